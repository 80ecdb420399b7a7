/**
 * @file problem.h
 * Recorded frictional-contact problems, from the text format of Siconos or the HDF5 format of
 * FCLib, in the one form in which they are solved.
 */
#ifndef TRIBO_CLI_PROBLEM_H
#define TRIBO_CLI_PROBLEM_H

#include <stddef.h>
#include <stdint.h>

/** u = W r + q, laid out as tribo_system_solve_assembled takes it. W need not be symmetric. */
typedef struct problem {
    size_t count;         /**< contacts, at least 1 */
    uint32_t *row_starts; /**< count + 1 */
    uint32_t *columns;    /**< of the blocks, ascending in each row, the diagonal always there */
    double *blocks;       /**< width 9, row by row; those of zeros only are left out */
    double *q;            /**< width 3 */
    double *mu;           /**< width 2: mu_s and mu_d, which are the same */
} problem;

/** Read a problem. Format and form are recognised from the content. The global form (M, H, f, w) is
 *  reduced: W = H^T M^-1 H, q = H^T M^-1 f + w. Memory is bounded by 512 MiB and 128 times the size
 *  of the file.
 *  @param file "-" for standard input
 *  @return 0, or CLI_BAD_INPUT after one message with the file and the place; then *out is empty */
int problem_read(const char *file, problem *out);

/** Give back what problem_read gave. */
void problem_free(problem *given);

#endif
