/* Speed against error of scenes in time, beside other engines in one run.
 *
 *   scene [--full] [SECONDS [NAME...]]   most processor seconds for a run (TRIBO_BENCH_SECONDS of
 *                                        the environment, or 2; --full: 60), and which scenes: all
 *                                        if none is named
 *
 * All engines get the same bodies, the same places, friction of pairs and steps of 1/240 s, each in
 * one thread, without sleep, with warm starts if it has them (ODE has none), and are judged by the
 * same code from where the bodies are. How near surfaces are contacts is left as it comes: 1/64 of
 * the lesser radius in tribo, 2 cm in Bullet and Box3D, none in ODE and MuJoCo. The time is that of
 * the thread, per step, collision included, the least of repetitions for 0.2 s, in rounds in which
 * engines take turns. Beside the error of the scene:
 *
 *   overlap  the deepest at the end, m, as tribo's collision finds it
 *   eta      how far impulses and velocities are from Coulomb's law, by the certificate of tribo's
 *            solvers: median and greatest of the steps that were looked at (the first, second,
 *            fourth ..., and every 40th). The law is that of velocities at the end of a step, with
 *            gap + h u_n >= 0; an engine that pushes overlaps apart by velocities leaves it for
 *            that. "-": the engine does not tell impulses of points
 *   energy   the greatest rise of kinetic and potential energy between two steps that were looked
 *            at, over the energy at the start, potential from the floor's origin on. Exact motions
 *            of these scenes have none
 *   speed    the greatest at the end, m/s
 *
 * A step that takes longer than the seconds is stopped; what does not get to the end in them is
 * told, with the time per step that it had, and not compared. For each scene there is a plot beside
 * the program, if there is gnuplot. */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */

#include <tribo/scene.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "../support/coupled.h"
#include "certificate.h"
#include "full.h"
#include "limit.h"
#include "peers/engine.h"
#include "peers/load.h"

enum { ENGINES = 48, RUNS = 3, ROUNDS = 3, LOOK = 40, LOOKS = 128 };

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
    tribo_step_options options;
} own_setting;

#define OPTIONS .struct_size = sizeof(tribo_step_options)

static const own_setting settings[] = {
    {"default", {OPTIONS}},
    {"1e-9", {OPTIONS, .tolerance = 1e-9}},
    {"1e-6", {OPTIONS, .tolerance = 1e-6}},
    {"1e-3", {OPTIONS, .tolerance = 1e-3}},
    {"GS 50, 1e-6",
     {OPTIONS, .tolerance = 1e-6, .max_iterations = 50, .solver = TRIBO_SOLVER_GAUSS_SEIDEL}},
    {"GS 10, 1e-3",
     {OPTIONS, .tolerance = 1e-3, .max_iterations = 10, .solver = TRIBO_SOLVER_GAUSS_SEIDEL}},
    {"GS 4, 1e-2",
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
    own_world *world = allocate(1, sizeof *world);
    world->scene = own_scene(from);
    world->options = &settings[choice].options;
    return world;
}

static void own_step(void *data, int watched)
{
    own_world *world = data;
    (void)watched;
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

static int own_contacts(void *data, int room, engine_contact *out)
{
    const own_world *world = data;
    size_t count = 0;
    (void)tribo_scene_contacts(world->scene, 0, NULL, &count);
    tribo_scene_contact *found = allocate(count, sizeof *found);
    demand(tribo_scene_contacts(world->scene, count, found, &count), "contacts");
    for (size_t i = 0; i < count && i < (size_t)room; i++) {
        out[i].a = (int)found[i].a;
        out[i].b = (int)found[i].b;
        out[i].gap = found[i].distance;
        memcpy(out[i].normal, found[i].normal, sizeof out[i].normal);
        memcpy(out[i].arm_a, found[i].arm_a, sizeof out[i].arm_a);
        memcpy(out[i].arm_b, found[i].arm_b, sizeof out[i].arm_b);
        memcpy(out[i].impulse, found[i].impulse, sizeof out[i].impulse);
    }
    free(found);
    return (int)count;
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
    static const char *const names[] = {"engine_ode", "engine_bullet", "engine_box3d",
                                        "engine_mujoco"};
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        const engine e = {"tribo",  settings[i].name, (int)i,       0,       own_make,
                          own_step, own_state,        own_contacts, own_drop};
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

/* Spheres and boxes by turns, on each other, in a bin without a lid. */
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
        const double z = 0.5 + layer;
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
    {"pyramid", "m, greatest way of a brick", make_pyramid, 1.0 / 15.0, 0.0, 1, drift},
    {"pile", "m, deepest overlap", make_pile, 1.0 / 15.0, 0.0, 1, pile_error},
};

/* ---- looks ----------------------------------------------------------------------------------- */

/* A gap as small as single precision has it may count as closed, or not, m. */
static const double closed = 1e-7;

/* A world on its way. */
typedef struct watcher {
    const engine *e;
    void *world;
    const engine_scene *scene;
    engine_state *states; /* of the last look */
    double first, least;  /* energy, J */
    double rise;          /* the greatest so far */
    double etas[LOOKS];
    int looks; /* of them */
} watcher;

static double energy_of(const engine_scene *scene, const engine_state *states)
{
    double sum = 0.0;
    for (int i = 0; i < scene->count; i++) {
        const engine_body *b = &scene->bodies[i];
        const engine_state *s = &states[i];
        double spin[3];
        if (!(b->mass > 0.0)) {
            continue;
        }
        tribo_quat_rotate_inverse(s->orientation, s->angular_velocity, spin);
        sum += b->mass * (0.5 * tribo_vec3_dot(s->velocity, s->velocity) -
                          tribo_vec3_dot(scene->gravity, s->position));
        for (int k = 0; k < 3; k++) {
            sum += 0.5 * b->inertia[k] * spin[k] * spin[k];
        }
    }
    return sum;
}

static void take_states(const watcher *w)
{
    for (int i = 0; i < w->scene->count; i++) {
        if (w->scene->bodies[i].mass > 0.0) {
            w->e->state(w->world, i, &w->states[i]);
        }
    }
}

/* What the law asks of a normal velocity u, where it may ask for 0 or for -slack. */
static double spare(double u, double slack)
{
    return u > 0.0 ? u : u < -slack ? u + slack : 0.0;
}

/* Greatest eta of impulses (contact coordinates) and of the velocities that bodies have: those
 * without impulses are what is left of them. slack: m/s, one for each contact. */
static double certify(const systems_scene *system, const double *impulses, const double *slack)
{
    tribo_system_info info = {.struct_size = sizeof info};
    coupled c;
    coupled_of_scene(system, &c);
    const size_t width = 3 * system->count;
    double *u = allocate(width, sizeof *u);
    double *before = allocate(width, sizeof *before);
    double *minus = allocate(width, sizeof *minus);
    double *scratch = allocate(6 * system->body_count, sizeof *scratch);
    memcpy(u, c.problem.q, width * sizeof *u);
    for (size_t k = 0; k < width; k++) {
        u[k] = k % 3 == 0 ? spare(u[k], slack[k / 3]) : u[k];
        minus[k] = -impulses[k];
    }
    c.problem.q = u;
    certificate_velocity(&c.problem, minus, scratch, before);
    c.problem.q = before;
    certificate_write(&c.problem, impulses, u, scratch, &info);
    coupled_free(&c);
    free(u);
    free(before);
    free(minus);
    free(scratch);
    return info.eta;
}

/* Bodies as they are now. */
static void put_bodies(const watcher *w, systems_scene *system)
{
    system->body_count = (size_t)w->scene->count;
    system->bodies = allocate(system->body_count, sizeof *system->bodies);
    for (int i = 0; i < w->scene->count; i++) {
        tribo_scene_body body;
        own_body(&w->scene->bodies[i], 0.0, &body);
        if (w->scene->bodies[i].mass > 0.0) {
            const engine_state *s = &w->states[i];
            demand(tribo_quat_normalize(s->orientation, body.state.orientation), "orientation");
            memcpy(body.state.velocity, s->velocity, sizeof s->velocity);
            memcpy(body.state.angular_velocity, s->angular_velocity, sizeof s->angular_velocity);
        }
        system->bodies[i] = body.state;
    }
}

static void put_contact(const engine_scene *scene, const engine_contact *from,
                        tribo_system_contact *to, double r[3])
{
    double frame[9];
    const double mu = scene->friction;
    to->a = (uint32_t)from->a;
    to->b = (uint32_t)from->b;
    to->dimension = 3;
    to->pair = (tribo_material){mu, mu, 0.0};
    to->target[0] = from->gap > closed ? -from->gap / scene->dt : 0.0;
    demand(tribo_vec3_normalize(from->normal, to->contact.normal), "normal");
    memcpy(to->contact.arm_a, from->arm_a, sizeof from->arm_a);
    memcpy(to->contact.arm_b, from->arm_b, sizeof from->arm_b);
    demand(tribo_basis_from_normal(to->contact.normal, frame), "frame");
    tribo_mat3_apply(frame, from->impulse, r);
}

static double eta_of(const watcher *w)
{
    systems_scene system = {0};
    const int count = w->e->contacts(w->world, 0, NULL);
    engine_contact *found = allocate((size_t)count, sizeof *found);
    double *impulses = allocate(3 * (size_t)count, sizeof *impulses);
    double *slack = allocate((size_t)count, sizeof *slack);
    w->e->contacts(w->world, count, found);
    system.count = (size_t)count;
    system.contacts = allocate(system.count, sizeof *system.contacts);
    put_bodies(w, &system);
    for (int i = 0; i < count; i++) {
        put_contact(w->scene, &found[i], &system.contacts[i], impulses + 3 * i);
        slack[i] = found[i].gap > 0.0 && found[i].gap <= closed ? found[i].gap / dt : 0.0;
    }
    const double eta = certify(&system, impulses, slack);
    free(slack);
    free(system.bodies);
    free(system.contacts);
    free(impulses);
    free(found);
    return eta;
}

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

static void look(watcher *w)
{
    take_states(w);
    if (!are_finite(w->scene, w->states)) {
        w->rise = HUGE_VAL;
        return;
    }
    const double energy = energy_of(w->scene, w->states);
    w->rise = fmax(w->rise, (energy - w->least) / w->first);
    w->least = fmin(w->least, energy);
    if (w->e->contacts != NULL && w->looks < LOOKS) {
        w->etas[w->looks++] = eta_of(w);
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median and greatest; negative: not told. */
static void sum_etas(const watcher *w, double *median, double *most)
{
    double sorted[LOOKS];
    *median = *most = -1.0;
    if (w->looks > 0) {
        memcpy(sorted, w->etas, (size_t)w->looks * sizeof *sorted);
        qsort(sorted, (size_t)w->looks, sizeof *sorted, ascending);
        *median = sorted[w->looks / 2];
        *most = sorted[w->looks - 1];
    }
}

static void begin_to_watch(watcher *w)
{
    w->states = allocate((size_t)w->scene->count, sizeof *w->states);
    for (int i = 0; i < w->scene->count; i++) {
        const engine_body *b = &w->scene->bodies[i];
        memcpy(w->states[i].position, b->position, sizeof b->position);
        memcpy(w->states[i].orientation, b->orientation, sizeof b->orientation);
        memcpy(w->states[i].velocity, b->velocity, sizeof b->velocity);
    }
    w->first = w->least = energy_of(w->scene, w->states);
}

/* ---- runs ------------------------------------------------------------------------------------ */

typedef struct point {
    double us; /* per step */
    double error, overlap, speed, eta, eta_most, energy;
    double errors[RUNS];
    int done, steps, runs;
    int end; /* of the process: LIMIT_... */
} point;

static const double repeat_seconds = 0.2 / ROUNDS; /* of a round */
static const double judging = 60.0;                /* s at most */
static const rlim_t memory = (rlim_t)8 << 30;

/* The step that is looked at after this one. */
static int next_look(int done, int steps)
{
    const int twice = done > 0 ? 2 * done : 1;
    const int next = twice < LOOK ? twice : (done / LOOK + 1) * LOOK;
    return next < steps ? next : steps;
}

/* The clock is asked where steps take long, and between looks: asking takes a third of a
 * microsecond. `out` is what is left if the process is stopped. */
static void do_steps(watcher *w, double seconds, int watched, point *out)
{
    double spent = 0.0;
    while (out->done < out->steps && spent <= seconds) {
        const int next = next_look(out->done, out->steps);
        const int count = spent > 1e-3 * out->done ? 1 : next - out->done;
        const int looks = watched && out->done + count == next;
        limit_set(seconds);
        const double start = now();
        for (int k = 1; k <= count; k++) {
            w->e->step(w->world, looks && k == count);
        }
        spent += now() - start;
        out->done += count;
        out->us = 1e6 * spent / out->done;
        limit_set(judging);
        if (looks) {
            look(w);
            sum_etas(w, &out->eta, &out->eta_most);
            out->energy = w->rise;
        }
    }
}

static void judge_world(watcher *w, const task *t, point *out)
{
    take_states(w);
    const int sane = are_finite(w->scene, w->states);
    out->error = sane ? t->judge(w->scene, w->states) : HUGE_VAL;
    out->overlap = sane ? overlap(w->scene, w->states) : HUGE_VAL;
    out->speed = sane ? restlessness(w->scene, w->states) : HUGE_VAL;
}

/* A process of its own. */
typedef struct job {
    const engine *e;
    const task *t;
    double seconds;
    point *found; /* shared */
} job;

static point run_once(const job *asked, int run, int watched)
{
    const task *t = asked->t;
    heap h = {0};
    const double steep = atan(t->slope);
    t->make(&h);
    if (t->judge == stop_error) {
        head(&h, run);
    }
    const engine_scene scene = {
        h.count, h.bodies, {gravity * sin(steep), 0.0, -gravity * cos(steep)}, 0.5, dt};
    watcher w = {.e = asked->e, .scene = &scene};
    const point fresh = {.steps = (int)(t->seconds / dt + 0.5), .eta = -1.0, .eta_most = -1.0};
    point out = fresh;
    point *live = watched ? asked->found : &out;
    *live = fresh;
    limit_set(asked->seconds);
    w.world = asked->e->make(&scene, asked->e->choice);
    if (w.world) {
        begin_to_watch(&w);
        do_steps(&w, asked->seconds, watched, live);
        out = *live;
        judge_world(&w, t, &out);
        asked->e->drop(w.world);
        free(w.states);
    }
    free(h.bodies);
    return out;
}

/* The least time of repetitions, the greatest errors of the runs. */
static void work(void *user)
{
    const job *asked = user;
    const struct rlimit limit = {memory, memory};
    point out = {.us = HUGE_VAL, .eta = -1.0, .eta_most = -1.0};
    setrlimit(RLIMIT_AS, &limit);
    for (int run = 0; run < asked->t->runs; run++) {
        double spent = 0.0;
        do {
            const point p = run_once(asked, run, spent == 0.0);
            spent += 1e-6 * p.us * p.done;
            out.us = fmin(out.us, p.us);
            out.errors[run] = p.error;
            out.error = fmax(out.error, p.error);
            out.overlap = fmax(out.overlap, p.overlap);
            out.speed = fmax(out.speed, p.speed);
            out.eta = fmax(out.eta, p.eta);
            out.eta_most = fmax(out.eta_most, p.eta_most);
            out.energy = fmax(out.energy, p.energy);
            out.done = p.done;
            out.steps = p.steps;
        } while (out.done > 0 && spent < repeat_seconds / asked->t->runs);
    }
    *asked->found = out;
}

static point run_engine(const engine *e, const task *t, double seconds)
{
    job asked = {e, t, seconds, limit_share(sizeof(point))};
    const int end = limit_run(work, &asked);
    point out = *asked.found;
    out.end = end;
    munmap(asked.found, sizeof(point));
    return out;
}

/* ---- what comes of it ------------------------------------------------------------------------ */

static int is_own(const engine *e)
{
    return e->make == own_make;
}

static int is_whole(const point *p)
{
    return p->end == LIMIT_DONE && p->done > 0 && p->done == p->steps && isfinite(p->error);
}

static void print_head(const task *t)
{
    printf("\n%s; error: %s\n%-7s %-15s %12s %9s", t->name, t->error, "engine", "setting",
           "us/step", "error");
    for (int run = 0; t->runs > 1 && run < t->runs; run++) {
        printf(" %5g deg", headings[run]);
    }
    printf(" %9s %9s %9s %9s %9s\n", "overlap", "eta", "greatest", "energy", "speed");
}

/* A number that there may be none of. */
static void print_number(double x)
{
    if (x >= 0.0) {
        printf(" %9.1e", x);
    } else {
        printf(" %9s", "-");
    }
}

/* What has not come to the end, and why. */
static void print_rest(const point *p, double seconds)
{
    static const char *const why[] = {
        [LIMIT_DONE] = "out of time", [LIMIT_STOPPED] = "stopped", [LIMIT_BROKEN] = "broke"};
    if (p->done == 0 && p->end == LIMIT_STOPPED) {
        printf(" >%11.0f  no step in %g s: not compared\n", 1e6 * seconds, seconds);
    } else if (p->done == 0) {
        printf(" %12s  %s\n", "-", p->end == LIMIT_BROKEN ? "broke in its first step" : "not made");
    } else {
        const int ended = p->end == LIMIT_DONE && p->done == p->steps;
        printf(" %12.2f  %s after %d of %d steps: not compared;", p->us,
               ended ? "no number" : why[p->end], p->done, p->steps);
        printf(" eta");
        print_number(p->eta);
        printf(", energy");
        print_number(p->energy);
        printf("\n");
    }
}

static void print_point(const engine *e, const task *t, const point *p, double seconds)
{
    printf("%-7s %-15s", e->name, e->setting);
    if (!is_whole(p)) {
        print_rest(p, seconds);
        return;
    }
    printf(" %12.2f", p->us);
    print_number(p->error);
    for (int run = 0; t->runs > 1 && run < t->runs; run++) {
        print_number(p->errors[run]);
    }
    print_number(p->overlap);
    print_number(p->eta);
    print_number(p->eta_most);
    print_number(p->energy);
    print_number(p->speed);
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

/* Colours that the colour-blind can tell apart, and types of points. */
static const struct style {
    const char *name, *colour;
    int point;
} styles[] = {{"tribo", "#0072B2", 7},
              {"ODE", "#D55E00", 8},
              {"Bullet", "#E69F00", 4},
              {"Box3D", "#009E73", 12},
              {"MuJoCo", "#CC79A7", 6}};
enum { STYLES = sizeof styles / sizeof styles[0] };

/* Points of an engine, with their settings; returns their number. */
static int put_points(FILE *gnuplot, int style, const point *points)
{
    int count = 0;
    fprintf(gnuplot, "$points%d << END\n", style);
    for (int k = 0; k < engine_count; k++) {
        const engine *e = &engines[k];
        if (strcmp(e->name, styles[style].name) == 0 && is_whole(&points[k])) {
            fprintf(gnuplot, "%.6g %.6g \"%s\"\n", points[k].us, fmax(points[k].error, 1e-16),
                    e->setting);
            count++;
        }
    }
    fputs("END\n", gnuplot);
    return count;
}

/* tribo's curve: the settings that no other of its own beats, as stairs, gnuplot sorts them. */
static void put_front(FILE *gnuplot, const point *points)
{
    fputs("$front << END\n", gnuplot);
    for (int k = 0; k < engine_count; k++) {
        const point before = {.us = nextafter(points[k].us, 0.0), .error = points[k].error};
        if (is_own(&engines[k]) && is_whole(&points[k]) && !is_beaten(points, &before)) {
            fprintf(gnuplot, "%.6g %.6g\n", points[k].us, fmax(points[k].error, 1e-16));
        }
    }
    fputs("END\n", gnuplot);
}

static void plot_points(FILE *gnuplot, const int *counts)
{
    const char *separator = "plot ";
    if (counts[0] > 0) {
        fprintf(gnuplot,
                "plot $front using 1:2 smooth unique with steps linecolor '%s' linewidth 1.5 "
                "notitle",
                styles[0].colour);
        separator = ", ";
    }
    for (int i = 0; i < STYLES; i++) {
        if (counts[i] > 0) {
            fprintf(gnuplot,
                    "%s$points%d using 1:2 with points pointtype %d pointsize 1.2 linewidth 1.6 "
                    "linecolor '%s' title '%s', $points%d using 1:2:3 with labels left font ',8' "
                    "offset 0.6,0.3 textcolor '%s' notitle",
                    separator, i, styles[i].point, styles[i].colour, styles[i].name, i,
                    styles[i].colour);
            separator = ", ";
        }
    }
    fputs("\n", gnuplot);
}

/* SVG beside the program; without gnuplot, or a point, there are the tables alone. */
static void plot(const char *program, const task *t, const point *points)
{
    const char *slash = strrchr(program, '/');
    const int length = slash != NULL ? (int)(slash + 1 - program) : 0;
    int counts[STYLES];
    int sum = 0;
    if (system("command -v gnuplot >/dev/null 2>&1") != 0) {
        return;
    }
    FILE *gnuplot = popen("LC_ALL=C.UTF-8 gnuplot", "w");
    if (gnuplot == NULL) {
        return;
    }
    fprintf(gnuplot,
            "set encoding utf8\nset terminal svg size 900,600 noenhanced font 'sans,12' background "
            "'#ffffff'\nset output '%.*sscene-%s.svg'\nset logscale xy\nset format '%%.0e'\n"
            "set grid linecolor '#dddddd'\nset tics nomirror\nset key outside\n"
            "set title '%s: speed against error'\nset xlabel 'microseconds per step'\n"
            "set ylabel 'error (%s)'\nset offsets graph 0.03, graph 0.14, graph 0.05, graph 0.05\n",
            length, program, t->name, t->name, t->error);
    for (int i = 0; i < STYLES; i++) {
        counts[i] = put_points(gnuplot, i, points);
        sum += counts[i];
    }
    put_front(gnuplot, points);
    if (sum > 0) {
        plot_points(gnuplot, counts);
    }
    if (pclose(gnuplot) == 0 && sum > 0) {
        printf("plot: %.*sscene-%s.svg\n", length, program, t->name);
    }
}

static void print_singles(void)
{
    const char *separator = "in single precision: ";
    for (int k = 0; k < engine_count; k++) {
        if (engines[k].single && (k == 0 || strcmp(engines[k].name, engines[k - 1].name) != 0)) {
            printf("%s%s", separator, engines[k].name);
            separator = ", ";
        }
    }
    printf("%s\n", separator[0] == ',' ? "" : "all in double precision");
}

/* Whether it is over so soon that it may meet nothing but another program's turn. */
static int is_short(const task *t, const point *p)
{
    return is_whole(p) && 1e-6 * p->us * p->done * t->runs < ROUNDS * repeat_seconds;
}

static void bench_task(const char *program, const task *t, double seconds)
{
    static point points[ENGINES];
    for (int k = 0; k < ROUNDS * engine_count; k++) {
        point *best = &points[k % engine_count];
        if (k < engine_count) {
            *best = run_engine(&engines[k], t, seconds);
        } else if (is_short(t, best)) {
            const point again = run_engine(&engines[k % engine_count], t, seconds);
            best->us = is_whole(&again) ? fmin(best->us, again.us) : best->us;
        }
    }
    print_head(t);
    for (int k = 0; k < engine_count; k++) {
        print_point(&engines[k], t, &points[k], seconds);
    }
    print_verdict(points);
    plot(program, t, points);
    (void)fflush(stdout);
}

int main(int argc, char **argv)
{
    const char *program = argc > 0 ? argv[0] : "";
    limit_threads(argv);
    const double usual = take_full(&argc, argv) ? 60.0 : 2.0;
    const char *given = argc > 1 ? argv[1] : getenv("TRIBO_BENCH_SECONDS");
    const double seconds = given ? strtod(given, NULL) : usual;
    find_engines(program);
    print_singles();
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
