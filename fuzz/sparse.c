/* Properties of include/tribo/sparse.h: small residuals, what is kept from matrix to matrix, and a
 * named status for whatever is wrong: singular matrices, rows that are none, memory that runs
 * out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <suitesparse/SuiteSparse_config.h>

#include <tribo/sparse.h>

#include "support/property.h"

enum { ROWS = 24, ENTRIES = ROWS * ROWS, METHODS = 3, PATTERNS = 3, MATRICES = 6 };

/* Residuals in units of n eps (|A||x| + |b|), row by row. */
#define UNITS 4.0

/* ---- memory that is counted and may run out -------------------------------------------------- */

static struct {
    long live;       /* pieces that are out */
    long taken;      /* so far */
    long fails_from; /* this one is refused; negative: none */
    uint32_t once;   /* 0: and all after it */
} memory;

static int refuses(void)
{
    const long number = memory.taken++;
    return memory.fails_from >= 0 &&
           (memory.once ? number == memory.fails_from : number >= memory.fails_from);
}

static void *count_out(void *piece)
{
    memory.live += piece != NULL;
    return piece;
}

static void *counted_malloc(size_t size)
{
    return refuses() ? NULL : count_out(malloc(size));
}

static void *counted_calloc(size_t count, size_t size)
{
    return refuses() ? NULL : count_out(calloc(count, size));
}

static void *counted_realloc(void *piece, size_t size)
{
    return refuses() ? NULL : piece != NULL ? realloc(piece, size) : count_out(malloc(size));
}

static void counted_free(void *piece)
{
    memory.live -= piece != NULL;
    free(piece);
}

static void *allocate(void *user, size_t size)
{
    return user == &memory && size > 0 ? counted_malloc(size) : NULL;
}

static void release(void *user, void *piece)
{
    if (user == &memory && piece != NULL) {
        counted_free(piece);
    }
}

static const tribo_allocator allocator = {sizeof allocator, 0, allocate, release, &memory};

/* What SuiteSparse takes for itself is counted, too. */
static void count_memory(void)
{
    SuiteSparse_config.malloc_func = counted_malloc;
    SuiteSparse_config.calloc_func = counted_calloc;
    SuiteSparse_config.realloc_func = counted_realloc;
    SuiteSparse_config.free_func = counted_free;
    memset(&memory, 0, sizeof memory);
    memory.fails_from = -1;
}

/* ---- matrices from bytes --------------------------------------------------------------------- */

/* A matrix as tribo_linear takes it. */
typedef struct matrix {
    uint32_t n, symmetric;
    uint32_t starts[ROWS + 1];
    uint32_t columns[ENTRIES];
    double values[ENTRIES];
} matrix;

/* Any entries beside the diagonal, which is always there. */
static void make_pattern(property_trial *t, uint32_t symmetric, matrix *out)
{
    memset(out, 0, sizeof *out);
    out->symmetric = symmetric;
    out->n = 1 + make_choice(t, "n", ROWS);
    const uint32_t density = make_byte(t);
    for (uint32_t i = 0; i < out->n; i++) {
        uint32_t at = out->starts[i];
        for (uint32_t j = 0; j < (symmetric ? i + 1 : out->n); j++) {
            if (i == j || make_byte(t) < density) {
                out->columns[at++] = j;
            }
        }
        out->starts[i + 1] = at;
    }
}

/* Rows (and columns, if it is symmetric) times powers of two. */
static void scale_rows(property_trial *t, matrix *m)
{
    int powers[ROWS];
    for (uint32_t i = 0; i < m->n; i++) {
        powers[i] = make_exponent(t, -30, 30);
    }
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const int column = m->symmetric ? powers[m->columns[k]] : 0;
            m->values[k] = ldexp(m->values[k], powers[i] + column);
        }
    }
}

/* Diagonals that outweigh their rows: positive if it is symmetric. */
static void make_values(property_trial *t, matrix *m)
{
    double sums[ROWS] = {0.0};
    uint32_t diagonal[ROWS] = {0};
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            m->values[k] = make_signed(t, NULL);
            diagonal[i] = j == i ? k : diagonal[i];
            sums[i] += j == i ? 0x1p-10 : fabs(m->values[k]);
            sums[j] += m->symmetric && j != i ? fabs(m->values[k]) : 0.0;
        }
    }
    for (uint32_t i = 0; i < m->n; i++) {
        const double sign = !m->symmetric && m->values[diagonal[i]] < 0.0 ? -1.0 : 1.0;
        m->values[diagonal[i]] = sign * 1.25 * sums[i];
    }
    if (make_choice(t, "scaled", 2) == 1) {
        scale_rows(t, m);
    }
    property_note(t, "values", m->values, m->starts[m->n]);
}

static void make_matrix(property_trial *t, uint32_t symmetric, matrix *out)
{
    make_pattern(t, symmetric, out);
    make_values(t, out);
}

/* ---- one object ------------------------------------------------------------------------------ */

static tribo_sparse *sparse;
static tribo_linear linear;

static tribo_status open_sparse(uint32_t method)
{
    memset(&linear, 0, sizeof linear);
    linear.struct_size = sizeof linear;
    const tribo_status status = tribo_sparse_create(method, &allocator, &sparse);
    return status == TRIBO_OK ? tribo_sparse_linear(sparse, &linear) : status;
}

static void close_sparse(void)
{
    tribo_sparse_destroy(sparse);
    sparse = NULL;
}

static tribo_status factor(const matrix *m)
{
    return linear.factor(linear.context, m->n, m->starts, m->columns, m->values, m->symmetric);
}

static tribo_sparse_info report(void)
{
    tribo_sparse_info info = {.struct_size = sizeof info};
    tribo_sparse_report(sparse, &info);
    return info;
}

/* The greater one; NaN stays. */
static double worse(double greatest, double here)
{
    return greatest != greatest || here <= greatest ? greatest : here;
}

/* Greatest |A x - b| over n eps (|A||x| + |b|), row by row. */
static double residual(const matrix *m, const double *x, const double *b)
{
    long double sums[ROWS];
    long double sizes[ROWS];
    double greatest = 0.0;
    for (uint32_t i = 0; i < m->n; i++) {
        sums[i] = -(long double)b[i];
        sizes[i] = fabsl(sums[i]);
    }
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            const long double value = (long double)m->values[k];
            sums[i] += value * (long double)x[j];
            sizes[i] += fabsl(value * (long double)x[j]);
            if (m->symmetric && j != i) {
                sums[j] += value * (long double)x[i];
                sizes[j] += fabsl(value * (long double)x[i]);
            }
        }
    }
    for (uint32_t i = 0; i < m->n; i++) {
        const double here = sums[i] == 0.0L ? 0.0 : (double)(fabsl(sums[i]) / sizes[i]);
        greatest = worse(greatest, here);
    }
    return greatest / (m->n * EPS);
}

/* The residual of the solution of a right-hand side; infinite if it is refused. */
static double solve_side(property_trial *t, const matrix *m)
{
    double b[ROWS];
    double x[ROWS];
    for (uint32_t i = 0; i < m->n; i++) {
        b[i] = make_signed(t, NULL);
    }
    memcpy(x, b, sizeof x);
    property_note(t, "b", b, m->n);
    return linear.solve(linear.context, x) == TRIBO_OK ? residual(m, x, b) : HUGE_VAL;
}

/* Whether there are no factors: solving is refused and changes nothing. */
static int has_no_factors(void)
{
    double x[ROWS];
    canary_set(x, sizeof x);
    return linear.solve(linear.context, x) == TRIBO_ERROR_CONTACT_MATRIX &&
           canary_kept(x, sizeof x) && report().fill == 0;
}

/* ---- what solves ----------------------------------------------------------------------------- */

static void residuals_are_small(property_trial *t)
{
    static matrix m;
    double greatest = 0.0;
    tribo_status status[2] = {TRIBO_OK, TRIBO_OK};
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    count_memory();
    property_expand(t);
    make_matrix(t, symmetric, &m);
    status[0] = open_sparse(method);
    status[1] = status[0] == TRIBO_OK ? factor(&m) : TRIBO_OK;
    for (int side = 0; side < 2; side++) {
        const double here =
            status[0] == TRIBO_OK && status[1] == TRIBO_OK ? solve_side(t, &m) : 0.0;
        greatest = worse(greatest, here);
    }
    close_sparse();
    REQUIRE_STATUS(t, status[0], TRIBO_OK);
    REQUIRE_STATUS(t, status[1], TRIBO_OK);
    REQUIRE_AT_MOST(t, greatest, UNITS);
    REQUIRE(t, memory.live == 0);
}

/* Matrices of some patterns, one after the other: each is solved, and a pattern analysed only where
 * it is not that of the matrix before. */
static void analyses_are_kept(property_trial *t)
{
    static matrix patterns[PATTERNS];
    tribo_sparse_info info = {.struct_size = sizeof info};
    uint64_t changes = 0;
    double greatest = 0.0;
    int refused = 0;
    uint32_t last = PATTERNS;
    const uint32_t method = make_choice(t, "method", METHODS);
    count_memory();
    property_expand(t);
    for (uint32_t i = 0; i < PATTERNS; i++) {
        make_pattern(t, make_choice(t, "symmetric", 2), &patterns[i]);
    }
    refused = open_sparse(method) != TRIBO_OK;
    for (uint32_t i = 0; i < MATRICES && !refused; i++) {
        const uint32_t now = make_choice(t, "pattern", PATTERNS);
        matrix *m = &patterns[now];
        const int same = last < PATTERNS && patterns[last].n == m->n &&
                         patterns[last].symmetric == m->symmetric &&
                         memcmp(patterns[last].starts, m->starts, sizeof m->starts) == 0 &&
                         memcmp(patterns[last].columns, m->columns, sizeof m->columns) == 0;
        changes += !same;
        last = now;
        make_values(t, m);
        refused = factor(m) != TRIBO_OK;
        const double here = refused ? 0.0 : solve_side(t, m);
        greatest = worse(greatest, here);
    }
    info = refused ? info : report();
    close_sparse();
    REQUIRE(t, !refused);
    REQUIRE_AT_MOST(t, greatest, UNITS);
    REQUIRE(t, info.analyses == changes);
    REQUIRE(t, info.factorizations == MATRICES && info.solves == MATRICES);
    REQUIRE(t, info.bytes > 0 && info.fill > 0);
    REQUIRE(t, info.method == TRIBO_SPARSE_SIMPLICIAL || info.method == TRIBO_SPARSE_SUPERNODAL);
    REQUIRE(t, memory.live == 0);
}

/* ---- what does not --------------------------------------------------------------------------- */

/* A row of zeros, or one that is not there; a number that is none; a pivot that is not positive. */
static void spoil_values(property_trial *t, matrix *m)
{
    const uint32_t row = make_byte(t) % m->n;
    const uint32_t entry = make_byte(t) % m->starts[m->n];
    const uint32_t kind = make_choice(t, "kind", m->symmetric ? 4 : 3);
    if (kind == 0) {
        for (uint32_t i = 0; i < m->n; i++) {
            for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
                const int in_row = i == row || (m->symmetric && m->columns[k] == row);
                m->values[k] = in_row ? 0.0 : m->values[k];
            }
        }
    } else if (kind == 1) {
        m->values[entry] = make_hostile(t, "entry");
    } else if (kind == 2) {
        const uint32_t gone = m->starts[row + 1] - m->starts[row];
        const uint32_t rest = m->starts[m->n] - m->starts[row + 1];
        memmove(m->columns + m->starts[row], m->columns + m->starts[row + 1],
                rest * sizeof *m->columns);
        memmove(m->values + m->starts[row], m->values + m->starts[row + 1],
                rest * sizeof *m->values);
        for (uint32_t i = row + 1; i <= m->n; i++) {
            m->starts[i] -= gone;
        }
    } else {
        m->values[m->starts[row + 1] - 1] *= -0.5;
    }
}

static void singular_is_refused(property_trial *t)
{
    static matrix bad;
    static matrix good;
    tribo_status status[3] = {TRIBO_OK, TRIBO_OK, TRIBO_OK};
    int none = 1;
    double after = 0.0;
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    count_memory();
    property_expand(t);
    make_matrix(t, symmetric, &bad);
    good = bad;
    spoil_values(t, &bad);
    status[0] = open_sparse(method);
    if (status[0] == TRIBO_OK) {
        status[1] = factor(&bad);
        none = has_no_factors();
        status[2] = factor(&good);
        after = status[2] == TRIBO_OK ? solve_side(t, &good) : 0.0;
    }
    close_sparse();
    REQUIRE_STATUS(t, status[0], TRIBO_OK);
    REQUIRE_STATUS(t, status[1], TRIBO_ERROR_CONTACT_MATRIX);
    REQUIRE(t, none);
    REQUIRE_STATUS(t, status[2], TRIBO_OK);
    REQUIRE_AT_MOST(t, after, UNITS);
    REQUIRE(t, memory.live == 0);
}

/* Rows that do not follow each other, columns that do not rise or lie outside. Returns the status
 * that names it; TRIBO_OK if there is nothing to corrupt. */
static tribo_status corrupt(property_trial *t, matrix *m)
{
    const uint32_t entries = m->starts[m->n];
    const uint32_t entry = make_byte(t) % entries;
    const uint32_t row = make_byte(t) % m->n;
    const uint32_t end = m->starts[row + 1];
    switch (make_choice(t, "corruption", 6)) {
    case 0:
        m->starts[0] = 1 + make_byte(t);
        return TRIBO_ERROR_INDEX;
    case 1:
        m->columns[entry] = m->n + (uint32_t)make_bits(t, 3);
        return TRIBO_ERROR_INDEX;
    case 2:
        m->starts[m->n] = INT32_MAX + (uint32_t)make_bits(t, 3);
        return TRIBO_ERROR_CAPACITY;
    case 3: /* a column again, or a lower one */
        if (end - m->starts[row] < 2) {
            return TRIBO_OK;
        }
        m->columns[end - 1] = make_byte(t) % (m->columns[end - 2] + 1);
        return TRIBO_ERROR_INDEX;
    case 4: /* an end beyond all entries */
        if (row + 1 == m->n) {
            return TRIBO_OK;
        }
        m->starts[row + 1] = entries + 1 + (uint32_t)make_bits(t, 3);
        return TRIBO_ERROR_INDEX;
    default: /* above the diagonal */
        if (!m->symmetric || row + 1 == m->n) {
            return TRIBO_OK;
        }
        m->columns[end - 1] = row + 1;
        return TRIBO_ERROR_INDEX;
    }
}

static void bad_rows(property_trial *t)
{
    static matrix bad;
    static matrix good;
    tribo_status status[3] = {TRIBO_OK, TRIBO_OK, TRIBO_OK};
    int none = 1;
    double after = 0.0;
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    const uint32_t before = make_choice(t, "before", 2);
    count_memory();
    property_expand(t);
    make_matrix(t, symmetric, &bad);
    good = bad;
    const tribo_status expected = corrupt(t, &bad);
    ASSUME(t, expected != TRIBO_OK);
    status[0] = open_sparse(method);
    if (status[0] == TRIBO_OK) {
        status[2] = before == 1 ? factor(&good) : TRIBO_OK;
        status[1] = factor(&bad);
        none = has_no_factors();
        status[2] = status[2] == TRIBO_OK ? factor(&good) : status[2];
        after = status[2] == TRIBO_OK ? solve_side(t, &good) : 0.0;
    }
    close_sparse();
    REQUIRE_STATUS(t, status[0], TRIBO_OK);
    REQUIRE_STATUS(t, status[1], expected);
    REQUIRE(t, none);
    REQUIRE_STATUS(t, status[2], TRIBO_OK);
    REQUIRE_AT_MOST(t, after, UNITS);
    REQUIRE(t, memory.live == 0);
}

/* Any numbers at all: a status that may be, and solutions only where there are factors. */
static void any_numbers(property_trial *t)
{
    static matrix m;
    double x[ROWS];
    tribo_status status[3] = {TRIBO_OK, TRIBO_OK, TRIBO_OK};
    int none = 1;
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    count_memory();
    property_expand(t);
    make_pattern(t, symmetric, &m);
    for (uint32_t k = 0; k < m.starts[m.n]; k++) {
        m.values[k] = make_finite(t, "value");
    }
    memset(x, 0, sizeof x);
    status[0] = open_sparse(method);
    if (status[0] == TRIBO_OK) {
        status[1] = factor(&m);
        none = status[1] == TRIBO_OK || has_no_factors();
        status[2] = status[1] == TRIBO_OK ? linear.solve(linear.context, x) : TRIBO_OK;
    }
    close_sparse();
    REQUIRE_STATUS(t, status[0], TRIBO_OK);
    REQUIRE(t, status[1] == TRIBO_OK || status[1] == TRIBO_ERROR_CONTACT_MATRIX);
    REQUIRE(t, none);
    REQUIRE_STATUS(t, status[2], TRIBO_OK);
    REQUIRE(t, memory.live == 0);
}

/* ---- memory runs out ------------------------------------------------------------------------- */

/* Two matrices with memory that fails at one place or from there on, and again once there is
 * some. */
static void memory_runs_out(property_trial *t)
{
    static matrix m[2];
    double greatest = 0.0;
    int other = 0; /* a status that does not belong here */
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t place = make_choice(t, "place", 128);
    count_memory();
    memory.once = make_choice(t, "once", 2);
    property_expand(t);
    for (int i = 0; i < 2; i++) {
        make_matrix(t, make_choice(t, "symmetric", 2), &m[i]);
    }
    memory.fails_from = (long)place;
    const tribo_status opened = open_sparse(method);
    for (int i = 0; i < 2 && opened == TRIBO_OK; i++) {
        const tribo_status status = factor(&m[i]);
        double x[ROWS] = {0.0};
        const tribo_status solved = status == TRIBO_OK ? linear.solve(linear.context, x) : TRIBO_OK;
        other = other || (status != TRIBO_OK && status != TRIBO_ERROR_MEMORY) ||
                (solved != TRIBO_OK && solved != TRIBO_ERROR_MEMORY);
    }
    const int met = memory.taken > memory.fails_from;
    memory.fails_from = -1;
    for (int i = 1; i >= 0 && opened == TRIBO_OK; i--) {
        const double here = factor(&m[i]) == TRIBO_OK ? solve_side(t, &m[i]) : HUGE_VAL;
        greatest = worse(greatest, here);
    }
    close_sparse();
    ASSUME(t, met);
    REQUIRE(t, opened == TRIBO_OK || opened == TRIBO_ERROR_MEMORY);
    REQUIRE(t, !other);
    REQUIRE_AT_MOST(t, greatest, UNITS);
    REQUIRE(t, memory.live == 0);
}

/* ---- calls that are wrong -------------------------------------------------------------------- */

static void bad_create(property_trial *t)
{
    tribo_allocator given = allocator;
    tribo_sparse *out = NULL;
    const uint32_t fault = make_choice(t, "fault", 4);
    const uint32_t method =
        fault == 3 ? METHODS + (uint32_t)make_bits(t, 3) : make_choice(t, "method", METHODS);
    count_memory();
    if (fault == 0) {
        given.struct_size = (uint32_t)make_bits(t, 2);
        ASSUME(t, given.struct_size != sizeof given);
    } else if (fault == 1) {
        given.allocate = NULL;
    } else if (fault == 2) {
        given.release = NULL;
    }
    const tribo_status expected = fault == 0   ? TRIBO_ERROR_STRUCT_SIZE
                                  : fault == 3 ? TRIBO_ERROR_OPTION
                                               : TRIBO_ERROR_NULL;
    REQUIRE_STATUS(t, tribo_sparse_create(method, &given, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_sparse_create(method, &given, &out), expected);
    REQUIRE(t, out == NULL && memory.live == 0);
    tribo_sparse_destroy(NULL);
}

/* Reports of every size that there ever was, and refusals of others. */
static void report_sizes(property_trial *t)
{
    tribo_sparse_info info;
    tribo_sparse_info blank;
    tribo_linear small;
    tribo_status status[5];
    const uint32_t size = make_byte(t);
    const int known = size >= 4 && size % 4 == 0 && size <= sizeof info;
    count_memory();
    canary_set(&blank, sizeof blank);
    blank.struct_size = size;
    info = blank;
    memset(&small, 0, sizeof small);
    small.struct_size = 4 * (make_byte(t) % (sizeof small / 4 + 2));
    const int older = small.struct_size == offsetof(tribo_linear, sign);
    const int linear_known = older || small.struct_size == sizeof small;
    REQUIRE_STATUS(t, open_sparse(TRIBO_SPARSE_AUTO), TRIBO_OK);
    status[0] = tribo_sparse_report(sparse, &info);
    status[1] = tribo_sparse_report(NULL, &info);
    status[2] = tribo_sparse_report(sparse, NULL);
    status[3] = tribo_sparse_linear(sparse, &small);
    status[4] = tribo_sparse_linear(NULL, &small);
    close_sparse();
    REQUIRE_STATUS(t, status[0], known ? TRIBO_OK : TRIBO_ERROR_STRUCT_SIZE);
    REQUIRE_STATUS(t, status[1], TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, status[2], TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, status[3], linear_known ? TRIBO_OK : TRIBO_ERROR_STRUCT_SIZE);
    REQUIRE_STATUS(t, status[4], TRIBO_ERROR_NULL);
    REQUIRE(t, info.struct_size == size && (small.solve != NULL) == linear_known &&
                   (small.sign != NULL) == (linear_known && !older));
    const size_t written = known ? size : 4;
    REQUIRE_SAME(t, (const char *)&info + written, (const char *)&blank + written,
                 sizeof info - written);
}

static void bad_null(property_trial *t)
{
    static matrix m;
    tribo_status status[6];
    double x[ROWS];
    count_memory();
    const uint32_t method = make_choice(t, "method", METHODS);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    property_expand(t);
    make_matrix(t, symmetric, &m);
    canary_set(x, sizeof x);
    REQUIRE_STATUS(t, open_sparse(method), TRIBO_OK);
    status[0] = linear.factor(NULL, m.n, m.starts, m.columns, m.values, symmetric);
    status[1] = linear.factor(sparse, m.n, NULL, m.columns, m.values, symmetric);
    status[2] = linear.factor(sparse, m.n, m.starts, NULL, m.values, symmetric);
    status[3] = linear.factor(sparse, m.n, m.starts, m.columns, NULL, symmetric);
    status[4] = linear.solve(NULL, x);
    status[5] = linear.solve(sparse, NULL);
    const tribo_sparse_info info = report();
    close_sparse();
    for (int i = 0; i < 6; i++) {
        REQUIRE_STATUS(t, status[i], TRIBO_ERROR_NULL);
    }
    REQUIRE(t, canary_kept(x, sizeof x));
    REQUIRE(t, info.factorizations == 0 && info.analyses == 0 && info.solves == 0);
    REQUIRE(t, memory.live == 0);
}

const char *const property_room = "sparse";
const property property_list[] = {
    {"residuals_are_small", residuals_are_small, 1},
    {"analyses_are_kept", analyses_are_kept, 4},
    {"singular_is_refused", singular_is_refused, 1},
    {"bad_rows", bad_rows, 1},
    {"any_numbers", any_numbers, 1},
    {"memory_runs_out", memory_runs_out, 2},
    {"bad_create", bad_create, 1},
    {"report_sizes", report_sizes, 1},
    {"bad_null", bad_null, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 4000;
