/**
 * @file box2d.h
 * As much of Box2D 2.4 (C++) as tests ask of it, in C. Its own steps: no warm start, no continuous
 * collision, no sleep; restitution from any speed on unless a threshold is set.
 */
#ifndef TRIBO_TESTS_BOX2D_H
#define TRIBO_TESTS_BOX2D_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct box2d_world box2d_world;

/** A disc if half[1] is 0, its radius half[0]; else a box. */
typedef struct box2d_body {
    double half[2];
    double mass;   /**< kg; 0: static */
    double moment; /**< kg m^2 about the centre of mass */
    double position[2];
    double angle;
    double velocity[2];
    double spin;
    double mu;
    double e;
    double threshold; /**< m/s: slower approaches do not bounce */
} box2d_body;

/** A contact point of the last step. */
typedef struct box2d_contact {
    int a;
    int b;
    double point[2];  /**< where the solver has it, world axes */
    double normal[2]; /**< from b to a */
    double normal_impulse;
    double tangent_impulse;
} box2d_contact;

box2d_world *box2d_create(double gravity_x, double gravity_y);
void box2d_destroy(box2d_world *world);

/** Number of the body, from 0 on. */
int box2d_add(box2d_world *world, const box2d_body *body);

void box2d_step(box2d_world *world, double dt, int velocity_iterations, int position_iterations);

/** x, y, angle, v_x, v_y, spin. */
void box2d_get(const box2d_world *world, int body, double state[6]);

/** Contact points of the last step; returns their number, at most capacity. */
int box2d_contacts(const box2d_world *world, int capacity, box2d_contact *contacts);

/** b2_linearSlop, m. */
double box2d_slop(void);

#ifdef __cplusplus
}
#endif

#endif
