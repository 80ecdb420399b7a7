#include <tribo/shape.h>

#include "hull.h"
#include "mesh.h"
#include "pair.h"
#include "rows.h"

#define UNIT_TOLERANCE 1e-6 /* of quaternions, which are used as if normalised */
#define PI 3.14159265358979323846

static int is_convex(uint32_t type)
{
    return type >= TRIBO_SHAPE_SPHERE && type <= TRIBO_SHAPE_CONVEX;
}

static const tribo_child *children_of(const tribo_shape *shape)
{
    return shape->data;
}

/* ---- judging --------------------------------------------------------------------------------- */

static tribo_status check_lengths(const double *size, int count)
{
    int well = 1;
    for (int i = 0; i < count; i++) {
        well = well && size[i] > 0.0 && size[i] < (double)INFINITY;
    }
    if (well) {
        return TRIBO_OK;
    }
    return all_finite(size, count) ? TRIBO_ERROR_SHAPE : TRIBO_ERROR_NOT_FINITE;
}

static tribo_status check_pose(const tribo_pose *pose)
{
    const double *q = pose->orientation;
    if (!all_finite(pose->position, 3) || !all_finite(q, 4)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return absolute(square - 1.0) <= 2.0 * UNIT_TOLERANCE ? TRIBO_OK : TRIBO_ERROR_ORIENTATION;
}

static tribo_status check_halfspace(const double *size)
{
    const double square = tribo_vec3_dot(size, size);
    if (all_finite(&size[3], 1) && absolute(square - 1.0) <= PAIR_NORMAL_TOLERANCE) {
        return TRIBO_OK;
    }
    return all_finite(size, 4) ? TRIBO_ERROR_NORMAL : TRIBO_ERROR_NOT_FINITE;
}

static tribo_status check_user(const tribo_convex *user)
{
    if (user->struct_size != sizeof *user) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    if (!user->support) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(user->center, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return check_lengths(&user->radius, 1);
}

static tribo_status check_data(const tribo_shape *shape)
{
    if (!shape->data) {
        return TRIBO_ERROR_NULL;
    }
    switch (shape->type) {
    case TRIBO_SHAPE_HULL:
        return hull_head_is_valid(shape->data) ? TRIBO_OK : TRIBO_ERROR_DATA;
    case TRIBO_SHAPE_MESH:
        return mesh_head_is_valid(shape->data) ? TRIBO_OK : TRIBO_ERROR_DATA;
    default:
        return check_user(shape->data);
    }
}

/* All but compounds. */
static tribo_status check_simple(const tribo_shape *shape)
{
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return check_lengths(shape->size, 1);
    case TRIBO_SHAPE_CAPSULE:
    case TRIBO_SHAPE_CYLINDER:
    case TRIBO_SHAPE_CONE:
        return check_lengths(shape->size, 2);
    case TRIBO_SHAPE_BOX:
    case TRIBO_SHAPE_ELLIPSOID:
        return check_lengths(shape->size, 3);
    case TRIBO_SHAPE_HALFSPACE:
        return check_halfspace(shape->size);
    case TRIBO_SHAPE_HULL:
    case TRIBO_SHAPE_MESH:
    case TRIBO_SHAPE_CONVEX:
        return check_data(shape);
    default:
        return TRIBO_ERROR_OPTION;
    }
}

/* Apart, so that all other shapes do not pay for its registers. */
TRIBO_NEVER_INLINE tribo_status check_compound(const tribo_shape *shape)
{
    const tribo_child *children = children_of(shape);
    if (!children) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = shape->count > 0 ? TRIBO_OK : TRIBO_ERROR_SHAPE;
    for (uint32_t i = 0; i < shape->count && status == TRIBO_OK; i++) {
        const uint32_t type = children[i].shape.type;
        const int is_known = type >= TRIBO_SHAPE_SPHERE && type <= TRIBO_SHAPE_COMPOUND;
        status =
            is_known && !is_convex(type) ? TRIBO_ERROR_SHAPE : check_simple(&children[i].shape);
        status = status == TRIBO_OK ? check_pose(&children[i].pose) : status;
    }
    return status;
}

tribo_status tribo_shape_check(const tribo_shape *shape)
{
    if (!shape) {
        return TRIBO_ERROR_NULL;
    }
    return shape->type == TRIBO_SHAPE_COMPOUND ? check_compound(shape) : check_simple(shape);
}

/* ---- directions ------------------------------------------------------------------------------ */

/* Scaled by the power of two that brings the largest component into [1, 2): no square overflows,
 * and none that matters is lost. */
static void scale_direction(const double d[3], double out[3])
{
    const double size = greater(absolute(d[0]), greater(absolute(d[1]), absolute(d[2])));
    tribo_vec3_scale(power_of_two(scale_exponent(size)), d, out);
}

/* d / |d|, zero for zero. */
static void unit_of(const double d[3], double out[3])
{
    double s[3];
    scale_direction(d, s);
    const double length = sqrt(tribo_vec3_dot(s, s));
    for (int i = 0; i < 3; i++) {
        out[i] = length > 0.0 ? s[i] / length : 0.0; /* exactly 1 along an axis */
    }
}

static double length_of(const double d[3])
{
    double s[3];
    const double size = greater(absolute(d[0]), greater(absolute(d[1]), absolute(d[2])));
    const uint64_t exponent = scale_exponent(size);
    tribo_vec3_scale(power_of_two(exponent), d, s);
    return sqrt(tribo_vec3_dot(s, s)) * power_of_two(2046u - exponent);
}

/* Unit vector along (x, y), however small beside z; zero on the axis. */
static void radial_unit(const double d[3], double out[3])
{
    const double flat[3] = {d[0], d[1], 0.0};
    unit_of(flat, out);
}

/* ---- support points -------------------------------------------------------------------------- */

/* Ties go to the positive side; no caller has a negative zero. */
static double toward(double direction, double length)
{
    return copysign(length, direction);
}

static void support_ellipsoid(const double axes[3], const double d[3], double point[3])
{
    double stretched[3];
    scale_direction(d, stretched);
    for (int i = 0; i < 3; i++) {
        stretched[i] *= axes[i];
    }
    unit_of(stretched, point);
    for (int i = 0; i < 3; i++) {
        point[i] *= axes[i];
    }
}

/* Along the axis the whole cap is farthest; its centre stands for it. */
static void support_cylinder(const double size[2], const double d[3], double point[3])
{
    radial_unit(d, point);
    tribo_vec3_scale(size[0], point, point);
    point[2] = toward(d[2], size[1]);
}

/* The apex is farthest if 2 h z >= r |(x, y)|. */
static int faces_apex(const double size[2], const double d[3])
{
    double s[3];
    scale_direction(d, s);
    return 2.0 * size[1] * s[2] >= size[0] * sqrt(s[0] * s[0] + s[1] * s[1]);
}

static void support_cone(const double size[2], const double d[3], double point[3])
{
    if (faces_apex(size, d)) {
        point[0] = 0.0;
        point[1] = 0.0;
        point[2] = size[1];
        return;
    }
    radial_unit(d, point);
    tribo_vec3_scale(size[0], point, point);
    point[2] = -size[1];
}

static uint32_t hull_vertex(const tribo_shape *shape, const double direction[3])
{
    double s[3];
    scale_direction(direction, s);
    return hull_support(shape->data, s);
}

static void support_hull(const tribo_shape *shape, const double direction[3], double point[3])
{
    const uint32_t vertex = hull_vertex(shape, direction);
    memcpy(point, hull_vertices(shape->data) + 3 * (size_t)vertex, 3 * sizeof *point);
}

static int support_user(const tribo_convex *user, const double direction[3], double point[3])
{
    double p[3] = {0.0, 0.0, 0.0};
    user->support(user->user, direction, p);
    memcpy(point, p, sizeof p);
    return all_finite(p, 3);
}

int shape_support(const tribo_shape *shape, const double direction[3], double point[3])
{
    const double *size = shape->size;
    /* One zero only: a negative one would show in the result. */
    const double d[3] = {direction[0] + 0.0, direction[1] + 0.0, direction[2] + 0.0};
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        unit_of(d, point);
        tribo_vec3_scale(size[0], point, point);
        return 1;
    case TRIBO_SHAPE_BOX:
        for (int i = 0; i < 3; i++) {
            point[i] = toward(d[i], size[i]);
        }
        return 1;
    case TRIBO_SHAPE_CAPSULE:
        unit_of(d, point);
        tribo_vec3_scale(size[0], point, point);
        point[2] += toward(d[2], size[1]);
        return 1;
    case TRIBO_SHAPE_CYLINDER:
        support_cylinder(size, d, point);
        return 1;
    case TRIBO_SHAPE_CONE:
        support_cone(size, d, point);
        return 1;
    case TRIBO_SHAPE_ELLIPSOID:
        support_ellipsoid(size, d, point);
        return 1;
    case TRIBO_SHAPE_HULL:
        support_hull(shape, d, point);
        return 1;
    default:
        return support_user(shape->data, d, point);
    }
}

/* ---- support faces --------------------------------------------------------------------------- */

static const double half_root = 0.70710678118654752440;

/* Feature numbers of the round shapes. */
enum { SIDE = 0, TOP = 1, BOTTOM = 2 };

static uint32_t face_box(const double half[3], const double d[3], double *points, double normal[3],
                         uint32_t *feature)
{
    const double x = absolute(d[0]);
    const double y = absolute(d[1]);
    const double z = absolute(d[2]);
    const int i = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const int negative = d[i] < 0.0;
    static const double corner[4][2] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
    for (int c = 0; c < 4; c++) {
        double *p = points + 3 * c;
        p[i] = negative ? -half[i] : half[i];
        p[j] = corner[c][negative] * half[j];
        p[k] = corner[c][1 - negative] * half[k];
    }
    normal[i] = negative ? -1.0 : 1.0;
    normal[j] = 0.0;
    normal[k] = 0.0;
    *feature = (uint32_t)(2 * i + negative);
    return 4;
}

/* Eight points of a circle at fixed angles, counter-clockwise seen from the side it faces. */
static uint32_t face_circle(double radius, double height, double facing, double *points,
                            double normal[3])
{
    static const double circle[8][2] = {{1.0, 0.0},  {1.0, 1.0},   {0.0, 1.0},  {-1.0, 1.0},
                                        {-1.0, 0.0}, {-1.0, -1.0}, {0.0, -1.0}, {1.0, -1.0}};
    for (int c = 0; c < 8; c++) {
        const double *place = circle[facing > 0.0 ? c : (8 - c) % 8];
        const double reach = c % 2 == 0 ? radius : radius * half_root;
        points[3 * c] = reach * place[0];
        points[3 * c + 1] = reach * place[1];
        points[3 * c + 2] = height;
    }
    normal[0] = 0.0;
    normal[1] = 0.0;
    normal[2] = facing;
    return 8;
}

/* The side if it is turned to the direction more than the cap: a line of it. */
static uint32_t face_cylinder(const double size[2], const double d[3], double *points,
                              double normal[3], uint32_t *feature)
{
    const double radial = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
    if (absolute(normal[2]) >= radial) {
        *feature = d[2] < 0.0 ? BOTTOM : TOP;
        return face_circle(size[0], toward(d[2], size[1]), toward(d[2], 1.0), points, normal);
    }
    radial_unit(d, points);
    tribo_vec3_scale(size[0], points, points);
    memcpy(points + 3, points, 3 * sizeof *points);
    points[2] = -size[1];
    points[5] = size[1];
    return 2;
}

/* Side normal (2 h, r) / length against base normal (0, -1), in the plane through the axis. */
static uint32_t face_cone(const double size[2], const double d[3], double *points, double normal[3],
                          uint32_t *feature)
{
    const double lengths[3] = {2.0 * size[1], size[0], 0.0};
    const double radial = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
    double slope[3];
    unit_of(lengths, slope);
    if (-normal[2] >= slope[0] * radial + slope[1] * normal[2]) {
        *feature = BOTTOM;
        return face_circle(size[0], -size[1], -1.0, points, normal);
    }
    const double apex[3] = {0.0, 0.0, size[1]};
    if (d[0] == 0.0 && d[1] == 0.0) {
        memcpy(points, apex, sizeof apex);
        *feature = TOP;
        return 1;
    }
    radial_unit(d, points);
    tribo_vec3_scale(size[0], points, points);
    points[2] = -size[1];
    memcpy(points + 3, apex, sizeof apex);
    return 2;
}

/* The segment moved out by the radius along the direction: its farthest point is exact. */
static uint32_t face_capsule(const double size[2], double *points, const double normal[3],
                             uint32_t *feature)
{
    const double radial = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
    tribo_vec3_scale(size[0], normal, points);
    if (absolute(normal[2]) > radial) {
        points[2] += toward(normal[2], size[1]);
        *feature = normal[2] < 0.0 ? BOTTOM : TOP;
        return 1;
    }
    memcpy(points + 3, points, 3 * sizeof *points);
    points[2] -= size[1];
    points[5] += size[1];
    return 2;
}

/* Of a large loop the extreme vertices along TRIBO_MAX_FACE directions in its plane, which come in
 * loop order. Returns how many there are. */
static uint32_t thin_loop(const hull_block *hull, const uint32_t *loop, uint32_t count,
                          const double normal[3], uint32_t kept[TRIBO_MAX_FACE])
{
    const double *vertices = hull_vertices(hull);
    double frame[9];
    uint32_t length = 0;
    basis_rows(normal[0], normal[1], normal[2], frame);
    for (uint32_t k = 0; k < TRIBO_MAX_FACE; k++) {
        double d[3];
        double sine;
        double cosine;
        tribo_sin_cos(2.0 * PI / TRIBO_MAX_FACE * (double)k, &sine, &cosine);
        tribo_vec3_scale(cosine, frame + 3, d);
        tribo_vec3_add_scaled(d, sine, frame + 6, d);
        uint32_t best = 0;
        double greatest = -HUGE_VAL;
        for (uint32_t i = 0; i < count; i++) {
            double arm[3];
            tribo_vec3_subtract(vertices + 3 * (size_t)loop[i], hull->center, arm);
            const double along = tribo_vec3_dot(arm, d);
            best = along > greatest ? i : best;
            greatest = along > greatest ? along : greatest;
        }
        const int is_new = length == 0 || (kept[length - 1] != best && kept[0] != best);
        kept[length] = best;
        length += is_new ? 1u : 0u;
    }
    return length;
}

/* Puts the support vertex in the place of the one before it in the loop, so that thinning costs no
 * depth. */
static void keep_vertex(const uint32_t *loop, uint32_t count, uint32_t vertex, uint32_t *kept,
                        uint32_t length)
{
    uint32_t at = 0;
    while (at + 1 < count && loop[at] != vertex) {
        at++;
    }
    uint32_t nearest = 0;
    uint32_t least = count;
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t steps = (at + count - kept[i]) % count;
        nearest = steps < least ? i : nearest;
        least = steps < least ? steps : least;
    }
    kept[nearest] = at;
}

/* The normal is the direction before. */
static uint32_t face_hull(const tribo_shape *shape, uint32_t vertex, double *points,
                          double normal[3], uint32_t *feature)
{
    const hull_block *hull = shape->data;
    const uint32_t face = hull_face_at(hull, vertex, normal);
    const uint32_t *starts = hull_table(hull, hull->face_starts);
    const uint32_t *loop = hull_table(hull, hull->loops) + starts[face];
    uint32_t count = starts[face + 1] - starts[face];
    uint32_t kept[TRIBO_MAX_FACE];
    memcpy(normal, hull_planes(hull) + 4 * (size_t)face, 3 * sizeof *normal);
    const int is_large = count > TRIBO_MAX_FACE;
    if (is_large) {
        const uint32_t length = thin_loop(hull, loop, count, normal, kept);
        keep_vertex(loop, count, vertex, kept, length);
        count = length;
    }
    for (uint32_t i = 0; i < count; i++) {
        const double *v = hull_vertices(hull) + 3 * (size_t)loop[is_large ? kept[i] : i];
        memcpy(points + 3 * (size_t)i, v, 3 * sizeof *points);
    }
    *feature = face;
    return count;
}

/* Twice the area of a polygon times its normal. */
static void polygon_normal(const double *points, uint32_t count, double normal[3])
{
    double a[3];
    double b[3];
    double cross[3];
    memset(normal, 0, 3 * sizeof *normal);
    tribo_vec3_subtract(points + 3, points, b);
    for (size_t i = 2; i < count; i++) {
        memcpy(a, b, sizeof a);
        tribo_vec3_subtract(points + 3 * i, points, b);
        tribo_vec3_cross(a, b, cross);
        tribo_vec3_add(normal, cross, normal);
    }
}

static void reverse_points(double *points, uint32_t count)
{
    for (size_t i = 0, j = count; i + 1 < j; i++) {
        j--;
        double p[3];
        memcpy(p, points + 3 * i, sizeof p);
        memcpy(points + 3 * i, points + 3 * j, sizeof p);
        memcpy(points + 3 * j, p, sizeof p);
    }
}

/* What a user's face function says counts only if it is a polygon. */
static uint32_t face_user(const tribo_convex *user, const double d[3], double *points,
                          double normal[3])
{
    uint32_t count = 0;
    if (user->face) {
        memset(points, 0, 3 * TRIBO_MAX_FACE * sizeof *points);
        count = user->face(user->user, d, TRIBO_MAX_FACE, points);
    }
    if (count > TRIBO_MAX_FACE ||
        !all_finite(points, count <= TRIBO_MAX_FACE ? 3 * (int)count : 0)) {
        count = 0;
    }
    if (count >= 3) {
        double area[3];
        polygon_normal(points, count, area);
        if (tribo_vec3_dot(area, d) < 0.0) {
            reverse_points(points, count);
            tribo_vec3_scale(-1.0, area, area);
        }
        const int has_area = area[0] != 0.0 || area[1] != 0.0 || area[2] != 0.0;
        count = has_area && all_finite(area, 3) ? count : 0;
        if (count > 0) {
            unit_of(area, normal);
        }
    }
    return count > 0 ? count : support_user(user, d, points) ? 1u : 0u;
}

uint32_t shape_face_at(const tribo_shape *shape, uint32_t vertex, const double direction[3],
                       double points[3 * TRIBO_MAX_FACE], double normal[3], uint32_t *feature)
{
    unit_of(direction, normal);
    return face_hull(shape, vertex, points, normal, feature);
}

uint32_t shape_face(const tribo_shape *shape, const double direction[3],
                    double points[3 * TRIBO_MAX_FACE], double normal[3], uint32_t *feature)
{
    const double d[3] = {direction[0] + 0.0, direction[1] + 0.0, direction[2] + 0.0};
    *feature = SIDE;
    unit_of(d, normal);
    switch (shape->type) {
    case TRIBO_SHAPE_BOX:
        return face_box(shape->size, d, points, normal, feature);
    case TRIBO_SHAPE_CAPSULE:
        return face_capsule(shape->size, points, normal, feature);
    case TRIBO_SHAPE_CYLINDER:
        return face_cylinder(shape->size, d, points, normal, feature);
    case TRIBO_SHAPE_CONE:
        return face_cone(shape->size, d, points, normal, feature);
    case TRIBO_SHAPE_HULL:
        return face_hull(shape, hull_vertex(shape, d), points, normal, feature);
    case TRIBO_SHAPE_CONVEX:
        return face_user(shape->data, d, points, normal);
    default:
        return (uint32_t)shape_support(shape, d, points);
    }
}

/* ---- inner points ---------------------------------------------------------------------------- */

/* Centre of the largest ball in the cone: the incircle of its section. */
static void core_cone(const double size[2], double center[3], double *inner, double *outer)
{
    const double rim[3] = {size[0], 2.0 * size[1], 0.0};
    const double slant = length_of(rim);
    *inner = 2.0 * size[1] * (size[0] / (size[0] + slant));
    center[2] = *inner - size[1];
    const double to_rim[3] = {size[0], *inner, 0.0};
    *outer = greater(2.0 * size[1] - *inner, length_of(to_rim));
}

static void core_data(const tribo_shape *shape, double center[3], double *inner, double *outer)
{
    if (shape->type == TRIBO_SHAPE_HULL) {
        const hull_block *hull = shape->data;
        memcpy(center, hull->center, sizeof hull->center);
        *inner = hull->inner;
        *outer = hull->outer;
    } else {
        const tribo_convex *user = shape->data;
        memcpy(center, user->center, sizeof user->center);
        *inner = 0.0;
        *outer = user->radius;
    }
}

void shape_core(const tribo_shape *shape, double center[3], double *inner, double *outer)
{
    const double *s = shape->size;
    const double rim[3] = {s[0], s[1], 0.0};
    memset(center, 0, 3 * sizeof *center);
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        *inner = s[0];
        *outer = s[0];
        break;
    case TRIBO_SHAPE_CAPSULE:
        *inner = s[0];
        *outer = s[0] + s[1];
        break;
    case TRIBO_SHAPE_CYLINDER:
        *inner = lesser(s[0], s[1]);
        *outer = length_of(rim);
        break;
    case TRIBO_SHAPE_CONE:
        core_cone(s, center, inner, outer);
        break;
    case TRIBO_SHAPE_BOX:
    case TRIBO_SHAPE_ELLIPSOID:
        *inner = lesser(s[0], lesser(s[1], s[2]));
        *outer = shape->type == TRIBO_SHAPE_BOX ? length_of(s) : greater(s[0], greater(s[1], s[2]));
        break;
    default:
        core_data(shape, center, inner, outer);
        break;
    }
}

/* ---- public queries -------------------------------------------------------------------------- */

static tribo_status check_query(const tribo_shape *shape, const double direction[3])
{
    if (!all_finite(direction, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) {
        return TRIBO_ERROR_RANGE;
    }
    if (!is_convex(shape->type)) {
        return TRIBO_ERROR_SHAPE;
    }
    return shape->type < TRIBO_SHAPE_HULL || shape->data ? TRIBO_OK : TRIBO_ERROR_NULL;
}

tribo_status tribo_shape_support(const tribo_shape *shape, const double direction[3],
                                 double point[3])
{
    if (!shape || !direction || !point) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = check_query(shape, direction);
    if (status != TRIBO_OK) {
        return status;
    }
    double p[3];
    if (!shape_support(shape, direction, p)) {
        return TRIBO_ERROR_SUPPORT;
    }
    memcpy(point, p, sizeof p);
    return TRIBO_OK;
}

tribo_status tribo_shape_face(const tribo_shape *shape, const double direction[3],
                              uint32_t capacity, double *points, uint32_t *count, double normal[3])
{
    if (!shape || !direction || !points || !count || !normal) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = check_query(shape, direction);
    if (status != TRIBO_OK) {
        return status;
    }
    double face[3 * TRIBO_MAX_FACE];
    double n[3];
    uint32_t feature;
    const uint32_t found = shape_face(shape, direction, face, n, &feature);
    if (found == 0) {
        return TRIBO_ERROR_SUPPORT;
    }
    if (found > capacity) {
        return TRIBO_ERROR_CAPACITY;
    }
    memcpy(points, face, 3 * (size_t)found * sizeof *points);
    memcpy(normal, n, sizeof n);
    *count = found;
    return TRIBO_OK;
}

/* ---- bounds ---------------------------------------------------------------------------------- */

typedef struct interval {
    double low;
    double high;
} interval;

static interval around(double reach)
{
    const interval range = {-reach, reach};
    return range;
}

/* Between the support points along a row and against it. 0 where a user's function gave none. */
static int supported_interval(const tribo_shape *shape, const double row[3], interval *range)
{
    const double back[3] = {-row[0], -row[1], -row[2]};
    double high[3];
    double low[3];
    if (!shape_support(shape, row, high) || !shape_support(shape, back, low)) {
        return 0;
    }
    range->low = tribo_vec3_dot(row, low);
    range->high = tribo_vec3_dot(row, high);
    return 1;
}

static interval cone_interval(const double size[2], double radial, double along)
{
    const double apex = size[1] * along;
    const double rim = size[0] * radial;
    const interval range = {lesser(apex, -apex - rim), greater(apex, rim - apex)};
    return range;
}

/* Extent of a convex shape along a unit vector in its own axes. */
static int convex_interval(const tribo_shape *shape, const double row[3], interval *range)
{
    const double *size = shape->size;
    const double stretched[3] = {row[0] * size[0], row[1] * size[1], row[2] * size[2]};
    const double radial = sqrt(row[0] * row[0] + row[1] * row[1]);
    const double along = absolute(row[2]);
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        *range = around(size[0]);
        return 1;
    case TRIBO_SHAPE_BOX:
        *range = around(absolute(stretched[0]) + absolute(stretched[1]) + absolute(stretched[2]));
        return 1;
    case TRIBO_SHAPE_CAPSULE:
        *range = around(size[0] + size[1] * along);
        return 1;
    case TRIBO_SHAPE_CYLINDER:
        *range = around(size[0] * radial + size[1] * along);
        return 1;
    case TRIBO_SHAPE_CONE:
        *range = cone_interval(size, radial, row[2]);
        return 1;
    case TRIBO_SHAPE_ELLIPSOID:
        *range = around(length_of(stretched));
        return 1;
    default:
        return supported_interval(shape, row, range);
    }
}

static void rotation_of(const tribo_pose *pose, double r[9])
{
    const double *q = pose->orientation;
    rotation_rows(q[0], q[1], q[2], q[3], r);
}

static int compound_interval(const tribo_shape *shape, const double row[3], interval *range)
{
    const tribo_child *children = children_of(shape);
    range->low = HUGE_VAL;
    range->high = -HUGE_VAL;
    for (uint32_t i = 0; i < shape->count; i++) {
        const tribo_child *child = &children[i];
        double r[9];
        double own[3];
        interval part;
        rotation_of(&child->pose, r);
        tribo_mat3_apply_transposed(r, row, own);
        if (!convex_interval(&child->shape, own, &part)) {
            return 0;
        }
        const double shift = tribo_vec3_dot(row, child->pose.position);
        range->low = lesser(range->low, shift + part.low);
        range->high = greater(range->high, shift + part.high);
    }
    return 1;
}

/* Bounded only along an axis that the normal lies on to the bit. */
static void halfspace_bounds(const double size[4], const double r[9], double low[3], double high[3])
{
    double n[3];
    tribo_mat3_apply(r, size, n);
    for (int i = 0; i < 3; i++) {
        const int alone = n[(i + 1) % 3] == 0.0 && n[(i + 2) % 3] == 0.0;
        low[i] = alone && n[i] < 0.0 ? size[3] / n[i] : -HUGE_VAL;
        high[i] = alone && n[i] > 0.0 ? size[3] / n[i] : HUGE_VAL;
    }
}

/* Relative to the position of the pose. */
static int local_bounds(const tribo_shape *shape, const double r[9], double low[3], double high[3])
{
    if (shape->type == TRIBO_SHAPE_HALFSPACE) {
        halfspace_bounds(shape->size, r, low, high);
        return 1;
    }
    if (shape->type == TRIBO_SHAPE_MESH) {
        mesh_extent(shape->data, r, low, high);
        return 1;
    }
    for (int i = 0; i < 3; i++) {
        interval range;
        const int known = shape->type == TRIBO_SHAPE_COMPOUND
                              ? compound_interval(shape, r + 3 * i, &range)
                              : convex_interval(shape, r + 3 * i, &range);
        if (!known) {
            return 0;
        }
        low[i] = range.low;
        high[i] = range.high;
    }
    return 1;
}

tribo_status tribo_shape_bounds(const tribo_shape *shape, const tribo_pose *pose, double low[3],
                                double high[3])
{
    if (!shape || !pose || !low || !high) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = tribo_shape_check(shape);
    status = status == TRIBO_OK ? check_pose(pose) : status;
    if (status != TRIBO_OK) {
        return status;
    }
    const double *position = pose->position;
    double r[9];
    double from[3];
    double to[3];
    rotation_of(pose, r);
    if (!local_bounds(shape, r, from, to)) {
        return TRIBO_ERROR_SUPPORT;
    }
    for (int i = 0; i < 3; i++) {
        from[i] += position[i];
        to[i] += position[i];
    }
    memcpy(low, from, sizeof from);
    memcpy(high, to, sizeof to);
    return TRIBO_OK;
}

/* ---- mass properties ------------------------------------------------------------------------- */

typedef struct solid {
    double mass;
    double center[3];
    double inertia[9];
} solid;

static tribo_status check_solid(const solid *s)
{
    const double values[4] = {s->mass, s->inertia[0], s->inertia[4], s->inertia[8]};
    for (int i = 0; i < 4; i++) {
        if (!(values[i] > 0.0)) {
            return TRIBO_ERROR_RANGE;
        }
    }
    return all_finite(values, 4) && all_finite(s->inertia, 9) && all_finite(s->center, 3)
               ? TRIBO_OK
               : TRIBO_ERROR_RANGE;
}

/* Centre of mass a quarter of the height above the base. */
static tribo_status cone_solid(double density, const double size[2], solid *out)
{
    const double r2 = size[0] * size[0];
    const double h = size[1];
    const double m = 2.0 / 3.0 * PI * density * r2 * h;
    const double across = 0.15 * m * (r2 + h * h);
    const double full[9] = {across, 0.0, 0.0, 0.0, across, 0.0, 0.0, 0.0, 0.3 * m * r2};
    out->mass = m;
    out->center[2] = -0.5 * h;
    memcpy(out->inertia, full, sizeof full);
    return check_solid(out);
}

static tribo_status hull_solid(double density, const hull_block *hull, solid *out)
{
    const uint64_t exponent = scale_exponent(hull->outer);
    const double unit = power_of_two(2046u - exponent);
    double volume;
    double shift[3];
    double s[6];
    hull_moments(hull, power_of_two(exponent), &volume, shift, s);
    tribo_vec3_add_scaled(hull->center, unit, shift, out->center);
    out->mass = density * volume * unit * unit * unit;
    const double full[9] = {s[3] + s[5], -s[1], -s[2], -s[1],      s[0] + s[5],
                            -s[4],       -s[2], -s[4], s[0] + s[3]};
    for (int i = 0; i < 9; i++) {
        out->inertia[i] = density * full[i] * unit * unit * unit * unit * unit;
    }
    return check_solid(out);
}

static tribo_status convex_solid(double density, const tribo_shape *shape, solid *out)
{
    const double *size = shape->size;
    memset(out, 0, sizeof *out);
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return tribo_mass_sphere(density, size[0], &out->mass, out->inertia);
    case TRIBO_SHAPE_BOX:
        return tribo_mass_box(density, size, &out->mass, out->inertia);
    case TRIBO_SHAPE_CAPSULE:
        return tribo_mass_capsule(density, size[0], size[1], &out->mass, out->inertia);
    case TRIBO_SHAPE_CYLINDER:
        return tribo_mass_cylinder(density, size[0], size[1], &out->mass, out->inertia);
    case TRIBO_SHAPE_CONE:
        return cone_solid(density, size, out);
    case TRIBO_SHAPE_ELLIPSOID:
        return tribo_mass_ellipsoid(density, size, &out->mass, out->inertia);
    case TRIBO_SHAPE_HULL:
        return hull_solid(density, shape->data, out);
    default:
        return TRIBO_ERROR_SHAPE;
    }
}

/* The part in the axes of the compound. */
static tribo_status child_solid(double density, const tribo_child *child, solid *out)
{
    solid part;
    const tribo_status status = convex_solid(density, &child->shape, &part);
    if (status != TRIBO_OK) {
        return status;
    }
    double r[9];
    double turned[9];
    rotation_of(&child->pose, r);
    out->mass = part.mass;
    tribo_mat3_apply(r, part.center, out->center);
    tribo_vec3_add(out->center, child->pose.position, out->center);
    for (int i = 0; i < 3; i++) {
        tribo_mat3_apply(part.inertia, r + 3 * i, turned + 3 * i);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out->inertia[3 * i + j] = tribo_vec3_dot(r + 3 * i, turned + 3 * j);
        }
    }
    return TRIBO_OK;
}

/* Adds a part's inertia about the point that `arm` leads from. */
static void add_inertia(const solid *part, const double arm[3], double inertia[9])
{
    const double square = tribo_vec3_dot(arm, arm);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double own = 0.5 * (part->inertia[3 * i + j] + part->inertia[3 * j + i]);
            inertia[3 * i + j] += own + part->mass * ((i == j ? square : 0.0) - arm[i] * arm[j]);
        }
    }
}

static tribo_status compound_solid(double density, const tribo_shape *shape, solid *out)
{
    const tribo_child *children = children_of(shape);
    solid part;
    double origin[3] = {0.0, 0.0, 0.0};
    double arm[3];
    double moment[3] = {0.0, 0.0, 0.0};
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < shape->count; i++) {
        const tribo_status status = child_solid(density, &children[i], &part);
        if (status != TRIBO_OK) {
            return status;
        }
        if (i == 0) {
            memcpy(origin, part.center, sizeof origin);
        }
        tribo_vec3_subtract(part.center, origin, arm);
        tribo_vec3_add_scaled(moment, part.mass, arm, moment);
        out->mass += part.mass;
    }
    tribo_vec3_add_scaled(origin, 1.0 / out->mass, moment, out->center);
    for (uint32_t i = 0; i < shape->count; i++) {
        child_solid(density, &children[i], &part);
        tribo_vec3_subtract(part.center, out->center, arm);
        add_inertia(&part, arm, out->inertia);
    }
    return check_solid(out);
}

tribo_status tribo_shape_mass(const tribo_shape *shape, double density, double *mass,
                              double center[3], double inertia[9])
{
    if (!shape || !mass || !center || !inertia) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = tribo_shape_check(shape);
    status = status == TRIBO_OK ? check_lengths(&density, 1) : status;
    if (status != TRIBO_OK) {
        return status;
    }
    solid s;
    status = shape->type == TRIBO_SHAPE_COMPOUND ? compound_solid(density, shape, &s)
                                                 : convex_solid(density, shape, &s);
    if (status != TRIBO_OK) {
        return status;
    }
    *mass = s.mass;
    memcpy(center, s.center, sizeof s.center);
    memcpy(inertia, s.inertia, sizeof s.inertia);
    return TRIBO_OK;
}
