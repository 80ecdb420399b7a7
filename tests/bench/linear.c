/* The linear systems of Newton's steps: microseconds for factors and a solve, dense and by the
 * methods of sparse.h, for towers of boxes and piles (cubic lattices of bodies with one contact to
 * each neighbour); and GFlop/s of the dense factorisations at each instruction set.
 *
 *   linear [--full]     more repetitions
 *
 *   H = 1 + J^T D J  in the bodies' velocities, blocks of 6, symmetric: CHOLMOD
 *   W + D            on the contacts, blocks of 3, symmetric: CHOLMOD
 *   Q W + 1 - Q      the same with a third of the contacts open and some sliding, unsymmetric: KLU,
 *                    UMFPACK
 *
 * "first" is the pattern's analysis and the factors, "again" the factors of the same pattern; least
 * times of several, by the clock on the wall, since CHOLMOD and BLAS may start threads; GFlop/s are
 * by the clock of the thread. Errors are |A x - b| / (|A||x|), greatest entries. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/sparse.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/problems.h"
#include "dense.h"
#include "full.h"

enum { SEED = 20160603, METHODS = 3, DENSE_LIMIT = 1000, GENERAL_LIMIT = 10000, KINDS = 3 };

enum { VELOCITIES, CONTACTS, GENERAL };

static double budget = 0.03; /* seconds for each figure */

static const char *const kinds[KINDS] = {"H", "W+D", "QW+1-Q"};

/* Contact between bodies a and b with its Jacobians, 3 rows of 6. */
typedef struct meeting {
    uint32_t a, b;
    double jacobians[2][18];
} meeting;

typedef struct scene {
    char name[32];
    uint32_t bodies, count;
    meeting *meetings;
    problem_random random;
} scene;

/* A block to be added at a place. */
typedef struct part {
    uint32_t row, column;
    double values[36];
} part;

typedef struct parts {
    uint32_t block;
    size_t count, capacity;
    part *list;
} parts;

typedef struct matrix {
    uint32_t n, symmetric;
    uint32_t *starts, *columns;
    double *values;
} matrix;

typedef struct timing {
    double first, again, solve, error; /* seconds; negative: not done */
    const char *method;
    uint64_t fill, bytes;
} timing;

static void *allocate(size_t size)
{
    void *made = malloc(size);
    if (!made) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return made;
}

static void demand(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "linear: %s\n", what);
        exit(1);
    }
}

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double now(void)
{
    return read_clock(CLOCK_MONOTONIC);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static double uniform(scene *s)
{
    return problem_random_uniform(&s->random, -0.5, 0.5);
}

/* The frame of the world will do: what counts is who meets whom. */
static void meet(scene *s, uint32_t a, uint32_t b)
{
    meeting *m = &s->meetings[s->count++];
    m->a = a;
    m->b = b;
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < 18; i++) {
            const double unit = i % 6 != i / 6 ? 0.0 : side ? -1.0 : 1.0;
            m->jacobians[side][i] = i % 6 < 3 ? unit : 2.0 * uniform(s);
        }
    }
}

static scene start_scene(const char *kind, uint32_t bodies, uint32_t most)
{
    scene s = {"", bodies, 0, allocate(most * sizeof(meeting)), {0}};
    snprintf(s.name, sizeof s.name, "%s of %u", kind, (unsigned)bodies);
    problem_random_start(&s.random, 81, SEED, bodies);
    return s;
}

static scene make_tower(uint32_t bodies)
{
    scene s = start_scene("tower", bodies, 4 * bodies);
    for (uint32_t i = 0; i < bodies; i++) {
        for (int k = 0; k < 4; k++) {
            meet(&s, i, i ? i - 1 : TRIBO_WORLD);
        }
    }
    return s;
}

static scene make_pile(uint32_t edge)
{
    scene s = start_scene("pile", edge * edge * edge, 3 * edge * edge * edge);
    for (uint32_t i = 0; i < s.bodies; i++) {
        const uint32_t x = i % edge, y = i / edge % edge, z = i / edge / edge;
        meet(&s, i, z ? i - edge * edge : TRIBO_WORLD);
        if (y) {
            meet(&s, i, i - edge);
        }
        if (x) {
            meet(&s, i, i - 1);
        }
    }
    return s;
}

/* ---- matrices -------------------------------------------------------------------------------- */

static double *add_part(parts *p, uint32_t row, uint32_t column)
{
    if (p->count == p->capacity) {
        p->capacity = 2 * p->capacity + 64;
        p->list = realloc(p->list, p->capacity * sizeof *p->list);
        demand(p->list != NULL, "out of memory");
    }
    part *made = &p->list[p->count++];
    memset(made, 0, sizeof *made);
    made->row = row;
    made->column = column;
    return made->values;
}

static int compare_parts(const void *x, const void *y)
{
    const part *a = x;
    const part *b = y;
    return a->row != b->row         ? (a->row < b->row ? -1 : 1)
           : a->column != b->column ? (a->column < b->column ? -1 : 1)
                                    : 0;
}

/* One row of a block row from its parts, those of the same place summed up. */
static uint32_t write_row(const parts *p, size_t from, size_t to, uint32_t line, matrix *m,
                          uint32_t at)
{
    const uint32_t row = p->list[from].row * p->block + line;
    for (size_t k = from; k < to; k++) {
        const part *added = &p->list[k];
        const int goes_on = k > from && added->column == p->list[k - 1].column;
        at -= goes_on ? p->block : 0;
        for (uint32_t j = 0; j < p->block; j++) {
            const double before = goes_on ? m->values[at + j] : 0.0;
            m->columns[at + j] = added->column * p->block + j;
            m->values[at + j] = before + added->values[line * p->block + j];
        }
        at += p->block;
    }
    /* Of a symmetric matrix the blocks above the diagonal are not there; the rest of the diagonal
     * block goes here. */
    while (m->symmetric && m->columns[at - 1] > row) {
        at--;
    }
    return at;
}

static matrix assemble(parts *p, uint32_t blocks, uint32_t symmetric)
{
    const size_t entries = p->count * p->block * p->block;
    matrix m = {blocks * p->block, symmetric, NULL, NULL, NULL};
    m.starts = allocate((m.n + 1) * sizeof *m.starts);
    m.columns = allocate(entries * sizeof *m.columns);
    m.values = allocate(entries * sizeof *m.values);
    m.starts[0] = 0;
    qsort(p->list, p->count, sizeof *p->list, compare_parts);
    size_t from = 0;
    for (uint32_t i = 0; i < blocks; i++) {
        size_t to = from;
        while (to < p->count && p->list[to].row == i) {
            to++;
        }
        for (uint32_t line = 0; line < p->block; line++) {
            const uint32_t row = i * p->block + line;
            m.starts[row + 1] = write_row(p, from, to, line, &m, m.starts[row]);
        }
        from = to;
    }
    free(p->list);
    return m;
}

static void free_matrix(matrix *m)
{
    free(m->starts);
    free(m->columns);
    free(m->values);
}

/* 1 + J^T D J, D a number for each contact from 0.1 to 1000. */
static matrix make_velocities(scene *s)
{
    parts p = {6, 0, 0, NULL};
    for (uint32_t i = 0; i < s->bodies; i++) {
        double *out = add_part(&p, i, i);
        for (int k = 0; k < 6; k++) {
            out[7 * k] = 1.0;
        }
    }
    for (uint32_t c = 0; c < s->count; c++) {
        const meeting *m = &s->meetings[c];
        const uint32_t ends[2] = {m->a, m->b};
        const double weight = problem_random_decades(&s->random, -1.0, 3.0);
        for (int e = 0; e < 4; e++) {
            const uint32_t i = ends[e / 2], j = ends[e % 2];
            if (i == TRIBO_WORLD || j == TRIBO_WORLD || j > i) {
                continue;
            }
            double *out = add_part(&p, i, j);
            for (int k = 0; k < 108; k++) {
                out[k % 36] += weight * m->jacobians[e / 2][k / 36 * 6 + k % 36 / 6] *
                               m->jacobians[e % 2][k / 36 * 6 + k % 6];
            }
        }
    }
    return assemble(&p, s->bodies, 1);
}

/* X Y^T of two matrices with three rows. */
static void multiply(const double *x, const double *y, int inner, double out[9])
{
    for (int k = 0; k < 9; k++) {
        out[k] = 0.0;
        for (int i = 0; i < inner; i++) {
            out[k] += x[k / 3 * inner + i] * y[k % 3 * inner + i];
        }
    }
}

/* Q_c: 1 if it sticks, 0 if it is open, else something in between. */
static void draw_state(scene *s, uint32_t general, double q[9])
{
    const double state = uniform(s);
    for (int i = 0; i < 9; i++) {
        const double unit = i % 4 == 0;
        q[i] = !general || state < 0.0 ? unit
               : state < 0.33          ? 0.0
                                       : unit - 0.3 * (0.5 + uniform(s));
    }
}

/* Who touches a body: chains of 2 * contact + side. */
static uint32_t *link_ends(const scene *s, uint32_t *first)
{
    uint32_t *next = allocate(2 * s->count * sizeof *next);
    for (uint32_t i = 0; i < s->bodies; i++) {
        first[i] = UINT32_MAX;
    }
    for (uint32_t end = 0; end < 2 * s->count; end++) {
        const uint32_t body = end % 2 ? s->meetings[end / 2].b : s->meetings[end / 2].a;
        if (body != TRIBO_WORLD) {
            next[end] = first[body];
            first[body] = end;
        }
    }
    return next;
}

/* Blocks of W, Q times, of all pairs of contacts that share a body. */
static void add_shared(const scene *s, const double *states, uint32_t general, parts *p)
{
    uint32_t *first = allocate(s->bodies * sizeof *first);
    uint32_t *next = link_ends(s, first);
    for (uint32_t body = 0; body < s->bodies; body++) {
        for (uint32_t x = first[body]; x != UINT32_MAX; x = next[x]) {
            for (uint32_t y = first[body]; y != UINT32_MAX; y = next[y]) {
                double w[9];
                multiply(s->meetings[y / 2].jacobians[y % 2], s->meetings[x / 2].jacobians[x % 2],
                         6, w); /* transposed */
                if (general || y / 2 <= x / 2) {
                    multiply(states + 9 * (x / 2), w, 3, add_part(p, x / 2, y / 2));
                }
            }
        }
    }
    free(first);
    free(next);
}

static matrix make_contacts(scene *s, uint32_t general)
{
    parts p = {3, 0, 0, NULL};
    double *states = allocate(9 * s->count * sizeof *states);
    for (uint32_t c = 0; c < s->count; c++) {
        draw_state(s, general, states + 9 * c);
        double *out = add_part(&p, c, c);
        for (uint32_t k = 0; k < 9; k++) {
            const double unit = k % 4 == 0;
            out[k] = general ? unit * 1.003 - states[9 * c + k] : 0.02 * unit;
        }
    }
    add_shared(s, states, general, &p);
    free(states);
    return assemble(&p, s->count, !general);
}

/* ---- timing ---------------------------------------------------------------------------------- */

static double error_of(const matrix *m, const double *x)
{
    double *rest = allocate(m->n * sizeof *rest);
    double greatest = 0.0, entry = 0.0, size = 0.0;
    for (uint32_t i = 0; i < m->n; i++) {
        rest[i] = -1.0;
    }
    for (uint32_t i = 0; i < m->n; i++) {
        size = fmax(size, fabs(x[i]));
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const uint32_t j = m->columns[k];
            entry = fmax(entry, fabs(m->values[k]));
            rest[i] += m->values[k] * x[j];
            rest[j] += m->symmetric && j != i ? m->values[k] * x[i] : 0.0;
        }
    }
    for (uint32_t i = 0; i < m->n; i++) {
        greatest = fmax(greatest, fabs(rest[i]));
    }
    free(rest);
    return greatest / (entry * size);
}

static void fill_ones(uint32_t n, double *x)
{
    for (uint32_t i = 0; i < n; i++) {
        x[i] = 1.0;
    }
}

static void keep_least(double seconds, double *least)
{
    *least = *least < 0.0 || seconds < *least ? seconds : *least;
}

static void take_least(double started, double *least)
{
    keep_least(now() - started, least);
}

static void factor(const tribo_linear *linear, const matrix *m)
{
    demand(linear->factor(linear->context, m->n, m->starts, m->columns, m->values, m->symmetric) ==
               TRIBO_OK,
           "a matrix is refused");
}

static void open_sparse(uint32_t method, tribo_sparse **sparse, tribo_linear *linear)
{
    linear->struct_size = sizeof *linear;
    demand(tribo_sparse_create(method, NULL, sparse) == TRIBO_OK &&
               tribo_sparse_linear(*sparse, linear) == TRIBO_OK,
           "out of memory");
}

static timing time_sparse(const matrix *m, uint32_t method)
{
    timing t = {-1.0, -1.0, -1.0, 0.0, NULL, 0, 0};
    tribo_sparse_info info = {.struct_size = sizeof info};
    tribo_sparse *sparse;
    tribo_linear linear;
    double *x = allocate(m->n * sizeof *x);
    for (double end = now() + budget; t.first < 0.0 || now() < end;) {
        open_sparse(method, &sparse, &linear);
        const double started = now();
        factor(&linear, m);
        take_least(started, &t.first);
        tribo_sparse_destroy(sparse);
    }
    open_sparse(method, &sparse, &linear);
    factor(&linear, m);
    for (double end = now() + budget; t.again < 0.0 || now() < end;) {
        double started = now();
        factor(&linear, m);
        take_least(started, &t.again);
        fill_ones(m->n, x);
        started = now();
        linear.solve(linear.context, x);
        take_least(started, &t.solve);
    }
    t.error = error_of(m, x);
    demand(tribo_sparse_report(sparse, &info) == TRIBO_OK, "no report");
    t.fill = info.fill;
    t.bytes = info.bytes;
    const int thin = info.method == TRIBO_SPARSE_SIMPLICIAL;
    t.method = m->symmetric ? (thin ? "CHOLMOD simplicial" : "CHOLMOD supernodal")
                            : (thin ? "KLU" : "UMFPACK");
    tribo_sparse_destroy(sparse);
    free(x);
    return t;
}

static void spread(const matrix *m, double *a)
{
    const size_t ld = dense_stride(m->n);
    memset(a, 0, m->n * ld * sizeof *a);
    for (uint32_t i = 0; i < m->n; i++) {
        for (uint32_t k = m->starts[i]; k < m->starts[i + 1]; k++) {
            const size_t j = m->columns[k];
            a[m->symmetric ? j * ld + i : i * ld + j] = m->values[k];
        }
    }
}

/* Spreading counts: Newton has to do it as well. */
static timing time_dense(const matrix *m)
{
    timing t = {-1.0, -1.0, -1.0, 0.0, "dense", 0, 0};
    const uint32_t n = m->n;
    const dense_shape shape = dense_shape_of(n, n);
    t.fill = (uint64_t)n * (m->symmetric ? n + 1 : 2 * n) / 2;
    t.bytes = shape.numbers * sizeof(double);
    double *a = allocate(t.bytes);
    double *x = allocate(n * sizeof *x);
    uint32_t *pivots = allocate(n * sizeof *pivots);
    for (double end = now() + budget; t.again < 0.0 || now() < end;) {
        double started = now();
        spread(m, a);
        demand(m->symmetric ? dense_cholesky(TRIBO_ISA_BEST, &shape, a)
                            : dense_lu(TRIBO_ISA_BEST, &shape, a, pivots),
               "a matrix is refused");
        take_least(started, &t.again);
        fill_ones(n, x);
        started = now();
        if (m->symmetric) {
            dense_cholesky_solve(TRIBO_ISA_BEST, &shape, a, x);
        } else {
            dense_lu_solve(TRIBO_ISA_BEST, &shape, a, pivots, x);
        }
        take_least(started, &t.solve);
    }
    t.first = t.again;
    t.error = error_of(m, x);
    free(a);
    free(x);
    free(pivots);
    return t;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void print_timing(const scene *s, const char *kind, const matrix *m, timing t, char best)
{
    printf("%-13s %-7s %6u %8u  %-18s %10.1f %10.1f %9.1f %9llu %8.1f %8.1e %c\n", s->name, kind,
           (unsigned)m->n, (unsigned)m->starts[m->n], t.method, 1e6 * t.first, 1e6 * t.again,
           1e6 * t.solve, (unsigned long long)t.fill, (double)t.bytes / 1024.0, t.error, best);
}

static void run_matrix(const scene *s, const char *kind, matrix *m)
{
    timing done[METHODS];
    int count = 0, best = 0;
    if (m->n <= DENSE_LIMIT) {
        done[count++] = time_dense(m);
    }
    done[count++] = time_sparse(m, TRIBO_SPARSE_SIMPLICIAL);
    done[count++] = time_sparse(m, TRIBO_SPARSE_SUPERNODAL);
    const char *chosen = time_sparse(m, TRIBO_SPARSE_AUTO).method;
    for (int i = 0; i < count; i++) {
        best = done[i].again + done[i].solve < done[best].again + done[best].solve ? i : best;
    }
    for (int i = 0; i < count; i++) {
        const int is_chosen = strcmp(done[i].method, chosen) == 0;
        print_timing(s, kind, m, done[i],
                     i == best   ? (is_chosen ? '#' : '*')
                     : is_chosen ? 'a'
                                 : ' ');
    }
    free_matrix(m);
}

static void run_scene(scene s)
{
    for (int kind = 0; kind < KINDS; kind++) {
        if (kind == VELOCITIES || 3 * s.count <= GENERAL_LIMIT) {
            matrix m =
                kind == VELOCITIES ? make_velocities(&s) : make_contacts(&s, kind == GENERAL);
            run_matrix(&s, kinds[kind], &m);
        }
    }
    free(s.meetings);
}

/* Seconds of one factorisation of a random matrix, the copy of it taken off. */
static double time_random(uint32_t isa, uint32_t n, int symmetric)
{
    const dense_shape shape = dense_shape_of(n, n);
    const size_t size = shape.numbers;
    double *given = allocate(size * sizeof *given);
    double *a = allocate(size * sizeof *a);
    uint32_t *pivots = allocate(n * sizeof *pivots);
    problem_random random;
    double copying = -1.0, all = -1.0;
    problem_random_start(&random, 82, SEED, n);
    const uint32_t rounds = 1 + 40000 / (n * n);
    for (size_t i = 0; i < size; i++) {
        given[i] = problem_random_uniform(&random, -1.0, 1.0) +
                   (symmetric && i % shape.stride == i / shape.stride ? n : 0.0);
    }
    for (double end = now() + budget; all < 0.0 || now() < end;) {
        double started = read_clock(CLOCK_THREAD_CPUTIME_ID);
        for (uint32_t k = 0; k < rounds; k++) {
            memcpy(a, given, size * sizeof *a);
        }
        keep_least(read_clock(CLOCK_THREAD_CPUTIME_ID) - started, &copying);
        started = read_clock(CLOCK_THREAD_CPUTIME_ID);
        for (uint32_t k = 0; k < rounds; k++) {
            memcpy(a, given, size * sizeof *a);
            demand(symmetric ? dense_cholesky(isa, &shape, a) : dense_lu(isa, &shape, a, pivots),
                   "a random matrix is refused");
        }
        keep_least(read_clock(CLOCK_THREAD_CPUTIME_ID) - started, &all);
    }
    free(given);
    free(a);
    free(pivots);
    return (all - copying) / rounds;
}

static void run_dense(void)
{
    static const uint32_t sizes[] = {12, 24, 48, 96, 192, 384};
    printf("%-10s %4s %14s %9s %14s %9s\n", "dense", "n", "Cholesky, us", "GFlop/s", "LU, us",
           "GFlop/s");
    for (uint32_t isa = TRIBO_ISA_BASELINE; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0] && tribo_isa_available(isa); k++) {
            const double n = sizes[k];
            const double cholesky = time_random(isa, sizes[k], 1);
            const double lu = time_random(isa, sizes[k], 0);
            printf("%-10s %4.0f %14.2f %9.1f %14.2f %9.1f\n", tribo_isa_name(isa), n,
                   1e6 * cholesky, 1e-9 * n * n * n / 3.0 / cholesky, 1e6 * lu,
                   2e-9 * n * n * n / 3.0 / lu);
        }
    }
}

int main(int count, char **arguments)
{
    budget = take_full(&count, arguments) ? 0.1 : budget;
    printf("%-13s %-7s %6s %8s  %-18s %10s %10s %9s %9s %8s %8s\n", "scene", "matrix", "n",
           "entries", "method", "first, us", "again, us", "solve, us", "fill", "KiB", "error");
    run_scene(make_tower(1));
    run_scene(make_tower(2));
    run_scene(make_tower(5));
    run_scene(make_tower(10));
    run_scene(make_tower(20));
    run_scene(make_tower(50));
    run_scene(make_tower(500));
    run_scene(make_pile(2));
    run_scene(make_pile(3));
    run_scene(make_pile(4));
    run_scene(make_pile(5));
    run_scene(make_pile(10));
    printf("*: least time again and solve; a: what TRIBO_SPARSE_AUTO chooses; #: both\n\n");
    run_dense();
    return 0;
}
