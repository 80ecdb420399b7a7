/* Structured input from bytes; see make.h. */
#include "make.h"

#include <math.h>
#include <string.h>

#include "reference.h"

/* ---- normals and quaternions -------------------------------------------------------------- */

static void normalise(double *v, int count, int plain)
{
    long double square = 0.0L;
    for (int i = 0; i < count; i++) {
        square += (long double)v[i] * (long double)v[i];
    }
    if (square < 1e-6L) {
        memset(v, 0, (size_t)count * sizeof *v);
        v[plain] = 1.0;
        return;
    }
    const long double length = sqrtl(square);
    for (int i = 0; i < count; i++) {
        v[i] = (double)((long double)v[i] / length);
    }
}

/* Exponents of the small components beside an axis; few of them are where squares underflow. */
static int small_exponent(property_trial *t)
{
    const uint8_t kind = make_byte(t);
    const uint8_t size = make_byte(t);
    return kind % 4 == 1 ? -1074 + 4 * size : -1 - size % 56;
}

/* An axis, exactly or with small components beside it. */
static void near_axis(property_trial *t, int axis, double sign, int exact, double n[3])
{
    for (int i = 0; i < 3; i++) {
        const int exponent = small_exponent(t);
        const double mantissa = make_byte(t) % 2 == 0 ? 1.0 : -1.0;
        n[i] = exact ? copysign(0.0, mantissa)
                     : ldexp(mantissa * (1.0 + make_unit(t, NULL)), exponent);
    }
    n[axis] = sign;
}

void make_normal(property_trial *t, const char *name, double out[3])
{
    const uint8_t kind = make_byte(t);
    if (kind < 128) {
        make_directions(t, NULL, out, 3);
    } else if (kind < 160) {
        near_axis(t, kind % 3, kind % 2 == 0 ? 1.0 : -1.0, 1, out);
    } else if (kind < 208) {
        near_axis(t, 2, -1.0, 0, out);
    } else {
        near_axis(t, kind % 3, kind % 2 == 0 ? 1.0 : -1.0, 0, out);
    }
    normalise(out, 3, 2);
    property_note(t, name, out, 3);
}

void make_quat(property_trial *t, const char *name, double out[4])
{
    const uint8_t kind = make_byte(t);
    make_directions(t, NULL, out, 4);
    if (kind >= 192) {
        /* turns by multiples of a right angle about axes */
        for (int i = 0; i < 4; i++) {
            out[i] = out[i] > 0.25 ? 1.0 : out[i] < -0.25 ? -1.0 : 0.0;
        }
    }
    normalise(out, 4, 0);
    property_note(t, name, out, 4);
}

/* ---- bodies ------------------------------------------------------------------------------- */

static double inverse(double x)
{
    return 1.0 / x;
}

static void box_inertia(double mass, const double half[3], double inverse_inertia[6])
{
    memset(inverse_inertia, 0, 6 * sizeof(double));
    inverse_inertia[0] = inverse(mass / 3.0 * (half[1] * half[1] + half[2] * half[2]));
    inverse_inertia[3] = inverse(mass / 3.0 * (half[2] * half[2] + half[0] * half[0]));
    inverse_inertia[5] = inverse(mass / 3.0 * (half[0] * half[0] + half[1] * half[1]));
}

/* R A R^T, each entry once. */
static void turn_tensor(const double q[4], const double a[6], double out[6])
{
    static const int row[6] = {0, 0, 0, 1, 1, 2};
    static const int column[6] = {0, 1, 2, 1, 2, 2};
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    long double r[9];
    double turned[6];
    reference_rotation(q, r);
    for (int e = 0; e < 6; e++) {
        long double sum = 0.0L;
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                sum += r[3 * row[e] + i] * (long double)a[full[3 * i + j]] * r[3 * column[e] + j];
            }
        }
        turned[e] = (double)sum;
    }
    memcpy(out, turned, sizeof turned);
}

static void make_wide_inertia(property_trial *t, tribo_body *body, double half[3])
{
    const double mass = make_positive(t, NULL, -20, 20);
    const uint8_t shape = make_byte(t);
    for (int i = 0; i < 3; i++) {
        half[i] = make_positive(t, NULL, -7, 6);
    }
    if (shape % 4 == 1) {
        half[1] = half[2] = half[0];
    }
    body->inverse_mass = inverse(mass);
    box_inertia(mass, half, body->inverse_inertia);
    if (shape % 4 == 2) {
        /* thin rod with flanges: nearly no inertia about one axis */
        body->inverse_inertia[shape >= 128 ? 3 : 5] *= ldexp(1.0, (shape >> 2) % 34);
    }
    if (shape % 4 == 3) {
        double q[4];
        make_quat(t, "axes", q);
        turn_tensor(q, body->inverse_inertia, body->inverse_inertia);
    }
}

static void lock_axes(uint8_t which, tribo_body *body)
{
    static const int diagonal[3] = {0, 3, 5};
    body->inverse_inertia[1] = body->inverse_inertia[2] = body->inverse_inertia[4] = 0.0;
    for (int i = 0; i < 3; i++) {
        if (((which >> i) & 1) != 0) {
            body->inverse_inertia[diagonal[i]] = 0.0;
        }
    }
    if (which >= 224) {
        body->inverse_mass = 0.0;
    }
}

static void make_inertia(property_trial *t, uint32_t kind, tribo_body *body, double half[3])
{
    const uint8_t which = make_byte(t);
    memset(body->inverse_inertia, 0, sizeof body->inverse_inertia);
    if (kind == BODY_PLAIN || (kind == BODY_WIDE && which < 64)) {
        const double mass = make_positive(t, NULL, -4, 4);
        const double size = make_positive(t, NULL, -3, 1);
        for (int i = 0; i < 3; i++) {
            half[i] = size * (1.0 + 9.0 * make_unit(t, NULL));
        }
        body->inverse_mass = inverse(mass);
        box_inertia(mass, half, body->inverse_inertia);
        return;
    }
    make_wide_inertia(t, body, half);
    if (kind == BODY_ANY && which >= 128) {
        lock_axes(which, body);
    }
}

static void note_body(property_trial *t, const char *name, const tribo_body *body)
{
    if (t->log != NULL) {
        fprintf(t->log, "#   body %s\n", name);
        property_note(t, "position", body->position, 3);
        property_note(t, "orientation", body->orientation, 4);
        property_note(t, "velocity", body->velocity, 3);
        property_note(t, "angular_velocity", body->angular_velocity, 3);
        property_note(t, "inverse_mass", &body->inverse_mass, 1);
        property_note(t, "inverse_inertia", body->inverse_inertia, 6);
    }
}

static void make_body_quiet(property_trial *t, uint32_t kind, tribo_body *out, double half[3])
{
    FILE *log = t->log;
    t->log = NULL;
    memset(out, 0, sizeof *out);
    make_inertia(t, kind, out, half);
    make_quat(t, NULL, out->orientation);
    if (make_byte(t) >= 192) {
        const double stretch = 1.0 + 0.9e-6 * make_signed(t, NULL);
        for (int i = 0; i < 4; i++) {
            out->orientation[i] *= stretch;
        }
    }
    make_vector(t, NULL, -6, 2, out->velocity);
    make_vector(t, NULL, -6, 2, out->angular_velocity);
    make_vector(t, NULL, -4, 6, out->position);
    t->log = log;
}

void make_body(property_trial *t, const char *name, uint32_t kind, tribo_body *out, double half[3])
{
    make_body_quiet(t, kind, out, half);
    note_body(t, name, out);
}

void make_body_wild(property_trial *t, const char *name, tribo_body *out)
{
    double half[3];
    double *field = (double *)out;
    make_body_quiet(t, BODY_ANY, out, half);
    const uint8_t kind = make_byte(t);
    for (uint32_t i = 0; i < sizeof *out / sizeof *field; i++) {
        const int pose = i >= 3 && i < 7;
        if (kind >= 192 || (!pose && make_byte(t) % 8 == 1)) {
            field[i] = kind % 8 == 1 ? make_any(t, NULL) : make_finite(t, NULL);
        }
    }
    note_body(t, name, out);
}

/* An arm to a point of the body: a corner, a face or inside. */
static void make_arm(property_trial *t, const double q[4], const double half[3], double arm[3])
{
    long double r[9];
    double local[3];
    const uint8_t sides = make_byte(t);
    reference_rotation(q, r);
    for (int i = 0; i < 3; i++) {
        const double inside = make_signed(t, NULL);
        local[i] = half[i] * (((sides >> i) & 1) == 0 ? inside : inside < 0.0 ? -1.0 : 1.0);
    }
    for (int i = 0; i < 3; i++) {
        long double sum = 0.0L;
        for (int j = 0; j < 3; j++) {
            sum += r[3 * i + j] * (long double)local[j];
        }
        arm[i] = (double)sum;
    }
}

void make_scene(property_trial *t, uint32_t kind, scene *out)
{
    double half[3];
    double arm[3];
    memset(out, 0, sizeof *out);
    out->b.orientation[0] = 1.0;
    out->has_b = make_choice(t, NULL, 4) != 1;
    make_body_quiet(t, kind == BODY_ANY ? BODY_WIDE : kind, &out->a, half);
    make_arm(t, out->a.orientation, half, arm);
    for (int i = 0; i < 3; i++) {
        out->point[i] = out->a.position[i] + arm[i];
        out->contact.arm_a[i] = out->point[i] - out->a.position[i];
    }
    note_body(t, "a", &out->a);
    if (out->has_b) {
        make_body_quiet(t, kind, &out->b, half);
        make_arm(t, out->b.orientation, half, arm);
        for (int i = 0; i < 3; i++) {
            out->b.position[i] = out->point[i] - arm[i];
            out->contact.arm_b[i] = out->point[i] - out->b.position[i];
        }
        note_body(t, "b", &out->b);
    }
    make_normal(t, "normal", out->contact.normal);
    property_note(t, "arm_a", out->contact.arm_a, 3);
    property_note(t, "arm_b", out->contact.arm_b, 3);
}

/* ---- contact matrices --------------------------------------------------------------------- */

/* W of one or two bodies, in a frame that is the rows of some rotation. */
static void matrix_of_bodies(property_trial *t, uint32_t kind, double w[6])
{
    scene s;
    double q[4];
    double half[3];
    double frame[9];
    double bound;
    long double rows[9];
    memset(&s, 0, sizeof s);
    s.has_b = make_choice(t, NULL, 2);
    make_inertia(t, kind, &s.a, half);
    make_quat(t, NULL, s.a.orientation);
    make_arm(t, s.a.orientation, half, s.contact.arm_a);
    if (s.has_b) {
        make_inertia(t, kind, &s.b, half);
        make_quat(t, NULL, s.b.orientation);
        make_arm(t, s.b.orientation, half, s.contact.arm_b);
    }
    make_quat(t, NULL, q);
    reference_rotation(q, rows);
    for (int i = 0; i < 9; i++) {
        frame[i] = (double)rows[i];
    }
    reference_matrix(&s, frame, w, &bound);
}

static void matrix_needle(property_trial *t, double w[6])
{
    scene s;
    double half[3];
    double bound;
    static const double frame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    memset(&s, 0, sizeof s);
    make_inertia(t, BODY_PLAIN, &s.a, half);
    const int axis = make_byte(t) % 2 == 0 ? 3 : 5;
    s.a.inverse_inertia[axis] *= ldexp(1.0, make_byte(t) % 34);
    make_quat(t, NULL, s.a.orientation);
    make_arm(t, s.a.orientation, half, s.contact.arm_a);
    reference_matrix(&s, frame, w, &bound);
}

/* Q diag Q^T with one or two small eigenvalues. */
static void matrix_synthetic(property_trial *t, double w[6])
{
    double q[4];
    double diagonal[6] = {0};
    diagonal[0] = ldexp(1.0, make_exponent(t, -10, 10));
    diagonal[3] = diagonal[0] * (1.0 - 0.75 * make_unit(t, NULL));
    diagonal[5] = ldexp(diagonal[3], -(make_byte(t) % 40));
    if (make_byte(t) % 2 == 1) {
        diagonal[3] = ldexp(diagonal[3], -(make_byte(t) % 40));
    }
    make_quat(t, NULL, q);
    turn_tensor(q, diagonal, w);
}

static void matrix_sphere(property_trial *t, double w[6])
{
    memset(w, 0, 6 * sizeof(double));
    w[0] = 1.0 + make_byte(t) % 4;
    w[3] = 3.5;
    w[5] = make_byte(t) % 2 == 0 ? 3.5 : 1.0 + make_byte(t) % 8;
}

/* Sums of squares of sixteenths: exact. */
static void matrix_singular(property_trial *t, double w[6])
{
    double v[2][3] = {{0}};
    const uint32_t rank = 1 + make_choice(t, NULL, 2);
    for (uint32_t k = 0; k < rank; k++) {
        for (int i = 0; i < 3; i++) {
            v[k][i] = ((int)(make_byte(t) % 65) - 32) / 16.0;
        }
    }
    if (v[0][0] == 0.0) {
        v[0][0] = 1.0;
    }
    for (int i = 0, e = 0; i < 3; i++) {
        for (int j = i; j < 3; j++, e++) {
            w[e] = v[0][i] * v[0][j] + v[1][i] * v[1][j];
        }
    }
}

void make_matrix_of(property_trial *t, const char *name, uint32_t kind, double w[6])
{
    FILE *log = t->log;
    t->log = NULL;
    switch (kind) {
    case MATRIX_BOX:
        matrix_of_bodies(t, BODY_PLAIN, w);
        break;
    case MATRIX_WIDE:
        matrix_of_bodies(t, BODY_WIDE, w);
        break;
    case MATRIX_NEEDLE:
        matrix_needle(t, w);
        break;
    case MATRIX_SYNTHETIC:
        matrix_synthetic(t, w);
        break;
    case MATRIX_SINGULAR:
        matrix_singular(t, w);
        break;
    default:
        matrix_sphere(t, w);
        break;
    }
    t->log = log;
    property_note(t, name, w, 6);
}

void make_matrix(property_trial *t, const char *name, double w[6])
{
    make_matrix_of(t, name,
                   (MATRIX_SPHERE + make_choice(t, NULL, MATRIX_DEFINITE)) % MATRIX_DEFINITE, w);
}

/* ---- materials and velocities ------------------------------------------------------------- */

static double friction_quiet(property_trial *t)
{
    static const double plain[8] = {0.5, 0.0, 1.0, 0.3, 0.7, 1e-3, 1e3, 2.0};
    const uint8_t kind = make_byte(t);
    if (kind < 48) {
        return plain[kind % 8];
    }
    return kind < 160 ? 1.5 * make_unit(t, NULL) : make_positive(t, NULL, -10, 9);
}

double make_friction(property_trial *t, const char *name)
{
    const double mu = friction_quiet(t);
    property_note(t, name, &mu, 1);
    return mu;
}

void make_material(property_trial *t, const char *name, tribo_material *out)
{
    static const double plain[4] = {0.5, 0.0, 1.0, 0.25};
    const uint8_t kind = make_byte(t);
    out->mu_s = friction_quiet(t);
    out->mu_d = kind % 2 == 0 ? out->mu_s : out->mu_s * make_unit(t, NULL);
    out->e = kind < 96 ? plain[(kind >> 1) % 4] : make_unit(t, NULL);
    property_note(t, name, (const double *)out, 3);
}

/* -W p for an impulse on the border of the cone, within a few bits. */
static void border_velocity(property_trial *t, const double w[6], double mu, double b[3])
{
    static const double zero[3] = {0, 0, 0};
    double p[3];
    const double angle = 6.3 * make_unit(t, NULL);
    const double side = make_byte(t) % 2 == 0 ? 1.0 : -1.0;
    const double off = ldexp(side, -(make_byte(t) % 54));
    p[0] = 1.0;
    p[1] = mu * (1.0 + off) * cos(angle);
    p[2] = mu * (1.0 + off) * sin(angle);
    reference_velocity(w, zero, p, b);
    for (int i = 0; i < 3; i++) {
        b[i] = -b[i];
    }
}

void make_velocity(property_trial *t, const char *name, const double w[6], double mu, double out[3])
{
    const uint8_t kind = make_byte(t);
    double direction[2];
    make_directions(t, NULL, direction, 2);
    out[1] = direction[0];
    out[2] = direction[1];
    if (kind < 128) {
        out[0] = -make_positive(t, NULL, -10, 1);
    } else if (kind < 192) {
        border_velocity(t, w, mu, out);
    } else if (kind < 208) {
        out[0] = -make_positive(t, NULL, -60, -10);
    } else if (kind < 224) {
        out[0] = -make_positive(t, NULL, -2, 2);
        out[1] = out[2] = kind % 2 == 0 ? 0.0 : -0.0;
    } else {
        out[0] = make_real(t, NULL, -10, 2);
    }
    property_note(t, name, out, 3);
}
