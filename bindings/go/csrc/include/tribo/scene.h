/**
 * @file scene.h
 * Bodies with shapes in time: they fly, touch, slide, roll, bounce and rest. Part of libtribo (not
 * of libtribo_core).
 *
 * A step of dt seconds is cut into equal sub-steps of h seconds. Each of them is Moreau's midpoint
 * rule (Moreau, in Nonsmooth Mechanics and Applications, CISM 302, Springer 1988), with the free
 * rotation of tribo_body_advance in place of a difference of angles:
 *
 *   1. all bodies fly freely for h/2;
 *   2. there, contacts are found: what may touch before the next midpoint, with its features;
 *   3. impacts, if there are any: half of the forces act, and bodies that would meet before the
 *      next midpoint, faster than the threshold, part by the restitution of their pairs
 *      (tribo_system_solve). In passes, at most 64, until none is left: in each those that are the
 *      first of both bodies, all at once that come within a sixteenth of the sub-step;
 *   4. forces act, and contacts hold: gap + h u_n >= 0 at the end, with Coulomb friction, and with
 *      rolling and spinning resistance where bodies have it;
 *   5. all bodies fly freely for the other h/2;
 *   6. where bodies overlap by more than rounding, and would go on to, they are moved apart;
 *      velocities do not change.
 *
 * Then a body without contact moves on the exact parabola and turns as Euler's equations say, at
 * any h. Linear momentum, and angular momentum about any common point, change by the impulses of
 * forces and of bodies that are not dynamic alone, to rounding: contacts act at one point on both
 * bodies, in the configuration that they were found in. Impacts do not raise kinetic energy. A
 * contact that persists takes p . (u- + u+) / 2 out of the total energy, with u- and u+ the
 * velocities at both ends of the sub-step; this is of the wrong sign only where a contact comes to
 * rest or is met within the sub-step, and then by at most (h F)^2 / 8m for a force F on a mass m.
 * Moving bodies apart changes their potential energy and, by the move times the momentum, angular
 * momentum; it is the one thing here that does. Impulses of a contact solve that ends without its
 * tolerance are taken in the greatest share that does not raise kinetic energy, unless belts or
 * bodies that move by themselves act.
 *
 * An impact takes place at the midpoint before the surfaces meet: there is no overlap, and the
 * energy of a bounce is exact. Its place and time are early, by up to the way of one sub-step. What
 * flies apart after the last pass of impacts, or was set up too near, may overlap for a sub-step.
 * What a body passes on its first h/2 after it was added or set is not seen.
 *
 * Only what the scene needs is run; tribo_step_info tells what was. The same calls give the same
 * bits, whatever the tasks, and from a saved state on.
 *
 * Body ids are small numbers: the smallest that is free, as in tribo_tree_add; after
 * tribo_scene_remove an id may be given again. One scene is for one thread at a time.
 */
#ifndef TRIBO_SCENE_H
#define TRIBO_SCENE_H

#include <tribo/audit.h>
#include <tribo/shape.h>
#include <tribo/sparse.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A scene; opaque. */
typedef struct tribo_scene tribo_scene;

/* ---- making ---------------------------------------------------------------------------------- */

/** What holds for all of a scene. All zeros but struct_size is the default. */
typedef struct tribo_scene_settings {
    uint32_t struct_size;      /**< sizeof(tribo_scene_settings) */
    uint32_t friction_rule;    /**< TRIBO_MIX_...: mu_s and mu_d of a pair */
    uint32_t restitution_rule; /**< TRIBO_MIX_...: e of a pair */
    uint32_t reserved;         /**< 0 */
    double gravity[3];         /**< m/s^2, world axes; acts on dynamic bodies */
} tribo_scene_settings;

/** Make an empty scene.
 *  @param settings  may be null: defaults
 *  @param allocator copied; may be null: malloc and free
 *  @param scene     receives the scene
 *  @return TRIBO_ERROR_NULL (scene, a function of the allocator), TRIBO_ERROR_STRUCT_SIZE,
 *          TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_scene_create(const tribo_scene_settings *settings,
                                          const tribo_allocator *allocator, tribo_scene **scene);

/** Free it and all that it holds; null is nothing. */
TRIBO_API void tribo_scene_destroy(tribo_scene *scene);

/** What moves a body. */
enum {
    TRIBO_BODY_DYNAMIC = 0,   /**< forces and contacts; it has a mass */
    TRIBO_BODY_KINEMATIC = 1, /**< its own velocities, which nothing changes */
    TRIBO_BODY_STATIC = 2     /**< nothing; its velocities are zero */
};

/** A body of a scene. Fill it by tribo_scene_body_init, then change what differs. */
typedef struct tribo_scene_body {
    uint32_t struct_size; /**< sizeof(tribo_scene_body) */
    uint32_t kind;        /**< TRIBO_BODY_... */
    tribo_body state;     /**< mass, pose, velocities; of a body that is not dynamic, inverse mass
                                  and inertia must be zero */
    tribo_shape shape;    /**< type 0: none, it touches nothing. HALFSPACE and MESH are not for
                                  dynamic bodies. What `data` names must outlive the body */
    tribo_pose offset;    /**< of the shape in the body's axes, origin at the centre of mass */
    tribo_material material; /**< mixed with that of the other body by the rules of the scene */
    double belt[3];  /**< m/s, body axes: velocity of the surface past the body, as that of a
                                  conveyor; what it has along a normal does nothing */
    double rolling;  /**< m, >= 0: length of rolling resistance, as in tribo_system_contact. Of two
                                  bodies the greater counts, for rubber resists on steel as it does
                                  on rubber */
    double spinning; /**< m, >= 0: the same of spinning resistance */
} tribo_scene_body;

/** A dynamic body without shape or mass, at the origin, at rest; friction and restitution 0.
 *  @return TRIBO_ERROR_NULL. */
TRIBO_API tribo_status tribo_scene_body_init(tribo_scene_body *body);

/** Add a body. One that is not dynamic wakes all others, for it may be anywhere.
 *  @param id receives its number
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION (kind), a status of
 *          tribo_body_check, tribo_material_check or tribo_shape_check, TRIBO_ERROR_MASS (dynamic
 *          with zero inverse mass, or not dynamic with another), TRIBO_ERROR_INERTIA (not dynamic
 *          with any, or one that tribo_body_spin refuses), TRIBO_ERROR_SHAPE (HALFSPACE or MESH on
 *          a dynamic body), TRIBO_ERROR_ORIENTATION (offset), TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_FRICTION (a length < 0), TRIBO_ERROR_RANGE (a static body with velocities),
 *          TRIBO_ERROR_SUPPORT, TRIBO_ERROR_CAPACITY (2^30 bodies), TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_scene_add(tribo_scene *scene, const tribo_scene_body *body,
                                       uint32_t *id);

/** Remove a body and its contacts; bodies that it touched wake. Its contacts are not told as ended.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX. */
TRIBO_API tribo_status tribo_scene_remove(tribo_scene *scene, uint32_t id);

/* ---- state ----------------------------------------------------------------------------------- */

/** Number of bodies, and one more than the greatest id in use; each may be null.
 *  @return TRIBO_ERROR_NULL (scene). */
TRIBO_API tribo_status tribo_scene_counts(const tribo_scene *scene, uint32_t *bodies,
                                          uint32_t *end);

/** Pose and velocities of a body, at the end of the last step.
 *  @param asleep receives 1 if it sleeps, else 0; may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX. */
TRIBO_API tribo_status tribo_scene_get_body(const tribo_scene *scene, uint32_t id,
                                            tribo_body *state, uint32_t *asleep);

/** Change pose, velocities or mass of a body. It wakes, and so do those that it touched; if it is
 *  not dynamic, all do. What it touches is found anew.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX, and for the state as in tribo_scene_add. */
TRIBO_API tribo_status tribo_scene_set_body(tribo_scene *scene, uint32_t id,
                                            const tribo_body *state);

/** Force (N) at the centre of mass and torque (N m), world axes, that act on a dynamic body from
 *  now on, until they are set anew. The body wakes if they change.
 *  @param force,torque may be null: zero
 *  @return TRIBO_ERROR_NULL (scene), TRIBO_ERROR_INDEX, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_MASS
 *          (not dynamic). */
TRIBO_API tribo_status tribo_scene_set_force(tribo_scene *scene, uint32_t id, const double force[3],
                                             const double torque[3]);

/** Change gravity; all bodies wake. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_scene_set_gravity(tribo_scene *scene, const double gravity[3]);

/** Momentum about `origin` and kinetic energy of the dynamic bodies.
 *  @param potential receives -sum m g . (x - origin), J; may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_scene_totals(const tribo_scene *scene, const double origin[3],
                                          tribo_totals *totals, double *potential);

/* ---- stepping -------------------------------------------------------------------------------- */

/** Stages to leave out, bits of tribo_step_options.skip. */
enum {
    TRIBO_SKIP_WARM_START = 1,  /**< start solvers from zero */
    TRIBO_SKIP_CORRECTION = 2,  /**< leave overlaps as they are */
    TRIBO_SKIP_RESTITUTION = 4, /**< all impacts are plastic */
    TRIBO_SKIP_SPECULATION = 8  /**< contacts act once surfaces have met, not before */
};

/** Options of a step. All zeros but struct_size is the default. */
typedef struct tribo_step_options {
    uint32_t struct_size;    /**< sizeof(tribo_step_options) */
    uint32_t substeps;       /**< 0 counts as 1; at most 2^20 */
    uint32_t solver;         /**< TRIBO_SOLVER_... */
    uint32_t skip;           /**< TRIBO_SKIP_..., or'ed */
    uint64_t max_iterations; /**< of tribo_system_options; 0: 1000 */
    double tolerance;        /**< the same; 0: 1e-12 */
    double margin;      /**< m: surfaces that are so near count as contacts, even if they do not
                                  come closer. 0: 1/64 of the lesser radius of the two bodies */
    double threshold;   /**< m/s: slower approaches are plastic. 0: what forces add to the
                                  approach in one sub-step */
    double correction;  /**< share of an overlap that one sub-step takes away; 0: 1/4; else in
                                  (0, 1] */
    double sleep_time;  /**< s of rest after which an island sleeps; 0: never */
    double sleep_speed; /**< m/s: rest is |v| + |omega| radius below this */
    uint32_t tasks;     /**< as in tribo_system_options */
    uint32_t reserved;  /**< 0 */
    tribo_parallel_function parallel; /**< may be null */
    void *user;                       /**< handed to parallel */
} tribo_step_options;

/** What a step did, summed over its sub-steps unless stated. Stages that the scene did not need are
 *  zero. */
typedef struct tribo_step_info {
    uint32_t struct_size;       /**< sizeof(tribo_step_info), set by the caller */
    uint32_t substeps;          /**< done */
    uint32_t stop;              /**< worst TRIBO_STOP_... of contact and impact solves */
    uint32_t asleep;            /**< bodies that sleep at the end */
    uint64_t flights;           /**< bodies advanced */
    uint64_t turns;             /**< of these, those that turned */
    uint64_t broad;             /**< sub-steps with a broad phase */
    uint64_t pairs;             /**< pairs of bodies collided */
    uint64_t contacts;          /**< contact points held by the contact solves */
    uint64_t frictionless;      /**< of these, those with one row */
    uint64_t resisting;         /**< of these, those with a length of resistance: six rows */
    uint64_t matched;           /**< of these, those with an impulse of the last sub-step */
    uint64_t contact_solves;    /**< sub-steps with a contact solve */
    uint64_t impact_solves;     /**< sub-steps with an impact solve */
    uint64_t impacts;           /**< contact points that had restitution in one */
    uint64_t correction_solves; /**< sub-steps in which bodies were moved apart */
    uint64_t sweeps;            /**< of tribo_system_info, over all solves */
    uint64_t newton_steps;      /**< the same */
    uint64_t factorizations;    /**< the same */
    double eta;                 /**< greatest of contact and impact solves */
    double restitution;         /**< least share of a restitution stage that the energy allowed; 1
                                   where there was none */
    double penetration;         /**< greatest overlap at a midpoint, m */
} tribo_step_info;

/** Advance the scene by dt seconds.
 *  @param dt      > 0
 *  @param options may be null: defaults
 *  @param info    may be null
 *  @return TRIBO_OK whatever the solvers say: see info->stop; TRIBO_ERROR_NULL,
 *          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_TIME_STEP (dt <= 0, or a body
 *          turns by more than 1e5 radians), TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE (an option,
 *          or a state beyond double), TRIBO_ERROR_SUPPORT, TRIBO_ERROR_CAPACITY (2^31 contacts),
 *          TRIBO_ERROR_MEMORY. With any of them the scene is as it was before the call. */
TRIBO_API tribo_status tribo_scene_step(tribo_scene *scene, double dt,
                                        const tribo_step_options *options, tribo_step_info *info);

/* ---- contacts and events --------------------------------------------------------------------- */

/** A contact point. A is the body with the lesser id. */
typedef struct tribo_scene_contact {
    uint32_t a;       /**< id of body A */
    uint32_t b;       /**< id of body B */
    uint32_t child_a; /**< as in tribo_manifold */
    uint32_t child_b;
    uint64_t id;       /**< which features touch */
    double normal[3];  /**< unit, from B to A */
    double arm_a[3];   /**< from the centre of mass of A to the point, m */
    double arm_b[3];   /**< the same from that of B */
    double distance;   /**< of the surfaces, m; negative inside */
    double impulse[3]; /**< on A, world axes, N s, in the last sub-step; without impacts */
    double torque[3];  /**< of rolling and spinning resistance on A, world axes, N m s, the same */
} tribo_scene_contact;

/** Contact points of the last sub-step, as of its midpoint, sorted by a, b, child_a and child_b.
 *  @param contacts may be null if capacity is 0
 *  @param count    receives their number, also with TRIBO_ERROR_CAPACITY
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_scene_contacts(const tribo_scene *scene, size_t capacity,
                                            tribo_scene_contact *contacts, size_t *count);

/** Kinds of events. */
enum {
    TRIBO_EVENT_BEGIN = 1,   /**< touch in this step, and did not in the last */
    TRIBO_EVENT_PERSIST = 2, /**< in both */
    TRIBO_EVENT_END = 3      /**< in the last step alone */
};

/** What two bodies did to each other in a step. They touch in a step if in a sub-step of it they
 *  exchange an impulse or a distance is not positive. */
typedef struct tribo_scene_event {
    uint32_t kind;     /**< TRIBO_EVENT_... */
    uint32_t a;        /**< id */
    uint32_t b;        /**< id, greater than a */
    uint32_t impacts;  /**< contact points with restitution, over the sub-steps */
    double impulse[3]; /**< on A, world axes, N s: all of the step, impacts included */
    double normal;     /**< sum of the normal impulses, N s */
} tribo_scene_event;

/** Events of the last step, sorted by a and b. At rest the impulses on a body sum up to -m g dt, to
 *  the tolerance of the solver. Bodies asleep tell the impulses of when they went to sleep.
 *  @return as tribo_scene_contacts. */
TRIBO_API tribo_status tribo_scene_events(const tribo_scene *scene, size_t capacity,
                                          tribo_scene_event *events, size_t *count);

/* ---- saving ---------------------------------------------------------------------------------- */

/** Write all of the scene to a block: bodies, contacts, events, settings. It has no pointers but
 *  those of shapes to their data, and is of the machine's byte order.
 *  @param block    aligned for double; may be null if capacity is 0
 *  @param needed   receives the bytes the block needs, also with TRIBO_ERROR_CAPACITY; may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_scene_save(const tribo_scene *scene, void *block, size_t capacity,
                                        size_t *needed);

/** Make the scene what it was when the block was saved, by this scene or another of the same
 *  process: steps from here on give the same bits as they did from there on.
 *  @param size bytes that may be read at `block`
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_DATA (not made by this version, cut off, or changed),
 *          TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_scene_load(tribo_scene *scene, const void *block, size_t size);

#ifdef __cplusplus
}
#endif

#endif
