#include "resist.h"

#include "dense.h"

/* Of the velocities that F is summed from: where Newton ends, and what counts as solved. */
#define ROUNDING (4.0 * TRIBO_EPS)
#define SOLVED 1e-10
#define NEWTON_STEPS 20
#define LEAST_LENGTH 1e-3
#define MEMORY 4
#define ROUNDS 4
#define WON 0.5 /* of the residual: what a round must bring for one more */
#define FIRST_PASSES 4

enum { STRIDE = 8 };

static const dense_shape six = {6, 6, STRIDE, 0, 6 * STRIDE};

/* ---- the map --------------------------------------------------------------------------------- */

uint32_t resist_map(double g, const double limits[2], const double r[3], const double u[3],
                    double f[3], double y[3])
{
    double projected[3];

    for (int k = 0; k < 3; k++)
        y[k] = g * r[k] - u[k];
    resist_project(y, limits, projected);
    for (int k = 0; k < 3; k++)
        f[k] = g * r[k] - projected[k];
    return projected[0] == y[0] && projected[1] == y[1] && projected[2] == y[2] ? STICK : SLIP;
}

void resist_linearize(double g, double alpha, const double limits[2], const double lengths[2],
                      const double y[3], double slope[9], double own[9], double lead[3])
{
    const double t = planar_length(y[1], y[2]);
    const int spins = absolute(y[0]) > limits[0] || !(limits[0] > 0.0);
    const int rolls = t > limits[1] || !(limits[1] > 0.0);
    const double h1 = rolls && t > 0.0 ? y[1] / t : 0.0;
    const double h2 = rolls && t > 0.0 ? y[2] / t : 0.0;
    const double across = rolls ? (t > 0.0 ? limits[1] / t : 0.0) : 1.0;

    for (int i = 0; i < 9; i++)
        slope[i] = 0.0;
    slope[0] = spins ? 0.0 : 1.0;
    slope[4] = across * (1.0 - h1 * h1);
    slope[5] = slope[7] = 0.0 - across * h1 * h2;
    slope[8] = across * (1.0 - h2 * h2);
    lead[0] = spins && y[0] != 0.0 ? copysign(g * lengths[0], y[0]) : 0.0;
    lead[1] = g * lengths[1] * h1;
    lead[2] = g * lengths[1] * h2;
    for (int i = 0; i < 9; i++)
        own[i] = g * ((i % 4 == 0 ? 1.0 : 0.0) - slope[i]) + alpha * slope[i];
}

/* ---- one contact and its torque -------------------------------------------------------------- */

/* out += T J T'^T, with J = (00, 01, 02, 11, 12, 22). */
static void add_mobility(const double *turn, const double *other, const double j[6], double out[9])
{
    for (int i = 0; i < 3; i++) {
        const double *t = turn + 3 * i;
        const double x = j[0] * t[0] + j[1] * t[1] + j[2] * t[2];
        const double y = j[1] * t[0] + j[3] * t[1] + j[4] * t[2];
        const double z = j[2] * t[0] + j[4] * t[1] + j[5] * t[2];
        for (int k = 0; k < 3; k++) {
            const double *o = other + 3 * k;
            out[3 * i + k] += x * o[0] + y * o[1] + z * o[2];
        }
    }
}

void resist_fill(const system_problem *p, size_t c, double alpha, resist_block *out)
{
    const double *own = p->diagonal + 9 * c;
    double across[9] = {0.0};

    for (size_t side = 0; side < 2; side++) {
        const uint32_t body = p->pairs[2 * c + side];
        if (body != TRIBO_WORLD)
            add_mobility(p->turns + 18 * c + 9 * side, p->turns + 18 * (c + 1) + 9 * side,
                         p->inverse_inertia + 6 * (size_t)body, across);
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            const double shift = i == k ? alpha : 0.0;
            out->w[6 * i + k] = own[3 * i + k] + shift;
            out->w[6 * i + 3 + k] = across[3 * i + k];
            out->w[6 * (3 + k) + i] = across[3 * i + k];
            out->w[6 * (3 + i) + 3 + k] = own[9 + 3 * i + k] + shift;
        }
    }
    out->mu = p->mu[2 * c];
    for (size_t k = 0; k < 2; k++)
        out->lengths[k] = p->lengths != NULL ? p->lengths[2 * (c + 1) + k] : 0.0;
}

/* A block scaled by powers of two, and where its solve is. */
typedef struct local {
    resist_block block;
    double gain[2];
    double x[6], f[6];
} local;

/* What F was evaluated with. */
typedef struct local_map {
    double u[6], y[6];
    double limits[2];
    uint32_t mode[2];
    double size; /* of the sums in u */
} local_map;

static double length6(const double x[6])
{
    double sum = 0.0;
    for (int i = 0; i < 6; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

/* |F| at x. */
static double evaluate(const local *l, const double x[6], double f[6], local_map *at)
{
    double sizes[6];

    for (int i = 0; i < 6; i++) {
        const double *w = l->block.w + 6 * i;
        at->u[i] = l->block.b[i];
        sizes[i] = absolute(l->block.b[i]);
        for (int k = 0; k < 6; k++) {
            at->u[i] += w[k] * x[k];
            sizes[i] += absolute(w[k] * x[k]);
        }
    }
    at->size = length6(sizes);
    at->mode[0] = natural_map(l->gain[0], l->block.mu, x, at->u, f, at->y);
    const double normal = resist_normal(l->gain[0], x[0], f[0]);
    for (int k = 0; k < 2; k++)
        at->limits[k] = l->gain[1] * (l->block.lengths[k] * normal);
    at->mode[1] = resist_map(l->gain[1], at->limits, x + 3, at->u + 3, f + 3, at->y + 3);
    return length6(f);
}

/* Step of Newton; 0 if the matrix is singular. */
static int find_step(const local *l, const local_map *at, double step[6])
{
    double a[6 * STRIDE] = {0.0};
    double slope[18];
    double own[18];
    double lead[3];
    uint32_t pivots[6];

    natural_linearize(at->mode[0], l->gain[0], 0.0, l->block.mu, at->u, at->y, l->f, slope, own,
                      step);
    resist_linearize(l->gain[1], 0.0, at->limits, l->block.lengths, at->y + 3, slope + 9, own + 9,
                     lead);
    for (int i = 0; i < 6; i++) {
        const double *s = slope + 9 * (i / 3) + 3 * (i % 3);
        const double *w = l->block.w + 18 * (i / 3);
        for (int k = 0; k < 6; k++)
            a[STRIDE * i + k] = s[0] * w[k] + s[1] * w[6 + k] + s[2] * w[12 + k];
        for (int k = 0; k < 3; k++)
            a[STRIDE * i + i / 3 * 3 + k] += own[9 * (i / 3) + 3 * (i % 3) + k];
    }
    for (int i = 0; i < 3; i++) {
        a[STRIDE * (3 + i)] -= lead[i];
        step[3 + i] = l->f[3 + i] - lead[i] * (l->f[0] / l->gain[0]);
    }
    for (int i = 0; i < 6; i++)
        step[i] = 0.0 - step[i];
    if (!dense_baseline.lu(&six, a, pivots))
        return 0;
    dense_baseline.lu_solve(&six, a, pivots, step);
    return 1;
}

/* Newton from x on until F is down to rounding. Returns |F|, and the size it is measured by. */
static double iterate(local *l, double *size)
{
    local_map at;
    double past[MEMORY];
    double f = evaluate(l, l->x, l->f, &at);

    for (int i = 0; i < MEMORY; i++)
        past[i] = f;
    *size = at.size;
    for (int n = 0; n < NEWTON_STEPS && f > ROUNDING * *size; n++) {
        double step[6];
        double next[6];
        double next_f[6];
        double now = f;
        double bound = 0.0;
        double t = 1.0;
        for (int i = 0; i < MEMORY; i++)
            bound = greater(bound, past[i]);
        if (f <= SOLVED * *size)
            bound = f;
        if (!find_step(l, &at, step))
            break;
        for (; t > LEAST_LENGTH; t *= 0.5) {
            for (int i = 0; i < 6; i++)
                next[i] = l->x[i] + t * step[i];
            now = evaluate(l, next, next_f, &at);
            if (now < (1.0 - 1e-4 * t) * bound)
                break;
        }
        if (!(now < bound))
            break;
        f = past[n % MEMORY] = now;
        *size = at.size;
        memcpy(l->x, next, sizeof next);
        memcpy(l->f, next_f, sizeof next_f);
    }
    return f;
}

/* ---- where Newton fails: contact and torque in turns ----------------------------------------- */

/* Least x A x / 2 + c x in the disc: (A + lambda) x = -c with lambda >= 0, which is 0 inside of the
 * disc (More & Sorensen, SIAM J. Sci. Stat. Comput. 4 (1983) 553). In the axes of A. */
static void solve_disc(const double a[3], const double c[2], double radius, double x[2])
{
    const double half = 0.5 * (a[0] - a[2]);
    const double root = sqrt(half * half + a[1] * a[1]);
    const double most = 0.5 * (a[0] + a[2]) + root;
    const double least = most > 0.0 ? greater(a[0] * a[2] - a[1] * a[1], 0.0) / most : 0.0;
    const double e0 = half >= 0.0 ? root + half : a[1];
    const double e1 = half >= 0.0 ? a[1] : root - half;
    const double size = sqrt(e0 * e0 + e1 * e1);
    const double e[2] = {size > 0.0 ? e0 / size : 1.0, size > 0.0 ? e1 / size : 0.0};
    const double d[2] = {0.0 - (e[0] * c[0] + e[1] * c[1]), 0.0 - (e[0] * c[1] - e[1] * c[0])};
    double lambda = sqrt(d[0] * d[0] + d[1] * d[1]) / radius - most;
    double z[2] = {0.0, 0.0};

    lambda = lambda > 0.0 ? lambda : 0.0;
    for (int n = 0; n < 64 && radius > 0.0; n++) {
        const double l[2] = {most + lambda, least + lambda};
        for (int k = 0; k < 2; k++)
            z[k] = d[k] != 0.0 ? d[k] / l[k] : 0.0;
        const double length = planar_length(z[0], z[1]);
        if (!(length > radius * (1.0 + ROUNDING)))
            break;
        const double bend =
            (z[0] / length) * (z[0] / length) / l[0] + (z[1] / length) * (z[1] / length) / l[1];
        const double more = (length / radius - 1.0) / bend;
        lambda += more == more && more < HUGE_VAL ? more : TRIBO_EPS * most;
    }
    x[0] = e[0] * z[0] - e[1] * z[1];
    x[1] = e[1] * z[0] + e[0] * z[1];
}

/* The torque for b = its velocity without itself. Least energy within the limits: convex in the
 * spin, so that the best spin in the interval is the one nearest to the best of all. */
static void solve_torque(const double w[9], const double b[3], const double limits[2],
                         double out[3])
{
    const double inverse = w[0] > 0.0 ? 1.0 / w[0] : 0.0;
    const double free[3] = {w[4] - w[1] * w[1] * inverse, w[5] - w[1] * w[2] * inverse,
                            w[8] - w[2] * w[2] * inverse};
    const double left[2] = {b[1] - w[1] * inverse * b[0], b[2] - w[2] * inverse * b[0]};
    const double held[3] = {w[4], w[5], w[8]};

    solve_disc(free, left, limits[1], out + 1);
    out[0] = 0.0 - (b[0] + w[1] * out[1] + w[2] * out[2]) * inverse;
    if (w[0] > 0.0 && absolute(out[0]) <= limits[0])
        return;
    out[0] = w[0] > 0.0    ? copysign(limits[0], out[0])
             : b[0] == 0.0 ? 0.0
                           : copysign(limits[0], -b[0]);
    const double rest[2] = {b[1] + w[1] * out[0], b[2] + w[2] * out[0]};
    solve_disc(held, rest, limits[1], out + 1);
}

static void take_turns(local *l, int passes)
{
    const double *w = l->block.w;
    const double contact[6] = {w[0], w[1], w[2], w[7], w[8], w[14]};
    const double torque[9] = {w[21], w[22], w[23], w[27], w[28], w[29], w[33], w[34], w[35]};
    double *x = l->x;

    for (int n = 0; n < passes; n++) {
        double b[6];
        double limits[2];
        for (int i = 0; i < 3; i++)
            b[i] =
                l->block.b[i] + (w[6 * i + 3] * x[3] + w[6 * i + 4] * x[4] + w[6 * i + 5] * x[5]);
        if (tribo_contact_solve(contact, b, l->block.mu, l->block.mu, x, NULL) != TRIBO_OK)
            return;
        for (int i = 3; i < 6; i++)
            b[i] = l->block.b[i] + (w[6 * i] * x[0] + w[6 * i + 1] * x[1] + w[6 * i + 2] * x[2]);
        for (int k = 0; k < 2; k++)
            limits[k] = l->block.lengths[k] * x[0];
        solve_torque(torque, b + 3, limits, x + 3);
    }
}

/* ---- the call -------------------------------------------------------------------------------- */

static double block_size(const double *w)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            sum += w[6 * i + k] * w[6 * i + k];
    }
    return sqrt(sum);
}

/* W and b to greatest entries in [1, 2); impulses are multiplied by *up. */
static void scale(const resist_block *block, local *l, double *up_w, double *up_b)
{
    double most_w = 0.0;
    double most_b = 0.0;

    for (int i = 0; i < 6; i++) {
        most_w = greater(most_w, block->w[7 * i]);
        most_b = greater(most_b, absolute(block->b[i]));
    }
    *up_w = power_of_two(scale_exponent(most_w));
    *up_b = power_of_two(scale_exponent(most_b));
    l->block = *block;
    for (int i = 0; i < 36; i++)
        l->block.w[i] *= *up_w;
    for (int i = 0; i < 6; i++)
        l->block.b[i] *= *up_b;
    l->gain[0] = block_size(l->block.w);
    l->gain[1] = block_size(l->block.w + 21);
    /* A torque that can turn nothing still has its law. */
    l->gain[1] = l->gain[1] > 0.0 ? l->gain[1] : l->gain[0];
}

/* The better of the start that was given and the impulse without friction. */
static void choose_start(local *l, const double given[6])
{
    const double bare[6] = {0.0 - l->block.b[0] / l->block.w[0], 0.0, 0.0, 0.0, 0.0, 0.0};
    local_map unused;

    memcpy(l->x, given, sizeof l->x);
    const double f = evaluate(l, given, l->f, &unused);
    if (!(f <= evaluate(l, bare, l->f, &unused)))
        memcpy(l->x, bare, sizeof l->x);
}

/* x = the impulse that stops all motion: where friction presses the contact together, and without
 * it Newton ends at a normal impulse below 0, the solution is on the way from here. Returns 0 if
 * there is none. */
static int start_at_rest(local *l)
{
    double a[6 * STRIDE] = {0.0};
    uint32_t pivots[6];

    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 6; k++)
            a[STRIDE * i + k] = l->block.w[6 * i + k];
        l->x[i] = 0.0 - l->block.b[i];
    }
    if (!dense_baseline.lu(&six, a, pivots))
        return 0;
    dense_baseline.lu_solve(&six, a, pivots, l->x);
    return 1;
}

int resist_solve(const resist_block *block, double r[6])
{
    local l;
    double given[6];
    double best[6];
    double up_w;
    double up_b;
    double size;
    double least = HUGE_VAL;
    int passes = FIRST_PASSES;

    if (block->b[0] >= 0.0) {
        memset(r, 0, 6 * sizeof *r);
        return 1;
    }
    scale(block, &l, &up_w, &up_b);
    for (int i = 0; i < 6; i++)
        given[i] = r[i] / up_w * up_b;
    choose_start(&l, given);
    memcpy(best, l.x, sizeof best);
    for (int round = 0; round < ROUNDS; round++, passes *= 2) {
        const double f = iterate(&l, &size) / size;
        const double before = least;
        if (f < least) {
            least = f;
            memcpy(best, l.x, sizeof best);
        }
        if (least <= SOLVED || (round > 1 && least > WON * before))
            break;
        if (round > 0 || !start_at_rest(&l))
            take_turns(&l, passes);
    }
    double limits[2];
    cone_project(best, block->mu, best);
    for (int k = 0; k < 2; k++)
        limits[k] = block->lengths[k] * best[0];
    resist_project(best + 3, limits, best + 3);
    for (int i = 0; i < 6; i++)
        r[i] = best[i] / up_b * up_w;
    return least <= SOLVED && all_finite(r, 6);
}
