#include "cone.h"
#include "scene.h"
#include "sym3.h"

/* Where bodies come to rest on each other, their momentum goes down from each to what is under it:
 * passed on from the highest to the lowest, once, it is what contacts of a stack have to carry, and
 * the solvers have next to nothing left to do. How points share the load of one body is not given by
 * the laws of contact; here each force is as small as can be. This is a start of the solvers, no
 * answer: it is taken for islands that it brings nearer to rest than the impulses of the last
 * sub-step do, by sweeps; by others, which find stacks from nothing, where it brings all to rest. */
#define LEAN 0.125  /* least share of gravity along the normal of a contact that carries */
#define ROUNDS 4    /* of one body: points that would pull are left out in the next */
#define HINT 1e-9   /* of the greatest moment of points, against axes that have none */
#define EXACT 1e-8  /* of the forces' impulses: balanced */
#define NEARER 0.25 /* of the energy that the old impulses leave: what rolls is not to be braked */
#define NOBODY UINT32_MAX

typedef struct carrying {
    scene_run *run;
    size_t count;      /* points */
    double up[3];      /* against gravity */
    double *loads;     /* 6 per body: impulse and its moment that nothing stops yet */
    double *energies;  /* 3 per island: of bodies, of loads before and after */
    double *forces;    /* 3 per point: impulse on A, world axes */
    double *weights;   /* of points in sharing */
    uint32_t *upper;   /* of each point the body that rests on the other, or none */
    uint32_t *first;   /* of each body where its points begin in `points`; one more at the end */
    uint32_t *points;  /* by the body that they carry */
    uint32_t *above;   /* of each body: points in which it carries a body that is not done */
    uint32_t *driven;  /* of islands */
    uint32_t *waiting; /* bodies with nothing above, in the order they are done in */
} carrying;

static const tribo_scene_contact *contact_at(const carrying *w, size_t i)
{
    return scene_list(&w->run->scene->points[w->run->points_to]) + i;
}

static scene_trace *trace_at(const carrying *w, size_t i)
{
    return (scene_trace *)w->run->scene->traces.data + i;
}

static int is_movable(const carrying *w, uint32_t body)
{
    return scene_is_awake(&scene_slots(w->run->scene)[body]);
}

static int is_swept(const carrying *w)
{
    return w->run->options.solver == TRIBO_SOLVER_GAUSS_SEIDEL;
}

/* ---- memory ---------------------------------------------------------------------------------- */

static tribo_status take_memory(carrying *w)
{
    tribo_scene *s = w->run->scene;
    const size_t bodies = s->end;
    tribo_status status = scene_reserve(s, &s->loads, 9 * bodies + 4 * w->count, sizeof(double));
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->carriers, 4 * bodies + 1 + 2 * w->count, sizeof(uint32_t));
    }
    if (status != TRIBO_OK) {
        return status;
    }
    w->loads = s->loads.data;
    w->energies = w->loads + 6 * bodies;
    w->forces = w->energies + 3 * bodies;
    w->weights = w->forces + 3 * w->count;
    w->first = s->carriers.data;
    w->above = w->first + bodies + 1;
    w->driven = w->above + bodies;
    w->waiting = w->driven + bodies;
    w->upper = w->waiting + bodies;
    w->points = w->upper + w->count;
    memset(w->loads, 0, 9 * bodies * sizeof *w->loads);
    memset(w->first, 0, (3 * bodies + 1) * sizeof *w->first);
    return TRIBO_OK;
}

/* ---- what there is to carry ------------------------------------------------------------------ */

static void add_load(carrying *w, uint32_t body, double sign, const double force[3],
                     const double arm[3])
{
    double *load = w->loads + 6 * (size_t)body;
    double moment[3];
    tribo_vec3_cross(arm, force, moment);
    for (int k = 0; k < 3; k++) {
        load[k] += sign * force[k];
        load[3 + k] += sign * moment[k];
    }
}

/* Bodies' own. An axis about which nothing turns has no moment. */
static void load_bodies(carrying *w)
{
    const tribo_scene *s = w->run->scene;
    for (uint32_t i = 0; i < s->end; i++) {
        const tribo_body *body = &scene_bodies(s)[i];
        double *load = w->loads + 6 * (size_t)i;
        if (is_movable(w, i)) {
            tribo_vec3_scale(1.0 / body->inverse_mass, body->velocity, load);
            if (tribo_body_spin(body, load + 3) != TRIBO_OK) {
                memset(load + 3, 0, 3 * sizeof *load);
            }
        }
    }
}

/* What points carry already. */
static void load_points(carrying *w)
{
    for (size_t i = 0; i < w->count; i++) {
        const tribo_scene_contact *c = contact_at(w, i);
        const scene_trace *trace = trace_at(w, i);
        double *force = w->forces + 3 * i;
        double turn[3];
        memset(force, 0, 3 * sizeof *force);
        if (trace->is_held == 0) {
            continue;
        }
        tribo_mat3_apply_transposed(trace->frame, trace->start, force);
        tribo_mat3_apply_transposed(trace->frame, trace->turn, turn);
        add_load(w, c->a, 1.0, force, c->arm_a);
        add_load(w, c->b, -1.0, force, c->arm_b);
        tribo_vec3_add(w->loads + 6 * (size_t)c->a + 3, turn, w->loads + 6 * (size_t)c->a + 3);
        tribo_vec3_subtract(w->loads + 6 * (size_t)c->b + 3, turn, w->loads + 6 * (size_t)c->b + 3);
    }
}

/* Sums over islands of what loads would give bodies. */
static void add_energies(carrying *w, int which)
{
    const tribo_scene *s = w->run->scene;
    const uint32_t *parents = s->parents.data;
    for (uint32_t i = 0; i < s->end; i++) {
        const double *load = w->loads + 6 * (size_t)i;
        const double radius = scene_slots(s)[i].radius;
        if (is_movable(w, i)) {
            const double turn = radius > 0.0 ? tribo_vec3_norm(load + 3) / radius : 0.0;
            w->energies[3 * (size_t)parents[i] + (size_t)which] +=
                scene_bodies(s)[i].inverse_mass * (tribo_vec3_dot(load, load) + turn * turn);
        }
    }
}

/* Whether some island is not at rest by what it carries already. */
static int is_unbalanced(const carrying *w)
{
    for (uint32_t i = 0; i < w->run->scene->end; i++) {
        const double *e = w->energies + 3 * (size_t)i;
        if (e[1] > EXACT * EXACT * e[0]) {
            return 1;
        }
    }
    return 0;
}

/* Islands that a belt or a body that moves by itself drives do not come to rest. */
static void mark_driven(carrying *w)
{
    const tribo_scene *s = w->run->scene;
    const uint32_t *parents = s->parents.data;
    for (size_t i = 0; i < w->count; i++) {
        const tribo_scene_contact *c = contact_at(w, i);
        const double *belt = trace_at(w, i)->belt;
        const int moves = (!is_movable(w, c->a) && scene_moves(&scene_bodies(s)[c->a])) ||
                          (!is_movable(w, c->b) && scene_moves(&scene_bodies(s)[c->b]));
        if (trace_at(w, i)->is_held != 0 && (moves || belt[1] != 0.0 || belt[2] != 0.0)) {
            w->driven[parents[is_movable(w, c->a) ? c->a : c->b]] = 1;
        }
    }
}

/* ---- who rests on whom ----------------------------------------------------------------------- */

/* How far surfaces may be apart: for sweeps, so far as forces bring them together in a sub-step;
 * corners that are just open take part, or else a body would be left without its feet. */
static double gap_of(const carrying *w, const scene_trace *trace, uint32_t body)
{
    const double *kick = (const double *)w->run->scene->kicks.data + 6 * (size_t)body;
    return is_swept(w) ? trace->slop + w->run->h * tribo_vec3_norm(kick) : trace->slop;
}

/* The body that a point carries: closed, and not beside it. */
static uint32_t find_upper(const carrying *w, size_t i)
{
    const uint32_t *parents = w->run->scene->parents.data;
    const tribo_scene_contact *c = contact_at(w, i);
    const scene_trace *trace = trace_at(w, i);
    const double lean = tribo_vec3_dot(c->normal, w->up);
    const uint32_t body = lean > 0.0 ? c->a : c->b;
    if (trace->is_held == 0 || !is_movable(w, body) || !(lean > LEAN || lean < -LEAN)) {
        return NOBODY;
    }
    return c->distance <= gap_of(w, trace, body) && w->driven[parents[body]] == 0 ? body : NOBODY;
}

static uint32_t lower_of(const carrying *w, size_t i)
{
    const tribo_scene_contact *c = contact_at(w, i);
    return w->upper[i] == c->a ? c->b : c->a;
}

/* Points sorted by the bodies that they carry. */
static void sort_points(carrying *w)
{
    const uint32_t end = w->run->scene->end;
    for (size_t i = 0; i < w->count; i++) {
        w->upper[i] = find_upper(w, i);
        if (w->upper[i] != NOBODY) {
            w->first[w->upper[i] + 1]++;
            w->above[lower_of(w, i)]++;
        }
    }
    for (uint32_t i = 0; i < end; i++) {
        w->first[i + 1] += w->first[i];
    }
    const uint32_t all = w->first[end];
    for (size_t i = w->count; i-- > 0;) {
        if (w->upper[i] != NOBODY) {
            w->points[--w->first[w->upper[i] + 1]] = (uint32_t)i;
        }
    }
    /* Each start now stands one place too high. */
    memmove(w->first, w->first + 1, end * sizeof *w->first);
    w->first[end] = all;
}

/* ---- one body -------------------------------------------------------------------------------- */

/* The points under a body, as one rigid foot. */
typedef struct foot {
    uint32_t body, count;
    const uint32_t *points;
    double center[3];
    double total;      /* of weights */
    double inverse[6]; /* of the moments of inertia of weights */
} foot;

static const double *arm_of(const carrying *w, uint32_t body, uint32_t point)
{
    const tribo_scene_contact *c = contact_at(w, point);
    return c->a == body ? c->arm_a : c->arm_b;
}

static void find_center(const carrying *w, foot *f)
{
    f->total = 0.0;
    memset(f->center, 0, sizeof f->center);
    for (uint32_t i = 0; i < f->count; i++) {
        const double weight = w->weights[f->points[i]];
        tribo_vec3_add_scaled(f->center, weight, arm_of(w, f->body, f->points[i]), f->center);
        f->total += weight;
    }
    tribo_vec3_scale(f->total > 0.0 ? 1.0 / f->total : 0.0, f->center, f->center);
}

/* Axes about which points have no moment give nothing. */
static void find_moments(const carrying *w, foot *f)
{
    double m[6] = {0.0};
    for (uint32_t i = 0; i < f->count; i++) {
        const double weight = w->weights[f->points[i]];
        double d[3];
        tribo_vec3_subtract(arm_of(w, f->body, f->points[i]), f->center, d);
        m[0] += weight * (d[1] * d[1] + d[2] * d[2]);
        m[1] -= weight * (d[0] * d[1]);
        m[2] -= weight * (d[0] * d[2]);
        m[3] += weight * (d[0] * d[0] + d[2] * d[2]);
        m[4] -= weight * (d[1] * d[2]);
        m[5] += weight * (d[0] * d[0] + d[1] * d[1]);
    }
    const double hint = HINT * (m[0] + m[3] + m[5]);
    m[0] += hint;
    m[3] += hint;
    m[5] += hint;
    if (!sym3_invert(m, f->inverse)) {
        memset(f->inverse, 0, sizeof f->inverse);
    }
}

/* What is left of the load when points bear what they do. */
static void find_rest(const carrying *w, const foot *f, const double load[6], double rest[6])
{
    memcpy(rest, load, 6 * sizeof *rest);
    for (uint32_t i = 0; i < f->count; i++) {
        const double *arm = arm_of(w, f->body, f->points[i]);
        const double *force = w->forces + 3 * (size_t)f->points[i];
        const double sign = contact_at(w, f->points[i])->a == f->body ? 1.0 : -1.0;
        double moment[3];
        tribo_vec3_cross(arm, force, moment);
        tribo_vec3_add_scaled(rest, sign, force, rest);
        tribo_vec3_add_scaled(rest + 3, sign, moment, rest + 3);
    }
}

/* Points take what is left of the load by their weights: the least forces, squares over weights, of
 * all that do. */
static void share(carrying *w, foot *f, const double load[6])
{
    double rest[6];
    double moment[3];
    double turn[3];
    double each[3];
    find_rest(w, f, load, rest);
    find_center(w, f);
    find_moments(w, f);
    tribo_vec3_cross(f->center, rest, moment);
    tribo_vec3_subtract(moment, rest + 3, moment);
    tribo_sym3_apply(f->inverse, moment, turn);
    tribo_vec3_scale(f->total > 0.0 ? -1.0 / f->total : 0.0, rest, each);
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t point = f->points[i];
        const double sign = contact_at(w, point)->a == f->body ? 1.0 : -1.0;
        double *force = w->forces + 3 * (size_t)point;
        double d[3];
        double more[3];
        tribo_vec3_subtract(arm_of(w, f->body, point), f->center, d);
        tribo_vec3_cross(turn, d, more);
        tribo_vec3_add(more, each, more);
        tribo_vec3_add_scaled(force, sign * w->weights[point], more, force);
    }
}

static double push_of(const carrying *w, uint32_t point)
{
    return tribo_vec3_dot(contact_at(w, point)->normal, w->forces + 3 * (size_t)point);
}

/* Points that would pull are left out. Returns 1 if there was one. */
static int leave_out(carrying *w, const foot *f)
{
    int found = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t point = f->points[i];
        if (w->weights[point] > 0.0 && push_of(w, point) < 0.0) {
            w->weights[point] = 0.0;
            found = 1;
        }
    }
    return found;
}

static void clear(carrying *w, const foot *f)
{
    for (uint32_t i = 0; i < f->count; i++) {
        memset(w->forces + 3 * (size_t)f->points[i], 0, 3 * sizeof *w->forces);
    }
}

/* Within the cone of its point, the normal part first. */
static void clip(const scene_trace *trace, double force[3])
{
    double p[3];
    tribo_mat3_apply(trace->frame, force, p);
    const double length = planar_length(p[1], p[2]);
    const double most = p[0] > 0.0 ? trace->pair.mu_s * p[0] : 0.0;
    if (p[0] > 0.0 && length <= most) {
        return;
    }
    const double part = length > most ? most / length : 1.0;
    p[0] = p[0] > 0.0 ? p[0] : 0.0;
    p[1] *= part;
    p[2] *= part;
    tribo_mat3_apply_transposed(trace->frame, p, force);
}

/* Give the loads of both bodies what points bear, or take it back. */
static void load_feet(carrying *w, const foot *f, double sign)
{
    for (uint32_t i = 0; i < f->count; i++) {
        const tribo_scene_contact *c = contact_at(w, f->points[i]);
        const double *force = w->forces + 3 * (size_t)f->points[i];
        add_load(w, c->a, sign, force, c->arm_a);
        add_load(w, c->b, -sign, force, c->arm_b);
    }
}

/* Hand the load of a body over to the points under it: shared evenly for the pressures, then by
 * these, so that friction is where pressure is. */
static void carry_body(carrying *w, uint32_t body)
{
    foot f = {.body = body, .count = w->first[body + 1] - w->first[body]};
    const double *load = w->loads + 6 * (size_t)body;
    int pulls = 1;
    f.points = w->points + w->first[body];
    load_feet(w, &f, -1.0);
    for (uint32_t i = 0; i < f.count; i++) {
        w->weights[f.points[i]] = 1.0;
    }
    for (int round = 0; round < ROUNDS && pulls; round++) {
        clear(w, &f);
        share(w, &f, load);
        pulls = leave_out(w, &f);
    }
    for (uint32_t i = 0; i < f.count; i++) {
        w->weights[f.points[i]] = greater(push_of(w, f.points[i]), 0.0);
    }
    clear(w, &f);
    share(w, &f, load);
    share(w, &f, load);
    for (uint32_t i = 0; i < f.count; i++) {
        clip(trace_at(w, f.points[i]), w->forces + 3 * (size_t)f.points[i]);
    }
    load_feet(w, &f, 1.0);
}

static int is_balanced(const carrying *w, uint32_t body)
{
    const tribo_scene *s = w->run->scene;
    const double *load = w->loads + 6 * (size_t)body;
    const double *kick = (const double *)s->kicks.data + 6 * (size_t)body;
    const double own = tribo_vec3_norm(kick) / scene_bodies(s)[body].inverse_mass;
    return tribo_vec3_norm(load) <= EXACT * own &&
           tribo_vec3_norm(load + 3) <= EXACT * own * scene_slots(s)[body].radius;
}

/* From the top down: a body is done when all that rest on it are. Bodies that carry each other in a
 * ring are left alone. */
static void carry_all(carrying *w)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < w->run->scene->end; i++) {
        if (w->above[i] == 0 && w->first[i + 1] > w->first[i]) {
            w->waiting[count++] = i;
        }
    }
    for (uint32_t at = 0; at < count; at++) {
        const uint32_t body = w->waiting[at];
        if (!is_balanced(w, body)) {
            carry_body(w, body);
        }
        for (uint32_t i = w->first[body]; i < w->first[body + 1]; i++) {
            const uint32_t lower = lower_of(w, w->points[i]);
            if (--w->above[lower] == 0 && w->first[lower + 1] > w->first[lower]) {
                w->waiting[count++] = lower;
            }
        }
    }
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* Sweeps and coarse tolerances leave loads that nothing stops; what is solved leaves none but where
 * contacts are new. */
static int is_worth(const scene_run *run, size_t count)
{
    const scene_trace *traces = run->scene->traces.data;
    const int is_coarse =
        run->options.solver == TRIBO_SOLVER_GAUSS_SEIDEL || run->options.tolerance > EXACT;
    for (size_t i = 0; i < count; i++) {
        if (traces[i].is_held != 0 && (is_coarse || !(traces[i].start[0] > 0.0))) {
            return 1;
        }
    }
    return 0;
}

static void take_forces(carrying *w)
{
    const tribo_scene *s = w->run->scene;
    const uint32_t *parents = s->parents.data;
    for (size_t i = 0; i < w->count; i++) {
        if (w->upper[i] == NOBODY) {
            continue;
        }
        const double *e = w->energies + 3 * (size_t)parents[w->upper[i]];
        if (is_swept(w) ? e[2] < NEARER * e[1] : e[2] <= EXACT * EXACT * e[0]) {
            tribo_mat3_apply(trace_at(w, i)->frame, w->forces + 3 * i, trace_at(w, i)->start);
        }
    }
}

/* Starts of contacts that are held. */
tribo_status scene_carry_weight(scene_run *run)
{
    tribo_scene *s = run->scene;
    const double *gravity = s->settings.gravity;
    const double strength = tribo_vec3_norm(gravity);
    carrying w = {.run = run, .count = s->points[run->points_to].count};
    if (!(strength > 0.0) || (run->options.skip & TRIBO_SKIP_WARM_START) ||
        !is_worth(run, w.count)) {
        return TRIBO_OK;
    }
    tribo_status status = scene_join_islands(run);
    if (status == TRIBO_OK) {
        status = take_memory(&w);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    tribo_vec3_scale(-1.0 / strength, gravity, w.up);
    load_bodies(&w);
    add_energies(&w, 0);
    load_points(&w);
    add_energies(&w, 1);
    if (!is_unbalanced(&w)) {
        return TRIBO_OK;
    }
    mark_driven(&w);
    sort_points(&w);
    carry_all(&w);
    add_energies(&w, 2);
    take_forces(&w);
    return TRIBO_OK;
}
