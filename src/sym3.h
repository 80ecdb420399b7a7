/* Symmetric positive semidefinite 3x3 matrices (00, 01, 02, 11, 12, 22), shared by body and audit. */
#ifndef TRIBO_SYM3_H
#define TRIBO_SYM3_H

#include "bits.h"

/* 1 if the matrix is positive semidefinite, up to `tolerance` relative to the diagonal in each minor. */
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

/* Inverse of a positive definite matrix by its cofactors, scaled against overflow. Returns 0, and
 * writes nothing, where it is singular or the inverse is not finite. */
static inline int sym3_invert(const double m[6], double out[6])
{
    const double s = power_of_two(scale_exponent(greater(m[0], greater(m[3], m[5]))));
    const double a = s * m[0];
    const double b = s * m[1];
    const double c = s * m[2];
    const double d = s * m[3];
    const double e = s * m[4];
    const double f = s * m[5];
    if (b == 0.0 && c == 0.0 && e == 0.0) {
        const double diagonal[6] = {1.0 / m[0], 0.0, 0.0, 1.0 / m[3], 0.0, 1.0 / m[5]};
        if (!all_finite(diagonal, 6)) {
            return 0;
        }
        memcpy(out, diagonal, sizeof diagonal);
        return 1;
    }
    const double cofactor[6] = {d * f - e * e, c * e - b * f, b * e - c * d,
                                a * f - c * c, b * c - a * e, a * d - b * b};
    const double determinant = a * cofactor[0] + b * cofactor[1] + c * cofactor[2];
    double inverse[6];
    for (int i = 0; i < 6; i++) {
        inverse[i] = cofactor[i] / determinant * s;
    }
    if (!(determinant > 0.0) || !all_finite(inverse, 6)) {
        return 0;
    }
    memcpy(out, inverse, sizeof inverse);
    return 1;
}

#endif
