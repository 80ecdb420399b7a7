/* The same scene in other units, to the bit; and inputs at the edge of what makes sense. */
#include "scene.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- other units ------------------------------------------------------------------------------- */

typedef struct units {
    double length, mass, time;
} units;

enum { MOST_BODIES = 8 };

/* What `given` of a scene is: makes it in those units, gravity as it is on earth. */
typedef void (*make_function)(world *w, const units *u);
typedef struct maker {
    make_function make;
} maker;

static double speed(const units *u)
{
    return u->length / u->time;
}

static void begin_in(world *w, const units *u, double gx, double gz)
{
    const double scale = u->length / (u->time * u->time);

    world_begin(w, gx * scale, 0.0, gz * scale);
}

static tribo_scene_body ball_in(const units *u, double radius, double mu, double e)
{
    return world_ball(u->mass, radius * u->length, mu, e);
}

/* A rod of 1 m at 45 degrees; its lower end hits the floor. */
static void make_rod(world *w, const units *u)
{
    const double arm = 0.5 * sqrt(0.5), radius = 0.01,
                 moment = u->mass * u->length * u->length / 12.0;
    const tribo_scene_body floor = world_floor(0.5, 0.5);
    tribo_scene_body rod = world_body(u->mass, moment, moment, moment, 0.5, 0.5);

    begin_in(w, u, 0.0, -WORLD_G);
    world_add(w, &floor);
    rod.shape = (tribo_shape){.type = TRIBO_SHAPE_SPHERE, .size = {radius * u->length}};
    rod.offset.position[0] = arm * u->length;
    rod.offset.position[2] = (radius - arm) * u->length;
    rod.state.velocity[0] = -0.4 * speed(u);
    rod.state.velocity[2] = -1.0 * speed(u);
    rod.state.angular_velocity[1] = 0.3 / u->time;
    world_add_at(w, &rod, 0.0, 0.0, (arm + 0.1) * u->length);
}

/* A ball, launched over an incline of 30 degrees. */
static void make_incline(world *w, const units *u)
{
    const tribo_scene_body floor = world_floor(0.4, 0.0);
    tribo_scene_body ball = ball_in(u, 0.5, 0.4, 0.0);

    begin_in(w, u, 0.5 * WORLD_G, -0.75 * WORLD_G);
    world_add(w, &floor);
    ball.state.velocity[0] = -1.5 * speed(u);
    ball.state.velocity[1] = 2.5 * speed(u);
    world_add_at(w, &ball, 0.0, 0.0, 0.5 * u->length);
}

/* Five cubes on each other, a little aside, the uppermost turned. */
static void make_tower(world *w, const units *u)
{
    const tribo_scene_body floor = world_floor(0.5, 0.0);
    const double half = 0.5 * u->length;

    begin_in(w, u, 0.0, -WORLD_G);
    world_add(w, &floor);
    for (int i = 0; i < 5; i++) {
        tribo_scene_body cube = world_box(u->mass, half, half, half, 0.5, 0.0);
        cube.state.velocity[0] = i == 2 ? 0.5 * speed(u) : 0.0;
        cube.state.angular_velocity[2] = i == 4 ? 1.0 / u->time : 0.0;
        world_add_at(w, &cube, 0.03125 * i * u->length, 0.0, (2.0 * i + 1.0) * half);
    }
}

/* A puck on three points that slides and spins. */
static void make_tripod(world *w, const units *u)
{
    static tribo_child feet[3];
    const double moment = 0.005 * u->mass * u->length * u->length;
    const tribo_scene_body floor = world_floor(0.3, 0.0);
    tribo_scene_body puck = world_body(u->mass, 0.5 * moment, 0.5 * moment, moment, 0.3, 0.0);

    begin_in(w, u, 0.0, -WORLD_G);
    world_add(w, &floor);
    for (int i = 0; i < 3; i++) {
        const double angle = 0.2 + i * 2.0 * PI / 3.0;
        feet[i] = (tribo_child){
            .shape = {.type = TRIBO_SHAPE_SPHERE, .size = {0.01 * u->length}},
            .pose = {{0.1 * cos(angle) * u->length, 0.1 * sin(angle) * u->length, 0.01 * u->length},
                     {1.0, 0.0, 0.0, 0.0}}};
    }
    puck.shape = (tribo_shape){.type = TRIBO_SHAPE_COMPOUND, .count = 3, .data = feet};
    puck.state.velocity[0] = speed(u);
    puck.state.angular_velocity[2] = 20.0 / u->time;
    world_add(w, &puck);
}

/* States at the end, back in SI units: exact, since units are powers of two. */
static uint32_t run_in(world *w, const units *u, tribo_body *end)
{
    const make_function make = ((const maker *)w->given)->make;
    const double dt = w->dt;
    const uint64_t steps = world_steps(w, w->seconds);
    uint32_t count = 0;

    make(w, u);
    w->dt = dt * u->time;
    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++)
        world_step(w);
    w->dt = dt;
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_counts(w->scene, NULL, &count));
    for (uint32_t i = 0; i < count && i < MOST_BODIES; i++) {
        end[i] = world_state(w, i);
        tribo_vec3_scale(1.0 / u->length, end[i].position, end[i].position);
        tribo_vec3_scale(1.0 / speed(u), end[i].velocity, end[i].velocity);
        tribo_vec3_scale(u->time, end[i].angular_velocity, end[i].angular_velocity);
    }
    return count;
}

/* Numbers of two states that are not the same. */
static int differences(const tribo_body *a, const tribo_body *b)
{
    int count = 0;

    for (int k = 0; k < 4; k++)
        count += !(a->orientation[k] == b->orientation[k]);
    for (int k = 0; k < 3; k++) {
        count += !(a->position[k] == b->position[k]);
        count += !(a->velocity[k] == b->velocity[k]);
        count += !(a->angular_velocity[k] == b->angular_velocity[k]);
    }
    return count;
}

static void run_units(world *w, scene_answer *answer)
{
    static const units si = {1.0, 1.0, 1.0};
    static const units all[] = {
        {0x1p20, 1.0, 1.0},        {0x1p-20, 1.0, 1.0},        {1.0, 0x1p40, 1.0},
        {1.0, 0x1p-40, 1.0},       {1.0, 1.0, 0x1p10},         {1.0, 1.0, 0x1p-10},
        {0x1p20, 0x1p-40, 0x1p10}, {0x1p-20, 0x1p40, 0x1p-10},
    };
    tribo_body plain[MOST_BODIES], other[MOST_BODIES];
    int count = 0;

    const uint32_t bodies = run_in(w, &si, plain);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const uint32_t same = run_in(w, &all[i], other);
        for (uint32_t k = 0; k < bodies && k < same; k++)
            count += differences(&plain[k], &other[k]);
    }
    answer->metric = count;
    answer->exact = 0.0;
}

/* ---- the edge of sense ------------------------------------------------------------------------- */

/* What is thrown at the floor. */
typedef struct thrown {
    double mu, e;
    double speed;  /* m/s */
    double spin;   /* rad/s */
    double moment; /* of its long axis, as a share of that of a box */
    double ratio;  /* of the mass of the ball to that of the box */
} thrown;

/* A box and a ball are thrown at the floor and at each other. Energy must not rise, and nothing may
 * be below the floor. Returns the greatest rise in a step, as a share of the energy at the start. */
static double throw_bodies(world *w, const thrown *t)
{
    const double half[3] = {0.5, 0.3, 0.2};
    const double moments[3] = {(0.09 + 0.04) / 3.0, (0.25 + 0.04) / 3.0, (0.25 + 0.09) / 3.0};
    const tribo_scene_body floor = world_floor(t->mu, t->e);
    tribo_scene_body box =
        world_body(1.0, moments[0] * t->moment, moments[1], moments[1], t->mu, t->e);
    tribo_scene_body ball = world_ball(t->ratio, 0.2, t->mu, t->e);
    double gain = 0.0;

    if (t->moment == 1.0)
        box = world_box(1.0, half[0], half[1], half[2], t->mu, t->e);
    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &floor);
    box.shape = (tribo_shape){.type = TRIBO_SHAPE_BOX, .size = {half[0], half[1], half[2]}};
    box.state.velocity[0] = t->speed;
    box.state.velocity[2] = -t->speed;
    for (int k = 0; k < 3; k++)
        box.state.angular_velocity[k] = t->spin * (k + 1) / sqrt(14.0);
    world_add_at(w, &box, 0.0, 0.0, 1.0);
    world_add_at(w, &ball, 0.1, 0.05, 2.0);
    const double start = world_energy(w);
    const uint64_t steps = world_steps(w, w->seconds);
    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++) {
        const double before = world_energy(w);
        world_step(w);
        const double rise = (world_energy(w) - before) / start;
        gain = rise <= gain ? gain : rise; /* NaN stays */
    }
    for (uint32_t id = 1; id <= 2; id++)
        gain = world_state(w, id).position[2] > 0.0 ? gain : 1.0;
    return gain;
}

static void run_thrown(world *w, scene_answer *answer)
{
    answer->error = throw_bodies(w, w->given);
    answer->metric = world_energy(w);
}

/* All frictions with both restitutions. */
static void run_frictions(world *w, scene_answer *answer)
{
    static const double mu[] = {0.0, 1e-300, 1e-3, 1.0, 1e3, 1e20};

    answer->error = 0.0;
    for (int i = 0; i < 12; i++) {
        const thrown t = {mu[i / 2], i % 2, 2.0, 3.0, 1.0, 1.0};
        const double gain = throw_bodies(w, &t);
        if (w->notes != NULL)
            fprintf(w->notes, "mu %g, e %g: energy rises by %.3g of it\n", t.mu, t.e, gain);
        answer->error = gain <= answer->error ? answer->error : gain;
    }
    answer->metric = world_energy(w);
}

/* A box of 10^k kg on one of 1 kg, k = 0 to 12. Up to 1e8 they rest; beyond, a residual of 1e-12 of
 * the heavy one's impulse is as much as the light one weighs, but energy does not rise. */
static void run_ratios(world *w, scene_answer *answer)
{
    const tribo_scene_body floor = world_floor(0.5, 0.0);

    answer->metric = answer->error = 0.0;
    for (int k = 0; k <= 12; k++) {
        const double ratio = pow(10.0, k);
        world_begin(w, 0.0, 0.0, -WORLD_G);
        world_add(w, &floor);
        for (int i = 0; i < 2; i++) {
            const tribo_scene_body box = world_box(i == 0 ? 1.0 : ratio, 0.5, 0.5, 0.5, 0.5, 0.0);
            world_add_at(w, &box, 0.0, 0.0, 0.5 + i);
        }
        world_keep(w);
        const double start = world_energy(w);
        world_run(w, w->seconds);
        const double way = world_way(w, 1.0), rise = world_energy(w) / start - 1.0;
        if (w->notes != NULL)
            fprintf(w->notes, "1e%d: %.3g m, energy rises by %.3g of it\n", k, way, rise);
        answer->error = rise <= answer->error ? answer->error : rise;
        if (k == 6)
            answer->metric = way;
    }
}

/* ---- table ------------------------------------------------------------------------------------- */

#define MAKER(function) \
    &(const maker)      \
    {                   \
        function        \
    }
#define THROWN(...) \
    &(const thrown) \
    {               \
        __VA_ARGS__ \
    }
#define UNITS(what_it_is, make)                                                            \
    .what = what_it_is " in units of 2^+-20 m, 2^+-40 kg, 2^+-10 s",                       \
    .metric = "numbers of its end that are not the same to the bit", .given = MAKER(make), \
    .dt = 0x1p-7, .seconds = 1.0, .tolerance = 0.0, .run = run_units,                      \
    .reason = "powers of two scale every operation exactly"
#define ENERGY                                                                                   \
    .metric = "energy at the end, J; error: its greatest rise in a step, of the whole, or 1 if " \
              "anything is below the floor",                                                     \
    .dt = 1e-3, .seconds = 2.0, .tolerance = 2e-5,                                               \
    .reason = "(h F)^2 / 8m for what is met in a step; m g times the overlap that is moved apart"

static const scene_entry ENTRIES[] = {
    {.name = "b18-units-rod", UNITS("a rod that hits the floor", make_rod)},
    {.name = "b18-units-incline", UNITS("a ball on an incline", make_incline)},
    {.name = "b18-units-tower", UNITS("a tower of 5 cubes, one kicked, one spinning", make_tower)},
    {.name = "b18-units-tripod", UNITS("a puck that slides and spins", make_tripod)},
    {.name = "b18-frictions",
     .what = "a box and a ball thrown at the floor, friction 0 to 1e20, restitution 0 and 1",
     ENERGY,
     .run = run_frictions},
    {.name = "b18-fast",
     .what = "the same at 2^27 m/s, mu 0.5, e 0.5",
     .given = THROWN(0.5, 0.5, 0x1p27, 3.0, 1.0, 1.0),
     ENERGY,
     .run = run_thrown},
    {.name = "b18-spin",
     .what = "the same, spinning at 1e4 rad/s",
     .given = THROWN(0.5, 0.5, 2.0, 1e4, 1.0, 1.0),
     ENERGY,
     .run = run_thrown},
    {.name = "b18-needle",
     .what = "the same, a moment of inertia 1e-10 of the others",
     .given = THROWN(0.5, 0.5, 2.0, 3.0, 1e-10, 1.0),
     ENERGY,
     .run = run_thrown},
    {.name = "b18-thrown-1e12",
     .what = "the same, the ball 1e12 times as heavy as the box",
     .given = THROWN(0.5, 0.5, 2.0, 3.0, 1.0, 1e12),
     ENERGY,
     .run = run_thrown},
    {.name = "b18-ratios",
     .what = "a box on another, masses 1 to 1e12",
     .metric = "how far one goes at 1e6, m; error: greatest rise of energy at any, of the whole",
     .dt = 1.0 / 60.0,
     .seconds = 1.0,
     .test_seconds = 0.25,
     .tolerance = 1e-6,
     .run = run_ratios,
     .reason = "bodies that overlap are moved apart, up"},
};

const scene_group scenes_units = {"other units, and the edge of sense",
                                  sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
