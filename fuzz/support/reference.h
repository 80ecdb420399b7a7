/**
 * @file reference.h
 * What results are measured against, in long double by other formulae than the library's. It must
 * be wider than double for them to be of use.
 */
#ifndef FUZZ_REFERENCE_H
#define FUZZ_REFERENCE_H

#include "make.h"

double norm3(const double v[3]);
double norm2(const double v[2]);
double distance3(const double a[3], const double b[3]);

/** Eigenvalues of a symmetric matrix, ascending. */
void reference_eigenvalues(const double w[6], double values[3]);

/** lambda_max / lambda_min, infinite for a matrix that is not positive definite. */
double reference_condition(const double w[6]);

/** Rotation matrix of q / |q|. */
void reference_rotation(const double q[4], long double r[9]);

/** The contact matrix by skew matrices in world axes; bound = sum (1/m + |r|^2 |I^-1|). */
void reference_matrix(const scene *s, const double frame[9], double w[6], double *bound);

/** v = W p + b. */
void reference_velocity(const double w[6], const double b[3], const double p[3], double v[3]);

/** Scales: V = |b| + | |W||p| |, P = V / greatest W_ii. */
double reference_scale(const double w[6], const double b[3], const double p[3], double *impulse);

/** Natural-map residual of p for (w, b, mu), without dimension. */
double reference_eta(const double w[6], const double b[3], double mu, const double p[3]);

/** 1 if Kantorovich's bound shows that the solution is unique, with room to spare. */
int reference_unique(const double w[6], double mu);

/** out = s^-1 x by Cholesky. 0 if s is not positive definite. */
int reference_solve(const double s[6], const long double x[3], long double out[3]);

/** Spin angular momentum in world axes and energy of rotation. 0 if the inverse inertia is not
 *  positive definite. */
int reference_spin(const tribo_body *body, double out[3], double *energy);

#endif
