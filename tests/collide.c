/* Manifolds: closed forms against values by hand, boxes against separating axes by brute force, the area and
 * place of the points, equivariance, parts, judging. */
#include <tribo/collide.h>
#include <tribo/math.h>

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

/* ---- random input ------------------------------------------------------------------------------ */

static uint64_t seed = 1;

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

/* ---- shapes and calls --------------------------------------------------------------------------- */

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

/* ---- closed forms against values by hand ---------------------------------------------------------- */

/* A pair with one point: its normal, place (from A, who stands at the origin) and distance. */
static void expect_point(tribo_shape a, tribo_pose pa, tribo_shape b, tribo_pose pb, const double n[3],
                         const double place[3], double distance)
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
    expect_point(one, at(0, 0, 3.25), capsule, at(0, 0, 0), z, (const double[]){0, 0, 2.375}, -0.25);
    expect_point(one, at(0, 0, 1), capsule, at(0, 0, 0), x, (const double[]){-0.25, 0, 1}, -1.5);
    /* outside of a face and of an edge, inside, at the centre */
    expect_point(half, at(0, 0, 3.25), box, at(0, 0, 0), z, (const double[]){0, 0, 2.875}, -0.25);
    expect_point(one, at(1.3, 2.4, 0), box, at(0, 0, 0), diagonal, (const double[]){0.85, 1.8, 0},
                 -0.5);
    expect_point(half, at(0, 1.75, 0), box, at(0, 0, 0), (const double[]){0, 1, 0},
                 (const double[]){0, 1.625, 0}, -0.75);
    expect_point(half, at(0, 0, 0), box, at(0, 0, 0), x, (const double[]){0.25, 0, 0}, -1.5);
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
    /* segments that cross, touch with an end, or lie in each other: depth is the sum of the radii */
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
    expect_point(ellipsoid, at(3, 4, 2.75), plane, ground, z, (const double[]){3, 4, -0.125}, -0.25);
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

/* ---- boxes: truth by brute force ------------------------------------------------------------------ */

typedef long double real;

typedef struct solid_box {
    real axis[3][3];
    real corner[8][3]; /* from the centre of A */
} solid_box;

static void rotate_exactly(const double q[4], real r[3][3])
{
    const real w = q[0], x = q[1], y = q[2], z = q[3];
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

/* How far B can go along a direction until the depth has fallen to `depth`: all widths are linear in it. */
static double way_to_depth(const solid_box *a, const solid_box *b, const double direction[3],
                           double depth)
{
    real axes[30][3];
    real way = (real)HUGE_VAL;
    const int count = take_axes(a, b, axes);
    for (int k = 0; k < count; k++) {
        const real *n = axes[k];
        const real slope = n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2];
        const real most = (width_along(a, b, n) - depth) / -slope;
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

enum {
    RANDOM,
    SLENDER,
    FACE_ALIGNED,
    EDGE_ALIGNED,
    FACE_TILTED,
    CONCENTRIC,
    PLATES,
    BOX_CLASSES
};

static const char *const box_names[BOX_CLASSES] = {
    "random",      "aspect 1e4", "face-aligned", "edge-aligned", "tilted 1e-8..1e-2",
    "concentric",  "plates 2000:1",
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
                                                             : uniform() < 0.5 ? 0.0
                                                                               : between(-3.0, 3.0);
    }
    if (class == FACE_TILTED || class == PLATES) {
        double tilt[3];
        random_direction(tilt);
        const double size = class == PLATES ? random_length(1e-12, 1e-6) : random_length(1e-8, 1e-2);
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
    /* Along a random direction, or along a face normal and a step aside, until the depth is right. */
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
    const real n[3] = {m->normal[0], m->normal[1], m->normal[2]};
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
        const double out = fmax(outside_by(&c->a, &c->pa, p->arm_a),
                                outside_by(&c->b, &c->pb, p->arm_b)) -
                           0.5 * fabs(p->distance);
        t->outside = fmax(t->outside, out / c->large);
        t->displaced += apart(p->arm_a, p->arm_b) >
                        apart(c->pa.position, c->pb.position) + 1e-12 * c->large;
    }
}

static void boxes_against_separating_axes(void **state)
{
    static const double depths[6] = {0.2, 1e-2, 1e-3, 1e-4, 1e-6, 0.0};
    (void)state;
    print_message("# boxes: pairs, missed, wrong directions, excess of width, errors / size\n");
    for (int class = 0; class < BOX_CLASSES; class++) {
        tally t = {0, 0, 0, 0, 0.0, 0.0, 0.0};
        for (int i = 0; i < 14400; i++) {
            box_case c;
            make_case(class, depths[i % 6], i % 12 < 6 ? 0.0 : 1e6, &c);
            const tribo_manifold m = pair_of(&c.a, &c.pa, &c.b, &c.pb, NULL);
            judge_case(&c, &m, &t);
        }
        print_message("# %-18s %6ld %4ld %4ld %9.2e  distance %.1e outside %.1e\n",
                      box_names[class], t.pairs, t.missed, t.wrong, t.excess, t.distance,
                      t.outside);
        assert_int_equal(t.missed, 0);
        assert_int_equal(t.wrong, 0);
        assert_int_equal(t.displaced, 0);
        assert_true(t.distance <= 1e-14);
        assert_true(t.outside <= 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_by_hand),
        cmocka_unit_test(capsules_by_hand),
        cmocka_unit_test(planes_by_hand),
        cmocka_unit_test(boxes_against_separating_axes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
