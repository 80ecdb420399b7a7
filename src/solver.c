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
/* Newton steps of the first turn, and of one that the interior method follows: the whole of it only
 * if the first half has brought the distance down to a share. */
#define FIRST_TURN 32
#define SHORT_TURN 16
#define WELL_ON_ITS_WAY 1e-4
/* Price of a Newton step, in sweeps, from which the interior method goes first where the system
 * seems to stand: its matrices are symmetric, and Newton's first turn would cost more. From a start
 * Newton goes first: what it finds is near. */
#define DEAR 200.0
/* A sweep that leaps, with its share of judging, takes as long as so many that do not. */
#define LEAPING 2.0
/* Newton steps' worth of sweeps that leap before Newton's first turn, where they are so dear. */
#define FIRST_LEAPS 8.0
/* Share of Newton's residual at which it goes on from where the sweeps are. */
#define FAR_AHEAD 0.1
/* Steps of an attempt at the path of Coulomb's law, and contacts for each more: the more there are,
 * the more folds it has. */
#define PATH_STEPS UINT64_C(96)
#define MOST_PATH_STEPS UINT64_C(500)
#define CONTACTS_A_STEP 3
/* Rounds of the interior method, if each brings the distance down by so much. */
#define MOST_ROUNDS 4
#define ROUND_GAIN 0.3

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

/* Returns by how much the sweeps still changed contacts. */
static double sweep_batch(solver *s, sweep *sweeps, uint32_t count, anderson *leaps, double *r)
{
    const tribo_system_options *o = s->options;

    if (leaps != NULL)
        anderson_hold(leaps, r);
    const double change = sweep_run(sweeps, count, r, NULL, o->parallel, o->user, o->tasks);
    if (leaps != NULL)
        anderson_leap(leaps, r);
    return change;
}

/* Sweep until the goal is met, `most` sweeps are done, or - if `hope` is given - more than that
 * many would be missing at the rate seen. `leaps` may be null. r was judged as `here`; `held` keeps
 * the best r so far, which `least` judges. Returns the last verdict. */
static verdict sweep_on(solver *s, const system_problem *p, const goal *wanted, uint64_t most,
                        double hope, anderson *leaps, verdict here, verdict *least, double *r,
                        uint64_t *done)
{
    const tribo_system_options *o = s->options;
    sweep *sweeps = sweep_prepare(p, o->isa, s->sweep_memory);
    uint32_t batch = o->warm_start != 0 ? WARM_SWEEPS : FIRST_SWEEPS;
    double before = here.distance;

    if (leaps != NULL) {
        anderson_resume(leaps);
        batch = ANDERSON_BATCH;
    }
    while (least->distance > 1.0 && *done < most && halt(s) == 0) {
        const uint32_t now = most - *done < batch ? (uint32_t)(most - *done) : batch;
        const double change = sweep_batch(s, sweeps, now, leaps, r);
        *done += now;
        batch = leaps == NULL && batch < 1024 ? 2 * batch : batch;
        if (is_far_off(s, wanted, change, hope, *done, most))
            continue;
        here = judge(s, p, wanted, r);
        s->is_current = is_better(here, *least) ? 1 : 0;
        if (s->is_current != 0) {
            *least = here;
            copy(3 * (size_t)p->count, r, s->held);
        }
        if (here.distance > 1.0 && hope > 0.0 &&
            is_hopeless(before / here.distance, here.distance, now, hope))
            break;
        before = here.distance;
    }
    return here;
}

/* The same from r, judged as `start` before, which receives the best; returns its verdict. s->dv is
 * that of r. With `hope`, others go on, and their growth counts. */
static verdict sweep_from(solver *s, const system_problem *p, const goal *wanted, uint64_t most,
                          double hope, anderson *leaps, verdict start, double *r, uint64_t *done)
{
    verdict least = start;

    copy(3 * (size_t)p->count, r, s->held);
    const verdict last = sweep_on(s, p, wanted, most, hope, leaps, start, &least, r, done);
    if (least.distance > 1.0 && hope == 0.0)
        s->growth = growth_of(s, p, wanted, last, r);
    copy(3 * (size_t)p->count, s->held, r);
    return least;
}

/* ---- one component, one coefficient per contact ---------------------------------------------- */

static void note_run(solver *s)
{
    s->growth = s->run.growth;
    s->info->steps = s->run.steps;
    s->info->factorizations = s->run.factorizations;
    if (s->run.status != TRIBO_OK)
        s->status = s->run.status;
}

static int can_go_on(solver *s)
{
    return s->status == TRIBO_OK && halt(s) == 0 && s->run.steps < s->run.most_steps;
}

static double run_newton(solver *s, uint64_t steps, double *r)
{
    const double distance = newton_continue(s->newton, &s->run, steps, r);
    note_run(s);
    return distance;
}

/* Rounds of the interior method, from r = the best so far. */
static double run_interior(solver *s, const system_problem *p, const goal *wanted, double *r)
{
    double distance = judge(s, p, wanted, r).distance;
    const double first = distance;
    double before = HUGE_VAL;

    interior_start(s->newton);
    for (int i = 0; i < MOST_ROUNDS && distance > 1.0 && distance < ROUND_GAIN * before; i++) {
        before = distance;
        distance = interior_round(s->newton, &s->run, r);
        note_run(s);
    }
    if (distance > 1.0 && distance < ROUND_GAIN * first)
        newton_start(s->newton, p, wanted, &s->run, r);
    return distance;
}

static double friction_of(const double r[3])
{
    return sqrt(r[1] * r[1] + r[2] * r[2]);
}

/* 1 if the system rather stands, by what sweeps have made of it: they have taken most of the slip
 * away, and fewer than half of the closed contacts are on their cones. Returns 0 without sweeps. */
static int stands(solver *s, const system_problem *p, const double *swept)
{
    size_t closed = 0;
    size_t on_cones = 0;
    double slip = 0.0;
    double before = 0.0;

    s->is_current = 0;
    certificate_velocity(p, swept, s->dv, s->u);
    for (size_t c = 0; c < p->count; c++) {
        const double bound = p->mu[2 * c] * swept[3 * c];
        const double *u = s->u + 3 * c;
        const double *q = p->q + 3 * c;
        if (!(bound > 0.0))
            continue;
        closed++;
        on_cones += friction_of(swept + 3 * c) >= bound * (1.0 - EDGE) ? 1 : 0;
        slip += u[1] * u[1] + u[2] * u[2];
        before += q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    }
    return closed > 0 && 2 * on_cones <= closed && 4.0 * slip <= before;
}

/* 1 if most of the velocity at contacts is along them. Only for bodies, whose matrix is the same for
 * Newton and the path; one of blocks holds all contacts on the path, and those that are closed for
 * Newton. */
static int shears(const system_problem *p)
{
    double along = 0.0;
    double across = 0.0;

    for (size_t c = 0; c < p->count; c++) {
        const double *q = p->q + 3 * c;
        across += q[0] * q[0];
        along += q[1] * q[1] + q[2] * q[2];
    }
    return p->bodies != 0 && along > across;
}

static int is_zero(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++) {
        if (x[i] != 0.0)
            return 0;
    }
    return 1;
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

/* Leaps for the sweeps over this problem, or null: there are none with torques. */
static anderson *leaps_on(solver *s, const system_problem *p)
{
    if (s->anderson == NULL || !interior_possible(p))
        return NULL;
    anderson_start(s->anderson, p);
    return s->anderson;
}

/* What take_turns goes by. */
typedef struct turns {
    const goal *wanted;
    double price;
    uint32_t rounds_due; /* of the interior method */
    uint32_t path_due;   /* attempts at the path */
    uint32_t path_first;
    anderson *leaps;
    double *swept; /* where the sweeps are; the best of them is in `held`, */
    verdict least; /* and judged here */
    uint64_t *sweeps;
} turns;

/* As many sweeps as take as long as `steps` Newton steps. Returns 1 if they reach the goal: r
 * receives what they found. */
static int take_sweeps(solver *s, const system_problem *p, turns *t, double steps, double *r)
{
    const double due = t->price * steps / (t->leaps != NULL ? LEAPING : 1.0);
    const uint64_t left = s->most - *t->sweeps;
    const uint64_t most = *t->sweeps + (due < (double)left ? (uint64_t)due : left);

    const verdict start = judge(s, p, t->wanted, t->swept);
    const verdict last =
        sweep_on(s, p, t->wanted, most, 0.0, t->leaps, start, &t->least, t->swept, t->sweeps);
    s->growth = growth_of(s, p, t->wanted, last, t->swept);
    if (t->least.distance > 1.0)
        return 0;
    s->info->solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    copy(3 * (size_t)p->count, s->held, r);
    return 1;
}

/* The path of Coulomb's law, if it is due, first in long steps where they cost little. r is
 * `distance` from the goal, and the new one is returned. Newton can go on after. */
static double take_path(solver *s, const system_problem *p, turns *t, double distance, double *r)
{
    const uint32_t attempt = PATH_ATTEMPTS - t->path_due;

    if (distance <= 1.0 || t->path_due == 0 || !can_go_on(s))
        return distance;
    t->path_due--;
    if (attempt == 0 && t->price < DEAR) {
        distance = path_follow(s->newton, &s->run, r);
        note_run(s);
    }
    if (distance > 1.0 && can_go_on(s)) {
        const uint64_t steps = PATH_STEPS + p->count / CONTACTS_A_STEP;
        distance = path_trace(s->newton, &s->run, attempt,
                              steps < MOST_PATH_STEPS ? steps : MOST_PATH_STEPS, r);
        note_run(s);
    }
    if (distance > 1.0)
        newton_start(s->newton, p, t->wanted, &s->run, r);
    return distance;
}

/* The same of the interior method's rounds, and Newton after them. */
static double take_rounds(solver *s, const system_problem *p, turns *t, double distance,
                          uint64_t steps, double *r)
{
    if (distance <= 1.0 || t->rounds_due == 0 || !can_go_on(s))
        return distance;
    t->rounds_due = 0;
    distance = run_interior(s, p, t->wanted, r);
    return distance > 1.0 && can_go_on(s) ? run_newton(s, steps, r) : distance;
}

/* What goes before Newton: the path where bodies slide, and where Newton is dear rounds for what
 * stands, and sweeps that leap. Returns 1 if it gets there. */
static int lead_in(solver *s, const system_problem *p, turns *t, double *r)
{
    if (s->options->solver != TRIBO_SOLVER_NEWTON && !(t->price < DEAR)) {
        if (!is_zero(3 * (size_t)p->count, r))
            return 0;
        if (t->rounds_due != 0 && run_interior(s, p, t->wanted, r) <= 1.0)
            return 1;
        t->rounds_due = 0;
        return can_go_on(s) && take_sweeps(s, p, t, FIRST_LEAPS, r);
    }
    return t->path_first != 0 && !stands(s, p, t->swept) && take_path(s, p, t, HUGE_VAL, r) <= 1.0;
}

/* Newton, and once its first turn does not end rounds of the interior method and the path, that
 * first where bodies slide; by the automatic choice in turns with sweeps that leap, each from where
 * it was unless the sweeps are far ahead, for ever longer turns: the cost is at most about twice
 * that of the better one. */
static double run_turns(solver *s, const system_problem *p, turns *t, double *r)
{
    const uint32_t alone = s->options->solver == TRIBO_SOLVER_NEWTON;
    uint64_t turn = FIRST_TURN;

    const double first = newton_start(s->newton, p, t->wanted, &s->run, r);
    if (lead_in(s, p, t, r))
        return 0.0;
    for (;; turn *= 2) {
        const uint64_t before = s->run.steps;
        double distance = run_newton(s, t->rounds_due != 0 ? SHORT_TURN : turn, r);
        if (t->rounds_due != 0 && distance > 1.0 && distance <= WELL_ON_ITS_WAY * first)
            distance = run_newton(s, SHORT_TURN, r);
        if (t->path_first != 0)
            distance = take_path(s, p, t, distance, r);
        distance = take_rounds(s, p, t, distance, turn, r);
        if (t->path_first == 0)
            distance = take_path(s, p, t, distance, r);
        if (distance <= 1.0 || !can_go_on(s) || newton_stalls(s->newton, &s->run))
            return distance;
        if (!alone && take_sweeps(s, p, t, (double)(s->run.steps - before), r))
            return 0.0;
        if (!alone && t->least.residual < FAR_AHEAD * judge(s, p, t->wanted, r).residual) {
            copy(3 * (size_t)p->count, s->held, r);
            newton_start(s->newton, p, t->wanted, &s->run, r);
        }
    }
}

/* `swept` is where sweeps have led, judged as `least`, r where Newton starts; r receives the best of
 * all. */
static double take_turns(solver *s, const system_problem *p, const goal *wanted, double price,
                         verdict least, double *swept, uint64_t *sweeps, double *r)
{
    turns t = {.wanted = wanted,
               .price = price,
               .leaps = leaps_on(s, p),
               .swept = swept,
               .least = least,
               .sweeps = sweeps};

    t.path_due = interior_possible(p) != 0 ? PATH_ATTEMPTS : 0;
    t.path_first = price < DEAR && shears(p);
    t.rounds_due = t.path_due != 0 && (s->options->solver == TRIBO_SOLVER_NEWTON || price < DEAR ||
                                       stands(s, p, swept));
    copy(3 * (size_t)p->count, swept, s->held);
    s->info->solver = TRIBO_SOLVER_NEWTON;
    const double distance = run_turns(s, p, &t, r);
    if (distance <= 1.0)
        return distance;
    if (is_better(t.least, judge(s, p, wanted, r))) {
        s->info->solver = TRIBO_SOLVER_GAUSS_SEIDEL;
        copy(3 * (size_t)p->count, s->held, r);
    }
    return distance;
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
    anderson *leaps = use_newton || asked != TRIBO_SOLVER_AUTO ? NULL : leaps_on(s, p);
    verdict now = start;
    uint64_t sweeps = 0;

    *is_judged = 1;
    s->run.most_steps = s->most > UINT64_MAX - done ? UINT64_MAX : done + s->most;
    copy(numbers, r, s->start_r);
    if (now.distance > 1.0 && asked != TRIBO_SOLVER_NEWTON)
        now = sweep_from(s, p, wanted, s->most, price * FEW_STEPS, leaps, now, r, &sweeps);
    if (now.distance > 1.0 && use_newton && halt(s) == 0) {
        copy(numbers, r, s->swept);
        /* Sweeps spoil the contacts of a stack at rest, which Newton finds at once from nothing. */
        copy(numbers, s->start_r, r);
        now.distance = take_turns(s, p, wanted, price, now, s->swept, &sweeps, r);
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
    const double friction = friction_of(r);
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
