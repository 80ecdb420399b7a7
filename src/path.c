#include "central.h"

#define FAR_START 10.0 /* times the greatest velocity */
#define READY 1e-8     /* x . y, of that of the start, from which Newton may end it */
#define RETRY 0.03     /* by which it falls until Newton tries again */
#define SLOW 0.95      /* near the end a step that leaves more is rounding's */
#define LEAST_GAP 1e-13
#define MOST_GAP 10.0 /* of that of the start: a path that goes back there ends nowhere */
#define QUICK_STEPS 60
#define SHORTEST 1e-3 /* of a quick step's length */
#define TRACE_STEPS 400
#define BOUNDARY 0.7 /* of the way to the edge of the cones, when the path is traced */
#define LONGEST 0.9  /* change of x . y along it, of what there is */
#define SHORTER 0.6  /* a change that leaves the cones is tried again */
#define SHORTENINGS 40
#define MOST_RISE 2.0 /* of x . y on the way back to the path, of what there is */

/* Where a run along the path is. */
typedef struct progress {
    double first; /* x . y at its start */
    double tried; /* where Newton tried last to end it, */
    double last;  /* and after the step before */
} progress;

static progress begin(newton *n)
{
    progress out;

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
    const int is_slow = is_ready && gap > SLOW * at->last;
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
    progress at = begin(n);
    double share = 1.0;

    for (int i = 0; i < QUICK_STEPS && share > SHORTEST && central_may_go(run); i++) {
        share = central_go(n, run);
        if (is_over(n, run, &at, r))
            break;
    }
    return n->reached.distance;
}

/* ---- tracing --------------------------------------------------------------------------------- */

/* The step to the path in u and f, and the direction of the path in along_x and along_y. Its sense is
 * that of the determinant's sign: x . y falls as long as that is as it was at the start, `turn`, and
 * rises where it is not, behind a fold or, where a contact's slip turns round, a kink. The angle to
 * the direction before would tell the one, but not the other. Returns 0 if there is none. */
static int look_around(newton *n, newton_run *run, double gap, int *turn)
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
    const double *dx = n->next_r;
    const double *dy = n->next_f;
    const double size = central_inner(n, dx, dy, dx, dy);
    const double rise = lesser(-central_inner(n, n->u, n->f, dx, dy) / size, MOST_RISE);
    const int now = step_turn(n);
    *turn = *turn != 0 ? *turn : now;
    for (size_t i = 0; i < numbers_of; i++) {
        n->u[i] += greater(rise, 0.0) * dx[i];
        n->f[i] += greater(rise, 0.0) * dy[i];
        n->along_x[i] = now == *turn ? -dx[i] : dx[i];
        n->along_y[i] = now == *turn ? -dy[i] : dy[i];
    }
    return 1;
}

/* One step back to the path and along it at once, as far as the cones let it. Returns its share. */
static double trace(newton *n, newton_run *run, int *turn)
{
    const double gap = central_gap(n);
    double ahead = LONGEST;
    double share = 0.0;

    central_place(n);
    run->steps++;
    if (!look_around(n, run, gap, turn))
        return 0.0;
    const double enough = 0.9 * lesser(1.0, BOUNDARY * central_share(n, n->u, n->f));
    for (int i = 0; i < SHORTENINGS && share < enough; i++, ahead *= SHORTER) {
        for (size_t k = 0; k < 3 * (size_t)n->problem->count; k++) {
            n->next_r[k] = n->u[k] + ahead * n->along_x[k];
            n->next_f[k] = n->f[k] + ahead * n->along_y[k];
        }
        share = BOUNDARY * central_share(n, n->next_r, n->next_f);
    }
    central_move(n, share);
    return share;
}

double path_trace(newton *n, newton_run *run, double *r)
{
    progress at = begin(n);
    double share = n->is_dense != 0 ? 1.0 : 0.0; /* else the sign of the determinant is not known */
    int turn = 0;

    for (int i = 0; i < TRACE_STEPS && share > 0.0 && central_may_go(run); i++) {
        share = trace(n, run, &turn);
        if (is_over(n, run, &at, r))
            break;
    }
    return n->reached.distance;
}
