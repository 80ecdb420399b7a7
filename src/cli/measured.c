#include "measured.h"

#include <stdio.h>
#include <stdlib.h>

#include "cli.h"
#include "problem.h"
#include "toss.h"

enum { PATH_AT_MOST = 4096 };

/* Those of the collection that have one contact. */
static const char *const PROBLEMS[] = {"FrictionContact3D_1c", "FrictionContact3D_RR_1c",
                                       "Rover11035",           "Rover11211",
                                       "GFC3D_Example0",       "GFC3D_Example0_SBM",
                                       "GFC3D_Example00",      "GFC3D_Example00_badly_scaled",
                                       "GFC3D_Example1",       "GFC3D_OneContact"};

static int make_path(char path[PATH_AT_MOST], const char *data, const char *folder,
                     const char *name, const char *extension)
{
    const int length = snprintf(path, PATH_AT_MOST, "%s/%s/%s%s", data, folder, name, extension);

    if (length < 0 || length >= PATH_AT_MOST)
        return cli_error(CLI_BAD_INPUT, "TRIBO_DATA: the path is too long");
    return 0;
}

static int run_tosses(const char *data)
{
    toss_options options = toss_defaults();
    const uint32_t preferred = options.law;
    char path[PATH_AT_MOST];
    int exit_status = make_path(path, data, "cube_tosses", "tosses", ".csv");

    printf("\nMeasured tosses of a cube, predicted from the first state of each (mu %g, e %g)\n\n"
           "  law              tosses   position error   rotation error   time per step\n"
           "                                    widths          degrees              us\n",
           options.pair.mu_s, options.pair.e);
    for (options.law = 0; options.law < CLI_LAWS && exit_status == 0; options.law++) {
        toss_result result;
        exit_status = toss_predict(path, &options, &result);
        if (exit_status == 0)
            printf("  %-15s  %6lu  %15.3f  %15.2f  %14.2f%s\n", cli_law_names[options.law],
                   result.tosses, result.position_error, result.rotation_error,
                   result.seconds * 1e6 / (double)result.steps,
                   options.law == preferred ? "  *" : "");
    }
    if (exit_status == 0)
        puts("  * the law that tribo toss takes by default");
    return exit_status;
}

static int run_problem(const char *data, const char *name)
{
    char path[PATH_AT_MOST];
    problem given;
    problem_solution solution;
    int exit_status = make_path(path, data, "fc", name, ".dat");

    if (exit_status == 0)
        exit_status = problem_read(path, name[0] == 'G', &given);
    if (exit_status != 0)
        return exit_status;
    problem_solve(&given, &solution);
    if (solution.status != TRIBO_OK) {
        printf("  %-28s  %s\n", name, tribo_status_name(solution.status));
        return cli_error(CLI_BAD_INPUT, "%s: %s", path, tribo_status_string(solution.status));
    }
    printf("  %-28s  %-9s  %-5s  %11.4g %11.4g %11.4g  %9.1e\n", name,
           solution.general ? "general" : "symmetric", cli_mode_name(solution.mode), solution.p[0],
           solution.p[1], solution.p[2], solution.error);
    return 0;
}

int measured_run(const char *data)
{
    int exit_status = run_tosses(data);

    if (exit_status != 0)
        return exit_status;
    puts("\nRecorded problems of one contact, solved exactly; the error is the natural map over "
         "|q|\n\n"
         "  problem                       W          mode            pn          p1          p2    "
         "  error");
    for (size_t i = 0; i < sizeof PROBLEMS / sizeof PROBLEMS[0] && exit_status == 0; i++)
        exit_status = run_problem(data, PROBLEMS[i]);
    return exit_status;
}
