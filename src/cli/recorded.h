/**
 * @file recorded.h
 * A frictional-contact problem as a file holds it, before it is brought into one form.
 *
 * Local form: u = W r + q. Global form: M v = H r + f, u = H^T v + w, with any number of unknowns
 * v. Matrices are lists of entries: sparse files have few of them, and zeros of dense ones are left
 * out.
 */
#ifndef TRIBO_CLI_RECORDED_H
#define TRIBO_CLI_RECORDED_H

#include <stddef.h>
#include <stdint.h>

/** Entries of a matrix in any order. Those at the same place are added up. */
typedef struct entries {
    uint32_t rows, columns;
    size_t count, room;
    uint32_t *places; /**< width 2: row, column */
    double *values;   /**< none is 0 */
} entries;

typedef struct recorded {
    uint32_t contacts;
    uint32_t global; /**< 1: global form */
    entries matrix;  /**< W, or M */
    entries h;       /**< H: unknowns x 3 contacts; empty in local form */
    double *f;       /**< one per unknown; null in local form */
    double *q;       /**< width 3: q, or w of the global form */
    double *mu;      /**< one per contact */
} recorded;

/** Append an entry, unless it is 0. @return -1 if there is not enough memory, else 0. */
int entries_add(entries *matrix, uint32_t row, uint32_t column, double value);

void recorded_free(recorded *given);

#endif
