#include "problem.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

enum { DENSE = 0, BLOCKS = 1, SIZE_AT_MOST = 256, TOKEN_AT_MOST = 63 };

/* ---- numbers between white space ------------------------------------------------------------- */

typedef struct scanner {
    FILE *stream;
    const char *file;
    unsigned long line, column;             /* of the next byte */
    unsigned long token_line, token_column; /* of the last token */
    int exit_status;
} scanner;

static int next_byte(scanner *s)
{
    const int byte = getc(s->stream);

    s->column += byte != EOF;
    if (byte == '\n') {
        s->line++;
        s->column = 1;
    }
    return byte;
}

static void complain(scanner *s, const char *message)
{
    if (s->exit_status == 0)
        s->exit_status = cli_error_at(s->file, s->token_line, s->token_column, "%s", message);
}

/* The next number; 0 after the first complaint. */
static double next_number(scanner *s)
{
    char token[TOKEN_AT_MOST + 1], *end = NULL;
    size_t length = 0;
    int byte;

    if (s->exit_status != 0)
        return 0.0;
    do {
        s->token_line = s->line;
        s->token_column = s->column;
        byte = next_byte(s);
    } while (byte != EOF && isspace(byte));
    while (byte != EOF && !isspace(byte) && length < TOKEN_AT_MOST) {
        token[length++] = (char)byte;
        byte = next_byte(s);
    }
    token[length] = '\0';
    const double value = strtod(token, &end);
    if (length == 0)
        complain(s, "the file ends too early");
    else if (end != token + length || !isfinite(value))
        complain(s, "not a finite number");
    return value;
}

/* The next number, which must be a whole one up to `most`. */
static size_t next_count(scanner *s, size_t most)
{
    const double value = next_number(s);

    if (value < 0.0 || value > (double)most || value != floor(value)) {
        complain(s, "not a whole number within its range");
        return 0;
    }
    return (size_t)value;
}

static void next_numbers(scanner *s, size_t count, double *numbers)
{
    for (size_t i = 0; i < count; i++)
        numbers[i] = next_number(s);
}

/* ---- matrices, kept column by column as they are stored -------------------------------------- */

typedef struct matrix {
    size_t rows, columns;
    double *entries;
} matrix;

static void read_dense(scanner *s, matrix *out)
{
    if (next_count(s, SIZE_AT_MOST) != out->rows || next_count(s, SIZE_AT_MOST) != out->columns)
        complain(s, "the matrix gives its size twice, and differently");
    else
        next_numbers(s, out->rows * out->columns, out->entries);
}

/* Block sparse rows: ends of block rows and columns, row pointers, block columns, then the blocks.
 */
static void read_blocks(scanner *s, matrix *out)
{
    size_t ends[2][SIZE_AT_MOST + 1] = {{0}, {0}}, pointer[SIZE_AT_MOST + 1] = {0},
                                  place[SIZE_AT_MOST] = {0};
    const size_t count = next_count(s, SIZE_AT_MOST);
    const size_t block_rows = next_count(s, out->rows), block_columns = next_count(s, out->columns);

    for (size_t i = 0; i < block_rows; i++)
        ends[0][i + 1] = next_count(s, out->rows);
    for (size_t i = 0; i < block_columns; i++)
        ends[1][i + 1] = next_count(s, out->columns);
    const size_t pointers = next_count(s, SIZE_AT_MOST + 1), places = next_count(s, SIZE_AT_MOST);
    if (pointers != block_rows + 1 || places != count)
        complain(s, "the block structure contradicts itself");
    for (size_t i = 0; i < pointers && s->exit_status == 0; i++)
        pointer[i] = next_count(s, count);
    for (size_t i = 0; i < places && s->exit_status == 0; i++)
        place[i] = next_count(s, block_columns > 0 ? block_columns - 1 : 0);
    for (size_t row = 0; row < block_rows && s->exit_status == 0; row++) {
        for (size_t block = pointer[row]; block < pointer[row + 1] && s->exit_status == 0;
             block++) {
            if (next_count(s, count) != block)
                complain(s, "the blocks are not in order");
            for (size_t j = ends[1][place[block]]; j < ends[1][place[block] + 1]; j++) {
                for (size_t i = ends[0][row]; i < ends[0][row + 1]; i++)
                    out->entries[j * out->rows + i] = next_number(s);
            }
        }
    }
}

static matrix read_matrix(scanner *s)
{
    const size_t storage = next_count(s, BLOCKS);
    matrix out = {0, 0, NULL};

    out.rows = next_count(s, SIZE_AT_MOST);
    out.columns = next_count(s, SIZE_AT_MOST);
    out.entries = calloc(out.rows * out.columns + 1, sizeof *out.entries);
    if (out.entries == NULL)
        complain(s, "not enough memory");
    else if (storage == DENSE)
        read_dense(s, &out);
    else
        read_blocks(s, &out);
    return out;
}

/* Replace each of the `count` columns of `x` by M^-1 times it: elimination with partial pivoting, M
 * is used up. Returns 0 if M is singular. */
static int divide(matrix *m, size_t count, double *x)
{
    const size_t n = m->rows;
    double *a = m->entries;

    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            pivot = fabs(a[k * n + i]) > fabs(a[k * n + pivot]) ? i : pivot;
        if (a[k * n + pivot] == 0.0)
            return 0;
        for (size_t j = 0; j < n + count; j++) {
            double *column = j < n ? a + j * n : x + (j - n) * n;
            const double upper = column[pivot];
            column[pivot] = column[k];
            column[k] = upper;
        }
        for (size_t i = k + 1; i < n; i++) {
            const double factor = a[k * n + i] / a[k * n + k];
            for (size_t j = k; j < n + count; j++) {
                double *column = j < n ? a + j * n : x + (j - n) * n;
                column[i] -= factor * column[k];
            }
        }
    }
    for (size_t j = 0; j < count; j++) {
        for (size_t k = n; k-- > 0;) {
            x[j * n + k] /= a[k * n + k];
            for (size_t i = 0; i < k; i++)
                x[j * n + i] -= a[k * n + i] * x[j * n + k];
        }
    }
    return 1;
}

/* ---- the two forms --------------------------------------------------------------------------- */

static void read_local(scanner *s, problem *out)
{
    matrix w = read_matrix(s);

    if (w.rows != 3 || w.columns != 3)
        complain(s, "W is not 3x3");
    for (size_t i = 0; i < 9 && s->exit_status == 0; i++)
        out->w[i] = w.entries[i % 3 * 3 + i / 3];
    free(w.entries);
    next_numbers(s, 3, out->q);
}

static void reduce(scanner *s, matrix *m, const matrix *h, double *solved, problem *out)
{
    const size_t n = m->rows;

    memcpy(solved, h->entries, 3 * n * sizeof *solved);
    next_numbers(s, n, solved + 3 * n);
    next_numbers(s, 3, out->q);
    if (s->exit_status == 0 && !divide(m, 4, solved))
        complain(s, "M is singular");
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 4; j++) {
            double sum = 0.0;
            for (size_t k = 0; k < n; k++)
                sum += h->entries[i * n + k] * solved[j * n + k];
            if (j < 3)
                out->w[i * 3 + j] = sum;
            else
                out->q[i] += sum;
        }
    }
}

static void read_global(scanner *s, problem *out)
{
    matrix m = read_matrix(s), h = read_matrix(s);
    double *solved = calloc(4 * m.rows + 1, sizeof *solved);

    if (m.rows != m.columns || h.rows != m.rows || h.columns != 3)
        complain(s, "the sizes of M and H do not fit one contact");
    if (solved == NULL)
        complain(s, "not enough memory");
    if (s->exit_status == 0)
        reduce(s, &m, &h, solved, out);
    free(solved);
    free(h.entries);
    free(m.entries);
}

int problem_read(const char *file, int global, problem *out)
{
    scanner s = {.stream = fopen(file, "r"), .file = file, .line = 1, .column = 1};

    if (s.stream == NULL)
        return cli_error(CLI_BAD_INPUT, "%s: %s", file, strerror(errno));
    if (next_count(&s, 3) != 3)
        complain(&s, "the problem is not in space: 3 is expected");
    if (next_count(&s, 1) != 1)
        complain(&s, "1 contact is expected");
    if (global)
        read_global(&s, out);
    else
        read_local(&s, out);
    out->mu = next_number(&s);
    fclose(s.stream);
    return s.exit_status;
}

/* ---- solving --------------------------------------------------------------------------------- */

static double natural_map(const problem *given, const double p[3])
{
    const double sigma = (given->w[0] + given->w[4] + given->w[8]) / 3.0;
    const double size = tribo_vec3_norm(given->q);
    double u[3], moved[3], projected[3];

    tribo_mat3_apply(given->w, p, u);
    tribo_vec3_add(u, given->q, u);
    const double slip[3] = {u[1], u[2], 0.0};
    u[0] += given->mu * tribo_vec3_norm(slip);
    tribo_vec3_scale(sigma, p, moved);
    tribo_vec3_subtract(moved, u, moved);
    if (tribo_cone_project(moved, given->mu, projected) != TRIBO_OK || size == 0.0)
        return size == 0.0 ? 0.0 : (double)NAN;
    tribo_vec3_scale(sigma, p, moved);
    tribo_vec3_subtract(moved, projected, moved);
    return tribo_vec3_norm(moved) / size;
}

void problem_solve(const problem *given, problem_solution *solution)
{
    const double *w = given->w;
    const double half[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
    tribo_solve_info info = {.struct_size = sizeof info};
    problem_solution out = {.general = w[1] != w[3] || w[2] != w[6] || w[5] != w[7]};

    out.status = out.general
                     ? tribo_contact_solve_general(w, given->q, given->mu, given->mu, out.p, &info)
                     : tribo_contact_solve(half, given->q, given->mu, given->mu, out.p, &info);
    out.mode = info.mode;
    out.error = out.status == TRIBO_OK ? natural_map(given, out.p) : (double)NAN;
    *solution = out;
}
