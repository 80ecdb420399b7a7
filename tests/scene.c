/* Scenes in time: limits of rest, conservation, units, saved states to the bit, events, sleep, which
 * stages run, bad input. */
#include <stdlib.h>

#include "worlds.h"

#define PI 3.14159265358979323846
#define G 9.81

static double energy_of(const tribo_scene *scene)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    tribo_totals totals;
    double potential = 0.0;
    assert_int_equal(tribo_scene_totals(scene, origin, &totals, &potential), TRIBO_OK);
    return totals.energy + potential;
}

/* ---- belts and slopes ------------------------------------------------------------------------ */

/* A box on a belt gains its speed in t = dv / (mu g), in a straight line; so it does on a floor
 * that moves. */
static void test_conveyor(void **state)
{
    const double time = 0.5 / (0.3 * G);
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double dt = 1e-3;
        tribo_scene *scene = make_scene(0.0, -G, 0);
        tribo_scene_body belt = floor_of(0.3, 0.0);
        tribo_scene_body box = box_of(2.0, 0.5, 0.4, 0.1, 0.3, 0.0);
        if (k == 0) {
            belt.belt[0] = 0.5;
        } else {
            belt.kind = TRIBO_BODY_KINEMATIC;
            belt.state.velocity[0] = 0.5;
        }
        add(scene, &belt);
        const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.1);
        run(scene, dt, 1000, NULL);
        const tribo_body end = state_of(scene, id);
        within(fabs(end.velocity[0] - 0.5), 1e-13);
        within(fabs(end.position[0] - 0.25 * time - 0.5 * (1.0 - time)), dt);
        within(fabs(end.position[1]), 1e-12);
        tribo_scene_destroy(scene);
    }
    settle("conveyor");
}

/* Friction just above the slope's holds without creep; below, a = g (sin - mu cos). */
static void test_box_on_a_slope(void **state)
{
    static const double parts[4] = {1.1, 1.001, 1.0001, 0.99};
    const double angle = PI / 6.0;
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double mu = parts[k] * tan(angle);
        const double a = 10.0 * (sin(angle) - mu * cos(angle));
        tribo_scene *scene = make_scene(10.0 * sin(angle), -10.0 * cos(angle), 0);
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, mu, 0.0);
        add_floor(scene, mu, 0.0);
        const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.5);
        run(scene, 1.0 / 60.0, 600, NULL);
        const double x = state_of(scene, id).position[0];
        within(fabs(x - (a > 0.0 ? 50.0 * a : 0.0)), 1e-9);
        tribo_scene_destroy(scene);
    }
    settle("10 s on a slope");
}

/* Balls that touch share an impact: Newton's law for all contacts at once. Balls with gaps pass it
 * on, also where one could come to all others in a step, were they not in each other's way. */
static void test_cradles(void **state)
{
    static const double shared[5] = {-0.6, 0.4, 0.4, 0.4, 0.4};
    static const double passed[5] = {0.0, 0.0, 0.0, 0.0, 1.0};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const int has_gaps = k % 2;
        tribo_scene *scene = make_scene(0.0, 0.0, 0);
        tribo_scene_body ball = sphere_of(1.0, 0.5, 0.0, 1.0);
        const double dt = k < 2 ? 0.01 : 8.0;
        for (int i = 0; i < 5; i++) {
            ball.state.velocity[0] = i == 0 ? 1.0 : 0.0;
            add_at(scene, &ball, i == 0 ? -0.5 * dt : i * (has_gaps ? 1.001 : 1.0), 0.0, 0.0);
        }
        run(scene, dt, k < 2 ? 100 : 4, NULL);
        for (uint32_t i = 0; i < 5; i++) {
            const double v = state_of(scene, i).velocity[0];
            within(fabs(v - (has_gaps ? passed[i] : shared[i])), 1e-12);
        }
        tribo_scene_destroy(scene);
    }
    settle("five balls in a row");
}

/* ---- units ----------------------------------------------------------------------------------- */

enum { MIXED = 10 };

/* Boxes and balls that tumble onto a block, in units of length, mass and time. */
static void tumble(double length, double mass, double time, tribo_body *end)
{
    tribo_scene *scene = make_scene(0.0, -G * length / (time * time), 0);
    tribo_scene_body block = floor_of(0.4, 0.3);
    block.shape.type = TRIBO_SHAPE_BOX;
    block.shape.size[0] = block.shape.size[1] = 5.0 * length;
    block.shape.size[2] = 0.5 * length;
    add_at(scene, &block, 0.0, 0.0, -0.5 * length);
    for (int i = 0; i < MIXED; i++) {
        const double m = mass * (1 + i);
        tribo_scene_body body =
            i % 3 == 0 ? sphere_of(m, 0.15 * length, 0.4, 0.3)
                       : box_of(m, 0.2 * length, 0.15 * length, 0.1 * length, 0.4, 0.3);
        body.state.angular_velocity[0] = 0.5 * i / time;
        add_at(scene, &body, 0.1 * (i % 3) * length, 0.1 * (i % 2) * length,
               (0.5 + 0.4 * i) * length);
    }
    const tribo_step_info info = run(scene, time / 64.0, 200, NULL);
    assert_true(info.impacts > 10 && info.contact_solves > 100);
    for (uint32_t i = 0; i < MIXED; i++) {
        end[i] = state_of(scene, i + 1);
    }
    tribo_scene_destroy(scene);
}

/* Powers of two scale the answer to the bit. */
static void test_units_do_not_matter(void **state)
{
    static const int exponents[3][3] = {{20, -40, 10}, {-20, 40, -10}, {3, 0, 0}};
    tribo_body plain[MIXED];
    tribo_body scaled[MIXED];
    (void)state;
    tumble(1.0, 1.0, 1.0, plain);
    for (int k = 0; k < 3; k++) {
        const double length = ldexp(1.0, exponents[k][0]);
        const double time = ldexp(1.0, exponents[k][2]);
        tumble(length, ldexp(1.0, exponents[k][1]), time, scaled);
        for (int i = 0; i < MIXED; i++) {
            for (int j = 0; j < 3; j++) {
                assert_true(scaled[i].position[j] == plain[i].position[j] * length);
                assert_true(scaled[i].velocity[j] == plain[i].velocity[j] * length / time);
                assert_true(scaled[i].angular_velocity[j] == plain[i].angular_velocity[j] / time);
            }
            assert_true(same_bits(scaled[i].orientation, plain[i].orientation, 4));
        }
    }
}

/* ---- stacks ---------------------------------------------------------------------------------- */

typedef struct stack {
    tribo_scene *scene;
    uint32_t top;
    double mass;
} stack;

static stack make_stack(int boxes, double ratio)
{
    stack out = {make_scene(0.0, -G, 0), 0, 0.0};
    add_floor(out.scene, 0.5, 0.0);
    for (int k = 0; k < boxes; k++) {
        const double mass = k == boxes - 1 ? ratio : 1.0;
        tribo_scene_body box = box_of(mass, 0.5, 0.5, 0.5, 0.5, 0.0);
        out.top = add_at(out.scene, &box, 0.0, 0.0, 0.5 + k);
        out.mass += mass;
    }
    return out;
}

static void test_stacks_rest(void **state)
{
    /* A residual of 1e-12 is one of the greatest impulse: it may move the lightest body by that. */
    static const struct {
        int boxes;
        double ratio;
    } cases[5] = {{1, 1.0}, {10, 1.0}, {2, 1000.0}, {2, 1e6}, {20, 1.0}};
    const double dt = 1.0 / 60.0;
    (void)state;
    for (int k = 0; k < 5; k++) {
        const int boxes = cases[k].boxes;
        const double residual = 1e-12 * fmax(cases[k].ratio, boxes) * G * dt;
        const stack s = make_stack(boxes, cases[k].ratio);
        tribo_scene_event events[32];
        size_t count = 0;
        const tribo_step_info first = run(s.scene, dt, 1, NULL);
        const tribo_step_info rest = run(s.scene, dt, 600, NULL);
        const tribo_body top = state_of(s.scene, s.top);
        assert_int_equal(first.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(rest.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(rest.impacts, 0);
        assert_int_equal(tribo_scene_events(s.scene, 32, events, &count), TRIBO_OK);
        assert_int_equal(count, boxes);
        print_message("# %d boxes, top %g kg: moved by %.2g, %.2g m, %d sweeps and %d Newton steps "
                      "in 600 steps\n",
                      boxes, cases[k].ratio, hypot(top.position[0], top.position[1]),
                      top.position[2] - (boxes - 0.5), (int)rest.sweeps, (int)rest.newton_steps);
        within(hypot(top.position[0], top.position[1]), residual * 600.0 * dt * boxes);
        within(fabs(top.position[2] - (boxes - 0.5)), (residual * 600.0 * dt + 1e-9) * boxes);
        double above = s.mass;
        for (int i = 0; i < boxes; i++) {
            const double weight = above * G * dt;
            assert_int_equal(events[i].kind, TRIBO_EVENT_PERSIST);
            within(fabs(-events[i].impulse[2] - weight), 1e-8 * weight * boxes);
            within(fabs(events[i].normal - weight), 1e-8 * weight * boxes);
            above -= 1.0;
        }
        tribo_scene_destroy(s.scene);
    }
    settle("stacks over 10 s");
}

/* ---- conservation ---------------------------------------------------------------------------- */

static double random_number(void)
{
    static uint64_t seed = 1;
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

static tribo_scene *make_encounter(double mu, double e)
{
    tribo_scene *scene = make_scene(0.0, 0.0, 0);
    for (int k = 0; k < 2; k++) {
        tribo_scene_body box = box_of(1.0 + k, 0.5, 0.3, 0.2, mu, e);
        for (int i = 0; i < 3; i++) {
            box.state.velocity[i] = random_number();
            box.state.angular_velocity[i] = 3.0 * random_number();
        }
        box.state.velocity[0] += k == 0 ? 3.0 : -3.0;
        const double y = 0.3 * random_number();
        const double z = 0.3 * random_number();
        add_at(scene, &box, k == 0 ? -1.5 : 1.5, y, z);
    }
    return scene;
}

/* Two boxes in empty space: momentum to rounding as long as nothing is moved apart, kinetic energy
 * never more, and with e = 1 and no friction never less. */
static void test_encounters_conserve(void **state)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    static const double cases[5][2] = {{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.0}, {0.5, 0.5}, {0.5, 1.0}};
    int met = 0;
    (void)state;
    for (int k = 0; k < 5 * 200; k++) {
        tribo_scene *scene = make_encounter(cases[k / 200][0], cases[k / 200][1]);
        const tribo_step_options options = {.struct_size = sizeof options,
                                            .skip = TRIBO_SKIP_CORRECTION};
        tribo_totals before;
        tribo_totals after;
        tribo_change change;
        tribo_scene_totals(scene, origin, &before, NULL);
        const tribo_step_info info = run(scene, 1.0 / 60.0, 60, &options);
        tribo_scene_totals(scene, origin, &after, NULL);
        assert_int_equal(tribo_audit_change(&before, &after, &change), TRIBO_OK);
        met += info.contact_solves + info.impact_solves > 0;
        within(change.linear, 64.0 * EPS);
        within(change.angular, 64.0 * EPS);
        within(fmax(change.energy, 0.0), 64.0 * EPS);
        /* What the solver leaves of each impact. */
        within(k < 200 ? fmax(-change.energy, 0.0) : 0.0, 1e-12 * (1.0 + (double)info.impacts));
        tribo_scene_destroy(scene);
    }
    print_message("# %d of 1000 pairs met\n", met);
    assert_true(met > 500);
    settle("momentum and energy of encounters");
}

/* An elastic heap of spheres, frictionless: total energy to rounding over many impacts. In long
 * steps what comes to rest on others takes some; none comes up. */
static void test_elastic_heap_keeps_energy(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double dt = k == 0 ? 0.01 : 0.1;
        tribo_scene *scene = make_scene(0.0, -G, 0);
        add_floor(scene, 0.0, 1.0);
        for (int i = 0; i < 64; i++) {
            tribo_scene_body ball = sphere_of(10.0, 0.1, 0.0, 1.0);
            const double x = 0.21 * (i % 4) + 1e-3 * random_number();
            const double y = 0.21 * (i / 4 % 4) + 1e-3 * random_number();
            const double z = 1.1 + 0.21 * (i / 16) + 1e-3 * random_number();
            add_at(scene, &ball, x, y, z);
        }
        const double before = energy_of(scene);
        const tribo_step_info info = run(scene, dt, (int)(2.0 / dt + 0.5), NULL);
        const double gained = energy_of(scene) - before;
        print_message("# step %g s: %d impacts, energy off by %.3g of %g J\n", dt,
                      (int)info.impacts, gained, before);
        assert_true(info.impacts > 100);
        within(fmax(gained, k == 0 ? -gained : 0.0), 1e-11 * before);
        within(fmax(-gained, 0.0), 0.05 * before);
        tribo_scene_destroy(scene);
    }
    settle("elastic heap");
}

/* A wall of 1 cm stops a ball at 300 m/s, which passes 5 m in a step. */
static void test_fast_ball_does_not_pass(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const tribo_step_options options = {.struct_size = sizeof options,
                                            .skip = k == 0 ? 0 : TRIBO_SKIP_SPECULATION};
        tribo_scene *scene = make_scene(0.0, 0.0, 0);
        tribo_scene_body wall = floor_of(0.0, 0.0);
        tribo_scene_body ball = sphere_of(0.01, 0.01, 0.0, 0.0);
        wall.shape.type = TRIBO_SHAPE_BOX;
        wall.shape.size[0] = 0.005;
        wall.shape.size[1] = wall.shape.size[2] = 5.0;
        add(scene, &wall);
        ball.state.velocity[0] = 300.0;
        const uint32_t id = add_at(scene, &ball, -13.3, 0.0, 0.0);
        run(scene, 1.0 / 60.0, 60, &options);
        const double x = state_of(scene, id).position[0];
        if (k == 0) {
            within(fabs(x + 0.015), 1e-12);
        } else {
            assert_true(x > 1.0);
        }
        tribo_scene_destroy(scene);
    }
    settle("a ball before a wall");
}

/* It does not matter whether the floor or what falls on it comes first. */
static void test_floor_may_come_last(void **state)
{
    tribo_body ends[2];
    (void)state;
    for (int last = 0; last < 2; last++) {
        tribo_scene *scene = make_scene(0.0, -G, 0);
        tribo_scene_body box = box_of(1.0, 0.2, 0.3, 0.4, 0.5, 0.3);
        box.state.angular_velocity[0] = 2.0;
        if (last == 0) {
            add_floor(scene, 0.5, 0.3);
        }
        const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.6);
        if (last == 1) {
            add_floor(scene, 0.5, 0.3);
        }
        run(scene, 0.01, 200, NULL);
        ends[last] = state_of(scene, id);
        tribo_scene_destroy(scene);
    }
    within(distance(ends[0].position, ends[1].position, 3), 1e-9);
    within(fabs(ends[1].position[2] - 0.4), 1e-9);
    settle("box on a floor that was added last");
}

/* A floor without end that turns about its normal does nothing to a ball at rest on it; one that
 * tilts takes it along. */
static void test_turning_floor(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        tribo_scene *scene = make_scene(0.0, -G, 0);
        tribo_scene_body plate = floor_of(0.0, 0.0);
        tribo_scene_body ball = sphere_of(1.0, 0.5, 0.0, 0.0);
        double normal[3];
        plate.kind = TRIBO_BODY_KINEMATIC;
        plate.state.angular_velocity[k == 0 ? 2 : 1] = -2.0;
        const uint32_t floor = add(scene, &plate);
        const uint32_t id = add_at(scene, &ball, 2.0, 0.0, 0.5);
        run(scene, 0.01, 30, NULL);
        const tribo_body end = state_of(scene, id);
        const double up[3] = {0.0, 0.0, 1.0};
        tribo_quat_rotate(state_of(scene, floor).orientation, up, normal);
        const double gap = tribo_vec3_dot(normal, end.position) - 0.5;
        within(fmax(-gap, 0.0), 2e-3); /* (omega h)^2 r / 2 in a step, of which a quarter goes */
        within(k == 0 ? distance(end.position, ball.state.position, 3) : 0.0, 1e-12);
        within(k == 1 ? fmax(2.0 - end.velocity[2], 0.0) : 0.0, 1e-12);
        tribo_scene_destroy(scene);
    }
    settle("turning floor");
}

/* Overlaps go away, and nothing gets faster by it. */
static void test_overlap_goes_without_speed(void **state)
{
    tribo_scene *scene = make_scene(0.0, 0.0, 0);
    (void)state;
    tribo_scene_body ball = sphere_of(1.0, 0.5, 0.0, 0.0);
    const uint32_t a = add_at(scene, &ball, 0.0, 0.0, 0.0);
    const uint32_t b = add_at(scene, &ball, 0.9, 0.0, 0.0);
    const tribo_step_info info = run(scene, 1.0 / 60.0, 200, NULL);
    const tribo_body one = state_of(scene, a);
    const tribo_body two = state_of(scene, b);
    assert_true(info.correction_solves > 0);
    assert_true(energy_of(scene) == 0.0);
    within(fabs(two.position[0] - one.position[0] - 1.0), 1e-8);
    within(fabs(two.position[0] + one.position[0] - 0.9), 1e-14);
    settle("two balls that overlap");
    tribo_scene_destroy(scene);
}

/* ---- only what the scene needs --------------------------------------------------------------- */

static void test_stages_that_are_not_needed(void **state)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body ball = sphere_of(1.0, 0.5, 0.0, 0.0);
    (void)state;
    tribo_step_info info = run(scene, 0.01, 3, NULL);
    assert_int_equal(info.flights + info.broad + info.contact_solves, 0);
    add_at(scene, &ball, 0.0, 0.0, 0.5);
    info = run(scene, 0.01, 3, NULL);
    assert_int_equal(info.flights, 5); /* the first half-flight is one at rest */
    assert_int_equal(info.turns + info.broad + info.pairs, 0);
    tribo_scene_destroy(scene);

    scene = make_scene(0.0, -G, 0);
    add_floor(scene, 0.0, 0.0);
    add_at(scene, &ball, 0.0, 0.0, 5.0);
    info = run(scene, 0.01, 3, NULL);
    assert_int_equal(info.broad, 3);
    assert_int_equal(info.contact_solves + info.impact_solves + info.contacts, 0);
    run(scene, 0.01, 200, NULL);
    info = run(scene, 0.01, 3, NULL);
    assert_int_equal(info.contact_solves, 3);
    assert_int_equal(info.contacts, 3);
    assert_int_equal(info.frictionless, 3);
    assert_int_equal(info.matched, 3);
    assert_int_equal(info.impact_solves + info.correction_solves + info.turns, 0);
    tribo_scene_destroy(scene);
}

/* Contacts keep their impulses from step to step, and those of no use are left out. */
static void test_warm_start(void **state)
{
    tribo_step_options cold = {.struct_size = sizeof cold, .skip = TRIBO_SKIP_WARM_START};
    const stack a = make_stack(5, 1.0);
    const stack b = make_stack(5, 1.0);
    (void)state;
    run(a.scene, 0.01, 1, NULL);
    run(b.scene, 0.01, 1, &cold);
    const tribo_step_info warm = run(a.scene, 0.01, 50, NULL);
    const tribo_step_info none = run(b.scene, 0.01, 50, &cold);
    print_message("# sweeps and Newton steps: %d and %d warm, %d and %d cold\n", (int)warm.sweeps,
                  (int)warm.newton_steps, (int)none.sweeps, (int)none.newton_steps);
    assert_int_equal(none.matched, 0);
    assert_int_equal(warm.matched, warm.contacts);
    assert_true(warm.sweeps + 10 * warm.newton_steps < none.sweeps + 10 * none.newton_steps);
    tribo_scene_destroy(a.scene);
    tribo_scene_destroy(b.scene);
}

/* Bricks in rows, each on two, and a heavy one on top; a ball between two that do not move. */
static tribo_scene *make_triangle(void)
{
    enum { ROWS = 8 };
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body ball = sphere_of(2.0, 0.5, 0.6, 0.0);
    add_floor(scene, 0.5, 0.0);
    for (int row = 0; row < ROWS; row++) {
        tribo_scene_body brick = box_of(row + 1 < ROWS ? 1.0 : 1000.0, 0.5, 0.25, 0.1, 0.5, 0.0);
        for (int i = 0; i < ROWS - row; i++) {
            add_at(scene, &brick, 1.1 * (i + 0.5 * row), 0.0, 0.1 + 0.2 * row);
        }
    }
    add_at(scene, &ball, 0.5, 5.0, 0.5 + 0.8660254037844386);
    ball.kind = TRIBO_BODY_STATIC;
    ball.state.inverse_mass = 0.0;
    memset(ball.state.inverse_inertia, 0, sizeof ball.state.inverse_inertia);
    add_at(scene, &ball, 0.0, 5.0, 0.5);
    add_at(scene, &ball, 1.0, 5.0, 0.5);
    return scene;
}

/* A plank on three posts with a weight above the third: evenly shared, the first would pull. */
static tribo_scene *make_plank(void)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body post = box_of(1.0, 0.1, 0.1, 0.5, 0.5, 0.0);
    tribo_scene_body plank = box_of(1.0, 2.5, 0.1, 0.1, 0.5, 0.0);
    tribo_scene_body weight = box_of(100.0, 0.1, 0.1, 0.1, 0.5, 0.0);
    add_floor(scene, 0.5, 0.0);
    for (int i = -1; i <= 1; i++) {
        add_at(scene, &post, 2.0 * i, 0.0, 0.5);
    }
    add_at(scene, &plank, 0.0, 0.0, 1.1);
    add_at(scene, &weight, 2.0, 0.0, 1.3);
    return scene;
}

/* Two boxes on a slope. */
static tribo_scene *make_leaning(void)
{
    tribo_scene *scene = make_scene(0.5 * G, -0.8660254037844386 * G, 0);
    tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.2, 0.7, 0.0);
    add_floor(scene, 0.7, 0.0);
    add_at(scene, &box, 0.0, 0.0, 0.2);
    add_at(scene, &box, 0.1, 0.0, 0.6);
    return scene;
}

/* What bodies at rest have to carry is known before any solver runs, for each of them. */
static void test_rest_needs_no_solver(void **state)
{
    static tribo_scene *(*const make[3])(void) = {make_triangle, make_plank, make_leaning};
    (void)state;
    for (int i = 0; i < 6; i++) {
        tribo_step_options options = {.struct_size = sizeof options};
        options.solver = i % 2 == 0 ? TRIBO_SOLVER_AUTO : TRIBO_SOLVER_GAUSS_SEIDEL;
        tribo_scene *scene = make[i / 2]();
        tribo_step_info info = run(scene, 0.01, 1, &options);
        assert_int_equal(info.stop, TRIBO_STOP_TOLERANCE);
        assert_int_equal(info.sweeps + info.newton_steps, 0);
        assert_int_equal(info.matched, 0);
        tribo_scene_destroy(scene);
        options.skip = TRIBO_SKIP_WARM_START;
        scene = make[i / 2]();
        info = run(scene, 0.01, 1, &options);
        assert_true(info.sweeps + info.newton_steps > 0);
        tribo_scene_destroy(scene);
    }
}

/* The top box of a high tower falls onto it: four sweeps a step, which find no balance of so many by
 * themselves, bring it to rest all the same. */
static void test_tower_comes_to_rest_by_few_sweeps(void **state)
{
    enum { HIGH = 40 };
    const tribo_step_options options = {.struct_size = sizeof options,
                                        .max_iterations = 4,
                                        .solver = TRIBO_SOLVER_GAUSS_SEIDEL,
                                        .tolerance = 1e-6};
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, 0.5, 0.0);
    (void)state;
    add_floor(scene, 0.5, 0.0);
    for (int i = 0; i < HIGH; i++) {
        add_at(scene, &box, 0.02 * (i % 3), 0.0, 0.5 + i + (i + 1 < HIGH ? 0.0 : 0.05));
    }
    run(scene, 1.0 / 240.0, 480, &options);
    for (uint32_t i = 1; i <= HIGH; i++) {
        const tribo_body body = state_of(scene, i);
        within(tribo_vec3_norm(body.velocity), 1e-9);
        within(fabs(body.position[2] - (i - 0.5)), 1e-3);
    }
    settle("a tower of 40 by 4 sweeps");
    tribo_scene_destroy(scene);
}

/* What a coarse tolerance forgives does not gather from step to step where a box sticks. */
static void test_coarse_tolerances_do_not_creep(void **state)
{
    static const double tolerances[2] = {1e-3, 1e-6};
    const double angle = atan(0.45);
    (void)state;
    for (int k = 0; k < 2; k++) {
        const tribo_step_options options = {.struct_size = sizeof options,
                                            .tolerance = tolerances[k]};
        tribo_scene *scene = make_scene(G * sin(angle), -G * cos(angle), 0);
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, 0.5, 0.0);
        add_floor(scene, 0.5, 0.0);
        const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.5);
        run(scene, 1.0 / 240.0, 2400, &options);
        const tribo_body end = state_of(scene, id);
        within(fabs(end.position[0]), 1e-12);
        within(tribo_vec3_norm(end.velocity), 1e-12);
        tribo_scene_destroy(scene);
    }
    settle("10 s on a slope by coarse tolerances");
}

/* A thousand kilogrammes fall onto one by 1 m; what has sunk in when they meet is all that does. */
static void test_heavy_box_is_stopped_by_few_sweeps(void **state)
{
    const tribo_step_options options = {.struct_size = sizeof options,
                                        .max_iterations = 4,
                                        .solver = TRIBO_SOLVER_GAUSS_SEIDEL,
                                        .tolerance = 1e-6};
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body light = box_of(1.0, 0.5, 0.5, 0.5, 0.5, 0.0);
    tribo_scene_body heavy = box_of(1000.0, 0.5, 0.5, 0.5, 0.5, 0.0);
    (void)state;
    add_floor(scene, 0.5, 0.0);
    add_at(scene, &light, 0.0, 0.0, 0.5);
    const uint32_t id = add_at(scene, &heavy, 0.0, 0.0, 2.5);
    run(scene, 1.0 / 240.0, 480, &options);
    const tribo_body end = state_of(scene, id);
    within(fabs(end.position[2] - 1.5), 5e-3);
    within(tribo_vec3_norm(end.velocity), 1e-9);
    settle("1000 kg on 1 kg by 4 sweeps");
    tribo_scene_destroy(scene);
}

/* ---- events ---------------------------------------------------------------------------------- */

static void test_events(void **state)
{
    tribo_scene *scene = make_scene(0.0, -10.0, 0);
    tribo_scene_body ball = sphere_of(2.0, 0.5, 0.0, 0.5);
    tribo_scene_event event;
    size_t count = 9;
    (void)state;
    add_floor(scene, 0.0, 0.5);
    ball.state.velocity[2] = -2.0;
    const uint32_t id = add_at(scene, &ball, 0.0, 0.0, 0.515);
    run(scene, 0.01, 1, NULL);
    assert_int_equal(tribo_scene_events(scene, 1, &event, &count), TRIBO_OK);
    assert_int_equal(count, 1);
    assert_int_equal(event.kind, TRIBO_EVENT_BEGIN);
    assert_int_equal(event.a, 0);
    assert_int_equal(event.b, id);
    assert_int_equal(event.impacts, 1);
    /* It meets the floor at 2 + 10 h/2 m/s. */
    within(fabs(event.impulse[2] + 2.0 * 1.5 * 2.05), 1e-13);
    within(fabs(event.normal - 2.0 * 1.5 * 2.05), 1e-13);
    run(scene, 0.01, 1, NULL);
    assert_int_equal(tribo_scene_events(scene, 1, &event, &count), TRIBO_OK);
    assert_int_equal(count, 1);
    assert_int_equal(event.kind, TRIBO_EVENT_END);
    assert_true(event.normal == 0.0 && event.impulse[2] == 0.0);
    run(scene, 0.01, 1, NULL);
    assert_int_equal(tribo_scene_events(scene, 0, NULL, &count), TRIBO_OK);
    assert_int_equal(count, 0);
    settle("impulse of an impact");
    tribo_scene_destroy(scene);
}

static void test_contacts(void **state)
{
    const stack s = make_stack(2, 1.0);
    tribo_scene_contact contacts[8];
    size_t count = 0;
    double sum = 0.0;
    (void)state;
    const tribo_step_options options = {.struct_size = sizeof options, .substeps = 4};
    run(s.scene, 0.04, 10, &options);
    assert_int_equal(tribo_scene_contacts(s.scene, 7, contacts, &count), TRIBO_ERROR_CAPACITY);
    assert_int_equal(count, 8);
    assert_int_equal(tribo_scene_contacts(s.scene, 8, contacts, &count), TRIBO_OK);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(contacts[i].a, i / 4);
        assert_int_equal(contacts[i].b, i / 4 + 1);
        within(fabs(contacts[i].normal[2] + 1.0), 1e-9);
        within(fabs(contacts[i].arm_b[2] + 0.5), 1e-9);
        within(fabs(contacts[i].distance), 1e-9);
        sum -= contacts[i].impulse[2];
    }
    within(fabs(sum - 3.0 * G * 0.01), 1e-9);
    settle("contacts of two boxes");
    tribo_scene_destroy(s.scene);
}

/* ---- saving ---------------------------------------------------------------------------------- */

static tribo_scene *make_mixture(void)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    add_floor(scene, 0.4, 0.3);
    for (int i = 0; i < 12; i++) {
        tribo_scene_body box = box_of(1.0 + i, 0.2, 0.15, 0.1, 0.4, 0.3);
        tribo_scene_body ball = sphere_of(1.0 + i, 0.15, 0.4, 0.3);
        tribo_scene_body *body = i % 3 == 0 ? &ball : &box;
        body->state.angular_velocity[0] = 0.5 * i;
        body->offset.position[0] = i == 4 ? 0.05 : 0.0;
        add_at(scene, body, 0.1 * (i % 3), 0.1 * (i % 2), 0.5 + 0.4 * i);
    }
    return scene;
}

static void assert_same(const tribo_scene *a, const tribo_scene *b, uint32_t end)
{
    for (uint32_t i = 0; i < end; i++) {
        tribo_body one;
        tribo_body two;
        assert_int_equal(tribo_scene_get_body(a, i, &one, NULL),
                         tribo_scene_get_body(b, i, &two, NULL));
        assert_memory_equal(&one, &two, sizeof one);
    }
}

static void test_saved_state_goes_on_to_the_bit(void **state)
{
    const tribo_step_options options = {
        .struct_size = sizeof options, .substeps = 2, .sleep_time = 0.5, .sleep_speed = 0.05};
    tribo_scene *scene = make_mixture();
    tribo_scene *other = make_scene(0.0, 0.0, 0);
    size_t needed = 0;
    (void)state;
    assert_int_equal(tribo_scene_remove(scene, 3), TRIBO_OK);
    run(scene, 1.0 / 60.0, 60, &options);
    assert_int_equal(tribo_scene_save(scene, NULL, 0, &needed), TRIBO_ERROR_CAPACITY);
    void *block = malloc(needed);
    void *again = malloc(needed);
    assert_non_null(block);
    assert_non_null(again);
    assert_int_equal(tribo_scene_save(scene, block, needed, NULL), TRIBO_OK);
    const tribo_step_info first = run(scene, 1.0 / 60.0, 200, &options);
    assert_int_equal(tribo_scene_load(other, block, needed), TRIBO_OK);
    assert_int_equal(tribo_scene_save(other, again, needed, NULL), TRIBO_OK);
    assert_memory_equal(block, again, needed);
    const tribo_step_info second = run(other, 1.0 / 60.0, 200, &options);
    assert_memory_equal(&first, &second, sizeof first);
    assert_same(scene, other, 13);
    assert_int_equal(tribo_scene_load(scene, block, needed), TRIBO_OK);
    run(scene, 1.0 / 60.0, 200, &options);
    assert_same(scene, other, 13);

    ((unsigned char *)block)[needed / 2] ^= 1;
    assert_int_equal(tribo_scene_load(scene, block, needed), TRIBO_ERROR_DATA);
    ((unsigned char *)block)[needed / 2] ^= 1;
    assert_int_equal(tribo_scene_load(scene, block, needed - 8), TRIBO_ERROR_DATA);
    assert_int_equal(tribo_scene_load(scene, block, 8), TRIBO_ERROR_DATA);
    assert_same(scene, other, 13);
    free(block);
    free(again);
    tribo_scene_destroy(scene);
    tribo_scene_destroy(other);
}

/* ---- sleep ----------------------------------------------------------------------------------- */

static uint32_t sleepers(const tribo_scene *scene, uint32_t end)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < end; i++) {
        tribo_body state;
        uint32_t asleep = 9;
        assert_int_equal(tribo_scene_get_body(scene, i, &state, &asleep), TRIBO_OK);
        count += asleep;
    }
    return count;
}

static void test_sleep(void **state)
{
    const tribo_step_options options = {
        .struct_size = sizeof options, .sleep_time = 0.1, .sleep_speed = 0.01};
    const double dt = 0.01;
    const stack s = make_stack(3, 1.0);
    tribo_scene_event events[4];
    size_t count = 0;
    (void)state;
    run(s.scene, dt, 9, &options);
    assert_int_equal(sleepers(s.scene, 4), 0);
    run(s.scene, dt, 3, &options);
    assert_int_equal(sleepers(s.scene, 4), 3);
    const tribo_step_info info = run(s.scene, dt, 10, &options);
    assert_int_equal(info.asleep, 3);
    assert_int_equal(info.pairs + info.contact_solves + info.flights, 0);
    assert_int_equal(tribo_scene_events(s.scene, 4, events, &count), TRIBO_OK);
    assert_int_equal(count, 3);
    within(fabs(events[0].normal - 3.0 * G * dt), 1e-9);

    /* A ball that falls on it wakes all of it when it comes near. */
    tribo_scene_body ball = sphere_of(1.0, 0.2, 0.5, 0.0);
    ball.state.velocity[2] = -1.0;
    add_at(s.scene, &ball, 0.0, 0.0, 3.4);
    run(s.scene, dt, 1, &options);
    assert_int_equal(sleepers(s.scene, 5), 3);
    run(s.scene, dt, 20, &options);
    assert_int_equal(sleepers(s.scene, 5), 0);
    run(s.scene, dt, 100, &options);
    assert_int_equal(sleepers(s.scene, 5), 4);

    /* What stands on a body that is taken away falls. */
    assert_int_equal(tribo_scene_remove(s.scene, 1), TRIBO_OK);
    run(s.scene, dt, 10, &options);
    assert_true(state_of(s.scene, 3).velocity[2] < -0.5);
    settle("impulses of sleepers");
    tribo_scene_destroy(s.scene);
}

/* ---- bad input ------------------------------------------------------------------------------- */

static void test_bad_bodies(void **state)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    const tribo_scene_body good = sphere_of(1.0, 0.5, 0.5, 0.5);
    uint32_t id = 77;
    uint32_t before = 0;
    (void)state;
#define REFUSED(status, change)                                                \
    do {                                                                       \
        tribo_scene_body bad = good;                                           \
        change;                                                                \
        ASSERT_REFUSED(id, before, status, tribo_scene_add(scene, &bad, &id)); \
    } while (0)
    REFUSED(TRIBO_ERROR_STRUCT_SIZE, bad.struct_size = 4);
    REFUSED(TRIBO_ERROR_OPTION, bad.kind = 3);
    REFUSED(TRIBO_ERROR_MASS, bad.state.inverse_mass = 0.0);
    REFUSED(TRIBO_ERROR_MASS, bad.kind = TRIBO_BODY_STATIC);
    REFUSED(TRIBO_ERROR_INERTIA, bad.kind = TRIBO_BODY_STATIC; bad.state.inverse_mass = 0.0);
    REFUSED(TRIBO_ERROR_INERTIA, bad.state.inverse_inertia[1] = bad.state.inverse_inertia[0]);
    REFUSED(TRIBO_ERROR_NOT_FINITE, bad.state.position[1] = NOT_A_NUMBER);
    REFUSED(TRIBO_ERROR_NOT_FINITE, bad.belt[2] = INFINITE);
    REFUSED(TRIBO_ERROR_NOT_FINITE, bad.offset.position[0] = NOT_A_NUMBER);
    REFUSED(TRIBO_ERROR_ORIENTATION, bad.offset.orientation[0] = 0.5);
    REFUSED(TRIBO_ERROR_ORIENTATION, bad.state.orientation[0] = 0.5);
    REFUSED(TRIBO_ERROR_FRICTION, bad.material.mu_d = 0.6);
    REFUSED(TRIBO_ERROR_RESTITUTION, bad.material.e = 1.5);
    REFUSED(TRIBO_ERROR_SHAPE, bad.shape.size[0] = 0.0);
    REFUSED(TRIBO_ERROR_OPTION, bad.shape.type = 99);
    REFUSED(TRIBO_ERROR_SHAPE, bad.shape.type = TRIBO_SHAPE_HALFSPACE; bad.shape.size[0] = 1.0);
    REFUSED(TRIBO_ERROR_RANGE, tribo_body_init(&bad.state); bad.kind = TRIBO_BODY_STATIC;
            bad.state.velocity[0] = 1.0);
#undef REFUSED
    assert_int_equal(tribo_scene_add(NULL, &good, &id), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_add(scene, NULL, &id), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_add(scene, &good, NULL), TRIBO_ERROR_NULL);
    uint32_t count = 9;
    assert_int_equal(tribo_scene_counts(scene, &count, NULL), TRIBO_OK);
    assert_int_equal(count, 0);
    tribo_scene_destroy(scene);
}

static void test_bad_settings(void **state)
{
    tribo_scene_settings settings = {.struct_size = sizeof settings};
    tribo_allocator allocator = {.struct_size = sizeof allocator};
    tribo_scene *scene = NULL;
    (void)state;
    assert_int_equal(tribo_scene_create(NULL, NULL, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_create(NULL, &allocator, &scene), TRIBO_ERROR_NULL);
    allocator.struct_size = 4;
    assert_int_equal(tribo_scene_create(NULL, &allocator, &scene), TRIBO_ERROR_STRUCT_SIZE);
    settings.friction_rule = 5;
    assert_int_equal(tribo_scene_create(&settings, NULL, &scene), TRIBO_ERROR_OPTION);
    settings.friction_rule = 0;
    settings.gravity[1] = NOT_A_NUMBER;
    assert_int_equal(tribo_scene_create(&settings, NULL, &scene), TRIBO_ERROR_NOT_FINITE);
    settings.struct_size = 1;
    assert_int_equal(tribo_scene_create(&settings, NULL, &scene), TRIBO_ERROR_STRUCT_SIZE);
    assert_null(scene);
    tribo_scene_destroy(NULL);
}

static void test_bad_steps(void **state)
{
    const stack s = make_stack(1, 1.0);
    const tribo_body before = state_of(s.scene, s.top);
    tribo_step_info info = {.struct_size = sizeof info};
    tribo_step_info kept;
    (void)state;
#define REFUSED(status, dt, change)                                                     \
    do {                                                                                \
        tribo_step_options bad = {.struct_size = sizeof bad};                           \
        change;                                                                         \
        ASSERT_REFUSED(info, kept, status, tribo_scene_step(s.scene, dt, &bad, &info)); \
    } while (0)
    REFUSED(TRIBO_ERROR_TIME_STEP, 0.0, (void)0);
    REFUSED(TRIBO_ERROR_TIME_STEP, -1.0, (void)0);
    REFUSED(TRIBO_ERROR_NOT_FINITE, NOT_A_NUMBER, (void)0);
    REFUSED(TRIBO_ERROR_NOT_FINITE, INFINITE, (void)0);
    REFUSED(TRIBO_ERROR_STRUCT_SIZE, 0.01, bad.struct_size = 0);
    REFUSED(TRIBO_ERROR_OPTION, 0.01, bad.solver = 3);
    REFUSED(TRIBO_ERROR_OPTION, 0.01, bad.skip = 16);
    REFUSED(TRIBO_ERROR_RANGE, 0.01, bad.tolerance = -1.0);
    REFUSED(TRIBO_ERROR_RANGE, 0.01, bad.correction = 1.5);
    REFUSED(TRIBO_ERROR_NOT_FINITE, 0.01, bad.margin = NOT_A_NUMBER);
    REFUSED(TRIBO_ERROR_RANGE, 0.01, bad.substeps = 0x100001u);
#undef REFUSED
    assert_int_equal(tribo_scene_step(NULL, 0.01, NULL, NULL), TRIBO_ERROR_NULL);
    info.struct_size = 0;
    assert_int_equal(tribo_scene_step(s.scene, 0.01, NULL, &info), TRIBO_ERROR_STRUCT_SIZE);
    const tribo_body after = state_of(s.scene, s.top);
    assert_memory_equal(&before, &after, sizeof before);
    tribo_scene_destroy(s.scene);
}

static void test_bad_ids(void **state)
{
    const stack s = make_stack(1, 1.0);
    const double bad[3] = {0.0, NOT_A_NUMBER, 0.0};
    tribo_body body = state_of(s.scene, s.top);
    tribo_totals totals;
    size_t count = 0;
    (void)state;
    assert_int_equal(tribo_scene_get_body(s.scene, 2, &body, NULL), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_scene_get_body(s.scene, 0, NULL, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_set_body(s.scene, 2, &body), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_scene_set_body(s.scene, 0, &body), TRIBO_ERROR_MASS);
    assert_int_equal(tribo_scene_set_body(s.scene, 0, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_remove(s.scene, 9), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_scene_remove(NULL, 0), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_set_force(s.scene, 0, NULL, NULL), TRIBO_ERROR_MASS);
    assert_int_equal(tribo_scene_set_force(s.scene, 7, NULL, NULL), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_scene_set_force(s.scene, 1, bad, NULL), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_scene_set_gravity(s.scene, bad), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_scene_set_gravity(s.scene, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_totals(s.scene, bad, &totals, NULL), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_scene_contacts(s.scene, 1, NULL, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_events(s.scene, 0, NULL, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_counts(NULL, NULL, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_load(s.scene, NULL, 0), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_save(s.scene, NULL, 8, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_body_init(NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_scene_remove(s.scene, 0), TRIBO_OK);
    assert_int_equal(tribo_scene_get_body(s.scene, 0, &body, NULL), TRIBO_ERROR_INDEX);
    tribo_scene_destroy(s.scene);
}

/* Memory that ends after so many pieces, and that counts those not given back. */
typedef struct purse {
    int left, held;
} purse;

static void *spend(void *user, size_t size)
{
    purse *p = user;
    if (p->left == 0) {
        return NULL;
    }
    p->left--;
    p->held++;
    return malloc(size);
}

static void refund(void *user, void *memory)
{
    ((purse *)user)->held--;
    free(memory);
}

static void test_memory_ends(void **state)
{
    int failed = 0;
    (void)state;
    for (int left = 0; left < 60; left++) {
        purse p = {left, 0};
        const tribo_allocator allocator = {sizeof allocator, 0, spend, refund, &p};
        const tribo_scene_settings settings = {.struct_size = sizeof settings,
                                               .gravity = {0.0, 0.0, -G}};
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, 0.5, 0.0);
        const tribo_scene_body ground = floor_of(0.5, 0.0);
        tribo_scene *scene = NULL;
        uint32_t id = 0;
        tribo_status status = tribo_scene_create(&settings, &allocator, &scene);
        if (status == TRIBO_OK) {
            status = tribo_scene_add(scene, &ground, &id);
        }
        box.state.position[2] = 0.5;
        if (status == TRIBO_OK) {
            status = tribo_scene_add(scene, &box, &id);
        }
        if (status == TRIBO_OK) {
            status = tribo_scene_step(scene, 0.01, NULL, NULL);
            const tribo_body body = state_of(scene, id);
            assert_true(status == TRIBO_OK || same_bits(body.position, box.state.position, 13));
        }
        assert_true(status == TRIBO_OK || status == TRIBO_ERROR_MEMORY);
        failed += status != TRIBO_OK;
        tribo_scene_destroy(scene);
        assert_int_equal(p.held, 0);
    }
    print_message("# %d of 60 amounts of memory were too little\n", failed);
    assert_in_range(failed, 10, 59);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_conveyor),
        TEST(test_box_on_a_slope),
        TEST(test_cradles),
        TEST(test_units_do_not_matter),
        TEST(test_stacks_rest),
        TEST(test_encounters_conserve),
        TEST(test_elastic_heap_keeps_energy),
        TEST(test_fast_ball_does_not_pass),
        TEST(test_floor_may_come_last),
        TEST(test_turning_floor),
        TEST(test_overlap_goes_without_speed),
        TEST(test_stages_that_are_not_needed),
        TEST(test_warm_start),
        TEST(test_rest_needs_no_solver),
        TEST(test_tower_comes_to_rest_by_few_sweeps),
        TEST(test_coarse_tolerances_do_not_creep),
        TEST(test_heavy_box_is_stopped_by_few_sweeps),
        TEST(test_events),
        TEST(test_contacts),
        TEST(test_saved_state_goes_on_to_the_bit),
        TEST(test_sleep),
        TEST(test_bad_bodies),
        TEST(test_bad_settings),
        TEST(test_bad_steps),
        TEST(test_bad_ids),
        TEST(test_memory_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
