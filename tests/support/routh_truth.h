/**
 * @file routh_truth.h
 * Routh's impact law by brute force: the slip equations integrated in long double with
 * extrapolation, to some 1e-16. Slow, and apart from the library's way of doing it.
 */
#ifndef TRIBO_TESTS_ROUTH_TRUTH_H
#define TRIBO_TESTS_ROUTH_TRUTH_H

#include <tribo/contact.h>

/** Impulse of TRIBO_LAW_ROUTH_... for an approach (u_n < 0) that slips at first and a W that is
 *  well conditioned. Returns 0, and leaves p as it is, where the path is not simple: slip that
 *  stops without sticking, or a second compression. */
int routh_truth(const double w[6], const double u[3], const tribo_material *pair, uint32_t law,
                double p[3]);

#endif
