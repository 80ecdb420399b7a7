/* One pair of convex shapes in a common frame, as the parts of room collide hand it to each other. */
#ifndef TRIBO_PAIR_H
#define TRIBO_PAIR_H

#include <tribo/collide.h>

/* World axes, origin at the position of A: far from the world's origin nothing is lost. */
typedef struct pair_query {
    const tribo_shape *a;
    const tribo_shape *b;
    double ra[9];     /* rotation of A, body to world, row by row */
    double rb[9];     /* rotation of B */
    double offset[3]; /* position of B minus position of A */
    double margin;
    uint32_t max_points;
} pair_query;

/* Where two convex shapes are nearest, or deepest. */
typedef struct pair_axis {
    double normal[3]; /* unit, from B to A */
    double distance;  /* support width along it: negative inside, > margin: apart */
} pair_axis;

/* shape.c: support point and face of a judged convex shape in its own axes. The first returns 0 where a
 * user's function gave no finite point. */
int shape_support(const tribo_shape *shape, const double direction[3], double point[3]);
uint32_t shape_face(const tribo_shape *shape, const double direction[3],
                    double points[3 * TRIBO_MAX_FACE], double normal[3], uint32_t *feature);

/* A point well inside of a judged convex shape, in its own axes, and the radii of balls around it inside of
 * and around the shape (the inner one may be a lower bound). */
void shape_core(const tribo_shape *shape, double center[3], double *inner, double *outer);

/* convex.c: axis of any two judged convex shapes through libccd. Adds what it did to info. */
tribo_status convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info);

/* clip.c: manifold from the axis by clipping the support faces; count 0 if apart by more than the margin. */
void clip_manifold(const pair_query *query, const pair_axis *axis, tribo_manifold *out);

/* closed.c: 1 if the pair has a closed form, and then its manifold. */
int closed_manifold(const pair_query *query, tribo_manifold *out);

#endif
