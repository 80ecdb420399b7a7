/* What the interior methods share: coordinates in which friction cones are round and dual to
 * themselves, and steps of Mehrotra's predictor and corrector. By contact
 *
 *   x = g (mu r_n, r_t),  y = (u_n / mu + s, u_t),  x . y = g r . (u + mu s e_n),
 *
 * g a power of two near |W|. Both are in Q = {|v_t| <= v_n}, and in the end x . y = 0. A contact of
 * one row has x = g r_n and y = u_n. Nesterov and Todd's scaling takes both to the same point,
 * V y = V^-1 x = lambda:
 *
 *   V = b [w_n, w_t^T; w_t, 1 + w_t w_t^T / (1 + w_n)],  V^2 = b^2 (2 w w^T - J),  w . J w = 1,
 *
 * J = diag(1, -1, -1), and e = (1, 0, 0). See Andersen, Roos & Terlaky, Math. Program. 95 (2003)
 * 249. The De Saxce term s is frozen, or that of the velocity itself where it `follows`. */
#ifndef TRIBO_CENTRAL_H
#define TRIBO_CENTRAL_H

#include "newton_state.h"

/* What a step is to bring, besides y = y(u) + s e: x o y = target e; the same with the second order
 * of the step in next_r and next_f; also with that of s, which follows; or only a change of x o y by
 * target e, from where it is. */
enum { AIM_PLAIN, AIM_SECOND, AIM_CURVED, AIM_ALONG };

/* x and y in the middle of the cones, `times` the greatest velocity. */
void central_start(newton *n, double times);

/* r of all x. */
void central_impulses(const newton *n, double *r);

/* next_u of where we are, which all below go by. Nothing is to be done where it is_placed. */
void central_place(newton *n);

/* Greatest |V (y(u) + s e - y)|^2 of a contact, over the gap. */
double central_lack(const newton *n, double gap);

/* The matrix of a step. Returns 0 at the edge of a cone. */
int central_law(newton *n);

/* The right-hand side of a step, after central_law. */
void central_aim(newton *n, uint32_t aim, double target);

/* Solve for `step`, or for another right-hand side with the matrix that is factored; what it does to
 * u goes to `moved`, q added. Returns 0 if the matrix is singular. */
int central_solve(newton *n, newton_run *run, int is_factored);

/* dx to next_r and dy to next_f, after central_solve. */
void central_directions(newton *n, uint32_t aim);

/* The share, at most 1, of dx and dy that stays in the cones. */
double central_share(const newton *n, const double *dx, const double *dy);

/* x and y go a share of next_r and next_f. */
void central_move(newton *n, double share);

/* Mean x . y. */
double central_gap(const newton *n);

/* Product of two steps, as V scales them. */
double central_inner(const newton *n, const double *ax, const double *ay, const double *bx,
                     const double *by);

/* One step towards x . y = 0. Returns the share of it that was gone; 0: no more can be done. */
double central_go(newton *n, newton_run *run);

/* 1 if the run may go on. */
int central_may_go(newton_run *run);

#endif
