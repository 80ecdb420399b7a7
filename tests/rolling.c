/* Scenes whose bodies resist rolling and spinning: closed forms, rest, saved states, what is
 * counted, bad input. */
#include <stdlib.h>

#include "worlds.h"

#define G 9.81

static const uint32_t solvers[] = {TRIBO_SOLVER_AUTO, TRIBO_SOLVER_GAUSS_SEIDEL,
                                   TRIBO_SOLVER_NEWTON};

static tribo_step_options by(uint32_t solver)
{
    const tribo_step_options options = {.struct_size = sizeof options, .solver = solver};
    return options;
}

static tribo_step_info step(tribo_scene *scene, double dt, const tribo_step_options *options)
{
    tribo_step_info info = {.struct_size = sizeof info};
    assert_int_equal(tribo_scene_step(scene, dt, options, &info), TRIBO_OK);
    assert_int_equal(info.stop, TRIBO_STOP_TOLERANCE);
    return info;
}

/* A ball that rolls loses (5/7) delta g / R of its speed a second; then it stands. */
static void test_ball_rolls_to_rest(void **state)
{
    const double radius = 0.25;
    const double rolling = 0.01;
    const double dt = 1.0 / 60.0;
    (void)state;
    for (int s = 0; s < 3; s++) {
        const tribo_step_options options = by(solvers[s]);
        tribo_scene *scene = make_scene(0.0, -G, TRIBO_MIX_MAXIMUM);
        tribo_scene_body ball = sphere_of(1.5, radius, 0.3, 0.0);
        double speed = 1.0;
        double place = 0.0;
        ball.rolling = rolling;
        ball.state.velocity[0] = 0.6 * speed;
        ball.state.velocity[1] = 0.8 * speed;
        ball.state.angular_velocity[0] = -0.8 * speed / radius;
        ball.state.angular_velocity[1] = 0.6 * speed / radius;
        add_floor(scene, 0.3, 0.0);
        const uint32_t id = add_at(scene, &ball, 0.0, 0.0, radius);
        for (int i = 0; i < 240; i++) {
            const double slower = fmax(0.0, speed - 5.0 / 7.0 * rolling * G / radius * dt);
            const tribo_step_info info = step(scene, dt, &options);
            assert_int_equal(info.contacts, 1);
            assert_int_equal(info.resisting, 1);
            place += 0.5 * (speed + slower) * dt;
            speed = slower;
            const tribo_body now = state_of(scene, id);
            within(fabs(now.velocity[0] - 0.6 * speed), 1e-11);
            within(fabs(now.velocity[1] - 0.8 * speed), 1e-11);
            within(fabs(now.angular_velocity[1] * radius - 0.6 * speed), 1e-11);
            within(fabs(now.angular_velocity[2]), 1e-11);
            within(fabs(now.position[0] - 0.6 * place), 1e-10);
        }
        assert_true(speed == 0.0);
        const tribo_body end = state_of(scene, id);
        within(tribo_vec3_norm(end.velocity), 1e-11);
        within(tribo_vec3_norm(end.angular_velocity), 1e-11);
        tribo_scene_destroy(scene);
    }
    settle("ball that rolls to rest");
}

/* One that spins loses (5/2) delta g / R^2 of its rate a second; on a table that turns it takes on
 * the table's rate. */
static void test_ball_spins_with_its_table(void **state)
{
    const double radius = 0.25;
    const double spinning = 0.02;
    const double dt = 1.0 / 60.0;
    (void)state;
    for (int s = 0; s < 3; s++) {
        for (int turns = 0; turns < 2; turns++) {
            const double table = turns * 3.0;
            const tribo_step_options options = by(solvers[s]);
            tribo_scene *scene = make_scene(0.0, -G, TRIBO_MIX_MAXIMUM);
            tribo_scene_body ball = sphere_of(1.5, radius, 0.3, 0.0);
            tribo_scene_body plate = box_of(1.0, 1.0, 1.0, 0.5, 0.3, 0.0);
            double rate = -20.0;
            plate.kind = TRIBO_BODY_KINEMATIC;
            plate.state.inverse_mass = 0.0;
            memset(plate.state.inverse_inertia, 0, sizeof plate.state.inverse_inertia);
            plate.state.angular_velocity[2] = table;
            plate.spinning = spinning;
            add_at(scene, &plate, 0.0, 0.0, -0.5);
            ball.state.angular_velocity[2] = rate;
            const uint32_t id = add_at(scene, &ball, 0.0, 0.0, radius);
            for (int i = 0; i < 240; i++) {
                step(scene, dt, &options);
                rate = fmin(table, rate + 2.5 * spinning * G / (radius * radius) * dt);
                const tribo_body now = state_of(scene, id);
                within(fabs(now.angular_velocity[2] - rate), 1e-10);
                within(tribo_vec3_norm(now.velocity), 1e-10);
            }
            assert_true(rate == table);
            tribo_scene_destroy(scene);
        }
    }
    settle("ball that spins");
}

/* What a ball does on a slope in two seconds: rests iff tan theta <= delta / R. */
static void test_ball_on_slope(void **state)
{
    const double radius = 0.5;
    const double rolling = 0.05;
    const double dt = 1.0 / 64.0;
    (void)state;
    for (int s = 0; s < 3; s++) {
        for (int k = 0; k < 4; k++) {
            const double hold = atan(rolling / radius);
            const double angle = k == 0 ? hold * (1.0 - 1e-3) : k == 1 ? hold * (1.0 + 1e-3) : 0.3;
            const double mu = k == 3 ? 0.05 : 0.5;
            const double down = G * sin(angle);
            const double press = G * cos(angle);
            const double roll = fmax(0.0, 5.0 / 7.0 * (down - rolling / radius * press));
            const double a = k == 3 ? down - mu * press : roll;
            const tribo_step_options options = by(solvers[s]);
            tribo_scene *scene = make_scene(down, -press, TRIBO_MIX_MAXIMUM);
            tribo_scene_body ball = sphere_of(2.0, radius, mu, 0.0);
            ball.rolling = rolling;
            add_floor(scene, mu, 0.0);
            const uint32_t id = add_at(scene, &ball, 0.0, 0.0, radius);
            for (int i = 0; i < 128; i++) {
                step(scene, dt, &options);
            }
            const tribo_body end = state_of(scene, id);
            const double slip = end.velocity[0] - radius * end.angular_velocity[1];
            within(fabs(end.velocity[0] - 2.0 * a), 1e-10);
            within(fabs(end.position[0] - 2.0 * a), 1e-10);
            if (k < 3) {
                within(fabs(slip), 1e-10);
            } else {
                assert_true(slip > 0.1);
            }
            tribo_scene_destroy(scene);
        }
    }
    settle("ball on a slope");
}

/* A coin's worth of contacts: a box that spins flat on the floor, with and without. */
static void test_what_is_not_set_is_not_paid(void **state)
{
    const double dt = 1.0 / 60.0;
    tribo_body ends[3];
    (void)state;
    for (int k = 0; k < 3; k++) {
        tribo_scene *scene = make_scene(0.0, -G, TRIBO_MIX_MAXIMUM);
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.1, 0.2, 0.0);
        uint64_t resisting = 0;
        box.state.angular_velocity[2] = 30.0;
        box.spinning = k == 2 ? 0.05 : 0.0;
        add_floor(scene, 0.2, 0.0);
        const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.1);
        for (int i = 0; i < 30; i++) {
            const tribo_step_info info = step(scene, dt, NULL);
            assert_int_equal(info.contacts, 4);
            resisting += info.resisting;
        }
        assert_int_equal(resisting, k == 2 ? 120 : 0);
        ends[k] = state_of(scene, id);
        tribo_scene_destroy(scene);
    }
    assert_memory_equal(&ends[0], &ends[1], sizeof ends[0]);
    assert_true(ends[2].angular_velocity[2] < ends[0].angular_velocity[2] - 0.1);
    settle("box that spins");
}

/* Balls with resistance in a heap: asleep they keep the torques that hold them; a scene that was
 * saved goes on with the same bits. */
static tribo_scene *make_heap(void)
{
    tribo_scene *scene = make_scene(0.0, -G, TRIBO_MIX_MAXIMUM);
    add_floor(scene, 0.6, 0.0);
    for (int i = 0; i < 12; i++) {
        tribo_scene_body ball = sphere_of(1.0, 0.2, 0.6, 0.0);
        ball.rolling = 0.04;
        ball.spinning = 0.02;
        add_at(scene, &ball, 0.21 * (i % 3), 0.19 * (i / 3 % 2), 0.2 + 0.35 * (i / 3));
    }
    return scene;
}

static void test_saved_scenes_go_on(void **state)
{
    static double block[8192];
    const double dt = 1.0 / 60.0;
    tribo_scene *scene = make_heap();
    tribo_scene *other = make_scene(0.0, 0.0, 0);
    size_t needed = 0;
    (void)state;
    run(scene, dt, 40, NULL);
    assert_int_equal(tribo_scene_save(scene, block, sizeof block, &needed), TRIBO_OK);
    assert_int_equal(tribo_scene_load(other, block, needed), TRIBO_OK);
    run(scene, dt, 40, NULL);
    run(other, dt, 40, NULL);
    for (uint32_t id = 0; id < 13; id++) {
        const tribo_body a = state_of(scene, id);
        const tribo_body b = state_of(other, id);
        assert_memory_equal(&a, &b, sizeof a);
    }
    tribo_scene_destroy(scene);
    tribo_scene_destroy(other);
}

static void test_torques_hold_what_sleeps(void **state)
{
    const double angle = 0.05;
    const double radius = 0.5;
    const double dt = 1.0 / 60.0;
    const tribo_step_options options = {
        .struct_size = sizeof options, .sleep_time = 0.2, .sleep_speed = 1e-6};
    tribo_scene *scene = make_scene(G * sin(angle), -G * cos(angle), TRIBO_MIX_MAXIMUM);
    tribo_scene_body ball = sphere_of(2.0, radius, 0.5, 0.0);
    tribo_scene_contact contact;
    size_t count = 0;
    uint32_t asleep = 0;
    (void)state;
    ball.rolling = 0.1;
    add_floor(scene, 0.5, 0.0);
    const uint32_t id = add_at(scene, &ball, 0.0, 0.0, radius);
    for (int i = 0; i < 30; i++) {
        step(scene, dt, &options);
    }
    assert_int_equal(tribo_scene_get_body(scene, id, &ball.state, &asleep), TRIBO_OK);
    assert_int_equal(asleep, 1);
    assert_int_equal(tribo_scene_contacts(scene, 1, &contact, &count), TRIBO_OK);
    assert_int_equal(count, 1);
    /* on A, the floor */
    within(fabs(contact.torque[1] - 2.0 * G * sin(angle) * radius * dt), 1e-12);
    within(fabs(contact.torque[0]) + fabs(contact.torque[2]), 1e-12);
    within(fabs(contact.impulse[0] - 2.0 * G * sin(angle) * dt), 1e-12);
    tribo_scene_destroy(scene);
    settle("ball asleep on a slope");
}

static void test_bad_lengths(void **state)
{
    const struct {
        double length;
        tribo_status want;
    } bad[] = {{-1e-300, TRIBO_ERROR_FRICTION},
               {(double)NAN, TRIBO_ERROR_NOT_FINITE},
               {(double)INFINITY, TRIBO_ERROR_NOT_FINITE}};
    tribo_scene *scene = make_scene(0.0, -G, 0);
    uint32_t bodies = 7;
    (void)state;
    for (int i = 0; i < 6; i++) {
        tribo_scene_body ball = sphere_of(1.0, 1.0, 0.5, 0.0);
        uint32_t id = 77;
        *(i % 2 == 0 ? &ball.rolling : &ball.spinning) = bad[i / 2].length;
        assert_int_equal(tribo_scene_add(scene, &ball, &id), bad[i / 2].want);
        assert_int_equal(id, 77);
    }
    assert_int_equal(tribo_scene_counts(scene, &bodies, NULL), TRIBO_OK);
    assert_int_equal(bodies, 0);
    tribo_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball_rolls_to_rest),
        cmocka_unit_test(test_ball_spins_with_its_table),
        cmocka_unit_test(test_ball_on_slope),
        cmocka_unit_test(test_what_is_not_set_is_not_paid),
        cmocka_unit_test(test_saved_scenes_go_on),
        cmocka_unit_test(test_torques_hold_what_sleeps),
        cmocka_unit_test(test_bad_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
