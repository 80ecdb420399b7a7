/* The natural map of one contact, F = g r - P_K(g r - u'), and its derivative: shared by Newton on
 * a system and Newton on one contact. */
#ifndef TRIBO_NATURAL_H
#define TRIBO_NATURAL_H

#include "cone.h"

enum { OPEN, SLIP, STICK };

/* F at the impulse r and the velocity u, g > 0; y receives g r - u'. Returns OPEN, SLIP or
 * STICK. */
static inline uint32_t natural_map(double g, double mu, const double r[3], const double u[3],
                                   double f[3], double y[3])
{
    double projected[3];

    for (int k = 0; k < 3; k++)
        y[k] = g * r[k] - u[k];
    const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
    y[0] -= mu * slip;
    cone_project(y, mu, projected);
    for (int k = 0; k < 3; k++)
        f[k] = g * r[k] - projected[k];
    /* A tie counts as closed: a stack is met from below, with all interfaces but one at rest. */
    if (y[0] >= 0.0 && projected[0] == y[0] && projected[1] == y[1] && projected[2] == y[2])
        return STICK;
    return projected[0] > 0.0 ? SLIP : OPEN;
}

/* P, the derivative of the projection at y. */
static inline void natural_derivative(uint32_t mode, const double y[3], double mu, double p[9])
{
    const double t = sqrt(y[1] * y[1] + y[2] * y[2]);
    const double share = 1.0 / (1.0 + mu * mu);

    for (int i = 0; i < 9; i++)
        p[i] = mode == STICK && i % 4 == 0 ? 1.0 : 0.0;
    if (mode != SLIP)
        return;
    const double h1 = t > 0.0 ? y[1] / t : 0.0;
    const double h2 = t > 0.0 ? y[2] / t : 0.0;
    const double across = t > 0.0 ? mu * share * (mu * t + y[0]) / t : 0.0;
    const double along = mu * mu * share;
    p[0] = share;
    p[1] = p[3] = mu * share * h1;
    p[2] = p[6] = mu * share * h2;
    p[4] = along * h1 * h1 + across * h2 * h2;
    p[5] = p[7] = (along - across) * h1 * h2;
    p[8] = along * h2 * h2 + across * h1 * h1;
}

/* dF by a change of velocity, slope = P E, E the derivative of u' by u, and by one of r alone, own
 * = g (1 - P) + alpha P E, where u itself changes by alpha dr; right = F. Where a contact sticks, P
 * = 1, and all three are multiplied by E^-1: that row of the matrix is one of W. u, f, y and mode
 * are those of natural_map. */
static inline void natural_linearize(uint32_t mode, double g, double alpha, double mu,
                                     const double u[3], const double y[3], const double f[3],
                                     double slope[9], double own[9], double right[3])
{
    const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
    const double e1 = slip > 0.0 ? mu * u[1] / slip : 0.0;
    const double e2 = slip > 0.0 ? mu * u[2] / slip : 0.0;
    const double off = mode == STICK ? 0.0 : 1.0;
    double p[9];

    natural_derivative(mode, y, mu, p);
    for (int i = 0; i < 3; i++) {
        slope[3 * i] = p[3 * i];
        slope[3 * i + 1] = p[3 * i + 1] + off * p[3 * i] * e1;
        slope[3 * i + 2] = p[3 * i + 2] + off * p[3 * i] * e2;
        right[i] = f[i];
    }
    if (mode == STICK)
        right[0] -= e1 * f[1] + e2 * f[2];
    for (int i = 0; i < 9; i++)
        own[i] = g * ((i % 4 == 0 ? 1.0 : 0.0) - p[i]) + alpha * slope[i];
}

#endif
