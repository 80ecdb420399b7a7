#include <stdlib.h>
#include <string.h>

#include "cli.h"

static const char USAGE[] =
    "usage: tribo COMMAND [OPTION...] [FILE]\n"
    "\n"
    "Contact and friction between rigid bodies.\n"
    "\n"
    "commands:\n"
    "  impact FILE.csv --law NAME  impulses of impacts, one for each row\n"
    "  toss FILE.csv               predict measured tosses of a cube, and say how well\n"
    "  collide FILE [--margin M]   contact manifolds of pairs of shapes\n"
    "  solve FILE... [--tol T]     recorded problems of many contacts, with a certificate\n"
    "  scene NAME                  scenes in time, held against their exact outcome\n"
    "  demo [--out DIR]            what each impact law keeps, breaks and costs; with pictures\n"
    "\n"
    "  tribo COMMAND --help        about one command\n"
    "  tribo --version             version of the library\n"
    "\n"
    "FILE may be - for standard input. Exit status: 0; 1 if the input is bad, 2 if the command "
    "line is.\n";

typedef struct cli_command {
    const char *name;
    int (*run)(int argc, char **argv);
} cli_command;

static const cli_command COMMANDS[] = {{"impact", cli_impact},   {"toss", cli_toss},
                                       {"collide", cli_collide}, {"solve", cli_solve},
                                       {"scene", cli_scene},     {"demo", cli_demo}};

int main(int argc, char **argv)
{
    static char program[] = "tribo"; /* getopt begins its messages with it */
    const char *name = argc > 1 ? argv[1] : "";

    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        fputs(USAGE, stdout);
        return cli_finish(EXIT_SUCCESS);
    }
    if (strcmp(name, "--version") == 0) {
        printf("tribo %s\n", tribo_version_string());
        return cli_finish(EXIT_SUCCESS);
    }
    for (size_t i = 0; i < sizeof COMMANDS / sizeof COMMANDS[0]; i++) {
        if (strcmp(name, COMMANDS[i].name) == 0) {
            argv[1] = program;
            return cli_finish(COMMANDS[i].run(argc - 1, argv + 1));
        }
    }
    if (name[0] == '\0')
        fputs(USAGE, stderr);
    else
        cli_error(CLI_USAGE, "there is no command \"%s\"; see tribo --help", name);
    return CLI_USAGE;
}
