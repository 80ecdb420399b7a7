/* Many bodies that stay at rest, unequal masses, rows that fall, surfaces that carry. */
#include "scene.h"

#include <math.h>

#define DEGREES (3.14159265358979323846 / 180.0)

/* ---- what is measured -------------------------------------------------------------------------- */

/* How far bodies that are at rest go, and turn, measured by `size`. */
static void watch_rest(world *w, double size, scene_answer *answer)
{
    world_keep(w);
    world_run(w, w->seconds);
    answer->metric = world_way(w, size);
    answer->exact = 0.0;
}

/* The greatest rise of energy from step to step, as a share of what there is at the start. */
static double run_and_watch_energy(world *w)
{
    const uint64_t steps = world_steps(w, w->seconds);
    const double start = world_energy(w);
    double before = start, gain = 0.0;

    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++) {
        world_step(w);
        const double now = world_energy(w);
        gain = fmax(gain, now - before);
        before = now;
    }
    return gain / fabs(start);
}

static void begin_on_floor(world *w, double mu)
{
    const tribo_scene_body floor = world_floor(mu, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &floor);
}

/* ---- no creep ---------------------------------------------------------------------------------- */

/* mu = tan(slope) (1 + beyond) */
static void run_creep(world *w, scene_answer *answer)
{
    const double slope = 30.0 * DEGREES, beyond = *(const double *)w->given;
    const double mu = tan(slope) * (1.0 + beyond);
    const tribo_scene_body plane = world_plane(sin(slope), cos(slope), 0.0, mu);
    tribo_scene_body box = world_box(1.0, 0.5, 0.5, 0.5, mu, 0.0);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &plane);
    world_tilt(&box, slope);
    world_add_at(w, &box, 0.5 * sin(slope), 0.0, 0.5 * cos(slope));
    watch_rest(w, 1.0, answer);
}

/* ---- card house -------------------------------------------------------------------------------- */

/* Cards of 0.4 x 0.3 x 0.002 m that lean by 25 degrees; flat ones from apex to apex. */
static void run_card_house(world *w, scene_answer *answer)
{
    const double thick = 0.001, half = 0.2, depth = 0.15, mu = 0.7;
    const double c = cos(25.0 * DEGREES), s = sin(25.0 * DEGREES);
    const double out = half * s + thick * c; /* from the middle of a card to the apex, along x */
    const double up = half * c + thick * s;  /* to its lowest and its highest edge, along z */
    const double pitch = 4.0 * out + thick;
    const tribo_scene_body flat = world_box(0.01, 0.5 * pitch - 0.0005, depth, thick, mu, 0.0);
    double z = 0.0;

    begin_on_floor(w, mu);
    for (int storey = 0; storey < 5; storey++) {
        for (int i = 0; i < 5 - storey; i++) {
            const double x = (i + 0.5 * storey) * pitch;
            for (int side = -1; side <= 1; side += 2) {
                tribo_scene_body card = world_box(0.01, thick, depth, half, mu, 0.0);
                world_tilt(&card, -side * 25.0 * DEGREES);
                world_add_at(w, &card, x + side * out, 0.0, z + up);
            }
            if (i < 4 - storey)
                world_add_at(w, &flat, x + 0.5 * pitch, 0.0, z + 2.0 * up + thick);
        }
        z += 2.0 * (up + thick);
    }
    watch_rest(w, half, answer);
}

/* ---- unequal masses, towers and walls ---------------------------------------------------------- */

typedef struct tower {
    int boxes;
    double ratio;  /* mass of the uppermost to that of the others */
    double origin; /* m: all three coordinates of where it stands */
} tower;

static void build_tower(world *w, const tower *t)
{
    const double x = t->origin;
    const tribo_scene_body ground = world_block(4.0, 4.0, 0.5, 0.5);

    world_begin(w, 0.0, 0.0, -WORLD_G);
    tribo_scene_body placed = ground;
    placed.state.position[1] = x;
    placed.state.position[0] = x;
    placed.state.position[2] = x - 0.5;
    world_add(w, &placed);
    for (int i = 0; i < t->boxes; i++) {
        const double mass = i + 1 == t->boxes ? t->ratio : 1.0;
        placed = world_box(mass, 0.5, 0.5, 0.5, 0.5, 0.0);
        placed.state.position[0] = placed.state.position[1] = x;
        placed.state.position[2] = x + i + 0.5;
        world_add(w, &placed);
    }
}

static void run_tower(world *w, scene_answer *answer)
{
    build_tower(w, w->given);
    watch_rest(w, 1.0, answer);
}

/* The heavy box is taken away: kinetic energy of what is left, as a share of what it weighs. */
static void run_removal(world *w, scene_answer *answer)
{
    const tower *t = w->given;
    double greatest = 0.0;

    build_tower(w, t);
    world_run(w, 0.5 * w->seconds);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_remove(w->scene, (uint32_t)t->boxes));
    const double rest = world_energy(w);
    for (double end = w->time + 0.5 * w->seconds; w->time < end && w->status == TRIBO_OK;) {
        world_step(w);
        greatest = fmax(greatest, fabs(world_energy(w) - rest));
    }
    answer->metric = greatest / fabs(rest);
    answer->exact = 0.0;
}

typedef struct heap {
    double ratio; /* mass of the uppermost to that of the others */
    double drop;  /* m that it falls first */
} heap;

/* A pyramid of 10 rows of cubes. */
static void build_pyramid(world *w, const heap *h)
{
    enum { ROWS = 10 };

    begin_on_floor(w, 0.6);
    for (int row = 0; row < ROWS; row++) {
        for (int i = 0; i < ROWS - row; i++) {
            const int last = row == ROWS - 1;
            const tribo_scene_body box = world_box(last ? h->ratio : 1.0, 0.5, 0.5, 0.5, 0.6, 0.0);
            world_add_at(w, &box, i + 0.5 * row, 0.0, row + 0.5 + (last ? h->drop : 0.0));
        }
    }
}

/* A plate of 20 m on two cubes of 1 m near its ends. */
static void build_table(world *w, const heap *h)
{
    const tribo_scene_body leg = world_box(1.0, 0.5, 0.5, 0.5, 0.6, 0.0);
    const tribo_scene_body plate = world_box(h->ratio, 10.0, 0.5, 10.0, 0.6, 0.0);

    begin_on_floor(w, 0.6);
    world_add_at(w, &leg, -9.0, 0.0, 0.5);
    world_add_at(w, &leg, 9.0, 0.0, 0.5);
    world_add_at(w, &plate, 0.0, 0.0, 11.0 + h->drop);
}

static void run_pyramid(world *w, scene_answer *answer)
{
    build_pyramid(w, w->given);
    watch_rest(w, 1.0, answer);
}

static void run_table(world *w, scene_answer *answer)
{
    build_table(w, w->given);
    watch_rest(w, 1.0, answer);
}

/* What falls first: energy must not grow. */
static void run_drop(world *w, scene_answer *answer)
{
    answer->error = run_and_watch_energy(w);
    answer->metric = world_energy(w);
}

static void run_pyramid_drop(world *w, scene_answer *answer)
{
    build_pyramid(w, w->given);
    run_drop(w, answer);
}

static void run_table_drop(world *w, scene_answer *answer)
{
    build_table(w, w->given);
    run_drop(w, answer);
}

/* 91 bricks in 14 rows of 6 and 7, each over the joints of the row below. */
static void run_wall(world *w, scene_answer *answer)
{
    enum { ROWS = 14, COLUMNS = 6 };

    begin_on_floor(w, 0.5);
    for (int row = 0; row < ROWS; row++) {
        for (int i = 0; i < COLUMNS + row % 2; i++) {
            const double left = fmax(2.0 * i - row % 2, 0.0);
            const double right = fmin(2.0 * i + 2.0 - row % 2, 2.0 * COLUMNS);
            const double half = 0.5 * (right - left);
            const tribo_scene_body brick = world_box(half, half, 0.5, 0.5, 0.5, 0.0);
            world_add_at(w, &brick, 0.5 * (left + right), 0.0, row + 0.5);
        }
    }
    watch_rest(w, 1.0, answer);
}

/* ---- dominoes ---------------------------------------------------------------------------------- */

enum { DOMINOES = 20 };

static double lean_of(world *w, uint32_t id)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    const tribo_body state = world_state(w, id);
    double axis[3];

    tribo_quat_rotate(state.orientation, up, axis);
    return atan2(hypot(axis[0], axis[1]), axis[2]);
}

/* A row of dominoes, 0.1 x 0.5 x 1 m, half a metre apart; the first starts beyond its edge. Each must
 * fall after the one before. The metric is the speed of the wave between the fifth and the last. */
static void run_dominoes(world *w, scene_answer *answer)
{
    const double x = 0.05, z = 0.5, start = 10.0 * DEGREES;
    double fallen[DOMINOES] = {0.0};
    double gain = 0.0;
    int count = 0, in_order = 1;

    begin_on_floor(w, 0.5);
    for (int i = 0; i < DOMINOES; i++) {
        tribo_scene_body domino = world_box(1.0, x, 0.25, z, 0.5, 0.0);
        const double lean = i == 0 ? start : 0.0;
        world_tilt(&domino, lean);
        world_add_at(w, &domino, 0.5 * i + z * sin(lean) - x * cos(lean), 0.0,
                     x * sin(lean) + z * cos(lean));
    }
    const double energy = world_energy(w);
    for (double before = energy;
         count < DOMINOES && w->time < w->seconds && w->status == TRIBO_OK;) {
        world_step(w);
        for (uint32_t i = 0; i < DOMINOES; i++) {
            if (fallen[i] > 0.0 || lean_of(w, i + 1) < 20.0 * DEGREES)
                continue;
            fallen[i] = w->time;
            in_order = in_order && (uint32_t)count == i;
            count++;
        }
        gain = fmax(gain, world_energy(w) - before);
        before = world_energy(w);
    }
    answer->metric = 0.5 * (DOMINOES - 5) / (fallen[DOMINOES - 1] - fallen[4]);
    answer->error = in_order && count == DOMINOES ? gain / energy : 1.0;
}

/* ---- surfaces that carry ----------------------------------------------------------------------- */

/* A box on a belt gains its speed in v / (mu g), on a straight line. */
static void run_conveyor(world *w, scene_answer *answer)
{
    const double v = 0.5, mu = 0.3, time = v / (mu * WORLD_G);
    const tribo_scene_body box = world_box(2.0, 0.5, 0.4, 0.1, mu, 0.0);
    tribo_scene_body belt = world_floor(mu, 0.0);

    belt.belt[0] = v;
    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &belt);
    const uint32_t id = world_add_at(w, &box, 0.0, 0.0, 0.1);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    const double exact[3] = {0.5 * v * time + v * (w->time - time), 0.0, 0.1};
    answer->metric = end.velocity[0];
    answer->exact = v;
    answer->error = fmax(fabs(end.velocity[0] - v), scene_distance(end.position, exact, 3));
}

/* A box on a table that turns at 1 rad/s turns with it. */
static void run_turntable(world *w, scene_answer *answer)
{
    const double mu = 0.5;
    const tribo_scene_body box = world_box(2.0, 0.1, 0.1, 0.05, mu, 0.0);
    tribo_scene_body table = world_floor(mu, 0.0);

    table.kind = TRIBO_BODY_KINEMATIC;
    table.state.angular_velocity[2] = 1.0;
    world_begin(w, 0.0, 0.0, -WORLD_G);
    world_add(w, &table);
    const uint32_t id = world_add_at(w, &box, 1.0, 0.0, 0.05);
    world_run(w, w->seconds);
    const tribo_body end = world_state(w, id);
    if (w->notes != NULL)
        fprintf(w->notes, "the box is %.6g m from the axis\n",
                hypot(end.position[0], end.position[1]));
    answer->metric = end.angular_velocity[2];
    answer->exact = 1.0;
}

/* ---- table ------------------------------------------------------------------------------------- */

#define TOWER(...)  \
    &(const tower)  \
    {               \
        __VA_ARGS__ \
    }
#define HEAP(...)   \
    &(const heap)   \
    {               \
        __VA_ARGS__ \
    }
#define SIXTIETHS .dt = 1.0 / 60.0, .seconds = 10.0, .test_seconds = 1.0
#define AT_REST .reason = "at rest: what the solver leaves in each step"
#define NO_GAIN \
    .reason = "energy does not grow but by (h F)^2 / 8m for what comes to rest in a step"

static const scene_entry ENTRIES[] = {
    {.name = "b7-creep",
     .what = "a cube on a slope of 30 degrees, friction 1e-6 above what it needs",
     .metric = "how far it goes, m",
     .given = &(const double){1e-6},
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 1e-9,
     .run = run_creep,
     .reason = "Coulomb's law: no creep"},
    {.name = "b7-creep-limit",
     .what = "a cube on a slope of 30 degrees, friction 1e-9 above what it needs",
     .metric = "how far it goes, m",
     .given = &(const double){1e-9},
     .dt = 1.0 / 60.0,
     .seconds = 10.0,
     .tolerance = 1e-9,
     .run = run_creep,
     .reason = "Coulomb's law: no creep"},
    {.name = "b9-card-house",
     .what = "a house of 5 storeys, 40 cards of 0.4 m and 2 mm, leaning by 25 degrees, mu 0.7",
     .metric = "how far a card goes, m",
     SIXTIETHS,
     .tolerance = 1e-9,
     .run = run_card_house,
     AT_REST},
    {.name = "b10-pyramid-300",
     .what = "a pyramid of 10 rows of cubes, the uppermost of 300 times the mass",
     .metric = "how far a cube goes, m",
     .given = HEAP(300.0, 0.0),
     SIXTIETHS,
     .tolerance = 1e-7,
     .run = run_pyramid,
     AT_REST},
    {.name = "b10-pyramid-300-drop",
     .what = "the same, the uppermost falling by 2 m first; by Gauss-Seidel",
     .metric = "energy at the end, J; error: its greatest rise in a step, of the whole",
     .given = HEAP(300.0, 2.0),
     .dt = 1.0 / 60.0,
     .seconds = 2.0,
     .test_seconds = 0.8,
     .tolerance = 1e-3,
     .solver = TRIBO_SOLVER_GAUSS_SEIDEL,
     .solver_tolerance = 1e-4,
     .run = run_pyramid_drop,
     .reason = "eta of 1e-4: Newton to 1e-12 takes a second for a step of the crash"},
    {.name = "b10-table-400",
     .what = "a plate of 20 m and 400 kg on two cubes of 1 m and 1 kg",
     .metric = "how far a body goes, m",
     .given = HEAP(400.0, 0.0),
     SIXTIETHS,
     .tolerance = 1e-8,
     .run = run_table,
     AT_REST},
    {.name = "b10-table-400-drop",
     .what = "the same, the plate falling by 16 m first",
     .metric = "energy at the end, J; error: its greatest rise in a step, of the whole",
     .given = HEAP(400.0, 16.0),
     .dt = 1.0 / 60.0,
     .seconds = 5.0,
     .tolerance = 1e-3,
     .run = run_table_drop,
     NO_GAIN},
    {.name = "b10-stack-1000",
     .what = "a box on one of a thousandth of its mass",
     .metric = "how far a box goes, m",
     .given = TOWER(2, 1e3, 0.0),
     SIXTIETHS,
     .tolerance = 1e-8,
     .run = run_tower,
     AT_REST},
    {.name = "b10-stack-1e6",
     .what = "a box on one of a millionth of its mass",
     .metric = "how far a box goes, m",
     .given = TOWER(2, 1e6, 0.0),
     SIXTIETHS,
     .tolerance = 1e-6,
     .run = run_tower,
     AT_REST},
    {.name = "b10-tower-1000",
     .what = "10 boxes, the uppermost of 1000 times the mass of the others",
     .metric = "how far a box goes, m",
     .given = TOWER(10, 1e3, 0.0),
     SIXTIETHS,
     .tolerance = 1e-7,
     .run = run_tower,
     AT_REST},
    {.name = "b10-tower-1e6",
     .what = "10 boxes, the uppermost of a million times the mass of the others",
     .metric = "how far a box goes, m",
     .given = TOWER(10, 1e6, 0.0),
     SIXTIETHS,
     .tolerance = 1e-5,
     .run = run_tower,
     AT_REST},
    {.name = "b10-tower-50",
     .what = "50 equal boxes",
     .metric = "how far a box goes, m",
     .given = TOWER(50, 1.0, 0.0),
     SIXTIETHS,
     .tolerance = 1e-8,
     .run = run_tower,
     AT_REST},
    {.name = "b10-wall-91",
     .what = "a wall of 91 bricks",
     .metric = "how far a brick goes, m",
     SIXTIETHS,
     .tolerance = 1e-8,
     .run = run_wall,
     AT_REST},
    {.name = "b10-far",
     .what = "10 equal boxes, 1e6 m from the origin along each axis",
     .metric = "how far a box goes, m",
     .given = TOWER(10, 1.0, 1e6),
     SIXTIETHS,
     .tolerance = 1e-9,
     .run = run_tower,
     .reason = "at rest; positions are kept to 1.2e-10 m there"},
    {.name = "b10-removal",
     .what = "5 boxes, the uppermost of 100 times the mass, which is taken away half way",
     .metric = "greatest change of the energy of those left, as a share of it",
     .given = TOWER(5, 100.0, 0.0),
     .dt = 1.0 / 60.0,
     .seconds = 4.0,
     .tolerance = 1e-10,
     .run = run_removal,
     .reason = "impulses kept for a warm start do nothing by themselves"},
    {.name = "b16-dominoes",
     .what = "20 dominoes in a row; the first starts beyond its edge",
     .metric =
         "speed of the wave, m/s; error: greatest rise of energy in a step, of the whole, or 1 "
         "if they do not fall in order",
     .dt = 2e-3,
     .seconds = 5.0,
     .tolerance = 1e-6,
     .solver_tolerance = 1e-6,
     .run = run_dominoes,
     NO_GAIN},
    {.name = "b17-conveyor",
     .what = "a box on a belt of 0.5 m/s, mu 0.3",
     .metric = "speed, m/s; error: of it, or of the place in m, whichever is more",
     .dt = 1e-3,
     .seconds = 1.0,
     .tolerance = 0.5,
     .scale = SCENE_PER_DT,
     .run = run_conveyor,
     .reason = "half a step of the belt's way"},
    {.name = "b17-turntable",
     .what = "a box at rest 1 m from the axis of a table that begins to turn at 1 rad/s, mu 0.5",
     .metric = "its angular velocity after 2 s, rad/s",
     .dt = 1e-3,
     .seconds = 2.0,
     .tolerance = 1e-9,
     .run = run_turntable,
     .reason = "it sticks"},
};

const scene_group scenes_rest = {"bodies that come to rest, or stay there",
                                 sizeof ENTRIES / sizeof ENTRIES[0], ENTRIES};
