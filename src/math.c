#define TRIBO_INLINE extern inline /* this file emits the exported twins of the inline functions */
#include <tribo/math.h>

#include "rows.h"

#include <math.h>

/* ---- vec3 ------------------------------------------------------------------------------------ */

static double norm_of(const double *a, int count)
{
    double greatest = 0.0;
    for (int i = 0; i < count; i++) {
        greatest = greater(greatest, absolute(a[i]));
    }
    const double s = power_of_two(scale_exponent(greatest));
    double sum = finite_probe(a, count);
    for (int i = 0; i < count; i++) {
        const double x = s * a[i];
        sum += x * x;
    }
    return sqrt(sum) / s;
}

static tribo_status normalize(const double *a, int count, double *out)
{
    if (!a || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(a, count)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    double greatest = 0.0;
    for (int i = 0; i < count; i++) {
        greatest = greater(greatest, absolute(a[i]));
    }
    if (greatest == 0.0) {
        return TRIBO_ERROR_RANGE;
    }
    /* Two steps of scaling bring the least subnormal into range as well. */
    const double s = power_of_two(scale_exponent(greatest));
    const double s2 = power_of_two(scale_exponent(s * greatest));
    double scaled[4];
    for (int i = 0; i < count; i++) {
        scaled[i] = a[i] * s * s2;
    }
    const double norm = norm_of(scaled, count);
    for (int i = 0; i < count; i++) {
        out[i] = scaled[i] / norm;
    }
    return TRIBO_OK;
}

double tribo_vec3_norm(const double a[3])
{
    return norm_of(a, 3);
}

tribo_status tribo_vec3_normalize(const double a[3], double out[3])
{
    return normalize(a, 3, out);
}

/* ---- mat3 ------------------------------------------------------------------------------------ */

void tribo_mat3_multiply(const double a[9], const double b[9], double out[9])
{
    double product[9];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            product[3 * i + j] =
                a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
    memcpy(out, product, sizeof product);
}

void tribo_mat3_transpose(const double a[9], double out[9])
{
    const double transposed[9] = {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
    memcpy(out, transposed, sizeof transposed);
}

/* ---- skew matrices --------------------------------------------------------------------------- */

void tribo_skew_matrix(const double r[3], double out[9])
{
    const double s[9] = {0.0, -r[2], r[1], r[2], 0.0, -r[0], -r[1], r[0], 0.0};
    memcpy(out, s, sizeof s);
}

void tribo_skew_congruence(const double r[3], const double a[6], double out[6])
{
    /* Columns of S(r) are r x e_k. */
    const double columns[3][3] = {{0.0, r[2], -r[1]}, {-r[2], 0.0, r[0]}, {r[1], -r[0], 0.0}};
    double image[3][3];
    for (int k = 0; k < 3; k++) {
        tribo_sym3_apply(a, columns[k], image[k]);
    }
    const double result[6] = {
        tribo_vec3_dot(columns[0], image[0]), tribo_vec3_dot(columns[0], image[1]),
        tribo_vec3_dot(columns[0], image[2]), tribo_vec3_dot(columns[1], image[1]),
        tribo_vec3_dot(columns[1], image[2]), tribo_vec3_dot(columns[2], image[2]),
    };
    memcpy(out, result, sizeof result);
}

void tribo_skew_cross_apply(const double r[3], const double a[6], const double x[3], double out[3])
{
    double image[3];
    tribo_sym3_apply(a, x, image);
    tribo_vec3_cross(r, image, out);
}

/* ---- contact basis --------------------------------------------------------------------------- */

tribo_status tribo_basis_from_normal(const double n[3], double frame[9])
{
    if (!n || !frame) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(n, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (!(absolute(tribo_vec3_dot(n, n) - 1.0) <= 1e-12)) {
        return TRIBO_ERROR_NORMAL;
    }
    basis_rows(n[0], n[1], n[2], frame);
    return TRIBO_OK;
}

/* ---- quaternions ----------------------------------------------------------------------------- */

void tribo_quat_multiply(const double a[4], const double b[4], double out[4])
{
    const double w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    const double x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    const double y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    const double z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    out[0] = w;
    out[1] = x;
    out[2] = y;
    out[3] = z;
}

void tribo_quat_conjugate(const double q[4], double out[4])
{
    out[0] = q[0];
    out[1] = -q[1];
    out[2] = -q[2];
    out[3] = -q[3];
}

tribo_status tribo_quat_normalize(const double q[4], double out[4])
{
    return normalize(q, 4, out);
}

void tribo_quat_to_mat3(const double q[4], double out[9])
{
    rotation_rows(q[0], q[1], q[2], q[3], out);
}

static void rotate(double w, const double v[3], const double q[4], const double x[3], double out[3])
{
    const double s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double t[3];
    double vt[3];
    tribo_vec3_cross(v, x, t);
    tribo_vec3_scale(s, t, t);
    tribo_vec3_cross(v, t, vt);
    for (int i = 0; i < 3; i++) {
        out[i] = x[i] + (w * t[i] + vt[i]);
    }
}

void tribo_quat_rotate(const double q[4], const double x[3], double out[3])
{
    rotate(q[0], q + 1, q, x, out);
}

void tribo_quat_rotate_inverse(const double q[4], const double x[3], double out[3])
{
    rotate(-q[0], q + 1, q, x, out);
}

tribo_status tribo_quat_from_rotation_vector(const double v[3], double out[4])
{
    if (!v || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(v, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const double angle = norm_of(v, 3);
    if (!(angle <= 1048576.0)) {
        return TRIBO_ERROR_RANGE;
    }
    double sine;
    double cosine;
    tribo_sin_cos(0.5 * angle, &sine, &cosine);
    /* Below 2^-500 the quotient is 1/2 to the last bit, and angle may be too small to divide by. */
    const double factor = angle > 3.0e-151 ? sine / angle : 0.5;
    const double q[4] = {cosine, factor * v[0], factor * v[1], factor * v[2]};
    memcpy(out, q, sizeof q);
    return TRIBO_OK;
}

double tribo_quat_angle(const double a[4], const double b[4])
{
    double inverse[4];
    double d[4];
    tribo_quat_conjugate(a, inverse);
    tribo_quat_multiply(inverse, b, d);
    return 2.0 * tribo_atan2(norm_of(d + 1, 3), absolute(d[0]));
}

/* ---- elementary functions -------------------------------------------------------------------- */

/* pi/2 in three pieces of 33 bits and a rest: the product of a piece with an integer up to 2^20 is
 * exact. */
#define PIO2_A 1.57079632673412561417e+00
#define PIO2_B 6.07710050630396597660e-11
#define PIO2_C 2.02226624871116645580e-21
#define PIO2_D 8.47842766036889956997e-32

void tribo_sin_cos(double x, double *sine, double *cosine)
{
    if (!(absolute(x) <= 1048576.0)) {
        *sine = *cosine = double_of(0x7ff8000000000000u);
        return;
    }
    /* Adding and taking away 1.5 * 2^52 rounds to the nearest integer. */
    const double k = (x * 0.63661977236758134308 + 6755399441055744.0) - 6755399441055744.0;
    const double t = x - k * PIO2_A;
    const double b = k * PIO2_B;
    const double u = t - b;
    const double c = k * PIO2_C;
    const double v = u - c;
    const double rest = (((t - u) - b) + ((u - v) - c)) - k * PIO2_D;
    const double r = v + rest;
    const double r_low = (v - r) + rest;
    const double z = r * r;
    /* Taylor polynomials: the first term left out is below 2e-18 of the result on [-pi/4, pi/4]. */
    const double ps =
        -1.0 / 6 +
        z * (1.0 / 120 +
             z * (-1.0 / 5040 +
                  z * (1.0 / 362880 +
                       z * (-1.0 / 39916800 +
                            z * (1.0 / 6227020800.0 +
                                 z * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)))))));
    const double pc =
        1.0 / 24 +
        z * (-1.0 / 720 +
             z * (1.0 / 40320 + z * (-1.0 / 3628800 + z * (1.0 / 479001600.0 +
                                                           z * (-1.0 / 87178291200.0 +
                                                                z * (1.0 / 20922789888000.0))))));
    const double half = 0.5 * z;
    const double sin_r = r + (r * z * ps + r_low * (1.0 - half));
    const double head = 1.0 - half;
    const double cos_r = head + (((1.0 - head) - half) + (z * z * pc - r * r_low));
    const int quadrant = (int)k & 3;
    const double s = quadrant & 1 ? cos_r : sin_r;
    const double q = quadrant & 1 ? sin_r : cos_r;
    *sine = quadrant & 2 ? -s : s;
    *cosine = (quadrant + 1) & 2 ? -q : q;
}

/* atan(i / 8), i = 0..8, as a double and what it lacks. */
static const double atan_eighths[9][2] = {
    {0.0, 0.0},
    {0.12435499454676144, -3.1253241424539383e-18},
    {0.24497866312686414, 1.0698755618734451e-17},
    {0.35877067027057225, -2.4623815582638635e-17},
    {0.4636476090008061, 2.2698777452961687e-17},
    {0.5585993153435624, -5.4556305485916264e-18},
    {0.6435011087932844, 1.5834785051444286e-17},
    {0.7188299996216245, -2.1478388444456983e-17},
    {0.7853981633974483, 3.061616997868383e-17},
};

/* Angle of (x, y) for 0 <= y <= x: atan(i/8) + atan of the small rest, i/8 near y/x. What does not
 * fit into the result goes to `low`. i = 1 only from 0.1 on: below, its two parts would cancel. */
static double octant_angle(double y, double x, double *low)
{
    const double slope = y / x;
    const int i = slope < 0.1 ? 0 : slope < 0.1875 ? 1 : (int)(8.0 * slope + 0.5);
    const double c = i / 8.0;
    const double t = (y - c * x) / (x + c * y);
    const double z = t * t;
    const double p =
        z * (-1.0 / 3 +
             z * (1.0 / 5 +
                  z * (-1.0 / 7 +
                       z * (1.0 / 9 +
                            z * (-1.0 / 11 + z * (1.0 / 13 + z * (-1.0 / 15 + z * (1.0 / 17))))))));
    const double rest = atan_eighths[i][1] + (t + t * p);
    const double angle = atan_eighths[i][0] + rest;
    *low = (atan_eighths[i][0] - angle) + rest;
    return angle;
}

/* (high + high_low) - (angle + *low), the rest to *low again. */
static double take_from(double high, double high_low, double angle, double *low)
{
    const double difference = high - angle;
    *low = ((high - difference) - angle) + (high_low - *low);
    return difference;
}

double tribo_atan2(double y, double x)
{
    const double ax = absolute(x);
    const double ay = absolute(y);
    if (!(ax - ax == 0.0) || !(ay - ay == 0.0)) {
        return double_of(0x7ff8000000000000u);
    }
    double angle = 0.0;
    double low = 0.0;
    if (greater(ax, ay) > 0.0) {
        const double s = power_of_two(scale_exponent(greater(ax, ay)));
        angle = ay <= ax ? octant_angle(s * ay, s * ax, &low) : octant_angle(s * ax, s * ay, &low);
    }
    if (ay > ax) {
        angle = take_from(1.5707963267948966, 6.123233995736766e-17, angle, &low);
    }
    if (bits_of(x) >> 63) {
        angle = take_from(3.141592653589793, 1.2246467991473532e-16, angle, &low);
    }
    angle += low;
    return bits_of(y) >> 63 ? -angle : angle;
}

double tribo_pow2_scale(double x)
{
    return x == 0.0 ? 1.0 : power_of_two(scale_exponent(x));
}
