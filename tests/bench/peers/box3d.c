/* Box3D: its functions for one pair, with empty caches each time. It calculates in single
 * precision and knows no half-space, cylinder, cone or ellipsoid. By design it takes the normal of
 * a face unless that of a pair of edges is better by a tenth and 2.5 mm: of the least ways out at
 * small depths, those across edges are not found, which counts as wrong. */
#include "peer.h"

#include <box3d/box3d.h>
#include <box3d/collision.h>

#include <stdlib.h>

enum { MOST_POINTS = 32 };

typedef struct box3d_shape {
    int kind; /* PEER_SPHERE, PEER_CAPSULE or PEER_HULL */
    b3Sphere sphere;
    b3Capsule capsule;
    b3BoxHull box;
    b3HullData *hull; /* made from points */
    const b3HullData *data;
    b3Transform transform;
} box3d_shape;

/* `shapes` are in the order in which Box3D takes them. */
typedef struct box3d_pair {
    box3d_shape shapes[2];
    float sign; /* of the normal: Box3D's points from its first shape to the second */
} box3d_pair;

/* A hull that Box3D simplifies is not the same shape any more. */
static int make_hull(const peer_shape *shape, box3d_shape *out)
{
    b3Vec3 *points = calloc((size_t)shape->vertices, sizeof *points);
    for (int i = 0; points != NULL && i < shape->vertices; i++) {
        const double *v = shape->vertex[i];
        points[i] = (b3Vec3){(float)v[0], (float)v[1], (float)v[2]};
    }
    if (points != NULL && shape->vertices <= B3_MAX_HULL_VERTICES) {
        out->hull = b3CreateHull(points, shape->vertices, shape->vertices);
    }
    free(points);
    out->data = out->hull;
    return out->hull != NULL && out->hull->vertexCount == shape->vertices;
}

static int make_shape(const peer_shape *shape, box3d_shape *out)
{
    const float size[3] = {(float)shape->size[0], (float)shape->size[1], (float)shape->size[2]};
    const double *p = shape->position;
    const double *q = shape->orientation;
    out->transform.p = (b3Vec3){(float)p[0], (float)p[1], (float)p[2]};
    out->transform.q = (b3Quat){{(float)q[1], (float)q[2], (float)q[3]}, (float)q[0]};
    out->kind = shape->kind == PEER_BOX ? PEER_HULL : shape->kind;
    switch (shape->kind) {
    case PEER_SPHERE:
        out->sphere.radius = size[0];
        return 1;
    case PEER_CAPSULE:
        out->capsule = (b3Capsule){{0.0f, 0.0f, -size[1]}, {0.0f, 0.0f, size[1]}, size[0]};
        return 1;
    case PEER_BOX:
        out->box = b3MakeBoxHull(size[0], size[1], size[2]);
        out->data = &out->box.base;
        return 1;
    case PEER_HULL:
        return make_hull(shape, out);
    default:
        return 0;
    }
}

static void drop_pair(void *data)
{
    box3d_pair *pair = data;
    for (int i = 0; i < 2; i++) {
        if (pair->shapes[i].hull != NULL) {
            b3DestroyHull(pair->shapes[i].hull);
        }
    }
    free(pair);
}

/* Hulls come first, spheres last. */
static void *make_pair(const peer_shape shapes[2])
{
    static const int order[] = {
        [PEER_HULL] = 0, [PEER_BOX] = 0, [PEER_CAPSULE] = 1, [PEER_SPHERE] = 2};
    box3d_pair *pair = calloc(1, sizeof *pair);
    if (pair == NULL || shapes[0].kind == PEER_PLANE || shapes[1].kind == PEER_PLANE) {
        free(pair);
        return NULL;
    }
    const int swap = order[shapes[0].kind] > order[shapes[1].kind];
    pair->sign = swap ? 1.0f : -1.0f;
    for (int i = 0; i < 2; i++) {
        if (!make_shape(&shapes[swap ? 1 - i : i], &pair->shapes[i])) {
            drop_pair(pair);
            return NULL;
        }
    }
    return pair;
}

static void collide(const box3d_pair *pair, b3LocalManifold *manifold)
{
    const box3d_shape *a = &pair->shapes[0];
    const box3d_shape *b = &pair->shapes[1];
    const b3Transform relative = b3InvMulTransforms(a->transform, b->transform);
    b3SATCache axis = {0};
    b3SimplexCache simplex = {0};
    if (a->kind == PEER_HULL && b->kind == PEER_HULL) {
        b3CollideHulls(manifold, MOST_POINTS, a->data, b->data, relative, &axis);
    } else if (a->kind == PEER_HULL && b->kind == PEER_CAPSULE) {
        b3CollideHullAndCapsule(manifold, MOST_POINTS, a->data, &b->capsule, relative, &simplex);
    } else if (a->kind == PEER_HULL) {
        b3CollideHullAndSphere(manifold, MOST_POINTS, a->data, &b->sphere, relative, &simplex);
    } else if (a->kind == PEER_CAPSULE && b->kind == PEER_CAPSULE) {
        b3CollideCapsules(manifold, MOST_POINTS, &a->capsule, &b->capsule, relative);
    } else if (a->kind == PEER_CAPSULE) {
        b3CollideCapsuleAndSphere(manifold, MOST_POINTS, &a->capsule, &b->sphere, relative);
    } else {
        b3CollideSpheres(manifold, MOST_POINTS, &a->sphere, &b->sphere, relative);
    }
}

/* A manifold holds what is near, too: only what touches is an answer. */
static void ask_pair(void *data, peer_answer *out)
{
    const box3d_pair *pair = data;
    b3LocalManifoldPoint points[MOST_POINTS];
    b3LocalManifold manifold = {.points = points};
    collide(pair, &manifold);
    out->points = manifold.pointCount;
    out->depth = 0.0;
    for (int k = 0; k < manifold.pointCount; k++) {
        const double depth = -(double)points[k].separation;
        out->depth = depth > out->depth ? depth : out->depth;
    }
    if (!(out->depth > 0.0)) {
        out->points = 0;
        return;
    }
    const b3Vec3 normal = b3RotateVector(pair->shapes[0].transform.q, manifold.normal);
    out->normal[0] = (double)(pair->sign * normal.x);
    out->normal[1] = (double)(pair->sign * normal.y);
    out->normal[2] = (double)(pair->sign * normal.z);
}

const peer *peer_list(int *count)
{
    static const peer list[] = {{"Box3D", 1, make_pair, ask_pair, drop_pair}};
    *count = 1;
    return list;
}
