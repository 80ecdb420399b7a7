#include <tribo/base.h>

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

typedef struct status_entry {
    tribo_status status;
    const char *name;
    const char *text;
} status_entry;

#define ENTRY(status, text)   \
    {                         \
        status, #status, text \
    }

static const status_entry statuses[] = {
    ENTRY(TRIBO_OK, "success"),
    ENTRY(TRIBO_ERROR_NULL, "a pointer that must not be null is null"),
    ENTRY(TRIBO_ERROR_STRUCT_SIZE, "struct_size is none that this library knows"),
    ENTRY(TRIBO_ERROR_OPTION, "an enumerated option has no such value"),
    ENTRY(TRIBO_ERROR_INDEX, "an index lies outside of its array"),
    ENTRY(TRIBO_ERROR_ISA, "the instruction set is not available on this machine"),
    ENTRY(TRIBO_ERROR_NAME, "no entry has that name"),
    ENTRY(TRIBO_ERROR_ALIAS, "two arguments that must differ are the same object"),
    ENTRY(TRIBO_ERROR_CAPACITY, "the buffer is too small"),
    ENTRY(TRIBO_ERROR_MEMORY, "a library beneath could not allocate memory"),
    ENTRY(TRIBO_ERROR_DATA, "a block of data is not one that this library made"),
    ENTRY(TRIBO_ERROR_NOT_FINITE, "an input is NaN or infinite"),
    ENTRY(TRIBO_ERROR_RANGE, "an input or the result is outside of the range of the function"),
    ENTRY(TRIBO_ERROR_NORMAL, "the contact normal is not of unit length"),
    ENTRY(TRIBO_ERROR_ORIENTATION, "the orientation quaternion is not of unit length"),
    ENTRY(TRIBO_ERROR_FRAME, "the contact frame is not orthonormal and right-handed"),
    ENTRY(TRIBO_ERROR_MASS, "a mass or inverse mass is negative, or zero where it must not be"),
    ENTRY(TRIBO_ERROR_INERTIA, "an inertia is asymmetric, indefinite or of no possible body"),
    ENTRY(TRIBO_ERROR_SHAPE, "a length or the density of a shape is not positive"),
    ENTRY(TRIBO_ERROR_TIME_STEP, "the time step is negative or too long to be resolved"),
    ENTRY(TRIBO_ERROR_DEGENERATE, "points span no volume, or no triangle has an area"),
    ENTRY(TRIBO_ERROR_SUPPORT, "a user's support function contradicts itself"),
    ENTRY(TRIBO_ERROR_PAIR, "these two kinds of shapes cannot be tested against each other"),
    ENTRY(TRIBO_ERROR_FRICTION, "a friction coefficient is negative, or mu_s is less than mu_d"),
    ENTRY(TRIBO_ERROR_RESTITUTION, "a coefficient of restitution is outside of its range"),
    ENTRY(TRIBO_ERROR_CONTACT_MATRIX, "the contact matrix is not positive semidefinite"),
    ENTRY(TRIBO_ERROR_IMMOVABLE, "neither body can move at the contact along the normal"),
    ENTRY(TRIBO_ERROR_JAM, "no bounded impulse satisfies Coulomb's law: the contact jams"),
};

static const status_entry *find_status(tribo_status status)
{
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        if (statuses[i].status == status) {
            return &statuses[i];
        }
    }
    return NULL;
}

const char *tribo_status_name(tribo_status status)
{
    const status_entry *entry = find_status(status);
    return entry ? entry->name : "TRIBO_ERROR_UNKNOWN";
}

const char *tribo_status_string(tribo_status status)
{
    const status_entry *entry = find_status(status);
    return entry ? entry->text : "unknown status";
}

uint32_t tribo_version(void)
{
    return TRIBO_VERSION_MAJOR * 10000u + TRIBO_VERSION_MINOR * 100u + TRIBO_VERSION_PATCH;
}

const char *tribo_version_string(void)
{
    return TEXT(TRIBO_VERSION_MAJOR) "." TEXT(TRIBO_VERSION_MINOR) "." TEXT(TRIBO_VERSION_PATCH);
}
