/* Shapes: supports, faces, bounds and masses against closed forms and brute force; hulls and
 * meshes. */
#define _POSIX_C_SOURCE 200809L

#include "hull.h"
#include "mesh.h"
#include "pair.h"
#include "problems.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define EPS DBL_EPSILON
#define NOT_A_NUMBER ((double)NAN)
#define INFINITE ((double)INFINITY)
#define PI 3.14159265358979323846
#define SEED 46914u

enum { STREAM_SUPPORT, STREAM_FACE, STREAM_BOUNDS, STREAM_MASS, STREAM_HULL, STREAM_MESH };

static int same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length(const double *a)
{
    return sqrt(dot(a, a));
}

static void random_pose(problem_random *random, double far, tribo_pose *pose)
{
    problem_random_direction(random, 4, pose->orientation);
    for (int i = 0; i < 3; i++) {
        pose->position[i] = problem_random_uniform(random, -far, far);
    }
}

static void matrix_of(const tribo_pose *pose, double r[9])
{
    tribo_quat_to_mat3(pose->orientation, r);
}

/* ---- shapes to draw from --------------------------------------------------------------------- */

static void *build_hull(size_t count, const double *points)
{
    size_t needed = 0;
    assert_int_equal(tribo_hull_build(count, points, NULL, 0, &needed), TRIBO_ERROR_CAPACITY);
    void *block = malloc(needed);
    assert_non_null(block);
    assert_int_equal(tribo_hull_build(count, points, block, needed, NULL), TRIBO_OK);
    assert_int_equal(tribo_hull_check(block, needed), TRIBO_OK);
    return block;
}

static tribo_shape shape_of(uint32_t type, double a, double b, double c)
{
    const tribo_shape shape = {.type = type, .size = {a, b, c, 0.0}};
    return shape;
}

static tribo_shape hull_shape(const void *block)
{
    const tribo_shape shape = {.type = TRIBO_SHAPE_HULL, .data = block};
    return shape;
}

/* The user's shape: a box that knows itself. */
static void user_support(const void *user, const double direction[3], double point[3])
{
    const double *half = user;
    for (int i = 0; i < 3; i++) {
        point[i] = direction[i] < 0.0 ? -half[i] : half[i];
    }
}

static tribo_convex user_box(const double half[3])
{
    const tribo_convex user = {
        .struct_size = sizeof user, .support = user_support, .user = half, .radius = length(half)};
    return user;
}

enum { ROUND_KINDS = 6 };

static const tribo_shape round_shapes[ROUND_KINDS] = {
    {.type = TRIBO_SHAPE_SPHERE, .size = {0.7}},
    {.type = TRIBO_SHAPE_BOX, .size = {0.3, 1.7, 0.9}},
    {.type = TRIBO_SHAPE_CAPSULE, .size = {0.4, 1.3}},
    {.type = TRIBO_SHAPE_CYLINDER, .size = {0.8, 0.6}},
    {.type = TRIBO_SHAPE_CONE, .size = {0.9, 1.1}},
    {.type = TRIBO_SHAPE_ELLIPSOID, .size = {0.2, 1.5, 0.8}},
};

/* Greatest extent along a direction by another way: of a body of revolution the support in the
 * plane through the axis, of the others the dual norm. */
static double extent_of(const tribo_shape *shape, const double d[3])
{
    const double *s = shape->size;
    const double radial = hypot(d[0], d[1]);
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return s[0] * length(d);
    case TRIBO_SHAPE_BOX:
        return s[0] * fabs(d[0]) + s[1] * fabs(d[1]) + s[2] * fabs(d[2]);
    case TRIBO_SHAPE_CAPSULE:
        return s[0] * length(d) + s[1] * fabs(d[2]);
    case TRIBO_SHAPE_CYLINDER:
        return s[0] * radial + s[1] * fabs(d[2]);
    case TRIBO_SHAPE_CONE:
        return fmax(s[1] * d[2], s[0] * radial - s[1] * d[2]);
    default:
        return sqrt(pow(s[0] * d[0], 2) + pow(s[1] * d[1], 2) + pow(s[2] * d[2], 2));
    }
}

/* 0 on the surface, positive outside, of the order of a length. */
static double outside_of(const tribo_shape *shape, const double p[3])
{
    const double *s = shape->size;
    const double radial = hypot(p[0], p[1]);
    const double beyond[3] = {p[0], p[1], copysign(fmax(fabs(p[2]) - s[1], 0.0), p[2])};
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return length(p) - s[0];
    case TRIBO_SHAPE_BOX:
        return fmax(fabs(p[0]) - s[0], fmax(fabs(p[1]) - s[1], fabs(p[2]) - s[2]));
    case TRIBO_SHAPE_CAPSULE:
        return length(beyond) - s[0];
    case TRIBO_SHAPE_CYLINDER:
        return fmax(radial - s[0], fabs(p[2]) - s[1]);
    case TRIBO_SHAPE_CONE:
        return fmax(radial - s[0] * (s[1] - p[2]) / (2.0 * s[1]), -s[1] - p[2]);
    default:
        return sqrt(pow(p[0] / s[0], 2) + pow(p[1] / s[1], 2) + pow(p[2] / s[2], 2)) - 1.0;
    }
}

/* ---- supports -------------------------------------------------------------------------------- */

static void test_supports_are_farthest_and_on_the_surface(void **state)
{
    (void)state;
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        const tribo_shape *shape = &round_shapes[kind];
        problem_random random;
        problem_random_start(&random, STREAM_SUPPORT, SEED, (uint64_t)kind);
        for (int i = 0; i < 100000; i++) {
            double d[3];
            double p[3];
            problem_random_direction(&random, 3, d);
            for (int k = 0; k < 3 && i % 2 == 0; k++) {
                d[k] *= problem_random_decades(&random, -20.0, 0.0);
            }
            assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
            assert_true(fabs(dot(d, p) - extent_of(shape, d)) <= 8.0 * EPS * length(d) * length(p));
            assert_true(fabs(outside_of(shape, p)) <= 8.0 * EPS);
        }
    }
}

static void assert_support(const tribo_shape *shape, double x, double y, double z, double px,
                           double py, double pz)
{
    const double d[3] = {x, y, z};
    const double expected[3] = {px, py, pz};
    double p[3];
    assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(p[i] == expected[i]);
    }
}

static void test_supports_at_special_directions(void **state)
{
    (void)state;
    const tribo_shape box = shape_of(TRIBO_SHAPE_BOX, 1.0, 2.0, 3.0);
    const tribo_shape capsule = shape_of(TRIBO_SHAPE_CAPSULE, 1.0, 2.0, 0.0);
    const tribo_shape cylinder = shape_of(TRIBO_SHAPE_CYLINDER, 1.0, 2.0, 0.0);
    const tribo_shape cone = shape_of(TRIBO_SHAPE_CONE, 1.0, 2.0, 0.0);
    const tribo_shape ellipsoid = shape_of(TRIBO_SHAPE_ELLIPSOID, 1.0, 2.0, 3.0);
    assert_support(&box, 0.0, 0.0, -1.0, 1.0, 2.0, -3.0);
    assert_support(&box, -0.0, -1e-320, 1.0, 1.0, -2.0, 3.0);
    assert_support(&capsule, 1.0, 0.0, 0.0, 1.0, 0.0, 2.0);
    assert_support(&capsule, 0.0, 0.0, -5.0, 0.0, 0.0, -3.0);
    assert_support(&cylinder, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0);
    assert_support(&cylinder, 0.0, 1e-300, -1.0, 0.0, 1.0, -2.0);
    assert_support(&cylinder, 0.0, -1.0, 0.0, 0.0, -1.0, 2.0);
    assert_support(&cone, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0);
    assert_support(&cone, 0.0, 0.0, -1.0, 0.0, 0.0, -2.0);
    assert_support(&cone, 4.0, 0.0, 1.0, 0.0, 0.0, 2.0); /* along the side's normal: a tie */
    assert_support(&cone, 4.001, 0.0, 1.0, 1.0, 0.0, -2.0);
    assert_support(&cone, -1.0, 0.0, 0.0, -1.0, 0.0, -2.0);
    assert_support(&ellipsoid, 0.0, -3.0, 0.0, 0.0, -2.0, 0.0);
    assert_support(&ellipsoid, 0.0, 0.0, 5e-324, 0.0, 0.0, 3.0);
}

static void test_supports_of_scaled_directions_are_the_same_bits(void **state)
{
    (void)state;
    static const int powers[] = {-660, -1, 3, 660};
    const double half[3] = {0.25, 0.5, 0.75};
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        for (int i = 0; i < 2000; i++) {
            problem_random random;
            double d[3];
            double p[3];
            problem_random_start(&random, STREAM_SUPPORT, SEED + 1, (uint64_t)i);
            problem_random_direction(&random, 3, d);
            d[i % 3] = i % 7 == 0 ? 0.0 : d[i % 3];
            assert_int_equal(tribo_shape_support(&round_shapes[kind], d, p), TRIBO_OK);
            for (int k = 0; k < 4; k++) {
                const double scale = ldexp(1.0, powers[k]);
                double scaled[3] = {scale * d[0], scale * d[1], scale * d[2]};
                double q[3];
                scaled[i % 3] = scaled[i % 3] == 0.0 ? -0.0 : scaled[i % 3];
                assert_int_equal(tribo_shape_support(&round_shapes[kind], scaled, q), TRIBO_OK);
                assert_true(same_bits(p, q, sizeof p));
            }
        }
    }
    const tribo_convex user = user_box(half);
    const tribo_shape shape = {.type = TRIBO_SHAPE_CONVEX, .data = &user};
    assert_support(&shape, -0.0, -1.0, 0.0, 0.25, -0.5, 0.75);
}

static void test_shapes_of_all_sizes_scale_to_the_bit(void **state)
{
    (void)state;
    static const int powers[] = {-100, -10, 10, 100};
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        for (int k = 0; k < 4; k++) {
            const double scale = ldexp(1.0, powers[k]);
            tribo_shape shape = round_shapes[kind];
            problem_random random;
            problem_random_start(&random, STREAM_SUPPORT, SEED + 2, (uint64_t)kind);
            for (int i = 0; i < 3; i++) {
                shape.size[i] *= scale;
            }
            for (int i = 0; i < 2000; i++) {
                double d[3];
                double p[3];
                double q[3];
                problem_random_direction(&random, 3, d);
                assert_int_equal(tribo_shape_support(&round_shapes[kind], d, p), TRIBO_OK);
                assert_int_equal(tribo_shape_support(&shape, d, q), TRIBO_OK);
                tribo_vec3_scale(scale, p, p);
                assert_true(same_bits(p, q, sizeof p));
            }
        }
    }
}

static void lying_support(const void *user, const double direction[3], double point[3])
{
    (void)direction;
    memcpy(point, user, 3 * sizeof *point);
}

static void test_support_statuses(void **state)
{
    (void)state;
    const tribo_shape box = round_shapes[1];
    const tribo_shape plane = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.0, 0.0, 1.0, 0.0}};
    const double zero[3] = {0.0, -0.0, 0.0};
    const double broken[3] = {0.0, NOT_A_NUMBER, 1.0};
    const double up[3] = {0.0, 0.0, 1.0};
    const double before[3] = {7.0, 8.0, 9.0};
    const tribo_convex liar = {
        .struct_size = sizeof liar, .support = lying_support, .user = broken};
    const tribo_shape user = {.type = TRIBO_SHAPE_CONVEX, .data = &liar};
    double p[3] = {7.0, 8.0, 9.0};
    assert_int_equal(tribo_shape_support(NULL, up, p), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_shape_support(&box, NULL, p), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_shape_support(&box, up, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_shape_support(&box, zero, p), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_shape_support(&box, broken, p), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_shape_support(&plane, up, p), TRIBO_ERROR_SHAPE);
    assert_int_equal(tribo_shape_support(&user, up, p), TRIBO_ERROR_SUPPORT);
    assert_true(same_bits(p, before, sizeof p));
}

/* ---- faces ----------------------------------------------------------------------------------- */

typedef struct face {
    uint32_t count;
    uint32_t feature;
    double normal[3];
    double points[3 * TRIBO_MAX_FACE];
} face;

static face face_of(const tribo_shape *shape, double x, double y, double z)
{
    const double d[3] = {x, y, z};
    double points[3 * TRIBO_MAX_FACE];
    double normal[3];
    uint32_t count;
    face f;
    memset(&f, 0, sizeof f);
    f.count = shape_face(shape, d, f.points, f.normal, &f.feature);
    assert_int_equal(tribo_shape_face(shape, d, TRIBO_MAX_FACE, points, &count, normal), TRIBO_OK);
    assert_int_equal(count, f.count);
    assert_true(same_bits(points, f.points, 3 * count * sizeof *points));
    assert_true(same_bits(normal, f.normal, sizeof normal));
    return f;
}

/* Counter-clockwise about the normal, convex, and all in one plane. */
static void assert_polygon(const face *f, double size)
{
    assert_true(f->count >= 3);
    assert_true(fabs(length(f->normal) - 1.0) <= 4.0 * EPS);
    for (uint32_t i = 0; i < f->count; i++) {
        const double *a = f->points + 3 * i;
        const double *b = f->points + 3 * ((i + 1) % f->count);
        const double *c = f->points + 3 * ((i + 2) % f->count);
        double ab[3];
        double bc[3];
        double turn[3];
        tribo_vec3_subtract(b, a, ab);
        tribo_vec3_subtract(c, b, bc);
        tribo_vec3_cross(ab, bc, turn);
        assert_true(dot(turn, f->normal) > 0.0);
        assert_true(fabs(dot(ab, f->normal)) <= 16.0 * EPS * size);
    }
}

static void test_faces_of_a_box(void **state)
{
    (void)state;
    const tribo_shape *box = &round_shapes[1];
    for (int axis = 0; axis < 3; axis++) {
        for (int side = 0; side < 2; side++) {
            double d[3] = {0.3, -0.3, 0.3};
            d[axis] = side ? -0.9 : 0.9;
            const face f = face_of(box, d[0], d[1], d[2]);
            assert_int_equal(f.count, 4);
            assert_int_equal(f.feature, 2 * axis + side);
            assert_polygon(&f, 2.0);
            assert_true(f.normal[axis] == (side ? -1.0 : 1.0));
            for (uint32_t i = 0; i < 4; i++) {
                for (int k = 0; k < 3; k++) {
                    assert_true(fabs(f.points[3 * i + (uint32_t)k]) == box->size[k]);
                }
                assert_true(f.points[3 * i + (uint32_t)axis] * d[axis] > 0.0);
            }
        }
    }
}

static void test_faces_of_round_shapes(void **state)
{
    (void)state;
    const tribo_shape cylinder = shape_of(TRIBO_SHAPE_CYLINDER, 2.0, 1.0, 0.0);
    const tribo_shape cone = shape_of(TRIBO_SHAPE_CONE, 2.0, 1.0, 0.0);
    const tribo_shape capsule = shape_of(TRIBO_SHAPE_CAPSULE, 2.0, 1.0, 0.0);
    for (int side = -1; side <= 1; side += 2) {
        const face cap = face_of(&cylinder, 0.1, 0.2, side);
        assert_int_equal(cap.count, 8);
        assert_int_equal(cap.feature, side > 0 ? 1 : 2);
        assert_polygon(&cap, 2.0);
        for (uint32_t i = 0; i < 8; i++) {
            assert_true(cap.points[3 * i + 2] == side);
            assert_true(fabs(length(cap.points + 3 * i) - sqrt(5.0)) <= 8.0 * EPS);
        }
        assert_true(cap.points[0] == 2.0 && cap.points[1] == 0.0);
    }
    const face edge = face_of(&cylinder, 3.0, 0.0, 0.3);
    const double lines[6] = {2.0, 0.0, -1.0, 2.0, 0.0, 1.0};
    assert_int_equal(edge.count, 2);
    assert_int_equal(edge.feature, 0);
    assert_true(same_bits(edge.points, lines, sizeof lines));
    const face base = face_of(&cone, 0.1, -0.1, -1.0);
    assert_int_equal(base.count, 8);
    assert_int_equal(base.feature, 2);
    assert_polygon(&base, 2.0);
    const face slope = face_of(&cone, 0.0, 1.0, 1.0);
    const double side[6] = {0.0, 2.0, -1.0, 0.0, 0.0, 1.0};
    assert_int_equal(slope.count, 2);
    assert_true(same_bits(slope.points, side, sizeof side));
    assert_int_equal(face_of(&cone, 0.0, 0.0, 1.0).count, 1);
    const face along = face_of(&capsule, 0.0, 1.0, 0.0);
    assert_int_equal(along.count, 2);
    assert_true(same_bits(along.points, (double[]){0.0, 2.0, -1.0, 0.0, 2.0, 1.0}, 6 * 8));
    assert_int_equal(face_of(&capsule, 0.0, 0.1, -1.0).count, 1);
    assert_int_equal(face_of(&round_shapes[0], 1.0, 2.0, 3.0).count, 1);
    assert_int_equal(face_of(&round_shapes[5], 1.0, 2.0, 3.0).count, 1);
}

/* No point of a face lies outside, and that which is farthest along the direction of an edge or a
 * point is the support point. */
static void test_faces_lie_on_their_shapes(void **state)
{
    (void)state;
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        const tribo_shape *shape = &round_shapes[kind];
        problem_random random;
        problem_random_start(&random, STREAM_FACE, SEED, (uint64_t)kind);
        for (int i = 0; i < 20000; i++) {
            double d[3];
            double p[3];
            double height = -INFINITE;
            problem_random_direction(&random, 3, d);
            const face f = face_of(shape, d[0], d[1], d[2]);
            assert_true(f.count >= 1);
            for (uint32_t k = 0; k < f.count; k++) {
                assert_true(outside_of(shape, f.points + 3 * k) <= 8.0 * EPS);
                height = fmax(height, dot(d, f.points + 3 * k));
            }
            assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
            assert_true(f.count == 8 || fabs(height - dot(d, p)) <= 8.0 * EPS);
        }
    }
}

static void test_face_statuses(void **state)
{
    (void)state;
    const double up[3] = {0.0, 0.0, 1.0};
    double points[12] = {5.0};
    double normal[3] = {6.0, 6.0, 6.0};
    uint32_t count = 77;
    assert_int_equal(tribo_shape_face(&round_shapes[1], up, 3, points, &count, normal),
                     TRIBO_ERROR_CAPACITY);
    assert_int_equal(tribo_shape_face(&round_shapes[1], up, 4, NULL, &count, normal),
                     TRIBO_ERROR_NULL);
    assert_true(points[0] == 5.0 && count == 77 && normal[0] == 6.0);
    assert_int_equal(tribo_shape_face(&round_shapes[1], up, 4, points, &count, normal), TRIBO_OK);
}

/* ---- the user's faces ------------------------------------------------------------------------ */

typedef struct told {
    uint32_t count;
    double points[15];
} told;

static uint32_t tell_face(const void *user, const double direction[3], uint32_t capacity,
                          double *points)
{
    const told *face_told = user;
    (void)direction;
    assert_true(capacity >= 5);
    memcpy(points, face_told->points, sizeof face_told->points);
    return face_told->count;
}

static void tell_support(const void *user, const double direction[3], double point[3])
{
    (void)user;
    (void)direction;
    point[0] = 1.0;
    point[1] = 2.0;
    point[2] = 3.0;
}

static void test_faces_told_by_the_user(void **state)
{
    (void)state;
    told square = {4, {0.0, 0.0, 3.0, 1.0, 0.0, 3.0, 1.0, 1.0, 3.0, 0.0, 1.0, 3.0}};
    tribo_convex user = {.struct_size = sizeof user,
                         .support = tell_support,
                         .face = tell_face,
                         .user = &square,
                         .radius = 9.0};
    const tribo_shape shape = {.type = TRIBO_SHAPE_CONVEX, .data = &user};
    face f = face_of(&shape, 0.1, 0.0, 2.0);
    assert_int_equal(f.count, 4);
    assert_true(f.normal[0] == 0.0 && f.normal[1] == 0.0 && f.normal[2] == 1.0);
    f = face_of(&shape, 0.1, 0.0, -2.0); /* the other way round */
    assert_int_equal(f.count, 4);
    assert_true(f.normal[2] == -1.0 && f.points[0] == 0.0 && f.points[1] == 1.0);
    assert_polygon(&f, 3.0);
    square.count = 0;
    assert_int_equal(face_of(&shape, 0.0, 0.0, 1.0).count, 1);
    square.count = 1000; /* more than there was room for */
    assert_int_equal(face_of(&shape, 0.0, 0.0, 1.0).count, 1);
    square.count = 4;
    square.points[4] = NOT_A_NUMBER;
    f = face_of(&shape, 0.0, 0.0, 1.0);
    assert_int_equal(f.count, 1);
    assert_true(f.points[0] == 1.0 && f.points[1] == 2.0 && f.points[2] == 3.0);
    memset(square.points, 0, sizeof square.points); /* no area */
    assert_int_equal(face_of(&shape, 0.0, 0.0, 1.0).count, 1);
    user.face = NULL;
    assert_int_equal(face_of(&shape, 0.0, 0.0, 1.0).count, 1);
}

/* ---- inner points ---------------------------------------------------------------------------- */

static const double pyramid[15] = {-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0,
                                   0.0,  -1.0, 1.0, 0.0, 0.0,  0.0, 3.0};

static void assert_core(const tribo_shape *shape, uint64_t index)
{
    problem_random random;
    double center[3];
    double inner;
    double outer;
    shape_core(shape, center, &inner, &outer);
    problem_random_start(&random, STREAM_SUPPORT, SEED + 3, index);
    double least = INFINITE;
    double greatest = 0.0;
    for (int i = 0; i < 20000; i++) {
        double d[3];
        double p[3];
        problem_random_direction(&random, 3, d);
        assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
        tribo_vec3_subtract(p, center, p);
        least = fmin(least, dot(d, p));
        greatest = fmax(greatest, length(p));
    }
    assert_true(least >= inner * (1.0 - 4.0 * EPS));
    assert_true(greatest <= outer * (1.0 + 4.0 * EPS));
    assert_true(greatest >= outer * 0.99);
    /* So many directions lie within 0.03 rad of any. */
    assert_true(shape->type == TRIBO_SHAPE_CONVEX || least <= inner + 0.03 * outer);
}

static void test_inner_and_outer_balls(void **state)
{
    (void)state;
    const double half[3] = {0.25, 0.5, 0.75};
    const double tetra[12] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0};
    const tribo_convex user = user_box(half);
    const tribo_shape convex = {.type = TRIBO_SHAPE_CONVEX, .data = &user};
    void *block = build_hull(4, tetra);
    const tribo_shape hull = hull_shape(block);
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        assert_core(&round_shapes[kind], (uint64_t)kind);
    }
    assert_core(&convex, 6);
    assert_core(&hull, 7);
    free(block);
    for (int i = 0; i < 5; i++) { /* any of its faces may be the last */
        double turned[15];
        for (int k = 0; k < 15; k++) {
            turned[k] = pyramid[(k + 3 * i) % 15];
        }
        block = build_hull(5, turned);
        const tribo_shape peak = hull_shape(block);
        assert_core(&peak, 8);
        free(block);
    }
}

/* ---- judging --------------------------------------------------------------------------------- */

static void test_check_of_sizes(void **state)
{
    (void)state;
    static const int lengths[ROUND_KINDS] = {1, 3, 2, 2, 2, 3};
    assert_int_equal(tribo_shape_check(NULL), TRIBO_ERROR_NULL);
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        assert_int_equal(tribo_shape_check(&round_shapes[kind]), TRIBO_OK);
        for (int i = 0; i < lengths[kind]; i++) {
            tribo_shape shape = round_shapes[kind];
            shape.size[i] = 0.0;
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
            shape.size[i] = -1.0;
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
            shape.size[i] = NOT_A_NUMBER;
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NOT_FINITE);
            shape.size[i] = INFINITE;
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NOT_FINITE);
        }
    }
    tribo_shape shape = {.type = 0};
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_OPTION);
    shape.type = 12;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_OPTION);
}

static void test_check_of_halfspaces_and_users(void **state)
{
    (void)state;
    const double half[3] = {1.0, 1.0, 1.0};
    tribo_shape plane = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.6, 0.0, 0.8, -3.0}};
    assert_int_equal(tribo_shape_check(&plane), TRIBO_OK);
    plane.size[2] = 0.8 + 1e-9;
    assert_int_equal(tribo_shape_check(&plane), TRIBO_ERROR_NORMAL);
    plane.size[3] = INFINITE;
    assert_int_equal(tribo_shape_check(&plane), TRIBO_ERROR_NOT_FINITE);
    tribo_convex user = user_box(half);
    tribo_shape shape = {.type = TRIBO_SHAPE_CONVEX};
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NULL);
    shape.data = &user;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_OK);
    user.center[1] = NOT_A_NUMBER;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NOT_FINITE);
    user.center[1] = 0.0;
    user.radius = 0.0;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
    user.support = NULL;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NULL);
    user.struct_size = 8;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_STRUCT_SIZE);
}

static tribo_child child_of(const tribo_shape *shape, double x, double y, double z)
{
    const tribo_child child = {.shape = *shape,
                               .pose = {.position = {x, y, z}, .orientation = {1.0}}};
    return child;
}

static void test_check_of_compounds(void **state)
{
    (void)state;
    const tribo_shape plane = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.0, 0.0, 1.0, 0.0}};
    tribo_child children[2] = {child_of(&round_shapes[1], 0.0, 0.0, 0.0),
                               child_of(&round_shapes[4], 1.0, 0.0, 0.0)};
    tribo_shape shape = {.type = TRIBO_SHAPE_COMPOUND, .count = 2};
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NULL);
    shape.data = children;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_OK);
    children[1].pose.orientation[0] = 1.1;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_ORIENTATION);
    children[1].pose.position[2] = NOT_A_NUMBER;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_NOT_FINITE);
    children[1] = child_of(&plane, 0.0, 0.0, 0.0);
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
    children[1].shape = shape;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
    children[1].shape.type = 99;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_OPTION);
    shape.count = 0;
    assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_SHAPE);
}

/* ---- bounds ---------------------------------------------------------------------------------- */

/* Along each world axis the bounds reach the support point and not beyond. */
static void assert_bounds(const tribo_shape *shape, const tribo_pose *pose, double size)
{
    double r[9];
    double ends[2][3];
    matrix_of(pose, r);
    assert_int_equal(tribo_shape_bounds(shape, pose, ends[0], ends[1]), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        for (int side = 0; side < 2; side++) {
            const double sign = side ? 1.0 : -1.0;
            const double d[3] = {sign * r[3 * i], sign * r[3 * i + 1], sign * r[3 * i + 2]};
            double p[3];
            assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
            const double reach = pose->position[i] + dot(r + 3 * i, p);
            assert_true(fabs(ends[side][i] - reach) <=
                        8.0 * EPS * (size + fabs(pose->position[i])));
        }
    }
}

static void test_bounds_touch_the_supports(void **state)
{
    (void)state;
    const double half[3] = {0.25, 0.5, 0.75};
    const double tetra[12] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0};
    const tribo_convex user = user_box(half);
    void *block = build_hull(4, tetra);
    tribo_shape shapes[ROUND_KINDS + 2];
    memcpy(shapes, round_shapes, sizeof round_shapes);
    shapes[ROUND_KINDS] = hull_shape(block);
    shapes[ROUND_KINDS + 1] = (tribo_shape){.type = TRIBO_SHAPE_CONVEX, .data = &user};
    for (int kind = 0; kind < ROUND_KINDS + 2; kind++) {
        problem_random random;
        problem_random_start(&random, STREAM_BOUNDS, SEED, (uint64_t)kind);
        for (int i = 0; i < 5000; i++) {
            tribo_pose pose;
            random_pose(&random, i % 2 ? 1e6 : 0.0, &pose);
            assert_bounds(&shapes[kind], &pose, 3.0);
        }
    }
    free(block);
}

static void test_bounds_of_halfspaces(void **state)
{
    (void)state;
    const tribo_shape ground = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.0, 0.0, 1.0, 2.0}};
    const tribo_shape wall = {.type = TRIBO_SHAPE_HALFSPACE, .size = {-1.0, 0.0, 0.0, 2.0}};
    const tribo_shape slope = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.6, 0.0, 0.8, 2.0}};
    const tribo_shape cliff = {.type = TRIBO_SHAPE_HALFSPACE, .size = {-0.6, 0.0, -0.8, 2.0}};
    const tribo_pose pose = {.position = {10.0, 20.0, 30.0}, .orientation = {1.0}};
    double low[3];
    double high[3];
    assert_int_equal(tribo_shape_bounds(&ground, &pose, low, high), TRIBO_OK);
    assert_true(low[2] == -INFINITE && high[2] == 32.0 && high[0] == INFINITE);
    assert_int_equal(tribo_shape_bounds(&wall, &pose, low, high), TRIBO_OK);
    assert_true(low[0] == 8.0 && high[0] == INFINITE && low[1] == -INFINITE);
    assert_int_equal(tribo_shape_bounds(&slope, &pose, low, high), TRIBO_OK);
    assert_true(low[2] == -INFINITE && high[2] == INFINITE && high[0] == INFINITE);
    assert_int_equal(tribo_shape_bounds(&cliff, &pose, low, high), TRIBO_OK);
    assert_true(low[2] == -INFINITE && high[2] == INFINITE && low[0] == -INFINITE);
}

static void test_bounds_of_compounds(void **state)
{
    (void)state;
    tribo_child children[3];
    const tribo_shape shape = {.type = TRIBO_SHAPE_COMPOUND, .count = 3, .data = children};
    for (int i = 0; i < 2000; i++) {
        problem_random random;
        tribo_pose pose;
        double r[9];
        double ends[2][3];
        problem_random_start(&random, STREAM_BOUNDS, SEED + 1, (uint64_t)i);
        random_pose(&random, 2.0, &pose);
        matrix_of(&pose, r);
        double low[3] = {INFINITE, INFINITE, INFINITE};
        double high[3] = {-INFINITE, -INFINITE, -INFINITE};
        for (int k = 0; k < 3; k++) {
            children[k].shape = round_shapes[(i + k) % ROUND_KINDS];
            random_pose(&random, 2.0, &children[k].pose);
            tribo_pose whole;
            tribo_quat_multiply(pose.orientation, children[k].pose.orientation, whole.orientation);
            tribo_mat3_apply(r, children[k].pose.position, whole.position);
            tribo_vec3_add(whole.position, pose.position, whole.position);
            assert_int_equal(tribo_shape_bounds(&children[k].shape, &whole, ends[0], ends[1]),
                             TRIBO_OK);
            for (int j = 0; j < 3; j++) {
                low[j] = fmin(low[j], ends[0][j]);
                high[j] = fmax(high[j], ends[1][j]);
            }
        }
        assert_int_equal(tribo_shape_bounds(&shape, &pose, ends[0], ends[1]), TRIBO_OK);
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(low[j] - ends[0][j]) <= 32.0 * EPS);
            assert_true(fabs(high[j] - ends[1][j]) <= 32.0 * EPS);
        }
    }
}

static void test_bounds_statuses(void **state)
{
    (void)state;
    const double nowhere[3] = {0.0, INFINITE, 0.0};
    const tribo_convex liar = {
        .struct_size = sizeof liar, .support = lying_support, .user = nowhere, .radius = 1.0};
    const tribo_shape user = {.type = TRIBO_SHAPE_CONVEX, .data = &liar};
    const tribo_shape bad = {.type = TRIBO_SHAPE_SPHERE};
    tribo_pose pose = {.orientation = {1.0}};
    double low[3] = {1.0, 2.0, 3.0};
    double high[3] = {4.0, 5.0, 6.0};
    assert_int_equal(tribo_shape_bounds(&bad, &pose, low, high), TRIBO_ERROR_SHAPE);
    assert_int_equal(tribo_shape_bounds(&user, &pose, low, high), TRIBO_ERROR_SUPPORT);
    pose.orientation[1] = 0.1;
    assert_int_equal(tribo_shape_bounds(&round_shapes[0], &pose, low, high),
                     TRIBO_ERROR_ORIENTATION);
    pose.position[0] = NOT_A_NUMBER;
    assert_int_equal(tribo_shape_bounds(&round_shapes[0], &pose, low, high),
                     TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_shape_bounds(&round_shapes[0], NULL, low, high), TRIBO_ERROR_NULL);
    assert_true(low[0] == 1.0 && low[2] == 3.0 && high[0] == 4.0 && high[2] == 6.0);
}

/* ---- mass ------------------------------------------------------------------------------------ */

typedef struct mass {
    double mass;
    double center[3];
    double inertia[9];
} mass;

static mass mass_of(const tribo_shape *shape, double density)
{
    mass m;
    assert_int_equal(tribo_shape_mass(shape, density, &m.mass, m.center, m.inertia), TRIBO_OK);
    return m;
}

static void assert_near(double value, double expected, double scale)
{
    if (!(fabs(value - expected) <= 1e-14 * scale)) {
        fail_msg("%.17g is not %.17g by %.3g of %.3g", value, expected, value - expected, scale);
    }
}

static void assert_same_mass(const mass *a, const mass *b, double size)
{
    const double scale = b->mass * size * size;
    assert_near(a->mass, b->mass, b->mass);
    for (int i = 0; i < 3; i++) {
        assert_near(a->center[i], b->center[i], size);
    }
    for (int i = 0; i < 9; i++) {
        assert_near(a->inertia[i], b->inertia[i], scale);
    }
}

static void test_mass_of_closed_forms(void **state)
{
    (void)state;
    const double density = 7.5;
    mass m = mass_of(&round_shapes[1], density);
    mass expected = {.mass = 0.0};
    assert_int_equal(
        tribo_mass_box(density, round_shapes[1].size, &expected.mass, expected.inertia), TRIBO_OK);
    assert_true(same_bits(&m, &expected, sizeof m));
    memset(&expected, 0, sizeof expected);
    m = mass_of(&round_shapes[2], density);
    tribo_mass_capsule(density, 0.4, 1.3, &expected.mass, expected.inertia);
    assert_true(same_bits(&m, &expected, sizeof m));
    memset(&expected, 0, sizeof expected);
    m = mass_of(&round_shapes[3], density);
    tribo_mass_cylinder(density, 0.8, 0.6, &expected.mass, expected.inertia);
    assert_true(same_bits(&m, &expected, sizeof m));
    memset(&expected, 0, sizeof expected);
    m = mass_of(&round_shapes[0], density);
    tribo_mass_sphere(density, 0.7, &expected.mass, expected.inertia);
    assert_true(same_bits(&m, &expected, sizeof m));
    memset(&expected, 0, sizeof expected);
    m = mass_of(&round_shapes[5], density);
    tribo_mass_ellipsoid(density, round_shapes[5].size, &expected.mass, expected.inertia);
    assert_true(same_bits(&m, &expected, sizeof m));
}

/* Discs from base to apex by Gauss's rule of three points, exact for their polynomials of fifth
 * degree. */
static void test_mass_of_a_cone_by_quadrature(void **state)
{
    (void)state;
    static const double nodes[3] = {-0.77459666924148337704, 0.0, 0.77459666924148337704};
    static const double weights[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    const double r = round_shapes[4].size[0];
    const double h = round_shapes[4].size[1];
    mass expected = {.mass = 0.0};
    double second = 0.0;
    double fourth = 0.0;
    for (int i = 0; i < 3; i++) {
        const double z = h * nodes[i];
        const double radius = r * (h - z) / (2.0 * h);
        const double disc = weights[i] * h * 3.0 * PI * radius * radius;
        expected.mass += disc;
        expected.center[2] += disc * z;
        second += disc * z * z;
        fourth += disc * radius * radius / 4.0;
    }
    expected.center[2] /= expected.mass;
    second -= expected.mass * expected.center[2] * expected.center[2];
    expected.inertia[0] = second + fourth;
    expected.inertia[4] = second + fourth;
    expected.inertia[8] = 2.0 * fourth;
    const mass m = mass_of(&round_shapes[4], 3.0);
    assert_same_mass(&m, &expected, 1.0);
    assert_near(m.center[2], -0.5 * h, 1.0);
}

static void box_points(const double half[3], const double center[3], double points[24])
{
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 3; k++) {
            points[3 * i + k] = center[k] + ((i >> k) % 2 ? half[k] : -half[k]);
        }
    }
}

static void test_mass_of_hulls(void **state)
{
    (void)state;
    const double half[3] = {0.3, 1.7, 0.9};
    const double center[3] = {0.25, -3.0, 5.0};
    double points[24];
    box_points(half, center, points);
    void *block = build_hull(8, points);
    const tribo_shape hull = hull_shape(block);
    mass m = mass_of(&hull, 2.0);
    mass expected = mass_of(&round_shapes[1], 2.0);
    memcpy(expected.center, center, sizeof center);
    assert_same_mass(&m, &expected, 2.0);
    free(block);
    /* The tetrahedron (0, a, b, c) along the axes: m = abc/6, centre a quarter, I_xx = m (b^2 +
     * c^2) 3/80, I_xy = m a b / 80. */
    const double tetra[12] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0};
    const mass simplex = {1.0,
                          {0.25, 0.5, 0.75},
                          {39.0 / 80.0, 2.0 / 80.0, 3.0 / 80.0, 2.0 / 80.0, 30.0 / 80.0, 6.0 / 80.0,
                           3.0 / 80.0, 6.0 / 80.0, 15.0 / 80.0}};
    block = build_hull(4, tetra);
    const tribo_shape corner = hull_shape(block);
    m = mass_of(&corner, 1.0);
    assert_same_mass(&m, &simplex, 3.0);
    free(block);
    /* A pyramid of height 3 on a square of side 2: centre a quarter up, I_zz = m 8/20,
     * I_xx = m (4/20 + 27/80). The mean of its vertices is another point. */
    const mass tip = {4.0, {0.0, 0.0, 0.75}, {2.15, 0.0, 0.0, 0.0, 2.15, 0.0, 0.0, 0.0, 1.6}};
    block = build_hull(5, pyramid);
    const tribo_shape peak = hull_shape(block);
    m = mass_of(&peak, 1.0);
    assert_same_mass(&m, &tip, 3.0);
    free(block);
}

/* Turned boxes down to needles of aspect 1e-9; far from the origin as near. */
static void test_mass_of_thin_hulls(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        problem_random random;
        tribo_pose pose;
        double r[9];
        double points[24];
        problem_random_start(&random, STREAM_MASS, SEED, (uint64_t)i);
        const double thin = problem_random_decades(&random, -9.0, 0.0);
        const double half[3] = {1.0, i % 2 ? thin : 0.7, thin};
        const double zero[3] = {0.0, 0.0, 0.0};
        random_pose(&random, 0.0, &pose);
        matrix_of(&pose, r);
        box_points(half, zero, points);
        for (int k = 0; k < 8; k++) {
            tribo_mat3_apply(r, points + 3 * k, points + 3 * k);
        }
        void *block = build_hull(8, points);
        const tribo_shape hull = hull_shape(block);
        const mass m = mass_of(&hull, 1.0);
        const double expected = 8.0 * half[0] * half[1] * half[2];
        assert_true(fabs(m.mass - expected) <= 32.0 * EPS / thin * expected);
        assert_true(length(m.center) <= 32.0 * EPS / thin);
        const double trace = m.inertia[0] + m.inertia[4] + m.inertia[8];
        const double sum = expected * 2.0 / 3.0 * dot(half, half);
        assert_true(fabs(trace - sum) <= 64.0 * EPS / thin * sum);
        free(block);
    }
}

/* A box cut into eight is the box again; children may be turned. */
static void test_mass_of_compounds(void **state)
{
    (void)state;
    const double far[3] = {100.0, -200.0, 300.0};
    const tribo_shape part = shape_of(TRIBO_SHAPE_BOX, 0.5, 1.0, 1.5);
    tribo_child children[8];
    for (int i = 0; i < 8; i++) {
        children[i] = child_of(&part, far[0] + (i % 2 ? 0.5 : -0.5),
                               far[1] + (i / 2 % 2 ? 1.0 : -1.0), far[2] + (i / 4 ? 1.5 : -1.5));
    }
    /* A quarter turn about x swaps y and z. */
    children[3].shape = shape_of(TRIBO_SHAPE_BOX, 0.5, 1.5, 1.0);
    children[3].pose.orientation[0] = sqrt(0.5);
    children[3].pose.orientation[1] = sqrt(0.5);
    const tribo_shape whole = {.type = TRIBO_SHAPE_COMPOUND, .count = 8, .data = children};
    const tribo_shape box = shape_of(TRIBO_SHAPE_BOX, 1.0, 2.0, 3.0);
    const mass m = mass_of(&whole, 1.5);
    mass expected = mass_of(&box, 1.5);
    memcpy(expected.center, far, sizeof far);
    assert_same_mass(&m, &expected, 30.0);
    const tribo_child cone = child_of(&round_shapes[4], 0.0, 0.0, 0.0);
    const tribo_shape alone = {.type = TRIBO_SHAPE_COMPOUND, .count = 1, .data = &cone};
    const mass a = mass_of(&alone, 1.5);
    const mass b = mass_of(&round_shapes[4], 1.5);
    assert_same_mass(&a, &b, 1.0);
}

static void test_mass_statuses(void **state)
{
    (void)state;
    const double half[3] = {1.0, 1.0, 1.0};
    const tribo_convex convex = user_box(half);
    const tribo_shape user = {.type = TRIBO_SHAPE_CONVEX, .data = &convex};
    const tribo_shape plane = {.type = TRIBO_SHAPE_HALFSPACE, .size = {0.0, 0.0, 1.0, 0.0}};
    const tribo_shape huge = shape_of(TRIBO_SHAPE_CONE, 1e200, 1e200, 0.0);
    const tribo_child child = child_of(&user, 0.0, 0.0, 0.0);
    const tribo_shape compound = {.type = TRIBO_SHAPE_COMPOUND, .count = 1, .data = &child};
    mass m = {.mass = 5.0};
    const mass before = m;
    assert_int_equal(tribo_shape_mass(&user, 1.0, &m.mass, m.center, m.inertia), TRIBO_ERROR_SHAPE);
    assert_int_equal(tribo_shape_mass(&plane, 1.0, &m.mass, m.center, m.inertia),
                     TRIBO_ERROR_SHAPE);
    assert_int_equal(tribo_shape_mass(&compound, 1.0, &m.mass, m.center, m.inertia),
                     TRIBO_ERROR_SHAPE);
    assert_int_equal(tribo_shape_mass(&huge, 1.0, &m.mass, m.center, m.inertia), TRIBO_ERROR_RANGE);
    for (int kind = 0; kind < ROUND_KINDS; kind++) {
        const tribo_shape *shape = &round_shapes[kind];
        assert_int_equal(tribo_shape_mass(shape, 0.0, &m.mass, m.center, m.inertia),
                         TRIBO_ERROR_SHAPE);
        assert_int_equal(tribo_shape_mass(shape, NOT_A_NUMBER, &m.mass, m.center, m.inertia),
                         TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_shape_mass(shape, 1.0, NULL, m.center, m.inertia), TRIBO_ERROR_NULL);
    }
    assert_true(same_bits(&m, &before, sizeof m));
}

/* ---- hulls ----------------------------------------------------------------------------------- */

static void assert_counts(const void *block, uint32_t vertices, uint32_t faces)
{
    uint32_t v;
    uint32_t f;
    assert_int_equal(tribo_hull_counts(block, &v, &f), TRIBO_OK);
    assert_int_equal(v, vertices);
    assert_int_equal(f, faces);
}

/* All input inside of all planes, all loops counter-clockwise in their plane, rings closed: each
 * step round a vertex shares an edge with the one before. */
static void assert_hull(const hull_block *hull, size_t count, const double *points,
                        double tolerance)
{
    const double *v = hull_vertices(hull);
    const double *planes = hull_planes(hull);
    const uint32_t *starts = hull_table(hull, hull->face_starts);
    const uint32_t *loops = hull_table(hull, hull->loops);
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const double *n = planes + 4 * f;
        double area[3] = {0.0, 0.0, 0.0};
        for (size_t i = 0; i < count; i++) {
            assert_true(dot(n, points + 3 * i) <= n[3] + tolerance);
        }
        for (uint32_t k = starts[f]; k < starts[f + 1]; k++) {
            const uint32_t next = k + 1 < starts[f + 1] ? k + 1 : starts[f];
            double cross[3];
            double to[3];
            double from[3];
            tribo_vec3_subtract(v + 3 * loops[k], v + 3 * loops[starts[f]], from);
            tribo_vec3_subtract(v + 3 * loops[next], v + 3 * loops[starts[f]], to);
            tribo_vec3_cross(from, to, cross);
            tribo_vec3_add(area, cross, area);
            assert_true(fabs(dot(n, v + 3 * loops[k]) - n[3]) <= tolerance);
        }
        assert_true(dot(area, n) > -tolerance); /* that of a sliver is 0 to rounding */
    }
    const uint32_t *ring_starts = hull_table(hull, hull->ring_starts);
    const uint32_t *rings = hull_table(hull, hull->rings);
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        for (uint32_t k = ring_starts[i]; k < ring_starts[i + 1]; k++) {
            const uint32_t next = k + 1 < ring_starts[i + 1] ? k + 1 : ring_starts[i];
            const uint32_t at = rings[2 * k + 1];
            int side = 0; /* i -> neighbour, and the next neighbour -> i, in one face */
            for (uint32_t s = starts[at]; s < starts[at + 1]; s++) {
                const uint32_t after = s + 1 < starts[at + 1] ? s + 1 : starts[at];
                side += loops[s] == i && loops[after] == rings[2 * k];
                side += loops[after] == i && loops[s] == rings[2 * next];
            }
            assert_int_equal(side, 2);
        }
    }
}

static size_t grid_points(int n, const double step[3], double *points)
{
    size_t count = 0;
    for (int i = 0; i < n * n * n; i++, count++) {
        points[3 * count] = step[0] * (i % n);
        points[3 * count + 1] = step[1] * (i / n % n);
        points[3 * count + 2] = step[2] * (i / n / n);
    }
    return count;
}

/* Points on its faces and edges leave a box a box, turned as it may be. */
static void test_hull_of_a_box(void **state)
{
    (void)state;
    static double points[3 * 512];
    static double turned[3 * 512];
    const double step[3] = {0.1, 0.3, 0.7};
    const size_t count = grid_points(8, step, points);
    for (int i = 0; i < 200; i++) {
        problem_random random;
        tribo_pose pose;
        double r[9];
        problem_random_start(&random, STREAM_HULL, SEED, (uint64_t)i);
        random_pose(&random, 10.0, &pose);
        if (i == 0) {
            memset(&pose, 0, sizeof pose);
            pose.orientation[0] = 1.0;
        }
        matrix_of(&pose, r);
        for (size_t k = 0; k < count; k++) {
            tribo_mat3_apply(r, points + 3 * k, turned + 3 * k);
            tribo_vec3_add(turned + 3 * k, pose.position, turned + 3 * k);
        }
        hull_block *hull = build_hull(count, turned);
        assert_counts(hull, 8, 6);
        assert_int_equal(hull->side_count, 24);
        for (uint32_t f = 0; f < 6; f++) {
            assert_int_equal(hull_table(hull, hull->face_starts)[f], 4 * f);
        }
        assert_hull(hull, count, turned, 64.0 * EPS * 20.0);
        free(hull);
    }
}

static void ball_points(problem_random *random, size_t count, int on_the_sphere, double *points)
{
    for (size_t i = 0; i < count; i++) {
        double *p = points + 3 * i;
        problem_random_direction(random, 3, p);
        const double radius = on_the_sphere ? 1.0 : problem_random_uniform(random, 0.0, 1.0);
        tribo_vec3_scale(radius, p, p);
    }
}

static void assert_supports(const tribo_shape *shape, size_t count, const double *points,
                            int directions, problem_random *random)
{
    for (int i = 0; i < directions; i++) {
        double d[3];
        double p[3];
        double best = -INFINITE;
        problem_random_direction(random, 3, d);
        for (size_t k = 0; k < count; k++) {
            best = fmax(best, dot(d, points + 3 * k));
        }
        assert_int_equal(tribo_shape_support(shape, d, p), TRIBO_OK);
        assert_true(dot(d, p) >= best - 4.0 * EPS);
    }
}

static void test_hull_supports_against_all_points(void **state)
{
    (void)state;
    static double points[3 * 2000];
    static const size_t counts[] = {4, 10, 32, 33, 100, 400, 2000};
    for (int sphere = 0; sphere < 2; sphere++) {
        for (uint64_t i = 0; i < 7; i++) {
            problem_random random;
            problem_random_start(&random, STREAM_HULL, SEED + 1, 2 * i + (uint64_t)sphere);
            ball_points(&random, counts[i], sphere, points);
            hull_block *hull = build_hull(counts[i], points);
            const tribo_shape shape = hull_shape(hull);
            assert_hull(hull, counts[i], points, 1e-14);
            assert_true(!sphere || hull->vertex_count == counts[i]);
            assert_supports(&shape, counts[i], points, (int)(i < 6 ? 100000 / counts[i] : 5000),
                            &random);
            free(hull);
        }
    }
}

/* The face lies at the support point, and none there faces the direction more. */
static void test_faces_of_hulls(void **state)
{
    (void)state;
    static double points[3 * 200];
    problem_random random;
    problem_random_start(&random, STREAM_FACE, SEED + 1, 0);
    ball_points(&random, 200, 1, points);
    hull_block *hull = build_hull(200, points);
    const tribo_shape shape = hull_shape(hull);
    for (uint32_t i = 0; i < hull->face_count; i++) {
        const double *n = hull_planes(hull) + 4 * i;
        const face f = face_of(&shape, 1e-180 * n[0], 1e-180 * n[1], 1e-180 * n[2]);
        assert_int_equal(f.feature, i);
        assert_polygon(&f, 1.0);
    }
    for (int i = 0; i < 20000; i++) {
        double d[3];
        double p[3];
        int has_support = 0;
        problem_random_direction(&random, 3, d);
        const face f = face_of(&shape, d[0], d[1], d[2]);
        assert_int_equal(tribo_shape_support(&shape, d, p), TRIBO_OK);
        for (uint32_t k = 0; k < f.count; k++) {
            has_support = has_support || same_bits(p, f.points + 3 * k, sizeof p);
        }
        assert_true(has_support);
        for (uint32_t k = 0; k < hull->face_count; k++) {
            const double *n = hull_planes(hull) + 4 * k;
            assert_true(dot(n, p) < n[3] - 1e-12 || dot(n, d) <= dot(f.normal, d) + 4.0 * EPS);
        }
    }
    free(hull);
}

/* Faces of many vertices are thinned to what a clipper takes, and keep their area and the support
 * point. */
static void test_large_faces_are_thinned(void **state)
{
    (void)state;
    enum { SIDES = 500 };
    static double points[6 * SIDES];
    for (int i = 0; i < SIDES; i++) {
        const double angle = 2.0 * PI * i / SIDES;
        for (int k = 0; k < 2; k++) {
            points[6 * i + 3 * k] = cos(angle);
            points[6 * i + 3 * k + 1] = sin(angle);
            points[6 * i + 3 * k + 2] = k;
        }
    }
    hull_block *hull = build_hull(2 * SIDES, points);
    const tribo_shape shape = hull_shape(hull);
    assert_counts(hull, 2 * SIDES, SIDES + 2);
    for (int i = 0; i < 1000; i++) {
        problem_random random;
        double p[3];
        double height = -INFINITE;
        problem_random_start(&random, STREAM_FACE, SEED + 2, (uint64_t)i);
        const double d[3] = {problem_random_uniform(&random, -0.3, 0.3),
                             problem_random_uniform(&random, -0.3, 0.3), i % 2 ? 1.0 : -1.0};
        const face f = face_of(&shape, d[0], d[1], d[2]);
        assert_true(f.count > 8 && f.count <= TRIBO_MAX_FACE);
        assert_polygon(&f, 1.0);
        double area = 0.0;
        for (uint32_t k = 0; k < f.count; k++) {
            const double *a = f.points + 3 * k;
            const double *b = f.points + 3 * ((k + 1) % f.count);
            area += 0.5 * f.normal[2] * (a[0] * b[1] - a[1] * b[0]);
            height = fmax(height, dot(d, a));
        }
        assert_true(area >= 0.98 * PI);
        assert_int_equal(tribo_shape_support(&shape, d, p), TRIBO_OK);
        assert_true(height == dot(d, p));
    }
    free(hull);
}

static void test_hulls_scale_to_the_bit(void **state)
{
    (void)state;
    static const int powers[] = {-100, -7, 5, 100};
    static double points[300];
    static double scaled[300];
    problem_random random;
    problem_random_start(&random, STREAM_HULL, SEED + 2, 0);
    ball_points(&random, 100, 0, points);
    hull_block *hull = build_hull(100, points);
    const tribo_shape shape = hull_shape(hull);
    const mass m = mass_of(&shape, 1.0);
    for (int i = 0; i < 4; i++) {
        const double scale = ldexp(1.0, powers[i]);
        for (int k = 0; k < 300; k++) {
            scaled[k] = scale * points[k];
        }
        hull_block *other = build_hull(100, scaled);
        const tribo_shape other_shape = hull_shape(other);
        const mass n = mass_of(&other_shape, 1.0);
        assert_true(same_bits(hull_table(hull, hull->face_starts),
                              hull_table(other, other->face_starts),
                              (size_t)(hull->bytes - hull->face_starts)));
        for (uint32_t f = 0; f < hull->face_count; f++) {
            const double *a = hull_planes(hull) + 4 * f;
            const double *b = hull_planes(other) + 4 * f;
            assert_true(same_bits(a, b, 3 * sizeof *a));
            assert_true(scale * a[3] == b[3]);
        }
        assert_true(n.mass == m.mass * scale * scale * scale);
        assert_true(n.center[0] == m.center[0] * scale);
        assert_true(n.inertia[1] == m.inertia[1] * pow(scale, 5));
        free(other);
    }
    free(hull);
}

static void assert_degenerate(size_t count, const double *points)
{
    unsigned char block[4096];
    unsigned char before[4096];
    size_t needed = 12345;
    memset(block, 0xa5, sizeof block);
    memset(before, 0xa5, sizeof before);
    assert_int_equal(tribo_hull_build(count, points, block, sizeof block, &needed),
                     TRIBO_ERROR_DEGENERATE);
    assert_int_equal(needed, 12345);
    assert_true(same_bits(block, before, sizeof block));
}

static void test_hulls_of_flat_points(void **state)
{
    (void)state;
    double points[60];
    for (int i = 0; i < 60; i++) {
        points[i] = 0.3;
    }
    assert_degenerate(20, points);
    for (int scale = -2; scale <= 2; scale++) {
        for (int i = 0; i < 20; i++) { /* a line */
            for (int k = 0; k < 3; k++) {
                points[3 * i + k] = pow(10.0, 15.0 * scale) * (i * 0.1 + k);
            }
        }
        assert_degenerate(20, points);
        for (int i = 0; i < 20; i++) { /* a plane */
            points[3 * i] = pow(10.0, 15.0 * scale) * (i % 5);
            points[3 * i + 2] = points[3 * i] + pow(10.0, 15.0 * scale) * (i / 5) * 0.7;
            points[3 * i + 1] = 0.1 * points[3 * i + 2] + 0.3 * points[3 * i];
        }
        assert_degenerate(20, points);
        points[1] += 3e-12 * pow(10.0, 15.0 * scale) * 20.0;
        free(build_hull(20, points));
    }
}

/* The limit is 1e-12 of the extent, to a factor of two. */
static void test_how_thin_a_hull_may_be(void **state)
{
    (void)state;
    const double zero[3] = {0.0, 0.0, 0.0};
    for (int scale = -2; scale <= 2; scale++) {
        const double size = pow(10.0, 15.0 * scale);
        const double plate[3] = {size, 0.9 * size, 0.4e-12 * size};
        const double needle[3] = {size, 0.4e-12 * size, 0.3e-12 * size};
        const double thin[3] = {size, 0.9 * size, 2.1e-12 * size};
        double points[24];
        box_points(plate, zero, points);
        assert_degenerate(8, points);
        box_points(needle, zero, points);
        assert_degenerate(8, points);
        box_points(thin, zero, points);
        void *block = build_hull(8, points);
        assert_counts(block, 8, 6);
        free(block);
    }
}

static void test_hull_statuses(void **state)
{
    (void)state;
    double points[24];
    const double half[3] = {1.0, 1.0, 1.0};
    const double zero[3] = {0.0, 0.0, 0.0};
    unsigned char small[64];
    size_t needed = 0;
    uint32_t count = 5;
    box_points(half, zero, points);
    memset(small, 0xa5, sizeof small);
    assert_int_equal(tribo_hull_build(8, NULL, small, 64, &needed), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_hull_build(8, points, NULL, 64, &needed), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_hull_build(3, points, small, 64, &needed), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_hull_build((size_t)1 << 40, points, small, 64, &needed),
                     TRIBO_ERROR_RANGE);
    points[5] = NOT_A_NUMBER;
    assert_int_equal(tribo_hull_build(8, points, small, 64, &needed), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(needed, 0);
    points[5] = -1.0;
    assert_int_equal(tribo_hull_build(8, points, small, 64, &needed), TRIBO_ERROR_CAPACITY);
    assert_true(needed > 64 && needed % 8 == 0);
    assert_int_equal(small[0], 0xa5);
    assert_int_equal(small[63], 0xa5);
    assert_int_equal(tribo_hull_counts(NULL, &count, &count), TRIBO_ERROR_NULL);
    double nonsense[64] = {0.0};
    assert_int_equal(tribo_hull_counts(nonsense, &count, &count), TRIBO_ERROR_DATA);
    assert_int_equal(count, 5);
}

/* Numbers at the ends of the range: no overflow on the way. */
static void test_hulls_of_extreme_sizes(void **state)
{
    (void)state;
    static const double sizes[] = {1e-300, 1e-30, 1e30, 1e308};
    for (int i = 0; i < 4; i++) {
        const double half[3] = {sizes[i], 0.5 * sizes[i], 0.25 * sizes[i]};
        const double zero[3] = {0.0, 0.0, 0.0};
        double points[24];
        box_points(half, zero, points);
        hull_block *hull = build_hull(8, points);
        assert_counts(hull, 8, 6);
        const tribo_shape shape = hull_shape(hull);
        assert_support(&shape, 1.0, -1.0, 1.0, half[0], -half[1], half[2]);
        free(hull);
    }
    const double half[3] = {1.7e308, 1.7e308, 1.7e308};
    const double zero[3] = {0.0, 0.0, 0.0};
    double points[24];
    box_points(half, zero, points);
    assert_int_equal(tribo_hull_build(8, points, NULL, 0, NULL), TRIBO_ERROR_RANGE);
}

static void test_blocks_mean_the_same_elsewhere(void **state)
{
    (void)state;
    static double points[300];
    problem_random random;
    problem_random_start(&random, STREAM_HULL, SEED + 3, 0);
    ball_points(&random, 100, 0, points);
    hull_block *hull = build_hull(100, points);
    const size_t size = (size_t)hull->bytes;
    hull_block *again = build_hull(100, points);
    hull_block *copy = malloc(size + 8);
    assert_non_null(copy);
    assert_true(same_bits(hull, again, size));
    memcpy((unsigned char *)copy + 8, hull, size);
    const tribo_shape a = hull_shape(again);
    const tribo_shape b = hull_shape((unsigned char *)copy + 8);
    memset(hull, 0, size);
    free(hull);
    assert_int_equal(tribo_shape_check(&b), TRIBO_OK);
    for (int i = 0; i < 2000; i++) {
        double d[3];
        double p[3];
        double q[3];
        problem_random_direction(&random, 3, d);
        assert_int_equal(tribo_shape_support(&a, d, p), TRIBO_OK);
        assert_int_equal(tribo_shape_support(&b, d, q), TRIBO_OK);
        assert_true(same_bits(p, q, sizeof p));
    }
    free(copy);
    free(again);
}

/* A bit of a byte turns over. */
static void damage(problem_random *random, unsigned char *byte)
{
    *byte = (unsigned char)(*byte ^ 1u << problem_random_bits(random) % 8u);
}

static void test_block_statuses(void **state)
{
    (void)state;
    static double points[150];
    problem_random random;
    problem_random_start(&random, STREAM_HULL, SEED + 5, 0);
    ball_points(&random, 50, 1, points);
    hull_block *hull = build_hull(50, points);
    const size_t size = (size_t)hull->bytes;
    unsigned char *moved = malloc(size + 16);
    assert_non_null(moved);
    memcpy(moved + 1, hull, size);
    assert_int_equal(tribo_hull_check(NULL, size), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_hull_check(hull, size), TRIBO_OK);
    assert_int_equal(tribo_hull_check(hull, size + 8), TRIBO_OK);
    assert_int_equal(tribo_hull_check(hull, size - 1), TRIBO_ERROR_DATA);
    assert_int_equal(tribo_hull_check(hull, 16), TRIBO_ERROR_DATA);
    assert_int_equal(tribo_hull_check(hull, 0), TRIBO_ERROR_DATA);
    assert_int_equal(tribo_hull_check(moved + 1, size), TRIBO_ERROR_DATA);
    memcpy(moved + 8, hull, size);
    assert_int_equal(tribo_hull_check(moved + 8, size), TRIBO_OK);
    assert_int_equal(tribo_mesh_check(hull, size), TRIBO_ERROR_DATA);
    double *vertices = (double *)(void *)((unsigned char *)hull + hull->vertices);
    for (int i = 1; i < 50; i++) {
        /* two signs, which are the highest bits of their words */
        vertices[0] = -vertices[0];
        vertices[i] = -vertices[i];
        assert_int_equal(tribo_hull_check(hull, size), TRIBO_ERROR_DATA);
        vertices[0] = -vertices[0];
        vertices[i] = -vertices[i];
    }
    assert_int_equal(tribo_hull_check(hull, size), TRIBO_OK);
    free(moved);
    free(hull);
}

/* A block with any bit changed is refused. If the sum is put right, the block is refused still, or
 * every query on it stays within it. */
static void test_broken_hull_blocks(void **state)
{
    (void)state;
    static double points[150];
    problem_random random;
    problem_random_start(&random, STREAM_HULL, SEED + 4, 0);
    ball_points(&random, 50, 1, points);
    hull_block *hull = build_hull(50, points);
    const size_t size = (size_t)hull->bytes;
    unsigned char *bytes = (unsigned char *)hull;
    unsigned refused = 0;
    for (size_t i = 0; i < size; i++) {
        const unsigned char before = bytes[i];
        const uint64_t sum = hull->sum;
        const tribo_shape shape = hull_shape(hull);
        damage(&random, bytes + i);
        assert_int_equal(tribo_hull_check(hull, size), TRIBO_ERROR_DATA);
        if (i < offsetof(hull_block, center)) {
            assert_false(hull_head_is_valid(hull));
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_DATA);
            bytes[i] = before;
            continue;
        }
        hull->sum = hull_sum(hull);
        if (tribo_hull_check(hull, size) == TRIBO_OK) {
            double d[3];
            problem_random_direction(&random, 3, d);
            face_of(&shape, d[0], d[1], d[2]);
        } else {
            refused++;
        }
        bytes[i] = before;
        hull->sum = sum;
    }
    assert_true(refused > size / 20);
    const struct {
        uint64_t table;
        uint32_t limit;
    } words[] = {{hull->loops, hull->vertex_count},
                 {hull->rings, hull->vertex_count},
                 {hull->rings + 4, hull->face_count},
                 {hull->seeds, hull->vertex_count},
                 {hull->face_starts + 4, hull->side_count + 1},
                 {hull->ring_starts + 4, hull->side_count + 1}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        uint32_t *word = (uint32_t *)(void *)(bytes + words[i].table);
        const uint32_t before = *word;
        *word = words[i].limit;
        hull->sum = hull_sum(hull);
        assert_int_equal(tribo_hull_check(hull, size), TRIBO_ERROR_DATA);
        *word = before;
        hull->sum = hull_sum(hull);
        assert_int_equal(tribo_hull_check(hull, size), TRIBO_OK);
    }
    free(hull);
}

/* Random sets of every shape that is bad for a hull: a valid hull or a status, and Qhull silent. */
static void test_hulls_of_bad_points(void **state)
{
    (void)state;
    static double points[3 * 300];
    unsigned built = 0;
    for (uint64_t i = 0; i < 3000; i++) {
        problem_random random;
        problem_random_start(&random, STREAM_HULL, SEED + 5, i);
        const size_t count = 4 + problem_random_bits(&random) % 296;
        const double thin[3] = {1.0, problem_random_decades(&random, -13.0, 0.0),
                                problem_random_decades(&random, -13.0, 0.0)};
        const double step = i % 3 == 0 ? 0.25 : problem_random_decades(&random, -16.0, -1.0);
        tribo_pose pose;
        double r[9];
        random_pose(&random, i % 5 == 0 ? 1e3 : 0.0, &pose);
        matrix_of(&pose, r);
        for (size_t k = 0; k < count; k++) {
            double *p = points + 3 * k;
            for (int j = 0; j < 3; j++) {
                p[j] = step * rint(problem_random_uniform(&random, -1.0, 1.0) / step) * thin[j];
            }
            if (i % 2 == 0) {
                tribo_mat3_apply(r, p, p);
                tribo_vec3_add(p, pose.position, p);
            }
        }
        size_t needed = 0;
        const tribo_status status = tribo_hull_build(count, points, NULL, 0, &needed);
        assert_true(status == TRIBO_ERROR_CAPACITY || status == TRIBO_ERROR_DEGENERATE);
        if (status == TRIBO_ERROR_CAPACITY) {
            hull_block *hull = build_hull(count, points);
            assert_hull(hull, count, points, i % 5 == 0 ? 1e-11 : 1e-13);
            free(hull);
            built++;
        }
    }
    print_message("# bad points: %u of 3000 sets have a hull\n", built);
    assert_true(built > 2000);
}

/* What is written to a stream while the body runs. */
static long written(FILE *stream, void (*body)(void **), void **state)
{
    fflush(stream);
    FILE *const file = tmpfile();
    assert_non_null(file);
    const int saved = dup(fileno(stream));
    assert_true(saved >= 0 && dup2(fileno(file), fileno(stream)) >= 0);
    body(state);
    fflush(stream);
    const long size = ftell(file) >= 0 && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    assert_true(dup2(saved, fileno(stream)) >= 0);
    close(saved);
    fclose(file);
    return size;
}

static void build_many_quietly(void **state)
{
    static double points[3 * 50];
    (void)state;
    for (uint64_t i = 0; i < 500; i++) {
        problem_random random;
        problem_random_start(&random, STREAM_HULL, SEED + 6, i);
        for (int k = 0; k < 150; k++) {
            const double thin = k % 3 == 2 ? problem_random_decades(&random, -14.0, -10.0) : 1.0;
            points[k] = thin * problem_random_uniform(&random, -1.0, 1.0);
        }
        tribo_hull_build(50, points, NULL, 0, NULL);
    }
}

static void test_hulls_print_nothing(void **state)
{
    assert_int_equal(written(stderr, build_many_quietly, state), 0);
    assert_int_equal(written(stdout, build_many_quietly, state), 0);
}

static void test_hull_of_a_million_points(void **state)
{
    (void)state;
    enum { MILLION = 1000000 };
    const char *slow = getenv("TRIBO_SLOW");
    if (!slow || !*slow) {
        skip();
    }
    double *points = malloc(3 * MILLION * sizeof *points);
    assert_non_null(points);
    for (int sphere = 0; sphere < 2; sphere++) {
        problem_random random;
        problem_random_start(&random, STREAM_HULL, SEED + 7, (uint64_t)sphere);
        ball_points(&random, MILLION, sphere, points);
        hull_block *hull = build_hull(MILLION, points);
        const tribo_shape shape = hull_shape(hull);
        print_message("# a million points: %u vertices\n", hull->vertex_count);
        assert_supports(&shape, MILLION, points, 100, &random);
        free(hull);
    }
    free(points);
}

/* ---- meshes ---------------------------------------------------------------------------------- */

static mesh_block *build_mesh(size_t vertex_count, const double *vertices, size_t count,
                              const uint32_t *triangles)
{
    size_t needed = 0;
    assert_int_equal(tribo_mesh_build(vertex_count, vertices, count, triangles, NULL, 0, &needed),
                     TRIBO_ERROR_CAPACITY);
    mesh_block *mesh = malloc(needed);
    assert_non_null(mesh);
    assert_int_equal(tribo_mesh_build(vertex_count, vertices, count, triangles, mesh, needed, NULL),
                     TRIBO_OK);
    assert_int_equal(tribo_mesh_check(mesh, needed), TRIBO_OK);
    return mesh;
}

/* A height field of n x n cells, two triangles each. */
static mesh_block *terrain(int n, double height, problem_random *random)
{
    const int side = n + 1;
    double *vertices = malloc(3 * (size_t)(side * side) * sizeof *vertices);
    uint32_t *triangles = malloc(6 * (size_t)(n * n) * sizeof *triangles);
    assert_true(vertices && triangles);
    for (int i = 0; i < side * side; i++) {
        vertices[3 * i] = i % side;
        vertices[3 * i + 1] = i / side;
        vertices[3 * i + 2] = height * problem_random_uniform(random, -1.0, 1.0);
    }
    for (int i = 0; i < n * n; i++) {
        const uint32_t a = (uint32_t)(i / n * side + i % n);
        const uint32_t b = a + (uint32_t)side;
        const uint32_t corners[6] = {a, a + 1, b + 1, a, b + 1, b};
        memcpy(triangles + 6 * i, corners, sizeof corners);
    }
    mesh_block *mesh = build_mesh((size_t)(side * side), vertices, 2 * (size_t)(n * n), triangles);
    free(vertices);
    free(triangles);
    return mesh;
}

static void test_mesh_queries_against_all_triangles(void **state)
{
    (void)state;
    static const int sizes[] = {1, 2, 3, 7, 40};
    for (uint64_t s = 0; s < 5; s++) {
        problem_random random;
        problem_random_start(&random, STREAM_MESH, SEED, s);
        mesh_block *mesh = terrain(sizes[s], 0.3, &random);
        for (int i = 0; i < 300; i++) {
            double low[3];
            double high[3];
            mesh_cursor cursor;
            mesh_triangle triangle;
            uint32_t slot = 0;
            for (int k = 0; k < 3; k++) {
                const double middle = problem_random_uniform(&random, -1.0, k < 2 ? sizes[s] : 1.0);
                const double half = problem_random_decades(&random, -2.0, 2.0);
                low[k] = middle - half;
                high[k] = middle + half;
            }
            mesh_begin(mesh, low, high, &cursor);
            int more = mesh_next(&cursor, &triangle);
            for (; slot < mesh->face_count; slot++) {
                const mesh_face *f = &mesh_faces(mesh)[slot];
                int apart = 0;
                for (int k = 0; k < 3; k++) {
                    double least = INFINITE;
                    double greatest = -INFINITE;
                    for (int c = 0; c < 3; c++) {
                        const double x = mesh_vertices(mesh)[3 * f->vertices[c] + (uint32_t)k];
                        least = fmin(least, x);
                        greatest = fmax(greatest, x);
                    }
                    apart = apart || least > high[k] || greatest < low[k];
                }
                if (!apart) {
                    assert_true(more && triangle.index == slot);
                    assert_true(triangle.normal[2] > 0.0);
                    assert_true(fabs(length(triangle.normal) - 1.0) <= 4.0 * EPS);
                    more = mesh_next(&cursor, &triangle);
                }
            }
            assert_false(more);
        }
        free(mesh);
    }
}

static uint32_t active_edges(const mesh_block *mesh)
{
    uint32_t active = 0;
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            active += (mesh_faces(mesh)[i].flags & MESH_ACTIVE(k)) != 0;
        }
    }
    return active;
}

/* Of a flat terrain only the rim is active; of a cube all but the diagonals; of a room nothing. */
static void test_inner_edges(void **state)
{
    (void)state;
    static const uint32_t cube[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const double half[3] = {1.0, 2.0, 3.0};
    const double zero[3] = {0.0, 0.0, 0.0};
    problem_random random;
    double corners[24];
    double soup[108];
    uint32_t room[36];
    uint32_t own[36];
    problem_random_start(&random, STREAM_MESH, SEED + 1, 0);
    mesh_block *mesh = terrain(10, 0.0, &random);
    assert_int_equal(active_edges(mesh), 40);
    free(mesh);
    box_points(half, zero, corners);
    mesh = build_mesh(8, corners, 12, cube);
    assert_int_equal(active_edges(mesh), 24);
    free(mesh);
    for (size_t i = 0; i < 36; i++) {
        room[i] = cube[i - i % 3 + (3 - i % 3) % 3];
        own[i] = (uint32_t)i;
        memcpy(soup + 3 * i, corners + 3 * cube[i], 3 * sizeof *soup);
    }
    mesh = build_mesh(8, corners, 12, room);
    assert_int_equal(active_edges(mesh), 0);
    free(mesh);
    mesh = build_mesh(36, soup, 12, own); /* no vertex shared */
    assert_int_equal(active_edges(mesh), 24);
    free(mesh);
    static const double blade[12] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 1.0, 0.0, 0.3, 1.0, 0.0};
    static const uint32_t sheet[6] = {0, 1, 2, 1, 0, 3};
    mesh = build_mesh(4, blade, 2, sheet); /* folded back on itself */
    assert_int_equal(active_edges(mesh), 6);
    free(mesh);
    for (int side = -1; side <= 1; side += 2) { /* wound against each other */
        const double bent[12] = {0.0, 0.0, 0.0, 1.0, 0.0,  0.0,
                                 0.3, 1.0, 0.0, 0.3, -1.0, (double)side};
        static const uint32_t crossed[6] = {0, 1, 2, 0, 1, 3};
        mesh = build_mesh(4, bent, 2, crossed);
        assert_int_equal(active_edges(mesh), 6);
        free(mesh);
    }
}

static void test_mesh_leaves_degenerate_triangles_out(void **state)
{
    (void)state;
    static const double vertices[15] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0,
                                        0.0, 2.0, 0.0, 0.0, 5.0, 5.0, 5.0};
    static const uint32_t triangles[15] = {0, 0, 1, 0, 1, 2, 0, 1, 3, 2, 2, 2, 1, 3, 2};
    const tribo_pose pose = {.position = {1.0, 1.0, 1.0}, .orientation = {1.0}};
    mesh_block *mesh = build_mesh(5, vertices, 5, triangles);
    const tribo_shape shape = {.type = TRIBO_SHAPE_MESH, .data = mesh};
    double low[3];
    double high[3];
    size_t needed = 9;
    assert_int_equal(mesh->face_count, 2);
    assert_int_equal(mesh_faces(mesh)[0].index, 1);
    assert_int_equal(mesh_faces(mesh)[1].index, 4);
    assert_int_equal(tribo_shape_check(&shape), TRIBO_OK);
    assert_int_equal(tribo_shape_bounds(&shape, &pose, low, high), TRIBO_OK);
    assert_true(low[0] == 1.0 && high[0] == 3.0 && high[1] == 2.0 && high[2] == 1.0);
    free(mesh);
    assert_int_equal(tribo_mesh_build(5, vertices, 1, triangles, NULL, 0, &needed),
                     TRIBO_ERROR_DEGENERATE);
    assert_int_equal(needed, 9);
}

static void test_mesh_statuses(void **state)
{
    (void)state;
    double vertices[9] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    uint32_t triangles[3] = {0, 1, 2};
    unsigned char small[8];
    memset(small, 0xa5, sizeof small);
    assert_int_equal(tribo_mesh_build(3, NULL, 1, triangles, small, 8, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_mesh_build(3, vertices, 1, NULL, small, 8, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_mesh_build(3, vertices, 1, triangles, NULL, 8, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_mesh_build(3, vertices, 0, triangles, small, 8, NULL),
                     TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_mesh_build(2, vertices, 1, triangles, small, 8, NULL),
                     TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_mesh_build(3, vertices, 1, triangles, small, 8, NULL),
                     TRIBO_ERROR_CAPACITY);
    triangles[1] = 3;
    assert_int_equal(tribo_mesh_build(3, vertices, 1, triangles, small, 8, NULL),
                     TRIBO_ERROR_INDEX);
    triangles[1] = 1;
    vertices[4] = NOT_A_NUMBER;
    assert_int_equal(tribo_mesh_build(3, vertices, 1, triangles, small, 8, NULL),
                     TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(small[0], 0xa5);
    assert_int_equal(small[7], 0xa5);
}

/* Changes of a word, with the sum put right. */
static void assert_refused(mesh_block *mesh, size_t size, uint32_t *word, uint32_t value)
{
    const uint32_t before = *word;
    const uint64_t sum = mesh->sum;
    *word = value;
    mesh->sum = mesh_sum(mesh);
    assert_int_equal(tribo_mesh_check(mesh, size), TRIBO_ERROR_DATA);
    *word = before;
    mesh->sum = sum;
}

static void test_broken_mesh_blocks(void **state)
{
    (void)state;
    const double low[3] = {-9.0, -9.0, -9.0};
    const double high[3] = {9.0, 9.0, 9.0};
    problem_random random;
    problem_random_start(&random, STREAM_MESH, SEED + 2, 0);
    mesh_block *mesh = terrain(4, 0.2, &random);
    const size_t size = (size_t)mesh->bytes;
    unsigned char *bytes = (unsigned char *)mesh;
    const tribo_shape shape = {.type = TRIBO_SHAPE_MESH, .data = mesh};
    assert_int_equal(tribo_mesh_check(NULL, size), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_mesh_check(mesh, size - 1), TRIBO_ERROR_DATA);
    assert_int_equal(tribo_mesh_check(bytes + 4, size - 8), TRIBO_ERROR_DATA);
    for (size_t i = 0; i < size; i++) {
        const unsigned char before = bytes[i];
        const uint64_t sum = mesh->sum;
        damage(&random, bytes + i);
        assert_int_equal(tribo_mesh_check(mesh, size), TRIBO_ERROR_DATA);
        if (i < offsetof(mesh_block, sum)) {
            assert_int_equal(tribo_shape_check(&shape), TRIBO_ERROR_DATA);
            bytes[i] = before;
            continue;
        }
        mesh->sum = mesh_sum(mesh);
        if (tribo_mesh_check(mesh, size) == TRIBO_OK) {
            mesh_cursor cursor;
            mesh_triangle triangle;
            mesh_begin(mesh, low, high, &cursor);
            for (uint32_t k = 0; mesh_next(&cursor, &triangle); k++) {
                assert_true(k <= mesh->face_count);
            }
        }
        bytes[i] = before;
        mesh->sum = sum;
    }
    mesh_node *nodes = (mesh_node *)(void *)(bytes + mesh->nodes);
    uint32_t *order = (uint32_t *)(void *)(bytes + mesh->order);
    mesh_face *faces = (mesh_face *)(void *)(bytes + mesh->faces);
    for (uint32_t i = 0; i < mesh->node_count; i++) {
        assert_refused(mesh, size, &nodes[i].skip, i); /* a walk without end */
        assert_refused(mesh, size, &nodes[i].greatest, nodes[i].greatest + 1);
    }
    for (uint32_t i = 1; i < mesh->face_count; i++) {
        assert_refused(mesh, size, &order[i], order[i - 1]); /* one slot twice, one never */
        assert_refused(mesh, size, &faces[i].index, faces[i - 1].index);
        assert_refused(mesh, size, &faces[i].vertices[1], faces[i].vertices[0]);
    }
    assert_int_equal(tribo_mesh_check(mesh, size), TRIBO_OK);
    free(mesh);
}

/* Where all lie in one plane far from the origin, and near to each other. */
static void test_meshes_of_extreme_places(void **state)
{
    (void)state;
    const double far[4] = {0x1p1020, 1e300, 1e-300, 0x1p-1000};
    const uint32_t triangles[6] = {0, 1, 2, 2, 1, 3};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            const double side = far[k];
            const double vertices[12] = {far[i], 0.0, 0.0,  far[i], side, 0.0,
                                         far[i], 0.0, side, far[i], side, side};
            uint64_t block[128];
            assert_int_equal(tribo_mesh_build(4, vertices, 2, triangles, block, sizeof block, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_mesh_check(block, sizeof block), TRIBO_OK);
        }
    }
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_supports_are_farthest_and_on_the_surface),
        TEST(test_supports_at_special_directions),
        TEST(test_supports_of_scaled_directions_are_the_same_bits),
        TEST(test_shapes_of_all_sizes_scale_to_the_bit),
        TEST(test_support_statuses),
        TEST(test_faces_of_a_box),
        TEST(test_faces_of_round_shapes),
        TEST(test_faces_lie_on_their_shapes),
        TEST(test_face_statuses),
        TEST(test_faces_told_by_the_user),
        TEST(test_inner_and_outer_balls),
        TEST(test_check_of_sizes),
        TEST(test_check_of_halfspaces_and_users),
        TEST(test_check_of_compounds),
        TEST(test_bounds_touch_the_supports),
        TEST(test_bounds_of_halfspaces),
        TEST(test_bounds_of_compounds),
        TEST(test_bounds_statuses),
        TEST(test_mass_of_closed_forms),
        TEST(test_mass_of_a_cone_by_quadrature),
        TEST(test_mass_of_hulls),
        TEST(test_mass_of_thin_hulls),
        TEST(test_mass_of_compounds),
        TEST(test_mass_statuses),
        TEST(test_hull_of_a_box),
        TEST(test_hull_supports_against_all_points),
        TEST(test_faces_of_hulls),
        TEST(test_large_faces_are_thinned),
        TEST(test_hulls_scale_to_the_bit),
        TEST(test_hulls_of_flat_points),
        TEST(test_how_thin_a_hull_may_be),
        TEST(test_hull_statuses),
        TEST(test_hulls_of_extreme_sizes),
        TEST(test_blocks_mean_the_same_elsewhere),
        TEST(test_block_statuses),
        TEST(test_broken_hull_blocks),
        TEST(test_hulls_of_bad_points),
        TEST(test_hulls_print_nothing),
        TEST(test_hull_of_a_million_points),
        TEST(test_mesh_queries_against_all_triangles),
        TEST(test_inner_edges),
        TEST(test_mesh_leaves_degenerate_triangles_out),
        TEST(test_mesh_statuses),
        TEST(test_broken_mesh_blocks),
        TEST(test_meshes_of_extreme_places),
    };
    return cmocka_run_group_tests_name("shape", tests, NULL, NULL);
}
