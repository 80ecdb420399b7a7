/* Properties of include/tribo/shape.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hull.h"
#include "mesh.h"
#include "support/reference.h"
#include "support/shapes.h"

enum { FACE = 3 * TRIBO_MAX_FACE };

static long double wide(double x)
{
    return (long double)x;
}

static void widen(const double x[3], long double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = wide(x[i]);
    }
}

static int all_numbers(const double *x, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(x[i])) {
            return 0;
        }
    }
    return 1;
}

/* Not zero, with components of any relation and length. */
static void make_direction(property_trial *t, double d[3])
{
    make_normal(t, NULL, d);
    const double length = make_byte(t) < 128 ? 1.0 : ldexp(1.0, make_exponent(t, -1000, 1000));
    for (int i = 0; i < 3; i++) {
        d[i] *= length;
        if (make_byte(t) % 16 == 1) {
            d[i] = 0.0;
        }
    }
    if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0) {
        d[2] = length;
    }
    property_note(t, "direction", d, 3);
}

/* Unit vector in long double. */
static void unit_of(const double d[3], long double out[3])
{
    const int exponent = ilogb(fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))));
    long double square = 0.0L;
    for (int i = 0; i < 3; i++) {
        out[i] = ldexpl(wide(d[i]), -exponent);
        square += out[i] * out[i];
    }
    for (int i = 0; i < 3; i++) {
        out[i] /= sqrtl(square);
    }
}

static long double along(const long double d[3], const double p[3])
{
    return d[0] * wide(p[0]) + d[1] * wide(p[1]) + d[2] * wide(p[2]);
}

/* ---- support points ----------------------------------------------------------------------- */

static void support_farthest(property_trial *t)
{
    static made_shape s;
    double d[3];
    double p[3];
    long double unit[3];
    long double x[3];
    make_shape(t, "shape", SHAPES_CONVEX, &s);
    make_direction(t, d);
    unit_of(d, unit);
    REQUIRE_STATUS(t, tribo_shape_support(&s.shape, d, p), TRIBO_OK);
    widen(p, x);
    REQUIRE_NEAR(t, along(unit, p), shapes_extent(&s.shape, unit), 8.0 * EPS * s.size);
    const double rounding = s.shape.type == TRIBO_SHAPE_HULL ? 1e-9 : 8.0 * EPS;
    REQUIRE_AT_MOST(t, shapes_outside(&s.shape, x), rounding * s.size);
}

/* Lengths of directions do not matter, nor does the sign of zeros; lengths of shapes scale. */
static void support_scales(property_trial *t)
{
    static made_shape s;
    static made_shape scaled;
    double d[3];
    double p[3];
    double q[3];
    make_shape(t, "shape", SHAPES_CONVEX, &s);
    const int exponent = make_exponent(t, -100, 100);
    const int length = make_exponent(t, -100, 100);
    make_normal(t, "direction", d);
    REQUIRE_STATUS(t, tribo_shape_support(&s.shape, d, p), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        ASSUME(t, d[i] == 0.0 || fabs(d[i]) > 1e-200);
        d[i] = d[i] == 0.0 ? -d[i] : ldexp(d[i], length);
    }
    REQUIRE(t, shapes_scale(&s, exponent, &scaled));
    REQUIRE_STATUS(t, tribo_shape_support(&scaled.shape, d, q), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        p[i] = ldexp(p[i], exponent);
    }
    REQUIRE_SAME(t, p, q, sizeof p);
}

static void support_bad(property_trial *t)
{
    static made_shape s;
    double d[3];
    double p[3];
    double n[3];
    double points[FACE];
    uint32_t count = 77;
    make_shape(t, "shape", SHAPES_ALL, &s);
    make_direction(t, d);
    canary_set(p, sizeof p);
    canary_set(n, sizeof n);
    REQUIRE_STATUS(t, tribo_shape_support(NULL, d, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_shape_support(&s.shape, NULL, p), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_shape_support(&s.shape, d, NULL), TRIBO_ERROR_NULL);
    if (s.shape.type > TRIBO_SHAPE_CONVEX) {
        REQUIRE_STATUS(t, tribo_shape_support(&s.shape, d, p), TRIBO_ERROR_SHAPE);
        REQUIRE_STATUS(t, tribo_shape_face(&s.shape, d, 32, points, &count, n), TRIBO_ERROR_SHAPE);
    } else {
        const double zero[3] = {0.0, -0.0, 0.0};
        REQUIRE_STATUS(t, tribo_shape_support(&s.shape, zero, p), TRIBO_ERROR_RANGE);
        REQUIRE_STATUS(t, tribo_shape_face(&s.shape, zero, 32, points, &count, n),
                       TRIBO_ERROR_RANGE);
        REQUIRE_STATUS(t, tribo_shape_face(&s.shape, d, 0, points, &count, n),
                       TRIBO_ERROR_CAPACITY);
    }
    d[make_choice(t, "entry", 3)] = make_hostile(t, "value");
    REQUIRE_STATUS(t, tribo_shape_support(&s.shape, d, p), TRIBO_ERROR_NOT_FINITE);
    REQUIRE_STATUS(t, tribo_shape_face(&s.shape, d, 32, points, &count, n), TRIBO_ERROR_NOT_FINITE);
    REQUIRE(t, canary_kept(p, sizeof p) && canary_kept(n, sizeof n) && count == 77);
}

/* ---- faces -------------------------------------------------------------------------------- */

/* Twice the area of a polygon, as seen against a unit vector. */
static long double area_along(const double *points, uint32_t count, const double n[3])
{
    long double sum = 0.0L;
    for (uint32_t k = 1; k + 1 < count; k++) {
        long double a[3];
        long double b[3];
        for (int i = 0; i < 3; i++) {
            a[i] = wide(points[3 * k + (uint32_t)i]) - wide(points[i]);
            b[i] = wide(points[3 * k + 3 + (uint32_t)i]) - wide(points[i]);
        }
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3;
            const int m = (i + 2) % 3;
            sum += wide(n[i]) * (a[j] * b[m] - a[m] * b[j]);
        }
    }
    return sum;
}

static void face_of_shape(property_trial *t)
{
    static made_shape s;
    double d[3];
    double n[3];
    double points[FACE];
    double other[FACE];
    long double unit[3];
    long double normal[3];
    uint32_t count = 0;
    make_shape(t, "shape", SHAPES_CONVEX, &s);
    make_direction(t, d);
    unit_of(d, unit);
    REQUIRE_STATUS(t, tribo_shape_face(&s.shape, d, TRIBO_MAX_FACE, points, &count, n), TRIBO_OK);
    widen(n, normal);
    const double flat = s.shape.type == TRIBO_SHAPE_HULL ? 1e-8 : 1e-12;
    long double reach = -(long double)INFINITY;
    REQUIRE(t, count >= 1 && count <= TRIBO_MAX_FACE);
    REQUIRE_NEAR(t, along(normal, n), 1.0, 8.0 * EPS);
    for (uint32_t k = 0; k < count; k++) {
        long double x[3];
        widen(points + 3 * k, x);
        REQUIRE_AT_MOST(t, shapes_outside(&s.shape, x), flat * s.size);
        reach = fmaxl(reach, along(unit, points + 3 * k));
        if (count > 2 && s.shape.type != TRIBO_SHAPE_CONVEX) {
            REQUIRE_NEAR(t, along(normal, points + 3 * k), shapes_extent(&s.shape, normal),
                         flat * s.size);
        }
    }
    if (s.shape.type == TRIBO_SHAPE_BOX || s.shape.type == TRIBO_SHAPE_HULL) {
        REQUIRE_NEAR(t, reach, shapes_extent(&s.shape, unit), 8.0 * EPS * s.size);
    }
    if (count > 2) {
        REQUIRE(t, area_along(points, count, n) > 0.0L);
    }
    canary_set(other, sizeof other);
    REQUIRE_STATUS(t, tribo_shape_face(&s.shape, d, count - 1, other, &count, n),
                   TRIBO_ERROR_CAPACITY);
    REQUIRE(t, canary_kept(other, sizeof other));
}

/* ---- bounds ------------------------------------------------------------------------------- */

static long double mesh_reach(const made_shape *s, const long double row[3], long double sign)
{
    long double most = -(long double)INFINITY;
    const mesh_block *mesh = s->shape.data;
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t v = mesh_faces(mesh)[f].vertices[k];
            most = fmaxl(most, sign * along(row, s->points + 3 * (size_t)v));
        }
    }
    return sign * most;
}

static void bounds(property_trial *t)
{
    static made_shape s;
    tribo_pose pose;
    long double r[9];
    double low[3];
    double high[3];
    make_shape(t, "shape", SHAPES_ALL & ~SHAPES_KIND(TRIBO_SHAPE_HALFSPACE), &s);
    make_pose(t, "pose", -10, 20, &pose);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &pose, low, high), TRIBO_OK);
    shapes_rotation(&pose, r);
    for (int i = 0; i < 3; i++) {
        const long double *row = r + 3 * i;
        const long double back[3] = {-row[0], -row[1], -row[2]};
        const int is_mesh = s.shape.type == TRIBO_SHAPE_MESH;
        const long double least =
            is_mesh ? mesh_reach(&s, row, -1.0L) : -shapes_extent(&s.shape, back);
        const long double most = is_mesh ? mesh_reach(&s, row, 1.0L) : shapes_extent(&s.shape, row);
        const double tolerance = 16.0 * EPS * (s.size + fabs(pose.position[i]));
        REQUIRE_NEAR(t, low[i], wide(pose.position[i]) + least, tolerance);
        REQUIRE_NEAR(t, high[i], wide(pose.position[i]) + most, tolerance);
    }
}

/* Bounded only where the world's axis is the normal. */
static void bounds_halfspace(property_trial *t)
{
    static made_shape s;
    tribo_pose pose;
    double low[3];
    double high[3];
    make_shape(t, "halfspace", SHAPES_KIND(TRIBO_SHAPE_HALFSPACE), &s);
    make_pose(t, "pose", -10, 20, &pose);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &pose, low, high), TRIBO_OK);
    int ends = 0;
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, low[i] <= high[i]);
        ends += isfinite(low[i]) + isfinite(high[i]);
    }
    REQUIRE(t, ends <= 1);
}

/* ---- mass --------------------------------------------------------------------------------- */

typedef struct mass_of {
    double mass;
    double center[3];
    double inertia[9];
} mass_of;

static tribo_status weigh(const tribo_shape *shape, double density, mass_of *out)
{
    return tribo_shape_mass(shape, density, &out->mass, out->center, out->inertia);
}

#define SHAPES_SOLID \
    (SHAPES_ROUND | SHAPES_KIND(TRIBO_SHAPE_HULL) | SHAPES_KIND(TRIBO_SHAPE_COMPOUND))

/* Inertia of some body of that mass and size; the centre within the shape's bounds. */
static void mass_possible(property_trial *t)
{
    static made_shape s;
    static const tribo_pose origin = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    mass_of m;
    double low[3];
    double high[3];
    double sym[6];
    double values[3];
    make_shape(t, "shape", SHAPES_SOLID, &s);
    const double density = make_positive(t, "density", -10, 10);
    REQUIRE_STATUS(t, weigh(&s.shape, density, &m), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &origin, low, high), TRIBO_OK);
    double volume = density * (double)(1 + s.shape.count);
    for (int i = 0, k = 0; i < 3; i++) {
        volume *= high[i] - low[i];
        REQUIRE(t, m.center[i] >= low[i] - 8.0 * EPS * s.size &&
                       m.center[i] <= high[i] + 8.0 * EPS * s.size);
        for (int j = i; j < 3; j++, k++) {
            REQUIRE(t, m.inertia[3 * i + j] == m.inertia[3 * j + i]);
            sym[k] = m.inertia[3 * i + j];
        }
    }
    reference_eigenvalues(sym, values);
    const double most = 4.0 * m.mass * s.size * s.size;
    REQUIRE(t, m.mass > 0.0);
    REQUIRE_AT_MOST(t, m.mass, volume * (1.0 + 64.0 * EPS));
    REQUIRE_AT_MOST(t, values[2], most);
    REQUIRE_AT_MOST(t, -values[0], 64.0 * EPS * values[2]);
    REQUIRE_AT_MOST(t, values[2], values[0] + values[1] + 64.0 * EPS * values[2]);
}

/* Lengths times 2^k: mass times 2^3k, inertia times 2^5k, to the bit. */
static void mass_scales(property_trial *t)
{
    static made_shape s;
    static made_shape scaled;
    mass_of m;
    mass_of n;
    make_shape(t, "shape", SHAPES_SOLID, &s);
    const int k = make_exponent(t, -100, 100);
    const double density = make_positive(t, "density", -10, 10);
    REQUIRE_STATUS(t, weigh(&s.shape, density, &m), TRIBO_OK);
    REQUIRE(t, shapes_scale(&s, k, &scaled));
    REQUIRE_STATUS(t, weigh(&scaled.shape, density, &n), TRIBO_OK);
    REQUIRE(t, ldexp(m.mass, 3 * k) == n.mass);
    for (int i = 0; i < 9; i++) {
        REQUIRE(t, i >= 3 || ldexp(m.center[i], k) == n.center[i]);
        REQUIRE(t, ldexp(m.inertia[i], 5 * k) == n.inertia[i]);
    }
}

/* A compound of one child is that child, turned and moved; of the same child twice, twice it. */
static void mass_of_child(property_trial *t)
{
    static made_shape s;
    tribo_child children[2];
    mass_of own;
    mass_of one;
    mass_of two;
    long double r[9];
    make_shape(t, "child", SHAPES_ROUND | SHAPES_KIND(TRIBO_SHAPE_HULL), &s);
    children[0].shape = s.shape;
    make_pose(t, "pose", -6, 6, &children[0].pose);
    children[1] = children[0];
    tribo_shape compound = {TRIBO_SHAPE_COMPOUND, 1, {0.0}, children};
    REQUIRE_STATUS(t, weigh(&s.shape, 1.0, &own), TRIBO_OK);
    REQUIRE_STATUS(t, weigh(&compound, 1.0, &one), TRIBO_OK);
    compound.count = 2;
    REQUIRE_STATUS(t, weigh(&compound, 1.0, &two), TRIBO_OK);
    shapes_rotation(&children[0].pose, r);
    const double far = s.size + norm3(children[0].pose.position);
    const double trace = own.inertia[0] + own.inertia[4] + own.inertia[8];
    REQUIRE(t, one.mass == own.mass && two.mass == 2.0 * own.mass);
    for (int i = 0; i < 3; i++) {
        const long double center =
            along(r + 3 * i, own.center) + wide(children[0].pose.position[i]);
        REQUIRE_NEAR(t, one.center[i], center, 16.0 * EPS * far);
        REQUIRE_NEAR(t, two.center[i], center, 16.0 * EPS * far);
        for (int j = 0; j < 3; j++) {
            long double want = 0.0L;
            for (int k = 0; k < 3; k++) {
                want += r[3 * i + k] * along(r + 3 * j, own.inertia + 3 * k);
            }
            REQUIRE_NEAR(t, one.inertia[3 * i + j], want, 64.0 * EPS * trace);
            REQUIRE_NEAR(t, two.inertia[3 * i + j], 2.0L * want, 128.0 * EPS * trace);
        }
    }
}

/* ---- judging ------------------------------------------------------------------------------ */

/* Any numbers as sizes: the check says what is wrong with them, and so do mass and bounds. */
static void check_sizes(property_trial *t)
{
    static const int used[] = {0, 1, 3, 2, 2, 2, 3};
    static const tribo_pose origin = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    tribo_shape s = {.type = 1 + make_choice(t, "kind", 6)};
    mass_of m;
    double low[3];
    double high[3];
    tribo_status want = TRIBO_OK;
    for (int i = 0; i < 4; i++) {
        s.size[i] = make_byte(t) % 2 == 0 ? 1.0 + make_unit(t, NULL) : make_any(t, NULL);
    }
    property_note(t, "size", s.size, 4);
    for (int i = 0; i < used[s.type]; i++) {
        want = want == TRIBO_OK && !(s.size[i] > 0.0) ? TRIBO_ERROR_SHAPE : want;
    }
    want = all_numbers(s.size, (size_t)used[s.type]) ? want : TRIBO_ERROR_NOT_FINITE;
    canary_set(&m, sizeof m);
    canary_set(low, sizeof low);
    canary_set(high, sizeof high);
    REQUIRE_STATUS(t, tribo_shape_check(&s), want);
    const tribo_status bounded = tribo_shape_bounds(&s, &origin, low, high);
    const tribo_status weighed = weigh(&s, 1.0, &m);
    if (want != TRIBO_OK) {
        REQUIRE_STATUS(t, bounded, want);
        REQUIRE_STATUS(t, weighed, want);
        REQUIRE(t, canary_kept(low, sizeof low) && canary_kept(high, sizeof high));
    } else {
        REQUIRE_STATUS(t, bounded, TRIBO_OK);
        REQUIRE(t, weighed == TRIBO_OK || weighed == TRIBO_ERROR_RANGE);
    }
    if (weighed == TRIBO_OK) {
        REQUIRE(t, all_numbers((const double *)&m, sizeof m / sizeof(double)) && m.mass > 0.0);
    } else {
        REQUIRE(t, canary_kept(&m, sizeof m));
    }
}

/* One thing wrong with a valid shape. */
static void check_bad(property_trial *t)
{
    static made_shape s;
    tribo_pose pose;
    mass_of m;
    double low[3];
    double high[3];
    make_shape(t, "shape", SHAPES_ALL, &s);
    make_pose(t, "pose", -10, 10, &pose);
    canary_set(&m, sizeof m);
    canary_set(low, sizeof low);
    canary_set(high, sizeof high);
    REQUIRE_STATUS(t, tribo_shape_check(&s.shape), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_shape_check(NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, NULL, low, high), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, weigh(&s.shape, make_byte(t) % 2 == 0 ? 0.0 : -1.0, &m), TRIBO_ERROR_SHAPE);
    REQUIRE_STATUS(t, weigh(&s.shape, (double)NAN, &m), TRIBO_ERROR_NOT_FINITE);
    const int has_no_mass = s.shape.type == TRIBO_SHAPE_CONVEX ||
                            s.shape.type == TRIBO_SHAPE_HALFSPACE ||
                            s.shape.type == TRIBO_SHAPE_MESH;
    if (has_no_mass) {
        REQUIRE_STATUS(t, weigh(&s.shape, 1.0, &m), TRIBO_ERROR_SHAPE);
    }
    tribo_pose bad = pose;
    bad.orientation[make_choice(t, NULL, 4)] = 1.5;
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &bad, low, high), TRIBO_ERROR_ORIENTATION);
    bad = pose;
    ((double *)&bad)[make_choice(t, NULL, 7)] = make_hostile(t, NULL);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &bad, low, high), TRIBO_ERROR_NOT_FINITE);
    if (s.shape.type >= TRIBO_SHAPE_HULL && s.shape.type != TRIBO_SHAPE_HALFSPACE) {
        s.shape.data = NULL;
        REQUIRE_STATUS(t, tribo_shape_check(&s.shape), TRIBO_ERROR_NULL);
    }
    s.shape.type = make_choice(t, NULL, 2) == 0 ? 0 : 12 + make_byte(t);
    REQUIRE_STATUS(t, tribo_shape_check(&s.shape), TRIBO_ERROR_OPTION);
    REQUIRE_STATUS(t, tribo_shape_bounds(&s.shape, &pose, low, high), TRIBO_ERROR_OPTION);
    REQUIRE_STATUS(t, weigh(&s.shape, 1.0, &m), TRIBO_ERROR_OPTION);
    REQUIRE(t, canary_kept(&m, sizeof m));
    REQUIRE(t, canary_kept(low, sizeof low) && canary_kept(high, sizeof high));
}

/* ---- hulls -------------------------------------------------------------------------------- */

static uint64_t block[SHAPES_WORDS];
static uint64_t second[SHAPES_WORDS];

static double span_of(size_t count, const double *points)
{
    double span = 0.0;
    for (size_t i = 3; i < 3 * count; i++) {
        span = fmax(span, fabs(points[i] - points[i % 3]));
    }
    return span;
}

static int is_one_of(const double v[3], size_t count, const double *points)
{
    for (size_t i = 0; i < count; i++) {
        if (v[0] == points[3 * i] && v[1] == points[3 * i + 1] && v[2] == points[3 * i + 2]) {
            return 1;
        }
    }
    return 0;
}

/* The edges of all faces run once each way. */
static int is_closed(const hull_block *hull)
{
    const uint32_t *starts = hull_table(hull, hull->face_starts);
    const uint32_t *loops = hull_table(hull, hull->loops);
    static uint8_t sides[SHAPES_POINTS][SHAPES_POINTS];
    memset(sides, 0, sizeof sides);
    for (uint32_t f = 0; f < hull->face_count; f++) {
        for (uint32_t k = starts[f]; k < starts[f + 1]; k++) {
            const uint32_t next = k + 1 < starts[f + 1] ? k + 1 : starts[f];
            sides[loops[k]][loops[next]]++;
        }
    }
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        for (uint32_t k = 0; k < hull->vertex_count; k++) {
            if (sides[i][k] > 1 || sides[i][k] != sides[k][i]) {
                return 0;
            }
        }
    }
    return 1;
}

static void judge_hull(property_trial *t, const hull_block *hull, size_t bytes, size_t count,
                       const double *points)
{
    const double span = span_of(count, points);
    const double *planes = hull_planes(hull);
    uint32_t vertices = 0;
    uint32_t faces = 0;
    REQUIRE_STATUS(t, tribo_hull_check(hull, bytes), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_hull_counts(hull, &vertices, &faces), TRIBO_OK);
    REQUIRE(t, vertices >= 4 && vertices <= count && faces >= 4);
    REQUIRE(t, is_closed(hull));
    for (uint32_t v = 0; v < vertices; v++) {
        REQUIRE(t, is_one_of(hull_vertices(hull) + 3 * (size_t)v, count, points));
    }
    for (uint32_t f = 0; f < faces; f++) {
        long double n[3];
        widen(planes + 4 * (size_t)f, n);
        for (size_t i = 0; i < count; i++) {
            REQUIRE_AT_MOST(t, along(n, points + 3 * i), planes[4 * (size_t)f + 3] + 1e-8 * span);
        }
    }
}

/* A hull, or a status, of points that may span no volume. */
static void hull_any(property_trial *t)
{
    double points[3 * SHAPES_POINTS];
    size_t count;
    size_t needed = 0;
    make_points(t, "points", &count, points);
    canary_set(block, sizeof block);
    const tribo_status status = tribo_hull_build(count, points, NULL, 0, &needed);
    if (status != TRIBO_ERROR_CAPACITY) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_DEGENERATE);
        REQUIRE_STATUS(t, tribo_hull_build(count, points, block, sizeof block, &needed), status);
        REQUIRE(t, needed == 0 && canary_kept(block, sizeof block));
        return;
    }
    REQUIRE(t, needed <= sizeof block && needed % 8 == 0);
    REQUIRE_STATUS(t, tribo_hull_build(count, points, block, needed - 1, NULL),
                   TRIBO_ERROR_CAPACITY);
    REQUIRE(t, canary_kept(block, sizeof block));
    REQUIRE_STATUS(t, tribo_hull_build(count, points, block, needed, NULL), TRIBO_OK);
    canary_set(second, sizeof second);
    REQUIRE_SAME(t, block + needed / 8, second + needed / 8, sizeof block - needed);
    judge_hull(t, (const hull_block *)block, needed, count, points);
}

/* Points of a plane or line that are so to the bit: there is no hull. */
static void hull_flat(property_trial *t)
{
    double points[3 * SHAPES_POINTS];
    size_t count;
    make_points(t, NULL, &count, points);
    const uint32_t axis = make_choice(t, "axis", 3);
    const uint32_t dimension = make_choice(t, "dimension", 3);
    const double shift = make_real(t, "shift", -10, 10);
    for (size_t i = 0; i < count; i++) {
        double *p = points + 3 * i;
        p[axis] = shift;
        if (dimension > 0) {
            p[(axis + 1) % 3] = -shift;
        }
        if (dimension > 1) {
            p[(axis + 2) % 3] = 1.0;
        }
    }
    property_note(t, "points", points, 3 * count);
    REQUIRE_STATUS(t, tribo_hull_build(count, points, block, sizeof block, NULL),
                   TRIBO_ERROR_DEGENERATE);
}

/* The corners of a box among the points: there is a hull, whatever lies inside or twice. */
static void hull_solid(property_trial *t)
{
    double points[3 * SHAPES_POINTS];
    size_t count;
    size_t needed = 0;
    mass_of m;
    mass_of box;
    make_points(t, NULL, &count, points);
    count = count < 8 ? 8 : count;
    const double side = ldexp(1.0, make_exponent(t, -10, 10));
    const double aspect = ldexp(1.0, -(make_byte(t) % 20));
    const double half[3] = {side, 0.5 * side * aspect, 0.75 * side};
    const double largest = 2.0 * span_of(count, points) + fabs(points[0]) + fabs(points[1]) +
                           fabs(points[2]) + 0x1p-1000;
    for (size_t i = 0; i < 3 * count; i++) {
        const size_t corner = i / 3;
        const size_t axis = i % 3;
        points[i] = corner < 8 ? (corner >> axis) % 2 == 0 ? half[axis] : -half[axis]
                               : points[i] / largest * half[axis];
    }
    property_note(t, "points", points, 3 * count);
    REQUIRE_STATUS(t, tribo_hull_build(count, points, block, sizeof block, &needed), TRIBO_OK);
    judge_hull(t, (const hull_block *)block, needed, count, points);
    const tribo_shape shape = {TRIBO_SHAPE_HULL, 0, {0.0}, block};
    const tribo_shape twin = {TRIBO_SHAPE_BOX, 0, {half[0], half[1], half[2], 0.0}, NULL};
    REQUIRE_STATUS(t, weigh(&shape, 1.0, &m), TRIBO_OK);
    REQUIRE_STATUS(t, weigh(&twin, 1.0, &box), TRIBO_OK);
    REQUIRE_NEAR(t, m.mass, box.mass, 1e-13 * box.mass);
    for (int i = 0; i < 3; i++) {
        REQUIRE_NEAR(t, m.center[i], 0.0, 1e-13 * side);
        REQUIRE_NEAR(t, m.inertia[4 * i], box.inertia[4 * i], 1e-12 * box.inertia[4 * i]);
    }
}

/* Numbers of any size at all: a status or a hull that passes its check, and no report by Qhull. */
static void hull_wild(property_trial *t)
{
    double points[3 * SHAPES_POINTS];
    size_t needed = 0;
    const size_t count = make_choice(t, "count", SHAPES_POINTS);
    const uint32_t hostile = make_choice(t, NULL, 4);
    for (size_t i = 0; i < 3 * count; i++) {
        points[i] = hostile == 1 ? make_any(t, NULL) : make_finite(t, NULL);
    }
    property_note(t, "points", points, 3 * count);
    canary_set(block, sizeof block);
    const tribo_status status = tribo_hull_build(count, points, block, sizeof block, &needed);
    if (count < 4) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_RANGE);
    } else if (!all_numbers(points, 3 * count)) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_NOT_FINITE);
    } else {
        REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_DEGENERATE ||
                       status == TRIBO_ERROR_RANGE);
    }
    if (status == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_hull_check(block, needed), TRIBO_OK);
    } else {
        REQUIRE(t, canary_kept(block, sizeof block));
    }
    REQUIRE_STATUS(t, tribo_hull_build(count, NULL, block, sizeof block, &needed),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_hull_build(count, points, NULL, 8, &needed), TRIBO_ERROR_NULL);
}

/* ---- meshes ------------------------------------------------------------------------------- */

static void mesh_any(property_trial *t)
{
    static made_shape s;
    size_t needed = 0;
    make_shape(t, "mesh", SHAPES_KIND(TRIBO_SHAPE_MESH), &s);
    const mesh_block *mesh = s.shape.data;
    REQUIRE_STATUS(t, tribo_mesh_check(mesh, s.bytes), TRIBO_OK);
    REQUIRE(t, mesh->face_count >= 1 && mesh->face_count <= s.triangle_count);
    canary_set(block, sizeof block);
    REQUIRE_STATUS(t,
                   tribo_mesh_build(s.point_count, s.points, s.triangle_count, s.triangles, block,
                                    s.bytes - 1, &needed),
                   TRIBO_ERROR_CAPACITY);
    REQUIRE(t, needed == s.bytes && canary_kept(block, sizeof block));
    REQUIRE_STATUS(t,
                   tribo_mesh_build(s.point_count, s.points, s.triangle_count, s.triangles, block,
                                    s.bytes, NULL),
                   TRIBO_OK);
    REQUIRE_SAME(t, block, mesh, s.bytes);
    canary_set(second, sizeof second);
    REQUIRE_SAME(t, block + needed / 8, second + needed / 8, sizeof block - needed);
}

/* What the tree finds within a box, against all triangles. */
static void mesh_query(property_trial *t)
{
    static made_shape s;
    mesh_cursor cursor;
    mesh_triangle found;
    double a[3];
    double b[3];
    double low[3];
    double high[3];
    make_shape(t, "mesh", SHAPES_KIND(TRIBO_SHAPE_MESH), &s);
    make_directions(t, "from", a, 3);
    make_directions(t, "to", b, 3);
    for (int i = 0; i < 3; i++) {
        low[i] = s.size * fmin(a[i], b[i]);
        high[i] = s.size * fmax(a[i], b[i]);
    }
    const mesh_block *mesh = s.shape.data;
    mesh_begin(mesh, low, high, &cursor);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const mesh_face *face = &mesh_faces(mesh)[f];
        int touches = 1;
        for (int i = 0; i < 3; i++) {
            const double x = s.points[3 * face->vertices[0] + (uint32_t)i];
            const double y = s.points[3 * face->vertices[1] + (uint32_t)i];
            const double z = s.points[3 * face->vertices[2] + (uint32_t)i];
            touches = touches && fmin(x, fmin(y, z)) <= high[i] && fmax(x, fmax(y, z)) >= low[i];
        }
        if (touches) {
            REQUIRE(t, mesh_next(&cursor, &found) == 1);
            REQUIRE(t, found.index == face->index);
        }
    }
    REQUIRE(t, mesh_next(&cursor, &found) == 0);
}

static void mesh_wild(property_trial *t)
{
    double points[3 * SHAPES_POINTS];
    uint32_t triangles[3 * SHAPES_TRIANGLES];
    size_t needed = 0;
    const size_t count = make_choice(t, "points", SHAPES_POINTS);
    const size_t triangle_count = make_choice(t, "triangles", SHAPES_TRIANGLES);
    const uint32_t hostile = make_choice(t, NULL, 4);
    const uint32_t limit = (uint32_t)count + (hostile == 2);
    int in_range = 1;
    for (size_t i = 0; i < 3 * count; i++) {
        points[i] = hostile == 1 ? make_any(t, NULL) : make_finite(t, NULL);
    }
    for (size_t i = 0; i < 3 * triangle_count; i++) {
        triangles[i] = limit > 0 ? make_byte(t) % limit : 0;
        in_range = in_range && triangles[i] < count;
    }
    property_note(t, "vertices", points, 3 * count);
    canary_set(block, sizeof block);
    const tribo_status status =
        tribo_mesh_build(count, points, triangle_count, triangles, block, sizeof block, &needed);
    if (count < 3 || triangle_count < 1) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_RANGE);
    } else if (!in_range) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_INDEX);
    } else if (!all_numbers(points, 3 * count)) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_NOT_FINITE);
    } else {
        REQUIRE(t, status == TRIBO_OK || status == TRIBO_ERROR_DEGENERATE);
    }
    if (status == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_mesh_check(block, needed), TRIBO_OK);
    } else {
        REQUIRE(t, canary_kept(block, sizeof block));
    }
}

/* ---- blocks from elsewhere ---------------------------------------------------------------- */

/* Bytes, words or numbers change. */
static void damage(property_trial *t, unsigned char *bytes, size_t size, size_t first)
{
    const uint32_t changes = 1 + make_choice(t, "changes", 4);
    for (uint32_t i = 0; i < changes; i++) {
        const uint32_t kind = make_choice(t, NULL, 4);
        const size_t at = first + (size_t)make_bits(t, 2) % (size - first);
        const size_t word = at - at % 8;
        if (kind == 0) {
            bytes[at] = (unsigned char)(bytes[at] ^ 1u << make_byte(t) % 8u);
        } else if (kind == 1) {
            const uint32_t value = make_byte(t) % 2 == 0 ? make_byte(t) : 0u - make_byte(t);
            memcpy(bytes + at - at % 4, &value, sizeof value);
        } else if (kind == 2) {
            const double value = make_any(t, NULL);
            memcpy(bytes + word, &value, sizeof value);
        } else {
            memcpy(bytes + word, bytes + first + (size_t)make_bits(t, 2) % (size - first - 8), 8);
        }
    }
}

static tribo_status judge_block(const tribo_shape *shape, size_t size)
{
    return shape->type == TRIBO_SHAPE_MESH ? tribo_mesh_check(shape->data, size)
                                           : tribo_hull_check(shape->data, size);
}

/* Puts the sum right. 0 if the head is not one any more, or of a block of another size. */
static int mend_sum(const tribo_shape *shape, void *bytes, size_t size)
{
    mesh_block *mesh = bytes;
    hull_block *hull = bytes;
    if (tribo_shape_check(shape) != TRIBO_OK) {
        return 0;
    }
    if (shape->type == TRIBO_SHAPE_MESH && mesh->bytes == size) {
        mesh->sum = mesh_sum(mesh);
        return 1;
    }
    if (shape->type == TRIBO_SHAPE_HULL && hull->bytes == size) {
        hull->sum = hull_sum(hull);
        return 1;
    }
    return 0;
}

/* Every call that takes a shape; what they say does not matter, only that they come back. */
static void use_shape(property_trial *t, const tribo_shape *shape)
{
    static made_shape other;
    const tribo_pose pose = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    tribo_pose near;
    tribo_manifold manifolds[SHAPES_TRIANGLES];
    mass_of m;
    double d[3];
    double points[FACE];
    double low[3];
    double high[3];
    uint32_t count;
    make_shape(t, "other", SHAPES_SIMPLE, &other);
    make_pose(t, "near", -10, 2, &near);
    (void)tribo_shape_check(shape);
    (void)weigh(shape, 1.0, &m);
    for (int i = 0; i < 12; i++) {
        make_direction(t, d);
        (void)tribo_shape_support(shape, d, low);
        (void)tribo_shape_face(shape, d, TRIBO_MAX_FACE, points, &count, low);
    }
    (void)tribo_shape_bounds(shape, &pose, low, high);
    (void)tribo_collide_shapes(shape, &pose, &other.shape, &near, NULL, SHAPES_TRIANGLES, manifolds,
                               &count, NULL);
}

/* A block whose bytes have changed is refused; with its sum put right too, it is refused or every
 * call that is given it stays within it. On the heap, in exactly as many bytes, so that sanitizers
 * see a step out of it. */
static void block_damaged(property_trial *t)
{
    static made_shape s;
    make_shape(t, "shape", SHAPES_KIND(TRIBO_SHAPE_HULL) | SHAPES_KIND(TRIBO_SHAPE_MESH), &s);
    unsigned char *copy = malloc(s.bytes);
    ASSUME(t, copy != NULL);
    memcpy(copy, s.block, s.bytes);
    s.shape.data = copy;
    const size_t head =
        s.shape.type == TRIBO_SHAPE_MESH ? sizeof(mesh_block) : offsetof(hull_block, center);
    damage(t, copy, s.bytes, make_byte(t) % 8 == 1 ? 0 : head);
    const int changed = memcmp(copy, s.block, s.bytes) != 0;
    const tribo_status plain = judge_block(&s.shape, s.bytes);
    const tribo_status mended =
        mend_sum(&s.shape, copy, s.bytes) ? judge_block(&s.shape, s.bytes) : TRIBO_ERROR_DATA;
    if (mended == TRIBO_OK) {
        use_shape(t, &s.shape);
    }
    free(copy);
    REQUIRE_STATUS(t, plain, changed ? TRIBO_ERROR_DATA : TRIBO_OK);
    REQUIRE(t, mended == TRIBO_OK || mended == TRIBO_ERROR_DATA);
}

/* Any bytes, with or without a head that is one; and what is cut off. */
static void block_foreign(property_trial *t)
{
    static made_shape s;
    make_shape(t, "shape", SHAPES_KIND(TRIBO_SHAPE_HULL) | SHAPES_KIND(TRIBO_SHAPE_MESH), &s);
    const size_t size = (size_t)make_bits(t, 2) % s.bytes;
    const uint32_t kind = make_choice(t, "kind", 3);
    unsigned char *copy = malloc(size + 8);
    ASSUME(t, copy != NULL);
    memcpy(copy, s.block, size);
    if (kind == 1) {
        for (size_t i = 8; i < size; i++) {
            copy[i] = make_byte(t);
        }
    }
    const size_t shift = kind == 2 ? 1 + make_choice(t, "shift", 7) : 0;
    memmove(copy + shift, copy, size);
    const tribo_status hull = tribo_hull_check(copy + shift, size);
    const tribo_status mesh = tribo_mesh_check(copy + shift, size);
    free(copy);
    REQUIRE_STATUS(t, hull, TRIBO_ERROR_DATA);
    REQUIRE_STATUS(t, mesh, TRIBO_ERROR_DATA);
    REQUIRE_STATUS(t, tribo_hull_check(NULL, size), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_mesh_check(NULL, size), TRIBO_ERROR_NULL);
    const int is_mesh = s.shape.type == TRIBO_SHAPE_MESH;
    REQUIRE_STATUS(t, tribo_hull_check(s.block, s.bytes), is_mesh ? TRIBO_ERROR_DATA : TRIBO_OK);
    REQUIRE_STATUS(t, tribo_mesh_check(s.block, s.bytes), is_mesh ? TRIBO_OK : TRIBO_ERROR_DATA);
}

const char *const property_room = "shape";
const property property_list[] = {
    {"support_farthest", support_farthest, 2},
    {"support_scales", support_scales, 4},
    {"support_bad", support_bad, 2},
    {"face_of_shape", face_of_shape, 3},
    {"bounds", bounds, 2},
    {"bounds_halfspace", bounds_halfspace, 2},
    {"mass_possible", mass_possible, 2},
    {"mass_scales", mass_scales, 4},
    {"mass_of_child", mass_of_child, 3},
    {"check_sizes", check_sizes, 1},
    {"check_bad", check_bad, 2},
    {"hull_any", hull_any, 30},
    {"hull_flat", hull_flat, 2},
    {"hull_solid", hull_solid, 30},
    {"hull_wild", hull_wild, 10},
    {"mesh_any", mesh_any, 4},
    {"mesh_query", mesh_query, 4},
    {"mesh_wild", mesh_wild, 2},
    {"block_damaged", block_damaged, 10},
    {"block_foreign", block_foreign, 5},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 20000;
