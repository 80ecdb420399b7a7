/**
 * @file condense.h
 * From what a file holds to the form that is solved.
 */
#ifndef TRIBO_CLI_CONDENSE_H
#define TRIBO_CLI_CONDENSE_H

#include "problem.h"
#include "recorded.h"

/** Assemble W by blocks. The global form is reduced: W = H^T M^-1 H, q = H^T M^-1 f + w, by one
 *  elimination for each connected component of M.
 *
 *  M is symmetric by its meaning, up to what an implicit integrator adds to it; some files hold
 *  only one triangle of it, which is then taken for both. W is never made symmetric, but where M is
 *  to the bit, W is computed so, too.
 *
 *  @param size most bytes to use
 *  @return 0, or CLI_BAD_INPUT after a message; then *out is empty */
int condense(const char *file, const recorded *given, size_t size, problem *out);

#endif
