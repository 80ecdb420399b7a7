/**
 * @file scene.h
 * Scenes in time whose outcome is known: what `tribo scene` runs by name, and the tests run all.
 *
 * A scene is an entry of a table; tables are grouped by subject, one file each (scenes_*.c). Names
 * begin with the letter of the group: a impacts, b contacts that persist, c many contacts, d the
 * tests of SimBenchmark.
 */
#ifndef TRIBO_CLI_SCENE_H
#define TRIBO_CLI_SCENE_H

#include "world.h"

/** What the tolerance of a scene is a multiple of. */
enum {
    SCENE_ONCE = 0,    /**< of 1: in the unit of the error */
    SCENE_PER_DT = 1,  /**< of the step, s */
    SCENE_PER_EPS = 2, /**< of 2^-52 */
    SCENE_PER_STEP = 3 /**< of 2^-52 times the number of steps in `seconds` */
};

/** What a scene gives. Numbers that it has not are NaN. */
typedef struct scene_answer {
    double metric; /**< the number that the scene is about */
    double exact;  /**< what it should be */
    double error;  /**< how far the motion is from the exact one: |metric - exact| where a scene
                        leaves it NaN and has both */
} scene_answer;

/** A scene. */
typedef struct scene_entry {
    const char *name;    /**< lower case; "b1-incline" */
    const char *what;    /**< what happens, in a line */
    const char *metric;  /**< what is measured, with unit; and the error, if it is another number */
    double dt;           /**< s, of a step, unless the user asks for another */
    double seconds;      /**< s, to run, likewise */
    double test_seconds; /**< s, that a test runs, where that is shorter; else 0 */
    double tolerance;    /**< greatest error of a right run with these options... */
    uint32_t scale;      /**< ...times SCENE_... */
    uint32_t substeps;   /**< 0 counts as 1 */
    uint32_t solver;     /**< TRIBO_SOLVER_... */
    double solver_tolerance; /**< of tribo_step_options; 0: its default */
    const char *reason;      /**< where the tolerance is from */
    const void *given;       /**< for `run`, as w->given: what tells scenes of one kind apart */

    /** Run it in `w`, whose dt, seconds and options are set: world_begin, bodies, world_run. Lines
     *  beside the answer go to w->notes, if there is one. */
    void (*run)(world *w, scene_answer *answer);
} scene_entry;

typedef struct scene_group {
    const char *title;
    size_t count;
    const scene_entry *entries;
} scene_group;

/** All groups. */
enum { SCENE_GROUPS = 8 };
extern const scene_group *const scene_groups[SCENE_GROUPS];
extern const scene_group scenes_impact;   /**< A6 to A10 */
extern const scene_group scenes_slide;    /**< B1 to B6 */
extern const scene_group scenes_limit;    /**< B7, B8, B16: how far bodies stay at rest */
extern const scene_group scenes_rest;     /**< B9, B10, B16, B17: bodies that come to rest */
extern const scene_group scenes_stack;    /**< C2, C3 */
extern const scene_group scenes_spin;     /**< B11 to B15 */
extern const scene_group scenes_units;    /**< B18 */
extern const scene_group scenes_simbench; /**< D1 to D3 */

/** The entry of that name; null if there is none. */
const scene_entry *scene_find(const char *name);

/** A world with the options of the entry. */
world scene_world(const scene_entry *entry);

/** Run a scene, and free what it made. @return TRIBO_OK or the status of the call that failed. */
tribo_status scene_play(const scene_entry *entry, world *w, scene_answer *answer);

/** The greatest error of a right run in that world. */
double scene_tolerance(const scene_entry *entry, const world *w);

/** The greatest |a[i] - b[i]|; NaN if any is. */
double scene_distance(const double *a, const double *b, size_t n);

#endif
