/* Properties of include/tribo/contact.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/reference.h"

static long double wide(double x)
{
    return (long double)x;
}

/* Length of numbers of any size. */
static long double length3(const double v[3])
{
    return sqrtl(wide(v[0]) * wide(v[0]) + wide(v[1]) * wide(v[1]) + wide(v[2]) * wide(v[2]));
}

static long double length2(const double v[2])
{
    return sqrtl(wide(v[0]) * wide(v[0]) + wide(v[1]) * wide(v[1]));
}

static long double apart(const double a[3], const double b[3])
{
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        const long double d = wide(a[i]) - wide(b[i]);
        square += d * d;
    }
    return sqrtl(square);
}

static int all_finite(const double *x, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(x[i])) {
            return 0;
        }
    }
    return 1;
}

/* One entry of one of the arrays becomes NaN or infinite. */
static void spoil(property_trial *t, double *const arrays[], const uint32_t lengths[],
                  uint32_t count)
{
    uint32_t total = 0;
    for (uint32_t i = 0; i < count; i++) {
        total += lengths[i];
    }
    uint32_t entry = make_choice(t, "entry", total);
    for (uint32_t i = 0; i < count; i++) {
        if (entry < lengths[i]) {
            arrays[i][entry] = make_hostile(t, "value");
            return;
        }
        entry -= lengths[i];
    }
}

static void make_frame(property_trial *t, const double n[3], double frame[9])
{
    if (make_choice(t, "frame", 4) != 3) {
        tribo_basis_from_normal(n, frame);
        return;
    }
    double q[4];
    long double r[9];
    make_quat(t, "frame", q);
    reference_rotation(q, r);
    for (int i = 0; i < 9; i++) {
        frame[i] = (double)r[i];
    }
}

/* ---- geometry ----------------------------------------------------------------------------- */

static void contact_at(property_trial *t)
{
    scene s;
    tribo_contact out;
    make_scene(t, BODY_ANY, &s);
    const tribo_body *b = s.has_b ? &s.b : NULL;
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, s.point, s.contact.normal, &out), TRIBO_OK);
    REQUIRE_SAME(t, &out, &s.contact, sizeof out);
    REQUIRE_STATUS(t, tribo_contact_check(&out), TRIBO_OK);
}

/* Any numbers at all: the check says what is wrong with them. */
static void contact_check(property_trial *t)
{
    tribo_contact c;
    double *field = (double *)&c;
    make_normal(t, NULL, c.normal);
    const double stretch = 1.0 + make_real(t, NULL, -50, 0);
    for (int i = 0; i < 9; i++) {
        field[i] = i < 3 ? stretch * field[i] : make_finite(t, NULL);
    }
    if (make_choice(t, NULL, 4) == 1) {
        field[make_choice(t, NULL, 9)] = make_any(t, NULL);
    }
    property_note(t, "contact", field, 9);
    const tribo_status status = tribo_contact_check(&c);
    const long double excess = fabsl(length3(c.normal) * length3(c.normal) - 1.0L);
    if (!all_finite(field, 9)) {
        REQUIRE(t, status == TRIBO_ERROR_NOT_FINITE ||
                       (status == TRIBO_ERROR_NORMAL && !(excess < 0.99e-12L)));
    } else if (excess > 1.01e-12L) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_NORMAL);
    } else if (excess < 0.99e-12L) {
        REQUIRE_STATUS(t, status, TRIBO_OK);
    }
    REQUIRE_STATUS(t, tribo_contact_check(NULL), TRIBO_ERROR_NULL);
}

static void contact_at_bad(property_trial *t)
{
    scene s;
    tribo_contact out;
    make_scene(t, BODY_ANY, &s);
    const tribo_body *b = s.has_b ? &s.b : NULL;
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_contact_at(NULL, b, s.point, s.contact.normal, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, NULL, s.contact.normal, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, s.point, NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, s.point, s.contact.normal, NULL), TRIBO_ERROR_NULL);
    const double stretch = 1.0 + make_positive(t, "stretch", -39, 4);
    for (int i = 0; i < 3; i++) {
        s.contact.normal[i] *= stretch;
    }
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, s.point, s.contact.normal, &out),
                   TRIBO_ERROR_NORMAL);
    double *const arrays[3] = {s.point, s.contact.normal, s.a.position};
    const uint32_t lengths[3] = {3, 3, 3};
    spoil(t, arrays, lengths, 3);
    REQUIRE_STATUS(t, tribo_contact_at(&s.a, b, s.point, s.contact.normal, &out),
                   TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(&out, sizeof out));
}

/* Velocity of the contact point of one body, and its size. */
static void add_point_velocity(const tribo_body *body, const double arm[3], long double sign,
                               long double v[3], long double *size)
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        v[i] += sign * (wide(body->velocity[i]) + wide(body->angular_velocity[j]) * wide(arm[k]) -
                        wide(body->angular_velocity[k]) * wide(arm[j]));
    }
    *size += length3(body->velocity) + length3(body->angular_velocity) * length3(arm);
}

static void contact_velocity(property_trial *t)
{
    scene s;
    double frame[9];
    double u[3];
    long double v[3] = {0};
    long double size = 0.0L;
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    add_point_velocity(&s.a, s.contact.arm_a, 1.0L, v, &size);
    if (s.has_b) {
        add_point_velocity(&s.b, s.contact.arm_b, -1.0L, v, &size);
    }
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, s.has_b ? &s.b : NULL, &s.contact, frame, u),
                   TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        long double want = 0.0L;
        for (int k = 0; k < 3; k++) {
            want += wide(frame[3 * i + k]) * v[k];
        }
        REQUIRE_NEAR(t, u[i], want, 8.0L * wide(EPS) * size);
    }
}

/* ---- contact matrix ----------------------------------------------------------------------- */

static void matrix_formula(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    double want[6];
    double bound;
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    reference_matrix(&s, frame, want, &bound);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, s.has_b ? &s.b : NULL, &s.contact, frame, w),
                   TRIBO_OK);
    for (int i = 0; i < 6; i++) {
        REQUIRE_NEAR(t, w[i], want[i], 16.0 * EPS * bound);
    }
}

/* 1/m_A + 1/m_B <= lambda <= sum (1/m + |r|^2 |I^-1|). */
static void matrix_bounds(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    double want[6];
    double values[3];
    double bound;
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    reference_matrix(&s, frame, want, &bound);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, s.has_b ? &s.b : NULL, &s.contact, frame, w),
                   TRIBO_OK);
    reference_eigenvalues(w, values);
    REQUIRE_AT_MOST(t, s.a.inverse_mass + s.b.inverse_mass, values[0] + 16.0 * EPS * bound);
    REQUIRE_AT_MOST(t, values[2], bound + 16.0 * EPS * bound);
}

/* The contact matrix of a uniform box has a condition number of at most 7, two have too. */
static void matrix_boxes(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    make_scene(t, BODY_PLAIN, &s);
    make_frame(t, s.contact.normal, frame);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, s.has_b ? &s.b : NULL, &s.contact, frame, w),
                   TRIBO_OK);
    REQUIRE_AT_MOST(t, reference_condition(w), 7.0 + 7.0 * 64.0 * EPS);
}

static void make_immovable(property_trial *t, tribo_body *body)
{
    double half[3];
    make_body(t, "immovable", BODY_PLAIN, body, half);
    memset(body->velocity, 0, sizeof body->velocity);
    memset(body->angular_velocity, 0, sizeof body->angular_velocity);
    body->inverse_mass = 0.0;
    memset(body->inverse_inertia, 0, sizeof body->inverse_inertia);
}

/* An immovable body adds nothing to W, whichever of the two it is. */
static void matrix_immovable(property_trial *t)
{
    scene s;
    tribo_body fixed;
    double frame[9];
    double alone[6];
    double with[6];
    make_scene(t, BODY_WIDE, &s);
    make_frame(t, s.contact.normal, frame);
    make_immovable(t, &fixed);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, NULL, &s.contact, frame, alone), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, &fixed, &s.contact, frame, with), TRIBO_OK);
    REQUIRE_SAME(t, alone, with, sizeof with);
    memcpy(s.contact.arm_b, s.contact.arm_a, sizeof s.contact.arm_b);
    REQUIRE_STATUS(t, tribo_contact_matrix(&fixed, &s.a, &s.contact, frame, with), TRIBO_OK);
    REQUIRE_SAME(t, alone, with, sizeof with);
    canary_set(with, sizeof with);
    REQUIRE_STATUS(t, tribo_contact_matrix(&fixed, NULL, &s.contact, frame, with),
                   TRIBO_ERROR_IMMOVABLE);
    REQUIRE(t, canary_kept(with, sizeof with));
}

/* Columns of W are what unit impulses do to the relative velocity. */
static void matrix_columns(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    double u[2][3];
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    make_scene(t, BODY_WIDE, &s);
    make_frame(t, s.contact.normal, frame);
    tribo_body *b = s.has_b ? &s.b : NULL;
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, b, &s.contact, frame, w), TRIBO_OK);
    const uint32_t k = make_choice(t, "column", 3);
    double p[3] = {0};
    /* large enough for the step to stand out from the velocity */
    p[k] = ldexp(tribo_pow2_scale(w[0]), 12);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, b, &s.contact, frame, u[0]), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, b, &s.contact, frame, p), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, b, &s.contact, frame, u[1]), TRIBO_OK);
    double values[3];
    reference_eigenvalues(w, values);
    const double size = values[2] * p[k] + norm3(u[0]);
    for (uint32_t i = 0; i < 3; i++) {
        REQUIRE_NEAR(t, u[1][i] - u[0][i], w[full[3 * i + k]] * p[k], 1e-7 * size);
    }
}

/* ---- applying impulses -------------------------------------------------------------------- */

/* Momentum of both bodies about the origin, and its scale. */
static void add_momentum(const tribo_body *body, const double origin[3], double linear[3],
                         double angular[3], double scale[2])
{
    double spin[3];
    double arm[3];
    double moment[3];
    double energy;
    double values[3];
    const double mass = 1.0 / body->inverse_mass;
    reference_spin(body, spin, &energy);
    reference_eigenvalues(body->inverse_inertia, values);
    tribo_vec3_subtract(body->position, origin, arm);
    tribo_vec3_cross(arm, body->velocity, moment);
    for (int i = 0; i < 3; i++) {
        linear[i] += mass * body->velocity[i];
        angular[i] += mass * moment[i] + spin[i];
    }
    scale[0] += mass * norm3(body->velocity);
    scale[1] +=
        norm3(arm) * mass * norm3(body->velocity) + norm3(body->angular_velocity) / values[0];
}

typedef struct momenta {
    double linear[3];
    double angular[3];
    double scale[2];
    double energy;
    double rounding; /* of the energy, over eps: |I| |w|^2 in place of w . I w */
} momenta;

static void measure(const scene *s, const double origin[3], momenta *m)
{
    double spin[3];
    double energy;
    double values[3];
    const tribo_body *bodies[2] = {&s->a, &s->b};
    memset(m, 0, sizeof *m);
    for (uint32_t i = 0; i < 1 + s->has_b; i++) {
        add_momentum(bodies[i], origin, m->linear, m->angular, m->scale);
        const double speed = norm3(bodies[i]->velocity);
        reference_spin(bodies[i], spin, &energy);
        m->energy += 0.5 * speed * speed / bodies[i]->inverse_mass + energy;
        const double rate = norm3(bodies[i]->angular_velocity);
        reference_eigenvalues(bodies[i]->inverse_inertia, values);
        m->rounding +=
            0.5 * speed * speed / bodies[i]->inverse_mass + 0.5 * rate * rate / values[0];
    }
}

/* What rounding of I^-1 (r x p) amounts to in the directions that are hard to turn. */
static double turning_scale(const scene *s, double impulse)
{
    double sum = norm3(s->contact.arm_a) * reference_condition(s->a.inverse_inertia);
    if (s->has_b) {
        sum += norm3(s->contact.arm_b) * reference_condition(s->b.inverse_inertia);
    }
    return sum * impulse;
}

/* `turning` is 0 for plain bodies. */
static void require_conserved(property_trial *t, const momenta *before, const momenta *after,
                              double turning)
{
    REQUIRE_AT_MOST(t, distance3(before->linear, after->linear),
                    8.0 * EPS * (before->scale[0] + after->scale[0]));
    REQUIRE_AT_MOST(t, distance3(before->angular, after->angular),
                    16.0 * EPS * (before->scale[1] + after->scale[1] + turning));
}

/* Linear momentum, and angular momentum about one point common to both bodies. */
static void apply_conserves(property_trial *t)
{
    scene s;
    double frame[9];
    double p[3];
    double origin[3];
    momenta before;
    momenta after;
    const uint32_t kind = make_choice(t, "wide", 2) == 1 ? BODY_WIDE : BODY_PLAIN;
    make_scene(t, kind, &s);
    ASSUME(t, s.has_b);
    make_frame(t, s.contact.normal, frame);
    make_vector(t, "p", -6, 6, p);
    make_vector(t, "origin", -4, 6, origin);
    measure(&s, origin, &before);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.b, &s.contact, frame, p), TRIBO_OK);
    measure(&s, origin, &after);
    require_conserved(t, &before, &after, kind == BODY_PLAIN ? 0.0 : turning_scale(&s, norm3(p)));
}

static void apply_single(property_trial *t)
{
    scene s;
    double frame[9];
    double p[3];
    double world[3];
    tribo_body alone;
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    make_vector(t, "p", -6, 6, p);
    alone = s.a;
    tribo_body with = s.a;
    REQUIRE_STATUS(t, tribo_contact_apply(&with, NULL, &s.contact, frame, p), TRIBO_OK);
    tribo_mat3_apply_transposed(frame, p, world);
    REQUIRE_STATUS(t, tribo_body_apply_impulse(&alone, s.contact.arm_a, world), TRIBO_OK);
    REQUIRE_SAME(t, &alone, &with, sizeof with);
    if (s.has_b) {
        REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.b, &s.contact, frame, p), TRIBO_OK);
        REQUIRE_SAME(t, &s.a, &alone, sizeof alone);
    }
}

static void matrix_bad(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    double p[3] = {1, 2, 3};
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    canary_set(w, sizeof w);
    const scene before = s;
    REQUIRE_STATUS(t, tribo_contact_matrix(NULL, &s.b, &s.contact, frame, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, &s.b, NULL, frame, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, &s.b, &s.contact, NULL, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, &s.b, &s.contact, frame, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_velocity(NULL, &s.b, &s.contact, frame, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, &s.b, NULL, frame, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, &s.b, &s.contact, NULL, w), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, &s.b, &s.contact, frame, NULL),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_apply(NULL, &s.b, &s.contact, frame, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.b, NULL, frame, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.b, &s.contact, NULL, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.b, &s.contact, frame, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, &s.a, &s.contact, frame, w), TRIBO_ERROR_ALIAS);
    REQUIRE_STATUS(t, tribo_contact_apply(&s.a, &s.a, &s.contact, frame, p), TRIBO_ERROR_ALIAS);
    REQUIRE(t, canary_kept(w, sizeof w));
    REQUIRE_SAME(t, &s, &before, sizeof s);
}

/* A frame that is not orthonormal, or left-handed. */
static void matrix_bad_frame(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    const uint32_t row = 3 * make_choice(t, "row", 3);
    const uint32_t next = (row + 3) % 9;
    const double size = make_positive(t, "size", -28, 2);
    const uint32_t kind = make_choice(t, "kind", 3);
    for (uint32_t i = 0; i < 3; i++) {
        if (kind == 0) {
            frame[row + i] *= 1.0 + size;
        } else if (kind == 1) {
            frame[row + i] += size * frame[next + i];
        } else {
            frame[row + i] = -frame[row + i];
        }
    }
    property_note(t, "frame", frame, 9);
    canary_set(w, sizeof w);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, s.has_b ? &s.b : NULL, &s.contact, frame, w),
                   TRIBO_ERROR_FRAME);
    REQUIRE(t, canary_kept(w, sizeof w));
}

/* A number that is none: the same status from all three. */
static void matrix_not_finite(property_trial *t)
{
    scene s;
    double frame[9];
    double w[6];
    double p[3] = {1, 2, 3};
    make_scene(t, BODY_ANY, &s);
    make_frame(t, s.contact.normal, frame);
    const uint32_t target = make_choice(t, "target", 4);
    double *const arrays[5] = {s.contact.arm_a, frame, s.a.velocity, s.contact.normal, p};
    const uint32_t lengths[5] = {3, 9, 6, 3, 3};
    spoil(t, arrays + target, lengths + target, target < 3 ? 1 : 2);
    tribo_body *b = s.has_b ? &s.b : NULL;
    const scene before = s;
    canary_set(w, sizeof w);
    if (target < 3 || isfinite(p[0] + p[1] + p[2])) {
        REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, b, &s.contact, frame, w),
                       TRIBO_ERROR_NOT_FINITE);
    }
    if (target < 3) {
        REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, b, &s.contact, frame, w),
                       TRIBO_ERROR_NOT_FINITE);
    }
    if (target < 3 || !isfinite(p[0] + p[1] + p[2])) {
        REQUIRE_STATUS(t, tribo_contact_apply(&s.a, b, &s.contact, frame, p),
                       TRIBO_ERROR_NOT_FINITE);
    }
    REQUIRE(t, canary_kept(w, sizeof w));
    REQUIRE_SAME(t, &s, &before, sizeof s);
}

/* Any finite numbers: named statuses, finite results, and outputs whole or untouched. */
static void matrix_wild(property_trial *t)
{
    scene s;
    double frame[9];
    double p[3];
    double w[6];
    make_scene(t, BODY_ANY, &s);
    make_body_wild(t, "a", &s.a);
    make_body_wild(t, "b", &s.b);
    make_frame(t, s.contact.normal, frame);
    make_finite_vector(t, "p", p);
    make_finite_vector(t, "arm_a", s.contact.arm_a);
    make_finite_vector(t, "arm_b", s.contact.arm_b);
    canary_set(w, sizeof w);
    const tribo_status status = tribo_contact_matrix(&s.a, &s.b, &s.contact, frame, w);
    const tribo_status check =
        tribo_body_check(&s.a) != TRIBO_OK ? tribo_body_check(&s.a) : tribo_body_check(&s.b);
    if (check != TRIBO_OK) {
        REQUIRE(t, status == tribo_body_check(&s.a) || status == tribo_body_check(&s.b));
    } else {
        REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_RANGE ||
                       status == TRIBO_ERROR_IMMOVABLE);
    }
    REQUIRE(t, status == TRIBO_OK ? all_finite(w, 6) && w[0] > 0.0 : canary_kept(w, sizeof w));
    const scene before = s;
    const tribo_status pushed = tribo_contact_apply(&s.a, &s.b, &s.contact, frame, p);
    REQUIRE(t, pushed == TRIBO_OK || pushed == TRIBO_ERROR_RANGE || check != TRIBO_OK);
    if (pushed == TRIBO_OK) {
        REQUIRE(t, tribo_body_check(&s.a) == TRIBO_OK && tribo_body_check(&s.b) == TRIBO_OK);
    } else {
        REQUIRE_SAME(t, &s, &before, sizeof s);
    }
}

/* ---- friction cone ------------------------------------------------------------------------ */

/* Nearest point of the cone. */
static void project(const long double x[3], double mu, long double out[3])
{
    const long double m = wide(mu);
    const long double t = sqrtl(x[1] * x[1] + x[2] * x[2]);
    out[0] = x[0];
    out[1] = x[1];
    out[2] = x[2];
    if (x[0] >= 0.0L && t <= m * x[0]) {
        return;
    }
    const long double n = (out[0] + m * t) / (1.0L + m * m);
    const long double share = n <= 0.0L ? 0.0L : m * n / t;
    out[0] = n <= 0.0L ? 0.0L : n;
    out[1] *= share;
    out[2] *= share;
}

static double make_cone_friction(property_trial *t)
{
    const uint8_t kind = make_byte(t);
    const double mu = kind < 160   ? make_friction(t, NULL)
                      : kind < 192 ? make_positive(t, NULL, -1074, 1023)
                                   : fabs(make_finite(t, NULL));
    property_note(t, "mu", &mu, 1);
    return mu;
}

static void make_cone_point(property_trial *t, const char *name, double x[3])
{
    const int scaled = make_choice(t, NULL, 2) == 0;
    const int exponent = make_exponent(t, -1074, 1023);
    if (!scaled) {
        make_finite_vector(t, name, x);
        return;
    }
    make_directions(t, NULL, x, 3);
    for (int i = 0; i < 3; i++) {
        x[i] = ldexp(x[i], exponent);
    }
    property_note(t, name, x, 3);
}

/* The nearest point of numbers next to the greatest double may be no double. */
static int leaves_doubles(const double x[3], double mu, long double want[3])
{
    const long double exact[3] = {wide(x[0]), wide(x[1]), wide(x[2])};
    project(exact, mu, want);
    return want[0] > 0.9999L * wide(DBL_MAX) || length3(x) > wide(DBL_MAX);
}

/* In the cone to 4 eps; only where p_n or p_t is no normal number, as near to it as such numbers
 * are. */
static void require_member(property_trial *t, const double p[3], double mu, long double slack)
{
    const long double excess = length2(p + 1) - wide(mu) * wide(p[0]);
    REQUIRE(t, p[0] >= 0.0);
    REQUIRE(t, excess <= slack * (1.0L + wide(mu)));
    if (p[0] >= 0x1p-960 && wide(p[0]) >= 0x1p-960L * length2(p + 1) &&
        length2(p + 1) > 0x1p-960L && mu > 0x1p-960) {
        REQUIRE(t, tribo_cone_contains(p, mu, 4.0 * EPS) == 1);
    }
}

/* Nearest, to 8 eps |x|, for all finite input. */
static void cone_project(property_trial *t)
{
    double x[3];
    double out[3];
    long double want[3];
    make_cone_point(t, "x", x);
    const double mu = make_cone_friction(t);
    const long double slack = 8.0L * wide(EPS) * length3(x) + 0x1p-1073L;
    const int beyond = leaves_doubles(x, mu, want);
    canary_set(out, sizeof out);
    const tribo_status status = tribo_cone_project(x, mu, out);
    if (beyond && status != TRIBO_OK) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_RANGE);
        REQUIRE(t, canary_kept(out, sizeof out));
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, isfinite(out[i]));
        REQUIRE_NEAR(t, wide(out[i]) - want[i], 0.0, slack);
    }
    require_member(t, out, mu, slack);
}

static void cone_idempotent(property_trial *t)
{
    double x[3];
    double once[3];
    double twice[3];
    make_cone_point(t, "x", x);
    const double mu = make_cone_friction(t);
    ASSUME(t, length3(x) < 0x1p1022L);
    REQUIRE_STATUS(t, tribo_cone_project(x, mu, once), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_cone_project(once, mu, twice), TRIBO_OK);
    REQUIRE_AT_MOST(t, apart(once, twice), 8.0L * wide(EPS) * length3(x) + 0x1p-1070L);
    REQUIRE_STATUS(t, tribo_cone_project(x, mu, x), TRIBO_OK);
    REQUIRE_SAME(t, x, once, sizeof x);
}

/* x = P_K(x) - P_K*(-x), the two parts orthogonal, the second in the dual cone. */
static void cone_moreau(property_trial *t)
{
    double x[3];
    double minus[3];
    double primal[3];
    double dual[3];
    make_cone_point(t, "x", x);
    const double mu = make_cone_friction(t);
    const long double size = length3(x);
    const long double slack = 8.0L * wide(EPS) * size + 0x1p-1072L;
    ASSUME(t, size < 0x1p1022L);
    long double dot = 0.0L;
    for (int i = 0; i < 3; i++) {
        minus[i] = -x[i];
    }
    REQUIRE_STATUS(t, tribo_cone_project(x, mu, primal), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_cone_project_dual(minus, mu, dual), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        REQUIRE_NEAR(t, wide(primal[i]) - wide(dual[i]) - wide(x[i]), 0.0, slack);
        dot += wide(primal[i]) * wide(dual[i]);
    }
    REQUIRE(t, fabsl(dot) <= slack * size);
    const long double excess = wide(mu) * length2(dual + 1) - wide(dual[0]);
    REQUIRE_AT_MOST(t, excess / (1.0L + wide(mu)), slack);
    REQUIRE_STATUS(t, tribo_cone_project_dual(minus, mu, minus), TRIBO_OK);
    REQUIRE_SAME(t, minus, dual, sizeof dual);
}

static void cone_nonexpansive(property_trial *t)
{
    double x[3];
    double y[3];
    double px[3];
    double py[3];
    make_cone_point(t, "x", x);
    make_cone_point(t, "y", y);
    const double mu = make_cone_friction(t);
    if (make_choice(t, "near", 2) == 1) {
        const double small = ldexp(1.0, -make_byte(t) % 56);
        for (int i = 0; i < 3; i++) {
            y[i] = x[i] * (1.0 + small * y[i] / (1.0 + fabs(y[i])));
            y[i] = isfinite(y[i]) ? y[i] : x[i];
        }
    }
    const long double greater = length3(x) > length3(y) ? length3(x) : length3(y);
    ASSUME(t, greater < 0x1p1022L);
    REQUIRE_STATUS(t, tribo_cone_project(x, mu, px), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_cone_project(y, mu, py), TRIBO_OK);
    REQUIRE(t, apart(px, py) <= apart(x, y) + 8.0L * wide(EPS) * greater + 0x1p-1072L);
}

/* P(2^k x) = 2^k P(x) to the bit; turning about n commutes with P. */
static void cone_homogeneous(property_trial *t)
{
    double x[3];
    double y[3];
    double px[3];
    double py[3];
    make_vector(t, "x", -200, 200, x);
    const double mu = make_friction(t, "mu");
    const int k = make_exponent(t, -400, 400);
    for (int i = 0; i < 3; i++) {
        y[i] = ldexp(x[i], k);
    }
    REQUIRE_STATUS(t, tribo_cone_project(x, mu, px), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_cone_project(y, mu, py), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, py[i] == ldexp(px[i], k));
    }
    const double angle = 6.3 * make_unit(t, "angle");
    const double c = cos(angle);
    const double s = sin(angle);
    const double turned[3] = {x[0], c * x[1] - s * x[2], s * x[1] + c * x[2]};
    const double want[3] = {px[0], c * px[1] - s * px[2], s * px[1] + c * px[2]};
    REQUIRE_STATUS(t, tribo_cone_project(turned, mu, py), TRIBO_OK);
    REQUIRE_AT_MOST(t, apart(py, want), 8.0L * wide(EPS) * length3(x));
}

/* mu = 0 is a half-line, huge mu a half-space. */
static void cone_limits(property_trial *t)
{
    double x[3];
    double out[3];
    make_cone_point(t, "x", x);
    ASSUME(t, length3(x) < 0x1p1022L);
    REQUIRE_STATUS(t, tribo_cone_project(x, 0.0, out), TRIBO_OK);
    REQUIRE(t, out[1] == 0.0 && out[2] == 0.0);
    REQUIRE_NEAR(t, out[0], x[0] > 0.0 ? x[0] : 0.0, 8.0L * wide(EPS) * length3(x));
    REQUIRE_STATUS(t, tribo_cone_clamp(x, 0.0, out), TRIBO_OK);
    REQUIRE(t, out[0] == (x[0] > 0.0 ? x[0] : 0.0) && out[1] == 0.0 && out[2] == 0.0);
    const double want[3] = {x[0] > 0.0 ? x[0] : 0.0, x[1], x[2]};
    REQUIRE_STATUS(t, tribo_cone_project(x, 1e300, out), TRIBO_OK);
    REQUIRE_AT_MOST(t, apart(out, want), 8.0L * wide(EPS) * length3(x) + 0x1p-1070L);
}

/* p_n up to 0, p_t shortened to mu p_n. */
static void cone_clamp(property_trial *t)
{
    double x[3];
    double out[3];
    make_cone_point(t, "x", x);
    const double mu = make_cone_friction(t);
    REQUIRE_STATUS(t, tribo_cone_clamp(x, mu, out), TRIBO_OK);
    const long double n = x[0] > 0.0 ? wide(x[0]) : 0.0L;
    const long double length = length2(x + 1);
    const long double limit = wide(mu) * n;
    const long double share = length > limit ? limit / length : 1.0L;
    const long double slack = 8.0L * wide(EPS) * share * length + 0x1p-1073L;
    require_member(t, out, mu, slack);
    REQUIRE(t, wide(out[0]) == n);
    for (int i = 1; i < 3; i++) {
        REQUIRE_NEAR(t, wide(out[i]) - share * wide(x[i]), 0.0, slack);
    }
    REQUIRE_STATUS(t, tribo_cone_clamp(x, mu, x), TRIBO_OK);
    REQUIRE_SAME(t, x, out, sizeof x);
}

static void cone_contains(property_trial *t)
{
    double x[3];
    make_cone_point(t, "x", x);
    const double mu = make_cone_friction(t);
    const double tolerance =
        make_choice(t, NULL, 2) == 0 ? 0.0 : make_positive(t, "tolerance", -52, 3);
    const long double limit = wide(mu) * wide(x[0]) * (1.0L + wide(tolerance));
    const long double length = length2(x + 1);
    const uint32_t inside = tribo_cone_contains(x, mu, tolerance);
    REQUIRE(t, inside <= 1);
    ASSUME(t, limit == 0.0L || limit > 1e-300L);
    if (x[0] < 0.0 || length > limit * (1.0L + 1e-14L)) {
        REQUIRE(t, inside == 0);
    } else if (length < limit * (1.0L - 1e-14L) || length == 0.0L) {
        REQUIRE(t, inside == 1);
    }
}

typedef tribo_status (*cone_function)(const double *p, double mu, double *out);

static void cone_bad(property_trial *t)
{
    static const cone_function functions[3] = {tribo_cone_project, tribo_cone_project_dual,
                                               tribo_cone_clamp};
    double x[3];
    double out[3];
    const cone_function call = functions[make_choice(t, "function", 3)];
    make_finite_vector(t, "x", x);
    double mu = make_cone_friction(t);
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, call(NULL, mu, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, call(x, mu, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, call(x, -make_positive(t, "minus mu", -1074, 1023), out),
                   TRIBO_ERROR_FRICTION);
    double *const arrays[2] = {x, &mu};
    const uint32_t lengths[2] = {3, 1};
    spoil(t, arrays, lengths, 2);
    REQUIRE_STATUS(t, call(x, mu, out), TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(out, sizeof out));
}

/* ---- exact solve -------------------------------------------------------------------------- */

typedef struct problem {
    double w[6];
    double b[3];
    double mu_s;
    double mu_d;
    double condition;
} problem;

/* One coefficient, or two. */
static void make_problem(property_trial *t, int one, problem *out)
{
    make_matrix(t, "w", out->w);
    out->mu_s = make_friction(t, "mu_s");
    out->mu_d = out->mu_s;
    if (!one && make_choice(t, NULL, 2) == 1) {
        out->mu_d *= make_unit(t, "mu_d / mu_s");
    }
    make_velocity(t, "b", out->w, out->mu_s, out->b);
    out->condition = reference_condition(out->w);
}

static tribo_status solve(const problem *q, double p[3], tribo_solve_info *info)
{
    info->struct_size = sizeof *info;
    return tribo_contact_solve(q->w, q->b, q->mu_s, q->mu_d, p, info);
}

/* Is the sticking impulse outside of the cone, but for rounding? */
static int cannot_stick(const problem *q)
{
    const long double minus[3] = {-wide(q->b[0]), -wide(q->b[1]), -wide(q->b[2])};
    long double p[3];
    if (!reference_solve(q->w, minus, p)) {
        return 1;
    }
    const long double length = sqrtl(p[1] * p[1] + p[2] * p[2]);
    const long double all = sqrtl(p[0] * p[0] + length * length);
    const long double slack = 256.0L * wide(EPS) * wide(q->condition) * all;
    return length + slack >= wide(q->mu_s) * (p[0] - slack);
}

/* 1e-10, or what the rounding of p itself amounts to: W may be small in the direction of p. */
static double eta_bound(const problem *q, const double p[3])
{
    double impulse;
    reference_scale(q->w, q->b, p, &impulse);
    return 1e-10 + (impulse > 0.0 ? 8.0 * EPS * norm3(p) / impulse : 0.0);
}

static void require_open(property_trial *t, const problem *q, const double p[3])
{
    REQUIRE(t, p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0);
    REQUIRE_AT_MOST(t, reference_eta(q->w, q->b, q->mu_s, p), eta_bound(q, p));
}

static void require_stick(property_trial *t, const problem *q, const double p[3])
{
    double v[3];
    double impulse;
    const double velocity = reference_scale(q->w, q->b, p, &impulse);
    reference_velocity(q->w, q->b, p, v);
    REQUIRE(t, q->b[0] < 0.0 && p[0] >= 0.0);
    REQUIRE_AT_MOST(t, norm3(v), 1e-10 * velocity);
    REQUIRE_AT_MOST(t, norm2(p + 1), q->mu_s * p[0] * (1.0 + 8.0 * EPS));
    REQUIRE_AT_MOST(t, reference_eta(q->w, q->b, q->mu_s, p), eta_bound(q, p));
}

static void require_slip(property_trial *t, const problem *q, const double p[3], double nu)
{
    double v[3];
    double impulse;
    const double velocity = reference_scale(q->w, q->b, p, &impulse);
    reference_velocity(q->w, q->b, p, v);
    REQUIRE(t, q->b[0] < 0.0 && p[0] >= 0.0 && nu >= 0.0);
    REQUIRE_NEAR(t, norm2(p + 1), q->mu_d * p[0], 8.0 * EPS * q->mu_d * p[0]);
    REQUIRE_AT_MOST(t, reference_eta(q->w, q->b, q->mu_d, p), eta_bound(q, p));
    REQUIRE(t, cannot_stick(q));
    if (q->mu_d > 0.0 && nu < 1e300) {
        const double off[2] = {v[1] + nu * p[1], v[2] + nu * p[2]};
        REQUIRE_AT_MOST(t, norm2(off), 1e-10 * velocity);
    }
}

static void require_solution(property_trial *t, const problem *q, const double p[3],
                             const tribo_solve_info *info)
{
    REQUIRE(t, all_finite(p, 3) && info->mode <= TRIBO_MODE_SLIP);
    REQUIRE(t, q->b[0] < 0.0 || info->mode == TRIBO_MODE_OPEN);
    REQUIRE(t, info->mode == TRIBO_MODE_SLIP || info->nu == 0.0);
    if (info->mode == TRIBO_MODE_OPEN) {
        require_open(t, q, p);
    } else if (info->mode == TRIBO_MODE_STICK) {
        require_stick(t, q, p);
    } else {
        require_slip(t, q, p, info->nu);
    }
}

/* Every definite problem is solved: eta <= 1e-10, and the mode is the one that the impulse has. */
static void solve_solution(property_trial *t)
{
    problem q;
    double p[3];
    double again[3];
    tribo_solve_info info;
    make_problem(t, 0, &q);
    REQUIRE_STATUS(t, solve(&q, p, &info), TRIBO_OK);
    require_solution(t, &q, p, &info);
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, again, NULL), TRIBO_OK);
    REQUIRE_SAME(t, again, p, sizeof p);
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, q.b, NULL), TRIBO_OK);
    REQUIRE_SAME(t, q.b, p, sizeof p);
}

/* b_n >= 0: no impulse, also where Coulomb's law has other solutions. */
static void solve_open(property_trial *t)
{
    problem q;
    double p[3];
    static const double zero[3] = {0, 0, 0};
    tribo_solve_info info;
    make_problem(t, 0, &q);
    q.b[0] = fabs(q.b[0]);
    if (make_choice(t, "touching", 4) == 1) {
        q.b[0] = make_choice(t, "minus", 2) == 0 ? 0.0 : -0.0;
    }
    REQUIRE_STATUS(t, solve(&q, p, &info), TRIBO_OK);
    REQUIRE_SAME(t, p, zero, sizeof p);
    REQUIRE(t, info.mode == TRIBO_MODE_OPEN && info.nu == 0.0 && info.iterations == 0);
}

/* Turning t1 and t2 turns the impulse. */
static void solve_turned(property_trial *t)
{
    problem q;
    problem r;
    double p[3];
    double turned[3];
    tribo_solve_info info;
    make_problem(t, 1, &q);
    ASSUME(t, reference_unique(q.w, q.mu_s));
    const double angle = 6.3 * make_unit(t, "angle");
    const long double c = cosl(wide(angle));
    const long double s = sinl(wide(angle));
    const long double d = wide(q.w[3]);
    const long double e = wide(q.w[4]);
    const long double f = wide(q.w[5]);
    r = q;
    r.w[1] = (double)(c * wide(q.w[1]) - s * wide(q.w[2]));
    r.w[2] = (double)(s * wide(q.w[1]) + c * wide(q.w[2]));
    r.w[3] = (double)(c * c * d - 2.0L * c * s * e + s * s * f);
    r.w[4] = (double)(c * s * (d - f) + (c * c - s * s) * e);
    r.w[5] = (double)(s * s * d + 2.0L * c * s * e + c * c * f);
    r.b[1] = (double)(c * wide(q.b[1]) - s * wide(q.b[2]));
    r.b[2] = (double)(s * wide(q.b[1]) + c * wide(q.b[2]));
    REQUIRE_STATUS(t, solve(&q, p, &info), TRIBO_OK);
    REQUIRE_STATUS(t, solve(&r, turned, &info), TRIBO_OK);
    const double want[3] = {p[0], (double)(c * wide(p[1]) - s * wide(p[2])),
                            (double)(s * wide(p[1]) + c * wide(p[2]))};
    REQUIRE_AT_MOST(t, distance3(turned, want), 128.0 * EPS * q.condition * norm3(p));
}

/* t2 to -t2: a mirrored impulse. */
static void solve_mirrored(property_trial *t)
{
    problem q;
    problem r;
    double p[3];
    double mirrored[3];
    tribo_solve_info info[2];
    make_problem(t, 0, &q);
    r = q;
    r.w[2] = -r.w[2];
    r.w[4] = -r.w[4];
    r.b[2] = -r.b[2];
    REQUIRE_STATUS(t, solve(&q, p, &info[0]), TRIBO_OK);
    REQUIRE_STATUS(t, solve(&r, mirrored, &info[1]), TRIBO_OK);
    mirrored[2] = -mirrored[2];
    REQUIRE_AT_MOST(t, distance3(p, mirrored), 8.0 * EPS * norm3(p));
    REQUIRE(t, info[0].mode == info[1].mode);
}

/* W 2^i and b 2^j: p 2^(j - i), to the bit. */
static void solve_scaled(property_trial *t)
{
    problem q;
    problem r;
    double p[3];
    double scaled[3];
    tribo_solve_info info[2];
    make_problem(t, 0, &q);
    r = q;
    const int i = make_exponent(t, -450, 450);
    const int j = make_exponent(t, -450, 450);
    for (int k = 0; k < 6; k++) {
        r.w[k] = ldexp(q.w[k], i);
    }
    for (int k = 0; k < 3; k++) {
        r.b[k] = ldexp(q.b[k], j);
    }
    REQUIRE_STATUS(t, solve(&q, p, &info[0]), TRIBO_OK);
    REQUIRE_STATUS(t, solve(&r, scaled, &info[1]), TRIBO_OK);
    for (int k = 0; k < 3; k++) {
        REQUIRE(t, scaled[k] == ldexp(p[k], j - i));
    }
    REQUIRE(t, info[0].mode == info[1].mode && info[0].iterations == info[1].iterations);
    REQUIRE(t, ldexp(info[0].nu, i) == info[1].nu);
}

/* A hair more or less friction changes the impulse by a hair, across stick and slip too. */
static void solve_continuous(property_trial *t)
{
    problem q;
    double p[3];
    double other[3];
    tribo_solve_info info;
    make_problem(t, 1, &q);
    ASSUME(t, reference_unique(q.w, q.mu_s));
    const double step = make_choice(t, "less", 2) == 1 ? -0x1p-40 : 0x1p-40;
    REQUIRE_STATUS(t, solve(&q, p, &info), TRIBO_OK);
    q.mu_s *= 1.0 + step;
    q.mu_d = q.mu_s;
    REQUIRE_STATUS(t, solve(&q, other, &info), TRIBO_OK);
    REQUIRE_AT_MOST(t, distance3(p, other),
                    (16.0 * 0x1p-40 + 128.0 * EPS * q.condition) * norm3(p));
}

/* (b + v) . p / 2 <= 0: friction and a plastic contact take energy. */
static void solve_dissipates(property_trial *t)
{
    problem q;
    double p[3];
    double v[3];
    double impulse;
    tribo_solve_info info;
    make_problem(t, 0, &q);
    REQUIRE_STATUS(t, solve(&q, p, &info), TRIBO_OK);
    reference_velocity(q.w, q.b, p, v);
    const double velocity = reference_scale(q.w, q.b, p, &impulse);
    long double energy = 0.0L;
    for (int i = 0; i < 3; i++) {
        energy += 0.5L * wide(p[i]) * (wide(q.b[i]) + wide(v[i]));
    }
    REQUIRE_AT_MOST(t, energy, 64.0 * EPS * impulse * velocity);
}

/* The greatest mu p_n - |p_t| over all nu, and the least, of the slip equation: a solution slides
 * where it changes sign. Each is relative to |p_t| + |mu p_n|. */
static void slip_range(const problem *q, long double *low, long double *high)
{
    const long double nn = wide(q->w[0]);
    const long double w1 = wide(q->w[1]);
    const long double w2 = wide(q->w[2]);
    const long double s11 = wide(q->w[3]) - w1 * w1 / nn;
    const long double s12 = wide(q->w[4]) - w1 * w2 / nn;
    const long double s22 = wide(q->w[5]) - w2 * w2 / nn;
    const long double c1 = w1 * wide(q->b[0]) / nn - wide(q->b[1]);
    const long double c2 = w2 * wide(q->b[0]) / nn - wide(q->b[2]);
    *low = 1.0L;
    *high = -1.0L;
    for (int i = -160; i < 160; i++) {
        const long double nu = (s11 + s22) * exp2l(wide(i / 4.0));
        const long double determinant = (s11 + nu) * (s22 + nu) - s12 * s12;
        const long double p1 = ((s22 + nu) * c1 - s12 * c2) / determinant;
        const long double p2 = ((s11 + nu) * c2 - s12 * c1) / determinant;
        const long double limit = -wide(q->mu_d) * (wide(q->b[0]) + w1 * p1 + w2 * p2) / nn;
        const long double length = sqrtl(p1 * p1 + p2 * p2);
        const long double f = (limit - length) / (fabsl(limit) + length);
        *low = f < *low ? f : *low;
        *high = f > *high ? f : *high;
    }
}

/* A matrix of rank 2, exactly, and the direction that it annuls. */
static void make_rank_two(property_trial *t, double w[6], double z[3])
{
    double a[2][3];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3; i++) {
            a[k][i] = ((int)(make_byte(t) % 33) - 16) / 8.0;
        }
    }
    for (int i = 0, e = 0; i < 3; i++) {
        for (int j = i; j < 3; j++, e++) {
            w[e] = a[0][i] * a[0][j] + a[1][i] * a[1][j];
        }
    }
    tribo_vec3_cross(a[0], a[1], z);
    property_note(t, "w", w, 6);
    property_note(t, "z", z, 3);
}

/* A jam may be said only where no solution is: a null direction lies in the cone, b pushes along
 * it, and the slip equation has no sign change. */
static void solve_jam(property_trial *t)
{
    double z[3];
    double p[3];
    problem q;
    tribo_solve_info info;
    long double low;
    long double high;
    make_rank_two(t, q.w, z);
    ASSUME(t, norm3(z) > 0.0 && q.w[0] > 0.0);
    q.mu_s = q.mu_d = make_friction(t, "mu");
    q.b[0] = -make_positive(t, "b_n", -6, 2);
    q.b[1] = make_real(t, "b_1", -6, 2);
    q.b[2] = make_real(t, "b_2", -6, 2);
    const double up = z[0] < 0.0 ? -1.0 : 1.0;
    const double along = up * tribo_vec3_dot(q.b, z) / (norm3(q.b) * norm3(z));
    const double slope = norm2(z + 1) - q.mu_s * fabs(z[0]);
    const int inside = slope < -0.001 * norm3(z);
    const int outside = slope > 0.001 * norm3(z);
    ASSUME(t, (inside && fabs(along) > 0.001) || outside);
    canary_set(p, sizeof p);
    canary_set(&info, sizeof info);
    info.struct_size = sizeof info;
    const tribo_solve_info untouched = info;
    const tribo_status status = tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, p, &info);
    if (status == TRIBO_ERROR_JAM) {
        slip_range(&q, &low, &high);
        REQUIRE(t, inside && along < 0.0 && low > -1e-9L);
        REQUIRE(t, canary_kept(p, sizeof p));
        REQUIRE_SAME(t, &info, &untouched, sizeof info);
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE_AT_MOST(t, reference_eta(q.w, q.b, q.mu_s, p), eta_bound(&q, p));
}

/* ---- the status of any numbers ------------------------------------------------------------ */

/* May the solver say this of the problem? Two faults: either. */
static int solve_status_fits(const problem *q, tribo_status status)
{
    const double mu[2] = {q->mu_s, q->mu_d};
    double values[3];
    double most = q->w[0] > q->w[3] ? q->w[0] : q->w[3];
    most = most > q->w[5] ? most : q->w[5];
    double fastest = fabs(q->b[0]) > fabs(q->b[1]) ? fabs(q->b[0]) : fabs(q->b[1]);
    fastest = fastest > fabs(q->b[2]) ? fastest : fabs(q->b[2]);
    if (!all_finite(q->w, 6) || !all_finite(q->b, 3) || !all_finite(mu, 2)) {
        return status == TRIBO_ERROR_NOT_FINITE || status == TRIBO_ERROR_RANGE ||
               status == TRIBO_ERROR_FRICTION || status == TRIBO_ERROR_CONTACT_MATRIX ||
               status == TRIBO_ERROR_IMMOVABLE;
    }
    reference_eigenvalues(q->w, values);
    const int in_range = most <= 0x1p1000 && most >= 0x1p-1000 && fastest <= 0x1p1000;
    const int semidefinite = values[0] >= -1e-9 * values[2] && values[2] > 0.0;
    const int definite = values[0] > 1e-11 * values[2];
    switch (status) {
    case TRIBO_OK:
        return in_range && q->mu_d >= 0.0 && q->mu_s >= q->mu_d && semidefinite;
    case TRIBO_ERROR_RANGE: /* the impulse may overflow too */
        return !in_range || most < 1e-100 || fastest > 1e100 || !definite;
    case TRIBO_ERROR_FRICTION:
        return q->mu_d < 0.0 || q->mu_s < q->mu_d;
    case TRIBO_ERROR_CONTACT_MATRIX:
        return !definite;
    case TRIBO_ERROR_IMMOVABLE:
        return q->w[0] == 0.0;
    case TRIBO_ERROR_JAM:
        return !definite;
    default:
        return 0;
    }
}

static double make_raw(property_trial *t)
{
    const uint64_t bits = make_bits(t, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void require_status(property_trial *t, problem *q)
{
    double p[3];
    tribo_solve_info info;
    canary_set(p, sizeof p);
    canary_set(&info, sizeof info);
    info.struct_size = sizeof info;
    const tribo_solve_info untouched = info;
    const tribo_status status = tribo_contact_solve(q->w, q->b, q->mu_s, q->mu_d, p, &info);
    property_note(t, "w", q->w, 6);
    property_note(t, "b", q->b, 3);
    property_note(t, "mu_s", &q->mu_s, 1);
    property_note(t, "mu_d", &q->mu_d, 1);
    REQUIRE(t, solve_status_fits(q, status));
    if (status != TRIBO_OK) {
        REQUIRE(t, canary_kept(p, sizeof p));
        REQUIRE_SAME(t, &info, &untouched, sizeof info);
        return;
    }
    REQUIRE(t, all_finite(p, 3));
    q->condition = reference_condition(q->w);
    /* products of very unequal numbers leave the range that the reference scales by */
    if (q->condition < 1e12 && q->mu_s < 1e6 && (q->mu_d == 0.0 || q->mu_d > 1e-100) &&
        norm3(p) < 1e250 && norm3(q->b) > 1e-250 && norm3(q->b) > 1e-250 * q->w[0] &&
        fabs(q->b[0]) > 1e-100 * norm3(q->b)) {
        require_solution(t, q, p, &info);
    }
}

/* Twelve doubles as they stand in the input: w, b, mu_s, mu_d. The named problems come this way. */
static void solve_raw(property_trial *t)
{
    problem q;
    for (int i = 0; i < 6; i++) {
        q.w[i] = make_raw(t);
    }
    for (int i = 0; i < 3; i++) {
        q.b[i] = make_raw(t);
    }
    q.mu_s = make_raw(t);
    q.mu_d = make_raw(t);
    require_status(t, &q);
}

static void solve_wild(property_trial *t)
{
    problem q;
    make_problem(t, 0, &q);
    const uint32_t faults = make_choice(t, "faults", 4);
    for (uint32_t i = 0; i < faults; i++) {
        const uint32_t field = make_choice(t, "field", 11);
        const double value = make_byte(t) % 8 == 1 ? make_hostile(t, NULL) : make_finite(t, NULL);
        if (field < 6) {
            q.w[field] = value;
        } else if (field < 9) {
            q.b[field - 6] = value;
        } else if (field == 9) {
            q.mu_s = value;
        } else {
            q.mu_d = value;
        }
    }
    if (make_choice(t, "scale", 4) == 1) {
        const double size = make_positive(t, NULL, -1074, 1023);
        for (int i = 0; i < 6; i++) {
            q.w[i] *= size;
        }
    }
    require_status(t, &q);
}

/* One fault of one kind: exactly its status. */
static void solve_bad(property_trial *t)
{
    problem q;
    double p[3];
    tribo_status expected = TRIBO_ERROR_FRICTION;
    make_problem(t, 0, &q);
    canary_set(p, sizeof p);
    REQUIRE_STATUS(t, tribo_contact_solve(NULL, q.b, 0.5, 0.5, p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, NULL, 0.5, 0.5, p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, q.b, 0.5, 0.5, NULL, NULL), TRIBO_ERROR_NULL);
    const double size = make_positive(t, "size", -30, 30);
    switch (make_choice(t, "kind", 7)) {
    case 0:
        q.mu_d = -size;
        break;
    case 1:
        q.mu_d = q.mu_s + size * (1.0 + q.mu_s);
        break;
    case 2: {
        double values[3];
        reference_eigenvalues(q.w, values);
        const double lift = values[0] + (1e-9 + size) * values[2];
        q.w[0] -= lift;
        q.w[3] -= lift;
        q.w[5] -= lift;
        expected = TRIBO_ERROR_CONTACT_MATRIX;
        /* a last diagonal entry that is left of the others may leave W_nn = 0, which has its own
         * name */
        ASSUME(t, q.w[0] != 0.0);
        break;
    }
    case 3:
        q.w[0] = q.w[1] = q.w[2] = 0.0;
        expected = TRIBO_ERROR_IMMOVABLE;
        break;
    case 4:
        memset(q.w, 0, sizeof q.w);
        expected = TRIBO_ERROR_IMMOVABLE;
        break;
    case 5:
        q.b[make_choice(t, "entry", 3)] =
            0x1.1p1000 * size * 0x1p20 > DBL_MAX ? DBL_MAX : 0x1.1p1000;
        expected = TRIBO_ERROR_RANGE;
        break;
    default: {
        double *const arrays[4] = {q.w, q.b, &q.mu_s, &q.mu_d};
        const uint32_t lengths[4] = {6, 3, 1, 1};
        spoil(t, arrays, lengths, 4);
        expected = TRIBO_ERROR_NOT_FINITE;
        break;
    }
    }
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, p, NULL), expected);
    REQUIRE(t, canary_kept(p, sizeof p));
}

/* ---- the general solve -------------------------------------------------------------------- */

static void full_matrix(const double s[6], double m[9])
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; i++) {
        m[i] = s[full[i]];
    }
}

static void general_symmetric(property_trial *t)
{
    problem q;
    double full[9];
    double p[3];
    double general[3];
    tribo_solve_info info[2];
    make_problem(t, 1, &q);
    ASSUME(t, reference_unique(q.w, q.mu_s));
    full_matrix(q.w, full);
    info[1].struct_size = sizeof info[1];
    REQUIRE_STATUS(t, solve(&q, p, &info[0]), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, general, &info[1]),
                   TRIBO_OK);
    REQUIRE_AT_MOST(t, distance3(p, general), 128.0 * EPS * q.condition * norm3(p));
    REQUIRE_AT_MOST(t, norm2(general + 1), q.mu_s * general[0] * (1.0 + 8.0 * EPS));
    REQUIRE_AT_MOST(t, reference_eta(q.w, q.b, q.mu_s, general),
                    eta_bound(&q, general) + 64.0 * EPS * q.condition);
}

/* Natural-map residual for a full matrix, less what the rounding of p amounts to. */
static double eta_of_full(const double w[9], const double b[3], double mu, const double p[3])
{
    long double v[3];
    long double x[3];
    long double nearest[3];
    long double velocity = length3(b);
    double most = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] = wide(b[i]);
        most = fabs(w[4 * i]) > most ? fabs(w[4 * i]) : most;
        for (int j = 0; j < 3; j++) {
            v[i] += wide(w[3 * i + j]) * wide(p[j]);
            velocity += fabsl(wide(w[3 * i + j]) * wide(p[j]));
        }
    }
    if (velocity == 0.0L) {
        return 0.0;
    }
    const long double rho = 1.0L / (wide(most) * (mu > 1.0 ? wide(mu) : 1.0L));
    v[0] += wide(mu) * sqrtl(v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++) {
        x[i] = wide(p[i]) - rho * v[i];
    }
    project(x, mu, nearest);
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        square += (nearest[i] - wide(p[i])) * (nearest[i] - wide(p[i]));
    }
    const long double rounding = 8.0L * wide(EPS) * length3(p);
    return (double)((sqrtl(square) - rounding) * wide(most) / velocity);
}

/* An antisymmetric part keeps the energy positive, and a solution exists. */
static void general_unsymmetric(property_trial *t)
{
    problem q;
    double full[9];
    double p[3];
    tribo_solve_info info;
    make_problem(t, 0, &q);
    full_matrix(q.w, full);
    for (int i = 0; i < 3; i++) {
        const double turn = q.w[0] * make_signed(t, "antisymmetric");
        full[3 * i + (i + 1) % 3] += turn;
        full[3 * ((i + 1) % 3) + i] -= turn;
    }
    property_note(t, "full", full, 9);
    info.struct_size = sizeof info;
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, &info), TRIBO_OK);
    REQUIRE(t, info.mode <= TRIBO_MODE_SLIP && (q.b[0] < 0.0 || info.mode == TRIBO_MODE_OPEN));
    const double mu = info.mode == TRIBO_MODE_STICK ? q.mu_s : q.mu_d;
    REQUIRE_AT_MOST(t, norm2(p + 1), mu * p[0] * (1.0 + 8.0 * EPS));
    REQUIRE_AT_MOST(t, eta_of_full(full, q.b, mu, p), 1e-10 + 64.0 * EPS * q.condition);
}

static void turn_tangents(double angle, double *x, double *y)
{
    const double turned = cos(angle) * *x - sin(angle) * *y;
    *y = sin(angle) * *x + cos(angle) * *y;
    *x = turned;
}

/* Tangents along which bodies move up to 2^16 times less or more easily than along the normal, and
 * a trace of skewness: never refused. */
static void general_graded(property_trial *t)
{
    problem q;
    double full[9];
    double p[3];
    double grade[3] = {1.0, 1.0, 1.0};
    make_problem(t, 0, &q);
    ASSUME(t, q.condition < 1e4);
    full_matrix(q.w, full);
    grade[1] = ldexp(1.0, make_exponent(t, -8, 8));
    grade[2] = ldexp(1.0, make_exponent(t, -8, 8));
    const double trace = make_positive(t, "skewness", -54, -1);
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3;
        const double turn = trace * sqrt(full[4 * i] * full[4 * k]) * make_signed(t, NULL);
        full[3 * i + k] += turn;
        full[3 * k + i] -= turn;
    }
    for (int i = 0; i < 9; i++) {
        full[i] *= grade[i / 3] * grade[i % 3];
    }
    const double angle = 6.3 * make_unit(t, "angle");
    for (int i = 0; i < 3; i++) {
        q.b[i] *= grade[i];
        turn_tangents(angle, full + 3 * i + 1, full + 3 * i + 2);
    }
    for (int i = 0; i < 3; i++) {
        turn_tangents(angle, full + 3 + i, full + 6 + i);
    }
    turn_tangents(angle, q.b + 1, q.b + 2);
    property_note(t, "full", full, 9);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, NULL), TRIBO_OK);
    if (q.mu_s == q.mu_d) {
        REQUIRE_AT_MOST(t, norm2(p + 1), q.mu_s * p[0] * (1.0 + 8.0 * EPS));
        REQUIRE_AT_MOST(t, eta_of_full(full, q.b, q.mu_s, p), 1e-10);
    }
}

static void general_wild(property_trial *t)
{
    problem q;
    double full[9];
    double p[3];
    make_problem(t, 0, &q);
    full_matrix(q.w, full);
    const uint32_t faults = 1 + make_choice(t, "faults", 4);
    for (uint32_t i = 0; i < faults; i++) {
        const double value = make_byte(t) % 8 == 1 ? make_hostile(t, NULL) : make_finite(t, NULL);
        full[make_choice(t, "field", 9)] = value;
    }
    property_note(t, "full", full, 9);
    canary_set(p, sizeof p);
    const tribo_status status = tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, NULL);
    REQUIRE(t, all_finite(full, 9) ? status != TRIBO_ERROR_NOT_FINITE : status != TRIBO_OK);
    REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_NOT_FINITE ||
                   status == TRIBO_ERROR_RANGE || status == TRIBO_ERROR_CONTACT_MATRIX ||
                   status == TRIBO_ERROR_IMMOVABLE || status == TRIBO_ERROR_JAM);
    REQUIRE(t, status == TRIBO_OK ? all_finite(p, 3) : canary_kept(p, sizeof p));
    REQUIRE(t, full[0] > 0.0 || status != TRIBO_OK);
}

static void general_bad(property_trial *t)
{
    problem q;
    double full[9];
    double p[3];
    make_problem(t, 0, &q);
    full_matrix(q.w, full);
    canary_set(p, sizeof p);
    REQUIRE_STATUS(t, tribo_contact_solve_general(NULL, q.b, 0.5, 0.5, p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, NULL, 0.5, 0.5, p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, 0.5, 0.5, NULL, NULL),
                   TRIBO_ERROR_NULL);
    const double size = make_positive(t, "size", -30, 30);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, -size, p, NULL),
                   TRIBO_ERROR_FRICTION);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, 0.5, 0.5 + size, p, NULL),
                   TRIBO_ERROR_FRICTION);
    full[0] = -full[0];
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, NULL),
                   TRIBO_ERROR_CONTACT_MATRIX);
    full[0] = 0.0;
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, NULL),
                   TRIBO_ERROR_IMMOVABLE);
    double *const arrays[4] = {full, q.b, &q.mu_s, &q.mu_d};
    const uint32_t lengths[4] = {9, 3, 1, 1};
    spoil(t, arrays, lengths, 4);
    REQUIRE_STATUS(t, tribo_contact_solve_general(full, q.b, q.mu_s, q.mu_d, p, NULL),
                   TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(p, sizeof p));
}

/* ---- impact laws -------------------------------------------------------------------------- */

enum { LAWS = 8 };

typedef struct impact {
    double w[6];
    double u[3];
    tribo_material pair;
    tribo_impact_options options;
    double condition;
    double p[3];
    tribo_impact_info info;
    double velocity; /* scale of velocities and of impulses */
    double impulse;
} impact;

static void set_law(impact *q, uint32_t law, double e_t)
{
    memset(&q->options, 0, sizeof q->options);
    q->options.struct_size = sizeof q->options;
    q->options.law = law;
    q->options.tangential_restitution = e_t;
}

static void make_impact(property_trial *t, uint32_t law, impact *q)
{
    make_matrix(t, "w", q->w);
    make_material(t, "pair", &q->pair);
    make_velocity(t, "u", q->w, q->pair.mu_s, q->u);
    q->condition = reference_condition(q->w);
    set_law(q, law, 0.0);
}

static tribo_status strike(impact *q)
{
    memset(&q->info, 0, sizeof q->info);
    q->info.struct_size = sizeof q->info;
    const tribo_status status = tribo_impact(q->w, q->u, &q->pair, &q->options, q->p, &q->info);
    if (status == TRIBO_OK) {
        q->velocity = reference_scale(q->w, q->u, q->p, &q->impulse);
        /* rounding of p: V over the greatest W_ii may be much less than |p| */
        q->impulse = q->impulse > norm3(q->p) ? q->impulse : norm3(q->p);
    }
    return status;
}

static long double energy_of(const impact *q)
{
    double v[3];
    long double sum = 0.0L;
    reference_velocity(q->w, q->u, q->p, v);
    for (int i = 0; i < 3; i++) {
        sum += 0.5L * wide(q->p[i]) * (wide(q->u[i]) + wide(v[i]));
    }
    return sum;
}

static int is_routh(uint32_t law)
{
    return law >= TRIBO_LAW_ROUTH_NEWTON && law <= TRIBO_LAW_ROUTH_STRONGE;
}

/* What every law does: finite, p_n >= 0, no approach afterwards, and an info that fits. */
static void require_impact(property_trial *t, const impact *q)
{
    double v[3];
    REQUIRE(t, all_finite(q->p, 3) && q->info.mode <= TRIBO_MODE_SLIP);
    REQUIRE(t, (q->info.mode == TRIBO_MODE_OPEN) == !(q->u[0] < 0.0));
    reference_velocity(q->w, q->u, q->p, v);
    REQUIRE_AT_MOST(t, distance3(v, q->info.velocity), 8.0 * EPS * q->velocity);
    REQUIRE_NEAR(t, q->info.energy, energy_of(q), 64.0 * EPS * q->impulse * q->velocity);
    REQUIRE(t, q->info.reserved == 0);
    REQUIRE(t, q->options.law == TRIBO_LAW_ALGEBRAIC || q->info.kappa == 0.0);
    REQUIRE(t, is_routh(q->options.law) || q->info.compression == 0.0);
}

static void require_cone(property_trial *t, const impact *q, double mu)
{
    REQUIRE(t, q->p[0] >= 0.0);
    REQUIRE_AT_MOST(t, norm2(q->p + 1), mu * q->p[0] * (1.0 + 8.0 * EPS));
}

/* u_n+ = -e u_n. */
static void require_restitution(property_trial *t, const impact *q)
{
    double v[3];
    reference_velocity(q->w, q->u, q->p, v);
    if (q->u[0] < 0.0) {
        REQUIRE_NEAR(t, v[0], -q->pair.e * q->u[0],
                     16.0 * EPS * (q->condition * fabs(q->u[0]) + q->velocity));
    }
}

static void impact_any(property_trial *t)
{
    impact q;
    double again[3];
    const uint32_t law = make_choice(t, "law", LAWS);
    make_impact(t, law, &q);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    REQUIRE_STATUS(t, tribo_impact(q.w, q.u, &q.pair, &q.options, again, NULL), TRIBO_OK);
    REQUIRE_SAME(t, again, q.p, sizeof again);
    if (law == TRIBO_LAW_ALGEBRAIC) {
        REQUIRE_STATUS(t, tribo_impact(q.w, q.u, &q.pair, NULL, again, NULL), TRIBO_OK);
        REQUIRE_SAME(t, again, q.p, sizeof again);
    }
    REQUIRE_STATUS(t, tribo_impact(q.w, q.u, &q.pair, &q.options, q.u, NULL), TRIBO_OK);
    REQUIRE_SAME(t, q.u, q.p, sizeof again);
}

/* u_n+ = -e u_n, the cone, dT <= 0, and the two W-orthogonal parts of dT. */
static void impact_algebraic(property_trial *t)
{
    impact q;
    long double s[2];
    make_impact(t, TRIBO_LAW_ALGEBRAIC, &q);
    q.options.tangential_restitution = make_choice(t, NULL, 2) == 0 ? 0.0 : make_signed(t, "e_t");
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    require_restitution(t, &q);
    require_cone(t, &q, q.pair.mu_s);
    if (q.info.mode == TRIBO_MODE_SLIP) {
        require_cone(t, &q, q.pair.mu_d);
    }
    const double most = 1.0 + q.options.tangential_restitution;
    REQUIRE(t, q.info.kappa >= 0.0 && q.info.kappa <= most);
    const long double change = energy_of(&q);
    REQUIRE_AT_MOST(t, change, 64.0 * EPS * q.impulse * q.velocity);
    ASSUME(t, q.u[0] < 0.0);
    /* |P_I|^2_W = u_n^2 / W_nn and |P_II - P_I|^2_W = c . S^-1 c */
    const long double nn = wide(q.w[0]);
    const long double minus[3] = {-wide(q.u[0]), -wide(q.u[1]), -wide(q.u[2])};
    long double stick[3];
    ASSUME(t, reference_solve(q.w, minus, stick));
    s[0] = wide(q.u[0]) * wide(q.u[0]) / nn;
    s[1] = stick[0] * minus[0] + stick[1] * minus[1] + stick[2] * minus[2] - s[0];
    const long double e = wide(q.pair.e);
    const long double kappa = wide(q.info.kappa);
    const long double want = -0.5L * (1.0L - e * e) * s[0] - 0.5L * kappa * (2.0L - kappa) * s[1];
    REQUIRE_NEAR(t, change, want, 64.0 * EPS * q.condition * q.impulse * q.velocity);
}

/* Coulomb's law of the velocities after the impact, with Newton's restitution. */
static void impact_coulomb(property_trial *t)
{
    impact q;
    make_impact(t, TRIBO_LAW_COULOMB, &q);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    ASSUME(t, q.u[0] < 0.0);
    const int slips = q.info.mode == TRIBO_MODE_SLIP;
    const double mu = slips ? q.pair.mu_d : q.pair.mu_s;
    const double b[3] = {(1.0 + q.pair.e) * q.u[0], q.u[1], q.u[2]};
    require_cone(t, &q, mu);
    require_restitution(t, &q);
    double impulse;
    reference_scale(q.w, b, q.p, &impulse);
    REQUIRE_AT_MOST(t, reference_eta(q.w, b, mu, q.p), 1e-10 + 8.0 * EPS * norm3(q.p) / impulse);
    if (q.pair.e == 0.0) {
        REQUIRE_AT_MOST(t, energy_of(&q), 64.0 * EPS * q.impulse * q.velocity);
    }
}

/* Friction stays in the cone all along; Newton's, Poisson's and Stronge's ends. */
static void impact_routh(property_trial *t)
{
    impact q;
    double v[3];
    make_impact(t, TRIBO_LAW_ROUTH_NEWTON + make_choice(t, "law", 3), &q);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    ASSUME(t, q.u[0] < 0.0);
    require_cone(t, &q, q.pair.mu_s);
    reference_velocity(q.w, q.u, q.p, v);
    REQUIRE_AT_MOST(t, -v[0], 64.0 * EPS * q.velocity);
    REQUIRE(t, q.info.compression >= 0.0);
    REQUIRE_AT_MOST(t, q.info.compression, q.p[0] * (1.0 + 8.0 * EPS));
    if (q.options.law == TRIBO_LAW_ROUTH_NEWTON) {
        require_restitution(t, &q);
        return;
    }
    REQUIRE_AT_MOST(t, energy_of(&q), 64.0 * EPS * q.impulse * q.velocity);
    if (q.options.law == TRIBO_LAW_ROUTH_POISSON) {
        REQUIRE_NEAR(t, q.p[0], (1.0 + q.pair.e) * q.info.compression, 64.0 * EPS * q.p[0]);
    }
}

/* ---- Routh's law in a plane, in closed form ----------------------------------------------- */

typedef struct routh {
    long double a, c, d; /* W_nn, W_n1, W_11 */
    long double un, ut;
    long double mu_s, mu_d;
    long double pn, pt; /* impulses so far */
    long double work;   /* of the normal impulse; since greatest compression */
} routh;

/* Friction ratio dp_t/dp_n. */
static long double ratio_of(const routh *r)
{
    const long double hold = -r->c / r->d;
    if (r->ut != 0.0L) {
        return r->ut > 0.0L ? -r->mu_d : r->mu_d;
    }
    return fabsl(hold) <= r->mu_s ? hold : r->c > 0.0L ? -r->mu_d : r->mu_d;
}

static void proceed(routh *r, long double ratio, long double h, int stop)
{
    const long double rate = r->a + r->c * ratio;
    const int sticks = r->ut == 0.0L && ratio == -r->c / r->d;
    r->work += h * (r->un + 0.5L * rate * h);
    r->un += rate * h;
    r->ut = stop || sticks ? 0.0L : r->ut + (r->c + r->d * ratio) * h;
    r->pn += h;
    r->pt += ratio * h;
}

/* Normal impulse until sliding stops; infinite if it does not. */
static long double until_rest(const routh *r, long double ratio)
{
    const long double rate = r->c + r->d * ratio;
    return r->ut * rate < 0.0L ? -r->ut / rate : (long double)HUGE_VAL;
}

/* Up to u_n = 0. */
static int compress(routh *r)
{
    for (int phase = 0; phase < 4 && r->un < 0.0L; phase++) {
        const long double ratio = ratio_of(r);
        const long double rate = r->a + r->c * ratio;
        const long double rest = until_rest(r, ratio);
        const long double end = rate > 0.0L ? -r->un / rate : (long double)HUGE_VAL;
        const int stop = rest < end;
        if (!stop && !(end < 1e300L)) {
            return 0;
        }
        proceed(r, ratio, stop ? rest : end, stop);
        if (!stop) {
            r->un = 0.0L;
        }
    }
    return r->un == 0.0L;
}

/* Normal impulse from here to the end that the law names, if the rate stays. */
static long double until_end(const routh *r, uint32_t law, long double rate,
                             const long double goal[3])
{
    if (law == TRIBO_LAW_ROUTH_NEWTON) {
        return (goal[0] - r->un) / rate;
    }
    if (law == TRIBO_LAW_ROUTH_POISSON) {
        return goal[1] - r->pn;
    }
    const long double missing = goal[2] - r->work;
    const long double root = sqrtl(r->un * r->un + 2.0L * rate * missing);
    return 2.0L * missing / (r->un + root);
}

static int restitute(routh *r, uint32_t law, const long double goal[3])
{
    for (int phase = 0; phase < 4; phase++) {
        const long double ratio = ratio_of(r);
        const long double rate = r->a + r->c * ratio;
        const long double rest = until_rest(r, ratio);
        const long double end = until_end(r, law, rate, goal);
        const int stop = rest < end;
        if (!stop && !(end >= 0.0L && end < 1e300L)) {
            return 0;
        }
        proceed(r, ratio, stop ? rest : end, stop);
        if (!stop) {
            return 1;
        }
    }
    return 0;
}

static int routh_reference(const impact *q, long double p[2], long double *compression)
{
    routh r = {wide(q->w[0]),      wide(q->w[1]),      wide(q->w[3]), wide(q->u[0]), wide(q->u[1]),
               wide(q->pair.mu_s), wide(q->pair.mu_d), 0.0L,          0.0L,          0.0L};
    const long double e = wide(q->pair.e);
    if (!compress(&r)) {
        return 0;
    }
    *compression = r.pn;
    const long double spent = r.work;
    r.work = 0.0L;
    const long double goal[3] = {-e * wide(q->u[0]), (1.0L + e) * r.pn, -e * e * spent};
    const int done = e == 0.0L || restitute(&r, q->options.law, goal);
    p[0] = r.pn;
    p[1] = r.pt;
    return done;
}

static void impact_routh_planar(property_trial *t)
{
    impact q;
    long double want[2];
    long double compression;
    make_impact(t, TRIBO_LAW_ROUTH_NEWTON + make_choice(t, "law", 3), &q);
    q.w[2] = q.w[4] = 0.0;
    q.u[2] = make_choice(t, "minus", 2) == 1 ? -0.0 : 0.0;
    q.condition = reference_condition(q.w);
    ASSUME(t, q.u[0] < 0.0 && q.condition < 1e8);
    /* away from where the reversal of slip is undecided, and from unbounded growth */
    const double hold = fabs(q.w[1] / q.w[3]);
    ASSUME(t, fabs(hold - q.pair.mu_s) > 1e-6 * hold && q.pair.mu_s < 1e3);
    ASSUME(t, routh_reference(&q, want, &compression));
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE(t, q.p[2] == 0.0);
    const double slack = 64.0 * EPS * q.condition * q.impulse * q.condition;
    REQUIRE_NEAR(t, wide(q.p[0]) - want[0], 0.0, slack);
    REQUIRE_NEAR(t, wide(q.p[1]) - want[1], 0.0, slack);
    REQUIRE_NEAR(t, wide(q.info.compression) - compression, 0.0, slack);
}

/* Without coupling of normal and tangent the three ends are one. */
static void impact_routh_decoupled(property_trial *t)
{
    impact q;
    double p[3][3];
    make_impact(t, TRIBO_LAW_ROUTH_NEWTON, &q);
    q.w[1] = q.w[2] = 0.0;
    ASSUME(t, q.u[0] < 0.0);
    for (uint32_t i = 0; i < 3; i++) {
        q.options.law = TRIBO_LAW_ROUTH_NEWTON + i;
        REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
        memcpy(p[i], q.p, sizeof q.p);
        REQUIRE_NEAR(t, q.p[0], -(1.0 + q.pair.e) * q.u[0] / q.w[0], 64.0 * EPS * q.p[0]);
    }
    const double slack = 64.0 * EPS * reference_condition(q.w) * norm3(p[0]);
    REQUIRE_AT_MOST(t, distance3(p[0], p[1]), slack);
    REQUIRE_AT_MOST(t, distance3(p[0], p[2]), slack);
}

/* An approach so slow that it ends before slip has changed, and its square may be no double: (1 + e)
 * |u_n| over the slope of u_n, whatever the hypothesis of restitution. */
static void impact_slow(property_trial *t)
{
    impact q;
    make_impact(t, TRIBO_LAW_ROUTH_NEWTON + make_choice(t, "law", 3), &q);
    q.u[0] = -make_positive(t, "speed", -960, -200);
    const double speed = norm2(q.u + 1);
    ASSUME(t, speed > 0x1p-40);
    const long double along =
        (wide(q.w[1]) * wide(q.u[1]) + wide(q.w[2]) * wide(q.u[2])) / wide(speed);
    const long double slope = wide(q.w[0]) - wide(q.pair.mu_d) * along;
    ASSUME(t, slope > 0.01L * wide(q.w[0]));
    const long double want = (1.0L + wide(q.pair.e)) * wide(-q.u[0]) / slope;
    ASSUME(t, want * wide(norm3(q.w) + norm3(q.w + 3)) * (1.0L + wide(q.pair.mu_s)) <
                  0x1p-80L * wide(speed));
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE(t, q.info.mode == TRIBO_MODE_SLIP);
    const long double rounding = wide(q.w[0]) + wide(q.pair.mu_d) * wide(norm2(q.w + 1));
    REQUIRE_NEAR(t, wide(q.p[0]) - want, 0.0, 16.0L * wide(EPS) * want * rounding / slope);
}

static void impact_frictionless(property_trial *t)
{
    impact q;
    make_impact(t, TRIBO_LAW_FRICTIONLESS, &q);
    ASSUME(t, q.u[0] < 0.0);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    require_restitution(t, &q);
    const double want = -(1.0 + q.pair.e) * q.u[0] / q.w[0];
    const double taken = -0.5 * (1.0 - q.pair.e * q.pair.e) * q.u[0] * q.u[0] / q.w[0];
    REQUIRE(t, q.p[1] == 0.0 && q.p[2] == 0.0);
    REQUIRE_NEAR(t, q.p[0], want, 4.0 * EPS * want);
    REQUIRE_NEAR(t, energy_of(&q), taken, 16.0 * EPS * q.u[0] * q.u[0] / q.w[0]);
}

/* mu = 0: every law but the lecture's is the frictionless one. */
static void impact_without_friction(property_trial *t)
{
    impact q;
    double want[3];
    static const uint32_t laws[5] = {TRIBO_LAW_ALGEBRAIC, TRIBO_LAW_COULOMB, TRIBO_LAW_ROUTH_NEWTON,
                                     TRIBO_LAW_ROUTH_POISSON, TRIBO_LAW_ROUTH_STRONGE};
    make_impact(t, TRIBO_LAW_FRICTIONLESS, &q);
    q.pair.mu_s = q.pair.mu_d = 0.0;
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    memcpy(want, q.p, sizeof want);
    q.options.law = laws[make_choice(t, "law", 5)];
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE_AT_MOST(t, distance3(q.p, want), 8.0 * EPS * norm3(want));
}

/* The lecture's velocities after the impact, in both readings. */
static void impact_lecture(property_trial *t)
{
    impact q;
    double v[3];
    make_impact(
        t, make_choice(t, "closing", 2) == 0 ? TRIBO_LAW_LECTURE : TRIBO_LAW_LECTURE_CLOSING, &q);
    ASSUME(t, q.u[0] < 0.0 && q.condition < 1e11);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    require_impact(t, &q);
    const double speed = norm2(q.u + 1);
    const double closing = -q.u[0];
    ASSUME(t, fabs(speed - q.pair.mu_s * closing) > 1e-12 * speed);
    double share = 0.0;
    if (speed > q.pair.mu_s * closing) {
        share = 1.0 - q.pair.mu_d;
        if (q.options.law == TRIBO_LAW_LECTURE_CLOSING) {
            share = 1.0 - q.pair.mu_d * closing / speed;
            share = share > 0.0 ? share : 0.0;
        }
    }
    reference_velocity(q.w, q.u, q.p, v);
    const double slack = 64.0 * EPS * q.condition * q.velocity;
    REQUIRE_NEAR(t, v[0], q.pair.e * closing, slack);
    REQUIRE_NEAR(t, v[1], share * q.u[1], slack);
    REQUIRE_NEAR(t, v[2], share * q.u[2], slack);
    REQUIRE(t, q.info.mode == (share == 0.0 ? TRIBO_MODE_STICK : TRIBO_MODE_SLIP) ||
                   q.pair.mu_d >= 1.0);
}

/* Separating: no law does anything. */
static void impact_open(property_trial *t)
{
    impact q;
    static const double zero[3] = {0, 0, 0};
    make_impact(t, make_choice(t, "law", LAWS), &q);
    q.u[0] = make_choice(t, "touching", 4) == 1 ? -0.0 : fabs(q.u[0]);
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE_SAME(t, q.p, zero, sizeof zero);
    REQUIRE(t, q.info.mode == TRIBO_MODE_OPEN && q.info.energy == 0.0);
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, q.info.velocity[i] == q.u[i]);
    }
}

/* W 2^i and u 2^j: p 2^(j - i), to the bit, by every law. */
static void impact_scaled(property_trial *t)
{
    impact q;
    impact r;
    make_impact(t, make_choice(t, "law", LAWS), &q);
    ASSUME(t, q.condition < 1e11);
    r = q;
    const int i = make_exponent(t, -450, 450);
    const int j = make_exponent(t, -450, 450);
    for (int k = 0; k < 6; k++) {
        r.w[k] = ldexp(q.w[k], i);
    }
    for (int k = 0; k < 3; k++) {
        r.u[k] = ldexp(q.u[k], j);
    }
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    /* the change of energy has the scale 2^(2j - i): it must be a number */
    ASSUME(t, abs(2 * j - i) < 600 && abs(j - i) < 800);
    REQUIRE_STATUS(t, strike(&r), TRIBO_OK);
    for (int k = 0; k < 3; k++) {
        REQUIRE(t, r.p[k] == ldexp(q.p[k], j - i));
        REQUIRE(t, r.info.velocity[k] == ldexp(q.info.velocity[k], j));
    }
    REQUIRE(t, r.info.mode == q.info.mode && r.info.iterations == q.info.iterations);
    REQUIRE(t, r.info.kappa == q.info.kappa);
    REQUIRE(t, r.info.compression == ldexp(q.info.compression, j - i));
    REQUIRE(t, r.info.energy == ldexp(q.info.energy, 2 * j - i));
}

/* Plastic impacts that stick are one and the same in all laws that stick. */
static void impact_sticks(property_trial *t)
{
    impact q;
    long double stick[3];
    make_impact(t, make_choice(t, "coulomb", 2) == 0 ? TRIBO_LAW_ALGEBRAIC : TRIBO_LAW_COULOMB, &q);
    q.pair.e = 0.0;
    q.pair.mu_s = q.pair.mu_d = make_positive(t, "mu", 0, 9);
    const long double minus[3] = {-wide(q.u[0]), -wide(q.u[1]), -wide(q.u[2])};
    ASSUME(t, q.u[0] < 0.0 && reference_solve(q.w, minus, stick));
    const double want[3] = {(double)stick[0], (double)stick[1], (double)stick[2]};
    const double slack = 128.0 * EPS * q.condition * norm3(want);
    ASSUME(t, norm2(want + 1) + slack < q.pair.mu_s * (want[0] - slack));
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE_AT_MOST(t, distance3(q.p, want), slack);
    REQUIRE(t, q.info.mode == TRIBO_MODE_STICK);
}

/* Semidefinite matrices: always for FRICTIONLESS and ALGEBRAIC, never for LECTURE. */
static void impact_singular(property_trial *t)
{
    impact q;
    const uint32_t law = make_choice(t, "law", LAWS);
    make_impact(t, law, &q);
    make_matrix_of(t, "w", MATRIX_SINGULAR, q.w);
    ASSUME(t, q.w[0] > 0.0);
    q.u[0] = -make_positive(t, "u_n", -4, 2);
    q.u[1] = make_real(t, "u_1", -4, 2);
    q.u[2] = make_real(t, "u_2", -4, 2);
    canary_set(q.p, sizeof q.p);
    const tribo_status status = strike(&q);
    if (law == TRIBO_LAW_LECTURE || law == TRIBO_LAW_LECTURE_CLOSING) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_CONTACT_MATRIX);
    } else if (law == TRIBO_LAW_FRICTIONLESS || law == TRIBO_LAW_ALGEBRAIC) {
        REQUIRE_STATUS(t, status, TRIBO_OK);
    } else {
        REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_JAM);
    }
    if (status != TRIBO_OK) {
        REQUIRE(t, canary_kept(q.p, sizeof q.p));
        return;
    }
    require_impact(t, &q);
    require_cone(t, &q, q.pair.mu_s);
    if (law == TRIBO_LAW_ALGEBRAIC) {
        double v[3];
        reference_velocity(q.w, q.u, q.p, v);
        REQUIRE_NEAR(t, v[0], -q.pair.e * q.u[0], 64.0 * EPS * q.velocity);
        REQUIRE_AT_MOST(t, energy_of(&q), 64.0 * EPS * q.impulse * q.velocity);
    }
}

static void impact_bad(property_trial *t)
{
    impact q;
    tribo_status expected = TRIBO_ERROR_NOT_FINITE;
    make_impact(t, make_choice(t, "law", LAWS), &q);
    canary_set(q.p, sizeof q.p);
    canary_set(&q.info, sizeof q.info);
    q.info.struct_size = sizeof q.info;
    const tribo_impact_info untouched = q.info;
    REQUIRE_STATUS(t, tribo_impact(NULL, q.u, &q.pair, NULL, q.p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_impact(q.w, NULL, &q.pair, NULL, q.p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_impact(q.w, q.u, NULL, NULL, q.p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_impact(q.w, q.u, &q.pair, NULL, NULL, NULL), TRIBO_ERROR_NULL);
    const double size = make_positive(t, "size", -30, 30);
    const int low = make_choice(t, "low", 2) == 1;
    switch (make_choice(t, "kind", 8)) {
    case 0:
        q.pair.mu_d = -size;
        expected = TRIBO_ERROR_FRICTION;
        break;
    case 1:
        q.pair.mu_d = q.pair.mu_s + size * (1.0 + q.pair.mu_s);
        expected = TRIBO_ERROR_FRICTION;
        break;
    case 2:
        q.pair.e = low ? -size : 1.0 + size + 2.0 * EPS;
        expected = TRIBO_ERROR_RESTITUTION;
        break;
    case 3:
        q.options.tangential_restitution = low ? -1.0 - size - EPS : 1.0 + size + 2.0 * EPS;
        expected = TRIBO_ERROR_RESTITUTION;
        break;
    case 4:
        q.options.law = LAWS + (uint32_t)make_bits(t, 3);
        expected = TRIBO_ERROR_OPTION;
        break;
    case 5:
        q.w[0] = q.w[1] = q.w[2] = 0.0;
        expected = TRIBO_ERROR_IMMOVABLE;
        break;
    case 6:
        q.u[make_choice(t, "entry", 3)] = low ? -0x1.001p1000 : 0x1.1p1001;
        expected = TRIBO_ERROR_RANGE;
        break;
    default: {
        double *const arrays[4] = {q.w, q.u, (double *)&q.pair, &q.options.tangential_restitution};
        const uint32_t lengths[4] = {6, 3, 3, 1};
        spoil(t, arrays, lengths, 4);
        break;
    }
    }
    const tribo_status status = tribo_impact(q.w, q.u, &q.pair, &q.options, q.p, &q.info);
    REQUIRE_STATUS(t, status, expected);
    REQUIRE(t, canary_kept(q.p, sizeof q.p));
    REQUIRE_SAME(t, &q.info, &untouched, sizeof untouched);
}

/* Any finite numbers: a named status, and finite results or none. */
static void impact_wild(property_trial *t)
{
    impact q;
    make_impact(t, make_choice(t, "law", LAWS), &q);
    for (uint32_t i = make_choice(t, "faults", 4); i > 0; i--) {
        double *const arrays[2] = {q.w, q.u};
        const uint32_t field = make_choice(t, "field", 9);
        arrays[field / 6][field % 6] = make_finite(t, NULL);
    }
    if (make_choice(t, "scale", 4) == 1) {
        const double size = make_positive(t, NULL, -1074, 1023);
        for (int i = 0; i < 6; i++) {
            q.w[i] *= size;
        }
    }
    property_note(t, "w", q.w, 6);
    property_note(t, "u", q.u, 3);
    canary_set(q.p, sizeof q.p);
    const tribo_status status = strike(&q);
    if (status == TRIBO_OK) {
        REQUIRE(t, all_finite(q.p, 3) && all_finite(q.info.velocity, 3));
        REQUIRE(t, isfinite(q.info.energy) && isfinite(q.info.kappa));
        REQUIRE(t, isfinite(q.info.compression) && q.info.mode <= TRIBO_MODE_SLIP);
        return;
    }
    REQUIRE(t, status == TRIBO_ERROR_RANGE || status == TRIBO_ERROR_CONTACT_MATRIX ||
                   status == TRIBO_ERROR_IMMOVABLE || status == TRIBO_ERROR_JAM ||
                   (status == TRIBO_ERROR_NOT_FINITE && !all_finite(q.w, 6)));
    REQUIRE(t, canary_kept(q.p, sizeof q.p));
}

/* ---- structs of other ages ---------------------------------------------------------------- */

/* Accepted sizes: multiples of four up to the newest. */
static int known_size(uint32_t size, size_t newest)
{
    return size >= 4 && size <= newest && size % 4 == 0;
}

static uint32_t make_size(property_trial *t, size_t newest)
{
    const uint32_t near = make_choice(t, "struct_size", (uint32_t)newest + 16);
    return make_byte(t) < 240 ? near : (uint32_t)make_bits(t, 4);
}

/* A struct in memory of its own, and how much of it there is. */
typedef struct aged {
    uint8_t *memory;
    uint32_t size; /* what struct_size says */
    size_t bytes;
} aged;

/* As long as it says, so that a sanitizer sees what reads or writes beyond; or with a margin
 * behind it that is looked at afterwards. */
static aged make_struct(property_trial *t, uint32_t size, size_t newest)
{
    aged s = {NULL, size, size < 4 ? 4 : size > newest ? newest : size};
    s.bytes += make_choice(t, "margin", 2) * 24;
    s.memory = malloc(s.bytes);
    if (s.memory == NULL) {
        abort();
    }
    canary_set(s.memory, s.bytes);
    memcpy(s.memory, &size, sizeof size);
    return s;
}

enum { LARGEST = 512 };

/* Frees the struct. `full`: what its prefix must be, but for the size; null: as it was made. */
static int aged_fits(aged s, const void *full)
{
    uint8_t expected[LARGEST];
    canary_set(expected, s.bytes);
    if (full != NULL) {
        memcpy(expected, full, s.size);
    }
    memcpy(expected, &s.size, sizeof s.size);
    const int fits = memcmp(s.memory, expected, s.bytes) == 0;
    free(s.memory);
    return fits;
}

static void info_sizes(property_trial *t)
{
    problem q;
    double full_w[9];
    double p[3];
    tribo_solve_info full;
    make_problem(t, 0, &q);
    full_matrix(q.w, full_w);
    const uint32_t size = make_size(t, sizeof full);
    const int general = make_choice(t, "general", 2) == 1;
    const int known = known_size(size, sizeof full);
    const aged old = make_struct(t, size, sizeof full);
    tribo_solve_info *info = (tribo_solve_info *)(void *)old.memory;
    full.struct_size = sizeof full;
    canary_set(p, sizeof p);
    const tribo_status status =
        general ? tribo_contact_solve_general(full_w, q.b, q.mu_s, q.mu_d, p, info)
                : tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, p, info);
    const int untouched = canary_kept(p, sizeof p);
    const tribo_status again =
        general ? tribo_contact_solve_general(full_w, q.b, q.mu_s, q.mu_d, p, &full)
                : tribo_contact_solve(q.w, q.b, q.mu_s, q.mu_d, p, &full);
    const int fits = aged_fits(old, known ? &full : NULL);
    REQUIRE_STATUS(t, again, TRIBO_OK);
    REQUIRE_STATUS(t, status, known ? TRIBO_OK : TRIBO_ERROR_STRUCT_SIZE);
    REQUIRE(t, fits && (known || untouched));
}

static void impact_sizes(property_trial *t)
{
    impact q;
    double p[3];
    make_impact(t, make_choice(t, "law", LAWS), &q);
    const uint32_t size = make_size(t, sizeof q.info);
    const int known = known_size(size, sizeof q.info);
    const aged old = make_struct(t, size, sizeof q.info);
    canary_set(p, sizeof p);
    const tribo_status status =
        tribo_impact(q.w, q.u, &q.pair, &q.options, p, (tribo_impact_info *)(void *)old.memory);
    const tribo_status again = strike(&q);
    const int untouched = canary_kept(p, sizeof p);
    const int fits = aged_fits(old, known ? &q.info : NULL);
    REQUIRE_STATUS(t, again, TRIBO_OK);
    REQUIRE_STATUS(t, status, known ? TRIBO_OK : TRIBO_ERROR_STRUCT_SIZE);
    REQUIRE(t, fits && (known ? property_same(p, q.p, sizeof p) : untouched));
}

/* Options that end early mean zeros for the rest. */
static void option_sizes(property_trial *t)
{
    impact q;
    double p[3];
    make_impact(t, make_choice(t, "law", LAWS), &q);
    q.options.tangential_restitution = make_signed(t, "e_t");
    const uint32_t size = make_size(t, sizeof q.options);
    const int known = known_size(size, sizeof q.options);
    const aged old = make_struct(t, size, sizeof q.options);
    if (known) {
        memcpy(old.memory + 4, (const uint8_t *)&q.options + 4, size - 4);
    }
    canary_set(p, sizeof p);
    const tribo_status status = tribo_impact(
        q.w, q.u, &q.pair, (const tribo_impact_options *)(const void *)old.memory, p, NULL);
    const int fits = aged_fits(old, known ? &q.options : NULL);
    REQUIRE(t, fits);
    if (!known) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_STRUCT_SIZE);
        REQUIRE(t, canary_kept(p, sizeof p));
        return;
    }
    q.options.law = size >= 8 ? q.options.law : TRIBO_LAW_ALGEBRAIC;
    q.options.tangential_restitution =
        size >= sizeof q.options ? q.options.tangential_restitution : 0.0;
    REQUIRE_STATUS(t, strike(&q), TRIBO_OK);
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE_SAME(t, p, q.p, sizeof p);
}

/* ---- a whole collision -------------------------------------------------------------------- */

typedef struct collision {
    scene s;
    tribo_material pair;
    tribo_impact_options options;
    tribo_collision_info info;
    double condition;
    double bound; /* sum (1/m + |r|^2 |I^-1|), what rounding of W is relative to */
} collision;

static const uint32_t smooth_laws[2] = {TRIBO_LAW_ALGEBRAIC, TRIBO_LAW_FRICTIONLESS};

static void make_collision(property_trial *t, uint32_t kind, uint32_t law, collision *c)
{
    double frame[9];
    double w[6];
    make_scene(t, kind, &c->s);
    make_material(t, "pair", &c->pair);
    memset(&c->options, 0, sizeof c->options);
    c->options.struct_size = sizeof c->options;
    c->options.law = law;
    tribo_basis_from_normal(c->s.contact.normal, frame);
    reference_matrix(&c->s, frame, w, &c->bound);
    c->condition = reference_condition(w);
}

static tribo_body *other(scene *s)
{
    return s->has_b ? &s->b : NULL;
}

static tribo_status collide(collision *c)
{
    memset(&c->info, 0, sizeof c->info);
    c->info.struct_size = sizeof c->info;
    return tribo_collide(&c->s.a, other(&c->s), c->s.point, c->s.contact.normal, &c->pair,
                         &c->options, &c->info);
}

static tribo_status resolve(collision *c)
{
    memset(&c->info, 0, sizeof c->info);
    c->info.struct_size = sizeof c->info;
    return tribo_contact_resolve(&c->s.a, other(&c->s), &c->s.contact, &c->pair, &c->options,
                                 &c->info);
}

/* One call is the same as its parts, to the bit; only velocities change. */
static void collide_parts(property_trial *t)
{
    collision c;
    double frame[9];
    double w[6];
    double u[3];
    double p[3];
    double world[3];
    tribo_impact_info part;
    make_collision(t, BODY_WIDE, make_choice(t, "law", LAWS), &c);
    ASSUME(t, c.condition < 1e10);
    collision r = c;
    scene s = c.s;
    tribo_body *b = other(&s);
    part.struct_size = sizeof part;
    REQUIRE_STATUS(t, collide(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&r), TRIBO_OK);
    REQUIRE_SAME(t, &c.s, &r.s, sizeof c.s);
    REQUIRE_SAME(t, &c.info, &r.info, sizeof c.info);
    REQUIRE_STATUS(t, tribo_basis_from_normal(s.contact.normal, frame), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_matrix(&s.a, b, &s.contact, frame, w), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, b, &s.contact, frame, u), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_impact(w, u, &c.pair, &c.options, p, &part), TRIBO_OK);
    REQUIRE_SAME(t, c.info.frame, frame, sizeof frame);
    REQUIRE_SAME(t, c.info.matrix, w, sizeof w);
    REQUIRE_SAME(t, c.info.velocity_before, u, sizeof u);
    REQUIRE_SAME(t, c.info.velocity_after, part.velocity, sizeof u);
    REQUIRE_SAME(t, c.info.impulse, p, sizeof p);
    REQUIRE(t, c.info.mode == part.mode && c.info.iterations == part.iterations);
    REQUIRE(t, c.info.energy == part.energy && c.info.reserved == 0);
    tribo_mat3_apply_transposed(frame, p, world);
    REQUIRE_SAME(t, c.info.impulse_world, world, sizeof world);
    if (part.mode != TRIBO_MODE_OPEN) {
        REQUIRE_STATUS(t, tribo_contact_apply(&s.a, b, &s.contact, frame, p), TRIBO_OK);
    }
    REQUIRE_SAME(t, &s, &c.s, sizeof s);
}

/* Momentum of both bodies, angular about one common point; the change of energy is p . (u- + u+)
 * / 2. */
static void collide_conserves(property_trial *t)
{
    collision c;
    double origin[3];
    momenta before;
    momenta after;
    const uint32_t kind = make_choice(t, "wide", 2) == 1 ? BODY_WIDE : BODY_PLAIN;
    make_collision(t, kind, make_choice(t, "law", LAWS), &c);
    make_vector(t, "origin", -4, 6, origin);
    ASSUME(t, c.condition < 1e10);
    measure(&c.s, origin, &before);
    REQUIRE_STATUS(t, collide(&c), TRIBO_OK);
    measure(&c.s, origin, &after);
    if (c.s.has_b) {
        const double turning = turning_scale(&c.s, norm3(c.info.impulse));
        require_conserved(t, &before, &after, kind == BODY_PLAIN ? 0.0 : turning);
    }
    const double size =
        kind == BODY_PLAIN ? before.energy + after.energy : before.rounding + after.rounding;
    REQUIRE_NEAR(t, after.energy - before.energy, c.info.energy, 64.0 * EPS * c.condition * size);
}

/* The velocities that the info gives are those of the bodies. */
static void collide_velocity(property_trial *t)
{
    collision c;
    double u[3];
    make_collision(t, BODY_PLAIN, make_choice(t, "law", LAWS), &c);
    REQUIRE_STATUS(t, collide(&c), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_velocity(&c.s.a, other(&c.s), &c.s.contact, c.info.frame, u),
                   TRIBO_OK);
    const double size = norm3(c.info.velocity_before) + c.bound * norm3(c.info.impulse) +
                        norm3(c.s.a.velocity) + norm3(c.s.b.velocity) +
                        norm3(c.s.a.angular_velocity) * norm3(c.s.contact.arm_a) +
                        norm3(c.s.b.angular_velocity) * norm3(c.s.contact.arm_b);
    REQUIRE_AT_MOST(t, distance3(u, c.info.velocity_after), 64.0 * EPS * size);
    if (c.options.law != TRIBO_LAW_ROUTH_POISSON && c.options.law != TRIBO_LAW_ROUTH_STRONGE &&
        c.info.mode != TRIBO_MODE_OPEN) {
        REQUIRE_NEAR(t, u[0], -c.pair.e * c.info.velocity_before[0], 64.0 * EPS * size);
    }
}

/* Bodies that part are not touched at all. */
static void collide_separating(property_trial *t)
{
    collision c;
    double u[3];
    double frame[9];
    make_collision(t, BODY_WIDE, make_choice(t, "law", LAWS), &c);
    tribo_basis_from_normal(c.s.contact.normal, frame);
    tribo_contact_velocity(&c.s.a, other(&c.s), &c.s.contact, frame, u);
    if (u[0] < 0.0) {
        /* twice the approach, the other way */
        tribo_vec3_add_scaled(c.s.a.velocity, -2.0 * u[0], c.s.contact.normal, c.s.a.velocity);
        tribo_contact_velocity(&c.s.a, other(&c.s), &c.s.contact, frame, u);
    }
    ASSUME(t, u[0] >= 0.0 && c.condition < 1e10);
    const scene before = c.s;
    REQUIRE_STATUS(t, collide(&c), TRIBO_OK);
    REQUIRE_SAME(t, &c.s, &before, sizeof before);
    REQUIRE(t, c.info.mode == TRIBO_MODE_OPEN && c.info.energy == 0.0);
    REQUIRE(t, norm3(c.info.impulse) == 0.0 && norm3(c.info.impulse_world) == 0.0);
}

/* The world, or a body that cannot be moved: the same bits. */
static void collide_immovable(property_trial *t)
{
    collision c;
    make_collision(t, BODY_WIDE, make_choice(t, "law", LAWS), &c);
    ASSUME(t, c.condition < 1e10);
    c.s.has_b = 0;
    collision r = c;
    r.s.has_b = 1;
    make_immovable(t, &r.s.b);
    const tribo_body fixed = r.s.b;
    const tribo_status status = collide(&c);
    REQUIRE_STATUS(t, collide(&r), status);
    ASSUME(t, status == TRIBO_OK);
    REQUIRE_SAME(t, &c.s.a, &r.s.a, sizeof c.s.a);
    REQUIRE_SAME(t, &c.info, &r.info, sizeof c.info);
    REQUIRE_SAME(t, &r.s.b, &fixed, sizeof fixed);
}

static double mu_scale(const collision *c)
{
    return c->pair.mu_s > 1.0 ? c->pair.mu_s : 1.0;
}

static void swap_bodies(scene *s)
{
    const tribo_body body = s->a;
    double arm[3];
    s->a = s->b;
    s->b = body;
    memcpy(arm, s->contact.arm_a, sizeof arm);
    memcpy(s->contact.arm_a, s->contact.arm_b, sizeof arm);
    memcpy(s->contact.arm_b, arm, sizeof arm);
    tribo_vec3_scale(-1.0, s->contact.normal, s->contact.normal);
}

/* A and B exchanged, the normal and one tangent turned round: the same W and the same impulse but
 * for signs, to the bit. */
static void swap_exact(property_trial *t)
{
    collision c;
    double frame[9];
    double w[6];
    double u[3];
    double p[3];
    double swapped_w[6];
    double swapped[3];
    make_collision(t, BODY_PLAIN, make_choice(t, "law", LAWS), &c);
    ASSUME(t, c.s.has_b);
    tribo_basis_from_normal(c.s.contact.normal, frame);
    tribo_contact_velocity(&c.s.a, &c.s.b, &c.s.contact, frame, u);
    REQUIRE_STATUS(t, tribo_contact_matrix(&c.s.a, &c.s.b, &c.s.contact, frame, w), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_impact(w, u, &c.pair, &c.options, p, NULL), TRIBO_OK);
    swap_bodies(&c.s);
    for (int i = 0; i < 9; i++) {
        frame[i] = i / 3 == 1 ? frame[i] : -frame[i];
    }
    tribo_contact_velocity(&c.s.a, &c.s.b, &c.s.contact, frame, u);
    REQUIRE_STATUS(t, tribo_contact_matrix(&c.s.a, &c.s.b, &c.s.contact, frame, swapped_w),
                   TRIBO_OK);
    REQUIRE_STATUS(t, tribo_impact(swapped_w, u, &c.pair, &c.options, swapped, NULL), TRIBO_OK);
    swapped[1] = -swapped[1];
    for (int i = 0; i < 6; i++) {
        REQUIRE(t, swapped_w[i] == (i == 1 || i == 4 ? -w[i] : w[i]));
    }
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, swapped[i] == p[i]);
    }
}

/* Differences that rounding of the input makes to laws that are continuous in it. */
static double sensitivity(const collision *c)
{
    return EPS * c->condition * mu_scale(c);
}

/* Which of the continuous laws, one coefficient of friction. */
static void make_smooth(property_trial *t, uint32_t kind, collision *c)
{
    make_collision(t, kind, smooth_laws[make_choice(t, "law", 2)], c);
    c->pair.mu_d = c->pair.mu_s;
}

/* Rounding of the arms and velocities that the frame turns. */
static double speed_scale(const collision *c)
{
    return norm3(c->s.a.velocity) + norm3(c->s.b.velocity) +
           norm3(c->s.a.angular_velocity) * norm3(c->s.contact.arm_a) +
           norm3(c->s.b.angular_velocity) * norm3(c->s.contact.arm_b);
}

static void collide_swapped(property_trial *t)
{
    collision c;
    make_smooth(t, BODY_PLAIN, &c);
    ASSUME(t, c.s.has_b);
    collision r = c;
    swap_bodies(&r.s);
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&r), TRIBO_OK);
    tribo_vec3_scale(-1.0, r.info.impulse_world, r.info.impulse_world);
    const double size = norm3(c.info.impulse) + speed_scale(&c) / c.info.matrix[0];
    REQUIRE_AT_MOST(t, distance3(c.info.impulse_world, r.info.impulse_world),
                    64.0 * sensitivity(&c) * size);
}

/* ---- objectivity -------------------------------------------------------------------------- */

static void turn_vector(const long double r[9], double v[3])
{
    double turned[3];
    for (int i = 0; i < 3; i++) {
        turned[i] =
            (double)(r[3 * i] * wide(v[0]) + r[3 * i + 1] * wide(v[1]) + r[3 * i + 2] * wide(v[2]));
    }
    memcpy(v, turned, sizeof turned);
}

static void turn_body(const double q[4], const long double r[9], tribo_body *body)
{
    turn_vector(r, body->position);
    turn_vector(r, body->velocity);
    turn_vector(r, body->angular_velocity);
    tribo_quat_multiply(q, body->orientation, body->orientation);
}

/* The whole world turned: the impulse turned. */
static void collide_objective(property_trial *t)
{
    collision c;
    double q[4];
    long double r[9];
    make_smooth(t, BODY_PLAIN, &c);
    make_quat(t, "turn", q);
    reference_rotation(q, r);
    collision d = c;
    turn_body(q, r, &d.s.a);
    turn_body(q, r, &d.s.b);
    turn_vector(r, d.s.contact.normal);
    turn_vector(r, d.s.contact.arm_a);
    turn_vector(r, d.s.contact.arm_b);
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&d), TRIBO_OK);
    turn_vector(r, c.info.impulse_world);
    const double size = norm3(c.info.impulse) + speed_scale(&c) / c.info.matrix[0];
    REQUIRE_AT_MOST(t, distance3(c.info.impulse_world, d.info.impulse_world),
                    64.0 * sensitivity(&c) * size);
}

/* A common velocity is of no matter. */
static void collide_galilean(property_trial *t)
{
    collision c;
    double v[3];
    make_smooth(t, BODY_PLAIN, &c);
    ASSUME(t, c.s.has_b);
    make_vector(t, "common velocity", -10, 10, v);
    collision d = c;
    tribo_vec3_add(c.s.a.velocity, v, d.s.a.velocity);
    tribo_vec3_add(c.s.b.velocity, v, d.s.b.velocity);
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&d), TRIBO_OK);
    const double size = norm3(c.info.impulse) + (speed_scale(&c) + norm3(v)) / c.info.matrix[0];
    REQUIRE_AT_MOST(t, distance3(c.info.impulse_world, d.info.impulse_world),
                    16.0 * sensitivity(&c) * size);
}

/* Far from the origin: the same bits if arms are passed, else as good as the arms. */
static void collide_translated(property_trial *t)
{
    collision c;
    double x[3];
    make_smooth(t, BODY_PLAIN, &c);
    make_vector(t, "shift", -10, 30, x);
    collision d = c;
    tribo_vec3_add(c.s.a.position, x, d.s.a.position);
    tribo_vec3_add(c.s.b.position, x, d.s.b.position);
    tribo_vec3_add(c.s.point, x, d.s.point);
    collision e = d;
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&e), TRIBO_OK);
    REQUIRE_SAME(t, &c.info, &e.info, sizeof c.info);
    const double shortest = !c.s.has_b || norm3(c.s.contact.arm_a) < norm3(c.s.contact.arm_b)
                                ? norm3(c.s.contact.arm_a)
                                : norm3(c.s.contact.arm_b);
    const double far = norm3(x) + norm3(c.s.point);
    ASSUME(t, far * EPS < 1e-3 * shortest);
    REQUIRE_STATUS(t, collide(&d), TRIBO_OK);
    const double size = norm3(c.info.impulse) + speed_scale(&c) / c.info.matrix[0];
    REQUIRE_AT_MOST(t, distance3(c.info.impulse_world, d.info.impulse_world),
                    sensitivity(&c) * (16.0 + 4.0 * far / shortest) * size);
}

/* A very heavy body is as good as an immovable one. */
static void collide_mass_limit(property_trial *t)
{
    collision c;
    make_smooth(t, BODY_PLAIN, &c);
    ASSUME(t, c.s.has_b);
    const int heavier = 10 + make_byte(t) % 60;
    memset(c.s.b.velocity, 0, sizeof c.s.b.velocity);
    memset(c.s.b.angular_velocity, 0, sizeof c.s.b.angular_velocity);
    c.s.b.inverse_mass = ldexp(c.s.b.inverse_mass, -heavier);
    for (int i = 0; i < 6; i++) {
        c.s.b.inverse_inertia[i] = ldexp(c.s.b.inverse_inertia[i], -heavier);
    }
    collision d = c;
    d.s.has_b = 0;
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE_STATUS(t, resolve(&d), TRIBO_OK);
    const double both = c.bound;
    double frame[9];
    double w[6];
    double alone;
    tribo_basis_from_normal(c.s.contact.normal, frame);
    reference_matrix(&d.s, frame, w, &alone);
    /* W of the heavy body, against the least eigenvalue of the light one's */
    const double ratio = ldexp(both, -heavier) / d.s.a.inverse_mass;
    const double mu = mu_scale(&c);
    const double size = norm3(d.info.impulse) + norm3(d.info.velocity_before) / w[0];
    REQUIRE_AT_MOST(t, distance3(c.info.impulse_world, d.info.impulse_world),
                    (4.0 * ratio * mu + 64.0 * EPS * mu * reference_condition(w)) * size);
}

static void flatten(tribo_body *body)
{
    const double *q = body->orientation;
    const double length = sqrt(q[0] * q[0] + q[2] * q[2]);
    const double turn[4] = {length > 0.1 ? q[0] / length : 1.0, 0.0,
                            length > 0.1 ? q[2] / length : 0.0, 0.0};
    memcpy(body->orientation, turn, sizeof turn);
    body->position[1] = body->velocity[1] = 0.0;
    body->angular_velocity[0] = body->angular_velocity[2] = 0.0;
    body->inverse_inertia[1] = body->inverse_inertia[2] = body->inverse_inertia[4] = 0.0;
}

/* What moves in the x-z plane stays in it, to the bit. */
static void collide_planar(property_trial *t)
{
    collision c;
    double half[3];
    make_collision(t, BODY_PLAIN, make_choice(t, "law", LAWS), &c);
    if (!c.s.has_b) {
        make_body(t, "b", BODY_PLAIN, &c.s.b, half);
    }
    flatten(&c.s.a);
    flatten(&c.s.b);
    double *n = c.s.contact.normal;
    const double length = sqrt(n[0] * n[0] + n[2] * n[2]);
    ASSUME(t, length > 0.1);
    n[0] /= length;
    n[2] /= length;
    n[1] = c.s.contact.arm_a[1] = c.s.contact.arm_b[1] = 0.0;
    REQUIRE_STATUS(t, resolve(&c), TRIBO_OK);
    REQUIRE(t, c.info.impulse[2] == 0.0 && c.info.impulse_world[1] == 0.0);
    REQUIRE(t, c.info.velocity_after[2] == 0.0);
    const tribo_body *bodies[2] = {&c.s.a, &c.s.b};
    for (uint32_t i = 0; i < 1 + c.s.has_b; i++) {
        REQUIRE(t, bodies[i]->velocity[1] == 0.0 && bodies[i]->angular_velocity[0] == 0.0);
        REQUIRE(t, bodies[i]->angular_velocity[2] == 0.0);
    }
}

/* ---- a collision of bad things ------------------------------------------------------------ */

static void collide_bad(property_trial *t)
{
    collision c;
    make_collision(t, BODY_ANY, make_choice(t, "law", LAWS), &c);
    tribo_status expected = TRIBO_ERROR_NOT_FINITE;
    const double size = make_positive(t, "size", -18, 8);
    tribo_body *hit = c.s.has_b && make_choice(t, "body", 2) == 1 ? &c.s.b : &c.s.a;
    switch (make_choice(t, "kind", 9)) {
    case 0:
        hit->inverse_mass = -size;
        expected = TRIBO_ERROR_MASS;
        break;
    case 1:
        hit->inverse_inertia[3] = -size;
        expected = TRIBO_ERROR_INERTIA;
        break;
    case 2:
        hit->orientation[0] += copysign(2.0 + size, hit->orientation[0]);
        expected = TRIBO_ERROR_ORIENTATION;
        break;
    case 3:
        tribo_vec3_scale(1.0 + size, c.s.contact.normal, c.s.contact.normal);
        expected = TRIBO_ERROR_NORMAL;
        break;
    case 4:
        c.pair.mu_d = c.pair.mu_s + size * (1.0 + c.pair.mu_s);
        expected = TRIBO_ERROR_FRICTION;
        break;
    case 5:
        c.pair.e = -size;
        expected = TRIBO_ERROR_RESTITUTION;
        break;
    case 6:
        c.options.tangential_restitution = 1.0 + size;
        expected = TRIBO_ERROR_RESTITUTION;
        break;
    case 7:
        c.options.law = LAWS + (uint32_t)make_bits(t, 3);
        expected = TRIBO_ERROR_OPTION;
        break;
    default: {
        double *const arrays[6] = {(double *)hit,     c.s.contact.normal,
                                   c.s.contact.arm_a, c.s.contact.arm_b,
                                   (double *)&c.pair, &c.options.tangential_restitution};
        const uint32_t lengths[6] = {20, 3, 3, 3, 3, 1};
        spoil(t, arrays, lengths, 6);
        break;
    }
    }
    canary_set(&c.info, sizeof c.info);
    c.info.struct_size = sizeof c.info;
    const collision before = c;
    REQUIRE_STATUS(
        t, tribo_contact_resolve(&c.s.a, other(&c.s), &c.s.contact, &c.pair, &c.options, &c.info),
        expected);
    REQUIRE_SAME(t, &c, &before, sizeof c);
}

static void collide_null(property_trial *t)
{
    collision c;
    make_collision(t, BODY_ANY, make_choice(t, "law", LAWS), &c);
    const collision k = c;
    tribo_body *a = &c.s.a;
    tribo_body *b = other(&c.s);
    const double *n = c.s.contact.normal;
    c.info.struct_size = sizeof c.info;
    const tribo_contact *contact = &c.s.contact;
    REQUIRE_STATUS(t, tribo_contact_resolve(NULL, b, contact, &k.pair, NULL, NULL),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_resolve(a, b, NULL, &k.pair, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_resolve(a, b, contact, NULL, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_contact_resolve(a, a, contact, &k.pair, NULL, NULL), TRIBO_ERROR_ALIAS);
    REQUIRE_STATUS(t, tribo_collide(NULL, b, c.s.point, n, &k.pair, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_collide(a, b, NULL, n, &k.pair, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_collide(a, b, c.s.point, NULL, &k.pair, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_collide(a, b, c.s.point, n, NULL, NULL, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_collide(a, a, c.s.point, n, &k.pair, NULL, NULL), TRIBO_ERROR_ALIAS);
    REQUIRE_SAME(t, &c.s, &k.s, sizeof c.s);
    double *const arrays[3] = {c.s.point, c.s.contact.normal, c.s.a.position};
    const uint32_t lengths[3] = {3, 3, 3};
    spoil(t, arrays, lengths, 3);
    const scene before = c.s;
    REQUIRE_STATUS(t, tribo_collide(a, b, c.s.point, n, &k.pair, NULL, NULL),
                   TRIBO_ERROR_NOT_FINITE);
    REQUIRE_SAME(t, &c.s, &before, sizeof before);
}

static void collision_sizes(property_trial *t)
{
    collision c;
    make_collision(t, BODY_PLAIN, make_choice(t, "law", LAWS), &c);
    const uint32_t size = make_size(t, sizeof c.info);
    const int known = known_size(size, sizeof c.info);
    const aged old = make_struct(t, size, sizeof c.info);
    const scene before = c.s;
    scene s = c.s;
    const tribo_status status =
        tribo_collide(&s.a, other(&s), s.point, s.contact.normal, &c.pair, &c.options,
                      (tribo_collision_info *)(void *)old.memory);
    const tribo_status again = collide(&c);
    const int fits = aged_fits(old, known ? &c.info : NULL);
    REQUIRE_STATUS(t, again, TRIBO_OK);
    REQUIRE_STATUS(t, status, known ? TRIBO_OK : TRIBO_ERROR_STRUCT_SIZE);
    REQUIRE(t, fits && property_same(&s, known ? &c.s : &before, sizeof s));
}

/* Any finite numbers: a named status; bodies that stay valid, or are not touched. */
static void collide_wild(property_trial *t)
{
    collision c;
    make_collision(t, BODY_ANY, make_choice(t, "law", LAWS), &c);
    make_body_wild(t, "a", &c.s.a);
    if (c.s.has_b) {
        make_body_wild(t, "b", &c.s.b);
    }
    if (make_choice(t, "wild arms", 2) == 1) {
        make_finite_vector(t, "arm_a", c.s.contact.arm_a);
        make_finite_vector(t, "arm_b", c.s.contact.arm_b);
    }
    canary_set(&c.info, sizeof c.info);
    c.info.struct_size = sizeof c.info;
    const collision before = c;
    const tribo_status status =
        tribo_contact_resolve(&c.s.a, other(&c.s), &c.s.contact, &c.pair, &c.options, &c.info);
    REQUIRE(t, status != TRIBO_ERROR_NULL && status != TRIBO_ERROR_STRUCT_SIZE);
    if (status != TRIBO_OK) {
        REQUIRE_SAME(t, &c, &before, sizeof c);
        return;
    }
    REQUIRE_STATUS(t, tribo_body_check(&c.s.a), TRIBO_OK);
    REQUIRE(t, !c.s.has_b || tribo_body_check(&c.s.b) == TRIBO_OK);
    REQUIRE(t, all_finite(c.info.frame, sizeof c.info / 8 - 2));
}

/* ---- friction of forces ------------------------------------------------------------------- */

static void friction_parts(property_trial *t)
{
    double f[3];
    double n[3];
    double reaction[3];
    double planar[3];
    make_vector(t, "f", -30, 30, f);
    make_normal(t, "n", n);
    REQUIRE_STATUS(t, tribo_friction_reaction(f, n, reaction), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_friction_planar(f, n, planar), TRIBO_OK);
    const long double along =
        wide(f[0]) * wide(n[0]) + wide(f[1]) * wide(n[1]) + wide(f[2]) * wide(n[2]);
    const double slack = 8.0 * EPS * norm3(f);
    for (int i = 0; i < 3; i++) {
        REQUIRE_NEAR(t, reaction[i], along < 0.0L ? along * wide(n[i]) : 0.0L, slack);
        REQUIRE_NEAR(t, planar[i], wide(f[i]) - along * wide(n[i]), slack);
    }
    REQUIRE_STATUS(t, tribo_friction_reaction(f, n, n), TRIBO_OK);
    REQUIRE_SAME(t, n, reaction, sizeof n);
}

/* Friction opposes, never exceeds mu_s |r|, cancels in full or slides with mu_d |r|. */
static void friction_force(property_trial *t)
{
    double f[3];
    double n[3];
    double reaction[3];
    double planar[3];
    double force[3];
    double again[3];
    uint32_t mode = 77;
    tribo_material pair;
    make_vector(t, "f", -30, 30, f);
    make_normal(t, "n", n);
    make_material(t, "pair", &pair);
    REQUIRE_STATUS(t, tribo_friction_reaction(f, n, reaction), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_friction_planar(f, n, planar), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &pair, force, &mode), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &pair, again, NULL), TRIBO_OK);
    REQUIRE_SAME(t, force, again, sizeof force);
    const double press = norm3(reaction);
    const double pull = norm3(planar);
    const double slack = 8.0 * EPS * norm3(f);
    const uint32_t holds = tribo_friction_holds(planar, reaction, pair.mu_s);
    const double margin = pull - pair.mu_s * press;
    REQUIRE(t, holds <= 1 && (fabs(margin) <= 4.0 * EPS * (pull + pair.mu_s * press) ||
                              holds == (margin < 0.0)));
    if (mode == TRIBO_MODE_OPEN) {
        REQUIRE(t, norm3(force) == 0.0 && press <= slack);
        return;
    }
    ASSUME(t, press > 1e-290);
    REQUIRE(t, mode == (holds ? TRIBO_MODE_STICK : TRIBO_MODE_SLIP));
    const double share = holds ? 1.0 : pair.mu_d * press / pull;
    for (int i = 0; i < 3; i++) {
        REQUIRE_NEAR(t, force[i], -share * planar[i], 8.0 * EPS * share * pull);
    }
    REQUIRE_AT_MOST(t, norm3(force), pair.mu_s * press * (1.0 + 8.0 * EPS));
}

static void friction_bad(property_trial *t)
{
    double f[3];
    double n[3];
    double out[3];
    uint32_t mode = 77;
    tribo_material pair;
    make_vector(t, "f", -30, 30, f);
    make_normal(t, "n", n);
    make_material(t, "pair", &pair);
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, tribo_friction_reaction(NULL, n, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_reaction(f, NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_reaction(f, n, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_planar(NULL, n, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_planar(f, NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_planar(f, n, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_force(NULL, n, &pair, out, &mode), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_force(f, NULL, &pair, out, &mode), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_force(f, n, NULL, out, &mode), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &pair, NULL, &mode), TRIBO_ERROR_NULL);
    tribo_material wrong = pair;
    wrong.mu_d = wrong.mu_s + 1.0;
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &wrong, out, &mode), TRIBO_ERROR_FRICTION);
    wrong = pair;
    wrong.e = 1.5;
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &wrong, out, &mode), TRIBO_ERROR_RESTITUTION);
    const double stretch = 1.0 + make_positive(t, "stretch", -39, 4);
    double off[3];
    tribo_vec3_scale(stretch, n, off);
    REQUIRE_STATUS(t, tribo_friction_reaction(f, off, out), TRIBO_ERROR_NORMAL);
    REQUIRE_STATUS(t, tribo_friction_planar(f, off, out), TRIBO_ERROR_NORMAL);
    REQUIRE_STATUS(t, tribo_friction_force(f, off, &pair, out, &mode), TRIBO_ERROR_NORMAL);
    double *const arrays[3] = {f, n, (double *)&pair};
    const uint32_t lengths[3] = {3, 3, 3};
    spoil(t, arrays, lengths, 3);
    if (all_finite((double *)&pair, 3)) {
        REQUIRE_STATUS(t, tribo_friction_reaction(f, n, out), TRIBO_ERROR_NOT_FINITE);
        REQUIRE_STATUS(t, tribo_friction_planar(f, n, out), TRIBO_ERROR_NOT_FINITE);
    }
    REQUIRE_STATUS(t, tribo_friction_force(f, n, &pair, out, &mode), TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(out, sizeof out) && mode == 77);
}

const char *const property_room = "contact";
const property property_list[] = {
    {"contact_at", contact_at, 1},
    {"contact_check", contact_check, 1},
    {"contact_at_bad", contact_at_bad, 1},
    {"contact_velocity", contact_velocity, 1},
    {"matrix_formula", matrix_formula, 1},
    {"matrix_bounds", matrix_bounds, 1},
    {"matrix_boxes", matrix_boxes, 1},
    {"matrix_immovable", matrix_immovable, 1},
    {"matrix_columns", matrix_columns, 1},
    {"apply_conserves", apply_conserves, 1},
    {"apply_single", apply_single, 1},
    {"matrix_bad", matrix_bad, 1},
    {"matrix_bad_frame", matrix_bad_frame, 1},
    {"matrix_not_finite", matrix_not_finite, 1},
    {"matrix_wild", matrix_wild, 1},
    {"cone_project", cone_project, 1},
    {"cone_idempotent", cone_idempotent, 1},
    {"cone_moreau", cone_moreau, 1},
    {"cone_nonexpansive", cone_nonexpansive, 1},
    {"cone_homogeneous", cone_homogeneous, 1},
    {"cone_limits", cone_limits, 1},
    {"cone_clamp", cone_clamp, 1},
    {"cone_contains", cone_contains, 1},
    {"cone_bad", cone_bad, 1},
    {"solve_solution", solve_solution, 1},
    {"solve_open", solve_open, 1},
    {"solve_turned", solve_turned, 1},
    {"solve_mirrored", solve_mirrored, 1},
    {"solve_scaled", solve_scaled, 1},
    {"solve_continuous", solve_continuous, 1},
    {"solve_dissipates", solve_dissipates, 1},
    {"solve_jam", solve_jam, 1},
    {"solve_raw", solve_raw, 1},
    {"solve_wild", solve_wild, 1},
    {"solve_bad", solve_bad, 1},
    {"general_symmetric", general_symmetric, 2},
    {"general_unsymmetric", general_unsymmetric, 2},
    {"general_wild", general_wild, 2},
    {"general_bad", general_bad, 1},
    {"impact_any", impact_any, 2},
    {"impact_algebraic", impact_algebraic, 1},
    {"impact_coulomb", impact_coulomb, 1},
    {"impact_routh", impact_routh, 10},
    {"impact_routh_planar", impact_routh_planar, 2},
    {"impact_routh_decoupled", impact_routh_decoupled, 10},
    {"impact_frictionless", impact_frictionless, 1},
    {"impact_without_friction", impact_without_friction, 2},
    {"impact_lecture", impact_lecture, 1},
    {"impact_open", impact_open, 1},
    {"impact_scaled", impact_scaled, 10},
    {"impact_sticks", impact_sticks, 1},
    {"impact_singular", impact_singular, 4},
    {"impact_bad", impact_bad, 1},
    {"impact_wild", impact_wild, 4},
    {"info_sizes", info_sizes, 1},
    {"impact_sizes", impact_sizes, 2},
    {"option_sizes", option_sizes, 2},
    {"collide_parts", collide_parts, 4},
    {"collide_conserves", collide_conserves, 4},
    {"collide_velocity", collide_velocity, 4},
    {"collide_separating", collide_separating, 2},
    {"collide_immovable", collide_immovable, 4},
    {"swap_exact", swap_exact, 2},
    {"collide_swapped", collide_swapped, 2},
    {"collide_objective", collide_objective, 2},
    {"collide_galilean", collide_galilean, 2},
    {"collide_translated", collide_translated, 2},
    {"collide_mass_limit", collide_mass_limit, 2},
    {"collide_planar", collide_planar, 2},
    {"collide_bad", collide_bad, 2},
    {"collide_null", collide_null, 2},
    {"collision_sizes", collision_sizes, 4},
    {"collide_wild", collide_wild, 4},
    {"friction_parts", friction_parts, 1},
    {"friction_force", friction_force, 1},
    {"friction_bad", friction_bad, 1},
    {"general_graded", general_graded, 1},
    {"impact_slow", impact_slow, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 10000;
