/**
 * @file peers.h
 * The same local problem solved as others do it, for comparison in one run: the slip equation with
 * cleared denominators as a quartic, and semismooth Newton on Alart and Curnier's function. Written
 * from the textbook formulas; of the quartic there is also a form with relative thresholds and a
 * Newton polish, so that what it loses, it loses by its formulation and not by neglect.
 */
#ifndef TRIBO_TESTS_PEERS_H
#define TRIBO_TESTS_PEERS_H

#include <tribo/contact.h>

/** Kinds of peers. */
enum {
    PEER_QUARTIC_PLAIN = 0, /**< roots by Ferrari's closed form, the first that fits */
    PEER_QUARTIC_FERRARI =
        1, /**< the same in scaled units, with Newton polish, the best that fits */
    PEER_QUARTIC_DURAND_KERNER = 2, /**< roots by simultaneous iteration (Weierstrass 1891) */
    PEER_NEWTON = 3,                /**< Alart & Curnier 1991, full steps */
    PEER_NEWTON_ARMIJO = 4,         /**< the same with Armijo's line search */
    PEERS = 5
};

const char *peer_name(uint32_t peer);

/** Solve v = W p + b with coefficient mu; returns the number of iterations. p is what the peer ends
 *  with, whether it found a solution or not. */
uint32_t peer_solve(uint32_t peer, const double w[6], const double b[3], double mu, double p[3]);

#endif
