/* Gauss-Seidel with the exact solve of one contact: the real-time end of the solvers. */
#ifndef TRIBO_SWEEP_H
#define TRIBO_SWEEP_H

#include "system.h"

typedef struct sweep sweep;

/* Bytes that sweep_prepare takes; enough for any smaller system, too. bodies = 0: assembled
 * form. `torques` of the contacts are torques. */
size_t sweep_size(uint32_t count, uint32_t bodies, uint32_t torques);

/* Lay out the contacts of a problem for sweeps in `memory`, of any alignment. The arrays of the
 * problem must stay as they are while sweeps run.
 *
 * Bodies form: contacts are coloured greedily, so that no two of a colour share a body that moves,
 * and swept colour by colour, eight by eight; colours of few contacts come last, one contact after
 * the other. This order does not depend on isa or tasks. isa: one of TRIBO_ISA_... that is
 * available here. Assembled form: in the order of contacts.
 *
 * A contact with mu_s = 0 costs one row; its r_t is taken as 0. Contacts with a torque come last of
 * all, one after the other. */
sweep *sweep_prepare(const system_problem *problem, uint32_t isa, void *memory);

/* `sweeps` sweeps over all contacts. r: 3 per contact. v: 6 per body, the velocity that r gives
 * before and after; it is not read for anything but that, and may be null. A contact whose own
 * solve fails (a jam) keeps its impulse, brought into the cone. Besides the sweeps a run costs
 * about one more: it sums the bodies' velocities from r.
 *
 * Returns the greatest change of a contact in the last sweep, |W_cc dr| / (|q_c| + |W_cc||r_c|) by
 * greatest entries; 1 for one whose solve failed: a cheap guess of how far the solution is. */
double sweep_run(sweep *s, uint32_t sweeps, double *r, double *v, tribo_parallel_function parallel,
                 void *user, uint32_t tasks);

#endif
