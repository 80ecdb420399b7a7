/* Symmetric positive semidefinite 3x3 matrices (00, 01, 02, 11, 12, 22), shared by body and
 * audit. */
#ifndef TRIBO_SYM3_H
#define TRIBO_SYM3_H

#include "bits.h"

/* 1 if the matrix is positive semidefinite, up to `tolerance` relative to the diagonal in each
 * minor. */
static inline int sym3_is_semidefinite(const double m[6], double tolerance)
{
    if (m[0] < 0.0 || m[3] < 0.0 || m[5] < 0.0) {
        return 0;
    }
    if (m[1] == 0.0 && m[2] == 0.0 && m[4] == 0.0) {
        return 1;
    }
    const double s = power_of_two(scale_exponent(greater(m[0], greater(m[3], m[5]))));
    const double a = s * m[0];
    const double b = s * m[1];
    const double c = s * m[2];
    const double d = s * m[3];
    const double e = s * m[4];
    const double f = s * m[5];
    const double slack = 1.0 + tolerance;
    if (b * b > slack * (a * d) || c * c > slack * (a * f) || e * e > slack * (d * f)) {
        return 0;
    }
    const double determinant = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d);
    return determinant >= -4.0 * tolerance * (a * d * f);
}

/* Inverse of a positive definite matrix, L^-T D^-1 L^-1 of its Cholesky factors: cofactors would
 * lose eps cond^2. Scaled against overflow. Returns 0, and writes nothing, where it is singular or
 * the inverse is not finite. */
static inline int sym3_invert(const double m[6], double out[6])
{
    const double s = power_of_two(scale_exponent(greater(m[0], greater(m[3], m[5]))));
    const double b = s * m[1];
    const double c = s * m[2];
    const double d0 = s * m[0];
    const double l10 = b / d0;
    const double l20 = c / d0;
    const double d1 = s * m[3] - l10 * b;
    const double e = s * m[4] - l10 * c;
    const double l21 = e / d1;
    const double d2 = s * m[5] - l20 * c - l21 * e;
    if (!(d0 > 0.0 && d1 > 0.0 && d2 > 0.0)) {
        return 0;
    }
    const double i0 = s / d0;
    const double i1 = s / d1;
    const double i2 = s / d2;
    const double k20 = l10 * l21 - l20; /* of L^-1, whose other entries are -l10 and -l21 */
    const double inverse[6] = {
        i0 + l10 * l10 * i1 + k20 * k20 * i2,
        -l10 * i1 - k20 * l21 * i2,
        k20 * i2,
        i1 + l21 * l21 * i2,
        -l21 * i2,
        i2,
    };
    if (!all_finite(inverse, 6)) {
        return 0;
    }
    memcpy(out, inverse, sizeof inverse);
    return 1;
}

#endif
