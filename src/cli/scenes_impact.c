/* Impacts: of many bodies at once, one after the other, and on corners. */
#include "scene.h"

#include <math.h>

/* ---- A6: cradles ----------------------------------------------------------------------------- */

enum { MOST_BALLS = 5 };

/* Balls of those masses in a row, the first at speed 1, the others at rest with gaps between them;
 * what the run makes of their velocities. */
static void run_row(world *w, int count, const double *masses, double e, double gap, double *v)
{
    world_begin(w, 0.0, 0.0, 0.0);
    for (int i = 0; i < count; i++) {
        tribo_scene_body ball = world_ball(masses[i], 0.5, 0.0, e);
        ball.state.velocity[0] = i == 0 ? 1.0 : 0.0;
        world_before(w, &ball);
        world_add_at(w, &ball, i * (1.0 + gap) + ball.state.position[0], 0.0, 0.0);
    }
    world_run(w, w->seconds);
    for (int i = 0; i < count; i++)
        v[i] = world_state(w, (uint32_t)i).velocity[0];
}

/* N - 1 of N balls that touch: (2 - N) / N, and 2 / N for all others. */
static void run_cradle(world *w, scene_answer *answer)
{
    static const double masses[MOST_BALLS] = {1.0, 1.0, 1.0, 1.0, 1.0};
    double v[MOST_BALLS], exact[MOST_BALLS];

    answer->error = 0.0;
    for (int n = 3; n <= MOST_BALLS; n++) {
        run_row(w, n, masses, 1.0, 0.0, v);
        for (int i = 0; i < n; i++)
            exact[i] = i == 0 ? (2.0 - n) / n : 2.0 / n;
        answer->error = fmax(answer->error, scene_distance(v, exact, (size_t)n));
    }
    answer->metric = v[0];
    answer->exact = exact[0];
}

static void run_cradle_sequential(world *w, scene_answer *answer)
{
    static const double masses[MOST_BALLS] = {1.0, 1.0, 1.0, 1.0, 1.0};
    static const double exact[MOST_BALLS] = {0.0, 0.0, 0.0, 0.0, 1.0};
    double v[MOST_BALLS];

    run_row(w, MOST_BALLS, masses, 1.0, 1e-3, v);
    answer->metric = v[MOST_BALLS - 1];
    answer->exact = 1.0;
    answer->error = scene_distance(v, exact, MOST_BALLS);
}

/* ---- table ----------------------------------------------------------------------------------- */

static const scene_entry ENTRIES[] = {
    {.name = "a6-cradle",
     .what = "3, 4 and 5 equal balls that touch, the first at 1 m/s, e 1: all share the impact",
     .metric = "velocity of the first of 5, m/s; error: greatest of all balls",
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_cradle},
    {.name = "a6-cradle-sequential",
     .what = "5 equal balls with gaps, the first at 1 m/s, e 1: they pass the impact on",
     .metric = "velocity of the last, m/s; error: greatest of all balls",
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_cradle_sequential},
};

const scene_group scenes_impact = {"impacts", sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
