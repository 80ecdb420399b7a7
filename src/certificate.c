#include "certificate.h"

#include "resist.h"

/* What rounding may add to eta: huge impulses are not taken for what it happens to spare. */
#define NOISE (8.0 * TRIBO_EPS)

static double length3(const double x[3])
{
    return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* ---- velocities ------------------------------------------------------------------------------ */

static void add_impulse(const double *frame, const double *turn, double sign, const double r[3],
                        double *sum)
{
    for (int k = 0; k < 3; k++) {
        sum[k] += sign * (frame[k] * r[0] + frame[3 + k] * r[1] + frame[6 + k] * r[2]);
        sum[3 + k] += sign * (turn[k] * r[0] + turn[3 + k] * r[1] + turn[6 + k] * r[2]);
    }
}

static void add_velocity(const double *frame, const double *turn, double sign, const double *dv,
                         double *u)
{
    for (int k = 0; k < 3; k++) {
        const double *f = frame + 3 * k;
        const double *t = turn + 3 * k;
        u[k] += sign * (f[0] * dv[0] + f[1] * dv[1] + f[2] * dv[2] +
                        (t[0] * dv[3] + t[1] * dv[4] + t[2] * dv[5]));
    }
}

/* dv = M^-1 dv, in place. */
static void divide_by_mass(const system_problem *p, double *dv)
{
    for (uint32_t i = 0; i < p->bodies; i++) {
        const double m = p->inverse_mass[i];
        const double *j = p->inverse_inertia + 6 * (size_t)i;
        double *d = dv + 6 * (size_t)i;
        const double x = d[3];
        const double y = d[4];
        const double z = d[5];
        d[0] *= m;
        d[1] *= m;
        d[2] *= m;
        d[3] = j[0] * x + j[1] * y + j[2] * z;
        d[4] = j[1] * x + j[3] * y + j[4] * z;
        d[5] = j[2] * x + j[4] * y + j[5] * z;
    }
}

static void velocity_by_bodies(const system_problem *p, size_t c, const double *dv, double u[3])
{
    static const double still[6] = {0.0};
    const uint32_t *pair = p->pairs + 2 * c;
    const double *a = pair[0] != TRIBO_WORLD ? dv + 6 * (size_t)pair[0] : still;
    const double *b = pair[1] != TRIBO_WORLD ? dv + 6 * (size_t)pair[1] : still;
    const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};

    for (size_t k = 0; k < 3; k++) {
        const double *f = p->frames + 9 * c + 3 * k;
        const double *s = p->turns + 18 * c + 3 * k;
        const double *t = s + 9;
        u[k] = p->q[3 * c + k] + ((f[0] * apart[0] + f[1] * apart[1] + f[2] * apart[2]) +
                                  ((s[0] * a[3] + s[1] * a[4] + s[2] * a[5]) -
                                   (t[0] * b[3] + t[1] * b[4] + t[2] * b[5])));
    }
}

/* Add the impulse of contact c to both of its bodies. */
static void add_both(const system_problem *p, size_t c, const double *r, double *dv)
{
    const double *f = p->frames + 9 * c;
    double along[3];

    for (size_t k = 0; k < 3; k++)
        along[k] = f[k] * r[0] + f[3 + k] * r[1] + f[6 + k] * r[2];
    for (size_t side = 0; side < 2; side++) {
        const uint32_t body = p->pairs[2 * c + side];
        const double *t = p->turns + 18 * c + 9 * side;
        double around[3];
        if (body == TRIBO_WORLD)
            continue;
        double *restrict d = dv + 6 * (size_t)body;
        for (size_t k = 0; k < 3; k++)
            around[k] = t[k] * r[0] + t[3 + k] * r[1] + t[6 + k] * r[2];
        for (size_t k = 0; k < 3; k++) {
            d[k] = side == 0 ? d[k] + along[k] : d[k] - along[k];
            d[3 + k] = side == 0 ? d[3 + k] + around[k] : d[3 + k] - around[k];
        }
    }
}

static void velocity_of_bodies(const system_problem *p, const double *r, double *dv, double *u)
{
    for (size_t i = 0; i < 6 * (size_t)p->bodies; i++)
        dv[i] = 0.0;
    for (size_t c = 0; c < p->count; c++)
        add_both(p, c, r + 3 * c, dv);
    divide_by_mass(p, dv);
    for (size_t c = 0; c < p->count; c++)
        velocity_by_bodies(p, c, dv, u + 3 * c);
}

static void velocity_of_blocks(const system_problem *p, const double *r, double *u)
{
    for (size_t c = 0; c < p->count; c++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
            const double *w = p->blocks + 9 * k;
            const double *x = r + 3 * (size_t)p->columns[k];
            sum[0] += w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
            sum[1] += w[3] * x[0] + w[4] * x[1] + w[5] * x[2];
            sum[2] += w[6] * x[0] + w[7] * x[1] + w[8] * x[2];
        }
        for (size_t k = 0; k < 3; k++)
            u[3 * c + k] = p->q[3 * c + k] + sum[k];
    }
}

void certificate_contact_velocity(const system_problem *p, size_t c, const double *dv, double u[3])
{
    const uint32_t *pair = p->pairs + 2 * c;

    for (size_t k = 0; k < 3; k++)
        u[k] = p->q[3 * c + k];
    if (pair[0] != TRIBO_WORLD)
        add_velocity(p->frames + 9 * c, p->turns + 18 * c, 1.0, dv + 6 * (size_t)pair[0], u);
    if (pair[1] != TRIBO_WORLD)
        add_velocity(p->frames + 9 * c, p->turns + 18 * c + 9, -1.0, dv + 6 * (size_t)pair[1], u);
}

void certificate_row_velocity(const system_problem *p, size_t c, const double *r, double u[3])
{
    for (size_t k = 0; k < 3; k++)
        u[k] = p->q[3 * c + k];
    for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
        const double *w = p->blocks + 9 * k;
        const double *x = r + 3 * (size_t)p->columns[k];
        u[0] += w[0] * x[0] + w[1] * x[1] + w[2] * x[2];
        u[1] += w[3] * x[0] + w[4] * x[1] + w[5] * x[2];
        u[2] += w[6] * x[0] + w[7] * x[1] + w[8] * x[2];
    }
}

void certificate_push(const system_problem *p, size_t c, const double change[3], double *dv)
{
    for (size_t side = 0; side < 2; side++) {
        const uint32_t body = p->pairs[2 * c + side];
        double sum[6] = {0.0};
        if (body == TRIBO_WORLD)
            continue;
        add_impulse(p->frames + 9 * c, p->turns + 18 * c + 9 * side, side == 0 ? 1.0 : -1.0, change,
                    sum);
        const double *j = p->inverse_inertia + 6 * (size_t)body;
        double *d = dv + 6 * (size_t)body;
        for (int k = 0; k < 3; k++)
            d[k] += p->inverse_mass[body] * sum[k];
        d[3] += j[0] * sum[3] + j[1] * sum[4] + j[2] * sum[5];
        d[4] += j[1] * sum[3] + j[3] * sum[4] + j[4] * sum[5];
        d[5] += j[2] * sum[3] + j[4] * sum[4] + j[5] * sum[5];
    }
}

void certificate_velocity(const system_problem *problem, const double *r, double *dv, double *u)
{
    if (problem->bodies != 0)
        velocity_of_bodies(problem, r, dv, u);
    else
        velocity_of_blocks(problem, r, u);
}

/* ---- sizes that the velocities are judged against -------------------------------------------- */

static void gather_size(const double *frame, const double *turn, const double r[3], double *sum)
{
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            sum[k] += absolute(frame[3 * i + k] * r[i]);
            sum[3 + k] += absolute(turn[3 * i + k] * r[i]);
        }
    }
}

/* sizes = |M^-1| sizes, in place. */
static void divide_sizes(const system_problem *p, double *sizes)
{
    for (size_t i = 0; i < p->bodies; i++) {
        const double *j = p->inverse_inertia + 6 * i;
        double *s = sizes + 6 * i;
        const double x = s[3];
        const double y = s[4];
        const double z = s[5];
        for (int k = 0; k < 3; k++)
            s[k] *= p->inverse_mass[i];
        s[3] = absolute(j[0]) * x + absolute(j[1]) * y + absolute(j[2]) * z;
        s[4] = absolute(j[1]) * x + absolute(j[3]) * y + absolute(j[4]) * z;
        s[5] = absolute(j[2]) * x + absolute(j[4]) * y + absolute(j[5]) * z;
    }
}

/* Sums over contacts of |M^-1| |J^T| |r|, 6 per body. */
static void sizes_of_bodies(const system_problem *p, const double *r, double *sizes)
{
    for (size_t i = 0; i < 6 * (size_t)p->bodies; i++)
        sizes[i] = 0.0;
    for (size_t c = 0; c < p->count; c++) {
        for (size_t side = 0; side < 2; side++) {
            const uint32_t body = p->pairs[2 * c + side];
            if (body != TRIBO_WORLD)
                gather_size(p->frames + 9 * c, p->turns + 18 * c + 9 * side, r + 3 * c,
                            sizes + 6 * (size_t)body);
        }
    }
    divide_sizes(p, sizes);
}

/* The size of sum |W_cj| |r_j|. */
static double size_by_bodies(const system_problem *p, size_t c, const double *sizes)
{
    double out[3] = {0.0, 0.0, 0.0};

    for (size_t side = 0; side < 2; side++) {
        const uint32_t body = p->pairs[2 * c + side];
        for (size_t k = 0; k < 3 && body != TRIBO_WORLD; k++) {
            const double *f = p->frames + 9 * c + 3 * k;
            const double *t = p->turns + 18 * c + 9 * side + 3 * k;
            const double *s = sizes + 6 * (size_t)body;
            for (int i = 0; i < 3; i++)
                out[k] += absolute(f[i]) * s[i] + absolute(t[i]) * s[3 + i];
        }
    }
    return length3(out);
}

static double size_by_blocks(const system_problem *p, size_t c, const double *r)
{
    double out[3] = {0.0, 0.0, 0.0};

    for (size_t k = p->row_starts[c]; k < p->row_starts[c + 1]; k++) {
        const double *w = p->blocks + 9 * k;
        const double *x = r + 3 * (size_t)p->columns[k];
        for (int i = 0; i < 3; i++)
            out[i] += absolute(w[3 * i] * x[0]) + absolute(w[3 * i + 1] * x[1]) +
                      absolute(w[3 * i + 2] * x[2]);
    }
    return length3(out);
}

/* V of a contact; sizes: of sizes_of_bodies, or null. That of a torque holds that of its contact,
 * too: rounding of impulses that roll nothing is not taken for rolling. */
static double velocity_scale(const system_problem *p, size_t c, const double *r,
                             const double *sizes)
{
    const double own = length3(p->q + 3 * c);
    const double all =
        own + (p->bodies != 0 ? size_by_bodies(p, c, sizes) : size_by_blocks(p, c, r));
    return resist_is_torque(p, c) ? all + velocity_scale(p, c - 1, r, sizes) : all;
}

/* ---- measures of one contact ----------------------------------------------------------------- */

typedef struct measured {
    double eta, signorini, cone, misalignment;
} measured;

static double greatest_diagonal(const double w[9])
{
    return greater(w[0], greater(w[4], w[8]));
}

/* |x - P_K(x - y)|, y = scale (u + mu |u_t| e_n). */
static double map_size(const double x[3], double scale, const double u[3], double mu)
{
    const double bent = u[0] + mu * planar_length(u[1], u[2]);
    const double moved[3] = {x[0] - scale * bent, x[1] - scale * u[1], x[2] - scale * u[2]};
    double projected[3];

    cone_project(moved, mu, projected);
    for (int k = 0; k < 3; k++)
        projected[k] = x[k] - projected[k];
    return length3(projected);
}

/* v, p: the contact's scales. */
static measured measure_with(double most, double mu, double v, double p, const double *r,
                             const double *u)
{
    const double slip = planar_length(u[1], u[2]);
    const double twist[3] = {slip * r[1] + mu * r[0] * u[1], slip * r[2] + mu * r[0] * u[2], 0.0};
    measured out;

    out.eta = map_size(r, 1.0 / (most * greater(1.0, mu)), u, mu) / p;
    out.signorini = absolute(lesser(u[0] / v, r[0] / p));
    out.cone = greater(0.0, planar_length(r[1], r[2]) - mu * r[0]) / p;
    out.misalignment = length3(twist) / (p * v);
    return out;
}

/* Judged by mu_d, or by mu_s where that is nearer although the contact may not slide then. `fit`
 * receives which. */
static measured measure_contact(const system_problem *problem, size_t c, double v, const double *r,
                                const double *u, double *fit)
{
    const double *mu = problem->mu + 2 * c;
    const double most = greatest_diagonal(problem->diagonal + 9 * c);
    const double p = v / most;
    const measured none = {0.0, 0.0, 0.0, 0.0};

    *fit = mu[1];
    if (v == 0.0)
        return none;
    const measured dynamic = measure_with(most, mu[1], v, p, r, u);
    if (mu[0] == mu[1])
        return dynamic;
    measured still = measure_with(most, mu[0], v, p, r, u);
    still.eta = greater(still.eta, planar_length(u[1], u[2]) / v);
    if (!(still.eta < dynamic.eta))
        return dynamic;
    *fit = mu[0];
    return still;
}

/* ---- measures of a torque -------------------------------------------------------------------- */

static double torque_map(const system_problem *problem, size_t c, double sigma, double scale,
                         const double *r, const double *u)
{
    double limits[2];
    double moved[3];
    double projected[3];

    resist_limits(problem, c, sigma * r[-3], limits);
    for (int k = 0; k < 3; k++)
        moved[k] = sigma * r[k] - scale * u[k];
    resist_project(moved, limits, projected);
    for (int k = 0; k < 3; k++)
        projected[k] = sigma * r[k] - projected[k];
    return length3(projected);
}

/* r and u are those of the torque; its contact's stand before them. */
static measured measure_torque(const system_problem *problem, size_t c, double v, const double *r,
                               const double *u)
{
    const double own = greatest_diagonal(problem->diagonal + 9 * c);
    const double most = own > 0.0 ? own : greatest_diagonal(problem->diagonal + 9 * (c - 1));
    const double p = v / most;
    const double roll = planar_length(u[1], u[2]);
    double limits[2];
    measured out = {0.0, 0.0, 0.0, 0.0};

    if (v == 0.0)
        return out;
    resist_limits(problem, c, r[-3], limits);
    const double twist[3] = {roll * r[1] + limits[1] * u[1], roll * r[2] + limits[1] * u[2],
                             absolute(u[0]) * r[0] + limits[0] * u[0]};
    out.eta = torque_map(problem, c, 1.0, 1.0 / most, r, u) / p;
    out.cone =
        greater(0.0, greater(absolute(r[0]) - limits[0], planar_length(r[1], r[2]) - limits[1])) /
        p;
    out.misalignment = length3(twist) / (p * v);
    return out;
}

/* A contact or a torque. */
static measured measure_any(const system_problem *problem, size_t c, double v, const double *r,
                            const double *u)
{
    double fit;
    return resist_is_torque(problem, c)
               ? measure_torque(problem, c, v, r + 3 * c, u + 3 * c)
               : measure_contact(problem, c, v, r + 3 * c, u + 3 * c, &fit);
}

/* ---- measures of a system -------------------------------------------------------------------- */

/* The coefficient that a contact is judged by. */
static double fit_of(const system_problem *problem, size_t c, const double *r, const double *u,
                     const double *scratch)
{
    const double *mu = problem->mu + 2 * c;
    double fit = mu[1];

    if (mu[0] != mu[1])
        measure_contact(problem, c, velocity_scale(problem, c, r, scratch), r + 3 * c, u + 3 * c,
                        &fit);
    return fit;
}

/* sum |sigma r - P_K(sigma r - u')|^2; scratch as sizes_of_bodies leaves it. */
static double squared_map(const system_problem *problem, double sigma, const double *r,
                          const double *u, const double *scratch)
{
    double sum = 0.0;

    for (size_t c = 0; c < problem->count; c++) {
        const double *own = r + 3 * c;
        const double scaled[3] = {sigma * own[0], sigma * own[1], sigma * own[2]};
        if (resist_is_torque(problem, c)) {
            const double map = torque_map(problem, c, sigma, 1.0, own, u + 3 * c);
            sum += map * map;
            continue;
        }
        const double fit = fit_of(problem, c, r, u, scratch);
        const double map = map_size(scaled, 1.0, u + 3 * c, fit);
        /* Beyond mu_d a contact may not slide. */
        const double slip =
            fit > problem->mu[2 * c + 1] ? planar_length(u[3 * c + 1], u[3 * c + 2]) : 0.0;
        sum += map * map + slip * slip;
    }
    return sum;
}

/* 1 if the sums over contacts ask for the sizes of velocities. */
static int asks_for_sizes(const system_problem *problem)
{
    for (size_t c = 0; c < problem->count; c++) {
        if (problem->mu[2 * c] != problem->mu[2 * c + 1])
            return problem->bodies != 0;
    }
    return 0;
}

/* The greater; what is not a number is worse than all. */
static double worse(double a, double b)
{
    return b <= a ? a : b < HUGE_VAL ? b : HUGE_VAL;
}

/* eta of a contact, and where mu is above 1 the greater of it and signorini, `hard`: there, the
 * natural map divides by mu what velocities leave open. What verdicts have no use for is not
 * calculated. */
static double judge_contact(const system_problem *problem, size_t c, double v, const double *r,
                            const double *u, double *hard)
{
    const double *mu = problem->mu + 2 * c;
    const double most = greatest_diagonal(problem->diagonal + 9 * c);
    double eta = 0.0;

    if (resist_is_torque(problem, c) || mu[0] != mu[1] || mu[1] > 1.0) {
        const measured m = measure_any(problem, c, v, r, u);
        *hard = mu[1] > 1.0 ? greater(m.eta, m.signorini) : m.eta;
        return m.eta;
    }
    if (v != 0.0)
        eta = map_size(r + 3 * c, 1.0 / most, u + 3 * c, mu[1]) / (v / most);
    *hard = eta;
    return eta;
}

/* A verdict in the making. */
typedef struct tally {
    verdict reached; /* greatest eta, and greatest eta V */
    double speed, most;
} tally;

static void count_contact(const system_problem *problem, size_t c, double v, const double *r,
                          const double *u, tally *sum)
{
    double hard;
    const double eta = judge_contact(problem, c, v, r, u, &hard);

    sum->speed = greater(sum->speed, length3(problem->q + 3 * c));
    sum->most = greater(sum->most, v);
    sum->reached.eta = greater(sum->reached.eta, eta);
    sum->reached.distance = worse(sum->reached.distance, hard);
    sum->reached.residual = worse(sum->reached.residual, (hard + NOISE) * v);
}

static verdict pronounce(const tally *sum, const goal *wanted)
{
    verdict out = sum->reached;

    out.growth = sum->speed > 0.0 ? sum->most / sum->speed : 0.0;
    out.distance /= wanted->tolerance;
    if (out.distance > 0.0)
        out.distance = greater(out.distance, out.residual / wanted->residual);
    return out;
}

verdict certificate_judge(const system_problem *problem, const goal *wanted, const double *r,
                          const double *u, double *scratch)
{
    verdict out = {0.0, 0.0, 0.0, 0.0};
    tally sum = {{0.0, 0.0, 0.0, 0.0}, 0.0, 0.0};

    const int by_eta = wanted->measure == TRIBO_MEASURE_ETA;

    if (by_eta ? problem->bodies != 0 : asks_for_sizes(problem))
        sizes_of_bodies(problem, r, scratch);
    if (by_eta) {
        for (size_t c = 0; c < problem->count; c++)
            count_contact(problem, c, velocity_scale(problem, c, r, scratch), r, u, &sum);
        return pronounce(&sum, wanted);
    }
    out.residual = worse(0.0, sqrt(squared_map(problem, wanted->sigma, r, u, scratch)));
    out.distance = out.residual == 0.0 ? 0.0 : out.residual / wanted->limit;
    return out;
}

/* What the impulse of a contact gives to one body, and the size of it: add_impulse and gather_size
 * in one. */
static void gather(const double *frame, const double *turn, double sign, const double r[3],
                   double *restrict sum, double *restrict sizes)
{
    for (int k = 0; k < 3; k++) {
        const double f[3] = {frame[k] * r[0], frame[3 + k] * r[1], frame[6 + k] * r[2]};
        const double t[3] = {turn[k] * r[0], turn[3 + k] * r[1], turn[6 + k] * r[2]};
        sum[k] += sign * (f[0] + f[1] + f[2]);
        sum[3 + k] += sign * (t[0] + t[1] + t[2]);
        sizes[k] = ((sizes[k] + absolute(f[0])) + absolute(f[1])) + absolute(f[2]);
        sizes[3 + k] = ((sizes[3 + k] + absolute(t[0])) + absolute(t[1])) + absolute(t[2]);
    }
}

static void gather_all(const system_problem *p, const double *r, double *dv, double *sizes)
{
    for (size_t i = 0; i < 6 * (size_t)p->bodies; i++)
        dv[i] = sizes[i] = 0.0;
    for (size_t c = 0; c < p->count; c++) {
        for (size_t side = 0; side < 2; side++) {
            const uint32_t body = p->pairs[2 * c + side];
            if (body != TRIBO_WORLD)
                gather(p->frames + 9 * c, p->turns + 18 * c + 9 * side, side == 0 ? 1.0 : -1.0,
                       r + 3 * c, dv + 6 * (size_t)body, sizes + 6 * (size_t)body);
        }
    }
    divide_by_mass(p, dv);
    divide_sizes(p, sizes);
}

verdict certificate_check(const system_problem *problem, const goal *wanted, const double *r,
                          double *dv, double *u, double *scratch)
{
    tally sum = {{0.0, 0.0, 0.0, 0.0}, 0.0, 0.0};

    if (problem->bodies == 0 || wanted->measure != TRIBO_MEASURE_ETA) {
        certificate_velocity(problem, r, dv, u);
        return certificate_judge(problem, wanted, r, u, scratch);
    }
    gather_all(problem, r, dv, scratch);
    for (size_t c = 0; c < problem->count; c++) {
        velocity_by_bodies(problem, c, dv, u + 3 * c);
        count_contact(problem, c, velocity_scale(problem, c, r, scratch), r, u, &sum);
    }
    return pronounce(&sum, wanted);
}

static double length(size_t count, const double *x)
{
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

double certificate_stiffness(const system_problem *problem)
{
    double sum = 0.0;

    for (size_t c = 0; c < problem->count; c++) {
        const double *w = problem->diagonal + 9 * c;
        sum += w[0] + w[4] + w[8];
    }
    return problem->count != 0 ? sum / (3.0 * (double)problem->count) : 0.0;
}

void certificate_write(const system_problem *problem, const double *r, const double *u,
                       double *scratch, tribo_system_info *info)
{
    double squares = 0.0;
    double before = 0.0;
    uint32_t contacts = 0;

    info->eta = info->signorini = info->cone = info->misalignment = 0.0;
    if (problem->bodies != 0)
        sizes_of_bodies(problem, r, scratch);
    for (size_t c = 0; c < problem->count; c++) {
        const double v = velocity_scale(problem, c, r, scratch);
        const measured m = measure_any(problem, c, v, r, u);
        /* Of a contact and its torque the worse counts. */
        if (resist_is_torque(problem, c))
            squares += greater(m.eta * m.eta - before * before, 0.0);
        else
            squares += m.eta * m.eta;
        contacts += resist_is_torque(problem, c) ? 0 : 1;
        before = m.eta;
        info->eta = greater(info->eta, m.eta);
        info->signorini = greater(info->signorini, m.signorini);
        info->cone = greater(info->cone, m.cone);
        info->misalignment = greater(info->misalignment, m.misalignment);
    }
    info->eta_rms = contacts != 0 ? sqrt(squares / (double)contacts) : 0.0;
}

void certificate_sum(const system_problem *problem, const double *r, const double *u,
                     double *scratch, tribo_system_info *info)
{
    const size_t numbers = 3 * (size_t)problem->count;
    const double q_size = length(numbers, problem->q);

    if (asks_for_sizes(problem))
        sizes_of_bodies(problem, r, scratch);
    const double map = sqrt(squared_map(problem, certificate_stiffness(problem), r, u, scratch));
    info->invariant = q_size > 0.0 ? map / q_size : 0.0;
    const double unit = sqrt(squared_map(problem, 1.0, r, u, scratch));
    const double size = greater(q_size, greater(length(numbers, r), length(numbers, u)));
    info->siconos = size > TRIBO_EPS ? unit / size : unit;
}

void certificate_energy(const system_problem *problem, const double *r, const double *u,
                        tribo_system_info *info)
{
    info->energy = info->energy_scale = 0.0;
    for (size_t c = 0; c < problem->count; c++) {
        const double *own = r + 3 * c;
        const double *before = problem->q + 3 * c;
        const double *after = u + 3 * c;
        for (int k = 0; k < 3; k++)
            info->energy += 0.5 * own[k] * (before[k] + after[k]);
        info->energy_scale += 0.5 * length3(own) * (length3(before) + length3(after));
    }
}

double certificate_growth(const system_problem *problem, const double *r, double *scratch)
{
    double speed = 0.0;
    double most = 0.0;

    if (problem->bodies != 0)
        sizes_of_bodies(problem, r, scratch);
    for (size_t c = 0; c < problem->count; c++) {
        speed = greater(speed, length3(problem->q + 3 * c));
        most = greater(most, velocity_scale(problem, c, r, scratch));
    }
    return speed > 0.0 ? most / speed : 0.0;
}
