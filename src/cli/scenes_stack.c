/* Many contacts: rates of sweeps, columns and towers at rest. */
#include "scene.h"

#include <math.h>
#include <stdlib.h>

/* ---- C2: rates of Gauss-Seidel --------------------------------------------------------------- */

enum { MOST_LAYERS = 50 };

/* Bodies on top of each other, one contact without friction between each two and one on the floor,
 * after gravity has acted for `kick` m/s. */
typedef struct column {
    size_t count;
    tribo_body bodies[MOST_LAYERS];
    tribo_system_contact contacts[MOST_LAYERS];
    double loads[MOST_LAYERS]; /* exact impulses: the weight of all above */
} column;

static void make_column(size_t count, const double *masses, column *c)
{
    double above = 0.0;

    c->count = count;
    for (size_t i = count; i-- > 0;) {
        const double inertia[9] = {masses[i], 0.0, 0.0, 0.0, masses[i], 0.0, 0.0, 0.0, masses[i]};
        tribo_body_init(&c->bodies[i]);
        tribo_body_set_mass(&c->bodies[i], masses[i], inertia);
        c->bodies[i].velocity[2] = -1.0;
        c->contacts[i] = (tribo_system_contact){.a = (uint32_t)i,
                                                .b = i > 0 ? (uint32_t)(i - 1) : TRIBO_WORLD,
                                                .dimension = 1,
                                                .contact = {.normal = {0.0, 0.0, 1.0},
                                                            .arm_a = {0.0, 0.0, -0.5},
                                                            .arm_b = {0.0, 0.0, 0.5}}};
        above += masses[i];
        c->loads[i] = above;
    }
}

/* Greatest error of an impulse after so many sweeps from zero, over the greatest impulse. */
static double error_after(world *w, const column *c, uint64_t sweeps)
{
    const tribo_system_options options = {.struct_size = sizeof options,
                                          .solver = TRIBO_SOLVER_GAUSS_SEIDEL,
                                          .max_iterations = sweeps,
                                          .tolerance = 1e-300};
    double impulses[3 * MOST_LAYERS] = {0.0};
    double error = 0.0;
    size_t size = 0;

    world_check(w, tribo_system_workspace_size(c->count, c->count, c->contacts, &options, &size));
    void *workspace = malloc(size + 1);
    const double tick = world_tick();
    world_check(w, workspace == NULL
                       ? TRIBO_ERROR_MEMORY
                       : tribo_system_solve(c->count, c->bodies, c->count, c->contacts, &options,
                                            workspace, size, impulses, NULL, NULL));
    world_tock(w, tick);
    free(workspace);
    for (size_t i = 0; i < c->count; i++)
        error = fmax(error, fabs(impulses[3 * i] - c->loads[i]) / c->loads[0]);
    return error;
}

/* Sweeps that take the error down to a millionth of it, at the rate of the last ones. */
static void answer_rate(world *w, const column *c, double rate, scene_answer *answer)
{
    const double needed = log(1e-6) / log(rate);
    const uint64_t from = (uint64_t)(0.5 * needed), to = (uint64_t)needed;
    const double shrinks = error_after(w, c, to) / error_after(w, c, from);

    answer->metric = log(1e-6) * (double)(to - from) / log(shrinks);
    answer->exact = needed;
    answer->error = fabs(answer->metric / needed - 1.0);
}

/* Two bodies: rate m_top / (m_bottom + m_top). */
static void run_rate_pair(world *w, scene_answer *answer)
{
    const double ratio = *(const double *)w->given;
    const double masses[2] = {1.0, ratio};
    column c;

    make_column(2, masses, &c);
    answer_rate(w, &c, ratio / (1.0 + ratio), answer);
}

/* n equal bodies: rate cos^2(pi / 2n). */
static void run_rate_column(world *w, scene_answer *answer)
{
    const size_t count = (size_t) * (const double *)w->given;
    const double root = cos(0.5 * 3.14159265358979323846 / (double)count);
    double masses[MOST_LAYERS];
    column c;

    for (size_t i = 0; i < count; i++)
        masses[i] = 1.0;
    make_column(count, masses, &c);
    answer_rate(w, &c, root * root, answer);
}

/* ---- C2, C3: at rest ------------------------------------------------------------------------- */

/* What stands on what. */
typedef struct tower {
    int layers;
    int are_boxes;   /* 1: cubes of 1 m with friction; 0: balls of 1 m without */
    double top_mass; /* kg, the others have 1 */
    double slope;    /* of the floor, radians */
} tower;

static const double TOWER_MU = 0.5;

static uint32_t make_tower(world *w, const tower *t)
{
    const double mu = t->are_boxes != 0 ? TOWER_MU : 0.0;
    const tribo_scene_body ground = world_floor(mu, 0.0);

    world_begin(w, WORLD_G * sin(t->slope), 0.0, -WORLD_G * cos(t->slope));
    const uint32_t id = world_add(w, &ground);
    for (int i = 0; i < t->layers; i++) {
        const double mass = i + 1 == t->layers ? t->top_mass : 1.0;
        const tribo_scene_body body = t->are_boxes != 0 ? world_box(mass, 0.5, 0.5, 0.5, mu, 0.0)
                                                        : world_ball(mass, 0.5, 0.0, 0.0);
        world_add_at(w, &body, 0.0, 0.0, i + 0.5);
    }
    return id;
}

/* Greatest error of what an interface bears in a step, relative to the weight above it. */
static double load_error(world *w, const tower *t)
{
    tribo_scene_event events[MOST_LAYERS];
    double above = t->layers - 1 + t->top_mass;
    double error = 0.0;
    size_t count = 0;

    world_check(w, tribo_scene_events(w->scene, MOST_LAYERS, events, &count));
    for (int i = 0; i < t->layers; i++, above -= 1.0) {
        const double weight = above * WORLD_G * cos(t->slope) * w->dt;
        error = fmax(error, (size_t)i < count ? fabs(events[i].normal / weight - 1.0) : 1.0);
    }
    return error;
}

static void run_loads(world *w, scene_answer *answer)
{
    const tower *t = w->given;

    make_tower(w, t);
    world_run(w, w->seconds);
    answer->metric = load_error(w, t);
    answer->exact = 0.0;
}

/* How far any body has moved in the end. */
static void run_tower(world *w, scene_answer *answer)
{
    const tower *t = w->given;
    const uint32_t ground = make_tower(w, t);
    const double start = world_energy(w);
    double gain = 0.0;

    answer->metric = 0.0;
    for (uint64_t i = world_steps(w, w->seconds); i > 0 && w->status == TRIBO_OK; i--) {
        world_step(w);
        gain = fmax(gain, world_energy(w) - start);
    }
    for (int i = 0; i < t->layers; i++) {
        const tribo_body body = world_state(w, ground + 1 + (uint32_t)i);
        const double place[3] = {0.0, 0.0, i + 0.5};
        answer->metric = fmax(answer->metric, scene_distance(body.position, place, 3));
    }
    answer->exact = 0.0;
    answer->error = fmax(answer->metric, gain / ((t->layers - 1 + t->top_mass) * WORLD_G));
}

/* One step of the length 1/60 s: v = g dt (sin - mu cos). */
static void run_slope(world *w, scene_answer *answer)
{
    const tower *t = w->given;
    const uint32_t ground = make_tower(w, t);
    const double pull = sin(t->slope) - TOWER_MU * cos(t->slope);

    world_run(w, w->seconds);
    answer->metric = world_state(w, ground + 1).velocity[0];
    answer->exact = WORLD_G * w->time * fmax(pull, 0.0);
}

/* ---- table ----------------------------------------------------------------------------------- */

static const double C2_RATE_PAIR_1 = 1.0;
static const double C2_RATE_PAIR_10 = 10.0;
static const double C2_RATE_PAIR_1000 = 1000.0;
static const double C2_RATE_COLUMN_10 = 10.0;
static const double C2_RATE_COLUMN_50 = 50.0;
static const tower C2_COLUMN_50 = {50, 0, 1.0, 0.0};
static const tower C2_PAIR_1E6 = {2, 0, 1000000.0, 0.0};
static const tower C3_TOWER_1 = {1, 1, 1.0, 0.0};
static const tower C3_TOWER_2 = {2, 1, 1.0, 0.0};
static const tower C3_TOWER_5 = {5, 1, 1.0, 0.0};
static const tower C3_TOWER_10 = {10, 1, 1.0, 0.0};
static const tower C3_TOWER_20 = {20, 1, 1.0, 0.0};
static const tower C3_PAIR_10 = {2, 1, 10.0, 0.0};
static const tower C3_PAIR_100 = {2, 1, 100.0, 0.0};
static const tower C3_PAIR_1000 = {2, 1, 1000.0, 0.0};
static const tower C3_SLOPE = {1, 1, 1.0, 0.46364760900080609};
static const tower C3_SLOPE_30 = {1, 1, 1.0, 0.52359877559829882};

static const scene_entry ENTRIES[] = {
    {.name = "c2-rate-pair-1",
     .what = "Gauss-Seidel on two bodies without friction, 1 times the mass on top",
     .metric = "sweeps for a millionth of the error; error: relative",
     .dt = 1.0,
     .seconds = 1.0,
     .tolerance = 1e-2,
     .reason = "rate of the last half of these sweeps; the first have other modes",
     .given = &C2_RATE_PAIR_1,
     .run = run_rate_pair},
    {.name = "c2-rate-pair-10",
     .what = "Gauss-Seidel on two bodies without friction, 10 times the mass on top",
     .metric = "sweeps for a millionth of the error; error: relative",
     .dt = 1.0,
     .seconds = 1.0,
     .tolerance = 1e-2,
     .reason = "rate of the last half of these sweeps; the first have other modes",
     .given = &C2_RATE_PAIR_10,
     .run = run_rate_pair},
    {.name = "c2-rate-pair-1000",
     .what = "Gauss-Seidel on two bodies without friction, 1000 times the mass on top",
     .metric = "sweeps for a millionth of the error; error: relative",
     .dt = 1.0,
     .seconds = 1.0,
     .tolerance = 1e-2,
     .reason = "rate of the last half of these sweeps; the first have other modes",
     .given = &C2_RATE_PAIR_1000,
     .run = run_rate_pair},
    {.name = "c2-rate-column-10",
     .what = "Gauss-Seidel on a column of 10 equal bodies without friction",
     .metric = "sweeps for a millionth of the error; error: relative",
     .dt = 1.0,
     .seconds = 1.0,
     .tolerance = 5e-2,
     .reason = "rate of the last half of these sweeps; the first have other modes",
     .given = &C2_RATE_COLUMN_10,
     .run = run_rate_column},
    {.name = "c2-rate-column-50",
     .what = "Gauss-Seidel on a column of 50 equal bodies without friction",
     .metric = "sweeps for a millionth of the error; error: relative",
     .dt = 1.0,
     .seconds = 1.0,
     .tolerance = 5e-2,
     .reason = "rate of the last half of these sweeps; the first have other modes",
     .given = &C2_RATE_COLUMN_50,
     .run = run_rate_column},
    {.name = "c2-column-50",
     .what = "50 balls of 1 kg on top of each other, without friction",
     .metric = "greatest error of what an interface bears, relative",
     .dt = 1.0 / 60.0,
     .seconds = 1.0,
     .tolerance = 1e-9,
     .reason = "the solver is asked for 1e-12 of the greatest impulse",
     .given = &C2_COLUMN_50,
     .run = run_loads},
    {.name = "c2-pair-1e6",
     .what = "a ball of 1e6 kg on one of 1 kg, without friction",
     .metric = "greatest error of what an interface bears, relative",
     .dt = 1.0 / 60.0,
     .seconds = 1.0,
     .tolerance = 1e-9,
     .reason = "the solver is asked for 1e-12 of the greatest impulse",
     .given = &C2_PAIR_1E6,
     .run = run_loads},
    {.name = "c3-tower-1",
     .what = "a cube of 1 m, mu 0.5, stands",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 1e-9,
     .reason = "the solver is asked for 1e-12 of the greatest impulse",
     .given = &C3_TOWER_1,
     .run = run_tower},
    {.name = "c3-tower-2",
     .what = "a tower of 2 cubes of 1 m, mu 0.5, stands",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 2e-9,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_TOWER_2,
     .run = run_tower},
    {.name = "c3-tower-5",
     .what = "a tower of 5 cubes of 1 m, mu 0.5, stands",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 5e-9,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_TOWER_5,
     .run = run_tower},
    {.name = "c3-tower-10",
     .what = "a tower of 10 cubes of 1 m, mu 0.5, stands",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .test_seconds = 1.0,
     .tolerance = 1e-8,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_TOWER_10,
     .run = run_tower},
    {.name = "c3-tower-20",
     .what = "a tower of 20 cubes of 1 m, mu 0.5, stands",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .test_seconds = 1.0,
     .tolerance = 2e-8,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_TOWER_20,
     .run = run_tower},
    {.name = "c3-pair-10",
     .what = "a cube of 10 kg stands on one of 1 kg, mu 0.5",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 2e-9,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_PAIR_10,
     .run = run_tower},
    {.name = "c3-pair-100",
     .what = "a cube of 100 kg stands on one of 1 kg, mu 0.5",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 2e-9,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_PAIR_100,
     .run = run_tower},
    {.name = "c3-pair-1000",
     .what = "a cube of 1000 kg stands on one of 1 kg, mu 0.5",
     .metric = "greatest move of a body, m; error: that, or energy gained over the weight, m",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 2e-9,
     .reason = "overlaps of 1e-9 m are left alone, at each interface",
     .given = &C3_PAIR_1000,
     .run = run_tower},
    {.name = "c3-slope",
     .what = "a cube on a slope of tan 0.5, mu 0.5: it stands",
     .metric = "velocity at the end, m/s",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 1e-9,
     .reason = "the solver is asked for 1e-12",
     .given = &C3_SLOPE,
     .run = run_slope},
    {.name = "c3-slope-30",
     .what = "the same on one of 30 degrees: it slides",
     .metric = "velocity at the end, m/s",
     .dt = 1.0 / 60.0,
     .seconds = 1.0 / 60.0,
     .tolerance = 1e-12,
     .reason = "the solver is asked for 1e-12",
     .given = &C3_SLOPE_30,
     .run = run_slope},
};

const scene_group scenes_stack = {"many contacts", sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
