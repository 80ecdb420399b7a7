/* Counts who is asked: linked with --wrap around the entries of hull code, the general method and
 * of libccd, and with allocators of its own that libraries find before the C library's. Prints one
 * line of TAP, without numbers, for each scene. */
#include <tribo/broad.h>
#include <tribo/collide.h>

#include <ccd/ccd.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hull.h"
#include "pair.h"

/* ---- counters -------------------------------------------------------------------------------- */

static struct {
    unsigned long hull, general, portal, allocated, freed;
} calls;

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void __libc_free(void *block);

void *malloc(size_t size)
{
    calls.allocated++;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    calls.allocated++;
    return __libc_calloc(count, size);
}

void *realloc(void *block, size_t size)
{
    calls.allocated += block == NULL;
    return __libc_realloc(block, size);
}

void free(void *block)
{
    calls.freed += block != NULL;
    __libc_free(block);
}

int __real_ccdMPRPenetration(const void *a, const void *b, const ccd_t *ccd, ccd_real_t *depth,
                             ccd_vec3_t *direction, ccd_vec3_t *point);
int __wrap_ccdMPRPenetration(const void *a, const void *b, const ccd_t *ccd, ccd_real_t *depth,
                             ccd_vec3_t *direction, ccd_vec3_t *point);
int __wrap_ccdMPRPenetration(const void *a, const void *b, const ccd_t *ccd, ccd_real_t *depth,
                             ccd_vec3_t *direction, ccd_vec3_t *point)
{
    calls.portal++;
    return __real_ccdMPRPenetration(a, b, ccd, depth, direction, point);
}

tribo_status __real_convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info);
tribo_status __wrap_convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info);
tribo_status __wrap_convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info)
{
    calls.general++;
    return __real_convex_axis(query, axis, info);
}

int __real_hull_head_is_valid(const void *block);
int __wrap_hull_head_is_valid(const void *block);
int __wrap_hull_head_is_valid(const void *block)
{
    calls.hull++;
    return __real_hull_head_is_valid(block);
}

uint32_t __real_hull_support(const hull_block *hull, const double direction[3]);
uint32_t __wrap_hull_support(const hull_block *hull, const double direction[3]);
uint32_t __wrap_hull_support(const hull_block *hull, const double direction[3])
{
    calls.hull++;
    return __real_hull_support(hull, direction);
}

/* ---- shapes and pairs ------------------------------------------------------------------------ */

static uint64_t seed = 88172645463325252u;

static double between(double low, double high)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

static void user_box(const void *user, const double direction[3], double point[3])
{
    const double *half = user;
    for (int i = 0; i < 3; i++) {
        point[i] = copysign(half[i], direction[i]);
    }
}

static const double user_half[3] = {0.5, 0.6, 0.7};
static const tribo_convex user_convex = {sizeof(tribo_convex), 0,  user_box, NULL, user_half,
                                         {0.0, 0.0, 0.0},      1.1};
static uint64_t hull[1024];

static tribo_shape make_shape(uint32_t type)
{
    tribo_shape s;
    memset(&s, 0, sizeof s);
    s.type = type;
    for (int i = 0; i < 3; i++) {
        s.size[i] = between(0.4, 1.0);
    }
    s.data = type == TRIBO_SHAPE_HULL ? (const void *)hull : &user_convex;
    if (type == TRIBO_SHAPE_HALFSPACE) {
        const double plane[4] = {0.0, 0.6, 0.8, between(-0.2, 0.2)};
        memcpy(s.size, plane, sizeof plane);
    }
    return s;
}

static tribo_pose make_pose(void)
{
    tribo_pose p;
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < 4; i++) {
            p.orientation[i] = between(-1.0, 1.0);
            square += p.orientation[i] * p.orientation[i];
        }
    } while (square < 0.1);
    for (int i = 0; i < 4; i++) {
        p.orientation[i] /= sqrt(square);
    }
    for (int i = 0; i < 3; i++) {
        p.position[i] = between(-0.6, 0.6);
    }
    return p;
}

typedef struct sums {
    unsigned long pairs, touching;
    tribo_collide_info info;
} sums;

/* Each of a list of kinds with each, a number of times. Kinds that have no closed form for each
 * other are passed over if it is asked for. */
static void collide_all(const uint32_t *kinds, int count, int rounds, uint32_t method, sums *sum)
{
    tribo_collide_options options;
    memset(&options, 0, sizeof options);
    memset(sum, 0, sizeof *sum);
    options.struct_size = sizeof options;
    options.method = method;
    for (int i = 0; i < rounds * count * count; i++) {
        const tribo_shape a = make_shape(kinds[i % count]);
        const tribo_shape b = make_shape(kinds[i / count % count]);
        const tribo_pose pa = make_pose();
        const tribo_pose pb = make_pose();
        tribo_manifold manifold;
        tribo_collide_info info;
        uint32_t found = 0;
        memset(&info, 0, sizeof info);
        info.struct_size = sizeof info;
        if (tribo_collide_shapes(&a, &pa, &b, &pb, &options, 1, &manifold, &found, &info) ==
            TRIBO_OK) {
            sum->pairs++;
            sum->touching += found;
            sum->info.general += info.general;
            sum->info.closed += info.closed;
            sum->info.mallocs += info.mallocs;
        }
    }
}

static void report(int good, const char *name, const sums *sum)
{
    printf("%s - %s: %lu pairs, %lu touch; calls: hull %lu, general %lu, libccd %lu, malloc %lu\n",
           good ? "ok" : "not ok", name, sum->pairs, sum->touching, calls.hull, calls.general,
           calls.portal, calls.allocated);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* Spheres with all that one does with shapes: judging, mass, bounds, broad phase, contacts. */
static void spheres(void)
{
    enum { BODIES = 200, PAIRS = 20000 };
    static tribo_shape shapes[BODIES];
    static tribo_pose poses[BODIES];
    static uint32_t pairs[2 * PAIRS];
    static tribo_manifold manifolds[PAIRS];
    static uint64_t block[8192];
    tribo_tree *tree = NULL;
    sums sum;
    size_t count = 0;
    int good = tribo_tree_size(BODIES) <= sizeof block;
    memset(&sum, 0, sizeof sum);
    memset(&calls, 0, sizeof calls);
    good = good && tribo_tree_init(block, BODIES, 0.1, &tree) == TRIBO_OK;
    for (int i = 0; i < BODIES && good; i++) {
        double low[3], high[3], mass, center[3], inertia[9];
        uint32_t id = 0;
        shapes[i] = make_shape(TRIBO_SHAPE_SPHERE);
        shapes[i].data = NULL;
        poses[i] = make_pose();
        good = tribo_shape_mass(&shapes[i], 1000.0, &mass, center, inertia) == TRIBO_OK &&
               tribo_shape_bounds(&shapes[i], &poses[i], low, high) == TRIBO_OK &&
               tribo_tree_add(tree, low, high, &id) == TRIBO_OK && id == (uint32_t)i;
    }
    good = good && tribo_tree_pairs(tree, PAIRS, pairs, &count) == TRIBO_OK &&
           tribo_collide_batch(BODIES, shapes, poses, count, pairs, NULL, manifolds, NULL, NULL) ==
               TRIBO_OK;
    sum.pairs = count;
    for (size_t i = 0; i < count; i++) {
        sum.touching += manifolds[i].count > 0;
    }
    good = good && sum.touching > 1000 && calls.hull + calls.general + calls.portal == 0 &&
           calls.allocated == 0;
    report(good, "spheres need no hull code, no general method, no libccd, no memory", &sum);
}

static void closed_forms(void)
{
    static const uint32_t kinds[] = {
        TRIBO_SHAPE_SPHERE, TRIBO_SHAPE_BOX,       TRIBO_SHAPE_CAPSULE,   TRIBO_SHAPE_CYLINDER,
        TRIBO_SHAPE_CONE,   TRIBO_SHAPE_ELLIPSOID, TRIBO_SHAPE_HALFSPACE, TRIBO_SHAPE_CONVEX};
    sums sum;
    memset(&calls, 0, sizeof calls);
    collide_all(kinds, 8, 100, TRIBO_METHOD_CLOSED, &sum);
    report(sum.touching > 1000 && sum.info.closed == sum.pairs &&
               calls.hull + calls.general + calls.portal + calls.allocated == 0,
           "closed forms need no hull code, no general method, no libccd, no memory", &sum);
}

static void hulls_on_the_ground(void)
{
    static const uint32_t kinds[] = {TRIBO_SHAPE_HULL, TRIBO_SHAPE_HALFSPACE};
    sums sum;
    memset(&calls, 0, sizeof calls);
    collide_all(kinds, 2, 100, TRIBO_METHOD_CLOSED, &sum);
    report(sum.touching > 100 && calls.hull > 0 &&
               calls.general + calls.portal + calls.allocated == 0,
           "hulls on a half-space need no general method, no libccd, no memory", &sum);
}

static void general_pairs(void)
{
    static const uint32_t kinds[] = {TRIBO_SHAPE_SPHERE,   TRIBO_SHAPE_BOX,   TRIBO_SHAPE_CAPSULE,
                                     TRIBO_SHAPE_CYLINDER, TRIBO_SHAPE_CONE,  TRIBO_SHAPE_ELLIPSOID,
                                     TRIBO_SHAPE_HULL,     TRIBO_SHAPE_CONVEX};
    sums sum;
    memset(&calls, 0, sizeof calls);
    collide_all(kinds, 8, 50, TRIBO_METHOD_GENERAL, &sum);
    report(sum.touching > 1000 && sum.info.general == sum.pairs && calls.general == sum.pairs &&
               calls.portal > 1000 && calls.portal <= sum.pairs &&
               calls.allocated <= sum.info.mallocs,
           "libccd is asked at most once a pair, and allocates no more than the info says", &sum);
}

/* ---- whether the counters count -------------------------------------------------------------- */

static void ball_support(const void *center, const ccd_vec3_t *direction, ccd_vec3_t *out)
{
    const ccd_vec3_t *c = center;
    const double size = sqrt(ccdVec3Len2(direction));
    for (int i = 0; i < 3; i++) {
        out->v[i] = c->v[i] + direction->v[i] / size;
    }
}

/* libccd's own expanding polytope allocates: that has to be seen. */
static void counters_count(void)
{
    static const ccd_vec3_t a = {{0.0, 0.0, 0.0}};
    static const ccd_vec3_t b = {{0.3, 0.4, 0.5}};
    ccd_t ccd;
    ccd_real_t depth;
    ccd_vec3_t direction, point;
    sums sum;
    memset(&sum, 0, sizeof sum);
    memset(&calls, 0, sizeof calls);
    CCD_INIT(&ccd);
    ccd.max_iterations = 100;
    ccd.support1 = ball_support;
    ccd.support2 = ball_support;
    sum.touching = ccdGJKPenetration(&a, &b, &ccd, &depth, &direction, &point) == 0;
    sum.pairs = 1;
    report(sum.touching == 1 && calls.allocated > 0,
           "what libccd allocates is seen (by its polytope, which is not used)", &sum);
}

static void building_hulls(void)
{
    double points[3 * 20];
    sums sum;
    for (int i = 0; i < 60; i++) {
        points[i] = between(-1.0, 1.0);
    }
    memset(&sum, 0, sizeof sum);
    memset(&calls, 0, sizeof calls);
    const tribo_status status = tribo_hull_build(20, points, hull, sizeof hull, NULL);
    report(status == TRIBO_OK && calls.allocated > 0 && calls.freed == calls.allocated,
           "building a hull allocates, and frees all of it", &sum);
}

int main(void)
{
    static char line[4096];
    (void)setvbuf(stdout, line, _IOFBF, sizeof line); /* else the first line allocates */
    building_hulls();
    spheres();
    closed_forms();
    hulls_on_the_ground();
    general_pairs();
    counters_count();
    return 0;
}
