/* Engines behind one face: the same bodies in the same places, stepped by the same dt. As in
 * peer.h, each library is a shared object of its own. */
#ifndef TRIBO_BENCH_ENGINE_H
#define TRIBO_BENCH_ENGINE_H

#include "peer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds are PEER_SPHERE, PEER_BOX and PEER_PLANE, sizes as in peer_shape. */
typedef struct engine_body {
    int kind;
    double size[4];
    double mass;       /* 0: it never moves */
    double inertia[3]; /* about its own axes */
    double position[3];
    double orientation[4]; /* w, x, y, z */
    double velocity[3];
} engine_body;

/* Friction is of all bodies; nothing bounces, nothing sleeps, nothing is damped. */
typedef struct engine_scene {
    int count;
    const engine_body *bodies;
    double gravity[3];
    double friction;
    double dt;
} engine_scene;

typedef struct engine_state {
    double position[3];
    double orientation[4]; /* w, x, y, z */
    double velocity[3];
    double angular_velocity[3]; /* world axes */
} engine_state;

/* A contact point of a step, of bodies by their numbers. The normal points from b to a, the impulse
 * acts on a; both, and the arms from the centres of the bodies, in world axes, as the engine had
 * them when it solved the step. */
typedef struct engine_contact {
    int a, b;
    double normal[3];
    double arm_a[3], arm_b[3];
    double gap;        /* m; negative: overlap */
    double impulse[3]; /* N s */
} engine_contact;

/* One library with one setting. */
typedef struct engine {
    const char *name;
    const char *setting;
    int choice;                                           /* handed to make: which setting */
    int single;                                           /* it calculates in single precision */
    void *(*make)(const engine_scene *scene, int choice); /* null: it can not */
    void (*step)(void *world, int watched); /* watched: contacts will be asked for after it */
    void (*state)(void *world, int body, engine_state *out);
    /* Contacts of the last step, which was watched; returns their number, also if there is less
     * room. Null: the engine does not tell impulses of points. */
    int (*contacts)(void *world, int room, engine_contact *out);
    void (*drop)(void *world);
} engine;

/* The symbol of a shared object. */
#define ENGINE_LIST "engine_list"
typedef const engine *(*engine_list_function)(int *count);
PEER_EXPORT const engine *engine_list(int *count);

#ifdef __cplusplus
}
#endif

#endif
