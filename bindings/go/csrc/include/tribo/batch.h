/**
 * @file batch.h
 * The contact matrix, the exact solve and the ALGEBRAIC law over flat arrays, eight contacts at a
 * time.
 *
 * Results are the same bits as those of the scalar functions in contact.h, on every instruction
 * set. Contacts do not influence each other; sharing out ranges of contacts among threads changes
 * no bit.
 *
 * Arrays are contact-major: entry k of contact i stands at array[i * width + k], width as stated.
 * Each contact has its own status: where it is not TRIBO_OK, the outputs of that contact are
 * untouched and all other contacts are still done.
 */
#ifndef TRIBO_BATCH_H
#define TRIBO_BATCH_H

#include <tribo/contact.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Instruction sets. The same source file is compiled once for each. */
enum {
    TRIBO_ISA_BEST = 0,      /**< the best one that this machine has */
    TRIBO_ISA_SCALAR = 1,    /**< one contact after the other by the functions of contact.h */
    TRIBO_ISA_BASELINE = 2,  /**< lanes with what every machine of this architecture has */
    TRIBO_ISA_X86_64_V3 = 3, /**< AVX2 */
    TRIBO_ISA_X86_64_V4 = 4  /**< AVX-512 */
};

/** Body index that means the immovable world. */
#define TRIBO_WORLD UINT32_MAX

/** 1 if this machine and this build have the instruction set, else 0. */
TRIBO_API uint32_t tribo_isa_available(uint32_t isa);

/** "best", "scalar", "baseline", "x86-64-v3", "x86-64-v4"; null for any other number. Static
 *  string. */
TRIBO_API const char *tribo_isa_name(uint32_t isa);

/** Frames and contact matrices of `count` contacts.
 *  @param isa        TRIBO_ISA_...
 *  @param bodies     body_count bodies; each body that is used is judged as by tribo_body_check
 *  @param pairs      width 2: indices of bodies A and B, or TRIBO_WORLD
 *  @param contacts   count contacts
 *  @param frames     width 9: receives the frames of tribo_basis_from_normal; may be null
 *  @param w          width 6: receives the matrices, as tribo_contact_matrix gives them
 *  @param statuses   width 1: receives a status per contact (TRIBO_ERROR_INDEX for a bad index,
 *                    TRIBO_ERROR_ALIAS for the same body twice); may be null
 *  @return TRIBO_OK; the first status that is not TRIBO_OK by contact order; or, with nothing done,
 *          TRIBO_ERROR_NULL (arrays may be null if count is 0), TRIBO_ERROR_OPTION,
 *          TRIBO_ERROR_ISA. */
TRIBO_API tribo_status tribo_batch_matrix(uint32_t isa, size_t body_count, const tribo_body *bodies,
                                          size_t count, const uint32_t *pairs,
                                          const tribo_contact *contacts, double *frames, double *w,
                                          tribo_status *statuses);

/** Exact solve of `count` contacts: tribo_contact_solve on each.
 *  @param w        width 6
 *  @param b        width 3
 *  @param mu       width 2: mu_s, mu_d
 *  @param p        width 3: receives impulses
 *  @param modes    width 1: receives TRIBO_MODE_...; JAM where the status is TRIBO_ERROR_JAM; may
 *                  be null
 *  @param statuses as in tribo_batch_matrix
 *  @return as tribo_batch_matrix. */
TRIBO_API tribo_status tribo_batch_solve(uint32_t isa, size_t count, const double *w,
                                         const double *b, const double *mu, double *p,
                                         uint32_t *modes, tribo_status *statuses);

/** ALGEBRAIC impact of `count` contacts: tribo_impact with default options, and without info, on
 *  each.
 *  @param u     width 3: relative velocities before
 *  @param pairs count coefficients of pairs
 *  @param p     width 3: receives impulses
 *  @param modes as in tribo_batch_solve
 *  @return as tribo_batch_matrix. */
TRIBO_API tribo_status tribo_batch_impact(uint32_t isa, size_t count, const double *w,
                                          const double *u, const tribo_material *pairs, double *p,
                                          uint32_t *modes, tribo_status *statuses);

#ifdef __cplusplus
}
#endif

#endif
