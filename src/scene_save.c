#include "scene.h"

#include "block.h"

#define MAGIC 0x656e656373627274u /* "trbscene" in memory on little-endian machines */
#define FORMAT 2u

/* Head of a block; slots, bodies, points and events follow. */
typedef struct scene_block {
    uint64_t magic;
    uint64_t sum; /* over all other words */
    uint64_t bytes;
    uint32_t format;
    uint32_t version;
    uint32_t count, end;
    uint64_t points, events;
    double last_h;
    tribo_scene_settings settings;
} scene_block;

typedef struct places {
    uint64_t slots, bodies, points, events, bytes;
} places;

static places place_parts(uint64_t end, uint64_t points, uint64_t events)
{
    uint64_t at = sizeof(scene_block);
    places out;
    out.slots = block_place(&at, end * sizeof(scene_slot));
    out.bodies = block_place(&at, end * sizeof(tribo_body));
    out.points = block_place(&at, points * sizeof(tribo_scene_contact));
    out.events = block_place(&at, events * sizeof(tribo_scene_event));
    out.bytes = at;
    return out;
}

static void put_part(void *block, uint64_t at, const void *from, uint64_t bytes)
{
    if (bytes > 0) {
        memcpy((unsigned char *)block + at, from, (size_t)bytes);
    }
}

static void take_part(const void *block, uint64_t at, void *to, uint64_t bytes)
{
    if (bytes > 0) {
        memcpy(to, (const unsigned char *)block + at, (size_t)bytes);
    }
}

tribo_status tribo_scene_save(const tribo_scene *scene, void *block, size_t capacity,
                              size_t *needed)
{
    if (!scene || (!block && capacity > 0)) {
        return TRIBO_ERROR_NULL;
    }
    const scene_points *points = &scene->points[scene->points_now];
    const scene_points *events = &scene->events[scene->events_now];
    const places at = place_parts(scene->end, points->count, events->count);
    scene_block head;
    if (needed) {
        *needed = (size_t)at.bytes;
    }
    if (capacity < at.bytes) {
        return TRIBO_ERROR_CAPACITY;
    }
    memset(&head, 0, sizeof head);
    head.magic = MAGIC;
    head.bytes = at.bytes;
    head.format = FORMAT;
    head.version = tribo_version();
    head.count = scene->count;
    head.end = scene->end;
    head.points = points->count;
    head.events = events->count;
    head.last_h = scene->last_h;
    head.settings = scene->settings;
    memset(block, 0, (size_t)at.bytes);
    put_part(block, 0, &head, sizeof head);
    put_part(block, at.slots, scene->slots.data, scene->end * sizeof(scene_slot));
    put_part(block, at.bodies, scene->bodies.data, scene->end * sizeof(tribo_body));
    put_part(block, at.points, points->buffer.data, points->count * sizeof(tribo_scene_contact));
    put_part(block, at.events, events->buffer.data, events->count * sizeof(tribo_scene_event));
    head.sum = block_sum(block, at.bytes, offsetof(scene_block, sum));
    put_part(block, 0, &head, sizeof head);
    return TRIBO_OK;
}

static tribo_status judge_block(const void *block, size_t size, scene_block *head)
{
    if (!block_is_aligned(block) || size < sizeof *head) {
        return TRIBO_ERROR_DATA;
    }
    memcpy(head, block, sizeof *head);
    if (head->magic != MAGIC || head->format != FORMAT || head->version != tribo_version() ||
        head->bytes > size || head->end > head->bytes / sizeof(scene_slot) ||
        head->points > head->bytes / sizeof(tribo_scene_contact) ||
        head->events > head->bytes / sizeof(tribo_scene_event) ||
        head->bytes != place_parts(head->end, head->points, head->events).bytes ||
        head->sum != block_sum(block, head->bytes, offsetof(scene_block, sum))) {
        return TRIBO_ERROR_DATA;
    }
    return TRIBO_OK;
}

/* What a scene is made of anew before the old is let go. */
typedef struct fresh_state {
    scene_buffer slots, bodies, tree_block;
    scene_points points, events;
    tribo_tree *tree;
    uint32_t capacity;
} fresh_state;

static uint32_t capacity_for(uint32_t end)
{
    uint32_t capacity = 16;
    while (capacity < end) {
        capacity *= 2;
    }
    return capacity;
}

static tribo_status read_parts(tribo_scene *s, const void *block, const scene_block *head,
                               fresh_state *out)
{
    const places at = place_parts(head->end, head->points, head->events);
    out->capacity = capacity_for(head->end);
    tribo_status status = scene_reserve(s, &out->slots, out->capacity, sizeof(scene_slot));
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &out->bodies, out->capacity, sizeof(tribo_body));
    }
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &out->points.buffer, (size_t)head->points + 1,
                               sizeof(tribo_scene_contact));
    }
    if (status == TRIBO_OK) {
        status = scene_reserve(s, &out->events.buffer, (size_t)head->events + 1,
                               sizeof(tribo_scene_event));
    }
    if (status != TRIBO_OK) {
        return status;
    }
    take_part(block, at.slots, out->slots.data, head->end * sizeof(scene_slot));
    take_part(block, at.bodies, out->bodies.data, head->end * sizeof(tribo_body));
    take_part(block, at.points, out->points.buffer.data,
              head->points * sizeof(tribo_scene_contact));
    take_part(block, at.events, out->events.buffer.data, head->events * sizeof(tribo_scene_event));
    out->points.count = (size_t)head->points;
    out->events.count = (size_t)head->events;
    return scene_make_tree(s, out->capacity, head->end, out->slots.data, &out->tree_block,
                           &out->tree);
}

static void swap_buffers(scene_buffer *x, scene_buffer *y)
{
    const scene_buffer kept = *x;
    *x = *y;
    *y = kept;
}

static void exchange(tribo_scene *s, fresh_state *state)
{
    swap_buffers(&s->slots, &state->slots);
    swap_buffers(&s->bodies, &state->bodies);
    swap_buffers(&s->tree_block, &state->tree_block);
    swap_buffers(&s->points[s->points_now].buffer, &state->points.buffer);
    swap_buffers(&s->events[s->events_now].buffer, &state->events.buffer);
    s->points[s->points_now].count = state->points.count;
    s->events[s->events_now].count = state->events.count;
    s->tree = state->tree;
    s->tree_capacity = state->capacity;
}

static void let_go(tribo_scene *s, fresh_state *state)
{
    scene_release(s, &state->slots);
    scene_release(s, &state->bodies);
    scene_release(s, &state->tree_block);
    scene_release(s, &state->points.buffer);
    scene_release(s, &state->events.buffer);
}

tribo_status tribo_scene_load(tribo_scene *scene, const void *block, size_t size)
{
    fresh_state state;
    scene_block head;
    if (!scene || !block) {
        return TRIBO_ERROR_NULL;
    }
    memset(&state, 0, sizeof state);
    tribo_status status = judge_block(block, size, &head);
    if (status != TRIBO_OK) {
        return status;
    }
    status = read_parts(scene, block, &head, &state);
    if (status == TRIBO_OK) {
        exchange(scene, &state);
        scene->count = head.count;
        scene->end = head.end;
        scene->last_h = head.last_h;
        scene->settings = head.settings;
    }
    let_go(scene, &state);
    return status;
}
