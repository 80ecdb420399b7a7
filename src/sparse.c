#include <tribo/sparse.h>

#include "bits.h"
#include "dissect.h"

#include <float.h>
#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <suitesparse/cholmod.h>
#include <suitesparse/klu.h>
#include <suitesparse/umfpack.h>

/* Operations for each number in the factors above which dense blocks in them pay: that of CHOLMOD,
 * and where UMFPACK overtakes KLU on the matrices of tests/bench/linear.c. */
#define BLOCKS_PAY 40.0

/* The same above which dissection may take less than AMD: in space, from about a thousand bodies
 * on. */
#define DISSECTION_PAYS 300.0

/* Whose factors are there. */
enum { NOBODY, EMPTY, CHOLMOD, KLU, UMFPACK };

struct tribo_sparse {
    tribo_allocator allocator;
    uint32_t method;
    int factors;  /* whose factors can solve */
    int analysis; /* whose analysis of the pattern is there */
    uint64_t factorizations, analyses, solves;

    /* The pattern that was analysed, 0 rows for none; and the values that were factored. */
    int n;
    uint32_t symmetric;
    int *row_starts; /* n + 1, and after them the columns: one piece of memory */
    int *columns;
    double *work; /* 3 n numbers, and n int */
    uint64_t own_bytes;
    const double *values;

    cholmod_common cholmod;
    cholmod_factor *cholesky;
    cholmod_dense *x, *y, *e; /* work of cholmod_solve2 */

    klu_common klu;
    klu_symbolic *klu_symbolic;
    klu_numeric *klu_numeric;

    double control[UMFPACK_CONTROL];
    double umfpack_info[UMFPACK_INFO];
    void *umfpack_symbolic;
    void *umfpack_numeric;
};

/* ---- memory ---------------------------------------------------------------------------------- */

static void *allocate_default(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void release_default(void *user, void *memory)
{
    (void)user;
    free(memory);
}

static void release(tribo_sparse *s, void *memory)
{
    if (memory) {
        s->allocator.release(s->allocator.user, memory);
    }
}

static void drop_factors(tribo_sparse *s)
{
    s->factors = NOBODY;
    klu_free_numeric(&s->klu_numeric, &s->klu);
    if (s->umfpack_numeric) {
        umfpack_di_free_numeric(&s->umfpack_numeric);
    }
}

/* Back to the state after tribo_sparse_create, but for the counters. */
static void forget(tribo_sparse *s)
{
    drop_factors(s);
    klu_free_symbolic(&s->klu_symbolic, &s->klu);
    if (s->umfpack_symbolic) {
        umfpack_di_free_symbolic(&s->umfpack_symbolic);
    }
    cholmod_free_factor(&s->cholesky, &s->cholmod);
    cholmod_free_dense(&s->x, &s->cholmod);
    cholmod_free_dense(&s->y, &s->cholmod);
    cholmod_free_dense(&s->e, &s->cholmod);
    release(s, s->row_starts);
    release(s, s->work);
    s->row_starts = NULL;
    s->columns = NULL;
    s->work = NULL;
    s->own_bytes = 0;
    s->analysis = NOBODY;
    s->n = 0;
}

static int size_is_known(uint32_t size, size_t newest)
{
    return size >= 4 && size % 4u == 0 && size <= newest;
}

static void set_up_libraries(tribo_sparse *s)
{
    cholmod_start(&s->cholmod);
    s->cholmod.print = 0;
    s->cholmod.nmethods = 1;
    s->cholmod.method[0].ordering = CHOLMOD_AMD;
    s->cholmod.postorder = 1;
    s->cholmod.final_ll = 1; /* LDL' would take negative pivots */
    s->cholmod.quick_return_if_not_posdef = 1;
    s->cholmod.supernodal = s->method == TRIBO_SPARSE_SIMPLICIAL   ? CHOLMOD_SIMPLICIAL
                            : s->method == TRIBO_SPARSE_SUPERNODAL ? CHOLMOD_SUPERNODAL
                                                                   : CHOLMOD_AUTO;
    s->cholmod.supernodal_switch = BLOCKS_PAY;
    klu_defaults(&s->klu);
    umfpack_di_defaults(s->control);
    s->control[UMFPACK_PRL] = 0.0;
    s->control[UMFPACK_ORDERING] = UMFPACK_ORDERING_AMD;
    s->control[UMFPACK_IRSTEP] = 0.0;
    s->control[UMFPACK_BLOCK_SIZE] = 16.0; /* fronts of contacts are small */
    /* Patterns are symmetric. UMFPACK would see it only with values at hand. */
    s->control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
}

tribo_status tribo_sparse_create(uint32_t method, const tribo_allocator *allocator,
                                 tribo_sparse **sparse)
{
    tribo_allocator full = {sizeof full, 0, allocate_default, release_default, NULL};
    if (!sparse) {
        return TRIBO_ERROR_NULL;
    }
    if (allocator) {
        if (allocator->struct_size != sizeof *allocator) {
            return TRIBO_ERROR_STRUCT_SIZE;
        }
        if (!allocator->allocate || !allocator->release) {
            return TRIBO_ERROR_NULL;
        }
        full = *allocator;
    }
    if (method > TRIBO_SPARSE_SUPERNODAL) {
        return TRIBO_ERROR_OPTION;
    }
    tribo_sparse *s = full.allocate(full.user, sizeof *s);
    if (!s) {
        return TRIBO_ERROR_MEMORY;
    }
    memset(s, 0, sizeof *s);
    s->allocator = full;
    s->method = method;
    set_up_libraries(s);
    *sparse = s;
    return TRIBO_OK;
}

void tribo_sparse_destroy(tribo_sparse *sparse)
{
    if (sparse) {
        forget(sparse);
        cholmod_finish(&sparse->cholmod);
        sparse->allocator.release(sparse->allocator.user, sparse);
    }
}

/* ---- pattern --------------------------------------------------------------------------------- */

static int is_known(const tribo_sparse *s, uint32_t n, const uint32_t *row_starts,
                    const uint32_t *columns, uint32_t symmetric)
{
    return s->analysis != NOBODY && (uint32_t)s->n == n && s->symmetric == symmetric &&
           memcmp(s->row_starts, row_starts, ((size_t)n + 1) * sizeof *row_starts) == 0 &&
           memcmp(s->columns, columns, row_starts[n] * sizeof *columns) == 0;
}

static tribo_status check_pattern(uint32_t n, const uint32_t *row_starts, const uint32_t *columns,
                                  uint32_t symmetric)
{
    if (n >= INT_MAX || row_starts[n] >= INT_MAX) {
        return TRIBO_ERROR_CAPACITY;
    }
    if (row_starts[0] != 0) {
        return TRIBO_ERROR_INDEX;
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t end = row_starts[i + 1];
        if (end < row_starts[i] || end > row_starts[n]) {
            return TRIBO_ERROR_INDEX;
        }
        for (uint32_t k = row_starts[i]; k < end; k++) {
            if (columns[k] >= (symmetric ? i + 1 : n) ||
                (k > row_starts[i] && columns[k] <= columns[k - 1])) {
                return TRIBO_ERROR_INDEX;
            }
        }
    }
    return TRIBO_OK;
}

static tribo_status keep_pattern(tribo_sparse *s, uint32_t n, const uint32_t *row_starts,
                                 const uint32_t *columns, uint32_t symmetric)
{
    const size_t starts = ((size_t)n + 1) * sizeof(int);
    const size_t entries = (size_t)row_starts[n] * sizeof(int);
    const size_t work = (size_t)n * (3 * sizeof(double) + sizeof(int));
    s->row_starts = s->allocator.allocate(s->allocator.user, starts + entries);
    s->work = s->allocator.allocate(s->allocator.user, work);
    if (!s->row_starts || !s->work) {
        return TRIBO_ERROR_MEMORY;
    }
    s->columns = s->row_starts + n + 1;
    s->own_bytes = starts + entries + work;
    memcpy(s->row_starts, row_starts, starts);
    memcpy(s->columns, columns, entries);
    s->n = (int)n;
    s->symmetric = symmetric;
    return TRIBO_OK;
}

/* ---- symmetric: CHOLMOD ---------------------------------------------------------------------- */

/* Rows of the lower triangle are columns of the upper one. CHOLMOD writes to none of it. */
static cholmod_sparse cholmod_view(tribo_sparse *s, const double *values)
{
    cholmod_sparse view;
    memset(&view, 0, sizeof view);
    view.nrow = (size_t)s->n;
    view.ncol = (size_t)s->n;
    view.nzmax = (size_t)s->row_starts[s->n];
    view.p = s->row_starts;
    view.i = s->columns;
    memcpy(&view.x, &values, sizeof view.x);
    view.stype = 1;
    view.itype = CHOLMOD_INT;
    view.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

/* Null if there is no memory. */
static cholmod_factor *analyse_dissected(tribo_sparse *s, cholmod_sparse *view)
{
    const size_t n = (size_t)s->n;
    const size_t room = dissect_room(s->n, s->row_starts[s->n]);
    cholmod_factor *found = NULL;
    int *memory = s->allocator.allocate(s->allocator.user, (room + 2 * n) * sizeof *memory);
    if (!memory) {
        return NULL;
    }
    int *sets = memory + room;
    int *order = sets + n;
    dissect(s->n, s->row_starts, s->columns, memory, sets);
    if (cholmod_camd(view, NULL, 0, sets, order, &s->cholmod)) {
        s->cholmod.method[0].ordering = CHOLMOD_GIVEN;
        found = cholmod_analyze_p(view, order, NULL, 0, &s->cholmod);
        s->cholmod.method[0].ordering = CHOLMOD_AMD;
    }
    release(s, memory);
    return found;
}

/* AMD's order is there: take that of dissection if it has fewer operations. */
static void try_dissection(tribo_sparse *s, cholmod_sparse *view)
{
    const double operations = s->cholmod.fl;
    const double numbers = s->cholmod.lnz;
    cholmod_factor *found = analyse_dissected(s, view);
    if (found && s->cholmod.fl < operations) {
        cholmod_free_factor(&s->cholesky, &s->cholmod);
        s->cholesky = found;
        return;
    }
    cholmod_free_factor(&found, &s->cholmod);
    s->cholmod.fl = operations;
    s->cholmod.lnz = numbers;
    s->cholmod.status = CHOLMOD_OK;
}

static tribo_status analyse_symmetric(tribo_sparse *s)
{
    cholmod_sparse view = cholmod_view(s, NULL);
    s->cholesky = cholmod_analyze(&view, &s->cholmod);
    if (s->cholesky && s->cholmod.fl > DISSECTION_PAYS * s->cholmod.lnz &&
        s->row_starts[s->n] < INT_MAX / 2) {
        try_dissection(s, &view);
    }
    s->analysis = s->cholesky ? CHOLMOD : NOBODY;
    return s->cholesky ? TRIBO_OK : TRIBO_ERROR_MEMORY;
}

/* The work of cholmod_solve2: where it has to allocate and cannot, it crashes. */
static int prepare_solve(tribo_sparse *s)
{
    const size_t n = (size_t)s->n;
    const size_t border = s->cholesky->is_super ? s->cholesky->maxesize : 0;
    return cholmod_ensure_dense(&s->x, n, 1, n, CHOLMOD_REAL, &s->cholmod) &&
           cholmod_ensure_dense(&s->y, n, 1, n, CHOLMOD_REAL, &s->cholmod) &&
           cholmod_ensure_dense(&s->e, border, 1, border, CHOLMOD_REAL, &s->cholmod);
}

static tribo_status factor_symmetric(tribo_sparse *s)
{
    cholmod_sparse view = cholmod_view(s, s->values);
    if (!cholmod_factorize(&view, s->cholesky, &s->cholmod) || s->cholmod.status < CHOLMOD_OK) {
        return TRIBO_ERROR_MEMORY;
    }
    /* The ratio of the pivots shows what is not finite: it is 0 then. */
    if (s->cholmod.status != CHOLMOD_OK || !(cholmod_rcond(s->cholesky, &s->cholmod) > 0.0)) {
        return TRIBO_ERROR_CONTACT_MATRIX;
    }
    if (!prepare_solve(s)) {
        return TRIBO_ERROR_MEMORY;
    }
    s->factors = CHOLMOD;
    return TRIBO_OK;
}

static tribo_status solve_symmetric(tribo_sparse *s, double *x)
{
    cholmod_dense b;
    memset(&b, 0, sizeof b);
    b.nrow = (size_t)s->n;
    b.ncol = 1;
    b.nzmax = b.nrow;
    b.d = b.nrow;
    b.x = x;
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, s->cholesky, &b, NULL, &s->x, NULL, &s->y, &s->e, &s->cholmod)) {
        return TRIBO_ERROR_MEMORY;
    }
    memcpy(x, s->x->x, b.nrow * sizeof *x);
    return TRIBO_OK;
}

/* ---- general: KLU and UMFPACK, given the transpose ------------------------------------------- */

static tribo_status analyse_for_umfpack(tribo_sparse *s)
{
    const int status = umfpack_di_symbolic(s->n, s->n, s->row_starts, s->columns, NULL,
                                           &s->umfpack_symbolic, s->control, s->umfpack_info);
    s->analysis = status >= UMFPACK_OK ? UMFPACK : NOBODY;
    return status >= UMFPACK_OK ? TRIBO_OK : TRIBO_ERROR_MEMORY;
}

static tribo_status analyse_general(tribo_sparse *s)
{
    if (s->method == TRIBO_SPARSE_SUPERNODAL) {
        return analyse_for_umfpack(s);
    }
    s->klu_symbolic = klu_analyze(s->n, s->row_starts, s->columns, &s->klu);
    if (!s->klu_symbolic) {
        return TRIBO_ERROR_MEMORY;
    }
    s->analysis = KLU;
    if (s->method == TRIBO_SPARSE_AUTO &&
        s->klu_symbolic->est_flops > BLOCKS_PAY * (s->klu_symbolic->lnz + s->klu_symbolic->unz)) {
        klu_free_symbolic(&s->klu_symbolic, &s->klu);
        return analyse_for_umfpack(s);
    }
    return TRIBO_OK;
}

static tribo_status factor_klu(tribo_sparse *s)
{
    double *values;
    memcpy(&values, &s->values, sizeof values); /* KLU writes to none of it */
    s->klu_numeric = klu_factor(s->row_starts, s->columns, values, s->klu_symbolic, &s->klu);
    if (!s->klu_numeric) {
        return s->klu.status == KLU_SINGULAR ? TRIBO_ERROR_CONTACT_MATRIX : TRIBO_ERROR_MEMORY;
    }
    klu_rcond(s->klu_symbolic, s->klu_numeric, &s->klu);
    s->factors = KLU;
    return s->klu.rcond > 0.0 ? TRIBO_OK : TRIBO_ERROR_CONTACT_MATRIX;
}

static tribo_status factor_umfpack(tribo_sparse *s)
{
    const int status = umfpack_di_numeric(s->row_starts, s->columns, s->values, s->umfpack_symbolic,
                                          &s->umfpack_numeric, s->control, s->umfpack_info);
    if (status < UMFPACK_OK) {
        return TRIBO_ERROR_MEMORY;
    }
    s->factors = UMFPACK;
    return s->umfpack_info[UMFPACK_RCOND] > 0.0 ? TRIBO_OK : TRIBO_ERROR_CONTACT_MATRIX;
}

/* x = A^-1 b without refinement. */
static tribo_status solve_once(tribo_sparse *s, const double *b, double *x)
{
    double *scratch = s->work + 2 * (size_t)s->n;
    if (s->factors == KLU) {
        memcpy(x, b, (size_t)s->n * sizeof *x);
        return klu_tsolve(s->klu_symbolic, s->klu_numeric, s->n, 1, x, &s->klu)
                   ? TRIBO_OK
                   : TRIBO_ERROR_MEMORY;
    }
    const int status = umfpack_di_wsolve(UMFPACK_Aat, s->row_starts, s->columns, s->values, x, b,
                                         s->umfpack_numeric, s->control, s->umfpack_info,
                                         (int *)(scratch + s->n), scratch);
    return status >= UMFPACK_OK ? TRIBO_OK : TRIBO_ERROR_MEMORY;
}

static tribo_status solve_general(tribo_sparse *s, double *x)
{
    double *residual = s->work;
    double *solution = s->work + s->n;
    tribo_status status = solve_once(s, x, solution);
    for (int i = 0; i < s->n && status == TRIBO_OK; i++) {
        double sum = x[i];
        for (int k = s->row_starts[i]; k < s->row_starts[i + 1]; k++) {
            sum -= s->values[k] * solution[s->columns[k]];
        }
        residual[i] = sum;
    }
    if (status == TRIBO_OK) {
        status = solve_once(s, residual, x);
    }
    for (int i = 0; i < s->n && status == TRIBO_OK; i++) {
        x[i] += solution[i];
    }
    return status;
}

/* ---- sign of the determinant ----------------------------------------------------------------- */

/* 1 if the permutation is odd. `seen`: n int. */
static int is_odd(int n, const int *permutation, int *seen)
{
    int odd = n % 2;
    memset(seen, 0, (size_t)n * sizeof *seen);
    for (int i = 0; i < n; i++) {
        odd ^= !seen[i]; /* each cycle */
        for (int k = i; !seen[k]; k = permutation[k]) {
            seen[k] = 1;
        }
    }
    return odd;
}

static int32_t sign_of_klu(tribo_sparse *s)
{
    int *seen = (int *)(s->work + 3 * (size_t)s->n);
    const double *pivots = s->klu_numeric->Udiag;
    int odd = is_odd(s->n, s->klu_numeric->Pnum, seen) ^ is_odd(s->n, s->klu_symbolic->Q, seen);
    for (int i = 0; i < s->n; i++) {
        odd ^= pivots[i] < 0.0;
    }
    return odd ? -1 : 1;
}

static tribo_status sign_of_umfpack(tribo_sparse *s, int32_t *sign)
{
    double mantissa;
    double exponent;
    const int status = umfpack_di_get_determinant(&mantissa, &exponent, s->umfpack_numeric, NULL);
    if (status < UMFPACK_OK) {
        return TRIBO_ERROR_MEMORY;
    }
    *sign = mantissa < 0.0 ? -1 : 1;
    return TRIBO_OK;
}

/* ---- the functions of tribo_linear ----------------------------------------------------------- */

static tribo_status analyse(tribo_sparse *s, uint32_t n, const uint32_t *row_starts,
                            const uint32_t *columns, uint32_t symmetric)
{
    tribo_status status = check_pattern(n, row_starts, columns, symmetric);
    if (status != TRIBO_OK) {
        return status;
    }
    forget(s);
    status = keep_pattern(s, n, row_starts, columns, symmetric);
    if (status == TRIBO_OK) {
        status = symmetric ? analyse_symmetric(s) : analyse_general(s);
    }
    if (status != TRIBO_OK) {
        forget(s);
        return status;
    }
    s->analyses++;
    return TRIBO_OK;
}

static tribo_status factor_values(tribo_sparse *s, const double *values)
{
    s->values = values;
    s->factorizations++;
    /* KLU and UMFPACK meet no pivot that would show what is not finite beside their blocks. */
    const tribo_status status = !all_finite(values, s->row_starts[s->n])
                                    ? TRIBO_ERROR_CONTACT_MATRIX
                                : s->analysis == CHOLMOD ? factor_symmetric(s)
                                : s->analysis == KLU     ? factor_klu(s)
                                                         : factor_umfpack(s);
    if (status != TRIBO_OK) {
        drop_factors(s);
    }
    return status;
}

static tribo_status factor(void *context, uint32_t n, const uint32_t *row_starts,
                           const uint32_t *columns, const double *values, uint32_t symmetric)
{
    tribo_sparse *s = context;
    if (!s || !row_starts || (n > 0 && (!columns || !values))) {
        return TRIBO_ERROR_NULL;
    }
    drop_factors(s);
    if (n == 0) {
        s->factors = EMPTY;
        s->factorizations++;
        return TRIBO_OK;
    }
    const uint32_t kind = symmetric != 0;
    const tribo_status status = is_known(s, n, row_starts, columns, kind)
                                    ? TRIBO_OK
                                    : analyse(s, n, row_starts, columns, kind);
    return status == TRIBO_OK ? factor_values(s, values) : status;
}

static tribo_status solve(void *context, double *x)
{
    tribo_sparse *s = context;
    if (!s || (!x && s->factors != EMPTY)) {
        return TRIBO_ERROR_NULL;
    }
    if (s->factors == NOBODY) {
        return TRIBO_ERROR_CONTACT_MATRIX;
    }
    s->solves++;
    return s->factors == EMPTY     ? TRIBO_OK
           : s->factors == CHOLMOD ? solve_symmetric(s, x)
                                   : solve_general(s, x);
}

static tribo_status sign(void *context, int32_t *out)
{
    tribo_sparse *s = context;
    if (!s || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (s->factors == NOBODY) {
        return TRIBO_ERROR_CONTACT_MATRIX;
    }
    if (s->factors == UMFPACK) {
        return sign_of_umfpack(s, out);
    }
    *out = s->factors == KLU ? sign_of_klu(s) : 1;
    return TRIBO_OK;
}

tribo_status tribo_sparse_linear(tribo_sparse *sparse, tribo_linear *linear)
{
    if (!sparse || !linear) {
        return TRIBO_ERROR_NULL;
    }
    const uint32_t size = linear->struct_size;
    if (size != sizeof *linear && size != offsetof(tribo_linear, sign)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    const tribo_linear full = {size, 0, sparse, factor, solve, sign};
    memcpy(linear, &full, size);
    return TRIBO_OK;
}

/* ---- report ---------------------------------------------------------------------------------- */

static void tell_factors(const tribo_sparse *s, tribo_sparse_info *info)
{
    if (s->factors == CHOLMOD) {
        info->fill = (uint64_t)s->cholmod.lnz;
        info->method = s->cholesky->is_super ? TRIBO_SPARSE_SUPERNODAL : TRIBO_SPARSE_SIMPLICIAL;
    } else if (s->factors == KLU) {
        info->fill = (uint64_t)s->klu_numeric->lnz + (uint64_t)s->klu_numeric->unz;
        info->method = TRIBO_SPARSE_SIMPLICIAL;
    } else if (s->factors == UMFPACK) {
        info->fill = (uint64_t)(s->umfpack_info[UMFPACK_LNZ] + s->umfpack_info[UMFPACK_UNZ]);
        info->method = TRIBO_SPARSE_SUPERNODAL;
    }
}

tribo_status tribo_sparse_report(const tribo_sparse *sparse, tribo_sparse_info *info)
{
    if (!sparse || !info) {
        return TRIBO_ERROR_NULL;
    }
    if (!size_is_known(info->struct_size, sizeof *info)) {
        return TRIBO_ERROR_STRUCT_SIZE;
    }
    tribo_sparse_info full;
    memset(&full, 0, sizeof full);
    full.struct_size = info->struct_size;
    full.factorizations = sparse->factorizations;
    full.analyses = sparse->analyses;
    full.solves = sparse->solves;
    full.bytes =
        sizeof *sparse + sparse->own_bytes + sparse->cholmod.memory_inuse + sparse->klu.memusage;
    if (sparse->umfpack_symbolic) {
        const double units =
            sparse->umfpack_info[UMFPACK_SYMBOLIC_SIZE] +
            (sparse->umfpack_numeric ? sparse->umfpack_info[UMFPACK_NUMERIC_SIZE] : 0.0);
        full.bytes += (uint64_t)(units * sparse->umfpack_info[UMFPACK_SIZE_OF_UNIT]);
    }
    tell_factors(sparse, &full);
    memcpy(info, &full, info->struct_size);
    return TRIBO_OK;
}
