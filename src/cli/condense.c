#include "condense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"

/* ---- memory ---------------------------------------------------------------------------------- */

typedef struct budget {
    const char *file;
    size_t left; /* bytes */
    int exit_status;
} budget;

static void complain(budget *b, const char *message)
{
    if (b->exit_status == 0)
        b->exit_status = cli_error(CLI_BAD_INPUT, "%s: %s", b->file, message);
}

/* Zeros. */
static void *take(budget *b, size_t count, size_t size)
{
    void *memory = NULL;

    if (count >= b->left / size)
        complain(b, "reduced to its contacts, the problem is too big for the size of the file");
    if (b->exit_status != 0)
        return NULL;
    memory = calloc(count + 1, size);
    b->left -= (count + 1) * size;
    if (memory == NULL)
        complain(b, "not enough memory");
    return memory;
}

/* ---- items sorted into groups ---------------------------------------------------------------- */

typedef struct groups {
    size_t *starts; /* one more than there are groups */
    size_t *order;  /* items of group g: order[starts[g]] to order[starts[g + 1] - 1], ascending */
} groups;

/* Item i goes into the group group_of[places[2 i]]; group_of[i] if places is null. */
static groups sort_into_groups(budget *b, size_t count, const uint32_t *places,
                               const uint32_t *group_of, size_t group_count)
{
    const groups out = {take(b, group_count + 1, sizeof *out.starts),
                        take(b, count, sizeof *out.order)};

    if (b->exit_status != 0)
        return out;
    for (size_t i = 0; i < count; i++)
        out.starts[group_of[places != NULL ? places[2 * i] : i] + 1]++;
    for (size_t g = 0; g < group_count; g++)
        out.starts[g + 1] += out.starts[g];
    for (size_t i = count; i-- > 0;) /* starts become ends, and starts again */
        out.order[--out.starts[group_of[places != NULL ? places[2 * i] : i] + 1]] = i;
    for (size_t g = 0; g < group_count; g++)
        out.starts[g] = out.starts[g + 1];
    out.starts[group_count] = count;
    return out;
}

static void groups_free(groups *g)
{
    free(g->starts);
    free(g->order);
}

/* ---- W by blocks ----------------------------------------------------------------------------- */

static int compare_columns(const void *left, const void *right)
{
    const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;

    return (a > b) - (a < b);
}

/* Block columns of a row, ascending, with the diagonal; returns their number. `seen`: 0s before
 * and after. */
static size_t columns_of_row(const entries *w, const groups *rows, size_t row, uint32_t *seen,
                             uint32_t *columns)
{
    size_t count = 1;

    columns[0] = (uint32_t)row;
    seen[row] = 1;
    for (size_t k = rows->starts[row]; k < rows->starts[row + 1]; k++) {
        const uint32_t column = w->places[2 * rows->order[k] + 1] / 3u;
        if (!seen[column])
            columns[count++] = column;
        seen[column] = 1;
    }
    qsort(columns, count, sizeof *columns, compare_columns);
    for (size_t k = 0; k < count; k++)
        seen[columns[k]] = 0;
    return count;
}

static void fill_row(const entries *w, const groups *rows, size_t row, uint32_t *place,
                     problem *out)
{
    for (uint32_t k = out->row_starts[row]; k < out->row_starts[row + 1]; k++)
        place[out->columns[k]] = k;
    for (size_t k = rows->starts[row]; k < rows->starts[row + 1]; k++) {
        const size_t entry = rows->order[k];
        const uint32_t i = w->places[2 * entry], j = w->places[2 * entry + 1];
        out->blocks[9 * (size_t)place[j / 3u] + 3u * (i % 3u) + j % 3u] += w->values[entry];
    }
}

/* Leave out blocks of zeros, which entries that cancel out have left. */
static void drop_zeros(problem *out)
{
    static const double zeros[9];
    uint32_t kept = 0, first = 0;

    for (uint32_t row = 0; row < out->count; row++) {
        const uint32_t end = out->row_starts[row + 1];
        for (uint32_t k = first; k < end; k++) {
            const double *block = out->blocks + 9 * (size_t)k;
            int full = out->columns[k] == row;
            for (size_t i = 0; i < 9 && !full; i++)
                full = block[i] != zeros[i];
            if (full) {
                out->columns[kept] = out->columns[k];
                memmove(out->blocks + 9 * (size_t)kept++, block, 9 * sizeof *block);
            }
        }
        first = end;
        out->row_starts[row + 1] = kept;
    }
}

static void assemble(budget *b, const entries *w, problem *out)
{
    uint32_t *row_of = take(b, w->rows, sizeof *row_of);
    uint32_t *seen = take(b, out->count, sizeof *seen);
    uint32_t *columns = take(b, out->count, sizeof *columns);
    size_t total = 0;

    for (size_t i = 0; i < w->rows && b->exit_status == 0; i++)
        row_of[i] = (uint32_t)(i / 3);
    groups rows = sort_into_groups(b, w->count, w->places, row_of, out->count);
    out->row_starts = take(b, out->count + 1, sizeof *out->row_starts);
    for (size_t row = 0; row < out->count && b->exit_status == 0; row++) {
        total += columns_of_row(w, &rows, row, seen, columns);
        if (total > UINT32_MAX)
            complain(b, "more than 4294967295 blocks");
        out->row_starts[row + 1] = (uint32_t)total;
    }
    out->columns = take(b, total, sizeof *out->columns);
    out->blocks = take(b, total, 9 * sizeof *out->blocks);
    for (size_t row = 0; row < out->count && b->exit_status == 0; row++) {
        columns_of_row(w, &rows, row, seen, out->columns + out->row_starts[row]);
        fill_row(w, &rows, row, columns, out);
    }
    if (b->exit_status == 0)
        drop_zeros(out);
    groups_free(&rows);
    free(columns);
    free(seen);
    free(row_of);
}

/* ---- connected components of M --------------------------------------------------------------- */

typedef struct reduction {
    const recorded *given;
    uint32_t half;          /* 1: M has one triangle only */
    uint32_t count;         /* components */
    uint32_t *component;    /* of each unknown */
    uint32_t *place;        /* of each unknown in its component */
    groups unknowns, m, h;  /* by component: unknowns, entries of M, entries of H */
    uint32_t *columns;      /* of H that the present component has */
    uint32_t *column_place; /* of each column of H among those, from 1; 0: not there */
    double *dense;          /* M of the present component, column by column */
    double *right;          /* right-hand sides: columns of H, then f */
    double *products;       /* H^T M^-1 H, row by row */
    entries w;
} reduction;

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Numbers the components in the order of their first unknowns. */
static void find_components(budget *b, reduction *r)
{
    const entries *m = &r->given->matrix;
    uint32_t *parent = take(b, m->rows, sizeof *parent);
    uint32_t *size = take(b, m->rows, sizeof *size);

    r->component = take(b, m->rows, sizeof *r->component);
    r->place = take(b, m->rows, sizeof *r->place);
    for (uint32_t i = 0; i < m->rows && b->exit_status == 0; i++)
        parent[i] = i;
    for (size_t k = 0; k < m->count && b->exit_status == 0; k++) {
        const uint32_t i = root_of(parent, m->places[2 * k]);
        const uint32_t j = root_of(parent, m->places[2 * k + 1]);
        parent[i > j ? i : j] = i < j ? i : j;
    }
    for (uint32_t i = 0; i < m->rows && b->exit_status == 0; i++) {
        const uint32_t root = root_of(parent, i);
        r->component[i] = root == i ? r->count++ : r->component[root];
        r->place[i] = size[root]++;
    }
    free(size);
    free(parent);
}

/* Whether M has entries on one side of the diagonal only: then the other half is not stored. */
static uint32_t is_half(const entries *m)
{
    size_t above = 0, below = 0;

    for (size_t k = 0; k < m->count; k++) {
        above += m->places[2 * k] < m->places[2 * k + 1];
        below += m->places[2 * k] > m->places[2 * k + 1];
    }
    return (above == 0) != (below == 0);
}

/* Finds the columns of H that a component has. */
static size_t find_columns(reduction *r, size_t component)
{
    size_t count = 0;

    for (size_t k = r->h.starts[component]; k < r->h.starts[component + 1]; k++) {
        const uint32_t column = r->given->h.places[2 * r->h.order[k] + 1];
        if (r->column_place[column] == 0) {
            r->columns[count] = column;
            r->column_place[column] = (uint32_t)++count;
        }
    }
    return count;
}

static void forget_columns(reduction *r, size_t count)
{
    for (size_t k = 0; k < count; k++)
        r->column_place[r->columns[k]] = 0;
}

/* Memory for the greatest component, and for all entries of W. */
static void prepare(budget *b, reduction *r)
{
    const recorded *given = r->given;
    size_t dense = 0, right = 0, products = 0, room = 0;

    r->half = is_half(&given->matrix);
    find_components(b, r);
    r->columns = take(b, given->h.columns, sizeof *r->columns);
    r->column_place = take(b, given->h.columns, sizeof *r->column_place);
    r->unknowns = sort_into_groups(b, given->matrix.rows, NULL, r->component, r->count);
    r->m = sort_into_groups(b, given->matrix.count, given->matrix.places, r->component, r->count);
    r->h = sort_into_groups(b, given->h.count, given->h.places, r->component, r->count);
    for (size_t c = 0; c < r->count && b->exit_status == 0; c++) {
        const size_t n = r->unknowns.starts[c + 1] - r->unknowns.starts[c];
        const size_t count = find_columns(r, c);
        forget_columns(r, count);
        dense = n * n > dense ? n * n : dense;
        right = n * (count + 1) > right ? n * (count + 1) : right;
        products = count * count > products ? count * count : products;
        room += count * count;
    }
    r->dense = take(b, dense, sizeof *r->dense);
    r->products = take(b, products, sizeof *r->products);
    r->right = take(b, right, sizeof *r->right);
    r->w.places = take(b, room, 2 * sizeof *r->w.places);
    r->w.values = take(b, room, sizeof *r->w.values);
    r->w.room = room;
    r->w.rows = r->w.columns = given->h.columns;
}

/* ---- one component --------------------------------------------------------------------------- */

static void load_matrix(reduction *r, size_t component, size_t n)
{
    const entries *m = &r->given->matrix;

    memset(r->dense, 0, n * n * sizeof *r->dense);
    for (size_t k = r->m.starts[component]; k < r->m.starts[component + 1]; k++) {
        const size_t entry = r->m.order[k];
        const size_t i = r->place[m->places[2 * entry]], j = r->place[m->places[2 * entry + 1]];
        r->dense[j * n + i] += m->values[entry];
        if (r->half && i != j)
            r->dense[i * n + j] += m->values[entry];
    }
}

static void load_right(reduction *r, size_t component, size_t n, size_t count)
{
    const entries *h = &r->given->h;

    memset(r->right, 0, n * count * sizeof *r->right);
    for (size_t k = r->h.starts[component]; k < r->h.starts[component + 1]; k++) {
        const size_t entry = r->h.order[k];
        const size_t j = r->column_place[h->places[2 * entry + 1]] - 1u;
        r->right[j * n + r->place[h->places[2 * entry]]] += h->values[entry];
    }
    for (size_t i = 0; i < n; i++)
        r->right[count * n + i] = r->given->f[r->unknowns.order[r->unknowns.starts[component] + i]];
}

static int is_symmetric(const double *a, size_t n)
{
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < j; i++) {
            if (a[j * n + i] != a[i * n + j])
                return 0;
        }
    }
    return 1;
}

/* Replace each of the `count` columns of `x` by M^-1 times it: elimination with partial pivoting, M
 * is used up. Returns 0 if M is singular. */
static int divide(double *a, size_t n, size_t count, double *x)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            pivot = fabs(a[k * n + i]) > fabs(a[k * n + pivot]) ? i : pivot;
        if (a[k * n + pivot] == 0.0)
            return 0;
        for (size_t j = k; j < n + count; j++) {
            double *column = j < n ? a + j * n : x + (j - n) * n;
            const double upper = column[pivot];
            column[pivot] = column[k];
            column[k] = upper;
        }
        for (size_t i = k + 1; i < n; i++)
            a[k * n + i] /= a[k * n + k];
        for (size_t j = k + 1; j < n + count; j++) {
            double *column = j < n ? a + j * n : x + (j - n) * n;
            const double factor = column[k];
            for (size_t i = k + 1; i < n && factor != 0.0; i++)
                column[i] -= factor * a[k * n + i];
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

/* Adds what the component gives to W and q; `symmetric`: its M is, and so will be W. */
static void multiply(reduction *r, size_t component, size_t n, size_t count, int symmetric,
                     double *q)
{
    const entries *h = &r->given->h;

    memset(r->products, 0, count * count * sizeof *r->products);
    for (size_t k = r->h.starts[component]; k < r->h.starts[component + 1]; k++) {
        const size_t entry = r->h.order[k];
        const uint32_t column = h->places[2 * entry + 1];
        const size_t i = r->column_place[column] - 1u, row = r->place[h->places[2 * entry]];
        for (size_t j = symmetric ? i : 0; j < count; j++)
            r->products[i * count + j] += h->values[entry] * r->right[j * n + row];
        q[column] += h->values[entry] * r->right[count * n + row];
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++) {
            const size_t from = symmetric && j < i ? j * count + i : i * count + j;
            entries_add(&r->w, r->columns[i], r->columns[j], r->products[from]); /* has room */
        }
    }
}

static void reduce(budget *b, const recorded *given, problem *out)
{
    reduction r = {.given = given};

    prepare(b, &r);
    for (size_t c = 0; c < r.count && b->exit_status == 0; c++) {
        const size_t n = r.unknowns.starts[c + 1] - r.unknowns.starts[c];
        const size_t count = find_columns(&r, c);
        load_matrix(&r, c, n);
        load_right(&r, c, n, count);
        const int symmetric = is_symmetric(r.dense, n);
        if (divide(r.dense, n, count + 1, r.right))
            multiply(&r, c, n, count, symmetric, out->q);
        else
            b->exit_status = cli_error(CLI_BAD_INPUT,
                                       "%s: M is singular, at unknown %zu or one "
                                       "that is connected with it (from 0)",
                                       b->file, r.unknowns.order[r.unknowns.starts[c]]);
        forget_columns(&r, count);
    }
    if (b->exit_status == 0)
        assemble(b, &r.w, out);
    groups_free(&r.unknowns);
    groups_free(&r.m);
    groups_free(&r.h);
    free(r.component);
    free(r.place);
    free(r.columns);
    free(r.column_place);
    free(r.dense);
    free(r.right);
    free(r.products);
    free(r.w.places);
    free(r.w.values);
}

static int all_finite(size_t count, const double *numbers)
{
    size_t i = 0;

    while (i < count && isfinite(numbers[i]))
        i++;
    return i == count;
}

int condense(const char *file, const recorded *given, size_t size, problem *out)
{
    budget b = {file, size, 0};

    *out = (problem){.count = given->contacts};
    out->q = take(&b, out->count, 3 * sizeof *out->q);
    out->mu = take(&b, out->count, 2 * sizeof *out->mu);
    for (size_t i = 0; i < 3 * out->count && b.exit_status == 0; i++)
        out->q[i] = given->q[i];
    for (size_t i = 0; i < 2 * out->count && b.exit_status == 0; i++)
        out->mu[i] = given->mu[i / 2];
    if (b.exit_status == 0 && given->global)
        reduce(&b, given, out);
    else if (b.exit_status == 0)
        assemble(&b, &given->matrix, out);
    if (b.exit_status == 0 && (!all_finite(3 * out->count, out->q) ||
                               !all_finite(9 * (size_t)out->row_starts[out->count], out->blocks)))
        complain(&b, "reduced to its contacts, the problem has numbers beyond double");
    if (b.exit_status != 0)
        problem_free(out);
    return b.exit_status;
}
