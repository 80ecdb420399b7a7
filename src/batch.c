#include <tribo/batch.h>

#include "lanes.h"

#include <string.h>

/* ---- instruction sets ------------------------------------------------------------------------ */

#if defined(TRIBO_HAVE_X86_64_LEVELS)
/* What the compiler may use at these levels; a virtual machine can mask any of it. */
static int has_v3(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
}

static int has_v4(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd");
}
#endif

static const lanes_table *table_of(uint32_t isa)
{
    switch (isa) {
    case TRIBO_ISA_BASELINE:
        return &lanes_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
    case TRIBO_ISA_X86_64_V3:
        return has_v3() ? &lanes_x86_64_v3 : NULL;
    case TRIBO_ISA_X86_64_V4:
        return has_v3() && has_v4() ? &lanes_x86_64_v4 : NULL;
#endif
    default:
        return NULL;
    }
}

static uint32_t resolve_isa(uint32_t isa)
{
    if (isa != TRIBO_ISA_BEST) {
        return isa;
    }
    return table_of(TRIBO_ISA_X86_64_V4)   ? TRIBO_ISA_X86_64_V4
           : table_of(TRIBO_ISA_X86_64_V3) ? TRIBO_ISA_X86_64_V3
                                           : TRIBO_ISA_BASELINE;
}

uint32_t tribo_isa_available(uint32_t isa)
{
    return isa == TRIBO_ISA_BEST || isa == TRIBO_ISA_SCALAR || table_of(isa) != NULL;
}

const char *tribo_isa_name(uint32_t isa)
{
    static const char *const names[] = {"best", "scalar", "baseline", "x86-64-v3", "x86-64-v4"};
    return isa < sizeof names / sizeof names[0] ? names[isa] : NULL;
}

/* ---- one contact after the other ------------------------------------------------------------- */

tribo_status lanes_find_pair(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
                             const tribo_body *ends[2])
{
    static const tribo_body world = {.orientation = {1.0, 0.0, 0.0, 0.0}};
    int known = 1;
    for (int i = 0; i < 2; i++) {
        const int inside = pair[i] < body_count;
        known = known && (inside || pair[i] == TRIBO_WORLD);
        ends[i] = inside ? &bodies[pair[i]] : &world;
    }
    if (!known) {
        return TRIBO_ERROR_INDEX;
    }
    return pair[0] == pair[1] && pair[0] != TRIBO_WORLD ? TRIBO_ERROR_ALIAS : TRIBO_OK;
}

static tribo_status matrix_one(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
                               const tribo_contact *contact, double *frame_out, double *w)
{
    const tribo_body *ends[2];
    double frame[9];
    tribo_status status = lanes_find_pair(body_count, bodies, pair, ends);
    if (status == TRIBO_OK) {
        status = tribo_contact_check(contact);
    }
    if (status == TRIBO_OK) {
        status = tribo_basis_from_normal(contact->normal, frame);
    }
    if (status == TRIBO_OK) {
        /* Both ends may be the world, which is one object. */
        status = ends[0] == ends[1] ? TRIBO_ERROR_IMMOVABLE
                                    : tribo_contact_matrix(ends[0], ends[1], contact, frame, w);
    }
    if (status == TRIBO_OK && frame_out) {
        memcpy(frame_out, frame, sizeof frame);
    }
    return status;
}

static tribo_status matrix_scalar(size_t body_count, const tribo_body *bodies, size_t count,
                                  const uint32_t *pairs, const tribo_contact *contacts,
                                  double *frames, double *w, tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        const tribo_status status = matrix_one(body_count, bodies, pairs + 2 * i, contacts + i,
                                               frames ? frames + 9 * i : NULL, w + 6 * i);
        lanes_give(status, 0, i, NULL, statuses, &first);
    }
    return first;
}

void lanes_solve_one(const double *w, const double *b, const double *mu, size_t i, double *p,
                     uint32_t *modes, tribo_status *statuses, tribo_status *first)
{
    tribo_solve_info info = {.struct_size = sizeof info};
    const tribo_status status =
        tribo_contact_solve(w + 6 * i, b + 3 * i, mu[2 * i], mu[2 * i + 1], p + 3 * i, &info);
    const uint32_t mode = status == TRIBO_ERROR_JAM ? TRIBO_MODE_JAM : info.mode;
    lanes_give(status, mode, i, modes, statuses, first);
}

static tribo_status solve_scalar(size_t count, const double *w, const double *b, const double *mu,
                                 double *p, uint32_t *modes, tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        lanes_solve_one(w, b, mu, i, p, modes, statuses, &first);
    }
    return first;
}

void lanes_impact_one(const double *w, const double *u, const tribo_material *pairs, size_t i,
                      double *p, uint32_t *modes, tribo_status *statuses, tribo_status *first)
{
    /* No more than the mode is asked for: whether u+ and the energy are within double is not
     * judged. */
    tribo_impact_info info = {.struct_size = offsetof(tribo_impact_info, velocity)};
    const tribo_status status =
        tribo_impact(w + 6 * i, u + 3 * i, pairs + i, NULL, p + 3 * i, &info);
    lanes_give(status, info.mode, i, modes, statuses, first);
}

static tribo_status impact_scalar(size_t count, const double *w, const double *u,
                                  const tribo_material *pairs, double *p, uint32_t *modes,
                                  tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        lanes_impact_one(w, u, pairs, i, p, modes, statuses, &first);
    }
    return first;
}

static const lanes_table scalar = {matrix_scalar, solve_scalar, impact_scalar};

/* ---- the calls ------------------------------------------------------------------------------- */

static tribo_status find_table(uint32_t isa, const lanes_table **table)
{
    if (!tribo_isa_name(isa)) {
        return TRIBO_ERROR_OPTION;
    }
    if (!tribo_isa_available(isa)) {
        return TRIBO_ERROR_ISA;
    }
    *table = isa == TRIBO_ISA_SCALAR ? &scalar : table_of(resolve_isa(isa));
    return TRIBO_OK;
}

tribo_status tribo_batch_matrix(uint32_t isa, size_t body_count, const tribo_body *bodies,
                                size_t count, const uint32_t *pairs, const tribo_contact *contacts,
                                double *frames, double *w, tribo_status *statuses)
{
    if ((count > 0 && (!pairs || !contacts || !w)) || (body_count > 0 && !bodies)) {
        return TRIBO_ERROR_NULL;
    }
    const lanes_table *table;
    const tribo_status status = find_table(isa, &table);
    return status != TRIBO_OK
               ? status
               : table->matrix(body_count, bodies, count, pairs, contacts, frames, w, statuses);
}

tribo_status tribo_batch_solve(uint32_t isa, size_t count, const double *w, const double *b,
                               const double *mu, double *p, uint32_t *modes, tribo_status *statuses)
{
    if (count > 0 && (!w || !b || !mu || !p)) {
        return TRIBO_ERROR_NULL;
    }
    const lanes_table *table;
    const tribo_status status = find_table(isa, &table);
    return status != TRIBO_OK ? status : table->solve(count, w, b, mu, p, modes, statuses);
}

tribo_status tribo_batch_impact(uint32_t isa, size_t count, const double *w, const double *u,
                                const tribo_material *pairs, double *p, uint32_t *modes,
                                tribo_status *statuses)
{
    if (count > 0 && (!w || !u || !pairs || !p)) {
        return TRIBO_ERROR_NULL;
    }
    const lanes_table *table;
    const tribo_status status = find_table(isa, &table);
    return status != TRIBO_OK ? status : table->impact(count, w, u, pairs, p, modes, statuses);
}
