#include "quad.h"

#include <math.h>
#include <string.h>

/* ---- numbers --------------------------------------------------------------------------------- */

static quad_real absolute(quad_real x)
{
    return x < 0 ? -x : x;
}

static quad_real larger(quad_real x, quad_real y)
{
    return x > y ? x : y;
}

quad_real quad_sqrt(quad_real x)
{
    quad_real scale = 1;
    if (!(x > 0)) {
        return 0;
    }
    if (x - x != 0) {
        return x;
    }
    /* into the range of double, by fourth powers of two that leave exact square roots */
    while (x > (quad_real)0x1p800) {
        x *= (quad_real)0x1p-800;
        scale *= (quad_real)0x1p400;
    }
    while (x < (quad_real)0x1p-800) {
        x *= (quad_real)0x1p800;
        scale *= (quad_real)0x1p-400;
    }
    quad_real y = (quad_real)sqrt((double)x);
    for (int k = 0; k < 2; k++) {
        y = (y + x / y) / 2;
    }
    return y * scale;
}

void quad_widen(size_t n, const double *x, quad_real *out)
{
    for (size_t i = 0; i < n; i++) {
        out[i] = (quad_real)x[i];
    }
}

static quad_real norm(size_t n, const quad_real *x)
{
    quad_real top = 0;
    quad_real sum = 0;
    for (size_t i = 0; i < n; i++) {
        top = larger(top, absolute(x[i]));
    }
    for (size_t i = 0; i < n && top > 0; i++) {
        sum += (x[i] / top) * (x[i] / top);
    }
    return top * quad_sqrt(sum);
}

double quad_relative_error(size_t n, const double *x, const quad_real *y)
{
    quad_real difference[16];
    for (size_t i = 0; i < n; i++) {
        difference[i] = (quad_real)x[i] - y[i];
    }
    const quad_real error = norm(n, difference);
    return error > 0 ? (double)(error / norm(n, y)) : 0.0;
}

static void apply(const quad_real w[6], const quad_real x[3], quad_real out[3])
{
    out[0] = w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
    out[1] = w[1] * x[0] + w[3] * x[1] + w[4] * x[2];
    out[2] = w[2] * x[0] + w[4] * x[1] + w[5] * x[2];
}

/* x = W^-1 y by cofactors; 0 if W is not positive definite. */
static int invert(const quad_real w[6], const quad_real y[3], quad_real x[3])
{
    const quad_real cofactor[6] = {w[3] * w[5] - w[4] * w[4], w[2] * w[4] - w[1] * w[5],
                                   w[1] * w[4] - w[2] * w[3], w[0] * w[5] - w[2] * w[2],
                                   w[1] * w[2] - w[0] * w[4], w[0] * w[3] - w[1] * w[1]};
    const quad_real determinant = w[0] * cofactor[0] + w[1] * cofactor[1] + w[2] * cofactor[2];
    if (!(determinant > 0)) {
        return 0;
    }
    apply(cofactor, y, x);
    for (size_t i = 0; i < 3; i++) {
        x[i] /= determinant;
    }
    return 1;
}

/* ---- eta ------------------------------------------------------------------------------------- */

/* Point of the cone nearest to x, in place. */
static void project(long double mu, long double x[3])
{
    const long double radius = sqrtl(x[1] * x[1] + x[2] * x[2]);
    if (mu * radius <= -x[0]) {
        x[0] = x[1] = x[2] = 0.0L;
    } else if (radius > mu * x[0]) {
        const long double normal = (x[0] + mu * radius) / (1.0L + mu * mu);
        x[1] *= mu * normal / radius;
        x[2] *= mu * normal / radius;
        x[0] = normal;
    }
}

void quad_project(const double x[3], double mu, long double out[3])
{
    for (size_t i = 0; i < 3; i++) {
        out[i] = (long double)x[i];
    }
    project((long double)mu, out);
}

static long double length(const long double x[3])
{
    return sqrtl(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

double quad_eta_of(const double w[6], const double b[3], double mu, const long double p[3])
{
    static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const double larger_of_two = w[0] > w[3] ? w[0] : w[3];
    const long double top = (long double)(w[5] > larger_of_two ? w[5] : larger_of_two);
    const long double m = (long double)mu;
    const long double step = 1.0L / (top * (m > 1.0L ? m : 1.0L));
    const long double velocity[3] = {(long double)b[0], (long double)b[1], (long double)b[2]};
    long double v[3];
    long double sizes[3] = {0.0L, 0.0L, 0.0L};
    long double x[3];
    memcpy(v, velocity, sizeof v);
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 3; j++) {
            const long double term = (long double)w[entry[i][j]] * p[j];
            v[i] += term;
            sizes[i] += fabsl(term);
        }
    }
    const long double scale = (length(velocity) + length(sizes)) / top;
    v[0] += m * sqrtl(v[1] * v[1] + v[2] * v[2]);
    for (size_t i = 0; i < 3; i++) {
        x[i] = p[i] - step * v[i];
    }
    project(m, x);
    for (size_t i = 0; i < 3; i++) {
        x[i] -= p[i];
    }
    return scale > 0.0L ? (double)(length(x) / scale) : 0.0;
}

double quad_eta(const double w[6], const double b[3], double mu, const double p[3])
{
    const long double wide[3] = {(long double)p[0], (long double)p[1], (long double)p[2]};
    return quad_eta_of(w, b, mu, wide);
}

/* ---- exact solve ----------------------------------------------------------------------------- */

/* Value at x of a polynomial, lowest power first. */
static quad_real value_at(const quad_real *polynomial, size_t degree, quad_real x)
{
    quad_real sum = polynomial[degree];
    for (size_t k = degree; k > 0; k--) {
        sum = sum * x + polynomial[k - 1];
    }
    return sum;
}

/* The root in [low, high], where the polynomial changes sign: bisection of the exponent, then
 * Illinois steps with bisection in between. */
static quad_real bracketed_root(const quad_real *polynomial, size_t degree, quad_real low,
                                quad_real high)
{
    const quad_real least = (quad_real)0x1p-120;
    quad_real at_low = value_at(polynomial, degree, low);
    quad_real at_high = value_at(polynomial, degree, high);
    if (!(at_high < 0) && !(at_high > 0)) {
        return high;
    }
    for (int k = 0; k < 400 && high - low > least * high; k++) {
        quad_real middle = (low + high) / 2;
        if (!(low > 0)) {
            middle = high * (quad_real)0x1p-90;
        } else if (high > 4 * low) {
            middle = quad_sqrt(low) * quad_sqrt(high);
        } else if (k % 3 != 0) {
            middle = low - at_low * ((high - low) / (at_high - at_low));
            middle = middle > low && middle < high ? middle : (low + high) / 2;
        }
        const quad_real there = value_at(polynomial, degree, middle);
        if ((there > 0) == (at_high > 0)) {
            high = middle;
            at_high = there;
            at_low /= 2;
        } else {
            low = middle;
            at_low = there;
            at_high /= 2;
        }
        if (!(there < 0) && !(there > 0)) {
            return middle;
        }
    }
    return (low + high) / 2;
}

/* Positive roots below `bound`, in rising order: between two neighbouring roots of the derivative
 * lies at most one. */
static size_t positive_roots(const quad_real *polynomial, size_t degree, quad_real bound,
                             quad_real roots[4])
{
    quad_real derivative[4];
    quad_real turns[6] = {0};
    size_t count = 0;
    if (degree == 0) {
        return 0;
    }
    for (size_t k = 1; k <= degree; k++) {
        derivative[k - 1] = polynomial[k] * (quad_real)(double)k;
    }
    const size_t turn_count = positive_roots(derivative, degree - 1, bound, turns + 1);
    turns[turn_count + 1] = bound;
    for (size_t k = 0; k <= turn_count; k++) {
        const quad_real left = value_at(polynomial, degree, turns[k]);
        const quad_real right = value_at(polynomial, degree, turns[k + 1]);
        if ((left < 0 && right >= 0) || (left > 0 && right <= 0)) {
            roots[count++] = bracketed_root(polynomial, degree, turns[k], turns[k + 1]);
        }
    }
    return count;
}

/* A bound on the roots' size: twice the greatest |q_k / q_n|^(1/(n-k)) (Fujiwara 1916). */
static quad_real root_bound(const quad_real quartic[5])
{
    const quad_real lead = absolute(quartic[4]);
    quad_real bound = absolute(quartic[3]) / lead;
    bound = larger(bound, quad_sqrt(absolute(quartic[2]) / lead));
    const quad_real fourth = quad_sqrt(quad_sqrt(absolute(quartic[0]) / lead));
    bound = larger(bound, fourth);
    /* without a cube root: x^(1/3) lies between x^(1/2) and x^(1/4) */
    const quad_real half = quad_sqrt(absolute(quartic[1]) / lead);
    bound = larger(bound, larger(half, quad_sqrt(half)));
    return 2 * bound;
}

static void add_solution(quad_solutions *out, uint32_t mode, const quad_real p[3], quad_real nu)
{
    out->mode[out->count] = mode;
    out->nu[out->count] = nu;
    memcpy(out->p[out->count], p, 3 * sizeof p[0]);
    out->count++;
}

/* Slip: with T = W_tt - w_t w_t^T / W_nn and D = det(T + nu 1), D p_n and D p_t are polynomials A
 * and B in nu, and mu^2 A^2 - |B|^2 = 0. */
static void add_slip(const quad_real w[6], const quad_real b[3], quad_real mu, quad_solutions *out)
{
    const quad_real t11 = w[3] - w[1] * w[1] / w[0];
    const quad_real t12 = w[4] - w[1] * w[2] / w[0];
    const quad_real t22 = w[5] - w[2] * w[2] / w[0];
    const quad_real c[2] = {w[1] * b[0] / w[0] - b[1], w[2] * b[0] / w[0] - b[2]};
    const quad_real d[2] = {t22 * c[0] - t12 * c[1], t11 * c[1] - t12 * c[0]};
    const quad_real determinant = t11 * t22 - t12 * t12;
    const quad_real a[3] = {-(b[0] * determinant + w[1] * d[0] + w[2] * d[1]) / w[0],
                            -(b[0] * (t11 + t22) + w[1] * c[0] + w[2] * c[1]) / w[0], -b[0] / w[0]};
    const quad_real square = mu * mu;
    const quad_real quartic[5] = {square * a[0] * a[0] - (d[0] * d[0] + d[1] * d[1]),
                                  2 * (square * a[0] * a[1] - (c[0] * d[0] + c[1] * d[1])),
                                  square * (a[1] * a[1] + 2 * a[0] * a[2]) -
                                      (c[0] * c[0] + c[1] * c[1]),
                                  2 * square * a[1] * a[2], square * a[2] * a[2]};
    quad_real roots[4];
    const size_t count = positive_roots(quartic, 4, root_bound(quartic), roots);
    for (size_t k = 0; k < count; k++) {
        const quad_real nu = roots[k];
        const quad_real divisor = (t11 + nu) * (t22 + nu) - t12 * t12;
        const quad_real p[3] = {value_at(a, 2, nu) / divisor, (d[0] + c[0] * nu) / divisor,
                                (d[1] + c[1] * nu) / divisor};
        if (p[0] > 0) {
            add_solution(out, TRIBO_MODE_SLIP, p, nu);
        }
    }
}

void quad_solve(const double w[6], const double b[3], double mu_s, double mu_d, quad_solutions *out)
{
    quad_real m[6];
    quad_real velocity[3];
    quad_real p[3] = {0, 0, 0};
    quad_widen(6, w, m);
    quad_widen(3, b, velocity);
    out->count = 0;
    if (velocity[0] >= 0) {
        add_solution(out, TRIBO_MODE_OPEN, p, 0);
    }
    if (invert(m, velocity, p)) {
        for (size_t i = 0; i < 3; i++) {
            p[i] = -p[i];
        }
        if (p[0] > 0 && norm(2, p + 1) <= (quad_real)mu_s * p[0]) {
            add_solution(out, TRIBO_MODE_STICK, p, 0);
        }
    }
    if (mu_d > 0.0 && (velocity[0] < 0 || velocity[0] > 0)) {
        add_slip(m, velocity, (quad_real)mu_d, out);
    } else if (velocity[0] < 0) {
        const quad_real frictionless[3] = {-velocity[0] / m[0], 0, 0};
        add_solution(out, TRIBO_MODE_SLIP, frictionless, 0);
    }
}

double quad_solution_error(const quad_solutions *solutions, const double p[3], size_t *nearest)
{
    double least = HUGE_VAL;
    for (size_t k = 0; k < solutions->count; k++) {
        const double error = quad_relative_error(3, p, solutions->p[k]);
        if (error < least) {
            least = error;
            if (nearest != NULL) {
                *nearest = k;
            }
        }
    }
    return least;
}

/* ---- condition ------------------------------------------------------------------------------- */

/* One Jacobi rotation of the symmetric a, of greatest entry 1, that clears a[i][j]. */
static void rotate(quad_real a[3][3], size_t i, size_t j)
{
    if (absolute(a[i][j]) <= (quad_real)0x1p-300) {
        return;
    }
    const size_t k = 3 - i - j;
    const quad_real slope = (a[j][j] - a[i][i]) / (2 * a[i][j]);
    const quad_real root = quad_sqrt(1 + slope * slope);
    const quad_real tangent = slope < 0 ? 1 / (slope - root) : 1 / (slope + root);
    const quad_real cosine = 1 / quad_sqrt(1 + tangent * tangent);
    const quad_real sine = tangent * cosine;
    const quad_real ik = cosine * a[i][k] - sine * a[j][k];
    const quad_real jk = sine * a[i][k] + cosine * a[j][k];
    a[i][i] -= tangent * a[i][j];
    a[j][j] += tangent * a[i][j];
    a[i][j] = a[j][i] = 0;
    a[i][k] = a[k][i] = ik;
    a[j][k] = a[k][j] = jk;
}

double quad_condition(const double w[6])
{
    quad_real m[6];
    quad_widen(6, w, m);
    const quad_real top = larger(m[0], larger(m[3], m[5]));
    quad_real a[3][3] = {{m[0] / top, m[1] / top, m[2] / top},
                         {m[1] / top, m[3] / top, m[4] / top},
                         {m[2] / top, m[4] / top, m[5] / top}};
    for (int sweep = 0; sweep < 8; sweep++) {
        rotate(a, 0, 1);
        rotate(a, 0, 2);
        rotate(a, 1, 2);
    }
    quad_real least = a[0][0];
    quad_real greatest = a[0][0];
    for (size_t i = 1; i < 3; i++) {
        least = a[i][i] < least ? a[i][i] : least;
        greatest = larger(greatest, a[i][i]);
    }
    return least > 0 ? (double)(greatest / least) : HUGE_VAL;
}

static long double frobenius(const long double w[6])
{
    const long double off = w[1] * w[1] + w[2] * w[2] + w[4] * w[4];
    return sqrtl(w[0] * w[0] + w[3] * w[3] + w[5] * w[5] + 2.0L * off);
}

double quad_condition_bound(const double w[6])
{
    long double m[6];
    for (size_t i = 0; i < 6; i++) {
        m[i] = (long double)w[i];
    }
    const long double cofactor[6] = {m[3] * m[5] - m[4] * m[4], m[2] * m[4] - m[1] * m[5],
                                     m[1] * m[4] - m[2] * m[3], m[0] * m[5] - m[2] * m[2],
                                     m[1] * m[2] - m[0] * m[4], m[0] * m[3] - m[1] * m[1]};
    const long double determinant = m[0] * cofactor[0] + m[1] * cofactor[1] + m[2] * cofactor[2];
    if (!(determinant > 0.0L)) {
        return HUGE_VAL;
    }
    return (double)(frobenius(m) * (frobenius(cofactor) / determinant));
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static void cross(const quad_real a[3], const quad_real b[3], quad_real out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static quad_real dot(const quad_real a[3], const quad_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* x from body to world axes (sign 1) or back (-1), the quaternion used as if normalised. */
static void turn(const double orientation[4], quad_real sign, const quad_real x[3],
                 quad_real out[3])
{
    quad_real q[4];
    quad_real once[3];
    quad_real twice[3];
    quad_widen(4, orientation, q);
    const quad_real axis[3] = {sign * q[1], sign * q[2], sign * q[3]};
    const quad_real square = q[0] * q[0] + dot(q + 1, q + 1);
    cross(axis, x, once);
    cross(axis, once, twice);
    for (size_t i = 0; i < 3; i++) {
        out[i] = x[i] + 2 * (q[0] * once[i] + twice[i]) / square;
    }
}

/* Inverse inertia in world axes applied to x. */
static void turn_by_inverse_inertia(const tribo_body *body, const quad_real x[3], quad_real out[3])
{
    quad_real inverse[6];
    quad_real in_body[3];
    quad_widen(6, body->inverse_inertia, inverse);
    turn(body->orientation, -1, x, in_body);
    apply(inverse, in_body, out);
    memcpy(in_body, out, sizeof in_body);
    turn(body->orientation, 1, in_body, out);
}

static void add_body(const tribo_body *body, const double arm[3], const double frame[9],
                     quad_real w[6])
{
    quad_real axes[9];
    quad_real lever[3];
    quad_real moment[3][3];
    quad_real spin[3][3];
    size_t entry = 0;
    quad_widen(9, frame, axes);
    quad_widen(3, arm, lever);
    for (size_t k = 0; k < 3; k++) {
        cross(lever, axes + 3 * k, moment[k]);
        turn_by_inverse_inertia(body, moment[k], spin[k]);
    }
    for (size_t k = 0; k < 3; k++) {
        for (size_t l = k; l < 3; l++) {
            w[entry] += dot(moment[k], spin[l]);
            w[entry] += (quad_real)body->inverse_mass * dot(axes + 3 * k, axes + 3 * l);
            entry++;
        }
    }
}

void quad_matrix(const tribo_body *a, const tribo_body *b, const tribo_contact *contact,
                 const double frame[9], quad_real w[6])
{
    for (size_t i = 0; i < 6; i++) {
        w[i] = 0;
    }
    add_body(a, contact->arm_a, frame, w);
    if (b != NULL) {
        add_body(b, contact->arm_b, frame, w);
    }
}

static void add_velocity(const tribo_body *body, const double arm[3], quad_real sign,
                         quad_real out[3])
{
    quad_real omega[3];
    quad_real lever[3];
    quad_real turning[3];
    quad_widen(3, body->angular_velocity, omega);
    quad_widen(3, arm, lever);
    cross(omega, lever, turning);
    for (size_t i = 0; i < 3; i++) {
        out[i] += sign * ((quad_real)body->velocity[i] + turning[i]);
    }
}

void quad_velocity(const tribo_body *a, const tribo_body *b, const tribo_contact *contact,
                   const double frame[9], quad_real u[3])
{
    quad_real relative[3] = {0, 0, 0};
    quad_real axes[9];
    quad_widen(9, frame, axes);
    add_velocity(a, contact->arm_a, 1, relative);
    if (b != NULL) {
        add_velocity(b, contact->arm_b, -1, relative);
    }
    for (size_t k = 0; k < 3; k++) {
        u[k] = dot(axes + 3 * k, relative);
    }
}

void quad_apply(const tribo_body *body, const double arm[3], const double frame[9],
                const quad_real p[3], double sign, quad_real velocity[6])
{
    quad_real axes[9];
    quad_real lever[3];
    quad_real impulse[3];
    quad_real moment[3];
    quad_real spin[3];
    quad_widen(9, frame, axes);
    quad_widen(3, arm, lever);
    for (size_t i = 0; i < 3; i++) {
        impulse[i] = axes[i] * p[0] + axes[3 + i] * p[1] + axes[6 + i] * p[2];
        impulse[i] *= (quad_real)sign;
    }
    cross(lever, impulse, moment);
    turn_by_inverse_inertia(body, moment, spin);
    for (size_t i = 0; i < 3; i++) {
        velocity[i] = (quad_real)body->velocity[i] + (quad_real)body->inverse_mass * impulse[i];
        velocity[3 + i] = (quad_real)body->angular_velocity[i] + spin[i];
    }
}

/* ---- impact laws ----------------------------------------------------------------------------- */

int quad_stick(const quad_real w[6], const quad_real u[3], quad_real p[3])
{
    const quad_real opposite[3] = {-u[0], -u[1], -u[2]};
    return invert(w, opposite, p);
}

void quad_frictionless(const quad_real w[6], const quad_real u[3], double e, quad_real p[3])
{
    p[0] = u[0] < 0 ? -(1 + (quad_real)e) * u[0] / w[0] : 0;
    p[1] = p[2] = 0;
}

/* The greatest kappa with |kappa D_t| <= mu ((1+e) P_In + kappa D_n), D = P_II - P_I. */
static quad_real greatest_kappa(quad_real mu, quad_real plastic, const quad_real step[3],
                                quad_real ceiling)
{
    const quad_real slope = norm(2, step + 1) - mu * step[0];
    const quad_real bound = mu * plastic;
    return slope * ceiling > bound ? bound / slope : ceiling;
}

quad_real quad_algebraic(const quad_real w[6], const quad_real u[3], const tribo_material *pair,
                         double tangential_restitution, quad_real p[3])
{
    quad_real sticking[3];
    const quad_real normal = -u[0] / w[0];
    const quad_real plastic = (1 + (quad_real)pair->e) * normal;
    const quad_real ceiling = 1 + (quad_real)tangential_restitution;
    p[0] = p[1] = p[2] = 0;
    if (!(u[0] < 0) || !quad_stick(w, u, sticking)) {
        return 0;
    }
    const quad_real step[3] = {sticking[0] - normal, sticking[1], sticking[2]};
    quad_real kappa = greatest_kappa((quad_real)pair->mu_s, plastic, step, ceiling);
    if (kappa < ceiling) {
        kappa = greatest_kappa((quad_real)pair->mu_d, plastic, step, ceiling);
    }
    p[0] = plastic + kappa * step[0];
    p[1] = kappa * step[1];
    p[2] = kappa * step[2];
    return kappa;
}
