/**
 * @file simbench.h
 * The four tests of SimBenchmark beside its published figures: `tribo scene simbench`.
 */
#ifndef TRIBO_CLI_SIMBENCH_H
#define TRIBO_CLI_SIMBENCH_H

#include <tribo/scene.h>

/** Print a table for each test: published errors and real-time factors, and those of its scene.
 *  @param least   s: steps below are left out; the only one of a test, where all of others are
 *  @param options solver and tolerance are taken
 *  @return TRIBO_OK or the status of the call that failed. */
tribo_status simbench_run(double least, const tribo_step_options *options);

#endif
