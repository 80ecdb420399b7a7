/* Batches give the bits and the statuses of the scalar functions, whatever the instruction set. */
#include <tribo/batch.h>

#include "check.h"
#include "problems.h"

enum { MOST = 40, ROUNDS = 400, ISAS = 5 };

/* ---- instruction sets ------------------------------------------------------------------------ */

static void test_instruction_sets(void **state)
{
    static const char *const names[ISAS] = {"best", "scalar", "baseline", "x86-64-v3", "x86-64-v4"};
    (void)state;
    for (uint32_t isa = 0; isa < ISAS; isa++) {
        assert_string_equal(tribo_isa_name(isa), names[isa]);
        assert_true(tribo_isa_available(isa) <= 1);
        print_message("# %s: %s\n", names[isa], tribo_isa_available(isa) ? "available" : "absent");
    }
    assert_int_equal(tribo_isa_available(TRIBO_ISA_BEST), 1);
    assert_int_equal(tribo_isa_available(TRIBO_ISA_SCALAR), 1);
    assert_int_equal(tribo_isa_available(TRIBO_ISA_BASELINE), 1);
    for (uint32_t isa = ISAS; isa < 100; isa++) {
        assert_null(tribo_isa_name(isa));
        assert_int_equal(tribo_isa_available(isa), 0);
    }
    assert_null(tribo_isa_name(UINT32_MAX));
    assert_int_equal(tribo_isa_available(UINT32_MAX), 0);
}

/* ---- solve and impact ------------------------------------------------------------------------ */

/* Inputs and outputs of MOST contacts; outputs have a guard behind them. */
typedef struct batch {
    double w[6 * MOST];
    double b[3 * MOST];
    double mu[2 * MOST];
    tribo_material pairs[MOST];
    double p[3 * MOST + 8];
    uint32_t modes[MOST + 8];
    tribo_status statuses[MOST + 8];
    tribo_status first;
} batch;

static void wipe(batch *out)
{
    memset(out->p, 0xa5, sizeof out->p);
    memset(out->modes, 0xa5, sizeof out->modes);
    memset(out->statuses, 0xa5, sizeof out->statuses);
}

static void spoil(problem_random *random, batch *out, size_t i)
{
    static const double jam[6] = {0.5, 0.5, 0, 0.5, 0, 1};
    static const double indefinite[6] = {1, -0.6, -0.6, 1, -0.6, 1};
    const uint64_t kind = problem_random_bits(random) % 16;
    const size_t k = (size_t)(problem_random_bits(random) % 3);
    const double bad = kind % 2 ? NOT_A_NUMBER : INFINITE;
    switch (kind) {
    case 0:
    case 1:
        out->w[6 * i + 2 * k] = bad;
        break;
    case 2:
    case 3:
        out->b[3 * i + k] = bad;
        break;
    case 4:
        out->mu[2 * i] = out->pairs[i].mu_s = bad;
        break;
    case 5:
        out->mu[2 * i + 1] = out->pairs[i].mu_d = -0.5;
        break;
    case 6:
        out->mu[2 * i + 1] = out->pairs[i].mu_d = 2.0 * out->mu[2 * i] + 1.0;
        break;
    case 7:
        memset(out->w + 6 * i, 0, sizeof jam);
        break;
    case 8:
        out->w[6 * i] = -out->w[6 * i];
        break;
    case 9:
        memcpy(out->w + 6 * i, indefinite, sizeof indefinite);
        break;
    case 10:
        out->b[3 * i + k] = k == 1 ? 1e302 : -1e305;
        break;
    case 11:
        out->w[6 * i] = 0x1p1010;
        break;
    case 12: /* jams under mu = 1.5, with W singular */
    case 13:
        memcpy(out->w + 6 * i, jam, sizeof jam);
        out->b[3 * i] = -1.0;
        out->b[3 * i + 1] = -0.3;
        out->b[3 * i + 2] = 0.0;
        out->mu[2 * i] = out->mu[2 * i + 1] = kind == 12 ? 1.5 : 0.5;
        out->pairs[i].mu_s = out->pairs[i].mu_d = out->mu[2 * i];
        break;
    case 14: /* zeros of both signs */
        out->b[3 * i + 1] = -0.0;
        out->b[3 * i + 2] = 0.0;
        out->w[6 * i + 1] = -0.0;
        break;
    default:
        out->pairs[i].e = bad;
        break;
    }
}

/* Problems of all sets, extremes of scale, one in `odd` of them spoilt. */
static void draw_batch(uint64_t round, uint64_t odd, batch *out)
{
    problem_random random;
    problem_random_start(&random, 60, odd, round);
    for (size_t i = 0; i < MOST; i++) {
        const uint32_t set = (uint32_t)(problem_random_bits(&random) % PROBLEM_SETS);
        problem_impact impact;
        problem_draw_impact(set, 61, round * MOST + i, &impact);
        int ew = 0;
        int eb = 0;
        if (problem_random_bits(&random) % 8 == 0) {
            ew = (int)(problem_random_bits(&random) % 1800) - 900;
            eb = (int)(problem_random_bits(&random) % 1800) - 900;
        }
        for (size_t k = 0; k < 6; k++) {
            out->w[6 * i + k] = ldexp(impact.w[k], ew);
        }
        for (size_t k = 0; k < 3; k++) {
            out->b[3 * i + k] = ldexp(impact.u[k], eb);
        }
        out->mu[2 * i] = impact.pair.mu_s;
        out->mu[2 * i + 1] = impact.pair.mu_d;
        out->pairs[i] = impact.pair;
        if (odd && problem_random_bits(&random) % odd == 0) {
            spoil(&random, out, i);
        }
    }
}

static void note_status(batch *out, size_t i, tribo_status status)
{
    out->statuses[i] = status;
    out->first = out->first == TRIBO_OK ? status : out->first;
}

static void solve_each(batch *out, size_t count)
{
    wipe(out);
    out->first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        tribo_solve_info info = {.struct_size = sizeof info};
        const double *mu = out->mu + 2 * i;
        const tribo_status status = tribo_contact_solve(out->w + 6 * i, out->b + 3 * i, mu[0],
                                                        mu[1], out->p + 3 * i, &info);
        note_status(out, i, status);
        if (status == TRIBO_OK) {
            out->modes[i] = info.mode;
        } else if (status == TRIBO_ERROR_JAM) {
            out->modes[i] = TRIBO_MODE_JAM;
        }
    }
}

static void impact_each(batch *out, size_t count)
{
    wipe(out);
    out->first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        /* asks for the mode alone: energy may be beyond double where p is not */
        tribo_impact_info info = {.struct_size = 2 * sizeof(uint32_t)};
        const tribo_status status = tribo_impact(out->w + 6 * i, out->b + 3 * i, &out->pairs[i],
                                                 NULL, out->p + 3 * i, &info);
        note_status(out, i, status);
        if (status == TRIBO_OK) {
            out->modes[i] = info.mode;
        }
    }
}

/* Contacts from `from` to `to` of a batch. */
static tribo_status run_range(uint32_t isa, int impact, batch *all, size_t from, size_t to)
{
    const size_t n = to - from;
    double *p = all->p + 3 * from;
    uint32_t *modes = all->modes + from;
    tribo_status *statuses = all->statuses + from;
    const double *w = all->w + 6 * from;
    const double *b = all->b + 3 * from;
    return impact ? tribo_batch_impact(isa, n, w, b, all->pairs + from, p, modes, statuses)
                  : tribo_batch_solve(isa, n, w, b, all->mu + 2 * from, p, modes, statuses);
}

static void compare(uint32_t isa, size_t count, const batch *got, const batch *want)
{
    for (size_t i = 0; i < count; i++) {
        if (memcmp(got->p + 3 * i, want->p + 3 * i, 3 * sizeof(double)) != 0 ||
            got->modes[i] != want->modes[i] || got->statuses[i] != want->statuses[i]) {
            const double *w = got->w + 6 * i;
            const double *b = got->b + 3 * i;
            print_message(
                "# %s, contact %d of %d: %s mode %u p %a %a %a, not %s mode %u p %a %a "
                "%a; W %a %a %a %a %a %a b %a %a %a mu %a %a e %a\n",
                tribo_isa_name(isa), (int)i, (int)count, tribo_status_name(got->statuses[i]),
                (unsigned)got->modes[i], got->p[3 * i], got->p[3 * i + 1], got->p[3 * i + 2],
                tribo_status_name(want->statuses[i]), (unsigned)want->modes[i], want->p[3 * i],
                want->p[3 * i + 1], want->p[3 * i + 2], w[0], w[1], w[2], w[3], w[4], w[5], b[0],
                b[1], b[2], got->mu[2 * i], got->mu[2 * i + 1], got->pairs[i].e);
            fail();
        }
    }
    /* and nothing beyond */
    assert_memory_equal(got->p, want->p, sizeof got->p);
    assert_memory_equal(got->modes, want->modes, sizeof got->modes);
    assert_memory_equal(got->statuses, want->statuses, sizeof got->statuses);
    assert_int_equal(got->first, want->first);
}

static void compare_with_scalar(int impact)
{
    static batch want;
    static batch got;
    static const uint64_t odds[4] = {0, 2, 6, 30};
    unsigned seen[4] = {0, 0, 0, 0};
    for (uint64_t round = 0; round < ROUNDS; round++) {
        const size_t count = (size_t)(round % (MOST + 1));
        draw_batch(round, odds[round % 4], &want);
        got = want;
        if (impact) {
            impact_each(&want, count);
        } else {
            solve_each(&want, count);
        }
        for (size_t i = 0; i < count; i++) {
            seen[want.modes[i] <= TRIBO_MODE_JAM ? want.modes[i] : 0]++;
        }
        for (uint32_t isa = 0; isa < ISAS; isa++) {
            if (!tribo_isa_available(isa)) {
                continue;
            }
            wipe(&got);
            got.first = run_range(isa, impact, &got, 0, count);
            compare(isa, count, &got, &want);
        }
    }
    assert_true(seen[TRIBO_MODE_STICK] > 500 && seen[TRIBO_MODE_SLIP] > 500);
    assert_true(impact || seen[TRIBO_MODE_JAM] > 20);
}

static void test_solve_has_the_scalar_bits(void **state)
{
    (void)state;
    compare_with_scalar(0);
}

static void test_impact_has_the_scalar_bits(void **state)
{
    (void)state;
    compare_with_scalar(1);
}

/* Threads may share out ranges as they like. */
static void test_ranges_change_no_bit(void **state)
{
    static batch whole;
    static batch parts;
    problem_random random;
    (void)state;
    problem_random_start(&random, 62, 0, 0);
    for (uint64_t round = 0; round < ROUNDS; round++) {
        const int impact = (int)(round / ISAS % 2);
        const uint32_t isa = (uint32_t)(round % ISAS);
        if (!tribo_isa_available(isa)) {
            continue;
        }
        draw_batch(round, 6, &whole);
        parts = whole;
        wipe(&whole);
        wipe(&parts);
        whole.first = run_range(isa, impact, &whole, 0, MOST);
        parts.first = TRIBO_OK;
        for (size_t from = 0; from < MOST;) {
            const size_t left = MOST - from;
            const size_t n = 1 + (size_t)(problem_random_bits(&random) % left);
            const tribo_status status = run_range(isa, impact, &parts, from, from + n);
            parts.first = parts.first == TRIBO_OK ? status : parts.first;
            from += n;
        }
        compare(isa, MOST, &parts, &whole);
    }
}

/* Modes and statuses may be missing; the impulses may take the place of b. */
static void test_missing_and_shared_arrays(void **state)
{
    static batch want;
    static batch got;
    (void)state;
    for (uint64_t round = 0; round < 80; round++) {
        const size_t count = (size_t)(round % (MOST + 1));
        for (uint32_t isa = 0; isa < ISAS; isa++) {
            if (!tribo_isa_available(isa)) {
                continue;
            }
            draw_batch(round, 0, &want);
            got = want;
            wipe(&want);
            want.first = run_range(isa, (int)(round % 2), &want, 0, count);
            wipe(&got);
            got.first =
                round % 2
                    ? tribo_batch_impact(isa, count, got.w, got.b, got.pairs, got.p, NULL, NULL)
                    : tribo_batch_solve(isa, count, got.w, got.b, got.mu, got.p, NULL, NULL);
            assert_memory_equal(got.p, want.p, sizeof got.p);
            assert_int_equal(got.first, want.first);
            got.first =
                round % 2
                    ? tribo_batch_impact(isa, count, got.w, got.b, got.pairs, got.b, NULL, NULL)
                    : tribo_batch_solve(isa, count, got.w, got.b, got.mu, got.b, NULL, NULL);
            for (size_t i = 0; i < count; i++) {
                const double *expected = want.statuses[i] == TRIBO_OK ? want.p : want.b;
                assert_memory_equal(got.b + 3 * i, expected + 3 * i, 3 * sizeof(double));
            }
        }
    }
}

/* ---- matrices -------------------------------------------------------------------------------- */

enum { BODIES = 2 * MOST };

typedef struct matrix_batch {
    tribo_body bodies[BODIES];
    uint32_t pairs[2 * MOST];
    tribo_contact contacts[MOST];
    double frames[9 * MOST + 8];
    double w[6 * MOST + 8];
    tribo_status statuses[MOST + 8];
    tribo_status first;
} matrix_batch;

static void wipe_matrices(matrix_batch *out)
{
    memset(out->frames, 0xa5, sizeof out->frames);
    memset(out->w, 0xa5, sizeof out->w);
    memset(out->statuses, 0xa5, sizeof out->statuses);
}

/* One fault at most, so that the order of judgement does not matter. */
static void spoil_matrix(problem_random *random, matrix_batch *out, size_t i)
{
    const size_t k = (size_t)(problem_random_bits(random) % 3);
    tribo_body *a = &out->bodies[2 * i];
    switch (problem_random_bits(random) % 14) {
    case 0:
        out->pairs[2 * i + k % 2] = BODIES;
        break;
    case 1:
        out->pairs[2 * i + k % 2] = TRIBO_WORLD - 1;
        break;
    case 2:
        out->pairs[2 * i + 1] = out->pairs[2 * i];
        break;
    case 3:
        out->pairs[2 * i] = out->pairs[2 * i + 1] = TRIBO_WORLD;
        break;
    case 4:
        out->contacts[i].normal[k] = NOT_A_NUMBER;
        break;
    case 5:
        out->contacts[i].normal[k] += 1e-6;
        break;
    case 6:
        out->contacts[i].arm_a[k] = -INFINITE;
        break;
    case 7:
        a->position[k] = NOT_A_NUMBER;
        break;
    case 8:
        a->orientation[k] += 0.1;
        break;
    case 9:
        a->inverse_mass = -1.0;
        break;
    case 10:
        a->inverse_inertia[5] = -1.0;
        break;
    case 11: /* neither can move */
        tribo_body_init(a);
        out->pairs[2 * i + k % 2] = TRIBO_WORLD;
        out->pairs[2 * i + 1 - k % 2] = (uint32_t)(2 * i);
        break;
    case 12:
        out->contacts[i].arm_a[k] = 1e200;
        break;
    default:
        out->contacts[i].normal[0] = out->contacts[i].normal[1] = -0.0;
        out->contacts[i].normal[2] = k ? -1.0 : 1.0;
        break;
    }
}

static void draw_matrices(uint64_t round, uint64_t odd, matrix_batch *out)
{
    problem_random random;
    problem_random_start(&random, 63, odd, round);
    for (size_t i = 0; i < MOST; i++) {
        problem_collision c;
        problem_draw_collision(64, round * MOST + i, &c);
        out->bodies[2 * i] = c.a;
        out->bodies[2 * i + 1] = c.b;
        out->contacts[i] = c.contact;
        out->pairs[2 * i] = (uint32_t)(2 * i);
        out->pairs[2 * i + 1] = (uint32_t)(2 * i + 1);
        switch (problem_random_bits(&random) % 8) {
        case 0:
            out->pairs[2 * i + 1] = TRIBO_WORLD;
            break;
        case 1:
            out->pairs[2 * i] = TRIBO_WORLD;
            break;
        case 2: /* an immovable body, and one that cannot turn */
            tribo_body_init(&out->bodies[2 * i + 1]);
            break;
        case 3:
            memset(out->bodies[2 * i].inverse_inertia, 0, sizeof c.a.inverse_inertia);
            break;
        default:
            break;
        }
        if (odd && problem_random_bits(&random) % odd == 0) {
            spoil_matrix(&random, out, i);
        }
    }
}

static tribo_status matrix_one(matrix_batch *out, size_t i)
{
    tribo_body world;
    const tribo_body *ends[2];
    double frame[9];
    tribo_body_init(&world);
    for (size_t k = 0; k < 2; k++) {
        const uint32_t index = out->pairs[2 * i + k];
        if (index >= BODIES && index != TRIBO_WORLD) {
            return TRIBO_ERROR_INDEX;
        }
        ends[k] = index == TRIBO_WORLD ? &world : &out->bodies[index];
    }
    if (ends[0] == &world && ends[1] == &world) {
        return TRIBO_ERROR_IMMOVABLE;
    }
    tribo_status status = tribo_contact_check(&out->contacts[i]);
    if (status != TRIBO_OK) {
        return status;
    }
    assert_int_equal(tribo_basis_from_normal(out->contacts[i].normal, frame), TRIBO_OK);
    status = tribo_contact_matrix(ends[0], ends[1], &out->contacts[i], frame, out->w + 6 * i);
    if (status == TRIBO_OK) {
        memcpy(out->frames + 9 * i, frame, sizeof frame);
    }
    return status;
}

static void matrix_each(matrix_batch *out, size_t count)
{
    wipe_matrices(out);
    out->first = TRIBO_OK;
    for (size_t i = 0; i < count; i++) {
        out->statuses[i] = matrix_one(out, i);
        out->first = out->first == TRIBO_OK ? out->statuses[i] : out->first;
    }
}

static void test_matrices_have_the_scalar_bits(void **state)
{
    static matrix_batch want;
    static matrix_batch got;
    static const uint64_t odds[4] = {0, 2, 6, 30};
    unsigned refused = 0;
    (void)state;
    for (uint64_t round = 0; round < ROUNDS; round++) {
        const size_t count = (size_t)(round % (MOST + 1));
        draw_matrices(round, odds[round % 4], &want);
        got = want;
        matrix_each(&want, count);
        refused += want.first != TRIBO_OK;
        for (uint32_t isa = 0; isa < ISAS; isa++) {
            if (!tribo_isa_available(isa)) {
                continue;
            }
            wipe_matrices(&got);
            got.first = tribo_batch_matrix(isa, BODIES, got.bodies, count, got.pairs, got.contacts,
                                           got.frames, got.w, got.statuses);
            for (size_t i = 0; i < count; i++) {
                if (got.statuses[i] != want.statuses[i]) {
                    fail_msg("%s: %s, not %s", tribo_isa_name(isa),
                             tribo_status_name(got.statuses[i]),
                             tribo_status_name(want.statuses[i]));
                }
            }
            assert_memory_equal(got.w, want.w, sizeof got.w);
            assert_memory_equal(got.frames, want.frames, sizeof got.frames);
            assert_memory_equal(got.statuses, want.statuses, sizeof got.statuses);
            assert_int_equal(got.first, want.first);
            /* frames and statuses may be missing; ranges change no bit */
            const size_t half = count / 3;
            wipe_matrices(&got);
            tribo_batch_matrix(isa, BODIES, got.bodies, half, got.pairs, got.contacts, NULL, got.w,
                               NULL);
            tribo_batch_matrix(isa, BODIES, got.bodies, count - half, got.pairs + 2 * half,
                               got.contacts + half, NULL, got.w + 6 * half, NULL);
            assert_memory_equal(got.w, want.w, sizeof got.w);
        }
    }
    assert_true(refused > 100);
}

/* ---- bad input ------------------------------------------------------------------------------- */

static void test_bad_calls(void **state)
{
    static batch all;
    static batch before;
    static matrix_batch matrices;
    static matrix_batch matrices_before;
    static const uint32_t options[] = {ISAS, 77, UINT32_MAX};
    (void)state;
    draw_batch(0, 0, &all);
    wipe(&all);
    before = all;
    draw_matrices(0, 0, &matrices);
    wipe_matrices(&matrices);
    matrices_before = matrices;
    for (uint32_t isa = 0; isa < ISAS + 3; isa++) {
        tribo_status status = TRIBO_ERROR_NULL;
        const uint32_t use = isa < ISAS ? isa : options[isa - ISAS];
        const int null_call = isa < ISAS && tribo_isa_available(isa);
        if (!null_call) {
            status = isa < ISAS ? TRIBO_ERROR_ISA : TRIBO_ERROR_OPTION;
            assert_int_equal(run_range(use, 0, &all, 0, 9), status);
            assert_int_equal(run_range(use, 1, &all, 0, 9), status);
            assert_int_equal(tribo_batch_matrix(use, BODIES, matrices.bodies, 9, matrices.pairs,
                                                matrices.contacts, matrices.frames, matrices.w,
                                                matrices.statuses),
                             status);
            /* with nothing to do as well */
            assert_int_equal(run_range(use, 0, &all, 0, 0), status);
            assert_int_equal(run_range(use, 1, &all, 0, 0), status);
        }
        /* null pointers come first */
        assert_int_equal(tribo_batch_solve(use, 9, NULL, all.b, all.mu, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_solve(use, 9, all.w, NULL, all.mu, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_solve(use, 9, all.w, all.b, NULL, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_solve(use, 9, all.w, all.b, all.mu, NULL, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_impact(use, 9, NULL, all.b, all.pairs, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_impact(use, 9, all.w, NULL, all.pairs, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_impact(use, 9, all.w, all.b, NULL, all.p, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_impact(use, 9, all.w, all.b, all.pairs, NULL, NULL, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_matrix(use, BODIES, NULL, 9, matrices.pairs, matrices.contacts,
                                            matrices.frames, matrices.w, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_matrix(use, BODIES, matrices.bodies, 9, NULL,
                                            matrices.contacts, matrices.frames, matrices.w, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_matrix(use, BODIES, matrices.bodies, 9, matrices.pairs, NULL,
                                            matrices.frames, matrices.w, NULL),
                         TRIBO_ERROR_NULL);
        assert_int_equal(tribo_batch_matrix(use, BODIES, matrices.bodies, 9, matrices.pairs,
                                            matrices.contacts, matrices.frames, NULL, NULL),
                         TRIBO_ERROR_NULL);
    }
    assert_memory_equal(&all, &before, sizeof all);
    assert_memory_equal(&matrices, &matrices_before, sizeof matrices);
}

static void test_empty_batches(void **state)
{
    (void)state;
    for (uint32_t isa = 0; isa < ISAS; isa++) {
        if (tribo_isa_available(isa)) {
            assert_int_equal(tribo_batch_solve(isa, 0, NULL, NULL, NULL, NULL, NULL, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_batch_impact(isa, 0, NULL, NULL, NULL, NULL, NULL, NULL),
                             TRIBO_OK);
            assert_int_equal(tribo_batch_matrix(isa, 0, NULL, 0, NULL, NULL, NULL, NULL, NULL),
                             TRIBO_OK);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_instruction_sets),
        cmocka_unit_test(test_solve_has_the_scalar_bits),
        cmocka_unit_test(test_impact_has_the_scalar_bits),
        cmocka_unit_test(test_ranges_change_no_bit),
        cmocka_unit_test(test_missing_and_shared_arrays),
        cmocka_unit_test(test_matrices_have_the_scalar_bits),
        cmocka_unit_test(test_bad_calls),
        cmocka_unit_test(test_empty_batches),
    };
    return cmocka_run_group_tests_name("batch", tests, NULL, NULL);
}
