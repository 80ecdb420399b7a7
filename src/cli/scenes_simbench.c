/* The four tests of SimBenchmark (Kang and Hwangbo, 2018, leggedrobotics.github.io/SimBenchmark),
 * on its own measures. */
#include "scene.h"

#include <math.h>

/* ---- rolling --------------------------------------------------------------------------------- */

/* A force of 150 N on a box of 10 kg on a floor, with 25 balls on it. Sliding, and the balls roll:
 * balls (F - mu (M + n m) g) / (M (7/2 / m + n / M) m), the box 7/2 of it. */
enum { ROLLING_BALLS = 25 };

static const double ROLLING_BALL = 0.211, ROLLING_BOX = 0.7385; /* m/s^2 */

static const double SIXTY_DEGREES[2] = {0.5, 0.8660254037844386};

static uint32_t make_rolling(world *w, const double direction[2], double overlap)
{
    const double force[3] = {150.0 * direction[0], 150.0 * direction[1], 0.0};
    const tribo_scene_body ground = world_floor(0.4, 0.0);
    const tribo_scene_body box = world_box(10.0, 10.0, 10.0, 0.5, 0.8, 0.0);
    const tribo_scene_body ball = world_ball(1.0, 0.5, 0.8, 0.0);

    world_begin_mixed(w, 0.0, 0.0, -WORLD_G, TRIBO_MIX_MINIMUM);
    world_add(w, &ground);
    const uint32_t id = world_add_at(w, &box, 0.0, 0.0, 0.5 - overlap);
    for (int i = 0; i < ROLLING_BALLS; i++)
        world_add_at(w, &ball, 2.0 * (i % 5) - 4.0, 2.0 * (i / 5) - 4.0, 1.5 - 3.0 * overlap);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_set_force(w->scene, id, force, NULL));
    return id;
}

static double squared_off(world *w, uint32_t id, double speed, const double direction[2])
{
    const tribo_body body = world_state(w, id);
    const double x = body.velocity[0] - speed * direction[0];
    const double y = body.velocity[1] - speed * direction[1];

    return x * x + y * y + body.velocity[2] * body.velocity[2];
}

/* Mean over the steps, before each, of what box and first ball are off. */
static void roll(world *w, const double direction[2], double overlap, scene_answer *answer)
{
    const uint32_t box = make_rolling(w, direction, overlap);
    const uint64_t steps = world_steps(w, w->seconds);
    double sum = 0.0;

    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++) {
        const double t = (double)i * w->dt;
        sum += squared_off(w, box, ROLLING_BOX * t, direction) +
               squared_off(w, box + 1, ROLLING_BALL * t, direction);
        world_step(w);
    }
    answer->metric = sum / (double)steps;
    answer->exact = 0.0;
}

static void run_rolling_y(world *w, scene_answer *answer)
{
    static const double direction[2] = {0.0, 1.0};

    roll(w, direction, 0.0, answer);
}

static void run_rolling_60(world *w, scene_answer *answer)
{
    roll(w, SIXTY_DEGREES, 0.0, answer);
}

/* Set up as published. Until overlaps are gone, friction acts on balls in the middle of them, on a
 * radius that is not the exact answer's. */
static void run_rolling_overlap(world *w, scene_answer *answer)
{
    roll(w, SIXTY_DEGREES, 2e-5, answer);
}

/* ---- bouncing -------------------------------------------------------------------------------- */

enum { BOUNCING_SIDE = 7, BOUNCING_BALLS = 49 };

static const double BOUNCING_MASS = 10.0, BOUNCING_RADIUS = 0.1, BOUNCING_HEIGHT = 5.0;

/* Mean over the steps, before each, of the squared error of the energy. */
static double mean_energy_error(world *w, double seconds)
{
    const uint64_t steps = world_steps(w, seconds);
    const double start = world_energy(w);
    double sum = 0.0;

    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++) {
        const double off = world_energy(w) - start;
        sum += off * off;
        world_step(w);
    }
    return sum / (double)steps;
}

static void run_bouncing(world *w, scene_answer *answer)
{
    const tribo_scene_body ground = world_floor(0.0, 1.0);
    const tribo_scene_body ball = world_ball(BOUNCING_MASS, BOUNCING_RADIUS, 0.0, 1.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &ground);
    for (int i = 0; i < BOUNCING_BALLS; i++)
        world_add_at(w, &ball, i % BOUNCING_SIDE, i / BOUNCING_SIDE, BOUNCING_HEIGHT);
    answer->metric = mean_energy_error(w, w->seconds);
    answer->exact = 0.0;
}

/* What the semi-implicit rule of Euler makes of the same balls: v += dt a, x += dt v. A ball that
 * touches the floor and falls is turned round: either the velocity that it has, or the one that
 * gravity has acted on in this step. That is what the figures of other engines show, digit by
 * digit; it is a matter of the integrator, not of the contact. */
static double euler_bouncing(const world *w, int with_gravity)
{
    const uint64_t steps = world_steps(w, w->seconds);
    const double weight = BOUNCING_BALLS * BOUNCING_MASS;
    double z = BOUNCING_HEIGHT, v = 0.0, sum = 0.0;

    for (uint64_t i = 0; i < steps; i++) {
        const double off = weight * (WORLD_G * (z - BOUNCING_HEIGHT) + 0.5 * v * v);
        const int is_turned = z <= BOUNCING_RADIUS && v < 0.0;
        const double fallen = v - w->dt * WORLD_G;
        sum += off * off;
        v = !is_turned ? fallen : with_gravity ? -fallen : -v;
        z += w->dt * v;
    }
    return sum / (double)steps;
}

/* Three digits of each figure at dt = 1e-5, 1e-4 ... 0.1 are published. */
static void answer_euler(world *w, int with_gravity, const double figures[5], scene_answer *answer)
{
    const double tick = world_tick();
    double dt = 1e-5;

    answer->metric = euler_bouncing(w, with_gravity);
    world_tock(w, tick);
    for (int i = 0; i < 5; i++, dt *= 10.0) {
        if (fabs(w->dt / dt - 1.0) < 1e-9)
            answer->exact = figures[i];
    }
    answer->error = fabs(answer->metric / answer->exact - 1.0);
}

static void run_euler_before(world *w, scene_answer *answer)
{
    static const double ode[5] = {0.0185, 1.85, 185.0, 1.88e4, 2.03e6};

    answer_euler(w, 0, ode, answer);
}

static void run_euler_after(world *w, scene_answer *answer)
{
    static const double bullet[5] = {7.52, 752.0, 7.52e4, 7.41e6, 7.68e8};

    answer_euler(w, 1, bullet, answer);
}

/* ---- 666 ------------------------------------------------------------------------------------- */

enum { HEAP_SIDE = 6, HEAP_BALLS = 216 };

static const double HEAP_RADIUS = 0.1, HEAP_SPACING = 0.21, HEAP_JITTER = 1e-3;

/* xorshift64*, G. Marsaglia and S. Vigna: the same places at each run. */
static double uniform(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)((*state * UINT64_C(2685821657736338717)) >> 11) * 0x1p-53;
}

static void make_heap(world *w, double height, double e)
{
    const tribo_scene_body ground = world_floor(0.0, e);
    const tribo_scene_body ball = world_ball(10.0, HEAP_RADIUS, 0.0, e);
    uint64_t state = 42;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &ground);
    for (int i = 0; i < HEAP_BALLS; i++) {
        const int place[3] = {i % HEAP_SIDE, i / HEAP_SIDE % HEAP_SIDE,
                              i / (HEAP_SIDE * HEAP_SIDE)};
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = HEAP_SPACING * place[k] + HEAP_JITTER * uniform(&state);
        world_add_at(w, &ball, x[0], x[1], height + x[2]);
    }
}

/* Sum of the squares of all overlaps. */
static double squared_overlaps(world *w)
{
    double places[HEAP_BALLS][3];
    double sum = 0.0;

    for (uint32_t i = 0; i < HEAP_BALLS; i++) {
        const tribo_body ball = world_state(w, i + 1);
        const double sunk = fmax(HEAP_RADIUS - ball.position[2], 0.0);
        for (int k = 0; k < 3; k++)
            places[i][k] = ball.position[k];
        sum += sunk * sunk;
        for (uint32_t j = 0; j < i; j++) {
            double way[3];
            tribo_vec3_subtract(places[i], places[j], way);
            const double squared = tribo_vec3_dot(way, way);
            if (squared < 4.0 * HEAP_RADIUS * HEAP_RADIUS) {
                const double overlap = 2.0 * HEAP_RADIUS - sqrt(squared);
                sum += overlap * overlap;
            }
        }
    }
    return sum;
}

static void run_666(world *w, scene_answer *answer)
{
    const uint64_t steps = world_steps(w, w->seconds);
    double sum = 0.0;

    make_heap(w, 0.101, 0.0);
    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++) {
        sum += squared_overlaps(w);
        world_step(w);
    }
    answer->metric = sum / (double)steps;
    answer->exact = 0.0;
}

static void run_666_elastic(world *w, scene_answer *answer)
{
    make_heap(w, 1.101, 1.0);
    answer->metric = mean_energy_error(w, w->seconds);
    answer->exact = 0.0;
}

/* ---- table ----------------------------------------------------------------------------------- */

static const scene_entry ENTRIES[] = {
    {.name = "d1-rolling-y",
     .what = "SimBenchmark, rolling: a box with 25 balls on it, pushed along y",
     .metric = "mean squared error of velocity of box and first ball, (m/s)^2",
     .dt = 1e-3,
     .seconds = 4.0,
     .test_seconds = 1.0,
     .tolerance = 1e-24,
     .reason = "rounding; the best published are 7.3e-28 (Bullet, 400 iterations) and 4.1e-7",
     .run = run_rolling_y},
    {.name = "d1-rolling-60",
     .what = "the same at 60 degrees, where boxes and pyramids for cones stick",
     .metric = "mean squared error of velocity of box and first ball, (m/s)^2",
     .dt = 1e-3,
     .seconds = 4.0,
     .test_seconds = 1.0,
     .tolerance = 1e-24,
     .reason = "rounding; the best published are 3.9e-27 (Bullet, 400 iterations) and 4.1e-7",
     .run = run_rolling_60},
    {.name = "d1-rolling-overlap",
     .what = "the same with overlaps of 20 um at the start, as published",
     .metric = "mean squared error of velocity of box and first ball, (m/s)^2",
     .dt = 1e-3,
     .seconds = 4.0,
     .test_seconds = 1.0,
     .tolerance = 1e-14,
     .reason = "4e-5 of the acceleration for the 10 ms in which overlaps go away",
     .run = run_rolling_overlap},
    {.name = "d2-bouncing",
     .what = "SimBenchmark, bouncing: 49 balls without friction, e 1",
     .metric = "mean squared error of energy, J^2",
     .dt = 1e-2,
     .seconds = 20.0,
     .tolerance = 1e-16,
     .reason = "rounding of 24 034.5 J",
     .run = run_bouncing},
    {.name = "d2-euler-before",
     .what = "the same by Euler's semi-implicit rule, restitution before gravity: ODE's figures",
     .metric = "mean squared error of energy, J^2; error: of the published figure, relative",
     .dt = 1e-2,
     .seconds = 20.0,
     .tolerance = 5e-3,
     .reason = "three digits are published",
     .run = run_euler_before},
    {.name = "d2-euler-after",
     .what = "the same, restitution after gravity: Bullet's figures",
     .metric = "mean squared error of energy, J^2; error: of the published figure, relative",
     .dt = 1e-2,
     .seconds = 20.0,
     .tolerance = 5e-3,
     .reason = "three digits are published",
     .run = run_euler_after},
    {.name = "d3-666",
     .what = "SimBenchmark, 666: 216 balls fall from a lattice, without friction, e 0",
     .metric = "mean sum of squared overlaps, m^2",
     .dt = 1e-2,
     .seconds = 10.0,
     .test_seconds = 2.0,
     .tolerance = 1e-16,
     .reason = "surfaces do not pass: 1e-8 m; the best published is 0.0153 at this step",
     .run = run_666},
    {.name = "d3-666-elastic",
     .what = "SimBenchmark, elastic 666: the same from 1 m above, e 1",
     .metric = "mean squared error of energy, J^2",
     .dt = 1e-2,
     .seconds = 10.0,
     .test_seconds = 2.0,
     .tolerance = 100.0,
     .reason = "what comes to rest is plastic; the best published is 5.18e6 at this step",
     .run = run_666_elastic},
};

const scene_group scenes_simbench = {"the tests of SimBenchmark",
                                     sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
