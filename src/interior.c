#include "central.h"

#include "resist.h"

#define MOST_STEPS 60
#define INNER_TOLERANCE 1e-10 /* of x . y and of y - y(u), against those of the start */
#define SURPLUS 1e-3          /* of the goal's distance: the last steps gain most */
#define SHORTEST 1e-4         /* of a step's length: it goes no further */
/* Where the convex problem gets nearer to its own solution, but not to that of Coulomb's law: steps
 * without progress, and how far x . y falls meanwhile. */
#define PATIENCE 4
#define PROGRESS 0.9
#define IDLE_FALL 1e-3

static void keep_slip(newton *n)
{
    central_place(n);
    for (size_t c = 0; c < n->problem->count; c++) {
        const double *u = n->next_u + 3 * c;
        n->slip[c] = coefficient(n, c) > 0.0 ? sqrt(u[1] * u[1] + u[2] * u[2]) : 0.0;
    }
}

uint32_t interior_possible(const system_problem *problem)
{
    for (size_t c = 0; c < problem->count; c++) {
        if (resist_is_torque(problem, c))
            return 0;
    }
    return 1;
}

void interior_start(newton *n)
{
    for (size_t c = 0; c < n->problem->count; c++)
        n->slip[c] = 0.0;
}

/* What the best distance in a round was, when, and x . y then. */
typedef struct progress {
    double distance, gap;
    int step;
} progress;

/* Note where a round is. Returns 1 if it leads elsewhere. */
static int is_idle(const newton *n, int step, double gap, progress *best)
{
    if (n->distance < PROGRESS * best->distance) {
        best->distance = n->distance;
        best->gap = gap;
        best->step = step;
    }
    return step - best->step >= PATIENCE || gap < IDLE_FALL * best->gap;
}

double interior_round(newton *n, newton_run *run, double *r)
{
    const double held = n->distance;
    progress best = {HUGE_VAL, 0.0, 0};
    double share = 1.0;

    n->follows = 0;
    central_start(n, 1.0);
    const double enough = INNER_TOLERANCE * central_gap(n);
    for (int i = 0; i < MOST_STEPS && share > SHORTEST && central_may_go(run); i++) {
        share = central_go(n, run);
        central_impulses(n, n->moved);
        const double before = n->distance;
        newton_judge(n, n->moved);
        const double gap = central_gap(n);
        if (gap <= enough || n->distance <= SURPLUS || is_idle(n, i, gap, &best) ||
            (n->reached.distance <= 1.0 && n->distance > 0.3 * before))
            break;
    }
    keep_slip(n);
    n->distance = held;
    copy(3 * (size_t)n->problem->count, n->best, r);
    return n->reached.distance;
}
