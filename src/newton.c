#include "newton.h"

#include "dense.h"
#include "resist.h"

/* One setting for all problems. */
#define FIRST_ALPHA 1e-2 /* of the mean |W_cc| */
#define LEAST_ALPHA 1e-14
#define FAST_FALL 10.0 /* of alpha, after QUICKEST steps or fewer, until Newton fails once */
#define SLOW_FALL 3.0  /* after fewer than QUICK steps */
#define RISE 5.0       /* where Newton fails */
#define QUICKEST 2
#define QUICK 10
#define INNER_STEPS 30
#define INNER_SHARE 1e-1  /* of the outer residual: where a proximal step is solved */
#define MEMORY 5          /* residuals that a step may not exceed */
#define LEAST_LENGTH 1e-3 /* of a Newton step */
#define SHORT_SHARE 0.1
#define SHORT_STEPS 3
#define LEAST_SWEEPS 8
#define MOST_SWEEPS 64
/* A step without its elimination takes as long as so many sweeps; a contact of a sweep as long as so
 * many operations of elimination, which is some times faster on dense matrices. */
#define STEP_SWEEPS 32.0
#define SWEEP_OPERATIONS 150.0
#define BLOCK_OPERATIONS 30.0     /* of a block of W that is summed */
#define TORQUE_OPERATIONS 18000.0 /* of a contact with a torque, which no lanes solve */
#define DENSE_SHARE 0.2
#define CLIQUE_SHARE 0.15 /* contacts of one body are all linked: fewer, larger blocks */
#define SYMMETRY 1e-12
#define PATIENCE 1500 /* Newton steps that bring nothing */
/* Two proximal steps that bring nothing, where eta is as small as what rounding of impulses that
 * work against each other does to it, in units of their growth and at most. */
#define FLOOR_PATIENCE (2 * INNER_STEPS)
#define FLOOR_GROWTH (64.0 * TRIBO_EPS)
#define FLOOR_MOST (65536.0 * TRIBO_EPS)

struct newton {
    const system_problem *problem;
    const goal *wanted;
    double size;  /* mean |W_cc| */
    double fall;  /* of alpha */
    double outer; /* |F| without the proximal term, and the distance from the goal */
    double distance;
    uint64_t won;      /* step that brought something last */
    uint64_t renewed;  /* step that found the best impulses so far */
    uint32_t on_floor; /* 1: eta is down at rounding, and falls no further */
    double alpha;
    verdict reached; /* by the best impulses */
    uint32_t sweeps; /* of the next smoothing */
    double unit;     /* bodies: power of two near the greatest W_cc */

    double *r, *center, *u, *f;       /* where we are: 3 per contact */
    double *next_r, *next_u, *next_f; /* where a step would lead */
    double *step, *moved, *best;      /* dr, a scratch, and the best impulses */
    double *right;                    /* F, without E where a contact sticks */
    double *gain;                     /* g_c */
    double *lead;        /* of torques, 3 per contact: what the normal impulse does to F */
    double *dv;          /* 6 per body */
    double *slope, *own; /* P E and A = g (1 - P) + alpha P E: 9 per contact */
    uint8_t *mode, *next_mode;

    double *half;    /* bodies: J (unit M)^-1/2, 36 per contact: unit W = half half^T */
    double *root;    /* bodies: (unit M)^-1/2 of inertia, lower triangle, 6 per body */
    uint32_t *place; /* bodies: where the blocks aa, ab, ba, bb start; assembled: first row */
    uint32_t *starts, *neighbours; /* bodies: block rows */

    uint32_t *row_starts, *columns; /* the matrix: rows of scalars, or dense */
    double *values, *x, *dense;
    uint32_t *pivots;
    uint32_t *lower_starts, *lower_columns; /* bodies: its lower triangle, if it is symmetric */
    double *lower_values;
    uint32_t symmetric_w; /* 1: W is symmetric but for rounding */
    uint32_t symmetric;   /* 1: so is the matrix of this step */
};

/* ---- memory ---------------------------------------------------------------------------------- */

static uint32_t unknowns(uint32_t count, uint32_t bodies)
{
    return bodies != 0 ? 6 * bodies : 3 * count;
}

uint32_t newton_possible(uint32_t count, uint32_t bodies, const newton_run *run)
{
    return run->linear != NULL || unknowns(count, bodies) <= run->dense_limit;
}

static double *numbers(arena *a, size_t count)
{
    return arena_take(a, count, sizeof(double));
}

static void take_state(newton *n, arena *a, size_t count, uint32_t bodies, uint32_t torques)
{
    double **each[] = {&n->r,      &n->center, &n->u,     &n->f,    &n->next_r, &n->next_u,
                       &n->next_f, &n->step,   &n->moved, &n->best, &n->right};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        *each[i] = numbers(a, 3 * count);
    n->gain = numbers(a, count);
    n->dv = numbers(a, 6 * (size_t)bodies);
    n->slope = numbers(a, 9 * count);
    n->own = numbers(a, 9 * count);
    n->lead = torques != 0 ? numbers(a, 3 * count) : NULL;
    n->mode = arena_take(a, count, 1);
    n->next_mode = arena_take(a, count, 1);
    n->place = arena_take(a, 4 * count + 1, sizeof(uint32_t));
}

static void take_matrix(newton *n, arena *a, uint32_t rows, size_t entries, const newton_run *run)
{
    const uint32_t small = rows < run->dense_limit ? rows : run->dense_limit;

    n->x = numbers(a, rows);
    n->dense = numbers(a, small * dense_stride(small));
    n->pivots = arena_take(a, small, sizeof(uint32_t));
    if (run->linear == NULL || rows <= small)
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

newton *newton_take(arena *a, uint32_t count, uint32_t bodies, uint32_t torques, size_t links,
                    const newton_run *run)
{
    newton counted = {0};
    newton *taken = arena_take(a, 1, sizeof *taken);
    newton *n = taken != NULL ? taken : &counted;

    *n = counted;
    take_state(n, a, count, bodies, torques);
    if (bodies != 0) {
        n->half = numbers(a, 36 * (size_t)count);
        n->root = numbers(a, 6 * (size_t)bodies);
        n->starts = arena_take(a, (size_t)bodies + 2, sizeof(uint32_t));
        n->neighbours = arena_take(a, links + bodies, sizeof(uint32_t));
        take_matrix(n, a, 6 * bodies, 36 * (links + bodies), run);
        take_lower(n, a, 6 * bodies, 18 * links + 21 * (size_t)bodies);
    } else {
        take_matrix(n, a, 3 * count, 9 * links, run);
    }
    return taken;
}

/* ---- natural map ----------------------------------------------------------------------------- */

static void copy(size_t count, const double *from, double *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

static double coefficient(const newton *n, size_t c)
{
    return n->problem->mu[2 * c];
}

/* F of one contact; `bent` receives u + alpha (r - center). */
static uint32_t map_contact(const newton *n, size_t c, const double *r, const double *u, double *f,
                            double bent[3], double y[3])
{
    for (size_t k = 0; k < 3; k++)
        bent[k] = u[k] + n->alpha * (r[k] - n->center[3 * c + k]);
    return natural_map(n->gain[c], coefficient(n, c), r, bent, f, y);
}

/* The same of a torque; f holds that of its contact before. */
static uint32_t map_torque(const newton *n, size_t c, const double *r, const double *u, double *f,
                           double limits[2], double y[3])
{
    const double normal = resist_normal(n->gain[c - 1], r[-3], f[-3]);
    double bent[3];

    for (size_t k = 0; k < 3; k++)
        bent[k] = u[k] + n->alpha * (r[k] - n->center[3 * c + k]);
    resist_limits(n->problem, c, n->gain[c] * normal, limits);
    return resist_map(n->gain[c], limits, r, bent, f, y);
}

static double map_all(newton *n, const double *r, const double *u, double *f, uint8_t *mode)
{
    double sum = 0.0;

    for (size_t c = 0; c < n->problem->count; c++) {
        double unused[3];
        double y[3];
        double *own = f + 3 * c;
        mode[c] = (uint8_t)(resist_is_torque(n->problem, c)
                                ? map_torque(n, c, r + 3 * c, u + 3 * c, own, unused, y)
                                : map_contact(n, c, r + 3 * c, u + 3 * c, own, unused, y));
        sum += own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
    }
    return sqrt(sum);
}

static void linearize_contact(newton *n, size_t c)
{
    double unused[3];
    double bent[3];
    double y[3];

    const uint32_t mode = map_contact(n, c, n->r + 3 * c, n->u + 3 * c, unused, bent, y);
    natural_linearize(mode, n->gain[c], n->alpha, coefficient(n, c), bent, y, n->f + 3 * c,
                      n->slope + 9 * c, n->own + 9 * c, n->right + 3 * c);
}

/* The same of a torque, but for what the normal impulse does to it: `lead` is kept for
 * follow_normal, and F of the contact is in what is on the right already. */
static void linearize_torque(newton *n, size_t c)
{
    const double *f = n->f + 3 * c;
    double *lead = n->lead + 3 * c;
    double held[6] = {f[-3], f[-2], f[-1], 0.0, 0.0, 0.0};
    double lengths[2];
    double limits[2];
    double y[3];

    map_torque(n, c, n->r + 3 * c, n->u + 3 * c, held + 3, limits, y);
    resist_limits(n->problem, c, 1.0, lengths);
    resist_linearize(n->gain[c], n->alpha, limits, lengths, y, n->slope + 9 * c, n->own + 9 * c,
                     lead);
    for (size_t k = 0; k < 3; k++)
        n->right[3 * c + k] = f[k] - lead[k] * (f[-3] / n->gain[c - 1]);
}

static void linearize(newton *n)
{
    n->symmetric = n->symmetric_w;
    for (size_t c = 0; c < n->problem->count; c++) {
        if (resist_is_torque(n->problem, c)) {
            linearize_torque(n, c);
            n->symmetric = n->mode[c] == SLIP ? 0 : n->symmetric;
            continue;
        }
        linearize_contact(n, c);
        if (n->mode[c] == SLIP && coefficient(n, c) > 0.0)
            n->symmetric = 0;
    }
}

static void apply3(const double a[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2];
}

/* ---- factorisation --------------------------------------------------------------------------- */

static uint32_t is_dense(uint32_t rows, const newton_run *run)
{
    return rows <= run->dense_limit;
}

static int eliminate_dense(newton *n, uint32_t rows, const newton_run *run)
{
    if (n->symmetric != 0) {
        if (!dense_cholesky(run->isa, rows, n->dense))
            return 0;
        dense_cholesky_solve(run->isa, rows, n->dense, n->x);
        return 1;
    }
    if (!dense_lu(run->isa, rows, n->dense, n->pivots))
        return 0;
    dense_lu_solve(run->isa, rows, n->dense, n->pivots, n->x);
    return 1;
}

/* Solve for x in place: the matrix stands in `dense` or in rows of scalars. */
static int eliminate(newton *n, uint32_t rows, newton_run *run)
{
    const tribo_linear *linear = run->linear;
    const uint32_t lower = n->symmetric != 0 && n->problem->bodies != 0;
    tribo_status status;

    if (rows == 0)
        return 1;
    run->factorizations++;
    if (is_dense(rows, run))
        return eliminate_dense(n, rows, run);
    status = lower != 0 ? linear->factor(linear->context, rows, n->lower_starts, n->lower_columns,
                                         n->lower_values, 1)
                        : linear->factor(linear->context, rows, n->row_starts, n->columns,
                                         n->values, n->symmetric);
    if (status == TRIBO_OK)
        status = linear->solve(linear->context, n->x);
    if (status != TRIBO_OK && status != TRIBO_ERROR_CONTACT_MATRIX)
        run->status = status;
    return status == TRIBO_OK;
}

/* ---- Newton step on blocks of W -------------------------------------------------------------- */

/* Rows that a contact has in the matrix: none if it is open, the normal alone without friction. */
static uint32_t rows_of(const newton *n, size_t c)
{
    return n->mode[c] == OPEN ? 0u : coefficient(n, c) > 0.0 ? 3u : 1u;
}

/* Number the unknowns; what is known of the step goes to `step`, and -F - P E W step to x. Impulses
 * that shall vanish do so at once, not by the rounding of F / g at a time: they would become subnormal.
 */
static uint32_t number_rows(newton *n)
{
    const system_problem *p = n->problem;
    uint32_t rows = 0;

    for (size_t c = 0; c < p->count; c++) {
        n->place[c] = rows;
        rows += rows_of(n, c);
        for (uint32_t k = 0; k < 3; k++)
            n->step[3 * c + k] = k < rows_of(n, c) ? 0.0 : -n->r[3 * c + k];
    }
    n->place[p->count] = rows;
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
    return rows;
}

/* Entry (i, j) of own (c = d) + P E W_cd. */
static double block_entry(const newton *n, size_t c, const double *w, uint32_t diagonal, uint32_t i,
                          uint32_t j)
{
    const double *s = n->slope + 9 * c + 3 * (size_t)i;
    const double sum = s[0] * w[j] + s[1] * w[3 + j] + s[2] * w[6 + j];
    return diagonal != 0 ? sum + n->own[9 * c + 3 * (size_t)i + j] : sum;
}

static void fill_dense_blocks(newton *n, uint32_t rows)
{
    const system_problem *p = n->problem;
    const size_t stride = dense_stride(rows);

    for (size_t i = 0; i < rows * stride; i++)
        n->dense[i] = 0.0;
    for (size_t c = 0; c < p->count; c++) {
        for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
            const size_t d = p->columns[k];
            for (uint32_t i = 0; i < rows_of(n, c); i++) {
                double *row = n->dense + (n->place[c] + i) * stride + n->place[d];
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

static int step_on_blocks(newton *n, newton_run *run)
{
    const uint32_t rows = number_rows(n);

    if (is_dense(rows, run))
        fill_dense_blocks(n, rows);
    else
        fill_sparse_blocks(n);
    if (!eliminate(n, rows, run))
        return 0;
    for (size_t c = 0; c < n->problem->count; c++) {
        for (uint32_t k = 0; k < rows_of(n, c); k++)
            n->step[3 * c + k] = n->x[n->place[c] + k];
    }
    return 1;
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

/* One side of a contact: 3 x 6, rows n, t1, t2. */
static void half_of(const newton *n, size_t c, uint32_t side, double half[18])
{
    const system_problem *p = n->problem;
    const uint32_t body = p->pairs[2 * c + side];
    const double sign = side == 0 ? 1.0 : -1.0;

    for (int i = 0; i < 18; i++)
        half[i] = 0.0;
    if (body == TRIBO_WORLD)
        return;
    const double m = sign * sqrt(p->inverse_mass[body] / n->unit);
    const double *l = n->root + 6 * (size_t)body;
    for (int k = 0; k < 3; k++) {
        const double *f = p->frames + 9 * c + 3 * (size_t)k;
        const double *t = p->turns + 18 * c + 9 * (size_t)side + 3 * (size_t)k;
        double *row = half + 6 * k;
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
static double *block_of(const newton *n, uint32_t dense, uint32_t row, uint32_t column,
                        size_t *stride)
{
    if (dense != 0) {
        *stride = dense_stride(6 * n->problem->bodies);
        return n->dense + 6 * (size_t)row * *stride + 6 * (size_t)column;
    }
    *stride = 6 * (size_t)(n->starts[row + 1] - n->starts[row]);
    return n->values + 36 * (size_t)n->starts[row] + 6 * (size_t)slot_of(n, row, column);
}

static void prepare_bodies(newton *n, uint32_t dense)
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
        half_of(n, c, 1, n->half + 36 * c + 18);
    }
    if (dense != 0)
        return;
    link_bodies(n);
    tidy_links(n);
    uint32_t at = 0;
    for (uint32_t i = 0; i < p->bodies; i++) {
        for (uint32_t k = 0; k < 6; k++) {
            n->row_starts[6 * i + k] = at;
            for (uint32_t b = n->starts[i]; b < n->starts[i + 1]; b++) {
                for (uint32_t j = 0; j < 6; j++)
                    n->columns[at++] = 6 * n->neighbours[b] + j;
            }
        }
    }
    n->row_starts[6 * p->bodies] = at;
    at = 0;
    for (uint32_t row = 0; row < 6 * p->bodies; row++) {
        n->lower_starts[row] = at;
        for (uint32_t k = n->row_starts[row]; n->columns[k] < row; k++)
            n->lower_columns[at++] = n->columns[k];
        n->lower_columns[at++] = row;
    }
    n->lower_starts[6 * p->bodies] = at;
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

/* block += L^T D R, L and R 3 x 6. */
static void add_product(const double *left, const double d[9], const double *right, double *block,
                        size_t stride)
{
    double s[18];

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 6; j++)
            s[6 * i + j] =
                d[3 * i] * right[j] + d[3 * i + 1] * right[6 + j] + d[3 * i + 2] * right[12 + j];
    }
    for (int i = 0; i < 6; i++) {
        double *row = block + (size_t)i * stride;
        for (int j = 0; j < 6; j++)
            row[j] += left[i] * s[j] + left[6 + i] * s[6 + j] + left[12 + i] * s[12 + j];
    }
}

/* The matrix of the bodies of contact c, += H_c^T D H_d; contact d has the same bodies. */
static void add_blocks(newton *n, uint32_t dense, size_t c, size_t d_at, const double d[9])
{
    const double *half = n->half + 36 * c;
    const double *other = n->half + 36 * d_at;
    const uint32_t *pair = n->problem->pairs + 2 * c;

    for (uint32_t i = 0; i < 2; i++) {
        for (uint32_t j = 0; j < 2; j++) {
            size_t stride;
            if (pair[i] == TRIBO_WORLD || pair[j] == TRIBO_WORLD)
                continue;
            double *block = block_of(n, dense, pair[i], pair[j], &stride);
            add_product(half + 18 * (size_t)i, d, other + 18 * (size_t)j, block, stride);
        }
    }
}

/* The step of a torque is -known - D du + lag dr_n, with lag = A^-1 lead and dr_n by the step of
 * the contact before it: a part of that is known, the other couples the two. */
static void follow_normal(newton *n, uint32_t dense, size_t c, const double inverse[9],
                          double known[3])
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
        add_blocks(n, dense, c, c - 1, across);
}

static void clear_matrix(newton *n, uint32_t dense)
{
    const system_problem *p = n->problem;
    const uint32_t rows = 6 * p->bodies;
    const size_t size = dense != 0 ? rows * dense_stride(rows) : 36 * (size_t)n->starts[p->bodies];
    double *values = dense != 0 ? n->dense : n->values;

    for (size_t i = 0; i < size; i++)
        values[i] = 0.0;
    for (uint32_t i = 0; i < p->bodies; i++) {
        size_t stride;
        double *block = block_of(n, dense, i, i, &stride);
        for (size_t k = 0; k < 6; k++)
            block[k * stride + k] = 1.0;
    }
    for (uint32_t i = 0; i < rows; i++)
        n->x[i] = 0.0;
}

/* slope = D = A^-1 P E, step = A^-1 F. An open contact has P = 0, A = g, F = g r, and so has its
 * torque: such impulses vanish at once, as in number_rows. */
static int reduce_contact(newton *n, uint32_t dense, size_t c)
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
        follow_normal(n, dense, c, inverse, known);
    return 1;
}

/* (1 + H^T D H) x = -H^T A^-1 F, H = J M^-1/2, D = A^-1 P E; then dr = -A^-1 F - D H x. Masses are
 * divided by a power of two, so that the root of an odd one is the same for all: x / unit. */
static int step_on_bodies(newton *n, newton_run *run)
{
    const system_problem *p = n->problem;
    const uint32_t rows = 6 * p->bodies;
    const uint32_t dense = is_dense(rows, run);

    clear_matrix(n, dense);
    for (size_t c = 0; c < p->count; c++) {
        const double *half = n->half + 36 * c;
        const double *known = n->step + 3 * c;
        double d[9];
        if (!reduce_contact(n, dense, c))
            return 0;
        for (size_t i = 0; i < 9; i++)
            d[i] = n->unit * n->slope[9 * c + i];
        if (n->mode[c] == OPEN && known[0] == 0.0 && known[1] == 0.0 && known[2] == 0.0)
            continue;
        for (uint32_t side = 0; side < 2; side++) {
            const uint32_t body = p->pairs[2 * c + side];
            for (uint32_t j = 0; j < 6 && body != TRIBO_WORLD; j++) {
                const double *h = half + 18 * (size_t)side + j;
                n->x[6 * body + j] -=
                    n->unit * (h[0] * known[0] + h[6] * known[1] + h[12] * known[2]);
            }
        }
        if (n->mode[c] != OPEN)
            add_blocks(n, dense, c, c, d);
    }
    if (n->symmetric != 0 && dense == 0)
        copy_lower(n);
    if (!eliminate(n, rows, run))
        return 0;
    double normal_change = 0.0;
    for (size_t c = 0; c < p->count; c++) {
        double moved[3] = {0.0, 0.0, 0.0};
        double change[3];
        for (uint32_t side = 0; side < 2; side++) {
            const uint32_t body = p->pairs[2 * c + side];
            for (uint32_t k = 0; k < 3 && body != TRIBO_WORLD; k++) {
                const double *h = n->half + 36 * c + 18 * (size_t)side + 6 * (size_t)k;
                for (uint32_t j = 0; j < 6; j++)
                    moved[k] += h[j] * n->x[6 * body + j];
            }
        }
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

/* ---- price ----------------------------------------------------------------------------------- */

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

/* From one end of the graph to the other the levels are thinnest. */
static double sparse_operations(uint32_t nodes, const uint32_t *starts, const uint32_t *neighbours,
                                double rows, uint32_t *scratch)
{
    uint32_t last = 0;
    uint32_t unused;

    eliminate_levels(nodes, starts, neighbours, 0, rows, scratch, scratch + nodes, &last);
    return eliminate_levels(nodes, starts, neighbours, last, rows, scratch, scratch + nodes,
                            &unused);
}

static uint32_t count_torques(const system_problem *p)
{
    uint32_t count = 0;

    for (size_t c = 0; p->lengths != NULL && c < p->count; c++)
        count += resist_is_torque(p, c) ? 1 : 0;
    return count;
}

double newton_price(newton *n, const system_problem *problem, const newton_run *run)
{
    const uint32_t rows = unknowns(problem->count, problem->bodies);
    double sweep = SWEEP_OPERATIONS * (double)problem->count;
    double operations;

    n->problem = problem;
    if (problem->bodies == 0)
        sweep += BLOCK_OPERATIONS * (double)problem->row_starts[problem->count];
    if (is_dense(rows, run)) {
        operations = DENSE_SHARE * (double)rows * (double)rows * (double)rows;
    } else if (problem->bodies != 0) {
        link_bodies(n);
        tidy_links(n);
        operations = sparse_operations(problem->bodies, n->starts, n->neighbours, 6.0, n->place);
    } else {
        operations = CLIQUE_SHARE * sparse_operations(problem->count, problem->row_starts,
                                                      problem->columns, 3.0, n->place);
    }
    const double price = STEP_SWEEPS + operations / sweep;
    return price * (sweep / (sweep + TORQUE_OPERATIONS * (double)count_torques(problem)));
}

/* ---- iteration ------------------------------------------------------------------------------- */

static void exchange(double **a, double **b)
{
    double *held = *a;
    *a = *b;
    *b = held;
}

/* Move by a share of the step, halved until F falls below the bound. Returns |F| there. */
static double search(newton *n, double bound, double *share)
{
    const size_t numbers_of = 3 * (size_t)n->problem->count;
    double t = 1.0;
    double next = bound;

    for (; t > LEAST_LENGTH; t *= 0.5) {
        for (size_t i = 0; i < numbers_of; i++)
            n->next_r[i] = n->r[i] + t * n->step[i];
        certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
        next = map_all(n, n->next_r, n->next_u, n->next_f, n->next_mode);
        if (next < (1.0 - 1e-4 * t) * bound)
            break;
    }
    *share = t;
    return next;
}

static int step_once(newton *n, newton_run *run)
{
    run->steps++;
    linearize(n);
    return n->problem->bodies != 0 ? step_on_bodies(n, run) : step_on_blocks(n, run);
}

/* ---- sweeps over the proximal problem -------------------------------------------------------- */

/* Velocity of contact c with the proximal term, without its own impulse: what its solve cancels. */
static void velocity_alone(const newton *n, size_t c, const double w[9], double b[3])
{
    const system_problem *p = n->problem;
    const double *r = n->r + 3 * c;

    if (p->bodies != 0)
        certificate_contact_velocity(p, c, n->dv, b);
    else
        certificate_row_velocity(p, c, n->r, b);
    for (size_t k = 0; k < 3; k++)
        b[k] -= w[3 * k] * r[0] + w[3 * k + 1] * r[1] + w[3 * k + 2] * r[2] -
                n->alpha * (r[k] - n->center[3 * c + k]);
}

/* Exact solve of one contact of the proximal problem. */
static void renew_contact(newton *n, size_t c)
{
    const system_problem *p = n->problem;
    const double mu = coefficient(n, c);
    double *r = n->r + 3 * c;
    double w[9];
    double b[3];
    double next[3];
    tribo_status status;

    for (size_t i = 0; i < 9; i++)
        w[i] = p->diagonal[9 * c + i] + (i % 4 == 0 ? n->alpha : 0.0);
    velocity_alone(n, c, w, b);
    if (p->symmetric[c] != 0) {
        const double half[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
        status = tribo_contact_solve(half, b, mu, mu, next, NULL);
    } else {
        status = tribo_contact_solve_general(w, b, mu, mu, next, NULL);
    }
    if (status != TRIBO_OK)
        return;
    if (p->bodies != 0) {
        const double change[3] = {next[0] - r[0], next[1] - r[1], next[2] - r[2]};
        certificate_push(p, c, change, n->dv);
    }
    for (int k = 0; k < 3; k++)
        r[k] = next[k];
}

/* The same of a contact and its torque. */
static void renew_resisting(newton *n, size_t c)
{
    const system_problem *p = n->problem;
    resist_block block;
    double next[6];

    resist_fill(p, c, n->alpha, &block);
    for (size_t i = 0; i < 6; i++)
        next[i] = n->r[3 * c + i];
    certificate_contact_velocity(p, c, n->dv, block.b);
    certificate_contact_velocity(p, c + 1, n->dv, block.b + 3);
    for (size_t i = 0; i < 6; i++) {
        block.b[i] -= n->alpha * n->center[3 * c + i] - n->alpha * next[i];
        for (size_t k = 0; k < 6; k++)
            block.b[i] -= block.w[6 * i + k] * next[k];
    }
    if (!resist_solve(&block, next))
        return;
    for (size_t part = 0; part < 2; part++) {
        double *r = n->r + 3 * (c + part);
        const double *to = next + 3 * part;
        const double change[3] = {to[0] - r[0], to[1] - r[1], to[2] - r[2]};
        certificate_push(p, c + part, change, n->dv);
        for (int k = 0; k < 3; k++)
            r[k] = to[k];
    }
}

/* Impulses into the cone, torques within their limits. */
static void project_all(const newton *n, const double *from, double *to)
{
    const system_problem *p = n->problem;

    for (size_t c = 0; c < p->count; c++) {
        double limits[2];
        if (!resist_is_torque(p, c)) {
            cone_project(from + 3 * c, coefficient(n, c), to + 3 * c);
            continue;
        }
        resist_limits(p, c, to[3 * c - 3], limits);
        resist_project(from + 3 * c, limits, to + 3 * c);
    }
}

/* Gauss-Seidel on the proximal problem, twice as long each time. Returns |F|. */
static double smooth(newton *n)
{
    const system_problem *p = n->problem;

    project_all(n, n->r, n->r);
    certificate_velocity(p, n->r, n->dv, n->u);
    for (uint32_t i = 0; i < n->sweeps; i++) {
        for (size_t c = 0; c < p->count; c++) {
            if (resist_has_torque(p, c))
                renew_resisting(n, c);
            else if (!resist_is_torque(p, c))
                renew_contact(n, c);
        }
    }
    n->sweeps = n->sweeps < MOST_SWEEPS ? 2 * n->sweeps : MOST_SWEEPS;
    certificate_velocity(p, n->r, n->dv, n->u);
    return map_all(n, n->r, n->u, n->f, n->mode);
}

/* Greatest of the last few |F|: what the next one is measured against. Letting F rise for a step or
 * two (Grippo, Lampariello & Lucidi, SIAM J. Numer. Anal. 23 (1986) 707) passes kinks sooner. */
static double bound_of(const double *past, uint32_t steps)
{
    double out = 0.0;

    for (uint32_t i = 0; i < MEMORY && i <= steps; i++)
        out = greater(out, past[i]);
    return out;
}

static void move(newton *n)
{
    uint8_t *held = n->mode;

    exchange(&n->r, &n->next_r);
    exchange(&n->u, &n->next_u);
    exchange(&n->f, &n->next_f);
    n->mode = n->next_mode;
    n->next_mode = held;
}

/* Newton on one proximal step until |F| <= enough. Returns 1 if it got there. Where its steps have
 * become short, sweeps find the contacts that slide or part. */
static int solve_proximal(newton *n, double enough, newton_run *run, uint32_t *steps)
{
    double f = map_all(n, n->r, n->u, n->f, n->mode);
    double past[MEMORY];
    uint32_t short_steps = 0;

    for (*steps = 0; *steps < INNER_STEPS; ++*steps) {
        double share;
        if (f <= enough)
            return 1;
        run->halted = run->halt != NULL ? run->halt(run->context) : 0;
        if (run->halted != 0 || run->steps >= run->most_steps || !step_once(n, run))
            return 0;
        past[*steps % MEMORY] = f;
        f = search(n, bound_of(past, *steps), &share);
        if (!(f <= 1e300))
            return 0;
        move(n);
        short_steps = share < SHORT_SHARE ? short_steps + 1 : 0;
        if (short_steps == SHORT_STEPS) {
            f = smooth(n);
            short_steps = 0;
            for (uint32_t i = 0; i < MEMORY; i++)
                past[i] = f;
        }
    }
    return f <= enough;
}

/* Natural map without the proximal term, and the distance from the goal, of r brought into the
 * cone; kept if it is the best so far. */
static double judge(newton *n)
{
    const size_t count = n->problem->count;
    const double alpha = n->alpha;

    project_all(n, n->r, n->next_r);
    certificate_velocity(n->problem, n->next_r, n->dv, n->next_u);
    n->alpha = 0.0;
    const double f = map_all(n, n->next_r, n->next_u, n->next_f, n->next_mode);
    n->alpha = alpha;
    const verdict now = certificate_judge(n->problem, n->wanted, n->next_r, n->next_u, n->dv);
    n->distance = now.distance;
    if (is_better(now, n->reached)) {
        n->reached = now;
        copy(3 * count, n->next_r, n->best);
    }
    return f;
}

/* Block (c, d) of W, or null where it is zero. */
static const double *block_at(const system_problem *p, uint32_t c, uint32_t d)
{
    uint32_t low = p->row_starts[c];
    uint32_t high = p->row_starts[c + 1];

    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (p->columns[middle] <= d)
            low = middle;
        else
            high = middle;
    }
    return p->columns[low] == d ? p->blocks + 9 * (size_t)low : NULL;
}

/* 1 if blocks across the diagonal agree to rounding. An unsymmetric rest is only in the direction
 * of a step, not in what the steps lead to. */
static uint32_t is_symmetric(const system_problem *p)
{
    double most = 0.0;
    double odd = 0.0;

    for (uint32_t c = 0; p->bodies == 0 && c < p->count; c++) {
        for (uint32_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
            const uint32_t d = p->columns[k];
            const double *w = p->blocks + 9 * (size_t)k;
            const double *other = block_at(p, d, c);
            for (int i = 0; i < 9; i++) {
                const double across = other != NULL ? other[i % 3 * 3 + i / 3] : 0.0;
                most = greater(most, absolute(w[i]));
                odd = greater(odd, absolute(w[i] - across));
            }
        }
    }
    return odd <= SYMMETRY * most;
}

static void begin(newton *n, const system_problem *problem, const double *r)
{
    double sum = 0.0;
    double most = 0.0;

    n->problem = problem;
    n->reached.residual = n->reached.distance = HUGE_VAL;
    n->symmetric_w = is_symmetric(problem);
    copy(3 * (size_t)problem->count, r, n->r);
    copy(3 * (size_t)problem->count, r, n->best);
    copy(3 * (size_t)problem->count, r, n->center);
    for (size_t c = 0; c < problem->count; c++) {
        const double *w = problem->diagonal + 9 * c;
        double squares = 0.0;
        for (int i = 0; i < 9; i++)
            squares += w[i] * w[i];
        n->gain[c] = sqrt(squares);
        if (resist_is_torque(problem, c) && n->gain[c] == 0.0)
            n->gain[c] = n->gain[c - 1]; /* it can turn nothing, but has its law */
        sum += n->gain[c];
        most = greater(most, n->gain[c]);
    }
    n->unit = 1.0 / power_of_two(scale_exponent(most));
    certificate_velocity(problem, n->r, n->dv, n->u);
    n->size = sum / (double)problem->count;
}

/* The next alpha: lower where Newton is at ease. */
static void adapt(newton *n, int solved, uint32_t steps)
{
    if (!solved) {
        n->alpha *= RISE;
        n->fall = SLOW_FALL;
        return;
    }
    n->sweeps = n->sweeps > LEAST_SWEEPS ? n->sweeps / 2 : LEAST_SWEEPS;
    if (steps < QUICK)
        n->alpha =
            greater(n->alpha / (steps <= QUICKEST ? n->fall : SLOW_FALL), LEAST_ALPHA * n->size);
}

void newton_start(newton *n, const system_problem *problem, const goal *wanted,
                  const newton_run *run, const double *r)
{
    begin(n, problem, r);
    n->wanted = wanted;
    n->outer = judge(n);
    n->alpha = FIRST_ALPHA * n->size;
    n->fall = FAST_FALL;
    n->sweeps = LEAST_SWEEPS;
    n->won = n->renewed = run->steps;
    n->on_floor = 0;
    if (problem->bodies != 0)
        prepare_bodies(n, is_dense(6 * problem->bodies, run));
}

uint32_t newton_stalls(const newton *n, const newton_run *run)
{
    return n->on_floor != 0 || run->steps - n->won >= PATIENCE;
}

/* 1 if the best impulses are as good as rounding lets them be, and no better ones come. */
static uint32_t is_on_floor(newton *n, const newton_run *run)
{
    const double eta = n->reached.distance * n->wanted->tolerance;

    if (n->wanted->measure != TRIBO_MEASURE_ETA || eta > FLOOR_MOST ||
        run->steps - n->renewed < FLOOR_PATIENCE)
        return 0;
    return eta <= FLOOR_GROWTH * certificate_growth(n->problem, n->best, n->dv);
}

/* One proximal step. */
static void advance(newton *n, newton_run *run)
{
    const double before = n->reached.residual;
    const double enough = greater(INNER_SHARE * n->outer, 0.1 * n->outer / n->distance);
    uint32_t steps;

    copy(3 * (size_t)n->problem->count, n->r, n->center);
    const int solved = solve_proximal(n, enough, run, &steps);
    if (run->halted != 0 || run->status != TRIBO_OK)
        return;
    const double now = judge(n);
    const int good = now < 10.0 * n->outer && n->distance < HUGE_VAL;
    adapt(n, solved && good, steps);
    if (steps == 0) {
        /* Nothing to do but what bringing r into the cone undoes: go on from there. It counts as a
         * step, so that steps end. */
        run->steps++;
        n->outer = now;
        move(n);
    } else if (good) {
        n->outer = solved ? now : lesser(n->outer, now);
    } else {
        copy(3 * (size_t)n->problem->count, n->center, n->r);
        certificate_velocity(n->problem, n->r, n->dv, n->u);
    }
    n->won = n->reached.residual < 0.9 * before ? run->steps : n->won;
    n->renewed = n->reached.residual < before ? run->steps : n->renewed;
    n->on_floor = is_on_floor(n, run);
}

double newton_continue(newton *n, newton_run *run, uint64_t steps, double *r)
{
    const uint64_t first = run->steps;

    while (n->distance > 1.0 && run->steps - first < steps && run->steps < run->most_steps &&
           run->halted == 0 && run->status == TRIBO_OK && !newton_stalls(n, run))
        advance(n, run);
    run->growth = certificate_growth(n->problem, n->r, n->dv);
    copy(3 * (size_t)n->problem->count, n->best, r);
    return n->reached.distance;
}
