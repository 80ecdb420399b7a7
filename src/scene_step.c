#include "scene.h"

#define MAX_SUBSTEPS 0x100000u
#define TOLERANCE 1e-12
#define MAX_ITERATIONS 1000u

/* ---- options --------------------------------------------------------------------------------- */

static tribo_status judge_options(const tribo_step_options *o)
{
    const uint32_t known = TRIBO_SKIP_WARM_START | TRIBO_SKIP_CORRECTION | TRIBO_SKIP_RESTITUTION |
                           TRIBO_SKIP_SPECULATION;
    const double numbers[6] = {o->tolerance,  o->margin,     o->threshold,
                               o->correction, o->sleep_time, o->sleep_speed};
    if (o->struct_size != sizeof *o) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    if (o->solver > TRIBO_SOLVER_NEWTON || (o->skip & ~known) != 0 || o->reserved != 0) {
        return TRIBO_ERROR_OPTION;
    }
    if (!all_finite(numbers, 6)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    for (int i = 0; i < 6; i++) {
        if (numbers[i] < 0.0) {
            return TRIBO_ERROR_RANGE;
        }
    }
    return o->correction > 1.0 || o->substeps > MAX_SUBSTEPS ? TRIBO_ERROR_RANGE : TRIBO_OK;
}

static tribo_status judge_dt(double dt)
{
    if (!all_finite(&dt, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    return dt > 0.0 ? TRIBO_OK : TRIBO_ERROR_TIME_STEP;
}

static tribo_status start_run(tribo_scene *scene, double dt, const tribo_step_options *options,
                              scene_run *run)
{
    memset(run, 0, sizeof *run);
    if (options) {
        const tribo_status status = judge_options(options);
        if (status != TRIBO_OK) {
            return status;
        }
        run->options = *options;
    }
    run->scene = scene;
    run->options.substeps = run->options.substeps > 0 ? run->options.substeps : 1;
    run->options.tolerance = run->options.tolerance > 0.0 ? run->options.tolerance : TOLERANCE;
    run->options.max_iterations =
        run->options.max_iterations > 0 ? run->options.max_iterations : MAX_ITERATIONS;
    run->h = dt / (double)run->options.substeps;
    run->info.restitution = 1.0;
    run->points_from = scene->points_now;
    run->points_to = (scene->points_now + 1) % 3;
    run->events_from = (scene->events_now + 1) % 3;
    run->events_to = (scene->events_now + 2) % 3;
    scene->events[run->events_from].count = 0;
    return run->h > 0.0 ? TRIBO_OK : TRIBO_ERROR_TIME_STEP;
}

/* ---- stages ---------------------------------------------------------------------------------- */

static int is_turning(const tribo_body *body)
{
    const double *w = body->angular_velocity;
    return w[0] != 0.0 || w[1] != 0.0 || w[2] != 0.0;
}

static tribo_status fly(scene_run *run)
{
    const tribo_scene *s = run->scene;
    for (uint32_t i = 0; i < s->end; i++) {
        tribo_body *body = &scene_bodies(s)[i];
        if (scene_slots(s)[i].used == 0 || !scene_moves(body)) {
            continue;
        }
        const tribo_status status = tribo_body_advance(body, NULL, 0.5 * run->h);
        if (status != TRIBO_OK) {
            return status;
        }
        run->info.flights++;
        run->info.turns += is_turning(body) ? 1u : 0u;
    }
    return TRIBO_OK;
}

static void mark_active(scene_run *run)
{
    tribo_scene *s = run->scene;
    const scene_points *points = &s->points[run->points_to];
    scene_trace *traces = s->traces.data;
    for (size_t i = 0; i < points->count; i++) {
        const tribo_scene_contact *c = &scene_list(points)[i];
        traces[i].is_active =
            scene_is_awake(&scene_slots(s)[c->a]) || scene_is_awake(&scene_slots(s)[c->b]) ? 1 : 0;
        if (traces[i].is_active == 0) {
            tribo_scene_contact *kept = &scene_list(points)[i];
            tribo_mat3_apply_transposed(traces[i].frame, traces[i].start, kept->impulse);
            tribo_mat3_apply_transposed(traces[i].frame, traces[i].turn, kept->torque);
            traces[i].normal = traces[i].start[0];
        }
    }
}

static void apply_forces(scene_run *run)
{
    const tribo_scene *s = run->scene;
    const double *kicks = s->kicks.data;
    for (uint32_t i = 0; i < s->end; i++) {
        tribo_body *body = &scene_bodies(s)[i];
        if (scene_is_awake(&scene_slots(s)[i])) {
            tribo_vec3_add(body->velocity, kicks + 6 * (size_t)i, body->velocity);
            tribo_vec3_add(body->angular_velocity, kicks + 6 * (size_t)i + 3,
                           body->angular_velocity);
        }
    }
}

static int any_asleep(const tribo_scene *s)
{
    for (uint32_t i = 0; i < s->end; i++) {
        if (scene_slots(s)[i].asleep != 0) {
            return 1;
        }
    }
    return 0;
}

static tribo_status wake(scene_run *run)
{
    const tribo_status status = scene_join_islands(run);
    if (status == TRIBO_OK) {
        scene_wake_islands(run);
    }
    return status;
}

static tribo_status touch(scene_run *run)
{
    tribo_status status = scene_find_contacts(run);
    if (status == TRIBO_OK && any_asleep(run->scene)) {
        status = wake(run);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    mark_active(run);
    status = scene_solve_impacts(run);
    if (status != TRIBO_OK) {
        return status;
    }
    apply_forces(run);
    return scene_solve_contacts(run);
}

static tribo_status rest(scene_run *run)
{
    if (!(run->options.sleep_time > 0.0)) {
        return TRIBO_OK;
    }
    const tribo_status status = scene_join_islands(run);
    return status == TRIBO_OK ? scene_fall_asleep(run) : status;
}

static void next_lists(scene_run *run)
{
    const uint32_t now = run->scene->points_now;
    const uint32_t from = run->points_to;
    run->points_to = run->points_from == now ? 3 - now - from : run->points_from;
    run->points_from = from;
    const uint32_t events = run->events_from;
    run->events_from = run->events_to;
    run->events_to = events;
}

static tribo_status do_substep(scene_run *run)
{
    uint32_t moved = 0;
    tribo_status status = fly(run);
    if (status == TRIBO_OK) {
        status = touch(run);
    }
    if (status == TRIBO_OK) {
        status = scene_gather_events(run);
    }
    if (status == TRIBO_OK) {
        status = scene_part_overlaps(run, &moved);
    }
    if (status == TRIBO_OK) {
        status = fly(run);
    }
    if (status == TRIBO_OK && moved != 0) {
        scene_move_apart(run);
    }
    if (status == TRIBO_OK) {
        status = rest(run);
    }
    run->scene->last_h = run->h;
    run->info.substeps++;
    next_lists(run);
    return status;
}

/* ---- a step ---------------------------------------------------------------------------------- */

static tribo_status keep_state(tribo_scene *s)
{
    tribo_status status = scene_reserve(s, &s->kept_slots, s->end, sizeof(scene_slot));
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->kept_bodies, s->end, sizeof(tribo_body));
    }
    if (status == TRIBO_OK && s->end > 0) {
        memcpy(s->kept_slots.data, s->slots.data, s->end * sizeof(scene_slot));
        memcpy(s->kept_bodies.data, s->bodies.data, s->end * sizeof(tribo_body));
    }
    return status;
}

static void take_back(tribo_scene *s, double last_h)
{
    s->last_h = last_h;
    if (s->end == 0) {
        return;
    }
    memcpy(s->slots.data, s->kept_slots.data, s->end * sizeof(scene_slot));
    memcpy(s->bodies.data, s->kept_bodies.data, s->end * sizeof(tribo_body));
    for (uint32_t i = 0; i < s->end; i++) {
        const scene_slot *slot = &scene_slots(s)[i];
        if (slot->used != 0) {
            tribo_tree_move(s->tree, i, slot->low, slot->high);
        }
    }
}

static void give_info(const scene_run *run, tribo_step_info *info)
{
    const uint32_t size = info->struct_size;
    *info = run->info;
    info->struct_size = size;
    for (uint32_t i = 0; i < run->scene->end; i++) {
        info->asleep += scene_slots(run->scene)[i].asleep;
    }
}

tribo_status tribo_scene_step(tribo_scene *scene, double dt, const tribo_step_options *options,
                              tribo_step_info *info)
{
    scene_run run;
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    if (info && info->struct_size != sizeof *info) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_status status = judge_dt(dt);
    const tribo_status options_status = start_run(scene, dt, options, &run);
    if (options_status == TRIBO_ERROR_STRUCT_SIZE || options_status == TRIBO_ERROR_OPTION ||
        status == TRIBO_OK) {
        status = options_status;
    }
    if (status == TRIBO_OK) {
        status = keep_state(scene);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    const double last_h = scene->last_h;
    while (status == TRIBO_OK && run.info.substeps < run.options.substeps) {
        status = do_substep(&run);
    }
    if (status == TRIBO_OK) {
        status = scene_name_events(&run);
    }
    if (status != TRIBO_OK) {
        take_back(scene, last_h);
        return status;
    }
    scene->points_now = run.points_from;
    scene->events_now = run.events_to;
    if (info) {
        give_info(&run, info);
    }
    return TRIBO_OK;
}
