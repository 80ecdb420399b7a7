#include "tumble.h"

#include <math.h>

enum { CORNERS = 8, IMPACTS_AT_MOST = 100 };

/* Impacts end when no corner approaches faster than this, m/s. What is left makes a resting box sink by
 * less than 0.1 mm in a second. */
static const double AT_REST = 1e-4;

/* Arms from the centre of mass to the lowest points of the corners that reach the plane. */
static uint32_t touching_corners(const tumble *scene, const tribo_body *box,
                                 double arms[CORNERS][3])
{
    const double *half = scene->half;
    const double reach = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    double rotation[9];
    uint32_t count = 0;

    if (box->position[2] > reach)
        return 0;
    tribo_quat_to_mat3(box->orientation, rotation);
    for (uint32_t corner = 0; corner < CORNERS; corner++) {
        double local[3];
        for (uint32_t k = 0; k < 3; k++) {
            const double inner = half[k] - scene->rounding;
            local[k] = (corner >> k & 1u) != 0 ? inner : -inner;
        }
        double *arm = arms[count];
        tribo_mat3_apply(rotation, local, arm);
        arm[2] -= scene->rounding;
        if (box->position[2] + arm[2] < 0.0)
            count++;
    }
    return count;
}

/* The corner that approaches fastest, or `count` if none approaches faster than AT_REST. */
static uint32_t fastest_corner(const tribo_body *box, uint32_t count, double arms[CORNERS][3],
                               double *velocity)
{
    uint32_t fastest = count;

    *velocity = -AT_REST;
    for (uint32_t i = 0; i < count; i++) {
        double u[3];
        tribo_body_point_velocity(box, arms[i], u);
        if (u[2] < *velocity) {
            *velocity = u[2];
            fastest = i;
        }
    }
    return fastest;
}

/* One impact after the other, the fastest approach first, until no corner approaches. Each impact takes
 * energy away or keeps it (as far as the law does), so that a resting face calms down. */
static tribo_status resolve_corners(const tumble *scene, tribo_body *box, tumble_observer observer,
                                    void *user)
{
    double arms[CORNERS][3];
    const uint32_t count = touching_corners(scene, box, arms);
    tribo_status status = TRIBO_OK;

    for (uint32_t i = 0; count > 0 && i < IMPACTS_AT_MOST; i++) {
        double velocity;
        const uint32_t corner = fastest_corner(box, count, arms, &velocity);
        if (corner == count)
            break;
        const tribo_contact contact = {
            {0.0, 0.0, 1.0}, {arms[corner][0], arms[corner][1], arms[corner][2]}, {0.0, 0.0, 0.0}};
        tribo_material pair = scene->pair;
        if (-velocity < scene->slow)
            pair.e = 0.0;
        tribo_collision_info info = {.struct_size = sizeof info};
        const tribo_body before = *box;
        status = tribo_contact_resolve(box, NULL, &contact, &pair, &scene->options, &info);
        if (status != TRIBO_OK)
            break;
        if (observer != NULL)
            observer(user, &before, box, &contact, &info);
    }
    return status;
}

tribo_status tumble_advance(const tumble *scene, double step, uint32_t parts, tribo_body *box,
                            tumble_observer observer, void *user)
{
    const double gravity[3] = {0.0, 0.0, -scene->gravity};
    tribo_status status = TRIBO_OK;

    for (uint32_t part = 0; part < parts && status == TRIBO_OK; part++) {
        status = tribo_body_advance(box, gravity, step / parts);
        if (status == TRIBO_OK)
            status = resolve_corners(scene, box, observer, user);
    }
    return status;
}
