/* Properties of include/tribo/body.h. */
#include <math.h>
#include <string.h>

#include "support/reference.h"

static long double wide(double x)
{
    return (long double)x;
}

static void expand(const double s[6], double m[9])
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; i++) {
        m[i] = s[full[i]];
    }
}

/* ---- mass properties ---------------------------------------------------------------------- */

enum { SPHERE, BOX, CAPSULE, CYLINDER, ELLIPSOID, SHAPES };

static const uint32_t length_count[SHAPES] = {1, 3, 2, 2, 3};

static tribo_status mass_of(uint32_t shape, double density, const double *lengths, double *mass,
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

/* Second moments of mass of a box-like solid: m k (y^2 + z^2), ... */
static void solid(long double m, long double k, const long double x[3], long double out[4])
{
    out[0] = m;
    out[1] = m * k * (x[1] * x[1] + x[2] * x[2]);
    out[2] = m * k * (x[2] * x[2] + x[0] * x[0]);
    out[3] = m * k * (x[0] * x[0] + x[1] * x[1]);
}

/* A tube of half-length h and two half-balls whose centres of mass are 3/8 r beyond it. */
static void capsule(long double rho, long double r, long double h, long double out[4])
{
    const long double pi = 3.141592653589793238462643383279502884L;
    const long double tube = rho * pi * r * r * 2.0L * h;
    const long double ball = rho * pi * 4.0L / 3.0L * r * r * r;
    const long double off = h + 3.0L / 8.0L * r;
    const long double about_own_centre = 0.4L * r * r - 9.0L / 64.0L * r * r;
    out[0] = tube + ball;
    out[1] = tube * (r * r / 4.0L + h * h / 3.0L) + ball * (about_own_centre + off * off);
    out[2] = out[1];
    out[3] = tube * r * r / 2.0L + ball * 0.4L * r * r;
}

static void mass_reference(uint32_t shape, double density, const double *lengths,
                           long double out[4])
{
    const long double pi = 3.141592653589793238462643383279502884L;
    const long double rho = wide(density);
    const long double r = wide(lengths[0]);
    const long double h = wide(lengths[1]);
    long double x[3] = {r, h, wide(lengths[2])};
    if (shape == SPHERE) {
        x[1] = x[2] = r;
    }
    switch (shape) {
    case BOX:
        solid(8.0L * rho * x[0] * x[1] * x[2], 1.0L / 3.0L, x, out);
        break;
    case CAPSULE:
        capsule(rho, r, h, out);
        break;
    case CYLINDER:
        out[0] = rho * pi * r * r * 2.0L * h;
        out[1] = out[2] = out[0] * (r * r / 4.0L + h * h / 3.0L);
        out[3] = out[0] * r * r / 2.0L;
        break;
    default:
        solid(4.0L / 3.0L * pi * rho * x[0] * x[1] * x[2], 0.2L, x, out);
        break;
    }
}

static void mass_formula(property_trial *t)
{
    double lengths[3];
    double mass;
    double inertia[9];
    long double want[4];
    tribo_body body;
    const uint32_t shape = make_choice(t, "shape", SHAPES);
    const double density = make_positive(t, "density", -60, 60);
    for (int i = 0; i < 3; i++) {
        lengths[i] = make_positive(t, "length", -60, 60);
    }
    REQUIRE_STATUS(t, mass_of(shape, density, lengths, &mass, inertia), TRIBO_OK);
    mass_reference(shape, density, lengths, want);
    REQUIRE_NEAR(t, mass, want[0], 8.0L * wide(EPS) * want[0]);
    for (int i = 0; i < 9; i++) {
        const long double entry = i % 4 == 0 ? want[1 + i / 4] : 0.0L;
        REQUIRE_NEAR(t, inertia[i], entry, 8.0L * wide(EPS) * entry);
    }
    REQUIRE(t, mass > 0.0 && inertia[0] > 0.0 && inertia[4] > 0.0 && inertia[8] > 0.0);
    REQUIRE_AT_MOST(t, inertia[0], (inertia[4] + inertia[8]) * (1.0 + 8.0 * EPS));
    REQUIRE_AT_MOST(t, inertia[4], (inertia[8] + inertia[0]) * (1.0 + 8.0 * EPS));
    REQUIRE_AT_MOST(t, inertia[8], (inertia[0] + inertia[4]) * (1.0 + 8.0 * EPS));
    REQUIRE_STATUS(t, tribo_body_init(&body), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_body_set_mass(&body, mass, inertia), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
}

/* A capsule without length is a ball; an ellipsoid of equal axes too; doubling the density
 * doubles all. */
static void mass_limits(property_trial *t)
{
    double mass[2];
    double inertia[2][9];
    const double density = make_positive(t, "density", -20, 20);
    const double r = make_positive(t, "radius", -20, 20);
    const double h = ldexp(r, -1 - make_byte(t) % 60);
    const double axes[3] = {r, r, r};
    REQUIRE_STATUS(t, tribo_mass_sphere(density, r, &mass[0], inertia[0]), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_mass_ellipsoid(density, axes, &mass[1], inertia[1]), TRIBO_OK);
    REQUIRE_NEAR(t, mass[1], mass[0], 4.0 * EPS * mass[0]);
    REQUIRE_NEAR(t, inertia[1][0], inertia[0][0], 4.0 * EPS * inertia[0][0]);
    REQUIRE_STATUS(t, tribo_mass_capsule(density, r, h, &mass[1], inertia[1]), TRIBO_OK);
    /* m(h)/m(0) = 1 + 3h/2r; I(h)/I(0) <= 1 + 15/4 h/r + ... */
    const double slack = 8.0 * h / r + 8.0 * EPS;
    for (int i = 0; i < 9; i += 4) {
        REQUIRE(t, inertia[1][i] >= inertia[0][i] * (1.0 - 8.0 * EPS));
        REQUIRE_NEAR(t, inertia[1][i], inertia[0][i], slack * inertia[0][i]);
    }
    REQUIRE_NEAR(t, mass[1], mass[0] * (1.0 + 1.5 * h / r), 8.0 * EPS * mass[1]);
    REQUIRE_STATUS(t, tribo_mass_capsule(2.0 * density, r, h, &mass[0], inertia[0]), TRIBO_OK);
    REQUIRE(t, mass[0] == 2.0 * mass[1] && inertia[0][0] == 2.0 * inertia[1][0]);
}

static void mass_wild(property_trial *t)
{
    double values[4]; /* lengths, density */
    double out[10];
    const uint32_t shape = make_choice(t, "shape", SHAPES);
    const uint32_t count = length_count[shape];
    int finite = 1;
    int positive = 1;
    for (uint32_t i = 0; i < 4; i++) {
        values[i] = make_any(t, "value");
        if (make_byte(t) % 4 != 0) {
            values[i] = fabs(values[i]);
        }
        if (i < count || i == 3) {
            finite = finite && isfinite(values[i]);
            positive = positive && values[i] > 0.0;
        }
    }
    canary_set(out, sizeof out);
    const tribo_status status = mass_of(shape, values[3], values, out, out + 1);
    if (status != TRIBO_OK) {
        REQUIRE(t, canary_kept(out, sizeof out));
    }
    if (!finite || !positive) {
        REQUIRE(t, (status == TRIBO_ERROR_SHAPE && !positive) ||
                       (status == TRIBO_ERROR_NOT_FINITE && !finite));
        return;
    }
    REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_RANGE);
    for (int i = 0; i < 10 && status == TRIBO_OK; i++) {
        REQUIRE(t, i % 4 == 1 || i == 0 ? out[i] > 0.0 && isfinite(out[i]) : out[i] == 0.0);
    }
}

static void mass_null(property_trial *t)
{
    double out[10];
    const uint32_t shape = make_choice(t, "shape", SHAPES);
    const double density = make_any(t, "density");
    const double lengths[3] = {1, 1, 1};
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, mass_of(shape, density, lengths, NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, mass_of(shape, density, lengths, out, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_mass_box(density, NULL, out, out + 1), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_mass_ellipsoid(density, NULL, out, out + 1), TRIBO_ERROR_NULL);
    REQUIRE(t, canary_kept(out, sizeof out));
}

/* ---- setting mass ------------------------------------------------------------------------- */

/* Inertia of a possible body, from second moments of mass along principal axes that are turned
 * by q. */
static void make_inertia(property_trial *t, int range, double moments[3], double inertia[9])
{
    double q[4];
    double p[3];
    long double r[9];
    for (int i = 0; i < 3; i++) {
        p[i] = make_positive(t, "second moment", -range, 0);
    }
    for (int i = 0; i < 3; i++) {
        moments[i] = p[(i + 1) % 3] + p[(i + 2) % 3];
    }
    make_quat(t, "principal axes", q);
    reference_rotation(q, r);
    for (int i = 0; i < 9; i++) {
        long double sum = 0.0L;
        for (int k = 0; k < 3; k++) {
            const int row = i / 3 < i % 3 ? i / 3 : i % 3;
            const int column = i / 3 < i % 3 ? i % 3 : i / 3;
            sum += r[3 * row + k] * wide(moments[k]) * r[3 * column + k];
        }
        inertia[i] = (double)sum;
    }
    property_note(t, "moments", moments, 3);
}

static double greatest(const double v[3])
{
    const double most = v[0] > v[1] ? v[0] : v[1];
    return most > v[2] ? most : v[2];
}

static double least(const double v[3])
{
    const double few = v[0] < v[1] ? v[0] : v[1];
    return few < v[2] ? few : v[2];
}

static void set_mass(property_trial *t)
{
    double half[3];
    double moments[3];
    double inertia[9];
    double inverse[9];
    tribo_body body;
    make_body(t, "before", BODY_ANY, &body, half);
    const tribo_body before = body;
    const double mass = make_positive(t, "mass", -100, 100);
    make_inertia(t, 20, moments, inertia);
    REQUIRE_STATUS(t, tribo_body_set_mass(&body, mass, inertia), TRIBO_OK);
    REQUIRE_SAME(t, &body, &before, offsetof(tribo_body, inverse_mass));
    REQUIRE_NEAR(t, body.inverse_mass * mass, 1.0, EPS);
    expand(body.inverse_inertia, inverse);
    const double condition = greatest(moments) / least(moments);
    for (int i = 0; i < 9; i++) {
        long double sum = i % 4 == 0 ? -1.0L : 0.0L;
        for (int k = 0; k < 3; k++) {
            sum += wide(inverse[i - i % 3 + k]) * wide(inertia[3 * k + i % 3]);
        }
        REQUIRE_NEAR(t, sum, 0.0, 16.0 * EPS * condition);
    }
    REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
}

/* An inertia that no body has, or a bad mass: a status, and nothing changes. */
static void set_mass_bad(property_trial *t)
{
    double half[3];
    double moments[3];
    double inertia[9];
    tribo_body body;
    tribo_status expected = TRIBO_ERROR_INERTIA;
    make_body(t, "before", BODY_ANY, &body, half);
    const tribo_body before = body;
    double mass = make_positive(t, "mass", -100, 100);
    make_inertia(t, 20, moments, inertia);
    const uint32_t kind = make_choice(t, "kind", 6);
    const double size = make_positive(t, "size", -20, 20);
    const uint32_t axis = make_choice(t, "axis", 3);
    switch (kind) {
    case 0: /* asymmetric */
        inertia[axis + 1] += (1e-9 + size) * greatest(moments);
        break;
    case 1: /* not positive definite */
        inertia[4 * axis] -= (1.0 + size) * greatest(moments);
        break;
    case 2: /* one moment exceeds the sum of the others */
        memset(inertia, 0, sizeof inertia);
        inertia[4 * axis] = (moments[0] + moments[1]) * (1.0 + 1e-6 + size);
        inertia[(4 * axis + 4) % 12] = moments[0];
        inertia[(4 * axis + 8) % 12] = moments[1];
        break;
    case 3:
        mass = make_choice(t, "zero", 2) == 0 ? -mass : 0.0;
        expected = TRIBO_ERROR_MASS;
        break;
    case 4:
        inertia[make_choice(t, "entry", 9)] = make_hostile(t, "value");
        expected = TRIBO_ERROR_NOT_FINITE;
        break;
    default:
        mass = make_hostile(t, "mass");
        expected = TRIBO_ERROR_NOT_FINITE;
        break;
    }
    property_note(t, "inertia", inertia, 9);
    REQUIRE_STATUS(t, tribo_body_set_mass(&body, mass, inertia), expected);
    REQUIRE_STATUS(t, tribo_body_set_mass(&body, mass, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_set_mass(NULL, mass, inertia), TRIBO_ERROR_NULL);
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

/* Any nine numbers: a body that passes the check, or a named status and nothing changes. */
static void set_mass_wild(property_trial *t)
{
    double inertia[9];
    tribo_body body;
    REQUIRE_STATUS(t, tribo_body_init(&body), TRIBO_OK);
    const tribo_body before = body;
    const double mass = make_any(t, "mass");
    int finite = isfinite(mass);
    for (int i = 0; i < 9; i++) {
        inertia[i] = make_any(t, NULL);
    }
    if (make_choice(t, "symmetric", 4) != 0) {
        inertia[3] = inertia[1];
        inertia[6] = inertia[2];
        inertia[7] = inertia[5];
    }
    if (make_choice(t, "diagonal", 2) != 0) {
        for (int i = 1; i < 9; i++) {
            inertia[i] = i % 4 == 0 ? fabs(inertia[i]) : 0.0;
        }
    }
    property_note(t, "inertia", inertia, 9);
    for (int i = 0; i < 9; i++) {
        finite = finite && isfinite(inertia[i]);
    }
    const tribo_status status = tribo_body_set_mass(&body, mass, inertia);
    if (status == TRIBO_OK) {
        REQUIRE(t, finite && mass > 0.0 && body.inverse_mass > 0.0);
        REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
        return;
    }
    REQUIRE_SAME(t, &body, &before, sizeof body);
    REQUIRE(t, (status == TRIBO_ERROR_NOT_FINITE && !finite) ||
                   (status == TRIBO_ERROR_MASS && mass <= 0.0) || status == TRIBO_ERROR_INERTIA ||
                   status == TRIBO_ERROR_RANGE);
}

/* ---- judging ------------------------------------------------------------------------------ */

static void init(property_trial *t)
{
    tribo_body body;
    tribo_body want;
    const size_t fields = sizeof body / sizeof(double);
    double *field = (double *)&body;
    for (size_t i = 0; i < fields; i++) {
        field[i] = make_any(t, NULL);
    }
    memset(&want, 0, sizeof want);
    want.orientation[0] = 1.0;
    REQUIRE_STATUS(t, tribo_body_init(&body), TRIBO_OK);
    REQUIRE_SAME(t, &body, &want, sizeof body);
    REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_body_init(NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_check(NULL), TRIBO_ERROR_NULL);
}

static void check_valid(property_trial *t)
{
    double half[3];
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
}

static void stretch_orientation(property_trial *t, tribo_body *body)
{
    const double off = 2e-6 + make_positive(t, "off", -18, 8);
    const double factor = make_choice(t, "shorter", 2) == 1 ? 1.0 / (1.0 + off) : 1.0 + off;
    for (int i = 0; i < 4; i++) {
        body->orientation[i] *= factor;
    }
}

/* One eigenvalue is negative by more than 1e-9 of the greatest. */
static void make_indefinite(property_trial *t, tribo_body *body)
{
    double values[3];
    for (int i = 0; i < 6; i++) {
        body->inverse_inertia[i] = make_real(t, NULL, -6, 6);
    }
    reference_eigenvalues(body->inverse_inertia, values);
    const double lift = values[0] + 1e-9 * fabs(values[2]) + make_positive(t, NULL, -20, 0);
    body->inverse_inertia[0] -= lift;
    body->inverse_inertia[3] -= lift;
    body->inverse_inertia[5] -= lift;
    property_note(t, "inverse_inertia", body->inverse_inertia, 6);
}

/* Each function that judges a body names the fault, and touches nothing. */
static void bad_body(property_trial *t)
{
    double half[3];
    double out[6];
    tribo_body body;
    tribo_status expected = TRIBO_ERROR_NOT_FINITE;
    static const double arm[3] = {1, 2, 3};
    make_body(t, "body", BODY_ANY, &body, half);
    switch (make_choice(t, "kind", 4)) {
    case 0:
        ((double *)&body)[make_choice(t, "field", 20)] = make_hostile(t, "value");
        break;
    case 1:
        stretch_orientation(t, &body);
        expected = TRIBO_ERROR_ORIENTATION;
        break;
    case 2:
        body.inverse_mass = -make_positive(t, "mass", -1000, 1000);
        expected = TRIBO_ERROR_MASS;
        break;
    default:
        make_indefinite(t, &body);
        expected = TRIBO_ERROR_INERTIA;
        break;
    }
    const tribo_body before = body;
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, tribo_body_check(&body), expected);
    REQUIRE_STATUS(t, tribo_body_world_inverse_inertia(&body, out), expected);
    REQUIRE_STATUS(t, tribo_body_spin(&body, out), expected);
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, arm, arm), expected);
    REQUIRE_STATUS(t, tribo_body_advance(&body, arm, 0.5), expected);
    REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, 0.0), expected);
    REQUIRE(t, canary_kept(out, sizeof out));
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

/* Null pointers and numbers that are none. */
static void bad_argument(property_trial *t)
{
    double half[3];
    double arm[3] = {1, 2, 3};
    double p[3] = {3, 2, 1};
    double out[6];
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    const tribo_body before = body;
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, tribo_body_world_inverse_inertia(NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_world_inverse_inertia(&body, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_spin(NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_spin(&body, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_apply_impulse(NULL, arm, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, NULL, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, arm, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_body_advance(NULL, arm, 1.0), TRIBO_ERROR_NULL);
    const double value = make_hostile(t, "value");
    const uint32_t entry = make_choice(t, "entry", 7);
    if (entry < 3) {
        arm[entry] = value;
    } else if (entry < 6) {
        p[entry - 3] = value;
    }
    REQUIRE_STATUS(t, tribo_body_advance(&body, arm, entry < 3 ? 1.0 : value),
                   TRIBO_ERROR_NOT_FINITE);
    if (entry < 6) {
        REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, arm, p), TRIBO_ERROR_NOT_FINITE);
    }
    REQUIRE(t, canary_kept(out, sizeof out));
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

/* A time step of few turns: long ones cost as much as they turn. */
static double make_wild_step(property_trial *t, const tribo_body *body)
{
    double values[3];
    const double dt = fabs(make_finite(t, NULL));
    reference_eigenvalues(body->inverse_inertia, values);
    const double growth = 1.0 + values[2] / fabs(values[0]);
    const double most = 20.0 / (norm3(body->angular_velocity) * growth);
    const double step = dt > most ? most : dt;
    property_note(t, "dt", &step, 1);
    return step;
}

/* Any twenty numbers for a body: named statuses; no NaN comes out of finite input. A semidefinite
 * inverse inertia that is singular without a zero row may pass the check and not be integrated. */
static void wild_body(property_trial *t)
{
    double arm[3];
    double p[3];
    double out[6];
    tribo_body body;
    make_body_wild(t, "body", &body);
    make_finite_vector(t, "arm", arm);
    make_finite_vector(t, "p", p);
    const tribo_status check = tribo_body_check(&body);
    const double dt = make_wild_step(t, &body);
    canary_set(out, sizeof out);
    const tribo_status inertia = tribo_body_world_inverse_inertia(&body, out);
    REQUIRE_STATUS(t, inertia, check);
    const tribo_body before = body;
    const tribo_status pushed = tribo_body_apply_impulse(&body, arm, p);
    REQUIRE(t, check != TRIBO_OK ? pushed == check
                                 : pushed == TRIBO_OK || pushed == TRIBO_ERROR_RANGE);
    if (pushed == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
    } else {
        REQUIRE_SAME(t, &body, &before, sizeof body);
    }
    body = before;
    const tribo_status moved = tribo_body_advance(&body, p, dt);
    REQUIRE(t, check != TRIBO_OK
                   ? moved == check
                   : moved == TRIBO_OK || moved == TRIBO_ERROR_RANGE ||
                         moved == TRIBO_ERROR_TIME_STEP || moved == TRIBO_ERROR_INERTIA);
    if (moved == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_body_check(&body), TRIBO_OK);
    } else {
        REQUIRE_SAME(t, &body, &before, sizeof body);
    }
}

/* ---- kinematics --------------------------------------------------------------------------- */

static void world_inverse_inertia(property_trial *t)
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    double half[3];
    double out[6];
    double values[3];
    long double r[9];
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    REQUIRE_STATUS(t, tribo_body_world_inverse_inertia(&body, out), TRIBO_OK);
    reference_rotation(body.orientation, r);
    reference_eigenvalues(body.inverse_inertia, values);
    for (int i = 0; i < 9; i++) {
        long double sum = 0.0L;
        for (int k = 0; k < 9; k++) {
            sum +=
                r[i - i % 3 + k / 3] * wide(body.inverse_inertia[full[k]]) * r[3 * (i % 3) + k % 3];
        }
        REQUIRE_NEAR(t, out[full[i]], sum, 16.0 * EPS * values[2]);
    }
}

static void spin(property_trial *t)
{
    double half[3];
    double out[3];
    double want[3];
    double energy;
    double values[3];
    tribo_body body;
    make_body(t, "body", BODY_WIDE, &body, half);
    ASSUME(t, reference_spin(&body, want, &energy));
    REQUIRE_STATUS(t, tribo_body_spin(&body, out), TRIBO_OK);
    reference_eigenvalues(body.inverse_inertia, values);
    REQUIRE_AT_MOST(t, distance3(out, want),
                    16.0 * EPS * values[2] / values[0] * norm3(body.angular_velocity) / values[0]);
}

/* An axis that cannot be turned has no part in the spin. */
static void spin_locked(property_trial *t)
{
    static const int diagonal[3] = {0, 3, 5};
    double half[3];
    double out[3];
    double want[3] = {0};
    double local[3];
    double most = 0.0;
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    const double *j = body.inverse_inertia;
    ASSUME(t, j[1] == 0.0 && j[2] == 0.0 && j[4] == 0.0);
    REQUIRE_STATUS(t, tribo_body_spin(&body, out), TRIBO_OK);
    tribo_quat_rotate_inverse(body.orientation, body.angular_velocity, local);
    for (int i = 0; i < 3; i++) {
        local[i] = j[diagonal[i]] == 0.0 ? 0.0 : local[i] / j[diagonal[i]];
        most = j[diagonal[i]] != 0.0 && most < 1.0 / j[diagonal[i]] ? 1.0 / j[diagonal[i]] : most;
    }
    tribo_quat_rotate(body.orientation, local, want);
    REQUIRE_AT_MOST(t, distance3(out, want), 32.0 * EPS * most * norm3(body.angular_velocity));
}

static void point_velocity(property_trial *t)
{
    double half[3];
    double arm[3];
    double out[3];
    double turn[3];
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    make_vector(t, "arm", -20, 20, arm);
    tribo_body_point_velocity(&body, arm, out);
    tribo_vec3_cross(body.angular_velocity, arm, turn);
    const double size = norm3(body.velocity) + norm3(body.angular_velocity) * norm3(arm);
    tribo_vec3_add(body.velocity, turn, turn);
    REQUIRE_AT_MOST(t, distance3(out, turn), 4.0 * EPS * size);
    tribo_body_point_velocity(&body, arm, arm);
    REQUIRE_SAME(t, arm, out, sizeof out);
}

/* m dv = p and I dw = r x p. */
static void apply_impulse(property_trial *t)
{
    double half[3];
    double arm[3];
    double p[3];
    double turn[3];
    double change[3];
    double j[6];
    double values[3];
    tribo_body body;
    make_body(t, "body", BODY_ANY, &body, half);
    make_vector(t, "arm", -6, 6, arm);
    make_vector(t, "p", -20, 20, p);
    const tribo_body before = body;
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, arm, p), TRIBO_OK);
    REQUIRE_SAME(t, &body, &before, offsetof(tribo_body, velocity));
    REQUIRE_SAME(t, &body.inverse_mass, &before.inverse_mass, 7 * sizeof(double));
    tribo_vec3_scale(before.inverse_mass, p, change);
    tribo_vec3_add(before.velocity, change, change);
    REQUIRE_AT_MOST(t, distance3(body.velocity, change),
                    4.0 * EPS * (norm3(before.velocity) + before.inverse_mass * norm3(p)));
    REQUIRE_STATUS(t, tribo_body_world_inverse_inertia(&before, j), TRIBO_OK);
    reference_eigenvalues(before.inverse_inertia, values);
    tribo_vec3_cross(arm, p, turn);
    tribo_sym3_apply(j, turn, change);
    tribo_vec3_add(before.angular_velocity, change, change);
    REQUIRE_AT_MOST(t, distance3(body.angular_velocity, change),
                    32.0 * EPS *
                        (norm3(before.angular_velocity) + values[2] * norm3(arm) * norm3(p)));
}

static void apply_impulse_immovable(property_trial *t)
{
    double half[3];
    double arm[3];
    double p[3];
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    make_finite_vector(t, "arm", arm);
    make_finite_vector(t, "p", p);
    body.inverse_mass = 0.0;
    memset(body.inverse_inertia, 0, sizeof body.inverse_inertia);
    const tribo_body before = body;
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&body, arm, p), TRIBO_OK);
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

/* ---- free flight -------------------------------------------------------------------------- */

/* A time step in which the body turns by no more than `most` radians, also if it gathers speed. */
static double make_step(property_trial *t, const tribo_body *body, double most, double *turn)
{
    double l[3];
    double energy;
    double values[3];
    double rate = norm3(body->angular_velocity);
    reference_eigenvalues(body->inverse_inertia, values);
    if (reference_spin(body, l, &energy) && norm3(l) * values[2] > rate) {
        rate = norm3(l) * values[2];
    }
    const double part = make_unit(t, NULL);
    const double dt = rate > 0.0 ? most * part * part / rate : part;
    *turn = rate * dt;
    property_note(t, "dt", &dt, 1);
    return dt;
}

/* Angular momentum and energy of rotation stay, the quaternion stays of unit length. */
static void advance_conserves(property_trial *t)
{
    double half[3];
    double turn;
    double before[3];
    double after[3];
    double energy[2];
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    const double dt = make_step(t, &body, 40.0, &turn);
    ASSUME(t, reference_spin(&body, before, &energy[0]) && turn > 0.0);
    REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, dt), TRIBO_OK);
    REQUIRE(t, reference_spin(&body, after, &energy[1]));
    const double *q = body.orientation;
    REQUIRE_NEAR(t, q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 8.0 * EPS);
    REQUIRE_AT_MOST(t, distance3(before, after), 64.0 * EPS * (1.0 + turn) * norm3(before));
    REQUIRE_NEAR(t, energy[1], energy[0], 64.0 * EPS * (1.0 + turn) * energy[0]);
}

/* The same for slender bodies, up to their condition number. */
static void advance_conserves_wide(property_trial *t)
{
    double half[3];
    double turn;
    double before[3];
    double after[3];
    double energy[2];
    tribo_body body;
    make_body(t, "body", BODY_WIDE, &body, half);
    const double condition = reference_condition(body.inverse_inertia);
    const double dt = make_step(t, &body, 40.0, &turn);
    ASSUME(t, reference_spin(&body, before, &energy[0]) && turn > 0.0 && condition < 1e12);
    REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, dt), TRIBO_OK);
    REQUIRE(t, reference_spin(&body, after, &energy[1]));
    const double slack = 64.0 * EPS * (1.0 + turn) * condition;
    REQUIRE_AT_MOST(t, distance3(before, after), slack * norm3(before));
    REQUIRE_NEAR(t, energy[1], energy[0], slack * energy[0]);
}

static void advance_parabola(property_trial *t)
{
    double half[3];
    double a[3];
    double turn;
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    make_vector(t, "acceleration", -10, 10, a);
    const double dt = make_step(t, &body, 1.0, &turn);
    const tribo_body before = body;
    REQUIRE_STATUS(t, tribo_body_advance(&body, a, dt), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        const double way = before.velocity[i] * dt;
        const double fall = 0.5 * a[i] * dt * dt;
        REQUIRE_NEAR(t, body.position[i], before.position[i] + way + fall,
                     4.0 * EPS * (fabs(before.position[i]) + fabs(way) + fabs(fall)));
        REQUIRE_NEAR(t, body.velocity[i], before.velocity[i] + a[i] * dt,
                     4.0 * EPS * (fabs(before.velocity[i]) + fabs(a[i] * dt)));
    }
    body = before;
    REQUIRE_STATUS(t, tribo_body_advance(&body, a, 0.0), TRIBO_OK);
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

/* Forth, velocities turned round, forth again: back at the start. */
static void advance_reversible(property_trial *t)
{
    double half[3];
    double turn;
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    const double dt = make_step(t, &body, 6.0, &turn);
    const tribo_body before = body;
    for (int i = 0; i < 2; i++) {
        REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, dt), TRIBO_OK);
        tribo_vec3_scale(-1.0, body.velocity, body.velocity);
        tribo_vec3_scale(-1.0, body.angular_velocity, body.angular_velocity);
    }
    /* rotation about the middle axis lets errors grow by exp(turn) at most */
    const double slack = 64.0 * EPS * (1.0 + turn) * exp(turn);
    REQUIRE_AT_MOST(t, tribo_quat_angle(before.orientation, body.orientation), slack);
    REQUIRE_AT_MOST(t, distance3(before.angular_velocity, body.angular_velocity),
                    slack * norm3(before.angular_velocity));
    REQUIRE_AT_MOST(t, distance3(before.position, body.position),
                    16.0 * EPS * (norm3(before.position) + norm3(before.velocity) * dt));
}

/* Many small steps end where one large step does. */
static void advance_splits(property_trial *t)
{
    double half[3];
    double turn;
    double a[3];
    tribo_body once;
    tribo_body often;
    make_body(t, "body", BODY_PLAIN, &once, half);
    make_vector(t, "acceleration", -4, 4, a);
    const double dt = make_step(t, &once, 6.0, &turn);
    const uint32_t steps = 1u << make_choice(t, "halvings", 6);
    often = once;
    const double size = norm3(once.position) + norm3(once.velocity) * dt + norm3(a) * dt * dt;
    REQUIRE_STATUS(t, tribo_body_advance(&once, a, dt), TRIBO_OK);
    for (uint32_t i = 0; i < steps; i++) {
        REQUIRE_STATUS(t, tribo_body_advance(&often, a, dt / steps), TRIBO_OK);
    }
    const double slack = 64.0 * EPS * (steps + turn) * exp(turn);
    REQUIRE_AT_MOST(t, tribo_quat_angle(once.orientation, often.orientation), slack);
    REQUIRE_AT_MOST(t, distance3(once.angular_velocity, often.angular_velocity),
                    slack * norm3(once.angular_velocity));
    REQUIRE_AT_MOST(t, distance3(once.position, often.position), 16.0 * EPS * steps * size);
}

/* A ball turns about a fixed axis. */
static void advance_ball(property_trial *t)
{
    double half[3];
    double turn;
    double step[4];
    double want[4];
    double v[3];
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    body.inverse_inertia[3] = body.inverse_inertia[5] = body.inverse_inertia[0];
    const double dt = make_step(t, &body, 100.0, &turn);
    const tribo_body before = body;
    REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, dt), TRIBO_OK);
    tribo_vec3_scale(dt, before.angular_velocity, v);
    REQUIRE_STATUS(t, tribo_quat_from_rotation_vector(v, step), TRIBO_OK);
    tribo_quat_multiply(step, before.orientation, want);
    REQUIRE_AT_MOST(t, tribo_quat_angle(body.orientation, want), 16.0 * EPS * (1.0 + turn));
    REQUIRE_AT_MOST(t, distance3(body.angular_velocity, before.angular_velocity),
                    16.0 * EPS * norm3(before.angular_velocity));
}

/* What cannot be moved keeps its velocities, and moves with them; so does a locked axis. */
static void advance_immovable(property_trial *t)
{
    double half[3];
    double turn;
    double a[3];
    double way[3];
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    make_vector(t, "acceleration", -4, 4, a);
    const int whole = make_choice(t, "locked axes only", 2) == 0;
    memset(body.inverse_inertia, 0, sizeof body.inverse_inertia);
    if (whole) {
        body.inverse_mass = 0.0;
    } else {
        body.inverse_inertia[make_choice(t, "free axis", 2) == 0 ? 0 : 5] = 1.0;
    }
    const double dt = make_step(t, &body, 10.0, &turn);
    const tribo_body before = body;
    REQUIRE_STATUS(t, tribo_body_advance(&body, whole ? a : NULL, dt), TRIBO_OK);
    REQUIRE(t, !whole || property_same(body.velocity, before.velocity, sizeof body.velocity));
    REQUIRE_SAME(t, body.angular_velocity, before.angular_velocity, sizeof body.velocity);
    tribo_vec3_add_scaled(before.position, dt, before.velocity, way);
    REQUIRE_AT_MOST(t, distance3(body.position, way),
                    4.0 * EPS * (norm3(before.position) + dt * norm3(before.velocity)));
    REQUIRE_NEAR(t, cos(tribo_quat_angle(before.orientation, body.orientation)),
                 cos(norm3(before.angular_velocity) * dt), 32.0 * EPS * (1.0 + turn));
}

static void advance_range(property_trial *t)
{
    double half[3];
    tribo_body body;
    make_body(t, "body", BODY_PLAIN, &body, half);
    const tribo_body before = body;
    const double rate = norm3(body.angular_velocity);
    const double dt = make_positive(t, "dt", -20, 40);
    REQUIRE_STATUS(t, tribo_body_advance(&body, NULL, -dt), TRIBO_ERROR_TIME_STEP);
    REQUIRE_SAME(t, &body, &before, sizeof body);
    ASSUME(t, rate > 0.0);
    const double beyond = 1.01e5 / rate * (1.0 + dt);
    const tribo_status status = tribo_body_advance(&body, NULL, beyond);
    REQUIRE_STATUS(t, status, TRIBO_ERROR_TIME_STEP);
    REQUIRE_SAME(t, &body, &before, sizeof body);
}

const char *const property_room = "body";
const property property_list[] = {
    {"mass_formula", mass_formula, 1},
    {"mass_limits", mass_limits, 1},
    {"mass_wild", mass_wild, 1},
    {"mass_null", mass_null, 1},
    {"set_mass", set_mass, 1},
    {"set_mass_bad", set_mass_bad, 1},
    {"set_mass_wild", set_mass_wild, 1},
    {"init", init, 1},
    {"check_valid", check_valid, 1},
    {"bad_body", bad_body, 1},
    {"bad_argument", bad_argument, 1},
    {"wild_body", wild_body, 40},
    {"world_inverse_inertia", world_inverse_inertia, 1},
    {"spin", spin, 1},
    {"spin_locked", spin_locked, 1},
    {"point_velocity", point_velocity, 1},
    {"apply_impulse", apply_impulse, 1},
    {"apply_impulse_immovable", apply_impulse_immovable, 1},
    {"advance_conserves", advance_conserves, 10},
    {"advance_conserves_wide", advance_conserves_wide, 10},
    {"advance_parabola", advance_parabola, 2},
    {"advance_reversible", advance_reversible, 10},
    {"advance_splits", advance_splits, 20},
    {"advance_ball", advance_ball, 2},
    {"advance_immovable", advance_immovable, 2},
    {"advance_range", advance_range, 100},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 30000;
