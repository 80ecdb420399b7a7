/* Coefficients of friction and restitution: judging, mixing, the lecture's table. */
#include <tribo/material.h>

#include "check.h"
#include "problems.h"

enum { RULES = 5 };

/* Outputs of refused calls; filled with a pattern that no result has. */
static struct {
    tribo_material material;
    const char *name;
} out, before;

/* A refused call gives the status and leaves `out` as it was. */
#define REFUSED(expected, call) ASSERT_REFUSED_AFRESH(out, before, expected, call)

static tribo_material material(double mu_s, double mu_d, double e)
{
    const tribo_material m = {mu_s, mu_d, e};
    return m;
}

static void test_check_accepts(void **state)
{
    static const tribo_material good[] = {
        {0.0, 0.0, 0.0},   {0.0, 0.0, 1.0},       {0.7, 0.3, 0.0},  {0.5, 0.5, 0.5},
        {1e300, 0.0, 1.0}, {DBL_MAX, DBL_MAX, 1}, {5e-324, 0, 0.0}, {-0.0, -0.0, -0.0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_int_equal(tribo_material_check(&good[i]), TRIBO_OK);
    }
}

static const struct {
    tribo_material material;
    tribo_status status;
} bad_materials[] = {
    {{NOT_A_NUMBER, 0.3, 0.5}, TRIBO_ERROR_NOT_FINITE},
    {{0.5, NOT_A_NUMBER, 0.5}, TRIBO_ERROR_NOT_FINITE},
    {{0.5, 0.3, NOT_A_NUMBER}, TRIBO_ERROR_NOT_FINITE},
    {{INFINITE, 0.3, 0.5}, TRIBO_ERROR_NOT_FINITE},
    {{INFINITE, INFINITE, 0.5}, TRIBO_ERROR_NOT_FINITE},
    {{0.5, -INFINITE, 0.5}, TRIBO_ERROR_NOT_FINITE},
    {{0.5, 0.3, INFINITE}, TRIBO_ERROR_NOT_FINITE},
    {{-0.1, -0.1, 0.5}, TRIBO_ERROR_FRICTION},
    {{-0.1, 0.0, 0.5}, TRIBO_ERROR_FRICTION},
    {{0.1, -5e-324, 0.5}, TRIBO_ERROR_FRICTION},
    {{0.3, 0.3000001, 0.5}, TRIBO_ERROR_FRICTION},
    {{0.0, 5e-324, 0.5}, TRIBO_ERROR_FRICTION},
    {{0.5, 0.3, -5e-324}, TRIBO_ERROR_RESTITUTION},
    {{0.5, 0.3, -1.0}, TRIBO_ERROR_RESTITUTION},
    {{0.5, 0.3, 1.0 + DBL_EPSILON}, TRIBO_ERROR_RESTITUTION},
    {{0.5, 0.3, 1e300}, TRIBO_ERROR_RESTITUTION},
};

enum { BAD_MATERIALS = sizeof bad_materials / sizeof bad_materials[0] };

static void copy_rule(const tribo_material *a, const tribo_material *b, void *user,
                      tribo_material *result)
{
    (void)b;
    *result = user ? *(const tribo_material *)user : *a;
}

static void test_bad_materials_are_refused(void **state)
{
    const tribo_material good = material(0.5, 0.3, 0.5);
    (void)state;
    for (size_t i = 0; i < BAD_MATERIALS; i++) {
        tribo_material bad = bad_materials[i].material;
        const tribo_status status = bad_materials[i].status;
        assert_int_equal(tribo_material_check(&bad), status);
        REFUSED(status, tribo_material_mix(&bad, &good, 0, 0, &out.material));
        REFUSED(status, tribo_material_mix(&good, &bad, 0, 0, &out.material));
        REFUSED(status, tribo_material_mix_with(&bad, &good, copy_rule, NULL, &out.material));
        REFUSED(status, tribo_material_mix_with(&good, &bad, copy_rule, NULL, &out.material));
        /* the same from the user's rule */
        REFUSED(status, tribo_material_mix_with(&good, &good, copy_rule, &bad, &out.material));
    }
}

static void forgetful_rule(const tribo_material *a, const tribo_material *b, void *user,
                           tribo_material *result)
{
    (void)a;
    (void)b;
    (void)user;
    result->mu_s = 0.5;
}

static void test_bad_calls_are_refused(void **state)
{
    const tribo_material m = material(0.5, 0.3, 0.5);
    const tribo_material bad = material(NOT_A_NUMBER, -1.0, 2.0);
    const tribo_material huge = material(1e200, 1e200, 0.5);
    const uint32_t top = RULES;
    (void)state;
    assert_int_equal(tribo_material_check(NULL), TRIBO_ERROR_NULL);
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix(NULL, &m, 0, 0, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix(&m, NULL, 0, 0, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix(&m, &m, top, 0, NULL));
    REFUSED(TRIBO_ERROR_OPTION, tribo_material_mix(&m, &m, top, 0, &out.material));
    REFUSED(TRIBO_ERROR_OPTION, tribo_material_mix(&m, &m, 0, top, &out.material));
    REFUSED(TRIBO_ERROR_OPTION, tribo_material_mix(&m, &m, UINT32_MAX, 0, &out.material));
    REFUSED(TRIBO_ERROR_OPTION, tribo_material_mix(&bad, &m, 0, top, &out.material));
    REFUSED(TRIBO_ERROR_RANGE,
            tribo_material_mix(&huge, &huge, TRIBO_MIX_PRODUCT, 0, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix_with(NULL, &m, copy_rule, NULL, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix_with(&m, NULL, copy_rule, NULL, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix_with(&m, &m, NULL, NULL, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_mix_with(&m, &m, copy_rule, NULL, NULL));
    REFUSED(TRIBO_ERROR_NOT_FINITE,
            tribo_material_mix_with(&m, &m, forgetful_rule, NULL, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_at(0, &out.name, NULL));
    REFUSED(TRIBO_ERROR_INDEX, tribo_material_at(tribo_material_count(), &out.name, &out.material));
    REFUSED(TRIBO_ERROR_INDEX, tribo_material_at(UINT32_MAX, &out.name, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_find(NULL, &out.material));
    REFUSED(TRIBO_ERROR_NULL, tribo_material_find("wood on stone", NULL));
    REFUSED(TRIBO_ERROR_NAME, tribo_material_find("", &out.material));
    REFUSED(TRIBO_ERROR_NAME, tribo_material_find("wood", &out.material));
    REFUSED(TRIBO_ERROR_NAME, tribo_material_find("wood on stones", &out.material));
}

/* Exact in binary: 0.25 and 0.0625 have roots, halves and products that are. */
static void test_mixing_closed_forms(void **state)
{
    const tribo_material a = material(0.25, 0.0625, 1.0);
    const tribo_material b = material(1.0, 0.25, 0.25);
    static const struct {
        uint32_t rule;
        tribo_material expected;
    } rows[RULES] = {
        {TRIBO_MIX_GEOMETRIC_MEAN, {0.5, 0.125, 0.5}},
        {TRIBO_MIX_MINIMUM, {0.25, 0.0625, 0.25}},
        {TRIBO_MIX_MAXIMUM, {1.0, 0.25, 1.0}},
        {TRIBO_MIX_PRODUCT, {0.25, 0.015625, 0.25}},
        {TRIBO_MIX_ARITHMETIC_MEAN, {0.625, 0.15625, 0.625}},
    };
    (void)state;
    for (size_t i = 0; i < RULES; i++) {
        for (size_t k = 0; k < RULES; k++) {
            tribo_material m;
            assert_int_equal(tribo_material_mix(&a, &b, rows[i].rule, rows[k].rule, &m), TRIBO_OK);
            assert_true(m.mu_s == rows[i].expected.mu_s);
            assert_true(m.mu_d == rows[i].expected.mu_d);
            assert_true(m.e == rows[k].expected.e);
        }
    }
}

static void test_mixing_is_symmetric_and_valid(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 1, 1, 1);
    for (int i = 0; i < 20000; i++) {
        const uint32_t rule = (uint32_t)i % RULES;
        tribo_material m[2];
        tribo_material ab;
        tribo_material ba;
        for (int k = 0; k < 2; k++) {
            m[k].mu_s = problem_random_decades(&random, -6.0, 6.0);
            m[k].mu_d = m[k].mu_s * problem_random_uniform(&random, 0.0, 1.0);
            m[k].e = problem_random_uniform(&random, 0.0, 1.0);
        }
        assert_int_equal(tribo_material_mix(&m[0], &m[1], rule, rule, &ab), TRIBO_OK);
        assert_int_equal(tribo_material_mix(&m[1], &m[0], rule, rule, &ba), TRIBO_OK);
        assert_memory_equal(&ab, &ba, sizeof ab);
        assert_int_equal(tribo_material_check(&ab), TRIBO_OK);
        /* a material on itself: every mean gives it back */
        if (rule != TRIBO_MIX_PRODUCT) {
            assert_int_equal(tribo_material_mix(&m[0], &m[0], rule, rule, &ab), TRIBO_OK);
            assert_memory_equal(&ab, &m[0], sizeof ab);
        }
    }
}

/* Means lie between their arguments, so no range of coefficients may be refused. */
static void test_means_of_extreme_coefficients(void **state)
{
    static const double size[] = {DBL_MAX, 1e200, 1e-200, DBL_MIN, 5e-324};
    (void)state;
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        tribo_material a = material(size[i], size[i], 1.0);
        tribo_material m;
        for (uint32_t rule = 0; rule < RULES; rule++) {
            if (rule != TRIBO_MIX_PRODUCT) {
                assert_int_equal(tribo_material_mix(&a, &a, rule, 0, &m), TRIBO_OK);
                assert_true(fabs(m.mu_s - size[i]) <= DBL_EPSILON * size[i]);
            }
        }
    }
    tribo_material a = material(1e250, 0.0, 1.0);
    tribo_material b = material(1e-250, 0.0, 1.0);
    tribo_material m;
    assert_int_equal(tribo_material_mix(&a, &b, TRIBO_MIX_GEOMETRIC_MEAN, 0, &m), TRIBO_OK);
    assert_true(fabs(m.mu_s - 1.0) <= 4 * DBL_EPSILON);
    b = material(0.0, 0.0, 0.0);
    assert_int_equal(tribo_material_mix(&a, &b, TRIBO_MIX_GEOMETRIC_MEAN, 0, &m), TRIBO_OK);
    assert_true(m.mu_s == 0.0 && m.e == 0.0);
}

static void average_rule(const tribo_material *a, const tribo_material *b, void *user,
                         tribo_material *result)
{
    int *calls = (int *)user;
    (*calls)++;
    result->mu_s = 0.5 * (a->mu_s + b->mu_s);
    result->mu_d = 0.5 * (a->mu_d + b->mu_d);
    result->e = 0.0;
}

static void test_user_rule(void **state)
{
    tribo_material a = material(0.5, 0.25, 1.0);
    const tribo_material b = material(1.0, 0.75, 1.0);
    tribo_material m;
    int calls = 0;
    (void)state;
    assert_int_equal(tribo_material_mix_with(&a, &b, average_rule, &calls, &m), TRIBO_OK);
    assert_int_equal(calls, 1);
    assert_true(m.mu_s == 0.75 && m.mu_d == 0.5 && m.e == 0.0);
    /* the output may be an input */
    assert_int_equal(tribo_material_mix_with(&a, &b, average_rule, &calls, &a), TRIBO_OK);
    assert_memory_equal(&a, &m, sizeof m);
    a = material(0.25, 0.0625, 1.0);
    assert_int_equal(tribo_material_mix(&a, &a, TRIBO_MIX_PRODUCT, 0, &a), TRIBO_OK);
    assert_true(a.mu_s == 0.0625 && a.mu_d == 0.00390625 && a.e == 1.0);
}

static void test_table_of_the_lecture(void **state)
{
    static const struct {
        const char *name;
        tribo_material expected;
    } rows[] = {
        {"wood on stone", {0.7, 0.3, 0.0}},
        {"steel on steel", {0.16, 0.12, 0.0}},
    };
    (void)state;
    assert_int_equal(tribo_material_count(), sizeof rows / sizeof rows[0]);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tribo_material found;
        assert_int_equal(tribo_material_find(rows[i].name, &found), TRIBO_OK);
        assert_memory_equal(&found, &rows[i].expected, sizeof found);
    }
    for (uint32_t i = 0; i < tribo_material_count(); i++) {
        tribo_material at;
        tribo_material found;
        const char *name = NULL;
        assert_int_equal(tribo_material_at(i, &name, &at), TRIBO_OK);
        assert_int_equal(tribo_material_find(name, &found), TRIBO_OK);
        assert_memory_equal(&at, &found, sizeof at);
        assert_int_equal(tribo_material_check(&at), TRIBO_OK);
        assert_int_equal(tribo_material_at(i, NULL, &found), TRIBO_OK);
        assert_memory_equal(&at, &found, sizeof at);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_check_accepts),
        cmocka_unit_test(test_bad_materials_are_refused),
        cmocka_unit_test(test_bad_calls_are_refused),
        cmocka_unit_test(test_mixing_closed_forms),
        cmocka_unit_test(test_mixing_is_symmetric_and_valid),
        cmocka_unit_test(test_means_of_extreme_coefficients),
        cmocka_unit_test(test_user_rule),
        cmocka_unit_test(test_table_of_the_lecture),
    };
    return cmocka_run_group_tests_name("material", tests, NULL, NULL);
}
