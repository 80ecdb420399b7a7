#include "solver.h"

#include "bits.h"

/* Sweeps of the first batch, from nothing and from a start, and the Newton steps whose price may
 * still be missing in sweeps. */
#define FIRST_SWEEPS 8
#define WARM_SWEEPS 4
#define FEW_STEPS 2.0
/* While there are few of them, sweeps that still change contacts by so many tolerances are not
 * judged, which costs as much as some of them do. */
#define FEW_SWEEPS 64
#define FAR_OFF 8.0
#define JAM_GROWTH 1e6
/* A contact within this share of its cone stands on it. */
#define EDGE 1e-9
/* Newton steps of the first turn. */
#define FIRST_TURN 64

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

static verdict judge(solver *s, const system_problem *p, const goal *wanted, const double *r)
{
    s->is_current = 1;
    return certificate_check(p, wanted, r, s->dv, s->u, s->v);
}

static double growth_of(solver *s, const system_problem *p, const goal *wanted, verdict last,
                        const double *r)
{
    return wanted->measure == TRIBO_MEASURE_ETA ? last.growth : certificate_growth(p, r, s->v);
}

static void copy(size_t count, const double *from, double *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

/* 1 if more than `hope` sweeps are missing, if each batch brings a distance down by the factor that
 * the last did. Counts no further than that: a factor of next to 1 would take millions. */
static int is_hopeless(double won, double distance, uint32_t batch, double hope)
{
    double sweeps = 0.0;

    if (!(won > 1.0))
        return 1;
    for (; distance > 1.0 && sweeps <= hope; distance /= won)
        sweeps += (double)batch;
    return sweeps > hope;
}

/* 1 if a judgement may wait: nobody looks at rates or the clock, and more sweeps are to come. */
static int is_far_off(const solver *s, const goal *wanted, double change, double hope,
                      uint64_t done, uint64_t most)
{
    const tribo_system_options *o = s->options;

    return wanted->measure == TRIBO_MEASURE_ETA && hope == 0.0 && done < most &&
           !(o->max_seconds > 0.0) && o->progress == NULL && done < FEW_SWEEPS &&
           change > FAR_OFF * wanted->tolerance;
}

/* Sweep until the goal is met, `most` sweeps are done, or - if `hope` is given - more than that
 * many would be missing at the rate seen. Keeps the best r, judged as `start` before; returns its
 * verdict. s->dv is that of r. */
static verdict sweep_until(solver *s, const system_problem *p, const goal *wanted, uint64_t most,
                           double hope, verdict start, double *r, uint64_t *done)
{
    const tribo_system_options *o = s->options;
    sweep *sweeps = sweep_prepare(p, o->isa, s->sweep_memory);
    verdict least = start;
    verdict here = start;
    uint32_t batch = o->warm_start != 0 ? WARM_SWEEPS : FIRST_SWEEPS;
    double before = least.distance;

    copy(3 * (size_t)p->count, r, s->held);
    while (least.distance > 1.0 && *done < most && halt(s) == 0) {
        const uint32_t now = most - *done < batch ? (uint32_t)(most - *done) : batch;
        const double change = sweep_run(sweeps, now, r, NULL, o->parallel, o->user, o->tasks);
        *done += now;
        batch = batch < 1024 ? 2 * batch : batch;
        if (is_far_off(s, wanted, change, hope, *done, most))
            continue;
        here = judge(s, p, wanted, r);
        s->is_current = is_better(here, least) ? 1 : 0;
        if (s->is_current != 0) {
            least = here;
            copy(3 * (size_t)p->count, r, s->held);
        }
        if (here.distance > 1.0 && hope > 0.0 &&
            is_hopeless(before / here.distance, here.distance, now, hope))
            break;
        before = here.distance;
    }
    s->growth = growth_of(s, p, wanted, here, r);
    copy(3 * (size_t)p->count, s->held, r);
    return least;
}

/* ---- one component, one coefficient per contact ---------------------------------------------- */

static double run_newton(solver *s, uint64_t steps, double *r)
{
    const double distance = newton_continue(s->newton, &s->run, steps, r);
    s->growth = s->run.growth;
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

/* Why the goal is missed. Impulses that have come to work against each other a million times harder
 * than on the approach, and do not get there, would grow for ever. */
static uint32_t reason(const solver *s, int stalled)
{
    if (s->growth > JAM_GROWTH)
        return TRIBO_STOP_JAM;
    return stalled ? TRIBO_STOP_STALL : TRIBO_STOP_ITERATIONS;
}

/* Newton; by the automatic choice in turns with Gauss-Seidel, each from where it was, for ever longer
 * turns: the cost is at most about twice that of the better one. `swept` is where the sweeps
 * were. */
static double take_turns(solver *s, const system_problem *p, const goal *wanted, double price,
                         double *r, double *swept, uint64_t *sweeps)
{
    const uint32_t alone = s->options->solver == TRIBO_SOLVER_NEWTON;
    uint64_t turn = alone ? UINT64_MAX : FIRST_TURN;
    double distance;

    newton_start(s->newton, p, wanted, &s->run, r);
    for (;;) {
        s->info->solver = TRIBO_SOLVER_NEWTON;
        distance = run_newton(s, turn, r);
        if (distance <= 1.0 || alone || s->status != TRIBO_OK || halt(s) != 0 ||
            s->run.steps >= s->run.most_steps || newton_stalls(s->newton, &s->run))
            return distance;
        const double due = price * (double)turn;
        const uint64_t left = s->most - *sweeps;
        const uint64_t most = *sweeps + (due < (double)left ? (uint64_t)due : left);
        const verdict start = judge(s, p, wanted, swept);
        if (sweep_until(s, p, wanted, most, 0.0, start, swept, sweeps).distance <= 1.0) {
            s->info->solver = TRIBO_SOLVER_GAUSS_SEIDEL;
            copy(3 * (size_t)p->count, swept, r);
            return 0.0;
        }
        turn *= 2;
    }
}

/* start: of r, as it is judged by p. Returns the same of the new r; a distance of Newton's own comes
 * with `is_judged` 0. */
static verdict solve_fixed(solver *s, const system_problem *p, const goal *wanted, verdict start,
                           double *r, int *is_judged)
{
    const size_t numbers = 3 * (size_t)p->count;
    const uint32_t asked = s->options->solver;
    const uint32_t can = s->newton != NULL && newton_possible(p->count, p->bodies, &s->run);
    const uint32_t use_newton = asked != TRIBO_SOLVER_GAUSS_SEIDEL && can;
    const uint64_t done = s->run.steps;
    const double price = use_newton ? newton_price(s->newton, p, &s->run) : 0.0;
    verdict now = start;
    uint64_t sweeps = 0;

    *is_judged = 1;
    s->run.most_steps = s->most > UINT64_MAX - done ? UINT64_MAX : done + s->most;
    copy(numbers, r, s->start_r);
    if (now.distance > 1.0 && asked != TRIBO_SOLVER_NEWTON)
        now = sweep_until(s, p, wanted, s->most, price * FEW_STEPS, now, r, &sweeps);
    if (now.distance > 1.0 && use_newton && halt(s) == 0) {
        copy(numbers, r, s->swept);
        /* Sweeps spoil the contacts of a stack at rest, which Newton finds at once from nothing. */
        copy(numbers, s->start_r, r);
        now.distance = take_turns(s, p, wanted, price, r, s->swept, &sweeps);
        *is_judged = 0;
    }
    if (sweeps > s->info->sweeps)
        s->info->sweeps = sweeps;
    if (now.distance > 1.0)
        note_stop(s, reason(s, use_newton && s->run.steps < s->run.most_steps));
    return now;
}

/* ---- static and dynamic coefficients --------------------------------------------------------- */

/* Slip, of friction times W, that a contact at rest may have. */
static double least_slip(const goal *wanted)
{
    return wanted->measure == TRIBO_MEASURE_ETA ? lesser(EDGE, 0.1 * wanted->tolerance)
                                                : 1e-3 * EDGE;
}

/* 1 if a contact stands on the cone of mu and slides faster than what the goal forgives. */
static int slides(const system_problem *p, size_t c, double mu, double least, const double *r,
                  const double *u)
{
    const double friction = sqrt(r[1] * r[1] + r[2] * r[2]);
    const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
    const double *w = p->diagonal + 9 * c;

    return r[0] > 0.0 && friction >= mu * r[0] * (1.0 - EDGE) &&
           slip > least * friction * (w[4] + w[8]);
}

/* A contact that slides on its cone has mu_d from now on: returns how many changed. */
static uint32_t release(solver *s, const system_problem *p, const goal *wanted, const double *r)
{
    const double least = least_slip(wanted);
    uint32_t released = 0;

    for (size_t c = 0; c < p->count; c++) {
        double *mu = s->mu + 2 * c;
        const double dynamic = p->mu[2 * c + 1];
        if (mu[0] > dynamic && slides(p, c, mu[0], least, r + 3 * c, s->u + 3 * c)) {
            mu[0] = mu[1] = dynamic;
            released++;
        }
    }
    return released;
}

/* mu_s for all, but mu_d where the start slides so. Returns 1 if mu_s is mu_d everywhere. */
static int choose_coefficients(solver *s, const system_problem *p, const goal *wanted,
                               const double *r)
{
    int is_same = 1;

    for (size_t c = 0; c < p->count; c++) {
        const double *mu = p->mu + 2 * c;
        const int dynamic =
            mu[0] > mu[1] && slides(p, c, mu[1], least_slip(wanted), r + 3 * c, s->u + 3 * c);
        s->mu[2 * c] = s->mu[2 * c + 1] = mu[dynamic];
        is_same = is_same && mu[0] == mu[1];
    }
    return is_same;
}

/* A contact alone has an answer without iteration. Where it jams, the frictionless impulse is what
 * stops the approach. Returns 0 if neither is sure. */
static int solve_alone(solver *s, const system_problem *p, double r[3])
{
    const double *w = p->diagonal;
    const double half[6] = {w[0], w[1], w[2], w[4], w[5], w[8]};
    const tribo_status status =
        p->symmetric[0] != 0 ? tribo_contact_solve(half, p->q, p->mu[0], p->mu[1], r, NULL)
                             : tribo_contact_solve_general(w, p->q, p->mu[0], p->mu[1], r, NULL);

    s->info->sweeps = s->info->sweeps > 1 ? s->info->sweeps : 1;
    if (status != TRIBO_ERROR_JAM)
        return status == TRIBO_OK;
    r[0] = (0.0 - p->q[0]) / w[0];
    r[1] = r[2] = 0.0;
    note_stop(s, TRIBO_STOP_JAM);
    return 1;
}

/* One round with the coefficients in force. Returns the verdict by the problem's own. */
static verdict solve_round(solver *s, const system_problem *problem, const goal *wanted,
                           const verdict *known, double *r)
{
    system_problem held = *problem;
    int is_judged = 0;

    held.mu = s->mu;
    const verdict start = known != NULL ? *known : judge(s, &held, wanted, r);
    const verdict now = solve_fixed(s, &held, wanted, start, r, &is_judged);
    return known != NULL && is_judged ? now : judge(s, problem, wanted, r);
}

verdict solver_solve(solver *s, const system_problem *problem, const goal *wanted, double *r)
{
    const size_t numbers = 3 * (size_t)problem->count;

    if (problem->count == 1 && solve_alone(s, problem, r)) {
        verdict done = judge(s, problem, wanted, r);
        done.distance = 0.0;
        return done;
    }
    verdict best = judge(s, problem, wanted, r);
    const uint32_t before = s->stop;

    if (best.distance <= 1.0)
        return best;
    s->run.halt = halt;
    s->run.context = s;
    const int is_same = choose_coefficients(s, problem, wanted, r);
    int is_best = 0;
    copy(numbers, r, s->best);
    do {
        const verdict now = solve_round(s, problem, wanted, is_same ? &best : NULL, r);
        is_best = is_better(now, best);
        if (is_best) {
            best = now;
            copy(numbers, r, s->best);
        }
    } while (s->status == TRIBO_OK && halt(s) == 0 && release(s, problem, wanted, r) > 0);
    s->is_current = is_best && s->is_current != 0;
    copy(numbers, s->best, r);
    if (best.distance <= 1.0 && s->stop != TRIBO_STOP_TIME && s->stop != TRIBO_STOP_CANCEL)
        s->stop = before;
    else if (best.distance > 1.0)
        note_stop(s, TRIBO_STOP_ITERATIONS);
    return best;
}
