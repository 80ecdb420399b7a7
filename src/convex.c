/* Axis of least translation of two convex shapes, by their support functions alone.
 *
 * Both shapes enter as one convex set M = B - A, its points relative to where A is; of spheres and
 * capsules only their points and segments do, their radii are added to the width afterwards. The
 * width of the pair along a unit direction n is w(n) = max { n . m : m in M }: the way A has to be
 * moved along n until the two part, and the same number negative, the gap between them, once they
 * have. The answer is the n of least w, and every support call tells w exactly for its own
 * direction. So nothing here is trusted but these widths: the least that was seen wins.
 *
 * - libccd's MPR (Snethen 2008) gives a start, rarely the minimum. Its loops have no limit: see
 *   `bounded`.
 * - Kinks. Where faces or edges meet, the direction is known to the bit from the faces.
 * - Newton where M is smooth, along a great circle where an edge meets a curved place.
 * - Descent everywhere else. w is convex, the unit sphere is not. Move M by -s n, s a little more
 *   than w(n), so that it leaves the origin, and let n' point from its nearest point to the
 *   origin: then w(n') <= w(n) - s (1 - n . n'). This is the convex-concave procedure; it ends in
 *   a local minimum, and with s = 0 it is the distance of two bodies that are apart. Nearest
 *   points by GJK (Gilbert, Johnson, Keerthi 1988), own, because libccd answers no distance query
 *   and its tolerances are absolute.
 * - A survey of all of M by an expanding polytope (van den Bergen 2001) says whether another local
 *   minimum lies deeper: a polytope within M bounds the least width from below. Where M is a
 *   polytope itself, the survey finds the least without a descent before. Round places would need
 *   ever more facets; where a facet is near to M a search from its normal, or what is known of the
 *   rise around the best minimum, settles what lies beyond. Own as well: libccd's ended early in
 *   one deep pair of twenty, compares squares of lengths, has no limit, and allocates. */
#include "hull.h"
#include "pair.h"
#include "rows.h"

#include <tribo/math.h>

#include <ccd/ccd.h>

enum {
    MPR_CALLS = 100,
    GJK_ROUNDS = 80,
    STALE = 6, /* of these in a row */
    DESCENTS = 16,
    LONG_DESCENTS = 10,
    SETTLEMENTS = 8,
    NEWTON_STEPS = 8,
    EXPLORED = 16, /* searches a survey may start, */
    FEW = 3,       /* of which these give up early, */
    CALLS = 1000,  /* and calls of M after which it starts none */
    POINTS = 100,
    FACETS = 2 * POINTS
};

#define SAME_WAY 0.99 /* cosine */
#define TOUCHING 1e-4 /* of the lesser radius: so little may be an overlap or a gap */
#define WORTH 1e-3    /* of the width: so much is worth another search */
#define WIDE 0.5      /* tangent of the angle at which a polytope is first looked at */
#define SAME 1e-9     /* of the reach: by so much two supports may contradict each other */

/* How w rises around a local minimum n where M is smooth, or smooth along a kink. */
typedef struct basin {
    double n[3];
    double across[2][3]; /* the kink runs along the first */
    double width;
    double bend[3];  /* Hessian: 00, 01, 11 */
    double slope[2]; /* to both sides of the kink */
} basin;

typedef struct search {
    const pair_query *pair;
    pair_arms *arms;    /* of A and B */
    double scale;       /* a power of two: lengths here are lengths there times scale */
    double center_a[3]; /* cores, in the axes of their shapes, metres */
    double center_b[3];
    double offset[3]; /* core of B minus core of A, world axes, scaled */
    double margin;    /* up to which gap of M the axis matters: the pair's and both radii */
    double radius;    /* of both, scaled */
    double small;     /* lesser of the outer radii, in [1, 2) */
    double inner;     /* lesser of the inner radii */
    double reach;     /* sum of the outer radii */
    double rounding;  /* of a width */
    double normal[3]; /* direction of the least width seen */
    double width;
    double nearest;     /* of what is known of M to the origin: no gap is more */
    basin lowest;       /* of the minima whose surroundings are known; width: infinite if none is */
    double last[2][3];  /* points of A and B, from their cores, of the latest support */
    double facet[3][3]; /* points of M where features meet */
    int has_facet;
    uint64_t calls; /* of M; each is one of A and one of B */
    uint64_t limit; /* beyond this many libccd is told to stop */
    int patient;    /* many directions are nearly as good: each is worth more work */
    int flat;       /* M is a polytope */
    int stopped;    /* it has been */
    int inside;     /* the origin is, and no direction is better */
    int fault;      /* a support is not finite or contradicts another */
} search;

/* ---- vectors --------------------------------------------------------------------------------- */

static void copy(const double from[3], double to[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

static double length(const double v[3])
{
    return sqrt(tribo_vec3_dot(v, v));
}

/* u = v / |v|; 0 if v is zero or not finite. */
static int unit(const double v[3], double u[3])
{
    const double square = tribo_vec3_dot(v, v);
    if (square > 1e-200 && square < 1e200) {
        const double inverse = 1.0 / sqrt(square);
        for (int i = 0; i < 3; i++) {
            u[i] = v[i] * inverse;
        }
        return 1;
    }
    const double big = greater(greater(absolute(v[0]), absolute(v[1])), absolute(v[2]));
    if (!(big > 0.0) || !all_finite(v, 3)) {
        return 0;
    }
    const double scale = power_of_two(scale_exponent(big));
    const double x[3] = {v[0] * scale, v[1] * scale, v[2] * scale};
    const double size = length(x);
    for (int i = 0; i < 3; i++) {
        u[i] = x[i] / size;
    }
    return 1;
}

/* n turned towards t, square to it, by an angle whose tangent is x. */
static void turn(const double n[3], const double t[3], double x, double out[3])
{
    const double v[3] = {n[0] + x * t[0], n[1] + x * t[1], n[2] + x * t[2]};
    (void)unit(v, out);
}

static void rotate_back(const double r[9], const double v[3], double sign, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = sign * (r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2]);
    }
}

/* ---- supports of M --------------------------------------------------------------------------- */

/* Radius by which a shape is more than its bone: the point or segment of a sphere or capsule. */
static double radius_of(const tribo_shape *shape)
{
    return shape->type == TRIBO_SHAPE_SPHERE || shape->type == TRIBO_SHAPE_CAPSULE ? shape->size[0]
                                                                                   : 0.0;
}

static int bone_support(const tribo_shape *shape, const double direction[3], double point[3])
{
    if (radius_of(shape) > 0.0) {
        const double half = shape->type == TRIBO_SHAPE_CAPSULE ? shape->size[1] : 0.0;
        point[0] = point[1] = 0.0;
        point[2] = direction[2] < 0.0 ? 0.0 - half : half;
        return 1;
    }
    return shape_support(shape, direction, point);
}

static void take_arms(const tribo_shape *shape, const double r[9], const double center[3],
                      double scale, pair_arms *restrict out)
{
    const hull_block *hull = shape->data;
    out->count = 0;
    if (shape->type != TRIBO_SHAPE_HULL || hull->vertex_count > PAIR_ARMS) {
        return;
    }
    const double *v = hull_vertices(hull);
    const uint32_t vertices = hull->vertex_count;
    const uint32_t count = vertices > PAIR_ARMS / 2 ? PAIR_ARMS : PAIR_ARMS / 2;
    double m[9];
    for (int i = 0; i < 9; i++) {
        m[i] = scale * r[i]; /* exact */
    }
    for (uint32_t i = 0; i < vertices; i++) {
        const double x = v[3 * i] - center[0];
        const double y = v[3 * i + 1] - center[1];
        const double z = v[3 * i + 2] - center[2];
        out->x[i] = m[0] * x + m[1] * y + m[2] * z;
        out->y[i] = m[3] * x + m[4] * y + m[5] * z;
        out->z[i] = m[6] * x + m[7] * y + m[8] * z;
    }
    for (uint32_t i = vertices; i < count; i++) {
        out->x[i] = out->x[0];
        out->y[i] = out->y[0];
        out->z[i] = out->z[0];
    }
    out->count = count;
    out->vertices = vertices;
}

/* Where the greatest of four numbers is, the first of them if there are more. */
TRIBO_ALWAYS_INLINE uint32_t first_of_four(const double *from, uint32_t stride, double most)
{
    const uint32_t a = from[0] < most ? 1 : 0;
    const uint32_t b = from[stride] < most ? 1 : 0;
    const uint32_t c = from[2 * stride] < most ? 1 : 0;
    return stride * (a + (a & b) + (a & b & c));
}

/* A knockout without a branch and without a chain from vertex to vertex: heights first, then the
 * greatest of those that are 16, 8 and 4 apart, and back to where the greatest of all has come
 * from. `count` is 16 or 32. */
TRIBO_ALWAYS_INLINE uint32_t knock_out(const pair_arms *from, uint32_t count, const double d[3])
{
    double h[PAIR_ARMS];
    double of_16[16];
    double of_4[4];
    double of_2[2];
    for (uint32_t i = 0; i < count; i++) {
        h[i] = d[0] * from->x[i] + d[1] * from->y[i] + d[2] * from->z[i];
    }
    for (uint32_t i = 0; i < 16; i++) {
        of_16[i] = count == 16 || h[i] > h[count - 16 + i] ? h[i] : h[count - 16 + i];
    }
    for (uint32_t i = 0; i < 4; i++) {
        const double low = of_16[i] > of_16[4 + i] ? of_16[i] : of_16[4 + i];
        const double high = of_16[8 + i] > of_16[12 + i] ? of_16[8 + i] : of_16[12 + i];
        of_4[i] = low > high ? low : high;
    }
    for (uint32_t i = 0; i < 2; i++) {
        of_2[i] = of_4[i] > of_4[2 + i] ? of_4[i] : of_4[2 + i];
    }
    const double most = greater(of_2[0], of_2[1]);
    const uint32_t in_4 = first_of_four(of_4, 1, most);
    const uint32_t in_16 = in_4 + first_of_four(of_16 + in_4, 4, most);
    return in_16 + 16 * (h[in_16] < most ? 1u : 0u);
}

static uint32_t farthest_arm(const pair_arms *from, const double d[3])
{
    return from->count == PAIR_ARMS ? knock_out(from, 32, d) : knock_out(from, 16, d);
}

uint32_t convex_farthest(const pair_arms *arms, const double direction[3])
{
    const uint32_t k = farthest_arm(arms, direction);
    return k < arms->vertices ? k : 0;
}

static void arm_along(const pair_arms *from, const double n[3], double sign, double out[3])
{
    const double d[3] = {sign * n[0], sign * n[1], sign * n[2]};
    const uint32_t k = farthest_arm(from, d);
    out[0] = from->x[k];
    out[1] = from->y[k];
    out[2] = from->z[k];
}

/* Support point of one shape without its radius from its core, world axes, scaled; 0 if there is
 * none. */
static int part(const tribo_shape *shape, const double r[9], const double center[3], double scale,
                const double along[3], double sign, double out[3])
{
    double local[3];
    double point[3];
    rotate_back(r, along, sign, local);
    if (!bone_support(shape, local, point)) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        point[i] = (point[i] - center[i]) * scale;
    }
    tribo_mat3_apply(r, point, out);
    return 1;
}

/* Point of M farthest along the unit vector n; returns its width and notes it if it is the
 * least. */
static double support(search *s, const double n[3], double point[3])
{
    double *a = s->last[0];
    double *b = s->last[1];
    int found = 1;
    s->calls++;
    if (s->arms[0].count > 0) {
        arm_along(&s->arms[0], n, -1.0, a);
    } else {
        found = part(s->pair->a, s->pair->ra, s->center_a, s->scale, n, -1.0, a);
    }
    if (s->arms[1].count > 0) {
        arm_along(&s->arms[1], n, 1.0, b);
    } else {
        found = part(s->pair->b, s->pair->rb, s->center_b, s->scale, n, 1.0, b) && found;
    }
    if (!found) {
        s->fault = 1;
        memset(s->last, 0, sizeof s->last);
    }
    for (int i = 0; i < 3; i++) {
        point[i] = s->offset[i] + (b[i] - a[i]);
    }
    const double width = tribo_vec3_dot(n, point);
    const double limit = (1.0 + 1e-6) * s->reach;
    const int behind =
        !(tribo_vec3_dot(n, a) <= s->rounding) || !(tribo_vec3_dot(n, b) >= 0.0 - s->rounding);
    double across[3];
    tribo_vec3_subtract(b, a, across);
    if (behind || !(tribo_vec3_dot(across, across) <= limit * limit)) {
        s->fault = 1; /* the core lies beyond the farthest point, or that outside of the ball */
    }
    if (width < s->width) {
        s->width = width;
        copy(n, s->normal);
    }
    return width;
}

static void probe(search *s, const double n[3])
{
    double point[3];
    (void)support(s, n, point);
}

static int apart(const search *s)
{
    return s->width < -s->margin;
}

/* ---- libccd ---------------------------------------------------------------------------------- */

/* M as libccd's first object. Once it has been asked too often, or the answer is known, it gets
 * a point so far behind that all of its loops take the set for passed and end. A direction that
 * is not a number fails all comparisons; libccd's loops end on that if the point is not a
 * number either. */
static void bounded(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *out)
{
    search *s = (search *)(uintptr_t)object;
    double n[3];
    if (!unit(direction->v, n)) {
        const double nothing = (double)NAN;
        ccdVec3Set(out, nothing, nothing, nothing);
        return;
    }
    if (s->calls >= s->limit || s->fault || apart(s)) {
        s->stopped |= s->calls >= s->limit;
        const double far = -1e6 * s->reach;
        ccdVec3Set(out, far * n[0], far * n[1], far * n[2]);
        return;
    }
    (void)support(s, n, out->v);
}

static void nowhere(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *out)
{
    (void)object;
    (void)direction;
    ccdVec3Set(out, 0.0, 0.0, 0.0);
}

static void middle(const void *object, ccd_vec3_t *center)
{
    const search *s = object;
    copy(s->offset, center->v);
}

static void origin(const void *object, ccd_vec3_t *center)
{
    (void)object;
    ccdVec3Set(center, 0.0, 0.0, 0.0);
}

static void ask_mpr(search *s)
{
    ccd_t ccd;
    ccd_real_t depth;
    ccd_vec3_t direction;
    ccd_vec3_t point;
    CCD_INIT(&ccd);
    ccd.support1 = bounded;
    ccd.support2 = nowhere;
    ccd.center1 = middle;
    ccd.center2 = origin;
    ccd.max_iterations = 50;
    ccd.mpr_tolerance = 1e-3 * s->inner;
    s->limit = s->calls + MPR_CALLS;
    (void)ccdMPRPenetration(s, s, &ccd, &depth, &direction, &point);
}

/* ---- distance of the origin: GJK ------------------------------------------------------------- */

typedef struct simplex {
    double p[4][3]; /* points of M */
    int count;
} simplex;

static void keep(simplex *x, int i, int j, int k, int count)
{
    const simplex old = *x;
    const int from[3] = {i, j, k};
    for (int t = 0; t < count; t++) {
        copy(old.p[from[t]], x->p[t]);
    }
    x->count = count;
}

/* The nearest point of a simplex. Where that is an end or a side to rounding, what lies beyond it
 * decides: the way to a vertex that is near has noise, the one square to an edge or face has
 * none. */
typedef struct nearest {
    double v[3];
    double square;
    double noise; /* of a vertex */
    int vertex[3];
    int count;
} nearest;

static void offer(nearest *best, const double v[3], int i, int j, int k, int count)
{
    const double square = tribo_vec3_dot(v, v);
    if (square < best->square) {
        copy(v, best->v);
        best->square = square;
        best->vertex[0] = i;
        best->vertex[1] = j;
        best->vertex[2] = k;
        best->count = count;
    }
}

static void offer_segment(nearest *best, double p[4][3], int i, int j)
{
    double d[3];
    double v[3];
    tribo_vec3_subtract(p[j], p[i], d);
    const double along = 0.0 - tribo_vec3_dot(p[i], d);
    const double square = tribo_vec3_dot(d, d);
    const double room = best->noise * sqrt(square);
    if (along <= 0.0 - room || square <= room * best->noise) {
        offer(best, p[i], i, i, i, 1);
    } else if (along >= square + room) {
        offer(best, p[j], j, j, j, 1);
    } else {
        tribo_vec3_add_scaled(p[i], along / square, d, v);
        /* square to the segment, however near that is */
        tribo_vec3_add_scaled(v, 0.0 - tribo_vec3_dot(v, d) / square, d, v);
        offer(best, v, i, j, j, 2);
    }
}

/* Edges of a triangle, and across it the product of the two shorter ones: long ones that are nearly
 * parallel would lose it. Returns the square of the product of their lengths. */
static double measure(const double a[3], const double b[3], const double c[3], double e[3][3],
                      double n[3])
{
    tribo_vec3_subtract(b, a, e[0]);
    tribo_vec3_subtract(c, b, e[1]);
    tribo_vec3_subtract(a, c, e[2]);
    const double square[3] = {tribo_vec3_dot(e[0], e[0]), tribo_vec3_dot(e[1], e[1]),
                              tribo_vec3_dot(e[2], e[2])};
    const int middle = square[1] > square[0] ? 1 : 0;
    const int longest = square[2] > square[middle] ? 2 : middle;
    const int after = (longest + 1) % 3;
    const int last = (longest + 2) % 3;
    tribo_vec3_cross(e[after], e[last], n);
    return square[after] * square[last];
}

/* The triangle if the origin projects into it, else its edges. */
static void offer_triangle(nearest *best, double p[4][3], int i, int j, int k)
{
    double e[3][3];
    double n[3];
    double t[3];
    (void)measure(p[i], p[j], p[k], e, n);
    const double area = tribo_vec3_dot(n, n);
    const int at[3] = {i, j, k};
    int inside = area > 0.0;
    for (int c = 0; c < 3; c++) {
        tribo_vec3_cross(n, e[c], t); /* points inwards */
        const double out = tribo_vec3_dot(t, p[at[c]]);
        if (!(out <= 0.0 || out * out <= best->noise * best->noise * tribo_vec3_dot(t, t))) {
            offer_segment(best, p, at[c], at[(c + 1) % 3]);
            inside = 0;
        }
    }
    if (inside) {
        const double f = tribo_vec3_dot(n, p[i]) / area;
        const double v[3] = {f * n[0], f * n[1], f * n[2]};
        offer(best, v, i, j, k, 3);
    } else if (!(area > 0.0)) {
        offer_segment(best, p, i, j);
        offer_segment(best, p, j, k);
        offer_segment(best, p, k, i);
    }
}

/* 1 if the faces that see the origin have been offered, 0 if none does: it lies inside. Of a vertex
 * that is in the plane of a face to rounding, the face may see it. */
static int offer_tetrahedron(nearest *best, double p[4][3])
{
    static const int face[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    int seen = 0;
    for (int f = 0; f < 4; f++) {
        const int *at = face[f];
        double e[3][3];
        double ad[3];
        double n[3];
        const double square = measure(p[at[0]], p[at[1]], p[at[2]], e, n);
        tribo_vec3_subtract(p[at[3]], p[at[0]], ad);
        const double volume = tribo_vec3_dot(n, ad);
        const double noise = PAIR_ROUNDING * PAIR_ROUNDING * square * tribo_vec3_dot(ad, ad);
        if (volume * volume <= noise || !(volume * tribo_vec3_dot(n, p[at[0]]) < 0.0)) {
            offer_triangle(best, p, at[0], at[1], at[2]);
            seen = 1;
        }
    }
    return seen;
}

/* Nearest point of the simplex moved by -shift to the origin; keeps the vertices it needs.
 * Returns 0 if the origin lies inside. */
static int reduce(simplex *x, const double shift[3], double noise, double v[3])
{
    double p[4][3];
    nearest best = {{0.0, 0.0, 0.0}, HUGE_VAL, noise, {0, 0, 0}, 0};
    for (int i = 0; i < x->count; i++) {
        tribo_vec3_subtract(x->p[i], shift, p[i]);
    }
    if (x->count == 1) {
        offer(&best, p[0], 0, 0, 0, 1);
    } else if (x->count == 2) {
        offer_segment(&best, p, 0, 1);
    } else if (x->count == 3) {
        offer_triangle(&best, p, 0, 1, 2);
    } else if (!offer_tetrahedron(&best, p)) {
        return 0;
    }
    if (best.count == 0) {
        return 0;
    }
    keep(x, best.vertex[0], best.vertex[1], best.vertex[2], best.count);
    copy(best.v, v);
    return 1;
}

static int holds(const simplex *x, const double p[3])
{
    for (int i = 0; i < x->count; i++) {
        if (x->p[i][0] == p[0] && x->p[i][1] == p[1] && x->p[i][2] == p[2]) {
            return 1;
        }
    }
    return 0;
}

/* Whether a known point of M lies farther along n than the farthest: a user's support lies. */
static int contradicts(const search *s, const simplex *x, const double n[3], double width)
{
    int lie = 0;
    for (int i = 0; i < x->count; i++) {
        lie |= !(tribo_vec3_dot(n, x->p[i]) <= width + SAME * s->reach);
    }
    return lie;
}

/* Probes directions towards the nearest point of M - shift until the distance is known to
 * rounding, or to a twentieth of what has been won over `start`, or for some rounds neither the
 * point comes nearer nor what is open halves. Returns 0 if M - shift holds the origin. */
static int approach(search *s, simplex *x, const double shift[3], double start)
{
    double shortest = HUGE_VAL;
    double open = HUGE_VAL;
    int corners = 0;
    int stale = 0;
    for (int round = 0; round < GJK_ROUNDS && stale < STALE && !s->fault && !apart(s); round++) {
        double v[3];
        double n[3];
        double p[3];
        if (!reduce(x, shift, s->rounding, v)) {
            return 0;
        }
        const double away[3] = {0.0 - v[0], 0.0 - v[1], 0.0 - v[2]};
        if (!unit(away, n)) {
            return 0;
        }
        const double width = support(s, n, p);
        const double gap = tribo_vec3_dot(shift, n) - width; /* lower bound of the distance */
        s->fault |= contradicts(s, x, n, width);
        const double size = length(v);
        const double left = size - gap;
        tribo_vec3_add(v, shift, v);
        s->nearest = lesser(s->nearest, length(v));
        if (left <= greater(s->rounding, 0.05 * (gap - start)) || holds(x, p)) {
            break;
        }
        const int better =
            size < shortest - 64.0 * s->rounding || left < 0.5 * open || corners != x->count;
        stale = better ? 0 : stale + 1;
        open = better ? left : open;
        corners = x->count;
        shortest = lesser(shortest, size);
        if (x->count < 4) {
            copy(p, x->p[x->count++]);
        }
    }
    return 1;
}

/* ---- smooth places: Newton ------------------------------------------------------------------- */

/* Where Newton is: the width, its support point, and around it a basis of directions across n. */
typedef struct place {
    double n[3];
    double across[2][3];
    double p[3];
    double width;
    double slope[2];
    double bend[3]; /* Hessian: 00, 01, 11 */
} place;

/* The gradient of w on the sphere is the support point's part across n, its Hessian the derivative
 * of that minus w, here by differences. */
static void differentiate(search *s, place *at)
{
    double f[9];
    double column[2][2];
    basis_rows(at->n[0], at->n[1], at->n[2], f);
    for (int i = 0; i < 2; i++) {
        copy(f + 3 + 3 * i, at->across[i]);
        at->slope[i] = tribo_vec3_dot(at->p, at->across[i]);
    }
    const double slope = sqrt(at->slope[0] * at->slope[0] + at->slope[1] * at->slope[1]);
    const double delta = lesser(greater(0.01 * slope / s->small, 1e-6), 1e-3);
    for (int i = 0; i < 2; i++) {
        double n[3];
        double q[3];
        turn(at->n, at->across[i], delta, n);
        (void)support(s, n, q);
        tribo_vec3_subtract(q, at->p, q);
        column[i][0] = tribo_vec3_dot(q, at->across[0]) / delta;
        column[i][1] = tribo_vec3_dot(q, at->across[1]) / delta;
    }
    at->bend[0] = column[0][0] - at->width;
    at->bend[1] = 0.5 * (column[0][1] + column[1][0]);
    at->bend[2] = column[1][1] - at->width;
}

/* Bend of w that is there for certain, or may be: a corner looks bent without end. */
static double stiffness(const search *s)
{
    return s->width < -64.0 * s->rounding ? lesser(0.0 - s->width, s->reach) : s->reach;
}

enum { STEP_NONE, STEP_TAKEN, STEP_DONE };

static int newton_step(search *s, place *at)
{
    differentiate(s, at);
    const double *h = at->bend;
    const double *t = at->slope;
    const double det = h[0] * h[2] - h[1] * h[1];
    if (!(h[0] > 0.0 && det > 1e-12 * (h[0] + h[2]) * (h[0] + h[2]))) {
        return STEP_NONE;
    }
    const double x = (h[1] * t[1] - h[2] * t[0]) / det;
    const double y = (h[1] * t[0] - h[0] * t[1]) / det;
    const double gain = 0.0 - 0.5 * (t[0] * x + t[1] * y);
    if (gain <= 0.25 * s->rounding) {
        const double square = t[0] * t[0] + t[1] * t[1];
        return square <= 16.0 * stiffness(s) * s->rounding ? STEP_DONE : STEP_NONE;
    }
    if (x * x + y * y > 0.1) {
        return STEP_NONE;
    }
    double v[3];
    for (int i = 0; i < 3; i++) {
        v[i] = at->n[i] + x * at->across[0][i] + y * at->across[1][i];
    }
    (void)unit(v, at->n);
    const double width = support(s, at->n, at->p);
    const int better = width < at->width - 0.25 * gain;
    at->width = width;
    return better ? STEP_TAKEN : STEP_NONE;
}

static void note_basin(search *s, const basin *found)
{
    if (found->width < s->lowest.width) {
        s->lowest = *found;
    }
}

/* Returns whether a local minimum was reached and is one; 0 where the surface is flat, edged or
 * bent the wrong way. */
static int newton(search *s)
{
    place at;
    int step = STEP_TAKEN;
    copy(s->normal, at.n);
    at.width = support(s, at.n, at.p);
    for (int k = 0; k < NEWTON_STEPS && step == STEP_TAKEN && !s->fault && !apart(s); k++) {
        step = newton_step(s, &at);
    }
    if (step != STEP_DONE) {
        return 0;
    }
    s->nearest = lesser(s->nearest, length(at.p));
    basin found = {{0.0}, {{0.0}}, at.width, {at.bend[0], at.bend[1], at.bend[2]}, {0.0, 0.0}};
    copy(at.n, found.n);
    memcpy(found.across, at.across, sizeof found.across);
    note_basin(s, &found);
    return 1;
}

/* ---- descent --------------------------------------------------------------------------------- */

/* From the least width seen to a local minimum. Returns whether its surroundings are known. */
static int descend(search *s)
{
    simplex x;
    double room = 0.0;
    x.count = 1;
    (void)support(s, s->normal, x.p[0]);
    for (int k = 0; !s->fault && !apart(s); k++) {
        const double width = s->width;
        const int outside =
            width < 0.0 - 64.0 * s->rounding; /* the origin, of M: nothing has to move */
        if (k >= DESCENTS && !outside) {
            break;
        }
        /* where M is flat, the nearer to it, the longer the step */
        room = k < LONG_DESCENTS ? greater(0.5 * absolute(width), 0.1 * s->inner) : 0.25 * room;
        const double gap = greater(room, 1e6 * s->rounding);
        const double way = outside ? 0.0 : greater(width + gap, 0.0);
        const double shift[3] = {way * s->normal[0], way * s->normal[1], way * s->normal[2]};
        const double start = way > 0.0 ? way - width : HUGE_VAL;
        if (!approach(s, &x, shift, start)) {
            return 0;
        }
        if (newton(s)) {
            return 1;
        }
        if (width - s->width <= s->rounding || way == 0.0) {
            return 0;
        }
    }
    return 0;
}

/* ---- all of M: expanding polytope ------------------------------------------------------------ */

typedef struct facet {
    double n[3]; /* outward unit normal */
    double d;    /* n . x <= d inside */
    int v[3];    /* counter-clockwise seen from outside */
    int next[3]; /* facet across the side from v[i] to v[i + 1] */
    int state;
    int explored; /* a search from its normal found what lies beyond it */
} facet;

/* A THIN facet has no normal to speak of. It is never asked and goes as soon as a neighbour
 * does. */
enum { FACET_FREE, FACET_KEPT, FACET_THIN };

/* Polytope within M. */
typedef struct polytope {
    double p[POINTS][3];
    facet f[FACETS];
    int points;
    int facets; /* ever used */
    int unused; /* of them, and which */
    int free[FACETS];
    double thin; /* heights of triangles that count as none */
} polytope;

/* A side of the hole that a new point tears: it stays behind with facet `outer`. */
typedef struct rim {
    int from;
    int to;
    int outer;
} rim;

/* The corner that is nearest to the origin: of long needles the others say little of the plane. */
static int nearest_of(const polytope *x, int a, int b, int c)
{
    const double aa = tribo_vec3_dot(x->p[a], x->p[a]);
    const double bb = tribo_vec3_dot(x->p[b], x->p[b]);
    const double cc = tribo_vec3_dot(x->p[c], x->p[c]);
    return aa <= bb && aa <= cc ? a : bb <= cc ? b : c;
}

static void set_facet(polytope *x, int which, int a, int b, int c)
{
    facet *f = &x->f[which];
    double ab[3];
    double ac[3];
    double n[3];
    const int at = nearest_of(x, a, b, c);
    const double *p = x->p[at];
    tribo_vec3_subtract(x->p[at == a ? b : at == b ? c : a], p, ab);
    tribo_vec3_subtract(x->p[at == a ? c : at == b ? a : b], p, ac);
    tribo_vec3_cross(ab, ac, n);
    const double longest = greater(tribo_vec3_dot(ab, ab), tribo_vec3_dot(ac, ac));
    const double square = tribo_vec3_dot(n, n);
    f->v[0] = a;
    f->v[1] = b;
    f->v[2] = c;
    const int is_measured = square > 1e-200 && square < 1e200;
    f->state = is_measured && square > x->thin * x->thin * longest ? FACET_KEPT : FACET_THIN;
    f->explored = 0;
    f->d = HUGE_VAL;
    if (f->state == FACET_KEPT) {
        tribo_vec3_scale(1.0 / sqrt(square), n, f->n);
        f->d = tribo_vec3_dot(f->n, p);
    }
}

static int free_facet(polytope *x)
{
    return x->unused > 0 ? x->free[--x->unused] : x->facets < FACETS ? x->facets++ : -1;
}

/* Frees the facets that see point p or lie in a plane with it, from one that sees it, and lists the
 * rim. Returns its length. */
static int tear(polytope *x, int first, const double p[3], double tolerance, rim *edges)
{
    int seen[FACETS];
    int depth = 1;
    int count = 0;
    seen[0] = first;
    x->f[first].state = FACET_FREE;
    for (int k = 0; k < depth; k++) {
        const facet *f = &x->f[seen[k]];
        for (int i = 0; i < 3; i++) {
            facet *other = &x->f[f->next[i]];
            if (other->state == FACET_THIN ||
                (other->state == FACET_KEPT &&
                 tribo_vec3_dot(other->n, p) > other->d - tolerance)) {
                other->state = FACET_FREE;
                seen[depth++] = f->next[i];
            } else if (other->state == FACET_KEPT) {
                const rim edge = {f->v[i], f->v[i == 2 ? 0 : i + 1], f->next[i]};
                edges[count++] = edge;
            }
        }
    }
    for (int k = 0; k < depth; k++) {
        x->free[x->unused++] = seen[k];
    }
    return count;
}

static void link_outer(polytope *x, int outer, int from, int to, int inner)
{
    facet *f = &x->f[outer]; /* it has the side, and nobody knows in which place */
    const int second = (f->v[1] == to) & (f->v[2] == from);
    const int third = (f->v[2] == to) & (f->v[0] == from);
    f->next[second + 2 * third] = inner;
}

/* Joins the rim to a new point. Returns 0 if the rim is no simple loop, as rounding may have it. */
static int mend(polytope *x, int point, const rim *edges, int count)
{
    int starts[POINTS];
    for (int k = 0; k < count; k++) {
        starts[edges[k].from] = starts[edges[k].to] = -1;
    }
    for (int k = 0; k < count; k++) {
        const int at = free_facet(x);
        if (at < 0 || starts[edges[k].from] >= 0) {
            return 0;
        }
        starts[edges[k].from] = at;
        set_facet(x, at, edges[k].from, edges[k].to, point);
        x->f[at].next[0] = edges[k].outer;
        link_outer(x, edges[k].outer, edges[k].from, edges[k].to, at);
    }
    for (int k = 0; k < count; k++) {
        const int at = starts[edges[k].from];
        const int after = starts[edges[k].to];
        if (after < 0) {
            return 0;
        }
        x->f[at].next[1] = after;
        x->f[after].next[2] = at;
    }
    return count >= 3;
}

/* Adds a point of M that `facet` sees. */
static int grow(polytope *x, int first, const double p[3], double tolerance)
{
    rim edges[FACETS];
    if (x->points == POINTS) {
        return 0;
    }
    const int point = x->points++;
    copy(p, x->p[point]);
    return mend(x, point, edges, tear(x, first, p, tolerance, edges));
}

/* Adds a point of M if it lies outside. */
static int grow_any(polytope *x, const double p[3], double tolerance)
{
    int first = -1;
    double most = tolerance;
    for (int i = 0; i < x->facets; i++) {
        const double above = tribo_vec3_dot(x->f[i].n, p) - x->f[i].d;
        if (x->f[i].state == FACET_KEPT && above > most) {
            most = above;
            first = i;
        }
    }
    return first < 0 || grow(x, first, p, tolerance);
}

/* Farther of the two support points along +-v from the plane or line through p, in v's measure. */
static double farther(search *s, const double v[3], const double p[3], double out[3])
{
    double n[3];
    double far[2][3];
    double away[2];
    if (!unit(v, n)) {
        return 0.0;
    }
    const double back[3] = {0.0 - n[0], 0.0 - n[1], 0.0 - n[2]};
    away[0] = support(s, n, far[0]) - tribo_vec3_dot(n, p);
    away[1] = support(s, back, far[1]) + tribo_vec3_dot(n, p);
    const int which = away[1] > away[0] ? 1 : 0;
    copy(far[which], out);
    return away[which];
}

/* The four facets of the tetrahedron of the first four points; 0 if it is flat. */
static int tetrahedron(search *s, polytope *x)
{
    static const int corner[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {0, 2, 3}};
    static const int next[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {0, 2, 1}};
    double e[3][3];
    double n[3];
    for (int i = 0; i < 3; i++) {
        tribo_vec3_subtract(x->p[i + 1], x->p[0], e[i]);
    }
    tribo_vec3_cross(e[0], e[1], n);
    if (tribo_vec3_dot(n, e[2]) >
        0.0) { /* corner is right for a fourth point below the first three */
        copy(x->p[1], n);
        copy(x->p[2], x->p[1]);
        copy(n, x->p[2]);
    }
    x->points = x->facets = 4;
    x->unused = 0;
    x->thin = 16.0 * s->rounding;
    int kept = 0;
    for (int i = 0; i < 4; i++) {
        set_facet(x, i, corner[i][0], corner[i][1], corner[i][2]);
        memcpy(x->f[i].next, next[i], sizeof next[i]);
        kept += x->f[i].state == FACET_KEPT ? 1 : 0;
    }
    return kept == 4;
}

/* Tetrahedron of support points, as wide as M is; 0 if M is flat. */
static int wide_polytope(search *s, polytope *x)
{
    double f[9];
    double e[3];
    double n[3];
    basis_rows(s->normal[0], s->normal[1], s->normal[2], f);
    (void)support(s, f, x->p[0]);
    (void)farther(s, f, x->p[0], x->p[1]);
    tribo_vec3_subtract(x->p[1], x->p[0], e);
    tribo_vec3_cross(e, f + 3, n);
    (void)farther(s, n, x->p[0], x->p[2]);
    tribo_vec3_subtract(x->p[2], x->p[0], f);
    tribo_vec3_cross(e, f, n);
    return farther(s, n, x->p[0], x->p[3]) > 16.0 * s->rounding && tetrahedron(s, x);
}

/* Whether the surroundings of the least width seen are known. */
static int is_known(const search *s)
{
    return s->lowest.width <= s->width + s->rounding;
}

/* Support points of three directions around the best one: of a polytope those of its corners there,
 * else so near that the facet between them lies as deep as it. Without them a smooth place would
 * have to be halved down to their size. */
static void ring(search *s, double p[3][3])
{
    if (s->has_facet) {
        memcpy(p, s->facet, sizeof s->facet);
        return;
    }
    static const double turn[3][2] = {{1.0, 0.0}, {-0.5, 0.75}, {-0.5, -0.75}};
    double f[9];
    basis_rows(s->normal[0], s->normal[1], s->normal[2], f);
    const double delta = s->flat ? WIDE : is_known(s) ? sqrt(0.006 * s->width / s->reach) : 1e-7;
    for (int i = 0; i < 3; i++) {
        double n[3];
        const double x = delta * turn[i][0];
        const double y = delta * turn[i][1];
        const double v[3] = {f[0] + x * f[3] + y * f[6], f[1] + x * f[4] + y * f[7],
                             f[2] + x * f[5] + y * f[8]};
        (void)unit(v, n);
        (void)support(s, n, p[i]);
    }
}

/* The ring and the point behind it; something wider if that is flat, and the ring on top. */
static int first_polytope(search *s, polytope *x)
{
    double p[3][3];
    const double back[3] = {0.0 - s->normal[0], 0.0 - s->normal[1], 0.0 - s->normal[2]};
    ring(s, p);
    memcpy(x->p, p, sizeof p);
    (void)support(s, back, x->p[3]);
    if (tetrahedron(s, x)) {
        return 1;
    }
    if (!wide_polytope(s, x)) {
        return 0;
    }
    int whole = 1;
    for (int i = 0; i < 3 && whole; i++) {
        whole = grow_any(x, p[i], s->rounding);
    }
    return whole || wide_polytope(s, x);
}

/* ---- kinks ----------------------------------------------------------------------------------- */

typedef struct support_face {
    double p[3 * TRIBO_MAX_FACE]; /* world axes, scaled, from the core */
    double normal[3];             /* of the axis: from B to A */
    uint32_t count;
    const tribo_shape *shape;
    const double *r;
    double sign; /* of the axis as the shape sees it */
} support_face;

static void face_of(const search *s, const tribo_shape *shape, const double r[9],
                    const double center[3], double sign, const pair_arms *arms, support_face *face)
{
    const double direction[3] = {sign * s->normal[0], sign * s->normal[1], sign * s->normal[2]};
    double local[3];
    double normal[3];
    double points[3 * TRIBO_MAX_FACE];
    uint32_t feature;
    rotate_back(r, s->normal, sign, local);
    face->shape = shape;
    face->r = r;
    face->sign = sign;
    face->count = arms->count > 0 ? shape_face_at(shape, convex_farthest(arms, direction), local,
                                                  points, normal, &feature)
                                  : shape_face(shape, local, points, normal, &feature);
    for (uint32_t i = 0; i < face->count; i++) {
        for (int c = 0; c < 3; c++) {
            points[3 * i + (uint32_t)c] = (points[3 * i + (uint32_t)c] - center[c]) * s->scale;
        }
        tribo_mat3_apply(r, points + 3 * i, face->p + 3 * i);
    }
    double world[3];
    tribo_mat3_apply(r, normal, world);
    for (int i = 0; i < 3; i++) {
        face->normal[i] = sign * world[i];
    }
}

/* Takes n for the axis if it is as good as the best to rounding: a face's normal is worth more
 * than digits of an iteration. Returns whether it did. */
static int prefer(search *s, const double v[3])
{
    double n[3];
    double point[3];
    if (!unit(v, n)) {
        return 0;
    }
    const double width = s->width;
    const double found = support(s, n, point);
    if (found <= width + 4.0 * s->rounding) {
        copy(n, s->normal);
        s->width = found;
        return 1;
    }
    return 0;
}

static uint32_t edge(const support_face *face, uint32_t i, double e[3])
{
    tribo_vec3_subtract(face->p + 3 * ((i + 1) % face->count), face->p + 3 * i, e);
    return unit(e, e) ? 1 : 0;
}

/* Directions in which w is kinked: those n with n . axis = along, a great circle square to an edge
 * or, round a cone, the small circle square to its lines. A user's face of two points may be either:
 * the edge is asked for anew wherever the crease is followed to. */
typedef struct crease {
    double axis[3];
    double along;
    const support_face *user;
} crease;

/* The edge that a user tells in a direction, with the sense of the one before. */
static void ask_edge(crease *k, const double v[3])
{
    double local[3];
    double points[3 * TRIBO_MAX_FACE];
    double normal[3];
    double e[3];
    uint32_t feature;
    rotate_back(k->user->r, v, k->user->sign, local);
    if (shape_face(k->user->shape, local, points, normal, &feature) != 2) {
        return;
    }
    tribo_vec3_subtract(points + 3, points, e);
    tribo_mat3_apply(k->user->r, e, e);
    if (unit(e, e)) {
        tribo_vec3_scale(copysign(1.0, tribo_vec3_dot(e, k->axis)), e, k->axis);
    }
}

/* The nearest of these directions. */
static void onto(crease *k, const double v[3], double n[3])
{
    if (k->user != NULL) {
        ask_edge(k, v);
    }
    double across[3];
    const double along = tribo_vec3_dot(v, k->axis);
    const double side = sqrt(1.0 - k->along * k->along);
    for (int i = 0; i < 3; i++) {
        across[i] = v[i] - along * k->axis[i];
    }
    (void)unit(across, across);
    for (int i = 0; i < 3; i++) {
        n[i] = k->along * k->axis[i] + side * across[i];
    }
    (void)unit(n, n); /* beside the axis what is left across it is not square to it */
}

/* Crease i of a face: that of its edge, or of the line of a cone. Returns whether it is one and the
 * axis lies on it but for `most`. */
static int crease_of(const search *s, const support_face *x, uint32_t i, double most, crease *k)
{
    k->user = x->shape->type == TRIBO_SHAPE_CONVEX && x->count == 2 ? x : NULL;
    if (x->shape->type == TRIBO_SHAPE_CONE && x->count == 2) {
        const double slant[3] = {x->shape->size[0], 2.0 * x->shape->size[1], 0.0};
        double n[3];
        (void)unit(slant, n);
        k->along = n[0];
        for (int c = 0; c < 3; c++) {
            k->axis[c] = x->sign * x->r[3 * c + 2];
        }
    } else if (edge(x, i, k->axis)) {
        k->along = 0.0;
    } else {
        return 0;
    }
    return absolute(tribo_vec3_dot(k->axis, s->normal) - k->along) <= most;
}

/* The crease of a face that is nearest to the axis; 0 if none is near. */
static int nearest_crease(const search *s, const support_face *x, crease *best)
{
    double least = 0.1;
    int found = 0;
    for (uint32_t i = 0; i < x->count && x->count > 1; i++) {
        crease k;
        if (crease_of(s, x, i, least, &k)) {
            least = absolute(tribo_vec3_dot(k.axis, s->normal) - k.along);
            *best = k;
            found = 1;
        }
    }
    return found;
}

/* The direction that lies on two creases, of the two the one on the side of the axis; 0 if they do
 * not meet there. */
static int meeting(const search *s, const crease *k, const crease *l, double n[3])
{
    double c[3];
    tribo_vec3_cross(k->axis, l->axis, c);
    const double cosine = tribo_vec3_dot(k->axis, l->axis);
    const double square = tribo_vec3_dot(c, c);
    const double facing = tribo_vec3_dot(c, s->normal);
    if (!(absolute(facing) > 1e-6)) {
        return 0;
    }
    const double x = (k->along - cosine * l->along) / square;
    const double y = (l->along - cosine * k->along) / square;
    const double left = (1.0 - (x * k->along + y * l->along)) / square;
    if (!(left >= 0.0)) {
        return 0;
    }
    const double z = copysign(sqrt(left), facing);
    for (int i = 0; i < 3; i++) {
        n[i] = x * k->axis[i] + y * l->axis[i] + z * c[i];
    }
    return 1;
}

/* The point of M between one of A and one of B. */
static void note_corner(search *s, int at, const double a[3], const double b[3])
{
    for (int c = 0; c < 3; c++) {
        s->facet[at][c] = s->offset[c] + (b[c] - a[c]);
    }
}

/* Whether the corners of a face are points of M: what a user says of his is not trusted so far. */
static int is_of_bone(const support_face *face)
{
    return face->shape->type != TRIBO_SHAPE_CONVEX && radius_of(face->shape) == 0.0;
}

/* Takes the normal of a face. With the farthest point of the other shape it is a facet of M. */
static int prefer_face(search *s, const support_face *face, int side)
{
    if (face->count < 3 || !prefer(s, face->normal)) {
        return 0;
    }
    s->has_facet = is_of_bone(face);
    for (uint32_t k = 0; k < 3; k++) {
        const double *corner = face->p + 3 * (k * face->count / 3);
        note_corner(s, (int)k, side == 0 ? corner : s->last[0], side == 0 ? s->last[1] : corner);
    }
    return 1;
}

/* Two edges that cross are a facet too. */
static void note_edges(search *s, const support_face *a, uint32_t i, const support_face *b,
                       uint32_t j)
{
    const double *to_a = a->p + 3 * ((i + 1) % a->count);
    const double *to_b = b->p + 3 * ((j + 1) % b->count);
    s->has_facet = s->flat && is_of_bone(a) && is_of_bone(b); /* a round shape has chords here */
    note_corner(s, 0, a->p + 3 * i, b->p + 3 * j);
    note_corner(s, 1, to_a, b->p + 3 * j);
    note_corner(s, 2, to_a, to_b);
}

/* Where those creases of both faces meet on which the axis lies nearly. */
static int prefer_edges(search *s, const support_face *a, const support_face *b)
{
    const double square = 1e-3;
    for (uint32_t i = 0; i < a->count; i++) {
        crease k;
        if (!crease_of(s, a, i, square, &k)) {
            continue;
        }
        for (uint32_t j = 0; j < b->count; j++) {
            crease l;
            double n[3];
            if (crease_of(s, b, j, square, &l) && meeting(s, &k, &l, n) && prefer(s, n)) {
                note_edges(s, a, i, b, j);
                return 1;
            }
        }
    }
    return 0;
}

static void faces_of(const search *s, support_face *a, support_face *b)
{
    face_of(s, s->pair->a, s->pair->ra, s->center_a, -1.0, &s->arms[0], a);
    face_of(s, s->pair->b, s->pair->rb, s->center_b, 1.0, &s->arms[1], b);
}

/* The normals of the faces that meet, or of the edges. Returns whether one of them is as good
 * as the best. */
static int snap(search *s)
{
    support_face a;
    support_face b;
    faces_of(s, &a, &b);
    return prefer_face(s, &a, 0) || prefer_face(s, &b, 1) ||
           (a.count > 1 && b.count > 1 && prefer_edges(s, &a, &b));
}

/* The way along them. */
static void tangent(const crease *k, const double n[3], double t[3])
{
    tribo_vec3_cross(k->axis, n, t);
    (void)unit(t, t);
}

static void turn_onto(crease *k, const double n[3], const double t[3], double x, double out[3])
{
    double v[3];
    turn(n, t, x, v);
    onto(k, v, out);
}

/* A step downhill along a kink where Newton's would lead astray. Returns whether there is one. */
static int stride(search *s, crease *k, const double t[3], double slope, double n[3], double p[3],
                  double *width)
{
    for (double x = copysign(0.5, 0.0 - slope); absolute(x) > 1e-3; x *= 0.25) {
        crease l = *k;
        double m[3];
        double q[3];
        turn_onto(&l, n, t, x, m);
        const double found = support(s, m, q);
        if (found < *width - s->rounding) {
            *k = l;
            copy(m, n);
            copy(q, p);
            *width = found;
            return 1;
        }
    }
    return 0;
}

/* Newton along a kink, where w is smooth. Returns the bend of w there; 0 if it did not end in a
 * minimum. */
static double along_ridge(search *s, crease *k, double n[3])
{
    double t[3];
    double p[3];
    double width = support(s, n, p);
    for (int step = 0; step < NEWTON_STEPS && !s->fault && !apart(s); step++) {
        crease l = *k;
        double m[3];
        double q[3];
        double after[3];
        tangent(k, n, t);
        const double slope = tribo_vec3_dot(p, t);
        const double delta = lesser(greater(0.01 * absolute(slope) / s->small, 1e-6), 1e-3);
        turn_onto(&l, n, t, delta, m);
        tangent(&l, m, after);
        (void)support(s, m, q);
        const double bend = (tribo_vec3_dot(q, after) - slope) / delta;
        if (!(bend > 1e-6 * s->small) || absolute(slope) > 0.5 * bend) {
            if (!s->patient || !stride(s, k, t, slope, n, p, &width)) {
                return 0.0;
            }
            continue;
        }
        const double gain = 0.5 * slope * slope / bend;
        if (gain <= 0.25 * s->rounding) {
            return bend;
        }
        turn_onto(k, n, t, 0.0 - slope / bend, m); /* ends the search if it is no better */
        const double found = support(s, m, p);
        if (!(found < width - 0.25 * gain)) {
            return 0.0;
        }
        width = found;
        copy(m, n);
    }
    return 0.0;
}

/* Where an edge meets a curved place w is kinked across the edge. Returns whether a local minimum
 * was reached: the support points on both sides of the kink then have the foot of the origin
 * between them. */
static int ridge(search *s, crease *k)
{
    double n[3];
    double t[3];
    double e[3];
    double m[3];
    double left[3];
    double right[3];
    const double tilt = 3e-8;
    onto(k, s->normal, n);
    const double bend = along_ridge(s, k, n);
    if (!(bend > 0.0)) {
        return 0;
    }
    tangent(k, n, t);
    tribo_vec3_cross(n, t, e);
    turn(n, e, tilt, m);
    const double width = support(s, m, right);
    turn(n, e, 0.0 - tilt, m);
    (void)support(s, m, left);
    const double after = tribo_vec3_dot(right, e);
    const double before = tribo_vec3_dot(left, e);
    const double slip = (tribo_vec3_dot(left, t) * after - tribo_vec3_dot(right, t) * before) /
                        greater(after - before, s->rounding);
    const double step =
        tribo_vec3_dot(left, n) - tribo_vec3_dot(right, n); /* another kink nearby */
    if (!(after > 0.0 && before < 0.0 && absolute(step) <= 4.0 * s->rounding &&
          0.5 * slip * slip <= lesser(bend, stiffness(s)) * s->rounding &&
          width <= s->width + tilt * s->reach)) {
        return 0;
    }
    basin found = {{0.0}, {{0.0}}, width, {bend, 0.0, 0.0}, {after, before}};
    copy(n, found.n);
    copy(t, found.across[0]);
    copy(e, found.across[1]);
    note_basin(s, &found);
    return 1;
}

/* Edges against curved places. */
static int climb_ridges(search *s)
{
    support_face a;
    support_face b;
    crease k;
    faces_of(s, &a, &b);
    return (nearest_crease(s, &a, &k) && ridge(s, &k)) ||
           (nearest_crease(s, &b, &k) && ridge(s, &k));
}

/* ---- the search ------------------------------------------------------------------------------ */

/* Whether a shape without its radius is a polytope. */
static int is_flat(const tribo_shape *shape)
{
    return radius_of(shape) > 0.0 || shape->type == TRIBO_SHAPE_BOX ||
           shape->type == TRIBO_SHAPE_HULL;
}

static void begin(search *s, const pair_query *pair)
{
    double inner[2];
    double outer[2];
    double a[3];
    double b[3];
    shape_core(pair->a, s->center_a, &inner[0], &outer[0]);
    shape_core(pair->b, s->center_b, &inner[1], &outer[1]);
    s->pair = pair;
    s->scale = power_of_two(scale_exponent(lesser(outer[0], outer[1])));
    take_arms(pair->a, pair->ra, s->center_a, s->scale, &s->arms[0]);
    take_arms(pair->b, pair->rb, s->center_b, s->scale, &s->arms[1]);
    tribo_mat3_apply(pair->ra, s->center_a, a);
    tribo_mat3_apply(pair->rb, s->center_b, b);
    for (int i = 0; i < 3; i++) {
        s->offset[i] = (pair->offset[i] + (b[i] - a[i])) * s->scale;
    }
    s->radius = (radius_of(pair->a) + radius_of(pair->b)) * s->scale;
    s->margin = pair->margin * s->scale + s->radius;
    s->flat = is_flat(pair->a) && is_flat(pair->b);
    s->small = lesser(outer[0], outer[1]) * s->scale;
    s->inner = lesser(inner[0], inner[1]) * s->scale;
    s->inner = s->inner > 0.0 ? s->inner : 0.05 * s->small; /* a user's shape tells none */
    s->reach = (outer[0] + outer[1]) * s->scale;
    s->rounding = 4.0 * TRIBO_EPS * s->reach;
    s->width = HUGE_VAL;
    s->nearest = HUGE_VAL;
    memset(&s->lowest, 0, sizeof s->lowest);
    s->lowest.width = HUGE_VAL;
    s->patient = 0;
    s->has_facet = 0;
    s->calls = 0;
    s->limit = 0;
    s->stopped = 0;
    s->inside = 0;
    s->fault = 0;
}

/* Along the line of the cores, and all axes of both bodies where the cores are so near that it
 * says nothing. */
static void first_look(search *s)
{
    double n[3];
    const double away[3] = {0.0 - s->offset[0], 0.0 - s->offset[1], 0.0 - s->offset[2]};
    const double start[3] = {0.0, 0.0, 1.0};
    probe(s, unit(away, n) ? n : start);
}

static void axes_of(search *s, const double r[9])
{
    for (int i = 0; i < 6; i++) {
        const double sign = i < 3 ? 1.0 : -1.0;
        const double n[3] = {sign * r[i % 3], sign * r[3 + i % 3], sign * r[6 + i % 3]};
        probe(s, n);
    }
}

/* From the least width seen to a local minimum. */
static void settle(search *s)
{
    if (!s->flat && (newton(s) || climb_ridges(s))) {
        return; /* a polytope is nowhere smooth */
    }
    if (!descend(s) && !s->flat && !s->fault && !apart(s)) {
        (void)climb_ridges(s); /* the crease was too far away before */
    }
}

/* Again while it is worth it: along a flat valley descents are many. */
static void settle_well(search *s)
{
    double before;
    int again = SETTLEMENTS;
    do {
        before = s->width;
        settle(s);
    } while (--again > 0 && before - s->width > WORTH * absolute(before) && !s->fault && !apart(s));
}

/* Whether M may go on beyond a facet that has no normal. */
static int has_thin(const polytope *x)
{
    int thin = 0;
    for (int i = 0; i < x->facets; i++) {
        thin = thin || x->f[i].state == FACET_THIN;
    }
    return thin;
}

static int nearest_facet(const polytope *x)
{
    int best = -1;
    for (int i = 0; i < x->facets; i++) {
        const facet *f = &x->f[i];
        if (f->state == FACET_KEPT && !f->explored && (best < 0 || f->d < x->f[best].d)) {
            best = i;
        }
    }
    return best;
}

/* Whether what is known around the least width explains the width along a direction. */
static int explains(const search *s, const double n[3], double width)
{
    const basin *at = &s->lowest;
    const double along = tribo_vec3_dot(n, at->n);
    if (!is_known(s) || !(along > SAME_WAY)) {
        return 0;
    }
    const double x = tribo_vec3_dot(n, at->across[0]) / along;
    const double y = tribo_vec3_dot(n, at->across[1]) / along;
    const double rise = 0.5 * (at->bend[0] * x * x + at->bend[2] * y * y) + at->bend[1] * x * y +
                        at->slope[y > 0.0 ? 0 : 1] * y;
    return absolute(width - at->width - rise) <= 0.25 * rise + 4.0 * s->rounding;
}

/* Whether M is so near beyond a facet that a search from there finds what is lower. A polytope is
 * better followed to its end, and so is a kink of which nothing is known. */
static int is_near(const search *s, const facet *f)
{
    const double share = !is_known(s)                                   ? 0.9999999
                         : tribo_vec3_dot(f->n, s->lowest.n) > SAME_WAY ? 0.995
                                                                        : 0.9999;
    return !s->flat && f->d >= share * s->width;
}

/* A search from one direction; the best known stays if it finds nothing better. */
static void explore(search *s, const double n[3])
{
    double known[3];
    const double width = s->width;
    copy(s->normal, known);
    s->width = HUGE_VAL;
    probe(s, n);
    settle(s);
    (void)snap(s);
    if (!(s->width < width)) {
        s->width = width;
        copy(known, s->normal);
    }
}

/* Settles what lies beyond a facet whose normal has this width. Returns 0 where that is too much
 * work. */
static int look_beyond(search *s, facet *f, double width, int *explored)
{
    f->explored = 1;
    if (explains(s, f->n, width)) {
        return 1;
    }
    if (*explored == EXPLORED || s->calls > CALLS) {
        return 0;
    }
    s->patient = *explored >= FEW;
    explore(s, f->n);
    ++*explored;
    return 1;
}

enum { SURVEY_FAILED, SURVEY_NEAR, SURVEY_EXACT };

/* Looks at M where the polytope in it comes nearest to the origin, until that is as far as the
 * least width. EXACT if it is so everywhere: then that is the least of all. */
static int survey(search *s)
{
    polytope x;
    int explored = 0;
    int again = 0; /* from a polytope of other points: near each other they may make no hull */
    int outcome = SURVEY_EXACT;
    if (!first_polytope(s, &x)) {
        return SURVEY_FAILED;
    }
    while (!s->fault && !apart(s)) {
        double p[3];
        const int at = nearest_facet(&x);
        if (at < 0 || s->width - x.f[at].d <= greater(16.0 * s->rounding, 1e-10 * s->width)) {
            return has_thin(&x) ? SURVEY_NEAR : outcome;
        }
        facet *f = &x.f[at];
        const double width = support(s, f->n, p);
        s->fault |= width < f->d - SAME * s->reach;
        if (x.points == POINTS || is_near(s, f)) {
            outcome = SURVEY_NEAR;
            if (!look_beyond(s, f, width, &explored)) {
                return SURVEY_FAILED;
            }
        } else if (width - f->d > s->rounding && !grow(&x, at, p, s->rounding)) {
            if (again++ > 0 || !wide_polytope(s, &x)) {
                return SURVEY_FAILED;
            }
        }
    }
    return SURVEY_FAILED;
}

/* M as a whole, once the best is a local minimum or, at a kink, may be one. */
static void look_around(search *s, int kink)
{
    const double before = s->width;
    if (length(s->offset) < 0.1 * s->small) {
        axes_of(s, s->pair->ra);
        axes_of(s, s->pair->rb);
    }
    const int outcome = survey(s);
    s->stopped |= outcome == SURVEY_FAILED;
    const int outside = s->width < -64.0 * s->rounding; /* where facets bound nothing */
    s->inside = outcome == SURVEY_EXACT && !outside;
    if (outside || (outcome != SURVEY_EXACT && (kink || s->width < before))) {
        settle_well(s);
    }
}

/* Bodies that are apart, or may be: what was moved by much more says little of a short way. */
static void meet(search *s)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    simplex x;
    x.count = 1;
    (void)support(s, s->normal, x.p[0]);
    (void)approach(s, &x, none, HUGE_VAL);
}

/* Whether the bodies may be apart, or farther apart than the best direction says. */
static int may_part(const search *s)
{
    return !s->inside && s->width < TOUCHING * s->small &&
           s->nearest + s->width > 16.0 * s->rounding;
}

/* A local minimum, unless a look at all of a polytope is cheaper. Returns whether it may be none
 * because M is kinked there. */
static int find_minimum(search *s)
{
    const int touching = s->width <= 64.0 * s->rounding;
    const int kink = !touching && snap(s);
    if (touching || (!s->flat && !kink)) {
        settle(s);
    }
    return kink;
}

static void least_width(search *s)
{
    first_look(s);
    if (apart(s) || s->fault) {
        return;
    }
    ask_mpr(s);
    if (apart(s) || s->fault) {
        return;
    }
    const int kink = find_minimum(s);
    const double width = s->width;
    if (width > 64.0 * s->rounding && !s->fault) {
        look_around(s, kink || s->flat);
    }
    if (may_part(s) && !s->fault && !apart(s)) {
        meet(s);
    }
    if (!s->fault && !apart(s) && (!kink || s->width < width)) {
        (void)snap(s);
    }
}

tribo_status convex_axis(const pair_query *query, pair_axis *axis, tribo_collide_info *info)
{
    search s;
    pair_arms own[2];
    s.arms = query->arms != NULL ? query->arms : own;
    begin(&s, query);
    least_width(&s);
    info->supports += 2 * s.calls;
    info->capped += s.stopped ? 1 : 0;
    if (s.fault) {
        return TRIBO_ERROR_SUPPORT;
    }
    copy(s.normal, axis->normal);
    axis->distance = (0.0 - s.width - s.radius) / s.scale;
    return TRIBO_OK;
}
