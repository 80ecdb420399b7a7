#include "tumble.h"

enum {
    CORNERS = 8,
    IMPACTS_AT_MOST = 100 /* in one part of a step; what is left waits for the next one */
};

/* Impacts end when no corner approaches faster than this, m/s: a resting box then sinks by less
 * than 0.1 mm in a second. */
static const double AT_REST = 1e-4;

/* Arms from the centre of mass to the corners, world axes. */
static void corner_arms(const tumble *scene, const tribo_body *box, double arms[CORNERS][3])
{
    double rotation[9];

    tribo_quat_to_mat3(box->orientation, rotation);
    for (uint32_t corner = 0; corner < CORNERS; corner++) {
        double local[3];
        for (uint32_t k = 0; k < 3; k++)
            local[k] = (corner >> k & 1u) != 0 ? scene->half[k] : -scene->half[k];
        tribo_mat3_apply(rotation, local, arms[corner]);
    }
}

/* Of the corners that would pass the plane within `duration`, the one that approaches fastest;
 * CORNERS if there is none. */
static uint32_t next_corner(const tribo_body *box, double arms[CORNERS][3], double duration,
                            double *velocity)
{
    uint32_t next = CORNERS;

    *velocity = -AT_REST;
    for (uint32_t i = 0; i < CORNERS; i++) {
        double u[3];
        tribo_body_point_velocity(box, arms[i], u);
        if (u[2] < *velocity && box->position[2] + arms[i][2] + u[2] * duration < 0.0) {
            *velocity = u[2];
            next = i;
        }
    }
    return next;
}

/* One impact after the other, the fastest approach first, until no corner would pass the plane. */
static tribo_status resolve_corners(const tumble *scene, double duration, tribo_body *box,
                                    tumble_observer observer, void *user)
{
    double arms[CORNERS][3];
    tribo_status status = TRIBO_OK;

    corner_arms(scene, box, arms);
    for (uint32_t i = 0; i < IMPACTS_AT_MOST && status == TRIBO_OK; i++) {
        double velocity;
        const uint32_t corner = next_corner(box, arms, duration, &velocity);
        if (corner == CORNERS)
            break;
        tumble_impact impact = {.before = *box,
                                .contact = {{0.0, 0.0, 1.0},
                                            {arms[corner][0], arms[corner][1], arms[corner][2]},
                                            {0.0}},
                                .pair = scene->pair,
                                .info = {.struct_size = sizeof impact.info}};
        if (-velocity < scene->slow)
            impact.pair.e = 0.0;
        status = tribo_contact_resolve(box, NULL, &impact.contact, &impact.pair, &scene->options,
                                       &impact.info);
        impact.after = *box;
        if (status == TRIBO_OK && observer != NULL)
            observer(user, &impact);
    }
    return status;
}

/* Half of gravity acts before the impacts and half after the flight. Flight is the exact parabola,
 * and a box at rest, which gravity pushes into the plane, is stopped before it moves: it cannot
 * sink. Nothing corrects positions, so nothing adds energy. */
tribo_status tumble_advance(const tumble *scene, double step, uint32_t parts, tribo_body *box,
                            tumble_observer observer, void *user)
{
    const double duration = step / parts;
    const double kick = 0.5 * scene->gravity * duration;
    tribo_status status = TRIBO_OK;

    for (uint32_t part = 0; part < parts && status == TRIBO_OK; part++) {
        box->velocity[2] -= kick;
        status = resolve_corners(scene, duration, box, observer, user);
        if (status == TRIBO_OK)
            status = tribo_body_advance(box, NULL, duration);
        box->velocity[2] -= kick;
    }
    return status;
}
