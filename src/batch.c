#include <tribo/batch.h>

#include "lanes.h"
#include "solve.h"

enum { CHUNK = 256 }; /* modes and statuses that the caller does not want go to a buffer of this size */

/* ---- instruction sets ------------------------------------------------------------------------ */

static const lanes_table *table_of(uint32_t isa)
{
    switch (isa) {
    case TRIBO_ISA_BASELINE:
        return &lanes_baseline;
#if defined(TRIBO_HAVE_X86_64_LEVELS)
    case TRIBO_ISA_X86_64_V3:
        return __builtin_cpu_supports("avx2") ? &lanes_x86_64_v3 : NULL;
    case TRIBO_ISA_X86_64_V4:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                       __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")
                   ? &lanes_x86_64_v4
                   : NULL;
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

static tribo_status check_isa(uint32_t isa)
{
    if (!tribo_isa_name(isa)) {
        return TRIBO_ERROR_OPTION;
    }
    return tribo_isa_available(isa) ? TRIBO_OK : TRIBO_ERROR_ISA;
}

/* ---- one contact after the other ------------------------------------------------------------- */

tribo_status lanes_check_pair(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
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
    if (pair[0] == pair[1] && pair[0] != TRIBO_WORLD) {
        return TRIBO_ERROR_ALIAS;
    }
    const tribo_status status = tribo_body_check(ends[0]);
    return status == TRIBO_OK ? tribo_body_check(ends[1]) : status;
}

static void matrix_one(size_t body_count, const tribo_body *bodies, const uint32_t pair[2],
                       const tribo_contact *contact, double *frame_out, double *w,
                       tribo_status *status)
{
    const tribo_body *ends[2];
    double frame[9];
    *status = lanes_check_pair(body_count, bodies, pair, ends);
    if (*status == TRIBO_OK) {
        *status = tribo_contact_check(contact);
    }
    if (*status == TRIBO_OK) {
        tribo_basis_from_normal(contact->normal, frame);
        /* Both ends may be the world, which is one object. */
        *status = ends[0] == ends[1] ? TRIBO_ERROR_IMMOVABLE
                                     : tribo_contact_matrix(ends[0], ends[1], contact, frame, w);
    }
    if (*status == TRIBO_OK && frame_out) {
        memcpy(frame_out, frame, sizeof frame);
    }
}

static void solve_one(const double *w, const double *b, const double *mu, double *p, uint32_t *mode,
                      tribo_status *status)
{
    tribo_solve_info info = {.struct_size = sizeof info};
    *status = tribo_contact_solve(w, b, mu[0], mu[1], p, &info);
    *mode = *status == TRIBO_ERROR_JAM ? TRIBO_MODE_JAM : info.mode;
}

static void impact_one(const double *w, const double *u, const tribo_material *pair, double *p,
                       uint32_t *mode, tribo_status *status)
{
    tribo_impact_info info = {.struct_size = sizeof info};
    *status = tribo_impact(w, u, pair, NULL, p, &info);
    *mode = info.mode;
}

/* ---- what the calls share -------------------------------------------------------------------- */

/* Modes and statuses of one chunk to the caller; keeps the first fault. Modes of faulty contacts stay as
 * they were, but for JAM. */
static void give_chunk(size_t count, const uint32_t *mode, const tribo_status *status,
                       uint32_t *modes, tribo_status *statuses, tribo_status *first)
{
    for (size_t i = 0; i < count; i++) {
        const int has_mode = status[i] == TRIBO_OK || status[i] == TRIBO_ERROR_JAM;
        if (modes && has_mode) {
            modes[i] = mode[i];
        }
        if (statuses) {
            statuses[i] = status[i];
        }
        if (*first == TRIBO_OK) {
            *first = status[i];
        }
    }
}

tribo_status tribo_batch_matrix(uint32_t isa, size_t body_count, const tribo_body *bodies,
                                size_t count, const uint32_t *pairs, const tribo_contact *contacts,
                                double *frames, double *w, tribo_status *statuses)
{
    if ((count > 0 && (!pairs || !contacts || !w)) || (body_count > 0 && !bodies)) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status isa_status = check_isa(isa);
    if (isa_status != TRIBO_OK) {
        return isa_status;
    }
    const lanes_table *table = table_of(resolve_isa(isa));
    tribo_status first = TRIBO_OK;
    for (size_t done = 0; done < count; done += CHUNK) {
        const size_t here = count - done < CHUNK ? count - done : CHUNK;
        tribo_status status[CHUNK];
        const uint32_t *pair = pairs + 2 * done;
        double *frame = frames ? frames + 9 * done : NULL;
        if (table) {
            table->matrix(body_count, bodies, here, pair, contacts + done, frame, w + 6 * done,
                          status);
        }
        for (size_t i = 0; !table && i < here; i++) {
            matrix_one(body_count, bodies, pair + 2 * i, contacts + done + i,
                       frame ? frame + 9 * i : NULL, w + 6 * (done + i), status + i);
        }
        give_chunk(here, NULL, status, NULL, statuses ? statuses + done : NULL, &first);
    }
    return first;
}

tribo_status tribo_batch_solve(uint32_t isa, size_t count, const double *w, const double *b,
                               const double *mu, double *p, uint32_t *modes, tribo_status *statuses)
{
    if (count > 0 && (!w || !b || !mu || !p)) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status isa_status = check_isa(isa);
    if (isa_status != TRIBO_OK) {
        return isa_status;
    }
    const lanes_table *table = table_of(resolve_isa(isa));
    tribo_status first = TRIBO_OK;
    for (size_t done = 0; done < count; done += CHUNK) {
        const size_t here = count - done < CHUNK ? count - done : CHUNK;
        uint32_t mode[CHUNK];
        tribo_status status[CHUNK];
        if (table) {
            table->solve(here, w + 6 * done, b + 3 * done, mu + 2 * done, p + 3 * done, mode,
                         status);
        }
        for (size_t i = done; !table && i < done + here; i++) {
            solve_one(w + 6 * i, b + 3 * i, mu + 2 * i, p + 3 * i, mode + i - done,
                      status + i - done);
        }
        give_chunk(here, mode, status, modes ? modes + done : NULL,
                   statuses ? statuses + done : NULL, &first);
    }
    return first;
}

tribo_status tribo_batch_impact(uint32_t isa, size_t count, const double *w, const double *u,
                                const tribo_material *pairs, double *p, uint32_t *modes,
                                tribo_status *statuses)
{
    if (count > 0 && (!w || !u || !pairs || !p)) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status isa_status = check_isa(isa);
    if (isa_status != TRIBO_OK) {
        return isa_status;
    }
    const lanes_table *table = table_of(resolve_isa(isa));
    tribo_status first = TRIBO_OK;
    for (size_t done = 0; done < count; done += CHUNK) {
        const size_t here = count - done < CHUNK ? count - done : CHUNK;
        uint32_t mode[CHUNK];
        tribo_status status[CHUNK];
        if (table) {
            table->impact(here, w + 6 * done, u + 3 * done, pairs + done, p + 3 * done, mode,
                          status);
        }
        for (size_t i = done; !table && i < done + here; i++) {
            impact_one(w + 6 * i, u + 3 * i, pairs + i, p + 3 * i, mode + i - done,
                       status + i - done);
        }
        give_chunk(here, mode, status, modes ? modes + done : NULL,
                   statuses ? statuses + done : NULL, &first);
    }
    return first;
}
