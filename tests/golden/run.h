/* What the golden runs are made of: a hash of all that comes out, and inputs made of integers by
 * exact operations only. The sign and payload of NaN are no promise and are not hashed. */
#ifndef TRIBO_GOLDEN_RUN_H
#define TRIBO_GOLDEN_RUN_H

#include <tribo/base.h>

#include <stddef.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* ---- hash ------------------------------------------------------------------------------------ */

static uint64_t hash;

static inline void put_u64(uint64_t x)
{
    for (int i = 0; i < 8; ++i) {
        hash = (hash ^ (x >> (8 * i) & 0xff)) * UINT64_C(0x100000001b3);
    }
}

static inline void put_double(double x)
{
    uint64_t u = UINT64_C(0x7ff8000000000000);
    if (x == x) {
        memcpy(&u, &x, sizeof u);
    }
    put_u64(u);
}

static inline void put_doubles(const double *x, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        put_double(x[i]);
    }
}

static inline void put_status(tribo_status status)
{
    put_u64((uint64_t)(int64_t)status);
}

static inline void put_string(const char *s)
{
    put_u64(s ? strlen(s) : UINT64_MAX);
    for (; s && *s; ++s) {
        put_u64((uint64_t)(unsigned char)*s);
    }
}

/* ---- numbers made of integers ---------------------------------------------------------------- */

static uint64_t generator;

/* SplitMix64 (Steele, Lea & Flood 2014). */
static inline uint64_t next(void)
{
    uint64_t z = generator += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static inline int below(int limit)
{
    return (int)(next() % (uint64_t)limit);
}

/* 2^exponent, for exponents of normal numbers. */
static inline double power(int exponent)
{
    const uint64_t u = (uint64_t)(exponent + 1023) << 52;
    double x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* In [0, 1), 53 bits. */
static inline double fraction(void)
{
    return (double)(int64_t)(next() >> 11) * 0x1p-53;
}

/* In (-1, 1). */
static inline double either(void)
{
    const double x = fraction();
    return next() & 1 ? x : -x;
}

/* Any magnitude within 2^-spread and 2^spread. Two draws never stand in one expression: the order
 * in which they are evaluated is the compiler's. */
static inline double wide(int spread)
{
    const double scale = power(below(2 * spread + 1) - spread);
    return scale * either();
}

/* Now and then what a caller should not pass, or what sits on an edge. */
static inline double odd(int spread)
{
    static const double edges[] = {0.0,     -0.0,     1.0,     -1.0,      0x1p-1074,
                                   0x1p-60, 0x1p1000, -0x1p60, 0x1p-1022, 1.7976931348623157e308};
    const int choice = below(256);
    if (choice < (int)COUNT(edges)) {
        return edges[choice];
    }
    if (choice == 254 || choice == 255) {
        const double huge = edges[9];
        return choice == 254 ? huge * 2 : huge * 2 - huge * 2;
    }
    return wide(spread);
}

static inline void fill(double *x, size_t count, int spread)
{
    for (size_t i = 0; i < count; ++i) {
        x[i] = wide(spread);
    }
}

static inline void fill_odd(double *x, size_t count, int spread)
{
    for (size_t i = 0; i < count; ++i) {
        x[i] = odd(spread);
    }
}

#endif
