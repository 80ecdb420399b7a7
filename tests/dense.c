/* Dense factorisations: small residuals, the bits of the textbook's loops whatever the instruction
 * set, pivots that cannot be. */
#include "dense.h"

#include "check.h"
#include "problems.h"
#include "quad.h"

#include <stdlib.h>

enum { SEED = 20160603, ISAS = 5, MOST = 136, GREATEST = 200 };

static const uint32_t sizes[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,   10,  11,  12,  13,  14,
                                 15, 16, 17, 19, 20, 22, 23, 24, 25, 31,  32,  33,  40,  47,  48,
                                 57, 63, 64, 65, 71, 72, 73, 96, 99, 120, 127, 128, 135, MOST};

enum { SIZES = sizeof sizes / sizeof sizes[0], NUMBERS = GREATEST * (GREATEST + 16) };

static double given[NUMBERS];   /* a matrix, dense_stride apart */
static double factors[NUMBERS]; /* what became of it */
static double plain[NUMBERS];   /* what the textbook makes of it */
static uint32_t pivots[GREATEST], plain_pivots[GREATEST];

/* ---- matrices -------------------------------------------------------------------------------- */

static void draw(uint32_t n, uint64_t index, double *a)
{
    problem_random random;
    problem_random_start(&random, 71, SEED, index);
    for (size_t i = 0; i < n * dense_stride(n); i++) {
        a[i] = problem_random_uniform(&random, -1.0, 1.0);
    }
}

/* G G^T + `shift`: positive definite, of condition up to about n^2 / shift. */
static void draw_positive(uint32_t n, uint64_t index, double shift, double *a)
{
    const size_t ld = dense_stride(n);
    draw(n, index, plain);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            double sum = i == j ? shift : 0.0;
            for (size_t k = 0; k < n; k++) {
                sum += plain[i * ld + k] * plain[j * ld + k];
            }
            a[i * ld + j] = sum;
        }
    }
}

/* The numbers that the functions must not look at: NaN in all places that the contract calls
 * scratch. */
static void poison(uint32_t n, int triangle, double *a)
{
    const size_t ld = dense_stride(n);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < ld; j++) {
            a[i * ld + j] = j >= n || (triangle && j < i) ? NOT_A_NUMBER : a[i * ld + j];
        }
    }
}

/* Greatest |A x - b| over n eps (|A||x| + |b|), row by row, in quad precision. */
static double residual(uint32_t n, const double *a, const double *x, const double *b)
{
    const size_t ld = dense_stride(n);
    double greatest = 0.0;
    for (size_t i = 0; i < n; i++) {
        quad_real sum = -(quad_real)b[i];
        double size = fabs(b[i]);
        for (size_t j = 0; j < n; j++) {
            sum += (quad_real)a[i * ld + j] * (quad_real)x[j];
            size += fabs(a[i * ld + j] * x[j]);
        }
        greatest = fmax(greatest, fabs((double)sum) / size);
    }
    return greatest / (n * EPS);
}

/* ---- the textbook ---------------------------------------------------------------------------- */

static int plain_cholesky(uint32_t n, double *a)
{
    const size_t ld = dense_stride(n);
    for (size_t k = 0; k < n; k++) {
        if (!(a[k * ld + k] > 0.0)) {
            return 0;
        }
        a[k * ld + k] = 1.0 / sqrt(a[k * ld + k]);
        for (size_t j = k + 1; j < n; j++) {
            a[k * ld + j] = a[k * ld + j] * a[k * ld + k];
        }
        for (size_t i = k + 1; i < n; i++) {
            for (size_t j = i; j < n; j++) {
                const double product = a[k * ld + i] * a[k * ld + j];
                a[i * ld + j] = a[i * ld + j] - product;
            }
        }
    }
    return 1;
}

/* Of L, only the columns of the block of eight that k is in are exchanged. */
static void plain_swap(uint32_t n, double *a, size_t i, size_t k)
{
    const size_t ld = dense_stride(n);
    for (size_t j = k / 8 * 8; j < n; j++) {
        const double value = a[i * ld + j];
        a[i * ld + j] = a[k * ld + j];
        a[k * ld + j] = value;
    }
}

static int plain_lu(uint32_t n, double *a, uint32_t *rows)
{
    const size_t ld = dense_stride(n);
    for (size_t k = 0; k < n; k++) {
        size_t at = k;
        for (size_t i = k + 1; i < n; i++) {
            at = fabs(a[i * ld + k]) > fabs(a[at * ld + k]) ? i : at;
        }
        rows[k] = (uint32_t)at;
        plain_swap(n, a, at, k);
        if (a[k * ld + k] == 0.0) {
            return 0;
        }
        a[k * ld + k] = 1.0 / a[k * ld + k];
        for (size_t i = k + 1; i < n; i++) {
            a[i * ld + k] = a[i * ld + k] * a[k * ld + k];
            for (size_t j = k + 1; j < n; j++) {
                const double product = a[i * ld + k] * a[k * ld + j];
                a[i * ld + j] = a[i * ld + j] - product;
            }
        }
    }
    return 1;
}

/* Whether the factors hold the same bits where the contract says that there are factors. */
static int same_factors(uint32_t n, int triangle, const double *a, const double *b)
{
    const size_t ld = dense_stride(n);
    for (size_t i = 0; i < n; i++) {
        const size_t from = triangle ? i : 0;
        if (memcmp(a + i * ld + from, b + i * ld + from, (n - from) * sizeof *a) != 0) {
            return 0;
        }
    }
    return 1;
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void test_strides(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 4096; n++) {
        assert_true(dense_stride(n) >= n);
        assert_true(dense_stride(n) < n + 16);
        assert_int_equal(dense_stride(n) % 16, 8);
    }
}

static int factor_in(uint32_t isa, dense_shape shape, int symmetric)
{
    double *a = factors + shape.origin;
    return symmetric ? dense_cholesky(isa, &shape, a) : dense_lu(isa, &shape, a, pivots);
}

static void solve_in(uint32_t isa, dense_shape shape, int symmetric, double *x)
{
    const double *a = factors + shape.origin;
    if (symmetric) {
        dense_cholesky_solve(isa, &shape, a, x);
    } else {
        dense_lu_solve(isa, &shape, a, pivots, x);
    }
}

/* One matrix by the textbook and at every instruction set. */
static void check_bits(uint32_t n, int symmetric)
{
    const size_t bytes = n * dense_stride(n) * sizeof *given;
    memcpy(plain, given, bytes);
    assert_true(symmetric ? plain_cholesky(n, plain) : plain_lu(n, plain, plain_pivots));
    poison(n, symmetric, given);
    for (uint32_t isa = 0; isa < ISAS; isa++) {
        if (!tribo_isa_available(isa)) {
            continue;
        }
        memcpy(factors, given, bytes);
        assert_true(factor_in(isa, dense_shape_of(n, n), symmetric));
        assert_true(same_factors(n, symmetric, factors, plain));
        assert_true(symmetric || memcmp(pivots, plain_pivots, n * sizeof *pivots) == 0);
    }
}

static void test_bits_are_the_textbooks(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < SIZES; k++) {
        draw_positive(sizes[k], k, 1e-3, given);
        check_bits(sizes[k], 1);
        draw(sizes[k], k, given);
        check_bits(sizes[k], 0);
    }
}

static void solve(uint32_t isa, uint32_t n, int symmetric, double *x)
{
    const dense_shape shape = dense_shape_of(n, n);
    memcpy(factors, given, n * dense_stride(n) * sizeof *given);
    poison(n, symmetric, factors);
    assert_true(factor_in(isa, shape, symmetric));
    solve_in(isa, shape, symmetric, x);
}

/* Residuals of all instruction sets, and their equal bits. */
static void check_solution(uint32_t n, int symmetric, uint64_t index)
{
    double b[GREATEST] = {0.0}, x[GREATEST], first[GREATEST];
    problem_random random;
    problem_random_start(&random, 72, SEED, index);
    for (size_t i = 0; i < n; i++) {
        b[i] = problem_random_uniform(&random, -1.0, 1.0);
    }
    memcpy(first, b, sizeof first);
    solve(TRIBO_ISA_BEST, n, symmetric, first);
    for (uint32_t isa = 1; isa < ISAS; isa++) {
        if (tribo_isa_available(isa)) {
            memcpy(x, b, sizeof x);
            solve(isa, n, symmetric, x);
            assert_memory_equal(x, first, n * sizeof *x);
        }
    }
    if (n > 0) {
        within(residual(n, given, first, b), 1.0);
    }
}

static void test_cholesky_residuals(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < SIZES; k++) {
        draw_positive(sizes[k], 100 + k, 1.0, given);
        check_solution(sizes[k], 1, k);
        draw_positive(sizes[k], 200 + k, 1e-9, given);
        check_solution(sizes[k], 1, k);
    }
    draw_positive(GREATEST, 300, 1e-6, given);
    check_solution(GREATEST, 1, 300);
    settle("residual of Cholesky, n eps");
}

/* Small diagonals make each column look for its pivot. */
static void test_lu_residuals(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < SIZES; k++) {
        draw(sizes[k], 400 + k, given);
        for (size_t i = 0; i < sizes[k]; i++) {
            given[i * dense_stride(sizes[k]) + i] *= k % 3 == 0 ? 1.0 : k % 3 == 1 ? 1e-20 : 0.0;
        }
        if (sizes[k] != 1) {
            check_solution(sizes[k], 0, k);
        }
    }
    draw(GREATEST, 500, given);
    check_solution(GREATEST, 0, 500);
    settle("residual of LU, n eps");
}

/* Permutation matrices: every row is somewhere else, and the answer is exact. */
static void test_permutations_are_exact(void **state)
{
    (void)state;
    for (uint64_t k = 1; k < SIZES; k++) {
        const uint32_t n = sizes[k];
        double x[MOST];
        memset(given, 0, sizeof given);
        for (uint32_t i = 0; i < n; i++) {
            given[i * dense_stride(n) + (i + n / 2) % n] = 2.0;
            x[i] = i;
        }
        solve(TRIBO_ISA_BEST, n, 0, x);
        for (uint32_t i = 0; i < n; i++) {
            assert_true(x[(i + n / 2) % n] == 0.5 * i);
        }
    }
}

static int factor_at(uint32_t isa, uint32_t n, int symmetric)
{
    memcpy(factors, given, n * dense_stride(n) * sizeof *given);
    return factor_in(isa, dense_shape_of(n, n), symmetric);
}

/* Put `value` on the diagonal and see each instruction set refuse, whichever place it is. */
static void check_refused(uint32_t n, double value, int symmetric)
{
    for (size_t at = 0; at < n; at++) {
        memset(given, 0, sizeof given);
        for (size_t i = 0; i < n; i++) {
            given[i * dense_stride(n) + i] = i == at ? value : 1.0;
        }
        for (uint32_t isa = 0; isa < ISAS; isa++) {
            if (tribo_isa_available(isa)) {
                assert_false(factor_at(isa, n, symmetric));
            }
        }
    }
}

static void test_bad_pivots_are_refused(void **state)
{
    (void)state;
    for (uint32_t n = 1; n < 28; n++) {
        check_refused(n, 0.0, 1);
        check_refused(n, -1.0, 1);
        check_refused(n, 0.0, 0);
        check_refused(n, 1e-310, 0); /* its reciprocal is beyond double */
        for (int i = 0; i < 3; i++) {
            check_refused(n, not_finite[i], 1);
            check_refused(n, not_finite[i], 0);
        }
    }
}

/* NaN anywhere in what is read comes to a pivot. */
static void test_not_finite_is_refused(void **state)
{
    (void)state;
    for (uint32_t n = 2; n < 28; n += 5) {
        for (size_t place = 0; place < (size_t)n * n; place++) {
            const size_t i = place / n, j = place % n;
            draw_positive(n, place, 1.0, given);
            given[i * dense_stride(n) + j] = NOT_A_NUMBER;
            assert_false(factor_at(TRIBO_ISA_BEST, n, 0));
            assert_int_equal(factor_at(TRIBO_ISA_BEST, n, 1), j < i);
        }
    }
}

/* Indefinite, and of rank one: a pivot is negative, or zero to the bit. */
static void test_singular_is_refused(void **state)
{
    (void)state;
    for (uint32_t n = 2; n < 40; n++) {
        for (size_t i = 0; i < n * dense_stride(n); i++) {
            given[i] = 1.0;
        }
        assert_false(factor_at(TRIBO_ISA_BEST, n, 1));
        assert_false(factor_at(TRIBO_ISA_BEST, n, 0));
        draw_positive(n, n, 1e-3, given);
        given[(n - 1) * dense_stride(n) + n - 1] = 1e-3; /* less than its column needs */
        assert_false(factor_at(TRIBO_ISA_BEST, n, 1));
    }
}

/* ---- narrow matrices ------------------------------------------------------------------------- */

static size_t apart(size_t i, size_t j)
{
    return i > j ? i - j : j - i;
}

/* Of the matrix in `given` the band alone, diagonally dominant if it shall be definite; and the same
 * in the narrow memory of `shape`, between guards. */
static void narrow(dense_shape shape, int symmetric)
{
    const size_t ld = dense_stride(shape.n);
    memset(factors, 0, sizeof factors);
    for (size_t i = shape.numbers; i < NUMBERS; i++) {
        factors[i] = NOT_A_NUMBER;
    }
    for (size_t i = 0; i < shape.n; i++) {
        for (size_t j = 0; j < shape.n; j++) {
            double *entry = given + i * ld + j;
            *entry = apart(i, j) > shape.band ? 0.0
                     : symmetric && j < i     ? given[j * ld + i]
                                              : *entry;
            *entry += symmetric && i == j ? 2.0 * shape.band + 1.0 : 0.0;
            if (apart(i, j) <= shape.band) {
                factors[shape.origin + i * shape.stride + j] = *entry;
            }
        }
    }
}

/* Factors that are those of the whole matrix, zeros left out. */
static void check_narrow_factors(dense_shape shape, int symmetric)
{
    const size_t ld = dense_stride(shape.n);
    const size_t reach = symmetric ? shape.band : 2 * (size_t)shape.band;
    memcpy(plain, given, shape.n * ld * sizeof *given);
    assert_true(symmetric ? plain_cholesky(shape.n, plain)
                          : plain_lu(shape.n, plain, plain_pivots));
    for (size_t i = 0; i < shape.n; i++) {
        for (size_t j = i; j < shape.n && j <= i + reach; j++) {
            assert_true(factors[shape.origin + i * shape.stride + j] == plain[i * ld + j]);
        }
    }
    for (size_t i = shape.numbers; i < NUMBERS; i++) {
        assert_true(isnan(factors[i]));
    }
}

static void check_narrow(uint32_t n, uint32_t band, int symmetric, uint64_t index)
{
    const dense_shape shape = dense_shape_of(n, band);
    double b[GREATEST], x[GREATEST], first[GREATEST];
    for (size_t i = 0; i < n; i++) {
        b[i] = (double)(i % 7) - 3.0;
    }
    for (uint32_t isa = 0; isa < ISAS; isa++) {
        if (!tribo_isa_available(isa)) {
            continue;
        }
        draw(n, index, given);
        narrow(shape, symmetric);
        assert_true(factor_in(isa, shape, symmetric));
        check_narrow_factors(shape, symmetric);
        memcpy(x, b, n * sizeof *x);
        solve_in(isa, shape, symmetric, x);
        if (isa == 0) {
            memcpy(first, x, n * sizeof *x);
        }
        assert_memory_equal(x, first, n * sizeof *x);
    }
    within(residual(n, given, first, b), 1.0);
}

/* From a diagonal alone to a matrix that is not narrow. */
static void test_narrow_matrices(void **state)
{
    static const uint32_t bands[] = {0, 1, 2, 5, 7, 8, 11, 16, 17, 23, 40, MOST};
    (void)state;
    for (uint64_t k = 1; k < SIZES; k++) {
        for (size_t i = 0; i < sizeof bands / sizeof *bands; i++) {
            check_narrow(sizes[k], bands[i], 1, 600 + k);
            check_narrow(sizes[k], bands[i], 0, 600 + k);
        }
    }
    settle("residual of narrow matrices, n eps");
}

/* A matrix of 600 rows takes no more memory than one of 192 that is full. */
static void test_narrow_memory(void **state)
{
    (void)state;
    assert_true(dense_shape_of(600, 11).numbers <= dense_shape_of(192, 192).numbers);
    for (uint32_t n = 0; n < 300; n++) {
        for (uint32_t band = 0; band < 300; band++) {
            assert_true(dense_shape_of(n, band).numbers <= n * dense_stride(n));
        }
    }
}

/* Each sum in the order that the contract of equal bits needs. */
static void test_products(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < 20; k++) {
        const double *left = given, *right = given + 36, *d = given + 72;
        double want[144], got[144];
        draw(16, 800 + k, given);
        for (size_t i = 0; i < 144; i++) {
            double sum = 0.0;
            for (size_t row = 0; row < 3; row++) {
                const double s = d[3 * row] * right[i % 12] + d[3 * row + 1] * right[12 + i % 12] +
                                 d[3 * row + 2] * right[24 + i % 12];
                sum += left[12 * row + i / 12] * s;
            }
            want[i] = given[100 + i] + sum;
        }
        for (uint32_t isa = 0; isa < ISAS; isa++) {
            if (tribo_isa_available(isa)) {
                memcpy(got, given + 100, sizeof got);
                dense_table_of(isa)->add_product(left, d, right, got);
                assert_memory_equal(got, want, sizeof got);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_strides),
        TEST(test_bits_are_the_textbooks),
        TEST(test_cholesky_residuals),
        TEST(test_lu_residuals),
        TEST(test_permutations_are_exact),
        TEST(test_bad_pivots_are_refused),
        TEST(test_not_finite_is_refused),
        TEST(test_singular_is_refused),
        TEST(test_narrow_matrices),
        TEST(test_narrow_memory),
        TEST(test_products),
    };
    return cmocka_run_group_tests_name("dense", tests, NULL, NULL);
}
