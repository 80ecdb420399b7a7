/* Eight contacts at a time. Each stage is one loop over the lanes around branch-free scalar
 * arithmetic of kernel.h, which compilers turn into vector code; lanes that have settled are
 * frozen, so each goes through exactly the operations of its scalar solve. Loading turns
 * contact-major arrays into lanes. */
#include "kernel.h"
#include "lanes.h"
#include "rows.h"

#ifndef TRIBO_LANES
#define TRIBO_LANES baseline
#endif
#define PASTE_TWO(a, b) a##b
#define PASTE(a, b) PASTE_TWO(a, b)

typedef double lane_row[LANES];

/* rows[k][i] = array[i * width + k], the last contact repeated in lanes beyond `count`. */
TRIBO_ALWAYS_INLINE void load_rows(const double *array, int width, size_t count, lane_row *rows)
{
    for (int k = 0; k < width && count == LANES; k++) {
        for (int i = 0; i < LANES; i++) {
            rows[k][i] = array[i * width + k];
        }
    }
    if (count == LANES) {
        return;
    }
    for (size_t i = 0; i < LANES; i++) {
        const double *from = array + (i < count ? i : count - 1) * (size_t)width;
        for (int k = 0; k < width; k++) {
            rows[k][i] = from[k];
        }
    }
}

/* ---- exact solve ----------------------------------------------------------------------------- */

typedef struct lane_problem {
    lane_row nn, n1, n2, t11, t12, t22, bn, b1, b2, up, up2, fault;
} lane_problem;

typedef struct lane_slip {
    lane_row inverse_a, bn, n1, n2, c1, c2, e1, e2, trace, det, mu_s, inverse_mu;
    lane_row A, B, C, alpha, beta, gamma, least, nu, mode;
} lane_slip;

static void scale_lanes(lane_row *restrict w, lane_row *restrict b, lane_problem *restrict out)
{
    for (int i = 0; i < LANES; i++) {
        const double wi[6] = {w[0][i], w[1][i], w[2][i], w[3][i], w[4][i], w[5][i]};
        const double bi[3] = {b[0][i], b[1][i], b[2][i]};
        kernel_problem k;
        kernel_scale(wi, bi, &k);
        out->nn[i] = k.nn;
        out->n1[i] = k.n1;
        out->n2[i] = k.n2;
        out->t11[i] = k.t11;
        out->t12[i] = k.t12;
        out->t22[i] = k.t22;
        out->bn[i] = k.bn;
        out->b1[i] = k.b1;
        out->b2[i] = k.b2;
        out->up[i] = k.up;
        out->up2[i] = k.up2;
        out->fault[i] = k.fault;
    }
}

TRIBO_ALWAYS_INLINE kernel_problem problem_of(const lane_problem *p, int i)
{
    const kernel_problem k = {p->nn[i], p->n1[i], p->n2[i], p->t11[i], p->t12[i], p->t22[i],
                              p->bn[i], p->b1[i], p->b2[i], p->up[i],  p->up2[i], p->fault[i]};
    return k;
}

static void prepare_lanes(const lane_problem *restrict p, lane_row *restrict mu,
                          lane_slip *restrict out)
{
    for (int i = 0; i < LANES; i++) {
        const kernel_problem k = problem_of(p, i);
        kernel_slip e;
        kernel_prepare(&k, mu[0][i], mu[1][i], &e);
        out->inverse_a[i] = e.inverse_a;
        out->bn[i] = e.bn;
        out->n1[i] = e.n1;
        out->n2[i] = e.n2;
        out->c1[i] = e.c1;
        out->c2[i] = e.c2;
        out->e1[i] = e.e1;
        out->e2[i] = e.e2;
        out->trace[i] = e.trace;
        out->det[i] = e.det;
        out->mu_s[i] = e.mu_s;
        out->inverse_mu[i] = e.inverse_mu;
        out->A[i] = e.A;
        out->B[i] = e.B;
        out->C[i] = e.C;
        out->alpha[i] = e.alpha;
        out->beta[i] = e.beta;
        out->gamma[i] = e.gamma;
        out->least[i] = e.least;
        out->nu[i] = e.nu;
        out->mode[i] = e.mode;
    }
}

TRIBO_ALWAYS_INLINE kernel_slip slip_of(const lane_slip *s, int i)
{
    const kernel_slip e = {
        s->inverse_a[i], s->bn[i], s->n1[i],    s->n2[i],    s->c1[i],   s->c2[i],
        s->e1[i],        s->e2[i], s->trace[i], s->det[i],   s->mu_s[i], s->inverse_mu[i],
        s->A[i],         s->B[i],  s->C[i],     s->alpha[i], s->beta[i], s->gamma[i],
        s->least[i],     s->nu[i], s->mode[i],
    };
    return e;
}

/* One step of all lanes that slip and have not settled; open[i] is 1 there. Returns how many go
 * on. */
static double step_lanes(lane_slip *restrict s, double *restrict open)
{
    double left = 0.0;
    for (int i = 0; i < LANES; i++) {
        const kernel_slip e = slip_of(s, i);
        double nu = e.nu;
        const int settled = kernel_halley(&e, &nu);
        s->nu[i] = open[i] != 0.0 ? nu : e.nu;
        open[i] = settled ? 0.0 : open[i];
        left += open[i];
    }
    return left;
}

static void finish_lanes(const lane_slip *restrict s, const lane_problem *restrict k,
                         lane_row *restrict p)
{
    for (int i = 0; i < LANES; i++) {
        const kernel_slip e = slip_of(s, i);
        const int slips = e.mode == KERNEL_SLIP;
        double impulse[3];
        kernel_finish(&e, slips ? e.nu : 0.0, slips, impulse);
        p[0][i] = impulse[0] * k->up[i] * k->up2[i];
        p[1][i] = impulse[1] * k->up[i] * k->up2[i];
        p[2][i] = impulse[2] * k->up[i] * k->up2[i];
    }
}

/* Open contacts have no impulse. odd[i] becomes 1 where a lane wants a closer look: an odd mode, a
 * lane that has not settled, an impulse beyond double. Returns how many. */
static double settle_lanes(lane_row *restrict p, const double *restrict mode,
                           const double *restrict open, double *restrict odd)
{
    for (int i = 0; i < LANES; i++) {
        const double m = mode[i];
        const double p0 = m == KERNEL_OPEN ? 0.0 : p[0][i];
        const double p1 = m == KERNEL_OPEN ? 0.0 : p[1][i];
        const double p2 = m == KERNEL_OPEN ? 0.0 : p[2][i];
        const double probe = ((p0 - p0) + (p1 - p1) + (p2 - p2)) + open[i];
        const double by_mode = m <= KERNEL_SLIP ? 0.0 : 1.0;
        p[0][i] = p0;
        p[1][i] = p1;
        p[2][i] = p2;
        odd[i] = probe == 0.0 ? by_mode : 1.0;
    }
    return ((odd[0] + odd[1]) + (odd[2] + odd[3])) + ((odd[4] + odd[5]) + (odd[6] + odd[7]));
}

/* One lane's impulse and mode to the caller. */
TRIBO_ALWAYS_INLINE void store_lane(lane_row *p_rows, double mode, size_t i, double *p,
                                    uint32_t *modes, tribo_status *statuses, tribo_status *first)
{
    p[3 * i] = p_rows[0][i];
    p[3 * i + 1] = p_rows[1][i];
    p[3 * i + 2] = p_rows[2][i];
    lanes_give(TRIBO_OK, (uint32_t)(int)mode, i, modes, statuses, first);
}

static void solve_block(size_t count, const double *w, const double *b, const double *mu, double *p,
                        uint32_t *modes, tribo_status *statuses, tribo_status *first)
{
    lane_row w_rows[6];
    lane_row b_rows[3];
    lane_row mu_rows[2];
    lane_row p_rows[3];
    lane_problem problem;
    lane_slip slip;
    lane_row open;
    lane_row odd;
    double left = 0.0;
    load_rows(w, 6, count, w_rows);
    load_rows(b, 3, count, b_rows);
    load_rows(mu, 2, count, mu_rows);
    scale_lanes(w_rows, b_rows, &problem);
    prepare_lanes(&problem, mu_rows, &slip);
    for (int i = 0; i < LANES; i++) {
        open[i] = slip.mode[i] == KERNEL_SLIP ? 1.0 : 0.0;
        left += open[i];
    }
    for (int step = 0; step < MAX_HALLEY && left > 0.0; step++) {
        left = step_lanes(&slip, open);
    }
    finish_lanes(&slip, &problem, p_rows);
    const double any_odd = settle_lanes(p_rows, slip.mode, open, odd);
    for (size_t i = 0; i < count; i++) {
        if (any_odd > 0.0 && odd[i] > 0.0) {
            lanes_solve_one(w, b, mu, i, p, modes, statuses, first);
        } else {
            store_lane(p_rows, slip.mode[i], i, p, modes, statuses, first);
        }
    }
}

static tribo_status solve(size_t count, const double *w, const double *b, const double *mu,
                          double *p, uint32_t *modes, tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i += LANES) {
        const size_t here = count - i < LANES ? count - i : LANES;
        solve_block(here, w + 6 * i, b + 3 * i, mu + 2 * i, p + 3 * i, modes ? modes + i : NULL,
                    statuses ? statuses + i : NULL, &first);
    }
    return first;
}

/* ---- ALGEBRAIC impact ------------------------------------------------------------------------ */

static void impact_lanes(const lane_problem *restrict problem, lane_row *restrict pair,
                         lane_row *restrict p, double *restrict modes)
{
    for (int i = 0; i < LANES; i++) {
        const kernel_problem k = problem_of(problem, i);
        kernel_algebraic result;
        kernel_solve_algebraic(&k, pair[0][i], pair[1][i], pair[2][i], 0.0, &result);
        p[0][i] = result.p[0] * k.up * k.up2;
        p[1][i] = result.p[1] * k.up * k.up2;
        p[2][i] = result.p[2] * k.up * k.up2;
        modes[i] = result.mode;
    }
}

static void impact_block(size_t count, const double *w, const double *u,
                         const tribo_material *pairs, double *p, uint32_t *modes,
                         tribo_status *statuses, tribo_status *first)
{
    lane_row w_rows[6];
    lane_row u_rows[3];
    lane_row pair_rows[3];
    lane_row p_rows[3];
    lane_problem problem;
    lane_row mode;
    lane_row odd;
    const lane_row open = {0.0};
    load_rows(w, 6, count, w_rows);
    load_rows(u, 3, count, u_rows);
    load_rows(&pairs[0].mu_s, 3, count, pair_rows);
    scale_lanes(w_rows, u_rows, &problem);
    impact_lanes(&problem, pair_rows, p_rows, mode);
    const double any_odd = settle_lanes(p_rows, mode, open, odd);
    for (size_t i = 0; i < count; i++) {
        if (any_odd > 0.0 && odd[i] > 0.0) {
            lanes_impact_one(w, u, pairs, i, p, modes, statuses, first);
        } else {
            store_lane(p_rows, mode[i], i, p, modes, statuses, first);
        }
    }
}

static tribo_status impact(size_t count, const double *w, const double *u,
                           const tribo_material *pairs, double *p, uint32_t *modes,
                           tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i += LANES) {
        const size_t here = count - i < LANES ? count - i : LANES;
        impact_block(here, w + 6 * i, u + 3 * i, pairs + i, p + 3 * i, modes ? modes + i : NULL,
                     statuses ? statuses + i : NULL, &first);
    }
    return first;
}

/* ---- contact matrix -------------------------------------------------------------------------- */

typedef struct lane_body {
    lane_row q[4], inverse_mass, inertia[6], arm[3];
} lane_body;

TRIBO_ALWAYS_INLINE void load_body(const tribo_body *body, const double arm[3], int i,
                                   lane_body *out)
{
    for (int k = 0; k < 4; k++) {
        out->q[k][i] = body->orientation[k];
    }
    for (int k = 0; k < 6; k++) {
        out->inertia[k][i] = body->inverse_inertia[k];
    }
    for (int k = 0; k < 3; k++) {
        out->arm[k][i] = arm[k];
    }
    out->inverse_mass[i] = body->inverse_mass;
}

static void frame_lanes(lane_row *normal, lane_row *frame)
{
    for (int i = 0; i < LANES; i++) {
        double rows[9];
        basis_rows(normal[0][i], normal[1][i], normal[2][i], rows);
        for (int k = 0; k < 9; k++) {
            frame[k][i] = rows[k];
        }
    }
}

static void mobility_lanes(const lane_body *body, lane_row *frame, lane_row *out)
{
    for (int i = 0; i < LANES; i++) {
        double r[9];
        double own[6];
        double rows[9];
        const double arm[3] = {body->arm[0][i], body->arm[1][i], body->arm[2][i]};
        const double inertia[6] = {body->inertia[0][i], body->inertia[1][i], body->inertia[2][i],
                                   body->inertia[3][i], body->inertia[4][i], body->inertia[5][i]};
        for (int k = 0; k < 9; k++) {
            rows[k] = frame[k][i];
        }
        rotation_rows(body->q[0][i], body->q[1][i], body->q[2][i], body->q[3][i], r);
        kernel_mobility(r, inertia, 0, arm, rows, own);
        for (int k = 0; k < 6; k++) {
            out[k][i] = own[k];
        }
    }
}

/* Each lane by itself: in a sum, a faulty neighbour could hide the others. */
static int any_inertia(const lane_body *body)
{
    int any = 0;
    for (int i = 0; i < LANES; i++) {
        const double *const diagonal[3] = {body->inertia[0], body->inertia[3], body->inertia[5]};
        any |= diagonal[0][i] != 0.0 || diagonal[1][i] != 0.0 || diagonal[2][i] != 0.0;
    }
    return any;
}

static void matrix_lanes(const lane_body ends[2], lane_row *frame, lane_row *w)
{
    lane_row mobility[2][6] = {{{0.0}}};
    for (int end = 0; end < 2; end++) {
        if (any_inertia(&ends[end])) {
            mobility_lanes(&ends[end], frame, mobility[end]);
        }
    }
    for (int i = 0; i < LANES; i++) {
        double of_a[6];
        double of_b[6];
        double own[6];
        for (int k = 0; k < 6; k++) {
            of_a[k] = mobility[0][k][i];
            of_b[k] = mobility[1][k][i];
        }
        kernel_join(ends[0].inverse_mass[i] + ends[1].inverse_mass[i], of_a, of_b, own);
        for (int k = 0; k < 6; k++) {
            w[k][i] = own[k];
        }
    }
}

static tribo_status judge_bodies(const tribo_body *const ends[2])
{
    const tribo_status status = tribo_body_check(ends[0]);
    return status == TRIBO_OK ? tribo_body_check(ends[1]) : status;
}

/* Load up to eight contacts; lanes beyond `count` repeat the last. */
static void load_contacts(size_t body_count, const tribo_body *bodies, size_t count,
                          const uint32_t *pairs, const tribo_contact *contacts, lane_body ends[2],
                          lane_row *normal, tribo_status *statuses)
{
    const tribo_body *pair[2] = {NULL, NULL};
    tribo_status pair_status = TRIBO_OK;
    tribo_status body_status = TRIBO_OK;
    for (int i = 0; i < LANES; i++) {
        const size_t at = (size_t)i < count ? (size_t)i : count - 1;
        const uint32_t *now = pairs + 2 * at;
        /* The points of a manifold follow each other; their bodies are judged once. */
        if (at == 0 || now[0] != now[-2] || now[1] != now[-1]) {
            pair_status = lanes_find_pair(body_count, bodies, now, pair);
            body_status = judge_bodies(pair);
        }
        const tribo_status contact_status = tribo_contact_check(contacts + at);
        const tribo_status geometry = pair_status != TRIBO_OK ? pair_status : contact_status;
        statuses[i] = geometry != TRIBO_OK ? geometry : body_status;
        load_body(pair[0], contacts[at].arm_a, i, &ends[0]);
        load_body(pair[1], contacts[at].arm_b, i, &ends[1]);
        for (int k = 0; k < 3; k++) {
            normal[k][i] = contacts[at].normal[k];
        }
    }
}

static tribo_status judge_matrix(tribo_status status, const double w[6])
{
    if (status == TRIBO_OK && !all_finite(w, 6)) {
        return TRIBO_ERROR_RANGE;
    }
    return status == TRIBO_OK && !(w[0] > 0.0) ? TRIBO_ERROR_IMMOVABLE : status;
}

static void matrix_block(size_t body_count, const tribo_body *bodies, size_t count,
                         const uint32_t *pairs, const tribo_contact *contacts, double *frames,
                         double *w, tribo_status *statuses, tribo_status *first)
{
    lane_body ends[2];
    lane_row normal[3];
    lane_row frame[9];
    lane_row matrix[6];
    tribo_status judged[LANES];
    load_contacts(body_count, bodies, count, pairs, contacts, ends, normal, judged);
    frame_lanes(normal, frame);
    matrix_lanes(ends, frame, matrix);
    for (size_t i = 0; i < count; i++) {
        double entries[6];
        for (int k = 0; k < 6; k++) {
            entries[k] = matrix[k][i];
        }
        const tribo_status status = judge_matrix(judged[i], entries);
        if (status == TRIBO_OK) {
            memcpy(w + 6 * i, entries, sizeof entries);
        }
        for (size_t k = 0; k < 9 && frames && status == TRIBO_OK; k++) {
            frames[9 * i + k] = frame[k][i];
        }
        lanes_give(status, 0, i, NULL, statuses, first);
    }
}

static tribo_status matrix(size_t body_count, const tribo_body *bodies, size_t count,
                           const uint32_t *pairs, const tribo_contact *contacts, double *frames,
                           double *w, tribo_status *statuses)
{
    tribo_status first = TRIBO_OK;
    for (size_t i = 0; i < count; i += LANES) {
        const size_t here = count - i < LANES ? count - i : LANES;
        matrix_block(body_count, bodies, here, pairs + 2 * i, contacts + i,
                     frames ? frames + 9 * i : NULL, w + 6 * i, statuses ? statuses + i : NULL,
                     &first);
    }
    return first;
}

const lanes_table PASTE(lanes_, TRIBO_LANES) = {matrix, solve, impact};
