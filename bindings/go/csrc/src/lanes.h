/* The lane kernels: batch_lanes.c is compiled once per instruction set, and each copy defines one
 * table. */
#ifndef TRIBO_LANES_H
#define TRIBO_LANES_H

#include <tribo/batch.h>

enum { LANES = 8 };

/* All arrays as in batch.h, and so are null pointers. Each returns the first status that is not
 * TRIBO_OK. */
typedef struct lanes_table {
    tribo_status (*matrix)(size_t body_count, const tribo_body *bodies, size_t count,
                           const uint32_t *pairs, const tribo_contact *contacts, double *frames,
                           double *w, tribo_status *statuses);
    tribo_status (*solve)(size_t count, const double *w, const double *b, const double *mu,
                          double *p, uint32_t *modes, tribo_status *statuses);
    tribo_status (*impact)(size_t count, const double *w, const double *u,
                           const tribo_material *pairs, double *p, uint32_t *modes,
                           tribo_status *statuses);
} lanes_table;

extern const lanes_table lanes_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
extern const lanes_table lanes_x86_64_v3;
extern const lanes_table lanes_x86_64_v4;
#endif

/* One contact's outcome to the arrays that the caller wants. */
static inline void lanes_give(tribo_status status, uint32_t mode, size_t i, uint32_t *modes,
                              tribo_status *statuses, tribo_status *first)
{
    if (modes && (status == TRIBO_OK || status == TRIBO_ERROR_JAM)) {
        modes[i] = mode;
    }
    if (statuses) {
        statuses[i] = status;
    }
    *first = *first == TRIBO_OK ? status : *first;
}

/* Find the bodies of one contact; ends receives A and B (an immovable body stands in for the
 * world). TRIBO_ERROR_INDEX or TRIBO_ERROR_ALIAS if that cannot be. */
tribo_status lanes_find_pair(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
                             const tribo_body *ends[2]);

/* Contact i alone, by the functions of contact.h: the scalar loop, and lanes that want a closer
 * look. */
void lanes_solve_one(const double *w, const double *b, const double *mu, size_t i, double *p,
                     uint32_t *modes, tribo_status *statuses, tribo_status *first);
void lanes_impact_one(const double *w, const double *u, const tribo_material *pairs, size_t i,
                      double *p, uint32_t *modes, tribo_status *statuses, tribo_status *first);

#endif
