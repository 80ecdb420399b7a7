/**
 * @file math.h
 * Vectors, 3x3 matrices, quaternions, skew products, the contact basis, and the few elementary
 * functions that tribo computes itself so that every platform gives the same bits.
 *
 * Shapes and the rules on aliasing, threads and NaN: see base.h. No function here needs a unit
 * unless it says so.
 */
#ifndef TRIBO_MATH_H
#define TRIBO_MATH_H

#include <tribo/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- vec3 ------------------------------------------------------------------------------------ */

/** a . b, summed from left to right. */
TRIBO_API TRIBO_INLINE double tribo_vec3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** out = a x b. */
TRIBO_API TRIBO_INLINE void tribo_vec3_cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/** out = a + b. */
TRIBO_API TRIBO_INLINE void tribo_vec3_add(const double a[3], const double b[3], double out[3])
{
    out[0] = a[0] + b[0];
    out[1] = a[1] + b[1];
    out[2] = a[2] + b[2];
}

/** out = a - b. */
TRIBO_API TRIBO_INLINE void tribo_vec3_subtract(const double a[3], const double b[3], double out[3])
{
    out[0] = a[0] - b[0];
    out[1] = a[1] - b[1];
    out[2] = a[2] - b[2];
}

/** out = s a. */
TRIBO_API TRIBO_INLINE void tribo_vec3_scale(double s, const double a[3], double out[3])
{
    out[0] = s * a[0];
    out[1] = s * a[1];
    out[2] = s * a[2];
}

/** out = a + s b. */
TRIBO_API TRIBO_INLINE void tribo_vec3_add_scaled(const double a[3], double s, const double b[3],
                                                  double out[3])
{
    out[0] = a[0] + s * b[0];
    out[1] = a[1] + s * b[1];
    out[2] = a[2] + s * b[2];
}

/** |a|, without overflow or underflow of the squares. */
TRIBO_API double tribo_vec3_norm(const double a[3]);

/** out = a / |a|, correct to 2 eps whatever the length of a.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or TRIBO_ERROR_RANGE if a is zero. */
TRIBO_API tribo_status tribo_vec3_normalize(const double a[3], double out[3]);

/* ---- mat3, row by row ------------------------------------------------------------------------ */

/** out = a b. */
TRIBO_API void tribo_mat3_multiply(const double a[9], const double b[9], double out[9]);

/** out = a transposed. */
TRIBO_API void tribo_mat3_transpose(const double a[9], double out[9]);

/** out = a x. */
TRIBO_API TRIBO_INLINE void tribo_mat3_apply(const double a[9], const double x[3], double out[3])
{
    const double r0 = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
    const double r1 = a[3] * x[0] + a[4] * x[1] + a[5] * x[2];
    const double r2 = a[6] * x[0] + a[7] * x[1] + a[8] * x[2];
    out[0] = r0;
    out[1] = r1;
    out[2] = r2;
}

/** out = a transposed, times x. */
TRIBO_API TRIBO_INLINE void tribo_mat3_apply_transposed(const double a[9], const double x[3],
                                                        double out[3])
{
    const double r0 = a[0] * x[0] + a[3] * x[1] + a[6] * x[2];
    const double r1 = a[1] * x[0] + a[4] * x[1] + a[7] * x[2];
    const double r2 = a[2] * x[0] + a[5] * x[1] + a[8] * x[2];
    out[0] = r0;
    out[1] = r1;
    out[2] = r2;
}

/** out = s x for a symmetric s. */
TRIBO_API TRIBO_INLINE void tribo_sym3_apply(const double s[6], const double x[3], double out[3])
{
    const double r0 = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
    const double r1 = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
    const double r2 = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
    out[0] = r0;
    out[1] = r1;
    out[2] = r2;
}

/* ---- skew matrices: S(r) x = r x x (lecture, "The skew-symmetric matrix") -------------------- */

/** out = S(r) = [0 -rz ry; rz 0 -rx; -ry rx 0]; S + S^T = 0 to the bit. */
TRIBO_API void tribo_skew_matrix(const double r[3], double out[9]);

/** out = S(r)^T A S(r) for a symmetric A: symmetric to the bit because each entry is computed once.
 *  With A the inverse inertia in the same axes this is the angular part of the contact matrix. */
TRIBO_API void tribo_skew_congruence(const double r[3], const double a[6], double out[6]);

/** out = r x (A x), A symmetric. */
TRIBO_API void tribo_skew_cross_apply(const double r[3], const double a[6], const double x[3],
                                      double out[3]);

/* ---- contact basis --------------------------------------------------------------------------- */

/** Orthonormal right-handed basis from a unit normal: rows (n, t1, t2) of `frame`, the first equal
 *  to n to the bit. x_contact = frame x_world.
 *
 *  Continuous everywhere but at n = (0, 0, -1) (and within 1e-150 of it), where t1 = (1, 0, 0),
 *  t2 = (0, -1, 0). (No basis is
 *  continuous on the whole sphere.) At n = (0, 0, 1): t1 = (1, 0, 0), t2 = (0, 1, 0). Zeros of
 *  either sign give the same basis. Construction: rotate z to n about z x n; where n_z < 0 the
 *  denominator 1 + n_z is formed without cancellation as (n_x^2 + n_y^2) / (1 - n_z).
 *  Deviation from orthonormality: at most 8 eps for a normal that is unit to an eps.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or TRIBO_ERROR_NORMAL if | |n|^2 - 1 | >
 *           1e-12. */
TRIBO_API tribo_status tribo_basis_from_normal(const double n[3], double frame[9]);

/* ---- quaternions (w, x, y, z): rotations from body to world axes ----------------------------- */

/** out = a b: the rotation b, then a. */
TRIBO_API void tribo_quat_multiply(const double a[4], const double b[4], double out[4]);

/** out = (w, -x, -y, -z): the inverse of a unit quaternion. */
TRIBO_API void tribo_quat_conjugate(const double q[4], double out[4]);

/** out = q / |q|. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE if q is
 *  zero. */
TRIBO_API tribo_status tribo_quat_normalize(const double q[4], double out[4]);

/** Rotation matrix of q / |q|; q need not be of unit length, but must not be zero. */
TRIBO_API void tribo_quat_to_mat3(const double q[4], double out[9]);

/** out = R(q) x: body to world. */
TRIBO_API void tribo_quat_rotate(const double q[4], const double x[3], double out[3]);

/** out = R(q)^T x: world to body. */
TRIBO_API void tribo_quat_rotate_inverse(const double q[4], const double x[3], double out[3]);

/** Quaternion of the rotation by |v| radians about v (the exponential map); |v| <= 2^20.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE. */
TRIBO_API tribo_status tribo_quat_from_rotation_vector(const double v[3], double out[4]);

/** Angle in [0, pi] of the rotation that takes a to b; both of any length but zero. Accurate for
 *  small angles too: 2 atan2(|vector part|, |scalar part|) of conj(a) b. */
TRIBO_API double tribo_quat_angle(const double a[4], const double b[4]);

/* ---- elementary functions, the same bits on every platform ----------------------------------- */

/** Sine and cosine of x radians, |x| <= 2^20 (NaN beyond), within 2 ulp.
 *  Reduction by pi/2 in three parts (Cody & Waite 1980), then Taylor polynomials on [-pi/4,
 *  pi/4]. */
TRIBO_API void tribo_sin_cos(double x, double *sine, double *cosine);

/** Angle of the point (x, y) in [-pi, pi], within 2 ulp; 0 for (0, 0); signed
 *  zeros as in C; NaN if an argument is not finite. */
TRIBO_API double tribo_atan2(double y, double x);

/** The power of two s with 1 <= s |x| < 2 for |x| in [2^-1000, 2^1000]; beyond, s of the nearer end
 *  of that range; 1 for x = 0. Scaling by it is exact. */
TRIBO_API double tribo_pow2_scale(double x);

#ifdef __cplusplus
}
#endif

#endif
