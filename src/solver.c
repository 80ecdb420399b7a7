#include "solver.h"

#include "bits.h"

/* Sweeps that are tried before Newton, and the most that may still be missing by the rate seen. */
#define FIRST_SWEEPS 8
#define MOST_SWEEPS 64
#define JAM_GROWTH 1e6
/* Newton starts from what the sweeps gave if it is nearer than this share of the start. */
#define WORTH_KEEPING 1e-3
/* Sweeps of Gauss-Seidel that smooth what Newton left, where it stalled. */
#define SMOOTHING_SWEEPS 256

double solver_now(const tribo_system_options *options)
{
    return options->clock != NULL ? options->clock(options->user) : 0.0;
}

/* ---- limits ---------------------------------------------------------------------------------- */

static uint32_t halt(void *context)
{
    solver *s = context;
    const tribo_system_options *o = s->options;

    if (s->stop == TRIBO_STOP_CANCEL || s->stop == TRIBO_STOP_TIME)
        return 1;
    if (o->max_seconds > 0.0 || o->progress != NULL)
        s->info->seconds = solver_now(o) - s->start;
    if (o->progress != NULL && o->progress(o->user, s->info) != 0)
        s->stop = TRIBO_STOP_CANCEL;
    else if (o->max_seconds > 0.0 && s->info->seconds >= o->max_seconds)
        s->stop = TRIBO_STOP_TIME;
    return s->stop == TRIBO_STOP_CANCEL || s->stop == TRIBO_STOP_TIME;
}

/* ---- Gauss-Seidel ---------------------------------------------------------------------------- */

static double distance_of(solver *s, const system_problem *p, const goal *wanted, const double *r)
{
    certificate_velocity(p, r, s->dv, s->u);
    return certificate_distance(p, wanted, r, s->u, s->v);
}

static void copy(size_t count, const double *from, double *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

/* Velocities that r gives, for the sweeps to go on from: rounding does not gather. */
static void renew_velocities(solver *s, const system_problem *p, const double *free_velocity)
{
    for (size_t i = 0; i < 6 * (size_t)p->bodies; i++)
        s->v[i] = free_velocity[i] + s->dv[i];
}

/* Sweep until the goal is met, `most` sweeps are done, or - if `hope` is given - more than that
 * many would be missing at the rate seen. Keeps the best r; returns its distance. */
static double sweep_until(solver *s, const system_problem *p, const double *free_velocity,
                          const goal *wanted, uint64_t most, double hope, double *r, uint64_t *done)
{
    const tribo_system_options *o = s->options;
    sweep *sweeps = sweep_prepare(p, o->isa, s->sweep_memory);
    double least = distance_of(s, p, wanted, r);
    uint32_t batch = FIRST_SWEEPS;
    double before = least;

    copy(3 * (size_t)p->count, r, s->held);
    while (least > 1.0 && *done < most && halt(s) == 0) {
        const uint32_t now = most - *done < batch ? (uint32_t)(most - *done) : batch;
        renew_velocities(s, p, free_velocity);
        sweep_run(sweeps, now, r, s->v, o->parallel, o->user, o->tasks);
        *done += now;
        const double distance = distance_of(s, p, wanted, r);
        if (distance < least) {
            least = distance;
            copy(3 * (size_t)p->count, r, s->held);
        }
        /* Sweeps that are missing if each batch wins what the last one did. */
        const double won = before / distance;
        double missing = 0.0;
        for (double left = distance; left > 1.0 && won > 1.0 && missing <= hope; left /= won)
            missing += (double)now;
        if (hope > 0.0 && distance > 1.0 && (!(won > 1.0) || missing > hope))
            break;
        before = distance;
        batch = batch < 1024 ? 2 * batch : batch;
    }
    copy(3 * (size_t)p->count, s->held, r);
    return least;
}

/* ---- one component, one coefficient per contact ---------------------------------------------- */

static double run_newton(solver *s, const system_problem *p, const goal *wanted, double *r)
{
    const double distance = newton_solve(s->newton, p, wanted, &s->run, r);
    s->info->steps = s->run.steps;
    s->info->factorizations = s->run.factorizations;
    if (s->run.status != TRIBO_OK)
        s->status = s->run.status;
    return distance;
}

static void note_stop(solver *s, uint32_t stop)
{
    if (stop > s->stop && s->stop != TRIBO_STOP_TIME && s->stop != TRIBO_STOP_CANCEL)
        s->stop = stop;
}

/* Why the goal is missed. Impulses that work against each other a million times harder than on the
 * approach, and leave a residual of its size, would grow for ever. */
static uint32_t reason(solver *s, const system_problem *p, const goal *wanted, const double *r,
                       int stalled)
{
    goal bare = *wanted;

    bare.tolerance = 1e300;
    if (certificate_growth(p, r, s->v) > JAM_GROWTH &&
        (wanted->measure != TRIBO_MEASURE_ETA || distance_of(s, p, &bare, r) > 1.0))
        return TRIBO_STOP_JAM;
    return stalled ? TRIBO_STOP_STALL : TRIBO_STOP_ITERATIONS;
}

static void solve_fixed(solver *s, const system_problem *p, const double *free_velocity,
                        const goal *wanted, double *r)
{
    const uint32_t asked = s->options->solver;
    const uint32_t can = s->newton != NULL && newton_possible(p->count, p->bodies, &s->run);
    const uint32_t use_newton = asked != TRIBO_SOLVER_GAUSS_SEIDEL && can;
    uint64_t sweeps = 0;
    const uint64_t done = s->run.steps;

    s->run.most_steps = s->most > UINT64_MAX - done ? UINT64_MAX : done + s->most;
    const double first = distance_of(s, p, wanted, r);
    double distance = first;

    copy(3 * (size_t)p->count, r, s->start_r);
    if (distance > 1.0 && asked != TRIBO_SOLVER_NEWTON)
        distance = sweep_until(s, p, free_velocity, wanted, s->most,
                               use_newton ? (double)MOST_SWEEPS : 0.0, r, &sweeps);
    /* Few sweeps spoil the contacts of a stack at rest, which Newton finds at once from nothing. */
    if (use_newton && distance > 1.0 && distance > WORTH_KEEPING * first)
        copy(3 * (size_t)p->count, s->start_r, r);
    for (int round = 0; distance > 1.0 && use_newton && round < 3; round++) {
        s->info->solver = TRIBO_SOLVER_NEWTON;
        distance = run_newton(s, p, wanted, r);
        if (!(distance > 1.0) || halt(s) != 0 || s->status != TRIBO_OK ||
            asked == TRIBO_SOLVER_NEWTON || round == 2 || s->run.steps >= s->run.most_steps)
            break;
        const uint64_t smooth = sweeps + SMOOTHING_SWEEPS;
        distance = sweep_until(s, p, free_velocity, wanted, smooth < s->most ? smooth : s->most,
                               0.0, r, &sweeps);
    }
    if (sweeps > s->info->sweeps)
        s->info->sweeps = sweeps;
    if (distance > 1.0)
        note_stop(s, reason(s, p, wanted, r, use_newton && s->run.steps < s->run.most_steps));
}

/* ---- static and dynamic coefficients --------------------------------------------------------- */

/* Contacts that slide on the cone of mu_s have only mu_d: returns how many changed. */
static uint32_t release(solver *s, const system_problem *p, const double *r, double *mu)
{
    uint32_t released = 0;

    for (size_t c = 0; c < p->count; c++) {
        const double dynamic = p->mu[2 * c + 1];
        const double *own = r + 3 * c;
        const double *u = s->u + 3 * c;
        const double friction = sqrt(own[1] * own[1] + own[2] * own[2]);
        const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
        const double *w = p->diagonal + 9 * c;
        const double scale = friction * (w[4] + w[8]);
        if (mu[2 * c] > dynamic && friction >= mu[2 * c] * own[0] * (1.0 - 1e-9) &&
            slip > 1e-9 * scale) {
            mu[2 * c] = mu[2 * c + 1] = dynamic;
            released++;
        }
    }
    return released;
}

void solver_solve(solver *s, const system_problem *problem, const double *free_velocity,
                  const goal *wanted, double *r)
{
    system_problem held = *problem;

    for (size_t c = 0; c < problem->count; c++)
        s->mu[2 * c] = s->mu[2 * c + 1] = problem->mu[2 * c];
    held.mu = s->mu;
    s->run.halt = halt;
    s->run.context = s;
    do {
        solve_fixed(s, &held, free_velocity, wanted, r);
        distance_of(s, problem, wanted, r);
    } while (s->status == TRIBO_OK && halt(s) == 0 && release(s, problem, r, s->mu) > 0);
}
