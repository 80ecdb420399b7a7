/* Properties of include/tribo/base.h. */
#include <string.h>

#include "support/property.h"

static const struct {
    tribo_status status;
    const char *name;
} known[] = {
    {0, "TRIBO_OK"},
    {10, "TRIBO_ERROR_NULL"},
    {11, "TRIBO_ERROR_STRUCT_SIZE"},
    {12, "TRIBO_ERROR_OPTION"},
    {13, "TRIBO_ERROR_INDEX"},
    {14, "TRIBO_ERROR_ISA"},
    {15, "TRIBO_ERROR_NAME"},
    {16, "TRIBO_ERROR_ALIAS"},
    {17, "TRIBO_ERROR_CAPACITY"},
    {18, "TRIBO_ERROR_MEMORY"},
    {19, "TRIBO_ERROR_DATA"},
    {20, "TRIBO_ERROR_NOT_FINITE"},
    {21, "TRIBO_ERROR_RANGE"},
    {22, "TRIBO_ERROR_NORMAL"},
    {23, "TRIBO_ERROR_ORIENTATION"},
    {24, "TRIBO_ERROR_FRAME"},
    {30, "TRIBO_ERROR_MASS"},
    {31, "TRIBO_ERROR_INERTIA"},
    {32, "TRIBO_ERROR_SHAPE"},
    {33, "TRIBO_ERROR_TIME_STEP"},
    {34, "TRIBO_ERROR_DEGENERATE"},
    {35, "TRIBO_ERROR_SUPPORT"},
    {36, "TRIBO_ERROR_PAIR"},
    {40, "TRIBO_ERROR_FRICTION"},
    {41, "TRIBO_ERROR_RESTITUTION"},
    {50, "TRIBO_ERROR_CONTACT_MATRIX"},
    {51, "TRIBO_ERROR_IMMOVABLE"},
    {52, "TRIBO_ERROR_JAM"},
};

static const char *expected_name(tribo_status status)
{
    for (size_t i = 0; i < PROPERTY_COUNT(known); i++) {
        if (known[i].status == status) {
            return known[i].name;
        }
    }
    return "TRIBO_ERROR_UNKNOWN";
}

static int is_sentence(const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i < length; i++) {
        if (text[i] < ' ' || text[i] > '~') {
            return 0;
        }
    }
    return length >= 3;
}

/* The numbers are pinned, every other number is unknown, and strings are static. */
static void status_text(property_trial *t)
{
    const int small = make_choice(t, "small", 2) == 0;
    const tribo_status status =
        small ? (tribo_status)make_byte(t) - 16 : (tribo_status)(int64_t)make_bits(t, 4);
    const char *name = tribo_status_name(status);
    const char *text = tribo_status_string(status);
    REQUIRE(t, name != NULL && text != NULL);
    REQUIRE(t, strcmp(name, expected_name(status)) == 0);
    REQUIRE(t, is_sentence(text));
    REQUIRE(t, name == tribo_status_name(status) && text == tribo_status_string(status));
}

/* Each status has a sentence of its own. */
static void status_distinct(property_trial *t)
{
    const uint32_t i = make_choice(t, "first", (uint32_t)PROPERTY_COUNT(known));
    const uint32_t j = make_choice(t, "second", (uint32_t)PROPERTY_COUNT(known));
    const int same =
        strcmp(tribo_status_string(known[i].status), tribo_status_string(known[j].status)) == 0;
    REQUIRE(t, same == (i == j));
}

static void version(property_trial *t)
{
    char text[40];
    const uint32_t major = TRIBO_VERSION_MAJOR;
    const uint32_t minor = TRIBO_VERSION_MINOR;
    const uint32_t patch = TRIBO_VERSION_PATCH;
    snprintf(text, sizeof text, "%u.%u.%u", major, minor, patch);
    REQUIRE(t, tribo_version() == major * 10000 + minor * 100 + patch);
    REQUIRE(t, strcmp(tribo_version_string(), text) == 0);
}

const char *const property_room = "base";
const property property_list[] = {
    {"status_text", status_text, 1},
    {"status_distinct", status_distinct, 1},
    {"version", version, 100},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 300000;
