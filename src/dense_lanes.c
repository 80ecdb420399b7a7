/* Factorisations by blocks of eight rows: the diagonal block (or panel), then its rows to the
 * right, then all rows below by an update of rank eight. Every loop over lanes is eight columns
 * side by side, and each number takes its products one after the other, by rising row: neither the
 * blocks nor the width of vectors show in the bits. */
#include "dense.h"

#include "bits.h"

#include <float.h>
#include <math.h>

#ifndef TRIBO_LANES
#define TRIBO_LANES baseline
#endif
#define PASTE_TWO(a, b) a##b
#define PASTE(a, b) PASTE_TWO(a, b)

enum { BLOCK = 8 };

/* Eight rows of a matrix in one column. */
typedef struct column {
    double x0, x1, x2, x3, x4, x5, x6, x7;
} column;

TRIBO_ALWAYS_INLINE column load_column(const double *a, size_t ld)
{
    const column c = {a[0],      a[ld],     a[2 * ld], a[3 * ld],
                      a[4 * ld], a[5 * ld], a[6 * ld], a[7 * ld]};
    return c;
}

/* y - l x */
TRIBO_ALWAYS_INLINE double subtract(double y, const double *l, column c)
{
    y = y - l[0] * c.x0;
    y = y - l[1] * c.x1;
    y = y - l[2] * c.x2;
    y = y - l[3] * c.x3;
    y = y - l[4] * c.x4;
    y = y - l[5] * c.x5;
    y = y - l[6] * c.x6;
    return y - l[7] * c.x7;
}

/* The columns that are worked on: up to seven beyond the n-th are scratch. */
static size_t width_of(size_t n)
{
    return (n + 7) / 8 * 8;
}

/* End of what is `reach` rows or columns beyond the block at k. */
static size_t end_of(size_t n, size_t k, size_t reach)
{
    return n < k + BLOCK + reach ? n : k + BLOCK + reach;
}

/* ---- update of rank eight -------------------------------------------------------------------- */

/* Subtract from the rows c (`width` numbers each) the products of l, 8 numbers for each, with the
 * eight rows u. */
static void update_four(size_t width, const double *restrict l, size_t ld, const double *restrict u,
                        double *restrict c0, double *restrict c1, double *restrict c2,
                        double *restrict c3)
{
    for (size_t j = 0; j < width; j += BLOCK) {
        for (size_t i = j; i < j + BLOCK; i++) {
            const column x = load_column(u + i, ld);
            c0[i] = subtract(c0[i], l, x);
            c1[i] = subtract(c1[i], l + 8, x);
            c2[i] = subtract(c2[i], l + 16, x);
            c3[i] = subtract(c3[i], l + 24, x);
        }
    }
}

static void update_one(size_t width, const double *restrict l, size_t ld, const double *restrict u,
                       double *restrict c)
{
    for (size_t j = 0; j < width; j += BLOCK) {
        for (size_t i = j; i < j + BLOCK; i++) {
            c[i] = subtract(c[i], l, load_column(u + i, ld));
        }
    }
}

/* ---- Cholesky -------------------------------------------------------------------------------- */

/* Factor a block of eight rows, the reciprocals of the diagonal on the diagonal. Whole rows are
 * worked on: what is below the diagonal is scratch. */
static int factor_block(double block[BLOCK][BLOCK])
{
    int positive = 1;
    for (int k = 0; k < BLOCK; k++) {
        const double pivot = block[k][k];
        positive = positive && pivot > 0.0 && pivot <= DBL_MAX;
        const double reciprocal = 1.0 / sqrt(positive ? pivot : 1.0);
        for (int j = 0; j < BLOCK; j++) {
            block[k][j] *= reciprocal;
        }
        for (int i = k + 1; i < BLOCK; i++) {
            const double l = block[k][i];
            for (int j = 0; j < BLOCK; j++) {
                block[i][j] -= l * block[k][j];
            }
        }
        block[k][k] = reciprocal;
    }
    return positive;
}

/* The block at `a`, of which the first `rows` rows are there, the others being those of the unit
 * matrix. */
static int factor_corner(uint32_t rows, size_t ld, double *a, double block[BLOCK][BLOCK])
{
    if (rows == BLOCK) {
        for (size_t i = 0; i < BLOCK; i++) {
            for (size_t j = 0; j < BLOCK; j++) {
                block[i][j] = a[i * ld + j];
            }
        }
        const int positive = factor_block(block);
        for (size_t i = 0; i < BLOCK; i++) {
            for (size_t j = 0; j < BLOCK; j++) {
                a[i * ld + j] = block[i][j];
            }
        }
        return positive;
    }
    for (uint32_t i = 0; i < BLOCK; i++) {
        for (uint32_t j = 0; j < BLOCK; j++) {
            block[i][j] = j < i ? 0.0 : i < rows && j < rows ? a[i * ld + j] : i == j ? 1.0 : 0.0;
        }
    }
    const int positive = factor_block(block);
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t j = i; j < rows; j++) {
            a[i * ld + j] = block[i][j];
        }
    }
    return positive;
}

/* The eight rows r to the right of a factored block: U_12 = U_11^-T A_12. */
static void divide_rows(size_t width, double block[BLOCK][BLOCK], double *restrict r0,
                        double *restrict r1, double *restrict r2, double *restrict r3,
                        double *restrict r4, double *restrict r5, double *restrict r6,
                        double *restrict r7)
{
    double(*const u)[BLOCK] = block;
    for (size_t j = 0; j < width; j += BLOCK) {
        for (size_t i = j; i < j + BLOCK; i++) {
            const double y0 = r0[i] * u[0][0];
            const double y1 = (r1[i] - u[0][1] * y0) * u[1][1];
            const double y2 = (r2[i] - u[0][2] * y0 - u[1][2] * y1) * u[2][2];
            const double y3 = (r3[i] - u[0][3] * y0 - u[1][3] * y1 - u[2][3] * y2) * u[3][3];
            double y4 = r4[i] - u[0][4] * y0 - u[1][4] * y1 - u[2][4] * y2 - u[3][4] * y3;
            double y5 = r5[i] - u[0][5] * y0 - u[1][5] * y1 - u[2][5] * y2 - u[3][5] * y3;
            double y6 = r6[i] - u[0][6] * y0 - u[1][6] * y1 - u[2][6] * y2 - u[3][6] * y3;
            double y7 = r7[i] - u[0][7] * y0 - u[1][7] * y1 - u[2][7] * y2 - u[3][7] * y3;
            y4 = y4 * u[4][4];
            y5 = (y5 - u[4][5] * y4) * u[5][5];
            y6 = (y6 - u[4][6] * y4 - u[5][6] * y5) * u[6][6];
            y7 = (y7 - u[4][7] * y4 - u[5][7] * y5 - u[6][7] * y6) * u[7][7];
            r0[i] = y0;
            r1[i] = y1;
            r2[i] = y2;
            r3[i] = y3;
            r4[i] = y4;
            r5[i] = y5;
            r6[i] = y6;
            r7[i] = y7;
        }
    }
}

static void divide_block_rows(size_t width, double block[BLOCK][BLOCK], size_t ld, double *r)
{
    divide_rows(width, block, r, r + ld, r + 2 * ld, r + 3 * ld, r + 4 * ld, r + 5 * ld, r + 6 * ld,
                r + 7 * ld);
}

/* l[i][s] = a[s][i]: what the rows u take off four rows below. */
static void gather(size_t ld, const double *u, double l[4 * BLOCK])
{
    for (size_t s = 0; s < BLOCK; s++) {
        for (size_t i = 0; i < 4; i++) {
            l[i * BLOCK + s] = u[s * ld + i];
        }
    }
}

/* All rows below the block at k up to `end`, less their products with its eight rows. Beyond the
 * band there are zeros: rows go by fours as long as there are any. */
static void update_symmetric(uint32_t n, size_t k, size_t end, size_t ld, double *a)
{
    const size_t width = width_of(end);
    for (size_t i = k + BLOCK; i < end; i += 4) {
        const size_t from = i / BLOCK * BLOCK;
        const double *u = a + k * ld + from;
        double l[4 * BLOCK];
        gather(ld, a + k * ld + i, l);
        if (n - i >= 4) {
            double *c = a + i * ld + from;
            update_four(width - from, l, ld, u, c, c + ld, c + 2 * ld, c + 3 * ld);
        } else {
            for (size_t row = i; row < n; row++) {
                update_one(width - from, l + (row - i) * BLOCK, ld, u, a + row * ld + from);
            }
        }
    }
}

static int cholesky(const dense_shape *shape, double *a)
{
    const uint32_t n = shape->n;
    const size_t ld = shape->stride;
    for (size_t k = 0; k < n; k += BLOCK) {
        double block[BLOCK][BLOCK];
        const uint32_t rows = n - k < BLOCK ? (uint32_t)(n - k) : BLOCK;
        const size_t end = end_of(n, k, shape->band);
        if (!factor_corner(rows, ld, a + k * ld + k, block)) {
            return 0;
        }
        if (rows == BLOCK) {
            divide_block_rows(width_of(end) - k - BLOCK, block, ld, a + k * ld + k + BLOCK);
            update_symmetric(n, k, end, ld, a);
        }
    }
    return 1;
}

/* ---- triangular solves ----------------------------------------------------------------------- */

/* Sum of a[j] x[j] for j from `from` to n - 1: eight sums by j modulo 8, then those in a tree. */
static double dot(size_t from, size_t n, const double *restrict a, const double *restrict x)
{
    double sums[BLOCK] = {0.0};
    size_t j = from;
    for (; j + BLOCK <= n; j += BLOCK) {
        for (size_t i = 0; i < BLOCK; i++) {
            sums[i] += a[j + i] * x[j + i];
        }
    }
    for (size_t i = 0; j + i < n; i++) {
        sums[i] += a[j + i] * x[j + i];
    }
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
           ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

/* U x = b, reciprocals on the diagonal, `reach` numbers to the right of it. */
static void solve_upper(const dense_shape *shape, size_t reach, const double *a, double *x)
{
    for (size_t i = shape->n; i-- > 0;) {
        const double *row = a + i * shape->stride;
        const size_t end = shape->n - i > reach ? i + 1 + reach : shape->n;
        x[i] = (x[i] - dot(i + 1, end, row, x)) * row[i];
    }
}

static void cholesky_solve(const dense_shape *shape, const double *a, double *x)
{
    const size_t n = shape->n;
    for (size_t i = 0; i < n; i++) {
        const double *row = a + i * shape->stride;
        const size_t end = n - i > shape->band ? i + 1 + shape->band : n;
        const double y = x[i] * row[i];
        x[i] = y;
        for (size_t j = i + 1; j < end; j++) {
            x[j] -= row[j] * y;
        }
    }
    solve_upper(shape, shape->band, a, x);
}

/* The columns of L from k on, `columns` of them, whose rows were exchanged together. */
static void solve_panel(const dense_shape *shape, size_t k, size_t columns, const double *a,
                        const uint32_t *pivots, double *x)
{
    const size_t end = end_of(shape->n, k, shape->band);
    for (size_t i = k; i < k + columns; i++) {
        const double y = x[pivots[i]];
        x[pivots[i]] = x[i];
        x[i] = y;
    }
    for (size_t i = k + 1; i < k + columns; i++) {
        const double *row = a + i * shape->stride;
        for (size_t j = k; j < i; j++) {
            x[i] -= row[j] * x[j];
        }
    }
    for (size_t i = k + BLOCK; i < end; i++) {
        const double *row = a + i * shape->stride + k;
        double sums[BLOCK];
        for (size_t j = 0; j < BLOCK; j++) {
            sums[j] = row[j] * x[k + j];
        }
        x[i] -= ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
                ((sums[1] + sums[5]) + (sums[3] + sums[7]));
    }
}

static void lu_solve(const dense_shape *shape, const double *a, const uint32_t *pivots, double *x)
{
    const size_t n = shape->n;
    for (size_t k = 0; k < n; k += BLOCK) {
        solve_panel(shape, k, n - k < BLOCK ? n - k : BLOCK, a, pivots, x);
    }
    solve_upper(shape, 2 * (size_t)shape->band, a, x);
}

/* ---- LU -------------------------------------------------------------------------------------- */

static size_t find_pivot(size_t end, size_t ld, const double *a, size_t k)
{
    size_t at = k;
    double greatest = -1.0;
    for (size_t i = k; i < end; i++) {
        const double size = fabs(a[i * ld + k]);
        at = size > greatest ? i : at;
        greatest = size > greatest ? size : greatest;
    }
    return at;
}

static void swap_rows(size_t width, double *restrict a, double *restrict b)
{
    for (size_t j = 0; j < width; j++) {
        const double value = a[j];
        a[j] = b[j];
        b[j] = value;
    }
}

/* Take row r, which holds zeros up to the pivot, off the rows below in the eight columns of the
 * panel; column `at` of it receives the multipliers. */
static void eliminate(size_t rows, size_t ld, double reciprocal, size_t at, const double r[BLOCK],
                      double *a)
{
    for (size_t i = 0; i < rows; i++) {
        double *row = a + i * ld;
        const double l = row[at] * reciprocal;
        for (size_t j = 0; j < BLOCK; j++) {
            row[j] -= l * r[j];
        }
        row[at] = l;
    }
}

/* Columns k to k + 7 (of which `columns` are there) of the rows from k to the end of the band; these
 * are exchanged up to column `right`. */
static int factor_panel(const dense_shape *shape, size_t k, size_t columns, size_t right, double *a,
                        uint32_t *pivots)
{
    const size_t ld = shape->stride;
    for (size_t c = 0; c < columns; c++) {
        const size_t row = k + c;
        const size_t end = shape->n - row > shape->band ? row + shape->band + 1 : shape->n;
        const size_t pivot = find_pivot(end, ld, a, row);
        pivots[row] = (uint32_t)pivot;
        if (pivot != row) {
            swap_rows(right - k, a + row * ld + k, a + pivot * ld + k);
        }
        const double reciprocal = 1.0 / a[row * ld + row];
        if (!(fabs(a[row * ld + row]) <= DBL_MAX && fabs(reciprocal) <= DBL_MAX)) {
            return 0;
        }
        double r[BLOCK];
        for (size_t j = 0; j < BLOCK; j++) {
            r[j] = j > c ? a[row * ld + k + j] : 0.0;
        }
        eliminate(end - row - 1, ld, reciprocal, c, r, a + (row + 1) * ld + k);
        a[row * ld + row] = reciprocal;
    }
    return 1;
}

/* The rows of the block at k to the right of its panel (U_12 = L_11^-1 A_12), then the rows
 * below up to `end`; columns up to `right`. */
static void update_right(size_t k, size_t end, size_t right, size_t ld, double *a)
{
    const size_t from = k + BLOCK;
    const size_t width = right - from;
    double block[BLOCK][BLOCK];
    for (size_t i = 0; i < BLOCK; i++) {
        for (size_t j = 0; j < BLOCK; j++) {
            block[j][i] = i == j ? 1.0 : a[(k + i) * ld + k + j];
        }
    }
    divide_block_rows(width, block, ld, a + k * ld + from);
    const double *u = a + k * ld + from;
    size_t i = from;
    for (; i + 4 <= end; i += 4) {
        double l[4 * BLOCK];
        for (size_t s = 0; s < 4; s++) {
            for (size_t j = 0; j < BLOCK; j++) {
                l[s * BLOCK + j] = a[(i + s) * ld + k + j];
            }
        }
        double *c = a + i * ld + from;
        update_four(width, l, ld, u, c, c + ld, c + 2 * ld, c + 3 * ld);
    }
    for (; i < end; i++) {
        update_one(width, a + i * ld + k, ld, u, a + i * ld + from);
    }
}

static int lu(const dense_shape *shape, double *a, uint32_t *pivots)
{
    const size_t n = shape->n;
    const size_t ld = shape->stride;
    for (size_t k = 0; k < n; k += BLOCK) {
        const size_t columns = n - k < BLOCK ? n - k : BLOCK;
        const size_t end = end_of(n, k, shape->band);
        const size_t right = width_of(end_of(n, k, 2 * (size_t)shape->band));
        if (!factor_panel(shape, k, columns, right, a, pivots)) {
            return 0;
        }
        if (n - k > BLOCK) {
            update_right(k, end, right, ld, a);
        }
    }
    return 1;
}

/* ---- products -------------------------------------------------------------------------------- */

static void add_product(const double *restrict left, const double d[9],
                        const double *restrict right, double *restrict sum)
{
    double s[36];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 12; j++) {
            s[12 * i + j] =
                d[3 * i] * right[j] + d[3 * i + 1] * right[12 + j] + d[3 * i + 2] * right[24 + j];
        }
    }
    for (int i = 0; i < 12; i++) {
        for (int j = 0; j < 12; j++) {
            sum[12 * i + j] += left[i] * s[j] + left[12 + i] * s[12 + j] + left[24 + i] * s[24 + j];
        }
    }
}

const dense_table PASTE(dense_, TRIBO_LANES) = {cholesky, cholesky_solve, lu, lu_solve,
                                                add_product};
