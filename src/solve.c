#include "solve.h"

#include "cone.h"

/* ---- spectrum of a symmetric 2x2 matrix --------------------------------------------------------
 * */

typedef struct spectrum {
    double lam1, lam2; /* lam1 >= lam2 */
    double x, y;       /* unit eigenvector of lam1 */
} spectrum;

static spectrum decompose(double s11, double s12, double s22)
{
    spectrum e;
    /* (r + |d|, s12) is along lam1 if d >= 0, across it else: no cancellation. */
    const double d = 0.5 * (s11 - s22);
    const double r = sqrt(d * d + s12 * s12);
    const double along = r + absolute(d);
    const double length = sqrt(along * along + s12 * s12);
    const double major = length > 0.0 ? along / length : 1.0;
    const double minor = length > 0.0 ? s12 / length : 0.0;
    e.x = d >= 0.0 ? major : minor;
    e.y = d >= 0.0 ? minor : major;
    e.lam1 = 0.5 * (s11 + s22) + r;
    e.lam2 = e.lam1 > 0.0 ? (s11 * s22 - s12 * s12) / e.lam1 : 0.0;
    return e;
}

static void to_eigenbasis(const spectrum *e, double c1, double c2, double out[2])
{
    out[0] = e->x * c1 + e->y * c2;
    out[1] = e->x * c2 - e->y * c1;
}

static void from_eigenbasis(const spectrum *e, const double c[2], double out[2])
{
    out[0] = c[0] * e->x - c[1] * e->y;
    out[1] = c[0] * e->y + c[1] * e->x;
}

/* ---- bisection: any W ------------------------------------------------------------------------ */

/* Sliding subproblem (S + nu 1) p_t = c of a general problem. */
typedef struct slide {
    double s[4];
    double c[2];
    double scale; /* power of two that brings |c| into [1, 2); c is stored scaled */
    double size;  /* of what S was subtracted from: rounding of S is relative to it */
    double drive; /* of what c was subtracted from, scaled as c */
    double trace, largest;
    double unit;    /* power of two that brings the largest entry of S into [1, 2) */
    double det;     /* of unit S */
    double adj[2];  /* adj(unit S) c */
    int singular;   /* to rounding; then det is 0, and so is adj if c lies in the range of S */
    int consistent; /* c lies in the range of S, to rounding */
    int symmetric;
    spectrum spectrum; /* of a symmetric S, and c in its eigenbasis; rounding is cleared to 0 */
    double c_eigen[2];
} slide;

/* The product and its rounding error (Dekker). */
static void multiply_exactly(double a, double b, double *product, double *error)
{
    const double split_a = 134217729.0 * a; /* 2^27 + 1 */
    const double split_b = 134217729.0 * b;
    const double high_a = split_a - (split_a - a);
    const double high_b = split_b - (split_b - b);
    const double low_a = a - high_a;
    const double low_b = b - high_b;
    *product = a * b;
    *error = ((high_a * high_b - *product) + high_a * low_b + low_a * high_b) + low_a * low_b;
}

/* a d - b c to the last digits, whatever cancels. */
static double determinant(double a, double b, double c, double d)
{
    double left;
    double left_error;
    double right;
    double right_error;
    multiply_exactly(a, d, &left, &left_error);
    multiply_exactly(b, c, &right, &right_error);
    return (left - right) + (left_error - right_error);
}

static void find_adjugate(slide *e)
{
    const double most = greater(greater(absolute(e->s[0]), absolute(e->s[1])),
                                greater(absolute(e->s[2]), absolute(e->s[3])));
    const double unit = power_of_two(scale_exponent(most));
    const double s[4] = {unit * e->s[0], unit * e->s[1], unit * e->s[2], unit * e->s[3]};
    const double nothing = SINGULAR_TOLERANCE * (unit * e->size) * (unit * most);
    e->trace = e->s[0] + e->s[3];
    e->largest = most;
    e->unit = unit;
    e->det = determinant(s[0], s[1], s[2], s[3]);
    e->adj[0] = determinant(e->c[0], s[1], e->c[1], s[3]);
    e->adj[1] = determinant(s[0], e->c[0], s[2], e->c[1]);
    e->singular = !(absolute(e->det) > nothing);
    const double most_adj = greater(absolute(e->adj[0]), absolute(e->adj[1]));
    const double most_c = greater(absolute(e->c[0]), absolute(e->c[1]));
    const double no_drive = SINGULAR_TOLERANCE * e->drive;
    e->consistent = most > 0.0 ? most_adj <= no_drive * (unit * most) : most_c <= no_drive;
    if (e->singular) {
        e->det = 0.0;
        e->adj[0] = e->consistent ? 0.0 : e->adj[0];
        e->adj[1] = e->consistent ? 0.0 : e->adj[1];
    }
}

/* In the eigenbasis a singular S is no trouble: its null space just has the eigenvalue 0. */
static int solve_symmetric(const slide *e, double nu, double p[2])
{
    const double lam[2] = {e->spectrum.lam1 + nu, e->spectrum.lam2 + nu};
    double x[2];
    for (int i = 0; i < 2; i++) {
        if (e->c_eigen[i] != 0.0 && lam[i] == 0.0) {
            return 0;
        }
        x[i] = e->c_eigen[i] == 0.0 ? 0.0 : e->c_eigen[i] / lam[i];
    }
    from_eigenbasis(&e->spectrum, x, p);
    return 1;
}

/* p = (c nu + adj(S) c) / (nu^2 + trace nu + det): as smooth in nu as it is accurate, which
 * elimination in S + nu 1, where nu may be lost, is not. Numerator and denominator are divided by
 * nu plus the largest entry of S. Returns 0 where S + nu 1 is singular. */
static int solve_unsymmetric(const slide *e, double nu, double p[2])
{
    const double divisor = nu + e->largest;
    if (nu == 0.0 && e->singular) {
        if (e->consistent && divisor > 0.0) { /* the shortest solution is along S^T c */
            const double s[4] = {e->unit * e->s[0], e->unit * e->s[1], e->unit * e->s[2],
                                 e->unit * e->s[3]};
            const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
            p[0] = (s[0] * e->c[0] + s[2] * e->c[1]) / square * e->unit;
            p[1] = (s[1] * e->c[0] + s[3] * e->c[1]) / square * e->unit;
        }
        return e->consistent;
    }
    const double share = nu / divisor;
    const double rest = 1.0 / (e->unit * divisor);
    const double pivot = share * (nu + e->trace) + e->det * rest / e->unit;
    p[0] = (e->c[0] * share + e->adj[0] * rest) / pivot;
    p[1] = (e->c[1] * share + e->adj[1] * rest) / pivot;
    return p[0] - p[0] == 0.0 && p[1] - p[1] == 0.0;
}

/* The shortest solution where there are many; 0 where there is none. A right-hand side of zero has
 * the solution zero whatever S is. */
static int solve_shifted(const slide *e, double nu, double p[2])
{
    p[0] = p[1] = 0.0;
    if (e->c[0] == 0.0 && e->c[1] == 0.0) {
        return 1;
    }
    return e->symmetric ? solve_symmetric(e, nu, p) : solve_unsymmetric(e, nu, p);
}

static double normal_impulse(const solve_general *g, const slide *e, const double p[2])
{
    return -(g->bn + (g->row[0] * p[0] + g->row[1] * p[1]) / e->scale) / g->nn;
}

/* mu p_n - |p_t| at this nu, times 1 + nu against underflow of p_t where nu is huge; negative to
 * the left of the root, and where S + nu 1 is singular. */
static double friction_gap(const solve_general *g, const slide *e, double mu, double nu)
{
    double p[2];
    if (!solve_shifted(e, nu, p)) {
        return -1.0;
    }
    const double x = (1.0 + nu) * p[0];
    const double y = (1.0 + nu) * p[1];
    return (1.0 + nu) * normal_impulse(g, e, p) * mu * e->scale - sqrt(x * x + y * y);
}

static int friction_suffices(const solve_general *g, const slide *e, double mu, double nu)
{
    return friction_gap(g, e, mu, nu) >= 0.0;
}

/* Bisection on the bit pattern halves the number of doubles between the ends: at most 64 steps, to
 * the last bit. */
static double bisect(const solve_general *g, const slide *e, double mu, double low, double high,
                     uint32_t *iterations)
{
    uint64_t low_bits = bits_of(low);
    uint64_t high_bits = bits_of(high);
    while (high_bits - low_bits > 1) {
        const uint64_t middle = low_bits + (high_bits - low_bits) / 2;
        if (friction_suffices(g, e, mu, double_of(middle))) {
            high_bits = middle;
        } else {
            low_bits = middle;
        }
        ++*iterations;
    }
    return double_of(high_bits);
}

/* A nu in (low, high) at which the gap is negative, by golden section; else 0. */
static double find_dip(const solve_general *g, const slide *e, double mu, double low, double high,
                       uint32_t *iterations)
{
    const double golden = 0.61803398874989485;
    for (int step = 0; step < 64; step++) {
        const double left = high - golden * (high - low);
        const double right = low + golden * (high - low);
        const double gap_left = friction_gap(g, e, mu, left);
        const double gap_right = friction_gap(g, e, mu, right);
        ++*iterations;
        if (gap_left < 0.0 || gap_right < 0.0) {
            return gap_left < 0.0 ? left : right;
        }
        low = gap_left > gap_right ? left : low;
        high = gap_left > gap_right ? high : right;
    }
    return 0.0;
}

/* A nu in (low, high) at which friction does not suffice although it does at both ends: steps of an
 * eighth of an octave, and a closer look at each dip. 0 if there is none. */
static double find_slip(const solve_general *g, const slide *e, double mu, double low, double high,
                        uint32_t *iterations)
{
    const double ratio = 1.0905077326652577; /* 2^(1/8) */
    double gap[2] = {friction_gap(g, e, mu, low), friction_gap(g, e, mu, ratio * low)};
    for (double nu = ratio * ratio * low; nu < high; nu *= ratio) {
        const double next = friction_gap(g, e, mu, nu);
        ++*iterations;
        if (gap[1] < 0.0) {
            return nu / ratio;
        }
        if (gap[1] <= gap[0] && gap[1] <= next) {
            const double dip = find_dip(g, e, mu, nu / (ratio * ratio), nu, iterations);
            if (dip > 0.0) {
                return dip;
            }
        }
        gap[0] = gap[1];
        gap[1] = next;
    }
    return 0.0;
}

/* As nu falls to 0 on a singular S, p_t grows without bound along one direction. Does friction
 * suffice for it in the end? */
static int null_direction_holds(const solve_general *g, const slide *e, double mu)
{
    double q[2] = {e->adj[0], e->adj[1]};
    if (e->symmetric) {
        const double null[2] = {e->spectrum.lam1 == 0.0 ? e->c_eigen[0] : 0.0,
                                e->spectrum.lam2 == 0.0 ? e->c_eigen[1] : 0.0};
        from_eigenbasis(&e->spectrum, null, q);
    } else if (e->largest == 0.0) {
        q[0] = e->c[0];
        q[1] = e->c[1];
    }
    return mu * -(g->row[0] * q[0] + g->row[1] * q[1]) >= g->nn * planar_length(q[0], q[1]);
}

/* A nu at which friction does not suffice, left of one at which it does; negative: there is none,
 * the contact jams. Where S is singular, a root below its rounding counts only if there is one
 * however small nu is made. */
static double lower_bound(const solve_general *g, const slide *e, double mu, double high,
                          uint32_t *iterations)
{
    double p[2];
    const double low = 8.0 * SINGULAR_TOLERANCE * e->size;
    if (solve_shifted(e, 0.0, p)) {
        return 0.0;
    }
    if (!friction_suffices(g, e, mu, low)) {
        return low;
    }
    if (!null_direction_holds(g, e, mu)) {
        return 0.0;
    }
    const double dip = find_slip(g, e, mu, low, high, iterations);
    return dip > 0.0 ? dip : -1.0;
}

/* Beyond this nu, |p_t| <= |c| / (nu - |S|) is too short to leave the cone. */
static double upper_bound(const solve_general *g, const slide *e, double mu)
{
    const double c = sqrt(e->c[0] * e->c[0] + e->c[1] * e->c[1]);
    const double row = sqrt(g->row[0] * g->row[0] + g->row[1] * g->row[1]);
    const double drive = mu * -g->bn;
    const double bound = 4.0 * (c / e->scale * (g->nn + mu * row) / drive + e->size);
    return bound < 8.9e307 ? bound : 8.9e307;
}

/* Spectrum of S and c in it; eigenvalues that rounding may have made, and what c has along them by
 * rounding, count as 0. */
static void clear_rounding(slide *e)
{
    const double nothing = SINGULAR_TOLERANCE * e->size;
    const double no_drive = SINGULAR_TOLERANCE * e->drive;
    e->spectrum = decompose(e->s[0], e->s[1], e->s[3]);
    to_eigenbasis(&e->spectrum, e->c[0], e->c[1], e->c_eigen);
    double *lam[2] = {&e->spectrum.lam1, &e->spectrum.lam2};
    for (int i = 0; i < 2; i++) {
        const int singular = *lam[i] <= nothing;
        *lam[i] = singular ? 0.0 : *lam[i];
        e->c_eigen[i] = singular && absolute(e->c_eigen[i]) <= no_drive ? 0.0 : e->c_eigen[i];
    }
}

static int make_slide(const solve_general *g, slide *e)
{
    const double l0 = g->column[0] / g->nn;
    const double l1 = g->column[1] / g->nn;
    const double size =
        absolute(g->d[0]) + absolute(g->d[3]) + absolute(l0 * g->row[0]) + absolute(l1 * g->row[1]);
    e->s[0] = g->d[0] - l0 * g->row[0];
    e->s[1] = g->d[1] - l0 * g->row[1];
    e->s[2] = g->d[2] - l1 * g->row[0];
    e->s[3] = g->d[3] - l1 * g->row[1];
    e->size = size;
    double c[2] = {l0 * g->bn - g->b[0], l1 * g->bn - g->b[1]};
    const double scale = power_of_two(scale_exponent(greater(absolute(c[0]), absolute(c[1]))));
    e->scale = scale;
    e->drive = scale * (absolute(g->b[0]) + absolute(g->b[1]) +
                        (absolute(l0) + absolute(l1)) * absolute(g->bn));
    e->c[0] = scale * c[0];
    e->c[1] = scale * c[1];
    find_adjugate(e);
    e->symmetric = g->row[0] == g->column[0] && g->row[1] == g->column[1] && g->d[1] == g->d[2];
    /* Friction must not be able to gain energy by itself: the symmetric part is semidefinite. */
    const double off = 0.5 * (e->s[1] + e->s[2]);
    const double least = -SEMIDEFINITE_TOLERANCE * size;
    return e->s[0] >= least && e->s[3] >= least && e->s[0] * e->s[3] - off * off >= least * size;
}

static void write_impulse(const solve_general *g, const slide *e, double mu, int slips,
                          const double p[2], double out[3])
{
    const double normal = normal_impulse(g, e, p);
    const double length = planar_length(p[0], p[1]) / e->scale;
    double f = 1.0;
    out[0] = normal;
    if (slips && mu >= 1.0) {
        out[0] = length / mu;
    } else if (length > mu * normal || (slips && length > 0.0)) {
        f = mu * normal / length;
    }
    out[1] = f * p[0] / e->scale;
    out[2] = f * p[1] / e->scale;
}

/* 1 if p solves the problem to 1e-9 of the velocities that it is made of: v_n = 0 and v_t = -nu
 * p_t. On a W that is singular to rounding, an answer may look right on the way and be none. */
static int is_certified(const solve_general *g, const double p[3], double nu)
{
    const double rows[3][3] = {{g->nn, g->row[0], g->row[1]},
                               {g->column[0], g->d[0], g->d[1]},
                               {g->column[1], g->d[2], g->d[3]}};
    const double b[3] = {g->bn, g->b[0], g->b[1]};
    double error = 0.0;
    double scale = 0.0;
    /* Friction near the least doubles has no digits left to judge nu by. */
    const int rows_judged = nu > 0.0 && planar_length(p[1], p[2]) < 1e-290 ? 1 : 3;
    for (int i = 0; i < rows_judged; i++) {
        double v = b[i] + (i > 0 ? nu * p[i] : 0.0);
        scale += absolute(b[i]);
        for (int j = 0; j < 3; j++) {
            v += rows[i][j] * p[j];
            scale += absolute(rows[i][j] * p[j]);
        }
        error = greater(error, absolute(v));
    }
    return error <= 1e-9 * scale;
}

/* Any problem whose slide has been made. */
static double solve_by_bisection(const solve_general *problem, slide *e, double mu_s, double mu_d,
                                 double p[3], double *nu, uint32_t *iterations)
{
    double p_t[2] = {0.0, 0.0};
    p[0] = p[1] = p[2] = 0.0;
    *nu = 0.0;
    if (problem->bn >= 0.0) {
        return KERNEL_OPEN;
    }
    if (e->symmetric) {
        clear_rounding(e);
    }
    if (mu_s == 0.0) {
        write_impulse(problem, e, 0.0, 0, p_t, p);
        return absolute(e->c[0]) + absolute(e->c[1]) > SINGULAR_TOLERANCE * e->drive ? KERNEL_SLIP
                                                                                     : KERNEL_STICK;
    }
    ++*iterations;
    if (friction_suffices(problem, e, mu_s, 0.0)) {
        solve_shifted(e, 0.0, p_t);
        write_impulse(problem, e, mu_s, 0, p_t, p);
        return is_certified(problem, p, 0.0) ? KERNEL_STICK : KERNEL_MATRIX;
    }
    if (mu_d == 0.0) {
        write_impulse(problem, e, 0.0, 0, p_t, p);
        return KERNEL_SLIP;
    }
    const double high = upper_bound(problem, e, mu_d);
    if (!friction_suffices(problem, e, mu_d, high)) {
        /* The root lies beyond the doubles, and so friction below them. */
        write_impulse(problem, e, 0.0, 0, p_t, p);
        *nu = high;
        return KERNEL_SLIP;
    }
    const double low = lower_bound(problem, e, mu_d, high, iterations);
    if (low < 0.0) {
        return KERNEL_JAM;
    }
    *nu = bisect(problem, e, mu_d, low, high, iterations);
    if (!solve_shifted(e, *nu, p_t)) {
        return KERNEL_JAM;
    }
    write_impulse(problem, e, mu_d, 1, p_t, p);
    return is_certified(problem, p, *nu) ? KERNEL_SLIP : KERNEL_MATRIX;
}

/* ---- spectral path: W as ill-conditioned as may be, but regular ---------------------------------
 * */

/* S in its eigenbasis: what costs a little more than adj(S) and keeps its digits down to the last.
 * */
typedef struct eigen_problem {
    spectrum s;
    double c1, c2, w1, w2;
} eigen_problem;

static eigen_problem rotate_problem(const kernel_problem *k, const kernel_schur *s)
{
    eigen_problem e;
    double c[2];
    double w[2];
    e.s = decompose(s->s11, s->s12, s->s22);
    to_eigenbasis(&e.s, s->c1, s->c2, c);
    to_eigenbasis(&e.s, k->n1, k->n2, w);
    e.c1 = c[0];
    e.c2 = c[1];
    e.w1 = w[0];
    e.w2 = w[1];
    return e;
}

/* The slip equation from its terms in the eigenbasis; returns 1 if sticking is within the cone of
 * mu_s. */
static int pose_spectral(const kernel_problem *k, const eigen_problem *e, double mu_s, double mu_d,
                         kernel_slip *out)
{
    const double coupling1 = e->w1 * e->c1;
    const double coupling2 = e->w2 * e->c2;
    const double square1 = k->nn * k->nn * (e->c1 * e->c1);
    const double square2 = k->nn * k->nn * (e->c2 * e->c2);
    const double base_b = -k->bn * (e->s.lam1 + e->s.lam2) - coupling1 - coupling2;
    const double base_c =
        -k->bn * (e->s.lam1 * e->s.lam2) - coupling1 * e->s.lam2 - coupling2 * e->s.lam1;
    out->A = -mu_d * k->bn;
    out->B = mu_d * base_b;
    out->C = mu_d * base_c;
    out->alpha = square1 + square2;
    out->beta = square1 * e->s.lam2 + square2 * e->s.lam1;
    out->gamma = square1 * (e->s.lam2 * e->s.lam2) + square2 * (e->s.lam1 * e->s.lam1);
    out->least = e->s.lam2;
    return mu_s * base_c >= kernel_guess(out);
}

static void finish_spectral(const kernel_problem *k, const eigen_problem *e, double nu, int slips,
                            double mu, double p[3])
{
    const double p1 = e->c1 / (e->s.lam1 + nu);
    const double p2 = e->c2 / (e->s.lam2 + nu);
    const double length = sqrt(p1 * p1 + p2 * p2);
    const double normal = -(k->bn + (e->w1 * p1 + e->w2 * p2)) / k->nn;
    const double f = !slips && length > mu * normal ? mu * normal / length : 1.0;
    p[0] = slips ? length / mu : normal;
    const double p_eigen[2] = {f * p1, f * p2};
    from_eigenbasis(&e->s, p_eigen, p + 1);
}

static int settle(kernel_slip *e, double *nu, uint32_t *iterations)
{
    int settled = 0;
    *nu = e->nu;
    for (int step = 0; step < MAX_HALLEY && !settled; step++) {
        settled = kernel_halley(e, nu);
        ++*iterations;
    }
    return settled;
}

/* ---- what the branch-free path leaves -------------------------------------------------------- */

static double find_fault(const kernel_problem *k, double mu_s, double mu_d)
{
    if (k->fault == KERNEL_NOT_FINITE || !(mu_s - mu_s == 0.0) || !(mu_d - mu_d == 0.0)) {
        return KERNEL_NOT_FINITE;
    }
    if (k->fault == KERNEL_RANGE) {
        return KERNEL_RANGE;
    }
    return mu_d < 0.0 || mu_s < mu_d ? KERNEL_FRICTION : k->fault;
}

static int is_usual(const kernel_problem *k, const eigen_problem *e, double mu_s, double mu_d)
{
    return e->s.lam2 > SINGULAR_TOLERANCE * (k->t11 + k->t22) && mu_d >= FAST_MIN &&
           mu_s <= FAST_MAX && -k->bn >= FAST_MIN &&
           greater(absolute(e->c1), absolute(e->c2)) >= FAST_MIN_DRIVE;
}

static double bisect_symmetric(const kernel_problem *k, double mu_s, double mu_d, double p[3],
                               double *nu, uint32_t *iterations)
{
    const solve_general g = {
        k->nn, {k->n1, k->n2}, {k->n1, k->n2}, {k->t11, k->t12, k->t12, k->t22},
        k->bn, {k->b1, k->b2},
    };
    slide e;
    if (!make_slide(&g, &e)) {
        return KERNEL_MATRIX;
    }
    return solve_by_bisection(&g, &e, mu_s, mu_d, p, nu, iterations);
}

static double solve_odd(const kernel_problem *k, double mu_s, double mu_d, double p[3], double *nu,
                        uint32_t *iterations)
{
    const double fault = find_fault(k, mu_s, mu_d);
    if (fault != KERNEL_OPEN) {
        return fault;
    }
    kernel_schur s;
    kernel_slip slip;
    kernel_reduce(k, &s);
    const eigen_problem e = rotate_problem(k, &s);
    const double least = -SEMIDEFINITE_TOLERANCE * (k->t11 + k->t22);
    if (s.s11 < least || s.s22 < least || e.s.lam2 < least || e.s.lam1 < least) {
        return KERNEL_MATRIX;
    }
    if (k->bn < 0.0 && is_usual(k, &e, mu_s, mu_d)) {
        if (pose_spectral(k, &e, mu_s, mu_d, &slip)) {
            finish_spectral(k, &e, 0.0, 0, mu_s, p);
            return KERNEL_STICK;
        }
        if (settle(&slip, nu, iterations)) {
            finish_spectral(k, &e, *nu, 1, mu_d, p);
            return KERNEL_SLIP;
        }
    }
    return bisect_symmetric(k, mu_s, mu_d, p, nu, iterations);
}

double solve_scaled(const kernel_problem *problem, double mu_s, double mu_d, double p[3],
                    double *nu, uint32_t *iterations)
{
    kernel_slip e;
    kernel_prepare(problem, mu_s, mu_d, &e);
    *nu = 0.0;
    *iterations = 0;
    p[0] = p[1] = p[2] = 0.0;
    if (e.mode == KERNEL_OPEN) {
        return KERNEL_OPEN;
    }
    if (e.mode == KERNEL_STICK) {
        kernel_finish(&e, 0.0, 0, p);
        return KERNEL_STICK;
    }
    if (e.mode == KERNEL_SLIP && settle(&e, nu, iterations)) {
        kernel_finish(&e, *nu, 1, p);
        return KERNEL_SLIP;
    }
    return solve_odd(problem, mu_s, mu_d, p, nu, iterations);
}

/* ---- any W, regular and of usual size: the same steps on the same equation -------------------- */

/* p_t = (c nu + e) / D and p_n = -(b_n + row . p_t) / a need no symmetry of S, so kernel_slip holds
 * as it is, with adj(S) c and det S taken exactly. Returns 0 for what is not usual. */
static int pose_general(const solve_general *g, const slide *e, double mu_s, double mu_d,
                        kernel_slip *out)
{
    const double c1 = e->c[0] / e->scale;
    const double c2 = e->c[1] / e->scale;
    const double e1 = e->adj[0] / e->unit / e->scale;
    const double e2 = e->adj[1] / e->unit / e->scale;
    const double det = e->det / e->unit / e->unit;
    const double greatest_row = greater(absolute(g->row[0]), absolute(g->row[1]));
    const double greatest_c = greater(absolute(c1), absolute(c2));
    const int usual = !e->singular && e->det > 0.0 && e->largest >= FAST_MIN &&
                      e->largest <= FAST_MAX && greatest_row <= FAST_MAX && g->nn >= FAST_MIN &&
                      mu_d >= FAST_MIN && mu_s <= FAST_MAX && -g->bn >= FAST_MIN &&
                      greatest_c >= FAST_MIN_DRIVE && greatest_c <= FAST_MAX;
    if (!usual) {
        return 0;
    }
    const double unit = g->nn * g->nn;
    out->inverse_a = 1.0 / g->nn;
    out->bn = g->bn;
    out->n1 = g->row[0];
    out->n2 = g->row[1];
    out->c1 = c1;
    out->c2 = c2;
    out->e1 = e1;
    out->e2 = e2;
    out->trace = e->trace;
    out->det = det;
    out->mu_s = mu_s;
    out->inverse_mu = 1.0 / mu_d;
    out->A = -mu_d * g->bn;
    out->B = mu_d * (-g->bn * e->trace - (g->row[0] * c1 + g->row[1] * c2));
    const double base_c = -g->bn * det - (g->row[0] * e1 + g->row[1] * e2);
    out->C = mu_d * base_c;
    out->alpha = unit * (c1 * c1 + c2 * c2);
    out->beta = unit * (c1 * e1 + c2 * e2);
    out->gamma = unit * (e1 * e1 + e2 * e2);
    out->least = det / (e->trace + e->largest);
    out->mode = mu_s * base_c >= kernel_guess(out) ? KERNEL_STICK : KERNEL_SLIP;
    return 1;
}

double solve_general_scaled(const solve_general *problem, double mu_s, double mu_d, double p[3],
                            double *nu, uint32_t *iterations)
{
    slide e;
    kernel_slip slip;
    p[0] = p[1] = p[2] = 0.0;
    *nu = 0.0;
    *iterations = 0;
    if (!make_slide(problem, &e)) {
        return KERNEL_MATRIX;
    }
    if (problem->bn < 0.0 && pose_general(problem, &e, mu_s, mu_d, &slip)) {
        const int slips = slip.mode == KERNEL_SLIP;
        if (!slips || settle(&slip, nu, iterations)) {
            kernel_finish(&slip, *nu, slips, p);
            if (is_certified(problem, p, *nu)) {
                return slip.mode;
            }
        }
    }
    return solve_by_bisection(problem, &e, mu_s, mu_d, p, nu, iterations);
}

tribo_status status_of_mode(double mode)
{
    static const tribo_status statuses[] = {
        TRIBO_OK,
        TRIBO_OK,
        TRIBO_OK,
        TRIBO_ERROR_JAM,
        TRIBO_OK,
        TRIBO_ERROR_NOT_FINITE,
        TRIBO_ERROR_RANGE,
        TRIBO_ERROR_FRICTION,
        TRIBO_ERROR_CONTACT_MATRIX,
        TRIBO_ERROR_IMMOVABLE,
    };
    return statuses[(int)mode];
}
