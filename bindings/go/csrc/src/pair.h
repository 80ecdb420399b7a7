/* One pair of convex shapes in a common frame, as the parts of room collide hand it to each
 * other. */
#ifndef TRIBO_PAIR_H
#define TRIBO_PAIR_H

#include <tribo/collide.h>

#include "bits.h"

enum { PAIR_ARMS = 32 };

/* Vertices of a small hull from its core, world axes, scaled by a power of two. */
typedef struct pair_arms {
    uint32_t count;    /* half of PAIR_ARMS or all: the first again and again; 0: no small hull */
    uint32_t vertices; /* so many are of the hull */
    double x[PAIR_ARMS];
    double y[PAIR_ARMS];
    double z[PAIR_ARMS];
} pair_arms;

/* World axes, origin at the position of A: far from the world's origin nothing is lost. */
typedef struct pair_query {
    const tribo_shape *a;
    const tribo_shape *b;
    double ra[9];     /* rotation of A, body to world, row by row */
    double rb[9];     /* rotation of B */
    double offset[3]; /* position of B minus position of A */
    double margin;
    pair_arms *arms; /* of A and B, once convex_axis has been asked; null: not wanted */
    uint32_t max_points;
    uint32_t turned; /* A here is the caller's B: manifolds are written the other way round */
    uint32_t safe;   /* boxes or half-spaces of usual size: no number of a closed form overflows */
} pair_query;

/* Where two convex shapes are nearest, or deepest. */
typedef struct pair_axis {
    double normal[3]; /* unit, from B to A */
    double distance;  /* support width along it: negative inside, > margin: apart */
} pair_axis;

/* Face of one shape of a query: world axes, origin at A, counter-clockwise seen from outside. */
typedef struct pair_face {
    uint32_t count; /* 1: a point of a curved place, 2: an edge of a rounded shape */
    uint32_t feature;
    double normal[3]; /* outward, unit */
    double points[3 * TRIBO_MAX_FACE];
} pair_face;

/* A face seen along a normal: heights h along it, u and v across it. */
typedef struct pair_polygon {
    uint32_t count;
    uint32_t feature;
    double size;     /* greatest distance of a corner from the first along u or v */
    double shortest; /* side, by the sum of what it is along u and v */
    double slope[2]; /* height gained per length along u and v */
    double h[TRIBO_MAX_FACE];
    double u[TRIBO_MAX_FACE];
    double v[TRIBO_MAX_FACE];
} pair_polygon;

/* Faces of two boxes seen from the middle of that box whose face clips: its outward normal, u and v
 * along its sides. */
typedef struct pair_rectangles {
    int side;        /* 0: a face of A clips */
    uint32_t own;    /* its number */
    double level;    /* its height */
    double half[2];  /* its sides */
    double frame[9]; /* outward normal, u, v; world axes */
    double size;     /* of the smaller face */
    pair_polygon other;
} pair_rectangles;

/* A point that may go into the manifold. */
typedef struct pair_point {
    double middle[3]; /* midway between the surfaces; world axes, origin at A */
    double distance;
    uint32_t a; /* what touches on A: pair_feature */
    uint32_t b;
} pair_point;

enum {
    PAIR_VERTEX = 0,
    PAIR_EDGE = 1,
    PAIR_FACE = 2,
    PAIR_CURVED = 3,                         /* a point of a curved place */
    PAIR_MAX_POINTS = 2 * TRIBO_MAX_FACE + 8 /* two faces clipped have no more corners */
};

/* Half of a point's id. The vertices and edges of a face are numbered around it; edge k leaves
 * vertex k. */
static inline uint32_t pair_feature(uint32_t face, uint32_t kind, uint32_t index)
{
    return (face & 0xffffffu) << 8 | kind << 6 | (index & 63u);
}

/* Distances that differ by less than this part of the lengths they were made from do not differ. */
#define PAIR_ROUNDING 3.5527136788005009e-15 /* 16 * 2^-52 */

/* A length of the size of a vector's, without a root. */
TRIBO_ALWAYS_INLINE double extent(const double v[3])
{
    return absolute(v[0]) + absolute(v[1]) + absolute(v[2]);
}

#define PAIR_NORMAL_TOLERANCE 1e-12 /* of the square of a half-space's normal */

/* Distances and lengths of closed forms overflow nowhere on the way, if the lengths they are made
 * from add up to less than this. */
#define PAIR_LARGE 1e100

/* Id of a point in the caller's order. */
TRIBO_ALWAYS_INLINE uint64_t pair_id(int turned, uint32_t a, uint32_t b)
{
    return turned ? (uint64_t)b << 32 | a : (uint64_t)a << 32 | b;
}

/* One number after the other: what was stored so can not be loaded at once without a stall.
 * Which arm is whose is chosen without a branch. */
TRIBO_ALWAYS_INLINE void pair_write_as(int turned, const double offset[3], const double middle[3],
                                       double distance, uint64_t id, tribo_point *to)
{
    double *own = turned ? to->arm_b : to->arm_a;
    double *other = turned ? to->arm_a : to->arm_b;
    for (int i = 0; i < 3; i++) {
        own[i] = middle[i];
        other[i] = middle[i] - offset[i];
    }
    to->distance = distance;
    to->id = id;
}

TRIBO_ALWAYS_INLINE void pair_write_point(const pair_query *query, const pair_point *from,
                                          tribo_point *to)
{
    const int turned = (int)query->turned;
    pair_write_as(turned, query->offset, from->middle, from->distance,
                  pair_id(turned, from->a, from->b), to);
}

TRIBO_ALWAYS_INLINE void pair_write_head(uint32_t turned, const double normal[3], uint32_t count,
                                         tribo_manifold *out)
{
    const double sign = 1.0 - 2.0 * (double)turned;
    out->count = count;
    out->child_a = 0;
    out->child_b = 0;
    out->method = 0;
    out->normal[0] = 0.0 + sign * normal[0];
    out->normal[1] = 0.0 + sign * normal[1];
    out->normal[2] = 0.0 + sign * normal[2];
}

/* shape.c: support point and face of a judged convex shape in its own axes. The first returns 0
 * where a user's function gave no finite point. */
int shape_support(const tribo_shape *shape, const double direction[3], double point[3]);
uint32_t shape_face(const tribo_shape *shape, const double direction[3],
                    double points[3 * TRIBO_MAX_FACE], double normal[3], uint32_t *feature);

/* shape.c: the face of a hull whose vertex that is farthest along the direction is known. */
uint32_t shape_face_at(const tribo_shape *shape, uint32_t vertex, const double direction[3],
                       double points[3 * TRIBO_MAX_FACE], double normal[3], uint32_t *feature);

/* A point well inside of a judged convex shape, in its own axes, and the radii of balls around it
 * inside of and around the shape (the inner one may be a lower bound). */
void shape_core(const tribo_shape *shape, double center[3], double *inner, double *outer);

/* convex.c: axis of any two judged convex shapes through libccd. Adds what it did to info. */
tribo_status convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info);

/* convex.c: the arm that is farthest along a direction, world axes, of a small hull. */
uint32_t convex_farthest(const pair_arms *arms, const double direction[3]);

/* clip.c: manifold from the axis by clipping the support faces; count 0 if apart by more than the
 * margin. */
void clip_manifold(const pair_query *query, const pair_axis *axis, tribo_manifold *out);

/* clip.c: the face of A (side 0) or B (side 1) that faces a direction; 0 if there is none. */
int clip_take_face(const pair_query *query, int side, const double direction[3], pair_face *face);

/* clip.c: points where two faces, each of three or more vertices, lie over each other along the
 * axis, the face of `reference` (0: A, 1: B) being the one that clips. Returns their number. */
uint32_t clip_faces(const pair_query *query, const pair_face faces[2], int reference,
                    const pair_axis *axis, pair_point points[PAIR_MAX_POINTS]);

/* clip.c: the same of two faces of boxes, one of which is square to the axis. */
uint32_t clip_rectangles(const pair_query *query, const pair_rectangles *faces,
                         pair_point points[PAIR_MAX_POINTS]);

/* clip.c: manifold of A on one given face of B, with its normal: only what lies over that face
 * counts. */
void clip_onto(const pair_query *query, const pair_face *face, tribo_manifold *out);

/* clip.c: distance of the shapes along a unit vector from B to A, and what rounding may have done
 * to it. 0 if a user's function gave no finite point. */
int clip_distance(const pair_query *query, const double normal[3], double *distance,
                  double *rounding);

/* clip.c: a manifold without points. */
void clip_nothing(tribo_manifold *out);

/* clip.c: TRIBO_ERROR_RANGE if a number of the manifold has overflowed: lengths near the ends of
 * the range of numbers do so on the way. */
tribo_status clip_check(const tribo_manifold *manifold);

/* clip.c: manifold of these points, at most as many as the query asks for. */
void clip_write(const pair_query *query, const double normal[3], uint32_t count,
                const pair_point *points, tribo_manifold *out);

/* clip.c: manifold of the points (at least one) within the margin, reduced to what the query asks
 * for. Points nearer to each other than 1e-9 of `size` are one. */
void clip_finish(const pair_query *query, const double normal[3], double size, uint32_t count,
                 pair_point *points, tribo_manifold *out);

/* Whether two kinds of shapes, A's number not the greater, have a closed form. */
TRIBO_ALWAYS_INLINE int closed_exists(uint32_t type_a, uint32_t type_b)
{
    return type_b == TRIBO_SHAPE_HALFSPACE ||
           (type_a == TRIBO_SHAPE_SPHERE && type_b <= TRIBO_SHAPE_CAPSULE) ||
           (type_a == type_b && type_b <= TRIBO_SHAPE_CAPSULE);
}

/* closed.c: its manifold. TRIBO_ERROR_SUPPORT if a user's function gave no finite point,
 * TRIBO_ERROR_RANGE if a number overflowed. */
tribo_status closed_manifold(const pair_query *query, tribo_manifold *out);

#endif
