/* Impact laws on one scaled problem; shared by contact.c only, kept apart because ROUTH is long. */
#ifndef TRIBO_IMPACT_H
#define TRIBO_IMPACT_H

#include <tribo/contact.h>

#include "kernel.h"

/* Impulse p of the scaled problem by the law in options; fills iterations, kappa and compression
 * (scaled) of info. The coefficients have been judged. Returns a KERNEL_ mode or fault. */
double impact_scaled(const kernel_problem *problem, const tribo_material *pair,
                     const tribo_impact_options *options, double p[3], tribo_impact_info *info);

/* Routh's law: routh.c. */
double routh_scaled(const kernel_problem *problem, const tribo_material *pair, uint32_t law,
                    double p[3], tribo_impact_info *info);

#endif
