#include "newton_state.h"

#include "resist.h"

/* A step without its elimination takes as long as so many sweeps; a contact of a sweep as long as so
 * many operations of elimination, which is some times faster on dense matrices. */
#define STEP_SWEEPS 16.0
#define SWEEP_OPERATIONS 150.0
#define BLOCK_OPERATIONS 30.0     /* of a block of W that is summed */
#define TORQUE_OPERATIONS 18000.0 /* of a contact with a torque, which no lanes solve */
#define DENSE_SHARE 0.2
#define CLIQUE_SHARE 0.15 /* contacts of one body are all linked: fewer, larger blocks */

/* ---- memory ---------------------------------------------------------------------------------- */

static void take_matrix(newton *n, arena *a, uint32_t rows, size_t entries, const newton_run *run)
{
    const uint32_t small = rows < run->dense_limit ? rows : run->dense_limit;

    n->x = numbers(a, rows);
    n->room = small * dense_stride(small);
    n->dense = numbers(a, n->room);
    n->pivots = arena_take(a, rows, sizeof(uint32_t));
    if (run->linear.factor == NULL || rows <= small)
        return;
    n->row_starts = arena_take(a, (size_t)rows + 1, sizeof(uint32_t));
    n->columns = arena_take(a, entries, sizeof(uint32_t));
    n->values = numbers(a, entries);
}

static void take_lower(newton *n, arena *a, uint32_t rows, size_t entries)
{
    n->lower_starts = arena_take(a, (size_t)rows + 1, sizeof(uint32_t));
    n->lower_columns = arena_take(a, entries, sizeof(uint32_t));
    n->lower_values = numbers(a, entries);
}

void step_take(newton *n, arena *a, uint32_t count, uint32_t bodies, size_t links,
               const newton_run *run)
{
    if (bodies != 0) {
        n->half = numbers(a, 36 * (size_t)count);
        n->root = numbers(a, 6 * (size_t)bodies);
        n->rank = arena_take(a, bodies, sizeof(uint32_t));
        n->starts = arena_take(a, (size_t)bodies + 2, sizeof(uint32_t));
        n->neighbours = arena_take(a, links + bodies, sizeof(uint32_t));
        take_matrix(n, a, 6 * bodies, 36 * (links + bodies), run);
        take_lower(n, a, 6 * bodies, 18 * links + 21 * (size_t)bodies);
    } else {
        n->rank = arena_take(a, count, sizeof(uint32_t));
        take_matrix(n, a, 3 * count, 9 * links, run);
    }
}

/* ---- factorisation --------------------------------------------------------------------------- */

/* Narrow matrices have room where wide ones of fewer rows have. */
static void choose_shape(newton *n, uint32_t rows, uint32_t band, const newton_run *run)
{
    n->shape = dense_shape_of(rows, band);
    n->is_dense = rows <= run->dense_limit || n->shape.numbers <= n->room ? 1 : 0;
}

/* Those of LU; Cholesky takes half. */
static double dense_operations(const dense_shape *shape)
{
    const double rows = (double)shape->n;
    const double below = lesser(rows, (double)shape->band + 8.0);
    const double beside = lesser(rows, 2.0 * (double)shape->band + 8.0);

    return DENSE_SHARE * rows * below * beside;
}

/* Entry (0, 0). */
static double *dense_entries(const newton *n)
{
    return n->dense + n->shape.origin;
}

static void clear_dense(newton *n)
{
    for (size_t i = 0; i < n->shape.numbers; i++)
        n->dense[i] = 0.0;
}

static int factor_dense(newton *n, const newton_run *run)
{
    return n->symmetric != 0 ? dense_cholesky(run->isa, &n->shape, dense_entries(n))
                             : dense_lu(run->isa, &n->shape, dense_entries(n), n->pivots);
}

static int note_status(tribo_status status, newton_run *run)
{
    if (status != TRIBO_OK && status != TRIBO_ERROR_CONTACT_MATRIX)
        run->status = status;
    return status == TRIBO_OK;
}

/* Factor the matrix that stands in `dense` or in rows of scalars. */
static int factor(newton *n, uint32_t rows, newton_run *run)
{
    const tribo_linear *linear = &run->linear;

    if (rows == 0)
        return 1;
    run->factorizations++;
    if (n->is_dense != 0)
        return factor_dense(n, run);
    if (n->symmetric != 0 && n->problem->bodies != 0)
        return note_status(linear->factor(linear->context, rows, n->lower_starts, n->lower_columns,
                                          n->lower_values, 1),
                           run);
    return note_status(
        linear->factor(linear->context, rows, n->row_starts, n->columns, n->values, n->symmetric),
        run);
}

/* Solve for x in place with the matrix that was factored last. */
static int substitute(newton *n, uint32_t rows, newton_run *run)
{
    if (rows == 0)
        return 1;
    if (n->is_dense == 0)
        return note_status(run->linear.solve(run->linear.context, n->x), run);
    if (n->symmetric != 0)
        dense_cholesky_solve(run->isa, &n->shape, dense_entries(n), n->x);
    else
        dense_lu_solve(run->isa, &n->shape, dense_entries(n), n->pivots, n->x);
    return 1;
}

/* ---- Newton step on blocks of W -------------------------------------------------------------- */

/* Rows that a contact has in the matrix: none if it is open, the normal alone without friction. */
static uint32_t rows_of(const newton *n, size_t c)
{
    return n->mode[c] == OPEN ? 0u : coefficient(n, c) > 0.0 ? 3u : 1u;
}

/* Number the unknowns, contact after contact; `ranked`: in the order of n->rank. Returns how many. */
static uint32_t number_rows(newton *n, int ranked)
{
    uint32_t rows = 0;

    for (uint32_t i = 0; i < n->problem->count; i++) {
        const uint32_t c = ranked ? n->rank[i] : i;
        n->place[c] = rows;
        rows += rows_of(n, c);
    }
    return rows;
}

/* Greatest distance of an entry from the diagonal, or a little more. */
static uint32_t band_of_blocks(const newton *n)
{
    const system_problem *p = n->problem;
    uint32_t apart = 0;

    for (size_t c = 0; c < p->count; c++) {
        for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1] && rows_of(n, c) > 0; k++) {
            const size_t d = p->columns[k];
            const uint32_t from = n->place[c] < n->place[d] ? n->place[c] : n->place[d];
            const uint32_t far = n->place[c] + n->place[d] - 2 * from;
            apart = rows_of(n, d) > 0 && far > apart ? far : apart;
        }
    }
    return apart + 2;
}

/* What is known of the step goes to `step`, and -F - P E W step to x. Impulses that shall vanish do
 * so at once, not by the rounding of F / g at a time: they would become subnormal. */
static void fill_right(newton *n)
{
    const system_problem *p = n->problem;

    for (size_t c = 0; c < p->count; c++) {
        for (uint32_t k = 0; k < 3; k++)
            n->step[3 * c + k] = k < rows_of(n, c) ? 0.0 : -n->r[3 * c + k];
    }
    certificate_velocity(p, n->step, n->dv, n->moved);
    for (size_t c = 0; c < p->count; c++) {
        double known[3];
        double bent[3];
        for (size_t k = 0; k < 3; k++)
            known[k] = n->moved[3 * c + k] - p->q[3 * c + k];
        apply3(n->slope + 9 * c, known, bent);
        for (uint32_t k = 0; k < rows_of(n, c); k++)
            n->x[n->place[c] + k] = -n->right[3 * c + k] - bent[k];
    }
}

/* Entry (i, j) of own (c = d) + P E W_cd. */
static double block_entry(const newton *n, size_t c, const double *w, uint32_t diagonal, uint32_t i,
                          uint32_t j)
{
    const double *s = n->slope + 9 * c + 3 * (size_t)i;
    const double sum = s[0] * w[j] + s[1] * w[3 + j] + s[2] * w[6 + j];
    return diagonal != 0 ? sum + n->own[9 * c + 3 * (size_t)i + j] : sum;
}

static void fill_dense_blocks(newton *n)
{
    const system_problem *p = n->problem;
    const size_t stride = n->shape.stride;

    clear_dense(n);
    for (size_t c = 0; c < p->count; c++) {
        for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
            const size_t d = p->columns[k];
            for (uint32_t i = 0; i < rows_of(n, c); i++) {
                double *row = dense_entries(n) + (n->place[c] + i) * stride + n->place[d];
                for (uint32_t j = 0; j < rows_of(n, d); j++)
                    row[j] = block_entry(n, c, p->blocks + 9 * k, c == d, i, j);
            }
        }
    }
}

static void fill_sparse_blocks(newton *n)
{
    const system_problem *p = n->problem;
    uint32_t at = 0;
    uint32_t row = 0;

    for (size_t c = 0; c < p->count; c++) {
        for (uint32_t i = 0; i < rows_of(n, c); i++) {
            n->row_starts[row++] = at;
            for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
                const size_t d = p->columns[k];
                for (uint32_t j = 0; j < rows_of(n, d); j++) {
                    if (n->symmetric != 0 && n->place[d] + j >= row)
                        break;
                    n->columns[at] = n->place[d] + j;
                    n->values[at++] = block_entry(n, c, p->blocks + 9 * k, c == d, i, j);
                }
            }
        }
    }
    n->row_starts[row] = at;
}

/* Solve for the rows that fill_right left in x. */
static int solve_blocks(newton *n, uint32_t rows, newton_run *run)
{
    if (!substitute(n, rows, run))
        return 0;
    for (size_t c = 0; c < n->problem->count; c++) {
        for (uint32_t k = 0; k < rows_of(n, c); k++)
            n->step[3 * c + k] = n->x[n->place[c] + k];
    }
    return 1;
}

static int step_on_blocks(newton *n, newton_run *run)
{
    const uint32_t rows = number_rows(n, 1);

    choose_shape(n, rows, band_of_blocks(n), run);
    if (n->is_dense != 0) {
        fill_dense_blocks(n);
    } else {
        number_rows(n, 0);
        fill_sparse_blocks(n);
    }
    fill_right(n);
    return factor(n, rows, run) && solve_blocks(n, rows, run);
}

/* ---- Newton step in the bodies' velocities --------------------------------------------------- */

/* Lower triangle L with L L^T = the inverse inertia; a zero pivot gives a zero column: an axis that
 * cannot be turned. */
static void root_of(const double j[6], double l[6])
{
    const double p0 = j[0] > 0.0 ? sqrt(j[0]) : 0.0;
    const double i0 = p0 > 0.0 ? 1.0 / p0 : 0.0;
    l[0] = p0;
    l[1] = j[1] * i0;
    l[3] = j[2] * i0;
    const double d1 = j[3] - l[1] * l[1];
    const double p1 = d1 > 4.0 * TRIBO_EPS * j[3] ? sqrt(d1) : 0.0;
    l[2] = p1;
    l[4] = p1 > 0.0 ? (j[4] - l[3] * l[1]) / p1 : 0.0;
    const double d2 = j[5] - l[3] * l[3] - l[4] * l[4];
    l[5] = d2 > 4.0 * TRIBO_EPS * j[5] ? sqrt(d2) : 0.0;
}

/* One side of a contact: six columns of rows n, t1, t2. */
static void half_of(const newton *n, size_t c, uint32_t side, double *restrict half)
{
    const system_problem *p = n->problem;
    const uint32_t body = p->pairs[2 * c + side];
    const double sign = side == 0 ? 1.0 : -1.0;

    if (body == TRIBO_WORLD) {
        for (int i = 0; i < 18; i++)
            half[i / 6 * 12 + i % 6] = 0.0;
        return;
    }
    const double m = sign * sqrt(p->inverse_mass[body] / n->unit);
    const double *l = n->root + 6 * (size_t)body;
    for (int k = 0; k < 3; k++) {
        const double *f = p->frames + 9 * c + 3 * (size_t)k;
        const double *t = p->turns + 18 * c + 9 * (size_t)side + 3 * (size_t)k;
        double *row = half + 12 * k;
        row[0] = m * f[0];
        row[1] = m * f[1];
        row[2] = m * f[2];
        row[3] = sign * (t[0] * l[0] + t[1] * l[1] + t[2] * l[3]);
        row[4] = sign * (t[1] * l[2] + t[2] * l[4]);
        row[5] = sign * (t[2] * l[5]);
    }
}

/* Block rows of the graph of bodies, each row ascending, itself included. */
static void link_bodies(newton *n)
{
    const system_problem *p = n->problem;
    uint32_t *starts = n->starts;

    for (uint32_t i = 0; i < p->bodies + 2; i++)
        starts[i] = 0;
    for (size_t c = 0; c < p->count; c++) {
        const uint32_t a = p->pairs[2 * c];
        const uint32_t b = p->pairs[2 * c + 1];
        if (a != TRIBO_WORLD && b != TRIBO_WORLD) {
            starts[a + 2]++;
            starts[b + 2]++;
        }
    }
    for (uint32_t i = 0; i < p->bodies; i++)
        starts[i + 2] += starts[i + 1] + 1;
    for (uint32_t i = 0; i < p->bodies; i++)
        n->neighbours[starts[i + 1]++] = i;
    for (size_t c = 0; c < p->count; c++) {
        const uint32_t a = p->pairs[2 * c];
        const uint32_t b = p->pairs[2 * c + 1];
        if (a != TRIBO_WORLD && b != TRIBO_WORLD) {
            n->neighbours[starts[a + 1]++] = b;
            n->neighbours[starts[b + 1]++] = a;
        }
    }
}

/* Sort each row by insertion and drop what stands twice. */
static void tidy_links(newton *n)
{
    uint32_t kept = 0;

    for (uint32_t i = 0; i < n->problem->bodies; i++) {
        const uint32_t first = n->starts[i];
        const uint32_t end = n->starts[i + 1];
        const uint32_t begin = kept;
        for (uint32_t k = first; k < end; k++) {
            const uint32_t body = n->neighbours[k];
            uint32_t at = kept;
            while (at > begin && n->neighbours[at - 1] > body)
                at--;
            if (at > begin && n->neighbours[at - 1] == body)
                continue;
            for (uint32_t move = kept++; move > at; move--)
                n->neighbours[move] = n->neighbours[move - 1];
            n->neighbours[at] = body;
        }
        n->starts[i] = begin;
    }
    n->starts[n->problem->bodies] = kept;
}

static uint32_t slot_of(const newton *n, uint32_t row, uint32_t body)
{
    uint32_t low = n->starts[row];
    uint32_t high = n->starts[row + 1];

    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (n->neighbours[middle] <= body)
            low = middle;
        else
            high = middle;
    }
    return low - n->starts[row];
}

/* Where block (row, column) starts, and how far its rows are apart. */
static double *block_of(const newton *n, uint32_t row, uint32_t column, size_t *stride)
{
    if (n->is_dense != 0) {
        *stride = n->shape.stride;
        return dense_entries(n) + 6 * (n->rank[row] * *stride + n->rank[column]);
    }
    *stride = 6 * (size_t)(n->starts[row + 1] - n->starts[row]);
    return n->values + 36 * (size_t)n->starts[row] + 6 * (size_t)slot_of(n, row, column);
}

/* The rows of scalars of the graph of bodies, and those of its lower triangle. */
static void spread_rows(newton *n)
{
    const uint32_t rows = 6 * n->problem->bodies;
    uint32_t at = 0;

    for (uint32_t row = 0; row < rows; row++) {
        n->row_starts[row] = at;
        for (uint32_t b = n->starts[row / 6]; b < n->starts[row / 6 + 1]; b++) {
            for (uint32_t j = 0; j < 6; j++)
                n->columns[at++] = 6 * n->neighbours[b] + j;
        }
    }
    n->row_starts[rows] = at;
    at = 0;
    for (uint32_t row = 0; row < rows; row++) {
        n->lower_starts[row] = at;
        for (uint32_t k = n->row_starts[row]; n->columns[k] < row; k++)
            n->lower_columns[at++] = n->columns[k];
        n->lower_columns[at++] = row;
    }
    n->lower_starts[rows] = at;
}

static void copy_lower(newton *n)
{
    for (uint32_t row = 0; row < 6 * n->problem->bodies; row++) {
        const double *from = n->values + n->row_starts[row];
        double *to = n->lower_values + n->lower_starts[row];
        const uint32_t count = n->lower_starts[row + 1] - n->lower_starts[row];
        for (uint32_t k = 0; k < count; k++)
            to[k] = from[k];
    }
}

/* x = A^-1 b for 3x3 by Cramer's rule; 0 if A is singular. */
static int invert3(const double a[9], double out[9])
{
    const double c0 = a[4] * a[8] - a[5] * a[7];
    const double c1 = a[5] * a[6] - a[3] * a[8];
    const double c2 = a[3] * a[7] - a[4] * a[6];
    const double det = a[0] * c0 + a[1] * c1 + a[2] * c2;
    const double inverse = 1.0 / det;

    if (!(absolute(inverse) <= TRIBO_LARGE))
        return 0;
    out[0] = c0 * inverse;
    out[1] = (a[2] * a[7] - a[1] * a[8]) * inverse;
    out[2] = (a[1] * a[5] - a[2] * a[4]) * inverse;
    out[3] = c1 * inverse;
    out[4] = (a[0] * a[8] - a[2] * a[6]) * inverse;
    out[5] = (a[2] * a[3] - a[0] * a[5]) * inverse;
    out[6] = c2 * inverse;
    out[7] = (a[1] * a[6] - a[0] * a[7]) * inverse;
    out[8] = (a[0] * a[4] - a[1] * a[3]) * inverse;
    return 1;
}

/* What contacts of one pair of bodies, one after the other, bring to the matrix. */
typedef struct couple {
    const uint32_t *pair; /* null: nothing yet */
    double sum[144];
} couple;

static void clear_couple(couple *of, const uint32_t *pair)
{
    of->pair = pair;
    for (int i = 0; i < 144; i++)
        of->sum[i] = 0.0;
}

/* Add what is there to the matrix. */
static void give_couple(newton *n, const couple *of)
{
    for (size_t i = 0; of->pair != NULL && i < 2; i++) {
        for (size_t j = 0; j < 2; j++) {
            size_t stride;
            if (of->pair[i] == TRIBO_WORLD || of->pair[j] == TRIBO_WORLD)
                continue;
            double *block = block_of(n, of->pair[i], of->pair[j], &stride);
            for (size_t k = 0; k < 6; k++) {
                const double *restrict from = of->sum + 72 * i + 6 * j + 12 * k;
                double *restrict to = block + k * stride;
                for (size_t l = 0; l < 6; l++)
                    to[l] += from[l];
            }
        }
    }
}

/* The matrix of the bodies of contact c, += H_c^T D H_d; contact d has the same bodies. */
static void add_blocks(newton *n, couple *of, size_t c, size_t d_at, const double d[9])
{
    const uint32_t *pair = n->problem->pairs + 2 * c;

    if (of->pair == NULL || of->pair[0] != pair[0] || of->pair[1] != pair[1]) {
        give_couple(n, of);
        clear_couple(of, pair);
    }
    n->kernels->add_product(n->half + 36 * c, d, n->half + 36 * d_at, of->sum);
}

/* The step of a torque is -known - D du + lag dr_n, with lag = A^-1 lead and dr_n by the step of
 * the contact before it: a part of that is known, the other couples the two. */
static void follow_normal(newton *n, couple *of, size_t c, const double inverse[9], double known[3])
{
    const double *before = n->slope + 9 * (c - 1);
    double *lag = n->lead + 3 * c;
    double lead[3] = {lag[0], lag[1], lag[2]};
    double across[9];

    apply3(inverse, lead, lag);
    for (int i = 0; i < 3; i++) {
        known[i] += lag[i] * known[-3];
        for (int k = 0; k < 3; k++)
            across[3 * i + k] = n->unit * (lag[i] * before[k]);
    }
    if (n->mode[c] == SLIP)
        add_blocks(n, of, c, c - 1, across);
}

static void clear_matrix(newton *n)
{
    const uint32_t bodies = n->problem->bodies;

    if (n->is_dense != 0) {
        clear_dense(n);
    } else {
        for (size_t i = 0; i < 36 * (size_t)n->starts[bodies]; i++)
            n->values[i] = 0.0;
    }
    for (uint32_t i = 0; i < bodies; i++) {
        size_t stride;
        double *block = block_of(n, i, i, &stride);
        for (size_t k = 0; k < 6; k++)
            block[k * stride + k] = 1.0;
    }
    for (uint32_t i = 0; i < 6 * bodies; i++)
        n->x[i] = 0.0;
}

/* slope = D = A^-1 P E, step = A^-1 F. An open contact has P = 0, A = g, F = g r, and so has its
 * torque: such impulses vanish at once, as in number_rows. */
static int reduce_contact(newton *n, couple *of, size_t c)
{
    const int turns = resist_is_torque(n->problem, c);
    double *slope = n->slope + 9 * c;
    double *known = n->step + 3 * c;
    double inverse[9];
    double d[9];

    if (n->mode[turns ? c - 1 : c] == OPEN) {
        copy(3, n->r + 3 * c, known);
        for (int i = 0; i < 9; i++)
            slope[i] = 0.0;
        return 1;
    }
    if (!invert3(n->own + 9 * c, inverse))
        return 0;
    for (int i = 0; i < 9; i++) {
        const double *row = inverse + i / 3 * 3;
        const double *column = slope + i % 3;
        d[i] = row[0] * column[0] + row[1] * column[3] + row[2] * column[6];
    }
    copy(9, d, slope);
    apply3(inverse, n->right + 3 * c, known);
    if (turns)
        follow_normal(n, of, c, inverse, known);
    return 1;
}

/* x -= H^T of what is known of the step of contact c. */
static void load_contact(newton *n, size_t c)
{
    const double *known = n->step + 3 * c;

    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t body = n->problem->pairs[2 * c + side];
        const double *h = n->half + 36 * c + 6 * (size_t)side;
        if (body == TRIBO_WORLD)
            continue;
        double *x = n->x + 6 * (size_t)n->rank[body];
        for (size_t j = 0; j < 6; j++)
            x[j] -= n->unit * (h[j] * known[0] + h[12 + j] * known[1] + h[24 + j] * known[2]);
    }
}

static int fill_bodies(newton *n)
{
    couple of;

    clear_matrix(n);
    clear_couple(&of, NULL);
    for (size_t c = 0; c < n->problem->count; c++) {
        const double *known = n->step + 3 * c;
        double d[9];
        if (!reduce_contact(n, &of, c))
            return 0;
        for (size_t i = 0; i < 9; i++)
            d[i] = n->unit * n->slope[9 * c + i];
        if (n->mode[c] == OPEN && known[0] == 0.0 && known[1] == 0.0 && known[2] == 0.0)
            continue;
        load_contact(n, c);
        if (n->mode[c] != OPEN)
            add_blocks(n, &of, c, c, d);
    }
    give_couple(n, &of);
    if (n->symmetric != 0 && n->is_dense == 0)
        copy_lower(n);
    return 1;
}

/* Change of velocity of contact c by x. */
static void move_contact(const newton *n, size_t c, double moved[3])
{
    moved[0] = moved[1] = moved[2] = 0.0;
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t body = n->problem->pairs[2 * c + side];
        const double *h = n->half + 36 * c + 6 * (size_t)side;
        if (body == TRIBO_WORLD)
            continue;
        const double *x = n->x + 6 * (size_t)n->rank[body];
        for (size_t j = 0; j < 6; j++) {
            moved[0] += h[j] * x[j];
            moved[1] += h[12 + j] * x[j];
            moved[2] += h[24 + j] * x[j];
        }
    }
}

/* Solve for x, and dr = -A^-1 F - D H x; H x goes to `moved`. */
static int solve_bodies(newton *n, newton_run *run)
{
    const system_problem *p = n->problem;
    double normal_change = 0.0;

    if (!substitute(n, 6 * p->bodies, run))
        return 0;
    for (size_t c = 0; c < p->count; c++) {
        double *moved = n->moved + 3 * c;
        double change[3];
        move_contact(n, c, moved);
        apply3(n->slope + 9 * c, moved, change);
        if (resist_is_torque(p, c)) {
            for (size_t k = 0; k < 3; k++)
                change[k] += n->lead[3 * c + k] * normal_change;
        }
        normal_change = change[0];
        for (size_t k = 0; k < 3; k++)
            n->step[3 * c + k] = -n->step[3 * c + k] - change[k];
    }
    return 1;
}

/* (1 + H^T D H) x = -H^T A^-1 F, H = J M^-1/2, D = A^-1 P E; then dr = -A^-1 F - D H x. Masses are
 * divided by a power of two, so that the root of an odd one is the same for all: x / unit. */
static int step_on_bodies(newton *n, newton_run *run)
{
    const uint32_t rows = 6 * n->problem->bodies;

    return fill_bodies(n) && factor(n, rows, run) && solve_bodies(n, run);
}

/* ---- order of bodies ------------------------------------------------------------------------- */

/* Breadth-first levels of a graph from `first`: marks nodes, and returns the operations of
 * elimination level by level, each node having `rows` rows. `last` receives a node of the last
 * level. */
static double eliminate_levels(uint32_t nodes, const uint32_t *starts, const uint32_t *neighbours,
                               uint32_t first, double rows, uint32_t *queue, uint32_t *mark,
                               uint32_t *last)
{
    uint32_t begin = 0;
    uint32_t end = 1;
    double before = 0.0;
    double sum = 0.0;

    for (uint32_t i = 0; i < nodes; i++)
        mark[i] = 0;
    queue[0] = first;
    mark[first] = 1;
    while (begin < end) {
        const double width = rows * (double)(end - begin);
        const uint32_t level_end = end;
        sum += width * (width + before) * (width + before);
        before = width;
        *last = queue[begin];
        for (; begin < level_end; begin++) {
            const uint32_t node = queue[begin];
            for (uint32_t k = starts[node]; k < starts[node + 1]; k++) {
                if (mark[neighbours[k]] == 0) {
                    mark[neighbours[k]] = 1;
                    queue[end++] = neighbours[k];
                }
            }
        }
    }
    return sum;
}

/* From one end of the graph to the other the levels are thinnest. scratch: two for each node; the
 * first are the nodes level by level. */
static double sparse_operations(uint32_t nodes, const uint32_t *starts, const uint32_t *neighbours,
                                double rows, uint32_t *scratch)
{
    uint32_t last = 0;
    uint32_t unused;

    eliminate_levels(nodes, starts, neighbours, 0, rows, scratch, scratch + nodes, &last);
    return eliminate_levels(nodes, starts, neighbours, last, rows, scratch, scratch + nodes,
                            &unused);
}

/* Rank the bodies as they stand in `order`. Returns the band of the matrix. */
static uint32_t rank_bodies(newton *n, const uint32_t *order)
{
    uint32_t apart = 0;

    for (uint32_t i = 0; i < n->problem->bodies; i++)
        n->rank[order[i]] = i;
    for (uint32_t i = 0; i < n->problem->bodies; i++) {
        for (uint32_t k = n->starts[i]; k < n->starts[i + 1]; k++) {
            const uint32_t other = n->rank[n->neighbours[k]];
            apart = other > n->rank[i] + apart ? other - n->rank[i] : apart;
        }
    }
    return 6 * apart + 5;
}

/* Link the bodies and see whether they are to be ranked level by level (Cuthill & McKee, Proc. 24th
 * ACM Conf. (1969) 157) for a narrow matrix. Returns the operations of its elimination. */
static double order_bodies(newton *n, const newton_run *run)
{
    const uint32_t bodies = n->problem->bodies;

    link_bodies(n);
    tidy_links(n);
    const double operations = sparse_operations(bodies, n->starts, n->neighbours, 6.0, n->place);
    choose_shape(n, 6 * bodies, rank_bodies(n, n->place), run);
    if (n->is_dense != 0)
        return dense_operations(&n->shape);
    for (uint32_t i = 0; i < bodies; i++)
        n->rank[i] = i;
    return operations;
}

/* The same for contacts and the blocks of W, where all are closed. Nodes that no level holds, as W
 * may be one-sided, come last. */
static double order_contacts(newton *n, const newton_run *run)
{
    const system_problem *p = n->problem;
    uint32_t *order = n->place;
    const uint32_t *mark = n->place + p->count;
    uint32_t reached = 0;

    const double operations = sparse_operations(p->count, p->row_starts, p->columns, 3.0, n->place);
    for (uint32_t c = 0; c < p->count; c++)
        reached += mark[c];
    for (uint32_t c = 0; c < p->count; c++) {
        if (mark[c] == 0)
            order[reached++] = c;
    }
    for (uint32_t i = 0; i < p->count; i++)
        n->rank[i] = order[i];
    for (uint32_t i = 0; i < p->count; i++)
        n->place[n->rank[i]] = 3 * i;
    for (uint32_t c = 0; c < p->count; c++)
        n->mode[c] = STICK;
    choose_shape(n, 3 * p->count, band_of_blocks(n), run);
    return n->is_dense != 0 ? dense_operations(&n->shape) : CLIQUE_SHARE * operations;
}

static void prepare_bodies(newton *n)
{
    const system_problem *p = n->problem;

    for (size_t i = 0; i < p->bodies; i++) {
        double scaled[6];
        for (size_t k = 0; k < 6; k++)
            scaled[k] = p->inverse_inertia[6 * i + k] / n->unit;
        root_of(scaled, n->root + 6 * i);
    }
    for (size_t c = 0; c < p->count; c++) {
        half_of(n, c, 0, n->half + 36 * c);
        half_of(n, c, 1, n->half + 36 * c + 6);
    }
    if (n->is_dense == 0)
        spread_rows(n);
}

/* ---- steps ----------------------------------------------------------------------------------- */

void step_prepare(newton *n, const newton_run *run)
{
    n->kernels = dense_table_of(run->isa);
    if (n->problem->bodies != 0)
        prepare_bodies(n);
}

int step_solve(newton *n, newton_run *run)
{
    return n->problem->bodies != 0 ? step_on_bodies(n, run) : step_on_blocks(n, run);
}

int step_again(newton *n, newton_run *run)
{
    const system_problem *p = n->problem;

    if (p->bodies == 0) {
        fill_right(n);
        return solve_blocks(n, n->shape.n, run);
    }
    copy(3 * (size_t)p->count, n->right, n->step);
    for (size_t i = 0; i < 6 * (size_t)p->bodies; i++)
        n->x[i] = 0.0;
    for (size_t c = 0; c < p->count; c++)
        load_contact(n, c);
    return solve_bodies(n, run);
}

/* What rounding left of the equations of contact c. Bodies: W dr - H x. */
static void leave(const newton *n, size_t c, double off[3])
{
    double du[3];
    double own[3];

    for (size_t k = 0; k < 3; k++)
        du[k] = n->next_u[3 * c + k] - n->u[3 * c + k];
    if (n->problem->bodies != 0) {
        for (size_t k = 0; k < 3; k++)
            off[k] = du[k] - n->moved[3 * c + k];
        return;
    }
    apply3(n->slope + 9 * c, du, off);
    apply3(n->own + 9 * c, n->step + 3 * c, own);
    for (size_t k = 0; k < 3; k++)
        off[k] += own[k] + n->right[3 * c + k];
}

double step_error(const newton *n)
{
    double sum = 0.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        double off[3];
        if (n->mode[c] == OPEN)
            continue;
        leave(n, c, off);
        sum += off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
    }
    return sqrt(sum);
}

/* Rows exchanged and negative pivots, each changing it. */
static int turn_of_dense(const newton *n)
{
    const double *a = dense_entries(n);
    int turn = 1;

    for (size_t i = 0; i < n->shape.n; i++) {
        turn = n->pivots[i] != i ? -turn : turn;
        turn = a[i * (n->shape.stride + 1)] < 0.0 ? -turn : turn;
    }
    return turn;
}

int step_turn(const newton *n, newton_run *run)
{
    int32_t turn = 0;

    if (n->symmetric != 0)
        return 1;
    if (n->is_dense != 0)
        return turn_of_dense(n);
    if (run->linear.sign == NULL)
        return 0;
    return note_status(run->linear.sign(run->linear.context, &turn), run) ? turn : 0;
}

/* ---- price ----------------------------------------------------------------------------------- */

static uint32_t count_torques(const system_problem *p)
{
    uint32_t count = 0;

    for (size_t c = 0; p->lengths != NULL && c < p->count; c++)
        count += resist_is_torque(p, c) ? 1 : 0;
    return count;
}

double newton_price(newton *n, const system_problem *problem, const newton_run *run)
{
    double sweep = SWEEP_OPERATIONS * (double)problem->count;

    n->problem = problem;
    if (problem->bodies == 0)
        sweep += BLOCK_OPERATIONS * (double)problem->row_starts[problem->count];
    const double operations = problem->bodies != 0 ? order_bodies(n, run) : order_contacts(n, run);
    const double price = STEP_SWEEPS + operations / sweep;
    return price * (sweep / (sweep + TORQUE_OPERATIONS * (double)count_torques(problem)));
}
