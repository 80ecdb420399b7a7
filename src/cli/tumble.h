/**
 * @file tumble.h
 * A box that falls, strikes and slides on the immovable plane z = 0: free flight, and one impact
 * after the other at its corners.
 */
#ifndef TRIBO_CLI_TUMBLE_H
#define TRIBO_CLI_TUMBLE_H

#include <tribo/tribo.h>

/** The box, the plane and how an impact goes. */
typedef struct tumble {
    double half[3];      /**< half-extents, m */
    double gravity;      /**< along -z, m/s^2 */
    double slow;         /**< an approach slower than this is plastic, m/s */
    tribo_material pair; /**< coefficients between box and plane */
    tribo_impact_options options;
} tumble;

/** One impact, as an observer sees it. */
typedef struct tumble_impact {
    tribo_body before, after;
    tribo_contact contact;
    tribo_material pair; /**< with the restitution that was used */
    tribo_collision_info info;
} tumble_impact;

typedef void (*tumble_observer)(void *user, const tumble_impact *impact);

/** Advance `box` by `step` seconds in `parts` equal parts: free flight, and impacts of the corners
 * that would pass the plane.
 *  @param observer may be null
 *  @return TRIBO_OK or the status of the library function that failed. */
tribo_status tumble_advance(const tumble *scene, double step, uint32_t parts, tribo_body *box,
                            tumble_observer observer, void *user);

#endif
