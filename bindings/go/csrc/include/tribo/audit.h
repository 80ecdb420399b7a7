/**
 * @file audit.h
 * The lecture's "Debugging the collision resolution" as functions: what a step conserved and how
 * far an impulse is from Coulomb's law. All measures are without dimension unless a unit is given.
 *
 * Shapes and the rules on aliasing, threads and NaN: see base.h.
 */
#ifndef TRIBO_AUDIT_H
#define TRIBO_AUDIT_H

#include <tribo/contact.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- bodies: momentum and energy ------------------------------------------------------------ */

/** Totals over bodies. Bodies with zero inverse mass have no finite momentum and are left out. 80
 *  bytes. */
typedef struct tribo_totals {
    double linear[3];     /**< sum m v, kg m/s */
    double angular[3];    /**< sum (x - origin) x m v + I omega about one common point, kg m^2/s */
    double energy;        /**< sum m |v|^2 / 2 + omega . I omega / 2, J */
    double mass;          /**< sum m, kg */
    double linear_scale;  /**< sum m |v|: what |linear| is measured against */
    double angular_scale; /**< sum |x - origin| m |v| + |I omega| */
} tribo_totals;

/** Momentum about `origin` and kinetic energy of `count` bodies.
 *  Angular momentum is conserved only about one point common to all bodies (lecture).
 *  @return TRIBO_ERROR_NULL, or a status of tribo_body_check for the first bad body. */
TRIBO_API tribo_status tribo_audit_bodies(size_t count, const tribo_body *bodies,
                                          const double origin[3], tribo_totals *out);

/** What changed between two totals of the same bodies about the same origin. */
typedef struct tribo_change {
    double linear;  /**< |change of linear momentum| / greater linear_scale; 0 if both are 0 */
    double angular; /**< |change of angular momentum| / greater angular_scale */
    double energy;  /**< (T+ - T-) / greater T, signed */
} tribo_change;

/** @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_audit_change(const tribo_totals *before, const tribo_totals *after,
                                          tribo_change *out);

/* ---- contacts: distance from Coulomb's law -------------------------------------------------- */

/** Measures of an impulse p for the problem v = W p + b with coefficient mu. Scales: V = |b| + the
 *  norm of |W||p| (entrywise absolute values), P = V / greatest W_ii. */
typedef struct tribo_measures {
    double eta;          /**< natural map |p - P_K(p - rho (v + mu |v_t| e_n))| / P,
                              rho = 1 / (greatest W_ii max(1, mu)): 0 at, and only at, a solution */
    double signorini;    /**< |min(v_n / V, p_n / P)| */
    double cone;         /**< max(0, |p_t| - mu p_n) / P */
    double misalignment; /**< | |v_t| p_t + mu p_n v_t | / (P V): friction not opposite to slip */
    double energy;       /**< p . (b + v) / 2 / (P V): change of energy, signed, b the velocity
                              before (e = 0) */
    double velocity;     /**< v_n, m/s: the separating velocity */
} tribo_measures;

/** Measures of one contact; b = 0 and p = 0 give zeros.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE, TRIBO_ERROR_FRICTION (mu < 0),
 *          TRIBO_ERROR_IMMOVABLE (no positive diagonal entry), TRIBO_ERROR_RANGE (a measure is
 *          beyond double, where mu or p is). */
TRIBO_API tribo_status tribo_audit_contact(const double w[6], const double b[3], double mu,
                                           const double p[3], tribo_measures *out);

/** Measures of an impact: those of tribo_audit_contact for b = ((1+e) u_n, u_t) and the coefficient
 *  that fits p (mu_s if p leaves no sliding velocity, else mu_d), but with `energy` = p . (u- + u+)
 *  / 2 / (P V), the true change, and `velocity` the deviation (u_n+ + e u_n-) / V from Newton's
 *  restitution, 0 where u_n- >= 0 (there is no impact then). eta is then the distance of any law's
 *  impulse from Coulomb's law with Newton's restitution.
 *  @return as tribo_audit_contact, TRIBO_ERROR_FRICTION, TRIBO_ERROR_RESTITUTION. */
TRIBO_API tribo_status tribo_audit_impact(const double w[6], const double u[3],
                                          const tribo_material *pair, const double p[3],
                                          tribo_measures *out);

/** Measures over `count` contacts: greatest absolute value and root mean square of each field.
 *  @param w,b,p widths 6, 3, 3, contact-major as in batch.h
 *  @param mu    width 1
 *  @param max   may be null
 *  @param rms   may be null
 *  @return TRIBO_ERROR_NULL, or a status of tribo_audit_contact for the first bad contact. count =
 *          0 gives zeros. */
TRIBO_API tribo_status tribo_audit_contacts(size_t count, const double *w, const double *b,
                                            const double *mu, const double *p, tribo_measures *max,
                                            tribo_measures *rms);

#ifdef __cplusplus
}
#endif

#endif
