/* Contacts that slide, spin and roll. */
#include "scene.h"

#include <math.h>

#define PI 3.14159265358979323846

/* ---- B1: over an incline --------------------------------------------------------------------- */

typedef struct launch {
    double slope, mu; /* of the incline, radians; friction */
    double v0, phi0;  /* speed, and angle from downhill */
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

static slide_state run_slide(world *w, const launch *l)
{
    tribo_scene_body floor = world_floor(l->mu, 0.0);
    tribo_scene_body body = world_ball(1.0, 0.5, l->mu, 0.0);

    world_begin(w, WORLD_G * sin(l->slope), 0.0, -WORLD_G * cos(l->slope));
    for (int i = 0; i < 6; i++)
        body.state.inverse_inertia[i] = 0.0; /* a point mass, in effect */
    body.state.velocity[0] = l->v0 * cos(l->phi0);
    body.state.velocity[1] = l->v0 * sin(l->phi0);
    world_add(w, &floor);
    const uint32_t id = world_add_at(w, &body, 0.0, 0.0, 0.5);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    const slide_state out = {{end.position[0], end.position[1]},
                             {end.velocity[0], end.velocity[1]}};
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
    const launch l = {PI / 6.0, 0.4, 3.0, 2.0 * PI / 3.0};

    answer_slide(w, &l, answer);
}

static void run_incline_critical(world *w, scene_answer *answer)
{
    const double slope = 25.0 * PI / 180.0;
    const launch l = {slope, tan(slope), 2.0, 0.5 * PI};

    answer_slide(w, &l, answer);
}

/* ---- B2: slide to roll ----------------------------------------------------------------------- */

static void run_roll(world *w, scene_answer *answer)
{
    const double v0 = 7.0;
    const tribo_scene_body floor = world_floor(0.2, 0.0);
    tribo_scene_body ball = world_ball(1.0, 0.5, 0.2, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    ball.state.velocity[0] = v0;
    world_add(w, &floor);
    const uint32_t id = world_add_at(w, &ball, 0.0, 0.0, 0.5);
    world_run(w, w->seconds);
    answer->metric = world_state(w, id).velocity[0];
    answer->exact = 5.0 / 7.0 * v0;
}

/* ---- table ----------------------------------------------------------------------------------- */

static const scene_entry ENTRIES[] = {
    {.name = "b1-incline",
     .what = "a point mass launched over an incline of 30 degrees, mu 0.4, 120 degrees from "
             "downhill",
     .metric = "speed, m/s; error: of the velocity",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 1.6,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while the direction turns",
     .run = run_incline},
    {.name = "b1-incline-critical",
     .what = "the same at mu = tan(25 degrees), launched across: half of the speed stays",
     .metric = "speed, m/s; error: of the velocity",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 1.6,
     .scale = SCENE_PER_DT,
     .reason = "first order in the step while the direction turns",
     .run = run_incline_critical},
    {.name = "b2-roll",
     .what = "a ball thrown without spin slides until it rolls, mu 0.2, 7 m/s",
     .metric = "speed at the end, m/s: 5/7 of that at the start",
     .dt = 1e-2,
     .seconds = 2.0,
     .tolerance = 32.0 * 5.0,
     .scale = SCENE_PER_STEP,
     .reason = "angular momentum about the line of contact is kept at any step",
     .run = run_roll},
};

const scene_group scenes_slide = {"contacts that slide, spin and roll",
                                  sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
