#include "central.h"

#define BOUNDARY 0.98 /* of the way to the edge of the cones */
#define LEAST_CENTERING 1e-8
#define ACCURACY 1e-3 /* of the solution of a step */
#define REFINEMENTS 4

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

void central_impulses(const newton *n, double *r)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        r[3 * c] = n->primal[3 * c] / friction(n, c);
        tangents(n, c, n->primal + 3 * c, r + 3 * c);
        for (size_t k = 3 * c; k < 3 * c + 3; k++)
            r[k] /= n->unit;
    }
}

void central_place(newton *n)
{
    if (n->is_placed != 0)
        return;
    central_impulses(n, n->next_r);
    certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
}

/* How s follows: the derivative of |u_t|, 0 where it has none, at the pace. */
static void slip_slope(const newton *n, size_t c, double e[2])
{
    const double *u = n->next_u + 3 * c;
    const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);

    e[0] = has_friction(n, c) && slip > 0.0 ? n->pace * (u[1] / slip) : 0.0;
    e[1] = has_friction(n, c) && slip > 0.0 ? n->pace * (u[2] / slip) : 0.0;
}

/* y(u) + s e - y: what y lacks. */
static void lack(const newton *n, size_t c, double off[3])
{
    const double *u = n->next_u + 3 * c;

    dual_of(n, c, u, off);
    if (n->follows == 0)
        off[0] += n->slip[c];
    else if (has_friction(n, c))
        off[0] += sqrt(u[1] * u[1] + u[2] * u[2]);
    for (size_t k = 0; k < 3; k++)
        off[k] -= n->dual[3 * c + k];
}

/* The part of it that a step is to bring. */
static void lack_due(const newton *n, size_t c, uint32_t aim, double off[3])
{
    if (aim == AIM_ALONG) {
        off[0] = off[1] = off[2] = 0.0;
        return;
    }
    lack(n, c, off);
    off[0] = n->pace * off[0] + (aim == AIM_CURVED ? n->slip[c] : 0.0);
}

double central_lack(const newton *n, double gap)
{
    double worst = 0.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        double off[3];
        double held[3];
        scaling s;
        if (!scale_cone(n->primal + 3 * c, n->dual + 3 * c, &s))
            return HUGE_VAL;
        lack(n, c, off);
        scale(&s, 1.0, off, held);
        worst = greater(worst, dot(held, held) / gap);
    }
    return worst;
}

/* ---- one step -------------------------------------------------------------------------------- */

/* dr = -D du' + ..., D = V^2 in the units of r and u, and u' = u + mu |u_t| e_n where that follows.
 * Bodies: own 1, slope D; blocks, to be symmetric: own D^-1, slope 1. */
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

/* The same of u, by that of u'. */
static void follow_slip(newton *n, size_t c)
{
    double *slope = n->slope + 9 * c;
    double e[2];

    slip_slope(n, c, e);
    for (int i = 0; i < 3; i++) {
        slope[3 * i + 1] += slope[3 * i] * (friction(n, c) * e[0]);
        slope[3 * i + 2] += slope[3 * i] * (friction(n, c) * e[1]);
    }
}

int central_law(newton *n)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        scaling s;
        if (!scale_cone(n->primal + 3 * c, n->dual + 3 * c, &s))
            return 0;
        fill_law(n, c, &s);
        if (n->follows != 0)
            follow_slip(n, c);
    }
    n->symmetric = n->follows == 0 ? n->symmetric_w : 0;
    return 1;
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

/* What x o y lacks, and t by it. */
static void aim_contact(const newton *n, size_t c, uint32_t aim, double target, const scaling *s,
                        double t[3])
{
    double lambda[3];
    double dx[3];
    double dy[3];
    double b[3] = {target, 0.0, 0.0};

    scale(s, 1.0, n->dual + 3 * c, lambda);
    if (aim == AIM_SECOND || aim == AIM_CURVED) {
        scale(s, -1.0, n->next_r + 3 * c, dx);
        scale(s, 1.0, n->next_f + 3 * c, dy);
        b[0] -= dot(dx, dy);
        for (int k = 1; k < 3; k++)
            b[k] = -(dx[0] * dy[k] + dy[0] * dx[k]);
    }
    divide(lambda, b, t);
    for (int k = 0; k < 3 && aim != AIM_ALONG; k++)
        t[k] -= lambda[k];
}

/* Second order of |u_t|, for the step in next_f. */
static double curve_of(const newton *n, size_t c)
{
    const double *u = n->next_u + 3 * c;
    double off[3];
    double e[2];

    if (!has_friction(n, c))
        return 0.0;
    lack(n, c, off);
    slip_slope(n, c, e);
    const double v1 = n->next_f[3 * c + 1] - off[1];
    const double v2 = n->next_f[3 * c + 2] - off[2];
    const double here = sqrt(u[1] * u[1] + u[2] * u[2]);
    const double there = sqrt((u[1] + v1) * (u[1] + v1) + (u[2] + v2) * (u[2] + v2));
    return n->pace * (there - here) - (e[0] * v1 + e[1] * v2);
}

void central_aim(newton *n, uint32_t aim, double target)
{
    for (size_t c = 0; c < n->problem->count; c++) {
        double off[3];
        double t[3];
        scaling s;
        if (!scale_cone(n->primal + 3 * c, n->dual + 3 * c, &s))
            return;
        if (aim == AIM_CURVED)
            n->slip[c] = curve_of(n, c);
        aim_contact(n, c, aim, target, &s, t);
        lack_due(n, c, aim, off);
        fill_right(n, c, &s, t, off);
    }
}

void central_directions(newton *n, uint32_t aim)
{
    const system_problem *p = n->problem;

    for (size_t c = 0; c < p->count; c++) {
        double *dy = n->next_f + 3 * c;
        double off[3];
        double e[2] = {0.0, 0.0};
        double du[3];
        for (size_t k = 0; k < 3; k++)
            du[k] = n->moved[3 * c + k] - p->q[3 * c + k];
        primal_of(n, c, n->step + 3 * c, n->next_r + 3 * c);
        dual_of(n, c, du, dy);
        if (n->follows != 0)
            slip_slope(n, c, e);
        lack_due(n, c, aim, off);
        dy[0] += e[0] * du[1] + e[1] * du[2];
        for (int k = 0; k < 3; k++)
            dy[k] += off[k];
    }
}

double central_share(const newton *n, const double *dx, const double *dy)
{
    double share = 1.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        share = lesser(share, longest(n->primal + 3 * c, dx + 3 * c));
        share = lesser(share, longest(n->dual + 3 * c, dy + 3 * c));
    }
    return share;
}

void central_move(newton *n, double share)
{
    n->is_placed = 0;
    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++) {
        n->primal[i] += share * n->next_r[i];
        n->dual[i] += share * n->next_f[i];
    }
}

double central_gap(const newton *n)
{
    double sum = 0.0;

    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++)
        sum += n->primal[i] * n->dual[i];
    return sum / (double)n->problem->count;
}

/* The same after a share of the step. */
static double gap_ahead(const newton *n, double share)
{
    double sum = 0.0;

    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++)
        sum += (n->primal[i] + share * n->next_r[i]) * (n->dual[i] + share * n->next_f[i]);
    return sum / (double)n->problem->count;
}

/* |v|^2 of what is a velocity, or an impulse, of contact c, as V scales it. */
static double scaled_square(const newton *n, size_t c, int is_velocity, const double v[3])
{
    double own[3];
    double scaled[3];
    scaling s;

    if (!scale_cone(n->primal + 3 * c, n->dual + 3 * c, &s))
        return 0.0;
    if (is_velocity)
        dual_of(n, c, v, own);
    else
        primal_of(n, c, v, own);
    scale(&s, is_velocity ? 1.0 : -1.0, own, scaled);
    return dot(scaled, scaled);
}

double central_inner(const newton *n, const double *ax, const double *ay, const double *bx,
                     const double *by)
{
    double sum = 0.0;

    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i += 3) {
        scaling s;
        double a[3];
        double b[3];
        if (!scale_cone(n->primal + i, n->dual + i, &s))
            return 0.0;
        scale(&s, -1.0, ax + i, a);
        scale(&s, -1.0, bx + i, b);
        sum += dot(a, b);
        scale(&s, 1.0, ay + i, a);
        scale(&s, 1.0, by + i, b);
        sum += dot(a, b);
    }
    return sum;
}

/* What `step` leaves of the equations, to `rest`. Returns its size over that of the right-hand side,
 * as V scales them. */
static double leave(newton *n)
{
    const system_problem *p = n->problem;
    const int blocks = p->bodies == 0;
    double sum = 0.0;
    double all = 0.0;

    for (size_t c = 0; c < p->count; c++) {
        double *rest = n->rest + 3 * c;
        double du[3];
        double own[3];
        double by_u[3];
        for (size_t k = 0; k < 3; k++)
            du[k] = n->moved[3 * c + k] - p->q[3 * c + k];
        apply3(n->own + 9 * c, n->step + 3 * c, own);
        apply3(n->slope + 9 * c, du, by_u);
        for (size_t k = 0; k < 3; k++)
            rest[k] = n->right[3 * c + k] + own[k] + by_u[k];
        sum += scaled_square(n, c, blocks, rest);
        all += scaled_square(n, c, blocks, n->right + 3 * c);
    }
    return all > 0.0 ? sqrt(sum / all) : 0.0;
}

/* Solve with the rest on the right, and add that to `step`. Returns 0 if it cannot be. */
static int refine(newton *n, newton_run *run)
{
    const size_t numbers_of = 3 * (size_t)n->problem->count;

    copy(numbers_of, n->step, n->center);
    for (size_t k = 0; k < numbers_of; k++) {
        const double held = n->right[k];
        n->right[k] = n->rest[k];
        n->rest[k] = held;
    }
    if (!step_again(n, run))
        return 0;
    for (size_t k = 0; k < numbers_of; k++) {
        n->step[k] += n->center[k];
        n->right[k] = n->rest[k];
    }
    certificate_velocity(n->problem, n->step, n->dv, n->moved);
    return 1;
}

/* Where a matrix has left no rest to speak of once, it does not either for the next right-hand
 * side. */
int central_solve(newton *n, newton_run *run, int is_factored)
{
    double before = HUGE_VAL;

    if (!(is_factored ? step_again(n, run) : step_solve(n, run)))
        return 0;
    certificate_velocity(n->problem, n->step, n->dv, n->moved);
    n->is_exact = n->follows == 0 || (is_factored && n->is_exact != 0);
    for (int i = 0; i < REFINEMENTS && n->is_exact == 0; i++) {
        const double size = leave(n);
        if (!(size > ACCURACY && size < 0.5 * before)) {
            n->is_exact = i == 0;
            break;
        }
        before = size;
        if (!refine(n, run))
            return 0;
    }
    return 1;
}

/* Mehrotra's predictor and corrector. */
double central_go(newton *n, newton_run *run)
{
    central_place(n);
    run->steps++;
    if (!central_law(n))
        return 0.0;
    central_aim(n, AIM_PLAIN, 0.0);
    if (!central_solve(n, run, 0))
        return 0.0;
    central_directions(n, AIM_PLAIN);
    const double ahead = gap_ahead(n, central_share(n, n->next_r, n->next_f));
    const double gap = central_gap(n);
    const double rest = lesser(absolute(ahead) / gap, 1.0);
    central_aim(n, AIM_SECOND, gap * greater(rest * rest * rest, LEAST_CENTERING));
    if (!central_solve(n, run, 1))
        return 0.0;
    central_directions(n, AIM_SECOND);
    const double share = lesser(1.0, BOUNDARY * central_share(n, n->next_r, n->next_f));
    central_move(n, share);
    return share;
}

/* ---- runs ------------------------------------------------------------------------------------ */

void central_start(newton *n, double times)
{
    double most = 0.0;

    n->is_placed = 0;
    n->pace = 1.0;
    for (size_t i = 0; i < 3 * (size_t)n->problem->count; i++)
        most = greater(most, absolute(n->problem->q[i]));
    for (size_t c = 0; c < n->problem->count; c++) {
        double *x = n->primal + 3 * c;
        double *y = n->dual + 3 * c;
        x[0] = y[0] = times * most;
        x[1] = x[2] = y[1] = y[2] = 0.0;
    }
}

int central_may_go(newton_run *run)
{
    run->halted = run->halt != NULL ? run->halt(run->context) : 0;
    return run->halted == 0 && run->steps < run->most_steps && run->status == TRIBO_OK;
}
