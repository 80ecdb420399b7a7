/* Published figures of other engines beside what the scenes of SimBenchmark give here. */
#include "simbench.h"

#include <math.h>

#include "scene.h"

/* From the tables of SimBenchmark: error and real-time factor (simulated time over processor time,
 * on a Core i7-7700HQ at 2.8 GHz), without parameters that trade error for drift. NaN: none. */
enum { MOST_STEPS = 5 };

static const double LONGEST = 0.1; /* s, of the steps */

typedef struct published {
    const char *engine;
    double error[MOST_STEPS], factor[MOST_STEPS];
} published;

/* A test: its scene, the steps of the columns. */
typedef struct simbench_test {
    const char *title, *scene;
    int steps, engines;
    double dt[MOST_STEPS];
    const published *figures;
} simbench_test;

static const published ROLLING_60[] = {
    {"RAI", {4.13711e-07}, {13.0}},
    {"Bullet", {5.70654e-09}, {7.1}},
    {"Bullet, 400 iterations", {3.85e-27}, {2.2}},
    {"ODE, QuickStep", {3.14497}, {5.5}},
    {"MuJoCo, CG, RK4", {0.00244841}, {1.0}},
    {"MuJoCo, Newton, Euler", {0.00692691}, {2.4}},
    {"DART, Dantzig", {3.14497}, {1.5}},
};

static const published ROLLING_Y[] = {
    {"RAI", {4.1268e-07}, {12.4}},
    {"Bullet", {4.93482e-09}, {7.3}},
    {"Bullet, 400 iterations", {7.28e-28}, {2.1}},
    {"ODE, QuickStep", {7.66873e-09}, {5.6}},
    {"MuJoCo, CG, RK4", {0.00236152}, {1.3}},
    {"MuJoCo, Newton, Euler", {0.0092196}, {2.9}},
    {"DART, Dantzig", {0.42589}, {1.5}},
};

static const published BOUNCING[] = {
    {"ODE, QuickStep", {0.0185, 1.85, 185.0, 1.88e4, 2.03e6}, {0.1, 1.0, 10.6, 105.7, 947.2}},
    {"DART, Dantzig", {7.39, 483.0, 7.23e4, 7.38e6, 7.67e8}, {0.1, 0.6, 6.2, 59.0, 527.8}},
    {"Bullet", {7.52, 752.0, 7.52e4, 7.41e6, 7.68e8}, {0.2, 2.4, 23.5, 195.4, 1247.0}},
    {"RAI", {1.86e-10, 1.86e-6, 0.0186, 186.0, 1.83e6}, {0.8, 8.5, 85.1, 792.1, 7522.1}},
};

static const published HEAP[] = {
    {"ODE, StandardStep", {1.55e-6, 1.55e-4, 0.0161, 4.42}, {0.1, 0.9, 7.4, 1.8}},
    {"ODE, QuickStep", {1.59e-6, 1.57e-4, 0.0162, 3.06}, {0.1, 1.0, 10.0, 82.3}},
    {"MuJoCo, PGS, Euler", {0.0113, 0.095, 0.934, 11.0}, {0.1, 0.8, 5.8, 8.2}},
    {"Bullet", {0.00353, 0.382, 37.4, 2.78e5}, {0.1, 0.8, 5.0, 10.9}},
    {"RAI", {1.64e-6, 1.35e-4, 0.0153, 0.962}, {0.8, 6.6, 59.5, 272.1}},
    {"DART, Dantzig", {1.98e-7, 2.82e-4, 215.0, 6.84}, {0.1, 0.4, 3.3, 3.6}},
};

static const published ELASTIC[] = {
    {"Bullet", {168.0, 4.15e4, 9.86e6, 1.72e9}, {0.5, 4.3, 31.3, 66.5}},
    {"ODE, StandardStep", {1.1, 112.0, 8.56e6, 2.1e7}, {0.2, 1.8, 17.2, 104.1}},
    {"ODE, QuickStep", {1.1, 112.0, 8.56e6, 1.88e7}, {0.2, 1.8, 16.6, 153.2}},
    {"RAI", {0.0011, 8.37, 5.18e6, 1.19e8}, {1.6, 15.3, 142.3, 785.2}},
    {"DART, Dantzig", {2.44e3, 3.47e5, 1.29e10, 1.21e12}, {0.1, 1.2, 11.9, 81.5}},
};

#define FIGURES(list) .engines = sizeof(list) / sizeof(list)[0], .figures = (list)

static const simbench_test TESTS[] = {
    {"Rolling at 60 degrees: mean squared error of velocity, (m/s)^2", "d1-rolling-60", .steps = 1,
     .dt = {1e-3}, FIGURES(ROLLING_60)},
    {"Rolling along y: mean squared error of velocity, (m/s)^2", "d1-rolling-y", .steps = 1,
     .dt = {1e-3}, FIGURES(ROLLING_Y)},
    {"Bouncing: mean squared error of energy, J^2", "d2-bouncing", .steps = 5,
     .dt = {1e-5, 1e-4, 1e-3, 1e-2, 0.1}, FIGURES(BOUNCING)},
    {"666: mean sum of squared overlaps, m^2", "d3-666", .steps = 4, .dt = {1e-4, 1e-3, 1e-2, 0.1},
     FIGURES(HEAP)},
    {"Elastic 666: mean squared error of energy, J^2", "d3-666-elastic", .steps = 4,
     .dt = {1e-4, 1e-3, 1e-2, 0.1}, FIGURES(ELASTIC)},
};

static void print_cell(double error, double factor)
{
    if (isnan(error))
        printf("  %18s", "-");
    else
        printf("  %9.3g /%6.4gx", error, factor);
}

/* The scene at its steps, of several none below the least. */
static tribo_status print_own(const simbench_test *t, const char *title, double least,
                              const tribo_step_options *options)
{
    tribo_status status = TRIBO_OK;

    printf("  %-24s", title);
    for (int i = 0; i < t->steps && status == TRIBO_OK; i++) {
        scene_answer answer = {(double)NAN, (double)NAN, (double)NAN};
        world w = scene_world(scene_find(t->scene));
        w.dt = t->dt[i];
        w.options.solver = options->solver;
        w.options.tolerance = options->tolerance;
        if (w.dt >= least || (t->steps == 1 && least <= LONGEST))
            status = scene_play(scene_find(t->scene), &w, &answer);
        print_cell(answer.metric, w.seconds / w.spent);
        fflush(stdout);
    }
    putchar('\n');
    return status;
}

static tribo_status print_test(const simbench_test *t, double least,
                               const tribo_step_options *options)
{
    const tribo_step_options coarse = {.solver = options->solver, .tolerance = 1e-6};

    printf("\n%s\n  %-24s", t->title, "step");
    for (int i = 0; i < t->steps; i++)
        printf("  %16g s", t->dt[i]);
    putchar('\n');
    for (int k = 0; k < t->engines; k++) {
        printf("  %-24s", t->figures[k].engine);
        for (int i = 0; i < t->steps; i++)
            print_cell(t->figures[k].error[i], t->figures[k].factor[i]);
        putchar('\n');
    }
    const tribo_status status = print_own(t, "tribo", least, options);
    return status == TRIBO_OK ? print_own(t, "tribo, tolerance 1e-6", least, &coarse) : status;
}

tribo_status simbench_run(double least, const tribo_step_options *options)
{
    tribo_status status = TRIBO_OK;

    puts(
        "SimBenchmark, without drift correction by parameters: error / real-time factor.\n"
        "Of other engines as published, on a Core i7-7700HQ at 2.8 GHz; of tribo on this machine.");
    for (size_t i = 0; i < sizeof TESTS / sizeof TESTS[0] && status == TRIBO_OK; i++)
        status = print_test(&TESTS[i], least, options);
    return status;
}
