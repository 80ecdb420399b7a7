#include <getopt.h>
#include <math.h>
#include <stdlib.h>

#include "cli.h"
#include "table.h"

static const char USAGE[] =
    "usage: tribo impact FILE.csv --law NAME\n"
    "\n"
    "Find the impulse of each impact in FILE.csv (-: standard input). Columns, in any order; "
    "others are\n"
    "ignored:\n"
    "  wnn,wn1,wn2,w11,w12,w22  contact matrix, 1/kg, in the axes normal, tangent 1, tangent 2\n"
    "  un,u1,u2                 relative velocity before, m/s; un < 0 is approach\n"
    "  mu_s,mu_d,e              static and dynamic friction, restitution\n"
    "Written are, row by row, 17 digits each:\n"
    "  mode                     open, stick or slip; or the status that says why there is no "
    "result\n"
    "  pn,p1,p2                 impulse, N s\n"
    "  vn,v1,v2                 relative velocity after, m/s\n"
    "  energy                   change of kinetic energy, J\n"
    "  eta                      distance from Coulomb's law with Newton's restitution, without "
    "unit\n"
    "\n"
    "  --law NAME  frictionless, lecture, lecture-closing, algebraic, coulomb, routh-newton,\n"
    "              routh-poisson or routh-stronge\n"
    "\n"
    "A row that the library refuses has a status in `mode` and empty fields, a message on standard "
    "error,\n"
    "and makes the exit status 1 in the end. Malformed CSV ends the run at its line.\n";

enum { UN = 6, MU_S = 9, RESTITUTION = 11, COLUMNS = 12 };

static const char *const NAMES[COLUMNS] = {"wnn", "wn1", "wn2", "w11",  "w12",  "w22",
                                           "un",  "u1",  "u2",  "mu_s", "mu_d", "e"};

typedef struct impact_run {
    tribo_impact_options options;
    unsigned long rows, refused;
} impact_run;

/* The column that a status is about. */
static size_t blamed_column(tribo_status status, const double *values)
{
    for (size_t i = 0; i < COLUMNS; i++) {
        if (status == TRIBO_ERROR_NOT_FINITE && !isfinite(values[i]))
            return i;
    }
    switch (status) {
    case TRIBO_ERROR_FRICTION:
        return MU_S;
    case TRIBO_ERROR_RESTITUTION:
        return RESTITUTION;
    default:
        return 0;
    }
}

static int take_impact(void *user, const table_row *row)
{
    impact_run *run = user;
    const double *value = row->values;
    const tribo_material pair = {value[MU_S], value[MU_S + 1], value[RESTITUTION]};
    tribo_impact_info info = {.struct_size = sizeof info};
    tribo_measures measures;
    double p[3];

    tribo_status status = tribo_impact(value, value + UN, &pair, &run->options, p, &info);
    if (status == TRIBO_OK)
        status = tribo_audit_impact(value, value + UN, &pair, p, &measures);
    run->rows++;
    if (status == TRIBO_OK) {
        const double *v = info.velocity;
        printf("%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", cli_mode_name(info.mode),
               p[0], p[1], p[2], v[0], v[1], v[2], info.energy, measures.eta);
    } else {
        const size_t blamed = blamed_column(status, value);
        run->refused++;
        printf("%s,,,,,,,,\n", tribo_status_name(status));
        cli_error_at(row->file, row->value_lines[blamed], row->value_columns[blamed], "%s: %s",
                     tribo_status_name(status), tribo_status_string(status));
    }
    return 0;
}

static int run_impacts(const char *file, uint32_t law)
{
    impact_run run = {.options = {.struct_size = sizeof run.options, .law = law}};

    puts("mode,pn,p1,p2,vn,v1,v2,energy,eta");
    const int exit_status = table_read(file, COLUMNS, NAMES, take_impact, &run);
    if (exit_status == 0 && run.refused > 0)
        return cli_error(CLI_BAD_INPUT, "%s: %lu of %lu rows have no result", file, run.refused,
                         run.rows);
    return exit_status;
}

int cli_impact(int argc, char **argv)
{
    static const struct option options[] = {{"law", required_argument, NULL, 'l'},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    uint32_t law = CLI_LAWS;
    int option;

    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        switch (option) {
        case 'l':
            if (cli_law_find(optarg, &law) != 0)
                return CLI_USAGE;
            break;
        case 'h':
            fputs(USAGE, stdout);
            return EXIT_SUCCESS;
        default:
            return CLI_USAGE;
        }
    }
    if (law == CLI_LAWS)
        return cli_error(CLI_USAGE, "impact: --law NAME is needed; see tribo impact --help");
    if (optind != argc - 1)
        return cli_error(CLI_USAGE, "impact: one FILE.csv is needed; see tribo impact --help");
    return run_impacts(argv[optind], law);
}
