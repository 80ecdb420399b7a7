#include "solve.h"

/* Sliding subproblem (S + nu 1) p_t = c of a general problem. */
typedef struct slide {
    double s[4];
    double c[2];
    double scale; /* power of two that brings |c| into [1, 2); c is stored scaled */
    double size;  /* of what S was subtracted from: rounding of S is relative to it */
    double drive; /* of what c was subtracted from, scaled as c */
} slide;

/* Solve by elimination with the larger pivot; returns 0 where it is singular. A right-hand side of zero
 * has the solution zero whatever S is. */
static int solve_shifted(const slide *e, double nu, double p[2])
{
    const double m[4] = {e->s[0] + nu, e->s[1], e->s[2], e->s[3] + nu};
    p[0] = p[1] = 0.0;
    if (e->c[0] == 0.0 && e->c[1] == 0.0) {
        return 1;
    }
    const int swap = absolute(m[2]) > absolute(m[0]);
    const double *top = swap ? m + 2 : m;
    const double *low = swap ? m : m + 2;
    const double c_top = swap ? e->c[1] : e->c[0];
    const double c_low = swap ? e->c[0] : e->c[1];
    if (top[0] == 0.0) {
        return 0;
    }
    const double factor = low[0] / top[0];
    const double pivot = low[1] - factor * top[1];
    const double rest = c_low - factor * c_top;
    const double least = nu > 0.0 ? 0.0 : SINGULAR_TOLERANCE * e->size;
    if (absolute(pivot) > least) {
        p[1] = rest / pivot;
    } else if (nu > 0.0 || absolute(rest) > SINGULAR_TOLERANCE * e->drive) {
        return 0;
    }
    p[0] = (c_top - top[1] * p[1]) / top[0];
    return p[0] - p[0] == 0.0 && p[1] - p[1] == 0.0;
}

static double normal_impulse(const solve_general *g, const slide *e, const double p[2])
{
    return -(g->bn + (g->row[0] * p[0] + g->row[1] * p[1]) / e->scale) / g->nn;
}

/* 1 if mu p_n >= |p_t| at this nu: to the right of the root. Both sides times 1 + nu, against underflow
 * of p_t where nu is huge. */
static int friction_suffices(const solve_general *g, const slide *e, double mu, double nu)
{
    double p[2];
    if (!solve_shifted(e, nu, p)) {
        return 0;
    }
    const double x = (1.0 + nu) * p[0];
    const double y = (1.0 + nu) * p[1];
    return (1.0 + nu) * normal_impulse(g, e, p) * mu * e->scale >= sqrt(x * x + y * y);
}

/* Bisection on the bit pattern halves the number of doubles between the ends: at most 64 steps from 0 to
 * the greatest double, to the last bit. */
static double bisect(const solve_general *g, const slide *e, double mu, double high,
                     uint32_t *iterations)
{
    uint64_t low_bits = 0;
    uint64_t high_bits = bits_of(high);
    while (high_bits - low_bits > 1) {
        const uint64_t middle = low_bits + (high_bits - low_bits) / 2;
        if (friction_suffices(g, e, mu, double_of(middle))) {
            high_bits = middle;
        } else {
            low_bits = middle;
        }
        ++*iterations;
    }
    return double_of(high_bits);
}

/* Beyond this nu, |p_t| <= |c| / (nu - |S|) is too short to leave the cone. */
static double upper_bound(const solve_general *g, const slide *e, double mu)
{
    const double c = sqrt(e->c[0] * e->c[0] + e->c[1] * e->c[1]);
    const double row = sqrt(g->row[0] * g->row[0] + g->row[1] * g->row[1]);
    const double drive = mu * -g->bn;
    const double bound = 4.0 * (c / e->scale * (g->nn + mu * row) / drive + e->size);
    return bound < 8.9e307 ? bound : 8.9e307;
}

static int make_slide(const solve_general *g, slide *e)
{
    const double l0 = g->column[0] / g->nn;
    const double l1 = g->column[1] / g->nn;
    const double size = absolute(g->d[0]) + absolute(g->d[3]) + absolute(l0 * g->row[0]) +
                        absolute(l1 * g->row[1]);
    e->s[0] = g->d[0] - l0 * g->row[0];
    e->s[1] = g->d[1] - l0 * g->row[1];
    e->s[2] = g->d[2] - l1 * g->row[0];
    e->s[3] = g->d[3] - l1 * g->row[1];
    e->size = size;
    double c[2] = {l0 * g->bn - g->b[0], l1 * g->bn - g->b[1]};
    const double scale = power_of_two(scale_exponent(greater(absolute(c[0]), absolute(c[1]))));
    e->scale = scale;
    e->drive = scale * (absolute(g->b[0]) + absolute(g->b[1]) +
                        (absolute(l0) + absolute(l1)) * absolute(g->bn));
    e->c[0] = scale * c[0];
    e->c[1] = scale * c[1];
    /* Friction must not be able to gain energy by itself: the symmetric part is semidefinite. */
    const double off = 0.5 * (e->s[1] + e->s[2]);
    const double least = -SEMIDEFINITE_TOLERANCE * size;
    return e->s[0] >= least && e->s[3] >= least &&
           e->s[0] * e->s[3] - off * off >= least * size;
}

static void write_impulse(const solve_general *g, const slide *e, double mu, int slips,
                          const double p[2], double out[3])
{
    const double normal = normal_impulse(g, e, p);
    const double length = sqrt(p[0] * p[0] + p[1] * p[1]) / e->scale;
    double f = 1.0;
    out[0] = normal;
    if (slips && mu >= 1.0) {
        out[0] = length / mu;
    } else if (length > mu * normal || (slips && length > 0.0)) {
        f = mu * normal / length;
    }
    out[1] = f * p[0] / e->scale;
    out[2] = f * p[1] / e->scale;
}

double solve_by_bisection(const solve_general *problem, double mu_s, double mu_d, double p[3],
                           double *nu, uint32_t *iterations)
{
    slide e;
    double p_t[2] = {0.0, 0.0};
    *nu = 0.0;
    p[0] = p[1] = p[2] = 0.0;
    if (!make_slide(problem, &e)) {
        return KERNEL_MATRIX;
    }
    if (problem->bn >= 0.0) {
        return KERNEL_OPEN;
    }
    ++*iterations;
    if (friction_suffices(problem, &e, mu_s, 0.0)) {
        solve_shifted(&e, 0.0, p_t);
        write_impulse(problem, &e, mu_s, 0, p_t, p);
        return KERNEL_STICK;
    }
    if (mu_d == 0.0) {
        write_impulse(problem, &e, 0.0, 0, p_t, p);
        return KERNEL_SLIP;
    }
    const double high = upper_bound(problem, &e, mu_d);
    if (!friction_suffices(problem, &e, mu_d, high)) {
        /* The root lies beyond the doubles, and so friction below them. */
        write_impulse(problem, &e, 0.0, 0, p_t, p);
        *nu = high;
        return KERNEL_SLIP;
    }
    *nu = bisect(problem, &e, mu_d, high, iterations);
    /* A root that runs into 0 is none: friction suffices however small nu is, but S cannot stick. */
    const int runs_away = *nu < 1e-30 * e.size && !solve_shifted(&e, 0.0, p_t);
    if (runs_away || !solve_shifted(&e, *nu, p_t)) {
        *nu = 0.0;
        return KERNEL_JAM;
    }
    write_impulse(problem, &e, mu_d, 1, p_t, p);
    return KERNEL_SLIP;
}

double solve_slowly(const kernel_problem *problem, double mu_s, double mu_d, double p[3], double *nu,
                     uint32_t *iterations)
{
    const solve_general g = {
        problem->nn,
        {problem->n1, problem->n2},
        {problem->n1, problem->n2},
        {problem->t11, problem->t12, problem->t12, problem->t22},
        problem->bn,
        {problem->b1, problem->b2},
    };
    return solve_by_bisection(&g, mu_s, mu_d, p, nu, iterations);
}

double solve_scaled(const kernel_problem *problem, double mu_s, double mu_d, double p[3],
                     double *nu, uint32_t *iterations)
{
    kernel_slip e;
    kernel_prepare(problem, mu_s, mu_d, &e);
    *nu = 0.0;
    *iterations = 0;
    double mode = e.mode;
    if (mode == KERNEL_SLIP) {
        int settled = 0;
        *nu = e.nu;
        while (!settled && *iterations < MAX_HALLEY) {
            settled = kernel_halley(&e, nu);
            ++*iterations;
        }
        mode = settled ? KERNEL_SLIP : KERNEL_SLOW;
    }
    if (mode == KERNEL_SLOW) {
        return solve_slowly(problem, mu_s, mu_d, p, nu, iterations);
    }
    if (mode == KERNEL_STICK || mode == KERNEL_SLIP || mode == KERNEL_FREE) {
        kernel_finish(&e, *nu, mode == KERNEL_SLIP, p);
        return mode == KERNEL_FREE ? KERNEL_SLIP : mode;
    }
    p[0] = p[1] = p[2] = 0.0;
    return mode;
}

tribo_status status_of_mode(double mode)
{
    static const tribo_status statuses[] = {
        TRIBO_OK,
        TRIBO_OK,
        TRIBO_OK,
        TRIBO_ERROR_JAM,
        TRIBO_OK,
        TRIBO_OK,
        TRIBO_ERROR_NOT_FINITE,
        TRIBO_ERROR_RANGE,
        TRIBO_ERROR_FRICTION,
        TRIBO_ERROR_RESTITUTION,
        TRIBO_ERROR_CONTACT_MATRIX,
        TRIBO_ERROR_IMMOVABLE,
    };
    return statuses[(int)mode];
}
