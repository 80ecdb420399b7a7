/* The restitution stage: bodies that have been stopped by the plastic solution part again. */
#ifndef TRIBO_RESTITUTION_H
#define TRIBO_RESTITUTION_H

#include "solver.h"

typedef struct restitution {
    double *first, *second;     /* impulses: 3 per contact */
    double *u_first, *u_second; /* velocities that they give */
    double *q, *target, *mu;    /* of the problems that are solved on the way */
} restitution;

void restitution_take(restitution *stage, arena *a, uint32_t count);

/* r holds the plastic solution and receives the impulses with restitution, e one coefficient per
 * contact. Returns the share of the stage that the energy allowed.
 *
 * r moves on two straight lines in the cone: to r + d, where frictionless impulses d part the
 * contacts at -e u_n, and on to Newton's restitution with Coulomb friction, u_n+ = -e u_n. On each
 * it goes as far as the energy, a quadratic in the share, does not exceed the one before impact. A
 * contact alone parts at -e u_n on all of the second line, and reaches it: with P_I = -u_n / W_nn,
 * the plastic impulse p dissipates p W p / 2 + mu p_n |u_t| >= P_I^2 W_nn / 2 (Cauchy-Schwarz on
 * (W p)_n = -u_n), and d gives back e^2 P_I^2 W_nn / 2 of it. */
double restitution_apply(restitution *stage, solver *s, const system_problem *problem,
                         const double *e, const goal *wanted, double *r);

#endif
