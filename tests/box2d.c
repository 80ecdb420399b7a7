/* Box2D beside tribo: motion in a plane where both hold Coulomb's law with Newton's restitution,
 * and where Box2D does not.
 *
 * The plane is x, z here and x, y in Box2D; turning from x to z is turning by -y here. Box2D is in
 * single precision and sweeps over its contacts; 1e-5 of the velocities is what it is good for.
 * Its arms are those of its own contact points, which lie within its skin, not on the shapes. */
#include "check.h"

#ifdef TRIBO_HAVE_BOX2D

#include <stdlib.h>

#include <tribo/system.h>

#include "oracle/box2d.h"
#include "problems.h"
#include "worlds.h"

#define G 9.81
#define PI 3.14159265358979323846
#define SINGLE 1e-5

enum { ITERATIONS = 50, POINTS = 8 };

/* s, step of an impact: its contact points are told as of the end of the step. */
static const double instant = 1e-9;

/* ---- from plane to space and back ------------------------------------------------------------ */

/* Only the moment about y counts: the others are those of a ball. */
static tribo_body lift(const box2d_body *from)
{
    tribo_body body = body_of(from->mass, from->moment, from->moment, from->moment);
    const double turn[3] = {0.0, -from->angle, 0.0};
    assert_int_equal(tribo_quat_from_rotation_vector(turn, body.orientation), TRIBO_OK);
    body.position[0] = from->position[0];
    body.position[2] = from->position[1];
    body.velocity[0] = from->velocity[0];
    body.velocity[2] = from->velocity[1];
    body.angular_velocity[1] = -from->spin;
    return body;
}

static void lift_contact(const box2d_contact *from, double point[3], double normal[3])
{
    const double length = hypot(from->normal[0], from->normal[1]);
    point[0] = from->point[0];
    point[1] = 0.0;
    point[2] = from->point[1];
    normal[0] = from->normal[0] / length;
    normal[1] = 0.0;
    normal[2] = from->normal[1] / length;
}

static double difference(const box2d_world *world, int body, const tribo_body *want)
{
    double s[6];
    box2d_get(world, body, s);
    const double got[3] = {s[3], s[4], s[5]};
    const double wanted[3] = {want->velocity[0], want->velocity[2], -want->angular_velocity[1]};
    return distance(got, wanted, 3);
}

/* m/s, for bodies of about a metre. */
static double speed_of(const box2d_body *body)
{
    return hypot(body->velocity[0], body->velocity[1]) + fabs(body->spin);
}

/* As short as it may be: its corners are in single precision, and the contact points with them. */
static box2d_body ground_of(double half, double mu, double e)
{
    const box2d_body out = {.half = {half, 1.0}, .position = {0.0, -1.0}, .mu = mu, .e = e};
    return out;
}

static box2d_body disc_of(double mass, double radius, double mu, double e)
{
    const box2d_body out = {.half = {radius, 0.0},
                            .mass = mass,
                            .moment = 0.4 * mass * radius * radius,
                            .mu = mu,
                            .e = e};
    return out;
}

static box2d_body plate_of(double mass, double hx, double hy, double mu, double e)
{
    const box2d_body out = {.half = {hx, hy},
                            .mass = mass,
                            .moment = mass / 3.0 * (hx * hx + hy * hy),
                            .mu = mu,
                            .e = e};
    return out;
}

/* ---- impacts --------------------------------------------------------------------------------- */

/* Body 1 meets body 0, which may be static, at the one point where Box2D has it. Returns how much
 * farther apart the answers are than SINGLE of what is going on; -1 if they do not meet. */
static double judge(const box2d_body bodies[2], int iterations, tribo_collision_info *info)
{
    const tribo_impact_options options = {.struct_size = sizeof options, .law = TRIBO_LAW_COULOMB};
    const tribo_material pair = {bodies[1].mu, bodies[1].mu, bodies[1].e};
    box2d_world *world = box2d_create(0.0, 0.0);
    box2d_contact contacts[POINTS];
    double point[3];
    double normal[3];
    double error = -1.0;
    box2d_add(world, &bodies[0]);
    box2d_add(world, &bodies[1]);
    box2d_step(world, instant, iterations, 0);
    const int count = box2d_contacts(world, POINTS, contacts);
    const int is_fixed = !(bodies[0].mass > 0.0);
    memset(info, 0, sizeof *info);
    info->struct_size = sizeof *info;
    if (count == 1) {
        const int is_flipped = contacts[0].a == 1;
        tribo_body a = lift(&bodies[1]);
        tribo_body b = is_fixed ? a : lift(&bodies[0]);
        lift_contact(&contacts[0], point, normal);
        if (!is_flipped) {
            tribo_vec3_scale(-1.0, normal, normal);
        }
        assert_int_equal(
            tribo_collide(&a, is_fixed ? NULL : &b, point, normal, &pair, &options, info),
            TRIBO_OK);
        const double speed = speed_of(&bodies[0]) + speed_of(&bodies[1]);
        error = difference(world, 1, &a);
        error = is_fixed ? error : hypot(error, difference(world, 0, &b));
        error /= SINGLE * speed;
    }
    box2d_destroy(world);
    return error;
}

static double normal_coupling(const tribo_collision_info *info, double mu)
{
    return mu * hypot(info->matrix[1], info->matrix[2]) / info->matrix[0];
}

typedef struct tally {
    int open, stick, slip, turned;
} tally;

static void count_mode(const tribo_collision_info *info, tally *t)
{
    const double *before = info->velocity_before;
    const double *after = info->velocity_after;
    t->open += info->mode == TRIBO_MODE_OPEN;
    t->stick += info->mode == TRIBO_MODE_STICK;
    t->slip += info->mode == TRIBO_MODE_SLIP;
    t->turned += info->mode == TRIBO_MODE_SLIP && before[1] * after[1] + before[2] * after[2] < 0.0;
}

static void tell(const char *what, const tally *t)
{
    print_message("# %s: %d open, %d stick, %d slip, %d of them the other way\n", what, t->open,
                  t->stick, t->slip, t->turned);
    assert_true(t->stick > 0 && t->slip > 0);
}

static void draw_motion(problem_random *r, box2d_body *body)
{
    body->velocity[0] = problem_random_uniform(r, -3.0, 3.0);
    body->velocity[1] = problem_random_uniform(r, -3.0, -0.5);
    body->spin = problem_random_uniform(r, -3.0, 3.0);
    body->mu = problem_random_uniform(r, 0.0, 0.8);
    body->e = problem_random_uniform(r, 0.0, 1.0);
}

static void test_disc_impacts(void **state)
{
    tally t = {0};
    (void)state;
    for (uint64_t i = 0; i < problem_count(2000); i++) {
        problem_random r;
        tribo_collision_info info;
        problem_random_start(&r, 81, 1, i);
        const double radius = problem_random_uniform(&r, 0.2, 1.0);
        box2d_body bodies[2];
        bodies[1] = disc_of(problem_random_uniform(&r, 0.5, 2.0), radius, 0.0, 0.0);
        draw_motion(&r, &bodies[1]);
        bodies[0] = ground_of(2.0, bodies[1].mu, bodies[1].e);
        bodies[1].position[1] = radius;
        within(judge(bodies, ITERATIONS, &info), 1.0);
        count_mode(&info, &t);
    }
    tell("discs", &t);
    settle("discs");
}

/* On a corner of it. */
static void draw_box(uint64_t index, box2d_body bodies[2])
{
    problem_random r;
    problem_random_start(&r, 82, 1, index);
    const double hx = problem_random_uniform(&r, 0.3, 1.0);
    const double hy = problem_random_uniform(&r, 0.3, 1.0);
    bodies[1] = plate_of(problem_random_uniform(&r, 0.5, 2.0), hx, hy, 0.0, 0.0);
    bodies[1].angle = problem_random_uniform(&r, 0.1, 0.5 * PI - 0.1);
    draw_motion(&r, &bodies[1]);
    bodies[0] = ground_of(2.0, bodies[1].mu, bodies[1].e);
    bodies[1].position[1] = hx * sin(bodies[1].angle) + hy * cos(bodies[1].angle);
}

static void test_box_impacts(void **state)
{
    tally t = {0};
    (void)state;
    for (uint64_t i = 0; i < problem_count(2000); i++) {
        tribo_collision_info info;
        box2d_body bodies[2];
        draw_box(i, bodies);
        const double error = judge(bodies, ITERATIONS, &info);
        if (normal_coupling(&info, bodies[1].mu) < 0.5) {
            within(error, 1.0);
            count_mode(&info, &t);
        }
    }
    tell("boxes", &t);
    assert_true(t.turned > 0);
    settle("boxes");
}

/* Two discs in the air: the same velocities, and momentum to single precision. */
static void test_two_discs(void **state)
{
    tally t = {0};
    (void)state;
    for (uint64_t i = 0; i < problem_count(1000); i++) {
        problem_random r;
        tribo_collision_info info;
        double n[2];
        box2d_body bodies[2];
        problem_random_start(&r, 83, 1, i);
        problem_random_direction(&r, 2, n);
        for (int k = 0; k < 2; k++) {
            const double radius = problem_random_uniform(&r, 0.2, 1.0);
            bodies[k] = disc_of(problem_random_uniform(&r, 0.5, 2.0), radius, 0.0, 0.0);
            draw_motion(&r, &bodies[k]);
            for (int c = 0; c < 2; c++) {
                bodies[k].position[c] = (k == 0 ? -1.0 : 1.0) * (radius - 1e-4) * n[c];
                bodies[k].velocity[c] -= (k == 0 ? -2.0 : 2.0) * n[c];
            }
        }
        bodies[0].mu = bodies[1].mu;
        bodies[0].e = bodies[1].e;
        const double error = judge(bodies, ITERATIONS, &info);
        if (info.mode != TRIBO_MODE_OPEN) {
            within(error, 1.0);
            count_mode(&info, &t);
        }
    }
    tell("two discs", &t);
    settle("two discs");
}

/* A box lands flat on two corners, sliding and turning: tribo's system of the same two points. */
static void test_two_contacts(void **state)
{
    static double workspace[1 << 16];
    int slips = 0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(500); i++) {
        const tribo_system_options options = {.struct_size = sizeof options, .tolerance = 1e-13};
        tribo_system_contact rows[2];
        box2d_contact contacts[POINTS];
        double impulses[6];
        double velocity[6];
        problem_random r;
        problem_random_start(&r, 84, 1, i);
        const double hx = problem_random_uniform(&r, 0.3, 1.0);
        const double hy = problem_random_uniform(&r, 0.3, 1.0);
        box2d_body plate = plate_of(1.0, hx, hy, 0.0, 0.0);
        draw_motion(&r, &plate);
        plate.spin *= 0.3;
        plate.e = 0.0;
        plate.mu *= 0.5;
        plate.position[1] = hy;
        const box2d_body ground = ground_of(2.0, plate.mu, 0.0);
        box2d_world *world = box2d_create(0.0, 0.0);
        box2d_add(world, &ground);
        box2d_add(world, &plate);
        box2d_step(world, instant, 4 * ITERATIONS, 0);
        assert_int_equal(box2d_contacts(world, POINTS, contacts), 2);
        tribo_body body = lift(&plate);
        memset(rows, 0, sizeof rows);
        for (int k = 0; k < 2; k++) {
            double point[3];
            double normal[3];
            lift_contact(&contacts[k], point, normal);
            tribo_vec3_scale(contacts[k].a == 1 ? 1.0 : -1.0, normal, normal);
            assert_int_equal(tribo_contact_at(&body, NULL, point, normal, &rows[k].contact),
                             TRIBO_OK);
            rows[k].b = TRIBO_WORLD;
            rows[k].dimension = 3;
            rows[k].pair = (tribo_material){plate.mu, plate.mu, 0.0};
        }
        assert_int_equal(tribo_system_solve(1, &body, 2, rows, &options, workspace,
                                            sizeof workspace, impulses, velocity, NULL),
                         TRIBO_OK);
        assert_int_equal(tribo_system_apply(1, &body, velocity), TRIBO_OK);
        within(difference(world, 1, &body), SINGLE * speed_of(&plate));
        slips += fabs(body.velocity[0]) > 1e-3;
        box2d_destroy(world);
    }
    print_message("# %d slide on\n", slips);
    assert_true(slips > 0);
    settle("flat landings");
}

/* ---- scenes ---------------------------------------------------------------------------------- */

/* A body on the ground in both. */
typedef struct both {
    tribo_scene *scene;
    uint32_t id;
    box2d_world *world;
    int body;
} both;

static void make_both(double gx, double gy, const box2d_body *body, both *out)
{
    const double r = body->half[0];
    const box2d_body ground = ground_of(16.0, body->mu, body->e);
    tribo_scene_body lifted = body->half[1] > 0.0 ? box_of(1.0, r, 0.5, body->half[1], 0.0, 0.0)
                                                  : sphere_of(1.0, r, 0.0, 0.0);
    out->scene = make_scene(gx, gy, TRIBO_MIX_GEOMETRIC_MEAN);
    add_floor(out->scene, body->mu, body->e);
    lifted.material = (tribo_material){body->mu, body->mu, body->e};
    lifted.state = lift(body);
    out->id = add(out->scene, &lifted);
    out->world = box2d_create(gx, gy);
    box2d_add(out->world, &ground);
    out->body = box2d_add(out->world, body);
}

static void drop_both(both *b)
{
    tribo_scene_destroy(b->scene);
    box2d_destroy(b->world);
}

/* Both go on; returns the greatest difference of velocities on the way. */
static double run_both(both *b, double dt, int steps)
{
    double greatest = 0.0;
    for (int k = 0; k < steps; k++) {
        run(b->scene, dt, 1, NULL);
        box2d_step(b->world, dt, ITERATIONS, 4);
        const tribo_body state = state_of(b->scene, b->id);
        greatest = fmax(greatest, difference(b->world, b->body, &state));
    }
    return greatest;
}

/* Semi-implicit Euler of Box2D goes h v0 / 2 less. */
static void test_sliding_box_stops(void **state)
{
    const double h = 1.0 / 240.0;
    double s[6];
    (void)state;
    box2d_body plate = plate_of(1.0, 0.5, 0.125, 0.5, 0.0);
    plate.position[1] = 0.125;
    plate.velocity[0] = 3.0;
    both b;
    make_both(0.0, -G, &plate, &b);
    within(run_both(&b, h, 240), SINGLE * 3.0);
    box2d_get(b.world, b.body, s);
    within(fabs(state_of(b.scene, b.id).position[0] - s[0] - 0.5 * h * 3.0), SINGLE);
    within(fabs(s[3]), SINGLE);
    drop_both(&b);
    settle("box slides to rest");
}

static void test_incline(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double angle = atan(k == 0 ? 0.45 : 0.55);
        const double speed = k == 0 ? 0.0 : 2.0 * G * (sin(angle) - 0.5 * cos(angle));
        box2d_body plate = plate_of(1.0, 0.5, 0.125, 0.5, 0.0);
        plate.position[1] = 0.125;
        both b;
        make_both(G * sin(angle), -G * cos(angle), &plate, &b);
        within(run_both(&b, 1.0 / 240.0, 480), 1e-4);
        within(fabs(state_of(b.scene, b.id).velocity[0] - speed), 1e-10);
        drop_both(&b);
    }
    settle("slopes of 0.45 and 0.55");
}

static void test_stack_rests(void **state)
{
    enum { BOXES = 5 };
    const double h = 1.0 / 120.0;
    const box2d_body ground = ground_of(2.0, 0.5, 0.0);
    box2d_world *world = box2d_create(0.0, -G);
    tribo_scene *scene = make_scene(0.0, -G, TRIBO_MIX_MAXIMUM);
    uint32_t ids[BOXES];
    double carried[BOXES + 1] = {0.0};
    box2d_contact contacts[4 * BOXES];
    (void)state;
    add_floor(scene, 0.5, 0.0);
    box2d_add(world, &ground);
    for (int i = 0; i < BOXES; i++) {
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, 0.5, 0.0);
        box2d_body plate = plate_of(1.0, 0.5, 0.5, 0.5, 0.0);
        ids[i] = add_at(scene, &box, 0.0, 0.0, i + 0.5);
        plate.position[1] = i + 0.5;
        box2d_add(world, &plate);
    }
    for (int k = 0; k < 240; k++) {
        run(scene, h, 1, NULL);
        box2d_step(world, h, 4 * ITERATIONS, 4);
    }
    const int count = box2d_contacts(world, 4 * BOXES, contacts);
    for (int i = 0; i < count; i++) {
        carried[contacts[i].a < contacts[i].b ? contacts[i].b : contacts[i].a] +=
            contacts[i].normal_impulse;
    }
    for (int i = 0; i < BOXES; i++) {
        tribo_scene_event events[BOXES];
        size_t found = 0;
        const double weight = (BOXES - i) * G * h;
        const tribo_body end = state_of(scene, ids[i]);
        double s[6];
        box2d_get(world, i + 1, s);
        assert_int_equal(tribo_scene_events(scene, BOXES, events, &found), TRIBO_OK);
        assert_int_equal(found, BOXES);
        within(tribo_vec3_norm(end.velocity), 1e-10);
        within(fabs(end.position[2] - (i + 0.5)), 1e-9);
        within(fabs(events[i].normal - weight), 1e-9);
        /* Boxes stand on their skins, two slops thick each, and one slop inside of these. */
        within(hypot(s[0], s[1] - end.position[2] - (i + 1) * 3.0 * box2d_slop()),
               (i + 1) * 0.5 * box2d_slop());
        within(distance(s + 3, (const double[3]){0.0, 0.0, 0.0}, 3), 1e-4);
        within(fabs(carried[i + 1] - weight), SINGLE * weight);
    }
    tribo_scene_destroy(scene);
    box2d_destroy(world);
    settle("stack of five");
}

/* ---- where Box2D is not Coulomb's and Newton's law ------------------------------------------- */

/* Box2D has the contact of a body at rest half its slop inside: a disc rolls with that arm r, at
 * v = v0 r^2 / (r^2 + 2/5 R^2), less than 5/7 of v0. */
static void test_arm_is_short_by_half_the_slop(void **state)
{
    const double radius = 0.5;
    const double k2 = 0.4 * radius * radius;
    const double arm = radius - 0.5 * box2d_slop();
    const double rolling = 7.0 * arm * arm / (k2 + arm * arm);
    double s[6];
    (void)state;
    box2d_body disc = disc_of(1.0, radius, 0.2, 0.0);
    disc.position[0] = -8.0;
    disc.position[1] = radius;
    disc.velocity[0] = 7.0;
    both b;
    make_both(0.0, -G, &disc, &b);
    run_both(&b, 1e-2, 200);
    box2d_get(b.world, b.body, s);
    print_message("# rolls at: tribo %.9f, Box2D %.6f m/s; its arm gives %.6f\n",
                  state_of(b.scene, b.id).velocity[0], s[3], rolling);
    within(fabs(state_of(b.scene, b.id).velocity[0] - 5.0), 1e-12);
    within(fabs(s[3] - rolling), 0.2 * (5.0 - rolling));
    drop_both(&b);
    settle("5/7 of the speed");
}

/* Speed after a fall at `speed` on a floor of e = 0.8, within one step without gravity. */
static double bounce(double speed, double threshold)
{
    box2d_body bodies[2];
    double s[6];
    bodies[1] = disc_of(1.0, 0.5, 0.0, 0.8);
    bodies[0] = ground_of(2.0, 0.0, 0.8);
    bodies[0].threshold = bodies[1].threshold = threshold;
    bodies[1].position[1] = 0.5;
    bodies[1].velocity[1] = -speed;
    box2d_world *world = box2d_create(0.0, 0.0);
    box2d_add(world, &bodies[0]);
    box2d_add(world, &bodies[1]);
    box2d_step(world, instant, ITERATIONS, 0);
    box2d_get(world, 1, s);
    box2d_destroy(world);
    return s[4];
}

/* 1 m/s by default, and no restitution at all below it. */
static void test_threshold_of_restitution(void **state)
{
    static const double speeds[2] = {0.99, 1.01};
    (void)state;
    for (int k = 0; k < 2; k++) {
        tribo_scene *scene = make_scene(0.0, 0.0, TRIBO_MIX_MAXIMUM);
        tribo_scene_body ball = sphere_of(1.0, 0.5, 0.0, 0.8);
        add_floor(scene, 0.0, 0.8);
        ball.state.velocity[2] = -speeds[k];
        const uint32_t id = add_at(scene, &ball, 0.0, 0.0, 0.5);
        run(scene, instant, 1, NULL);
        within(fabs(state_of(scene, id).velocity[2] - 0.8 * speeds[k]), 1e-14);
        within(fabs(bounce(speeds[k], 1.0) - (k == 0 ? 0.0 : 0.8 * speeds[k])), 1e-6);
        within(fabs(bounce(speeds[k], 0.0) - 0.8 * speeds[k]), 1e-6);
        tribo_scene_destroy(scene);
    }
    settle("0.99 and 1.01 m/s");
}

/* v = -2 m/s, g h = 0.1 m/s, e = 0.5: Box2D's law sees the velocity after gravity has acted, and
 * gives 1.05 m/s; tribo's impact is at the midpoint, between half of gravity before and half of it
 * after. */
static void test_bounce_and_gravity(void **state)
{
    double s[6];
    (void)state;
    box2d_body disc = disc_of(1.0, 0.5, 0.0, 0.5);
    disc.position[1] = 0.5;
    disc.velocity[1] = -2.0;
    both b;
    make_both(0.0, -10.0, &disc, &b);
    tribo_body above = state_of(b.scene, b.id);
    above.position[2] += 0.01;
    assert_int_equal(tribo_scene_set_body(b.scene, b.id, &above), TRIBO_OK);
    run(b.scene, 0.01, 1, NULL);
    box2d_step(b.world, 0.01, ITERATIONS, 0);
    box2d_get(b.world, b.body, s);
    const double got = state_of(b.scene, b.id).velocity[2];
    print_message("# tribo %.9f, Box2D %.6f m/s\n", got, s[4]);
    within(fabs(got - (0.5 * 2.05 - 0.05)), 1e-14);
    within(fabs(s[4] - 1.05), 1e-6);
    drop_both(&b);
    settle("bounce");
}

/* One sweep bounds friction by the normal impulse of none: it solves friction first. */
static void test_one_iteration_is_not_enough(void **state)
{
    double greatest = 0.0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(200); i++) {
        tribo_collision_info info;
        box2d_body bodies[2];
        draw_box(i, bodies);
        greatest = fmax(greatest, judge(bodies, 1, &info));
    }
    print_message("# one iteration: off by up to %.3g of the speed\n", greatest * SINGLE);
    assert_true(greatest * SINGLE > 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_disc_impacts),
        TEST(test_box_impacts),
        TEST(test_two_discs),
        TEST(test_two_contacts),
        TEST(test_sliding_box_stops),
        TEST(test_incline),
        TEST(test_stack_rests),
        TEST(test_arm_is_short_by_half_the_slop),
        TEST(test_threshold_of_restitution),
        TEST(test_bounce_and_gravity),
        TEST(test_one_iteration_is_not_enough),
    };
    return cmocka_run_group_tests_name("box2d", tests, NULL, NULL);
}

#else

static void test_box2d(void **state)
{
    (void)state;
    print_message("# Box2D 2.4 or a C++ compiler is not installed (Debian: libbox2d-dev, g++)\n");
    skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {TEST(test_box2d)};
    return cmocka_run_group_tests_name("box2d", tests, NULL, NULL);
}

#endif
