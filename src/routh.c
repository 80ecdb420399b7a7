/* Routh's impact law: Coulomb friction along the growing normal impulse (Keller, J. Appl. Mech. 53
 * (1986) 1).
 *
 * While the contact slips with s = u_t / |u_t|,
 *     du_t/dp_n = w - mu D s,   du_n/dp_n = a - mu w . s,   dp_t/dp_n = -mu s,
 * a = W_nn, w = W_tn, D = W_tt. Three kinds of pieces follow each other:
 *  - s turns: a step of a Taylor series in tau, dp_n = |u_t| dtau, in which the equations are
 *    polynomial but for r = |u_t|, whose series follows from r^2 = x^2 + y^2;
 *  - s has settled (its rate depends on s alone, so it stays): everything is linear in p_n;
 *  - u_t = 0: it stays if friction can hold it, |D^-1 w| <= mu_s, else slip starts along the one s
 *    with (mu D + k) s = w, k > 0. Linear as well.
 * Compression ends at u_n = 0; restitution by Newton's, Poisson's or Stronge's hypothesis. */
#include "impact.h"

enum { ORDER = 20, MAX_PIECES = 4000 };
#define SETTLED \
    1e-16             /* turning rate of s, relative, below which its direction counts as
                              constant */
#define STOPPED 1e-16 /* |u_t| relative to the velocity at the start that counts as zero */
#define SERIES_ERROR 1e-17

typedef struct routh_state {
    double un, ut[2];
    double pn, pt[2];
    double coupled; /* integral of u_n w . dp_t since the last end of compression */
    double work;    /* integral of u_n dp_n since then */
} routh_state;

typedef struct routh_problem {
    double a, w[2], d[3]; /* d = (11, 12, 22) */
    double mu_s, mu_d, e;
    double rate; /* |w| + mu |D|: bound of the rates in tau */
    uint32_t law;
    double start; /* u_n before the impact */
    int restituting;
    double compression; /* p_n at greatest compression */
    double spent;       /* integral of u_n dp_n up to there, negative */
    double reference;   /* u_n where state.work counts from */
    double goal;        /* u_n, p_n or work at which restitution ends, by law */
} routh_problem;

/* Rates per unit of p_n in a linear piece. */
typedef struct routh_slope {
    double un, ut[2], pt[2];
} routh_slope;

static double length_of(const double x[2])
{
    return sqrt(x[0] * x[0] + x[1] * x[1]);
}

static void apply_tangent(const routh_problem *c, const double x[2], double out[2])
{
    out[0] = c->d[0] * x[0] + c->d[1] * x[1];
    out[1] = c->d[1] * x[0] + c->d[2] * x[1];
}

/* ---- phases ---------------------------------------------------------------------------------- */

/* The phase ends where one of these rises to the phase's goal. */
static double phase_goal(const routh_problem *c)
{
    return c->restituting ? c->goal : 0.0;
}

static int ends_by_velocity(const routh_problem *c)
{
    return !c->restituting || c->law == TRIBO_LAW_ROUTH_NEWTON;
}

static double phase_value(const routh_problem *c, const routh_state *state)
{
    if (ends_by_velocity(c)) {
        return state->un;
    }
    return c->law == TRIBO_LAW_ROUTH_POISSON ? state->pn : state->work;
}

/* Poisson's and Stronge's restitution start anew if turning slip compresses the contact again. */
static int may_compress_again(const routh_problem *c)
{
    return c->restituting && c->law != TRIBO_LAW_ROUTH_NEWTON;
}

/* A phase that ends by u_n ends exactly there: p_n follows from p_t, free of what rounding added
 * up. */
static void meet_goal(const routh_problem *c, routh_state *state)
{
    if (ends_by_velocity(c)) {
        const double coupled = c->w[0] * state->pt[0] + c->w[1] * state->pt[1];
        state->un = phase_goal(c);
        state->pn = (state->un - c->start - coupled) / c->a;
    }
}

/* Compression has ended; returns 1 if restitution has nothing to do. */
static int begin_restitution(routh_problem *c, routh_state *state)
{
    c->restituting = 1;
    c->compression = state->pn;
    c->spent += state->work;
    c->reference = 0.0;
    state->work = 0.0;
    state->coupled = 0.0;
    switch (c->law) {
    case TRIBO_LAW_ROUTH_NEWTON:
        c->goal = -c->e * c->start;
        break;
    case TRIBO_LAW_ROUTH_POISSON:
        c->goal = (1.0 + c->e) * state->pn;
        break;
    default:
        c->goal = -c->e * c->e * c->spent;
        break;
    }
    return c->e == 0.0;
}

/* ---- linear pieces --------------------------------------------------------------------------- */

/* Normal impulse from here to the end of the phase; negative: never. */
static double phase_length(const routh_problem *c, const routh_state *state, double slope)
{
    const double gap = phase_goal(c) - phase_value(c, state);
    if (c->restituting && c->law == TRIBO_LAW_ROUTH_POISSON) {
        return gap;
    }
    if (c->restituting && c->law == TRIBO_LAW_ROUTH_STRONGE) {
        const double square = state->un * state->un + 2.0 * slope * gap;
        if (gap == 0.0) { /* e^2 times the work of compression may be less than any double */
            return 0.0;
        }
        return square >= 0.0 ? 2.0 * gap / (state->un + sqrt(square)) : -1.0;
    }
    return slope > 0.0 ? gap / slope : -1.0;
}

/* Work of the normal impulse: with du_n = a dp_n + w . dp_t, it is exact where nothing couples. */
static double normal_work(const routh_problem *c, double un, double coupled)
{
    return (0.5 * (un * un - c->reference * c->reference) - coupled) / c->a;
}

/* u_n and the work follow from the impulse: rounding of the pieces does not add up in them. */
static void renew_velocity(const routh_problem *c, routh_state *state)
{
    state->un = c->start + (c->a * state->pn + (c->w[0] * state->pt[0] + c->w[1] * state->pt[1]));
    state->work = normal_work(c, state->un, state->coupled);
}

static void advance_linearly(const routh_problem *c, const routh_slope *slope, double length,
                             routh_state *state)
{
    const double pull = c->w[0] * slope->pt[0] + c->w[1] * slope->pt[1];
    state->coupled += length * (state->un + 0.5 * length * slope->un) * pull;
    state->pn += length;
    for (int i = 0; i < 2; i++) {
        state->ut[i] += length * slope->ut[i];
        state->pt[i] += length * slope->pt[i];
    }
    renew_velocity(c, state);
}

/* Go along until slip stops (after `room` of normal impulse; negative: never) or the impact ends.
 * Returns 1 at the end, -1 if it never comes. */
static int run_linearly(routh_problem *c, const routh_slope *slope, double room, routh_state *state)
{
    for (;;) {
        double length = phase_length(c, state, slope->un);
        if (may_compress_again(c) && slope->un < 0.0) {
            const double falling = -state->un / slope->un;
            if (length < 0.0 || falling < length) {
                c->restituting = room >= 0.0 && falling >= room;
                length = -1.0;
            }
        }
        if (room >= 0.0 && (length < 0.0 || length > room)) {
            advance_linearly(c, slope, room, state);
            state->ut[0] = state->ut[1] = 0.0;
            return 0;
        }
        if (length < 0.0 || !(length - length == 0.0)) {
            return -1;
        }
        advance_linearly(c, slope, length, state);
        meet_goal(c, state);
        room = room >= 0.0 ? greater(room - length, 0.0) : room;
        if (c->restituting || begin_restitution(c, state)) {
            return 1;
        }
    }
}

static void slip_slope(const routh_problem *c, const double s[2], double growth, routh_slope *slope)
{
    slope->un = c->a - c->mu_d * (c->w[0] * s[0] + c->w[1] * s[1]);
    for (int i = 0; i < 2; i++) {
        slope->ut[i] = growth * s[i];
        slope->pt[i] = -c->mu_d * s[i];
    }
}

/* Eigenvalues of D and w in its eigenbasis; as in kernel_prepare. */
typedef struct routh_basis {
    double lam[2], w[2], x, y;
} routh_basis;

static routh_basis tangent_basis(const routh_problem *c)
{
    routh_basis basis;
    const double half = 0.5 * (c->d[0] - c->d[2]);
    const double r = sqrt(half * half + c->d[1] * c->d[1]);
    const double along = r + absolute(half);
    const double length = sqrt(along * along + c->d[1] * c->d[1]);
    const double cx = length > 0.0 ? along / length : 1.0;
    const double cy = length > 0.0 ? c->d[1] / length : 0.0;
    basis.x = half >= 0.0 ? cx : cy;
    basis.y = half >= 0.0 ? cy : cx;
    basis.lam[0] = 0.5 * (c->d[0] + c->d[2]) + r;
    basis.lam[1] =
        basis.lam[0] > 0.0 ? (c->d[0] * c->d[2] - c->d[1] * c->d[1]) / basis.lam[0] : 0.0;
    basis.w[0] = basis.x * c->w[0] + basis.y * c->w[1];
    basis.w[1] = basis.x * c->w[1] - basis.y * c->w[0];
    return basis;
}

/* out = (mu D + k)^-1 w in the caller's tangents. An axis without mobility has no w either. */
static void shifted_solve(const routh_basis *basis, double mu, double k, double out[2])
{
    double x[2];
    for (int i = 0; i < 2; i++) {
        const double g = mu * basis->lam[i] + k;
        const double least = SINGULAR_TOLERANCE * (mu * basis->lam[0]);
        x[i] = g > least ? basis->w[i] / g : 0.0;
    }
    out[0] = x[0] * basis->x - x[1] * basis->y;
    out[1] = x[0] * basis->y + x[1] * basis->x;
}

/* The k > 0 with |(mu D + k)^-1 w| = 1, by bisection on bit patterns: that length falls with k. */
static double outgoing_growth(const routh_basis *basis, double mu)
{
    uint64_t low = 0;
    uint64_t high = bits_of(2.0 * length_of(basis->w));
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        double s[2];
        shifted_solve(basis, mu, double_of(middle), s);
        if (length_of(s) > 1.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return double_of(high);
}

/* From u_t = 0 to the end. */
static int run_from_rest(routh_problem *c, routh_state *state, double *mode)
{
    const routh_basis basis = tangent_basis(c);
    routh_slope slope;
    double hold[2];
    shifted_solve(&basis, 1.0, 0.0, hold);
    if (length_of(hold) <= c->mu_s) {
        *mode = KERNEL_STICK;
        slope.un = c->a - (c->w[0] * hold[0] + c->w[1] * hold[1]);
        slope.ut[0] = slope.ut[1] = 0.0;
        slope.pt[0] = -hold[0];
        slope.pt[1] = -hold[1];
    } else {
        double s[2];
        const double growth = outgoing_growth(&basis, c->mu_d);
        shifted_solve(&basis, c->mu_d, growth, s);
        const double length = length_of(s);
        s[0] /= length;
        s[1] /= length;
        *mode = KERNEL_SLIP;
        slip_slope(c, s, growth, &slope);
    }
    return run_linearly(c, &slope, -1.0, state);
}

/* ---- turning slip: Taylor series ------------------------------------------------------------- */

typedef struct routh_series {
    double x[ORDER + 1], y[ORDER + 1], r[ORDER + 1];
    double un[ORDER + 1], pn[ORDER + 1], px[ORDER + 1], py[ORDER + 1];
    double pull[ORDER + 1],
        coupled[ORDER + 1]; /* w . dp_t/dtau, and the integral of u_n times that */
} routh_series;

static double convolve(const double *a, const double *b, int from, int to, int k)
{
    double sum = 0.0;
    for (int i = from; i <= to; i++) {
        sum += a[i] * b[k - i];
    }
    return sum;
}

static void expand(const routh_problem *c, const routh_state *state, routh_series *t)
{
    const double mu = c->mu_d;
    t->x[0] = state->ut[0];
    t->y[0] = state->ut[1];
    t->un[0] = state->un;
    t->pn[0] = state->pn;
    t->px[0] = state->pt[0];
    t->py[0] = state->pt[1];
    t->coupled[0] = state->coupled;
    t->r[0] = length_of(state->ut);
    for (int k = 0; k < ORDER; k++) {
        const double share = 1.0 / (k + 1);
        if (k > 0) {
            const double square = convolve(t->x, t->x, 0, k, k) + convolve(t->y, t->y, 0, k, k) -
                                  convolve(t->r, t->r, 1, k - 1, k);
            t->r[k] = square / (2.0 * t->r[0]);
        }
        const double fx = c->d[0] * t->x[k] + c->d[1] * t->y[k];
        const double fy = c->d[1] * t->x[k] + c->d[2] * t->y[k];
        const double fn = c->w[0] * t->x[k] + c->w[1] * t->y[k];
        t->x[k + 1] = share * (c->w[0] * t->r[k] - mu * fx);
        t->y[k + 1] = share * (c->w[1] * t->r[k] - mu * fy);
        t->un[k + 1] = share * (c->a * t->r[k] - mu * fn);
        t->pn[k + 1] = share * t->r[k];
        t->px[k + 1] = -share * mu * t->x[k];
        t->py[k + 1] = -share * mu * t->y[k];
        t->pull[k] = -mu * fn;
        t->coupled[k + 1] = share * convolve(t->un, t->pull, 0, k, k);
    }
}

static double sum_series(const double *terms, double tau)
{
    double sum = terms[ORDER];
    for (int k = ORDER - 1; k >= 0; k--) {
        sum = sum * tau + terms[k];
    }
    return sum;
}

static void evaluate(const routh_problem *c, const routh_series *t, double tau, routh_state *state)
{
    state->ut[0] = sum_series(t->x, tau);
    state->ut[1] = sum_series(t->y, tau);
    state->pn = sum_series(t->pn, tau);
    state->pt[0] = sum_series(t->px, tau);
    state->pt[1] = sum_series(t->py, tau);
    state->coupled = sum_series(t->coupled, tau);
    renew_velocity(c, state);
}

/* Greatest step, by halves, whose last two terms are negligible beside |u_t|. */
static double series_step(const routh_problem *c, const routh_series *t)
{
    const double limit = SERIES_ERROR * t->r[0];
    double h = 4.0 / c->rate;
    for (int tries = 0; tries < 60; tries++) {
        double power = 1.0;
        for (int k = 0; k < ORDER - 1; k++) {
            power *= h;
        }
        const double before = power * (absolute(t->x[ORDER - 1]) + absolute(t->y[ORDER - 1]));
        const double last = power * h * (absolute(t->x[ORDER]) + absolute(t->y[ORDER]));
        if (before + last <= limit) {
            break;
        }
        h *= 0.5;
    }
    return h;
}

/* phase_value at tau, from no more series than it needs. */
static double series_value(const routh_problem *c, const routh_series *t, double tau)
{
    if (c->restituting && c->law == TRIBO_LAW_ROUTH_POISSON) {
        return sum_series(t->pn, tau);
    }
    const double un = sum_series(t->un, tau);
    return ends_by_velocity(c) ? un : normal_work(c, un, sum_series(t->coupled, tau));
}

/* tau in (0, h] at which the phase ends, known to end within; bisection on bit patterns. */
static double event_time(const routh_problem *c, const routh_series *t, double h)
{
    const double goal = phase_goal(c);
    uint64_t low = 0;
    uint64_t high = bits_of(h);
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        if (series_value(c, t, double_of(middle)) >= goal) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return double_of(high);
}

/* One step of turning slip. Returns 1 at the end of the impact. */
static int run_turning(routh_problem *c, routh_state *state)
{
    routh_series t;
    routh_state next;
    expand(c, state, &t);
    const double h = series_step(c, &t);
    evaluate(c, &t, h, &next);
    const int goes_on = phase_value(c, &next) < phase_goal(c);
    if (!goes_on) {
        evaluate(c, &t, event_time(c, &t, h), &next);
        meet_goal(c, &next);
    }
    *state = next;
    if (may_compress_again(c) && next.un < 0.0) {
        c->restituting = 0;
        return 0;
    }
    if (goes_on) {
        return 0;
    }
    return c->restituting || begin_restitution(c, state);
}

/* ---- the whole impact ------------------------------------------------------------------------ */

/* Slip without friction: linear whichever way it turns. It stops on the way only if w is straight
 * against it. */
static int run_without_friction(routh_problem *c, double r, routh_state *state)
{
    const routh_slope slope = {c->a, {c->w[0], c->w[1]}, {0.0, 0.0}};
    const double across = state->ut[0] * c->w[1] - state->ut[1] * c->w[0];
    const double along = state->ut[0] * c->w[0] + state->ut[1] * c->w[1];
    const int stops = across == 0.0 && along < 0.0;
    return run_linearly(c, &slope, stops ? r / length_of(c->w) : -1.0, state);
}

/* One piece from slip at speed r. Returns as run_linearly. */
static int run_slip(routh_problem *c, double r, int force_linear, routh_state *state)
{
    const double s[2] = {state->ut[0] / r, state->ut[1] / r};
    double g[2];
    apply_tangent(c, s, g);
    g[0] = c->w[0] - c->mu_d * g[0];
    g[1] = c->w[1] - c->mu_d * g[1];
    const double turning = s[0] * g[1] - s[1] * g[0];
    if (absolute(turning) > SETTLED * c->rate && !force_linear) {
        return run_turning(c, state);
    }
    routh_slope slope;
    const double growth = s[0] * g[0] + s[1] * g[1];
    slip_slope(c, s, growth, &slope);
    return run_linearly(c, &slope, growth < 0.0 ? -r / growth : -1.0, state);
}

/* An approach that ends before slip has changed is one linear piece under every law; and its
 * squares, of which Stronge's work is made, may be no doubles. Returns 0 where slip does change. */
static int run_grazing(routh_problem *c, double r, routh_state *state)
{
    const double s[2] = {state->ut[0] / r, state->ut[1] / r};
    routh_slope slope;
    slip_slope(c, s, 0.0, &slope);
    const double compression = -c->start / slope.un;
    const double normal = (1.0 + c->e) * compression;
    if (!(slope.un > 0.0 && normal * c->rate <= SERIES_ERROR * r)) {
        return 0;
    }
    c->compression = compression;
    state->pn = normal;
    state->pt[0] = normal * slope.pt[0];
    state->pt[1] = normal * slope.pt[1];
    return 1;
}

double routh_scaled(const kernel_problem *problem, const tribo_material *pair, uint32_t law,
                    double p[3], tribo_impact_info *info)
{
    routh_problem c = {0};
    routh_state state = {0};
    c.a = problem->nn;
    c.w[0] = problem->n1;
    c.w[1] = problem->n2;
    c.d[0] = problem->t11;
    c.d[1] = problem->t12;
    c.d[2] = problem->t22;
    c.mu_s = pair->mu_s;
    c.mu_d = pair->mu_d;
    c.e = pair->e;
    c.rate = absolute(c.w[0]) + absolute(c.w[1]) + c.mu_d * (c.d[0] + c.d[2]);
    c.law = law;
    c.start = problem->bn;
    c.reference = problem->bn;
    state.un = problem->bn;
    state.ut[0] = problem->b1;
    state.ut[1] = problem->b2;
    const double stopped = STOPPED * (absolute(problem->bn) + length_of(state.ut));
    double mode = KERNEL_SLIP;
    int ended = 0;
    while (ended == 0) {
        const double r = length_of(state.ut);
        const int force_linear = info->iterations >= MAX_PIECES;
        if (r <= stopped) {
            ended = run_from_rest(&c, &state, &mode);
        } else if (info->iterations == 0 && run_grazing(&c, r, &state)) {
            ended = 1;
        } else if (c.mu_d == 0.0) {
            ended = run_without_friction(&c, r, &state);
        } else {
            ended = run_slip(&c, r, force_linear, &state);
        }
        info->iterations++;
    }
    if (ended < 0) {
        return KERNEL_JAM;
    }
    /* What rounding put outside of the cone comes back. */
    const double friction = length_of(state.pt);
    const double limit = c.mu_s * state.pn;
    const double share = friction > limit ? limit / friction : 1.0;
    p[0] = state.pn;
    p[1] = share * state.pt[0];
    p[2] = share * state.pt[1];
    info->compression = c.compression;
    return mode;
}
