#include "scene.h"

/* ---- what happens in a sub-step -------------------------------------------------------------- */

static int compare(const tribo_scene_event *x, const tribo_scene_event *y)
{
    if (x->a != y->a) {
        return x->a < y->a ? -1 : 1;
    }
    return x->b < y->b ? -1 : x->b > y->b;
}

/* Sum up the points from *at on that are of the same bodies; *at moves behind them. Returns whether
 * the bodies touch. */
static int sum_pair(const scene_run *run, size_t *at, tribo_scene_event *event)
{
    const tribo_scene *s = run->scene;
    const scene_points *points = &s->points[run->points_to];
    const tribo_scene_contact *c = scene_list(points) + *at;
    int touch = 0;
    memset(event, 0, sizeof *event);
    event->a = c->a;
    event->b = c->b;
    for (; *at < points->count && c->a == event->a && c->b == event->b; ++*at, c++) {
        const scene_trace *trace = (const scene_trace *)s->traces.data + *at;
        touch = touch || c->distance <= 0.0 || trace->normal > 0.0;
        event->impacts += trace->impacts;
        event->normal += trace->normal;
        tribo_vec3_add(event->impulse, c->impulse, event->impulse);
        if (run->bounces != 0) {
            tribo_vec3_add(event->impulse, trace->impact, event->impulse);
        }
    }
    return touch;
}

static tribo_status put(tribo_scene *s, scene_points *list, const tribo_scene_event *event)
{
    tribo_status status = TRIBO_OK;
    if (!scene_has_room(&list->buffer, list->count, sizeof *event)) {
        status = scene_grow(s, &list->buffer, list->count, list->count + 1, sizeof *event);
    }
    if (status == TRIBO_OK) {
        scene_event_list(list)[list->count++] = *event;
    }
    return status;
}

static void add_event(const tribo_scene_event *more, tribo_scene_event *sum)
{
    sum->impacts += more->impacts;
    sum->normal += more->normal;
    tribo_vec3_add(sum->impulse, more->impulse, sum->impulse);
}

/* Merge what happened in this sub-step into what happened in those before. */
tribo_status scene_gather_events(scene_run *run)
{
    tribo_scene *s = run->scene;
    const scene_points *from = &s->events[run->events_from];
    scene_points *to = &s->events[run->events_to];
    const size_t count = s->points[run->points_to].count;
    tribo_status status = TRIBO_OK;
    size_t old = 0;
    size_t at = 0;
    to->count = 0;
    while (status == TRIBO_OK && at < count) {
        tribo_scene_event event;
        if (!sum_pair(run, &at, &event)) {
            continue;
        }
        while (status == TRIBO_OK && old < from->count &&
               compare(&scene_event_list(from)[old], &event) < 0) {
            status = put(s, to, &scene_event_list(from)[old++]);
        }
        if (old < from->count && compare(&scene_event_list(from)[old], &event) == 0) {
            add_event(&scene_event_list(from)[old++], &event);
        }
        if (status == TRIBO_OK) {
            status = put(s, to, &event);
        }
    }
    while (status == TRIBO_OK && old < from->count) {
        status = put(s, to, &scene_event_list(from)[old++]);
    }
    return status;
}

/* ---- what a step is told as ------------------------------------------------------------------ */

static int touched(const tribo_scene_event *event)
{
    return event->kind != TRIBO_EVENT_END;
}

static tribo_status put_end(tribo_scene *s, scene_points *list, const tribo_scene_event *last)
{
    tribo_scene_event event;
    if (!touched(last)) {
        return TRIBO_OK;
    }
    memset(&event, 0, sizeof event);
    event.kind = TRIBO_EVENT_END;
    event.a = last->a;
    event.b = last->b;
    return put(s, list, &event);
}

/* Compare what was gathered with the events of the last step. */
tribo_status scene_name_events(scene_run *run)
{
    tribo_scene *s = run->scene;
    const scene_points *last = &s->events[s->events_now];
    const scene_points *from = &s->events[run->events_from];
    scene_points *to = &s->events[run->events_to];
    tribo_status status = TRIBO_OK;
    size_t old = 0;
    to->count = 0;
    for (size_t i = 0; status == TRIBO_OK && i < from->count; i++) {
        tribo_scene_event event = scene_event_list(from)[i];
        const tribo_scene_event *before = scene_event_list(last);
        while (status == TRIBO_OK && old < last->count && compare(&before[old], &event) < 0) {
            status = put_end(s, to, &before[old++]);
        }
        event.kind = TRIBO_EVENT_BEGIN;
        if (old < last->count && compare(&before[old], &event) == 0) {
            event.kind = touched(&before[old++]) ? TRIBO_EVENT_PERSIST : TRIBO_EVENT_BEGIN;
        }
        if (status == TRIBO_OK) {
            status = put(s, to, &event);
        }
    }
    while (status == TRIBO_OK && old < last->count) {
        status = put_end(s, to, &scene_event_list(last)[old++]);
    }
    return status;
}
