/* Speed against error of scenes in time, beside other engines in one run.
 *
 *   scene [SECONDS [NAME...]]   most processor seconds for a run (TRIBO_BENCH_SECONDS of the
 *                               environment, or 3), and which scenes: all if none is named
 *
 * All engines get the same bodies, the same places and steps of 1/240 s, and are judged by the same
 * code from where the bodies are at the end. The time is that of one thread, per step, collision
 * included, the least of repetitions for 0.2 s. Beside the error of the scene: the deepest overlap
 * at the end, m, as tribo's collision finds it, and the greatest speed then, m/s. What does not
 * get to the end in its seconds is told and not compared. For each scene there is a plot beside the
 * program, if there is gnuplot. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/scene.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "peers/engine.h"
#include "peers/load.h"

enum { ENGINES = 48, MOST_BODIES = 2000 };

static const double gravity = 9.81;
static const double dt = 1.0 / 240.0;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *allocate(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (!made) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return made;
}

/* ---- tribo ----------------------------------------------------------------------------------- */

typedef struct own_setting {
    const char *name;
    int most_bodies; /* Newton has steps of seconds where there are more */
    tribo_step_options options;
} own_setting;

#define OPTIONS .struct_size = sizeof(tribo_step_options)

static const own_setting settings[] = {
    {"default", MOST_BODIES, {OPTIONS}},
    {"1e-9", MOST_BODIES, {OPTIONS, .tolerance = 1e-9}},
    {"1e-6", MOST_BODIES, {OPTIONS, .tolerance = 1e-6}},
    {"1e-3", MOST_BODIES, {OPTIONS, .tolerance = 1e-3}},
    {"GS 50, 1e-6",
     INT32_MAX,
     {OPTIONS, .tolerance = 1e-6, .max_iterations = 50, .solver = TRIBO_SOLVER_GAUSS_SEIDEL}},
    {"GS 10, 1e-3",
     INT32_MAX,
     {OPTIONS, .tolerance = 1e-3, .max_iterations = 10, .solver = TRIBO_SOLVER_GAUSS_SEIDEL}},
    {"GS 4, 1e-2",
     INT32_MAX,
     {OPTIONS, .tolerance = 1e-2, .max_iterations = 4, .solver = TRIBO_SOLVER_GAUSS_SEIDEL}},
};

typedef struct own_world {
    tribo_scene *scene;
    const tribo_step_options *options;
} own_world;

static void demand(tribo_status status, const char *what)
{
    if (status != TRIBO_OK) {
        fprintf(stderr, "%s: %s\n", what, tribo_status_string(status));
        exit(1);
    }
}

static void own_body(const engine_body *from, double mu, tribo_scene_body *to)
{
    static const uint32_t types[] = {[PEER_SPHERE] = TRIBO_SHAPE_SPHERE,
                                     [PEER_BOX] = TRIBO_SHAPE_BOX,
                                     [PEER_PLANE] = TRIBO_SHAPE_HALFSPACE};
    demand(tribo_scene_body_init(to), "body");
    to->kind = from->mass > 0.0 ? TRIBO_BODY_DYNAMIC : TRIBO_BODY_STATIC;
    to->shape.type = types[from->kind];
    memcpy(to->shape.size, from->size, sizeof from->size);
    to->material = (tribo_material){mu, mu, 0.0};
    memcpy(to->state.position, from->position, sizeof from->position);
    memcpy(to->state.orientation, from->orientation, sizeof from->orientation);
    memcpy(to->state.velocity, from->velocity, sizeof from->velocity);
    if (from->mass > 0.0) {
        to->state.inverse_mass = 1.0 / from->mass;
        to->state.inverse_inertia[0] = 1.0 / from->inertia[0];
        to->state.inverse_inertia[3] = 1.0 / from->inertia[1];
        to->state.inverse_inertia[5] = 1.0 / from->inertia[2];
    } else {
        to->state.inverse_mass = 0.0;
        memset(to->state.inverse_inertia, 0, sizeof to->state.inverse_inertia);
    }
}

static tribo_scene *own_scene(const engine_scene *from)
{
    tribo_scene_settings s = {.struct_size = sizeof s, .friction_rule = TRIBO_MIX_MAXIMUM};
    tribo_scene *scene = NULL;
    memcpy(s.gravity, from->gravity, sizeof s.gravity);
    demand(tribo_scene_create(&s, NULL, &scene), "scene");
    for (int i = 0; i < from->count; i++) {
        tribo_scene_body body;
        uint32_t id;
        own_body(&from->bodies[i], from->friction, &body);
        demand(tribo_scene_add(scene, &body, &id), "add");
    }
    return scene;
}

static void *own_make(const engine_scene *from, int choice)
{
    if (from->count > settings[choice].most_bodies) {
        return NULL;
    }
    own_world *world = allocate(1, sizeof *world);
    world->scene = own_scene(from);
    world->options = &settings[choice].options;
    return world;
}

static void own_step(void *data)
{
    own_world *world = data;
    demand(tribo_scene_step(world->scene, dt, world->options, NULL), "step");
}

static void own_state(void *data, int i, engine_state *out)
{
    const own_world *world = data;
    tribo_body body;
    demand(tribo_scene_get_body(world->scene, (uint32_t)i, &body, NULL), "state");
    memcpy(out->position, body.position, sizeof out->position);
    memcpy(out->orientation, body.orientation, sizeof out->orientation);
    memcpy(out->velocity, body.velocity, sizeof out->velocity);
    memcpy(out->angular_velocity, body.angular_velocity, sizeof out->angular_velocity);
}

static void own_drop(void *data)
{
    own_world *world = data;
    tribo_scene_destroy(world->scene);
    free(world);
}

/* ---- engines --------------------------------------------------------------------------------- */

static engine engines[ENGINES];
static int engine_count;

static void add_engine(const engine *e)
{
    if (engine_count < ENGINES) {
        engines[engine_count++] = *e;
    }
}

static void find_engines(const char *program)
{
    static const char *const names[] = {"engine_ode", "engine_bullet", "engine_box3d"};
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        const engine e = {"tribo",  settings[i].name, (int)i,    0,
                          own_make, own_step,         own_state, own_drop};
        add_engine(&e);
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        int count = 0;
        engine_list_function list = NULL;
        *(void **)&list = load_peer(program, names[i], ENGINE_LIST); /* as POSIX has it */
        const engine *first = list != NULL ? list(&count) : NULL;
        for (int k = 0; k < count; k++) {
            add_engine(&first[k]);
        }
    }
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* Bodies in the making. */
typedef struct heap {
    engine_body *bodies;
    int count, room;
} heap;

static engine_body *put(heap *h, int kind, double x, double y, double z)
{
    if (h->count == h->room) {
        h->room = 2 * h->room + 16;
        h->bodies = realloc(h->bodies, (size_t)h->room * sizeof *h->bodies);
        if (!h->bodies) {
            fprintf(stderr, "out of memory\n");
            exit(1);
        }
    }
    engine_body *body = &h->bodies[h->count++];
    memset(body, 0, sizeof *body);
    body->kind = kind;
    body->position[0] = x;
    body->position[1] = y;
    body->position[2] = z;
    body->orientation[0] = 1.0;
    return body;
}

static void put_floor(heap *h)
{
    put(h, PEER_PLANE, 0.0, 0.0, 0.0)->size[2] = 1.0;
}

static engine_body *put_box(heap *h, double mass, double x, double y, double z, double hx,
                            double hy, double hz)
{
    engine_body *body = put(h, PEER_BOX, x, y, z);
    const double half[3] = {hx, hy, hz};
    body->mass = mass;
    for (int k = 0; k < 3; k++) {
        const double a = half[(k + 1) % 3];
        const double b = half[(k + 2) % 3];
        body->size[k] = half[k];
        body->inertia[k] = mass / 3.0 * (a * a + b * b);
    }
    return body;
}

static void make_slide(heap *h)
{
    put_floor(h);
    put_box(h, 1.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5);
}

static void make_stack(heap *h)
{
    put_floor(h);
    for (int i = 0; i < 10; i++) {
        put_box(h, 1.0, 0.0, 0.0, 0.5 + i, 0.5, 0.5, 0.5);
    }
}

static void make_ratio(heap *h)
{
    put_floor(h);
    put_box(h, 1.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5);
    put_box(h, 1000.0, 0.0, 0.0, 1.5, 0.5, 0.5, 0.5);
}

/* Rows of `base` bricks and fewer, each on two. */
static void make_wall(heap *h, int base, double hx, double hz)
{
    put_floor(h);
    for (int row = 0; row < base; row++) {
        for (int i = 0; i < base - row; i++) {
            const double x = 2.2 * hx * (i + 0.5 * row - 0.5 * (base - 1));
            put_box(h, 1.0, x, 0.0, hz * (1 + 2 * row), hx, 0.5, hz);
        }
    }
}

static void make_wall91(heap *h)
{
    make_wall(h, 13, 0.5, 0.25);
}

static void make_pyramid(heap *h)
{
    make_wall(h, 100, 0.5, 0.5);
}

static double noise(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 16777216.0 - 0.5;
}

/* Spheres and boxes by turns, a little above each other, in a bin without a lid. */
static void make_pile(heap *h)
{
    static const double walls[5][4] = {{0.0, 0.0, 1.0, 0.0},
                                       {1.0, 0.0, 0.0, -11.5},
                                       {-1.0, 0.0, 0.0, -11.5},
                                       {0.0, 1.0, 0.0, -11.5},
                                       {0.0, -1.0, 0.0, -11.5}};
    unsigned seed = 1;
    for (int k = 0; k < 5; k++) {
        memcpy(put(h, PEER_PLANE, 0.0, 0.0, 0.0)->size, walls[k], sizeof walls[k]);
    }
    for (int i = 0; i < 10000; i++) {
        const int layer = i / 400;
        const double x = 1.1 * (i % 20 - 9.5) + 0.08 * noise(&seed);
        const double y = 1.1 * (i / 20 % 20 - 9.5) + 0.08 * noise(&seed);
        const double z = 0.55 + 1.05 * layer;
        engine_body *body = put_box(h, 1.0, x, y, z, 0.5, 0.5, 0.5);
        if ((i + i / 20 + layer) % 2 != 0) {
            body->kind = PEER_SPHERE;
            body->size[1] = body->size[2] = 0.0;
            body->inertia[0] = body->inertia[1] = body->inertia[2] = 0.1;
        }
    }
}

typedef struct task {
    const char *name;
    const char *error; /* what the error is, and its unit */
    void (*make)(heap *h);
    double seconds;
    double slope; /* tangent of the angle of gravity to the floor's normal */
    int runs;
    double (*judge)(const engine_scene *scene, const engine_state *ends);
} task;

/* The greatest way of a body from where it was laid. */
static double drift(const engine_scene *scene, const engine_state *ends)
{
    double most = 0.0;
    for (int i = 0; i < scene->count; i++) {
        double way[3];
        tribo_vec3_subtract(ends[i].position, scene->bodies[i].position, way);
        const double size = tribo_vec3_norm(way);
        if (scene->bodies[i].mass > 0.0 && !(size <= most)) {
            most = size;
        }
    }
    return most;
}

#define FIRST_SPEED 5.0
static const double headings[3] = {0.0, 22.5, 45.0};

static void head(heap *h, int run)
{
    const double a = headings[run] * 3.14159265358979323846 / 180.0;
    h->bodies[1].velocity[0] = FIRST_SPEED * cos(a);
    h->bodies[1].velocity[1] = FIRST_SPEED * sin(a);
}

static double stop_error(const engine_scene *scene, const engine_state *ends)
{
    const double way = FIRST_SPEED * FIRST_SPEED / (2.0 * scene->friction * gravity);
    const double *v = scene->bodies[1].velocity;
    const double *p = ends[1].position;
    return hypot(p[0] - way * v[0] / FIRST_SPEED, p[1] - way * v[1] / FIRST_SPEED) / way;
}

/* What is left of motion: the greatest speed of a body at the end. */
static double restlessness(const engine_scene *scene, const engine_state *ends)
{
    double most = 0.0;
    for (int i = 0; i < scene->count; i++) {
        most = fmax(most, tribo_vec3_norm(ends[i].velocity));
    }
    return most;
}

static double overlap(const engine_scene *scene, const engine_state *ends)
{
    engine_scene end = *scene;
    heap h = {0};
    for (int i = 0; i < scene->count; i++) {
        const engine_body *from = &scene->bodies[i];
        engine_body *to = put(&h, from->kind, 0.0, 0.0, 0.0);
        *to = *from;
        memset(to->velocity, 0, sizeof to->velocity);
        if (from->mass > 0.0) {
            memcpy(to->position, ends[i].position, sizeof to->position);
            memcpy(to->orientation, ends[i].orientation, sizeof to->orientation);
            if (tribo_quat_normalize(to->orientation, to->orientation) != TRIBO_OK) {
                free(h.bodies);
                return HUGE_VAL;
            }
        }
    }
    end.bodies = h.bodies;
    tribo_scene *own = own_scene(&end);
    const tribo_step_options options = {OPTIONS, .max_iterations = 1,
                                        .skip = TRIBO_SKIP_CORRECTION | TRIBO_SKIP_SPECULATION,
                                        .solver = TRIBO_SOLVER_GAUSS_SEIDEL};
    tribo_step_info info = {.struct_size = sizeof info};
    const tribo_status status = tribo_scene_step(own, 1e-9, &options, &info);
    tribo_scene_destroy(own);
    free(h.bodies);
    return status == TRIBO_OK ? info.penetration : HUGE_VAL;
}

static double pile_error(const engine_scene *scene, const engine_state *ends)
{
    return overlap(scene, ends);
}

static const task tasks[] = {
    {"slide", "of the way to stop, at 0, 22.5 and 45 degrees", make_slide, 2.0, 0.0, 3, stop_error},
    {"incline", "m, way of a box that sticks", make_slide, 10.0, 0.45, 1, drift},
    {"stack", "m, greatest way of a box", make_stack, 10.0, 0.0, 1, drift},
    {"ratio", "m, greatest way of a box", make_ratio, 5.0, 0.0, 1, drift},
    {"wall", "m, greatest way of a brick", make_wall91, 1.0, 0.0, 1, drift},
    {"pyramid", "m, greatest way of a brick", make_pyramid, 0.125, 0.0, 1, drift},
    {"pile", "m, deepest overlap", make_pile, 0.25, 0.0, 1, pile_error},
};

/* ---- runs ------------------------------------------------------------------------------------ */

typedef struct point {
    double us; /* per step */
    double error, overlap, speed;
    int done, steps; /* 0 done: the engine can not make the scene */
} point;

static const double repeat_seconds = 0.2;

static int are_finite(const engine_scene *scene, const engine_state *ends)
{
    double probe = 0.0;
    for (int i = 0; i < scene->count; i++) {
        for (int k = 0; k < 3; k++) {
            probe += 0.0 * (ends[i].position[k] + ends[i].velocity[k] + ends[i].orientation[k]);
        }
    }
    return probe == 0.0;
}

static void judge_world(const engine *e, void *world, const task *t, const engine_scene *scene,
                        point *out)
{
    engine_state *ends = allocate((size_t)scene->count, sizeof *ends);
    for (int i = 0; i < scene->count; i++) {
        if (scene->bodies[i].mass > 0.0) {
            e->state(world, i, &ends[i]);
        }
    }
    const int sane = are_finite(scene, ends);
    out->error = sane ? t->judge(scene, ends) : HUGE_VAL;
    out->overlap = sane ? overlap(scene, ends) : HUGE_VAL;
    out->speed = sane ? restlessness(scene, ends) : HUGE_VAL;
    free(ends);
}

/* The clock is asked every few steps: asking takes a third of a microsecond. */
static double do_steps(const engine *e, void *world, double seconds, point *out)
{
    const double start = now();
    double spent = 0.0;
    while (out->done < out->steps && spent <= seconds) {
        e->step(world);
        out->done++;
        if (out->done % 16 == 0 || spent > 0.01 || out->done == 1 || out->done == out->steps) {
            spent = now() - start;
        }
    }
    return spent;
}

static point run_once(const engine *e, const task *t, int run, double seconds)
{
    heap h = {0};
    point out = {.steps = (int)(t->seconds / dt + 0.5)};
    const double steep = atan(t->slope);
    t->make(&h);
    if (t->judge == stop_error) {
        head(&h, run);
    }
    const engine_scene scene = {
        h.count, h.bodies, {gravity * sin(steep), 0.0, -gravity * cos(steep)}, 0.5, dt};
    void *world = e->make(&scene, e->choice);
    if (world) {
        out.us = 1e6 * do_steps(e, world, seconds, &out) / out.done;
        judge_world(e, world, t, &scene, &out);
        e->drop(world);
    }
    free(h.bodies);
    return out;
}

/* The least time of repetitions, the greatest errors of the runs. */
static point run_engine(const engine *e, const task *t, double seconds)
{
    point out = {.us = HUGE_VAL};
    for (int run = 0; run < t->runs; run++) {
        double spent = 0.0;
        do {
            const point p = run_once(e, t, run, seconds);
            spent += 1e-6 * p.us * p.done;
            out.us = fmin(out.us, p.us);
            out.error = fmax(out.error, p.error);
            out.overlap = fmax(out.overlap, p.overlap);
            out.speed = fmax(out.speed, p.speed);
            out.done = p.done;
            out.steps = p.steps;
        } while (out.done > 0 && spent < repeat_seconds);
    }
    return out;
}

/* ---- what comes of it ------------------------------------------------------------------------ */

static int is_own(const engine *e)
{
    return e->make == own_make;
}

static int is_whole(const point *p)
{
    return p->done > 0 && p->done == p->steps && isfinite(p->error);
}

static void print_point(const engine *e, const point *p)
{
    printf("%-7s %-15s ", e->name, e->setting);
    if (p->done == 0) {
        printf("not run\n");
        return;
    }
    printf("%11.2f %9.1e %9.1e %9.1e", p->us, p->error, p->overlap, p->speed);
    if (p->done < p->steps) {
        printf("  after %d of %d steps: not compared", p->done, p->steps);
    }
    printf("\n");
}

/* Whether some setting of tribo is as fast and as exact. */
static int is_beaten(const point *points, const point *other)
{
    for (int k = 0; k < engine_count; k++) {
        if (is_own(&engines[k]) && is_whole(&points[k]) && points[k].us <= other->us &&
            points[k].error <= other->error) {
            return 1;
        }
    }
    return 0;
}

/* Whether a peer is faster and more exact than some setting of tribo that no other beats. */
static int beats_front(const point *points, const point *other)
{
    for (int k = 0; k < engine_count; k++) {
        const point *own = &points[k];
        const point before = {.us = nextafter(own->us, 0.0), .error = own->error};
        if (is_own(&engines[k]) && is_whole(own) && !is_beaten(points, &before) &&
            other->us < own->us && other->error < own->error) {
            return 1;
        }
    }
    return 0;
}

static void print_verdict(const point *points)
{
    int peers = 0;
    int worse = 0;
    for (int k = 0; k < engine_count; k++) {
        const point *p = &points[k];
        if (is_own(&engines[k]) || !is_whole(p)) {
            continue;
        }
        peers++;
        if (is_beaten(points, p)) {
            worse++;
        } else if (beats_front(points, p)) {
            printf("below and left of tribo's curve: %s %s\n", engines[k].name, engines[k].setting);
        } else {
            printf("left of all tribo's points as exact: %s %s\n", engines[k].name,
                   engines[k].setting);
        }
    }
    printf("%d of %d settings of peers are slower and less exact than one of tribo\n", worse,
           peers);
}

/* ---- plots ----------------------------------------------------------------------------------- */

static void put_points(FILE *gnuplot, const char *name, const point *points)
{
    fprintf(gnuplot, "$%s << END\n", name);
    for (int k = 0; k < engine_count; k++) {
        if (strcmp(engines[k].name, name) == 0 && is_whole(&points[k])) {
            fprintf(gnuplot, "%.6g %.6g\n", points[k].us, fmax(points[k].error, 1e-16));
        }
    }
    fputs("END\n", gnuplot);
}

static int has_points(const char *name, const point *points)
{
    for (int k = 0; k < engine_count; k++) {
        if (strcmp(engines[k].name, name) == 0 && is_whole(&points[k])) {
            return 1;
        }
    }
    return 0;
}

/* SVG beside the program; without gnuplot there are the tables alone. */
static void plot(const char *program, const task *t, const point *points)
{
    const char *slash = strrchr(program, '/');
    const int length = slash != NULL ? (int)(slash + 1 - program) : 0;
    const char *separator = "plot ";
    if (system("command -v gnuplot >/dev/null 2>&1") != 0) {
        return;
    }
    FILE *gnuplot = popen("LC_ALL=C.UTF-8 gnuplot", "w");
    if (gnuplot == NULL) {
        return;
    }
    fprintf(gnuplot,
            "set terminal svg size 800,560 background '#ffffff'\nset output '%.*sscene-%s.svg'\n"
            "set logscale xy\nset format '10^{%%T}'\nset grid\nset key outside\n"
            "set title '%s'\nset xlabel 'microseconds per step'\nset ylabel 'error (%s)'\n",
            length, program, t->name, t->name, t->error);
    for (int k = 0; k < engine_count; k++) {
        const int is_first = k == 0 || strcmp(engines[k].name, engines[k - 1].name) != 0;
        if (is_first && has_points(engines[k].name, points)) {
            put_points(gnuplot, engines[k].name, points);
        }
    }
    for (int k = 0; k < engine_count; k++) {
        const int is_first = k == 0 || strcmp(engines[k].name, engines[k - 1].name) != 0;
        if (is_first && has_points(engines[k].name, points)) {
            fprintf(gnuplot, "%s$%s with points pointsize 1.4 linewidth 2 title '%s'", separator,
                    engines[k].name, engines[k].name);
            separator = ", ";
        }
    }
    fputs("\n", gnuplot);
    if (pclose(gnuplot) == 0) {
        printf("plot: %.*sscene-%s.svg\n", length, program, t->name);
    }
}

static void bench_task(const char *program, const task *t, double seconds)
{
    static point points[ENGINES];
    printf("\n%s; error: %s\n%-7s %-15s %11s %9s %9s %9s\n", t->name, t->error, "engine", "setting",
           "us/step", "error", "overlap", "speed");
    for (int k = 0; k < engine_count; k++) {
        points[k] = run_engine(&engines[k], t, seconds);
        print_point(&engines[k], &points[k]);
        (void)fflush(stdout);
    }
    print_verdict(points);
    plot(program, t, points);
}

int main(int argc, char **argv)
{
    const char *program = argc > 0 ? argv[0] : "";
    const char *given = argc > 1 ? argv[1] : getenv("TRIBO_BENCH_SECONDS");
    const double seconds = given ? strtod(given, NULL) : 3.0;
    find_engines(program);
    for (size_t k = 0; k < sizeof tasks / sizeof tasks[0]; k++) {
        int wanted = argc < 3;
        for (int i = 2; i < argc; i++) {
            wanted = wanted || strcmp(argv[i], tasks[k].name) == 0;
        }
        if (wanted) {
            bench_task(program, &tasks[k], seconds);
        }
    }
    return 0;
}
