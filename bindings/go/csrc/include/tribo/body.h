/**
 * @file body.h
 * Rigid bodies: mass, inertia, pose, velocity, free flight.
 *
 * Shapes and the rules on aliasing, threads and NaN: see base.h.
 */
#ifndef TRIBO_BODY_H
#define TRIBO_BODY_H

#include <tribo/math.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A rigid body. All zeros but orientation[0] = 1 is an immovable body at the origin.
 *  160 bytes; layout is part of the ABI. */
typedef struct tribo_body {
    double position[3];         /**< centre of mass, world axes, m */
    double orientation[4];      /**< body to world; unit to 1e-6, used as if normalised */
    double velocity[3];         /**< of the centre of mass, world axes, m/s */
    double angular_velocity[3]; /**< world axes, rad/s */
    double inverse_mass;        /**< 1/kg; 0: cannot be moved */
    double inverse_inertia[6];  /**< about the centre of mass, BODY axes, 1/(kg m^2), symmetric,
                                     positive semidefinite; a zero row is an axis that cannot be
                                     turned */
} tribo_body;

/** Make `body` immovable, at the origin, at rest. @return TRIBO_ERROR_NULL. */
TRIBO_API tribo_status tribo_body_init(tribo_body *body);

/** Set inverse mass and inverse inertia from mass (kg) and inertia tensor (kg m^2, about the centre
 *  of mass, body axes).
 *  @param inertia symmetric (relative asymmetry up to 1e-12 is averaged out), positive definite,
 *         and of a possible body: no principal moment exceeds the sum of the others by more than
 *         1e-9 of it.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MASS (mass <= 0),
 *          TRIBO_ERROR_INERTIA, TRIBO_ERROR_RANGE (a reciprocal is not finite). */
TRIBO_API tribo_status tribo_body_set_mass(tribo_body *body, double mass, const double inertia[9]);

/** Judge every field of a body.
 *  @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_ORIENTATION
 *          (||q|-1|>1e-6), TRIBO_ERROR_MASS (negative), TRIBO_ERROR_INERTIA (not positive
 *          semidefinite to 1e-12). */
TRIBO_API tribo_status tribo_body_check(const tribo_body *body);

/* ---- mass properties of uniform solids -------------------------------------------------------
 * About the centre of mass, in the axes of the shape; density kg/m^3, lengths m, `mass` kg,
 * `inertia` kg m^2 as a full 3x3 matrix for tribo_body_set_mass. All return TRIBO_ERROR_NULL,
 * TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_SHAPE (a length or the density is not positive),
 * TRIBO_ERROR_RANGE (the result is not finite or underflows to zero). */

/** Ball of the given radius: I = 2/5 m r^2. */
TRIBO_API tribo_status tribo_mass_sphere(double density, double radius, double *mass,
                                         double inertia[9]);

/** Box of half-extents h: I_xx = m/3 (h_y^2 + h_z^2), and so on. */
TRIBO_API tribo_status tribo_mass_box(double density, const double half[3], double *mass,
                                      double inertia[9]);

/** Cylinder of axis z from -half_height to half_height, with half-balls of the same radius on its
 *  ends. */
TRIBO_API tribo_status tribo_mass_capsule(double density, double radius, double half_height,
                                          double *mass, double inertia[9]);

/** Cylinder of axis z from -half_height to half_height. */
TRIBO_API tribo_status tribo_mass_cylinder(double density, double radius, double half_height,
                                           double *mass, double inertia[9]);

/** Ellipsoid of semi-axes a: I_xx = m/5 (a_y^2 + a_z^2), and so on. */
TRIBO_API tribo_status tribo_mass_ellipsoid(double density, const double semi_axes[3], double *mass,
                                            double inertia[9]);

/* ---- kinematics and dynamics ---------------------------------------------------------------- */

/** Inverse inertia in world axes: R I_body^-1 R^T (lecture, "The algorithm for angular motion").
 *  Symmetric to the bit. @return TRIBO_ERROR_NULL or a status of tribo_body_check. */
TRIBO_API tribo_status tribo_body_world_inverse_inertia(const tribo_body *body, double out[6]);

/** Spin angular momentum about the centre of mass, world axes, kg m^2/s: R I R^T omega; an axis
 *  that cannot be turned contributes nothing.
 *  @return TRIBO_ERROR_NULL, a status of tribo_body_check, TRIBO_ERROR_INERTIA also where the
 *          inverse inertia is singular in any other way than by zero rows. */
TRIBO_API tribo_status tribo_body_spin(const tribo_body *body, double out[3]);

/** Velocity of the body's point at `arm` from the centre of mass (world axes): v + omega x arm,
 *  m/s. */
TRIBO_API void tribo_body_point_velocity(const tribo_body *body, const double arm[3],
                                         double out[3]);

/** Add the impulse `p` (N s, world axes) at `arm`: v += p/m, omega += I^-1 (arm x p).
 *  An immovable body is not changed.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, or a status of tribo_body_check;
 *          TRIBO_ERROR_RANGE if a velocity would not be finite. */
TRIBO_API tribo_status tribo_body_apply_impulse(tribo_body *body, const double arm[3],
                                                const double p[3]);

/** Free flight: advance pose and velocities by dt seconds under a constant acceleration (m/s^2,
 *  world axes; may be null: none) and no torque.
 *
 *  Translation is the exact parabola. Rotation solves Euler's equations I w' = (I w) x w with the
 *  quaternion by Taylor series in the body's axes, to rounding: order and number of sub-steps
 *  follow from |omega| dt, so kinetic energy and angular momentum are kept to rounding and there is
 *  no time-step error (free rotation as in Goldstein, Classical Mechanics, 3rd ed., 5.6). Bodies
 *  with equal moments cost less. Cost grows with |omega| dt beyond about half a radian per step.
 *  A body with locked axes (zero rows of inverse inertia) keeps the angular velocity that it has.
 *  A body with zero inverse mass is kinematic: it moves with its velocities and is not accelerated.
 *  @param dt >= 0; |omega| dt <= 1e5.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_TIME_STEP, TRIBO_ERROR_RANGE
 *          (result not finite), or a status of tribo_body_check (TRIBO_ERROR_INERTIA as in
 *          tribo_body_spin). */
TRIBO_API tribo_status tribo_body_advance(tribo_body *body, const double acceleration[3],
                                          double dt);

#ifdef __cplusplus
}
#endif

#endif
