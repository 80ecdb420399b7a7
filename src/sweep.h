/* Gauss-Seidel with the exact solve of one contact: the real-time end of the solvers. */
#ifndef TRIBO_SWEEP_H
#define TRIBO_SWEEP_H

#include "system.h"

typedef struct sweep sweep;

/* Bytes that sweep_prepare takes, aligned for double. */
size_t sweep_size(uint32_t count, uint32_t bodies);

/* Colour the contacts (no two of a colour share a body that moves, in the assembled form: a
 * block), and lay them out eight by eight in `memory`. The order of the colouring is the order of
 * the sweeps, whatever isa and tasks are. */
sweep *sweep_prepare(const system_problem *problem, uint32_t isa, void *memory);

/* `sweeps` sweeps over all contacts. r: 3 per contact; v: 6 per body, kept equal to the velocity
 * that r gives (unused in the assembled form). Returns the greatest change |W_cc dr| / V of a
 * contact in the last sweep, V = |q_c| + |W_cc| |r_c| summed entrywise: a cheap guess of how far
 * the solution is. */
double sweep_run(sweep *s, uint32_t sweeps, double *r, double *v, tribo_parallel_function parallel,
                 void *user, uint32_t tasks);

#endif
