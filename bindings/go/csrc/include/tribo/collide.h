/**
 * @file collide.h
 * Contacts from shapes: given two shapes and their poses, the contact manifold. Part of libtribo.
 *
 * Pairs with a closed form use it (half-space with all, sphere-sphere, sphere-capsule,
 * capsule-capsule, sphere-box, box-box); all other convex pairs go through libccd, in a wrapper
 * that recentres, scales, certifies the direction by its width and bounds the work. The points come
 * from clipping the two support faces.
 *
 * Where the direction of least depth is not unique, a fixed one of them is taken: concentric
 * spheres part along the world's z axis; a sphere whose centre lies on a capsule's segment along
 * the capsule's x axis; a sphere in the middle of a box through the face of its first axis. Boxes
 * prefer a face of one of them to an edge of each.
 *
 * Meshes are surfaces seen from outside: a body whose core lies behind a triangle is let through,
 * normals do not lean over edges inside of the surface, and what lies beyond such an edge is left
 * to the neighbour.
 *
 * Rules on aliasing, threads, units: see base.h.
 */
#ifndef TRIBO_COLLIDE_H
#define TRIBO_COLLIDE_H

#include <tribo/contact.h>
#include <tribo/shape.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One point of a manifold. 64 bytes. */
typedef struct tribo_point {
    double arm_a[3]; /**< from A's position to the point, midway between the surfaces, m */
    double arm_b[3]; /**< the same point from the position of B's pose, m */
    double distance; /**< of the surfaces along the normal, m; negative inside */
    uint64_t id;     /**< which features touch, A's in the high half, B's in the low: persists from
                          step to step while they do. A corner within 1e-4 of the shortest side from
                          a vertex or edge has its name, so stacks of equal boxes keep theirs */
} tribo_point;

#define TRIBO_MAX_POINTS 4

/** Contact between two convex parts. */
typedef struct tribo_manifold {
    uint32_t count;   /**< number of points, 0 to 4 */
    uint32_t child_a; /**< COMPOUND: index of the child; MESH: of the triangle; else 0 */
    uint32_t child_b;
    uint32_t method;                      /**< TRIBO_METHOD_... that found it */
    double normal[3];                     /**< unit, world axes, from B to A */
    tribo_point points[TRIBO_MAX_POINTS]; /**< those from `count` on mean nothing */
} tribo_manifold;

/** How a pair is done. */
enum {
    TRIBO_METHOD_AUTOMATIC = 0, /**< closed form if there is one, else general */
    TRIBO_METHOD_CLOSED = 1,    /**< closed form, or TRIBO_ERROR_OPTION if the pair has none */
    TRIBO_METHOD_GENERAL = 2    /**< by support functions alone; not for half-spaces */
};

/** Options of a collision query. Zero-initialise, set struct_size. Null: all defaults. */
typedef struct tribo_collide_options {
    uint32_t struct_size; /**< smaller (older) structs are accepted */
    uint32_t method;      /**< TRIBO_METHOD_... */
    uint32_t max_points;  /**< 1 to 4; 0: 4. The deepest stays, and what keeps most area: all of an
                               overlap of up to four corners. Faces of boxes have up to eight; of
                               random ones the best four corners keep 0.97 of the area on the mean,
                               0.81 at worst, and 0.74 where the deepest is none of those. Corners
                               as deep as the deepest to 1e-5 of the size are: area alone chooses,
                               and the deepest of those that stay tells the greatest depth */
    uint32_t reserved;
    double margin; /**< surfaces up to this far apart count (speculative), >= 0, m */
} tribo_collide_options;

/** What a query cost. The caller sets struct_size. */
typedef struct tribo_collide_info {
    uint32_t struct_size;
    uint32_t closed;   /**< pairs done in closed form */
    uint32_t general;  /**< pairs done by libccd */
    uint32_t capped;   /**< of these, those that ran into a bound of work: another direction may be
                            a little less deep; the depth is that of the normal even then */
    uint64_t supports; /**< support function calls of the search; faces and bounds need a few */
    uint64_t mallocs;  /**< upper bound of allocations libccd made */
} tribo_collide_info;

/** Manifolds between shape A at pose A and shape B at pose B. Convex pairs give at most one;
 *  compounds and meshes one per pair of parts that touch, in the order of their indices.
 *
 *  Only relative positions enter, so the result is the same far from the origin as near it.
 *  Swapping A and B swaps the arms and turns the normal round. Depths are exact to rounding for
 *  closed forms; general: to 1e-9 of the smaller size. Of nearly concentric pairs, where a great
 *  many directions are nearly as deep, one in 1000 is given one that is deeper than the least by
 *  more than 1e-9 of the depth, one in 2500 by more than 1e-6, up to some 4e-3.
 *
 *  A gap is told along the normal, so it is never more than the true one. Closed forms but boxes:
 *  exact to rounding. General: to 2e-9 of the smaller size, and to 1 % of a gap of 1e-8 of that size
 *  or more; to 1e-8 of it where bodies are a hundred times as long as thick.
 *  Two boxes in closed form part along a normal of a face or across two edges: where a corner is
 *  nearest to a corner or an edge, that gap is less than the true one, and only
 *  TRIBO_METHOD_GENERAL has the direction between the nearest points.
 *  @param options   may be null
 *  @param capacity  room in manifolds
 *  @param manifolds receives the manifolds with at least one point
 *  @param count     receives their number; with TRIBO_ERROR_CAPACITY the number needed
 *  @param info      may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_RANGE (margin < 0; lengths so large that they overflow), a status of
 *          tribo_shape_check, TRIBO_ERROR_ORIENTATION, TRIBO_ERROR_PAIR (two shapes that cannot
 *          meet: two of HALFSPACE and MESH), TRIBO_ERROR_SUPPORT (a user's support function
 *          contradicts itself), TRIBO_ERROR_CAPACITY, TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_collide_shapes(const tribo_shape *shape_a, const tribo_pose *pose_a,
                                            const tribo_shape *shape_b, const tribo_pose *pose_b,
                                            const tribo_collide_options *options, uint32_t capacity,
                                            tribo_manifold *manifolds, uint32_t *count,
                                            tribo_collide_info *info);

/** Many convex pairs. Pair i is shapes[pairs[2i]] at poses[pairs[2i]] and the same for 2i + 1; it
 *  fills manifolds[i] (count 0 if they do not touch) and statuses[i]. Pairs do not influence each
 *  other. Where a status is not TRIBO_OK, that manifold is untouched and all other pairs are still
 *  done.
 *  @param statuses may be null
 *  @param info     may be null; sums over all pairs
 *  @return the first status that is not TRIBO_OK by order; or with nothing done TRIBO_ERROR_NULL,
 *          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, or for the margin TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_RANGE. Of a pair also TRIBO_ERROR_INDEX, TRIBO_ERROR_ALIAS (i with i),
 *          TRIBO_ERROR_PAIR (MESH or COMPOUND). */
TRIBO_API tribo_status tribo_collide_batch(uint32_t shape_count, const tribo_shape *shapes,
                                           const tribo_pose *poses, size_t count,
                                           const uint32_t *pairs,
                                           const tribo_collide_options *options,
                                           tribo_manifold *manifolds, tribo_status *statuses,
                                           tribo_collide_info *info);

#ifdef __cplusplus
}
#endif

#endif
