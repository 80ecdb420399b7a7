/* The impact laws on the six sets: what ALGEBRAIC guarantees, on a million cases of each; which
 * laws break what, counted; and that the audit sees it. Everything is computed from the impulse
 * alone, in long double. */
#include <tribo/audit.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/problems.h"
#include "support/quad.h"

enum { SEED = 19980412, LAWS = TRIBO_LAW_LECTURE_CLOSING + 1 };

static const char *const law_names[LAWS] = {"ALGEBRAIC",     "FRICTIONLESS",   "LECTURE",
                                            "COULOMB",       "ROUTH_NEWTON",   "ROUTH_POISSON",
                                            "ROUTH_STRONGE", "LECTURE_CLOSING"};

/* ---- an impulse, judged apart from the library ----------------------------------------------- */

typedef struct judgement {
    long double after[3]; /* u+ */
    long double energy;   /* p . (u- + u+) / 2 */
    long double v;        /* scale of velocity, as in audit.h */
    long double p;        /* scale of impulse */
    long double friction; /* |p_t| */
} judgement;

static void judge(const double w[6], const double u[3], const double p[3], judgement *out)
{
    static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const double top = fmax(w[0], fmax(w[3], w[5]));
    long double square_u = 0.0L;
    long double square_wp = 0.0L;
    out->energy = 0.0L;
    for (size_t i = 0; i < 3; i++) {
        long double sum = 0.0L;
        long double size = 0.0L;
        for (size_t j = 0; j < 3; j++) {
            const long double term = (long double)w[entry[i][j]] * (long double)p[j];
            sum += term;
            size += fabsl(term);
        }
        out->after[i] = (long double)u[i] + sum;
        out->energy += (long double)p[i] * ((long double)u[i] + out->after[i]) / 2.0L;
        square_u += (long double)u[i] * (long double)u[i];
        square_wp += size * size;
    }
    out->v = sqrtl(square_u) + sqrtl(square_wp);
    out->p = out->v / (long double)top;
    out->friction =
        sqrtl((long double)p[1] * (long double)p[1] + (long double)p[2] * (long double)p[2]);
}

/* Relative excess of friction over mu p_n; infinity for a pulling impulse. */
static double cone_excess(const judgement *judged, double mu, const double p[3])
{
    const long double limit = (long double)mu * (long double)p[0];
    if (p[0] < 0.0) {
        return HUGE_VAL;
    }
    return judged->friction > limit ? (double)(judged->friction / limit - 1.0L) : 0.0;
}

static void keep_greatest(double *worst, double value)
{
    if (!(value <= *worst)) {
        *worst = value;
    }
}

/* ---- ALGEBRAIC: its guarantees --------------------------------------------------------------- */

/* Greatest deviations, in units of eps times the scale that is named. */
typedef struct guarantees {
    double restitution;             /* u_n+ + e u_n-, scale V */
    double restitution_of_approach; /* the same, scale cond v_c */
    double cone;                    /* relative */
    double gain;                    /* dT > 0, scale P V */
    double identity;                /* dT - identity, scale cond P V */
    double velocity;                /* of the info, scale V */
    double energy;                  /* of the info, scale |p| V */
    uint64_t modes[3];
} guarantees;

/* -(1 - e^2)/2 |P_I|^2_W - kappa (2 - kappa)/2 |P_II - P_I|^2_W. With S the Schur complement of
 * W_nn and c = -(u_t - w_t u_n / W_nn), |P_II - P_I|^2_W = c . S^-1 c. */
static long double energy_by_identity(const problem_impact *problem, long double kappa)
{
    const long double nn = (long double)problem->w[0];
    const long double l[2] = {(long double)problem->w[1] / nn, (long double)problem->w[2] / nn};
    const long double s[3] = {(long double)problem->w[3] - l[0] * (long double)problem->w[1],
                              (long double)problem->w[4] - l[0] * (long double)problem->w[2],
                              (long double)problem->w[5] - l[1] * (long double)problem->w[2]};
    const long double un = (long double)problem->u[0];
    const long double c[2] = {l[0] * un - (long double)problem->u[1],
                              l[1] * un - (long double)problem->u[2]};
    const long double e = (long double)problem->pair.e;
    const long double square =
        (s[2] * c[0] * c[0] - 2.0L * s[1] * c[0] * c[1] + s[0] * c[1] * c[1]) /
        (s[0] * s[2] - s[1] * s[1]);
    return -(1.0L - e * e) * un * un / nn / 2.0L - kappa * (2.0L - kappa) * square / 2.0L;
}

static tribo_status algebraic(const problem_impact *problem, double p[3], tribo_impact_info *info)
{
    tribo_impact_options options = {0};
    options.struct_size = sizeof options;
    options.law = TRIBO_LAW_ALGEBRAIC;
    options.tangential_restitution = problem->tangential_restitution;
    info->struct_size = sizeof *info;
    return tribo_impact(problem->w, problem->u, &problem->pair, &options, p, info);
}

static void check_guarantees(const problem_impact *problem, guarantees *worst)
{
    tribo_impact_info info = {0};
    judgement judged;
    double p[3] = {0.0, 0.0, 0.0};
    assert_int_equal(algebraic(problem, p, &info), TRIBO_OK);
    worst->modes[info.mode]++;
    judge(problem->w, problem->u, p, &judged);
    if (problem->u[0] >= 0.0) {
        assert_int_equal(info.mode, TRIBO_MODE_OPEN);
        assert_true(p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0);
        return;
    }
    const long double eps = (long double)DBL_EPSILON;
    const long double cond = (long double)quad_condition_bound(problem->w);
    const long double power = judged.p * judged.v;
    const double mu = info.mode == TRIBO_MODE_STICK ? problem->pair.mu_s : problem->pair.mu_d;
    const long double miss =
        fabsl(judged.after[0] + (long double)problem->pair.e * (long double)problem->u[0]);
    const long double identity = energy_by_identity(problem, (long double)info.kappa);
    keep_greatest(&worst->restitution, (double)(miss / (eps * judged.v)));
    keep_greatest(&worst->restitution_of_approach,
                  (double)(miss / (eps * cond * -(long double)problem->u[0])));
    keep_greatest(&worst->cone, cone_excess(&judged, mu, p) / DBL_EPSILON);
    keep_greatest(&worst->gain, (double)(judged.energy / (eps * power)));
    keep_greatest(&worst->identity,
                  (double)(fabsl(judged.energy - identity) / (eps * cond * power)));
    for (size_t i = 0; i < 3; i++) {
        const long double off = fabsl((long double)info.velocity[i] - judged.after[i]);
        keep_greatest(&worst->velocity, (double)(off / (eps * judged.v)));
    }
    const long double off = fabsl((long double)info.energy - judged.energy);
    const long double size =
        sqrtl(judged.friction * judged.friction + (long double)p[0] * (long double)p[0]);
    keep_greatest(&worst->energy, (double)(off / (eps * size * judged.v)));
}

static void algebraic_keeps_its_promises(void **state)
{
    const uint32_t set = *(const uint32_t *)*state;
    const uint64_t count = problem_count(1000000);
    guarantees worst = {0};
    for (uint64_t index = 0; index < count; index++) {
        problem_impact problem;
        problem_draw_impact(set, SEED, index, &problem);
        check_guarantees(&problem, &worst);
    }
    const double percent = 100.0 / (double)count;
    print_message(
        "# %-2s %llu impacts, worst in eps: u_n+ + e u_n- %.2g V, %.2g cond v_c; cone %.2g; "
        "dT > 0 %.2g PV; identity %.2g cond PV; info %.2g V %.2g |p|V; open %.1f stick %.1f slip "
        "%.1f %%\n",
        problem_set_name(set), (unsigned long long)count, worst.restitution,
        worst.restitution_of_approach, worst.cone, worst.gain, worst.identity, worst.velocity,
        worst.energy, percent * (double)worst.modes[0], percent * (double)worst.modes[1],
        percent * (double)worst.modes[2]);
    assert_true(worst.restitution <= 16.0);
    assert_true(worst.cone <= 8.0);
    assert_true(worst.gain <= 64.0);
    assert_true(worst.identity <= 64.0);
    assert_true(worst.velocity <= 16.0);
    assert_true(worst.energy <= 16.0);
    for (size_t mode = 0; mode < 3; mode++) {
        assert_true(worst.modes[mode] > count / 100);
    }
}

/* ---- ALGEBRAIC: forward error ---------------------------------------------------------------- */

/* Error of the library's impulse in units of eps cond(W). Where mu_d < mu_s the impulse jumps as
 * sticking gives way; so that a case on the very edge may fall to either side, a mu_s that differs
 * by rounding may explain the mode. */
static double error_of_algebraic(const problem_impact *problem)
{
    tribo_impact_info info = {0};
    tribo_material pair = problem->pair;
    double p[3] = {0.0, 0.0, 0.0};
    quad_real w[6];
    quad_real u[3];
    quad_real truth[3];
    const double unit = DBL_EPSILON * quad_condition(problem->w);
    quad_widen(6, problem->w, w);
    quad_widen(3, problem->u, u);
    assert_int_equal(algebraic(problem, p, &info), TRIBO_OK);
    quad_algebraic(w, u, &pair, problem->tangential_restitution, truth);
    const double error = quad_relative_error(3, p, truth);
    pair.mu_s *= info.mode == TRIBO_MODE_STICK ? 1.0 + 64.0 * unit : 1.0 - 64.0 * unit;
    quad_algebraic(w, u, &pair, problem->tangential_restitution, truth);
    return fmin(error, quad_relative_error(3, p, truth)) / unit;
}

static void algebraic_agrees_with_the_twin(void **state)
{
    const uint64_t count = problem_count(2000);
    (void)state;
    if (!QUAD_AVAILABLE) {
        print_message("# this compiler has no quadruple precision\n");
        skip();
    }
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        double worst = 0.0;
        double sum = 0.0;
        for (uint64_t k = 0; k < count; k++) {
            problem_impact problem;
            problem_draw_impact(set, SEED, 499 * k, &problem);
            const double error = error_of_algebraic(&problem);
            keep_greatest(&worst, error);
            sum += error;
        }
        print_message("# %-2s forward error of ALGEBRAIC / (eps cond W): mean %.2g worst %.3g\n",
                      problem_set_name(set), sum / (double)count, worst);
        assert_true(worst <= 64.0);
    }
}

/* ---- which law breaks what ------------------------------------------------------------------- */

typedef struct offences {
    uint64_t approaching; /* cases with u_n < 0 */
    uint64_t gains;       /* dT > 64 eps P V */
    uint64_t outside;     /* p_n < 0 or |p_t| > mu_s p_n (1 + 8 eps) */
    uint64_t pulls;       /* p_n < 0 */
    uint64_t sinks;       /* u_n+ < -64 eps V */
    uint64_t audited_gains;
    uint64_t audited_outside;
    double greatest_gain; /* in units of P V */
} offences;

static void count_offences(const problem_impact *problem, uint32_t law, offences *sum)
{
    tribo_impact_options options = {0};
    tribo_measures measures;
    judgement judged;
    double p[3] = {0.0, 0.0, 0.0};
    options.struct_size = sizeof options;
    options.law = law;
    assert_int_equal(tribo_impact(problem->w, problem->u, &problem->pair, &options, p, NULL),
                     TRIBO_OK);
    if (problem->u[0] >= 0.0) {
        return;
    }
    judge(problem->w, problem->u, p, &judged);
    assert_int_equal(tribo_audit_impact(problem->w, problem->u, &problem->pair, p, &measures),
                     TRIBO_OK);
    const double gain = (double)(judged.energy / (judged.p * judged.v));
    const double mu = problem->pair.mu_s;
    sum->approaching++;
    sum->gains += gain > 64.0 * DBL_EPSILON;
    sum->outside += cone_excess(&judged, mu, p) > 8.0 * DBL_EPSILON;
    sum->pulls += p[0] < 0.0;
    sum->sinks += judged.after[0] < -64.0L * (long double)DBL_EPSILON * judged.v;
    sum->audited_gains += measures.energy > 64.0 * DBL_EPSILON;
    sum->audited_outside += measures.cone > 8.0 * DBL_EPSILON;
    keep_greatest(&sum->greatest_gain, gain);
}

static double share(uint64_t part, const offences *sum)
{
    return 100.0 * (double)part / (double)sum->approaching;
}

static void print_offences(uint32_t set, uint32_t law, const offences *sum)
{
    print_message("# %-2s %-15s gains energy %7.3f %% (up to %.2g PV), outside the cone %7.3f %%, "
                  "pulls %7.3f %%, still approaches %7.3f %%\n",
                  problem_set_name(set), law_names[law], share(sum->gains, sum), sum->greatest_gain,
                  share(sum->outside, sum), share(sum->pulls, sum), share(sum->sinks, sum));
}

static void laws_break_what_they_are_known_to_break(void **state)
{
    const uint32_t set = *(const uint32_t *)*state;
    const uint64_t count = problem_count(50000);
    offences of[LAWS];
    memset(of, 0, sizeof of);
    for (uint64_t index = 0; index < count; index++) {
        problem_impact problem;
        problem_draw_impact(set, SEED + 1, index, &problem);
        for (uint32_t law = 0; law < LAWS; law++) {
            count_offences(&problem, law, &of[law]);
        }
    }
    for (uint32_t law = 0; law < LAWS; law++) {
        print_offences(set, law, &of[law]);
    }
    for (uint32_t law = 0; law < LAWS; law++) {
        const int lecture = law == TRIBO_LAW_LECTURE || law == TRIBO_LAW_LECTURE_CLOSING;
        const int newton = law == TRIBO_LAW_COULOMB || law == TRIBO_LAW_ROUTH_NEWTON;
        assert_int_equal(of[law].sinks, 0);
        assert_true(lecture || (of[law].outside == 0 && of[law].pulls == 0));
        assert_true(lecture || newton || of[law].gains == 0);
        /* the audit counts the same offences: half a per mille of doubt for those at the limit */
        assert_true(fabs(share(of[law].gains, &of[law]) - share(of[law].audited_gains, &of[law])) <=
                    0.05);
    }
    /* the negative control: were these zero, the counters and the audit would be blind */
    assert_true(of[TRIBO_LAW_LECTURE].outside > 0 && of[TRIBO_LAW_LECTURE].gains > 0);
    assert_true(of[TRIBO_LAW_LECTURE].audited_outside > 0 &&
                of[TRIBO_LAW_LECTURE].audited_gains > 0);
    assert_true(of[TRIBO_LAW_COULOMB].gains > 0);
}

/* ---- closed forms ---------------------------------------------------------------------------- */

static void frictionless_loses_what_restitution_says(void **state)
{
    const uint64_t count = problem_count(100000);
    tribo_impact_options options = {0};
    double worst = 0.0;
    (void)state;
    options.struct_size = sizeof options;
    options.law = TRIBO_LAW_FRICTIONLESS;
    for (uint64_t index = 0; index < PROBLEM_SETS * count; index++) {
        problem_impact problem;
        judgement judged;
        double p[3];
        problem_draw_impact((uint32_t)(index % PROBLEM_SETS), SEED + 2, index, &problem);
        assert_int_equal(tribo_impact(problem.w, problem.u, &problem.pair, &options, p, NULL),
                         TRIBO_OK);
        judge(problem.w, problem.u, p, &judged);
        const long double e = (long double)problem.pair.e;
        const long double un = fminl((long double)problem.u[0], 0.0L);
        const long double plastic = un * un / (2.0L * (long double)problem.w[0]);
        assert_true(p[1] == 0.0 && p[2] == 0.0);
        if (plastic > 0.0L) {
            const long double miss = fabsl(judged.energy + (1.0L - e * e) * plastic) / plastic;
            keep_greatest(&worst, (double)miss / DBL_EPSILON);
        }
    }
    print_message("# dT of FRICTIONLESS against -(1 - e^2) u_n^2 / (2 W_nn): worst %.2g eps\n",
                  worst);
    assert_true(worst <= 16.0);
}

/* COULOMB is the exact solve of b = ((1 + e) u_n, u_t); with e = 0 it never gains energy. */
static void coulomb_is_exact(void **state)
{
    const uint64_t count = problem_count(50000);
    tribo_impact_options options = {0};
    (void)state;
    options.struct_size = sizeof options;
    options.law = TRIBO_LAW_COULOMB;
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        double worst = 0.0;
        double gain = 0.0;
        for (uint64_t index = 0; index < count; index++) {
            problem_impact problem;
            tribo_impact_info info = {0};
            judgement judged;
            double p[3];
            info.struct_size = sizeof info;
            problem_draw_impact(set, SEED + 3, index, &problem);
            problem.pair.e = index % 2 == 0 ? 0.0 : problem.pair.e;
            assert_int_equal(tribo_impact(problem.w, problem.u, &problem.pair, &options, p, &info),
                             TRIBO_OK);
            const double b[3] = {(1.0 + problem.pair.e) * problem.u[0], problem.u[1], problem.u[2]};
            const double mu = info.mode == TRIBO_MODE_STICK ? problem.pair.mu_s : problem.pair.mu_d;
            keep_greatest(&worst, problem.u[0] < 0.0 ? quad_eta(problem.w, b, mu, p) : 0.0);
            judge(problem.w, problem.u, p, &judged);
            if (problem.pair.e == 0.0 && judged.energy > 0.0L) {
                keep_greatest(&gain, (double)(judged.energy / (judged.p * judged.v)));
            }
        }
        print_message("# %-2s COULOMB: worst eta %.2g; e = 0: dT > 0 by %.2g eps PV\n",
                      problem_set_name(set), worst, gain / DBL_EPSILON);
        assert_true(worst <= 1e-11);
        assert_true(gain <= 64.0 * DBL_EPSILON);
    }
}

int main(void)
{
    static uint32_t sets[PROBLEM_SETS] = {PROBLEM_P1, PROBLEM_P2, PROBLEM_P3,
                                          PROBLEM_S,  PROBLEM_B,  PROBLEM_U};
#define SET_TEST(name, function, set)          \
    {                                          \
        name, function, NULL, NULL, &sets[set] \
    }
    const struct CMUnitTest tests[] = {
        SET_TEST("ALGEBRAIC keeps its promises on P1", algebraic_keeps_its_promises, 0),
        SET_TEST("ALGEBRAIC keeps its promises on P2", algebraic_keeps_its_promises, 1),
        SET_TEST("ALGEBRAIC keeps its promises on P3", algebraic_keeps_its_promises, 2),
        SET_TEST("ALGEBRAIC keeps its promises on S", algebraic_keeps_its_promises, 3),
        SET_TEST("ALGEBRAIC keeps its promises on B", algebraic_keeps_its_promises, 4),
        SET_TEST("ALGEBRAIC keeps its promises on U", algebraic_keeps_its_promises, 5),
        cmocka_unit_test(algebraic_agrees_with_the_twin),
        SET_TEST("laws on P1", laws_break_what_they_are_known_to_break, 0),
        SET_TEST("laws on P2", laws_break_what_they_are_known_to_break, 1),
        SET_TEST("laws on P3", laws_break_what_they_are_known_to_break, 2),
        SET_TEST("laws on S", laws_break_what_they_are_known_to_break, 3),
        SET_TEST("laws on B", laws_break_what_they_are_known_to_break, 4),
        SET_TEST("laws on U", laws_break_what_they_are_known_to_break, 5),
        cmocka_unit_test(frictionless_loses_what_restitution_says),
        cmocka_unit_test(coulomb_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
