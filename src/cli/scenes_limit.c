/* Limits of rest and of stability: bodies stay where they are up to a value of one parameter, and
 * move beyond. The exact limits are closed forms, or linear programs of planar statics; bisection
 * finds where the motion has them. */
#include "scene.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DEGREES (PI / 180.0)
#define STRONG 1e3      /* friction of what is not to be the weaker of a pair */
#define WIDTH 1e-4      /* of the limit: where the search ends */
#define BESIDE 1e-3     /* of the limit: below and beyond it rest and motion are shown */
#define REST 1e-6       /* of the size, per second: drift of what counts as at rest */
#define ON_THE_WAY 1e-3 /* of the size: who has gone so far moves */

/* What `given` of a scene is. */
typedef struct limit {
    /* Begin a world in which bodies rest or move. Returns their size, m. */
    double (*build)(world *w, const struct limit *limit, double parameter);
    double (*exact)(const struct limit *limit);
    /* Run it; whether that is on the other side of the limit than rest. */
    int (*is_beyond)(world *w, const struct limit *limit, double parameter);
    double low, high; /* one of them rests */
    double given[3];
} limit;

/* ---- search ---------------------------------------------------------------------------------- */

/* Share of the size that the bodies move by per second. */
static double drift(world *w, const limit *l, double parameter)
{
    const double size = l->build(w, l, parameter);
    const uint64_t steps = world_steps(w, w->seconds);
    double way = 0.0;

    world_keep(w);
    for (uint64_t i = 0; i < steps && way < ON_THE_WAY && w->status == TRIBO_OK; i++) {
        world_step(w);
        way = world_way(w, size) / size;
    }
    return w->time > 0.0 ? way / w->time : 0.0;
}

static int moves(world *w, const limit *l, double parameter)
{
    const double d = drift(w, l, parameter);

    if (w->notes != NULL)
        fprintf(w->notes, "at %.10g: drift %.3g of the size per second\n", parameter, d);
    return d > REST;
}

static void run_limit(world *w, scene_answer *answer)
{
    const limit *l = w->given;
    double low = l->low, high = l->high;
    FILE *csv = w->csv;

    w->csv = NULL; /* the motions beside the limit alone are of interest */
    answer->exact = l->exact(l);
    const int low_is = l->is_beyond(w, l, low);
    if (low_is == l->is_beyond(w, l, high)) {
        answer->error = 1.0; /* there is no limit */
        return;
    }
    while (high - low > WIDTH * high && w->status == TRIBO_OK) {
        const double middle = 0.5 * (low + high);
        const int is = l->is_beyond(w, l, middle);
        low = is == low_is ? middle : low;
        high = is == low_is ? high : middle;
    }
    answer->metric = 0.5 * (low + high);
    answer->error = fabs(answer->metric - answer->exact) / answer->exact;
    w->csv = csv;
    const int below = l->is_beyond(w, l, answer->exact * (1.0 - BESIDE));
    const int above = l->is_beyond(w, l, answer->exact * (1.0 + BESIDE));
    if (below != low_is || above == low_is)
        answer->error = fmax(answer->error, BESIDE);
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static void add_plane(world *w, double nx, double nz, double d, double mu)
{
    const tribo_scene_body plane = world_plane(nx, nz, d, mu);

    world_add(w, &plane);
}

/* Two balls as one body touches with them, at +-0.2 m along y. */
static void add_balls(tribo_child balls[2], double radius, double x, double z)
{
    for (int i = 0; i < 2; i++) {
        balls[i] = (tribo_child){.shape = {.type = TRIBO_SHAPE_SPHERE, .size = {radius}},
                                 .pose = {{x, i == 0 ? 0.2 : -0.2, z}, {1.0, 0.0, 0.0, 0.0}}};
    }
}

static tribo_scene_body body_of_balls(const tribo_child *balls, uint32_t count, double mu)
{
    tribo_scene_body body = world_body(1.0, 0.1, 0.1, 0.1, mu, 0.0);

    body.shape = (tribo_shape){.type = TRIBO_SHAPE_COMPOUND, .count = count, .data = balls};
    return body;
}

/* ---- ladder: friction of floor and wall; degrees ---------------------------------------------- */

static double build_ladder(world *w, const limit *l, double degrees)
{
    const double angle = degrees * DEGREES;
    tribo_scene_body ladder = world_box(1.0, 0.5, 0.2, 0.02, STRONG, 0.0);

    world_begin_mixed(w, 0.0, 0.0, -WORLD_G, TRIBO_MIX_MINIMUM);
    add_plane(w, 0.0, 1.0, 0.0, l->given[0]);
    add_plane(w, -1.0, 0.0, 0.0, l->given[1]);
    ladder.offset.position[2] = 0.02; /* centre of mass amid the two edges that touch */
    world_tilt(&ladder, -angle);
    world_add_at(w, &ladder, -0.5 * cos(angle), 0.0, 0.5 * sin(angle));
    return 1.0;
}

static double exact_ladder(const limit *l)
{
    return atan((1.0 - l->given[0] * l->given[1]) / (2.0 * l->given[0])) / DEGREES;
}

/* ---- two cards that lean on each other: half the angle between them; friction of the floor ------ */

static double build_frame(world *w, const limit *l, double mu)
{
    static tribo_child balls[2][4];
    const double phi = l->given[0] * DEGREES, radius = 0.01;
    const double x = 0.5 * sin(phi), z = 0.5 * cos(phi);

    world_begin_mixed(w, 0.0, 0.0, -WORLD_G, TRIBO_MIX_MINIMUM);
    add_plane(w, 0.0, 1.0, 0.0, mu);
    for (int i = 0; i < 2; i++) {
        const double side = i == 0 ? -1.0 : 1.0;
        add_balls(balls[i], radius, side * x, radius - z);
        add_balls(balls[i] + 2, radius, side * (radius - x), z);
        const tribo_scene_body card = body_of_balls(balls[i], 4, 0.7);
        world_add_at(w, &card, side * x, 0.0, z);
    }
    return 1.0;
}

static double exact_frame(const limit *l)
{
    return 0.5 * tan(l->given[0] * DEGREES);
}

/* ---- box on a slope: width, height, friction; degrees ------------------------------------------ */

static double build_slope(world *w, const limit *l, double degrees)
{
    const double angle = degrees * DEGREES, h = 0.5 * l->given[1];
    tribo_scene_body box = world_box(1.0, 0.5 * l->given[0], 0.5, h, STRONG, 0.0);

    world_begin_mixed(w, 0.0, 0.0, -WORLD_G, TRIBO_MIX_MINIMUM);
    add_plane(w, sin(angle), cos(angle), 0.0, l->given[2]);
    world_tilt(&box, angle);
    world_add_at(w, &box, h * sin(angle), 0.0, h * cos(angle));
    return 1.0;
}

static double exact_slope(const limit *l)
{
    return fmin(atan(l->given[2]), atan(l->given[0] / l->given[1])) / DEGREES;
}

/* ---- collar on a shaft: friction, length; offset of the load -------------------------------------
 * The load is a force and a torque on a collar whose centre of mass lies on the shaft. If its weight
 * were the load, falling freely without touching would be a second solution of Coulomb's law. So
 * would, within 1e-3 beyond the limit, be turning about x while it slides, were it free to. */

static double build_collar(world *w, const limit *l, double offset)
{
    static tribo_child balls[4];
    const double radius = 0.01, shaft = 0.05, half = 0.5 * l->given[1];
    const double force[3] = {0.0, 0.0, -10.0}, torque[3] = {0.0, 10.0 * offset, 0.0};

    world_begin_mixed(w, 0.0, 0.0, 0.0, TRIBO_MIX_MINIMUM);
    const tribo_scene_body bar = world_block(shaft, 0.3, 5.0 * l->given[1], l->given[0]);
    world_add_at(w, &bar, 0.0, 0.0, 0.0);
    add_balls(balls, radius, -shaft - radius, half);
    add_balls(balls + 2, radius, shaft + radius, -half);
    tribo_scene_body collar = body_of_balls(balls, 4, STRONG);
    for (int i = 0; i < 6; i++) /* symmetric, 00 01 02 11 12 22: it turns about y alone */
        collar.state.inverse_inertia[i] = i == 3 ? collar.state.inverse_inertia[i] : 0.0;
    const uint32_t id = world_add(w, &collar);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_set_force(w->scene, id, force, torque));
    return l->given[1];
}

static double exact_collar(const limit *l)
{
    return l->given[1] / (2.0 * l->given[0]);
}

/* ---- wedge between two jaws: half of its angle; friction ------------------------------------------
 * The jaws are pressed together by forces, slide on a floor without friction and cannot turn. The
 * wedge, its wide end up, is free. A wedge that is left alone in a fixed groove has two solutions:
 * to stay, under stress that rigid bodies do not know, and to leave. */

static tribo_scene_body wedge_of(double angle, double mu)
{
    static double hull[256];
    double corners[24];
    size_t needed = 0;
    tribo_scene_body wedge = world_body(1.0, 0.1, 0.1, 0.1, mu, 0.0);

    for (int i = 0; i < 8; i++) {
        const double z = i & 1 ? 0.4 : -0.4;
        const double x = 0.4 + z * tan(angle);
        corners[3 * i] = i & 2 ? x : -x;
        corners[3 * i + 1] = i & 4 ? 0.3 : -0.3;
        corners[3 * i + 2] = z;
    }
    if (tribo_hull_build(8, corners, hull, sizeof hull, &needed) == TRIBO_OK)
        wedge.shape = (tribo_shape){.type = TRIBO_SHAPE_HULL, .data = hull};
    return wedge;
}

static double build_wedge(world *w, const limit *l, double mu)
{
    const double angle = l->given[0] * DEGREES, hx = 0.2, hz = 0.3;
    const tribo_scene_body wedge = wedge_of(angle, mu);
    tribo_scene_body jaw = world_box(1.0, hx, 0.5, hz, STRONG, 0.0);

    world_begin_mixed(w, 0.0, 0.0, 0.0, TRIBO_MIX_MINIMUM);
    add_plane(w, 0.0, 1.0, -2.0 * hx * sin(angle) - hz * cos(angle), 0.0);
    world_add(w, &wedge);
    memset(jaw.state.inverse_inertia, 0, sizeof jaw.state.inverse_inertia);
    for (int i = 0; i < 2; i++) {
        const double side = i == 0 ? -1.0 : 1.0;
        const double force[3] = {-10.0 * side, 0.0, 0.0};
        world_tilt(&jaw, side * angle);
        const uint32_t id =
            world_add_at(w, &jaw, side * (0.4 + hx * cos(angle)), 0.0, -hx * sin(angle));
        if (w->status == TRIBO_OK)
            world_check(w, tribo_scene_set_force(w->scene, id, force, NULL));
    }
    return 1.0;
}

static double exact_wedge(const limit *l)
{
    return tan(l->given[0] * DEGREES);
}

/* ---- harmonic overhang: number of blocks; how far the uppermost reaches out ---------------------- */

/* Sum of 1 / 2k, in lengths of a block. */
static double exact_overhang(const limit *l)
{
    double sum = 0.0;

    for (int k = 1; k <= (int)l->given[0]; k++)
        sum += 0.5 / k;
    return sum;
}

static double build_overhang(world *w, const limit *l, double reach)
{
    const int count = (int)l->given[0];
    const double h = 0.05, share = reach / exact_overhang(l);
    const tribo_scene_body block = world_box(1.0, 0.5, 0.25, h, 0.5, 0.0);
    double edge = 0.0;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    const tribo_scene_body ledge = world_block(2.0, 0.25, 0.5, 0.5);
    world_add_at(w, &ledge, -2.0, 0.0, -0.5);
    for (int k = count; k > 0; k--) {
        edge += share * 0.5 / k;
        world_add_at(w, &block, edge - 0.5, 0.0, h * (2 * (count - k) + 1));
    }
    return 1.0;
}

/* ---- capstan: number of contacts, friction, turn; ratio of the forces ----------------------------
 * A rope that is pushed: balls that cannot turn, without friction between them, in a row along the
 * inside of a round wall, pressed together by a force at either end. */

static double build_capstan(world *w, const limit *l, double ratio)
{
    const int count = (int)l->given[0];
    const double delta = l->given[2] / count, radius = sin(0.5 * delta);
    tribo_scene_body ball = world_ball(1.0 / count, radius, 0.0, 0.0);
    tribo_scene_body wall = world_floor(l->given[1], 0.0);

    memset(ball.state.inverse_inertia, 0, sizeof ball.state.inverse_inertia);
    world_begin(w, 0.0, 0.0, 0.0);
    for (int i = 0; i < count; i++) {
        const double a = i * delta;
        const double before = a - 0.5 * delta, after = a + 0.5 * delta;
        const double push = i == 0 ? 1.0 : 0.0, pull = i == count - 1 ? ratio : 0.0;
        const double force[3] = {-push * sin(before) + pull * sin(after),
                                 push * cos(before) - pull * cos(after), 0.0};
        const double plane[4] = {-cos(a), -sin(a), 0.0, -1.0 - radius};
        memcpy(wall.shape.size, plane, sizeof plane);
        world_add(w, &wall);
        const uint32_t id = world_add_at(w, &ball, cos(a), sin(a), 0.0);
        if (w->status == TRIBO_OK)
            world_check(w, tribo_scene_set_force(w->scene, id, force, NULL));
    }
    return 1.0;
}

static double exact_capstan(const limit *l)
{
    const double half = 0.5 * l->given[2] / l->given[0];
    const double away = l->given[1] * sin(half);

    return pow((cos(half) + away) / (cos(half) - away), l->given[0]);
}

/* ---- arches: equal voussoirs, a half circle of mean radius 1 ------------------------------------- */

/* A voussoir has straight sides, and the centre of mass of the piece of a ring that it stands for. */
static void build_voussoir(int count, double thickness, double mu, tribo_scene_body *out)
{
    static double hull[256];
    const double half = 0.5 * PI / count;
    const double inner = 1.0 - 0.5 * thickness, outer = 1.0 + 0.5 * thickness;
    const double ring = (inner * inner + inner * outer + outer * outer) / (inner + outer);
    double corners[24];
    size_t needed = 0;

    for (int i = 0; i < 8; i++) {
        const double r = i & 1 ? outer : inner, a = i & 2 ? half : -half;
        corners[3 * i] = r * sin(a);
        corners[3 * i + 1] = i & 4 ? 0.1 : -0.1;
        corners[3 * i + 2] = r * cos(a);
    }
    *out = world_box(1.0, half, 0.1, 0.5 * thickness, mu, 0.0);
    out->offset.position[2] = -2.0 / 3.0 * ring * sin(half) / half;
    if (tribo_hull_build(8, corners, hull, sizeof hull, &needed) == TRIBO_OK)
        out->shape = (tribo_shape){.type = TRIBO_SHAPE_HULL, .data = hull};
}

static void build_arch(world *w, int count, double thickness, double mu)
{
    tribo_scene_body voussoir;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    add_plane(w, 0.0, 1.0, 0.0, mu);
    build_voussoir(count, thickness, mu, &voussoir);
    for (int i = 0; i < count; i++) {
        const double angle = (i + 0.5) * PI / count - 0.5 * PI;
        const double r = -voussoir.offset.position[2];
        world_tilt(&voussoir, angle);
        world_add_at(w, &voussoir, r * sin(angle), 0.0, r * cos(angle));
    }
}

static double build_arch_by_thickness(world *w, const limit *l, double thickness)
{
    build_arch(w, (int)l->given[0], thickness, l->given[1]);
    return 1.0;
}

static double build_arch_by_friction(world *w, const limit *l, double mu)
{
    build_arch(w, (int)l->given[0], l->given[1], mu);
    return 1.0;
}

static double exact_arch(const limit *l)
{
    return l->given[2];
}

/* Whether the keystone has come down by a tenth of the radius. */
static double keystone(world *w)
{
    return world_state(w, 14).position[2];
}

static void run_standing_arch(world *w, scene_answer *answer)
{
    build_arch(w, 27, 0.115, 0.6);
    const double before = keystone(w);
    world_run(w, w->seconds);
    answer->metric = before - keystone(w);
    answer->exact = 0.0;
}

/* Seconds until the keystone has come down by a tenth of the radius. */
static void run_falling_arch(world *w, scene_answer *answer)
{
    build_arch(w, 27, 0.100, 0.6);
    const double before = keystone(w);
    const double energy = world_energy(w);
    double gain = 0.0;
    while (w->time < w->seconds && before - keystone(w) < 0.1 && w->status == TRIBO_OK) {
        world_step(w);
        gain = fmax(gain, world_energy(w) - energy);
    }
    answer->metric = w->time;
    answer->error = w->time < w->seconds ? gain / energy : 1.0;
}

/* ---- domino, released from rest on its edge: width, height; degrees ------------------------------ */

static double lean_of(const tribo_body *body)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    double axis[3];

    tribo_quat_rotate(body->orientation, up, axis);
    return atan2(hypot(axis[0], axis[1]), axis[2]);
}

/* Whether it falls over, not back. */
static int topples(world *w, const limit *l, double degrees)
{
    const double angle = degrees * DEGREES, x = 0.5 * l->given[0], z = 0.5 * l->given[1];
    const uint64_t steps = world_steps(w, w->seconds);
    tribo_scene_body box = world_box(1.0, x, z, z, 1.0, 0.0);
    double lean = angle;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    add_plane(w, 0.0, 1.0, 0.0, 1.0);
    world_tilt(&box, angle);
    const uint32_t id = world_add_at(w, &box, z * sin(angle) - x * cos(angle), 0.0,
                                     x * sin(angle) + z * cos(angle));
    for (uint64_t i = 0; i < steps && fabs(lean - angle) < 0.1 * angle; i++) {
        world_step(w);
        const tribo_body state = world_state(w, id);
        lean = lean_of(&state);
    }
    if (w->notes != NULL)
        fprintf(w->notes, "at %.10g: leans by %.4g after %g s\n", degrees, lean / DEGREES, w->time);
    return lean > angle;
}

static double exact_domino(const limit *l)
{
    return atan(l->given[0] / l->given[1]) / DEGREES;
}

/* ---- table --------------------------------------------------------------------------------------- */

#define LIMIT(...)  \
    &(const limit)  \
    {               \
        __VA_ARGS__ \
    }
#define BRACKET                                                                                    \
    .tolerance = BESIDE, .dt = 1.0 / 60.0, .seconds = 1.0, .test_seconds = 0.05, .run = run_limit, \
    .reason = "the law itself: no more than the search leaves is expected"

static const scene_entry ENTRIES[] = {
    {.name = "b7-ladder-smooth-wall",
     .what = "a ladder on a floor of mu 0.4, at a wall without friction",
     .metric = "least angle at which it stands, degrees; error: relative",
     .given = LIMIT(build_ladder, exact_ladder, moves, 20.0, 80.0, {0.4, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-ladder",
     .what = "a ladder on a floor of mu 0.4, at a wall of mu 0.3",
     .metric = "least angle at which it stands, degrees; error: relative",
     .given = LIMIT(build_ladder, exact_ladder, moves, 20.0, 80.0, {0.4, 0.3, 0.0}),
     BRACKET},
    {.name = "b7-ladder-rough",
     .what = "a ladder on a floor of mu 0.6, at a wall of mu 0.6",
     .metric = "least angle at which it stands, degrees; error: relative",
     .given = LIMIT(build_ladder, exact_ladder, moves, 10.0, 80.0, {0.6, 0.6, 0.0}),
     BRACKET},
    {.name = "b7-frame-25",
     .what = "two cards that lean on each other, 25 degrees from upright",
     .metric = "least friction of the floor; error: relative",
     .given = LIMIT(build_frame, exact_frame, moves, 0.01, 0.65, {25.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-frame-40",
     .what = "two cards that lean on each other, 40 degrees from upright",
     .metric = "least friction of the floor; error: relative",
     .given = LIMIT(build_frame, exact_frame, moves, 0.01, 0.65, {40.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-slope-slides",
     .what = "a cube on a slope, mu 0.5",
     .metric = "greatest angle of rest, degrees; error: relative",
     .given = LIMIT(build_slope, exact_slope, moves, 5.0, 60.0, {1.0, 1.0, 0.5}),
     BRACKET},
    {.name = "b7-slope-topples",
     .what = "a box thrice as high as wide on a slope, mu 0.8",
     .metric = "greatest angle of rest, degrees; error: relative",
     .given = LIMIT(build_slope, exact_slope, moves, 5.0, 60.0, {1.0, 3.0, 0.8}),
     BRACKET},
    {.name = "b7-collar",
     .what = "a collar of length 1 on a shaft, mu 0.2, loaded off its axis",
     .metric = "least offset of the load at which it jams, m; error: relative",
     .given = LIMIT(build_collar, exact_collar, moves, 0.1, 10.0, {0.2, 1.0, 0.0}),
     BRACKET},
    {.name = "b7-drawer",
     .what = "a drawer of length 2 between rails, mu 0.5, pulled off its axis",
     .metric = "least offset of the pull at which it jams, m; error: relative",
     .given = LIMIT(build_collar, exact_collar, moves, 0.1, 10.0, {0.5, 2.0, 0.0}),
     BRACKET},
    {.name = "b7-wedge",
     .what = "a wedge of 20 degrees to either side, between jaws that are pressed together",
     .metric = "least friction at which it locks; error: relative",
     .given = LIMIT(build_wedge, exact_wedge, moves, 0.01, 1.0, {20.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-overhang-4",
     .what = "4 blocks, each over the edge of the one below in harmonic shares",
     .metric = "greatest reach of the uppermost, lengths of a block; error: relative",
     .given = LIMIT(build_overhang, exact_overhang, moves, 0.5, 2.0, {4.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-overhang-10",
     .what = "10 blocks, each over the edge of the one below in harmonic shares",
     .metric = "greatest reach of the uppermost, lengths of a block; error: relative",
     .given = LIMIT(build_overhang, exact_overhang, moves, 0.5, 2.0, {10.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-overhang-31",
     .what = "31 blocks, each over the edge of the one below in harmonic shares",
     .metric = "greatest reach of the uppermost, lengths of a block; error: relative",
     .given = LIMIT(build_overhang, exact_overhang, moves, 0.5, 3.0, {31.0, 0.0, 0.0}),
     BRACKET},
    {.name = "b7-capstan-10",
     .what = "10 beads pushed along half a turn of a round wall, mu 0.3",
     .metric = "greatest ratio of the forces at rest; error: relative",
     .given = LIMIT(build_capstan, exact_capstan, moves, 1.1, 5.0, {10.0, 0.3, PI}),
     BRACKET},
    {.name = "b7-capstan-100",
     .what = "100 beads pushed along half a turn of a round wall, mu 0.3",
     .metric = "greatest ratio of the forces at rest; error: relative",
     .given = LIMIT(build_capstan, exact_capstan, moves, 1.1, 5.0, {100.0, 0.3, PI}),
     BRACKET},
    {.name = "b8-arch-9",
     .what = "a half circle of 9 voussoirs that do not slide, mu 10",
     .metric = "least thickness over radius; error: relative",
     .given = LIMIT(build_arch_by_thickness, exact_arch, moves, 0.05, 0.2, {9.0, 10.0, 0.10213423}),
     BRACKET},
    {.name = "b8-arch-16",
     .what = "a half circle of 16 voussoirs that do not slide, mu 10",
     .metric = "least thickness over radius; error: relative",
     .given =
         LIMIT(build_arch_by_thickness, exact_arch, moves, 0.05, 0.2, {16.0, 10.0, 0.10723722}),
     BRACKET},
    {.name = "b8-arch-27",
     .what = "a half circle of 27 voussoirs that do not slide, mu 10",
     .metric = "least thickness over radius; error: relative",
     .given =
         LIMIT(build_arch_by_thickness, exact_arch, moves, 0.05, 0.2, {27.0, 10.0, 0.10677634}),
     BRACKET},
    {.name = "b8-arch-friction-12",
     .what = "a half circle of 27 voussoirs, thickness 0.12",
     .metric = "least friction; error: relative",
     .given = LIMIT(build_arch_by_friction, exact_arch, moves, 0.1, 0.8, {27.0, 0.12, 0.38057422}),
     BRACKET},
    {.name = "b8-arch-friction-15",
     .what = "a half circle of 27 voussoirs, thickness 0.15",
     .metric = "least friction; error: relative",
     .given = LIMIT(build_arch_by_friction, exact_arch, moves, 0.1, 0.8, {27.0, 0.15, 0.35056500}),
     BRACKET},
    {.name = "b8-arch-friction-20",
     .what = "a half circle of 27 voussoirs, thickness 0.2",
     .metric = "least friction; error: relative",
     .given = LIMIT(build_arch_by_friction, exact_arch, moves, 0.1, 0.8, {27.0, 0.20, 0.30898831}),
     BRACKET},
    {.name = "b8-arch-stands",
     .what = "a half circle of 27 voussoirs, thickness 0.115, mu 0.6",
     .metric = "how far the keystone comes down, radii",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .test_seconds = 1.0,
     .tolerance = 1e-8,
     .reason = "at rest: what the solver leaves in each step",
     .run = run_standing_arch},
    {.name = "b8-arch-falls",
     .what = "a half circle of 27 voussoirs, thickness 0.100, mu 0.6",
     .metric = "when the keystone has come down by a tenth of the radius, s; error: energy gained, "
               "of the whole, or 1 if it stands",
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 6e-4,
     .reason = "thinner than 0.1068 it collapses; (h F)^2 / 8m of energy for each body that comes "
               "to move within a step",
     .run = run_falling_arch},
    {.name = "b16-domino",
     .what = "a domino a fifth as wide as high, released at rest on its edge",
     .metric = "least angle from upright at which it falls over, degrees; error: relative",
     .dt = 1e-3,
     .seconds = 5.0,
     .test_seconds = 5.0,
     .tolerance = BESIDE,
     .reason = "the centre of mass over the edge",
     .given = LIMIT(NULL, exact_domino, topples, 1.0, 40.0, {0.2, 1.0, 0.0}),
     .run = run_limit},
};

const scene_group scenes_limit = {"limits of rest", sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
