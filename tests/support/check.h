/**
 * @file check.h
 * What the cmocka programs of the core share: errors in units of their tolerances, refused calls,
 * a body by its numbers. It needs cmocka, so it is a header only: benches and fuzz targets link
 * the rest of this folder without.
 */
#ifndef TRIBO_TESTS_CHECK_H
#define TRIBO_TESTS_CHECK_H

#include <tribo/body.h>

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define EPS DBL_EPSILON
#define NOT_A_NUMBER ((double)NAN)
#define INFINITE ((double)INFINITY)

static const double not_finite[3] = {NOT_A_NUMBER, INFINITE, -INFINITE};

/** Greatest error of the running test, in units of its tolerance. */
static double worst;

/** The test's set-up. */
static inline int fresh(void **state)
{
    (void)state;
    worst = 0.0;
    return 0;
}

#define TEST(function) cmocka_unit_test_setup(function, fresh)

/** Keep an error that `settle` is to judge; NaN counts as infinite. */
static inline void within(double error, double tolerance)
{
    const double units = error == 0.0 ? 0.0 : error / tolerance;
    if (!(units <= worst)) {
        worst = units >= 0.0 ? units : INFINITE;
    }
}

/** Print the greatest error since the last call, fail if it is beyond its tolerance. */
static inline void settle(const char *what)
{
    const double greatest = worst;
    worst = 0.0;
    print_message("# %s: %.3g of the tolerance\n", what, greatest);
    assert_true(greatest <= 1.0);
}

static inline double distance(const double *a, const double *b, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(sum);
}

static inline int same_bits(const double *a, const double *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) == 0;
}

/** A body with a diagonal inertia tensor. */
static inline tribo_body body_of(double mass, double ixx, double iyy, double izz)
{
    const double inertia[9] = {ixx, 0, 0, 0, iyy, 0, 0, 0, izz};
    tribo_body body;
    tribo_body_init(&body);
    assert_int_equal(tribo_body_set_mass(&body, mass, inertia), TRIBO_OK);
    return body;
}

/** A refused call gives the status and leaves `outputs` as they were; `before` is a variable of the
 *  same type. */
#define ASSERT_REFUSED(outputs, before, expected, call)         \
    do {                                                        \
        memcpy(&before, &outputs, sizeof outputs);              \
        assert_int_equal(call, expected);                       \
        assert_memory_equal(&before, &outputs, sizeof outputs); \
    } while (0)

/** The same after the outputs are filled with a pattern that no result has. */
#define ASSERT_REFUSED_AFRESH(outputs, before, expected, call) \
    do {                                                       \
        memset(&outputs, 0xa5, sizeof outputs);                \
        ASSERT_REFUSED(outputs, before, expected, call);       \
    } while (0)

#endif
