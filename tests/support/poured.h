/**
 * @file poured.h
 * Spheres poured into a box, as the scenes of libtribo move them: systems as they come, while the
 * spheres fall onto each other and once they lie.
 */
#ifndef TRIBO_TESTS_POURED_H
#define TRIBO_TESTS_POURED_H

#include "systems.h"

/** Moments of a pour. The time to them grows with the root of the height. */
enum {
    POURED_FALLING = 0, /**< the lower half lies, the upper one falls onto it */
    POURED_LYING = 1    /**< all have come down; some still creep */
};

/** The contacts of the next step. Radii from 0.35 to 0.5 m, drawn from the seed, as are small shifts
 *  and velocities at the start, in layers as high as they are wide, between four walls; friction
 *  0.5, no restitution, steps of 1/120 s. The first five bodies are the floor and the walls. A gap
 *  may close, no more: it stands in the target. */
void poured(systems_scene *out, size_t spheres, uint32_t moment, uint64_t seed);

#endif
