/* The inside of a scene, and what its files do for each other:
 *
 *   scene.c          bodies in and out, queries
 *   scene_save.c     to a block and back
 *   scene_step.c     the stages of a step in their order
 *   scene_contact.c  which bodies touch, and where: broad phase, manifolds, warm starts
 *   scene_solve.c    problems for tribo_system_solve: impacts, contacts, moving apart
 *   scene_weight.c   impulses that contacts of bodies at rest start from
 *   scene_rest.c     islands, sleep
 *   scene_event.c    what begins, persists and ends */
#ifndef TRIBO_SCENE_PRIVATE_H
#define TRIBO_SCENE_PRIVATE_H

#include <tribo/broad.h>
#include <tribo/collide.h>
#include <tribo/scene.h>

#include "bits.h"

/* What belongs to a body beside its state. Padding is zero: it is saved byte by byte. */
typedef struct scene_slot {
    tribo_shape shape;
    tribo_pose offset;
    tribo_material material;
    double belt[3];
    double rolling, spinning;
    double force[3], torque[3];
    double radius;          /* of a ball around the centre of mass that holds the shape */
    double low[3], high[3]; /* the box in the tree */
    double rest;            /* s of rest so far */
    uint32_t kind;
    uint32_t used;
    uint32_t asleep;
    uint32_t is_centred; /* the offset is none */
} scene_slot;

/* Memory that grows. */
typedef struct scene_buffer {
    void *data;
    size_t bytes;
} scene_buffer;

/* What is kept from a step to the next: points sorted by bodies and children; events by bodies. */
typedef struct scene_points {
    scene_buffer buffer;
    size_t count;
} scene_points;

struct tribo_scene {
    tribo_allocator allocator;
    tribo_scene_settings settings;
    uint32_t count; /* bodies */
    uint32_t end;   /* one more than the greatest id */
    double last_h;  /* s, sub-step that the impulses are of; 0: none yet */
    scene_buffer slots, bodies;
    scene_buffer tree_block;
    tribo_tree *tree;
    uint32_t tree_capacity;
    tribo_sparse *sparse; /* null: not needed yet */

    /* Of three lists one holds what was, two what becomes: a step that fails leaves no trace. */
    scene_points points[3];
    scene_points events[3];
    uint32_t points_now, events_now;

    /* Scratch. */
    scene_buffer kept_slots, kept_bodies;
    scene_buffer kicks, pushed, reaches, firsts, pairs, manifolds, parents, marks;
    scene_buffer traces, rows, picks, impulses, torques, velocities, still, workspace;
    scene_buffer loads, carriers;
};

/* What is known of a contact point within one sub-step. What all stages look at comes first: it is
 * one line of the cache. */
typedef struct scene_trace {
    uint32_t is_active; /* a body of it is awake and dynamic */
    uint32_t is_impact; /* it waits for an impact */
    uint32_t impacts;   /* that it had */
    uint32_t is_held;   /* the contact solve has it */
    uint32_t is_marked; /* its island is the concern of the stage that runs */
    uint32_t unused;
    double margin; /* m, so near it is held in any case */
    double slop;   /* m, overlap that is left alone */
    double normal; /* sum of normal impulses */
    double meets;  /* s from the midpoint on, of a contact that waits for an impact */
    double rolling, spinning;
    tribo_material pair;
    double frame[9];
    double start[3];  /* impulse to start from, contact coordinates */
    double turn[3];   /* the same of the torque */
    double impact[3]; /* impulse of the impact stage, world axes */
    double belt[3];   /* belt of B less that of A, contact coordinates */
} scene_trace;

/* One call of tribo_scene_step. */
typedef struct scene_run {
    tribo_scene *scene;
    tribo_step_options options;
    tribo_step_info info;
    double h;
    uint32_t points_from, points_to; /* lists of the sub-step */
    uint32_t events_from, events_to;
    uint32_t may_sleep; /* some body sleeps, or may */
    uint32_t resists;   /* some contact has a length of resistance */
    uint32_t bounces;   /* some contact has restitution */
} scene_run;

static inline scene_slot *scene_slots(const tribo_scene *s)
{
    return s->slots.data;
}

static inline tribo_body *scene_bodies(const tribo_scene *s)
{
    return s->bodies.data;
}

static inline tribo_scene_contact *scene_list(const scene_points *points)
{
    return points->buffer.data;
}

static inline tribo_scene_event *scene_event_list(const scene_points *events)
{
    return events->buffer.data;
}

static inline int scene_is_awake(const scene_slot *slot)
{
    return slot->used != 0 && slot->kind == TRIBO_BODY_DYNAMIC && slot->asleep == 0;
}

static inline int scene_moves(const tribo_body *body)
{
    const double *v = body->velocity;
    const double *w = body->angular_velocity;
    return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0 || w[0] != 0.0 || w[1] != 0.0 || w[2] != 0.0;
}

/* Whether one more object fits behind `count` of them. */
static inline int scene_has_room(const scene_buffer *buffer, size_t count, size_t size)
{
    return (count + 1) * size <= buffer->bytes;
}

/* scene.c */
tribo_status scene_reserve(tribo_scene *s, scene_buffer *buffer, size_t count, size_t size);
tribo_status scene_grow(tribo_scene *s, scene_buffer *buffer, size_t used, size_t count,
                        size_t size);
void scene_shape_pose(const scene_slot *slot, const tribo_body *body, tribo_pose *pose);
tribo_status scene_box(const scene_slot *slot, const tribo_body *body, double reach, double low[3],
                       double high[3]);
tribo_status scene_place_box(tribo_scene *s, uint32_t id, double reach);
tribo_status scene_make_tree(tribo_scene *s, uint32_t capacity, uint32_t end,
                             const scene_slot *slots, scene_buffer *block, tribo_tree **tree);
void scene_release(tribo_scene *s, scene_buffer *buffer);

/* scene_contact.c */
tribo_status scene_find_contacts(scene_run *run);
tribo_status scene_place_near(scene_run *run, uint32_t i, double reach);
void scene_point_velocity(const tribo_scene *s, const tribo_scene_contact *c, const double *kicks,
                          double u[3]);

/* scene_solve.c */
tribo_status scene_solve_impacts(scene_run *run);
tribo_status scene_solve_contacts(scene_run *run);
tribo_status scene_part_overlaps(scene_run *run, uint32_t *moved);
void scene_move_apart(scene_run *run);

/* scene_weight.c */
tribo_status scene_carry_weight(scene_run *run);

/* scene_rest.c */
tribo_status scene_join_islands(scene_run *run);
void scene_mark_islands(scene_run *run, uint32_t *marks);
void scene_wake_islands(scene_run *run);
tribo_status scene_fall_asleep(scene_run *run);
void scene_wake_neighbours(tribo_scene *s, uint32_t id);
void scene_wake_all(tribo_scene *s);

/* scene_event.c */
tribo_status scene_gather_events(scene_run *run);
tribo_status scene_name_events(scene_run *run);

#endif
