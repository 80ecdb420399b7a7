/* Gauss-Seidel sweeps by themselves (src/sweep.h): exact rates, the same bits in lanes and tasks,
 * and each contact against the exact solve of one. */
#include "sweep.h"
#include "coupled.h"
#include "quad_system.h"

#include "check.h"

#include <stdlib.h>

/* ---- running sweeps -------------------------------------------------------------------------- */

/* A problem with its sweeps, impulses and velocities. */
typedef struct trial {
    coupled coupled;
    sweep *sweep;
    void *memory;
    double *r, *v;
    double change;
    size_t count, bodies;
} trial;

static void *zeros(size_t count)
{
    void *memory = calloc(count + 1, sizeof(double));
    assert_non_null(memory);
    return memory;
}

static void set_up(trial *t, uint32_t isa)
{
    const system_problem *p = &t->coupled.problem;
    t->count = p->count;
    t->bodies = p->bodies;
    t->memory = malloc(sweep_size(p->count, p->bodies, 0));
    assert_non_null(t->memory);
    t->sweep = sweep_prepare(p, isa, t->memory);
    t->r = zeros(3 * t->count);
    t->v = zeros(6 * t->bodies);
    memcpy(t->v, t->coupled.free_velocity, 6 * t->bodies * sizeof *t->v);
}

static void open_scene(const systems_scene *scene, uint32_t isa, trial *t)
{
    coupled_of_scene(scene, &t->coupled);
    set_up(t, isa);
}

static void close_trial(trial *t)
{
    coupled_free(&t->coupled);
    free(t->memory);
    free(t->r);
    free(t->v);
}

static void run(trial *t, uint32_t sweeps)
{
    t->change = sweep_run(t->sweep, sweeps, t->r, t->v, NULL, NULL, 1);
}

/* Bodies of these masses on each other, one contact in the middle of each face. */
static void make_stack(systems_scene *out, size_t n, const double *masses, uint32_t dimension)
{
    const double half[3] = {0.5, 0.5, 0.5};
    const double up[3] = {0.0, 0.0, 1.0};
    const double fall[3] = {0.0, 0.0, -SYSTEMS_FALL};
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < n; i++) {
        const double centre[3] = {0.0, 0.0, 0.5 + (double)i};
        const double foot[3] = {0.0, 0.0, (double)i};
        const uint32_t own = systems_add_box(out, half, masses[i], centre);
        systems_add_contact(out, own, own == 0 ? TRIBO_WORLD : own - 1, foot, up, 0.5)->dimension =
            dimension;
    }
    systems_accelerate(out, fall);
}

/* ---- exact rates ----------------------------------------------------------------------------- */

/* Error of the impulses: each carries the weight of all above it. */
static double stack_error(const trial *t, size_t n, const double *masses)
{
    double weight = 0.0;
    double square = 0.0;
    for (size_t i = n; i-- > 0;) {
        weight += SYSTEMS_FALL * masses[i];
        square += (t->r[3 * i] - weight) * (t->r[3 * i] - weight);
    }
    return sqrt(square);
}

/* Ratio of the errors after `sweeps` sweeps and one more. */
static double measure_rate(size_t n, const double *masses, uint32_t dimension, uint32_t sweeps)
{
    systems_scene scene;
    trial t;
    make_stack(&scene, n, masses, dimension);
    open_scene(&scene, TRIBO_ISA_BEST, &t);
    run(&t, sweeps);
    const double before = stack_error(&t, n, masses);
    run(&t, 1);
    const double rate = stack_error(&t, n, masses) / before;
    close_trial(&t);
    systems_free(&scene);
    return rate;
}

static void test_rate_of_two(void **state)
{
    static const double ratios[] = {0.01, 1.0, 10.0, 1e3, 1e6};
    (void)state;
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios; i++) {
        const double masses[2] = {1.0, ratios[i]};
        const double exact = ratios[i] / (1.0 + ratios[i]);
        const uint32_t sweeps = ratios[i] < 1.0 ? 1 : 10;
        within(fabs(measure_rate(2, masses, 1, sweeps) - exact), 1e-9 * exact);
        within(fabs(measure_rate(2, masses, 3, sweeps) - exact), 1e-9 * exact);
    }
    settle("rate m2 / (m1 + m2) of two bodies");
}

/* The colours sweep every other contact first. Rows and columns of W may be signed and sorted so
 * that it is consistently ordered, and so the rate is that of the natural order. */
static void test_rate_of_many(void **state)
{
    static const size_t counts[] = {3, 10, 50, 200};
    double masses[200];
    (void)state;
    for (size_t i = 0; i < 200; i++) {
        masses[i] = 1.0;
    }
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const size_t n = counts[i];
        const double root = cos(acos(-1.0) / (2.0 * (double)n));
        const uint32_t sweeps = (uint32_t)(n * n);
        const double one = measure_rate(n, masses, 1, sweeps);
        const double three = measure_rate(n, masses, 3, sweeps);
        print_message("# %zu boxes: rate %.9f, exact %.9f\n", n, three, root * root);
        within(fabs(one - root * root), 1e-6 * (1.0 - root * root));
        within(fabs(three - root * root), 1e-6 * (1.0 - root * root));
    }
    settle("rate cos^2(pi / 2n) of n boxes");
}

/* ---- towers ---------------------------------------------------------------------------------- */

/* Sweeps to an error of Siconos' measure, at most `most`. */
static uint32_t sweeps_to(const systems_scene *scene, double tolerance, uint32_t most)
{
    trial t;
    uint32_t done = 0;
    double error = 1.0;
    open_scene(scene, TRIBO_ISA_BEST, &t);
    while (error > tolerance && done < most) {
        quad_certificate judged;
        const uint32_t step = done / 50 + 1;
        run(&t, step);
        done += step;
        quad_certificate_of_bodies(scene->body_count, scene->bodies, scene->count, scene->contacts,
                                   t.r, t.v, &judged);
        error = judged.siconos;
    }
    close_trial(&t);
    return done;
}

/* Sweeps of a scalar Gauss-Seidel with an exact local solve in natural order: how many it took to
 * 1e-2 and 1e-4. The order of the colours is another, so that the counts are not the same. */
static void test_towers(void **state)
{
    static const struct {
        size_t boxes;
        uint32_t sweeps[2];
    } known[] = {{1, {3, 5}}, {2, {19, 62}}, {5, {35, 1158}}, {10, {93, 6697}}};
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        systems_scene scene;
        uint32_t sweeps[2];
        systems_tower(&scene, known[i].boxes, SYSTEMS_TOP, 1.0, 0.5);
        for (size_t k = 0; k < 2; k++) {
            sweeps[k] = sweeps_to(&scene, k == 0 ? 1e-2 : 1e-4, 20000);
            within(fabs((double)sweeps[k] - (double)known[i].sweeps[k]),
                   0.25 * (double)known[i].sweeps[k]);
        }
        print_message("# tower of %zu: %u sweeps to 1e-2, %u to 1e-4; natural order %u, %u\n",
                      known[i].boxes, sweeps[0], sweeps[1], known[i].sweeps[0], known[i].sweeps[1]);
        systems_free(&scene);
    }
    settle("sweeps on towers, to a quarter those of natural order");
}

/* ---- the same bits --------------------------------------------------------------------------- */

/* Tasks in reverse order, and the most there were at once. */
static uint32_t most_tasks;

static void backwards(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    (void)user;
    most_tasks = count > most_tasks ? count : most_tasks;
    for (uint32_t i = count; i-- > 0;) {
        task(data, i);
    }
}

/* Seeded numbers within [-1, 1]. */
static double draw(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Any impulses within the cones. */
static void start_anywhere(trial *t, uint64_t seed)
{
    const double *mu = t->coupled.problem.mu;
    for (size_t c = 0; c < t->count; c++) {
        t->r[3 * c] = 0.1 + 0.1 * draw(&seed);
        for (size_t k = 1; k < 3; k++) {
            t->r[3 * c + k] = 0.7 * mu[2 * c] * t->r[3 * c] * draw(&seed);
        }
    }
}

/* What every instruction set and number of tasks makes of a scene is what the scalar sweeps make of
 * it. Returns how many comparisons there were. */
static size_t compare_all(const systems_scene *scene, uint32_t sweeps, uint64_t seed)
{
    static const uint32_t tasks[] = {1, 2, 3, 7, 1000};
    trial scalar;
    size_t compared = 0;
    open_scene(scene, TRIBO_ISA_SCALAR, &scalar);
    start_anywhere(&scalar, seed);
    run(&scalar, sweeps);
    for (uint32_t isa = TRIBO_ISA_SCALAR; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        for (size_t i = 0; i < sizeof tasks / sizeof *tasks && tribo_isa_available(isa); i++) {
            trial t;
            open_scene(scene, isa, &t);
            start_anywhere(&t, seed);
            t.change = sweep_run(t.sweep, sweeps, t.r, t.v, backwards, NULL, tasks[i]);
            assert_true(same_bits(t.r, scalar.r, 3 * t.count));
            assert_true(same_bits(t.v, scalar.v, 6 * t.bodies));
            assert_true(same_bits(&t.change, &scalar.change, 1));
            compared++;
            close_trial(&t);
        }
    }
    for (size_t i = 0; i < 3 * scalar.count; i++) {
        assert_true(isfinite(scalar.r[i]));
    }
    close_trial(&scalar);
    return compared;
}

static void test_same_bits(void **state)
{
    size_t compared = 0;
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        systems_scene scene;
        const size_t bodies = 1 + (size_t)(seed % 40);
        systems_random(&scene, bodies, 4 * bodies, SYSTEMS_ALL, seed);
        compared += compare_all(&scene, 1 + (uint32_t)(seed % 5), seed);
        systems_free(&scene);
    }
    print_message("# %zu comparisons\n", compared);
}

/* Scenes large enough for tasks; contacts beyond the colours. */
static void test_same_bits_of_many(void **state)
{
    systems_scene scene;
    (void)state;
    most_tasks = 0;
    systems_rubble(&scene, 13, 7);
    for (size_t c = 0; c < scene.count; c += 3) {
        scene.contacts[c].dimension = c % 2 == 0 ? 1 : 3;
        scene.contacts[c].pair.mu_s *= 1.5;
    }
    compare_all(&scene, 3, 1);
    print_message("# at most %u tasks\n", most_tasks);
    assert_true(most_tasks >= 3);
    systems_free(&scene);
    systems_crowd(&scene, 700, 3);
    compare_all(&scene, 3, 2);
    systems_free(&scene);
}

/* The layout is no part of the result: runs cut in two, another address. */
static void test_runs_add_up(void **state)
{
    systems_scene scene;
    trial whole;
    trial parts;
    (void)state;
    systems_wall(&scene, 8, 6, 5);
    open_scene(&scene, TRIBO_ISA_BEST, &whole);
    open_scene(&scene, TRIBO_ISA_BEST, &parts);
    free(parts.memory);
    parts.memory = malloc(sweep_size((uint32_t)parts.count, (uint32_t)parts.bodies, 0) + 8);
    parts.sweep =
        sweep_prepare(&parts.coupled.problem, TRIBO_ISA_BEST, (unsigned char *)parts.memory + 8);
    run(&whole, 12);
    run(&parts, 5);
    run(&parts, 7);
    within(distance(whole.r, parts.r, 3 * whole.count), 1e-12);
    within(distance(whole.v, parts.v, 6 * whole.bodies), 1e-12);
    settle("runs of 5 and 7 sweeps against 12");
    close_trial(&whole);
    close_trial(&parts);
    systems_free(&scene);
}

/* ---- against the exact solve of one contact -------------------------------------------------- */

static size_t failures; /* of single contacts, in the running test */

/* One sweep in the order of contacts, by the functions of contact.h on assembled blocks. */
static void sweep_by_hand(const systems_blocks *w, double *r)
{
    for (size_t c = 0; c < w->count; c++) {
        double b[3] = {w->q[3 * c], w->q[3 * c + 1], w->q[3 * c + 2]};
        const double *own = NULL;
        for (uint32_t at = w->row_starts[c]; at < w->row_starts[c + 1]; at++) {
            const double *block = w->blocks + 9 * (size_t)at;
            const size_t j = w->columns[at];
            if (j == c) {
                own = block;
                continue;
            }
            for (size_t k = 0; k < 3; k++) {
                b[k] += tribo_vec3_dot(block + 3 * k, r + 3 * j);
            }
        }
        const double *mu = w->mu + 2 * c;
        if (tribo_contact_solve_general(own, b, mu[0], mu[1], r + 3 * c, NULL) != TRIBO_OK) {
            tribo_cone_clamp(r + 3 * c, mu[0], r + 3 * c);
            failures++;
        }
    }
}

static double size_of(const double *r, size_t n)
{
    double square = 0.0;
    for (size_t i = 0; i < n; i++) {
        square += r[i] * r[i];
    }
    return sqrt(square);
}

static const double sweep_tolerance = 1e-12; /* of |r|: rounding times the condition of W_cc */

static void compare_by_hand(const systems_blocks *blocks, trial *t, uint32_t sweeps)
{
    double *r = zeros(3 * blocks->count);
    for (uint32_t n = 0; n < sweeps; n++) {
        sweep_by_hand(blocks, r);
        run(t, 1);
        within(distance(r, t->r, 3 * blocks->count),
               sweep_tolerance * size_of(r, 3 * blocks->count) + DBL_MIN);
    }
    free(r);
}

/* Up to three contacts of a colour and kind are swept in the order of contacts. */
static void test_three_contacts(void **state)
{
    (void)state;
    failures = 0;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        systems_scene scene;
        systems_blocks blocks;
        trial t;
        systems_random(&scene, 3, 3, SYSTEMS_STATIC | SYSTEMS_TWO_FRICTION | SYSTEMS_TARGETS, seed);
        for (size_t c = 0; c < scene.count; c++) {
            tribo_material *pair = &scene.contacts[c].pair;
            scene.contacts[c].dimension = seed % 4 == 0 ? 1 : 3;
            pair->mu_s = pair->mu_s > 0.0 ? pair->mu_s : 0.5;
        }
        systems_assemble(&scene, &blocks);
        open_scene(&scene, TRIBO_ISA_BEST, &t);
        compare_by_hand(&blocks, &t, 4);
        close_trial(&t);
        systems_free_blocks(&blocks);
        systems_free(&scene);
    }
    print_message("# %zu solves failed\n", failures);
    settle("four sweeps over three contacts by bodies");
}

/* Make blocks unsymmetric, as gyroscopic terms do. */
static void skew_blocks(systems_blocks *blocks, double share, uint64_t seed)
{
    for (size_t c = 0; c < blocks->count; c++) {
        for (uint32_t at = blocks->row_starts[c]; at < blocks->row_starts[c + 1]; at++) {
            double *w = blocks->blocks + 9 * (size_t)at;
            const double size = share * fabs(w[0]);
            for (size_t k = 0; k < 9; k++) {
                w[k] += k % 4 == 0 ? 0.0 : size * draw(&seed);
            }
        }
    }
}

static void test_assembled(void **state)
{
    (void)state;
    failures = 0;
    for (uint64_t seed = 0; seed < 600; seed++) {
        const double skews[] = {0.0, 1e-4, 1e-2};
        systems_scene scene;
        systems_blocks blocks;
        systems_random(&scene, 6, 12,
                       SYSTEMS_STATIC | SYSTEMS_ONE_ROW | SYSTEMS_TWO_FRICTION | SYSTEMS_TARGETS,
                       seed);
        systems_assemble(&scene, &blocks);
        skew_blocks(&blocks, skews[seed % 3], seed);
        double *dense = systems_dense(&blocks);
        for (int form = 0; form < 2; form++) {
            trial t;
            coupled_of_blocks(&blocks, form == 0 ? NULL : dense, &t.coupled);
            set_up(&t, TRIBO_ISA_BEST);
            compare_by_hand(&blocks, &t, 4);
            close_trial(&t);
        }
        free(dense);
        systems_free_blocks(&blocks);
        systems_free(&scene);
    }
    print_message("# %zu solves failed\n", failures);
    settle("four sweeps over blocks, sparse and dense");
}

/* ---- where it ends --------------------------------------------------------------------------- */

/* Sweeps go to a solution, and stay there; velocities are those of the impulses. */
static void test_fixed_point(void **state)
{
    size_t solved = 0;
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        systems_scene scene;
        quad_certificate judged;
        trial t;
        systems_random(&scene, 8, 16, SYSTEMS_STATIC | SYSTEMS_ONE_ROW | SYSTEMS_TARGETS, seed);
        open_scene(&scene, TRIBO_ISA_BEST, &t);
        for (int k = 0; k < 400 && (k == 0 || t.change > 1e-15); k++) {
            run(&t, 50);
        }
        quad_certificate_of_bodies(scene.body_count, scene.bodies, scene.count, scene.contacts, t.r,
                                   t.v, &judged);
        within(judged.velocity, 1e-12);
        if (t.change <= 1e-15) {
            within(judged.eta, 1e-12);
            solved++;
        }
        close_trial(&t);
        systems_free(&scene);
    }
    print_message("# %zu of 40 do not change any more\n", solved);
    assert_true(solved >= 20);
    settle("eta and velocities where sweeps do not change anything any more");
}

/* A body that turns about y alone: the contact opens only as it slides, and friction more than
 * undoes what the normal impulse does. */
static void make_jam(systems_scene *out)
{
    const double half[3] = {0.5, 0.5, 0.5};
    const double origin[3] = {0.0, 0.0, 0.0};
    const double point[3] = {1.0, 0.0, -1.0};
    const double up[3] = {0.0, 0.0, 1.0};
    memset(out, 0, sizeof *out);
    const uint32_t body = systems_add_box(out, half, 1.0, origin);
    out->bodies[body].inverse_mass = 0.0;
    out->bodies[body].inverse_inertia[0] = out->bodies[body].inverse_inertia[5] = 0.0;
    tribo_system_contact *contact = systems_add_contact(out, body, TRIBO_WORLD, point, up, 2.0);
    contact->target[0] = 1.0;
}

static void test_jam(void **state)
{
    systems_scene scene;
    trial t;
    double p[3];
    (void)state;
    make_jam(&scene);
    open_scene(&scene, TRIBO_ISA_BEST, &t);
    const double *w = t.coupled.problem.diagonal;
    const double six[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
    assert_int_equal(tribo_contact_solve(six, t.coupled.problem.q, 2.0, 2.0, p, NULL),
                     TRIBO_ERROR_JAM);
    const double held[3] = {0.25, 0.5, 0.0};
    memcpy(t.r, held, sizeof held);
    run(&t, 3);
    assert_true(t.change == 1.0);
    assert_true(same_bits(t.r, held, 3));
    t.r[1] = 5.0;
    run(&t, 1);
    assert_true(fabs(t.r[1] - 0.5) <= 4.0 * EPS && t.r[0] == 0.25);
    close_trial(&t);
    systems_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_rate_of_two),
        TEST(test_rate_of_many),
        TEST(test_towers),
        TEST(test_same_bits),
        TEST(test_same_bits_of_many),
        TEST(test_runs_add_up),
        TEST(test_three_contacts),
        TEST(test_assembled),
        TEST(test_fixed_point),
        TEST(test_jam),
    };
    return cmocka_run_group_tests_name("sweep", tests, NULL, NULL);
}
