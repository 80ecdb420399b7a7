/* Branch-free bodies of the contact basis and of the rotation matrix, shared by the scalar
 * functions and the lanes: one source of the bits. */
#ifndef TRIBO_ROWS_H
#define TRIBO_ROWS_H

#include "bits.h"

/* Below this n_x^2 + n_y^2 the normal counts as (0, 0, -1): t1 and t2 are then orthogonal to n to
 * 1e-150. */
#define TRIBO_POLE 1e-300

/* t1 = (1 - c x^2, -c x y, -x), t2 = (-c x y, 1 - c y^2, -y), c = 1/(1+z) = (1-z)/(x^2+y^2). The
 * second form does not cancel where z is near -1. 0 - a instead of -a: zeros of either sign give
 * the same bits. */
TRIBO_ALWAYS_INLINE void basis_rows(double x, double y, double z, double *frame)
{
    const double h = x * x + y * y;
    const int upper = z >= 0.0;
    const int pole = !upper && h < TRIBO_POLE;
    const double denominator = upper ? 1.0 + z : pole ? 1.0 : h;
    const double c = (upper ? 1.0 : 1.0 - z) / denominator;
    const double xy = 0.0 - c * x * y;
    frame[0] = x;
    frame[1] = y;
    frame[2] = z;
    frame[3] = pole ? 1.0 : 1.0 - c * x * x;
    frame[4] = pole ? 0.0 : xy;
    frame[5] = pole ? 0.0 : 0.0 - x;
    frame[6] = pole ? 0.0 : xy;
    frame[7] = pole ? -1.0 : 1.0 - c * y * y;
    frame[8] = pole ? 0.0 : 0.0 - y;
}

/* Rotation matrix of q / |q|. */
TRIBO_ALWAYS_INLINE void rotation_rows(double w, double x, double y, double z, double *r)
{
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    const double sx = s * x;
    const double sy = s * y;
    const double sz = s * z;
    const double wx = w * sx;
    const double wy = w * sy;
    const double wz = w * sz;
    const double xx = x * sx;
    const double xy = x * sy;
    const double xz = x * sz;
    const double yy = y * sy;
    const double yz = y * sz;
    const double zz = z * sz;
    r[0] = 1.0 - (yy + zz);
    r[1] = xy - wz;
    r[2] = xz + wy;
    r[3] = xy + wz;
    r[4] = 1.0 - (xx + zz);
    r[5] = yz - wx;
    r[6] = xz - wy;
    r[7] = yz + wx;
    r[8] = 1.0 - (xx + yy);
}

#endif
