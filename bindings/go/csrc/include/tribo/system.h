/**
 * @file system.h
 * Many contacts coupled through their bodies: exact Coulomb friction to the accuracy that the
 * caller asks for, with a certificate.
 *
 * A problem comes in one of two forms: bodies with contacts (tribo_system_solve), or assembled
 * (tribo_system_solve_assembled) as the public collections of frictional-contact problems store it.
 * Both have the same solvers, options and certificate:
 *
 *   u = W r + q,   u' = u + mu |u_t| e_n,   K* contains u',   u' . r = 0,   K contains r
 *
 * per contact, with K the friction cone |r_t| <= mu r_n and K* its dual (De Saxce & Feng, Math.
 * Comput. Model. 28 (1998) 225). That is Signorini's and Coulomb's law, not its convex relaxation.
 * Impulses and velocities are in contact coordinates (n, t1, t2), the frame that
 * tribo_basis_from_normal gives.
 *
 * Static friction above dynamic friction: a contact that sticks may need up to mu_s r_n; one that
 * slides has |r_t| = mu_d r_n.
 *
 * Rolling and spinning resistance: a contact may also pass a torque tau (N m s as impulse, on A, in
 * contact coordinates) that its two lengths bound,
 *
 *   |tau_t| <= rolling r_n,  and = rolling r_n, opposite to omega_t, where omega_t is not 0,
 *   |tau_n| <= spinning r_n, and = spinning r_n, opposite to omega_n, where omega_n is not 0,
 *
 * omega = omega_A - omega_B. With u' = u + (mu |u_t| + rolling |omega_t| + spinning |omega_n|) e_n
 * this is complementarity on one cone of r and tau (Acary & Bourrier, Eur. J. Mech. A/Solids 85
 * (2021), for rolling). An implicit law: what it stops, stands still and does not turn back. Where
 * there is restitution, torques come with the plastic solution and with Newton's; the frictionless
 * way between them has none. What torques cost is paid where they are set: a contact with both
 * lengths 0 has the rows, the bits and the price that it has without them.
 *
 * Memory is the caller's: ask for the size, give a buffer. Nothing is kept between calls but what
 * the caller keeps (impulses for a warm start). See base.h for the rules on aliasing and threads.
 */
#ifndef TRIBO_SYSTEM_H
#define TRIBO_SYSTEM_H

#include <tribo/batch.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One contact between two bodies of a system. 152 bytes.
 *
 *  Rows: one with dimension 1, or with mu_s = 0 and both lengths 0; three with friction; six with
 *  a length > 0. An axis whose length is 0 has no torque. */
typedef struct tribo_system_contact {
    uint32_t a;            /**< index of body A, or TRIBO_WORLD */
    uint32_t b;            /**< index of body B, or TRIBO_WORLD; not that of A */
    uint32_t dimension;    /**< 3; or 1: frictionless, one row whatever the pair's friction and the
                                lengths are */
    uint32_t reserved;     /**< 0 */
    tribo_contact contact; /**< normal and arms */
    tribo_material pair;   /**< mu_s, mu_d, e */
    double target[3];      /**< m/s, in contact coordinates: u - target takes the place of u in the
                               laws of contact. Normal: -g/dt lets a gap g close and no more;
                               tangential: the speed of a belt */
    double rolling;        /**< m, >= 0: greatest torque about a tangent, of r_n; 0: none */
    double spinning;       /**< m, >= 0: greatest torque about the normal, of r_n; 0: none */
} tribo_system_contact;

/** Solvers. */
enum {
    /** Gauss-Seidel first; then Newton, in turns with sweeps that Anderson's method accelerates
     *  (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), for the components of the system that it
     *  does not finish. */
    TRIBO_SOLVER_AUTO = 0,
    /** Sweeps of the exact solve of one contact after the other (Jourdan, Alart & Jean, Comput.
     *  Methods Appl. Mech. Eng. 155 (1998) 31). */
    TRIBO_SOLVER_GAUSS_SEIDEL = 1,
    /** Proximal point and semismooth Newton, in the bodies' velocities or on W; and where that does
     *  not end soon, an interior-point method on the convex neighbour of the problem (Anitescu,
     *  Math. Program. 105 (2006) 113), which finds how a system can stand, whatever its size, and
     *  the central path of Coulomb's law itself, followed where it turns back, too. Where bodies
     *  slide over each other that path goes first. */
    TRIBO_SOLVER_NEWTON = 2
};

/** What the tolerance bounds. */
enum {
    /** The greatest eta of the contacts: tribo_measures of audit.h, with all of W. */
    TRIBO_MEASURE_ETA = 0,
    /** sqrt(sum |s r - P_K(s r - u')|^2) / |q| over all contacts, s the mean diagonal entry of
     *  W. */
    TRIBO_MEASURE_INVARIANT = 1
};

/** Why a solve ended. */
enum {
    TRIBO_STOP_TOLERANCE = 0,  /**< the tolerance is met */
    TRIBO_STOP_ITERATIONS = 1, /**< max_iterations were done */
    TRIBO_STOP_TIME = 2,       /**< max_seconds are over */
    TRIBO_STOP_CANCEL = 3,     /**< the progress callback asked for it */
    TRIBO_STOP_STALL = 4,      /**< no solver makes progress any more */
    TRIBO_STOP_JAM = 5         /**< no bounded impulses exist, or none that double can hold: the
                                    least-bad ones found are returned */
};

/** Certificate: how far the impulses are from the exact law. Per-contact measures are those of
 *  audit.h with the scales V = |q_c| + |sum |W_cj||r_j|| and P = V / greatest diagonal entry of
 *  W_cc; in the bodies form the sum is taken body by body, |J_c| |M^-1| sum |J_j^T||r_j|, which is
 *  somewhat more. A contact is judged by mu_d; by mu_s where that is nearer, and then its sliding
 *  velocity counts in full: over V in eta, squared in the sums of invariant and siconos. One-row
 *  contacts are judged as contacts without friction. With restitution the measures judge the
 *  plastic solution that it is built on.
 *
 *  The torque of a contact with a length is judged beside its impulse, and the worse of the two
 *  counts: eta is |tau - P(tau - s omega)| / T with P the nearest torque within the bounds, 1 / s
 *  the greatest diagonal entry of its 3x3 matrix W_tau (omega = W_tau tau + ...), T = s Omega, and
 *  Omega the scale of omega as V is that of u, with V / arm added to it. The arm is about the
 *  radius of gyration: the power of two with the binary exponent (x - y) / 2, rounded down, where x
 *  and y are those of the greatest entries on the diagonals of W_cc and W_tau. Sums over contacts
 *  (invariant, siconos, energy_scale, |q|) take arm omega for one more u and tau / arm for its r.
 *  Cone is max(0, |tau| - bound) / T, misalignment | |omega| tau + bound omega | / (T Omega).
 *
 *  TRIBO_STOP_TOLERANCE by eta also promises eta V <= a tenth of the greatest |q|: where impulses
 *  grow without bound, eta falls though nothing is solved. Of contacts with mu_d above 1 it promises
 *  signorini within the tolerance too: eta divides by mu what normal velocities leave open. */
typedef struct tribo_system_info {
    uint32_t struct_size;    /**< sizeof(tribo_system_info), set by the caller; of a smaller one
                                  what lies beyond it is not computed either */
    uint32_t stop;           /**< TRIBO_STOP_... */
    uint32_t solver;         /**< the TRIBO_SOLVER_... that gave the result */
    uint32_t components;     /**< connected components (islands) of the system */
    uint64_t sweeps;         /**< Gauss-Seidel sweeps, of the component that had most */
    uint64_t steps;          /**< Newton's and interior steps, over all components */
    uint64_t factorizations; /**< matrices factored */
    double eta;              /**< greatest natural-map residual of a contact, no unit */
    double eta_rms;          /**< root mean square of the same */
    double signorini;        /**< greatest |min(u_n / V, r_n / P)| */
    double cone;             /**< greatest max(0, |r_t| - mu r_n) / P */
    double misalignment;     /**< greatest | |u_t| r_t + mu r_n u_t | / (P V) */
    double invariant;        /**< as in TRIBO_MEASURE_INVARIANT; |q| = 0 gives 0 */
    double siconos;          /**< sqrt(sum |r - P_K(r - u')|^2) / max(|q|, |r|, |u|): the measure of
                                  Siconos 4.4, not free of units; not divided by less than 2^-52 */
    double energy;           /**< change of kinetic energy by the impulses, r . (q + u) / 2, J;
                                  without the work of targets */
    double energy_scale;     /**< sum |r_c| (|q_c| + |u_c|) / 2, J: what energy is measured
                                  against */
    double linear;           /**< |change of total linear momentum, impulses of the world counted| /
                                  sum m |dv|; 0 in the assembled form */
    double angular;          /**< the same of angular momentum about the origin; of meaning where
                                  the arms of each contact meet, and no axis is locked */
    double restitution;      /**< least share of the restitution stage that the energy allowed, 0 to
                                  1; 1 where there is none */
    double seconds;          /**< by the clock in the options; 0 without one */
    uint64_t bytes;          /**< of the workspace that were used */
} tribo_system_info;

/** Factorise the n x n matrix with rows row_starts[i] to row_starts[i + 1] of `columns` (ascending
 *  in each row) and `values`. symmetric = 1: it is symmetric, positive definite but for rounding,
 *  and only entries with column <= row are given. The arrays stay as they are until the last solve.
 *  @return TRIBO_OK; TRIBO_ERROR_CONTACT_MATRIX if it is singular; any other status. */
typedef tribo_status (*tribo_factor_function)(void *context, uint32_t n, const uint32_t *row_starts,
                                              const uint32_t *columns, const double *values,
                                              uint32_t symmetric);

/** Replace x by the solution for the right-hand side x, n numbers. */
typedef tribo_status (*tribo_solve_function)(void *context, double *x);

/** Tell the sign of the determinant of the matrix that was factorised last: -1 or 1.
 *  @return TRIBO_OK; any other status ends the solve with it, but for TRIBO_ERROR_CONTACT_MATRIX: the
 *          sign is not known. */
typedef tribo_status (*tribo_sign_function)(void *context, int32_t *sign);

/** Factorise and solve sparse linear systems for Newton: a user's own, or tribo_sparse of
 *  libtribo. Without one, systems up to `dense_limit` unknowns are factored by dense elimination;
 *  so they are, and narrow matrices of more unknowns, with one. */
typedef struct tribo_linear {
    uint32_t struct_size; /**< sizeof(tribo_linear), or offsetof(tribo_linear, sign) */
    uint32_t reserved;    /**< 0 */
    void *context;        /**< handed to all functions */
    tribo_factor_function factor;
    tribo_solve_function solve;
    /** May be null, or beyond struct_size: piles that creep may end unsolved then, for the path of
     *  Coulomb's law is followed by this sign. */
    tribo_sign_function sign;
} tribo_linear;

/** Called with what is known so far; return other than 0 to stop. */
typedef uint32_t (*tribo_progress_function)(void *user, const tribo_system_info *info);

/** Run task(data, i) for each i from 0 to count - 1, in any order, on any threads, and return when
 *  all are done. */
typedef void (*tribo_parallel_function)(void *user, void (*task)(void *data, uint32_t i),
                                        void *data, uint32_t count);

/** A clock in seconds from any moment on. */
typedef double (*tribo_clock_function)(void *user);

/** Options. All zeros but struct_size is the default. */
typedef struct tribo_system_options {
    uint32_t struct_size;    /**< sizeof(tribo_system_options) */
    uint32_t solver;         /**< TRIBO_SOLVER_... */
    uint32_t measure;        /**< TRIBO_MEASURE_... */
    uint32_t isa;            /**< TRIBO_ISA_... of the sweeps; no bit depends on it */
    uint32_t warm_start;     /**< 1: `impulses` holds a start; 0: start from zero */
    uint32_t tasks;          /**< most tasks to hand to `parallel` at once; 0 counts as 1. No bit
                                   depends on it */
    uint64_t max_iterations; /**< of sweeps, and of Newton steps; 0: 1 000 000 */
    double tolerance;        /**< 0: 1e-10; else > 0 */
    double max_seconds;      /**< 0: no limit; else > 0, and a clock. Looked at between sweeps and
                                   steps */
    uint32_t dense_limit;    /**< most unknowns of a dense matrix; 0: 192. The workspace grows with
                                   its square. Narrow matrices of more unknowns (towers, chains) are
                                   kept in the same memory, if they fit in */
    uint32_t reserved;       /**< 0 */
    const tribo_linear *linear;       /**< may be null */
    tribo_progress_function progress; /**< may be null */
    tribo_parallel_function parallel; /**< may be null: all in the caller's thread */
    tribo_clock_function clock;       /**< may be null: no time is measured */
    void *user;                       /**< handed to progress, parallel and clock */
    double *torques; /**< width 3: receives the torques on A of all contacts, N m s; 0 where both
                          lengths are 0. Holds their start if warm_start is 1. May be null: they
                          start from 0 and are not told. Bodies form only */
} tribo_system_options;

/** Bytes of workspace for tribo_system_solve.
 *  @param options may be null: defaults
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_INDEX,
 *          TRIBO_ERROR_CAPACITY (more than 2^31 bodies or contacts, or a size beyond size_t). */
TRIBO_API tribo_status tribo_system_workspace_size(size_t body_count, size_t count,
                                                   const tribo_system_contact *contacts,
                                                   const tribo_system_options *options,
                                                   size_t *size);

/** Solve a system of bodies and contacts.
 *  @param body_count bodies; those with zero inverse mass and inertia do not move, any number of
 *                    them
 *  @param bodies     body_count bodies, with the velocities before the contacts act (forces of the
 *                    step added)
 *  @param count      contacts
 *  @param contacts   count contacts
 *  @param options    may be null: defaults
 *  @param workspace  aligned for double; may be null if its size is 0
 *  @param size       of the workspace, bytes
 *  @param impulses   width 3: receives impulses on A, N s; holds the start if warm_start is 1
 *  @param velocities width 6: receives v, m/s, and omega, rad/s, of each body; may be null
 *  @param info       may be null
 *  @return TRIBO_OK whatever the certificate says: see info->stop; TRIBO_ERROR_NULL,
 *          TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_ISA, TRIBO_ERROR_INDEX,
 *          TRIBO_ERROR_ALIAS (A is B), TRIBO_ERROR_CAPACITY (workspace), TRIBO_ERROR_NOT_FINITE, a
 *          status of tribo_body_check, tribo_material_check, TRIBO_ERROR_FRICTION (a length < 0),
 *          TRIBO_ERROR_NORMAL, TRIBO_ERROR_IMMOVABLE (neither body of a contact can move along its
 *          normal), TRIBO_ERROR_RANGE (numbers beyond double), or a status of options->linear. */
TRIBO_API tribo_status tribo_system_solve(size_t body_count, const tribo_body *bodies, size_t count,
                                          const tribo_system_contact *contacts,
                                          const tribo_system_options *options, void *workspace,
                                          size_t size, double *impulses, double *velocities,
                                          tribo_system_info *info);

/** Bytes of workspace for tribo_system_solve_assembled. Parameters and statuses as there. */
TRIBO_API tribo_status tribo_system_assembled_workspace_size(size_t count,
                                                             const uint32_t *row_starts,
                                                             const uint32_t *columns,
                                                             const tribo_system_options *options,
                                                             size_t *size);

/** Solve an assembled problem u = W r + q. W need not be symmetric (implicit integrators of
 *  gyroscopic terms give such ones) nor of full rank; it is solved as it is given.
 *  @param count      contacts
 *  @param row_starts count + 1 numbers: blocks row_starts[i] to row_starts[i + 1] - 1 stand in
 *                    block row i. Null: W is dense, all count^2 blocks
 *  @param columns    block columns, ascending in each row; the diagonal block is always there. Null
 *                    with row_starts
 *  @param blocks     width 9: 3x3 blocks, each row by row. If row_starts is null, W as one dense
 *                    matrix of 3 count rows, row by row
 *  @param q          width 3, m/s
 *  @param mu         width 2: mu_s, mu_d. mu_s = 0 costs one row
 *  @param impulses   width 3: receives r; holds the start if warm_start is 1
 *  @param velocities width 3: receives u = W r + q; may be null
 *  @return as tribo_system_solve; TRIBO_ERROR_INDEX for a bad row_starts or columns;
 *          TRIBO_ERROR_FRICTION; TRIBO_ERROR_CONTACT_MATRIX (a diagonal block that is not positive
 *          semidefinite), TRIBO_ERROR_IMMOVABLE (W_nn = 0 in a diagonal block). */
TRIBO_API tribo_status tribo_system_solve_assembled(size_t count, const uint32_t *row_starts,
                                                    const uint32_t *columns, const double *blocks,
                                                    const double *q, const double *mu,
                                                    const tribo_system_options *options,
                                                    void *workspace, size_t size, double *impulses,
                                                    double *velocities, tribo_system_info *info);

/** Give the velocities of tribo_system_solve to the bodies.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_system_apply(size_t body_count, tribo_body *bodies,
                                          const double *velocities);

#ifdef __cplusplus
}
#endif

#endif
