/* Only what the scene needs: bodies of all shapes carry their weight and no more, stages that a
 * scene has no use for do not run, and what is switched off changes no bit, nor do threads. */
#include <stdlib.h>

#include "pool.h"
#include "problems.h"
#include "worlds.h"

#define G 9.81

/* ---- weight ---------------------------------------------------------------------------------- */

enum { WORDS = 1024, EVENTS = 8 };

/* A body that stands, its lowest points at z = 0, and what its shape points to. */
typedef struct standing {
    const char *name;
    tribo_scene_body body;
    tribo_shape solid; /* of a user's shape */
    tribo_convex convex;
    tribo_child children[2];
    uint64_t block[WORDS];
} standing;

static const double quarter_y[4] = {0.70710678118654752, 0.0, 0.70710678118654752, 0.0};

static void support(const void *user, const double direction[3], double point[3])
{
    tribo_shape_support(user, direction, point);
}

static uint32_t face(const void *user, const double direction[3], uint32_t capacity, double *points)
{
    double normal[3];
    uint32_t count = 0;
    return tribo_shape_face(user, direction, capacity, points, &count, normal) == TRIBO_OK ? count
                                                                                           : 0;
}

static void set_solid(standing *s, uint32_t type, double x, double y, double z)
{
    s->body.shape.type = type;
    s->body.shape.size[0] = x;
    s->body.shape.size[1] = y;
    s->body.shape.size[2] = z;
}

static void set_hull(standing *s)
{
    static const double corners[12] = {1.0,  0.0,  0.0, -0.5, 0.8, 0.0,
                                       -0.5, -0.8, 0.0, 0.0,  0.0, 1.0};
    set_solid(s, TRIBO_SHAPE_HULL, 0.0, 0.0, 0.0);
    assert_int_equal(tribo_hull_build(4, corners, s->block, sizeof s->block, NULL), TRIBO_OK);
    s->body.shape.data = s->block;
}

static void set_user(standing *s)
{
    set_solid(s, TRIBO_SHAPE_BOX, 0.3, 0.4, 0.5);
    s->solid = s->body.shape;
    s->convex.struct_size = sizeof s->convex;
    s->convex.support = support;
    s->convex.face = face;
    s->convex.user = &s->solid;
    s->convex.radius = 1.0;
}

/* A box and a cylinder, apart. */
static void set_compound(standing *s)
{
    for (int i = 0; i < 2; i++) {
        s->children[i].shape.type = i == 0 ? TRIBO_SHAPE_BOX : TRIBO_SHAPE_CYLINDER;
        s->children[i].shape.size[0] = s->children[i].shape.size[1] = 0.25;
        s->children[i].shape.size[2] = 0.25;
        s->children[i].pose.position[0] = i == 0 ? -0.75 : 0.75;
        s->children[i].pose.orientation[0] = 1.0;
    }
    set_solid(s, TRIBO_SHAPE_COMPOUND, 0.0, 0.0, 0.0);
    s->body.shape.data = s->children;
    s->body.shape.count = 2;
}

static void choose_shape(int kind, standing *s)
{
    switch (kind) {
    case 0:
        s->name = "sphere";
        set_solid(s, TRIBO_SHAPE_SPHERE, 0.5, 0.0, 0.0);
        break;
    case 1:
        s->name = "box";
        set_solid(s, TRIBO_SHAPE_BOX, 0.3, 0.4, 0.5);
        break;
    case 2:
        s->name = "capsule";
        set_solid(s, TRIBO_SHAPE_CAPSULE, 0.25, 0.5, 0.0);
        memcpy(s->body.state.orientation, quarter_y, sizeof quarter_y);
        break;
    case 3:
        s->name = "cylinder";
        set_solid(s, TRIBO_SHAPE_CYLINDER, 0.4, 0.3, 0.0);
        break;
    case 4:
        s->name = "cone";
        set_solid(s, TRIBO_SHAPE_CONE, 0.5, 0.4, 0.0);
        break;
    case 5:
        s->name = "ellipsoid";
        set_solid(s, TRIBO_SHAPE_ELLIPSOID, 0.5, 0.5, 0.25);
        break;
    case 6:
        s->name = "hull";
        set_hull(s);
        break;
    case 7:
        s->name = "user's shape";
        set_user(s);
        break;
    default:
        s->name = "compound";
        set_compound(s);
        break;
    }
}

static void make_standing(int kind, standing *s)
{
    double mass = 0.0;
    double center[3];
    double inertia[9];
    double low[3];
    double high[3];
    tribo_pose pose = {.orientation = {1.0, 0.0, 0.0, 0.0}};
    memset(s, 0, sizeof *s);
    tribo_scene_body_init(&s->body);
    s->body.material = (tribo_material){0.5, 0.5, 0.0};
    choose_shape(kind, s);
    assert_int_equal(tribo_shape_mass(&s->body.shape, 2.0, &mass, center, inertia), TRIBO_OK);
    assert_int_equal(tribo_body_set_mass(&s->body.state, mass, inertia), TRIBO_OK);
    if (s->convex.support != NULL) {
        s->body.shape.type = TRIBO_SHAPE_CONVEX;
        s->body.shape.data = &s->convex;
    }
    tribo_vec3_scale(-1.0, center, s->body.offset.position);
    tribo_quat_rotate(s->body.state.orientation, s->body.offset.position, pose.position);
    memcpy(pose.orientation, s->body.state.orientation, sizeof pose.orientation);
    assert_int_equal(tribo_shape_bounds(&s->body.shape, &pose, low, high), TRIBO_OK);
    s->body.state.position[2] = -low[2];
}

/* Grounds whose surface is z = 0. */
static void add_ground(tribo_scene *scene, int kind, uint64_t *block)
{
    static const double corners[12] = {-5.0, -5.0, 0.0, 5.0,  -5.0, 0.0,
                                       5.0,  5.0,  0.0, -5.0, 5.0,  0.0};
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    tribo_scene_body ground = floor_of(0.5, 0.0);
    if (kind == 1) {
        ground.shape.type = TRIBO_SHAPE_BOX;
        ground.shape.size[0] = ground.shape.size[1] = 5.0;
        ground.shape.size[2] = 1.0;
        ground.state.position[2] = -1.0;
    } else if (kind == 2) {
        assert_int_equal(
            tribo_mesh_build(4, corners, 2, triangles, block, WORDS * sizeof *block, NULL),
            TRIBO_OK);
        ground.shape.type = TRIBO_SHAPE_MESH;
        ground.shape.data = block;
    }
    add(scene, &ground);
}

/* The impulses of events sum up to m g dt, upwards, in every step. */
static void test_all_shapes_carry_their_weight(void **state)
{
    static const char *const grounds[3] = {"half-space", "box", "mesh"};
    static standing s;
    static uint64_t block[WORDS];
    const double dt = 0.01;
    (void)state;
    for (int kind = 0; kind < 9; kind++) {
        for (int ground = 0; ground < 3; ground++) {
            tribo_scene *scene = make_scene(0.0, -G, 0);
            add_ground(scene, ground, block);
            make_standing(kind, &s);
            const uint32_t id = add(scene, &s.body);
            const double weight = G * dt / s.body.state.inverse_mass;
            run(scene, dt, 50, NULL);
            for (int i = 0; i < 50; i++) {
                tribo_scene_event events[EVENTS];
                size_t count = 0;
                run(scene, dt, 1, NULL);
                assert_int_equal(tribo_scene_events(scene, EVENTS, events, &count), TRIBO_OK);
                assert_int_equal(count, 1);
                assert_int_equal(events[0].kind, TRIBO_EVENT_PERSIST);
                assert_int_equal(events[0].b, id);
                /* On A, the ground. */
                within(hypot(events[0].impulse[0], events[0].impulse[1]), 1e-9 * weight);
                within(fabs(events[0].impulse[2] + weight), 1e-9 * weight);
                within(fabs(events[0].normal - weight), 1e-9 * weight);
            }
            within(tribo_vec3_norm(state_of(scene, id).velocity), 1e-9);
            print_message("# %s on a %s: ", s.name, grounds[ground]);
            settle("weight");
            tribo_scene_destroy(scene);
        }
    }
}

/* ---- stages ---------------------------------------------------------------------------------- */

/* Four bodies side by side on a floor, or above it. */
static tribo_scene *make_row(uint32_t type, double mu, double e, double height, double fall)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    add_floor(scene, mu, e);
    for (int i = 0; i < 4; i++) {
        tribo_scene_body body = type == TRIBO_SHAPE_SPHERE ? sphere_of(1.0, 0.5, mu, e)
                                                           : box_of(1.0, 0.5, 0.5, 0.5, mu, e);
        body.state.velocity[2] = -fall;
        add_at(scene, &body, 3.0 * i, 0.0, 0.5 + height);
    }
    return scene;
}

static void test_nothing_is_nothing(void **state)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    (void)state;
    add_floor(scene, 0.5, 0.5);
    tribo_step_info info = run(scene, 0.01, 3, NULL);
    info.substeps = 0;
    const tribo_step_info none = {0};
    assert_memory_equal(&info, &none, sizeof info);
    tribo_scene_destroy(scene);
}

static void test_frictionless_contacts_have_one_row(void **state)
{
    (void)state;
    for (uint32_t type = TRIBO_SHAPE_SPHERE; type <= TRIBO_SHAPE_BOX; type++) {
        tribo_scene *scene = make_row(type, 0.0, 0.0, 0.0, 0.0);
        const tribo_step_info info = run(scene, 0.01, 20, NULL);
        assert_true(info.contacts > 0);
        assert_int_equal(info.frictionless, info.contacts);
        assert_true(type != TRIBO_SHAPE_SPHERE || info.turns == 0);
        assert_int_equal(info.impact_solves + info.impacts + info.correction_solves, 0);
        tribo_scene_destroy(scene);
        scene = make_row(type, 0.5, 0.0, 0.0, 0.0);
        assert_int_equal(run(scene, 0.01, 20, NULL).frictionless, 0);
        tribo_scene_destroy(scene);
    }
}

static void test_impacts_need_restitution(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        tribo_scene *scene = make_row(TRIBO_SHAPE_BOX, 0.5, k == 0 ? 0.0 : 0.5, 0.05, 5.0);
        const tribo_step_info info = run(scene, 0.01, 3, NULL);
        assert_int_equal(info.impact_solves > 0, k);
        assert_int_equal(info.impacts > 0, k);
        assert_int_equal(info.correction_solves, 0);
        tribo_scene_destroy(scene);
    }
}

static void test_flying_bodies_meet_nothing(void **state)
{
    tribo_scene *scene = make_row(TRIBO_SHAPE_SPHERE, 0.5, 0.5, 10.0, 0.0);
    (void)state;
    const tribo_step_info info = run(scene, 0.01, 10, NULL);
    assert_int_equal(info.contacts + info.contact_solves + info.impact_solves + info.sweeps +
                         info.newton_steps + info.factorizations + info.correction_solves,
                     0);
    assert_int_equal(info.turns, 0);
    tribo_scene_destroy(scene);
}

static void test_overlap_alone_is_corrected(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        tribo_scene *scene = make_row(TRIBO_SHAPE_BOX, 0.5, 0.0, k == 0 ? 0.0 : -0.01, 0.0);
        const tribo_step_info info = run(scene, 0.01, 5, NULL);
        assert_int_equal(info.correction_solves > 0, k);
        tribo_scene_destroy(scene);
    }
}

static void test_sleep_costs_nothing(void **state)
{
    const tribo_step_options options = {
        .struct_size = sizeof options, .sleep_time = 0.1, .sleep_speed = 0.01};
    tribo_scene *scene = make_row(TRIBO_SHAPE_BOX, 0.5, 0.0, 0.0, 0.0);
    (void)state;
    run(scene, 0.01, 50, &options);
    const tribo_step_info info = run(scene, 0.01, 10, &options);
    assert_int_equal(info.asleep, 4);
    assert_int_equal(info.flights + info.turns + info.pairs + info.contacts + info.contact_solves +
                         info.impact_solves + info.correction_solves + info.sweeps +
                         info.newton_steps + info.factorizations,
                     0);
    tribo_scene_destroy(scene);
}

/* ---- bits ------------------------------------------------------------------------------------ */

/* The same bodies, to the bit, after n steps of each. */
static void assert_same_motion(tribo_scene *a, const tribo_step_options *a_options, tribo_scene *b,
                               const tribo_step_options *b_options, int steps)
{
    uint32_t end = 0;
    run(a, 0.01, steps, a_options);
    run(b, 0.01, steps, b_options);
    assert_int_equal(tribo_scene_counts(a, NULL, &end), TRIBO_OK);
    for (uint32_t i = 0; i < end; i++) {
        const tribo_body x = state_of(a, i);
        const tribo_body y = state_of(b, i);
        assert_memory_equal(&x, &y, sizeof x);
    }
    tribo_scene_destroy(a);
    tribo_scene_destroy(b);
}

static const tribo_step_options plain = {.struct_size = sizeof plain};

static void test_what_is_off_changes_no_bit(void **state)
{
    const uint32_t box = TRIBO_SHAPE_BOX;
    tribo_step_options other = plain;
    (void)state;
    other.skip = TRIBO_SKIP_RESTITUTION;
    assert_same_motion(make_row(box, 0.5, 0.0, 0.05, 5.0), &plain,
                       make_row(box, 0.5, 0.0, 0.05, 5.0), &other, 30);
    assert_same_motion(make_row(box, 0.5, 0.0, 0.05, 5.0), &plain,
                       make_row(box, 0.5, 0.7, 0.05, 5.0), &other, 30);
    other.skip = TRIBO_SKIP_CORRECTION;
    assert_same_motion(make_row(box, 0.5, 0.5, 0.05, 5.0), &plain,
                       make_row(box, 0.5, 0.5, 0.05, 5.0), &other, 30);
    other.skip = 0;
    other.sleep_time = 1.0;
    other.sleep_speed = 0.1;
    assert_same_motion(make_row(box, 0.5, 0.5, 0.05, 5.0), &plain,
                       make_row(box, 0.5, 0.5, 0.05, 5.0), &other, 30);
}

static tribo_scene *with_ignored(int what)
{
    tribo_scene *scene = make_scene(0.0, -G, 0);
    tribo_scene_body ground = floor_of(0.0, 0.0);
    tribo_scene_body box = box_of(1.0, 0.5, 0.4, 0.3, 0.0, 0.0);
    tribo_scene_body ghost = box;
    ground.belt[0] = what == 1 ? 3.0 : 0.0;
    add(scene, &ground);
    box.state.velocity[0] = 1.0;
    const uint32_t id = add_at(scene, &box, 0.0, 0.0, 0.4);
    ghost.shape.type = 0;
    ghost.state.velocity[0] = what == 2 ? 1.0 : 0.0;
    add_at(scene, &ghost, 0.0, 0.0, 100.0);
    if (what == 3) {
        assert_int_equal(tribo_scene_set_force(scene, id, NULL, NULL), TRIBO_OK);
    }
    return scene;
}

/* A belt without friction, forces of nothing, a body without shape. */
static void test_what_has_no_effect_changes_no_bit(void **state)
{
    (void)state;
    assert_same_motion(with_ignored(0), &plain, with_ignored(1), &plain, 30);
    assert_same_motion(with_ignored(0), &plain, with_ignored(3), &plain, 30);
    tribo_scene *a = with_ignored(0);
    tribo_scene *b = with_ignored(2);
    run(a, 0.01, 30, NULL);
    run(b, 0.01, 30, NULL);
    const tribo_body x = state_of(a, 1);
    const tribo_body y = state_of(b, 1);
    assert_memory_equal(&x, &y, sizeof x);
    tribo_scene_destroy(a);
    tribo_scene_destroy(b);
}

/* So wide that a colour of contacts is worth some tasks. */
static tribo_scene *make_field(double e)
{
    enum { SIDE = 18 };
    tribo_scene *scene = make_scene(0.0, -G, 0);
    problem_random r;
    problem_random_start(&r, 91, 1, 0);
    add_floor(scene, 0.5, e);
    for (int i = 0; i < SIDE * SIDE; i++) {
        tribo_scene_body box = box_of(1.0, 0.5, 0.5, 0.5, 0.5, e);
        box.state.velocity[0] = problem_random_normal(&r);
        box.state.velocity[1] = problem_random_normal(&r);
        add_at(scene, &box, 1.02 * (i % SIDE), 1.02 * (i / SIDE), 0.5);
    }
    return scene;
}

static void test_threads_change_no_bit(void **state)
{
    pool *threads = pool_create(3);
    (void)state;
    assert_non_null(threads);
    for (uint32_t tasks = 2; tasks <= 4; tasks += 2) {
        for (int k = 0; k < 2; k++) {
            tribo_step_options serial = plain;
            serial.solver = k == 0 ? TRIBO_SOLVER_GAUSS_SEIDEL : TRIBO_SOLVER_AUTO;
            serial.max_iterations = 10;
            tribo_step_options parallel = serial;
            parallel.tasks = tasks;
            parallel.parallel = pool_run;
            parallel.user = threads;
            const uint64_t calls = pool_calls(threads);
            const double e = k == 0 ? 0.5 : 0.0;
            assert_same_motion(make_field(e), &serial, make_field(e), &parallel, 4);
            print_message("# %d tasks: %d calls of the pool\n", (int)tasks,
                          (int)(pool_calls(threads) - calls));
            assert_true(pool_calls(threads) > calls);
        }
    }
    pool_destroy(threads);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_all_shapes_carry_their_weight),
        TEST(test_nothing_is_nothing),
        TEST(test_frictionless_contacts_have_one_row),
        TEST(test_impacts_need_restitution),
        TEST(test_flying_bodies_meet_nothing),
        TEST(test_overlap_alone_is_corrected),
        TEST(test_sleep_costs_nothing),
        TEST(test_what_is_off_changes_no_bit),
        TEST(test_what_has_no_effect_changes_no_bit),
        TEST(test_threads_change_no_bit),
    };
    return cmocka_run_group_tests_name("scene_needs", tests, NULL, NULL);
}
