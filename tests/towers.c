/* Towers, heaps and piles: the load of a standing one is known, and long chains of unequal masses are what solvers
 * of contacts stall on; sliding and spinning ones have no closed form, only a certificate.
 *
 * TRIBO_SLOW=1 in the environment: 1000 sliding towers of each height instead of some. */
#include <tribo/sparse.h>
#include <tribo/system.h>

#include "poured.h"
#include "problems.h"
#include "quad_system.h"
#include "systems.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static void *allocate(size_t size)
{
    void *memory = malloc(size > 0 ? size : 1);
    assert_non_null(memory);
    return memory;
}

static double processor_time(void *user)
{
    (void)user;
    return (double)clock() / (double)CLOCKS_PER_SEC;
}

static tribo_system_options defaults(void)
{
    tribo_system_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.clock = processor_time;
    return options;
}

/* Impulses and velocities of a solve, judged in quad precision. */
typedef struct answer {
    double *impulses;
    double *velocities;
    tribo_system_info info;
    quad_certificate truth;
} answer;

static void release(answer *out)
{
    free(out->impulses);
    free(out->velocities);
}

/* start (may be null): impulses to start from. */
static void solve(const systems_scene *scene, const tribo_system_options *options,
                  const double *start, answer *out)
{
    tribo_system_options with = *options;
    const char *name = "";
    tribo_sparse *sparse = NULL;
    tribo_linear linear;
    size_t size = 0;
    out->impulses = allocate(3 * scene->count * sizeof(double));
    out->velocities = allocate(6 * scene->body_count * sizeof(double));
    memset(&out->info, 0, sizeof out->info);
    out->info.struct_size = sizeof out->info;
    if (start != NULL) {
        memcpy(out->impulses, start, 3 * scene->count * sizeof(double));
        with.warm_start = 1;
    }
    memset(&linear, 0, sizeof linear);
    linear.struct_size = sizeof linear;
    assert_int_equal(tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse), TRIBO_OK);
    assert_int_equal(tribo_sparse_linear(sparse, &linear), TRIBO_OK);
    with.linear = &linear;
    assert_int_equal(
        tribo_system_workspace_size(scene->body_count, scene->count, scene->contacts, &with, &size),
        TRIBO_OK);
    void *workspace = allocate(size);
    assert_int_equal(tribo_system_solve(scene->body_count, scene->bodies, scene->count,
                                        scene->contacts, &with, workspace, size, out->impulses,
                                        out->velocities, &out->info),
                     TRIBO_OK);
    free(workspace);
    tribo_sparse_destroy(sparse);
    quad_certificate_of_bodies(scene->body_count, scene->bodies, scene->count, scene->contacts,
                               out->impulses, out->velocities, &out->truth);
    const double units = quad_certificate_difference(&out->truth, &out->info, &name);
    if (!(units <= 64.0)) {
        print_message("# certificate: %s is %.3g roundings off\n", name, units);
        fail();
    }
}

/* ---- standing towers ------------------------------------------------------------------------- */

/* Greatest relative error of the load of an interface. */
static double load_error(const systems_scene *tower, const double *impulses)
{
    double weight = 0.0;
    double greatest = 0.0;
    for (size_t i = tower->body_count; i-- > 0;) {
        double load = 0.0;
        weight += SYSTEMS_FALL / tower->bodies[i].inverse_mass;
        for (size_t k = 0; k < 4; k++) {
            load += impulses[3 * (4 * i + k)];
        }
        greatest = fmax(greatest, fabs(load - weight) / weight);
    }
    return greatest;
}

/* What is known of all towers of one height and ratio. */
typedef struct worst {
    double load;
    double factorizations;
    double milliseconds;
} worst;

static void stand(size_t boxes, uint32_t masses, double ratio, uint32_t measure, worst *out)
{
    systems_scene tower;
    answer got;
    tribo_system_options options = defaults();
    options.measure = measure;
    options.tolerance = 1e-10;
    if (measure == TRIBO_MEASURE_INVARIANT) {
        /* what double can tell: velocities of light boxes are sums of n loads ratio times as large
         * as the g dt that they are measured against */
        options.tolerance = fmax(1e-10, 4.0 * DBL_EPSILON * ratio * (double)boxes);
    }
    systems_tower(&tower, boxes, masses, ratio, 0.5);
    solve(&tower, &options, NULL, &got);
    const double error = load_error(&tower, got.impulses);
    if (got.info.stop != TRIBO_STOP_TOLERANCE) {
        print_message("# %u boxes, masses %u, ratio %g: stop %u, eta %.2g, invariant %.2g\n",
                      (unsigned)boxes, (unsigned)masses, ratio, (unsigned)got.info.stop,
                      got.truth.eta, got.truth.invariant);
    }
    assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
    assert_true(measure == TRIBO_MEASURE_ETA || error <= 10.0 * (double)boxes * options.tolerance);
    out->load = fmax(out->load, error);
    out->factorizations = fmax(out->factorizations, (double)got.info.factorizations);
    out->milliseconds = fmax(out->milliseconds, 1e3 * got.info.seconds);
    release(&got);
    systems_free(&tower);
}

/* From a cold start to 1e-10 in at most 12 factorisations, whatever the masses. eta is relative to
 * what the loads do to each contact, so that light boxes under heavy ones hide an error of the
 * load; the invariant measure is relative to g dt. */
static void test_standing_towers(void **state)
{
    static const size_t heights[] = {10, 20, 50, 100};
    static const double ratios[] = {1.0, 1e2, 1e4, 1e6};
    (void)state;
    for (size_t i = 0; i < 32; i++) {
        const size_t boxes = heights[i / 8];
        const double ratio = ratios[i / 2 % 4];
        const uint32_t measure = (uint32_t)(i % 2);
        worst most = {0.0, 0.0, 0.0};
        for (uint32_t masses = SYSTEMS_TOP; masses <= SYSTEMS_ALTERNATE; masses++) {
            stand(boxes, masses, ratio, measure, &most);
        }
        print_message("# %u boxes, ratio %g, by %s: at most %g factorisations, %.3g ms, error of "
                      "a load %.2g\n",
                      (unsigned)boxes, ratio, measure == TRIBO_MEASURE_ETA ? "eta" : "invariant",
                      most.factorizations, most.milliseconds, most.load);
        assert_true(most.factorizations <= 12.0);
    }
}

/* 100 000 contacts: rounding of a step grows as alpha falls, and with it the height that is out of
 * reach; a step that rounding spoils raises alpha. */
static void test_tall_towers(void **state)
{
    (void)state;
    for (uint32_t measure = 0; measure < 2; measure++) {
        tribo_system_options options = defaults();
        systems_scene tower;
        answer got;
        options.measure = measure;
        options.tolerance = 1e-8;
        systems_tower(&tower, 25000, SYSTEMS_TOP, 1.0, 0.5);
        solve(&tower, &options, NULL, &got);
        print_message("# 100000 contacts by %s: %g factorisations, %.3g s\n",
                      measure == TRIBO_MEASURE_ETA ? "eta" : "invariant",
                      (double)got.info.factorizations, got.info.seconds);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(got.info.factorizations <= 12);
        release(&got);
        systems_free(&tower);
    }
}

/* A tower at rest that starts from its impulses is done at once. */
static void test_resting_towers_start_warm(void **state)
{
    static const size_t heights[] = {1, 10, 50};
    (void)state;
    for (size_t h = 0; h < 3; h++) {
        for (uint32_t solver = 0; solver < 3; solver++) {
            systems_scene tower;
            answer cold;
            answer warm;
            tribo_system_options options = defaults();
            systems_tower(&tower, heights[h], SYSTEMS_TOP, 1.0, 0.5);
            solve(&tower, &options, NULL, &cold);
            options.solver = solver;
            solve(&tower, &options, cold.impulses, &warm);
            assert_int_equal(warm.info.stop, TRIBO_STOP_TOLERANCE);
            assert_true(warm.info.sweeps + warm.info.steps <= 1);
            release(&cold);
            release(&warm);
            systems_free(&tower);
        }
    }
}

/* ---- rates of Gauss-Seidel ------------------------------------------------------------------- */

/* Boxes on each other with one frictionless contact between two. */
static void chain(systems_scene *out, size_t boxes, double top)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    static const double up[3] = {0.0, 0.0, 1.0};
    static const double fall[3] = {0.0, 0.0, -SYSTEMS_FALL};
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < boxes; i++) {
        const double position[3] = {0.0, 0.0, 0.5 + (double)i};
        const double point[3] = {0.0, 0.0, (double)i};
        const uint32_t box = systems_add_box(out, half, i + 1 == boxes ? top : 1.0, position);
        systems_add_contact(out, box, i == 0 ? TRIBO_WORLD : box - 1, point, up, 0.0)->dimension =
            1;
    }
    systems_accelerate(out, fall);
}

static double chain_error(const systems_scene *scene, const double *impulses)
{
    double weight = 0.0;
    double sum = 0.0;
    for (size_t i = scene->count; i-- > 0;) {
        weight += SYSTEMS_FALL / scene->bodies[i].inverse_mass;
        sum += (impulses[3 * i] - weight) * (impulses[3 * i] - weight);
    }
    return sqrt(sum);
}

/* Error per sweep: cos^2(pi / 2n) for n equal boxes, m2 / (m1 + m2) for two. */
static void test_gauss_seidel_has_its_exact_rate(void **state)
{
    static const struct {
        size_t boxes;
        double top;
        uint64_t first;
        uint64_t more;
    } cases[] = {{2, 1.0, 8, 16},       {2, 10.0, 20, 100},  {2, 1000.0, 100, 4000},
                 {3, 1.0, 20, 40},      {10, 1.0, 400, 300}, {20, 1.0, 1600, 800},
                 {50, 1.0, 10000, 4000}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        systems_scene scene;
        answer early;
        answer late;
        tribo_system_options options = defaults();
        const double pi = 3.14159265358979323846;
        const double c = cos(pi / (2.0 * (double)cases[i].boxes));
        const double rate = cases[i].boxes == 2 ? cases[i].top / (1.0 + cases[i].top) : c * c;
        chain(&scene, cases[i].boxes, cases[i].top);
        options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
        options.tolerance = 1e-300;
        options.max_iterations = cases[i].first;
        solve(&scene, &options, NULL, &early);
        options.max_iterations = cases[i].more;
        solve(&scene, &options, early.impulses, &late);
        const double ratio =
            chain_error(&scene, late.impulses) / chain_error(&scene, early.impulses);
        const double measured = pow(ratio, 1.0 / (double)cases[i].more);
        print_message("# %u boxes, top %g kg: rate %.9f, exact %.9f\n", (unsigned)cases[i].boxes,
                      cases[i].top, measured, rate);
        assert_true(late.info.sweeps == cases[i].more);
        assert_true(fabs(measured - rate) <= 1e-6 * (1.0 - rate) + 1e-9);
        release(&early);
        release(&late);
        systems_free(&scene);
    }
}

/* ---- sliding and spinning towers ------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double quantile(const double *sorted, size_t count, double share)
{
    return sorted[(size_t)(share * (double)(count - 1) + 0.5)];
}

static void print_quantiles(const char *what, double *values, size_t count)
{
    qsort(values, count, sizeof *values, by_size);
    print_message("#     %s: median %.3g, 90 %% %.3g, 99 %% %.3g, most %.3g\n", what,
                  quantile(values, count, 0.5), quantile(values, count, 0.9),
                  quantile(values, count, 0.99), values[count - 1]);
}

/* Success at 1e-9 over random towers of one height; returns its share. `median` receives that of the
 * factorisations. */
static double slide(size_t boxes, size_t count, double *median)
{
    double *seconds = allocate(count * sizeof *seconds);
    double *factors = allocate(count * sizeof *factors);
    size_t solved = 0;
    for (size_t i = 0; i < count; i++) {
        systems_scene tower;
        answer got;
        tribo_system_options options = defaults();
        options.tolerance = 1e-9;
        options.max_seconds = 20.0;
        systems_sliding_tower(&tower, boxes, i);
        solve(&tower, &options, NULL, &got);
        const int good = got.truth.eta <= 1e-9 && got.truth.energy <= got.truth.energy_noise;
        if (!good && count <= 100) {
            print_message("#     seed %u: stop %u, eta %.3g, mu %.3g\n", (unsigned)i,
                          (unsigned)got.info.stop, got.truth.eta, tower.contacts[0].pair.mu_s);
        }
        solved += (size_t)good;
        seconds[i] = 1e3 * got.info.seconds;
        factors[i] = (double)got.info.factorizations;
        release(&got);
        systems_free(&tower);
    }
    print_message("# %u boxes: %u of %u to 1e-9\n", (unsigned)boxes, (unsigned)solved,
                  (unsigned)count);
    print_quantiles("ms", seconds, count);
    print_quantiles("factorisations", factors, count);
    *median = quantile(factors, count, 0.5);
    free(seconds);
    free(factors);
    return (double)solved / (double)count;
}

/* A library that is always out of memory. */
static tribo_status refuse_matrix(void *context, uint32_t n, const uint32_t *row_starts,
                                  const uint32_t *columns, const double *values, uint32_t symmetric)
{
    (void)context;
    (void)n;
    (void)row_starts;
    (void)columns;
    (void)values;
    (void)symmetric;
    return TRIBO_ERROR_MEMORY;
}

static tribo_status refuse_solve(void *context, double *x)
{
    (void)context;
    (void)x;
    return TRIBO_ERROR_MEMORY;
}

/* Bodies in another order: neighbours are far from each other. */
static void renumber(systems_scene *scene)
{
    const size_t count = scene->body_count;
    tribo_body *old = allocate(count * sizeof *old);
    memcpy(old, scene->bodies, count * sizeof *old);
    for (size_t i = 0; i < count; i++) {
        scene->bodies[37 * i % count] = old[i];
    }
    for (size_t c = 0; c < scene->count; c++) {
        uint32_t *ends[2] = {&scene->contacts[c].a, &scene->contacts[c].b};
        for (int k = 0; k < 2; k++) {
            *ends[k] = *ends[k] == TRIBO_WORLD ? TRIBO_WORLD : (uint32_t)(37 * *ends[k] % count);
        }
    }
    free(old);
}

/* Towers whose matrices are narrow, however their bodies are numbered. */
static void test_narrow_matrices_need_no_library(void **state)
{
    static const tribo_linear none = {sizeof none, 0, NULL, refuse_matrix, refuse_solve, NULL};
    (void)state;
    for (int sliding = 0; sliding < 2; sliding++) {
        tribo_system_options options = defaults();
        tribo_system_info info = {.struct_size = sizeof info};
        systems_scene tower;
        size_t size = 0;
        options.linear = &none;
        options.solver = TRIBO_SOLVER_NEWTON;
        if (sliding) {
            systems_sliding_tower(&tower, 60, 2);
        } else {
            systems_tower(&tower, 100, SYSTEMS_ALTERNATE, 10.0, 0.5);
        }
        renumber(&tower);
        assert_int_equal(tribo_system_workspace_size(tower.body_count, tower.count, tower.contacts,
                                                     &options, &size),
                         TRIBO_OK);
        void *workspace = allocate(size);
        double *impulses = allocate(3 * tower.count * sizeof(double));
        double *velocities = allocate(6 * tower.body_count * sizeof(double));
        assert_int_equal(tribo_system_solve(tower.body_count, tower.bodies, tower.count,
                                            tower.contacts, &options, workspace, size, impulses,
                                            velocities, &info),
                         TRIBO_OK);
        assert_int_equal(info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(info.factorizations > 0);
        free(workspace);
        free(impulses);
        free(velocities);
        systems_free(&tower);
    }
}

/* The same by W alone, contacts in any order. */
static void test_narrow_blocks_need_no_library(void **state)
{
    static const tribo_linear none = {sizeof none, 0, NULL, refuse_matrix, refuse_solve, NULL};
    tribo_system_options options = defaults();
    tribo_system_info info = {.struct_size = sizeof info};
    systems_scene tower;
    systems_blocks w;
    size_t size = 0;
    (void)state;
    options.linear = &none;
    options.solver = TRIBO_SOLVER_NEWTON;
    systems_tower(&tower, 20, SYSTEMS_ALTERNATE, 10.0, 0.5);
    systems_permute(&tower, 3, NULL);
    systems_assemble(&tower, &w);
    assert_int_equal(
        tribo_system_assembled_workspace_size(w.count, w.row_starts, w.columns, &options, &size),
        TRIBO_OK);
    void *workspace = allocate(size);
    double *impulses = allocate(3 * w.count * sizeof(double));
    assert_int_equal(tribo_system_solve_assembled(w.count, w.row_starts, w.columns, w.blocks, w.q,
                                                  w.mu, &options, workspace, size, impulses, NULL,
                                                  &info),
                     TRIBO_OK);
    assert_int_equal(info.stop, TRIBO_STOP_TOLERANCE);
    assert_true(info.factorizations > 0);
    free(workspace);
    free(impulses);
    systems_free_blocks(&w);
    systems_free(&tower);
}

static void test_sliding_towers(void **state)
{
    static const struct {
        size_t boxes;
        size_t some;
        double most; /* median */
    } heights[] = {{2, 60, 10}, {5, 40, 24}, {10, 30, 30}, {20, 15, 30}, {50, 6, 40}, {100, 3, 60}};
    const char *slow = getenv("TRIBO_SLOW");
    double least = 1.0;
    (void)state;
    for (size_t i = 0; i < sizeof heights / sizeof heights[0]; i++) {
        const size_t count =
            slow != NULL && slow[0] == '1' ? 1000 : (size_t)problem_count(heights[i].some);
        double median;
        least = fmin(least, slide(heights[i].boxes, count, &median));
        assert_true(count < heights[i].some || median <= heights[i].most);
    }
    assert_true(least == 1.0);
}

/* The path to the solution of most of these turns back, where a matrix becomes singular or where a
 * slip turns round; the last steps of the others need all digits. Newton alone wanders on them for
 * some hundred to two thousand steps, and on seed 334 it stalls. */
static void test_towers_whose_path_turns(void **state)
{
    static const struct {
        size_t boxes;
        uint64_t seed;
    } towers[] = {{10, 7},   {50, 6},   {50, 26},  {50, 29}, {50, 334},
                  {100, 20}, {100, 27}, {100, 78}, {100, 89}};
    tribo_system_options options = defaults();
    double most = 0.0;
    (void)state;
    options.tolerance = 1e-9;
    for (size_t i = 0; i < sizeof towers / sizeof towers[0]; i++) {
        systems_scene tower;
        answer got;
        systems_sliding_tower(&tower, towers[i].boxes, towers[i].seed);
        solve(&tower, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(got.truth.eta <= 1e-9 && got.truth.energy <= got.truth.energy_noise);
        most = fmax(most, (double)got.info.factorizations);
        release(&got);
        systems_free(&tower);
    }
    print_message("# paths that turn: at most %g factorisations\n", most);
    assert_true(most <= 250.0);
}

/* ---- standing heaps -------------------------------------------------------------------------- */

/* Greatest velocity that is left, over that of the fall. */
static double motion(const systems_scene *scene, const double *velocities)
{
    double most = 0.0;
    for (size_t i = 0; i < 6 * scene->body_count; i++) {
        most = fmax(most, fabs(velocities[i]));
    }
    return most / SYSTEMS_FALL;
}

/* Pyramids of spheres, four contacts to a sphere: twice what holds it. Newton alone takes a thousand
 * steps for 256 contacts, and does not get through more of them; the interior method takes some
 * dozen, after Newton's first 32 where these are cheap. */
static void test_standing_heaps(void **state)
{
    static const size_t layers[] = {4, 6, 8, 11};
    static const double coefficients[] = {1.0, 1.5, 20.0};
    tribo_system_options options = defaults();
    double most = 0.0;
    (void)state;
    options.measure = TRIBO_MEASURE_INVARIANT;
    for (size_t i = 0; i < 12; i++) {
        systems_scene heap;
        answer got;
        systems_heap(&heap, layers[i % 4], coefficients[i / 4], i);
        solve(&heap, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(motion(&heap, got.velocities) <= 1e-8);
        assert_true(got.info.linear <= 1e-10);
        most = fmax(most, (double)got.info.factorizations);
        release(&got);
        systems_free(&heap);
    }
    print_message("# heaps: at most %g factorisations\n", most);
    assert_true(most <= 64.0);
}

/* Smooth walls around the lowest layer, one row each, hold what friction could not. */
static void wall_in(systems_scene *heap, size_t layers)
{
    static const double normals[4][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    const double far = (double)layers - 1.0;
    for (uint32_t i = 0; i < layers * layers; i++) {
        const double *place = heap->bodies[i].position;
        for (size_t side = 0; side < 4; side++) {
            const double *normal = normals[side];
            const double at = normal[0] + normal[1] > 0.0 ? 0.0 : far;
            double point[3] = {place[0], place[1], place[2]};
            if (place[side / 2] != at) {
                continue;
            }
            point[side / 2] -= 0.5 * normal[side / 2];
            systems_add_contact(heap, i, TRIBO_WORLD, point, normal, 0.5)->dimension = 1;
        }
    }
}

static void test_heaps_between_smooth_walls(void **state)
{
    const tribo_system_options options = defaults();
    (void)state;
    for (size_t layers = 5; layers <= 9; layers++) {
        systems_scene heap;
        answer got;
        systems_heap(&heap, layers, 0.6, layers);
        wall_in(&heap, layers);
        solve(&heap, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_true(motion(&heap, got.velocities) <= 1e-8);
        assert_true(got.info.factorizations <= 64);
        release(&got);
        systems_free(&heap);
    }
}

/* Units are a matter of exponents: odd powers of two, of which no root is exact, change no bit. */
static void scale_units(const systems_scene *scene)
{
    static const int powers[6][3] = {{1, 0, 0},  {0, 1, 0},    {0, 0, 1},
                                     {-3, 5, 2}, {7, -11, -3}, {-20, 31, 9}};
    const tribo_system_options options = defaults();
    answer want;
    solve(scene, &options, NULL, &want);
    for (int i = 0; i < 6; i++) {
        systems_scene scaled;
        answer got;
        systems_copy(scene, &scaled);
        systems_scale(&scaled, powers[i][0], powers[i][1], powers[i][2]);
        solve(&scaled, &options, NULL, &got);
        for (size_t k = 0; k < 3 * scene->count; k++) {
            got.impulses[k] = ldexp(got.impulses[k], powers[i][2] - powers[i][0] - powers[i][1]);
        }
        assert_memory_equal(got.impulses, want.impulses, 3 * scene->count * sizeof(double));
        assert_int_equal(got.info.factorizations, want.info.factorizations);
        release(&got);
        systems_free(&scaled);
    }
    release(&want);
}

static void test_heaps_have_no_units(void **state)
{
    systems_scene heap;
    (void)state;
    systems_heap(&heap, 6, 1.0, 3);
    scale_units(&heap);
    systems_free(&heap);
}

/* One whose path turns back. */
static void test_sliding_towers_have_no_units(void **state)
{
    systems_scene tower;
    (void)state;
    systems_sliding_tower(&tower, 10, 7);
    scale_units(&tower);
    systems_free(&tower);
}

/* Piles that fall apart, on slippery spheres: sweeps get there, and with leaps in a tenth of them. */
static void test_slippery_piles(void **state)
{
    tribo_system_options plain = defaults();
    const tribo_system_options leaping = defaults();
    (void)state;
    plain.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        systems_scene pile;
        answer want;
        answer got;
        systems_rubble(&pile, 7, seed);
        for (size_t i = 0; i < pile.count; i++) {
            pile.contacts[i].pair.mu_s = pile.contacts[i].pair.mu_d = 0.1;
        }
        solve(&pile, &plain, NULL, &want);
        solve(&pile, &leaping, NULL, &got);
        print_message("# pile of %u contacts: %u sweeps, with leaps %u\n", (unsigned)pile.count,
                      (unsigned)want.info.sweeps, (unsigned)got.info.sweeps);
        assert_int_equal(want.info.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(got.info.steps, 0);
        assert_true(5 * got.info.sweeps <= want.info.sweeps);
        release(&want);
        release(&got);
        systems_free(&pile);
    }
}

/* Rough ones are what sweeps wander on, and Newton too. */
static void test_rough_piles(void **state)
{
    tribo_system_options options = defaults();
    (void)state;
    options.max_iterations = 100000;
    for (uint64_t seed = 1; seed <= 6; seed++) {
        systems_scene pile;
        answer got;
        systems_rubble(&pile, 5, seed);
        solve(&pile, &options, NULL, &got);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        release(&got);
        systems_free(&pile);
    }
}

/* Spheres poured into a box, at one moment, to 1e-8: each pile has `least` contacts. */
static void solve_poured(size_t spheres, uint32_t moment, uint64_t seeds, size_t least)
{
    tribo_system_options options = defaults();
    options.measure = TRIBO_MEASURE_INVARIANT;
    options.tolerance = 1e-8;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        systems_scene pile;
        answer got;
        poured(&pile, spheres, moment, seed);
        assert_true(pile.count >= least);
        solve(&pile, &options, NULL, &got);
        print_message("# poured, %u contacts: %u sweeps, %u steps\n", (unsigned)pile.count,
                      (unsigned)got.info.sweeps, (unsigned)got.info.steps);
        assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
        release(&got);
        systems_free(&pile);
    }
}

/* Contacts that slide, part and meet: sweeps get there. */
static void test_poured_spheres_that_fall(void **state)
{
    (void)state;
    solve_poured(400, POURED_FALLING, 3, 700);
}

/* Once they lie, a fifth of the contacts still slides, and no balance without slip is to be found:
 * the hardest moment of a pile. Neither sweeps nor Newton solve the first of the larger ones; the
 * path of Coulomb's law does. */
static void test_poured_spheres_that_lie(void **state)
{
    (void)state;
    solve_poured(90, POURED_LYING, 4, 180);
    solve_poured(120, POURED_LYING, 3, 300);
}

/* The same by W alone: a heap whose matrix is given in blocks. */
static void test_assembled_heaps(void **state)
{
    (void)state;
    for (size_t layers = 5; layers <= 7; layers++) {
        tribo_system_options options = defaults();
        tribo_system_info info = {.struct_size = sizeof info};
        tribo_linear linear = {.struct_size = sizeof linear};
        tribo_sparse *sparse = NULL;
        systems_scene heap;
        systems_blocks w;
        size_t size = 0;
        systems_heap(&heap, layers, 1.0, layers);
        systems_assemble(&heap, &w);
        assert_int_equal(tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse), TRIBO_OK);
        assert_int_equal(tribo_sparse_linear(sparse, &linear), TRIBO_OK);
        options.linear = &linear;
        assert_int_equal(tribo_system_assembled_workspace_size(w.count, w.row_starts, w.columns,
                                                               &options, &size),
                         TRIBO_OK);
        void *workspace = allocate(size);
        double *impulses = allocate(3 * w.count * sizeof(double));
        double *velocities = allocate(3 * w.count * sizeof(double));
        assert_int_equal(tribo_system_solve_assembled(w.count, w.row_starts, w.columns, w.blocks,
                                                      w.q, w.mu, &options, workspace, size,
                                                      impulses, velocities, &info),
                         TRIBO_OK);
        assert_int_equal(info.stop, TRIBO_STOP_TOLERANCE);
        for (size_t k = 0; k < 3 * w.count; k++) {
            assert_true(fabs(velocities[k]) <= 1e-8 * SYSTEMS_FALL);
        }
        assert_true(info.factorizations <= 64);
        free(workspace);
        free(impulses);
        free(velocities);
        tribo_sparse_destroy(sparse);
        systems_free_blocks(&w);
        systems_free(&heap);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_standing_towers),
        cmocka_unit_test(test_tall_towers),
        cmocka_unit_test(test_resting_towers_start_warm),
        cmocka_unit_test(test_gauss_seidel_has_its_exact_rate),
        cmocka_unit_test(test_narrow_matrices_need_no_library),
        cmocka_unit_test(test_narrow_blocks_need_no_library),
        cmocka_unit_test(test_sliding_towers),
        cmocka_unit_test(test_towers_whose_path_turns),
        cmocka_unit_test(test_standing_heaps),
        cmocka_unit_test(test_heaps_between_smooth_walls),
        cmocka_unit_test(test_heaps_have_no_units),
        cmocka_unit_test(test_sliding_towers_have_no_units),
        cmocka_unit_test(test_assembled_heaps),
        cmocka_unit_test(test_slippery_piles),
        cmocka_unit_test(test_rough_piles),
        cmocka_unit_test(test_poured_spheres_that_fall),
        cmocka_unit_test(test_poured_spheres_that_lie),
    };
    return cmocka_run_group_tests_name("towers", tests, NULL, NULL);
}
