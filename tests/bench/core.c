/* Nanoseconds per call against error: the core's kernels, scalar and in lanes, and peers that solve
 * the same contacts, all in one run.
 *
 * Every kernel works on flat arrays that fit the second-level cache. Before each timed pass the
 * problems are shuffled into an order that has not been seen before, so that branch predictors
 * learn shares and not sequences. Calls are independent of each other: the figure is throughput.
 * Kernels take turns; the clock is that of the thread. Nothing is pinned. */
#define _POSIX_C_SOURCE 200809L

#include <tribo/tribo.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/peers.h"
#include "../support/problems.h"
#include "../support/quad.h"
#include "../support/routh_truth.h"

enum {
    SEED = 20160603,
    CONTACTS = 4096, /* 4096 (W, b, mu, p) are 448 KiB */
    PAIRS = 1024,    /* 1024 colliding pairs are 424 KiB */
    ROUNDS = 15,
    TRUTHS = 512, /* problems with a quad-precision truth */
    MAX_ROWS = 96
};

static const double failed = 1e-9; /* eta beyond which a solution counts as none */

/* ---- data ------------------------------------------------------------------------------------ */

/* Problems in a fixed order, and what is known of them. */
typedef struct problem_set {
    const char *name;
    problem_local *local;
    problem_impact *impact;
    quad_solutions *truth; /* of the first TRUTHS */
    double *condition;
} problem_set;

static problem_collision collisions[PAIRS];

/* The arrays that are timed, shuffled: order[i] is the number of the problem at place i. */
static size_t order[CONTACTS];
static double w[6 * CONTACTS];
static double general[2][9 * CONTACTS]; /* W row by row, and the same made unsymmetric */
static double b[3 * CONTACTS];
static double mu[2 * CONTACTS];
static double p[3 * CONTACTS];
static tribo_material materials[CONTACTS];
static tribo_body bodies[2 * PAIRS];
static uint32_t body_pairs[2 * PAIRS];
static tribo_contact contacts[PAIRS];
static double frames[9 * PAIRS];

/* ---- rows ------------------------------------------------------------------------------------ */

typedef struct row row;
struct row {
    const char *kernel;
    const char *isa_name;
    const problem_set *set; /* null: collisions */
    void (*load)(void);
    void (*run)(const row *self);
    void (*judge)(row *self);
    uint32_t isa;
    uint32_t variant; /* law, peer, or which of `general` */
    size_t count;
    size_t width; /* doubles per result in `out` */
    const double *result;
    double *out; /* results of the last pass, in the order of the set */
    double ns[ROUNDS];
    double median_ns, least_ns, ratio;
    double eta_median, eta_worst, failures; /* negative: not defined */
    double forward_median, forward_worst;   /* in `unit`; negative: not defined */
    const char *unit;
};

static row rows[MAX_ROWS];
static size_t row_count;
static const problem_set *loading; /* the set that `load` takes */

static int compare_doubles(const void *x, const void *y)
{
    const double a = *(const double *)x;
    const double c = *(const double *)y;
    return (a > c) - (a < c);
}

static double median(size_t count, double *values, double *greatest)
{
    if (count == 0) {
        return -1.0;
    }
    qsort(values, count, sizeof *values, compare_doubles);
    *greatest = values[count - 1];
    return values[count / 2];
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---- loading: untimed ------------------------------------------------------------------------ */

static void shuffle(size_t count, problem_random *random)
{
    for (size_t i = 0; i < count; i++) {
        order[i] = i;
    }
    for (size_t i = count - 1; i > 0; i--) {
        const size_t j = (size_t)(problem_random_bits(random) % (i + 1));
        const size_t other = order[j];
        order[j] = order[i];
        order[i] = other;
    }
}

/* W row by row, with an antisymmetric part of 1e-3 if `skewed`: recorded problems have up to that of
 * gyroscopic terms. */
static void fill_general(const double packed[6], uint32_t skewed, double out[9])
{
    static const size_t entry[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (size_t i = 0; i < 9; i++) {
        out[i] = packed[entry[i]];
    }
    for (size_t i = 0; i < 3 && skewed != 0; i++) {
        const size_t j = (i + 1) % 3;
        const double skew = 1e-3 * sqrt(out[4 * i] * out[4 * j]);
        out[3 * i + j] += skew;
        out[3 * j + i] -= skew;
    }
}

static void load_local(void)
{
    for (size_t i = 0; i < CONTACTS; i++) {
        const problem_local *from = &loading->local[order[i]];
        memcpy(w + 6 * i, from->w, sizeof from->w);
        fill_general(from->w, 0, general[0] + 9 * i);
        fill_general(from->w, 1, general[1] + 9 * i);
        memcpy(b + 3 * i, from->b, sizeof from->b);
        mu[2 * i] = mu[2 * i + 1] = from->mu;
    }
    memset(p, 0, sizeof p);
}

static void load_impacts(void)
{
    for (size_t i = 0; i < CONTACTS; i++) {
        const problem_impact *from = &loading->impact[order[i]];
        memcpy(w + 6 * i, from->w, sizeof from->w);
        memcpy(b + 3 * i, from->u, sizeof from->u);
        materials[i] = from->pair;
    }
    memset(p, 0, sizeof p);
}

static void load_collisions(void)
{
    for (size_t i = 0; i < PAIRS; i++) {
        const problem_collision *from = &collisions[order[i]];
        bodies[2 * i] = from->a;
        bodies[2 * i + 1] = from->b;
        body_pairs[2 * i] = (uint32_t)(2 * i);
        body_pairs[2 * i + 1] = from->two_bodies ? (uint32_t)(2 * i + 1) : TRIBO_WORLD;
        contacts[i] = from->contact;
        materials[i] = from->pair;
        tribo_basis_from_normal(from->contact.normal, frames + 9 * i);
    }
}

/* ---- kernels: timed -------------------------------------------------------------------------- */

static void run_solve(const row *self)
{
    for (size_t i = 0; i < self->count; i++) {
        tribo_contact_solve(w + 6 * i, b + 3 * i, mu[2 * i], mu[2 * i + 1], p + 3 * i, NULL);
    }
}

static void run_general(const row *self)
{
    const double *matrices = general[self->variant];
    for (size_t i = 0; i < self->count; i++) {
        tribo_contact_solve_general(matrices + 9 * i, b + 3 * i, mu[2 * i], mu[2 * i + 1],
                                    p + 3 * i, NULL);
    }
}

static void run_batch_solve(const row *self)
{
    tribo_batch_solve(self->isa, self->count, w, b, mu, p, NULL, NULL);
}

static void run_peer(const row *self)
{
    for (size_t i = 0; i < self->count; i++) {
        peer_solve(self->variant, w + 6 * i, b + 3 * i, mu[2 * i], p + 3 * i);
    }
}

static void run_impact(const row *self)
{
    tribo_impact_options options = {0};
    options.struct_size = sizeof options;
    options.law = self->variant;
    for (size_t i = 0; i < self->count; i++) {
        tribo_impact(w + 6 * i, b + 3 * i, &materials[i], &options, p + 3 * i, NULL);
    }
}

static void run_batch_impact(const row *self)
{
    tribo_batch_impact(self->isa, self->count, w, b, materials, p, NULL, NULL);
}

static void run_project(const row *self)
{
    for (size_t i = 0; i < self->count; i++) {
        tribo_cone_project(b + 3 * i, mu[2 * i], p + 3 * i);
    }
}

static tribo_body *second_body(size_t i)
{
    return body_pairs[2 * i + 1] == TRIBO_WORLD ? NULL : &bodies[2 * i + 1];
}

static void run_matrix(const row *self)
{
    for (size_t i = 0; i < self->count; i++) {
        tribo_contact_matrix(&bodies[2 * i], second_body(i), &contacts[i], frames + 9 * i,
                             w + 6 * i);
    }
}

static void run_basis_matrix(const row *self)
{
    for (size_t i = 0; i < self->count; i++) {
        tribo_basis_from_normal(contacts[i].normal, frames + 9 * i);
        tribo_contact_matrix(&bodies[2 * i], second_body(i), &contacts[i], frames + 9 * i,
                             w + 6 * i);
    }
}

static void run_batch_matrix(const row *self)
{
    tribo_batch_matrix(self->isa, 2 * self->count, bodies, self->count, body_pairs, contacts,
                       frames, w, NULL);
}

static void run_resolve(const row *self)
{
    tribo_impact_options options = {0};
    options.struct_size = sizeof options;
    options.law = self->variant;
    for (size_t i = 0; i < self->count; i++) {
        tribo_contact_resolve(&bodies[2 * i], second_body(i), &contacts[i], &materials[i], &options,
                              NULL);
    }
}

static void run_advance(const row *self)
{
    static const double gravity[3] = {0.0, 0.0, -9.81};
    for (size_t i = 0; i < self->count; i++) {
        tribo_body_advance(&bodies[2 * i], gravity, 1.0 / 60.0);
    }
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* Point of the cone nearest to x, in place. */
static void project(long double coefficient, long double x[3])
{
    const long double radius = hypotl(x[1], x[2]);
    if (coefficient * radius <= -x[0]) {
        x[0] = x[1] = x[2] = 0.0L;
    } else if (radius > coefficient * x[0]) {
        x[0] = (x[0] + coefficient * radius) / (1.0L + coefficient * coefficient);
        x[1] *= coefficient * x[0] / radius;
        x[2] *= coefficient * x[0] / radius;
    }
}

/* As quad_eta, for the W that is not symmetric. */
static double skewed_eta(const problem_local *problem, const double impulse[3])
{
    double matrix[9];
    long double x[3];
    long double v[3];
    long double sizes[3] = {0.0L, 0.0L, 0.0L};
    long double square = 0.0L;
    fill_general(problem->w, 1, matrix);
    for (size_t i = 0; i < 3; i++) {
        v[i] = (long double)problem->b[i];
        for (size_t j = 0; j < 3; j++) {
            const long double term = (long double)matrix[3 * i + j] * (long double)impulse[j];
            v[i] += term;
            sizes[i] += fabsl(term);
        }
    }
    const long double top = (long double)fmax(fmax(matrix[0], matrix[4]), matrix[8]);
    const long double scale =
        hypotl(hypotl(sizes[0], sizes[1]), sizes[2]) + (long double)tribo_vec3_norm(problem->b);
    v[0] += (long double)problem->mu * hypotl(v[1], v[2]);
    for (size_t i = 0; i < 3; i++) {
        x[i] = (long double)impulse[i] - v[i] / (top * (long double)fmax(problem->mu, 1.0));
    }
    project((long double)problem->mu, x);
    for (size_t i = 0; i < 3; i++) {
        const long double off = x[i] - (long double)impulse[i];
        square += off * off;
    }
    return (double)(sqrtl(square) * top / scale);
}

static void judge_eta(row *self)
{
    static double etas[CONTACTS];
    size_t failures = 0;
    for (size_t i = 0; i < self->count; i++) {
        const problem_local *problem = &self->set->local[i];
        const double *impulse = self->out + 3 * i;
        const double eta = self->run == run_general && self->variant == 1
                               ? skewed_eta(problem, impulse)
                               : quad_eta(problem->w, problem->b, problem->mu, impulse);
        etas[i] = eta == eta ? eta : HUGE_VAL;
        failures += eta <= failed ? 0 : 1;
    }
    self->eta_median = median(self->count, etas, &self->eta_worst);
    self->failures = 100.0 * (double)failures / (double)self->count;
}

static void judge_solution(row *self)
{
    double errors[TRUTHS];
    judge_eta(self);
    for (size_t i = 0; i < TRUTHS; i++) {
        const double error = quad_solution_error(&self->set->truth[i], self->out + 3 * i, NULL) /
                             (DBL_EPSILON * self->set->condition[i]);
        errors[i] = error == error ? error : HUGE_VAL;
    }
    self->forward_median = median(TRUTHS, errors, &self->forward_worst);
    self->unit = "eps cond";
}

/* p = W^-1 (target - u), the target in quad precision. */
static void impulse_to(const problem_impact *problem, const quad_real target[3], quad_real out[3])
{
    quad_real wide[6];
    quad_real u[3];
    quad_widen(6, problem->w, wide);
    quad_widen(3, problem->u, u);
    for (size_t i = 0; i < 3; i++) {
        u[i] -= target[i];
    }
    quad_stick(wide, u, out);
}

static void lecture_truth(const problem_impact *problem, uint32_t law, quad_real out[3])
{
    quad_real target[3];
    quad_widen(3, problem->u, target);
    const quad_real slide = quad_sqrt(target[1] * target[1] + target[2] * target[2]);
    const quad_real close = -target[0];
    const quad_real mu_d = (quad_real)problem->pair.mu_d;
    quad_real keep = 0;
    if (slide > (quad_real)problem->pair.mu_s * close) {
        keep = 1 - mu_d * (law == TRIBO_LAW_LECTURE ? 1 : close / slide);
    }
    target[0] = (quad_real)problem->pair.e * close;
    target[1] *= keep;
    target[2] *= keep;
    impulse_to(problem, target, out);
}

static void judge_impact(row *self)
{
    double errors[TRUTHS];
    size_t count = 0;
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_impact *problem = &self->set->impact[i];
        quad_real wide[6];
        quad_real u[3];
        quad_real truth[3];
        quad_widen(6, problem->w, wide);
        quad_widen(3, problem->u, u);
        if (problem->u[0] >= 0.0) {
            continue;
        }
        if (self->variant == TRIBO_LAW_ALGEBRAIC) {
            quad_algebraic(wide, u, &problem->pair, 0.0, truth);
        } else if (self->variant == TRIBO_LAW_FRICTIONLESS) {
            quad_frictionless(wide, u, problem->pair.e, truth);
        } else {
            lecture_truth(problem, self->variant, truth);
        }
        errors[count++] = quad_relative_error(3, self->out + 3 * i, truth) /
                          (DBL_EPSILON * self->set->condition[i]);
    }
    self->forward_median = median(count, errors, &self->forward_worst);
    self->unit = "eps cond";
}

static void judge_routh(row *self)
{
    double errors[TRUTHS];
    size_t count = 0;
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_impact *problem = &self->set->impact[i];
        double truth[3];
        quad_real wide[3];
        if (problem->u[0] < 0.0 &&
            routh_truth(problem->w, problem->u, &problem->pair, self->variant, truth)) {
            quad_widen(3, truth, wide);
            errors[count++] = quad_relative_error(3, self->out + 3 * i, wide) /
                              (DBL_EPSILON * self->set->condition[i]);
        }
    }
    self->forward_median = median(count, errors, &self->forward_worst);
    self->unit = "eps cond";
}

/* COULOMB is the exact solve of ((1 + e) u_n, u_t). */
static void judge_coulomb(row *self)
{
    static double etas[CONTACTS];
    size_t count = 0;
    size_t failures = 0;
    for (size_t i = 0; i < self->count; i++) {
        const problem_impact *problem = &self->set->impact[i];
        const double *impulse = self->out + 3 * i;
        const double target[3] = {(1.0 + problem->pair.e) * problem->u[0], problem->u[1],
                                  problem->u[2]};
        const double slip = quad_eta(problem->w, target, problem->pair.mu_d, impulse);
        const double stick = quad_eta(problem->w, target, problem->pair.mu_s, impulse);
        if (problem->u[0] < 0.0) {
            etas[count++] = fmin(slip, stick);
            failures += fmin(slip, stick) <= failed ? 0 : 1;
        }
    }
    self->eta_median = median(count, etas, &self->eta_worst);
    self->failures = 100.0 * (double)failures / (double)count;
}

static void judge_project(row *self)
{
    double errors[TRUTHS];
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_local *problem = &self->set->local[i];
        long double truth[3];
        long double square = 0.0L;
        long double size = 0.0L;
        quad_project(problem->b, problem->mu, truth);
        for (size_t k = 0; k < 3; k++) {
            const long double off = (long double)self->out[3 * i + k] - truth[k];
            square += off * off;
            size += (long double)problem->b[k] * (long double)problem->b[k];
        }
        errors[i] = (double)sqrtl(square / size) / DBL_EPSILON;
    }
    self->forward_median = median(TRUTHS, errors, &self->forward_worst);
    self->unit = "eps |x|";
}

static const tribo_body *second_of(const problem_collision *collision)
{
    return collision->two_bodies ? &collision->b : NULL;
}

static void judge_matrix(row *self)
{
    double errors[TRUTHS];
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_collision *from = &collisions[i];
        quad_real truth[6];
        double frame[9];
        tribo_basis_from_normal(from->contact.normal, frame);
        quad_matrix(&from->a, second_of(from), &from->contact, frame, truth);
        errors[i] = quad_relative_error(6, self->out + 6 * i, truth) / DBL_EPSILON;
    }
    self->forward_median = median(TRUTHS, errors, &self->forward_worst);
    self->unit = "eps |W|";
}

/* Velocities after the collision against quad precision all the way from the bodies. */
static void judge_resolve(row *self)
{
    double errors[TRUTHS];
    size_t count = 0;
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_collision *from = &collisions[i];
        quad_real matrix[6];
        quad_real u[3];
        quad_real impulse[3];
        quad_real truth[6];
        double frame[9];
        tribo_basis_from_normal(from->contact.normal, frame);
        quad_matrix(&from->a, second_of(from), &from->contact, frame, matrix);
        quad_velocity(&from->a, second_of(from), &from->contact, frame, u);
        if (self->variant == TRIBO_LAW_ALGEBRAIC) {
            quad_algebraic(matrix, u, &from->pair, 0.0, impulse);
        } else {
            quad_frictionless(matrix, u, from->pair.e, impulse);
        }
        quad_apply(&from->a, from->contact.arm_a, frame, impulse, 1.0, truth);
        errors[count++] = quad_relative_error(6, self->out + 6 * i, truth) / DBL_EPSILON;
    }
    self->forward_median = median(count, errors, &self->forward_worst);
    self->unit = "eps |v|";
}

/* What free flight must keep: energy of rotation and angular momentum. */
static void judge_advance(row *self)
{
    double errors[TRUTHS];
    for (size_t i = 0; i < TRUTHS; i++) {
        static const double origin[3] = {0.0, 0.0, 0.0};
        tribo_body before = collisions[i].a;
        tribo_body after;
        tribo_totals totals[2];
        tribo_change change;
        memcpy(&after, self->out + sizeof after / sizeof(double) * i, sizeof after);
        for (size_t k = 0; k < 3; k++) {
            before.velocity[k] = after.velocity[k] = 0.0;
            before.position[k] = after.position[k] = 0.0;
        }
        tribo_audit_bodies(1, &before, origin, &totals[0]);
        tribo_audit_bodies(1, &after, origin, &totals[1]);
        tribo_audit_change(&totals[0], &totals[1], &change);
        errors[i] = fmax(fabs(change.energy), change.angular) / DBL_EPSILON;
    }
    self->forward_median = median(TRUTHS, errors, &self->forward_worst);
    self->unit = "eps T, L";
}

/* ---- timing ---------------------------------------------------------------------------------- */

/* Results of the last pass back into the order of the set. */
static void keep_results(row *self)
{
    const size_t stride = self->result == (const double *)bodies ? 2 * self->width : self->width;
    for (size_t i = 0; i < self->count; i++) {
        const double *from = self->result + stride * i;
        if (self->judge == judge_resolve) {
            from = bodies[2 * i].velocity;
        }
        memcpy(self->out + self->width * order[i], from, self->width * sizeof(double));
    }
}

static void time_rows(void)
{
    problem_random random;
    problem_random_start(&random, 7, SEED, 0);
    for (size_t round = 0; round < ROUNDS; round++) {
        for (size_t k = 0; k < row_count; k++) {
            row *self = &rows[k];
            loading = self->set;
            shuffle(self->count, &random);
            self->load();
            const double start = now();
            self->run(self);
            self->ns[round] = (now() - start) / (double)self->count;
            if (round == ROUNDS - 1) {
                keep_results(self);
            }
        }
    }
}

static void finish_rows(void)
{
    for (size_t k = 0; k < row_count; k++) {
        row *self = &rows[k];
        double greatest;
        self->eta_median = self->eta_worst = self->failures = -1.0;
        self->forward_median = self->forward_worst = -1.0;
        self->unit = "";
        self->median_ns = median(ROUNDS, self->ns, &greatest);
        self->least_ns = self->ns[0];
        self->judge(self);
    }
}

/* ---- the list of rows ------------------------------------------------------------------------ */

static row *add_row(const char *kernel, const problem_set *set, void (*run)(const row *),
                    void (*judge)(row *))
{
    row *self = &rows[row_count++];
    self->kernel = kernel;
    self->isa = TRIBO_ISA_SCALAR;
    self->isa_name = "scalar";
    self->set = set;
    self->load = load_local;
    self->run = run;
    self->judge = judge;
    self->count = CONTACTS;
    self->width = 3;
    self->result = p;
    return self;
}

static row *add_lanes(const row *scalar, uint32_t isa, void (*run)(const row *))
{
    row *self = &rows[row_count++];
    *self = *scalar;
    self->isa = isa;
    self->isa_name = tribo_isa_name(isa);
    self->run = run;
    return self;
}

static void add_all_lanes(const row *scalar, void (*run)(const row *))
{
    for (uint32_t isa = TRIBO_ISA_BASELINE; isa <= TRIBO_ISA_X86_64_V4; isa++) {
        if (tribo_isa_available(isa)) {
            add_lanes(scalar, isa, run);
        }
    }
}

static void add_solvers(const problem_set *set)
{
    const row *exact = add_row("exact solve", set, run_solve, judge_solution);
    add_all_lanes(exact, run_batch_solve);
    add_row("general solve", set, run_general, judge_solution);
    add_row("general solve, unsymmetric W", set, run_general, judge_eta)->variant = 1;
    for (uint32_t peer = 0; peer < PEERS; peer++) {
        add_row(peer_name(peer), set, run_peer, judge_solution)->variant = peer;
    }
}

static void add_laws(const problem_set *set)
{
    static const struct {
        const char *name;
        uint32_t law;
        void (*judge)(row *);
    } laws[] = {
        {"FRICTIONLESS", TRIBO_LAW_FRICTIONLESS, judge_impact},
        {"ALGEBRAIC", TRIBO_LAW_ALGEBRAIC, judge_impact},
        {"LECTURE", TRIBO_LAW_LECTURE, judge_impact},
        {"LECTURE_CLOSING", TRIBO_LAW_LECTURE_CLOSING, judge_impact},
        {"COULOMB", TRIBO_LAW_COULOMB, judge_coulomb},
        {"ROUTH_NEWTON", TRIBO_LAW_ROUTH_NEWTON, judge_routh},
        {"ROUTH_POISSON", TRIBO_LAW_ROUTH_POISSON, judge_routh},
        {"ROUTH_STRONGE", TRIBO_LAW_ROUTH_STRONGE, judge_routh},
    };
    for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
        row *law = add_row(laws[k].name, set, run_impact, laws[k].judge);
        law->variant = laws[k].law;
        law->load = load_impacts;
        if (laws[k].law == TRIBO_LAW_ALGEBRAIC) {
            add_all_lanes(law, run_batch_impact);
        }
    }
}

static row *add_bodies(const char *kernel, void (*run)(const row *), void (*judge)(row *),
                       const double *result, size_t width)
{
    row *self = add_row(kernel, NULL, run, judge);
    self->load = load_collisions;
    self->count = PAIRS;
    self->result = result;
    self->width = width;
    return self;
}

static void add_everything(const problem_set *sets)
{
    for (size_t k = 0; k < 4; k++) {
        add_solvers(&sets[k]);
    }
    add_laws(&sets[0]);
    add_row("cone projection", &sets[0], run_project, judge_project);
    add_bodies("contact matrix", run_matrix, judge_matrix, w, 6);
    const row *matrix = add_bodies("basis and matrix", run_basis_matrix, judge_matrix, w, 6);
    add_all_lanes(matrix, run_batch_matrix);
    add_bodies("whole collision, ALGEBRAIC", run_resolve, judge_resolve, (const double *)bodies, 6)
        ->variant = TRIBO_LAW_ALGEBRAIC;
    add_bodies("whole collision, FRICTIONLESS", run_resolve, judge_resolve, (const double *)bodies,
               6)
        ->variant = TRIBO_LAW_FRICTIONLESS;
    add_bodies("body advance, 1/60 s", run_advance, judge_advance, (const double *)bodies,
               sizeof(tribo_body) / sizeof(double));
    for (size_t k = 0; k < row_count; k++) {
        rows[k].out = calloc(rows[k].count * rows[k].width, sizeof(double));
    }
}

/* ---- sets ------------------------------------------------------------------------------------ */

static int slips(const problem_local *problem)
{
    double impulse[3];
    tribo_solve_info info = {0};
    info.struct_size = sizeof info;
    return tribo_contact_solve(problem->w, problem->b, problem->mu, problem->mu, impulse, &info) ==
               TRIBO_OK &&
           info.mode == TRIBO_MODE_SLIP;
}

static void make_set(problem_set *out, const char *name, uint32_t set, int slipping_only)
{
    uint64_t index = 0;
    out->name = name;
    out->local = calloc(CONTACTS, sizeof *out->local);
    out->impact = calloc(CONTACTS, sizeof *out->impact);
    out->truth = calloc(TRUTHS, sizeof *out->truth);
    out->condition = calloc(TRUTHS, sizeof *out->condition);
    for (size_t i = 0; i < CONTACTS; i++) {
        do {
            problem_draw_impact(set, SEED, index, &out->impact[i]);
            problem_draw(set, SEED, index++, &out->local[i]);
        } while (slipping_only && !slips(&out->local[i]));
    }
    for (size_t i = 0; i < TRUTHS; i++) {
        const problem_local *problem = &out->local[i];
        quad_solve(problem->w, problem->b, problem->mu, problem->mu, &out->truth[i]);
        out->condition[i] = quad_condition(problem->w);
    }
}

/* ---- output ---------------------------------------------------------------------------------- */

/* The exact scalar solve on the same set, or on the first one for kernels without a set. */
static double exact_ns(const row *self)
{
    for (size_t k = 0; k < row_count; k++) {
        if (rows[k].run == run_solve && (self->set == NULL || rows[k].set == self->set)) {
            return rows[k].median_ns;
        }
    }
    return HUGE_VAL;
}

static void print_number(FILE *file, const char *format, const char *none, double value)
{
    if (value < 0.0) {
        fputs(none, file);
    } else {
        fprintf(file, format, value);
    }
}

static void print_rows(void)
{
    printf("%-30s %-10s %-8s %8s %8s %6s  %8s %8s %8s  %8s %8s %s\n", "kernel", "ISA", "set",
           "ns/call", "least", "ratio", "eta med", "worst", "failed %", "err med", "worst", "unit");
    for (size_t k = 0; k < row_count; k++) {
        const row *self = &rows[k];
        if (k > 0 && (self->set != rows[k - 1].set || self->load != rows[k - 1].load)) {
            printf("\n");
        }
        printf("%-30s %-10s %-8s %8.1f %8.1f %6.2f ", self->kernel, self->isa_name,
               self->set != NULL ? self->set->name : "boxes", self->median_ns, self->least_ns,
               self->median_ns / exact_ns(self));
        print_number(stdout, " %8.1e", "         ", self->eta_median);
        print_number(stdout, " %8.1e", "         ", self->eta_worst);
        print_number(stdout, " %8.3f", "         ", self->failures);
        print_number(stdout, "  %8.2g", "          ", self->forward_median);
        print_number(stdout, " %8.2g", "         ", self->forward_worst);
        printf(" %s\n", self->unit);
    }
}

static void write_table(const char *path)
{
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: cannot be written\n", path);
        return;
    }
    fprintf(file, "kernel\tisa\tset\tns_median\tns_least\tratio\teta_median\teta_worst\t"
                  "failed_percent\terror_median\terror_worst\terror_unit\n");
    for (size_t k = 0; k < row_count; k++) {
        const row *self = &rows[k];
        fprintf(file, "%s\t%s\t%s\t%.2f\t%.2f\t%.3f", self->kernel, self->isa_name,
                self->set != NULL ? self->set->name : "boxes", self->median_ns, self->least_ns,
                self->median_ns / exact_ns(self));
        print_number(file, "\t%.3g", "\t", self->eta_median);
        print_number(file, "\t%.3g", "\t", self->eta_worst);
        print_number(file, "\t%.4f", "\t", self->failures);
        print_number(file, "\t%.3g", "\t", self->forward_median);
        print_number(file, "\t%.3g", "\t", self->forward_worst);
        fprintf(file, "\t%s\n", self->unit);
    }
    fclose(file);
    printf("\nwritten: %s\n", path);
}

/* Points of one side: x time, y worst eta, label. Labels lean away from where points crowd. */
static void plot_points(FILE *gnuplot, const problem_set *set, int peers)
{
    fprintf(gnuplot, "%s << END\n", peers ? "$peers" : "$tribo");
    for (size_t k = 0; k < row_count; k++) {
        const row *self = &rows[k];
        const int is_peer = self->run == run_peer;
        if (self->set == set && self->load == load_local && self->eta_worst >= 0.0 &&
            is_peer == peers) {
            fprintf(gnuplot, "%g %g \"%s\"\n", self->median_ns,
                    fmin(fmax(self->eta_worst, 1e-17), 10.0),
                    self->run == run_solve || self->run == run_batch_solve ? self->isa_name
                                                                           : self->kernel);
        }
    }
    fprintf(gnuplot, "END\n");
}

static void plot_set(FILE *gnuplot, const problem_set *set)
{
    plot_points(gnuplot, set, 0);
    plot_points(gnuplot, set, 1);
    fprintf(gnuplot, "set title \"set %s\"\n", set->name);
    fprintf(gnuplot, "plot $tribo using 1:2 with points pt 7 ps 0.8 lc '#1b6ca8' title "
                     "'exact solves, scalar and lanes', $peers using 1:2 with points pt 5 ps 0.8 "
                     "lc '#c0392b' title 'peers', $tribo using 1:2:3 with labels left rotate by "
                     "40 offset 0.3,0.5 font ',8' notitle, $peers using 1:2:3 with labels left "
                     "rotate by -30 offset 0.5,-0.5 font ',8' notitle\n");
}

static void plot(const char *path, const problem_set *sets)
{
    FILE *gnuplot;
    if (system("command -v gnuplot >/dev/null 2>&1") != 0) {
        printf("no picture: gnuplot is not installed\n");
        return;
    }
    gnuplot = popen("gnuplot", "w");
    if (gnuplot == NULL) {
        printf("no picture: gnuplot does not start\n");
        return;
    }
    fprintf(gnuplot, "set terminal svg size 1100,800 font 'sans,11'\nset output '%s'\n", path);
    fprintf(gnuplot, "set multiplot layout 2,2\nset logscale xy\nset xrange [5:20000]\n"
                     "set yrange [1e-19:1e3]\nset format y '10^{%%L}'\nset grid\n"
                     "set xlabel 'ns per contact'\nset ylabel 'worst residual'\n"
                     "set key center left\n");
    for (size_t k = 0; k < 4; k++) {
        plot_set(gnuplot, &sets[k]);
    }
    fprintf(gnuplot, "unset multiplot\n");
    if (pclose(gnuplot) == 0) {
        printf("written: %s\n", path);
    }
}

static void print_machine(void)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, "model name", 10) == 0) {
            printf("%s", strchr(line, ':') + 2);
            break;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    printf(
        "compiler %s; %d rounds, kernels taking turns; %d contacts or %d pairs of boxes per "
        "pass, shuffled anew\nbefore each; independent calls, thread time, nothing pinned. Half of "
        "the collisions have two moving bodies, half of\nthe bodies an inertia tensor that is not "
        "diagonal. ratio: to the exact scalar solve of the set.\n\n",
        __VERSION__, ROUNDS, CONTACTS, PAIRS);
}

/* Lanes have to give the bits of the scalar form, which stands some rows before them. */
static int lanes_agree(void)
{
    int agree = 1;
    const row *scalar = NULL;
    for (size_t k = 0; k < row_count; k++) {
        const row *self = &rows[k];
        if (self->isa == TRIBO_ISA_SCALAR) {
            scalar = self;
        } else if (memcmp(self->out, scalar->out, self->count * self->width * sizeof(double)) !=
                   0) {
            printf("NOT the bits of the scalar form: %s, %s, set %s\n", self->kernel,
                   self->isa_name, self->set != NULL ? self->set->name : "boxes");
            agree = 0;
        }
    }
    return agree;
}

/* Output goes next to the program. */
static void place_output(const char *program, const char *suffix, char *path, size_t size)
{
    snprintf(path, size, "%s%s", program, suffix);
}

int main(int count, char **arguments)
{
    static problem_set sets[4];
    char path[1024];
    make_set(&sets[0], "P1", PROBLEM_P1, 0);
    make_set(&sets[1], "P1 slip", PROBLEM_P1, 1);
    make_set(&sets[2], "P3", PROBLEM_P3, 0);
    make_set(&sets[3], "S", PROBLEM_S, 0);
    for (size_t i = 0; i < PAIRS; i++) {
        problem_draw_collision(SEED, i, &collisions[i]);
    }
    add_everything(sets);
    time_rows();
    finish_rows();
    print_machine();
    print_rows();
    const char *program = count > 0 ? arguments[0] : "core";
    place_output(program, ".tsv", path, sizeof path);
    write_table(path);
    place_output(program, ".svg", path, sizeof path);
    plot(path, sets);
    return lanes_agree() ? EXIT_SUCCESS : EXIT_FAILURE;
}
