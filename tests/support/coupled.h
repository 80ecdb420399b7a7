/**
 * @file coupled.h
 * The problem that the solvers of a system share (src/system.h), made of scenes or blocks: for
 * tests and benches of a solver by itself.
 */
#ifndef TRIBO_TESTS_COUPLED_H
#define TRIBO_TESTS_COUPLED_H

#include "../../src/system.h"
#include "systems.h"

/** A problem with the arrays that it points to; free it with coupled_free. */
typedef struct coupled {
    system_problem problem;
    double *free_velocity; /**< width 6 per body: without impulses */
    void *memory;
} coupled;

void coupled_of_scene(const systems_scene *scene, coupled *out);
/** The blocks are not copied. dense: from systems_dense, in place of the sparse ones; or null. */
void coupled_of_blocks(const systems_blocks *blocks, const double *dense, coupled *out);
void coupled_free(coupled *c);

#endif
