/*
 * One long mixed run over every public function, hashed: same source, same bits, on every platform.
 *
 * Prints a 64-bit FNV-1a hash per room and one over all of them. Stands alone: no test library, no
 * files, and inputs made of integers by exact operations only, so that a difference in the hash is
 * one in the library. The sign and payload of NaN are no promise and are not hashed.
 *
 * TRIBO_ISA in the environment names the instruction set of batches and sweeps (default: best).
 * Exit status 77: this machine or build has no such instruction set.
 */
#include "run.h"

#include <tribo/system.h>
#include <tribo/tribo.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void make_normal(double n[3])
{
    static const double exact[][3] = {{1, 0, 0},    {0, -1, 0},    {0, 0, 1},       {-0.0, 0.0, -1},
                                      {0, -0.0, 1}, {0.6, 0.8, 0}, {0, -0.28, 0.96}};
    double v[3];
    fill(v, 3, below(8) ? 0 : 30);
    if (below(8) == 0 || tribo_vec3_normalize(v, n) != TRIBO_OK) {
        memcpy(n, exact[below((int)COUNT(exact))], 3 * sizeof *n);
    }
}

/* Semidefinite by construction: A A^T of small integers is exact, so is scaling by powers of 2. */
static void make_matrix(double w[6], int spread)
{
    double a[3][3];
    const double scale = power(below(2 * spread + 1) - spread);
    for (int i = 0; i < 3; ++i) {
        const double row = power(below(2) ? 0 : -below(20));
        for (int j = 0; j < 3; ++j) {
            a[i][j] = row * (below(1 << 17) - (1 << 16));
        }
    }
    for (int i = 0, k = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j, ++k) {
            w[k] = scale * (a[i][0] * a[j][0] + a[i][1] * a[j][1] + a[i][2] * a[j][2]);
        }
    }
    if (below(64) == 0) {
        const int entry = below(6);
        w[entry] = odd(spread);
    }
}

static tribo_material make_pair(void)
{
    tribo_material pair;
    pair.mu_s = below(16) ? 2 * fraction() : wide(30);
    pair.mu_d = below(3) ? pair.mu_s : pair.mu_s * fraction();
    pair.e = below(3) ? fraction() : (double)below(2);
    if (below(64) == 0) {
        pair.mu_d = odd(4);
    }
    if (below(64) == 0) {
        pair.e = odd(1);
    }
    return pair;
}

static void make_moments(double inertia[9])
{
    double mass, half[3];
    const int shape = below(6);
    for (int i = 0; i < 3; ++i) {
        half[i] = 0x1p-3 + fraction();
    }
    half[1] = shape < 2 ? half[0] : half[1];
    half[2] = shape < 1 ? half[0] : half[2];
    memset(inertia, 0, 9 * sizeof *inertia);
    (void)tribo_mass_box(1000.0, half, &mass, inertia);
}

static void spoil(tribo_body *body)
{
    double *const fields[] = {body->position,         body->orientation,   body->velocity,
                              body->angular_velocity, &body->inverse_mass, body->inverse_inertia};
    double *const field = fields[below((int)COUNT(fields))];
    *field = odd(4);
}

static tribo_body make_body(void)
{
    tribo_body body;
    double inertia[9];
    (void)tribo_body_init(&body);
    fill(body.position, 3, below(16) ? 2 : 40);
    fill(body.velocity, 3, below(16) ? 2 : 40);
    fill(body.angular_velocity, 3, below(16) ? 2 : 6);
    fill(body.orientation, 4, 0);
    (void)tribo_quat_normalize(body.orientation, body.orientation);
    if (below(8)) {
        const double scale = power(below(12));
        make_moments(inertia);
        (void)tribo_body_set_mass(&body, 1 + scale * fraction(), inertia);
    }
    if (below(128) == 0) {
        spoil(&body);
    }
    return body;
}

static void put_body(const tribo_body *body)
{
    put_doubles(body->position, 3);
    put_doubles(body->orientation, 4);
    put_doubles(body->velocity, 3);
    put_doubles(body->angular_velocity, 3);
    put_double(body->inverse_mass);
    put_doubles(body->inverse_inertia, 6);
}

/* ---- base ------------------------------------------------------------------------------------ */

static void run_base(void)
{
    for (tribo_status status = -1; status < 80; ++status) {
        put_string(tribo_status_name(status));
    }
    put_u64(tribo_version() ==
            TRIBO_VERSION_MAJOR * 10000 + TRIBO_VERSION_MINOR * 100 + TRIBO_VERSION_PATCH);
    put_u64(tribo_status_string(TRIBO_ERROR_NULL) != NULL && tribo_version_string() != NULL);
}

/* ---- math ------------------------------------------------------------------------------------ */

static void run_vectors(int spread)
{
    double a[9], b[9], out[9];
    double s[6];
    fill_odd(a, 9, spread);
    fill_odd(b, 9, spread);
    fill_odd(s, 6, spread);
    put_double(tribo_vec3_dot(a, b));
    tribo_vec3_cross(a, b, out);
    put_doubles(out, 3);
    tribo_vec3_add(a, b, out);
    put_doubles(out, 3);
    tribo_vec3_subtract(a, b, out);
    put_doubles(out, 3);
    tribo_vec3_scale(b[0], a, out);
    put_doubles(out, 3);
    tribo_vec3_add_scaled(a, s[0], b, out);
    put_doubles(out, 3);
    put_double(tribo_vec3_norm(a));
    put_status(tribo_vec3_normalize(a, out));
    put_doubles(out, 3);
    tribo_mat3_multiply(a, b, out);
    put_doubles(out, 9);
    tribo_mat3_transpose(a, out);
    put_doubles(out, 9);
    tribo_mat3_apply(a, b, out);
    put_doubles(out, 3);
    tribo_mat3_apply_transposed(a, b, out);
    put_doubles(out, 3);
    tribo_sym3_apply(s, a, out);
    put_doubles(out, 3);
    tribo_skew_matrix(a, out);
    put_doubles(out, 9);
    tribo_skew_congruence(a, s, out);
    put_doubles(out, 6);
    tribo_skew_cross_apply(a, s, b, out);
    put_doubles(out, 3);
}

static void run_quaternions(int spread)
{
    double a[4], b[4], v[3], out[9] = {0};
    fill_odd(a, 4, spread);
    fill_odd(b, 4, spread);
    fill_odd(v, 3, 21);
    tribo_quat_multiply(a, b, out);
    put_doubles(out, 4);
    tribo_quat_conjugate(a, out);
    put_doubles(out, 4);
    put_status(tribo_quat_normalize(a, out));
    put_doubles(out, 4);
    tribo_quat_to_mat3(a, out);
    put_doubles(out, 9);
    tribo_quat_rotate(a, v, out);
    put_doubles(out, 3);
    tribo_quat_rotate_inverse(a, v, out);
    put_doubles(out, 3);
    put_status(tribo_quat_from_rotation_vector(v, out));
    put_doubles(out, 4);
    put_double(tribo_quat_angle(a, b));
}

static void run_elementary(void)
{
    double sine = 0, cosine = 0, yx[2], n[3], frame[9] = {0};
    tribo_sin_cos(odd(21), &sine, &cosine);
    put_double(sine);
    put_double(cosine);
    fill_odd(yx, 2, 20);
    put_double(tribo_atan2(yx[0], yx[1]));
    put_double(tribo_pow2_scale(odd(1010)));
    make_normal(n);
    if (below(32) == 0) {
        const int entry = below(3);
        n[entry] += wide(30) * 0x1p-30;
    }
    put_status(tribo_basis_from_normal(n, frame));
    put_doubles(frame, 9);
}

static void run_math(void)
{
    for (int i = 0; i < 4000; ++i) {
        const int spread = i % 4 ? 3 : 1000;
        run_vectors(spread);
        run_quaternions(spread);
        run_elementary();
    }
}

/* ---- body ------------------------------------------------------------------------------------ */

static void run_solids(void)
{
    const double density = below(16) ? power(below(14)) : odd(300);
    const double radius = below(16) ? fraction() : odd(300);
    const double height = below(16) ? fraction() : odd(300);
    double axes[3], mass = 0, inertia[9] = {0};
    fill_odd(axes, 3, 2);
    for (int i = 0; i < 3; ++i) {
        axes[i] = axes[i] < 0 && below(8) ? -axes[i] : axes[i];
    }
    put_status(tribo_mass_sphere(density, radius, &mass, inertia));
    put_double(mass);
    put_doubles(inertia, 9);
    put_status(tribo_mass_box(density, axes, &mass, inertia));
    put_double(mass);
    put_doubles(inertia, 9);
    put_status(tribo_mass_capsule(density, radius, height, &mass, inertia));
    put_double(mass);
    put_doubles(inertia, 9);
    put_status(tribo_mass_cylinder(density, radius, height, &mass, inertia));
    put_double(mass);
    put_doubles(inertia, 9);
    put_status(tribo_mass_ellipsoid(density, axes, &mass, inertia));
    put_double(mass);
    put_doubles(inertia, 9);
}

static void run_mass(void)
{
    tribo_body body;
    double w[6], inertia[9];
    make_matrix(w, 4);
    const double full[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    memcpy(inertia, full, sizeof inertia);
    if (below(2)) {
        /* a tensor of a possible body: tr(A) 1 - A for a semidefinite A */
        for (int i = 0; i < 9; ++i) {
            inertia[i] = (i % 4 ? 0.0 : w[0] + w[3] + w[5]) - full[i];
        }
    }
    put_status(tribo_body_init(&body));
    put_status(tribo_body_set_mass(&body, below(8) ? 1 + fraction() : odd(2), inertia));
    put_body(&body);
}

static void run_flight(void)
{
    static const double gravity[3] = {0, 0, -9.81};
    static const double steps[] = {0, 0x1p-10, 1.0 / 148, 1.0 / 60, 0x1p-4};
    tribo_body body = make_body();
    tribo_body pushed = body;
    double arm[3], p[3], out[6] = {0};
    fill_odd(arm, 3, 2);
    fill_odd(p, 3, 3);
    put_status(tribo_body_check(&body));
    put_status(tribo_body_world_inverse_inertia(&body, out));
    put_doubles(out, 6);
    put_status(tribo_body_spin(&body, out));
    put_doubles(out, 3);
    tribo_body_point_velocity(&body, arm, out);
    put_doubles(out, 3);
    put_status(tribo_body_apply_impulse(&pushed, arm, p));
    put_body(&pushed);
    const double dt = below(32) ? steps[below((int)COUNT(steps))] : odd(2);
    put_status(tribo_body_advance(&body, below(4) ? gravity : NULL, dt));
    put_body(&body);
}

/* Errors of one step feed the next: nothing averages them out. */
static void run_long_flight(void)
{
    tribo_body body = make_body();
    for (int i = 0; i < 60; ++i) {
        put_status(tribo_body_advance(&body, NULL, 1.0 / 60));
    }
    put_body(&body);
}

static void run_body(void)
{
    for (int i = 0; i < 600; ++i) {
        run_solids();
        run_mass();
        run_flight();
    }
    for (int i = 0; i < 20; ++i) {
        run_long_flight();
    }
}

/* ---- material -------------------------------------------------------------------------------- */

static void put_material(const tribo_material *material)
{
    put_double(material->mu_s);
    put_double(material->mu_d);
    put_double(material->e);
}

static void mix_harmonic(const tribo_material *a, const tribo_material *b, void *user,
                         tribo_material *out)
{
    const double sum = a->mu_s + b->mu_s;
    (void)user;
    out->mu_s = sum > 0 ? 2 * a->mu_s * b->mu_s / sum : 0;
    out->mu_d = out->mu_s / 2;
    out->e = a->e * b->e;
}

static void run_table(void)
{
    tribo_material out = {0, 0, 0};
    const uint32_t count = tribo_material_count();
    put_u64(count);
    for (uint32_t i = 0; i <= count; ++i) {
        const char *name = NULL;
        put_status(tribo_material_at(i, &name, &out));
        put_string(name);
        put_material(&out);
        put_status(tribo_material_find(name ? name : "no such pair", &out));
        put_material(&out);
    }
}

static void run_material(void)
{
    run_table();
    for (int i = 0; i < 4000; ++i) {
        const tribo_material a = make_pair();
        const tribo_material b = make_pair();
        const uint32_t friction = (uint32_t)below(6);
        const uint32_t restitution = (uint32_t)below(6);
        tribo_material out = {0, 0, 0};
        put_status(tribo_material_check(&a));
        put_status(tribo_material_mix(&a, &b, friction, restitution, &out));
        put_material(&out);
        put_status(tribo_material_mix_with(&a, &b, mix_harmonic, NULL, &out));
        put_material(&out);
    }
}

/* ---- contact --------------------------------------------------------------------------------- */

static void put_impact_info(const tribo_impact_info *info)
{
    put_u64(info->mode);
    put_u64(info->iterations);
    put_doubles(info->velocity, 3);
    put_double(info->energy);
    put_double(info->kappa);
    put_double(info->compression);
}

static void put_collision_info(const tribo_collision_info *info)
{
    put_u64(info->mode);
    put_u64(info->iterations);
    put_doubles(info->frame, 9);
    put_doubles(info->matrix, 6);
    put_doubles(info->velocity_before, 3);
    put_doubles(info->velocity_after, 3);
    put_doubles(info->impulse, 3);
    put_doubles(info->impulse_world, 3);
    put_double(info->energy);
}

static void run_cone(int spread)
{
    double x[3], out[3] = {0};
    const double mu = below(8) ? 2 * fraction() : odd(spread);
    fill_odd(x, 3, spread);
    put_u64(tribo_cone_contains(x, mu, 0x1p-50));
    put_status(tribo_cone_project(x, mu, out));
    put_doubles(out, 3);
    put_u64(tribo_cone_contains(out, mu, 0x1p-50));
    put_status(tribo_cone_project_dual(x, mu, out));
    put_doubles(out, 3);
    put_status(tribo_cone_clamp(x, mu, out));
    put_doubles(out, 3);
}

static void run_solve(int spread)
{
    double w[6], b[3], general[9], p[3] = {0};
    tribo_solve_info info = {sizeof info, 0, 0, 0, 0};
    const tribo_material pair = make_pair();
    make_matrix(w, spread);
    fill_odd(b, 3, spread);
    b[0] = b[0] > 0 && below(4) ? -b[0] : b[0];
    put_status(tribo_contact_solve(w, b, pair.mu_s, pair.mu_d, p, &info));
    put_doubles(p, 3);
    put_u64(info.mode);
    put_u64(info.iterations);
    put_double(info.nu);
    const double full[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    for (int i = 0; i < 9; ++i) {
        general[i] = full[i] + (below(2) ? full[0] * either() / 4 : 0);
    }
    put_status(tribo_contact_solve_general(general, b, pair.mu_s, pair.mu_d, p, &info));
    put_doubles(p, 3);
    put_u64(info.mode);
    put_double(info.nu);
}

static void run_impact(int spread)
{
    double w[6], u[3], p[3] = {0};
    const tribo_material pair = make_pair();
    make_matrix(w, spread);
    fill_odd(u, 3, spread);
    u[0] = u[0] > 0 && below(8) ? -u[0] : u[0];
    for (uint32_t law = 0; law <= 8; ++law) {
        tribo_impact_options options = {sizeof options, law, 0};
        tribo_impact_info info;
        memset(&info, 0, sizeof info);
        info.struct_size = sizeof info;
        options.tangential_restitution = below(2) ? either() : 0;
        put_status(tribo_impact(w, u, &pair, &options, p, &info));
        put_doubles(p, 3);
        put_impact_info(&info);
    }
}

static void run_parts(tribo_body *a, tribo_body *b, const tribo_contact *contact)
{
    double frame[9] = {0}, w[6] = {0}, u[3] = {0}, p[3];
    fill(p, 3, 3);
    put_status(tribo_contact_check(contact));
    put_status(tribo_basis_from_normal(contact->normal, frame));
    put_status(tribo_contact_velocity(a, b, contact, frame, u));
    put_doubles(u, 3);
    put_status(tribo_contact_matrix(a, b, contact, frame, w));
    put_doubles(w, 6);
    put_status(tribo_contact_apply(a, b, contact, frame, p));
    put_body(a);
    put_body(b);
}

static void run_collision(void)
{
    tribo_body a = make_body();
    tribo_body b = make_body();
    const uint32_t world = below(4) == 0;
    const tribo_material pair = make_pair();
    const tribo_impact_options options = {sizeof options, (uint32_t)below(8), 0};
    tribo_collision_info info;
    tribo_contact contact;
    double point[3], normal[3];
    memset(&info, 0, sizeof info);
    memset(&contact, 0, sizeof contact);
    info.struct_size = sizeof info;
    for (int i = 0; i < 3; ++i) {
        point[i] = a.position[i] + either();
    }
    make_normal(normal);
    put_status(tribo_contact_at(&a, world ? NULL : &b, point, normal, &contact));
    put_doubles(contact.normal, 3);
    put_doubles(contact.arm_a, 3);
    put_doubles(contact.arm_b, 3);
    put_status(tribo_contact_resolve(&a, world ? NULL : &b, &contact, &pair, &options, &info));
    put_collision_info(&info);
    put_status(tribo_collide(&b, &a, point, normal, &pair, below(2) ? NULL : &options, &info));
    put_collision_info(&info);
    put_body(&a);
    put_body(&b);
    run_parts(&a, &b, &contact);
}

static void run_friction(void)
{
    double f[3], n[3], reaction[3] = {0}, planar[3] = {0}, force[3] = {0};
    uint32_t mode = 9;
    const tribo_material pair = make_pair();
    fill_odd(f, 3, 3);
    make_normal(n);
    put_status(tribo_friction_reaction(f, n, reaction));
    put_doubles(reaction, 3);
    put_status(tribo_friction_planar(f, n, planar));
    put_doubles(planar, 3);
    put_u64(tribo_friction_holds(planar, reaction, pair.mu_s));
    put_status(tribo_friction_force(f, n, &pair, force, &mode));
    put_doubles(force, 3);
    put_u64(mode);
}

static void run_contact(void)
{
    for (int i = 0; i < 4000; ++i) {
        const int spread = i % 8 ? 4 : 450;
        run_cone(i % 8 ? 4 : 1000);
        run_solve(spread);
        run_friction();
        if (i % 4 == 0) {
            run_impact(spread);
            run_collision();
        }
    }
}

/* ---- audit ----------------------------------------------------------------------------------- */

static void put_measures(const tribo_measures *m)
{
    put_double(m->eta);
    put_double(m->signorini);
    put_double(m->cone);
    put_double(m->misalignment);
    put_double(m->energy);
    put_double(m->velocity);
}

static void put_totals(const tribo_totals *t)
{
    put_doubles(t->linear, 3);
    put_doubles(t->angular, 3);
    put_double(t->energy);
    put_double(t->mass);
    put_double(t->linear_scale);
    put_double(t->angular_scale);
}

static void audit_bodies(void)
{
    tribo_body bodies[4];
    tribo_totals before, after;
    tribo_change change = {0, 0, 0};
    double origin[3];
    memset(&before, 0, sizeof before);
    memset(&after, 0, sizeof after);
    fill(origin, 3, 3);
    for (size_t i = 0; i < COUNT(bodies); ++i) {
        bodies[i] = make_body();
    }
    put_status(tribo_audit_bodies(COUNT(bodies), bodies, origin, &before));
    put_totals(&before);
    (void)tribo_body_advance(&bodies[0], NULL, 0x1p-6);
    put_status(tribo_audit_bodies(COUNT(bodies), bodies, origin, &after));
    put_totals(&after);
    put_status(tribo_audit_change(&before, &after, &change));
    put_double(change.linear);
    put_double(change.angular);
    put_double(change.energy);
}

enum { AUDITED = 5 };

static void audit_contacts(int spread)
{
    double w[6 * AUDITED], b[3 * AUDITED], p[3 * AUDITED] = {0}, mu[AUDITED];
    tribo_measures one, greatest, rms;
    memset(&one, 0, sizeof one);
    memset(&greatest, 0, sizeof greatest);
    memset(&rms, 0, sizeof rms);
    fill_odd(b, COUNT(b), spread);
    for (int i = 0; i < AUDITED; ++i) {
        const tribo_material pair = make_pair();
        make_matrix(w + 6 * i, spread);
        mu[i] = pair.mu_s;
        put_status(tribo_contact_solve(w + 6 * i, b + 3 * i, mu[i], mu[i], p + 3 * i, NULL));
        p[3 * i + i % 3] *= below(2) ? 1 + wide(50) * 0x1p-50 : 1;
        put_status(tribo_audit_contact(w + 6 * i, b + 3 * i, mu[i], p + 3 * i, &one));
        put_measures(&one);
        put_status(tribo_audit_impact(w + 6 * i, b + 3 * i, &pair, p + 3 * i, &one));
        put_measures(&one);
    }
    put_status(tribo_audit_contacts(AUDITED, w, b, mu, p, &greatest, &rms));
    put_measures(&greatest);
    put_measures(&rms);
}

static void run_audit(void)
{
    for (int i = 0; i < 800; ++i) {
        audit_bodies();
        audit_contacts(i % 8 ? 4 : 300);
    }
}

/* ---- batch ----------------------------------------------------------------------------------- */

enum { BODIES = 16, CONTACTS = 203 };

static void batch_matrix(uint32_t isa, size_t count)
{
    static tribo_body bodies[BODIES];
    static tribo_contact contacts[CONTACTS];
    static uint32_t pairs[2 * CONTACTS];
    static double frames[9 * CONTACTS], w[6 * CONTACTS];
    static tribo_status statuses[CONTACTS];
    for (size_t i = 0; i < BODIES; ++i) {
        bodies[i] = make_body();
    }
    for (size_t i = 0; i < count; ++i) {
        make_normal(contacts[i].normal);
        fill(contacts[i].arm_a, 3, 2);
        fill(contacts[i].arm_b, 3, 2);
        for (size_t k = 2 * i; k < 2 * i + 2; ++k) {
            pairs[k] = below(16) ? (uint32_t)below(BODIES + !below(8)) : TRIBO_WORLD;
        }
        if (below(32) == 0) {
            contacts[i].arm_a[0] = odd(3);
        }
    }
    put_status(tribo_batch_matrix(isa, BODIES, bodies, count, pairs, contacts,
                                  below(4) ? frames : NULL, w, statuses));
    put_doubles(frames, 9 * count);
    put_doubles(w, 6 * count);
    for (size_t i = 0; i < count; ++i) {
        put_status(statuses[i]);
    }
}

static void batch_impulses(uint32_t isa, size_t count, int spread)
{
    static double w[6 * CONTACTS], b[3 * CONTACTS], mu[2 * CONTACTS], p[3 * CONTACTS];
    static tribo_material pairs[CONTACTS];
    static uint32_t modes[CONTACTS];
    static tribo_status statuses[CONTACTS];
    fill_odd(b, 3 * count, spread);
    for (size_t i = 0; i < count; ++i) {
        make_matrix(w + 6 * i, spread);
        pairs[i] = make_pair();
        mu[2 * i] = pairs[i].mu_s;
        mu[2 * i + 1] = pairs[i].mu_d;
        b[3 * i] = b[3 * i] > 0 && below(4) ? -b[3 * i] : b[3 * i];
    }
    for (int solve = 0; solve < 2; ++solve) {
        put_status(solve ? tribo_batch_solve(isa, count, w, b, mu, p, modes, statuses)
                         : tribo_batch_impact(isa, count, w, b, pairs, p, modes, statuses));
        put_doubles(p, 3 * count);
        for (size_t i = 0; i < count; ++i) {
            put_status(statuses[i]);
            put_u64(modes[i]);
        }
    }
}

static uint32_t chosen_isa = TRIBO_ISA_BEST;

static void run_batch(void)
{
    for (uint32_t isa = 0; isa < 6; ++isa) {
        put_string(tribo_isa_name(isa));
    }
    put_u64(tribo_isa_available(TRIBO_ISA_SCALAR) && tribo_isa_available(TRIBO_ISA_BASELINE));
    for (size_t count = 0; count < 20; ++count) {
        batch_matrix(chosen_isa, count);
        batch_impulses(chosen_isa, count, 4);
    }
    for (int i = 0; i < 40; ++i) {
        batch_matrix(chosen_isa, CONTACTS);
        batch_impulses(chosen_isa, CONTACTS, i % 8 ? 4 : 450);
    }
}

/* ---- system ---------------------------------------------------------------------------------- */

/* The core alone: what SuiteSparse gives, which libtribo hands to Newton, is rounded as its BLAS
 * rounds. In its place stands a plain elimination, so that the sparse matrices are hashed, too. */

enum { MOST_BODIES = 1024, MOST_CONTACTS = 2048, MOST_UNKNOWNS = 128, MOST_BLOCKS = 64 * 64 };

static tribo_body scene_bodies[MOST_BODIES];
static tribo_system_contact scene_contacts[MOST_CONTACTS];
static size_t scene_body_count, scene_count;

static uint32_t add_body(const double half[3], const double position[3], double density)
{
    tribo_body *body = &scene_bodies[scene_body_count];
    double mass = 0, inertia[9] = {0};
    (void)tribo_mass_box(density, half, &mass, inertia);
    (void)tribo_body_init(body);
    (void)tribo_body_set_mass(body, mass, inertia);
    memcpy(body->position, position, sizeof body->position);
    body->velocity[2] = -9.81 * 0x1p-6;
    return (uint32_t)scene_body_count++;
}

static tribo_system_contact *add_contact(uint32_t a, uint32_t b, const double point[3],
                                         const double normal[3])
{
    tribo_system_contact *c = &scene_contacts[scene_count++];
    memset(c, 0, sizeof *c);
    c->a = a;
    c->b = b;
    c->dimension = 3;
    c->pair.mu_s = c->pair.mu_d = 0.5;
    memcpy(c->contact.normal, normal, sizeof c->contact.normal);
    for (int i = 0; i < 3; ++i) {
        c->contact.arm_a[i] = a == TRIBO_WORLD ? 0 : point[i] - scene_bodies[a].position[i];
        c->contact.arm_b[i] = b == TRIBO_WORLD ? 0 : point[i] - scene_bodies[b].position[i];
    }
    return c;
}

/* The four corners of a face that looks up. */
static void add_face(uint32_t a, uint32_t b, double x, double z, double half)
{
    static const double up[3] = {0, 0, 1};
    for (int i = 0; i < 4; ++i) {
        const double point[3] = {x + (i % 2 ? half : -half), i / 2 ? 0.5 : -0.5, z};
        (void)add_contact(a, b, point, up);
    }
}

static void clear_scene(void)
{
    scene_body_count = 0;
    scene_count = 0;
}

static void make_tower(uint32_t height)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    clear_scene();
    for (uint32_t i = 0; i < height; ++i) {
        const double centre[3] = {0, 0, 0.5 + i};
        const uint32_t own = add_body(half, centre, power(below(9)));
        add_face(own, i == 0 ? TRIBO_WORLD : own - 1, 0, i, 0.5);
    }
}

/* Bricks, each on halves of the two below. */
static void make_wall(uint32_t rows, uint32_t columns)
{
    static const double half[3] = {1, 0.5, 0.5};
    clear_scene();
    for (uint32_t row = 0; row < rows; ++row) {
        for (uint32_t i = 0; i < columns; ++i) {
            const double x = 2.0 * i + (row % 2);
            const double centre[3] = {x, 0, 0.5 + row};
            const uint32_t own = add_body(half, centre, 1);
            const uint32_t under = own - columns;
            if (row == 0) {
                add_face(own, TRIBO_WORLD, x, row, 1);
                continue;
            }
            add_face(own, under, row % 2 ? x - 0.5 : x + 0.5, row, 0.5);
            if (row % 2 ? i + 1 < columns : i > 0) {
                add_face(own, row % 2 ? under + 1 : under - 1, row % 2 ? x + 0.5 : x - 0.5, row,
                         0.5);
            }
        }
    }
}

/* Each body touches its neighbours in a plane: few colours, so many blocks in each that tasks share
 * them. */
static void make_net(uint32_t side)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    clear_scene();
    for (uint32_t i = 0; i < side * side; ++i) {
        const double centre[3] = {i % side, i / side, 0};
        const uint32_t own = add_body(half, centre, 1);
        fill(scene_bodies[own].velocity, 3, 1);
        for (uint32_t k = 0; k < 2; ++k) {
            const uint32_t other = k == 0 ? own - 1 : own - side;
            const double point[3] = {centre[0] - 0.5 * !k, centre[1] - 0.5 * k, 0};
            double normal[3] = {!k, k, 0};
            if (k == 0 ? i % side > 0 : i >= side) {
                (void)add_contact(own, other, point, normal);
            }
        }
    }
}

static int moves(uint32_t body)
{
    return body != TRIBO_WORLD && scene_bodies[body].inverse_mass > 0;
}

/* Any bodies, immovable and spoilt ones among them. */
static void make_heap(int bodies, int contacts)
{
    clear_scene();
    do {
        scene_bodies[0] = make_body();
    } while (!moves(0));
    for (scene_body_count = 1; scene_body_count < (size_t)bodies; ++scene_body_count) {
        scene_bodies[scene_body_count] = make_body();
    }
    while (scene_count < (size_t)contacts) {
        double point[3], normal[3];
        uint32_t ends[2];
        for (int i = 0; i < 2; ++i) {
            ends[i] = below(4) ? (uint32_t)below(bodies) : TRIBO_WORLD;
        }
        if ((ends[0] == ends[1] || !(moves(ends[0]) || moves(ends[1]))) && below(128)) {
            continue;
        }
        fill(point, 3, 2);
        make_normal(normal);
        tribo_system_contact *c = add_contact(ends[0], ends[1], point, normal);
        for (int i = 0; i < 3; ++i) {
            c->contact.arm_a[i] = wide(2);
            c->contact.arm_b[i] = wide(2);
        }
    }
}

/* Any of what a contact may have. */
static void season(int restitution)
{
    for (size_t i = 0; i < scene_count; ++i) {
        tribo_system_contact *c = &scene_contacts[i];
        c->dimension = below(4) ? 3 : 1;
        c->pair.mu_s = 2 * fraction();
        c->pair.mu_d = below(2) ? c->pair.mu_s : c->pair.mu_s * fraction();
        c->pair.e = restitution && below(2) ? fraction() : 0;
        if (below(4) == 0) {
            fill(c->target, 3, 2);
        }
    }
}

static void stir(void)
{
    for (size_t i = 0; i < scene_body_count; ++i) {
        fill(scene_bodies[i].velocity, 2, 3);
        fill(scene_bodies[i].angular_velocity, 3, 2);
    }
}

/* A user's factorisation: elimination with row exchanges. */
static double dense[MOST_UNKNOWNS][MOST_UNKNOWNS];
static uint32_t dense_rows, dense_pivots[MOST_UNKNOWNS];

static void scatter(uint32_t n, const uint32_t *row_starts, const uint32_t *columns,
                    const double *values, uint32_t symmetric)
{
    for (uint32_t i = 0; i < n; ++i) {
        memset(dense[i], 0, n * sizeof dense[i][0]);
    }
    for (uint32_t i = 0; i < n; ++i) {
        for (uint32_t k = row_starts[i]; k < row_starts[i + 1]; ++k) {
            put_u64(columns[k]);
            put_double(values[k]);
            dense[i][columns[k]] = values[k];
            if (symmetric) {
                dense[columns[k]][i] = values[k];
            }
        }
    }
}

static tribo_status dense_factor(void *context, uint32_t n, const uint32_t *row_starts,
                                 const uint32_t *columns, const double *values, uint32_t symmetric)
{
    (void)context;
    if (n > MOST_UNKNOWNS) {
        return TRIBO_ERROR_MEMORY;
    }
    scatter(n, row_starts, columns, values, symmetric);
    dense_rows = n;
    for (uint32_t k = 0; k < n; ++k) {
        uint32_t pivot = k;
        for (uint32_t i = k + 1; i < n; ++i) {
            pivot = dense[i][k] * dense[i][k] > dense[pivot][k] * dense[pivot][k] ? i : pivot;
        }
        dense_pivots[k] = pivot;
        for (uint32_t j = 0; j < n; ++j) {
            const double kept = dense[k][j];
            dense[k][j] = dense[pivot][j];
            dense[pivot][j] = kept;
        }
        if (dense[k][k] == 0) {
            return TRIBO_ERROR_CONTACT_MATRIX;
        }
        for (uint32_t i = k + 1; i < n; ++i) {
            const double l = dense[i][k] / dense[k][k];
            dense[i][k] = l;
            for (uint32_t j = k + 1; j < n && l != 0; ++j) {
                dense[i][j] -= l * dense[k][j];
            }
        }
    }
    return TRIBO_OK;
}

static tribo_status dense_solve(void *context, double *x)
{
    (void)context;
    for (uint32_t i = 0; i < dense_rows; ++i) {
        const double kept = x[i];
        x[i] = x[dense_pivots[i]];
        x[dense_pivots[i]] = kept;
    }
    for (uint32_t i = 0; i < dense_rows; ++i) {
        for (uint32_t j = 0; j < i; ++j) {
            x[i] -= dense[i][j] * x[j];
        }
    }
    for (uint32_t i = dense_rows; i-- > 0;) {
        for (uint32_t j = i + 1; j < dense_rows; ++j) {
            x[i] -= dense[i][j] * x[j];
        }
        x[i] /= dense[i][i];
    }
    return TRIBO_OK;
}

static uint32_t tasks_met;

static void backwards(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    (void)user;
    tasks_met = count > tasks_met ? count : tasks_met;
    for (uint32_t i = count; i > 0; --i) {
        task(data, i - 1);
    }
}

/* All but seconds, and bytes: pointers are among them. */
static void put_system_info(const tribo_system_info *info)
{
    put_u64(info->stop);
    put_u64(info->solver);
    put_u64(info->components);
    put_u64(info->sweeps);
    put_u64(info->steps);
    put_u64(info->factorizations);
    put_double(info->eta);
    put_double(info->eta_rms);
    put_double(info->signorini);
    put_double(info->cone);
    put_double(info->misalignment);
    put_double(info->invariant);
    put_double(info->siconos);
    put_double(info->energy);
    put_double(info->energy_scale);
    put_double(info->linear);
    put_double(info->angular);
    put_double(info->restitution);
}

/* Buffers of a solve; the start of a warm one is left from the solve before. */
static double *workspace;
static size_t workspace_bytes;
static double solved_impulses[3 * MOST_CONTACTS], solved_velocities[6 * MOST_BODIES];

static void reserve(size_t bytes)
{
    if (bytes > workspace_bytes) {
        free(workspace);
        workspace = malloc(bytes);
        workspace_bytes = bytes;
        if (!workspace) {
            fprintf(stderr, "no memory\n");
            exit(3);
        }
    }
}

static void solve_scene(const tribo_system_options *options)
{
    tribo_system_info info;
    size_t size = 0;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    put_status(
        tribo_system_workspace_size(scene_body_count, scene_count, scene_contacts, options, &size));
    reserve(size);
    put_status(tribo_system_solve(scene_body_count, scene_bodies, scene_count, scene_contacts,
                                  options, workspace, size, solved_impulses, solved_velocities,
                                  &info));
    put_doubles(solved_impulses, 3 * scene_count);
    if (options->torques) {
        put_doubles(options->torques, 3 * scene_count);
    }
    put_doubles(solved_velocities, 6 * scene_body_count);
    put_system_info(&info);
}

/* By every solver, with either way to factor, in one task and in three, and on from there. torques:
 * where they go, or null. */
static void solve_each_way(uint64_t most, double *torques)
{
    const tribo_linear linear = {sizeof linear, 0, NULL, dense_factor, dense_solve, NULL};
    tribo_system_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.isa = chosen_isa;
    options.parallel = backwards;
    options.torques = torques;
    for (uint32_t solver = 0; solver < 3; ++solver) {
        options.solver = solver;
        options.max_iterations = most;
        options.tasks = 1;
        options.warm_start = 0;
        options.measure = TRIBO_MEASURE_ETA;
        options.linear = NULL;
        solve_scene(&options);
        options.tasks = 3;
        options.warm_start = 1;
        options.measure = TRIBO_MEASURE_INVARIANT;
        options.tolerance = 1e-12;
        options.dense_limit = 1;
        options.linear = &linear;
        solve_scene(&options);
        options.dense_limit = 0;
    }
}

static void run_tower(uint32_t height, int kind)
{
    make_tower(height);
    if (kind > 0) {
        stir();
    }
    if (kind > 1) {
        season(kind > 2);
    }
    solve_each_way(40, NULL);
}

static void run_net(void)
{
    const uint64_t before = hash;
    uint64_t alone;
    tribo_system_options options;
    make_net(32);
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    options.isa = chosen_isa;
    options.max_iterations = 6;
    options.parallel = backwards;
    season(1);
    options.tasks = 1;
    solve_scene(&options);
    alone = hash;
    hash = before;
    options.tasks = 3;
    solve_scene(&options);
    if (hash != alone || (chosen_isa != TRIBO_ISA_SCALAR && tasks_met != 3)) {
        fprintf(stderr, "a system is solved otherwise in %u tasks than in one\n", tasks_met);
        exit(4);
    }
}

/* W = A A^T of integers, of what rank it comes; unsymmetric by a little where asked for. */
static double assembled[9 * MOST_BLOCKS], assembled_q[3 * 64], assembled_mu[2 * 64];
static uint32_t assembled_starts[65], assembled_columns[MOST_BLOCKS];

static double product_of(double a[][24], uint32_t i, uint32_t j, int rank)
{
    double sum = 0;
    for (int k = 0; k < rank; ++k) {
        sum += a[i][k] * a[j][k];
    }
    return sum;
}

static void make_rows(uint32_t count, int rank, double a[][24])
{
    for (uint32_t i = 0; i < 3 * count; ++i) {
        for (int k = 0; k < rank; ++k) {
            a[i][k] = below(4) ? 0 : below(1 << 12) - (1 << 11);
        }
        a[i][i % 3] += 1 << 10;
    }
}

/* Blocks beyond `reach` of the diagonal are left out of the sparse form. */
static void make_assembled(uint32_t count, uint32_t reach, int rank, int skew)
{
    static double a[3 * 64][24];
    uint32_t at = 0;
    make_rows(count, rank, a);
    for (uint32_t i = 0; i < count; ++i) {
        assembled_starts[i] = at;
        for (uint32_t j = 0; j < count; ++j) {
            if (j > i + reach || i > j + reach) {
                continue;
            }
            for (uint32_t k = 0; k < 9; ++k) {
                const double entry = product_of(a, 3 * i + k / 3, 3 * j + k % 3, rank);
                assembled[9 * at + k] = entry * 0x1p-20 + (skew && i != j ? wide(2) * 0x1p-6 : 0);
            }
            assembled_columns[at++] = j;
        }
        fill(assembled_q + 3 * i, 3, 2);
        assembled_mu[2 * i] = below(4) ? fraction() : 0;
        assembled_mu[2 * i + 1] = below(2) ? assembled_mu[2 * i] : assembled_mu[2 * i] / 2;
    }
    assembled_starts[count] = at;
}

static void solve_assembled(uint32_t count, int sparse, const tribo_system_options *options)
{
    const uint32_t *starts = sparse ? assembled_starts : NULL;
    const uint32_t *columns = sparse ? assembled_columns : NULL;
    tribo_system_info info;
    size_t size = 0;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    put_status(tribo_system_assembled_workspace_size(count, starts, columns, options, &size));
    reserve(size);
    put_status(tribo_system_solve_assembled(count, starts, columns, assembled, assembled_q,
                                            assembled_mu, options, workspace, size, solved_impulses,
                                            solved_velocities, &info));
    put_doubles(solved_impulses, 3 * (size_t)count);
    put_doubles(solved_velocities, 3 * (size_t)count);
    put_system_info(&info);
}

static void run_assembled(void)
{
    const tribo_linear linear = {sizeof linear, 0, NULL, dense_factor, dense_solve, NULL};
    tribo_system_options options;
    const uint32_t count = 1 + (uint32_t)below(20);
    const int dense_form = below(2);
    const uint32_t reach = dense_form ? count : (uint32_t)below(4);
    const int rank = 1 + below(24);
    make_assembled(count, reach, rank, below(2));
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.isa = chosen_isa;
    options.max_iterations = 40;
    for (uint32_t solver = 0; solver < 3; ++solver) {
        options.solver = solver;
        options.linear = below(2) ? NULL : &linear;
        options.dense_limit = options.linear ? 1 : 0;
        options.measure = (uint32_t)below(2);
        options.warm_start = solver == 2;
        /* one matrix is read in two ways: row by row, and block by block */
        solve_assembled(count, !dense_form, &options);
    }
}

static void run_system(void)
{
    for (int kind = 0; kind < 4; ++kind) {
        run_tower(5, kind);
        run_tower(9, kind);
    }
    for (int kind = 0; kind < 2; ++kind) {
        make_wall(4, 5);
        if (kind) {
            stir();
            season(1);
        }
        solve_each_way(12, NULL);
    }
    for (int i = 0; i < 40; ++i) {
        const int bodies = 1 + below(16);
        make_heap(bodies, 1 + below(24));
        season(i % 2);
        solve_each_way(40, NULL);
        put_status(tribo_system_apply(scene_body_count, scene_bodies, solved_velocities));
        put_body(&scene_bodies[0]);
    }
    run_net();
    for (int i = 0; i < 50; ++i) {
        run_assembled();
    }
}

/* Contacts that resist rolling and spinning. */
static void run_resistance(void)
{
    static double torques[3 * MOST_CONTACTS];
    for (int i = 0; i < 12; ++i) {
        const int bodies = 1 + below(16);
        make_heap(bodies, 1 + below(24));
        season(i % 2);
        for (size_t c = 0; c < scene_count; ++c) {
            scene_contacts[c].rolling = below(2) ? fraction() : 0;
            scene_contacts[c].spinning = below(2) ? fraction() : 0;
        }
        solve_each_way(30, torques);
    }
}

/* ---- the run --------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    void (*run)(void);
} rooms[] = {{"base", run_base},         {"math", run_math},       {"body", run_body},
             {"material", run_material}, {"contact", run_contact}, {"audit", run_audit},
             {"batch", run_batch},       {"system", run_system},   {"resist", run_resistance}};

static int choose_isa(const char *wanted)
{
    const char *name;
    for (uint32_t isa = 0; (name = tribo_isa_name(isa)) != NULL; ++isa) {
        if (strcmp(name, wanted) == 0) {
            chosen_isa = isa;
            return tribo_isa_available(isa) ? 0 : 77;
        }
    }
    fprintf(stderr, "TRIBO_ISA: there is no instruction set '%s'\n", wanted);
    return 2;
}

int main(void)
{
    const char *isa = getenv("TRIBO_ISA");
    const int refusal = isa && *isa ? choose_isa(isa) : 0;
    uint64_t all = UINT64_C(0xcbf29ce484222325);
    if (refusal) {
        return refusal;
    }
    for (size_t i = 0; i < COUNT(rooms); ++i) {
        hash = UINT64_C(0xcbf29ce484222325);
        generator = i;
        rooms[i].run();
        printf("%-8s %016" PRIx64 "\n", rooms[i].name, hash);
        const uint64_t room = hash;
        hash = all;
        put_u64(room);
        all = hash;
    }
    printf("%-8s %016" PRIx64 "\n", "all", all);
    return 0;
}
