/* One contact: geometry, contact matrix, cone, exact solve, force-level friction. */
#include <tribo/audit.h>
#include <tribo/contact.h>

#include "check.h"
#include "problems.h"
#include "quad.h"

static const double axes[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0}; /* n = z, t1 = x, t2 = y */

static void full_matrix(const double w[6], double full[9])
{
    const double m[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    memcpy(full, m, sizeof m);
}

/* ---- exact solve: fixtures ------------------------------------------------------------------- */

enum { OPEN = TRIBO_MODE_OPEN, STICK = TRIBO_MODE_STICK, SLIP = TRIBO_MODE_SLIP };

#define BALL                 \
    {                        \
        1, 0, 0, 3.5, 0, 3.5 \
    }
#define ROD                    \
    {                          \
        2.5, 1.5, 0, 2.5, 0, 1 \
    }
#define SKEW                         \
    {                                \
        2.5, 1.5, 0.25, 2.5, -0.5, 1 \
    }
#define THREE                                   \
    {                                           \
        4.375, 2.625, -0.75, 3.125, -0.875, 4.5 \
    }

/* W, b, mu and the solution to 17 digits, found with 60. L05 and L06 are one-contact problems of
 * Siconos, L07 of ContactBench, L16 of Siconos; L14 and L17 have three solutions, of which sticking
 * is the one to be found (b_n >= 0: the open one). nu is 0 where it is not given. */
static const struct {
    const char *name;
    double w[6];
    double b[3];
    double mu;
    uint32_t mode;
    double p[3];
    double nu;
} fixtures[] = {
    {"L01", BALL, {-1.5, 1, -2}, 0.5, STICK, {1.5, -2.0 / 7.0, 4.0 / 7.0}, 0},
    {"L02", BALL, {-1.5, 3, -4}, 0.5, SLIP, {1.5, -0.45, 0.6}, 19.0 / 6.0},
    {"L03", ROD, {-1.5, -3, 0}, 0.3, SLIP, {0.50847457627118644, 0.15254237288135593, 0}, 0},
    {"L04",
     ROD,
     {-1.5, -3, 1},
     0.3,
     SLIP,
     {0.51667893196905942, 0.1388684467182343, -0.068859967998299525},
     0},
    {"L05",
     {15, -1, -2, 14, 1, 16},
     {-1, 2, 3},
     0.13,
     SLIP,
     {0.065409925913629479, -0.0047634262382201316, -0.0070438425286688384},
     0},
    {"L06",
     {0.01344, -9.421e-7, 0.001486, 0.1061, 0.0001733, 0.001442},
     {-0.1458, -0.2484, -0.1515},
     0.63,
     SLIP,
     {10.173264415434215, 1.9485792540220339, 6.1057617853831561},
     0},
    {"L07",
     {2.88477717, -0.9707955, -2.07305584, 5.32596138, -0.72388089, 4.11915949},
     {-0.00799683, 0.00065288, 0.00139417},
     0.9,
     STICK,
     {0.0047141441640366458, 0.0010379396616583241, 0.0022164373091330852},
     0},
    {"L08",
     SKEW,
     {-0.001, 1, -2},
     1000,
     SLIP,
     {0.00091603887607802784, -0.15143261877557633, 0.90343532389267767},
     0},
    {"L09",
     SKEW,
     {-1, 1, -2},
     0.001,
     SLIP,
     {0.40012402045429387, -0.00025771354443162673, 0.00030607672365110702},
     0},
    {"L10",
     {1, 1, 0, 1.000000000001, 0, 1},
     {-1, -1.5, 0.25},
     0.5,
     SLIP,
     {0.67638661081791387, 0.32361338918208613, -0.098229762116782498},
     0},
    {"L11", BALL, {-1, 1.75 * (1.0 + 0x1p-40), 0}, 0.5, SLIP, {1, -0.5, 0}, 3.18323e-12},
    {"L12", BALL, {-1, 1.75, 0}, 0.5, STICK, {1, -0.5, 0}, 0},
    {"L14", {1.6, 1.2, 0, 3.4, 0, 1}, {0.1, 1, 0}, 2, OPEN, {0, 0, 0}, 0},
    {"L15",
     SKEW,
     {-1e-12, 1, -2},
     0.5,
     SLIP,
     {4.3929141899195973e-13, -9.8228547479875138e-14, 1.9645709495965346e-13},
     0},
    {"L16",
     {1, 0, 0, 1, 0, 1},
     {-1, 1, 3},
     0.1,
     SLIP,
     {1, -0.031622776601683795, -0.094868329805051385},
     0},
    {"L17",
     THREE,
     {-0.0625, 0.75, 0.75},
     2,
     STICK,
     {0.31757259865971705, -0.56962025316455696, -0.22449739389426657},
     0},
};

enum { FIXTURES = sizeof fixtures / sizeof fixtures[0] };

static void residual_velocity(const double w[9], const double b[3], const double p[3],
                              long double v[3])
{
    for (int i = 0; i < 3; i++) {
        v[i] = (long double)b[i];
        for (int k = 0; k < 3; k++) {
            v[i] += (long double)w[3 * i + k] * (long double)p[k];
        }
    }
}

static void check_solution(size_t i, const double p[3], const tribo_solve_info *info)
{
    const double size = distance(fixtures[i].p, (const double[3]){0, 0, 0}, 3);
    const double tolerance = 64.0 * EPS * quad_condition(fixtures[i].w);
    const double error = distance(p, fixtures[i].p, 3);
    if (!(error <= tolerance * size)) {
        print_message("# %s: error %.3g of the tolerance\n", fixtures[i].name,
                      error / tolerance / size);
    }
    within(error, tolerance * size);
    if (info->mode != fixtures[i].mode) {
        fail_msg("%s: mode %u", fixtures[i].name, (unsigned)info->mode);
    }
    assert_true(quad_eta(fixtures[i].w, fixtures[i].b, fixtures[i].mu, p) <= 1e-11);
    if (fixtures[i].nu != 0.0) {
        /* nu is the difference of |c| / |p_t| and S, which is 3.5 in both rows */
        within(fabs(info->nu - fixtures[i].nu), 64.0 * EPS * 3.5 + 5e-6 * fixtures[i].nu);
    }
    double full[9];
    long double v[3];
    full_matrix(fixtures[i].w, full);
    residual_velocity(full, fixtures[i].b, p, v);
    const double scale = tribo_vec3_norm(fixtures[i].b);
    for (int k = 1; k < 3 && info->mode == SLIP; k++) { /* u_t = -nu p_t */
        within((double)fabsl(v[k] + (long double)info->nu * (long double)p[k]), 64 * EPS * scale);
    }
}

static void test_fixtures(void **state)
{
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const double mu = fixtures[i].mu;
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(fixtures[i].w, fixtures[i].b, mu, mu, p, &info),
                         TRIBO_OK);
        check_solution(i, p, &info);
    }
    settle("L01 to L17, 64 eps cond");
}

static void test_fixtures_by_the_general_solve(void **state)
{
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const double mu = fixtures[i].mu;
        double full[9];
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        full_matrix(fixtures[i].w, full);
        assert_int_equal(tribo_contact_solve_general(full, fixtures[i].b, mu, mu, p, &info),
                         TRIBO_OK);
        check_solution(i, p, &info);
    }
    settle("L01 to L17 by bisection, 64 eps cond");
}

/* The other two solutions of L17 and of L14 are solutions too: the fixture is what it says. */
static void test_three_solutions(void **state)
{
    static const double others[4][3] = {
        {0.17464160017074114, -0.31207792239530554, -0.15686339405424611},
        {0.068978854621670813, -0.11354360446275848, -0.078359296993241592},
        {0.125, -0.25, 0},
        {0.215, -0.37, 0},
    };
    static const double w[2][6] = {THREE, {1.6, 1.2, 0, 3.4, 0, 1}};
    static const double b[2][3] = {{-0.0625, 0.75, 0.75}, {0.1, 1, 0}};
    (void)state;
    for (int i = 0; i < 4; i++) {
        within(quad_eta(w[i / 2], b[i / 2], 2.0, others[i]), 64.0 * EPS);
        quad_solutions all;
        quad_solve(w[i / 2], b[i / 2], 2.0, 2.0, &all);
        assert_int_equal(all.count, 3);
    }
    settle("other solutions of L17 and L14");
    /* b_n >= 0 gives the open one, whatever else there is; Painleve's indeterminate rod is L14 */
    double p[3] = {1, 1, 1};
    tribo_solve_info info = {.struct_size = sizeof info};
    assert_int_equal(tribo_contact_solve(w[1], b[1], 2, 2, p, &info), TRIBO_OK);
    assert_true(info.mode == OPEN && p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0);
    const double touching[3] = {0.0, 1.0, -1.0};
    assert_int_equal(tribo_contact_solve(w[1], touching, 2, 2, p, &info), TRIBO_OK);
    assert_true(info.mode == OPEN && p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0);
}

/* L13 among them: W * 2^i and b * 2^j give p * 2^(j-i) to the bit. */
static void test_scaling_is_exact(void **state)
{
    static const int exponents[][2] = {
        {-40, 0}, {40, 0}, {0, 7}, {-3, 200}, {300, -250}, {900, 100}, {-900, -300}, {1, -1},
    };
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const double mu = fixtures[i].mu;
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(fixtures[i].w, fixtures[i].b, mu, mu, p, &info),
                         TRIBO_OK);
        for (size_t k = 0; k < sizeof exponents / sizeof exponents[0]; k++) {
            double w[6];
            double b[3];
            double q[3];
            double full[9];
            tribo_solve_info scaled = {.struct_size = sizeof scaled};
            for (int l = 0; l < 6; l++) {
                w[l] = ldexp(fixtures[i].w[l], exponents[k][0]);
            }
            for (int l = 0; l < 3; l++) {
                b[l] = ldexp(fixtures[i].b[l], exponents[k][1]);
            }
            assert_int_equal(tribo_contact_solve(w, b, mu, mu, q, &scaled), TRIBO_OK);
            for (int l = 0; l < 3; l++) {
                assert_true(q[l] == ldexp(p[l], exponents[k][1] - exponents[k][0]));
            }
            assert_int_equal(scaled.mode, info.mode);
            assert_int_equal(scaled.iterations, info.iterations);
            assert_true(scaled.nu == ldexp(info.nu, exponents[k][0]));
            full_matrix(w, full);
            double g[3];
            double h[3];
            double plain[9];
            full_matrix(fixtures[i].w, plain);
            assert_int_equal(tribo_contact_solve_general(plain, fixtures[i].b, mu, mu, g, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_contact_solve_general(full, b, mu, mu, h, NULL), TRIBO_OK);
            for (int l = 0; l < 3; l++) {
                assert_true(h[l] == ldexp(g[l], exponents[k][1] - exponents[k][0]));
            }
        }
    }
}

/* W = 1 - e e^T with e = (1, -1, 0)/sqrt 2 and b = (-1, -.3, 0): p_n = 2/(1 - mu), and no bounded
 * solution from mu = 1 on. Errors of mu and of W are amplified by 1/(1 - mu). */
static void test_jam(void **state)
{
    static const double w[6] = {0.5, 0.5, 0, 0.5, 0, 1};
    static const double b[3] = {-1, -0.3, 0};
    static const double jams[] = {1.0, 1.0 + EPS, 1.5, 2.0, 1000.0, 1e100};
    double full[9];
    (void)state;
    full_matrix(w, full);
    for (int i = 0; i < 1000; i++) {
        const double mu = i == 0 ? 0.5 : 0.001 * i;
        const double expected[3] = {2.0 / (1.0 - mu), -2.0 * mu / (1.0 - mu), 0.0};
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(w, b, mu, mu, p, &info), TRIBO_OK);
        assert_int_equal(info.mode, SLIP);
        const double tolerance = 64.0 * EPS / (1.0 - mu) * tribo_vec3_norm(expected);
        within(distance(p, expected, 3), tolerance);
        assert_int_equal(tribo_contact_solve_general(full, b, mu, mu, p, &info), TRIBO_OK);
        assert_int_equal(info.mode, SLIP);
        within(distance(p, expected, 3), tolerance);
    }
    settle("mu up to .999 (p = (2000, -1998, 0)), 64 eps / (1 - mu)");
    for (size_t i = 0; i < sizeof jams / sizeof jams[0]; i++) {
        double p[3] = {7, 8, 9};
        const double before[3] = {7, 8, 9};
        assert_int_equal(tribo_contact_solve(w, b, jams[i], jams[i], p, NULL), TRIBO_ERROR_JAM);
        assert_true(same_bits(p, before, 3));
        assert_int_equal(tribo_contact_solve_general(full, b, jams[i], jams[i], p, NULL),
                         TRIBO_ERROR_JAM);
        assert_true(same_bits(p, before, 3));
    }
}

/* W annuls a tangent, (0, 1, -1), and rounding lets b push along it: friction can hold that, so
 * there is no jam. */
static void test_tangential_null_direction(void **state)
{
    static const double w[6] = {6.25, 1, 1, 8, 8, 8};
    static const double b[3] = {-0x1.272727272727p+0, -0x1.2727272727072p-3, -0x1.2727272727272p-3};
    double full[9];
    (void)state;
    full_matrix(w, full);
    for (int i = 0; i < 4; i++) {
        const double share = i % 2 ? 1e-5 : 1.0; /* of the part beyond one p in the cone */
        const double mu = i < 2 ? 0.5 : 5.0;
        const double along = 0.5 * share * (b[1] - b[2]);
        const double pushed[3] = {b[0], 0.5 * (b[1] + b[2]) + along, 0.5 * (b[1] + b[2]) - along};
        for (int general = 0; general < 2; general++) {
            double p[3];
            tribo_measures m;
            assert_int_equal(general ? tribo_contact_solve_general(full, pushed, mu, mu, p, NULL)
                                     : tribo_contact_solve(w, pushed, mu, mu, p, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_audit_contact(w, pushed, mu, p, &m), TRIBO_OK);
            within(m.eta, 1e-13);
        }
    }
    settle("null direction among the tangents: eta, 1e-13");
}

/* Tangents along which nothing can move: friction cannot change the sliding there, and opposes it
 * with all it has; where nothing slides it sticks. mu = 1/2. */
static void test_locked_tangents(void **state)
{
    static const struct {
        double d[2]; /* W = diag(1, d) */
        double b[2];
        double p[2];
        uint32_t mode;
    } rows[] = {
        {{0, 0}, {0, 0}, {0, 0}, STICK},        {{0, 0}, {0.1, 0}, {-0.5, 0}, SLIP},
        {{0, 0}, {0, 1e-9}, {0, -0.5}, SLIP},   {{0, 0}, {-3, 4}, {0.3, -0.4}, SLIP},
        {{1, 0}, {0.25, 0}, {-0.25, 0}, STICK}, {{0, 1}, {0, 0.25}, {0, -0.25}, STICK},
        {{1, 0}, {2, 0}, {-0.5, 0}, SLIP},      {{0, 1}, {0, -2}, {0, 0.5}, SLIP},
        {{1, 0}, {0, 2}, {0, -0.5}, SLIP},      {{0, 1}, {-2, 0}, {0.5, 0}, SLIP},
        {{1, 0}, {0, 1e-9}, {0, -0.5}, SLIP},   {{0, 1}, {1e-9, 0}, {-0.5, 0}, SLIP},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double w[6] = {1, 0, 0, rows[i].d[0], 0, rows[i].d[1]};
        const double b[3] = {-1, rows[i].b[0], rows[i].b[1]};
        const double expected[3] = {1, rows[i].p[0], rows[i].p[1]};
        double full[9];
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        full_matrix(w, full);
        assert_int_equal(tribo_contact_solve(w, b, 0.5, 0.5, p, &info), TRIBO_OK);
        within(distance(p, expected, 3), 64 * EPS);
        assert_int_equal(info.mode, rows[i].mode);
        assert_int_equal(tribo_contact_solve_general(full, b, 0.5, 0.5, p, &info), TRIBO_OK);
        within(distance(p, expected, 3), 64 * EPS);
        assert_int_equal(info.mode, rows[i].mode);
    }
    settle("locked tangents, 64 eps");
}

/* Of rank 2 (a body held at one more point, say), with b = -W p for a p well inside of the cone:
 * that p is a solution, so one has to be found. With b . z = 0 for W z = 0 there is no jam. */
static void test_singular_matrices_that_stick(void **state)
{
    problem_random random;
    unsigned refused = 0;
    (void)state;
    problem_random_start(&random, 37, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double a[2][3];
        double w[6];
        double p[3] = {1, 0, 0};
        double b[3];
        double full[9];
        const double mu = problem_random_uniform(&random, 0.1, 1.0);
        for (int k = 0; k < 3; k++) {
            a[0][k] = i % 4 == 3 && k > 0 ? 0.0 : problem_random_normal(&random);
            a[1][k] = problem_random_normal(&random);
        }
        if (i % 4 == 1 || i % 4 == 2) { /* one tangent locked */
            a[0][i % 4] = a[1][i % 4] = 0.0;
        }
        for (int k = 0, entry = 0; k < 3; k++) {
            for (int l = k; l < 3; l++) {
                w[entry++] = a[0][k] * a[0][l] + a[1][k] * a[1][l];
            }
        }
        /* a null vector in the cone would jam under the least disturbance */
        double z[3];
        tribo_vec3_cross(a[0], a[1], z);
        if (hypot(z[1], z[2]) < 1.1 * mu * fabs(z[0])) {
            continue;
        }
        problem_random_direction(&random, 2, p + 1);
        const double share = mu * problem_random_uniform(&random, 0.0, 0.9);
        p[1] *= share;
        p[2] *= share;
        tribo_sym3_apply(w, p, b);
        tribo_vec3_scale(-1.0, b, b);
        full_matrix(w, full);
        for (int general = 0; general < 2 && b[0] < 0.0; general++) {
            const tribo_status status = general
                                            ? tribo_contact_solve_general(full, b, mu, mu, p, NULL)
                                            : tribo_contact_solve(w, b, mu, mu, p, NULL);
            if (status != TRIBO_OK) {
                refused++;
                continue;
            }
            within(quad_eta(w, b, mu, p), 1e-9);
        }
    }
    print_message("# refused %u of 40000\n", refused);
    settle("eta 1e-9");
    assert_int_equal(refused, 0);
}

/* Stick is tested with mu_s, slip goes by mu_d. Here |p_t|/p_n = 0.42592 would stick. */
static void test_static_and_dynamic_friction(void **state)
{
    static const double w[6] = BALL;
    static const double b[3] = {-1.5, 1, -2};
    const double ratio = sqrt(5.0) * 2.0 / 7.0 / 1.5;
    double full[9];
    (void)state;
    full_matrix(w, full);
    for (int i = 0; i < 4; i++) {
        const double mu_s = ratio * (i % 2 ? 1.0 - 1e-12 : 1.0 + 1e-12);
        const double p_t = 0.2 * 1.5 / sqrt(5.0);
        const double slip[3] = {1.5, -p_t, 2.0 * p_t};
        const double stick[3] = {1.5, -2.0 / 7.0, 4.0 / 7.0};
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        const tribo_status status = i < 2
                                        ? tribo_contact_solve(w, b, mu_s, 0.2, p, &info)
                                        : tribo_contact_solve_general(full, b, mu_s, 0.2, p, &info);
        assert_int_equal(status, TRIBO_OK);
        assert_int_equal(info.mode, i % 2 ? SLIP : STICK);
        within(distance(p, i % 2 ? slip : stick, 3), 64.0 * EPS * 3.5 * tribo_vec3_norm(p));
    }
    settle("mu_s decides, mu_d slides, 64 eps cond");
}

/* Without friction, and next to it. */
static void test_limits_of_friction(void **state)
{
    static const double w[6] = SKEW;
    static const double b[3] = {-1, 1, -2};
    static const double small[] = {0.0, -0.0, 5e-324, 1e-300, 1e-100, 1e-20};
    double p[3];
    (void)state;
    for (size_t i = 0; i < sizeof small / sizeof small[0]; i++) {
        assert_int_equal(tribo_contact_solve(w, b, small[i], small[i], p, NULL), TRIBO_OK);
        within(distance(p, (const double[3]){0.4, 0, 0}, 3), 64 * EPS + 4 * small[i]);
        assert_true(fabs(p[1]) <= small[i] && fabs(p[2]) <= small[i]);
    }
    /* c = 0: no drive to slide, so it sticks at any mu, mu = 0 included */
    const double straight[3] = {-2.5, -1.5, -0.25};
    for (size_t i = 0; i < sizeof small / sizeof small[0]; i++) {
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(w, straight, small[i], small[i], p, &info), TRIBO_OK);
        assert_true(p[0] == 1.0 && p[1] == 0.0 && p[2] == 0.0);
        assert_int_equal(info.mode, STICK);
    }
    static const double large[] = {1e3, 1e20, 1e100, 1e300, DBL_MAX};
    double stick[3];
    for (size_t i = 0; i < sizeof large / sizeof large[0]; i++) {
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(w, straight, large[i], large[i], stick, NULL),
                         TRIBO_OK);
        assert_int_equal(tribo_contact_solve(w, b, large[i], large[i], p, &info), TRIBO_OK);
        assert_true(quad_eta(w, b, large[i], p) <= 1e-11);
        assert_true(p[0] > 0.0);
    }
    settle("mu down to 5e-324, 64 eps");
}

static void test_extreme_sizes(void **state)
{
    static const double w[6] = SKEW;
    static const double b[3] = {-1, 1, -2};
    double p[3];
    (void)state;
    assert_int_equal(tribo_contact_solve(w, b, 0.5, 0.5, p, NULL), TRIBO_OK);
    for (int i = -290; i <= 290; i += 10) {
        const double s = pow(10.0, i);
        double ws[6];
        double bs[3];
        double q[3];
        for (int k = 0; k < 6; k++) {
            ws[k] = w[k] * s;
        }
        for (int k = 0; k < 3; k++) {
            bs[k] = b[k] * s;
        }
        assert_int_equal(tribo_contact_solve(ws, bs, 0.5, 0.5, q, NULL), TRIBO_OK);
        within(distance(p, q, 3), 64.0 * EPS * 4.0 * tribo_vec3_norm(p));
    }
    settle("W and b times 1e-290 to 1e290, 64 eps cond");
    /* the ends of the range are in it */
    static const double ends[2] = {0x1p-1000, 0x1p1000};
    for (int i = 0; i < 4; i++) {
        const double m = ends[i / 2];
        const double bound = ends[i % 2];
        const double end_w[6] = {m, 0, 0, m, 0, m};
        const double end_b[3] = {-bound, 0, 0};
        if (i == 1) { /* p would be 2^2000 */
            assert_int_equal(tribo_contact_solve(end_w, end_b, 0.5, 0.5, p, NULL),
                             TRIBO_ERROR_RANGE);
            continue;
        }
        assert_int_equal(tribo_contact_solve(end_w, end_b, 0.5, 0.5, p, NULL), TRIBO_OK);
        assert_true(p[0] == ldexp(1.0, i == 2 ? -2000 : 0) && p[1] == 0.0 && p[2] == 0.0);
    }
    /* b_n far below b_t */
    static const double grazing[] = {-1e-100, -1e-300, -5e-324};
    for (int i = 0; i < 3; i++) {
        const double graze[3] = {grazing[i], 1, -2};
        assert_int_equal(tribo_contact_solve(w, graze, 0.5, 0.5, p, NULL), TRIBO_OK);
        assert_true(p[0] >= 0.0 && p[0] <= 2.0 * -grazing[i]);
        assert_true(quad_eta(w, graze, 0.5, p) <= 1e-11);
    }
}

/* A tangential frame turned by an angle turns p_t; a mirrored one mirrors it. */
static void test_frames_do_not_matter(void **state)
{
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const double *w = fixtures[i].w;
        const double *b = fixtures[i].b;
        const double mu = fixtures[i].mu;
        const double mirrored_w[6] = {w[0], w[1], -w[2], w[3], -w[4], w[5]};
        const double mirrored_b[3] = {b[0], b[1], -b[2]};
        double p[3];
        double q[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_contact_solve(w, b, mu, mu, p, NULL), TRIBO_OK);
        assert_int_equal(tribo_contact_solve(mirrored_w, mirrored_b, mu, mu, q, NULL), TRIBO_OK);
        within(fabs(q[0] - p[0]) + fabs(q[1] - p[1]) + fabs(q[2] + p[2]),
               8.0 * EPS * tribo_vec3_norm(p));
        /* exactly on the boundary a turned frame may slip by a rounding */
        for (int degrees = 1; degrees < 360 && strcmp(fixtures[i].name, "L12"); degrees++) {
            const double c = cos(degrees * 0.017453292519943295);
            const double s = sin(degrees * 0.017453292519943295);
            const double turned_w[6] = {
                w[0],
                c * w[1] - s * w[2],
                s * w[1] + c * w[2],
                c * c * w[3] - 2 * c * s * w[4] + s * s * w[5],
                c * s * (w[3] - w[5]) + (c * c - s * s) * w[4],
                s * s * w[3] + 2 * c * s * w[4] + c * c * w[5],
            };
            const double turned_b[3] = {b[0], c * b[1] - s * b[2], s * b[1] + c * b[2]};
            const double turned_p[3] = {p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
            assert_int_equal(tribo_contact_solve(turned_w, turned_b, mu, mu, q, &info), TRIBO_OK);
            within(distance(q, turned_p, 3), 128.0 * EPS * quad_condition(w) * tribo_vec3_norm(p));
            assert_int_equal(info.mode, fixtures[i].mode);
        }
    }
    settle("mirrored frame, 8 eps; turned frame, 128 eps cond");
}

/* Natural-map residual for a matrix that need not be symmetric; scales as in the audit. */
static double general_eta(const double w[9], const double b[3], double mu, const double p[3])
{
    long double v[3];
    long double size = 0.0L;
    long double bound = 0.0L;
    residual_velocity(w, b, p, v);
    for (int i = 0; i < 3; i++) {
        long double row = 0.0L;
        for (int k = 0; k < 3; k++) {
            row += (long double)fabs(w[3 * i + k] * p[k]);
        }
        bound += row * row;
        size += (long double)(b[i] * b[i]);
    }
    const long double diagonal = (long double)fmax(w[0], fmax(w[4], w[8]));
    const long double scale = (sqrtl(size) + sqrtl(bound)) / diagonal;
    const long double rho = 1.0L / (diagonal * fmaxl(1.0L, (long double)mu));
    const long double m = (long double)mu;
    long double x[3];
    for (int i = 0; i < 3; i++) {
        x[i] = (long double)p[i] - rho * v[i];
    }
    x[0] -= rho * m * hypotl(v[1], v[2]);
    /* projection onto the cone */
    const long double t = hypotl(x[1], x[2]);
    long double y[3] = {x[0], x[1], x[2]};
    if (t > m * x[0]) {
        const long double normal = fmaxl(0.0L, (x[0] + m * t) / (1.0L + m * m));
        y[0] = normal;
        y[1] = t > 0.0L ? m * normal * x[1] / t : 0.0L;
        y[2] = t > 0.0L ? m * normal * x[2] / t : 0.0L;
    }
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        square += ((long double)p[i] - y[i]) * ((long double)p[i] - y[i]);
    }
    return (double)(sqrtl(square) / scale);
}

/* Symmetric positive definite plus skew: a solution always exists. */
static void test_unsymmetric_matrices(void **state)
{
    size_t modes[3] = {0, 0, 0};
    (void)state;
    for (uint64_t i = 0; i < 20000; i++) {
        problem_local problem;
        problem_random random;
        double w[9];
        double p[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        problem_draw(i % 2 ? PROBLEM_P1 : PROBLEM_P2, 5, i, &problem);
        problem_random_start(&random, 30, 5, i);
        full_matrix(problem.w, w);
        /* as implicit gyroscopic terms: up to as large as W itself */
        const double size = w[0] * problem_random_decades(&random, -6.0, 0.0);
        for (int k = 0; k < 3; k++) {
            const int r = k == 2 ? 1 : 0;
            const int c = k == 0 ? 1 : 2;
            const double skew = size * problem_random_uniform(&random, -1.0, 1.0);
            w[3 * r + c] += skew;
            w[3 * c + r] -= skew;
        }
        const double mu = problem.mu;
        assert_int_equal(tribo_contact_solve_general(w, problem.b, mu, mu, p, &info), TRIBO_OK);
        within(general_eta(w, problem.b, mu, p), 1e-12);
        assert_true(info.mode <= SLIP);
        modes[info.mode]++;
        long double v[3];
        residual_velocity(w, problem.b, p, v);
        const double vs = tribo_vec3_norm(problem.b);
        if (info.mode == STICK) {
            within((double)hypotl(v[1], v[2]), 1e-12 * vs);
        } else if (info.mode == SLIP) {
            within((double)hypotl(v[1] + (long double)(info.nu * p[1]),
                                  v[2] + (long double)(info.nu * p[2])),
                   1e-12 * vs);
            assert_true(info.nu > 0.0 || mu == 0.0);
        }
        if (info.mode != OPEN) {
            within((double)fabsl(v[0]), 1e-12 * vs);
            within(fmax(0.0, hypot(p[1], p[2]) - mu * p[0]), 8 * EPS * mu * p[0]);
        } else {
            assert_true(problem.b[0] >= 0.0 && p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0);
        }
    }
    settle("unsymmetric W: eta and each condition, 1e-12; cone 8 eps");
    assert_true(modes[OPEN] > 500 && modes[STICK] > 500 && modes[SLIP] > 500);
}

/* Graded W: what friction has to stop is nine decades easier to move along one tangent. */
static void test_graded_general_matrix(void **state)
{
    static const double w[9] = {0x1.796cp+1,      0x1.796cp-51, 0, -0x1.796cp-51,
                                0x1.80000002p+31, -0x1.a4p+30,  0, -0x1.a4p+30,
                                0x1.cb600008p+29};
    static const double b[3] = {-0x1.796cp+1, -0x1.80c0000201p+30, 0x1.a4d2p+29};
    const double mu_d = 0.5 * 0x1.c4p-1;
    double p[3];
    tribo_solve_info info = {.struct_size = sizeof info};
    (void)state;
    assert_int_equal(tribo_contact_solve_general(w, b, 0.5, mu_d, p, &info), TRIBO_OK);
    assert_int_equal(info.mode, SLIP);
    within(general_eta(w, b, mu_d, p), 1e-15);
    within(fabs(hypot(p[1], p[2]) - mu_d * p[0]), 8 * EPS * mu_d);
    settle("graded W that is not symmetric: eta 1e-15, cone 8 eps");
}

/* S of any condition up to 1e11, turned, beside a W_nn as small; b from a p within the cone. */
static void test_stiff_general_matrices(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 38, 0, 0);
    for (int i = 0; i < 20000; i++) {
        const double soft = problem_random_decades(&random, -11.0, 0.0);
        double e[2];
        double p[3] = {1, 0, 0};
        problem_random_direction(&random, 2, e);
        problem_random_direction(&random, 2, p + 1);
        p[1] *= 0.5;
        p[2] *= 0.5;
        const double skew = soft * problem_random_normal(&random);
        const double w[9] = {soft,
                             skew,
                             0,
                             -skew,
                             e[0] * e[0] + soft * e[1] * e[1],
                             (1 - soft) * e[0] * e[1],
                             0,
                             (1 - soft) * e[0] * e[1],
                             e[1] * e[1] + soft * e[0] * e[0]};
        double b[3];
        double found[3];
        long double v[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        tribo_mat3_apply(w, p, b);
        tribo_vec3_scale(-1.0, b, b);
        if (b[0] < 0.0) {
            assert_int_equal(tribo_contact_solve_general(w, b, 0.6, 0.6, found, &info), TRIBO_OK);
            assert_int_equal(info.mode, STICK);
            residual_velocity(w, b, found, v);
            within((double)hypotl(v[1], v[2]), 8 * EPS); /* |W| |p| = 1 */
        }
    }
    settle("stiff S: sliding that sticking leaves, 8 eps");
}

/* S of rank 1 though W is not symmetric: the shortest friction that stops all sliding; and what
 * slides where nothing resists it. */
static void test_singular_general_matrices(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 39, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double e[2];
        double p[3] = {1, 0, 0};
        problem_random_direction(&random, 2, e);
        const double share = problem_random_uniform(&random, -0.5, 0.5);
        const double w1 = problem_random_uniform(&random, -0.5, 0.5);
        const double w2 = problem_random_uniform(&random, -0.5, 0.5);
        const double skew = problem_random_uniform(&random, -0.5, 0.5);
        const double row[2] = {w1 + skew, w2};
        const double column[2] = {w1 - skew, w2};
        const double w[9] = {1,
                             row[0],
                             row[1],
                             column[0],
                             e[0] * e[0] + column[0] * row[0],
                             e[0] * e[1] + column[0] * row[1],
                             column[1],
                             e[0] * e[1] + column[1] * row[0],
                             e[1] * e[1] + column[1] * row[1]};
        double b[3];
        double found[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        p[1] = share * e[0];
        p[2] = share * e[1];
        tribo_mat3_apply(w, p, b);
        tribo_vec3_scale(-1.0, b, b);
        if (b[0] < 0.0) {
            assert_int_equal(tribo_contact_solve_general(w, b, 0.6, 0.6, found, &info), TRIBO_OK);
            assert_int_equal(info.mode, STICK);
            within(distance(found, p, 3), 64 * EPS);
            /* a push along the direction that S annuls */
            b[1] += 0.01 * e[1];
            b[2] -= 0.01 * e[0];
            assert_int_equal(tribo_contact_solve_general(w, b, 0.6, 0.6, found, &info), TRIBO_OK);
            assert_int_equal(info.mode, SLIP);
            within(general_eta(w, b, 0.6, found), 1e-13);
        }
    }
    settle("singular S: the shortest friction 64 eps, slip eta 1e-13");
}

/* Whatever the sizes of the entries and however S cancels: what is called a solution has the
 * velocities of one. */
static void test_wild_general_matrices(void **state)
{
    problem_random random;
    unsigned solved = 0;
    (void)state;
    problem_random_start(&random, 40, 0, 0);
    for (int i = 0; i < 100000; i++) {
        double w[9];
        double b[3];
        double p[3];
        long double v[3];
        tribo_solve_info info = {.struct_size = sizeof info};
        const double decades = 5.0 * (i % 4);
        w[0] = problem_random_decades(&random, -6, 6);
        for (int k = 0; k < 2; k++) {
            const double s[2] = {problem_random_decades(&random, -6, 6),
                                 problem_random_decades(&random, -6, 6)};
            w[1 + k] =
                problem_random_normal(&random) * problem_random_decades(&random, -decades, decades);
            w[3 + 3 * k] =
                problem_random_normal(&random) * problem_random_decades(&random, -decades, decades);
            w[4 + 4 * k] = s[0];
            w[k == 0 ? 5 : 7] = 0.5 * s[1] * problem_random_normal(&random);
        }
        for (int k = 0; k < 3; k++) {
            b[k] = problem_random_normal(&random) * problem_random_decades(&random, -10, 10);
        }
        for (int k = 0; k < 4; k++) {
            const int row = 1 + k / 2;
            w[3 * row + 1 + k % 2] += w[3 * row] * w[1 + k % 2] / w[0];
        }
        b[0] = -fabs(b[0]);
        const double mu = problem_random_decades(&random, -15, 15);
        if (tribo_contact_solve_general(w, b, mu, mu, p, &info) != TRIBO_OK) {
            continue;
        }
        double scale = fabs(b[0]) + fabs(b[1]) + fabs(b[2]);
        for (int k = 0; k < 9; k++) {
            scale += fabs(w[k] * p[k % 3]);
        }
        residual_velocity(w, b, p, v);
        within((double)fabsl(v[0]), 1.01e-9 * scale);
        within((double)fabsl(v[1] + (long double)info.nu * (long double)p[1]), 1.01e-9 * scale);
        within((double)fabsl(v[2] + (long double)info.nu * (long double)p[2]), 1.01e-9 * scale);
        solved++;
    }
    settle("wild W: velocities of what is called a solution, 1e-9");
    assert_true(solved > 20000);
}

/* On symmetric ones both solvers find the same. */
static void test_both_solvers_agree(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 20000; i++) {
        problem_local problem;
        double w[9];
        double p[3];
        double q[3];
        tribo_solve_info one = {.struct_size = sizeof one};
        tribo_solve_info two = {.struct_size = sizeof two};
        problem_draw(PROBLEM_P1, 6, i, &problem);
        full_matrix(problem.w, w);
        /* below 0.8819 uniform boxes have one solution only */
        const double mu = fmin(problem.mu, 0.88);
        assert_int_equal(tribo_contact_solve(problem.w, problem.b, mu, 0.9 * mu, p, &one),
                         TRIBO_OK);
        assert_int_equal(tribo_contact_solve_general(w, problem.b, mu, 0.9 * mu, q, &two),
                         TRIBO_OK);
        assert_int_equal(one.mode, two.mode);
        within(distance(p, q, 3), 64.0 * EPS * 7.0 * tribo_vec3_norm(p));
    }
    settle("both solvers, 64 eps cond");
}

/* An output may be the same array as an input. */
static void test_outputs_in_place_of_inputs(void **state)
{
    static const double n[3] = {0.6, 0, 0.8};
    static const double f[3] = {1, 2, -30};
    const tribo_material pair = {0.1, 0.05, 0.5};
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const double mu = fixtures[i].mu;
        double full[9];
        double p[3];
        double shared[9];
        full_matrix(fixtures[i].w, full);
        for (int how = 0; how < 4; how++) {
            const double *w = how < 2 ? fixtures[i].w : full;
            /* the impulse over b, or over the first entries of W */
            double *b = how % 2 ? (double[3]){fixtures[i].b[0], fixtures[i].b[1], fixtures[i].b[2]}
                                : shared;
            const double *matrix = how % 2 ? shared : w;
            memcpy(shared, how % 2 ? w : fixtures[i].b,
                   (how % 2 ? how < 2 ? 6 : 9 : 3) * sizeof *w);
            if (how < 2) {
                assert_int_equal(tribo_contact_solve(w, fixtures[i].b, mu, mu, p, NULL), TRIBO_OK);
                assert_int_equal(tribo_contact_solve(matrix, b, mu, mu, shared, NULL), TRIBO_OK);
            } else {
                assert_int_equal(tribo_contact_solve_general(w, fixtures[i].b, mu, mu, p, NULL),
                                 TRIBO_OK);
                assert_int_equal(tribo_contact_solve_general(matrix, b, mu, mu, shared, NULL),
                                 TRIBO_OK);
            }
            assert_true(same_bits(p, shared, 3));
        }
        for (uint32_t law = 0; law <= TRIBO_LAW_LECTURE_CLOSING; law++) {
            const tribo_impact_options options = {sizeof options, law, 0.0};
            memcpy(shared, fixtures[i].b, sizeof p);
            assert_int_equal(tribo_impact(fixtures[i].w, shared, &pair, &options, p, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_impact(fixtures[i].w, shared, &pair, &options, shared, NULL),
                             TRIBO_OK);
            assert_true(same_bits(p, shared, 3));
        }
    }
    for (int how = 0; how < 6; how++) {
        double expected[3];
        double force[3] = {f[0], f[1], f[2]};
        double normal[3] = {n[0], n[1], n[2]};
        double *result = how % 2 ? normal : force;
        tribo_status (*const function)(const double *, const double *, double *) =
            how < 2 ? tribo_friction_reaction : tribo_friction_planar;
        if (how < 4) {
            assert_int_equal(function(f, n, expected), TRIBO_OK);
            assert_int_equal(function(force, normal, result), TRIBO_OK);
        } else {
            assert_int_equal(tribo_friction_force(f, n, &pair, expected, NULL), TRIBO_OK);
            assert_int_equal(tribo_friction_force(force, normal, &pair, result, NULL), TRIBO_OK);
        }
        assert_true(same_bits(expected, result, 3));
    }
}

/* ---- exact solve: infos and bad input -------------------------------------------------------- */

/* An older caller's info is filled as far as it goes. */
static void test_older_solve_info(void **state)
{
    static const uint32_t sizes[] = {4, 8, 12, 16, sizeof(tribo_solve_info)};
    static const double w[6] = BALL;
    static const double b[3] = {-1.5, 3, -4};
    double full[9];
    (void)state;
    full_matrix(w, full);
    for (int general = 0; general < 2; general++) {
        tribo_solve_info newest = {.struct_size = sizeof newest};
        double p[3];
        assert_int_equal(general ? tribo_contact_solve_general(full, b, 0.5, 0.5, p, &newest)
                                 : tribo_contact_solve(w, b, 0.5, 0.5, p, &newest),
                         TRIBO_OK);
        assert_int_equal(newest.struct_size, sizeof newest);
        assert_int_equal(newest.mode, SLIP);
        assert_true(newest.iterations > 0);
        assert_int_equal(newest.reserved, 0);
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            unsigned char expected[sizeof newest];
            tribo_solve_info info;
            memset(&info, 0xa5, sizeof info);
            memset(expected, 0xa5, sizeof expected);
            memcpy(expected, &newest, sizes[i]);
            memcpy(expected, &sizes[i], sizeof sizes[i]);
            info.struct_size = sizes[i];
            assert_int_equal(general ? tribo_contact_solve_general(full, b, 0.5, 0.5, p, &info)
                                     : tribo_contact_solve(w, b, 0.5, 0.5, p, &info),
                             TRIBO_OK);
            assert_memory_equal(&info, expected, sizeof info);
        }
    }
}

/* Outputs of refused calls. */
static struct {
    double p[9];
    tribo_solve_info info;
    tribo_contact contact;
    uint32_t mode;
} out, before;

static void canary(void)
{
    memset(&out, 0xa5, sizeof out);
    out.info.struct_size = sizeof out.info;
}

/* A refused call gives the status and leaves `out` as it was. */
#define REFUSED(expected, call) ASSERT_REFUSED(out, before, expected, call)

static const struct {
    double w[6];
    double b[3];
    double mu_s;
    double mu_d;
    tribo_status status;
    int general; /* 1: the general solve answers the same */
} bad_problems[] = {
    {BALL, {-1, 0, 0}, -0.1, -0.2, TRIBO_ERROR_FRICTION, 1},
    {BALL, {-1, 0, 0}, 0.1, -5e-324, TRIBO_ERROR_FRICTION, 1},
    {BALL, {-1, 0, 0}, 0.1, 0.2, TRIBO_ERROR_FRICTION, 1},
    {BALL, {1, 0, 0}, 0.1, 0.2, TRIBO_ERROR_FRICTION, 1}, /* judged even where nothing touches */
    {{0, 0, 0, 0, 0, 0}, {-1, 0, 0}, 0.5, 0.5, TRIBO_ERROR_IMMOVABLE, 1},
    {{0, 0, 0, 0, 0, 0}, {1, 0, 0}, 0.5, 0.5, TRIBO_ERROR_IMMOVABLE, 1},
    {{0, 0, 0, 1, 0, 1}, {-1, 0, 0}, 0.5, 0.5, TRIBO_ERROR_IMMOVABLE, 1},
    {{-1, 0, 0, 1, 0, 1}, {-1, 0, 0}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{-1, 0, 0, 1, 0, 1}, {1, 0, 0}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, 0, 0, -1, 0, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, 0, 0, 1, 0, -1e-3}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, 2, 0, 1, 0, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, 0, 0, 1, 1.001, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, -0.6, -0.6, 1, -0.6, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{1, -0.5 - 1e-11, -0.5 - 1e-11, 1, -0.5 - 1e-11, 1},
     {-1, 1, 1},
     0.5,
     0.5,
     TRIBO_ERROR_CONTACT_MATRIX,
     1},
    {{1, 1 + 1e-11, 0, 1, 0, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_CONTACT_MATRIX, 1},
    {{0x1p1001, 0, 0, 1, 0, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_RANGE, 1},
    {{1, 0, 0, 0x1.8p1000, 0, 1}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_RANGE, 1},
    {{0x1p-1001, 0, 0, 0x1p-1001, 0, 0}, {-1, 1, 1}, 0.5, 0.5, TRIBO_ERROR_RANGE, 1},
    {BALL, {-0x1p1001, 1, 1}, 0.5, 0.5, TRIBO_ERROR_RANGE, 1},
    {BALL, {-1, 1, DBL_MAX}, 0.5, 0.5, TRIBO_ERROR_RANGE, 1},
    {{0x1p-900, 0, 0, 0x1p-900, 0, 0x1p-900}, {-0x1p200, 0, 0}, 0, 0, TRIBO_ERROR_RANGE, 1},
    {{0.5, 0.5, 0, 0.5, 0, 1}, {-1, -0.3, 0}, 1.5, 1.5, TRIBO_ERROR_JAM, 1},
};

enum { BAD_PROBLEMS = sizeof bad_problems / sizeof bad_problems[0] };

static void test_bad_problems(void **state)
{
    (void)state;
    for (size_t i = 0; i < BAD_PROBLEMS; i++) {
        const double *b = bad_problems[i].b;
        const double mu_s = bad_problems[i].mu_s;
        const double mu_d = bad_problems[i].mu_d;
        const tribo_status status = bad_problems[i].status;
        double full[9];
        canary();
        full_matrix(bad_problems[i].w, full);
        REFUSED(status, tribo_contact_solve(bad_problems[i].w, b, mu_s, mu_d, out.p, &out.info));
        if (bad_problems[i].general) {
            REFUSED(status, tribo_contact_solve_general(full, b, mu_s, mu_d, out.p, &out.info));
        }
    }
    for (int i = 0; i < 14 * 3; i++) {
        const double value = not_finite[i % 3];
        double x[14] = {1, 0, 0, 0, 3.5, 0, 0, 0, 3.5, -1, 1, 1, 0.5, 0.5};
        x[i / 3] = value;
        canary();
        REFUSED(TRIBO_ERROR_NOT_FINITE,
                tribo_contact_solve_general(x, x + 9, x[12], x[13], out.p, &out.info));
    }
    for (int i = 0; i < 11 * 3; i++) {
        const double value = not_finite[i % 3];
        double x[11] = {1, 0, 0, 3.5, 0, 3.5, -1, 1, 1, 0.5, 0.5};
        x[i / 3] = value;
        canary();
        REFUSED(TRIBO_ERROR_NOT_FINITE,
                tribo_contact_solve(x, x + 6, x[9], x[10], out.p, &out.info));
    }
}

static void test_bad_solve_calls(void **state)
{
    const uint32_t newer = sizeof(tribo_solve_info) + 8;
    const uint32_t sizes[] = {0, 1, 2, 3, 5, 17, 23, newer - 7, newer, UINT32_MAX};
    static const double w[6] = BALL;
    static const double b[3] = {-1, 1, 1};
    const double bad[3] = {NOT_A_NUMBER, 1, 1};
    double full[9];
    (void)state;
    full_matrix(w, full);
    canary();
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve(NULL, b, 1, 1, out.p, &out.info));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve(w, NULL, 1, 1, out.p, &out.info));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve(w, b, 1, 1, NULL, &out.info));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve_general(NULL, b, 1, 1, out.p, &out.info));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve_general(full, NULL, 1, 1, out.p, &out.info));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve_general(full, b, 1, 1, NULL, &out.info));
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        out.info.struct_size = sizes[i];
        REFUSED(TRIBO_ERROR_STRUCT_SIZE, tribo_contact_solve(w, bad, 1, 1, out.p, &out.info));
        REFUSED(TRIBO_ERROR_STRUCT_SIZE,
                tribo_contact_solve_general(full, bad, 1, 1, out.p, &out.info));
        REFUSED(TRIBO_ERROR_NULL, tribo_contact_solve(NULL, b, 1, 1, out.p, &out.info));
    }
}

/* ---- friction cone --------------------------------------------------------------------------- */

static void test_cone_contains(void **state)
{
    static const struct {
        double p[3];
        double mu;
        double tolerance;
        uint32_t inside;
    } rows[] = {
        {{0, 0, 0}, 0, 0, 1},
        {{1, 0, 0}, 0, 0, 1},
        {{1, 5e-324, 0}, 0, 0, 0},
        {{-5e-324, 0, 0}, 1, 0, 0},
        {{-1, 0, 0}, 1e300, 0, 0},
        {{2, 0.6, 0.8}, 0.5, 0, 1},
        {{2, 0.6, 0.8}, 0.4999999, 0, 0},
        {{2, 0.6, 0.8}, 0.49999999, 1e-7, 1},
        {{0, 1e-300, 0}, 1e300, 0, 0},
        {{5, 30, -40}, 10, 0, 1},
        {{5, 30, -40.0000001}, 10, 0, 0},
        {{1e300, 3e300, 4e300}, 5.0000001, 0, 1},
        {{1e300, 3e300, 4e300}, 4.9999999, 0, 0},
        {{1e-300, 3e-300, 4e-300}, 5.0000001, 0, 1},
        {{1e-300, 3e-300, 4e-300}, 4.9999999, 0, 0},
        {{1e300, 1e308, 1e308}, 1e300, 0, 1},
        {{DBL_MAX, DBL_MAX, DBL_MAX}, 1.125, 0, 0}, /* neither side of the cone is a double */
        {{DBL_MAX, DBL_MAX, DBL_MAX}, 1.5, 0, 1},
        {{DBL_MAX, 1, 0}, 0, 0, 0},
        {{DBL_MAX, 5e-324, 0}, 5e-324, 0, 1},
        {{5e-324, DBL_MAX, DBL_MAX}, DBL_MAX, 0, 0},
        {{1, 5e-324, 0}, 5e-324, 0, 1},
        {{0.6, 5e-324, 0}, 5e-324, 0, 0}, /* mu p_n would round to 5e-324 */
        {{1, DBL_MAX, 0}, 1, DBL_MAX, 1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (tribo_cone_contains(rows[i].p, rows[i].mu, rows[i].tolerance) != rows[i].inside) {
            fail_msg("row %d", (int)i);
        }
    }
}

static void test_cone_closed_forms(void **state)
{
    static const struct {
        double x[3];
        double mu;
        double onto[3]; /* nearest point of K */
        double dual[3]; /* nearest point of K* */
        double clamped[3];
    } rows[] = {
        {{2, 0.6, 0.8}, 0.5, {2, 0.6, 0.8}, {2, 0.6, 0.8}, {2, 0.6, 0.8}},
        {{2, 3, 4}, 0.5, {3.6, 1.08, 1.44}, {2.4, 2.88, 3.84}, {2, 0.6, 0.8}},
        {{-2, 3, 4}, 0.5, {0.4, 0.12, 0.16}, {1.6, 1.92, 2.56}, {0, 0, 0}},
        {{-2.5, 3, 4}, 0.5, {0, 0, 0}, {1.5, 1.8, 2.4}, {0, 0, 0}},
        {{-11, 3, 4}, 0.5, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
        {{-1, 0, 0}, 0.5, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
        {{0, 3, 4}, 1, {2.5, 1.5, 2}, {2.5, 1.5, 2}, {0, 0, 0}},
        {{7, 3, 4}, 0, {7, 0, 0}, {7, 3, 4}, {7, 0, 0}},
        {{-7, 3, 4}, 0, {0, 0, 0}, {0, 3, 4}, {0, 0, 0}},
        {{0, 3, 4}, 2, {2, 2.4, 3.2}, {2, 0.6, 0.8}, {0, 0, 0}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double size = tribo_vec3_norm(rows[i].x);
        double y[3];
        assert_int_equal(tribo_cone_project(rows[i].x, rows[i].mu, y), TRIBO_OK);
        within(distance(y, rows[i].onto, 3), 8 * EPS * size);
        assert_int_equal(tribo_cone_project_dual(rows[i].x, rows[i].mu, y), TRIBO_OK);
        within(distance(y, rows[i].dual, 3), 8 * EPS * size);
        assert_int_equal(tribo_cone_clamp(rows[i].x, rows[i].mu, y), TRIBO_OK);
        within(distance(y, rows[i].clamped, 3), 8 * EPS * size);
    }
    settle("projections and clamp by hand, 8 eps");
}

/* Where |p_t| or mu p_n or both are beyond double. */
static void test_clamp_beyond_double(void **state)
{
    static const struct {
        double x[3];
        double mu;
        double planar[2];
    } rows[] = {
        {{DBL_MAX, DBL_MAX, DBL_MAX}, 1.125, {0.79549512883486595, 0.79549512883486595}},
        {{DBL_MAX, DBL_MAX, -DBL_MAX}, 1.5, {1, -1}},
        {{DBL_MAX, DBL_MAX, DBL_MAX}, 1.0, {0.70710678118654752, 0.70710678118654752}},
        {{1, DBL_MAX, DBL_MAX}, DBL_MAX, {0.70710678118654752, 0.70710678118654752}},
        {{DBL_MAX / 2, -DBL_MAX, 0}, 1.75, {-0.875, 0}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        double y[3];
        assert_int_equal(tribo_cone_clamp(rows[i].x, rows[i].mu, y), TRIBO_OK);
        assert_true(y[0] == rows[i].x[0]);
        for (int k = 0; k < 2; k++) {
            within(fabs(y[1 + k] / DBL_MAX - rows[i].planar[k]), 2 * EPS);
        }
        assert_true(tribo_cone_contains(y, rows[i].mu, 4 * EPS));
    }
    settle("clamp beyond double, 2 eps");
}

static void draw_cone_point(problem_random *random, double x[3], double *mu)
{
    for (int i = 0; i < 3; i++) {
        x[i] = problem_random_normal(random) * problem_random_decades(random, -3.0, 0.0);
    }
    *mu = problem_random_bits(random) % 4 ? problem_random_uniform(random, 0.0, 2.0)
                                          : problem_random_decades(random, -12.0, 12.0);
    *mu = problem_random_bits(random) % 16 ? *mu : 0.0;
}

static void test_cone_projection_properties(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 31, 0, 0);
    for (int i = 0; i < 100000; i++) {
        double x[3];
        double other[3];
        double mu;
        double k[3];
        double k2[3];
        double minus[3];
        double polar[3];
        draw_cone_point(&random, other, &mu);
        draw_cone_point(&random, x, &mu);
        const double size = tribo_vec3_norm(x);
        assert_int_equal(tribo_cone_project(x, mu, k), TRIBO_OK);
        assert_true(tribo_cone_contains(k, mu, 8 * EPS));
        /* idempotent */
        assert_int_equal(tribo_cone_project(k, mu, k2), TRIBO_OK);
        within(distance(k, k2, 3), 8 * EPS * size);
        /* Moreau: x = P_K(x) - P_K*(-x), the two at right angles */
        tribo_vec3_scale(-1.0, x, minus);
        assert_int_equal(tribo_cone_project_dual(minus, mu, polar), TRIBO_OK);
        double sum[3];
        tribo_vec3_subtract(k, polar, sum);
        within(distance(sum, x, 3), 8 * EPS * size);
        within(fabs(tribo_vec3_dot(k, polar)), 8 * EPS * size * size);
        within(mu * hypot(polar[1], polar[2]) - polar[0], 8 * EPS * (1.0 + mu) * size);
        /* no expansion */
        assert_int_equal(tribo_cone_project(other, mu, k2), TRIBO_OK);
        within(distance(k, k2, 3) - distance(x, other, 3),
               8 * EPS * (size + tribo_vec3_norm(other)));
        /* in place, and to the bit under powers of two */
        const int e = (int)(problem_random_bits(&random) % 1800) - 900;
        for (int n = 0; n < 3; n++) {
            double scaled[3];
            double plain[3];
            for (int l = 0; l < 3; l++) {
                scaled[l] = ldexp(x[l], e);
            }
            assert_int_equal(n == 0   ? tribo_cone_project(scaled, mu, scaled)
                             : n == 1 ? tribo_cone_project_dual(scaled, mu, scaled)
                                      : tribo_cone_clamp(scaled, mu, scaled),
                             TRIBO_OK);
            assert_int_equal(n == 0   ? tribo_cone_project(x, mu, plain)
                             : n == 1 ? tribo_cone_project_dual(x, mu, plain)
                                      : tribo_cone_clamp(x, mu, plain),
                             TRIBO_OK);
            for (int l = 0; l < 3; l++) {
                assert_true(scaled[l] == ldexp(plain[l], e) || fabs(scaled[l]) < DBL_MIN);
            }
        }
        /* turning about n */
        const double angle = problem_random_uniform(&random, 0.0, 6.28);
        const double c = cos(angle);
        const double s = sin(angle);
        const double turned[3] = {x[0], c * x[1] - s * x[2], s * x[1] + c * x[2]};
        const double expected[3] = {k[0], c * k[1] - s * k[2], s * k[1] + c * k[2]};
        assert_int_equal(tribo_cone_project(turned, mu, k2), TRIBO_OK);
        within(distance(k2, expected, 3), 8 * EPS * size);
        /* clamp */
        assert_int_equal(tribo_cone_clamp(x, mu, k2), TRIBO_OK);
        assert_true(k2[0] == fmax(x[0], 0.0) && tribo_cone_contains(k2, mu, 4 * EPS));
    }
    settle("projections, 8 eps");
}

static void test_cone_at_the_ends_of_the_range(void **state)
{
    /* up to where the norm, and so the projection, is still a double */
    static const double sizes[] = {5e-324, 1e-310, 1e-160, 1.0, 1e160, 1e300, 1e308};
    static const double mus[] = {0.0, 5e-324, 1e-300, 1e-19, 1.0, 1e19, 1e300, 4e307};
    (void)state;
    for (size_t a = 0; a < 7 * 7 * 7 * 8; a++) {
        const double mu = mus[a % 8];
        for (int signs = 0; signs < 8; signs++) {
            const double x[3] = {(signs & 1 ? -1 : 1) * sizes[a / 8 % 7],
                                 (signs & 2 ? -1 : 1) * sizes[a / 56 % 7],
                                 (signs & 4 ? -1 : 1) * sizes[a / 392]};
            double y[3];
            assert_int_equal(tribo_cone_project(x, mu, y), TRIBO_OK);
            assert_true(isfinite(y[0]) && isfinite(y[1]) && isfinite(y[2]));
            const double size = tribo_vec3_norm(x);
            within(hypot(y[1], y[2]) - mu * y[0], 8 * EPS * size + (1.0 + mu) * 1e-323);
            assert_int_equal(tribo_cone_clamp(x, mu, y), TRIBO_OK);
            assert_true(isfinite(y[0]) && isfinite(y[1]) && isfinite(y[2]));
            assert_int_equal(tribo_cone_project_dual(x, mu, y), TRIBO_OK);
            assert_true(isfinite(y[0]) && isfinite(y[1]) && isfinite(y[2]));
        }
    }
    settle("excess over the cone at the ends of the range, 8 eps");
}

static void test_bad_cones(void **state)
{
    const double p[3] = {1, 2, 3};
    tribo_status (*const functions[3])(const double *, double, double *) = {
        tribo_cone_project, tribo_cone_project_dual, tribo_cone_clamp};
    (void)state;
    canary();
    /* their nearest points are 1.2 times as large */
    static const double huge[3] = {DBL_MAX, DBL_MAX, DBL_MAX};
    REFUSED(TRIBO_ERROR_RANGE, tribo_cone_project(huge, 1.0, out.p));
    REFUSED(TRIBO_ERROR_RANGE, tribo_cone_project_dual(huge, 1.0, out.p));
    for (int n = 0; n < 3; n++) {
        REFUSED(TRIBO_ERROR_NULL, functions[n](NULL, 0.5, out.p));
        REFUSED(TRIBO_ERROR_NULL, functions[n](p, 0.5, NULL));
        REFUSED(TRIBO_ERROR_FRICTION, functions[n](p, -5e-324, out.p));
        REFUSED(TRIBO_ERROR_FRICTION, functions[n](p, -1.0, out.p));
        for (int i = 0; i < 9; i++) {
            double x[3] = {1, 2, 3};
            x[i / 3] = not_finite[i % 3];
            REFUSED(TRIBO_ERROR_NOT_FINITE, functions[n](x, 0.5, out.p));
            REFUSED(TRIBO_ERROR_NOT_FINITE, functions[n](p, not_finite[i % 3], out.p));
        }
    }
}

/* ---- geometry and contact matrix ------------------------------------------------------------- */

static tribo_contact contact_with_arm(double x, double y, double z)
{
    const tribo_contact contact = {{0, 0, 1}, {x, y, z}, {0, 0, 0}};
    return contact;
}

/* Solid ball 7/2, hollow ball 5/2, cylinder 3, hoop 2: 1 + m R^2 / I, over the mass. */
static void test_matrix_of_round_bodies(void **state)
{
    static const double factors[4][2] = {{0.4, 3.5}, {2.0 / 3.0, 2.5}, {0.5, 3.0}, {1.0, 2.0}};
    (void)state;
    for (int i = 0; i < 4; i++) {
        const double m = 2.0;
        const double r = 0.5;
        const double inertia = factors[i][0] * m * r * r;
        const tribo_body body = body_of(m, inertia, inertia, inertia);
        const tribo_contact contact = contact_with_arm(0, 0, -r);
        const double expected[6] = {1 / m, 0, 0, factors[i][1] / m, 0, factors[i][1] / m};
        double w[6];
        assert_int_equal(tribo_contact_matrix(&body, NULL, &contact, axes, w), TRIBO_OK);
        within(distance(w, expected, 6), 16 * EPS * factors[i][1] / m);
        assert_true(w[1] == 0.0 && w[2] == 0.0 && w[4] == 0.0);
    }
    settle("balls, cylinder, hoop, 16 eps");
}

/* Slender rods that turn about y only. 45 degrees: (5/2, 3/2, 5/2). tan = 2, Painleve's paradox at
 * the least mu, 4/3: (8/5, 6/5, 17/5). */
static void test_matrix_of_rods(void **state)
{
    const double a = 0.5 * sqrt(0.5);
    const double c = 0.5 / sqrt(5.0);
    const double arms[2][2] = {{a, -a}, {c, -2.0 * c}};
    static const double expected[2][6] = {{2.5, 1.5, 0, 2.5, 0, 1}, {1.6, 1.2, 0, 3.4, 0, 1}};
    (void)state;
    for (int i = 0; i < 2; i++) {
        tribo_body rod = body_of(1, 1, 1.0 / 12.0, 1);
        rod.inverse_inertia[0] = rod.inverse_inertia[5] = 0.0;
        const tribo_contact contact = contact_with_arm(arms[i][0], 0, arms[i][1]);
        double w[6];
        assert_int_equal(tribo_contact_matrix(&rod, NULL, &contact, axes, w), TRIBO_OK);
        within(distance(w, expected[i], 6), 16 * EPS * 4.0);
        assert_true(w[2] == 0.0 && w[4] == 0.0);
    }
    settle("rods, 16 eps");
}

/* q of Rz(.3) Rx(.7) Rz(.2). */
static void oblique(double q[4])
{
    double step[4];
    assert_int_equal(tribo_quat_from_rotation_vector((const double[3]){0, 0, 0.3}, q), TRIBO_OK);
    assert_int_equal(tribo_quat_from_rotation_vector((const double[3]){0.7, 0, 0}, step), TRIBO_OK);
    tribo_quat_multiply(q, step, q);
    assert_int_equal(tribo_quat_from_rotation_vector((const double[3]){0, 0, 0.2}, step), TRIBO_OK);
    tribo_quat_multiply(q, step, q);
}

/* Box of half-extents .5 .3 .2, 1 kg, on its lowest corner; all couplings differ from zero. */
static void test_matrix_of_the_oblique_box(void **state)
{
    static const double expected[6] = {3.241254041781604,  -1.1323130861265038, -1.7244589474978635,
                                       3.4944156067613887, -1.5051045068439446, 5.264330351457007};
    static const double lowest[3] = {-0.3603752304, -0.2915295820, -0.4063744531};
    static const double before_impact[3] = {-1.7853895607, -0.2809631992, 0.7843129177};
    static const double v[3] = {1, -0.5, -2};
    static const double omega[3] = {0.5, 1, -3};
    static const double signs[2] = {-1, 1};
    double least = 0.0;
    double inertia[9];
    double mass;
    tribo_body box;
    tribo_contact contact = contact_with_arm(0, 0, 0);
    (void)state;
    tribo_body_init(&box);
    assert_int_equal(tribo_mass_box(1 / 0.24, (const double[3]){0.5, 0.3, 0.2}, &mass, inertia),
                     TRIBO_OK);
    assert_int_equal(tribo_body_set_mass(&box, mass, inertia), TRIBO_OK);
    oblique(box.orientation);
    memcpy(box.velocity, v, sizeof v);
    memcpy(box.angular_velocity, omega, sizeof omega);
    for (int i = 0; i < 8; i++) {
        const double corner[3] = {0.5 * signs[i & 1], 0.3 * signs[i / 2 & 1], 0.2 * signs[i / 4]};
        double arm[3];
        tribo_quat_rotate(box.orientation, corner, arm);
        if (arm[2] < least) {
            least = arm[2];
            memcpy(contact.arm_a, arm, sizeof arm);
        }
    }
    within(distance(contact.arm_a, lowest, 3), 1e-10);
    double w[6];
    double u[3];
    const double top_inverse = 3.0 / (0.3 * 0.3 + 0.2 * 0.2);
    const double scale = 1.0 + tribo_vec3_dot(lowest, lowest) * top_inverse;
    assert_int_equal(tribo_contact_matrix(&box, NULL, &contact, axes, w), TRIBO_OK);
    for (int i = 0; i < 6; i++) {
        within(fabs(w[i] - expected[i]), 16 * EPS * scale);
    }
    assert_int_equal(tribo_contact_velocity(&box, NULL, &contact, axes, u), TRIBO_OK);
    within(distance(u, before_impact, 3), 1e-10);
    within(fabs(quad_condition(w) - 6.493), 5e-4);
    tribo_totals totals;
    assert_int_equal(tribo_audit_bodies(1, &box, (const double[3]){0, 0, 0}, &totals), TRIBO_OK);
    within(fabs(totals.energy - 3.1798671972), 1e-10);
    settle("oblique box: W 16 eps; corner, u-, T to the digits given");
}

static double matrix_scale(const tribo_body *body, const double arm[3])
{
    const double *v = body->inverse_inertia;
    return body->inverse_mass + tribo_vec3_dot(arm, arm) * (v[0] + v[3] + v[5]);
}

/* W against world-axis skew matrices in quadruple precision, W of a pair as a sum, W as the change
 * of the relative velocity by unit impulses. */
static void test_matrix_of_random_boxes(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 3000; i++) {
        problem_collision c;
        double frame[9];
        double w[6];
        double full[9];
        quad_real truth[6];
        problem_draw_collision(7, i, &c);
        tribo_body *b = c.two_bodies ? &c.b : NULL;
        assert_int_equal(tribo_basis_from_normal(c.contact.normal, frame), TRIBO_OK);
        assert_int_equal(tribo_contact_matrix(&c.a, b, &c.contact, frame, w), TRIBO_OK);
        const double scale =
            matrix_scale(&c.a, c.contact.arm_a) + (b ? matrix_scale(b, c.contact.arm_b) : 0.0);
        quad_matrix(&c.a, b, &c.contact, frame, truth);
        for (int k = 0; k < 6; k++) {
            within(fabs((double)((quad_real)w[k] - truth[k])), 16 * EPS * scale);
        }
        full_matrix(w, full);
        /* columns of W by impulses */
        for (int k = 0; k < 3; k++) {
            const double unit[3] = {k == 0, k == 1, k == 2};
            tribo_body rest_a = c.a;
            tribo_body rest_b = c.b;
            double u[3];
            memset(rest_a.velocity, 0, sizeof rest_a.velocity);
            memset(rest_a.angular_velocity, 0, sizeof rest_a.angular_velocity);
            memset(rest_b.velocity, 0, sizeof rest_b.velocity);
            memset(rest_b.angular_velocity, 0, sizeof rest_b.angular_velocity);
            tribo_body *other = b ? &rest_b : NULL;
            assert_int_equal(tribo_contact_apply(&rest_a, other, &c.contact, frame, unit),
                             TRIBO_OK);
            assert_int_equal(tribo_contact_velocity(&rest_a, other, &c.contact, frame, u),
                             TRIBO_OK);
            within(distance(u, full + 3 * k, 3), 64 * EPS * scale);
        }
        if (b) { /* the sum over both, and the other order */
            double one[6];
            double two[6];
            const tribo_contact of_b = {
                {c.contact.normal[0], c.contact.normal[1], c.contact.normal[2]},
                {c.contact.arm_b[0], c.contact.arm_b[1], c.contact.arm_b[2]},
                {c.contact.arm_a[0], c.contact.arm_a[1], c.contact.arm_a[2]}};
            assert_int_equal(tribo_contact_matrix(&c.a, NULL, &c.contact, frame, one), TRIBO_OK);
            assert_int_equal(tribo_contact_matrix(b, NULL, &of_b, frame, two), TRIBO_OK);
            for (int k = 0; k < 6; k++) {
                within(fabs(w[k] - (one[k] + two[k])), 8 * EPS * scale);
            }
            assert_int_equal(tribo_contact_matrix(b, &c.a, &of_b, frame, two), TRIBO_OK);
            assert_true(same_bits(w, two, 6));
        }
    }
    settle("W against quad precision 16 eps, impulses 64 eps, sums 8 eps");
}

/* An immovable body is the world, to the bit. */
static void test_immovable_bodies(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 500; i++) {
        problem_collision c;
        tribo_body wall;
        double frame[9];
        double w[2][6];
        double u[2][3];
        problem_draw_collision(8, i, &c);
        tribo_body_init(&wall);
        memcpy(wall.position, c.b.position, sizeof wall.position);
        memcpy(wall.orientation, c.b.orientation, sizeof wall.orientation);
        tribo_contact contact;
        assert_int_equal(tribo_contact_at(&c.a, &wall, c.point, c.normal, &contact), TRIBO_OK);
        assert_int_equal(tribo_basis_from_normal(contact.normal, frame), TRIBO_OK);
        assert_int_equal(tribo_contact_matrix(&c.a, NULL, &contact, frame, w[0]), TRIBO_OK);
        assert_int_equal(tribo_contact_matrix(&c.a, &wall, &contact, frame, w[1]), TRIBO_OK);
        assert_true(same_bits(w[0], w[1], 6));
        assert_int_equal(tribo_contact_velocity(&c.a, NULL, &contact, frame, u[0]), TRIBO_OK);
        assert_int_equal(tribo_contact_velocity(&c.a, &wall, &contact, frame, u[1]), TRIBO_OK);
        assert_true(u[0][0] == u[1][0] && u[0][1] == u[1][1] && u[0][2] == u[1][2]);
        tribo_body alone = c.a;
        tribo_body still = wall;
        assert_int_equal(tribo_contact_apply(&c.a, &wall, &contact, frame, u[0]), TRIBO_OK);
        assert_int_equal(tribo_contact_apply(&alone, NULL, &contact, frame, u[0]), TRIBO_OK);
        assert_memory_equal(&c.a, &alone, sizeof alone);
        assert_memory_equal(&wall, &still, sizeof wall);
    }
}

/* Uniform boxes of any shape: cond W <= 7, so |w_t| / W_nn <= 6 / (2 sqrt 7) and no more than one
 * solution below mu = 0.8819. */
static void test_uniform_boxes_are_benign(void **state)
{
    int several = 0;
    (void)state;
    for (uint64_t i = 0; i < 4000; i++) {
        problem_local problem;
        problem_draw(i % 2 ? PROBLEM_P1 : PROBLEM_P2, 9, i, &problem);
        const double *w = problem.w;
        within(quad_condition(w), 7.0 * (1.0 + 16 * EPS));
        within(hypot(w[1], w[2]) / w[0], 6.0 / (2.0 * sqrt(7.0)) * (1.0 + 16 * EPS));
        quad_solutions all;
        problem.b[0] = -fabs(problem.b[0]);
        quad_solve(w, problem.b, 0.88, 0.88, &all);
        assert_int_equal(all.count, 1);
        quad_solve(w, problem.b, 2.0, 2.0, &all);
        assert_true(all.count == 1 || all.count == 3);
        several += all.count == 3;
    }
    settle("cond W <= 7 and |w_t|/W_nn <= 1.1339");
    print_message("# boxes with three solutions at mu = 2: %.2g %%\n", several / 40.0);
    assert_true(several > 10);
}

/* Momentum about one common point, and energy = p . (u- + u+) / 2. */
static void test_apply_conserves(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 5000; i++) {
        problem_collision c;
        problem_random random;
        tribo_totals totals[2];
        tribo_change change;
        double frame[9];
        double w[6];
        double u[2][3];
        double p[3];
        problem_draw_collision(10, i, &c);
        if (!c.two_bodies) {
            continue;
        }
        problem_random_start(&random, 32, 0, i);
        assert_int_equal(tribo_basis_from_normal(c.contact.normal, frame), TRIBO_OK);
        assert_int_equal(tribo_contact_matrix(&c.a, &c.b, &c.contact, frame, w), TRIBO_OK);
        assert_int_equal(tribo_contact_velocity(&c.a, &c.b, &c.contact, frame, u[0]), TRIBO_OK);
        for (int k = 0; k < 3; k++) {
            p[k] = problem_random_normal(&random) / w[0];
        }
        tribo_body bodies[2] = {c.a, c.b};
        assert_int_equal(tribo_audit_bodies(2, bodies, c.point, &totals[0]), TRIBO_OK);
        assert_int_equal(tribo_contact_apply(&bodies[0], &bodies[1], &c.contact, frame, p),
                         TRIBO_OK);
        assert_int_equal(tribo_audit_bodies(2, bodies, c.point, &totals[1]), TRIBO_OK);
        assert_int_equal(tribo_contact_velocity(&bodies[0], &bodies[1], &c.contact, frame, u[1]),
                         TRIBO_OK);
        assert_int_equal(tribo_audit_change(&totals[0], &totals[1], &change), TRIBO_OK);
        within(change.linear, 8 * EPS);
        within(change.angular, 16 * EPS);
        const double work = 0.5 * (tribo_vec3_dot(p, u[0]) + tribo_vec3_dot(p, u[1]));
        within(fabs(totals[1].energy - totals[0].energy - work),
               64 * EPS * fmax(totals[0].energy, totals[1].energy));
    }
    settle("momentum 8 and 16 eps, work 64 eps");
}

static void test_contact_at(void **state)
{
    tribo_body a = body_of(1, 1, 1, 1);
    tribo_body b = body_of(1, 1, 1, 1);
    static const double point[3] = {1, 2, 3};
    static const double normal[3] = {0, -1, 0};
    tribo_contact contact;
    double u[3];
    (void)state;
    a.position[0] = 4;
    b.position[2] = -5;
    assert_int_equal(tribo_contact_at(&a, &b, point, normal, &contact), TRIBO_OK);
    static const tribo_contact expected = {{0, -1, 0}, {-3, 2, 3}, {1, 2, 8}};
    assert_memory_equal(&contact, &expected, sizeof contact);
    assert_int_equal(tribo_contact_check(&contact), TRIBO_OK);
    assert_int_equal(tribo_contact_at(&a, NULL, point, normal, &contact), TRIBO_OK);
    static const tribo_contact alone = {{0, -1, 0}, {-3, 2, 3}, {0, 0, 0}};
    assert_memory_equal(&contact, &alone, sizeof contact);
    /* v_A - v_B = (1,0,0) + (0,0,2) x (-3,2,3) - (0,1,0) x (1,2,8) = (1-4-8, -6, 1) */
    a.velocity[0] = 1;
    a.angular_velocity[2] = 2;
    b.angular_velocity[1] = 1;
    assert_int_equal(tribo_contact_velocity(&a, &b, &expected, axes, u), TRIBO_OK);
    assert_true(u[0] == 1.0 && u[1] == -11.0 && u[2] == -6.0);
}

/* ---- bad bodies, contacts and frames --------------------------------------------------------- */

static void test_bad_contacts(void **state)
{
    static const double point[3] = {1, 2, 3};
    static const double normals[][3] = {{0, 0, 0}, {0, 0, 2}, {1, 1, 1}, {0, 0, 1 + 1e-12}};
    static const double up[3] = {0, 0, 1};
    tribo_body a = body_of(1, 1, 1, 1);
    tribo_body b = body_of(1, 1, 1, 1);
    const tribo_contact good = contact_with_arm(0, 0, -1);
    (void)state;
    canary();
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_at(NULL, &b, point, up, &out.contact));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_at(&a, &b, NULL, up, &out.contact));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_at(&a, &b, point, NULL, &out.contact));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_at(&a, &b, point, up, NULL));
    assert_int_equal(tribo_contact_check(NULL), TRIBO_ERROR_NULL);
    for (int i = 0; i < 9; i++) {
        double x[3] = {0, 0, 1};
        x[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_at(&a, &b, x, up, &out.contact));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_at(&a, &b, point, x, &out.contact));
        tribo_body lost = a;
        lost.position[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_at(&lost, &b, point, up, &out.contact));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_at(&a, &lost, point, up, &out.contact));
    }
    for (size_t i = 0; i < sizeof normals / sizeof normals[0]; i++) {
        tribo_contact contact = good;
        memcpy(contact.normal, normals[i], sizeof normals[i]);
        REFUSED(TRIBO_ERROR_NORMAL, tribo_contact_at(&a, &b, point, normals[i], &out.contact));
        assert_int_equal(tribo_contact_check(&contact), TRIBO_ERROR_NORMAL);
        REFUSED(TRIBO_ERROR_NORMAL, tribo_contact_matrix(&a, &b, &contact, axes, out.p));
    }
    for (int i = 0; i < 27; i++) {
        tribo_contact contact = good;
        ((double *)&contact)[i / 3] = not_finite[i % 3];
        assert_int_equal(tribo_contact_check(&contact), TRIBO_ERROR_NOT_FINITE);
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_matrix(&a, &b, &contact, axes, out.p));
        if (i >= 9) { /* the normal is not used where a frame is given */
            REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_velocity(&a, &b, &contact, axes, out.p));
        }
    }
}

static void test_bad_frames(void **state)
{
    static const double frames[][9] = {
        {0, 0, 0, 0, 0, 0, 0, 0, 0},        {0, 0, 1, 1, 0, 0, 0, -1, 0}, /* left-handed */
        {0, 0, 1, 1, 0, 0, 0, 1 + 3e-9, 0}, {0, 0, 1, 1, 3e-9, 0, 0, 1, 0},
        {0, 0, 2, 1, 0, 0, 0, 1, 0},        {0, 0, 1, 0, 0, 1, 0, 1, 0},
    };
    tribo_body a = body_of(1, 1, 1, 1);
    const tribo_contact contact = contact_with_arm(0, 0, -1);
    (void)state;
    canary();
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        REFUSED(TRIBO_ERROR_FRAME, tribo_contact_matrix(&a, NULL, &contact, frames[i], out.p));
    }
    for (int i = 0; i < 27; i++) {
        double frame[9];
        tribo_body pushed = a;
        memcpy(frame, axes, sizeof frame);
        frame[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_matrix(&a, NULL, &contact, frame, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_velocity(&a, NULL, &contact, frame, out.p));
        assert_int_equal(tribo_contact_apply(&pushed, NULL, &contact, frame, axes),
                         TRIBO_ERROR_NOT_FINITE);
        assert_memory_equal(&pushed, &a, sizeof a);
    }
}

static void test_bad_pairs(void **state)
{
    static const struct {
        size_t field; /* of the 20 doubles of a body */
        double value;
        tribo_status status;
    } rows[] = {
        {0, (double)NAN, TRIBO_ERROR_NOT_FINITE},  {8, (double)INFINITY, TRIBO_ERROR_NOT_FINITE},
        {11, (double)NAN, TRIBO_ERROR_NOT_FINITE}, {19, -(double)INFINITY, TRIBO_ERROR_NOT_FINITE},
        {3, 0.9, TRIBO_ERROR_ORIENTATION},         {13, -1.0, TRIBO_ERROR_MASS},
        {14, -1.0, TRIBO_ERROR_INERTIA},           {15, 2.0, TRIBO_ERROR_INERTIA},
    };
    tribo_body good = body_of(1, 1, 1, 1);
    const tribo_contact contact = contact_with_arm(0, 0, -1);
    (void)state;
    canary();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tribo_body bad = good;
        tribo_body a = good;
        memcpy((char *)&bad + 8 * rows[i].field, &rows[i].value, 8);
        tribo_body b = bad;
        REFUSED(rows[i].status, tribo_contact_matrix(&b, &a, &contact, axes, out.p));
        REFUSED(rows[i].status, tribo_contact_matrix(&a, &b, &contact, axes, out.p));
        REFUSED(rows[i].status, tribo_contact_matrix(&b, NULL, &contact, axes, out.p));
        assert_int_equal(tribo_contact_apply(&a, &b, &contact, axes, axes), rows[i].status);
        assert_int_equal(tribo_contact_apply(&b, &a, &contact, axes, axes), rows[i].status);
        assert_int_equal(tribo_contact_apply(&b, NULL, &contact, axes, axes), rows[i].status);
        assert_memory_equal(&a, &good, sizeof a);
        assert_memory_equal(&b, &bad, sizeof b);
    }
    for (size_t i = 0; i < 18; i++) { /* velocities of A and of B */
        tribo_body bad = good;
        memcpy((char *)&bad + 8 * (7 + i / 3), &not_finite[i % 3], 8);
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_velocity(&bad, &good, &contact, axes, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_contact_velocity(&good, &bad, &contact, axes, out.p));
    }
}

static void test_bad_geometry_calls(void **state)
{
    tribo_body a = body_of(1, 1, 1, 1);
    tribo_body b = a;
    const tribo_body good = a;
    tribo_body wall;
    tribo_contact contact = contact_with_arm(0, 0, -1);
    const double p[3] = {1, 2, 3};
    (void)state;
    tribo_body_init(&wall);
    canary();
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_velocity(NULL, &b, &contact, axes, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_velocity(&a, &b, NULL, axes, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_velocity(&a, &b, &contact, NULL, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_velocity(&a, &b, &contact, axes, NULL));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_matrix(NULL, &b, &contact, axes, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_matrix(&a, &b, NULL, axes, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_matrix(&a, &b, &contact, NULL, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_contact_matrix(&a, &b, &contact, axes, NULL));
    REFUSED(TRIBO_ERROR_ALIAS, tribo_contact_matrix(&a, &a, &contact, axes, out.p));
    REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_contact_matrix(&wall, NULL, &contact, axes, out.p));
    tribo_body other_wall = wall;
    REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_contact_matrix(&wall, &other_wall, &contact, axes, out.p));
    /* it can turn, but not along the normal */
    tribo_body pinned = a;
    pinned.inverse_mass = 0.0;
    REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_contact_matrix(&pinned, NULL, &contact, axes, out.p));
    tribo_contact far_away = contact_with_arm(1e200, 0, 0);
    REFUSED(TRIBO_ERROR_RANGE, tribo_contact_matrix(&a, NULL, &far_away, axes, out.p));
    assert_int_equal(tribo_contact_apply(NULL, &b, &contact, axes, p), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_contact_apply(&a, &b, NULL, axes, p), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_contact_apply(&a, &b, &contact, NULL, p), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_contact_apply(&a, &b, &contact, axes, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_contact_apply(&a, &a, &contact, axes, p), TRIBO_ERROR_ALIAS);
    for (int i = 0; i < 9; i++) {
        double x[3] = {1, 2, 3};
        x[i / 3] = not_finite[i % 3];
        assert_int_equal(tribo_contact_apply(&a, &b, &contact, axes, x), TRIBO_ERROR_NOT_FINITE);
    }
    /* too much for B only: A must not move either */
    b.inverse_mass = 1e10;
    const tribo_body light = b;
    const double huge[3] = {1e300, 0, 0};
    assert_int_equal(tribo_contact_apply(&a, &b, &contact, axes, huge), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_contact_apply(&b, &a, &contact, axes, huge), TRIBO_ERROR_RANGE);
    assert_memory_equal(&a, &good, sizeof a);
    assert_memory_equal(&b, &light, sizeof b);
}

/* ---- force-level friction -------------------------------------------------------------------- */

static void test_friction_by_hand(void **state)
{
    static const double n[3] = {0, 0, 1};
    static const double pressing[3] = {3, 4, -10};
    static const double lifting[3] = {3, 4, 10};
    static const double sliding[3] = {3, 4, 0};
    double r[3];
    double planar[3];
    (void)state;
    assert_int_equal(tribo_friction_reaction(pressing, n, r), TRIBO_OK);
    assert_true(r[0] == 0.0 && r[1] == 0.0 && r[2] == -10.0);
    assert_int_equal(tribo_friction_planar(pressing, n, planar), TRIBO_OK);
    assert_true(distance(planar, sliding, 3) == 0.0);
    assert_int_equal(tribo_friction_holds(planar, r, 0.5), 1);
    assert_int_equal(tribo_friction_holds(planar, r, 0.4999), 0);
    assert_int_equal(tribo_friction_holds(planar, r, 0.0), 0);
    assert_int_equal(tribo_friction_reaction(lifting, n, r), TRIBO_OK);
    assert_true(r[0] == 0.0 && r[1] == 0.0 && r[2] == 0.0);
    assert_int_equal(tribo_friction_planar(lifting, n, planar), TRIBO_OK);
    assert_true(distance(planar, sliding, 3) == 0.0);
    assert_int_equal(tribo_friction_holds(planar, r, 100.0), 0);
}

/* Wood on stone, 0.7 / 0.3: held up to 0.7 of the load, then 0.3 of it against the pull. */
static void test_wood_on_stone(void **state)
{
    static const double n[3] = {0, 0, 1};
    static const struct {
        double f[3];
        double force[3];
        uint32_t mode;
    } rows[] = {
        {{6.9, 0, -10}, {-6.9, 0, 0}, STICK},
        {{0, -7.0 * (1 - 1e-12), -10}, {0, 7, 0}, STICK},
        {{0, -7.0 * (1 + 1e-12), -10}, {0, 3, 0}, SLIP},
        {{30, 40, -10}, {-1.8, -2.4, 0}, SLIP},
        {{0, 0, -10}, {0, 0, 0}, STICK},
        {{3, 4, 1}, {0, 0, 0}, OPEN},
        {{3, 4, 0}, {0, 0, 0}, OPEN},
    };
    tribo_material pair;
    (void)state;
    assert_int_equal(tribo_material_find("wood on stone", &pair), TRIBO_OK);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        double force[3];
        uint32_t mode = 99;
        assert_int_equal(tribo_friction_force(rows[i].f, n, &pair, force, &mode), TRIBO_OK);
        assert_int_equal(mode, rows[i].mode);
        within(distance(force, rows[i].force, 3), 1e-11);
        assert_int_equal(tribo_friction_force(rows[i].f, n, &pair, force, NULL), TRIBO_OK);
    }
    settle("friction force on wood and stone");
}

/* A block slides from the slope tan(angle) = mu on, whatever its weight and the way it faces. */
static void test_angle_of_repose(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 33, 0, 0);
    for (int i = 0; i < 2000; i++) {
        const double mu = problem_random_uniform(&random, 0.05, 2.0);
        const double angle = atan(mu) * (i % 2 ? 1.0 + 1e-12 : 1.0 - 1e-12);
        const double azimuth = problem_random_uniform(&random, 0.0, 6.28);
        const double n[3] = {sin(angle) * cos(azimuth), sin(angle) * sin(azimuth), cos(angle)};
        const double f[3] = {0, 0, -problem_random_decades(&random, -3.0, 3.0)};
        const tribo_material pair = {mu, 0.5 * mu, 0};
        double force[3];
        uint32_t mode;
        assert_int_equal(tribo_friction_force(f, n, &pair, force, &mode), TRIBO_OK);
        assert_int_equal(mode, i % 2 ? SLIP : STICK);
        const double along = -f[2] * (i % 2 ? 0.5 * mu * cos(angle) : sin(angle));
        within(fabs(tribo_vec3_norm(force) - along), 16 * EPS * -f[2]);
        within(fabs(tribo_vec3_dot(force, n)), 16 * EPS * -f[2]);
        assert_true(force[2] > 0.0); /* up the slope */
    }
    settle("slopes of atan(mu) (1 +- 1e-12)");
}

static void test_bad_forces(void **state)
{
    static const double f[3] = {1, 2, -3};
    static const double n[3] = {0, 0, 1};
    static const double crooked[3] = {0, 0, 1.001};
    const tribo_material pair = {0.5, 0.3, 0};
    const struct {
        tribo_material pair;
        tribo_status status;
    } bad_pairs[] = {
        {{NOT_A_NUMBER, 0.3, 0}, TRIBO_ERROR_NOT_FINITE},
        {{0.5, INFINITE, 0}, TRIBO_ERROR_NOT_FINITE},
        {{0.3, 0.5, 0}, TRIBO_ERROR_FRICTION},
        {{0.3, -0.5, 0}, TRIBO_ERROR_FRICTION},
        {{0.5, 0.3, 1.5}, TRIBO_ERROR_RESTITUTION},
    };
    (void)state;
    canary();
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_reaction(NULL, n, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_reaction(f, NULL, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_reaction(f, n, NULL));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_friction_reaction(f, crooked, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_planar(NULL, n, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_planar(f, NULL, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_planar(f, n, NULL));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_friction_planar(f, crooked, out.p));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_force(NULL, n, &pair, out.p, &out.mode));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_force(f, NULL, &pair, out.p, &out.mode));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_force(f, n, NULL, out.p, &out.mode));
    REFUSED(TRIBO_ERROR_NULL, tribo_friction_force(f, n, &pair, NULL, &out.mode));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_friction_force(f, crooked, &pair, out.p, &out.mode));
    for (size_t i = 0; i < sizeof bad_pairs / sizeof bad_pairs[0]; i++) {
        REFUSED(bad_pairs[i].status,
                tribo_friction_force(f, n, &bad_pairs[i].pair, out.p, &out.mode));
    }
    for (int i = 0; i < 9; i++) {
        double x[3] = {0, 0, 1};
        x[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_reaction(x, n, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_reaction(f, x, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_planar(x, n, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_planar(f, x, out.p));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_force(x, n, &pair, out.p, &out.mode));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_friction_force(f, x, &pair, out.p, &out.mode));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_fixtures),
        TEST(test_fixtures_by_the_general_solve),
        TEST(test_three_solutions),
        TEST(test_scaling_is_exact),
        TEST(test_jam),
        TEST(test_tangential_null_direction),
        TEST(test_locked_tangents),
        TEST(test_singular_matrices_that_stick),
        TEST(test_static_and_dynamic_friction),
        TEST(test_limits_of_friction),
        TEST(test_extreme_sizes),
        TEST(test_frames_do_not_matter),
        TEST(test_unsymmetric_matrices),
        TEST(test_graded_general_matrix),
        TEST(test_stiff_general_matrices),
        TEST(test_singular_general_matrices),
        TEST(test_wild_general_matrices),
        TEST(test_both_solvers_agree),
        TEST(test_outputs_in_place_of_inputs),
        TEST(test_older_solve_info),
        TEST(test_bad_problems),
        TEST(test_bad_solve_calls),
        TEST(test_cone_contains),
        TEST(test_cone_closed_forms),
        TEST(test_clamp_beyond_double),
        TEST(test_cone_projection_properties),
        TEST(test_cone_at_the_ends_of_the_range),
        TEST(test_bad_cones),
        TEST(test_matrix_of_round_bodies),
        TEST(test_matrix_of_rods),
        TEST(test_matrix_of_the_oblique_box),
        TEST(test_matrix_of_random_boxes),
        TEST(test_immovable_bodies),
        TEST(test_uniform_boxes_are_benign),
        TEST(test_apply_conserves),
        TEST(test_contact_at),
        TEST(test_bad_contacts),
        TEST(test_bad_frames),
        TEST(test_bad_pairs),
        TEST(test_bad_geometry_calls),
        TEST(test_friction_by_hand),
        TEST(test_wood_on_stone),
        TEST(test_angle_of_repose),
        TEST(test_bad_forces),
    };
    return cmocka_run_group_tests_name("contact", tests, NULL, NULL);
}
