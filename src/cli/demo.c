#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli.h"
#include "manifold.h"
#include "measured.h"
#include "plot.h"
#include "stack.h"
#include "survey.h"
#include "throw.h"

static const char USAGE[] =
    "usage: tribo demo [--out DIR]\n"
    "\n"
    "Show what each impact law keeps, breaks and costs: a box thrown with spin onto a floor, and "
    "the speed\n"
    "of the laws against their distance from Coulomb's law. Then contact manifolds: their speed "
    "against\n"
    "the error of their depth. Then many contacts, towers and a wall: the speed of the solvers "
    "against\n"
    "how far they are from the exact law.\n"
    "\n"
    "  --out DIR  folder for the pictures throw.svg, cone.svg, laws.svg, manifolds.svg and "
    "stack.svg,\n"
    "             made if need be (.); they are drawn by gnuplot, and left out if it is not "
    "installed\n"
    "\n"
    "If the environment variable TRIBO_DATA names a folder with cube_tosses/tosses.csv and "
    "fc/*.dat,\n"
    "fc/*.hdf5, the measured tosses are predicted and the recorded contact problems solved as "
    "well.\n";

/* ---- tables ---------------------------------------------------------------------------------- */

static void print_first_impacts(const throw_record *records)
{
    const tumble scene = throw_scene(TRIBO_LAW_ALGEBRAIC);
    const double *u = records->first.info.velocity_before;

    printf("A box of %g x %g x %g m, thrown with spin onto a floor: mu_s %g, mu_d %g, e %g.\n"
           "Its first impact, u = (%.3f, %.3f, %.3f) m/s, under each law\n\n"
           "  law              mode     p_n  |p_t|/p_n    u_n+    energy  momentum  ang.mom.      "
           "eta\n"
           "                            N s                m/s         %%  change    change\n",
           2.0 * scene.half[0], 2.0 * scene.half[1], 2.0 * scene.half[2], scene.pair.mu_s,
           scene.pair.mu_d, scene.pair.e, u[0], u[1], u[2]);
    for (int law = 0; law < CLI_LAWS; law++) {
        const throw_audit *audit = &records[law].first;
        const double *p = audit->info.impulse;
        const double tangent[3] = {p[1], p[2], 0.0};
        printf("  %-15s  %-5s  %5.3f  %9.4f  %6.3f  %+8.2f  %8.1e  %8.1e  %7.1e\n",
               cli_law_names[law], cli_mode_name(audit->info.mode), p[0],
               tribo_vec3_norm(tangent) / p[0], audit->info.velocity_after[0],
               100.0 * audit->change.energy, audit->change.linear, audit->change.angular,
               audit->measures.eta);
    }
}

/* What a throw broke, of cone, energy and Newton's restitution. */
static const char *broken(const throw_record *record)
{
    static const char *const names[] = {"nothing", "cone",    "energy",    "cone, energy",
                                        "e",       "cone, e", "energy, e", "cone, energy, e"};

    return names[(record->escapes > 0) + 2 * (record->gains > 0) + 4 * (record->rebounds > 0)];
}

static void print_throws(const throw_record *records)
{
    printf(
        "\nThe whole throw, %g s: what the impacts kept and broke, floor included\n\n"
        "  law              impacts   energy  gains  greatest  outside   excess  momentum  broken\n"
        "                             left/J                 J  of cone    / |p|    change\n",
        (double)THROW_FRAMES / THROW_FRAMES_PER_SECOND);
    for (int law = 0; law < CLI_LAWS; law++) {
        const throw_record *r = &records[law];
        const double momentum =
            r->greatest_linear > r->greatest_angular ? r->greatest_linear : r->greatest_angular;
        printf("  %-15s  %7lu  %7.3f  %5lu  %8.2g  %7lu  %7.2g  %8.1e  %s\n", cli_law_names[law],
               r->impacts, r->energy_after, r->gains, r->greatest_gain, r->escapes,
               r->greatest_escape, momentum, broken(r));
    }
    printf("  Energy is kinetic and potential, %.3f J at the start. e: Newton's restitution.\n",
           records->energy_before);
}

static void print_survey(const survey_result *results)
{
    printf(
        "\nSpeed against error: %d contacts at corners of random boxes, random mu and e\n\n"
        "  law              time per call   eta: median  greatest   outside   energy   Newton's\n"
        "                              ns                           of cone   gained   e broken\n",
        (int)SURVEY_CONTACTS);
    for (int law = 0; law < CLI_LAWS; law++) {
        const survey_result *r = &results[law];
        printf("  %-15s  %13.1f  %12.1e  %8.1e  %6.2f %%  %5.2f %%  %7.2f %%\n", cli_law_names[law],
               r->nanoseconds, r->median_eta, r->greatest_eta, 100.0 * r->escapes, 100.0 * r->gains,
               100.0 * r->rebounds);
    }
    puts("  eta: distance from Coulomb's law with Newton's restitution (0: exact). Poisson's and "
         "Stronge's\n"
         "  restitution is not Newton's where friction turns or stops the sliding.");
}

static void print_manifolds(const manifold_result *results)
{
    printf("\nSpeed against error of manifolds: %d pairs of random boxes that overlap by 1 %% of "
           "their size\n\n"
           "  pair               time per pair  error of depth:     wrong  points\n"
           "                                ns  median  greatest  normals\n",
           (int)MANIFOLD_PAIRS);
    for (int i = 0; i < MANIFOLD_METHODS; i++) {
        const manifold_result *r = &results[i];
        printf("  %-17s  %13.1f %7.1e  %8.1e %6.2f %%  %6.2f\n", r->name, r->nanoseconds,
               r->median_error, r->greatest_error, 100.0 * r->wrong, r->points);
    }
    puts("  wrong: the way out along the normal is longer than the least by 1 %, or the normal is "
         "not the\n"
         "  plane's. general: by support functions alone, as for hulls.");
}

/* The point of a curve as a row: sweeps at the left, or the tolerance on eta. */
static void print_stack(const stack_result *scene, int curve, int k)
{
    const tribo_system_info *info = &scene->points[curve][k].info;
    char error[16] = "-";

    if (curve == 0)
        printf("    %-12s %5llu", stack_names[curve], (unsigned long long)stack_sweeps[k]);
    else
        printf("    %-12s %5.0e", stack_names[curve], stack_tolerances[k]);
    if (scene->rests)
        snprintf(error, sizeof error, "%.1e", scene->points[curve][k].load_error);
    printf("  %10.1f  %6llu  %5llu  %8llu  %7.1e  %+11.4e  %10s\n", 1e6 * info->seconds,
           (unsigned long long)info->sweeps, (unsigned long long)info->steps,
           (unsigned long long)info->factorizations, info->eta, info->energy, error);
}

static void print_stacks(const stack_result *results)
{
    static const struct {
        int curve, point;
    } rows[] = {{0, 2}, {0, 4}, {0, 6}, {1, 5}, {2, 5}};

    puts("\nSpeed against error of many contacts: a step of 1/60 s from a cold start, mu 0.5\n\n"
         "                             time  sweeps  steps  matrices      eta       energy  error "
         "of\n"
         "    until                      us                  factored              change/J    the "
         "load");
    for (int i = 0; i < STACK_SCENES; i++) {
        printf("  %s, %zu contacts\n", results[i].title, results[i].contacts);
        for (size_t row = 0; row < sizeof rows / sizeof rows[0]; row++)
            print_stack(&results[i], rows[row].curve, rows[row].point);
    }
    puts("  until: so many sweeps, or eta (the greatest of a contact) below that. Load: of the "
         "ground, against\n"
         "  m g dt of all bodies. Sliding has more than one exact solution: solvers may end at "
         "different ones.");
}

/* ---- the command ----------------------------------------------------------------------------- */

static int draw(const char *folder, const throw_record *records, const survey_result *results,
                const manifold_scene *scenes, const stack_result *stacks)
{
    if (!plot_available()) {
        cli_error(0, "gnuplot is not installed: no pictures are drawn");
        return 0;
    }
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return cli_error(CLI_BAD_INPUT, "%s: %s", folder, strerror(errno));
    int exit_status = plot_throws(folder, "throw.svg", records);
    if (exit_status == 0)
        exit_status = plot_cone(folder, "cone.svg", records);
    if (exit_status == 0)
        exit_status = plot_survey(folder, "laws.svg", results);
    if (exit_status == 0)
        exit_status = plot_manifolds(folder, "manifolds.svg", scenes);
    if (exit_status == 0)
        exit_status = plot_stacks(folder, "stack.svg", stacks);
    if (exit_status == 0)
        printf("\nPictures: %s/throw.svg %s/cone.svg %s/laws.svg %s/manifolds.svg %s/stack.svg\n",
               folder, folder, folder, folder, folder);
    return exit_status;
}

static int run_demo(const char *folder)
{
    static throw_record records[CLI_LAWS];
    static survey_contacts contacts;
    survey_result results[CLI_LAWS];
    manifold_scene scenes[MANIFOLD_SCENES];
    manifold_result manifolds[MANIFOLD_METHODS];
    static stack_result stacks[STACK_SCENES];
    const char *data = getenv("TRIBO_DATA");

    tribo_status status = survey_make(&contacts);
    for (uint32_t law = 0; law < CLI_LAWS && status == TRIBO_OK; law++) {
        status = throw_box(law, &records[law]);
        if (status == TRIBO_OK)
            status = survey_law(law, &contacts, &results[law]);
    }
    if (status == TRIBO_OK)
        status = manifold_scenes(scenes);
    if (status == TRIBO_OK)
        status = manifold_survey(manifolds);
    if (status == TRIBO_OK)
        status = stack_survey(stacks);
    if (status != TRIBO_OK)
        return cli_error(CLI_BAD_INPUT, "demo: %s: %s", tribo_status_name(status),
                         tribo_status_string(status));
    print_first_impacts(records);
    print_throws(records);
    print_survey(results);
    print_manifolds(manifolds);
    print_stacks(stacks);
    int exit_status = draw(folder, records, results, scenes, stacks);
    if (exit_status == 0 && (data == NULL || data[0] == '\0'))
        puts(
            "\nTRIBO_DATA is not set: the measured tosses and the recorded problems are left out.");
    else if (exit_status == 0)
        exit_status = measured_run(data);
    if (exit_status == 0 && data != NULL && data[0] != '\0')
        exit_status = stack_recorded(data);
    return exit_status;
}

int cli_demo(int argc, char **argv)
{
    static const struct option options[] = {{"out", required_argument, NULL, 'o'},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    const char *folder = ".";
    int option;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        switch (option) {
        case 'o':
            folder = optarg;
            break;
        case 'h':
            fputs(USAGE, stdout);
            return EXIT_SUCCESS;
        default:
            return CLI_USAGE;
        }
    }
    if (optind != argc)
        return cli_error(CLI_USAGE, "demo: \"%s\" is too much; see tribo demo --help",
                         argv[optind]);
    signal(SIGPIPE, SIG_IGN); /* gnuplot may end early: that is reported by its exit status */
    return run_demo(folder);
}
