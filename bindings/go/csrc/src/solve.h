/* The exact solve of one scaled problem, with a symmetric W or any; shared by contact and batch. */
#ifndef TRIBO_SOLVE_H
#define TRIBO_SOLVE_H

#include <tribo/base.h>

#include "kernel.h"

/* A scaled problem whose W need not be symmetric: row = (nt1, nt2), column = (t1n, t2n),
 * d = (11, 12, 21, 22). */
typedef struct solve_general {
    double nn, row[2], column[2], d[4];
    double bn, b[2];
} solve_general;

/* Impulse p of the scaled problem. Returns the mode (OPEN to JAM) or KERNEL_MATRIX. */
double solve_general_scaled(const solve_general *problem, double mu_s, double mu_d, double p[3],
                            double *nu, uint32_t *iterations);

/* The exact solve of a scaled problem; returns its mode or fault. */
double solve_scaled(const kernel_problem *problem, double mu_s, double mu_d, double p[3],
                    double *nu, uint32_t *iterations);

/* The public status of a KERNEL_ mode or fault. */
tribo_status status_of_mode(double mode);

#endif
