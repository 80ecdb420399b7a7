/**
 * @file stack.h
 * Many contacts for the demonstration: towers and a wall by each solver, and recorded problems by
 * the automatic choice: what an answer costs, and how far it is from the exact law.
 */
#ifndef TRIBO_CLI_STACK_H
#define TRIBO_CLI_STACK_H

#include <tribo/system.h>

enum { STACK_SCENES = 4, STACK_CURVES = 3, STACK_POINTS = 7 };

/** Solvers by curve: Gauss-Seidel, Newton, automatic. */
extern const char *const stack_names[STACK_CURVES];

/** Where the points of a curve stop: the first by sweeps, the others by eta. */
extern const uint64_t stack_sweeps[STACK_POINTS];
extern const double stack_tolerances[STACK_POINTS];

/** One solve from zero. */
typedef struct stack_point {
    tribo_system_info info; /**< its time is the least of several runs */
    double load_error;      /**< of the impulse on the ground, relative to the weight's */
} stack_point;

typedef struct stack_result {
    const char *title;
    size_t contacts;
    uint32_t rests; /**< 1: the exact load on the ground is the weight */
    stack_point points[STACK_CURVES][STACK_POINTS];
} stack_result;

/** Solve all scenes to all points. @return TRIBO_OK or the status of the library function that
 *  failed. */
tribo_status stack_survey(stack_result results[STACK_SCENES]);

/** Print what the recorded problems with more than 20 contacts take, those of the folder `data`/fc;
 * 0 or an exit status after a message. */
int stack_recorded(const char *data);

#endif
