/* Projections onto the friction cone and its dual for finite input of any size; shared by contact
 * and audit. */
#ifndef TRIBO_CONE_H
#define TRIBO_CONE_H

#include "bits.h"

#include <math.h>

/* |(x, y)| without overflow or underflow. */
static inline double planar_length(double x, double y)
{
    const double big = greater(absolute(x), absolute(y));
    const double s = power_of_two(scale_exponent(big));
    const double sx = s * x;
    const double sy = s * y;
    return sqrt(sx * sx + sy * sy) / s;
}

/* Nearest point of { |p_t| <= mu p_n }. Outside of both cones it is (1, mu t)(n + mu r)/(1 + mu^2)
 * with r = |p_t|; for mu > 1 numerator and denominator are divided by mu^2, so nothing
 * overflows. */
static inline void cone_project(const double p[3], double mu, double out[3])
{
    const double n = p[0];
    const double r = planar_length(p[1], p[2]);
    if (n >= 0.0 && r <= mu * n) {
        out[0] = p[0];
        out[1] = p[1];
        out[2] = p[2];
        return;
    }
    if (mu > 1.0 ? r <= -n / mu : mu * r <= -n) {
        out[0] = out[1] = out[2] = 0.0;
        return;
    }
    double normal;
    double planar;
    if (mu > 1.0) {
        const double inverse = 1.0 / mu;
        const double share = (n * inverse + r) / (1.0 + inverse * inverse);
        normal = share * inverse;
        planar = share;
    } else {
        normal = (n + mu * r) / (1.0 + mu * mu);
        planar = mu * normal;
    }
    out[0] = normal > 0.0 ? normal : 0.0;
    out[1] = planar > 0.0 ? planar * (p[1] / r) : 0.0;
    out[2] = planar > 0.0 ? planar * (p[2] / r) : 0.0;
}

#endif
