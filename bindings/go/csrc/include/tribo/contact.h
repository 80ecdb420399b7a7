/**
 * @file contact.h
 * One contact between two bodies: frame, contact matrix, friction cone, exact Signorini-Coulomb
 * solve, impact laws, and a whole collision in one call.
 *
 * Conventions: the normal n points from body B to body A. Contact coordinates are ordered (n, t1,
 * t2). u = v_A - v_B at the contact point; u_n < 0 is approach. The impulse p acts as +p on A and
 * -p on B, so u+ = u- + W p, with W the symmetric contact matrix stored as (nn, n1, n2, 11, 12,
 * 22), 1/kg.
 *
 * Shapes and the rules on aliasing, threads and NaN: see base.h.
 */
#ifndef TRIBO_CONTACT_H
#define TRIBO_CONTACT_H

#include <tribo/body.h>
#include <tribo/material.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Geometry of one contact. Arms instead of a point keep it exact far from the origin. 72 bytes. */
typedef struct tribo_contact {
    double normal[3]; /**< unit to 1e-12, world axes, from B to A */
    double arm_a[3];  /**< contact point minus centre of mass of A, world axes, m */
    double arm_b[3];  /**< contact point minus centre of mass of B, world axes, m */
} tribo_contact;

/** What a contact does. */
enum {
    TRIBO_MODE_OPEN = 0,  /**< separates, or no impulse is needed */
    TRIBO_MODE_STICK = 1, /**< friction takes all sliding it is asked to, within mu_s p_n */
    TRIBO_MODE_SLIP = 2,  /**< the impulse lies on the friction cone of mu_d */
    TRIBO_MODE_JAM = 3    /**< batch only: no bounded impulse exists */
};

/** Impact laws. With u- before and u+ after the impact, e restitution, p the impulse: */
enum {
    /** Chatterjee & Ruina, J. Appl. Mech. 65 (1998) 939: P = (1+e) P_I + kappa (P_II - P_I), P_I
     *  the frictionless plastic and P_II the sticking plastic impulse, kappa = 1 + e_t, or the
     *  greatest smaller value that keeps P in the friction cone. u_n+ = -e u_n-; the cone holds;
     *  and, because P_I and P_II - P_I are W-orthogonal, energy never grows:
     *  dT = -(1-e^2)/2 |P_I|^2_W - kappa (2 - kappa)/2 |P_II - P_I|^2_W. Closed form. */
    TRIBO_LAW_ALGEBRAIC = 0,
    /** p = -(1+e) u_n / W_nn along the normal (lecture, collision resolution, steps 1-5). */
    TRIBO_LAW_FRICTIONLESS = 1,
    /** The lecture's velocity rule through the 3x3 system: u_n+ = -e u_n-; u_t+ = 0 if
     *  |u_t| <= mu_s v_c, else (1 - mu_d) u_t. Faithful to the slides; it may leave the friction
     *  cone or gain energy, which the audit shows. */
    TRIBO_LAW_LECTURE = 2,
    /** Coulomb's law exactly (cone, and slip opposite to friction after the impact) with Newton's
     *  u_n+ = -e u_n-. May gain energy for e > 0 with friction: see energy in the info. */
    TRIBO_LAW_COULOMB = 3,
    /** Routh's incremental law: Coulomb friction along the growing normal impulse (Keller,
     *  J. Appl. Mech. 53 (1986) 1), ended by Newton's hypothesis u_n+ = -e u_n-. */
    TRIBO_LAW_ROUTH_NEWTON = 4,
    /** ... ended by Poisson's: p_n = (1+e) p_n at greatest compression. Where slip that turns
     *  compresses the contact a second time, the last compression counts, for this law and the
     *  next. */
    TRIBO_LAW_ROUTH_POISSON = 5,
    /** ... ended by Stronge's (J. Appl. Mech. 58 (1991) 1049): the normal work regained in
     *  restitution is e^2 times that spent in compression. */
    TRIBO_LAW_ROUTH_STRONGE = 6,
    /** As LECTURE, but sliding loses what dynamic friction on the closing velocity v_c takes:
     *  u_t+ = u_t max(0, 1 - mu_d v_c / |u_t|), the rule before the slides' approximation. */
    TRIBO_LAW_LECTURE_CLOSING = 7
};

/** Options of an impact. Zero-initialise, set struct_size = sizeof(tribo_impact_options). A null
 *  pointer in place of options means all defaults (zeros). */
typedef struct tribo_impact_options {
    uint32_t struct_size; /**< bytes of this struct as the caller knows it; smaller (older) is
                               accepted */
    uint32_t law;         /**< TRIBO_LAW_...; default ALGEBRAIC */
    double tangential_restitution; /**< e_t in [-1, 1], ALGEBRAIC only; default 0: plastic
                                        sticking */
} tribo_impact_options;

/** What an impact did. The caller sets struct_size; a smaller (older) struct is filled as far as it
 *  goes. */
typedef struct tribo_impact_info {
    uint32_t struct_size;
    uint32_t mode;       /**< TRIBO_MODE_... at the end of the impact */
    uint32_t iterations; /**< root-finding or integration steps; 0 for closed forms */
    uint32_t reserved;
    double velocity[3]; /**< u+ in contact coordinates, m/s */
    double energy;      /**< change of kinetic energy, p . (u- + u+) / 2, J */
    double kappa;       /**< ALGEBRAIC: the kappa used; other laws: 0 */
    double compression; /**< ROUTH: normal impulse at greatest compression, N s; other laws: 0 */
} tribo_impact_info;

/** What the exact solve did; struct_size as above. */
typedef struct tribo_solve_info {
    uint32_t struct_size;
    uint32_t mode;       /**< OPEN, STICK or SLIP */
    uint32_t iterations; /**< Newton and bisection steps on the slip equation */
    uint32_t reserved;
    double nu; /**< slip: u_t = -nu p_t, 1/kg, DBL_MAX if beyond double; else 0 */
} tribo_solve_info;

/** A whole collision; struct_size as above. */
typedef struct tribo_collision_info {
    uint32_t struct_size;
    uint32_t mode;       /**< TRIBO_MODE_... */
    uint32_t iterations; /**< as in tribo_impact_info */
    uint32_t reserved;
    double frame[9];           /**< rows n, t1, t2: world to contact coordinates */
    double matrix[6];          /**< W, 1/kg */
    double velocity_before[3]; /**< u-, contact coordinates, m/s */
    double velocity_after[3];  /**< u+ = u- + W p */
    double impulse[3];         /**< p, contact coordinates, N s */
    double impulse_world[3];   /**< the same in world axes; acts on A, its negative on B */
    double energy;             /**< change of kinetic energy, p . (u- + u+) / 2, J */
} tribo_collision_info;

/* ---- geometry ------------------------------------------------------------------------------- */

/** Contact of bodies A and B at a world point with a normal from B to A. b may be null: the world,
 *  whose arm is zero.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL. */
TRIBO_API tribo_status tribo_contact_at(const tribo_body *a, const tribo_body *b,
                                        const double point[3], const double normal[3],
                                        tribo_contact *out);

/** Judge a contact. @return TRIBO_OK, TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
 *  TRIBO_ERROR_NORMAL. */
TRIBO_API tribo_status tribo_contact_check(const tribo_contact *contact);

/** u = frame (v_A - v_B) at the contact point, m/s. b may be null: the world at rest. `frame` as
 *  from tribo_basis_from_normal (any orthonormal rows do). @return TRIBO_ERROR_NULL,
 *  TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_contact_velocity(const tribo_body *a, const tribo_body *b,
                                              const tribo_contact *contact, const double frame[9],
                                              double u[3]);

/** Contact matrix W = N^T [(1/m_A + 1/m_B) 1 + sum S(r)^T I^-1 S(r)] N with N^T = frame (lecture,
 *  "The algorithm for angular motion": Delta V_contact). Six entries, each computed once: symmetric
 *  to the bit. Built in body axes as sum_k x_k . I_body^-1 x_l, x_k = R^T (r x n_k), so slender
 *  bodies lose no digits; immovable bodies cost nothing. b may be null: the world.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL, TRIBO_ERROR_FRAME (rows
 *          not orthonormal to 1e-9), TRIBO_ERROR_ALIAS (a is b), a status of tribo_body_check,
 *          TRIBO_ERROR_IMMOVABLE (W_nn = 0), TRIBO_ERROR_RANGE (an entry overflows). */
TRIBO_API tribo_status tribo_contact_matrix(const tribo_body *a, const tribo_body *b,
                                            const tribo_contact *contact, const double frame[9],
                                            double w[6]);

/** Apply p (contact coordinates, N s) as +p to A and -p to B. b may be null.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_ALIAS (a is b), a status of
 *          tribo_body_check, TRIBO_ERROR_RANGE. */
TRIBO_API tribo_status tribo_contact_apply(tribo_body *a, tribo_body *b,
                                           const tribo_contact *contact, const double frame[9],
                                           const double p[3]);

/* ---- the friction cone K = { p : |p_t| <= mu p_n }, its dual K* = { x : mu |x_t| <= x_n } ---- */

/** 1 if p lies in K, allowing |p_t| a relative excess of `tolerance` (>= 0; rounding of p itself
 *  makes 4 eps a sensible least value), else 0. 0 <= mu < infinity. */
TRIBO_API uint32_t tribo_cone_contains(const double p[3], double mu, double tolerance);

/** out = the point of K nearest to p. No division by mu; right for all finite p and mu >= 0, also
 *  where squares would overflow. @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE,
 *  TRIBO_ERROR_FRICTION, TRIBO_ERROR_RANGE (that point is beyond double). */
TRIBO_API tribo_status tribo_cone_project(const double p[3], double mu, double out[3]);

/** out = the point of K* nearest to x; x = P_K(x) - P_K*(-x) (Moreau). Statuses as above. */
TRIBO_API tribo_status tribo_cone_project_dual(const double x[3], double mu, double out[3]);

/** out = p with p_n raised to 0 and p_t shortened to mu p_n: the cheap clamp of engines, not a
 *  projection. Statuses as above. */
TRIBO_API tribo_status tribo_cone_clamp(const double p[3], double mu, double out[3]);

/* ---- exact solve ---------------------------------------------------------------------------- */

/** Find p with v = W p + b, 0 <= v_n, 0 <= p_n, v_n p_n = 0, |p_t| <= mu p_n, and sliding velocity
 *  v_t opposite to p_t wherever |p_t| = mu p_n: exact Signorini-Coulomb, no pyramid, no relaxation.
 *
 *  b_n >= 0: p = 0. Else the sticking p = -W^-1 b if it lies in the cone of mu_s. Else slip with
 *  mu_d, one scalar equation: with S = W_tt - w_t w_t^T / W_nn and c = -(b_t - w_t b_n / W_nn),
 *  find nu > 0 with mu p_n(nu) = |p_t(nu)|, p_t = (S + nu 1)^-1 c, p_n = -(b_n + w_t . p_t) / W_nn.
 *  A root lies in (0, |c| (W_nn + mu |w_t|) / (mu |b_n|)], so bisection behind Newton cannot fail.
 *  Where Coulomb's law has three solutions, stick is preferred to slip, and the slip that is found
 *  is the same on every platform.
 *
 *  W and b are scaled by powers of two first: multiplying W by 2^i and b by 2^j multiplies p by
 *  2^(j-i) to the bit.
 *
 *  @param w    positive semidefinite to 1e-12, greatest diagonal entry within [2^-1000, 2^1000]
 *  @param b    velocity that is to be cancelled, |b_i| <= 2^1000
 *  @param mu_s static, mu_d dynamic coefficient, 0 <= mu_d <= mu_s
 *  @param p    receives the impulse
 *  @param info may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_RANGE
 *          (input beyond the above, or p beyond double), TRIBO_ERROR_FRICTION,
 *          TRIBO_ERROR_CONTACT_MATRIX (also where W is so near to singular that no answer can be
 *          certified), TRIBO_ERROR_IMMOVABLE (W_nn = 0), TRIBO_ERROR_JAM (W is only semidefinite
 *          and no bounded impulse exists). */
TRIBO_API tribo_status tribo_contact_solve(const double w[6], const double b[3], double mu_s,
                                           double mu_d, double p[3], tribo_solve_info *info);

/** The same for any W with W_nn > 0, symmetric or not (row by row), such as implicit integrators of
 *  gyroscopic terms give: the same steps on the same scalar equation, which needs no symmetry of S,
 *  and bisection behind them. If no nu solves it, nor sticking, the contact jams.
 *  @return as tribo_contact_solve; TRIBO_ERROR_CONTACT_MATRIX if W_nn < 0 or the symmetric part of
 *          the Schur complement of W_nn is not positive semidefinite. */
TRIBO_API tribo_status tribo_contact_solve_general(const double w[9], const double b[3],
                                                   double mu_s, double mu_d, double p[3],
                                                   tribo_solve_info *info);

/* ---- impact --------------------------------------------------------------------------------- */

/** Impulse of an impact with relative velocity u by the law in `options`. u_n >= 0: p = 0, OPEN.
 *  @param w       contact matrix, as in tribo_contact_solve
 *  @param u       u- in contact coordinates, |u_i| <= 2^1000
 *  @param pair    coefficients of the pair
 *  @param options may be null: ALGEBRAIC
 *  @param p       receives the impulse, N s
 *  @param info    may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_RANGE (p, or what info asks for, is beyond double), TRIBO_ERROR_FRICTION,
 *          TRIBO_ERROR_RESTITUTION, TRIBO_ERROR_CONTACT_MATRIX, TRIBO_ERROR_IMMOVABLE,
 *          TRIBO_ERROR_JAM. FRICTIONLESS needs, and judges, no more of W than its size and
 *          diagonal. A W that is only semidefinite is accepted by FRICTIONLESS and ALGEBRAIC
 *          always, by LECTURE never (TRIBO_ERROR_CONTACT_MATRIX), by COULOMB and ROUTH where a
 *          solution exists. */
TRIBO_API tribo_status tribo_impact(const double w[6], const double u[3],
                                    const tribo_material *pair, const tribo_impact_options *options,
                                    double p[3], tribo_impact_info *info);

/** A whole collision: judge, build frame and W, find the impulse, apply it. Only the velocities of
 *  a and b change; nothing changes if they separate.
 *  @param b       may be null: the immovable world
 *  @param pair    coefficients of the pair (tribo_material_mix makes them of two materials)
 *  @param options may be null: ALGEBRAIC
 *  @param info    may be null
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_STRUCT_SIZE, TRIBO_ERROR_OPTION, TRIBO_ERROR_NOT_FINITE,
 *          TRIBO_ERROR_NORMAL, TRIBO_ERROR_ALIAS (a is b), a status of tribo_body_check,
 *          tribo_material_check or tribo_impact. */
TRIBO_API tribo_status tribo_contact_resolve(tribo_body *a, tribo_body *b,
                                             const tribo_contact *contact,
                                             const tribo_material *pair,
                                             const tribo_impact_options *options,
                                             tribo_collision_info *info);

/** tribo_contact_at, then tribo_contact_resolve. */
TRIBO_API tribo_status tribo_collide(tribo_body *a, tribo_body *b, const double point[3],
                                     const double normal[3], const tribo_material *pair,
                                     const tribo_impact_options *options,
                                     tribo_collision_info *info);

/* ---- force-level friction (lecture, "Static friction" and "Dynamic friction") --------------- */

/** Reaction r = -|f . n| n of a force f (N) that presses the body onto the surface, f . n < 0, n
 *  the surface's unit normal (towards the body); zero if f does not press.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL. */
TRIBO_API tribo_status tribo_friction_reaction(const double f[3], const double n[3],
                                               double reaction[3]);

/** Planar force f - r, the part of f that tries to slide the body; f minus its normal part if f
 *  does not press. Statuses as above. */
TRIBO_API tribo_status tribo_friction_planar(const double f[3], const double n[3],
                                             double planar[3]);

/** 1 if static friction holds: |planar| <= mu_s |reaction|; else 0. */
TRIBO_API uint32_t tribo_friction_holds(const double planar[3], const double reaction[3],
                                        double mu_s);

/** Friction force on a body at rest under f: static, -planar, while that holds; else dynamic,
 *  -mu_d |r| planar / |planar|. `mode` (may be null) receives STICK, SLIP, or OPEN if f does not
 *  press (then the force is zero).
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_NORMAL, a status of
 *          tribo_material_check. */
TRIBO_API tribo_status tribo_friction_force(const double f[3], const double n[3],
                                            const tribo_material *pair, double force[3],
                                            uint32_t *mode);

#ifdef __cplusplus
}
#endif

#endif
