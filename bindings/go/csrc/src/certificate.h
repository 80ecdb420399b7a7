/* Velocities that impulses give, and how far both are from the laws of contact. */
#ifndef TRIBO_CERTIFICATE_H
#define TRIBO_CERTIFICATE_H

#include "system.h"

/* What a solver shall reach. */
typedef struct goal {
    uint32_t measure;
    double tolerance; /* ETA: greatest eta of a contact */
    double sigma;     /* INVARIANT: velocity per impulse ... */
    double limit;     /* ... and greatest sqrt(sum |s r - P_K(s r - u')|^2), m/s */
    double residual;  /* ETA: greatest eta V, m/s. Where no bounded impulses exist, eta falls with
                         growing impulses, the residual does not */
} goal;

/* u = q + W r. Bodies form: also dv = M^-1 J^T r, 6 per body; the assembled form has none. */
void certificate_velocity(const system_problem *problem, const double *r, double *dv, double *u);

/* u of one contact: of the change dv of velocities, or of r by its row of W. */
void certificate_contact_velocity(const system_problem *problem, size_t c, const double *dv,
                                  double u[3]);
void certificate_row_velocity(const system_problem *problem, size_t c, const double *r,
                              double u[3]);

/* Add what a change of one contact's impulse does to dv. */
void certificate_push(const system_problem *problem, size_t c, const double change[3], double *dv);

/* How good impulses are. */
typedef struct verdict {
    double distance; /* the measure over the goal's bound: 1 or less is there */
    double residual; /* what the best are chosen by. Unlike eta it does not fall where impulses only
                        grow */
    double eta;      /* greatest of a contact; measured as the goal is */
    double growth;   /* as of certificate_growth; likewise */
} verdict;

/* 1 if `now` is worth taking other, perhaps far larger, impulses. */
static inline int is_better(verdict now, verdict best)
{
    return now.residual < 0.99 * best.residual || (now.distance <= 1.0 && best.distance > 1.0);
}

/* scratch: 6 per body, in the bodies form. */
verdict certificate_judge(const system_problem *problem, const goal *wanted, const double *r,
                          const double *u, double *scratch);

/* certificate_velocity, then certificate_judge. */
verdict certificate_check(const system_problem *problem, const goal *wanted, const double *r,
                          double *dv, double *u, double *scratch);

/* Greatest V of a contact over the greatest |q_c|: what impulses do to each other. */
double certificate_growth(const system_problem *problem, const double *r, double *scratch);

/* Mean diagonal entry of W. */
double certificate_stiffness(const system_problem *problem);

/* Write the measures of contacts to info; the rest of it is left as it is. */
void certificate_write(const system_problem *problem, const double *r, const double *u,
                       double *scratch, tribo_system_info *info);

/* The same for the measures that are sums over contacts: invariant and siconos. */
void certificate_sum(const system_problem *problem, const double *r, const double *u,
                     double *scratch, tribo_system_info *info);

/* Write the change of energy and its scale. */
void certificate_energy(const system_problem *problem, const double *r, const double *u,
                        tribo_system_info *info);

#endif
