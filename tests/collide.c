/* Manifolds: closed forms against values by hand, boxes against separating axes by brute force, the
 * area and place of the points, equivariance, parts, judging. */
#include <tribo/collide.h>
#include <tribo/math.h>

#include "pair.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define NOT_A_NUMBER ((double)NAN)
#define INFINITE ((double)INFINITY)

/* ---- random input --------------------------------------------------------------------------- */

static uint64_t seed = 1;

/* Each test has its own random numbers: what one draws does not change the next. */
static int fresh(void **state)
{
    (void)state;
    seed = 88172645463325252u;
    return 0;
}

static double uniform(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) * 0x1p-53;
}

static double between(double low, double high)
{
    return low + (high - low) * uniform();
}

static void random_direction(double d[3])
{
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < 3; i++) {
            d[i] = between(-1.0, 1.0);
            square += d[i] * d[i];
        }
    } while (square < 1e-2 || square > 1.0);
    for (int i = 0; i < 3; i++) {
        d[i] /= sqrt(square);
    }
}

static void random_turn(double q[4])
{
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < 4; i++) {
            q[i] = between(-1.0, 1.0);
            square += q[i] * q[i];
        }
    } while (square < 1e-2 || square > 1.0);
    for (int i = 0; i < 4; i++) {
        q[i] /= sqrt(square);
    }
}

static double random_length(double low, double high)
{
    return exp(between(log(low), log(high)));
}

/* ---- shapes and calls ----------------------------------------------------------------------- */

static tribo_shape make(uint32_t type, double x, double y, double z)
{
    const tribo_shape s = {type, 0, {x, y, z, 0.0}, NULL};
    return s;
}

static tribo_pose at(double x, double y, double z)
{
    const tribo_pose p = {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
    return p;
}

static tribo_pose turned(tribo_pose p, double x, double y, double z)
{
    const double v[3] = {x, y, z};
    assert_int_equal(tribo_quat_from_rotation_vector(v, p.orientation), TRIBO_OK);
    return p;
}

static tribo_collide_options with_margin(double margin)
{
    tribo_collide_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.margin = margin;
    return o;
}

/* One convex pair; count 0 if it does not touch. */
static tribo_manifold pair_of(const tribo_shape *a, const tribo_pose *pa, const tribo_shape *b,
                              const tribo_pose *pb, const tribo_collide_options *options)
{
    tribo_manifold m;
    uint32_t count = 77;
    memset(&m, 0, sizeof m);
    const tribo_status status = tribo_collide_shapes(a, pa, b, pb, options, 1, &m, &count, NULL);
    if (status != TRIBO_OK) {
        print_message("# %s\n", tribo_status_name(status));
    }
    assert_int_equal(status, TRIBO_OK);
    assert_in_range(count, 0, 1);
    assert_int_equal(count, m.count > 0);
    return m;
}

static double deepest(const tribo_manifold *m)
{
    double least = INFINITE;
    for (uint32_t k = 0; k < m->count; k++) {
        least = m->points[k].distance < least ? m->points[k].distance : least;
    }
    return least;
}

static double norm(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double apart(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return norm(d);
}

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) {
        print_message("# %.17g is not %.17g within %g\n", value, expected, tolerance);
        fail();
    }
}

static void assert_vector(const double v[3], double x, double y, double z, double tolerance)
{
    assert_near(v[0], x, tolerance);
    assert_near(v[1], y, tolerance);
    assert_near(v[2], z, tolerance);
}

/* ---- closed forms against values by hand ---------------------------------------------------- */

/* A pair with one point: its normal, place (from A, who stands at the origin) and distance. */
static void expect_point(tribo_shape a, tribo_pose pa, tribo_shape b, tribo_pose pb,
                         const double n[3], const double place[3], double distance)
{
    const tribo_collide_options options = with_margin(1.0);
    const tribo_manifold m = pair_of(&a, &pa, &b, &pb, &options);
    assert_int_equal(m.count, 1);
    assert_int_equal(m.method, TRIBO_METHOD_CLOSED);
    assert_vector(m.normal, n[0], n[1], n[2], 4e-16);
    assert_near(m.points[0].distance, distance, 1e-15);
    for (int i = 0; i < 3; i++) {
        assert_near(m.points[0].arm_a[i], place[i] - pa.position[i], 1e-15);
        assert_near(m.points[0].arm_b[i], place[i] - pb.position[i], 1e-15);
    }
}

static void spheres_by_hand(void **state)
{
    (void)state;
    const tribo_shape one = make(TRIBO_SHAPE_SPHERE, 1.0, 0.0, 0.0);
    const tribo_shape half = make(TRIBO_SHAPE_SPHERE, 0.5, 0.0, 0.0);
    const tribo_shape capsule = make(TRIBO_SHAPE_CAPSULE, 0.5, 2.0, 0.0);
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 1.0, 2.0, 3.0);
    const double z[3] = {0, 0, 1};
    const double down[3] = {0, 0, -1};
    const double x[3] = {1, 0, 0};
    const double diagonal[3] = {0.6, 0.8, 0};
    expect_point(one, at(0, 0, 1.25), half, at(0, 0, 0), z, (const double[]){0, 0, 0.375}, -0.25);
    expect_point(one, at(0, 0, 0), half, at(0, 0, 1.75), down, (const double[]){0, 0, 1.125}, 0.25);
    expect_point(one, at(0, 0, 0), one, at(0, 0, 0), z, (const double[]){0, 0, 0}, -2.0);
    /* barrel, cap, and on the segment */
    expect_point(one, at(1, 0, 1), capsule, at(0, 0, 0), x, (const double[]){0.25, 0, 1}, -0.5);
    expect_point(one, at(0, 0, 3.25), capsule, at(0, 0, 0), z, (const double[]){0, 0, 2.375},
                 -0.25);
    expect_point(one, at(0, 0, 1), capsule, at(0, 0, 0), x, (const double[]){-0.25, 0, 1}, -1.5);
    /* outside of a face and of an edge, inside, at the centre */
    expect_point(half, at(0, 0, 3.25), box, at(0, 0, 0), z, (const double[]){0, 0, 2.875}, -0.25);
    expect_point(one, at(1.3, 2.4, 0), box, at(0, 0, 0), diagonal, (const double[]){0.85, 1.8, 0},
                 -0.5);
    expect_point(half, at(0, 1.75, 0), box, at(0, 0, 0), (const double[]){0, 1, 0},
                 (const double[]){0, 1.625, 0}, -0.75);
    expect_point(half, at(0, 0, 0), box, at(0, 0, 0), x, (const double[]){0.25, 0, 0}, -1.5);
    expect_point(half, at(-0.75, 0, 0), box, at(0, 0, 0), (const double[]){-1, 0, 0},
                 (const double[]){-0.625, 0, 0}, -0.75);
}

static void capsules_by_hand(void **state)
{
    (void)state;
    const tribo_shape a = make(TRIBO_SHAPE_CAPSULE, 0.5, 2.0, 0.0);
    const tribo_shape b = make(TRIBO_SHAPE_CAPSULE, 0.25, 1.0, 0.0);
    const double z[3] = {0, 0, 1};
    const double x[3] = {1, 0, 0};
    const tribo_pose lying = turned(at(0.25, 0, 0), 1.5707963267948966, 0, 0);
    /* crossing: b along y; end to end; crossing segments that meet */
    expect_point(a, at(0.875, 0, 0), b, lying, x, (const double[]){0.4375, 0, 0}, -0.125);
    expect_point(a, at(0, 0, 0), b, at(0, 0, -3.625), z, (const double[]){0, 0, -2.4375}, -0.125);
    const tribo_collide_options options = with_margin(0.0);
    tribo_pose pa = at(0.625, 0, 0.5);
    tribo_pose pb = at(0, 0, 0);
    tribo_manifold m = pair_of(&a, &pa, &b, &pb, &options);
    assert_int_equal(m.count, 2);
    assert_vector(m.normal, 1, 0, 0, 1e-15);
    for (int k = 0; k < 2; k++) {
        assert_near(m.points[k].distance, -0.125, 1e-15);
        assert_near(m.points[k].arm_b[0], 0.1875, 1e-15);
        assert_near(fabs(m.points[k].arm_b[2]), 1.0, 1e-15);
    }
    /* segments that cross, touch with an end, or lie in each other: depth is the sum of the
     * radii */
    const tribo_pose places[5] = {at(0, 0, 0), at(0, 0, 2), at(0, 1, 2), at(0, 0, 1), at(0, 0, 3)};
    for (int k = 0; k < 5; k++) {
        tribo_pose p = places[k];
        p = k < 3 ? turned(p, 1.5707963267948966, 0, 0) : p;
        pa = at(0, 0, 0);
        m = pair_of(&a, &pa, &b, &p, &options);
        assert_in_range(m.count, 1, 2);
        assert_near(norm(m.normal), 1.0, 1e-15);
        assert_near(deepest(&m), -0.75, 1e-15);
    }
}

static void planes_by_hand(void **state)
{
    (void)state;
    const tribo_shape plane = {TRIBO_SHAPE_HALFSPACE, 0, {0.0, 0.0, 1.0, 0.5}, NULL};
    const tribo_shape sphere = make(TRIBO_SHAPE_SPHERE, 1.0, 0.0, 0.0);
    const tribo_shape ellipsoid = make(TRIBO_SHAPE_ELLIPSOID, 1.0, 2.0, 3.0);
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 1.0, 2.0, 3.0);
    const tribo_shape capsule = make(TRIBO_SHAPE_CAPSULE, 0.5, 2.0, 0.0);
    const tribo_shape cylinder = make(TRIBO_SHAPE_CYLINDER, 1.0, 2.0, 0.0);
    const tribo_shape cone = make(TRIBO_SHAPE_CONE, 1.0, 2.0, 0.0);
    const tribo_pose ground = at(0, 0, -0.5);
    const double z[3] = {0, 0, 1};
    expect_point(sphere, at(3, 4, 0.75), plane, ground, z, (const double[]){3, 4, -0.125}, -0.25);
    expect_point(sphere, at(3, 4, 1.25), plane, ground, z, (const double[]){3, 4, 0.125}, 0.25);
    expect_point(ellipsoid, at(3, 4, 2.75), plane, ground, z, (const double[]){3, 4, -0.125},
                 -0.25);
    const tribo_shape *shapes[4] = {&box, &capsule, &cylinder, &cone};
    const double heights[4] = {2.75, 0.25, 1.75, 1.75};
    const double tilts[4] = {0.0, 1.5707963267948966, 0.0, 0.0};
    const uint32_t counts[4] = {4, 2, 4, 4};
    for (int k = 0; k < 4; k++) {
        const tribo_pose pose = turned(at(7, 0, heights[k]), tilts[k], 0, 0);
        const tribo_manifold m = pair_of(shapes[k], &pose, &plane, &ground, NULL);
        assert_int_equal(m.count, counts[k]);
        assert_vector(m.normal, 0, 0, 1, 0);
        for (uint32_t c = 0; c < m.count; c++) {
            assert_near(m.points[c].distance, -0.25, 1e-15);
            assert_near(m.points[c].arm_a[2], -0.125 - heights[k], 1e-15);
        }
    }
    /* a tilted cylinder's lowest point is on its rim */
    const tribo_pose tilted = turned(at(0, 0, 0), 0.3, 0.4, 0);
    const tribo_manifold m = pair_of(&cylinder, &tilted, &plane, &ground, NULL);
    const double lowest = -(2.0 * cos(0.5) + sin(0.5));
    assert_near(deepest(&m), lowest, 1e-15);
}

/* ---- boxes: truth by brute force ------------------------------------------------------------ */

typedef long double real;

typedef struct solid_box {
    real axis[3][3];
    real corner[8][3]; /* from the centre of A */
} solid_box;

static void rotate_exactly(const double q[4], real r[3][3])
{
    const real w = (real)q[0];
    const real x = (real)q[1];
    const real y = (real)q[2];
    const real z = (real)q[3];
    const real s = 2.0L / (w * w + x * x + y * y + z * z);
    const real full[3][3] = {
        {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
        {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
        {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)},
    };
    memcpy(r, full, sizeof full);
}

static void take_box(const tribo_shape *shape, const tribo_pose *pose, const double origin[3],
                     solid_box *out)
{
    real r[3][3];
    rotate_exactly(pose->orientation, r);
    for (int c = 0; c < 8; c++) {
        for (int k = 0; k < 3; k++) {
            out->corner[c][k] = (real)pose->position[k] - (real)origin[k];
            for (int i = 0; i < 3; i++) {
                out->axis[i][k] = r[k][i];
                out->corner[c][k] += (c >> i & 1 ? 1.0L : -1.0L) * (real)shape->size[i] * r[k][i];
            }
        }
    }
}

static void extent_along(const solid_box *x, const real n[3], real *low, real *high)
{
    *low = (real)HUGE_VAL;
    *high = -(real)HUGE_VAL;
    for (int c = 0; c < 8; c++) {
        const real h = n[0] * x->corner[c][0] + n[1] * x->corner[c][1] + n[2] * x->corner[c][2];
        *low = h < *low ? h : *low;
        *high = h > *high ? h : *high;
    }
}

/* Depth if A is pushed along n. */
static real width_along(const solid_box *a, const solid_box *b, const real n[3])
{
    real range[4];
    extent_along(a, n, &range[0], &range[1]);
    extent_along(b, n, &range[2], &range[3]);
    return range[3] - range[0];
}

/* The 15 axes, both ways along each; fewer where edges are parallel. Returns their number. */
static int take_axes(const solid_box *a, const solid_box *b, real axes[30][3])
{
    int count = 0;
    for (int k = 0; k < 15; k++) {
        real n[3];
        if (k < 6) {
            memcpy(n, k < 3 ? a->axis[k] : b->axis[k - 3], sizeof n);
        } else {
            const real *u = a->axis[(k - 6) / 3];
            const real *v = b->axis[(k - 6) % 3];
            n[0] = u[1] * v[2] - u[2] * v[1];
            n[1] = u[2] * v[0] - u[0] * v[2];
            n[2] = u[0] * v[1] - u[1] * v[0];
        }
        const real length = sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int sign = -1; sign <= 1 && length > 1e-12L; sign += 2) {
            for (int i = 0; i < 3; i++) {
                axes[count][i] = sign * n[i] / length;
            }
            count++;
        }
    }
    return count;
}

static real true_depth(const solid_box *a, const solid_box *b)
{
    real axes[30][3];
    real least = (real)HUGE_VAL;
    const int count = take_axes(a, b, axes);
    for (int k = 0; k < count; k++) {
        const real width = width_along(a, b, axes[k]);
        least = width < least ? width : least;
    }
    return least;
}

/* How far B can go along a direction until the depth has fallen to `depth`: all widths are linear
 * in it. */
static double way_to_depth(const solid_box *a, const solid_box *b, const double direction[3],
                           double depth)
{
    real axes[30][3];
    real way = (real)HUGE_VAL;
    const int count = take_axes(a, b, axes);
    for (int k = 0; k < count; k++) {
        const real *n = axes[k];
        const real slope =
            n[0] * (real)direction[0] + n[1] * (real)direction[1] + n[2] * (real)direction[2];
        const real most = (width_along(a, b, n) - (real)depth) / -slope;
        way = slope < -1e-9L && most < way ? most : way;
    }
    return way > 0 ? (double)way : 0.0;
}

typedef struct box_case {
    tribo_shape a, b;
    tribo_pose pa, pb;
    double small; /* least half-extent */
    double large; /* sum of all */
} box_case;

static real depth_of(const box_case *c)
{
    solid_box a;
    solid_box b;
    take_box(&c->a, &c->pa, c->pa.position, &a);
    take_box(&c->b, &c->pb, c->pa.position, &b);
    return true_depth(&a, &b);
}

enum { RANDOM, SLENDER, FACE_ALIGNED, EDGE_ALIGNED, FACE_TILTED, CONCENTRIC, PLATES, BOX_CLASSES };

static const char *const box_names[BOX_CLASSES] = {
    "random",     "aspect 1e4",    "face-aligned", "edge-aligned", "tilted 1e-8..1e-2",
    "concentric", "plates 2000:1",
};

static void random_sizes(int class, double scale, double h[3])
{
    for (int i = 0; i < 3; i++) {
        h[i] = scale * between(0.3, 1.0);
    }
    if (class == SLENDER) {
        h[(int)(3.0 * uniform())] *= uniform() < 0.5 ? 1e-4 : 1e4;
    }
    if (class == PLATES) {
        h[0] = 1000.0 * scale * between(0.5, 1.0);
        h[1] = 1000.0 * scale * between(0.5, 1.0);
        h[2] = 0.5 * scale;
    }
}

/* The turn of B against A. */
static void relative_turn(int class, double q[4])
{
    static const double half = 0.70710678118654752440;
    const double quarter[4][4] = {
        {1, 0, 0, 0}, {half, half, 0, 0}, {half, 0, half, 0}, {0.5, 0.5, 0.5, 0.5}};
    double spin[3] = {0.0, 0.0, 0.0};
    double turn[4];
    if (class == RANDOM || class == SLENDER || (class == CONCENTRIC && uniform() < 0.5)) {
        random_turn(q);
        return;
    }
    if (class == PLATES) {
        spin[2] = uniform() < 0.5 ? 0.0 : between(-3.0, 3.0);
    } else {
        spin[(int)(3.0 * uniform())] = class == EDGE_ALIGNED ? 0.78539816339744830962
                                       : uniform() < 0.5     ? 0.0
                                                             : between(-3.0, 3.0);
    }
    if (class == FACE_TILTED || class == PLATES) {
        double tilt[3];
        random_direction(tilt);
        const double size =
            class == PLATES ? random_length(1e-12, 1e-6) : random_length(1e-8, 1e-2);
        for (int i = 0; i < 3; i++) {
            spin[i] += uniform() < 0.3 ? 0.0 : size * tilt[i];
        }
    }
    assert_int_equal(tribo_quat_from_rotation_vector(spin, turn), TRIBO_OK);
    const int k = class == PLATES ? 0 : (int)(4.0 * uniform());
    tribo_quat_multiply(quarter[k], turn, q);
}

/* Two boxes whose true depth is about `depth` times the least half-extent. */
static void make_case(int class, double depth, double offset, box_case *c)
{
    const double scale = random_length(1e-3, 1e3);
    double direction[3];
    double q[4];
    memset(c, 0, sizeof *c);
    c->a.type = c->b.type = TRIBO_SHAPE_BOX;
    random_sizes(class, scale, c->a.size);
    random_sizes(class, uniform() < 0.3 ? scale : scale * random_length(0.1, 10.0), c->b.size);
    if (uniform() < 0.2) {
        memcpy(c->b.size, c->a.size, sizeof c->b.size);
    }
    c->small = INFINITE;
    for (int i = 0; i < 3; i++) {
        c->small = fmin(c->small, fmin(c->a.size[i], c->b.size[i]));
        c->large += c->a.size[i] + c->b.size[i];
        c->pa.position[i] = offset * between(-1.0, 1.0);
    }
    random_turn(c->pa.orientation);
    if (uniform() < 0.3) {
        memcpy(c->pa.orientation, (const double[]){1, 0, 0, 0}, sizeof c->pa.orientation);
    }
    relative_turn(class, q);
    tribo_quat_multiply(c->pa.orientation, q, c->pb.orientation);
    memcpy(c->pb.position, c->pa.position, sizeof c->pb.position);
    if (class == CONCENTRIC) {
        random_direction(direction);
        for (int i = 0; i < 3; i++) {
            c->pb.position[i] += (uniform() < 0.5 ? 0.0 : 1e-9 * c->small) * direction[i];
        }
        return;
    }
    /* Along a random direction, or along a face normal and a step aside, until the depth is
     * right. */
    double side[3] = {0.0, 0.0, 0.0};
    random_direction(direction);
    if (class == PLATES || (class != RANDOM && class != SLENDER && uniform() < 0.7)) {
        const double local[3] = {0.0, 0.0, uniform() < 0.5 ? 1.0 : -1.0};
        const double shift[3] = {between(-1, 1) * c->a.size[0], between(-1, 1) * c->a.size[1], 0.0};
        tribo_quat_rotate(c->pa.orientation, local, direction);
        tribo_quat_rotate(c->pa.orientation, shift, side);
    }
    solid_box a;
    solid_box b;
    tribo_pose start = c->pb;
    for (int i = 0; i < 3; i++) {
        start.position[i] = side[i];
    }
    take_box(&c->a, &c->pa, c->pa.position, &a);
    take_box(&c->b, &start, (const double[]){0.0, 0.0, 0.0}, &b);
    const double way = way_to_depth(&a, &b, direction, depth * c->small);
    for (int i = 0; i < 3; i++) {
        c->pb.position[i] = c->pa.position[i] + (side[i] + way * direction[i]);
    }
}

/* How far a point, given from the centre of A, lies outside of a box. */
static double outside_by(const tribo_shape *shape, const tribo_pose *pose, const double arm[3])
{
    double local[3];
    double most = -INFINITE;
    tribo_quat_rotate_inverse(pose->orientation, arm, local);
    for (int i = 0; i < 3; i++) {
        most = fmax(most, fabs(local[i]) - shape->size[i]);
    }
    return most;
}

typedef struct tally {
    long pairs, missed, wrong, displaced;
    double excess;   /* greatest width along the normal over true depth, relative */
    double distance; /* greatest error of the deepest distance, of the sizes */
    double outside;  /* greatest way of a point out of a box beyond half its depth, of the sizes */
} tally;

static void judge_case(const box_case *c, const tribo_manifold *m, tally *t)
{
    solid_box a;
    solid_box b;
    const real depth = depth_of(c);
    const double rounding = 1e-14 * (c->large + apart(c->pa.position, c->pb.position));
    t->pairs++;
    if (m->count == 0) {
        t->missed += depth > (real)rounding;
        return;
    }
    const real n[3] = {(real)m->normal[0], (real)m->normal[1], (real)m->normal[2]};
    take_box(&c->a, &c->pa, c->pa.position, &a);
    take_box(&c->b, &c->pb, c->pa.position, &b);
    const real width = width_along(&a, &b, n);
    const double excess = (double)((width - depth) / depth);
    if (depth > 100.0L * (real)rounding) {
        t->excess = fmax(t->excess, excess);
    }
    t->wrong += width - depth > 0.01L * depth + (real)rounding;
    t->distance = fmax(t->distance, fabs((double)((real)deepest(m) + width)) / c->large);
    for (uint32_t k = 0; k < m->count; k++) {
        const tribo_point *p = &m->points[k];
        const double out =
            fmax(outside_by(&c->a, &c->pa, p->arm_a), outside_by(&c->b, &c->pb, p->arm_b)) -
            0.5 * fabs(p->distance);
        t->outside = fmax(t->outside, out / c->large);
        t->displaced +=
            apart(p->arm_a, p->arm_b) > apart(c->pa.position, c->pb.position) + 1e-12 * c->large;
    }
}

static void try_classes(uint32_t method, int pairs, tally t[BOX_CLASSES])
{
    static const double depths[6] = {0.2, 1e-2, 1e-3, 1e-4, 1e-6, 0.0};
    tribo_collide_options options = with_margin(0.0);
    options.method = method;
    memset(t, 0, BOX_CLASSES * sizeof *t);
    print_message("# boxes: pairs, missed, wrong directions, excess of width, errors / size\n");
    for (int class = 0; class < BOX_CLASSES; class ++) {
        for (int i = 0; i < pairs; i++) {
            box_case c;
            make_case(class, depths[i % 6], i % 12 < 6 ? 0.0 : 1e6, &c);
            const tribo_manifold m = pair_of(&c.a, &c.pa, &c.b, &c.pb, &options);
            judge_case(&c, &m, &t[class]);
        }
        print_message("# %-18s %6ld %4ld %4ld %9.2e  distance %.1e outside %.1e\n",
                      box_names[class], t[class].pairs, t[class].missed, t[class].wrong,
                      t[class].excess, t[class].distance, t[class].outside);
    }
}

static void boxes_against_separating_axes(void **state)
{
    tally t[BOX_CLASSES];
    (void)state;
    try_classes(TRIBO_METHOD_CLOSED, 14400, t);
    for (int class = 0; class < BOX_CLASSES; class ++) {
        assert_int_equal(t[class].missed, 0);
        assert_int_equal(t[class].wrong, 0);
        assert_int_equal(t[class].displaced, 0);
        assert_true(t[class].distance <= 1e-14);
        assert_true(t[class].outside <= 1e-12);
    }
}

/* The same by support functions and clipped support faces. */
static void boxes_by_the_general_method(void **state)
{
    tally t[BOX_CLASSES];
    (void)state;
    try_classes(TRIBO_METHOD_GENERAL, 1200, t);
    for (int class = 0; class < BOX_CLASSES; class ++) {
        assert_int_equal(t[class].missed, 0);
        assert_int_equal(t[class].wrong, 0);
        assert_int_equal(t[class].displaced, 0);
        assert_true(t[class].outside <= 1e-9);
    }
}

/* Plates 2000:1 that lie on each other, near enough to flat: the normal is that of a face to the
 * bit, however large the lever of its noise would be. */
static void plates_take_a_face_normal(void **state)
{
    tribo_collide_options options = with_margin(0.0);
    (void)state;
    options.method = TRIBO_METHOD_GENERAL;
    for (int i = 0; i < 600; i++) {
        static const double depths[3] = {0.2, 1e-4, 1e-6};
        const tribo_shape plate = make(TRIBO_SHAPE_BOX, 1000.0, 1000.0, 0.5);
        const double x = between(-1900.0, 1900.0);
        const double y = between(-1900.0, 1900.0);
        const tribo_pose pa = turned(at(x, y, 1.0 - depths[i % 3]), 0, 0, between(-3.0, 3.0));
        const tribo_pose pb = at(0, 0, 0);
        const tribo_manifold m = pair_of(&plate, &pa, &plate, &pb, &options);
        if (m.count == 0) {
            continue;
        }
        if (fabs(m.normal[2]) < 0.9) {
            continue; /* corners that barely overlap part sideways */
        }
        assert_vector(m.normal, 0, 0, 1, 0);
        for (uint32_t k = 0; k < m.count; k++) {
            assert_near(m.points[k].distance, -depths[i % 3], 1e-12);
        }
    }
}

/* An axis with noise on a large lever comes out as the normal of a face, and its depth with it. */
static void noise_of_an_axis_does_not_show(void **state)
{
    (void)state;
    const tribo_shape plate = make(TRIBO_SHAPE_BOX, 1000.0, 1000.0, 0.5);
    for (int i = 0; i < 200; i++) {
        pair_query query;
        tribo_manifold m;
        memset(&query, 0, sizeof query);
        query.a = query.b = &plate;
        query.ra[0] = query.ra[4] = query.ra[8] = 1.0;
        memcpy(query.rb, query.ra, sizeof query.rb);
        query.offset[0] = between(-1000.0, 1000.0);
        query.offset[1] = between(-1000.0, 1000.0);
        query.offset[2] = -0.9999;
        query.max_points = 4;
        const double tilt[2] = {between(-1e-8, 1e-8), between(-1e-8, 1e-8)};
        pair_axis axis = {{tilt[0], tilt[1], 1.0}, 0.0};
        double rounding;
        assert_true(clip_distance(&query, axis.normal, &axis.distance, &rounding));
        clip_manifold(&query, &axis, &m);
        assert_int_equal(m.count, 4);
        assert_vector(m.normal, 0, 0, 1, 0);
        for (uint32_t k = 0; k < 4; k++) {
            assert_near(m.points[k].distance, -1e-4, 1e-12);
        }
    }
}

/* ---- separated boxes ------------------------------------------------------------------------ */

static real distance_to_box(const solid_box *x, const real p[3])
{
    real square = 0;
    for (int i = 0; i < 3; i++) {
        real low;
        real high;
        extent_along(x, x->axis[i], &low, &high);
        const real h = x->axis[i][0] * p[0] + x->axis[i][1] * p[1] + x->axis[i][2] * p[2];
        const real out = h < low ? low - h : h > high ? h - high : 0;
        square += out * out;
    }
    return sqrtl(square);
}

/* Distance of the segments p + s d and q + t e, s and t in [0, 1], by trying all of the edge's
 * cases. */
static real distance_of_edges(const real p[3], const real p1[3], const real q[3], const real q1[3])
{
    real dd = 0, ee = 0, de = 0, dr = 0, er = 0;
    for (int i = 0; i < 3; i++) {
        const real d = p1[i] - p[i];
        const real e = q1[i] - q[i];
        const real r = p[i] - q[i];
        dd += d * d;
        ee += e * e;
        de += d * e;
        dr += d * r;
        er += e * r;
    }
    real least = (real)HUGE_VAL;
    const real determinant = dd * ee - de * de;
    for (int k = 0; k < 5; k++) {
        real s = k == 0 ? 0 : k == 1 ? 1 : 0;
        real t = k == 2 ? 0 : 1;
        if (k < 2) {
            t = (er + s * de) / ee;
        } else if (k < 4) {
            s = (t * de - dr) / dd;
        } else if (determinant > 1e-12L * dd * ee) {
            s = (de * er - ee * dr) / determinant;
            t = (dd * er - de * dr) / determinant;
        }
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        real square = 0;
        for (int i = 0; i < 3; i++) {
            const real gap = p[i] + s * (p1[i] - p[i]) - q[i] - t * (q1[i] - q[i]);
            square += gap * gap;
        }
        least = square < least ? square : least;
    }
    return sqrtl(least);
}

static real true_distance(const solid_box *a, const solid_box *b)
{
    real least = (real)HUGE_VAL;
    for (int c = 0; c < 8; c++) {
        const real d[2] = {distance_to_box(a, b->corner[c]), distance_to_box(b, a->corner[c])};
        least = d[0] < least ? d[0] : least;
        least = d[1] < least ? d[1] : least;
    }
    for (int c = 0; c < 64; c++) {
        for (int e = 0; e < 9; e++) {
            const int i = c & 7;
            const int j = c >> 3;
            if ((i >> e / 3 & 1) == 0 && (j >> e % 3 & 1) == 0) {
                const real d = distance_of_edges(a->corner[i], a->corner[i | 1 << e / 3],
                                                 b->corner[j], b->corner[j | 1 << e % 3]);
                least = d < least ? d : least;
            }
        }
    }
    return least;
}

/* Boxes apart are reported if, and only if, they are not farther apart than the margin; no point is
 * nearer than the truth, and each lies between the surfaces. */
static void boxes_within_the_margin(void **state)
{
    (void)state;
    long reported = 0;
    for (int i = 0; i < 20000; i++) {
        box_case c;
        solid_box a;
        solid_box b;
        make_case(i % 3 == 0 ? RANDOM : i % 3 == 1 ? FACE_ALIGNED : FACE_TILTED, 0.0, 0.0, &c);
        const double step = c.small * random_length(1e-6, 1.0);
        double way[3];
        random_direction(way);
        for (int k = 0; k < 3; k++) {
            c.pb.position[k] += step * way[k];
        }
        take_box(&c.a, &c.pa, c.pa.position, &a);
        take_box(&c.b, &c.pb, c.pa.position, &b);
        const double distance = (double)true_distance(&a, &b);
        if (!(distance > 1e-12 * c.large) || depth_of(&c) > 0) {
            continue;
        }
        tribo_collide_options o = with_margin(fmax(distance * (1.0 - 1e-9) - 1e-14 * c.large, 0.0));
        tribo_manifold m = pair_of(&c.a, &c.pa, &c.b, &c.pb, &o);
        assert_int_equal(m.count, 0);
        o.margin = distance * (1.0 + 1e-9) + 1e-14 * c.large;
        m = pair_of(&c.a, &c.pa, &c.b, &c.pb, &o);
        assert_true(m.count > 0);
        assert_near(norm(m.normal), 1.0, 1e-15);
        reported++;
        for (uint32_t k = 0; k < m.count; k++) {
            const tribo_point *p = &m.points[k];
            assert_true(p->distance <= o.margin + 1e-14 * c.large);
            assert_true(outside_by(&c.a, &c.pa, p->arm_a) <= 0.5 * distance + 1e-9 * c.large);
            assert_true(outside_by(&c.b, &c.pb, p->arm_b) <= 0.5 * distance + 1e-9 * c.large);
        }
    }
    print_message("# %ld pairs apart reported at their distance\n", reported);
    assert_true(reported > 5000);
}

/* ---- the area of the points ----------------------------------------------------------------- */

/* Twice the area of the convex hull of points in the plane, by gift wrapping. */
static double hull_area(double (*p)[2], int count)
{
    int start = 0;
    for (int i = 1; i < count; i++) {
        start =
            p[i][0] < p[start][0] || (p[i][0] == p[start][0] && p[i][1] < p[start][1]) ? i : start;
    }
    double sum = 0.0;
    int from = start;
    for (int round = 0; round < count; round++) {
        int to = from == 0 ? 1 % count : 0;
        for (int i = 0; i < count; i++) {
            const double turn = (p[to][0] - p[from][0]) * (p[i][1] - p[from][1]) -
                                (p[to][1] - p[from][1]) * (p[i][0] - p[from][0]);
            to = turn < 0.0 ? i : to;
        }
        sum += p[from][0] * p[to][1] - p[from][1] * p[to][0];
        from = to;
        if (from == start) {
            break;
        }
    }
    return sum;
}

/* Corners of the overlap of a rectangle about the origin and one at (x, y), turned by `angle`:
 * corners of one in the other, and all crossings of sides. */
static int overlap_corners(const double h[2], const double g[2], double x, double y, double angle,
                           double (*out)[2])
{
    const double c = cos(angle);
    const double s = sin(angle);
    double p[2][4][2];
    int count = 0;
    for (int k = 0; k < 4; k++) {
        const double u = k == 0 || k == 3 ? 1.0 : -1.0;
        const double v = k < 2 ? 1.0 : -1.0;
        p[0][k][0] = u * h[0];
        p[0][k][1] = v * h[1];
        p[1][k][0] = x + c * u * g[0] - s * v * g[1];
        p[1][k][1] = y + s * u * g[0] + c * v * g[1];
    }
    for (int k = 0; k < 4; k++) {
        const double dx = p[0][k][0] - x;
        const double dy = p[0][k][1] - y;
        if (fabs(c * dx + s * dy) <= g[0] && fabs(c * dy - s * dx) <= g[1]) {
            memcpy(out[count++], p[0][k], sizeof *out);
        }
        if (fabs(p[1][k][0]) <= h[0] && fabs(p[1][k][1]) <= h[1]) {
            memcpy(out[count++], p[1][k], sizeof *out);
        }
        for (int l = 0; l < 4; l++) {
            const double *a = p[0][k];
            const double *b = p[0][(k + 1) % 4];
            const double *d = p[1][l];
            const double *e = p[1][(l + 1) % 4];
            const double turn = (b[0] - a[0]) * (e[1] - d[1]) - (b[1] - a[1]) * (e[0] - d[0]);
            const double f = ((d[0] - a[0]) * (e[1] - d[1]) - (d[1] - a[1]) * (e[0] - d[0])) / turn;
            const double t = ((d[0] - a[0]) * (b[1] - a[1]) - (d[1] - a[1]) * (b[0] - a[0])) / turn;
            if (f >= 0.0 && f <= 1.0 && t >= 0.0 && t <= 1.0) {
                out[count][0] = a[0] + f * (b[0] - a[0]);
                out[count++][1] = a[1] + f * (b[1] - a[1]);
            }
        }
    }
    return count;
}

/* The greatest area that four of the points can have, point `kept` among them (-1: any four). */
static double best_four(double (*p)[2], int count, int kept)
{
    double best = 0.0;
    for (int i = 0; i < count; i++) {
        for (int j = i + 1; j < count; j++) {
            for (int k = j + 1; k < count; k++) {
                for (int l = k; l < count; l++) {
                    double four[4][2] = {{p[i][0], p[i][1]},
                                         {p[j][0], p[j][1]},
                                         {p[k][0], p[k][1]},
                                         {p[l][0], p[l][1]}};
                    if (kept < 0 || i == kept || j == kept || k == kept || l == kept) {
                        best = fmax(best, hull_area(four, 4));
                    }
                }
            }
        }
    }
    return best;
}

static int nearest_to(double (*p)[2], int count, const double at[2])
{
    int best = 0;
    for (int i = 1; i < count; i++) {
        best =
            hypot(p[i][0] - at[0], p[i][1] - at[1]) < hypot(p[best][0] - at[0], p[best][1] - at[1])
                ? i
                : best;
    }
    return best;
}

typedef struct ratios {
    double sum;
    double worst;
    long count;
} ratios;

static void note(ratios *r, double ratio)
{
    r->worst = r->count == 0 ? ratio : fmin(r->worst, ratio);
    r->sum += ratio;
    r->count++;
}

static void print_ratios(const char *name, const ratios *r)
{
    print_message("# %-44s mean %.4f worst %.4f\n", name, r->sum / (double)r->count, r->worst);
}

/* A box on a plate of 2 x 2, flat to what does not count, or tilted a little. The overlap has up to
 * eight corners, of which four are kept: all of its area where it has no more, else what the best
 * four have, or, where one is the deepest, the best four with that. Four points can not do better;
 * eight would have it all. */
static void points_keep_the_area(void **state)
{
    static const double tilts[3] = {0.0, 1e-6, 1e-4};
    static const double plate[2] = {1.0, 1.0};
    ratios all = {0.0, 0.0, 0};
    ratios possible = all;
    ratios few = all;
    ratios flat = all;
    ratios tilted = all;
    ratios with_deepest = all;
    (void)state;
    for (int i = 0; i < 6000; i++) {
        const double h[2] = {between(0.2, 0.6), between(0.2, 0.6)};
        const double angle = between(-3.0, 3.0);
        const double x = between(-1.0, 1.0);
        const double y = between(-1.0, 1.0);
        const double tilt = tilts[i % 3];
        const tribo_shape a = make(TRIBO_SHAPE_BOX, h[0], h[1], 0.3);
        const tribo_shape b = make(TRIBO_SHAPE_BOX, plate[0], plate[1], 0.2);
        const double up[3] = {0.0, 0.0, 0.3};
        tribo_pose pa = turned(at(x, y, 0.199), tilt * sin(x), tilt * cos(x), angle);
        const tribo_pose pb = at(0, 0, 0);
        double middle[3];
        double truth[24][2];
        tribo_quat_rotate(pa.orientation, up, middle);
        tribo_vec3_add(pa.position, middle, pa.position); /* the lower face stays where it is */
        double points[4][2];
        int lowest = 0;
        const int corners = overlap_corners(plate, h, x, y, angle, truth);
        const double area = hull_area(truth, corners);
        if (area < 1e-2) {
            continue;
        }
        const tribo_manifold m = pair_of(&a, &pa, &b, &pb, NULL);
        for (uint32_t k = 0; k < m.count; k++) {
            points[k][0] = m.points[k].arm_b[0];
            points[k][1] = m.points[k].arm_b[1];
            lowest = m.points[k].distance < m.points[lowest].distance ? (int)k : lowest;
        }
        const double mine = hull_area(points, (int)m.count);
        note(&all, mine / area);
        if (corners <= 4) {
            note(&few, mine / area);
            note(&possible, 1.0);
            continue;
        }
        const double best = best_four(truth, corners, -1);
        note(&possible, best / area);
        note(tilt < 1e-5 ? &flat : &tilted, mine / best);
        if (tilt > 1e-5) {
            const int deep = nearest_to(truth, corners, points[lowest]);
            note(&with_deepest, mine / best_four(truth, corners, deep));
        }
    }
    print_ratios("area over the true overlap, 4 points:", &all);
    print_ratios("the best 4 of its corners (all 8: 1):", &possible);
    print_ratios("overlap of up to 4 corners, over the true:", &few);
    print_ratios("of more, flat, over the best 4:", &flat);
    print_ratios("of more, tilted, over the best 4:", &tilted);
    print_ratios("tilted, over the best 4 with the deepest:", &with_deepest);
    assert_true(few.worst >= 1.0 - 1e-5);
    assert_true(all.sum / (double)all.count >= 0.97);
    assert_true(flat.worst >= 0.99 && with_deepest.worst >= 0.99);
    assert_true(tilted.sum / (double)tilted.count >= 0.99);
}

/* A cylinder that stands nearly upright: its lowest point, on the rim, joins the eight of its base,
 * in its place. */
static void rims_keep_the_area(void **state)
{
    const tribo_shape cylinder = make(TRIBO_SHAPE_CYLINDER, 1.0, 0.5, 0.0);
    const tribo_shape ground = {TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0}, NULL};
    const tribo_pose here = at(0, 0, 0);
    const tribo_collide_options options = with_margin(0.1);
    double least = 2.0;
    (void)state;
    for (int i = 0; i < 1000; i++) {
        const double angle = between(-3.0, 3.0);
        const tribo_pose pose = turned(at(0, 0, 0.49), 0.01 * cos(angle), 0.01 * sin(angle), 0.0);
        const tribo_manifold m = pair_of(&cylinder, &pose, &ground, &here, &options);
        double points[4][2];
        assert_int_equal(m.count, 4);
        for (uint32_t k = 0; k < 4; k++) {
            points[k][0] = m.points[k].arm_a[0];
            points[k][1] = m.points[k].arm_a[1];
        }
        least = fmin(least, 0.5 * hull_area(points, 4));
        assert_near(deepest(&m), 0.49 - (0.5 * cos(0.01) + sin(0.01)), 1e-15);
    }
    print_message("# four points of a circle: %.4f of the square in it at least\n", 0.5 * least);
    assert_true(least >= 2.0 * 0.95);
}

/* ---- the same answer from elsewhere --------------------------------------------------------- */

enum { KINDS = 8 };

static double block[2048];

/* A shape of each convex kind, and a half-space. */
static tribo_shape kind_of(int k)
{
    static const uint32_t types[KINDS] = {
        TRIBO_SHAPE_SPHERE, TRIBO_SHAPE_BOX,       TRIBO_SHAPE_CAPSULE, TRIBO_SHAPE_CYLINDER,
        TRIBO_SHAPE_CONE,   TRIBO_SHAPE_ELLIPSOID, TRIBO_SHAPE_HULL,    TRIBO_SHAPE_HALFSPACE};
    const uint32_t type = types[k];
    tribo_shape s = make(type, between(0.4, 1.0), 0.0, 0.0);
    s.size[1] = type != TRIBO_SHAPE_SPHERE ? between(0.4, 1.0) : 0.0;
    s.size[2] = type == TRIBO_SHAPE_BOX || type == TRIBO_SHAPE_ELLIPSOID ? between(0.4, 1.0) : 0.0;
    if (type == TRIBO_SHAPE_HULL) {
        memset(s.size, 0, sizeof s.size);
        s.data = block;
    }
    if (type == TRIBO_SHAPE_HALFSPACE) {
        random_direction(s.size);
        const double length = norm(s.size);
        for (int i = 0; i < 3; i++) {
            s.size[i] /= length;
        }
        s.size[3] = between(-0.5, 0.5);
    }
    return s;
}

static void build_hull(void)
{
    double points[20][3];
    for (int k = 0; k < 20; k++) {
        random_direction(points[k]);
        for (int i = 0; i < 3; i++) {
            points[k][i] *= between(0.6, 0.9);
        }
    }
    assert_int_equal(tribo_hull_build(20, points[0], block, sizeof block, NULL), TRIBO_OK);
}

/* Positions on a grid, so that they stay exact when 2^20 is added. */
static tribo_pose random_pose(double reach)
{
    tribo_pose p;
    for (int i = 0; i < 3; i++) {
        p.position[i] = floor(0x1p20 * between(-reach, reach)) * 0x1p-20;
    }
    random_turn(p.orientation);
    if (uniform() < 0.3) {
        p = at(p.position[0], p.position[1], p.position[2]);
    }
    return p;
}

static int same_number(double x, double y)
{
    return x == y;
}

/* Whether n is m with A and B swapped, all lengths times `scale`. */
static int is_mirror(const tribo_manifold *m, const tribo_manifold *n, double scale)
{
    int same = m->count == n->count;
    for (int i = 0; i < 3; i++) {
        same = same && same_number(m->normal[i], 0.0 - n->normal[i]);
    }
    for (uint32_t k = 0; same && k < m->count; k++) {
        const tribo_point *p = &m->points[k];
        const tribo_point *q = &n->points[k];
        same =
            same_number(scale * p->distance, q->distance) && (p->id << 32 | p->id >> 32) == q->id;
        for (int i = 0; i < 3; i++) {
            same = same && same_number(scale * p->arm_a[i], q->arm_b[i]) &&
                   same_number(scale * p->arm_b[i], q->arm_a[i]);
        }
    }
    return same;
}

static void swap_offset_and_scale_change_no_bit(void **state)
{
    (void)state;
    long touching = 0;
    build_hull();
    const tribo_collide_options options = with_margin(0.125);
    for (int i = 0; i < 12000; i++) {
        tribo_shape a = kind_of(i % KINDS);
        tribo_shape b = kind_of(i / KINDS % KINDS);
        tribo_pose pa = random_pose(1.0);
        tribo_pose pb = random_pose(1.0);
        if (a.type == b.type && a.type == TRIBO_SHAPE_HALFSPACE) {
            continue;
        }
        if (uniform() < 0.2) {
            memcpy(b.size, a.size, a.type == b.type ? sizeof b.size : 0);
            memcpy(pb.orientation, pa.orientation, sizeof pb.orientation);
        }
        const tribo_manifold m = pair_of(&a, &pa, &b, &pb, &options);
        touching += m.count > 0;
        assert_true(
            is_mirror(&m, (const tribo_manifold[]){pair_of(&b, &pb, &a, &pa, &options)}, 1.0));
        const double far = 0x1p20;
        pa.position[0] += far;
        pb.position[0] += far;
        pa.position[2] -= far;
        pb.position[2] -= far;
        assert_true(
            is_mirror(&m, (const tribo_manifold[]){pair_of(&b, &pb, &a, &pa, &options)}, 1.0));
        if (a.type == TRIBO_SHAPE_HULL || b.type == TRIBO_SHAPE_HULL) {
            continue;
        }
        const double scale = i % 3 == 0 ? 0x1p-100 : i % 3 == 1 ? 0x1p100 : 0x1p10;
        tribo_collide_options scaled = options;
        scaled.margin *= scale;
        for (int k = 0; k < 4; k++) {
            a.size[k] *= a.type == TRIBO_SHAPE_HALFSPACE && k < 3 ? 1.0 : scale;
            b.size[k] *= b.type == TRIBO_SHAPE_HALFSPACE && k < 3 ? 1.0 : scale;
        }
        for (int k = 0; k < 3; k++) {
            pa.position[k] *= scale;
            pb.position[k] *= scale;
        }
        assert_true(
            is_mirror(&m, (const tribo_manifold[]){pair_of(&b, &pb, &a, &pa, &scaled)}, scale));
    }
    print_message("# %ld pairs that touch\n", touching);
    assert_true(touching > 5000);
}

/* The same pair turned as a whole: depth and normal turn with it. */
static void rigid_motion_turns_the_answer(void **state)
{
    (void)state;
    double closed = 0.0;
    double general = 0.0;
    build_hull();
    for (int i = 0; i < 6000; i++) {
        const tribo_shape a = kind_of(i % KINDS);
        const tribo_shape b = kind_of(i / KINDS % KINDS);
        if (a.type == b.type && a.type == TRIBO_SHAPE_HALFSPACE) {
            continue;
        }
        tribo_pose p[2] = {random_pose(1.0), random_pose(1.0)};
        tribo_pose q[2];
        double turn[4];
        double back[3];
        random_turn(turn);
        for (int k = 0; k < 2; k++) {
            tribo_quat_rotate(turn, p[k].position, q[k].position);
            tribo_quat_multiply(turn, p[k].orientation, q[k].orientation);
        }
        const tribo_manifold m = pair_of(&a, &p[0], &b, &p[1], NULL);
        const tribo_manifold n = pair_of(&a, &q[0], &b, &q[1], NULL);
        if (m.count == 0 || n.count == 0) {
            assert_true(m.count == n.count);
            continue;
        }
        const double change = fabs(deepest(&m) - deepest(&n));
        if (m.method == TRIBO_METHOD_GENERAL) {
            general = fmax(general, change / fabs(deepest(&m)));
            continue;
        }
        closed = fmax(closed, change);
        tribo_quat_rotate_inverse(turn, n.normal, back);
        assert_true(apart(back, m.normal) <= 1e-9);
        assert_int_equal(m.count, n.count);
    }
    print_message("# depths change by %.1e (closed), %.1e of themselves (general) at most\n",
                  closed, general);
    assert_true(closed <= 1e-14);
    assert_true(general <= 0.01);
}

static int has_id(const tribo_manifold *m, uint64_t id)
{
    int found = 0;
    for (uint32_t k = 0; k < m->count; k++) {
        found |= m->points[k].id == id;
    }
    return found;
}

/* Resting poses moved by 1e-6: the same points under the same names. */
static void ids_survive_small_motions(void **state)
{
    (void)state;
    long kept = 0;
    long all = 0;
    for (int i = 0; i < 4000; i++) {
        const tribo_shape a = make(TRIBO_SHAPE_BOX, between(0.3, 0.6), between(0.3, 0.6), 0.3);
        const tribo_shape ground =
            i % 2 == 0 ? make(TRIBO_SHAPE_BOX, 1.0, 1.0, 0.5)
                       : (tribo_shape){TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0.5}, NULL};
        const tribo_pose origin = at(0, 0, 0);
        const double x = between(-1.0, 1.0);
        const double y = between(-1.0, 1.0);
        const double angle = between(-3.0, 3.0);
        const tribo_pose p = turned(at(x, y, 0.7999), 0, 0, angle);
        double d[3];
        random_direction(d);
        const tribo_pose q = turned(at(x + 1e-6 * d[0], y + 1e-6 * d[1], 0.7999 + 1e-6 * d[2]),
                                    1e-6 * d[1], 1e-6 * d[2], angle + 1e-6 * d[0]);
        const tribo_manifold m = pair_of(&a, &p, &ground, &origin, NULL);
        const tribo_manifold n = pair_of(&a, &q, &ground, &origin, NULL);
        assert_int_equal(m.count, n.count);
        for (uint32_t k = 0; k < m.count; k++) {
            kept += has_id(&n, m.points[k].id);
            all++;
            for (uint32_t l = k + 1; l < m.count; l++) {
                assert_true(m.points[k].id != m.points[l].id);
            }
        }
    }
    print_message("# %ld of %ld ids kept\n", kept, all);
    assert_true((double)kept >= 0.99 * (double)all);
}

/* A box on another of its width, of which edges and corners lie on each other: which of them are
 * found is up to noise, their names are not. Moves of `step` on both, in any frame. Twisted there are
 * up to eight corners, of which two fours may be as good as each other, and which of them is the
 * deepest is up to noise too. */
static void shake_stack(uint32_t method, int flush, double step, long *kept, long *all)
{
    static const double shifts[4][2] = {{0, 0}, {0.25, 0}, {0, -0.5}, {0.5, 0.5}};
    const double turns[4] = {0.0, 0.5, 1.0, between(0.02, 0.98)};
    const tribo_collide_options options = {sizeof options, method, 0, 0, 1e-3};
    const double wide = between(0.3, 2.0);
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 0.5 * wide, 0.5 * wide, 0.5);
    const double *shift = shifts[flush % 2 != 0 ? 0 : flush / 4 % 4];
    const double turn = 1.5707963267948966 * turns[flush % 4];
    const int swap = uniform() < 0.5;
    tribo_manifold first = {0};
    double frame[4];
    random_turn(frame);
    for (int i = 0; i < 8; i++) {
        tribo_pose poses[2];
        for (int k = 0; k < 2; k++) {
            double d[3];
            double e[3];
            random_direction(d);
            random_direction(e);
            const tribo_pose p =
                turned(at((k == 0 ? shift[0] * wide : 0.0) + step * d[0],
                          (k == 0 ? shift[1] * wide : 0.0) + step * d[1],
                          (k == 0 ? 1.0 - 1e-5 : 0.0) + step * d[2]),
                       step * e[0], step * e[1], (k == 0 ? turn : 0.0) + step * e[2]);
            tribo_quat_rotate(frame, p.position, poses[k].position);
            tribo_quat_multiply(frame, p.orientation, poses[k].orientation);
        }
        const tribo_manifold m =
            pair_of(&box, &poses[swap ? 1 : 0], &box, &poses[swap ? 0 : 1], &options);
        assert_true(is_mirror(&m,
                              (const tribo_manifold[]){pair_of(&box, &poses[swap ? 0 : 1], &box,
                                                               &poses[swap ? 1 : 0], &options)},
                              1.0));
        assert_int_equal(m.count, 4);
        for (uint32_t k = 0; k < m.count && i > 0; k++) {
            *kept += has_id(&first, m.points[k].id);
            *all += 1;
            for (uint32_t l = k + 1; l < m.count; l++) {
                assert_true(m.points[k].id != m.points[l].id);
            }
        }
        first = i == 0 ? m : first;
    }
}

static void ids_survive_in_stacks(void **state)
{
    (void)state;
    for (uint32_t method = TRIBO_METHOD_CLOSED; method <= TRIBO_METHOD_GENERAL; method++) {
        for (int decade = -9; decade <= -6; decade++) {
            long kept = 0;
            long all = 0;
            for (int flush = 0; flush < 16; flush++) {
                for (int i = 0; i < 20; i++) {
                    shake_stack(method, flush, pow(10.0, decade), &kept, &all);
                }
            }
            print_message("# moves of 1e%d, %s: %ld of %ld ids kept\n", decade,
                          method == TRIBO_METHOD_CLOSED ? "closed" : "general", kept, all);
            assert_true(kept == all);
        }
    }
}

/* ---- degenerate places ---------------------------------------------------------------------- */

static void no_place_gives_what_is_no_number(void **state)
{
    static const double steps[6] = {0.0, 1e-300, 1e-160, 1e-17, 1e-9, 0.5};
    (void)state;
    build_hull();
    for (int i = 0; i < KINDS * KINDS; i++) {
        for (int k = 0; k < 6; k++) {
            for (int axis = 0; axis < 4; axis++) {
                const tribo_shape a = kind_of(i % KINDS);
                const tribo_shape b =
                    uniform() < 0.5 && i % KINDS == i / KINDS ? a : kind_of(i / KINDS);
                if (a.type == TRIBO_SHAPE_HALFSPACE && b.type == TRIBO_SHAPE_HALFSPACE) {
                    continue;
                }
                tribo_pose pa = at(0, 0, 0);
                tribo_pose pb = at(0, 0, 0);
                if (axis < 3) {
                    pb.position[axis] = steps[k];
                } else {
                    pb = turned(pb, 1.5707963267948966, 0, 0);
                }
                const tribo_manifold m = pair_of(&a, &pa, &b, &pb, NULL);
                if (m.count == 0) {
                    continue;
                }
                assert_near(norm(m.normal), 1.0, 1e-14);
                for (uint32_t c = 0; c < m.count; c++) {
                    const tribo_point *p = &m.points[c];
                    assert_true(p->distance <= 1e-14 && norm(p->arm_a) < 1e3 &&
                                norm(p->arm_b) < 1e3);
                }
            }
        }
    }
}

/* ---- parts ---------------------------------------------------------------------------------- */

static uint32_t all_of(const tribo_shape *a, tribo_pose pa, const tribo_shape *b, tribo_pose pb,
                       uint32_t capacity, tribo_manifold *m)
{
    uint32_t count = 0;
    assert_int_equal(tribo_collide_shapes(a, &pa, b, &pb, NULL, capacity, m, &count, NULL),
                     TRIBO_OK);
    return count;
}

/* A dumb-bell of two spheres and a box gives what its parts give alone. */
static void compounds_are_their_parts(void **state)
{
    (void)state;
    const tribo_child children[3] = {
        {make(TRIBO_SHAPE_SPHERE, 0.5, 0, 0), at(-1, 0, 0)},
        {make(TRIBO_SHAPE_BOX, 1.0, 0.125, 0.125), at(0, 0, 0)},
        {make(TRIBO_SHAPE_SPHERE, 0.5, 0, 0), at(1, 0, 0)},
    };
    const tribo_shape bell = {TRIBO_SHAPE_COMPOUND, 3, {0, 0, 0, 0}, children};
    const tribo_shape plane = {TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0}, NULL};
    const tribo_shape plate = make(TRIBO_SHAPE_BOX, 4, 4, 0.5);
    tribo_manifold m[9];
    assert_int_equal(all_of(&bell, at(3, 0, 0.4375), &plane, at(0, 0, 0), 9, m), 2);
    assert_int_equal(m[0].child_a, 0);
    assert_int_equal(m[1].child_a, 2);
    assert_vector(m[0].points[0].arm_a, -1, 0, -0.46875, 1e-15);
    assert_vector(m[1].points[0].arm_b, 4, 0, -0.03125, 1e-15);
    assert_near(m[1].points[0].distance, -0.0625, 1e-15);
    assert_int_equal(all_of(&plate, at(0, 0, -0.5), &bell, at(0, 0, 0.0625), 9, m), 3);
    for (uint32_t k = 0; k < 3; k++) {
        assert_int_equal(m[k].child_a, 0);
        assert_int_equal(m[k].child_b, k);
        assert_vector(m[k].normal, 0, 0, -1, 1e-15);
    }
    assert_int_equal(m[1].count, 4);
    assert_vector(m[0].points[0].arm_b, -1, 0, -0.28125, 1e-15);
    const tribo_shape ball = make(TRIBO_SHAPE_SPHERE, 0.5, 0, 0);
    assert_int_equal(all_of(&bell, at(0, 0, 0), &ball, at(-1, 0, 0.96875), 9, m), 1);
    assert_vector(m[0].points[0].arm_a, -1, 0, 0.484375, 1e-15);
    /* Bells crossed: bar on bar, and each bar between the other's balls. */
    const uint32_t count =
        all_of(&bell, at(0, 0, 0), &bell, turned(at(0, 0, 0.2), 0, 0, 1.5707963267948966), 9, m);
    assert_int_equal(count, 1);
    assert_int_equal(m[0].child_a, 1);
    assert_int_equal(m[0].child_b, 1);
}

static double ground[4096];

/* Terrain: a square of two triangles in each cell of a grid of 8 x 8 cells, flat or like a roof
 * along x = 4. */
static tribo_shape terrain(double slope)
{
    double vertices[81][3];
    uint32_t triangles[128][3];
    for (int i = 0; i < 81; i++) {
        vertices[i][0] = i % 9;
        vertices[i][1] = i / 9;
        vertices[i][2] = slope * (4.0 - fabs(i % 9 - 4.0));
    }
    for (uint32_t c = 0; c < 64; c++) {
        const uint32_t v = c % 8 + 9 * (c / 8);
        const uint32_t corners[2][3] = {{v, v + 1, v + 10}, {v, v + 10, v + 9}};
        memcpy(triangles[2 * c], corners, sizeof corners);
    }
    size_t needed = 0;
    const tribo_status status =
        tribo_mesh_build(81, vertices[0], 128, triangles[0], ground, sizeof ground, &needed);
    assert_int_equal(status, TRIBO_OK);
    const tribo_shape mesh = {TRIBO_SHAPE_MESH, 0, {0, 0, 0, 0}, ground};
    return mesh;
}

/* Whatever rolls or slides on flat terrain meets normals straight up only, and nothing but its
 * depth. */
static void inner_edges_do_not_show(void **state)
{
    (void)state;
    const tribo_shape mesh = terrain(0.0);
    build_hull();
    long manifolds = 0;
    for (int i = 0; i < 3000; i++) {
        const tribo_shape s = kind_of(i % (KINDS - 1));
        tribo_pose pose = random_pose(1.0);
        double low[3];
        double high[3];
        pose.position[0] = between(2.0, 6.0);
        pose.position[1] = between(2.0, 6.0);
        assert_int_equal(tribo_shape_bounds(&s, &pose, low, high), TRIBO_OK);
        pose.position[2] -= low[2] + 0.01;
        tribo_manifold m[128];
        const uint32_t count = all_of(&s, pose, &mesh, at(0, 0, 0), 128, m);
        double least = 0.0;
        assert_true(count > 0);
        for (uint32_t k = 0; k < count; k++) {
            assert_vector(m[k].normal, 0, 0, 1, 1e-14);
            assert_true(k == 0 || m[k].child_b > m[k - 1].child_b);
            least = fmin(least, deepest(&m[k]));
            manifolds++;
        }
        assert_near(least, -0.01, 1e-12);
    }
    print_message("# %ld manifolds with triangles\n", manifolds);
}

/* What has its core below the surface has come from there. */
static void meshes_have_one_side(void **state)
{
    (void)state;
    const tribo_shape mesh = terrain(0.0);
    const tribo_shape shapes[2] = {make(TRIBO_SHAPE_SPHERE, 0.5, 0, 0),
                                   make(TRIBO_SHAPE_BOX, 0.5, 0.5, 0.5)};
    tribo_manifold m[16];
    for (int k = 0; k < 2; k++) {
        assert_true(all_of(&shapes[k], at(4.25, 4.5, 0.0625), &mesh, at(0, 0, 0), 16, m) > 0);
        assert_int_equal(all_of(&shapes[k], at(4.25, 4.5, -0.0625), &mesh, at(0, 0, 0), 16, m), 0);
    }
}

static void fill_stack(int byte)
{
    volatile unsigned char below[16384];
    for (size_t i = 0; i < sizeof below; i++) {
        below[i] = (unsigned char)byte;
    }
}

/* Two calls are alike to the last byte, whatever has been on the stack before. */
static void nothing_of_the_stack_shows(void **state)
{
    (void)state;
    const tribo_shape mesh = terrain(0.0);
    const tribo_shape rod = make(TRIBO_SHAPE_CAPSULE, 0.5, 3.0, 0);
    const tribo_pose lying = {{4.1, 4.2, 0.4}, {sqrt(0.5), 0, sqrt(0.5), 0}};
    static tribo_manifold m[2][128];
    for (int k = 0; k < 2; k++) {
        memset(m[k], 0, sizeof m[k]);
        fill_stack(k == 0 ? 0x11 : 0xee);
        assert_true(all_of(&rod, lying, &mesh, at(0, 0, 0), 128, m[k]) > 8);
    }
    assert_memory_equal(m[0], m[1], sizeof m[0]);
}

/* The ridge of a roof is an edge that a body may touch. */
static void ridges_show(void **state)
{
    (void)state;
    const tribo_shape mesh = terrain(1.0);
    const tribo_shape sphere = make(TRIBO_SHAPE_SPHERE, 0.5, 0, 0);
    tribo_manifold m[16];
    const uint32_t count = all_of(&mesh, at(0, 0, 0), &sphere, at(4, 4.25, 4.4), 16, m);
    assert_true(count >= 1);
    for (uint32_t k = 0; k < count; k++) {
        assert_vector(m[k].normal, 0, 0, -1, 1e-14);
        assert_near(m[k].points[0].distance, -0.1, 1e-14);
        assert_vector(m[k].points[0].arm_a, 4, 4.25, 3.95, 1e-14);
        assert_true(k == 0 || m[k].child_a > m[k - 1].child_a);
    }
}

/* ---- judging -------------------------------------------------------------------------------- */

typedef struct call {
    const tribo_shape *a, *b;
    const tribo_pose *pa, *pb;
    const tribo_collide_options *options;
    tribo_manifold manifolds[2];
    uint32_t capacity, count;
    tribo_collide_info info;
} call;

static void expect_status(call c, tribo_status expected)
{
    memset(c.manifolds, 0x5a, sizeof c.manifolds);
    c.count = 77;
    const call before = c;
    const tribo_status status = tribo_collide_shapes(c.a, c.pa, c.b, c.pb, c.options, c.capacity,
                                                     c.manifolds, &c.count, &c.info);
    assert_int_equal(status, expected);
    assert_memory_equal(c.manifolds, before.manifolds, sizeof c.manifolds);
    assert_memory_equal(&c.info, &before.info, sizeof c.info);
    assert_int_equal(c.count, expected == TRIBO_ERROR_CAPACITY ? 1 : 77);
}

static void faults_are_named_and_change_nothing(void **state)
{
    (void)state;
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 1, 1, 1);
    const tribo_shape plane = {TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0}, NULL};
    const tribo_pose here = at(0, 0, 0);
    call good;
    memset(&good, 0, sizeof good);
    good.a = good.b = &box;
    good.pa = good.pb = &here;
    good.capacity = 2;
    good.info.struct_size = sizeof good.info;
    call c = good;
    c.a = NULL;
    expect_status(c, TRIBO_ERROR_NULL);
    c = good;
    c.pb = NULL;
    expect_status(c, TRIBO_ERROR_NULL);
    c = good;
    c.info.struct_size = 3;
    expect_status(c, TRIBO_ERROR_STRUCT_SIZE);
    tribo_collide_options options = with_margin(0.0);
    good.options = &options;
    options.struct_size = sizeof options + 4;
    expect_status(good, TRIBO_ERROR_STRUCT_SIZE);
    options = with_margin(NOT_A_NUMBER);
    expect_status(good, TRIBO_ERROR_NOT_FINITE);
    options = with_margin(-1.0);
    expect_status(good, TRIBO_ERROR_RANGE);
    options = with_margin(0.0);
    options.method = 3;
    expect_status(good, TRIBO_ERROR_OPTION);
    options.method = 0;
    options.max_points = 5;
    expect_status(good, TRIBO_ERROR_OPTION);
    options.max_points = 0;
    tribo_shape bad = box;
    c = good;
    c.b = &bad;
    bad.size[1] = 0.0;
    expect_status(c, TRIBO_ERROR_SHAPE);
    bad.size[1] = INFINITE;
    expect_status(c, TRIBO_ERROR_NOT_FINITE);
    bad = box;
    bad.type = 99;
    expect_status(c, TRIBO_ERROR_OPTION);
    tribo_pose pose = here;
    c = good;
    c.pa = &pose;
    pose.position[2] = NOT_A_NUMBER;
    expect_status(c, TRIBO_ERROR_NOT_FINITE);
    pose = here;
    pose.orientation[0] = 1.1;
    expect_status(c, TRIBO_ERROR_ORIENTATION);
    c = good;
    c.a = c.b = &plane;
    expect_status(c, TRIBO_ERROR_PAIR);
    c.b = &box;
    options.method = TRIBO_METHOD_GENERAL;
    expect_status(c, TRIBO_ERROR_OPTION);
    const tribo_shape cone = make(TRIBO_SHAPE_CONE, 1, 1, 0);
    c.a = &cone;
    options.method = TRIBO_METHOD_CLOSED;
    expect_status(c, TRIBO_ERROR_OPTION);
    options.method = 0;
    pose = at(1.7e308, 0, 0);
    tribo_pose far = at(-1.7e308, 0, 0);
    c.pa = &pose;
    c.pb = &far;
    expect_status(c, TRIBO_ERROR_RANGE);
    c = good;
    c.capacity = 0;
    expect_status(c, TRIBO_ERROR_CAPACITY);
}

static void nowhere(const void *user, const double direction[3], double point[3])
{
    (void)user;
    (void)direction;
    point[0] = point[1] = point[2] = NOT_A_NUMBER;
}

/* Points of any two shapes lie in both, but for half of their depth. */
static void points_lie_in_both_shapes(void **state)
{
    (void)state;
    long points = 0;
    double worst = 0.0;
    build_hull();
    for (int i = 0; i < 5000; i++) {
        const tribo_shape s[2] = {kind_of(i % (KINDS - 1)), kind_of(i / (KINDS - 1) % (KINDS - 1))};
        const tribo_pose p[2] = {random_pose(0.8), random_pose(0.8)};
        const tribo_manifold m = pair_of(&s[0], &p[0], &s[1], &p[1], NULL);
        for (uint32_t k = 0; k < m.count; k++) {
            points++;
            for (int side = 0; side < 2; side++) {
                const double *arm = side == 0 ? m.points[k].arm_a : m.points[k].arm_b;
                for (int c = 0; c < 100; c++) {
                    double d[3];
                    double local[3];
                    double far[3];
                    random_direction(d);
                    tribo_quat_rotate_inverse(p[side].orientation, arm, local);
                    assert_int_equal(tribo_shape_support(&s[side], d, far), TRIBO_OK);
                    const double out = d[0] * (local[0] - far[0]) + d[1] * (local[1] - far[1]) +
                                       d[2] * (local[2] - far[2]);
                    worst = fmax(worst, out - 0.5 * fabs(m.points[k].distance));
                }
            }
        }
    }
    print_message("# %ld points, %.1e outside of a shape at most\n", points, worst);
    assert_true(points > 4000);
    assert_true(worst <= 1e-9);
}

/* A caller's older and shorter struct: what it does not hold whole is not looked at. */
static void options_of_any_age(void **state)
{
    (void)state;
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 1, 1, 1);
    const tribo_shape plane = {TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0}, NULL};
    const tribo_pose here = at(0, 0, 0);
    const tribo_pose touching = at(0, 0, 0.9375);
    const tribo_pose above = at(0, 0, 1.0625);
    tribo_manifold m;
    uint32_t count;
    for (uint32_t size = 4; size <= sizeof(tribo_collide_options); size += 4) {
        tribo_collide_options options = with_margin(0.125);
        options.struct_size = size;
        options.max_points = 2;
        assert_int_equal(
            tribo_collide_shapes(&box, &touching, &plane, &here, &options, 1, &m, &count, NULL),
            TRIBO_OK);
        assert_int_equal(m.count, size >= 12 ? 2 : 4);
        assert_int_equal(
            tribo_collide_shapes(&box, &above, &plane, &here, &options, 1, &m, &count, NULL),
            TRIBO_OK);
        assert_int_equal(count, size == sizeof options ? 1 : 0);
        options.method = 3;
        assert_int_equal(
            tribo_collide_shapes(&box, &above, &plane, &here, &options, 1, &m, &count, NULL),
            size >= 8 ? TRIBO_ERROR_OPTION : TRIBO_OK);
    }
}

/* Counters, older structs, limits of points, many manifolds against little room. */
static void options_and_counters(void **state)
{
    (void)state;
    const tribo_shape box = make(TRIBO_SHAPE_BOX, 1, 1, 1);
    const tribo_shape plane = {TRIBO_SHAPE_HALFSPACE, 0, {0, 0, 1, 0}, NULL};
    const tribo_shape cone = make(TRIBO_SHAPE_CONE, 1, 1, 0);
    const tribo_pose up = at(0, 0, 0.9375);
    const tribo_pose here = at(0, 0, 0);
    tribo_manifold m;
    uint32_t count;
    tribo_collide_info info = {sizeof info, 0, 0, 0, 0, 0};
    tribo_collide_options options = with_margin(0.0);
    for (uint32_t k = 1; k <= 4; k++) {
        options.max_points = k;
        m = pair_of(&box, &up, &plane, &here, &options);
        assert_int_equal(m.count, k);
    }
    assert_int_equal(tribo_collide_shapes(&box, &up, &plane, &here, NULL, 1, &m, &count, &info),
                     TRIBO_OK);
    assert_int_equal(info.closed, 1);
    assert_int_equal(info.general + info.capped, 0);
    assert_true(info.supports == 0 && info.mallocs == 0);
    assert_int_equal(tribo_collide_shapes(&box, &up, &cone, &here, NULL, 1, &m, &count, &info),
                     TRIBO_OK);
    assert_int_equal(info.general, 1);
    assert_true(info.supports > 0);
    info.struct_size = 8;
    info.general = 99;
    assert_int_equal(tribo_collide_shapes(&box, &up, &cone, &here, NULL, 1, &m, &count, &info),
                     TRIBO_OK);
    assert_int_equal(info.general, 99);
    const tribo_convex liar = {sizeof liar, 0, nowhere, NULL, NULL, {0, 0, 0}, 1.0};
    const tribo_shape user = {TRIBO_SHAPE_CONVEX, 0, {0, 0, 0, 0}, &liar};
    assert_int_equal(tribo_collide_shapes(&user, &up, &plane, &here, NULL, 1, &m, &count, NULL),
                     TRIBO_ERROR_SUPPORT);
    const tribo_shape mesh = terrain(0.0);
    const tribo_shape slab = make(TRIBO_SHAPE_BOX, 2, 2, 0.5);
    const tribo_pose middle = at(4, 4, 0.4375);
    tribo_manifold many[128];
    memset(many, 0x5a, sizeof many);
    assert_int_equal(
        tribo_collide_shapes(&slab, &middle, &mesh, &here, NULL, 20, many, &count, NULL),
        TRIBO_ERROR_CAPACITY);
    assert_true(count >= 32 && many[0].count == 0x5a5a5a5a);
    const uint32_t needed = count;
    assert_int_equal(
        tribo_collide_shapes(&slab, &middle, &mesh, &here, NULL, needed, many, &count, NULL),
        TRIBO_OK);
    assert_int_equal(count, needed);
}

static void batches_are_single_calls(void **state)
{
    (void)state;
    enum { SHAPES = 40, PAIRS = 400 };
    tribo_shape shapes[SHAPES];
    tribo_pose poses[SHAPES];
    uint32_t pairs[2 * PAIRS];
    tribo_manifold batch[PAIRS];
    tribo_status statuses[PAIRS];
    tribo_collide_info info = {sizeof info, 0, 0, 0, 0, 0};
    build_hull();
    for (int i = 0; i < SHAPES; i++) {
        shapes[i] = kind_of(i % KINDS);
        poses[i] = random_pose(1.0);
    }
    for (int i = 0; i < 2 * PAIRS; i++) {
        pairs[i] = (uint32_t)(SHAPES * uniform());
    }
    pairs[0] = pairs[1] = 3;
    pairs[2] = SHAPES;
    memset(batch, 0x5a, sizeof batch);
    assert_int_equal(
        tribo_collide_batch(SHAPES, shapes, poses, PAIRS, pairs, NULL, batch, statuses, &info),
        TRIBO_ERROR_ALIAS);
    assert_int_equal(statuses[0], TRIBO_ERROR_ALIAS);
    assert_int_equal(statuses[1], TRIBO_ERROR_INDEX);
    assert_int_equal(batch[1].count, 0x5a5a5a5a);
    uint32_t done = 0;
    for (int i = 2; i < PAIRS; i++) {
        const uint32_t a = pairs[2 * i];
        const uint32_t b = pairs[2 * i + 1];
        if (a == b) {
            assert_int_equal(statuses[i], TRIBO_ERROR_ALIAS);
            continue;
        }
        if (shapes[a].type == TRIBO_SHAPE_HALFSPACE && shapes[b].type == TRIBO_SHAPE_HALFSPACE) {
            assert_int_equal(statuses[i], TRIBO_ERROR_PAIR);
            continue;
        }
        assert_int_equal(statuses[i], TRIBO_OK);
        done++;
        const tribo_manifold m = pair_of(&shapes[a], &poses[a], &shapes[b], &poses[b], NULL);
        assert_int_equal(m.count, batch[i].count);
        if (m.count > 0) {
            assert_memory_equal(m.normal, batch[i].normal, sizeof m.normal);
            assert_memory_equal(m.points, batch[i].points, m.count * sizeof *m.points);
        }
    }
    assert_int_equal(info.closed + info.general, done);
    assert_int_equal(tribo_collide_batch(0, NULL, NULL, 0, NULL, NULL, NULL, NULL, NULL), TRIBO_OK);
    assert_int_equal(tribo_collide_batch(1, shapes, NULL, 0, NULL, NULL, NULL, NULL, NULL),
                     TRIBO_ERROR_NULL);
}

/* The general method on pairs that have a closed form: they check each other. */
static void general_method_agrees(void **state)
{
    (void)state;
    tribo_collide_options options = with_margin(0.0);
    long both = 0;
    double worst = 0.0;
    double least = 0.0;
    for (int i = 0; i < 6000; i++) {
        const tribo_shape a = kind_of(i % 3);
        const tribo_shape b = kind_of(i % 3 == 2 ? 2 : i / 3 % 3);
        if (a.type == TRIBO_SHAPE_BOX && b.type == TRIBO_SHAPE_CAPSULE) {
            continue;
        }
        const tribo_pose pa = random_pose(0.7);
        const tribo_pose pb = random_pose(0.7);
        options.method = TRIBO_METHOD_CLOSED;
        const tribo_manifold closed = pair_of(&a, &pa, &b, &pb, &options);
        options.method = TRIBO_METHOD_GENERAL;
        const tribo_manifold open = pair_of(&a, &pa, &b, &pb, &options);
        if (closed.count > 0 && deepest(&closed) < -1e-6) {
            assert_true(open.count > 0);
            assert_int_equal(open.method, TRIBO_METHOD_GENERAL);
            worst = fmax(worst, deepest(&open) / deepest(&closed) - 1.0);
            least = fmin(least, deepest(&open) / deepest(&closed) - 1.0);
            both++;
        }
    }
    print_message("# %ld pairs by both methods, depth of the general one %.1e to %.1e in excess\n",
                  both, least, worst);
    assert_true(both > 2000);
    assert_true(worst <= 0.01);
    assert_true(least >= -1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(spheres_by_hand, fresh),
        cmocka_unit_test_setup(capsules_by_hand, fresh),
        cmocka_unit_test_setup(planes_by_hand, fresh),
        cmocka_unit_test_setup(boxes_against_separating_axes, fresh),
        cmocka_unit_test_setup(boxes_by_the_general_method, fresh),
        cmocka_unit_test_setup(plates_take_a_face_normal, fresh),
        cmocka_unit_test_setup(noise_of_an_axis_does_not_show, fresh),
        cmocka_unit_test_setup(boxes_within_the_margin, fresh),
        cmocka_unit_test_setup(points_keep_the_area, fresh),
        cmocka_unit_test_setup(rims_keep_the_area, fresh),
        cmocka_unit_test_setup(swap_offset_and_scale_change_no_bit, fresh),
        cmocka_unit_test_setup(rigid_motion_turns_the_answer, fresh),
        cmocka_unit_test_setup(ids_survive_small_motions, fresh),
        cmocka_unit_test_setup(ids_survive_in_stacks, fresh),
        cmocka_unit_test_setup(no_place_gives_what_is_no_number, fresh),
        cmocka_unit_test_setup(compounds_are_their_parts, fresh),
        cmocka_unit_test_setup(inner_edges_do_not_show, fresh),
        cmocka_unit_test_setup(meshes_have_one_side, fresh),
        cmocka_unit_test_setup(nothing_of_the_stack_shows, fresh),
        cmocka_unit_test_setup(ridges_show, fresh),
        cmocka_unit_test_setup(faults_are_named_and_change_nothing, fresh),
        cmocka_unit_test_setup(options_of_any_age, fresh),
        cmocka_unit_test_setup(options_and_counters, fresh),
        cmocka_unit_test_setup(batches_are_single_calls, fresh),
        cmocka_unit_test_setup(general_method_agrees, fresh),
        cmocka_unit_test_setup(points_lie_in_both_shapes, fresh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
