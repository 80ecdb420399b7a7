/* Time to an accuracy beside Siconos in the same run, on recorded problems of many contacts and on
 * towers of boxes: its proximal solver with regularised Newton (its best single configuration on
 * the recorded problems) and its Gauss-Seidel with two exact local solvers; and beside the time of
 * the best of 44 configurations of Siconos that the collection records for each problem.
 *
 *   siconos [--full] [SECONDS]     most seconds for a solve (TRIBO_BENCH_SECONDS of the environment,
 *                                  or 1; --full: 20)
 *
 * Accuracy is E_inv = |s r - P_K(s r - u')| / |q|, s the mean diagonal entry of W, computed here
 * from the impulses and the assembled W alone, in long double. Siconos stops by another measure: it
 * is asked for tighter ones until E_inv is met. Each solve starts from r = 0 in a process of its
 * own, which may be stopped; a mean "at most" counts that limit as the time. The time is that of
 * the processor, the least of repetitions for a while, and includes all that a solver
 * does before it starts. One thread. Towers are given to tribo as bodies and contacts, and to it
 * and Siconos assembled, which is not in the time. */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */

#include <tribo/sparse.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifdef TRIBO_HAVE_SICONOS
#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
#include <fc3d_Solvers.h>
#endif

#include "../../src/cli/problem.h"
#include "../support/systems.h"
#include "full.h"
#include "limit.h"

enum { CONTACTS_ABOVE = 20, PROBLEMS = 64, NAME = 64, GOALS = 2, REPETITIONS = 50, SLIDING = 2 };

static const double goals[GOALS] = {1e-6, 1e-9};
static double repeat_seconds = 0.1; /* --full: 0.5 */

/* One problem in the forms that there are of it. */
typedef struct task {
    problem assembled;
    const systems_scene *scene; /* null: recorded, assembled only */
} task;

/* Of the thread: Linux counts that of a process by ticks while SIGPROF is to come. */
static double now(void *user)
{
    struct timespec t;
    (void)user;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *allocate(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (!made) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return made;
}

/* What a solver asks for as scratch: it need not be cleared. */
static void *reserve(size_t size)
{
    void *made = malloc(size + 1);
    if (!made) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return made;
}

/* ---- accuracy ----------------------------------------------------------------------------- */

/* x - P_K(x) is what is left of x on the polar cone; the map is s r - P_K(s r - u'). */
static void project(long double x[3], long double mu)
{
    const long double size = sqrtl(x[1] * x[1] + x[2] * x[2]);
    if (mu * size <= -x[0]) {
        x[0] = x[1] = x[2] = 0.0L;
    } else if (size > mu * x[0]) {
        const long double normal = (mu * size + x[0]) / (mu * mu + 1.0L);
        x[0] = normal;
        x[1] *= mu * normal / size;
        x[2] *= mu * normal / size;
    }
}

static void velocity(const problem *given, const double *r, size_t row, long double u[3])
{
    for (size_t i = 0; i < 3; i++) {
        u[i] = (long double)given->q[3 * row + i];
    }
    for (uint32_t k = given->row_starts[row]; k < given->row_starts[row + 1]; k++) {
        const double *block = given->blocks + 9 * (size_t)k;
        const double *p = r + 3 * (size_t)given->columns[k];
        for (size_t i = 0; i < 9; i++) {
            u[i / 3] += (long double)block[i] * (long double)p[i % 3];
        }
    }
}

static long double mean_diagonal(const problem *given)
{
    long double trace = 0.0L;
    for (size_t row = 0; row < given->count; row++) {
        for (uint32_t k = given->row_starts[row]; k < given->row_starts[row + 1]; k++) {
            const double *block = given->blocks + 9 * (size_t)k;
            trace += given->columns[k] == row
                         ? (long double)block[0] + (long double)block[4] + (long double)block[8]
                         : 0.0L;
        }
    }
    return trace / (3.0L * (long double)given->count);
}

static double error_of(const problem *given, const double *r)
{
    const long double s = mean_diagonal(given);
    long double sum = 0.0L;
    long double size = 0.0L;
    for (size_t row = 0; row < given->count; row++) {
        const long double mu = (long double)given->mu[2 * row];
        long double u[3];
        long double x[3];
        velocity(given, r, row, u);
        u[0] += mu * sqrtl(u[1] * u[1] + u[2] * u[2]);
        for (size_t i = 0; i < 3; i++) {
            x[i] = s * (long double)r[3 * row + i] - u[i];
            size += (long double)given->q[3 * row + i] * (long double)given->q[3 * row + i];
        }
        project(x, mu);
        for (size_t i = 0; i < 3; i++) {
            const long double d = s * (long double)r[3 * row + i] - x[i];
            sum += d * d;
        }
    }
    return (double)sqrtl(sum / size);
}

/* ---- methods: each solves from r = 0 and returns the seconds it took ---------------------- */

typedef struct method {
    const char *name;
    double (*solve)(const task *given, double tolerance, double *r);
    double
        tightening; /* of the tolerance asked for, if E_inv is not met; 0: it is what it bounds */
} method;

static tribo_status solve_assembled(const problem *given, const tribo_system_options *options,
                                    double *r)
{
    size_t size = 0;
    tribo_status status = tribo_system_assembled_workspace_size(given->count, given->row_starts,
                                                                given->columns, options, &size);
    void *workspace = reserve(size);
    if (status == TRIBO_OK) {
        status = tribo_system_solve_assembled(given->count, given->row_starts, given->columns,
                                              given->blocks, given->q, given->mu, options,
                                              workspace, size, r, NULL, NULL);
    }
    free(workspace);
    return status;
}

static tribo_status solve_scene(const systems_scene *given, const tribo_system_options *options,
                                double *r)
{
    size_t size = 0;
    double *velocities = allocate(6 * given->body_count, sizeof *velocities);
    tribo_status status = tribo_system_workspace_size(given->body_count, given->count,
                                                      given->contacts, options, &size);
    void *workspace = reserve(size);
    if (status == TRIBO_OK) {
        status = tribo_system_solve(given->body_count, given->bodies, given->count, given->contacts,
                                    options, workspace, size, r, velocities, NULL);
    }
    free(workspace);
    free(velocities);
    return status;
}

static double solve_tribo(const task *given, int bodies, double tolerance, double *r)
{
    const double start = now(NULL);
    tribo_sparse *sparse = NULL;
    tribo_linear linear = {.struct_size = sizeof linear};
    tribo_system_options options = {.struct_size = sizeof options,
                                    .measure = TRIBO_MEASURE_INVARIANT,
                                    .tolerance = tolerance,
                                    .linear = &linear,
                                    .clock = now};
    tribo_status status = tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse);
    if (status == TRIBO_OK) {
        status = tribo_sparse_linear(sparse, &linear);
    }
    if (status == TRIBO_OK) {
        status = bodies ? solve_scene(given->scene, &options, r)
                        : solve_assembled(&given->assembled, &options, r);
    }
    tribo_sparse_destroy(sparse);
    const double seconds = now(NULL) - start;
    if (status != TRIBO_OK) {
        fprintf(stderr, "%s\n", tribo_status_name(status));
        exit(1);
    }
    return seconds;
}

static double solve_as_bodies(const task *given, double tolerance, double *r)
{
    return solve_tribo(given, 1, tolerance, r);
}

static double solve_as_blocks(const task *given, double tolerance, double *r)
{
    return solve_tribo(given, 0, tolerance, r);
}

#ifdef TRIBO_HAVE_SICONOS

/* Siconos frees what it is given, and spoils it before. */
static FrictionContactProblem *to_siconos(const problem *given)
{
    const unsigned count = (unsigned)given->count;
    const size_t blocks = given->row_starts[count];
    SparseBlockStructuredMatrix *w = SBM_new();
    w->nbblocks = (unsigned)blocks;
    w->blocknumber0 = w->blocknumber1 = count;
    w->blocksize0 = allocate(count, sizeof *w->blocksize0);
    w->blocksize1 = allocate(count, sizeof *w->blocksize1);
    w->filled1 = count + 1u;
    w->filled2 = blocks;
    w->index1_data = allocate(count + 1u, sizeof *w->index1_data);
    w->index2_data = allocate(blocks, sizeof *w->index2_data);
    w->block = allocate(blocks, sizeof *w->block);
    for (unsigned i = 0; i < count; i++) {
        w->blocksize0[i] = w->blocksize1[i] = 3u * (i + 1u);
        w->index1_data[i + 1] = given->row_starts[i + 1];
    }
    for (size_t k = 0; k < blocks; k++) {
        w->index2_data[k] = given->columns[k];
        w->block[k] = allocate(9, sizeof **w->block);
        for (size_t i = 0; i < 9; i++) {
            w->block[k][i % 3 * 3 + i / 3] = given->blocks[9 * k + i];
        }
    }
    NumericsMatrix *matrix = NM_new_SBM((int)(3u * count), (int)(3u * count), w);
    double *q = allocate(3u * count, sizeof *q);
    double *mu = allocate(count, sizeof *mu);
    memcpy(q, given->q, 3u * count * sizeof *q);
    for (unsigned i = 0; i < count; i++) {
        mu[i] = given->mu[2u * i];
    }
    return frictionContactProblem_new_with_data(3, (int)count, matrix, q, mu);
}

typedef void (*siconos_solver)(FrictionContactProblem *, double *, double *, int *,
                               SolverOptions *);

static double run_siconos(siconos_solver solver, SolverOptions *options, const task *given,
                          double tolerance, double *r)
{
    FrictionContactProblem *problem_of = to_siconos(&given->assembled);
    double *u = allocate(3 * given->assembled.count, sizeof *u);
    int info = 1; /* 0 would tell it that there is nothing to do */
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    const double start = now(NULL);
    solver(problem_of, r, u, &info, options);
    const double seconds = now(NULL) - start;
    free(u);
    solver_options_delete(options);
    frictionContactProblem_free(problem_of);
    return seconds;
}

static double solve_proximal(const task *given, double tolerance, double *r)
{
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_3D_PROX);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000;
    options->iparam[SICONOS_FRICTION_3D_PROXIMAL_IPARAM_STRATEGY] =
        SICONOS_FRICTION_3D_PROXIMAL_REGULARIZATION;
    options->dparam[SICONOS_FRICTION_3D_PROXIMAL_DPARAM_ALPHA] = 1.0;
    solver_options_update_internal(options, 0, SICONOS_FRICTION_3D_NSN_AC);
    return run_siconos(fc3d_proximal, options, given, tolerance, r);
}

static double solve_sweeps(const task *given, double tolerance, double *r, int local)
{
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000000;
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] =
        SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_FULL;
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION_FREQUENCY] = 10;
    solver_options_update_internal(options, 0, local);
    return run_siconos(fc3d_nsgs, options, given, tolerance, r);
}

static double solve_quartic(const task *given, double tolerance, double *r)
{
    return solve_sweeps(given, tolerance, r, SICONOS_FRICTION_3D_ONECONTACT_QUARTIC);
}

static double solve_hybrid(const task *given, double tolerance, double *r)
{
    return solve_sweeps(given, tolerance, r, SICONOS_FRICTION_3D_ONECONTACT_NSN_GP_HYBRID);
}

#endif

enum { BODIES, TRIBO, SICONOS_FIRST };

static const method methods[] = {{"tribo_bodies", solve_as_bodies, 0.0},
                                 {"tribo", solve_as_blocks, 0.0},
#ifdef TRIBO_HAVE_SICONOS
                                 {"prox_reg", solve_proximal, 1.0 / 30.0},
                                 {"nsgs_quartic", solve_quartic, 1.0 / 30.0},
                                 {"nsgs_hybrid", solve_hybrid, 1.0 / 30.0}
#endif
};
enum { METHODS = sizeof methods / sizeof methods[0], CURVES = METHODS + 1, TIGHTENINGS = 4 };

/* ---- one measurement ---------------------------------------------------------------------- */

typedef struct outcome {
    double seconds; /* infinite: not reached */
    double error;
    int stopped; /* by the limit of time */
} outcome;

static const outcome none = {HUGE_VAL, HUGE_VAL, 0};

/* What a process of its own has found so far. */
typedef struct shared {
    volatile double seconds;
    volatile double error;
    volatile int done;
} shared;

/* What is asked of a process. */
typedef struct attempt {
    const method *method;
    const task *given;
    double tolerance, limit;
    shared *found;
} attempt;

static void repeat(void *user)
{
    const attempt *asked = user;
    const task *given = asked->given;
    shared *found = asked->found;
    double *r = allocate(3 * given->assembled.count, sizeof *r);
    const double start = now(NULL);
    for (int i = 0; i < REPETITIONS && (i == 0 || now(NULL) - start < repeat_seconds); i++) {
        memset(r, 0, 3 * given->assembled.count * sizeof *r);
        limit_set(asked->limit);
        const double seconds = asked->method->solve(given, asked->tolerance, r);
        found->seconds = i == 0 || seconds < found->seconds ? seconds : found->seconds;
        found->error = error_of(&given->assembled, r);
        found->done = 1;
    }
    free(r);
}

static outcome measure(const method *m, const task *given, double tolerance, double limit)
{
    outcome out = none;
    shared *found = limit_share(sizeof *found);
    attempt asked = {m, given, tolerance, limit, found};
    const int end = limit_run(repeat, &asked);
    if (found->done) {
        out.seconds = found->seconds;
        out.error = found->error;
    }
    out.stopped = !found->done && end == LIMIT_STOPPED;
    munmap(found, sizeof *found);
    return out;
}

/* The first run that meets the goal; infinite seconds, if none does. */
static outcome time_to(const method *m, const task *given, double goal, double limit)
{
    double tolerance = goal;
    outcome last = none;
    for (int i = 0; i < (m->tightening > 0.0 ? TIGHTENINGS : 1); i++) {
        const outcome got = measure(m, given, tolerance, limit);
        if (got.error <= goal) {
            return got;
        }
        last.stopped = got.stopped;
        if (got.seconds == HUGE_VAL) {
            break; /* stopped, or failed: a tighter tolerance will be no better */
        }
        tolerance *= m->tightening;
    }
    return last;
}

/* ---- problems in series ------------------------------------------------------------------- */

typedef struct record {
    char name[NAME];
    unsigned contacts;
    double reference[GOALS]; /* seconds of the curve behind the methods; infinite: none */
    outcome found[METHODS][GOALS];
} record;

/* Problems in one table. Their methods are those from `first` on, then the reference. */
typedef struct series {
    const char *title; /* after their number */
    const char *file;  /* of the pictures */
    const char *reference;
    const char *heading; /* of the reference's column */
    int first;
    size_t count;
    record records[PROBLEMS];
} series;

static series recorded = {.title = "recorded problems",
                          .file = "siconos",
                          .reference = "best of 44, recorded",
                          .heading = "best/44",
                          .first = TRIBO};

static series towers = {.title = "towers",
                        .file = "siconos-towers",
                        .reference = "best of Siconos here",
                        .heading = "best",
                        .first = BODIES};

/* A time as the collection writes it, "4.7e-02 prox_fb", or "-". */
static double recorded_time(const char *field)
{
    char *end = NULL;
    const double seconds = strtod(field, &end);
    return end == field ? HUGE_VAL : seconds;
}

/* Fields: file, format, contacts, rank, rows, condition, mu, then times to 1e-3, 1e-6, 1e-9... */
static void read_manifest(const char *data)
{
    char path[4096];
    char line[1024];
    snprintf(path, sizeof path, "%s/fc/MANIFEST.tsv", data);
    FILE *stream = fopen(path, "r");
    while (stream && recorded.count < PROBLEMS && fgets(line, sizeof line, stream)) {
        char *fields[11];
        size_t got = 0;
        for (char *at = line; at && got < 11; got++) {
            fields[got] = at;
            at = strchr(at, '\t');
            if (at) {
                *at++ = '\0';
            }
        }
        if (got == 11 && atoi(fields[2]) > CONTACTS_ABOVE) {
            record *r = &recorded.records[recorded.count++];
            snprintf(r->name, sizeof r->name, "%.*s", NAME - 1, fields[0]);
            r->contacts = (unsigned)atoi(fields[2]);
            r->reference[0] = recorded_time(fields[8]);
            r->reference[1] = recorded_time(fields[9]);
        }
    }
    if (stream) {
        fclose(stream);
    }
}

static void print_head(const series *of)
{
    printf("%-34s %5s %6s", "problem", "cont.", "goal");
    for (int m = of->first; m < METHODS; m++) {
        printf("  %13s %7s", methods[m].name, "E_inv");
    }
    printf("  %10s", of->heading);
    for (int m = of->first + 1; m < METHODS; m++) {
        printf("  /%s", methods[m].name);
    }
    printf("  /%s\n", of->heading);
}

static void print_ratio(double seconds, double other, int width)
{
    if (seconds == HUGE_VAL) {
        printf("  %*s", width, "not met");
    } else if (other == HUGE_VAL) {
        printf("  %*s", width, "only");
    } else {
        printf("  %*.3g", width, seconds / other);
    }
}

static void print_row(const series *of, const record *r, int goal)
{
    const double mine = r->found[of->first][goal].seconds;
    printf("%-34.34s %5u %6.0e", r->name, r->contacts, goals[goal]);
    for (int m = of->first; m < METHODS; m++) {
        const outcome *o = &r->found[m][goal];
        if (o->seconds == HUGE_VAL) {
            printf("  %13s %7s", o->stopped ? "too long" : "-", "");
        } else {
            printf("  %10.3f ms %7.0e", 1e3 * o->seconds, o->error);
        }
    }
    if (r->reference[goal] == HUGE_VAL) {
        printf("  %10s", "-");
    } else {
        printf("  %7.2f ms", 1e3 * r->reference[goal]);
    }
    for (int m = of->first + 1; m < METHODS; m++) {
        print_ratio(mine, r->found[m][goal].seconds, (int)strlen(methods[m].name) + 1);
    }
    print_ratio(mine, r->reference[goal], (int)strlen(of->heading) + 1);
    putchar('\n');
}

/* Seconds of a curve: a method, or the reference. */
static double seconds_of(const record *r, int curve, int goal)
{
    return curve < METHODS ? r->found[curve][goal].seconds : r->reference[goal];
}

static const char *name_of(const series *of, int curve)
{
    return curve < METHODS ? methods[curve].name : of->reference;
}

/* Geometric mean of the times of `mine` over those of a curve, where both meet the goal; number of
 * those. What the
 * curve takes too long for counts as `stopped` seconds. */
static size_t mean_ratio(const series *of, int mine, int curve, int goal, double stopped,
                         double *mean)
{
    size_t both = 0;
    double sum = 0.0;
    for (size_t i = 0; i < of->count; i++) {
        const record *r = &of->records[i];
        const double own = seconds_of(r, mine, goal);
        double other = seconds_of(r, curve, goal);
        if (curve < METHODS && r->found[curve][goal].stopped) {
            other = stopped;
        }
        if (own < HUGE_VAL && other < HUGE_VAL) {
            both++;
            sum += log(own / other);
        }
    }
    *mean = exp(sum / (double)(both > 0 ? both : 1));
    return both;
}

static void print_means(const series *of, int goal, double limit)
{
    for (int curve = of->first; curve < CURVES; curve++) {
        size_t met = 0;
        for (size_t i = 0; i < of->count; i++) {
            met += seconds_of(&of->records[i], curve, goal) < HUGE_VAL;
        }
        printf("  to %.0e: %-22s meets %2zu of %zu", goals[goal], name_of(of, curve), met,
               of->count);
        for (int mine = of->first; mine <= TRIBO && mine < curve; mine++) {
            double mean = 1.0;
            double most = 1.0;
            const size_t both = mean_ratio(of, mine, curve, goal, HUGE_VAL, &mean);
            const size_t all = mean_ratio(of, mine, curve, goal, limit, &most);
            if (both > 0) {
                printf("; %s takes %.3g of its time (geometric mean of %zu)", methods[mine].name,
                       mean, both);
            }
            if (all > both) {
                printf("; %s at most %.3g of %zu", methods[mine].name, most, all);
            }
        }
        putchar('\n');
    }
}

/* ---- performance profile (Dolan & More 2002) ---------------------------------------------- */

static int compare(const void *left, const void *right)
{
    const double a = *(const double *)left;
    const double b = *(const double *)right;
    return (a > b) - (a < b);
}

/* Share of the problems that a curve solves within a factor of the fastest, as steps. */
static void put_profile(FILE *gnuplot, const series *of, int curve, int goal)
{
    const size_t count = of->count;
    double ratios[PROBLEMS];
    for (size_t i = 0; i < count; i++) {
        const record *r = &of->records[i];
        double best = HUGE_VAL;
        for (int c = of->first; c < CURVES; c++) {
            best = fmin(best, seconds_of(r, c, goal));
        }
        ratios[i] = best < HUGE_VAL ? seconds_of(r, curve, goal) / best : HUGE_VAL;
    }
    qsort(ratios, count, sizeof *ratios, compare);
    fprintf(gnuplot, "$curve%d << END\n1 0\n", curve);
    size_t met = 0;
    for (; met < count && ratios[met] < HUGE_VAL; met++) {
        fprintf(gnuplot, "%.6g %.6g\n", ratios[met], (double)(met + 1) / (double)count);
    }
    fprintf(gnuplot, "1e9 %.6g\nEND\n", (double)met / (double)count);
}

static void plot_profile(const char *folder, const series *of, int goal)
{
    static const char *const colours[] = {"#56B4E9", "#0072B2", "#D55E00",
                                          "#009E73", "#CC79A7", "#000000"};
    FILE *gnuplot = popen("LC_ALL=C.UTF-8 gnuplot", "w");
    if (!gnuplot) {
        perror("gnuplot");
        return;
    }
    fprintf(gnuplot,
            "set encoding utf8\nset terminal svg size 900,560 dynamic enhanced"
            " font 'Helvetica,15' background '#ffffff'\nset output '%s/%s-%.0e.svg'\n"
            "set border linecolor '#444444'\nset grid linecolor '#dddddd'\nset logscale x\n"
            "set xrange [1:1e5]\nset yrange [0:1.03]\nset key right bottom\n"
            "set format x '10^{%%T}'\nset xlabel 'time over that of the fastest'\n"
            "set ylabel 'share of the problems that are solved'\n"
            "set title '%zu %s to E_{inv} = %.0e'\n",
            folder, of->file, goals[goal], of->count, of->title, goals[goal]);
    for (int curve = of->first; curve < CURVES; curve++) {
        put_profile(gnuplot, of, curve, goal);
    }
    for (int curve = of->first; curve < CURVES; curve++) {
        const int last = curve == CURVES - 1;
        fprintf(gnuplot,
                "%s $curve%d using 1:2 with steps linewidth %d linecolor '%s' dashtype %d"
                " title '%s' noenhanced%s",
                curve == of->first ? "plot" : "", curve, curve <= TRIBO ? 4 : 2,
                colours[last ? 5 : curve], last ? 2 : 1, name_of(of, curve), last ? "\n" : ",");
    }
    if (pclose(gnuplot) == 0) {
        printf("  profile: %s/%s-%.0e.svg\n", folder, of->file, goals[goal]);
    }
}

/* ---- the bench ---------------------------------------------------------------------------- */

static void time_methods(const series *of, const task *given, record *r, double limit)
{
    for (int goal = 0; goal < GOALS; goal++) {
        for (int m = of->first; m < METHODS; m++) {
            outcome *out = &r->found[m][goal];
            /* what was too long to the goal before is too long to this one */
            *out = none;
            out->stopped = goal > 0 && r->found[m][goal - 1].stopped;
            if (!out->stopped) {
                *out = time_to(&methods[m], given, goals[goal], limit);
            }
        }
    }
}

static int run_recorded(const char *data, record *r, double limit)
{
    char path[4096];
    task given = {.scene = NULL};
    snprintf(path, sizeof path, "%s/fc/%s", data, r->name);
    if (problem_read(path, &given.assembled) != 0) {
        return 1;
    }
    time_methods(&recorded, &given, r, limit);
    for (int goal = 0; goal < GOALS; goal++) {
        print_row(&recorded, r, goal);
    }
    problem_free(&given.assembled);
    return 0;
}

static void run_tower(const char *kind, size_t boxes, systems_scene *scene, double limit)
{
    record *r = &towers.records[towers.count++];
    systems_blocks blocks;
    systems_assemble(scene, &blocks);
    const task given = {.assembled = {.count = blocks.count,
                                      .row_starts = blocks.row_starts,
                                      .columns = blocks.columns,
                                      .blocks = blocks.blocks,
                                      .q = blocks.q,
                                      .mu = blocks.mu},
                        .scene = scene};
    snprintf(r->name, sizeof r->name, "%zu boxes, %s", boxes, kind);
    r->contacts = (unsigned)scene->count;
    time_methods(&towers, &given, r, limit);
    for (int goal = 0; goal < GOALS; goal++) {
        r->reference[goal] = HUGE_VAL;
        for (int m = SICONOS_FIRST; m < METHODS; m++) {
            r->reference[goal] = fmin(r->reference[goal], r->found[m][goal].seconds);
        }
        print_row(&towers, r, goal);
    }
    systems_free_blocks(&blocks);
    systems_free(scene);
}

static void run_towers(double limit)
{
    static const size_t heights[] = {10, 20, 50};
    static const struct {
        const char *name;
        uint32_t masses;
        double ratio;
    } kinds[] = {{"equal", SYSTEMS_TOP, 1.0},
                 {"top 1000 times", SYSTEMS_TOP, 1000.0},
                 {"alternately 1000 times", SYSTEMS_ALTERNATE, 1000.0}};
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
        systems_scene scene;
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
            systems_tower(&scene, heights[i], kinds[k].masses, kinds[k].ratio, 0.5);
            run_tower(kinds[k].name, heights[i], &scene, limit);
        }
        for (uint64_t seed = 1; seed <= SLIDING; seed++) {
            char name[NAME];
            systems_sliding_tower(&scene, heights[i], seed);
            snprintf(name, sizeof name, "sliding, seed %d", (int)seed);
            run_tower(name, heights[i], &scene, limit);
        }
    }
}

static void summarise(const char *program, const series *of, double limit)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", program);
    char *slash = strrchr(folder, '/');
    snprintf(slash ? slash : folder, 2, "%s", slash ? "" : ".");
    for (int goal = 0; goal < GOALS; goal++) {
        print_means(of, goal, limit);
        if (system("command -v gnuplot >/dev/null 2>&1") == 0) {
            plot_profile(folder, of, goal);
        }
    }
}

static double limit_of(const char *argument, double usual)
{
    const char *text = argument ? argument : getenv("TRIBO_BENCH_SECONDS");
    const double seconds = text ? atof(text) : usual;
    if (!(seconds > 0.0 && seconds < 1e6)) {
        fprintf(stderr, "siconos: %s is no time limit\n", text);
        exit(2);
    }
    return seconds;
}

int main(int argc, char **argv)
{
    const char *data = getenv("TRIBO_DATA");
    int failed = 0;
    limit_threads(argv);
    const int full = take_full(&argc, argv);
    const double limit = limit_of(argc > 1 ? argv[1] : NULL, full ? 20.0 : 1.0);
    repeat_seconds = full ? 0.5 : repeat_seconds;
    if ((int)METHODS == (int)SICONOS_FIRST) {
        puts("siconos: its solvers are skipped, they were not there when this was built");
    }
    printf("\nTowers of boxes from a cold start, time to E_inv; a solve has %g s\n", limit);
    print_head(&towers);
    run_towers(limit);
    summarise(argv[0], &towers, limit);
    if (!data || !*data) {
        puts("siconos: recorded problems are skipped, TRIBO_DATA does not name their folder");
        return 0;
    }
    read_manifest(data);
    printf("\nRecorded problems of more than %d contacts, time to E_inv; a solve has %g s\n",
           (int)CONTACTS_ABOVE, limit);
    print_head(&recorded);
    for (size_t i = 0; i < recorded.count; i++) {
        failed |= run_recorded(data, &recorded.records[i], limit);
    }
    summarise(argv[0], &recorded, limit);
    return failed;
}
