#include "central.h"

#define FAR_START 10.0 /* times the greatest velocity */
#define READY 1e-8     /* x . y, of that of the start, from which Newton may end it */
#define RETRY 0.03     /* by which it falls until Newton tries again */
#define SLOW 0.95      /* near the end a step that leaves more is rounding's */
#define LEAST_GAP 1e-13
#define MOST_GAP 10.0 /* of that of the start: a path that goes back there ends nowhere */
#define QUICK_STEPS 60
#define SHORTEST 1e-3 /* of a quick step's length */
/* Of a step that is traced, the way to the edge of the cones; less where that is nearer. */
#define BOUNDARY 0.98
#define CAREFUL 0.9
#define NEARBY 0.3 /* share of the way to the path that stays in the cones: less is far from it */
#define FAR 0.1    /* share of the way along it: where it is less, all of it is gone */
#define ALLOWANCE 0.02   /* of that share */
#define LEAST_REST 1e-8  /* of the gap */
#define SECOND_ORDER 0.1 /* share of a step from which it is worth to correct it */
/* Share of a step below which s follows |u_t| at half the pace, so that it goes where it is drawn,
 * over a fold, and not where the law holds (Kelley & Keyes, SIAM J. Numer. Anal. 35 (1998) 508); and
 * above which at twice that, up to 1. */
#define HARD 0.2
#define EASY 0.5
#define LEAST_PACE 0.015625
#define SHORTEST_TRACED 1e-4 /* so many steps in a row, and it goes no further */
#define IDLE_STEPS 3

/* Where a run along the path is. */
typedef struct progress {
    double first; /* x . y at its start */
    double tried; /* where Newton tried last to end it, */
    double last;  /* and after the step before */
    int is_traced;
} progress;

static progress begin(newton *n, int is_traced)
{
    progress out = {.is_traced = is_traced};

    n->follows = 1;
    central_start(n, FAR_START);
    out.first = out.tried = out.last = central_gap(n);
    return out;
}

/* Judge where we are. Returns 1 if the run is at an end. */
static int is_over(newton *n, newton_run *run, progress *at, double *r)
{
    central_impulses(n, n->moved);
    newton_judge(n, n->moved);
    copy(3 * (size_t)n->problem->count, n->best, r);
    if (n->reached.distance <= 1.0)
        return 1;
    n->is_placed = is_same(3 * (size_t)n->problem->count, n->moved, n->next_r);
    const double gap = central_gap(n);
    const int is_ready = gap <= READY * at->first;
    const int is_slow = is_ready && !at->is_traced && gap > SLOW * at->last;
    at->last = gap;
    if (is_slow || (is_ready && gap <= RETRY * at->tried)) {
        at->tried = gap;
        n->is_placed = 0;
        if (newton_finish(n, run, n->moved, r) <= 1.0)
            return 1;
    }
    return is_slow || gap <= LEAST_GAP * at->first || !(gap <= MOST_GAP * at->first);
}

double path_follow(newton *n, newton_run *run, double *r)
{
    progress at = begin(n, 0);
    double share = 1.0;

    for (int i = 0; i < QUICK_STEPS && share > SHORTEST && central_may_go(run); i++) {
        share = central_go(n, run);
        if (is_over(n, run, &at, r))
            break;
    }
    return n->reached.distance;
}

/* ---- tracing --------------------------------------------------------------------------------- */

/* What is unlike in each attempt: where one goes astray, another may not. */
typedef struct manner {
    double most_lack; /* |V lack|^2 in gaps: where it is more, no way along the path */
    double slow;      /* share of what a step without a way along the path should take off the lack:
                         if it takes less, the pace is halved; 0: never */
    double settled;   /* |V lack|^2 below which the gap falls at less than the full pace too */
} manner;

static const manner manners[PATH_ATTEMPTS] = {
    {900.0, 0.0, 0.0}, {900.0, 0.3, 9.0}, {9.0, 0.0, 0.0}};

/* A run that is traced. */
typedef struct tracing {
    const manner *manner;
    int turn;       /* sign of the determinant at the start */
    int onwards;    /* sense of the direction along the path: 1 or -1, by log gap */
    double lacking; /* what central_lack was before the last step; 0 if that went along the path */
} tracing;

/* The step A to the path in u and f, and the direction B of the path, by log gap, in along_x and
 * along_y. Onwards the gap falls as long as the sign of the determinant is as it was at the start,
 * and rises where it is not, behind a fold or, where a contact's slip turns round, a kink (Allgower &
 * Georg, Introduction to Numerical Continuation Methods, SIAM (2003), 2.1). The angle to the
 * direction before would tell the one, but not the other. Returns 0 if there is none. */
static int look_around(newton *n, newton_run *run, double gap, tracing *t)
{
    const size_t numbers_of = 3 * (size_t)n->problem->count;

    if (!central_law(n))
        return 0;
    central_aim(n, AIM_PLAIN, gap);
    if (!central_solve(n, run, 0))
        return 0;
    central_directions(n, AIM_PLAIN);
    copy(numbers_of, n->next_r, n->u);
    copy(numbers_of, n->next_f, n->f);
    central_aim(n, AIM_ALONG, gap);
    if (!central_solve(n, run, 1))
        return 0;
    central_directions(n, AIM_ALONG);
    copy(numbers_of, n->next_r, n->along_x);
    copy(numbers_of, n->next_f, n->along_y);
    const int now = step_turn(n, run);
    t->turn = t->turn != 0 ? t->turn : now;
    t->onwards = now == t->turn ? -1 : 1;
    return now != 0;
}

/* A + change B to next_r and next_f. Returns the share of it that stays in the cones. */
static double combine(newton *n, double change)
{
    for (size_t k = 0; k < 3 * (size_t)n->problem->count; k++) {
        n->next_r[k] = n->u[k] + change * n->along_x[k];
        n->next_f[k] = n->f[k] + change * n->along_y[k];
    }
    return central_share(n, n->next_r, n->next_f);
}

/* Share of B, or of -B, that stays in the cones. Uses next_r and next_f. */
static double room_along(newton *n, double sense)
{
    for (size_t k = 0; k < 3 * (size_t)n->problem->count; k++) {
        n->next_r[k] = sense * n->along_x[k];
        n->next_f[k] = sense * n->along_y[k];
    }
    return central_share(n, n->next_r, n->next_f);
}

/* How far to go, in log gap to first order: to the nearest point of the path, as V scales the way
 * there, and along it where that is near. */
static double choose_change(newton *n, tracing *t, double gap, double lack)
{
    const double size = gap * (double)n->problem->count +
                        central_inner(n, n->along_x, n->along_y, n->along_x, n->along_y);
    const double shift = -central_inner(n, n->u, n->f, n->along_x, n->along_y) / size;
    const double sense = n->pace < 1.0 ? -1.0 : (double)t->onwards;
    double along = 0.0;

    t->lacking = lack;
    if (n->pace < 1.0 && lack > t->manner->settled)
        return 0.0;
    if (lack <= t->manner->most_lack && combine(n, shift) >= NEARBY) {
        const double both = combine(n, shift + sense);
        const double room = lesser(room_along(n, sense), both + ALLOWANCE);
        const double rest = 1.0 - lesser(1.0, room);
        t->lacking = 0.0;
        along = sense * (room > FAR ? 1.0 - rest * rest * rest : room);
    }
    return greater(shift + along, LEAST_REST - 1.0);
}

/* Go by A + change B, with its second order if that is worth it. Returns the share. */
static double move_corrected(newton *n, newton_run *run, double gap, double change)
{
    const size_t numbers_of = 3 * (size_t)n->problem->count;
    double share = combine(n, change);

    if (share > SECOND_ORDER) {
        copy(numbers_of, n->next_r, n->u);
        copy(numbers_of, n->next_f, n->f);
        central_aim(n, AIM_CURVED, gap * (1.0 + change));
        if (!central_solve(n, run, 1))
            return 0.0;
        central_directions(n, AIM_CURVED);
        const double corrected = central_share(n, n->next_r, n->next_f);
        if (corrected < 0.5 * share) {
            copy(numbers_of, n->u, n->next_r);
            copy(numbers_of, n->f, n->next_f);
        } else {
            share = corrected;
        }
    }
    const double part = lesser(1.0, (share < CAREFUL ? CAREFUL : BOUNDARY) * share);
    central_move(n, part);
    return part;
}

/* One step back to the path and along it at once. Returns its share. */
static double trace(newton *n, newton_run *run, tracing *t)
{
    const double gap = central_gap(n);

    central_place(n);
    run->steps++;
    const double lack = central_lack(n, gap);
    if (!look_around(n, run, gap, t))
        return 0.0;
    const double due = 1.0 - t->manner->slow * n->pace;
    const int is_slow = t->manner->slow > 0.0 && t->lacking > 0.0 && lack > due * due * t->lacking;
    const double share = move_corrected(n, run, gap, choose_change(n, t, gap, lack));
    if (share < HARD || is_slow)
        n->pace = greater(0.5 * n->pace, LEAST_PACE);
    else if (share > EASY)
        n->pace = lesser(2.0 * n->pace, 1.0);
    return share;
}

double path_trace(newton *n, newton_run *run, uint32_t attempt, uint64_t steps, double *r)
{
    progress at = begin(n, 1);
    tracing t = {.manner = manners + attempt};
    uint32_t idle = 0;

    for (uint64_t i = 0; i < steps && idle < IDLE_STEPS && central_may_go(run); i++) {
        const double share = trace(n, run, &t);
        idle = share < SHORTEST_TRACED ? idle + 1 : 0;
        if (share == 0.0 || is_over(n, run, &at, r))
            break;
    }
    return n->reached.distance;
}
