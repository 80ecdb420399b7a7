/* Eight contacts of a sweep at a time. As in batch_lanes.c, each stage is one loop over the lanes
 * around the branch-free scalar arithmetic of sweep_block.h. */
#include "sweep_block.h"

#ifndef TRIBO_LANES
#define TRIBO_LANES baseline
#endif
/* gcc unrolls small loops inside of larger ones before it looks for vectors: hence no inlining. */
#if defined(__GNUC__)
#define STAGE static __attribute__((noinline))
#else
#define STAGE static
#endif
#define PASTE_TWO(a, b) a##b
#define PASTE(a, b) PASTE_TWO(a, b)

/* ---- bodies to lanes and back ---------------------------------------------------------------- */

/* Rows v, w of eight bodies, and their inverse masses. */
typedef struct lane_ends {
    lane_row v[3], mass, w[3], unit;
} lane_ends;

/* Vectors of four would split the rows of eight that AVX-512 reads back. */
#if defined(__GNUC__) && defined(__has_builtin) && !defined(__AVX512F__)
#if __has_builtin(__builtin_shufflevector)
#define HAVE_SHUFFLE 1
#endif
#endif

#if defined(HAVE_SHUFFLE)

/* Moves four numbers of four lines into four rows, or back. Compilers make a third as many shuffles
 * of this as of loops; no number is changed. */
typedef double four __attribute__((vector_size(32)));

TRIBO_ALWAYS_INLINE void turn_four(const double *const from[4], double *const to[4])
{
    four a;
    four b;
    four c;
    four d;
    memcpy(&a, from[0], sizeof a);
    memcpy(&b, from[1], sizeof b);
    memcpy(&c, from[2], sizeof c);
    memcpy(&d, from[3], sizeof d);
    const four ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
    const four ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const four cd0 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const four cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    c = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
    memcpy(to[0], &a, sizeof a);
    memcpy(to[1], &b, sizeof b);
    memcpy(to[2], &c, sizeof c);
    memcpy(to[3], &d, sizeof d);
}

STAGE void gather(const sweep_body *x, const uint32_t *at, lane_ends *restrict out)
{
    for (int i = 0; i < LANES; i += 4) {
        const sweep_body *const e[4] = {x + at[i], x + at[i + 1], x + at[i + 2], x + at[i + 3]};
        const double *const linear[4] = {e[0]->v, e[1]->v, e[2]->v, e[3]->v};
        const double *const angular[4] = {e[0]->w, e[1]->w, e[2]->w, e[3]->w};
        double *const rows[4] = {out->v[0] + i, out->v[1] + i, out->v[2] + i, out->mass + i};
        double *const more[4] = {out->w[0] + i, out->w[1] + i, out->w[2] + i, out->unit + i};
        turn_four(linear, rows);
        turn_four(angular, more);
    }
}

/* Rows to the lines that `to` points to. */
TRIBO_ALWAYS_INLINE void turn_back(const lane_ends *restrict rows, sweep_body *const to[LANES])
{
    for (int i = 0; i < LANES; i += 4) {
        const double *const linear[4] = {rows->v[0] + i, rows->v[1] + i, rows->v[2] + i,
                                         rows->mass + i};
        const double *const angular[4] = {rows->w[0] + i, rows->w[1] + i, rows->w[2] + i,
                                          rows->unit + i};
        double *const lines[4] = {to[i]->v, to[i + 1]->v, to[i + 2]->v, to[i + 3]->v};
        double *const more[4] = {to[i]->w, to[i + 1]->w, to[i + 2]->w, to[i + 3]->w};
        turn_four(linear, lines);
        turn_four(angular, more);
    }
}

#else

STAGE void gather(const sweep_body *x, const uint32_t *at, lane_ends *restrict out)
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
        out->unit[i] = lines[i][7];
    }
}

static void turn_back(const lane_ends *restrict rows, sweep_body *const to[LANES])
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
        lines[i][7] = rows->unit[i];
    }
    for (int i = 0; i < LANES; i++) {
        memcpy(to[i], lines[i], sizeof lines[i]);
    }
}

#endif

/* Ends that can not move are not written. */
STAGE void scatter(const lane_ends *restrict rows, const uint32_t *at, uint32_t none,
                   uint32_t still, sweep_body *x)
{
    sweep_body sink;
    sweep_body *to[LANES];
    for (int i = 0; i < LANES; i++) {
        to[i] = still && at[i] == none ? &sink : x + at[i];
    }
    turn_back(rows, to);
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
    lane_row bn, c1, c2, e1, e2, trace, det, base_b, base_c, up, mode;
} lane_pose;

TRIBO_ALWAYS_INLINE sweep_pose pose_of(const lane_pose *p, int i)
{
    const sweep_pose e = {p->bn[i],  p->c1[i],     p->c2[i],     p->e1[i], p->e2[i],  p->trace[i],
                          p->det[i], p->base_b[i], p->base_c[i], p->up[i], p->mode[i]};
    return e;
}

STAGE void pose_lanes(const sweep_three *restrict g, const lane_ends *restrict a,
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
        out->up[i] = e.up;
        out->mode[i] = e.mode;
    }
}

typedef struct lane_slip {
    lane_row A, B, C, alpha, beta, gamma, least, nu;
} lane_slip;

STAGE void slip_lanes(const sweep_three *restrict g, const lane_pose *restrict pose,
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
    }
}

TRIBO_ALWAYS_INLINE kernel_slip slip_of(const lane_slip *s, int i)
{
    kernel_slip e;
    e.A = s->A[i];
    e.B = s->B[i];
    e.C = s->C[i];
    e.alpha = s->alpha[i];
    e.beta = s->beta[i];
    e.gamma = s->gamma[i];
    e.least = s->least[i];
    e.nu = s->nu[i];
    return e;
}

/* Guesses for the lanes that have no root yet. */
STAGE void guess_lanes(lane_slip *restrict slip)
{
    for (int i = 0; i < LANES; i++) {
        kernel_slip e = slip_of(slip, i);
        const double nu = e.nu;
        kernel_guess(&e);
        slip->nu[i] = nu > 0.0 ? nu : e.nu;
    }
}

/* A sum that is not one long chain. */
TRIBO_ALWAYS_INLINE double sum_lanes(const double *x)
{
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

/* One step of all lanes that slip and have not settled; open[i] is 1 there. Returns how many go
 * on. */
STAGE double step_lanes(lane_slip *restrict slip, double *restrict open)
{
    for (int i = 0; i < LANES; i++) {
        const kernel_slip e = slip_of(slip, i);
        double nu = e.nu;
        const int settled = kernel_halley(&e, &nu);
        slip->nu[i] = open[i] != 0.0 ? nu : e.nu;
        open[i] = settled ? 0.0 : open[i];
    }
    return sum_lanes(open);
}

/* Lanes that slip to their roots, from those of the last sweep on; open[i] is 1 where that does not
 * settle. */
STAGE void settle_lanes(sweep_three *restrict g, const lane_pose *restrict pose,
                        double *restrict open)
{
    lane_slip slip;
    lane_row new;
    for (int i = 0; i < LANES; i++) {
        const double slips = pose->mode[i] == KERNEL_SLIP ? 1.0 : 0.0;
        open[i] = slips;
        new[i] = g->nu[i] > 0.0 ? 0.0 : slips;
    }
    double left = sum_lanes(open);
    if (left == 0.0) {
        return;
    }
    slip_lanes(g, pose, &slip);
    memcpy(slip.nu, g->nu, sizeof slip.nu);
    if (sum_lanes(new) > 0.0) {
        guess_lanes(&slip);
    }
    for (int step = 0; step < MAX_HALLEY && left > 0.0; step++) {
        left = step_lanes(&slip, open);
    }
    memcpy(g->nu, slip.nu, sizeof slip.nu);
}

/* New impulses p; odd[i] becomes 1 where a lane wants a closer look. Returns how many. */
STAGE double finish_lanes(sweep_three *restrict g, const lane_pose *restrict pose,
                          const double *restrict open, lane_row *restrict p, double *restrict odd)
{
    for (int i = 0; i < LANES; i++) {
        const sweep_pose e = pose_of(pose, i);
        const double nu = g->nu[i];
        double impulse[3];
        const double wrong = open[i] + sweep_finish_one(g, (size_t)i, &e, nu, impulse);
        p[0][i] = impulse[0];
        p[1][i] = impulse[1];
        p[2][i] = impulse[2];
        odd[i] = e.mode <= KERNEL_SLIP ? wrong : 1.0;
        const double root = wrong == 0.0 ? nu : 0.0;
        g->nu[i] = e.mode == KERNEL_SLIP ? root : 0.0;
    }
    return sum_lanes(odd);
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
STAGE void exchange_lanes(sweep_three *restrict g, lane_row *restrict p)
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
STAGE void push_lanes(const sweep_three *restrict g, lane_row *restrict change,
                      lane_ends *restrict a, lane_ends *restrict b)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        const double d[3] = {change[0][i], change[1][i], change[2][i]};
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        sweep_push(g, (size_t)i, d, a->mass[i], b->mass[i], a->unit[i], b->unit[i], of_a, of_b);
        store_end(a, i, of_a);
        store_end(b, i, of_b);
    }
}

STAGE double change_lanes(const sweep_three *restrict g, lane_row *restrict d)
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

/* Blocks under way at once: where one waits for a division, the next goes on. From FAR blocks on,
 * they are likely not to be near. */
enum { UNDER_WAY = 2, FAR = 256 };

/* Ask for the blocks after the next ones: what foresees accesses stops at each page. */
TRIBO_ALWAYS_INLINE void fetch(const sweep_three *blocks, uint32_t count)
{
#if defined(__GNUC__)
    const char *line = (const char *)blocks;
    for (size_t at = 0; at < count * sizeof *blocks; at += 64) {
        __builtin_prefetch(line + at, 0);
    }
#else
    (void)blocks;
    (void)count;
#endif
}

static uint32_t lesser_count(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

typedef struct work {
    lane_ends a, b;
    lane_pose pose;
    lane_row open, odd, p[3];
} work;

static double sweep_some(const system_problem *problem, sweep_three *g, uint32_t count,
                         sweep_body *x, int measure)
{
    work own[UNDER_WAY];
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k++) {
        gather(x, g[k].ends.a, &own[k].a);
        gather(x, g[k].ends.b, &own[k].b);
        pose_lanes(g + k, &own[k].a, &own[k].b, &own[k].pose);
    }
    for (uint32_t k = 0; k < count; k++) {
        settle_lanes(g + k, &own[k].pose, own[k].open);
    }
    for (uint32_t k = 0; k < count; k++) {
        work *w = own + k;
        if (finish_lanes(g + k, &w->pose, w->open, w->p, w->odd) > 0.0) {
            greatest = greater(solve_odd(problem, g + k, &w->pose, w->odd, w->p), greatest);
        }
    }
    for (uint32_t k = 0; k < count; k++) {
        work *w = own + k;
        exchange_lanes(g + k, w->p);
        push_lanes(g + k, w->p, &w->a, &w->b);
        scatter(&w->a, g[k].ends.a, problem->bodies, g[k].ends.still, x);
        scatter(&w->b, g[k].ends.b, problem->bodies, g[k].ends.still, x);
        if (measure) {
            greatest = greater(change_lanes(g + k, w->p), greatest);
        }
    }
    return greatest;
}

static double three(const system_problem *problem, sweep_three *blocks, uint32_t count,
                    sweep_body *x, int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k += UNDER_WAY) {
        const uint32_t here = lesser_count(count - k, UNDER_WAY);
        if (count >= FAR && count - k > 2 * UNDER_WAY) {
            const uint32_t left = count - k - 2 * UNDER_WAY;
            fetch(blocks + k + 2 * UNDER_WAY, lesser_count(left, UNDER_WAY));
        }
        greatest = greater(sweep_some(problem, blocks + k, here, x, measure), greatest);
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
        scatter(&a, g->ends.a, none, g->ends.still, x);
        scatter(&b, g->ends.b, none, g->ends.still, x);
    }
}

/* ---- one row --------------------------------------------------------------------------------- */

STAGE void push_ones(const sweep_one *restrict g, const double *restrict d, lane_ends *restrict a,
                     lane_ends *restrict b)
{
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        load_end(a, i, of_a);
        load_end(b, i, of_b);
        sweep_one_push(g, (size_t)i, d[i], a->mass[i], b->mass[i], a->unit[i], b->unit[i], of_a,
                       of_b);
        store_end(a, i, of_a);
        store_end(b, i, of_b);
    }
}

STAGE void solve_ones(sweep_one *restrict g, const lane_ends *restrict a,
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

STAGE double change_ones(const sweep_one *restrict g, const double *restrict d)
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
        scatter(&a, g->ends.a, none, g->ends.still, x);
        scatter(&b, g->ends.b, none, g->ends.still, x);
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
        scatter(&a, g->ends.a, none, g->ends.still, x);
        scatter(&b, g->ends.b, none, g->ends.still, x);
    }
}

const sweep_table PASTE(sweep_, TRIBO_LANES) = {three, one, start_three, start_one};
