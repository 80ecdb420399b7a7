/* Faces of boxes, and a box on a half-space, the most frequent of all pairs: one source for the
 * short way from the query and for the way of all pairs. */
#ifndef TRIBO_BOX_H
#define TRIBO_BOX_H

#include "pair.h"

#include <tribo/math.h>

static const int next_axis[3] = {1, 2, 0};
static const int last_axis[3] = {2, 0, 1};

/* Without a branch, as nobody knows which it is: so are the two axes that follow another. */
TRIBO_ALWAYS_INLINE int greatest_of(const double x[3])
{
    const int first = absolute(x[1]) > absolute(x[0]) ? 1 : 0;
    const int third = absolute(x[2]) > greater(absolute(x[0]), absolute(x[1])) ? 1 : 0;
    return third * 2 + (1 - third) * first;
}

TRIBO_ALWAYS_INLINE uint32_t box_face_number(int axis, double sign)
{
    return 2u * (uint32_t)axis + (sign > 0.0 ? 0u : 1u);
}

/* Whether a normal is as near to a unit vector as rounding lets it be. */
TRIBO_ALWAYS_INLINE int box_is_unit(const double normal[3])
{
    return absolute(tribo_vec3_dot(normal, normal) - 1.0) <= 4.0 * TRIBO_EPS;
}

/* A box at the origin with rotation r against a half-space; both are sound, and the normal a unit
 * vector. */
typedef struct box_ground {
    const double *r;
    const double *half;
    const double *offset; /* where the arms of the half-space begin */
    const double *normal;
    double level; /* n . x on the plane */
    double limit; /* distance up to which corners count */
} box_ground;

/* The margin and what rounding may add, from the lengths that distances are made of. */
TRIBO_ALWAYS_INLINE double box_limit(double margin, double lengths)
{
    return margin + PAIR_ROUNDING * lengths;
}

/* One component of the arms of all corners: what the normal has of it, a row of the box's rotation,
 * and what the other body's position has of it. */
TRIBO_ALWAYS_INLINE void box_write_row(int turned, int k, const box_ground *g, const int axes[3],
                                       const double size[3], const double heights[3],
                                       tribo_point *const to[4])
{
    const double *row = g->r + 3 * k;
    const double offset = g->offset[k];
    const double back = 0.5 * g->normal[k];
    const double center = row[axes[0]] * size[0] - back * heights[0];
    const double side = row[axes[1]] * size[1] - back * heights[1];
    const double other = row[axes[2]] * size[2] - back * heights[2];
    const double right = center + side;
    const double left = center - side;
    const double middle[4] = {right + other, left + other, left - other, right - other};
    for (int c = 0; c < 4; c++) {
        double *own = turned ? to[c]->arm_b : to[c]->arm_a;
        double *others = turned ? to[c]->arm_a : to[c]->arm_b;
        own[k] = middle[c];
        others[k] = middle[c] - offset;
    }
}

/* The corners of the lowest face, which holds the deepest, as far as they are near enough. A corner
 * is the middle of the face and half a side to either hand, and so are its distance and the point
 * midway to the plane. No branch depends on the pose: all four are written, each in the place of
 * the one before if that does not count. Returns how many do. */
TRIBO_ALWAYS_INLINE uint32_t box_on_ground(int turned, const box_ground *g,
                                           tribo_point *restrict points)
{
    const double *r = g->r;
    const double n[3] = {g->normal[0], g->normal[1], g->normal[2]};
    const double *half = g->half;
    const double down[3] = {r[0] * n[0] + r[3] * n[1] + r[6] * n[2],
                            r[1] * n[0] + r[4] * n[1] + r[7] * n[2],
                            r[2] * n[0] + r[5] * n[1] + r[8] * n[2]};
    const int axis = greatest_of(down);
    const int axes[3] = {axis, next_axis[axis], last_axis[axis]};
    const double sign = copysign(1.0, 0.0 - down[axis]); /* it is not 0 */
    const double size[3] = {sign * half[axes[0]], sign * half[axes[1]], half[axes[2]]};
    const double heights[3] = {size[0] * down[axis] - g->level, size[1] * down[axes[1]],
                               size[2] * down[axes[2]]};
    const double right = heights[0] + heights[1];
    const double left = heights[0] - heights[1];
    const double distances[4] = {right + heights[2], left + heights[2], left - heights[2],
                                 right - heights[2]};
    const uint32_t face = pair_feature(box_face_number(axis, sign), PAIR_VERTEX, 0);
    const uint64_t first = pair_id(turned, face, pair_feature(0, PAIR_FACE, 0));
    const uint64_t step = pair_id(turned, 1, 0);
    tribo_point *to[4];
    uint32_t count = 0;
    for (uint32_t c = 0; c < 4; c++) {
        to[c] = &points[count];
        to[c]->distance = distances[c];
        to[c]->id = first + c * step;
        count += distances[c] <= g->limit ? 1 : 0;
    }
    box_write_row(turned, 0, g, axes, size, heights, to);
    box_write_row(turned, 1, g, axes, size, heights, to);
    box_write_row(turned, 2, g, axes, size, heights, to);
    return count;
}

#endif
