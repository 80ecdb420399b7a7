/**
 * @file quad.h
 * The small kernels in quadruple precision, by other algorithms than the library's: the truth that
 * tests and benches measure against.
 *
 * Uses __float128 where the compiler has it (only + - * / and comparisons; no library), long double
 * where that is as wide. Elsewhere QUAD_AVAILABLE is 0 and the functions work in long double, which
 * is good enough for eta but no truth for forward errors.
 */
#ifndef TRIBO_TESTS_QUAD_H
#define TRIBO_TESTS_QUAD_H

#include <float.h>

#include <tribo/contact.h>

#if LDBL_MANT_DIG >= 113
#define QUAD_AVAILABLE 1
typedef long double quad_real;
#elif defined(__SIZEOF_FLOAT128__)
#define QUAD_AVAILABLE 1
__extension__ typedef __float128 quad_real;
#else
#define QUAD_AVAILABLE 0
typedef long double quad_real;
#endif

/** All solutions of one contact problem. */
typedef struct quad_solutions {
    size_t count;     /**< at most 6: open, stick, and four roots of the slip equation */
    uint32_t mode[6]; /**< TRIBO_MODE_... */
    quad_real p[6][3];
    quad_real nu[6]; /**< slip: u_t = -nu p_t; else 0 */
} quad_solutions;

/** Square root; 0 for x <= 0. */
quad_real quad_sqrt(quad_real x);

/** Every solution of Signorini-Coulomb with a positive definite W: sticking if in the cone of mu_s,
 *  slip with mu_d. The slip roots are those of a quartic with cleared denominators, separated by
 *  the roots of its derivatives and bisected, where the library follows the uncleared equation: the
 *  two share no step. */
void quad_solve(const double w[6], const double b[3], double mu_s, double mu_d,
                quad_solutions *out);

/** |p - q| / |q| for the solution q nearest to p (0 if both are zero); `nearest` (may be null)
 *  receives its number. Infinity if there is no solution. */
double quad_solution_error(const quad_solutions *solutions, const double p[3], size_t *nearest);

/** Condition number of W in the 2-norm; infinity if W is not positive definite. */
double quad_condition(const double w[6]);

/** Frobenius norms of W and its inverse multiplied, in long double: between the condition number
 *  and three times it, and a thousand times faster. Infinity if W is not positive definite. */
double quad_condition_bound(const double w[6]);

/** eta of audit.h for p, in long double: fast, and independent of the library. */
double quad_eta(const double w[6], const double b[3], double mu, const double p[3]);

/** The same for an impulse that is not rounded to double. */
double quad_eta_of(const double w[6], const double b[3], double mu, const long double p[3]);

/** Point of the cone |p_t| <= mu p_n nearest to x, in long double. */
void quad_project(const double x[3], double mu, long double out[3]);

/** Contact matrix of the bodies as they stand; b may be null. */
void quad_matrix(const tribo_body *a, const tribo_body *b, const tribo_contact *contact,
                 const double frame[9], quad_real w[6]);

/** Relative velocity in contact axes; b may be null. */
void quad_velocity(const tribo_body *a, const tribo_body *b, const tribo_contact *contact,
                   const double frame[9], quad_real u[3]);

/** Sticking impulse -W^-1 u; 0 if W is not positive definite. */
int quad_stick(const quad_real w[6], const quad_real u[3], quad_real p[3]);

/** Impulse of FRICTIONLESS. */
void quad_frictionless(const quad_real w[6], const quad_real u[3], double e, quad_real p[3]);

/** Impulse of ALGEBRAIC; returns kappa (0 if the bodies separate). */
quad_real quad_algebraic(const quad_real w[6], const quad_real u[3], const tribo_material *pair,
                         double tangential_restitution, quad_real p[3]);

/** Velocities of a body after the impulse `sign` p (contact axes) at `arm`: v, then omega. */
void quad_apply(const tribo_body *body, const double arm[3], const double frame[9],
                const quad_real p[3], double sign, quad_real velocity[6]);

/** Widen n doubles. */
void quad_widen(size_t n, const double *x, quad_real *out);

/** |x - y| / |y| of n-vectors, y the truth; 0 if both are zero. */
double quad_relative_error(size_t n, const double *x, const quad_real *y);

#endif
