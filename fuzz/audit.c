/* Properties of include/tribo/audit.h. */
#include <math.h>
#include <string.h>

#include "support/reference.h"

static long double wide(double x)
{
    return (long double)x;
}

static int any_nan(const double *x, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (isnan(x[i])) {
            return 1;
        }
    }
    return 0;
}

/* ---- bodies ------------------------------------------------------------------------------- */

enum { BODIES = 5 };

static uint32_t make_bodies(property_trial *t, uint32_t kind, tribo_body bodies[BODIES])
{
    double half[3];
    const uint32_t count = make_choice(t, "bodies", BODIES + 1);
    property_expand(t);
    for (uint32_t i = 0; i < count; i++) {
        make_body(t, "body", kind, &bodies[i], half);
    }
    return count;
}

/* One body's part of the totals; rounding receives what its energy may be off by, over eps. */
static void add_body(const tribo_body *body, const double origin[3], tribo_totals *sum,
                     double *rounding)
{
    double arm[3];
    double moment[3];
    double spin[3];
    double energy = 0.0;
    double values[3];
    const double mass = 1.0 / body->inverse_mass;
    const double speed = norm3(body->velocity);
    const double rate = norm3(body->angular_velocity);
    reference_spin(body, spin, &energy);
    reference_eigenvalues(body->inverse_inertia, values);
    tribo_vec3_subtract(body->position, origin, arm);
    tribo_vec3_cross(arm, body->velocity, moment);
    for (int i = 0; i < 3; i++) {
        sum->linear[i] += mass * body->velocity[i];
        sum->angular[i] += mass * moment[i] + spin[i];
    }
    sum->energy += 0.5 * mass * speed * speed + energy;
    sum->mass += mass;
    sum->linear_scale += mass * speed;
    sum->angular_scale += norm3(arm) * mass * speed + norm3(spin);
    *rounding += 0.5 * mass * speed * speed + 0.5 * rate * rate / values[0];
}

static void bodies_totals(property_trial *t)
{
    tribo_body bodies[BODIES];
    tribo_totals out;
    tribo_totals want;
    double origin[3];
    double rounding = 0.0;
    double turning = 0.0;
    const uint32_t count = make_bodies(t, BODY_PLAIN, bodies);
    make_vector(t, "origin", -4, 6, origin);
    memset(&want, 0, sizeof want);
    for (uint32_t i = 0; i < count; i++) {
        double values[3];
        add_body(&bodies[i], origin, &want, &rounding);
        reference_eigenvalues(bodies[i].inverse_inertia, values);
        turning += norm3(bodies[i].angular_velocity) / values[0];
    }
    REQUIRE_STATUS(t, tribo_audit_bodies(count, bodies, origin, &out), TRIBO_OK);
    REQUIRE_AT_MOST(t, distance3(out.linear, want.linear), 16.0 * EPS * want.linear_scale);
    REQUIRE_AT_MOST(t, distance3(out.angular, want.angular),
                    32.0 * EPS * (want.angular_scale + turning));
    REQUIRE_NEAR(t, out.energy, want.energy, 64.0 * EPS * rounding);
    REQUIRE_NEAR(t, out.mass, want.mass, 8.0 * EPS * want.mass);
    REQUIRE_NEAR(t, out.linear_scale, want.linear_scale, 16.0 * EPS * want.linear_scale);
    REQUIRE_NEAR(t, out.angular_scale, want.angular_scale,
                 32.0 * EPS * (want.angular_scale + turning));
    REQUIRE_STATUS(t, tribo_audit_bodies(0, NULL, origin, &want), TRIBO_OK);
    static const tribo_totals zeros;
    REQUIRE_SAME(t, &want, &zeros, sizeof zeros);
}

/* Immovable bodies are left out: they may stand anywhere in the list. */
static void bodies_immovable(property_trial *t)
{
    tribo_body bodies[BODIES];
    tribo_body with[BODIES + 1];
    tribo_totals left;
    tribo_totals right;
    double origin[3];
    double half[3];
    const uint32_t count = make_bodies(t, BODY_PLAIN, bodies);
    const uint32_t place = make_choice(t, "place", count + 1);
    make_vector(t, "origin", -4, 6, origin);
    memcpy(with, bodies, place * sizeof *with);
    make_body(t, "immovable", BODY_PLAIN, &with[place], half);
    with[place].inverse_mass = 0.0;
    memset(with[place].inverse_inertia, 0, sizeof with[place].inverse_inertia);
    memcpy(with + place + 1, bodies + place, (count - place) * sizeof *with);
    REQUIRE_STATUS(t, tribo_audit_bodies(count, bodies, origin, &left), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_bodies(count + 1, with, origin, &right), TRIBO_OK);
    REQUIRE_SAME(t, &left, &right, sizeof left);
}

/* A collision changes neither momentum, and its energy by what it says. */
static void bodies_collide(property_trial *t)
{
    scene s;
    tribo_body bodies[2];
    tribo_totals before;
    tribo_totals after;
    tribo_change change;
    tribo_collision_info info;
    tribo_material pair;
    double origin[3];
    make_scene(t, BODY_PLAIN, &s);
    ASSUME(t, s.has_b);
    make_material(t, "pair", &pair);
    make_vector(t, "origin", -4, 6, origin);
    info.struct_size = sizeof info;
    bodies[0] = s.a;
    bodies[1] = s.b;
    REQUIRE_STATUS(t, tribo_audit_bodies(2, bodies, origin, &before), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_resolve(&bodies[0], &bodies[1], &s.contact, &pair, NULL, &info),
                   TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_bodies(2, bodies, origin, &after), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_change(&before, &after, &change), TRIBO_OK);
    REQUIRE_AT_MOST(t, change.linear, 64.0 * EPS);
    REQUIRE_AT_MOST(t, change.angular, 4096.0 * EPS);
    REQUIRE_AT_MOST(t, change.energy, 4096.0 * EPS);
    ASSUME(t, before.energy > 0.0);
    const double most = before.energy > after.energy ? before.energy : after.energy;
    REQUIRE_NEAR(t, change.energy, info.energy / most, 4096.0 * EPS);
}

static void make_totals(property_trial *t, const char *name, tribo_totals *out)
{
    make_vector(t, name, -20, 20, out->linear);
    make_vector(t, NULL, -20, 20, out->angular);
    out->energy = fabs(make_real(t, NULL, -20, 20));
    out->mass = make_positive(t, NULL, -20, 20);
    out->linear_scale = norm3(out->linear) * (1.0 + make_unit(t, NULL));
    out->angular_scale = norm3(out->angular) * (1.0 + make_unit(t, NULL));
    property_note(t, "totals", out->linear, sizeof *out / 8);
}

static long double relative(long double change, double before, double after)
{
    const double most = before > after ? before : after;
    return most == 0.0 ? 0.0L : change / wide(most);
}

static void change_formula(property_trial *t)
{
    tribo_totals before;
    tribo_totals after;
    tribo_change out;
    make_totals(t, "before", &before);
    make_totals(t, "after", &after);
    REQUIRE_STATUS(t, tribo_audit_change(&before, &after, &out), TRIBO_OK);
    REQUIRE_NEAR(t, out.linear,
                 relative(wide(distance3(before.linear, after.linear)), before.linear_scale,
                          after.linear_scale),
                 16.0 * EPS);
    REQUIRE_NEAR(t, out.angular,
                 relative(wide(distance3(before.angular, after.angular)), before.angular_scale,
                          after.angular_scale),
                 16.0 * EPS);
    REQUIRE_NEAR(t, out.energy,
                 relative(wide(after.energy) - wide(before.energy), before.energy, after.energy),
                 16.0 * EPS);
    REQUIRE_STATUS(t, tribo_audit_change(&before, &before, &out), TRIBO_OK);
    REQUIRE(t, out.linear == 0.0 && out.angular == 0.0 && out.energy == 0.0);
}

static void bodies_bad(property_trial *t)
{
    tribo_body bodies[BODIES];
    tribo_totals out;
    double origin[3] = {1, 2, 3};
    const uint32_t count = make_bodies(t, BODY_ANY, bodies);
    ASSUME(t, count > 0);
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_audit_bodies(count, NULL, origin, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_bodies(count, bodies, NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_bodies(count, bodies, origin, NULL), TRIBO_ERROR_NULL);
    const uint32_t place = make_choice(t, "place", count);
    tribo_body *body = &bodies[place];
    tribo_status expected = TRIBO_ERROR_NOT_FINITE;
    switch (make_choice(t, "kind", 4)) {
    case 0:
        ((double *)body)[make_choice(t, "field", 20)] = make_hostile(t, "value");
        break;
    case 1:
        body->inverse_mass = -make_positive(t, "mass", -10, 10);
        expected = TRIBO_ERROR_MASS;
        break;
    case 2:
        body->inverse_inertia[0] = -make_positive(t, "inertia", -4, 4);
        expected = TRIBO_ERROR_INERTIA;
        break;
    default:
        body->orientation[0] += copysign(2.5, body->orientation[0]);
        expected = TRIBO_ERROR_ORIENTATION;
        break;
    }
    REQUIRE_STATUS(t, tribo_audit_bodies(count, bodies, origin, &out), expected);
    REQUIRE(t, canary_kept(&out, sizeof out));
}

static void change_bad(property_trial *t)
{
    tribo_totals before;
    tribo_totals after;
    tribo_change out;
    make_totals(t, "before", &before);
    make_totals(t, "after", &after);
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_audit_change(NULL, &after, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_change(&before, NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_change(&before, &after, NULL), TRIBO_ERROR_NULL);
    double *field = (double *)(make_choice(t, "which", 2) == 0 ? &before : &after);
    field[make_choice(t, "field", 10)] = make_hostile(t, "value");
    REQUIRE_STATUS(t, tribo_audit_change(&before, &after, &out), TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(&out, sizeof out));
}

/* ---- contacts ----------------------------------------------------------------------------- */

typedef struct problem {
    double w[6];
    double b[3];
    double mu;
    double p[3];
} problem;

/* Any impulse: the solution, one nearby, or anything. */
static void make_audited(property_trial *t, problem *q)
{
    make_matrix(t, "w", q->w);
    q->mu = make_friction(t, "mu");
    make_velocity(t, "b", q->w, q->mu, q->b);
    const uint32_t kind = make_choice(t, "kind", 3);
    if (kind == 2 || tribo_contact_solve(q->w, q->b, q->mu, q->mu, q->p, NULL) != TRIBO_OK) {
        make_vector(t, NULL, -10, 10, q->p);
    } else if (kind == 1) {
        for (int i = 0; i < 3; i++) {
            q->p[i] *= 1.0 + make_real(t, NULL, -50, 0);
        }
    }
    property_note(t, "p", q->p, 3);
}

/* All measures in long double. `energy` for the velocity before, `fault` for the velocity
 * measure. */
static void reference_measures(const problem *q, const double before[3], tribo_measures *out)
{
    double impulse;
    double v[3];
    const double velocity = reference_scale(q->w, q->b, q->p, &impulse);
    memset(out, 0, sizeof *out);
    reference_velocity(q->w, q->b, q->p, v);
    out->velocity = v[0];
    if (velocity == 0.0) {
        return;
    }
    const double n = v[0] / velocity;
    const double m = q->p[0] / impulse;
    const double excess = norm2(q->p + 1) - q->mu * q->p[0];
    const double slide = norm2(v + 1);
    const double off[2] = {slide * q->p[1] + q->mu * q->p[0] * v[1],
                           slide * q->p[2] + q->mu * q->p[0] * v[2]};
    long double energy = 0.0L;
    reference_velocity(q->w, before, q->p, v);
    for (int i = 0; i < 3; i++) {
        energy += 0.5L * wide(q->p[i]) * (wide(before[i]) + wide(v[i]));
    }
    out->eta = reference_eta(q->w, q->b, q->mu, q->p);
    out->signorini = fabs(n < m ? n : m);
    out->cone = excess > 0.0 ? excess / impulse : 0.0;
    out->misalignment = norm2(off) / impulse / velocity;
    out->energy = (double)(energy / wide(impulse) / wide(velocity));
}

/* Rounding of p, of W p and of the measures, relative to their scales. */
static void require_measures(property_trial *t, const problem *q, const tribo_measures *got,
                             const tribo_measures *want)
{
    double impulse;
    const double velocity = reference_scale(q->w, q->b, q->p, &impulse);
    const double ratio = impulse > 0.0 ? norm3(q->p) / impulse : 0.0;
    const double mu = q->mu > 1.0 ? q->mu : 1.0;
    const double slack = 16.0 * EPS * (1.0 + ratio) * mu;
    REQUIRE_NEAR(t, got->eta, want->eta, slack);
    REQUIRE_NEAR(t, got->signorini, want->signorini, slack);
    REQUIRE_NEAR(t, got->cone, want->cone, slack);
    REQUIRE_NEAR(t, got->misalignment, want->misalignment, slack);
    REQUIRE_NEAR(t, got->energy, want->energy, slack);
    REQUIRE_NEAR(t, got->velocity, want->velocity, 16.0 * EPS * velocity);
    REQUIRE(t, got->eta >= 0.0 && got->signorini >= 0.0 && got->cone >= 0.0);
    REQUIRE(t, got->misalignment >= 0.0);
}

static void contact_measures(property_trial *t)
{
    problem q;
    tribo_measures got;
    tribo_measures want;
    make_audited(t, &q);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &got), TRIBO_OK);
    reference_measures(&q, q.b, &want);
    require_measures(t, &q, &got, &want);
}

/* eta is 0 at a solution and only there. */
static void contact_solution(property_trial *t)
{
    problem q;
    tribo_measures m;
    double impulse;
    make_matrix_of(t, "w", MATRIX_BOX, q.w);
    q.mu = make_friction(t, "mu");
    make_velocity(t, "b", q.w, q.mu, q.b);
    ASSUME(t, reference_unique(q.w, q.mu));
    REQUIRE_STATUS(t, tribo_contact_solve(q.w, q.b, q.mu, q.mu, q.p, NULL), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &m), TRIBO_OK);
    REQUIRE_AT_MOST(t, m.eta, 1e-12);
    REQUIRE_AT_MOST(t, m.signorini, 1e-12);
    REQUIRE_AT_MOST(t, m.cone, 1e-12);
    REQUIRE_AT_MOST(t, m.misalignment, 1e-12);
    REQUIRE_AT_MOST(t, m.energy, 64.0 * EPS);
    reference_scale(q.w, q.b, q.p, &impulse);
    const double step = ldexp(impulse, -1 - make_byte(t) % 20);
    const uint32_t entry = make_choice(t, "entry", 3);
    q.p[entry] += make_choice(t, "minus", 2) == 1 ? -step : step;
    ASSUME(t, step > 0.0);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &m), TRIBO_OK);
    REQUIRE_AT_MOST(t, 1e-10, m.eta);
}

static void contact_zero(property_trial *t)
{
    problem q;
    tribo_measures m;
    static const tribo_measures zeros;
    static const double zero[3] = {0, 0, 0};
    make_matrix(t, "w", q.w);
    q.mu = make_friction(t, "mu");
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, zero, q.mu, zero, &m), TRIBO_OK);
    REQUIRE_SAME(t, &m, &zeros, sizeof m);
}

/* W 2^i, b 2^j, p 2^(j - i): the same measures, to the bit. */
static void contact_scaled(property_trial *t)
{
    problem q;
    problem r;
    tribo_measures m;
    tribo_measures n;
    make_audited(t, &q);
    r = q;
    const int i = make_exponent(t, -400, 400);
    const int j = make_exponent(t, -400, 400);
    for (int k = 0; k < 6; k++) {
        r.w[k] = ldexp(q.w[k], i);
    }
    for (int k = 0; k < 3; k++) {
        r.b[k] = ldexp(q.b[k], j);
        r.p[k] = ldexp(q.p[k], j - i);
    }
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &m), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_contact(r.w, r.b, r.mu, r.p, &n), TRIBO_OK);
    m.velocity = ldexp(m.velocity, j);
    REQUIRE_SAME(t, &m, &n, sizeof m);
}

/* The measures of an impact by its law: those of the plastic problem with (1+e) u_n, the
 * coefficient that fits, the true change of energy and the deviation from Newton's restitution. */
static void impact_measures(property_trial *t)
{
    problem q;
    double u[3];
    double v[3];
    tribo_material pair;
    tribo_measures got;
    tribo_measures want[2];
    tribo_impact_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.law = make_choice(t, "law", 8);
    make_matrix_of(t, "w", MATRIX_BOX, q.w);
    make_material(t, "pair", &pair);
    make_velocity(t, "u", q.w, pair.mu_s, u);
    REQUIRE_STATUS(t, tribo_impact(q.w, u, &pair, &options, q.p, NULL), TRIBO_OK);
    if (make_choice(t, "moved", 2) == 1) {
        q.p[make_choice(t, "entry", 3)] *= 1.0 + make_real(t, "by", -40, 0);
    }
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, u, &pair, q.p, &got), TRIBO_OK);
    q.b[0] = (1.0 + pair.e) * u[0];
    q.b[1] = u[1];
    q.b[2] = u[2];
    q.mu = pair.mu_s;
    reference_measures(&q, u, &want[0]);
    q.mu = pair.mu_d;
    reference_measures(&q, u, &want[1]);
    double impulse;
    const double scale = reference_scale(q.w, q.b, q.p, &impulse);
    ASSUME(t, scale > 0.0 && u[0] < 0.0);
    reference_velocity(q.w, u, q.p, v);
    const double slip = norm2(v + 1) / scale;
    const double off = (v[0] + pair.e * u[0]) / scale;
    got.velocity -= off;
    REQUIRE_NEAR(t, got.velocity, 0.0, 64.0 * EPS);
    want[0].velocity = want[1].velocity = 0.0;
    got.velocity = 0.0;
    q.mu = pair.mu_s;
    if (slip > 1e-6) {
        require_measures(t, &q, &got, &want[1]);
    } else if (slip < 1e-15) {
        require_measures(t, &q, &got, &want[0]);
    }
}

/* COULOMB's impulses have eta = 0, and e u_n is met. */
static void impact_solution(property_trial *t)
{
    double w[6];
    double u[3];
    double p[3];
    tribo_material pair;
    tribo_measures m;
    tribo_impact_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.law = TRIBO_LAW_COULOMB;
    make_matrix_of(t, "w", MATRIX_BOX, w);
    make_material(t, "pair", &pair);
    make_velocity(t, "u", w, pair.mu_s, u);
    ASSUME(t, u[0] < 0.0);
    REQUIRE_STATUS(t, tribo_impact(w, u, &pair, &options, p, NULL), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_audit_impact(w, u, &pair, p, &m), TRIBO_OK);
    REQUIRE_AT_MOST(t, m.eta, 1e-10);
    REQUIRE_AT_MOST(t, m.cone, 64.0 * EPS);
    REQUIRE_AT_MOST(t, fabs(m.velocity), 64.0 * EPS);
}

/* ---- arrays ------------------------------------------------------------------------------- */

enum { CONTACTS = 9 };

static void array_measures(property_trial *t)
{
    double w[6 * CONTACTS];
    double b[3 * CONTACTS];
    double mu[CONTACTS];
    double p[3 * CONTACTS];
    tribo_measures most;
    tribo_measures rms;
    tribo_measures alone;
    double want[2][6] = {{0}};
    const uint32_t count = make_choice(t, "count", CONTACTS + 1);
    property_expand(t);
    for (uint32_t i = 0; i < count; i++) {
        problem q;
        make_audited(t, &q);
        memcpy(w + 6 * i, q.w, sizeof q.w);
        memcpy(b + 3 * i, q.b, sizeof q.b);
        memcpy(p + 3 * i, q.p, sizeof q.p);
        mu[i] = q.mu;
        REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &alone), TRIBO_OK);
        const double *field = &alone.eta;
        for (int k = 0; k < 6; k++) {
            want[0][k] = fabs(field[k]) > want[0][k] ? fabs(field[k]) : want[0][k];
            want[1][k] += field[k] * field[k] / count;
        }
    }
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, p, &most, &rms), TRIBO_OK);
    REQUIRE_SAME(t, &most, want[0], sizeof most);
    for (int k = 0; k < 6; k++) {
        REQUIRE_NEAR(t, (&rms.eta)[k], sqrt(want[1][k]), 16.0 * EPS * want[0][k]);
    }
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, p, NULL, &alone), TRIBO_OK);
    REQUIRE_SAME(t, &alone, &rms, sizeof rms);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, p, &alone, NULL), TRIBO_OK);
    REQUIRE_SAME(t, &alone, &most, sizeof most);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, p, NULL, NULL), TRIBO_OK);
}

/* ---- bad input ---------------------------------------------------------------------------- */

static void contact_bad(property_trial *t)
{
    problem q;
    tribo_measures out;
    tribo_material pair;
    make_audited(t, &q);
    make_material(t, "pair", &pair);
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_audit_contact(NULL, q.b, q.mu, q.p, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, NULL, q.mu, q.p, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_impact(NULL, q.b, &pair, q.p, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, NULL, &pair, q.p, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, NULL, q.p, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, &pair, NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, &pair, q.p, NULL), TRIBO_ERROR_NULL);
    const double size = make_positive(t, "size", -20, 20);
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, -size, q.p, &out), TRIBO_ERROR_FRICTION);
    tribo_material wrong = pair;
    wrong.mu_d = wrong.mu_s + size * (1.0 + wrong.mu_s);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, &wrong, q.p, &out), TRIBO_ERROR_FRICTION);
    wrong = pair;
    wrong.e = 1.0 + size;
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, &wrong, q.p, &out), TRIBO_ERROR_RESTITUTION);
    static const double none[6] = {0};
    REQUIRE_STATUS(t, tribo_audit_contact(none, q.b, q.mu, q.p, &out), TRIBO_ERROR_IMMOVABLE);
    REQUIRE_STATUS(t, tribo_audit_impact(none, q.b, &pair, q.p, &out), TRIBO_ERROR_IMMOVABLE);
    double *fields[3] = {q.w, q.b, q.p};
    const uint32_t entry = make_choice(t, "entry", 12);
    fields[entry < 6   ? 0
           : entry < 9 ? 1
                       : 2][entry < 6 ? entry : entry % 3] = make_hostile(t, "value");
    REQUIRE_STATUS(t, tribo_audit_contact(q.w, q.b, q.mu, q.p, &out), TRIBO_ERROR_NOT_FINITE);
    REQUIRE_STATUS(t, tribo_audit_impact(q.w, q.b, &pair, q.p, &out), TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(&out, sizeof out));
}

static void array_bad(property_trial *t)
{
    double w[6 * CONTACTS];
    double b[3 * CONTACTS];
    double mu[CONTACTS];
    double p[3 * CONTACTS];
    tribo_measures out[2];
    static const tribo_measures zeros;
    const uint32_t count = 1 + make_choice(t, "count", CONTACTS);
    property_expand(t);
    for (uint32_t i = 0; i < count; i++) {
        problem q;
        make_audited(t, &q);
        memcpy(w + 6 * i, q.w, sizeof q.w);
        memcpy(b + 3 * i, q.b, sizeof q.b);
        memcpy(p + 3 * i, q.p, sizeof q.p);
        mu[i] = q.mu;
    }
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, NULL, b, mu, p, out, out + 1), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, NULL, mu, p, out, out + 1), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, NULL, p, out, out + 1), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, NULL, out, out + 1), TRIBO_ERROR_NULL);
    const uint32_t place = make_choice(t, "place", count);
    tribo_status expected = TRIBO_ERROR_NOT_FINITE;
    switch (make_choice(t, "kind", 3)) {
    case 0:
        mu[place] = -1.0;
        expected = TRIBO_ERROR_FRICTION;
        break;
    case 1:
        memset(w + 6 * place, 0, 6 * sizeof *w);
        expected = TRIBO_ERROR_IMMOVABLE;
        break;
    default:
        p[3 * place + make_choice(t, "entry", 3)] = make_hostile(t, "value");
        break;
    }
    REQUIRE_STATUS(t, tribo_audit_contacts(count, w, b, mu, p, out, out + 1), expected);
    REQUIRE(t, canary_kept(out, sizeof out));
    REQUIRE_STATUS(t, tribo_audit_contacts(0, NULL, NULL, NULL, NULL, out, out + 1), TRIBO_OK);
    REQUIRE(t, property_same(out, &zeros, sizeof zeros) &&
                   property_same(out + 1, &zeros, sizeof zeros));
}

/* Any finite numbers: measures that are numbers or too large for one, or a named status and nothing
 * written. */
static void contact_wild(property_trial *t)
{
    problem q;
    tribo_measures out;
    tribo_material pair;
    make_audited(t, &q);
    make_material(t, "pair", &pair);
    for (uint32_t i = make_choice(t, "wild", 6); i > 0; i--) {
        double *fields[3] = {q.w, q.b, q.p};
        const uint32_t entry = make_choice(t, "entry", 12);
        fields[entry < 6   ? 0
               : entry < 9 ? 1
                           : 2][entry < 6 ? entry : entry % 3] = make_finite(t, "value");
    }
    q.mu = make_choice(t, "wild mu", 2) == 1 ? fabs(make_finite(t, "mu")) : q.mu;
    for (int i = 0; i < 2; i++) {
        canary_set(&out, sizeof out);
        const tribo_status status = i == 0 ? tribo_audit_contact(q.w, q.b, q.mu, q.p, &out)
                                           : tribo_audit_impact(q.w, q.b, &pair, q.p, &out);
        REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_IMMOVABLE ||
                       status == TRIBO_ERROR_NOT_FINITE || status == TRIBO_ERROR_RANGE);
        REQUIRE(t, status == TRIBO_OK ? !any_nan(&out.eta, 6) : canary_kept(&out, sizeof out));
    }
}

const char *const property_room = "audit";
const property property_list[] = {
    {"bodies_totals", bodies_totals, 1},
    {"bodies_immovable", bodies_immovable, 1},
    {"bodies_collide", bodies_collide, 1},
    {"change_formula", change_formula, 1},
    {"bodies_bad", bodies_bad, 1},
    {"change_bad", change_bad, 1},
    {"contact_measures", contact_measures, 1},
    {"contact_solution", contact_solution, 1},
    {"contact_zero", contact_zero, 1},
    {"contact_scaled", contact_scaled, 1},
    {"impact_measures", impact_measures, 4},
    {"impact_solution", impact_solution, 1},
    {"array_measures", array_measures, 4},
    {"contact_bad", contact_bad, 1},
    {"array_bad", array_bad, 4},
    {"contact_wild", contact_wild, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 40000;
