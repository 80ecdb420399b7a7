/*
 * One long mixed run over shapes, the broad phase and the contacts of pairs of every class, hashed
 * as in bits.c: same source, same bits. What other libraries have a part in stands apart:
 *
 *   shape    supports, faces, bounds, masses
 *   broad    pairs and queries
 *   closed   closed forms, parts and meshes included
 *   own      the general method where libccd finds nothing (see absent.c)
 *   libccd   the general method
 *   hull     blocks that Qhull had a part in, and their contacts
 *
 * Built with -DTRIBO_GOLDEN_BARE, and absent.c in place of hull.c and libccd, it prints the first
 * four: they are the same everywhere. Else it prints the first three and the last two. libccd gives
 * directions to try and Qhull which points make up which face: where these libraries are built in
 * another way (Debian has fused multiply-adds in them on arm64), that may differ in the last bit.
 */
#include "run.h"

#include <tribo/broad.h>
#include <tribo/collide.h>
#include <tribo/math.h>

#include <inttypes.h>
#include <stdio.h>

/* ---- shapes of every class ------------------------------------------------------------------- */

enum { SOLIDS = 6, USER = SOLIDS, PLANE, TERRAIN, PARTS, HULL, KINDS };

enum { CORNERS = 12, CELLS = 3 };

/* A shape and what it names. */
typedef struct body {
    tribo_shape shape;
    tribo_convex convex;
    double corners[3 * CORNERS];
    tribo_child children[3];
    uint64_t block[2048];
} body;

static void user_support(const void *user, const double direction[3], double point[3])
{
    const double *corners = user;
    size_t best = 0;
    for (size_t i = 1; i < CORNERS; ++i) {
        if (tribo_vec3_dot(corners + 3 * i, direction) >
            tribo_vec3_dot(corners + 3 * best, direction)) {
            best = i;
        }
    }
    memcpy(point, corners + 3 * best, 3 * sizeof *point);
}

static double length(void)
{
    return 0.25 + fraction();
}

static void make_solid(uint32_t type, tribo_shape *shape)
{
    memset(shape, 0, sizeof *shape);
    shape->type = type;
    for (int i = 0; i < 3; ++i) {
        shape->size[i] = length();
    }
    if (below(4) == 0) {
        shape->size[1] = shape->size[2] = shape->size[0];
    }
}

static void make_points(double *points, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        double v[3];
        do {
            fill(v, 3, 0);
        } while (tribo_vec3_normalize(v, points + 3 * i) != TRIBO_OK);
    }
}

static void make_user(body *x)
{
    make_points(x->corners, CORNERS);
    memset(&x->convex, 0, sizeof x->convex);
    x->convex.struct_size = sizeof x->convex;
    x->convex.support = user_support;
    x->convex.user = x->corners;
    x->convex.radius = 1.0000001;
    x->shape.type = TRIBO_SHAPE_CONVEX;
    x->shape.data = &x->convex;
}

static void make_plane(body *x)
{
    x->shape.type = TRIBO_SHAPE_HALFSPACE;
    make_points(x->shape.size, 1);
    if (below(2)) {
        memset(x->shape.size, 0, sizeof x->shape.size);
        x->shape.size[below(3)] = below(2) ? 1.0 : -1.0;
    }
    x->shape.size[3] = either() / 4;
}

/* Hilly ground, some of it flat. */
static void make_terrain(body *x)
{
    enum { SIDE = CELLS + 1 };
    double vertices[3 * SIDE * SIDE];
    uint32_t triangles[6 * CELLS * CELLS];
    for (int i = 0; i < SIDE * SIDE; ++i) {
        vertices[3 * i] = i % SIDE - 0.5 * CELLS;
        vertices[3 * i + 1] = i / SIDE - 0.5 * CELLS;
        vertices[3 * i + 2] = below(2) ? 0.0 : either() / 4;
    }
    for (uint32_t i = 0; i < CELLS * CELLS; ++i) {
        const uint32_t at = i / CELLS * SIDE + i % CELLS;
        const uint32_t corner[6] = {at, at + 1, at + SIDE, at + 1, at + SIDE + 1, at + SIDE};
        memcpy(triangles + 6 * (size_t)i, corner, sizeof corner);
    }
    put_status(tribo_mesh_build(SIDE * SIDE, vertices, 2 * CELLS * CELLS, triangles, x->block,
                                sizeof x->block, NULL));
    x->shape.type = TRIBO_SHAPE_MESH;
    x->shape.data = x->block;
}

static void make_pose(double reach, tribo_pose *pose)
{
    static const double turns[3][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0.5, 0.5, 0.5, 0.5}};
    for (int i = 0; i < 3; ++i) {
        pose->position[i] = below(4) ? reach * either() : 0.25 * below(9) - 1;
    }
    fill(pose->orientation, 4, 0);
    if (below(4) == 0 || tribo_quat_normalize(pose->orientation, pose->orientation) != TRIBO_OK) {
        memcpy(pose->orientation, turns[below(3)], sizeof pose->orientation);
    }
}

static void make_parts(body *x)
{
    x->shape.type = TRIBO_SHAPE_COMPOUND;
    x->shape.count = (uint32_t)COUNT(x->children);
    x->shape.data = x->children;
    for (size_t i = 0; i < COUNT(x->children); ++i) {
        make_solid((uint32_t)(1 + below(SOLIDS)), &x->children[i].shape);
        make_pose(1.0, &x->children[i].pose);
    }
}

#if !defined(TRIBO_GOLDEN_BARE)
static void make_hull(body *x)
{
    double points[3 * 40];
    const size_t count = 8 + (size_t)below(33);
    const int grid = below(3) == 0;
    make_points(points, count);
    for (size_t i = 0; grid && i < 3 * count; ++i) {
        points[i] = 0.5 * (below(5) - 2);
    }
    size_t needed = 0;
    put_status(tribo_hull_build(count, points, x->block, sizeof x->block, &needed));
    put_u64(needed);
    x->shape.type = TRIBO_SHAPE_HULL;
    x->shape.data = x->block;
}
#endif

static void make_body(int kind, body *x)
{
    memset(x, 0, sizeof *x);
    if (kind < SOLIDS) {
        make_solid((uint32_t)kind + 1, &x->shape);
    } else if (kind == USER) {
        make_user(x);
    } else if (kind == PLANE) {
        make_plane(x);
    } else if (kind == TERRAIN) {
        make_terrain(x);
    } else if (kind == PARTS) {
        make_parts(x);
    }
#if !defined(TRIBO_GOLDEN_BARE)
    if (kind == HULL) {
        make_hull(x);
    }
#endif
}

/* ---- queries of one shape -------------------------------------------------------------------- */

static void put_shape(const body *x)
{
    double d[3], point[3] = {0}, points[3 * TRIBO_MAX_FACE], normal[3] = {0}, low[3] = {0},
                 high[3] = {0}, mass = 0, inertia[9] = {0};
    uint32_t count = 0;
    tribo_pose pose;
    make_pose(4.0, &pose);
    put_status(tribo_shape_check(&x->shape));
    for (int i = 0; i < 8; ++i) {
        fill_odd(d, 3, i < 6 ? 1 : 500);
        put_status(tribo_shape_support(&x->shape, d, point));
        put_doubles(point, 3);
        put_status(tribo_shape_face(&x->shape, d, TRIBO_MAX_FACE, points, &count, normal));
        put_u64(count);
        put_doubles(points, 3 * (size_t)count);
        put_doubles(normal, 3);
        count = 0;
    }
    put_status(tribo_shape_bounds(&x->shape, &pose, low, high));
    put_doubles(low, 3);
    put_doubles(high, 3);
    put_status(tribo_shape_mass(&x->shape, 1000 * fraction(), &mass, point, inertia));
    put_double(mass);
    put_doubles(point, 3);
    put_doubles(inertia, 9);
}

static void run_shape(void)
{
    static body x;
    for (int i = 0; i < 40 * HULL; ++i) {
        make_body(i % HULL, &x);
        put_shape(&x);
    }
}

/* ---- pairs ----------------------------------------------------------------------------------- */

enum { ROOM = 128 };

static void put_manifold(const tribo_manifold *m)
{
    put_u64(m->count);
    put_u64(m->child_a);
    put_u64(m->child_b);
    put_u64(m->method);
    put_doubles(m->normal, 3);
    for (uint32_t k = 0; k < m->count; ++k) {
        put_doubles(m->points[k].arm_a, 3);
        put_doubles(m->points[k].arm_b, 3);
        put_double(m->points[k].distance);
        put_u64(m->points[k].id);
    }
}

static void put_pair(const body *a, const body *b, uint32_t method)
{
    static tribo_manifold manifolds[ROOM];
    tribo_collide_options options;
    tribo_collide_info info;
    tribo_pose pose[2];
    uint32_t count = 0;
    memset(&options, 0, sizeof options);
    memset(&info, 0, sizeof info);
    options.struct_size = sizeof options;
    info.struct_size = sizeof info;
    options.method = method;
    options.max_points = (uint32_t)below(5);
    options.margin = below(2) ? 0.0 : fraction() / 4;
    make_pose(0.75, &pose[0]);
    make_pose(0.75, &pose[1]);
    if (below(8) == 0) {
        memcpy(pose[1].position, pose[0].position, sizeof pose[1].position);
    }
    if (below(8) == 0) {
        memcpy(pose[1].orientation, pose[0].orientation, sizeof pose[1].orientation);
    }
    const tribo_status status = tribo_collide_shapes(&a->shape, &pose[0], &b->shape, &pose[1],
                                                     &options, ROOM, manifolds, &count, &info);
    put_status(status);
    put_u64(count);
    for (uint32_t i = 0; status == TRIBO_OK && i < count; ++i) {
        put_manifold(&manifolds[i]);
    }
    put_u64(info.closed);
    put_u64(info.general);
    put_u64(info.capped);
    put_u64(info.supports);
    put_u64(info.mallocs);
}

/* Every class with every class, both ways round: of hulls, or of all others. Terrain has no closed
 * form. */
static void put_pairs(int rounds, int hulls, uint32_t method)
{
    static body a, b;
    for (int i = 0; i < rounds * KINDS * KINDS; ++i) {
        const int kind[2] = {i % KINDS, i / KINDS % KINDS};
        const int terrain = kind[0] == TERRAIN || kind[1] == TERRAIN;
        const int hull = kind[0] == HULL || kind[1] == HULL;
        if (hull == hulls && !(terrain && method == TRIBO_METHOD_CLOSED)) {
            make_body(kind[0], &a);
            make_body(kind[1], &b);
            put_pair(&a, &b, method);
        }
    }
}

static void put_batch(void)
{
    enum { COUNT_OF_SHAPES = 24, PAIRS = 100 };
    static body bodies[COUNT_OF_SHAPES];
    static tribo_manifold manifolds[PAIRS];
    tribo_shape shapes[COUNT_OF_SHAPES];
    tribo_pose poses[COUNT_OF_SHAPES];
    tribo_status statuses[PAIRS];
    uint32_t pairs[2 * PAIRS];
    tribo_collide_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.method = TRIBO_METHOD_CLOSED;
    for (int i = 0; i < COUNT_OF_SHAPES; ++i) {
        make_body(i % HULL, &bodies[i]);
        make_pose(1.0, &poses[i]);
        shapes[i] = bodies[i].shape;
    }
    for (int i = 0; i < 2 * PAIRS; ++i) {
        pairs[i] = (uint32_t)below(COUNT_OF_SHAPES);
    }
    memset(manifolds, 0, sizeof manifolds);
    put_status(tribo_collide_batch(COUNT_OF_SHAPES, shapes, poses, PAIRS, pairs, &options,
                                   manifolds, statuses, NULL));
    for (int i = 0; i < PAIRS; ++i) {
        put_status(statuses[i]);
        put_manifold(&manifolds[i]);
    }
}

static void run_closed(void)
{
    put_pairs(100, 0, TRIBO_METHOD_CLOSED);
    for (int i = 0; i < 10; ++i) {
        put_batch();
    }
}

static void run_general(void)
{
    put_pairs(40, 0, TRIBO_METHOD_GENERAL);
    put_pairs(10, 0, TRIBO_METHOD_AUTOMATIC);
}

#if !defined(TRIBO_GOLDEN_BARE)
static void run_hull(void)
{
    static body x;
    for (int i = 0; i < 100; ++i) {
        make_body(HULL, &x);
        for (size_t k = 0; k < COUNT(x.block); ++k) {
            put_u64(x.block[k]);
        }
        put_shape(&x);
    }
    put_pairs(20, 1, TRIBO_METHOD_AUTOMATIC);
}
#endif

/* ---- broad phase ----------------------------------------------------------------------------- */

enum { BOXES = 400, FOUND = 20000 };

static void make_box(double low[3], double high[3])
{
    for (int i = 0; i < 3; ++i) {
        low[i] = below(8) ? 8 * either() : below(8);
        high[i] = low[i] + (below(8) ? fraction() : 1);
    }
}

static void put_queries(const tribo_tree *tree)
{
    static uint32_t found[2 * FOUND];
    double from[3], to[3];
    size_t count = 0;
    put_status(tribo_tree_pairs(tree, FOUND, found, &count));
    put_u64(count);
    for (size_t i = 0; i < 2 * count && i < COUNT(found); ++i) {
        put_u64(found[i]);
    }
    make_box(from, to);
    put_status(tribo_tree_query_box(tree, from, to, FOUND, found, &count));
    put_u64(count);
    for (size_t i = 0; i < count; ++i) {
        put_u64(found[i]);
    }
    fill(from, 3, 3);
    fill(to, 3, 3);
    put_status(tribo_tree_query_ray(tree, from, to, FOUND, found, &count));
    put_u64(count);
    for (size_t i = 0; i < count; ++i) {
        put_u64(found[i]);
    }
}

static void run_broad(void)
{
    static uint64_t block[8 * 2048];
    tribo_tree *tree = NULL;
    double low[3], high[3];
    if (tribo_tree_size(BOXES) > sizeof block) {
        put_u64(0);
        return;
    }
    put_status(tribo_tree_init(block, BOXES, 0.125, &tree));
    for (int i = 0; i < 4000; ++i) {
        const int what = below(8);
        uint32_t id = (uint32_t)below(BOXES);
        make_box(low, high);
        if (i < BOXES || what == 0) {
            put_status(tribo_tree_add(tree, low, high, &id));
            put_u64(id);
        } else if (what == 1) {
            put_status(tribo_tree_remove(tree, id));
        } else {
            put_status(tribo_tree_move(tree, id, low, high));
        }
        if (i % 100 == 0) {
            put_queries(tree);
        }
    }
}

/* ---- the run --------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    void (*run)(void);
} parts[] = {{"shape", run_shape},
             {"broad", run_broad},
             {"closed", run_closed},
#if defined(TRIBO_GOLDEN_BARE)
             {"own", run_general}
#else
             {"libccd", run_general},
             {"hull", run_hull}
#endif
};

int main(void)
{
    for (size_t i = 0; i < COUNT(parts); ++i) {
        hash = UINT64_C(0xcbf29ce484222325);
        generator = i;
        parts[i].run();
        printf("%-8s %016" PRIx64 "\n", parts[i].name, hash);
    }
    return 0;
}
