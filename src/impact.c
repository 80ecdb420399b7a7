#include "impact.h"
#include "solve.h"
#include "sym3.h"

static double frictionless(const kernel_problem *k, double e, double p[3])
{
    p[0] = -(1.0 + e) * k->bn / k->nn;
    p[1] = p[2] = 0.0;
    return k->b1 == 0.0 && k->b2 == 0.0 ? KERNEL_STICK : KERNEL_SLIP;
}

/* S x = c by the larger pivot. A direction that rounding left without mobility gets no impulse,
 * which keeps every promise of the law. Returns 0 if S is not semidefinite. */
static int solve_by_pivot(const kernel_problem *k, const kernel_schur *s, double x[2])
{
    const double size = k->t11 + k->t22;
    const double nothing = SINGULAR_TOLERANCE * size;
    const int second = s->s22 > s->s11;
    const double pivot = second ? s->s22 : s->s11;
    const double other = second ? s->s11 : s->s22;
    const double c_pivot = second ? s->c2 : s->c1;
    const double c_other = second ? s->c1 : s->c2;
    const double det = pivot * other - s->s12 * s->s12;
    const double least = -SEMIDEFINITE_TOLERANCE * size;
    if (other < least || pivot < least || det < least * greater(pivot, nothing)) {
        return 0;
    }
    x[0] = x[1] = 0.0;
    if (pivot > nothing) {
        const double across =
            det > nothing * pivot ? (c_other * pivot - s->s12 * c_pivot) / det : 0.0;
        x[second ? 0 : 1] = across;
        x[second ? 1 : 0] = (c_pivot - s->s12 * across) / pivot;
    }
    return 1;
}

static double algebraic(const kernel_problem *k, const tribo_material *pair, double e_t,
                        double p[3], tribo_impact_info *info)
{
    kernel_algebraic result;
    kernel_solve_algebraic(k, pair->mu_s, pair->mu_d, pair->e, e_t, &result);
    if (result.mode == KERNEL_ODD) {
        kernel_schur s;
        double x[2];
        kernel_reduce(k, &s);
        if (!solve_by_pivot(k, &s, x)) {
            return KERNEL_MATRIX;
        }
        kernel_scale_algebraic(k, s.inverse_a, x, pair->mu_s, pair->mu_d, pair->e, e_t, &result);
    }
    memcpy(p, result.p, sizeof result.p);
    info->kappa = result.kappa;
    return result.mode;
}

static double coulomb(const kernel_problem *k, const tribo_material *pair, double p[3],
                      tribo_impact_info *info)
{
    kernel_problem bouncing = *k;
    double nu;
    bouncing.bn = (1.0 + pair->e) * k->bn;
    return solve_scaled(&bouncing, pair->mu_s, pair->mu_d, p, &nu, &info->iterations);
}

/* The share of u_t that the lecture's rule takes away: 1 sticks. */
static double lecture_share(const kernel_problem *k, const tribo_material *pair, uint32_t law)
{
    const double closing = -k->bn;
    const double planar = sqrt(k->b1 * k->b1 + k->b2 * k->b2);
    if (planar <= pair->mu_s * closing) {
        return 1.0;
    }
    return law == TRIBO_LAW_LECTURE ? pair->mu_d : lesser(1.0, pair->mu_d * closing / planar);
}

/* p = W^-1 (wanted change of velocity), through the Schur complement of W_nn. */
static double lecture(const kernel_problem *k, const tribo_material *pair, uint32_t law,
                      double p[3])
{
    const double share = lecture_share(k, pair, law);
    const double change[3] = {-(1.0 + pair->e) * k->bn, -share * k->b1, -share * k->b2};
    kernel_schur s;
    kernel_reduce(k, &s);
    const double c1 = change[1] - k->n1 * s.inverse_a * change[0];
    const double c2 = change[2] - k->n2 * s.inverse_a * change[0];
    const int second = s.s22 > s.s11;
    const double pivot = second ? s.s22 : s.s11;
    const double other = second ? s.s11 : s.s22;
    const double nothing = SINGULAR_TOLERANCE * (k->t11 + k->t22);
    if (!(pivot > nothing)) {
        return KERNEL_MATRIX;
    }
    const double factor = s.s12 / pivot;
    const double rest = other - factor * s.s12;
    if (!(rest > nothing)) {
        return KERNEL_MATRIX;
    }
    const double x_other = ((second ? c1 : c2) - factor * (second ? c2 : c1)) / rest;
    const double x_pivot = ((second ? c2 : c1) - s.s12 * x_other) / pivot;
    p[1] = second ? x_other : x_pivot;
    p[2] = second ? x_pivot : x_other;
    p[0] = (change[0] - k->n1 * p[1] - k->n2 * p[2]) * s.inverse_a;
    return share == 1.0 ? KERNEL_STICK : KERNEL_SLIP;
}

static int is_semidefinite(const kernel_problem *k)
{
    const double w[6] = {k->nn, k->n1, k->n2, k->t11, k->t12, k->t22};
    return sym3_is_semidefinite(w, SEMIDEFINITE_TOLERANCE);
}

double impact_scaled(const kernel_problem *problem, const tribo_material *pair,
                     const tribo_impact_options *options, double p[3], tribo_impact_info *info)
{
    p[0] = p[1] = p[2] = 0.0;
    if (problem->bn >= 0.0) {
        return KERNEL_OPEN;
    }
    switch (options->law) {
    case TRIBO_LAW_FRICTIONLESS:
        return frictionless(problem, pair->e, p);
    case TRIBO_LAW_LECTURE:
    case TRIBO_LAW_LECTURE_CLOSING:
        return lecture(problem, pair, options->law, p);
    case TRIBO_LAW_COULOMB:
        return coulomb(problem, pair, p, info);
    case TRIBO_LAW_ROUTH_NEWTON:
    case TRIBO_LAW_ROUTH_POISSON:
    case TRIBO_LAW_ROUTH_STRONGE:
        if (!is_semidefinite(problem)) {
            return KERNEL_MATRIX;
        }
        return routh_scaled(problem, pair, options->law, p, info);
    default:
        return algebraic(problem, pair, options->tangential_restitution, p, info);
    }
}
