/* Nanoseconds per pair of shapes against the error of depth and normal: tribo's closed forms
 * and its general method, libccd alone with its default tolerances, and ODE's dCollide (with
 * TRIBO_BENCH_ODE), on the same pairs in one run.
 *
 * tribo and ODE give whole manifolds, libccd one direction. Pairs are asked in a new random
 * order in every round, methods take turns, the clock is that of the thread, nothing is pinned.
 * The hundredth of each direction that counts as wrong is that of pairs_excess; the error of
 * depth is relative to the true one. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/tribo.h>

#include <tribo/collide.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/pairs.h"
#include "../support/problems.h"

#if defined(TRIBO_BENCH_ODE)
#include <ode/ode.h>
#endif

enum { SEED = 20160604, PAIRS = 256, ROUNDS = 11 };

static pairs_pair *pairs;
static size_t order[PAIRS];

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---- methods
 * ------------------------------------------------------------------------------------ */

/* The answer of a method to a pair; `found` 0 is a miss. */
typedef void (*method_function)(size_t pair, pairs_answer *out);

static void ask_tribo(uint32_t method, size_t i, pairs_answer *out)
{
    const pairs_pair *pair = &pairs[i];
    tribo_collide_options options = {0};
    tribo_manifold manifold;
    uint32_t count = 0;
    options.struct_size = sizeof options;
    options.method = method;
    const tribo_status status =
        tribo_collide_shapes(&pair->shape[0], &pair->pose[0], &pair->shape[1], &pair->pose[1],
                             &options, 1, &manifold, &count, NULL);
    out->found = status == TRIBO_OK && count == 1;
    if (out->found) {
        double deepest = manifold.points[0].distance;
        for (uint32_t k = 1; k < manifold.count; k++) {
            deepest = fmin(deepest, manifold.points[k].distance);
        }
        out->depth = -deepest;
        memcpy(out->normal, manifold.normal, sizeof out->normal);
    }
}

static void ask_closed(size_t i, pairs_answer *out)
{
    ask_tribo(TRIBO_METHOD_CLOSED, i, out);
}

static void ask_general(size_t i, pairs_answer *out)
{
    ask_tribo(TRIBO_METHOD_GENERAL, i, out);
}

static void ask_epa(size_t i, pairs_answer *out)
{
    pairs_raw_epa(&pairs[i], out);
}

static void ask_mpr(size_t i, pairs_answer *out)
{
    pairs_raw_mpr(&pairs[i], out);
}

#if defined(TRIBO_BENCH_ODE)

/* ---- ODE
 * ---------------------------------------------------------------------------------------- */

/* What ODE keeps pointers to of a convex. */
typedef struct ode_hull {
    dReal planes[4 * TRUTH_FACES];
    dReal points[3 * TRUTH_VERTICES];
    unsigned polygons[4 * TRUTH_FACES];
} ode_hull;

static dGeomID geoms[2 * PAIRS];
static ode_hull *hulls[2 * PAIRS];

static dGeomID make_convex(const truth_polytope *core, ode_hull *hull)
{
    for (int i = 0; i < core->vertices; i++) {
        for (int c = 0; c < 3; c++) {
            hull->points[3 * i + c] = core->vertex[i][c];
        }
    }
    for (int f = 0; f < core->faces; f++) {
        const double *n = core->normal[f];
        const double *p = core->vertex[core->corner[f][0]];
        hull->polygons[4 * f] = 3;
        for (int c = 0; c < 3; c++) {
            hull->planes[4 * f + c] = n[c];
            hull->polygons[4 * f + 1 + c] = (unsigned)core->corner[f][c];
        }
        hull->planes[4 * f + 3] = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
    }
    return dCreateConvex(0, hull->planes, (unsigned)core->faces, hull->points,
                         (unsigned)core->vertices, hull->polygons);
}

/* Null where ODE has no such shape. */
static dGeomID make_geom(const pairs_pair *pair, int i, ode_hull **hull)
{
    const double *s = pair->shape[i].size;
    *hull = NULL;
    switch (pair->shape[i].type) {
    case TRIBO_SHAPE_SPHERE:
        return dCreateSphere(0, s[0]);
    case TRIBO_SHAPE_BOX:
        return dCreateBox(0, 2.0 * s[0], 2.0 * s[1], 2.0 * s[2]);
    case TRIBO_SHAPE_CAPSULE:
        return dCreateCapsule(0, s[0], 2.0 * s[1]);
    case TRIBO_SHAPE_CYLINDER:
        return dCreateCylinder(0, s[0], 2.0 * s[1]);
    case TRIBO_SHAPE_HULL:
        *hull = calloc(1, sizeof **hull);
        return *hull != NULL ? make_convex(pair->body[i].core, *hull) : 0;
    default:
        return 0;
    }
}

static int make_geoms(void)
{
    int all = 1;
    for (size_t k = 0; k < 2 * PAIRS; k++) {
        const pairs_pair *pair = &pairs[k / 2];
        const tribo_pose *pose = &pair->pose[k % 2];
        geoms[k] = make_geom(pair, (int)(k % 2), &hulls[k]);
        if (geoms[k] != 0) {
            dQuaternion q = {pose->orientation[0], pose->orientation[1], pose->orientation[2],
                             pose->orientation[3]};
            dGeomSetPosition(geoms[k], pose->position[0], pose->position[1], pose->position[2]);
            dGeomSetQuaternion(geoms[k], q);
        }
        all = all && geoms[k] != 0;
    }
    return all;
}

static void drop_geoms(void)
{
    for (size_t k = 0; k < 2 * PAIRS; k++) {
        if (geoms[k] != 0) {
            dGeomDestroy(geoms[k]);
        }
        free(hulls[k]);
    }
}

/* ODE's normal points into its first body. */
static void ask_ode(size_t i, pairs_answer *out)
{
    dContactGeom contacts[8];
    const int count =
        dCollide(geoms[2 * i], geoms[2 * i + 1], 8, contacts, (int)sizeof contacts[0]);
    out->found = count > 0;
    out->depth = -1.0;
    for (int k = 0; k < count; k++) {
        if (contacts[k].depth > out->depth) {
            out->depth = contacts[k].depth;
            memcpy(out->normal, contacts[k].normal, sizeof out->normal);
        }
    }
}

#endif

/* ---- rows
 * --------------------------------------------------------------------------------------- */

typedef struct method {
    const char *name;
    method_function ask;
} method;

static const method methods[] = {
    {"tribo closed", ask_closed}, {"tribo general", ask_general},
    {"libccd GJK/EPA", ask_epa},  {"libccd MPR", ask_mpr},
#if defined(TRIBO_BENCH_ODE)
    {"ODE dCollide", ask_ode},
#endif
};

enum { METHODS = sizeof methods / sizeof methods[0] };

typedef struct figures {
    double ns[ROUNDS];
    double error[PAIRS]; /* of depth, relative */
    size_t found, wrong;
} figures;

static int compare_doubles(const void *x, const void *y)
{
    const double a = *(const double *)x;
    const double c = *(const double *)y;
    return (a > c) - (a < c);
}

static void shuffle(problem_random *random)
{
    for (size_t i = 0; i < PAIRS; i++) {
        const size_t j = (size_t)(problem_random_bits(random) % (i + 1));
        order[i] = order[j];
        order[j] = i;
    }
}

/* Where the truth is only an upper bound the least of all answers is the better one. */
static void lower_truth(const method *m)
{
    for (size_t i = 0; i < PAIRS; i++) {
        pairs_pair *pair = &pairs[i];
        pairs_answer answer = {0};
        m->ask(i, &answer);
        if (answer.found && (pair->body[0].core == NULL || pair->body[1].core == NULL)) {
            const double width = truth_width(&pair->body[0], &pair->body[1], answer.normal);
            pair->depth = width < pair->depth ? width : pair->depth;
        }
    }
}

static void judge(const method *m, figures *f)
{
    for (size_t i = 0; i < PAIRS; i++) {
        pairs_answer answer = {0};
        m->ask(i, &answer);
        if (answer.found) {
            f->wrong += pairs_excess(&pairs[i], answer.normal) <= 0.01 ? 0 : 1;
            f->error[f->found++] = fabs(answer.depth - pairs[i].depth) / pairs[i].depth;
        }
    }
}

/* Sink of all answers, so that none is left out. */
static volatile double taken;

static void time_round(const method *m, double *ns)
{
    double sum = 0.0;
    const double start = now();
    for (size_t i = 0; i < PAIRS; i++) {
        pairs_answer answer = {0};
        m->ask(order[i], &answer);
        sum += answer.depth;
    }
    *ns = (now() - start) / PAIRS;
    taken = sum;
}

static void print_row(const char *set, const char *kinds, const method *m, figures *f)
{
    qsort(f->ns, ROUNDS, sizeof f->ns[0], compare_doubles);
    qsort(f->error, f->found, sizeof f->error[0], compare_doubles);
    printf("%-11s %-21s %-15s %8.0f %8.0f %7.2f %7.2f", set, kinds, m->name, f->ns[ROUNDS / 2],
           f->ns[0], 100.0 * (double)f->wrong / PAIRS, 100.0 * (double)(PAIRS - f->found) / PAIRS);
    if (f->found > 0) {
        printf(" %10.1e %10.1e", f->error[f->found / 2], f->error[f->found - 1]);
    }
    printf("\n");
}

static void bench_kinds(const pairs_class *class, int kind_a, int kind_b)
{
    static figures all[METHODS];
    char kinds[64];
    problem_random random;
    problem_random_start(&random, 9, SEED, 0);
    memset(all, 0, sizeof all);
    (void)snprintf(kinds, sizeof kinds, "%s-%s", pairs_kind_names[kind_a],
                   pairs_kind_names[kind_b]);
    for (size_t i = 0; i < PAIRS; i++) {
        pairs_draw(class, SEED, i, kind_a, kind_b, &pairs[i]);
        order[i] = i;
    }
#if defined(TRIBO_BENCH_ODE)
    const int ode = make_geoms();
#endif
    size_t count = METHODS;
#if defined(TRIBO_BENCH_ODE)
    count -= ode ? 0 : 1;
#endif
    for (size_t k = 0; k < count; k++) {
        lower_truth(&methods[k]);
    }
    for (size_t k = 0; k < count; k++) {
        judge(&methods[k], &all[k]);
    }
    for (size_t r = 0; r < ROUNDS; r++) {
        shuffle(&random);
        for (size_t k = 0; k < METHODS; k++) {
            if (all[k].found > 0) {
                time_round(&methods[k], &all[k].ns[r]);
            }
        }
    }
    for (size_t k = 0; k < METHODS; k++) {
        if (all[k].found > 0) {
            print_row(class->name, kinds, &methods[k], &all[k]);
        }
    }
#if defined(TRIBO_BENCH_ODE)
    drop_geoms();
#endif
}

static const int kinds[][2] = {
    {PAIRS_SPHERE, PAIRS_SPHERE},   {PAIRS_SPHERE, PAIRS_CAPSULE},
    {PAIRS_CAPSULE, PAIRS_CAPSULE}, {PAIRS_SPHERE, PAIRS_BOX},
    {PAIRS_BOX, PAIRS_BOX},         {PAIRS_CAPSULE, PAIRS_BOX},
    {PAIRS_CYLINDER, PAIRS_BOX},    {PAIRS_CYLINDER, PAIRS_CYLINDER},
    {PAIRS_CONE, PAIRS_BOX},        {PAIRS_ELLIPSOID, PAIRS_ELLIPSOID},
    {PAIRS_HULL32, PAIRS_HULL32},   {PAIRS_HULL256, PAIRS_HULL256},
};

int main(void)
{
    static const int classes[] = {1, 4}; /* depths 1e-2 and 1e-6 */
    pairs = calloc(PAIRS, sizeof *pairs);
    if (pairs == NULL) {
        return 1;
    }
#if defined(TRIBO_BENCH_ODE)
    dInitODE();
#endif
    printf("%-11s %-21s %-15s %8s %8s %7s %7s %10s %10s\n", "class", "pair", "method", "ns median",
           "least", "wrong %", "miss %", "depth med", "depth max");
    for (size_t c = 0; c < sizeof classes / sizeof classes[0]; c++) {
        for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
            bench_kinds(&pairs_classes[classes[c]], kinds[k][0], kinds[k][1]);
        }
    }
#if defined(TRIBO_BENCH_ODE)
    dCloseODE();
#endif
    free(pairs);
    return 0;
}
