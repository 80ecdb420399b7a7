/* Status numbers are pinned, named and described; versions agree. */
#include <tribo/base.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* The numbers are written out: a renumbered status has to fail here. */
static const struct {
    tribo_status status;
    tribo_status number;
    const char *name;
} statuses[] = {
    {TRIBO_OK, 0, "TRIBO_OK"},
    {TRIBO_ERROR_NULL, 10, "TRIBO_ERROR_NULL"},
    {TRIBO_ERROR_STRUCT_SIZE, 11, "TRIBO_ERROR_STRUCT_SIZE"},
    {TRIBO_ERROR_OPTION, 12, "TRIBO_ERROR_OPTION"},
    {TRIBO_ERROR_INDEX, 13, "TRIBO_ERROR_INDEX"},
    {TRIBO_ERROR_ISA, 14, "TRIBO_ERROR_ISA"},
    {TRIBO_ERROR_NAME, 15, "TRIBO_ERROR_NAME"},
    {TRIBO_ERROR_ALIAS, 16, "TRIBO_ERROR_ALIAS"},
    {TRIBO_ERROR_CAPACITY, 17, "TRIBO_ERROR_CAPACITY"},
    {TRIBO_ERROR_MEMORY, 18, "TRIBO_ERROR_MEMORY"},
    {TRIBO_ERROR_DATA, 19, "TRIBO_ERROR_DATA"},
    {TRIBO_ERROR_NOT_FINITE, 20, "TRIBO_ERROR_NOT_FINITE"},
    {TRIBO_ERROR_RANGE, 21, "TRIBO_ERROR_RANGE"},
    {TRIBO_ERROR_NORMAL, 22, "TRIBO_ERROR_NORMAL"},
    {TRIBO_ERROR_ORIENTATION, 23, "TRIBO_ERROR_ORIENTATION"},
    {TRIBO_ERROR_FRAME, 24, "TRIBO_ERROR_FRAME"},
    {TRIBO_ERROR_MASS, 30, "TRIBO_ERROR_MASS"},
    {TRIBO_ERROR_INERTIA, 31, "TRIBO_ERROR_INERTIA"},
    {TRIBO_ERROR_SHAPE, 32, "TRIBO_ERROR_SHAPE"},
    {TRIBO_ERROR_TIME_STEP, 33, "TRIBO_ERROR_TIME_STEP"},
    {TRIBO_ERROR_DEGENERATE, 34, "TRIBO_ERROR_DEGENERATE"},
    {TRIBO_ERROR_SUPPORT, 35, "TRIBO_ERROR_SUPPORT"},
    {TRIBO_ERROR_PAIR, 36, "TRIBO_ERROR_PAIR"},
    {TRIBO_ERROR_FRICTION, 40, "TRIBO_ERROR_FRICTION"},
    {TRIBO_ERROR_RESTITUTION, 41, "TRIBO_ERROR_RESTITUTION"},
    {TRIBO_ERROR_CONTACT_MATRIX, 50, "TRIBO_ERROR_CONTACT_MATRIX"},
    {TRIBO_ERROR_IMMOVABLE, 51, "TRIBO_ERROR_IMMOVABLE"},
    {TRIBO_ERROR_JAM, 52, "TRIBO_ERROR_JAM"},
};

enum { STATUS_COUNT = sizeof statuses / sizeof statuses[0] };

static void test_numbers_and_names(void **state)
{
    (void)state;
    for (size_t i = 0; i < STATUS_COUNT; i++) {
        assert_int_equal(statuses[i].status, statuses[i].number);
        assert_string_equal(tribo_status_name(statuses[i].status), statuses[i].name);
    }
}

static void test_strings_describe(void **state)
{
    (void)state;
    for (size_t i = 0; i < STATUS_COUNT; i++) {
        const char *text = tribo_status_string(statuses[i].status);
        assert_non_null(text);
        assert_true(strlen(text) > 3);
        assert_null(strchr(text, '\n'));
        assert_string_not_equal(text, statuses[i].name);
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(text, tribo_status_string(statuses[k].status));
        }
        /* static: a later call leaves it as it was */
        assert_ptr_equal(text, tribo_status_string(statuses[i].status));
    }
}

static int is_listed(tribo_status status)
{
    for (size_t i = 0; i < STATUS_COUNT; i++) {
        if (statuses[i].number == status) {
            return 1;
        }
    }
    return 0;
}

static void check_unlisted(tribo_status status)
{
    assert_string_equal(tribo_status_name(status), "TRIBO_ERROR_UNKNOWN");
    assert_non_null(tribo_status_string(status));
    for (size_t i = 0; i < STATUS_COUNT; i++) {
        assert_string_not_equal(tribo_status_string(status),
                                tribo_status_string(statuses[i].status));
    }
}

/* A status that the library knows and this table does not fails here too. */
static void test_other_numbers_are_unknown(void **state)
{
    (void)state;
    for (tribo_status status = -300; status < 1000; status++) {
        if (!is_listed(status)) {
            check_unlisted(status);
        }
    }
    check_unlisted(INT32_MIN);
    check_unlisted(INT32_MAX);
}

static void test_version(void **state)
{
    char text[40];
    (void)state;
    assert_int_equal(tribo_version(),
                     TRIBO_VERSION_MAJOR * 10000 + TRIBO_VERSION_MINOR * 100 + TRIBO_VERSION_PATCH);
    snprintf(text, sizeof text, "%d.%d.%d", TRIBO_VERSION_MAJOR, TRIBO_VERSION_MINOR,
             TRIBO_VERSION_PATCH);
    assert_string_equal(tribo_version_string(), text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_and_names),
        cmocka_unit_test(test_strings_describe),
        cmocka_unit_test(test_other_numbers_are_unknown),
        cmocka_unit_test(test_version),
    };
    return cmocka_run_group_tests_name("base", tests, NULL, NULL);
}
