#include "scene.h"

/* ---- islands: dynamic bodies that contacts join ---------------------------------------------- */

static uint32_t root_of(uint32_t *parents, uint32_t i)
{
    while (parents[i] != i) {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    return i;
}

static int is_dynamic(const tribo_scene *s, uint32_t i)
{
    return scene_slots(s)[i].kind == TRIBO_BODY_DYNAMIC;
}

/* parents: of each body the least of its island. */
tribo_status scene_join_islands(scene_run *run)
{
    tribo_scene *s = run->scene;
    const scene_points *points = &s->points[run->points_to];
    tribo_status status = scene_reserve(s, &s->parents, s->end, sizeof(uint32_t));
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &s->marks, s->end, sizeof(uint32_t));
    }
    if (status != TRIBO_OK) {
        return status;
    }
    uint32_t *parents = s->parents.data;
    for (uint32_t i = 0; i < s->end; i++) {
        parents[i] = i;
    }
    for (size_t i = 0; i < points->count; i++) {
        const tribo_scene_contact *c = &scene_list(points)[i];
        if (is_dynamic(s, c->a) && is_dynamic(s, c->b)) {
            const uint32_t a = root_of(parents, c->a);
            const uint32_t b = root_of(parents, c->b);
            parents[a < b ? b : a] = a < b ? a : b;
        }
    }
    for (uint32_t i = 0; i < s->end; i++) {
        parents[i] = root_of(parents, i);
    }
    return TRIBO_OK;
}

/* Spread marks over islands: each body gets those of all in it, or'ed. */
static void spread(const tribo_scene *s, uint32_t *marks)
{
    const uint32_t *parents = s->parents.data;
    for (uint32_t i = 0; i < s->end; i++) {
        marks[parents[i]] |= marks[i];
    }
    for (uint32_t i = 0; i < s->end; i++) {
        marks[i] = marks[parents[i]];
    }
}

/* Mark the islands of contacts that are marked. */
void scene_mark_islands(scene_run *run, uint32_t *marks)
{
    tribo_scene *s = run->scene;
    const scene_points *points = &s->points[run->points_to];
    const scene_trace *traces = s->traces.data;
    memset(marks, 0, s->end * sizeof *marks);
    for (size_t i = 0; i < points->count; i++) {
        const tribo_scene_contact *c = &scene_list(points)[i];
        if (traces[i].is_marked != 0) {
            marks[is_dynamic(s, c->a) ? c->a : c->b] = 1;
        }
    }
    spread(s, marks);
}

/* ---- sleep ----------------------------------------------------------------------------------- */

static void wake(scene_slot *slot)
{
    slot->asleep = 0;
    slot->rest = 0.0;
}

void scene_wake_all(tribo_scene *s)
{
    for (uint32_t i = 0; i < s->end; i++) {
        wake(&scene_slots(s)[i]);
    }
}

void scene_wake_neighbours(tribo_scene *s, uint32_t id)
{
    const scene_points *points = &s->points[s->points_now];
    for (size_t i = 0; i < points->count; i++) {
        const tribo_scene_contact *c = &scene_list(points)[i];
        if (c->a == id || c->b == id) {
            wake(&scene_slots(s)[c->a]);
            wake(&scene_slots(s)[c->b]);
        }
    }
}

static int is_pushed(const tribo_scene *s, uint32_t i)
{
    return scene_slots(s)[i].kind == TRIBO_BODY_KINEMATIC && scene_moves(&scene_bodies(s)[i]);
}

/* Mark islands that a moving kinematic body touches. */
static void mark_pushed(const scene_run *run, uint32_t *marks)
{
    const tribo_scene *s = run->scene;
    const scene_points *points = &s->points[run->points_to];
    for (size_t i = 0; i < points->count; i++) {
        const tribo_scene_contact *c = &scene_list(points)[i];
        if (is_pushed(s, c->a)) {
            marks[c->b] = 1;
        }
        if (is_pushed(s, c->b)) {
            marks[c->a] = 1;
        }
    }
}

/* All sleep, or none. */
void scene_wake_islands(scene_run *run)
{
    tribo_scene *s = run->scene;
    uint32_t *marks = s->marks.data;
    for (uint32_t i = 0; i < s->end; i++) {
        marks[i] = scene_is_awake(&scene_slots(s)[i]) ? 1 : 0;
    }
    mark_pushed(run, marks);
    spread(s, marks);
    for (uint32_t i = 0; i < s->end; i++) {
        if (marks[i] != 0 && scene_slots(s)[i].asleep != 0) {
            wake(&scene_slots(s)[i]);
        }
    }
}

static int is_at_rest(const scene_run *run, const scene_slot *slot, const tribo_body *body)
{
    const double turn = tribo_vec3_norm(body->angular_velocity);
    return tribo_vec3_norm(body->velocity) + turn * slot->radius < run->options.sleep_speed;
}

static tribo_status put_to_sleep(scene_run *run, uint32_t i)
{
    tribo_scene *s = run->scene;
    tribo_body *body = &scene_bodies(s)[i];
    scene_slots(s)[i].asleep = 1;
    memset(body->velocity, 0, sizeof body->velocity);
    memset(body->angular_velocity, 0, sizeof body->angular_velocity);
    return scene_place_near(run, i, 0.0);
}

/* Islands are those of the contacts at the midpoint. */
tribo_status scene_fall_asleep(scene_run *run)
{
    tribo_scene *s = run->scene;
    uint32_t *marks = s->marks.data;
    tribo_status status = TRIBO_OK;
    for (uint32_t i = 0; i < s->end; i++) {
        scene_slot *slot = &scene_slots(s)[i];
        marks[i] = 0;
        if (scene_is_awake(slot)) {
            slot->rest = is_at_rest(run, slot, &scene_bodies(s)[i]) ? slot->rest + run->h : 0.0;
            marks[i] = slot->rest < run->options.sleep_time ? 1 : 0;
        }
    }
    mark_pushed(run, marks);
    spread(s, marks);
    for (uint32_t i = 0; status == TRIBO_OK && i < s->end; i++) {
        if (marks[i] == 0 && scene_is_awake(&scene_slots(s)[i])) {
            status = put_to_sleep(run, i);
        }
    }
    return status;
}
