/* The state of a solve by Newton's method, and its linear steps: shared by the proximal method, the
 * interior one and the elimination. */
#ifndef TRIBO_NEWTON_STATE_H
#define TRIBO_NEWTON_STATE_H

#include "dense.h"
#include "natural.h"
#include "newton.h"

struct newton {
    const system_problem *problem;
    const goal *wanted;
    double size;  /* mean |W_cc| */
    double fall;  /* of alpha */
    double known; /* |F| of r for center = r, if f and mode are its; else negative */
    double outer; /* |F| without the proximal term, and the distance from the goal */
    double distance;
    uint64_t won;      /* step that brought something last */
    uint64_t renewed;  /* step that found the best impulses so far */
    uint32_t on_floor; /* 1: eta is down at rounding, and falls no further */
    double alpha;
    verdict reached;      /* by the best impulses */
    uint32_t sweeps;      /* of the next smoothing */
    double blur;          /* greatest step_error over |F| in the last proximal step */
    uint32_t inner_steps; /* that a proximal step may take */
    double unit;          /* bodies: power of two near the greatest W_cc */

    double *r, *center, *u, *f;       /* where we are: 3 per contact */
    double *next_r, *next_u, *next_f; /* where a step would lead */
    double *step, *moved, *best;      /* dr, a scratch, and the best impulses */
    double *right;                    /* F, without E where a contact sticks */
    double *gain;                     /* g_c */
    double *primal, *dual;            /* interior: x and y, 3 per contact */
    double *slip;                     /* interior: s, the De Saxce term over mu, unless ... */
    uint32_t follows;   /* 1: it is that of the velocity; then `slip` is the second order of that */
    double pace;        /* share of its change that a step takes */
    uint32_t is_placed; /* 1: next_u is that of x */
    uint32_t is_exact;  /* 1: the matrix needs no refinement */
    double *rest;       /* of the equations of a step: 3 per contact */
    double *along_x, *along_y; /* direction of the path that is traced: 3 per contact */
    double *lead;              /* of torques, 3 per contact: what the normal impulse does to F */
    double *dv;                /* 6 per body */
    double *slope, *own;       /* P E and A = g (1 - P) + alpha P E: 9 per contact */
    uint8_t *mode, *next_mode;

    double *half;    /* bodies: J (unit M)^-1/2, 3 x 12 per contact, those of a before those of b:
                        unit W = half half^T */
    double *root;    /* bodies: (unit M)^-1/2 of inertia, lower triangle, 6 per body */
    uint32_t *place; /* bodies: where the blocks aa, ab, ba, bb start; assembled: first row */
    uint32_t *starts, *neighbours; /* bodies: block rows */
    uint32_t
        *rank; /* where the matrix is dense, neighbours are near each other in it. Bodies: their
                       block rows; assembled: contacts in the order of their rows */

    uint32_t *row_starts, *columns; /* the matrix: rows of scalars, or dense */
    double *values, *x, *dense;
    uint32_t *pivots;
    size_t room;       /* numbers in `dense` */
    dense_shape shape; /* of the matrix, where it is dense */
    uint32_t is_dense;
    const dense_table *kernels;             /* of the instruction set */
    uint32_t *lower_starts, *lower_columns; /* bodies: its lower triangle, if it is symmetric */
    double *lower_values;
    uint32_t symmetric_w; /* 1: W is symmetric but for rounding */
    uint32_t symmetric;   /* 1: so is the matrix of this step */
};

static inline uint32_t unknowns(uint32_t count, uint32_t bodies)
{
    return bodies != 0 ? 6 * bodies : 3 * count;
}

static inline double *numbers(arena *a, size_t count)
{
    return arena_take(a, count, sizeof(double));
}

static inline void copy(size_t count, const double *from, double *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

static inline uint32_t is_same(size_t count, const double *a, const double *b)
{
    for (size_t i = 0; i < count; i++) {
        if (a[i] != b[i])
            return 0;
    }
    return 1;
}

static inline double coefficient(const newton *n, size_t c)
{
    return n->problem->mu[2 * c];
}

static inline void apply3(const double a[9], const double x[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2];
}

/* Natural map without the proximal term, and the distance from the goal, of r brought into the
 * cone; kept if it is the best so far. That r, and u, F and modes of it, go to next_r and so on; where
 * r is n->r, n->u must be its. */
double newton_judge(newton *n, const double *r);

/* Memory of the matrices. */
void step_take(newton *n, arena *a, uint32_t count, uint32_t bodies, size_t links,
               const newton_run *run);

/* What all steps on this problem have in common, its unknowns being in order. */
void step_prepare(newton *n, const newton_run *run);

/* Solve own dr + slope W dr = -right for `step` = dr, contact by contact coupled by W; mode is OPEN
 * where dr = -r. Bodies: `slope` becomes own^-1 slope. `symmetric` tells that own^-1 slope (bodies)
 * or slope W + own (blocks) is. Returns 0 if it is singular. */
int step_solve(newton *n, newton_run *run);

/* The same for another `right`, after a step_solve whose own is 1 (bodies), with its matrix. */
int step_again(newton *n, newton_run *run);

/* By how much rounding missed the equations of step_solve, as a velocity: next_u is that of r + step. */
double step_error(const newton *n);

/* Sign of the determinant of the matrix that step_solve has factored; 0 where `linear` does not tell
 * it. */
int step_turn(const newton *n, newton_run *run);

#endif
