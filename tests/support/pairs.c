/* Pairs of known depth and libccd alone on them. */
#include "pairs.h"

#include "problems.h"

#include <ccd/ccd.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const pairs_kind_names[PAIRS_KINDS] = {
    "sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "hull32", "hull256", "user"};

const pairs_class pairs_classes[] = {
    {"depth 0.2", PAIRS_ANYHOW, 0.2, 1.0, 3.0, 0.0},
    {"depth 1e-2", PAIRS_ANYHOW, 1e-2, 1.0, 3.0, 0.0},
    {"depth 1e-3", PAIRS_ANYHOW, 1e-3, 1.0, 3.0, 0.0},
    {"depth 1e-4", PAIRS_ANYHOW, 1e-4, 1.0, 3.0, 0.0},
    {"depth 1e-6", PAIRS_ANYHOW, 1e-6, 1.0, 3.0, 0.0},
    {"touching", PAIRS_ANYHOW, 0.0, 1.0, 3.0, 0.0},
    {"gap 1e-6", PAIRS_ANYHOW, -1e-6, 1.0, 3.0, 0.0},
    {"gap 1e-2", PAIRS_ANYHOW, -1e-2, 1.0, 3.0, 0.0},
    {"size 1e-3 m, 1e-3", PAIRS_ANYHOW, 1e-3, 1e-3, 3.0, 0.0},
    {"size 1e3 m, 1e-3", PAIRS_ANYHOW, 1e-3, 1e3, 3.0, 0.0},
    {"aspect 1e4, 0.2", PAIRS_ANYHOW, 0.2, 1.0, 1e4, 0.0},
    {"aspect 1e4, 1e-2", PAIRS_ANYHOW, 1e-2, 1.0, 1e4, 0.0},
    {"aspect 1e4, 1e-4", PAIRS_ANYHOW, 1e-4, 1.0, 1e4, 0.0},
    {"offset 1e6 m, 1e-3", PAIRS_ANYHOW, 1e-3, 1.0, 3.0, 1e6},
    {"faces 0.2", PAIRS_FACES, 0.2, 1.0, 3.0, 0.0},
    {"faces 1e-3", PAIRS_FACES, 1e-3, 1.0, 3.0, 0.0},
    {"faces 1e-6", PAIRS_FACES, 1e-6, 1.0, 3.0, 0.0},
    {"edges 0.2", PAIRS_EDGES, 0.2, 1.0, 3.0, 0.0},
    {"edges 1e-3", PAIRS_EDGES, 1e-3, 1.0, 3.0, 0.0},
    {"edges 1e-6", PAIRS_EDGES, 1e-6, 1.0, 3.0, 0.0},
    {"concentric", PAIRS_CONCENTRIC, 0.0, 1.0, 3.0, 0.0},
    {"plates 2000:1 0.2", PAIRS_PLATES, 0.2, 1.0, 3.0, 0.0},
    {"plates 2000:1 1e-4", PAIRS_PLATES, 1e-4, 1.0, 3.0, 0.0},
    {"plates 2000:1 1e-6", PAIRS_PLATES, 1e-6, 1.0, 3.0, 0.0},
    {"apart 1e-2", PAIRS_APART, -1e-2, 1.0, 3.0, 0.0},
    {"apart 1e-5", PAIRS_APART, -1e-5, 1.0, 3.0, 0.0},
    {"apart 1e-6", PAIRS_APART, -1e-6, 1.0, 3.0, 0.0},
    {"apart 1e-7", PAIRS_APART, -1e-7, 1.0, 3.0, 0.0},
    {"apart 1e-8", PAIRS_APART, -1e-8, 1.0, 3.0, 0.0},
};

const int pairs_class_count = (int)(sizeof pairs_classes / sizeof pairs_classes[0]);

/* ---- hulls
 * -------------------------------------------------------------------------------------- */

enum { HULLS = 6 };

typedef struct hull_entry {
    double scale;
    double stretch[3];
    truth_polytope core;
    void *block;
} hull_entry;

static hull_entry pool[2][HULLS];

/* Hulls of points on an ellipsoid are kept until another scale or aspect is asked for. */
static const hull_entry *draw_hull(int large, const pairs_class *class, problem_random *random)
{
    const int count = large ? 256 : 32;
    const int i = (int)problem_random_uniform(random, 0.0, HULLS);
    hull_entry *entry = &pool[large][i];
    double points[3 * 256];
    problem_random own;
    problem_random_start(&own, 77, (uint64_t)count, (uint64_t)i);
    double stretch[3];
    for (int c = 0; c < 3; c++) {
        stretch[c] = class->scale * problem_random_decades(&own, -log10(class->aspect), 0.0);
    }
    if (entry->block != NULL && memcmp(entry->stretch, stretch, sizeof stretch) == 0) {
        return entry;
    }
    for (int k = 0; k < count; k++) {
        double p[3];
        problem_random_direction(&own, 3, p);
        for (int c = 0; c < 3; c++) {
            points[3 * k + c] = stretch[c] * p[c];
        }
    }
    size_t needed = 0;
    memcpy(entry->stretch, stretch, sizeof stretch);
    free(entry->block);
    entry->block = NULL;
    (void)tribo_hull_build((size_t)count, points, NULL, 0, &needed);
    entry->block = malloc(needed);
    if (entry->block == NULL || !truth_wrap(count, points, &entry->core) ||
        tribo_hull_build((size_t)count, points, entry->block, needed, NULL) != TRIBO_OK) {
        abort();
    }
    return entry;
}

/* ---- bodies
 * ------------------------------------------------------------------------------------- */

static void box_support(const void *user, const double direction[3], double point[3])
{
    const double *half = user;
    for (int i = 0; i < 3; i++) {
        point[i] = copysign(half[i], direction[i]);
    }
}

static void user_shape(pairs_pair *pair, int i)
{
    const double *half = pair->body[i].size;
    tribo_convex *user = &pair->user[i];
    memset(user, 0, sizeof *user);
    user->struct_size = sizeof *user;
    user->support = box_support;
    user->user = half;
    user->radius = (1.0 + 1e-12) * sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    memset(pair->shape[i].size, 0, sizeof pair->shape[i].size);
    pair->shape[i].data = user;
}

static const uint32_t shape_types[PAIRS_KINDS] = {
    TRIBO_SHAPE_SPHERE,   TRIBO_SHAPE_BOX,  TRIBO_SHAPE_CAPSULE,
    TRIBO_SHAPE_CYLINDER, TRIBO_SHAPE_CONE, TRIBO_SHAPE_ELLIPSOID,
    TRIBO_SHAPE_HULL,     TRIBO_SHAPE_HULL, TRIBO_SHAPE_CONVEX};

static const int size_counts[PAIRS_KINDS] = {1, 3, 2, 2, 2, 3, 0, 0, 3};

/* Sizes given, makes the shape and its twin; notes the least and greatest size. */
static void make_body(pairs_pair *pair, int i, const hull_entry *hull)
{
    const int kind = pair->kind[i];
    const double *size = hull != NULL ? hull->stretch : pair->body[i].size;
    const int count = hull != NULL ? 3 : size_counts[kind];
    tribo_shape *shape = &pair->shape[i];
    truth_body *body = &pair->body[i];
    memset(shape, 0, sizeof *shape);
    shape->type = shape_types[kind];
    body->type = kind == PAIRS_USER ? (uint32_t)TRIBO_SHAPE_BOX : shape->type;
    for (int c = 0; c < count; c++) {
        shape->size[c] = hull != NULL ? 0.0 : size[c];
        pair->small = fmin(pair->small, size[c]);
        pair->large = fmax(pair->large, size[c]);
    }
    body->radius = kind == PAIRS_SPHERE || kind == PAIRS_CAPSULE ? size[0] : 0.0;
    body->core = NULL;
    if (hull != NULL) {
        body->core = &hull->core;
        shape->data = hull->block;
    } else if (kind != PAIRS_CYLINDER && kind != PAIRS_CONE && kind != PAIRS_ELLIPSOID) {
        truth_core(body->type, size, &pair->core[i]);
        body->core = &pair->core[i];
    }
    if (kind == PAIRS_USER) {
        user_shape(pair, i);
    }
}

static void draw_body(const pairs_class *class, int plate, problem_random *random, pairs_pair *pair,
                      int i)
{
    static const int plates[3] = {PAIRS_BOX, PAIRS_CYLINDER, PAIRS_USER};
    const hull_entry *hull = NULL;
    if (pair->kind[i] < 0) {
        pair->kind[i] = plate ? plates[(int)problem_random_uniform(random, 0.0, 3.0)]
                              : (int)problem_random_uniform(random, 0.0, PAIRS_KINDS);
    }
    const int kind = pair->kind[i];
    for (int c = 0; c < 3; c++) {
        pair->body[i].size[c] =
            class->scale * problem_random_decades(random, -log10(class->aspect), 0.0);
    }
    if (plate) {
        const double wide = 1000.0 * class->scale;
        const double box[3] = {wide, wide, class->scale};
        const double disc[3] = {wide, class->scale, 0.0};
        memcpy(pair->body[i].size, kind == PAIRS_CYLINDER ? disc : box, sizeof box);
    }
    if (kind == PAIRS_HULL32 || kind == PAIRS_HULL256) {
        hull = draw_hull(kind == PAIRS_HULL256, class, random);
    }
    make_body(pair, i, hull);
}

/* ---- poses
 * -------------------------------------------------------------------------------------- */

static void product(const double *p, const double *q, double *out)
{
    const double x[4] = {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
                         p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                         p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
                         p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
    memcpy(out, x, sizeof x);
}

static void turn_by(double angle, const double *axis, double *q)
{
    q[0] = cos(0.5 * angle);
    for (int i = 0; i < 3; i++) {
        q[1 + i] = sin(0.5 * angle) * axis[i];
    }
}

/* A quarter turn about one axis now and then, so that any face meets any. */
static void quarter(problem_random *random, double *q)
{
    double axis[3] = {0.0, 0.0, 0.0};
    double turn[4];
    axis[(int)problem_random_uniform(random, 0.0, 3.0)] = 1.0;
    turn_by(1.5707963267948966 * floor(problem_random_uniform(random, 0.0, 4.0)), axis, turn);
    product(q, turn, q);
}

static void orient(const pairs_class *class, problem_random *random, pairs_pair *pair)
{
    double axis[3];
    double turn[4];
    double *qa = pair->pose[0].orientation;
    double *qb = pair->pose[1].orientation;
    problem_random_direction(random, 4, qa);
    problem_random_direction(random, 4, qb);
    if (problem_random_uniform(random, 0.0, 1.0) < 0.3) {
        const double upright[4] = {1.0, 0.0, 0.0, 0.0};
        memcpy(qa, upright, sizeof upright);
    }
    if (class->arrangement == PAIRS_ANYHOW) {
        return;
    }
    memcpy(qb, qa, 4 * sizeof *qb);
    quarter(random, qb);
    if (class->arrangement == PAIRS_EDGES) {
        memset(axis, 0, sizeof axis);
        axis[(int)problem_random_uniform(random, 0.0, 3.0)] = 1.0;
        turn_by(problem_random_uniform(random, 0.0, 6.28), axis, turn);
        product(qb, turn, qb);
    } else if (problem_random_uniform(random, 0.0, 1.0) < 0.5) {
        problem_random_direction(random, 3, axis);
        turn_by(problem_random_decades(random, -12.0, -3.0), axis, turn);
        product(qb, turn, qb);
    }
}

static void matrix(const double *q, double *r)
{
    const double w = q[0];
    const double x = q[1];
    const double y = q[2];
    const double z = q[3];
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    const double m[9] = {
        1.0 - s * (y * y + z * z), s * (x * y - w * z),       s * (x * z + w * y),
        s * (x * y + w * z),       1.0 - s * (x * x + z * z), s * (y * z - w * x),
        s * (x * z - w * y),       s * (y * z + w * x),       1.0 - s * (x * x + y * y)};
    memcpy(r, m, sizeof m);
}

/* Support point of a body, own axes; a face gives one of its corners. */
static void farthest(const pairs_pair *pair, int i, const double *n, double *point)
{
    const truth_body *body = &pair->body[i];
    const double *s = body->size;
    const double flat = hypot(n[0], n[1]);
    if (body->core != NULL) {
        double most = -HUGE_VAL;
        for (int k = 0; k < body->core->vertices; k++) {
            const double *v = body->core->vertex[k];
            const double along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
            if (along > most) {
                most = along;
                memcpy(point, v, 3 * sizeof *point);
            }
        }
        for (int c = 0; c < 3; c++) {
            point[c] += body->radius * n[c];
        }
    } else if (body->type == TRIBO_SHAPE_ELLIPSOID) {
        const double size =
            sqrt(s[0] * s[0] * n[0] * n[0] + s[1] * s[1] * n[1] * n[1] + s[2] * s[2] * n[2] * n[2]);
        for (int c = 0; c < 3; c++) {
            point[c] = s[c] * s[c] * n[c] / size;
        }
    } else {
        point[0] = s[0] * n[0] / flat;
        point[1] = s[0] * n[1] / flat;
        point[2] = body->type == TRIBO_SHAPE_CONE ? -s[1] : copysign(s[1], n[2]);
    }
}

static void turned(const double *r, const double *v, double *out)
{
    for (int i = 0; i < 3; i++) {
        out[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
    }
}

/* Puts a random point inside of A on one inside of B. */
static void overlap(problem_random *random, pairs_pair *pair)
{
    double at[2][3];
    for (int i = 0; i < 2; i++) {
        double n[2][3];
        double p[2][3];
        double mixed[3];
        const double share = problem_random_uniform(random, 0.0, 1.0);
        const double out = pow(problem_random_uniform(random, 0.0, 1.0), 0.4);
        for (int k = 0; k < 2; k++) {
            problem_random_direction(random, 3, n[k]);
            farthest(pair, i, n[k], p[k]);
        }
        for (int c = 0; c < 3; c++) {
            mixed[c] = out * (share * p[0][c] + (1.0 - share) * p[1][c]);
        }
        turned(pair->body[i].rotation, mixed, at[i]);
    }
    for (int c = 0; c < 3; c++) {
        pair->body[1].position[c] = at[0][c] - at[1][c];
    }
}

static void concentric(problem_random *random, pairs_pair *pair)
{
    double way[3];
    const double off = problem_random_uniform(random, 0.0, 1.0) < 0.5
                           ? 0.0
                           : pair->small * problem_random_decades(random, -16.0, -3.0);
    problem_random_direction(random, 3, way);
    for (int c = 0; c < 3; c++) {
        pair->body[1].position[c] = off * way[c];
    }
}

/* One of the points of a core, own axes, that are farthest along n: a mixture of the vertices. */
static void spot_of_core(const truth_polytope *core, const double *n, problem_random *random,
                         double *point)
{
    double most = -HUGE_VAL;
    double sum = 0.0;
    double mixed[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < core->vertices; k++) {
        const double *v = core->vertex[k];
        most = fmax(most, n[0] * v[0] + n[1] * v[1] + n[2] * v[2]);
    }
    for (int k = 0; k < core->vertices; k++) {
        const double *v = core->vertex[k];
        if (n[0] * v[0] + n[1] * v[1] + n[2] * v[2] >= most - 1e-14) {
            const double weight = problem_random_uniform(random, 0.01, 1.0);
            sum += weight;
            for (int c = 0; c < 3; c++) {
                mixed[c] += weight * v[c];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        point[c] = mixed[c] / sum;
    }
}

/* The same of a cylinder or cone: a cap, its rim, a line of the side, the tip. */
static void spot_of_turned(const truth_body *body, const double *n, problem_random *random,
                           double *point)
{
    const int cone = body->type == TRIBO_SHAPE_CONE;
    const double r = body->size[0];
    const double h = body->size[1];
    const double flat = hypot(n[0], n[1]);
    const double turn = problem_random_uniform(random, 0.0, 6.28);
    const double share = sqrt(problem_random_uniform(random, 0.0, 1.0));
    const double side = cone ? r * flat - 2.0 * h * n[2] : -n[2]; /* > 0: the lower rim is */
    const double line = fabs(side) < 1e-14 ? problem_random_uniform(random, 0.0, 1.0) : side > 0.0;
    const double radius = cone ? line * r : r;
    point[0] = flat > 1e-14 ? radius * n[0] / flat : share * radius * cos(turn);
    point[1] = flat > 1e-14 ? radius * n[1] / flat : share * radius * sin(turn);
    point[2] = (1.0 - 2.0 * line) * h;
}

/* World axes, from the position of the body. */
static void spot(const pairs_pair *pair, int i, const double *n, problem_random *random, double *at)
{
    const truth_body *body = &pair->body[i];
    const double *r = body->rotation;
    double own[3];
    double point[3];
    for (int c = 0; c < 3; c++) {
        own[c] = r[c] * n[0] + r[3 + c] * n[1] + r[6 + c] * n[2];
    }
    if (body->core != NULL) {
        spot_of_core(body->core, own, random, point);
    } else if (body->type == TRIBO_SHAPE_ELLIPSOID) {
        farthest(pair, i, own, point);
    } else {
        spot_of_turned(body, own, random, point);
    }
    turned(r, point, at);
    for (int c = 0; c < 3; c++) {
        at[c] += body->radius * n[c];
    }
}

/* Any direction, an axis of a body, or one square to such an axis. */
static void draw_way(const pairs_pair *pair, problem_random *random, double *n)
{
    const double *r = pair->body[problem_random_uniform(random, 0.0, 1.0) < 0.5 ? 0 : 1].rotation;
    const int k = (int)problem_random_uniform(random, 0.0, 3.0);
    const double axis[3] = {r[k], r[3 + k], r[6 + k]};
    const double which = problem_random_uniform(random, 0.0, 1.0);
    double other[3];
    problem_random_direction(random, 3, n);
    if (which < 0.3) {
        memcpy(n, axis, sizeof axis);
    } else if (which < 0.6) {
        memcpy(other, n, sizeof other);
        for (int c = 0; c < 3; c++) {
            n[c] = axis[(c + 1) % 3] * other[(c + 2) % 3] - axis[(c + 2) % 3] * other[(c + 1) % 3];
        }
        const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int c = 0; c < 3; c++) {
            n[c] /= size;
        }
    }
}

/* Points of both that are farthest along n, one before the other: no two are nearer. */
static void apart(problem_random *random, double gap, pairs_pair *pair)
{
    double at[2][3];
    double back[3];
    draw_way(pair, random, pair->normal);
    for (int c = 0; c < 3; c++) {
        back[c] = -pair->normal[c];
    }
    spot(pair, 0, back, random, at[0]);
    spot(pair, 1, pair->normal, random, at[1]);
    for (int c = 0; c < 3; c++) {
        pair->body[1].position[c] = at[0][c] - at[1][c] - gap * pair->normal[c];
    }
}

/* Far from the origin positions are rounded; what was meant is what is left of it. */
static void place(const pairs_class *class, problem_random *random, pairs_pair *pair)
{
    double way[3];
    problem_random_direction(random, 3, way);
    for (int c = 0; c < 3; c++) {
        pair->pose[0].position[c] = class->far * way[c];
        pair->pose[1].position[c] = pair->pose[0].position[c] + pair->body[1].position[c];
        pair->body[1].position[c] = pair->pose[1].position[c] - pair->pose[0].position[c];
    }
}

/* Pulling two bodies apart along the direction of least depth keeps it the least, exactly:
 * every other direction m loses less, by m . n. So one search for the depth serves all depths
 * below it. */
static int draw_pair(const pairs_class *class, problem_random *random, pairs_pair *pair)
{
    double wanted = class->depth * pair->small;
    orient(class, random, pair);
    for (int i = 0; i < 2; i++) {
        matrix(pair->pose[i].orientation, pair->body[i].rotation);
        memset(pair->body[i].position, 0, sizeof pair->body[i].position);
    }
    if (class->arrangement == PAIRS_CONCENTRIC) {
        concentric(random, pair);
        pair->depth = truth_least(&pair->body[0], &pair->body[1], pair->normal);
        place(class, random, pair);
        return 1;
    }
    if (class->arrangement == PAIRS_APART) {
        apart(random, -wanted, pair);
        place(class, random, pair);
        pair->depth = truth_width(&pair->body[0], &pair->body[1], pair->normal);
        return 1;
    }
    overlap(random, pair);
    const double depth = truth_least(&pair->body[0], &pair->body[1], pair->normal);
    if (depth < wanted) {
        return 0;
    }
    for (int c = 0; c < 3; c++) {
        pair->body[1].position[c] -= (depth - wanted) * pair->normal[c];
    }
    place(class, random, pair);
    pair->depth = truth_width(&pair->body[0], &pair->body[1], pair->normal);
    return 1;
}

void pairs_draw(const pairs_class *class, uint64_t seed, uint64_t index, int kind_a, int kind_b,
                pairs_pair *out)
{
    problem_random random;
    problem_random_start(&random, (uint64_t)(class - pairs_classes), seed, index);
    do {
        out->kind[0] = kind_a;
        out->kind[1] = kind_b;
        out->small = HUGE_VAL;
        out->large = 0.0;
        draw_body(class, class->arrangement == PAIRS_PLATES, &random, out, 0);
        draw_body(class, 0, &random, out, 1);
    } while (!draw_pair(class, &random, out));
}

double pairs_excess(const pairs_pair *pair, const double normal[3])
{
    const double width = truth_width(&pair->body[0], &pair->body[1], normal);
    const double over = width - pair->depth - 1e-13 * pair->large;
    const double least = fmax(fabs(pair->depth), 1e-9 * pair->small);
    return over > 0.0 || over != over ? over / least : 0.0;
}

/* ---- libccd alone
 * ------------------------------------------------------------------------------- */

/* One body in the world, and a bound of its support calls: see src/convex.c on how that ends
 * loops. */
typedef struct raw_body {
    const tribo_shape *shape;
    const double *rotation;
    const double *position;
    int portal; /* asked by MPR */
    uint64_t calls;
} raw_body;

static const uint64_t raw_bound = 1000;

static void raw_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *out)
{
    raw_body *body = (raw_body *)(uintptr_t)object;
    const double *r = body->rotation;
    const double *d = direction->v;
    double local[3];
    double point[3] = {0.0, 0.0, 0.0};
    body->calls++;
    for (int i = 0; i < 3; i++) {
        local[i] = r[i] * d[0] + r[3 + i] * d[1] + r[6 + i] * d[2];
    }
    if (body->calls > raw_bound) {
        for (int i = 0; i < 3; i++) {
            out->v[i] = d[i] == d[i] ? -1e9 * d[i] : body->portal ? (double)NAN : 0.0;
        }
        return;
    }
    (void)tribo_shape_support(body->shape, local, point);
    turned(r, point, out->v);
    for (int i = 0; i < 3; i++) {
        out->v[i] += body->position[i];
    }
}

static void raw_center(const void *object, ccd_vec3_t *center)
{
    const raw_body *body = object;
    memcpy(center->v, body->position, sizeof center->v);
}

typedef int (*raw_function)(const void *a, const void *b, const ccd_t *ccd, ccd_real_t *depth,
                            ccd_vec3_t *direction, ccd_vec3_t *point);

/* libccd's direction is that in which its second object goes. */
static void ask_raw(raw_function ask, int portal, const pairs_pair *pair, pairs_answer *out)
{
    ccd_t ccd;
    ccd_vec3_t direction = {{0.0, 0.0, 0.0}};
    ccd_vec3_t point;
    raw_body a = {&pair->shape[0], pair->body[0].rotation, pair->pose[0].position, portal, 0};
    raw_body b = {&pair->shape[1], pair->body[1].rotation, pair->pose[1].position, portal, 0};
    CCD_INIT(&ccd);
    ccd.max_iterations = (unsigned long)raw_bound; /* none by default */
    ccd.support1 = raw_support;
    ccd.support2 = raw_support;
    ccd.center1 = raw_center;
    ccd.center2 = raw_center;
    out->depth = 0.0;
    out->found = ask(&b, &a, &ccd, &out->depth, &direction, &point) == 0;
    out->endless = a.calls > raw_bound;
    memcpy(out->normal, direction.v, sizeof out->normal);
}

void pairs_raw_epa(const pairs_pair *pair, pairs_answer *out)
{
    ask_raw(ccdGJKPenetration, 0, pair, out);
}

void pairs_raw_mpr(const pairs_pair *pair, pairs_answer *out)
{
    ask_raw(ccdMPRPenetration, 1, pair, out);
}
