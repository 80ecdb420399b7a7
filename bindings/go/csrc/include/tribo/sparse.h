/**
 * @file sparse.h
 * Sparse factorisations for the Newton solvers of system.h, on SuiteSparse. Part of libtribo (not
 * of libtribo_core).
 *
 * Symmetric matrices go to CHOLMOD (Chen, Davis, Hager & Rajamanickam, ACM TOMS 35 (2008) 22),
 * others to KLU (Davis & Palamadai Natarajan, ACM TOMS 37 (2010) 36) or UMFPACK (Davis, ACM TOMS 30
 * (2004) 196), all ordered by AMD; large symmetric ones by nested dissection where that takes fewer
 * operations. The analysis of a pattern is kept as long as matrices of the same pattern follow.
 *
 * Licences: CHOLMOD's simplicial part and KLU are under the LGPL, CHOLMOD's supernodal part and
 * UMFPACK under the GPL; a program that is linked with them is bound by these. tribo itself is not.
 *
 * Bits: the supernodal part and UMFPACK call the BLAS of the machine, which may round otherwise on
 * another one. TRIBO_SPARSE_SIMPLICIAL calls none.
 *
 * Memory: SuiteSparse takes its own from the functions that its SuiteSparse_config names, malloc by
 * default; these are of the whole process. What tribo takes itself comes from the allocator given.
 *
 * Threads: one object is for one thread at a time; any number of objects may be at work at once.
 * CHOLMOD's supernodal part may start threads of OpenMP, and a threaded BLAS its own;
 * OMP_THREAD_LIMIT=1 in the environment keeps the former off: faster where all cores are busy.
 */
#ifndef TRIBO_SPARSE_H
#define TRIBO_SPARSE_H

#include <tribo/system.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Memory for `size` bytes (never 0), aligned for any type; null if there is none. */
typedef void *(*tribo_allocate_function)(void *user, size_t size);

/** Take back what allocate gave (never null). */
typedef void (*tribo_release_function)(void *user, void *memory);

/** Where libtribo takes memory from. */
typedef struct tribo_allocator {
    uint32_t struct_size; /**< sizeof(tribo_allocator) */
    uint32_t reserved;    /**< 0 */
    tribo_allocate_function allocate;
    tribo_release_function release;
    void *user; /**< handed to both functions */
} tribo_allocator;

/** Which of SuiteSparse's methods. */
enum {
    TRIBO_SPARSE_AUTO = 0,       /**< the faster one, judged by operations for each number in the
                                      factors */
    TRIBO_SPARSE_SIMPLICIAL = 1, /**< CHOLMOD simplicial, KLU: best where factors stay thin */
    TRIBO_SPARSE_SUPERNODAL = 2  /**< CHOLMOD supernodal, UMFPACK: best where they fill up */
};

/** Factors of the last matrix, and the analysis of the last pattern. */
typedef struct tribo_sparse tribo_sparse;

/** What a tribo_sparse has done. */
typedef struct tribo_sparse_info {
    uint32_t struct_size;    /**< sizeof(tribo_sparse_info), set by the caller */
    uint32_t method;         /**< SIMPLICIAL or SUPERNODAL: of the last matrix; AUTO: none yet */
    uint64_t factorizations; /**< matrices factored, singular ones counted */
    uint64_t analyses;       /**< patterns analysed */
    uint64_t solves;         /**< right-hand sides */
    uint64_t bytes;          /**< of memory held now, SuiteSparse's part included */
    uint64_t fill;           /**< numbers in the factors of the last matrix, those of L or of L and
                                  U */
} tribo_sparse_info;

/** Make one.
 *  @param method    TRIBO_SPARSE_...
 *  @param allocator copied; may be null: malloc and free
 *  @param sparse    receives the object
 *  @return TRIBO_ERROR_NULL (sparse, a function of the allocator), TRIBO_ERROR_STRUCT_SIZE,
 *          TRIBO_ERROR_OPTION, TRIBO_ERROR_MEMORY. */
TRIBO_API tribo_status tribo_sparse_create(uint32_t method, const tribo_allocator *allocator,
                                           tribo_sparse **sparse);

/** Free it and all that it holds; null is nothing. */
TRIBO_API void tribo_sparse_destroy(tribo_sparse *sparse);

/** The object as tribo_system_options.linear takes it; it must outlive `linear`.
 *
 *  factor: TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX (singular, not positive definite, or not finite:
 *  there are no factors then), TRIBO_ERROR_MEMORY, TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY (2^31 - 1
 *  entries or rows, or more), TRIBO_ERROR_INDEX (rows that do not follow each other, columns that
 *  do not rise or lie outside, or above the diagonal if symmetric). An unsymmetric matrix is solved
 *  with one step of iterative refinement, which reads the arrays given to factor.
 *
 *  solve: TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX (no factors), TRIBO_ERROR_MEMORY, TRIBO_ERROR_NULL.
 *
 *  sign: TRIBO_OK (1 for a symmetric matrix, and for one without rows); otherwise as solve, and
 *  *sign is left as it is.
 *
 *  @param linear struct_size set by the caller; where it ends before `sign`, that is not given
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE (neither of the two). */
TRIBO_API tribo_status tribo_sparse_linear(tribo_sparse *sparse, tribo_linear *linear);

/** Tell what it has done.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE. */
TRIBO_API tribo_status tribo_sparse_report(const tribo_sparse *sparse, tribo_sparse_info *info);

#ifdef __cplusplus
}
#endif

#endif
