#include <tribo/audit.h>

#include "cone.h"

/* ---- bodies ---------------------------------------------------------------------------------- */

tribo_status tribo_audit_bodies(size_t count, const tribo_body *bodies, const double origin[3],
                                tribo_totals *out)
{
    if ((count > 0 && !bodies) || !origin || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(origin, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    tribo_totals totals = {0};
    for (size_t i = 0; i < count; i++) {
        const tribo_body *body = &bodies[i];
        double spin[3];
        double arm[3];
        double momentum[3];
        double orbital[3];
        const tribo_status status = tribo_body_spin(body, spin);
        if (status != TRIBO_OK) {
            return status;
        }
        if (body->inverse_mass == 0.0) {
            continue;
        }
        const double mass = 1.0 / body->inverse_mass;
        tribo_vec3_scale(mass, body->velocity, momentum);
        tribo_vec3_subtract(body->position, origin, arm);
        tribo_vec3_cross(arm, momentum, orbital);
        tribo_vec3_add(totals.linear, momentum, totals.linear);
        tribo_vec3_add(totals.angular, orbital, totals.angular);
        tribo_vec3_add(totals.angular, spin, totals.angular);
        totals.energy += 0.5 * (tribo_vec3_dot(momentum, body->velocity) +
                                tribo_vec3_dot(spin, body->angular_velocity));
        totals.mass += mass;
        totals.linear_scale += tribo_vec3_norm(momentum);
        totals.angular_scale +=
            tribo_vec3_norm(arm) * tribo_vec3_norm(momentum) + tribo_vec3_norm(spin);
    }
    *out = totals;
    return TRIBO_OK;
}

static double relative_change(const double before[3], const double after[3], double scale)
{
    double change[3];
    tribo_vec3_subtract(after, before, change);
    return scale > 0.0 ? tribo_vec3_norm(change) / scale : 0.0;
}

tribo_status tribo_audit_change(const tribo_totals *before, const tribo_totals *after,
                                tribo_change *out)
{
    if (!before || !after || !out) {
        return TRIBO_ERROR_NULL;
    }
    const double probe = finite_probe(before->linear, 3) + finite_probe(before->angular, 3) +
                         finite_probe(&before->energy, 4) + finite_probe(after->linear, 3) +
                         finite_probe(after->angular, 3) + finite_probe(&after->energy, 4);
    if (!(probe == 0.0)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const double energy = greater(before->energy, after->energy);
    out->linear = relative_change(before->linear, after->linear,
                                  greater(before->linear_scale, after->linear_scale));
    out->angular = relative_change(before->angular, after->angular,
                                   greater(before->angular_scale, after->angular_scale));
    out->energy = energy > 0.0 ? (after->energy - before->energy) / energy : 0.0;
    return TRIBO_OK;
}

enum { FIELDS = sizeof(tribo_measures) / sizeof(double) };

/* ---- contacts -------------------------------------------------------------------------------- */

static double length_of(const double x[3])
{
    return tribo_vec3_norm(x);
}

static void apply_matrix(const double w[6], const double p[3], double out[3])
{
    tribo_sym3_apply(w, p, out);
}

/* W, b and p in units in which the greatest diagonal entry of W and the velocity scale V lie in [1,
 * 2): the measures have no dimension, and then nothing over- or underflows. */
typedef struct audit_problem {
    double w[6], b[3], p[3], v[3];
    double velocity_scale, impulse_scale, greatest;
} audit_problem;

static tribo_status pose_problem(const double w[6], const double b[3], const double p[3],
                                 audit_problem *out)
{
    const double greatest = greater(w[0], greater(w[3], w[5]));
    if (!(greatest > 0.0)) {
        return TRIBO_ERROR_IMMOVABLE;
    }
    const double sw = power_of_two(scale_exponent(greatest));
    const double image = length_of(p) * greatest;
    const double sb = power_of_two(scale_exponent(greater(length_of(b), image)));
    for (int i = 0; i < 6; i++) {
        out->w[i] = sw * w[i];
    }
    for (int i = 0; i < 3; i++) {
        out->b[i] = sb * b[i];
        out->p[i] = p[i] / sw * sb;
    }
    double absolute_w[6];
    double absolute_p[3];
    double reach[3];
    for (int i = 0; i < 6; i++) {
        absolute_w[i] = absolute(out->w[i]);
    }
    for (int i = 0; i < 3; i++) {
        absolute_p[i] = absolute(out->p[i]);
    }
    apply_matrix(absolute_w, absolute_p, reach);
    apply_matrix(out->w, out->p, out->v);
    tribo_vec3_add(out->v, out->b, out->v);
    out->greatest = sw * greatest;
    out->velocity_scale = length_of(out->b) + length_of(reach);
    out->impulse_scale = out->velocity_scale / out->greatest;
    return TRIBO_OK;
}

static double natural_map(const audit_problem *a, double mu)
{
    /* rho and rho mu apart: mu |v_t| may be beyond double where rho mu |v_t| is not. */
    const double rho = 1.0 / greater(1.0, mu) / a->greatest;
    const double rho_mu = lesser(1.0, mu) / a->greatest;
    const double sliding = planar_length(a->v[1], a->v[2]);
    double moved[3];
    for (int i = 0; i < 3; i++) {
        moved[i] = a->p[i] - (rho * a->v[i] + (i == 0 ? rho_mu * sliding : 0.0));
    }
    cone_project(moved, mu, moved);
    tribo_vec3_subtract(a->p, moved, moved);
    return length_of(moved) / a->impulse_scale;
}

static void measure(const audit_problem *a, double mu, double unscale, tribo_measures *out)
{
    const double sliding = planar_length(a->v[1], a->v[2]);
    const double friction = planar_length(a->p[1], a->p[2]);
    const double impulse = a->p[0] / a->impulse_scale;
    const double velocity = a->v[0] / a->velocity_scale;
    const double across[3] = {0.0, sliding * a->p[1] + a->p[0] * a->v[1] * mu,
                              sliding * a->p[2] + a->p[0] * a->v[2] * mu};
    const double product = a->impulse_scale * a->velocity_scale;
    double both[3];
    tribo_vec3_add(a->b, a->v, both);
    out->eta = natural_map(a, mu);
    out->signorini = absolute(lesser(velocity, impulse));
    out->cone = greater(0.0, friction - mu * a->p[0]) / a->impulse_scale;
    out->misalignment = length_of(across) / product;
    out->energy = 0.5 * tribo_vec3_dot(a->p, both) / product;
    out->velocity = a->v[0] * unscale;
}

static tribo_status check_problem(const double w[6], const double b[3], double mu,
                                  const double p[3])
{
    const double probe = finite_probe(w, 6) + finite_probe(b, 3) + finite_probe(p, 3) + (mu - mu);
    if (!(probe == 0.0)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return mu >= 0.0 ? TRIBO_OK : TRIBO_ERROR_FRICTION;
}

/* Measures, and the posed problem for those who measure more. */
static tribo_status audit(const double w[6], const double b[3], double mu, const double p[3],
                          audit_problem *a, tribo_measures *out)
{
    tribo_status status = check_problem(w, b, mu, p);
    if (status == TRIBO_OK) {
        status = pose_problem(w, b, p, a);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    memset(out, 0, sizeof *out);
    if (a->velocity_scale > 0.0) {
        const double greatest = greater(w[0], greater(w[3], w[5]));
        const double image = length_of(p) * greatest;
        measure(a, mu, 1.0 / power_of_two(scale_exponent(greater(length_of(b), image))), out);
    }
    return all_finite(&out->eta, FIELDS) ? TRIBO_OK : TRIBO_ERROR_RANGE;
}

tribo_status tribo_audit_contact(const double w[6], const double b[3], double mu, const double p[3],
                                 tribo_measures *out)
{
    if (!w || !b || !p || !out) {
        return TRIBO_ERROR_NULL;
    }
    audit_problem a;
    tribo_measures measures;
    const tribo_status status = audit(w, b, mu, p, &a, &measures);
    if (status == TRIBO_OK) {
        *out = measures;
    }
    return status;
}

tribo_status tribo_audit_impact(const double w[6], const double u[3], const tribo_material *pair,
                                const double p[3], tribo_measures *out)
{
    if (!w || !u || !pair || !p || !out) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = check_problem(w, u, 0.0, p);
    if (status == TRIBO_OK) {
        status = tribo_material_check(pair);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    /* Sliding that rounding leaves of a stick counts as none. */
    const double b[3] = {u[0] < 0.0 ? (1.0 + pair->e) * u[0] : u[0], u[1], u[2]};
    audit_problem a;
    tribo_measures by_static;
    tribo_measures by_dynamic;
    status = audit(w, b, pair->mu_s, p, &a, &by_static);
    if (status == TRIBO_OK) {
        status = audit(w, b, pair->mu_d, p, &a, &by_dynamic);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    const double sliding = planar_length(a.v[1], a.v[2]);
    *out = sliding <= 1e-12 * a.velocity_scale ? by_static : by_dynamic;
    if (a.velocity_scale > 0.0) {
        /* v_n = u_n+ + e u_n-, so it is the deviation; the energy wants u- in place of b. */
        const double bounce = b[0] != 0.0 ? a.b[0] * (u[0] / b[0]) : 0.0;
        const double before[3] = {bounce, a.b[1], a.b[2]};
        double both[3];
        apply_matrix(a.w, a.p, both);
        tribo_vec3_add_scaled(both, 2.0, before, both);
        const double product = a.impulse_scale * a.velocity_scale;
        out->energy = 0.5 * tribo_vec3_dot(a.p, both) / product;
        out->velocity = u[0] < 0.0 ? a.v[0] / a.velocity_scale : 0.0;
    }
    return TRIBO_OK;
}

tribo_status tribo_audit_contacts(size_t count, const double *w, const double *b, const double *mu,
                                  const double *p, tribo_measures *max, tribo_measures *rms)
{
    if (count > 0 && (!w || !b || !mu || !p)) {
        return TRIBO_ERROR_NULL;
    }
    double greatest[FIELDS] = {0.0};
    double squares[FIELDS] = {0.0};
    for (size_t i = 0; i < count; i++) {
        audit_problem a;
        tribo_measures measures;
        double fields[FIELDS];
        const tribo_status status = audit(w + 6 * i, b + 3 * i, mu[i], p + 3 * i, &a, &measures);
        if (status != TRIBO_OK) {
            return status;
        }
        memcpy(fields, &measures, sizeof measures);
        for (int k = 0; k < FIELDS; k++) {
            greatest[k] = greater(greatest[k], absolute(fields[k]));
            squares[k] += fields[k] * fields[k];
        }
    }
    for (int k = 0; k < FIELDS && count > 0; k++) {
        squares[k] = sqrt(squares[k] / (double)count);
    }
    if (max) {
        memcpy(max, greatest, sizeof greatest);
    }
    if (rms) {
        memcpy(rms, squares, sizeof squares);
    }
    return TRIBO_OK;
}
