/**
 * @file cli.h
 * What the commands of the program `tribo` share: exit statuses, messages, names of laws, options.
 */
#ifndef TRIBO_CLI_H
#define TRIBO_CLI_H

#include <stdio.h>

#include <tribo/tribo.h>

/** Exit statuses, next to EXIT_SUCCESS. */
enum {
    CLI_BAD_INPUT = 1, /**< the input cannot be read or is wrong, or output cannot be written */
    CLI_USAGE = 2      /**< the command line is wrong */
};

/** Each takes the arguments from the command's name on and returns the exit status. */
int cli_impact(int argc, char **argv);
int cli_toss(int argc, char **argv);
int cli_collide(int argc, char **argv);
int cli_solve(int argc, char **argv);
int cli_demo(int argc, char **argv);
int cli_scene(int argc, char **argv);

/** Print "tribo: " and the message to standard error; returns `exit_status`. */
int cli_error(int exit_status, const char *format, ...);

/** The same with the place in front: "tribo: FILE:LINE:COLUMN: "; returns CLI_BAD_INPUT. */
int cli_error_at(const char *file, unsigned long line, unsigned long column, const char *format,
                 ...);

/** Names of the impact laws as users write them. */
enum { CLI_LAWS = 8 };
extern const char *const cli_law_names[CLI_LAWS];

/** Find the number of the law called `name`; -1 after a message that lists the names. */
int cli_law_find(const char *name, uint32_t *law);

/** Names of TRIBO_SOLVER_... as users write them. */
enum { CLI_SOLVERS = 3 };
extern const char *const cli_solver_names[CLI_SOLVERS];

/** Find the number of the solver called `name`; -1 after a message that lists the names. */
int cli_solver_find(const char *name, uint32_t *solver);

/** "tolerance", "iterations", "time", "cancel", "stall" or "jam": names of TRIBO_STOP_... */
const char *cli_stop_name(uint32_t stop);

/** Read the whole of `text` as a finite number; -1 after a message that names `option`. */
int cli_number(const char *option, const char *text, double *number);

/** The same, and above 0. */
int cli_positive(const char *option, const char *text, double *number);

/** Read the whole of `text` as a whole number from `least` to 2^20; -1 after a message. */
int cli_count(const char *option, const char *text, uint32_t least, uint32_t *count);

/** Seconds from any moment on: a tribo_clock_function. */
double cli_now(void *user);

/** "open", "stick", "slip" or "jam". */
const char *cli_mode_name(uint32_t mode);

/** End standard output; `exit_status`, or CLI_BAD_INPUT after a message if something was not
 * written. */
int cli_finish(int exit_status);

#endif
