/**
 * @file property.h
 * Properties: functions from a byte string to structured input to assertions.
 *
 * A property takes its input from the front of the byte string by the make_... functions below,
 * calls tribo, and says by REQUIRE what must hold. Where the bytes end, zeros follow, and zeros
 * give the plainest value of each kind; so cutting bytes off, or zeroing them, makes an input
 * simpler (driver/random.c shrinks in this way, and so do libFuzzer and AFL++).
 *
 * Each room's file defines property_list, property_count, property_room and property_trials; the
 * first byte of an input is the index of the property in the list. New properties are appended,
 * so that the files of the corpus keep their meaning.
 */
#ifndef FUZZ_PROPERTY_H
#define FUZZ_PROPERTY_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <tribo/tribo.h>

#define EPS DBL_EPSILON

/* ---- a trial ------------------------------------------------------------------------------ */

/** One run of one property. */
typedef struct property_trial {
    const uint8_t *data; /**< input without the first byte */
    size_t size;
    size_t used;
    uint64_t stream;        /**< state of the endless tail; 0: zeros */
    FILE *log;              /**< each made value is printed here; null: nowhere */
    int skipped;            /**< the input lies outside of what the property speaks of */
    const char *expression; /**< what failed; null: nothing */
    const char *file;
    int line;
    char detail[240]; /**< the values it failed with */
} property_trial;

typedef void (*property_function)(property_trial *t);

typedef struct property {
    const char *name;
    property_function run;
    unsigned cost; /**< a trial costs so many times that of a cheap property */
} property;

/* each room defines these */
extern const char *const property_room;
extern const property property_list[];
extern const size_t property_count;
extern const unsigned property_trials; /**< default number of trials of a property of cost 1 */

/** Number of elements of a list, for property_count. */
#define PROPERTY_COUNT(list) (sizeof(list) / sizeof((list)[0]))

/** Run the property that data[0] names. @return 0 if there is none, else 1. */
int property_run(property_trial *t, const uint8_t *data, size_t size, FILE *log);

/** libFuzzer's and AFL++'s entry: runs the property, prints and aborts if it fails. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* ---- assertions: the first that fails ends the property ----------------------------------- */

void property_fail(property_trial *t, const char *expression, const char *file, int line);
void property_fail_values(property_trial *t, const char *expression, const char *file, int line,
                          double got, double want, double tolerance);
void property_fail_status(property_trial *t, const char *expression, const char *file, int line,
                          tribo_status got, tribo_status want);

/** The property says nothing about this input. */
#define ASSUME(t, condition)  \
    do {                      \
        if (!(condition)) {   \
            (t)->skipped = 1; \
            return;           \
        }                     \
    } while (0)

#define REQUIRE(t, condition)                                   \
    do {                                                        \
        if (!(condition)) {                                     \
            property_fail((t), #condition, __FILE__, __LINE__); \
            return;                                             \
        }                                                       \
    } while (0)

/** |got - want| <= tolerance; NaN fails. */
#define REQUIRE_NEAR(t, got, want, tolerance)                                               \
    do {                                                                                    \
        const double got_ = (double)(got);                                                  \
        const double want_ = (double)(want);                                                \
        const double tolerance_ = (double)(tolerance);                                      \
        if (!(got_ - want_ <= tolerance_ && want_ - got_ <= tolerance_)) {                  \
            property_fail_values((t), #got " near " #want, __FILE__, __LINE__, got_, want_, \
                                 tolerance_);                                               \
            return;                                                                         \
        }                                                                                   \
    } while (0)

/** value <= bound; NaN fails. */
#define REQUIRE_AT_MOST(t, value, bound)                                                        \
    do {                                                                                        \
        const double value_ = (double)(value);                                                  \
        const double bound_ = (double)(bound);                                                  \
        if (!(value_ <= bound_)) {                                                              \
            property_fail_values((t), #value " <= " #bound, __FILE__, __LINE__, value_, bound_, \
                                 0.0);                                                          \
            return;                                                                             \
        }                                                                                       \
    } while (0)

#define REQUIRE_STATUS(t, call, expected)                                      \
    do {                                                                       \
        const tribo_status got_ = (call);                                      \
        const tribo_status want_ = (expected);                                 \
        if (got_ != want_) {                                                   \
            property_fail_status((t), #call, __FILE__, __LINE__, got_, want_); \
            return;                                                            \
        }                                                                      \
    } while (0)

/** The same bytes. */
#define REQUIRE_SAME(t, left, right, bytes) REQUIRE(t, property_same((left), (right), (bytes)))

int property_same(const void *left, const void *right, size_t bytes);

/** Fill memory with a pattern that no result is likely to be, and see whether it is still there. */
void canary_set(void *memory, size_t bytes);
int canary_kept(const void *memory, size_t bytes);

/* ---- values from bytes -------------------------------------------------------------------- */

/** Let pseudo-random bytes, seeded by the next four, follow after the end in place of zeros: for
 *  properties that need many values. A zero seed gives zeros. */
void property_expand(property_trial *t);

uint8_t make_byte(property_trial *t);
uint64_t make_bits(property_trial *t, unsigned bytes);
uint32_t make_choice(property_trial *t, const char *name, uint32_t count);

/** Uniform in [0, 1) and in (-1, 1). */
double make_unit(property_trial *t, const char *name);
double make_signed(property_trial *t, const char *name);

/** Uniform in [low, high]; zero bytes give the one nearest to 0. */
int make_exponent(property_trial *t, int low, int high);

/** Uniform exponent in [low, high], mantissa in [1, 2): powers of two among them. */
double make_positive(property_trial *t, const char *name, int low, int high);

/** Zero of either sign, or + or - make_positive. */
double make_real(property_trial *t, const char *name, int low, int high);

/** Any finite number; special ones often. */
double make_finite(property_trial *t, const char *name);

/** NaN or infinity of either sign. */
double make_hostile(property_trial *t, const char *name);

/** make_finite or make_hostile. */
double make_any(property_trial *t, const char *name);

void make_vector(property_trial *t, const char *name, int low, int high, double out[3]);
void make_finite_vector(property_trial *t, const char *name, double out[3]);

/** Components within (-1, 1), zeros among them. */
void make_directions(property_trial *t, const char *name, double *out, size_t count);

/** Print values that a property made by itself, if the trial is logged. */
void property_note(property_trial *t, const char *name, const double *values, size_t count);

#endif
