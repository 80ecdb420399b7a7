/* Impacts: of many bodies at once, one after the other, and on corners. */
#include "scene.h"

#include <math.h>

#define PI 3.14159265358979323846

/* ---- A6: cradles ----------------------------------------------------------------------------- */

enum { MOST_BALLS = 5 };

static const double EQUAL[MOST_BALLS] = {1.0, 1.0, 1.0, 1.0, 1.0};
static const double HALVED[3] = {1.0, 0.5, 0.25};

/* Balls of those masses in a row, the first at speed 1, the others at rest with gaps between them;
 * what the run makes of their velocities. */
static void run_row(world *w, int count, const double *masses, double e, double gap, double *v)
{
    world_begin(w, 0.0, 0.0, 0.0);
    for (int i = 0; i < count; i++) {
        tribo_scene_body ball = world_ball(masses[i], 0.5, 0.0, e);
        ball.state.position[0] = i * (1.0 + gap);
        ball.state.velocity[0] = i == 0 ? 1.0 : 0.0;
        world_before(w, &ball);
        world_add(w, &ball);
    }
    world_run(w, w->seconds);
    for (int i = 0; i < count; i++)
        v[i] = world_state(w, (uint32_t)i).velocity[0];
}

/* The last ball is the metric, the error the greatest of all. */
static void answer_row(int count, const double *v, const double *exact, scene_answer *answer)
{
    answer->metric = v[count - 1];
    answer->exact = exact[count - 1];
    answer->error =
        fmax(isnan(answer->error) ? 0.0 : answer->error, scene_distance(v, exact, (size_t)count));
}

/* Of N balls that touch the first gets (2 - N) / N, and all others 2 / N. */
static void run_cradle(world *w, scene_answer *answer)
{
    double v[MOST_BALLS], exact[MOST_BALLS];

    for (int n = 3; n <= MOST_BALLS; n++) {
        run_row(w, n, EQUAL, 1.0, 0.0, v);
        for (int i = 0; i < n; i++)
            exact[i] = i == 0 ? (2.0 - n) / n : 2.0 / n;
        answer_row(n, v, exact, answer);
    }
}

static void run_cradle_sequential(world *w, scene_answer *answer)
{
    static const double exact[MOST_BALLS] = {0.0, 0.0, 0.0, 0.0, 1.0};
    double v[MOST_BALLS];

    run_row(w, MOST_BALLS, EQUAL, 1.0, 1e-3, v);
    answer_row(MOST_BALLS, v, exact, answer);
}

/* Ten impacts of two balls each, the fastest approach first. */
static void lossy_row(double e, double v[MOST_BALLS])
{
    for (int i = 0; i < MOST_BALLS; i++)
        v[i] = i == 0 ? 1.0 : 0.0;
    for (int impact = 0; impact < MOST_BALLS * (MOST_BALLS - 1) / 2; impact++) {
        int first = 0;
        for (int i = 1; i + 1 < MOST_BALLS; i++)
            first = v[i] - v[i + 1] > v[first] - v[first + 1] ? i : first;
        const double mean = 0.5 * (v[first] + v[first + 1]);
        const double part = 0.5 * e * (v[first] - v[first + 1]);
        v[first] = mean - part;
        v[first + 1] = mean + part;
    }
}

static void run_cradle_lossy(world *w, scene_answer *answer)
{
    double v[MOST_BALLS], exact[MOST_BALLS];

    lossy_row(0.9, exact);
    run_row(w, MOST_BALLS, EQUAL, 0.9, 1e-3, v);
    answer_row(MOST_BALLS, v, exact, answer);
}

static void run_graded(world *w, scene_answer *answer)
{
    static const double exact[3] = {1.0 / 7.0, 8.0 / 7.0, 8.0 / 7.0};
    double v[3];

    run_row(w, 3, HALVED, 1.0, 0.0, v);
    answer_row(3, v, exact, answer);
}

static void run_graded_sequential(world *w, scene_answer *answer)
{
    static const double exact[3] = {1.0 / 3.0, 4.0 / 9.0, 16.0 / 9.0};
    double v[3];

    run_row(w, 3, HALVED, 1.0, 1e-3, v);
    answer_row(3, v, exact, answer);
}

/* ---- A7: breaks ------------------------------------------------------------------------------ */

/* Greatest error of the two that are struck: sqrt(3)/5 (1 + e) along their lines. */
static double fork_error(world *w, double e)
{
    const double speed = 0.2 * sqrt(3.0) * (1.0 + e);
    double error = 0.0;

    for (uint32_t side = 0; side < 2; side++) {
        const double across = side == 0 ? 0.5 : -0.5;
        const double exact[2] = {0.5 * sqrt(3.0) * speed, across * speed};
        const tribo_body ball = world_state(w, side);
        error = fmax(error, scene_distance(ball.velocity, exact, 2));
    }
    return error;
}

/* A ball at speed 1 into two others that touch it, at 30 degrees to both sides: it is left with
 * 1 - 3/5 (1 + e). */
static void run_fork(world *w, scene_answer *answer)
{
    static const double restitution[3] = {0.0, 0.5, 1.0};

    answer->error = 0.0;
    for (int k = 0; k < 3; k++) {
        const double e = restitution[k];
        tribo_scene_body ball = world_ball(1.0, 0.5, 0.0, e);
        world_begin(w, 0.0, 0.0, 0.0);
        world_add_at(w, &ball, 0.5 * sqrt(3.0), 0.5, 0.0);
        world_add_at(w, &ball, 0.5 * sqrt(3.0), -0.5, 0.0);
        ball.state.velocity[0] = 1.0;
        world_before(w, &ball);
        const uint32_t cue = world_add(w, &ball);
        world_run(w, w->seconds);
        answer->metric = world_state(w, cue).velocity[0];
        answer->exact = 1.0 - 0.6 * (1.0 + e);
        answer->error = fmax(answer->error, fabs(answer->metric - answer->exact));
        answer->error = fmax(answer->error, fork_error(w, e));
    }
}

enum { RACK_ROWS = 5 };

/* Greatest difference of balls and their mirror images; rows from the apex on, each from one side
 * to the other. */
static double asymmetry(world *w)
{
    double greatest = 0.0;

    for (uint32_t row = 0, first = 0; row < RACK_ROWS; first += ++row) {
        for (uint32_t place = 0; place <= row; place++) {
            const tribo_body one = world_state(w, first + place);
            const tribo_body two = world_state(w, first + row - place);
            greatest = fmax(greatest, fabs(one.velocity[0] - two.velocity[0]));
            greatest = fmax(greatest, fabs(one.velocity[1] + two.velocity[1]));
        }
    }
    return greatest;
}

/* 15 balls in a triangle, struck head-on: both sides do the same. */
static void run_rack(world *w, scene_answer *answer)
{
    tribo_scene_body ball = world_ball(0.17, 0.5, 0.0, 0.95);

    world_begin(w, 0.0, 0.0, 0.0);
    for (int row = 0; row < RACK_ROWS; row++) {
        for (int place = 0; place <= row; place++)
            world_add_at(w, &ball, 1.0 + 0.5 * sqrt(3.0) * row, 0.5 * row - place, 0.0);
    }
    ball.state.velocity[0] = 1.0;
    world_before(w, &ball);
    world_add(w, &ball);
    world_run(w, w->seconds);
    answer->metric = asymmetry(w);
    answer->exact = 0.0;
}

/* ---- A8: bounces that die out ---------------------------------------------------------------- */

static const double DROP = 1.0, DROP_E = 0.5;

static uint32_t drop_ball(world *w)
{
    const tribo_scene_body ground = world_floor(0.0, DROP_E);
    const tribo_scene_body ball = world_ball(1.0, 0.1, 0.0, DROP_E);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &ground);
    return world_add_at(w, &ball, 0.0, 0.0, 0.1 + DROP);
}

/* The last impact; exact: sqrt(2 h / g) (1 + e) / (1 - e), after no end of them. */
static void run_bounce(world *w, scene_answer *answer)
{
    uint64_t impacts = 0;

    drop_ball(w);
    for (uint64_t i = world_steps(w, w->seconds); i > 0 && w->status == TRIBO_OK; i--) {
        world_step(w);
        if (w->impacts > impacts)
            answer->metric = w->time - 0.5 * w->dt;
        impacts = w->impacts;
    }
    answer->exact = sqrt(2.0 * DROP / WORLD_G) * (1.0 + DROP_E) / (1.0 - DROP_E);
}

/* Height of the second apex, by energy: e^4 h. */
static void run_apex(world *w, scene_answer *answer)
{
    const uint32_t id = drop_ball(w);

    for (uint64_t i = world_steps(w, w->seconds); i > 0 && w->impacts < 2; i--)
        world_step(w);
    const tribo_body ball = world_state(w, id);
    const double v = ball.velocity[2];
    answer->metric = ball.position[2] - 0.1 + 0.5 * v * v / WORLD_G;
    answer->exact = pow(DROP_E, 4.0) * DROP;
}

/* ---- A9, A10: from corner to corner ---------------------------------------------------------- */

/* A body turns about its corner at (-back, -down) of the centre until the one at (back, -down)
 * strikes, seen at the midpoint of the first step: plastic, without slip. `i` is its moment of
 * inertia about y. */
static void strike_corner(world *w, tribo_scene_body *body, double i, double back, double down,
                          scene_answer *answer)
{
    const double m = 1.0 / body->state.inverse_mass;
    const double arm = back * back + down * down;
    const tribo_scene_body ground = world_floor(1.0, 0.0);

    world_begin(w, 0.0, 0.0, 0.0);
    body->state.position[2] = down;
    body->state.angular_velocity[1] = 1.0;
    body->state.velocity[0] = down;
    body->state.velocity[2] = -back;
    world_before(w, body);
    world_add(w, &ground);
    const uint32_t id = world_add(w, body);
    world_step(w);
    const tribo_body end = world_state(w, id);
    answer->metric = end.angular_velocity[1];
    answer->exact = (i + m * (down * down - back * back)) / (i + m * arm);
    const double exact[3] = {answer->exact * down, 0.0, answer->exact * back};
    answer->error = fmax(fabs(answer->metric - answer->exact),
                         scene_distance(end.velocity, exact, 3) / sqrt(arm));
}

static void rock(world *w, double half_width, double half_height, scene_answer *answer)
{
    const double i = (half_width * half_width + half_height * half_height) / 3.0;
    tribo_scene_body block = world_box(1.0, half_width, 0.5, half_height, 1.0, 0.0);

    strike_corner(w, &block, i, half_width, half_height, answer);
}

static void run_rocking(world *w, scene_answer *answer)
{
    rock(w, 0.2, 1.0, answer);
}

static void run_rocking_wide(world *w, scene_answer *answer)
{
    rock(w, 0.3, 1.0, answer);
}

static void run_rocking_cube(world *w, scene_answer *answer)
{
    rock(w, 0.5, 0.5, answer);
}

enum { SPOKES = 12, HULL_NUMBERS = 2048 };

static const double WHEEL_INERTIA = 0.5;

/* A wheel of spokes of length 1 and no rim: the hull of their ends, 0.4 wide. */
static tribo_scene_body make_wheel(world *w, double block[HULL_NUMBERS])
{
    tribo_scene_body wheel = world_body(1.0, 0.3, WHEEL_INERTIA, 0.3, 1.0, 0.0);
    double points[6 * SPOKES];

    for (int i = 0; i < 2 * SPOKES; i++) {
        const double angle = (i / 2 + 0.5) * 2.0 * PI / SPOKES;
        points[3 * i] = sin(angle);
        points[3 * i + 1] = i % 2 == 0 ? -0.2 : 0.2;
        points[3 * i + 2] = -cos(angle);
    }
    world_check(w, tribo_hull_build(2 * SPOKES, points, block, HULL_NUMBERS * sizeof *block, NULL));
    wheel.shape.type = TRIBO_SHAPE_HULL;
    wheel.shape.data = block;
    return wheel;
}

static void run_wheel(world *w, scene_answer *answer)
{
    double block[HULL_NUMBERS];
    tribo_scene_body wheel = make_wheel(w, block);

    strike_corner(w, &wheel, WHEEL_INERTIA, sin(PI / SPOKES), cos(PI / SPOKES), answer);
}

/* Down a slope strides become all alike: what gravity gives in one, the impact takes. The wheel
 * begins with such a one. */
static void run_wheel_descent(world *w, scene_answer *answer)
{
    const double slope = 0.1, alpha = PI / SPOKES;
    const double i = WHEEL_INERTIA + 1.0; /* about the foot */
    const double kept = (WHEEL_INERTIA + cos(2.0 * alpha)) / i;
    const double given = 4.0 * WORLD_G * sin(alpha) * sin(slope) / i;
    const double before = sqrt(given / (1.0 - kept * kept)), start = kept * before;
    const tribo_scene_body ground = world_floor(1.0, 0.0);
    double block[HULL_NUMBERS];
    tribo_scene_body wheel = make_wheel(w, block);
    double greatest = 0.0;

    world_begin(w, WORLD_G * sin(slope), 0.0, -WORLD_G * cos(slope));
    wheel.state.angular_velocity[1] = start;
    wheel.state.velocity[0] = start * cos(alpha);
    wheel.state.velocity[2] = start * sin(alpha);
    world_add(w, &ground);
    const uint32_t id = world_add_at(w, &wheel, 0.0, 0.0, cos(alpha));
    for (uint64_t k = world_steps(w, w->seconds); k > 0 && w->status == TRIBO_OK; k--) {
        world_step(w);
        if (w->time > 0.75 * w->seconds)
            greatest = fmax(greatest, world_state(w, id).angular_velocity[1]);
    }
    answer->metric = greatest;
    answer->exact = before;
}

/* ---- table ----------------------------------------------------------------------------------- */

#define OF_ALL_BALLS "velocity of the last ball, m/s; error: greatest of all"
#define OF_ALL_VELOCITIES "share of the angular velocity that is left; error: of all velocities"

static const scene_entry ENTRIES[] = {
    {.name = "a6-cradle",
     .what = "3, 4 and 5 equal balls that touch, the first at 1 m/s, e 1: all share the impact",
     .metric = OF_ALL_BALLS,
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_cradle},
    {.name = "a6-cradle-sequential",
     .what = "5 equal balls with gaps, the first at 1 m/s, e 1: they pass the impact on",
     .metric = OF_ALL_BALLS,
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_cradle_sequential},
    {.name = "a6-cradle-lossy",
     .what = "the same with e 0.9: ten impacts of two balls each",
     .metric = OF_ALL_BALLS,
     .dt = 1e-2,
     .seconds = 20.0,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_cradle_lossy},
    {.name = "a6-graded",
     .what = "balls of 1, 1/2 and 1/4 kg that touch, the first at 1 m/s, e 1",
     .metric = OF_ALL_BALLS,
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_graded},
    {.name = "a6-graded-sequential",
     .what = "the same with gaps",
     .metric = OF_ALL_BALLS,
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_graded_sequential},
    {.name = "a7-fork",
     .what = "a ball at 1 m/s into two that touch, 30 degrees to both sides; e 0, 0.5 and 1",
     .metric = "velocity left at e 1, m/s; error: greatest of all balls and e",
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 16.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_fork},
    {.name = "a7-rack",
     .what = "a ball at 1 m/s head-on into a triangle of 15 that touch, e 0.95",
     .metric = "greatest difference of a ball and its mirror image, m/s",
     .dt = 1e-2,
     .seconds = 0.1,
     .tolerance = 64.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding: a solver may have an order, the law has none",
     .run = run_rack},
    {.name = "a8-bounce",
     .what = "a ball falls 1 m, e 0.5, and comes to rest",
     .metric = "time of the last impact, s",
     .dt = 1e-3,
     .seconds = 3.0,
     .tolerance = 24.0,
     .scale = SCENE_PER_DT,
     .reason = "two steps for each of a dozen impacts: a step early, and from as high",
     .run = run_bounce},
    {.name = "a8-apex",
     .what = "the same until its second bounce",
     .metric = "height of the apex after it, m",
     .dt = 1e-3,
     .seconds = 3.0,
     .tolerance = 2.5,
     .scale = SCENE_PER_DT,
     .reason = "impacts take place up to a step's way above the floor: 3/16 4.43 + 3/4 2.2 dt",
     .run = run_apex},
    {.name = "a9-rocking",
     .what = "a block of 0.4 x 2 m rocks onto its other corner, e 0, without slip",
     .metric = OF_ALL_VELOCITIES,
     .dt = 0.125,
     .seconds = 0.125,
     .tolerance = 64.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_rocking},
    {.name = "a9-rocking-wide",
     .what = "the same of 0.6 x 2 m",
     .metric = OF_ALL_VELOCITIES,
     .dt = 0.125,
     .seconds = 0.125,
     .tolerance = 64.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_rocking_wide},
    {.name = "a9-rocking-cube",
     .what = "the same of 1 x 1 m",
     .metric = OF_ALL_VELOCITIES,
     .dt = 0.125,
     .seconds = 0.125,
     .tolerance = 64.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_rocking_cube},
    {.name = "a10-wheel",
     .what = "a wheel of 12 spokes without a rim falls from one onto the next",
     .metric = OF_ALL_VELOCITIES,
     .dt = 0.125,
     .seconds = 0.125,
     .tolerance = 64.0,
     .scale = SCENE_PER_EPS,
     .solver_tolerance = 1e-15,
     .reason = "rounding",
     .run = run_wheel},
    {.name = "a10-wheel-descent",
     .what = "it rolls down a slope of 0.1 in strides that are alike",
     .metric = "angular velocity before an impact, rad/s",
     .dt = 1e-3,
     .seconds = 8.0,
     .test_seconds = 2.0,
     .tolerance = 12.0,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step: 10.6 dt measured from 4e-3 to 2.5e-4 s",
     .run = run_wheel_descent},
};

const scene_group scenes_impact = {"impacts", sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
