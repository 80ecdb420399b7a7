/* Contact points of two convex shapes by clipping the faces that look at each other.
 *
 * Everything is seen along the normal n, in coordinates (h, u, v) of the contact frame (n, t1, t2):
 * the faces become polygons in the plane, the points are the corners of their overlap, and the
 * distance at a point is the difference of the heights h of the two faces above it. */
#include "hull.h"
#include "pair.h"
#include "rows.h"

#include <tribo/math.h>

#define ALIGNED \
    0.9995 /* cosine: up to here faces tilted against the normal still lie on each other */
#define SNAP_ANGLE 0.9  /* cosine: faces that are worth a look for a better normal */
#define SNAP_WIDTH 1e-9 /* of the distance: by so much a face's normal may be worse than the axis */
#define CLIP_ROUNDING 1e-12 /* of the lengths: on the line is inside */
#define PARALLEL 1e-3       /* sine of the angle up to which two edges are one line of contact */
#define ASIDE 1e-5          /* of the size: so far apart sideways two such edges still touch */
#define MERGE 1e-9          /* of the size: points that are one */
#define NEAR 1e-4           /* of the shortest side: a corner is at a vertex or on an edge */
#define BETTER 1.00001      /* ratio of areas, or of squares, that is worth another choice */
#define ABOVE 1e-6          /* of the lengths: corners so far beyond the margin are none */
#define TILT 1e-5           /* radians by which supports are tilted to feel along a face, */
#define TILT_GROWTH 8.0     /* and by so much more, up to the next, where that brings little: */
#define MOST_TILT 5e-3      /* of round shapes the axis is known less well than the depth */
#define LEVEL 1e-5          /* of the size: points are as deep as the deepest */
#define RIDGE 1e-6 /* of the size: up to so much above the deepest point two ridges still touch */

enum { SAMPLES = 12 };
enum { SEARCHED = 12 }; /* corners of which the best are sought among all choices */

/* ---- faces ---------------------------------------------------------------------------------- */

/* What is known of a small hull's vertices; null: nothing. */
static const pair_arms *arms_of(const pair_query *query, int side)
{
    return query->arms != NULL && query->arms[side].count > 0 ? &query->arms[side] : NULL;
}

int clip_take_face(const pair_query *query, int side, const double direction[3], pair_face *face)
{
    const double *r = side == 0 ? query->ra : query->rb;
    const tribo_shape *shape = side == 0 ? query->a : query->b;
    const pair_arms *arms = arms_of(query, side);
    double local[3];
    tribo_mat3_apply_transposed(r, direction, local);
    face->count = arms != NULL
                      ? shape_face_at(shape, convex_farthest(arms, direction), local, face->points,
                                      face->normal, &face->feature)
                      : shape_face(shape, local, face->points, face->normal, &face->feature);
    tribo_mat3_apply(r, face->normal, face->normal);
    for (uint32_t i = 0; i < face->count; i++) {
        double *p = face->points + 3 * i;
        tribo_mat3_apply(r, p, p);
        if (side != 0) {
            tribo_vec3_add(p, query->offset, p);
        }
    }
    return face->count > 0;
}

/* Support point of A (side 0) or B along a direction, world axes, origin at A. */
static int take_support(const pair_query *query, int side, const double direction[3],
                        double point[3])
{
    const double *r = side == 0 ? query->ra : query->rb;
    const tribo_shape *shape = side == 0 ? query->a : query->b;
    const pair_arms *arms = arms_of(query, side);
    if (arms != NULL) {
        const double *vertices = hull_vertices(shape->data);
        tribo_mat3_apply(r, vertices + 3 * (size_t)convex_farthest(arms, direction), point);
    } else {
        double local[3];
        tribo_mat3_apply_transposed(r, direction, local);
        if (!shape_support(shape, local, point)) {
            return 0;
        }
        tribo_mat3_apply(r, point, point);
    }
    if (side != 0) {
        tribo_vec3_add(point, query->offset, point);
    }
    return 1;
}

int clip_distance(const pair_query *query, const double n[3], double *distance, double *rounding)
{
    const double back[3] = {0.0 - n[0], 0.0 - n[1], 0.0 - n[2]};
    double a[3];
    double b[3];
    if (!take_support(query, 0, back, a) || !take_support(query, 1, n, b)) {
        return 0;
    }
    *distance = tribo_vec3_dot(a, n) - tribo_vec3_dot(b, n);
    *rounding = PAIR_ROUNDING * (extent(a) + extent(b) + extent(query->offset));
    return 1;
}

/* ---- polygons along the normal -------------------------------------------------------------- */

typedef pair_polygon polygon;

static void flatten(const pair_face *face, const double frame[9], polygon *out)
{
    double size = 0.0;
    double shortest = (double)INFINITY;
    double u = tribo_vec3_dot(frame + 3, face->points);
    double v = tribo_vec3_dot(frame + 6, face->points);
    const double first_u = u;
    const double first_v = v;
    out->count = face->count;
    out->feature = face->feature;
    out->h[0] = tribo_vec3_dot(frame, face->points);
    out->u[0] = u;
    out->v[0] = v;
    for (uint32_t i = 1; i < face->count; i++) {
        const double *p = face->points + 3 * i;
        const double last_u = u;
        const double last_v = v;
        u = tribo_vec3_dot(frame + 3, p);
        v = tribo_vec3_dot(frame + 6, p);
        out->h[i] = tribo_vec3_dot(frame, p);
        out->u[i] = u;
        out->v[i] = v;
        size = greater(size, absolute(u - first_u));
        size = greater(size, absolute(v - first_v));
        shortest = lesser(shortest, absolute(u - last_u) + absolute(v - last_v));
    }
    out->size = size;
    out->shortest = lesser(shortest, absolute(first_u - u) + absolute(first_v - v));
}

/* Of the polygon whose heights between the corners are asked for. */
static void take_slope(const pair_face *face, const double frame[9], polygon *out)
{
    const double along = tribo_vec3_dot(frame, face->normal);
    out->slope[0] = along == 0.0 ? 0.0 : 0.0 - tribo_vec3_dot(frame + 3, face->normal) / along;
    out->slope[1] = along == 0.0 ? 0.0 : 0.0 - tribo_vec3_dot(frame + 6, face->normal) / along;
}

static double height_at(const polygon *p, double u, double v)
{
    return p->h[0] + (p->slope[0] * (u - p->u[0]) + p->slope[1] * (v - p->v[0]));
}

/* +1 if the corners go round counter-clockwise in (u, v): so B's do, whose face looks along n. */
static double winding_of(int side)
{
    return side == 0 ? -1.0 : 1.0;
}

/* Line through side j of a polygon. Its value is the distance from it times `length`, positive
 * inside. */
typedef struct line {
    double u, v, c;
    double length; /* of the side, or up to 1.5 times that: it saves a root */
} line;

static line side_line(const polygon *p, uint32_t j, double winding)
{
    const uint32_t k = j + 1 == p->count ? 0 : j + 1;
    const double du = winding * (p->u[k] - p->u[j]);
    const double dv = winding * (p->v[k] - p->v[j]);
    const line l = {0.0 - dv, du, dv * p->u[j] - du * p->v[j], absolute(du) + absolute(dv)};
    return l;
}

static double line_value(const line *l, double u, double v)
{
    return l->u * u + l->v * v + l->c;
}

/* ---- names of corners ----------------------------------------------------------------------- */

/* Where vertices and edges of both polygons lie on each other, as in stacks of equal boxes, noise
 * decides which of them the overlap has for corners. So a corner is named by all it is near to,
 * whether it is a vertex of one, of the other, or where two sides cross; corners of one name are
 * one. */

static int is_at(const polygon *p, uint32_t vertex, double reach, double u, double v)
{
    const double du = u - p->u[vertex];
    const double dv = v - p->v[vertex];
    return du * du + dv * dv <= reach * reach;
}

/* A point on side k. */
static uint32_t name_on_side(const polygon *p, uint32_t k, double reach, double u, double v)
{
    const uint32_t next = k + 1 == p->count ? 0 : k + 1;
    return is_at(p, k, reach, u, v)      ? pair_feature(0, PAIR_VERTEX, k)
           : is_at(p, next, reach, u, v) ? pair_feature(0, PAIR_VERTEX, next)
                                         : pair_feature(0, PAIR_EDGE, k);
}

/* A point inside. */
static uint32_t name_inside(const polygon *p, double reach, double u, double v)
{
    for (uint32_t k = 0; k < p->count; k++) {
        const line l = side_line(p, k, 1.0);
        if (absolute(line_value(&l, u, v)) <= reach * l.length) {
            return name_on_side(p, k, reach, u, v);
        }
    }
    return pair_feature(0, PAIR_FACE, 0);
}

/* ---- clipping (Sutherland and Hodgman, CACM 17 (1974) 32) ----------------------------------- */

enum {
    LEVEL_SIDE = 32, /* in place of a side of the clipping polygon: a height */
    OWN_SIDE = 64    /* sides of the clipping polygon are numbered from here */
};

/* Corners of what is left of a polygon: one array for each number, because numbers that were stored
 * one by one can not be copied in wider pieces without a stall. */
typedef struct outline {
    uint32_t count;
    uint32_t side[PAIR_MAX_POINTS];   /* that leaves here */
    uint32_t origin[PAIR_MAX_POINTS]; /* a vertex, or two sides that cross: origin_of */
    double u[PAIR_MAX_POINTS];
    double v[PAIR_MAX_POINTS];
    double h[PAIR_MAX_POINTS];
} outline;

/* One polygon clipped by another. */
typedef struct clipping {
    const polygon *inner;
    const polygon *outer;
    double winding; /* of the outer one */
    double slack;   /* outside by so much is inside */
    double reach;   /* corners so near to a feature are named by it */
    int near;       /* some corner is so near to an edge of the outer one */
} clipping;

enum { NO_SIDE = 255 };

/* Where a corner comes from: its name is made of that once it is known to stay. */
static uint32_t origin_of(uint32_t side, uint32_t cut)
{
    return side << 8 | cut;
}

TRIBO_ALWAYS_INLINE void take_vertex(const polygon *p, uint32_t i, outline *out)
{
    out->side[i] = i;
    out->origin[i] = origin_of(i, NO_SIDE);
    out->u[i] = p->u[i];
    out->v[i] = p->v[i];
    out->h[i] = p->h[i];
}

static void take_outline(const polygon *p, outline *out)
{
    out->count = p->count;
    for (uint32_t i = 0; i < p->count; i++) {
        take_vertex(p, i, out);
    }
}

/* The same of four corners, without a loop, which compilers would turn into wider copies. */
static void take_quadrilateral(const polygon *p, outline *out)
{
    out->count = 4;
    take_vertex(p, 0, out);
    take_vertex(p, 1, out);
    take_vertex(p, 2, out);
    take_vertex(p, 3, out);
}

/* The features of a corner on the clipped polygon and on the one that clips, without the face. */
static void name_corner(const clipping *c, const outline *x, uint32_t i, uint32_t *inner,
                        uint32_t *outer)
{
    const uint32_t side = x->origin[i] >> 8;
    const uint32_t cut = x->origin[i] & 255u;
    const double u = x->u[i];
    const double v = x->v[i];
    if (cut == NO_SIDE) {
        *inner = pair_feature(0, PAIR_VERTEX, side);
        *outer = c->near ? name_inside(c->outer, c->reach, u, v) : pair_feature(0, PAIR_FACE, 0);
    } else if (side < OWN_SIDE) {
        *inner = name_on_side(c->inner, side, c->reach, u, v);
        *outer = name_on_side(c->outer, cut, c->reach, u, v);
    } else {
        const uint32_t next = cut + 1 == c->outer->count ? 0 : cut + 1;
        *inner = name_inside(c->inner, c->reach, u, v);
        *outer = pair_feature(0, PAIR_VERTEX, next == side - OWN_SIDE ? next : cut);
    }
}

/* Where the side that leaves corner i for k crosses side j of the clipping polygon; d are the values
 * of its line. */
static void take_crossing(const outline *in, uint32_t i, uint32_t k, const double *d, uint32_t j,
                          outline *out, uint32_t m)
{
    const double f = d[i] / (d[i] - d[k]);
    out->u[m] = in->u[i] + f * (in->u[k] - in->u[i]);
    out->v[m] = in->v[i] + f * (in->v[k] - in->v[i]);
    out->h[m] = in->h[i] + f * (in->h[k] - in->h[i]);
    out->side[m] = in->side[i];
    out->origin[m] = origin_of(in->side[i], j);
}

/* Keep what lies inside of side j; d are the values of its line at the corners, and room for the
 * first again. Nobody knows where it crosses, so no branch depends on that: every corner is copied, and the next one over it if it
 * does not stay. Crossings get their places in between. */
static void clip_by_line(const outline *in, double d[PAIR_MAX_POINTS + 1], double room, uint32_t j,
                         outline *out)
{
    const uint32_t n = in->count;
    uint32_t m = 0;
    uint32_t last[2] = {0, 0}; /* the second: before the line is left */
    uint32_t crossings = 0;
    uint32_t from[PAIR_MAX_POINTS + 1];
    uint32_t to[PAIR_MAX_POINTS + 1];
    uint32_t inside = d[0] >= -room ? 1 : 0;
    d[n] = d[0];
    for (uint32_t i = 0; i < n && m + 2 <= PAIR_MAX_POINTS; i++) {
        const uint32_t next_inside = d[i + 1] >= -room ? 1 : 0;
        const uint32_t clear = greater(d[i], d[i + 1]) > room ? 1 : 0;
        const uint32_t crosses = (inside ^ next_inside) & clear;
        out->side[m] = in->side[i];
        out->origin[m] = in->origin[i];
        out->u[m] = in->u[i];
        out->v[m] = in->v[i];
        out->h[m] = in->h[i];
        m += inside;
        from[crossings] = i;
        to[crossings] = m;
        crossings += crosses;
        m += crosses;
        last[inside & (next_inside ^ 1u)] = m - 1;
        inside = next_inside;
    }
    for (uint32_t c = 0; c < crossings; c++) {
        const uint32_t i = from[c];
        take_crossing(in, i, i + 1 == n ? 0 : i + 1, d, j, out, to[c]);
    }
    out->side[last[1]] = OWN_SIDE + j;
    out->count = m;
}

/* Overlap of two polygons. Returns a pointer into the work space. */
static const outline *clip_polygon(clipping *c, outline work[2])
{
    outline *from = &work[0];
    outline *to = &work[1];
    double d[PAIR_MAX_POINTS + 1];
    take_outline(c->inner, from);
    for (uint32_t j = 0; j < c->outer->count && from->count > 0; j++) {
        const line l = side_line(c->outer, j, c->winding);
        const double room = c->slack * l.length;
        const double reach = c->reach * l.length;
        double least = (double)INFINITY;
        double nearest = (double)INFINITY;
        for (uint32_t i = 0; i < from->count; i++) {
            d[i] = line_value(&l, from->u[i], from->v[i]);
            least = lesser(d[i], least);
            nearest = lesser(absolute(d[i]), nearest);
        }
        c->near |= nearest <= reach;
        if (least < -room) {
            clip_by_line(from, d, room, j, to);
            outline *swap = from;
            from = to;
            to = swap;
        }
    }
    return from;
}

/* An end of a segment, with the names of its features. */
typedef struct segment_corner {
    double u, v, h;
    uint32_t inner;
    uint32_t outer;
} segment_corner;

/* A segment clipped by a polygon: two corners, or none. */
static uint32_t clip_segment(const polygon *inner, const polygon *outer, double winding,
                             double slack, segment_corner out[2])
{
    double t[2] = {0.0, 1.0};
    uint32_t cut[2] = {OWN_SIDE, OWN_SIDE};
    for (uint32_t j = 0; j < outer->count; j++) {
        const line l = side_line(outer, j, winding);
        const double d[2] = {line_value(&l, inner->u[0], inner->v[0]),
                             line_value(&l, inner->u[1], inner->v[1])};
        const double room = slack * l.length;
        if (d[0] < -room && d[1] < -room) {
            return 0;
        }
        for (int end = 0; end < 2; end++) {
            if (d[end] < -room) {
                const double f = d[0] / (d[0] - d[1]);
                const double at = f < 0.0 ? 0.0 : f > 1.0 ? 1.0 : f;
                if (end == 0 ? at > t[0] : at < t[1]) {
                    t[end] = at;
                    cut[end] = j;
                }
            }
        }
    }
    if (t[0] > t[1]) {
        return 0;
    }
    for (int end = 0; end < 2; end++) {
        const double f = t[end];
        const int whole = cut[end] == OWN_SIDE;
        segment_corner c = {inner->u[0] + f * (inner->u[1] - inner->u[0]),
                            inner->v[0] + f * (inner->v[1] - inner->v[0]),
                            inner->h[0] + f * (inner->h[1] - inner->h[0]), 0, 0};
        c.inner = pair_feature(0, whole ? PAIR_VERTEX : PAIR_EDGE, whole ? (uint32_t)end : 0);
        c.outer = pair_feature(0, whole ? PAIR_FACE : PAIR_EDGE, whole ? 0 : cut[end]);
        out[end] = c;
    }
    return 2;
}

/* ---- from the plane back into space --------------------------------------------------------- */

static void place(const double frame[9], double u, double v, double h, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = frame[i] * h + (frame[3 + i] * u + frame[6 + i] * v);
    }
}

static void name_features(const polygon p[2], int reference, uint32_t inner, uint32_t outer,
                          pair_point *point)
{
    const uint32_t a = reference == 0 ? outer : inner;
    const uint32_t b = reference == 0 ? inner : outer;
    point->a = pair_feature(p[0].feature, 0, 0) | a;
    point->b = pair_feature(p[1].feature, 0, 0) | b;
}

/* Corner of an overlap to a point: `reference` is the polygon that clipped. */
static void raise(const double frame[9], const polygon p[2], int reference, double u, double v,
                  double height, pair_point *point)
{
    const double h = height_at(&p[reference], u, v);
    point->distance = reference == 0 ? h - height : height - h;
    place(frame, u, v, 0.5 * (h + height), point->middle);
}

static double slack_of(const polygon p[2])
{
    double reach = 0.0;
    for (int k = 0; k < 2; k++) {
        reach = greater(reach, absolute(p[k].u[0]) + absolute(p[k].v[0]) + p[k].size);
    }
    return CLIP_ROUNDING * lesser(p[0].size, p[1].size) + PAIR_ROUNDING * reach;
}

static uint32_t overlap_segment(const double frame[9], const polygon p[2], int reference,
                                pair_point *points)
{
    segment_corner ends[2];
    const uint32_t count =
        clip_segment(&p[1 - reference], &p[reference], winding_of(reference), slack_of(p), ends);
    for (uint32_t i = 0; i < count; i++) {
        raise(frame, p, reference, ends[i].u, ends[i].v, ends[i].h, &points[i]);
        name_features(p, reference, ends[i].inner, ends[i].outer, &points[i]);
    }
    return count;
}

static uint32_t overlap(const double frame[9], const polygon p[2], int reference,
                        pair_point *points)
{
    outline work[2];
    clipping c = {&p[1 - reference],
                  &p[reference],
                  winding_of(reference),
                  slack_of(p),
                  NEAR * lesser(p[0].shortest, p[1].shortest),
                  0};
    if (c.inner->count == 2) {
        return overlap_segment(frame, p, reference, points);
    }
    const outline *x = clip_polygon(&c, work);
    for (uint32_t i = 0; i < x->count; i++) {
        uint32_t inner;
        uint32_t outer;
        raise(frame, p, reference, x->u[i], x->v[i], x->h[i], &points[i]);
        name_corner(&c, x, i, &inner, &outer);
        name_features(p, reference, inner, outer, &points[i]);
    }
    return x->count;
}

static void frame_of(const double n[3], double frame[9])
{
    basis_rows(n[0], n[1], n[2], frame);
}

uint32_t clip_faces(const pair_query *query, const pair_face faces[2], int reference,
                    const pair_axis *axis, pair_point points[PAIR_MAX_POINTS])
{
    double frame[9];
    polygon p[2];
    (void)query;
    frame_of(axis->normal, frame);
    flatten(&faces[0], frame, &p[0]);
    flatten(&faces[1], frame, &p[1]);
    take_slope(&faces[reference], frame, &p[reference]);
    return overlap(frame, p, reference, points);
}

/* ---- faces of boxes -------------------------------------------------------------------------- */

enum { ALONG_U, ALONG_V, ALONG_H };

/* Of the outline work[at], keep what lies on one side of a line along an axis of the rectangle, if
 * anything does not. Returns where the outline is now. */
TRIBO_ALWAYS_INLINE uint32_t cut(outline work[2], uint32_t at, int along, double sign, double reach,
                                 double slack, uint32_t j)
{
    const outline *x = &work[at];
    const double *values = along == ALONG_U ? x->u : along == ALONG_V ? x->v : x->h;
    double d[PAIR_MAX_POINTS + 1];
    double least = (double)INFINITY;
    for (uint32_t i = 0; i < x->count; i++) {
        d[i] = reach - sign * values[i];
        least = lesser(d[i], least);
    }
    if (least >= -slack) {
        return at;
    }
    clip_by_line(x, d, slack, j, &work[1 - at]);
    return 1 - at;
}

static int is_near(const polygon *p, const double half[2], double reach)
{
    int near = 0;
    for (uint32_t i = 0; i < 4; i++) {
        near |= absolute(absolute(p->u[i]) - half[0]) <= reach;
        near |= absolute(absolute(p->v[i]) - half[1]) <= reach;
    }
    return near;
}

/* Whether a corner is none of the overlap, but one that cutting at a height has made. */
static int is_at_level(uint32_t origin)
{
    return ((origin & 255u) == LEVEL_SIDE) | (origin >> 8 == OWN_SIDE + LEVEL_SIDE);
}

static uint32_t raise_rectangle(const pair_query *query, const pair_rectangles *f,
                                const clipping *c, const outline *x, pair_point *points)
{
    const uint32_t own = pair_feature(f->own, 0, 0);
    const uint32_t other = pair_feature(f->other.feature, 0, 0);
    double origin[3]; /* of the box whose face clips */
    tribo_vec3_scale((double)f->side, query->offset, origin);
    uint32_t count = 0;
    for (uint32_t i = 0; i < x->count; i++) {
        if (is_at_level(x->origin[i])) {
            continue;
        }
        pair_point *to = points + count++;
        uint32_t inner;
        uint32_t outer;
        name_corner(c, x, i, &inner, &outer);
        place(f->frame, x->u[i], x->v[i], 0.5 * (x->h[i] + f->level), to->middle);
        tribo_vec3_add(to->middle, origin, to->middle);
        to->distance = x->h[i] - f->level;
        const uint32_t names[2] = {own | outer, other | inner};
        to->a = names[f->side];
        to->b = names[1 - f->side];
    }
    return count;
}

/* Corners of the rectangle, for their names. */
static void take_corners(const double half[2], polygon *p)
{
    p->count = 4;
    p->u[0] = p->u[3] = half[0];
    p->u[1] = p->u[2] = -half[0];
    p->v[0] = p->v[1] = half[1];
    p->v[2] = p->v[3] = -half[1];
}

uint32_t clip_rectangles(const pair_query *query, const pair_rectangles *f,
                         pair_point points[PAIR_MAX_POINTS])
{
    polygon outer;
    outline work[2];
    const polygon *other = &f->other;
    take_corners(f->half, &outer);
    const double first = absolute(other->u[0] - other->u[1]) + absolute(other->v[0] - other->v[1]);
    const double second = absolute(other->u[1] - other->u[2]) + absolute(other->v[1] - other->v[2]);
    const double lengths = f->half[0] + f->half[1] + (first + second) + extent(query->offset);
    const double slack = CLIP_ROUNDING * f->size + PAIR_ROUNDING * lengths;
    const double reach = NEAR * lesser(2.0 * lesser(f->half[0], f->half[1]), lesser(first, second));
    const clipping c = {other, &outer, 1.0, slack, reach, is_near(other, f->half, reach)};
    /* first the height: most of what would be clipped hangs on corners too far from the face */
    const double top = f->level + (query->margin + ABOVE * lengths);
    uint32_t at = 0;
    take_quadrilateral(other, work);
    at = cut(work, at, ALONG_H, 1.0, top, 0.0, LEVEL_SIDE);
    at = cut(work, at, ALONG_V, 1.0, f->half[1], slack, 0);
    at = cut(work, at, ALONG_U, -1.0, f->half[0], slack, 1);
    at = cut(work, at, ALONG_V, -1.0, f->half[1], slack, 2);
    at = cut(work, at, ALONG_U, 1.0, f->half[0], slack, 3);
    return raise_rectangle(query, f, &c, &work[at], points);
}

static uint32_t deepest_of(const pair_point *points, uint32_t count)
{
    uint32_t deepest = 0;
    for (uint32_t i = 1; i < count; i++) {
        if (points[i].distance < points[deepest].distance) {
            deepest = i;
        }
    }
    return deepest;
}

/* ---- degenerate faces ----------------------------------------------------------------------- */

/* One point, of a curved place at least on one side. */
static uint32_t touch_at_point(const pair_face faces[2], const pair_axis *axis, pair_point *point)
{
    const double half = 0.5 * axis->distance;
    const int a = faces[0].count == 1;
    const int b = faces[1].count == 1;
    for (int i = 0; i < 3; i++) {
        const double from_a = faces[0].points[i] - half * axis->normal[i];
        const double from_b = faces[1].points[i] + half * axis->normal[i];
        point->middle[i] = a && b ? 0.5 * (from_a + from_b) : a ? from_a : from_b;
    }
    point->distance = axis->distance;
    point->a = pair_feature(faces[0].feature, a ? PAIR_CURVED : PAIR_FACE, 0);
    point->b = pair_feature(faces[1].feature, b ? PAIR_CURVED : PAIR_FACE, 0);
    return 1;
}

static double held(double t)
{
    return t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
}

/* The point at parameter s of A's edge and t of B's. */
static void between_edges(const double frame[9], const polygon p[2], double s, double t,
                          pair_point *point)
{
    const double w[2] = {s, t};
    double at[2][3];
    for (int k = 0; k < 2; k++) {
        at[k][0] = p[k].h[0] + w[k] * (p[k].h[1] - p[k].h[0]);
        at[k][1] = p[k].u[0] + w[k] * (p[k].u[1] - p[k].u[0]);
        at[k][2] = p[k].v[0] + w[k] * (p[k].v[1] - p[k].v[0]);
    }
    place(frame, 0.5 * (at[0][1] + at[1][1]), 0.5 * (at[0][2] + at[1][2]),
          0.5 * (at[0][0] + at[1][0]), point->middle);
    point->distance = at[0][0] - at[1][0];
    point->a = pair_feature(p[0].feature, PAIR_EDGE, 0);
    point->b = pair_feature(p[1].feature, PAIR_EDGE, 0);
}

static int is_share(double t)
{
    return t >= 0.0 - RIDGE && t <= 1.0 + RIDGE;
}

/* Two edges along the normal. */
typedef struct crossing_edges {
    double a[2]; /* the way along A's, */
    double b[2]; /* along B's, */
    double d[2]; /* and from where A's begins to where B's does */
    double aa;
    double turn; /* a x b */
} crossing_edges;

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* The point where they cross; none if that is beyond an end or not at the distance of the shapes: a
 * line of a cone may lie a little across the normal. */
static uint32_t touch_at_crossing(const double frame[9], const polygon p[2],
                                  const crossing_edges *e, double distance, pair_point *point)
{
    const double at_a = cross(e->d, e->b) / e->turn;
    const double at_b = cross(e->d, e->a) / e->turn;
    if (!(is_share(at_a) && is_share(at_b))) {
        return 0;
    }
    between_edges(frame, p, held(at_a), held(at_b), point);
    const double off = absolute(point->distance - distance);
    point->distance = distance;
    return off <= RIDGE * lesser(p[0].size, p[1].size) ? 1 : 0;
}

/* The ends of the overlap of edges that are parallel; none if they pass each other or veer. */
static uint32_t touch_along(const double frame[9], const polygon p[2], const crossing_edges *e,
                            double distance, pair_point points[2])
{
    const double s0 = (e->d[0] * e->a[0] + e->d[1] * e->a[1]) / e->aa;
    const double s1 = s0 + (e->b[0] * e->a[0] + e->b[1] * e->a[1]) / e->aa;
    const double s[2] = {held(lesser(s0, s1)), held(greater(s0, s1))};
    const double room = ASIDE * (p[0].size + p[1].size) * sqrt(e->aa);
    double least = (double)INFINITY;
    uint32_t count = 0;
    for (int k = 0; k < 2 && (k == 0 || s[1] > s[0]); k++) {
        const int at_a = s[k] == (double)k;
        const int at_b = (s0 < s1) == (k == 0) ? 0 : 1;
        const double t = held((s[k] - s0) / (s1 - s0));
        if (absolute(cross(e->a, e->d) + t * e->turn) > room) {
            return 0;
        }
        between_edges(frame, p, s[k], t, &points[count]);
        if (at_a) {
            points[count].a = pair_feature(p[0].feature, PAIR_VERTEX, (uint32_t)k);
        } else {
            points[count].b = pair_feature(p[1].feature, PAIR_VERTEX, (uint32_t)at_b);
        }
        least = lesser(least, points[count].distance);
        count++;
    }
    for (uint32_t k = 0; k < count; k++) {
        points[k].distance += distance - least; /* the axis may lean on an end of either */
    }
    return count;
}

/* Edges of two rounded shapes; 0 if they do not touch each other. */
static uint32_t touch_at_edges(const double frame[9], const polygon p[2], double distance,
                               pair_point points[2])
{
    crossing_edges e = {{p[0].u[1] - p[0].u[0], p[0].v[1] - p[0].v[0]},
                        {p[1].u[1] - p[1].u[0], p[1].v[1] - p[1].v[0]},
                        {p[1].u[0] - p[0].u[0], p[1].v[0] - p[0].v[0]},
                        0.0,
                        0.0};
    const double bb = e.b[0] * e.b[0] + e.b[1] * e.b[1];
    e.aa = e.a[0] * e.a[0] + e.a[1] * e.a[1];
    e.turn = cross(e.a, e.b);
    uint32_t count = 0;
    if (e.turn * e.turn <= PARALLEL * PARALLEL * (e.aa * bb)) {
        count = e.aa > 0.0 && bb > 0.0 ? touch_along(frame, p, &e, distance, points) : 0;
    }
    return count > 0 || e.turn == 0.0 ? count : touch_at_crossing(frame, p, &e, distance, points);
}

static int is_same(const double a[3], const double b[3], double reach)
{
    return absolute(a[0] - b[0]) <= reach && absolute(a[1] - b[1]) <= reach &&
           absolute(a[2] - b[2]) <= reach;
}

/* ---- the axis and the faces ----------------------------------------------------------------- */

/* Where a face of either shape looks along the axis nearly, its normal is exact and the axis has
 * noise that a large face turns into depth: take it unless it is worse, or the axis is it already.
 * Returns the face's side, or -1. */
static int snap(const pair_query *query, const pair_face faces[2], pair_axis *axis)
{
    int best = -1;
    pair_axis face[2];
    const pair_axis given = *axis;
    for (int side = 0; side < 2; side++) {
        tribo_vec3_scale(side == 0 ? -1.0 : 1.0, faces[side].normal, face[side].normal);
        if (faces[side].count >= 3 && is_same(face[side].normal, given.normal, 4.0 * TRIBO_EPS)) {
            memcpy(axis->normal, face[side].normal, sizeof axis->normal);
            return side;
        }
    }
    for (int side = 0; side < 2; side++) {
        double rounding;
        if (faces[side].count < 3 ||
            !(tribo_vec3_dot(face[side].normal, given.normal) > SNAP_ANGLE) ||
            !clip_distance(query, face[side].normal, &face[side].distance, &rounding)) {
            continue;
        }
        const double gain = face[side].distance - axis->distance;
        const double slack = SNAP_WIDTH * absolute(axis->distance) + rounding;
        if (best < 0 ? gain >= -slack : gain > slack) {
            *axis = face[side];
            best = side;
        }
    }
    return best;
}

/* The face that clips: the one that is more alike to a plane across the normal; A's if both are. */
static int choose_reference(const pair_face faces[2], const double normal[3], double *cosine)
{
    const double a = faces[0].count < 3 ? -1.0 : 0.0 - tribo_vec3_dot(faces[0].normal, normal);
    const double b = faces[1].count < 3 ? -1.0 : tribo_vec3_dot(faces[1].normal, normal);
    const int reference = b > a + 4.0 * TRIBO_EPS ? 1 : 0;
    *cosine = reference == 0 ? a : b;
    return reference;
}

/* ---- where two shapes touch, by supports alone ---------------------------------------------- */

/* Farthest points of A and B in directions tilted a little against the axis, and how B's lies
 * beside A's. The shapes touch where a mixture of such pairs has its two points above each
 * other. */
typedef struct sample {
    double a[3];
    double b[3];
    double u;
    double v;
} sample;

typedef struct mixture {
    uint32_t count; /* 1 to 3 samples */
    uint32_t at[3];
    double weight[3];
    double u; /* what is left between the two points */
    double v;
} mixture;

static int take_sample(const pair_query *query, const double frame[9], double u, double v,
                       sample *out)
{
    double along[3];
    double back[3];
    for (int i = 0; i < 3; i++) {
        along[i] = frame[i] + (u * frame[3 + i] + v * frame[6 + i]);
        back[i] = 0.0 - along[i];
    }
    if (!take_support(query, 0, back, out->a) || !take_support(query, 1, along, out->b)) {
        return 0;
    }
    double apart[3];
    tribo_vec3_subtract(out->b, out->a, apart);
    out->u = tribo_vec3_dot(frame + 3, apart);
    out->v = tribo_vec3_dot(frame + 6, apart);
    return 1;
}

/* Two samples: the point of their segment that is nearest to zero. */
static void mix_two(const sample *s, uint32_t i, uint32_t j, mixture *best)
{
    const double du = s[j].u - s[i].u;
    const double dv = s[j].v - s[i].v;
    const double square = du * du + dv * dv;
    const double t = square > 0.0 ? held(0.0 - (s[i].u * du + s[i].v * dv) / square) : 0.0;
    const double u = s[i].u + t * du;
    const double v = s[i].v + t * dv;
    if (u * u + v * v < best->u * best->u + best->v * best->v) {
        const mixture m = {2, {i, j, j}, {1.0 - t, t, 0.0}, u, v};
        *best = m;
    }
}

/* Three samples with zero among them; if they lie on a line, rounding may say so of any. */
static void mix_three(const sample *s, uint32_t i, uint32_t j, uint32_t k, mixture *best)
{
    const double a = s[j].u * s[k].v - s[j].v * s[k].u;
    const double b = s[k].u * s[i].v - s[k].v * s[i].u;
    const double c = s[i].u * s[j].v - s[i].v * s[j].u;
    const double sum = a + b + c;
    if ((a >= 0.0 && b >= 0.0 && c >= 0.0 && sum > 0.0) ||
        (a <= 0.0 && b <= 0.0 && c <= 0.0 && sum < 0.0)) {
        const double w[3] = {a / sum, b / sum, c / sum};
        const double u = w[0] * s[i].u + w[1] * s[j].u + w[2] * s[k].u;
        const double v = w[0] * s[i].v + w[1] * s[j].v + w[2] * s[k].v;
        if (u * u + v * v < best->u * best->u + best->v * best->v) {
            const mixture m = {3, {i, j, k}, {w[0], w[1], w[2]}, u, v};
            *best = m;
        }
    }
}

/* What the newest of `count` samples adds. */
static void mix(const sample *s, uint32_t count, mixture *best)
{
    const uint32_t last = count - 1;
    if (count == 1) {
        const mixture m = {1, {0, 0, 0}, {1.0, 0.0, 0.0}, s[0].u, s[0].v};
        *best = m;
    }
    for (uint32_t i = 0; i < last; i++) {
        mix_two(s, i, last, best);
    }
    for (uint32_t i = 0; i < last; i++) {
        for (uint32_t j = i + 1; j < last; j++) {
            mix_three(s, i, j, last, best);
        }
    }
}

/* The point where the shapes touch, when their faces do not hold it: rims of round shapes, corners
 * and edges whose nearest faces look elsewhere. Samples are tilted towards what is left, as in GJK,
 * but in the plane, and farther where a sample brings little. */
static uint32_t add_witness(const pair_query *query, const pair_face faces[2],
                            const double frame[9], const pair_axis *axis, pair_point *point)
{
    sample s[SAMPLES];
    mixture best = {0, {0, 0, 0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    double way[2] = {0.0, 0.0};
    double left = 0.0;
    double reach = TILT;
    for (uint32_t count = 0; count < SAMPLES; count++) {
        sample *new = &s[count];
        if (!take_sample(query, frame, reach * way[0], reach * way[1], new)) {
            return 0;
        }
        const double slack = CLIP_ROUNDING * (extent(new->a) + extent(new->b));
        const double gain = left + (new->u *way[0] + new->v *way[1]);
        if (count > 0 && gain <= slack && reach >= MOST_TILT) {
            break;
        }
        reach *= count > 0 && gain < 0.5 * left && reach < MOST_TILT ? TILT_GROWTH : 1.0;
        mix(s, count + 1, &best);
        left = sqrt(best.u * best.u + best.v * best.v);
        if (!(left > slack)) {
            break;
        }
        way[0] = 0.0 - best.u / left;
        way[1] = 0.0 - best.v / left;
    }
    point->middle[0] = point->middle[1] = point->middle[2] = 0.0;
    for (uint32_t k = 0; k < best.count; k++) {
        const sample *from = &s[best.at[k]];
        tribo_vec3_add_scaled(point->middle, 0.5 * best.weight[k], from->a, point->middle);
        tribo_vec3_add_scaled(point->middle, 0.5 * best.weight[k], from->b, point->middle);
    }
    point->distance = axis->distance;
    point->a = pair_feature(faces[0].feature, PAIR_CURVED, 0);
    point->b = pair_feature(faces[1].feature, PAIR_CURVED, 0);
    return 1;
}

static int is_over(const polygon *p, double winding, double slack, double u, double v)
{
    int over = 1;
    for (uint32_t j = 0; j < p->count; j++) {
        const line l = side_line(p, j, winding);
        over = over && line_value(&l, u, v) >= -slack * l.length;
    }
    return over;
}

/* Whether a point lies on a segment. */
static int is_beside(const polygon *p, double room, double u, double v)
{
    const double way[2] = {p->u[1] - p->u[0], p->v[1] - p->v[0]};
    const double to[2] = {u - p->u[0], v - p->v[0]};
    const double square = way[0] * way[0] + way[1] * way[1];
    const double t = square > 0.0 ? held((to[0] * way[0] + to[1] * way[1]) / square) : 0.0;
    return absolute(to[0] - t * way[0]) <= room && absolute(to[1] - t * way[1]) <= room;
}

/* Whether the farthest point of one shape, where that is all of its face, does not lie where the
 * other one is: of round shapes the axis is known less well than the depth, and a user's shape that
 * tells no face may be flat all the same; then its support point is one of many as far. */
static int is_elsewhere(const pair_face faces[2], const double frame[9], double distance)
{
    polygon p[2];
    flatten(&faces[0], frame, &p[0]);
    flatten(&faces[1], frame, &p[1]);
    const double room = RIDGE * (extent(faces[0].points) + extent(faces[1].points));
    if (p[0].count == 1 && p[1].count == 1) {
        return absolute(p[0].u[0] - p[1].u[0]) > room || absolute(p[0].v[0] - p[1].v[0]) > room;
    }
    const int side = p[0].count > 1 ? 0 : 1;
    const double u = p[1 - side].u[0];
    const double v = p[1 - side].v[0];
    if (p[side].count == 2) {
        return !is_beside(&p[side], room, u, v);
    }
    take_slope(&faces[side], frame, &p[side]);
    const double between = winding_of(1 - side) * (height_at(&p[side], u, v) - p[1 - side].h[0]);
    return absolute(between - distance) > room || !is_over(&p[side], winding_of(side), room, u, v);
}

/* ---- two faces ------------------------------------------------------------------------------ */

/* Points of two faces of which the one that clips lies across the normal. */
static uint32_t touch_at_faces(const pair_query *query, const pair_face faces[2],
                               const polygon p[2], const double frame[9], int reference,
                               const pair_axis *axis, pair_point *points)
{
    uint32_t count = overlap(frame, p, reference, points);
    const double size = lesser(p[0].size, p[1].size);
    const double slack = CLIP_ROUNDING * size + PAIR_ROUNDING * (absolute(p[0].h[0]) + size);
    if (count == 0 || points[deepest_of(points, count)].distance > axis->distance + slack) {
        count += add_witness(query, faces, frame, axis, &points[count]);
    }
    return count;
}

/* Edges that cross, or corners: no face lies across the normal. What is deepest in the overlap is
 * where they touch; parallel edges have two such places. */
static uint32_t touch_at_ridges(const pair_query *query, const pair_face faces[2],
                                const polygon p[2], const double frame[9], int reference,
                                const pair_axis *axis, pair_point *points)
{
    const uint32_t count = overlap(frame, p, reference, points);
    const double room = RIDGE * lesser(p[0].size, p[1].size);
    const double least = count > 0 ? points[deepest_of(points, count)].distance : 0.0;
    if (count == 0 || absolute(least - axis->distance) > room) {
        return add_witness(query, faces, frame, axis, points);
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (points[i].distance <= least + room) {
            points[kept] = points[i];
            points[kept].distance += axis->distance - least;
            kept++;
        }
    }
    return kept;
}

static uint32_t touch(const pair_query *query, const pair_face faces[2], const pair_axis *axis,
                      double *size, pair_point *points)
{
    double frame[9];
    polygon p[2];
    double cosine;
    *size = 0.0;
    frame_of(axis->normal, frame);
    if (faces[0].count == 1 || faces[1].count == 1) {
        return is_elsewhere(faces, frame, axis->distance)
                   ? add_witness(query, faces, frame, axis, points)
                   : touch_at_point(faces, axis, points);
    }
    flatten(&faces[0], frame, &p[0]);
    flatten(&faces[1], frame, &p[1]);
    *size = lesser(p[0].size, p[1].size);
    if (faces[0].count == 2 && faces[1].count == 2) {
        const uint32_t count = touch_at_edges(frame, p, axis->distance, points);
        return count > 0 ? count : add_witness(query, faces, frame, axis, points);
    }
    const int reference = choose_reference(faces, axis->normal, &cosine);
    take_slope(&faces[reference], frame, &p[reference]);
    return cosine >= ALIGNED ? touch_at_faces(query, faces, p, frame, reference, axis, points)
                             : touch_at_ridges(query, faces, p, frame, reference, axis, points);
}

void clip_manifold(const pair_query *query, const pair_axis *axis, tribo_manifold *out)
{
    pair_face faces[2];
    pair_point points[PAIR_MAX_POINTS];
    pair_axis best = *axis;
    double back[3] = {0.0 - best.normal[0], 0.0 - best.normal[1], 0.0 - best.normal[2]};
    double size;
    clip_nothing(out);
    if (!(axis->distance <= query->margin) || !clip_take_face(query, 0, back, &faces[0]) ||
        !clip_take_face(query, 1, best.normal, &faces[1])) {
        return;
    }
    int side = snap(query, faces, &best);
    side = is_same(best.normal, axis->normal, 0.0) ? -1 : side;
    if (side == 0 && !clip_take_face(query, 1, best.normal, &faces[1])) {
        return;
    }
    if (side == 1) {
        tribo_vec3_scale(-1.0, best.normal, back);
        if (!clip_take_face(query, 0, back, &faces[0])) {
            return;
        }
    }
    const uint32_t count = touch(query, faces, &best, &size, points);
    if (count > 0) {
        const uint32_t deepest = deepest_of(points, count);
        points[deepest].distance = lesser(points[deepest].distance, query->margin);
        clip_finish(query, best.normal, size, count, points, out);
    }
}

/* ---- one face that is given ----------------------------------------------------------------- */

/* The lowest point of A, if it lies over the polygon and is lower than all others. */
static uint32_t add_lowest(const pair_query *query, const polygon p[2], const double frame[9],
                           double slack, uint32_t count, pair_point *points)
{
    const double down[3] = {0.0 - frame[0], 0.0 - frame[1], 0.0 - frame[2]};
    double at[3];
    if (!take_support(query, 0, down, at)) {
        return 0;
    }
    const double u = tribo_vec3_dot(frame + 3, at);
    const double v = tribo_vec3_dot(frame + 6, at);
    const double h = tribo_vec3_dot(frame, at);
    const double distance = h - p[1].h[0];
    if (!is_over(&p[1], winding_of(1), slack, u, v) ||
        (count > 0 && !(distance < points[deepest_of(points, count)].distance - slack))) {
        return 0;
    }
    place(frame, u, v, 0.5 * (h + p[1].h[0]), points[count].middle);
    points[count].distance = distance;
    points[count].a = pair_feature(p[0].feature, PAIR_CURVED, 0);
    points[count].b = pair_feature(p[1].feature, PAIR_FACE, 0);
    return 1;
}

void clip_onto(const pair_query *query, const pair_face *face, tribo_manifold *out)
{
    pair_face faces[2];
    pair_point points[PAIR_MAX_POINTS];
    polygon p[2];
    double frame[9];
    const double down[3] = {0.0 - face->normal[0], 0.0 - face->normal[1], 0.0 - face->normal[2]};
    clip_nothing(out);
    faces[1] = *face;
    if (!clip_take_face(query, 0, down, &faces[0])) {
        return;
    }
    frame_of(face->normal, frame);
    flatten(&faces[0], frame, &p[0]);
    flatten(&faces[1], frame, &p[1]);
    take_slope(&faces[1], frame, &p[1]);
    const double slack = slack_of(p);
    uint32_t count = p[0].count == 1 ? 0 : overlap(frame, p, 1, points);
    count += add_lowest(query, p, frame, slack, count, points);
    if (count > 0) {
        clip_finish(query, face->normal, lesser(p[0].size, p[1].size), count, points, out);
    }
}

/* ---- choice of points ----------------------------------------------------------------------- */

/* Points in order around their area, and what each adds to it. */
typedef struct ring {
    uint32_t count;
    uint32_t order[PAIR_MAX_POINTS];
    double ear
        [PAIR_MAX_POINTS]; /* of the point at this place of the order: twice the triangle's area */
    double u[PAIR_MAX_POINTS];
    double v[PAIR_MAX_POINTS];
} ring;

/* Twice the signed area of a triangle. */
static double area(const ring *r, uint32_t i, uint32_t j, uint32_t k)
{
    return (r->u[j] - r->u[i]) * (r->v[k] - r->v[i]) - (r->v[j] - r->v[i]) * (r->u[k] - r->u[i]);
}

static uint32_t before(const ring *r, uint32_t place)
{
    return place == 0 ? r->count - 1 : place - 1;
}

static uint32_t after(const ring *r, uint32_t place)
{
    return place + 1 == r->count ? 0 : place + 1;
}

static void measure_ear(ring *r, uint32_t place)
{
    r->ear[place] =
        absolute(area(r, r->order[before(r, place)], r->order[place], r->order[after(r, place)]));
}

/* Counter-clockwise from the point of the least name: where choices are as good as each other,
 * which polygon clipped which does not show. */
static void put_in_order(const pair_point *points, ring *r)
{
    double total = 0.0;
    uint32_t first = 0;
    for (uint32_t k = 1; k < r->count; k++) {
        const pair_point *p = &points[k];
        const pair_point *least = &points[first];
        total += k > 1 ? area(r, 0, k - 1, k) : 0.0;
        first = p->a < least->a || (p->a == least->a && p->b < least->b) ? k : first;
    }
    for (uint32_t k = 0; k < r->count; k++) {
        r->order[k] = (total < 0.0 ? first + r->count - k : first + k) % r->count;
    }
}

/* Put point i, which is in no order, where it lies farthest off a side. */
static void insert_point(ring *r, uint32_t i)
{
    double most = -(double)INFINITY;
    uint32_t place = 0;
    for (uint32_t k = 0; k < r->count; k++) {
        const double gain = 0.0 - area(r, r->order[k], r->order[after(r, k)], i);
        if (gain > most) {
            most = gain;
            place = k + 1;
        }
    }
    for (uint32_t k = r->count; k > place; k--) {
        r->order[k] = r->order[k - 1];
    }
    r->order[place] = i;
    r->count++;
}

static void take_ring(const double normal[3], uint32_t count, const pair_point *points, ring *r)
{
    double frame[9];
    const uint32_t last = count - 1;
    const int is_alone = (points[last].a >> 6 & 3u) == PAIR_CURVED;
    frame_of(normal, frame);
    for (uint32_t i = 0; i < count; i++) {
        r->u[i] = tribo_vec3_dot(frame + 3, points[i].middle);
        r->v[i] = tribo_vec3_dot(frame + 6, points[i].middle);
    }
    /* Corners come in order; a support point stands behind them. */
    r->count = is_alone ? last : count;
    put_in_order(points, r);
    if (r->count < count) {
        insert_point(r, last);
    }
}

static void remove_place(ring *r, uint32_t place)
{
    r->count--;
    for (uint32_t k = place; k < r->count; k++) {
        r->order[k] = r->order[k + 1];
        r->ear[k] = r->ear[k + 1];
    }
    const uint32_t next = place == r->count ? 0 : place;
    measure_ear(r, next);
    measure_ear(r, before(r, next));
}

/* Take away what adds least to the area until `max` points are left, but not the one to keep. */
static void thin_ring(ring *r, uint32_t max, uint32_t kept)
{
    for (uint32_t k = 0; k < r->count; k++) {
        measure_ear(r, k);
    }
    while (r->count > max) {
        uint32_t least = r->order[0] == kept ? 1 : 0;
        for (uint32_t k = least + 1; k < r->count; k++) {
            if (r->ear[k] * BETTER < r->ear[least] && r->order[k] != kept) {
                least = k;
            }
        }
        remove_place(r, least);
    }
}

/* Places of the three corners of a polygon that hold the largest area, the first of them below
 * `first`. */
static void best_three(uint32_t count, const double *u, const double *v, uint32_t first,
                       uint32_t best[3])
{
    double most = -1.0;
    for (uint32_t i = 0; i < first; i++) {
        for (uint32_t j = i + 1; j < count; j++) {
            for (uint32_t k = j + 1; k < count; k++) {
                const double size =
                    absolute((u[j] - u[i]) * (v[k] - v[i]) - (v[j] - v[i]) * (u[k] - u[i]));
                if (size > most) {
                    const uint32_t corners[3] = {i, j, k};
                    memcpy(best, corners, sizeof corners);
                    most = BETTER * size;
                }
            }
        }
    }
}

/* The same of four corners: a quadrilateral has half the area that its diagonals span. */
static void best_four(uint32_t count, const double *u, const double *v, uint32_t first,
                      uint32_t best[4])
{
    double most = -1.0;
    for (uint32_t i = 0; i < first; i++) {
        for (uint32_t k = i + 2; k + 1 < count; k++) {
            const double du = u[k] - u[i];
            const double dv = v[k] - v[i];
            for (uint32_t j = i + 1; j < k; j++) {
                for (uint32_t l = k + 1; l < count; l++) {
                    const double size = absolute(du * (v[l] - v[j]) - dv * (u[l] - u[j]));
                    if (size > most) {
                        const uint32_t corners[4] = {i, j, k, l};
                        memcpy(best, corners, sizeof corners);
                        most = BETTER * size;
                    }
                }
            }
        }
    }
}

/* The three or four points of a ring that keep the largest area, with `kept` among them if the
 * ring has it. */
static void choose_corners(ring *r, uint32_t max, uint32_t kept)
{
    double u[SEARCHED];
    double v[SEARCHED];
    uint32_t order[SEARCHED] = {0};
    uint32_t best[TRIBO_MAX_POINTS] = {0};
    uint32_t start = 0;
    thin_ring(r, SEARCHED, kept);
    while (start < r->count && r->order[start] != kept) {
        start++;
    }
    const uint32_t first = start < r->count ? 1 : r->count;
    for (uint32_t k = 0; k < r->count; k++) {
        order[k] = r->order[(start + k) % r->count];
        u[k] = r->u[order[k]];
        v[k] = r->v[order[k]];
    }
    if (max == 3) {
        best_three(r->count, u, v, first, best);
    } else {
        best_four(r->count, u, v, first, best);
    }
    for (uint32_t k = 0; k < max; k++) {
        r->order[k] = order[best[k]];
    }
    r->count = max;
}

/* The deepest point and the one that is farthest from it. */
static void choose_two(ring *r, uint32_t max, uint32_t deepest)
{
    double best = -1.0;
    uint32_t farthest = deepest;
    for (uint32_t k = 0; k < r->count; k++) {
        const double u = r->u[k] - r->u[deepest];
        const double v = r->v[k] - r->v[deepest];
        if (u * u + v * v > best * BETTER) {
            best = u * u + v * v;
            farthest = k;
        }
    }
    r->order[0] = deepest;
    r->order[1] = farthest;
    r->count = max;
}

/* Place of the deepest of the points chosen. */
static uint32_t deepest_place(const ring *r, const pair_point *points)
{
    uint32_t place = 0;
    for (uint32_t k = 1; k < r->count; k++) {
        const double best = points[r->order[place]].distance;
        place = points[r->order[k]].distance < best ? k : place;
    }
    return place;
}

/* Choose `max` of the points: those that keep the largest area, one of them the deepest. In stacks
 * of equal boxes that are twisted against each other two choices are as good as each other, and
 * the motion of a step says which corner is the deepest: where all of them are to `level`, the
 * choice stays, and the deepest of it tells the depth of all. */
static void choose_points(const double normal[3], double level, uint32_t max, uint32_t count,
                          pair_point *points, ring *r)
{
    const uint32_t deepest = deepest_of(points, count);
    take_ring(normal, count, points, r);
    if (max < 3) {
        choose_two(r, max, deepest);
        return;
    }
    choose_corners(r, max, PAIR_MAX_POINTS);
    pair_point *best = &points[r->order[deepest_place(r, points)]];
    if (best->distance <= points[deepest].distance + level) {
        best->distance = points[deepest].distance;
    } else {
        take_ring(normal, count, points, r);
        choose_corners(r, max, deepest);
    }
}

/* Drop what is farther apart than the margin, and points that coincide with one before or have its
 * name: the deeper of the two stays. */
static uint32_t sift(double margin, double reach, uint32_t count, pair_point *points)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const pair_point *p = &points[i];
        uint32_t known = kept;
        if (!(p->distance <= margin)) {
            continue;
        }
        for (uint32_t k = kept; reach > 0.0 && k-- > 0;) {
            const pair_point *q = &points[k];
            const int one = (p->a == q->a) & (p->b == q->b);
            const double across = greater(absolute(p->middle[0] - q->middle[0]),
                                          absolute(p->middle[1] - q->middle[1]));
            const int same = greater(across, absolute(p->middle[2] - q->middle[2])) <= reach;
            known = one | same ? k : known;
        }
        if (known == kept) {
            if (kept != i) { /* what has just been written can not be copied without a stall */
                points[kept] = *p;
            }
            kept++;
        } else if (p->distance < points[known].distance) {
            memcpy(points[known].middle, p->middle, sizeof p->middle);
            points[known].distance = p->distance;
        }
    }
    return kept;
}

void clip_nothing(tribo_manifold *out)
{
    memset(out, 0, offsetof(tribo_manifold, points));
}

tribo_status clip_check(const tribo_manifold *m)
{
    double sum = m->normal[0] + m->normal[1] + m->normal[2];
    for (uint32_t k = 0; k < m->count; k++) {
        const tribo_point *p = &m->points[k];
        sum += (p->arm_a[0] + p->arm_a[1] + p->arm_a[2]) +
               (p->arm_b[0] + p->arm_b[1] + p->arm_b[2]) + p->distance;
    }
    return sum - sum == 0.0 ? TRIBO_OK : TRIBO_ERROR_RANGE;
}

void clip_write(const pair_query *query, const double normal[3], uint32_t count,
                const pair_point *points, tribo_manifold *out)
{
    pair_write_head(query->turned, normal, count, out);
    for (uint32_t i = 0; i < count; i++) {
        pair_write_point(query, &points[i], &out->points[i]);
    }
}

void clip_finish(const pair_query *query, const double normal[3], double size, uint32_t count,
                 pair_point *points, tribo_manifold *out)
{
    const double slack = PAIR_ROUNDING * (size + extent(points[0].middle) + extent(query->offset));
    const uint32_t kept = sift(query->margin + slack, MERGE * size, count, points);
    if (kept == 0) {
        clip_nothing(out);
        return;
    }
    if (kept <= query->max_points) {
        clip_write(query, normal, kept, points, out);
        return;
    }
    ring r;
    choose_points(normal, slack + LEVEL * size, query->max_points, kept, points, &r);
    pair_write_head(query->turned, normal, r.count, out);
    for (uint32_t i = 0; i < r.count; i++) {
        pair_write_point(query, &points[r.order[i]], &out->points[i]);
    }
}
