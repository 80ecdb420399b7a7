/* Depth of penetration by separating axes, feature distances and golden sections. */
#include "truth.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- vectors
 * ---------------------------------------------------------------------------------- */

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *c)
{
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    c[0] = x;
    c[1] = y;
    c[2] = z;
}

static void minus(const double *a, const double *b, double *c)
{
    for (int i = 0; i < 3; i++) {
        c[i] = a[i] - b[i];
    }
}

static double normalize(double *v)
{
    const double size = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++) {
        v[i] /= size;
    }
    return size;
}

static void to_world(const truth_body *body, const double *v, double *out)
{
    const double *r = body->rotation;
    const double x[3] = {v[0], v[1], v[2]};
    for (int i = 0; i < 3; i++) {
        out[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
    }
}

static void to_local(const truth_body *body, const double *v, double *out)
{
    const double *r = body->rotation;
    const double x[3] = {v[0], v[1], v[2]};
    for (int i = 0; i < 3; i++) {
        out[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
    }
}

/* ---- polytopes
 * ---------------------------------------------------------------------------------- */

static void add_vertex(truth_polytope *p, const double *vertex)
{
    for (int c = 0; c < 3; c++) {
        p->vertex[p->vertices][c] = vertex[c];
        p->across[c][p->vertices] = vertex[c];
    }
    p->vertices++;
}

static int find_edge(const truth_polytope *p, int a, int b)
{
    for (int k = 0; k < p->edges; k++) {
        if ((p->edge[k][0] == a && p->edge[k][1] == b) ||
            (p->edge[k][0] == b && p->edge[k][1] == a)) {
            return k;
        }
    }
    return -1;
}

/* Enters the sides of a face into the table of edges. */
static void enter_edges(truth_polytope *p, int face, int sides)
{
    for (int i = 0; i < sides; i++) {
        const int a = p->corner[face][i];
        const int b = p->corner[face][(i + 1) % sides];
        const int known = find_edge(p, a, b);
        if (known >= 0) {
            p->edge[known][3] = face;
        } else {
            int *edge = p->edge[p->edges++];
            edge[0] = a;
            edge[1] = b;
            edge[2] = face;
            edge[3] = -1;
        }
    }
}

/* The vertex c for which all others lie below the plane a b c, seen from outside
 * counter-clockwise. */
static int third(const truth_polytope *p, int a, int b, double *normal)
{
    int c = -1;
    double ab[3];
    minus(p->vertex[b], p->vertex[a], ab);
    for (int k = 0; k < p->vertices; k++) {
        double ak[3];
        if (k == a || k == b) {
            continue;
        }
        minus(p->vertex[k], p->vertex[a], ak);
        if (c < 0 || dot(normal, ak) > 0.0) {
            c = k;
            cross(ab, ak, normal);
        }
    }
    return c;
}

static void add_triangle(truth_polytope *p, int a, int b, int c, const double *normal)
{
    const int face = p->faces++;
    p->corner[face][0] = a;
    p->corner[face][1] = b;
    p->corner[face][2] = c;
    p->corner[face][3] = -1;
    memcpy(p->normal[face], normal, sizeof p->normal[face]);
    normalize(p->normal[face]);
    enter_edges(p, face, 3);
}

/* Lowest vertex in z and the one that makes the flattest edge with it: an edge of the hull. */
static void first_edge(const truth_polytope *p, int *a, int *b)
{
    double flattest = HUGE_VAL;
    *a = 0;
    for (int i = 1; i < p->vertices; i++) {
        *a = p->vertex[i][2] < p->vertex[*a][2] ? i : *a;
    }
    *b = *a;
    for (int i = 0; i < p->vertices; i++) {
        double d[3];
        minus(p->vertex[i], p->vertex[*a], d);
        /* rise per advance in x: the least is an edge of the shadow on the xz plane */
        const double rise = d[0] > 0.0 ? d[2] / d[0] : HUGE_VAL;
        if (i != *a && rise < flattest) {
            flattest = rise;
            *b = i;
        }
    }
}

int truth_wrap(int count, const double *points, truth_polytope *out)
{
    int a;
    int b;
    double normal[3] = {0.0, 0.0, 0.0};
    memset(out, 0, sizeof *out);
    for (int i = 0; i < count; i++) {
        add_vertex(out, points + 3 * i);
    }
    first_edge(out, &a, &b);
    const int c = third(out, a, b, normal);
    if (a == b || c < 0) {
        return 0;
    }
    add_triangle(out, a, b, c, normal);
    for (int k = 0; k < out->edges; k++) {
        if (out->edge[k][3] >= 0) {
            continue;
        }
        if (out->edges + 2 > TRUTH_EDGES || out->faces >= TRUTH_FACES) {
            return 0;
        }
        /* the other face runs along the edge the other way */
        const int from = out->edge[k][1];
        const int to = out->edge[k][0];
        add_triangle(out, from, to, third(out, from, to, normal), normal);
    }
    return out->vertices - out->edges + out->faces == 2;
}

static void box_core(const double *half, truth_polytope *out)
{
    for (int i = 0; i < 8; i++) {
        const double corner[3] = {i % 2 != 0 ? half[0] : -half[0],
                                  (i >> 1) % 2 != 0 ? half[1] : -half[1],
                                  (i >> 2) % 2 != 0 ? half[2] : -half[2]};
        add_vertex(out, corner);
    }
    for (int f = 0; f < 6; f++) {
        const int axis = f / 2;
        const int u = 1 << (axis + 1) % 3;
        const int v = 1 << (axis + 2) % 3;
        const int base = f % 2 << axis;
        const int round[2][4] = {{base, base + v, base + u + v, base + u},
                                 {base, base + u, base + u + v, base + v}};
        out->normal[f][axis] = f % 2 != 0 ? 1.0 : -1.0;
        memcpy(out->corner[f], round[f % 2], sizeof out->corner[f]);
        out->faces++;
        enter_edges(out, f, 4);
    }
}

void truth_core(uint32_t type, const double *size, truth_polytope *out)
{
    memset(out, 0, sizeof *out);
    if (type == TRIBO_SHAPE_BOX) {
        box_core(size, out);
        return;
    }
    const double half = type == TRIBO_SHAPE_CAPSULE ? size[1] : 0.0;
    const double ends[2][3] = {{0.0, 0.0, -half}, {0.0, 0.0, half}};
    add_vertex(out, ends[0]);
    if (type == TRIBO_SHAPE_CAPSULE) {
        add_vertex(out, ends[1]);
        out->edges = 1;
        out->edge[0][1] = 1;
        out->edge[0][2] = out->edge[0][3] = -1;
    }
}

/* ---- width
 * -------------------------------------------------------------------------------------- */

/* Most of the time of all truths is spent here, in loops that compilers take two by two. */
static double reach_of_core(const truth_polytope *core, const double *n)
{
    double along[TRUTH_VERTICES];
    int count = core->vertices;
    for (int i = 0; i < count; i++) {
        along[i] =
            n[0] * core->across[0][i] + n[1] * core->across[1][i] + n[2] * core->across[2][i];
    }
    while (count > 1) {
        const int half = (count + 1) / 2;
        const double *other = along + half;
        for (int i = 0; i < count - half; i++) {
            along[i] = other[i] > along[i] ? other[i] : along[i];
        }
        count = half;
    }
    return along[0];
}

/* Largest n . x of a body about its position, n in its own axes. */
static double reach_local(const truth_body *body, const double *n)
{
    const double *s = body->size;
    const double flat = sqrt(n[0] * n[0] + n[1] * n[1]);
    switch (body->type) {
    case TRIBO_SHAPE_CYLINDER:
        return s[0] * flat + s[1] * fabs(n[2]);
    case TRIBO_SHAPE_CONE:
        return fmax(s[0] * flat - s[1] * n[2], s[1] * n[2]);
    case TRIBO_SHAPE_ELLIPSOID:
        return sqrt(s[0] * s[0] * n[0] * n[0] + s[1] * s[1] * n[1] * n[1] +
                    s[2] * s[2] * n[2] * n[2]);
    default:
        return reach_of_core(body->core, n) + body->radius * sqrt(dot(n, n));
    }
}

static double reach(const truth_body *body, const double *n, double sign)
{
    double local[3];
    to_local(body, n, local);
    for (int i = 0; i < 3; i++) {
        local[i] *= sign;
    }
    return reach_local(body, local);
}

double truth_width(const truth_body *a, const truth_body *b, const double n[3])
{
    double between[3];
    minus(b->position, a->position, between);
    return dot(between, n) + reach(a, n, -1.0) + reach(b, n, 1.0);
}

static void least(const truth_body *a, const truth_body *b, const double *n, double *width,
                  double *normal)
{
    const double w = truth_width(a, b, n);
    if (w < *width) {
        *width = w;
        memcpy(normal, n, 3 * sizeof *n);
    }
}

/* ---- separating axes
 * ---------------------------------------------------------------------------- */

/* Whether some vertex of a body lies farther along n, world axes, than `limit` from its position. */
static int is_beyond(const truth_body *body, const double *n, double limit)
{
    double local[3];
    to_local(body, n, local);
    for (int i = 0; body->core != NULL && i < body->core->vertices; i++) {
        if (dot(local, body->core->vertex[i]) > limit) {
            return 1;
        }
    }
    return 0;
}

/* The faces of A (side 0) or B. Most of them are told by one vertex of the other body that lies too
 * far behind. */
static void try_faces(const truth_body *a, const truth_body *b, int side, double *width,
                      double *normal)
{
    const truth_body *owner = side == 0 ? a : b;
    const truth_body *other = side == 0 ? b : a;
    double between[3];
    minus(other->position, owner->position, between);
    for (int f = 0; f < owner->core->faces; f++) {
        const double own =
            dot(owner->core->normal[f], owner->core->vertex[owner->core->corner[f][0]]);
        double out[3];
        to_world(owner, owner->core->normal[f], out);
        const double back[3] = {-out[0], -out[1], -out[2]};
        const double room = 1e-9 * fabs(own); /* more than rounding */
        if (!is_beyond(other, back, *width + dot(between, out) - own + room)) {
            least(a, b, side == 0 ? back : out, width, normal);
        }
    }
}

typedef struct world_edge {
    double along[3];
    double square;    /* of its length */
    double middle[3]; /* half-way between the normals of both faces, towards the other body */
    double cosine;    /* of the angle between it and either of them */
    double sine;
    int bare; /* a segment: its arc is the whole circle */
} world_edge;

static int world_edges(const truth_body *body, double sign, world_edge *out)
{
    const truth_polytope *core = body->core;
    for (int k = 0; k < core->edges; k++) {
        const int *edge = core->edge[k];
        world_edge *w = &out[k];
        double from[3];
        double to[3];
        double arc[2][3];
        to_world(body, core->vertex[edge[0]], from);
        to_world(body, core->vertex[edge[1]], to);
        minus(to, from, w->along);
        w->square = dot(w->along, w->along);
        w->bare = edge[2] < 0;
        memset(w->middle, 0, sizeof w->middle);
        w->cosine = 0.0;
        w->sine = 1.0;
        if (!w->bare) {
            to_world(body, core->normal[edge[2]], arc[0]);
            to_world(body, core->normal[edge[3]], arc[1]);
            for (int i = 0; i < 3; i++) {
                w->middle[i] = sign * (arc[0][i] + arc[1][i]);
            }
            normalize(w->middle);
            w->cosine = fmin(sign * dot(w->middle, arc[0]), 1.0);
            w->sine = sqrt(1.0 - w->cosine * w->cosine);
        }
    }
    return core->edges;
}

/* Whether the unit vector n, which lies in the plane of the arc of an edge, lies on the arc, with
 * room for rounding. */
static int on_arc(const world_edge *e, const double *n)
{
    return e->bare || dot(e->middle, n) >= e->cosine - 1e-9;
}

/* Whether two arcs come near enough to each other to cross: their middles are no farther apart than
 * both halves. */
static int may_cross(const world_edge *e, const world_edge *f)
{
    const double both = e->cosine * f->cosine - e->sine * f->sine;
    return e->bare || f->bare || dot(e->middle, f->middle) >= both - 1e-6;
}

static void try_edges(const truth_body *a, const truth_body *b, double *width, double *normal)
{
    world_edge ea[TRUTH_EDGES];
    world_edge eb[TRUTH_EDGES];
    const int na = world_edges(a, -1.0, ea);
    const int nb = world_edges(b, 1.0, eb);
    double between[3];
    minus(b->position, a->position, between);
    for (int i = 0; i < na; i++) {
        for (int j = 0; j < nb; j++) {
            double n[3];
            if (!may_cross(&ea[i], &eb[j])) {
                continue;
            }
            cross(ea[i].along, eb[j].along, n);
            const double square = dot(n, n);
            if (square <= 1e-24 * ea[i].square * eb[j].square) {
                continue;
            }
            const double sign = dot(n, ea[i].middle) >= 0.0 ? 1.0 : -1.0;
            for (int side = 0; side < (ea[i].bare ? 2 : 1); side++) {
                const double scale = (side == 0 ? sign : -sign) / sqrt(square);
                const double m[3] = {scale * n[0], scale * n[1], scale * n[2]};
                if (on_arc(&ea[i], m) && on_arc(&eb[j], m)) {
                    least(a, b, m, width, normal);
                }
            }
        }
    }
}

/* ---- distances of polytopes
 * --------------------------------------------------------------------- */

/* Where cores nearly meet, the difference of two points says little of the direction between them:
 * all of it is done in long double, and the direction made square to the edges that it belongs to. */
typedef long double real;

static real real_dot(const real *a, const real *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void real_cross(const real *a, const real *b, real *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void real_minus(const real *a, const real *b, real *c)
{
    for (int i = 0; i < 3; i++) {
        c[i] = a[i] - b[i];
    }
}

/* c = a x b of vectors that may be nearly parallel: what is left of it is square to a. */
static void real_square(const real *a, const real *b, real *c)
{
    real_cross(a, b, c);
    const real left = real_dot(a, c) / real_dot(a, a);
    for (int i = 0; i < 3; i++) {
        c[i] -= left * a[i];
    }
}

static void real_world(const truth_body *body, const double *v, real *out)
{
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0L;
        for (int k = 0; k < 3; k++) {
            out[i] += (real)body->rotation[3 * i + k] * (real)v[k];
        }
    }
}

/* What was seen of two cores. */
typedef struct distances {
    real gap; /* least, and its direction */
    double normal[3];
    const truth_body *a; /* not null: every direction is tried, the least width kept */
    const truth_body *b;
    double width;
    double best[3];
} distances;

static void nearer(real size, const real *along, distances *d)
{
    const real norm = sqrtl(real_dot(along, along));
    double n[3];
    if (!(norm > 0.0L)) {
        d->gap = 0.0L; /* they meet: no direction */
        return;
    }
    for (int i = 0; i < 3; i++) {
        n[i] = (double)(along[i] / norm);
    }
    if (size < d->gap) {
        d->gap = size;
        memcpy(d->normal, n, sizeof n);
    }
    if (d->a != NULL) {
        least(d->a, d->b, n, &d->width, d->best);
    }
}

/* From the point on the segment q + t f nearest to p, to p; `sign` -1 turns it round. */
static void point_segment(const real *p, const real *q, const real *f, real sign, distances *d)
{
    real r[3];
    real apart[3];
    real_minus(p, q, r);
    const real ff = real_dot(f, f);
    const real share = ff > 0.0L ? real_dot(f, r) / ff : 0.0L;
    const real t = share < 0.0L ? 0.0L : share > 1.0L ? 1.0L : share;
    for (int i = 0; i < 3; i++) {
        apart[i] = sign * (r[i] - t * f[i]);
    }
    const real size = sqrtl(real_dot(apart, apart));
    if (share == t && ff > 0.0L) {
        const real left = real_dot(f, apart) / ff;
        for (int i = 0; i < 3; i++) {
            apart[i] -= left * f[i];
        }
    }
    nearer(size, apart, d);
}

/* From the segment q + t f to the segment p + s e: all ends against the other segment, and where
 * both are crossed inside by the line square to both. */
static void segments(const real *p, const real *e, const real *q, const real *f, distances *d)
{
    real r[3];
    real ends[2][3];
    real c[3];
    real rf[3];
    real re[3];
    for (int i = 0; i < 3; i++) {
        r[i] = p[i] - q[i];
        ends[0][i] = p[i] + e[i];
        ends[1][i] = q[i] + f[i];
    }
    point_segment(p, q, f, 1.0L, d);
    point_segment(ends[0], q, f, 1.0L, d);
    point_segment(q, p, e, -1.0L, d);
    point_segment(ends[1], p, e, -1.0L, d);
    real_square(e, f, c);
    real_cross(r, f, rf);
    real_cross(r, e, re);
    const real square = real_dot(c, c);
    if (!(square > 1e-26L * real_dot(e, e) * real_dot(f, f))) {
        return;
    }
    const real s = 0.0L - real_dot(rf, c) / square;
    const real t = 0.0L - real_dot(re, c) / square;
    if (s >= 0.0L && s <= 1.0L && t >= 0.0L && t <= 1.0L) {
        const real apart = real_dot(r, c) / sqrtl(square);
        const real sign = apart < 0.0L ? -1.0L : 1.0L;
        const real along[3] = {sign * c[0], sign * c[1], sign * c[2]};
        nearer(sign * apart, along, d);
    }
}

/* A point against the inside of all faces of the other body; `sign` 1 if the point is of A. */
static void point_faces(const real *point, const truth_body *body, real sign, distances *out)
{
    const truth_polytope *core = body->core;
    real x[3];
    for (int i = 0; i < 3; i++) {
        x[i] = 0.0L;
        for (int k = 0; k < 3; k++) {
            x[i] += (real)body->rotation[3 * k + i] * point[k];
        }
    }
    for (int f = 0; f < core->faces; f++) {
        const int sides = core->corner[f][3] < 0 ? 3 : 4;
        const real n[3] = {(real)core->normal[f][0], (real)core->normal[f][1],
                           (real)core->normal[f][2]};
        const double *first = core->vertex[core->corner[f][0]];
        real d[3] = {x[0] - (real)first[0], x[1] - (real)first[1], x[2] - (real)first[2]};
        const real height = real_dot(n, d);
        int inside = height > 0.0L;
        for (int i = 0; i < sides && inside; i++) {
            const double *from = core->vertex[core->corner[f][i]];
            const double *to = core->vertex[core->corner[f][(i + 1) % sides]];
            real e[3];
            real across[3];
            for (int c = 0; c < 3; c++) {
                e[c] = (real)to[c] - (real)from[c];
                d[c] = x[c] - (real)from[c];
            }
            real_cross(n, e, across);
            inside = real_dot(across, d) >= 0.0L;
        }
        if (inside) {
            real along[3];
            real_world(body, core->normal[f], along);
            for (int i = 0; i < 3; i++) {
                along[i] *= sign;
            }
            nearer(height, along, out);
        }
    }
}

/* Edges as point and direction; a lone point is an edge of no length. */
static int feature_edges(const truth_body *body, real from[][3], real along[][3])
{
    const truth_polytope *core = body->core;
    for (int k = 0; k < core->edges; k++) {
        real to[3];
        real_world(body, core->vertex[core->edge[k][0]], from[k]);
        real_world(body, core->vertex[core->edge[k][1]], to);
        real_minus(to, from[k], along[k]);
        for (int i = 0; i < 3; i++) {
            from[k][i] += (real)body->position[i];
        }
    }
    if (core->edges == 0) {
        for (int i = 0; i < 3; i++) {
            from[0][i] = (real)body->position[i];
            along[0][i] = 0.0L;
        }
        return 1;
    }
    return core->edges;
}

static void vertices_faces(const truth_body *a, const truth_body *b, real sign, distances *d)
{
    for (int i = 0; i < a->core->vertices; i++) {
        real point[3];
        real_world(a, a->core->vertex[i], point);
        for (int c = 0; c < 3; c++) {
            point[c] += (real)a->position[c] - (real)b->position[c];
        }
        point_faces(point, b, sign, d);
    }
}

static int full(const truth_body *body)
{
    return body->core->faces > 0;
}

/* Least distance of two cores that are apart. */
static void core_gap(const truth_body *a, const truth_body *b, distances *d)
{
    real from_a[TRUTH_EDGES][3];
    real along_a[TRUTH_EDGES][3];
    real from_b[TRUTH_EDGES][3];
    real along_b[TRUTH_EDGES][3];
    memset(d, 0, sizeof *d);
    d->gap = (real)HUGE_VAL;
    d->width = HUGE_VAL;
    d->a = full(a) || full(b) ? NULL : a;
    d->b = b;
    const int na = feature_edges(a, from_a, along_a);
    const int nb = feature_edges(b, from_b, along_b);
    for (int i = 0; i < na; i++) {
        for (int j = 0; j < nb; j++) {
            segments(from_a[i], along_a[i], from_b[j], along_b[j], d);
        }
    }
    vertices_faces(a, b, 1.0L, d);
    vertices_faces(b, a, -1.0L, d);
}

static void both_ways(const truth_body *a, const truth_body *b, const real *v, double *width,
                      double *normal)
{
    const real norm = sqrtl(real_dot(v, v));
    for (int side = 0; side < 2 && norm > 1e-300L; side++) {
        const real scale = (side == 0 ? 1.0L : -1.0L) / norm;
        const double n[3] = {(double)(scale * v[0]), (double)(scale * v[1]),
                             (double)(scale * v[2])};
        least(a, b, n, width, normal);
    }
}

/* Directions square to two segments or points that meet, or nearly: there the difference of nearest
 * points has no direction to speak of. */
static void try_squares(const truth_body *a, const truth_body *b, double *width, double *normal)
{
    real between[3];
    real n[3];
    real axis[4][3];
    for (int i = 0; i < 3; i++) {
        between[i] = (real)b->position[i] - (real)a->position[i];
        for (int k = 0; k < 4; k++) {
            axis[k][i] = (real)(k % 2 == 0 ? a : b)->rotation[3 * i + (k < 2 ? 2 : 0)];
        }
    }
    for (int i = 0; i < 4; i++) {
        both_ways(a, b, axis[i], width, normal);
        for (int j = 0; j < i; j++) {
            real_square(axis[i], axis[j], n);
            both_ways(a, b, n, width, normal);
        }
        real side[3];
        real_cross(between, axis[i], side);
        real_cross(side, axis[i], n);
        both_ways(a, b, n, width, normal);
    }
}

static double rounded_polytopes(const truth_body *a, const truth_body *b, double *normal)
{
    double width = HUGE_VAL;
    distances d;
    if (full(a) || full(b)) {
        try_faces(a, b, 0, &width, normal);
        try_faces(a, b, 1, &width, normal);
        try_edges(a, b, &width, normal);
    }
    if (width >= a->radius + b->radius && width < HUGE_VAL) {
        return width; /* the cores overlap */
    }
    core_gap(a, b, &d);
    if (d.gap > 0.0L && d.gap < (real)HUGE_VAL) {
        least(a, b, d.normal, &width, normal);
    }
    if (d.a != NULL) {
        if (d.width < width) {
            width = d.width;
            memcpy(normal, d.best, sizeof d.best);
        }
        try_squares(a, b, &width, normal);
    } else if (d.gap < 1e-6L * (real)(a->radius + b->radius)) {
        try_squares(a, b, &width, normal);
    }
    return width;
}

/* ---- a point against a curved body
 * -------------------------------------------------------------- */

/* Nearest point to (x, y) of the boundary of a convex polygon, counter-clockwise, whose first
 * side is the axis x = 0 and no boundary: outward normal there. */
static void polygon_normal(int count, double corner[][2], const double *x, double *normal)
{
    double deepest = -HUGE_VAL;
    double gap = HUGE_VAL;
    double inner[2] = {0.0, 0.0};
    for (int i = 1; i < count; i++) {
        const double *p = corner[i];
        const double *q = corner[(i + 1) % count];
        const double e[2] = {q[0] - p[0], q[1] - p[1]};
        const double size = hypot(e[0], e[1]);
        const double n[2] = {e[1] / size, -e[0] / size};
        const double height = n[0] * (x[0] - p[0]) + n[1] * (x[1] - p[1]);
        const double t = ((x[0] - p[0]) * e[0] + (x[1] - p[1]) * e[1]) / (size * size);
        const double s = fmin(fmax(t, 0.0), 1.0);
        const double d[2] = {x[0] - p[0] - s * e[0], x[1] - p[1] - s * e[1]};
        if (height > deepest) {
            deepest = height;
            memcpy(inner, n, sizeof inner);
        }
        if (hypot(d[0], d[1]) < gap) {
            gap = hypot(d[0], d[1]);
            const int foot = t >= 0.0 && t <= 1.0;
            normal[0] = foot || gap == 0.0 ? n[0] : d[0] / gap;
            normal[1] = foot || gap == 0.0 ? n[1] : d[1] / gap;
        }
    }
    if (deepest <= 0.0) {
        memcpy(normal, inner, sizeof inner);
    }
}

static void turned_normal(const truth_body *body, const double *x, double *normal)
{
    const double r = body->size[0];
    const double h = body->size[1];
    double cylinder[4][2] = {{0.0, h}, {0.0, -h}, {r, -h}, {r, h}};
    double cone[3][2] = {{0.0, h}, {0.0, -h}, {r, -h}};
    const double flat = hypot(x[0], x[1]);
    const double at[2] = {flat, x[2]};
    double n[2] = {1.0, 0.0};
    if (body->type == TRIBO_SHAPE_CYLINDER) {
        polygon_normal(4, cylinder, at, n);
    } else {
        polygon_normal(3, cone, at, n);
    }
    normal[0] = flat > 0.0 ? n[0] * x[0] / flat : n[0];
    normal[1] = flat > 0.0 ? n[0] * x[1] / flat : 0.0;
    normal[2] = n[1];
}

/* The multiplier t of the nearest point s^2 x / (s^2 + t) is the greatest root of a decreasing
 * function (Eberly 2013): bisection between -min s^2 and |s x|. */
static void ellipsoid_normal(const truth_body *body, const double *x, double *normal)
{
    const double *s = body->size;
    const double smallest = fmin(s[0], fmin(s[1], s[2]));
    double low = -smallest * smallest;
    double high = 0.0;
    for (int i = 0; i < 3; i++) {
        high += s[i] * s[i] * x[i] * x[i];
    }
    high = sqrt(high);
    for (int k = 0; k < 200 && low < high; k++) {
        const double t = 0.5 * (low + high);
        double f = -1.0;
        for (int i = 0; i < 3; i++) {
            const double g = s[i] * x[i] / (s[i] * s[i] + t);
            f += g * g;
        }
        if (f > 0.0) {
            low = t;
        } else {
            high = t;
        }
    }
    double rest = 1.0;
    for (int i = 0; i < 3; i++) {
        const double share = s[i] * s[i] + 0.5 * (low + high);
        normal[i] = share > 0.0 ? x[i] / share : 0.0;
        rest -= share > 0.0 ? s[i] * s[i] * normal[i] * normal[i] : 0.0;
    }
    /* the middle of the shortest axis: the foot leaves the plane x lies in */
    for (int i = 0; i < 3 && low <= -smallest * smallest; i++) {
        if (s[i] <= smallest) {
            normal[i] = sqrt(fmax(rest, 0.0)) / s[i];
            break;
        }
    }
    normalize(normal);
}

/* Sphere against a cylinder, cone or ellipsoid. */
static double against_sphere(const truth_body *a, const truth_body *b, double *normal)
{
    const truth_body *body = a->type == TRIBO_SHAPE_SPHERE ? b : a;
    const truth_body *ball = a->type == TRIBO_SHAPE_SPHERE ? a : b;
    double x[3];
    double n[3];
    minus(ball->position, body->position, x);
    to_local(body, x, x);
    if (body->type == TRIBO_SHAPE_ELLIPSOID) {
        ellipsoid_normal(body, x, n);
    } else {
        turned_normal(body, x, n);
    }
    to_world(body, n, n);
    for (int i = 0; i < 3; i++) {
        normal[i] = ball == a ? n[i] : -n[i];
    }
    return truth_width(a, b, normal);
}

/* ---- all else
 * ----------------------------------------------------------------------------------- */

enum { SPREAD = 500, STARTS = 5, COARSE = 16, FINE = 30 };

typedef struct chart {
    const truth_body *a;
    const truth_body *b;
    double n[3];
    double u[3];
    double v[3];
    double radius;
    int sections;
    double width; /* the least seen, at `best` */
    double best[3];
} chart;

static double width_at(chart *c, double x, double y)
{
    double m[3];
    for (int i = 0; i < 3; i++) {
        m[i] = c->n[i] + x * c->u[i] + y * c->v[i];
    }
    normalize(m);
    const double width = truth_width(c->a, c->b, m);
    if (width < c->width) {
        c->width = width;
        memcpy(c->best, m, sizeof m);
    }
    return width;
}

static double golden(chart *c, double (*f)(chart *, double, double), double fixed)
{
    const double share = 0.6180339887498949;
    double low = -c->radius;
    double high = c->radius;
    double p = high - share * (high - low);
    double q = low + share * (high - low);
    double fp = f(c, fixed, p);
    double fq = f(c, fixed, q);
    for (int i = 0; i < c->sections; i++) {
        if (fp < fq) {
            high = q;
            q = p;
            fq = fp;
            p = high - share * (high - low);
            fp = f(c, fixed, p);
        } else {
            low = p;
            p = q;
            fp = fq;
            q = low + share * (high - low);
            fq = f(c, fixed, q);
        }
    }
    return fmin(fp, fq);
}

static double along_line(chart *c, double unused, double x)
{
    (void)unused;
    return golden(c, width_at, x);
}

/* The body with those vertices alone that are farthest along some direction within the square of
 * half-width `spread` about n, seen from the body (sign 1) or towards it. */
static void narrow(const truth_body *body, const double *n, double sign, double spread,
                   truth_polytope *core, truth_body *out)
{
    double local[3];
    double most = -HUGE_VAL;
    *out = *body;
    if (body->core == NULL) {
        return;
    }
    to_local(body, n, local);
    const double turn = 1.5 * spread; /* above the root of 2 */
    for (int i = 0; i < body->core->vertices; i++) {
        const double *v = body->core->vertex[i];
        most = fmax(most, sign * dot(local, v) - turn * sqrt(dot(v, v)));
    }
    core->vertices = 0;
    for (int i = 0; i < body->core->vertices; i++) {
        const double *v = body->core->vertex[i];
        if (sign * dot(local, v) + turn * sqrt(dot(v, v)) >= most) {
            add_vertex(core, v);
        }
    }
    out->core = core;
}

static double polish(const truth_body *a, const truth_body *b, double spread, int sections,
                     double normal[3])
{
    truth_polytope cores[2];
    truth_body near_a;
    truth_body near_b;
    chart c;
    narrow(a, normal, -1.0, spread, &cores[0], &near_a);
    narrow(b, normal, 1.0, spread, &cores[1], &near_b);
    c.a = &near_a;
    c.b = &near_b;
    c.radius = spread;
    c.sections = sections;
    const int flat = fabs(normal[0]) < 0.6 ? 0 : 1;
    double helper[3] = {0.0, 0.0, 0.0};
    helper[flat] = 1.0;
    memcpy(c.n, normal, sizeof c.n);
    memcpy(c.best, normal, sizeof c.best);
    cross(c.n, helper, c.u);
    normalize(c.u);
    cross(c.n, c.u, c.v);
    c.width = truth_width(a, b, normal);
    (void)golden(&c, along_line, 0.0);
    memcpy(normal, c.best, sizeof c.best);
    return c.width;
}

double truth_polish(const truth_body *a, const truth_body *b, double spread, double normal[3])
{
    return polish(a, b, spread, FINE, normal);
}

/* The best directions of an even spread (a spiral by the golden angle), no two near each other. */
static int spread_starts(const truth_body *a, const truth_body *b, double start[STARTS][3])
{
    double width[SPREAD];
    double way[SPREAD][3];
    for (int i = 0; i < SPREAD; i++) {
        const double z = 1.0 - (2.0 * i + 1.0) / SPREAD;
        const double turn = 2.399963229728653 * i;
        way[i][0] = sqrt(1.0 - z * z) * cos(turn);
        way[i][1] = sqrt(1.0 - z * z) * sin(turn);
        way[i][2] = z;
        width[i] = truth_width(a, b, way[i]);
    }
    int count = 0;
    while (count < STARTS) {
        int best = 0;
        for (int i = 1; i < SPREAD; i++) {
            best = width[i] < width[best] ? i : best;
        }
        if (!(width[best] < HUGE_VAL)) {
            break;
        }
        memcpy(start[count], way[best], sizeof way[best]);
        for (int i = 0; i < SPREAD; i++) {
            width[i] = dot(way[i], start[count]) > 0.95 ? HUGE_VAL : width[i];
        }
        count++;
    }
    return count;
}

static void try_axes(const truth_body *a, const truth_body *b, double *width, double *normal)
{
    double axis[6][3];
    for (int i = 0; i < 6; i++) {
        const double *r = i < 3 ? a->rotation : b->rotation;
        for (int c = 0; c < 3; c++) {
            axis[i][c] = r[3 * c + i % 3];
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j <= i; j++) {
            double n[3];
            cross(axis[i], axis[j], n);
            if (i == j) {
                memcpy(n, axis[i], sizeof n);
            } else if (normalize(n) < 1e-9) {
                continue; /* parallel */
            }
            const double back[3] = {-n[0], -n[1], -n[2]};
            least(a, b, n, width, normal);
            least(a, b, back, width, normal);
        }
    }
}

static double by_sections(const truth_body *a, const truth_body *b, double *normal)
{
    double start[STARTS][3];
    double width = HUGE_VAL;
    try_axes(a, b, &width, normal);
    if (a->core != NULL) {
        try_faces(a, b, 0, &width, normal);
    }
    if (b->core != NULL) {
        try_faces(a, b, 1, &width, normal);
    }
    const int count = spread_starts(a, b, start);
    for (int i = 0; i < count; i++) {
        (void)polish(a, b, 0.2, COARSE, start[i]);
        least(a, b, start[i], &width, normal);
    }
    (void)polish(a, b, 1e-2, FINE, normal);
    return polish(a, b, 1e-6, FINE, normal);
}

double truth_least(const truth_body *a, const truth_body *b, double normal[3])
{
    if (a->core != NULL && b->core != NULL) {
        return rounded_polytopes(a, b, normal);
    }
    if (a->type == TRIBO_SHAPE_SPHERE || b->type == TRIBO_SHAPE_SPHERE) {
        return against_sphere(a, b, normal);
    }
    return by_sections(a, b, normal);
}
