/* Time to an accuracy on recorded problems of many contacts, beside Siconos in the same run: its
 * proximal solver with regularised Newton (its best single configuration on these problems) and its
 * Gauss-Seidel with two exact local solvers; and beside the time of the best of 44 configurations
 * of Siconos that the collection records for each problem.
 *
 *   siconos [SECONDS]     most seconds for a solve (20)
 *
 * Accuracy is E_inv = |s r - P_K(s r - u')| / |q|, s the mean diagonal entry of W, computed here
 * from the impulses alone, in long double. Siconos stops by another measure: it is asked for
 * tighter ones until E_inv is met. Each solve starts from r = 0 in a process of its own, which may
 * be stopped; its time is the least of repetitions for up to half a second, and includes all that a
 * solver does before it starts. One thread. */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */

#include <tribo/sparse.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
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

enum { CONTACTS_ABOVE = 20, PROBLEMS = 64, NAME = 64, GOALS = 2, REPETITIONS = 50 };

static const double goals[GOALS] = {1e-6, 1e-9};
static const double repeat_seconds = 0.5;

static double now(void *user)
{
    struct timespec t;
    (void)user;
    clock_gettime(CLOCK_MONOTONIC, &t);
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
    double (*solve)(const problem *given, double tolerance, double *r);
    double
        tightening; /* of the tolerance asked for, if E_inv is not met; 0: it is what it bounds */
} method;

static double solve_tribo(const problem *given, double tolerance, double *r)
{
    const double start = now(NULL);
    tribo_sparse *sparse = NULL;
    tribo_linear linear = {.struct_size = sizeof linear};
    tribo_system_options options = {.struct_size = sizeof options,
                                    .measure = TRIBO_MEASURE_INVARIANT,
                                    .tolerance = tolerance,
                                    .linear = &linear,
                                    .clock = now};
    size_t size = 0;
    tribo_status status = tribo_sparse_create(TRIBO_SPARSE_AUTO, NULL, &sparse);
    if (status == TRIBO_OK) {
        status = tribo_sparse_linear(sparse, &linear);
    }
    if (status == TRIBO_OK) {
        status = tribo_system_assembled_workspace_size(given->count, given->row_starts,
                                                       given->columns, &options, &size);
    }
    void *workspace = malloc(size + 1);
    if (status == TRIBO_OK && workspace) {
        status = tribo_system_solve_assembled(given->count, given->row_starts, given->columns,
                                              given->blocks, given->q, given->mu, &options,
                                              workspace, size, r, NULL, NULL);
    }
    free(workspace);
    tribo_sparse_destroy(sparse);
    const double seconds = now(NULL) - start;
    if (status != TRIBO_OK) {
        fprintf(stderr, "%s\n", tribo_status_name(status));
        exit(1);
    }
    return seconds;
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

static double run_siconos(siconos_solver solver, SolverOptions *options, const problem *given,
                          double tolerance, double *r)
{
    FrictionContactProblem *problem_of = to_siconos(given);
    double *u = allocate(3 * given->count, sizeof *u);
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

static double solve_proximal(const problem *given, double tolerance, double *r)
{
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_3D_PROX);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000;
    options->iparam[SICONOS_FRICTION_3D_PROXIMAL_IPARAM_STRATEGY] =
        SICONOS_FRICTION_3D_PROXIMAL_REGULARIZATION;
    options->dparam[SICONOS_FRICTION_3D_PROXIMAL_DPARAM_ALPHA] = 1.0;
    solver_options_update_internal(options, 0, SICONOS_FRICTION_3D_NSN_AC);
    return run_siconos(fc3d_proximal, options, given, tolerance, r);
}

static double solve_sweeps(const problem *given, double tolerance, double *r, int local)
{
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000000;
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] =
        SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_FULL;
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION_FREQUENCY] = 10;
    solver_options_update_internal(options, 0, local);
    return run_siconos(fc3d_nsgs, options, given, tolerance, r);
}

static double solve_quartic(const problem *given, double tolerance, double *r)
{
    return solve_sweeps(given, tolerance, r, SICONOS_FRICTION_3D_ONECONTACT_QUARTIC);
}

static double solve_hybrid(const problem *given, double tolerance, double *r)
{
    return solve_sweeps(given, tolerance, r, SICONOS_FRICTION_3D_ONECONTACT_NSN_GP_HYBRID);
}

#endif

static const method methods[] = {{"tribo", solve_tribo, 0.0},
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
} outcome;

/* What a process of its own has found so far. */
typedef struct shared {
    volatile double seconds;
    volatile double error;
    volatile int done;
} shared;

static void repeat(const method *m, const problem *given, double tolerance, unsigned limit,
                   shared *found)
{
    double *r = allocate(3 * given->count, sizeof *r);
    const double start = now(NULL);
    for (int i = 0; i < REPETITIONS && (i == 0 || now(NULL) - start < repeat_seconds); i++) {
        memset(r, 0, 3 * given->count * sizeof *r);
        alarm(limit);
        const double seconds = m->solve(given, tolerance, r);
        found->seconds = i == 0 || seconds < found->seconds ? seconds : found->seconds;
        found->error = error_of(given, r);
        found->done = 1;
    }
    free(r);
}

static outcome measure(const method *m, const problem *given, double tolerance, unsigned limit)
{
    outcome out = {HUGE_VAL, HUGE_VAL};
    int status = 0;
    shared *found =
        mmap(NULL, sizeof *found, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (found == MAP_FAILED) {
        perror("mmap");
        exit(1);
    }
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        /* Siconos tells of its troubles at length, and leaves by exit or abort. */
        if (freopen("/dev/null", "w", stdout) && freopen("/dev/null", "w", stderr)) {
            repeat(m, given, tolerance, limit, found);
        }
        _exit(0);
    }
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
        continue;
    }
    if (found->done) {
        out.seconds = found->seconds;
        out.error = found->error;
    }
    munmap(found, sizeof *found);
    return out;
}

/* The first run that meets the goal; infinite seconds, if none does. */
static outcome time_to(const method *m, const problem *given, double goal, unsigned limit)
{
    const outcome none = {HUGE_VAL, HUGE_VAL};
    double tolerance = goal;
    for (int i = 0; i < (m->tightening > 0.0 ? TIGHTENINGS : 1); i++) {
        const outcome got = measure(m, given, tolerance, limit);
        if (got.error <= goal) {
            return got;
        }
        if (got.seconds == HUGE_VAL) {
            break; /* stopped, or failed: a tighter tolerance will be no better */
        }
        tolerance *= m->tightening;
    }
    return none;
}

/* ---- all problems ------------------------------------------------------------------------- */

typedef struct record {
    char file[NAME];
    unsigned contacts;
    double recorded[GOALS]; /* seconds of the best of 44; infinite: none */
    outcome found[METHODS][GOALS];
} record;

/* A time as the collection writes it, "4.7e-02 prox_fb", or "-". */
static double recorded_time(const char *field)
{
    char *end = NULL;
    const double seconds = strtod(field, &end);
    return end == field ? HUGE_VAL : seconds;
}

/* Fields: file, format, contacts, rank, rows, condition, mu, then times to 1e-3, 1e-6, 1e-9... */
static size_t read_manifest(const char *data, record *records)
{
    char path[4096];
    char line[1024];
    size_t count = 0;
    snprintf(path, sizeof path, "%s/fc/MANIFEST.tsv", data);
    FILE *stream = fopen(path, "r");
    while (stream && count < PROBLEMS && fgets(line, sizeof line, stream)) {
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
            record *r = &records[count++];
            memset(r, 0, sizeof *r);
            snprintf(r->file, sizeof r->file, "%.*s", NAME - 1, fields[0]);
            r->contacts = (unsigned)atoi(fields[2]);
            r->recorded[0] = recorded_time(fields[8]);
            r->recorded[1] = recorded_time(fields[9]);
        }
    }
    if (stream) {
        fclose(stream);
    }
    return count;
}

static void print_head(void)
{
    printf("%-34s %5s %6s", "problem", "cont.", "goal");
    for (int m = 0; m < METHODS; m++) {
        printf("  %12s %7s", methods[m].name, "E_inv");
    }
    printf("  %8s", "best/44");
    for (int m = 1; m < METHODS; m++) {
        printf("  /%s", methods[m].name);
    }
    printf("  /best44\n");
}

static void print_ratio(double seconds, double other, int width)
{
    if (seconds == HUGE_VAL) {
        printf("  %*s", width, "not met");
    } else if (other == HUGE_VAL) {
        printf("  %*s", width, "only");
    } else {
        printf("  %*.3f", width, seconds / other);
    }
}

static void print_row(const record *r, int goal)
{
    printf("%-34.34s %5u %6.0e", r->file, r->contacts, goals[goal]);
    for (int m = 0; m < METHODS; m++) {
        const outcome *o = &r->found[m][goal];
        if (o->seconds == HUGE_VAL) {
            printf("  %12s %7s", "-", "");
        } else {
            printf("  %10.3f ms %7.0e", 1e3 * o->seconds, o->error);
        }
    }
    printf("  %5.2f ms", 1e3 * r->recorded[goal]);
    for (int m = 1; m < METHODS; m++) {
        print_ratio(r->found[0][goal].seconds, r->found[m][goal].seconds,
                    (int)strlen(methods[m].name) + 1);
    }
    print_ratio(r->found[0][goal].seconds, r->recorded[goal], 7);
    putchar('\n');
}

/* Seconds of a curve: a method, or what is recorded. */
static double seconds_of(const record *r, int curve, int goal)
{
    return curve < METHODS ? r->found[curve][goal].seconds : r->recorded[goal];
}

static const char *name_of(int curve)
{
    return curve < METHODS ? methods[curve].name : "best of 44, recorded";
}

static void print_means(const record *records, size_t count, int goal)
{
    for (int curve = 0; curve < CURVES; curve++) {
        size_t met = 0;
        size_t both = 0;
        double sum = 0.0;
        for (size_t i = 0; i < count; i++) {
            const double mine = seconds_of(&records[i], 0, goal);
            const double other = seconds_of(&records[i], curve, goal);
            met += other < HUGE_VAL;
            both += mine < HUGE_VAL && other < HUGE_VAL;
            sum += mine < HUGE_VAL && other < HUGE_VAL ? log(mine / other) : 0.0;
        }
        printf("  to %.0e: %-22s meets %2zu of %zu", goals[goal], name_of(curve), met, count);
        if (curve > 0 && both > 0) {
            printf("; tribo takes %.3f of its time (geometric mean of %zu)",
                   exp(sum / (double)both), both);
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
static void put_profile(FILE *gnuplot, const record *records, size_t count, int curve, int goal)
{
    double ratios[PROBLEMS];
    for (size_t i = 0; i < count; i++) {
        double best = HUGE_VAL;
        for (int c = 0; c < CURVES; c++) {
            best = fmin(best, seconds_of(&records[i], c, goal));
        }
        ratios[i] = best < HUGE_VAL ? seconds_of(&records[i], curve, goal) / best : HUGE_VAL;
    }
    qsort(ratios, count, sizeof *ratios, compare);
    fprintf(gnuplot, "$curve%d << END\n1 0\n", curve);
    size_t met = 0;
    for (; met < count && ratios[met] < HUGE_VAL; met++) {
        fprintf(gnuplot, "%.6g %.6g\n", ratios[met], (double)(met + 1) / (double)count);
    }
    fprintf(gnuplot, "1e9 %.6g\nEND\n", (double)met / (double)count);
}

static void plot_profile(const char *folder, const record *records, size_t count, int goal)
{
    static const char *const colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000"};
    FILE *gnuplot = popen("LC_ALL=C.UTF-8 gnuplot", "w");
    if (!gnuplot) {
        perror("gnuplot");
        return;
    }
    fprintf(gnuplot,
            "set encoding utf8\nset terminal svg size 900,560 dynamic enhanced"
            " font 'Helvetica,15' background '#ffffff'\nset output '%s/siconos-%.0e.svg'\n"
            "set border linecolor '#444444'\nset grid linecolor '#dddddd'\nset logscale x\n"
            "set xrange [1:1e5]\nset yrange [0:1.03]\nset key right bottom\n"
            "set format x '10^{%%T}'\nset xlabel 'time over that of the fastest'\n"
            "set ylabel 'share of the problems that are solved'\n"
            "set title '%zu recorded problems to E_{inv} = %.0e'\n",
            folder, goals[goal], count, goals[goal]);
    for (int curve = 0; curve < CURVES; curve++) {
        put_profile(gnuplot, records, count, curve, goal);
    }
    for (int curve = 0; curve < CURVES; curve++) {
        const int last = curve == CURVES - 1;
        fprintf(gnuplot,
                "%s $curve%d using 1:2 with steps linewidth %d linecolor '%s' dashtype %d"
                " title '%s' noenhanced%s",
                curve == 0 ? "plot" : "", curve, curve == 0 ? 4 : 2, colours[last ? 4 : curve],
                last ? 2 : 1, name_of(curve), last ? "\n" : ",");
    }
    if (pclose(gnuplot) == 0) {
        printf("  profile: %s/siconos-%.0e.svg\n", folder, goals[goal]);
    }
}

/* ---- the bench ---------------------------------------------------------------------------- */

static int run_problem(const char *data, record *r, unsigned limit)
{
    char path[4096];
    problem given;
    snprintf(path, sizeof path, "%s/fc/%s", data, r->file);
    if (problem_read(path, &given) != 0) {
        return 1;
    }
    for (int goal = 0; goal < GOALS; goal++) {
        for (int m = 0; m < METHODS; m++) {
            r->found[m][goal] = time_to(&methods[m], &given, goals[goal], limit);
        }
        print_row(r, goal);
    }
    problem_free(&given);
    return 0;
}

static void summarise(const char *program, const record *records, size_t count)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", program);
    char *slash = strrchr(folder, '/');
    snprintf(slash ? slash : folder, 2, "%s", slash ? "" : ".");
    for (int goal = 0; goal < GOALS; goal++) {
        print_means(records, count, goal);
        if (system("command -v gnuplot >/dev/null 2>&1") == 0) {
            plot_profile(folder, records, count, goal);
        }
    }
}

int main(int argc, char **argv)
{
    static record records[PROBLEMS];
    const char *data = getenv("TRIBO_DATA");
    const unsigned limit = argc > 1 ? (unsigned)atoi(argv[1]) : 20;
    int failed = 0;
    if (!data || !*data) {
        puts("siconos: skipped, TRIBO_DATA does not name a folder with recorded problems");
        return 0;
    }
    /* The BLAS beneath Siconos reads this when it is loaded. */
    if (!getenv("OPENBLAS_NUM_THREADS") && setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0) {
        execv(argv[0], argv);
    }
    const size_t count = read_manifest(data, records);
    printf("\nRecorded problems of more than %d contacts, time to E_inv; a solve has %u s\n",
           (int)CONTACTS_ABOVE, limit);
    if (METHODS == 1) {
        puts("siconos: its solvers are skipped, they were not there when this was built");
    }
    print_head();
    for (size_t i = 0; i < count; i++) {
        failed |= run_problem(data, &records[i], limit);
    }
    summarise(argv[0], records, count);
    return failed;
}
