/**
 * @file material.h
 * Friction and restitution of materials, the lecture's table, and rules that mix two materials.
 *
 * Shapes and the rules on aliasing, threads and NaN: see base.h.
 */
#ifndef TRIBO_MATERIAL_H
#define TRIBO_MATERIAL_H

#include <tribo/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Coefficients of one material, or of a pair in contact; all without unit. 24 bytes. */
typedef struct tribo_material {
    double mu_s; /**< static friction, 0 <= mu_d <= mu_s < infinity: sticking holds up to mu_s
                      p_n */
    double mu_d; /**< dynamic friction: sliding friction is mu_d p_n */
    double e;    /**< restitution, 0 (plastic) to 1 (elastic) */
} tribo_material;

/** @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_FRICTION,
 *          TRIBO_ERROR_RESTITUTION. */
TRIBO_API tribo_status tribo_material_check(const tribo_material *material);

/** How two coefficients become one. */
enum {
    TRIBO_MIX_GEOMETRIC_MEAN = 0, /**< sqrt(a b): Box2D, Box3D and Jolt for friction */
    TRIBO_MIX_MINIMUM = 1,        /**< min(a, b) */
    TRIBO_MIX_MAXIMUM = 2,        /**< max(a, b): Box2D, Box3D and Jolt for restitution */
    TRIBO_MIX_PRODUCT = 3,        /**< a b: Bullet */
    TRIBO_MIX_ARITHMETIC_MEAN = 4 /**< (a + b) / 2: default of PhysX and of Rapier */
};

/** Mix two materials into the coefficients of the pair. Symmetric in a and b to the bit.
 *  @param friction_rule    TRIBO_MIX_..., for mu_s and mu_d (mu_d <= mu_s is kept by each rule)
 *  @param restitution_rule TRIBO_MIX_..., for e
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_OPTION, a status of tribo_material_check,
 *          TRIBO_ERROR_RANGE (the product overflows). */
TRIBO_API tribo_status tribo_material_mix(const tribo_material *a, const tribo_material *b,
                                          uint32_t friction_rule, uint32_t restitution_rule,
                                          tribo_material *out);

/** A user's own rule: fill `out` from a and b. Must be as thread-safe as the caller needs. */
typedef void (*tribo_mix_function)(const tribo_material *a, const tribo_material *b, void *user,
                                   tribo_material *out);

/** Mix by the user's rule; what it returns is checked before `out` is written.
 *  @return TRIBO_ERROR_NULL (user may be null), a status of tribo_material_check. */
TRIBO_API tribo_status tribo_material_mix_with(const tribo_material *a, const tribo_material *b,
                                               tribo_mix_function rule, void *user,
                                               tribo_material *out);

/** Number of entries in the table of pairs. The table is the lecture's ("Some coefficients"): wood
 *  on stone 0.7/0.3 and steel on steel 0.16/0.12; it gives no restitution, so e is 0. */
TRIBO_API uint32_t tribo_material_count(void);

/** Entry `index` of the table.
 *  @param name receives a static string, such as "wood on stone"; may be null
 *  @return TRIBO_ERROR_NULL (out), TRIBO_ERROR_INDEX. */
TRIBO_API tribo_status tribo_material_at(uint32_t index, const char **name, tribo_material *out);

/** Entry of the table by its name. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NAME. */
TRIBO_API tribo_status tribo_material_find(const char *name, tribo_material *out);

#ifdef __cplusplus
}
#endif

#endif
