/* Proximal point and semismooth Newton: the accurate end of the solvers of a system.
 *
 * Each proximal step replaces W by W + alpha 1 and q by q - alpha r_k, which is regular whatever
 * the rank of W is, and has the solution of the problem as its fixed point; alpha then vanishes. A
 * step is solved by Newton on the natural map F_c = g_c r_c - P_K(g_c r_c - u'_c), g_c about
 * |W_cc|: see Acary, Bremond & Huber, INRIA RR-9118 (2018), 4, for the family of such methods. */
#ifndef TRIBO_NEWTON_H
#define TRIBO_NEWTON_H

#include "arena.h"
#include "certificate.h"

typedef struct newton newton;

/* What bounds a run, and what it took. */
typedef struct newton_run {
    uint64_t most_steps;
    uint32_t isa;
    uint32_t dense_limit;
    tribo_linear linear;             /* without functions: none */
    uint32_t (*halt)(void *context); /* other than 0: stop */
    void *context;

    uint64_t steps;
    uint64_t factorizations;
    uint32_t halted; /* what `halt` returned */
    double growth;   /* certificate_growth of the last impulses, not of the best; where they miss
                            the goal */
    tribo_status status; /* of `linear`; else TRIBO_OK */
} newton_run;

/* 1 if matrices of this problem can be factored at all. */
uint32_t newton_possible(uint32_t count, uint32_t bodies, const newton_run *run);

/* Take the memory for problems of up to this size: `links` counts the blocks of W, or twice the
 * contacts in the bodies form; `torques` of the contacts are torques. */
newton *newton_take(arena *a, uint32_t count, uint32_t bodies, uint32_t torques, size_t links,
                    const newton_run *run);

/* Order the unknowns of this problem. Returns about how many sweeps take as long as a step on it. */
double newton_price(newton *n, const system_problem *problem, const newton_run *run);

/* Start from r on the problem of the last newton_price; it and `wanted` must last until the last
 * newton_continue. Returns the distance of r from the goal. */
double newton_start(newton *n, const system_problem *problem, const goal *wanted,
                    const newton_run *run, const double *r);

/* Go on for some `steps` until the goal is met. r receives the best impulses since the start, in
 * the cone; returns their distance from the goal. */
double newton_continue(newton *n, newton_run *run, uint64_t steps, double *r);

/* The convex neighbour of the problem, by an interior-point method: with the De Saxce term frozen it
 * is complementarity on round cones with a symmetric matrix, which that method solves in some ten to
 * thirty steps whatever its size and its rank (Anitescu, Math. Program. 105 (2006) 113; Acary,
 * Cadoux, Lemarechal & Malick, ZAMM 91 (2011) 155). The term starts as 0, so that what can stand
 * still does; each round freezes it at the slip of the round before, and the fixed point is
 * Coulomb's law. Newton has no such path through systems of many contacts at rest, whose solutions
 * with a proximal term turn back again and again as it vanishes. Call newton_start before. */
void interior_start(newton *n);

/* 1 if there are such rounds: a problem without torques. */
uint32_t interior_possible(const system_problem *problem);

/* One round; r receives the best impulses since newton_start. Returns their distance. */
double interior_round(newton *n, newton_run *run, double *r);

/* The central path of Coulomb's law itself: x o y = t e, with the De Saxce term that of the velocity.
 * For each t there is such a point (freeze the term: one point; the fixed point is Brouwer's), and
 * where t is large but one, so that the path from there leads to t = 0, though it may turn back on
 * its way. path_follow takes it in long steps, some fifteen to thirty, until they fail; path_trace
 * in some `steps` measured along it (Keller, in Rabinowitz (ed.), Applications of bifurcation theory,
 * 1977, 359), which pass where t turns; each attempt in its own manner. Newton ends both. Call
 * newton_start before and, unless the goal is met, after; interior_possible tells of which problems.
 * r receives the best impulses since; they return their distance. */
#define PATH_ATTEMPTS 3
double path_follow(newton *n, newton_run *run, double *r);
double path_trace(newton *n, newton_run *run, uint32_t attempt, uint64_t steps, double *r);

/* A few of Newton's steps `from` impulses nearby, as long as they bring the distance down by much. r
 * receives the best impulses since newton_start; returns their distance. */
double newton_finish(newton *n, newton_run *run, const double *from, double *r);

/* 1 if the last many steps brought nothing. */
uint32_t newton_stalls(const newton *n, const newton_run *run);

#endif
