/* Convex hulls as flat blocks: building by Qhull, checking, and the queries on them. */
#include "hull.h"

#include "rows.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

#include <libqhull_r/qhull_ra.h>

#define MAX_POINTS ((size_t)1 << 24)
#define FLAT 1e-12   /* of the extent: thinner point sets span no volume */
#define OUTSIDE 1e-9 /* of the extent: how far a point may lie outside of a plane */
#define SLIVER 1e-14 /* of the extent: by how much the own normal of a face may miss a vertex */
#define UNIT 1e-9
#define NEEDLE 0.0009765625 /* width by length below which a hull is looked at along its length */

/* ---- layout ---------------------------------------------------------------------------------- */

/* Sizes and offsets follow from the three counts alone. */
static void lay_out(hull_block *head, uint32_t vertex_count, uint32_t face_count,
                    uint32_t side_count)
{
    const uint64_t v = vertex_count;
    const uint64_t f = face_count;
    const uint64_t s = side_count;
    uint64_t end = sizeof *head;
    memset(head, 0, sizeof *head);
    head->magic = HULL_MAGIC;
    head->version = HULL_VERSION;
    head->vertex_count = vertex_count;
    head->face_count = face_count;
    head->side_count = side_count;
    head->vertices = block_place(&end, v * 3 * sizeof(double));
    head->planes = block_place(&end, f * 4 * sizeof(double));
    head->face_starts = block_place(&end, (f + 1) * sizeof(uint32_t));
    head->loops = block_place(&end, s * sizeof(uint32_t));
    head->ring_starts = block_place(&end, (v + 1) * sizeof(uint32_t));
    head->rings = block_place(&end, s * 2 * sizeof(uint32_t));
    head->seeds = block_place(&end, v > HULL_LINEAR ? HULL_SEEDS * sizeof(uint32_t) : 0);
    head->bytes = end;
}

/* ---- judging a block ------------------------------------------------------------------------- */

int hull_head_is_valid(const void *block)
{
    const hull_block *head = block;
    if (head->magic != HULL_MAGIC || head->version != HULL_VERSION) {
        return 0;
    }
    const int64_t euler =
        (int64_t)head->vertex_count + (int64_t)head->face_count - (int64_t)(head->side_count / 2u);
    if (head->vertex_count < 4 || head->vertex_count > MAX_POINTS || head->face_count < 4 ||
        head->side_count % 2u != 0 || euler != 2) {
        return 0;
    }
    hull_block expected;
    lay_out(&expected, head->vertex_count, head->face_count, head->side_count);
    return memcmp(head, &expected, offsetof(hull_block, center)) == 0;
}

/* count lists of at least 3 entries each, end to end in a table of `total`. */
static int starts_are_valid(const uint32_t *starts, uint32_t count, uint32_t total)
{
    if (starts[0] != 0 || starts[count] != total) {
        return 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (starts[i] > starts[i + 1] || starts[i + 1] - starts[i] < 3) {
            return 0;
        }
    }
    return 1;
}

static int indices_are_valid(const uint32_t *indices, uint32_t count, uint32_t stride,
                             uint32_t limit)
{
    uint32_t greatest = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t index = indices[(size_t)stride * i];
        greatest = index > greatest ? index : greatest;
    }
    return greatest < limit;
}

static int numbers_are_valid(const hull_block *hull)
{
    const double *v = hull_vertices(hull);
    const double *planes = hull_planes(hull);
    if (!all_finite(hull->center, 3) || !(hull->inner >= 0.0) || !(hull->outer >= hull->inner) ||
        !all_finite(&hull->outer, 1)) {
        return 0;
    }
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        if (!all_finite(v + 3 * (size_t)i, 3)) {
            return 0;
        }
    }
    for (uint32_t i = 0; i < hull->face_count; i++) {
        const double *p = planes + 4 * (size_t)i;
        const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
        if (!all_finite(p, 4) || !(absolute(square - 1.0) <= UNIT)) {
            return 0;
        }
    }
    return 1;
}

uint64_t hull_sum(const hull_block *hull)
{
    return block_sum(hull, hull->bytes, offsetof(hull_block, sum));
}

/* Whether all indices are in range, and all numbers such as a hull has: no query then reads outside
 * of the block, and each comes to an end. */
static int body_is_valid(const hull_block *hull)
{
    const uint32_t vertices = hull->vertex_count;
    const uint32_t *rings = hull_table(hull, hull->rings);
    const uint32_t seeds = vertices > HULL_LINEAR ? HULL_SEEDS : 0;
    return starts_are_valid(hull_table(hull, hull->face_starts), hull->face_count,
                            hull->side_count) &&
           starts_are_valid(hull_table(hull, hull->ring_starts), vertices, hull->side_count) &&
           indices_are_valid(hull_table(hull, hull->loops), hull->side_count, 1, vertices) &&
           indices_are_valid(rings, hull->side_count, 2, vertices) &&
           indices_are_valid(rings + 1, hull->side_count, 2, hull->face_count) &&
           indices_are_valid(hull_table(hull, hull->seeds), seeds, 1, vertices) &&
           numbers_are_valid(hull);
}

/* The sum tells damage; the rest, a block that was written to deceive. */
tribo_status tribo_hull_check(const void *block, size_t size)
{
    if (!block) {
        return TRIBO_ERROR_NULL;
    }
    const hull_block *hull = block;
    const int is_whole = block_is_aligned(block) && size >= sizeof *hull &&
                         hull_head_is_valid(block) && hull->bytes <= size;
    return is_whole && hull_sum(hull) == hull->sum && body_is_valid(hull) ? TRIBO_OK
                                                                          : TRIBO_ERROR_DATA;
}

tribo_status tribo_hull_counts(const void *block, uint32_t *vertices, uint32_t *faces)
{
    if (!block || !vertices || !faces) {
        return TRIBO_ERROR_NULL;
    }
    if (!hull_head_is_valid(block)) {
        return TRIBO_ERROR_DATA;
    }
    const hull_block *hull = block;
    *vertices = hull->vertex_count;
    *faces = hull->face_count;
    return TRIBO_OK;
}

/* ---- queries --------------------------------------------------------------------------------- */

/* From the centre, so that a hull far from its origin loses nothing. The same bits for the same
 * vertex, whoever asks: a climb can then never run in a circle. */
TRIBO_ALWAYS_INLINE double height_of(const hull_block *hull, const double *v, const double d[3])
{
    return d[0] * (v[0] - hull->center[0]) + d[1] * (v[1] - hull->center[1]) +
           d[2] * (v[2] - hull->center[2]);
}

static uint32_t climb(const hull_block *hull, uint32_t start, const double d[3])
{
    const double *v = hull_vertices(hull);
    const uint32_t *starts = hull_table(hull, hull->ring_starts);
    const uint32_t *rings = hull_table(hull, hull->rings);
    uint32_t at = start;
    double height = height_of(hull, v + 3 * (size_t)at, d);
    for (;;) {
        const uint32_t here = at;
        for (uint32_t k = starts[here]; k < starts[here + 1]; k++) {
            const uint32_t next = rings[2 * (size_t)k];
            const double h = height_of(hull, v + 3 * (size_t)next, d);
            at = h > height ? next : at;
            height = h > height ? h : height;
        }
        if (at == here) {
            return at;
        }
    }
}

static uint32_t cell_along(double x)
{
    const int cell = (int)((x + 1.0) * (0.5 * (double)HULL_GRID));
    return cell < 0 ? 0u : cell > (int)HULL_GRID - 1 ? HULL_GRID - 1u : (uint32_t)cell;
}

/* Directions by the face of a cube that they pierce, and a grid on it. */
static uint32_t cell_of(const double d[3])
{
    const double x = absolute(d[0]);
    const double y = absolute(d[1]);
    const double z = absolute(d[2]);
    const uint32_t axis = x >= y && x >= z ? 0u : y >= z ? 1u : 2u;
    const double size = greater(x, greater(y, z));
    const uint32_t side = 2u * axis + (d[axis] < 0.0 ? 1u : 0u);
    const uint32_t u = cell_along(d[(axis + 1u) % 3u] / size);
    const uint32_t v = cell_along(d[(axis + 2u) % 3u] / size);
    return (side * HULL_GRID + u) * HULL_GRID + v;
}

uint32_t hull_support(const hull_block *hull, const double direction[3])
{
    if (hull->vertex_count > HULL_LINEAR) {
        const uint32_t *seeds = hull_table(hull, hull->seeds);
        return climb(hull, seeds[cell_of(direction)], direction);
    }
    const double *v = hull_vertices(hull);
    uint32_t best = 0;
    double height = height_of(hull, v, direction);
    for (uint32_t i = 1; i < hull->vertex_count; i++) {
        const double h = height_of(hull, v + 3 * (size_t)i, direction);
        best = h > height ? i : best;
        height = h > height ? h : height;
    }
    return best;
}

uint32_t hull_face_at(const hull_block *hull, uint32_t vertex, const double direction[3])
{
    const double *planes = hull_planes(hull);
    const uint32_t *starts = hull_table(hull, hull->ring_starts);
    const uint32_t *rings = hull_table(hull, hull->rings);
    uint32_t best = 0;
    double greatest = -HUGE_VAL;
    for (uint32_t k = starts[vertex]; k < starts[vertex + 1]; k++) {
        const uint32_t face = rings[2 * (size_t)k + 1];
        const double along = tribo_vec3_dot(planes + 4 * (size_t)face, direction);
        if (along > greatest) {
            greatest = along;
            best = face;
        }
    }
    return best;
}

/* Sums over tetrahedra from the centre to the triangles of each face; all volumes are positive, so
 * that nothing cancels. The second moment of (0, a, b, c) is V/20 ((a+b+c)(a+b+c)' + aa' + bb' +
 * cc'). */
static void add_tetrahedron(const double a[3], const double b[3], const double c[3], double *volume,
                            double first[3], double second[6])
{
    double cross[3];
    double sum[3];
    tribo_vec3_cross(b, c, cross);
    tribo_vec3_add(a, b, sum);
    tribo_vec3_add(sum, c, sum);
    const double v = tribo_vec3_dot(a, cross) / 6.0;
    const double *const terms[4] = {sum, a, b, c};
    *volume += v;
    for (int i = 0; i < 3; i++) {
        first[i] += 0.25 * v * sum[i];
    }
    for (int k = 0; k < 4; k++) {
        const double *t = terms[k];
        const double squares[6] = {t[0] * t[0], t[0] * t[1], t[0] * t[2],
                                   t[1] * t[1], t[1] * t[2], t[2] * t[2]};
        for (int i = 0; i < 6; i++) {
            second[i] += 0.05 * v * squares[i];
        }
    }
}

/* Vertices from the centre, in units of 1/scale; of a needle in axes along it. */
typedef struct view {
    const hull_block *hull;
    double scale;
    int is_turned;
    double frame[9];
} view;

static void relative_vertex(const view *from, uint32_t index, double out[3])
{
    const double *v = hull_vertices(from->hull) + 3 * (size_t)index;
    for (int i = 0; i < 3; i++) {
        out[i] = from->scale * (v[i] - from->hull->center[i]);
    }
    if (from->is_turned) {
        tribo_mat3_apply(from->frame, out, out);
    }
}

static view view_of(const hull_block *hull, double scale)
{
    view from;
    memset(&from, 0, sizeof from);
    from.hull = hull;
    from.scale = scale;
    return from;
}

/* In the given axes the products of a needle's long components would drown its volume: the relative
 * error is eps / width^2 there, and eps / width here. */
static void turn_view(view *from)
{
    const uint32_t count = from->hull->vertex_count;
    double axis[3] = {0.0, 0.0, 0.0};
    double length = 0.0;
    double width = 0.0;
    double v[3];
    for (uint32_t i = 0; i < count; i++) {
        relative_vertex(from, i, v);
        const double square = tribo_vec3_dot(v, v);
        if (square > length) {
            length = square;
            memcpy(axis, v, sizeof axis);
        }
    }
    tribo_vec3_scale(1.0 / sqrt(length), axis, axis);
    for (uint32_t i = 0; i < count; i++) {
        double across[3];
        relative_vertex(from, i, v);
        tribo_vec3_cross(axis, v, across);
        width = greater(width, tribo_vec3_dot(across, across));
    }
    basis_rows(axis[0], axis[1], axis[2], from->frame);
    from->is_turned = width < NEEDLE * NEEDLE * length;
}

/* Back to the axes of the hull: R' c and R' S R. */
static void turn_back(const view *from, double center[3], double second[6])
{
    const double *r = from->frame;
    const double s[6] = {second[0], second[1], second[2], second[3], second[4], second[5]};
    double columns[9];
    tribo_mat3_apply_transposed(r, center, center);
    for (int i = 0; i < 3; i++) {
        const double column[3] = {r[i], r[3 + i], r[6 + i]};
        tribo_sym3_apply(s, column, columns + 3 * i);
    }
    for (int i = 0, k = 0; i < 3; i++) {
        for (int j = i; j < 3; j++, k++) {
            const double column[3] = {r[j], r[3 + j], r[6 + j]};
            second[k] = tribo_vec3_dot(columns + 3 * i, column);
        }
    }
}

static void add_faces(const view *from, double *volume, double first[3], double second[6])
{
    const hull_block *hull = from->hull;
    const uint32_t *starts = hull_table(hull, hull->face_starts);
    const uint32_t *loops = hull_table(hull, hull->loops);
    for (uint32_t f = 0; f < hull->face_count; f++) {
        double a[3];
        double b[3];
        double c[3];
        relative_vertex(from, loops[starts[f]], a);
        relative_vertex(from, loops[starts[f] + 1], c);
        for (uint32_t k = starts[f] + 2; k < starts[f + 1]; k++) {
            memcpy(b, c, sizeof b);
            relative_vertex(from, loops[k], c);
            add_tetrahedron(a, b, c, volume, first, second);
        }
    }
}

void hull_moments(const hull_block *hull, double scale, double *volume, double center[3],
                  double second[6])
{
    view from = view_of(hull, scale);
    double total = 0.0;
    double first[3] = {0.0, 0.0, 0.0};
    double sums[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    turn_view(&from);
    add_faces(&from, &total, first, sums);
    *volume = total;
    for (int i = 0, k = 0; i < 3; i++) {
        center[i] = first[i] / total;
        for (int j = i; j < 3; j++, k++) {
            second[k] = sums[k] - first[i] * (first[j] / total);
        }
    }
    if (from.is_turned) {
        turn_back(&from, center, second);
    }
}

/* ---- points, normalised ---------------------------------------------------------------------- */

typedef struct cloud {
    size_t count;
    double *points; /* width 3, extent within [1, 2) around the origin */
    double shift[3];
    double scale; /* power of two: points = scale (input - shift) */
} cloud;

static void bounds_of(size_t count, const double *points, double low[3], double high[3])
{
    memcpy(low, points, 3 * sizeof *low);
    memcpy(high, points, 3 * sizeof *high);
    for (size_t i = 1; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            low[k] = lesser(low[k], points[3 * i + k]);
            high[k] = greater(high[k], points[3 * i + k]);
        }
    }
}

/* Midpoint and scale of the points. 0 if all are equal. */
static int measure(size_t count, const double *points, double shift[3], double *scale)
{
    double low[3];
    double high[3];
    double extent = 0.0;
    bounds_of(count, points, low, high);
    for (int k = 0; k < 3; k++) {
        /* Halves first: the sum and the difference of the largest numbers overflow. */
        shift[k] = 0.5 * low[k] + 0.5 * high[k];
        extent = greater(extent, 0.5 * high[k] - 0.5 * low[k]);
    }
    *scale = 0.5 * power_of_two(scale_exponent(extent));
    return extent > 0.0;
}

static void normalise(const double *points, cloud *set)
{
    for (size_t i = 0; i < set->count; i++) {
        for (size_t k = 0; k < 3; k++) {
            set->points[3 * i + k] = set->scale * (points[3 * i + k] - set->shift[k]);
        }
    }
}

/* Distance of p from the span of orthonormal axes at an origin; the remainder goes to rest. */
static double distance_from(const double *p, const double *origin, const double *axes, int count,
                            double rest[3])
{
    tribo_vec3_subtract(p, origin, rest);
    for (int k = 0; k < count; k++) {
        const double *axis = axes + 3 * k;
        tribo_vec3_add_scaled(rest, -tribo_vec3_dot(rest, axis), axis, rest);
    }
    return sqrt(tribo_vec3_dot(rest, rest));
}

/* Whether the points lie at one point, on a line or in a plane: each time the farthest from the
 * span so far must be far enough to widen it. */
static int is_flat(const cloud *set)
{
    double axes[9];
    for (int k = 0; k < 3; k++) {
        double rest[3] = {0.0, 0.0, 0.0};
        double greatest = 0.0;
        for (size_t i = 1; i < set->count; i++) {
            double r[3];
            const double distance = distance_from(set->points + 3 * i, set->points, axes, k, r);
            if (distance > greatest) {
                greatest = distance;
                memcpy(rest, r, sizeof rest);
            }
        }
        if (!(greatest > FLAT)) {
            return 1;
        }
        tribo_vec3_scale(1.0 / greatest, rest, axes + 3 * k);
    }
    return 0;
}

/* ---- Qhull ----------------------------------------------------------------------------------- */

#if defined(_WIN32)
#define NULL_DEVICE "NUL"
#else
#define NULL_DEVICE "/dev/null"
#endif

/* Faces as Qhull gave them, by indices of input points. */
typedef struct faces {
    uint32_t count;
    uint32_t sides;
    uint32_t *starts;
    uint32_t *loops;
    double *normals;
} faces;

static void drop_faces(faces *out)
{
    free(out->starts);
    free(out->loops);
    free(out->normals);
    memset(out, 0, sizeof *out);
}

static int allocate_faces(qhT *qh, faces *out)
{
    facetT *facet;
    size_t sides = 0;
    size_t count = 0;
    FORALLfacet_(qh->facet_list)
    {
        sides += (size_t)qh_setsize(qh, facet->vertices);
        count++;
    }
    out->count = (uint32_t)count;
    out->sides = (uint32_t)sides;
    out->starts = malloc((count + 1) * sizeof *out->starts);
    out->loops = malloc((sides + 1) * sizeof *out->loops);
    out->normals = malloc((3 * count + 1) * sizeof *out->normals);
    return out->starts && out->loops && out->normals;
}

static void copy_faces(qhT *qh, faces *out)
{
    facetT *facet;
    vertexT *vertex;
    vertexT **vertexp;
    uint32_t face = 0;
    uint32_t side = 0;
    FORALLfacet_(qh->facet_list)
    {
        setT *loop = qh_facet3vertex(qh, facet);
        out->starts[face] = side;
        memcpy(out->normals + 3 * (size_t)face, facet->normal, 3 * sizeof(double));
        FOREACHvertex_(loop)
        {
            /* A loop is no longer than the set that was counted; no trust in that. */
            if (side < out->sides) {
                out->loops[side++] = (uint32_t)qh_pointid(qh, vertex->point);
            }
        }
        qh_settempfree(qh, &loop);
        face++;
    }
    out->starts[face] = side;
    out->sides = side;
}

/* Outside of qh_new_qhull Qhull ends the process on an internal error unless it finds a place to
 * jump to. */
static int read_faces(qhT *qh, faces *out)
{
    switch (setjmp(qh->errexit)) {
    case 0:
        break;
    case qh_ERRmem:
        qh->NOerrexit = True;
        return qh_ERRmem;
    default:
        qh->NOerrexit = True;
        return qh_ERRqhull;
    }
    qh->NOerrexit = False;
    const int allocated = allocate_faces(qh, out);
    if (allocated) {
        copy_faces(qh, out);
    }
    qh->NOerrexit = True;
    return allocated ? qh_ERRnone : qh_ERRmem;
}

static tribo_status status_of(int code)
{
    return code == qh_ERRnone  ? TRIBO_OK
           : code == qh_ERRmem ? TRIBO_ERROR_MEMORY
                               : TRIBO_ERROR_DEGENERATE;
}

/* Qhull writes its complaints to a file that it must be given. */
static tribo_status run_qhull(const cloud *set, faces *out)
{
    char options[] = "qhull Pp";
    FILE *sink = fopen(NULL_DEVICE, "w");
    if (!sink) {
        return TRIBO_ERROR_MEMORY;
    }
    qhT qh;
    int long_blocks;
    int long_bytes;
    qh_zero(&qh, sink);
    int code = qh_new_qhull(&qh, 3, (int)set->count, set->points, False, options, NULL, sink);
    if (code == qh_ERRnone) {
        code = read_faces(&qh, out);
    }
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &long_blocks, &long_bytes);
    fclose(sink);
    return status_of(code);
}

/* ---- assembly -------------------------------------------------------------------------------- */

#define NONE UINT32_MAX

/* A side is a place in the loops: the directed edge from the vertex there to the next one of its
 * face. */
typedef struct assembly {
    const cloud *set;
    const double *points; /* as the caller gave them */
    faces raw;
    uint32_t vertex_count;
    uint32_t *vertex_of; /* input point: vertex, or NONE */
    uint32_t *face_of;   /* side: face */
    uint32_t *twin_face; /* side: the face across */
    uint32_t *leaving;   /* sides by the vertex that they leave */
    uint32_t *where;     /* vertex: place in `leaving` of the side that goes there */
    hull_block *hull;
} assembly;

static uint32_t *own_table(hull_block *hull, uint64_t offset)
{
    return (uint32_t *)(void *)((unsigned char *)hull + offset);
}

static double *own_numbers(hull_block *hull, uint64_t offset)
{
    return (double *)(void *)((unsigned char *)hull + offset);
}

static void drop_assembly(assembly *work)
{
    drop_faces(&work->raw);
    free(work->vertex_of);
    free(work->face_of);
    free(work->hull);
}

/* Vertices keep the order of the input. */
static int number_vertices(assembly *work)
{
    const faces *raw = &work->raw;
    const size_t count = work->set->count;
    work->vertex_of = malloc(count * sizeof *work->vertex_of);
    if (!work->vertex_of) {
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        work->vertex_of[i] = NONE;
    }
    for (uint32_t s = 0; s < raw->sides; s++) {
        work->vertex_of[raw->loops[s]] = 0;
    }
    for (size_t i = 0; i < count; i++) {
        if (work->vertex_of[i] != NONE) {
            work->vertex_of[i] = work->vertex_count++;
        }
    }
    return 1;
}

static int allocate_block(assembly *work)
{
    hull_block head;
    const size_t sides = work->raw.sides;
    lay_out(&head, work->vertex_count, work->raw.count, work->raw.sides);
    work->hull = calloc((size_t)head.bytes, 1);
    work->face_of = malloc((3 * sides + work->vertex_count) * sizeof *work->face_of);
    if (!work->hull || !work->face_of) {
        return 0;
    }
    work->twin_face = work->face_of + sides;
    work->leaving = work->twin_face + sides;
    work->where = work->leaving + sides;
    *work->hull = head;
    return 1;
}

/* Area normal of a loop of input points, normalised: sum of the cross products from its first
 * point. */
static void area_normal(const double *points, const uint32_t *loop, uint32_t count,
                        double normal[3])
{
    const double *origin = points + 3 * (size_t)loop[0];
    double a[3];
    double b[3];
    double cross[3];
    memset(normal, 0, 3 * sizeof *normal);
    tribo_vec3_subtract(points + 3 * (size_t)loop[1], origin, b);
    for (uint32_t k = 2; k < count; k++) {
        memcpy(a, b, sizeof a);
        tribo_vec3_subtract(points + 3 * (size_t)loop[k], origin, b);
        tribo_vec3_cross(a, b, cross);
        tribo_vec3_add(normal, cross, normal);
    }
}

/* All loops turn the same way round; which one, the large faces decide. */
static int loops_are_clockwise(const assembly *work)
{
    const faces *raw = &work->raw;
    double sum = 0.0;
    for (uint32_t f = 0; f < raw->count; f++) {
        double normal[3];
        area_normal(work->set->points, raw->loops + raw->starts[f],
                    raw->starts[f + 1] - raw->starts[f], normal);
        sum += tribo_vec3_dot(normal, raw->normals + 3 * (size_t)f);
    }
    return sum < 0.0;
}

static void reverse_loops(faces *raw)
{
    for (uint32_t f = 0; f < raw->count; f++) {
        for (uint32_t i = raw->starts[f], j = raw->starts[f + 1]; i + 1 < j; i++) {
            j--;
            const uint32_t index = raw->loops[i];
            raw->loops[i] = raw->loops[j];
            raw->loops[j] = index;
        }
    }
}

/* Tables, and the mean of the vertices as a first inner point. */
static void copy_vertices(assembly *work)
{
    hull_block *hull = work->hull;
    double *vertices = own_numbers(hull, hull->vertices);
    uint32_t *loops = own_table(hull, hull->loops);
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < work->set->count; i++) {
        const uint32_t vertex = work->vertex_of[i];
        if (vertex != NONE) {
            tribo_vec3_add(sum, work->set->points + 3 * i, sum);
            memcpy(vertices + 3 * (size_t)vertex, work->points + 3 * i, 3 * sizeof *vertices);
        }
    }
    for (uint32_t s = 0; s < work->raw.sides; s++) {
        loops[s] = work->vertex_of[work->raw.loops[s]];
    }
    memcpy(own_table(hull, hull->face_starts), work->raw.starts,
           (work->raw.count + (size_t)1) * sizeof(uint32_t));
    tribo_vec3_scale(1.0 / (double)work->vertex_count, sum, sum);
    tribo_vec3_add_scaled(work->set->shift, 1.0 / work->set->scale, sum, hull->center);
}

static uint32_t following(const assembly *work, uint32_t side)
{
    const uint32_t face = work->face_of[side];
    return side + 1 < work->raw.starts[face + 1] ? side + 1 : work->raw.starts[face];
}

static uint32_t preceding(const assembly *work, uint32_t side)
{
    const uint32_t face = work->face_of[side];
    return side > work->raw.starts[face] ? side - 1 : work->raw.starts[face + 1] - 1;
}

static void sort_sides_by_vertex(assembly *work)
{
    hull_block *hull = work->hull;
    uint32_t *starts = own_table(hull, hull->ring_starts);
    const uint32_t *loops = own_table(hull, hull->loops);
    for (uint32_t f = 0; f < work->raw.count; f++) {
        for (uint32_t s = work->raw.starts[f]; s < work->raw.starts[f + 1]; s++) {
            work->face_of[s] = f;
            starts[loops[s] + 1]++;
        }
    }
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        starts[v + 1] += starts[v];
        work->where[v] = starts[v];
    }
    for (uint32_t s = 0; s < work->raw.sides; s++) {
        work->leaving[work->where[loops[s]]++] = s;
    }
}

/* Counter-clockwise around one vertex: from the side that leaves a face to the one along which the
 * loop of that face comes in. 0 unless the faces close around it. */
static int order_ring(assembly *work, uint32_t vertex)
{
    hull_block *hull = work->hull;
    const uint32_t *loops = own_table(hull, hull->loops);
    const uint32_t first = own_table(hull, hull->ring_starts)[vertex];
    const uint32_t end = own_table(hull, hull->ring_starts)[vertex + 1];
    uint32_t *rings = own_table(hull, hull->rings);
    for (uint32_t k = first; k < end; k++) {
        work->where[loops[following(work, work->leaving[k])]] = k;
    }
    uint32_t at = first;
    for (uint32_t k = first; k < end; k++) {
        const uint32_t side = work->leaving[at];
        const uint32_t from = loops[preceding(work, side)];
        rings[2 * (size_t)k] = loops[following(work, side)];
        rings[2 * (size_t)k + 1] = work->face_of[side];
        at = work->where[from];
        if (at < first || at >= end || loops[following(work, work->leaving[at])] != from ||
            (at == first) != (k + 1 == end)) {
            return 0;
        }
        work->twin_face[work->leaving[at]] = work->face_of[side];
    }
    return end - first >= 3;
}

static int build_rings(assembly *work)
{
    sort_sides_by_vertex(work);
    memset(work->where, 0, work->vertex_count * sizeof *work->where);
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        if (!order_ring(work, v)) {
            return 0;
        }
    }
    return 1;
}

static void build_seeds(hull_block *hull)
{
    if (hull->vertex_count <= HULL_LINEAR) {
        return;
    }
    uint32_t *seeds = own_table(hull, hull->seeds);
    uint32_t at = 0;
    for (uint32_t i = 0; i < HULL_SEEDS; i++) {
        const uint32_t side = i / (HULL_GRID * HULL_GRID);
        const uint32_t axis = side / 2u;
        const double cell = 2.0 / (double)HULL_GRID;
        double d[3];
        d[axis] = side % 2u != 0 ? -1.0 : 1.0;
        d[(axis + 1u) % 3u] = cell * ((double)(i / HULL_GRID % HULL_GRID) + 0.5) - 1.0;
        d[(axis + 2u) % 3u] = cell * ((double)(i % HULL_GRID) + 0.5) - 1.0;
        at = climb(hull, at, d);
        seeds[i] = at;
    }
}

/* How far the hull reaches beyond the loop of a face, along a normal; its farthest vertex. */
static double excess_over(const assembly *work, uint32_t face, const double normal[3],
                          uint32_t *farthest)
{
    const hull_block *hull = work->hull;
    const double *vertices = hull_vertices(hull);
    const uint32_t *loops = hull_table(hull, hull->loops);
    const uint32_t start = work->raw.starts[face];
    *farthest = climb(hull, loops[start], normal);
    double lowest = HUGE_VAL;
    for (uint32_t s = start; s < work->raw.starts[face + 1]; s++) {
        lowest = lesser(lowest, height_of(hull, vertices + 3 * (size_t)loops[s], normal));
    }
    return height_of(hull, vertices + 3 * (size_t)*farthest, normal) - lowest;
}

/* The area normal is exact to rounding but for slivers, where Qhull's, which it tested against all
 * points, is the better one. */
static void build_plane(const assembly *work, uint32_t face, double plane[4])
{
    const uint32_t start = work->raw.starts[face];
    double normal[3];
    uint32_t farthest;
    area_normal(work->set->points, work->raw.loops + start, work->raw.starts[face + 1] - start,
                normal);
    const double length = sqrt(tribo_vec3_dot(normal, normal));
    double excess = HUGE_VAL;
    if (length > 0.0) {
        tribo_vec3_scale(1.0 / length, normal, normal);
        excess = work->set->scale * excess_over(work, face, normal, &farthest);
    }
    if (!(excess <= SLIVER)) {
        const double *other = work->raw.normals + 3 * (size_t)face;
        uint32_t vertex;
        const double rest = work->set->scale * excess_over(work, face, other, &vertex);
        if (!(rest >= excess)) {
            memcpy(normal, other, sizeof normal);
            farthest = vertex;
        }
    }
    const double *v = hull_vertices(work->hull) + 3 * (size_t)farthest;
    for (int i = 0; i < 3; i++) {
        plane[i] = normal[i] + 0.0; /* no negative zeros */
    }
    plane[3] = tribo_vec3_dot(plane, v);
}

/* Distance of a face from the centre. */
static double depth_of(const hull_block *hull, const double plane[4])
{
    return plane[3] - tribo_vec3_dot(plane, hull->center);
}

/* Centroid, planes, and the balls within and around. 0 if there is no volume. */
static int measure_hull(assembly *work)
{
    hull_block *hull = work->hull;
    double *planes = own_numbers(hull, hull->planes);
    double volume;
    double center[3];
    double second[6];
    hull_moments(hull, work->set->scale, &volume, center, second);
    if (!(volume > 0.0)) {
        return 0;
    }
    tribo_vec3_add_scaled(hull->center, 1.0 / work->set->scale, center, hull->center);
    hull->inner = HUGE_VAL;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        double *plane = planes + 4 * (size_t)f;
        build_plane(work, f, plane);
        hull->inner = lesser(hull->inner, depth_of(hull, plane));
    }
    const view from = view_of(hull, work->set->scale);
    double square = 0.0;
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        double arm[3];
        relative_vertex(&from, i, arm);
        square = greater(square, tribo_vec3_dot(arm, arm));
    }
    hull->outer = sqrt(square) / work->set->scale;
    return hull->inner > 0.0;
}

/* Where the ray from the centre through an arm meets a face, but for a common factor: the greater,
 * the nearer. */
static double reach(const hull_block *hull, uint32_t face, const double arm[3])
{
    const double *plane = hull_planes(hull) + 4 * (size_t)face;
    return tribo_vec3_dot(plane, arm) / depth_of(hull, plane);
}

/* The face through which the ray along an arm leaves the hull: a climb on the polar body, whose
 * vertices are the faces. The support vertex is where it cannot be far. */
static uint32_t face_along(const assembly *work, const double arm[3])
{
    uint32_t at = hull_face_at(work->hull, hull_support(work->hull, arm), arm);
    double greatest = reach(work->hull, at, arm);
    for (;;) {
        const uint32_t here = at;
        for (uint32_t s = work->raw.starts[here]; s < work->raw.starts[here + 1]; s++) {
            const uint32_t next = work->twin_face[s];
            const double r = reach(work->hull, next, arm);
            at = r > greatest ? next : at;
            greatest = r > greatest ? r : greatest;
        }
        if (at == here) {
            return at;
        }
    }
}

/* Qhull's word that no point is left outside is not taken for it. */
static int all_are_inside(const assembly *work)
{
    const hull_block *hull = work->hull;
    const double scale = work->set->scale;
    for (size_t i = 0; i < work->set->count; i++) {
        double arm[3];
        tribo_vec3_subtract(work->points + 3 * i, hull->center, arm);
        tribo_vec3_scale(scale, arm, arm);
        const double *plane = hull_planes(hull) + 4 * (size_t)face_along(work, arm);
        if (!(tribo_vec3_dot(plane, arm) - scale * depth_of(hull, plane) <= OUTSIDE)) {
            return 0;
        }
    }
    return 1;
}

static tribo_status assemble(assembly *work)
{
    const tribo_status status = run_qhull(work->set, &work->raw);
    if (status != TRIBO_OK) {
        return status;
    }
    if (!number_vertices(work) || !allocate_block(work)) {
        return TRIBO_ERROR_MEMORY;
    }
    if (!hull_head_is_valid(work->hull)) {
        return TRIBO_ERROR_DEGENERATE;
    }
    if (loops_are_clockwise(work)) {
        reverse_loops(&work->raw);
    }
    copy_vertices(work);
    if (!build_rings(work)) {
        return TRIBO_ERROR_DEGENERATE;
    }
    build_seeds(work->hull);
    if (!measure_hull(work) || !all_are_inside(work)) {
        return TRIBO_ERROR_DEGENERATE;
    }
    work->hull->sum = hull_sum(work->hull);
    return numbers_are_valid(work->hull) ? TRIBO_OK : TRIBO_ERROR_RANGE;
}

/* ---- building -------------------------------------------------------------------------------- */

static int points_are_finite(size_t count, const double *points)
{
    for (size_t i = 0; i < count; i++) {
        if (!all_finite(points + 3 * i, 3)) {
            return 0;
        }
    }
    return 1;
}

static tribo_status deliver(const hull_block *hull, void *block, size_t capacity, size_t *needed)
{
    const size_t bytes = (size_t)hull->bytes;
    if (needed) {
        *needed = bytes;
    }
    if (capacity < bytes) {
        return TRIBO_ERROR_CAPACITY;
    }
    memcpy(block, hull, bytes);
    return TRIBO_OK;
}

tribo_status tribo_hull_build(size_t count, const double *points, void *block, size_t capacity,
                              size_t *needed)
{
    if (!points || (!block && capacity != 0)) {
        return TRIBO_ERROR_NULL;
    }
    if (count < 4 || count > MAX_POINTS) {
        return TRIBO_ERROR_RANGE;
    }
    if (!points_are_finite(count, points)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    cloud set = {.count = count};
    if (!measure(count, points, set.shift, &set.scale)) {
        return TRIBO_ERROR_DEGENERATE;
    }
    set.points = malloc(3 * count * sizeof *set.points);
    if (!set.points) {
        return TRIBO_ERROR_MEMORY;
    }
    assembly work = {.set = &set, .points = points};
    normalise(points, &set);
    tribo_status status = is_flat(&set) ? TRIBO_ERROR_DEGENERATE : assemble(&work);
    if (status == TRIBO_OK) {
        status = deliver(work.hull, block, capacity, needed);
    }
    drop_assembly(&work);
    free(set.points);
    return status;
}
