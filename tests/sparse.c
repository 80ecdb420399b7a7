/* Sparse factorisations: residuals in quad precision, agreement with the dense ones, what is kept
 * between matrices, refusals, and memory that runs out at every place in turn. */
#include <tribo/sparse.h>

#include "check.h"
#include "dense.h"
#include "problems.h"
#include "quad.h"

#include <stdlib.h>

#include <suitesparse/SuiteSparse_config.h>

enum { SEED = 20160603, METHODS = 3, MOST = 1200, ENTRIES = 100000, DENSE = 130 };

/* A matrix as tribo_linear takes it. */
typedef struct matrix {
    uint32_t n, symmetric;
    uint32_t starts[MOST + 1];
    uint32_t columns[ENTRIES];
    double values[ENTRIES];
} matrix;

static matrix given, other;

/* ---- memory that is counted and may run out -------------------------------------------------- */

static struct {
    long live;       /* pieces that are out */
    long taken;      /* since the last reset */
    long fails_from; /* this one and all after it are refused; negative: none */
    uint32_t once;   /* only this one is refused */
    uint32_t hit;    /* one was refused since the last reset */
} memory;

static int refuses(void)
{
    const long number = memory.taken++;
    const int refused = memory.fails_from >= 0 &&
                        (memory.once ? number == memory.fails_from : number >= memory.fails_from);
    memory.hit = memory.hit || refused;
    return refused;
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
    return refuses() ? NULL : piece ? realloc(piece, size) : count_out(malloc(size));
}

static void counted_free(void *piece)
{
    memory.live -= piece != NULL;
    free(piece);
}

static void *allocate(void *user, size_t size)
{
    assert_ptr_equal(user, &memory);
    assert_true(size > 0);
    return counted_malloc(size);
}

static void release(void *user, void *piece)
{
    assert_ptr_equal(user, &memory);
    assert_non_null(piece);
    counted_free(piece);
}

static const tribo_allocator allocator = {sizeof allocator, 0, allocate, release, &memory};

static void reset_memory(long fails_from, uint32_t once)
{
    assert_int_equal(memory.live, 0);
    memory.taken = 0;
    memory.hit = 0;
    memory.fails_from = fails_from;
    memory.once = once;
}

static int count_memory(void **state)
{
    (void)state;
    SuiteSparse_config.malloc_func = counted_malloc;
    SuiteSparse_config.calloc_func = counted_calloc;
    SuiteSparse_config.realloc_func = counted_realloc;
    SuiteSparse_config.free_func = counted_free;
    memory.fails_from = -1;
    return 0;
}

/* ---- matrices -------------------------------------------------------------------------------- */

/* The same number for (i, j) and (j, i), in [-1, 1). */
static double noise(uint32_t i, uint32_t j, uint64_t index)
{
    problem_random random;
    problem_random_start(&random, index, SEED, (uint64_t)(i < j ? j : i) << 32 | (i < j ? i : j));
    return problem_random_uniform(&random, -1.0, 1.0);
}

/* Blocks of `block` rows; those of i and j meet if `meets` says so (i != j), symmetric pattern. The
 * diagonal outweighs the rest by `weight` to 1. */
static void draw(matrix *m, uint32_t blocks, uint32_t block, uint32_t symmetric, double weight,
                 uint32_t (*meets)(uint32_t i, uint32_t j, uint64_t index), uint64_t index)
{
    m->n = blocks * block;
    m->symmetric = symmetric;
    m->starts[0] = 0;
    for (uint32_t i = 0; i < m->n; i++) {
        uint32_t end = m->starts[i], diagonal = end;
        double sum = 1e-3;
        for (uint32_t j = 0; j < m->n; j++) {
            if (i / block != j / block && !meets(i / block, j / block, index)) {
                continue;
            }
            const double value = noise(i, j, index) + (symmetric || i > j ? 0.0 : 0.5);
            sum += fabs(value);
            if (!symmetric || j <= i) {
                assert_true(end < ENTRIES);
                diagonal = i == j ? end : diagonal;
                m->columns[end] = j;
                m->values[end++] = value;
            }
        }
        m->values[diagonal] = weight * sum;
        m->starts[i + 1] = end;
    }
}

static uint32_t meet_in_line(uint32_t i, uint32_t j, uint64_t index)
{
    (void)index;
    return i + 1 == j || j + 1 == i;
}

static uint32_t meet_at_random(uint32_t i, uint32_t j, uint64_t index)
{
    return noise(i, j, index + 1000) > 0.7;
}

static uint32_t meet_at_first(uint32_t i, uint32_t j, uint64_t index)
{
    (void)index;
    return i == 0 || j == 0;
}

static uint32_t meet_always(uint32_t i, uint32_t j, uint64_t index)
{
    (void)i;
    (void)j;
    (void)index;
    return 1;
}

/* Neighbours in a cube of five along each edge. */
static uint32_t meet_in_cube(uint32_t i, uint32_t j, uint64_t index)
{
    const int a = (int)i, b = (int)j;
    (void)index;
    return abs(a / 25 - b / 25) + abs(a / 5 % 5 - b / 5 % 5) + abs(a % 5 - b % 5) == 1;
}

/* Greatest |A x - b| over n eps (|A||x| + |b|), row by row, in quad precision. */
static double residual(const matrix *m, const double *x, const double *b)
{
    static quad_real sums[MOST];
    static double sizes[MOST];
    for (uint32_t i = 0; i < m->n; i++) {
        sums[i] = -(quad_real)b[i];
        sizes[i] = fabs(b[i]);
    }
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            const uint32_t twice = m->symmetric && j != i;
            sums[i] += (quad_real)m->values[k] * (quad_real)x[j];
            sizes[i] += fabs(m->values[k] * x[j]);
            sums[j] += twice ? (quad_real)m->values[k] * (quad_real)x[i] : (quad_real)0.0;
            sizes[j] += twice ? fabs(m->values[k] * x[i]) : 0.0;
        }
    }
    double greatest = 0.0;
    for (uint32_t i = 0; i < m->n; i++) {
        greatest = fmax(greatest, fabs((double)sums[i]) / sizes[i]);
    }
    return greatest / (m->n * EPS);
}

static double condition_bound(double weight)
{
    return (weight + 1.0) / (weight - 1.0);
}

/* Solve by dense elimination. */
static void solve_dense(const matrix *m, double *x)
{
    static double a[DENSE * (DENSE + 16)];
    static uint32_t pivots[DENSE];
    const dense_shape shape = dense_shape_of(m->n, m->n);
    const size_t ld = shape.stride;
    memset(a, 0, sizeof a);
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            a[m->symmetric ? j * ld + i : i * ld + j] = m->values[k];
        }
    }
    if (m->symmetric) {
        assert_true(dense_cholesky(TRIBO_ISA_BEST, &shape, a));
        dense_cholesky_solve(TRIBO_ISA_BEST, &shape, a, x);
    } else {
        assert_true(dense_lu(TRIBO_ISA_BEST, &shape, a, pivots));
        dense_lu_solve(TRIBO_ISA_BEST, &shape, a, pivots, x);
    }
}

/* ---- one object ------------------------------------------------------------------------------ */

static tribo_sparse *sparse;
static tribo_linear linear;

static void open_sparse(uint32_t method)
{
    linear.struct_size = sizeof linear;
    assert_int_equal(tribo_sparse_create(method, &allocator, &sparse), TRIBO_OK);
    assert_int_equal(tribo_sparse_linear(sparse, &linear), TRIBO_OK);
    assert_int_equal(linear.struct_size, sizeof linear);
}

static void close_sparse(void)
{
    tribo_sparse_destroy(sparse);
    assert_int_equal(memory.live, 0);
}

static tribo_status factor(const matrix *m)
{
    return linear.factor(linear.context, m->n, m->starts, m->columns, m->values, m->symmetric);
}

static tribo_sparse_info report(void)
{
    tribo_sparse_info info = {.struct_size = sizeof info};
    assert_int_equal(tribo_sparse_report(sparse, &info), TRIBO_OK);
    return info;
}

static void draw_side(uint32_t n, uint64_t index, double *b)
{
    for (uint32_t i = 0; i < n; i++) {
        b[i] = noise(i, n, index + 5000);
    }
}

/* Factor, solve two right-hand sides and judge them. */
static void check_solution(const matrix *m, double weight)
{
    static double b[MOST], x[MOST], expected[MOST];
    assert_int_equal(factor(m), TRIBO_OK);
    for (uint64_t side = 0; side < 2; side++) {
        draw_side(m->n, side, b);
        memcpy(x, b, sizeof x);
        assert_int_equal(linear.solve(linear.context, x), TRIBO_OK);
        within(residual(m, x, b), 1.0);
        if (m->n <= DENSE) {
            memcpy(expected, b, sizeof x);
            solve_dense(m, expected);
            for (uint32_t i = 0; i < m->n; i++) {
                within(fabs(x[i] - expected[i]),
                       m->n * EPS * condition_bound(weight) * fmax(1.0, fabs(expected[i])));
            }
        }
    }
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void check_family(uint32_t (*meets)(uint32_t i, uint32_t j, uint64_t index), uint64_t index)
{
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            open_sparse(method);
            for (uint32_t n = 1; n <= 40; n += n < 6 ? 1 : 17) {
                draw(&given, n, 3, symmetric, 1.25, meets, index + n);
                check_solution(&given, 1.25);
                draw(&given, n, 1, symmetric, 4.0, meets, index + n);
                check_solution(&given, 4.0);
            }
            close_sparse();
        }
    }
}

static void test_solutions(void **state)
{
    (void)state;
    check_family(meet_in_line, 1);
    check_family(meet_at_random, 2);
    check_family(meet_at_first, 3);
    check_family(meet_always, 4);
    settle("residuals, n eps, and distance from the dense solution");
}

/* No diagonal that could be trusted: KLU and UMFPACK have to look for pivots. */
static void test_pivoting(void **state)
{
    (void)state;
    static double b[MOST], x[MOST];
    for (uint32_t method = 0; method < METHODS; method++) {
        open_sparse(method);
        for (uint64_t index = 0; index < 30; index++) {
            draw(&given, 40, 3, 0, 1.0, meet_at_random, index);
            for (uint32_t i = 0; i < given.n; i++) {
                for (uint32_t k = given.starts[i]; k < given.starts[i + 1]; k++) {
                    given.values[k] *= given.columns[k] == i ? 1e-18 : 1.0;
                }
            }
            assert_int_equal(factor(&given), TRIBO_OK);
            draw_side(given.n, index, b);
            memcpy(x, b, sizeof x);
            assert_int_equal(linear.solve(linear.context, x), TRIBO_OK);
            within(residual(&given, x, b), 1.0);
        }
        close_sparse();
    }
    settle("residuals without a diagonal, n eps");
}

/* A cube of blocks fills its factors up, a line does not: each has its method. */
static void test_methods(void **state)
{
    static const uint32_t thin[METHODS] = {TRIBO_SPARSE_SIMPLICIAL, TRIBO_SPARSE_SIMPLICIAL,
                                           TRIBO_SPARSE_SUPERNODAL};
    static const uint32_t full[METHODS] = {TRIBO_SPARSE_SUPERNODAL, TRIBO_SPARSE_SIMPLICIAL,
                                           TRIBO_SPARSE_SUPERNODAL};
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            open_sparse(method);
            assert_int_equal(report().method, TRIBO_SPARSE_AUTO);
            draw(&given, 125, 6, symmetric, 1.25, meet_in_cube, 7);
            check_solution(&given, 1.25);
            assert_int_equal(report().method, full[method]);
            assert_true(report().fill > given.starts[given.n]);
            draw(&given, 100, 6, symmetric, 1.25, meet_in_line, 8);
            check_solution(&given, 1.25);
            assert_int_equal(report().method, thin[method]);
            close_sparse();
        }
    }
    settle("residuals of 600 and 750 rows, n eps");
}

static void test_analysis_is_kept(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            open_sparse(method);
            uint64_t bytes = 0;
            for (uint64_t k = 0; k < 5; k++) {
                draw(&given, 20, 3, symmetric, 2.0 + (double)k, meet_in_line, k);
                check_solution(&given, 2.0);
                assert_int_equal(report().analyses, 1);
                assert_int_equal(report().factorizations, k + 1);
                assert_int_equal(report().solves, 2 * (k + 1));
                assert_true(report().bytes > 8 * report().fill);
                bytes = k == 1 ? report().bytes : bytes;
            }
            assert_true(report().bytes < bytes + bytes / 4);
            /* The same number of rows and entries, one column elsewhere. */
            draw(&given, 20, 1, symmetric, 2.0, meet_in_line, 1);
            check_solution(&given, 2.0);
            assert_int_equal(report().analyses, 2);
            given.columns[given.starts[9]] = 1;
            check_solution(&given, 1.5);
            assert_int_equal(report().analyses, 3);
            check_solution(&given, 1.5);
            assert_int_equal(report().analyses, 3);
            close_sparse();
        }
    }
    settle("residuals of matrices of one pattern, n eps");
}

/* The same columns one after the other, broken into rows elsewhere. */
static void test_rows_are_part_of_the_pattern(void **state)
{
    static const uint32_t starts[2][4] = {{0, 3, 4, 5}, {0, 1, 3, 5}};
    static const uint32_t columns[5] = {0, 1, 2, 1, 2};
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        open_sparse(method);
        for (uint32_t k = 0; k < 4; k++) {
            given.n = 3;
            given.symmetric = 0;
            memcpy(given.starts, starts[k % 2], sizeof starts[0]);
            memcpy(given.columns, columns, sizeof columns);
            for (uint32_t i = 0; i < 5; i++) {
                given.values[i] = 2.0 + noise(i, k, 1);
            }
            given.values[k % 2 == 0 ? 0 : 4] = 9.0;
            check_solution(&given, 1.25);
            assert_int_equal(report().analyses, k + 1);
        }
        close_sparse();
    }
    settle("residuals of three rows, n eps");
}

/* The pattern of a triangle may be that of a whole matrix as well. */
static void test_symmetric_is_part_of_the_pattern(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        open_sparse(method);
        draw(&given, 30, 1, 1, 2.0, meet_in_line, 1);
        check_solution(&given, 2.0);
        given.symmetric = 0;
        check_solution(&given, 2.0);
        assert_int_equal(report().analyses, 2);
        given.symmetric = 1;
        check_solution(&given, 2.0);
        assert_int_equal(report().analyses, 3);
        close_sparse();
    }
    settle("residuals of a triangle, n eps");
}

static void test_none_and_one(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            const uint32_t starts[2] = {0, 1}, column = 0;
            const double value = 4.0;
            double x = 2.0;
            open_sparse(method);
            assert_int_equal(linear.factor(linear.context, 0, starts, NULL, NULL, symmetric),
                             TRIBO_OK);
            assert_int_equal(linear.solve(linear.context, NULL), TRIBO_OK);
            assert_int_equal(report().method, TRIBO_SPARSE_AUTO);
            assert_int_equal(linear.factor(linear.context, 1, starts, &column, &value, symmetric),
                             TRIBO_OK);
            assert_int_equal(linear.solve(linear.context, &x), TRIBO_OK);
            assert_true(x == 0.5);
            assert_int_equal(linear.factor(linear.context, 0, starts, NULL, NULL, symmetric),
                             TRIBO_OK);
            assert_int_equal(linear.solve(linear.context, &x), TRIBO_OK);
            assert_true(x == 0.5);
            close_sparse();
        }
    }
}

/* ---- refusals -------------------------------------------------------------------------------- */

/* `given` is singular: it is refused, x stays, and the next good matrix is solved. */
static void check_singular(void)
{
    double x[MOST] = {7.0};
    assert_int_equal(factor(&given), TRIBO_ERROR_CONTACT_MATRIX);
    assert_int_equal(linear.solve(linear.context, x), TRIBO_ERROR_CONTACT_MATRIX);
    assert_true(x[0] == 7.0);
    assert_int_equal(report().fill, 0);
    draw(&other, 20, 3, given.symmetric, 2.0, meet_in_line, 1);
    check_solution(&other, 2.0);
}

static void scale_row(uint32_t row, double factor_of_row)
{
    for (uint32_t k = given.starts[row]; k < given.starts[row + 1]; k++) {
        given.values[k] *= factor_of_row;
    }
}

static void check_singular_matrices(uint32_t symmetric)
{
    draw(&given, 20, 3, symmetric, 2.0, meet_in_line, 1);
    memset(given.values, 0, sizeof given.values);
    check_singular();
    for (uint32_t row = 0; row < 60; row += 59) {
        draw(&given, 20, 3, symmetric, 2.0, meet_in_line, 1);
        scale_row(row, 0.0);
        check_singular();
        for (int i = 0; i < 3; i++) {
            draw(&given, 20, 3, symmetric, 2.0, meet_in_line, 1);
            given.values[given.starts[row]] = not_finite[i];
            check_singular();
        }
    }
    if (symmetric) {
        draw(&given, 20, 3, 1, -2.0, meet_in_line, 1);
        check_singular();
        draw(&given, 20, 3, 1, 2.0, meet_in_line, 1);
        given.values[given.starts[31] - 1] = 1e-3; /* less than its row needs */
        check_singular();
    }
}

static void test_singular_is_refused(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            open_sparse(method);
            check_singular_matrices(symmetric);
            close_sparse();
        }
    }
    settle("residuals after a singular matrix, n eps");
}

static void check_bad_pattern(uint32_t n, const uint32_t *starts, const uint32_t *columns,
                              uint32_t symmetric, tribo_status expected)
{
    const double values[4] = {1.0, 1.0, 1.0, 1.0};
    double x[2] = {1.0, 2.0};
    assert_int_equal(linear.factor(linear.context, n, starts, columns, values, symmetric),
                     expected);
    assert_int_equal(linear.solve(linear.context, x), TRIBO_ERROR_CONTACT_MATRIX);
    assert_int_equal(report().analyses, 0);
}

static void test_bad_patterns_are_refused(void **state)
{
    static const uint32_t full[3] = {0, 2, 4}, triangle[3] = {0, 1, 3};
    static const uint32_t late[3] = {1, 2, 4}, falling[3] = {0, 3, 2}, beyond[3] = {0, 5, 4};
    static const uint32_t huge[3] = {0, 2, INT32_MAX};
    static const uint32_t square[4] = {0, 1, 0, 1}, twice[4] = {0, 0, 0, 1};
    static const uint32_t swapped[4] = {1, 0, 0, 1}, outside[4] = {0, 2, 0, 1};
    static const uint32_t above[3] = {1, 0, 1};
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        open_sparse(method);
        check_bad_pattern(2, late, square, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, falling, square, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, beyond, square, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, huge, square, 0, TRIBO_ERROR_CAPACITY);
        check_bad_pattern(2, full, twice, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, full, swapped, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, full, outside, 0, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, full, square, 1, TRIBO_ERROR_INDEX);
        check_bad_pattern(2, triangle, above, 1, TRIBO_ERROR_INDEX);
        check_bad_pattern(INT32_MAX, full, square, 0, TRIBO_ERROR_CAPACITY);
        close_sparse();
    }
}

/* Sign of the determinant by elimination with pivots, rows exchanged and negative pivots counted. */
static int32_t sign_of(const matrix *m)
{
    static double a[DENSE][DENSE];
    int32_t sign = 1;
    memset(a, 0, sizeof a);
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            a[i][m->columns[k]] = m->values[k];
        }
    }
    for (uint32_t k = 0; k < m->n; k++) {
        uint32_t pivot = k;
        for (uint32_t i = k + 1; i < m->n; i++) {
            pivot = fabs(a[i][k]) > fabs(a[pivot][k]) ? i : pivot;
        }
        for (uint32_t j = 0; j < m->n; j++) {
            const double held = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = held;
        }
        sign = (pivot != k) != (a[k][k] < 0.0) ? -sign : sign;
        for (uint32_t i = k + 1; i < m->n; i++) {
            const double l = a[i][k] / a[k][k];
            for (uint32_t j = k; j < m->n; j++) {
                a[i][j] -= l * a[k][j];
            }
        }
    }
    return sign;
}

static void test_signs(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        uint32_t negative = 0;
        int32_t sign = 7;
        open_sparse(method);
        assert_int_equal(linear.sign(linear.context, &sign), TRIBO_ERROR_CONTACT_MATRIX);
        assert_int_equal(sign, 7);
        for (uint64_t index = 0; index < 200; index++) {
            const uint32_t blocks = 1 + (uint32_t)(index % 12);
            /* the lighter the diagonal, the more pivots are looked for elsewhere */
            draw(&given, blocks, 3, 0, index % 2 ? 0.02 : 1.25,
                 index % 3 ? meet_at_random : meet_in_line, index);
            if (factor(&given) != TRIBO_OK) {
                continue;
            }
            assert_int_equal(linear.sign(linear.context, &sign), TRIBO_OK);
            assert_int_equal(sign, sign_of(&given));
            negative += sign < 0;
        }
        assert_true(negative > 40 && negative < 160);
        draw(&given, 9, 3, 1, 1.25, meet_in_line, 1);
        assert_int_equal(factor(&given), TRIBO_OK);
        assert_int_equal(linear.sign(linear.context, &sign), TRIBO_OK);
        assert_int_equal(sign, 1);
        assert_int_equal(linear.sign(linear.context, NULL), TRIBO_ERROR_NULL);
        assert_int_equal(linear.sign(NULL, &sign), TRIBO_ERROR_NULL);
        close_sparse();
    }
}

static void test_null_and_options(void **state)
{
    static const uint32_t starts[2] = {0, 1}, column = 0;
    static const double value = 1.0;
    const tribo_allocator small = {sizeof small - 4, 0, allocate, release, &memory};
    const tribo_allocator mute = {sizeof mute, 0, NULL, release, &memory};
    const tribo_allocator keeper = {sizeof keeper, 0, allocate, NULL, &memory};
    tribo_sparse *none = NULL;
    (void)state;
    assert_int_equal(tribo_sparse_create(0, &allocator, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_create(0, &small, &none), TRIBO_ERROR_STRUCT_SIZE);
    assert_int_equal(tribo_sparse_create(0, &mute, &none), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_create(0, &keeper, &none), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_create(METHODS, &allocator, &none), TRIBO_ERROR_OPTION);
    assert_null(none);
    tribo_sparse_destroy(NULL);

    open_sparse(0);
    tribo_linear short_one = {.struct_size = offsetof(tribo_linear, sign) - 8};
    tribo_sparse_info info = {.struct_size = 3};
    double x = 1.0;
    assert_int_equal(tribo_sparse_linear(NULL, &short_one), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_linear(sparse, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_linear(sparse, &short_one), TRIBO_ERROR_STRUCT_SIZE);
    assert_null(short_one.factor);
    short_one.struct_size = sizeof short_one - 4;
    assert_int_equal(tribo_sparse_linear(sparse, &short_one), TRIBO_ERROR_STRUCT_SIZE);
    short_one.struct_size = sizeof short_one + 8;
    assert_int_equal(tribo_sparse_linear(sparse, &short_one), TRIBO_ERROR_STRUCT_SIZE);
    short_one.struct_size = offsetof(tribo_linear, sign); /* an older one */
    assert_int_equal(tribo_sparse_linear(sparse, &short_one), TRIBO_OK);
    assert_non_null(short_one.solve);
    assert_null(short_one.sign);
    assert_int_equal(tribo_sparse_report(NULL, &info), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_report(sparse, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_sparse_report(sparse, &info), TRIBO_ERROR_STRUCT_SIZE);
    info.struct_size = sizeof info + 8;
    assert_int_equal(tribo_sparse_report(sparse, &info), TRIBO_ERROR_STRUCT_SIZE);
    info.factorizations = 77;
    info.struct_size = 8; /* an older one */
    assert_int_equal(tribo_sparse_report(sparse, &info), TRIBO_OK);
    assert_int_equal(info.factorizations, 77);
    assert_int_equal(linear.factor(NULL, 1, starts, &column, &value, 1), TRIBO_ERROR_NULL);
    assert_int_equal(linear.factor(sparse, 1, NULL, &column, &value, 1), TRIBO_ERROR_NULL);
    assert_int_equal(linear.factor(sparse, 1, starts, NULL, &value, 1), TRIBO_ERROR_NULL);
    assert_int_equal(linear.factor(sparse, 1, starts, &column, NULL, 1), TRIBO_ERROR_NULL);
    assert_int_equal(linear.solve(sparse, &x), TRIBO_ERROR_CONTACT_MATRIX);
    assert_int_equal(linear.solve(sparse, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(linear.solve(NULL, &x), TRIBO_ERROR_NULL);
    close_sparse();
}

static void test_default_allocator(void **state)
{
    (void)state;
    const long before = memory.taken;
    assert_int_equal(tribo_sparse_create(0, NULL, &sparse), TRIBO_OK);
    assert_int_equal(memory.taken, before);
    tribo_sparse_destroy(sparse);
}

/* ---- dissection ------------------------------------------------------------------------------ */

/* Bodies on a lattice in space, six rows each, every one linked to its six neighbours: the lower
 * triangle, far from dense. */
typedef struct lattice {
    uint32_t n;
    uint32_t *starts, *columns;
    double *values;
} lattice;

/* The one next to body b along an axis, -1 or +1; or b if that is outside. */
static uint32_t next_to(uint32_t b, uint32_t edge, uint32_t axis, int way)
{
    const uint32_t stride = axis == 0 ? 1 : axis == 1 ? edge : edge * edge;
    const uint32_t at = b / stride % edge;
    return way < 0 ? (at > 0 ? b - stride : b) : at + 1 < edge ? b + stride : b;
}

static void build_lattice(uint32_t edge, lattice *m)
{
    const uint32_t bodies = edge * edge * edge;
    uint32_t at = 0;
    m->n = 6 * bodies;
    m->starts = malloc((m->n + 1) * sizeof *m->starts);
    m->columns = malloc((size_t)m->n * 24 * sizeof *m->columns);
    m->values = malloc((size_t)m->n * 24 * sizeof *m->values);
    for (uint32_t row = 0; row < m->n; row++) {
        m->starts[row] = at;
        for (uint32_t axis = 3; axis-- > 0;) {
            const uint32_t other_body = next_to(row / 6, edge, axis, -1);
            for (uint32_t k = 0; k < 6 && other_body != row / 6; k++) {
                m->columns[at] = 6 * other_body + k;
                m->values[at++] = 0.1 * noise(row, 6 * other_body + k, 9);
            }
        }
        for (uint32_t column = row / 6 * 6; column <= row; column++) {
            m->columns[at] = column;
            m->values[at++] = column == row ? 6.0 : 0.1 * noise(row, column, 9);
        }
    }
    m->starts[m->n] = at;
}

static void free_lattice(lattice *m)
{
    free(m->starts);
    free(m->columns);
    free(m->values);
}

/* |A x - b| / (n eps |x|), greatest entries. */
static double lattice_residual(const lattice *m, const double *x, const double *b)
{
    double *rest = malloc(m->n * sizeof *rest);
    double left = 0.0, most = 0.0;
    memcpy(rest, b, m->n * sizeof *rest);
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            rest[i] -= m->values[k] * x[j];
            rest[j] -= i != j ? m->values[k] * x[i] : 0.0;
        }
    }
    for (uint32_t i = 0; i < m->n; i++) {
        left = fmax(left, fabs(rest[i]));
        most = fmax(most, fabs(x[i]));
    }
    free(rest);
    return left / ((double)m->n * DBL_EPSILON * most);
}

/* Returns the numbers in the factors; 0 if memory ran out. */
static uint64_t solve_lattice(const lattice *m, double *x)
{
    tribo_sparse_info info = {.struct_size = sizeof info};
    double *b = malloc(m->n * sizeof *b);
    for (uint32_t i = 0; i < m->n; i++) {
        b[i] = x[i] = noise(i, i, 10);
    }
    tribo_status status = linear.factor(linear.context, m->n, m->starts, m->columns, m->values, 1);
    if (status == TRIBO_OK) {
        status = linear.solve(linear.context, x);
        assert_true(status != TRIBO_OK || lattice_residual(m, x, b) <= 1.0);
    }
    assert_true(status == TRIBO_OK || status == TRIBO_ERROR_MEMORY);
    assert_int_equal(tribo_sparse_report(sparse, &info), TRIBO_OK);
    free(b);
    return status == TRIBO_OK ? info.fill : 0;
}

/* AMD leaves 5 418 348 numbers in the factors of 14^3 bodies. */
static void test_lattices_are_dissected(void **state)
{
    lattice m;
    (void)state;
    build_lattice(14, &m);
    double *x = malloc(m.n * sizeof *x);
    double *again = malloc(m.n * sizeof *again);
    open_sparse(TRIBO_SPARSE_AUTO);
    const uint64_t fill = solve_lattice(&m, x);
    close_sparse();
    open_sparse(TRIBO_SPARSE_AUTO);
    assert_int_equal(solve_lattice(&m, again), fill);
    close_sparse();
    print_message("# lattice of %u rows: %llu numbers\n", (unsigned)m.n, (unsigned long long)fill);
    assert_true(fill > 0 && fill <= 4400000);
    assert_memory_equal(x, again, m.n * sizeof *x);
    free(x);
    free(again);
    free_lattice(&m);
}

/* Where memory for it is short, AMD's order is as good. */
static void test_dissection_may_lack_memory(void **state)
{
    lattice m;
    uint32_t dissected = 0, not_dissected = 0, refused = 0;
    (void)state;
    build_lattice(10, &m);
    double *x = malloc(m.n * sizeof *x);
    open_sparse(TRIBO_SPARSE_AUTO);
    const uint64_t fill = solve_lattice(&m, x);
    close_sparse();
    for (long place = 0; place < 200 || memory.hit; place++) {
        open_sparse(TRIBO_SPARSE_AUTO);
        memory.taken = memory.hit = 0;
        memory.fails_from = place;
        memory.once = 1;
        const uint64_t found = solve_lattice(&m, x);
        memory.fails_from = -1;
        dissected += found == fill;
        not_dissected += found > fill;
        refused += found == 0;
        close_sparse();
        assert_int_equal(memory.live, 0);
        if (!memory.hit) {
            break;
        }
    }
    print_message("# lattice of %u rows: %u dissected, %u not, %u refused\n", (unsigned)m.n,
                  (unsigned)dissected, (unsigned)not_dissected, (unsigned)refused);
    assert_true(not_dissected > 5 && refused > 5);
    free(x);
    free_lattice(&m);
}

/* ---- memory runs out ------------------------------------------------------------------------- */

/* Two matrices with memory that fails; returns whether all of it went well. */
static int run_short_of_memory(uint32_t method)
{
    static double b[MOST], x[MOST];
    tribo_status status = tribo_sparse_create(method, &allocator, &sparse);
    if (status != TRIBO_OK) {
        assert_int_equal(status, TRIBO_ERROR_MEMORY);
        return 0;
    }
    assert_int_equal(tribo_sparse_linear(sparse, &linear), TRIBO_OK);
    int good = 1;
    for (int k = 0; k < 2; k++) {
        const matrix *m = k == 0 ? &given : &other;
        draw_side(m->n, 1, b);
        memcpy(x, b, sizeof x);
        status = factor(m);
        if (status == TRIBO_OK) {
            status = linear.solve(linear.context, x);
            assert_true(status != TRIBO_OK || residual(m, x, b) <= 1.0);
        }
        assert_true(status == TRIBO_OK || status == TRIBO_ERROR_MEMORY);
        good = good && status == TRIBO_OK;
    }
    memory.fails_from = -1;
    check_solution(&other, 1.25); /* there is memory again */
    check_solution(&given, 1.25);
    close_sparse();
    return good;
}

static void fail_each(uint32_t method, uint32_t once)
{
    long refusals = 0, place = -1;
    do {
        reset_memory(++place, once);
        refusals += !run_short_of_memory(method);
    } while (memory.hit);
    reset_memory(-1, 0);
    print_message("# method %u, %s: %ld places, %ld refusals\n", (unsigned)method,
                  once ? "once" : "from there on", place, refusals);
    assert_true(refusals > 10);
}

static void test_memory_runs_out(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < METHODS; method++) {
        for (uint32_t symmetric = 0; symmetric < 2; symmetric++) {
            draw(&given, 20, 3, symmetric, 1.25, meet_at_random, 3);
            draw(&other, 30, 3, symmetric, 1.25, meet_in_line, 4);
            fail_each(method, 0);
            fail_each(method, 1);
        }
    }
    settle("residuals once there is memory again, n eps");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_solutions),
        TEST(test_pivoting),
        TEST(test_methods),
        TEST(test_analysis_is_kept),
        TEST(test_rows_are_part_of_the_pattern),
        TEST(test_symmetric_is_part_of_the_pattern),
        TEST(test_none_and_one),
        TEST(test_singular_is_refused),
        TEST(test_bad_patterns_are_refused),
        TEST(test_signs),
        TEST(test_null_and_options),
        TEST(test_default_allocator),
        TEST(test_lattices_are_dissected),
        TEST(test_dissection_may_lack_memory),
        TEST(test_memory_runs_out),
    };
    return cmocka_run_group_tests_name("sparse", tests, count_memory, NULL);
}
