#include "newton_state.h"

#include "resist.h"

/* Coordinates in which friction cones are round and dual to themselves, by contact:
 *
 *   x = g (mu r_n, r_t),  y = (u_n / mu + s, u_t),  x . y = g r . (u + mu s e_n),
 *
 * g a power of two near |W|. Both are in Q = {|v_t| <= v_n}, and in the end x . y = 0. A contact of
 * one row has x = g r_n and y = u_n. Nesterov and Todd's scaling takes both to the same point,
 * V y = V^-1 x = lambda:
 *
 *   V = b [w_n, w_t^T; w_t, 1 + w_t w_t^T / (1 + w_n)],  V^2 = b^2 (2 w w^T - J),  w . J w = 1,
 *
 * J = diag(1, -1, -1). See Andersen, Roos & Terlaky, Math. Program. 95 (2003) 249, for it and for
 * the steps, Mehrotra's predictor and corrector. */

#define MOST_STEPS 60
#define INNER_TOLERANCE 1e-10 /* of x . y and of y - y(u), against those of the start */
#define SURPLUS 1e-3          /* of the goal's distance: the last steps gain most */
#define SHORTEST 1e-4         /* of a step's length: it goes no further */
#define BOUNDARY 0.98         /* of the way to the edge of the cones */
#define LEAST_CENTERING 1e-8
/* Where the convex problem gets nearer to its own solution, but not to that of Coulomb's law: steps
 * without progress, and how far x . y falls meanwhile. */
#define PATIENCE 4
#define PROGRESS 0.9
#define IDLE_FALL 1e-3

typedef struct scaling {
    double w[3];
    double b;
} scaling;

/* ---- cones ----------------------------------------------------------------------------------- */

/* v . J v, without squares that cancel. */
static double determinant(const double v[3])
{
    const double t = sqrt(v[1] * v[1] + v[2] * v[2]);
    return (v[0] - t) * (v[0] + t);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns 0 if x or y is not inside. */
static int scale_cone(const double x[3], const double y[3], scaling *out)
{
    const double dx = determinant(x);
    const double dy = determinant(y);

    if (!(dx > 0.0 && dy > 0.0 && x[0] > 0.0 && y[0] > 0.0))
        return 0;
    const double ix = 1.0 / sqrt(dx);
    const double iy = 1.0 / sqrt(dy);
    const double half = 0.5 / sqrt(0.5 * (1.0 + ix * iy * dot(x, y)));
    out->w[0] = half * (ix * x[0] + iy * y[0]);
    out->w[1] = half * (ix * x[1] - iy * y[1]);
    out->w[2] = half * (ix * x[2] - iy * y[2]);
    out->b = sqrt(iy / ix);
    return 1;
}

/* out = V v, or V^-1 v with sign -1. */
static void scale(const scaling *s, double sign, const double v[3], double out[3])
{
    const double b = sign > 0.0 ? s->b : 1.0 / s->b;
    const double along = s->w[1] * v[1] + s->w[2] * v[2];
    const double more = sign * v[0] + along / (1.0 + s->w[0]);

    out[0] = b * (s->w[0] * v[0] + sign * along);
    out[1] = b * (v[1] + more * s->w[1]);
    out[2] = b * (v[2] + more * s->w[2]);
}

/* Solve l o t = b for t, o the product of the algebra of Q: (a . b, a_n b_t + b_n a_t). */
static void divide(const double l[3], const double b[3], double t[3])
{
    t[0] = (l[0] * b[0] - l[1] * b[1] - l[2] * b[2]) / determinant(l);
    t[1] = (b[1] - t[0] * l[1]) / l[0];
    t[2] = (b[2] - t[0] * l[2]) / l[0];
}

/* Greatest a <= 1 with v + a d in Q. */
static double longest(const double v[3], const double d[3])
{
    const double square = d[0] * d[0] - d[1] * d[1] - d[2] * d[2];
    const double middle = v[0] * d[0] - v[1] * d[1] - v[2] * d[2];
    const double rest = determinant(v);
    const double under = middle * middle - square * rest;
    double a = d[0] < 0.0 ? lesser(1.0, -v[0] / d[0]) : 1.0;

    if (under < 0.0)
        return a;
    /* square a^2 + 2 middle a + rest = 0: the roots are -p / square and -rest / p */
    const double p = middle + (middle >= 0.0 ? sqrt(under) : -sqrt(under));
    const double roots[2] = {-p / square, -rest / p};
    for (int i = 0; i < 2; i++) {
        if (roots[i] > 0.0)
            a = lesser(a, roots[i]);
    }
    return a;
}

/* ---- coordinates ----------------------------------------------------------------------------- */

static int has_friction(const newton *n, size_t c)
{
    return coefficient(n, c) > 0.0;
}

static double friction(const newton *n, size_t c)
{
    return has_friction(n, c) ? coefficient(n, c) : 1.0;
}

static void tangents(const newton *n, size_t c, const double from[3], double to[3])
{
    to[1] = has_friction(n, c) ? from[1] : 0.0;
    to[2] = has_friction(n, c) ? from[2] : 0.0;
}

/* x of r, and y of u but for s. */
static void primal_of(const newton *n, size_t c, const double r[3], double x[3])
{
    x[0] = friction(n, c) * r[0];
    tangents(n, c, r, x);
    for (int k = 0; k < 3; k++)
        x[k] *= n->unit;
}

static void dual_of(const newton *n, size_t c, const double u[3], double y[3])
{
    y[0] = u[0] / friction(n, c);
    tangents(n, c, u, y);
}

/* r of all x. */
static void impulses_of(const newton *n, double *r)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        r[3 * c] = n->primal[3 * c] / friction(n, c);
        tangents(n, c, n->primal + 3 * c, r + 3 * c);
        for (size_t k = 3 * c; k < 3 * c + 3; k++)
            r[k] /= n->unit;
    }
}

/* ---- one step -------------------------------------------------------------------------------- */

/* dr = -D du + ..., D = V^2 in the units of r and u. Bodies: own 1, slope D; blocks, to be symmetric:
 * own D^-1, slope 1. */
static void fill_law(newton *n, size_t c, const scaling *s)
{
    const int inverse = n->problem->bodies == 0;
    const double mu = friction(n, c);
    const double b = inverse ? n->unit / (s->b * s->b) : s->b * s->b / n->unit;
    const double sign = inverse ? -1.0 : 1.0;
    const double unit[3] = {inverse ? mu : 1.0 / mu, 1.0, 1.0};
    const double w[3] = {s->w[0], sign * s->w[1], sign * s->w[2]};
    double *law = inverse ? n->own + 9 * c : n->slope + 9 * c;
    double *one = inverse ? n->slope + 9 * c : n->own + 9 * c;

    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            const double j = i != k ? 0.0 : i == 0 ? -1.0 : 1.0;
            const int kept = has_friction(n, c) || (i == 0 && k == 0);
            law[3 * i + k] = kept ? unit[i] * unit[k] * b * (2.0 * w[i] * w[k] + j) : 0.0;
            one[3 * i + k] = i == k ? 1.0 : 0.0;
        }
    }
    n->mode[c] = STICK;
}

/* The right-hand side of lambda o (V^-1 dx + V dy) = lambda o t, with dy by du and `off`. */
static void fill_right(newton *n, size_t c, const scaling *s, const double t[3],
                       const double off[3])
{
    const int blocks = n->problem->bodies == 0;
    double *right = n->right + 3 * c;
    double held[3];
    double moved[3];

    scale(s, 1.0, off, held);
    for (int k = 0; k < 3; k++)
        held[k] = held[k] - t[k];
    scale(s, blocks ? -1.0 : 1.0, held, moved);
    right[0] = blocks ? friction(n, c) * moved[0] : moved[0] / friction(n, c);
    tangents(n, c, moved, right);
    for (int k = 0; k < 3 && !blocks; k++)
        right[k] /= n->unit;
}

/* y(u) + s e - y: what y lacks. */
static void lack(const newton *n, size_t c, double off[3])
{
    dual_of(n, c, n->next_u + 3 * c, off);
    off[0] += n->slip[c];
    for (size_t k = 0; k < 3; k++)
        off[k] -= n->dual[3 * c + k];
}

/* Towards x . y = 0: t = -lambda. Returns 0 at the edge of a cone. */
static int predict(newton *n)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        const double *y = n->dual + 3 * c;
        scaling s;
        double lambda[3];
        double off[3];
        if (!scale_cone(n->primal + 3 * c, y, &s))
            return 0;
        scale(&s, 1.0, y, lambda);
        for (int k = 0; k < 3; k++)
            lambda[k] = -lambda[k];
        lack(n, c, off);
        fill_law(n, c, &s);
        fill_right(n, c, &s, lambda, off);
    }
    n->symmetric = n->symmetric_w;
    return 1;
}

/* Towards x o y = target e, with the second order of the step before. */
static void correct(newton *n, double target)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        const double *y = n->dual + 3 * c;
        scaling s;
        double lambda[3];
        double dx[3];
        double dy[3];
        double off[3];
        double b[3];
        double t[3];
        if (!scale_cone(n->primal + 3 * c, y, &s))
            return;
        scale(&s, 1.0, y, lambda);
        scale(&s, -1.0, n->next_r + 3 * c, dx);
        scale(&s, 1.0, n->next_f + 3 * c, dy);
        b[0] = target - dot(dx, dy);
        for (int k = 1; k < 3; k++)
            b[k] = -(dx[0] * dy[k] + dy[0] * dx[k]);
        divide(lambda, b, t);
        for (int k = 0; k < 3; k++)
            t[k] -= lambda[k];
        lack(n, c, off);
        fill_right(n, c, &s, t, off);
    }
}

/* dx to next_r and dy to next_f, from `step`. Returns the share of them that stays in the cones. */
static double directions(newton *n)
{
    const system_problem *p = n->problem;
    double share = 1.0;

    certificate_velocity(p, n->step, n->dv, n->moved);
    for (size_t c = 0; c < p->count; c++) {
        double *dx = n->next_r + 3 * c;
        double *dy = n->next_f + 3 * c;
        double du[3];
        double off[3];
        for (size_t k = 0; k < 3; k++)
            du[k] = n->moved[3 * c + k] - p->q[3 * c + k];
        primal_of(n, c, n->step + 3 * c, dx);
        dual_of(n, c, du, dy);
        lack(n, c, off);
        for (int k = 0; k < 3; k++)
            dy[k] += off[k];
        share = lesser(share, longest(n->primal + 3 * c, dx));
        share = lesser(share, longest(n->dual + 3 * c, dy));
    }
    return share;
}

/* Mean x . y after a share of the step. */
static double gap_at(const newton *n, double share)
{
    double sum = 0.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        for (size_t i = 3 * c; i < 3 * c + 3; i++)
            sum += (n->primal[i] + share * n->next_r[i]) * (n->dual[i] + share * n->next_f[i]);
    }
    return sum / (double)n->problem->count;
}

/* Returns the share of the step that was gone; 0: no more can be done. */
static double go(newton *n, newton_run *run)
{
    impulses_of(n, n->next_r);
    certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
    run->steps++;
    if (!predict(n) || !step_solve(n, run))
        return 0.0;
    const double ahead = gap_at(n, directions(n));
    const double gap = gap_at(n, 0.0);
    const double rest = lesser(absolute(ahead) / gap, 1.0);
    correct(n, gap * greater(rest * rest * rest, LEAST_CENTERING));
    if (!step_again(n, run))
        return 0.0;
    const double share = lesser(1.0, BOUNDARY * directions(n));
    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++) {
        n->primal[i] += share * n->next_r[i];
        n->dual[i] += share * n->next_f[i];
    }
    return share;
}

/* ---- rounds ---------------------------------------------------------------------------------- */

/* x and y in the middle of the cones, of the size of the greatest velocity. */
static void start_inside(newton *n)
{
    double most = 0.0;

    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++)
        most = greater(most, absolute(n->problem->q[i]));
    for (size_t c = 0; c < n->problem->count; c++) {
        double *x = n->primal + 3 * c;
        double *y = n->dual + 3 * c;
        x[0] = y[0] = most;
        x[1] = x[2] = y[1] = y[2] = 0.0;
    }
}

static void keep_slip(newton *n)
{
    impulses_of(n, n->next_r);
    certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
    for (size_t c = 0; c < n->problem->count; c++) {
        const double *u = n->next_u + 3 * c;
        n->slip[c] = has_friction(n, c) ? sqrt(u[1] * u[1] + u[2] * u[2]) : 0.0;
    }
}

uint32_t interior_possible(const system_problem *problem)
{
    for (size_t c = 0; c < problem->count; c++) {
        if (resist_is_torque(problem, c))
            return 0;
    }
    return 1;
}

void interior_start(newton *n)
{
    for (size_t c = 0; c < n->problem->count; c++)
        n->slip[c] = 0.0;
}

/* What the best distance in a round was, when, and x . y then. */
typedef struct progress {
    double distance, gap;
    int step;
} progress;

/* Note where a round is. Returns 1 if it leads elsewhere. */
static int is_idle(const newton *n, int step, double gap, progress *best)
{
    if (n->distance < PROGRESS * best->distance) {
        best->distance = n->distance;
        best->gap = gap;
        best->step = step;
    }
    return step - best->step >= PATIENCE || gap < IDLE_FALL * best->gap;
}

double interior_round(newton *n, newton_run *run, double *r)
{
    const double held = n->distance;
    progress best = {HUGE_VAL, 0.0, 0};
    double share = 1.0;

    start_inside(n);
    const double enough = INNER_TOLERANCE * gap_at(n, 0.0);
    for (int i = 0; i < MOST_STEPS && share > SHORTEST; i++) {
        run->halted = run->halt != NULL ? run->halt(run->context) : 0;
        if (run->halted != 0 || run->steps >= run->most_steps || run->status != TRIBO_OK)
            break;
        share = go(n, run);
        impulses_of(n, n->moved);
        const double before = n->distance;
        newton_judge(n, n->moved);
        const double gap = gap_at(n, 0.0);
        if (gap <= enough || n->distance <= SURPLUS || is_idle(n, i, gap, &best) ||
            (n->reached.distance <= 1.0 && n->distance > 0.3 * before))
            break;
    }
    keep_slip(n);
    n->distance = held;
    copy(3 * (size_t)n->problem->count, n->best, r);
    return n->reached.distance;
}
