/* Scenes of `tribo scene`, all of them, against what is exact; orders of convergence. */
#include "cli/scene.h"

#include "check.h"

enum { MOST_SCENES = 200 };

/* Under sanitizers a second of motion may take a minute. */
static void test_scene(void **state)
{
    const scene_entry *entry = *state;
    world w = scene_world(entry);
    scene_answer answer;
    w.seconds = entry->test_seconds > 0.0 ? entry->test_seconds : w.seconds;
    assert_int_equal(scene_play(entry, &w, &answer), TRIBO_OK);
    print_message("# %s: metric %.10g, exact %.10g, error %.3g, %.1f us per step\n", entry->name,
                  answer.metric, answer.exact, answer.error, 1e6 * w.spent / (double)w.steps);
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

int main(void)
{
    static struct CMUnitTest tests[MOST_SCENES + 1];
    size_t count = 0;
    tests[count++] = (struct CMUnitTest)TEST(test_names_are_unique);
    for (size_t group = 0; group < SCENE_GROUPS; group++) {
        for (size_t i = 0; i < scene_groups[group]->count && count <= MOST_SCENES; i++) {
            const scene_entry *entry = &scene_groups[group]->entries[i];
            tests[count++] =
                (struct CMUnitTest){entry->name, test_scene, NULL, NULL, (void *)(uintptr_t)entry};
        }
    }
    return _cmocka_run_group_tests("scenes", tests, count, NULL, NULL);
}
