/* Scenes of `tribo scene`, all of them, against what is exact; orders of convergence. */
#include "cli/scene.h"

#include "check.h"
#include "problems.h"

enum { MOST_SCENES = 200 };

/* These take more than half a second each. */
static const char *const LONG[] = {
    "b7-overhang-31",       "b7-capstan-100",      "b8-arch-27",         "b8-arch-friction-12",
    "b8-arch-friction-15",  "b8-arch-friction-20", "b9-card-house",      "b10-pyramid-300",
    "b10-pyramid-300-drop", "b10-wall-91",         "b16-domino",         "b16-dominoes",
    "b15-top-slow",         "b15-top-sleeping",    "b11-disc-01",        "b11-disc-03",
    "b3-disc-108",          "d1-rolling-y",        "d1-rolling-overlap", "d3-666",
};

static int is_left_out(const char *name)
{
    for (size_t i = 0; i < sizeof LONG / sizeof LONG[0]; i++) {
        if (strcmp(LONG[i], name) == 0) {
            return problem_count(20) < 20;
        }
    }
    return 0;
}

static void test_scene(void **state)
{
    const scene_entry *entry = *state;
    if (is_left_out(entry->name)) {
        print_message("# takes too long with fewer optimisations\n");
        skip();
    }
    world w = scene_world(entry);
    scene_answer answer;
    w.seconds = entry->test_seconds > 0.0 ? entry->test_seconds : w.seconds;
    assert_int_equal(scene_play(entry, &w, &answer), TRIBO_OK);
    print_message("# %s: metric %.10g, exact %.10g, error %.3g; %d steps in %.3f s\n", entry->name,
                  answer.metric, answer.exact, answer.error, (int)w.steps, w.spent);
    worst = 0.0;
    within(answer.error, scene_tolerance(entry, &w));
    settle(entry->name);
}

static void test_names_are_unique(void **state)
{
    (void)state;
    for (size_t group = 0; group < SCENE_GROUPS; group++) {
        for (size_t i = 0; i < scene_groups[group]->count; i++) {
            const scene_entry *entry = &scene_groups[group]->entries[i];
            assert_ptr_equal(scene_find(entry->name), entry);
            assert_true(entry->what && entry->metric && entry->reason);
            assert_true(entry->dt > 0.0 && entry->seconds > 0.0 && entry->tolerance >= 0.0);
        }
    }
    assert_null(scene_find("a6-cradle-"));
}

/* ---- more of some scenes --------------------------------------------------------------------- */

/* The error of a scene at a step, for so many seconds where they are not its own. */
static scene_answer play(const char *name, double dt, double seconds, world *w)
{
    const scene_entry *entry = scene_find(name);
    scene_answer answer;
    assert_non_null(entry);
    *w = scene_world(entry);
    w->dt = dt;
    w->seconds = seconds > 0.0 ? seconds : w->seconds;
    assert_int_equal(scene_play(entry, w, &answer), TRIBO_OK);
    print_message("# %s, step %g s: error %.3g\n", name, dt, answer.error);
    within(answer.error, scene_tolerance(entry, w));
    return answer;
}

/* Ten times the step, ten times the error. */
static void test_first_order(void **state)
{
    static const char *const names[4] = {"b1-incline", "b1-incline-way", "b3-tripod",
                                         "b5-turntable"};
    (void)state;
    for (int k = 0; k < 4; k++) {
        world w;
        double errors[3];
        for (int i = 0; i < 3; i++) {
            errors[i] = play(names[k], pow(10.0, -2 - i), 0.0, &w).error;
        }
        const double orders[2] = {log10(errors[0] / errors[1]), log10(errors[1] / errors[2])};
        print_message("# %s: orders %.3f, %.3f\n", names[k], orders[0], orders[1]);
        within(fabs(orders[0] - 1.0), 0.05);
        within(fabs(orders[1] - 1.0), 0.05);
    }
    settle("orders of convergence");
}

/* Rolling discs and tops on a point: half of the step, half of the error. */
static void test_spin_is_of_first_order(void **state)
{
    static const char *const names[3] = {"b11-disc-03", "b15-top-slow", "b15-top-sleeping"};
    static const double seconds[3] = {0.5, 2.0, 2.0};
    (void)state;
    for (int k = 0; k < 3; k++) {
        world w;
        const double coarse = play(names[k], 5e-4, seconds[k], &w).error;
        const double fine = play(names[k], 2.5e-4, seconds[k], &w).error;
        print_message("# %s: order %.3f\n", names[k], log2(coarse / fine));
        within(fabs(log2(coarse / fine) - 1.0), 0.2);
    }
    settle("orders of spinning bodies");
}

/* Free bodies turn to rounding at any step. */
static void test_flip_at_any_step(void **state)
{
    static const double steps[4] = {0.5, 0.1, 1.0 / 64.0, 1e-3};
    (void)state;
    for (int k = 0; k < 4; k++) {
        world w;
        play("b14-flip", steps[k], 5.0, &w);
    }
    settle("a free box");
}

/* What is exact is so at any step. */
static void test_exact_at_any_step(void **state)
{
    static const char *const names[9] = {"b2-roll",     "b2-roll-back",     "b4-rolling",
                                         "b4-spinning", "b4-spinning-stop", "b4-limit",
                                         "d2-bouncing", "d2-euler-before",  "d2-euler-after"};
    static const double steps[3] = {1e-3, 1.0 / 64.0, 0.1};
    (void)state;
    for (int k = 0; k < 9; k++) {
        for (int i = 0; i < 3; i++) {
            world w;
            if (k < 7 || i != 1) { /* figures are published at powers of ten */
                play(names[k], steps[i], k == 6 ? 4.0 : 0.0, &w);
            }
        }
    }
    settle("exact scenes");
}

/* An impact without collision: the impulse stays as the step goes to nothing. */
static void test_painleve_at_any_step(void **state)
{
    (void)state;
    for (int i = 2; i <= 5; i++) {
        world w;
        const scene_answer answer = play("b6-painleve", pow(10.0, -i), 0.1, &w);
        within(answer.metric, 1.0);
    }
    settle("Painleve's rod");
}

/* Feet that are nine times as many: the error of the disc falls so, but for their places. */
static void test_sampled_disc_converges(void **state)
{
    world w;
    (void)state;
    const double few = play("b3-disc-12", 1e-3, 0.0, &w).error;
    const double many = play("b3-disc-108", 1e-3, 0.0, &w).error;
    assert_true(few / many > 4.5);
}

/* A bounce ends after a number of impacts that the threshold bounds: e^n v = g h, but for the few
 * last ones, which gravity has a part in. */
static void test_bounces_end(void **state)
{
    (void)state;
    for (int i = 2; i <= 4; i++) {
        const double dt = pow(10.0, -i);
        const double most = log(sqrt(2.0 / WORLD_G) / dt) / log(2.0) + 4.0;
        world w;
        play("a8-bounce", dt, 0.0, &w);
        print_message("# %d impacts, at most %.1f\n", (int)w.impacts, most);
        assert_in_range(w.impacts, 2, (uint64_t)most);
    }
    settle("bounces");
}

/* Overlaps of nothing and energy that does not come up, also in steps in which balls pass several
 * of their sizes. */
static void test_heaps_in_long_steps(void **state)
{
    world w;
    (void)state;
    play("d3-666", 0.1, 2.0, &w);
    settle("666");
    const scene_answer elastic = play("d3-666-elastic", 0.1, 2.0, &w);
    worst = 0.0;
    within(elastic.error, 1e6); /* the best published is 1.88e7 */
    settle("elastic 666");
}

/* A tower that rests goes on from its impulses: Gauss-Seidel has at most one sweep to do. */
static void test_towers_rest_from_warm_starts(void **state)
{
    static const char *const names[3] = {"c3-tower-1", "c3-tower-2", "c3-tower-10"};
    (void)state;
    for (int k = 0; k < 3; k++) {
        world w;
        play(names[k], 1.0 / 60.0, 1.0, &w);
        print_message("# %s: %d sweeps and %d Newton steps in the last of %d steps\n", names[k],
                      (int)w.last.sweeps, (int)w.last.newton_steps, (int)w.steps);
        assert_in_range(w.last.sweeps, 0, 8);
        assert_int_equal(w.last.newton_steps, 0);
    }
    settle("towers");
}

/* Walls and card houses ask for less than rounding leaves: Newton ends there, and does not go on for
 * the 1000 steps that a solve may take. */
static void test_newton_ends_at_rounding(void **state)
{
    static const char *const names[2] = {"b10-wall-91", "b9-card-house"};
    (void)state;
    for (int k = 0; k < 2; k++) {
        world w;
        const scene_answer answer = play(names[k], 1.0 / 60.0, 1.0, &w);
        print_message("# %s: %d Newton steps in %d steps, stopped by %d\n", names[k], (int)w.newton,
                      (int)w.steps, (int)w.stop);
        assert_in_range(w.newton, 0, 600);
        within(answer.error, 1e-9);
    }
    settle("walls and card houses");
}

int main(void)
{
    static const struct CMUnitTest more[] = {
        TEST(test_names_are_unique),        TEST(test_first_order),
        TEST(test_spin_is_of_first_order),  TEST(test_flip_at_any_step),
        TEST(test_exact_at_any_step),       TEST(test_painleve_at_any_step),
        TEST(test_sampled_disc_converges),  TEST(test_bounces_end),
        TEST(test_heaps_in_long_steps),     TEST(test_towers_rest_from_warm_starts),
        TEST(test_newton_ends_at_rounding),
    };
    static struct CMUnitTest tests[MOST_SCENES];
    const size_t stride = problem_count(20) < 20 ? 8 : 1; /* under a sanitizer one in eight */
    size_t count = 0;
    size_t seen = 0;
    for (; count < sizeof more / sizeof more[0]; count++) {
        tests[count] = more[count];
    }
    for (size_t group = 0; group < SCENE_GROUPS; group++) {
        for (size_t i = 0; i < scene_groups[group]->count && count < MOST_SCENES; i++) {
            const scene_entry *entry = &scene_groups[group]->entries[i];
            if (seen++ % stride == 0) {
                tests[count++] = (struct CMUnitTest){entry->name, test_scene, NULL, NULL,
                                                     (void *)(uintptr_t)entry};
            }
        }
    }
    return _cmocka_run_group_tests("scenes", tests, count, NULL, NULL);
}
