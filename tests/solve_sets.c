/* The exact solve on six sets of a million problems each, judged by a residual computed apart from
 * the library and by a quad-precision twin; extreme scales; equal bits under powers of two. */
#include <tribo/contact.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/problems.h"
#include "support/quad.h"

enum { SEED = 20240917, ITERATION_BINS = 128 };

static const double solved = 1e-9;     /* eta beyond which a problem counts as failed */
static const double worst_eta = 1e-11; /* what no problem may exceed */

/* ---- helpers --------------------------------------------------------------------------------- */

static void print_problem(const char *what, const double w[6], const double b[3], double mu)
{
    print_message("# %s: w %a %a %a %a %a %a, b %a %a %a, mu %a\n", what, w[0], w[1], w[2], w[3],
                  w[4], w[5], b[0], b[1], b[2], mu);
}

/* Solves, and returns eta by the residual of quad.h; infinity if the library refuses. */
static double solve_and_judge(const problem_local *problem, double p[3], tribo_solve_info *info)
{
    info->struct_size = sizeof *info;
    const tribo_status status =
        tribo_contact_solve(problem->w, problem->b, problem->mu, problem->mu, p, info);
    if (status != TRIBO_OK) {
        print_problem(tribo_status_name(status), problem->w, problem->b, problem->mu);
        return HUGE_VAL;
    }
    const double eta = quad_eta(problem->w, problem->b, problem->mu, p);
    return eta == eta ? eta : HUGE_VAL;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- a million of each ----------------------------------------------------------------------- */

typedef struct tally {
    uint64_t modes[3];
    uint64_t iterations[ITERATION_BINS]; /* of slipping contacts */
    uint64_t failures;
    double worst;
    uint64_t worst_index;
} tally;

static void count_problem(tally *sum, const tribo_solve_info *info, double eta, uint64_t index)
{
    const uint32_t steps = info->iterations;
    if (eta < HUGE_VAL) {
        sum->modes[info->mode]++;
        if (info->mode == TRIBO_MODE_SLIP) {
            sum->iterations[steps < ITERATION_BINS ? steps : ITERATION_BINS - 1]++;
        }
    }
    sum->failures += eta > solved;
    if (eta > sum->worst) {
        sum->worst = eta;
        sum->worst_index = index;
    }
}

/* Mean, 99th percentile and greatest number of iterations. */
static void iteration_figures(const tally *sum, double *mean, uint32_t *p99, uint32_t *most)
{
    const uint64_t slips = sum->modes[TRIBO_MODE_SLIP];
    uint64_t below = 0;
    uint64_t total = 0;
    *p99 = *most = 0;
    for (uint32_t k = 0; k < ITERATION_BINS; k++) {
        if (sum->iterations[k] > 0) {
            *p99 = below * 100 < slips * 99 ? k : *p99;
            *most = k;
        }
        below += sum->iterations[k];
        total += sum->iterations[k] * k;
    }
    *mean = slips > 0 ? (double)total / (double)slips : 0.0;
}

static void print_tally(uint32_t set, uint64_t count, const tally *sum, double median)
{
    double mean;
    uint32_t p99;
    uint32_t most;
    const double percent = 100.0 / (double)count;
    iteration_figures(sum, &mean, &p99, &most);
    print_message("# %-2s %llu problems: %llu failures, eta worst %.2g (index %llu) median %.2g, "
                  "open %.1f stick %.1f slip %.1f %%, slip iterations mean %.2f p99 %u max %u\n",
                  problem_set_name(set), (unsigned long long)count,
                  (unsigned long long)sum->failures, sum->worst,
                  (unsigned long long)sum->worst_index, median,
                  percent * (double)sum->modes[TRIBO_MODE_OPEN],
                  percent * (double)sum->modes[TRIBO_MODE_STICK],
                  percent * (double)sum->modes[TRIBO_MODE_SLIP], mean, p99, most);
}

static void solves_every_problem_of_a_set(void **state)
{
    const uint32_t set = *(const uint32_t *)*state;
    const uint64_t count = problem_count(1000000);
    double *etas = malloc((size_t)count * sizeof *etas);
    tally sum = {0};
    assert_non_null(etas);
    for (uint64_t index = 0; index < count; index++) {
        problem_local problem;
        tribo_solve_info info = {0};
        double p[3] = {0.0, 0.0, 0.0};
        problem_draw(set, SEED, index, &problem);
        etas[index] = solve_and_judge(&problem, p, &info);
        count_problem(&sum, &info, etas[index], index);
    }
    qsort(etas, (size_t)count, sizeof *etas, compare_doubles);
    print_tally(set, count, &sum, etas[count / 2]);
    free(etas);
    assert_int_equal(sum.failures, 0);
    assert_true(sum.worst <= worst_eta);
    /* a set without all three modes would not test what it is for */
    for (size_t mode = 0; mode < 3; mode++) {
        assert_true(sum.modes[mode] > count / 100);
    }
}

/* ---- forward error --------------------------------------------------------------------------- */

typedef struct forward {
    uint64_t several; /* problems with three solutions */
    double worst;     /* of the error in units of eps cond(W) */
    double worst_of_several;
    uint64_t worst_index;
    uint64_t unmatched_modes;
} forward;

static void compare_with_twin(uint32_t set, uint64_t index, forward *sum, double *unit)
{
    problem_local problem;
    tribo_solve_info info = {0};
    quad_solutions truth;
    double p[3] = {0.0, 0.0, 0.0};
    size_t nearest = 0;
    info.struct_size = sizeof info;
    problem_draw(set, SEED, index, &problem);
    quad_solve(problem.w, problem.b, problem.mu, problem.mu, &truth);
    assert_true(truth.count == 1 || truth.count == 3);
    assert_int_equal(tribo_contact_solve(problem.w, problem.b, problem.mu, problem.mu, p, &info),
                     TRIBO_OK);
    const double error = quad_solution_error(&truth, p, &nearest);
    *unit = error / (DBL_EPSILON * quad_condition(problem.w));
    sum->unmatched_modes += truth.mode[nearest] != info.mode;
    if (truth.count > 1) {
        sum->several++;
        sum->worst_of_several = fmax(sum->worst_of_several, *unit);
    } else if (*unit > sum->worst) {
        sum->worst = *unit;
        sum->worst_index = index;
    }
}

static void agrees_with_the_twin(void **state)
{
    (void)state;
    if (!QUAD_AVAILABLE) {
        print_message("# this compiler has no quadruple precision\n");
        skip();
    }
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        enum { SAMPLE = 2000 };
        static double units[SAMPLE];
        forward sum = {0};
        const uint64_t count = problem_count(SAMPLE);
        for (uint64_t k = 0; k < count; k++) {
            compare_with_twin(set, 499 * k, &sum, &units[k]);
        }
        qsort(units, (size_t)count, sizeof units[0], compare_doubles);
        print_message("# %-2s forward error / (eps cond W): median %.2g p99 %.2g, worst %.3g "
                      "(index %llu); %llu with three solutions: worst %.3g; %llu modes differ\n",
                      problem_set_name(set), units[count / 2], units[count * 99 / 100], sum.worst,
                      (unsigned long long)sum.worst_index, (unsigned long long)sum.several,
                      sum.worst_of_several, (unsigned long long)sum.unmatched_modes);
        assert_true(units[count - 1] <= 64.0);
    }
}

/* ---- extremes -------------------------------------------------------------------------------- */

/* Brings the greatest diagonal entry of W and the greatest of b to 1, to keep scales in range. */
static void normalise(problem_local *problem)
{
    double *w = problem->w;
    double *b = problem->b;
    const double top_w = fmax(w[0], fmax(w[3], w[5]));
    const double top_b = fmax(fabs(b[0]), fmax(fabs(b[1]), fabs(b[2])));
    for (size_t i = 0; i < 6; i++) {
        w[i] /= top_w;
    }
    for (size_t i = 0; i < 3; i++) {
        b[i] /= top_b;
    }
}

static void scale_problem(problem_local *problem, double of_w, double of_b)
{
    for (size_t i = 0; i < 6; i++) {
        problem->w[i] *= of_w;
    }
    for (size_t i = 0; i < 3; i++) {
        problem->b[i] *= of_b;
    }
}

/* Does the first `count` problems of each set after `change`; returns the worst eta. */
static double worst_after(void (*change)(problem_local *, uint64_t, double), double with,
                          uint64_t count)
{
    double worst = 0.0;
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        for (uint64_t index = 0; index < count; index++) {
            problem_local problem;
            tribo_solve_info info = {0};
            double p[3] = {0.0, 0.0, 0.0};
            problem_draw(set, SEED + 1, index, &problem);
            normalise(&problem);
            change(&problem, index, with);
            const double eta = solve_and_judge(&problem, p, &info);
            if (!(eta <= worst_eta)) {
                print_problem("eta too great", problem.w, problem.b, problem.mu);
                print_message("# set %s, index %llu, eta %g\n", problem_set_name(set),
                              (unsigned long long)index, eta);
            }
            worst = fmax(worst, eta);
        }
    }
    return worst;
}

static void scale_both(problem_local *problem, uint64_t index, double with)
{
    (void)index;
    scale_problem(problem, with, with);
}

static void scale_matrix(problem_local *problem, uint64_t index, double with)
{
    (void)index;
    scale_problem(problem, with, 1.0);
}

static void scale_velocity(problem_local *problem, uint64_t index, double with)
{
    (void)index;
    scale_problem(problem, 1.0, with);
}

static void scale_apart(problem_local *problem, uint64_t index, double with)
{
    (void)index;
    scale_problem(problem, with, 1.0 / with);
}

static void set_friction(problem_local *problem, uint64_t index, double with)
{
    (void)index;
    problem->mu = with;
}

static void set_small_approach(problem_local *problem, uint64_t index, double with)
{
    problem_random random;
    problem_random_start(&random, 99, SEED, index);
    problem->b[0] = -problem_random_decades(&random, with, -3.0);
}

static void solves_at_any_scale(void **state)
{
    static const struct {
        const char *name;
        void (*change)(problem_local *, uint64_t, double);
        double with;
    } cases[] = {
        {"W, b times 1e290", scale_both, 1e290},
        {"W, b times 1e-290", scale_both, 1e-290},
        {"W times 1e290", scale_matrix, 1e290},
        {"W times 1e-290", scale_matrix, 1e-290},
        {"b times 1e290", scale_velocity, 1e290},
        {"b times 1e-290", scale_velocity, 1e-290},
        {"W times 1e145, b times 1e-145", scale_apart, 1e145},
        {"W times 1e-145, b times 1e145", scale_apart, 1e-145},
        {"mu = 1e100", set_friction, 1e100},
        {"mu = 1e-100", set_friction, 1e-100},
        {"mu = 1e300", set_friction, 1e300},
        {"mu = 0", set_friction, 0.0},
        {"b_n down to -1e-300", set_small_approach, -300.0},
    };
    (void)state;
    const uint64_t count = problem_count(2000);
    double worst = 0.0;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const double eta = worst_after(cases[k].change, cases[k].with, count);
        print_message("# %-30s worst eta %.2g\n", cases[k].name, eta);
        worst = fmax(worst, eta);
    }
    assert_true(worst <= worst_eta);
}

/* ---- special directions ---------------------------------------------------------------------- */

/* Problems built from their Schur complement S = R diag(1, l) R^T: W_tt = S + w w^T / W_nn and
 * b_t = w b_n / W_nn - c, with w and c along eigenvectors, zero, or nearly so. */
static void draw_special(uint64_t index, problem_local *out)
{
    problem_random random;
    double e[2];
    double along[2][2];
    problem_random_start(&random, 97, SEED, index);
    problem_random_direction(&random, 2, e);
    const double least = index % 8 == 0 ? 1.0 : problem_random_decades(&random, -12.0, 0.0);
    for (size_t k = 0; k < 2; k++) {
        const uint64_t kind = problem_random_bits(&random) % 6;
        const double size = problem_random_decades(&random, -4.0, 1.0);
        const double off = kind < 2 ? 0.0 : problem_random_decades(&random, -16.0, 0.0);
        along[k][0] = kind == 5 ? 0.0 : (kind % 2 == 0 ? size : off * size);
        along[k][1] = kind == 5 ? 0.0 : (kind % 2 == 0 ? off * size : size);
    }
    const double nn = problem_random_decades(&random, -3.0, 1.0);
    const double bn = -problem_random_decades(&random, -6.0, 1.0);
    const double w1 = e[0] * along[0][0] - e[1] * along[0][1];
    const double w2 = e[1] * along[0][0] + e[0] * along[0][1];
    const double c1 = e[0] * along[1][0] - e[1] * along[1][1];
    const double c2 = e[1] * along[1][0] + e[0] * along[1][1];
    const double w[6] = {nn,
                         w1,
                         w2,
                         e[0] * e[0] + e[1] * e[1] * least + w1 * w1 / nn,
                         e[0] * e[1] * (1.0 - least) + w1 * w2 / nn,
                         e[1] * e[1] + e[0] * e[0] * least + w2 * w2 / nn};
    memcpy(out->w, w, sizeof out->w);
    out->b[0] = bn;
    out->b[1] = w1 * bn / nn - c1;
    out->b[2] = w2 * bn / nn - c2;
    out->mu = problem_random_decades(&random, -3.0, 3.0);
}

static void solves_special_directions(void **state)
{
    const uint64_t count = problem_count(400000);
    uint64_t modes[3] = {0, 0, 0};
    uint64_t failures = 0;
    double worst = 0.0;
    (void)state;
    for (uint64_t index = 0; index < count; index++) {
        problem_local problem;
        tribo_solve_info info = {0};
        double p[3] = {0.0, 0.0, 0.0};
        draw_special(index, &problem);
        if (!(quad_condition_bound(problem.w) <= 1e12)) {
            continue; /* rounding of W may have left it singular */
        }
        const double eta = solve_and_judge(&problem, p, &info);
        modes[eta < HUGE_VAL ? info.mode : 0]++;
        failures += eta > solved;
        worst = fmax(worst, eta);
        if (!(eta <= worst_eta)) {
            print_problem("eta too great", problem.w, problem.b, problem.mu);
            print_message("# index %llu, eta %g\n", (unsigned long long)index, eta);
        }
    }
    print_message(
        "# %llu with c or w_t along an eigenvector of S or zero: %llu failures, worst eta "
        "%.2g, stick %llu slip %llu\n",
        (unsigned long long)count, (unsigned long long)failures, worst,
        (unsigned long long)modes[TRIBO_MODE_STICK], (unsigned long long)modes[TRIBO_MODE_SLIP]);
    assert_int_equal(failures, 0);
    assert_true(worst <= worst_eta);
}

/* ---- equal bits under powers of two ---------------------------------------------------------- */

static int same_bits(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static int scales_exactly(const problem_local *problem, int of_w, int of_b)
{
    problem_local scaled = *problem;
    tribo_solve_info info = {0};
    tribo_solve_info scaled_info = {0};
    double p[3];
    double q[3];
    info.struct_size = scaled_info.struct_size = sizeof info;
    scale_problem(&scaled, ldexp(1.0, of_w), ldexp(1.0, of_b));
    if (tribo_contact_solve(problem->w, problem->b, problem->mu, problem->mu, p, &info) ||
        tribo_contact_solve(scaled.w, scaled.b, scaled.mu, scaled.mu, q, &scaled_info)) {
        return 0;
    }
    return same_bits(q[0], ldexp(p[0], of_b - of_w)) && same_bits(q[1], ldexp(p[1], of_b - of_w)) &&
           same_bits(q[2], ldexp(p[2], of_b - of_w)) &&
           same_bits(scaled_info.nu, ldexp(info.nu, of_w)) && info.mode == scaled_info.mode &&
           info.iterations == scaled_info.iterations;
}

static void powers_of_two_scale_the_bits(void **state)
{
    const uint64_t count = problem_count(15000);
    uint64_t failures = 0;
    (void)state;
    for (uint64_t index = 0; index < count; index++) {
        problem_local problem;
        problem_random random;
        problem_draw((uint32_t)(index % PROBLEM_SETS), SEED + 2, index, &problem);
        problem_random_start(&random, 98, SEED, index);
        const int of_w = (int)(problem_random_bits(&random) % 801) - 400;
        const int of_b = (int)(problem_random_bits(&random) % 801) - 400;
        if (!scales_exactly(&problem, of_w, of_b)) {
            print_problem("not the same bits", problem.w, problem.b, problem.mu);
            print_message("# W times 2^%d, b times 2^%d\n", of_w, of_b);
            failures++;
        }
    }
    print_message("# %llu problems scaled by 2^i and 2^j: %llu differ\n", (unsigned long long)count,
                  (unsigned long long)failures);
    assert_int_equal(failures, 0);
}

/* ---- static above dynamic friction ----------------------------------------------------------- */

static void static_and_dynamic_friction_differ(void **state)
{
    const uint64_t count = problem_count(20000);
    (void)state;
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        double worst = 0.0;
        uint64_t kept = 0; /* stick that mu_d alone would not hold */
        for (uint64_t index = 0; index < count; index++) {
            problem_impact problem;
            tribo_solve_info info = {0};
            double p[3];
            info.struct_size = sizeof info;
            problem_draw_impact(set, SEED + 3, index, &problem);
            const double mu_s = problem.pair.mu_s;
            const double mu_d = problem.pair.mu_d;
            assert_int_equal(tribo_contact_solve(problem.w, problem.u, mu_s, mu_d, p, &info),
                             TRIBO_OK);
            const int sticks = info.mode == TRIBO_MODE_STICK;
            kept += sticks && sqrt(p[1] * p[1] + p[2] * p[2]) > mu_d * p[0];
            worst = fmax(worst, quad_eta(problem.w, problem.u, sticks ? mu_s : mu_d, p));
        }
        print_message("# %-2s mu_d < mu_s: worst eta %.2g, %llu of %llu stick by mu_s alone\n",
                      problem_set_name(set), worst, (unsigned long long)kept,
                      (unsigned long long)count);
        assert_true(worst <= worst_eta);
        assert_true(kept > 0);
    }
}

/* ---- the judges are judged ------------------------------------------------------------------- */

static void the_residual_sees_small_faults(void **state)
{
    static const double w[6] = {2.5, 1.5, 0.0, 2.5, 0.0, 1.0};
    static const double b[3] = {-1.5, -3.0, 1.0};
    static const double p[3] = {0.51667893196905942, 0.1388684467182343, -0.068859967998299525};
    (void)state;
    assert_true(quad_eta(w, b, 0.3, p) < 1e-15);
    for (size_t i = 0; i < 3; i++) {
        double off[3] = {p[0], p[1], p[2]};
        off[i] *= 1.0 + 1e-7;
        assert_true(quad_eta(w, b, 0.3, off) > solved);
    }
    assert_true(quad_eta(w, b, 0.31, p) > 1e-3);
}

/* Problems with solutions known to 60 digits. L13 is L04 in other units. */
static const struct {
    const char *name;
    double w[6];
    double b[3];
    double mu;
    double p[3];
} fixtures[] = {
    {"L01", {1, 0, 0, 3.5, 0, 3.5}, {-1.5, 1, -2}, 0.5, {1.5, -2.0 / 7.0, 4.0 / 7.0}},
    {"L02", {1, 0, 0, 3.5, 0, 3.5}, {-1.5, 3, -4}, 0.5, {1.5, -0.45, 0.6}},
    {"L03",
     {2.5, 1.5, 0, 2.5, 0, 1},
     {-1.5, -3, 0},
     0.3,
     {0.50847457627118644, 0.15254237288135593, 0}},
    {"L04",
     {2.5, 1.5, 0, 2.5, 0, 1},
     {-1.5, -3, 1},
     0.3,
     {0.51667893196905942, 0.1388684467182343, -0.068859967998299525}},
    {"L05",
     {15, -1, -2, 14, 1, 16},
     {-1, 2, 3},
     0.13,
     {0.065409925913629479, -0.0047634262382201316, -0.0070438425286688384}},
    {"L06",
     {0.01344, -9.421e-7, 0.001486, 0.1061, 0.0001733, 0.001442},
     {-0.1458, -0.2484, -0.1515},
     0.63,
     {10.173264415434215, 1.9485792540220339, 6.1057617853831561}},
    {"L07",
     {2.88477717, -0.9707955, -2.07305584, 5.32596138, -0.72388089, 4.11915949},
     {-0.00799683, 0.00065288, 0.00139417},
     0.9,
     {0.0047141441640366458, 0.0010379396616583241, 0.0022164373091330852}},
    {"L08",
     {2.5, 1.5, 0.25, 2.5, -0.5, 1},
     {-0.001, 1, -2},
     1000,
     {0.00091603887607802784, -0.15143261877557633, 0.90343532389267767}},
    {"L09",
     {2.5, 1.5, 0.25, 2.5, -0.5, 1},
     {-1, 1, -2},
     0.001,
     {0.40012402045429387, -0.00025771354443162673, 0.00030607672365110702}},
    {"L10",
     {1, 1, 0, 1.000000000001, 0, 1},
     {-1, -1.5, 0.25},
     0.5,
     {0.67638661081791387, 0.32361338918208613, -0.098229762116782498}},
    {"L11", {1, 0, 0, 3.5, 0, 3.5}, {-1, 1.75 * (1 + 0x1p-40), 0}, 0.5, {1, -0.5, 0}},
    {"L12", {1, 0, 0, 3.5, 0, 3.5}, {-1, 1.75, 0}, 0.5, {1, -0.5, 0}},
    {"L14", {1.6, 1.2, 0, 3.4, 0, 1}, {0.1, 1, 0}, 2, {0, 0, 0}},
    {"L14", {1.6, 1.2, 0, 3.4, 0, 1}, {0.1, 1, 0}, 2, {0.125, -0.25, 0}},
    {"L14", {1.6, 1.2, 0, 3.4, 0, 1}, {0.1, 1, 0}, 2, {0.215, -0.37, 0}},
    {"L15",
     {2.5, 1.5, 0.25, 2.5, -0.5, 1},
     {-1e-12, 1, -2},
     0.5,
     {4.3929141899195973e-13, -9.8228547479875138e-14, 1.9645709495965346e-13}},
    {"L16", {1, 0, 0, 1, 0, 1}, {-1, 1, 3}, 0.1, {1, -0.031622776601683795, -0.094868329805051388}},
    {"L17",
     {4.375, 2.625, -0.75, 3.125, -0.875, 4.5},
     {-0.0625, 0.75, 0.75},
     2,
     {0.31757259865971705, -0.56962025316455696, -0.22449739389426657}},
    {"L17",
     {4.375, 2.625, -0.75, 3.125, -0.875, 4.5},
     {-0.0625, 0.75, 0.75},
     2,
     {0.17464160017074114, -0.31207792239530554, -0.15686339405424611}},
    {"L17",
     {4.375, 2.625, -0.75, 3.125, -0.875, 4.5},
     {-0.0625, 0.75, 0.75},
     2,
     {0.068978854621670813, -0.11354360446275848, -0.078359296993241592}},
};

static void the_twin_finds_every_known_solution(void **state)
{
    (void)state;
    if (!QUAD_AVAILABLE) {
        print_message("# this compiler has no quadruple precision\n");
        skip();
    }
    for (size_t k = 0; k < sizeof fixtures / sizeof fixtures[0]; k++) {
        quad_solutions all;
        quad_solve(fixtures[k].w, fixtures[k].b, fixtures[k].mu, fixtures[k].mu, &all);
        assert_true(all.count == (strcmp(fixtures[k].name, "L14") >= 0 &&
                                          (fixtures[k].name[2] == '4' || fixtures[k].name[2] == '7')
                                      ? 3
                                      : 1));
        /* the references are doubles, and some inputs are: 1e-12 is cancelled to 1e-16 in L10 */
        if (!(quad_solution_error(&all, fixtures[k].p, NULL) <= 4.0 * DBL_EPSILON)) {
            fail_msg("%s: error %g", fixtures[k].name,
                     quad_solution_error(&all, fixtures[k].p, NULL));
        }
    }
}

int main(void)
{
    static uint32_t sets[PROBLEM_SETS] = {PROBLEM_P1, PROBLEM_P2, PROBLEM_P3,
                                          PROBLEM_S,  PROBLEM_B,  PROBLEM_U};
#define SET_TEST(name, set)                                                                        \
    {                                                                                              \
        "solves every problem of set " name, solves_every_problem_of_a_set, NULL, NULL, &sets[set] \
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_residual_sees_small_faults),
        cmocka_unit_test(the_twin_finds_every_known_solution),
        SET_TEST("P1", PROBLEM_P1),
        SET_TEST("P2", PROBLEM_P2),
        SET_TEST("P3", PROBLEM_P3),
        SET_TEST("S", PROBLEM_S),
        SET_TEST("B", PROBLEM_B),
        SET_TEST("U", PROBLEM_U),
        cmocka_unit_test(agrees_with_the_twin),
        cmocka_unit_test(solves_at_any_scale),
        cmocka_unit_test(solves_special_directions),
        cmocka_unit_test(powers_of_two_scale_the_bits),
        cmocka_unit_test(static_and_dynamic_friction_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
