/* Contacts that slide, spin and roll. */
#include "scene.h"

#include <math.h>

#define PI 3.14159265358979323846

/* ---- B1: over an incline --------------------------------------------------------------------- */

typedef struct launch {
    double slope, mu; /* of the incline, radians; friction */
    double v0, phi0;  /* speed, and angle from downhill */
    double azimuth;   /* of downhill from x */
} launch;

/* Motion in the plane of the incline, x downhill. */
typedef struct slide_state {
    double x[2], v[2];
} slide_state;

/* Integral of t^n from a to b. */
static double integral(double n, double a, double b)
{
    const double m = n + 1.0;

    return m == 0.0 ? log(b / a) : (pow(b, m) - pow(a, m)) / m;
}

/* The path at u = tan(phi / 2), which falls from u0 to 0: v = a u^(k-1) (1 + u^2), k = mu / tan
 * slope, d phi / dt = -g sin(slope) sin(phi) / v. Returns the time. */
static double path_at(const launch *l, double u, slide_state *s)
{
    const double pull = WORLD_G * sin(l->slope);
    const double k = l->mu / tan(l->slope);
    const double u0 = tan(0.5 * l->phi0);
    const double a = l->v0 * pow(u0, 1.0 - k) / (1.0 + u0 * u0);
    const double b = a * a / pull;

    s->v[0] = a * pow(u, k - 1.0) * (1.0 - u * u);
    s->v[1] = 2.0 * a * pow(u, k);
    s->x[0] = b * (integral(2.0 * k - 3.0, u, u0) - integral(2.0 * k + 1.0, u, u0));
    s->x[1] = 2.0 * b * (integral(2.0 * k - 2.0, u, u0) + integral(2.0 * k, u, u0));
    return a / pull * (integral(k - 2.0, u, u0) + integral(k, u, u0));
}

/* The exact state at a time, for mu and slope at which the motion does not end before. */
static slide_state exact_slide(const launch *l, double time)
{
    slide_state s;
    double low = log(1e-100), high = log(tan(0.5 * l->phi0));

    for (int i = 0; i < 200; i++) {
        const double middle = 0.5 * (low + high);
        if (path_at(l, exp(middle), &s) > time)
            low = middle;
        else
            high = middle;
    }
    path_at(l, exp(high), &s);
    return s;
}

/* The state in the axes of the slope. */
static slide_state run_slide(world *w, const launch *l)
{
    const double c = cos(l->azimuth), d = sin(l->azimuth);
    const double pull = WORLD_G * sin(l->slope);
    const tribo_scene_body ground = world_floor(l->mu, 0.0);
    tribo_scene_body body = world_ball(1.0, 0.5, l->mu, 0.0);

    world_begin(w, pull * c, pull * d, -WORLD_G * cos(l->slope));
    for (int i = 0; i < 6; i++)
        body.state.inverse_inertia[i] = 0.0; /* a point mass, in effect */
    body.state.velocity[0] = l->v0 * cos(l->phi0 + l->azimuth);
    body.state.velocity[1] = l->v0 * sin(l->phi0 + l->azimuth);
    world_add(w, &ground);
    const uint32_t id = world_add_at(w, &body, 0.0, 0.0, 0.5);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    const double *x = end.position, *v = end.velocity;
    const slide_state out = {{c * x[0] + d * x[1], c * x[1] - d * x[0]},
                             {c * v[0] + d * v[1], c * v[1] - d * v[0]}};
    return out;
}

static void answer_slide(world *w, const launch *l, scene_answer *answer)
{
    const slide_state end = run_slide(w, l);
    const slide_state exact = exact_slide(l, w->time);

    answer->metric = hypot(end.v[0], end.v[1]);
    answer->exact = hypot(exact.v[0], exact.v[1]);
    answer->error = hypot(end.v[0] - exact.v[0], end.v[1] - exact.v[1]);
}

static void run_incline(world *w, scene_answer *answer)
{
    const launch l = {PI / 6.0, 0.4, 3.0, 2.0 * PI / 3.0, 0.0};

    answer_slide(w, &l, answer);
}

static void run_incline_critical(world *w, scene_answer *answer)
{
    const double slope = 25.0 * PI / 180.0;
    const launch l = {slope, tan(slope), 2.0, 0.5 * PI, 0.0};

    answer_slide(w, &l, answer);
}

/* The way does not depend on how the axes lie: 91 of them. */
static void run_incline_turned(world *w, scene_answer *answer)
{
    launch l = {PI / 6.0, 0.4, 3.0, 2.0 * PI / 3.0, 0.0};
    const slide_state straight = run_slide(w, &l);

    answer->metric = 0.0;
    for (int degrees = 1; degrees <= 90; degrees++) {
        l.azimuth = degrees * PI / 180.0;
        const slide_state turned = run_slide(w, &l);
        answer->metric = fmax(answer->metric, scene_distance(turned.v, straight.v, 2));
        answer->metric = fmax(answer->metric, scene_distance(turned.x, straight.x, 2));
    }
    answer->exact = 0.0;
}

static void run_incline_way(world *w, scene_answer *answer)
{
    const launch l = {PI / 6.0, 0.4, 3.0, 2.0 * PI / 3.0, 0.0};
    const slide_state end = run_slide(w, &l);
    const slide_state exact = exact_slide(&l, w->time);

    answer->metric = end.x[1];
    answer->exact = exact.x[1];
    answer->error = hypot(end.x[0] - exact.x[0], end.x[1] - exact.x[1]);
}

/* ---- B2: slide to roll ----------------------------------------------------------------------- */

static const double ROLL_RADIUS = 0.5, ROLL_MU = 0.2, ROLL_SPEED = 7.0;

static tribo_body run_ball(world *w, double spin)
{
    const tribo_scene_body ground = world_floor(ROLL_MU, 0.0);
    tribo_scene_body ball = world_ball(1.0, ROLL_RADIUS, ROLL_MU, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    ball.state.velocity[0] = ROLL_SPEED;
    ball.state.angular_velocity[1] = spin;
    world_add(w, &ground);
    const uint32_t id = world_add_at(w, &ball, 0.0, 0.0, ROLL_RADIUS);
    world_run(w, w->seconds);
    return world_state(w, id);
}

static void run_roll(world *w, scene_answer *answer)
{
    answer->metric = run_ball(w, 0.0).velocity[0];
    answer->exact = 5.0 / 7.0 * ROLL_SPEED;
}

/* 12 v0^2 / (49 mu g) until it rolls, from then on at 5/7 v0. */
static void run_roll_way(world *w, scene_answer *answer)
{
    const double braking = ROLL_MU * WORLD_G;
    const double rolls_from = 2.0 * ROLL_SPEED / (7.0 * braking);

    answer->metric = run_ball(w, 0.0).position[0];
    answer->exact = 12.0 * ROLL_SPEED * ROLL_SPEED / (49.0 * braking) +
                    5.0 / 7.0 * ROLL_SPEED * (w->time - rolls_from);
}

static void run_roll_back(world *w, scene_answer *answer)
{
    const double spin = -8.0;

    answer->metric = run_ball(w, spin).velocity[0];
    answer->exact = (5.0 * ROLL_SPEED + 2.0 * ROLL_RADIUS * spin) / 7.0;
}

/* ---- B3: slide and spin ---------------------------------------------------------------------- */

static const double PUCK_RADIUS = 0.1, PUCK_MU = 0.3, PUCK_SPEED = 1.0, PUCK_SPIN = 20.0;

enum { MOST_FEET = 300 };

/* A disc of mass 1 that stands on small balls around its centre of mass, which is in the plane of
 * contact: places (x, y). */
static tribo_body run_puck(world *w, int count, double places[][2])
{
    static tribo_child feet[MOST_FEET];
    const double i = PUCK_RADIUS * PUCK_RADIUS;
    const tribo_scene_body ground = world_floor(PUCK_MU, 0.0);
    tribo_scene_body puck = world_body(1.0, 0.25 * i, 0.25 * i, 0.5 * i, PUCK_MU, 0.0);

    for (int k = 0; k < count; k++)
        feet[k] = (tribo_child){{.type = TRIBO_SHAPE_SPHERE, .size = {1e-3}},
                                {{places[k][0], places[k][1], 1e-3}, {1.0, 0.0, 0.0, 0.0}}};
    puck.shape.type = TRIBO_SHAPE_COMPOUND;
    puck.shape.count = (uint32_t)count;
    puck.shape.data = feet;
    puck.state.velocity[0] = PUCK_SPEED;
    puck.state.angular_velocity[2] = PUCK_SPIN;
    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &ground);
    const uint32_t id = world_add(w, &puck);
    world_run(w, w->seconds);
    return world_state(w, id);
}

static void place_tripod(double places[3][2])
{
    for (int k = 0; k < 3; k++) {
        const double angle = 0.2 + 2.0 * PI / 3.0 * k;
        places[k][0] = PUCK_RADIUS * cos(angle);
        places[k][1] = PUCK_RADIUS * sin(angle);
    }
}

/* x, y, angle and their rates of a tripod, whose feet bear equal loads. */
static void tripod_rates(double places[3][2], const double s[6], double rates[6])
{
    const double load = PUCK_MU * WORLD_G / 3.0;
    double moment = 0.0;

    for (int i = 0; i < 3; i++) {
        rates[i] = s[3 + i];
        rates[3 + i] = 0.0;
    }
    for (int k = 0; k < 3; k++) {
        const double c = cos(s[2]), d = sin(s[2]);
        const double arm[2] = {c * places[k][0] - d * places[k][1],
                               d * places[k][0] + c * places[k][1]};
        const double v[2] = {s[3] - s[5] * arm[1], s[4] + s[5] * arm[0]};
        const double speed = hypot(v[0], v[1]);
        for (int i = 0; i < 2; i++)
            rates[3 + i] -= load * v[i] / speed;
        moment -= load * (arm[0] * v[1] - arm[1] * v[0]) / speed;
    }
    rates[5] = moment / (0.5 * PUCK_RADIUS * PUCK_RADIUS);
}

/* By the classical Runge-Kutta rule, before the tripod stops. */
static void exact_tripod(double places[3][2], double time, double s[6])
{
    static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const int steps = 4096;
    const double h = time / steps;
    const double start[6] = {0.0, 0.0, 0.0, PUCK_SPEED, 0.0, PUCK_SPIN};

    for (int i = 0; i < 6; i++)
        s[i] = start[i];
    for (int step = 0; step < steps; step++) {
        double k[6] = {0.0}, sum[6] = {0.0};
        for (int stage = 0; stage < 4; stage++) {
            double at[6];
            for (int i = 0; i < 6; i++)
                at[i] = s[i] + share[stage] * h * k[i];
            tripod_rates(places, at, k);
            for (int i = 0; i < 6; i++)
                sum[i] += weight[stage] * k[i];
        }
        for (int i = 0; i < 6; i++)
            s[i] += h / 6.0 * sum[i];
    }
}

static void run_tripod(world *w, scene_answer *answer)
{
    double places[3][2], s[6];

    place_tripod(places);
    const tribo_body end = run_puck(w, 3, places);
    exact_tripod(places, w->time, s);
    answer->metric = end.angular_velocity[2];
    answer->exact = s[5];
    answer->error = fmax(fabs(answer->metric - answer->exact) * PUCK_RADIUS,
                         scene_distance(end.velocity, s + 3, 2));
}

/* Where it stops, by the same equation in quadruple precision. */
static void run_tripod_stop(world *w, scene_answer *answer)
{
    static const double exact[2] = {0.334270043, 0.004602731};
    double places[3][2];

    place_tripod(places);
    const tribo_body end = run_puck(w, 3, places);
    answer->metric = end.position[0];
    answer->exact = exact[0];
    answer->error = scene_distance(end.position, exact, 2);
}

/* Feet that bear equal areas, on rings: 3 (2 j + 1) on the ring of the area between j and j + 1 of
 * so many parts of the radius, at the radius that has the same moment of area. */
static int place_disc(int rings, double places[][2])
{
    int count = 0;

    for (int j = 0; j < rings; j++) {
        const int feet = 3 * (2 * j + 1);
        const double radius = PUCK_RADIUS * sqrt(0.5 * (j * j + (j + 1) * (j + 1))) / rings;
        for (int k = 0; k < feet; k++, count++) {
            const double angle = 0.1 * j + 2.0 * PI * k / feet;
            places[count][0] = radius * cos(angle);
            places[count][1] = radius * sin(angle);
        }
    }
    return count;
}

/* Exact: uniform pressure, by Farkas, Bartels, Unger and Wolf, Phys. Rev. Lett. 90 (2003) 248302,
 * integrated. More than three feet bear loads that rigid bodies leave open; Newton's, the least in
 * the mean square, are equal here. */
static void answer_disc(world *w, int rings, scene_answer *answer)
{
    double places[MOST_FEET][2];

    const int count = place_disc(rings, places);
    const tribo_body end = run_puck(w, count, places);
    answer->metric = end.position[0];
    answer->exact = 0.334182093;
}

static void run_disc_12(world *w, scene_answer *answer)
{
    answer_disc(w, 2, answer);
}

static void run_disc_108(world *w, scene_answer *answer)
{
    answer_disc(w, 6, answer);
}

/* ---- B4: rolling and spinning resistance ----------------------------------------------------- */

static const double RESIST_RADIUS = 0.5, RESIST_LENGTH = 0.02, RESIST_SPEED = 1.0;

/* A ball that rolls without slip, or spins on the spot, until resistance stops it. */
static tribo_body run_resisted(world *w, double speed, double spin)
{
    const tribo_scene_body ground = world_floor(0.5, 0.0);
    tribo_scene_body ball = world_ball(1.0, RESIST_RADIUS, 0.5, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    ball.rolling = RESIST_LENGTH;
    ball.spinning = RESIST_LENGTH;
    ball.state.velocity[0] = speed;
    ball.state.angular_velocity[1] = speed / RESIST_RADIUS;
    ball.state.angular_velocity[2] = spin;
    world_add(w, &ground);
    const uint32_t id = world_add_at(w, &ball, 0.0, 0.0, RESIST_RADIUS);
    world_run(w, w->seconds);
    return world_state(w, id);
}

/* 5/7 delta g / R. */
static double rolling_deceleration(void)
{
    return 5.0 / 7.0 * RESIST_LENGTH * WORLD_G / RESIST_RADIUS;
}

static void run_rolling(world *w, scene_answer *answer)
{
    answer->metric = run_resisted(w, RESIST_SPEED, 0.0).velocity[0];
    answer->exact = fmax(RESIST_SPEED - rolling_deceleration() * w->time, 0.0);
}

static void run_rolling_way(world *w, scene_answer *answer)
{
    const tribo_body end = run_resisted(w, RESIST_SPEED, 0.0);

    answer->metric = end.position[0];
    answer->exact = 0.5 * RESIST_SPEED * RESIST_SPEED / rolling_deceleration();
    answer->error = fmax(fabs(answer->metric - answer->exact), fabs(end.velocity[0]));
}

/* 5/2 delta g / R^2. */
static void run_spinning(world *w, scene_answer *answer)
{
    const double spin = 3.0;
    const double braking = 2.5 * RESIST_LENGTH * WORLD_G / (RESIST_RADIUS * RESIST_RADIUS);

    answer->metric = run_resisted(w, 0.0, spin).angular_velocity[2];
    answer->exact = fmax(spin - braking * w->time, 0.0);
}

/* Down a slope a ball rolls without slip if mu >= 2/7 tan: a thousandth above and below. */
static void run_rolling_limit(world *w, scene_answer *answer)
{
    const double slope = 0.5, limit = 2.0 / 7.0 * tan(slope);

    answer->error = 0.0;
    for (int k = 0; k < 2; k++) {
        const double mu = limit * (k == 0 ? 0.999 : 1.001);
        const double slides = sin(slope) - mu * cos(slope), rolls = 5.0 / 7.0 * sin(slope);
        const tribo_scene_body ground = world_floor(mu, 0.0);
        const tribo_scene_body ball = world_ball(1.0, 0.5, mu, 0.0);
        world_begin(w, WORLD_G * sin(slope), 0.0, -WORLD_G * cos(slope));
        world_add(w, &ground);
        const uint32_t id = world_add_at(w, &ball, 0.0, 0.0, 0.5);
        world_run(w, w->seconds);
        answer->metric = world_state(w, id).velocity[0];
        answer->exact = WORLD_G * w->time * fmax(slides, rolls);
        answer->error = fmax(answer->error, fabs(answer->metric - answer->exact));
    }
}

/* ---- B5: on a turntable ---------------------------------------------------------------------- */

/* A ball that rolls on a table of angular velocity Omega goes round at 2/7 of it, wherever it is.
 */
static void run_turntable(world *w, scene_answer *answer)
{
    const double table = 2.0, rate = 2.0 / 7.0 * table, r = 0.5, v0 = 0.5, x0 = 1.0;
    tribo_scene_body plate = world_floor(2.0, 0.0);
    tribo_scene_body ball = world_ball(1.0, r, 2.0, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    plate.kind = TRIBO_BODY_KINEMATIC;
    plate.state.angular_velocity[2] = table;
    ball.state.velocity[1] = v0;
    ball.state.angular_velocity[0] = (table * x0 - v0) / r; /* no slip */
    world_add(w, &plate);
    const uint32_t id = world_add_at(w, &ball, x0, 0.0, r);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    const double turned = rate * w->time, orbit = v0 / rate;
    const double exact[2] = {x0 - orbit + orbit * cos(turned), orbit * sin(turned)};
    answer->metric = scene_distance(end.position, exact, 2);
    answer->exact = 0.0;
}

/* ---- B6: Painleve's rod ---------------------------------------------------------------------- */

/* A slender rod of length 2 and mass 1 whose lower tip touches the floor in front of it; tan of its
 * slope 2: W = ((8/5, 6/5), (6/5, 17/5)) at the tip. Beyond mu = 4/3 there are states in which no
 * force lets it slide on. */
static tribo_scene_body painleve_rod(double mu)
{
    const double angle = atan(2.0), tip = 1e-9;
    const double turn[3] = {0.0, angle - 0.5 * PI, 0.0};
    tribo_scene_body rod = world_body(1.0, 1.0 / 3.0, 1.0 / 3.0, 1e-3, mu, 0.0);

    rod.shape.type = TRIBO_SHAPE_CAPSULE;
    rod.shape.size[0] = tip;
    rod.shape.size[1] = 1.0;
    tribo_quat_from_rotation_vector(turn, rod.state.orientation);
    rod.state.position[2] = sin(angle) + tip;
    return rod;
}

static double greatest_normal_impulse(world *w)
{
    tribo_scene_event event = {0};
    size_t count = 0;

    world_check(w, tribo_scene_events(w->scene, 1, &event, &count));
    return count > 0 ? event.normal : 0.0;
}

/* It slides into such a state and is caught at once, without a collision: W p = (g h, -v), and p_n
 * goes to 0.3 v as the step h gets small. */
static void run_painleve(world *w, scene_answer *answer)
{
    const double v0 = 3.0;
    const tribo_scene_body ground = world_floor(1.4, 0.0);
    tribo_scene_body rod = painleve_rod(1.4);
    const double fall = WORLD_G * world_substep(w);
    double gain = 0.0;

    world_begin(w, 0.0, 0.0, -WORLD_G);
    rod.state.velocity[0] = v0;
    world_before(w, &rod);
    world_add(w, &ground);
    world_add(w, &rod);
    double energy = world_energy(w);
    answer->metric = 0.0;
    for (uint64_t k = world_steps(w, w->seconds); k > 0 && w->status == TRIBO_OK; k--) {
        world_step(w);
        const double now = world_energy(w);
        gain = fmax(gain, now - energy);
        energy = now;
        answer->metric = fmax(answer->metric, greatest_normal_impulse(w));
    }
    answer->exact = 0.3 * v0 + 0.85 * fall;
    answer->error = fmax(fabs(answer->metric - answer->exact), gain - fall * fall / 8.0);
}

/* It separates, though sticking and sliding were answers as well: nothing happens. */
static void run_painleve_open(world *w, scene_answer *answer)
{
    const tribo_scene_body ground = world_floor(2.0, 0.0);
    tribo_scene_body rod = painleve_rod(2.0);

    world_begin(w, 0.0, 0.0, 0.0);
    rod.state.velocity[0] = 1.0;
    rod.state.velocity[2] = 0.1;
    world_before(w, &rod);
    world_add(w, &ground);
    const uint32_t id = world_add(w, &rod);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    answer->metric = scene_distance(end.velocity, rod.state.velocity, 3);
    answer->exact = 0.0;
}

/* ---- table ----------------------------------------------------------------------------------- */

static const scene_entry ENTRIES[] = {
    {.name = "b1-incline",
     .what =
         "a point mass launched over an incline of 30 degrees, mu 0.4, 120 degrees from downhill",
     .metric = "speed, m/s; error: of the velocity",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 1.6,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while the direction turns",
     .run = run_incline},
    {.name = "b1-incline-way",
     .what = "the same",
     .metric = "way across, m; error: of the place",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 1.24,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while the direction turns",
     .run = run_incline_way},
    {.name = "b1-incline-turned",
     .what = "the same with downhill at 0, 1 ... 90 degrees from an axis",
     .metric = "greatest difference to that at 0, m/s or m",
     .dt = 1e-2,
     .seconds = 1.0,
     .tolerance = 1e3,
     .scale = SCENE_PER_EPS,
     .reason = "rounding: the cone is round",
     .run = run_incline_turned},
    {.name = "b1-incline-critical",
     .what =
         "the same at mu = tan(25 degrees), launched across: in the end half of the speed is left",
     .metric = "speed, m/s; error: of the velocity",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 1.6,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while the direction turns",
     .run = run_incline_critical},
    {.name = "b2-roll",
     .what = "a ball thrown without spin, mu 0.2, 7 m/s, slides until it rolls",
     .metric = "speed, m/s: 5/7 of that at the start",
     .dt = 1e-2,
     .seconds = 2.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "rounding: angular momentum about the line of contact is kept at any step",
     .run = run_roll},
    {.name = "b2-roll-back",
     .what = "the same with 8 rad/s of backspin",
     .metric = "speed, m/s",
     .dt = 1e-2,
     .seconds = 2.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "the same",
     .run = run_roll_back},
    {.name = "b2-roll-way",
     .what = "a ball thrown without spin",
     .metric = "way, m",
     .dt = 1e-2,
     .seconds = 2.0,
     .tolerance = 1.1,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step",
     .run = run_roll_way},
    {.name = "b3-disc-12",
     .what = "a disc on 12 feet that bear equal areas slides and spins, mu 0.3",
     .metric = "way until it stops, m, of a disc under uniform pressure",
     .dt = 1e-3,
     .seconds = 0.8,
     .tolerance = 0.07 / 12.0,
     .solver = TRIBO_SOLVER_NEWTON,
     .reason = "the error falls with the number of feet: 0.07 / N",
     .run = run_disc_12},
    {.name = "b3-disc-108",
     .what = "the same on 108 feet",
     .metric = "way until it stops, m, of a disc under uniform pressure",
     .dt = 1e-3,
     .seconds = 0.8,
     .tolerance = 0.11 / 108.0,
     .solver = TRIBO_SOLVER_NEWTON,
     .reason = "the error falls with the number of feet: 0.1 / N",
     .run = run_disc_108},
    {.name = "b3-tripod",
     .what = "a disc on three feet slides and spins, mu 0.3",
     .metric = "angular velocity at the end, rad/s; error: of v and omega R, m/s",
     .dt = 1e-3,
     .seconds = 0.2,
     .tolerance = 0.3,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while directions turn",
     .run = run_tripod},
    {.name = "b3-tripod-stop",
     .what = "the same until it stops: slide and spin end at once",
     .metric = "way, m; error: of the place",
     .dt = 1e-3,
     .seconds = 0.8,
     .tolerance = 0.5,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step",
     .run = run_tripod_stop},
    {.name = "b4-rolling",
     .what = "a ball of 0.5 m rolls at 1 m/s, rolling resistance of 0.02 m",
     .metric = "speed, m/s",
     .dt = 1e-2,
     .seconds = 1.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "rounding: the deceleration is 5/7 delta g / R at any step",
     .run = run_rolling},
    {.name = "b4-rolling-way",
     .what = "the same until it stops, and does not roll back",
     .metric = "way, m; error: of it, or the speed that is left, m/s",
     .dt = 1e-2,
     .seconds = 5.0,
     .tolerance = 3.6e-6,
     .reason = "a h^2 / 8: it stops within a step",
     .run = run_rolling_way},
    {.name = "b4-spinning",
     .what = "a ball of 0.5 m spins at 3 rad/s, spinning resistance of 0.02 m",
     .metric = "angular velocity, rad/s",
     .dt = 1e-2,
     .seconds = 1.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "rounding: the deceleration is 5/2 delta g / R^2 at any step",
     .run = run_spinning},
    {.name = "b4-spinning-stop",
     .what = "the same until it stops",
     .metric = "angular velocity, rad/s",
     .dt = 1e-2,
     .seconds = 3.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "rounding: it stops within a step and does not turn back",
     .run = run_spinning},
    {.name = "b4-limit",
     .what =
         "a ball on a slope of 0.5, mu a thousandth above and below 2/7 tan: it rolls, or slips",
     .metric = "speed of the ball that rolls, m/s; error: of both",
     .dt = 1e-2,
     .seconds = 1.0,
     .tolerance = 32.0,
     .scale = SCENE_PER_STEP,
     .reason = "rounding: both accelerations are constant",
     .run = run_rolling_limit},
    {.name = "b5-turntable",
     .what = "a ball rolls on a table that turns at 2 rad/s",
     .metric = "distance from its orbit at 4/7 rad/s, m",
     .dt = 1e-3,
     .seconds = 10.995574287564276,
     .tolerance = 1.7,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step: 1.58 dt measured",
     .run = run_turntable},
    {.name = "b6-painleve",
     .what = "a rod at mu 1.4 slides into a state where no force lets it slide on",
     .metric = "greatest normal impulse of a step, N s; error: of it, or energy gained beyond (h "
               "F)^2 / 8 m, J",
     .dt = 1e-4,
     .seconds = 0.5,
     .tolerance = 1e-8,
     .reason = "the tip is a ball of 1e-9 m, the solver's tolerance 1e-12",
     .run = run_painleve},
    {.name = "b6-painleve-open",
     .what = "a rod at mu 2 separates, where sticking and sliding would be answers as well",
     .metric = "change of velocity, m/s",
     .dt = 1e-2,
     .seconds = 1e-2,
     .tolerance = 0.0,
     .reason = "an open contact has no impulse, to the bit",
     .run = run_painleve_open},
};

const scene_group scenes_slide = {"contacts that slide, spin and roll",
                                  sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
