#include <tribo/body.h>

#include "dynamics.h"
#include "sym3.h"

#include <math.h>

#define UNIT_TOLERANCE 1e-6 /* of quaternions, which are used as if normalised */
#define INERTIA_TOLERANCE 1e-12
#define MAX_TURN 1e5 /* radians in one call of tribo_body_advance */

tribo_status tribo_body_init(tribo_body *body)
{
    if (!body) {
        return TRIBO_ERROR_NULL;
    }
    memset(body, 0, sizeof *body);
    body->orientation[0] = 1.0;
    return TRIBO_OK;
}

/* No principal moment of a body exceeds the sum of the two others. With T = trace, that says that
 * T/2 1 - I is positive semidefinite. */
static int is_inertia_of_a_body(const double i[6])
{
    const double half = 0.5 * (i[0] + i[3] + i[5]);
    const double slack = half * (1.0 + 1e-9);
    const double m[6] = {slack - i[0], -i[1], -i[2], slack - i[3], -i[4], slack - i[5]};
    return sym3_is_semidefinite(m, INERTIA_TOLERANCE);
}

tribo_status tribo_body_set_mass(tribo_body *body, double mass, const double inertia[9])
{
    if (!body || !inertia) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(&mass, 1) || !all_finite(inertia, 9)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (!(mass > 0.0)) {
        return TRIBO_ERROR_MASS;
    }
    const double scale = greater(inertia[0], greater(inertia[4], inertia[8]));
    const double asymmetry =
        greater(absolute(inertia[1] - inertia[3]),
                greater(absolute(inertia[2] - inertia[6]), absolute(inertia[5] - inertia[7])));
    if (!(asymmetry <= INERTIA_TOLERANCE * scale)) {
        return TRIBO_ERROR_INERTIA;
    }
    const double symmetric[6] = {
        inertia[0], 0.5 * inertia[1] + 0.5 * inertia[3], 0.5 * inertia[2] + 0.5 * inertia[6],
        inertia[4], 0.5 * inertia[5] + 0.5 * inertia[7], inertia[8],
    };
    if (!(symmetric[0] > 0.0 && symmetric[3] > 0.0 && symmetric[5] > 0.0) ||
        !sym3_is_semidefinite(symmetric, 0.0) || !is_inertia_of_a_body(symmetric)) {
        return TRIBO_ERROR_INERTIA;
    }
    const double inverse_mass = 1.0 / mass;
    double inverse[6];
    if (!all_finite(&inverse_mass, 1) || inverse_mass == 0.0 || !sym3_invert(symmetric, inverse)) {
        return TRIBO_ERROR_RANGE;
    }
    body->inverse_mass = inverse_mass;
    memcpy(body->inverse_inertia, inverse, sizeof inverse);
    return TRIBO_OK;
}

tribo_status tribo_body_check(const tribo_body *body)
{
    if (!body) {
        return TRIBO_ERROR_NULL;
    }
    const double pose = finite_probe(body->position, 3) + finite_probe(body->orientation, 4);
    const double rates = finite_probe(body->velocity, 3) + finite_probe(body->angular_velocity, 3);
    const double masses =
        finite_probe(&body->inverse_mass, 1) + finite_probe(body->inverse_inertia, 6);
    if (!(pose + rates + masses == 0.0)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const double *q = body->orientation;
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(absolute(square - 1.0) <= 2.0 * UNIT_TOLERANCE)) {
        return TRIBO_ERROR_ORIENTATION;
    }
    if (body->inverse_mass < 0.0) {
        return TRIBO_ERROR_MASS;
    }
    return sym3_is_semidefinite(body->inverse_inertia, INERTIA_TOLERANCE) ? TRIBO_OK
                                                                          : TRIBO_ERROR_INERTIA;
}

/* ---- mass properties ------------------------------------------------------------------------- */

static tribo_status check_shape(double density, const double *lengths, int count,
                                const double *mass, const double *inertia)
{
    if (!lengths || !mass || !inertia) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(&density, 1) || !all_finite(lengths, count)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    int positive = density > 0.0;
    for (int i = 0; i < count; i++) {
        positive = positive && lengths[i] > 0.0;
    }
    return positive ? TRIBO_OK : TRIBO_ERROR_SHAPE;
}

static tribo_status write_mass(double m, double xx, double yy, double zz, double *mass,
                               double inertia[9])
{
    const double values[4] = {m, xx, yy, zz};
    for (int i = 0; i < 4; i++) {
        if (!(values[i] > 0.0) || !all_finite(&values[i], 1)) {
            return TRIBO_ERROR_RANGE;
        }
    }
    const double full[9] = {xx, 0.0, 0.0, 0.0, yy, 0.0, 0.0, 0.0, zz};
    *mass = m;
    memcpy(inertia, full, sizeof full);
    return TRIBO_OK;
}

#define PI 3.14159265358979323846

tribo_status tribo_mass_sphere(double density, double radius, double *mass, double inertia[9])
{
    const double axes[3] = {radius, radius, radius};
    return tribo_mass_ellipsoid(density, axes, mass, inertia);
}

tribo_status tribo_mass_box(double density, const double half[3], double *mass, double inertia[9])
{
    const tribo_status status = check_shape(density, half, 3, mass, inertia);
    if (status != TRIBO_OK) {
        return status;
    }
    const double m = 8.0 * density * half[0] * half[1] * half[2];
    const double xx = half[0] * half[0];
    const double yy = half[1] * half[1];
    const double zz = half[2] * half[2];
    return write_mass(m, m * (yy + zz) / 3.0, m * (xx + zz) / 3.0, m * (xx + yy) / 3.0, mass,
                      inertia);
}

tribo_status tribo_mass_capsule(double density, double radius, double half_height, double *mass,
                                double inertia[9])
{
    const double lengths[2] = {radius, half_height};
    const tribo_status status = check_shape(density, lengths, 2, mass, inertia);
    if (status != TRIBO_OK) {
        return status;
    }
    const double r2 = radius * radius;
    const double h = half_height;
    const double barrel = 2.0 * PI * density * r2 * h;
    const double caps = 4.0 / 3.0 * PI * density * r2 * radius;
    /* A half-ball's centre of mass lies 3/8 r from its face; about the capsule's centre the two
     * caps give m (2/5 r^2 + h^2 + 3/4 h r) across the axis. */
    const double across =
        barrel * (0.25 * r2 + h * h / 3.0) + caps * (0.4 * r2 + h * h + 0.75 * h * radius);
    const double along = 0.5 * barrel * r2 + 0.4 * caps * r2;
    return write_mass(barrel + caps, across, across, along, mass, inertia);
}

tribo_status tribo_mass_cylinder(double density, double radius, double half_height, double *mass,
                                 double inertia[9])
{
    const double lengths[2] = {radius, half_height};
    const tribo_status status = check_shape(density, lengths, 2, mass, inertia);
    if (status != TRIBO_OK) {
        return status;
    }
    const double r2 = radius * radius;
    const double m = 2.0 * PI * density * r2 * half_height;
    const double across = m * (0.25 * r2 + half_height * half_height / 3.0);
    return write_mass(m, across, across, 0.5 * m * r2, mass, inertia);
}

tribo_status tribo_mass_ellipsoid(double density, const double semi_axes[3], double *mass,
                                  double inertia[9])
{
    const tribo_status status = check_shape(density, semi_axes, 3, mass, inertia);
    if (status != TRIBO_OK) {
        return status;
    }
    const double m = 4.0 / 3.0 * PI * density * semi_axes[0] * semi_axes[1] * semi_axes[2];
    const double xx = semi_axes[0] * semi_axes[0];
    const double yy = semi_axes[1] * semi_axes[1];
    const double zz = semi_axes[2] * semi_axes[2];
    return write_mass(m, m * (yy + zz) / 5.0, m * (xx + zz) / 5.0, m * (xx + yy) / 5.0, mass,
                      inertia);
}

/* ---- kinematics ------------------------------------------------------------------------------ */

static void world_rotation(const tribo_body *body, double r[9])
{
    const double *q = body->orientation;
    rotation_rows(q[0], q[1], q[2], q[3], r);
}

tribo_status tribo_body_world_inverse_inertia(const tribo_body *body, double out[6])
{
    if (!out) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = tribo_body_check(body);
    if (status != TRIBO_OK) {
        return status;
    }
    double r[9];
    double image[3][3];
    world_rotation(body, r);
    for (int i = 0; i < 3; i++) {
        tribo_sym3_apply(body->inverse_inertia, r + 3 * i, image[i]);
    }
    out[0] = tribo_vec3_dot(r, image[0]);
    out[1] = tribo_vec3_dot(r, image[1]);
    out[2] = tribo_vec3_dot(r, image[2]);
    out[3] = tribo_vec3_dot(r + 3, image[1]);
    out[4] = tribo_vec3_dot(r + 3, image[2]);
    out[5] = tribo_vec3_dot(r + 6, image[2]);
    return TRIBO_OK;
}

/* out = I w for the free axes of a body whose inverse inertia may have zero rows. Rows that are not
 * zero form a block that is inverted alone, by putting 1 on the diagonal of the locked ones. */
static int apply_inertia(const double inverse_inertia[6], const double w[3], double out[3])
{
    double block[6];
    double inverse[6];
    memcpy(block, inverse_inertia, sizeof block);
    const int diagonal[3] = {0, 3, 5};
    double greatest = greater(block[0], greater(block[3], block[5]));
    for (int i = 0; i < 3; i++) {
        if (inverse_inertia[diagonal[i]] == 0.0) {
            block[diagonal[i]] = greatest;
        }
    }
    if (greatest == 0.0 || !sym3_invert(block, inverse)) {
        out[0] = out[1] = out[2] = 0.0;
        return greatest == 0.0;
    }
    tribo_sym3_apply(inverse, w, out);
    for (int i = 0; i < 3; i++) {
        if (inverse_inertia[diagonal[i]] == 0.0) {
            out[i] = 0.0;
        }
    }
    return 1;
}

tribo_status tribo_body_spin(const tribo_body *body, double out[3])
{
    if (!out) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = tribo_body_check(body);
    if (status != TRIBO_OK) {
        return status;
    }
    double r[9];
    double w[3];
    double spin[3];
    world_rotation(body, r);
    tribo_mat3_apply_transposed(r, body->angular_velocity, w);
    if (!apply_inertia(body->inverse_inertia, w, spin)) {
        return TRIBO_ERROR_INERTIA;
    }
    tribo_mat3_apply(r, spin, out);
    return TRIBO_OK;
}

void tribo_body_point_velocity(const tribo_body *body, const double arm[3], double out[3])
{
    double turn[3];
    tribo_vec3_cross(body->angular_velocity, arm, turn);
    tribo_vec3_add(body->velocity, turn, out);
}

tribo_status tribo_body_apply_impulse(tribo_body *body, const double arm[3], const double p[3])
{
    if (!body || !arm || !p) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(arm, 3) || !all_finite(p, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const tribo_status status = tribo_body_check(body);
    if (status != TRIBO_OK) {
        return status;
    }
    tribo_body pushed = *body;
    push_body(&pushed, arm, p);
    if (!all_finite(pushed.velocity, 3) || !all_finite(pushed.angular_velocity, 3)) {
        return TRIBO_ERROR_RANGE;
    }
    *body = pushed;
    return TRIBO_OK;
}

/* ---- free flight ----------------------------------------------------------------------------- */

enum { MAX_ORDER = 30, MAX_TRIES = 300000 }; /* 1e5 radians by halves, and a half more */
#define TURN_PER_SUBSTEP 0.5
#define SERIES_TOLERANCE 1e-17 /* of the last two terms, relative to the sum */

typedef struct spin_state {
    double spin[3];        /* I w, body axes */
    double orientation[4]; /* body to world */
} spin_state;

/* a x b and q o (0, w), added to the sums. */
static void add_cross(const double a[3], const double b[3], double sum[3])
{
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
}

static void add_turn(const double q[4], const double w[3], double sum[4])
{
    sum[0] -= q[1] * w[0] + q[2] * w[1] + q[3] * w[2];
    sum[1] += q[0] * w[0] + q[2] * w[2] - q[3] * w[1];
    sum[2] += q[0] * w[1] + q[3] * w[0] - q[1] * w[2];
    sum[3] += q[0] * w[2] + q[1] * w[1] - q[2] * w[0];
}

static double greatest_of(const double *x, int count)
{
    double greatest = 0.0;
    for (int i = 0; i < count; i++) {
        greatest = greater(greatest, absolute(x[i]));
    }
    return greatest;
}

/* One Taylor step of length h of L' = L x w, w = I^-1 L, q' = q (0, w) / 2, all in body axes:
 * (k+1) L_{k+1} = h sum_i L_i x w_{k-i}, and so for q. Returns 0 if the series has not settled
 * within MAX_ORDER terms; then h is too long. */
static int taylor_step(const double inverse_inertia[6], double h, spin_state *state)
{
    double spin[MAX_ORDER + 1][3];
    double w[MAX_ORDER + 1][3];
    double q[MAX_ORDER + 1][4];
    memcpy(spin[0], state->spin, sizeof spin[0]);
    memcpy(q[0], state->orientation, sizeof q[0]);
    const double spin_limit = SERIES_TOLERANCE * greatest_of(spin[0], 3);
    int settled = 0;
    int order = 0;
    while (settled < 2) {
        if (order == MAX_ORDER) {
            return 0;
        }
        double spin_sum[3] = {0.0, 0.0, 0.0};
        double q_sum[4] = {0.0, 0.0, 0.0, 0.0};
        tribo_sym3_apply(inverse_inertia, spin[order], w[order]);
        for (int i = 0; i <= order; i++) {
            add_cross(spin[i], w[order - i], spin_sum);
            add_turn(q[i], w[order - i], q_sum);
        }
        const double factor = h / (order + 1);
        order++;
        tribo_vec3_scale(factor, spin_sum, spin[order]);
        for (int i = 0; i < 4; i++) {
            q[order][i] = 0.5 * factor * q_sum[i];
        }
        const int small = greatest_of(spin[order], 3) <= spin_limit &&
                          greatest_of(q[order], 4) <= SERIES_TOLERANCE;
        settled = small ? settled + 1 : 0;
    }
    for (int k = order - 1; k >= 0; k--) {
        tribo_vec3_add(spin[k], spin[k + 1], spin[k]);
        for (int i = 0; i < 4; i++) {
            q[k][i] += q[k + 1][i];
        }
    }
    memcpy(state->spin, spin[0], sizeof spin[0]);
    memcpy(state->orientation, q[0], sizeof q[0]);
    return 1;
}

/* Free rotation over dt in as many steps as the series needs. Lengths are tied to |w| as it is at
 * each step, because a slender body may turn much faster later on. */
static tribo_status turn_freely(const double inverse_inertia[6], double dt, spin_state *state)
{
    const double spin_norm = tribo_vec3_norm(state->spin);
    double left = dt;
    double shrink = 1.0;
    for (int tries = 0; left > 0.0; tries++) {
        double w[3];
        tribo_sym3_apply(inverse_inertia, state->spin, w);
        const double rate = tribo_vec3_norm(w);
        const double longest = shrink * TURN_PER_SUBSTEP;
        const double h = rate * left > longest ? longest / rate : left;
        if (tries == MAX_TRIES) {
            return TRIBO_ERROR_TIME_STEP;
        }
        if (!taylor_step(inverse_inertia, h, state)) {
            shrink *= 0.5;
            continue;
        }
        left = h < left ? left - h : 0.0;
        shrink = lesser(1.0, 2.0 * shrink);
    }
    /* Torque-free: what rounding did to |L| is taken back. */
    const double norm = tribo_vec3_norm(state->spin);
    if (norm > 0.0) {
        tribo_vec3_scale(spin_norm / norm, state->spin, state->spin);
    }
    return TRIBO_OK;
}

/* w stays as it is in world axes: equal moments, locked axes, kinematic bodies. */
static tribo_status turn_uniformly(tribo_body *body, double dt)
{
    double turn[3];
    double step[4];
    tribo_vec3_scale(dt, body->angular_velocity, turn);
    const tribo_status status = tribo_quat_from_rotation_vector(turn, step);
    if (status == TRIBO_OK) {
        tribo_quat_multiply(step, body->orientation, body->orientation);
    }
    return status;
}

static int turns_uniformly(const double j[6])
{
    const int locked = j[0] == 0.0 || j[3] == 0.0 || j[5] == 0.0;
    const int equal = j[0] == j[3] && j[3] == j[5] && j[1] == 0.0 && j[2] == 0.0 && j[4] == 0.0;
    return locked || equal;
}

static tribo_status turn_body(tribo_body *body, double dt)
{
    const double *j = body->inverse_inertia;
    const double rate = tribo_vec3_norm(body->angular_velocity);
    if (!(rate * dt <= MAX_TURN)) {
        return TRIBO_ERROR_TIME_STEP;
    }
    if (rate == 0.0) {
        return TRIBO_OK;
    }
    if (turns_uniformly(j)) {
        return turn_uniformly(body, dt);
    }
    spin_state state;
    double r[9];
    double w[3];
    memcpy(state.orientation, body->orientation, sizeof state.orientation);
    world_rotation(body, r);
    tribo_mat3_apply_transposed(r, body->angular_velocity, w);
    /* A unit of time near dt: then all is of order |omega| dt. A power of two: then it is exact. */
    const double per_unit = tribo_pow2_scale(dt);
    tribo_vec3_scale(1.0 / per_unit, w, w);
    if (!apply_inertia(j, w, state.spin)) {
        return TRIBO_ERROR_INERTIA;
    }
    const tribo_status status = turn_freely(j, per_unit * dt, &state);
    if (status != TRIBO_OK) {
        return status;
    }
    memcpy(body->orientation, state.orientation, sizeof state.orientation);
    world_rotation(body, r);
    tribo_sym3_apply(j, state.spin, w);
    tribo_vec3_scale(per_unit, w, w);
    tribo_mat3_apply(r, w, body->angular_velocity);
    return TRIBO_OK;
}

tribo_status tribo_body_advance(tribo_body *body, const double acceleration[3], double dt)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const double *a = acceleration ? acceleration : none;
    if (!body) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(a, 3) || !all_finite(&dt, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    tribo_status status = tribo_body_check(body);
    if (status != TRIBO_OK) {
        return status;
    }
    if (dt < 0.0) {
        return TRIBO_ERROR_TIME_STEP;
    }
    if (dt == 0.0) {
        return TRIBO_OK;
    }
    tribo_body moved = *body;
    if (body->inverse_mass == 0.0) {
        a = none;
    }
    for (int i = 0; i < 3; i++) {
        moved.position[i] += dt * (moved.velocity[i] + 0.5 * dt * a[i]);
        if (a[i] != 0.0) {
            moved.velocity[i] += dt * a[i];
        }
    }
    status = turn_body(&moved, dt);
    if (status == TRIBO_OK) {
        status = tribo_quat_normalize(moved.orientation, moved.orientation);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    status = tribo_body_check(&moved);
    if (status != TRIBO_OK) {
        return status == TRIBO_ERROR_NOT_FINITE ? TRIBO_ERROR_RANGE : status;
    }
    *body = moved;
    return TRIBO_OK;
}
