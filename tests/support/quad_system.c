#include "quad_system.h"

#include "quad.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EPS DBL_EPSILON

/* One contact as the laws of contact see it; or its torque, right behind it: u = arm omega and r =
 * tau / arm, its laws by the impulse of the contact. */
typedef struct view {
    int is_torque;
    quad_real normal;     /* r_n of the contact */
    quad_real lengths[2]; /* spinning, rolling, over the arm */
    quad_real q[3];       /* velocity without impulses, less the target */
    quad_real u[3];       /* with them */
    quad_real r[3];
    double greatest; /* diagonal entry of W_cc */
    double trace;
    double speed; /* V */
    double noise; /* of u, m/s */
    double mu[2];
} view;

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size);
    if (memory == NULL) {
        abort();
    }
    return memory;
}

/* ---- small vectors --------------------------------------------------------------------------- */

static quad_real dot(size_t n, const quad_real *a, const quad_real *b)
{
    quad_real sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static quad_real length(size_t n, const quad_real *a)
{
    return quad_sqrt(dot(n, a, a));
}

static void cross(const quad_real a[3], const quad_real b[3], quad_real out[3])
{
    const quad_real x = a[1] * b[2] - a[2] * b[1];
    const quad_real y = a[2] * b[0] - a[0] * b[2];
    const quad_real z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static double greater(double a, double b)
{
    return a > b ? a : b;
}

static double length3(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* ---- the laws of contact --------------------------------------------------------------------- */

/* |x - P_K(x - step (u + mu |u_t| e_n))| */
static quad_real residual(const quad_real x[3], const quad_real u[3], quad_real mu, quad_real step)
{
    const quad_real lift = mu * length(2, u + 1);
    const quad_real y[3] = {x[0] - step * (u[0] + lift), x[1] - step * u[1], x[2] - step * u[2]};
    const quad_real planar = length(2, y + 1);
    quad_real p[3] = {y[0], y[1], y[2]};
    if (mu * planar <= -y[0]) {
        p[0] = p[1] = p[2] = 0;
    } else if (planar > mu * y[0]) {
        p[0] = (y[0] + mu * planar) / (1 + mu * mu);
        p[1] = mu * p[0] * y[1] / planar;
        p[2] = mu * p[0] * y[2] / planar;
    }
    for (size_t i = 0; i < 3; i++) {
        p[i] -= x[i];
    }
    return length(3, p);
}

/* |x - P(x - step u)|, P the nearest torque within what the normal impulse allows. */
static quad_real torque_residual(const view *c, const quad_real x[3], quad_real normal,
                                 quad_real step)
{
    const quad_real most[2] = {c->lengths[0] * normal, c->lengths[1] * normal};
    quad_real p[3];
    for (size_t i = 0; i < 3; i++) {
        p[i] = x[i] - step * c->u[i];
    }
    const quad_real planar = length(2, p + 1);
    p[0] = p[0] > most[0] ? most[0] : p[0] < -most[0] ? -most[0] : p[0];
    for (size_t i = 1; i < 3; i++) {
        p[i] = planar > most[1] ? most[1] * p[i] / planar : p[i];
    }
    for (size_t i = 0; i < 3; i++) {
        p[i] -= x[i];
    }
    return length(3, p);
}

/* The measures of one contact with the coefficient mu. */
typedef struct measures {
    double eta;
    double signorini;
    double cone;
    double misalignment;
} measures;

static void measure(const view *c, double mu, double speed, double impulse, measures *out)
{
    const quad_real step = 1 / (quad_real)(c->greatest * greater(1.0, mu));
    const quad_real m = (quad_real)mu;
    const quad_real slip = length(2, c->u + 1);
    const double normal_speed = (double)(c->u[0] / (quad_real)speed);
    const double normal_impulse = (double)(c->r[0] / (quad_real)impulse);
    quad_real wrong[2];
    for (size_t i = 0; i < 2; i++) {
        wrong[i] = slip * c->r[1 + i] + m * c->r[0] * c->u[1 + i];
    }
    const quad_real excess = length(2, c->r + 1) - m * c->r[0];
    out->eta = (double)(residual(c->r, c->u, m, step) / (quad_real)impulse);
    out->signorini = fabs(normal_speed < normal_impulse ? normal_speed : normal_impulse);
    out->cone = excess > 0 ? (double)(excess / (quad_real)impulse) : 0.0;
    out->misalignment = (double)(length(2, wrong) / (quad_real)(impulse * speed));
}

static void measure_torque(const view *c, double speed, double impulse, measures *out)
{
    const quad_real normal = c->normal > 0 ? c->normal : 0;
    const quad_real spin = c->u[0] > 0 ? c->u[0] : -c->u[0];
    const quad_real torque = c->r[0] > 0 ? c->r[0] : -c->r[0];
    const quad_real roll = length(2, c->u + 1);
    const quad_real bounds[2] = {c->lengths[0] * normal, c->lengths[1] * normal};
    const quad_real over[2] = {torque - bounds[0], length(2, c->r + 1) - bounds[1]};
    const quad_real most = over[0] > over[1] ? over[0] : over[1];
    const quad_real wrong[3] = {spin * c->r[0] + bounds[0] * c->u[0],
                                roll * c->r[1] + bounds[1] * c->u[1],
                                roll * c->r[2] + bounds[1] * c->u[2]};
    out->eta =
        (double)(torque_residual(c, c->r, normal, 1 / (quad_real)c->greatest) / (quad_real)impulse);
    out->signorini = 0.0;
    out->cone = most > 0 ? (double)(most / (quad_real)impulse) : 0.0;
    out->misalignment = (double)(length(3, wrong) / (quad_real)(impulse * speed));
}

/* The coefficient by which a contact is judged: mu_s where it fits better than mu_d although the
 * contact must not slide then. */
static double coefficient(const view *c, double speed, double impulse, measures *out)
{
    measures still;
    measure(c, c->mu[1], speed, impulse, out);
    if (!(c->mu[0] > c->mu[1])) {
        return c->mu[1];
    }
    measure(c, c->mu[0], speed, impulse, &still);
    still.eta = greater(still.eta, (double)length(2, c->u + 1) / speed);
    if (!(still.eta < out->eta)) {
        return c->mu[1];
    }
    *out = still;
    return c->mu[0];
}

typedef struct sums {
    quad_real eta;
    quad_real invariant;
    quad_real siconos;
    quad_real q;
    quad_real r;
    quad_real u;
    quad_real energy;
    double energy_scale;
    double energy_noise;
    double noise; /* |of all u| squared */
    double last;  /* eta of the contact before */
    size_t contacts;
} sums;

static void judge(const view *c, double stiffness, size_t number, sums *sum, quad_certificate *out)
{
    const double speed = c->speed;
    const double impulse = speed / c->greatest;
    const quad_real rq = dot(3, c->r, c->q);
    const quad_real ru = dot(3, c->r, c->u);
    const double strength = (double)length(3, c->r);
    measures got = {0, 0, 0, 0};
    double mu = c->mu[1];
    quad_real scaled[3];
    if (speed > 0.0) {
        if (c->is_torque) {
            mu = (double)(c->lengths[0] + c->lengths[1]);
            measure_torque(c, speed, impulse, &got);
        } else {
            mu = coefficient(c, speed, impulse, &got);
        }
        /* the map is a difference of impulses, which are far above P where W turns them easily */
        const double own = EPS * (1.0 + strength / impulse) + c->noise / speed;
        const double normal = (double)(c->is_torque ? c->normal : c->r[0]);
        const double planar = c->is_torque ? strength : (double)length(2, c->r + 1);
        const double friction = planar + mu * fabs(normal);
        out->contact_noise = greater(out->contact_noise, own);
        out->misalignment_noise =
            greater(out->misalignment_noise, own * (1.0 + friction / impulse));
    }
    if (got.eta > out->eta) {
        out->eta = got.eta;
        out->worst_contact = (double)number;
    }
    out->signorini = greater(out->signorini, got.signorini);
    out->cone = greater(out->cone, got.cone);
    out->misalignment = greater(out->misalignment, got.misalignment);
    /* of a contact and its torque the worse counts */
    const double counted = c->is_torque ? greater(got.eta, sum->last) : got.eta;
    const double before = c->is_torque ? sum->last : 0.0;
    sum->eta += (quad_real)counted * (quad_real)counted - (quad_real)before * (quad_real)before;
    sum->last = got.eta;
    sum->contacts += c->is_torque ? 0 : 1;
    for (size_t i = 0; i < 3; i++) {
        scaled[i] = (quad_real)stiffness * c->r[i];
    }
    const quad_real normal = c->normal > 0 ? c->normal : 0;
    const quad_real invariant = c->is_torque
                                    ? torque_residual(c, scaled, (quad_real)stiffness * normal, 1)
                                    : residual(scaled, c->u, (quad_real)mu, 1);
    const quad_real siconos =
        c->is_torque ? torque_residual(c, c->r, normal, 1) : residual(c->r, c->u, (quad_real)mu, 1);
    /* beyond mu_d a contact may not slide */
    const quad_real slip = !c->is_torque && mu > c->mu[1] ? length(2, c->u + 1) : 0;
    sum->invariant += invariant * invariant + slip * slip;
    sum->siconos += siconos * siconos + slip * slip;
    sum->q += dot(3, c->q, c->q);
    sum->r += dot(3, c->r, c->r);
    sum->u += dot(3, c->u, c->u);
    sum->energy += (rq + ru) / 2;
    sum->energy_scale += strength * (double)(length(3, c->q) + length(3, c->u)) / 2.0;
    sum->energy_noise += strength * (c->noise + EPS * speed);
    const double noise = (1.0 + mu) * (c->noise + EPS * speed);
    sum->noise += noise * noise;
}

static void judge_all(size_t count, const view *views, quad_certificate *out)
{
    sums sum;
    double trace = 0.0;
    memset(&sum, 0, sizeof sum);
    for (size_t i = 0; i < count; i++) {
        trace += views[i].trace;
    }
    const double stiffness = count > 0 ? trace / (3.0 * (double)count) : 0.0;
    for (size_t i = 0; i < count; i++) {
        judge(&views[i], stiffness, i, &sum, out);
    }
    const double q = (double)quad_sqrt(sum.q);
    const double r = (double)quad_sqrt(sum.r);
    const double u = (double)quad_sqrt(sum.u);
    const double scale = greater(q, greater(r, u));
    const double noise = sqrt(sum.noise);
    out->eta_rms =
        sum.contacts > 0 ? (double)quad_sqrt(sum.eta / (quad_real)(double)sum.contacts) : 0.0;
    if (q > 0.0) {
        out->invariant = (double)quad_sqrt(sum.invariant) / q;
        out->invariant_noise = (noise + EPS * stiffness * r) / q + EPS * out->invariant;
    }
    if (scale > EPS) {
        out->siconos = (double)quad_sqrt(sum.siconos) / scale;
        out->siconos_noise = (noise + EPS * r) / scale + EPS * out->siconos;
    }
    out->energy = (double)sum.energy;
    out->energy_scale = sum.energy_scale;
    out->energy_noise = sum.energy_noise + EPS * sum.energy_scale;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static const double at_rest[3] = {0.0, 0.0, 0.0};

static int moves(const tribo_body *body)
{
    double sum = body->inverse_mass;
    for (size_t i = 0; i < 6; i++) {
        sum += fabs(body->inverse_inertia[i]);
    }
    return sum > 0.0;
}

/* x from world to body axes (sign -1) or back (1). */
static void turn(const double orientation[4], int sign, const quad_real x[3], quad_real out[3])
{
    quad_real q[4];
    quad_real once[3];
    quad_real twice[3];
    quad_widen(4, orientation, q);
    const quad_real square = dot(4, q, q);
    for (size_t i = 1; i < 4 && sign < 0; i++) {
        q[i] = -q[i];
    }
    cross(q + 1, x, once);
    cross(q + 1, once, twice);
    for (size_t i = 0; i < 3; i++) {
        out[i] = x[i] + 2 * (q[0] * once[i] + twice[i]) / square;
    }
}

/* Change of the angular velocity by a moment, both in world axes. */
static void twist(const tribo_body *body, const quad_real moment[3], quad_real change[3])
{
    static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    quad_real x[3];
    quad_real y[3] = {0, 0, 0};
    turn(body->orientation, -1, moment, x);
    for (size_t i = 0; i < 9; i++) {
        y[i / 3] += (quad_real)body->inverse_inertia[entry[i / 3][i % 3]] * x[i % 3];
    }
    turn(body->orientation, 1, y, change);
}

/* What the impulse `x` (contact axes) on a body at rest makes of it. */
static void push(const tribo_body *body, const double arm[3], const double frame[9],
                 const quad_real x[3], double sign, quad_real change[6])
{
    tribo_body still = *body;
    memcpy(still.velocity, at_rest, sizeof at_rest);
    memcpy(still.angular_velocity, at_rest, sizeof at_rest);
    quad_apply(&still, arm, frame, x, sign, change);
}

/* The bodies' part of a certificate. */
typedef struct motion {
    size_t body_count;
    const tribo_body *bodies;
    size_t count;
    const tribo_system_contact *contacts;
    const double *torques; /* or null */
    double *frames;        /* 9 */
    quad_real *change;     /* 6 per body: v(r) - v */
    double *summed;        /* 2 per body: sizes of the terms that v and omega are summed from */
    double *sizes;         /* 6 per body: |M^-1| |J^T| |r| */
    double *reach;         /* 1 per body: longest arm */
} motion;

static const tribo_body *body_of(const motion *m, size_t contact, size_t side)
{
    const tribo_system_contact *c = &m->contacts[contact];
    const uint32_t index = side == 0 ? c->a : c->b;
    return index < m->body_count && moves(&m->bodies[index]) ? &m->bodies[index] : NULL;
}

static const double *arm_of(const motion *m, size_t contact, size_t side)
{
    const tribo_contact *c = &m->contacts[contact].contact;
    return side == 0 ? c->arm_a : c->arm_b;
}

static size_t index_of(const motion *m, size_t contact, size_t side)
{
    return (size_t)(body_of(m, contact, side) - m->bodies);
}

/* Size of the inverse inertia: what a moment is multiplied by in world axes, where a slender body
 * has rounding of its fast axis in all others. */
static double stiffness(const tribo_body *body)
{
    const double *i = body->inverse_inertia;
    return sqrt(i[0] * i[0] + i[3] * i[3] + i[5] * i[5] +
                2.0 * (i[1] * i[1] + i[2] * i[2] + i[4] * i[4]));
}

/* Adds the impulse of a contact to its bodies. */
static void add_impulse(motion *m, size_t contact, const quad_real r[3])
{
    for (size_t side = 0; side < 2; side++) {
        const tribo_body *body = body_of(m, contact, side);
        const double *arm = arm_of(m, contact, side);
        quad_real change[6];
        if (body == NULL) {
            continue;
        }
        const size_t index = index_of(m, contact, side);
        push(body, arm, m->frames + 9 * contact, r, side == 0 ? 1.0 : -1.0, change);
        for (size_t i = 0; i < 6; i++) {
            m->change[6 * index + i] += change[i];
        }
        m->summed[2 * index] += (double)length(3, change);
        m->summed[2 * index + 1] += stiffness(body) * length3(arm) * (double)length(3, r);
        m->reach[index] = greater(m->reach[index], length3(arm));
    }
}

/* A torque's share, world axes, for A. */
static void moment_of(const motion *m, size_t contact, quad_real out[3])
{
    const double *axes = m->frames + 9 * contact;
    for (size_t i = 0; i < 3; i++) {
        out[i] = 0;
        for (size_t k = 0; k < 3; k++) {
            out[i] += (quad_real)axes[3 * k + i] * (quad_real)m->torques[3 * contact + k];
        }
    }
}

/* Adds the torque of a contact to its bodies. */
static void add_torque(motion *m, size_t contact)
{
    quad_real moment[3];
    moment_of(m, contact, moment);
    for (size_t side = 0; side < 2; side++) {
        const tribo_body *body = body_of(m, contact, side);
        quad_real change[3];
        if (body == NULL) {
            continue;
        }
        const size_t index = index_of(m, contact, side);
        twist(body, moment, change);
        for (size_t i = 0; i < 3; i++) {
            m->change[6 * index + 3 + i] += side == 0 ? change[i] : -change[i];
        }
        m->summed[2 * index + 1] += stiffness(body) * (double)length(3, moment);
    }
}

static void find_diagonal(const double w[9], view *out)
{
    out->greatest = greater(w[0], greater(w[4], w[8]));
    out->trace = w[0] + w[4] + w[8];
}

/* One side of a contact: its frame, and the moments of the frame's axes. */
static void find_rows(const motion *m, size_t c, size_t side, double rows[3][6])
{
    const double *frame = m->frames + 9 * c;
    for (size_t k = 0; k < 3; k++) {
        memcpy(rows[k], frame + 3 * k, 3 * sizeof rows[k][0]);
        tribo_vec3_cross(arm_of(m, c, side), frame + 3 * k, rows[k] + 3);
    }
}

/* |M^-1| |J^T| |r|, 6 per body, entry by entry in world axes. */
static void find_sizes(motion *m, const double *impulses)
{
    static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (size_t i = 0; i < 2 * m->count; i++) {
        double rows[3][6];
        if (body_of(m, i / 2, i % 2) == NULL) {
            continue;
        }
        find_rows(m, i / 2, i % 2, rows);
        for (size_t k = 0; k < 18; k++) {
            m->sizes[6 * index_of(m, i / 2, i % 2) + k % 6] +=
                fabs(rows[k / 6][k % 6] * impulses[3 * (i / 2) + k / 6]);
        }
        for (size_t k = 0; k < 9 && m->torques != NULL; k++) {
            m->sizes[6 * index_of(m, i / 2, i % 2) + 3 + k % 3] +=
                fabs(m->frames[9 * (i / 2) + k] * m->torques[3 * (i / 2) + k / 3]);
        }
    }
    for (size_t b = 0; b < m->body_count; b++) {
        double *size = m->sizes + 6 * b;
        const double moment[3] = {size[3], size[4], size[5]};
        double inertia[6];
        tribo_body_world_inverse_inertia(&m->bodies[b], inertia);
        for (size_t k = 0; k < 3; k++) {
            size[k] *= m->bodies[b].inverse_mass;
            size[3 + k] = 0.0;
            for (size_t l = 0; l < 3; l++) {
                size[3 + k] += fabs(inertia[entry[k][l]]) * moment[l];
            }
        }
    }
}

/* V = |q_c| + | |J_c| |M^-1| |J^T| |r| | */
static double find_speed(const motion *m, size_t c, const view *v)
{
    double size[3] = {0.0, 0.0, 0.0};
    for (size_t side = 0; side < 2; side++) {
        double rows[3][6];
        if (body_of(m, c, side) == NULL) {
            continue;
        }
        find_rows(m, c, side, rows);
        for (size_t k = 0; k < 18; k++) {
            size[k / 6] += fabs(rows[k / 6][k % 6]) * m->sizes[6 * index_of(m, c, side) + k % 6];
        }
    }
    return (double)length(3, v->q) + length3(size);
}

/* The same of a torque for an arm of 1. */
static double find_turning_speed(const motion *m, size_t c, const view *v)
{
    double size[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < 18; i++) {
        const size_t side = i / 9;
        if (body_of(m, c, side) != NULL) {
            size[i % 9 / 3] +=
                fabs(m->frames[9 * c + i % 9]) * m->sizes[6 * index_of(m, c, side) + 3 + i % 3];
        }
    }
    return (double)length(3, v->q) + length3(size);
}

static void find_matrix(const motion *m, size_t c, double w[9])
{
    static const size_t entry[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const tribo_system_contact *contact = &m->contacts[c];
    tribo_body world;
    quad_real matrix[6];
    tribo_body_init(&world);
    quad_matrix(contact->a < m->body_count ? &m->bodies[contact->a] : &world,
                contact->b < m->body_count ? &m->bodies[contact->b] : &world, &contact->contact,
                m->frames + 9 * c, matrix);
    for (size_t i = 0; i < 9; i++) {
        w[i] = (double)matrix[entry[i]];
    }
}

/* u without (before = 1) or with the impulses, less the target. */
static void find_velocity(const motion *m, size_t c, int before, quad_real out[3])
{
    const tribo_system_contact *contact = &m->contacts[c];
    quad_real axes[9];
    quad_real total[3] = {0, 0, 0};
    quad_widen(9, m->frames + 9 * c, axes);
    for (size_t side = 0; side < 2; side++) {
        const uint32_t index = side == 0 ? contact->a : contact->b;
        quad_real v[6];
        quad_real arm[3];
        quad_real turning[3];
        if (index >= m->body_count) {
            continue;
        }
        quad_widen(3, m->bodies[index].velocity, v);
        quad_widen(3, m->bodies[index].angular_velocity, v + 3);
        quad_widen(3, arm_of(m, c, side), arm);
        for (size_t i = 0; i < 6 && !before; i++) {
            v[i] += m->change[6 * index + i];
        }
        cross(v + 3, arm, turning);
        for (size_t i = 0; i < 3; i++) {
            total[i] += (v[i] + turning[i]) * (side == 0 ? 1 : -1);
        }
    }
    for (size_t i = 0; i < 3; i++) {
        out[i] = dot(3, axes + 3 * i, total) - (quad_real)contact->target[i];
    }
}

/* Relative angular velocity, as find_velocity. */
static void find_turning(const motion *m, size_t c, int before, quad_real out[3])
{
    const tribo_system_contact *contact = &m->contacts[c];
    quad_real axes[9];
    quad_real total[3] = {0, 0, 0};
    quad_widen(9, m->frames + 9 * c, axes);
    for (size_t i = 0; i < 6; i++) {
        const uint32_t index = i < 3 ? contact->a : contact->b;
        if (index >= m->body_count) {
            continue;
        }
        quad_real omega = (quad_real)m->bodies[index].angular_velocity[i % 3];
        omega += before ? 0 : m->change[6 * index + 3 + i % 3];
        total[i % 3] += i < 3 ? omega : -omega;
    }
    for (size_t i = 0; i < 3; i++) {
        out[i] = dot(3, axes + 3 * i, total);
    }
}

/* Diagonal of W of a torque, in double and by the library's functions: at a power of two another
 * rounding would halve the arm. */
static void find_turning_diagonal(const motion *m, size_t c, double diagonal[3])
{
    for (size_t k = 0; k < 3; k++) {
        const double *axis = m->frames + 9 * c + 3 * k;
        diagonal[k] = 0.0;
        for (size_t side = 0; side < 2; side++) {
            double inertia[6];
            double x[3];
            if (body_of(m, c, side) != NULL) {
                tribo_body_world_inverse_inertia(body_of(m, c, side), inertia);
                tribo_sym3_apply(inertia, axis, x);
                diagonal[k] += tribo_vec3_dot(axis, x);
            }
        }
    }
}

/* The arm by which torques and angular velocities are measured; system.h. */
static double arm_of_torque(const motion *m, size_t c, const double turning[3])
{
    const tribo_system_contact *contact = &m->contacts[c];
    tribo_body world;
    double w[6];
    tribo_body_init(&world);
    const tribo_body *a = body_of(m, c, 0);
    const tribo_body *b = body_of(m, c, 1);
    world.inverse_mass = 0.0;
    if (tribo_contact_matrix(a != NULL ? a : &world, b != NULL ? b : &world, &contact->contact,
                             m->frames + 9 * c, w) != TRIBO_OK) {
        abort();
    }
    const double most = greater(w[0], greater(w[3], w[5]));
    const double most_turning = greater(turning[0], greater(turning[1], turning[2]));
    if (!(most_turning > 0.0)) {
        return ldexp(1.0, ilogb(greater(contact->rolling, contact->spinning)));
    }
    return ldexp(1.0, (int)floor((ilogb(most) - ilogb(most_turning)) / 2.0));
}

/* The torque of contact c; `of` is the view of the contact. */
static void see_torque(const motion *m, size_t c, const view *of, view *out)
{
    const tribo_system_contact *contact = &m->contacts[c];
    double diagonal[3];
    find_turning_diagonal(m, c, diagonal);
    const double arm = arm_of_torque(m, c, diagonal);
    find_turning(m, c, 1, out->q);
    find_turning(m, c, 0, out->u);
    out->is_torque = 1;
    out->normal = of->r[0];
    out->lengths[0] = (quad_real)contact->spinning / (quad_real)arm;
    out->lengths[1] = (quad_real)contact->rolling / (quad_real)arm;
    out->speed = arm * find_turning_speed(m, c, out) + of->speed;
    out->trace = arm * arm * (diagonal[0] + diagonal[1] + diagonal[2]);
    out->greatest = arm * arm * greater(diagonal[0], greater(diagonal[1], diagonal[2]));
    out->greatest = out->greatest > 0.0 ? out->greatest : of->greatest;
    for (size_t i = 0; i < 3; i++) {
        out->q[i] *= (quad_real)arm;
        out->u[i] *= (quad_real)arm;
        out->r[i] = (quad_real)m->torques[3 * c + i] / (quad_real)arm;
    }
    for (size_t side = 0; side < 2; side++) {
        const uint32_t index = side == 0 ? contact->a : contact->b;
        if (index < m->body_count) {
            out->noise +=
                EPS * arm * (length3(m->bodies[index].angular_velocity) + m->summed[2 * index + 1]);
        }
    }
}

/* Size of what u is summed from, in double: its rounding is some eps of it. */
static double velocity_size(const motion *m, size_t c)
{
    double size = length3(m->contacts[c].target);
    for (size_t side = 0; side < 2; side++) {
        const tribo_system_contact *contact = &m->contacts[c];
        const uint32_t index = side == 0 ? contact->a : contact->b;
        if (index < m->body_count) {
            const tribo_body *body = &m->bodies[index];
            size += length3(body->velocity) + m->summed[2 * index];
            size += (length3(body->angular_velocity) + m->summed[2 * index + 1]) *
                    length3(arm_of(m, c, side));
        }
    }
    return size;
}

/* ---- momentum -------------------------------------------------------------------------------- */

/* Spin of omega: solves I^-1 x = omega in body axes, in which a row of zeros is an axis that
 * cannot turn and takes no part. */
static void spin_of(const tribo_body *body, const quad_real omega[3], quad_real out[3])
{
    static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    quad_real inverse[6];
    quad_real turned[3];
    quad_real x[3];
    quad_widen(6, body->inverse_inertia, inverse);
    turn(body->orientation, -1, omega, turned);
    for (size_t i = 0; i < 3; i++) {
        turned[i] = -turned[i];
        if (body->inverse_inertia[entry[i][i]] == 0.0) {
            inverse[entry[i][i]] = 1;
            turned[i] = 0;
        }
    }
    if (!quad_stick(inverse, turned, x)) {
        abort();
    }
    turn(body->orientation, 1, x, out);
}

/* Trace of the inertia, kg m^2: what an error of the angular velocity may be worth. */
static double inertia_size(const tribo_body *body)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; k++) {
        quad_real axis[3] = {0, 0, 0};
        quad_real spin[3];
        axis[k] = 1;
        spin_of(body, axis, spin);
        sum += (double)spin[k];
    }
    return sum;
}

static int finite_momentum(const tribo_body *body)
{
    return body->inverse_mass > 0.0;
}

/* Bodies that something holds: an axis that cannot turn, or a centre that cannot move. */
static int is_held(const tribo_body *body)
{
    const double *inverse = body->inverse_inertia;
    const int all = inverse[0] > 0.0 && inverse[3] > 0.0 && inverse[5] > 0.0;
    return moves(body) && !(all && finite_momentum(body));
}

/* The impulse of the world on a body, and its moment about the origin; of a contact between two
 * bodies, the moment of the gap between their points. */
static void add_world(const motion *m, size_t c, const quad_real r[3], quad_real linear[3],
                      quad_real angular[3], quad_real gap[3])
{
    const int lone = body_of(m, c, 0) == NULL || body_of(m, c, 1) == NULL;
    quad_real axes[9];
    quad_real p[3];
    quad_widen(9, m->frames + 9 * c, axes);
    for (size_t i = 0; i < 3; i++) {
        p[i] = axes[i] * r[0] + axes[3 + i] * r[1] + axes[6 + i] * r[2];
    }
    for (size_t side = 0; side < 2; side++) {
        const tribo_body *body = body_of(m, c, side);
        quad_real *sum = lone ? angular : gap;
        quad_real point[3];
        quad_real moment[3];
        if (body == NULL || !finite_momentum(body)) {
            continue;
        }
        for (size_t i = 0; i < 3; i++) {
            point[i] = (quad_real)body->position[i] + (quad_real)arm_of(m, c, side)[i];
        }
        cross(point, p, moment);
        for (size_t i = 0; i < 3; i++) {
            linear[i] += side == 0 ? p[i] : -p[i];
            sum[i] += side == 0 ? moment[i] : -moment[i];
        }
    }
}

/* The torque of the world on a body. */
static void add_world_torque(const motion *m, size_t c, quad_real angular[3])
{
    quad_real moment[3];
    moment_of(m, c, moment);
    for (size_t side = 0; side < 2; side++) {
        const tribo_body *body = body_of(m, c, side);
        const int lone = body_of(m, c, 1 - side) == NULL;
        for (size_t i = 0; i < 3 && lone && body != NULL && finite_momentum(body); i++) {
            angular[i] += side == 0 ? moment[i] : -moment[i];
        }
    }
}

/* Momentum that the velocities given gained, less what the impulses of the world brought in. */
static void check_momentum(const motion *m, const double *impulses, const double *velocities,
                           quad_certificate *out)
{
    quad_real linear[3] = {0, 0, 0};
    quad_real angular[3] = {0, 0, 0};
    quad_real gap[3] = {0, 0, 0};
    double linear_scale = 0.0;
    double linear_sum = 0.0;
    double angular_scale = 0.0;
    double angular_sum = 0.0;
    size_t held = 0;
    for (size_t c = 0; c < m->count; c++) {
        quad_real r[3];
        quad_widen(3, impulses + 3 * c, r);
        add_world(m, c, r, linear, angular, gap);
        if (m->torques != NULL) {
            add_world_torque(m, c, angular);
        }
    }
    for (size_t b = 0; b < m->body_count; b++) {
        const tribo_body *body = &m->bodies[b];
        quad_real change[6];
        quad_real spin[3] = {0, 0, 0};
        quad_real position[3];
        quad_real orbit[3];
        held += (size_t)is_held(body);
        if (!finite_momentum(body)) {
            continue;
        }
        const quad_real mass = 1 / (quad_real)body->inverse_mass;
        for (size_t i = 0; i < 3; i++) {
            change[i] = (quad_real)velocities[6 * b + i] - (quad_real)body->velocity[i];
            change[3 + i] =
                (quad_real)velocities[6 * b + 3 + i] - (quad_real)body->angular_velocity[i];
        }
        quad_widen(3, body->position, position);
        cross(position, change, orbit);
        spin_of(body, change + 3, spin);
        for (size_t i = 0; i < 3; i++) {
            linear[i] -= mass * change[i];
            angular[i] -= mass * orbit[i] + spin[i];
        }
        const double m_dv = (double)(mass * length(3, change));
        const double m_v = (double)mass * (length3(body->velocity) + m->summed[2 * b]);
        const double distance = length3(body->position);
        linear_scale += m_dv;
        linear_sum += m_v;
        const double rate = length3(body->angular_velocity) + m->summed[2 * b + 1];
        angular_scale += distance * m_dv + (double)length(3, spin);
        angular_sum += distance * m_v + inertia_size(body) * rate;
    }
    if (linear_scale > 0.0) {
        out->linear = (double)(length(3, linear)) / linear_scale;
        out->linear_noise = EPS * linear_sum / linear_scale;
    }
    if (angular_scale > 0.0) {
        out->angular = (double)(length(3, angular)) / angular_scale;
        out->gap = (double)(length(3, gap)) / angular_scale;
        out->angular_noise = held > 0 ? HUGE_VAL : EPS * angular_sum / angular_scale;
    }
}

/* How far the velocities given are from those of the impulses. */
static void check_velocities(const motion *m, const double *velocities, quad_certificate *out)
{
    for (size_t b = 0; b < m->body_count; b++) {
        const tribo_body *body = &m->bodies[b];
        quad_real error[6];
        for (size_t i = 0; i < 6; i++) {
            const double v = i < 3 ? body->velocity[i] : body->angular_velocity[i - 3];
            error[i] = (quad_real)velocities[6 * b + i] - (quad_real)v - m->change[6 * b + i];
        }
        const double linear = length3(body->velocity) + m->summed[2 * b];
        const double angular = length3(body->angular_velocity) + m->summed[2 * b + 1];
        const double size = linear + m->reach[b] * angular;
        const double wrong = (double)length(3, error);
        const double turned = (double)length(3, error + 3);
        if (wrong > 0.0 || turned > 0.0) {
            const double arm = m->reach[b] > 0.0 ? m->reach[b] : 1.0;
            out->velocity = greater(out->velocity, (wrong + arm * turned) / size);
        }
    }
}

/* T+ - T-, with the velocities given: sum m dv . (v + dv / 2) + spin(dw) . (w + dw / 2). */
static void check_energy(const motion *m, const double *velocities, quad_certificate *out)
{
    quad_real sum = 0;
    for (size_t b = 0; b < m->body_count; b++) {
        const tribo_body *body = &m->bodies[b];
        quad_real change[6];
        quad_real middle[6];
        quad_real spin[3] = {0, 0, 0};
        quad_real part[2] = {0, 0};
        if (!moves(body)) {
            continue;
        }
        for (size_t i = 0; i < 6; i++) {
            const double v = i < 3 ? body->velocity[i] : body->angular_velocity[i - 3];
            change[i] = (quad_real)velocities[6 * b + i] - (quad_real)v;
            middle[i] = (quad_real)v + change[i] / 2;
        }
        spin_of(body, change + 3, spin);
        part[1] = dot(3, spin, middle + 3);
        if (finite_momentum(body)) {
            part[0] = dot(3, change, middle) / (quad_real)body->inverse_mass;
        }
        const double linear = length3(body->velocity) + m->summed[2 * b];
        const double angular = length3(body->angular_velocity) + m->summed[2 * b + 1];
        const double mass = finite_momentum(body) ? 1.0 / body->inverse_mass : 0.0;
        sum += part[0] + part[1];
        out->kinetic_noise += EPS * mass * linear * linear;
        out->kinetic_noise += EPS * inertia_size(body) * angular * angular;
    }
    out->kinetic = (double)sum;
}

static void start(motion *m)
{
    m->frames = allocate(9 * m->count, sizeof *m->frames);
    m->change = allocate(6 * m->body_count, sizeof *m->change);
    m->summed = allocate(2 * m->body_count, sizeof *m->summed);
    m->sizes = allocate(6 * m->body_count, sizeof *m->sizes);
    m->reach = allocate(m->body_count, sizeof *m->reach);
    for (size_t c = 0; c < m->count; c++) {
        if (tribo_basis_from_normal(m->contacts[c].contact.normal, m->frames + 9 * c) != TRIBO_OK) {
            abort();
        }
    }
}

static void finish(motion *m)
{
    free(m->frames);
    free(m->change);
    free(m->summed);
    free(m->sizes);
    free(m->reach);
}

static int resists(const tribo_system_contact *c)
{
    return c->dimension == 3 && (c->rolling > 0.0 || c->spinning > 0.0);
}

void quad_certificate_with_torques(size_t body_count, const tribo_body *bodies, size_t count,
                                   const tribo_system_contact *contacts, const double *impulses,
                                   const double *torques, const double *velocities,
                                   quad_certificate *out)
{
    motion m = {.body_count = body_count,
                .bodies = bodies,
                .count = count,
                .contacts = contacts,
                .torques = torques};
    view *views = allocate(2 * count, sizeof *views);
    size_t seen = 0;
    memset(out, 0, sizeof *out);
    start(&m);
    for (size_t c = 0; c < count; c++) {
        quad_real r[3];
        quad_widen(3, impulses + 3 * c, r);
        add_impulse(&m, c, r);
        if (torques != NULL) {
            add_torque(&m, c);
        }
    }
    find_sizes(&m, impulses);
    for (size_t c = 0; c < count; c++) {
        view *v = &views[seen++];
        double w[9];
        quad_widen(3, impulses + 3 * c, v->r);
        const int one_row = contacts[c].dimension == 1;
        v->mu[0] = one_row ? 0.0 : contacts[c].pair.mu_s;
        v->mu[1] = one_row ? 0.0 : contacts[c].pair.mu_d;
        find_velocity(&m, c, 1, v->q);
        find_velocity(&m, c, 0, v->u);
        find_matrix(&m, c, w);
        find_diagonal(w, v);
        v->speed = find_speed(&m, c, v);
        v->noise = EPS * velocity_size(&m, c);
        if (torques != NULL && resists(&contacts[c])) {
            see_torque(&m, c, v, &views[seen++]);
        }
    }
    judge_all(seen, views, out);
    if (velocities != NULL) {
        check_energy(&m, velocities, out);
        check_momentum(&m, impulses, velocities, out);
        check_velocities(&m, velocities, out);
    }
    finish(&m);
    free(views);
}

void quad_certificate_of_bodies(size_t body_count, const tribo_body *bodies, size_t count,
                                const tribo_system_contact *contacts, const double *impulses,
                                const double *velocities, quad_certificate *out)
{
    quad_certificate_with_torques(body_count, bodies, count, contacts, impulses, NULL, velocities,
                                  out);
}

/* ---- assembled ------------------------------------------------------------------------------- */

void quad_certificate_of_blocks(size_t count, const uint32_t *row_starts, const uint32_t *columns,
                                const double *blocks, const double *q, const double *mu,
                                const double *impulses, const double *velocities,
                                quad_certificate *out)
{
    view *views = allocate(count, sizeof *views);
    memset(out, 0, sizeof *out);
    for (size_t c = 0; c < count; c++) {
        view *v = &views[c];
        const size_t begin = row_starts != NULL ? row_starts[c] : 0;
        const size_t end = row_starts != NULL ? row_starts[c + 1] : count;
        v->mu[0] = mu[2 * c];
        v->mu[1] = mu[2 * c + 1];
        quad_widen(3, q + 3 * c, v->q);
        quad_widen(3, q + 3 * c, v->u);
        quad_widen(3, impulses + 3 * c, v->r);
        double own[9] = {0};
        double size[3] = {0.0, 0.0, 0.0};
        for (size_t k = begin; k < end; k++) {
            const size_t d = row_starts != NULL ? columns[k] : k;
            for (size_t i = 0; i < 9; i++) {
                const double w = row_starts != NULL
                                     ? blocks[9 * k + i]
                                     : blocks[(3 * c + i / 3) * 3 * count + 3 * d + i % 3];
                v->u[i / 3] += (quad_real)w * (quad_real)impulses[3 * d + i % 3];
                size[i / 3] += fabs(w * impulses[3 * d + i % 3]);
                if (d == c) {
                    own[i] = w;
                }
            }
        }
        find_diagonal(own, v);
        v->speed = (double)length(3, v->q) + length3(size);
        v->noise = EPS * v->speed;
        for (size_t i = 0; i < 3 && velocities != NULL; i++) {
            const double wrong = (double)((quad_real)velocities[3 * c + i] - v->u[i]);
            if (!(wrong == 0.0)) {
                out->velocity = greater(out->velocity, fabs(wrong) / v->speed);
            }
        }
    }
    judge_all(count, views, out);
    free(views);
}

/* ---- comparison ------------------------------------------------------------------------------ */

double quad_certificate_difference(const quad_certificate *truth, const tribo_system_info *info,
                                   const char **name)
{
    const struct {
        const char *name;
        double truth;
        double got;
        double noise;
    } pairs[] = {
        {"eta", truth->eta, info->eta, truth->contact_noise},
        {"eta_rms", truth->eta_rms, info->eta_rms, truth->contact_noise},
        {"signorini", truth->signorini, info->signorini, truth->contact_noise},
        {"cone", truth->cone, info->cone, truth->contact_noise},
        {"misalignment", truth->misalignment, info->misalignment, truth->misalignment_noise},
        {"invariant", truth->invariant, info->invariant, truth->invariant_noise},
        {"siconos", truth->siconos, info->siconos, truth->siconos_noise},
        {"energy", truth->energy, info->energy, truth->energy_noise},
        {"energy_scale", truth->energy_scale, info->energy_scale, truth->energy_noise},
        {"linear", truth->linear, info->linear, truth->linear_noise},
        {"angular", truth->angular, info->angular, truth->angular_noise},
    };
    double worst = 0.0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        const double difference = fabs(pairs[i].got - pairs[i].truth);
        const double units = difference == 0.0 ? 0.0 : difference / pairs[i].noise;
        if (!(units <= worst)) {
            worst = units >= 0.0 ? units : HUGE_VAL;
            if (name != NULL) {
                *name = pairs[i].name;
            }
        }
    }
    return worst;
}
