#include "problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#define SLOW_BUILD 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define SLOW_BUILD 1
#endif
#if !defined(SLOW_BUILD)
#define SLOW_BUILD 0
#endif

/* A box for one side of a contact; moments of inertia stand in its own axes. */
typedef struct box {
    double mass;
    double moment[3];
    double rotation[9]; /* body to world */
    double orientation[4];
    double arm[3]; /* from the centre to the contact, world axes */
} box;

uint64_t problem_count(uint64_t wanted)
{
    const char *text = getenv("TRIBO_TEST_COUNT");
    const uint64_t most = text != NULL ? (uint64_t)strtoul(text, NULL, 10) : 0;
    const uint64_t count = SLOW_BUILD ? (wanted + 19) / 20 : wanted;
    return most > 0 && most < count ? most : count;
}

const char *problem_set_name(uint32_t set)
{
    static const char *const names[PROBLEM_SETS] = {"P1", "P2", "P3", "S", "B", "U"};
    return set < PROBLEM_SETS ? names[set] : "?";
}

/* ---- random numbers -------------------------------------------------------------------------- */

uint64_t problem_random_bits(problem_random *random)
{
    uint64_t z = random->state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

void problem_random_start(problem_random *random, uint64_t stream, uint64_t seed, uint64_t index)
{
    /* each number passes through the mixer, so neighbouring streams share nothing */
    random->state = stream;
    random->state = problem_random_bits(random) ^ seed;
    random->state = problem_random_bits(random) ^ index;
    random->state = problem_random_bits(random);
}

double problem_random_uniform(problem_random *random, double low, double high)
{
    const double unit = (double)(problem_random_bits(random) >> 11) * 0x1p-53;
    return low + (high - low) * unit;
}

static int one_in(problem_random *random, uint64_t n)
{
    return problem_random_bits(random) % n == 0;
}

/* 2^n for a normal result. */
static double power_of_two(int n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

double problem_random_decades(problem_random *random, double low, double high)
{
    const double log2_10 = 3.3219280948873623;
    const double x = problem_random_uniform(random, low, high) * log2_10;
    const int n = (int)(x + (x < 0.0 ? -0.5 : 0.5));
    const double y = (x - (double)n) * 0.6931471805599453;
    double sum = 1.0;
    for (int k = 14; k > 0; k--) {
        sum = 1.0 + y * sum / (double)k;
    }
    return sum * power_of_two(n);
}

/* Natural logarithm of x in (0, 1), to a few ulp. */
static double logarithm(double x)
{
    int n;
    double m = frexp(x, &n);
    if (m < 0.7071067811865476) {
        m *= 2.0;
        n--;
    }
    const double z = (m - 1.0) / (m + 1.0);
    double sum = 0.0;
    for (int k = 23; k > 0; k -= 2) {
        sum = sum * z * z + 2.0 / (double)k;
    }
    return (double)n * 0.6931471805599453 + sum * z;
}

/* Polar method of Marsaglia; the second number is dropped so that the state stays one word. */
double problem_random_normal(problem_random *random)
{
    double x;
    double s;
    do {
        x = problem_random_uniform(random, -1.0, 1.0);
        const double y = problem_random_uniform(random, -1.0, 1.0);
        s = x * x + y * y;
    } while (s >= 1.0 || s == 0.0);
    return x * sqrt(-2.0 * logarithm(s) / s);
}

void problem_random_direction(problem_random *random, size_t dimension, double out[])
{
    double square;
    do {
        square = 0.0;
        for (size_t i = 0; i < dimension; i++) {
            out[i] = problem_random_uniform(random, -1.0, 1.0);
            square += out[i] * out[i];
        }
    } while (square > 1.0 || square < 0x1p-40);
    for (size_t i = 0; i < dimension; i++) {
        out[i] /= sqrt(square);
    }
}

/* ---- boxes ----------------------------------------------------------------------------------- */

static void rotation_from(const double q[4], double out[9])
{
    const double w = q[0];
    const double x = q[1];
    const double y = q[2];
    const double z = q[3];
    const double r[9] = {
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
    memcpy(out, r, sizeof r);
}

static void turn(const double r[9], const double x[3], double out[3])
{
    for (size_t i = 0; i < 3; i++) {
        out[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
    }
}

static void turn_back(const double r[9], const double x[3], double out[3])
{
    for (size_t i = 0; i < 3; i++) {
        out[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
    }
}

/* A random box with a random point of its surface: a corner, or a point of an edge or of a face. */
static void draw_box(problem_random *random, double aspect_decades, double mass_low,
                     double mass_high, box *out)
{
    double half[3];
    double point[3];
    const double size = problem_random_decades(random, -1.0, 0.3);
    for (size_t i = 0; i < 3; i++) {
        half[i] = size * problem_random_decades(random, -aspect_decades, 0.0);
        point[i] = problem_random_uniform(random, -1.0, 1.0) * half[i];
        if (one_in(random, 2)) {
            point[i] = point[i] < 0.0 ? -half[i] : half[i];
        }
    }
    const size_t face = (size_t)(problem_random_bits(random) % 3);
    point[face] = point[face] < 0.0 ? -half[face] : half[face];
    out->mass = problem_random_decades(random, mass_low, mass_high);
    for (size_t i = 0; i < 3; i++) {
        const double y = half[(i + 1) % 3];
        const double z = half[(i + 2) % 3];
        out->moment[i] = out->mass * (y * y + z * z) / 3.0;
    }
    problem_random_direction(random, 4, out->orientation);
    rotation_from(out->orientation, out->rotation);
    turn(out->rotation, point, out->arm);
}

/* Contact axes (n, t1, t2), n towards A: out of its surface into its middle, side (+1 A, -1 B). */
static void draw_frame(problem_random *random, const double arm[3], double side, double frame[9])
{
    problem_random_direction(random, 3, frame);
    const double along = side * (frame[0] * arm[0] + frame[1] * arm[1] + frame[2] * arm[2]);
    double q[3];
    double square;
    for (size_t i = 0; i < 3; i++) {
        frame[i] = along > 0.0 ? -frame[i] : frame[i];
    }
    do {
        problem_random_direction(random, 3, q);
        const double d = q[0] * frame[0] + q[1] * frame[1] + q[2] * frame[2];
        square = 0.0;
        for (size_t i = 0; i < 3; i++) {
            frame[3 + i] = q[i] - d * frame[i];
            square += frame[3 + i] * frame[3 + i];
        }
    } while (square < 0.01);
    for (size_t i = 0; i < 3; i++) {
        frame[3 + i] /= sqrt(square);
    }
    tribo_vec3_cross(frame, frame + 3, frame + 6);
}

/* Adds the box's share to the contact matrix. */
static void add_box(const box *body, const double frame[9], double w[6])
{
    double x[3][3];
    for (size_t k = 0; k < 3; k++) {
        double cross[3];
        tribo_vec3_cross(body->arm, frame + 3 * k, cross);
        turn_back(body->rotation, cross, x[k]);
    }
    size_t entry = 0;
    for (size_t k = 0; k < 3; k++) {
        for (size_t l = k; l < 3; l++) {
            w[entry] += k == l ? 1.0 / body->mass : 0.0;
            for (size_t i = 0; i < 3; i++) {
                w[entry] += x[k][i] * x[l][i] / body->moment[i];
            }
            entry++;
        }
    }
}

/* ---- local problems -------------------------------------------------------------------------- */

static void draw_boxes_matrix(problem_random *random, uint32_t set, double w[6])
{
    const double aspect = set == PROBLEM_P2 ? 4.0 : 1.0;
    const double mass_low = set == PROBLEM_P2 ? -6.0 : -1.0;
    const double mass_high = set == PROBLEM_P2 ? 6.0 : 2.0;
    const int two = one_in(random, 2);
    box body;
    double frame[9];
    memset(w, 0, 6 * sizeof w[0]);
    draw_box(random, aspect, mass_low, mass_high, &body);
    draw_frame(random, body.arm, 1.0, frame);
    if (set == PROBLEM_P3) {
        body.moment[problem_random_bits(random) % 3] *= problem_random_decades(random, -10.0, 0.0);
    }
    add_box(&body, frame, w);
    if (two) {
        draw_box(random, aspect, mass_low, mass_high, &body);
        add_box(&body, frame, w);
    }
}

static void draw_synthetic_matrix(problem_random *random, double w[6])
{
    double q[4];
    double r[9];
    const double decades = problem_random_uniform(random, -12.0, 0.0);
    const double value[3] = {1.0, problem_random_decades(random, decades, 0.0),
                             problem_random_decades(random, decades, decades)};
    problem_random_direction(random, 4, q);
    rotation_from(q, r);
    size_t entry = 0;
    for (size_t k = 0; k < 3; k++) {
        for (size_t l = k; l < 3; l++) {
            w[entry] = 0.0;
            for (size_t i = 0; i < 3; i++) {
                w[entry] += r[3 * k + i] * r[3 * l + i] * value[i];
            }
            entry++;
        }
    }
}

static void draw_velocity(problem_random *random, double b[3])
{
    const double size = problem_random_decades(random, -3.0, 0.5);
    const double normal = fabs(problem_random_normal(random)) * size;
    b[0] = one_in(random, 16) ? normal : -normal;
    b[1] = problem_random_normal(random);
    b[2] = problem_random_normal(random);
}

/* b for which the sticking impulse lies next to the cone's boundary. */
static void draw_boundary_velocity(problem_random *random, const double w[6], double mu,
                                   double b[3])
{
    double p[3];
    const double off = problem_random_decades(random, -16.0, 0.0);
    const double factor = one_in(random, 2) ? 1.0 + off : 1.0 - off;
    p[0] = problem_random_decades(random, -3.0, 0.5);
    problem_random_direction(random, 2, p + 1);
    p[1] *= mu * p[0] * factor;
    p[2] *= mu * p[0] * factor;
    tribo_sym3_apply(w, p, b);
    for (size_t i = 0; i < 3; i++) {
        b[i] = -b[i];
    }
}

static void draw_local(problem_random *random, uint32_t set, problem_local *out)
{
    if (set == PROBLEM_S) {
        draw_synthetic_matrix(random, out->w);
    } else {
        draw_boxes_matrix(random, set, out->w);
    }
    if (set == PROBLEM_P1 || set == PROBLEM_U) {
        out->mu = problem_random_uniform(random, 0.0, 1.5);
    } else if (set == PROBLEM_B) {
        out->mu = problem_random_decades(random, -2.0, 1.0);
    } else {
        out->mu = problem_random_decades(random, -3.0, 3.0);
    }
    if (set == PROBLEM_B) {
        draw_boundary_velocity(random, out->w, out->mu, out->b);
    } else {
        draw_velocity(random, out->b);
    }
    if (set == PROBLEM_U) {
        const double matrix_scale = problem_random_decades(random, -12.0, 12.0);
        const double velocity_scale = problem_random_decades(random, -8.0, 8.0);
        for (size_t i = 0; i < 6; i++) {
            out->w[i] *= matrix_scale;
        }
        for (size_t i = 0; i < 3; i++) {
            out->b[i] *= velocity_scale;
        }
    }
}

void problem_draw(uint32_t set, uint64_t seed, uint64_t index, problem_local *out)
{
    problem_random random;
    problem_random_start(&random, set, seed, index);
    draw_local(&random, set, out);
}

static double draw_restitution(problem_random *random)
{
    const double e = problem_random_uniform(random, 0.0, 1.0);
    switch (problem_random_bits(random) % 8) {
    case 0:
        return 0.0;
    case 1:
        return 1.0;
    default:
        return e;
    }
}

void problem_draw_impact(uint32_t set, uint64_t seed, uint64_t index, problem_impact *out)
{
    problem_random random;
    problem_local local;
    problem_random_start(&random, set, seed, index);
    draw_local(&random, set, &local);
    memcpy(out->w, local.w, sizeof out->w);
    memcpy(out->u, local.b, sizeof out->u);
    out->pair.mu_s = local.mu;
    out->pair.mu_d = local.mu;
    if (one_in(&random, 2)) {
        out->pair.mu_d *= problem_random_uniform(&random, 0.0, 1.0);
    }
    out->pair.e = draw_restitution(&random);
    const double e_t = problem_random_uniform(&random, -1.0, 1.0);
    out->tangential_restitution = one_in(&random, 4) ? e_t : 0.0;
}

/* ---- whole collisions ------------------------------------------------------------------------ */

/* Inverse inertia in axes turned by r against the principal ones. */
static void turned_inverse(const double moment[3], const double r[9], double out[6])
{
    size_t entry = 0;
    for (size_t k = 0; k < 3; k++) {
        for (size_t l = k; l < 3; l++) {
            out[entry] = 0.0;
            for (size_t i = 0; i < 3; i++) {
                out[entry] += r[3 * k + i] * r[3 * l + i] / moment[i];
            }
            entry++;
        }
    }
}

/* out = p conj(q). */
static void turn_quaternion_back(const double p[4], const double q[4], double out[4])
{
    out[0] = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    out[1] = -p[0] * q[1] + p[1] * q[0] - p[2] * q[3] + p[3] * q[2];
    out[2] = -p[0] * q[2] + p[1] * q[3] + p[2] * q[0] - p[3] * q[1];
    out[3] = -p[0] * q[3] - p[1] * q[2] + p[2] * q[1] + p[3] * q[0];
}

static void place_box(problem_random *random, const box *shape, const double point[3],
                      tribo_body *out)
{
    static const double aligned[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    for (size_t i = 0; i < 3; i++) {
        out->position[i] = point[i] - shape->arm[i];
        out->velocity[i] = problem_random_normal(random);
        out->angular_velocity[i] = problem_random_normal(random);
    }
    out->inverse_mass = 1.0 / shape->mass;
    memcpy(out->orientation, shape->orientation, sizeof out->orientation);
    turned_inverse(shape->moment, aligned, out->inverse_inertia);
    if (one_in(random, 2)) {
        double q[4];
        double r[9];
        /* body axes turned by r against the principal axes; the body itself keeps its place */
        problem_random_direction(random, 4, q);
        rotation_from(q, r);
        turned_inverse(shape->moment, r, out->inverse_inertia);
        turn_quaternion_back(shape->orientation, q, out->orientation);
    }
}

/* Shift the velocities so that the bodies approach (or separate) by speed along n. */
static void set_approach(problem_collision *out, double speed)
{
    double va[3];
    double vb[3];
    tribo_vec3_cross(out->a.angular_velocity, out->contact.arm_a, va);
    tribo_vec3_cross(out->b.angular_velocity, out->contact.arm_b, vb);
    for (size_t i = 0; i < 3; i++) {
        va[i] += out->a.velocity[i] - vb[i] - out->b.velocity[i];
    }
    const double excess = speed - tribo_vec3_dot(out->normal, va);
    tribo_vec3_add_scaled(out->a.velocity, excess, out->normal, out->a.velocity);
}

void problem_draw_collision(uint64_t seed, uint64_t index, problem_collision *out)
{
    problem_random random;
    box shape_a;
    box shape_b;
    double frame[9];
    memset(out, 0, sizeof *out);
    problem_random_start(&random, PROBLEM_SETS, seed, index);
    draw_box(&random, 1.0, -1.0, 2.0, &shape_a);
    draw_box(&random, 1.0, -1.0, 2.0, &shape_b);
    draw_frame(&random, shape_a.arm, 1.0, frame);
    out->two_bodies = (uint32_t)one_in(&random, 2);
    const double inwards = tribo_vec3_dot(frame, shape_b.arm);
    for (size_t i = 0; i < 3; i++) {
        out->normal[i] = frame[i];
        out->point[i] = problem_random_normal(&random);
        /* B lies behind the contact */
        shape_b.arm[i] = inwards < 0.0 ? -shape_b.arm[i] : shape_b.arm[i];
    }
    out->b.orientation[0] = 1.0;
    place_box(&random, &shape_a, out->point, &out->a);
    memcpy(out->contact.normal, out->normal, sizeof out->normal);
    memcpy(out->contact.arm_a, shape_a.arm, sizeof shape_a.arm);
    if (out->two_bodies) {
        place_box(&random, &shape_b, out->point, &out->b);
        memcpy(out->contact.arm_b, shape_b.arm, sizeof shape_b.arm);
    }
    const double speed = problem_random_decades(&random, -3.0, 0.5);
    set_approach(out, one_in(&random, 16) ? speed : -speed);
    out->pair.mu_s = problem_random_uniform(&random, 0.0, 1.5);
    out->pair.mu_d = out->pair.mu_s * problem_random_uniform(&random, 0.6, 1.0);
    out->pair.e = draw_restitution(&random);
}
