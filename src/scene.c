#include "scene.h"

#include "tree.h"

#include <stdlib.h>

#define MAX_BODIES 0x40000000u
#define LEAST_CAPACITY 16u
#define SLACK 0.03125 /* of the radius: so far a body moves before the tree is changed */

/* ---- memory ---------------------------------------------------------------------------------- */

static void *allocate_default(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void release_default(void *user, void *memory)
{
    (void)user;
    free(memory);
}

void scene_release(tribo_scene *s, scene_buffer *buffer)
{
    if (buffer->data) {
        s->allocator.release(s->allocator.user, buffer->data);
    }
    buffer->data = NULL;
    buffer->bytes = 0;
}

/* Room for count objects; the first `used` stay. */
tribo_status scene_grow(tribo_scene *s, scene_buffer *buffer, size_t used, size_t count,
                        size_t size)
{
    if (count > SIZE_MAX / 2 / size) {
        return TRIBO_ERROR_MEMORY;
    }
    const size_t needed = count * size;
    if (needed <= buffer->bytes) {
        return TRIBO_OK;
    }
    const size_t half_more = needed + needed / 2;
    void *data = s->allocator.allocate(s->allocator.user, half_more);
    if (!data) {
        return TRIBO_ERROR_MEMORY;
    }
    if (used > 0) {
        memcpy(data, buffer->data, used * size);
    }
    scene_release(s, buffer);
    buffer->data = data;
    buffer->bytes = half_more;
    return TRIBO_OK;
}

tribo_status scene_reserve(tribo_scene *s, scene_buffer *buffer, size_t count, size_t size)
{
    return scene_grow(s, buffer, 0, count, size);
}

/* ---- a scene --------------------------------------------------------------------------------- */

static tribo_status judge_allocator(const tribo_allocator *allocator)
{
    if (allocator->struct_size != sizeof *allocator) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    return allocator->allocate && allocator->release ? TRIBO_OK : TRIBO_ERROR_NULL;
}

static tribo_status judge_settings(const tribo_scene_settings *settings)
{
    if (settings->struct_size != sizeof *settings) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    if (settings->friction_rule > TRIBO_MIX_ARITHMETIC_MEAN ||
        settings->restitution_rule > TRIBO_MIX_ARITHMETIC_MEAN || settings->reserved != 0) {
        return TRIBO_ERROR_OPTION;
    }
    return all_finite(settings->gravity, 3) ? TRIBO_OK : TRIBO_ERROR_NOT_FINITE;
}

tribo_status tribo_scene_create(const tribo_scene_settings *settings,
                                const tribo_allocator *allocator, tribo_scene **scene)
{
    const tribo_allocator plain = {sizeof plain, 0, allocate_default, release_default, NULL};
    const tribo_scene_settings none = {.struct_size = sizeof none};
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = allocator ? judge_allocator(allocator) : TRIBO_OK;
    if (status == TRIBO_OK && settings) {
        status = judge_settings(settings);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    const tribo_allocator *used = allocator ? allocator : &plain;
    tribo_scene *s = used->allocate(used->user, sizeof *s);
    if (!s) {
        return TRIBO_ERROR_MEMORY;
    }
    memset(s, 0, sizeof *s);
    s->allocator = *used;
    s->settings = settings ? *settings : none;
    *scene = s;
    return TRIBO_OK;
}

void tribo_scene_destroy(tribo_scene *scene)
{
    if (!scene) {
        return;
    }
    scene_buffer *all[] = {
        &scene->slots,       &scene->bodies,  &scene->tree_block, &scene->kept_slots,
        &scene->kept_bodies, &scene->kicks,   &scene->pushed,     &scene->reaches,
        &scene->firsts,      &scene->pairs,   &scene->manifolds,  &scene->parents,
        &scene->marks,       &scene->traces,  &scene->rows,       &scene->picks,
        &scene->impulses,    &scene->torques, &scene->velocities, &scene->still,
        &scene->workspace,   &scene->loads,   &scene->carriers};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        scene_release(scene, all[i]);
    }
    for (int i = 0; i < 3; i++) {
        scene_release(scene, &scene->points[i].buffer);
        scene_release(scene, &scene->events[i].buffer);
    }
    tribo_sparse_destroy(scene->sparse);
    scene->allocator.release(scene->allocator.user, scene);
}

/* ---- boxes ----------------------------------------------------------------------------------- */

void scene_shape_pose(const scene_slot *slot, const tribo_body *body, tribo_pose *pose)
{
    if (slot->is_centred) {
        memcpy(pose->position, body->position, sizeof pose->position);
        memcpy(pose->orientation, body->orientation, sizeof pose->orientation);
        return;
    }
    double arm[3];
    tribo_quat_rotate(body->orientation, slot->offset.position, arm);
    tribo_vec3_add(body->position, arm, pose->position);
    tribo_quat_multiply(body->orientation, slot->offset.orientation, pose->orientation);
    /* Both are unit to 1e-6, the product need not be. */
    tribo_quat_normalize(pose->orientation, pose->orientation);
}

tribo_status scene_box(const scene_slot *slot, const tribo_body *body, double reach, double low[3],
                       double high[3])
{
    tribo_pose pose;
    if (slot->shape.type == 0) {
        memcpy(low, body->position, sizeof body->position);
        memcpy(high, body->position, sizeof body->position);
        return TRIBO_OK;
    }
    scene_shape_pose(slot, body, &pose);
    const tribo_status status = tribo_shape_bounds(&slot->shape, &pose, low, high);
    if (status != TRIBO_OK) {
        return status == TRIBO_ERROR_NOT_FINITE ? TRIBO_ERROR_RANGE : status;
    }
    for (int i = 0; i < 3; i++) {
        low[i] -= reach;
        high[i] += reach;
    }
    return TRIBO_OK;
}

tribo_status scene_place_box(tribo_scene *s, uint32_t id, double reach)
{
    scene_slot *slot = &scene_slots(s)[id];
    const tribo_status status = scene_box(slot, &scene_bodies(s)[id], reach, slot->low, slot->high);
    const double margin = slot->radius - slot->radius == 0.0 ? SLACK * slot->radius : 0.0;
    return status == TRIBO_OK ? tree_move(s->tree, id, slot->low, slot->high, margin) : status;
}

/* A tree of the boxes of slots 0 to end - 1, each with the number of its slot. */
tribo_status scene_make_tree(tribo_scene *s, uint32_t capacity, uint32_t end,
                             const scene_slot *slots, scene_buffer *block, tribo_tree **tree)
{
    static const double nowhere[3] = {0.0, 0.0, 0.0};
    uint32_t id = 0;
    tribo_status status = scene_reserve(s, block, tribo_tree_size(capacity), 1);
    if (status == TRIBO_OK) {
        status = tribo_tree_init(block->data, capacity, 0.0, tree);
    }
    for (uint32_t i = 0; status == TRIBO_OK && i < end; i++) {
        const int used = slots[i].used != 0;
        status = tribo_tree_add(*tree, used ? slots[i].low : nowhere,
                                used ? slots[i].high : nowhere, &id);
    }
    for (uint32_t i = 0; status == TRIBO_OK && i < end; i++) {
        if (slots[i].used == 0) {
            status = tribo_tree_remove(*tree, i);
        }
    }
    return status;
}

static tribo_status make_room(tribo_scene *s)
{
    if (s->count < s->tree_capacity) {
        return TRIBO_OK;
    }
    if (s->count == MAX_BODIES) {
        return TRIBO_ERROR_CAPACITY;
    }
    const uint32_t capacity = s->tree_capacity > 0 ? 2u * s->tree_capacity : LEAST_CAPACITY;
    scene_buffer block = {NULL, 0};
    tribo_tree *tree = NULL;
    tribo_status status = scene_grow(s, &s->slots, s->end, capacity, sizeof(scene_slot));
    if (status == TRIBO_OK) {
        status = scene_grow(s, &s->bodies, s->end, capacity, sizeof(tribo_body));
    }
    if (status == TRIBO_OK) {
        status = scene_make_tree(s, capacity, s->end, scene_slots(s), &block, &tree);
    }
    if (status != TRIBO_OK) {
        scene_release(s, &block);
        return status;
    }
    scene_release(s, &s->tree_block);
    s->tree_block = block;
    s->tree = tree;
    s->tree_capacity = capacity;
    return TRIBO_OK;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

tribo_status tribo_scene_body_init(tribo_scene_body *body)
{
    if (!body) {
        return TRIBO_ERROR_NULL;
    }
    memset(body, 0, sizeof *body);
    body->struct_size = sizeof *body;
    body->state.orientation[0] = 1.0;
    body->offset.orientation[0] = 1.0;
    return TRIBO_OK;
}

static tribo_status judge_state(uint32_t kind, const tribo_body *body)
{
    double spin[3];
    const tribo_status status = tribo_body_check(body);
    if (status != TRIBO_OK) {
        return status;
    }
    if (kind == TRIBO_BODY_DYNAMIC) {
        return body->inverse_mass > 0.0 ? tribo_body_spin(body, spin) : TRIBO_ERROR_MASS;
    }
    if (body->inverse_mass != 0.0) {
        return TRIBO_ERROR_MASS;
    }
    for (int i = 0; i < 6; i++) {
        if (body->inverse_inertia[i] != 0.0) {
            return TRIBO_ERROR_INERTIA;
        }
    }
    return kind == TRIBO_BODY_STATIC && scene_moves(body) ? TRIBO_ERROR_RANGE : TRIBO_OK;
}

static tribo_status judge_body(const tribo_scene_body *body)
{
    const uint32_t type = body->shape.type;
    if (body->struct_size != sizeof *body) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    if (body->kind > TRIBO_BODY_STATIC) {
        return TRIBO_ERROR_OPTION;
    }
    tribo_status status = judge_state(body->kind, &body->state);
    if (status == TRIBO_OK) {
        status = tribo_material_check(&body->material);
    }
    if (status == TRIBO_OK && type != 0) {
        status = tribo_shape_check(&body->shape);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    if (!all_finite(body->belt, 3) || !all_finite(body->offset.position, 3) ||
        !all_finite(body->offset.orientation, 4) || !all_finite(&body->rolling, 1) ||
        !all_finite(&body->spinning, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (body->rolling < 0.0 || body->spinning < 0.0) {
        return TRIBO_ERROR_FRICTION;
    }
    const double *q = body->offset.orientation;
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(absolute(length - 1.0) <= 1e-6)) {
        return TRIBO_ERROR_ORIENTATION;
    }
    const int unbounded = type == TRIBO_SHAPE_HALFSPACE || type == TRIBO_SHAPE_MESH;
    return unbounded && body->kind == TRIBO_BODY_DYNAMIC ? TRIBO_ERROR_SHAPE : TRIBO_OK;
}

static int is_identity(const tribo_pose *pose)
{
    const double *x = pose->position;
    const double *q = pose->orientation;
    return x[0] == 0.0 && x[1] == 0.0 && x[2] == 0.0 && q[0] == 1.0 && q[1] == 0.0 && q[2] == 0.0 &&
           q[3] == 0.0;
}

/* Radius about the centre of mass; infinite where the shape has no end. */
static tribo_status measure(scene_slot *slot)
{
    double low[3];
    double high[3];
    double far[3];
    if (slot->shape.type == 0) {
        return TRIBO_OK;
    }
    const tribo_status status = tribo_shape_bounds(&slot->shape, &slot->offset, low, high);
    for (int i = 0; i < 3; i++) {
        far[i] = greater(absolute(low[i]), absolute(high[i]));
    }
    const double sum = far[0] + far[1] + far[2];
    slot->radius = sum - sum == 0.0 ? tribo_vec3_norm(far) : sum;
    return status;
}

static tribo_status fill_slot(const tribo_scene_body *body, scene_slot *slot)
{
    memset(slot, 0, sizeof *slot);
    slot->shape = body->shape;
    slot->offset = body->offset;
    slot->material = body->material;
    memcpy(slot->belt, body->belt, sizeof slot->belt);
    slot->rolling = body->rolling;
    slot->spinning = body->spinning;
    slot->kind = body->kind;
    slot->used = 1;
    slot->is_centred = is_identity(&body->offset) ? 1 : 0;
    tribo_status status = measure(slot);
    if (status == TRIBO_OK) {
        status = scene_box(slot, &body->state, 0.0, slot->low, slot->high);
    }
    return status;
}

tribo_status tribo_scene_add(tribo_scene *scene, const tribo_scene_body *body, uint32_t *id)
{
    scene_slot slot;
    uint32_t place = 0;
    if (!scene || !body || !id) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = judge_body(body);
    if (status == TRIBO_OK) {
        status = fill_slot(body, &slot);
    }
    if (status == TRIBO_OK) {
        status = make_room(scene);
    }
    if (status == TRIBO_OK) {
        status = tribo_tree_add(scene->tree, slot.low, slot.high, &place);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    scene_slots(scene)[place] = slot;
    scene_bodies(scene)[place] = body->state;
    scene->count++;
    scene->end = place < scene->end ? scene->end : place + 1;
    if (body->kind != TRIBO_BODY_DYNAMIC) {
        scene_wake_all(scene);
    }
    *id = place;
    return TRIBO_OK;
}

static int is_used(const tribo_scene *s, uint32_t id)
{
    return id < s->end && scene_slots(s)[id].used != 0;
}

static void forget_points(tribo_scene *s, uint32_t id)
{
    scene_points *points = &s->points[s->points_now];
    scene_points *events = &s->events[s->events_now];
    tribo_scene_contact *c = scene_list(points);
    tribo_scene_event *e = scene_event_list(events);
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++) {
        if (c[i].a != id && c[i].b != id) {
            c[kept++] = c[i];
        }
    }
    points->count = kept;
    kept = 0;
    for (size_t i = 0; i < events->count; i++) {
        if (e[i].a != id && e[i].b != id) {
            e[kept++] = e[i];
        }
    }
    events->count = kept;
}

tribo_status tribo_scene_remove(tribo_scene *scene, uint32_t id)
{
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    if (!is_used(scene, id)) {
        return TRIBO_ERROR_INDEX;
    }
    const tribo_status status = tribo_tree_remove(scene->tree, id);
    if (status != TRIBO_OK) {
        return status;
    }
    scene_wake_neighbours(scene, id);
    forget_points(scene, id);
    memset(&scene_slots(scene)[id], 0, sizeof(scene_slot));
    tribo_body_init(&scene_bodies(scene)[id]);
    scene->count--;
    while (scene->end > 0 && scene_slots(scene)[scene->end - 1].used == 0) {
        scene->end--;
    }
    return TRIBO_OK;
}

/* ---- state ----------------------------------------------------------------------------------- */

tribo_status tribo_scene_counts(const tribo_scene *scene, uint32_t *bodies, uint32_t *end)
{
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    if (bodies) {
        *bodies = scene->count;
    }
    if (end) {
        *end = scene->end;
    }
    return TRIBO_OK;
}

tribo_status tribo_scene_get_body(const tribo_scene *scene, uint32_t id, tribo_body *state,
                                  uint32_t *asleep)
{
    if (!scene || !state) {
        return TRIBO_ERROR_NULL;
    }
    if (!is_used(scene, id)) {
        return TRIBO_ERROR_INDEX;
    }
    *state = scene_bodies(scene)[id];
    if (asleep) {
        *asleep = scene_slots(scene)[id].asleep;
    }
    return TRIBO_OK;
}

static void wake(scene_slot *slot)
{
    slot->asleep = 0;
    slot->rest = 0.0;
}

tribo_status tribo_scene_set_body(tribo_scene *scene, uint32_t id, const tribo_body *state)
{
    double low[3];
    double high[3];
    if (!scene || !state) {
        return TRIBO_ERROR_NULL;
    }
    if (!is_used(scene, id)) {
        return TRIBO_ERROR_INDEX;
    }
    scene_slot *slot = &scene_slots(scene)[id];
    tribo_status status = judge_state(slot->kind, state);
    if (status == TRIBO_OK) {
        status = scene_box(slot, state, 0.0, low, high);
    }
    if (status == TRIBO_OK) {
        status = tribo_tree_move(scene->tree, id, low, high);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    memcpy(slot->low, low, sizeof low);
    memcpy(slot->high, high, sizeof high);
    scene_bodies(scene)[id] = *state;
    if (slot->kind == TRIBO_BODY_DYNAMIC) {
        wake(slot);
        scene_wake_neighbours(scene, id);
    } else {
        scene_wake_all(scene);
    }
    return TRIBO_OK;
}

tribo_status tribo_scene_set_force(tribo_scene *scene, uint32_t id, const double force[3],
                                   const double torque[3])
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const double *f = force ? force : none;
    const double *t = torque ? torque : none;
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    if (!is_used(scene, id)) {
        return TRIBO_ERROR_INDEX;
    }
    if (!all_finite(f, 3) || !all_finite(t, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    scene_slot *slot = &scene_slots(scene)[id];
    if (slot->kind != TRIBO_BODY_DYNAMIC) {
        return TRIBO_ERROR_MASS;
    }
    for (int i = 0; i < 3; i++) {
        if (slot->force[i] != f[i] || slot->torque[i] != t[i]) {
            wake(slot);
        }
    }
    memcpy(slot->force, f, sizeof slot->force);
    memcpy(slot->torque, t, sizeof slot->torque);
    return TRIBO_OK;
}

tribo_status tribo_scene_set_gravity(tribo_scene *scene, const double gravity[3])
{
    if (!scene || !gravity) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(gravity, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    memcpy(scene->settings.gravity, gravity, sizeof scene->settings.gravity);
    scene_wake_all(scene);
    return TRIBO_OK;
}

tribo_status tribo_scene_totals(const tribo_scene *scene, const double origin[3],
                                tribo_totals *totals, double *potential)
{
    static const tribo_body none;
    tribo_totals sum;
    if (!scene || !origin || !totals) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_body *bodies = scene->end > 0 ? scene_bodies(scene) : &none;
    const tribo_status status = tribo_audit_bodies(scene->end, bodies, origin, &sum);
    if (status != TRIBO_OK) {
        return status;
    }
    double height = 0.0;
    for (uint32_t i = 0; i < scene->end; i++) {
        const tribo_body *body = &scene_bodies(scene)[i];
        double arm[3];
        tribo_vec3_subtract(body->position, origin, arm);
        if (body->inverse_mass > 0.0) {
            height -= tribo_vec3_dot(scene->settings.gravity, arm) / body->inverse_mass;
        }
    }
    *totals = sum;
    if (potential) {
        *potential = height;
    }
    return TRIBO_OK;
}

/* ---- contacts and events --------------------------------------------------------------------- */

static tribo_status give_list(const scene_points *list, size_t size, size_t capacity, void *out,
                              size_t *count)
{
    if (!count || (!out && capacity > 0)) {
        return TRIBO_ERROR_NULL;
    }
    *count = list->count;
    if (capacity < list->count) {
        return TRIBO_ERROR_CAPACITY;
    }
    if (list->count > 0) {
        memcpy(out, list->buffer.data, list->count * size);
    }
    return TRIBO_OK;
}

tribo_status tribo_scene_contacts(const tribo_scene *scene, size_t capacity,
                                  tribo_scene_contact *contacts, size_t *count)
{
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    return give_list(&scene->points[scene->points_now], sizeof *contacts, capacity, contacts,
                     count);
}

tribo_status tribo_scene_events(const tribo_scene *scene, size_t capacity,
                                tribo_scene_event *events, size_t *count)
{
    if (!scene) {
        return TRIBO_ERROR_NULL;
    }
    return give_list(&scene->events[scene->events_now], sizeof *events, capacity, events, count);
}
