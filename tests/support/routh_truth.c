#include "routh_truth.h"

#include <math.h>
#include <string.h>

/* Time along the path is dp_n / |u_t|: in it slip fades exponentially and everything is smooth. */
enum {
    UN = 0,
    U1 = 1,
    U2 = 2,
    PN = 3,
    P1 = 4,
    P2 = 5,
    WORK = 6, /* of the normal impulse */
    STATE = 7,
    COLUMNS = 8, /* of the extrapolation: order 16 */
    MAX_STEPS = 20000
};

typedef struct path {
    long double w[6];
    long double mu;
    long double y[STATE];
    int restitution;
    long double compression;
    long double work_of_compression;
    long double target; /* NEWTON: u_n+; POISSON and STRONGE: e */
    uint32_t law;
} path;

static void slope_of(const path *at, const long double y[STATE], long double out[STATE])
{
    const long double *w = at->w;
    const long double slip = sqrtl(y[U1] * y[U1] + y[U2] * y[U2]);
    const long double f1 = -at->mu * y[U1];
    const long double f2 = -at->mu * y[U2];
    out[UN] = w[0] * slip + w[1] * f1 + w[2] * f2;
    out[U1] = w[1] * slip + w[3] * f1 + w[4] * f2;
    out[U2] = w[2] * slip + w[4] * f1 + w[5] * f2;
    out[PN] = slip;
    out[P1] = f1;
    out[P2] = f2;
    out[WORK] = y[UN] * slip;
}

/* Modified midpoint rule with n steps (Gragg 1965). */
static void midpoint(const path *at, long double length, int n, long double out[STATE])
{
    const long double h = length / (long double)n;
    long double before[STATE];
    long double slope[STATE];
    memcpy(before, at->y, sizeof before);
    slope_of(at, before, slope);
    for (size_t i = 0; i < STATE; i++) {
        out[i] = before[i] + h * slope[i];
    }
    for (int k = 1; k < n; k++) {
        slope_of(at, out, slope);
        for (size_t i = 0; i < STATE; i++) {
            const long double next = before[i] + 2.0L * h * slope[i];
            before[i] = out[i];
            out[i] = next;
        }
    }
    slope_of(at, out, slope);
    for (size_t i = 0; i < STATE; i++) {
        out[i] = 0.5L * (before[i] + out[i] + h * slope[i]);
    }
}

/* State after `length`, extrapolated to infinitely many midpoint steps (Neville's scheme). */
static void advance(const path *at, long double length, long double out[STATE])
{
    long double above[COLUMNS][STATE];
    long double row[COLUMNS][STATE];
    for (int r = 0; r < COLUMNS; r++) {
        midpoint(at, length, 2 * (r + 1), row[0]);
        for (int c = 1; c <= r; c++) {
            const long double ratio = (long double)(r + 1) / (long double)(r - c + 1);
            for (size_t i = 0; i < STATE; i++) {
                row[c][i] =
                    row[c - 1][i] + (row[c - 1][i] - above[c - 1][i]) / (ratio * ratio - 1.0L);
            }
        }
        memcpy(above, row, sizeof above);
    }
    memcpy(out, row[COLUMNS - 1], STATE * sizeof out[0]);
}

/* Negative until the phase ends: compression with u_n = 0, restitution by the law. */
static long double until_end(const path *at, const long double y[STATE])
{
    if (!at->restitution) {
        return y[UN];
    }
    switch (at->law) {
    case TRIBO_LAW_ROUTH_NEWTON:
        return y[UN] - at->target;
    case TRIBO_LAW_ROUTH_POISSON:
        return y[PN] - (1.0L + at->target) * at->compression;
    default:
        return y[WORK] - at->work_of_compression * (1.0L - at->target * at->target);
    }
}

static void begin_restitution(path *at)
{
    at->restitution = 1;
    at->compression = at->y[PN];
    at->work_of_compression = at->y[WORK];
}

/* Shortens a step that would pass the end of the phase to reach just it (Illinois method); 1 if it
 * does. */
static int meet_end(const path *at, long double length, long double y[STATE])
{
    long double low = 0.0L;
    long double high = length;
    long double at_low = until_end(at, at->y);
    long double at_high = until_end(at, y);
    int side = 0;
    if (at_high < 0.0L) {
        return 0;
    }
    for (int k = 0; k < 100 && high - low > 1e-19L * high; k++) {
        const long double middle = low - at_low * (high - low) / (at_high - at_low);
        if (!(middle > low && middle < high)) {
            break;
        }
        advance(at, middle, y);
        const long double there = until_end(at, y);
        if (there >= 0.0L) {
            high = middle;
            at_high = there;
            at_low *= side == 1 ? 0.5L : 1.0L;
            side = 1;
        } else {
            low = middle;
            at_low = there;
            at_high *= side == -1 ? 0.5L : 1.0L;
            side = -1;
        }
    }
    return 1;
}

/* Slip has stopped: the rest of the way in closed form. Per normal impulse friction is f, and u_n
 * grows by `stiffness`. */
static void finish_sticking(path *at, const long double f[2])
{
    const long double stiffness = at->w[0] + f[0] * at->w[1] + f[1] * at->w[2];
    long double *y = at->y;
    const long double before = y[PN];
    if (!at->restitution) {
        const long double step = -y[UN] / stiffness;
        y[PN] += step;
        y[WORK] += 0.5L * y[UN] * step;
        y[UN] = 0.0L;
        begin_restitution(at);
    }
    long double step = (at->target - y[UN]) / stiffness;
    if (at->law == TRIBO_LAW_ROUTH_POISSON) {
        step = (1.0L + at->target) * at->compression - y[PN];
    } else if (at->law == TRIBO_LAW_ROUTH_STRONGE) {
        const long double rest = -until_end(at, y);
        step = (sqrtl(y[UN] * y[UN] + 2.0L * stiffness * rest) - y[UN]) / stiffness;
    }
    y[PN] += step;
    y[P1] += f[0] * (y[PN] - before);
    y[P2] += f[1] * (y[PN] - before);
}

/* 1: the law ended it; 0: slip stopped; -1: the path is not simple. The first steps are as short as
 * u_n is small beside the slip. */
static int slip_until_end(path *at, long double rate, long double slip)
{
    const long double longest = 0.5L / rate;
    const long double stopped = 1e-18L * slip;
    long double step = fminl(longest, -at->y[UN] / (rate * slip));
    for (int k = 0; k < MAX_STEPS; k++, step = fminl(longest, 2.0L * step)) {
        long double y[STATE];
        advance(at, step, y);
        const int ends = meet_end(at, step, y);
        memcpy(at->y, y, sizeof y);
        if (ends && (at->restitution || !(at->target > 0.0L))) {
            return 1;
        }
        if (ends) {
            begin_restitution(at);
        } else if (at->restitution && y[UN] < 0.0L) {
            return -1;
        }
        if (y[U1] * y[U1] + y[U2] * y[U2] < stopped * stopped) {
            return 0;
        }
    }
    return -1;
}

int routh_truth(const double w[6], const double u[3], const tribo_material *pair, uint32_t law,
                double p[3])
{
    path at = {.mu = (long double)pair->mu_d, .law = law};
    for (size_t i = 0; i < 6; i++) {
        at.w[i] = (long double)w[i];
    }
    for (size_t i = 0; i < 3; i++) {
        at.y[i] = (long double)u[i];
    }
    at.target = (long double)pair->e * (law == TRIBO_LAW_ROUTH_NEWTON ? -at.y[UN] : 1.0L);
    const long double determinant = at.w[3] * at.w[5] - at.w[4] * at.w[4];
    const long double f[2] = {(at.w[2] * at.w[4] - at.w[1] * at.w[5]) / determinant,
                              (at.w[1] * at.w[4] - at.w[2] * at.w[3]) / determinant};
    const long double rate = at.w[0] + (1.0L + at.mu) * (at.w[3] + at.w[5]);
    const long double slip = sqrtl(at.y[U1] * at.y[U1] + at.y[U2] * at.y[U2]);
    const int outcome = slip_until_end(&at, rate, slip);
    if (outcome < 0) {
        return 0;
    }
    if (outcome == 0) {
        const long double limit = (long double)pair->mu_s;
        if (f[0] * f[0] + f[1] * f[1] > limit * limit) {
            return 0;
        }
        finish_sticking(&at, f);
    }
    for (size_t i = 0; i < 3; i++) {
        p[i] = (double)at.y[PN + i];
    }
    return 1;
}
