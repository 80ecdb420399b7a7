#include "central.h"

#include "resist.h"

/* One setting for all problems. */
#define FIRST_ALPHA 1e-2 /* of the mean |W_cc| */
#define LEAST_ALPHA 1e-14
/* Of alpha, after QUICKEST steps or fewer, until Newton fails once; so many times more after each
 * single step, but not far beyond what the goal is away. */
#define FAST_FALL 10.0
#define SLOW_FALL 3.0 /* after fewer than QUICK steps */
#define RISE 5.0      /* where Newton fails */
#define QUICKEST 2
#define QUICK 10
#define INNER_STEPS 30
/* Share of |F| that rounding leaves of a step's equations: about inversely as alpha, which falls only
 * so far that the one is to be expected. A step beyond the other is the last with this alpha, and
 * none if it cannot be gone in full. */
#define CLEAR 0.1
#define BLIND 0.5
#define INNER_SHARE 1e-1  /* of the outer residual: where a proximal step is solved */
#define MEMORY 5          /* residuals that a step may not exceed */
#define LEAST_LENGTH 1e-3 /* of a Newton step */
#define SHORT_SHARE 0.1
#define SHORT_STEPS 3
#define LEAST_SWEEPS 8
#define MOST_SWEEPS 64
#define SYMMETRY 1e-12
/* From nearby: the first alpha, of the mean |W_cc|, the steps that a proximal step may take, and
 * what it must leave of the distance at most. */
#define LAST_ALPHA 1e-7
#define LAST_STEPS 5
#define LAST_REST 0.1
#define PATIENCE 1500 /* Newton steps that bring nothing */
/* Two proximal steps that bring nothing, where eta is as small as what rounding of impulses that
 * work against each other does to it, in units of their growth and at most. */
#define FLOOR_PATIENCE (2 * INNER_STEPS)
#define FLOOR_GROWTH (64.0 * TRIBO_EPS)
#define FLOOR_MOST (65536.0 * TRIBO_EPS)

/* ---- memory ---------------------------------------------------------------------------------- */

uint32_t newton_possible(uint32_t count, uint32_t bodies, const newton_run *run)
{
    return run->linear.factor != NULL || unknowns(count, bodies) <= run->dense_limit;
}

static void take_state(newton *n, arena *a, size_t count, uint32_t bodies, uint32_t torques)
{
    double **each[] = {&n->r,      &n->center, &n->u,     &n->f,    &n->next_r, &n->next_u,
                       &n->next_f, &n->step,   &n->moved, &n->best, &n->right};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        *each[i] = numbers(a, 3 * count);
    n->gain = numbers(a, count);
    n->dv = numbers(a, 6 * (size_t)bodies);
    n->slope = numbers(a, 9 * count);
    n->own = numbers(a, 9 * count);
    n->primal = numbers(a, 3 * count);
    n->dual = numbers(a, 3 * count);
    n->rest = numbers(a, 3 * count);
    n->along_x = numbers(a, 3 * count);
    n->along_y = numbers(a, 3 * count);
    n->slip = numbers(a, count);
    n->lead = torques != 0 ? numbers(a, 3 * count) : NULL;
    n->mode = arena_take(a, count, 1);
    n->next_mode = arena_take(a, count, 1);
    n->place = arena_take(a, 4 * count + 1, sizeof(uint32_t));
}

newton *newton_take(arena *a, uint32_t count, uint32_t bodies, uint32_t torques, size_t links,
                    const newton_run *run)
{
    newton counted = {0};
    newton *taken = arena_take(a, 1, sizeof *taken);
    newton *n = taken != NULL ? taken : &counted;

    *n = counted;
    take_state(n, a, count, bodies, torques);
    step_take(n, a, count, bodies, links, run);
    return taken;
}
/* ---- natural map ----------------------------------------------------------------------------- */

/* F of one contact; `bent` receives u + alpha (r - center). */
static uint32_t map_contact(const newton *n, size_t c, const double *r, const double *u, double *f,
                            double bent[3], double y[3])
{
    for (size_t k = 0; k < 3; k++)
        bent[k] = u[k] + n->alpha * (r[k] - n->center[3 * c + k]);
    return natural_map(n->gain[c], coefficient(n, c), r, bent, f, y);
}

/* The same of a torque; f holds that of its contact before. */
static uint32_t map_torque(const newton *n, size_t c, const double *r, const double *u, double *f,
                           double limits[2], double y[3])
{
    const double normal = resist_normal(n->gain[c - 1], r[-3], f[-3]);
    double bent[3];

    for (size_t k = 0; k < 3; k++)
        bent[k] = u[k] + n->alpha * (r[k] - n->center[3 * c + k]);
    resist_limits(n->problem, c, n->gain[c] * normal, limits);
    return resist_map(n->gain[c], limits, r, bent, f, y);
}

static double map_all(newton *n, const double *r, const double *u, double *f, uint8_t *mode)
{
    double sum = 0.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        double unused[3];
        double y[3];
        double *own = f + 3 * c;
        mode[c] = (uint8_t)(resist_is_torque(n->problem, c)
                                ? map_torque(n, c, r + 3 * c, u + 3 * c, own, unused, y)
                                : map_contact(n, c, r + 3 * c, u + 3 * c, own, unused, y));
        sum += own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
    }
    return sqrt(sum);
}

static void linearize_contact(newton *n, size_t c)
{
    double unused[3];
    double bent[3];
    double y[3];

    const uint32_t mode = map_contact(n, c, n->r + 3 * c, n->u + 3 * c, unused, bent, y);
    natural_linearize(mode, n->gain[c], n->alpha, coefficient(n, c), bent, y, n->f + 3 * c,
                      n->slope + 9 * c, n->own + 9 * c, n->right + 3 * c);
}

/* The same of a torque, but for what the normal impulse does to it: `lead` is kept for
 * follow_normal, and F of the contact is in what is on the right already. */
static void linearize_torque(newton *n, size_t c)
{
    const double *f = n->f + 3 * c;
    double *lead = n->lead + 3 * c;
    double held[6] = {f[-3], f[-2], f[-1], 0.0, 0.0, 0.0};
    double lengths[2];
    double limits[2];
    double y[3];

    map_torque(n, c, n->r + 3 * c, n->u + 3 * c, held + 3, limits, y);
    resist_limits(n->problem, c, 1.0, lengths);
    resist_linearize(n->gain[c], n->alpha, limits, lengths, y, n->slope + 9 * c, n->own + 9 * c,
                     lead);
    for (size_t k = 0; k < 3; k++)
        n->right[3 * c + k] = f[k] - lead[k] * (f[-3] / n->gain[c - 1]);
}

static void linearize(newton *n)
{
    n->symmetric = n->symmetric_w;
    for (size_t c = 0; c < n->problem->count; c++) {
        if (resist_is_torque(n->problem, c)) {
            linearize_torque(n, c);
            n->symmetric = n->mode[c] == SLIP ? 0 : n->symmetric;
            continue;
        }
        linearize_contact(n, c);
        if (n->mode[c] == SLIP && coefficient(n, c) > 0.0)
            n->symmetric = 0;
    }
}

/* ---- iteration ------------------------------------------------------------------------------- */

static void exchange(double **a, double **b)
{
    double *held = *a;
    *a = *b;
    *b = held;
}

/* Move by a share of the step, halved until |F| = f falls below the bound. Returns |F| there. */
static double search(newton *n, double f, double bound, double *share)
{
    const size_t numbers_of = 3 * (size_t)n->problem->count;
    double t = 1.0;
    double next = bound;

    for (; t > LEAST_LENGTH; t *= 0.5) {
        for (size_t i = 0; i < numbers_of; i++)
            n->next_r[i] = n->r[i] + t * n->step[i];
        certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
        next = map_all(n, n->next_r, n->next_u, n->next_f, n->next_mode);
        if (t == 1.0)
            n->blur = greater(n->blur, step_error(n) / f);
        if (next < (1.0 - 1e-4 * t) * bound)
            break;
    }
    *share = t;
    return next;
}

static int step_once(newton *n, newton_run *run)
{
    run->steps++;
    linearize(n);
    return step_solve(n, run);
}

/* ---- sweeps over the proximal problem -------------------------------------------------------- */

/* Velocity of contact c with the proximal term, without its own impulse: what its solve cancels. */
static void velocity_alone(const newton *n, size_t c, const double w[9], double b[3])
{
    const system_problem *p = n->problem;
    const double *r = n->r + 3 * c;

    if (p->bodies != 0)
        certificate_contact_velocity(p, c, n->dv, b);
    else
        certificate_row_velocity(p, c, n->r, b);
    for (size_t k = 0; k < 3; k++)
        b[k] -= w[3 * k] * r[0] + w[3 * k + 1] * r[1] + w[3 * k + 2] * r[2] -
                n->alpha * (r[k] - n->center[3 * c + k]);
}

/* Exact solve of one contact of the proximal problem. */
static void renew_contact(newton *n, size_t c)
{
    const system_problem *p = n->problem;
    const double mu = coefficient(n, c);
    double *r = n->r + 3 * c;
    double w[9];
    double b[3];
    double next[3];
    tribo_status status;

    for (size_t i = 0; i < 9; i++)
        w[i] = p->diagonal[9 * c + i] + (i % 4 == 0 ? n->alpha : 0.0);
    velocity_alone(n, c, w, b);
    if (p->symmetric[c] != 0) {
        const double half[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
        status = tribo_contact_solve(half, b, mu, mu, next, NULL);
    } else {
        status = tribo_contact_solve_general(w, b, mu, mu, next, NULL);
    }
    if (status != TRIBO_OK)
        return;
    if (p->bodies != 0) {
        const double change[3] = {next[0] - r[0], next[1] - r[1], next[2] - r[2]};
        certificate_push(p, c, change, n->dv);
    }
    for (int k = 0; k < 3; k++)
        r[k] = next[k];
}

/* The same of a contact and its torque. */
static void renew_resisting(newton *n, size_t c)
{
    const system_problem *p = n->problem;
    resist_block block;
    double next[6];

    resist_fill(p, c, n->alpha, &block);
    for (size_t i = 0; i < 6; i++)
        next[i] = n->r[3 * c + i];
    certificate_contact_velocity(p, c, n->dv, block.b);
    certificate_contact_velocity(p, c + 1, n->dv, block.b + 3);
    for (size_t i = 0; i < 6; i++) {
        block.b[i] -= n->alpha * n->center[3 * c + i] - n->alpha * next[i];
        for (size_t k = 0; k < 6; k++)
            block.b[i] -= block.w[6 * i + k] * next[k];
    }
    if (!resist_solve(&block, next))
        return;
    for (size_t part = 0; part < 2; part++) {
        double *r = n->r + 3 * (c + part);
        const double *to = next + 3 * part;
        const double change[3] = {to[0] - r[0], to[1] - r[1], to[2] - r[2]};
        certificate_push(p, c + part, change, n->dv);
        for (int k = 0; k < 3; k++)
            r[k] = to[k];
    }
}

/* Impulses into the cone, torques within their limits. */
static void project_all(const newton *n, const double *from, double *to)
{
    const system_problem *p = n->problem;

    for (size_t c = 0; c < p->count; c++) {
        double limits[2];
        if (!resist_is_torque(p, c)) {
            cone_project(from + 3 * c, coefficient(n, c), to + 3 * c);
            continue;
        }
        resist_limits(p, c, to[3 * c - 3], limits);
        resist_project(from + 3 * c, limits, to + 3 * c);
    }
}

/* Gauss-Seidel on the proximal problem, twice as long each time. Returns |F|. */
static double smooth(newton *n)
{
    const system_problem *p = n->problem;

    project_all(n, n->r, n->r);
    certificate_velocity(p, n->r, n->dv, n->u);
    for (uint32_t i = 0; i < n->sweeps; i++) {
        for (size_t c = 0; c < p->count; c++) {
            if (resist_has_torque(p, c))
                renew_resisting(n, c);
            else if (!resist_is_torque(p, c))
                renew_contact(n, c);
        }
    }
    n->sweeps = n->sweeps < MOST_SWEEPS ? 2 * n->sweeps : MOST_SWEEPS;
    certificate_velocity(p, n->r, n->dv, n->u);
    return map_all(n, n->r, n->u, n->f, n->mode);
}

/* Greatest of the last few |F|: what the next one is measured against. Letting F rise for a step or
 * two (Grippo, Lampariello & Lucidi, SIAM J. Numer. Anal. 23 (1986) 707) passes kinks sooner. */
static double bound_of(const double *past, uint32_t steps)
{
    double out = 0.0;

    for (uint32_t i = 0; i < MEMORY && i <= steps; i++)
        out = greater(out, past[i]);
    return out;
}

static void move(newton *n)
{
    uint8_t *held = n->mode;

    exchange(&n->r, &n->next_r);
    exchange(&n->u, &n->next_u);
    exchange(&n->f, &n->next_f);
    n->mode = n->next_mode;
    n->next_mode = held;
}

/* Newton on one proximal step until |F| <= enough. Returns 1 if it got there. Where its steps have
 * become short, sweeps find the contacts that slide or part. */
static int solve_proximal(newton *n, double enough, newton_run *run, uint32_t *steps)
{
    double f = n->known >= 0.0 ? n->known : map_all(n, n->r, n->u, n->f, n->mode);
    double past[MEMORY];
    uint32_t short_steps = 0;

    n->known = -1.0;
    n->blur = 0.0;
    for (*steps = 0; *steps < n->inner_steps; ++*steps) {
        double share;
        if (f <= enough)
            return 1;
        run->halted = run->halt != NULL ? run->halt(run->context) : 0;
        if (run->halted != 0 || run->steps >= run->most_steps || !step_once(n, run))
            return 0;
        past[*steps % MEMORY] = f;
        f = search(n, f, bound_of(past, *steps), &share);
        if (!(f <= 1e300) || (share < 1.0 && n->blur > BLIND))
            return 0;
        move(n);
        if (n->blur > BLIND)
            break;
        short_steps = share < SHORT_SHARE ? short_steps + 1 : 0;
        if (short_steps == SHORT_STEPS) {
            f = smooth(n);
            short_steps = 0;
            for (uint32_t i = 0; i < MEMORY; i++)
                past[i] = f;
        }
    }
    return f <= enough;
}

double newton_judge(newton *n, const double *r)
{
    const size_t count = n->problem->count;
    const double alpha = n->alpha;

    project_all(n, r, n->next_r);
    if (r == n->r && is_same(3 * count, r, n->next_r))
        copy(3 * count, n->u, n->next_u);
    else
        certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
    n->alpha = 0.0;
    const double f = map_all(n, n->next_r, n->next_u, n->next_f, n->next_mode);
    n->alpha = alpha;
    const verdict now = certificate_judge(n->problem, n->wanted, n->next_r, n->next_u, n->dv);
    n->distance = now.distance;
    if (is_better(now, n->reached)) {
        n->reached = now;
        copy(3 * count, n->next_r, n->best);
    }
    return f;
}

/* Block (c, d) of W, or null where it is zero. */
static const double *block_at(const system_problem *p, uint32_t c, uint32_t d)
{
    uint32_t low = p->row_starts[c];
    uint32_t high = p->row_starts[c + 1];

    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (p->columns[middle] <= d)
            low = middle;
        else
            high = middle;
    }
    return p->columns[low] == d ? p->blocks + 9 * (size_t)low : NULL;
}

/* 1 if blocks across the diagonal agree to rounding. An unsymmetric rest is only in the direction
 * of a step, not in what the steps lead to. */
static uint32_t is_symmetric(const system_problem *p)
{
    double most = 0.0;
    double odd = 0.0;

    for (uint32_t c = 0; p->bodies == 0 && c < p->count; c++) {
        for (uint32_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
            const uint32_t d = p->columns[k];
            const double *w = p->blocks + 9 * (size_t)k;
            const double *other = block_at(p, d, c);
            for (int i = 0; i < 9; i++) {
                const double across = other != NULL ? other[i % 3 * 3 + i / 3] : 0.0;
                most = greater(most, absolute(w[i]));
                odd = greater(odd, absolute(w[i] - across));
            }
        }
    }
    return odd <= SYMMETRY * most;
}

static void begin(newton *n, const system_problem *problem, const double *r)
{
    double sum = 0.0;
    double most = 0.0;

    n->problem = problem;
    n->reached.residual = n->reached.distance = HUGE_VAL;
    n->symmetric_w = is_symmetric(problem);
    copy(3 * (size_t)problem->count, r, n->r);
    copy(3 * (size_t)problem->count, r, n->best);
    copy(3 * (size_t)problem->count, r, n->center);
    for (size_t c = 0; c < problem->count; c++) {
        const double *w = problem->diagonal + 9 * c;
        double squares = 0.0;
        for (int i = 0; i < 9; i++)
            squares += w[i] * w[i];
        n->gain[c] = sqrt(squares);
        if (resist_is_torque(problem, c) && n->gain[c] == 0.0)
            n->gain[c] = n->gain[c - 1]; /* it can turn nothing, but has its law */
        sum += n->gain[c];
        most = greater(most, n->gain[c]);
    }
    n->unit = 1.0 / power_of_two(scale_exponent(most));
    certificate_velocity(problem, n->r, n->dv, n->u);
    n->size = sum / (double)problem->count;
}

/* The judgement of n->r has mapped it without a proximal term, which is the map where the next
 * proximal step begins, unless the cone held it back. */
static void keep_map(newton *n, double f)
{
    uint8_t *held = n->mode;

    n->known = -1.0;
    if (!is_same(3 * (size_t)n->problem->count, n->r, n->next_r))
        return;
    exchange(&n->f, &n->next_f);
    n->mode = n->next_mode;
    n->next_mode = held;
    n->known = f;
}

/* The next alpha: lower where Newton is at ease. */
static void adapt(newton *n, int solved, uint32_t steps)
{
    const double missing = FAST_FALL * greater(n->distance, 1.0);

    if (!solved) {
        n->alpha *= RISE;
        n->fall = SLOW_FALL;
        return;
    }
    n->sweeps = n->sweeps > LEAST_SWEEPS ? n->sweeps / 2 : LEAST_SWEEPS;
    if (steps <= 1 && n->fall > SLOW_FALL)
        n->fall *= FAST_FALL;
    if (steps >= QUICK)
        return;
    const double fall = steps <= QUICKEST ? lesser(n->fall, missing) : SLOW_FALL;
    const double clear = n->blur > 0.0 ? greater(CLEAR / n->blur, 1.0) : fall;
    n->alpha = greater(n->alpha / lesser(fall, clear), LEAST_ALPHA * n->size);
}

double newton_start(newton *n, const system_problem *problem, const goal *wanted,
                    const newton_run *run, const double *r)
{
    begin(n, problem, r);
    n->wanted = wanted;
    n->outer = newton_judge(n, n->r);
    keep_map(n, n->outer);
    n->alpha = FIRST_ALPHA * n->size;
    n->fall = FAST_FALL;
    n->sweeps = LEAST_SWEEPS;
    n->inner_steps = INNER_STEPS;
    n->won = n->renewed = run->steps;
    n->on_floor = 0;
    step_prepare(n, run);
    return n->distance;
}

uint32_t newton_stalls(const newton *n, const newton_run *run)
{
    return n->on_floor != 0 || run->steps - n->won >= PATIENCE;
}

/* 1 if the best impulses are as good as rounding lets them be, and no better ones come. The longer
 * none come, the more is put down to rounding. */
static uint32_t is_on_floor(newton *n, const newton_run *run)
{
    const double eta = n->reached.distance * n->wanted->tolerance;
    const double idle = (double)(run->steps - n->renewed) / FLOOR_PATIENCE;

    if (n->wanted->measure != TRIBO_MEASURE_ETA || eta > FLOOR_MOST || idle < 1.0)
        return 0;
    return eta <= idle * FLOOR_GROWTH * certificate_growth(n->problem, n->best, n->dv);
}

/* One proximal step. */
static void advance(newton *n, newton_run *run)
{
    const double before = n->reached.residual;
    const double enough = greater(INNER_SHARE * n->outer, 0.1 * n->outer / n->distance);
    uint32_t steps;

    copy(3 * (size_t)n->problem->count, n->r, n->center);
    const int solved = solve_proximal(n, enough, run, &steps);
    if (run->halted != 0 || run->status != TRIBO_OK)
        return;
    const double now = newton_judge(n, n->r);
    const int good = now < 10.0 * n->outer && n->distance < HUGE_VAL;
    adapt(n, solved && good, steps);
    if (steps == 0) {
        /* Nothing to do but what bringing r into the cone undoes: go on from there. It counts as a
         * step, so that steps end. */
        run->steps++;
        n->outer = now;
        move(n);
        n->known = now;
    } else if (good) {
        n->outer = solved ? now : lesser(n->outer, now);
        keep_map(n, now);
    } else {
        copy(3 * (size_t)n->problem->count, n->center, n->r);
        certificate_velocity(n->problem, n->r, n->dv, n->u);
    }
    n->won = n->reached.residual < 0.9 * before ? run->steps : n->won;
    n->renewed = n->reached.residual < before ? run->steps : n->renewed;
    n->on_floor = is_on_floor(n, run);
}

double newton_finish(newton *n, newton_run *run, const double *from, double *r)
{
    double before = HUGE_VAL;

    copy(3 * (size_t)n->problem->count, from, n->r);
    certificate_velocity(n->problem, n->r, n->dv, n->u);
    n->outer = newton_judge(n, n->r);
    keep_map(n, n->outer);
    n->alpha = LAST_ALPHA * n->size;
    n->fall = FAST_FALL;
    n->inner_steps = LAST_STEPS;
    while (n->distance > 1.0 && n->distance < LAST_REST * before && central_may_go(run)) {
        before = n->distance;
        advance(n, run);
    }
    n->inner_steps = INNER_STEPS;
    copy(3 * (size_t)n->problem->count, n->best, r);
    return n->reached.distance;
}

double newton_continue(newton *n, newton_run *run, uint64_t steps, double *r)
{
    const uint64_t first = run->steps;

    while (n->distance > 1.0 && run->steps - first < steps && run->steps < run->most_steps &&
           run->halted == 0 && run->status == TRIBO_OK && !newton_stalls(n, run))
        advance(n, run);
    if (n->reached.distance > 1.0)
        run->growth = certificate_growth(n->problem, n->r, n->dv);
    copy(3 * (size_t)n->problem->count, n->best, r);
    return n->reached.distance;
}
