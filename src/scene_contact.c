#include "scene.h"

#define NEAR (1.0 / 64.0)               /* of the lesser radius: the default margin */
#define SLOP 9.31322574615478515625e-10 /* 2^-30, of the lesser radius: overlap by rounding */
#define SOLVED 0.0625 /* of the tolerance: overlap that the solver leaves from time to time */
#define FIRST_MANIFOLDS 16u

/* ---- what may come together ------------------------------------------------------------------ */

/* Changes of velocity by forces in one sub-step. */
static tribo_status take_kicks(scene_run *run)
{
    tribo_scene *s = run->scene;
    const tribo_status status = scene_reserve(s, &s->kicks, 6 * (size_t)s->end, sizeof(double));
    if (status != TRIBO_OK) {
        return status;
    }
    double *kicks = s->kicks.data;
    memset(kicks, 0, 6 * (size_t)s->end * sizeof *kicks);
    for (uint32_t i = 0; i < s->end; i++) {
        const scene_slot *slot = &scene_slots(s)[i];
        const tribo_body *body = &scene_bodies(s)[i];
        double *kick = kicks + 6 * (size_t)i;
        if (slot->used == 0 || slot->kind != TRIBO_BODY_DYNAMIC) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            const double a = s->settings.gravity[k] + body->inverse_mass * slot->force[k];
            kick[k] = run->h * a;
        }
        const double *t = slot->torque;
        if (t[0] != 0.0 || t[1] != 0.0 || t[2] != 0.0) {
            double j[6];
            tribo_body_world_inverse_inertia(body, j);
            tribo_sym3_apply(j, t, kick + 3);
            tribo_vec3_scale(run->h, kick + 3, kick + 3);
        }
        if (!all_finite(kick, 6)) {
            return TRIBO_ERROR_RANGE;
        }
    }
    return TRIBO_OK;
}

static int is_finite_radius(double radius)
{
    return radius - radius == 0.0;
}

static double turn_of(const scene_run *run, uint32_t i)
{
    const double *kick = (const double *)run->scene->kicks.data + 6 * (size_t)i;
    return tribo_vec3_norm(scene_bodies(run->scene)[i].angular_velocity) +
           tribo_vec3_norm(kick + 3);
}

static int does_speculate(const scene_run *run, uint32_t i)
{
    return scene_slots(run->scene)[i].asleep == 0 &&
           (run->options.skip & TRIBO_SKIP_SPECULATION) == 0;
}

/* How far a point of the body may come before the next midpoint; of one without end, without its
 * turning. */
static double reach_of(const scene_run *run, uint32_t i)
{
    const tribo_scene *s = run->scene;
    const double radius = scene_slots(s)[i].radius;
    const double *kick = (const double *)s->kicks.data + 6 * (size_t)i;
    const double turn = is_finite_radius(radius) ? turn_of(run, i) * radius : 0.0;
    const double speed = tribo_vec3_norm(scene_bodies(s)[i].velocity) + tribo_vec3_norm(kick);
    return does_speculate(run, i) ? run->h * (speed + turn) : 0.0;
}

/* A body without end that turns may come to anything. */
static int may_come_anywhere(const scene_run *run, uint32_t i)
{
    return !is_finite_radius(scene_slots(run->scene)[i].radius) && does_speculate(run, i) &&
           turn_of(run, i) > 0.0;
}

/* How far the turning of such a body may bring it near the other one. */
static double swing_of(const scene_run *run, uint32_t i, uint32_t other)
{
    const tribo_scene *s = run->scene;
    double way[3];
    if (!may_come_anywhere(run, i)) {
        return 0.0;
    }
    tribo_vec3_subtract(scene_bodies(s)[other].position, scene_bodies(s)[i].position, way);
    return run->h * turn_of(run, i) * (tribo_vec3_norm(way) + scene_slots(s)[other].radius);
}

static double margin_of(const scene_run *run, double radius)
{
    if (run->options.skip & TRIBO_SKIP_SPECULATION) {
        return 0.0;
    }
    return run->options.margin > 0.0 ? run->options.margin : NEAR * radius;
}

/* The box of a body holds what may touch it within `reach`, and what counts as near. */
tribo_status scene_place_near(scene_run *run, uint32_t i, double reach)
{
    const double radius = scene_slots(run->scene)[i].radius;
    const double margin = is_finite_radius(radius) ? margin_of(run, radius) : 0.0;
    if (reach != reach || reach + margin != reach + margin) {
        return TRIBO_ERROR_RANGE;
    }
    return scene_place_box(run->scene, i,
                           may_come_anywhere(run, i) ? (double)INFINITY : reach + margin);
}

static tribo_status move_boxes(scene_run *run)
{
    tribo_scene *s = run->scene;
    tribo_status status = scene_reserve(s, &s->reaches, s->end, sizeof(double));
    for (uint32_t i = 0; status == TRIBO_OK && i < s->end; i++) {
        const scene_slot *slot = &scene_slots(s)[i];
        double *reach = (double *)s->reaches.data + i;
        *reach = 0.0;
        if (slot->used == 0 || slot->shape.type == 0 || slot->kind == TRIBO_BODY_STATIC ||
            slot->asleep != 0) {
            continue;
        }
        *reach = reach_of(run, i);
        status = scene_place_near(run, i, *reach);
    }
    return status;
}

static tribo_status find_pairs(scene_run *run, size_t *count)
{
    tribo_scene *s = run->scene;
    size_t needed = 0;
    for (;;) {
        const size_t capacity = s->pairs.bytes / (2 * sizeof(uint32_t));
        tribo_status status = tribo_tree_pairs(s->tree, capacity, s->pairs.data, &needed);
        if (status == TRIBO_ERROR_CAPACITY) {
            status = scene_reserve(s, &s->pairs, needed, 2 * sizeof(uint32_t));
            if (status == TRIBO_OK) {
                continue;
            }
        }
        *count = needed;
        return status;
    }
}

/* ---- one contact point ----------------------------------------------------------------------- */

static void add_velocity(const tribo_scene *s, uint32_t i, const double arm[3], const double *kicks,
                         double sign, double u[3])
{
    const tribo_body *body = &scene_bodies(s)[i];
    double v[3];
    double w[3];
    double turn[3];
    memcpy(v, body->velocity, sizeof v);
    memcpy(w, body->angular_velocity, sizeof w);
    if (kicks && scene_slots(s)[i].kind == TRIBO_BODY_DYNAMIC) {
        tribo_vec3_add(v, kicks + 6 * (size_t)i, v);
        tribo_vec3_add(w, kicks + 6 * (size_t)i + 3, w);
    }
    tribo_vec3_cross(w, arm, turn);
    for (int k = 0; k < 3; k++) {
        u[k] += sign * (v[k] + turn[k]);
    }
}

/* v_A - v_B at the point, world axes; with forces of the sub-step where kicks are given. */
void scene_point_velocity(const tribo_scene *s, const tribo_scene_contact *c, const double *kicks,
                          double u[3])
{
    u[0] = u[1] = u[2] = 0.0;
    add_velocity(s, c->a, c->arm_a, kicks, 1.0, u);
    add_velocity(s, c->b, c->arm_b, kicks, -1.0, u);
}

static void add_belt(const tribo_scene *s, uint32_t i, double sign, double sum[3])
{
    const double *belt = scene_slots(s)[i].belt;
    double world[3];
    if (belt[0] != 0.0 || belt[1] != 0.0 || belt[2] != 0.0) {
        tribo_quat_rotate(scene_bodies(s)[i].orientation, belt, world);
        tribo_vec3_add_scaled(sum, sign, world, sum);
    }
}

/* What points between two bodies with one normal have in common. */
static tribo_status fill_trace(scene_run *run, const uint32_t pair[2], const double normal[3],
                               scene_trace *trace)
{
    const tribo_scene *s = run->scene;
    const scene_slot *a = &scene_slots(s)[pair[0]];
    const scene_slot *b = &scene_slots(s)[pair[1]];
    const double radius = lesser(a->radius, b->radius);
    double belt[3] = {0.0, 0.0, 0.0};
    memset(trace, 0, sizeof *trace);
    tribo_status status = tribo_material_mix(&a->material, &b->material, s->settings.friction_rule,
                                             s->settings.restitution_rule, &trace->pair);
    if (status == TRIBO_OK) {
        status = tribo_basis_from_normal(normal, trace->frame);
    }
    trace->rolling = greater(a->rolling, b->rolling);
    trace->spinning = greater(a->spinning, b->spinning);
    add_belt(s, pair[1], 1.0, belt);
    add_belt(s, pair[0], -1.0, belt);
    tribo_mat3_apply(trace->frame, belt, trace->belt);
    trace->margin = margin_of(run, radius);
    trace->slop = greater(SLOP, SOLVED * run->options.tolerance) * radius;
    return status;
}

/* common: of fill_trace. recalled: impulse and torque of the last sub-step, world axes. */
static tribo_status keep_point(scene_run *run, const tribo_scene_contact *c,
                               const scene_trace *common, const double recalled[6])
{
    tribo_scene *s = run->scene;
    scene_points *to = &s->points[run->points_to];
    if (to->count == INT32_MAX) {
        return TRIBO_ERROR_CAPACITY;
    }
    tribo_status status = TRIBO_OK;
    if (!scene_has_room(&to->buffer, to->count, sizeof *c)) {
        status = scene_grow(s, &to->buffer, to->count, to->count + 1, sizeof *c);
    }
    if (status == TRIBO_OK && !scene_has_room(&s->traces, to->count, sizeof(scene_trace))) {
        status = scene_grow(s, &s->traces, to->count, to->count + 1, sizeof(scene_trace));
    }
    if (status != TRIBO_OK) {
        return status;
    }
    tribo_scene_contact *kept = scene_list(to) + to->count;
    scene_trace *trace = (scene_trace *)s->traces.data + to->count++;
    *kept = *c;
    memset(kept->impulse, 0, sizeof kept->impulse);
    memset(kept->torque, 0, sizeof kept->torque);
    *trace = *common;
    tribo_mat3_apply(trace->frame, recalled, trace->start);
    tribo_mat3_apply(trace->frame, recalled + 3, trace->turn);
    run->resists |= trace->rolling > 0.0 || trace->spinning > 0.0 ? 1u : 0u;
    run->bounces |= trace->pair.e > 0.0 ? 1u : 0u;
    return TRIBO_OK;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

/* Points of the last sub-step between the same bodies. */
typedef struct old_points {
    const tribo_scene_contact *first;
    size_t count;
} old_points;

static int precedes(const tribo_scene_contact *c, uint32_t a, uint32_t b)
{
    return c->a < a || (c->a == a && c->b < b);
}

/* `at` runs along the old list as pairs run along the new one. */
static old_points find_old(const scene_run *run, uint32_t a, uint32_t b, size_t *at)
{
    const scene_points *from = &run->scene->points[run->points_from];
    const tribo_scene_contact *c = scene_list(from);
    while (*at < from->count && precedes(&c[*at], a, b)) {
        ++*at;
    }
    size_t end = *at;
    while (end < from->count && c[end].a == a && c[end].b == b) {
        end++;
    }
    const old_points out = {end > *at ? c + *at : NULL, end - *at};
    *at = end;
    return out;
}

static int is_of(const tribo_scene_contact *old, const tribo_scene_contact *c)
{
    return old->child_a == c->child_a && old->child_b == c->child_b;
}

/* The old point of the same features; or the nearest one, where rounding has two bodies take turns
 * in whose face clips the other's. Null if there is none. */
static const tribo_scene_contact *find_same(const old_points *old, const tribo_scene_contact *c,
                                            double near)
{
    const tribo_scene_contact *best = NULL;
    double least = near;
    for (size_t i = 0; i < old->count; i++) {
        if (old->first[i].id == c->id && is_of(&old->first[i], c)) {
            return &old->first[i];
        }
    }
    for (size_t i = 0; i < old->count; i++) {
        double way[3];
        tribo_vec3_subtract(old->first[i].arm_a, c->arm_a, way);
        const double distance = tribo_vec3_norm(way);
        if (is_of(&old->first[i], c) && distance < least) {
            least = distance;
            best = &old->first[i];
        }
    }
    return best;
}

static void recall_impulse(const scene_run *run, const old_points *old,
                           const tribo_scene_contact *c, double recalled[6])
{
    const scene_slot *slots = scene_slots(run->scene);
    const double radius = lesser(slots[c->a].radius, slots[c->b].radius);
    const tribo_scene_contact *same = find_same(old, c, NEAR * radius);
    memset(recalled, 0, 6 * sizeof *recalled);
    if (same) {
        tribo_vec3_scale(run->h / run->scene->last_h, same->impulse, recalled);
        tribo_vec3_scale(run->h / run->scene->last_h, same->torque, recalled + 3);
    }
}

static tribo_status keep_manifold(scene_run *run, const uint32_t pair[2],
                                  const tribo_manifold *manifold, const old_points *old)
{
    const tribo_scene *s = run->scene;
    const int speculates = (run->options.skip & TRIBO_SKIP_SPECULATION) == 0;
    scene_trace common;
    tribo_status status = fill_trace(run, pair, manifold->normal, &common);
    for (uint32_t i = 0; status == TRIBO_OK && i < manifold->count; i++) {
        const tribo_point *point = &manifold->points[i];
        tribo_scene_contact c;
        double recalled[6];
        memset(&c, 0, sizeof c);
        c.a = pair[0];
        c.b = pair[1];
        c.child_a = manifold->child_a;
        c.child_b = manifold->child_b;
        c.id = point->id;
        c.distance = point->distance;
        memcpy(c.normal, manifold->normal, sizeof c.normal);
        double *arms[2] = {c.arm_a, c.arm_b};
        memcpy(c.arm_a, point->arm_a, sizeof c.arm_a);
        memcpy(c.arm_b, point->arm_b, sizeof c.arm_b);
        for (int side = 0; side < 2; side++) {
            const scene_slot *slot = &scene_slots(s)[pair[side]];
            double arm[3];
            if (slot->is_centred == 0) {
                tribo_quat_rotate(scene_bodies(s)[pair[side]].orientation, slot->offset.position,
                                  arm);
                tribo_vec3_add(arms[side], arm, arms[side]);
            }
        }
        if (speculates || c.distance <= 0.0) {
            recall_impulse(run, old, &c, recalled);
            status = keep_point(run, &c, &common, recalled);
        }
    }
    return status;
}

static tribo_status collide_pair(scene_run *run, const uint32_t pair[2], double margin,
                                 uint32_t *count)
{
    tribo_scene *s = run->scene;
    tribo_collide_options options = {.struct_size = sizeof options};
    tribo_pose poses[2];
    const scene_slot *slots[2];
    for (int side = 0; side < 2; side++) {
        slots[side] = &scene_slots(s)[pair[side]];
        scene_shape_pose(slots[side], &scene_bodies(s)[pair[side]], &poses[side]);
    }
    const double *reaches = s->reaches.data;
    options.margin = margin + reaches[pair[0]] + reaches[pair[1]] +
                     swing_of(run, pair[0], pair[1]) + swing_of(run, pair[1], pair[0]);
    run->info.pairs++;
    tribo_status status = scene_reserve(s, &s->manifolds, FIRST_MANIFOLDS, sizeof(tribo_manifold));
    while (status == TRIBO_OK) {
        const size_t capacity = s->manifolds.bytes / sizeof(tribo_manifold);
        status = tribo_collide_shapes(&slots[0]->shape, &poses[0], &slots[1]->shape, &poses[1],
                                      &options, (uint32_t)lesser((double)capacity, INT32_MAX),
                                      s->manifolds.data, count, NULL);
        if (status != TRIBO_ERROR_CAPACITY) {
            break;
        }
        status = scene_reserve(s, &s->manifolds, *count, sizeof(tribo_manifold));
    }
    return status == TRIBO_ERROR_NOT_FINITE ? TRIBO_ERROR_RANGE : status;
}

static int can_disturb(const tribo_scene *s, uint32_t i)
{
    return scene_is_awake(&scene_slots(s)[i]) ||
           (scene_slots(s)[i].kind == TRIBO_BODY_KINEMATIC && scene_moves(&scene_bodies(s)[i]));
}

/* What sleeps stays as it is. */
static tribo_status keep_old(scene_run *run, const uint32_t pair[2], const old_points *old)
{
    tribo_status status = TRIBO_OK;
    for (size_t i = 0; status == TRIBO_OK && i < old->count; i++) {
        scene_trace common;
        double recalled[6];
        recall_impulse(run, old, &old->first[i], recalled);
        status = fill_trace(run, pair, old->first[i].normal, &common);
        if (status == TRIBO_OK) {
            status = keep_point(run, &old->first[i], &common, recalled);
        }
    }
    return status;
}

static tribo_status do_pair(scene_run *run, const uint32_t pair[2], size_t *at)
{
    tribo_scene *s = run->scene;
    const scene_slot *a = &scene_slots(s)[pair[0]];
    const scene_slot *b = &scene_slots(s)[pair[1]];
    uint32_t count = 0;
    tribo_status status = TRIBO_OK;
    if (a->shape.type == 0 || b->shape.type == 0 ||
        (a->kind != TRIBO_BODY_DYNAMIC && b->kind != TRIBO_BODY_DYNAMIC)) {
        return TRIBO_OK;
    }
    const old_points old = find_old(run, pair[0], pair[1], at);
    if (!can_disturb(s, pair[0]) && !can_disturb(s, pair[1])) {
        return keep_old(run, pair, &old);
    }
    const double margin = margin_of(run, lesser(a->radius, b->radius));
    status = collide_pair(run, pair, margin, &count);
    for (uint32_t i = 0; status == TRIBO_OK && i < count; i++) {
        const tribo_manifold *manifold = (const tribo_manifold *)s->manifolds.data + i;
        status = keep_manifold(run, pair, manifold, &old);
    }
    return status;
}

tribo_status scene_find_contacts(scene_run *run)
{
    tribo_scene *s = run->scene;
    size_t count = 0;
    size_t at = 0;
    s->points[run->points_to].count = 0;
    if (s->count == 0) {
        return TRIBO_OK;
    }
    tribo_status status = take_kicks(run);
    if (status == TRIBO_OK && s->count < 2) {
        return TRIBO_OK;
    }
    if (status == TRIBO_OK) {
        status = move_boxes(run);
    }
    if (status == TRIBO_OK) {
        status = find_pairs(run, &count);
        run->info.broad++;
    }
    for (size_t i = 0; status == TRIBO_OK && i < count; i++) {
        uint32_t pair[2];
        memcpy(pair, (const uint32_t *)s->pairs.data + 2 * i, sizeof pair);
        status = do_pair(run, pair, &at);
    }
    return status;
}
