/* Properties of include/tribo/collide.h. */
#include <math.h>
#include <string.h>

#include "support/reference.h"
#include "support/shapes.h"

/* Where the direction is held to 1 %. */
#define LEAST_DEPTH 1e-6 /* of the smaller size */
#define WIDEST 1e4       /* aspect */
#define LEVEL 1e-5       /* of the size: so much the deepest corner may be deeper than what stays */

enum { MANIFOLDS = 2 * SHAPES_TRIANGLES * SHAPES_CHILDREN };

static long double wide(double x)
{
    return (long double)x;
}

/* ---- pairs -------------------------------------------------------------------------------- */

typedef struct pair {
    made_shape a;
    made_shape b;
    tribo_pose pose_a;
    tribo_pose pose_b;
    tribo_collide_options options;
    double size;   /* of both, and how far they are apart: what rounding is relative to */
    double small;  /* the lesser half-size */
    double aspect; /* greatest size by the least half-size */
} pair;

static pair first;
static pair other;

/* Room for what a call says. */
typedef struct answer {
    tribo_status status;
    uint32_t count;
    tribo_manifold manifolds[MANIFOLDS];
} answer;

static void ask(const pair *p, answer *out)
{
    memset(out->manifolds, 0, sizeof out->manifolds);
    out->count = 0;
    out->status = tribo_collide_shapes(&p->a.shape, &p->pose_a, &p->b.shape, &p->pose_b,
                                       &p->options, MANIFOLDS, out->manifolds, &out->count, NULL);
}

/* max d . x over a shape at a pose, from the position of its pose. */
static long double reach(const tribo_shape *shape, const tribo_pose *pose, const long double d[3])
{
    long double r[9];
    long double own[3];
    shapes_rotation(pose, r);
    for (int i = 0; i < 3; i++) {
        own[i] = r[i] * d[0] + r[3 + i] * d[1] + r[6 + i] * d[2];
    }
    if (shape->type != TRIBO_SHAPE_HALFSPACE) {
        return shapes_extent(shape, own);
    }
    /* bounded along its normal alone */
    long double cosine = 0.0L;
    for (int i = 0; i < 3; i++) {
        cosine += own[i] * wide(shape->size[i]);
    }
    return cosine > 1.0L - 1e-9L ? wide(shape->size[3]) : (long double)INFINITY;
}

/* Gap of the shapes along a direction from B to A: n . (a - b) at least, for all a in A, b in B. */
static long double gap(const tribo_shape *a, const tribo_pose *pose_a, const tribo_shape *b,
                       const tribo_pose *pose_b, const long double n[3])
{
    const long double back[3] = {-n[0], -n[1], -n[2]};
    long double between = 0.0L;
    for (int i = 0; i < 3; i++) {
        between += n[i] * (wide(pose_a->position[i]) - wide(pose_b->position[i]));
    }
    return between - reach(a, pose_a, back) - reach(b, pose_b, n);
}

/* A point of the shape at its pose: a support point, drawn towards the origin of its axes. */
static void point_of(property_trial *t, const made_shape *s, const tribo_pose *pose,
                     const double n[3], double share, double out[3])
{
    double own[3];
    double p[3] = {0.0, 0.0, 0.0};
    (void)t;
    tribo_quat_rotate_inverse(pose->orientation, n, own);
    if (s->shape.type == TRIBO_SHAPE_HALFSPACE) {
        tribo_vec3_scale(s->shape.size[3], s->shape.size, p);
    } else if (s->shape.type == TRIBO_SHAPE_MESH) {
        memcpy(p, s->points, sizeof p);
    } else if (s->shape.type == TRIBO_SHAPE_COMPOUND) {
        const tribo_child *child = &s->children[0];
        tribo_quat_rotate_inverse(child->pose.orientation, own, own);
        (void)tribo_shape_support(&child->shape, own, p);
        tribo_quat_rotate(child->pose.orientation, p, p);
        tribo_vec3_add(p, child->pose.position, p);
    } else {
        (void)tribo_shape_support(&s->shape, own, p);
    }
    tribo_vec3_scale(share, p, p);
    tribo_quat_rotate(pose->orientation, p, out);
}

enum { TOUCHING, DEEP, ANYWHERE, CONCENTRIC, ARRANGEMENTS };

/* B goes where a point of it and one of A are nearly the same. */
static void place(property_trial *t, pair *p)
{
    double n[3];
    double back[3];
    double at_a[3];
    double at_b[3];
    const uint32_t arrangement = make_choice(t, "arrangement", ARRANGEMENTS);
    make_normal(t, "along", n);
    tribo_vec3_scale(-1.0, n, back);
    const double share_a = arrangement == DEEP ? 0.95 * make_signed(t, NULL) : 1.0;
    const double share_b = arrangement == DEEP ? 0.95 * make_signed(t, NULL) : 1.0;
    const double small = fmin(p->a.small, p->b.small);
    const double by = arrangement == TOUCHING ? (make_byte(t) % 4 == 1 ? 1.0 : -1.0) * 2.0 * small *
                                                    ldexp(make_unit(t, NULL), -(make_byte(t) % 24))
                                              : 0.0;
    point_of(t, &p->a, &p->pose_a, back, share_a, at_a);
    point_of(t, &p->b, &p->pose_b, n, share_b, at_b);
    if (arrangement == ANYWHERE) {
        make_directions(t, NULL, at_b, 3);
        tribo_vec3_scale(p->a.size + p->b.size, at_b, at_b);
    }
    for (int i = 0; i < 3; i++) {
        const double offset = arrangement == CONCENTRIC ? 0.0 : at_a[i] - at_b[i] - by * n[i];
        p->pose_b.position[i] = p->pose_a.position[i] + offset;
    }
    property_note(t, "position of B", p->pose_b.position, 3);
}

static void measure_pair(pair *p)
{
    double apart[3];
    tribo_vec3_subtract(p->pose_b.position, p->pose_a.position, apart);
    p->size = p->a.size + p->b.size + norm3(apart);
    p->small = fmin(p->a.small, p->b.small);
    p->aspect = fmax(p->a.size, p->b.size) / p->small;
}

/* Position of A at the origin or some way off; a margin in a part of the pairs. */
static void make_pair(property_trial *t, uint32_t kinds_a, uint32_t kinds_b, pair *p)
{
    make_shape(t, "A", kinds_a, &p->a);
    make_shape(t, "B", kinds_b, &p->b);
    make_pose(t, "pose of A", -10, 10, &p->pose_a);
    make_pose(t, "pose of B", 0, 0, &p->pose_b);
    if (make_byte(t) % 4 == 1) {
        memcpy(p->pose_b.orientation, p->pose_a.orientation, sizeof p->pose_a.orientation);
    }
    place(t, p);
    measure_pair(p);
    memset(&p->options, 0, sizeof p->options);
    p->options.struct_size = sizeof p->options;
    p->options.max_points = make_choice(t, "max_points", 5);
    if (make_byte(t) % 4 == 1) {
        p->options.margin = p->small * make_unit(t, "margin by size");
    }
}

static uint32_t limit_of(const pair *p)
{
    return p->options.max_points == 0 ? TRIBO_MAX_POINTS : p->options.max_points;
}

static double deepest(const tribo_manifold *m)
{
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < m->count; k++) {
        least = fmin(least, m->points[k].distance);
    }
    return least;
}

/* Two of HALFSPACE and MESH do not meet. */
static int can_meet(const pair *p)
{
    const int ground_a =
        p->a.shape.type == TRIBO_SHAPE_HALFSPACE || p->a.shape.type == TRIBO_SHAPE_MESH;
    const int ground_b =
        p->b.shape.type == TRIBO_SHAPE_HALFSPACE || p->b.shape.type == TRIBO_SHAPE_MESH;
    return !(ground_a && ground_b);
}

/* ---- what every manifold is --------------------------------------------------------------- */

/* What may be wrong with a distance: the general method is promised to 1e-9 of the smaller size.
 * Between edges of boxes the closed form tells the distance of the edges, for a normal that is as
 * good as that. */
static double rounding_of(const pair *p, const tribo_manifold *m)
{
    const int boxes = p->a.shape.type == TRIBO_SHAPE_BOX && p->b.shape.type == TRIBO_SHAPE_BOX;
    const int is_exact = m->method == TRIBO_METHOD_CLOSED && !boxes;
    return 64.0 * EPS * p->size + (is_exact ? 0.0 : 1e-9 * p->small);
}

static void judge_manifold(property_trial *t, const pair *p, const tribo_manifold *m)
{
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        square += wide(m->normal[i]) * wide(m->normal[i]);
    }
    REQUIRE_NEAR(t, square, 1.0, 16.0 * EPS);
    REQUIRE(t, m->count >= 1 && m->count <= limit_of(p));
    REQUIRE(t, m->method == TRIBO_METHOD_CLOSED || m->method == TRIBO_METHOD_GENERAL);
    REQUIRE_AT_MOST(t, deepest(m), p->options.margin + 64.0 * EPS * p->size);
    for (uint32_t k = 0; k < m->count; k++) {
        const tribo_point *point = &m->points[k];
        REQUIRE(t, isfinite(point->distance));
        for (uint32_t i = 0; i < 3; i++) {
            const long double between = wide(point->arm_a[i]) - wide(point->arm_b[i]);
            const long double want = wide(p->pose_b.position[i]) - wide(p->pose_a.position[i]);
            const double far = fabs(point->arm_a[i]) + fabs(point->arm_b[i]) +
                               fabs(p->pose_a.position[i]) + fabs(p->pose_b.position[i]);
            REQUIRE_NEAR(t, between, want, 4.0 * EPS * (far + p->size));
        }
        for (uint32_t i = 0; i < k; i++) {
            REQUIRE(t, m->points[i].id != point->id);
        }
    }
}

/* Any two kinds: the status is the one that the kinds ask for, and what is told is sound. */
static void manifolds_sound(property_trial *t)
{
    static answer out;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, can_meet(&first) ? TRIBO_OK : TRIBO_ERROR_PAIR);
    for (uint32_t i = 0; i < out.count; i++) {
        judge_manifold(t, &first, &out.manifolds[i]);
        if (t->expression != NULL) {
            return;
        }
        if (i > 0) {
            const tribo_manifold *before = &out.manifolds[i - 1];
            const tribo_manifold *m = &out.manifolds[i];
            REQUIRE(t, before->child_a < m->child_a ||
                           (before->child_a == m->child_a && before->child_b < m->child_b));
        }
    }
}

/* ---- truth -------------------------------------------------------------------------------- */

static void normal_of(const tribo_manifold *m, long double n[3])
{
    for (int i = 0; i < 3; i++) {
        n[i] = wide(m->normal[i]);
    }
}

/* How far the point of a manifold, moved along the normal onto a surface, lies outside of the
 * shape. */
static long double outside(const tribo_shape *shape, const tribo_pose *pose, const double arm[3],
                           const double normal[3], long double by)
{
    long double r[9];
    long double x[3];
    long double own[3];
    shapes_rotation(pose, r);
    for (int i = 0; i < 3; i++) {
        x[i] = wide(arm[i]) + by * wide(normal[i]);
    }
    for (int i = 0; i < 3; i++) {
        own[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
    }
    return shapes_outside(shape, own);
}

static int tells_face(const made_shape *s)
{
    return s->shape.type != TRIBO_SHAPE_CONVEX || s->convex.face != NULL;
}

/* Whether a point may stand for a deeper one that did not stay: the deepest, where there may be more
 * corners than points and area chose (tribo_collide_options, max_points). All others are exact. */
static int tells_for_all(const pair *p, const tribo_manifold *m, uint32_t k)
{
    const uint32_t max = p->options.max_points > 0 ? p->options.max_points : TRIBO_MAX_POINTS;
    return max > 2 && m->count == max && m->points[k].distance == deepest(m);
}

/* Points of the manifold, moved by half of the distance, lie on the surfaces: in both shapes. Not
 * so where a user tells no face: the place of a single point on a flat side hangs on the normal. */
static void points_inside(property_trial *t)
{
    static answer out;
    make_pair(t, SHAPES_SIMPLE, SHAPES_CONVEX, &first);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    ASSUME(t, out.count > 0 && tells_face(&first.a) && tells_face(&first.b));
    const tribo_manifold *m = &out.manifolds[0];
    /* where a surface is smooth, the normal is known to the root of what the depth is known to; at
     * rims supports that are tilted by 1e-5 feel for the point; ends of capsules that touch along a
     * line may be shifted sideways by 1e-3 of the lesser radius */
    const int lines =
        first.a.shape.type == TRIBO_SHAPE_CAPSULE && first.b.shape.type == TRIBO_SHAPE_CAPSULE;
    const double tolerance = m->method == TRIBO_METHOD_CLOSED
                                 ? rounding_of(&first, m) + (lines ? 2e-7 * first.small : 0.0)
                                 : 2e-5 * first.size + sqrt(rounding_of(&first, m) * first.size);
    for (uint32_t k = 0; k < m->count; k++) {
        const tribo_point *point = &m->points[k];
        const long double half = 0.5L * wide(point->distance);
        const double most = tolerance + (tells_for_all(&first, m, k) ? LEVEL * first.size : 0.0);
        REQUIRE_AT_MOST(t, outside(&first.a.shape, &first.pose_a, point->arm_a, m->normal, half),
                        most);
        REQUIRE_AT_MOST(t, outside(&first.b.shape, &first.pose_b, point->arm_b, m->normal, -half),
                        most);
    }
}

static long double gap_of(const pair *p, const long double n[3])
{
    return gap(&p->a.shape, &p->pose_a, &p->b.shape, &p->pose_b, n);
}

/* The deepest point tells the width of the two shapes along the normal. */
static void distance_is_width(property_trial *t)
{
    static answer out;
    long double n[3];
    make_pair(t, SHAPES_CONVEX, SHAPES_CONVEX, &first);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    ASSUME(t, out.count > 0);
    normal_of(&out.manifolds[0], n);
    REQUIRE_NEAR(t, deepest(&out.manifolds[0]), gap_of(&first, n),
                 rounding_of(&first, &out.manifolds[0]));
}

/* No direction near the normal or anywhere shows the shapes less deep. */
static void no_shorter_way(property_trial *t)
{
    static answer out;
    double d[3];
    long double n[3];
    make_pair(t, SHAPES_CONVEX, SHAPES_CONVEX, &first);
    const double near = ldexp(1.0, -(make_byte(t) % 30));
    property_expand(t);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    ASSUME(t, out.count > 0);
    const tribo_manifold *m = &out.manifolds[0];
    const long double found = wide(deepest(m));
    ASSUME(t, first.aspect <= WIDEST && found <= -wide(LEAST_DEPTH * first.small));
    const double tolerance =
        0.01 * fmax(fabs((double)found), 1e-9 * first.small) + rounding_of(&first, m);
    for (int trial = 0; trial < 24; trial++) {
        make_normal(t, NULL, d);
        for (int i = 0; i < 3; i++) {
            d[i] = trial % 3 == 0 ? d[i] : m->normal[i] + near * d[i];
        }
        long double length = 0.0L;
        for (int i = 0; i < 3; i++) {
            length += wide(d[i]) * wide(d[i]);
        }
        ASSUME(t, length > 1e-6L);
        for (int i = 0; i < 3; i++) {
            n[i] = wide(d[i]) / sqrtl(length);
        }
        REQUIRE_AT_MOST(t, gap_of(&first, n) - found, tolerance);
    }
}

/* Where nothing is told, the shapes are apart: a wider margin names a direction that shows it. */
static void apart_has_witness(property_trial *t)
{
    static answer out;
    long double n[3];
    make_pair(t, SHAPES_SIMPLE, SHAPES_CONVEX, &first);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    ASSUME(t, out.count == 0);
    const double margin = first.options.margin;
    first.options.margin = 4.0 * first.size + fabs(first.a.shape.size[3]);
    if (first.a.shape.type == TRIBO_SHAPE_HALFSPACE) {
        first.options.margin += norm3(first.pose_a.position) + norm3(first.pose_b.position);
    }
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    REQUIRE(t, out.count == 1);
    normal_of(&out.manifolds[0], n);
    REQUIRE_AT_MOST(t, wide(margin) - gap_of(&first, n), rounding_of(&first, &out.manifolds[0]));
}

/* ---- symmetries --------------------------------------------------------------------------- */

static uint64_t swapped_id(uint64_t id)
{
    return id << 32 | id >> 32;
}

/* Times a power of two; what underflows may differ. */
static int same_vector(const double *x, const double *y, int exponent)
{
    for (int i = 0; i < 3; i++) {
        if (!(fabs(ldexp(x[i], exponent) - y[i]) <= 0x1p-960)) {
            return 0;
        }
    }
    return 1;
}

static int is_mirror(const tribo_manifold *m, const tribo_manifold *n)
{
    const double back[3] = {-n->normal[0], -n->normal[1], -n->normal[2]};
    int same = m->count == n->count && m->child_a == n->child_b && m->child_b == n->child_a &&
               m->method == n->method && same_vector(m->normal, back, 0);
    for (uint32_t k = 0; same && k < m->count; k++) {
        const tribo_point *p = &m->points[k];
        const tribo_point *q = &n->points[k];
        same = p->distance == q->distance && p->id == swapped_id(q->id) &&
               same_vector(p->arm_a, q->arm_b, 0) && same_vector(p->arm_b, q->arm_a, 0);
    }
    return same;
}

/* A and B exchanged: the same to the bit, arms exchanged and the normal turned round. Not so of two
 * shapes at one place and of one kind and size, of which neither is the first. */
static void swap_exact(property_trial *t)
{
    static answer out;
    static answer back;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    ASSUME(t, memcmp(first.pose_a.position, first.pose_b.position, 3 * sizeof(double)) != 0 ||
                  first.a.shape.type != first.b.shape.type || first.a.size != first.b.size);
    ask(&first, &out);
    memset(back.manifolds, 0, sizeof back.manifolds);
    back.count = 0;
    back.status =
        tribo_collide_shapes(&first.b.shape, &first.pose_b, &first.a.shape, &first.pose_a,
                             &first.options, MANIFOLDS, back.manifolds, &back.count, NULL);
    REQUIRE_STATUS(t, back.status, out.status);
    REQUIRE(t, back.count == out.count);
    for (uint32_t i = 0; i < out.count; i++) {
        int found = 0;
        for (uint32_t k = 0; k < back.count; k++) {
            found += is_mirror(&out.manifolds[i], &back.manifolds[k]);
        }
        REQUIRE(t, found == 1);
    }
}

/* Both poses moved by what is added without rounding: the same to the bit. */
static void translation_exact(property_trial *t)
{
    static answer out;
    static answer moved;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    for (int i = 0; i < 3; i++) {
        /* multiples of 2^-20, so that the sum with 2^20 has 41 bits or less */
        first.pose_a.position[i] = ldexp(nearbyint(ldexp(first.pose_a.position[i], 20)), -20);
        first.pose_b.position[i] = ldexp(nearbyint(ldexp(first.pose_b.position[i], 20)), -20);
        ASSUME(t, fabs(first.pose_b.position[i]) < 0x1p20);
    }
    ask(&first, &out);
    for (int i = 0; i < 3; i++) {
        const double by = (double)((int)(make_byte(t) % 5) - 2) * 0x1p20;
        first.pose_a.position[i] += by;
        first.pose_b.position[i] += by;
    }
    ask(&first, &moved);
    REQUIRE_STATUS(t, moved.status, out.status);
    REQUIRE(t, moved.count == out.count);
    REQUIRE_SAME(t, moved.manifolds, out.manifolds, sizeof out.manifolds);
}

/* The pair turned as a whole: the same depth, to what the method promises. */
static void rotation_near(property_trial *t)
{
    static answer out;
    static answer turned;
    double q[4];
    make_pair(t, SHAPES_CONVEX, SHAPES_CONVEX, &first);
    make_quat(t, "turn", q);
    first.options.margin = first.size; /* always an answer */
    ask(&first, &out);
    for (int k = 0; k < 2; k++) {
        tribo_pose *pose = k == 0 ? &first.pose_a : &first.pose_b;
        tribo_quat_rotate(q, pose->position, pose->position);
        tribo_quat_multiply(q, pose->orientation, pose->orientation);
    }
    ask(&first, &turned);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    REQUIRE_STATUS(t, turned.status, TRIBO_OK);
    ASSUME(t, out.count == 1);
    REQUIRE(t, turned.count == 1);
    const double depth = deepest(&out.manifolds[0]);
    ASSUME(t, first.aspect <= WIDEST && depth <= -LEAST_DEPTH * first.small);
    const double far = norm3(first.pose_a.position) + norm3(first.pose_b.position);
    const double share = out.manifolds[0].method == TRIBO_METHOD_CLOSED ? 0.0 : 0.01;
    REQUIRE_NEAR(t, deepest(&turned.manifolds[0]), depth,
                 share * fabs(depth) + 2.0 * rounding_of(&first, &out.manifolds[0]) +
                     64.0 * EPS * far);
}

static void scale_pair(const pair *from, int exponent, pair *to)
{
    const double *margin = &from->options.margin;
    to->options = from->options;
    to->options.margin = ldexp(*margin, exponent);
    to->pose_a = from->pose_a;
    to->pose_b = from->pose_b;
    for (int i = 0; i < 3; i++) {
        to->pose_a.position[i] = ldexp(from->pose_a.position[i], exponent);
        to->pose_b.position[i] = ldexp(from->pose_b.position[i], exponent);
    }
}

static int is_scalable(const pair *p)
{
    return shapes_scalable(p->pose_a.position, 3) && shapes_scalable(p->pose_b.position, 3) &&
           shapes_scalable(p->a.points, 3 * (size_t)p->a.point_count) &&
           shapes_scalable(p->b.points, 3 * (size_t)p->b.point_count);
}

/* All lengths times a power of two: the answer too, to the bit. */
static void scale_exact(property_trial *t)
{
    static answer out;
    static answer scaled;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    ASSUME(t, is_scalable(&first));
    const int exponent = make_exponent(t, -100, 100);
    ask(&first, &out);
    REQUIRE(t, shapes_scale(&first.a, exponent, &other.a));
    REQUIRE(t, shapes_scale(&first.b, exponent, &other.b));
    scale_pair(&first, exponent, &other);
    ask(&other, &scaled);
    REQUIRE_STATUS(t, scaled.status, out.status);
    REQUIRE(t, scaled.count == out.count);
    for (uint32_t i = 0; i < out.count; i++) {
        const tribo_manifold *m = &out.manifolds[i];
        const tribo_manifold *n = &scaled.manifolds[i];
        REQUIRE(t, m->count == n->count && same_vector(m->normal, n->normal, 0));
        for (uint32_t k = 0; k < m->count; k++) {
            REQUIRE(t, ldexp(m->points[k].distance, exponent) == n->points[k].distance);
            REQUIRE(t, m->points[k].id == n->points[k].id);
            REQUIRE(t, same_vector(m->points[k].arm_a, n->points[k].arm_a, exponent));
            REQUIRE(t, same_vector(m->points[k].arm_b, n->points[k].arm_b, exponent));
        }
    }
}

/* ---- options ------------------------------------------------------------------------------ */

/* A wider margin loses no contact, and tells the same depth. */
static void margin_monotone(property_trial *t)
{
    static answer narrow;
    static answer wide_answer;
    make_pair(t, SHAPES_SIMPLE, SHAPES_CONVEX, &first);
    const double more = first.small * make_unit(t, "more");
    ask(&first, &narrow);
    first.options.margin += more;
    ask(&first, &wide_answer);
    REQUIRE_STATUS(t, narrow.status, TRIBO_OK);
    REQUIRE_STATUS(t, wide_answer.status, TRIBO_OK);
    ASSUME(t, narrow.count == 1);
    REQUIRE(t, wide_answer.count == 1);
    const double depth = deepest(&narrow.manifolds[0]);
    const double share = narrow.manifolds[0].method == TRIBO_METHOD_CLOSED ? 0.0 : 0.01;
    REQUIRE_NEAR(t, deepest(&wide_answer.manifolds[0]), depth,
                 share * fabs(depth) + 2.0 * rounding_of(&first, &narrow.manifolds[0]));
}

/* Fewer points, and one of the deepest, to rounding, stays. */
static void fewer_points(property_trial *t)
{
    static answer all;
    static answer few;
    make_pair(t, SHAPES_SIMPLE, SHAPES_CONVEX, &first);
    first.options.max_points = 0;
    ask(&first, &all);
    ASSUME(t, all.count == 1);
    for (uint32_t limit = 1; limit <= TRIBO_MAX_POINTS; limit++) {
        first.options.max_points = limit;
        ask(&first, &few);
        REQUIRE(t, few.status == TRIBO_OK && few.count == 1);
        REQUIRE(t, few.manifolds[0].count <= limit);
        REQUIRE(t, few.manifolds[0].count == limit || all.manifolds[0].count < limit + 1);
        REQUIRE_NEAR(t, deepest(&few.manifolds[0]), deepest(&all.manifolds[0]),
                     64.0 * EPS * first.size);
        REQUIRE_SAME(t, few.manifolds[0].normal, all.manifolds[0].normal, 3 * sizeof(double));
    }
    REQUIRE_SAME(t, &few, &all, sizeof all);
}

/* Closed form and general method tell the same depth. */
static void methods_agree(property_trial *t)
{
    static answer closed;
    static answer general;
    make_pair(t, SHAPES_ROUND, SHAPES_ROUND, &first);
    first.options.margin = first.size;
    first.options.method = TRIBO_METHOD_CLOSED;
    ask(&first, &closed);
    REQUIRE(t, closed.status == TRIBO_OK || closed.status == TRIBO_ERROR_OPTION);
    ASSUME(t, closed.status == TRIBO_OK && closed.count == 1);
    first.options.method = TRIBO_METHOD_GENERAL;
    ask(&first, &general);
    REQUIRE_STATUS(t, general.status, TRIBO_OK);
    REQUIRE(t, general.count == 1);
    REQUIRE(t, closed.manifolds[0].method == TRIBO_METHOD_CLOSED);
    REQUIRE(t, general.manifolds[0].method == TRIBO_METHOD_GENERAL);
    const double depth = deepest(&closed.manifolds[0]);
    ASSUME(t, first.aspect <= WIDEST && depth <= -LEAST_DEPTH * first.small);
    REQUIRE_NEAR(t, deepest(&general.manifolds[0]), depth,
                 0.01 * fabs(depth) + rounding_of(&first, &closed.manifolds[0]) +
                     rounding_of(&first, &general.manifolds[0]));
}

/* Room for fewer manifolds than there are: the number is told, and nothing else is written. */
static void little_room(property_trial *t)
{
    static answer out;
    static answer few;
    make_pair(t, SHAPES_KIND(TRIBO_SHAPE_MESH) | SHAPES_KIND(TRIBO_SHAPE_COMPOUND),
              SHAPES_CONVEX | SHAPES_KIND(TRIBO_SHAPE_COMPOUND), &first);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    ASSUME(t, out.count > 0);
    const uint32_t room = make_choice(t, "room", out.count);
    canary_set(few.manifolds, sizeof few.manifolds);
    few.count = 0;
    REQUIRE_STATUS(t,
                   tribo_collide_shapes(&first.a.shape, &first.pose_a, &first.b.shape,
                                        &first.pose_b, &first.options, room,
                                        room > 0 ? few.manifolds : NULL, &few.count, NULL),
                   TRIBO_ERROR_CAPACITY);
    REQUIRE(t, few.count == out.count);
    REQUIRE(t, canary_kept(few.manifolds, sizeof few.manifolds));
}

/* Each child of a compound touches as it does alone. */
static void compound_is_its_parts(property_trial *t)
{
    static answer out;
    static answer part;
    make_pair(t, SHAPES_KIND(TRIBO_SHAPE_COMPOUND), SHAPES_SIMPLE, &first);
    for (uint32_t c = 0; c < first.a.shape.count; c++) {
        tribo_pose *pose = &first.a.children[c].pose;
        static const tribo_pose plain = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
        const double shift = pose->position[0];
        *pose = plain; /* exact to compose with */
        pose->position[0] = shift;
    }
    first.pose_a.orientation[0] = 1.0;
    memset(first.pose_a.orientation + 1, 0, 3 * sizeof(double));
    memset(first.pose_a.position, 0, sizeof first.pose_a.position);
    ask(&first, &out);
    REQUIRE_STATUS(t, out.status, TRIBO_OK);
    uint32_t seen = 0;
    for (uint32_t c = 0; c < first.a.shape.count; c++) {
        part.count = 0;
        part.status = tribo_collide_shapes(&first.a.children[c].shape, &first.a.children[c].pose,
                                           &first.b.shape, &first.pose_b, &first.options, 1,
                                           part.manifolds, &part.count, NULL);
        REQUIRE_STATUS(t, part.status, TRIBO_OK);
        const int told = seen < out.count && out.manifolds[seen].child_a == c;
        REQUIRE(t, told == (part.count == 1));
        if (told) {
            const tribo_manifold *m = &out.manifolds[seen++];
            REQUIRE(t, m->count == part.manifolds[0].count);
            REQUIRE_NEAR(t, deepest(m), deepest(&part.manifolds[0]), rounding_of(&first, m));
        }
    }
    REQUIRE(t, seen == out.count);
}

/* ---- batches ------------------------------------------------------------------------------ */

/* Shapes one by one, and poses one by one, are what a batch does; what cannot be done is named and
 * does not touch the rest. */
static void batch_is_scalar(property_trial *t)
{
    enum { SHAPES = 4, PAIRS = 8 };
    static made_shape made[SHAPES];
    static tribo_manifold batch[PAIRS];
    static tribo_manifold untouched[PAIRS];
    tribo_shape shapes[SHAPES];
    tribo_pose poses[SHAPES];
    uint32_t pairs[2 * PAIRS];
    tribo_status statuses[PAIRS];
    tribo_collide_options options = {.struct_size = sizeof options};
    tribo_status want = TRIBO_OK;
    double small = HUGE_VAL;
    for (int i = 0; i < SHAPES; i++) {
        make_shape(t, "shape", SHAPES_ALL, &made[i]);
        make_pose(t, "pose", -4, 4, &poses[i]);
        shapes[i] = made[i].shape;
        small = fmin(small, made[i].small);
    }
    options.margin = small * make_unit(t, "margin");
    for (int i = 0; i < 2 * PAIRS; i++) {
        pairs[i] = make_choice(t, NULL, SHAPES * 8) * 9u / 64u;
    }
    canary_set(batch, sizeof batch);
    canary_set(untouched, sizeof untouched);
    const tribo_status status =
        tribo_collide_batch(SHAPES, shapes, poses, PAIRS, pairs, &options, batch, statuses, NULL);
    for (int i = 0; i < PAIRS; i++) {
        const uint32_t a = pairs[2 * i];
        const uint32_t b = pairs[2 * i + 1];
        tribo_manifold m = untouched[i];
        uint32_t count = 0;
        tribo_status own = TRIBO_ERROR_INDEX;
        if (a < SHAPES && b < SHAPES) {
            const int parts =
                shapes[a].type >= TRIBO_SHAPE_MESH || shapes[b].type >= TRIBO_SHAPE_MESH;
            own = a == b  ? TRIBO_ERROR_ALIAS
                  : parts ? TRIBO_ERROR_PAIR
                          : tribo_collide_shapes(&shapes[a], &poses[a], &shapes[b], &poses[b],
                                                 &options, 1, &m, &count, NULL);
        }
        REQUIRE_STATUS(t, statuses[i], own);
        want = want == TRIBO_OK ? own : want;
        if (own != TRIBO_OK) {
            REQUIRE_SAME(t, &batch[i], &untouched[i], sizeof m);
        } else if (count == 0) {
            REQUIRE(t, batch[i].count == 0);
        } else {
            REQUIRE_SAME(t, &batch[i], &m, sizeof m);
        }
    }
    REQUIRE_STATUS(t, status, want);
}

/* ---- what is wrong ------------------------------------------------------------------------ */

/* One thing wrong in a good call: a status, outputs untouched. */
static void faults(property_trial *t)
{
    static answer out;
    tribo_collide_info info;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    pair *p = &first;
    tribo_shape *shape = make_choice(t, "side", 2) == 0 ? &p->a.shape : &p->b.shape;
    tribo_pose *pose = shape == &p->a.shape ? &p->pose_a : &p->pose_b;
    const uint32_t fault = make_choice(t, "fault", 9);
    const double bad = make_hostile(t, "value");
    const int has_sizes = shape->type <= TRIBO_SHAPE_ELLIPSOID;
    tribo_status want = TRIBO_ERROR_NOT_FINITE;
    memset(&info, 0x5a, sizeof info);
    info.struct_size = sizeof info;
    if (fault == 0) {
        ((double *)pose)[make_choice(t, NULL, 7)] = bad;
    } else if (fault == 1 && has_sizes) {
        shape->size[0] = bad;
    } else if (fault == 2 && has_sizes) {
        shape->size[0] = make_byte(t) % 2 == 0 ? 0.0 : -1.0;
        want = TRIBO_ERROR_SHAPE;
    } else if (fault == 3) {
        p->options.margin = bad;
    } else if (fault == 4) {
        p->options.margin = -make_positive(t, NULL, -1000, 1000);
        want = TRIBO_ERROR_RANGE;
    } else if (fault == 5) {
        p->options.max_points = 5 + make_byte(t);
        want = TRIBO_ERROR_OPTION;
    } else if (fault == 6) {
        p->options.method = 3 + make_byte(t);
        want = TRIBO_ERROR_OPTION;
    } else if (fault == 7) {
        info.struct_size = make_byte(t) % 2 == 0 ? 0 : (uint32_t)sizeof info + 8;
        want = TRIBO_ERROR_STRUCT_SIZE;
    } else {
        pose->orientation[make_choice(t, NULL, 4)] = 1.5;
        want = TRIBO_ERROR_ORIENTATION;
    }
    const tribo_collide_info before = info;
    canary_set(out.manifolds, sizeof out.manifolds);
    out.count = 77;
    REQUIRE_STATUS(t,
                   tribo_collide_shapes(&p->a.shape, &p->pose_a, &p->b.shape, &p->pose_b,
                                        &p->options, MANIFOLDS, out.manifolds, &out.count, &info),
                   want);
    REQUIRE(t, out.count == 77 && canary_kept(out.manifolds, sizeof out.manifolds));
    REQUIRE_SAME(t, &info, &before, sizeof info);
}

static void null_pointers(property_trial *t)
{
    static answer out;
    make_pair(t, SHAPES_ALL, SHAPES_ALL, &first);
    const uint32_t which = make_choice(t, "which", 6);
    const pair *p = &first;
    canary_set(out.manifolds, sizeof out.manifolds);
    out.count = 77;
    const tribo_status status = tribo_collide_shapes(
        which == 0 ? NULL : &p->a.shape, which == 1 ? NULL : &p->pose_a,
        which == 2 ? NULL : &p->b.shape, which == 3 ? NULL : &p->pose_b, &p->options, MANIFOLDS,
        which == 4 ? NULL : out.manifolds, which == 5 ? NULL : &out.count, NULL);
    REQUIRE_STATUS(t, status, TRIBO_ERROR_NULL);
    REQUIRE(t, out.count == 77 && canary_kept(out.manifolds, sizeof out.manifolds));
}

/* Any finite numbers: what comes out is finite, or a status. */
static void any_numbers(property_trial *t)
{
    static answer out;
    make_pair(t, SHAPES_SIMPLE, SHAPES_CONVEX, &first);
    pair *p = &first;
    const uint32_t changes = 1 + make_choice(t, "changes", 4);
    for (uint32_t i = 0; i < changes; i++) {
        const uint32_t place = make_choice(t, "place", 5);
        tribo_shape *shape = place % 2 == 0 ? &p->a.shape : &p->b.shape;
        tribo_pose *pose = place % 2 == 0 ? &p->pose_a : &p->pose_b;
        if (place < 2) {
            shape->size[make_choice(t, NULL, 4)] = fabs(make_finite(t, "size"));
        } else if (place < 4) {
            pose->position[make_choice(t, NULL, 3)] = make_finite(t, "position");
        } else {
            p->options.margin = fabs(make_finite(t, "margin"));
        }
    }
    ask(p, &out);
    REQUIRE(t, out.status == TRIBO_OK || out.status == TRIBO_ERROR_SHAPE ||
                   out.status == TRIBO_ERROR_NORMAL || out.status == TRIBO_ERROR_RANGE ||
                   out.status == TRIBO_ERROR_SUPPORT);
    const tribo_manifold *m = &out.manifolds[0];
    for (uint32_t k = 0; out.status == TRIBO_OK && out.count > 0 && k < m->count; k++) {
        for (int i = 0; i < 3; i++) {
            REQUIRE(t, isfinite(m->points[k].arm_a[i]) && isfinite(m->points[k].arm_b[i]));
        }
        REQUIRE(t, isfinite(m->points[k].distance));
        REQUIRE_NEAR(t, norm3(m->normal), 1.0, 1e-12);
    }
}

/* ---- a user's functions that lie ---------------------------------------------------------- */

enum { HONEST, NOT_A_NUMBER, ONE_POINT, FLIPPED, NOISE, HUGE_STEP, FAR_OUT, TOO_MANY, LIES };

typedef struct liar {
    const tribo_shape *base;
    uint32_t lie;
    uint32_t every; /* one of so many directions is lied about */
    uint64_t calls;
} liar;

static liar told;

/* A number that depends on nothing but the direction. */
static uint64_t hash_of(const double d[3])
{
    uint64_t sum = 0x9e3779b97f4a7c15u;
    for (int i = 0; i < 3; i++) {
        uint64_t bits;
        memcpy(&bits, &d[i], sizeof bits);
        sum = (sum ^ bits) * 0xbf58476d1ce4e5b9u;
        sum ^= sum >> 31;
    }
    return sum;
}

static void lie_support(const void *user, const double direction[3], double point[3])
{
    const liar *l = user;
    const uint64_t hash = hash_of(direction);
    told.calls++;
    shapes_support(l->base, direction, point);
    if (hash % l->every != 0) {
        return;
    }
    for (int i = 0; i < 3; i++) {
        const double noise = (double)(hash >> (8 * i + 8) & 255u) / 128.0 - 1.0;
        switch (l->lie) {
        case NOT_A_NUMBER:
            point[i] = i == (int)(hash % 3u) ? (double)NAN : point[i];
            break;
        case ONE_POINT:
            point[i] = 0.25 * (double)i;
            break;
        case FLIPPED:
            point[i] = -point[i];
            break;
        case NOISE:
            point[i] *= 1.0 + 0.5 * noise;
            break;
        case HUGE_STEP:
            point[i] = noise * 1e300;
            break;
        case FAR_OUT:
            point[i] += 1e6 * noise;
            break;
        default:
            break;
        }
    }
}

static uint32_t lie_face(const void *user, const double direction[3], uint32_t capacity,
                         double *points)
{
    const liar *l = user;
    const uint64_t hash = hash_of(direction);
    const uint32_t count = shapes_face(l->base, direction, capacity, points);
    told.calls++;
    for (uint32_t k = 0; k < count; k++) {
        if (l->lie != HONEST && l->lie != TOO_MANY && (hash >> 8) % l->every == 0) {
            lie_support(user, direction, points + 3 * k);
        }
    }
    return l->lie == TOO_MANY ? (uint32_t)hash : count;
}

/* A status or finite numbers, after a bounded number of calls. */
static void liars(property_trial *t)
{
    static answer out;
    tribo_convex convex = {.struct_size = sizeof convex, .support = lie_support, .user = &told};
    double low[3];
    double high[3];
    const int has_face = make_choice(t, "face", 2) == 1;
    make_pair(t, SHAPES_ROUND, SHAPES_ALL, &first);
    told.base = &first.a.shape;
    told.lie = make_choice(t, "lie", LIES);
    told.every = 1 + make_choice(t, "every", 8);
    told.calls = 0;
    convex.face = has_face ? lie_face : NULL;
    convex.radius = ldexp(first.a.size, make_byte(t) % 8 == 1 ? make_exponent(t, -60, 60) : 1);
    const tribo_shape base = first.a.shape;
    told.base = &base;
    memset(&first.a.shape, 0, sizeof first.a.shape);
    first.a.shape.type = TRIBO_SHAPE_CONVEX;
    first.a.shape.data = &convex;
    ask(&first, &out);
    REQUIRE(t, out.status == TRIBO_OK || out.status == TRIBO_ERROR_SUPPORT ||
                   out.status == TRIBO_ERROR_RANGE);
    for (uint32_t i = 0; i < out.count; i++) {
        const tribo_manifold *m = &out.manifolds[i];
        REQUIRE_NEAR(t, norm3(m->normal), 1.0, 1e-12);
        REQUIRE(t, m->count <= limit_of(&first));
        for (uint32_t k = 0; k < m->count; k++) {
            REQUIRE(t, isfinite(m->points[k].distance));
        }
    }
    const uint32_t triangles =
        first.b.shape.type == TRIBO_SHAPE_MESH ? (uint32_t)first.b.triangle_count : 1;
    const uint32_t parts = first.b.shape.count > 0 ? first.b.shape.count : 1;
    REQUIRE_AT_MOST(t, (double)told.calls, 20000.0 * triangles * parts);
    const tribo_status bounded = tribo_shape_bounds(&first.a.shape, &first.pose_a, low, high);
    REQUIRE(t, bounded == TRIBO_OK || bounded == TRIBO_ERROR_SUPPORT);
}

const char *const property_room = "collide";
const property property_list[] = {
    {"manifolds_sound", manifolds_sound, 2},
    {"points_inside", points_inside, 2},
    {"distance_is_width", distance_is_width, 2},
    {"no_shorter_way", no_shorter_way, 4},
    {"apart_has_witness", apart_has_witness, 2},
    {"swap_exact", swap_exact, 3},
    {"translation_exact", translation_exact, 3},
    {"rotation_near", rotation_near, 3},
    {"scale_exact", scale_exact, 4},
    {"margin_monotone", margin_monotone, 2},
    {"fewer_points", fewer_points, 4},
    {"methods_agree", methods_agree, 4},
    {"little_room", little_room, 4},
    {"compound_is_its_parts", compound_is_its_parts, 4},
    {"batch_is_scalar", batch_is_scalar, 4},
    {"faults", faults, 1},
    {"null_pointers", null_pointers, 1},
    {"any_numbers", any_numbers, 2},
    {"liars", liars, 3},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 4000;
