/* The problem that the solvers of a system share, and the places they stand behind.
 *
 * Contacts of one system: u = W r + q, with W given by bodies (J M^-1 J^T) or by blocks. The torque
 * of a contact that resists rolling or spinning is one more "contact", right behind its own: see
 * resist.h. */
#ifndef TRIBO_SYSTEM_PRIVATE_H
#define TRIBO_SYSTEM_PRIVATE_H

#include <tribo/system.h>

typedef struct system_problem {
    uint32_t count;  /* contacts, and torques */
    uint32_t bodies; /* 0: the assembled form */

    /* Bodies form. u_c = F (v_A - v_B) + T_A omega_A - T_B omega_B, row by row. */
    const uint32_t *pairs;         /* 2 per contact; TRIBO_WORLD for all that can not move */
    const double *frames;          /* F: 9 per contact */
    const double *turns;           /* T_A and T_B: 18 per contact */
    const double *inverse_mass;    /* 1 per body */
    const double *inverse_inertia; /* 6 per body, world axes */
    const double *target;          /* 3 per contact, taken off u_c */
    const uint32_t *torque;        /* 1 per contact: it is a torque. Null: none is */
    const double *lengths; /* 2 per contact, of torques: spinning, rolling. Null: all are 0 */

    /* Assembled form: W by 3x3 blocks, 9 numbers each, rows sorted, the diagonal always there. Null
     * row_starts: dense, 3 count numbers a row. */
    const uint32_t *row_starts, *columns;
    const double *blocks;

    /* Both. */
    const double *diagonal;    /* W_cc: 9 per contact, row by row */
    const uint32_t *symmetric; /* 1 per contact: W_cc is symmetric to the bit */
    const double *q;           /* 3 per contact: velocity without impulses, less the target */
    const double *mu;          /* 2 per contact: mu_s, mu_d; 0, 0 for one row */
} system_problem;

#endif
