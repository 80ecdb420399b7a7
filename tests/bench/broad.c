/* Nanoseconds per body and step of the broad phase: every body moves a little, then all overlapping
 * pairs are listed. From 1e2 to 1e5 boxes at constant density, beside brute force, a plain sweep
 * along one axis and Bullet's tree, if it is there, over the same boxes in the same run, up to 1e4.
 * All must find the same number of pairs.
 *
 *   broad [--full] [BODIES]     greatest number of boxes; --full: 1e6, and the sweep and Bullet up
 *                               to 1e5
 *
 * Boxes lie at random, so that neighbours in space are strangers in memory: the worst case for
 * caches, and what is left of any order after a while. The clock is that of the thread; figures
 * are medians over steps. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/broad.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/problems.h"
#include "full.h"
#include "peers/load.h"
#include "peers/peer.h"

enum { SEED = 20160603, MOST_STEPS = 41, BRUTE_LIMIT = 10000 };

static size_t other_limit = 10000; /* of the sweep and the peer */
static const double room = 2.0;    /* volume per body, whose edges are 0.5 to 1.5 */
static const double stride = 0.01; /* greatest motion per step and axis */
static const double margin = 0.1;
static const double settling =
    60.0; /* steps before the clock starts, so that enlarged boxes are in all states */

/* Boxes as tribo_tree_add takes them, and what the methods need. */
typedef struct crowd {
    size_t count;
    double *boxes; /* 6 each */
    double *velocities;
    uint32_t *pairs;
    size_t capacity;
    uint32_t *order; /* of the sweep: by lower bound along x */
    double *keys;
    problem_random random;
} crowd;

typedef struct timing {
    double add, move, pairs, brute, sweep, peer; /* negative: not done */
    double share;                                /* pairs per body */
} timing;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static double uniform(problem_random *random)
{
    return (double)(problem_random_bits(random) >> 11) * 1.1102230246251565e-16;
}

static void *allocate(size_t size)
{
    void *made = malloc(size);
    if (!made) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return made;
}

static crowd make_crowd(size_t count)
{
    crowd c = {count, NULL, NULL, NULL, 4 * count + 64, NULL, NULL, {SEED}};
    c.boxes = allocate(6 * count * sizeof *c.boxes);
    c.velocities = allocate(3 * count * sizeof *c.velocities);
    c.pairs = allocate(2 * c.capacity * sizeof *c.pairs);
    c.order = allocate(count * sizeof *c.order);
    c.keys = allocate(count * sizeof *c.keys);
    const double side = cbrt(room * (double)count);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            const double middle = side * uniform(&c.random);
            const double half = 0.25 + 0.5 * uniform(&c.random);
            c.boxes[6 * i + k] = middle - half;
            c.boxes[6 * i + 3 + k] = middle + half;
            c.velocities[3 * i + k] = stride * (2.0 * uniform(&c.random) - 1.0);
        }
        c.order[i] = (uint32_t)i;
    }
    return c;
}

static void free_crowd(crowd *c)
{
    free(c->boxes);
    free(c->velocities);
    free(c->pairs);
    free(c->order);
    free(c->keys);
}

/* Straight on, with a new velocity every hundred steps or so; walls reflect. */
static void drift(crowd *c)
{
    const double side = cbrt(room * (double)c->count);
    for (size_t i = 0; i < c->count; i++) {
        const int turns = problem_random_bits(&c->random) % 100 == 0;
        for (size_t k = 0; k < 3; k++) {
            double *v = &c->velocities[3 * i + k];
            double *low = &c->boxes[6 * i + k];
            double *high = &c->boxes[6 * i + 3 + k];
            if (turns) {
                *v = stride * (2.0 * uniform(&c->random) - 1.0);
            }
            if ((*low < 0.0 && *v < 0.0) || (*high > side && *v > 0.0)) {
                *v = -*v;
            }
            *low += *v;
            *high += *v;
        }
    }
}

static int apart(const double *a, const double *b)
{
    return (a[0] > b[3]) | (b[0] > a[3]) | (a[1] > b[4]) | (b[1] > a[4]) | (a[2] > b[5]) |
           (b[2] > a[5]);
}

static void keep(crowd *c, size_t at, uint32_t a, uint32_t b)
{
    if (at < c->capacity) {
        c->pairs[2 * at] = a < b ? a : b;
        c->pairs[2 * at + 1] = a < b ? b : a;
    }
}

static size_t brute_force(crowd *c)
{
    size_t found = 0;
    for (size_t i = 0; i < c->count; i++) {
        for (size_t j = i + 1; j < c->count; j++) {
            if (!apart(c->boxes + 6 * i, c->boxes + 6 * j)) {
                keep(c, found++, (uint32_t)i, (uint32_t)j);
            }
        }
    }
    return found;
}

/* Insertion sort of last step's order, then one pass; pairs come as they are met. */
static size_t sweep(crowd *c)
{
    for (size_t i = 0; i < c->count; i++) {
        const uint32_t body = c->order[i];
        const double key = c->boxes[6 * body];
        size_t to = i;
        for (; to > 0 && c->keys[to - 1] > key; to--) {
            c->keys[to] = c->keys[to - 1];
            c->order[to] = c->order[to - 1];
        }
        c->keys[to] = key;
        c->order[to] = body;
    }
    size_t found = 0;
    for (size_t i = 0; i < c->count; i++) {
        const double *box = c->boxes + 6 * c->order[i];
        for (size_t j = i + 1; j < c->count && c->keys[j] <= box[3]; j++) {
            if (!apart(box, c->boxes + 6 * c->order[j])) {
                keep(c, found++, c->order[i], c->order[j]);
            }
        }
    }
    return found;
}

/* The first sort of a sweep is no insertion sort, and not timed. */
static const double *sorted_boxes;

static int compare_low(const void *x, const void *y)
{
    const double a = sorted_boxes[6 * (size_t) * (const uint32_t *)x];
    const double b = sorted_boxes[6 * (size_t) * (const uint32_t *)y];
    return (a > b) - (a < b);
}

static int compare_doubles(const void *x, const void *y)
{
    const double a = *(const double *)x;
    const double b = *(const double *)y;
    return (a > b) - (a < b);
}

static double median(size_t count, double *values)
{
    qsort(values, count, sizeof *values, compare_doubles);
    return values[count / 2];
}

static void demand(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "broad: %s\n", what);
        exit(1);
    }
}

static void move_all(const crowd *c, tribo_tree *tree)
{
    for (size_t i = 0; i < c->count; i++) {
        (void)tribo_tree_move(tree, (uint32_t)i, c->boxes + 6 * i, c->boxes + 6 * i + 3);
    }
}

/* One timed pass of a method other than the tree; its count must be the tree's. */
static double time_other(crowd *c, size_t (*method)(crowd *), size_t expected)
{
    const double start = now();
    const size_t found = method(c);
    const double ns = now() - start;
    demand(found == expected, "methods disagree on the number of pairs");
    return ns;
}

static const peer_broad *other; /* null: it is not there */

/* The peer's step, moving and listing, over boxes that the tree has been moved to. */
static double time_peer(void *broad, const crowd *c, size_t expected)
{
    const double start = now();
    const size_t found = other->step(broad, c->boxes);
    const double ns = now() - start;
    demand(found == expected, "the peer disagrees on the number of pairs");
    return ns;
}

static timing measure(size_t count, size_t steps)
{
    crowd c = make_crowd(count);
    tribo_tree *tree = NULL;
    void *block = allocate(tribo_tree_size((uint32_t)count));
    demand(tribo_tree_init(block, (uint32_t)count, margin, &tree) == TRIBO_OK, "no tree");
    double times[5][MOST_STEPS];
    timing t = {0};
    t.add = -now();
    for (size_t i = 0; i < count; i++) {
        uint32_t id;
        (void)tribo_tree_add(tree, c.boxes + 6 * i, c.boxes + 6 * i + 3, &id);
    }
    t.add += now();
    void *broad =
        other != NULL && count <= other_limit ? other->make((unsigned)count, c.boxes) : NULL;
    for (double step = 0.0; step < settling; step++) {
        drift(&c);
        move_all(&c, tree);
        if (broad != NULL) {
            (void)other->step(broad, c.boxes);
        }
    }
    sorted_boxes = c.boxes;
    qsort(c.order, count, sizeof *c.order, compare_low);
    size_t found = 0;
    for (size_t step = 0; step < steps; step++) {
        drift(&c);
        times[0][step] = -now();
        move_all(&c, tree);
        const double moved = now();
        times[0][step] += moved;
        demand(tribo_tree_pairs(tree, c.capacity, c.pairs, &found) == TRIBO_OK, "no pairs");
        times[1][step] = now() - moved;
        times[2][step] = count <= BRUTE_LIMIT ? time_other(&c, brute_force, found) : 0.0;
        times[3][step] = count <= other_limit ? time_other(&c, sweep, found) : 0.0;
        times[4][step] = broad != NULL ? time_peer(broad, &c, found) : 0.0;
    }
    const double each = 1.0 / (double)count;
    t.add *= each;
    t.move = median(steps, times[0]) * each;
    t.pairs = median(steps, times[1]) * each;
    t.brute = count <= BRUTE_LIMIT ? median(steps, times[2]) * each : -1.0;
    t.sweep = count <= other_limit ? median(steps, times[3]) * each : -1.0;
    t.peer = broad != NULL ? median(steps, times[4]) * each : -1.0;
    t.share = (double)found * each;
    if (broad != NULL) {
        other->drop(broad);
    }
    free(block);
    free_crowd(&c);
    return t;
}

static void print_other(double ns)
{
    if (ns < 0.0) {
        printf(" %9s", "-");
    } else {
        printf(" %9.1f", ns);
    }
}

int main(int argc, char **argv)
{
    const int full = take_full(&argc, argv);
    const size_t limit = argc > 1 ? strtoul(argv[1], NULL, 10) : full ? 1000000 : 100000;
    other_limit = full ? 100000 : other_limit;
    other = load_peer(argc > 0 ? argv[0] : "", "bullet", PEER_BROAD);
    printf("# broad phase: ns per body and step, one thread; %g of volume per body, motion %g, "
           "margin %g "
           "of mean edge\n",
           room, stride, margin);
    printf(
        "# step = move + list, sorted; brute and sweep list the pairs of the same step, unsorted; "
        "%s: its step\n",
        other != NULL ? other->name : "peer");
    printf("%8s %6s %9s %9s %9s %9s %9s %9s %9s\n", "bodies", "pairs", "step", "move", "list",
           "add", "brute", "sweep", other != NULL ? other->name : "peer");
    for (size_t count = 100; count <= limit; count *= 10) {
        const size_t steps = count < 10000 ? MOST_STEPS : count < 1000000 ? 11 : 5;
        const timing t = measure(count, steps);
        printf("%8zu %6.2f %9.1f %9.1f %9.1f %9.1f", count, t.share, t.move + t.pairs, t.move,
               t.pairs, t.add);
        print_other(t.brute);
        print_other(t.sweep);
        print_other(t.peer);
        printf("\n");
        fflush(stdout);
    }
    return 0;
}
