#include <tribo/collide.h>

#include "bits.h"
#include "box.h"
#include "mesh.h"
#include "pair.h"

#include <tribo/math.h>

#define UNIT_TOLERANCE 1e-6 /* of quaternions, which are used as if normalised */
#define BOUNDS_SLACK 1e-12  /* relative growth of bounds, so that rounding loses no pair */
#define FLAT 1e-5           /* sine of the angle below which a normal is the triangle's own */

enum { FEW = 8 }; /* manifolds that are kept on the stack until all is known to be well */

/* ---- judging -------------------------------------------------------------------------------- */

static int size_is_known(uint32_t size, size_t newest)
{
    return size >= sizeof(uint32_t) && size <= newest && size % sizeof(uint32_t) == 0;
}

/* Options of any age into the full struct of this library. A field counts only if the caller's
 * struct holds all of it. They are taken one by one: what was stored so can not be loaded at once
 * without a stall. */
TRIBO_ALWAYS_INLINE tribo_status read_options(const tribo_collide_options *options,
                                              tribo_collide_options *full)
{
    const uint32_t size = options ? options->struct_size : sizeof(uint32_t);
    const int whole = size == sizeof *options;
    if (!whole && !size_is_known(size, sizeof *options)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    const uint32_t points =
        whole || size >= offsetof(tribo_collide_options, reserved) ? options->max_points : 0;
    full->struct_size = size;
    full->method =
        whole || size >= offsetof(tribo_collide_options, max_points) ? options->method : 0;
    full->max_points = points == 0 ? TRIBO_MAX_POINTS : points;
    full->reserved = 0;
    full->margin = whole ? options->margin : 0.0;
    if (full->method > TRIBO_METHOD_GENERAL || points > TRIBO_MAX_POINTS) {
        return TRIBO_ERROR_OPTION;
    }
    if (full->margin >= 0.0 && full->margin < (double)INFINITY) {
        return TRIBO_OK;
    }
    return full->margin < 0.0 && full->margin > -(double)INFINITY ? TRIBO_ERROR_RANGE
                                                                  : TRIBO_ERROR_NOT_FINITE;
}

/* The rotation of a quaternion; 0 if that is no unit one. What it lacks to one is so little that no
 * division is needed: the next term of the series is 8e-18. */
TRIBO_ALWAYS_INLINE int take_rotation(const double q[4], double r[9])
{
    const double w = q[0];
    const double x = q[1];
    const double y = q[2];
    const double z = q[3];
    const double xx = x * x;
    const double yy = y * y;
    const double zz = z * z;
    const double xy = x * y;
    const double xz = x * z;
    const double yz = y * z;
    const double wx = w * x;
    const double wy = w * y;
    const double wz = w * z;
    const double excess = ((w * w + xx) + (yy + zz)) - 1.0;
    const double s = 2.0 - (excess + excess) * (1.0 - excess); /* 2 / |q|^2 */
    r[0] = 1.0 - s * (yy + zz);
    r[1] = s * (xy - wz);
    r[2] = s * (xz + wy);
    r[3] = s * (xy + wz);
    r[4] = 1.0 - s * (xx + zz);
    r[5] = s * (yz - wx);
    r[6] = s * (xz - wy);
    r[7] = s * (yz + wx);
    r[8] = 1.0 - s * (xx + yy);
    return absolute(excess) <= 2.0 * UNIT_TOLERANCE;
}

static tribo_status check_pose(const tribo_pose *pose)
{
    double r[9];
    if (!all_finite(pose->position, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return take_rotation(pose->orientation, r) ? TRIBO_OK
           : all_finite(pose->orientation, 4)  ? TRIBO_ERROR_ORIENTATION
                                               : TRIBO_ERROR_NOT_FINITE;
}

static int is_convex(uint32_t type)
{
    return type <= TRIBO_SHAPE_CONVEX;
}

/* Whether two judged kinds can meet, and the asked method can be had. */
static tribo_status check_kinds(uint32_t a, uint32_t b)
{
    const int a_is_ground = a == TRIBO_SHAPE_HALFSPACE || a == TRIBO_SHAPE_MESH;
    const int b_is_ground = b == TRIBO_SHAPE_HALFSPACE || b == TRIBO_SHAPE_MESH;
    return a_is_ground && b_is_ground ? TRIBO_ERROR_PAIR : TRIBO_OK;
}

/* ---- one convex pair ------------------------------------------------------------------------ */

/* Which of two lists of numbers comes first: -1, 0 or 1. NaN, in entries that no shape looks at,
 * does not count. */
static int compare(const double *x, const double *y, int count)
{
    for (int i = 0; i < count; i++) {
        if (x[i] < y[i] || x[i] > y[i]) {
            return x[i] < y[i] ? -1 : 1;
        }
    }
    return 0;
}

/* By what two shapes of one kind at one pose differ, if it shows in their cores. */
static int compare_cores(const pair_query *q)
{
    double a[5];
    double b[5];
    shape_core(q->a, a, &a[3], &a[4]);
    shape_core(q->b, b, &b[3], &b[4]);
    return compare(a, b, 5);
}

/* Whether the pair is to be seen the other way round. Each pair is done in one order only, so that
 * swapping A and B swaps the answer to the bit. */
static int is_turned(const pair_query *q)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    if (q->a->type != q->b->type) {
        return q->a->type > q->b->type;
    }
    int order = compare(q->a->size, q->b->size, 4);
    order = order != 0 ? order : compare(q->offset, origin, 3);
    order = order != 0 ? order : compare(q->ra, q->rb, 9);
    return (order != 0 ? order : compare_cores(q)) > 0;
}

static void turn(const pair_query *from, pair_query *to)
{
    to->a = from->b;
    to->b = from->a;
    memcpy(to->ra, from->rb, sizeof to->ra);
    memcpy(to->rb, from->ra, sizeof to->rb);
    for (int i = 0; i < 3; i++) {
        to->offset[i] = 0.0 - from->offset[i];
    }
    to->margin = from->margin;
    to->arms = NULL;
    to->max_points = from->max_points;
    to->turned = !from->turned;
    to->safe = from->safe;
}

TRIBO_NEVER_INLINE tribo_status general(const pair_query *query, tribo_manifold *out,
                                        tribo_collide_info *info)
{
    pair_axis axis;
    pair_arms arms[2];
    pair_query full = *query;
    full.arms = arms;
    const tribo_status status = convex_axis(&full, &axis, info);
    if (status != TRIBO_OK) {
        return status;
    }
    info->general++;
    clip_manifold(&full, &axis, out);
    out->method = TRIBO_METHOD_GENERAL;
    return clip_check(out);
}

static tribo_status in_order(const pair_query *query, uint32_t method, tribo_manifold *out,
                             tribo_collide_info *info)
{
    const int is_closed = closed_exists(query->a->type, query->b->type);
    if (method == TRIBO_METHOD_CLOSED
            ? !is_closed
            : method == TRIBO_METHOD_GENERAL && query->b->type == TRIBO_SHAPE_HALFSPACE) {
        return TRIBO_ERROR_OPTION;
    }
    if (!is_closed || method == TRIBO_METHOD_GENERAL) {
        return general(query, out, info);
    }
    const tribo_status status = closed_manifold(query, out);
    info->closed++;
    out->method = TRIBO_METHOD_CLOSED;
    return status;
}

TRIBO_NEVER_INLINE tribo_status touch_turned(const pair_query *query, uint32_t method,
                                             tribo_manifold *out, tribo_collide_info *info)
{
    pair_query turned;
    turn(query, &turned);
    return in_order(&turned, method, out, info);
}

static tribo_status touch(const pair_query *query, uint32_t method, tribo_manifold *out,
                          tribo_collide_info *info)
{
    return is_turned(query) ? touch_turned(query, method, out, info)
                            : in_order(query, method, out, info);
}

/* Boxes and the ground, which are many, without a call. */
TRIBO_ALWAYS_INLINE int is_well(const tribo_shape *shape)
{
    const double *size = shape->size;
    const int is_box = shape->type == TRIBO_SHAPE_BOX && size[0] > 0.0 && size[1] > 0.0 &&
                       size[2] > 0.0 && size[0] + size[1] + size[2] < (double)INFINITY;
    const int is_ground = shape->type == TRIBO_SHAPE_HALFSPACE &&
                          absolute(tribo_vec3_dot(size, size) - 1.0) <= PAIR_NORMAL_TOLERANCE &&
                          absolute(size[3]) < (double)INFINITY;
    return is_box || is_ground || tribo_shape_check(shape) == TRIBO_OK;
}

/* Length that says how large the numbers of a box or half-space are; infinite of other shapes. */
TRIBO_ALWAYS_INLINE double length_of(const tribo_shape *shape)
{
    return shape->type == TRIBO_SHAPE_BOX         ? extent(shape->size)
           : shape->type == TRIBO_SHAPE_HALFSPACE ? absolute(shape->size[3])
                                                  : (double)INFINITY;
}

/* What is wrong with a pair. */
TRIBO_NEVER_INLINE tribo_status check_pair(const tribo_shape *shape_a, const tribo_pose *pose_a,
                                           const tribo_shape *shape_b, const tribo_pose *pose_b)
{
    tribo_status status = tribo_shape_check(shape_a);
    status = status == TRIBO_OK ? tribo_shape_check(shape_b) : status;
    status = status == TRIBO_OK ? check_pose(pose_a) : status;
    status = status == TRIBO_OK ? check_pose(pose_b) : status;
    status = status == TRIBO_OK ? check_kinds(shape_a->type, shape_b->type) : status;
    return status == TRIBO_OK ? TRIBO_ERROR_RANGE : status;
}

/* Whether two boxes are to be seen the other way round by their sizes: without a branch, as nobody
 * knows. Ties, and all other pairs, are left to is_turned. */
static int sizes_are_turned(const tribo_shape *a, const tribo_shape *b)
{
    int order = 0;
    if (a->type != TRIBO_SHAPE_BOX || b->type != TRIBO_SHAPE_BOX) {
        return 0;
    }
    for (int i = 3; i >= 0; i--) {
        const int more = a->size[i] > b->size[i] ? 1 : 0;
        const int less = a->size[i] < b->size[i] ? 1 : 0;
        order = more | less ? more - less : order;
    }
    return order > 0;
}

/* The pair without its shapes' parts, if all of it is well. A finite offset has finite ends. */
static tribo_status take_pair(const tribo_shape *shape_a, const tribo_pose *pose_a,
                              const tribo_shape *shape_b, const tribo_pose *pose_b,
                              const tribo_collide_options *options, pair_query *query)
{
    const tribo_shape *const shapes[2] = {shape_a, shape_b};
    const tribo_pose *const poses[2] = {pose_a, pose_b};
    const int turned = sizes_are_turned(shape_a, shape_b);
    const tribo_shape *a = shapes[turned];
    const tribo_shape *b = shapes[1 - turned];
    const tribo_pose *at_a = poses[turned];
    const tribo_pose *at_b = poses[1 - turned];
    tribo_vec3_subtract(at_b->position, at_a->position, query->offset);
    query->a = a;
    query->b = b;
    query->margin = options->margin;
    query->arms = NULL;
    query->max_points = options->max_points;
    query->turned = (uint32_t)turned;
    query->safe = length_of(a) + length_of(b) + extent(query->offset) < PAIR_LARGE;
    const int well = is_well(a) && is_well(b) && all_finite(query->offset, 3) &&
                     take_rotation(at_a->orientation, query->ra) &&
                     take_rotation(at_b->orientation, query->rb) &&
                     check_kinds(a->type, b->type) == TRIBO_OK;
    return well ? TRIBO_OK : check_pair(shape_a, pose_a, shape_b, pose_b);
}

/* Whether a quaternion turns nothing, by its bits but that of the sign. */
TRIBO_ALWAYS_INLINE int is_upright(const double q[4])
{
    return (bits_of(q[1]) | bits_of(q[2]) | bits_of(q[3])) << 1 == 0 &&
           bits_of(q[0]) << 1 == bits_of(1.0) << 1;
}

/* A box on the ground, the most frequent of all pairs, goes the shortest way if all is well and of
 * usual size. The ground is seldom turned: then its normal is as it stands. */
TRIBO_ALWAYS_INLINE int touch_ground(const tribo_shape *box, const tribo_pose *pose,
                                     const tribo_shape *ground, const tribo_pose *below,
                                     const tribo_collide_options *options, tribo_manifold *out,
                                     uint32_t *found)
{
    const double *half = box->size;
    const double *size = ground->size;
    if (box->type != TRIBO_SHAPE_BOX || ground->type != TRIBO_SHAPE_HALFSPACE ||
        options->method == TRIBO_METHOD_GENERAL || options->max_points < 4) {
        return 0;
    }
    double r[9];
    double normal[3] = {size[0], size[1], size[2]};
    double offset[3];
    tribo_vec3_subtract(below->position, pose->position, offset);
    const double lengths = (half[0] + half[1] + half[2]) + (absolute(size[3]) + extent(offset));
    if (!(half[0] > 0.0 && half[1] > 0.0 && half[2] > 0.0 && lengths < PAIR_LARGE) ||
        !take_rotation(pose->orientation, r)) {
        return 0;
    }
    if (!is_upright(below->orientation)) {
        double turn[9];
        if (!take_rotation(below->orientation, turn)) {
            return 0;
        }
        tribo_mat3_apply(turn, size, normal);
    }
    if (!box_is_unit(normal)) {
        return 0;
    }
    const double level = tribo_vec3_dot(normal, offset) + size[3];
    const box_ground pair = {r, half, offset, normal, level, box_limit(options->margin, lengths)};
    pair_write_head(0, normal, 0, out); /* early: it may be read at once, and in wider pieces */
    const uint32_t count = box_on_ground(0, &pair, out->points);
    if (count == 0) {
        clip_nothing(out);
    }
    out->count = count;
    out->method = TRIBO_METHOD_CLOSED;
    *found = count > 0 ? 1 : 0;
    return 1;
}

/* ---- parts ---------------------------------------------------------------------------------- */

/* Manifolds in the order of their children. Beyond the capacity they are only counted. */
typedef struct sink {
    tribo_manifold *manifolds;
    uint32_t capacity;
    uint32_t count;
} sink;

/* Points from the count on are no numbers. */
static void copy_manifold(const tribo_manifold *from, tribo_manifold *to)
{
    const size_t size = offsetof(tribo_manifold, points) + from->count * sizeof *from->points;
    memcpy(to, from, size);
}

static void keep(sink *s, const tribo_manifold *m)
{
    if (s->count < s->capacity) {
        uint32_t k = s->count;
        for (; k > 0; k--) {
            const tribo_manifold *before = &s->manifolds[k - 1];
            if (before->child_a < m->child_a ||
                (before->child_a == m->child_a && before->child_b < m->child_b)) {
                break;
            }
            copy_manifold(before, &s->manifolds[k]);
        }
        copy_manifold(m, &s->manifolds[k]);
    }
    s->count++;
}

/* A convex part of a shape: where it is in world axes, from the position of the shape. */
typedef struct part {
    const tribo_shape *shape;
    uint32_t index;
    double r[9];
    double position[3];
} part;

static uint32_t part_count(const tribo_shape *shape)
{
    return shape->type == TRIBO_SHAPE_COMPOUND ? shape->count : 1;
}

static void take_part(const tribo_shape *shape, const double r[9], uint32_t index, part *out)
{
    out->shape = shape;
    out->index = index;
    if (shape->type != TRIBO_SHAPE_COMPOUND) {
        memcpy(out->r, r, sizeof out->r);
        out->position[0] = out->position[1] = out->position[2] = 0.0;
        return;
    }
    const tribo_child *child = (const tribo_child *)shape->data + index;
    double own[9];
    out->shape = &child->shape;
    (void)take_rotation(child->pose.orientation, own); /* it has been judged */
    tribo_mat3_multiply(r, own, out->r);
    tribo_mat3_apply(r, child->pose.position, out->position);
}

/* The pair of two parts; query is that of the whole shapes. */
static void take_parts(const pair_query *query, const part *a, const part *b, pair_query *out)
{
    double apart[3];
    out->a = a->shape;
    out->b = b->shape;
    memcpy(out->ra, a->r, sizeof out->ra);
    memcpy(out->rb, b->r, sizeof out->rb);
    tribo_vec3_subtract(b->position, a->position, apart);
    tribo_vec3_add(query->offset, apart, out->offset);
    out->margin = query->margin;
    out->arms = NULL;
    out->max_points = query->max_points;
    out->turned = query->turned;
    out->safe = 0;
}

/* A manifold of two parts into the caller's order, arms from the positions of the shapes. */
static void place_manifold(const part *a, const part *b, uint32_t turned, tribo_manifold *m)
{
    const part *first = turned ? b : a;
    const part *second = turned ? a : b;
    m->child_a = first->index;
    m->child_b = second->index;
    for (uint32_t k = 0; k < m->count; k++) {
        tribo_vec3_add(m->points[k].arm_a, first->position, m->points[k].arm_a);
        tribo_vec3_add(m->points[k].arm_b, second->position, m->points[k].arm_b);
    }
}

/* Whether the balls around two parts, or a ball and a half-space, leave room between them. */
static int is_far(const pair_query *q)
{
    double center[3];
    double other[3];
    double radius[2];
    double inner;
    if (q->a->type == TRIBO_SHAPE_HALFSPACE || q->b->type == TRIBO_SHAPE_HALFSPACE) {
        return 0;
    }
    shape_core(q->a, center, &inner, &radius[0]);
    tribo_mat3_apply(q->ra, center, center);
    shape_core(q->b, other, &inner, &radius[1]);
    tribo_mat3_apply(q->rb, other, other);
    for (int i = 0; i < 3; i++) {
        other[i] = (other[i] - center[i]) + q->offset[i];
    }
    return tribo_vec3_norm(other) > (radius[0] + radius[1] + q->margin) * (1.0 + BOUNDS_SLACK);
}

/* ---- meshes --------------------------------------------------------------------------------- */

/* A triangle for the general method: a convex shape whose origin is its first vertex, so that far
 * from the mesh's origin nothing more is lost. */
typedef struct triangle {
    tribo_convex convex;
    tribo_shape shape;
    double vertices[9];
} triangle;

static void triangle_support(const void *user, const double direction[3], double point[3])
{
    const double *v = user;
    int best = 0;
    for (int k = 1; k < 3; k++) {
        if (tribo_vec3_dot(v + 3 * k, direction) > tribo_vec3_dot(v + 3 * best, direction)) {
            best = k;
        }
    }
    memcpy(point, v + 3 * best, 3 * sizeof *point);
}

/* Counter-clockwise seen from the side the direction comes from: a triangle has two. */
static uint32_t triangle_face(const void *user, const double direction[3], uint32_t capacity,
                              double *points)
{
    const double *v = user;
    double normal[3];
    tribo_vec3_cross(v + 3, v + 6, normal);
    const int behind = tribo_vec3_dot(normal, direction) < 0.0;
    if (capacity < 3) {
        return 0;
    }
    memcpy(points, v, 9 * sizeof *points);
    if (behind) {
        memcpy(points + 3, v + 6, 3 * sizeof *points);
        memcpy(points + 6, v + 3, 3 * sizeof *points);
    }
    return 3;
}

static void take_triangle(const mesh_triangle *from, triangle *out)
{
    double reach = 0.0;
    memset(out, 0, sizeof *out);
    for (int k = 0; k < 3; k++) {
        tribo_vec3_subtract(from->vertices + 3 * k, from->vertices, out->vertices + 3 * k);
    }
    out->convex.struct_size = sizeof out->convex;
    out->convex.support = triangle_support;
    out->convex.face = triangle_face;
    out->convex.user = out->vertices;
    for (int i = 0; i < 3; i++) {
        out->convex.center[i] = (out->vertices[3 + i] + out->vertices[6 + i]) / 3.0;
    }
    for (int k = 0; k < 3; k++) {
        double arm[3];
        tribo_vec3_subtract(out->vertices + 3 * k, out->convex.center, arm);
        reach = greater(reach, tribo_vec3_norm(arm));
    }
    out->convex.radius = reach * (1.0 + BOUNDS_SLACK);
    out->shape.type = TRIBO_SHAPE_CONVEX;
    out->shape.data = &out->convex;
}

/* Nearest point of a triangle to the origin, by regions (Ericson, Real-Time Collision Detection,
 * 5.1.5), from a = vertex and its edges. */
static void nearest_of_triangle(const double v[9], double out[3])
{
    double best = (double)INFINITY;
    double normal[3];
    double edges[3][3];
    int inside = 1;
    for (int k = 0; k < 3; k++) {
        tribo_vec3_subtract(v + 3 * ((k + 1) % 3), v + 3 * k, edges[k]);
    }
    tribo_vec3_cross(edges[0], edges[1], normal);
    for (int k = 0; k < 3; k++) {
        double inward[3];
        tribo_vec3_cross(normal, edges[k], inward);
        inside = inside && tribo_vec3_dot(inward, v + 3 * k) <= 0.0;
    }
    if (inside) {
        const double f = tribo_vec3_dot(normal, v) / tribo_vec3_dot(normal, normal);
        tribo_vec3_scale(f, normal, out);
        return;
    }
    for (int k = 0; k < 3; k++) {
        const double square = tribo_vec3_dot(edges[k], edges[k]);
        const double f = 0.0 - tribo_vec3_dot(edges[k], v + 3 * k) / square;
        const double t = f > 0.0 ? lesser(f, 1.0) : 0.0;
        double at[3];
        tribo_vec3_add_scaled(v + 3 * k, t, edges[k], at);
        if (tribo_vec3_dot(at, at) < best) {
            best = tribo_vec3_dot(at, at);
            memcpy(out, at, sizeof at);
        }
    }
}

static void sphere_axis(const pair_query *q, const pair_face *face, pair_axis *axis)
{
    double nearest[3];
    nearest_of_triangle(face->points, nearest);
    const double length = tribo_vec3_norm(nearest);
    tribo_vec3_scale(-1.0, nearest, axis->normal);
    if (tribo_vec3_normalize(axis->normal, axis->normal) != TRIBO_OK) {
        memcpy(axis->normal, face->normal, sizeof axis->normal);
    }
    axis->distance = length - q->a->size[0];
}

/* Whether a normal leans over edges that bodies may touch, and over no other: what is nearest
 * beyond an edge inside of the surface belongs to the neighbour. */
static int leans_over_active(const pair_face *face, uint32_t flags, const double normal[3])
{
    int active = 0;
    for (int k = 0; k < 3; k++) {
        double edge[3];
        double out[3];
        tribo_vec3_subtract(face->points + 3 * ((k + 1) % 3), face->points + 3 * k, edge);
        tribo_vec3_cross(edge, face->normal, out);
        if (tribo_vec3_dot(out, normal) > FLAT * tribo_vec3_norm(edge)) {
            if (!(flags & MESH_ACTIVE(k))) {
                return 0;
            }
            active = 1;
        }
    }
    return active;
}

/* Whether the core of A lies behind the triangle: then it has come from there, and is let
 * through. */
static int is_behind(const pair_query *q, const pair_face *face)
{
    double center[3];
    double inner;
    double outer;
    shape_core(q->a, center, &inner, &outer);
    tribo_mat3_apply(q->ra, center, center);
    tribo_vec3_subtract(center, face->points, center);
    return tribo_vec3_dot(center, face->normal) < 0.0;
}

static void place_triangle(const pair_query *q, const mesh_triangle *from, const triangle *t,
                           pair_face *face)
{
    face->count = 3;
    face->feature = 0;
    tribo_mat3_apply(q->rb, from->normal, face->normal);
    for (int k = 0; k < 3; k++) {
        tribo_mat3_apply(q->rb, t->vertices + 3 * k, face->points + 3 * k);
        tribo_vec3_add(face->points + 3 * k, q->offset, face->points + 3 * k);
    }
}

/* Whether the lowest point of A is over the triangle and no deeper than A is thick. Then the
 * triangle holds it, even if what is left of A passes beside the triangle: a tip that has sunk in
 * through a neighbour. */
static int holds_lowest(const pair_query *q, const pair_face *face)
{
    const double down[3] = {0.0 - face->normal[0], 0.0 - face->normal[1], 0.0 - face->normal[2]};
    double local[3];
    double lowest[3];
    double center[3];
    double inner;
    double outer;
    tribo_mat3_apply_transposed(q->ra, down, local);
    if (!shape_support(q->a, local, lowest)) {
        return 0;
    }
    tribo_mat3_apply(q->ra, lowest, lowest);
    shape_core(q->a, center, &inner, &outer);
    int over = 1;
    for (int k = 0; k < 3; k++) {
        double edge[3];
        double out[3];
        double arm[3];
        tribo_vec3_subtract(face->points + 3 * ((k + 1) % 3), face->points + 3 * k, edge);
        tribo_vec3_cross(edge, face->normal, out);
        tribo_vec3_subtract(lowest, face->points + 3 * k, arm);
        over = over && tribo_vec3_dot(out, arm) <= 0.0;
    }
    double arm[3];
    tribo_vec3_subtract(lowest, face->points, arm);
    const double distance = tribo_vec3_dot(arm, face->normal);
    return over && distance <= q->margin && distance >= -inner;
}

/* Axis of A and the triangle, by the sphere's closed form or libccd. */
static tribo_status triangle_axis(const pair_query *q, const pair_face *face, pair_axis *axis,
                                  tribo_collide_info *info)
{
    if (q->a->type == TRIBO_SHAPE_SPHERE) {
        sphere_axis(q, face, axis);
        info->closed++;
        return TRIBO_OK;
    }
    info->general++;
    return convex_axis(q, axis, info);
}

/* The edges inside of the surface are none to the body: there the normal is the triangle's own. */
static tribo_status touch_triangle(const pair_query *q, const mesh_triangle *from,
                                   const triangle *t, tribo_manifold *out, tribo_collide_info *info)
{
    pair_face face;
    pair_axis axis;
    clip_nothing(out);
    place_triangle(q, from, t, &face);
    if (is_behind(q, &face)) {
        return TRIBO_OK;
    }
    if (holds_lowest(q, &face)) {
        clip_onto(q, &face, out);
        out->method = TRIBO_METHOD_CLOSED;
        info->closed++;
        return clip_check(out);
    }
    const tribo_status status = triangle_axis(q, &face, &axis, info);
    if (status != TRIBO_OK || !(axis.distance <= q->margin)) {
        return status;
    }
    if (tribo_vec3_dot(axis.normal, face.normal) > 0.0 &&
        leans_over_active(&face, from->flags, axis.normal)) {
        clip_manifold(q, &axis, out);
    } else {
        clip_onto(q, &face, out);
    }
    out->method = q->a->type == TRIBO_SHAPE_SPHERE ? TRIBO_METHOD_CLOSED : TRIBO_METHOD_GENERAL;
    return clip_check(out);
}

/* Bounds of A in the axes of the mesh. 0 if a user's function gave no finite point. */
static int bounds_in_mesh(const pair_query *q, double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) {
        const double axis[3] = {q->rb[k], q->rb[3 + k], q->rb[6 + k]};
        double local[3];
        double back[3];
        double far[3];
        double near[3];
        tribo_mat3_apply_transposed(q->ra, axis, local);
        tribo_vec3_scale(-1.0, local, back);
        if (!shape_support(q->a, local, far) || !shape_support(q->a, back, near)) {
            return 0;
        }
        const double shift = 0.0 - tribo_vec3_dot(axis, q->offset);
        const double reach = absolute(shift) + tribo_vec3_norm(far) + tribo_vec3_norm(near);
        const double slack = q->margin + BOUNDS_SLACK * reach;
        low[k] = shift + tribo_vec3_dot(local, near) - slack;
        high[k] = shift + tribo_vec3_dot(local, far) + slack;
    }
    return 1;
}

/* Part A of a shape on the mesh B. */
static tribo_status touch_mesh(const pair_query *whole, const part *a, const part *b, sink *to,
                               tribo_collide_info *info)
{
    pair_query q;
    mesh_cursor cursor;
    mesh_triangle found;
    double low[3];
    double high[3];
    take_parts(whole, a, b, &q);
    if (!bounds_in_mesh(&q, low, high)) {
        return TRIBO_ERROR_SUPPORT;
    }
    double offset[3];
    memcpy(offset, q.offset, sizeof offset);
    mesh_begin(b->shape->data, low, high, &cursor);
    while (mesh_next(&cursor, &found)) {
        triangle t;
        part corner = *b;
        tribo_manifold m;
        take_triangle(&found, &t);
        corner.index = found.index;
        tribo_mat3_apply(b->r, found.vertices, corner.position);
        tribo_vec3_add(offset, corner.position, q.offset);
        q.b = &t.shape;
        const tribo_status status = touch_triangle(&q, &found, &t, &m, info);
        if (status != TRIBO_OK) {
            return status;
        }
        if (m.count > 0) {
            place_manifold(a, &corner, whole->turned, &m);
            keep(to, &m);
        }
    }
    return TRIBO_OK;
}

/* ---- all parts of a pair -------------------------------------------------------------------- */

static tribo_status touch_parts(const pair_query *whole, uint32_t method, const part *a,
                                const part *b, sink *to, tribo_collide_info *info)
{
    if (b->shape->type == TRIBO_SHAPE_MESH) {
        return touch_mesh(whole, a, b, to, info);
    }
    if (a->shape->type == TRIBO_SHAPE_MESH) {
        pair_query turned;
        turn(whole, &turned);
        return touch_mesh(&turned, b, a, to, info);
    }
    pair_query q;
    tribo_manifold m;
    take_parts(whole, a, b, &q);
    if (is_far(&q)) {
        return TRIBO_OK;
    }
    const tribo_status status = touch(&q, method, &m, info);
    if (status == TRIBO_OK && m.count > 0) {
        place_manifold(a, b, 0, &m);
        keep(to, &m);
    }
    return status;
}

static tribo_status touch_all(const pair_query *whole, uint32_t method, sink *to,
                              tribo_collide_info *info)
{
    for (uint32_t i = 0; i < part_count(whole->a); i++) {
        part a;
        take_part(whole->a, whole->ra, i, &a);
        for (uint32_t k = 0; k < part_count(whole->b); k++) {
            part b;
            take_part(whole->b, whole->rb, k, &b);
            const tribo_status status = touch_parts(whole, method, &a, &b, to, info);
            if (status != TRIBO_OK) {
                return status;
            }
        }
    }
    return TRIBO_OK;
}

static int is_simple(const tribo_shape *shape)
{
    return is_convex(shape->type) || shape->type == TRIBO_SHAPE_HALFSPACE;
}

/* Few manifolds wait on the stack. Of many only the number is known after the first round; a second
 * one writes them out when nothing can fail any more but a library's memory. */
TRIBO_NEVER_INLINE tribo_status collide_parts(const pair_query *whole, uint32_t method,
                                              uint32_t capacity, tribo_manifold *manifolds,
                                              uint32_t *count, tribo_collide_info *info)
{
    tribo_manifold few[FEW];
    sink first = {few, FEW, 0};
    const tribo_status status = touch_all(whole, method, &first, info);
    if (status != TRIBO_OK) {
        return status;
    }
    *count = first.count;
    if (first.count > capacity) {
        return TRIBO_ERROR_CAPACITY;
    }
    if (first.count > FEW) {
        tribo_collide_info again = {0};
        sink second = {manifolds, capacity, 0};
        return touch_all(whole, method, &second, &again);
    }
    for (uint32_t i = 0; i < first.count; i++) {
        copy_manifold(&few[i], &manifolds[i]);
    }
    return TRIBO_OK;
}

static tribo_status collide_simple(const pair_query *query, uint32_t method, uint32_t capacity,
                                   tribo_manifold *manifolds, uint32_t *count,
                                   tribo_collide_info *info)
{
    /* what cannot fail is written where it is to be */
    tribo_manifold m;
    tribo_manifold *out =
        capacity > 0 && query->safe && method != TRIBO_METHOD_GENERAL ? manifolds : &m;
    const tribo_status status = touch(query, method, out, info);
    if (status != TRIBO_OK) {
        return status;
    }
    *count = out->count > 0 ? 1 : 0;
    if (out == &m && m.count > 0 && capacity > 0) {
        copy_manifold(&m, manifolds);
    }
    return *count > capacity ? TRIBO_ERROR_CAPACITY : TRIBO_OK;
}

static void give_info(tribo_collide_info *info, tribo_collide_info *full)
{
    if (info) {
        full->struct_size = info->struct_size;
        memcpy(info, full, info->struct_size);
    }
}

tribo_status tribo_collide_shapes(const tribo_shape *shape_a, const tribo_pose *pose_a,
                                  const tribo_shape *shape_b, const tribo_pose *pose_b,
                                  const tribo_collide_options *options, uint32_t capacity,
                                  tribo_manifold *manifolds, uint32_t *count,
                                  tribo_collide_info *info)
{
    tribo_collide_options known;
    tribo_collide_info full = {0};
    pair_query query;
    if (!shape_a || !pose_a || !shape_b || !pose_b || !count || (!manifolds && capacity > 0)) {
        return TRIBO_ERROR_NULL;
    }
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_status status = read_options(options, &known);
    if (status == TRIBO_OK && capacity > 0 &&
        touch_ground(shape_a, pose_a, shape_b, pose_b, &known, manifolds, count)) {
        full.closed = 1;
        give_info(info, &full);
        return TRIBO_OK;
    }
    status =
        status == TRIBO_OK ? take_pair(shape_a, pose_a, shape_b, pose_b, &known, &query) : status;
    if (status != TRIBO_OK) {
        return status;
    }
    status = is_simple(shape_a) && is_simple(shape_b)
                 ? collide_simple(&query, known.method, capacity, manifolds, count, &full)
                 : collide_parts(&query, known.method, capacity, manifolds, count, &full);
    if (status == TRIBO_OK) {
        give_info(info, &full);
    }
    return status;
}

static tribo_status batch_pair(uint32_t shape_count, const tribo_shape *shapes,
                               const tribo_pose *poses, const uint32_t pair[2],
                               const tribo_collide_options *options, tribo_manifold *out,
                               tribo_collide_info *info)
{
    pair_query query;
    if (pair[0] >= shape_count || pair[1] >= shape_count) {
        return TRIBO_ERROR_INDEX;
    }
    if (pair[0] == pair[1]) {
        return TRIBO_ERROR_ALIAS;
    }
    const tribo_shape *a = &shapes[pair[0]];
    const tribo_shape *b = &shapes[pair[1]];
    uint32_t found;
    if (touch_ground(a, &poses[pair[0]], b, &poses[pair[1]], options, out, &found)) {
        info->closed++;
        return TRIBO_OK;
    }
    tribo_status status = take_pair(a, &poses[pair[0]], b, &poses[pair[1]], options, &query);
    if (status == TRIBO_OK && !(is_simple(a) && is_simple(b))) {
        status = TRIBO_ERROR_PAIR;
    }
    if (status != TRIBO_OK) {
        return status;
    }
    if (query.safe && options->method != TRIBO_METHOD_GENERAL) {
        return touch(&query, options->method, out, info);
    }
    tribo_manifold m;
    status = touch(&query, options->method, &m, info);
    if (status == TRIBO_OK) {
        copy_manifold(&m, out);
    }
    return status;
}

tribo_status tribo_collide_batch(uint32_t shape_count, const tribo_shape *shapes,
                                 const tribo_pose *poses, size_t count, const uint32_t *pairs,
                                 const tribo_collide_options *options, tribo_manifold *manifolds,
                                 tribo_status *statuses, tribo_collide_info *info)
{
    tribo_collide_options known;
    tribo_collide_info full = {0};
    if ((shape_count > 0 && (!shapes || !poses)) || (count > 0 && (!pairs || !manifolds))) {
        return TRIBO_ERROR_NULL;
    }
    if (info && !size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_status first = read_options(options, &known);
    if (first != TRIBO_OK) {
        return first;
    }
    for (size_t i = 0; i < count; i++) {
        const tribo_status status =
            batch_pair(shape_count, shapes, poses, pairs + 2 * i, &known, &manifolds[i], &full);
        if (statuses) {
            statuses[i] = status;
        }
        first = first == TRIBO_OK ? status : first;
    }
    give_info(info, &full);
    return first;
}
