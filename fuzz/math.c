/* Properties of include/tribo/math.h. */
#include <math.h>
#include <string.h>

#include "support/reference.h"

static long double wide(double x)
{
    return (long double)x;
}

/* Spacing of doubles at x. */
static double ulp(long double x)
{
    const int exponent = x == 0.0L ? -1074 : ilogbl(x) - 52;
    return ldexp(1.0, exponent < -1074 ? -1074 : exponent);
}

static double worst9(const double got[9], const long double want[9])
{
    long double worst = 0.0L;
    for (int i = 0; i < 9; i++) {
        const long double d = fabsl(wide(got[i]) - want[i]);
        worst = d > worst || d != d ? d : worst;
    }
    return (double)worst;
}

static double worst3(const double got[3], const long double want[3])
{
    long double worst = 0.0L;
    for (int i = 0; i < 3; i++) {
        const long double d = fabsl(wide(got[i]) - want[i]);
        worst = d > worst || d != d ? d : worst;
    }
    return (double)worst;
}

static void make_matrix9(property_trial *t, const char *name, double m[9])
{
    for (int i = 0; i < 9; i++) {
        m[i] = make_real(t, NULL, -30, 30);
    }
    property_note(t, name, m, 9);
}

static void expand_symmetric(const double s[6], double m[9])
{
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; i++) {
        m[i] = s[full[i]];
    }
}

static void apply_wide(const long double m[9], const double x[3], long double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = m[3 * i] * wide(x[0]) + m[3 * i + 1] * wide(x[1]) + m[3 * i + 2] * wide(x[2]);
    }
}

/* ---- vectors ------------------------------------------------------------------------------ */

/* The stated formulae, bit by bit, also where the output is an input. */
static void vec3_formulae(property_trial *t)
{
    double a[3];
    double b[3];
    double out[3];
    double want[3];
    double same[3];
    make_vector(t, "a", -400, 400, a);
    make_vector(t, "b", -400, 400, b);
    const double s = make_real(t, "s", -400, 400);
    REQUIRE(t, tribo_vec3_dot(a, b) == a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    for (int i = 0; i < 3; i++) {
        want[i] = a[i] + b[i];
    }
    tribo_vec3_add(a, b, out);
    memcpy(same, a, sizeof same);
    tribo_vec3_add(same, b, same);
    REQUIRE(t, property_same(out, want, sizeof out) && property_same(out, same, sizeof out));
    for (int i = 0; i < 3; i++) {
        want[i] = a[i] - b[i];
    }
    tribo_vec3_subtract(a, b, out);
    memcpy(same, b, sizeof same);
    tribo_vec3_subtract(a, same, same);
    REQUIRE(t, property_same(out, want, sizeof out) && property_same(out, same, sizeof out));
    for (int i = 0; i < 3; i++) {
        want[i] = s * a[i];
    }
    tribo_vec3_scale(s, a, out);
    REQUIRE_SAME(t, out, want, sizeof out);
    for (int i = 0; i < 3; i++) {
        want[i] = a[i] + s * b[i];
    }
    tribo_vec3_add_scaled(a, s, b, out);
    memcpy(same, b, sizeof same);
    tribo_vec3_add_scaled(a, s, same, same);
    REQUIRE(t, property_same(out, want, sizeof out) && property_same(out, same, sizeof out));
}

static void vec3_cross(property_trial *t)
{
    double a[3];
    double b[3];
    double ab[3];
    double ba[3];
    double aa[3];
    make_vector(t, "a", -100, 100, a);
    make_vector(t, "b", -100, 100, b);
    tribo_vec3_cross(a, b, ab);
    tribo_vec3_cross(b, a, ba);
    tribo_vec3_cross(a, a, aa);
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, ab[i] == -ba[i] && aa[i] == 0.0);
    }
    const double size = norm3(a) * norm3(b);
    REQUIRE_AT_MOST(t, fabs(tribo_vec3_dot(a, ab)), 8.0 * EPS * size * norm3(a));
    REQUIRE_AT_MOST(t, fabs(tribo_vec3_dot(b, ab)), 8.0 * EPS * size * norm3(b));
    tribo_vec3_cross(a, b, a);
    REQUIRE_SAME(t, a, ab, sizeof a);
}

static void vec3_norm(property_trial *t)
{
    double a[3];
    make_finite_vector(t, "a", a);
    const long double x = wide(a[0]);
    const long double y = wide(a[1]);
    const long double z = wide(a[2]);
    const long double want = sqrtl(x * x + y * y + z * z);
    const double got = tribo_vec3_norm(a);
    if (want > 1.0000000001L * wide(DBL_MAX)) {
        REQUIRE(t, got == HUGE_VAL);
    } else if (want < 0.9999999999L * wide(DBL_MAX)) {
        REQUIRE_NEAR(t, got, want, 2.0L * wide(EPS) * want + 0x1p-1074L);
    }
}

static void vec3_normalize(property_trial *t)
{
    double a[3];
    double out[3];
    make_finite_vector(t, "a", a);
    canary_set(out, sizeof out);
    const tribo_status status = tribo_vec3_normalize(a, out);
    if (a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0) {
        REQUIRE(t, status == TRIBO_ERROR_RANGE && canary_kept(out, sizeof out));
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    const long double size =
        sqrtl(wide(a[0]) * wide(a[0]) + wide(a[1]) * wide(a[1]) + wide(a[2]) * wide(a[2]));
    const long double want[3] = {wide(a[0]) / size, wide(a[1]) / size, wide(a[2]) / size};
    REQUIRE_AT_MOST(t, worst3(out, want), 2.0 * EPS);
    REQUIRE_STATUS(t, tribo_vec3_normalize(a, a), TRIBO_OK);
    REQUIRE_SAME(t, a, out, sizeof a);
}

/* ---- matrices ----------------------------------------------------------------------------- */

static void mat3_multiply(property_trial *t)
{
    double a[9];
    double b[9];
    double out[9];
    make_matrix9(t, "a", a);
    make_matrix9(t, "b", b);
    tribo_mat3_multiply(a, b, out);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            long double sum = 0.0L;
            long double size = 0.0L;
            for (int k = 0; k < 3; k++) {
                const long double term = wide(a[3 * i + k]) * wide(b[3 * k + j]);
                sum += term;
                size += fabsl(term);
            }
            REQUIRE_NEAR(t, out[3 * i + j], sum, 3.0L * wide(EPS) * size);
        }
    }
    tribo_mat3_multiply(a, b, b);
    REQUIRE_SAME(t, b, out, sizeof b);
}

static void mat3_transpose_apply(property_trial *t)
{
    double a[9];
    double at[9];
    double back[9];
    double x[3];
    double left[3];
    double right[3];
    make_matrix9(t, "a", a);
    make_vector(t, "x", -30, 30, x);
    tribo_mat3_transpose(a, at);
    for (int i = 0; i < 9; i++) {
        REQUIRE(t, memcmp(&at[i], &a[3 * (i % 3) + i / 3], sizeof at[i]) == 0);
    }
    tribo_mat3_transpose(at, back);
    REQUIRE_SAME(t, back, a, sizeof a);
    tribo_mat3_transpose(back, back);
    REQUIRE_SAME(t, back, at, sizeof at);
    tribo_mat3_apply(at, x, left);
    tribo_mat3_apply_transposed(a, x, right);
    REQUIRE_SAME(t, left, right, sizeof left);
    for (int i = 0; i < 3; i++) {
        REQUIRE(t, left[i] == at[3 * i] * x[0] + at[3 * i + 1] * x[1] + at[3 * i + 2] * x[2]);
    }
    tribo_mat3_apply_transposed(a, x, x);
    REQUIRE_SAME(t, x, right, sizeof x);
}

static void sym3_apply(property_trial *t)
{
    double s[6];
    double full[9];
    double x[3];
    double left[3];
    double right[3];
    make_vector(t, "s", -30, 30, s);
    make_vector(t, "s", -30, 30, s + 3);
    make_vector(t, "x", -30, 30, x);
    expand_symmetric(s, full);
    tribo_sym3_apply(s, x, left);
    tribo_mat3_apply(full, x, right);
    REQUIRE_SAME(t, left, right, sizeof left);
    tribo_sym3_apply(s, x, x);
    REQUIRE_SAME(t, x, left, sizeof x);
}

/* ---- skew products ------------------------------------------------------------------------ */

static void skew_matrix(property_trial *t)
{
    double r[3];
    double x[3];
    double s[9];
    double left[3];
    double right[3];
    make_finite_vector(t, "r", r);
    tribo_skew_matrix(r, s);
    for (int i = 0; i < 9; i++) {
        REQUIRE(t, s[i] + s[3 * (i % 3) + i / 3] == 0.0);
    }
    make_vector(t, "r", -60, 60, r);
    make_vector(t, "x", -60, 60, x);
    tribo_skew_matrix(r, s);
    tribo_mat3_apply(s, x, left);
    tribo_vec3_cross(r, x, right);
    REQUIRE_AT_MOST(t, distance3(left, right), 4.0 * EPS * norm3(r) * norm3(x));
}

static void skew_congruence(property_trial *t)
{
    double r[3];
    double a[6];
    double full[9];
    double out[6];
    double values[3];
    long double wanted[9];
    make_vector(t, "r", -20, 20, r);
    make_matrix(t, "a", a);
    tribo_skew_congruence(r, a, out);
    expand_symmetric(a, full);
    const long double s[9] = {0.0L,        -wide(r[2]), wide(r[1]), wide(r[2]), 0.0L,
                              -wide(r[0]), -wide(r[1]), wide(r[0]), 0.0L};
    for (int i = 0; i < 9; i++) {
        wanted[i] = 0.0L;
        for (int k = 0; k < 9; k++) {
            wanted[i] += s[3 * (k / 3) + i / 3] * wide(full[k]) * s[3 * (k % 3) + i % 3];
        }
    }
    reference_eigenvalues(a, values);
    const double scale = norm3(r) * norm3(r) * values[2];
    expand_symmetric(out, full);
    REQUIRE_AT_MOST(t, worst9(full, wanted), 16.0 * EPS * scale);
    reference_eigenvalues(out, values);
    REQUIRE_AT_MOST(t, -values[0], 16.0 * EPS * scale);
}

static void skew_cross_apply(property_trial *t)
{
    double r[3];
    double a[6];
    double x[3];
    double out[3];
    double image[3];
    double values[3];
    make_vector(t, "r", -20, 20, r);
    make_vector(t, "x", -20, 20, x);
    make_matrix(t, "a", a);
    reference_eigenvalues(a, values);
    tribo_skew_cross_apply(r, a, x, out);
    tribo_sym3_apply(a, x, image);
    tribo_vec3_cross(r, image, image);
    REQUIRE_AT_MOST(t, distance3(out, image), 8.0 * EPS * norm3(r) * values[2] * norm3(x));
    tribo_skew_cross_apply(r, a, x, x);
    REQUIRE_SAME(t, x, out, sizeof x);
}

/* ---- contact basis ------------------------------------------------------------------------ */

static double frame_error(const double b[9])
{
    double worst = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            long double dot = i == j ? -1.0L : 0.0L;
            for (int k = 0; k < 3; k++) {
                dot += wide(b[3 * i + k]) * wide(b[3 * j + k]);
            }
            const double d = (double)fabsl(dot);
            worst = d > worst || d != d ? d : worst;
        }
    }
    return worst;
}

static double determinant_error(const double b[9])
{
    long double sum = -1.0L;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        sum += wide(b[i]) * (wide(b[3 + j]) * wide(b[6 + k]) - wide(b[3 + k]) * wide(b[6 + j]));
    }
    return (double)fabsl(sum);
}

/* z turned to n about z x n, with the stated denominator. */
static void reference_basis(const double n[3], long double b[9])
{
    const long double x = wide(n[0]);
    const long double y = wide(n[1]);
    const long double z = wide(n[2]);
    const long double h = z < 0.0L ? (x * x + y * y) / (1.0L - z) : 1.0L + z;
    const long double frame[9] = {
        x, y, z, 1.0L - x * x / h, -x * y / h, -x, -x * y / h, 1.0L - y * y / h, -y};
    memcpy(b, frame, sizeof frame);
}

static void basis_frame(property_trial *t)
{
    double n[3];
    double b[9];
    long double want[9];
    make_normal(t, "n", n);
    REQUIRE_STATUS(t, tribo_basis_from_normal(n, b), TRIBO_OK);
    REQUIRE_SAME(t, b, n, sizeof n);
    REQUIRE_AT_MOST(t, frame_error(b), 8.0 * EPS);
    REQUIRE_AT_MOST(t, determinant_error(b), 8.0 * EPS);
    /* closer to the pole the squares leave the range of doubles, and the frame is the pole's */
    if (n[2] > 0.0 || n[0] * n[0] + n[1] * n[1] > 1.1e-300) {
        reference_basis(n, want);
        REQUIRE_AT_MOST(t, worst9(b, want), 8.0 * EPS);
    }
}

static void basis_axes(property_trial *t)
{
    static const double up[6] = {1, 0, 0, 0, 1, 0};
    static const double down[6] = {1, 0, 0, 0, -1, 0};
    double n[3] = {0.0, 0.0, 1.0};
    double b[9];
    const uint32_t axis = make_choice(t, "axis", 6);
    const uint8_t signs = make_byte(t);
    for (int i = 0; i < 3; i++) {
        n[i] = ((signs >> i) & 1) != 0 ? -0.0 : 0.0;
    }
    n[axis % 3] = axis < 3 ? 1.0 : -1.0;
    property_note(t, "n", n, 3);
    REQUIRE_STATUS(t, tribo_basis_from_normal(n, b), TRIBO_OK);
    REQUIRE_SAME(t, b, n, sizeof n);
    REQUIRE(t, frame_error(b) == 0.0 && determinant_error(b) == 0.0);
    for (int i = 0; i < 6 && axis % 3 == 2; i++) {
        REQUIRE(t, b[3 + i] == (axis < 3 ? up : down)[i]);
    }
}

/* The sign of a zero in n changes no value of the frame. */
static void basis_zeros(property_trial *t)
{
    double n[3];
    double m[3];
    double b[9];
    double c[9];
    make_normal(t, "n", n);
    n[make_choice(t, "zero", 2)] = 0.0;
    const double size = norm3(n);
    ASSUME(t, size > 0.01);
    for (int i = 0; i < 3; i++) {
        n[i] /= size;
        m[i] = n[i] == 0.0 ? -n[i] : n[i];
    }
    REQUIRE_STATUS(t, tribo_basis_from_normal(n, b), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_basis_from_normal(m, c), TRIBO_OK);
    for (int i = 0; i < 9; i++) {
        REQUIRE(t, b[i] == c[i]);
    }
}

/* |frame(m) - frame(n)| <= 4 (1 + 2 / |n + z|) |m - n|: turning about n grows near -z only. */
static void basis_continuous(property_trial *t)
{
    static const double pole[3] = {0, 0, -1};
    double n[3];
    double m[3];
    double b[9];
    double c[9];
    make_normal(t, "n", n);
    make_directions(t, "step", m, 3);
    const double step = ldexp(1.0, -2 - make_byte(t) % 50);
    for (int i = 0; i < 3; i++) {
        m[i] = n[i] + step * m[i];
    }
    REQUIRE_STATUS(t, tribo_vec3_normalize(m, m), TRIBO_OK);
    const double moved = distance3(n, m);
    const double off = distance3(n, pole);
    ASSUME(t, off > 4.0 * moved && off > 1e-6);
    REQUIRE_STATUS(t, tribo_basis_from_normal(n, b), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_basis_from_normal(m, c), TRIBO_OK);
    for (int i = 0; i < 3; i++) {
        REQUIRE_AT_MOST(t, distance3(b + 3 * i, c + 3 * i),
                        4.0 * (1.0 + 2.0 / off) * moved + 16.0 * EPS * (1.0 + 1.0 / off));
    }
}

static void basis_not_unit(property_trial *t)
{
    double n[3];
    double b[9];
    make_normal(t, "n", n);
    const double stretch = 1.0 + make_real(t, "stretch", -45, 4);
    for (int i = 0; i < 3; i++) {
        n[i] *= stretch;
    }
    const long double square =
        wide(n[0]) * wide(n[0]) + wide(n[1]) * wide(n[1]) + wide(n[2]) * wide(n[2]);
    const double excess = (double)fabsl(square - 1.0L);
    canary_set(b, sizeof b);
    const tribo_status status = tribo_basis_from_normal(n, b);
    if (excess > 1.01e-12) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_NORMAL);
        REQUIRE(t, canary_kept(b, sizeof b));
    } else if (excess < 0.99e-12) {
        REQUIRE_STATUS(t, status, TRIBO_OK);
        REQUIRE_AT_MOST(t, frame_error(b), 8.0 * EPS + 4.0 * excess);
    }
}

/* ---- quaternions -------------------------------------------------------------------------- */

static void quat_matrix(property_trial *t)
{
    double q[4];
    double r[9];
    double turned[9];
    long double want[9];
    make_quat(t, "q", q);
    const double stretch = make_positive(t, "stretch", -400, 400);
    for (int i = 0; i < 4; i++) {
        q[i] *= stretch;
    }
    reference_rotation(q, want);
    tribo_quat_to_mat3(q, r);
    REQUIRE_AT_MOST(t, worst9(r, want), 8.0 * EPS);
    REQUIRE_AT_MOST(t, frame_error(r), 16.0 * EPS);
    REQUIRE_AT_MOST(t, determinant_error(r), 16.0 * EPS);
    for (int i = 0; i < 4; i++) {
        q[i] = -q[i];
    }
    tribo_quat_to_mat3(q, turned);
    for (int i = 0; i < 9; i++) {
        REQUIRE(t, r[i] == turned[i]);
    }
}

static void quat_normalize(property_trial *t)
{
    double q[4];
    double out[4];
    make_finite_vector(t, "q", q);
    q[3] = make_finite(t, "q3");
    canary_set(out, sizeof out);
    const tribo_status status = tribo_quat_normalize(q, out);
    if (q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0) {
        REQUIRE(t, status == TRIBO_ERROR_RANGE && canary_kept(out, sizeof out));
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    long double square = 0.0L;
    for (int i = 0; i < 4; i++) {
        square += wide(q[i]) * wide(q[i]);
    }
    for (int i = 0; i < 4; i++) {
        REQUIRE_NEAR(t, out[i], wide(q[i]) / sqrtl(square), 2.0 * EPS);
    }
    REQUIRE_STATUS(t, tribo_quat_normalize(q, q), TRIBO_OK);
    REQUIRE_SAME(t, q, out, sizeof q);
}

/* R(ab) = R(a) R(b), and the conjugate is the inverse. */
static void quat_multiply(property_trial *t)
{
    double a[4];
    double b[4];
    double ab[4];
    double inverse[4];
    double unit[4];
    long double ra[9];
    long double rb[9];
    long double product[9];
    double rab[9];
    make_quat(t, "a", a);
    make_quat(t, "b", b);
    tribo_quat_multiply(a, b, ab);
    reference_rotation(a, ra);
    reference_rotation(b, rb);
    for (int i = 0; i < 9; i++) {
        const int row = i - i % 3;
        product[i] = 0.0L;
        for (int k = 0; k < 3; k++) {
            product[i] += ra[row + k] * rb[3 * k + i % 3];
        }
    }
    tribo_quat_to_mat3(ab, rab);
    REQUIRE_AT_MOST(t, worst9(rab, product), 16.0 * EPS);
    tribo_quat_conjugate(a, inverse);
    REQUIRE(t, inverse[0] == a[0] && inverse[1] == -a[1] && inverse[2] == -a[2] &&
                   inverse[3] == -a[3]);
    tribo_quat_multiply(a, inverse, unit);
    REQUIRE_NEAR(t, unit[0], 1.0, 4.0 * EPS);
    REQUIRE_AT_MOST(t, norm3(unit + 1), 4.0 * EPS);
    tribo_quat_multiply(a, b, b);
    REQUIRE_SAME(t, b, ab, sizeof b);
    tribo_quat_conjugate(a, a);
    REQUIRE_SAME(t, a, inverse, sizeof a);
}

static void quat_rotate(property_trial *t)
{
    double q[4];
    double x[3];
    double out[3];
    double back[3];
    long double r[9];
    long double want[3];
    make_quat(t, "q", q);
    make_vector(t, "x", -40, 40, x);
    const double size = norm3(x);
    reference_rotation(q, r);
    apply_wide(r, x, want);
    tribo_quat_rotate(q, x, out);
    REQUIRE_AT_MOST(t, worst3(out, want), 8.0 * EPS * size);
    REQUIRE_NEAR(t, norm3(out), size, 8.0 * EPS * size);
    tribo_quat_rotate_inverse(q, out, back);
    REQUIRE_AT_MOST(t, distance3(back, x), 16.0 * EPS * size);
    tribo_quat_rotate(q, x, x);
    REQUIRE_SAME(t, x, out, sizeof x);
    tribo_quat_rotate_inverse(q, x, x);
    REQUIRE_SAME(t, x, back, sizeof x);
}

static void quat_rotation_vector(property_trial *t)
{
    static const double identity[4] = {1, 0, 0, 0};
    double v[3];
    double q[4];
    make_vector(t, "v", -300, 8, v);
    const long double angle =
        sqrtl(wide(v[0]) * wide(v[0]) + wide(v[1]) * wide(v[1]) + wide(v[2]) * wide(v[2]));
    REQUIRE_STATUS(t, tribo_quat_from_rotation_vector(v, q), TRIBO_OK);
    REQUIRE_NEAR(t, q[0], cosl(angle / 2.0L), wide(EPS) * (4.0L + angle));
    for (int i = 0; i < 3; i++) {
        const long double ratio = angle == 0.0L ? 0.5L : sinl(angle / 2.0L) / angle;
        const long double want = ratio * wide(v[i]);
        REQUIRE_NEAR(t, q[i + 1], want,
                     wide(EPS) * (4.0L * fabsl(want) + angle * fabsl(wide(v[i])) * 0.5L));
    }
    if (angle < 3.14L) {
        REQUIRE_NEAR(t, tribo_quat_angle(identity, q), angle, 8.0L * wide(EPS) * angle);
    }
}

static void quat_rotation_range(property_trial *t)
{
    double v[3];
    double q[4];
    make_finite_vector(t, "v", v);
    const double angle = norm3(v);
    canary_set(q, sizeof q);
    const tribo_status status = tribo_quat_from_rotation_vector(v, q);
    if (angle > 1048577.0) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_RANGE);
        REQUIRE(t, canary_kept(q, sizeof q));
    } else if (angle < 1048575.0) {
        REQUIRE_STATUS(t, status, TRIBO_OK);
        REQUIRE_NEAR(t, q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 8.0 * EPS);
    }
}

/* The angle between a and a turned by v is |v|, whatever the lengths and signs. */
static void quat_angle(property_trial *t)
{
    double a[4];
    double b[4];
    double v[3];
    double turn[4];
    make_quat(t, "a", a);
    make_directions(t, "v", v, 3);
    const double size = ldexp(1.0, -make_byte(t) % 60);
    tribo_vec3_scale(size, v, v);
    const double angle = norm3(v);
    REQUIRE_STATUS(t, tribo_quat_from_rotation_vector(v, turn), TRIBO_OK);
    tribo_quat_multiply(a, turn, b);
    const double stretch = make_real(t, "stretch", -100, 100);
    ASSUME(t, stretch != 0.0);
    for (int i = 0; i < 4; i++) {
        b[i] *= stretch;
    }
    REQUIRE_NEAR(t, tribo_quat_angle(a, b), angle, 16.0 * EPS);
    REQUIRE_NEAR(t, tribo_quat_angle(b, a), angle, 16.0 * EPS);
    REQUIRE_AT_MOST(t, tribo_quat_angle(b, b), 4.0 * EPS);
}

/* ---- elementary functions ----------------------------------------------------------------- */

static double make_angle(property_trial *t)
{
    const uint8_t kind = make_byte(t);
    if (kind < 128) {
        /* next to a multiple of an eighth of a turn, where reduction must not cancel */
        const int64_t k = (int64_t)(make_bits(t, 3) % 1335088u);
        const double x = (double)(wide((double)k) * 0.785398163397448309615660845819875721L);
        const double ends[3] = {x, nextafter(x, 0.0), nextafter(x, 2e6)};
        const double chosen = ends[make_byte(t) % 3];
        return kind % 2 == 0 ? chosen : -chosen;
    }
    return kind < 192 ? make_real(t, NULL, -1074, 19) : 1048576.0 * make_signed(t, NULL);
}

static void sin_cos(property_trial *t)
{
    double s;
    double c;
    double s2;
    double c2;
    const double x = make_angle(t);
    property_note(t, "x", &x, 1);
    ASSUME(t, fabs(x) <= 1048576.0);
    tribo_sin_cos(x, &s, &c);
    const long double sine = sinl(wide(x));
    const long double cosine = cosl(wide(x));
    REQUIRE_NEAR(t, wide(s) - sine, 0.0, 2.0 * ulp(sine));
    REQUIRE_NEAR(t, wide(c) - cosine, 0.0, 2.0 * ulp(cosine));
    tribo_sin_cos(-x, &s2, &c2);
    REQUIRE(t, s2 == -s && c2 == c);
}

static void sin_cos_beyond(property_trial *t)
{
    double s;
    double c;
    double x = make_any(t, NULL);
    if (fabs(x) <= 1048576.0) {
        x = copysign(1048576.0 + make_positive(t, NULL, -20, 900), x);
    }
    ASSUME(t, !(fabs(x) <= 1048576.0));
    property_note(t, "x", &x, 1);
    tribo_sin_cos(x, &s, &c);
    REQUIRE(t, isnan(s) && isnan(c));
}

static void atan2_angle(property_trial *t)
{
    double y = make_finite(t, "y");
    double x = make_finite(t, "x");
    if (make_choice(t, "scaled", 2) == 1) {
        y = make_signed(t, "y");
        x = make_signed(t, "x");
    }
    const double got = tribo_atan2(y, x);
    const long double want = atan2l(wide(y), wide(x));
    REQUIRE_NEAR(t, wide(got) - want, 0.0, 2.0 * ulp(want));
    REQUIRE(t, fabs(got) <= 3.1415926535897936 && !signbit(got) == !signbit(y));
    REQUIRE(t, tribo_atan2(-y, x) == -got);
}

static void atan2_zeros(property_trial *t)
{
    const uint8_t signs = make_byte(t);
    const double zero = signs % 2 == 0 ? 0.0 : -0.0;
    const double x = (signs & 2) == 0 ? 0.0 : -0.0;
    const double size = make_positive(t, "size", -1074, 1023);
    const double cases[5][2] = {{zero, x}, {zero, size}, {zero, -size}, {size, x}, {-size, x}};
    for (int i = 0; i < 5; i++) {
        const double got = tribo_atan2(cases[i][0], cases[i][1]);
        const double want = atan2(cases[i][0], cases[i][1]);
        REQUIRE(t, got == want && !signbit(got) == !signbit(want));
    }
}

static void pow2_scale(property_trial *t)
{
    int exponent;
    const double x = make_finite(t, "x");
    const double s = tribo_pow2_scale(x);
    REQUIRE(t, frexp(s, &exponent) == 0.5 && s == tribo_pow2_scale(-x));
    const double scaled = s * fabs(x);
    if (x == 0.0) {
        REQUIRE(t, s == 1.0);
    } else if (fabs(x) > 0x1p1000) {
        REQUIRE(t, s == 0x1p-1000);
    } else if (fabs(x) < 0x1p-1000) {
        REQUIRE(t, s == 0x1p1000);
    } else {
        REQUIRE(t, scaled >= 1.0 && scaled < 2.0);
    }
}

/* ---- bad input ---------------------------------------------------------------------------- */

typedef tribo_status (*vector_function)(const double *in, double *out);

/* Null pointers and one entry that is no number: a status, and the output is untouched. */
static void bad_vector(property_trial *t)
{
    static const struct {
        vector_function call;
        size_t in;
        size_t out;
    } functions[] = {{tribo_vec3_normalize, 3, 3},
                     {tribo_basis_from_normal, 3, 9},
                     {tribo_quat_normalize, 4, 4},
                     {tribo_quat_from_rotation_vector, 3, 4}};
    double in[4];
    double out[9];
    const uint32_t which = make_choice(t, "function", 4);
    const vector_function call = functions[which].call;
    make_quat(t, "in", in);
    canary_set(out, sizeof out);
    REQUIRE_STATUS(t, call(NULL, out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, call(in, NULL), TRIBO_ERROR_NULL);
    in[make_choice(t, "entry", (uint32_t)functions[which].in)] = make_hostile(t, "value");
    REQUIRE_STATUS(t, call(in, out), TRIBO_ERROR_NOT_FINITE);
    REQUIRE_STATUS(t, call(in, NULL), TRIBO_ERROR_NULL);
    REQUIRE(t, canary_kept(out, sizeof out));
}

const char *const property_room = "math";
const property property_list[] = {
    {"vec3_formulae", vec3_formulae, 1},
    {"vec3_cross", vec3_cross, 1},
    {"vec3_norm", vec3_norm, 1},
    {"vec3_normalize", vec3_normalize, 1},
    {"mat3_multiply", mat3_multiply, 1},
    {"mat3_transpose_apply", mat3_transpose_apply, 1},
    {"sym3_apply", sym3_apply, 1},
    {"skew_matrix", skew_matrix, 1},
    {"skew_congruence", skew_congruence, 1},
    {"skew_cross_apply", skew_cross_apply, 1},
    {"basis_frame", basis_frame, 1},
    {"basis_axes", basis_axes, 1},
    {"basis_zeros", basis_zeros, 1},
    {"basis_continuous", basis_continuous, 1},
    {"basis_not_unit", basis_not_unit, 1},
    {"quat_matrix", quat_matrix, 1},
    {"quat_normalize", quat_normalize, 1},
    {"quat_multiply", quat_multiply, 1},
    {"quat_rotate", quat_rotate, 1},
    {"quat_rotation_vector", quat_rotation_vector, 1},
    {"quat_rotation_range", quat_rotation_range, 1},
    {"quat_angle", quat_angle, 1},
    {"sin_cos", sin_cos, 1},
    {"sin_cos_beyond", sin_cos_beyond, 1},
    {"atan2_angle", atan2_angle, 1},
    {"atan2_zeros", atan2_zeros, 1},
    {"pow2_scale", pow2_scale, 1},
    {"bad_vector", bad_vector, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 40000;
