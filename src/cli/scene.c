#include "scene.h"

#include <errno.h>
#include <float.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "simbench.h"

static const char USAGE[] =
    "usage: tribo scene list\n"
    "       tribo scene simbench [OPTION...]\n"
    "       tribo scene NAME [OPTION...]\n"
    "\n"
    "Run a scene whose outcome is known, and say how far it is from the exact one. The last line "
    "is\n"
    "\n"
    "  scene NAME metric M exact E error X us_per_step T\n"
    "\n"
    "  M  what the scene measures, in SI units, E what that should be, X how far the motion is "
    "from\n"
    "     the exact one (`list` says how, where it is not |M - E|); - where there is none\n"
    "  T  microseconds of processor time that a step takes, in the mean\n"
    "\n"
    "  --dt S       step, s\n"
    "  --substeps N parts of a step\n"
    "  --solver S   auto, gauss-seidel or newton\n"
    "  --tol T      tolerance of the solver, on eta\n"
    "  --seconds S  time to run, s\n"
    "  --csv OUT    write the motion of all bodies to OUT, a row for each body and step\n"
    "\n"
    "`simbench` runs the tests of SimBenchmark at its steps, from --dt (0.01) on, and prints them "
    "beside\n"
    "its published figures. `list` prints each scene with its own step, time and the greatest "
    "error of a right run.\n";

static const char CSV_HEADER[] = "time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n";

const scene_group *const scene_groups[SCENE_GROUPS] = {
    &scenes_impact, &scenes_slide, &scenes_limit, &scenes_rest,
    &scenes_stack,  &scenes_spin,  &scenes_units, &scenes_simbench,
};

/* ---- running --------------------------------------------------------------------------------- */

const scene_entry *scene_find(const char *name)
{
    for (size_t group = 0; group < SCENE_GROUPS; group++) {
        for (size_t i = 0; i < scene_groups[group]->count; i++) {
            const scene_entry *entry = &scene_groups[group]->entries[i];
            if (strcmp(entry->name, name) == 0)
                return entry;
        }
    }
    return NULL;
}

world scene_world(const scene_entry *entry)
{
    const world w = {.dt = entry->dt,
                     .seconds = entry->seconds,
                     .options = {.struct_size = sizeof w.options,
                                 .substeps = entry->substeps,
                                 .solver = entry->solver,
                                 .tolerance = entry->solver_tolerance},
                     .given = entry->given,
                     .restitution = 1.0};

    return w;
}

tribo_status scene_play(const scene_entry *entry, world *w, scene_answer *answer)
{
    *answer = (scene_answer){(double)NAN, (double)NAN, (double)NAN};
    entry->run(w, answer);
    world_end(w);
    if (isnan(answer->error))
        answer->error = fabs(answer->metric - answer->exact);
    return w->status;
}

double scene_tolerance(const scene_entry *entry, const world *w)
{
    switch (entry->scale) {
    case SCENE_PER_DT:
        return entry->tolerance * w->dt;
    case SCENE_PER_EPS:
        return entry->tolerance * DBL_EPSILON;
    case SCENE_PER_STEP:
        return entry->tolerance * DBL_EPSILON * (double)world_steps(w, w->seconds);
    default:
        return entry->tolerance;
    }
}

double scene_distance(const double *a, const double *b, size_t n)
{
    double greatest = 0.0;

    for (size_t i = 0; i < n; i++) {
        const double distance = fabs(a[i] - b[i]);
        greatest = distance <= greatest ? greatest : distance; /* NaN stays */
    }
    return greatest;
}

/* ---- the command ----------------------------------------------------------------------------- */

static void print_entry(const scene_entry *e)
{
    static const char *const scales[] = {"", " dt", " eps", " eps steps"};

    printf("  %s\n      %s\n      metric: %s\n      step %g s", e->name, e->what, e->metric, e->dt);
    if (e->substeps > 1)
        printf(" in %u parts", (unsigned)e->substeps);
    printf(", %g s; error <= %g%s: %s\n", e->seconds, e->tolerance, scales[e->scale], e->reason);
}

static void print_list(void)
{
    for (size_t group = 0; group < SCENE_GROUPS; group++) {
        printf("%s%s\n", group > 0 ? "\n" : "", scene_groups[group]->title);
        for (size_t i = 0; i < scene_groups[group]->count; i++)
            print_entry(&scene_groups[group]->entries[i]);
    }
}

static void print_number(const char *what, double number)
{
    if (isnan(number))
        printf(" %s -", what);
    else
        printf(" %s %.17g", what, number);
}

static int print_answer(const scene_entry *entry, const world *w, const scene_answer *answer)
{
    printf("%llu steps: %llu impacts, %llu sweeps, %llu Newton steps; solver stopped by %s\n",
           (unsigned long long)w->steps, (unsigned long long)w->impacts,
           (unsigned long long)w->sweeps, (unsigned long long)w->newton, cli_stop_name(w->stop));
    printf("scene %s", entry->name);
    print_number("metric", answer->metric);
    print_number("exact", answer->exact);
    print_number("error", answer->error);
    printf(" us_per_step %.4g\n", w->steps > 0 ? 1e6 * w->spent / (double)w->steps : 0.0);
    return 0;
}

static int run_scene(const scene_entry *entry, world *w, const char *csv)
{
    scene_answer answer;
    int exit_status = 0;

    w->notes = stdout;
    if (csv != NULL) {
        w->csv = fopen(csv, "w");
        if (w->csv == NULL)
            return cli_error(CLI_BAD_INPUT, "%s: %s", csv, strerror(errno));
        fputs(CSV_HEADER, w->csv);
    }
    const tribo_status status = scene_play(entry, w, &answer);
    if (status != TRIBO_OK)
        exit_status = cli_error(CLI_BAD_INPUT, "scene %s: %s: %s", entry->name,
                                tribo_status_name(status), tribo_status_string(status));
    else
        exit_status = print_answer(entry, w, &answer);
    if (w->csv != NULL) {
        const int failed = ferror(w->csv) != 0;
        if ((fclose(w->csv) != 0 || failed) && exit_status == 0)
            exit_status = cli_error(CLI_BAD_INPUT, "%s: %s", csv, strerror(errno));
    }
    return exit_status;
}

static int compare(const world *asked)
{
    const tribo_step_options by = {
        .solver = asked->options.solver < CLI_SOLVERS ? asked->options.solver : TRIBO_SOLVER_AUTO,
        .tolerance = asked->options.tolerance};
    const tribo_status status = simbench_run(asked->dt > 0.0 ? asked->dt : 0.01, &by);

    return status == TRIBO_OK ? EXIT_SUCCESS
                              : cli_error(CLI_BAD_INPUT, "scene simbench: %s: %s",
                                          tribo_status_name(status), tribo_status_string(status));
}

/* -1 after a message; 1 if help was asked for. */
static int take_option(int option, world *w, const char **csv)
{
    switch (option) {
    case 'd':
        return cli_positive("--dt", optarg, &w->dt);
    case 'n':
        return cli_count("--substeps", optarg, 1, &w->options.substeps);
    case 's':
        return cli_solver_find(optarg, &w->options.solver);
    case 't':
        return cli_positive("--tol", optarg, &w->options.tolerance);
    case 'S':
        return cli_positive("--seconds", optarg, &w->seconds);
    case 'c':
        *csv = optarg;
        return 0;
    case 'h':
        fputs(USAGE, stdout);
        return 1;
    default:
        return -1;
    }
}

/* Which scene; null after a message. */
static const scene_entry *take_name(int argc, char **argv)
{
    if (optind != argc - 1) {
        cli_error(CLI_USAGE, "scene: the name of one scene is needed; see tribo scene --help");
        return NULL;
    }
    const scene_entry *entry = scene_find(argv[optind]);
    if (entry == NULL)
        cli_error(CLI_USAGE, "there is no scene \"%s\"; see tribo scene list", argv[optind]);
    return entry;
}

int cli_scene(int argc, char **argv)
{
    static const struct option options[] = {
        {"dt", required_argument, NULL, 'd'},      {"substeps", required_argument, NULL, 'n'},
        {"solver", required_argument, NULL, 's'},  {"tol", required_argument, NULL, 't'},
        {"seconds", required_argument, NULL, 'S'}, {"csv", required_argument, NULL, 'c'},
        {"help", no_argument, NULL, 'h'},          {NULL, 0, NULL, 0}};
    world asked = {.options.solver = CLI_SOLVERS}; /* none */
    const char *csv = NULL;
    int option;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        const int taken = take_option(option, &asked, &csv);
        if (taken != 0)
            return taken > 0 ? EXIT_SUCCESS : CLI_USAGE;
    }
    if (optind == argc - 1 && strcmp(argv[optind], "list") == 0) {
        print_list();
        return EXIT_SUCCESS;
    }
    if (optind == argc - 1 && strcmp(argv[optind], "simbench") == 0)
        return compare(&asked);
    const scene_entry *entry = take_name(argc, argv);
    if (entry == NULL)
        return CLI_USAGE;
    world w = scene_world(entry);
    w.dt = asked.dt > 0.0 ? asked.dt : w.dt;
    w.seconds = asked.seconds > 0.0 ? asked.seconds : w.seconds;
    w.options.substeps = asked.options.substeps > 0 ? asked.options.substeps : w.options.substeps;
    w.options.solver = asked.options.solver < CLI_SOLVERS ? asked.options.solver : w.options.solver;
    w.options.tolerance =
        asked.options.tolerance > 0.0 ? asked.options.tolerance : w.options.tolerance;
    return run_scene(entry, &w, csv);
}
