/**
 * @file quad_system.h
 * The certificate of system.h in quadruple precision, by no step of the library: from bodies or
 * blocks and impulses to velocities, measures, energy and momentum. Every solve of the tests is
 * compared with it.
 */
#ifndef TRIBO_TESTS_QUAD_SYSTEM_H
#define TRIBO_TESTS_QUAD_SYSTEM_H

#include <tribo/system.h>

/** Measures as in tribo_system_info, and how much of each rounding in double can be. */
typedef struct quad_certificate {
    double eta;
    double eta_rms;
    double signorini;
    double cone;
    double misalignment;
    double invariant;
    double siconos;
    double energy;
    double energy_scale;
    double linear;   /**< of the velocities given, not of those that the impulses give */
    double angular;  /**< the same */
    double gap;      /**< angular that the gaps between the points of two bodies in contact make */
    double velocity; /**< greatest error of a velocity given: |v - v(r)|, linear or angular
                                 times the longest arm of the body, over the velocities it is summed
                                 from */
    double contact_noise;      /**< rounding of eta and its kin */
    double misalignment_noise; /**< of misalignment */
    double invariant_noise;    /**< of invariant */
    double siconos_noise;      /**< of siconos */
    double energy_noise;       /**< of energy, J */
    double linear_noise;       /**< of linear */
    double angular_noise;      /**< of angular; infinite where a body is held by an axis that cannot
                                 turn or a centre that cannot move: its momentum is not kept */
    double kinetic;            /**< change of the bodies' kinetic energy by the velocities given, J:
                                 with the work of targets; bodies form */
    double kinetic_noise;      /**< of kinetic, J */
    double worst_contact;      /**< number of the contact with the greatest eta */
} quad_certificate;

/** Certificate of impulses for bodies and contacts; `velocities` (width 6) as tribo_system_solve
 *  gave them, or null: linear, angular and velocity are 0 then. */
void quad_certificate_of_bodies(size_t body_count, const tribo_body *bodies, size_t count,
                                const tribo_system_contact *contacts, const double *impulses,
                                const double *velocities, quad_certificate *out);

/** The same with the torques (width 3; may be null: none) of contacts that resist rolling or
 *  spinning. */
void quad_certificate_with_torques(size_t body_count, const tribo_body *bodies, size_t count,
                                   const tribo_system_contact *contacts, const double *impulses,
                                   const double *torques, const double *velocities,
                                   quad_certificate *out);

/** The same of an assembled problem; row_starts null: dense. `velocities` (width 3) or null. */
void quad_certificate_of_blocks(size_t count, const uint32_t *row_starts, const uint32_t *columns,
                                const double *blocks, const double *q, const double *mu,
                                const double *impulses, const double *velocities,
                                quad_certificate *out);

/** Greatest difference between the two, each in units of its own rounding; `name` (may be null)
 *  receives the measure that has it. NaN counts as infinite. */
double quad_certificate_difference(const quad_certificate *truth, const tribo_system_info *info,
                                   const char **name);

#endif
