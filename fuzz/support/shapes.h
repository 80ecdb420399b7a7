/**
 * @file shapes.h
 * Shapes and poses from bytes, and what is known of them in long double by formulae of their own.
 * Part of the targets of libtribo only.
 */
#ifndef FUZZ_SHAPES_H
#define FUZZ_SHAPES_H

#include <tribo/collide.h>

#include "make.h"

enum {
    SHAPES_POINTS = 40, /* of a hull: more than are scanned one by one */
    SHAPES_TRIANGLES = 24,
    SHAPES_CHILDREN = 3,
    SHAPES_WORDS = 1536 /* of a block */
};

/** Sets of kinds: one bit for each. */
#define SHAPES_KIND(type) (1u << (type))
#define SHAPES_ROUND 0x7eu   /**< SPHERE to ELLIPSOID */
#define SHAPES_CONVEX 0x1feu /**< SPHERE to CONVEX */
#define SHAPES_SIMPLE 0x3feu /**< and HALFSPACE */
#define SHAPES_ALL 0xffeu

/** A shape with all that it names. It points into itself: not to be moved. */
typedef struct made_shape {
    tribo_shape shape;
    double size;      /**< no point is farther from the origin of its axes; HALFSPACE: |d| */
    double small;     /**< the least half-size, about */
    tribo_shape base; /**< CONVEX: the shape that its functions are those of */
    tribo_convex convex;
    tribo_child children[SHAPES_CHILDREN];
    size_t point_count; /**< of hull or mesh */
    double points[3 * SHAPES_POINTS];
    size_t triangle_count;
    uint32_t triangles[3 * SHAPES_TRIANGLES];
    size_t bytes; /**< of the block */
    uint64_t block[SHAPES_WORDS];
} made_shape;

/** Points of a hull: in a box, on a sphere, on a lattice, flat, in line, twice, nearly flat. */
void make_points(property_trial *t, const char *name, size_t *count, double *points);

/** A valid shape of one of the kinds, of size 2^-10 to 2^10, rarely with aspect up to 2^13. */
void make_shape(property_trial *t, const char *name, uint32_t kinds, made_shape *out);

/** Whether no product of two of these lengths underflows, before scaling or after: that has other
 * bits. */
int shapes_scalable(const double *numbers, size_t count);

/** The shape with all lengths times 2^exponent. 0 if a block cannot be built. */
int shapes_scale(const made_shape *from, int exponent, made_shape *out);

/** A valid pose, its position within 2^low to 2^high or zero. */
void make_pose(property_trial *t, const char *name, int low, int high, tribo_pose *out);

/** Rotation matrix of a pose. */
void shapes_rotation(const tribo_pose *pose, long double r[9]);

/** max d . x over the shape, in its own axes; infinite for a half-space. */
long double shapes_extent(const tribo_shape *shape, const long double d[3]);

/** How far a point lies outside of a convex shape or half-space, to first order; <= 0 inside. */
long double shapes_outside(const tribo_shape *shape, const long double x[3]);

/** Support and face functions that are those of the shape `user` points to. */
void shapes_support(const void *user, const double direction[3], double point[3]);
uint32_t shapes_face(const void *user, const double direction[3], uint32_t capacity,
                     double *points);

#endif
