#include "scene.h"

#define PARTING_TOLERANCE 1e-3 /* of moves that are a share of an overlap anyway, */
#define PARTING_ITERATIONS 32u /* and that the next sub-step goes on with */
#define PARTING_SHARE 0.25
#define CLOSED 0x1p-10 /* of the overlap that is left alone: a gap by rounding */
#define MAX_PASSES 16
#define MAX_IMPACTS 64      /* passes of these */
#define AT_ONCE 0.0625      /* of a sub-step: impacts that are no more apart share a pass */
#define DENSE_UNKNOWNS 192u /* up to here the solvers factor without help */

/* ---- calling tribo_system_solve -------------------------------------------------------------- */

static const tribo_scene_contact *point_at(const scene_run *run, size_t i)
{
    return scene_list(&run->scene->points[run->points_to]) + i;
}

static scene_trace *trace_at(const scene_run *run, size_t i)
{
    return (scene_trace *)run->scene->traces.data + i;
}

static uint32_t pick_at(const scene_run *run, size_t i)
{
    return ((const uint32_t *)run->scene->picks.data)[i];
}

static tribo_status reserve_rows(scene_run *run)
{
    tribo_scene *s = run->scene;
    const size_t n = s->points[run->points_to].count;
    tribo_status status = scene_reserve(s, &s->rows, n, sizeof(tribo_system_contact));
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->picks, n, sizeof(uint32_t));
    }
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->impulses, 3 * n, sizeof(double));
    }
    if (status == TRIBO_OK && run->resists != 0) {
        status = scene_reserve(s, &s->torques, 3 * n, sizeof(double));
    }
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->velocities, 6 * (size_t)s->end, sizeof(double));
    }
    return status;
}

static int resists(const scene_trace *trace)
{
    return trace->rolling > 0.0 || trace->spinning > 0.0;
}

/* The row of a contact without restitution, in which neither gap nor overlap counts. */
static tribo_system_contact *lay_row(scene_run *run, size_t row, size_t i)
{
    const tribo_scene_contact *c = point_at(run, i);
    const scene_trace *trace = trace_at(run, i);
    tribo_system_contact *out = (tribo_system_contact *)run->scene->rows.data + row;
    ((uint32_t *)run->scene->picks.data)[row] = (uint32_t)i;
    memset(out, 0, sizeof *out);
    out->a = c->a;
    out->b = c->b;
    out->dimension = trace->pair.mu_s > 0.0 || resists(trace) ? 3 : 1;
    out->rolling = trace->rolling;
    out->spinning = trace->spinning;
    memcpy(out->contact.normal, c->normal, sizeof c->normal);
    memcpy(out->contact.arm_a, c->arm_a, sizeof c->arm_a);
    memcpy(out->contact.arm_b, c->arm_b, sizeof c->arm_b);
    out->pair = trace->pair;
    out->pair.e = 0.0;
    if (trace->pair.mu_s > 0.0) { /* else belts would count for the scale of residuals alone */
        out->target[1] = trace->belt[1];
        out->target[2] = trace->belt[2];
    }
    return out;
}

static tribo_status find_linear(scene_run *run, uint32_t solver, tribo_linear *linear,
                                int *is_needed)
{
    tribo_scene *s = run->scene;
    uint32_t unknowns = 0;
    for (uint32_t i = 0; i < s->end && unknowns <= DENSE_UNKNOWNS; i++) {
        unknowns += scene_is_awake(&scene_slots(s)[i]) ? 6u : 0u;
    }
    *is_needed = unknowns > DENSE_UNKNOWNS && solver != TRIBO_SOLVER_GAUSS_SEIDEL;
    if (!*is_needed) {
        return TRIBO_OK;
    }
    tribo_status status = TRIBO_OK;
    if (!s->sparse) {
        status = tribo_sparse_create(TRIBO_SPARSE_SIMPLICIAL, &s->allocator, &s->sparse);
    }
    linear->struct_size = sizeof *linear;
    return status == TRIBO_OK ? tribo_sparse_linear(s->sparse, linear) : status;
}

static void tell(scene_run *run, const tribo_system_info *info)
{
    run->info.sweeps += info->sweeps;
    run->info.newton_steps += info->steps;
    run->info.factorizations += info->factorizations;
}

static void tell_quality(scene_run *run, const tribo_system_info *info)
{
    run->info.stop = info->stop > run->info.stop ? info->stop : run->info.stop;
    run->info.eta = greater(run->info.eta, info->eta);
    run->info.restitution = lesser(run->info.restitution, info->restitution);
}

/* Bytes of an info that tells eta, and no other measure. */
#define UP_TO_ETA ((uint32_t)offsetof(tribo_system_info, eta_rms))

/* `by`: what the problem asks of the solver; all else is filled in. Of the info struct_size bytes
 * are wanted. */
static tribo_status solve(scene_run *run, size_t count, const tribo_body *bodies,
                          const tribo_system_options *by, tribo_system_info *info)
{
    tribo_scene *s = run->scene;
    tribo_system_options o = *by;
    tribo_linear linear = {0};
    int has_linear = 0;
    size_t size = 0;
    tribo_status status = find_linear(run, o.solver, &linear, &has_linear);
    o.struct_size = sizeof o;
    o.tasks = run->options.tasks;
    o.linear = has_linear ? &linear : NULL;
    o.torques = run->resists != 0 ? s->torques.data : NULL;
    o.parallel = run->options.parallel;
    o.user = run->options.user;
    if (status == TRIBO_OK) {
        status = tribo_system_workspace_size(s->end, count, s->rows.data, &o, &size);
    }
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->workspace, size, 1);
    }
    if (status == TRIBO_OK) {
        status = tribo_system_solve(s->end, bodies, count, s->rows.data, &o, s->workspace.data,
                                    s->workspace.bytes, s->impulses.data, s->velocities.data, info);
    }
    tell(run, info);
    return status == TRIBO_ERROR_NOT_FINITE ? TRIBO_ERROR_RANGE : status;
}

/* What impacts and contacts ask of the solver. */
static tribo_system_options asked(const scene_run *run, uint32_t warm)
{
    const tribo_system_options out = {.solver = run->options.solver,
                                      .warm_start = warm,
                                      .max_iterations = run->options.max_iterations,
                                      .tolerance = run->options.tolerance};
    return out;
}

/* Bodies of rows get the velocities of the solution; others keep theirs. */
static void give_velocities(scene_run *run, size_t count)
{
    tribo_scene *s = run->scene;
    const tribo_system_contact *rows = s->rows.data;
    const double *velocities = s->velocities.data;
    for (size_t i = 0; i < 2 * count; i++) {
        const tribo_system_contact *row = &rows[i / 2];
        const uint32_t id = i % 2 == 0 ? row->a : row->b;
        /* Points between two bodies follow each other. */
        if (i > 1 && row[-1].a == row->a && row[-1].b == row->b) {
            continue;
        }
        tribo_body *body = &scene_bodies(s)[id];
        if (scene_slots(s)[id].kind == TRIBO_BODY_DYNAMIC) {
            memcpy(body->velocity, velocities + 6 * (size_t)id, sizeof body->velocity);
            memcpy(body->angular_velocity, velocities + 6 * (size_t)id + 3,
                   sizeof body->angular_velocity);
        }
    }
}

static void to_world(const scene_trace *trace, const double impulse[3], double out[3])
{
    tribo_mat3_apply_transposed(trace->frame, impulse, out);
}

/* ---- impacts --------------------------------------------------------------------------------- */

/* Whether the surfaces meet before the next midpoint, faster than they may without parting. The
 * impact takes place at this one, when half of what forces give has been given.
 * meets: receives when they do, s from now on. */
static int is_impact(const scene_run *run, size_t i, double *meets)
{
    const tribo_scene *s = run->scene;
    const tribo_scene_contact *c = point_at(run, i);
    double before[3];
    double after[3];
    if (!(trace_at(run, i)->pair.e > 0.0)) {
        return 0;
    }
    scene_point_velocity(s, c, NULL, before);
    scene_point_velocity(s, c, s->kicks.data, after);
    const double start = tribo_vec3_dot(c->normal, before);
    const double end = tribo_vec3_dot(c->normal, after);
    const double approach = -0.5 * (start + end);
    const double threshold =
        run->options.threshold > 0.0 ? run->options.threshold : greater(start - end, 0.0);
    *meets = greater(c->distance, 0.0) / -end;
    return approach > threshold && c->distance + run->h * end < 0.0;
}

/* When each dynamic body has its first impact. */
static void find_firsts(scene_run *run)
{
    tribo_scene *s = run->scene;
    const size_t count = s->points[run->points_to].count;
    double *firsts = s->firsts.data;
    for (uint32_t i = 0; i < s->end; i++) {
        firsts[i] = run->h;
    }
    for (size_t i = 0; i < count; i++) {
        const tribo_scene_contact *c = point_at(run, i);
        const scene_trace *trace = trace_at(run, i);
        if (trace->is_impact != 0) {
            firsts[c->a] = lesser(firsts[c->a], trace->meets);
            firsts[c->b] = lesser(firsts[c->b], trace->meets);
        }
    }
}

/* Whether neither body has something before it to meet, by more than a part of the sub-step: what
 * comes later may not come at all. */
static int is_first(const scene_run *run, size_t i)
{
    const tribo_scene *s = run->scene;
    const uint32_t bodies[2] = {point_at(run, i)->a, point_at(run, i)->b};
    const double *firsts = s->firsts.data;
    for (int side = 0; side < 2; side++) {
        if (scene_slots(s)[bodies[side]].kind == TRIBO_BODY_DYNAMIC &&
            trace_at(run, i)->meets > firsts[bodies[side]] + AT_ONCE * run->h) {
            return 0;
        }
    }
    return 1;
}

/* Mark the impacts of a pass. */
static size_t find_impacts(scene_run *run)
{
    const size_t count = run->scene->points[run->points_to].count;
    size_t due = 0;
    size_t found = 0;
    if (run->bounces == 0 || (run->options.skip & TRIBO_SKIP_RESTITUTION)) {
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        scene_trace *trace = trace_at(run, i);
        trace->is_impact = trace->is_active != 0 && is_impact(run, i, &trace->meets) ? 1 : 0;
        due += trace->is_impact;
    }
    if (due > 0) {
        find_firsts(run);
    }
    for (size_t i = 0; i < count && due > 0; i++) {
        scene_trace *trace = trace_at(run, i);
        trace->is_marked = trace->is_impact != 0 && is_first(run, i) ? 1 : 0;
        trace->impacts += trace->is_marked;
        found += trace->is_marked;
    }
    return found;
}

static uint32_t island_mark(const scene_run *run, const uint32_t *marks, size_t i)
{
    const tribo_scene_contact *c = point_at(run, i);
    const int own = scene_slots(run->scene)[c->a].kind == TRIBO_BODY_DYNAMIC;
    return marks[own ? c->a : c->b];
}

/* Rows of the islands in which something has an impact now: that, and contacts that are closed. What
 * an impact sends across a gap has one of its own in a later pass. */
static size_t lay_impacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    const uint32_t *marks = s->marks.data;
    const size_t count = s->points[run->points_to].count;
    size_t rows = 0;
    for (size_t i = 0; i < count; i++) {
        const scene_trace *trace = trace_at(run, i);
        const int is_closed = point_at(run, i)->distance <= trace->slop;
        if (trace->is_active != 0 && island_mark(run, marks, i) != 0 &&
            (trace->is_marked != 0 || is_closed)) {
            tribo_system_contact *row = lay_row(run, rows++, i);
            row->pair.e = trace->is_marked != 0 ? trace->pair.e : 0.0;
        }
    }
    return rows;
}

/* Half of the forces act before the impacts; the other half is left for after them. */
static void push_marked(scene_run *run)
{
    tribo_scene *s = run->scene;
    const uint32_t *marks = s->marks.data;
    uint32_t *pushed = s->pushed.data;
    double *kicks = s->kicks.data;
    for (uint32_t i = 0; i < s->end; i++) {
        tribo_body *body = &scene_bodies(s)[i];
        double *kick = kicks + 6 * (size_t)i;
        if (marks[i] != 0 && pushed[i] == 0 && scene_is_awake(&scene_slots(s)[i])) {
            pushed[i] = 1;
            tribo_vec3_scale(0.5, kick, kick);
            tribo_vec3_scale(0.5, kick + 3, kick + 3);
            tribo_vec3_add(body->velocity, kick, body->velocity);
            tribo_vec3_add(body->angular_velocity, kick + 3, body->angular_velocity);
        }
    }
}

static void take_impacts(scene_run *run, size_t rows)
{
    const double *impulses = run->scene->impulses.data;
    for (size_t i = 0; i < rows; i++) {
        scene_trace *trace = trace_at(run, pick_at(run, i));
        double impulse[3];
        to_world(trace, impulses + 3 * i, impulse);
        tribo_vec3_add(trace->impact, impulse, trace->impact);
        trace->normal += impulses[3 * i];
    }
}

static tribo_status do_impacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    tribo_system_info info = {.struct_size = sizeof info};
    const tribo_system_options by = asked(run, 0);
    scene_mark_islands(run, s->marks.data);
    push_marked(run);
    const size_t rows = lay_impacts(run);
    const tribo_status status = solve(run, rows, scene_bodies(s), &by, &info);
    if (status == TRIBO_OK) {
        give_velocities(run, rows);
        tell_quality(run, &info);
        take_impacts(run, rows);
        run->info.impact_solves++;
    }
    return status;
}

static tribo_status reserve_impacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    tribo_status status = reserve_rows(run);
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->pushed, s->end, sizeof(uint32_t));
    }
    if (status == TRIBO_OK) {
        memset(s->pushed.data, 0, s->end * sizeof(uint32_t));
        status = scene_join_islands(run);
    }
    return status;
}

/* One impact may lead to the next. What the last pass leaves goes on in the next sub-step. */
tribo_status scene_solve_impacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    tribo_status status = scene_reserve(s, &s->firsts, s->end, sizeof(double));
    if (status != TRIBO_OK) {
        return status;
    }
    size_t found = find_impacts(run);
    if (found > 0) {
        status = reserve_impacts(run);
    }
    for (int pass = 0; status == TRIBO_OK && found > 0 && pass < MAX_IMPACTS; pass++) {
        run->info.impacts += found;
        status = do_impacts(run);
        found = find_impacts(run);
    }
    return status;
}

/* ---- contacts that hold ---------------------------------------------------------------------- */

/* Distance at the next midpoint, if nothing changes velocities. */
static double distance_then(const scene_run *run, size_t i)
{
    const tribo_scene_contact *c = point_at(run, i);
    double u[3];
    scene_point_velocity(run->scene, c, NULL, u);
    return c->distance + run->h * tribo_vec3_dot(c->normal, u);
}

/* Hold what surfaces would pass through. Returns how many were not held before. */
static size_t hold_more(scene_run *run)
{
    const size_t count = run->scene->points[run->points_to].count;
    size_t more = 0;
    for (size_t i = 0; i < count; i++) {
        scene_trace *trace = trace_at(run, i);
        if (trace->is_active == 0 || trace->is_impact != 0 || trace->is_held != 0) {
            continue;
        }
        trace->is_held = distance_then(run, i) < -trace->slop ? 1 : 0;
        more += trace->is_held;
    }
    return more;
}

static int is_near(const scene_run *run, size_t i)
{
    return point_at(run, i)->distance <= trace_at(run, i)->margin;
}

/* Old impulses, or none. */
static void prepare_start(const scene_run *run, scene_trace *trace)
{
    const int wanted = (run->options.skip & TRIBO_SKIP_WARM_START) == 0;
    if (!wanted || !(trace->start[0] > 0.0)) {
        memset(trace->start, 0, sizeof trace->start);
        memset(trace->turn, 0, sizeof trace->turn);
    }
}

/* Hold what is near and what surfaces would pass through. Returns how many others there are. */
static size_t hold_first(scene_run *run)
{
    const size_t count = run->scene->points[run->points_to].count;
    size_t loose = 0;
    for (size_t i = 0; i < count; i++) {
        scene_trace *trace = trace_at(run, i);
        if (trace->is_active == 0) {
            continue;
        }
        prepare_start(run, trace);
        const int can_hold = trace->is_impact == 0;
        const int is_held = can_hold && (is_near(run, i) || distance_then(run, i) < -trace->slop);
        trace->is_held = is_held ? 1 : 0;
        loose += can_hold && !is_held ? 1 : 0;
        run->info.matched += is_held && trace->start[0] > 0.0 ? 1 : 0;
    }
    return loose;
}

static void count_row(scene_run *run, const tribo_system_contact *row)
{
    run->info.contacts++;
    run->info.frictionless += row->dimension == 1;
    run->info.resisting += row->rolling > 0.0 || row->spinning > 0.0;
}

/* Rows of the contacts that are held, with impulses to start from. Returns their number. */
static size_t lay_contacts(scene_run *run, int is_first)
{
    tribo_scene *s = run->scene;
    const size_t count = s->points[run->points_to].count;
    size_t rows = 0;
    for (size_t i = 0; i < count; i++) {
        const scene_trace *trace = trace_at(run, i);
        double *start = (double *)s->impulses.data + 3 * rows;
        if (trace->is_held == 0) {
            continue;
        }
        tribo_system_contact *row = lay_row(run, rows++, i);
        const double gap = point_at(run, i)->distance;
        if (is_first) {
            count_row(run, row);
        }
        row->target[0] = gap > CLOSED * trace->slop ? -gap / run->h : 0.0;
        for (int k = 0; k < 3; k++) {
            const int has = trace->start[0] > 0.0 && (k == 0 || row->dimension == 3);
            start[k] = has ? trace->start[k] : 0.0;
        }
        if (run->resists != 0) {
            memcpy((double *)s->torques.data + 3 * (rows - 1), trace->turn, sizeof trace->turn);
        }
    }
    return rows;
}

/* Whether any contact would not hold by itself; a gap that may be closed is none of them. */
static int is_needed(const scene_run *run)
{
    const size_t count = run->scene->points[run->points_to].count;
    for (size_t i = 0; i < count; i++) {
        const scene_trace *trace = trace_at(run, i);
        if (trace->is_active != 0 && trace->is_impact == 0 &&
            distance_then(run, i) < lesser(point_at(run, i)->distance, 0.0)) {
            return 1;
        }
    }
    return 0;
}

static void take_contacts(scene_run *run, size_t rows)
{
    const double *impulses = run->scene->impulses.data;
    const double *torques = run->scene->torques.data;
    for (size_t i = 0; i < rows; i++) {
        scene_trace *trace = trace_at(run, pick_at(run, i));
        memcpy(trace->start, impulses + 3 * i, sizeof trace->start);
        if (run->resists != 0) {
            memcpy(trace->turn, torques + 3 * i, sizeof trace->turn);
        }
    }
}

static void keep_impulses(scene_run *run, size_t rows)
{
    const double *impulses = run->scene->impulses.data;
    const double *torques = run->scene->torques.data;
    for (size_t i = 0; i < rows; i++) {
        const uint32_t at = pick_at(run, i);
        scene_trace *trace = trace_at(run, at);
        tribo_scene_contact *c = scene_list(&run->scene->points[run->points_to]) + at;
        to_world(trace, impulses + 3 * i, c->impulse);
        if (resists(trace)) {
            to_world(trace, torques + 3 * i, c->torque);
        }
        trace->normal += impulses[3 * i];
    }
}

/* Whether a belt or a body that moves by itself may do work on what is held. */
static int is_driven(const scene_run *run, size_t rows)
{
    const tribo_scene *s = run->scene;
    const tribo_system_contact *row = s->rows.data;
    for (size_t i = 0; i < rows; i++) {
        const uint32_t ids[2] = {row[i].a, row[i].b};
        if (row[i].target[1] != 0.0 || row[i].target[2] != 0.0) {
            return 1;
        }
        for (int side = 0; side < 2; side++) {
            if (scene_slots(s)[ids[side]].kind == TRIBO_BODY_KINEMATIC &&
                scene_moves(&scene_bodies(s)[ids[side]])) {
                return 1;
            }
        }
    }
    return 0;
}

static tribo_status add_energy(const tribo_body *body, double *sum)
{
    double spin[3];
    double momentum[3];
    const tribo_status status = tribo_body_spin(body, spin);
    if (status == TRIBO_OK && body->inverse_mass > 0.0) {
        tribo_vec3_scale(1.0 / body->inverse_mass, body->velocity, momentum);
        *sum += 0.5 * (tribo_vec3_dot(momentum, body->velocity) +
                       tribo_vec3_dot(spin, body->angular_velocity));
    }
    return status;
}

/* The greatest share of the impulses that does not raise kinetic energy, T0 + k a + k^2 b. `still`
 * has the velocities before them, and gets what they change where that is less than 1. */
static tribo_status find_share(const scene_run *run, tribo_body *still, double *share)
{
    const tribo_scene *s = run->scene;
    const tribo_body *bodies = scene_bodies(s);
    double before = 0.0;
    double after = 0.0;
    double change = 0.0;
    tribo_status status = TRIBO_OK;
    for (uint32_t i = 0; status == TRIBO_OK && i < s->end; i++) {
        status = add_energy(&still[i], &before);
        status = status == TRIBO_OK ? add_energy(&bodies[i], &after) : status;
    }
    if (status != TRIBO_OK || !(after > before)) {
        return status;
    }
    for (uint32_t i = 0; status == TRIBO_OK && i < s->end; i++) {
        tribo_vec3_subtract(bodies[i].velocity, still[i].velocity, still[i].velocity);
        tribo_vec3_subtract(bodies[i].angular_velocity, still[i].angular_velocity,
                            still[i].angular_velocity);
        status = add_energy(&still[i], &change);
    }
    const double a = after - before - change;
    *share = lesser(greater(-a / change, 0.0), 1.0);
    return status;
}

/* Impulses of a solve that was given up may raise kinetic energy: then they are taken in part. */
static tribo_status hold_energy(scene_run *run, size_t rows)
{
    tribo_scene *s = run->scene;
    tribo_body *still = s->still.data;
    double *impulses = s->impulses.data;
    double *torques = s->torques.data;
    double share = 1.0;
    const tribo_status status = find_share(run, still, &share);
    if (status != TRIBO_OK || share == 1.0) {
        return status;
    }
    for (uint32_t i = 0; i < s->end; i++) {
        tribo_body *body = &scene_bodies(s)[i];
        tribo_vec3_add_scaled(body->velocity, share - 1.0, still[i].velocity, body->velocity);
        tribo_vec3_add_scaled(body->angular_velocity, share - 1.0, still[i].angular_velocity,
                              body->angular_velocity);
    }
    for (size_t i = 0; i < 3 * rows; i++) {
        impulses[i] *= share;
        if (run->resists != 0) {
            torques[i] *= share;
        }
    }
    return TRIBO_OK;
}

/* What one solve sends through a surface that was far is held by the next. loose: contacts that are
 * not held. */
static tribo_status solve_held(scene_run *run, size_t loose)
{
    tribo_scene *s = run->scene;
    tribo_system_info info = {.struct_size = UP_TO_ETA, .restitution = 1.0};
    tribo_status status = TRIBO_OK;
    size_t rows = 0;
    size_t more = 1;
    for (int pass = 0; status == TRIBO_OK && more > 0 && pass < MAX_PASSES; pass++) {
        rows = lay_contacts(run, pass == 0);
        const tribo_system_options by = asked(run, 1);
        status = solve(run, rows, s->still.data, &by, &info);
        if (status == TRIBO_OK) {
            give_velocities(run, rows);
            more = loose > 0 ? hold_more(run) : 0;
        }
        if (more > 0) {
            take_contacts(run, rows);
        }
    }
    if (status == TRIBO_OK && info.stop != TRIBO_STOP_TOLERANCE && !is_driven(run, rows)) {
        status = hold_energy(run, rows);
    }
    if (status == TRIBO_OK) {
        tell_quality(run, &info);
        keep_impulses(run, rows);
    }
    return status;
}

tribo_status scene_solve_contacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    if (!is_needed(run)) {
        return TRIBO_OK;
    }
    tribo_status status = reserve_rows(run);
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->still, s->end, sizeof(tribo_body));
    }
    if (status != TRIBO_OK) {
        return status;
    }
    memcpy(s->still.data, s->bodies.data, s->end * sizeof(tribo_body));
    run->info.contact_solves++;
    const size_t loose = hold_first(run);
    status = scene_carry_weight(run);
    return status == TRIBO_OK ? solve_held(run, loose) : status;
}

/* ---- moving apart what overlaps -------------------------------------------------------------- */

/* Overlaps that do not go away by themselves. */
static int find_overlaps(scene_run *run)
{
    const size_t count = run->scene->points[run->points_to].count;
    int found = 0;
    for (size_t i = 0; i < count; i++) {
        scene_trace *trace = trace_at(run, i);
        const double overlap = -point_at(run, i)->distance;
        trace->is_marked =
            trace->is_active != 0 && overlap > trace->slop && -distance_then(run, i) > trace->slop
                ? 1
                : 0;
        found = found || trace->is_marked != 0;
        run->info.penetration = greater(run->info.penetration, overlap);
    }
    return found;
}

/* Frictionless rows: what overlaps moves apart by a share, all else comes no nearer than it may. */
static size_t lay_overlaps(scene_run *run)
{
    tribo_scene *s = run->scene;
    const uint32_t *marks = s->marks.data;
    const size_t count = s->points[run->points_to].count;
    const double share = run->options.correction > 0.0 ? run->options.correction : PARTING_SHARE;
    size_t rows = 0;
    for (size_t i = 0; i < count; i++) {
        const scene_trace *trace = trace_at(run, i);
        if (trace->is_active == 0 || island_mark(run, marks, i) == 0) {
            continue;
        }
        tribo_system_contact *row = lay_row(run, rows++, i);
        const double then = distance_then(run, i);
        row->dimension = 1;
        row->target[1] = row->target[2] = 0.0;
        row->target[0] =
            trace->is_marked != 0 ? -share * then / run->h : -greater(then, 0.0) / run->h;
    }
    return rows;
}

static tribo_status still_bodies(scene_run *run)
{
    tribo_scene *s = run->scene;
    const tribo_status status = scene_reserve(s, &s->still, s->end, sizeof(tribo_body));
    if (status != TRIBO_OK) {
        return status;
    }
    tribo_body *still = s->still.data;
    for (uint32_t i = 0; i < s->end; i++) {
        still[i] = scene_bodies(s)[i];
        memset(still[i].velocity, 0, sizeof still[i].velocity);
        memset(still[i].angular_velocity, 0, sizeof still[i].angular_velocity);
    }
    return TRIBO_OK;
}

/* velocities: moves per second, that scene_move_apart applies. */
tribo_status scene_part_overlaps(scene_run *run, uint32_t *moved)
{
    tribo_scene *s = run->scene;
    tribo_system_info info = {.struct_size = UP_TO_ETA};
    const tribo_system_options by = {.solver = run->options.solver,
                                     .max_iterations = PARTING_ITERATIONS,
                                     .tolerance = PARTING_TOLERANCE};
    *moved = 0;
    if (!find_overlaps(run) || (run->options.skip & TRIBO_SKIP_CORRECTION)) {
        return TRIBO_OK;
    }
    tribo_status status = reserve_rows(run);
    if (status == TRIBO_OK) {
        status = scene_join_islands(run);
    }
    if (status == TRIBO_OK) {
        status = still_bodies(run);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    scene_mark_islands(run, s->marks.data);
    const size_t rows = lay_overlaps(run);
    status = solve(run, rows, s->still.data, &by, &info);
    /* What is squeezed from both sides has no way out: then nothing moves. */
    if (status == TRIBO_OK && info.stop != TRIBO_STOP_JAM) {
        *moved = 1;
        run->info.correction_solves++;
    }
    return status;
}

void scene_move_apart(scene_run *run)
{
    tribo_scene *s = run->scene;
    const double *velocities = s->velocities.data;
    for (uint32_t i = 0; i < s->end; i++) {
        const double *v = velocities + 6 * (size_t)i;
        tribo_body *body = &scene_bodies(s)[i];
        double turn[3];
        double q[4];
        if (!scene_is_awake(&scene_slots(s)[i])) {
            continue;
        }
        tribo_vec3_add_scaled(body->position, run->h, v, body->position);
        tribo_vec3_scale(run->h, v + 3, turn);
        if ((turn[0] != 0.0 || turn[1] != 0.0 || turn[2] != 0.0) &&
            tribo_quat_from_rotation_vector(turn, q) == TRIBO_OK) {
            tribo_quat_multiply(q, body->orientation, body->orientation);
            tribo_quat_normalize(body->orientation, body->orientation);
        }
    }
}
