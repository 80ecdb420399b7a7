/**
 * @file throw.h
 * A box thrown with spin onto a floor, the same throw under each impact law, with an audit of each
 * impact.
 */
#ifndef TRIBO_CLI_THROW_H
#define TRIBO_CLI_THROW_H

#include "tumble.h"

enum { THROW_FRAMES = 700, THROW_FRAMES_PER_SECOND = 500 };

/** What one impact conserved, floor included, and how far it is from Coulomb's law. */
typedef struct throw_audit {
    tribo_collision_info info;
    tribo_change change;
    tribo_measures measures;
    double escape; /**< (|p_t| - mu_s p_n) / |p|, or 0 in the cone of static friction */
} throw_audit;

/** One throw. */
typedef struct throw_record {
    throw_audit first;    /**< the first impact: the same velocities before it under each law */
    unsigned first_frame; /**< the frame before it */
    unsigned long impacts;
    unsigned long gains;    /**< impacts that made energy */
    unsigned long escapes;  /**< impacts whose impulse left the friction cone */
    unsigned long rebounds; /**< impacts that broke Newton's restitution */
    double greatest_gain;   /**< of energy, J */
    double greatest_escape, greatest_linear, greatest_angular;
    double energy_before, energy_after; /**< kinetic and potential, J */
    double turned; /**< angle from the first to the last orientation, degrees */
    tribo_body path[THROW_FRAMES];
} throw_record;

/** The box and the floor under `law`. */
tumble throw_scene(uint32_t law);

/** The box as it leaves the hand. */
tribo_status throw_start(tribo_body *box);

tribo_status throw_box(uint32_t law, throw_record *record);

#endif
