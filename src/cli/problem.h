/**
 * @file problem.h
 * Frictional-contact problems of one contact in the text format of Siconos.
 */
#ifndef TRIBO_CLI_PROBLEM_H
#define TRIBO_CLI_PROBLEM_H

#include <tribo/tribo.h>

/** u = W p + q with friction mu. W row by row; it need not be symmetric. */
typedef struct problem {
    double w[9];
    double q[3];
    double mu;
} problem;

/** What a solve gave. */
typedef struct problem_solution {
    tribo_status status;
    uint32_t
        general;   /**< 1: W is not symmetric to the bit, tribo_contact_solve_general was called */
    uint32_t mode; /**< TRIBO_MODE_... */
    double p[3];
    double
        error; /**< natural map |s p - P_K(s p - u')| / |q|, u' = u + mu |u_t| e_n, s = tr(W) / 3 */
} problem_solution;

/** Read a problem in local form (W, q, mu) or, if `global` is not 0, in global form (M, H, f, w,
 * mu), which is reduced: W = H^T M^-1 H, q = H^T M^-1 f + w. Matrices may be dense or of sparse
 * blocks.
 *  @return 0, or an exit status after a message with line and column. */
int problem_read(const char *file, int global, problem *out);

void problem_solve(const problem *given, problem_solution *solution);

#endif
