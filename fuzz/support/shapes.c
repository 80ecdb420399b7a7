/* Shapes and poses from bytes; see shapes.h. */
#include "shapes.h"

#include <math.h>
#include <string.h>

#include "hull.h"
#include "reference.h"

/* ---- points -------------------------------------------------------------------------------- */

enum { IN_BOX, ON_SPHERE, LATTICE, FLAT, IN_LINE, FEW_PLACES, NEARLY_FLAT, POINT_KINDS };

static void make_point(property_trial *t, uint32_t kind, double thin, double p[3])
{
    make_directions(t, NULL, p, 3);
    if (kind == ON_SPHERE) {
        make_normal(t, NULL, p);
    }
    for (int i = 0; i < 3; i++) {
        if (kind == LATTICE || kind == FEW_PLACES) {
            p[i] = nearbyint(kind == LATTICE ? 2.0 * p[i] : p[i]);
        }
    }
    if (kind == IN_LINE) {
        p[1] = 0.5 * p[0]; /* exact, and so is all that is made of it by halving */
    }
    if (kind == FLAT || kind == IN_LINE) {
        p[2] = 0.25 * p[0];
    }
    if (kind == NEARLY_FLAT) {
        p[2] = 0.25 * p[0] + thin * p[2];
    }
}

void make_points(property_trial *t, const char *name, size_t *count, double *points)
{
    const uint32_t kind = make_choice(t, NULL, POINT_KINDS);
    const double scale = ldexp(1.0, make_exponent(t, -10, 10));
    const double thin = ldexp(1.0, -(make_byte(t) % 56));
    *count = 4 + make_choice(t, NULL, SHAPES_POINTS - 3);
    property_expand(t);
    for (size_t i = 0; i < *count; i++) {
        make_point(t, kind, thin, points + 3 * i);
        if (i > 0 && make_byte(t) % 16 == 1) {
            memcpy(points + 3 * i, points + 3 * (i - 1), 3 * sizeof *points);
        }
        for (size_t k = 3 * i; k < 3 * i + 3; k++) {
            points[k] *= scale;
        }
    }
    property_note(t, name, points, 3 * *count);
}

/* ---- shapes -------------------------------------------------------------------------------- */

static uint32_t choose_kind(property_trial *t, uint32_t kinds)
{
    uint32_t list[16];
    uint32_t count = 0;
    for (uint32_t type = 1; type < 16; type++) {
        if ((kinds & SHAPES_KIND(type)) != 0) {
            list[count++] = type;
        }
    }
    return list[make_choice(t, NULL, count)];
}

static double largest3(const double *x)
{
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

static void measure(const tribo_shape *shape, double *size, double *small)
{
    const double *s = shape->size;
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        *size = *small = s[0];
        break;
    case TRIBO_SHAPE_CAPSULE:
        *size = s[0] + s[1];
        *small = s[0];
        break;
    case TRIBO_SHAPE_CYLINDER:
    case TRIBO_SHAPE_CONE:
        *size = hypot(s[0], s[1]);
        *small = fmin(s[0], s[1]);
        break;
    case TRIBO_SHAPE_HALFSPACE:
        *size = *small = fabs(s[3]);
        break;
    default:
        *size = norm3(s);
        *small = fmin(s[0], fmin(s[1], s[2]));
        break;
    }
}

/* Entries that no shape of the kind looks at hold anything. */
static void make_round(property_trial *t, uint32_t type, tribo_shape *out)
{
    static const int used[] = {0, 1, 3, 2, 2, 2, 3};
    const int exponent = make_exponent(t, -10, 10);
    const int slender = make_byte(t) >= 224 ? 13 : 2;
    memset(out, 0, sizeof *out);
    out->type = type;
    for (int i = 0; i < 4; i++) {
        const double part = 1.0 + make_unit(t, NULL);
        const int below = make_byte(t) % (slender + 1);
        out->size[i] = i < used[type] ? ldexp(part, exponent - below) : (double)(below - 1);
    }
}

static void make_halfspace(property_trial *t, tribo_shape *out)
{
    memset(out, 0, sizeof *out);
    out->type = TRIBO_SHAPE_HALFSPACE;
    make_normal(t, NULL, out->size);
    out->size[3] = make_real(t, NULL, -10, 10);
}

static void measure_points(made_shape *out)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    out->size = 0.0;
    for (size_t i = 0; i < 3 * out->point_count; i++) {
        low[i % 3] = fmin(low[i % 3], out->points[i]);
        high[i % 3] = fmax(high[i % 3], out->points[i]);
        out->size = fmax(out->size, 1.7320508075688774 * fabs(out->points[i]));
    }
    out->small = 0.5 * fmin(high[0] - low[0], fmin(high[1] - low[1], high[2] - low[2]));
}

static int build_block(made_shape *out)
{
    const tribo_status status =
        out->shape.type == TRIBO_SHAPE_MESH
            ? tribo_mesh_build(out->point_count, out->points, out->triangle_count, out->triangles,
                               out->block, sizeof out->block, &out->bytes)
            : tribo_hull_build(out->point_count, out->points, out->block, sizeof out->block,
                               &out->bytes);
    return status == TRIBO_OK;
}

/* Where the points span no volume, the corners of a box take their place. */
static void make_hull(property_trial *t, made_shape *out)
{
    out->shape.type = TRIBO_SHAPE_HULL;
    make_points(t, NULL, &out->point_count, out->points);
    if (!build_block(out)) {
        const double side = largest3(out->points) > 0.0 ? largest3(out->points) : 1.0;
        out->point_count = 8;
        for (int i = 0; i < 24; i++) {
            out->points[i] = (i / 3 >> i % 3) % 2 == 0 ? side : -side;
        }
        build_block(out);
    }
    measure_points(out);
}

static void make_mesh(property_trial *t, made_shape *out)
{
    out->shape.type = TRIBO_SHAPE_MESH;
    make_points(t, NULL, &out->point_count, out->points);
    out->triangle_count = 1 + make_choice(t, NULL, SHAPES_TRIANGLES);
    for (size_t i = 0; i < 3 * out->triangle_count; i++) {
        const uint32_t next = make_byte(t) % 4 == 1 ? make_byte(t) : (uint32_t)(i / 3 + i % 3);
        out->triangles[i] = next % (uint32_t)out->point_count;
    }
    if (!build_block(out)) {
        static const double plain[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0};
        static const uint32_t order[3] = {0, 1, 2};
        out->point_count = 3;
        out->triangle_count = 1;
        memcpy(out->points, plain, sizeof plain);
        memcpy(out->triangles, order, sizeof order);
        build_block(out);
    }
    measure_points(out);
}

void shapes_support(const void *user, const double direction[3], double point[3])
{
    if (tribo_shape_support(user, direction, point) != TRIBO_OK) {
        point[0] = point[1] = point[2] = (double)NAN;
    }
}

uint32_t shapes_face(const void *user, const double direction[3], uint32_t capacity, double *points)
{
    uint32_t count = 0;
    double normal[3];
    return tribo_shape_face(user, direction, capacity, points, &count, normal) == TRIBO_OK ? count
                                                                                           : 0;
}

static void set_user(made_shape *out, int has_face)
{
    const double center[3] = {0.0, 0.0,
                              out->base.type == TRIBO_SHAPE_CONE ? -0.5 * out->base.size[1] : 0.0};
    memset(&out->convex, 0, sizeof out->convex);
    out->convex.struct_size = sizeof out->convex;
    out->convex.support = shapes_support;
    out->convex.face = has_face ? shapes_face : NULL;
    out->convex.user = &out->base;
    memcpy(out->convex.center, center, sizeof center);
    out->convex.radius = 2.0 * out->size;
    out->shape.data = &out->convex;
}

static void make_user(property_trial *t, made_shape *out)
{
    make_round(t, choose_kind(t, SHAPES_ROUND), &out->base);
    measure(&out->base, &out->size, &out->small);
    out->shape.type = TRIBO_SHAPE_CONVEX;
    set_user(out, make_byte(t) % 2 == 1);
}

static void measure_compound(made_shape *out)
{
    out->size = 0.0;
    out->small = HUGE_VAL;
    for (uint32_t i = 0; i < out->shape.count; i++) {
        double size;
        double small;
        measure(&out->children[i].shape, &size, &small);
        out->size = fmax(out->size, size + norm3(out->children[i].pose.position));
        out->small = fmin(out->small, small);
    }
}

static void make_compound(property_trial *t, made_shape *out)
{
    out->shape.type = TRIBO_SHAPE_COMPOUND;
    out->shape.count = 1 + make_choice(t, NULL, SHAPES_CHILDREN);
    out->shape.data = out->children;
    for (uint32_t i = 0; i < out->shape.count; i++) {
        make_round(t, choose_kind(t, SHAPES_ROUND), &out->children[i].shape);
        make_pose(t, NULL, -10, 10, &out->children[i].pose);
    }
    measure_compound(out);
}

static void note_part(property_trial *t, const tribo_shape *shape)
{
    if (t->log != NULL) {
        fprintf(t->log, "#     kind %u\n", (unsigned)shape->type);
        property_note(t, "  size", shape->size, 4);
    }
}

static void note_shape(property_trial *t, const char *name, const made_shape *s)
{
    if (t->log == NULL || name == NULL) {
        return;
    }
    const char *face =
        s->convex.face != NULL ? ", by its functions with faces" : ", by its support";
    fprintf(t->log, "#   %s%s:\n", name, s->shape.type == TRIBO_SHAPE_CONVEX ? face : "");
    note_part(t, s->shape.type == TRIBO_SHAPE_CONVEX ? &s->base : &s->shape);
    for (uint32_t i = 0; i < s->shape.count; i++) {
        note_part(t, &s->children[i].shape);
        property_note(t, "  position", s->children[i].pose.position, 3);
        property_note(t, "  orientation", s->children[i].pose.orientation, 4);
    }
    if (s->point_count > 0) {
        property_note(t, "  points", s->points, 3 * s->point_count);
    }
}

void make_shape(property_trial *t, const char *name, uint32_t kinds, made_shape *out)
{
    FILE *log = t->log;
    t->log = NULL;
    memset(out, 0, offsetof(made_shape, block));
    const uint32_t type = choose_kind(t, kinds);
    switch (type) {
    case TRIBO_SHAPE_HULL:
        make_hull(t, out);
        break;
    case TRIBO_SHAPE_CONVEX:
        make_user(t, out);
        break;
    case TRIBO_SHAPE_MESH:
        make_mesh(t, out);
        break;
    case TRIBO_SHAPE_COMPOUND:
        make_compound(t, out);
        break;
    case TRIBO_SHAPE_HALFSPACE:
        make_halfspace(t, &out->shape);
        measure(&out->shape, &out->size, &out->small);
        break;
    default:
        make_round(t, type, &out->shape);
        measure(&out->shape, &out->size, &out->small);
        break;
    }
    if (out->point_count > 0) {
        out->shape.data = out->block;
    }
    t->log = log;
    note_shape(t, name, out);
}

static void scale_numbers(double *x, size_t count, int exponent)
{
    for (size_t i = 0; i < count; i++) {
        x[i] = ldexp(x[i], exponent);
    }
}

static void scale_sizes(tribo_shape *shape, int exponent)
{
    const size_t first = shape->type == TRIBO_SHAPE_HALFSPACE ? 3 : 0;
    scale_numbers(shape->size + first, 4 - first, exponent);
}

int shapes_scalable(const double *numbers, size_t count)
{
    int scalable = 1;
    for (size_t i = 0; i < count; i++) {
        scalable = scalable && (numbers[i] == 0.0 || fabs(numbers[i]) > 1e-200);
    }
    return scalable;
}

int shapes_scale(const made_shape *from, int exponent, made_shape *out)
{
    memcpy(out, from, sizeof *out);
    scale_sizes(&out->shape, exponent);
    scale_sizes(&out->base, exponent);
    scale_numbers(out->points, 3 * out->point_count, exponent);
    out->size = ldexp(out->size, exponent);
    out->small = ldexp(out->small, exponent);
    for (uint32_t i = 0; i < out->shape.count; i++) {
        scale_sizes(&out->children[i].shape, exponent);
        scale_numbers(out->children[i].pose.position, 3, exponent);
    }
    if (out->shape.type == TRIBO_SHAPE_CONVEX) {
        set_user(out, from->convex.face != NULL);
    } else if (out->shape.type == TRIBO_SHAPE_COMPOUND) {
        out->shape.data = out->children;
    } else if (out->point_count > 0) {
        out->shape.data = out->block;
        return build_block(out);
    }
    return 1;
}

void make_pose(property_trial *t, const char *name, int low, int high, tribo_pose *out)
{
    FILE *log = t->log;
    t->log = NULL;
    make_quat(t, NULL, out->orientation);
    if (make_byte(t) >= 224) {
        const double stretch = 1.0 + 0.9e-6 * make_signed(t, NULL);
        for (int i = 0; i < 4; i++) {
            out->orientation[i] *= stretch;
        }
    }
    make_vector(t, NULL, low, high, out->position);
    t->log = log;
    if (name != NULL && log != NULL) {
        fprintf(log, "#   %s:\n", name);
        property_note(t, "  position", out->position, 3);
        property_note(t, "  orientation", out->orientation, 4);
    }
}

/* ---- what is known of them ----------------------------------------------------------------- */

static long double wide(double x)
{
    return (long double)x;
}

static long double length3(const long double v[3])
{
    return sqrtl(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void shapes_rotation(const tribo_pose *pose, long double r[9])
{
    reference_rotation(pose->orientation, r);
}

static long double points_extent(const double *points, size_t count, const long double d[3])
{
    long double most = -(long double)INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double *p = points + 3 * i;
        most = fmaxl(most, d[0] * wide(p[0]) + d[1] * wide(p[1]) + d[2] * wide(p[2]));
    }
    return most;
}

static long double compound_extent(const tribo_shape *shape, const long double d[3])
{
    const tribo_child *children = shape->data;
    long double most = -(long double)INFINITY;
    for (uint32_t c = 0; c < shape->count; c++) {
        const tribo_pose *pose = &children[c].pose;
        long double r[9];
        long double own[3];
        shapes_rotation(pose, r);
        for (int i = 0; i < 3; i++) {
            own[i] = r[i] * d[0] + r[3 + i] * d[1] + r[6 + i] * d[2];
        }
        most = fmaxl(most,
                     shapes_extent(&children[c].shape, own) + points_extent(pose->position, 1, d));
    }
    return most;
}

long double shapes_extent(const tribo_shape *shape, const long double d[3])
{
    const double *s = shape->size;
    const long double radial = sqrtl(d[0] * d[0] + d[1] * d[1]);
    const long double along = fabsl(d[2]);
    const long double stretched[3] = {d[0] * wide(s[0]), d[1] * wide(s[1]), d[2] * wide(s[2])};
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return wide(s[0]) * length3(d);
    case TRIBO_SHAPE_BOX:
        return fabsl(stretched[0]) + fabsl(stretched[1]) + fabsl(stretched[2]);
    case TRIBO_SHAPE_CAPSULE:
        return wide(s[0]) * length3(d) + wide(s[1]) * along;
    case TRIBO_SHAPE_CYLINDER:
        return wide(s[0]) * radial + wide(s[1]) * along;
    case TRIBO_SHAPE_CONE:
        return fmaxl(wide(s[1]) * d[2], wide(s[0]) * radial - wide(s[1]) * d[2]);
    case TRIBO_SHAPE_ELLIPSOID:
        return length3(stretched);
    case TRIBO_SHAPE_HULL: {
        const hull_block *hull = shape->data;
        return points_extent(hull_vertices(hull), hull->vertex_count, d);
    }
    case TRIBO_SHAPE_CONVEX:
        return shapes_extent(((const tribo_convex *)shape->data)->user, d);
    case TRIBO_SHAPE_COMPOUND:
        return compound_extent(shape, d);
    default:
        return (long double)INFINITY;
    }
}

static long double outside_ellipsoid(const double axes[3], const long double x[3])
{
    long double q[3];
    long double gradient[3];
    for (int i = 0; i < 3; i++) {
        q[i] = x[i] / wide(axes[i]);
        gradient[i] = q[i] / wide(axes[i]);
    }
    const long double length = length3(q);
    return length <= 1.0L ? 0.0L : (length - 1.0L) * length / length3(gradient);
}

static long double outside_hull(const hull_block *hull, const long double x[3])
{
    const double *planes = hull_planes(hull);
    long double most = -(long double)INFINITY;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        most = fmaxl(most,
                     points_extent(planes + 4 * (size_t)f, 1, x) - wide(planes[4 * (size_t)f + 3]));
    }
    return most;
}

long double shapes_outside(const tribo_shape *shape, const long double x[3])
{
    const double *s = shape->size;
    const long double r = wide(s[0]);
    const long double h = wide(s[1]);
    const long double radial = sqrtl(x[0] * x[0] + x[1] * x[1]);
    const long double over = fabsl(x[2]) - h;
    switch (shape->type) {
    case TRIBO_SHAPE_SPHERE:
        return length3(x) - r;
    case TRIBO_SHAPE_BOX:
        return fmaxl(fabsl(x[0]) - r, fmaxl(fabsl(x[1]) - h, fabsl(x[2]) - wide(s[2])));
    case TRIBO_SHAPE_CAPSULE:
        return hypotl(radial, fmaxl(over, 0.0L)) - r;
    case TRIBO_SHAPE_CYLINDER:
        return fmaxl(radial - r, over);
    case TRIBO_SHAPE_CONE:
        return fmaxl(-h - x[2], (2.0L * h * radial + r * (x[2] - h)) / hypotl(2.0L * h, r));
    case TRIBO_SHAPE_ELLIPSOID:
        return outside_ellipsoid(s, x);
    case TRIBO_SHAPE_HULL:
        return outside_hull(shape->data, x);
    case TRIBO_SHAPE_CONVEX:
        return shapes_outside(((const tribo_convex *)shape->data)->user, x);
    default:
        return points_extent(s, 1, x) - wide(s[3]);
    }
}
