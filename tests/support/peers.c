#include "peers.h"

#include <math.h>
#include <string.h>

enum { NEWTON_STEPS = 100, ROOT_STEPS = 100 };

const char *peer_name(uint32_t peer)
{
    static const char *const names[PEERS] = {"quartic, plain", "quartic, Ferrari",
                                             "quartic, Durand-Kerner", "Alart-Curnier Newton",
                                             "Alart-Curnier + Armijo"};
    return peer < PEERS ? names[peer] : "?";
}

/* ---- quartic --------------------------------------------------------------------------------- */

/* The slip problem with cleared denominators, D = det(T + nu 1) = nu^2 + d1 nu + d0:
 * D p_n = a2 nu^2 + a1 nu + a0, D p_t = c nu + e, and mu^2 (D p_n)^2 = |D p_t|^2. */
typedef struct slip_polynomials {
    double d[2];
    double a[3];
    double c[2];
    double e[2];
    double q[5]; /* lowest power first */
} slip_polynomials;

static void expand_slip(const double w[6], const double b[3], double mu, slip_polynomials *out)
{
    const double t11 = w[3] - w[1] * w[1] / w[0];
    const double t12 = w[4] - w[1] * w[2] / w[0];
    const double t22 = w[5] - w[2] * w[2] / w[0];
    double *a = out->a;
    double *c = out->c;
    double *e = out->e;
    c[0] = w[1] * b[0] / w[0] - b[1];
    c[1] = w[2] * b[0] / w[0] - b[2];
    e[0] = t22 * c[0] - t12 * c[1];
    e[1] = t11 * c[1] - t12 * c[0];
    out->d[0] = t11 * t22 - t12 * t12;
    out->d[1] = t11 + t22;
    a[0] = -(b[0] * out->d[0] + w[1] * e[0] + w[2] * e[1]) / w[0];
    a[1] = -(b[0] * out->d[1] + w[1] * c[0] + w[2] * c[1]) / w[0];
    a[2] = -b[0] / w[0];
    const double m = mu * mu;
    out->q[0] = m * a[0] * a[0] - (e[0] * e[0] + e[1] * e[1]);
    out->q[1] = 2.0 * (m * a[0] * a[1] - (c[0] * e[0] + c[1] * e[1]));
    out->q[2] = m * (a[1] * a[1] + 2.0 * a[0] * a[2]) - (c[0] * c[0] + c[1] * c[1]);
    out->q[3] = 2.0 * m * a[1] * a[2];
    out->q[4] = m * a[2] * a[2];
}

/* Greatest real root of x^3 + a x^2 + b x + c. */
static double cubic_root(double a, double b, double c)
{
    const double third = a / 3.0;
    const double p = b / 3.0 - third * third;
    const double q = third * third * third - third * b / 2.0 + c / 2.0;
    const double discriminant = q * q + p * p * p;
    if (discriminant > 0.0) {
        const double r = cbrt(fabs(q) + sqrt(discriminant));
        const double s = r > 0.0 ? r - p / r : 0.0;
        return (q > 0.0 ? -s : s) - third;
    }
    const double radius = sqrt(-p);
    const double ratio = radius > 0.0 ? -q / (radius * radius * radius) : 0.0;
    const double angle = acos(ratio > 1.0 ? 1.0 : (ratio < -1.0 ? -1.0 : ratio));
    return 2.0 * radius * cos(angle / 3.0) - third;
}

static size_t quadratic_roots(double half_b, double c, double shift, double roots[2])
{
    const double discriminant = half_b * half_b - c;
    /* a pair that rounding parted from the real axis still counts */
    if (discriminant < -1e-10 * (half_b * half_b + fabs(c))) {
        return 0;
    }
    const double root = sqrt(discriminant > 0.0 ? discriminant : 0.0);
    const double far_root = half_b > 0.0 ? -half_b - root : -half_b + root;
    roots[0] = far_root + shift;
    roots[1] = (fabs(far_root) > 0.0 ? c / far_root : 0.0) + shift;
    return 2;
}

/* Real roots of a monic quartic x^4 + m3 x^3 + m2 x^2 + m1 x + m0. */
static size_t ferrari(const double m[4], double roots[4])
{
    const double shift = -m[3] / 4.0;
    const double s2 = m[3] * m[3];
    const double p = m[2] - 3.0 * s2 / 8.0;
    const double q = m[1] - m[3] * m[2] / 2.0 + s2 * m[3] / 8.0;
    const double r = m[0] - m[3] * m[1] / 4.0 + s2 * m[2] / 16.0 - 3.0 * s2 * s2 / 256.0;
    const double z = cubic_root(2.0 * p, p * p - 4.0 * r, -q * q);
    if (!(z > 0.0)) {
        double squares[2];
        size_t count = 0;
        const size_t pairs = quadratic_roots(p / 2.0, r, 0.0, squares);
        for (size_t k = 0; k < pairs; k++) {
            if (squares[k] >= 0.0) {
                roots[count++] = shift + sqrt(squares[k]);
                roots[count++] = shift - sqrt(squares[k]);
            }
        }
        return count;
    }
    const double u = sqrt(z);
    size_t count = quadratic_roots(u / 2.0, (p + z - q / u) / 2.0, shift, roots);
    count += quadratic_roots(-u / 2.0, (p + z + q / u) / 2.0, shift, roots + count);
    return count;
}

/* The same by simultaneous iteration on all four complex roots. */
static size_t durand_kerner(const double m[4], double roots[4], uint32_t *steps)
{
    double x[4] = {1.0, 0.4, -0.65, -0.908};
    double y[4] = {0.0, 0.9, 0.72, -0.297};
    size_t count = 0;
    double move = 1.0;
    for (*steps = 0; *steps < ROOT_STEPS && move > 1e-15; (*steps)++) {
        move = 0.0;
        for (size_t k = 0; k < 4; k++) {
            double re = x[k] + m[3];
            double im = y[k];
            double dre = 1.0;
            double dim = 0.0;
            for (size_t l = 3; l-- > 0;) {
                const double next = re * x[k] - im * y[k] + m[l];
                im = re * y[k] + im * x[k];
                re = next;
            }
            for (size_t l = 0; l < 4; l++) {
                if (l != k) {
                    const double a = x[k] - x[l];
                    const double c = y[k] - y[l];
                    const double next = dre * a - dim * c;
                    dim = dre * c + dim * a;
                    dre = next;
                }
            }
            const double square = dre * dre + dim * dim;
            const double sx = (re * dre + im * dim) / square;
            const double sy = (im * dre - re * dim) / square;
            const double size = fabs(sx) + fabs(sy);
            x[k] -= sx;
            y[k] -= sy;
            move = size > move ? size : move;
        }
    }
    for (size_t k = 0; k < 4; k++) {
        if (fabs(y[k]) < 1e-10 * (1.0 + fabs(x[k]))) {
            roots[count++] = x[k];
        }
    }
    return count;
}

static double polish(const double q[5], double x)
{
    for (int k = 0; k < 2; k++) {
        const double value = (((q[4] * x + q[3]) * x + q[2]) * x + q[1]) * x + q[0];
        const double slope = ((4.0 * q[4] * x + 3.0 * q[3]) * x + 2.0 * q[2]) * x + q[1];
        const double next = x - value / slope;
        x = next > 0.0 && next < HUGE_VAL ? next : x;
    }
    return x;
}

/* Impulse of the positive root that fits the cone best, or of the first one as it stands. */
static void choose(const slip_polynomials *slip, double mu, int plain, size_t count,
                   const double *roots, double scale, double p[3])
{
    double least = HUGE_VAL;
    for (size_t k = 0; k < count; k++) {
        const double nu = plain ? roots[k] : polish(slip->q, roots[k] * scale);
        const double divisor = (nu + slip->d[1]) * nu + slip->d[0];
        const double normal = ((slip->a[2] * nu + slip->a[1]) * nu + slip->a[0]) / divisor;
        const double t1 = (slip->c[0] * nu + slip->e[0]) / divisor;
        const double t2 = (slip->c[1] * nu + slip->e[1]) / divisor;
        const double miss = fabs(mu * normal - sqrt(t1 * t1 + t2 * t2)) / normal;
        if (nu > 0.0 && normal > 0.0 && miss < least) {
            least = plain ? 0.0 : miss;
            p[0] = normal;
            p[1] = t1;
            p[2] = t2;
        }
    }
}

/* A bound on the roots' size; with it as unit of nu no threshold has a dimension. */
static double size_of_roots(const double q[5])
{
    double scale = fabs(q[3] / q[4]);
    scale = fmax(scale, sqrt(fabs(q[2] / q[4])));
    scale = fmax(scale, cbrt(fabs(q[1] / q[4])));
    return fmax(scale, sqrt(sqrt(fabs(q[0] / q[4]))));
}

static uint32_t solve_quartic(uint32_t peer, const double w[6], const double b[3], double mu,
                              double p[3])
{
    slip_polynomials slip;
    double roots[4];
    uint32_t steps = 0;
    expand_slip(w, b, mu, &slip);
    const double *q = slip.q;
    /* stick is the root nu = 0 */
    const double s[3] = {slip.a[0] / slip.d[0], slip.e[0] / slip.d[0], slip.e[1] / slip.d[0]};
    if (s[0] >= 0.0 && sqrt(s[1] * s[1] + s[2] * s[2]) <= mu * s[0]) {
        memcpy(p, s, sizeof s);
        return 0;
    }
    p[0] = -b[0] / w[0];
    p[1] = p[2] = 0.0;
    const int plain = peer == PEER_QUARTIC_PLAIN;
    const double scale = plain ? 1.0 : size_of_roots(q);
    double monic[4];
    double power = 1.0;
    for (size_t k = 4; k-- > 0;) {
        power *= scale;
        monic[k] = q[k] / q[4] / power;
    }
    const size_t count = peer == PEER_QUARTIC_DURAND_KERNER ? durand_kerner(monic, roots, &steps)
                                                            : ferrari(monic, roots);
    choose(&slip, mu, plain, count, roots, scale, p);
    return steps;
}

/* ---- Alart-Curnier --------------------------------------------------------------------------- */

/* F(p) = (p_n - max(0, y_n), p_t - projection of y_t onto the disc of radius mu max(0, y_n)), with
 * y = p - rho (W p + b), and its generalised Jacobian. */
static void alart_curnier(const double w[6], const double b[3], double mu, const double rho[3],
                          const double p[3], double f[3], double jacobian[9])
{
    const double rows[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    double y[3];
    double dy[9];
    for (size_t i = 0; i < 3; i++) {
        y[i] = p[i] - rho[i] * (tribo_vec3_dot(rows + 3 * i, p) + b[i]);
        for (size_t j = 0; j < 3; j++) {
            dy[3 * i + j] = (i == j ? 1.0 : 0.0) - rho[i] * rows[3 * i + j];
        }
    }
    const double active = y[0] > 0.0 ? 1.0 : 0.0;
    const double radius = mu * active * y[0];
    const double size = sqrt(y[1] * y[1] + y[2] * y[2]);
    const double shrink = size <= radius ? 1.0 : radius / size;
    const double d[2] = {size > radius ? y[1] / size : 0.0, size > radius ? y[2] / size : 0.0};
    f[0] = p[0] - active * y[0];
    f[1] = p[1] - shrink * y[1];
    f[2] = p[2] - shrink * y[2];
    for (size_t j = 0; j < 3; j++) {
        const double along = d[0] * dy[3 + j] + d[1] * dy[6 + j];
        const double grow = mu * active * dy[j] - shrink * along;
        jacobian[j] = -active * dy[j];
        jacobian[3 + j] = -(d[0] * grow + shrink * dy[3 + j]);
        jacobian[6 + j] = -(d[1] * grow + shrink * dy[6 + j]);
        jacobian[4 * j] += 1.0;
    }
}

/* x = a^-1 y by cofactors; 0 if the result is not finite. */
static int solve3(const double a[9], const double y[3], double x[3])
{
    double c[9];
    tribo_vec3_cross(a + 3, a + 6, c);
    tribo_vec3_cross(a + 6, a, c + 3);
    tribo_vec3_cross(a, a + 3, c + 6);
    const double determinant = tribo_vec3_dot(a, c);
    double size = 0.0;
    for (size_t i = 0; i < 3; i++) {
        x[i] = (c[i] * y[0] + c[3 + i] * y[1] + c[6 + i] * y[2]) / determinant;
        size += fabs(x[i]);
    }
    return size < HUGE_VAL;
}

static uint32_t solve_newton(uint32_t peer, const double w[6], const double b[3], double mu,
                             double p[3])
{
    const double half = 0.5 * (w[3] - w[5]);
    const double tangential = 0.5 * (w[3] + w[5]) + sqrt(half * half + w[4] * w[4]);
    const double rho[3] = {1.0 / w[0], 1.0 / tangential, 1.0 / tangential};
    const double size = sqrt(tribo_vec3_dot(b, b)) / fmax(w[0], tangential);
    double f[3];
    double jacobian[9];
    uint32_t steps = 0;
    p[0] = -b[0] / w[0];
    p[1] = p[2] = 0.0;
    alart_curnier(w, b, mu, rho, p, f, jacobian);
    double square = tribo_vec3_dot(f, f);
    while (steps < NEWTON_STEPS && square > 1e-24 * size * size) {
        double step[3];
        double next[3];
        double next_square = HUGE_VAL;
        double length = -1.0;
        steps++;
        if (!solve3(jacobian, f, step)) {
            return steps;
        }
        for (int k = 0; k < 12; k++) {
            tribo_vec3_add_scaled(p, length, step, next);
            alart_curnier(w, b, mu, rho, next, f, jacobian);
            next_square = tribo_vec3_dot(f, f);
            if (peer == PEER_NEWTON || next_square <= (1.0 + 2e-4 * length) * square) {
                break;
            }
            length *= 0.5;
        }
        memcpy(p, next, sizeof next);
        square = next_square;
    }
    return steps;
}

uint32_t peer_solve(uint32_t peer, const double w[6], const double b[3], double mu, double p[3])
{
    if (b[0] >= 0.0) {
        p[0] = p[1] = p[2] = 0.0;
        return 0;
    }
    return peer <= PEER_QUARTIC_DURAND_KERNER ? solve_quartic(peer, w, b, mu, p)
                                              : solve_newton(peer, w, b, mu, p);
}
