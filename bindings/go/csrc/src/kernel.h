/* The arithmetic of one contact, free of branches, so that the scalar functions (contact.c) and the
 * lanes (batch_lanes.c) are one source and give the same bits.
 *
 * Everything here works on a contact matrix and a velocity that were scaled by powers of two to
 * greatest entries in [1, 2). Notation as in contact.h; a = W_nn, w = (n1, n2), S the Schur
 * complement of W_nn. */
#ifndef TRIBO_KERNEL_H
#define TRIBO_KERNEL_H

#include "bits.h"

#include <float.h>
#include <math.h>

/* What becomes of a problem; the first four are the public modes, faults stand in the order in
 * which they are reported. Held in doubles, because lanes select doubles by comparisons of
 * doubles. */
#define KERNEL_OPEN 0.0
#define KERNEL_STICK 1.0
#define KERNEL_SLIP 2.0
#define KERNEL_JAM 3.0
#define KERNEL_ODD 4.0 /* not for the branch-free path: solve.c and contact.c look closer */
#define KERNEL_NOT_FINITE 5.0
#define KERNEL_RANGE 6.0
#define KERNEL_FRICTION 7.0
#define KERNEL_MATRIX 8.0
#define KERNEL_IMMOVABLE 9.0

#define SEMIDEFINITE_TOLERANCE 1e-12
#define SINGULAR_TOLERANCE (8.0 * TRIBO_EPS)
#define FAST_MIN 8.6736173798840355e-19       /* 2^-60: bounds of mu and |b_n| in this file */
#define FAST_MAX 1152921504606846976.0        /* 2^60 */
#define FAST_MIN_DRIVE 7.8886090522101181e-31 /* 2^-100: least |c| but 0 */
#define FAST_CONDITION 0.000244140625         /* 2^-12: least det S / (trace S)^2 */
#define STEP_TOLERANCE 9.5367431640625e-07    /* 2^-20: the next error is the cube */

enum { MAX_HALLEY = 12 };

/* Scaled input of every law: W and the velocity b. */
typedef struct kernel_problem {
    double nn, n1, n2, t11, t12, t22;
    double bn, b1, b2;
    double up, up2; /* p of the caller's problem = (p of the scaled one) * up * up2 */
    double fault;   /* one of the faults above, or KERNEL_OPEN */
} kernel_problem;

/* Scale W and b. up and up2 share the exponent between them, so that no product in between over- or
 * underflows unless the result does. */
TRIBO_ALWAYS_INLINE void kernel_scale(const double w[6], const double b[3], kernel_problem *out)
{
    const double probe = ((w[0] - w[0]) + (w[1] - w[1]) + (w[2] - w[2])) +
                         ((w[3] - w[3]) + (w[4] - w[4]) + (w[5] - w[5])) +
                         ((b[0] - b[0]) + (b[1] - b[1]) + (b[2] - b[2]));
    const double greatest_w = greater(greater(absolute(w[0]), absolute(w[3])), absolute(w[5]));
    const double greatest_off = greater(greater(absolute(w[1]), absolute(w[2])), absolute(w[4]));
    const double greatest_b = greater(greater(absolute(b[0]), absolute(b[1])), absolute(b[2]));
    const uint64_t ew = scale_exponent(greatest_w);
    const uint64_t eb = scale_exponent(greatest_b);
    const double sw = power_of_two(ew);
    const double sb = power_of_two(eb);
    const uint64_t e = ew + 2048u - eb;
    out->nn = sw * w[0];
    out->n1 = sw * w[1];
    out->n2 = sw * w[2];
    out->t11 = sw * w[3];
    out->t12 = sw * w[4];
    out->t22 = sw * w[5];
    out->bn = sb * b[0];
    out->b1 = sb * b[1];
    out->b2 = sb * b[2];
    out->up = power_of_two((e >> 1) - 1u);
    out->up2 = power_of_two(e - (e >> 1) - 1u);
    const int out_of_range = (greatest_w > TRIBO_LARGE) | (greatest_b > TRIBO_LARGE) |
                             ((greatest_w < TRIBO_SMALL) & (greatest_w > 0.0));
    const int negative = (w[0] < 0.0) | (w[3] < 0.0) | (w[5] < 0.0) | (greatest_off > greatest_w);
    double fault = w[0] == 0.0 ? KERNEL_IMMOVABLE : KERNEL_OPEN;
    fault = negative ? KERNEL_MATRIX : fault;
    fault = out_of_range ? KERNEL_RANGE : fault;
    out->fault = probe == 0.0 ? fault : KERNEL_NOT_FINITE;
}

/* Schur complement of W_nn and the sliding that friction is to cancel, in the caller's tangents. */
typedef struct kernel_schur {
    double inverse_a;
    double s11, s12, s22;
    double c1, c2;
} kernel_schur;

TRIBO_ALWAYS_INLINE void kernel_reduce(const kernel_problem *k, kernel_schur *out)
{
    const double inverse_a = 1.0 / k->nn;
    const double l1 = k->n1 * inverse_a;
    const double l2 = k->n2 * inverse_a;
    out->inverse_a = inverse_a;
    out->s11 = k->t11 - l1 * k->n1;
    out->s12 = k->t12 - l1 * k->n2;
    out->s22 = k->t22 - l2 * k->n2;
    out->c1 = l1 * k->bn - k->b1;
    out->c2 = l2 * k->bn - k->b2;
}

/* The slip equation. With D(nu) = det(S + nu 1) = nu^2 + trace nu + det and e = adj(S) c,
 *     D p_t = c nu + e,   a D p_n = -(b_n D + w . (c nu + e)),
 * so mu p_n = |p_t|, times a D, is N(nu) = sqrt(q(nu)) with plain quadratics
 *     N = A nu^2 + B nu + C,   q = alpha nu^2 + 2 beta nu + gamma   (a^2 is inside q).
 * Squaring that into a quartic is what loses digits elsewhere. adj(S) loses eps (trace S)^2 / det
 * S, no more than 1e-12 where det S >= FAST_CONDITION (trace S)^2; bodies of any usual shape have
 * 1e-2. */
typedef struct kernel_slip {
    double inverse_a, bn, n1, n2, c1, c2, e1, e2, trace, det;
    double mu_s, inverse_mu;
    double A, B, C, alpha, beta, gamma;
    double least; /* changes of nu far below this one do not matter */
    double nu;
    double mode; /* OPEN, STICK, SLIP or ODD */
} kernel_slip;

/* First guess of nu; returns sqrt q(0), the side of the equation that sticking is measured against.
 * sqrt q is convex, so its tangents at 0 and at infinity lie below it, and with either in place of
 * sqrt q the slip equation is a quadratic whose greater root lies left of the greatest root wanted.
 * The greater of the two needs 1.4 to 2 steps on average. */
TRIBO_ALWAYS_INLINE double kernel_guess(kernel_slip *e)
{
    const double near_side = sqrt(e->gamma);
    const double far_side = sqrt(e->alpha);
    const double far_rest = e->beta / e->alpha * far_side - e->C;
    const double far_half = 0.5 * (far_side - e->B);
    const double far_square = far_half * far_half + e->A * far_rest;
    const double near_rest = near_side - e->C;
    const double near_half = 0.5 * (e->beta / e->gamma * near_side - e->B);
    const double near_square = near_half * near_half + e->A * near_rest;
    const double inverse_A = 1.0 / e->A;
    const double far_guess = (far_half + sqrt(far_square > 0.0 ? far_square : 0.0)) * inverse_A;
    const double near_guess = (near_half + sqrt(near_square)) * inverse_A;
    e->nu = far_guess > near_guess ? far_guess : near_guess;
    return near_side;
}

TRIBO_ALWAYS_INLINE void kernel_prepare(const kernel_problem *k, double mu_s, double mu_d,
                                        kernel_slip *out)
{
    kernel_schur s;
    kernel_reduce(k, &s);
    const double trace = s.s11 + s.s22;
    const double det = s.s11 * s.s22 - s.s12 * s.s12;
    const double e1 = s.s22 * s.c1 - s.s12 * s.c2;
    const double e2 = s.s11 * s.c2 - s.s12 * s.c1;
    const double base_b = -k->bn * trace - (k->n1 * s.c1 + k->n2 * s.c2);
    const double base_c = -k->bn * det - (k->n1 * e1 + k->n2 * e2);
    const double unit = k->nn * k->nn;

    out->inverse_a = s.inverse_a;
    out->bn = k->bn;
    out->n1 = k->n1;
    out->n2 = k->n2;
    out->c1 = s.c1;
    out->c2 = s.c2;
    out->e1 = e1;
    out->e2 = e2;
    out->trace = trace;
    out->det = det;
    out->mu_s = mu_s;
    out->inverse_mu = 1.0 / mu_d;
    out->A = -mu_d * k->bn;
    out->B = mu_d * base_b;
    out->C = mu_d * base_c;
    out->alpha = unit * (s.c1 * s.c1 + s.c2 * s.c2);
    out->beta = unit * (s.c1 * e1 + s.c2 * e2);
    out->gamma = unit * (e1 * e1 + e2 * e2);
    out->least = FAST_CONDITION * trace; /* no more than the lesser eigenvalue of S */
    const double side = kernel_guess(out);

    const double greatest_c = greater(absolute(s.c1), absolute(s.c2));
    const double least_c = greatest_c > 0.0 ? FAST_MIN_DRIVE : 0.0;
    const double closing = mu_s * base_c >= side ? KERNEL_STICK : KERNEL_SLIP;
    const int usual_size = (-k->bn >= FAST_MIN) & (greatest_c >= least_c);
    const double usual = usual_size ? closing : KERNEL_ODD;
    const double mode = k->bn >= 0.0 ? KERNEL_OPEN : usual;
    const int sound = (det >= FAST_CONDITION * (trace * trace)) & (trace > 0.0) &
                      (mu_d >= FAST_MIN) & (mu_s >= mu_d) & (mu_s <= FAST_MAX) &
                      (k->fault == KERNEL_OPEN);
    out->mode = sound ? mode : KERNEL_ODD;
}

/* One Halley step on mu p_n / |p_t| - 1 = N / sqrt q - 1, nearly linear in nu; cubic convergence
 * for the one square root and one division of Newton's. With T = N' q - N q'/2 the first two
 * derivatives are T / q^1.5 and (T' - 3 T q'/(2q)) / q^1.5. A step beyond 0 ends at 0. Returns 1
 * once a further step cannot change the result. */
TRIBO_ALWAYS_INLINE int kernel_halley(const kernel_slip *e, double *nu)
{
    const double x = *nu;
    const double slope0 = e->A * x + e->B;
    const double numerator = slope0 * x + e->C;
    const double slope = slope0 + e->A * x;
    const double half_q_slope = e->alpha * x + e->beta;
    const double q = (half_q_slope + e->beta) * x + e->gamma;
    const double excess = numerator - sqrt(q);
    const double t = slope * q - numerator * half_q_slope;
    const double t_slope = (e->A + e->A) * q + (slope * half_q_slope - numerator * e->alpha);
    const double bend = q * t_slope - 3.0 * half_q_slope * t;
    const double step = excess * q * t / (0.5 * excess * bend - t * t);
    const double moved = x + step;
    *nu = moved > 0.0 ? moved : 0.0;
    return absolute(step) <= STEP_TOLERANCE * (moved + e->least);
}

/* Impulse of the scaled problem from nu (slip) or nu = 0 (stick). Slip takes p_n from |p_t| = mu
 * p_n, so the cone holds to an ulp or two also where p_n is a small difference; a stick that
 * rounding left just outside of the cone is brought back. */
TRIBO_ALWAYS_INLINE void kernel_finish(const kernel_slip *e, double nu, int slips, double p[3])
{
    const double inverse = 1.0 / ((nu + e->trace) * nu + e->det);
    const double p1 = (e->c1 * nu + e->e1) * inverse;
    const double p2 = (e->c2 * nu + e->e2) * inverse;
    const double length = sqrt(p1 * p1 + p2 * p2);
    const double normal = -(e->bn + (e->n1 * p1 + e->n2 * p2)) * e->inverse_a;
    const double ratio = e->mu_s * normal / length;
    const double capped = ratio < 1.0 ? ratio : 1.0;
    const double f = slips ? 1.0 : capped;
    p[0] = slips ? length * e->inverse_mu : normal;
    p[1] = f * p1;
    p[2] = f * p2;
}

/* The ALGEBRAIC law (contact.h) on a scaled problem whose b is the velocity before the impact. */
typedef struct kernel_algebraic {
    double p[3];
    double kappa;
    double mode;
} kernel_algebraic;

/* From x = S^-1 c, the tangential part of the sticking impulse P_II. */
TRIBO_ALWAYS_INLINE void kernel_scale_algebraic(const kernel_problem *k, double inverse_a,
                                                const double x[2], double mu_s, double mu_d,
                                                double e, double e_t, kernel_algebraic *out)
{
    /* P_I = plastic n, P_II - P_I = (coupling, x). */
    const double plastic = -k->bn * inverse_a;
    const double normal_rest = (1.0 + e) * plastic;
    const double coupling = -(k->n1 * x[0] + k->n2 * x[1]) * inverse_a;
    const double length = sqrt(x[0] * x[0] + x[1] * x[1]);
    const double full = 1.0 + e_t;
    const double full_normal = normal_rest + full * coupling;
    const int sticks = full * length <= mu_s * full_normal;
    /* On the cone, |P_t| = mu P_n exactly: P_t = kappa x, P_n = normal_rest |x| / reach. */
    const double share = normal_rest / (sticks ? 1.0 : length - mu_d * coupling);
    const double kappa = sticks ? full : mu_d * share;
    const double closing = sticks ? KERNEL_STICK : KERNEL_SLIP;
    out->p[0] = sticks ? full_normal : share * length;
    out->p[1] = kappa * x[0];
    out->p[2] = kappa * x[1];
    out->kappa = kappa;
    out->mode = k->bn >= 0.0 ? KERNEL_OPEN : closing;
}

/* x by adj(S) c / det S where S is well conditioned; ODD elsewhere and for bad coefficients. */
TRIBO_ALWAYS_INLINE void kernel_solve_algebraic(const kernel_problem *k, double mu_s, double mu_d,
                                                double e, double e_t, kernel_algebraic *out)
{
    kernel_schur s;
    kernel_reduce(k, &s);
    const double trace = s.s11 + s.s22;
    const double det = s.s11 * s.s22 - s.s12 * s.s12;
    const double inverse = 1.0 / det;
    const double x[2] = {(s.s22 * s.c1 - s.s12 * s.c2) * inverse,
                         (s.s11 * s.c2 - s.s12 * s.c1) * inverse};
    kernel_scale_algebraic(k, s.inverse_a, x, mu_s, mu_d, e, e_t, out);
    const int sound = (det >= FAST_CONDITION * (trace * trace)) & (trace > 0.0) & (mu_d >= 0.0) &
                      (mu_s >= mu_d) & (mu_s <= DBL_MAX) & (e >= 0.0) & (e <= 1.0) & (e_t >= -1.0) &
                      (e_t <= 1.0) & (k->fault == KERNEL_OPEN);
    out->mode = sound ? out->mode : KERNEL_ODD;
}

/* What the inertia of one body adds to W: x_k . J x_l with x_k = R^T (r x n_k), in body axes. A
 * diagonal J saves products with zero, which change no bit but the signs of zeros. */
TRIBO_ALWAYS_INLINE void kernel_mobility(const double r[9], const double j[6], int diagonal,
                                         const double arm[3], const double frame[9], double out[6])
{
    double x[3][3];
    double z[3][3];
    for (int k = 0; k < 3; k++) {
        const double n0 = frame[3 * k];
        const double n1 = frame[3 * k + 1];
        const double n2 = frame[3 * k + 2];
        const double c0 = arm[1] * n2 - arm[2] * n1;
        const double c1 = arm[2] * n0 - arm[0] * n2;
        const double c2 = arm[0] * n1 - arm[1] * n0;
        const double x0 = r[0] * c0 + r[3] * c1 + r[6] * c2;
        const double x1 = r[1] * c0 + r[4] * c1 + r[7] * c2;
        const double x2 = r[2] * c0 + r[5] * c1 + r[8] * c2;
        x[k][0] = x0;
        x[k][1] = x1;
        x[k][2] = x2;
        z[k][0] = diagonal ? j[0] * x0 : j[0] * x0 + j[1] * x1 + j[2] * x2;
        z[k][1] = diagonal ? j[3] * x1 : j[1] * x0 + j[3] * x1 + j[4] * x2;
        z[k][2] = diagonal ? j[5] * x2 : j[2] * x0 + j[4] * x1 + j[5] * x2;
    }
    out[0] = x[0][0] * z[0][0] + x[0][1] * z[0][1] + x[0][2] * z[0][2];
    out[1] = x[0][0] * z[1][0] + x[0][1] * z[1][1] + x[0][2] * z[1][2];
    out[2] = x[0][0] * z[2][0] + x[0][1] * z[2][1] + x[0][2] * z[2][2];
    out[3] = x[1][0] * z[1][0] + x[1][1] * z[1][1] + x[1][2] * z[1][2];
    out[4] = x[1][0] * z[2][0] + x[1][1] * z[2][1] + x[1][2] * z[2][2];
    out[5] = x[2][0] * z[2][0] + x[2][1] * z[2][1] + x[2][2] * z[2][2];
}

/* W of the two bodies' mobilities: the bodies first, so that exchanging them changes no bit. The
 * added 0 leaves no entry -0, whichever body adds nothing. */
TRIBO_ALWAYS_INLINE void kernel_join(double inverse_mass, const double of_a[6],
                                     const double of_b[6], double w[6])
{
    w[0] = inverse_mass + (of_a[0] + of_b[0]);
    w[1] = 0.0 + (of_a[1] + of_b[1]);
    w[2] = 0.0 + (of_a[2] + of_b[2]);
    w[3] = inverse_mass + (of_a[3] + of_b[3]);
    w[4] = 0.0 + (of_a[4] + of_b[4]);
    w[5] = inverse_mass + (of_a[5] + of_b[5]);
}

#endif
