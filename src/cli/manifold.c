#include "manifold.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

static const double DEGREE = 0.017453292519943295769; /* in radians */

static tribo_status turn(double degrees, const double axis[3], double orientation[4])
{
    double vector[3];

    tribo_vec3_scale(degrees * DEGREE, axis, vector);
    return tribo_quat_from_rotation_vector(vector, orientation);
}

static tribo_status find(const tribo_shape *shapes, const tribo_pose *poses, uint32_t method,
                         tribo_manifold *manifold, uint32_t *count)
{
    const tribo_collide_options options = {.struct_size = sizeof options, .method = method};

    return tribo_collide_shapes(&shapes[0], &poses[0], &shapes[1], &poses[1], &options, 1, manifold,
                                count, NULL);
}

/* ---- what is drawn --------------------------------------------------------------------------- */

enum { PRISM = 12 };

/* Room for the block of a hull of a few points. */
typedef double hull_block[512];

/* A hexagonal prism that widens upwards, its lower face at z = 0. */
static tribo_status make_prism(hull_block block, tribo_shape *shape)
{
    double points[3 * PRISM];

    for (int i = 0; i < PRISM; i++) {
        const double angle = 60.0 * DEGREE * (i % 6), radius = i < 6 ? 0.36 : 0.5;
        points[3 * i] = radius * cos(angle);
        points[3 * i + 1] = radius * sin(angle);
        points[3 * i + 2] = i < 6 ? 0.0 : 0.55;
    }
    shape->type = TRIBO_SHAPE_HULL;
    shape->data = block;
    return tribo_hull_build(PRISM, points, block, sizeof(hull_block), NULL);
}

static tribo_status place_boxes(manifold_scene *scene)
{
    static const double up[3] = {0.0, 0.0, 1.0};

    *scene = (manifold_scene){
        .title = "box on box, turned by 50\u00b0",
        .shapes = {{.type = TRIBO_SHAPE_BOX, .size = {0.45, 0.45, 0.25}},
                   {.type = TRIBO_SHAPE_BOX, .size = {0.5, 0.5, 0.2}}},
        .poses = {{.position = {0.0, 0.0, 0.24}},
                  {.position = {0.0, 0.0, -0.2}, .orientation = {1.0, 0.0, 0.0, 0.0}}}};
    return turn(50.0, up, scene->poses[0].orientation);
}

static tribo_status place_capsule(manifold_scene *scene)
{
    static const double across[3] = {0.0, 1.0, 0.0};

    *scene = (manifold_scene){
        .title = "capsule over the edge of a box",
        .shapes = {{.type = TRIBO_SHAPE_CAPSULE, .size = {0.16, 0.45}},
                   {.type = TRIBO_SHAPE_BOX, .size = {0.5, 0.5, 0.2}}},
        .poses = {{.position = {0.3, 0.1, 0.15}},
                  {.position = {0.0, 0.0, -0.2}, .orientation = {1.0, 0.0, 0.0, 0.0}}}};
    return turn(90.0, across, scene->poses[0].orientation);
}

/* The slope turns the half-space and the hull alike. */
static tribo_status place_hull(manifold_scene *scene)
{
    static const double slope[3] = {0.0, 1.0, 0.0};
    static hull_block block;

    *scene = (manifold_scene){
        .title = "hull on a sloping plane",
        .shapes = {{.type = TRIBO_SHAPE_HULL}, {.type = TRIBO_SHAPE_HALFSPACE, .size = {0, 0, 1}}},
        .poses = {{.position = {0.0, 0.0, -0.01}}}};
    tribo_status status = make_prism(block, &scene->shapes[0]);
    for (int i = 0; i < 2 && status == TRIBO_OK; i++)
        status = turn(12.0, slope, scene->poses[i].orientation);
    return status;
}

tribo_status manifold_scenes(manifold_scene scenes[MANIFOLD_SCENES])
{
    tribo_status status = place_boxes(&scenes[0]);

    if (status == TRIBO_OK)
        status = place_capsule(&scenes[1]);
    if (status == TRIBO_OK)
        status = place_hull(&scenes[2]);
    for (int i = 0; i < MANIFOLD_SCENES && status == TRIBO_OK; i++) {
        uint32_t count = 0;
        status = find(scenes[i].shapes, scenes[i].poses, TRIBO_METHOD_AUTOMATIC,
                      &scenes[i].manifold, &count);
        if (status == TRIBO_OK && count == 0)
            status = TRIBO_ERROR_PAIR;
    }
    return status;
}

/* ---- pairs of boxes of known depth ----------------------------------------------------------- */

typedef struct box_pair {
    double half[2][3];
    double axes[2][9]; /* rows: the axes of each box in the world */
    tribo_pose poses[2];
    double depth;
    double normal[3]; /* from B to A */
} box_pair;

/* The same pairs as boxes, as hulls of eight points, and with a half-space in place of B. */
typedef struct pair_set {
    box_pair boxes[MANIFOLD_PAIRS];
    tribo_shape shapes[MANIFOLD_PAIRS][2];
    tribo_pose poses[MANIFOLD_PAIRS][2];
    hull_block blocks[MANIFOLD_PAIRS][2];
} pair_set;

/* xorshift64*, G. Marsaglia and S. Vigna: the same pairs at each run. */
static double uniform(uint64_t *state, double low, double high)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    const uint64_t bits = (*state * UINT64_C(2685821657736338717)) >> 11;
    return low + (high - low) * ((double)bits / 9007199254740992.0);
}

/* How far A has to go along the unit vector n until it is clear of B. */
static double way_along(const box_pair *pair, const double n[3])
{
    double offset[3], way;

    tribo_vec3_subtract(pair->poses[1].position, pair->poses[0].position, offset);
    way = tribo_vec3_dot(offset, n);
    for (int i = 0; i < 6; i++)
        way += pair->half[i / 3][i % 3] * fabs(tribo_vec3_dot(&pair->axes[i / 3][3 * (i % 3)], n));
    return way;
}

static void try_axis(box_pair *pair, const double axis[3])
{
    double n[3];
    const double size = tribo_vec3_norm(axis);

    if (size < 1e-9)
        return; /* parallel edges: a face is as good */
    for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
        tribo_vec3_scale(sign / size, axis, n);
        const double way = way_along(pair, n);
        if (way < pair->depth) {
            pair->depth = way;
            memcpy(pair->normal, n, sizeof n);
        }
    }
}

/* The least way, by separating axes. */
static void find_truth(box_pair *pair)
{
    double cross[3];

    pair->depth = DBL_MAX;
    for (int i = 0; i < 6; i++)
        try_axis(pair, &pair->axes[i / 3][3 * (i % 3)]);
    for (int i = 0; i < 9; i++) {
        tribo_vec3_cross(&pair->axes[0][3 * (i / 3)], &pair->axes[1][3 * (i % 3)], cross);
        try_axis(pair, cross);
    }
}

/* Pulled apart along the direction of the least way, that stays the least, until it is a
 * hundredth of the least half-size. */
static tribo_status make_pair(uint64_t *state, box_pair *pair)
{
    double least = 1.0, turned[3];
    tribo_status status = TRIBO_OK;

    for (int i = 0; i < 2 && status == TRIBO_OK; i++) {
        for (int k = 0; k < 3; k++) {
            pair->half[i][k] = uniform(state, 0.3, 1.0);
            pair->poses[i].position[k] = uniform(state, -0.2, 0.2);
            turned[k] = uniform(state, -2.0, 2.0);
            least = fmin(least, pair->half[i][k]);
        }
        status = tribo_quat_from_rotation_vector(turned, pair->poses[i].orientation);
        for (int k = 0; k < 3; k++) {
            const double axis[3] = {k == 0, k == 1, k == 2};
            tribo_quat_rotate(pair->poses[i].orientation, axis, &pair->axes[i][3 * k]);
        }
    }
    find_truth(pair);
    tribo_vec3_add_scaled(pair->poses[0].position, pair->depth - 0.01 * least, pair->normal,
                          pair->poses[0].position);
    pair->depth = way_along(pair, pair->normal);
    return status;
}

static tribo_status hull_of_box(const double half[3], hull_block block, tribo_shape *shape)
{
    double points[24];

    for (int i = 0; i < 24; i++)
        points[i] = (i / 3 >> i % 3 & 1) != 0 ? half[i % 3] : -half[i % 3];
    shape->type = TRIBO_SHAPE_HULL;
    shape->data = block;
    return tribo_hull_build(8, points, block, sizeof(hull_block), NULL);
}

/* The half-space that ends where B does, seen along the normal. */
static void halfspace_of_box(const box_pair *pair, tribo_shape *shape, tribo_pose *pose)
{
    const double *n = pair->normal;

    memset(shape, 0, sizeof *shape);
    memset(pose, 0, sizeof *pose);
    shape->type = TRIBO_SHAPE_HALFSPACE;
    memcpy(shape->size, n, 3 * sizeof *n);
    shape->size[3] = tribo_vec3_dot(n, pair->poses[1].position);
    for (int k = 0; k < 3; k++)
        shape->size[3] += pair->half[1][k] * fabs(tribo_vec3_dot(&pair->axes[1][3 * k], n));
    pose->orientation[0] = 1.0;
}

static tribo_status make_set(pair_set *set)
{
    uint64_t state = UINT64_C(20260603);
    tribo_status status = TRIBO_OK;

    for (size_t i = 0; i < MANIFOLD_PAIRS && status == TRIBO_OK; i++)
        status = make_pair(&state, &set->boxes[i]);
    return status;
}

enum { AS_BOXES, AS_HULLS, AS_PLANES };

static tribo_status dress(pair_set *set, int kind)
{
    tribo_status status = TRIBO_OK;

    for (size_t i = 0; i < 2 * MANIFOLD_PAIRS && status == TRIBO_OK; i++) {
        const box_pair *pair = &set->boxes[i / 2];
        tribo_shape *shape = &set->shapes[i / 2][i % 2];
        memset(shape, 0, sizeof *shape);
        shape->type = TRIBO_SHAPE_BOX;
        memcpy(shape->size, pair->half[i % 2], sizeof pair->half[0]);
        set->poses[i / 2][i % 2] = pair->poses[i % 2];
        if (kind == AS_HULLS)
            status = hull_of_box(pair->half[i % 2], set->blocks[i / 2][i % 2], shape);
        else if (kind == AS_PLANES && i % 2 == 1)
            halfspace_of_box(pair, shape, &set->poses[i / 2][1]);
    }
    return status;
}

/* ---- speed and error ------------------------------------------------------------------------- */

static double run_once(const pair_set *set, uint32_t method)
{
    tribo_manifold manifold;
    uint32_t count;
    const double start = cli_now(NULL);

    for (size_t i = 0; i < MANIFOLD_PAIRS; i++)
        find(set->shapes[i], set->poses[i], method, &manifold, &count);
    return cli_now(NULL) - start;
}

/* The least of at least three runs, and of as many as fit into a twentieth of a second. */
static double nanoseconds_per_pair(const pair_set *set, uint32_t method)
{
    double least = run_once(set, method), sum = least;

    for (int run = 1; run < 3 || sum < 0.05; run++) {
        const double seconds = run_once(set, method);
        least = fmin(least, seconds);
        sum += seconds;
    }
    return least * 1e9 / MANIFOLD_PAIRS;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* What does not touch at all has an error of 1. Against a half-space all normals but one are
 * wrong. */
static tribo_status judge(const pair_set *set, size_t i, int kind, uint32_t method, double *error,
                          manifold_result *sums)
{
    const box_pair *pair = &set->boxes[i];
    tribo_manifold manifold;
    uint32_t count = 0;
    const tribo_status status = find(set->shapes[i], set->poses[i], method, &manifold, &count);

    *error = 1.0;
    if (status != TRIBO_OK || count == 0)
        return status;
    double deepest = manifold.points[0].distance;
    for (uint32_t k = 1; k < manifold.count; k++)
        deepest = fmin(deepest, manifold.points[k].distance);
    *error = fabs(-deepest - pair->depth) / pair->depth;
    sums->points += manifold.count;
    if (kind == AS_PLANES)
        sums->wrong += !(tribo_vec3_dot(manifold.normal, pair->normal) > 1.0 - 1e-12);
    else
        sums->wrong += !(way_along(pair, manifold.normal) <= 1.01 * pair->depth);
    return TRIBO_OK;
}

static tribo_status survey_method(pair_set *set, const char *name, int kind, uint32_t method,
                                  manifold_result *result)
{
    static double errors[MANIFOLD_PAIRS];
    manifold_result sums = {.name = name};
    tribo_status status = dress(set, kind);

    for (size_t i = 0; i < MANIFOLD_PAIRS && status == TRIBO_OK; i++)
        status = judge(set, i, kind, method, &errors[i], &sums);
    if (status != TRIBO_OK)
        return status;
    qsort(errors, MANIFOLD_PAIRS, sizeof errors[0], compare);
    sums.median_error = errors[MANIFOLD_PAIRS / 2];
    sums.greatest_error = errors[MANIFOLD_PAIRS - 1];
    sums.wrong /= MANIFOLD_PAIRS;
    sums.points /= MANIFOLD_PAIRS;
    sums.nanoseconds = nanoseconds_per_pair(set, method);
    *result = sums;
    return TRIBO_OK;
}

tribo_status manifold_survey(manifold_result results[MANIFOLD_METHODS])
{
    static pair_set set;
    static const struct {
        const char *name;
        int kind;
        uint32_t method;
    } methods[MANIFOLD_METHODS] = {{"box-plane", AS_PLANES, TRIBO_METHOD_CLOSED},
                                   {"box-box", AS_BOXES, TRIBO_METHOD_CLOSED},
                                   {"box-box, general", AS_BOXES, TRIBO_METHOD_GENERAL},
                                   {"the same as hulls", AS_HULLS, TRIBO_METHOD_AUTOMATIC}};
    tribo_status status = make_set(&set);

    for (size_t i = 0; i < MANIFOLD_METHODS && status == TRIBO_OK; i++)
        status =
            survey_method(&set, methods[i].name, methods[i].kind, methods[i].method, &results[i]);
    return status;
}
