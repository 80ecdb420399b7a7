/* Many contacts: how time and memory grow with their number, and what towers take.
 *
 *   system [--full] [CONTACTS [SECONDS [SCENE]]]
 *       greatest number of contacts (10000; --full: 100000), limit for one solve (3; --full: 20), and
 *       a scene: how it grows, alone
 *
 * Spheres poured into a box while they fall and once they lie (pour, pile), heaps of spheres that
 * stand, walls of bricks, towers of boxes, and pyramids of spheres that fall apart (rubble), from a
 * cold start to an invariant residual of 1e-8 by the automatic choice with SuiteSparse, in
 * the caller's thread; the time is that of tribo_system_solve alone by the clock on the wall, the
 * least of several. Errors are those of the certificate, which the tests compare with quad
 * precision. A scene that reaches the limit grows no further. Exponents are fitted to log time over
 * log contacts. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/sparse.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/poured.h"
#include "../support/problems.h"
#include "../support/systems.h"
#include "full.h"
#include "threads.h"

enum { SCENES = 6, MOST_ROWS = 64 };

static const double tolerance = 1e-8;
static double budget = 0.05; /* seconds of repetition for each figure */
static const char *const scene_names[SCENES] = {"pour", "pile", "heap", "wall", "tower", "rubble"};

typedef struct row {
    const char *scene;
    size_t contacts;
    size_t bodies;
    int solved;
    double seconds;
    double bytes; /* of the workspace */
    double sparse_bytes;
    tribo_system_info info;
} row;

static row rows[MOST_ROWS];
static size_t row_count;

static double now(void *user)
{
    struct timespec at;
    (void)user;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

static void *allocate(size_t size)
{
    void *memory = malloc(size > 0 ? size : 1);
    if (memory == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(EXIT_FAILURE);
    }
    return memory;
}

static void demand(tribo_status status, const char *what)
{
    if (status != TRIBO_OK) {
        fprintf(stderr, "%s: %s\n", what, tribo_status_string(status));
        exit(EXIT_FAILURE);
    }
}

/* ---- one solve ------------------------------------------------------------------------------- */

/* From zero; the least time of several. */
static void solve(const systems_scene *scene, const tribo_system_options *given, row *out)
{
    tribo_system_options options = *given;
    tribo_sparse_info report = {.struct_size = sizeof report};
    tribo_linear linear = {.struct_size = sizeof linear};
    tribo_sparse *sparse = NULL;
    size_t size = 0;
    demand(tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse), "tribo_sparse_create");
    demand(tribo_sparse_linear(sparse, &linear), "tribo_sparse_linear");
    options.linear = &linear;
    options.clock = now;
    demand(tribo_system_workspace_size(scene->body_count, scene->count, scene->contacts, &options,
                                       &size),
           "tribo_system_workspace_size");
    void *workspace = allocate(size);
    double *impulses = allocate(3 * scene->count * sizeof *impulses);
    double *velocities = allocate(6 * scene->body_count * sizeof *velocities);
    out->contacts = scene->count;
    out->bodies = scene->body_count;
    out->seconds = HUGE_VAL;
    const double start = now(NULL);
    do {
        out->info.struct_size = sizeof out->info;
        demand(tribo_system_solve(scene->body_count, scene->bodies, scene->count, scene->contacts,
                                  &options, workspace, size, impulses, velocities, &out->info),
               "tribo_system_solve");
        out->seconds = fmin(out->seconds, out->info.seconds);
    } while (now(NULL) - start < budget);
    demand(tribo_sparse_report(sparse, &report), "tribo_sparse_report");
    out->solved = out->info.stop == TRIBO_STOP_TOLERANCE;
    out->bytes = (double)out->info.bytes;
    out->sparse_bytes = (double)report.bytes;
    tribo_sparse_destroy(sparse);
    free(workspace);
    free(impulses);
    free(velocities);
}

/* ---- growth ---------------------------------------------------------------------------------- */

/* A scene of about so many contacts. */
static void make_scene(size_t kind, double contacts, systems_scene *out)
{
    if (kind == 0) {
        poured(out, (size_t)(contacts / 2.2 + 0.5), POURED_FALLING, 1);
    } else if (kind == 1) {
        poured(out, (size_t)(contacts / 2.6 + 0.5), POURED_LYING, 1);
    } else if (kind == 2) {
        systems_heap(out, (size_t)(cbrt(0.75 * contacts) + 0.5), 1.0, 1);
    } else if (kind == 3) {
        /* two columns to a row, an even number of rows */
        const size_t half = (size_t)(sqrt(contacts / 8.0) / 2.0 + 0.5);
        systems_wall(out, half > 1 ? 2 * half : 2, half > 1 ? 2 * half : 2, 1);
    } else if (kind == 4) {
        systems_tower(out, (size_t)(contacts / 4.0 + 0.5), SYSTEMS_TOP, 1.0, 0.5);
    } else {
        systems_rubble(out, (size_t)(cbrt(contacts / 2.0) + 1.0), 1);
    }
}

static void print_row(const row *r)
{
    printf("%-6s %8zu %8zu %11.4g %9.3g %7.0f %7.0f %7llu %6llu %6llu  %8.1e %8.1e %s\n", r->scene,
           r->contacts, r->bodies, 1e3 * r->seconds, 1e6 * r->seconds / (double)r->contacts,
           r->bytes / (double)r->contacts, r->sparse_bytes / (double)r->contacts,
           (unsigned long long)r->info.sweeps, (unsigned long long)r->info.steps,
           (unsigned long long)r->info.factorizations, r->info.eta, r->info.invariant,
           r->solved ? "" : "not solved");
    fflush(stdout);
}

/* Slope of log time over log contacts, of the solved rows of a scene. */
static double exponent(const char *scene)
{
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (size_t i = 0; i < row_count; i++) {
        if (rows[i].scene == scene && rows[i].solved) {
            const double a = log((double)rows[i].contacts);
            const double b = log(rows[i].seconds);
            n += 1.0;
            x += a;
            y += b;
            xx += a * a;
            xy += a * b;
        }
    }
    return n > 1.0 ? (n * xy - x * y) / (n * xx - x * x) : 0.0;
}

static int is_wanted(size_t kind, const char *only)
{
    return only == NULL || strcmp(only, scene_names[kind]) == 0;
}

/* All scenes, or one alone. */
static void grow(double most, double limit, const char *only)
{
    static const double sizes[] = {1e2, 3e2, 1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6};
    tribo_system_options options = {.struct_size = sizeof options};
    options.measure = TRIBO_MEASURE_INVARIANT;
    options.tolerance = tolerance;
    options.max_seconds = limit;
    printf("to an invariant residual of %g, cold, automatic choice\n", tolerance);
    printf("%-6s %8s %8s %11s %9s %7s %7s %7s %6s %6s  %8s %8s\n", "scene", "contacts", "bodies",
           "ms", "us/cont.", "B/cont.", "sparse", "sweeps", "steps", "factor", "eta", "invar.");
    for (size_t kind = 0; kind < SCENES; kind++) {
        int solved = is_wanted(kind, only);
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0] && sizes[i] <= most && solved; i++) {
            systems_scene scene;
            row *r = &rows[row_count++];
            r->scene = scene_names[kind];
            make_scene(kind, sizes[i], &scene);
            solve(&scene, &options, r);
            print_row(r);
            solved = r->seconds < limit;
            systems_free(&scene);
        }
    }
    for (size_t kind = 0; kind < SCENES; kind++) {
        if (!is_wanted(kind, only))
            continue;
        printf("%s: time grows as contacts^%.2f\n", scene_names[kind], exponent(scene_names[kind]));
    }
}

/* ---- towers ---------------------------------------------------------------------------------- */

static void stand(void)
{
    static const size_t heights[] = {10, 20, 50, 100};
    static const double ratios[] = {1.0, 1e2, 1e4, 1e6};
    static const char *const masses[] = {"top", "geometric", "alternate"};
    printf("\nstanding towers, cold, invariant residual 1e-8 (rounding allows no less for a ratio "
           "of 1e6)\n");
    printf("%6s %9s %10s %9s %7s %9s %9s\n", "boxes", "ratio", "masses", "ms", "factor", "eta",
           "invar.");
    for (size_t i = 0; i < 48; i++) {
        systems_scene tower;
        row r = {.scene = "tower"};
        tribo_system_options options = {.struct_size = sizeof options};
        options.measure = TRIBO_MEASURE_INVARIANT;
        options.tolerance = tolerance;
        options.max_seconds = 10.0;
        systems_tower(&tower, heights[i / 12], (uint32_t)(i % 3), ratios[i / 3 % 4], 0.5);
        solve(&tower, &options, &r);
        printf("%6zu %9g %10s %9.4g %7llu %9.1e %9.1e %s\n", heights[i / 12], ratios[i / 3 % 4],
               masses[i % 3], 1e3 * r.seconds, (unsigned long long)r.info.factorizations,
               r.info.eta, r.info.invariant, r.solved ? "" : "not solved");
        systems_free(&tower);
    }
}

/* The same by sweeps alone: what a tower costs without Newton. */
static void sweep(double limit)
{
    static const size_t heights[] = {1, 2, 5, 10, 20};
    printf("\nstanding towers by Gauss-Seidel alone, ratio 1, invariant residual 1e-8\n");
    printf("%6s %9s %9s %9s %9s\n", "boxes", "ms", "sweeps", "invar.", "us/sweep");
    for (size_t i = 0; i < sizeof heights / sizeof heights[0]; i++) {
        systems_scene tower;
        row r = {.scene = "tower"};
        tribo_system_options options = {.struct_size = sizeof options};
        options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
        options.measure = TRIBO_MEASURE_INVARIANT;
        options.tolerance = tolerance;
        options.max_seconds = limit / 6.0;
        systems_tower(&tower, heights[i], SYSTEMS_TOP, 1.0, 0.5);
        solve(&tower, &options, &r);
        printf("%6zu %9.4g %9llu %9.1e %9.3g %s\n", heights[i], 1e3 * r.seconds,
               (unsigned long long)r.info.sweeps, r.info.invariant,
               1e6 * r.info.seconds / (double)(r.info.sweeps > 0 ? r.info.sweeps : 1),
               r.solved ? "" : "not solved");
        systems_free(&tower);
    }
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Sliding and spinning towers with mu up to 1.5. */
/* Up to so many boxes. */
static void slide(size_t most)
{
    enum { SEEDS = 20 };
    static const size_t heights[] = {2, 5, 10, 20, 50, 100};
    printf("\n%d sliding and spinning towers of each height, mu up to 1.5, eta 1e-9\n", SEEDS);
    printf("%6s %7s %9s %9s %9s %9s %9s\n", "boxes", "solved", "least ms", "median", "most",
           "med.fact.", "most");
    for (size_t i = 0; i < sizeof heights / sizeof heights[0] && heights[i] <= most; i++) {
        double ms[SEEDS];
        double factors[SEEDS];
        int solved = 0;
        for (size_t seed = 0; seed < SEEDS; seed++) {
            systems_scene tower;
            row r = {.scene = "tower"};
            tribo_system_options options = {.struct_size = sizeof options};
            options.tolerance = 1e-9;
            options.max_seconds = 10.0;
            systems_sliding_tower(&tower, heights[i], seed);
            solve(&tower, &options, &r);
            solved += r.solved;
            ms[seed] = 1e3 * r.seconds;
            factors[seed] = (double)r.info.factorizations;
            systems_free(&tower);
        }
        qsort(ms, SEEDS, sizeof ms[0], by_size);
        qsort(factors, SEEDS, sizeof factors[0], by_size);
        printf("%6zu %4d/%d %9.3g %9.3g %9.3g %9g %9g\n", heights[i], solved, SEEDS, ms[0],
               ms[SEEDS / 2], ms[SEEDS - 1], factors[SEEDS / 2], factors[SEEDS - 1]);
        fflush(stdout);
    }
}

/* ---- output ---------------------------------------------------------------------------------- */

static void write_table(const char *program)
{
    char path[1024];
    snprintf(path, sizeof path, "%s.tsv", program);
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: cannot be written\n", path);
        return;
    }
    fprintf(file, "scene\tcontacts\tbodies\tsolved\tms\tworkspace_bytes\tsparse_bytes\tsweeps\t"
                  "steps\tfactorizations\teta\tinvariant\n");
    for (size_t i = 0; i < row_count; i++) {
        const row *r = &rows[i];
        fprintf(file, "%s\t%zu\t%zu\t%d\t%.6g\t%.0f\t%.0f\t%llu\t%llu\t%llu\t%.3g\t%.3g\n",
                r->scene, r->contacts, r->bodies, r->solved, 1e3 * r->seconds, r->bytes,
                r->sparse_bytes, (unsigned long long)r->info.sweeps,
                (unsigned long long)r->info.steps, (unsigned long long)r->info.factorizations,
                r->info.eta, r->info.invariant);
    }
    fclose(file);
    printf("\nwritten: %s\n", path);
}

int main(int count, char **arguments)
{
    limit_threads(arguments);
    const int full = take_full(&count, arguments);
    const double most = count > 1 ? strtod(arguments[1], NULL) : full ? 1e5 : 1e4;
    const double limit = count > 2 ? strtod(arguments[2], NULL) : full ? 20.0 : 3.0;
    const char *only = count > 3 ? arguments[3] : NULL;
    size_t known = 0;
    while (known < SCENES && only != NULL && !is_wanted(known, only))
        known++;
    if (known == SCENES) {
        fprintf(stderr, "no scene %s\n", only);
        return EXIT_FAILURE;
    }
    budget = full ? 0.2 : budget;
    grow(most, limit, only);
    if (only == NULL) {
        stand();
        sweep(limit);
        slide(full ? 100 : 50);
    }
    write_table(count > 0 ? arguments[0] : "system");
    return EXIT_SUCCESS;
}
