/* Trials, failures, and values from bytes; see property.h. */
#include "property.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a trial ------------------------------------------------------------------------------ */

int property_run(property_trial *t, const uint8_t *data, size_t size, FILE *log)
{
    memset(t, 0, sizeof *t);
    if (size == 0 || data[0] >= property_count) {
        return 0;
    }
    t->data = data + 1;
    t->size = size - 1;
    t->log = log;
    property_list[data[0]].run(t);
    return 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    property_trial t;
    if (!property_run(&t, data, size, NULL)) {
        return -1;
    }
    if (t.expression != NULL) {
        property_run(&t, data, size, stderr);
        fprintf(stderr, "%s: %s fails at %s:%d: %s%s\n", property_room, property_list[data[0]].name,
                t.file, t.line, t.expression, t.detail);
        abort();
    }
    return 0;
}

void property_fail(property_trial *t, const char *expression, const char *file, int line)
{
    if (t->expression == NULL) {
        t->expression = expression;
        t->file = file;
        t->line = line;
    }
}

void property_fail_values(property_trial *t, const char *expression, const char *file, int line,
                          double got, double want, double tolerance)
{
    if (t->expression == NULL) {
        snprintf(t->detail, sizeof t->detail, ": %a (%.17g), %a (%.17g), tolerance %.3g", got, got,
                 want, want, tolerance);
    }
    property_fail(t, expression, file, line);
}

void property_fail_status(property_trial *t, const char *expression, const char *file, int line,
                          tribo_status got, tribo_status want)
{
    if (t->expression == NULL) {
        snprintf(t->detail, sizeof t->detail, ": %s, not %s", tribo_status_name(got),
                 tribo_status_name(want));
    }
    property_fail(t, expression, file, line);
}

int property_same(const void *left, const void *right, size_t bytes)
{
    return memcmp(left, right, bytes) == 0;
}

static uint8_t canary_byte(size_t i)
{
    return (uint8_t)(0x9du + 61u * i);
}

void canary_set(void *memory, size_t bytes)
{
    uint8_t *m = memory;
    for (size_t i = 0; i < bytes; i++) {
        m[i] = canary_byte(i);
    }
}

int canary_kept(const void *memory, size_t bytes)
{
    const uint8_t *m = memory;
    for (size_t i = 0; i < bytes; i++) {
        if (m[i] != canary_byte(i)) {
            return 0;
        }
    }
    return 1;
}

/* ---- values from bytes -------------------------------------------------------------------- */

void property_note(property_trial *t, const char *name, const double *values, size_t count)
{
    if (t->log == NULL || name == NULL) {
        return;
    }
    fprintf(t->log, "#   %s =", name);
    for (size_t i = 0; i < count; i++) {
        fprintf(t->log, " %a", values[i]);
    }
    fprintf(t->log, "  (");
    for (size_t i = 0; i < count; i++) {
        fprintf(t->log, "%s%.9g", i == 0 ? "" : " ", values[i]);
    }
    fprintf(t->log, ")\n");
}

static double noted(property_trial *t, const char *name, double value)
{
    property_note(t, name, &value, 1);
    return value;
}

void property_expand(property_trial *t)
{
    t->stream = make_bits(t, 4);
}

/* Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014. */
static uint8_t next_of_stream(property_trial *t)
{
    uint64_t z = (t->stream += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (uint8_t)(z >> 56);
}

uint8_t make_byte(property_trial *t)
{
    if (t->used < t->size) {
        return t->data[t->used++];
    }
    return t->stream != 0 ? next_of_stream(t) : 0;
}

uint64_t make_bits(property_trial *t, unsigned bytes)
{
    uint64_t bits = 0;
    for (unsigned i = 0; i < bytes; i++) {
        bits |= (uint64_t)make_byte(t) << (8 * i);
    }
    return bits;
}

uint32_t make_choice(property_trial *t, const char *name, uint32_t count)
{
    const uint32_t choice = (uint32_t)make_bits(t, count > 64 ? 2 : 1) % count;
    if (t->log != NULL && name != NULL) {
        fprintf(t->log, "#   %s: %u\n", name, (unsigned)choice);
    }
    return choice;
}

static double unit_quiet(property_trial *t)
{
    return ldexp((double)(make_bits(t, 7) >> 3), -53);
}

static double signed_quiet(property_trial *t)
{
    const double unit = unit_quiet(t);
    return unit < 0.5 ? 2.0 * unit : 2.0 * unit - 2.0;
}

double make_unit(property_trial *t, const char *name)
{
    return noted(t, name, unit_quiet(t));
}

double make_signed(property_trial *t, const char *name)
{
    return noted(t, name, signed_quiet(t));
}

int make_exponent(property_trial *t, int low, int high)
{
    const int plain = low > 0 ? low : high < 0 ? high : 0;
    const int span = high - low + 1;
    return low + ((int)make_bits(t, 2) + plain - low) % span;
}

static double positive_quiet(property_trial *t, int low, int high)
{
    const int exponent = make_exponent(t, low, high);
    const double mantissa = make_byte(t) < 224 ? 1.0 + unit_quiet(t) : 1.0;
    return ldexp(mantissa, exponent);
}

double make_positive(property_trial *t, const char *name, int low, int high)
{
    return noted(t, name, positive_quiet(t, low, high));
}

static double real_quiet(property_trial *t, int low, int high)
{
    const uint8_t kind = make_byte(t);
    if (kind < 24) {
        return kind % 2 == 0 ? 0.0 : -0.0;
    }
    return kind % 2 == 0 ? positive_quiet(t, low, high) : -positive_quiet(t, low, high);
}

double make_real(property_trial *t, const char *name, int low, int high)
{
    return noted(t, name, real_quiet(t, low, high));
}

static const double special[] = {0.0,
                                 -0.0,
                                 1.0,
                                 -1.0,
                                 0.5,
                                 2.0,
                                 DBL_EPSILON,
                                 -DBL_EPSILON,
                                 DBL_MIN,
                                 DBL_MAX,
                                 -DBL_MAX,
                                 -DBL_MIN,
                                 1e-308,
                                 1e308,
                                 1e290,
                                 -1e290,
                                 1e-290,
                                 1e154,
                                 -1e154,
                                 1e-154,
                                 1e-162,
                                 0x1p600,
                                 1.0 + DBL_EPSILON,
                                 1.0 - DBL_EPSILON / 2.0,
                                 -1e-308,
                                 -1e308,
                                 0x1p1000,
                                 0x1p-1000,
                                 0x1p-1074,
                                 -0x1p-1074,
                                 0x1p1001,
                                 0x1p-1001};

static double any_bits(property_trial *t)
{
    const uint64_t bits = make_bits(t, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double finite_quiet(property_trial *t)
{
    const uint8_t kind = make_byte(t);
    if (kind < 64) {
        return signed_quiet(t);
    }
    if (kind < 128) {
        return real_quiet(t, -60, 60);
    }
    if (kind < 192) {
        return special[make_byte(t) % (sizeof special / sizeof special[0])];
    }
    const double value = any_bits(t);
    return isfinite(value) ? value : 3.0;
}

double make_finite(property_trial *t, const char *name)
{
    return noted(t, name, finite_quiet(t));
}

double make_hostile(property_trial *t, const char *name)
{
    const uint8_t kind = make_byte(t);
    return noted(t, name, kind % 3 == 0 ? (double)NAN : kind % 3 == 1 ? HUGE_VAL : -HUGE_VAL);
}

double make_any(property_trial *t, const char *name)
{
    return make_byte(t) < 224 ? make_finite(t, name) : make_hostile(t, name);
}

void make_vector(property_trial *t, const char *name, int low, int high, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = real_quiet(t, low, high);
    }
    property_note(t, name, out, 3);
}

void make_finite_vector(property_trial *t, const char *name, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = finite_quiet(t);
    }
    property_note(t, name, out, 3);
}

void make_directions(property_trial *t, const char *name, double *out, size_t count)
{
    const uint8_t zeros = make_byte(t);
    for (size_t i = 0; i < count; i++) {
        out[i] = signed_quiet(t);
        if (zeros >= 192 && ((zeros >> i) & 1) != 0) {
            out[i] = copysign(0.0, out[i]);
        }
    }
    property_note(t, name, out, count);
}
