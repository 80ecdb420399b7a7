/**
 * @file problems.h
 * Seeded contact problems for tests and benches: six sets of local problems, impacts on them, and
 * whole collisions of boxes.
 *
 * Every problem is a function of (set, seed, index) alone, so one that fails is named by three
 * numbers. Integer generator, own logarithm and power: the same doubles on every platform.
 */
#ifndef TRIBO_TESTS_PROBLEMS_H
#define TRIBO_TESTS_PROBLEMS_H

#include <tribo/contact.h>

/** Sets of local problems. b_n = -10^[-3, 0.5] |N(0,1)| (one in 16 separates), b_t = N(0,1), unless
 *  said otherwise; mu is log-uniform where its range is given in decades, else uniform. */
enum {
    PROBLEM_P1 = 0, /**< uniform boxes of aspect up to 10, one or two bodies, mu in [0, 1.5] */
    PROBLEM_P2 = 1, /**< aspect up to 1e4, masses 10^[-6, 6], mu in 10^[-3, 3] */
    PROBLEM_P3 = 2, /**< P1 with one moment of inertia times 10^-[0, 10], mu in 10^[-3, 3] */
    PROBLEM_S = 3,  /**< Q diag Q^T of condition up to 1e12, mu in 10^[-3, 3] */
    PROBLEM_B = 4,  /**< P1 with the sticking impulse on the cone times 1 +- 10^-[0, 16],
                         mu in 10^[-2, 1] */
    PROBLEM_U = 5,  /**< P1 with W times 10^[-12, 12] and b times 10^[-8, 8] */
    PROBLEM_SETS = 6
};

/** State of the generator (splitmix64, Steele, Lea & Flood 2014). */
typedef struct problem_random {
    uint64_t state;
} problem_random;

/** Find p for v = W p + b and coefficient mu. */
typedef struct problem_local {
    double w[6];
    double b[3];
    double mu;
} problem_local;

/** Find the impulse of an impact with velocity u. */
typedef struct problem_impact {
    double w[6];
    double u[3];
    tribo_material pair;
    double tangential_restitution;
} problem_impact;

/** Two boxes, or one and the world, that meet at a point. */
typedef struct problem_collision {
    tribo_body a;
    tribo_body b;
    uint32_t two_bodies; /**< 0: b is to be passed as null */
    double point[3];
    double normal[3];
    tribo_contact contact; /**< of point and normal, arms taken before the bodies were placed */
    tribo_material pair;
} problem_collision;

/** How many of `wanted` problems to do: one in 20 under a sanitizer, or what TRIBO_TEST_COUNT says
 *  where that is less. */
uint64_t problem_count(uint64_t wanted);

/** "P1", "P2", "P3", "S", "B", "U". */
const char *problem_set_name(uint32_t set);

/** Start the stream of (stream, seed, index). */
void problem_random_start(problem_random *random, uint64_t stream, uint64_t seed, uint64_t index);
uint64_t problem_random_bits(problem_random *random);
/** Uniform in [low, high). */
double problem_random_uniform(problem_random *random, double low, double high);
/** 10^x with x uniform in [low, high). */
double problem_random_decades(problem_random *random, double low, double high);
/** Normal distribution, mean 0, deviation 1. */
double problem_random_normal(problem_random *random);
/** Uniform on the unit sphere of the given dimension, 2 to 4. */
void problem_random_direction(problem_random *random, size_t dimension, double out[]);

/** Problem `index` of a set. */
void problem_draw(uint32_t set, uint64_t seed, uint64_t index, problem_local *out);

/** The same problem as an impact: u = b, mu_s = mu, mu_d = mu (half of them) or less, e in [0, 1]
 *  with the ends drawn one time in eight each; e_t = 0 (three of four) or in [-1, 1]. */
void problem_draw_impact(uint32_t set, uint64_t seed, uint64_t index, problem_impact *out);

/** Boxes of aspect up to 10 and mass 10^[-1, 2] kg near the origin, half of them with an inertia
 *  tensor that is not diagonal; friction and restitution of usual materials; one in 16
 *  separates. */
void problem_draw_collision(uint64_t seed, uint64_t index, problem_collision *out);

#endif
