/* Rolling and spinning resistance: the torque at a contact, bounded by its normal impulse.
 *
 * In a system_problem a torque stands right behind its contact, laid out as if it were one more:
 * its r is tau / arm and its u is arm omega, by the axes (n, t1, t2) of the contact. The arm, a
 * power of two, brings its diagonal of W to the size of the contact's. Its law is a projection,
 * too, on limits that the normal impulse N of the contact sets: r_n in [-spinning N, spinning N],
 * (r_t1, r_t2) in the disc of radius rolling N, with lengths over the arm. */
#ifndef TRIBO_RESIST_H
#define TRIBO_RESIST_H

#include "natural.h"
#include "system.h"

static inline int resist_is_torque(const system_problem *p, size_t c)
{
    return p->torque != NULL && p->torque[c] != 0;
}

static inline int resist_has_torque(const system_problem *p, size_t c)
{
    return p->torque != NULL && c + 1 < p->count && p->torque[c + 1] != 0;
}

/* 1 if contact c has a torque that may be other than 0. */
static inline int resist_acts(const system_problem *p, size_t c)
{
    return resist_has_torque(p, c) && p->lengths != NULL;
}

/* Limits, spinning and rolling, of torque c for the normal impulse (times what the torque is
 * multiplied by). */
static inline void resist_limits(const system_problem *p, size_t c, double normal, double limits[2])
{
    const double held = normal > 0.0 ? normal : 0.0;
    for (size_t k = 0; k < 2; k++)
        limits[k] = p->lengths != NULL ? p->lengths[2 * c + k] * held : 0.0;
}

/* Nearest torque within the limits. */
static inline void resist_project(const double y[3], const double limits[2], double out[3])
{
    const double t = planar_length(y[1], y[2]);
    const double share = t > limits[1] ? limits[1] / t : 1.0;

    out[0] = absolute(y[0]) > limits[0] ? copysign(limits[0], y[0]) : y[0];
    out[1] = share * y[1];
    out[2] = share * y[2];
}

/* F = g r - P(g r - u) of a torque, for limits times g. Returns STICK where it is within
 * them, else SLIP. */
uint32_t resist_map(double g, const double limits[2], const double r[3], const double u[3],
                    double f[3], double y[3]);

/* As natural_linearize. F also changes by -lead dN, N the normal impulse that the limits are of.
 * lengths: as the limits, for N = 1. */
void resist_linearize(double g, double alpha, const double limits[2], const double lengths[2],
                      const double y[3], double slope[9], double own[9], double lead[3]);

/* N, by F_n of the contact's natural map. */
static inline double resist_normal(double g, double r, double f)
{
    return greater(r - f / g, 0.0);
}

/* One contact and its torque. */
typedef struct resist_block {
    double w[36]; /* symmetric, row by row */
    double b[6];  /* velocity without the impulses */
    double mu;
    double lengths[2];
} resist_block;

/* All of contact c but b; alpha is added to the diagonal of W. */
void resist_fill(const system_problem *p, size_t c, double alpha, resist_block *out);

/* r = impulses for one contact and its torque; it holds a start. Returns 0 if there are none: r is
 * then as near as was found, within the cone and the limits. */
int resist_solve(const resist_block *block, double r[6]);

#endif
