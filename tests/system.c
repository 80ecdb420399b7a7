/* Many contacts: closed forms, certificates against quad precision, symmetries
 * to the bit, stop reasons, bad input. */
#include <tribo/audit.h>
#include <tribo/system.h>

#include "problems.h"
#include "quad_system.h"
#include "systems.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define EPS DBL_EPSILON
#define NOT_A_NUMBER ((double)NAN)
#define INFINITE ((double)INFINITY)

/* Differences between a certificate and its quad-precision truth, in units of
 * the rounding of the sums that it is made of. */
#define UNITS 64.0

enum { GUARD = 64 };

static const double pi = 3.14159265358979323846;

/* Greatest difference of certificates in the running test, and the measure it
 * was in. */
static double worst;
static const char *worst_name;

static int fresh(void **state)
{
    (void)state;
    worst = 0.0;
    worst_name = "none";
    return 0;
}

static int tell(void **state)
{
    (void)state;
    print_message("# certificates: at most %.3g roundings off (%s)\n", worst, worst_name);
    return 0;
}

/* ---- one call
 * --------------------------------------------------------------------------------
 */

typedef struct solution {
    tribo_status status;
    size_t count;
    size_t body_count; /* assembled: 0 */
    double *impulses;
    double *velocities;
    tribo_system_info info;
    size_t workspace;
} solution;

static void *allocate(size_t size)
{
    void *memory = malloc(size > 0 ? size : 1);
    assert_non_null(memory);
    return memory;
}

static void release(solution *out)
{
    free(out->impulses);
    free(out->velocities);
    memset(out, 0, sizeof *out);
}

static tribo_system_options defaults(void)
{
    tribo_system_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    return options;
}

/* Memory of just the size asked for, with a guard behind it. */
static unsigned char *workspace_of(size_t size)
{
    unsigned char *memory = allocate(size + GUARD);
    memset(memory, 0xa5, size + GUARD);
    return memory;
}

static void check_guard(unsigned char *memory, size_t size)
{
    for (size_t i = 0; i < GUARD; i++) {
        assert_int_equal(memory[size + i], 0xa5);
    }
    free(memory);
}

static void note_difference(const quad_certificate *truth, const tribo_system_info *info)
{
    const char *name = "none";
    const double units = quad_certificate_difference(truth, info, &name);
    if (!(units <= worst)) {
        worst = units;
        worst_name = name;
    }
    if (!(units <= UNITS)) {
        print_message("# %s is %.3g roundings off\n", name, units);
        print_message("# truth eta %.17g rms %.17g signorini %.17g cone %.17g "
                      "misalignment %.17g "
                      "invariant %.17g siconos %.17g energy %.17g scale %.17g "
                      "linear %.17g angular "
                      "%.17g\n",
                      truth->eta, truth->eta_rms, truth->signorini, truth->cone,
                      truth->misalignment, truth->invariant, truth->siconos, truth->energy,
                      truth->energy_scale, truth->linear, truth->angular);
        print_message("#  info eta %.17g rms %.17g signorini %.17g cone %.17g "
                      "misalignment %.17g "
                      "invariant %.17g siconos %.17g energy %.17g scale %.17g "
                      "linear %.17g angular "
                      "%.17g\n",
                      info->eta, info->eta_rms, info->signorini, info->cone, info->misalignment,
                      info->invariant, info->siconos, info->energy, info->energy_scale,
                      info->linear, info->angular);
        fail();
    }
}

static int has_restitution(const systems_scene *scene)
{
    for (size_t i = 0; i < scene->count; i++) {
        if (scene->contacts[i].pair.e > 0.0) {
            return 1;
        }
    }
    return 0;
}

static int has_targets(const systems_scene *scene)
{
    for (size_t i = 0; i < scene->count; i++) {
        const double *t = scene->contacts[i].target;
        if (t[0] != 0.0 || t[1] != 0.0 || t[2] != 0.0) {
            return 1;
        }
    }
    return 0;
}

/* Finite, in the cone, separating or not pulling: whatever the accuracy. */
static void check_impulses(size_t count, const double *impulses, const double *mu)
{
    for (size_t i = 0; i < count; i++) {
        const double *r = impulses + 3 * i;
        assert_true(isfinite(r[0]) && isfinite(r[1]) && isfinite(r[2]));
        assert_true(r[0] >= 0.0);
        if (mu[2 * i] == 0.0) {
            assert_true(r[1] == 0.0 && r[2] == 0.0);
        }
        assert_true(tribo_cone_contains(r, mu[2 * i], 16.0 * EPS));
    }
}

/* What holds for every solve: the certificate is true, momentum and velocities
 * fit the impulses to rounding, impulses lie in the cone, and energy does not
 * grow. */
static void check_solution(const systems_scene *scene, const tribo_system_options *options,
                           const solution *got)
{
    quad_certificate truth;
    const double tolerance =
        options != NULL && options->tolerance > 0.0 ? options->tolerance : 1e-10;
    double *mu = allocate(2 * scene->count * sizeof *mu);
    for (size_t i = 0; i < scene->count; i++) {
        const int one_row = scene->contacts[i].dimension == 1;
        mu[2 * i] = mu[2 * i + 1] = one_row ? 0.0 : scene->contacts[i].pair.mu_s;
    }
    quad_certificate_of_bodies(scene->body_count, scene->bodies, scene->count, scene->contacts,
                               got->impulses, got->velocities, &truth);
    assert_true(truth.velocity <= UNITS * EPS);
    assert_true(truth.linear <= UNITS * truth.linear_noise);
    assert_true(truth.angular <= truth.gap + UNITS * truth.angular_noise);
    if (!has_targets(scene)) {
        assert_true(truth.kinetic <= UNITS * truth.kinetic_noise + 1e-9 * truth.energy_scale);
    }
    if (!has_restitution(scene)) {
        check_impulses(scene->count, got->impulses, mu);
        note_difference(&truth, &got->info);
        const int invariant = options != NULL && options->measure == TRIBO_MEASURE_INVARIANT;
        const double measure = invariant ? truth.invariant : truth.eta;
        const double noise = UNITS * (invariant ? truth.invariant_noise : truth.contact_noise);
        assert_true(got->info.stop != TRIBO_STOP_TOLERANCE || measure <= tolerance + noise);
    }
    assert_true(got->info.bytes <= got->workspace);
    free(mu);
}

/* Solves without judging; start (may be null): impulses of a warm start. */
static void solve_only(const systems_scene *scene, const tribo_system_options *options,
                       const double *start, solution *out)
{
    memset(out, 0, sizeof *out);
    out->count = scene->count;
    out->body_count = scene->body_count;
    out->impulses = allocate(3 * scene->count * sizeof(double));
    out->velocities = allocate(6 * scene->body_count * sizeof(double));
    memset(out->impulses, 0xa5, 3 * scene->count * sizeof(double));
    memset(out->velocities, 0xa5, 6 * scene->body_count * sizeof(double));
    if (start != NULL) {
        memcpy(out->impulses, start, 3 * scene->count * sizeof(double));
    }
    out->info.struct_size = sizeof out->info;
    out->status = tribo_system_workspace_size(scene->body_count, scene->count, scene->contacts,
                                              options, &out->workspace);
    assert_int_equal(out->status, TRIBO_OK);
    unsigned char *memory = workspace_of(out->workspace);
    out->status =
        tribo_system_solve(scene->body_count, scene->bodies, scene->count, scene->contacts, options,
                           memory, out->workspace, out->impulses, out->velocities, &out->info);
    check_guard(memory, out->workspace);
}

static void solve(const systems_scene *scene, const tribo_system_options *options,
                  const double *start, solution *out)
{
    solve_only(scene, options, start, out);
    assert_int_equal(out->status, TRIBO_OK);
    check_solution(scene, options, out);
}

/* With defaults, which have to be enough. */
static void solve_well(const systems_scene *scene, solution *out)
{
    solve(scene, NULL, NULL, out);
    if (out->info.stop != TRIBO_STOP_TOLERANCE) {
        print_message("# stop %u eta %.3g sweeps %llu steps %llu\n", (unsigned)out->info.stop,
                      out->info.eta, (unsigned long long)out->info.sweeps,
                      (unsigned long long)out->info.steps);
    }
    assert_int_equal(out->info.stop, TRIBO_STOP_TOLERANCE);
}

static void solve_blocks(const systems_blocks *problem, const double *dense,
                         const tribo_system_options *options, solution *out)
{
    const uint32_t *row_starts = dense != NULL ? NULL : problem->row_starts;
    const uint32_t *columns = dense != NULL ? NULL : problem->columns;
    const double *blocks = dense != NULL ? dense : problem->blocks;
    quad_certificate truth;
    memset(out, 0, sizeof *out);
    out->count = problem->count;
    out->impulses = allocate(3 * problem->count * sizeof(double));
    out->velocities = allocate(3 * problem->count * sizeof(double));
    out->info.struct_size = sizeof out->info;
    assert_int_equal(tribo_system_assembled_workspace_size(problem->count, row_starts, columns,
                                                           options, &out->workspace),
                     TRIBO_OK);
    unsigned char *memory = workspace_of(out->workspace);
    out->status = tribo_system_solve_assembled(
        problem->count, row_starts, columns, blocks, problem->q, problem->mu, options, memory,
        out->workspace, out->impulses, out->velocities, &out->info);
    check_guard(memory, out->workspace);
    assert_int_equal(out->status, TRIBO_OK);
    quad_certificate_of_blocks(problem->count, row_starts, columns, blocks, problem->q, problem->mu,
                               out->impulses, out->velocities, &truth);
    assert_true(truth.velocity <= UNITS * EPS);
    assert_true(out->info.linear == 0.0 && out->info.angular == 0.0);
    check_impulses(problem->count, out->impulses, problem->mu);
    note_difference(&truth, &out->info);
}

static int same(const double *a, const double *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) == 0;
}

static void assert_same(const solution *a, const solution *b)
{
    assert_int_equal(a->info.stop, b->info.stop);
    assert_true(same(a->impulses, b->impulses, 3 * a->count));
    assert_true(same(a->velocities, b->velocities, 6 * a->body_count));
    assert_true(same(&a->info.eta, &b->info.eta, 1));
    assert_true(same(&a->info.energy, &b->info.energy, 1));
    assert_true(a->info.sweeps == b->info.sweeps && a->info.steps == b->info.steps);
}

static double distance(const double *a, const double *b, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(sum);
}

static double size_of(const double *a, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += a[i] * a[i];
    }
    return sqrt(sum);
}

static void assert_near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) {
        print_message("# %.17g, not %.17g to %.3g\n", got, want, tolerance);
        fail();
    }
}

/* ---- one contact
 * -----------------------------------------------------------------------------
 */

static void test_one_contact_is_the_exact_solve(void **state)
{
    const uint64_t trials = problem_count(400);
    double greatest = 0.0;
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        problem_collision c;
        systems_scene scene;
        solution got;
        double frame[9];
        double w[6];
        double u[3];
        double p[3];
        tribo_body bodies[2];
        tribo_system_contact contact;
        problem_draw_collision(70, i, &c);
        memset(&scene, 0, sizeof scene);
        memset(&contact, 0, sizeof contact);
        bodies[0] = c.a;
        bodies[1] = c.b;
        contact.b = c.two_bodies ? 1 : TRIBO_WORLD;
        contact.dimension = 3;
        contact.contact = c.contact;
        contact.pair = c.pair;
        contact.pair.e = 0.0;
        scene.bodies = bodies;
        scene.body_count = c.two_bodies ? 2 : 1;
        scene.contacts = &contact;
        scene.count = 1;
        tribo_basis_from_normal(c.contact.normal, frame);
        const tribo_body *b = c.two_bodies ? &c.b : NULL;
        assert_int_equal(tribo_contact_matrix(&c.a, b, &c.contact, frame, w), TRIBO_OK);
        assert_int_equal(tribo_contact_velocity(&c.a, b, &c.contact, frame, u), TRIBO_OK);
        assert_int_equal(tribo_contact_solve(w, u, c.pair.mu_s, c.pair.mu_d, p, NULL), TRIBO_OK);
        solve_well(&scene, &got);
        const double error = distance(got.impulses, p, 3);
        if (size_of(p, 3) > 0.0) {
            greatest = fmax(greatest, error / size_of(p, 3));
        } else {
            assert_true(error == 0.0);
        }
        release(&got);
    }
    print_message("# greatest relative difference %.3g\n", greatest);
    assert_true(greatest <= 1e-12);
}

/* The assembled form, on all sets of local problems. */
static void test_one_block_is_the_exact_solve(void **state)
{
    const uint64_t trials = problem_count(300);
    (void)state;
    for (uint32_t set = 0; set < PROBLEM_SETS; set++) {
        unsigned unsolved = 0;
        for (uint64_t i = 0; i < trials; i++) {
            static const size_t entry[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
            problem_local local;
            uint32_t row_starts[2] = {0, 1};
            uint32_t column = 0;
            double block[9];
            double mu[2];
            solution got;
            problem_draw(set, 71, i, &local);
            for (size_t k = 0; k < 9; k++) {
                block[k] = local.w[entry[k]];
            }
            mu[0] = mu[1] = local.mu;
            systems_blocks one = {1, row_starts, &column, block, local.b, mu};
            solve_blocks(&one, NULL, NULL, &got);
            unsolved += got.info.stop != TRIBO_STOP_TOLERANCE;
            release(&got);
        }
        print_message("# %s: %u of %u not to 1e-10\n", problem_set_name(set), unsolved,
                      (unsigned)trials);
        assert_int_equal(unsolved, 0);
    }
}

/* ---- stacks and slopes
 * ----------------------------------------------------------------------- */

static double interface_impulse(const solution *got, size_t k)
{
    double sum = 0.0;
    for (size_t i = 0; i < 4; i++) {
        sum += got->impulses[3 * (4 * k + i)];
    }
    return sum;
}

static void test_stacks_carry_their_weight(void **state)
{
    static const size_t sizes[] = {1, 2, 5, 10};
    static const double ratios[] = {1.0, 10.0, 1e3, 1e6};
    double greatest = 0.0;
    (void)state;
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        for (size_t k = 0; k < 3 * sizeof ratios / sizeof ratios[0]; k++) {
            systems_scene tower;
            solution got;
            double weight = 0.0;
            tribo_system_options options = defaults();
            /* eta is relative to what the greatest loads do to the lightest boxes */
            options.measure = TRIBO_MEASURE_INVARIANT;
            options.tolerance = 4e-9;
            systems_tower(&tower, sizes[s], (uint32_t)(k % 3), ratios[k / 3], 0.5);
            solve(&tower, &options, NULL, &got);
            assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
            assert_true(got.info.factorizations <= 40);
            for (size_t i = sizes[s]; i-- > 0;) {
                weight += SYSTEMS_FALL / tower.bodies[i].inverse_mass;
                const double error = fabs(interface_impulse(&got, i) - weight) / weight;
                greatest = fmax(greatest, error);
                assert_true(size_of(got.velocities + 6 * i, 6) <= 1e-7 * SYSTEMS_FALL);
            }
            release(&got);
            systems_free(&tower);
        }
    }
    print_message("# greatest relative error of a load %.3g\n", greatest);
    assert_true(greatest <= 1e-7);
}

static void test_slopes(void **state)
{
    systems_scene slope;
    solution got;
    const double threshold = atan(0.5);
    (void)state;
    systems_slope(&slope, pi / 6.0, 0.5);
    solve_well(&slope, &got);
    assert_near(got.velocities[0], 0.010952423241, 1e-11);
    assert_near(got.velocities[0], SYSTEMS_FALL * (sin(pi / 6.0) - 0.5 * cos(pi / 6.0)), 1e-10);
    assert_true(size_of(got.velocities + 1, 5) <= 1e-9);
    release(&got);
    systems_free(&slope);
    for (int side = -1; side <= 1; side++) {
        const double angle = threshold * (1.0 + 1e-3 * (double)side);
        systems_slope(&slope, angle, 0.5);
        solve_well(&slope, &got);
        const double slides = fmax(0.0, SYSTEMS_FALL * (sin(angle) - 0.5 * cos(angle)));
        /* just at the threshold an error of the friction is one of the speed, amplified */
        assert_near(got.velocities[0], slides, side == 0 ? 1e-6 : 1e-8);
        release(&got);
        systems_free(&slope);
    }
}

/* Greatest speed of a body, in units of the fall of one step. */
static double unrest(systems_scene *scene)
{
    solution got;
    double greatest = 0.0;
    tribo_system_options options = defaults();
    /* chains of many joints turn a small residual into a large velocity */
    options.measure = TRIBO_MEASURE_INVARIANT;
    options.tolerance = 1e-12;
    solve(scene, &options, NULL, &got);
    assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
    for (size_t i = 0; i < scene->body_count; i++) {
        greatest = fmax(greatest, size_of(got.velocities + 6 * i, 6) / SYSTEMS_FALL);
    }
    release(&got);
    systems_free(scene);
    return greatest;
}

/* Scenes just on either side of their exact thresholds of rest (planar
 * statics). What cannot be in equilibrium has to move; where equilibrium is the
 * only solution, it has to rest. */
static void test_thresholds_of_rest(void **state)
{
    systems_scene scene;
    static const struct {
        const char *name;
        double mu_floor;
        double mu_wall;
    } ladders[] = {
        {"ladder 0.4, 0", 0.4, 0.0}, {"ladder 0.4, 0.3", 0.4, 0.3}, {"ladder 0.6, 0.6", 0.6, 0.6}};
    static const struct {
        double width;
        double height;
        double mu;
        double angle; /* degrees */
    } boxes[] = {{1.0, 1.0, 0.5, 26.56505118}, {1.0, 3.0, 0.8, 18.43494882}};
    static const struct {
        size_t voussoirs;
        double thickness;
    } arches[] = {{9, 0.10213423}, {15, 0.10626577}, {27, 0.10677634}};
    (void)state;
    for (size_t i = 0; i < sizeof ladders / sizeof ladders[0]; i++) {
        const double f = ladders[i].mu_floor;
        const double w = ladders[i].mu_wall;
        const double angle = atan((1.0 - w * f) / (2.0 * f));
        systems_ladder(&scene, angle * (1.0 + 1e-3), f, w);
        const double above = unrest(&scene);
        systems_ladder(&scene, angle * (1.0 - 1e-3), f, w);
        const double below = unrest(&scene);
        print_message("# %s: %.3g and %.3g g dt\n", ladders[i].name, above, below);
        assert_true(above <= 1e-7 && below > 1e-5);
    }
    for (size_t i = 0; i < 2; i++) {
        const double half_angle = (i == 0 ? 25.0 : 40.0) * pi / 180.0;
        const double mu = tan(half_angle) / 2.0;
        assert_near(mu, i == 0 ? 0.233153829 : 0.419549816, 1e-9);
        systems_cards(&scene, half_angle, mu * (1.0 + 1e-3));
        assert_true(unrest(&scene) <= 1e-7);
        systems_cards(&scene, half_angle, mu * (1.0 - 1e-3));
        assert_true(unrest(&scene) > 1e-5);
    }
    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++) {
        const double angle = boxes[i].angle * pi / 180.0;
        systems_box_on_slope(&scene, boxes[i].width, boxes[i].height, angle * (1.0 - 1e-3),
                             boxes[i].mu);
        assert_true(unrest(&scene) <= 1e-7);
        systems_box_on_slope(&scene, boxes[i].width, boxes[i].height, angle * (1.0 + 1e-3),
                             boxes[i].mu);
        assert_true(unrest(&scene) > 1e-5);
    }
    for (size_t i = 0; i < 2; i++) {
        const size_t bricks = i == 0 ? 4 : 10;
        systems_overhang(&scene, bricks, 1.0 - 1e-3);
        assert_true(unrest(&scene) <= 1e-7);
        systems_overhang(&scene, bricks, 1.0 + 1e-3);
        assert_true(unrest(&scene) > 1e-5);
    }
    for (size_t i = 0; i < sizeof arches / sizeof arches[0]; i++) {
        systems_arch(&scene, arches[i].voussoirs, arches[i].thickness * (1.0 + 1e-3), 0.6);
        const double thick = unrest(&scene);
        systems_arch(&scene, arches[i].voussoirs, arches[i].thickness * (1.0 - 1e-3), 0.6);
        const double thin = unrest(&scene);
        print_message("# arch of %u: %.3g and %.3g g dt\n", (unsigned)arches[i].voussoirs, thick,
                      thin);
        assert_true(thick <= 1e-7 && thin > 1e-6);
    }
}

/* ---- impacts
 * ---------------------------------------------------------------------------------
 */

static void test_rocking_and_rolling(void **state)
{
    static const struct {
        double b;
        double h;
        double mu;
        double rate;
        double friction;
    } blocks[] = {{0.2, 1.0, 0.3, 49.0 / 52.0, 0.1485},
                  {0.3, 1.0, 0.3, 0.876146788991, 0.2200},
                  {0.5, 0.5, 0.8, 0.25, 0.6}};
    (void)state;
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) {
        systems_scene scene;
        solution got;
        systems_rocking(&scene, blocks[i].b, blocks[i].h, blocks[i].mu);
        solve_well(&scene, &got);
        assert_near(got.velocities[4], blocks[i].rate, 1e-9);
        assert_true(size_of(got.impulses, 3) <= 1e-9);
        assert_near(fabs(got.impulses[4] / got.impulses[3]), blocks[i].friction, 5e-5);
        release(&got);
        systems_free(&scene);
    }
    for (size_t spokes = 5; spokes < 20; spokes += 3) {
        const double inertia = 0.3;
        const double angle = pi / (double)spokes;
        systems_scene scene;
        solution got;
        systems_wheel(&scene, spokes, inertia, 2.0);
        solve_well(&scene, &got);
        assert_near(got.velocities[4], (inertia + cos(2.0 * angle)) / (inertia + 1.0), 1e-9);
        assert_true(size_of(got.impulses, 3) <= 1e-9);
        release(&got);
        systems_free(&scene);
    }
}

static void check_line(size_t balls, const double *masses, double e, const double *want)
{
    systems_scene scene;
    solution got;
    systems_cradle(&scene, balls, masses, e);
    solve_well(&scene, &got);
    for (size_t i = 0; i < balls; i++) {
        assert_near(got.velocities[6 * i], want[i], 1e-9);
    }
    assert_near(got.info.restitution, 1.0, 0.0);
    release(&got);
    systems_free(&scene);
}

/* Simultaneous impacts: all contacts at once, not one after the other. */
static void test_balls_in_a_row(void **state)
{
    static const double graded[3] = {1.0, 0.5, 0.25};
    static const double three[3] = {-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0};
    static const double four[4] = {-0.5, 0.5, 0.5, 0.5};
    static const double five[5] = {-0.6, 0.4, 0.4, 0.4, 0.4};
    static const double of_graded[3] = {1.0 / 7.0, 8.0 / 7.0, 8.0 / 7.0};
    static const double plastic[3] = {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};
    (void)state;
    check_line(3, NULL, 1.0, three);
    check_line(4, NULL, 1.0, four);
    check_line(5, NULL, 1.0, five);
    check_line(3, graded, 1.0, of_graded);
    check_line(3, NULL, 0.0, plastic);
}

static void test_breaks(void **state)
{
    (void)state;
    for (int i = 0; i <= 4; i++) {
        const double e = (double)i / 4.0;
        systems_scene scene;
        solution got;
        systems_break(&scene, e);
        solve_well(&scene, &got);
        assert_near(got.velocities[0], 1.0 - 0.6 * (1.0 + e), 1e-9);
        for (size_t ball = 1; ball < 3; ball++) {
            const double *v = got.velocities + 6 * ball;
            const double speed = sqrt(3.0) / 5.0 * (1.0 + e);
            assert_near(v[0], speed * sqrt(0.75), 1e-9);
            assert_near(fabs(v[1]), speed / 2.0, 1e-9);
        }
        release(&got);
        systems_free(&scene);
        /* a symmetric break is symmetric */
        systems_rack(&scene, e);
        solve_well(&scene, &got);
        size_t first = 0;
        for (size_t row = 0; row < 5; row++) {
            for (size_t k = 0; k <= row; k++) {
                const double *v = got.velocities + 6 * (first + k);
                const double *mirror = got.velocities + 6 * (first + row - k);
                assert_near(v[0], mirror[0], 1e-8);
                assert_near(v[1], -mirror[1], 1e-8);
            }
            first += row + 1;
        }
        release(&got);
        systems_free(&scene);
    }
}

/* One contact alone separates with -e u_n, exactly; energy never grows,
 * whatever the coefficients and however many contacts; and the impulses lie on
 * the line from the plastic ones. */
static void test_restitution(void **state)
{
    const uint64_t trials = problem_count(300);
    unsigned limited = 0;
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        systems_scene scene;
        solution got;
        solution plastic;
        systems_random(&scene, 4, i % 2 == 0 ? 1 : 6, SYSTEMS_STATIC | SYSTEMS_RESTITUTION, i);
        if (scene.count == 0) {
            systems_free(&scene);
            continue;
        }
        solve_well(&scene, &got);
        limited += got.info.restitution < 1.0;
        assert_true(got.info.restitution >= 0.0 && got.info.restitution <= 1.0);
        quad_certificate before;
        quad_certificate after;
        quad_certificate_of_bodies(scene.body_count, scene.bodies, scene.count, scene.contacts,
                                   got.impulses, got.velocities, &after);
        assert_true(after.kinetic <= UNITS * after.kinetic_noise);
        assert_near(got.info.energy, after.energy, UNITS * after.energy_noise);
        systems_scene still;
        systems_copy(&scene, &still);
        for (size_t k = 0; k < still.count; k++) {
            still.contacts[k].pair.e = 0.0;
        }
        solve_well(&still, &plastic);
        assert_near(plastic.info.restitution, 1.0, 0.0);
        quad_certificate_of_bodies(still.body_count, still.bodies, still.count, still.contacts,
                                   plastic.impulses, plastic.velocities, &before);
        assert_near(got.info.eta, before.eta, UNITS * before.contact_noise);
        assert_near(got.info.invariant, before.invariant, UNITS * before.invariant_noise);
        for (size_t k = 0; k < scene.count && scene.count == 1; k++) {
            double frame[9];
            double u[2][3];
            tribo_basis_from_normal(scene.contacts[k].contact.normal, frame);
            tribo_body world;
            tribo_body_init(&world);
            for (size_t when = 0; when < 2; when++) {
                const uint32_t index[2] = {scene.contacts[k].a, scene.contacts[k].b};
                const tribo_body *ends[2];
                for (size_t side = 0; side < 2; side++) {
                    ends[side] = index[side] == TRIBO_WORLD ? &world : &scene.bodies[index[side]];
                }
                tribo_contact_velocity(ends[0], ends[1], &scene.contacts[k].contact, frame,
                                       u[when]);
                assert_int_equal(tribo_system_apply(scene.body_count, scene.bodies, got.velocities),
                                 TRIBO_OK);
            }
            if (u[0][0] < 0.0 && got.info.restitution == 1.0) {
                assert_near(u[1][0], -scene.contacts[k].pair.e * u[0][0],
                            1e-9 * (fabs(u[0][0]) + size_of(u[0], 3)));
            }
        }
        release(&got);
        release(&plastic);
        systems_free(&still);
        systems_free(&scene);
    }
    print_message("# energy limited restitution in %u of %u systems\n", limited, (unsigned)trials);
}

/* ---- random systems
 * -------------------------------------------------------------------------- */

/* Certificate, momentum, energy, cone on everything that systems_random can
 * draw. */
static void test_random_systems(void **state)
{
    static const uint32_t solvers[] = {TRIBO_SOLVER_AUTO, TRIBO_SOLVER_GAUSS_SEIDEL,
                                       TRIBO_SOLVER_NEWTON};
    const uint64_t trials = problem_count(200);
    (void)state;
    for (size_t s = 0; s < 3; s++) {
        unsigned stops[6] = {0, 0, 0, 0, 0, 0};
        unsigned unsolved = 0;
        double greatest = 0.0;
        for (uint64_t i = 0; i < trials; i++) {
            const uint32_t draws = (uint32_t)(i * 37) & SYSTEMS_ALL & ~(uint32_t)SYSTEMS_TARGETS;
            systems_scene scene;
            solution got;
            tribo_system_options options = defaults();
            options.solver = solvers[s];
            options.max_iterations = s == 1 ? 20000 : 0;
            systems_random(&scene, 6, 12, draws, i);
            solve(&scene, &options, NULL, &got);
            assert_true(got.info.stop <= TRIBO_STOP_JAM);
            stops[got.info.stop]++;
            if (s == 0 && !has_restitution(&scene) && got.info.stop != TRIBO_STOP_TOLERANCE) {
                print_message("# seed %u draws %u: stop %u eta %.3g\n", (unsigned)i,
                              (unsigned)draws, (unsigned)got.info.stop, got.info.eta);
                unsolved++;
            }
            greatest = fmax(greatest, size_of(got.impulses, 3 * got.count));
            release(&got);
            systems_free(&scene);
        }
        print_message("# solver %u: tolerance %u, iterations %u, time %u, cancel %u, stall %u, jam "
                      "%u; greatest |r| %.3g\n",
                      (unsigned)solvers[s], stops[0], stops[1], stops[2], stops[3], stops[4],
                      stops[5], greatest);
        assert_int_equal(unsolved, 0);
        assert_true(greatest <= 1e9);
    }
}

/* Other scales change nothing but the exponents. */
static void test_powers_of_two(void **state)
{
    static const int scales[][3] = {{20, 0, 0}, {-20, 0, 0}, {0, 40, 0},      {0, -40, 0},
                                    {0, 0, 10}, {0, 0, -10}, {7, 0, 0},       {0, 11, 0},
                                    {0, 0, 5},  {7, -11, 5}, {100, -200, 50}, {-60, 90, 1}};
    const uint64_t trials = problem_count(60);
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        systems_scene scene;
        solution want;
        if (i % 6 == 0) {
            systems_tower(&scene, 3, SYSTEMS_GEOMETRIC, 10.0, 0.5);
        } else {
            systems_random(&scene, 5, 8, (uint32_t)(i * 37) & SYSTEMS_ALL, i);
        }
        solve(&scene, NULL, NULL, &want);
        for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++) {
            const int *s = scales[k];
            systems_scene other;
            solution got;
            systems_copy(&scene, &other);
            systems_scale(&other, s[0], s[1], s[2]);
            solve(&other, NULL, NULL, &got);
            for (size_t n = 0; n < 3 * got.count; n++) {
                got.impulses[n] = ldexp(got.impulses[n], s[2] - s[0] - s[1]);
            }
            for (size_t n = 0; n < 6 * got.body_count; n++) {
                got.velocities[n] = ldexp(got.velocities[n], n % 6 < 3 ? s[2] - s[0] : s[2]);
            }
            got.info.energy = ldexp(got.info.energy, 2 * s[2] - 2 * s[0] - s[1]);
            assert_same(&got, &want);
            release(&got);
            systems_free(&other);
        }
        release(&want);
        systems_free(&scene);
    }
}

/* ---- order, threads, instruction sets
 * -------------------------------------------------------- */

static void draw_scene(systems_scene *scene, uint64_t i)
{
    switch (i % 6) {
    case 0:
        systems_tower(scene, 4, SYSTEMS_TOP, 3.0, 0.5);
        break;
    case 1:
        systems_wall(scene, 4, 4, i + 1);
        break;
    case 2:
        systems_rubble(scene, 4, i);
        break;
    case 3:
        systems_sliding_tower(scene, 5, i);
        break;
    case 4:
        systems_crowd(scene, 11, i);
        break;
    default:
        systems_random(scene, 6, 12, SYSTEMS_ALL & ~(uint32_t)SYSTEMS_TARGETS, i);
        break;
    }
}

static void backwards(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    unsigned *calls = user;
    (*calls)++;
    for (uint32_t i = count; i > 0; i--) {
        task(data, i - 1);
    }
}

typedef struct job {
    void (*task)(void *data, uint32_t i);
    void *data;
    uint32_t number;
} job;

static void *run_job(void *context)
{
    const job *self = context;
    self->task(self->data, self->number);
    return NULL;
}

static void threads(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    enum { MOST = 7 };
    pthread_t ids[MOST];
    job jobs[MOST];
    unsigned *calls = user;
    (*calls)++;
    assert_true(count <= MOST);
    for (uint32_t i = 0; i < count; i++) {
        jobs[i].task = task;
        jobs[i].data = data;
        jobs[i].number = i;
        assert_int_equal(pthread_create(&ids[i], NULL, run_job, &jobs[i]), 0);
    }
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(pthread_join(ids[i], NULL), 0);
    }
}

static void test_no_bit_depends_on_how_it_is_run(void **state)
{
    static const uint32_t tasks[] = {1, 2, 7};
    unsigned calls = 0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(24); i++) {
        systems_scene scene;
        solution want;
        solution got;
        tribo_system_options options = defaults();
        options.solver = (uint32_t)(i / 6 % 3);
        options.max_iterations = 40;
        draw_scene(&scene, i);
        solve(&scene, &options, NULL, &want);
        solve(&scene, &options, NULL, &got);
        assert_same(&got, &want);
        release(&got);
        for (uint32_t isa = 0; isa <= TRIBO_ISA_X86_64_V4; isa++) {
            options.isa = isa;
            if (tribo_isa_available(isa)) {
                solve(&scene, &options, NULL, &got);
                assert_same(&got, &want);
                release(&got);
            }
        }
        options.user = &calls;
        for (size_t k = 0; k < 6; k++) {
            options.isa = (uint32_t)(i % 3);
            options.tasks = tasks[k % 3];
            options.parallel = k < 3 ? backwards : threads;
            solve(&scene, &options, NULL, &got);
            assert_same(&got, &want);
            release(&got);
        }
        release(&want);
        systems_free(&scene);
    }
    print_message("# %u calls of the parallel callback\n", calls);
}

/* The callback is used where there is enough to share out. */
static void test_large_systems_run_in_parallel(void **state)
{
    unsigned calls = 0;
    systems_scene scene;
    solution want;
    solution got;
    tribo_system_options options = defaults();
    (void)state;
    options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    options.max_iterations = 10;
    systems_rubble(&scene, 16, 3);
    solve(&scene, &options, NULL, &want);
    options.parallel = threads;
    options.tasks = 2;
    options.user = &calls;
    solve(&scene, &options, NULL, &got);
    assert_same(&got, &want);
    assert_true(calls > 0);
    release(&want);
    release(&got);
    systems_free(&scene);
}

/* A scene whose velocities are unique. Where bodies slide and spin on more points than three, the
 * points can share the load in many ways, and with friction each way gives other velocities; so
 * there is no friction then. */
static int draw_unique(systems_scene *scene, uint64_t i)
{
    if (i % 6 == 5) {
        return 0;
    }
    if (i % 6 == 4) {
        systems_crowd(scene, 3, i);
        return 1;
    }
    draw_scene(scene, i);
    for (size_t k = 0; k < scene->count && (i % 6 == 2 || i % 6 == 3); k++) {
        scene->contacts[k].pair.mu_s = scene->contacts[k].pair.mu_d = 0.0;
    }
    return 1;
}

/* Velocities of the bodies do not depend on the order of the contacts where the
 * problem has one solution. */
static void test_permutations(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(24); i++) {
        systems_scene scene;
        solution want;
        if (!draw_unique(&scene, i)) {
            continue;
        }
        solve_well(&scene, &want);
        for (uint64_t seed = 0; seed < 3; seed++) {
            systems_scene other;
            solution got;
            systems_copy(&scene, &other);
            systems_permute(&other, seed, NULL);
            solve_well(&other, &got);
            const double scale = SYSTEMS_FALL + size_of(want.velocities, 6 * want.body_count);
            const double off = distance(got.velocities, want.velocities, 6 * want.body_count);
            assert_true(off <= 1e-6 * scale);
            release(&got);
            systems_free(&other);
        }
        release(&want);
        systems_free(&scene);
    }
}

static void test_duplicates_change_no_velocity(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(24); i++) {
        systems_scene scene;
        systems_scene other;
        solution want;
        solution got;
        if (!draw_unique(&scene, i)) {
            continue;
        }
        solve_well(&scene, &want);
        systems_copy(&scene, &other);
        for (size_t k = 0; k < scene.count; k += 3) {
            const tribo_system_contact again = scene.contacts[k];
            *systems_add_contact(&other, TRIBO_WORLD, TRIBO_WORLD, again.target,
                                 again.contact.normal, 0.0) = again;
        }
        solve_well(&other, &got);
        const double scale = SYSTEMS_FALL + size_of(want.velocities, 6 * want.body_count);
        assert_true(distance(got.velocities, want.velocities, 6 * want.body_count) <= 1e-6 * scale);
        release(&want);
        release(&got);
        systems_free(&other);
        systems_free(&scene);
    }
}

/* Islands do not know of each other: together or alone, the same bits. */
static void test_islands(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(24); i++) {
        systems_scene parts[2];
        systems_scene both;
        solution alone[2];
        solution got;
        tribo_system_options options = defaults();
        options.solver = (uint32_t)(i % 3);
        options.max_iterations = options.solver == TRIBO_SOLVER_GAUSS_SEIDEL ? 200 : 0;
        draw_scene(&parts[0], i);
        draw_scene(&parts[1], i + 1 + i / 6);
        systems_copy(&parts[0], &both);
        systems_append(&both, &parts[1]);
        for (size_t k = 0; k < 2; k++) {
            solve(&parts[k], &options, NULL, &alone[k]);
        }
        solve(&both, &options, NULL, &got);
        assert_int_equal(got.info.components, alone[0].info.components + alone[1].info.components);
        assert_true(got.info.eta == fmax(alone[0].info.eta, alone[1].info.eta));
        const size_t n = 3 * alone[0].count;
        const size_t m = 6 * alone[0].body_count;
        assert_true(same(got.impulses, alone[0].impulses, n));
        assert_true(same(got.impulses + n, alone[1].impulses, 3 * alone[1].count));
        assert_true(same(got.velocities, alone[0].velocities, m));
        assert_true(same(got.velocities + m, alone[1].velocities, 6 * alone[1].body_count));
        release(&got);
        for (size_t k = 0; k < 2; k++) {
            release(&alone[k]);
            systems_free(&parts[k]);
        }
        systems_free(&both);
    }
}

static void test_warm_starts(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(24); i++) {
        systems_scene scene;
        solution cold;
        solution got;
        tribo_system_options options = defaults();
        draw_scene(&scene, i);
        if (has_restitution(&scene)) {
            systems_free(&scene);
            continue;
        }
        solve_well(&scene, &cold);
        options.warm_start = 1;
        for (uint32_t solver = 0; solver < 3; solver++) {
            options.solver = solver;
            solve(&scene, &options, cold.impulses, &got);
            assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
            assert_true(got.info.sweeps + got.info.steps <= 1);
            assert_true(distance(got.impulses, cold.impulses, 3 * got.count) <=
                        1e-9 * size_of(cold.impulses, 3 * got.count));
            release(&got);
        }
        release(&cold);
        systems_free(&scene);
    }
}

/* ---- what a contact may be
 * ------------------------------------------------------------------- */

static void test_one_row_contacts(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(60); i++) {
        systems_scene rows;
        systems_scene smooth;
        solution got[2];
        systems_random(&rows, 5, 6, SYSTEMS_STATIC, i);
        systems_copy(&rows, &smooth);
        for (size_t k = 0; k < rows.count; k++) {
            /* one row whatever the friction is; mu = 0 is the same law */
            rows.contacts[k].dimension = 1;
            smooth.contacts[k].pair.mu_s = smooth.contacts[k].pair.mu_d = 0.0;
        }
        solve_well(&rows, &got[0]);
        solve_well(&smooth, &got[1]);
        assert_true(distance(got[0].velocities, got[1].velocities, 6 * rows.body_count) <=
                    1e-8 * (1.0 + size_of(got[1].velocities, 6 * rows.body_count)));
        release(&got[0]);
        release(&got[1]);
        systems_free(&rows);
        systems_free(&smooth);
    }
}

/* A cube on a slope: holds up to mu_s, slides with mu_d. */
static void test_static_above_dynamic_friction(void **state)
{
    static const double angles[] = {0.3, 0.5, 0.6, 0.8};
    (void)state;
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        systems_scene scene;
        solution got;
        systems_slope(&scene, angles[i], 0.6);
        for (size_t k = 0; k < scene.count; k++) {
            scene.contacts[k].pair.mu_d = 0.4;
        }
        solve_well(&scene, &got);
        const double slides = SYSTEMS_FALL * (sin(angles[i]) - 0.4 * cos(angles[i]));
        assert_near(got.velocities[0], tan(angles[i]) <= 0.6 ? 0.0 : slides, 1e-9);
        release(&got);
        systems_free(&scene);
    }
}

static void test_targets(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        /* a belt of 0.05 i m/s: friction gives mu g dt at most */
        const double speed = 0.05 * (double)i;
        systems_scene scene;
        solution got;
        systems_slope(&scene, 0.0, 0.7);
        for (size_t k = 0; k < 4; k++) {
            scene.contacts[k].target[1] = speed;
        }
        solve_well(&scene, &got);
        assert_near(got.velocities[0], fmin(speed, 0.7 * SYSTEMS_FALL), 1e-9);
        assert_near(got.velocities[2], 0.0, 1e-9);
        release(&got);
        systems_free(&scene);
        /* a gap that is still open after 0.02 i m/s of approach */
        systems_slope(&scene, 0.0, 0.7);
        for (size_t k = 0; k < 4; k++) {
            scene.contacts[k].target[0] = -0.05 * (double)i;
        }
        solve_well(&scene, &got);
        assert_near(got.velocities[2], -fmin(SYSTEMS_FALL, 0.05 * (double)i), 1e-9);
        release(&got);
        systems_free(&scene);
    }
}

/* Pressed between walls that close in: no bounded impulses, no NaN, no 1e13. */
static void test_jams(void **state)
{
    static const uint32_t solvers[] = {TRIBO_SOLVER_AUTO, TRIBO_SOLVER_GAUSS_SEIDEL,
                                       TRIBO_SOLVER_NEWTON};
    (void)state;
    for (size_t s = 0; s < 6; s++) {
        systems_scene scene;
        solution got;
        tribo_system_options options = defaults();
        options.solver = solvers[s % 3];
        options.max_iterations = 100000;
        systems_press(&scene, 0.5, s < 3 ? 0.4 : 0.0);
        solve(&scene, &options, NULL, &got);
        print_message("# solver %u: stop %u, |r| %.3g, eta %.3g\n", (unsigned)options.solver,
                      (unsigned)got.info.stop, size_of(got.impulses, 6), got.info.eta);
        assert_true(got.info.stop == TRIBO_STOP_JAM || got.info.stop == TRIBO_STOP_STALL ||
                    (s % 3 == 1 && got.info.stop == TRIBO_STOP_ITERATIONS));
        assert_true(size_of(got.impulses, 6) < 1e11);
        release(&got);
        systems_free(&scene);
    }
    /* one block, semidefinite, with a null vector in the cone that the velocity
   * runs against */
    for (int k = 0; k < 4; k++) {
        static const double mus[] = {0.5, 0.99, 1.0, 2.0};
        uint32_t row_starts[2] = {0, 1};
        uint32_t column = 0;
        double block[9] = {0.5, 0.5, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0};
        double q[3] = {-1.0, -0.3, 0.0};
        double mu[2] = {mus[k], mus[k]};
        systems_blocks one = {1, row_starts, &column, block, q, mu};
        solution got;
        solve_blocks(&one, NULL, NULL, &got);
        if (k < 2) {
            assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
            assert_near(got.impulses[0], 2.0 / (1.0 - mus[k]), 1e-7 * 2.0 / (1.0 - mus[k]));
        } else {
            assert_int_equal(got.info.stop, TRIBO_STOP_JAM);
            assert_true(size_of(got.impulses, 3) < 1e11);
        }
        release(&got);
    }
}

/* ---- assembled
 * -------------------------------------------------------------------------------
 */

static void test_assembled_and_bodies_agree(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(30); i++) {
        systems_scene scene;
        systems_blocks blocks;
        solution want;
        solution sparse;
        solution whole;
        if (!draw_unique(&scene, i)) {
            continue;
        }
        systems_assemble(&scene, &blocks);
        double *dense = systems_dense(&blocks);
        solve_well(&scene, &want);
        solve_blocks(&blocks, NULL, NULL, &sparse);
        solve_blocks(&blocks, dense, NULL, &whole);
        assert_int_equal(sparse.info.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(whole.info.stop, TRIBO_STOP_TOLERANCE);
        /* what does not depend on the choice among hyperstatic impulses: velocities
     */
        quad_certificate of_bodies;
        quad_certificate_of_blocks(blocks.count, blocks.row_starts, blocks.columns, blocks.blocks,
                                   blocks.q, blocks.mu, want.impulses, NULL, &of_bodies);
        assert_true(of_bodies.eta <= 2e-10);
        const double scale = size_of(blocks.q, 3 * blocks.count);
        assert_true(distance(sparse.velocities, whole.velocities, 3 * blocks.count) <=
                    1e-6 * scale);
        assert_near(sparse.info.energy, want.info.energy, 1e-7 * want.info.energy_scale);
        free(dense);
        release(&want);
        release(&sparse);
        release(&whole);
        systems_free_blocks(&blocks);
        systems_free(&scene);
    }
}

/* Gyroscopic terms make W unsymmetric: it is solved as it is. */
static void test_unsymmetric_matrices(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(30); i++) {
        systems_scene scene;
        systems_blocks blocks;
        problem_random random;
        solution got;
        if (!draw_unique(&scene, i)) {
            continue;
        }
        systems_assemble(&scene, &blocks);
        problem_random_start(&random, 72, 0, i);
        const double share = problem_random_decades(&random, -5.0, -3.0);
        for (size_t k = 0; k < blocks.row_starts[blocks.count]; k++) {
            for (size_t e = 0; e < 9; e++) {
                blocks.blocks[9 * k + e] *= 1.0 + share * problem_random_normal(&random);
            }
        }
        solve_blocks(&blocks, NULL, NULL, &got);
        if (got.info.stop != TRIBO_STOP_TOLERANCE) {
            print_message("# %u, asymmetry %.3g: stop %u eta %.3g\n", (unsigned)i, share,
                          (unsigned)got.info.stop, got.info.eta);
        }
        release(&got);
        systems_free_blocks(&blocks);
        systems_free(&scene);
    }
}

/* ---- options
 * ---------------------------------------------------------------------------------
 */

typedef struct watch {
    double now;
    double tick;
    unsigned calls;
    unsigned stop_after;
    tribo_system_info last;
} watch;

static double tick(void *user)
{
    watch *self = user;
    self->now += self->tick;
    return self->now;
}

static uint32_t look(void *user, const tribo_system_info *info)
{
    watch *self = user;
    assert_int_equal(info->struct_size, sizeof *info);
    self->calls++;
    self->last = *info;
    return self->calls >= self->stop_after;
}

static void test_stops(void **state)
{
    (void)state;
    for (uint32_t solver = 0; solver < 3; solver++) {
        systems_scene scene;
        solution got;
        tribo_system_options options = defaults();
        watch w = {100.0, 1.0, 0, UINT32_MAX, {0}};
        systems_tower(&scene, 20, SYSTEMS_TOP, 1000.0, 0.5);
        options.solver = solver;
        options.tolerance = 1e-13;
        options.max_iterations = 1;
        solve(&scene, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_ITERATIONS);
        assert_true(got.info.sweeps <= 1 && got.info.steps <= 1);
        release(&got);
        options.max_iterations = 0;
        options.max_seconds = 3.0;
        options.clock = tick;
        options.user = &w;
        solve(&scene, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TIME);
        assert_true(got.info.seconds >= 3.0 && got.info.seconds <= 8.0);
        assert_true(w.now > 100.0);
        release(&got);
        options.max_seconds = 0.0;
        options.progress = look;
        w.stop_after = 2;
        solve(&scene, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_CANCEL);
        assert_int_equal(w.calls, 2);
        assert_true(got.info.eta <= w.last.eta || w.last.eta == 0.0);
        release(&got);
        systems_free(&scene);
    }
}

/* An island that takes all the time that there is keeps no smaller one waiting. */
static void test_time_is_shared(void **state)
{
    systems_scene scene;
    systems_scene small;
    solution alone;
    solution got;
    tribo_system_options options = defaults();
    watch w = {0.0, 1.0, 0, UINT32_MAX, {0}};
    (void)state;
    options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    options.tolerance = 1e-13;
    systems_tower(&scene, 20, SYSTEMS_TOP, 1000.0, 0.5);
    systems_tower(&small, 2, SYSTEMS_TOP, 1.0, 0.5);
    solve(&small, &options, NULL, &alone);
    assert_int_equal(alone.info.stop, TRIBO_STOP_TOLERANCE);
    const size_t before = scene.count;
    systems_append(&scene, &small);
    options.clock = tick;
    options.user = &w;
    options.max_seconds = 40.0;
    solve(&scene, &options, NULL, &got);
    assert_int_equal(got.info.stop, TRIBO_STOP_TIME);
    assert_memory_equal(got.impulses + 3 * before, alone.impulses,
                        3 * small.count * sizeof *alone.impulses);
    release(&got);
    release(&alone);
    systems_free(&small);
    systems_free(&scene);
}

/* No solver gives back less than it was given. */
static void test_best_iterate_is_returned(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < problem_count(36); i++) {
        systems_scene scene;
        solution start;
        solution got;
        tribo_system_options options = defaults();
        draw_scene(&scene, i);
        if (has_restitution(&scene)) {
            systems_free(&scene);
            continue;
        }
        options.measure = TRIBO_MEASURE_INVARIANT;
        options.tolerance = i % 2 == 0 ? 1e-3 : 1e-9;
        solve(&scene, &options, NULL, &start);
        options.tolerance = 1e-300;
        options.warm_start = 1;
        options.max_iterations = 1 + i / 6;
        options.solver = (uint32_t)(i % 3);
        solve(&scene, &options, start.impulses, &got);
        /* impulses may be put back into the cone, which is rounding */
        const double bound = start.info.invariant * (1.0 + 1e-9) + 1e-14;
        assert_true(got.info.invariant <= bound);
        release(&start);
        release(&got);
        systems_free(&scene);
    }
}

static void test_measures(void **state)
{
    static const double tolerances[] = {1e-2, 1e-4, 1e-8, 1e-11};
    (void)state;
    for (size_t i = 0; i < sizeof tolerances / sizeof tolerances[0]; i++) {
        for (uint32_t measure = 0; measure < 2; measure++) {
            systems_scene scene;
            solution got;
            tribo_system_options options = defaults();
            options.measure = measure;
            options.tolerance = tolerances[i];
            systems_wall(&scene, 3, 4, 5);
            solve(&scene, &options, NULL, &got);
            assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
            const double reached = measure == TRIBO_MEASURE_ETA ? got.info.eta : got.info.invariant;
            assert_true(reached <= tolerances[i]);
            release(&got);
            systems_free(&scene);
        }
    }
}

/* ---- a user's linear solver
 * ------------------------------------------------------------------ */

typedef struct elimination {
    uint32_t n;
    double *matrix;
    unsigned factors;
    unsigned solves;
    tribo_status answer;
} elimination;

static tribo_status eliminate(void *context, uint32_t n, const uint32_t *row_starts,
                              const uint32_t *columns, const double *values, uint32_t symmetric)
{
    elimination *self = context;
    self->factors++;
    if (self->answer != TRIBO_OK) {
        return self->answer;
    }
    free(self->matrix);
    self->n = n;
    self->matrix = calloc((size_t)n * n + 1, sizeof(double));
    assert_non_null(self->matrix);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = row_starts[i]; k < row_starts[i + 1]; k++) {
            const uint32_t j = columns[k];
            assert_true(j < n && (!symmetric || j <= i));
            assert_true(k == row_starts[i] || columns[k - 1] < j);
            assert_true(isfinite(values[k]));
            self->matrix[(size_t)i * n + j] = values[k];
            if (symmetric) {
                self->matrix[(size_t)j * n + i] = values[k];
            }
        }
    }
    return TRIBO_OK;
}

/* Gauss-Jordan with row exchanges, anew for each right-hand side. */
static tribo_status substitute(void *context, double *x)
{
    elimination *self = context;
    const size_t n = self->n;
    double *a = allocate(n * n * sizeof *a);
    self->solves++;
    memcpy(a, self->matrix, n * n * sizeof *a);
    for (size_t i = 0; i < n; i++) {
        size_t pivot = i;
        for (size_t k = i + 1; k < n; k++) {
            pivot = fabs(a[k * n + i]) > fabs(a[pivot * n + i]) ? k : pivot;
        }
        for (size_t j = 0; j < n; j++) {
            const double kept = a[i * n + j];
            a[i * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }
        const double kept = x[i];
        x[i] = x[pivot];
        x[pivot] = kept;
        if (a[i * n + i] == 0.0) {
            free(a);
            return TRIBO_ERROR_CONTACT_MATRIX;
        }
        for (size_t k = 0; k < n; k++) {
            const double factor = k == i ? 0.0 : a[k * n + i] / a[i * n + i];
            for (size_t j = i; j < n && factor != 0.0; j++) {
                a[k * n + j] -= factor * a[i * n + j];
            }
            x[k] -= factor * x[i];
        }
    }
    for (size_t i = 0; i < n; i++) {
        x[i] /= a[i * n + i];
    }
    free(a);
    return TRIBO_OK;
}

static void test_user_linear_solver(void **state)
{
    elimination mine = {0, NULL, 0, 0, TRIBO_OK};
    tribo_linear linear = {sizeof linear, 0, &mine, eliminate, substitute, NULL};
    (void)state;
    for (uint64_t i = 0; i < 4; i++) {
        systems_scene scene;
        systems_blocks blocks;
        solution got;
        tribo_system_options options = defaults();
        options.linear = &linear;
        options.solver = TRIBO_SOLVER_NEWTON;
        options.dense_limit = 1;
        linear.struct_size = i % 2 ? (uint32_t)offsetof(tribo_linear, sign) : sizeof linear;
        draw_scene(&scene, i);
        solve(&scene, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(mine.factors > 0 && mine.solves > 0);
        assert_true(got.info.factorizations == mine.factors);
        mine.factors = 0;
        release(&got);
        systems_assemble(&scene, &blocks);
        solve_blocks(&blocks, NULL, &options, &got);
        assert_true(mine.factors > 0);
        release(&got);
        /* what it reports comes back, and nothing is touched */
        mine.answer = TRIBO_ERROR_MEMORY;
        solve_only(&scene, &options, NULL, &got);
        assert_int_equal(got.status, TRIBO_ERROR_MEMORY);
        for (size_t k = 0; k < 3 * got.count * sizeof(double); k++) {
            assert_int_equal(((unsigned char *)got.impulses)[k], 0xa5);
        }
        mine.answer = TRIBO_OK;
        mine.factors = 0;
        release(&got);
        systems_free_blocks(&blocks);
        systems_free(&scene);
    }
    free(mine.matrix);
}

/* ---- nothing, and bad input
 * ------------------------------------------------------------------ */

static void test_nothing_to_do(void **state)
{
    systems_scene scene;
    solution got;
    size_t size = 77;
    tribo_system_info info;
    (void)state;
    memset(&scene, 0, sizeof scene);
    solve_well(&scene, &got);
    assert_true(got.info.eta == 0.0 && got.info.energy == 0.0 && got.info.components == 0);
    release(&got);
    systems_tower(&scene, 3, SYSTEMS_TOP, 1.0, 0.5);
    scene.count = 0;
    solve_well(&scene, &got);
    for (size_t i = 0; i < 3; i++) {
        assert_true(same(got.velocities + 6 * i, scene.bodies[i].velocity, 3));
    }
    release(&got);
    systems_free(&scene);
    assert_int_equal(tribo_system_workspace_size(0, 0, NULL, NULL, &size), TRIBO_OK);
    void *memory = allocate(size);
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    assert_int_equal(tribo_system_solve(0, NULL, 0, NULL, NULL, memory, size, NULL, NULL, &info),
                     TRIBO_OK);
    free(memory);
    assert_int_equal(tribo_system_assembled_workspace_size(0, NULL, NULL, NULL, &size), TRIBO_OK);
    memory = allocate(size);
    assert_int_equal(tribo_system_solve_assembled(0, NULL, NULL, NULL, NULL, NULL, NULL, memory,
                                                  size, NULL, NULL, &info),
                     TRIBO_OK);
    free(memory);
    assert_int_equal(tribo_system_apply(0, NULL, NULL), TRIBO_OK);
    /* contacts that open: no impulse, not a bit of velocity */
    systems_tower(&scene, 3, SYSTEMS_TOP, 1.0, 0.5);
    const double rise[3] = {0.0, 0.0, 1.0};
    systems_accelerate(&scene, rise);
    for (size_t i = 0; i < 3; i++) {
        scene.bodies[i].velocity[2] += (double)i;
    }
    solve_well(&scene, &got);
    assert_true(size_of(got.impulses, 3 * got.count) == 0.0);
    for (size_t i = 0; i < 3; i++) {
        assert_true(same(got.velocities + 6 * i, scene.bodies[i].velocity, 3));
    }
    release(&got);
    systems_free(&scene);
}

/* A call whose outputs are all canaries, and must be afterwards. */
typedef struct call {
    systems_scene scene;
    tribo_system_options options;
    const tribo_system_options *use_options;
    void *workspace;
    size_t size;
    double impulses[3 * 64];
    double velocities[6 * 16];
    tribo_system_info info;
    double *use_impulses;
    tribo_system_info *use_info;
} call;

static void prepare(call *c)
{
    memset(c, 0, sizeof *c);
    systems_tower(&c->scene, 3, SYSTEMS_TOP, 2.0, 0.5);
    c->options = defaults();
    c->use_options = &c->options;
    assert_int_equal(tribo_system_workspace_size(c->scene.body_count, c->scene.count,
                                                 c->scene.contacts, NULL, &c->size),
                     TRIBO_OK);
    c->workspace = allocate(c->size);
    memset(c->impulses, 0xa5, sizeof c->impulses);
    memset(c->velocities, 0xa5, sizeof c->velocities);
    memset(&c->info, 0xa5, sizeof c->info);
    c->info.struct_size = sizeof c->info;
    c->use_impulses = c->impulses;
    c->use_info = &c->info;
}

static void expect(call *c, tribo_status want)
{
    const call before = *c;
    const tribo_status got = tribo_system_solve(
        c->scene.body_count, c->scene.bodies, c->scene.count, c->scene.contacts, c->use_options,
        c->workspace, c->size, c->use_impulses, c->velocities, c->use_info);
    if (got != want) {
        print_message("# %s, not %s\n", tribo_status_name(got), tribo_status_name(want));
    }
    assert_int_equal(got, want);
    assert_memory_equal(c->impulses, before.impulses, sizeof c->impulses);
    assert_memory_equal(c->velocities, before.velocities, sizeof c->velocities);
    assert_memory_equal(&c->info, &before.info, sizeof c->info);
    free(c->workspace);
    systems_free(&c->scene);
    prepare(c);
}

static void test_bad_calls(void **state)
{
    call c;
    (void)state;
    prepare(&c);
    /* pointers */
    tribo_body *bodies = c.scene.bodies;
    c.scene.bodies = NULL;
    free(bodies);
    expect(&c, TRIBO_ERROR_NULL);
    free(c.scene.contacts);
    c.scene.contacts = NULL;
    expect(&c, TRIBO_ERROR_NULL);
    c.use_impulses = NULL;
    expect(&c, TRIBO_ERROR_NULL);
    free(c.workspace);
    c.workspace = NULL;
    expect(&c, TRIBO_ERROR_NULL);
    /* struct sizes */
    static const uint32_t sizes[] = {0, 3, UINT32_MAX, sizeof(tribo_system_options) + 8};
    for (size_t i = 0; i < 4; i++) {
        c.options.struct_size = sizes[i];
        expect(&c, TRIBO_ERROR_STRUCT_SIZE);
        c.info.struct_size = i < 3 ? sizes[i] : (uint32_t)sizeof(tribo_system_info) + 8;
        expect(&c, TRIBO_ERROR_STRUCT_SIZE);
        tribo_linear linear = {sizeof linear, 0, NULL, eliminate, substitute, NULL};
        linear.struct_size = i < 3 ? sizes[i] : (uint32_t)sizeof linear + 8;
        c.options.linear = &linear;
        expect(&c, TRIBO_ERROR_STRUCT_SIZE);
    }
    tribo_linear half = {sizeof half - 4, 0, NULL, eliminate, substitute, NULL};
    c.options.linear = &half; /* of the pointer to sign */
    expect(&c, TRIBO_ERROR_STRUCT_SIZE);
    tribo_linear no_factor = {sizeof no_factor, 0, NULL, NULL, substitute, NULL};
    c.options.linear = &no_factor;
    expect(&c, TRIBO_ERROR_NULL);
    tribo_linear no_solve = {sizeof no_solve, 0, NULL, eliminate, NULL, NULL};
    c.options.linear = &no_solve;
    expect(&c, TRIBO_ERROR_NULL);
    /* options */
    c.options.solver = 3;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.measure = 2;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.isa = 5;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.warm_start = 2;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.reserved = 1;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.tolerance = -1e-9;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.tolerance = NOT_A_NUMBER;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.max_seconds = -1.0;
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.max_seconds = 1.0; /* by no clock */
    expect(&c, TRIBO_ERROR_OPTION);
    c.options.max_seconds = NOT_A_NUMBER;
    expect(&c, TRIBO_ERROR_OPTION);
    for (uint32_t isa = 0; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        if (!tribo_isa_available(isa)) {
            c.options.isa = isa;
            expect(&c, TRIBO_ERROR_ISA);
        }
    }
    /* workspace */
    c.size--;
    expect(&c, TRIBO_ERROR_CAPACITY);
    free(c.workspace);
    systems_free(&c.scene);
}

static void test_bad_contacts_and_bodies(void **state)
{
    static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    call c;
    (void)state;
    prepare(&c);
    c.scene.contacts[5].a = 3;
    expect(&c, TRIBO_ERROR_INDEX);
    c.scene.contacts[5].b = TRIBO_WORLD - 1;
    expect(&c, TRIBO_ERROR_INDEX);
    c.scene.contacts[5].b = c.scene.contacts[5].a;
    expect(&c, TRIBO_ERROR_ALIAS);
    c.scene.contacts[5].a = c.scene.contacts[5].b = TRIBO_WORLD;
    expect(&c, TRIBO_ERROR_IMMOVABLE);
    c.scene.contacts[5].dimension = 2;
    expect(&c, TRIBO_ERROR_OPTION);
    c.scene.contacts[5].dimension = 0;
    expect(&c, TRIBO_ERROR_OPTION);
    c.scene.contacts[5].reserved = 1;
    expect(&c, TRIBO_ERROR_OPTION);
    c.scene.contacts[5].contact.normal[0] = 1e-3;
    expect(&c, TRIBO_ERROR_NORMAL);
    c.scene.contacts[5].pair.mu_d = 0.6;
    expect(&c, TRIBO_ERROR_FRICTION);
    c.scene.contacts[5].pair.mu_d = -0.1;
    expect(&c, TRIBO_ERROR_FRICTION);
    c.scene.contacts[5].pair.e = 1.1;
    expect(&c, TRIBO_ERROR_RESTITUTION);
    for (size_t i = 0; i < 3; i++) {
        c.scene.contacts[5].contact.normal[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.contacts[5].contact.arm_a[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.contacts[5].contact.arm_b[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.contacts[5].target[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.contacts[5].pair.mu_s = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.contacts[5].pair.e = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.bodies[1].velocity[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.bodies[1].angular_velocity[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.bodies[1].position[i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.scene.bodies[1].inverse_inertia[2 * i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
        c.options.warm_start = 1;
        memset(c.impulses, 0, sizeof c.impulses);
        c.impulses[7 + i] = bad[i];
        expect(&c, TRIBO_ERROR_NOT_FINITE);
    }
    c.scene.bodies[1].inverse_mass = -1.0;
    expect(&c, TRIBO_ERROR_MASS);
    c.scene.bodies[1].orientation[0] = 1.1;
    expect(&c, TRIBO_ERROR_ORIENTATION);
    c.scene.bodies[1].inverse_inertia[0] = -1.0;
    expect(&c, TRIBO_ERROR_INERTIA);
    tribo_body_init(&c.scene.bodies[0]);
    expect(&c, TRIBO_ERROR_IMMOVABLE);
    c.scene.bodies[1].velocity[0] = 1e308;
    c.scene.bodies[0].velocity[0] = -1e308;
    expect(&c, TRIBO_ERROR_RANGE);
    free(c.workspace);
    systems_free(&c.scene);
}

/* Sizes are judged like solves, and refused sizes leave nothing behind. */
static void test_bad_sizes(void **state)
{
    systems_scene scene;
    size_t size = 77;
    tribo_system_options options = defaults();
    (void)state;
    systems_tower(&scene, 3, SYSTEMS_TOP, 1.0, 0.5);
    const size_t n = scene.count;
    assert_int_equal(tribo_system_workspace_size(3, n, scene.contacts, NULL, NULL),
                     TRIBO_ERROR_NULL);
    assert_int_equal(tribo_system_workspace_size(3, n, NULL, NULL, &size), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_system_workspace_size(2, n, scene.contacts, NULL, &size),
                     TRIBO_ERROR_INDEX);
    options.struct_size = 1;
    assert_int_equal(tribo_system_workspace_size(3, n, scene.contacts, &options, &size),
                     TRIBO_ERROR_STRUCT_SIZE);
    options = defaults();
    options.solver = 9;
    assert_int_equal(tribo_system_workspace_size(3, n, scene.contacts, &options, &size),
                     TRIBO_ERROR_OPTION);
    assert_int_equal(tribo_system_workspace_size((size_t)1 << 32, 0, scene.contacts, NULL, &size),
                     TRIBO_ERROR_CAPACITY);
    assert_int_equal(tribo_system_workspace_size(3, SIZE_MAX / 8, scene.contacts, NULL, &size),
                     TRIBO_ERROR_CAPACITY);
    assert_int_equal(size, 77);
    systems_free(&scene);
}

static void test_bad_assembled(void **state)
{
    static const uint32_t starts[][4] = {{1, 3, 6, 8}, {0, 3, 2, 8}, {0, 2, 5, 7},
                                         {0, 2, 5, 7}, {0, 2, 5, 7}, {0, 2, 5, 7}};
    /* a good pattern: 0 1 | 0 1 2 | 1 2; and an unsorted one, one without a
   * diagonal, one beyond */
    static const uint32_t columns[][8] = {{0, 1, 0, 1, 2, 1, 2, 2}, {0, 1, 0, 1, 2, 1, 2, 2},
                                          {1, 0, 0, 1, 2, 1, 2, 0}, {0, 1, 0, 2, 2, 1, 2, 0},
                                          {0, 1, 0, 1, 2, 0, 1, 0}, {0, 3, 0, 1, 2, 1, 2, 0}};
    static const uint32_t good_starts[4] = {0, 2, 5, 7};
    static const uint32_t good_columns[7] = {0, 1, 0, 1, 2, 1, 2};
    double blocks[9 * 8] = {0};
    double q[9] = {-1, 0, 0, -1, 0, 0, -1, 0, 0};
    double mu[6] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    double impulses[9];
    double before[9];
    size_t size = 0;
    (void)state;
    memset(impulses, 0xa5, sizeof impulses);
    memcpy(before, impulses, sizeof before);
    for (size_t k = 0; k < 7; k++) {
        const int diagonal = k == 0 || k == 3 || k == 6;
        blocks[9 * k] = blocks[9 * k + 4] = blocks[9 * k + 8] = diagonal ? 2.0 : -0.5;
    }
    assert_int_equal(
        tribo_system_assembled_workspace_size(3, good_starts, good_columns, NULL, &size), TRIBO_OK);
    double *memory = allocate(2 * size + 8);
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        size_t other = 77;
        assert_int_equal(
            tribo_system_assembled_workspace_size(3, starts[i], columns[i], NULL, &other),
            TRIBO_ERROR_INDEX);
        assert_int_equal(other, 77);
        assert_int_equal(tribo_system_solve_assembled(3, starts[i], columns[i], blocks, q, mu, NULL,
                                                      memory, 2 * size, impulses, NULL, NULL),
                         TRIBO_ERROR_INDEX);
    }
#define EXPECT(want)                                                                           \
    assert_int_equal(tribo_system_solve_assembled(3, good_starts, good_columns, blocks, q, mu, \
                                                  NULL, memory, size, impulses, NULL, NULL),   \
                     (want));                                                                  \
    assert_memory_equal(impulses, before, sizeof before)
    assert_int_equal(tribo_system_solve_assembled(3, good_starts, NULL, blocks, q, mu, NULL, memory,
                                                  size, impulses, NULL, NULL),
                     TRIBO_ERROR_NULL);
    assert_int_equal(tribo_system_solve_assembled(3, good_starts, good_columns, NULL, q, mu, NULL,
                                                  memory, size, impulses, NULL, NULL),
                     TRIBO_ERROR_NULL);
    assert_int_equal(tribo_system_solve_assembled(3, good_starts, good_columns, blocks, q, mu, NULL,
                                                  memory, size - 1, impulses, NULL, NULL),
                     TRIBO_ERROR_CAPACITY);
    blocks[9] = NOT_A_NUMBER;
    EXPECT(TRIBO_ERROR_NOT_FINITE);
    blocks[9] = -0.5;
    q[4] = INFINITE;
    EXPECT(TRIBO_ERROR_NOT_FINITE);
    q[4] = 0.0;
    mu[3] = 0.6;
    EXPECT(TRIBO_ERROR_FRICTION);
    mu[3] = -0.5;
    EXPECT(TRIBO_ERROR_FRICTION);
    mu[3] = 0.5;
    blocks[27] = 0.0;
    EXPECT(TRIBO_ERROR_IMMOVABLE);
    blocks[27] = 2.0;
    blocks[27 + 4] = -1.0;
    EXPECT(TRIBO_ERROR_CONTACT_MATRIX);
    blocks[27 + 4] = 2.0;
    blocks[27 + 1] = blocks[27 + 3] = 3.0;
    EXPECT(TRIBO_ERROR_CONTACT_MATRIX);
#undef EXPECT
    free(memory);
}

/* Options and infos of callers that know less. */
static void test_older_structs(void **state)
{
    systems_scene scene;
    size_t size = 0;
    solution want;
    (void)state;
    systems_tower(&scene, 3, SYSTEMS_TOP, 1.0, 0.5);
    solve_well(&scene, &want);
    assert_int_equal(
        tribo_system_workspace_size(scene.body_count, scene.count, scene.contacts, NULL, &size),
        TRIBO_OK);
    void *memory = allocate(size);
    double *impulses = allocate(3 * scene.count * sizeof *impulses);
    for (uint32_t bytes = 8; bytes <= sizeof(tribo_system_info); bytes += 8) {
        tribo_system_info info;
        memset(&info, 0xa5, sizeof info);
        info.struct_size = bytes;
        assert_int_equal(tribo_system_solve(scene.body_count, scene.bodies, scene.count,
                                            scene.contacts, NULL, memory, size, impulses, NULL,
                                            &info),
                         TRIBO_OK);
        assert_true(same(impulses, want.impulses, 3 * scene.count));
        assert_int_equal(info.struct_size, bytes);
        for (size_t k = bytes; k < sizeof info; k++) {
            assert_int_equal(((unsigned char *)&info)[k], 0xa5);
        }
    }
    for (uint32_t bytes = 8; bytes < sizeof(tribo_system_options); bytes += 8) {
        tribo_system_options options;
        memset(&options, 0xff, sizeof options);
        memset(&options, 0, bytes);
        options.struct_size = bytes;
        assert_int_equal(tribo_system_solve(scene.body_count, scene.bodies, scene.count,
                                            scene.contacts, &options, memory, size, impulses, NULL,
                                            NULL),
                         TRIBO_OK);
        assert_true(same(impulses, want.impulses, 3 * scene.count));
    }
    free(memory);
    free(impulses);
    release(&want);
    systems_free(&scene);
}

/* Who asks for eta alone is told the same, and given the same velocities, as who asks for all. */
static void expect_brief(const systems_scene *scene, const tribo_system_options *options)
{
    const uint32_t bytes = offsetof(tribo_system_info, eta_rms);
    solution want;
    tribo_system_info info = {.struct_size = bytes};
    solve_only(scene, options, NULL, &want);
    assert_int_equal(want.status, TRIBO_OK);
    void *memory = allocate(want.workspace);
    double *impulses = allocate(3 * scene->count * sizeof *impulses);
    double *velocities = allocate(6 * scene->body_count * sizeof *velocities);
    memset(velocities, 0xa5, 6 * scene->body_count * sizeof *velocities);
    assert_int_equal(tribo_system_solve(scene->body_count, scene->bodies, scene->count,
                                        scene->contacts, options, memory, want.workspace, impulses,
                                        velocities, &info),
                     TRIBO_OK);
    want.info.struct_size = bytes;
    assert_memory_equal(&info, &want.info, bytes);
    assert_true(same(impulses, want.impulses, 3 * scene->count));
    assert_true(same(velocities, want.velocities, 6 * scene->body_count));
    free(memory);
    free(impulses);
    free(velocities);
    release(&want);
}

static void test_eta_alone(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 600; i++) {
        const uint32_t sweeps[] = {1, 4, 13, 60, 0};
        const tribo_system_options options = {.struct_size = sizeof options,
                                              .max_iterations = sweeps[i % 5],
                                              .solver = (uint32_t)(i / 5 % 3),
                                              .measure = i % 7 == 0 ? TRIBO_MEASURE_INVARIANT
                                                                    : TRIBO_MEASURE_ETA,
                                              .tolerance = i % 2 == 0 ? 1e-3 : 1e-10};
        systems_scene scene;
        /* Few contacts for many bodies: several components, some of them of one contact or none. */
        systems_random(&scene, 8, 1 + i % 9, (uint32_t)(i * 37) & SYSTEMS_ALL, i);
        expect_brief(&scene, &options);
        systems_free(&scene);
    }
}

static void test_apply(void **state)
{
    systems_scene scene;
    systems_scene before;
    double velocities[18];
    (void)state;
    systems_tower(&scene, 3, SYSTEMS_TOP, 1.0, 0.5);
    systems_copy(&scene, &before);
    for (size_t i = 0; i < 18; i++) {
        velocities[i] = (double)i;
    }
    assert_int_equal(tribo_system_apply(3, NULL, velocities), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_system_apply(3, scene.bodies, NULL), TRIBO_ERROR_NULL);
    velocities[17] = NOT_A_NUMBER;
    assert_int_equal(tribo_system_apply(3, scene.bodies, velocities), TRIBO_ERROR_NOT_FINITE);
    assert_memory_equal(scene.bodies, before.bodies, 3 * sizeof *scene.bodies);
    velocities[17] = 17.0;
    assert_int_equal(tribo_system_apply(3, scene.bodies, velocities), TRIBO_OK);
    for (size_t i = 0; i < 3; i++) {
        assert_true(same(scene.bodies[i].velocity, velocities + 6 * i, 3));
        assert_true(same(scene.bodies[i].angular_velocity, velocities + 6 * i + 3, 3));
        assert_true(same(scene.bodies[i].position, before.bodies[i].position, 7));
        assert_true(same(&scene.bodies[i].inverse_mass, &before.bodies[i].inverse_mass, 7));
    }
    systems_free(&scene);
    systems_free(&before);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fresh, tell)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_one_contact_is_the_exact_solve),
        TEST(test_one_block_is_the_exact_solve),
        TEST(test_stacks_carry_their_weight),
        TEST(test_slopes),
        TEST(test_thresholds_of_rest),
        TEST(test_rocking_and_rolling),
        TEST(test_balls_in_a_row),
        TEST(test_breaks),
        TEST(test_restitution),
        TEST(test_random_systems),
        TEST(test_powers_of_two),
        TEST(test_no_bit_depends_on_how_it_is_run),
        TEST(test_large_systems_run_in_parallel),
        TEST(test_permutations),
        TEST(test_duplicates_change_no_velocity),
        TEST(test_islands),
        TEST(test_warm_starts),
        TEST(test_one_row_contacts),
        TEST(test_static_above_dynamic_friction),
        TEST(test_targets),
        TEST(test_jams),
        TEST(test_assembled_and_bodies_agree),
        TEST(test_unsymmetric_matrices),
        TEST(test_stops),
        TEST(test_time_is_shared),
        TEST(test_best_iterate_is_returned),
        TEST(test_measures),
        TEST(test_user_linear_solver),
        TEST(test_nothing_to_do),
        TEST(test_bad_calls),
        TEST(test_bad_contacts_and_bodies),
        TEST(test_bad_sizes),
        TEST(test_bad_assembled),
        TEST(test_older_structs),
        TEST(test_eta_alone),
        TEST(test_apply),
    };
    return cmocka_run_group_tests_name("system", tests, NULL, NULL);
}
