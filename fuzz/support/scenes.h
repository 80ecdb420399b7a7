/**
 * @file scenes.h
 * Bodies with shapes of every type for a scene, from bytes. Part of the target of scenes only.
 */
#ifndef FUZZ_SCENES_H
#define FUZZ_SCENES_H

#include <tribo/scene.h>

#include "shapes.h"

enum { SCENES_BODIES = 6 };

/** What a cast may have. */
enum {
    SCENES_GRAVITY = 1,
    SCENES_FRICTION = 2,
    SCENES_RESTITUTION = 4,
    SCENES_GROUND = 8,   /**< bodies that are not dynamic, at rest */
    SCENES_DRIVEN = 16,  /**< kinematic bodies that move, and belts */
    SCENES_FORCES = 32,  /**< forces and torques */
    SCENES_EXTREME = 64, /**< sizes and densities from 1e-6 to 1e6, a thousand apart in one cast */
    SCENES_ALL = 127
};

/** Bodies that are near each other. They point into it: not to be moved. Large. */
typedef struct cast {
    tribo_scene_settings settings;
    uint32_t count;
    int length; /**< exponents of what is usual in it, m and kg/m^3 */
    int density;
    made_shape shapes[SCENES_BODIES];
    tribo_scene_body bodies[SCENES_BODIES];
    double forces[SCENES_BODIES][3];
    double torques[SCENES_BODIES][3];
} cast;

void make_cast(property_trial *t, uint32_t with, cast *out);

/** All lengths, masses and times by powers of two. 0 if a hull or mesh cannot be built. */
int scenes_scale(const cast *from, int length, int mass, int time, cast *out);

/** A scene with all of the cast, ids as places in it; null if it is refused. */
tribo_scene *scenes_build(const cast *from);

#endif
