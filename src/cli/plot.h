/**
 * @file plot.h
 * Pictures (SVG) of the demonstration, drawn by gnuplot.
 */
#ifndef TRIBO_CLI_PLOT_H
#define TRIBO_CLI_PLOT_H

#include "manifold.h"
#include "stack.h"
#include "survey.h"
#include "throw.h"

/** 1 if gnuplot can be run. */
int plot_available(void);

/** The paths of the thrown box under each law, from the side and from above. Each of these writes
 * `name` into `folder` and returns 0, or an exit status after a message. */
int plot_throws(const char *folder, const char *name, const throw_record *records);

/** The impulses of the first impact under each law, in the friction cone. */
int plot_cone(const char *folder, const char *name, const throw_record *records);

/** Speed against error of the laws. */
int plot_survey(const char *folder, const char *name, const survey_result *results);

/** The manifolds of the scenes: shapes, contact points and normals, seen from above the side. */
int plot_manifolds(const char *folder, const char *name, const manifold_scene *scenes);

/** Speed against error of the solvers, a panel for each scene of many contacts. */
int plot_stacks(const char *folder, const char *name, const stack_result *results);

#endif
