/* What sweep.c and sweep_lanes.c share: how contacts of a system are laid out eight by eight, and
 * the arithmetic of one of them, free of branches: one source of the bits.
 *
 * Sweeps do not work on velocities but on their change by impulses, x = (dv, L^-1 domega) with
 * L L^T the inverse inertia of a body: there one matrix both takes bodies to contacts, u = q + J x,
 * and, transposed, gives impulses back, x += M J^T dr with M the inverse masses and 1. */
#ifndef TRIBO_SWEEP_BLOCK_H
#define TRIBO_SWEEP_BLOCK_H

#include "kernel.h"
#include "lanes.h"
#include "sweep.h"

#define CERTIFIED 1e-9 /* greatest v_n that a slip may leave, to what it is summed from */

/* Rows are lines of the cache. */
#if defined(__GNUC__)
typedef double lane_row[LANES] __attribute__((aligned(64)));
#else
typedef double lane_row[LANES];
#endif

/* A body in sweeps: one line of the cache. Its inverse inertia is unit L L^T, the unit a power of
 * two: the root of an odd power would round otherwise than that of an even one. w = L^T times the
 * moments. */
typedef struct sweep_body {
    double v[3];
    double inverse_mass;
    double w[3];
    double unit;
} sweep_body;

/* Who stands in the lanes of a block. Lanes beyond `live` hold contacts that never close, of a body
 * of its own that is never written; so are ends that can not move. */
typedef struct sweep_ends {
    uint32_t a[LANES], b[LANES];
    uint32_t contact[LANES];
    uint32_t live;
    uint32_t still; /* 1: some end is that body */
    uint32_t unused[6];
} sweep_ends;

/* Eight contacts with friction. W is scaled by a power of two, as kernel_scale does; inverse_a is 0
 * where W or mu are not for the branch-free path. */
typedef struct sweep_three {
    sweep_ends ends;
    lane_row frame[9], turn_a[9], turn_b[9];
    lane_row q[3], r[3];
    lane_row nn, n1, n2, t11, t12, t22;
    lane_row scale, inverse_a, mu_s, inverse_mu; /* of mu_d */
    lane_row nu; /* root of the slip equation in the last sweep; 0: none */
} sweep_three;

/* Eight frictionless contacts. */
typedef struct sweep_one {
    sweep_ends ends;
    lane_row normal[3], turn_a[3], turn_b[3];
    lane_row q, r, w, inverse_w;
} sweep_one;

/* Sweep over `count` blocks whose lanes do not share a body; x[problem->bodies], or x[none], is the
 * body of the ends that can not move. Returns the greatest change of a contact if `measure` is 1,
 * as sweep_run does. start: take x to the impulses that the blocks hold. */
typedef struct sweep_table {
    double (*three)(const system_problem *problem, sweep_three *blocks, uint32_t count,
                    sweep_body *x, int measure);
    double (*one)(sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none, int measure);
    void (*start_three)(const sweep_three *blocks, uint32_t count, sweep_body *x, uint32_t none);
    void (*start_one)(const sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none);
} sweep_table;

extern const sweep_table sweep_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
extern const sweep_table sweep_x86_64_v3;
extern const sweep_table sweep_x86_64_v4;
#endif

/* The contact in lane i by the functions of contact.h: p in place of the impulse that it holds. u
 * is its velocity. Returns 0 where that fails: p is then what it holds, within the cone. */
int sweep_solve_odd(const system_problem *problem, const sweep_three *block, size_t i,
                    const double u[3], double p[3]);

/* ---- three rows ------------------------------------------------------------------------------ */

/* Velocity of the contact. */
TRIBO_ALWAYS_INLINE void sweep_velocity(const sweep_three *g, size_t i, const double a[6],
                                        const double b[6], double u[3])
{
    const double d0 = a[0] - b[0];
    const double d1 = a[1] - b[1];
    const double d2 = a[2] - b[2];
    for (int k = 0; k < 3; k++) {
        const double linear =
            g->frame[3 * k][i] * d0 + g->frame[3 * k + 1][i] * d1 + g->frame[3 * k + 2][i] * d2;
        const double of_a = g->turn_a[3 * k][i] * a[3] + g->turn_a[3 * k + 1][i] * a[4] +
                            g->turn_a[3 * k + 2][i] * a[5];
        const double of_b = g->turn_b[3 * k][i] * b[3] + g->turn_b[3 * k + 1][i] * b[4] +
                            g->turn_b[3 * k + 2][i] * b[5];
        u[k] = g->q[k][i] + (linear + (of_a - of_b));
    }
}

/* The local problem without its own impulse, up to whether it sticks. */
typedef struct sweep_pose {
    double bn, c1, c2, e1, e2, trace, det;
    double base_b, base_c;
    double up; /* p = (p of the scaled problem) * up */
    double mode;
} sweep_pose;

TRIBO_ALWAYS_INLINE void sweep_pose_one(const sweep_three *g, size_t i, const double u[3],
                                        sweep_pose *out)
{
    const double s = g->scale[i];
    const double nn = g->nn[i];
    const double n1 = g->n1[i];
    const double n2 = g->n2[i];
    const double t12 = g->t12[i];
    const double r0 = g->r[0][i];
    const double r1 = g->r[1][i];
    const double r2 = g->r[2][i];
    const double b0 = s * u[0] - (nn * r0 + n1 * r1 + n2 * r2);
    const double b1 = s * u[1] - (n1 * r0 + g->t11[i] * r1 + t12 * r2);
    const double b2 = s * u[2] - (n2 * r0 + t12 * r1 + g->t22[i] * r2);
    const double greatest_b = greater(greater(absolute(b0), absolute(b1)), absolute(b2));
    const uint64_t eb = scale_exponent(greatest_b);
    const double sb = power_of_two(eb);
    const double bn = sb * b0;
    const double inverse_a = g->inverse_a[i];
    const double l1 = n1 * inverse_a;
    const double l2 = n2 * inverse_a;
    const double s11 = g->t11[i] - l1 * n1;
    const double s12 = t12 - l1 * n2;
    const double s22 = g->t22[i] - l2 * n2;
    const double c1 = l1 * bn - sb * b1;
    const double c2 = l2 * bn - sb * b2;
    const double trace = s11 + s22;
    const double det = s11 * s22 - s12 * s12;
    const double e1 = s22 * c1 - s12 * c2;
    const double e2 = s11 * c2 - s12 * c1;
    const double base_c = -bn * det - (n1 * e1 + n2 * e2);
    const double drive = nn * sqrt(e1 * e1 + e2 * e2);
    out->bn = bn;
    out->c1 = c1;
    out->c2 = c2;
    out->e1 = e1;
    out->e2 = e2;
    out->trace = trace;
    out->det = det;
    out->base_b = -bn * trace - (n1 * c1 + n2 * c2);
    out->base_c = base_c;
    out->up = power_of_two(2046u - eb);
    const double greatest_c = greater(absolute(c1), absolute(c2));
    const double least_c = greatest_c > 0.0 ? FAST_MIN_DRIVE : 0.0;
    const double closing = g->mu_s[i] * base_c >= drive ? KERNEL_STICK : KERNEL_SLIP;
    const int usual_size = (-bn >= FAST_MIN) & (greatest_c >= least_c);
    const double usual = usual_size ? closing : KERNEL_ODD;
    const double mode = bn >= 0.0 ? KERNEL_OPEN : usual;
    const int sound = (inverse_a > 0.0) & (greatest_b <= TRIBO_LARGE);
    out->mode = sound ? mode : KERNEL_ODD;
}

/* The slip equation of kernel.h, divided by mu. */
TRIBO_ALWAYS_INLINE void sweep_slip_one(const sweep_three *g, size_t i, const sweep_pose *e,
                                        kernel_slip *out)
{
    const double inverse = g->inverse_mu[i] * g->nn[i];
    const double unit = inverse * inverse;
    out->A = -e->bn;
    out->B = e->base_b;
    out->C = e->base_c;
    out->alpha = unit * (e->c1 * e->c1 + e->c2 * e->c2);
    out->beta = unit * (e->c1 * e->e1 + e->c2 * e->e2);
    out->gamma = unit * (e->e1 * e->e1 + e->e2 * e->e2);
    out->least = FAST_CONDITION * e->trace;
}

/* New impulse from the root nu. Returns 0; or 1 if it is not finite, or slips and leaves v_n other
 * than 0: the root was sought from that of the last sweep, which may be far. */
TRIBO_ALWAYS_INLINE double sweep_finish_one(const sweep_three *g, size_t i, const sweep_pose *e,
                                            double nu, double p[3])
{
    const double mode = e->mode;
    const int slips = mode == KERNEL_SLIP;
    const double nn = g->nn[i];
    kernel_slip s;
    s.inverse_a = g->inverse_a[i];
    s.bn = e->bn;
    s.n1 = g->n1[i];
    s.n2 = g->n2[i];
    s.c1 = e->c1;
    s.c2 = e->c2;
    s.e1 = e->e1;
    s.e2 = e->e2;
    s.trace = e->trace;
    s.det = e->det;
    s.mu_s = g->mu_s[i];
    s.inverse_mu = g->inverse_mu[i];
    double impulse[3];
    kernel_finish(&s, slips ? nu : 0.0, slips, impulse);
    const double push = nn * impulse[0];
    const double left = absolute(push + (s.n1 * impulse[1] + s.n2 * impulse[2]) + s.bn);
    const double allowed = CERTIFIED * (push + absolute(s.bn));
    const double p0 = mode == KERNEL_OPEN ? 0.0 : impulse[0] * e->up;
    const double p1 = mode == KERNEL_OPEN ? 0.0 : impulse[1] * e->up;
    const double p2 = mode == KERNEL_OPEN ? 0.0 : impulse[2] * e->up;
    p[0] = p0;
    p[1] = p1;
    p[2] = p2;
    const double probe = (p0 - p0) + (p1 - p1) + (p2 - p2);
    const double wrong = left <= allowed ? probe : 1.0;
    const double judged = slips ? wrong : probe;
    return judged == 0.0 ? 0.0 : 1.0;
}

/* Give the change d of the impulse to both bodies. */
TRIBO_ALWAYS_INLINE void sweep_push(const sweep_three *g, size_t i, const double d[3],
                                    double mass_a, double mass_b, double unit_a, double unit_b,
                                    double a[6], double b[6])
{
    for (int k = 0; k < 3; k++) {
        const double f =
            g->frame[k][i] * d[0] + g->frame[3 + k][i] * d[1] + g->frame[6 + k][i] * d[2];
        const double of_a =
            g->turn_a[k][i] * d[0] + g->turn_a[3 + k][i] * d[1] + g->turn_a[6 + k][i] * d[2];
        const double of_b =
            g->turn_b[k][i] * d[0] + g->turn_b[3 + k][i] * d[1] + g->turn_b[6 + k][i] * d[2];
        a[k] += mass_a * f;
        b[k] -= mass_b * f;
        a[3 + k] += unit_a * of_a;
        b[3 + k] -= unit_b * of_b;
    }
}

/* |W d| / (|q| + |W||r|) after the change d to r, by greatest entries. */
TRIBO_ALWAYS_INLINE double sweep_change(const sweep_three *g, size_t i, const double d[3])
{
    const double w[3][3] = {{g->nn[i], g->n1[i], g->n2[i]},
                            {g->n1[i], g->t11[i], g->t12[i]},
                            {g->n2[i], g->t12[i], g->t22[i]}};
    double change = 0.0;
    double size = 0.0;
    double free = 0.0;
    for (int k = 0; k < 3; k++) {
        const double q = absolute(g->scale[i] * g->q[k][i]);
        const double x = absolute(w[k][0] * d[0] + w[k][1] * d[1] + w[k][2] * d[2]);
        const double y = absolute(w[k][0] * g->r[0][i]) + absolute(w[k][1] * g->r[1][i]) +
                         absolute(w[k][2] * g->r[2][i]);
        change = greater(x, change);
        size = greater(y, size);
        free = greater(q, free);
    }
    const double scale = free + size;
    return change / (scale > 0.0 ? scale : change > 0.0 ? change : 1.0);
}

/* ---- one row --------------------------------------------------------------------------------- */

TRIBO_ALWAYS_INLINE double sweep_one_impulse(const sweep_one *g, size_t i, const double a[6],
                                             const double b[6])
{
    const double linear = g->normal[0][i] * (a[0] - b[0]) + g->normal[1][i] * (a[1] - b[1]) +
                          g->normal[2][i] * (a[2] - b[2]);
    const double of_a = g->turn_a[0][i] * a[3] + g->turn_a[1][i] * a[4] + g->turn_a[2][i] * a[5];
    const double of_b = g->turn_b[0][i] * b[3] + g->turn_b[1][i] * b[4] + g->turn_b[2][i] * b[5];
    const double u = g->q[i] + (linear + (of_a - of_b));
    const double r = g->r[i];
    const double p = (g->w[i] * r - u) * g->inverse_w[i];
    const double closed = p > 0.0 ? p : 0.0;
    return p - p == 0.0 ? closed : r;
}

TRIBO_ALWAYS_INLINE void sweep_one_push(const sweep_one *g, size_t i, double d, double mass_a,
                                        double mass_b, double unit_a, double unit_b, double a[6],
                                        double b[6])
{
    for (int k = 0; k < 3; k++) {
        const double f = g->normal[k][i] * d;
        a[k] += mass_a * f;
        b[k] -= mass_b * f;
        a[3 + k] += unit_a * (g->turn_a[k][i] * d);
        b[3 + k] -= unit_b * (g->turn_b[k][i] * d);
    }
}

TRIBO_ALWAYS_INLINE double sweep_one_change(const sweep_one *g, size_t i, double d)
{
    const double change = absolute(g->w[i] * d);
    const double scale = absolute(g->q[i]) + absolute(g->w[i] * g->r[i]);
    return change / (scale > 0.0 ? scale : change > 0.0 ? change : 1.0);
}

/* ---- assembled form -------------------------------------------------------------------------- */

/* x . y, eight sums side by side. */
TRIBO_ALWAYS_INLINE double sweep_dot(size_t n, const double *x, const double *y)
{
    double sum[LANES] = {0.0};
    size_t at = 0;
    for (; at + LANES <= n; at += LANES) {
        for (size_t i = 0; i < LANES; i++) {
            sum[i] += x[at + i] * y[at + i];
        }
    }
    for (; at < n; at++) {
        sum[at % LANES] += x[at] * y[at];
    }
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

#endif
