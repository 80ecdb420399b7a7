/* The choice among the solvers for one connected component. */
#ifndef TRIBO_SOLVER_H
#define TRIBO_SOLVER_H

#include "anderson.h"
#include "newton.h"
#include "sweep.h"

/* What all components of a solve share. */
typedef struct solver {
    const tribo_system_options *options;
    tribo_system_info *info; /* counts so far */
    double start;            /* s, by the clock of the options */
    uint64_t most;           /* sweeps, and Newton steps, of a component */
    uint32_t stop;           /* TRIBO_STOP_...: the worst so far */
    tribo_status status;     /* of options->linear */
    double growth;           /* of the last impulses: see certificate_growth */
    int is_current;          /* dv and u are those of the r that solver_solve gave back */
    newton_run run;

    newton *newton;     /* null: not asked for */
    anderson *anderson; /* the same */
    void *sweep_memory;
    double *dv, *v;                            /* 6 per body */
    double *u, *held, *start_r, *swept, *best; /* 3 per contact */
    double *mu;                                /* 2 per contact: the coefficients in force */
} solver;

/* Seconds by the clock of the options. */
double solver_now(const tribo_system_options *options);

/* Improve r, 3 per contact, until the goal is met or nothing helps. Returns how good r is; a contact
 * that was solved alone has no distance from the goal. */
verdict solver_solve(solver *s, const system_problem *problem, const goal *wanted, double *r);

#endif
