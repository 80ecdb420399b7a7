/* Nanoseconds per pair of shapes against the errors of depth and normal: tribo's closed forms and
 * its general method, libccd alone with its default tolerances, and other libraries as far as
 * they are there (peers/), on the same pairs in one run.
 *
 * tribo and the libraries give whole manifolds, libccd one point. Pairs are asked in a new random
 * order in every round, methods take turns, the clock is that of the thread, nothing is pinned.
 * The hundredth of each direction that counts as wrong is that of pairs_excess; against a
 * half-space, which has one direction only, more than 1e-6 rad. The error of depth is relative to
 * the true one; that of the normal, in radians, is told where the truth is exact. At a depth of
 * 1e-6 a hundredth is less than single precision holds of a length. */
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
#include "peers/load.h"
#include "peers/peer.h"

enum { SEED = 20160604, PAIRS = 256, ROUNDS = 11, PEERS_AT_MOST = 8 };

/* In place of a kind: B is the half-space that touches a box where A does. */
enum { PLANE = PAIRS_KINDS };

static pairs_pair *pairs;
static int planes; /* B is a half-space in all pairs */
static size_t order[PAIRS];

/* What is asked of tribo, close together as a scene has it: a pairs_pair is as large as caches. */
static tribo_shape shapes[PAIRS][2];
static tribo_pose poses[PAIRS][2];

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---- pairs ---------------------------------------------------------------------------------- */

/* B becomes the half-space below its own highest point along the normal: the depth stays, the
 * normal is the only one. */
static void flatten(pairs_pair *pair)
{
    const double *n = pair->normal;
    const double *r = pair->body[1].rotation;
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    tribo_shape *shape = &pair->shape[1];
    const double half[3] = {shape->size[0], shape->size[1], shape->size[2]};
    memset(shape, 0, sizeof *shape);
    shape->type = TRIBO_SHAPE_HALFSPACE;
    for (int k = 0; k < 3; k++) {
        const double along = r[k] * n[0] + r[3 + k] * n[1] + r[6 + k] * n[2];
        shape->size[k] = n[k] / size;
        shape->size[3] += n[k] / size * pair->pose[1].position[k] + fabs(along / size) * half[k];
    }
    memset(&pair->pose[1], 0, sizeof pair->pose[1]);
    pair->pose[1].orientation[0] = 1.0;
}

static void draw_pairs(const pairs_class *class, int kind_a, int kind_b)
{
    planes = kind_b == PLANE;
    for (size_t i = 0; i < PAIRS; i++) {
        pairs_draw(class, SEED, i, kind_a, planes ? PAIRS_BOX : kind_b, &pairs[i]);
        if (planes) {
            flatten(&pairs[i]);
        }
        memcpy(shapes[i], pairs[i].shape, sizeof shapes[i]);
        memcpy(poses[i], pairs[i].pose, sizeof poses[i]);
        order[i] = i;
    }
}

static int exact(const pairs_pair *pair)
{
    return planes || (pair->body[0].core != NULL && pair->body[1].core != NULL);
}

static double angle(const double *n, const double *m)
{
    return sqrt((n[0] - m[0]) * (n[0] - m[0]) + (n[1] - m[1]) * (n[1] - m[1]) +
                (n[2] - m[2]) * (n[2] - m[2]));
}

static int is_wrong(const pairs_pair *pair, const double *normal)
{
    return planes ? !(angle(normal, pair->normal) <= 1e-6) : !(pairs_excess(pair, normal) <= 0.01);
}

/* ---- tribo and libccd ----------------------------------------------------------------------- */

/* Asks pair i. Less than 0 points: there is no such method for it. */
typedef void (*ask_function)(size_t i, peer_answer *out);

static void ask_tribo(uint32_t method, size_t i, peer_answer *out)
{
    tribo_collide_options options = {0};
    tribo_manifold manifold;
    uint32_t count = 0;
    options.struct_size = sizeof options;
    options.method = method;
    const tribo_status status =
        tribo_collide_shapes(&shapes[i][0], &poses[i][0], &shapes[i][1], &poses[i][1], &options, 1,
                             &manifold, &count, NULL);
    out->points = status == TRIBO_ERROR_OPTION ? -1 : 0;
    if (status == TRIBO_OK && count == 1) {
        double deepest = manifold.points[0].distance;
        for (uint32_t k = 1; k < manifold.count; k++) {
            deepest = manifold.points[k].distance < deepest ? manifold.points[k].distance : deepest;
        }
        out->points = (int)manifold.count;
        out->depth = -deepest;
        memcpy(out->normal, manifold.normal, sizeof out->normal);
    }
}

static void ask_closed(size_t i, peer_answer *out)
{
    ask_tribo(TRIBO_METHOD_CLOSED, i, out);
}

static void ask_general(size_t i, peer_answer *out)
{
    ask_tribo(TRIBO_METHOD_GENERAL, i, out);
}

static void ask_ccd(void (*ask)(const pairs_pair *, pairs_answer *), size_t i, peer_answer *out)
{
    pairs_answer answer = {0};
    out->points = planes ? -1 : 0;
    if (!planes) {
        ask(&pairs[i], &answer);
        out->points = answer.found ? 1 : 0;
        out->depth = answer.depth;
        memcpy(out->normal, answer.normal, sizeof out->normal);
    }
}

static void ask_epa(size_t i, peer_answer *out)
{
    ask_ccd(pairs_raw_epa, i, out);
}

static void ask_mpr(size_t i, peer_answer *out)
{
    ask_ccd(pairs_raw_mpr, i, out);
}

/* ---- methods -------------------------------------------------------------------------------- */

/* Our own by a function, a peer's by what it has made of each pair. */
typedef struct method {
    const char *name;
    ask_function ask;
    const peer *other;
    void *made[PAIRS];
    int able;
} method;

static method methods[4 + PEERS_AT_MOST] = {{.name = "tribo closed", .ask = ask_closed},
                                            {.name = "tribo general", .ask = ask_general},
                                            {.name = "libccd GJK/EPA", .ask = ask_epa},
                                            {.name = "libccd MPR", .ask = ask_mpr}};
static size_t method_count = 4;

static void ask(const method *m, size_t i, peer_answer *out)
{
    if (m->other != NULL) {
        m->other->ask(m->made[i], out);
    } else {
        m->ask(i, out);
    }
}

static int kind_for_peers(uint32_t type)
{
    switch (type) {
    case TRIBO_SHAPE_SPHERE:
        return PEER_SPHERE;
    case TRIBO_SHAPE_BOX:
        return PEER_BOX;
    case TRIBO_SHAPE_CAPSULE:
        return PEER_CAPSULE;
    case TRIBO_SHAPE_CYLINDER:
        return PEER_CYLINDER;
    case TRIBO_SHAPE_CONE:
        return PEER_CONE;
    case TRIBO_SHAPE_ELLIPSOID:
        return PEER_ELLIPSOID;
    case TRIBO_SHAPE_HALFSPACE:
        return PEER_PLANE;
    default:
        return PEER_HULL;
    }
}

static peer_shape shape_for_peers(const pairs_pair *pair, int i)
{
    const truth_polytope *core = pair->body[i].core;
    peer_shape shape = {.kind = kind_for_peers(pair->shape[i].type)};
    memcpy(shape.size, pair->shape[i].size, sizeof shape.size);
    memcpy(shape.position, pair->pose[i].position, sizeof shape.position);
    memcpy(shape.orientation, pair->pose[i].orientation, sizeof shape.orientation);
    if (shape.kind == PEER_HULL) {
        shape.vertices = core->vertices;
        shape.vertex = core->vertex;
        shape.faces = core->faces;
        shape.corner = core->corner;
        shape.normal = core->normal;
    }
    return shape;
}

static void drop_made(method *m)
{
    for (size_t i = 0; i < PAIRS; i++) {
        if (m->made[i] != NULL) {
            m->other->drop(m->made[i]);
        }
        m->made[i] = NULL;
    }
}

/* Whether a method knows all pairs; a peer gets ready for them. */
static void prepare(method *m)
{
    m->able = 1;
    for (size_t i = 0; i < PAIRS && m->able; i++) {
        if (m->other != NULL) {
            const peer_shape both[2] = {shape_for_peers(&pairs[i], 0),
                                        shape_for_peers(&pairs[i], 1)};
            m->made[i] = m->other->make(both);
            m->able = m->made[i] != NULL;
        } else {
            peer_answer answer = {0};
            m->ask(i, &answer);
            m->able = answer.points >= 0;
        }
    }
    if (!m->able && m->other != NULL) {
        drop_made(m);
    }
}

/* ---- figures -------------------------------------------------------------------------------- */

typedef struct figures {
    double ns[ROUNDS];
    double depth[PAIRS]; /* errors */
    double normal[PAIRS];
    size_t found, wrong, angles, points;
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
        peer_answer answer = {0};
        ask(m, i, &answer);
        if (answer.points > 0 && !exact(pair)) {
            const double width = truth_width(&pair->body[0], &pair->body[1], answer.normal);
            pair->depth = width < pair->depth ? width : pair->depth;
        }
    }
}

static void judge(const method *m, figures *f)
{
    for (size_t i = 0; i < PAIRS; i++) {
        const pairs_pair *pair = &pairs[i];
        peer_answer answer = {0};
        ask(m, i, &answer);
        if (answer.points > 0) {
            f->wrong += is_wrong(pair, answer.normal) ? 1 : 0;
            f->points += (size_t)answer.points;
            f->depth[f->found++] = fabs(answer.depth - pair->depth) / pair->depth;
            if (exact(pair)) {
                f->normal[f->angles++] = angle(answer.normal, pair->normal);
            }
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
        peer_answer answer = {0};
        ask(m, order[i], &answer);
        sum += answer.depth;
    }
    *ns = (now() - start) / PAIRS;
    taken = sum;
}

static void print_errors(double *errors, size_t count)
{
    qsort(errors, count, sizeof *errors, compare_doubles);
    if (count > 0) {
        printf(" %8.1e %8.1e", errors[count / 2], errors[count - 1]);
    } else {
        printf(" %8s %8s", "-", "-");
    }
}

static void print_row(const char *set, const char *kinds, const method *m, figures *f)
{
    const double found = (double)f->found;
    qsort(f->ns, ROUNDS, sizeof f->ns[0], compare_doubles);
    printf("%-10s %-19s %-16s %6.0f %6.0f %6.2f %6.2f %5.1f", set, kinds, m->name,
           f->ns[ROUNDS / 2], f->ns[0], 100.0 * (double)f->wrong / PAIRS,
           100.0 * (PAIRS - found) / PAIRS, f->found > 0 ? (double)f->points / found : 0.0);
    print_errors(f->depth, f->found);
    print_errors(f->normal, f->angles);
    printf("\n");
}

/* ---- aims ----------------------------------------------------------------------------------- */

/* What tribo is to take for one pair at most, in any class, with no direction wrong. */
typedef struct aim {
    const char *kinds;
    double most; /* ns */
    double ns;   /* greatest of the medians */
    size_t wrong, missed;
} aim;

static aim aims[] = {{"box-box", 350.0, 0.0, 0, 0},
                     {"box-plane", 60.0, 0.0, 0, 0},
                     {"hull32-hull32", 3000.0, 0.0, 0, 0}};

/* The method that tribo takes by itself: the closed form, where there is one. */
static void note_aim(const char *kinds, const method *m, const figures *f)
{
    if (m != &methods[0] && (m != &methods[1] || methods[0].able)) {
        return;
    }
    for (size_t i = 0; i < sizeof aims / sizeof aims[0]; i++) {
        if (strcmp(aims[i].kinds, kinds) == 0) {
            aims[i].ns = f->ns[ROUNDS / 2] > aims[i].ns ? f->ns[ROUNDS / 2] : aims[i].ns;
            aims[i].wrong += f->wrong;
            aims[i].missed += PAIRS - f->found;
        }
    }
}

static void print_aims(void)
{
    printf("\naims, greatest median of all classes:\n");
    for (size_t i = 0; i < sizeof aims / sizeof aims[0]; i++) {
        const aim *a = &aims[i];
        const int met = a->ns <= a->most && a->wrong == 0 && a->missed == 0;
        printf("  %-14s %5.0f ns, %zu wrong, %zu missed; aim: %.0f ns, none wrong: %s\n", a->kinds,
               a->ns, a->wrong, a->missed, a->most, met ? "met" : "not met");
    }
}

/* ---- rows ----------------------------------------------------------------------------------- */

static void time_methods(figures *all)
{
    problem_random random;
    problem_random_start(&random, 9, SEED, 0);
    for (size_t r = 0; r < ROUNDS; r++) {
        shuffle(&random);
        for (size_t k = 0; k < method_count; k++) {
            if (methods[k].able) {
                time_round(&methods[k], &all[k].ns[r]);
            }
        }
    }
}

static void bench_kinds(const pairs_class *class, int kind_a, int kind_b)
{
    static figures all[4 + PEERS_AT_MOST];
    char kinds[64];
    memset(all, 0, sizeof all);
    (void)snprintf(kinds, sizeof kinds, "%s-%s", pairs_kind_names[kind_a],
                   kind_b == PLANE ? "plane" : pairs_kind_names[kind_b]);
    draw_pairs(class, kind_a, kind_b);
    for (size_t k = 0; k < method_count; k++) {
        prepare(&methods[k]);
        if (methods[k].able) {
            lower_truth(&methods[k]);
        }
    }
    for (size_t k = 0; k < method_count; k++) {
        if (methods[k].able) {
            judge(&methods[k], &all[k]);
        }
    }
    time_methods(all);
    for (size_t k = 0; k < method_count; k++) {
        if (methods[k].able) {
            print_row(class->name, kinds, &methods[k], &all[k]);
            note_aim(kinds, &methods[k], &all[k]);
            drop_made(&methods[k]);
        }
    }
}

/* ---- peers ---------------------------------------------------------------------------------- */

static void load_peers(const char *program)
{
    static const char *const names[] = {"ode", "bullet", "box3d"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        int count = 0;
        peer_list_function list = NULL;
        *(void **)&list = load_peer(program, names[i], PEER_LIST); /* as POSIX has it */
        const peer *first = list != NULL ? list(&count) : NULL;
        for (int k = 0; k < count && method_count < sizeof methods / sizeof methods[0]; k++) {
            printf("peer: %s, in %s precision\n", first[k].name,
                   first[k].single ? "single" : "double");
            methods[method_count].name = first[k].name;
            methods[method_count++].other = &first[k];
        }
    }
}

/* ---- the whole ------------------------------------------------------------------------------ */

static const int kinds[][2] = {
    {PAIRS_SPHERE, PAIRS_SPHERE},
    {PAIRS_SPHERE, PAIRS_CAPSULE},
    {PAIRS_CAPSULE, PAIRS_CAPSULE},
    {PAIRS_SPHERE, PAIRS_BOX},
    {PAIRS_SPHERE, PLANE},
    {PAIRS_CAPSULE, PLANE},
    {PAIRS_BOX, PLANE},
    {PAIRS_HULL32, PLANE},
    {PAIRS_BOX, PAIRS_BOX},
    {PAIRS_CAPSULE, PAIRS_BOX},
    {PAIRS_CYLINDER, PAIRS_BOX},
    {PAIRS_CYLINDER, PAIRS_CYLINDER},
    {PAIRS_CONE, PAIRS_BOX},
    {PAIRS_ELLIPSOID, PAIRS_ELLIPSOID},
    {PAIRS_HULL32, PAIRS_HULL32},
    {PAIRS_HULL256, PAIRS_HULL256},
};

int main(int argc, char **argv)
{
    static const int classes[] = {1, 15, 4}; /* depth 1e-2, faces 1e-3, depth 1e-6 */
    pairs = calloc(PAIRS, sizeof *pairs);
    if (pairs == NULL) {
        return 1;
    }
    load_peers(argc > 0 ? argv[0] : "");
    printf("%-10s %-19s %-16s %6s %6s %6s %6s %5s %8s %8s %8s %8s\n", "class", "pair", "method",
           "ns med", "least", "wrong%", "miss%", "pts", "depth", "max", "normal", "max");
    for (size_t c = 0; c < sizeof classes / sizeof classes[0]; c++) {
        for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
            bench_kinds(&pairs_classes[classes[c]], kinds[k][0], kinds[k][1]);
        }
    }
    print_aims();
    free(pairs);
    return 0;
}
