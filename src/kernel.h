/* The arithmetic of one contact, free of branches, so that the scalar functions (contact.c) and the lanes
 * (batch_lanes.c) are one source and give the same bits.
 *
 * Everything here works on a contact matrix and a velocity that were scaled by powers of two to greatest
 * entries in [1, 2). Notation as in contact.h; a = W_nn, S the Schur complement of W_nn, lam1 >= lam2 its
 * eigenvalues, (ex, ey) the eigenvector of lam1 of length 1 / sqrt(shrink), c and w in that basis. */
#ifndef TRIBO_KERNEL_H
#define TRIBO_KERNEL_H

#include "bits.h"

#include <math.h>

/* What becomes of a problem; the first three are the public modes, faults stand in the order in which they
 * are reported. Held in doubles, because lanes select doubles by comparisons of doubles. */
#define KERNEL_OPEN 0.0
#define KERNEL_STICK 1.0
#define KERNEL_SLIP 2.0
#define KERNEL_JAM 3.0
#define KERNEL_SLOW 4.0 /* outside of what the fast iteration is proven for: bisect */
#define KERNEL_FREE 5.0 /* no friction at all: slides, p_t = 0 */
#define KERNEL_NOT_FINITE 6.0
#define KERNEL_RANGE 7.0
#define KERNEL_FRICTION 8.0
#define KERNEL_RESTITUTION 9.0
#define KERNEL_MATRIX 10.0
#define KERNEL_IMMOVABLE 11.0

#define SEMIDEFINITE_TOLERANCE 1e-12
#define SINGULAR_TOLERANCE (8.0 * TRIBO_EPS)
#define FAST_MIN 8.6736173798840355e-19     /* 2^-60: bounds of mu and |b_n| for the fast iteration */
#define FAST_MAX 1152921504606846976.0      /* 2^60 */
#define FAST_MIN_DRIVE 7.8886090522101181e-31 /* 2^-100: least |c| */
#define ISOTROPIC 1e-100              /* difference of eigenvalues that counts as none */
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

/* The slip equation N(nu) = sqrt(q(nu)) in the eigenbasis of S, where numerator and square are plain
 * quadratics (both sides of mu p_n = |p_t|, times a det(S + nu 1)):
 *   N = A nu^2 + B nu + C,  q = alpha nu^2 + 2 beta nu + gamma.
 * Each coefficient is a sum that cancels no more than the law itself does; squaring the equation into
 * a quartic is what loses digits. */
typedef struct kernel_slip {
    double inverse_a, bn, mu_s, inverse_mu;
    double lam1, lam2, ex, ey, shrink, c1, c2, w1, w2;
    double A, B, C, alpha, beta, gamma;
    double nu;
    double mode; /* one of the above */
} kernel_slip;

TRIBO_ALWAYS_INLINE void kernel_prepare(const kernel_problem *k, double mu_s, double mu_d,
                                        kernel_slip *out)
{
    kernel_schur s;
    kernel_reduce(k, &s);

    /* Eigenvectors without cancellation: (x, s12), x = r + |d|, is along lam1 if d >= 0, across it else. They
     * stay as long as they are; where two of them meet, 1 / length^2 makes up for it. Where S is a multiple
     * of 1, to more digits than there are, any direction will do. */
    const double trace = s.s11 + s.s22;
    const double d = 0.5 * (s.s11 - s.s22);
    const double r = sqrt(d * d + s.s12 * s.s12);
    const double x_raw = r + absolute(d);
    const int distinct = x_raw > ISOTROPIC;
    const double x = distinct ? x_raw : 1.0;
    const double y = distinct ? s.s12 : 0.0;
    const double shrink = 1.0 / (x * x + y * y);
    const double ex = d >= 0.0 ? x : y;
    const double ey = d >= 0.0 ? y : x;
    const double lam1_raw = 0.5 * trace + r;
    const double determinant = s.s11 * s.s22 - s.s12 * s.s12;
    const double lam2_raw = determinant / (lam1_raw > 0.0 ? lam1_raw : 1.0);

    /* What rounding leaves of a singular S counts as zero; a part of c along its null space likewise. */
    const double size = k->t11 + k->t22;
    const double drive = absolute(k->b1) + absolute(k->b2) +
                         (absolute(k->n1) + absolute(k->n2)) * s.inverse_a * absolute(k->bn);
    const double nothing = SINGULAR_TOLERANCE * size;
    const double no_drive = SINGULAR_TOLERANCE * drive;
    const double c1_raw = mu_s == 0.0 ? 0.0 : ex * s.c1 + ey * s.c2;
    const double c2_raw = mu_s == 0.0 ? 0.0 : ex * s.c2 - ey * s.c1;
    const int singular1 = lam1_raw <= nothing;
    const int singular2 = lam2_raw <= nothing;
    const double lam1 = singular1 ? 0.0 : lam1_raw;
    const double lam2 = singular2 ? 0.0 : lam2_raw;
    const double least_c = no_drive * x;
    const double c1_clean = absolute(c1_raw) <= least_c ? 0.0 : c1_raw;
    const double c2_clean = absolute(c2_raw) <= least_c ? 0.0 : c2_raw;
    const double c1 = singular1 ? c1_clean : c1_raw;
    const double c2 = singular2 ? c2_clean : c2_raw;
    const double w1 = ex * k->n1 + ey * k->n2;
    const double w2 = ex * k->n2 - ey * k->n1;

    /* q is taken times a^2, so that the other side of the equation is sqrt q alone. */
    const double coupling1 = w1 * c1 * shrink;
    const double coupling2 = w2 * c2 * shrink;
    const double unit = k->nn * k->nn * shrink;
    const double square1 = c1 * c1 * unit;
    const double square2 = c2 * c2 * unit;
    const double alpha = square1 + square2;
    const double beta = square1 * lam2 + square2 * lam1;
    const double gamma = square1 * (lam2 * lam2) + square2 * (lam1 * lam1);
    const double base_a = -k->bn;
    const double base_b = (base_a * (lam1 + lam2) - coupling1) - coupling2;
    const double base_c = (base_a * (lam1 * lam2) - coupling1 * lam2) - coupling2 * lam1;
    const double A = mu_d * base_a;
    const double B = mu_d * base_b;
    const double C = mu_d * base_c;
    const double side = sqrt(gamma);

    /* First guess. sqrt q is convex, so its tangents at 0 and at infinity lie below it, and with either in
     * place of sqrt q the slip equation is a quadratic whose greater root lies left of the greatest
     * root wanted. The greater of the two needs 1.4 to 2 steps on average. */
    const double far_side = sqrt(alpha);
    const double far_rest = beta / far_side - C;
    const double far_half = 0.5 * (far_side - B);
    const double far_square = far_half * far_half + A * far_rest;
    const double near_rest = side - C;
    const double near_half = 0.5 * (beta / side - B);
    const double near_square = near_half * near_half + A * near_rest;
    const double inverse_A = 1.0 / A;
    const double far_guess = (far_half + sqrt(far_square > 0.0 ? far_square : 0.0)) * inverse_A;
    const double near_guess = (near_half + sqrt(near_square)) * inverse_A;
    const double guess = far_guess > near_guess ? far_guess : near_guess;

    out->inverse_a = s.inverse_a;
    out->bn = k->bn;
    out->mu_s = mu_s;
    out->inverse_mu = 1.0 / mu_d;
    out->lam1 = lam1;
    out->lam2 = lam2;
    out->ex = ex;
    out->ey = ey;
    out->shrink = shrink;
    out->c1 = c1;
    out->c2 = c2;
    out->w1 = w1;
    out->w2 = w2;
    out->A = A;
    out->B = B;
    out->C = C;
    out->alpha = alpha;
    out->beta = beta;
    out->gamma = gamma;
    out->nu = guess > 0.0 ? guess : lam1;

    /* Stick needs S to be invertible where c asks for it. Without it, friction that grows at least as fast
     * as the slip it fights (N >= a sqrt q as nu -> 0) leaves no bounded solution. */
    const double greatest_c = greater(absolute(c1), absolute(c2));
    const int fast = (mu_d >= FAST_MIN) & (mu_s <= FAST_MAX) & (-k->bn >= FAST_MIN) &
                     (greatest_c >= FAST_MIN_DRIVE * x);
    const int within = mu_s * base_c >= side;
    const double immobile_drive =
        (singular1 ? absolute(c1) : 0.0) + (singular2 ? absolute(c2) : 0.0);
    const double friction_gain = singular1 ? B : C;
    const double sliding_gain = singular1 ? far_side : side;
    double mode = within ? KERNEL_STICK : KERNEL_SLIP;
    const double without = friction_gain >= sliding_gain ? KERNEL_JAM : KERNEL_SLIP;
    mode = immobile_drive > 0.0 ? without : mode;
    mode = fast ? mode : KERNEL_SLOW;
    mode = alpha == 0.0 ? KERNEL_STICK : mode;
    const double unbraked = absolute(s.c1) + absolute(s.c2) > no_drive ? KERNEL_FREE : mode;
    mode = mu_s == 0.0 ? unbraked : mode;
    mode = k->bn >= 0.0 ? KERNEL_OPEN : mode;
    const double least = -SEMIDEFINITE_TOLERANCE * size;
    const int indefinite =
        (s.s11 < least) | (s.s22 < least) | (lam2_raw < least) | (lam1_raw < least);
    mode = indefinite ? KERNEL_MATRIX : mode;
    mode = k->fault != KERNEL_OPEN ? k->fault : mode;
    const double friction_probe = (mu_s - mu_s) + (mu_d - mu_d);
    const int bad_friction = (mu_d < 0.0) | (mu_s < mu_d);
    mode = (bad_friction & (k->fault != KERNEL_RANGE)) ? KERNEL_FRICTION : mode;
    const int not_finite = (friction_probe != 0.0) | (k->fault == KERNEL_NOT_FINITE);
    mode = not_finite ? KERNEL_NOT_FINITE : mode;
    out->mode = mode;
}

/* One Halley step on mu p_n / |p_t| - 1 = N / sqrt q - 1, nearly linear in nu; cubic convergence for
 * the one square root and one division of Newton's. With T = N' q - N q'/2 the first two derivatives are
 * T / q^1.5 and (T' - 3 T q'/(2q)) / q^1.5. Returns 1 once a further step cannot change the result. */
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
    const double back = e->lam2 > 0.0 ? 0.0 : 0.5 * x; /* the left end is as near as may be */
    *nu = moved > 0.0 ? moved : back;
    return absolute(step) <= STEP_TOLERANCE * (moved + e->lam2);
}

/* Impulse of the scaled problem from nu (slip) or nu = 0 (stick). Slip takes p_n from |p_t| = mu p_n, so the
 * cone holds to an ulp or two also where p_n is a small difference; a stick that rounding left just
 * outside of the cone is brought back. */
TRIBO_ALWAYS_INLINE void kernel_finish(const kernel_slip *e, double nu, int slips, double p[3])
{
    const double g1 = e->lam1 + nu;
    const double g2 = e->lam2 + nu;
    const double p1 = e->c1 / (g1 > 0.0 ? g1 : 1.0);
    const double p2 = e->c2 / (g2 > 0.0 ? g2 : 1.0);
    const double length = sqrt((p1 * p1 + p2 * p2) * e->shrink);
    const double normal =
        -(e->bn + (e->w1 * p1 + e->w2 * p2) * e->shrink) * e->inverse_a;
    const double ratio = e->mu_s * normal / length;
    const double capped = ratio < 1.0 ? ratio : 1.0;
    const double f = (slips ? 1.0 : capped) * e->shrink;
    p[0] = slips ? length * e->inverse_mu : normal;
    p[1] = f * (p1 * e->ex - p2 * e->ey);
    p[2] = f * (p1 * e->ey + p2 * e->ex);
}

/* The ALGEBRAIC law (contact.h) on a scaled problem whose b is the velocity before the impact. */
typedef struct kernel_algebraic {
    double p[3];
    double kappa;
    double mode;
} kernel_algebraic;

TRIBO_ALWAYS_INLINE void kernel_solve_algebraic(const kernel_problem *k, double mu_s, double mu_d,
                                                double e, double e_t, kernel_algebraic *out)
{
    kernel_schur s;
    kernel_reduce(k, &s);

    /* S x = c by the larger pivot; a direction that rounding left without mobility gets no impulse. */
    const double size = k->t11 + k->t22;
    const double nothing = SINGULAR_TOLERANCE * size;
    const int second = s.s22 > s.s11;
    const double pivot = second ? s.s22 : s.s11;
    const double other = second ? s.s11 : s.s22;
    const double c_pivot = second ? s.c2 : s.c1;
    const double c_other = second ? s.c1 : s.c2;
    const int mobile = pivot > nothing;
    const double inverse_pivot = 1.0 / (mobile ? pivot : 1.0);
    const double determinant = pivot * other - s.s12 * s.s12;
    const int regular = determinant > nothing * pivot;
    const double solved = (c_other * pivot - s.s12 * c_pivot) / (regular ? determinant : 1.0);
    const double x_other = regular ? solved : 0.0;
    const double x_pivot = mobile ? (c_pivot - s.s12 * x_other) * inverse_pivot : 0.0;
    const double x1 = second ? x_other : x_pivot;
    const double x2 = second ? x_pivot : x_other;

    /* P_I = plastic n, P_II - P_I = (coupling, x). */
    const double plastic = -k->bn * s.inverse_a;
    const double normal_rest = (1.0 + e) * plastic;
    const double coupling = -(k->n1 * x1 + k->n2 * x2) * s.inverse_a;
    const double length = sqrt(x1 * x1 + x2 * x2);
    const double full = 1.0 + e_t;
    const double full_normal = normal_rest + full * coupling;
    const int sticks = full * length <= mu_s * full_normal;
    /* On the cone, |P_t| = mu P_n exactly: P_t = kappa x, P_n = normal_rest |x| / reach. */
    const double share = normal_rest / (sticks ? 1.0 : length - mu_d * coupling);
    const double kappa = sticks ? full : mu_d * share;
    out->p[0] = sticks ? full_normal : share * length;
    out->p[1] = kappa * x1;
    out->p[2] = kappa * x2;
    out->kappa = kappa;

    const double least = -SEMIDEFINITE_TOLERANCE * size;
    const int indefinite = (s.s11 < least) | (s.s22 < least) | (determinant < least * pivot);
    double mode = sticks ? KERNEL_STICK : KERNEL_SLIP;
    mode = k->bn >= 0.0 ? KERNEL_OPEN : mode;
    mode = indefinite ? KERNEL_MATRIX : mode;
    mode = k->fault != KERNEL_OPEN ? k->fault : mode;
    const double probe = (mu_s - mu_s) + (mu_d - mu_d) + (e - e) + (e_t - e_t);
    const int bad_friction = (mu_d < 0.0) | (mu_s < mu_d);
    const int bad_restitution = (e < 0.0) | (e > 1.0) | (e_t < -1.0) | (e_t > 1.0);
    mode = (bad_restitution & (k->fault != KERNEL_RANGE)) ? KERNEL_RESTITUTION : mode;
    mode = (bad_friction & (k->fault != KERNEL_RANGE)) ? KERNEL_FRICTION : mode;
    const int not_finite = (probe != 0.0) | (k->fault == KERNEL_NOT_FINITE);
    mode = not_finite ? KERNEL_NOT_FINITE : mode;
    out->mode = mode;
}

/* What one body adds to W: x_k . J x_l with x_k = R^T (r x n_k), in body axes. A diagonal J saves
 * products with zero, which change no bit but the signs of zeros. */
TRIBO_ALWAYS_INLINE void kernel_add_mobility(const double r[9], const double j[6], int diagonal,
                                             const double arm[3], const double frame[9], double w[6])
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
    w[0] += x[0][0] * z[0][0] + x[0][1] * z[0][1] + x[0][2] * z[0][2];
    w[1] += x[0][0] * z[1][0] + x[0][1] * z[1][1] + x[0][2] * z[1][2];
    w[2] += x[0][0] * z[2][0] + x[0][1] * z[2][1] + x[0][2] * z[2][2];
    w[3] += x[1][0] * z[1][0] + x[1][1] * z[1][1] + x[1][2] * z[1][2];
    w[4] += x[1][0] * z[2][0] + x[1][1] * z[2][1] + x[1][2] * z[2][2];
    w[5] += x[2][0] * z[2][0] + x[2][1] * z[2][1] + x[2][2] * z[2][2];
}

#endif
