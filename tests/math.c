/* Vectors, matrices, quaternions, skew products, the contact basis, elementary functions. */
#include <tribo/math.h>

#include "check.h"
#include "problems.h"

#define PI 3.141592653589793238462643L

enum { TRIALS = 100000 };

static void draw(problem_random *random, size_t n, double x[])
{
    for (size_t i = 0; i < n; i++) {
        x[i] = problem_random_normal(random);
    }
}

/* Small integers: sums of products are exact, so results can be compared to the bit. */
static void draw_integers(problem_random *random, size_t n, double x[])
{
    for (size_t i = 0; i < n; i++) {
        x[i] = (double)(int)(problem_random_bits(random) % 201) - 100.0;
    }
}

static int equal(const double *a, const double *b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!(a[i] == b[i])) {
            return 0;
        }
    }
    return 1;
}

static long double length(const double *x, size_t n)
{
    long double sum = 0.0L;
    for (size_t i = 0; i < n; i++) {
        sum += (long double)x[i] * (long double)x[i];
    }
    return sqrtl(sum);
}

static long double long_distance(const double *a, const long double *b, size_t n)
{
    long double sum = 0.0L;
    for (size_t i = 0; i < n; i++) {
        sum += ((long double)a[i] - b[i]) * ((long double)a[i] - b[i]);
    }
    return sqrtl(sum);
}

/* ---- vec3, mat3 ------------------------------------------------------------------------------ */

static void test_vec3_by_hand(void **state)
{
    const double a[3] = {1.0, 2.0, 3.0};
    const double b[3] = {-4.0, 5.0, 6.0};
    static const double cross[3] = {-3.0, -18.0, 13.0};
    static const double sum[3] = {-3.0, 7.0, 9.0};
    static const double difference[3] = {5.0, -3.0, -3.0};
    static const double scaled[3] = {2.0, 4.0, 6.0};
    static const double added[3] = {-7.0, 12.0, 15.0};
    double out[3];
    (void)state;
    assert_true(tribo_vec3_dot(a, b) == 24.0);
    tribo_vec3_cross(a, b, out);
    assert_true(equal(out, cross, 3));
    tribo_vec3_add(a, b, out);
    assert_true(equal(out, sum, 3));
    tribo_vec3_subtract(a, b, out);
    assert_true(equal(out, difference, 3));
    tribo_vec3_scale(2.0, a, out);
    assert_true(equal(out, scaled, 3));
    tribo_vec3_add_scaled(a, 2.0, b, out);
    assert_true(equal(out, added, 3));
    /* left to right: (1e300 - 1e300) + 1, not 1e300 + (-1e300 + 1) */
    assert_true(tribo_vec3_dot((const double[3]){1e300, 1e300, 1.0},
                               (const double[3]){1.0, -1.0, 1.0}) == 1.0);
}

static void test_vec3_outputs_may_be_inputs(void **state)
{
    static const double cross[3] = {-3.0, -18.0, 13.0};
    double a[3] = {1.0, 2.0, 3.0};
    double b[3] = {-4.0, 5.0, 6.0};
    (void)state;
    tribo_vec3_cross(a, b, a);
    assert_true(equal(a, cross, 3));
    a[0] = 1.0;
    a[1] = 2.0;
    a[2] = 3.0;
    tribo_vec3_cross(a, b, b);
    assert_true(equal(b, cross, 3));
    tribo_vec3_cross(a, a, a);
    assert_true(a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0);
}

static void test_norm_has_no_range(void **state)
{
    static const double scales[] = {1.0, 0x1p1020, 0x1p-1020, 0x1p-1074, 0x1p600, 0x1p-600};
    problem_random random;
    (void)state;
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        const double s = scales[i];
        assert_true(tribo_vec3_norm((const double[3]){3.0 * s, -4.0 * s, 0.0}) == 5.0 * s);
        assert_true(tribo_vec3_norm((const double[3]){2.0 * s, -6.0 * s, 9.0 * s}) == 11.0 * s);
    }
    assert_true(tribo_vec3_norm((const double[3]){0.0, -0.0, 0.0}) == 0.0);
    problem_random_start(&random, 1, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double a[3];
        draw(&random, 3, a);
        const double s = problem_random_decades(&random, -300.0, 300.0);
        for (int k = 0; k < 3; k++) {
            a[k] *= s * problem_random_decades(&random, -6.0, 0.0);
        }
        const long double norm = length(a, 3);
        within((double)(fabsl((long double)tribo_vec3_norm(a) - norm) / norm), 2.0 * EPS);
    }
    settle("norm, 2 eps");
}

static void test_normalize(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 2, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double a[3];
        double out[3];
        long double unit[3];
        draw(&random, 3, a);
        const double s = problem_random_decades(&random, -307.0, 307.0);
        for (int k = 0; k < 3; k++) {
            a[k] *= s * problem_random_decades(&random, -6.0, 0.0);
        }
        const long double norm = length(a, 3);
        for (int k = 0; k < 3; k++) {
            unit[k] = (long double)a[k] / norm;
        }
        assert_int_equal(tribo_vec3_normalize(a, out), TRIBO_OK);
        within((double)long_distance(out, unit, 3), 2.0 * EPS);
        assert_int_equal(tribo_vec3_normalize(a, a), TRIBO_OK);
        assert_true(same_bits(a, out, 3));
    }
    settle("normalize, 2 eps");
    double tiny[3] = {5e-324, 0.0, -5e-324};
    assert_int_equal(tribo_vec3_normalize(tiny, tiny), TRIBO_OK);
    within(fabs(tiny[0] - 0.70710678118654752), 2.0 * EPS);
    within(fabs(tiny[2] + 0.70710678118654752), 2.0 * EPS);
    double huge[3] = {DBL_MAX, -DBL_MAX, DBL_MAX};
    assert_int_equal(tribo_vec3_normalize(huge, huge), TRIBO_OK);
    within(fabs(huge[1] + 0.57735026918962576), 2.0 * EPS);
    settle("normalize at the ends of the range, 2 eps");
}

static void test_mat3_exact(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 3, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double a[9];
        double b[9];
        double x[3];
        double ab[9] = {0.0};
        double at[9];
        double ax[3] = {0.0};
        double atx[3] = {0.0};
        double out[9];
        draw_integers(&random, 9, a);
        draw_integers(&random, 9, b);
        draw_integers(&random, 3, x);
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) {
                at[3 * c + r] = a[3 * r + c];
                ax[r] += a[3 * r + c] * x[c];
                atx[c] += a[3 * r + c] * x[r];
                for (int k = 0; k < 3; k++) {
                    ab[3 * r + c] += a[3 * r + k] * b[3 * k + c];
                }
            }
        }
        tribo_mat3_multiply(a, b, out);
        assert_true(equal(out, ab, 9));
        tribo_mat3_transpose(a, out);
        assert_true(same_bits(out, at, 9));
        tribo_mat3_apply(a, x, out);
        assert_true(equal(out, ax, 3));
        tribo_mat3_apply_transposed(a, x, out);
        assert_true(equal(out, atx, 3));
        /* in place */
        memcpy(out, x, sizeof x);
        tribo_mat3_apply(a, out, out);
        assert_true(equal(out, ax, 3));
        memcpy(out, x, sizeof x);
        tribo_mat3_apply_transposed(a, out, out);
        assert_true(equal(out, atx, 3));
        tribo_mat3_multiply(a, b, b);
        assert_true(equal(b, ab, 9));
        tribo_mat3_transpose(a, a);
        assert_true(same_bits(a, at, 9));
    }
}

static void full_of(const double s[6], double full[9])
{
    const double m[9] = {s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]};
    memcpy(full, m, sizeof m);
}

static void test_sym3_is_the_full_matrix(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 4, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double s[6];
        double full[9];
        double x[3];
        double expected[3];
        draw(&random, 6, s);
        draw(&random, 3, x);
        full_of(s, full);
        tribo_mat3_apply(full, x, expected);
        tribo_sym3_apply(s, x, x);
        assert_true(same_bits(x, expected, 3));
    }
}

/* ---- skew matrices --------------------------------------------------------------------------- */

static void test_skew_is_the_cross_product(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 5, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double r[3];
        double x[3];
        double s[9];
        double sx[3];
        long double rx[3];
        draw(&random, 3, r);
        draw(&random, 3, x);
        tribo_skew_matrix(r, s);
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            rx[k] = (long double)r[a] * (long double)x[b] - (long double)r[b] * (long double)x[a];
            for (int l = 0; l < 3; l++) {
                assert_true(s[3 * k + l] + s[3 * l + k] == 0.0);
            }
        }
        tribo_mat3_apply(s, x, sx);
        within((double)(long_distance(sx, rx, 3) / (length(r, 3) * length(x, 3))), 4.0 * EPS);
    }
    settle("S(r) x = r x x, 4 eps |r||x|");
}

static void test_skew_products_exact(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 6, 0, 0);
    for (int i = 0; i < 2000; i++) {
        double r[3];
        double x[3];
        double a[6];
        double full[9];
        double s[9];
        double st[9];
        double product[9];
        double expected[3];
        double out[6];
        double congruence[9];
        draw_integers(&random, 3, r);
        draw_integers(&random, 3, x);
        draw_integers(&random, 6, a);
        full_of(a, full);
        tribo_skew_matrix(r, s);
        tribo_mat3_transpose(s, st);
        tribo_mat3_multiply(st, full, product);
        tribo_mat3_multiply(product, s, product);
        tribo_skew_congruence(r, a, out);
        full_of(out, congruence);
        assert_true(equal(congruence, product, 9));
        tribo_mat3_apply(full, x, expected);
        tribo_vec3_cross(r, expected, expected);
        tribo_skew_cross_apply(r, a, x, out);
        assert_true(equal(out, expected, 3));
        tribo_skew_cross_apply(r, a, x, x);
        assert_true(equal(x, expected, 3));
    }
}

/* ---- contact basis --------------------------------------------------------------------------- */

/* Deviation of B B^T from 1 and of det B from 1, in long double. */
static double basis_error(const double b[9])
{
    long double error = 0.0L;
    long double m[9];
    for (int i = 0; i < 9; i++) {
        m[i] = (long double)b[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            const long double product =
                m[3 * i] * m[3 * k] + m[3 * i + 1] * m[3 * k + 1] + m[3 * i + 2] * m[3 * k + 2];
            error = fmaxl(error, fabsl(product - (i == k ? 1.0L : 0.0L)));
        }
    }
    const long double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
                                    m[1] * (m[3] * m[8] - m[5] * m[6]) +
                                    m[2] * (m[3] * m[7] - m[4] * m[6]);
    return (double)fmaxl(error, fabsl(determinant - 1.0L));
}

static void basis(const double n[3], double b[9])
{
    memset(b, 0xff, 9 * sizeof *b);
    assert_int_equal(tribo_basis_from_normal(n, b), TRIBO_OK);
    assert_true(same_bits(n, b, 3));
    within(basis_error(b), 8.0 * EPS);
}

static void test_basis_at_the_axes(void **state)
{
    static const double rows[][9] = {
        {0, 0, 1, 1, 0, 0, 0, 1, 0},  {0, 0, -1, 1, 0, 0, 0, -1, 0}, {1, 0, 0, 0, 0, -1, 0, 1, 0},
        {-1, 0, 0, 0, 0, 1, 0, 1, 0}, {0, 1, 0, 1, 0, 0, 0, 0, -1},  {0, -1, 0, 1, 0, 0, 0, 0, 1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        /* every choice of signs of the two zeros gives the same tangents, to the bit */
        double first[9];
        for (int signs = 0; signs < 4; signs++) {
            double n[3];
            double b[9];
            int zero = 0;
            for (int k = 0; k < 3; k++) {
                n[k] = rows[i][k];
                if (n[k] == 0.0) {
                    n[k] = (signs >> zero++) & 1 ? -0.0 : 0.0;
                }
            }
            basis(n, b);
            assert_true(equal(b, rows[i], 9));
            if (signs == 0) {
                memcpy(first, b, sizeof b);
            }
            assert_true(same_bits(b + 3, first + 3, 6));
        }
    }
    assert_true(worst == 0.0);
}

static void test_basis_of_random_normals(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 7, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double n[3];
        double b[9];
        problem_random_direction(&random, 3, n);
        assert_int_equal(tribo_vec3_normalize(n, n), TRIBO_OK);
        basis(n, b);
    }
    settle("orthonormal and right-handed, 8 eps, 1e5 normals");
}

/* Rotate z to n = (s cos f, s sin f, c) about z x n, in long double, from the angle itself. */
static void reference_tangents(long double theta, long double f, long double t[6])
{
    const long double s = sinl(theta);
    const long double versine = 2.0L * sinl(theta / 2) * sinl(theta / 2); /* 1 - cos theta */
    t[0] = 1.0L - versine * cosl(f) * cosl(f);
    t[1] = -versine * cosl(f) * sinl(f);
    t[2] = -s * cosl(f);
    t[3] = t[1];
    t[4] = 1.0L - versine * sinl(f) * sinl(f);
    t[5] = -s * sinl(f);
}

static void test_basis_is_the_rotation_of_z(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 8, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        const long double theta = (long double)problem_random_uniform(&random, 0.0, 2.8);
        const long double f = (long double)problem_random_uniform(&random, -3.14, 3.14);
        const double n[3] = {(double)(sinl(theta) * cosl(f)), (double)(sinl(theta) * sinl(f)),
                             (double)cosl(theta)};
        double b[9];
        long double t[6];
        reference_tangents(theta, f, t);
        basis(n, b);
        within((double)long_distance(b + 3, t, 6), 16.0 * EPS / (double)cosl(theta / 2));
    }
    settle("the rotation about z x n, 16 eps / cos(theta/2)");
}

/* At an angle d from -z, d from 0.1 to 1e-300. */
static void test_basis_near_minus_z(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 9, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        const double d = problem_random_decades(&random, i % 2 ? -17.0 : -300.0, -1.0);
        const double f = problem_random_uniform(&random, -3.14, 3.14);
        const double n[3] = {sin(d) * cos(f), sin(d) * sin(f), -cos(d)};
        double b[9];
        basis(n, b);
    }
    settle("orthonormal near -z, 8 eps");
    static const double offset[] = {1e-9, 1e-150, 1e-154, 1e-160, 5e-324};
    for (size_t i = 0; i < sizeof offset / sizeof offset[0]; i++) {
        for (int k = 0; k < 8; k++) {
            double b[9];
            const double n[3] = {k & 1 ? offset[i] : 0.0, k & 2 ? -offset[i] : 0.0,
                                 k & 4 ? -1.0 : 1.0};
            basis(n, b);
        }
    }
    settle("orthonormal next to the poles, 8 eps");
}

/* A frame that follows n turns by |dn| with it and twists by tan(theta/2) |dn| about it, so that in
 * the Frobenius norm |dB| <= sqrt(2) |dn| / cos(theta/2): continuous wherever that is finite. */
static void test_basis_is_continuous(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 10, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double n[3];
        double m[3];
        double step[3];
        double b[9];
        double c[9];
        problem_random_direction(&random, 3, n);
        if (i % 2) { /* next to the planes where a choice of axis or of formula may switch */
            n[i / 2 % 3] = problem_random_decades(&random, -12.0, -3.0);
        }
        problem_random_direction(&random, 3, step);
        const double size = problem_random_decades(&random, -9.0, -5.0);
        tribo_vec3_add_scaled(n, size, step, m);
        assert_int_equal(tribo_vec3_normalize(n, n), TRIBO_OK);
        assert_int_equal(tribo_vec3_normalize(m, m), TRIBO_OK);
        const double half_cosine = sqrt(0.5 * (1.0 + fmin(n[2], m[2])));
        if (half_cosine < 0.01) {
            continue;
        }
        basis(n, b);
        basis(m, c);
        double dn = 0.0;
        double db = 0.0;
        for (int k = 0; k < 9; k++) {
            dn += k < 3 ? (b[k] - c[k]) * (b[k] - c[k]) : 0.0;
            db += (b[k] - c[k]) * (b[k] - c[k]);
        }
        within(sqrt(db), (sqrt(2.0 * dn) * 1.01 + 16.0 * EPS) / half_cosine);
    }
    settle("change of the basis over its Lipschitz bound");
}

/* An output may be the same array as an input. */
static void test_in_place(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 17, 0, 0);
    for (int i = 0; i < 1000; i++) {
        double expected[9];
        double shared[9];
        problem_random_direction(&random, 3, shared);
        assert_int_equal(tribo_vec3_normalize(shared, shared), TRIBO_OK);
        assert_int_equal(tribo_basis_from_normal(shared, expected), TRIBO_OK);
        assert_int_equal(tribo_basis_from_normal(shared, shared), TRIBO_OK);
        assert_true(same_bits(shared, expected, 9));
        draw(&random, 4, shared);
        tribo_quat_to_mat3(shared, expected);
        tribo_quat_to_mat3(shared, shared);
        assert_true(same_bits(shared, expected, 9));
        draw(&random, 3, shared);
        tribo_skew_matrix(shared, expected);
        tribo_skew_matrix(shared, shared);
        assert_true(same_bits(shared, expected, 9));
        draw(&random, 3, shared);
        assert_int_equal(tribo_quat_from_rotation_vector(shared, expected), TRIBO_OK);
        assert_int_equal(tribo_quat_from_rotation_vector(shared, shared), TRIBO_OK);
        assert_true(same_bits(shared, expected, 4));
        const double r[3] = {1.0, -2.0, 0.5};
        draw(&random, 6, shared);
        tribo_skew_congruence(r, shared, expected);
        tribo_skew_congruence(r, shared, shared);
        assert_true(same_bits(shared, expected, 6));
        const double q[4] = {0.5, -0.25, 2.0, 1.0};
        draw(&random, 4, shared);
        tribo_quat_multiply(q, shared, expected);
        tribo_quat_multiply(q, shared, shared);
        assert_true(same_bits(shared, expected, 4));
        draw(&random, 4, shared);
        tribo_quat_multiply(shared, q, expected);
        tribo_quat_multiply(shared, q, shared);
        assert_true(same_bits(shared, expected, 4));
    }
}

static void test_basis_judges_the_length(void **state)
{
    double b[9];
    (void)state;
    for (int i = 0; i < 3; i++) {
        double n[3] = {0.0, 0.0, 0.0};
        n[i] = -sqrt(1.0 + 0.9e-12);
        assert_int_equal(tribo_basis_from_normal(n, b), TRIBO_OK);
        n[i] = sqrt(1.0 - 0.9e-12);
        assert_int_equal(tribo_basis_from_normal(n, b), TRIBO_OK);
        assert_true(same_bits(n, b, 3));
        n[i] = sqrt(1.0 + 1.1e-12);
        assert_int_equal(tribo_basis_from_normal(n, b), TRIBO_ERROR_NORMAL);
        n[i] = -sqrt(1.0 - 1.1e-12);
        assert_int_equal(tribo_basis_from_normal(n, b), TRIBO_ERROR_NORMAL);
    }
}

/* ---- quaternions ----------------------------------------------------------------------------- */

static void draw_rotation(problem_random *random, double q[4])
{
    problem_random_direction(random, 4, q);
    assert_int_equal(tribo_quat_normalize(q, q), TRIBO_OK);
}

static double difference(const double *a, const double *b, size_t n)
{
    double greatest = 0.0;
    for (size_t i = 0; i < n; i++) {
        greatest = fmax(greatest, fabs(a[i] - b[i]));
    }
    return greatest;
}

static void test_quaternions_by_hand(void **state)
{
    static const double i[4] = {0, 1, 0, 0};
    static const double j[4] = {0, 0, 1, 0};
    static const double k[4] = {0, 0, 0, 1};
    static const double quarter[4] = {1, 0, 0, 1}; /* not of unit length: a quarter turn about z */
    static const double turned[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    static const double x[3] = {1.0, 2.0, 3.0};
    double out[9];
    (void)state;
    tribo_quat_multiply(i, j, out);
    assert_true(equal(out, k, 4));
    tribo_quat_multiply(j, k, out);
    assert_true(equal(out, i, 4));
    tribo_quat_multiply(k, i, out);
    assert_true(equal(out, j, 4));
    tribo_quat_multiply(j, i, out);
    tribo_quat_conjugate(out, out);
    assert_true(equal(out, k, 4));
    tribo_quat_to_mat3(quarter, out);
    assert_true(equal(out, turned, 9));
    tribo_quat_rotate(quarter, x, out);
    assert_true(out[0] == -2.0 && out[1] == 1.0 && out[2] == 3.0);
    tribo_quat_rotate_inverse(quarter, x, out);
    assert_true(out[0] == 2.0 && out[1] == -1.0 && out[2] == 3.0);
}

static void test_quaternions_are_rotations(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 11, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double a[4];
        double b[4];
        double ab[4];
        double long_a[4];
        double ra[9];
        double rb[9];
        double rab[9];
        double product[9];
        double x[3];
        double y[3];
        double z[3];
        draw_rotation(&random, a);
        draw_rotation(&random, b);
        draw(&random, 3, x);
        const double stretch = problem_random_decades(&random, -3.0, 3.0);
        for (int k = 0; k < 4; k++) {
            long_a[k] = stretch * a[k];
        }
        tribo_quat_multiply(a, b, ab);
        tribo_quat_to_mat3(long_a, ra);
        tribo_quat_to_mat3(b, rb);
        tribo_quat_to_mat3(ab, rab);
        tribo_mat3_multiply(ra, rb, product);
        within(difference(rab, product, 9), 16.0 * EPS);
        within(basis_error(ra), 16.0 * EPS);
        tribo_mat3_apply(ra, x, y);
        tribo_quat_rotate(long_a, x, z);
        const double norm = tribo_vec3_norm(x);
        within(difference(y, z, 3), 16.0 * EPS * norm);
        tribo_quat_rotate_inverse(long_a, z, z);
        within(difference(x, z, 3), 16.0 * EPS * norm);
        tribo_mat3_apply_transposed(ra, x, y);
        tribo_quat_rotate_inverse(long_a, x, x);
        within(difference(x, y, 3), 16.0 * EPS * norm);
    }
    settle("product, matrix, rotate and its inverse agree, 16 eps");
}

static void test_quat_normalize(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 12, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double q[4];
        double out[4];
        long double unit[4];
        draw(&random, 4, q);
        const double s = problem_random_decades(&random, -307.0, 307.0);
        for (int k = 0; k < 4; k++) {
            q[k] *= s;
        }
        const long double norm = length(q, 4);
        for (int k = 0; k < 4; k++) {
            unit[k] = (long double)q[k] / norm;
        }
        assert_int_equal(tribo_quat_normalize(q, out), TRIBO_OK);
        within((double)long_distance(out, unit, 4), 2.0 * EPS);
    }
    settle("normalize, 2 eps");
}

static void check_rotation_vector(const double v[3])
{
    const long double angle = length(v, 3);
    const long double factor = angle > 0 ? sinl(angle / 2) / angle : 0.5L;
    const long double expected[4] = {cosl(angle / 2), factor * (long double)v[0],
                                     factor * (long double)v[1], factor * (long double)v[2]};
    double q[4];
    assert_int_equal(tribo_quat_from_rotation_vector(v, q), TRIBO_OK);
    /* the rounded angle itself is uncertain by half an ulp */
    within((double)long_distance(q, expected, 4), 4.0 * EPS * (1.0 + 0.25 * (double)angle));
    within((double)fabsl(length(q, 4) - 1.0L), 4.0 * EPS);
    /* and the vector part is accurate relative to itself while the angle is small */
    if (angle > 0 && angle < 1) {
        within((double)long_distance(q + 1, expected + 1, 3), 4.0 * EPS * (double)angle + 5e-324);
    }
}

static void test_rotation_vector(void **state)
{
    static const double size[] = {0.0, 5e-324, 1e-300, 1e-160, 3e-151, 1e-20, 1e-8, 1048576.0};
    problem_random random;
    (void)state;
    problem_random_start(&random, 13, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double v[3];
        problem_random_direction(&random, 3, v);
        tribo_vec3_scale(problem_random_decades(&random, i % 2 ? -3.0 : -300.0, 6.0), v, v);
        check_rotation_vector(v);
    }
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        check_rotation_vector((const double[3]){size[i], 0.0, 0.0});
        check_rotation_vector((const double[3]){0.0, -size[i], 0.0});
    }
    settle("exponential map, 4 eps (1 + |v|/4)");
}

static void test_quat_angle(void **state)
{
    problem_random random;
    (void)state;
    problem_random_start(&random, 14, 0, 0);
    for (int i = 0; i < TRIALS; i++) {
        double a[4];
        double b[4];
        double step[4];
        double v[3];
        const double angle = i % 3 ? problem_random_uniform(&random, 0.0, 3.14159)
                                   : problem_random_decades(&random, -12.0, 0.0);
        draw_rotation(&random, a);
        problem_random_direction(&random, 3, v);
        tribo_vec3_scale(angle, v, v);
        assert_int_equal(tribo_quat_from_rotation_vector(v, step), TRIBO_OK);
        tribo_quat_multiply(a, step, b);
        within(fabs(tribo_quat_angle(a, b) - angle), 16.0 * EPS);
        within(fabs(tribo_quat_angle(b, a) - angle), 16.0 * EPS);
        /* length and sign of a quaternion do not matter */
        for (int k = 0; k < 4; k++) {
            b[k] *= -3.0;
        }
        within(fabs(tribo_quat_angle(a, b) - angle), 16.0 * EPS);
    }
    settle("angle between rotations, 16 eps");
    /* small angles keep their relative accuracy */
    const double one[4] = {1.0, 0.0, 0.0, 0.0};
    for (int e = -1; e > -1000; e--) {
        const double v[3] = {0.0, ldexp(1.25, e), 0.0};
        double q[4];
        assert_int_equal(tribo_quat_from_rotation_vector(v, q), TRIBO_OK);
        within(fabs(tribo_quat_angle(one, q) - v[1]) / v[1], 4.0 * EPS);
    }
    settle("small angles, 4 eps relative");
    assert_true(tribo_quat_angle(one, (const double[4]){0.0, 0.0, 0.0, -2.0}) == (double)PI);
    assert_true(tribo_quat_angle(one, (const double[4]){-5.0, 0.0, 0.0, 0.0}) == 0.0);
}

/* ---- elementary functions -------------------------------------------------------------------- */

static double ulps(double x, long double truth)
{
    int exponent;
    frexpl(truth, &exponent);
    const int lowest = exponent - 53 < -1074 ? -1074 : exponent - 53;
    return (double)(fabsl((long double)x - truth) / ldexpl(1.0L, lowest));
}

static void need_long_double(void)
{
    if (LDBL_MANT_DIG < 64) {
        print_message("# SKIP: long double is no wider than double here\n");
        skip();
    }
}

static void check_sin_cos(double x)
{
    double sine;
    double cosine;
    double minus_sine;
    double minus_cosine;
    tribo_sin_cos(x, &sine, &cosine);
    within(ulps(sine, sinl((long double)x)), 2.0);
    within(ulps(cosine, cosl((long double)x)), 2.0);
    tribo_sin_cos(-x, &minus_sine, &minus_cosine);
    assert_true(minus_sine == -sine && minus_cosine == cosine);
}

static void test_sin_cos_in_ulp(void **state)
{
    problem_random random;
    (void)state;
    need_long_double();
    problem_random_start(&random, 15, 0, 0);
    for (int i = 0; i < 4 * TRIALS; i++) {
        check_sin_cos(problem_random_uniform(&random, -1048576.0, 1048576.0));
        check_sin_cos(problem_random_uniform(&random, -3.2, 3.2));
        check_sin_cos(problem_random_decades(&random, -300.0, 6.0));
    }
    check_sin_cos(1048576.0);
    check_sin_cos(5e-324);
    settle("sine and cosine, 2 ulp");
}

/* Next to every multiple of pi/4 within the range: there reduction loses most digits. */
static void test_sin_cos_next_to_multiples(void **state)
{
    (void)state;
    need_long_double();
    for (int k = 1; k <= 1335088; k++) {
        const double x = (double)(PI / 4 * (long double)k);
        check_sin_cos(x);
        check_sin_cos(nextafter(x, 0.0));
        if (x < 1048575.0) {
            check_sin_cos(nextafter(x, 2e6));
        }
    }
    settle("sine and cosine next to k pi/4, 2 ulp");
}

static void test_sin_cos_special(void **state)
{
    const double outside[] = {nextafter(1048576.0, 2e6),
                              -nextafter(1048576.0, 2e6),
                              1e300,
                              INFINITE,
                              -INFINITE,
                              NOT_A_NUMBER};
    double sine;
    double cosine;
    (void)state;
    tribo_sin_cos(0.0, &sine, &cosine);
    assert_true(sine == 0.0 && cosine == 1.0);
    tribo_sin_cos(-0.0, &sine, &cosine);
    assert_true(sine == 0.0 && cosine == 1.0);
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        sine = cosine = 0.0;
        tribo_sin_cos(outside[i], &sine, &cosine);
        assert_true(isnan(sine) && isnan(cosine));
    }
    /* sin^2 + cos^2 = 1 */
    for (int i = 0; i < 100000; i++) {
        tribo_sin_cos(0.1 * i, &sine, &cosine);
        within(fabs(sine * sine + cosine * cosine - 1.0), 3.0 * EPS);
    }
    settle("sin^2 + cos^2, 3 eps");
}

static void check_atan2(double y, double x)
{
    within(ulps(tribo_atan2(y, x), atan2l((long double)y, (long double)x)), 2.0);
}

static void test_atan2_in_ulp(void **state)
{
    problem_random random;
    (void)state;
    need_long_double();
    problem_random_start(&random, 16, 0, 0);
    for (int i = 0; i < 4 * TRIALS; i++) {
        const double y = problem_random_normal(&random);
        const double x = problem_random_normal(&random);
        check_atan2(y, x);
        check_atan2(y * problem_random_decades(&random, -300.0, 300.0), x);
        check_atan2(y, x * problem_random_decades(&random, -300.0, 300.0));
        check_atan2(y * problem_random_decades(&random, -20.0, 0.0), x);
        /* next to the diagonals, and to the eighths of the slope */
        const double off = problem_random_decades(&random, -17.0, -3.0);
        const double t = (double)(i % 17) / 8.0 - 1.0 + off;
        check_atan2(t * x, x);
        check_atan2(x, t * x);
        check_atan2((t + 0.0625) * x, x);
    }
    settle("atan2, 2 ulp");
    static const double ends[] = {5e-324, DBL_MIN, 1e-300, 1.0, 1e300, DBL_MAX};
    for (size_t i = 0; i < 6; i++) {
        for (size_t k = 0; k < 6; k++) {
            check_atan2(ends[i], ends[k]);
            check_atan2(ends[i], -ends[k]);
            check_atan2(-ends[i], ends[k]);
            check_atan2(-ends[i], -ends[k]);
        }
    }
    settle("atan2 at the ends of the range, 2 ulp");
}

static void test_atan2_special(void **state)
{
    const double pi = (double)PI;
    const struct {
        double y;
        double x;
        double angle;
    } rows[] = {
        {0.0, 1.0, 0.0},         {-0.0, 1.0, -0.0},      {0.0, -1.0, pi},
        {-0.0, -1.0, -pi},       {1.0, 0.0, pi / 2},     {1.0, -0.0, pi / 2},
        {-1.0, 0.0, -pi / 2},    {-1.0, -0.0, -pi / 2},  {1.0, 1.0, pi / 4},
        {-1.0, 1.0, -pi / 4},    {1.0, -1.0, 0.75 * pi}, {-1, -1, -0.75 * pi},
        {0.0, 0.0, 0.0},         {-0.0, 0.0, -0.0},      {0.0, -0.0, pi},
        {-0.0, -0.0, -pi},       {5e-324, -1e300, pi},   {-5e-324, -1e300, -pi},
        {1e300, 5e-324, pi / 2}, {3.0, 3.0, pi / 4},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double angle = tribo_atan2(rows[i].y, rows[i].x);
        if (!same_bits(&angle, &rows[i].angle, 1)) {
            fail_msg("atan2(%g, %g) = %.17g, not %.17g", rows[i].y, rows[i].x, angle,
                     rows[i].angle);
        }
    }
    assert_true(isnan(tribo_atan2(NOT_A_NUMBER, 1.0)));
    assert_true(isnan(tribo_atan2(1.0, NOT_A_NUMBER)));
}

static void check_scale(double x)
{
    const double s = tribo_pow2_scale(x);
    int exponent;
    assert_true(frexp(s, &exponent) == 0.5);
    assert_true(s * fabs(x) >= 1.0 && s * fabs(x) < 2.0);
    assert_true(tribo_pow2_scale(-x) == s);
}

static void test_pow2_scale(void **state)
{
    (void)state;
    for (int e = -1000; e < 1000; e++) {
        check_scale(ldexp(1.0, e));
        check_scale(ldexp(1.3, e));
        check_scale(nextafter(ldexp(2.0, e), 0.0));
    }
    check_scale(0x1p1000);
    static const double small[] = {5e-324, DBL_MIN, 0x1p-1001, 0x1.fffffffffffffp-1001};
    static const double large[] = {0x1.8p1001, 0x1p1001, 0x1p1023, DBL_MAX};
    for (size_t i = 0; i < 4; i++) {
        assert_true(tribo_pow2_scale(small[i]) == 0x1p1000);
        assert_true(tribo_pow2_scale(-small[i]) == 0x1p1000);
        assert_true(tribo_pow2_scale(large[i]) == 0x1p-1000);
        assert_true(tribo_pow2_scale(-large[i]) == 0x1p-1000);
    }
    assert_true(tribo_pow2_scale(0.0) == 1.0);
    assert_true(tribo_pow2_scale(-0.0) == 1.0);
}

/* ---- bad input ------------------------------------------------------------------------------- */

static double out[9];
static double before[9];

/* A refused call gives the status and leaves `out` as it was. */
#define REFUSED(expected, call) ASSERT_REFUSED_AFRESH(out, before, expected, call)

static void test_bad_input(void **state)
{
    const double bad[3] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    const double zero[4] = {0.0, -0.0, 0.0, 0.0};
    const double unit[4] = {0.0, 0.0, 1.0, 0.0};
    (void)state;
    REFUSED(TRIBO_ERROR_NULL, tribo_vec3_normalize(NULL, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_vec3_normalize(unit, NULL));
    REFUSED(TRIBO_ERROR_RANGE, tribo_vec3_normalize(zero, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_basis_from_normal(NULL, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_basis_from_normal(unit, NULL));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_basis_from_normal(zero, out));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_basis_from_normal((const double[3]){1, 1, 1}, out));
    REFUSED(TRIBO_ERROR_NORMAL, tribo_basis_from_normal((const double[3]){1e300, 0, 0}, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_quat_normalize(NULL, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_quat_normalize(unit, NULL));
    REFUSED(TRIBO_ERROR_RANGE, tribo_quat_normalize(zero, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_quat_from_rotation_vector(NULL, out));
    REFUSED(TRIBO_ERROR_NULL, tribo_quat_from_rotation_vector(unit, NULL));
    REFUSED(TRIBO_ERROR_RANGE,
            tribo_quat_from_rotation_vector((const double[3]){0, 1048576.5, 0}, out));
    REFUSED(TRIBO_ERROR_RANGE,
            tribo_quat_from_rotation_vector((const double[3]){1e308, 1e308, 1e308}, out));
    for (int i = 0; i < 12; i++) {
        double v[4] = {0.0, 0.0, 1.0, 0.0};
        v[i / 3] = bad[i % 3];
        REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_quat_normalize(v, out));
        if (i < 9) {
            REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_vec3_normalize(v, out));
            REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_basis_from_normal(v, out));
            REFUSED(TRIBO_ERROR_NOT_FINITE, tribo_quat_from_rotation_vector(v, out));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_vec3_by_hand),
        TEST(test_vec3_outputs_may_be_inputs),
        TEST(test_norm_has_no_range),
        TEST(test_normalize),
        TEST(test_mat3_exact),
        TEST(test_sym3_is_the_full_matrix),
        TEST(test_skew_is_the_cross_product),
        TEST(test_skew_products_exact),
        TEST(test_basis_at_the_axes),
        TEST(test_basis_of_random_normals),
        TEST(test_basis_is_the_rotation_of_z),
        TEST(test_basis_near_minus_z),
        TEST(test_basis_is_continuous),
        TEST(test_basis_judges_the_length),
        TEST(test_in_place),
        TEST(test_quaternions_by_hand),
        TEST(test_quaternions_are_rotations),
        TEST(test_quat_normalize),
        TEST(test_rotation_vector),
        TEST(test_quat_angle),
        TEST(test_sin_cos_in_ulp),
        TEST(test_sin_cos_next_to_multiples),
        TEST(test_sin_cos_special),
        TEST(test_atan2_in_ulp),
        TEST(test_atan2_special),
        TEST(test_pow2_scale),
        TEST(test_bad_input),
    };
    return cmocka_run_group_tests_name("math", tests, NULL, NULL);
}
