#define _POSIX_C_SOURCE 200809L

#include "cli.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* In the order of TRIBO_LAW_... */
const char *const cli_law_names[CLI_LAWS] = {"algebraic",     "frictionless",   "lecture",
                                             "coulomb",       "routh-newton",   "routh-poisson",
                                             "routh-stronge", "lecture-closing"};

int cli_error(int exit_status, const char *format, ...)
{
    va_list arguments;

    fputs("tribo: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return exit_status;
}

int cli_error_at(const char *file, unsigned long line, unsigned long column, const char *format,
                 ...)
{
    va_list arguments;

    fprintf(stderr, "tribo: %s:%lu:%lu: ", file, line, column);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return CLI_BAD_INPUT;
}

int cli_law_find(const char *name, uint32_t *law)
{
    for (uint32_t i = 0; i < CLI_LAWS; i++) {
        if (strcmp(name, cli_law_names[i]) == 0) {
            *law = i;
            return 0;
        }
    }
    fprintf(stderr, "tribo: there is no law \"%s\"; the laws are", name);
    for (uint32_t i = 0; i < CLI_LAWS; i++)
        fprintf(stderr, " %s", cli_law_names[i]);
    fputc('\n', stderr);
    return -1;
}

/* In the order of TRIBO_SOLVER_... */
const char *const cli_solver_names[CLI_SOLVERS] = {"auto", "gauss-seidel", "newton"};

int cli_solver_find(const char *name, uint32_t *solver)
{
    for (uint32_t i = 0; i < CLI_SOLVERS; i++) {
        if (strcmp(name, cli_solver_names[i]) == 0) {
            *solver = i;
            return 0;
        }
    }
    cli_error(CLI_USAGE, "there is no solver \"%s\"; the solvers are auto gauss-seidel newton",
              name);
    return -1;
}

int cli_number(const char *option, const char *text, double *number)
{
    char *end = NULL;
    const double value = strtod(text, &end);

    if (text[0] == '\0' || isspace((unsigned char)text[0]) || *end != '\0' || !isfinite(value)) {
        cli_error(CLI_USAGE, "%s: \"%s\" is not a finite number", option, text);
        return -1;
    }
    *number = value;
    return 0;
}

const char *cli_stop_name(uint32_t stop)
{
    static const char *const names[] = {"tolerance", "iterations", "time",
                                        "cancel",    "stall",      "jam"};

    return stop < sizeof names / sizeof names[0] ? names[stop] : "unknown";
}

int cli_positive(const char *option, const char *text, double *number)
{
    if (cli_number(option, text, number) != 0)
        return -1;
    if (!(*number > 0.0)) {
        cli_error(CLI_USAGE, "%s: %s is not above 0", option, text);
        return -1;
    }
    return 0;
}

int cli_count(const char *option, const char *text, uint32_t least, uint32_t *count)
{
    double number;

    if (cli_number(option, text, &number) != 0)
        return -1;
    if (number < least || number > 1048576.0 || floor(number) != number) {
        cli_error(CLI_USAGE, "%s: \"%s\" is not a whole number from %u to 1048576", option, text,
                  (unsigned)least);
        return -1;
    }
    *count = (uint32_t)number;
    return 0;
}

double cli_now(void *user)
{
    struct timespec t;

    (void)user;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

const char *cli_mode_name(uint32_t mode)
{
    static const char *const names[] = {"open", "stick", "slip", "jam"};

    return mode < sizeof names / sizeof names[0] ? names[mode] : "unknown";
}

int cli_finish(int exit_status)
{
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        const char *reason = errno != 0 ? strerror(errno) : "write error";
        return cli_error(CLI_BAD_INPUT, "standard output: %s", reason);
    }
    return exit_status;
}
