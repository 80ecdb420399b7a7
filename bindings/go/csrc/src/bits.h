/* Small helpers shared by the rooms: finiteness, powers of two by their bit patterns. */
#ifndef TRIBO_BITS_H
#define TRIBO_BITS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__GNUC__)
#define TRIBO_ALWAYS_INLINE static inline __attribute__((always_inline))
#define TRIBO_NEVER_INLINE static __attribute__((noinline))
#else
#define TRIBO_ALWAYS_INLINE static inline
#define TRIBO_NEVER_INLINE static
#endif

#define TRIBO_EPS 2.220446049250313080847e-16 /* 2^-52 */

TRIBO_ALWAYS_INLINE uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

TRIBO_ALWAYS_INLINE double double_of(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

TRIBO_ALWAYS_INLINE double absolute(double x)
{
    return fabs(x);
}

TRIBO_ALWAYS_INLINE double greater(double a, double b)
{
    return a > b ? a : b;
}

TRIBO_ALWAYS_INLINE double lesser(double a, double b)
{
    return a < b ? a : b;
}

/* x - x is 0 for finite x and NaN for all others; a sum of such terms needs one test only. */
TRIBO_ALWAYS_INLINE double finite_probe(const double *x, int count)
{
    double even = 0.0;
    double odd = 0.0;
    for (int i = 0; i + 1 < count; i += 2) {
        even += x[i] - x[i];
        odd += x[i + 1] - x[i + 1];
    }
    return count % 2 != 0 ? even + odd + (x[count - 1] - x[count - 1]) : even + odd;
}

TRIBO_ALWAYS_INLINE int all_finite(const double *x, int count)
{
    return finite_probe(x, count) == 0.0;
}

#define TRIBO_LARGE 1.0715086071862673e+301 /* 2^1000 */
#define TRIBO_SMALL 9.3326361850321888e-302 /* 2^-1000 */

/* Biased exponent of the power of two that brings |x| into [1, 2), held within 2^-1000 and 2^1000
 * so that the scale and its inverse are both normal numbers. 0 and NaN count as small. Held as a
 * double, because lanes have no cheap comparison of 64-bit integers. */
TRIBO_ALWAYS_INLINE uint64_t scale_exponent(double x)
{
    const double size = absolute(x);
    const double low = size > TRIBO_SMALL ? size : TRIBO_SMALL;
    const double held = low < TRIBO_LARGE ? low : TRIBO_LARGE;
    return 2046u - (bits_of(held) >> 52);
}

/* 2^(e - 1023) for a biased exponent e in [1, 2046]. */
TRIBO_ALWAYS_INLINE double power_of_two(uint64_t biased_exponent)
{
    return double_of(biased_exponent << 52);
}

#endif
