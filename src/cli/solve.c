#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <tribo/sparse.h>

#include "cli.h"
#include "problem.h"

static const char USAGE[] =
    "usage: tribo solve FILE... [--tol T] [--solver NAME] [--max-time S] [--impulses DIR]\n"
    "\n"
    "Solve recorded problems of many contacts with friction, u = W r + q, and print for each a "
    "row\n"
    "of a table (tab-separated) with how far its impulses are from the exact law.\n"
    "\n"
    "  --tol T         stop when e_inv <= T (1e-9)\n"
    "  --solver NAME   auto (default), gauss-seidel or newton\n"
    "  --max-time S    stop after S seconds (no limit)\n"
    "  --impulses DIR  write DIR/NAME.r for each file NAME: a line \"rn rt1 rt2\" for each "
    "contact\n"
    "\n"
    "FILE is in the text format of Siconos (.dat) or the HDF5 format of FCLib, local or global.\n"
    "\n"
    "  solver         that gave the result\n"
    "  status         why it stopped: tolerance, iterations, time, stall, jam; or the library's "
    "name\n"
    "                 of what is wrong with the problem, which makes the exit status 1\n"
    "  eta            greatest natural-map residual of a contact, without unit\n"
    "  e_inv          |s r - P_K(s r - u')| / |q|, s the mean diagonal entry of W\n"
    "  siconos_error  |r - P_K(r - u')| / max(|q|, |r|, |u|)\n"
    "  iterations     sweeps and Newton steps\n"
    "  seconds        of the solve, its analysis included, without reading the file\n";

typedef struct settings {
    double tolerance;
    double max_seconds; /* 0: no limit */
    uint32_t solver;
    const char *folder; /* for impulses; null: none */
    tribo_linear linear;
} settings;

/* ---- one file -------------------------------------------------------------------------------- */

static const char *base_name(const char *file)
{
    const char *slash = strrchr(file, '/');

    return slash != NULL ? slash + 1 : file;
}

static int write_impulses(const char *folder, const char *file, size_t count, const double *r)
{
    const size_t room = strlen(folder) + strlen(base_name(file)) + sizeof "/.r";
    char *path = malloc(room);
    FILE *stream = NULL;
    int exit_status = 0;

    if (path != NULL) {
        snprintf(path, room, "%s/%s.r", folder, base_name(file));
        stream = fopen(path, "w");
    }
    for (size_t i = 0; i < count && stream != NULL; i++)
        fprintf(stream, "%.17g %.17g %.17g\n", r[3 * i], r[3 * i + 1], r[3 * i + 2]);
    const int failed = stream == NULL || ferror(stream) != 0;
    if ((stream != NULL && fclose(stream) != 0) || failed)
        exit_status =
            cli_error(CLI_BAD_INPUT, "%s/%s.r: %s", folder, base_name(file), strerror(errno));
    free(path);
    return exit_status;
}

static tribo_status solve(const settings *s, const problem *given, double *r,
                          tribo_system_info *info)
{
    tribo_system_options options = {.struct_size = sizeof options};
    size_t size = 0;

    options.solver = s->solver;
    options.measure = TRIBO_MEASURE_INVARIANT;
    options.tolerance = s->tolerance;
    options.max_seconds = s->max_seconds;
    options.linear = &s->linear;
    options.clock = cli_now;
    tribo_status status = tribo_system_assembled_workspace_size(given->count, given->row_starts,
                                                                given->columns, &options, &size);
    if (status != TRIBO_OK)
        return status;
    void *workspace = malloc(size + 1);
    if (workspace == NULL)
        return TRIBO_ERROR_MEMORY;
    status =
        tribo_system_solve_assembled(given->count, given->row_starts, given->columns, given->blocks,
                                     given->q, given->mu, &options, workspace, size, r, NULL, info);
    free(workspace);
    return status;
}

static int solve_file(const settings *s, const char *file)
{
    tribo_system_info info = {.struct_size = sizeof info};
    problem given;
    int exit_status = problem_read(file, &given);

    if (exit_status != 0)
        return exit_status;
    double *r = malloc(3 * given.count * sizeof *r);
    const double start = cli_now(NULL);
    const tribo_status status = r == NULL ? TRIBO_ERROR_MEMORY : solve(s, &given, r, &info);
    const double seconds = cli_now(NULL) - start;
    if (status == TRIBO_OK)
        printf("%s\t%zu\t%s\t%s\t%.6e\t%.6e\t%.6e\t%llu\t%.6e\n", file, given.count,
               cli_solver_names[info.solver], cli_stop_name(info.stop), info.eta, info.invariant,
               info.siconos, (unsigned long long)(info.sweeps + info.steps), seconds);
    else
        printf("%s\t%zu\t%s\t%s\tnan\tnan\tnan\t0\t%.6e\n", file, given.count,
               cli_solver_names[s->solver], tribo_status_name(status), seconds);
    fflush(stdout);
    if (status != TRIBO_OK)
        exit_status = cli_error(CLI_BAD_INPUT, "%s: %s: %s", file, tribo_status_name(status),
                                tribo_status_string(status));
    else if (s->folder != NULL)
        exit_status = write_impulses(s->folder, file, given.count, r);
    free(r);
    problem_free(&given);
    return exit_status;
}

/* ---- the command ----------------------------------------------------------------------------- */

static int run(settings *s, int count, char **files)
{
    tribo_sparse *sparse = NULL;
    int exit_status = 0;
    tribo_status status = tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse);

    s->linear.struct_size = sizeof s->linear;
    if (status == TRIBO_OK)
        status = tribo_sparse_linear(sparse, &s->linear);
    if (status != TRIBO_OK)
        return cli_error(CLI_BAD_INPUT, "solve: %s", tribo_status_string(status));
    if (s->folder != NULL && mkdir(s->folder, 0777) != 0 && errno != EEXIST) {
        exit_status = cli_error(CLI_BAD_INPUT, "%s: %s", s->folder, strerror(errno));
    } else {
        puts("file\tcontacts\tsolver\tstatus\teta\te_inv\tsiconos_error\titerations\tseconds");
        for (int i = 0; i < count; i++) {
            const int failed = solve_file(s, files[i]);
            exit_status = failed != 0 ? failed : exit_status;
        }
    }
    tribo_sparse_destroy(sparse);
    return exit_status;
}

/* -1 after a message; 1 if help was asked for. */
static int take_option(int option, settings *s)
{
    switch (option) {
    case 't':
        return cli_positive("--tol", optarg, &s->tolerance);
    case 's':
        return cli_solver_find(optarg, &s->solver);
    case 'm':
        return cli_positive("--max-time", optarg, &s->max_seconds);
    case 'i':
        s->folder = optarg;
        return 0;
    case 'h':
        fputs(USAGE, stdout);
        return 1;
    default:
        return -1;
    }
}

int cli_solve(int argc, char **argv)
{
    static const struct option options[] = {
        {"tol", required_argument, NULL, 't'},      {"solver", required_argument, NULL, 's'},
        {"max-time", required_argument, NULL, 'm'}, {"impulses", required_argument, NULL, 'i'},
        {"help", no_argument, NULL, 'h'},           {NULL, 0, NULL, 0}};
    settings s = {.tolerance = 1e-9};
    int option;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        const int taken = take_option(option, &s);
        if (taken != 0)
            return taken > 0 ? EXIT_SUCCESS : CLI_USAGE;
    }
    if (optind == argc)
        return cli_error(CLI_USAGE, "solve: a FILE is needed; see tribo solve --help");
    return run(&s, argc - optind, argv + optind);
}
