/* What an impulse does to a body; shared by body and contact. No judgement of input here. */
#ifndef TRIBO_DYNAMICS_H
#define TRIBO_DYNAMICS_H

#include <tribo/body.h>

#include "rows.h"

TRIBO_ALWAYS_INLINE int has_inertia(const tribo_body *body)
{
    const double *j = body->inverse_inertia;
    return j[0] != 0.0 || j[3] != 0.0 || j[5] != 0.0;
}

static inline void push_body(tribo_body *body, const double arm[3], const double p[3])
{
    if (body->inverse_mass != 0.0) {
        tribo_vec3_add_scaled(body->velocity, body->inverse_mass, p, body->velocity);
    }
    if (has_inertia(body)) {
        const double *q = body->orientation;
        double r[9];
        double turn[3];
        rotation_rows(q[0], q[1], q[2], q[3], r);
        tribo_vec3_cross(arm, p, turn);
        tribo_mat3_apply_transposed(r, turn, turn);
        tribo_sym3_apply(body->inverse_inertia, turn, turn);
        tribo_mat3_apply(r, turn, turn);
        tribo_vec3_add(body->angular_velocity, turn, body->angular_velocity);
    }
}

#endif
