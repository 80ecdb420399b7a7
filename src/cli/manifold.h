/**
 * @file manifold.h
 * Contact manifolds for the demonstration: three pairs of shapes that are drawn, and the methods
 * on the same random boxes: what a manifold costs, and how far it is from the truth.
 */
#ifndef TRIBO_CLI_MANIFOLD_H
#define TRIBO_CLI_MANIFOLD_H

#include <tribo/collide.h>

enum { MANIFOLD_SCENES = 3, MANIFOLD_METHODS = 4, MANIFOLD_PAIRS = 1024 };

/** A pair and its manifold; A, the upper one, is drawn by its edges. */
typedef struct manifold_scene {
    const char *title;
    tribo_shape shapes[2];
    tribo_pose poses[2];
    tribo_manifold manifold;
} manifold_scene;

/** One method on all pairs. */
typedef struct manifold_result {
    const char *name;
    double nanoseconds;                  /**< per pair; least of several runs */
    double median_error, greatest_error; /**< of the depth, relative to it */
    double wrong;  /**< share of normals along which the way is longer than the least by 1 % */
    double points; /**< mean */
} manifold_result;

/** @return TRIBO_OK or the status of the library function that failed. */
tribo_status manifold_scenes(manifold_scene scenes[MANIFOLD_SCENES]);
tribo_status manifold_survey(manifold_result results[MANIFOLD_METHODS]);

#endif
