/**
 * @file systems.h
 * Seeded systems of many contacts for tests and benches. Every one is a function of its parameters
 * alone. Velocities are those before the contacts act, the gravity of one step included.
 */
#ifndef TRIBO_TESTS_SYSTEMS_H
#define TRIBO_TESTS_SYSTEMS_H

#include <tribo/system.h>

/** g dt of all scenes that stand, m/s. */
#define SYSTEMS_FALL (9.81 / 60.0)

/** Bodies and contacts; free it with systems_free. */
typedef struct systems_scene {
    size_t body_count;
    size_t body_capacity;
    tribo_body *bodies;
    size_t count;
    size_t capacity;
    tribo_system_contact *contacts;
} systems_scene;

/** An assembled problem in sparse blocks; free it with systems_free_blocks. */
typedef struct systems_blocks {
    size_t count;
    uint32_t *row_starts;
    uint32_t *columns;
    double *blocks;
    double *q;
    double *mu;
} systems_blocks;

void systems_free(systems_scene *scene);
void systems_copy(const systems_scene *from, systems_scene *to);

/** Body of the given mass and half-extents (moments of a uniform box) at rest; its index. */
uint32_t systems_add_box(systems_scene *scene, const double half[3], double mass,
                         const double position[3]);
uint32_t systems_add_sphere(systems_scene *scene, double radius, double mass,
                            const double position[3]);
/** A body that never moves by itself. */
uint32_t systems_add_static(systems_scene *scene, const double position[3]);

/** Contact at a world point, mu_s = mu_d = mu, e = 0, target 0. The pointer is good until the next
 *  one. */
tribo_system_contact *systems_add_contact(systems_scene *scene, uint32_t a, uint32_t b,
                                          const double point[3], const double normal[3], double mu);

/** Add a velocity to all bodies that a force can move. */
void systems_accelerate(systems_scene *scene, const double dv[3]);

/** Multiply lengths, masses and times by powers of two. */
void systems_scale(systems_scene *scene, int length, int mass, int time);

/** Contacts in another order, drawn from the seed; order[i] receives the old number of contact i
 *  (may be null). */
void systems_permute(systems_scene *scene, uint64_t seed, size_t *order);

/** Bodies and contacts of `other` appended. */
void systems_append(systems_scene *scene, const systems_scene *other);

/** W, q and mu of the bodies' form: blocks J_c M^-1 J_d^T wherever two contacts share a body that
 *  moves. One-row contacts get mu = 0. Needs sorted memory of the size of W. */
void systems_assemble(const systems_scene *scene, systems_blocks *out);
void systems_free_blocks(systems_blocks *blocks);
/** The same W as one dense matrix of 3 count rows; free it. */
double *systems_dense(const systems_blocks *blocks);

/* ---- scenes that stand ----------------------------------------------------------------------- */

/** How masses go in a tower; the lowest box has 1 kg. */
enum {
    SYSTEMS_TOP = 0,       /**< all 1 kg but the top box, which has `ratio` */
    SYSTEMS_GEOMETRIC = 1, /**< growing evenly to `ratio` at the top */
    SYSTEMS_ALTERNATE = 2  /**< 1, ratio, 1, ratio, ... */
};

/** Unit cubes on each other, four contacts at each interface. */
void systems_tower(systems_scene *out, size_t boxes, uint32_t masses, double ratio, double mu);

/** Unit cubes with a common mu drawn from [0, 1.5], one in four from [1, 1.5]; sliding velocities
 *  and spin of each box normal, of a size drawn from 10^[-2, 0.5] m/s. */
void systems_sliding_tower(systems_scene *out, size_t boxes, uint64_t seed);

/** A unit cube on a slope of `angle` radians, downhill along x; gravity is tilted, not the cube. */
void systems_slope(systems_scene *out, double angle, double mu);

/** Bricks 2 x 1 x 1 in rows, each over the gap of two; masses drawn from the seed within a factor
 *  of 2; seed 0: all 1 kg. Eight contacts per brick. */
void systems_wall(systems_scene *out, size_t columns, size_t rows, uint64_t seed);

/** Four-sided pyramid of unit spheres, `layers` high, each resting on four and touching four; some
 *  2 layers^3 contacts. Masses and mu are drawn, one sphere in 20 is missing, and velocities have
 *  some noise. No real pile has so many contacts (see poured.h for some that do not). */
void systems_rubble(systems_scene *out, size_t layers, uint64_t seed);

/** The same pyramid without gaps, noise and contacts within a layer, with one mu: from about 0.9 on
 *  it stands, whatever the masses (drawn within a decade). Some 4/3 layers^3 contacts. */
void systems_heap(systems_scene *out, size_t layers, double mu, uint64_t seed);

/** Cube with `contacts` contacts on its underside. */
void systems_crowd(systems_scene *out, size_t contacts, uint64_t seed);

/* ---- thresholds of rest ---------------------------------------------------------------------- */

/** Ladder of 1 m, inclination `angle`, on a floor and against a wall. */
void systems_ladder(systems_scene *out, double angle, double mu_floor, double mu_wall);
/** Two cards of 1 m that lean against each other, `half_angle` from the vertical. */
void systems_cards(systems_scene *out, double half_angle, double mu);
/** Box of width w and height h on a slope. */
void systems_box_on_slope(systems_scene *out, double width, double height, double angle, double mu);
/** Bricks of 1 m, each as far over the one below as harmonic overhang times `share` allows. */
void systems_overhang(systems_scene *out, size_t bricks, double share);
/** Round arch of equal voussoirs with mean radius 1, contacts at both ends of each joint. */
void systems_arch(systems_scene *out, size_t voussoirs, double thickness, double mu);

/* ---- impacts --------------------------------------------------------------------------------- */

/** Block 2b x 2h that has rocked on its left edge with rate 1 about y and now meets the floor with
 *  its right one. */
void systems_rocking(systems_scene *out, double b, double h, double mu);
/** Wheel of `spokes` spokes of 1 m, mass 1 kg, moment `inertia`, as it changes its foot with rate
 *  1 about y. */
void systems_wheel(systems_scene *out, size_t spokes, double inertia, double mu);
/** Balls in a row, the first with 1 m/s along x. masses may be null: 1 kg each. */
void systems_cradle(systems_scene *out, size_t balls, const double *masses, double e);
/** A ball with 1 m/s along x meets two that touch it at +-30 degrees and each other. */
void systems_break(systems_scene *out, double e);
/** The same with 15 balls in a triangle. */
void systems_rack(systems_scene *out, double e);

/* ---- small random systems -------------------------------------------------------------------- */

/** What systems_random may draw. */
enum {
    SYSTEMS_STATIC = 1,       /**< bodies that do not move, and the world */
    SYSTEMS_ONE_ROW = 2,      /**< frictionless contacts of one row */
    SYSTEMS_TWO_FRICTION = 4, /**< mu_s > mu_d */
    SYSTEMS_TARGETS = 8,
    SYSTEMS_RESTITUTION = 16,
    SYSTEMS_DEGENERATE = 32, /**< repeated contacts and locked axes */
    SYSTEMS_ALL = 63
};

/** Up to `bodies` boxes and `contacts` contacts at random. */
void systems_random(systems_scene *out, size_t bodies, size_t contacts, uint32_t draws,
                    uint64_t seed);

/** A box between two walls that move towards each other at `speed`: no bounded impulses exist. */
void systems_press(systems_scene *out, double speed, double mu);

#endif
