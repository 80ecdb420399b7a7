#include "anderson.h"

#include "bits.h"
#include "cone.h"

#define MEMORY 8
#define GROWTH 2.0 /* of |f|, by which a leap went astray */
#define WINDOW 16  /* leaps in which ... */
#define SHARE 0.5  /* ... |f| must come down to this share of itself */
#define LEAST_REST 4
#define MOST_REST 4096 /* batches */
#define RIDGE 1e-12    /* of the greatest square of a difference */
#define LANES 8

struct anderson {
    const system_problem *problem;
    uint32_t held; /* differences in memory, and where the next one goes */
    uint32_t at;
    uint32_t has_past;
    uint32_t leapt;
    uint32_t leaps; /* in the window */
    uint32_t rest;  /* batches still to rest, and how long the next rest will be */
    uint32_t next_rest;
    double last;   /* |f| before the last leap */
    double window; /* |f| where the window began; 0: it has not */

    double gram[MEMORY][MEMORY]; /* df . df */
    double *weight;              /* per contact: velocity per impulse */
    double *x, *f, *past_x, *past_f;
    double *plain; /* what sweeps alone gave before the last leap */
    double *dx[MEMORY], *df[MEMORY];
};

anderson *anderson_take(arena *a, uint32_t count)
{
    anderson counted = {0};
    anderson *taken = arena_take(a, 1, sizeof *taken);
    anderson *out = taken != NULL ? taken : &counted;
    double **each[] = {&out->x, &out->f, &out->past_x, &out->past_f, &out->plain};

    *out = counted;
    out->weight = arena_take(a, count, sizeof(double));
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        *each[i] = arena_take(a, 3 * (size_t)count, sizeof(double));
    for (size_t i = 0; i < MEMORY; i++) {
        out->dx[i] = arena_take(a, 3 * (size_t)count, sizeof(double));
        out->df[i] = arena_take(a, 3 * (size_t)count, sizeof(double));
    }
    return taken;
}

/* In lanes, so that the sum does not wait for each of its terms. */
static double dot(size_t count, const double *a, const double *b)
{
    double lanes[LANES] = {0.0};
    double sum = 0.0;
    size_t i = 0;

    for (; i + LANES <= count; i += LANES) {
        for (size_t k = 0; k < LANES; k++)
            lanes[k] += a[i + k] * b[i + k];
    }
    for (; i < count; i++)
        sum += a[i] * b[i];
    for (size_t k = 0; k < LANES; k++)
        sum += lanes[k];
    return sum;
}

static void copy(size_t count, const double *from, double *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

static void forget(anderson *a)
{
    a->held = a->at = a->has_past = a->leapt = a->leaps = 0;
    a->window = 0.0;
}

void anderson_start(anderson *a, const system_problem *problem)
{
    a->problem = problem;
    for (size_t c = 0; c < problem->count; c++) {
        const double *w = problem->diagonal + 9 * c;
        a->weight[c] = w[0] + w[4] + w[8];
    }
    forget(a);
    a->rest = a->next_rest = LEAST_REST;
}

void anderson_resume(anderson *a)
{
    forget(a);
}

void anderson_hold(anderson *a, const double *r)
{
    copy(3 * (size_t)a->problem->count, r, a->x);
}

/* What changed since the last batch. */
static void remember(anderson *a)
{
    const size_t numbers = 3 * (size_t)a->problem->count;
    double *dx = a->dx[a->at];
    double *df = a->df[a->at];

    for (size_t i = 0; i < numbers; i++) {
        dx[i] = a->x[i] - a->past_x[i];
        df[i] = a->f[i] - a->past_f[i];
    }
    a->held = a->held < MEMORY ? a->held + 1 : MEMORY;
    for (uint32_t i = 0; i < a->held; i++)
        a->gram[a->at][i] = a->gram[i][a->at] = dot(numbers, df, a->df[i]);
    a->at = (a->at + 1) % MEMORY;
}

/* Solve for t, which holds the right-hand side, by Cholesky's factors; 0 if it is singular. */
static int solve_gram(const anderson *a, double *t)
{
    const uint32_t n = a->held;
    double l[MEMORY][MEMORY];
    double most = 0.0;

    for (uint32_t i = 0; i < n; i++)
        most = greater(most, a->gram[i][i]);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            double sum = a->gram[i][j] + (i == j ? RIDGE * most : 0.0);
            for (uint32_t k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 0.0))
                return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < i; k++)
            t[i] -= l[i][k] * t[k];
        t[i] /= l[i][i];
    }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t k = i + 1; k < n; k++)
            t[i] -= l[k][i] * t[k];
        t[i] /= l[i][i];
    }
    return 1;
}

/* r - sum t (dx + df / weight), with |f - sum t df| least. */
static void leap(anderson *a, double *r)
{
    const size_t count = a->problem->count;
    double t[MEMORY];

    for (uint32_t i = 0; i < a->held; i++)
        t[i] = dot(3 * count, a->df[i], a->f);
    if (!solve_gram(a, t)) {
        forget(a);
        return;
    }
    copy(3 * count, r, a->plain);
    for (uint32_t i = 0; i < a->held; i++) {
        for (size_t c = 0; c < count; c++) {
            for (size_t k = 3 * c; k < 3 * c + 3; k++)
                r[k] -= t[i] * (a->dx[i][k] + a->df[i][k] / a->weight[c]);
        }
    }
    for (size_t c = 0; c < count; c++) {
        double inside[3];
        cone_project(r + 3 * c, a->problem->mu[2 * c], inside);
        copy(3, inside, r + 3 * c);
    }
    a->leapt = 1;
}

/* f = weight (r - x), m/s; returns |f|. */
static double measure(anderson *a, const double *r)
{
    const size_t count = a->problem->count;

    for (size_t c = 0; c < count; c++) {
        for (size_t k = 3 * c; k < 3 * c + 3; k++)
            a->f[k] = a->weight[c] * (r[k] - a->x[k]);
    }
    return sqrt(dot(3 * count, a->f, a->f));
}

/* 1 if the last leap went astray, or the last many bring nothing. */
static int is_astray(anderson *a, double size, double *r)
{
    if (!(size <= GROWTH * a->last)) {
        copy(3 * (size_t)a->problem->count, a->plain, r);
        return 1;
    }
    if (++a->leaps < WINDOW)
        return 0;
    if (size > SHARE * a->window)
        return 1;
    a->leaps = 0;
    a->window = size;
    a->next_rest = LEAST_REST;
    return 0;
}

void anderson_leap(anderson *a, double *r)
{
    const size_t numbers = 3 * (size_t)a->problem->count;
    const double size = measure(a, r);

    if (a->leapt != 0 && is_astray(a, size, r)) {
        forget(a);
        a->rest = a->next_rest;
        a->next_rest = a->next_rest < MOST_REST ? 2 * a->next_rest : MOST_REST;
        return;
    }
    a->leapt = 0;
    if (a->rest > 0) {
        a->rest--;
        return;
    }
    if (a->has_past != 0)
        remember(a);
    copy(numbers, a->x, a->past_x);
    copy(numbers, a->f, a->past_f);
    a->has_past = 1;
    a->last = size;
    if (a->held == 0)
        return;
    if (a->window == 0.0)
        a->window = size;
    leap(a, r);
}
