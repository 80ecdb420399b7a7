/* Pairs that have a closed form: half-space with every convex shape, spheres and capsules with each
 * other, sphere with box, box with box.
 *
 * Where the direction of least depth is not unique, one is named here and stays the same from call
 * to call:
 * - spheres about one point: the world's z axis;
 * - a sphere's centre on a capsule's segment: the capsule's x axis;
 * - a sphere's centre inside of a box, as near to several faces: the face of the first axis, its
 *   positive side;
 * - capsules whose segments touch: across both where they cross inside, else away from the ends
 *   that touch; along one line: across it, by the contact basis of that line;
 * - boxes: faces of A before faces of B before edges, and A on the positive side of them. */
#include "box.h"
#include "pair.h"
#include "rows.h"

#include <tribo/math.h>

static void column(const double r[9], int i, double out[3])
{
    out[0] = r[i];
    out[1] = r[3 + i];
    out[2] = r[6 + i];
}

static double sign_of(double x)
{
    return copysign(1.0, x + 0.0);
}

static double within(double x, double bound)
{
    return x < -bound ? -bound : x > bound ? bound : x;
}

/* out = v / |v|, and |v|; 0 if v is zero. */
static double unit(const double v[3], double out[3])
{
    const double square = tribo_vec3_dot(v, v);
    if (square > 1e-280 && square < 1e280) {
        const double length = sqrt(square);
        out[0] = v[0] / length;
        out[1] = v[1] / length;
        out[2] = v[2] / length;
        return length;
    }
    return tribo_vec3_normalize(v, out) == TRIBO_OK ? tribo_vec3_norm(v) : 0.0;
}

/* Takes out of v what it has along a unit vector. */
static void square_to(const double axis[3], double v[3])
{
    tribo_vec3_add_scaled(v, 0.0 - tribo_vec3_dot(v, axis), axis, v);
}

/* One point at `middle`. */
static void single(const pair_query *query, const double normal[3], const double middle[3],
                   double distance, uint32_t a, uint32_t b, tribo_manifold *out)
{
    pair_point point;
    memcpy(point.middle, middle, sizeof point.middle);
    point.distance = distance;
    point.a = a;
    point.b = b;
    clip_finish(query, normal, 0.0, 1, &point, out);
}

/* ---- balls ---------------------------------------------------------------------------------- */

/* Balls of radius r about two points: `apart` runs from the one of B to the one of A, `at` is the
 * latter. */
static void balls(const pair_query *query, const double at[3], double radius_a, double radius_b,
                  double length, const double normal[3], uint32_t a, uint32_t b,
                  tribo_manifold *out)
{
    const double distance = length - (radius_a + radius_b);
    double middle[3];
    tribo_vec3_add_scaled(at, 0.0 - (radius_a + 0.5 * distance), normal, middle);
    single(query, normal, middle, distance, a, b, out);
}

static void sphere_sphere(const pair_query *query, tribo_manifold *out)
{
    static const double center[3] = {0.0, 0.0, 0.0};
    const double apart[3] = {0.0 - query->offset[0], 0.0 - query->offset[1],
                             0.0 - query->offset[2]};
    double normal[3] = {0.0, 0.0, 1.0};
    const double length = unit(apart, normal);
    balls(query, center, query->a->size[0], query->b->size[0], length, normal,
          pair_feature(0, PAIR_CURVED, 0), pair_feature(0, PAIR_CURVED, 0), out);
}

/* The nearest point of the capsule's segment decides; its two ends and its barrel are features. */
static void sphere_capsule(const pair_query *query, tribo_manifold *out)
{
    static const double center[3] = {0.0, 0.0, 0.0};
    const double half = query->b->size[1];
    double axis[3];
    double apart[3];
    double normal[3];
    column(query->rb, 2, axis);
    column(query->rb, 0, normal);
    const double along = 0.0 - tribo_vec3_dot(axis, query->offset);
    const double t = within(along, half);
    for (int i = 0; i < 3; i++) {
        apart[i] = 0.0 - (query->offset[i] + t * axis[i]);
    }
    if (t == along) {
        square_to(axis, apart); /* a short way has noise, which the length of the axis would show */
    }
    const double length = unit(apart, normal);
    const uint32_t place = along > half ? 1 : along < -half ? 2 : 0;
    balls(query, center, query->a->size[0], query->b->size[0], length, normal,
          pair_feature(0, PAIR_CURVED, 0), pair_feature(0, PAIR_CURVED, place), out);
}

/* ---- capsules ------------------------------------------------------------------------------- */

#define SEGMENTS_PARALLEL 1e-14 /* sine of the angle below which it is noise */
#define SEGMENTS_TOUCH 1e-14    /* of the lengths: below this the direction between them is noise */
#define LINE_OF_CONTACT \
    1e-3 /* sideways shift, by distance and lesser radius, up to which two ends touch too */

/* Two segments: centres on a line from A's to B's, unit directions, half-lengths; where they are
 * nearest. */
typedef struct segments {
    double a[3];
    double b[3];
    double offset[3]; /* centre of B minus centre of A */
    double half[2];
    double cosine;
    double s; /* parameters along a and b, lengths */
    double t;
    double apart[3]; /* from the point on B to the point on A */
} segments;

static void separate(segments *g)
{
    for (int i = 0; i < 3; i++) {
        g->apart[i] = g->s * g->a[i] - (g->offset[i] + g->t * g->b[i]);
    }
}

/* Between points inside of segments the way is square to them: a short one has noise, which the
 * lengths of the segments would show. */
static void square_to_axes(segments *g, double sine2)
{
    const int a_inside = absolute(g->s) < g->half[0];
    const int b_inside = absolute(g->t) < g->half[1];
    double across[3];
    if (a_inside) {
        square_to(g->a, g->apart);
    } else if (b_inside) {
        square_to(g->b, g->apart);
    }
    if (a_inside && b_inside && sine2 > SEGMENTS_PARALLEL * SEGMENTS_PARALLEL) {
        tribo_vec3_add_scaled(g->b, 0.0 - g->cosine, g->a, across);
        if (unit(across, across) > 0.0) {
            square_to(across, g->apart);
        }
    }
}

/* Nearest points of two segments (Ericson, Real-Time Collision Detection, 5.1.9), for unit
 * directions. The sine comes from the cross product: 1 - cosine^2 would lose half of the digits. */
static void nearest_points(segments *g)
{
    double cross[3];
    const double da = tribo_vec3_dot(g->a, g->offset);
    const double db = tribo_vec3_dot(g->b, g->offset);
    tribo_vec3_cross(g->a, g->b, cross);
    const double sine2 = tribo_vec3_dot(cross, cross);
    g->cosine = tribo_vec3_dot(g->a, g->b);
    double s;
    if (sine2 > SEGMENTS_PARALLEL * SEGMENTS_PARALLEL) {
        double turn[3];
        tribo_vec3_cross(g->offset, g->b, turn);
        s = within(tribo_vec3_dot(turn, cross) / sine2, g->half[0]);
    } else {
        /* The middle of the overlap, or the end that is nearest to B. */
        const double reach = g->half[1];
        const double low = within(da - reach, g->half[0]);
        const double high = within(da + reach, g->half[0]);
        s = 0.5 * (low + high);
    }
    const double t = s * g->cosine - db;
    g->t = within(t, g->half[1]);
    g->s = t == g->t ? s : within(da + g->t * g->cosine, g->half[0]);
    separate(g);
    square_to_axes(g, sine2);
}

/* Directions of an end that touches: out of the segment's middle into it, or nothing inside. */
static void away_from_end(const double axis[3], double at, double half, double out[3])
{
    const double sign = absolute(at) < half ? 0.0 : at > 0.0 ? -1.0 : 1.0;
    tribo_vec3_scale(sign, axis, out);
}

/* Normal where the segments touch each other: see the head of this file. */
static void touching_normal(const segments *g, double normal[3])
{
    double from_a[3];
    double from_b[3];
    double direction[3];
    const int a_inside = absolute(g->s) < g->half[0];
    const int b_inside = absolute(g->t) < g->half[1];
    away_from_end(g->a, g->s, g->half[0], from_a);
    away_from_end(g->b, g->t, g->half[1], from_b);
    if (a_inside && b_inside) {
        tribo_vec3_cross(g->a, g->b, direction);
        tribo_vec3_scale(0.0 - sign_of(tribo_vec3_dot(direction, g->offset)), direction, direction);
    } else if (b_inside) {
        tribo_vec3_add_scaled(from_a, 0.0 - tribo_vec3_dot(from_a, g->b), g->b, direction);
    } else if (a_inside) {
        tribo_vec3_add_scaled(from_b, 0.0 - tribo_vec3_dot(from_b, g->a), g->a, direction);
        tribo_vec3_scale(-1.0, direction, direction);
    } else {
        tribo_vec3_subtract(from_a, from_b, direction);
    }
    if (!(unit(direction, normal) > SEGMENTS_PARALLEL)) {
        double frame[9];
        basis_rows(g->a[0], g->a[1], g->a[2], frame);
        memcpy(normal, frame + 3, 3 * sizeof *normal);
    }
}

static uint32_t end_feature(double at, double half)
{
    return absolute(at) < half ? pair_feature(0, PAIR_EDGE, 0)
                               : pair_feature(0, PAIR_VERTEX, at > 0.0 ? 1 : 0);
}

static void capsule_point(const pair_query *query, const segments *g, const double normal[3],
                          pair_point *point)
{
    const double ra = query->a->size[0];
    const double rb = query->b->size[0];
    point->distance = tribo_vec3_dot(normal, g->apart) - (ra + rb);
    for (int i = 0; i < 3; i++) {
        const double on_a = g->s * g->a[i] - ra * normal[i];
        const double on_b = g->offset[i] + g->t * g->b[i] + rb * normal[i];
        point->middle[i] = 0.5 * (on_a + on_b);
    }
    point->a = end_feature(g->s, g->half[0]);
    point->b = end_feature(g->t, g->half[1]);
}

/* Both ends of the stretch where nearly parallel segments lie side by side, if they do not veer
 * from each other there: then the capsules touch along a line. */
static uint32_t capsule_line(const pair_query *query, const segments *g, double length,
                             const double normal[3], pair_point points[2])
{
    const double middle = tribo_vec3_dot(g->a, g->offset);
    const double reach = absolute(g->cosine) * g->half[1];
    const double radius = lesser(query->a->size[0], query->b->size[0]);
    segments end = *g;
    for (int k = 0; k < 2; k++) {
        double aside[3];
        const double to = k == 0 ? middle - reach : middle + reach;
        const double end_of_b = (k == 0) == (g->cosine > 0.0) ? -g->half[1] : g->half[1];
        end.s = within(to, g->half[0]);
        const double t = end.s * g->cosine - tribo_vec3_dot(g->b, g->offset);
        end.t = end.s == to ? end_of_b : within(t, g->half[1]);
        separate(&end);
        tribo_vec3_add_scaled(end.apart, 0.0 - tribo_vec3_dot(end.apart, normal), normal, aside);
        if (!(extent(aside) <= LINE_OF_CONTACT * lesser(length, radius))) {
            return 0;
        }
        capsule_point(query, &end, normal, &points[k]);
    }
    return 2;
}

static void capsule_capsule(const pair_query *query, tribo_manifold *out)
{
    segments g;
    pair_point points[2];
    double normal[3];
    column(query->ra, 2, g.a);
    column(query->rb, 2, g.b);
    memcpy(g.offset, query->offset, sizeof g.offset);
    g.half[0] = query->a->size[1];
    g.half[1] = query->b->size[1];
    nearest_points(&g);
    const double size = extent(g.offset) + g.half[0] + g.half[1];
    double length = unit(g.apart, normal);
    const int touching = !(length > SEGMENTS_TOUCH * size);
    if (touching) {
        touching_normal(&g, normal);
        length = query->a->size[0] + query->b->size[0];
    }
    uint32_t count = absolute(g.cosine) > 0.5 ? capsule_line(query, &g, length, normal, points) : 0;
    if (count == 0) {
        capsule_point(query, &g, normal, &points[0]);
        count = 1;
    }
    clip_finish(query, normal, g.half[0] + g.half[1], count, points, out);
}

/* ---- sphere and box ------------------------------------------------------------------------- */

/* Inside: through the nearest face. The centre is (x, y, z) in the axes of the box. */
static double leave_box(const double half[3], const double center[3], double normal[3])
{
    int axis = 0;
    for (int i = 1; i < 3; i++) {
        if (half[i] - absolute(center[i]) < half[axis] - absolute(center[axis])) {
            axis = i;
        }
    }
    normal[0] = normal[1] = normal[2] = 0.0;
    normal[axis] = sign_of(center[axis]);
    return absolute(center[axis]) - half[axis];
}

static void sphere_box(const pair_query *query, tribo_manifold *out)
{
    static const double center[3] = {0.0, 0.0, 0.0};
    const double *half = query->b->size;
    double local[3];
    double apart[3];
    double normal[3];
    uint32_t place = 0;
    tribo_mat3_apply_transposed(query->rb, query->offset, local);
    for (int i = 0; i < 3; i++) {
        local[i] = 0.0 - local[i];
        apart[i] = local[i] - within(local[i], half[i]);
        place = 3 * place + (apart[i] > 0.0 ? 2 : apart[i] < 0.0 ? 0 : 1);
    }
    double length = unit(apart, normal);
    if (!(length > 0.0)) {
        length = leave_box(half, local, normal);
        place = (uint32_t)(13.0 + 9.0 * normal[0] + 3.0 * normal[1] + normal[2]);
    }
    tribo_mat3_apply(query->rb, normal, normal);
    balls(query, center, query->a->size[0], 0.0, length, normal, pair_feature(0, PAIR_CURVED, 0),
          pair_feature(0, PAIR_CURVED, place), out);
}

/* ---- half-space ----------------------------------------------------------------------------- */

typedef struct plane {
    double normal[3];
    double level; /* n . x on the plane; origin at A */
} plane;

TRIBO_ALWAYS_INLINE void take_plane(const pair_query *query, plane *out)
{
    const double *size = query->b->size;
    tribo_mat3_apply(query->rb, size, out->normal);
    if (!box_is_unit(out->normal)) {
        (void)unit(out->normal, out->normal);
    }
    out->level = tribo_vec3_dot(out->normal, query->offset) + size[3];
}

/* A point of A's surface against the plane. */
static void above_plane(const plane *p, const double at[3], uint32_t feature, pair_point *point)
{
    point->distance = tribo_vec3_dot(p->normal, at) - p->level;
    tribo_vec3_add_scaled(at, -0.5 * point->distance, p->normal, point->middle);
    point->a = feature;
    point->b = pair_feature(0, PAIR_FACE, 0);
}

static void sphere_plane(const pair_query *query, const plane *p, tribo_manifold *out)
{
    pair_point point;
    double at[3];
    tribo_vec3_scale(0.0 - query->a->size[0], p->normal, at);
    above_plane(p, at, pair_feature(0, PAIR_CURVED, 0), &point);
    clip_finish(query, p->normal, 0.0, 1, &point, out);
}

static void capsule_plane(const pair_query *query, const plane *p, tribo_manifold *out)
{
    pair_point points[2];
    double axis[3];
    column(query->ra, 2, axis);
    for (uint32_t k = 0; k < 2; k++) {
        const double along = k == 0 ? -query->a->size[1] : query->a->size[1];
        double at[3];
        for (int i = 0; i < 3; i++) {
            at[i] = along * axis[i] - query->a->size[0] * p->normal[i];
        }
        above_plane(p, at, pair_feature(0, PAIR_VERTEX, k), &points[k]);
    }
    clip_finish(query, p->normal, 0.0, 2, points, out);
}

/* Half-edges of a box, world axes. */
static void box_edges(const double r[9], const double half[3], double edges[3][3])
{
    for (int i = 0; i < 3; i++) {
        edges[i][0] = r[i] * half[i];
        edges[i][1] = r[3 + i] * half[i];
        edges[i][2] = r[6 + i] * half[i];
    }
}

/* Corners of face (axis, sign), counter-clockwise seen from outside, from the centre. */
TRIBO_ALWAYS_INLINE void box_corners(const double r[9], const double half[3], int axis, double sign,
                                     double *restrict corners)
{
    const int next = next_axis[axis];
    const int last = last_axis[axis];
    const double out = sign * half[axis];
    const double u = sign * half[next];
    const double v = half[last];
    for (int k = 0; k < 3; k++) {
        const double *row = r + 3 * k;
        const double outward = row[axis] * out;
        const double along = row[next] * u;
        const double across = row[last] * v;
        const double right = outward + along;
        const double left = outward - along;
        corners[k] = right + across;
        corners[3 + k] = left + across;
        corners[6 + k] = left - across;
        corners[9 + k] = right - across;
    }
}

/* Fewer points than all that are near enough. */
static void choose_corners(const pair_query *query, const double normal[3], uint32_t count,
                           const tribo_point *corners, tribo_manifold *out)
{
    pair_point points[4];
    if (count == 0) {
        clip_nothing(out);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        memcpy(points[i].middle, corners[i].arm_a, sizeof points[i].middle);
        points[i].distance = corners[i].distance;
        points[i].a = (uint32_t)(corners[i].id >> 32);
        points[i].b = (uint32_t)corners[i].id;
    }
    clip_finish(query, normal, 0.0, count, points, out);
}

/* The way of pairs that are turned, not of usual size, or to have fewer points. */
static tribo_status box_plane(const pair_query *query, const plane *p, tribo_manifold *out)
{
    const double lengths =
        extent(query->a->size) + (absolute(query->b->size[3]) + extent(query->offset));
    const box_ground ground = {query->ra, query->a->size, query->offset,
                               p->normal, p->level,       box_limit(query->margin, lengths)};
    if (query->max_points < 4) {
        tribo_point all[4];
        const uint32_t count = box_on_ground(0, &ground, all);
        choose_corners(query, p->normal, count, all, out);
        return clip_check(out);
    }
    const uint32_t count = query->turned ? box_on_ground(1, &ground, out->points)
                                         : box_on_ground(0, &ground, out->points);
    if (count == 0) {
        clip_nothing(out);
    } else {
        pair_write_head(query->turned, p->normal, count, out);
    }
    return query->safe ? TRIBO_OK : clip_check(out);
}

/* Any convex shape: the corners of its lowest face, and its lowest point if that is none of
 * them. */
TRIBO_NEVER_INLINE tribo_status convex_plane(const pair_query *query, const plane *p,
                                             tribo_manifold *out)
{
    pair_face face;
    pair_point points[PAIR_MAX_POINTS];
    pair_point lowest;
    double down[3];
    double local[3];
    double at[3];
    tribo_vec3_scale(-1.0, p->normal, down);
    tribo_mat3_apply_transposed(query->ra, down, local);
    if (!shape_support(query->a, local, at) || !clip_take_face(query, 0, down, &face)) {
        return TRIBO_ERROR_SUPPORT;
    }
    tribo_mat3_apply(query->ra, at, at);
    above_plane(p, at, pair_feature(face.feature, PAIR_CURVED, 0), &lowest);
    double least = (double)INFINITY;
    double size = 0.0;
    for (uint32_t i = 0; i < face.count; i++) {
        double apart[3];
        const uint32_t kind = face.count == 1 ? PAIR_CURVED : PAIR_VERTEX;
        above_plane(p, face.points + 3 * i, pair_feature(face.feature, kind, i), &points[i]);
        tribo_vec3_subtract(face.points + 3 * i, face.points, apart);
        least = lesser(least, points[i].distance);
        size = greater(size, tribo_vec3_norm(apart));
    }
    const double slack = PAIR_ROUNDING * (extent(at) + absolute(p->level) + size);
    uint32_t count = face.count;
    if (lowest.distance < least - slack) {
        points[count++] = lowest;
    }
    clip_finish(query, p->normal, size, count, points, out);
    return clip_check(out);
}

static tribo_status half_space(const pair_query *query, tribo_manifold *out)
{
    plane p;
    take_plane(query, &p);
    switch (query->a->type) {
    case TRIBO_SHAPE_BOX:
        return box_plane(query, &p, out);
    case TRIBO_SHAPE_SPHERE:
        sphere_plane(query, &p, out);
        return clip_check(out);
    case TRIBO_SHAPE_CAPSULE:
        capsule_plane(query, &p, out);
        return clip_check(out);
    default:
        return convex_plane(query, &p, out);
    }
}

/* ---- box and box: separating axes (Gottschalk, Lin, Manocha 1996) --------------------------- */

#define EDGES_PARALLEL 1e-28 /* square of the sine of the angle below which it is noise */
#define NEARLY_FLAT \
    0.9995 /* cosine of a face with the normal, up to which an edge axis gives an area */

typedef struct boxes {
    const pair_query *query;
    double r[3][3]; /* r[i][j]: axis i of A times axis j of B */
    double abs_r[3][3];
    double ta[3]; /* offset along the axes of A */
    double tb[3]; /* and of B */
    const double *half_a;
    const double *half_b;
    double rounding; /* of a distance */
} boxes;

/* Best axis so far: 0 to 2 faces of A, 3 to 5 faces of B, 6 + 3 i + j edge i of A with edge j of
 * B. */
typedef struct best_axis {
    int which;
    double distance;
    double sine2; /* edges: square of the length of their cross product */
    double side;  /* edges: sign of the offset along it */
} best_axis;

static void take_boxes(const pair_query *query, boxes *x)
{
    x->query = query;
    x->half_a = query->a->size;
    x->half_b = query->b->size;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            x->r[i][j] = query->ra[i] * query->rb[j] + query->ra[3 + i] * query->rb[3 + j] +
                         query->ra[6 + i] * query->rb[6 + j];
            x->abs_r[i][j] = absolute(x->r[i][j]);
        }
    }
    tribo_mat3_apply_transposed(query->ra, query->offset, x->ta);
    tribo_mat3_apply_transposed(query->rb, query->offset, x->tb);
    x->rounding = PAIR_ROUNDING * (extent(query->offset) + extent(x->half_a) + extent(x->half_b));
}

/* The first face whose distance is the greatest, but for rounding. No branch depends on the pose:
 * nobody knows which it is. */
static void try_faces(const boxes *x, best_axis *best)
{
    const double *ha = x->half_a;
    const double *hb = x->half_b;
    double distances[6];
    double most = -(double)INFINITY;
    for (int i = 0; i < 3; i++) {
        const double *s = x->abs_r[i];
        const double reach = ha[i] + (hb[0] * s[0] + hb[1] * s[1] + hb[2] * s[2]);
        distances[i] = absolute(x->ta[i]) - reach;
        most = greater(distances[i], most);
    }
    for (int j = 0; j < 3; j++) {
        const double reach =
            hb[j] + (ha[0] * x->abs_r[0][j] + ha[1] * x->abs_r[1][j] + ha[2] * x->abs_r[2][j]);
        distances[3 + j] = absolute(x->tb[j]) - reach;
        most = greater(distances[3 + j], most);
    }
    int which = 5;
    for (int k = 4; k >= 0; k--) {
        which = distances[k] >= most - x->rounding ? k : which;
    }
    best->which = which;
    best->distance = distances[which];
}

/* Along the cross product c of edge i of A and edge j of B: in the axes of A it has the components
 * -r[i2][j] and r[i1][j] along the two axes i1 and i2 that follow i. */
TRIBO_ALWAYS_INLINE double along_edges(const boxes *x, int i1, int i2, int j)
{
    return x->ta[i2] * x->r[i1][j] - x->ta[i1] * x->r[i2][j];
}

/* x with its sign, squared. */
TRIBO_ALWAYS_INLINE double signed_square(double x)
{
    return x * absolute(x);
}

/* Whether the distance along c, but for rounding of c, is above a limit that is given as its signed
 * square: no root is needed to compare. i and j are constants. */
TRIBO_ALWAYS_INLINE uint32_t may_exceed(const boxes *x, int i, int j, double limit)
{
    const int i1 = i == 2 ? 0 : i + 1;
    const int i2 = i == 0 ? 2 : i - 1;
    const int j1 = j == 2 ? 0 : j + 1;
    const int j2 = j == 0 ? 2 : j - 1;
    const double c1 = x->r[i2][j];
    const double c2 = x->r[i1][j];
    const double reach_a = x->half_a[i1] * absolute(c1) + x->half_a[i2] * absolute(c2);
    const double reach_b = x->half_b[j1] * x->abs_r[i][j2] + x->half_b[j2] * x->abs_r[i][j1];
    const double most = absolute(along_edges(x, i1, i2, j)) - (reach_a + reach_b) + x->rounding;
    const double sine2 = c1 * c1 + c2 * c2;
    const uint32_t exceeds = signed_square(most) > limit * sine2 ? 1 : 0;
    const uint32_t crosses = sine2 > EDGES_PARALLEL ? 1 : 0;
    return (exceeds & crosses) << (3 * i + j);
}

/* The pairs of edges that may be better than a face, a bit for each. */
static uint32_t edges_to_try(const boxes *x, double distance)
{
    const double limit = signed_square(distance + x->rounding);
    return may_exceed(x, 0, 0, limit) | may_exceed(x, 0, 1, limit) | may_exceed(x, 0, 2, limit) |
           may_exceed(x, 1, 0, limit) | may_exceed(x, 1, 1, limit) | may_exceed(x, 1, 2, limit) |
           may_exceed(x, 2, 0, limit) | may_exceed(x, 2, 1, limit) | may_exceed(x, 2, 2, limit);
}

/* All widths are those of c as it is, with its rounding, so that edges that are nearly parallel do
 * no harm: the direction has noise, its distance has none. Comparison by squares: the root is for
 * the winner. Returns 0 if the boxes are apart by more than the margin. */
static int try_edge(const boxes *x, int i, int j, best_axis *best)
{
    const int i1 = next_axis[i];
    const int i2 = last_axis[i];
    const int j1 = next_axis[j];
    const int j2 = last_axis[j];
    const double c1 = x->r[i2][j];
    const double c2 = x->r[i1][j];
    const double along = along_edges(x, i1, i2, j);
    const double reach_a = x->half_a[i1] * x->abs_r[i2][j] + x->half_a[i2] * x->abs_r[i1][j];
    const double reach_b = x->half_b[j1] * absolute(c2 * x->r[i2][j1] - c1 * x->r[i1][j1]) +
                           x->half_b[j2] * absolute(c2 * x->r[i2][j2] - c1 * x->r[i1][j2]);
    const double distance = absolute(along) - (reach_a + reach_b);
    const double limit = best->distance + x->rounding;
    const double sine2 = c1 * c1 + c2 * c2;
    if (!(signed_square(distance) > signed_square(limit) * sine2)) {
        return 1;
    }
    const double scaled = distance / sqrt(sine2);
    best->which = 6 + 3 * i + j;
    best->distance = scaled;
    best->sine2 = sine2;
    best->side = sign_of(along);
    return scaled <= x->query->margin + x->rounding;
}

/* Edges must beat the best face clearly. Returns 0 as soon as the boxes are apart by more than the
 * margin. */
static int try_edges(const boxes *x, best_axis *best)
{
    int within = 1;
    uint32_t left = edges_to_try(x, best->distance);
    for (int k = 0; left != 0 && within; k++, left >>= 1) {
        within = !(left & 1u) || try_edge(x, k / 3, k % 3, best);
    }
    return within;
}

static void box_face(const pair_query *query, int side, int axis, double sign, pair_face *face)
{
    const double *r = side == 0 ? query->ra : query->rb;
    const double *half = side == 0 ? query->a->size : query->b->size;
    box_corners(r, half, axis, sign, face->points);
    face->count = 4;
    face->feature = box_face_number(axis, sign);
    column(r, axis, face->normal);
    tribo_vec3_scale(sign, face->normal, face->normal);
    for (int c = 0; c < 4 && side != 0; c++) {
        tribo_vec3_add(face->points + 3 * c, query->offset, face->points + 3 * c);
    }
}

/* The face of a box that looks along a direction most. */
static void box_face_along(const pair_query *query, int side, const double direction[3],
                           pair_face *face)
{
    double local[3];
    tribo_mat3_apply_transposed(side == 0 ? query->ra : query->rb, direction, local);
    const int axis = greatest_of(local);
    box_face(query, side, axis, sign_of(local[axis]), face);
}

static double face_size(const double half[3], uint32_t feature)
{
    const uint32_t axis = feature / 2;
    return greater(half[next_axis[axis]], half[last_axis[axis]]);
}

/* One of the twelve edges: its middle from the centre, its direction and half-length. */
static void box_edge(const boxes *x, int side, uint32_t number, double at[3], double axis[3],
                     double *half)
{
    const double *r = side == 0 ? x->query->ra : x->query->rb;
    const double *size = side == 0 ? x->half_a : x->half_b;
    const int i = (int)(number / 4);
    double edges[3][3];
    box_edges(r, size, edges);
    const double *first = edges[i == 0 ? 1 : 0];
    const double *second = edges[i == 2 ? 1 : 2];
    for (int k = 0; k < 3; k++) {
        at[k] = (number & 2 ? first[k] : -first[k]) + (number & 1 ? second[k] : -second[k]);
    }
    column(r, i, axis);
    *half = size[i];
}

/* Direction of the way from B to A at their nearest features, and the distance of the boxes along
 * it. Ways that are hardly longer than rounding still have a direction where what is rounding alone
 * is left out: what is square to edges stays so, or far ends would show the boxes less far apart. */
static double way_between(const boxes *x, const double apart[3], double normal[3])
{
    double distance;
    double rounding;
    double way[3] = {apart[0], apart[1], apart[2]};
    for (int k = 0; k < 6; k++) {
        double axis[3];
        column(k < 3 ? x->query->ra : x->query->rb, k % 3, axis);
        const double along = tribo_vec3_dot(way, axis);
        if (absolute(along) <= x->rounding) {
            tribo_vec3_add_scaled(way, 0.0 - along, axis, way);
        }
    }
    return unit(way, normal) > 0.0 && clip_distance(x->query, normal, &distance, &rounding)
               ? distance
               : -(double)INFINITY;
}

/* Corner or edge against corner or edge, apart from each other: no face lies over the other there.
 * Which features are nearest is found by looking at all edges. */
static void nearest_edges(const boxes *x, const pair_axis *axis, tribo_manifold *out)
{
    const pair_query *query = x->query;
    segments best = {{0}, {0}, {0}, {0}, 0, 0, 0, {0}};
    double least = (double)INFINITY;
    double middle[3] = {0.0, 0.0, 0.0};
    uint32_t numbers = 0;
    for (uint32_t pair = 0; pair < 144; pair++) {
        double on_a[3];
        double on_b[3];
        segments g;
        box_edge(x, 0, pair / 12, on_a, g.a, &g.half[0]);
        box_edge(x, 1, pair % 12, on_b, g.b, &g.half[1]);
        for (int k = 0; k < 3; k++) {
            g.offset[k] = (query->offset[k] + on_b[k]) - on_a[k];
        }
        nearest_points(&g);
        const double square = tribo_vec3_dot(g.apart, g.apart);
        if (square < least * (1.0 - 1e-12)) {
            least = square;
            best = g;
            numbers = pair;
            for (int k = 0; k < 3; k++) {
                middle[k] = on_a[k] + (g.s * g.a[k] - 0.5 * g.apart[k]);
            }
        }
    }
    double normal[3];
    double distance = way_between(x, best.apart, normal);
    if (!(distance >= axis->distance - x->rounding)) {
        memcpy(normal, axis->normal, sizeof normal);
        distance = axis->distance;
    }
    single(query, normal, middle, distance, pair_feature(6, PAIR_EDGE, numbers / 12),
           pair_feature(6, PAIR_EDGE, numbers % 12), out);
}

/* Edge i of the box that is extreme along a direction: its middle, and its number among all
 * twelve. */
static uint32_t extreme_edge(const double r[9], const double half[3], int i,
                             const double direction[3], double middle[3])
{
    const int others[2] = {i == 0 ? 1 : 0, i == 2 ? 1 : 2};
    uint32_t number = (uint32_t)i;
    middle[0] = middle[1] = middle[2] = 0.0;
    for (int c = 0; c < 2; c++) {
        double axis[3];
        column(r, others[c], axis);
        const double sign = sign_of(tribo_vec3_dot(axis, direction));
        tribo_vec3_add_scaled(middle, sign * half[others[c]], axis, middle);
        number = 2 * number + (sign > 0.0 ? 1 : 0);
    }
    return number;
}

/* Where the extreme edges i of A and j of B cross. */
static void touch_edges(const boxes *x, int i, int j, const pair_axis *axis, tribo_manifold *out)
{
    const pair_query *query = x->query;
    const double back[3] = {0.0 - axis->normal[0], 0.0 - axis->normal[1], 0.0 - axis->normal[2]};
    double on_a[3];
    double on_b[3];
    double middle[3];
    segments g;
    const uint32_t edge_a = extreme_edge(query->ra, x->half_a, i, back, on_a);
    const uint32_t edge_b = extreme_edge(query->rb, x->half_b, j, axis->normal, on_b);
    column(query->ra, i, g.a);
    column(query->rb, j, g.b);
    g.half[0] = x->half_a[i];
    g.half[1] = x->half_b[j];
    for (int k = 0; k < 3; k++) {
        g.offset[k] = (query->offset[k] + on_b[k]) - on_a[k];
    }
    nearest_points(&g);
    double aside[3];
    tribo_vec3_add_scaled(g.apart, 0.0 - tribo_vec3_dot(g.apart, axis->normal), axis->normal,
                          aside);
    if (axis->distance > x->rounding && extent(aside) > 4.0 * x->rounding) {
        nearest_edges(x, axis, out);
        return;
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = on_a[k] + (g.s * g.a[k] - 0.5 * g.apart[k]);
    }
    single(query, axis->normal, middle, axis->distance, pair_feature(6, PAIR_EDGE, edge_a),
           pair_feature(6, PAIR_EDGE, edge_b), out);
}

/* Points of two faces; boxes that are apart may have none that lie over each other, or not the
 * nearest. */
static void finish_faces(const boxes *x, const pair_axis *axis, double size, uint32_t count,
                         pair_point *points, tribo_manifold *out)
{
    double least = (double)INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        least = lesser(least, points[i].distance);
    }
    if (count == 0 ||
        (axis->distance > x->rounding && least > axis->distance + 4.0 * x->rounding)) {
        nearest_edges(x, axis, out);
    } else {
        clip_finish(x->query, axis->normal, size, count, points, out);
    }
}

static void touch_faces(const boxes *x, const pair_face faces[2], int reference,
                        const pair_axis *axis, tribo_manifold *out)
{
    pair_point points[PAIR_MAX_POINTS];
    const uint32_t count = clip_faces(x->query, faces, reference, axis, points);
    const double size =
        lesser(face_size(x->half_a, faces[0].feature), face_size(x->half_b, faces[1].feature));
    finish_faces(x, axis, size, count, points, out);
}

/* Face `axis` of A (side 0) or B, which looks at the other box, and the face of that which looks at
 * it most. */
static void take_rectangles(const boxes *x, int side, int axis, pair_rectangles *f)
{
    const double *r = &x->r[0][0];
    const int row = 3 - 2 * side;
    const int step = 1 + 2 * side;
    const double *half = side == 0 ? x->half_a : x->half_b;
    const double *other = side == 0 ? x->half_b : x->half_a;
    const double *own = side == 0 ? x->query->ra : x->query->rb;
    const double turn = 1.0 - 2.0 * (double)side; /* offset from the box of the face to the other */
    const double *t = side == 0 ? x->ta : x->tb;
    const int next = next_axis[axis];
    const int last = last_axis[axis];
    /* where the middles are level, A is on the positive side of B, and its own face the negative */
    const double sign = (0.0 - turn) * copysign(1.0, 0.0 - t[axis]);
    const int rows[3] = {axis, next, last};
    const double signs[3] = {sign, sign, 1.0};
    const double facing[3] = {r[row * axis], r[row * axis + step], r[row * axis + 2 * step]};
    const int m = greatest_of(facing);
    const double back = copysign(1.0, 0.0 - facing[m] * sign);
    const int m1 = next_axis[m];
    const int m2 = last_axis[m];
    double *const to[3] = {f->other.h, f->other.u, f->other.v};
    for (int k = 0; k < 3; k++) {
        const double *from = r + row * rows[k];
        const double center = signs[k] * (turn * t[rows[k]] + back * other[m] * from[step * m]);
        const double e1 = signs[k] * (back * other[m1] * from[step * m1]);
        const double e2 = signs[k] * (other[m2] * from[step * m2]);
        to[k][0] = (center + e1) + e2;
        to[k][1] = (center - e1) + e2;
        to[k][2] = (center - e1) - e2;
        to[k][3] = (center + e1) - e2;
        f->frame[3 * k] = signs[k] * own[rows[k]];
        f->frame[3 * k + 1] = signs[k] * own[3 + rows[k]];
        f->frame[3 * k + 2] = signs[k] * own[6 + rows[k]];
    }
    f->side = side;
    f->level = half[axis];
    f->half[0] = half[next];
    f->half[1] = half[last];
    f->own = box_face_number(axis, sign);
    f->other.count = 4;
    f->other.feature = box_face_number(m, back);
    f->size = lesser(greater(half[next], half[last]), greater(other[m1], other[m2]));
}

static void by_face(const boxes *x, int side, int axis, double distance, tribo_manifold *out)
{
    pair_rectangles f;
    pair_axis best;
    pair_point points[PAIR_MAX_POINTS];
    take_rectangles(x, side, axis, &f);
    tribo_vec3_scale(2.0 * (double)side - 1.0, f.frame, best.normal);
    best.distance = distance;
    const uint32_t count = clip_rectangles(x->query, &f, points);
    finish_faces(x, &best, f.size, count, points, out);
}

/* The cross product of two edges. Between faces that are nearly flat on each other it tilts the
 * normal a little; then they touch along an area all the same. */
static void by_edges(const boxes *x, const best_axis *best, tribo_manifold *out)
{
    const int i = (best->which - 6) / 3;
    const int j = (best->which - 6) % 3;
    double local[3] = {0.0, 0.0, 0.0};
    pair_axis axis;
    pair_face faces[2];
    const double scale = (0.0 - best->side) / sqrt(best->sine2);
    local[next_axis[i]] = 0.0 - scale * x->r[last_axis[i]][j];
    local[last_axis[i]] = scale * x->r[next_axis[i]][j];
    tribo_mat3_apply(x->query->ra, local, axis.normal);
    axis.distance = best->distance;
    const double back[3] = {0.0 - axis.normal[0], 0.0 - axis.normal[1], 0.0 - axis.normal[2]};
    box_face_along(x->query, 0, back, &faces[0]);
    box_face_along(x->query, 1, axis.normal, &faces[1]);
    const double flat_a = 0.0 - tribo_vec3_dot(faces[0].normal, axis.normal);
    const double flat_b = tribo_vec3_dot(faces[1].normal, axis.normal);
    if (greater(flat_a, flat_b) >= NEARLY_FLAT) {
        touch_faces(x, faces, flat_b > flat_a + 4.0 * TRIBO_EPS ? 1 : 0, &axis, out);
    } else {
        touch_edges(x, i, j, &axis, out);
    }
}

static tribo_status box_box(const pair_query *query, tribo_manifold *out)
{
    boxes x;
    best_axis best = {0, 0.0, 0.0, 0.0};
    take_boxes(query, &x);
    try_faces(&x, &best);
    if (best.distance > query->margin + x.rounding || !try_edges(&x, &best)) {
        clip_nothing(out);
    } else if (best.which < 6) {
        by_face(&x, best.which / 3, best.which % 3, best.distance, out);
    } else {
        by_edges(&x, &best, out);
    }
    return query->safe ? TRIBO_OK : clip_check(out);
}

/* ---- all pairs ------------------------------------------------------------------------------ */

/* Two shapes of which none is a half-space. */
TRIBO_NEVER_INLINE tribo_status two_solids(const pair_query *query, tribo_manifold *out)
{
    const uint32_t type_a = query->a->type;
    const uint32_t type_b = query->b->type;
    if (type_a == TRIBO_SHAPE_BOX) {
        return box_box(query, out);
    }
    if (type_a == TRIBO_SHAPE_CAPSULE) {
        capsule_capsule(query, out);
    } else if (type_b == TRIBO_SHAPE_SPHERE) {
        sphere_sphere(query, out);
    } else if (type_b == TRIBO_SHAPE_CAPSULE) {
        sphere_capsule(query, out);
    } else {
        sphere_box(query, out);
    }
    return clip_check(out);
}

tribo_status closed_manifold(const pair_query *query, tribo_manifold *out)
{
    return query->b->type == TRIBO_SHAPE_HALFSPACE ? half_space(query, out)
                                                   : two_solids(query, out);
}
