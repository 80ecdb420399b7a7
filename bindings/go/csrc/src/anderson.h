/* Anderson acceleration of sweeps.
 *
 * A batch of sweeps is a map r -> g(r) whose fixed point is wanted. From the last few r and f =
 * g(r) - r the method leaps to where f would vanish if g were linear (Walker & Ni, SIAM J. Numer.
 * Anal. 49 (2011) 1715). Where sweeps contract slowly it takes a tenth of them; where they wander
 * without end, as in piles that slide on many contacts, it finds fixed points that sweeps alone do
 * not get to. Far from one its leaps lead astray: it then rests for ever longer, and sweeps go on
 * alone. */
#ifndef TRIBO_ANDERSON_H
#define TRIBO_ANDERSON_H

#include "arena.h"
#include "system.h"

/* Sweeps between two leaps. */
#define ANDERSON_BATCH 4

typedef struct anderson anderson;

anderson *anderson_take(arena *a, uint32_t count);

/* Start on this problem, which must last and have no torques. */
void anderson_start(anderson *a, const system_problem *problem);

/* Go on, perhaps from another r. */
void anderson_resume(anderson *a);

/* r before a batch of sweeps. */
void anderson_hold(anderson *a, const double *r);

/* r after the batch: replaced by where to go on, within the cones. */
void anderson_leap(anderson *a, double *r);

#endif
