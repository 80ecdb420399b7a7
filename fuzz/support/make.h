/**
 * @file make.h
 * Structured input from bytes: normals, bodies, contact matrices, materials, velocities.
 */
#ifndef FUZZ_MAKE_H
#define FUZZ_MAKE_H

#include "property.h"

/** Unit to an eps: random, axes with zeros of either sign, and the neighbourhood of (0, 0, -1). */
void make_normal(property_trial *t, const char *name, double out[3]);
void make_quat(property_trial *t, const char *name, double out[4]);

/** Kinds of bodies. */
enum {
    BODY_PLAIN, /**< uniform boxes, aspect up to 10, mass within 2^-4 .. 2^4 */
    BODY_WIDE,  /**< also aspect 2^13, masses 2^-20 .. 2^20, spheres, needles */
    BODY_ANY    /**< also immovable, locked axes */
};

/** A body with pose and velocities; `half` receives half-extents that contact arms fit in. */
void make_body(property_trial *t, const char *name, uint32_t kind, tribo_body *out, double half[3]);

/** A body of any twenty numbers, near a valid one in half of the cases. */
void make_body_wild(property_trial *t, const char *name, tribo_body *out);

/** Two bodies in contact. has_b = 0: the world. */
typedef struct scene {
    tribo_body a;
    tribo_body b;
    uint32_t has_b;
    double point[3];
    tribo_contact contact;
} scene;

/** At least A can move. */
void make_scene(property_trial *t, uint32_t kind, scene *out);

/** Kinds of contact matrices, after the sets of problems P1, P2, P3 and S. */
enum {
    MATRIX_BOX,       /**< one or two uniform boxes of aspect up to 10 */
    MATRIX_WIDE,      /**< aspect up to 1e4, masses 1e+-6 */
    MATRIX_NEEDLE,    /**< one moment of inertia times 2^-[0, 33] */
    MATRIX_SYNTHETIC, /**< symmetric positive definite, condition number up to 1e12 */
    MATRIX_SPHERE,    /**< diagonal, small integers */
    MATRIX_DEFINITE,  /**< number of the kinds above */
    MATRIX_SINGULAR   /**< semidefinite of rank 1 or 2, W_nn > 0 */
};

/** A contact matrix of one of the definite kinds. */
void make_matrix(property_trial *t, const char *name, double w[6]);
void make_matrix_of(property_trial *t, const char *name, uint32_t kind, double w[6]);

/** mu: 0, special, uniform below 1.5, or within 2^-10 .. 2^10. */
double make_friction(property_trial *t, const char *name);

/** A valid material; mu_s = mu_d in half of them. */
void make_material(property_trial *t, const char *name, tribo_material *out);

/** A velocity to be cancelled for w and mu: of mixed size, near the border of stick and slip,
 * grazing. */
void make_velocity(property_trial *t, const char *name, const double w[6], double mu,
                   double out[3]);

#endif
