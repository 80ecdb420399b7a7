/* References in long double; see reference.h. */
#include "reference.h"

#include <math.h>

/* ---- references --------------------------------------------------------------------------- */

double norm3(const double v[3])
{
    const long double x = (long double)v[0];
    const long double y = (long double)v[1];
    const long double z = (long double)v[2];
    return (double)sqrtl(x * x + y * y + z * z);
}

double norm2(const double v[2])
{
    const double padded[3] = {v[0], v[1], 0.0};
    return norm3(padded);
}

double distance3(const double a[3], const double b[3])
{
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        const long double d = (long double)a[i] - (long double)b[i];
        square += d * d;
    }
    return (double)sqrtl(square);
}

/* One Jacobi rotation that zeroes m[i][j]. */
static void jacobi_turn(long double m[3][3], int i, int j)
{
    const int k = 3 - i - j;
    if (m[i][j] == 0.0L) {
        return;
    }
    const long double theta = (m[j][j] - m[i][i]) / (2.0L * m[i][j]);
    const long double t = (theta < 0.0L ? -1.0L : 1.0L) / (fabsl(theta) + hypotl(1.0L, theta));
    const long double c = 1.0L / hypotl(1.0L, t);
    const long double s = t * c;
    const long double mik = m[i][k];
    const long double mjk = m[j][k];
    m[i][i] -= t * m[i][j];
    m[j][j] += t * m[i][j];
    m[i][j] = m[j][i] = 0.0L;
    m[i][k] = m[k][i] = c * mik - s * mjk;
    m[j][k] = m[k][j] = s * mik + c * mjk;
}

void reference_eigenvalues(const double w[6], double values[3])
{
    long double m[3][3] = {{(long double)w[0], (long double)w[1], (long double)w[2]},
                           {(long double)w[1], (long double)w[3], (long double)w[4]},
                           {(long double)w[2], (long double)w[4], (long double)w[5]}};
    for (int sweep = 0; sweep < 12; sweep++) {
        jacobi_turn(m, 0, 1);
        jacobi_turn(m, 0, 2);
        jacobi_turn(m, 1, 2);
    }
    for (int i = 0; i < 3; i++) {
        values[i] = (double)m[i][i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = i + 1; j < 3; j++) {
            if (values[j] < values[i]) {
                const double swap = values[i];
                values[i] = values[j];
                values[j] = swap;
            }
        }
    }
}

double reference_condition(const double w[6])
{
    double values[3];
    reference_eigenvalues(w, values);
    return values[0] > 0.0 ? values[2] / values[0] : HUGE_VAL;
}

void reference_rotation(const double q[4], long double r[9])
{
    const long double w = (long double)q[0];
    const long double x = (long double)q[1];
    const long double y = (long double)q[2];
    const long double z = (long double)q[3];
    const long double s = 2.0L / (w * w + x * x + y * y + z * z);
    r[0] = 1.0L - s * (y * y + z * z);
    r[1] = s * (x * y - w * z);
    r[2] = s * (x * z + w * y);
    r[3] = s * (x * y + w * z);
    r[4] = 1.0L - s * (z * z + x * x);
    r[5] = s * (y * z - w * x);
    r[6] = s * (x * z - w * y);
    r[7] = s * (y * z + w * x);
    r[8] = 1.0L - s * (x * x + y * y);
}

static void multiply(const long double a[9], const long double b[9], long double out[9])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
}

static void transpose(const long double a[9], long double out[9])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = a[3 * j + i];
        }
    }
}

/* (1/m) 1 - S(r) R I^-1 R^T S(r), in world axes. */
static void add_body(const tribo_body *body, const double arm[3], long double k[9], double *bound)
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const long double x = (long double)arm[0];
    const long double y = (long double)arm[1];
    const long double z = (long double)arm[2];
    const long double skew[9] = {0.0L, -z, y, z, 0.0L, -x, -y, x, 0.0L};
    long double r[9];
    long double rt[9];
    long double inertia[9];
    long double left[9];
    long double right[9];
    double values[3];
    reference_rotation(body->orientation, r);
    transpose(r, rt);
    for (int i = 0; i < 9; i++) {
        inertia[i] = (long double)body->inverse_inertia[full[i]];
    }
    multiply(r, inertia, left);
    multiply(left, rt, inertia);
    multiply(skew, inertia, left);
    multiply(left, skew, right);
    for (int i = 0; i < 9; i++) {
        k[i] += (i % 4 == 0 ? (long double)body->inverse_mass : 0.0L) - right[i];
    }
    reference_eigenvalues(body->inverse_inertia, values);
    *bound += body->inverse_mass + (double)(x * x + y * y + z * z) * values[2];
}

void reference_matrix(const scene *s, const double frame[9], double w[6], double *bound)
{
    static const int place[6] = {0, 1, 2, 4, 5, 8};
    long double k[9] = {0};
    long double n[9];
    long double nt[9];
    long double left[9];
    long double out[9];
    *bound = 0.0;
    add_body(&s->a, s->contact.arm_a, k, bound);
    if (s->has_b) {
        add_body(&s->b, s->contact.arm_b, k, bound);
    }
    for (int i = 0; i < 9; i++) {
        n[i] = (long double)frame[i];
    }
    transpose(n, nt);
    multiply(n, k, left);
    multiply(left, nt, out);
    for (int i = 0; i < 6; i++) {
        w[i] = (double)out[place[i]];
    }
}

static void velocity_of(const double w[6], const double b[3], const double p[3], long double v[3])
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 3; i++) {
        v[i] = (long double)b[i];
        for (int j = 0; j < 3; j++) {
            v[i] += (long double)w[full[3 * i + j]] * (long double)p[j];
        }
    }
}

void reference_velocity(const double w[6], const double b[3], const double p[3], double v[3])
{
    long double exact[3];
    velocity_of(w, b, p, exact);
    for (int i = 0; i < 3; i++) {
        v[i] = (double)exact[i];
    }
}

static double greatest_diagonal(const double w[6])
{
    double most = w[0] > w[3] ? w[0] : w[3];
    return most > w[5] ? most : w[5];
}

double reference_scale(const double w[6], const double b[3], const double p[3], double *impulse)
{
    static const double zero[3] = {0, 0, 0};
    double positive[6];
    double size[3];
    double sum[3];
    for (int i = 0; i < 6; i++) {
        positive[i] = fabs(w[i]);
    }
    for (int i = 0; i < 3; i++) {
        size[i] = fabs(p[i]);
    }
    reference_velocity(positive, zero, size, sum);
    const double v = norm3(b) + norm3(sum);
    *impulse = v / greatest_diagonal(w);
    return v;
}

/* Nearest point of the cone |x_t| <= mu x_n. */
static void project(long double mu, long double x[3])
{
    const long double t = sqrtl(x[1] * x[1] + x[2] * x[2]);
    if (x[0] >= 0.0L && t <= mu * x[0]) {
        return;
    }
    if (mu * t + x[0] <= 0.0L) {
        x[0] = x[1] = x[2] = 0.0L;
        return;
    }
    const long double n = (x[0] + mu * t) / (1.0L + mu * mu);
    x[0] = n;
    x[1] *= mu * n / t;
    x[2] *= mu * n / t;
}

double reference_eta(const double w[6], const double b[3], double mu, const double p[3])
{
    double impulse;
    long double v[3];
    long double x[3];
    if (reference_scale(w, b, p, &impulse) == 0.0) {
        return 0.0;
    }
    const long double rho =
        1.0L / ((long double)greatest_diagonal(w) * (mu > 1.0 ? (long double)mu : 1.0L));
    velocity_of(w, b, p, v);
    v[0] += (long double)mu * sqrtl(v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++) {
        x[i] = (long double)p[i] - rho * v[i];
    }
    project((long double)mu, x);
    for (int i = 0; i < 3; i++) {
        x[i] -= (long double)p[i];
    }
    return (double)(sqrtl(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) / (long double)impulse);
}

int reference_unique(const double w[6], double mu)
{
    const double s00 = w[3] - w[1] * w[1] / w[0];
    const double s01 = w[4] - w[1] * w[2] / w[0];
    const double s11 = w[5] - w[2] * w[2] / w[0];
    const double half = 0.5 * (s00 + s11);
    const double radius = hypot(0.5 * (s00 - s11), s01);
    const double ratio = (half - radius) / (half + radius);
    if (!(ratio > 0.0)) {
        return 0;
    }
    return mu * hypot(w[1], w[2]) / w[0] < 0.9 * 2.0 * sqrt(ratio) / (1.0 + ratio);
}

int reference_solve(const double s[6], const long double x[3], long double out[3])
{
    const long double a = sqrtl((long double)s[0]);
    const long double b = (long double)s[1] / a;
    const long double c = (long double)s[2] / a;
    const long double d = sqrtl((long double)s[3] - b * b);
    const long double e = ((long double)s[4] - b * c) / d;
    const long double f = sqrtl((long double)s[5] - c * c - e * e);
    if (!(a > 0.0L && d > 0.0L && f > 0.0L)) {
        return 0;
    }
    const long double y0 = x[0] / a;
    const long double y1 = (x[1] - b * y0) / d;
    const long double y2 = (x[2] - c * y0 - e * y1) / f;
    out[2] = y2 / f;
    out[1] = (y1 - e * out[2]) / d;
    out[0] = (y0 - b * out[1] - c * out[2]) / a;
    return 1;
}

int reference_spin(const tribo_body *body, double out[3], double *energy)
{
    long double r[9];
    long double w[3] = {0};
    long double l[3];
    reference_rotation(body->orientation, r);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            w[i] += r[3 * k + i] * (long double)(body->angular_velocity[k]);
        }
    }
    if (!reference_solve(body->inverse_inertia, w, l)) {
        return 0;
    }
    *energy = (double)(0.5L * (w[0] * l[0] + w[1] * l[1] + w[2] * l[2]));
    for (int i = 0; i < 3; i++) {
        out[i] = (double)(r[3 * i] * l[0] + r[3 * i + 1] * l[1] + r[3 * i + 2] * l[2]);
    }
    return 1;
}
