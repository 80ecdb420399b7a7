/**
 * @file world.h
 * Worlds for `tribo scene`: a tribo_scene with the options of its steps, its clock, and the bodies
 * that scenes are made of.
 *
 * The first call that fails leaves its status in the world; from then on calls do nothing, so that
 * scenes need not ask after each. Lengths in m, masses in kg, times in s.
 */
#ifndef TRIBO_CLI_WORLD_H
#define TRIBO_CLI_WORLD_H

#include <stdio.h>

#include <tribo/scene.h>

/** Standard gravity of all scenes, m/s^2. */
#define WORLD_G 9.81

/** How a scene is run, and what has become of it. */
typedef struct world {
    double dt;      /**< of a step, s */
    double seconds; /**< that the scene asks for, or the user */
    tribo_step_options options;
    const void *given; /**< of the scene, as in scene_entry */
    FILE *csv;         /**< for states; null: none */
    FILE *notes;       /**< for lines beside the answer; null: none */

    tribo_scene *scene; /**< the present one; null before world_begin */
    tribo_body *kept;   /**< of world_keep; null: none */
    uint32_t kept_count;
    double time; /**< of the present one, s */
    tribo_status status;
    uint64_t steps;       /**< of all scenes since the world was made */
    double spent;         /**< s of processor time, in these steps */
    uint64_t impacts;     /**< of these steps, as in tribo_step_info */
    uint64_t sweeps;      /**< likewise */
    uint64_t newton;      /**< likewise */
    uint32_t stop;        /**< worst of these steps */
    double restitution;   /**< least of these steps */
    tribo_step_info last; /**< of the last step */
} world;

/** Make the present scene an empty one; mu and e of a pair are the greater ones. */
void world_begin(world *w, double gx, double gy, double gz);

/** The same with friction of a pair by TRIBO_MIX_... */
void world_begin_mixed(world *w, double gx, double gy, double gz, uint32_t friction_rule);

/** Free what the world holds. */
void world_end(world *w);

/** A floor z <= 0. */
tribo_scene_body world_floor(double mu, double e);

/** What is on the far side of a plane, n . x <= d with n in the xz plane. */
tribo_scene_body world_plane(double nx, double nz, double d, double mu);

/** A box that does not move. */
tribo_scene_body world_block(double hx, double hy, double hz, double mu);

/** Turn a body from z to x by an angle, from no turn. */
void world_tilt(tribo_scene_body *body, double angle);

/** A uniform ball, or one with the moment of inertia `share` m r^2. */
tribo_scene_body world_ball(double mass, double radius, double mu, double e);
tribo_scene_body world_ball_of(double mass, double radius, double share, double mu, double e);

/** A uniform box of half-extents hx, hy, hz. */
tribo_scene_body world_box(double mass, double hx, double hy, double hz, double mu, double e);

/** A body of mass, principal moments and friction that has no shape yet. */
tribo_scene_body world_body(double mass, double ixx, double iyy, double izz, double mu, double e);

/** Keep the first status that is not TRIBO_OK; 1 if all is well so far. */
int world_check(world *w, tribo_status status);

/** Add a body where it is, or at a place; returns its id. */
uint32_t world_add(world *w, const tribo_scene_body *body);
uint32_t world_add_at(world *w, const tribo_scene_body *body, double x, double y, double z);

/** Of a sub-step, s. */
double world_substep(const world *w);

/** Take `body` half a step back on its way, so that the midpoint of the first step finds it where
 *  it is now: contacts are found there. */
void world_before(const world *w, tribo_scene_body *body);

tribo_body world_state(world *w, uint32_t id);

/** Keep the states of all bodies. */
void world_keep(world *w);

/** The greatest way that a body has gone since, m: a turn counts as its angle times `size`. */
double world_way(world *w, double size);

/** Kinetic and potential energy about the origin, J. */
double world_energy(world *w);

/** One step. With a CSV file, a row for each body that is not static: time, id, position,
 *  orientation, velocity, angular velocity. */
void world_step(world *w);

/** Steps for so many seconds: the nearest whole number of them. */
void world_run(world *w, double seconds);

/** Number of steps in so many seconds, at least 1. */
uint64_t world_steps(const world *w, double seconds);

/** Measure the processor time of what is no step: world_tick() before, world_tock(w, tick) after; counts as a
 *  step. */
double world_tick(void);
void world_tock(world *w, double tick);

#endif
