/* Eight contacts of a sweep at a time. As in batch_lanes.c, each stage is one loop over the lanes
 * around the branch-free scalar arithmetic of sweep_block.h. */
#include "sweep_block.h"

#ifndef TRIBO_LANES
#define TRIBO_LANES baseline
#endif
#define PASTE_TWO(a, b) a##b
#define PASTE(a, b) PASTE_TWO(a, b)

/* ---- bodies to lanes and back ---------------------------------------------------------------- */

/* Rows v, w of eight bodies, and their inverse masses. */
typedef struct lane_ends {
    lane_row v[3], mass, w[3], unused;
} lane_ends;

static void gather(const sweep_body *x, const uint32_t *at, lane_ends *restrict out)
{
    double lines[LANES][8];
    for (int i = 0; i < LANES; i++) {
        memcpy(lines[i], &x[at[i]], sizeof lines[i]);
    }
    for (int i = 0; i < LANES; i++) {
        out->v[0][i] = lines[i][0];
        out->v[1][i] = lines[i][1];
        out->v[2][i] = lines[i][2];
        out->mass[i] = lines[i][3];
        out->w[0][i] = lines[i][4];
        out->w[1][i] = lines[i][5];
        out->w[2][i] = lines[i][6];
        out->unused[i] = lines[i][7];
    }
}

static void scatter(const lane_ends *restrict rows, const uint32_t *at, uint32_t none,
                    sweep_body *x)
{
    double lines[LANES][8];
    for (int i = 0; i < LANES; i++) {
        lines[i][0] = rows->v[0][i];
        lines[i][1] = rows->v[1][i];
        lines[i][2] = rows->v[2][i];
        lines[i][3] = rows->mass[i];
        lines[i][4] = rows->w[0][i];
        lines[i][5] = rows->w[1][i];
        lines[i][6] = rows->w[2][i];
        lines[i][7] = rows->unused[i];
    }
    for (int i = 0; i < LANES; i++) {
        if (at[i] != none) {
            memcpy(&x[at[i]], lines[i], sizeof lines[i]);
        }
    }
}

TRIBO_ALWAYS_INLINE void load_end(const lane_ends *e, int i, double out[6])
{
    out[0] = e->v[0][i];
    out[1] = e->v[1][i];
    out[2] = e->v[2][i];
    out[3] = e->w[0][i];
    out[4] = e->w[1][i];
    out[5] = e->w[2][i];
}

TRIBO_ALWAYS_INLINE void store_end(lane_ends *e, int i, const double in[6])
{
    e->v[0][i] = in[0];
    e->v[1][i] = in[1];
    e->v[2][i] = in[2];
    e->w[0][i] = in[3];
    e->w[1][i] = in[4];
    e->w[2][i] = in[5];
}

/* ---- three rows ------------------------------------------------------------------------------ */

typedef struct lane_pose {
    lane_row u[3];
    lane_row bn, c1, c2, e1, e2, trace, det, base_b, base_c, gamma, up, mode;
} lane_pose;

TRIBO_ALWAYS_INLINE sweep_pose pose_of(const lane_pose *p, int i)
{
    const sweep_pose e = {
        p->bn[i],  p->c1[i],     p->c2[i],     p->e1[i],    p->e2[i], p->trace[i],
        p->det[i], p->base_b[i], p->base_c[i], p->gamma[i], p->up[i], p->mode[i],
    };
    return e;
}

static void pose_lanes(const sweep_three *restrict g, const lane_ends *restrict a,
                       const lane_ends *restrict b, lane_pose *restrict out)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        double u[3];
        sweep_pose e;
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        sweep_velocity(g, (size_t)i, of_a, of_b, u);
        sweep_pose_one(g, (size_t)i, u, &e);
        out->u[0][i] = u[0];
        out->u[1][i] = u[1];
        out->u[2][i] = u[2];
        out->bn[i] = e.bn;
        out->c1[i] = e.c1;
        out->c2[i] = e.c2;
        out->e1[i] = e.e1;
        out->e2[i] = e.e2;
        out->trace[i] = e.trace;
        out->det[i] = e.det;
        out->base_b[i] = e.base_b;
        out->base_c[i] = e.base_c;
        out->gamma[i] = e.gamma;
        out->up[i] = e.up;
        out->mode[i] = e.mode;
    }
}

typedef struct lane_slip {
    lane_row A, B, C, alpha, beta, gamma, least, nu;
} lane_slip;

static void slip_lanes(const sweep_three *restrict g, const lane_pose *restrict pose,
                       lane_slip *restrict out)
{
    for (int i = 0; i < LANES; i++) {
        const sweep_pose e = pose_of(pose, i);
        kernel_slip s;
        sweep_slip_one(g, (size_t)i, &e, &s);
        out->A[i] = s.A;
        out->B[i] = s.B;
        out->C[i] = s.C;
        out->alpha[i] = s.alpha;
        out->beta[i] = s.beta;
        out->gamma[i] = s.gamma;
        out->least[i] = s.least;
        out->nu[i] = s.nu;
    }
}

/* One step of all lanes that slip and have not settled; open[i] is 1 there. Returns how many go
 * on. */
static double step_lanes(lane_slip *restrict slip, double *restrict open)
{
    double left = 0.0;
    for (int i = 0; i < LANES; i++) {
        kernel_slip e;
        e.A = slip->A[i];
        e.B = slip->B[i];
        e.C = slip->C[i];
        e.alpha = slip->alpha[i];
        e.beta = slip->beta[i];
        e.gamma = slip->gamma[i];
        e.least = slip->least[i];
        double nu = slip->nu[i];
        const int settled = kernel_halley(&e, &nu);
        slip->nu[i] = open[i] != 0.0 ? nu : slip->nu[i];
        open[i] = settled ? 0.0 : open[i];
        left += open[i];
    }
    return left;
}

/* Lanes that slip in `mode` to their root; open[i] is 1 where that does not settle. */
static void settle_lanes(const sweep_three *g, const lane_pose *pose, double *restrict nu,
                         double *restrict open)
{
    double left = 0.0;
    for (int i = 0; i < LANES; i++) {
        nu[i] = 0.0;
        open[i] = pose->mode[i] == KERNEL_SLIP ? 1.0 : 0.0;
        left += open[i];
    }
    if (left > 0.0) {
        lane_slip slip;
        slip_lanes(g, pose, &slip);
        for (int step = 0; step < MAX_HALLEY && left > 0.0; step++) {
            left = step_lanes(&slip, open);
        }
        memcpy(nu, slip.nu, sizeof slip.nu);
    }
}

/* New impulses p; odd[i] becomes 1 where a lane wants a closer look. Returns how many. */
static double finish_lanes(const sweep_three *restrict g, const lane_pose *restrict pose,
                           const double *restrict nu, const double *restrict open,
                           lane_row *restrict p, double *restrict odd)
{
    for (int i = 0; i < LANES; i++) {
        const sweep_pose e = pose_of(pose, i);
        double impulse[3];
        sweep_finish_one(g, (size_t)i, &e, nu[i], impulse);
        p[0][i] = impulse[0];
        p[1][i] = impulse[1];
        p[2][i] = impulse[2];
        const double probe =
            ((impulse[0] - impulse[0]) + (impulse[1] - impulse[1]) + (impulse[2] - impulse[2])) +
            open[i];
        const double by_mode = e.mode <= KERNEL_SLIP ? 0.0 : 1.0;
        odd[i] = probe == 0.0 ? by_mode : 1.0;
    }
    return ((odd[0] + odd[1]) + (odd[2] + odd[3])) + ((odd[4] + odd[5]) + (odd[6] + odd[7]));
}

/* Returns 1 if a lane fails. */
static double solve_odd(const system_problem *problem, const sweep_three *g, const lane_pose *pose,
                        const double *odd, lane_row *p)
{
    double failed = 0.0;
    for (size_t i = 0; i < g->ends.live; i++) {
        if (odd[i] > 0.0) {
            const double u[3] = {pose->u[0][i], pose->u[1][i], pose->u[2][i]};
            double impulse[3];
            failed = sweep_solve_odd(problem, g, i, u, impulse) ? failed : 1.0;
            p[0][i] = impulse[0];
            p[1][i] = impulse[1];
            p[2][i] = impulse[2];
        }
    }
    return failed;
}

/* Impulses p to the block; p becomes their change. */
static void exchange_lanes(sweep_three *restrict g, lane_row *restrict p)
{
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < LANES; i++) {
            const double d = p[k][i] - g->r[k][i];
            g->r[k][i] = p[k][i];
            p[k][i] = d;
        }
    }
}

/* Changes d of the impulses to the bodies. */
static void push_lanes(const sweep_three *restrict g, lane_row *restrict change,
                       lane_ends *restrict a, lane_ends *restrict b)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        const double d[3] = {change[0][i], change[1][i], change[2][i]};
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        sweep_push(g, (size_t)i, d, a->mass[i], b->mass[i], of_a, of_b);
        store_end(a, i, of_a);
        store_end(b, i, of_b);
    }
}

static double change_lanes(const sweep_three *restrict g, lane_row *restrict d)
{
    lane_row changes;
    double greatest = 0.0;
    for (int i = 0; i < LANES; i++) {
        const double own[3] = {d[0][i], d[1][i], d[2][i]};
        changes[i] = sweep_change(g, (size_t)i, own);
    }
    for (int i = 0; i < LANES; i++) {
        greatest = greater(changes[i], greatest);
    }
    return greatest;
}

static double three(const system_problem *problem, sweep_three *blocks, uint32_t count,
                    sweep_body *x, int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k++) {
        sweep_three *g = blocks + k;
        lane_ends a;
        lane_ends b;
        lane_pose pose;
        lane_row nu;
        lane_row open;
        lane_row odd;
        lane_row p[3];
        const uint32_t none = problem->bodies;
        gather(x, g->ends.a, &a);
        gather(x, g->ends.b, &b);
        pose_lanes(g, &a, &b, &pose);
        settle_lanes(g, &pose, nu, open);
        if (finish_lanes(g, &pose, nu, open, p, odd) > 0.0) {
            greatest = greater(solve_odd(problem, g, &pose, odd, p), greatest);
        }
        exchange_lanes(g, p);
        push_lanes(g, p, &a, &b);
        scatter(&a, g->ends.a, none, x);
        scatter(&b, g->ends.b, none, x);
        if (measure) {
            greatest = greater(change_lanes(g, p), greatest);
        }
    }
    return greatest;
}

static void start_three(const sweep_three *blocks, uint32_t count, sweep_body *x, uint32_t none)
{
    for (uint32_t k = 0; k < count; k++) {
        const sweep_three *g = blocks + k;
        lane_ends a;
        lane_ends b;
        lane_row r[3];
        memcpy(r, g->r, sizeof r);
        gather(x, g->ends.a, &a);
        gather(x, g->ends.b, &b);
        push_lanes(g, r, &a, &b);
        scatter(&a, g->ends.a, none, x);
        scatter(&b, g->ends.b, none, x);
    }
}

/* ---- one row --------------------------------------------------------------------------------- */

static void push_ones(const sweep_one *restrict g, const double *restrict d, lane_ends *restrict a,
                      lane_ends *restrict b)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        sweep_one_push(g, (size_t)i, d[i], a->mass[i], b->mass[i], of_a, of_b);
        store_end(a, i, of_a);
        store_end(b, i, of_b);
    }
}

static void solve_ones(sweep_one *restrict g, const lane_ends *restrict a,
                       const lane_ends *restrict b, double *restrict d)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        const double p = sweep_one_impulse(g, (size_t)i, of_a, of_b);
        d[i] = p - g->r[i];
        g->r[i] = p;
    }
}

static double change_ones(const sweep_one *restrict g, const double *restrict d)
{
    lane_row changes;
    double greatest = 0.0;
    for (int i = 0; i < LANES; i++) {
        changes[i] = sweep_one_change(g, (size_t)i, d[i]);
    }
    for (int i = 0; i < LANES; i++) {
        greatest = greater(changes[i], greatest);
    }
    return greatest;
}

static double one(sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none, int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k++) {
        sweep_one *g = blocks + k;
        lane_ends a;
        lane_ends b;
        lane_row d;
        gather(x, g->ends.a, &a);
        gather(x, g->ends.b, &b);
        solve_ones(g, &a, &b, d);
        push_ones(g, d, &a, &b);
        scatter(&a, g->ends.a, none, x);
        scatter(&b, g->ends.b, none, x);
        if (measure) {
            greatest = greater(change_ones(g, d), greatest);
        }
    }
    return greatest;
}

static void start_one(const sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none)
{
    for (uint32_t k = 0; k < count; k++) {
        const sweep_one *g = blocks + k;
        lane_ends a;
        lane_ends b;
        gather(x, g->ends.a, &a);
        gather(x, g->ends.b, &b);
        push_ones(g, g->r, &a, &b);
        scatter(&a, g->ends.a, none, x);
        scatter(&b, g->ends.b, none, x);
    }
}

const sweep_table PASTE(sweep_, TRIBO_LANES) = {three, one, start_three, start_one};
