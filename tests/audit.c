/* Measures of conservation and of Coulomb's law, against closed forms. */
#include <tribo/audit.h>

#include "check.h"
#include "problems.h"
#include "quad.h"

enum { FIELDS = sizeof(tribo_measures) / sizeof(double) };

static void fields_of(const tribo_measures *measures, double fields[FIELDS])
{
    memcpy(fields, measures, sizeof *measures);
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* 2 kg at (1,0,0) with v = (0,3,4), spin (0,0,5) about I_zz = 4; 0.5 kg at (0,2,0), v =
 * (-8,0,0), no spin. About the origin: (1,0,0) x (0,6,8) = (0,-8,6); (0,2,0) x (-4,0,0) =
 * (0,0,8). */
static void two_bodies(tribo_body bodies[2])
{
    bodies[0] = body_of(2, 4, 4, 4);
    bodies[1] = body_of(0.5, 1, 1, 1);
    bodies[0].position[0] = 1;
    bodies[0].velocity[1] = 3;
    bodies[0].velocity[2] = 4;
    bodies[0].angular_velocity[2] = 5;
    bodies[1].position[1] = 2;
    bodies[1].velocity[0] = -8;
}

static void test_totals_by_hand(void **state)
{
    static const tribo_totals expected = {{-4, 6, 8}, {0, -8, 34}, 25 + 50 + 16, 2.5, 14, 38};
    static const double origin[3] = {0, 0, 0};
    tribo_body bodies[3];
    tribo_totals totals;
    (void)state;
    two_bodies(bodies);
    assert_int_equal(tribo_audit_bodies(2, bodies, origin, &totals), TRIBO_OK);
    assert_memory_equal(&totals, &expected, sizeof totals);
    /* bodies without finite mass are left out, whatever they do */
    tribo_body_init(&bodies[2]);
    bodies[2].velocity[0] = 1e10;
    bodies[2].angular_velocity[0] = 1e10;
    assert_int_equal(tribo_audit_bodies(3, bodies, origin, &totals), TRIBO_OK);
    assert_memory_equal(&totals, &expected, sizeof totals);
    bodies[2].inverse_inertia[0] = 1.0;
    assert_int_equal(tribo_audit_bodies(3, bodies, origin, &totals), TRIBO_OK);
    assert_memory_equal(&totals, &expected, sizeof totals);
    /* about another point: L - d x P, d = (0,0,10), d x P = (-60,-40,0) */
    static const double above[3] = {0, 0, 10};
    assert_int_equal(tribo_audit_bodies(2, bodies, above, &totals), TRIBO_OK);
    assert_true(totals.angular[0] == 60.0 && totals.angular[1] == 32.0 &&
                totals.angular[2] == 34.0);
    assert_true(totals.energy == expected.energy && totals.linear_scale == 14.0);
    static const tribo_totals nothing = {{0, 0, 0}, {0, 0, 0}, 0, 0, 0, 0};
    assert_int_equal(tribo_audit_bodies(0, NULL, origin, &totals), TRIBO_OK);
    assert_memory_equal(&totals, &nothing, sizeof totals);
}

/* A turned body: I = R diag R^T by a quarter turn about z exchanges I_xx and I_yy. */
static void test_totals_of_a_turned_body(void **state)
{
    static const double origin[3] = {0, 0, 0};
    tribo_body body = body_of(1, 2, 3, 4);
    tribo_totals totals;
    (void)state;
    body.orientation[0] = body.orientation[3] = sqrt(0.5);
    body.angular_velocity[0] = 1;
    body.angular_velocity[1] = 10;
    body.angular_velocity[2] = 100;
    assert_int_equal(tribo_audit_bodies(1, &body, origin, &totals), TRIBO_OK);
    within(fabs(totals.angular[0] - 3), 16 * EPS * 400);
    within(fabs(totals.angular[1] - 20), 16 * EPS * 400);
    within(fabs(totals.angular[2] - 400), 16 * EPS * 400);
    within(fabs(totals.energy - 0.5 * (3 + 200 + 40000)), 16 * EPS * 20000);
    within(fabs(totals.angular_scale - sqrt(9 + 400 + 160000)), 16 * EPS * 400);
    settle("turned body, 16 eps");
}

static void test_change(void **state)
{
    tribo_totals before = {{3, 4, 0}, {0, 0, 10}, 8, 2, 10, 20};
    tribo_totals after = {{3, 4, 5}, {0, 3, 6}, 2, 2, 4, 50};
    const tribo_totals nothing = {{0, 0, 0}, {0, 0, 0}, 0, 0, 0, 0};
    tribo_change change;
    (void)state;
    assert_int_equal(tribo_audit_change(&before, &after, &change), TRIBO_OK);
    assert_true(change.linear == 0.5 && change.angular == 0.1 && change.energy == -0.75);
    assert_int_equal(tribo_audit_change(&after, &before, &change), TRIBO_OK);
    assert_true(change.linear == 0.5 && change.angular == 0.1 && change.energy == 0.75);
    assert_int_equal(tribo_audit_change(&before, &before, &change), TRIBO_OK);
    assert_true(change.linear == 0.0 && change.angular == 0.0 && change.energy == 0.0);
    assert_int_equal(tribo_audit_change(&nothing, &nothing, &change), TRIBO_OK);
    assert_true(change.linear == 0.0 && change.angular == 0.0 && change.energy == 0.0);
    assert_int_equal(tribo_audit_change(&nothing, &after, &change), TRIBO_OK);
    assert_true(change.energy == 1.0);
}

/* ---- one contact ----------------------------------------------------------------------------- */

#define UNIT             \
    {                    \
        1, 0, 0, 1, 0, 1 \
    }

static void test_measures_by_hand(void **state)
{
    const double r5 = sqrt(5.0);
    const struct {
        double w[6];
        double b[3];
        double mu;
        double p[3];
        tribo_measures expected; /* eta, signorini, cone, misalignment, energy, velocity */
    } rows[] = {
        {UNIT, {0, 0, 0}, 0.5, {0, 0, 0}, {0, 0, 0, 0, 0, 0}},
        /* sticks; V = P = 2 */
        {UNIT, {-1, 0, 0}, 0.5, {1, 0, 0}, {0, 0, 0, 0, -0.125, 0}},
        /* open; V = P = 1 */
        {UNIT, {1, 0, 0}, 0.5, {0, 0, 0}, {0, 0, 0, 0, 0, 1}},
        /* no impulse where one is needed */
        {UNIT, {-1, 0, 0}, 0.5, {0, 0, 0}, {1, 1, 0, 0, 0, -1}},
        /* an impulse where none is: v = 2, V = P = 2, natural map (1 - 2)+ = 0 */
        {UNIT, {1, 0, 0}, 0.5, {1, 0, 0}, {0.5, 0.5, 0, 0, 0.375, 2}},
        /* pulls */
        {UNIT, {1, 0, 0}, 0.5, {-1, 0, 0}, {0.5, 0.5, 0.25, 0, -0.125, 0}},
        /* sticks outside of the cone, by 1.5; V = P = 2 sqrt 5 */
        {UNIT,
         {-1, -2, 0},
         0.5,
         {1, 2, 0},
         {1.5 / sqrt(1.25) / 2 / r5, 0, 0.75 / r5, 0, -0.125, 0}},
        /* slips with friction against it; V = sqrt 3.25 + sqrt 1.25 */
        {UNIT,
         {-1, 1.5, 0},
         0.5,
         {1, -0.5, 0},
         {0, 0, 0, 0, -1.125 / (sqrt(3.25) + sqrt(1.25)) / (sqrt(3.25) + sqrt(1.25)), 0}},
        /* slips with friction along: map goes to (.6, -.3); V = P = sqrt 5 */
        {UNIT, {-1, 0.5, 0}, 0.5, {1, 0.5, 0}, {0.4, 0, 0, 0.2, -0.025, 0}},
        /* slips without friction: map to (.8, -.4); V = P = sqrt 2 + 1 */
        {UNIT,
         {-1, 1, 0},
         0.5,
         {1, 0, 0},
         {sqrt(0.2) / (sqrt(2.0) + 1), 0, 0, 0.5 / (sqrt(2.0) + 1) / (sqrt(2.0) + 1),
          -0.5 / (sqrt(2.0) + 1) / (sqrt(2.0) + 1), 0}},
        /* rho = 1/(2 * 4): W twice as stiff, mu = 4; v_n = -1 + 1 = 0 */
        {{2, 0, 0, 2, 0, 2}, {-1, 0, 0}, 4, {0.5, 0, 0}, {0, 0, 0, 0, -0.125, 0}},
        {{2, 0, 0, 2, 0, 2}, {-1, 0, 0}, 4, {0, 0, 0}, {0.25, 1, 0, 0, 0, -1}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tribo_measures measures;
        double got[FIELDS];
        double want[FIELDS];
        assert_int_equal(
            tribo_audit_contact(rows[i].w, rows[i].b, rows[i].mu, rows[i].p, &measures), TRIBO_OK);
        fields_of(&measures, got);
        fields_of(&rows[i].expected, want);
        for (int k = 0; k < FIELDS; k++) {
            if (!(fabs(got[k] - want[k]) <= 16 * EPS)) {
                print_message("# row %d, field %d: %.17g, not %.17g\n", (int)i, k, got[k], want[k]);
            }
            within(fabs(got[k] - want[k]), 16 * EPS);
        }
    }
    settle("measures by hand, 16 eps");
}

/* The measures written out in long double, for any W, b, p. */
static void reference(const double w[6], const double b[3], double mu, const double p[3],
                      double out[FIELDS])
{
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    long double v[3];
    long double square_b = 0.0L;
    long double square_wp = 0.0L;
    long double work = 0.0L;
    for (int i = 0; i < 3; i++) {
        long double row = 0.0L;
        v[i] = (long double)b[i];
        for (int k = 0; k < 3; k++) {
            v[i] += (long double)w[at[i][k]] * (long double)p[k];
            row += fabsl((long double)w[at[i][k]] * (long double)p[k]);
        }
        square_b += (long double)b[i] * (long double)b[i];
        square_wp += row * row;
        work += 0.5L * (long double)p[i] * ((long double)b[i] + v[i]);
    }
    const long double vs = sqrtl(square_b) + sqrtl(square_wp);
    const long double ps = vs / (long double)fmax(w[0], fmax(w[3], w[5]));
    const long double m = (long double)mu;
    const long double slide = hypotl(v[1], v[2]);
    const long double friction = hypotl((long double)p[1], (long double)p[2]);
    out[0] = quad_eta(w, b, mu, p);
    out[1] = (double)fabsl(fminl(v[0] / vs, (long double)p[0] / ps));
    out[2] = (double)(fmaxl(0.0L, friction - m * (long double)p[0]) / ps);
    out[3] = (double)(hypotl(slide * (long double)p[1] + m * (long double)p[0] * v[1],
                             slide * (long double)p[2] + m * (long double)p[0] * v[2]) /
                      (ps * vs));
    out[4] = (double)(work / (ps * vs));
    out[5] = (double)v[0];
}

static void draw_case(uint64_t i, problem_local *problem, double p[3])
{
    problem_random random;
    problem_draw((uint32_t)(i % PROBLEM_SETS), 50, i, problem);
    problem_random_start(&random, 51, 0, i);
    assert_int_equal(tribo_contact_solve(problem->w, problem->b, problem->mu, problem->mu, p, NULL),
                     TRIBO_OK);
    /* solutions, and what is off by little or much */
    if (i % 4) {
        const double size = problem_random_decades(&random, -12.0, 1.0) *
                            (tribo_vec3_norm(p) + tribo_vec3_norm(problem->b) / problem->w[0]);
        for (int k = 0; k < 3; k++) {
            p[k] += size * problem_random_normal(&random);
        }
    }
}

static double impulse_over_scale(const problem_local *problem, const double p[3])
{
    const double *w = problem->w;
    const double rows[3] = {
        fabs(w[0] * p[0]) + fabs(w[1] * p[1]) + fabs(w[2] * p[2]),
        fabs(w[1] * p[0]) + fabs(w[3] * p[1]) + fabs(w[4] * p[2]),
        fabs(w[2] * p[0]) + fabs(w[4] * p[1]) + fabs(w[5] * p[2]),
    };
    const double v = tribo_vec3_norm(problem->b) + tribo_vec3_norm(rows);
    return tribo_vec3_norm(p) * fmax(w[0], fmax(w[3], w[5])) / v;
}

static void test_measures_of_random_impulses(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 30000; i++) {
        problem_local problem;
        tribo_measures measures;
        double p[3];
        double got[FIELDS];
        double want[FIELDS];
        draw_case(i, &problem, p);
        assert_int_equal(tribo_audit_contact(problem.w, problem.b, problem.mu, p, &measures),
                         TRIBO_OK);
        fields_of(&measures, got);
        reference(problem.w, problem.b, problem.mu, p, want);
        const double top = fmax(problem.w[0], fmax(problem.w[3], problem.w[5]));
        const double scale = tribo_vec3_norm(problem.b) + 3.0 * tribo_vec3_norm(p) * top;
        /* P is small beside p where p lies along a soft axis of W; mu multiplies p_n and |v_t| */
        const double amplified = (1.0 + problem.mu) * fmax(1.0, impulse_over_scale(&problem, p));
        for (int k = 0; k < 5; k++) {
            within(fabs(got[k] - want[k]), 16 * EPS * amplified);
        }
        within(fabs(got[5] - want[5]), 16 * EPS * scale);
    }
    settle("measures in long double, 16 eps (1 + mu) |p|/P");
}

/* No unit matters: W * 2^i and b * 2^j, p * 2^(j-i) have the same measures to the bit. */
static void test_measures_have_no_dimension(void **state)
{
    static const int exponents[][2] = {{0, 100}, {-400, 0}, {300, -300}, {900, 0}, {-900, -100}};
    (void)state;
    for (uint64_t i = 0; i < 2000; i++) {
        problem_local problem;
        tribo_measures plain;
        double p[3];
        draw_case(i, &problem, p);
        assert_int_equal(tribo_audit_contact(problem.w, problem.b, problem.mu, p, &plain),
                         TRIBO_OK);
        for (size_t n = 0; n < sizeof exponents / sizeof exponents[0]; n++) {
            const int ew = exponents[n][0];
            const int eb = exponents[n][1];
            tribo_measures scaled;
            double w[6];
            double b[3];
            double q[3];
            for (int k = 0; k < 6; k++) {
                w[k] = ldexp(problem.w[k], ew);
            }
            for (int k = 0; k < 3; k++) {
                b[k] = ldexp(problem.b[k], eb);
                q[k] = ldexp(p[k], eb - ew);
            }
            assert_int_equal(tribo_audit_contact(w, b, problem.mu, q, &scaled), TRIBO_OK);
            scaled.velocity = ldexp(scaled.velocity, -eb);
            assert_memory_equal(&scaled, &plain, sizeof plain);
        }
    }
}

/* ---- impacts --------------------------------------------------------------------------------- */

/* Ball, u = (-1; 2, 0), e = 1/2, so b = (-1.5; 2, 0). */
static void test_impact_by_hand(void **state)
{
    static const double w[6] = {1, 0, 0, 3.5, 0, 3.5};
    static const double u[3] = {-1, 2, 0};
    const tribo_material pair = {0.4, 0.1, 0.5};
    const double stick[3] = {1.5, -4.0 / 7.0, 0};
    const double slip[3] = {1.5, -0.15, 0};
    const double bounce[3] = {1, 0, 0};
    tribo_measures measures;
    (void)state;
    /* |p_t|/p_n = .381: no sliding is left, so it is judged by mu_s */
    assert_int_equal(tribo_audit_impact(w, u, &pair, stick, &measures), TRIBO_OK);
    const double v_stick = 2.5 + hypot(1.5, 2);
    within(measures.eta + measures.signorini + measures.cone + measures.misalignment, 16 * EPS);
    within(fabs(measures.velocity), 16 * EPS);
    /* p . (u- + u+) / 2 = (1.5 (-.5) - 4/7 * 2) / 2 */
    within(fabs(measures.energy - 0.5 * (-0.75 - 8.0 / 7.0) / (v_stick * v_stick / 3.5)), 16 * EPS);
    /* slides on: by mu_d */
    assert_int_equal(tribo_audit_impact(w, u, &pair, slip, &measures), TRIBO_OK);
    within(measures.eta + measures.signorini + measures.cone + measures.misalignment, 16 * EPS);
    /* the same with mu_d = .2 is a wrong answer */
    const tribo_material other = {0.4, 0.2, 0.5};
    assert_int_equal(tribo_audit_impact(w, u, &other, slip, &measures), TRIBO_OK);
    assert_true(measures.eta > 0.01 && measures.misalignment > 0.01 && measures.cone == 0.0);
    /* half way: u_n+ = 0 instead of .5, V = 2.5 + 1 */
    assert_int_equal(tribo_audit_impact(w, u, &pair, bounce, &measures), TRIBO_OK);
    within(fabs(measures.velocity + 0.5 / 3.5), 16 * EPS);
    within(fabs(measures.energy + 0.5 / (3.5 * 3.5 / 3.5)), 16 * EPS);
    assert_true(measures.eta > 0.01);
    settle("impacts by hand, 16 eps");
}

/* COULOMB is what eta is measured against; every other law is off it in its own way, and the true
 * change of energy and the cone show. */
static void test_impact_of_laws(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 6000; i++) {
        problem_impact problem;
        problem_draw_impact(PROBLEM_P1, 52, i, &problem);
        for (uint32_t law = 0; law <= TRIBO_LAW_LECTURE_CLOSING; law++) {
            const tribo_impact_options options = {sizeof options, law, 0.0};
            tribo_impact_info info = {.struct_size = sizeof info};
            tribo_measures measures;
            double p[3];
            assert_int_equal(tribo_impact(problem.w, problem.u, &problem.pair, &options, p, &info),
                             TRIBO_OK);
            assert_int_equal(tribo_audit_impact(problem.w, problem.u, &problem.pair, p, &measures),
                             TRIBO_OK);
            const double e = problem.u[0] < 0.0 ? problem.pair.e : 0.0;
            const double b[3] = {(1 + e) * problem.u[0], problem.u[1], problem.u[2]};
            double scaled[FIELDS];
            const double top = fmax(problem.w[0], fmax(problem.w[3], problem.w[5]));
            reference(problem.w, b, problem.pair.mu_d, p, scaled);
            /* V from the sum of the parts: energy and velocity in its units */
            double vs = tribo_vec3_norm(b);
            const double *w = problem.w;
            const double rows[3] = {
                fabs(w[0] * p[0]) + fabs(w[1] * p[1]) + fabs(w[2] * p[2]),
                fabs(w[1] * p[0]) + fabs(w[3] * p[1]) + fabs(w[4] * p[2]),
                fabs(w[2] * p[0]) + fabs(w[4] * p[1]) + fabs(w[5] * p[2]),
            };
            vs += tribo_vec3_norm(rows);
            within(fabs(measures.energy - info.energy / (vs * vs / top)), 64 * EPS);
            if (problem.u[0] < 0.0) {
                within(fabs(measures.velocity - (info.velocity[0] + e * problem.u[0]) / vs),
                       64 * EPS);
            }
            if (law == TRIBO_LAW_COULOMB) {
                within(measures.eta, 1e-12);
            }
            if (info.mode == TRIBO_MODE_SLIP && law != TRIBO_LAW_FRICTIONLESS) {
                within(fabs(measures.cone - scaled[2]), 64 * EPS);
            }
        }
    }
    settle("energy, velocity, cone 64 eps; eta of COULOMB 1e-12");
}

/* ---- arrays ---------------------------------------------------------------------------------- */

static void test_arrays(void **state)
{
    enum { COUNT = 37 };
    static double w[6 * COUNT];
    static double b[3 * COUNT];
    static double p[3 * COUNT];
    static double mu[COUNT];
    double greatest[FIELDS] = {0.0};
    double squares[FIELDS] = {0.0};
    tribo_measures max;
    tribo_measures rms;
    double got[FIELDS];
    (void)state;
    for (size_t i = 0; i < COUNT; i++) {
        problem_local problem;
        tribo_measures one;
        double fields[FIELDS];
        draw_case(i, &problem, p + 3 * i);
        memcpy(w + 6 * i, problem.w, sizeof problem.w);
        memcpy(b + 3 * i, problem.b, sizeof problem.b);
        mu[i] = problem.mu;
        assert_int_equal(tribo_audit_contact(w + 6 * i, b + 3 * i, mu[i], p + 3 * i, &one),
                         TRIBO_OK);
        fields_of(&one, fields);
        for (int k = 0; k < FIELDS; k++) {
            greatest[k] = fmax(greatest[k], fabs(fields[k]));
            squares[k] += fields[k] * fields[k];
        }
    }
    assert_int_equal(tribo_audit_contacts(COUNT, w, b, mu, p, &max, &rms), TRIBO_OK);
    fields_of(&max, got);
    for (int k = 0; k < FIELDS; k++) {
        assert_true(got[k] == greatest[k]);
    }
    fields_of(&rms, got);
    for (int k = 0; k < FIELDS; k++) {
        within(fabs(got[k] - sqrt(squares[k] / COUNT)), 64 * EPS * greatest[k]);
    }
    settle("root mean square, 64 eps");
    /* either may be missing */
    tribo_measures again;
    assert_int_equal(tribo_audit_contacts(COUNT, w, b, mu, p, &again, NULL), TRIBO_OK);
    assert_memory_equal(&again, &max, sizeof max);
    assert_int_equal(tribo_audit_contacts(COUNT, w, b, mu, p, NULL, &again), TRIBO_OK);
    assert_memory_equal(&again, &rms, sizeof rms);
    assert_int_equal(tribo_audit_contacts(COUNT, w, b, mu, p, NULL, NULL), TRIBO_OK);
    static const tribo_measures nothing = {0, 0, 0, 0, 0, 0};
    assert_int_equal(tribo_audit_contacts(0, NULL, NULL, NULL, NULL, &max, &rms), TRIBO_OK);
    assert_memory_equal(&max, &nothing, sizeof max);
    assert_memory_equal(&rms, &nothing, sizeof rms);
}

/* ---- bad input ------------------------------------------------------------------------------- */

static struct {
    tribo_totals totals;
    tribo_change change;
    tribo_measures measures, max, rms;
} out, before;

/* A refused call gives the status and leaves `out` as it was. */
#define REFUSED(expected, call) ASSERT_REFUSED_AFRESH(out, before, expected, call)

static void test_bad_bodies(void **state)
{
    static const struct {
        size_t field; /* of the 20 doubles of a body */
        double value;
        tribo_status status;
    } rows[] = {
        {2, (double)NAN, TRIBO_ERROR_NOT_FINITE}, {9, (double)INFINITY, TRIBO_ERROR_NOT_FINITE},
        {5, 0.5, TRIBO_ERROR_ORIENTATION},        {13, -1.0, TRIBO_ERROR_MASS},
        {17, -1.0, TRIBO_ERROR_INERTIA},          {16, 9.0, TRIBO_ERROR_INERTIA},
    };
    static const double origin[3] = {0, 0, 0};
    tribo_body bodies[2];
    (void)state;
    two_bodies(bodies);
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_bodies(2, NULL, origin, &out.totals));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_bodies(2, bodies, NULL, &out.totals));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_bodies(2, bodies, origin, NULL));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_bodies(0, NULL, NULL, &out.totals));
    for (int i = 0; i < 9; i++) {
        double x[3] = {0, 0, 0};
        x[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_bodies(2, bodies, x, &out.totals));
    }
    for (size_t i = 0; i < 2 * sizeof rows / sizeof rows[0]; i++) {
        two_bodies(bodies);
        memcpy((char *)&bodies[i % 2] + 8 * rows[i / 2].field, &rows[i / 2].value, 8);
        REFUSED(rows[i / 2].status, tribo_audit_bodies(2, bodies, origin, &out.totals));
    }
    /* of two bad ones the first */
    two_bodies(bodies);
    bodies[0].inverse_mass = -1.0;
    bodies[1].orientation[0] = 0.0;
    REFUSED(TRIBO_ERROR_MASS, tribo_audit_bodies(2, bodies, origin, &out.totals));
}

static void test_bad_changes(void **state)
{
    const tribo_totals good = {{3, 4, 0}, {0, 0, 10}, 8, 2, 10, 20};
    (void)state;
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_change(NULL, &good, &out.change));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_change(&good, NULL, &out.change));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_change(&good, &good, NULL));
    for (int i = 0; i < 30; i++) {
        tribo_totals bad = good;
        memcpy((char *)&bad + 8 * (i / 3), &not_finite[i % 3], 8);
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_change(&bad, &good, &out.change));
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_change(&good, &bad, &out.change));
    }
}

static void test_bad_contacts(void **state)
{
    static const double w[6] = {1, 0, 0, 1, 0, 1};
    static const double b[3] = {-1, 0, 0};
    static const double p[3] = {1, 0, 0};
    static const double none[2][6] = {{0, 0, 0, 0, 0, 0}, {-1, 0, 0, -1, 0, -1}};
    const tribo_material pair = {0.5, 0.3, 0.5};
    const tribo_material bad_friction = {0.3, 0.5, 0.5};
    const tribo_material negative = {0.3, -0.5, 0.5};
    const tribo_material bad_restitution = {0.5, 0.3, 1.5};
    (void)state;
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contact(NULL, b, 0.5, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contact(w, NULL, 0.5, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contact(w, b, 0.5, NULL, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contact(w, b, 0.5, p, NULL));
    REFUSED(TRIBO_ERROR_FRICTION, tribo_audit_contact(w, b, -0.5, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_impact(NULL, b, &pair, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_impact(w, NULL, &pair, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_impact(w, b, NULL, p, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_impact(w, b, &pair, NULL, &out.measures));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_impact(w, b, &pair, p, NULL));
    REFUSED(TRIBO_ERROR_FRICTION, tribo_audit_impact(w, b, &bad_friction, p, &out.measures));
    REFUSED(TRIBO_ERROR_FRICTION, tribo_audit_impact(w, b, &negative, p, &out.measures));
    REFUSED(TRIBO_ERROR_RESTITUTION, tribo_audit_impact(w, b, &bad_restitution, p, &out.measures));
    for (int i = 0; i < 2; i++) {
        REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_audit_contact(none[i], b, 0.5, p, &out.measures));
        REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_audit_impact(none[i], b, &pair, p, &out.measures));
    }
    for (int i = 0; i < 13 * 3; i++) {
        double x[13] = {1, 0, 0, 1, 0, 1, -1, 0, 0, 1, 0, 0, 0.5};
        x[i / 3] = not_finite[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_contact(x, x + 6, x[12], x + 9, &out.measures));
        if (i < 36) {
            REFUSED(TRIBO_ERROR_NOT_FINITE,
                    tribo_audit_impact(x, x + 6, &pair, x + 9, &out.measures));
        }
    }
    for (int i = 0; i < 9; i++) {
        double x[3] = {0.5, 0.3, 0.5};
        x[i / 3] = not_finite[i % 3];
        const tribo_material bad = {x[0], x[1], x[2]};
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_impact(w, b, &bad, p, &out.measures));
    }
}

static void test_bad_arrays(void **state)
{
    double w[18] = {1, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1};
    double b[9] = {-1, 0, 0, -1, 0, 0, -1, 0, 0};
    double p[9] = {1, 0, 0, 1, 0, 0, 1, 0, 0};
    double mu[3] = {0.5, 0.5, 0.5};
    (void)state;
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contacts(3, NULL, b, mu, p, &out.max, &out.rms));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contacts(3, w, NULL, mu, p, &out.max, &out.rms));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contacts(3, w, b, NULL, p, &out.max, &out.rms));
    REFUSED(TRIBO_ERROR_NULL, tribo_audit_contacts(3, w, b, mu, NULL, &out.max, &out.rms));
    mu[2] = -1.0;
    REFUSED(TRIBO_ERROR_FRICTION, tribo_audit_contacts(3, w, b, mu, p, &out.max, &out.rms));
    w[6] = w[9] = w[11] = 0.0;
    REFUSED(TRIBO_ERROR_IMMOVABLE, tribo_audit_contacts(3, w, b, mu, p, &out.max, &out.rms));
    p[1] = not_finite[1];
    REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_audit_contacts(3, w, b, mu, p, &out.max, &out.rms));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_totals_by_hand),
        TEST(test_totals_of_a_turned_body),
        TEST(test_change),
        TEST(test_measures_by_hand),
        TEST(test_measures_of_random_impulses),
        TEST(test_measures_have_no_dimension),
        TEST(test_impact_by_hand),
        TEST(test_impact_of_laws),
        TEST(test_arrays),
        TEST(test_bad_bodies),
        TEST(test_bad_changes),
        TEST(test_bad_contacts),
        TEST(test_bad_arrays),
    };
    return cmocka_run_group_tests_name("audit", tests, NULL, NULL);
}
