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

/* One library with one setting. */
typedef struct engine {
    const char *name;
    const char *setting;
    int choice;                                           /* handed to make: which setting */
    int single;                                           /* it calculates in single precision */
    void *(*make)(const engine_scene *scene, int choice); /* null: it can not */
    void (*step)(void *world);
    void (*state)(void *world, int body, engine_state *out);
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
