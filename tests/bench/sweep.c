/* Nanoseconds per contact and sweep of Gauss-Seidel with the exact local solve, by instruction set,
 * threads and working set, and how far the sweeps get: greatest eta after 10 and 100 of them, by
 * the library's certificate, which the tests compare with quad precision.
 *
 *   sweep [--full] [CONTACTS]     greatest number of contacts (100000; --full: 1000000)
 *
 * Timed sweeps go on from ten that were done before, so that roots of slips are known, as they are
 * in any but the first sweeps; the start of each run (bodies' velocities from the impulses) is in
 * the figure. One thread is timed by its own clock; two by that of the wall, each kept to one
 * processor (on Linux), a task of each colour for either. Where other programs run, their figure is
 * an upper bound: `cores` says how many processors the rounds were given, 2 if there are no
 * others. */
#define _GNU_SOURCE /* of POSIX.1-2008: threads, clocks; besides: CPU_SET */

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/coupled.h"
#include "certificate.h"
#include "full.h"
#include "sweep.h"

enum { LEAST_ROUNDS = 3, ROUNDS = 64, SPINS = 1000000 };

static const double budget = 1e8; /* ns of rounds for each row */
static int differs;               /* a row gave other bits */

/* ---- two threads ----------------------------------------------------------------------------- */

/* Work of one call, shared between the caller, which takes tasks from the first on, and one helper,
 * which takes them from the last on: so a thread meets the same contacts in each sweep.
 *
 * `ticket` holds the number of the call and how many tasks are left between the two ends. A thread
 * takes a task by changing the ticket that it read before it read the rest, which is written while
 * no tasks are left. So the caller need not wait for a helper that came too late, or that the
 * system has put aside: it does all tasks itself. */
static struct {
    uint64_t ticket;                      /* atomic: call << 32 | first << 16 | end */
    uint32_t left;                        /* atomic: tasks that are not done */
    uint32_t here;                        /* atomic: the helper has begun */
    uint32_t over;                        /* atomic */
    void (*task)(void *data, uint32_t i); /* these two: atomic */
    void *data;
} shared;

static void pause_spinning(uint32_t *spins)
{
    if (++*spins > SPINS) {
        sched_yield();
    }
}

/* Do one task, if there is one. */
static int work(int from_end)
{
    uint64_t ticket = __atomic_load_n(&shared.ticket, __ATOMIC_ACQUIRE);
    const uint32_t first = (uint32_t)(ticket >> 16) & 0xffffu;
    const uint32_t end = (uint32_t)ticket & 0xffffu;
    void (*const task)(void *, uint32_t) = __atomic_load_n(&shared.task, __ATOMIC_RELAXED);
    void *const data = __atomic_load_n(&shared.data, __ATOMIC_RELAXED);
    if (first == end) {
        return 0;
    }
    const uint64_t rest = from_end ? ticket - 1 : ticket + 0x10000u;
    if (__atomic_compare_exchange_n(&shared.ticket, &ticket, rest, 0, __ATOMIC_ACQ_REL,
                                    __ATOMIC_RELAXED)) {
        task(data, from_end ? end - 1 : first);
        __atomic_fetch_sub(&shared.left, 1, __ATOMIC_RELEASE);
    }
    return 1;
}

static void *help(void *unused)
{
    uint32_t spins = 0;
    __atomic_store_n(&shared.here, 1, __ATOMIC_RELEASE);
    while (!__atomic_load_n(&shared.over, __ATOMIC_ACQUIRE)) {
        if (work(1)) {
            spins = 0;
        } else {
            pause_spinning(&spins);
        }
    }
    return unused;
}

static void parallel(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    const uint64_t call = (__atomic_load_n(&shared.ticket, __ATOMIC_RELAXED) >> 32) + 1;
    uint32_t spins = 0;
    (void)user;
    __atomic_store_n(&shared.task, task, __ATOMIC_RELAXED);
    __atomic_store_n(&shared.data, data, __ATOMIC_RELAXED);
    __atomic_store_n(&shared.left, count, __ATOMIC_RELAXED);
    __atomic_store_n(&shared.ticket, call << 32 | count, __ATOMIC_RELEASE);
    while (work(0)) {
        continue;
    }
    while (__atomic_load_n(&shared.left, __ATOMIC_ACQUIRE) > 0) {
        pause_spinning(&spins);
    }
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* Bricks that stay: nearly all contacts stick. */
static void make_sticking(systems_scene *out, size_t contacts)
{
    const size_t rows = contacts < 1000 ? 4 : contacts < 100000 ? 10 : 20;
    const size_t columns = contacts / (8 * rows);
    systems_wall(out, columns > 0 ? columns : 1, rows, 0);
}

/* The same with rows that go to the left and to the right. */
static void make_sliding(systems_scene *out, size_t contacts)
{
    make_sticking(out, contacts);
    for (size_t i = 0; i < out->body_count; i++) {
        tribo_body *body = &out->bodies[i];
        const double row = floor(body->position[2]);
        body->velocity[0] += body->inverse_mass > 0.0 ? 10.0 * cos(acos(-1.0) * row) : 0.0;
    }
    for (size_t c = 0; c < out->count; c++) {
        out->contacts[c].pair.mu_s = out->contacts[c].pair.mu_d = 0.1;
    }
}

/* Spheres with noise in their velocities: contacts that open, stick and slip. */
static void make_mixed(systems_scene *out, size_t contacts)
{
    systems_rubble(out, (size_t)(cbrt((double)contacts / 2.0) + 1.0), 1);
}

static void make_frictionless(systems_scene *out, size_t contacts)
{
    make_sticking(out, contacts);
    for (size_t c = 0; c < out->count; c++) {
        out->contacts[c].dimension = 1;
    }
}

/* ---- measuring ------------------------------------------------------------------------------- */

static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void need(int have, const char *what)
{
    if (!have) {
        fprintf(stderr, "sweep: no %s\n", what);
        exit(1);
    }
}

static void *allocate(size_t bytes)
{
    void *memory = calloc(bytes > 0 ? bytes : 1, 1);
    need(memory != NULL, "memory");
    return memory;
}

static int compare(const void *x, const void *y)
{
    const double a = *(const double *)x;
    const double b = *(const double *)y;
    return (a > b) - (a < b);
}

#ifdef __linux__

static cpu_set_t allowed; /* to the caller before it was kept to one */

/* Keep a thread to the processor of that number among those allowed. */
static void pin(pthread_t thread, int number)
{
    cpu_set_t one;
    int cpu = 0;
    CPU_ZERO(&one);
    for (int found = -1; cpu < CPU_SETSIZE && found < number; cpu++) {
        found += CPU_ISSET((size_t)cpu, &allowed) ? 1 : 0;
    }
    CPU_SET((size_t)(cpu - 1), &one);
    pthread_setaffinity_np(thread, sizeof one, &one);
}

static void pin_both(pthread_t helper)
{
    pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed);
    if (CPU_COUNT(&allowed) > 1) {
        pin(helper, 1);
        pin(pthread_self(), 0);
    }
}

static void unpin(void)
{
    pthread_setaffinity_np(pthread_self(), sizeof allowed, &allowed);
}

#else

static void pin_both(pthread_t helper)
{
    (void)helper;
}

static void unpin(void)
{
}

#endif

static pthread_t start_helper(void)
{
    pthread_t helper;
    __atomic_store_n(&shared.here, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&shared.over, 0, __ATOMIC_RELEASE);
    need(pthread_create(&helper, NULL, help, NULL) == 0, "second thread");
    pin_both(helper);
    while (!__atomic_load_n(&shared.here, __ATOMIC_ACQUIRE)) {
        sched_yield();
    }
    return helper;
}

static void stop_helper(pthread_t helper)
{
    __atomic_store_n(&shared.over, 1, __ATOMIC_RELEASE);
    need(pthread_join(helper, NULL) == 0, "end of the second thread");
    unpin();
}

static void do_nothing(void *data, uint32_t i)
{
    (void)data;
    (void)i;
}

/* What a call costs whose tasks are empty. */
static void print_call(void)
{
    enum { CALLS = 20000 };
    double ns[ROUNDS];
    const pthread_t helper = start_helper();
    for (int i = 0; i < ROUNDS; i++) {
        const double before = now(CLOCK_MONOTONIC);
        for (int k = 0; k < CALLS; k++) {
            parallel(NULL, do_nothing, NULL, 2);
        }
        ns[i] = (now(CLOCK_MONOTONIC) - before) / (double)CALLS;
    }
    stop_helper(helper);
    qsort(ns, ROUNDS, sizeof *ns, compare);
    printf("Two threads: a call with two empty tasks takes %.0f ns (median; least %.0f)\n",
           ns[ROUNDS / 2], ns[0]);
}

typedef struct row {
    double median, least; /* ns per contact and sweep */
    double cores;         /* processors that were given, waiting in a loop included */
} row;

static row measure(sweep *s, size_t count, uint32_t threads, const double *start, double *r,
                   double *first)
{
    const size_t bytes = 3 * count * sizeof *r;
    const clockid_t clock = threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    const uint32_t sweeps = count < 2000 ? 200 : count < 20000 ? 20 : count < 200000 ? 5 : 3;
    const pthread_t helper = threads > 1 ? start_helper() : pthread_self();
    const double begun = now(CLOCK_MONOTONIC);
    const double used = now(CLOCK_PROCESS_CPUTIME_ID);
    double ns[ROUNDS];
    row out;
    int rounds = 0;
    while (rounds < LEAST_ROUNDS || (rounds < ROUNDS && now(CLOCK_MONOTONIC) - begun < budget)) {
        memcpy(r, start, bytes);
        const double before = now(clock);
        sweep_run(s, sweeps, r, NULL, threads > 1 ? parallel : NULL, NULL, threads);
        ns[rounds++] = (now(clock) - before) / (double)sweeps / (double)count;
        if (rounds == 1) {
            memcpy(first, r, bytes); /* later rounds start from other roots */
        }
    }
    out.cores = (now(CLOCK_PROCESS_CPUTIME_ID) - used) / (now(CLOCK_MONOTONIC) - begun);
    if (threads > 1) {
        stop_helper(helper);
    }
    qsort(ns, (size_t)rounds, sizeof *ns, compare);
    out.median = ns[rounds / 2];
    out.least = ns[0];
    return out;
}

/* Greatest eta. */
static double judge(const system_problem *problem, const double *r)
{
    tribo_system_info info = {.struct_size = sizeof info};
    double *dv = allocate(6 * (size_t)problem->bodies * sizeof *dv);
    double *scratch = allocate(6 * (size_t)problem->bodies * sizeof *scratch);
    double *u = allocate(3 * (size_t)problem->count * sizeof *u);
    certificate_velocity(problem, r, dv, u);
    certificate_write(problem, r, u, scratch, &info);
    free(dv);
    free(scratch);
    free(u);
    return info.eta;
}

/* Shares of contacts that are open, stick and slip. */
static void count_modes(const coupled *c, const double *r, double shares[3])
{
    shares[0] = shares[1] = shares[2] = 0.0;
    for (size_t i = 0; i < c->problem.count; i++) {
        const double *p = r + 3 * i;
        const double limit = c->problem.mu[2 * i + 1] * p[0];
        const int slips = hypot(p[1], p[2]) >= limit * (1.0 - 1e-9);
        shares[!(p[0] > 0.0) ? 0 : slips ? 2 : 1] += 100.0 / (double)c->problem.count;
    }
}

/* What all rows of a scene have in common. */
typedef struct ground {
    const char *name;
    size_t bodies;
    coupled c;
    double *start; /* impulses after ten sweeps */
    double *end;   /* after the first row's first round */
    double shares[3], eta[2];
} ground;

static void print_row(const ground *g, uint32_t isa, uint32_t threads, double prepare,
                      const row *measured)
{
    const double count = (double)g->c.problem.count;
    printf("%-12s %8.0f %9.0f  %3.0f %3.0f %3.0f  %-9s %u %7.1f %7.1f %5.2f %8.1f  %8.1e %8.1e\n",
           g->name, count, (368.0 * count + 64.0 * (double)g->bodies) / 1024.0, g->shares[0],
           g->shares[1], g->shares[2], tribo_isa_name(isa), threads, measured->median,
           measured->least, measured->cores, prepare, g->eta[0], g->eta[1]);
    fflush(stdout);
}

static void run_row(const ground *g, uint32_t isa, uint32_t threads, double *r)
{
    const system_problem *problem = &g->c.problem;
    const size_t bytes = 3 * (size_t)problem->count * sizeof *r;
    void *memory = allocate(sweep_size(problem->count, problem->bodies, 0));
    double *first = allocate(bytes);
    const double begun = now(CLOCK_THREAD_CPUTIME_ID);
    sweep *s = sweep_prepare(problem, isa, memory);
    const double prepare = (now(CLOCK_THREAD_CPUTIME_ID) - begun) / (double)problem->count;
    const row measured = measure(s, problem->count, threads, g->start, r, first);
    print_row(g, isa, threads, prepare, &measured);
    if (isa == TRIBO_ISA_SCALAR) {
        memcpy(g->end, first, bytes);
    } else if (memcmp(g->end, first, bytes) != 0) {
        printf("NOT the bits of the scalar form in one thread\n");
        differs = 1;
    }
    free(first);
    free(memory);
}

static void run_scene(const char *name, void (*make)(systems_scene *out, size_t contacts),
                      size_t contacts)
{
    systems_scene scene;
    ground g = {.name = name};
    make(&scene, contacts);
    coupled_of_scene(&scene, &g.c);
    g.bodies = scene.body_count;
    const system_problem *problem = &g.c.problem;
    const size_t bytes = 3 * scene.count * sizeof(double);
    double *r = allocate(bytes);
    void *memory = allocate(sweep_size(problem->count, problem->bodies, 0));
    sweep *s = sweep_prepare(problem, TRIBO_ISA_BEST, memory);
    sweep_run(s, 10, r, NULL, NULL, NULL, 1);
    g.start = allocate(bytes);
    g.end = allocate(bytes);
    memcpy(g.start, r, bytes);
    count_modes(&g.c, r, g.shares);
    g.eta[0] = judge(problem, r);
    sweep_run(s, 90, r, NULL, NULL, NULL, 1);
    g.eta[1] = judge(problem, r);
    free(memory);
    for (uint32_t isa = TRIBO_ISA_SCALAR; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        if (tribo_isa_available(isa)) {
            run_row(&g, isa, 1, r);
        }
        /* the scalar form is there to compare with */
        if (tribo_isa_available(isa) && isa != TRIBO_ISA_SCALAR) {
            run_row(&g, isa, 2, r);
        }
    }
    free(r);
    free(g.start);
    free(g.end);
    coupled_free(&g.c);
    systems_free(&scene);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*make)(systems_scene *out, size_t contacts);
    } scenes[] = {{"sticking", make_sticking},
                  {"sliding", make_sliding},
                  {"mixed", make_mixed},
                  {"frictionless", make_frictionless}};
    const int full = take_full(&argc, argv);
    const double most = argc > 1 ? atof(argv[1]) : full ? 1e6 : 1e5;
    printf("Gauss-Seidel, exact cone, doubles; ns per contact and sweep. Published for comparison: "
           "Box3D, 25 ns per\npoint and sub-step, normal and lumped friction, floats, 4 lanes.\n"
           "KiB: contacts and bodies in a sweep; %%: contacts that are open, stick, slip after 10 "
           "sweeps; eta: the greatest, after 10 and 100 sweeps\n");
    print_call();
    printf("%-12s %8s %9s  %3s %3s %3s  %-9s T %7s %7s %5s %8s  %8s %8s\n", "scene", "contacts",
           "KiB", "op", "st", "sl", "ISA", "median", "least", "cores", "prepare", "eta 10",
           "eta 100");
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        for (double contacts = 100.0; contacts <= most; contacts *= 10.0) {
            run_scene(scenes[k].name, scenes[k].make, (size_t)contacts);
        }
    }
    return differs;
}
