/* The lane kernels: batch_lanes.c is compiled once per instruction set, and each copy defines one table. */
#ifndef TRIBO_LANES_H
#define TRIBO_LANES_H

#include <tribo/batch.h>

enum { LANES = 8 };

/* All arrays as in batch.h; modes and statuses hold `count` entries and are never null here. Outputs of
 * contacts whose status is not TRIBO_OK are untouched, but for modes, which is scratch there. */
typedef struct lanes_table {
    void (*matrix)(size_t body_count, const tribo_body *bodies, size_t count, const uint32_t *pairs,
                   const tribo_contact *contacts, double *frames, double *w, tribo_status *statuses);
    void (*solve)(size_t count, const double *w, const double *b, const double *mu, double *p,
                  uint32_t *modes, tribo_status *statuses);
    void (*impact)(size_t count, const double *w, const double *u, const tribo_material *pairs,
                   double *p, uint32_t *modes, tribo_status *statuses);
} lanes_table;

extern const lanes_table lanes_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
extern const lanes_table lanes_x86_64_v3;
extern const lanes_table lanes_x86_64_v4;
#endif

/* Judge the bodies of one contact; ends receives A and B (an immovable body stands in for the world). */
tribo_status lanes_check_pair(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
                              const tribo_body *ends[2]);

#endif
