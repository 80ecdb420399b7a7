/* Dense factorisations of small systems: Newton without a sparse library.
 *
 * A matrix is stored row by row, dense_stride(n) numbers a row; what lies beyond the n-th number of
 * a row is scratch. Whatever isa is, each number goes through the same operations in the same
 * order, so no bit depends on it. isa is one of TRIBO_ISA_..., available here; SCALAR counts as
 * BASELINE. n may be 0. */
#ifndef TRIBO_DENSE_H
#define TRIBO_DENSE_H

#include <tribo/batch.h>

/* Numbers from one row to the next: at least n, and such that columns spread over the cache. */
static inline size_t dense_stride(uint32_t n)
{
    return (((size_t)n + 7) / 16) * 16 + 8;
}

/* Cholesky factor U of A = U^T U, A positive definite, in place: entries (i, j) with j >= i are
 * read and become U, the reciprocal of U_ii standing on the diagonal; those with j < i are scratch.
 * Returns 0 if a pivot is not positive and finite. */
int dense_cholesky(uint32_t isa, uint32_t n, double *a);

/* Solve U^T U x = b with the factor of dense_cholesky; x holds b. */
void dense_cholesky_solve(uint32_t isa, uint32_t n, const double *a, double *x);

/* LU factors of P A, in place, partial pivoting by rows: L has ones on its diagonal, the
 * reciprocal of U_ii stands on the diagonal of U. pivots: n row numbers. Returns 0 if A is singular
 * (a pivot is zero, or not finite). */
int dense_lu(uint32_t isa, uint32_t n, double *a, uint32_t *pivots);

/* Solve A x = b with the factors of dense_lu; x holds b. */
void dense_lu_solve(uint32_t isa, uint32_t n, const double *a, const uint32_t *pivots, double *x);

/* The same, compiled once per instruction set. */
typedef struct dense_table {
    int (*cholesky)(uint32_t n, double *a);
    void (*cholesky_solve)(uint32_t n, const double *a, double *x);
    int (*lu)(uint32_t n, double *a, uint32_t *pivots);
    void (*lu_solve)(uint32_t n, const double *a, const uint32_t *pivots, double *x);
} dense_table;

extern const dense_table dense_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
extern const dense_table dense_x86_64_v3;
extern const dense_table dense_x86_64_v4;
#endif

#endif
