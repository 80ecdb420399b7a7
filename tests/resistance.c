/* Rolling and spinning resistance in systems: closed forms, the law by its own terms, what it costs
 * where it is not set. */
#include <tribo/system.h>

#include "problems.h"
#include "quad_system.h"
#include "systems.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define EPS DBL_EPSILON

static const uint32_t solvers[] = {TRIBO_SOLVER_AUTO, TRIBO_SOLVER_GAUSS_SEIDEL,
                                   TRIBO_SOLVER_NEWTON};

/* ---- one call -------------------------------------------------------------------------------- */

typedef struct solution {
    double *impulses, *torques, *velocities;
    tribo_system_info info;
} solution;

static double *numbers(size_t count)
{
    double *out = calloc(count + 1, sizeof *out);
    assert_non_null(out);
    return out;
}

static void release(solution *out)
{
    free(out->impulses);
    free(out->torques);
    free(out->velocities);
}

static tribo_status try_to_solve(const systems_scene *scene, const tribo_system_options *options,
                                 solution *out)
{
    tribo_system_options o = *options;
    size_t size = 0;
    memset(out, 0, sizeof *out);
    out->info.struct_size = sizeof out->info;
    out->impulses = numbers(3 * scene->count);
    out->torques = numbers(3 * scene->count);
    out->velocities = numbers(6 * scene->body_count);
    o.torques = out->torques;
    tribo_status status =
        tribo_system_workspace_size(scene->body_count, scene->count, scene->contacts, &o, &size);
    void *workspace = malloc(size + 1);
    assert_non_null(workspace);
    if (status == TRIBO_OK) {
        status =
            tribo_system_solve(scene->body_count, scene->bodies, scene->count, scene->contacts, &o,
                               workspace, size, out->impulses, out->velocities, &out->info);
    }
    free(workspace);
    return status;
}

static void solve(const systems_scene *scene, uint32_t solver, double tolerance, uint64_t most,
                  solution *out)
{
    const tribo_system_options options = {.struct_size = sizeof options,
                                          .solver = solver,
                                          .tolerance = tolerance,
                                          .max_iterations = most};
    assert_int_equal(try_to_solve(scene, &options, out), TRIBO_OK);
}

/* ---- the law by its own terms ---------------------------------------------------------------- */

/* What is wrong with an answer: bounds over the own impulses of a contact, all else over the
 * greatest impulses and speeds. */
typedef struct wrong {
    double bounds;  /* impulses and torques beyond their bounds */
    double closing; /* contacts that still approach */
    double gap; /* r . u' + tau . omega, the gap of complementarity, which is a sum of terms >= 0 */
    double motion; /* velocities that are not those of the impulses */
} wrong;

static void relative_velocity(const systems_scene *s, const double *velocities, size_t c,
                              double u[3], double omega[3])
{
    const tribo_system_contact *contact = &s->contacts[c];
    double frame[9];
    double v[3] = {0.0, 0.0, 0.0};
    double w[3] = {0.0, 0.0, 0.0};
    for (int side = 0; side < 2; side++) {
        const uint32_t body = side == 0 ? contact->a : contact->b;
        const double *arm = side == 0 ? contact->contact.arm_a : contact->contact.arm_b;
        const double sign = side == 0 ? 1.0 : -1.0;
        double turn[3];
        if (body == TRIBO_WORLD) {
            continue;
        }
        const double *own = velocities + 6 * (size_t)body;
        tribo_vec3_cross(own + 3, arm, turn);
        for (int k = 0; k < 3; k++) {
            v[k] += sign * (own[k] + turn[k]);
            w[k] += sign * own[3 + k];
        }
    }
    assert_int_equal(tribo_basis_from_normal(contact->contact.normal, frame), TRIBO_OK);
    tribo_mat3_apply(frame, v, u);
    tribo_mat3_apply(frame, w, omega);
    for (int k = 0; k < 3; k++) {
        u[k] -= contact->target[k];
    }
}

static double length(int n, const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        sum += x[i] * x[i];
    }
    return sqrt(sum);
}

static double dot(int n, const double *x, const double *y)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

/* Greatest error of velocities, over the speeds in the system. */
static double wrong_motion(const systems_scene *s, const solution *got)
{
    tribo_body *bodies = malloc((s->body_count + 1) * sizeof *bodies);
    double error = 0.0;
    double size = 0.0;
    assert_non_null(bodies);
    memcpy(bodies, s->bodies, s->body_count * sizeof *bodies);
    for (size_t c = 0; c < s->count; c++) {
        const tribo_system_contact *contact = &s->contacts[c];
        double frame[9];
        double impulse[3];
        double torque[3];
        tribo_basis_from_normal(contact->contact.normal, frame);
        tribo_mat3_apply_transposed(frame, got->impulses + 3 * c, impulse);
        tribo_mat3_apply_transposed(frame, got->torques + 3 * c, torque);
        for (int side = 0; side < 2; side++) {
            const uint32_t body = side == 0 ? contact->a : contact->b;
            double p[3];
            double l[3];
            double j[6];
            if (body == TRIBO_WORLD) {
                continue;
            }
            tribo_vec3_scale(side == 0 ? 1.0 : -1.0, impulse, p);
            tribo_vec3_scale(side == 0 ? 1.0 : -1.0, torque, l);
            tribo_body_apply_impulse(
                &bodies[body], side == 0 ? contact->contact.arm_a : contact->contact.arm_b, p);
            tribo_body_world_inverse_inertia(&bodies[body], j);
            tribo_sym3_apply(j, l, l);
            tribo_vec3_add(bodies[body].angular_velocity, l, bodies[body].angular_velocity);
            size = fmax(size, s->bodies[body].inverse_mass * length(3, p) + length(3, l));
        }
    }
    for (size_t i = 0; i < s->body_count; i++) {
        size = fmax(size, length(3, s->bodies[i].velocity));
        size = fmax(size, length(3, s->bodies[i].angular_velocity));
        for (int k = 0; k < 3; k++) {
            error = fmax(error, fabs(bodies[i].velocity[k] - got->velocities[6 * i + (size_t)k]));
            error = fmax(error, fabs(bodies[i].angular_velocity[k] -
                                     got->velocities[6 * i + 3 + (size_t)k]));
        }
    }
    free(bodies);
    return size > 0.0 ? error / size : error;
}

/* Greatest difference of the certificate from the one in quad precision, in roundings. */
static double wrong_certificate(const systems_scene *s, const solution *got)
{
    quad_certificate truth;
    quad_certificate_with_torques(s->body_count, s->bodies, s->count, s->contacts, got->impulses,
                                  got->torques, got->velocities, &truth);
    return quad_certificate_difference(&truth, &got->info, NULL);
}

static wrong judge(const systems_scene *s, const solution *got)
{
    wrong out = {0.0, 0.0, 0.0, wrong_motion(s, got)};
    double speed = 0.0;
    double most = 0.0;
    double *before = numbers(6 * s->body_count);
    for (size_t i = 0; i < s->body_count; i++) {
        memcpy(before + 6 * i, s->bodies[i].velocity, 3 * sizeof *before);
        memcpy(before + 6 * i + 3, s->bodies[i].angular_velocity, 3 * sizeof *before);
    }
    for (size_t c = 0; c < s->count; c++) {
        double q[3];
        double omega[3];
        relative_velocity(s, before, c, q, omega);
        speed = fmax(speed, length(3, q) + length(3, omega));
    }
    for (size_t c = 0; c < s->count; c++) {
        const tribo_system_contact *contact = &s->contacts[c];
        const int full = contact->dimension == 3;
        const double *r = got->impulses + 3 * c;
        const double *t = got->torques + 3 * c;
        const double bound[3] = {full ? contact->pair.mu_s * r[0] : 0.0,
                                 full ? contact->rolling * r[0] : 0.0,
                                 full ? contact->spinning * r[0] : 0.0};
        const double size = length(3, r) + length(3, t);
        double u[3];
        double w[3];
        relative_velocity(s, got->velocities, c, u, w);
        if (size > 0.0) {
            const double over[3] = {length(2, r + 1) - bound[0], length(2, t + 1) - bound[1],
                                    fabs(t[0]) - bound[2]};
            const double gap = fabs(r[0] * u[0]) + bound[0] * length(2, u + 1) +
                               dot(2, r + 1, u + 1) + bound[1] * length(2, w + 1) +
                               dot(2, t + 1, w + 1) + bound[2] * fabs(w[0]) + t[0] * w[0];
            for (int k = 0; k < 3; k++) {
                out.bounds = fmax(out.bounds, over[k] / size);
            }
            out.bounds = fmax(out.bounds, -r[0] / size);
            most = fmax(most, size);
            out.gap = fmax(out.gap, gap / speed);
        }
        out.closing = fmax(out.closing, -u[0] / speed);
    }
    out.gap /= most > 0.0 ? most : 1.0;
    free(before);
    return out;
}

/* ---- a ball on a floor ----------------------------------------------------------------------- */

#define STEP (1.0 / 64.0)
#define GRAVITY 9.81

static const double origin[3] = {0.0, 0.0, 0.0};
static const double up[3] = {0.0, 0.0, 1.0};

static void make_ball(double radius, double mass, double mu, double rolling, double spinning,
                      systems_scene *out)
{
    const double centre[3] = {0.0, 0.0, radius};
    memset(out, 0, sizeof *out);
    const uint32_t ball = systems_add_sphere(out, radius, mass, centre);
    tribo_system_contact *c = systems_add_contact(out, ball, TRIBO_WORLD, origin, up, mu);
    c->rolling = rolling;
    c->spinning = spinning;
}

/* One step under gravity, on a slope of `angle` radians that falls along x. */
static void step_ball(systems_scene *scene, double angle, uint32_t solver)
{
    const double kick[3] = {GRAVITY * STEP * sin(angle), 0.0, -GRAVITY * STEP * cos(angle)};
    solution got;
    systems_accelerate(scene, kick);
    solve(scene, solver, 1e-13, 0, &got);
    assert_int_equal(got.info.stop, TRIBO_STOP_TOLERANCE);
    assert_true(got.info.energy <= 1e-15 * got.info.energy_scale);
    tribo_system_apply(scene->body_count, scene->bodies, got.velocities);
    release(&got);
}

static void assert_near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) {
        print_message("# got %.17g, want %.17g\n", got, want);
    }
    assert_true(fabs(got - want) <= tolerance);
}

/* A ball that rolls slows down by (5/7) delta g / R; then it stands, and does not turn back. */
static void test_rolling_ball(void **state)
{
    const double radius = 0.3;
    const double rolling = 0.004;
    (void)state;
    for (size_t s = 0; s < 3; s++) {
        systems_scene scene;
        double speed = 0.5;
        make_ball(radius, 2.0, 0.4, rolling, 0.0, &scene);
        tribo_body *ball = &scene.bodies[0];
        ball->velocity[0] = 0.6 * speed;
        ball->velocity[1] = 0.8 * speed;
        ball->angular_velocity[0] = -0.8 * speed / radius;
        ball->angular_velocity[1] = 0.6 * speed / radius;
        for (int i = 0; i < 400; i++) {
            step_ball(&scene, 0.0, solvers[s]);
            speed = fmax(0.0, speed - 5.0 / 7.0 * rolling * GRAVITY / radius * STEP);
            const double *w = ball->angular_velocity;
            assert_near(length(2, ball->velocity), speed, 1e-12);
            assert_near(ball->velocity[0], 0.6 * speed, 1e-12);
            assert_near(radius * w[1], 0.6 * speed, 1e-12);
            assert_near(radius * w[0], -0.8 * speed, 1e-12);
            assert_near(ball->velocity[2], 0.0, 1e-13);
        }
        assert_true(length(3, ball->velocity) <= 1e-15);
        assert_true(length(3, ball->angular_velocity) <= 1e-15);
        systems_free(&scene);
    }
}

/* One that spins on the spot loses (5/2) delta g / R^2 of its rate a second. */
static void test_spinning_ball(void **state)
{
    const double radius = 0.3;
    const double spinning = 0.01;
    (void)state;
    for (size_t s = 0; s < 3; s++) {
        systems_scene scene;
        double rate = -8.0;
        make_ball(radius, 2.0, 0.4, 0.0, spinning, &scene);
        scene.bodies[0].angular_velocity[2] = rate;
        for (int i = 0; i < 300; i++) {
            step_ball(&scene, 0.0, solvers[s]);
            rate = fmin(0.0, rate + 2.5 * spinning * GRAVITY / (radius * radius) * STEP);
            assert_near(scene.bodies[0].angular_velocity[2], rate, 1e-11);
            assert_true(length(3, scene.bodies[0].velocity) <= 1e-13);
        }
        assert_true(fabs(scene.bodies[0].angular_velocity[2]) <= 1e-15);
        systems_free(&scene);
    }
}

/* On a slope a ball rests iff tan theta <= delta / R, rolls without slip iff the friction that
 * needs is there, and slides else. */
static void test_ball_on_slope(void **state)
{
    const double radius = 0.5;
    const double lengths[] = {0.0, 0.02, 0.1};
    (void)state;
    for (size_t s = 0; s < 3; s++) {
        for (size_t i = 0; i < 3; i++) {
            const double hold = atan(lengths[i] / radius);
            for (int k = 0; k < 4; k++) {
                const double angle = k < 2 ? hold * (1.0 + (k == 0 ? -1e-3 : 1e-3)) : 0.2 * k;
                const double down = GRAVITY * sin(angle);
                const double press = GRAVITY * cos(angle);
                const double rolls = fmax(0.0, 5.0 / 7.0 * (down - lengths[i] / radius * press));
                const double least = (down - rolls) / press; /* friction of rolling */
                if (lengths[i] == 0.0) {
                    assert_near(least, 2.0 / 7.0 * tan(angle), 1e-15);
                }
                for (int side = -1; side <= 1 && angle > 0.0; side += 2) {
                    const double mu = least * (1.0 + 1e-3 * side);
                    systems_scene scene;
                    make_ball(radius, 3.0, mu, lengths[i], 0.0, &scene);
                    step_ball(&scene, angle, solvers[s]);
                    step_ball(&scene, angle, solvers[s]);
                    const tribo_body *ball = &scene.bodies[0];
                    const double slip = ball->velocity[0] - radius * ball->angular_velocity[1];
                    if (side > 0) {
                        assert_near(slip, 0.0, 1e-12);
                        assert_near(ball->velocity[0], 2.0 * STEP * rolls, 1e-12);
                    } else {
                        assert_near(ball->velocity[0], 2.0 * STEP * (down - mu * press), 1e-12);
                        assert_true(slip > 1e-7);
                    }
                    systems_free(&scene);
                }
            }
        }
    }
}

/* ---- at random ------------------------------------------------------------------------------- */

/* Lengths from nothing to some arms of the bodies. */
static void draw_lengths(systems_scene *scene, uint64_t seed)
{
    problem_random random;
    problem_random_start(&random, 77, seed, 0);
    for (size_t i = 0; i < scene->count; i++) {
        const uint64_t kind = problem_random_bits(&random) % 5;
        const double size = exp(problem_random_uniform(&random, -6.0, 1.0));
        const double other = exp(problem_random_uniform(&random, -6.0, 1.0));
        scene->contacts[i].rolling = kind == 1 || kind == 3 || kind == 4 ? size : 0.0;
        scene->contacts[i].spinning = kind == 2 || kind == 3 || kind == 4 ? other : 0.0;
    }
}

static void test_random_systems(void **state)
{
    const uint64_t trials = problem_count(300);
    (void)state;
    for (size_t s = 0; s < 3; s++) {
        unsigned stops[6] = {0, 0, 0, 0, 0, 0};
        wrong worst = {0.0, 0.0, 0.0, 0.0};
        unsigned unsolved = 0;
        double certificate = 0.0;
        for (uint64_t i = 0; i < trials; i++) {
            systems_scene scene;
            solution got;
            systems_random(&scene, 1 + i % 6, 1 + i % 12, (uint32_t)(i * 37) & SYSTEMS_STATIC, i);
            draw_lengths(&scene, i);
            solve(&scene, solvers[s], 1e-11, s == 1 ? 20000 : 0, &got);
            stops[got.info.stop]++;
            const wrong now = judge(&scene, &got);
            certificate = fmax(certificate, wrong_certificate(&scene, &got));
            const int solved = got.info.stop == TRIBO_STOP_TOLERANCE;
            unsolved += s == 0 && !solved;
            if (s == 0 && !solved) {
                print_message("# seed %u: stop %u, eta %.3g\n", (unsigned)i,
                              (unsigned)got.info.stop, got.info.eta);
            }
            worst.bounds = fmax(worst.bounds, now.bounds);
            worst.motion = fmax(worst.motion, now.motion);
            worst.gap = fmax(worst.gap, solved ? now.gap : 0.0);
            worst.closing = fmax(worst.closing, solved ? now.closing : 0.0);
            if (solved) {
                assert_true(got.info.energy <= 1e-9 * got.info.energy_scale);
            }
            release(&got);
            systems_free(&scene);
        }
        print_message("# solver %u: tolerance %u, iterations %u, stall %u, jam %u; bounds %.3g, "
                      "closing %.3g, gap %.3g, motion %.3g\n",
                      (unsigned)solvers[s], stops[0], stops[1], stops[4], stops[5], worst.bounds,
                      worst.closing, worst.gap, worst.motion);
        print_message("# certificates: at most %.3g roundings off\n", certificate);
        assert_true(certificate <= 64.0);
        assert_true(worst.bounds <= 8.0 * EPS);
        assert_true(worst.motion <= 1e-13);
        assert_true(worst.gap <= 1e-8 && worst.closing <= 1e-8);
        assert_int_equal(unsolved, 0);
    }
}

/* ---- to the bit ------------------------------------------------------------------------------ */

static void draw_scene(uint64_t i, systems_scene *scene)
{
    if (i % 5 == 0) {
        systems_rubble(scene, 3, i);
    } else {
        systems_random(scene, 5, 9, (uint32_t)(i * 37) & SYSTEMS_ALL, i);
    }
    draw_lengths(scene, i);
}

static void assert_same(const systems_scene *s, const solution *got, const solution *want)
{
    const size_t n = 3 * s->count * sizeof(double);
    assert_memory_equal(got->impulses, want->impulses, n);
    assert_memory_equal(got->torques, want->torques, n);
    assert_memory_equal(got->velocities, want->velocities, 6 * s->body_count * sizeof(double));
    assert_memory_equal(&got->info.eta, &want->info.eta, sizeof got->info.eta);
    assert_int_equal(got->info.stop, want->info.stop);
    assert_int_equal(got->info.sweeps, want->info.sweeps);
    assert_int_equal(got->info.steps, want->info.steps);
}

static void test_powers_of_two(void **state)
{
    static const int scales[][3] = {{20, 0, 0}, {0, -40, 0}, {0, 0, 10},     {7, 0, 0},
                                    {0, 11, 0}, {7, -11, 5}, {100, -200, 50}};
    const uint64_t trials = problem_count(40);
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        const uint32_t solver = solvers[i % 3];
        systems_scene scene;
        solution want;
        draw_scene(i, &scene);
        solve(&scene, solver, 0.0, 200, &want);
        for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++) {
            const int *s = scales[k];
            systems_scene other;
            solution got;
            systems_copy(&scene, &other);
            systems_scale(&other, s[0], s[1], s[2]);
            solve(&other, solver, 0.0, 200, &got);
            for (size_t n = 0; n < 3 * scene.count; n++) {
                got.impulses[n] = ldexp(got.impulses[n], s[2] - s[0] - s[1]);
                got.torques[n] = ldexp(got.torques[n], s[2] - 2 * s[0] - s[1]);
            }
            for (size_t n = 0; n < 6 * scene.body_count; n++) {
                got.velocities[n] = ldexp(got.velocities[n], n % 6 < 3 ? s[2] - s[0] : s[2]);
            }
            assert_same(&scene, &got, &want);
            release(&got);
            systems_free(&other);
        }
        release(&want);
        systems_free(&scene);
    }
}

static void backwards(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    (void)user;
    for (uint32_t i = count; i > 0; i--) {
        task(data, i - 1);
    }
}

static void test_no_bit_depends_on_how_it_is_run(void **state)
{
    const uint64_t trials = problem_count(20);
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        tribo_system_options options = {
            .struct_size = sizeof options, .solver = solvers[i % 3], .max_iterations = 200};
        systems_scene scene;
        solution want;
        draw_scene(i, &scene);
        assert_int_equal(try_to_solve(&scene, &options, &want), TRIBO_OK);
        for (uint32_t isa = 1; isa <= TRIBO_ISA_X86_64_V4; isa++) {
            solution got;
            options.isa = isa;
            options.tasks = 1 + 3 * isa;
            options.parallel = backwards;
            if (tribo_isa_available(isa)) {
                assert_int_equal(try_to_solve(&scene, &options, &got), TRIBO_OK);
                assert_same(&scene, &got, &want);
                release(&got);
            }
        }
        release(&want);
        systems_free(&scene);
    }
}

/* One resisting contact in an island leaves other islands what they were; dimension 1 has no
 * torque, whatever its lengths are. */
static void test_what_is_not_set_is_not_paid(void **state)
{
    const uint64_t trials = problem_count(20);
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        systems_scene plain;
        systems_scene resisting;
        systems_scene both;
        solution want[2];
        solution got;
        systems_random(&plain, 5, 9, (uint32_t)(i * 37) & SYSTEMS_ALL, i);
        systems_copy(&plain, &resisting);
        for (size_t c = 0; c < resisting.count; c++) {
            resisting.contacts[c].dimension = 1;
            resisting.contacts[c].rolling = resisting.contacts[c].spinning = 1.0;
            plain.contacts[c].dimension = 1;
        }
        solve(&plain, solvers[i % 3], 0.0, 200, &want[0]);
        solve(&resisting, solvers[i % 3], 0.0, 200, &got);
        assert_same(&plain, &got, &want[0]);
        assert_int_equal(got.info.bytes, want[0].info.bytes);
        release(&got);
        for (size_t c = 0; c < resisting.count; c++) {
            resisting.contacts[c].dimension = 3;
        }
        solve(&resisting, solvers[i % 3], 0.0, 200, &want[1]);
        systems_copy(&plain, &both);
        systems_append(&both, &resisting);
        solve(&both, solvers[i % 3], 0.0, 200, &got);
        const size_t n = 3 * plain.count;
        assert_memory_equal(got.impulses, want[0].impulses, n * sizeof(double));
        assert_memory_equal(got.impulses + n, want[1].impulses, n * sizeof(double));
        assert_memory_equal(got.torques + n, want[1].torques, n * sizeof(double));
        for (size_t k = 0; k < n; k++) {
            assert_true(got.torques[k] == 0.0);
        }
        release(&got);
        release(&want[0]);
        release(&want[1]);
        systems_free(&plain);
        systems_free(&resisting);
        systems_free(&both);
    }
}

/* ---- starts, restitution, bad input ---------------------------------------------------------- */

/* A solution starts warm where impulses and torques are given. */
static void test_warm_starts(void **state)
{
    const uint64_t trials = problem_count(40);
    (void)state;
    for (uint64_t i = 0; i < trials; i++) {
        const tribo_system_options options = {
            .struct_size = sizeof options, .tolerance = 1e-9, .warm_start = 1};
        systems_scene scene;
        solution cold;
        size_t size = 0;
        systems_random(&scene, 4, 8, 0, i);
        draw_lengths(&scene, i);
        solve(&scene, TRIBO_SOLVER_AUTO, 1e-11, 0, &cold);
        assert_int_equal(cold.info.stop, TRIBO_STOP_TOLERANCE);
        tribo_system_options o = options;
        o.torques = cold.torques;
        assert_int_equal(
            tribo_system_workspace_size(scene.body_count, scene.count, scene.contacts, &o, &size),
            TRIBO_OK);
        void *workspace = malloc(size);
        assert_int_equal(tribo_system_solve(scene.body_count, scene.bodies, scene.count,
                                            scene.contacts, &o, workspace, size, cold.impulses,
                                            cold.velocities, &cold.info),
                         TRIBO_OK);
        assert_true(cold.info.sweeps <= 1 && cold.info.steps == 0); /* 1: contacts alone */
        assert_int_equal(cold.info.stop, TRIBO_STOP_TOLERANCE);
        free(workspace);
        release(&cold);
        systems_free(&scene);
    }
}

/* Restitution never adds energy, and parts a ball at -e u_n. */
static void test_restitution(void **state)
{
    const uint64_t trials = problem_count(60);
    systems_scene scene;
    solution got;
    (void)state;
    make_ball(0.3, 2.0, 0.4, 0.05, 0.02, &scene);
    scene.contacts[0].pair.e = 0.7;
    scene.bodies[0].velocity[0] = 1.5;
    scene.bodies[0].velocity[2] = -2.0;
    scene.bodies[0].angular_velocity[2] = 4.0;
    solve(&scene, TRIBO_SOLVER_AUTO, 0.0, 0, &got);
    assert_near(got.velocities[2], 1.4, 1e-9);
    assert_true(got.info.restitution == 1.0);
    assert_true(length(2, got.torques + 1) <= 0.05 * got.impulses[0] * (1.0 + 4.0 * EPS));
    assert_near(got.torques[0], -0.02 * got.impulses[0], 1e-12);
    release(&got);
    systems_free(&scene);
    for (uint64_t i = 0; i < trials; i++) {
        systems_random(&scene, 5, 9, SYSTEMS_RESTITUTION, i);
        draw_lengths(&scene, i);
        solve(&scene, TRIBO_SOLVER_AUTO, 0.0, 500, &got);
        assert_true(got.info.energy <= 1e-9 * got.info.energy_scale);
        release(&got);
        systems_free(&scene);
    }
}

static void test_bad_lengths(void **state)
{
    const struct {
        double length;
        tribo_status want;
    } bad[] = {{-1e-300, TRIBO_ERROR_FRICTION},
               {(double)NAN, TRIBO_ERROR_NOT_FINITE},
               {(double)INFINITY, TRIBO_ERROR_NOT_FINITE},
               {-(double)INFINITY, TRIBO_ERROR_NOT_FINITE}};
    const tribo_system_options options = {.struct_size = sizeof options, .warm_start = 1};
    (void)state;
    for (uint32_t i = 0; i < 16; i++) {
        systems_scene scene;
        solution got;
        make_ball(1.0, 1.0, 0.5, 0.1, 0.1, &scene);
        scene.bodies[0].velocity[2] = -1.0;
        scene.contacts[0].dimension = i % 2 == 0 ? 1 : 3;
        *(i % 4 < 2 ? &scene.contacts[0].rolling : &scene.contacts[0].spinning) = bad[i / 4].length;
        assert_int_equal(try_to_solve(&scene, &options, &got), bad[i / 4].want);
        for (int k = 0; k < 3; k++) {
            assert_true(got.impulses[k] == 0.0 && got.torques[k] == 0.0);
            assert_true(got.velocities[k] == 0.0);
        }
        release(&got);
        systems_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rolling_ball),
        cmocka_unit_test(test_spinning_ball),
        cmocka_unit_test(test_ball_on_slope),
        cmocka_unit_test(test_random_systems),
        cmocka_unit_test(test_powers_of_two),
        cmocka_unit_test(test_no_bit_depends_on_how_it_is_run),
        cmocka_unit_test(test_what_is_not_set_is_not_paid),
        cmocka_unit_test(test_warm_starts),
        cmocka_unit_test(test_restitution),
        cmocka_unit_test(test_bad_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
