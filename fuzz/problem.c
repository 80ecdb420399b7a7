/* Properties of the reader of recorded problems, src/cli/problem.h: what is written is read,
 * whatever its storage; a fault is named by its place; nothing crashes. HDF5 files are written here
 * by libhdf5 itself. */
#include <hdf5.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../src/cli/cli.h"
#include "../src/cli/problem.h"
#include "support/channel.h"
#include "support/make.h"

enum {
    CONTACTS = 3,
    ROWS = 3 * CONTACTS,
    UNKNOWNS = 6,
    TEXT = 16384,
    WORDS = 640,
    IMAGE = 1 << 16
};

/* AddressSanitizer asks for its options here. The reader has a process of its own for each HDF5
 * file, and fork copies the tables of all pages; so the memory that was freed and must not be used
 * is kept for as long as a trial frees, and not for hundreds of trials. */
const char *__asan_default_options(void);

const char *__asan_default_options(void)
{
    return "quarantine_size_mb=8";
}

/* ---- a problem ---------------------------------------------------------------------------- */

typedef struct plain_matrix {
    uint32_t rows;
    uint32_t columns;
    double entries[ROWS * ROWS]; /* row by row */
} plain_matrix;

typedef struct plain {
    uint32_t contacts;
    uint32_t global;
    plain_matrix matrix; /* W or M */
    plain_matrix h;
    double f[UNKNOWNS];
    double q[ROWS];
    double mu[CONTACTS];
} plain;

/* Half of the entries are zeros. */
static double make_entry(property_trial *t)
{
    return make_choice(t, NULL, 2) == 0 ? 0.0 : make_real(t, NULL, -3, 3);
}

static void make_local(property_trial *t, plain *p)
{
    p->matrix.rows = p->matrix.columns = 3 * p->contacts;
    for (uint32_t i = 0; i < p->matrix.rows * p->matrix.rows; i++) {
        p->matrix.entries[i] = make_entry(t);
    }
}

/* M has components of one to three unknowns, and a diagonal that keeps its condition small.
 * Symmetric in half of the cases; in some of the others two rows are exchanged, so that it takes
 * pivoting. */
static void make_global(property_trial *t, plain *p)
{
    const uint32_t n = 1 + make_choice(t, "unknowns", UNKNOWNS);
    const uint32_t size = 1 + make_choice(t, "component", 3);
    const uint32_t symmetric = make_choice(t, "symmetric", 2);
    plain_matrix *m = &p->matrix;
    m->rows = m->columns = p->h.rows = n;
    p->h.columns = 3 * p->contacts;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < n; j++) {
            const double entry = i / size == j / size ? make_signed(t, NULL) / 4.0 : 0.0;
            m->entries[i * n + j] = i == j               ? make_positive(t, NULL, 0, 2)
                                    : symmetric && j < i ? m->entries[j * n + i]
                                                         : entry;
        }
        p->f[i] = make_real(t, NULL, -3, 3);
    }
    for (uint32_t j = 0; j < n && n > 1 && size > 1 && !symmetric && p->f[0] > 0.0; j++) {
        const double upper = m->entries[j];
        m->entries[j] = m->entries[n + j];
        m->entries[n + j] = upper;
    }
    for (uint32_t i = 0; i < n * p->h.columns; i++) {
        p->h.entries[i] = make_entry(t);
    }
}

static void make_plain(property_trial *t, uint32_t global, plain *p)
{
    property_expand(t);
    memset(p, 0, sizeof *p);
    p->contacts = 1 + make_choice(t, "contacts", CONTACTS);
    p->global = global;
    if (global) {
        make_global(t, p);
    } else {
        make_local(t, p);
    }
    for (uint32_t i = 0; i < 3 * p->contacts; i++) {
        p->q[i] = make_real(t, NULL, -20, 20);
    }
    for (uint32_t i = 0; i < p->contacts; i++) {
        p->mu[i] = make_friction(t, NULL);
    }
}

/* ---- as text ------------------------------------------------------------------------------ */

typedef struct text {
    char bytes[TEXT];
    size_t length;
    unsigned long line;
    unsigned long column;
    uint32_t style;
    size_t count;  /* words */
    size_t matrix; /* words up to the end of the first matrix */
    size_t at[WORDS];
    unsigned long lines[WORDS];
    unsigned long columns[WORDS];
} text;

static void put(text *x, const char *s)
{
    for (; *s != '\0' && x->length < TEXT - 1; s++) {
        x->bytes[x->length++] = *s;
        x->column++;
        if (*s == '\n') {
            x->line++;
            x->column = 1;
        }
    }
}

static void put_word(text *x, const char *word)
{
    static const char *const between[4] = {" ", "\n", "\t \n", "\r\n"};
    if (x->count > 0) {
        put(x, between[(x->style >> (x->count % 5)) & 3]);
    }
    if (x->count < WORDS) {
        x->at[x->count] = x->length;
        x->lines[x->count] = x->line;
        x->columns[x->count++] = x->column;
    }
    put(x, word);
}

static void put_count(text *x, uint32_t count)
{
    char word[32];
    snprintf(word, sizeof word, "%lu", (unsigned long)count);
    put_word(x, word);
}

static void put_number(text *x, double number)
{
    char word[64];
    snprintf(word, sizeof word, (x->style & 32) != 0 ? "%a" : "%.17g", number);
    put_word(x, word);
}

enum { DENSE, BLOCKS, TRIPLETS, BY_COLUMNS, HALF, TEXTS };

static void put_dense(text *x, const plain_matrix *m)
{
    put_count(x, m->rows);
    put_count(x, m->columns);
    for (uint32_t j = 0; j < m->columns; j++) {
        for (uint32_t i = 0; i < m->rows; i++) {
            put_number(x, m->entries[i * m->columns + j]);
        }
    }
}

/* Blocks of `size` (what is left at the end); those of zeros are left out, or not; each row from
 * its last to its first. */
static void put_blocks(text *x, const plain_matrix *m, uint32_t size)
{
    const uint32_t rows = (m->rows + size - 1) / size;
    const uint32_t columns = (m->columns + size - 1) / size;
    uint32_t count = 0;
    uint32_t starts[ROWS + 1] = {0};
    uint32_t places[ROWS * ROWS];
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t j = columns; j-- > 0;) {
            uint32_t full = (x->style & 64) != 0;
            for (uint32_t k = 0; k < size * size && !full; k++) {
                const uint32_t row = i * size + k / size;
                const uint32_t column = j * size + k % size;
                full = row < m->rows && column < m->columns &&
                       m->entries[row * m->columns + column] != 0.0;
            }
            if (full) {
                places[count++] = j;
            }
        }
        starts[i + 1] = count;
    }
    put_count(x, count);
    put_count(x, rows);
    put_count(x, columns);
    for (uint32_t i = 1; i <= rows; i++) {
        put_count(x, i < rows ? i * size : m->rows);
    }
    for (uint32_t i = 1; i <= columns; i++) {
        put_count(x, i < columns ? i * size : m->columns);
    }
    put_count(x, rows + 1);
    put_count(x, count);
    for (uint32_t i = 0; i <= rows; i++) {
        put_count(x, starts[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        put_count(x, places[i]);
    }
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t k = starts[i]; k < starts[i + 1]; k++) {
            put_count(x, k);
            for (uint32_t j = places[k] * size; j < (places[k] + 1) * size && j < m->columns; j++) {
                for (uint32_t row = i * size; row < (i + 1) * size && row < m->rows; row++) {
                    put_number(x, m->entries[row * m->columns + j]);
                }
            }
        }
    }
}

/* The listing ends in a line of its own. Triplets may have two at a place, which cancel out. */
static void put_listing(text *x, const plain_matrix *m, uint32_t storage)
{
    char line[96];
    uint32_t count = 0;
    uint32_t done = 0;
    const uint32_t total = m->rows * m->columns;
    for (uint32_t k = 0; k < total; k++) {
        const int listed = storage != HALF || k / m->columns <= k % m->columns;
        count += m->entries[k] != 0.0 && listed;
    }
    const int twice = storage == TRIPLETS && (x->style & 128) != 0;
    count += twice ? 2 : 0;
    put_count(x, storage == TRIPLETS ? 1 : storage == HALF ? 4 : 2);
    put(x, "\nCXSparse Version 3.1.4, Oct 10, 2014.  Copyright (c) Timothy A. Davis\n");
    snprintf(line, sizeof line, "%s%lu-by-%lu, nzmax: %lu nnz: %lu%s\n",
             storage == BY_COLUMNS ? "" : "triplet: ", (unsigned long)m->rows,
             (unsigned long)m->columns, (unsigned long)count, (unsigned long)count,
             storage == BY_COLUMNS ? ", 1-norm: 1" : "");
    put(x, line);
    if (twice) {
        snprintf(line, sizeof line, "0 %lu : 1\n0 %lu : -1\n", (unsigned long)m->columns - 1,
                 (unsigned long)m->columns - 1);
        put(x, line);
    }
    for (uint32_t j = 0; j < m->columns; j++) {
        uint32_t first = done;
        for (uint32_t i = 0; i < m->rows; i++) {
            done += m->entries[i * m->columns + j] != 0.0;
        }
        if (storage == BY_COLUMNS) {
            snprintf(line, sizeof line, "    col %lu : locations %lu to %ld\n", (unsigned long)j,
                     (unsigned long)first, (long)done - 1);
            put(x, line);
        }
        for (uint32_t i = m->rows; i-- > 0;) {
            const double value = m->entries[i * m->columns + j];
            if (value == 0.0 || (storage == HALF && i > j)) {
                continue;
            }
            snprintf(line, sizeof line, storage == BY_COLUMNS ? "      %lu" : "    %lu %lu",
                     (unsigned long)i, (unsigned long)j);
            put(x, line);
            snprintf(line, sizeof line, " : %.17g\n", value);
            put(x, line);
        }
    }
}

static int is_symmetric(const plain_matrix *m)
{
    int same = m->rows == m->columns;
    for (uint32_t i = 0; i < m->rows && same; i++) {
        for (uint32_t j = 0; j < i; j++) {
            same = same && m->entries[i * m->columns + j] == m->entries[j * m->columns + i];
        }
    }
    return same;
}

static void put_matrix(property_trial *t, text *x, const plain_matrix *m, uint32_t most)
{
    uint32_t storage = make_choice(t, "storage", most);
    if (storage == HALF && !is_symmetric(m)) {
        storage = TRIPLETS;
    }
    put_count(x, storage == DENSE ? 0 : storage == BLOCKS ? 1 : 2);
    put_count(x, m->rows);
    put_count(x, m->columns);
    if (storage == DENSE) {
        put_dense(x, m);
    } else if (storage == BLOCKS) {
        put_blocks(x, m, 1 + make_choice(t, "block", 4));
    } else {
        put_listing(x, m, storage);
    }
}

/* `most`: storages to choose from. */
static void put_plain(property_trial *t, text *x, const plain *p, uint32_t most)
{
    memset(x, 0, sizeof *x);
    x->line = x->column = 1;
    x->style = make_byte(t);
    put_count(x, 3);
    put_count(x, p->contacts);
    put_matrix(t, x, &p->matrix, most);
    x->matrix = x->count;
    if (p->global) {
        put_matrix(t, x, &p->h, most);
        for (uint32_t i = 0; i < p->matrix.rows; i++) {
            put_number(x, p->f[i]);
        }
    }
    for (uint32_t i = 0; i < 3 * p->contacts; i++) {
        put_number(x, p->q[i]);
    }
    for (uint32_t i = 0; i < p->contacts; i++) {
        put_number(x, p->mu[i]);
    }
}

/* ---- as HDF5 ------------------------------------------------------------------------------ */

/* One thing that is wrong. */
enum {
    FAULT_NONE,
    FAULT_REAL,     /* whole numbers are real ones, or the other way round */
    FAULT_TEXT,     /* strings instead of numbers */
    FAULT_FEWER,    /* one number less */
    FAULT_MORE,     /* one number more, where the length is fixed */
    FAULT_HUGE,     /* a billion numbers that take no room */
    FAULT_ABSENT,   /* not there */
    FAULT_GROUP,    /* a group in its place */
    FAULT_NEGATIVE, /* the first number is -7 */
    FAULT_BIG,      /* the first number is 1e9, or NaN */
    FAULTS
};

typedef struct image {
    hid_t file;
    unsigned char bytes[IMAGE];
    size_t length;
    uint32_t fault;
    char faulty[64]; /* the data set */
} image;

static void put_group(image *h, const char *name)
{
    H5Gclose(H5Gcreate2(h->file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

static void put_huge(image *h, const char *name, hid_t type)
{
    const hsize_t count = 1000000000;
    const hsize_t chunk = 1024;
    const hid_t space = H5Screate_simple(1, &count, NULL);
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(made, 1, &chunk);
    H5Dclose(H5Dcreate2(h->file, name, type, space, H5P_DEFAULT, made, H5P_DEFAULT));
    H5Pclose(made);
    H5Sclose(space);
}

static void put_set(image *h, const char *name, hid_t stored, hid_t type, uint32_t count,
                    const void *numbers)
{
    const hsize_t size = count;
    const hid_t space = H5Screate_simple(1, &size, NULL);
    const hid_t set =
        H5Dcreate2(h->file, name, stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (count > 0 && type >= 0) {
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers);
    }
    H5Dclose(set);
    H5Sclose(space);
}

/* int32_t or double; with the fault, if it is this one's. */
static void put_numbers(image *h, const char *group, const char *name, int real, uint32_t count,
                        const void *numbers)
{
    char path[64];
    double reals[ROWS * ROWS + 1] = {0};
    int32_t wholes[ROWS * ROWS + 1] = {0};
    snprintf(path, sizeof path, "%s/%s", group, name);
    const uint32_t fault = strcmp(path, h->faulty) == 0 ? h->fault : FAULT_NONE;
    memcpy(real ? (void *)reals : (void *)wholes, numbers,
           count * (real ? sizeof *reals : sizeof *wholes));
    if (fault == FAULT_NEGATIVE || fault == FAULT_BIG) {
        reals[0] = (double)NAN;
        wholes[0] = fault == FAULT_BIG ? 1000000000 : -7;
    }
    const hid_t type = real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT32;
    const hid_t other = real ? H5T_STD_I32LE : H5T_IEEE_F64LE;
    const uint32_t size = fault == FAULT_FEWER  ? count - 1
                          : fault == FAULT_MORE ? count + 1
                                                : count;
    if (fault == FAULT_GROUP) {
        put_group(h, path);
    } else if (fault == FAULT_HUGE) {
        put_huge(h, path, type);
    } else if (fault == FAULT_TEXT) {
        put_set(h, path, H5T_C_S1, -1, count, NULL);
    } else if (fault != FAULT_ABSENT) {
        put_set(h, path, fault == FAULT_REAL ? other : type, type, size,
                real ? (void *)reals : (void *)wholes);
    }
}

/* Triplets, by columns, or by rows; triplets of one triangle (half) if it is symmetric. */
static void put_sparse(image *h, const char *group, const plain_matrix *m, uint32_t storage,
                       uint32_t half)
{
    int32_t starts[ROWS * ROWS + 1] = {0};
    int32_t places[ROWS * ROWS] = {0};
    double values[ROWS * ROWS] = {0};
    int32_t count = 0;
    const uint32_t lines = storage == 1 ? m->columns : m->rows;
    const uint32_t across = storage == 1 ? m->rows : m->columns;
    for (uint32_t line = 0; line < lines; line++) {
        for (uint32_t k = 0; k < across; k++) {
            const uint32_t i = storage == 1 ? k : line;
            const uint32_t j = storage == 1 ? line : k;
            const double value = m->entries[i * m->columns + j];
            if (value == 0.0 || (half && storage == 0 && i > j)) {
                continue;
            }
            values[count] = value;
            places[count] = (int32_t)(storage == 2 ? j : i);
            if (storage == 0) {
                starts[count] = (int32_t)j;
            }
            count++;
        }
        if (storage != 0) {
            starts[line + 1] = count;
        }
    }
    const int32_t rows = (int32_t)m->rows;
    const int32_t columns = (int32_t)m->columns;
    const int32_t kind = storage == 0 ? count : -(int32_t)storage;
    put_group(h, group);
    put_numbers(h, group, "m", 0, 1, &rows);
    put_numbers(h, group, "n", 0, 1, &columns);
    put_numbers(h, group, "nz", 0, 1, &kind);
    put_numbers(h, group, "nzmax", 0, 1, &count);
    put_numbers(h, group, "p", 0, storage == 0 ? (uint32_t)count : lines + 1, starts);
    put_numbers(h, group, "i", 0, (uint32_t)count, places);
    put_numbers(h, group, "x", 1, (uint32_t)count, values);
}

static void put_hdf5(property_trial *t, image *h, const plain *p)
{
    const int32_t dimension = 3;
    const char *group = p->global ? "/fclib_global" : "/fclib_local";
    char path[64];
    const uint32_t half = p->global && is_symmetric(&p->matrix) && make_choice(t, "half", 2) == 1;
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    H5Pset_fapl_core(access, 4096, 0);
    h->file = H5Fcreate("problem", H5F_ACC_TRUNC, H5P_DEFAULT, access);
    put_group(h, group);
    put_numbers(h, group, "spacedim", 0, 1, &dimension);
    snprintf(path, sizeof path, "%s/%s", group, p->global ? "M" : "W");
    put_sparse(h, path, &p->matrix, make_choice(t, "storage", 3), half);
    if (p->global) {
        put_sparse(h, "/fclib_global/H", &p->h, make_choice(t, "storage", 3), 0);
    }
    snprintf(path, sizeof path, "%s/vectors", group);
    put_group(h, path);
    put_numbers(h, path, p->global ? "w" : "q", 1, 3 * p->contacts, p->q);
    put_numbers(h, path, "mu", 1, p->contacts, p->mu);
    if (p->global) {
        put_numbers(h, path, "f", 1, p->matrix.rows, p->f);
    }
    H5Fflush(h->file, H5F_SCOPE_GLOBAL);
    const ssize_t length = H5Fget_file_image(h->file, h->bytes, sizeof h->bytes);
    h->length = length > 0 ? (size_t)length : 0;
    H5Fclose(h->file);
    H5Pclose(access);
}

/* ---- as it is read ------------------------------------------------------------------------ */

static int read_back(const void *bytes, size_t length, problem *got)
{
    channel *p = channel_begin(bytes, length);
    const int status = problem_read(p->path, got);
    channel_end(p);
    return status;
}

/* Rows and columns are in order, no block but the diagonal is all zeros, all is finite; W goes into
 * `w`, row by row. */
static int unfold(const problem *got, double w[ROWS * ROWS])
{
    const uint32_t n = 3 * (uint32_t)got->count;
    int good = got->count >= 1 && got->count <= CONTACTS && got->row_starts[0] == 0;
    memset(w, 0, ROWS * ROWS * sizeof *w);
    for (uint32_t row = 0; row < got->count && good; row++) {
        int diagonal = 0;
        for (uint32_t k = got->row_starts[row]; k < got->row_starts[row + 1] && good; k++) {
            const uint32_t column = got->columns[k];
            int full = column == row;
            diagonal |= full;
            good =
                column < got->count && (k == got->row_starts[row] || got->columns[k - 1] < column);
            for (uint32_t i = 0; i < 9 && good; i++) {
                const double value = got->blocks[9 * k + i];
                full |= value != 0.0;
                good = isfinite(value);
                w[(3 * row + i / 3) * n + 3 * column + i % 3] = value;
            }
            good = good && full;
        }
        good = good && diagonal;
    }
    return good;
}

static int same_vectors(const problem *got, const plain *want)
{
    int same = got->count == want->contacts;
    for (uint32_t i = 0; i < 3 * want->contacts && same; i++) {
        same = want->global || got->q[i] == want->q[i];
    }
    for (uint32_t i = 0; i < want->contacts && same; i++) {
        same = got->mu[2 * i] == want->mu[i] && got->mu[2 * i + 1] == want->mu[i];
    }
    return same;
}

/* ---- what is written is read -------------------------------------------------------------- */

static void require_local(property_trial *t, const void *bytes, size_t length, const plain *want)
{
    problem got;
    double w[ROWS * ROWS];
    const int status = read_back(bytes, length, &got);
    int same = status == 0 && channel_get()->message[0] == '\0' && unfold(&got, w) &&
               same_vectors(&got, want);
    for (uint32_t i = 0; i < 9 * want->contacts * want->contacts && same; i++) {
        same = w[i] == want->matrix.entries[i]; /* but for the sign of a zero, which is not kept */
    }
    problem_free(&got);
    REQUIRE(t, same);
}

static void problem_dense(property_trial *t)
{
    static plain want;
    static text x;
    make_plain(t, 0, &want);
    put_plain(t, &x, &want, 1);
    require_local(t, x.bytes, x.length, &want);
}

static size_t make_bytes(property_trial *t, const char *before, char *bytes)
{
    size_t length = strlen(before);
    memcpy(bytes, before, length);
    while (t->used < t->size && length < TEXT) {
        bytes[length++] = (char)make_byte(t);
    }
    return length;
}

static void problem_bytes(property_trial *t)
{
    static char bytes[TEXT + 1];
    static const char *const starts[4] = {"", "3\n1\n0\n3 3 3 3\n1 0 0 0 1 0 0 0 1\n",
                                          "3\n1\n1\n1\n3\n3\n1\n", "3\n1\n2\n3\n3\n1\nCSparse\n"};
    problem got;
    const uint32_t start = make_choice(t, "start", 4);
    const size_t length = make_bytes(t, starts[start], bytes);
    const int status = read_back(bytes, length, &got);
    problem_free(&got);
    REQUIRE(t, status == 0 ? channel_get()->message[0] == '\0'
                           : status == CLI_BAD_INPUT && channel_said_once(channel_get()));
}

static void problem_storages(property_trial *t)
{
    static plain want;
    static text x;
    make_plain(t, 0, &want);
    put_plain(t, &x, &want, TEXTS);
    require_local(t, x.bytes, x.length, &want);
}

static void problem_hdf5(property_trial *t)
{
    static plain want;
    static image h;
    make_plain(t, 0, &want);
    h.faulty[0] = '\0';
    put_hdf5(t, &h, &want);
    REQUIRE(t, h.length > 0);
    require_local(t, h.bytes, h.length, &want);
}

static void exchange(uint32_t count, long double *left, long double *right)
{
    for (uint32_t j = 0; j < count; j++) {
        const long double held = left[j];
        left[j] = right[j];
        right[j] = held;
    }
}

/* x: columns of H and f, replaced by M^-1 times them. */
static void divide(uint32_t n, uint32_t count, long double *m, long double *x)
{
    for (uint32_t k = 0; k < n; k++) {
        uint32_t pivot = k;
        for (uint32_t i = k; i < n; i++) {
            pivot = fabsl(m[i * n + k]) > fabsl(m[pivot * n + k]) ? i : pivot;
        }
        exchange(pivot == k ? 0 : n, m + k * n, m + pivot * n);
        exchange(pivot == k ? 0 : count, x + k * count, x + pivot * count);
        for (uint32_t i = 0; i < n; i++) {
            const long double factor = i == k ? 0.0L : m[i * n + k] / m[k * n + k];
            for (uint32_t j = 0; j < n; j++) {
                m[i * n + j] -= factor * m[k * n + j];
            }
            for (uint32_t j = 0; j < count; j++) {
                x[i * count + j] -= factor * x[k * count + j];
            }
        }
    }
    for (uint32_t i = 0; i < n * count; i++) {
        x[i] /= m[i / count * n + i / count];
    }
}

/* W = H^T M^-1 H and q = H^T M^-1 f + w, in long double by another elimination. */
static void require_reduced(property_trial *t, const plain *p, const double *w, const double *q)
{
    static long double m[UNKNOWNS * UNKNOWNS];
    static long double x[UNKNOWNS * (ROWS + 1)];
    const uint32_t n = p->matrix.rows;
    const uint32_t columns = p->h.columns;
    for (uint32_t i = 0; i < n * n; i++) {
        m[i] = (long double)p->matrix.entries[i];
    }
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < columns; j++) {
            x[i * (columns + 1) + j] = (long double)p->h.entries[i * columns + j];
        }
        x[i * (columns + 1) + columns] = (long double)p->f[i];
    }
    divide(n, columns + 1, m, x);
    for (uint32_t i = 0; i < columns; i++) {
        for (uint32_t j = 0; j <= columns; j++) {
            long double sum = j < columns ? 0.0L : (long double)p->q[i];
            long double size = fabsl(sum);
            for (uint32_t k = 0; k < n; k++) {
                const long double product =
                    (long double)p->h.entries[k * columns + i] * x[k * (columns + 1) + j];
                sum += product;
                size += fabsl(product);
            }
            /* The entries of a solution share their error. */
            REQUIRE_NEAR(t, j < columns ? w[i * columns + j] : q[i], sum,
                         64.0 * EPS * ((double)size + 1024.0));
            REQUIRE(t, j >= columns || !is_symmetric(&p->matrix) ||
                           w[i * columns + j] == w[j * columns + i]);
        }
    }
}

static void require_global(property_trial *t, const void *bytes, size_t length, const plain *want)
{
    problem got;
    double w[ROWS * ROWS];
    double q[ROWS] = {0};
    const int status = read_back(bytes, length, &got);
    const int same = status == 0 && channel_get()->message[0] == '\0' && unfold(&got, w) &&
                     same_vectors(&got, want);
    for (uint32_t i = 0; i < 3 * want->contacts && same; i++) {
        q[i] = got.q[i];
    }
    problem_free(&got);
    REQUIRE(t, same);
    require_reduced(t, want, w, q);
}

/* M with entries on one side of the diagonal only is half of a symmetric one. */
static int has_one_triangle(const plain_matrix *m)
{
    uint32_t above = 0;
    uint32_t below = 0;
    for (uint32_t k = 0; k < m->rows * m->columns; k++) {
        above += m->entries[k] != 0.0 && k / m->columns < k % m->columns;
        below += m->entries[k] != 0.0 && k / m->columns > k % m->columns;
    }
    return (above == 0) != (below == 0);
}

static void problem_reduced(property_trial *t)
{
    static plain want;
    static text x;
    make_plain(t, 1, &want);
    ASSUME(t, !has_one_triangle(&want.matrix));
    put_plain(t, &x, &want, TEXTS);
    require_global(t, x.bytes, x.length, &want);
}

static void problem_reduced_hdf5(property_trial *t)
{
    static plain want;
    static image h;
    make_plain(t, 1, &want);
    ASSUME(t, !has_one_triangle(&want.matrix));
    h.faulty[0] = '\0';
    put_hdf5(t, &h, &want);
    REQUIRE(t, h.length > 0);
    require_global(t, h.bytes, h.length, &want);
}

/* ---- faults ------------------------------------------------------------------------------- */

static const char *const not_numbers[] = {"nan", "-inf", "1e999", "1x", "x", "--1", "1,5", "0x"};

/* A word that is no number, or the end of the file in its place. */
static void problem_faults(property_trial *t)
{
    static plain want;
    static text x;
    static char bytes[TEXT + 16];
    unsigned long got[2];
    problem none;
    make_plain(t, make_choice(t, "global", 2), &want);
    put_plain(t, &x, &want, 2);
    const uint32_t word = make_choice(t, "word", (uint32_t)x.count);
    const uint32_t bad = make_choice(t, "bad", (uint32_t)PROPERTY_COUNT(not_numbers) + 1);
    size_t length = x.at[word];
    /* The head of a 3x3 matrix H may be q and mu as well. */
    ASSUME(t, !want.global || want.matrix.rows != 3 || word != x.matrix + 4);
    memcpy(bytes, x.bytes, length);
    if (bad < PROPERTY_COUNT(not_numbers)) {
        size_t rest = word + 1 < x.count ? x.at[word + 1] : x.length;
        bytes[length] = '\0';
        strcat(bytes, not_numbers[bad]);
        strcat(bytes, " ");
        length = strlen(bytes);
        memcpy(bytes + length, x.bytes + rest, x.length - rest);
        length += x.length - rest;
    }
    REQUIRE(t, read_back(bytes, length, &none) == CLI_BAD_INPUT);
    REQUIRE(t, none.count == 0 && none.blocks == NULL);
    REQUIRE(t, channel_place(channel_get(), &got[0], &got[1]));
    if (bad < PROPERTY_COUNT(not_numbers)) {
        REQUIRE(t,
                got[0] < x.lines[word] || (got[0] == x.lines[word] && got[1] <= x.columns[word]));
    }
}

/* Data sets, and which faults of them are none. */
typedef struct set {
    const char *name;
    uint32_t harmless; /* bits of faults */
} set;

static void problem_hdf5_faults(property_trial *t)
{
    static plain want;
    static image h;
    problem none;
    static const set sets[2][11] = {{{"spacedim", 1u << FAULT_MORE},
                                     {"W/m", 1u << FAULT_MORE},
                                     {"W/n", 1u << FAULT_MORE},
                                     {"W/nz", 1u << FAULT_MORE},
                                     {"W/p", 1u << FAULT_MORE},
                                     {"W/i", 1u << FAULT_MORE},
                                     {"W/x", 1u << FAULT_MORE},
                                     {"vectors/q", 0},
                                     {"vectors/mu", 0},
                                     {"vectors/mu", 0},
                                     {"vectors/q", 0}},
                                    {{"spacedim", 1u << FAULT_MORE},
                                     {"M/m", 1u << FAULT_MORE},
                                     {"M/nz", 1u << FAULT_MORE},
                                     {"M/x", 1u << FAULT_MORE},
                                     {"H/n", 1u << FAULT_MORE},
                                     {"H/p", 1u << FAULT_MORE},
                                     {"H/i", 1u << FAULT_MORE},
                                     {"H/x", 1u << FAULT_MORE},
                                     {"vectors/f", 0},
                                     {"vectors/w", 0},
                                     {"vectors/mu", 0}}};
    make_plain(t, make_choice(t, "global", 2), &want);
    const set *bad = &sets[want.global][make_choice(t, "set", 11)];
    h.fault = 1 + make_choice(t, "fault", FAULTS - 1);
    ASSUME(t, (bad->harmless >> h.fault & 1u) == 0);
    /* Each matrix has an entry, so that none of its data sets is empty. */
    want.matrix.entries[0] = 2.0;
    want.h.entries[0] = 1.0;
    snprintf(h.faulty, sizeof h.faulty, "/fclib_%s/%s", want.global ? "global" : "local",
             bad->name);
    put_hdf5(t, &h, &want);
    REQUIRE(t, h.length > 0);
    REQUIRE(t, read_back(h.bytes, h.length, &none) == CLI_BAD_INPUT);
    REQUIRE(t, none.count == 0 && none.blocks == NULL);
    REQUIRE(t, channel_said_once(channel_get()));
    REQUIRE(t, strstr(channel_get()->message, "/fclib_") != NULL);
}

/* Bytes that are changed, or the end that is lost: a problem that can be solved, or one message. */
static void problem_hdf5_bytes(property_trial *t)
{
    static plain want;
    static image h;
    problem got;
    double w[ROWS * ROWS];
    make_plain(t, make_choice(t, "global", 2), &want);
    h.faulty[0] = '\0';
    put_hdf5(t, &h, &want);
    REQUIRE(t, h.length > 0);
    const uint32_t changes = make_choice(t, "changes", 4);
    for (uint32_t i = 0; i < changes; i++) {
        h.bytes[make_bits(t, 4) % h.length] = make_byte(t);
    }
    if (make_choice(t, "cut", 4) == 3) {
        h.length = make_bits(t, 4) % h.length;
    }
    const int status = read_back(h.bytes, h.length, &got);
    const int good = status != 0 || unfold(&got, w);
    problem_free(&got);
    REQUIRE(t, good);
    REQUIRE(t, status == 0 ? channel_get()->message[0] == '\0'
                           : status == CLI_BAD_INPUT && channel_said_once(channel_get()));
}

const char *const property_room = "problem";
const property property_list[] = {
    {"problem_dense", problem_dense, 1},
    {"problem_bytes", problem_bytes, 1},
    {"problem_storages", problem_storages, 1},
    {"problem_hdf5", problem_hdf5, 30},
    {"problem_reduced", problem_reduced, 1},
    {"problem_reduced_hdf5", problem_reduced_hdf5, 30},
    {"problem_faults", problem_faults, 1},
    {"problem_hdf5_faults", problem_hdf5_faults, 10},
    {"problem_hdf5_bytes", problem_hdf5_bytes, 30},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 10000;
