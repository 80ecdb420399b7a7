#include "dat.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

/* How a matrix is stored, and where a listing by CSparse comes from. */
enum { DENSE = 0, BLOCKS = 1, LISTING = 2 };
enum { TRIPLETS = 1, BY_COLUMNS = 2, HALF = 4 };

/* ---- numbers between white space ------------------------------------------------------------- */

typedef struct scanner {
    const char *file;
    const char *bytes, *end;
    const char *at;    /* next byte */
    const char *token; /* the last one */
    int exit_status;
} scanner;

static void complain(scanner *s, const char *format, ...)
{
    unsigned long line = 1, column = 1;
    char message[160];
    va_list arguments;

    if (s->exit_status != 0)
        return;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    for (const char *c = s->bytes; c < s->token; c++) {
        column = *c == '\n' ? 1 : column + 1;
        line += *c == '\n';
    }
    s->exit_status = cli_error_at(s->file, line, column, "%s", message);
}

/* Find the next word; its length is 0 at the end of the file and after the first complaint. */
static size_t next_token(scanner *s)
{
    if (s->exit_status != 0)
        return 0;
    while (s->at < s->end && isspace((unsigned char)*s->at))
        s->at++;
    s->token = s->at;
    while (s->at < s->end && !isspace((unsigned char)*s->at))
        s->at++;
    if (s->token == s->end)
        complain(s, "the file ends too early");
    return (size_t)(s->at - s->token);
}

static double next_number(scanner *s)
{
    char *end = NULL;

    if (next_token(s) == 0)
        return 0.0;
    const double value = strtod(s->token, &end);
    if (end != s->at || !isfinite(value))
        complain(s, "not a finite number");
    return value;
}

static uint32_t next_count(scanner *s, size_t least, size_t most)
{
    const double value = next_number(s);

    if (value >= (double)least && value <= (double)most && value == floor(value))
        return (uint32_t)value;
    complain(s, "not a whole number from %zu to %zu", least, most);
    return (uint32_t)least;
}

/* Whether so many numbers may follow: nothing is allocated for more than that. */
static int has_room(scanner *s, size_t count)
{
    if (s->exit_status == 0 && count > ((size_t)(s->end - s->at) + 1) / 2) {
        s->token = s->end;
        complain(s, "the file ends too early: %zu numbers were to follow", count);
    }
    return s->exit_status == 0;
}

static void *allocate(scanner *s, size_t count, size_t size)
{
    void *memory = has_room(s, count) ? calloc(count + 1, size) : NULL;

    if (memory == NULL)
        complain(s, "not enough memory");
    return memory;
}

static double *next_numbers(scanner *s, size_t count)
{
    double *numbers = allocate(s, count, sizeof *numbers);

    for (size_t i = 0; i < count && s->exit_status == 0; i++)
        numbers[i] = next_number(s);
    return numbers;
}

static void add(scanner *s, entries *out, size_t row, size_t column, double value)
{
    if (s->exit_status == 0 && entries_add(out, (uint32_t)row, (uint32_t)column, value) != 0)
        complain(s, "not enough memory");
}

/* ---- matrices -------------------------------------------------------------------------------- */

static void read_dense(scanner *s, entries *out)
{
    if (next_count(s, 0, UINT32_MAX) != out->rows || next_count(s, 0, UINT32_MAX) != out->columns)
        complain(s, "the matrix gives its size twice, and differently");
    for (size_t j = 0; j < out->columns && s->exit_status == 0; j++) {
        for (size_t i = 0; i < out->rows && s->exit_status == 0; i++)
            add(s, out, i, j, next_number(s));
    }
}

/* Block sparse rows. */
typedef struct block_rows {
    uint32_t count;        /* blocks */
    uint32_t rows;         /* block rows */
    uint32_t columns;      /* block columns */
    uint32_t *row_ends;    /* one more than block rows: 0, then where each ends */
    uint32_t *column_ends; /* the same of block columns */
    uint32_t *pointers;    /* first block of each row, then their number */
    uint32_t *places;      /* block column of each block */
} block_rows;

/* `count` numbers that rise from above 0 to `last`. In front of them a 0, which is not in the
 * file. */
static uint32_t *next_ends(scanner *s, uint32_t count, uint32_t last)
{
    uint32_t *ends = allocate(s, count, sizeof *ends);

    for (uint32_t i = 0; i < count && s->exit_status == 0; i++)
        ends[i + 1] = next_count(s, ends[i] + 1u, last - (count - 1u - i));
    if (s->exit_status == 0 && ends[count] != last)
        complain(s, "the last block ends at %lu, the matrix at %lu", (unsigned long)ends[count],
                 (unsigned long)last);
    return ends;
}

static void read_structure(scanner *s, const entries *out, block_rows *b)
{
    b->count = next_count(s, 0, UINT32_MAX - 1u);
    b->rows = next_count(s, 1, out->rows);
    b->columns = next_count(s, 1, out->columns);
    b->row_ends = next_ends(s, b->rows, out->rows);
    b->column_ends = next_ends(s, b->columns, out->columns);
    next_count(s, b->rows + 1u, b->rows + 1u);
    next_count(s, b->count, b->count);
    b->pointers = allocate(s, b->rows + 1u, sizeof *b->pointers);
    for (uint32_t i = 0; i <= b->rows && s->exit_status == 0; i++)
        b->pointers[i] = next_count(s,
                                    i == b->rows ? b->count
                                    : i > 0      ? b->pointers[i - 1]
                                                 : 0,
                                    i > 0 ? b->count : 0);
    b->places = allocate(s, b->count, sizeof *b->places);
    for (uint32_t i = 0; i < b->count && s->exit_status == 0; i++)
        b->places[i] = next_count(s, 0, b->columns - 1u);
}

static void read_block(scanner *s, const block_rows *b, uint32_t row, uint32_t block, entries *out)
{
    const uint32_t column = b->places[block];

    next_count(s, block, block);
    for (uint32_t j = b->column_ends[column]; j < b->column_ends[column + 1]; j++) {
        for (uint32_t i = b->row_ends[row]; i < b->row_ends[row + 1] && s->exit_status == 0; i++)
            add(s, out, i, j, next_number(s));
    }
}

static void read_blocks(scanner *s, entries *out)
{
    block_rows b = {0};

    read_structure(s, out, &b);
    for (uint32_t row = 0; row < b.rows && s->exit_status == 0; row++) {
        for (uint32_t k = b.pointers[row]; k < b.pointers[row + 1] && s->exit_status == 0; k++)
            read_block(s, &b, row, k, out);
    }
    free(b.row_ends);
    free(b.column_ends);
    free(b.pointers);
    free(b.places);
}

/* ---- listings by CSparse --------------------------------------------------------------------- */

static void expect(scanner *s, const char *word)
{
    const size_t length = next_token(s);

    if (length != strlen(word) || memcmp(s->token, word, length) != 0)
        complain(s, "\"%s\" is expected", word);
}

/* "M-by-N," */
static void expect_size(scanner *s, const entries *out)
{
    char size[48];

    snprintf(size, sizeof size, "%lu-by-%lu,", (unsigned long)out->rows,
             (unsigned long)out->columns);
    expect(s, size);
}

static void read_triplets(scanner *s, int half, entries *out)
{
    expect(s, "triplet:");
    expect_size(s, out);
    expect(s, "nzmax:");
    next_count(s, 0, UINT32_MAX);
    expect(s, "nnz:");
    const uint32_t count = next_count(s, 0, UINT32_MAX);
    for (uint32_t k = 0; k < count && s->exit_status == 0; k++) {
        const uint32_t row = next_count(s, 0, out->rows - 1u);
        const uint32_t column = next_count(s, 0, out->columns - 1u);
        expect(s, ":");
        const double value = next_number(s);
        add(s, out, row, column, value);
        if (half && row != column && column < out->rows && row < out->columns)
            add(s, out, column, row, value);
    }
}

/* A number with a comma behind it. */
static uint32_t next_count_and_comma(scanner *s)
{
    char *end = NULL;
    const size_t length = next_token(s);
    const unsigned long value = length > 0 ? strtoul(s->token, &end, 10) : 0;

    if (length > 0 && (!isdigit((unsigned char)*s->token) || end != s->at - 1 || *end != ',' ||
                       value > UINT32_MAX))
        complain(s, "not a whole number and a comma");
    return (uint32_t)value;
}

static void read_columns(scanner *s, entries *out)
{
    uint32_t done = 0;

    expect_size(s, out);
    expect(s, "nzmax:");
    next_count(s, 0, UINT32_MAX);
    expect(s, "nnz:");
    const uint32_t count = next_count_and_comma(s);
    expect(s, "1-norm:");
    next_number(s);
    for (uint32_t j = 0; j < out->columns && s->exit_status == 0; j++) {
        expect(s, "col");
        next_count(s, j, j);
        expect(s, ":");
        expect(s, "locations");
        next_count(s, done, done);
        expect(s, "to");
        const double last = next_number(s); /* -1 if the first column has nothing */
        if (!(last >= (double)done - 1.0 && last < (double)count && last == floor(last)))
            complain(s, "not a whole number from %ld to %ld", (long)done - 1, (long)count - 1);
        for (; (double)done <= last && s->exit_status == 0; done++) {
            const uint32_t row = next_count(s, 0, out->rows - 1u);
            expect(s, ":");
            add(s, out, row, j, next_number(s));
        }
    }
}

static void read_listing(scanner *s, entries *out)
{
    const uint32_t origin = next_count(s, TRIPLETS, HALF);
    const size_t length = next_token(s);

    if ((length < 7 || memcmp(s->token, "CSparse", 7) != 0) &&
        (length < 8 || memcmp(s->token, "CXSparse", 8) != 0))
        complain(s, "a listing by CSparse is expected");
    while (s->at < s->end && *s->at != '\n')
        s->at++;
    if (origin == TRIPLETS || origin == HALF)
        read_triplets(s, origin == HALF, out);
    else if (origin == BY_COLUMNS)
        read_columns(s, out);
    else
        complain(s, "a listing by rows is not known");
}

static void read_matrix(scanner *s, entries *out)
{
    const uint32_t storage = next_count(s, DENSE, LISTING);

    /* No unknown and no contact is without its numbers. */
    const size_t most = (size_t)(s->end - s->at);
    out->rows = next_count(s, 1, most);
    out->columns = next_count(s, 1, most);
    if (s->exit_status != 0)
        return;
    if (storage == DENSE)
        read_dense(s, out);
    else if (storage == BLOCKS)
        read_blocks(s, out);
    else
        read_listing(s, out);
}

/* ---- the two forms --------------------------------------------------------------------------- */

/* After a first matrix of any size: does another one of `rows` x `columns` begin here? In local
 * form q does, where such numbers would be a very odd chance. */
static int finds_matrix(const scanner *s, uint32_t rows, uint32_t columns)
{
    scanner ahead = *s;
    double head[5];

    for (size_t i = 0; i < 5; i++) {
        while (ahead.at < ahead.end && isspace((unsigned char)*ahead.at))
            ahead.at++;
        if (ahead.at == ahead.end)
            return 0;
        char *end = NULL;
        head[i] = strtod(ahead.at, &end);
        if (end == ahead.at) /* the banner of a listing */
            head[i] = -1.0;
        while (ahead.at < ahead.end && !isspace((unsigned char)*ahead.at))
            ahead.at++;
    }
    if (head[1] != rows || head[2] != columns)
        return 0;
    if (head[0] == DENSE)
        return head[3] == rows && head[4] == columns;
    return head[0] == LISTING ? head[4] < 0.0
                              : head[0] == BLOCKS && head[3] >= 0.0 && head[3] == floor(head[3]) &&
                                    head[4] >= 1.0 && head[4] <= rows;
}

static void read_local(scanner *s, recorded *out)
{
    if (out->matrix.rows != 3 * out->contacts || out->matrix.columns != out->matrix.rows)
        complain(s, "W is %lu x %lu, and no H follows", (unsigned long)out->matrix.rows,
                 (unsigned long)out->matrix.columns);
    out->q = next_numbers(s, 3 * (size_t)out->contacts);
}

static void read_global(scanner *s, recorded *out)
{
    if (out->matrix.rows != out->matrix.columns)
        complain(s, "M is %lu x %lu", (unsigned long)out->matrix.rows,
                 (unsigned long)out->matrix.columns);
    read_matrix(s, &out->h);
    out->f = next_numbers(s, out->matrix.rows);
    out->q = next_numbers(s, 3 * (size_t)out->contacts);
}

/* Some files go on with 0, or with 1 and a guess. */
static void read_rest(scanner *s)
{
    scanner ahead = *s;

    while (ahead.at < ahead.end && isspace((unsigned char)*ahead.at))
        ahead.at++;
    if (s->exit_status == 0 && ahead.at < ahead.end && next_count(s, 0, 1) == 0) {
        while (s->at < s->end && isspace((unsigned char)*s->at))
            s->at++;
        s->token = s->at;
        if (s->at < s->end)
            complain(s, "the problem has ended before");
    }
}

int dat_read(const char *file, const char *bytes, size_t length, recorded *out)
{
    scanner s = {file, bytes, bytes + length, bytes, bytes, 0};

    if (next_count(&s, 0, UINT32_MAX) != 3)
        complain(&s, "the problem is not in space: dimension 3 is expected");
    out->contacts = next_count(&s, 1, UINT32_MAX / 3u);
    read_matrix(&s, &out->matrix);
    out->global = s.exit_status == 0 && finds_matrix(&s, out->matrix.rows, 3 * out->contacts);
    if (out->global)
        read_global(&s, out);
    else
        read_local(&s, out);
    out->mu = next_numbers(&s, out->contacts);
    read_rest(&s);
    return s.exit_status;
}
