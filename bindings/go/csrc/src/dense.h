/* Factorisations of small or narrow matrices, row by row: Newton without a sparse library.
 *
 * Entry (i, j) is a[i * stride + j], and 0 where |i - j| > band. Of narrow matrices only what is
 * near the diagonal is kept: a points `origin` numbers into the memory, and all of it that is
 * beyond the band is 0 before. Of others, what lies beyond the n-th number of a row is scratch.
 * Whatever isa is, each number goes through the same operations in the same order, so no bit
 * depends on it. isa is one of TRIBO_ISA_..., available here; SCALAR counts as BASELINE. n may be
 * 0. */
#ifndef TRIBO_DENSE_H
#define TRIBO_DENSE_H

#include <tribo/batch.h>

typedef struct dense_shape {
    uint32_t n, band;
    size_t stride, origin;
    size_t numbers; /* all that there are in memory */
} dense_shape;

/* Numbers from one whole row to the next: at least n, and such that columns spread over the cache.
 */
static inline size_t dense_stride(uint32_t n)
{
    return (((size_t)n + 7) / 16) * 16 + 8;
}

/* With room for what pivots bring beyond the band, and for blocks of eight. */
static inline dense_shape dense_shape_of(uint32_t n, uint32_t band)
{
    const size_t whole = dense_stride(n);
    const size_t narrow = 3 * (size_t)band + 21;
    const dense_shape all = {n, band, whole, 0, n * whole};
    const dense_shape near = {n, band, narrow, (size_t)band + 7, n * (narrow + 1)};

    return narrow < whole ? near : all;
}

/* Cholesky factor U of A = U^T U, A positive definite, in place: entries (i, j) with j >= i are
 * read and become U, the reciprocal of U_ii standing on the diagonal; those with j < i are scratch.
 * Returns 0 if a pivot is not positive and finite. */
int dense_cholesky(uint32_t isa, const dense_shape *shape, double *a);

/* Solve U^T U x = b with the factor of dense_cholesky; x holds b. */
void dense_cholesky_solve(uint32_t isa, const dense_shape *shape, const double *a, double *x);

/* LU factors of A in place, partial pivoting by rows. L has ones on its diagonal; each eight columns
 * of it stay as they are once they are complete, whatever rows are exchanged later. The reciprocal
 * of U_ii stands on the diagonal of U. pivots: n row numbers. Returns 0 if A is singular (a pivot is
 * zero, or not finite). */
int dense_lu(uint32_t isa, const dense_shape *shape, double *a, uint32_t *pivots);

/* Solve A x = b with the factors of dense_lu; x holds b. */
void dense_lu_solve(uint32_t isa, const dense_shape *shape, const double *a, const uint32_t *pivots,
                    double *x);

/* The same, compiled once per instruction set. */
typedef struct dense_table {
    int (*cholesky)(const dense_shape *shape, double *a);
    void (*cholesky_solve)(const dense_shape *shape, const double *a, double *x);
    int (*lu)(const dense_shape *shape, double *a, uint32_t *pivots);
    void (*lu_solve)(const dense_shape *shape, const double *a, const uint32_t *pivots, double *x);
    /* sum += L^T D R: L and R have 3 rows of 12, D 3 x 3, sum 12 x 12. */
    void (*add_product)(const double *restrict left, const double d[9],
                        const double *restrict right, double *restrict sum);
} dense_table;

const dense_table *dense_table_of(uint32_t isa);

extern const dense_table dense_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
extern const dense_table dense_x86_64_v3;
extern const dense_table dense_x86_64_v4;
#endif

#endif
