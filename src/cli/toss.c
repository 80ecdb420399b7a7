#include "toss.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli.h"

static const char USAGE[] =
    "usage: tribo toss FILE.csv [OPTION...]\n"
    "\n"
    "Predict measured tosses of a cube onto a board by a scene, from one state of each, and "
    "compare.\n"
    "FILE.csv (-: standard input) has one row per step of 1/148 s, with the columns, in any "
    "order:\n"
    "  toss,step    number of the toss; number of the step, one more in each row of a toss\n"
    "  qw,qx,qy,qz  orientation, body to world\n"
    "  px,py,pz     position of the centre, m; the board is z = 0\n"
    "  wx,wy,wz     angular velocity, body axes, rad/s\n"
    "  vx,vy,vz     velocity, world axes, m/s\n"
    "Written are, for each toss, the means over the steps after the one that prediction starts "
    "from of\n"
    "the distance between the measured and the predicted position, in widths of the cube (0.1048 "
    "m), and\n"
    "of the angle between the orientations, in degrees; then the means over the tosses and the "
    "time.\n"
    "\n"
    "  --mu X           static friction; dynamic friction too, unless --mu-d is given (%g)\n"
    "  --mu-d X         dynamic friction (%g)\n"
    "  --restitution X  restitution (%g)\n"
    "  --inertia X      moment of inertia over mass times width^2 (%g)\n"
    "  --drag X         drag of the air: deceleration over speed^2, 1/m (%g)\n"
    "  --from N         start from the state of step N of a toss, from 0 (%u: until then the hand "
    "holds\n"
    "                   the cube); steps before it are neither used nor judged\n"
    "  --substeps N     parts of a step (%u)\n"
    "  --solver NAME    as in tribo scene (%s)\n"
    "  --compare        write instead the means for other choices, one at a time: friction, "
    "restitution,\n"
    "                   inertia, lengths, air, sub-steps, first state\n"
    "  --fit            fit instead friction, restitution and inertia to the tosses, starting from "
    "the\n"
    "                   nominal ones: compass search for the least sum of the mean position error "
    "in widths\n"
    "                   and the mean rotation error in radians. Done for all tosses, and five "
    "times with\n"
    "                   every fifth one kept aside, whose errors are then written (held out)\n";

typedef struct toss_command {
    toss_options options;
    int dynamic_given, compare, fit;
} toss_command;

static int predict(const toss_data *data, const toss_options *options)
{
    toss_result result;
    toss_error *errors = calloc(data->tosses, sizeof *errors);

    if (errors == NULL)
        return cli_error(CLI_BAD_INPUT, "%s", tribo_status_string(TRIBO_ERROR_MEMORY));
    const int exit_status = toss_predict(data, options, errors, &result);
    if (exit_status == 0) {
        puts("toss,steps,position_error_widths,rotation_error_deg");
        for (size_t i = 0; i < data->tosses; i++)
            printf("%.17g,%zu,%.6f,%.6f\n", data->rows[data->starts[i]].values[TOSS_NUMBER],
                   data->starts[i + 1] - data->starts[i] - options->from - 1, errors[i].position,
                   errors[i].rotation);
        printf("mean position_error_widths %.6f rotation_error_deg %.6f us_per_step %.2f\n",
               result.error.position, result.error.rotation,
               result.seconds * 1e6 / (double)result.steps);
    }
    free(errors);
    return exit_status;
}

static int run_toss(const char *file, const toss_command *command)
{
    const toss_options *options = &command->options;
    const uint32_t from =
        command->compare && options->from < TOSS_FROM_AT_MOST ? TOSS_FROM_AT_MOST : options->from;
    toss_data data;

    const tribo_status status = tribo_material_check(&options->pair);
    if (status != TRIBO_OK)
        return cli_error(CLI_USAGE, "toss: %s", tribo_status_string(status));
    int exit_status = toss_read(file, from, &data);
    if (exit_status != 0)
        return exit_status;
    if (command->fit)
        exit_status = toss_fit(&data, options);
    else if (command->compare)
        exit_status = toss_compare(&data, options);
    else
        exit_status = predict(&data, options);
    toss_free(&data);
    return exit_status;
}

static void print_usage(void)
{
    const toss_options o = toss_defaults();

    printf(USAGE, o.pair.mu_s, o.pair.mu_d, o.pair.e, o.inertia, o.drag, o.from, o.step.substeps,
           cli_solver_names[o.step.solver]);
}

static int take_drag(const char *text, double *drag)
{
    if (cli_number("--drag", text, drag) != 0)
        return -1;
    if (*drag < 0.0) {
        cli_error(CLI_USAGE, "--drag: \"%s\" is negative", text);
        return -1;
    }
    return 0;
}

/* -1 after a message; 1 if help was asked for. */
static int take_option(int option, toss_command *command)
{
    toss_options *o = &command->options;

    switch (option) {
    case 'm':
        return cli_number("--mu", optarg, &o->pair.mu_s);
    case 'd':
        command->dynamic_given = 1;
        return cli_number("--mu-d", optarg, &o->pair.mu_d);
    case 'e':
        return cli_number("--restitution", optarg, &o->pair.e);
    case 'i':
        return cli_positive("--inertia", optarg, &o->inertia);
    case 'a':
        return take_drag(optarg, &o->drag);
    case 'f':
        return cli_count("--from", optarg, 0, &o->from);
    case 'n':
        return cli_count("--substeps", optarg, 1, &o->step.substeps);
    case 's':
        return cli_solver_find(optarg, &o->step.solver);
    case 'c':
        command->compare = 1;
        return 0;
    case 'F':
        command->fit = 1;
        return 0;
    case 'h':
        print_usage();
        return 1;
    default:
        return -1;
    }
}

int cli_toss(int argc, char **argv)
{
    static const struct option options[] = {{"mu", required_argument, NULL, 'm'},
                                            {"mu-d", required_argument, NULL, 'd'},
                                            {"restitution", required_argument, NULL, 'e'},
                                            {"inertia", required_argument, NULL, 'i'},
                                            {"drag", required_argument, NULL, 'a'},
                                            {"from", required_argument, NULL, 'f'},
                                            {"substeps", required_argument, NULL, 'n'},
                                            {"solver", required_argument, NULL, 's'},
                                            {"compare", no_argument, NULL, 'c'},
                                            {"fit", no_argument, NULL, 'F'},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    toss_command command = {.options = toss_defaults()};
    int option, bad = 0;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        const int taken = take_option(option, &command);
        if (taken > 0)
            return EXIT_SUCCESS;
        bad |= taken;
    }
    if (bad != 0)
        return CLI_USAGE;
    if (optind != argc - 1)
        return cli_error(CLI_USAGE, "toss: one FILE.csv is needed; see tribo toss --help");
    if (!command.dynamic_given)
        command.options.pair.mu_d = command.options.pair.mu_s;
    return run_toss(argv[optind], &command);
}
