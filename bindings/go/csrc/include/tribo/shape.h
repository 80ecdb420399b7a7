/**
 * @file shape.h
 * Shapes: what bodies are made of geometrically. Support functions, bounds, mass properties; convex
 * hulls from points, triangle meshes, compounds. Part of libtribo (not of libtribo_core).
 *
 * A shape is a value. Large data (hull, mesh) is a flat block without pointers in the caller's
 * memory: it can be copied, mapped from a file, and shared by any number of shapes, bodies and
 * threads; nobody counts references, nothing is freed behind the caller's back. It must be aligned
 * to 8 bytes and outlive the shapes that name it. Blocks are of the machine's byte order.
 *
 * Rules on aliasing, threads, units: see base.h.
 */
#ifndef TRIBO_SHAPE_H
#define TRIBO_SHAPE_H

#include <tribo/body.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Kinds of shapes, in their own axes. */
enum {
    TRIBO_SHAPE_SPHERE = 1,    /**< size = {radius} */
    TRIBO_SHAPE_BOX = 2,       /**< size = {hx, hy, hz}, half-extents */
    TRIBO_SHAPE_CAPSULE = 3,   /**< size = {radius, half_height}: all within r of z = -h to h */
    TRIBO_SHAPE_CYLINDER = 4,  /**< size = {radius, half_height}, axis z */
    TRIBO_SHAPE_CONE = 5,      /**< size = {radius, half_height}: base at z = -h, apex at z = h */
    TRIBO_SHAPE_ELLIPSOID = 6, /**< size = {a, b, c}, semi-axes */
    TRIBO_SHAPE_HULL = 7,      /**< data: block of tribo_hull_build */
    TRIBO_SHAPE_CONVEX = 8,    /**< data: const tribo_convex *, the user's own support function */
    TRIBO_SHAPE_HALFSPACE = 9, /**< size = {nx, ny, nz, d}: n . x <= d, with |n| = 1 to 5e-13 */
    TRIBO_SHAPE_MESH = 10,     /**< data: block of tribo_mesh_build; static terrain */
    TRIBO_SHAPE_COMPOUND = 11  /**< data: const tribo_child *, count children, each convex */
};

/** A shape. 48 bytes on 64-bit machines; layout is part of the ABI. */
typedef struct tribo_shape {
    uint32_t type;    /**< TRIBO_SHAPE_... */
    uint32_t count;   /**< COMPOUND: number of children; else 0 */
    double size[4];   /**< as above, m; unused entries are not looked at */
    const void *data; /**< as above; null where a shape has none */
} tribo_shape;

/** Position and orientation: body axes to world axes, as in tribo_body. 56 bytes. */
typedef struct tribo_pose {
    double position[3];    /**< m */
    double orientation[4]; /**< (w, x, y, z), unit to 1e-6, used as if normalised */
} tribo_pose;

/** One convex part of a compound. */
typedef struct tribo_child {
    tribo_shape shape; /**< convex: not HALFSPACE, MESH or COMPOUND */
    tribo_pose pose;   /**< in the axes of the compound */
} tribo_child;

/** point = the point of the shape that is farthest along `direction` (not zero, not of unit
 *  length), both in the axes of the shape. Called any number of times; must be a function of its
 *  arguments alone. */
typedef void (*tribo_support_function)(const void *user, const double direction[3],
                                       double point[3]);

/** The face that faces `direction` most: up to `capacity` vertices to points (width 3), in order
 *  around it, either way. Returns their number, 0 if the surface is curved or has no face there.
 *  More than `capacity`, a point that is not finite or a polygon without area count as 0. */
typedef uint32_t (*tribo_face_function)(const void *user, const double direction[3],
                                        uint32_t capacity, double *points);

/** A convex shape given by functions. The caller sets struct_size, to sizeof(tribo_convex). */
typedef struct tribo_convex {
    uint32_t struct_size;
    uint32_t reserved;
    tribo_support_function support;
    tribo_face_function face; /**< may be null: contacts are then single points */
    const void *user;         /**< passed on as it is */
    double center[3];         /**< a point well inside */
    double radius;            /**< of a ball around center that holds the shape, m */
} tribo_convex;

/** Largest number of vertices a support face gives for clipping. */
#define TRIBO_MAX_FACE 32

/* ---- judging --------------------------------------------------------------------------------- */

/** Judge a shape and the data it names; of a block its head alone, at the same cost for any size
 *  (tribo_hull_check and tribo_mesh_check judge all of it).
 *  @return TRIBO_OK, TRIBO_ERROR_NULL (shape, or data that its type needs), TRIBO_ERROR_OPTION
 *          (type), TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_SHAPE (a size is not positive; a compound
 *          has no child, or one that is not convex),
 *          TRIBO_ERROR_NORMAL (HALFSPACE), TRIBO_ERROR_ORIENTATION (child), TRIBO_ERROR_STRUCT_SIZE
 *          (CONVEX), TRIBO_ERROR_DATA (the block is not one of this version). */
TRIBO_API tribo_status tribo_shape_check(const tribo_shape *shape);

/* ---- queries --------------------------------------------------------------------------------- */

/** Support point of a convex shape in its own axes: the farthest along `direction` (any length but
 *  zero). Where an edge or a face is farthest: the box gives the corner on the positive side, round
 *  shapes the centre of the cap or the apex, a hull one of the vertices. Zeros of either sign are
 *  the same.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (direction is zero),
 *          TRIBO_ERROR_SHAPE (not convex, or unbounded), TRIBO_ERROR_SUPPORT (the user's function
 *          gave a point that is not finite). The shape is not judged otherwise. */
TRIBO_API tribo_status tribo_shape_support(const tribo_shape *shape, const double direction[3],
                                           double point[3]);

/** Face of a convex shape that faces `direction` most, in its own axes: its vertices in order,
 *  counter-clockwise seen from outside. A curved place gives 1 point; the side of a capsule,
 *  cylinder or cone a line of it, 2 points by rising z (of a capsule moved out along the
 *  direction); circles give 8 points at multiples of 45 degrees from the x axis. Of a hull the
 *  faces at the support point are compared: a better one elsewhere would be no place of contact.
 *  @param capacity room in points (width 3); TRIBO_MAX_FACE is always enough (larger faces are
 *                  thinned)
 *  @param count    receives the number of points
 *  @param normal   receives the outward unit normal of the face; of a point or edge, direction /
 *                  |direction|
 *  @return as tribo_shape_support, TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_shape_face(const tribo_shape *shape, const double direction[3],
                                        uint32_t capacity, double *points, uint32_t *count,
                                        double normal[3]);

/** Axis-aligned bounds of a shape at a pose, world axes; the tightest, to rounding (no margin is
 *  added). CONVEX: by six calls of the user's function. MESH: visits all triangles. HALFSPACE:
 *  infinite along what it does not bound, and it bounds only an axis on which its normal lies to
 *  the bit.
 *  @return a status of tribo_shape_check, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_ORIENTATION, TRIBO_ERROR_SUPPORT (the user's function gave a point that is
 *          not finite). */
TRIBO_API tribo_status tribo_shape_bounds(const tribo_shape *shape, const tribo_pose *pose,
                                          double low[3], double high[3]);

/** Mass properties of a uniform solid of that shape. Hulls by exact integrals; what the children of
 *  a compound have in common counts for each of them.
 *  @param density kg/m^3
 *  @param mass    receives kg
 *  @param center  receives the centre of mass in the axes of the shape, m
 *  @param inertia receives the inertia about that centre, in the axes of the shape, kg m^2
 *  @return a status of tribo_shape_check, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_SHAPE (density <= 0; HALFSPACE, MESH and CONVEX have none),
 *          TRIBO_ERROR_RANGE. */
TRIBO_API tribo_status tribo_shape_mass(const tribo_shape *shape, double density, double *mass,
                                        double center[3], double inertia[9]);

/* ---- convex hulls ---------------------------------------------------------------------------- */

/** Convex hull of points as a flat block: vertices, face planes, ordered faces (coplanar ones
 *  merged), neighbours. Faces by Qhull (Barber, Dobkin, Huhdanpaa, ACM TOMS 22 (1996) 469). This is
 *  the one function here that allocates, by malloc, and it frees all before it returns.
 *  @param count  number of points, 4 to 2^24
 *  @param points width 3
 *  @param block  receives the hull, aligned to 8; may be null if capacity is 0
 *  @param needed receives the bytes the block needs (also with TRIBO_ERROR_CAPACITY); may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (count, or the
 *          radius overflows), TRIBO_ERROR_DEGENERATE (all points equal, on a line or in a plane,
 *          relative to their extent by 1e-12; or so nearly that rounding leaves no convex solid),
 *          TRIBO_ERROR_CAPACITY, TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_hull_build(size_t count, const double *points, void *block,
                                        size_t capacity, size_t *needed);

/** Judge a block from elsewhere, such as a file, before it is used: whether tribo_hull_build of this
 *  version made it, on a machine of the same byte order, and no byte of it has changed since.
 *  Damage shows by a sum over all bytes. A block that was written to deceive may pass, and then is
 *  some other shape, but no call that is given it leaves it or runs without end. Takes time of the
 *  order of its size.
 *  @param size bytes that may be read at `block`; those beyond the block are not looked at
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA (also if it is not aligned to 8, or cut off). */
TRIBO_API tribo_status tribo_hull_check(const void *block, size_t size);

/** Numbers of vertices and (merged) faces of a hull block; its head alone is judged.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA. */
TRIBO_API tribo_status tribo_hull_counts(const void *block, uint32_t *vertices, uint32_t *faces);

/* ---- triangle meshes ------------------------------------------------------------------------- */

/** Static triangle mesh as a flat block: triangles counter-clockwise seen from outside, a tree of
 *  bounds, and which edges are convex, so that bodies do not trip over inner edges. Neighbours are
 *  known by the positions of their vertices; they need not share indices.
 *  @param vertex_count 3 to 2^31
 *  @param vertices     width 3, m
 *  @param count        number of triangles, 1 to 2^30; those whose height is below 1e-12 of their
 *                      longest edge are left out, and keep their numbers
 *  @param triangles    width 3: vertex indices
 *  @param block,capacity,needed as in tribo_hull_build
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_INDEX, TRIBO_ERROR_RANGE,
 *          TRIBO_ERROR_DEGENERATE (no triangle is left), TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_mesh_build(size_t vertex_count, const double *vertices, size_t count,
                                        const uint32_t *triangles, void *block, size_t capacity,
                                        size_t *needed);

/** Judge a block from elsewhere that is said to be a mesh: as tribo_hull_check. */
TRIBO_API tribo_status tribo_mesh_check(const void *block, size_t size);

#ifdef __cplusplus
}
#endif

#endif
