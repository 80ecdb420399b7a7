/* Properties of include/tribo/system.h: certificates against quad precision, conservation, symmetry
 * to the bit, one contact as contact.h solves it, and whatever is wrong. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "quad_system.h"
#include "support/reference.h"
#include "systems.h"

enum { BODIES = 5, CONTACTS = 8, GUARD = 32 };

/* In units of the rounding of the sums that a measure is made of. */
#define UNITS 256.0

/* What a system may have. */
enum {
    PLAIN = 0,
    TARGETS = 1,
    RESTITUTION = 2,
    TWO_FRICTION = 4,
    SMOOTH = 8,
    NARROW = 16,
    RESISTANCE = 32
};

/* ---- systems from bytes --------------------------------------------------------------------- */

static void make_ends(property_trial *t, size_t bodies, uint32_t *a, uint32_t *b)
{
    *a = make_byte(t) % (uint32_t)bodies;
    *b = make_byte(t) % (uint32_t)(bodies + 1);
    if (*b == bodies || *b == *a) {
        *b = TRIBO_WORLD;
    }
    if (make_byte(t) % 2 == 1) {
        const uint32_t kept = *a;
        *a = *b;
        *b = kept;
    }
}

static void make_contact_of(property_trial *t, size_t bodies, uint32_t with,
                            tribo_system_contact *out)
{
    memset(out, 0, sizeof *out);
    make_ends(t, bodies, &out->a, &out->b);
    out->dimension = make_byte(t) % 4 == 1 ? 1 : 3;
    make_normal(t, "normal", out->contact.normal);
    make_vector(t, "arm_a", -2, 1, out->contact.arm_a);
    make_vector(t, "arm_b", -2, 1, out->contact.arm_b);
    make_material(t, "pair", &out->pair);
    out->pair.mu_s = fmin(out->pair.mu_s, 2.0);
    out->pair.mu_d = (with & TWO_FRICTION) ? fmin(out->pair.mu_d, out->pair.mu_s) : out->pair.mu_s;
    if (with & SMOOTH) {
        out->pair.mu_s = out->pair.mu_d = 0.0;
    }
    if (!(with & RESTITUTION)) {
        out->pair.e = 0.0;
    }
    if ((with & TARGETS) && make_byte(t) % 2 == 1) {
        make_vector(t, "target", -4, 0, out->target);
    }
    if (with & RESISTANCE) {
        const uint32_t which = make_byte(t) % 4;
        out->rolling = which % 2 == 1 ? make_positive(t, "rolling", -8, 1) : 0.0;
        out->spinning = which >= 2 ? make_positive(t, "spinning", -8, 1) : 0.0;
    }
}

/* Bodies that can all move; the caller frees it. */
static void make_system(property_trial *t, uint32_t with, systems_scene *out)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    double half[3];
    const size_t bodies = 1 + make_choice(t, "bodies", BODIES);
    const size_t contacts = 1 + make_choice(t, "contacts", CONTACTS);
    const uint32_t wide = make_choice(t, "wide", 4) == 1 && !(with & NARROW);
    memset(out, 0, sizeof *out);
    property_expand(t);
    for (size_t i = 0; i < bodies; i++) {
        const uint32_t index = systems_add_static(out, origin);
        make_body(t, "body", wide ? BODY_WIDE : BODY_PLAIN, &out->bodies[index], half);
    }
    for (size_t i = 0; i < contacts; i++) {
        static const double up[3] = {0.0, 0.0, 1.0};
        make_contact_of(t, bodies, with, systems_add_contact(out, 0, TRIBO_WORLD, origin, up, 0.0));
    }
}

static void make_options(property_trial *t, tribo_system_options *out)
{
    static const double tolerances[] = {0.0, 1e-6, 1e-3, 1e-12};
    memset(out, 0, sizeof *out);
    out->struct_size = sizeof *out;
    out->solver = make_choice(t, "solver", 3);
    out->tolerance = tolerances[make_choice(t, "tolerance", 4)];
    out->max_iterations = 1 + (uint64_t)make_byte(t) * 4;
}

/* ---- solving -------------------------------------------------------------------------------- */

/* Whether nothing was written from `from` on into an array that canary_set filled. */
static int untouched(const double *array, size_t from, size_t bytes)
{
    static double blank[6 * (2 * CONTACTS + GUARD)];
    canary_set(blank, bytes);
    return property_same(array + from, blank + from, bytes - from * sizeof *array);
}

typedef struct solution {
    tribo_status status;
    double impulses[3 * (2 * CONTACTS + GUARD)];
    double torques[3 * (2 * CONTACTS + GUARD)];
    double velocities[6 * (2 * BODIES + GUARD)];
    tribo_system_info info;
    int kept; /* nothing was written behind the workspace */
} solution;

/* start (may be null): a warm start. */
static void solve(const systems_scene *s, const tribo_system_options *given, const solution *start,
                  solution *out)
{
    tribo_system_options told = *given;
    const tribo_system_options *options = &told;
    size_t size = 0;
    if (told.struct_size == sizeof told) {
        told.torques = out->torques;
    }
    canary_set(out->impulses, sizeof out->impulses);
    canary_set(out->torques, sizeof out->torques);
    canary_set(out->velocities, sizeof out->velocities);
    memset(&out->info, 0, sizeof out->info);
    out->info.struct_size = sizeof out->info;
    out->kept = 1;
    if (start != NULL) {
        memcpy(out->impulses, start->impulses, 3 * s->count * sizeof(double));
        memcpy(out->torques, start->torques, 3 * s->count * sizeof(double));
    }
    out->status = tribo_system_workspace_size(s->body_count, s->count, s->contacts, options, &size);
    if (out->status != TRIBO_OK) {
        return;
    }
    unsigned char *workspace = malloc(size + GUARD);
    if (workspace == NULL) {
        abort();
    }
    canary_set(workspace + size, GUARD);
    out->status = tribo_system_solve(s->body_count, s->bodies, s->count, s->contacts, options,
                                     workspace, size, out->impulses, out->velocities, &out->info);
    out->kept = canary_kept(workspace + size, GUARD);
    free(workspace);
}

static int same_results(const solution *a, const solution *b)
{
    return a->status == b->status && property_same(a->impulses, b->impulses, sizeof a->impulses) &&
           property_same(a->torques, b->torques, sizeof a->torques) &&
           property_same(a->velocities, b->velocities, sizeof a->velocities) &&
           property_same(&a->info.eta, &b->info.eta, sizeof a->info.eta) &&
           a->info.stop == b->info.stop && a->info.sweeps == b->info.sweeps &&
           a->info.steps == b->info.steps;
}

/* ---- certificates --------------------------------------------------------------------------- */

static void evaluate(const systems_scene *s, const solution *got, quad_certificate *truth)
{
    quad_certificate_with_torques(s->body_count, s->bodies, s->count, s->contacts, got->impulses,
                                  got->torques, got->velocities, truth);
}

/* What holds for every solve, converged or not. */
static void judge(property_trial *t, const systems_scene *s, const tribo_system_options *options,
                  const solution *got, quad_certificate *truth)
{
    const double tolerance = options->tolerance > 0.0 ? options->tolerance : 1e-10;
    int restitution = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double *r = got->impulses + 3 * i;
        const double *torque = got->torques + 3 * i;
        const int full = s->contacts[i].dimension == 3;
        const double rolling = full ? s->contacts[i].rolling * r[0] : 0.0;
        const double spinning = full ? s->contacts[i].spinning * r[0] : 0.0;
        REQUIRE(t, fabs(torque[0]) <= spinning * (1.0 + 16.0 * EPS));
        REQUIRE(t, hypot(torque[1], torque[2]) <= rolling * (1.0 + 16.0 * EPS));
        const double mu = s->contacts[i].dimension == 1 ? 0.0 : s->contacts[i].pair.mu_s;
        REQUIRE(t, isfinite(r[0]) && isfinite(r[1]) && isfinite(r[2]));
        REQUIRE(t, r[0] >= 0.0 && tribo_cone_contains(r, mu, 16.0 * EPS));
        restitution = restitution || s->contacts[i].pair.e > 0.0;
    }
    REQUIRE(t, got->kept);
    REQUIRE(t, untouched(got->impulses, 3 * s->count, sizeof got->impulses));
    REQUIRE(t, untouched(got->torques, 3 * s->count, sizeof got->torques));
    REQUIRE(t, untouched(got->velocities, 6 * s->body_count, sizeof got->velocities));
    evaluate(s, got, truth);
    REQUIRE_AT_MOST(t, truth->velocity, UNITS * EPS);
    REQUIRE_AT_MOST(t, truth->linear, UNITS * truth->linear_noise);
    REQUIRE_AT_MOST(t, truth->angular, truth->gap + UNITS * truth->angular_noise);
    if (!restitution) {
        REQUIRE_AT_MOST(t, quad_certificate_difference(truth, &got->info, NULL), UNITS);
        if (got->info.stop == TRIBO_STOP_TOLERANCE) {
            REQUIRE_AT_MOST(t, truth->eta, tolerance + UNITS * truth->contact_noise);
        }
    }
}

static void judge_certificate(property_trial *t, uint32_t also)
{
    tribo_system_options options;
    quad_certificate truth;
    systems_scene s;
    static solution got;
    const uint32_t with = (make_choice(t, "with", 8) & (TARGETS | TWO_FRICTION)) | also;
    make_options(t, &options);
    make_system(t, with, &s);
    solve(&s, &options, NULL, &got);
    if (got.status == TRIBO_OK) {
        judge(t, &s, &options, &got, &truth);
    } else {
        property_fail_status(t, "tribo_system_solve", __FILE__, __LINE__, got.status, TRIBO_OK);
    }
    systems_free(&s);
}

static void certificate_is_true(property_trial *t)
{
    judge_certificate(t, PLAIN);
}

static void certificate_of_torques_is_true(property_trial *t)
{
    judge_certificate(t, RESISTANCE);
}

/* Without targets and restitution a solution loses energy, to what the tolerance leaves. */
static void judge_energy(property_trial *t, uint32_t also)
{
    tribo_system_options options;
    quad_certificate truth;
    systems_scene s;
    static solution got;
    make_options(t, &options);
    make_system(t, make_choice(t, "two", 2) * TWO_FRICTION | also, &s);
    solve(&s, &options, NULL, &got);
    const int solved = got.status == TRIBO_OK && got.info.stop == TRIBO_STOP_TOLERANCE;
    if (solved) {
        evaluate(&s, &got, &truth);
    }
    systems_free(&s);
    ASSUME(t, solved);
    const double tolerance = options.tolerance > 0.0 ? options.tolerance : 1e-10;
    REQUIRE_AT_MOST(t, truth.energy,
                    UNITS * truth.energy_noise + 100.0 * tolerance * truth.energy_scale);
    REQUIRE_NEAR(t, truth.kinetic, truth.energy,
                 UNITS * (truth.kinetic_noise + truth.energy_noise));
}

static void energy_never_grows(property_trial *t)
{
    judge_energy(t, PLAIN);
}

static void torques_take_energy(property_trial *t)
{
    judge_energy(t, RESISTANCE);
}

/* Restitution never adds energy, however many contacts there are, and parts one alone with -e
 * u_n. */
static void judge_restitution(property_trial *t, uint32_t also)
{
    tribo_system_options options = {.struct_size = sizeof options};
    quad_certificate truth;
    systems_scene s;
    static solution got;
    make_system(t, RESTITUTION | make_choice(t, "smooth", 2) * SMOOTH | also, &s);
    options.max_iterations = 1000;
    solve(&s, &options, NULL, &got);
    const int good = got.status == TRIBO_OK;
    if (good) {
        evaluate(&s, &got, &truth);
    }
    const double e = s.contacts[0].pair.e;
    const int alone = s.count == 1 && s.contacts[0].dimension == 1;
    double frame[9];
    double u[2][3];
    const tribo_body world = {.orientation = {1, 0, 0, 0}};
    for (size_t i = 0; i < 2 && good && alone; i++) {
        const uint32_t ends[2] = {s.contacts[0].a, s.contacts[0].b};
        tribo_basis_from_normal(s.contacts[0].contact.normal, frame);
        tribo_contact_velocity(ends[0] == TRIBO_WORLD ? &world : &s.bodies[ends[0]],
                               ends[1] == TRIBO_WORLD ? &world : &s.bodies[ends[1]],
                               &s.contacts[0].contact, frame, u[i]);
        tribo_system_apply(s.body_count, s.bodies, got.velocities);
    }
    systems_free(&s);
    REQUIRE(t, good);
    REQUIRE(t, got.info.restitution >= 0.0 && got.info.restitution <= 1.0);
    REQUIRE_NEAR(t, got.info.energy, truth.energy, UNITS * truth.energy_noise);
    if (got.info.stop == TRIBO_STOP_TOLERANCE) {
        REQUIRE_AT_MOST(t, truth.kinetic, UNITS * truth.kinetic_noise + 1e-8 * truth.energy_scale);
    }
    if (alone && u[0][0] < 0.0) {
        REQUIRE_NEAR(t, u[1][0], -e * u[0][0], 1e-8 * norm3(u[0]) + 64.0 * EPS * norm3(u[1]));
    }
}

static void restitution_never_adds_energy(property_trial *t)
{
    judge_restitution(t, PLAIN);
}

static void restitution_beside_torques(property_trial *t)
{
    judge_restitution(t, RESISTANCE);
}

/* ---- symmetry ------------------------------------------------------------------------------- */

static void backwards(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    (void)user;
    for (uint32_t i = count; i > 0; i--) {
        task(data, i - 1);
    }
}

static void run_in_all_ways(property_trial *t, uint32_t also)
{
    tribo_system_options options;
    systems_scene s;
    static solution want;
    static solution got;
    int same = 1;
    const uint32_t with = make_choice(t, "with", 8) | also;
    make_options(t, &options);
    make_system(t, with, &s);
    solve(&s, &options, NULL, &want);
    for (uint32_t isa = 0; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        options.isa = isa;
        options.tasks = isa;
        options.parallel = isa % 2 == 0 ? backwards : NULL;
        if (tribo_isa_available(isa)) {
            solve(&s, &options, NULL, &got);
            same = same && same_results(&got, &want);
        }
    }
    systems_free(&s);
    REQUIRE_STATUS(t, want.status, TRIBO_OK);
    REQUIRE(t, same);
}

static void same_bits_however_run(property_trial *t)
{
    run_in_all_ways(t, PLAIN);
}

static void same_torques_however_run(property_trial *t)
{
    run_in_all_ways(t, RESISTANCE);
}

/* Make `got` comparable with `want`. Normals may have numbers of any size: what comes near to the
 * least double loses bits, and counts as 0. */
static void compare_scaled(double *got, double *want, int exponent)
{
    *got = ldexp(*got, exponent);
    *got = fabs(*got) > 0x1p-900 ? *got : 0.0;
    *want = fabs(*want) > 0x1p-900 ? *want : 0.0;
}

static void scale_by_powers(property_trial *t, uint32_t also)
{
    tribo_system_options options;
    systems_scene s;
    systems_scene other;
    static solution want;
    static solution got;
    const uint32_t with = make_choice(t, "with", 8) | also;
    const int length = make_exponent(t, -40, 40);
    const int mass = make_exponent(t, -40, 40);
    const int time = make_exponent(t, -40, 40);
    make_options(t, &options);
    make_system(t, with, &s);
    systems_copy(&s, &other);
    systems_scale(&other, length, mass, time);
    solve(&s, &options, NULL, &want);
    solve(&other, &options, NULL, &got);
    for (size_t i = 0; i < 3 * s.count; i++) {
        compare_scaled(&got.impulses[i], &want.impulses[i], time - length - mass);
        compare_scaled(&got.torques[i], &want.torques[i], time - 2 * length - mass);
    }
    for (size_t i = 0; i < 6 * s.body_count; i++) {
        compare_scaled(&got.velocities[i], &want.velocities[i], i % 6 < 3 ? time - length : time);
    }
    systems_free(&s);
    systems_free(&other);
    REQUIRE_STATUS(t, want.status, TRIBO_OK);
    REQUIRE(t, same_results(&got, &want));
}

static void powers_of_two(property_trial *t)
{
    scale_by_powers(t, PLAIN);
}

static void torques_scale(property_trial *t)
{
    scale_by_powers(t, RESISTANCE);
}

/* Frictionless systems have one velocity each: in any order, and with contacts met twice. */
static void order_and_repetition(property_trial *t)
{
    const tribo_system_options options = {
        .struct_size = sizeof options, .measure = TRIBO_MEASURE_INVARIANT, .tolerance = 1e-10};
    systems_scene s;
    systems_scene other;
    static solution want;
    static solution got;
    const uint64_t seed = make_bits(t, 2);
    const int again = make_choice(t, "again", 2) == 1;
    make_system(t, SMOOTH | NARROW, &s);
    systems_copy(&s, &other);
    for (size_t i = 0; i < s.count && again; i += 2) {
        static const double up[3] = {0.0, 0.0, 1.0};
        *systems_add_contact(&other, 0, TRIBO_WORLD, up, up, 0.0) = s.contacts[i];
    }
    systems_permute(&other, seed, NULL);
    solve(&s, &options, NULL, &want);
    solve(&other, &options, NULL, &got);
    double scale = 0.0;
    double off = 0.0;
    for (size_t i = 0; i < 6 * s.body_count; i++) {
        /* in the metric of kinetic energy, whose square the tolerance bounds */
        const double m = i % 6 < 3 ? 1.0 / s.bodies[i / 6].inverse_mass : 0.0;
        off +=
            m * (got.velocities[i] - want.velocities[i]) * (got.velocities[i] - want.velocities[i]);
        scale += m * want.velocities[i] * want.velocities[i];
        scale +=
            i % 6 < 3 ? m * s.bodies[i / 6].velocity[i % 6] * s.bodies[i / 6].velocity[i % 6] : 0.0;
    }
    systems_free(&s);
    systems_free(&other);
    ASSUME(t, want.info.stop == TRIBO_STOP_TOLERANCE && got.info.stop == TRIBO_STOP_TOLERANCE);
    REQUIRE_AT_MOST(t, sqrt(off), 1e-3 * sqrt(scale + want.info.energy_scale));
}

static void islands_stay_apart(property_trial *t)
{
    tribo_system_options options;
    systems_scene s[2];
    systems_scene both;
    static solution alone[2];
    static solution got;
    const uint32_t with = make_choice(t, "with", 8);
    make_options(t, &options);
    make_system(t, with, &s[0]);
    make_system(t, with, &s[1]);
    systems_copy(&s[0], &both);
    systems_append(&both, &s[1]);
    solve(&s[0], &options, NULL, &alone[0]);
    solve(&s[1], &options, NULL, &alone[1]);
    solve(&both, &options, NULL, &got);
    const size_t n = 3 * s[0].count;
    const size_t m = 6 * s[0].body_count;
    const int same =
        property_same(got.impulses, alone[0].impulses, n * sizeof(double)) &&
        property_same(got.impulses + n, alone[1].impulses, 3 * s[1].count * sizeof(double)) &&
        property_same(got.velocities, alone[0].velocities, m * sizeof(double)) &&
        property_same(got.velocities + m, alone[1].velocities,
                      6 * s[1].body_count * sizeof(double));
    systems_free(&s[0]);
    systems_free(&s[1]);
    systems_free(&both);
    REQUIRE_STATUS(t, got.status, TRIBO_OK);
    REQUIRE(t, same);
}

static void start_warm(property_trial *t, uint32_t also)
{
    tribo_system_options options;
    systems_scene s;
    static solution cold;
    static solution warm;
    make_options(t, &options);
    make_system(t, make_choice(t, "two", 2) * TWO_FRICTION | also, &s);
    options.measure = TRIBO_MEASURE_INVARIANT;
    options.max_iterations = 2000;
    solve(&s, &options, NULL, &cold);
    options.warm_start = 1;
    solve(&s, &options, &cold, &warm);
    const int same = property_same(warm.impulses, cold.impulses, 3 * s.count * sizeof(double));
    systems_free(&s);
    REQUIRE_STATUS(t, warm.status, TRIBO_OK);
    REQUIRE_AT_MOST(t, warm.info.invariant, cold.info.invariant);
    ASSUME(t, cold.info.stop == TRIBO_STOP_TOLERANCE);
    REQUIRE(t, warm.info.stop == TRIBO_STOP_TOLERANCE);
    REQUIRE(t, warm.info.sweeps + warm.info.steps <= 1);
    REQUIRE(t, same || warm.info.sweeps + warm.info.steps == 1);
}

static void solutions_start_warm(property_trial *t)
{
    start_warm(t, PLAIN);
}

static void torques_start_warm(property_trial *t)
{
    start_warm(t, RESISTANCE);
}

/* ---- one contact ---------------------------------------------------------------------------- */

static void one_contact(property_trial *t)
{
    tribo_system_options options;
    scene s;
    tribo_body bodies[2];
    tribo_system_contact contact;
    systems_scene one;
    static solution got;
    double frame[9];
    double w[6];
    double u[3];
    double p[3];
    make_options(t, &options);
    make_scene(t, BODY_WIDE, &s);
    memset(&contact, 0, sizeof contact);
    make_material(t, "pair", &contact.pair);
    contact.pair.e = 0.0;
    contact.dimension = 3;
    contact.contact = s.contact;
    contact.b = s.has_b ? 1 : TRIBO_WORLD;
    bodies[0] = s.a;
    bodies[1] = s.b;
    memset(&one, 0, sizeof one);
    one.bodies = bodies;
    one.body_count = s.has_b ? 2 : 1;
    one.contacts = &contact;
    one.count = 1;
    tribo_basis_from_normal(s.contact.normal, frame);
    const tribo_body *b = s.has_b ? &s.b : NULL;
    ASSUME(t, tribo_contact_matrix(&s.a, b, &s.contact, frame, w) == TRIBO_OK);
    REQUIRE_STATUS(t, tribo_contact_velocity(&s.a, b, &s.contact, frame, u), TRIBO_OK);
    ASSUME(t, tribo_contact_solve(w, u, contact.pair.mu_s, contact.pair.mu_d, p, NULL) == TRIBO_OK);
    options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    options.tolerance = 0.0;
    solve(&one, &options, NULL, &got);
    REQUIRE_STATUS(t, got.status, TRIBO_OK);
    const double condition = reference_condition(w);
    const double scale = norm3(p);
    /* q is summed in another order than tribo_contact_velocity does it */
    ASSUME(t, reference_unique(w, contact.pair.mu_s) && contact.pair.mu_s == contact.pair.mu_d);
    double noise = norm3(s.a.velocity) + norm3(s.a.angular_velocity) * norm3(s.contact.arm_a);
    if (s.has_b) {
        noise += norm3(s.b.velocity) + norm3(s.b.angular_velocity) * norm3(s.contact.arm_b);
    }
    double values[3];
    reference_eigenvalues(w, values);
    REQUIRE_AT_MOST(t, distance3(got.impulses, p),
                    1e-12 * condition * scale + 1e-9 * scale + UNITS * EPS * noise / values[0]);
}

/* ---- assembled ------------------------------------------------------------------------------ */

typedef struct assembled {
    double blocks[9 * CONTACTS * CONTACTS];
    double q[3 * CONTACTS];
    double mu[2 * CONTACTS];
    uint32_t row_starts[CONTACTS + 1];
    uint32_t columns[CONTACTS * CONTACTS];
    double impulses[3 * CONTACTS + GUARD];
    double velocities[3 * CONTACTS + GUARD];
    tribo_system_info info;
} assembled;

static tribo_status solve_assembled(size_t count, const tribo_system_options *options, assembled *a)
{
    size_t size = 0;
    canary_set(a->impulses, sizeof a->impulses);
    canary_set(a->velocities, sizeof a->velocities);
    memset(&a->info, 0, sizeof a->info);
    a->info.struct_size = sizeof a->info;
    tribo_status status =
        tribo_system_assembled_workspace_size(count, a->row_starts, a->columns, options, &size);
    if (status != TRIBO_OK) {
        return status;
    }
    void *workspace = malloc(size + 1);
    if (workspace == NULL) {
        abort();
    }
    status = tribo_system_solve_assembled(count, a->row_starts, a->columns, a->blocks, a->q, a->mu,
                                          options, workspace, size, a->impulses, a->velocities,
                                          &a->info);
    free(workspace);
    return status;
}

/* The blocks of bodies, in part with gyroscopic terms on them. */
static void assembled_certificate(property_trial *t)
{
    tribo_system_options options;
    systems_blocks blocks;
    systems_scene s;
    quad_certificate truth;
    static assembled a;
    const uint32_t with = make_choice(t, "with", 8) & (TARGETS | TWO_FRICTION);
    const uint32_t skew = make_choice(t, "skew", 3);
    make_options(t, &options);
    make_system(t, with, &s);
    systems_assemble(&s, &blocks);
    const size_t n = s.count;
    const size_t links = blocks.row_starts[n];
    memset(&a, 0, sizeof a);
    memcpy(a.row_starts, blocks.row_starts, (n + 1) * sizeof a.row_starts[0]);
    memcpy(a.columns, blocks.columns, links * sizeof a.columns[0]);
    memcpy(a.blocks, blocks.blocks, 9 * links * sizeof a.blocks[0]);
    memcpy(a.q, blocks.q, 3 * n * sizeof a.q[0]);
    memcpy(a.mu, blocks.mu, 2 * n * sizeof a.mu[0]);
    systems_free_blocks(&blocks);
    systems_free(&s);
    for (size_t i = 0; i < 9 * links && skew > 0; i++) {
        a.blocks[i] *= 1.0 + (skew == 1 ? 1e-5 : 1e-3) * make_signed(t, NULL);
    }
    const tribo_status status = solve_assembled(n, &options, &a);
    if (skew > 0 && status == TRIBO_ERROR_CONTACT_MATRIX) {
        t->skipped = 1;
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    quad_certificate_of_blocks(n, a.row_starts, a.columns, a.blocks, a.q, a.mu, a.impulses,
                               a.velocities, &truth);
    REQUIRE_AT_MOST(t, truth.velocity, UNITS * EPS);
    REQUIRE_AT_MOST(t, quad_certificate_difference(&truth, &a.info, NULL), UNITS);
    for (size_t i = 0; i < n; i++) {
        REQUIRE(t, tribo_cone_contains(a.impulses + 3 * i, a.mu[2 * i], 16.0 * EPS));
    }
    REQUIRE(t, untouched(a.impulses, 3 * n, sizeof a.impulses));
    REQUIRE(t, untouched(a.velocities, 3 * n, sizeof a.velocities));
}

/* Any numbers at all in any pattern: a status, or impulses in the cone. */
static void assembled_wild(property_trial *t)
{
    tribo_system_options options;
    static assembled a;
    memset(&a, 0, sizeof a);
    const size_t n = make_choice(t, "count", CONTACTS);
    const uint32_t pattern = make_choice(t, "pattern", 2);
    make_options(t, &options);
    property_expand(t);
    size_t links = 0;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < n; k++) {
            if (i == k || make_byte(t) % 2 == 1) {
                a.columns[links++] = (uint32_t)k;
            }
        }
        a.row_starts[i + 1] = (uint32_t)links;
    }
    if (pattern == 1 && links > 0) {
        a.columns[make_byte(t) % links] = make_byte(t) % 16;
        a.row_starts[make_byte(t) % n] = make_byte(t) % (uint32_t)(links + 1);
    }
    for (size_t i = 0; i < 9 * links; i++) {
        const uint8_t kind = make_byte(t);
        a.blocks[i] = kind < 8 ? make_any(t, NULL) : make_real(t, NULL, -4, 4);
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t k = a.row_starts[i]; k < a.row_starts[i + 1] && k < CONTACTS * CONTACTS; k++) {
            if (a.columns[k] == i && make_byte(t) % 16 != 1) {
                a.blocks[9 * k] = fabs(a.blocks[9 * k]) + 32.0;
                a.blocks[9 * k + 4] = fabs(a.blocks[9 * k + 4]) + 32.0;
                a.blocks[9 * k + 8] = fabs(a.blocks[9 * k + 8]) + 32.0;
            }
        }
        a.q[3 * i] = make_byte(t) < 4 ? make_any(t, NULL) : make_real(t, NULL, -4, 4);
        a.q[3 * i + 1] = make_real(t, NULL, -4, 4);
        a.q[3 * i + 2] = make_real(t, NULL, -4, 4);
        a.mu[2 * i] = make_byte(t) < 4 ? make_any(t, NULL) : make_unit(t, NULL);
        a.mu[2 * i + 1] = a.mu[2 * i];
    }
    options.max_iterations = 1 + options.max_iterations % 64;
    const tribo_status status = solve_assembled(n, &options, &a);
    if (status != TRIBO_OK) {
        REQUIRE(t, canary_kept(a.impulses, sizeof a.impulses));
        REQUIRE(t, canary_kept(a.velocities, sizeof a.velocities));
        return;
    }
    for (size_t i = 0; i < n; i++) {
        REQUIRE(t, tribo_cone_contains(a.impulses + 3 * i, a.mu[2 * i], 16.0 * EPS));
        REQUIRE(t, isfinite(a.velocities[3 * i]));
    }
}

/* ---- what is wrong -------------------------------------------------------------------------- */

/* Any bodies and contacts: refused if one of their parts is, and outputs untouched then. */
static void bodies_wild(property_trial *t)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    tribo_system_options options;
    systems_scene s;
    static solution got;
    static solution blank;
    const size_t bodies = make_choice(t, "bodies", BODIES);
    const size_t contacts = make_choice(t, "contacts", CONTACTS);
    make_options(t, &options);
    memset(&s, 0, sizeof s);
    property_expand(t);
    int good = 1;
    for (size_t i = 0; i < bodies; i++) {
        const uint32_t index = systems_add_static(&s, origin);
        if (make_byte(t) % 4 == 1) {
            make_body_wild(t, "body", &s.bodies[index]);
        } else {
            double half[3];
            make_body(t, "body", BODY_ANY, &s.bodies[index], half);
        }
        good = good && tribo_body_check(&s.bodies[index]) == TRIBO_OK;
    }
    for (size_t i = 0; i < contacts; i++) {
        static const double up[3] = {0.0, 0.0, 1.0};
        tribo_system_contact *c = systems_add_contact(&s, TRIBO_WORLD, TRIBO_WORLD, up, up, 0.0);
        make_contact_of(t, bodies + 1, TARGETS | RESTITUTION | TWO_FRICTION, c);
        const uint8_t fault = make_byte(t);
        if (fault < 16) {
            ((double *)&c->contact)[fault % 9] = make_any(t, NULL);
        } else if (fault < 32) {
            ((double *)&c->pair)[fault % 3] = make_any(t, NULL);
        } else if (fault < 48) {
            c->target[fault % 3] = make_any(t, NULL);
        } else if (fault < 64) {
            c->dimension = fault % 5;
        } else if (fault < 72) {
            c->a = (uint32_t)make_bits(t, 4);
        } else if (fault < 88) {
            *(fault % 2 == 0 ? &c->rolling : &c->spinning) = make_any(t, NULL);
        }
        good = good && tribo_contact_check(&c->contact) == TRIBO_OK &&
               tribo_material_check(&c->pair) == TRIBO_OK && isfinite(c->target[0]) &&
               isfinite(c->target[1]) && isfinite(c->target[2]) && c->a != c->b &&
               isfinite(c->rolling) && isfinite(c->spinning) && c->rolling >= 0.0 &&
               c->spinning >= 0.0 && (c->a < bodies || c->a == TRIBO_WORLD) &&
               (c->b < bodies || c->b == TRIBO_WORLD) && (c->dimension == 1 || c->dimension == 3);
    }
    options.max_iterations = 1 + options.max_iterations % 64;
    solve(&s, &options, NULL, &got);
    blank = got;
    canary_set(blank.impulses, sizeof blank.impulses);
    canary_set(blank.torques, sizeof blank.torques);
    canary_set(blank.velocities, sizeof blank.velocities);
    const size_t n = s.count;
    const size_t m = s.body_count;
    systems_free(&s);
    REQUIRE(t, good || got.status != TRIBO_OK);
    REQUIRE(t, got.kept);
    if (got.status != TRIBO_OK) {
        REQUIRE_SAME(t, &got, &blank, sizeof got);
        return;
    }
    for (size_t i = 0; i < 3 * n; i++) {
        REQUIRE(t, isfinite(got.impulses[i]) && isfinite(got.torques[i]));
    }
    for (size_t i = 0; i < 6 * m; i++) {
        REQUIRE(t, isfinite(got.velocities[i]));
    }
}

static void bad_calls(property_trial *t)
{
    tribo_system_options options;
    systems_scene s;
    static solution got;
    size_t size = 0;
    tribo_status want = TRIBO_ERROR_OPTION;
    make_options(t, &options);
    const uint32_t kind = make_choice(t, "kind", 7);
    make_system(t, PLAIN, &s);
    tribo_system_workspace_size(s.body_count, s.count, s.contacts, NULL, &size);
    if (kind == 0) {
        options.solver = 3 + (uint32_t)make_bits(t, 3);
    } else if (kind == 1) {
        options.measure = 2 + (uint32_t)make_bits(t, 3);
    } else if (kind == 2) {
        options.warm_start = 2 + (uint32_t)make_bits(t, 3);
    } else if (kind == 3) {
        options.tolerance = -make_positive(t, "tolerance", -1000, 1000);
    } else if (kind == 4) {
        options.reserved = 1 + (uint32_t)make_bits(t, 3);
    } else if (kind == 5) {
        const uint32_t bytes = (uint32_t)make_bits(t, 2);
        options.struct_size = bytes <= sizeof options && bytes % 4 == 0 ? 0 : bytes;
        want = TRIBO_ERROR_STRUCT_SIZE;
    } else {
        options.isa = 5 + (uint32_t)make_bits(t, 3);
    }
    solve(&s, &options, NULL, &got);
    size_t other = 77;
    const tribo_status status =
        tribo_system_workspace_size(s.body_count, s.count, s.contacts, &options, &other);
    void *workspace = malloc(size + 1);
    if (workspace == NULL) {
        abort();
    }
    const tribo_status solved =
        tribo_system_solve(s.body_count, s.bodies, s.count, s.contacts, &options, workspace, size,
                           got.impulses, got.velocities, &got.info);
    const tribo_status none = tribo_system_solve(s.body_count, s.bodies, s.count, s.contacts, NULL,
                                                 workspace, size, NULL, NULL, NULL);
    const tribo_status small = tribo_system_solve(s.body_count, s.bodies, s.count, s.contacts, NULL,
                                                  workspace, size - 1, got.impulses, NULL, NULL);
    free(workspace);
    systems_free(&s);
    REQUIRE_STATUS(t, status, want);
    REQUIRE(t, other == 77);
    REQUIRE_STATUS(t, solved, want);
    REQUIRE_STATUS(t, none, TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, small, TRIBO_ERROR_CAPACITY);
    REQUIRE(t, canary_kept(got.impulses, sizeof got.impulses));
    REQUIRE(t, canary_kept(got.velocities, sizeof got.velocities));
}

static void velocities_are_given(property_trial *t)
{
    tribo_body bodies[BODIES];
    tribo_body before[BODIES];
    double velocities[6 * BODIES];
    double half[3];
    const size_t count = make_choice(t, "count", BODIES + 1);
    const uint32_t bad = make_choice(t, "bad", 6);
    int finite = 1;
    property_expand(t);
    for (size_t i = 0; i < BODIES; i++) {
        make_body(t, "body", BODY_ANY, &bodies[i], half);
    }
    for (size_t i = 0; i < 6 * BODIES; i++) {
        velocities[i] = bad == 1 && make_byte(t) % 8 == 1 ? make_any(t, "v") : make_finite(t, "v");
        finite = finite && (i >= 6 * count || isfinite(velocities[i]));
    }
    memcpy(before, bodies, sizeof bodies);
    REQUIRE_STATUS(t, tribo_system_apply(count, bodies, velocities),
                   finite ? TRIBO_OK : TRIBO_ERROR_NOT_FINITE);
    for (size_t i = 0; i < count && finite; i++) {
        memcpy(before[i].velocity, velocities + 6 * i, sizeof before[i].velocity);
        memcpy(before[i].angular_velocity, velocities + 6 * i + 3,
               sizeof before[i].angular_velocity);
    }
    REQUIRE_SAME(t, bodies, before, sizeof bodies);
    REQUIRE_STATUS(t, tribo_system_apply(BODIES, NULL, velocities), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_system_apply(BODIES, bodies, NULL), TRIBO_ERROR_NULL);
}

const char *const property_room = "system";
const property property_list[] = {
    {"certificate_is_true", certificate_is_true, 1},
    {"energy_never_grows", energy_never_grows, 1},
    {"restitution_never_adds_energy", restitution_never_adds_energy, 1},
    {"same_bits_however_run", same_bits_however_run, 2},
    {"powers_of_two", powers_of_two, 1},
    {"order_and_repetition", order_and_repetition, 1},
    {"islands_stay_apart", islands_stay_apart, 2},
    {"solutions_start_warm", solutions_start_warm, 2},
    {"one_contact", one_contact, 1},
    {"assembled_certificate", assembled_certificate, 1},
    {"assembled_wild", assembled_wild, 1},
    {"bodies_wild", bodies_wild, 1},
    {"bad_calls", bad_calls, 1},
    {"velocities_are_given", velocities_are_given, 1},
    {"certificate_of_torques_is_true", certificate_of_torques_is_true, 2},
    {"torques_take_energy", torques_take_energy, 2},
    {"restitution_beside_torques", restitution_beside_torques, 8},
    {"same_torques_however_run", same_torques_however_run, 8},
    {"torques_scale", torques_scale, 4},
    {"torques_start_warm", torques_start_warm, 10},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 1000;
