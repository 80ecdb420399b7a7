/* Rigid bodies: mass properties, impulses, free flight. */
#include <tribo/body.h>

#include "check.h"
#include "problems.h"

#define PI 3.14159265358979323846

/* ---- mass properties ------------------------------------------------------------------------- */

enum { SPHERE, BOX, CAPSULE, CYLINDER, ELLIPSOID, SHAPES };

static const size_t shape_lengths[SHAPES] = {1, 3, 2, 2, 3};

static tribo_status mass_of(int shape, double density, const double *lengths, double *mass,
                            double *inertia)
{
    switch (shape) {
    case SPHERE:
        return tribo_mass_sphere(density, lengths[0], mass, inertia);
    case BOX:
        return tribo_mass_box(density, lengths, mass, inertia);
    case CAPSULE:
        return tribo_mass_capsule(density, lengths[0], lengths[1], mass, inertia);
    case CYLINDER:
        return tribo_mass_cylinder(density, lengths[0], lengths[1], mass, inertia);
    default:
        return tribo_mass_ellipsoid(density, lengths, mass, inertia);
    }
}

/* Area of the cut at height z, and integrals of x^2 and y^2 over it. */
static void cut(int shape, const double *l, double z, double *area, double *xx, double *yy)
{
    double a;
    double b;
    if (shape == BOX) {
        *area = 4.0 * l[0] * l[1];
        *xx = *area * l[0] * l[0] / 3.0;
        *yy = *area * l[1] * l[1] / 3.0;
        return;
    }
    if (shape == SPHERE || shape == CYLINDER) {
        a = b = shape == CYLINDER ? l[0] : sqrt((l[0] - z) * (l[0] + z));
    } else if (shape == CAPSULE) {
        const double over = fmax(0.0, fabs(z) - l[1]);
        a = b = sqrt((l[0] - over) * (l[0] + over));
    } else {
        const double s = sqrt((1.0 - z / l[2]) * (1.0 + z / l[2]));
        a = l[0] * s;
        b = l[1] * s;
    }
    *area = PI * a * b;
    *xx = *area * a * a / 4.0;
    *yy = *area * b * b / 4.0;
}

/* Mass, I_xx, I_yy, I_zz between two heights. All integrands are polynomials of degree 4 at most,
 * so Gauss's rule of three points is exact. */
static void integrate(int shape, double density, const double *l, double from, double to,
                      double sum[4])
{
    static const double node[3] = {-0.774596669241483377, 0.0, 0.774596669241483377};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    for (int i = 0; i < 3; i++) {
        const double z = 0.5 * (from + to) + 0.5 * (to - from) * node[i];
        const double w = 0.5 * (to - from) * weight[i] * density;
        double area;
        double xx;
        double yy;
        cut(shape, l, z, &area, &xx, &yy);
        sum[0] += w * area;
        sum[1] += w * (yy + z * z * area);
        sum[2] += w * (xx + z * z * area);
        sum[3] += w * (xx + yy);
    }
}

static void quadrature(int shape, double density, const double *l, double sum[4])
{
    const double middle = shape == SPHERE ? l[0] : shape == BOX || shape == ELLIPSOID ? l[2] : l[1];
    sum[0] = sum[1] = sum[2] = sum[3] = 0.0;
    integrate(shape, density, l, -middle, middle, sum);
    if (shape == CAPSULE) {
        integrate(shape, density, l, l[1], l[1] + l[0], sum);
        integrate(shape, density, l, -l[1] - l[0], -l[1], sum);
    }
}

static void test_mass_against_quadrature(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 20, 0, 0);
    for (int i = 0; i < 20000; i++) {
        const int shape = i % SHAPES;
        const double density = problem_random_decades(&random, -3.0, 4.0);
        const double size = problem_random_decades(&random, -6.0, 6.0);
        double l[3];
        double mass;
        double inertia[9];
        double sum[4];
        for (int k = 0; k < 3; k++) {
            l[k] = size * problem_random_decades(&random, -2.0, 0.0);
        }
        assert_int_equal(mass_of(shape, density, l, &mass, inertia), TRIBO_OK);
        quadrature(shape, density, l, sum);
        within(fabs(mass - sum[0]), 16.0 * EPS * sum[0]);
        for (int k = 0; k < 3; k++) {
            within(fabs(inertia[4 * k] - sum[k + 1]), 16.0 * EPS * sum[k + 1]);
        }
        for (int k = 0; k < 9; k++) {
            assert_true(k % 4 == 0 || inertia[k] == 0.0);
        }
    }
    settle("mass and inertia against exact quadrature, 16 eps");
}

static void test_mass_by_hand(void **state)
{
    double mass;
    double inertia[9];
    (void)state;
    assert_int_equal(tribo_mass_sphere(3.0, 2.0, &mass, inertia), TRIBO_OK);
    within(fabs(mass - 32.0 * PI), 4 * EPS * mass);
    within(fabs(inertia[0] - 1.6 * mass) + fabs(inertia[8] - 1.6 * mass), 8 * EPS * inertia[0]);
    assert_int_equal(tribo_mass_box(0.5, (const double[3]){1.0, 2.0, 3.0}, &mass, inertia),
                     TRIBO_OK);
    assert_true(mass == 24.0 && inertia[0] == 104.0 && inertia[4] == 80.0 && inertia[8] == 40.0);
    assert_int_equal(tribo_mass_cylinder(1.0, 2.0, 1.5, &mass, inertia), TRIBO_OK);
    within(fabs(mass - 12.0 * PI), 4 * EPS * mass);
    within(fabs(inertia[0] - 1.75 * mass) + fabs(inertia[8] - 2.0 * mass), 8 * EPS * inertia[8]);
    /* r = h = 1: barrel 2 pi, caps 4/3 pi; across 2 pi (7/12) + 4/3 pi (0.4 + 1 + 0.75) */
    assert_int_equal(tribo_mass_capsule(1.0, 1.0, 1.0, &mass, inertia), TRIBO_OK);
    within(fabs(mass - 10.0 / 3.0 * PI), 4 * EPS * mass);
    within(fabs(inertia[0] - PI * (7.0 / 6.0 + 8.6 / 3.0)), 8 * EPS * inertia[0]);
    within(fabs(inertia[8] - PI * (1.0 + 1.6 / 3.0)), 8 * EPS * inertia[8]);
    settle("closed forms, 8 eps");
}

/* The B14 test body of the literature: half-extents .1 .2 .3, 1 kg: (13/300, 1/30, 1/60). */
static void test_mass_of_the_test_body(void **state)
{
    static const double moments[3] = {13.0 / 300.0, 1.0 / 30.0, 1.0 / 60.0};
    double mass;
    double inertia[9];
    (void)state;
    assert_int_equal(tribo_mass_box(1.0 / 0.048, (const double[3]){0.1, 0.2, 0.3}, &mass, inertia),
                     TRIBO_OK);
    within(fabs(mass - 1.0), 8 * EPS);
    for (int k = 0; k < 3; k++) {
        within(fabs(inertia[4 * k] - moments[k]), 8 * EPS * moments[k]);
    }
    settle("the test body, 8 eps");
}

static double canvas[16];
static double before[16];

/* A refused call gives the status and leaves the canvas, where its outputs stand, as it was. */
#define REFUSED(expected, call) ASSERT_REFUSED(canvas, before, expected, call)

static void test_bad_shapes(void **state)
{
    const double bad[3] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    double *mass = canvas;
    double *inertia = canvas + 1;
    (void)state;
    memset(canvas, 0xa5, sizeof canvas);
    for (int shape = 0; shape < SHAPES; shape++) {
        const double good[3] = {1.0, 2.0, 3.0};
        REFUSED(TRIBO_ERROR_NULL, mass_of(shape, 1.0, good, NULL, inertia));
        REFUSED(TRIBO_ERROR_NULL, mass_of(shape, NOT_A_NUMBER, good, mass, NULL));
        REFUSED(TRIBO_ERROR_SHAPE, mass_of(shape, 0.0, good, mass, inertia));
        REFUSED(TRIBO_ERROR_SHAPE, mass_of(shape, -1.0, good, mass, inertia));
        REFUSED(TRIBO_ERROR_RANGE, mass_of(shape, DBL_MAX, good, mass, inertia));
        REFUSED(TRIBO_ERROR_RANGE,
                mass_of(shape, 5e-324, (const double[3]){1e-3, 1e-3, 1e-3}, mass, inertia));
        REFUSED(TRIBO_ERROR_RANGE,
                mass_of(shape, 1.0, (const double[3]){1e200, 1e200, 1e200}, mass, inertia));
        REFUSED(TRIBO_ERROR_RANGE,
                mass_of(shape, 1.0, (const double[3]){1e-70, 1e-70, 1e-70}, mass, inertia));
        for (int i = 0; i < 3; i++) {
            REFUSED(TRIBO_ERROR_NOT_FINITE, mass_of(shape, bad[i], good, mass, inertia));
            for (size_t k = 0; k < shape_lengths[shape]; k++) {
                double l[3] = {1.0, 2.0, 3.0};
                l[k] = bad[i];
                REFUSED(TRIBO_ERROR_NOT_FINITE, mass_of(shape, 1.0, l, mass, inertia));
                l[k] = i == 0 ? 0.0 : i == 1 ? -0.0 : -1.0;
                REFUSED(TRIBO_ERROR_SHAPE, mass_of(shape, 1.0, l, mass, inertia));
            }
        }
    }
    REFUSED(TRIBO_ERROR_NULL, tribo_mass_box(1.0, NULL, mass, inertia));
    REFUSED(TRIBO_ERROR_NULL, tribo_mass_ellipsoid(1.0, NULL, mass, inertia));
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static void long_rotation(const double orientation[4], long double r[9])
{
    long double q[4];
    long double norm = 0.0L;
    for (int i = 0; i < 4; i++) {
        q[i] = (long double)orientation[i];
        norm += q[i] * q[i];
    }
    const long double s = 2.0L / norm;
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3;
        const int l = (i + 2) % 3;
        r[4 * i] = 1.0L - s * (q[k + 1] * q[k + 1] + q[l + 1] * q[l + 1]);
        r[3 * i + k] = s * (q[i + 1] * q[k + 1] - q[0] * q[l + 1]);
        r[3 * i + l] = s * (q[i + 1] * q[l + 1] + q[0] * q[k + 1]);
    }
}

/* Inertia R diag(moments) R^T. */
static void turned_inertia(const double q[4], const double moments[3], double out[9])
{
    long double r[9];
    long_rotation(q, r);
    for (int i = 0; i < 3; i++) {
        for (int k = i; k < 3; k++) {
            long double sum = 0.0L;
            for (int l = 0; l < 3; l++) {
                sum += r[3 * i + l] * r[3 * k + l] * (long double)moments[l];
            }
            out[3 * i + k] = out[3 * k + i] = (double)sum;
        }
    }
}

/* Principal moments of a uniform box with edges of the given spread. */
static void draw_moments(problem_random *random, double spread, double moments[3])
{
    double square[3];
    for (int i = 0; i < 3; i++) {
        const double edge = problem_random_decades(random, -spread, 0.0);
        square[i] = edge * edge;
    }
    const double mass = problem_random_decades(random, -3.0, 3.0);
    for (int i = 0; i < 3; i++) {
        moments[i] = mass * (square[(i + 1) % 3] + square[(i + 2) % 3]) / 12.0;
    }
}

static void test_init(void **state)
{
    tribo_body body;
    tribo_body expected;
    (void)state;
    memset(&body, 0xa5, sizeof body);
    memset(&expected, 0, sizeof expected);
    expected.orientation[0] = 1.0;
    assert_int_equal(tribo_body_init(&body), TRIBO_OK);
    assert_memory_equal(&body, &expected, sizeof body);
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    assert_int_equal(tribo_body_init(NULL), TRIBO_ERROR_NULL);
}

static void test_set_mass_inverts(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 21, 0, 0);
    for (int i = 0; i < 20000; i++) {
        tribo_body body;
        double q[4];
        double moments[3];
        double inertia[9];
        draw_moments(&random, i % 2 ? 1.0 : 3.0, moments);
        problem_random_direction(&random, 4, q);
        turned_inertia(q, moments, inertia);
        const double scale = problem_random_decades(&random, -100.0, 100.0);
        for (int k = 0; k < 9; k++) {
            inertia[k] *= scale;
        }
        assert_int_equal(tribo_body_init(&body), TRIBO_OK);
        assert_int_equal(tribo_body_set_mass(&body, scale, inertia), TRIBO_OK);
        assert_true(body.inverse_mass == 1.0 / scale);
        const double *v = body.inverse_inertia;
        const double full[9] = {v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5]};
        double product[9];
        tribo_mat3_multiply(inertia, full, product);
        const double least = fmin(moments[0], fmin(moments[1], moments[2]));
        const double most = fmax(moments[0], fmax(moments[1], moments[2]));
        for (int k = 0; k < 9; k++) {
            within(fabs(product[k] - (k % 4 ? 0.0 : 1.0)), 16.0 * EPS * most / least);
        }
        assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    }
    settle("I I^-1 = 1, 16 eps cond");
    tribo_body body;
    tribo_body_init(&body);
    assert_int_equal(
        tribo_body_set_mass(&body, 4.0, (const double[9]){0.5, 0, 0, 0, 0.25, 0, 0, 0, 0.5}),
        TRIBO_OK);
    static const double inverse[6] = {2.0, 0.0, 0.0, 4.0, 0.0, 2.0};
    assert_true(body.inverse_mass == 0.25);
    within(distance(body.inverse_inertia, inverse, 6), 0.0);
    settle("inverse of a diagonal, exact");
}

/* What the contract lets through: asymmetry of 1e-12, flat bodies, one moment as great as the sum
 * of the others. */
static void test_set_mass_accepts(void **state)
{
    static const double rows[][9] = {
        {1, 0, 0, 0, 1, 0, 0, 0, 2},
        {1, 0, 0, 0, 1, 0, 0, 0, 2.0 * (1.0 + 0.4e-9)},
        {1, 0.1, 0, 0.1 + 0.5e-12, 1, 0, 0, 0, 1},
        {1, 0, 0.2, 0, 1, 0.1, 0.2, 0.1 - 0.5e-12, 1},
        {1e-290, 0, 0, 0, 1e-290, 0, 0, 0, 1e-290},
        {1e290, 0, 0, 0, 1e290, 0, 0, 0, 1e290},
        {1e-9, 0, 0, 0, 1, 0, 0, 0, 1},
    };
    tribo_body body;
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tribo_body_init(&body);
        assert_int_equal(tribo_body_set_mass(&body, 1.0, rows[i]), TRIBO_OK);
    }
}

static void test_set_mass_refuses(void **state)
{
    static const struct {
        double mass;
        double inertia[9];
        tribo_status status;
    } rows[] = {
        {0.0, {1, 0, 0, 0, 1, 0, 0, 0, 1}, TRIBO_ERROR_MASS},
        {-0.0, {1, 0, 0, 0, 1, 0, 0, 0, 1}, TRIBO_ERROR_MASS},
        {-1.0, {1, 0, 0, 0, 1, 0, 0, 0, 1}, TRIBO_ERROR_MASS},
        {1e-310, {1, 0, 0, 0, 1, 0, 0, 0, 1}, TRIBO_ERROR_RANGE},
        {1.0, {1e-310, 0, 0, 0, 1e-310, 0, 0, 0, 1e-310}, TRIBO_ERROR_RANGE},
        {1.0, {1, 0.1, 0, 0.1 + 3e-12, 1, 0, 0, 0, 1}, TRIBO_ERROR_INERTIA},
        {1.0, {1, 0, 0.1, 0, 1, 0, -0.1, 0, 1}, TRIBO_ERROR_INERTIA},
        {1.0, {1, 0, 0, 0, 1, 0.1, 0, 0, 1}, TRIBO_ERROR_INERTIA},
        {1.0, {0, 0, 0, 0, 1, 0, 0, 0, 1}, TRIBO_ERROR_INERTIA},
        {1.0, {0, 0, 0, 0, 0, 0, 0, 0, 0}, TRIBO_ERROR_INERTIA},
        {1.0, {1, 0, 0, 0, 1, 0, 0, 0, -1}, TRIBO_ERROR_INERTIA},
        {1.0, {-1, 0, 0, 0, -1, 0, 0, 0, -1}, TRIBO_ERROR_INERTIA},
        {1.0, {1, 1.1, 0, 1.1, 1, 0, 0, 0, 1}, TRIBO_ERROR_INERTIA},
        /* each 2x2 minor is positive, the determinant is not: eigenvalues 1.6, 1.6, -0.2 */
        {1.0, {1, -0.6, -0.6, -0.6, 1, -0.6, -0.6, -0.6, 1}, TRIBO_ERROR_INERTIA},
        /* no body has a moment greater than the sum of the others */
        {1.0, {1, 0, 0, 0, 1, 0, 0, 0, 2.0 * (1.0 + 3e-9)}, TRIBO_ERROR_INERTIA},
        {1.0, {5, 0, 0, 0, 1, 0, 0, 0, 2}, TRIBO_ERROR_INERTIA},
        {1.0, {2, 1.5, 0, 1.5, 2, 0, 0, 0, 2}, TRIBO_ERROR_INERTIA}, /* 3.5, 0.5, 2 */
    };
    tribo_body body;
    tribo_body untouched;
    (void)state;
    memset(&body, 0xa5, sizeof body);
    untouched = body;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(tribo_body_set_mass(&body, rows[i].mass, rows[i].inertia), rows[i].status);
        assert_memory_equal(&body, &untouched, sizeof body);
    }
    static const double bad[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    for (int i = 0; i < 30; i++) {
        double input[10] = {1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
        input[i / 3] = bad[i % 3];
        assert_int_equal(tribo_body_set_mass(&body, input[0], input + 1), TRIBO_ERROR_NOT_FINITE);
        assert_memory_equal(&body, &untouched, sizeof body);
    }
    assert_int_equal(tribo_body_set_mass(&body, 1.0, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_set_mass(NULL, 1.0, rows[0].inertia), TRIBO_ERROR_NULL);
    assert_memory_equal(&body, &untouched, sizeof body);
}

/* A body as its 20 doubles, in the order of the struct. */
enum { ORIENTATION = 3, VELOCITY = 7, SPIN = 10, MASS = 13, INERTIA = 14, FIELDS = 20 };

static void set_field(tribo_body *body, size_t field, double value)
{
    memcpy((char *)body + field * sizeof value, &value, sizeof value);
}

static tribo_body plain_body(void)
{
    tribo_body body;
    tribo_body_init(&body);
    assert_int_equal(tribo_body_set_mass(&body, 2.0, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}),
                     TRIBO_OK);
    return body;
}

static const struct {
    size_t field;
    double value;
    tribo_status status;
} bad_bodies[] = {
    {ORIENTATION, 1.0 + 2e-6, TRIBO_ERROR_ORIENTATION},
    {ORIENTATION, 1.0 - 2e-6, TRIBO_ERROR_ORIENTATION},
    {ORIENTATION, 0.0, TRIBO_ERROR_ORIENTATION},
    {ORIENTATION + 2, 0.01, TRIBO_ERROR_ORIENTATION},
    {ORIENTATION, 1e300, TRIBO_ERROR_ORIENTATION},
    {MASS, -1e-300, TRIBO_ERROR_MASS},
    {MASS, -1.0, TRIBO_ERROR_MASS},
    {INERTIA, -1.0, TRIBO_ERROR_INERTIA},
    {INERTIA + 3, -1e-3, TRIBO_ERROR_INERTIA},
    {INERTIA + 5, -1e-300, TRIBO_ERROR_INERTIA},
    {INERTIA + 1, 1.0 + 1e-11, TRIBO_ERROR_INERTIA},
    {INERTIA + 2, -2.0, TRIBO_ERROR_INERTIA},
    {INERTIA + 4, 1e300, TRIBO_ERROR_INERTIA},
};

enum { BAD_BODIES = sizeof bad_bodies / sizeof bad_bodies[0] };

/* Every function that judges a body gives the status and writes nothing. */
static void refuse_body(const tribo_body *bad, tribo_status status)
{
    const double arm[3] = {1.0, 2.0, 3.0};
    tribo_body body;
    memset(canvas, 0xa5, sizeof canvas);
    assert_int_equal(tribo_body_check(bad), status);
    REFUSED(status, tribo_body_world_inverse_inertia(bad, canvas));
    REFUSED(status, tribo_body_spin(bad, canvas));
    memcpy(&body, bad, sizeof body);
    assert_int_equal(tribo_body_apply_impulse(&body, arm, arm), status);
    assert_memory_equal(&body, bad, sizeof body);
    assert_int_equal(tribo_body_advance(&body, arm, 0.01), status);
    assert_memory_equal(&body, bad, sizeof body);
}

static void test_bad_bodies(void **state)
{
    static const double bad[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    (void)state;
    for (size_t i = 0; i < BAD_BODIES; i++) {
        tribo_body body = plain_body();
        set_field(&body, bad_bodies[i].field, bad_bodies[i].value);
        refuse_body(&body, bad_bodies[i].status);
    }
    for (size_t field = 0; field < FIELDS; field++) {
        for (int i = 0; i < 3; i++) {
            tribo_body body = plain_body();
            set_field(&body, field, bad[i]);
            refuse_body(&body, TRIBO_ERROR_NOT_FINITE);
        }
    }
    /* three minors positive, determinant negative */
    tribo_body body = plain_body();
    body.inverse_inertia[1] = body.inverse_inertia[2] = body.inverse_inertia[4] = -0.6;
    refuse_body(&body, TRIBO_ERROR_INERTIA);
}

/* Semidefinite, so a body it is, but singular in another way than by zero rows: it has no spin. */
static void test_bodies_without_a_spin(void **state)
{
    tribo_body body = plain_body();
    (void)state;
    for (int i = 0; i < 6; i++) {
        body.inverse_inertia[i] = 1.0;
    }
    body.angular_velocity[1] = 2.0;
    const tribo_body start = body;
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    memset(canvas, 0xa5, sizeof canvas);
    REFUSED(TRIBO_ERROR_INERTIA, tribo_body_spin(&body, canvas));
    assert_int_equal(tribo_body_advance(&body, NULL, 0.1), TRIBO_ERROR_INERTIA);
    assert_memory_equal(&body, &start, sizeof body);
}

static void test_body_check_accepts(void **state)
{
    tribo_body body = plain_body();
    (void)state;
    body.orientation[0] = -1.0 - 0.9e-6;
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    body.orientation[0] = 1.0 - 0.9e-6;
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    body.inverse_mass = 0.0;
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    for (size_t i = 0; i < 6; i++) {
        body.inverse_inertia[i] = 1.0; /* rank 1 */
    }
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    memset(body.inverse_inertia, 0, sizeof body.inverse_inertia);
    body.inverse_inertia[5] = 3.0;
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
    /* eigenvalues 1.5, 1.5, -2e-14: semidefinite to 1e-12; -2e-11 is not */
    for (int i = 0; i < 2; i++) {
        const double off = -0.5 - (i ? 1e-11 : 1e-14);
        const double rows[6] = {1.0, off, off, 1.0, off, 1.0};
        memcpy(body.inverse_inertia, rows, sizeof rows);
        assert_int_equal(tribo_body_check(&body), i ? TRIBO_ERROR_INERTIA : TRIBO_OK);
    }
    memset(body.inverse_inertia, 0, sizeof body.inverse_inertia);
    assert_int_equal(tribo_body_check(&body), TRIBO_OK);
}

static void test_bad_arguments(void **state)
{
    static const double bad[3] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    const double one[3] = {1.0, 1.0, 1.0};
    tribo_body good = plain_body();
    tribo_body body = good;
    (void)state;
    good.angular_velocity[0] = body.angular_velocity[0] = 10.0;
    memset(canvas, 0xa5, sizeof canvas);
    assert_int_equal(tribo_body_check(NULL), TRIBO_ERROR_NULL);
    REFUSED(TRIBO_ERROR_NULL, tribo_body_world_inverse_inertia(NULL, canvas));
    assert_int_equal(tribo_body_world_inverse_inertia(&body, NULL), TRIBO_ERROR_NULL);
    REFUSED(TRIBO_ERROR_NULL, tribo_body_spin(NULL, canvas));
    assert_int_equal(tribo_body_spin(&body, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_apply_impulse(NULL, one, one), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_apply_impulse(&body, NULL, one), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_apply_impulse(&body, one, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_advance(NULL, one, 1.0), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_body_advance(&body, one, -1e-300), TRIBO_ERROR_TIME_STEP);
    assert_int_equal(tribo_body_advance(&body, NULL, -1.0), TRIBO_ERROR_TIME_STEP);
    assert_int_equal(tribo_body_advance(&body, NULL, 1.001e4), TRIBO_ERROR_TIME_STEP);
    assert_memory_equal(&body, &good, sizeof body);
    for (int i = 0; i < 9; i++) {
        double v[3] = {1.0, 1.0, 1.0};
        v[i / 3] = bad[i % 3];
        assert_int_equal(tribo_body_apply_impulse(&body, v, one), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_body_apply_impulse(&body, one, v), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_body_advance(&body, v, 1.0), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_body_advance(&body, one, bad[i % 3]), TRIBO_ERROR_NOT_FINITE);
        assert_memory_equal(&body, &good, sizeof body);
    }
}

static void test_results_out_of_range(void **state)
{
    const double huge[3] = {0.0, 1e308, 0.0};
    const double arm[3] = {1.0, 0.0, 0.0};
    const double far_arm[3] = {1e10, 0.0, 0.0};
    tribo_body body = plain_body();
    (void)state;
    body.inverse_mass = 4.0;
    tribo_body good = body;
    assert_int_equal(tribo_body_apply_impulse(&body, arm, huge), TRIBO_ERROR_RANGE);
    assert_memory_equal(&body, &good, sizeof body);
    body.inverse_mass = good.inverse_mass = 0.25;
    assert_int_equal(tribo_body_apply_impulse(&body, far_arm, huge), TRIBO_ERROR_RANGE);
    assert_memory_equal(&body, &good, sizeof body);
    assert_int_equal(tribo_body_advance(&body, huge, 10.0), TRIBO_ERROR_RANGE);
    assert_memory_equal(&body, &good, sizeof body);
    good.velocity[2] = body.velocity[2] = -1e308;
    assert_int_equal(tribo_body_advance(&body, NULL, 10.0), TRIBO_ERROR_RANGE);
    assert_memory_equal(&body, &good, sizeof body);
}

static void draw_body(problem_random *random, tribo_body *body)
{
    double q[4];
    double moments[3];
    double inertia[9];
    tribo_body_init(body);
    draw_moments(random, 0.5, moments);
    problem_random_direction(random, 4, q);
    if (problem_random_bits(random) % 2) {
        q[0] = 1.0;
        q[1] = q[2] = q[3] = 0.0;
    }
    turned_inertia(q, moments, inertia);
    assert_int_equal(tribo_body_set_mass(body, problem_random_decades(random, -2.0, 2.0), inertia),
                     TRIBO_OK);
    problem_random_direction(random, 4, body->orientation);
    for (int i = 0; i < 3; i++) {
        body->position[i] = problem_random_normal(random);
        body->velocity[i] = problem_random_normal(random);
        body->angular_velocity[i] = 3.0 * problem_random_normal(random);
    }
}

/* R A R^T in long double. */
static void long_world(const double q[4], const double a[6], long double out[9])
{
    const int at[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    long double r[9];
    long_rotation(q, r);
    for (int i = 0; i < 9; i++) {
        out[i] = 0.0L;
        for (int k = 0; k < 9; k++) {
            out[i] += r[3 * (i / 3) + k / 3] * (long double)a[at[k]] * r[3 * (i % 3) + k % 3];
        }
    }
}

static void test_world_inverse_inertia(void **state)
{
    const int at[6] = {0, 1, 2, 4, 5, 8};
    problem_random random;
    (void)state;
    problem_random_start(&random, 22, 0, 0);
    for (int i = 0; i < 20000; i++) {
        tribo_body body;
        double world[6];
        long double expected[9];
        draw_body(&random, &body);
        if (i % 2) { /* off unit length, still used as if normalised */
            for (int k = 0; k < 4; k++) {
                body.orientation[k] *= 1.0 + 0.9e-6;
            }
        }
        assert_int_equal(tribo_body_world_inverse_inertia(&body, world), TRIBO_OK);
        long_world(body.orientation, body.inverse_inertia, expected);
        const double *v = body.inverse_inertia;
        for (int k = 0; k < 6; k++) {
            within(fabs(world[k] - (double)expected[at[k]]), 16.0 * EPS * (v[0] + v[3] + v[5]));
        }
        /* L of the spin, taken back by the inverse inertia, is the angular velocity */
        double spin[3];
        double back[3];
        assert_int_equal(tribo_body_spin(&body, spin), TRIBO_OK);
        tribo_sym3_apply(world, spin, back);
        within(distance(back, body.angular_velocity, 3),
               400.0 * EPS * tribo_vec3_norm(body.angular_velocity));
    }
    settle("R I^-1 R^T, 16 eps; inertia and its inverse, 400 eps");
}

static void test_spin_of_locked_axes(void **state)
{
    tribo_body body = plain_body();
    double spin[3];
    (void)state;
    body.angular_velocity[0] = 2.0;
    body.angular_velocity[1] = 3.0;
    body.angular_velocity[2] = 5.0;
    memset(body.inverse_inertia, 0, sizeof body.inverse_inertia);
    assert_int_equal(tribo_body_spin(&body, spin), TRIBO_OK);
    assert_true(spin[0] == 0.0 && spin[1] == 0.0 && spin[2] == 0.0);
    body.inverse_inertia[3] = 0.25;
    assert_int_equal(tribo_body_spin(&body, spin), TRIBO_OK);
    assert_true(spin[0] == 0.0 && spin[1] == 12.0 && spin[2] == 0.0);
    /* x locked; y and z coupled: [2 1; 1 2]^-1 = [2 -1; -1 2] / 3 */
    body.inverse_inertia[3] = body.inverse_inertia[5] = 2.0;
    body.inverse_inertia[4] = 1.0;
    assert_int_equal(tribo_body_spin(&body, spin), TRIBO_OK);
    within(distance(spin, (const double[3]){0.0, 1.0 / 3.0, 7.0 / 3.0}, 3), 16.0 * EPS);
    settle("spin of a coupled block");
}

static void test_point_velocity(void **state)
{
    tribo_body body = plain_body();
    double out[3];
    static const double v[3] = {1.0, 2.0, 3.0};
    static const double w[3] = {4.0, -5.0, 6.0};
    (void)state;
    memcpy(body.velocity, v, sizeof v);
    memcpy(body.angular_velocity, w, sizeof w);
    tribo_body_point_velocity(&body, (const double[3]){-7.0, 8.0, 9.0}, out);
    /* w x r = (-45 - 48, -42 - 36, 32 - 35) */
    assert_true(out[0] == -92.0 && out[1] == -76.0 && out[2] == 0.0);
}

static void test_apply_impulse(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 23, 0, 0);
    for (int i = 0; i < 20000; i++) {
        tribo_body body;
        double arm[3];
        double p[3];
        long double inverse[9];
        draw_body(&random, &body);
        const tribo_body start = body;
        problem_random_direction(&random, 3, arm);
        problem_random_direction(&random, 3, p);
        assert_int_equal(tribo_body_apply_impulse(&body, arm, p), TRIBO_OK);
        long_world(body.orientation, body.inverse_inertia, inverse);
        long double torque[3];
        for (int k = 0; k < 3; k++) {
            const int l = (k + 1) % 3;
            const int m = (k + 2) % 3;
            torque[k] =
                (long double)arm[l] * (long double)p[m] - (long double)arm[m] * (long double)p[l];
        }
        for (int k = 0; k < 3; k++) {
            const long double v =
                (long double)start.velocity[k] + (long double)p[k] * (long double)body.inverse_mass;
            const long double turn = inverse[3 * k] * torque[0] + inverse[3 * k + 1] * torque[1] +
                                     inverse[3 * k + 2] * torque[2];
            const double trace = (double)(inverse[0] + inverse[4] + inverse[8]);
            within((double)fabsl(v - (long double)body.velocity[k]),
                   2.0 * EPS * (fabs(start.velocity[k]) + body.inverse_mass));
            within((double)fabsl((long double)start.angular_velocity[k] + turn -
                                 (long double)body.angular_velocity[k]),
                   16.0 * EPS * (trace + fabs(start.angular_velocity[k])));
        }
        assert_true(same_bits(start.position, body.position, 3));
        assert_true(same_bits(start.orientation, body.orientation, 4));
    }
    settle("v += p/m, 2 eps; omega += I^-1 (r x p), 16 eps");
    /* immovable: not a bit changes */
    tribo_body wall;
    tribo_body_init(&wall);
    wall.velocity[0] = -0.0;
    wall.angular_velocity[1] = -0.0;
    const tribo_body still = wall;
    assert_int_equal(
        tribo_body_apply_impulse(&wall, (const double[3]){1, 2, 3}, (const double[3]){-4, 5, -6}),
        TRIBO_OK);
    assert_memory_equal(&wall, &still, sizeof wall);
}

/* ---- free flight ----------------------------------------------------------------------------- */

/* Angular momentum R I R^T omega and kinetic energy of rotation, in long double. */
static double momentum_and_energy(const tribo_body *body, const double inertia[9], double l[3])
{
    long double r[9];
    long double w[3] = {0.0L, 0.0L, 0.0L};
    long double spin[3] = {0.0L, 0.0L, 0.0L};
    long double energy = 0.0L;
    long_rotation(body->orientation, r);
    for (int i = 0; i < 9; i++) {
        w[i % 3] += r[i] * (long double)body->angular_velocity[i / 3];
    }
    for (int i = 0; i < 9; i++) {
        spin[i / 3] += (long double)inertia[i] * w[i % 3];
    }
    for (int i = 0; i < 3; i++) {
        energy += 0.5L * spin[i] * w[i];
        l[i] = (double)(r[3 * i] * spin[0] + r[3 * i + 1] * spin[1] + r[3 * i + 2] * spin[2]);
    }
    return (double)energy;
}

static void body_frame_velocity(const tribo_body *body, double w[3])
{
    tribo_quat_rotate_inverse(body->orientation, body->angular_velocity, w);
}

static const double test_inertia[9] = {13.0 / 300.0, 0, 0, 0, 1.0 / 30.0, 0, 0, 0, 1.0 / 60.0};

static tribo_body spinning(const double inertia[9], double x, double y, double z)
{
    tribo_body body;
    tribo_body_init(&body);
    assert_int_equal(tribo_body_set_mass(&body, 1.0, inertia), TRIBO_OK);
    body.angular_velocity[0] = x;
    body.angular_velocity[1] = y;
    body.angular_velocity[2] = z;
    return body;
}

static void advance(tribo_body *body, double time, int steps)
{
    for (int i = 0; i < steps; i++) {
        assert_int_equal(tribo_body_advance(body, NULL, time / steps), TRIBO_OK);
    }
}

static const int step_counts[] = {1, 2, 7, 100, 300, 500, 5000};

enum { STEP_COUNTS = sizeof step_counts / sizeof step_counts[0] };

/* An eps for each step; the library takes steps of half a radian at most. */
static double rounding(int steps, double radians)
{
    return EPS * (16.0 + fmax((double)steps, 2.0 * radians));
}

/* Free rotation of the box of half-extents .1 .2 .3 m and 1 kg from (1, 2, 3) rad/s. Reference:
 * Euler's equations integrated to 20 digits. */
static void test_free_rotation_table(void **state)
{
    static const double at_five[3] = {0.28086194081460047, -2.4322669397127981, 2.7501014800339832};
    const double period = 3.6718473026523538;
    (void)state;
    for (int i = 0; i < STEP_COUNTS; i++) {
        tribo_body body = spinning(test_inertia, 1.0, 2.0, 3.0);
        double w[3];
        double l[3];
        within(fabs(momentum_and_energy(&body, test_inertia, l) - 0.16333333333333333), 1e-13);
        within(fabs(tribo_vec3_norm(l) - 0.093926685357369139), 1e-13);
        advance(&body, 5.0, step_counts[i]);
        body_frame_velocity(&body, w);
        within(distance(w, at_five, 3), 1e-12);
        within(fabs(momentum_and_energy(&body, test_inertia, l) - 0.16333333333333333), 1e-13);
        within(fabs(tribo_vec3_norm(l) - 0.093926685357369139), 1e-13);
        body = spinning(test_inertia, 1.0, 2.0, 3.0);
        advance(&body, period, step_counts[i]);
        body_frame_velocity(&body, w);
        within(distance(w, (const double[3]){1.0, 2.0, 3.0}, 3), 1e-12);
    }
    settle("omega(5), omega after a period, energy, |L|; 1 to 5000 steps; 1e-12");
}

/* About the middle axis: it flips after half a period, where w_y and w_z are reversed. |L|^2 and
 * 2 T I_yy differ by (0.05 / 5)^2 = 1e-4 of themselves, so a relative error in one of them counts
 * 1e4 * 0.05 = 500 times in omega. */
static void test_flips_about_the_middle_axis(void **state)
{
    const double period = 10.220304614326249;
    (void)state;
    for (int i = 0; i < STEP_COUNTS; i++) {
        tribo_body body = spinning(test_inertia, 0.05, 5.0, 0.05);
        double w[3];
        advance(&body, period, step_counts[i]);
        body_frame_velocity(&body, w);
        const double tolerance = 500.0 * rounding(step_counts[i], 5.0 * period);
        within(distance(w, (const double[3]){0.05, 5.0, 0.05}, 3), tolerance);
        body = spinning(test_inertia, 0.05, 5.0, 0.05);
        advance(&body, 0.5 * period, step_counts[i]);
        body_frame_velocity(&body, w);
        within(distance(w, (const double[3]){0.05, -5.0, -0.05}, 3), tolerance);
    }
    settle("period 10.2203046143 and the flip, 500 eps per step");
}

/* omega(t; s omega_0) = s omega(s t; omega_0): the table again, 4096 times faster. */
static void test_fast_rotation(void **state)
{
    static const double at_five[3] = {0.28086194081460047, -2.4322669397127981, 2.7501014800339832};
    (void)state;
    for (int i = 0; i < STEP_COUNTS; i++) {
        tribo_body body = spinning(test_inertia, 4096.0, 2 * 4096.0, 3 * 4096.0);
        double w[3];
        advance(&body, 5.0 / 4096.0, step_counts[i]);
        body_frame_velocity(&body, w);
        tribo_vec3_scale(1.0 / 4096.0, w, w);
        within(distance(w, at_five, 3), 1e-12);
    }
    settle("the same at 15 000 rad/s, 1e-12");
}

static void check_drift(tribo_body body, const double inertia[9], double dt, int steps)
{
    double l0[3];
    double l[3];
    const double energy = momentum_and_energy(&body, inertia, l0);
    const double size = tribo_vec3_norm(l0);
    for (int i = 1; i <= steps; i++) {
        assert_int_equal(tribo_body_advance(&body, NULL, dt), TRIBO_OK);
        if (i % 100 == 0 || i == steps) {
            const double drift = EPS * (16.0 + i);
            within(fabs(momentum_and_energy(&body, inertia, l) / energy - 1.0), drift);
            within(fabs(tribo_vec3_norm(l) / size - 1.0), drift);
            within(distance(l, l0, 3) / size, drift); /* its direction too */
        }
    }
    double norm = 0.0;
    for (int k = 0; k < 4; k++) {
        norm += body.orientation[k] * body.orientation[k];
    }
    within(fabs(norm - 1.0), 8.0 * EPS);
}

/* Box of .1 x .25 x .5 m, 100 s at 60 Hz. Asked: 1e-6. Held: one eps per step, so 1.3e-12. */
static void test_drift_over_100_seconds(void **state)
{
    static const double speeds[] = {2.0, 5.0, 10.0, 20.0};
    double mass;
    double inertia[9];
    (void)state;
    assert_int_equal(tribo_mass_box(1000.0, (const double[3]){0.05, 0.125, 0.25}, &mass, inertia),
                     TRIBO_OK);
    for (size_t i = 0; i < 4; i++) {
        const double w = speeds[i];
        check_drift(spinning(inertia, 1e-3 * w, w, 1e-3 * w), inertia, 1.0 / 60.0, 6000);
        check_drift(spinning(inertia, 0.01, w, 0.0), inertia, 1.0 / 60.0, 6000);
        check_drift(spinning(inertia, w, w, w), inertia, 1.0 / 60.0, 6000);
    }
    settle("energy, |L| and direction of L over 100 s, one eps per step");
    check_drift(spinning(inertia, 10.0, 1e4, 10.0), inertia, 1.0 / 60.0, 100);
    check_drift(spinning(test_inertia, 6e3, 6e3, 6e3), test_inertia, 1.0 / 240.0, 400);
    settle("the same at 1e4 rad/s, eps per step");
}

/* I_1 = I_2: R(t) = exp(t L / I_1) R_0 exp(t (1 - I_3/I_1) w_3 e_3). */
static void test_symmetric_top(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 24, 0, 0);
    for (int i = 0; i < 400; i++) {
        const double i1 = problem_random_uniform(&random, 0.5, 2.0);
        const double i3 = problem_random_uniform(&random, 0.1, 1.9) * i1;
        const double inertia[9] = {i1, 0, 0, 0, i1, 0, 0, 0, i3};
        tribo_body body = spinning(inertia, problem_random_normal(&random),
                                   problem_random_normal(&random), problem_random_normal(&random));
        problem_random_direction(&random, 4, body.orientation);
        const tribo_body start = body;
        const double time = problem_random_uniform(&random, 0.1, 10.0);
        double l[3];
        double w[3];
        double about_l[4];
        double about_axis[4];
        double expected[4];
        momentum_and_energy(&body, inertia, l);
        tribo_vec3_scale(time / i1, l, l);
        body_frame_velocity(&body, w);
        const double axis[3] = {0.0, 0.0, time * (1.0 - i3 / i1) * w[2]};
        assert_int_equal(tribo_quat_from_rotation_vector(l, about_l), TRIBO_OK);
        assert_int_equal(tribo_quat_from_rotation_vector(axis, about_axis), TRIBO_OK);
        tribo_quat_multiply(start.orientation, about_axis, expected);
        tribo_quat_multiply(about_l, expected, expected);
        advance(&body, time, i % 2 ? 1 : 50);
        within(tribo_quat_angle(body.orientation, expected), 1e-13);
        double turned[3];
        body_frame_velocity(&body, turned);
        within(fabs(turned[2] - w[2]), 1e-13);
    }
    settle("symmetric top against its closed form, 1e-13");
}

/* State (q, omega in body axes) and Euler's equations, for a reference by Runge-Kutta. */
static void euler(const long double inertia[3], const long double y[7], long double dy[7])
{
    const long double *w = y + 4;
    dy[0] = -0.5L * (y[1] * w[0] + y[2] * w[1] + y[3] * w[2]);
    dy[1] = 0.5L * (y[0] * w[0] + y[2] * w[2] - y[3] * w[1]);
    dy[2] = 0.5L * (y[0] * w[1] + y[3] * w[0] - y[1] * w[2]);
    dy[3] = 0.5L * (y[0] * w[2] + y[1] * w[1] - y[2] * w[0]);
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3;
        const int l = (i + 2) % 3;
        dy[4 + i] = (inertia[k] - inertia[l]) / inertia[i] * w[k] * w[l];
    }
}

static void runge_kutta(const long double inertia[3], long double y[7], long double h, int steps)
{
    for (int n = 0; n < steps; n++) {
        long double k[4][7];
        long double z[7];
        euler(inertia, y, k[0]);
        for (int s = 1; s < 4; s++) {
            for (int i = 0; i < 7; i++) {
                z[i] = y[i] + (s == 3 ? h : 0.5L * h) * k[s - 1][i];
            }
            euler(inertia, z, k[s]);
        }
        for (int i = 0; i < 7; i++) {
            y[i] += h / 6.0L * (k[0][i] + 2.0L * k[1][i] + 2.0L * k[2][i] + k[3][i]);
        }
    }
}

/* Two runs of 4th order, extrapolated: error about 1e-15. */
static void reference_flight(const double moments[3], const tribo_body *start, double time,
                             double q[4], double w[3])
{
    const int steps = 1000;
    long double y[2][7];
    long double inertia[3];
    double body_w[3];
    body_frame_velocity(start, body_w);
    for (int run = 0; run < 2; run++) {
        for (int i = 0; i < 7; i++) {
            y[run][i] = (long double)(i < 4 ? start->orientation[i] : body_w[i - 4]);
        }
        for (int i = 0; i < 3; i++) {
            inertia[i] = (long double)moments[i];
        }
        const int n = steps << run;
        runge_kutta(inertia, y[run], (long double)time / n, n);
    }
    for (int i = 0; i < 7; i++) {
        const double value = (double)(y[1][i] + (y[1][i] - y[0][i]) / 15.0L);
        *(i < 4 ? &q[i] : &w[i - 4]) = value;
    }
    tribo_quat_rotate(q, w, w);
}

static void test_random_flights(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 25, 0, 0);
    for (int i = 0; i < 300; i++) {
        double moments[3];
        double q[4];
        double w[3];
        draw_moments(&random, 0.5, moments);
        const double inertia[9] = {moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2]};
        tribo_body body = spinning(inertia, problem_random_normal(&random),
                                   problem_random_normal(&random), problem_random_normal(&random));
        problem_random_direction(&random, 4, body.orientation);
        const double time = problem_random_uniform(&random, 0.0, 2.0);
        reference_flight(moments, &body, time, q, w);
        advance(&body, time, 1 + i % 9);
        within(tribo_quat_angle(body.orientation, q), 1e-13);
        within(distance(body.angular_velocity, w, 3), 1e-13);
    }
    settle("random bodies against Runge-Kutta in long double, 1e-13");
}

/* The same body in turned body axes flies the same: inertia with products. */
static void test_products_of_inertia(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 26, 0, 0);
    for (int i = 0; i < 300; i++) {
        double moments[3];
        double q[4];
        double turned[9];
        double back[4];
        draw_moments(&random, 0.3, moments);
        const double inertia[9] = {moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2]};
        tribo_body body = spinning(inertia, 1.0, problem_random_normal(&random), 2.0);
        problem_random_direction(&random, 4, q);
        turned_inertia(q, moments, turned);
        tribo_body twin = spinning(turned, 1.0, body.angular_velocity[1], 2.0);
        /* body axes = Q principal axes, so the twin's orientation is Q^-1 */
        tribo_quat_conjugate(q, twin.orientation);
        advance(&body, 3.0, 20);
        advance(&twin, 3.0, 20);
        tribo_quat_multiply(twin.orientation, q, back);
        within(tribo_quat_angle(body.orientation, back), 1e-13);
        within(distance(body.angular_velocity, twin.angular_velocity, 3), 1e-13);
    }
    settle("inertia with products, 1e-13");
}

/* There is no time-step error: one step of 100 s is as good as 5000. Rounding of the energy changes
 * the rate, so the phase is off by |omega| t = 374 times that. Reference: Jacobi's elliptic
 * functions to 40 digits. */
static void test_one_big_step(void **state)
{
    static const double at_hundred[3] = {1.3720842116810151, -1.4711086382031172,
                                         3.2213164282561761};
    (void)state;
    for (int i = 0; i < STEP_COUNTS; i++) {
        tribo_body body = spinning(test_inertia, 1.0, 2.0, 3.0);
        double w[3];
        advance(&body, 100.0, step_counts[i]);
        body_frame_velocity(&body, w);
        within(distance(w, at_hundred, 3), 374.0 * rounding(step_counts[i], 374.0));
    }
    settle("omega(100) in 1 to 5000 steps, 374 eps per step");
    tribo_body body = spinning(test_inertia, 1.0, 2.0, 3.0);
    double l0[3];
    double l[3];
    const double energy = momentum_and_energy(&body, test_inertia, l0);
    advance(&body, 26000.0, 1);
    const double tolerance = rounding(1, 97300.0);
    within(fabs(momentum_and_energy(&body, test_inertia, l) / energy - 1.0), tolerance);
    within(distance(l, l0, 3) / tribo_vec3_norm(l0), tolerance);
    settle("one step of 97 000 radians, an eps per half radian");
}

static void test_parabola_is_exact(void **state)
{
    tribo_body body = plain_body();
    static const double v[3] = {3.0, -1.5, 8.0};
    static const double g[3] = {0.5, 0.0, -9.75};
    (void)state;
    memcpy(body.velocity, v, sizeof v);
    for (int i = 1; i <= 640; i++) {
        assert_int_equal(tribo_body_advance(&body, g, 0x1p-6), TRIBO_OK);
        const double t = i * 0x1p-6;
        for (int k = 0; k < 3; k++) {
            assert_true(body.velocity[k] == v[k] + g[k] * t);
            assert_true(body.position[k] == v[k] * t + 0.5 * g[k] * t * t);
        }
    }
    problem_random random;
    problem_random_start(&random, 27, 0, 0);
    for (int i = 0; i < 20000; i++) {
        tribo_body a;
        double acceleration[3];
        draw_body(&random, &a);
        const tribo_body start = a;
        const double t = problem_random_decades(&random, -6.0, 1.0);
        for (int k = 0; k < 3; k++) {
            acceleration[k] = 10.0 * problem_random_normal(&random);
        }
        assert_int_equal(tribo_body_advance(&a, acceleration, t), TRIBO_OK);
        for (int k = 0; k < 3; k++) {
            const long double lt = (long double)t;
            const long double x0 = (long double)start.position[k];
            const long double v0 = (long double)start.velocity[k];
            const long double g0 = (long double)acceleration[k];
            const double x_scale = fabs(start.position[k]) + fabs(start.velocity[k]) * t +
                                   0.5 * fabs(acceleration[k]) * t * t;
            const double v_scale = fabs(start.velocity[k]) + fabs(acceleration[k]) * t;
            within((double)fabsl((long double)a.position[k] - (x0 + lt * (v0 + 0.5L * g0 * lt))),
                   4.0 * EPS * x_scale);
            within((double)fabsl((long double)a.velocity[k] - (v0 + g0 * lt)), 2.0 * EPS * v_scale);
        }
    }
    settle("parabola, 4 eps");
}

static void test_kinematic_body(void **state)
{
    static const double gravity[3] = {0.0, 0.0, -9.81};
    static const double v[3] = {1.0, 2.0, -3.0};
    static const double w[3] = {0.3, -0.2, 0.7};
    tribo_body body;
    double turn[4];
    double vector[3];
    (void)state;
    tribo_body_init(&body);
    memcpy(body.velocity, v, sizeof v);
    memcpy(body.angular_velocity, w, sizeof w);
    for (int i = 0; i < 64; i++) {
        assert_int_equal(tribo_body_advance(&body, gravity, 0x1p-4), TRIBO_OK);
    }
    assert_true(same_bits(body.velocity, v, 3));
    within(distance(body.angular_velocity, w, 3), 64 * EPS);
    within(distance(body.position, (const double[3]){4.0, 8.0, -12.0}, 3), 64 * EPS);
    tribo_vec3_scale(4.0, w, vector);
    assert_int_equal(tribo_quat_from_rotation_vector(vector, turn), TRIBO_OK);
    within(tribo_quat_angle(body.orientation, turn), 64 * EPS);
    settle("kinematic body, eps per step");
}

/* Locked axes, and balls: the angular velocity stays; the pose turns by omega dt. */
static void test_constant_angular_velocity(void **state)
{
    static const double locked[][6] = {
        {0, 0, 0, 1, 0, 2},
        {3, 0, 0, 0, 0, 0},
        {2, 0, 0, 2, 0, 0},
        {0.5, 0, 0, 0.5, 0, 0.5},
    };
    (void)state;
    for (size_t i = 0; i < sizeof locked / sizeof locked[0]; i++) {
        tribo_body body = plain_body();
        static const double w[3] = {1.0, -2.0, 0.5};
        double turn[4];
        double vector[3];
        memcpy(body.inverse_inertia, locked[i], sizeof locked[i]);
        memcpy(body.angular_velocity, w, sizeof w);
        for (int k = 0; k < 64; k++) {
            assert_int_equal(tribo_body_advance(&body, NULL, 0x1p-4), TRIBO_OK);
        }
        within(distance(body.angular_velocity, w, 3), 64 * EPS);
        tribo_vec3_scale(4.0, w, vector);
        assert_int_equal(tribo_quat_from_rotation_vector(vector, turn), TRIBO_OK);
        within(tribo_quat_angle(body.orientation, turn), 64 * EPS);
    }
    settle("constant angular velocity, eps per step");
}

static void test_nothing_moves_in_no_time(void **state)
{
    tribo_body body = spinning(test_inertia, 1.0, 2.0, 3.0);
    (void)state;
    body.velocity[1] = 4.0;
    body.position[2] = -7.0;
    const tribo_body start = body;
    assert_int_equal(tribo_body_advance(&body, (const double[3]){0.0, 0.0, -9.81}, 0.0), TRIBO_OK);
    assert_memory_equal(&body, &start, sizeof body);
}

/* The orientation is used as if normalised. */
static void test_long_orientation(void **state)
{
    tribo_body body = spinning(test_inertia, 1.0, 2.0, 3.0);
    tribo_body twin = body;
    (void)state;
    twin.orientation[0] = 1.0 + 0.9e-6;
    advance(&body, 1.0, 3);
    advance(&twin, 1.0, 3);
    within(tribo_quat_angle(body.orientation, twin.orientation), 16 * EPS);
    within(distance(body.angular_velocity, twin.angular_velocity, 3), 32 * EPS);
    settle("orientation off unit length, 32 eps");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_mass_against_quadrature),
        TEST(test_mass_by_hand),
        TEST(test_mass_of_the_test_body),
        TEST(test_bad_shapes),
        TEST(test_init),
        TEST(test_set_mass_inverts),
        TEST(test_set_mass_accepts),
        TEST(test_set_mass_refuses),
        TEST(test_bad_bodies),
        TEST(test_bodies_without_a_spin),
        TEST(test_body_check_accepts),
        TEST(test_bad_arguments),
        TEST(test_results_out_of_range),
        TEST(test_world_inverse_inertia),
        TEST(test_spin_of_locked_axes),
        TEST(test_point_velocity),
        TEST(test_apply_impulse),
        TEST(test_free_rotation_table),
        TEST(test_flips_about_the_middle_axis),
        TEST(test_fast_rotation),
        TEST(test_drift_over_100_seconds),
        TEST(test_symmetric_top),
        TEST(test_random_flights),
        TEST(test_products_of_inertia),
        TEST(test_one_big_step),
        TEST(test_parabola_is_exact),
        TEST(test_kinematic_body),
        TEST(test_constant_angular_velocity),
        TEST(test_nothing_moves_in_no_time),
        TEST(test_long_orientation),
    };
    return cmocka_run_group_tests_name("body", tests, NULL, NULL);
}
