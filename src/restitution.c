#include "restitution.h"

#include "bits.h"

#define WILD 1e6

void restitution_take(restitution *stage, arena *a, uint32_t count)
{
    double **each[] = {&stage->first,    &stage->second, &stage->u_first,
                       &stage->u_second, &stage->q,      &stage->target};

    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        *each[i] = arena_take(a, 3 * (size_t)count, sizeof(double));
    stage->mu = arena_take(a, 2 * (size_t)count, sizeof(double));
}

/* Speed at which contact c shall part. */
static double parting(const system_problem *p, const double *e, size_t c)
{
    const double approach = 0.0 - p->q[3 * c];
    return approach > 0.0 ? e[c] * approach : 0.0;
}

static int is_needed(const system_problem *p, const double *e)
{
    for (size_t c = 0; c < p->count; c++) {
        if (parting(p, e, c) > 0.0)
            return 1;
    }
    return 0;
}

/* Change of energy by impulses r: r . (q + u) / 2. */
static double energy_of(const system_problem *p, const double *r, const double *u)
{
    double sum = 0.0;

    for (size_t i = 0; i < 3 * (size_t)p->count; i++)
        sum += 0.5 * r[i] * (p->q[i] + u[i]);
    return sum;
}

/* Greatest share in [0, 1] of the way from impulses `from` to `to` with energy <= 0. */
static double allowed(const system_problem *p, const double *from, const double *u_from,
                      const double *to, const double *u_to)
{
    const double start = lesser(energy_of(p, from, u_from), 0.0);
    double slope = 0.0;
    double bend = 0.0;

    if (energy_of(p, to, u_to) <= 0.0)
        return 1.0;
    for (size_t i = 0; i < 3 * (size_t)p->count; i++) {
        const double d = to[i] - from[i];
        slope += d * u_from[i];
        bend += 0.5 * d * (u_to[i] - u_from[i]);
    }
    /* start + slope s + bend s^2 = 0 with start <= 0, by the form that does not cancel. */
    const double root = sqrt(greater(slope * slope - 4.0 * bend * start, 0.0));
    const double share = slope > 0.0  ? -2.0 * start / (slope + root)
                         : bend > 0.0 ? (root - slope) / (2.0 * bend)
                                      : 0.0;
    return share > 0.0 ? lesser(share, 1.0) : 0.0;
}

/* from += share (to - from), velocities too. */
static void advance(const system_problem *p, double share, double *from, double *u_from,
                    const double *to, const double *u_to)
{
    for (size_t i = 0; i < 3 * (size_t)p->count; i++) {
        from[i] = share < 1.0 ? from[i] + share * (to[i] - from[i]) : to[i];
        u_from[i] = share < 1.0 ? u_from[i] + share * (u_to[i] - u_from[i]) : u_to[i];
    }
}

/* second = first + frictionless impulses that part the contacts. Returns the distance from the
 * goal. */
static double part_without_friction(restitution *st, solver *s, const system_problem *p,
                                    const double *e, const goal *wanted)
{
    system_problem bare = *p;
    const size_t n = p->count;

    certificate_velocity(p, st->first, s->dv, st->u_first);
    for (size_t c = 0; c < n; c++) {
        st->mu[2 * c] = st->mu[2 * c + 1] = 0.0;
        for (size_t k = 0; k < 3; k++) {
            const double speed = k == 0 ? parting(p, e, c) : 0.0;
            st->target[3 * c + k] = p->target[3 * c + k] + speed;
            st->q[3 * c + k] = st->u_first[3 * c + k] - speed;
            st->second[3 * c + k] = 0.0;
        }
    }
    bare.q = st->q;
    bare.target = st->target;
    bare.mu = st->mu;
    bare.lengths = NULL;
    const double distance = solver_solve(s, &bare, wanted, st->second).distance;
    for (size_t i = 0; i < 3 * n; i++)
        st->second[i] = st->first[i] + (i % 3 == 0 ? st->second[i] : 0.0);
    certificate_velocity(p, st->second, s->dv, st->u_second);
    return distance;
}

/* second = impulses of Newton's restitution with friction. */
static double part_with_friction(restitution *st, solver *s, const system_problem *p,
                                 const double *e, const goal *wanted)
{
    system_problem aimed = *p;

    for (size_t c = 0; c < p->count; c++) {
        for (size_t k = 0; k < 3; k++)
            st->q[3 * c + k] = p->q[3 * c + k] - (k == 0 ? parting(p, e, c) : 0.0);
    }
    for (size_t i = 0; i < 3 * (size_t)p->count; i++)
        st->second[i] = st->first[i];
    aimed.q = st->q;
    aimed.target = st->target;
    const double distance = solver_solve(s, &aimed, wanted, st->second).distance;
    certificate_velocity(p, st->second, s->dv, st->u_second);
    return distance;
}

/* Time and cancelling end all that follows. */
static uint32_t lasting(uint32_t now, uint32_t before)
{
    return now == TRIBO_STOP_TIME || now == TRIBO_STOP_CANCEL ? now : before;
}

/* 1 if a way of parting is no way to go: it is not solved, or its impulses hold each other a million
 * times harder than those of the plastic solution. */
static int is_wild(const restitution *st, solver *s, const system_problem *p, double distance)
{
    const double before = certificate_growth(p, st->first, s->v);
    return distance > 1.0 || certificate_growth(p, st->second, s->v) > WILD * greater(before, 1.0);
}

double restitution_apply(restitution *stage, solver *s, const system_problem *problem,
                         const double *e, const goal *wanted, double *r)
{
    const size_t numbers = 3 * (size_t)problem->count;

    if (!is_needed(problem, e))
        return 1.0;
    for (size_t i = 0; i < numbers; i++)
        stage->first[i] = r[i];
    /* The plastic solution stands: what fails from here on is told by the share alone. */
    const uint32_t stop = s->stop;
    double distance = part_without_friction(stage, s, problem, e, wanted);
    if (is_wild(stage, s, problem, distance)) {
        s->stop = lasting(s->stop, stop);
        s->is_current = 0;
        return 0.0;
    }
    double share = allowed(problem, stage->first, stage->u_first, stage->second, stage->u_second);
    advance(problem, share, stage->first, stage->u_first, stage->second, stage->u_second);
    if (share == 1.0) {
        distance = part_with_friction(stage, s, problem, e, wanted);
        share =
            is_wild(stage, s, problem, distance)
                ? 0.0
                : allowed(problem, stage->first, stage->u_first, stage->second, stage->u_second);
        advance(problem, share, stage->first, stage->u_first, stage->second, stage->u_second);
    }
    s->stop = lasting(s->stop, stop);
    s->is_current = 0;
    for (size_t i = 0; i < numbers; i++)
        r[i] = stage->first[i];
    return share;
}
