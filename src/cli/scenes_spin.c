/* Bodies that spin: free, on a point that rolls or slides, and about a point that is held. */
#include "scene.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static void axis_of(const tribo_body *body, double axis[3])
{
    static const double up[3] = {0.0, 0.0, 1.0};

    tribo_quat_rotate(body->orientation, up, axis);
}

static double lean_of(const tribo_body *body)
{
    double axis[3];

    axis_of(body, axis);
    return atan2(hypot(axis[0], axis[1]), axis[2]);
}

static void note(const world *w, const char *what, double number)
{
    if (w->notes != NULL)
        fprintf(w->notes, "%s: %.6g\n", what, number);
}

/* ---- B11: Euler's disc -------------------------------------------------------------------------
 * A thin disc of radius 1 m and 1 kg rolls without loss, its centre at rest: Omega^2 sin(tilt) = 4 g,
 * E = 3/2 g sin(tilt) (Moffatt, Nature 404 (2000) 833). A contact that persists
 * is held where a step finds it: that takes at most h f . R f / 2 of power, with f its force and R
 * what turning adds to its contact matrix; here 2 g^2 cos^2(tilt) h. */

static void run_disc(world *w, scene_answer *answer)
{
    const double tilt = *(const double *)w->given, half = 0.01, mu = 10.0;
    const double spin = 2.0 * sqrt(WORLD_G * sin(tilt)); /* about the diameter to the contact */
    const tribo_scene_body floor = world_floor(mu, 0.0);
    tribo_scene_body disc = world_body(1.0, 0.25, 0.25, 0.5, mu, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &floor);
    disc.shape = (tribo_shape){.type = TRIBO_SHAPE_CYLINDER, .size = {1.0, half}};
    disc.offset.position[2] = half; /* its lower face is the thin disc */
    world_tilt(&disc, tilt);
    disc.state.angular_velocity[0] = -spin * cos(tilt);
    disc.state.angular_velocity[2] = spin * sin(tilt);
    const uint32_t id = world_add_at(w, &disc, 0.0, 0.0, sin(tilt));
    const double before = world_energy(w);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    answer->metric = (before - world_energy(w)) / w->time;
    answer->exact = 0.0;
    note(w, "energy at the start, J", before);
    note(w, "energy lost, of the whole", answer->metric * w->time / before);
    note(w, "tilt gained, rad", lean_of(&end) - tilt);
    note(w, "periods", w->time * spin / (2.0 * PI * sin(tilt)));
}

/* ---- B12: tippe top ----------------------------------------------------------------------------
 * Jellett's number L . r, with r from the centre of mass to the contact, stays whatever force acts
 * there. The motion itself hangs on how friction begins: with Coulomb's law these tops soon roll,
 * and do not turn over; with friction in proportion to slip below 1 mm/s the first one does. */

static double jellett(world *w, uint32_t id, double radius, double offset)
{
    const tribo_body body = world_state(w, id);
    double spin[3] = {0.0}, arm[3];

    axis_of(&body, arm);
    tribo_vec3_scale(offset, arm, arm);
    arm[2] -= radius;
    tribo_body_spin(&body, spin);
    return tribo_vec3_dot(spin, arm);
}

static void run_tippe_top(world *w, scene_answer *answer)
{
    const double ratio = *(const double *)w->given; /* of the moments across and along the axis */
    const double radius = 0.02, offset = 0.003, along = 8e-7, mu = 0.3, lean = 5.7 * PI / 180.0;
    const tribo_scene_body floor = world_floor(mu, 0.0);
    tribo_scene_body top = world_body(0.006, ratio * along, ratio * along, along, mu, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &floor);
    top.shape = (tribo_shape){.type = TRIBO_SHAPE_SPHERE, .size = {radius}};
    top.offset.position[2] = offset;
    top.state.angular_velocity[2] = 150.0;
    world_tilt(&top, lean);
    const uint32_t id = world_add_at(w, &top, 0.0, 0.0, radius - offset * cos(lean));
    answer->exact = jellett(w, id, radius, offset);
    answer->error = 0.0;
    for (uint64_t left = world_steps(w, w->seconds); left > 0 && w->status == TRIBO_OK; left--) {
        world_step(w);
        answer->metric = jellett(w, id, radius, offset);
        answer->error = fmax(answer->error, fabs(answer->metric / answer->exact - 1.0));
    }
    const tribo_body end = world_state(w, id);
    note(w, "lean at the end, degrees", lean_of(&end) * 180.0 / PI);
}

/* ---- B13: rattleback ---------------------------------------------------------------------------
 * An ellipsoid whose principal axes of inertia stand askew by 0.1 rad: spun one way it turns back. */

static void run_rattleback(world *w, scene_answer *answer)
{
    const double spin = *(const double *)w->given, mu = 1.0, skew = -0.1;
    const double a = 0.1, b = 0.03, c = 0.02;
    const double x = (b * b + c * c) / 5.0, y = (a * a + c * c) / 5.0, z = (a * a + b * b) / 5.0;
    const double cross = (x - y) * cos(skew) * sin(skew);
    const double inertia[9] = {x + (y - x) * sin(skew) * sin(skew),
                               cross,
                               0.0,
                               cross,
                               y + (x - y) * sin(skew) * sin(skew),
                               0.0,
                               0.0,
                               0.0,
                               z};
    const tribo_scene_body floor = world_floor(mu, 0.0);
    tribo_scene_body stone = world_body(1.0, x, y, z, mu, 0.0);
    double gain = 0.0, least = spin;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &floor);
    world_check(w, tribo_body_set_mass(&stone.state, 1.0, inertia));
    stone.shape = (tribo_shape){.type = TRIBO_SHAPE_ELLIPSOID, .size = {a, b, c}};
    stone.state.angular_velocity[1] = 0.01;
    stone.state.angular_velocity[2] = spin;
    const uint32_t id = world_add_at(w, &stone, 0.0, 0.0, c);
    const double start = world_energy(w) - WORLD_G * c;
    for (double before = start; w->time < w->seconds && w->status == TRIBO_OK;) {
        world_step(w);
        const double now = world_energy(w) - WORLD_G * c;
        gain = fmax(gain, now - before);
        before = now;
        if (fabs(world_state(w, id).angular_velocity[2] - spin) > fabs(least - spin))
            least = world_state(w, id).angular_velocity[2];
    }
    answer->metric = least;
    answer->error = (least * spin < 0.0) == (spin > 0.0) ? gain / start : 1.0;
}

/* ---- B14: free rotation ------------------------------------------------------------------------ */

/* Angular velocity in the body's axes after the run; energy and angular momentum to rounding. */
static void spin_freely(world *w, const double start[3], double omega[3], double *drift)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    tribo_scene_body box = world_box(1.0, 0.1, 0.2, 0.3, 0.0, 0.0);
    tribo_totals before = {0}, after = {0};

    world_begin(w, 0.0, 0.0, 0.0);
    memcpy(box.state.angular_velocity, start, 3 * sizeof *start);
    const uint32_t id = world_add(w, &box);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_totals(w->scene, origin, &before, NULL));
    world_run(w, w->seconds);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_totals(w->scene, origin, &after, NULL));
    const tribo_body end = world_state(w, id);
    tribo_quat_rotate_inverse(end.orientation, end.angular_velocity, omega);
    *drift =
        fmax(fabs(after.energy / before.energy - 1.0),
             scene_distance(after.angular, before.angular, 3) / tribo_vec3_norm(before.angular));
}

static void run_flip(world *w, scene_answer *answer)
{
    static const double start[3] = {1.0, 2.0, 3.0};
    static const double exact[3] = {0.280861940815, -2.432266939713, 2.750101480034};
    double omega[3], drift;

    spin_freely(w, start, omega, &drift);
    note(w, "energy or angular momentum off by, of it", drift);
    answer->metric = omega[1];
    answer->exact = exact[1];
    answer->error = scene_distance(omega, exact, 3);
}

/* After whole periods it is where it was. */
static void run_period(world *w, scene_answer *answer)
{
    const double *start = w->given;
    double omega[3], drift;

    spin_freely(w, start, omega, &drift);
    note(w, "energy or angular momentum off by, of it", drift);
    answer->metric = omega[1];
    answer->exact = start[1];
    answer->error = scene_distance(omega, start, 3);
}

static void run_invariants(world *w, scene_answer *answer)
{
    static const double start[3] = {1.0, 2.0, 3.0};
    double omega[3];

    spin_freely(w, start, omega, &answer->metric);
    answer->exact = 0.0;
}

/* ---- B15: heavy top ----------------------------------------------------------------------------
 * Its tip is a ball between six planes without friction, which hold the centre of the ball where it
 * is and let it turn: a fixed point. Moments of inertia are about that point. */

static const double TOP_MASS = 0.1, TOP_LENGTH = 0.05, TOP_ACROSS = 4e-4, TOP_ALONG = 1e-4;

static uint32_t begin_top(world *w, double lean, double spin, double precession)
{
    const double radius = 0.005;
    const double across = TOP_ACROSS - TOP_MASS * TOP_LENGTH * TOP_LENGTH;
    tribo_scene_body top = world_body(TOP_MASS, across, across, TOP_ALONG, 0.0, 0.0);
    double axis[3];

    world_begin(w, 0.0, 0.0, -WORLD_G);
    for (int i = 0; i < 6; i++) {
        tribo_scene_body plane = world_floor(0.0, 0.0);
        plane.shape.size[2] = 0.0;
        plane.shape.size[i / 2] = i % 2 == 0 ? 1.0 : -1.0;
        plane.shape.size[3] = -radius;
        world_add(w, &plane);
    }
    top.shape = (tribo_shape){.type = TRIBO_SHAPE_SPHERE, .size = {radius}};
    top.offset.position[2] = -TOP_LENGTH;
    world_tilt(&top, lean);
    axis_of(&top.state, axis);
    tribo_vec3_scale(spin - precession * cos(lean), axis, top.state.angular_velocity);
    top.state.angular_velocity[2] += precession;
    tribo_vec3_scale(TOP_LENGTH, axis, top.state.position);
    tribo_vec3_cross(top.state.angular_velocity, top.state.position, top.state.velocity);
    return world_add(w, &top);
}

/* I3 w3 W - I1 W^2 cos(lean) = m g l, the slow or the fast one. */
static void run_precession(world *w, scene_answer *answer)
{
    const double sign = *(const double *)w->given, lean = 0.5, spin = 200.0;
    const double a = TOP_ACROSS * cos(lean), b = TOP_ALONG * spin;
    const double c = TOP_MASS * WORLD_G * TOP_LENGTH;
    const double exact = (b + sign * sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    const uint32_t id = begin_top(w, lean, spin, exact);
    double angle = 0.0, last = 0.0, off = 0.0;

    for (uint64_t left = world_steps(w, w->seconds); left > 0 && w->status == TRIBO_OK; left--) {
        double axis[3];
        world_step(w);
        const tribo_body state = world_state(w, id);
        axis_of(&state, axis);
        const double now = atan2(axis[1], axis[0]);
        angle += remainder(now - last, 2.0 * PI);
        last = now;
        off = fmax(off, fabs(lean_of(&state) - lean));
    }
    note(w, "lean off by at most, rad", off);
    answer->metric = angle / w->time;
    answer->exact = exact;
    answer->error = fabs(answer->metric / exact - 1.0);
}

/* A top that sleeps too slowly for that wakes: leaning grows as exp(rate t), rate = sqrt(4 m g l I1 -
 * I3^2 w3^2) / 2 I1. */
static void run_sleeping_top(world *w, scene_answer *answer)
{
    const double spin = 80.0;
    const double across = 2.0 * TOP_ACROSS, along = TOP_ALONG * spin;
    const double weight = TOP_MASS * WORLD_G * TOP_LENGTH;
    const uint32_t id = begin_top(w, 1e-7, spin, 0.0);

    world_run(w, 0.5 * w->seconds);
    const double then = w->time;
    const tribo_body half = world_state(w, id);
    world_run(w, 0.5 * w->seconds);
    const tribo_body end = world_state(w, id);
    answer->metric = log(lean_of(&end) / lean_of(&half)) / (w->time - then);
    answer->exact = sqrt(2.0 * weight * across - along * along) / across;
    answer->error = fabs(answer->metric / answer->exact - 1.0);
}

/* ---- table ------------------------------------------------------------------------------------- */

#define GIVEN(x)    \
    &(const double) \
    {               \
        x           \
    }
#define DISC(digits, angle, time)                                                                \
    {                                                                                            \
        .name = "b11-disc-" digits, .what = "Euler's disc, rolling at a tilt of " #angle " rad", \
        .metric = "power lost, W", .given = GIVEN(angle), .dt = 1e-4, .seconds = time,           \
        .test_seconds = 1.0, .tolerance = 2.1 * WORLD_G * WORLD_G, .scale = SCENE_PER_DT,        \
        .run = run_disc, .reason = "first order: at most 2 m g^2 h cos^2(tilt)"                  \
    }
#define TIPPE(digits, ratio, most)                                                                 \
    {                                                                                              \
        .name = "b12-tippe-" digits,                                                               \
        .what = "a tippe top, moments in the ratio of " #ratio ", 150 rad/s, mu 0.3",              \
        .metric = "Jellett's number, J s m; error: greatest change, relative",                     \
        .given = GIVEN(ratio), .dt = 1e-4, .seconds = 8.0, .test_seconds = 1.0, .tolerance = most, \
        .scale = SCENE_PER_DT, .run = run_tippe_top,                                               \
        .reason = "first order: contact acts half a gap from the surface"                          \
    }

static const scene_entry ENTRIES[] = {
    DISC("01", 0.1, 31.6),
    DISC("03", 0.3, 54.4),
    DISC("06", 0.6, 75.0),
    TIPPE("10", 1.0, 2.0),
    TIPPE("09", 0.9, 5e-3),
    TIPPE("08", 0.8, 5e-3),
    {.name = "b13-rattleback",
     .what = "a skew ellipsoid, spun at 5 rad/s against its sense",
     .metric =
         "spin when it has turned back most, rad/s; error: greatest rise of energy in a step, "
         "of that of the spin, or 1 if it does not turn back",
     .given = GIVEN(5.0),
     .dt = 1e-3,
     .seconds = 5.0,
     .tolerance = 5e-4,
     .run = run_rattleback,
     .reason = "(h F)^2 / 8m of energy for what is met in a step"},
    {.name = "b13-rattleback-along",
     .what = "the same, spun at 5 rad/s in its sense",
     .metric =
         "spin when it has turned back most, rad/s; error: greatest rise of energy in a step, "
         "of that of the spin, or 1 if it turns back",
     .given = GIVEN(-5.0),
     .dt = 1e-3,
     .seconds = 5.0,
     .tolerance = 5e-4,
     .run = run_rattleback,
     .reason = "(h F)^2 / 8m of energy for what is met in a step"},
    {.name = "b14-flip",
     .what = "a free box that starts at (1, 2, 3) rad/s",
     .metric = "its middle angular velocity after 5 s, rad/s; error: of all three",
     .dt = 1e-2,
     .seconds = 5.0,
     .tolerance = 1e-11,
     .run = run_flip,
     .reason = "to the digits of the reference"},
    {.name = "b14-period",
     .what = "the same over ten periods",
     .metric = "its middle angular velocity, rad/s; error: of all three",
     .given = (const double[3]){1.0, 2.0, 3.0},
     .dt = 0.03671847302652,
     .seconds = 36.71847302652,
     .tolerance = 1e-9,
     .run = run_period,
     .reason = "to the digits of the period"},
    {.name = "b14-dzhanibekov",
     .what = "a free box about its middle axis, 5 rad/s, over a period",
     .metric = "its middle angular velocity, rad/s; error: of all three",
     .given = (const double[3]){0.05, 5.0, 0.05},
     .dt = 0.0102203046143,
     .seconds = 10.2203046143,
     .tolerance = 1e-7,
     .run = run_period,
     .reason = "to the digits of the period, which the unstable axis makes 1e3 times as many"},
    {.name = "b14-invariants",
     .what = "a free box for 100 s",
     .metric = "change of energy or angular momentum, relative",
     .dt = 1e-2,
     .seconds = 100.0,
     .tolerance = 1e-12,
     .run = run_invariants,
     .reason = "to rounding, at any step"},
    {.name = "b15-top-slow",
     .what = "a top about a fixed point, 200 rad/s, leaning by 0.5 rad, the slow precession",
     .metric = "rate of precession, rad/s; error: relative",
     .given = GIVEN(-1.0),
     .dt = 2.5e-4,
     .seconds = 2.0,
     .tolerance = 4.0,
     .scale = SCENE_PER_DT,
     .run = run_precession,
     .reason = "first order: the lean changes by 28 rad/s^2 h"},
    {.name = "b15-top-fast",
     .what = "the same, the fast precession",
     .metric = "rate of precession, rad/s; error: relative",
     .given = GIVEN(1.0),
     .dt = 2.5e-4,
     .seconds = 0.5,
     .tolerance = 40.0,
     .scale = SCENE_PER_DT,
     .run = run_precession,
     .reason = "first order"},
    {.name = "b15-top-sleeping",
     .what = "an upright top at 80 rad/s, too slow to sleep (88.59 rad/s)",
     .metric = "rate at which leaning grows, 1/s; error: relative",
     .dt = 2.5e-4,
     .seconds = 2.0,
     .tolerance = 200.0,
     .scale = SCENE_PER_DT,
     .run = run_sleeping_top,
     .reason = "first order"},
};

const scene_group scenes_spin = {"bodies that spin", sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
