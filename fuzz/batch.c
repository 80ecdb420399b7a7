/* Properties of include/tribo/batch.h: the same bits as one contact after the other. */
#include <math.h>
#include <string.h>

#include "support/reference.h"

enum { CONTACTS = 41, BODIES = 7, SETS = 5, GUARD = 3 };

/* ---- contact matrices --------------------------------------------------------------------- */

typedef struct matrices {
    tribo_body bodies[BODIES];
    uint32_t pairs[2 * CONTACTS];
    tribo_contact contacts[CONTACTS];
    double frames[9 * (CONTACTS + GUARD)];
    double w[6 * (CONTACTS + GUARD)];
    tribo_status statuses[CONTACTS + GUARD];
    tribo_status result;
} matrices;

/* Mostly valid, some with faults. */
static void make_contact(property_trial *t, uint32_t faults, matrices *m, uint32_t i)
{
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t index = make_byte(t) % (BODIES + 2);
        m->pairs[2 * i + k] = index < BODIES ? index : TRIBO_WORLD;
    }
    make_normal(t, NULL, m->contacts[i].normal);
    make_vector(t, NULL, -4, 4, m->contacts[i].arm_a);
    make_vector(t, NULL, -4, 4, m->contacts[i].arm_b);
    if (make_byte(t) % 8 < faults) {
        const uint8_t kind = make_byte(t) % 4;
        if (kind == 0) {
            m->pairs[2 * i + 1] = BODIES + (uint32_t)make_bits(t, 3);
        } else if (kind == 1) {
            ((double *)&m->contacts[i])[make_byte(t) % 9] = make_hostile(t, NULL);
        } else if (kind == 2) {
            m->contacts[i].normal[0] += 1e-3;
        } else {
            m->contacts[i].arm_a[0] = 1e200;
        }
    }
}

static uint32_t make_contacts(property_trial *t, matrices *m)
{
    double half[3];
    const uint32_t count = make_choice(t, "count", CONTACTS);
    const uint32_t faults = make_choice(t, "faults", 3);
    const uint32_t kind = make_choice(t, "bodies", 3);
    property_expand(t);
    for (uint32_t i = 0; i < BODIES; i++) {
        make_body(t, "body", kind, &m->bodies[i], half);
        if (faults == 2 && make_byte(t) % 8 == 1) {
            ((double *)&m->bodies[i])[make_byte(t) % 20] = make_any(t, NULL);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        make_contact(t, faults, m, i);
    }
    canary_set(m->frames, sizeof m->frames);
    canary_set(m->w, sizeof m->w);
    canary_set(m->statuses, sizeof m->statuses);
    return count;
}

/* What batch.h says of one contact, by the functions of contact.h. */
static tribo_status matrix_alone(const matrices *m, uint32_t i, double *frame, double *w)
{
    static const tribo_body world = {.orientation = {1, 0, 0, 0}};
    const tribo_body *body[2];
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t index = m->pairs[2 * i + k];
        if (index != TRIBO_WORLD && index >= BODIES) {
            return TRIBO_ERROR_INDEX;
        }
        body[k] = index == TRIBO_WORLD ? NULL : &m->bodies[index];
    }
    if (body[0] != NULL && body[0] == body[1]) {
        return TRIBO_ERROR_ALIAS;
    }
    double basis[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double matrix[6];
    tribo_basis_from_normal(m->contacts[i].normal, basis); /* a bad normal is judged below */
    const tribo_status status = tribo_contact_matrix(body[0] != NULL ? body[0] : &world, body[1],
                                                     &m->contacts[i], basis, matrix);
    if (status == TRIBO_OK) {
        memcpy(frame, basis, sizeof basis);
        memcpy(w, matrix, sizeof matrix);
    }
    return status;
}

static void matrices_alone(matrices *m, uint32_t count)
{
    m->result = TRIBO_OK;
    for (uint32_t i = 0; i < count; i++) {
        m->statuses[i] = matrix_alone(m, i, m->frames + 9 * i, m->w + 6 * i);
        if (m->result == TRIBO_OK) {
            m->result = m->statuses[i];
        }
    }
}

/* Every set, every count: frames, matrices, statuses, and what stays untouched. */
static void matrix_same(property_trial *t)
{
    static matrices given;
    static matrices want;
    static matrices got;
    memset(&given, 0, sizeof given);
    const uint32_t count = make_contacts(t, &given);
    want = given;
    matrices_alone(&want, count);
    for (uint32_t isa = 0; isa < SETS; isa++) {
        if (!tribo_isa_available(isa)) {
            continue;
        }
        got = given;
        got.result = tribo_batch_matrix(isa, BODIES, got.bodies, count, got.pairs, got.contacts,
                                        got.frames, got.w, got.statuses);
        REQUIRE_STATUS(t, got.result, want.result);
        for (uint32_t i = 0; i < count; i++) {
            REQUIRE_STATUS(t, got.statuses[i], want.statuses[i]);
        }
        REQUIRE_SAME(t, &got, &want, sizeof got);
        memcpy(got.w, given.w, sizeof got.w);
        REQUIRE_STATUS(t,
                       tribo_batch_matrix(isa, BODIES, got.bodies, count, got.pairs, got.contacts,
                                          NULL, got.w, NULL),
                       want.result);
        REQUIRE_SAME(t, got.w, want.w, sizeof got.w);
    }
}

/* ---- solve and impact --------------------------------------------------------------------- */

typedef struct problems {
    double w[6 * CONTACTS];
    double b[3 * CONTACTS];
    double mu[2 * CONTACTS];
    tribo_material pairs[CONTACTS];
    double p[3 * (CONTACTS + GUARD)];
    uint32_t modes[CONTACTS + GUARD];
    tribo_status statuses[CONTACTS + GUARD];
    tribo_status result;
} problems;

static void make_fault(property_trial *t, problems *q, uint32_t i)
{
    const uint8_t kind = make_byte(t) % 6;
    if (kind == 0) {
        q->w[6 * i + make_byte(t) % 6] = make_any(t, NULL);
    } else if (kind == 1) {
        q->b[3 * i + make_byte(t) % 3] = make_any(t, NULL);
    } else if (kind == 2) {
        q->mu[2 * i + make_byte(t) % 2] = make_any(t, NULL);
    } else if (kind == 3) {
        ((double *)&q->pairs[i])[make_byte(t) % 3] = make_any(t, NULL);
    } else if (kind == 4) {
        make_matrix_of(t, NULL, MATRIX_SINGULAR, q->w + 6 * i);
    } else {
        const int exponent = make_exponent(t, -1100, 1100);
        for (uint32_t k = 0; k < 6; k++) {
            q->w[6 * i + k] = ldexp(q->w[6 * i + k], exponent);
        }
    }
}

static uint32_t make_problems(property_trial *t, problems *q)
{
    const uint32_t count = make_choice(t, "count", CONTACTS);
    const uint32_t faults = make_choice(t, "faults", 4);
    const uint32_t set = make_choice(t, "set", MATRIX_DEFINITE + 1);
    property_expand(t);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kind = set < MATRIX_DEFINITE ? set : make_byte(t) % MATRIX_DEFINITE;
        make_matrix_of(t, "w", kind, q->w + 6 * i);
        make_material(t, "pair", &q->pairs[i]);
        q->mu[2 * i] = q->pairs[i].mu_s;
        q->mu[2 * i + 1] = q->pairs[i].mu_d;
        make_velocity(t, "b", q->w + 6 * i, q->mu[2 * i], q->b + 3 * i);
        if (make_byte(t) % 8 < faults) {
            make_fault(t, q, i);
        }
    }
    canary_set(q->p, sizeof q->p);
    canary_set(q->modes, sizeof q->modes);
    canary_set(q->statuses, sizeof q->statuses);
    return count;
}

/* The impulse of contact i, alone. */
static tribo_status alone(const problems *q, uint32_t impact, uint32_t i, double *p, uint32_t *mode)
{
    tribo_solve_info solve = {.struct_size = sizeof solve};
    /* asks for the mode alone: energy may be beyond double where p is not */
    tribo_impact_info info = {.struct_size = 2 * sizeof(uint32_t)};
    tribo_status status;
    if (impact) {
        status = tribo_impact(q->w + 6 * i, q->b + 3 * i, &q->pairs[i], NULL, p, &info);
    } else {
        status = tribo_contact_solve(q->w + 6 * i, q->b + 3 * i, q->mu[2 * i], q->mu[2 * i + 1], p,
                                     &solve);
    }
    if (status == TRIBO_OK) {
        *mode = impact ? info.mode : solve.mode;
    } else if (status == TRIBO_ERROR_JAM) {
        *mode = TRIBO_MODE_JAM;
    }
    return status;
}

static tribo_status run(uint32_t isa, uint32_t impact, uint32_t from, uint32_t to, problems *q,
                        int all)
{
    double *p = q->p + 3 * from;
    uint32_t *modes = all ? q->modes + from : NULL;
    tribo_status *statuses = all ? q->statuses + from : NULL;
    if (impact) {
        return tribo_batch_impact(isa, to - from, q->w + 6 * from, q->b + 3 * from, q->pairs + from,
                                  p, modes, statuses);
    }
    return tribo_batch_solve(isa, to - from, q->w + 6 * from, q->b + 3 * from, q->mu + 2 * from, p,
                             modes, statuses);
}

static void same(property_trial *t, uint32_t impact)
{
    static problems given;
    static problems want;
    static problems got;
    memset(&given, 0, sizeof given);
    const uint32_t count = make_problems(t, &given);
    const uint32_t cut = make_choice(t, "cut", count + 1);
    want = given;
    for (uint32_t i = 0; i < count; i++) {
        want.statuses[i] = alone(&want, impact, i, want.p + 3 * i, &want.modes[i]);
        want.result = want.result == TRIBO_OK ? want.statuses[i] : want.result;
    }
    for (uint32_t isa = 0; isa < SETS; isa++) {
        if (!tribo_isa_available(isa)) {
            continue;
        }
        got = given;
        got.result = run(isa, impact, 0, count, &got, 1);
        REQUIRE_STATUS(t, got.result, want.result);
        for (uint32_t i = 0; i < count; i++) {
            REQUIRE_STATUS(t, got.statuses[i], want.statuses[i]);
            REQUIRE_SAME(t, got.p + 3 * i, want.p + 3 * i, 3 * sizeof(double));
            REQUIRE(t, got.modes[i] == want.modes[i]);
        }
        REQUIRE_SAME(t, &got, &want, sizeof got);
        got = given;
        REQUIRE_STATUS(t, run(isa, impact, 0, count, &got, 0), want.result);
        REQUIRE_SAME(t, got.p, want.p, sizeof got.p);
        got = given;
        run(isa, impact, cut, count, &got, 1);
        run(isa, impact, 0, cut, &got, 1);
        got.result = want.result;
        REQUIRE_SAME(t, &got, &want, sizeof got);
    }
}

static void solve_same(property_trial *t)
{
    same(t, 0);
}

static void impact_same(property_trial *t)
{
    same(t, 1);
}

/* ---- arguments ---------------------------------------------------------------------------- */

static void isa_names(property_trial *t)
{
    static const char *const names[SETS] = {"best", "scalar", "baseline", "x86-64-v3", "x86-64-v4"};
    const uint32_t isa =
        make_choice(t, "small", 2) == 0 ? make_byte(t) % 8 : (uint32_t)make_bits(t, 4);
    const char *name = tribo_isa_name(isa);
    const uint32_t available = tribo_isa_available(isa);
    REQUIRE(t, available <= 1 && available == tribo_isa_available(isa));
    if (isa < SETS) {
        REQUIRE(t, name != NULL && strcmp(name, names[isa]) == 0);
        REQUIRE(t, available == 1 || isa > TRIBO_ISA_BASELINE);
    } else {
        REQUIRE(t, name == NULL && available == 0);
    }
}

static void bad_isa(property_trial *t)
{
    static matrices m;
    static problems q;
    memset(&m, 0, sizeof m);
    memset(&q, 0, sizeof q);
    const uint32_t contacts = make_contacts(t, &m);
    const uint32_t count = make_problems(t, &q);
    const uint32_t isa =
        make_choice(t, "known", 2) == 1 ? make_byte(t) % SETS : SETS + (uint32_t)make_bits(t, 3);
    ASSUME(t, !tribo_isa_available(isa));
    const tribo_status expected = isa < SETS ? TRIBO_ERROR_ISA : TRIBO_ERROR_OPTION;
    REQUIRE_STATUS(t,
                   tribo_batch_matrix(isa, BODIES, m.bodies, contacts, m.pairs, m.contacts,
                                      m.frames, m.w, m.statuses),
                   expected);
    REQUIRE_STATUS(t, run(isa, 0, 0, count, &q, 1), expected);
    REQUIRE_STATUS(t, run(isa, 1, 0, count, &q, 1), expected);
    REQUIRE(t, canary_kept(m.w, sizeof m.w) && canary_kept(m.frames, sizeof m.frames));
    REQUIRE(t, canary_kept(q.p, sizeof q.p) && canary_kept(q.modes, sizeof q.modes));
    REQUIRE(t, canary_kept(m.statuses, sizeof m.statuses));
    REQUIRE(t, canary_kept(q.statuses, sizeof q.statuses));
}

static void bad_null(property_trial *t)
{
    static matrices m;
    static problems q;
    memset(&m, 0, sizeof m);
    memset(&q, 0, sizeof q);
    const uint32_t contacts = make_contacts(t, &m);
    const uint32_t count = make_problems(t, &q);
    const uint32_t isa = make_choice(t, "isa", 3);
    const int least = make_choice(t, "argument", 5) == 0;
    ASSUME(t, contacts > 0 && count > 0);
    REQUIRE_STATUS(t,
                   tribo_batch_matrix(isa, BODIES, NULL, contacts, m.pairs, m.contacts, m.frames,
                                      m.w, m.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t,
                   tribo_batch_matrix(isa, BODIES, m.bodies, contacts, NULL, m.contacts, m.frames,
                                      m.w, m.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t,
                   tribo_batch_matrix(isa, BODIES, m.bodies, contacts, m.pairs, NULL, m.frames, m.w,
                                      m.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t,
                   tribo_batch_matrix(isa, BODIES, m.bodies, contacts, m.pairs, m.contacts,
                                      m.frames, NULL, m.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_solve(isa, count, NULL, q.b, q.mu, q.p, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_solve(isa, count, q.w, NULL, q.mu, q.p, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_solve(isa, count, q.w, q.b, NULL, q.p, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_solve(isa, count, q.w, q.b, q.mu, NULL, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_impact(isa, count, q.w, q.b, NULL, q.p, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t,
                   tribo_batch_impact(isa, count, least ? NULL : q.w, least ? q.b : NULL, q.pairs,
                                      q.p, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_batch_impact(isa, count, q.w, q.b, q.pairs, NULL, q.modes, q.statuses),
                   TRIBO_ERROR_NULL);
    REQUIRE(t, canary_kept(m.w, sizeof m.w) && canary_kept(m.statuses, sizeof m.statuses));
    REQUIRE(t, canary_kept(q.p, sizeof q.p) && canary_kept(q.statuses, sizeof q.statuses));
    REQUIRE(t, canary_kept(q.modes, sizeof q.modes));
    REQUIRE_STATUS(t, tribo_batch_matrix(isa, 0, NULL, 0, NULL, NULL, NULL, NULL, NULL), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_batch_solve(isa, 0, NULL, NULL, NULL, NULL, NULL, NULL), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_batch_impact(isa, 0, NULL, NULL, NULL, NULL, NULL, NULL), TRIBO_OK);
}

const char *const property_room = "batch";
const property property_list[] = {
    {"matrix_same", matrix_same, 1}, {"solve_same", solve_same, 1}, {"impact_same", impact_same, 1},
    {"isa_names", isa_names, 1},     {"bad_isa", bad_isa, 1},       {"bad_null", bad_null, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 8000;
