/* Nanoseconds per contact and sweep of Gauss-Seidel with the exact local solve, by instruction set,
 * threads and working set, and how far the sweeps get: greatest eta after 10 and 100 of them.
 *
 * Timed sweeps go on from ten that were done before, so that roots of slips are known, as they are
 * in any but the first sweeps; the start of each run (bodies' velocities from the impulses) is in
 * the figure. One thread is timed by its own clock, two by that of the wall. Nothing is pinned. */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/coupled.h"
#include "../support/quad_system.h"
#include "sweep.h"

enum { ROUNDS = 7, JUDGED = 200000, SPINS = 4000 };

/* ---- two threads ----------------------------------------------------------------------------- */

/* Work of one call, shared between the caller and one helper. */
static struct {
    void (*task)(void *data, uint32_t i);
    void *data;
    uint32_t count;
    uint32_t next, done; /* atomic */
    uint32_t round;      /* atomic: counts the calls; the helper waits for the next */
    uint32_t over;       /* atomic */
    uint32_t idle;       /* atomic: the helper is not at work */
} shared;

static void pause_spinning(uint32_t *spins)
{
    if (++*spins > SPINS) {
        sched_yield();
    }
}

static void work(void)
{
    uint32_t i = __atomic_fetch_add(&shared.next, 1, __ATOMIC_ACQ_REL);
    while (i < shared.count) {
        shared.task(shared.data, i);
        __atomic_fetch_add(&shared.done, 1, __ATOMIC_ACQ_REL);
        i = __atomic_fetch_add(&shared.next, 1, __ATOMIC_ACQ_REL);
    }
}

static void *help(void *unused)
{
    uint32_t seen = 0;
    uint32_t spins = 0;
    while (!__atomic_load_n(&shared.over, __ATOMIC_ACQUIRE)) {
        const uint32_t now = __atomic_load_n(&shared.round, __ATOMIC_ACQUIRE);
        if (now == seen) {
            pause_spinning(&spins);
            continue;
        }
        spins = 0;
        seen = now;
        work();
        __atomic_store_n(&shared.idle, 1, __ATOMIC_RELEASE);
    }
    return unused;
}

/* Until the helper is idle again, too: it must not see the next call's task with this one's
 * count. */
static void parallel(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    uint32_t spins = 0;
    (void)user;
    shared.task = task;
    shared.data = data;
    shared.count = count;
    __atomic_store_n(&shared.next, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&shared.done, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&shared.idle, 0, __ATOMIC_RELEASE);
    __atomic_fetch_add(&shared.round, 1, __ATOMIC_ACQ_REL);
    work();
    while (__atomic_load_n(&shared.done, __ATOMIC_ACQUIRE) < count ||
           !__atomic_load_n(&shared.idle, __ATOMIC_ACQUIRE)) {
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
    systems_pile(out, (size_t)(cbrt((double)contacts / 2.0) + 1.0), 1);
}

static void make_frictionless(systems_scene *out, size_t contacts)
{
    make_sticking(out, contacts);
    for (size_t c = 0; c < out->count; c++) {
        out->contacts[c].dimension = 1;
    }
}

/* ---- measuring ------------------------------------------------------------------------------- */

static double now(uint32_t threads)
{
    struct timespec t;
    clock_gettime(threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &t);
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

typedef struct row {
    double median, least, prepare; /* ns per contact */
} row;

static row measure(const coupled *c, uint32_t isa, uint32_t threads, const double *start)
{
    const size_t count = c->problem.count;
    const size_t bytes = 3 * count * sizeof(double);
    const uint32_t sweeps = count < 2000 ? 200 : count < 200000 ? 20 : 5;
    const int rounds = count < 200000 ? ROUNDS : 3;
    void *memory = allocate(sweep_size(c->problem.count, c->problem.bodies));
    double *r = allocate(bytes);
    double ns[ROUNDS];
    pthread_t helper;
    row out;
    const double begun = now(1);
    sweep *s = sweep_prepare(&c->problem, isa, memory);
    out.prepare = (now(1) - begun) / (double)count;
    memcpy(r, start, bytes);
    sweep_run(s, 1, r, NULL, NULL, NULL, 1);
    if (threads > 1) {
        __atomic_store_n(&shared.round, 0, __ATOMIC_RELEASE);
        __atomic_store_n(&shared.over, 0, __ATOMIC_RELEASE);
        need(pthread_create(&helper, NULL, help, NULL) == 0, "second thread");
    }
    for (int i = 0; i < rounds; i++) {
        memcpy(r, start, bytes);
        const double before = now(threads);
        sweep_run(s, sweeps, r, NULL, threads > 1 ? parallel : NULL, NULL, threads);
        ns[i] = (now(threads) - before) / (double)sweeps / (double)count;
    }
    if (threads > 1) {
        __atomic_store_n(&shared.over, 1, __ATOMIC_RELEASE);
        need(pthread_join(helper, NULL) == 0, "end of the second thread");
    }
    qsort(ns, (size_t)rounds, sizeof *ns, compare);
    out.median = ns[rounds / 2];
    out.least = ns[0];
    free(memory);
    free(r);
    return out;
}

/* Greatest eta as text; none of very large systems, for it is summed in quadruple precision. */
static void judge(const systems_scene *scene, const double *r, char out[16])
{
    quad_certificate judged;
    if (scene->count > JUDGED) {
        memcpy(out, "-", 2);
        return;
    }
    quad_certificate_of_bodies(scene->body_count, scene->bodies, scene->count, scene->contacts, r,
                               NULL, &judged);
    snprintf(out, 16, "%.1e", judged.eta);
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

static void run_scene(const char *name, void (*make)(systems_scene *out, size_t contacts),
                      size_t contacts)
{
    systems_scene scene;
    coupled c;
    double shares[3];
    make(&scene, contacts);
    coupled_of_scene(&scene, &c);
    char eta[2][16];
    double *r = allocate(3 * scene.count * sizeof *r);
    void *memory = allocate(sweep_size(c.problem.count, c.problem.bodies));
    sweep *s = sweep_prepare(&c.problem, TRIBO_ISA_BEST, memory);
    sweep_run(s, 10, r, NULL, NULL, NULL, 1);
    double *start = allocate(3 * scene.count * sizeof *start);
    memcpy(start, r, 3 * scene.count * sizeof *r);
    judge(&scene, r, eta[0]);
    count_modes(&c, r, shares);
    sweep_run(s, scene.count > JUDGED ? 0 : 90, r, NULL, NULL, NULL, 1);
    judge(&scene, r, eta[1]);
    free(memory);
    for (uint32_t isa = TRIBO_ISA_SCALAR; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        for (uint32_t threads = 1; threads <= 2 && tribo_isa_available(isa); threads++) {
            const row measured = measure(&c, isa, threads, start);
            printf("%-12s %8zu %9.0f  %3.0f %3.0f %3.0f  %-9s %u %7.1f %7.1f %8.1f  %8s %8s\n",
                   name, scene.count,
                   (368.0 * (double)scene.count + 64.0 * (double)scene.body_count) / 1024.0,
                   shares[0], shares[1], shares[2], tribo_isa_name(isa), threads, measured.median,
                   measured.least, measured.prepare, eta[0], eta[1]);
            fflush(stdout);
        }
    }
    free(r);
    free(start);
    coupled_free(&c);
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
    const double most = argc > 1 ? atof(argv[1]) : 1e6;
    printf("Gauss-Seidel, exact cone, doubles; ns per contact and sweep. Published for comparison: "
           "Box3D, 25 ns per\npoint and sub-step, normal and lumped friction, floats, 4 lanes.\n"
           "KiB: contacts and bodies in a sweep; %%: contacts that are open, stick, slip after 10 "
           "sweeps; eta: the greatest, after 10 and 100 sweeps\n");
    printf("%-12s %8s %9s  %3s %3s %3s  %-9s T %7s %7s %8s  %8s %8s\n", "scene", "contacts", "KiB",
           "op", "st", "sl", "ISA", "median", "least", "prepare", "eta 10", "eta 100");
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        for (double contacts = 100.0; contacts <= most; contacts *= 10.0) {
            run_scene(scenes[k].name, scenes[k].make, (size_t)contacts);
        }
    }
    return 0;
}
