#include <tribo/contact.h>

#include "cone.h"
#include "dynamics.h"
#include "impact.h"
#include "solve.h"

#define FRAME_TOLERANCE 1e-9
#define NORMAL_TOLERANCE 1e-12

/* ---- structs that may be older than this library --------------------------------------------- */

static int size_is_known(uint32_t size, size_t newest)
{
    return size >= sizeof(uint32_t) && size <= newest && size % sizeof(uint32_t) == 0;
}

/* Fill a caller's info from a full one, as far as the caller's struct goes. */
static void give_info(void *info, void *full, uint32_t size)
{
    if (info) {
        memcpy(full, &size, sizeof size);
        memcpy(info, full, size);
    }
}

/* ---- geometry -------------------------------------------------------------------------------- */

static int is_unit(const double n[3])
{
    return absolute(tribo_vec3_dot(n, n) - 1.0) <= NORMAL_TOLERANCE;
}

tribo_status tribo_contact_at(const tribo_body *a, const tribo_body *b, const double point[3],
                              const double normal[3], tribo_contact *out)
{
    if (!a || !point || !normal || !out) {
        return TRIBO_ERROR_NULL;
    }
    tribo_contact contact;
    memcpy(contact.normal, normal, sizeof contact.normal);
    tribo_vec3_subtract(point, a->position, contact.arm_a);
    contact.arm_b[0] = contact.arm_b[1] = contact.arm_b[2] = 0.0;
    if (b) {
        tribo_vec3_subtract(point, b->position, contact.arm_b);
    }
    const tribo_status status = tribo_contact_check(&contact);
    if (status == TRIBO_OK) {
        *out = contact;
    }
    return status;
}

tribo_status tribo_contact_check(const tribo_contact *contact)
{
    if (!contact) {
        return TRIBO_ERROR_NULL;
    }
    const double probe = finite_probe(contact->normal, 3) + finite_probe(contact->arm_a, 3) +
                         finite_probe(contact->arm_b, 3);
    if (!(probe == 0.0)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return is_unit(contact->normal) ? TRIBO_OK : TRIBO_ERROR_NORMAL;
}

static void relative_velocity(const tribo_body *a, const tribo_body *b,
                              const tribo_contact *contact, const double frame[9], double u[3])
{
    double world[3];
    tribo_body_point_velocity(a, contact->arm_a, world);
    if (b) {
        double other[3];
        tribo_body_point_velocity(b, contact->arm_b, other);
        tribo_vec3_subtract(world, other, world);
    }
    tribo_mat3_apply(frame, world, u);
}

tribo_status tribo_contact_velocity(const tribo_body *a, const tribo_body *b,
                                    const tribo_contact *contact, const double frame[9],
                                    double u[3])
{
    if (!a || !contact || !frame || !u) {
        return TRIBO_ERROR_NULL;
    }
    double velocity[3];
    relative_velocity(a, b, contact, frame, velocity);
    if (!all_finite(velocity, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    memcpy(u, velocity, sizeof velocity);
    return TRIBO_OK;
}

static void find_mobility(const tribo_body *body, const double arm[3], const double frame[9],
                          double out[6])
{
    if (body && has_inertia(body)) {
        const double *q = body->orientation;
        const double *j = body->inverse_inertia;
        double r[9];
        rotation_rows(q[0], q[1], q[2], q[3], r);
        if (j[1] == 0.0 && j[2] == 0.0 && j[4] == 0.0) {
            kernel_mobility(r, j, 1, arm, frame, out);
        } else {
            kernel_mobility(r, j, 0, arm, frame, out);
        }
    } else {
        memset(out, 0, 6 * sizeof *out);
    }
}

static tribo_status build_matrix(const tribo_body *a, const tribo_body *b,
                                 const tribo_contact *contact, const double frame[9], double w[6])
{
    double of_a[6];
    double of_b[6];
    find_mobility(a, contact->arm_a, frame, of_a);
    find_mobility(b, contact->arm_b, frame, of_b);
    kernel_join(a->inverse_mass + (b ? b->inverse_mass : 0.0), of_a, of_b, w);
    if (!all_finite(w, 6)) {
        return TRIBO_ERROR_RANGE;
    }
    return w[0] > 0.0 ? TRIBO_OK : TRIBO_ERROR_IMMOVABLE;
}

static tribo_status check_bodies(const tribo_body *a, const tribo_body *b)
{
    if (a == b) {
        return TRIBO_ERROR_ALIAS;
    }
    const tribo_status status = tribo_body_check(a);
    return status != TRIBO_OK || !b ? status : tribo_body_check(b);
}

static tribo_status check_frame(const double frame[9])
{
    if (!all_finite(frame, 9)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    double third[3];
    double error = 0.0;
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j <= i; j++) {
            const double product = tribo_vec3_dot(frame + 3 * i, frame + 3 * j);
            error = greater(error, absolute(product - (i == j ? 1.0 : 0.0)));
        }
    }
    tribo_vec3_cross(frame, frame + 3, third);
    tribo_vec3_subtract(third, frame + 6, third);
    error = greater(error, tribo_vec3_dot(third, third) / FRAME_TOLERANCE);
    return error <= FRAME_TOLERANCE ? TRIBO_OK : TRIBO_ERROR_FRAME;
}

tribo_status tribo_contact_matrix(const tribo_body *a, const tribo_body *b,
                                  const tribo_contact *contact, const double frame[9], double w[6])
{
    if (!a || !contact || !frame || !w) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = tribo_contact_check(contact);
    if (status == TRIBO_OK) {
        status = check_frame(frame);
    }
    if (status == TRIBO_OK) {
        status = check_bodies(a, b);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    double matrix[6];
    status = build_matrix(a, b, contact, frame, matrix);
    if (status == TRIBO_OK) {
        memcpy(w, matrix, sizeof matrix);
    }
    return status;
}

/* Velocities of both bodies after +p on a and -p on b, world axes. */
static tribo_status push_pair(tribo_body *a, tribo_body *b, const tribo_contact *contact,
                              const double p[3])
{
    const double minus[3] = {-p[0], -p[1], -p[2]};
    tribo_body pushed_a = *a;
    push_body(&pushed_a, contact->arm_a, p);
    double probe = finite_probe(pushed_a.velocity, 3) + finite_probe(pushed_a.angular_velocity, 3);
    if (b) {
        tribo_body pushed_b = *b;
        push_body(&pushed_b, contact->arm_b, minus);
        probe += finite_probe(pushed_b.velocity, 3) + finite_probe(pushed_b.angular_velocity, 3);
        if (probe == 0.0) {
            *b = pushed_b;
        }
    }
    if (!(probe == 0.0)) {
        return TRIBO_ERROR_RANGE;
    }
    *a = pushed_a;
    return TRIBO_OK;
}

tribo_status tribo_contact_apply(tribo_body *a, tribo_body *b, const tribo_contact *contact,
                                 const double frame[9], const double p[3])
{
    if (!a || !contact || !frame || !p) {
        return TRIBO_ERROR_NULL;
    }
    if (!(finite_probe(contact->arm_a, 3) + finite_probe(contact->arm_b, 3) +
              finite_probe(frame, 9) + finite_probe(p, 3) ==
          0.0)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const tribo_status status = check_bodies(a, b);
    if (status != TRIBO_OK) {
        return status;
    }
    double world[3];
    tribo_mat3_apply_transposed(frame, p, world);
    return push_pair(a, b, contact, world);
}

/* ---- exact solve ----------------------------------------------------------------------------- */

static tribo_status solve_unscaled(const double w[6], const double b[3], double mu_s, double mu_d,
                                   double p[3], tribo_solve_info *full)
{
    kernel_problem problem;
    double nu;
    kernel_scale(w, b, &problem);
    const double mode = solve_scaled(&problem, mu_s, mu_d, p, &nu, &full->iterations);
    const tribo_status status = status_of_mode(mode);
    if (status != TRIBO_OK) {
        return status;
    }
    for (int i = 0; i < 3; i++) {
        p[i] = p[i] * problem.up * problem.up2;
    }
    full->mode = (uint32_t)mode;
    full->nu = nu;
    return all_finite(p, 3) ? TRIBO_OK : TRIBO_ERROR_RANGE;
}

static double greatest_diagonal(double x, double y, double z)
{
    return greater(greater(absolute(x), absolute(y)), absolute(z));
}

tribo_status tribo_contact_solve(const double w[6], const double b[3], double mu_s, double mu_d,
                                 double p[3], tribo_solve_info *info)
{
    if (!w || !b || !p) {
        return TRIBO_ERROR_NULL;
    }
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_solve_info full = {0};
    double impulse[3];
    const tribo_status status = solve_unscaled(w, b, mu_s, mu_d, impulse, &full);
    if (status == TRIBO_OK) {
        full.nu = lesser(
            full.nu / power_of_two(scale_exponent(greatest_diagonal(w[0], w[3], w[5]))), DBL_MAX);
        memcpy(p, impulse, sizeof impulse);
        give_info(info, &full, info ? info->struct_size : 0);
    }
    return status;
}

/* Range of the general problem, whose entries off the diagonal are bounded by nothing else. */
static tribo_status check_general(const double w[9], const double b[3], double mu_s, double mu_d)
{
    const double mu[2] = {mu_s, mu_d};
    if (!all_finite(w, 9) || !all_finite(b, 3) || !all_finite(mu, 2)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    double greatest_w = 0.0;
    double greatest_b = 0.0;
    for (int i = 0; i < 9; i++) {
        greatest_w = greater(greatest_w, absolute(w[i]));
    }
    for (int i = 0; i < 3; i++) {
        greatest_b = greater(greatest_b, absolute(b[i]));
    }
    if (greatest_w > TRIBO_LARGE || (greatest_w < TRIBO_SMALL && greatest_w > 0.0) ||
        greatest_b > TRIBO_LARGE) {
        return TRIBO_ERROR_RANGE;
    }
    if (mu_d < 0.0 || mu_s < mu_d) {
        return TRIBO_ERROR_FRICTION;
    }
    if (w[0] == 0.0) {
        return TRIBO_ERROR_IMMOVABLE;
    }
    return w[0] > 0.0 ? TRIBO_OK : TRIBO_ERROR_CONTACT_MATRIX;
}

tribo_status tribo_contact_solve_general(const double w[9], const double b[3], double mu_s,
                                         double mu_d, double p[3], tribo_solve_info *info)
{
    if (!w || !b || !p) {
        return TRIBO_ERROR_NULL;
    }
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    const tribo_status status = check_general(w, b, mu_s, mu_d);
    if (status != TRIBO_OK) {
        return status;
    }
    /* The symmetric problem with the same diagonal gives the scales. */
    const double diagonal[6] = {w[0], 0.0, 0.0, absolute(w[4]), 0.0, absolute(w[8])};
    kernel_problem scaled;
    kernel_scale(diagonal, b, &scaled);
    const double s = power_of_two(scale_exponent(greatest_diagonal(w[0], w[4], w[8])));
    const solve_general problem = {
        scaled.nn,
        {s * w[1], s * w[2]},
        {s * w[3], s * w[6]},
        {s * w[4], s * w[5], s * w[7], s * w[8]},
        scaled.bn,
        {scaled.b1, scaled.b2},
    };
    tribo_solve_info full = {0};
    double impulse[3];
    const double mode =
        solve_general_scaled(&problem, mu_s, mu_d, impulse, &full.nu, &full.iterations);
    if (status_of_mode(mode) != TRIBO_OK) {
        return status_of_mode(mode);
    }
    for (int i = 0; i < 3; i++) {
        impulse[i] = impulse[i] * scaled.up * scaled.up2;
    }
    if (!all_finite(impulse, 3)) {
        return TRIBO_ERROR_RANGE;
    }
    full.mode = (uint32_t)mode;
    full.nu = lesser(full.nu / s, DBL_MAX);
    memcpy(p, impulse, sizeof impulse);
    give_info(info, &full, info ? info->struct_size : 0);
    return TRIBO_OK;
}

/* ---- impact and collision -------------------------------------------------------------------- */

/* Options of any age into the full struct of this library. */
static tribo_status read_options(const tribo_impact_options *options, tribo_impact_options *full)
{
    memset(full, 0, sizeof *full);
    if (options) {
        if (!size_is_known(options->struct_size, sizeof *options)) {
            return TRIBO_ERROR_STRUCT_SIZE;
        }
        /* A field counts only if the caller's struct holds all of it. */
        const int has_law = options->struct_size >= offsetof(tribo_impact_options, law) + 4;
        full->law = has_law ? options->law : 0;
        if (options->struct_size >= sizeof *options) {
            full->tangential_restitution = options->tangential_restitution;
        }
    }
    return full->law <= TRIBO_LAW_LECTURE_CLOSING ? TRIBO_OK : TRIBO_ERROR_OPTION;
}

static tribo_status check_coefficients(const tribo_material *pair, double e_t)
{
    if (!all_finite(&e_t, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const tribo_status status = tribo_material_check(pair);
    if (status != TRIBO_OK) {
        return status;
    }
    return e_t >= -1.0 && e_t <= 1.0 ? TRIBO_OK : TRIBO_ERROR_RESTITUTION;
}

/* u+ and the energy, beyond double where they are nobody's concern but the caller's who asks for
 * them. */
static tribo_status check_outcome(const tribo_impact_info *full)
{
    return all_finite(full->velocity, 3) && all_finite(&full->energy, 1) ? TRIBO_OK
                                                                         : TRIBO_ERROR_RANGE;
}

static tribo_status solve_impact(const double w[6], const double u[3], const tribo_material *pair,
                                 const tribo_impact_options *options, double p[3],
                                 tribo_impact_info *full)
{
    kernel_problem problem;
    kernel_scale(w, u, &problem);
    if (problem.fault == KERNEL_NOT_FINITE) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const tribo_status status = check_coefficients(pair, options->tangential_restitution);
    if (status != TRIBO_OK) {
        return status;
    }
    if (problem.fault != KERNEL_OPEN) {
        return status_of_mode(problem.fault);
    }
    const double mode = impact_scaled(&problem, pair, options, p, full);
    if (status_of_mode(mode) != TRIBO_OK) {
        return status_of_mode(mode);
    }
    for (int i = 0; i < 3; i++) {
        p[i] = p[i] * problem.up * problem.up2;
    }
    full->mode = (uint32_t)mode;
    full->compression = full->compression * problem.up * problem.up2;
    full->velocity[0] = u[0] + (w[0] * p[0] + w[1] * p[1] + w[2] * p[2]);
    full->velocity[1] = u[1] + (w[1] * p[0] + w[3] * p[1] + w[4] * p[2]);
    full->velocity[2] = u[2] + (w[2] * p[0] + w[4] * p[1] + w[5] * p[2]);
    full->energy = 0.5 * (p[0] * (u[0] + full->velocity[0]) + p[1] * (u[1] + full->velocity[1]) +
                          p[2] * (u[2] + full->velocity[2]));
    return all_finite(p, 3) ? TRIBO_OK : TRIBO_ERROR_RANGE;
}

tribo_status tribo_impact(const double w[6], const double u[3], const tribo_material *pair,
                          const tribo_impact_options *options, double p[3], tribo_impact_info *info)
{
    if (!w || !u || !pair || !p) {
        return TRIBO_ERROR_NULL;
    }
    tribo_impact_options known;
    tribo_impact_info full = {0};
    double impulse[3];
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_status status = read_options(options, &known);
    if (status == TRIBO_OK) {
        status = solve_impact(w, u, pair, &known, impulse, &full);
    }
    if (status == TRIBO_OK && info && info->struct_size > offsetof(tribo_impact_info, velocity)) {
        status = check_outcome(&full);
    }
    if (status == TRIBO_OK) {
        memcpy(p, impulse, sizeof impulse);
        give_info(info, &full, info ? info->struct_size : 0);
    }
    return status;
}

static tribo_status check_collision(const tribo_body *a, const tribo_body *b,
                                    const tribo_contact *contact, const tribo_material *pair)
{
    tribo_status status = tribo_contact_check(contact);
    if (status == TRIBO_OK) {
        status = check_bodies(a, b);
    }
    if (status == TRIBO_OK) {
        status = tribo_material_check(pair);
    }
    return status;
}

tribo_status tribo_contact_resolve(tribo_body *a, tribo_body *b, const tribo_contact *contact,
                                   const tribo_material *pair, const tribo_impact_options *options,
                                   tribo_collision_info *info)
{
    if (!a || !contact || !pair) {
        return TRIBO_ERROR_NULL;
    }
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_impact_options known;
    tribo_collision_info full = {0};
    tribo_impact_info impact = {0};
    const double *n = contact->normal;
    tribo_status status = read_options(options, &known);
    if (status == TRIBO_OK) {
        status = check_collision(a, b, contact, pair);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    basis_rows(n[0], n[1], n[2], full.frame);
    status = build_matrix(a, b, contact, full.frame, full.matrix);
    if (status != TRIBO_OK) {
        return status;
    }
    relative_velocity(a, b, contact, full.frame, full.velocity_before);
    status = solve_impact(full.matrix, full.velocity_before, pair, &known, full.impulse, &impact);
    if (status == TRIBO_OK) {
        status = check_outcome(&impact);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    tribo_mat3_apply_transposed(full.frame, full.impulse, full.impulse_world);
    if (impact.mode != TRIBO_MODE_OPEN) {
        status = push_pair(a, b, contact, full.impulse_world);
    }
    if (status == TRIBO_OK) {
        full.mode = impact.mode;
        full.iterations = impact.iterations;
        memcpy(full.velocity_after, impact.velocity, sizeof impact.velocity);
        full.energy = impact.energy;
        give_info(info, &full, info ? info->struct_size : 0);
    }
    return status;
}

tribo_status tribo_collide(tribo_body *a, tribo_body *b, const double point[3],
                           const double normal[3], const tribo_material *pair,
                           const tribo_impact_options *options, tribo_collision_info *info)
{
    if (!a || !point || !normal || !pair) {
        return TRIBO_ERROR_NULL;
    }
    tribo_impact_options known;
    tribo_contact contact;
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_status status = read_options(options, &known);
    if (status == TRIBO_OK) {
        status = tribo_contact_at(a, b, point, normal, &contact);
    }
    return status == TRIBO_OK ? tribo_contact_resolve(a, b, &contact, pair, options, info) : status;
}

/* ---- friction cone --------------------------------------------------------------------------- */

static tribo_status check_cone(const double x[3], double mu, const double out[3])
{
    if (!x || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(x, 3) || !all_finite(&mu, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return mu >= 0.0 ? TRIBO_OK : TRIBO_ERROR_FRICTION;
}

/* The two sides of the cone, |p_t| and mu p_n, to full precision also where neither is a double:
 * |p_t| = length 2^shift / unit, mu p_n = limit / unit, unit the product of the two powers of two
 * whose biased exponents are given. */
typedef struct cone_sides {
    double x, y; /* p_t as scaled for its length */
    double length, limit;
    double shift;         /* 2^shift, held where the comparison is decided anyway */
    uint64_t unit_normal; /* of p_n and mu */
    uint64_t unit_mu;
} cone_sides;

static cone_sides measure_cone(const double p[3], double mu)
{
    cone_sides c;
    const uint64_t planar = scale_exponent(greater(absolute(p[1]), absolute(p[2])));
    const double s = power_of_two(planar);
    c.unit_normal = scale_exponent(p[0]);
    c.unit_mu = scale_exponent(mu);
    c.x = s * p[1];
    c.y = s * p[2];
    c.length = sqrt(c.x * c.x + c.y * c.y);
    c.limit = (power_of_two(c.unit_mu) * mu) * (power_of_two(c.unit_normal) * p[0]);
    const uint64_t from = planar + 1023u; /* unit / s = 2^(to - from) */
    const uint64_t to = c.unit_normal + c.unit_mu;
    const uint64_t up = to > from ? (to - from < 900u ? to - from : 900u) : 0u;
    const uint64_t down = from > to ? (from - to < 900u ? from - to : 900u) : 0u;
    c.shift = power_of_two(1023u + up - down);
    return c;
}

uint32_t tribo_cone_contains(const double p[3], double mu, double tolerance)
{
    const cone_sides c = measure_cone(p, mu);
    return p[0] >= 0.0 && c.length * c.shift <= c.limit * (1.0 + tolerance);
}

/* Numbers of any size brought near 2^900: sums and lengths of them are finite, and their products
 * with the least mu are normal numbers. Returns the first of the two factors. */
#define CONE_LIFT 8.452712498170644e+270 /* 2^900 */

static double scale_for_cone(const double x[3], double scaled[3])
{
    const double s = power_of_two(scale_exponent(greatest_diagonal(x[0], x[1], x[2])));
    for (int i = 0; i < 3; i++) {
        scaled[i] = s <= 1.0 ? x[i] * (s * CONE_LIFT) : s * x[i] * CONE_LIFT;
    }
    return s;
}

/* Back to the caller's units; TRIBO_ERROR_RANGE if that is beyond double. */
static tribo_status unscale_from_cone(const double scaled[3], double s, double out[3])
{
    double x[3];
    for (int i = 0; i < 3; i++) {
        /* No step goes below the least normal number unless the result does. */
        x[i] = s <= 1.0 ? scaled[i] / (CONE_LIFT * s) : scaled[i] / CONE_LIFT / s;
    }
    if (!all_finite(x, 3)) {
        return TRIBO_ERROR_RANGE;
    }
    memcpy(out, x, sizeof x);
    return TRIBO_OK;
}

/* Rounding p_t to subnormal numbers may have put it outside of the cone: down by one of them. */
static void step_into_cone(double p[3], double mu)
{
    if (greater(absolute(p[1]), absolute(p[2])) >= DBL_MIN) {
        return;
    }
    for (int tries = 0; tries < 2 && !tribo_cone_contains(p, mu, 4.0 * TRIBO_EPS); tries++) {
        for (int i = 1; i < 3; i++) {
            if (p[i] != 0.0) {
                p[i] = double_of(bits_of(p[i]) - 1u);
            }
        }
    }
}

tribo_status tribo_cone_project(const double p[3], double mu, double out[3])
{
    tribo_status status = check_cone(p, mu, out);
    if (status == TRIBO_OK) {
        double scaled[3];
        const double s = scale_for_cone(p, scaled);
        cone_project(scaled, mu, scaled);
        status = unscale_from_cone(scaled, s, out);
    }
    if (status == TRIBO_OK) {
        step_into_cone(out, mu);
    }
    return status;
}

tribo_status tribo_cone_project_dual(const double x[3], double mu, double out[3])
{
    tribo_status status = check_cone(x, mu, out);
    if (status == TRIBO_OK) {
        /* Moreau: x = P_K*(x) - P_K(-x). */
        double scaled[3];
        double polar[3];
        const double s = scale_for_cone(x, scaled);
        const double minus[3] = {-scaled[0], -scaled[1], -scaled[2]};
        cone_project(minus, mu, polar);
        tribo_vec3_add(scaled, polar, scaled);
        status = unscale_from_cone(scaled, s, out);
    }
    return status;
}

tribo_status tribo_cone_clamp(const double p[3], double mu, double out[3])
{
    const tribo_status status = check_cone(p, mu, out);
    if (status == TRIBO_OK) {
        const double upright[3] = {p[0] > 0.0 ? p[0] : 0.0, p[1], p[2]};
        const cone_sides c = measure_cone(upright, mu);
        const int outside = c.length * c.shift > c.limit;
        /* 1 / unit in two halves, so that nothing goes beyond double on the way */
        const uint64_t e = 4092u - c.unit_normal - c.unit_mu;
        const double first = power_of_two((e >> 1));
        const double second = power_of_two(e - (e >> 1));
        out[0] = upright[0];
        out[1] = outside ? c.x / c.length * c.limit * first * second : upright[1];
        out[2] = outside ? c.y / c.length * c.limit * first * second : upright[2];
    }
    return status;
}

/* ---- force-level friction -------------------------------------------------------------------- */

static tribo_status check_force(const double f[3], const double n[3], const double out[3])
{
    if (!f || !n || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(f, 3) || !all_finite(n, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return is_unit(n) ? TRIBO_OK : TRIBO_ERROR_NORMAL;
}

tribo_status tribo_friction_reaction(const double f[3], const double n[3], double reaction[3])
{
    const tribo_status status = check_force(f, n, reaction);
    if (status == TRIBO_OK) {
        const double along = tribo_vec3_dot(f, n);
        tribo_vec3_scale(along < 0.0 ? along : 0.0, n, reaction);
    }
    return status;
}

tribo_status tribo_friction_planar(const double f[3], const double n[3], double planar[3])
{
    const tribo_status status = check_force(f, n, planar);
    if (status == TRIBO_OK) {
        tribo_vec3_add_scaled(f, -tribo_vec3_dot(f, n), n, planar);
    }
    return status;
}

uint32_t tribo_friction_holds(const double planar[3], const double reaction[3], double mu_s)
{
    return tribo_vec3_norm(planar) <= mu_s * tribo_vec3_norm(reaction);
}

tribo_status tribo_friction_force(const double f[3], const double n[3], const tribo_material *pair,
                                  double force[3], uint32_t *mode)
{
    if (!pair) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = tribo_material_check(pair);
    if (status != TRIBO_ERROR_NOT_FINITE) {
        const tribo_status force_status = check_force(f, n, force);
        status = force_status != TRIBO_OK ? force_status : status;
    }
    if (status != TRIBO_OK) {
        return status;
    }
    double reaction[3];
    double planar[3];
    const int presses = tribo_vec3_dot(f, n) < 0.0;
    tribo_friction_reaction(f, n, reaction);
    tribo_friction_planar(f, n, planar);
    const int holds = presses && tribo_friction_holds(planar, reaction, pair->mu_s);
    const double dynamic = pair->mu_d * tribo_vec3_norm(reaction);
    const double share = holds ? 1.0 : presses ? dynamic / tribo_vec3_norm(planar) : 0.0;
    tribo_vec3_scale(-share, planar, force);
    if (mode) {
        *mode = holds ? TRIBO_MODE_STICK : presses ? TRIBO_MODE_SLIP : TRIBO_MODE_OPEN;
    }
    return TRIBO_OK;
}
