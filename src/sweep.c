#include "sweep.h"

#include "resist.h"
#include "solve.h"
#include "sweep_block.h"

#include <float.h>

enum {
    COLOURS = 512, /* one bit each in the line of a body */
    WORDS = COLOURS / 64,
    LEAST = 4,       /* contacts of a colour that are worth a block of their own */
    SLOTS = 64,      /* tasks at most */
    TASK_BLOCKS = 16 /* blocks at least that are worth a task */
};

/* Contacts of one colour: blocks of either kind, whose contacts do not share a body that moves. */
typedef struct colour {
    uint32_t first_three, threes, first_one, ones;
} colour;

/* The inverse inertia of a body is unit L L^T; rows of L. */
typedef struct factor {
    double l[6], unit, unused;
} factor;

/* A contact of the assembled form. W_cc is scaled as in sweep_three; inverse_a = 0: not for the
 * fast path. */
typedef struct assembled {
    double nn, row[2], column[2], s[4];
    double scale, inverse_a, trace, det, mu_s, mu_d;
} assembled;

/* A contact and its torque; ends as in sweep_ends. Rows of both, of 6 numbers each: u = q + of_a
 * x_a - of_b x_b, in the terms of sweep_block.h. */
typedef struct sweep_six {
    uint32_t contact, ends[2];
    double of_ends[2][36];
    double q[6], r[6];
    resist_block block;
} sweep_six;

struct sweep {
    system_problem problem;
    const sweep_table *table; /* null: one contact after the other */
    /* Bodies form */
    sweep_body *bodies;
    factor *factors; /* of the inverse inertia of each body */
    colour *colours;
    uint32_t *colour_of; /* of each contact; COLOURS: none */
    sweep_three *threes;
    sweep_one *ones;
    sweep_six *sixes;
    uint32_t six_count;
    uint32_t colour_count;
    uint32_t three_count, one_count; /* blocks */
    uint32_t last_three, last_one;   /* where the blocks begin whose lanes may share bodies */
    /* Assembled form */
    assembled *contacts;
};

/* ---- memory ---------------------------------------------------------------------------------- */

enum { LINE = 64 };

static size_t round_up(size_t bytes)
{
    return (bytes + LINE - 1) / LINE * LINE;
}

/* Blocks for `count` contacts: at most two lanes for each contact, and at most seven empty ones for
 * each colour and kind; the last blocks of both kinds besides. */
static size_t block_limit(uint32_t count)
{
    const size_t twice = 2 * (size_t)count;
    const size_t padded = (size_t)count + 2 * 7 * (size_t)COLOURS;
    return (twice < padded ? twice : padded) / LANES + 4;
}

size_t sweep_size(uint32_t count, uint32_t bodies, uint32_t torques)
{
    const size_t head = LINE + round_up(sizeof(sweep));
    if (bodies == 0) {
        return head + round_up(count * sizeof(assembled));
    }
    return head + round_up(((size_t)bodies + 1) * sizeof(sweep_body)) +
           round_up(bodies * sizeof(factor)) + round_up(COLOURS * sizeof(colour)) +
           round_up(count * sizeof(uint32_t)) + block_limit(count) * sizeof(sweep_three) +
           round_up(torques * sizeof(sweep_six));
}

static void *take(unsigned char **at, size_t bytes)
{
    void *taken = *at;
    *at += round_up(bytes);
    return taken;
}

static unsigned char *align_line(void *memory)
{
    return (unsigned char *)memory + (LINE - (uintptr_t)memory % LINE) % LINE;
}

/* ---- colours --------------------------------------------------------------------------------- */

static int is_one(const system_problem *problem, uint32_t c)
{
    return problem->mu[2 * (size_t)c] == 0.0;
}

/* Torques are solved with their contacts, and these apart from all others. */
static int is_apart(const system_problem *problem, uint32_t c)
{
    return resist_is_torque(problem, c) || resist_acts(problem, c);
}

/* The least colour that neither mask has, or COLOURS. */
static uint32_t free_colour(const uint64_t *a, const uint64_t *b)
{
    for (uint32_t word = 0; word < WORDS; word++) {
        uint64_t left = ~(a[word] | b[word]);
        if (left != 0) {
            uint32_t found = 64 * word;
            for (; (left & 1u) == 0; left >>= 1) {
                found++;
            }
            return found;
        }
    }
    return COLOURS;
}

/* The line of each body holds the colours of its contacts meanwhile. What can not move shares no
 * colour with anybody. */
static void find_colours(sweep *s)
{
    static const uint64_t none[WORDS] = {0};
    const system_problem *problem = &s->problem;
    uint64_t *masks = (uint64_t *)(void *)s->bodies;
    memset(masks, 0, problem->bodies * sizeof(sweep_body));
    for (uint32_t c = 0; c < problem->count; c++) {
        const uint32_t *pair = problem->pairs + 2 * (size_t)c;
        uint64_t *mask[2] = {NULL, NULL};
        if (is_apart(problem, c)) {
            continue;
        }
        for (int i = 0; i < 2; i++) {
            mask[i] = pair[i] == TRIBO_WORLD ? NULL : masks + WORDS * (size_t)pair[i];
        }
        const uint32_t own = free_colour(mask[0] ? mask[0] : none, mask[1] ? mask[1] : none);
        s->colour_of[c] = own;
        for (int i = 0; i < 2 && own < COLOURS; i++) {
            if (mask[i]) {
                mask[i][own / 64] |= (uint64_t)1 << own % 64;
            }
        }
    }
}

/* Blocks of `contacts` of one colour and kind, from *next on; a few contacts get none. */
static uint32_t place_blocks(uint32_t contacts, uint32_t *next)
{
    const uint32_t blocks = contacts < LEAST ? 0 : (contacts + LANES - 1) / LANES;
    *next += blocks;
    return blocks;
}

/* Count the contacts of each colour, then make blocks of them; the rest comes last. */
static void place_colours(sweep *s)
{
    const system_problem *problem = &s->problem;
    uint32_t rest[2] = {0, 0};
    memset(s->colours, 0, COLOURS * sizeof *s->colours);
    s->colour_count = 0;
    for (uint32_t c = 0; c < problem->count; c++) {
        const uint32_t own = s->colour_of[c];
        const int one = is_one(problem, c);
        if (is_apart(problem, c)) {
            continue;
        }
        if (own == COLOURS) {
            rest[one]++;
        } else {
            s->colours[own].threes += one ? 0 : 1;
            s->colours[own].ones += one ? 1 : 0;
            s->colour_count = own < s->colour_count ? s->colour_count : own + 1;
        }
    }
    s->last_three = s->last_one = 0;
    for (uint32_t k = 0; k < s->colour_count; k++) {
        colour *own = &s->colours[k];
        rest[0] += own->threes < LEAST ? own->threes : 0;
        rest[1] += own->ones < LEAST ? own->ones : 0;
        own->first_three = s->last_three;
        own->first_one = s->last_one;
        own->threes = place_blocks(own->threes, &s->last_three);
        own->ones = place_blocks(own->ones, &s->last_one);
    }
    s->three_count = s->last_three + (rest[0] + LANES - 1) / LANES;
    s->one_count = s->last_one + (rest[1] + LANES - 1) / LANES;
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* Lower triangular L with L L^T = m, by rows; columns of a semidefinite m that have nothing of
 * their own are 0. */
static void factor_inertia(const double m[6], double l[6])
{
    const double l00 = sqrt(m[0] > 0.0 ? m[0] : 0.0);
    const double i00 = l00 > 0.0 ? 1.0 / l00 : 0.0;
    const double l10 = m[1] * i00;
    const double l20 = m[2] * i00;
    const double d1 = m[3] - l10 * l10;
    const double l11 = sqrt(d1 > 0.0 ? d1 : 0.0);
    const double l21 = l11 > 0.0 ? (m[4] - l20 * l10) / l11 : 0.0;
    const double d2 = m[5] - l20 * l20 - l21 * l21;
    l[0] = l00;
    l[1] = l10;
    l[2] = l11;
    l[3] = l20;
    l[4] = l21;
    l[5] = sqrt(d2 > 0.0 ? d2 : 0.0);
}

/* The power of two near the greatest entry of an inverse inertia. */
static double unit_of(const double m[6])
{
    return 1.0 / power_of_two(scale_exponent(greater(greater(m[0], m[3]), m[5])));
}

static void factor_body(const system_problem *problem, uint32_t body, factor *out)
{
    const double *m = problem->inverse_inertia + 6 * (size_t)body;
    const double unit = unit_of(m);
    const double inverse = 1.0 / unit;
    const double scaled[6] = {inverse * m[0], inverse * m[1], inverse * m[2],
                              inverse * m[3], inverse * m[4], inverse * m[5]};
    factor_inertia(scaled, out->l);
    out->unit = unit;
    out->unused = 0.0;
}

/* T L of the body at one end, row by row; 0 for the world. */
static void turn_end(const factor *factors, uint32_t body, const double *turn, double out[9])
{
    if (body == TRIBO_WORLD) {
        memset(out, 0, 9 * sizeof *out);
        return;
    }
    const double *l = factors[body].l;
    for (int k = 0; k < 3; k++) {
        const double *t = turn + 3 * k;
        out[3 * k] = t[0] * l[0] + t[1] * l[1] + t[2] * l[3];
        out[3 * k + 1] = t[1] * l[2] + t[2] * l[4];
        out[3 * k + 2] = t[2] * l[5];
    }
}

/* Everybody in the lanes is the body that is never written. */
static void clear_ends(sweep_ends *ends, uint32_t none)
{
    for (int i = 0; i < LANES; i++) {
        ends->a[i] = ends->b[i] = none;
    }
}

static void clear_threes(sweep *s)
{
    memset(s->threes, 0, s->three_count * sizeof *s->threes);
    for (uint32_t k = 0; k < s->three_count; k++) {
        sweep_three *g = s->threes + k;
        clear_ends(&g->ends, s->problem.bodies);
        for (int i = 0; i < LANES; i++) {
            g->q[0][i] = g->nn[i] = g->t11[i] = g->t22[i] = 1.0;
            g->scale[i] = g->inverse_a[i] = g->mu_s[i] = g->inverse_mu[i] = 1.0;
        }
    }
}

static void clear_ones(sweep *s)
{
    memset(s->ones, 0, s->one_count * sizeof *s->ones);
    for (uint32_t k = 0; k < s->one_count; k++) {
        sweep_one *g = s->ones + k;
        clear_ends(&g->ends, s->problem.bodies);
        for (int i = 0; i < LANES; i++) {
            g->q[i] = g->w[i] = g->inverse_w[i] = 1.0;
        }
    }
}

static void fill_ends(const system_problem *problem, uint32_t c, uint32_t i, sweep_ends *ends)
{
    const uint32_t *pair = problem->pairs + 2 * (size_t)c;
    ends->a[i] = pair[0] == TRIBO_WORLD ? problem->bodies : pair[0];
    ends->b[i] = pair[1] == TRIBO_WORLD ? problem->bodies : pair[1];
    ends->contact[i] = c;
    ends->live = i + 1;
}

/* W_cc by its six numbers. */
static void pack_diagonal(const double *w, double out[6])
{
    out[0] = w[0];
    out[1] = w[1];
    out[2] = w[2];
    out[3] = w[4];
    out[4] = w[5];
    out[5] = w[8];
}

/* 1 if det S and trace S are such that adj(S) c keeps its digits, and mu and W are usual. */
static int is_sound(double trace, double det, double mu_s, double mu_d, double fault)
{
    return det >= FAST_CONDITION * (trace * trace) && trace > 0.0 && mu_d >= FAST_MIN &&
           mu_s >= mu_d && mu_s <= FAST_MAX && fault == KERNEL_OPEN;
}

static void fill_matrix(const system_problem *problem, uint32_t c, uint32_t i, sweep_three *g)
{
    static const double nothing[3] = {0.0, 0.0, 0.0};
    const double *diagonal = problem->diagonal + 9 * (size_t)c;
    const double mu_d = problem->mu[2 * (size_t)c + 1];
    double w[6];
    kernel_problem k;
    kernel_schur schur;
    pack_diagonal(diagonal, w);
    kernel_scale(w, nothing, &k);
    kernel_reduce(&k, &schur);
    g->nn[i] = k.nn;
    g->n1[i] = k.n1;
    g->n2[i] = k.n2;
    g->t11[i] = k.t11;
    g->t12[i] = k.t12;
    g->t22[i] = k.t22;
    g->mu_s[i] = problem->mu[2 * (size_t)c];
    g->inverse_mu[i] = 1.0 / mu_d;
    g->scale[i] = power_of_two(scale_exponent(greater(greater(w[0], w[3]), w[5])));
    const double trace = schur.s11 + schur.s22;
    const double det = schur.s11 * schur.s22 - schur.s12 * schur.s12;
    const int sound = is_sound(trace, det, g->mu_s[i], mu_d, k.fault);
    g->inverse_a[i] = sound ? schur.inverse_a : 0.0;
}

static void fill_three(const sweep *s, uint32_t c, uint32_t i, sweep_three *g)
{
    const system_problem *problem = &s->problem;
    const uint32_t *pair = problem->pairs + 2 * (size_t)c;
    double turn[2][9];
    turn_end(s->factors, pair[0], problem->turns + 18 * (size_t)c, turn[0]);
    turn_end(s->factors, pair[1], problem->turns + 18 * (size_t)c + 9, turn[1]);
    for (int k = 0; k < 9; k++) {
        g->frame[k][i] = problem->frames[9 * (size_t)c + (size_t)k];
        g->turn_a[k][i] = turn[0][k];
        g->turn_b[k][i] = turn[1][k];
    }
    for (int k = 0; k < 3; k++) {
        g->q[k][i] = problem->q[3 * (size_t)c + (size_t)k];
    }
    fill_ends(problem, c, i, &g->ends);
    fill_matrix(problem, c, i, g);
}

static void fill_one(const sweep *s, uint32_t c, uint32_t i, sweep_one *g)
{
    const system_problem *problem = &s->problem;
    const uint32_t *pair = problem->pairs + 2 * (size_t)c;
    double turn[2][9];
    turn_end(s->factors, pair[0], problem->turns + 18 * (size_t)c, turn[0]);
    turn_end(s->factors, pair[1], problem->turns + 18 * (size_t)c + 9, turn[1]);
    for (int k = 0; k < 3; k++) {
        g->normal[k][i] = problem->frames[9 * (size_t)c + (size_t)k];
        g->turn_a[k][i] = turn[0][k];
        g->turn_b[k][i] = turn[1][k];
    }
    g->q[i] = problem->q[3 * (size_t)c];
    g->w[i] = problem->diagonal[9 * (size_t)c];
    g->inverse_w[i] = 1.0 / g->w[i];
    fill_ends(problem, c, i, &g->ends);
}

static void mark_still(sweep_ends *ends, uint32_t none)
{
    for (int i = 0; i < LANES; i++) {
        ends->still |= ends->a[i] == none || ends->b[i] == none;
    }
}

/* Contacts into the lanes of the blocks of their colour, in the order of contacts. */
static void fill_blocks(sweep *s)
{
    const system_problem *problem = &s->problem;
    uint32_t used[2][COLOURS] = {{0}};
    uint32_t rest[2] = {s->last_three * LANES, s->last_one * LANES};
    clear_threes(s);
    clear_ones(s);
    for (uint32_t c = 0; c < problem->count; c++) {
        if (is_apart(problem, c)) {
            continue;
        }
        const uint32_t own = s->colour_of[c];
        const int one = is_one(problem, c);
        const colour *k = own < COLOURS ? s->colours + own : NULL;
        const uint32_t blocks = !k ? 0 : one ? k->ones : k->threes;
        uint32_t lane;
        if (blocks > 0) {
            lane = (one ? k->first_one : k->first_three) * LANES + used[one][own]++;
        } else {
            lane = rest[one]++;
        }
        if (one) {
            fill_one(s, c, lane % LANES, s->ones + lane / LANES);
        } else {
            fill_three(s, c, lane % LANES, s->threes + lane / LANES);
        }
    }
    for (uint32_t k = 0; k < s->three_count; k++) {
        mark_still(&s->threes[k].ends, problem->bodies);
    }
    for (uint32_t k = 0; k < s->one_count; k++) {
        mark_still(&s->ones[k].ends, problem->bodies);
    }
}

/* Rows of contact c at one end. */
static void fill_rows(const sweep *s, size_t c, size_t end, double rows[18])
{
    const system_problem *problem = &s->problem;
    double turn[9];
    turn_end(s->factors, problem->pairs[2 * c + end], problem->turns + 18 * c + 9 * end, turn);
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < 3; i++) {
            rows[6 * k + i] = problem->frames[9 * c + 3 * k + i];
            rows[6 * k + 3 + i] = turn[3 * k + i];
        }
    }
}

static void fill_sixes(sweep *s)
{
    const system_problem *problem = &s->problem;
    uint32_t filled = 0;
    for (uint32_t c = 0; c < problem->count; c++) {
        if (!resist_acts(problem, c)) {
            continue;
        }
        sweep_six *g = s->sixes + filled++;
        g->contact = c;
        for (size_t end = 0; end < 2; end++) {
            const uint32_t body = problem->pairs[2 * (size_t)c + end];
            g->ends[end] = body == TRIBO_WORLD ? problem->bodies : body;
            fill_rows(s, c, end, g->of_ends[end]);
            fill_rows(s, (size_t)c + 1, end, g->of_ends[end] + 18);
        }
        memcpy(g->q, problem->q + 3 * (size_t)c, sizeof g->q);
        resist_fill(problem, c, 0.0, &g->block);
    }
}

static void clear_bodies(sweep *s)
{
    for (uint32_t k = 0; k <= s->problem.bodies; k++) {
        const sweep_body still = {{0.0}, 0.0, {0.0}, 0.0};
        s->bodies[k] = still;
        if (k < s->problem.bodies) {
            s->bodies[k].inverse_mass = s->problem.inverse_mass[k];
            s->bodies[k].unit = s->factors[k].unit;
        }
    }
}

/* ---- one contact after the other ------------------------------------------------------------- */

int sweep_solve_odd(const system_problem *problem, const sweep_three *block, size_t i,
                    const double u[3], double p[3])
{
    const size_t c = block->ends.contact[i];
    const double *mu = problem->mu + 2 * c;
    const double r[3] = {block->r[0][i], block->r[1][i], block->r[2][i]};
    double own[3];
    double w[6];
    pack_diagonal(problem->diagonal + 9 * c, w);
    tribo_sym3_apply(w, r, own);
    const double b[3] = {u[0] - own[0], u[1] - own[1], u[2] - own[2]};
    if (tribo_contact_solve(w, b, mu[0], mu[1], p, NULL) == TRIBO_OK) {
        return 1;
    }
    tribo_cone_clamp(r, mu[0], p);
    return 0;
}

static void load_body(const sweep_body *x, double out[6])
{
    for (int k = 0; k < 3; k++) {
        out[k] = x->v[k];
        out[3 + k] = x->w[k];
    }
}

static void store_body(const double in[6], sweep_body *x)
{
    for (int k = 0; k < 3; k++) {
        x->v[k] = in[k];
        x->w[k] = in[3 + k];
    }
}

static void give_three(const sweep_three *g, size_t i, const double d[3], sweep_body *x,
                       uint32_t none)
{
    sweep_body *a = x + g->ends.a[i];
    sweep_body *b = x + g->ends.b[i];
    double of_a[6];
    double of_b[6];
    load_body(a, of_a);
    load_body(b, of_b);
    sweep_push(g, i, d, a->inverse_mass, b->inverse_mass, a->unit, b->unit, of_a, of_b);
    if (g->ends.a[i] != none) {
        store_body(of_a, a);
    }
    if (g->ends.b[i] != none) {
        store_body(of_b, b);
    }
}

/* The impulse by the branch-free path, and the root of the slip equation; 0 if that is not for
 * it. */
static int solve_usual(const sweep_three *g, size_t i, const sweep_pose *e, double *nu, double p[3])
{
    int settled = e->mode < KERNEL_SLIP;
    *nu = g->nu[i];
    if (e->mode == KERNEL_SLIP) {
        kernel_slip slip;
        sweep_slip_one(g, i, e, &slip);
        if (!(*nu > 0.0)) {
            kernel_guess(&slip);
            *nu = slip.nu;
        }
        for (int step = 0; step < MAX_HALLEY && !settled; step++) {
            settled = kernel_halley(&slip, nu);
        }
    }
    return settled && sweep_finish_one(g, i, e, *nu, p) == 0.0;
}

static double three_alone(const system_problem *problem, sweep_three *g, size_t i, sweep_body *x,
                          int measure)
{
    double of_a[6];
    double of_b[6];
    double u[3];
    double p[3];
    double d[3];
    double nu;
    sweep_pose e;
    int solved = 1;
    load_body(x + g->ends.a[i], of_a);
    load_body(x + g->ends.b[i], of_b);
    sweep_velocity(g, i, of_a, of_b, u);
    sweep_pose_one(g, i, u, &e);
    const int usual = solve_usual(g, i, &e, &nu, p);
    g->nu[i] = usual && e.mode == KERNEL_SLIP ? nu : 0.0;
    if (!usual) {
        solved = sweep_solve_odd(problem, g, i, u, p);
    }
    for (int k = 0; k < 3; k++) {
        d[k] = p[k] - g->r[k][i];
        g->r[k][i] = p[k];
    }
    give_three(g, i, d, x, problem->bodies);
    return !measure ? 0.0 : solved ? sweep_change(g, i, d) : 1.0;
}

static void give_one(const sweep_one *g, size_t i, double d, sweep_body *x, uint32_t none)
{
    sweep_body *a = x + g->ends.a[i];
    sweep_body *b = x + g->ends.b[i];
    double of_a[6];
    double of_b[6];
    load_body(a, of_a);
    load_body(b, of_b);
    sweep_one_push(g, i, d, a->inverse_mass, b->inverse_mass, a->unit, b->unit, of_a, of_b);
    if (g->ends.a[i] != none) {
        store_body(of_a, a);
    }
    if (g->ends.b[i] != none) {
        store_body(of_b, b);
    }
}

static double one_alone(sweep_one *g, size_t i, sweep_body *x, uint32_t none, int measure)
{
    double of_a[6];
    double of_b[6];
    load_body(x + g->ends.a[i], of_a);
    load_body(x + g->ends.b[i], of_b);
    const double p = sweep_one_impulse(g, i, of_a, of_b);
    const double d = p - g->r[i];
    g->r[i] = p;
    give_one(g, i, d, x, none);
    return measure ? sweep_one_change(g, i, d) : 0.0;
}

static double threes_alone(const system_problem *problem, sweep_three *blocks, uint32_t count,
                           sweep_body *x, int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k++) {
        for (size_t i = 0; i < blocks[k].ends.live; i++) {
            greatest = greater(three_alone(problem, blocks + k, i, x, measure), greatest);
        }
    }
    return greatest;
}

static double ones_alone(sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none,
                         int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < count; k++) {
        for (size_t i = 0; i < blocks[k].ends.live; i++) {
            greatest = greater(one_alone(blocks + k, i, x, none, measure), greatest);
        }
    }
    return greatest;
}

static void start_threes_alone(const sweep_three *blocks, uint32_t count, sweep_body *x,
                               uint32_t none)
{
    for (uint32_t k = 0; k < count; k++) {
        const sweep_three *g = blocks + k;
        for (size_t i = 0; i < g->ends.live; i++) {
            const double r[3] = {g->r[0][i], g->r[1][i], g->r[2][i]};
            give_three(g, i, r, x, none);
        }
    }
}

static void start_ones_alone(const sweep_one *blocks, uint32_t count, sweep_body *x, uint32_t none)
{
    for (uint32_t k = 0; k < count; k++) {
        for (size_t i = 0; i < blocks[k].ends.live; i++) {
            give_one(blocks + k, i, blocks[k].r[i], x, none);
        }
    }
}

/* Give the change d of impulse and torque to both bodies. */
static void give_six(const sweep_six *g, const double d[6], sweep_body *x, uint32_t none)
{
    for (size_t end = 0; end < 2; end++) {
        sweep_body *body = x + g->ends[end];
        const double sign = end == 0 ? 1.0 : -1.0;
        double sum[6] = {0.0};
        if (g->ends[end] == none) {
            continue;
        }
        for (size_t k = 0; k < 6; k++) {
            for (size_t i = 0; i < 6; i++) {
                sum[i] += g->of_ends[end][6 * k + i] * d[k];
            }
        }
        for (int i = 0; i < 3; i++) {
            body->v[i] += sign * body->inverse_mass * sum[i];
            body->w[i] += sign * body->unit * sum[3 + i];
        }
    }
}

/* As sweep_change. */
static double change_six(const sweep_six *g, const double d[6])
{
    double change = 0.0;
    double size = 0.0;
    double free = 0.0;
    for (int k = 0; k < 6; k++) {
        const double *w = g->block.w + 6 * k;
        double x = 0.0;
        double y = 0.0;
        for (int i = 0; i < 6; i++) {
            x += w[i] * d[i];
            y += absolute(w[i] * g->r[i]);
        }
        change = greater(absolute(x), change);
        size = greater(y, size);
        free = greater(absolute(g->q[k]), free);
    }
    const double scale = free + size;
    return change / (scale > 0.0 ? scale : change > 0.0 ? change : 1.0);
}

static double six_alone(sweep_six *g, sweep_body *x, uint32_t none, int measure)
{
    double ends[2][6];
    double p[6];
    double d[6];
    load_body(x + g->ends[0], ends[0]);
    load_body(x + g->ends[1], ends[1]);
    for (int k = 0; k < 6; k++) {
        double u = 0.0;
        double own = 0.0;
        for (int i = 0; i < 6; i++) {
            u += g->of_ends[0][6 * k + i] * ends[0][i] - g->of_ends[1][6 * k + i] * ends[1][i];
            own += g->block.w[6 * k + i] * g->r[i];
        }
        g->block.b[k] = g->q[k] + u - own;
    }
    memcpy(p, g->r, sizeof p);
    const int solved = resist_solve(&g->block, p);
    for (int k = 0; k < 6; k++) {
        d[k] = p[k] - g->r[k];
        g->r[k] = p[k];
    }
    give_six(g, d, x, none);
    return !measure ? 0.0 : solved ? change_six(g, d) : 1.0;
}

static double sweep_sixes(sweep *s, int measure)
{
    double greatest = 0.0;
    for (uint32_t k = 0; k < s->six_count; k++) {
        greatest =
            greater(six_alone(s->sixes + k, s->bodies, s->problem.bodies, measure), greatest);
    }
    return greatest;
}

static const sweep_table alone = {threes_alone, ones_alone, start_threes_alone, start_ones_alone};

static const sweep_table *table_of(uint32_t isa)
{
    if (isa == TRIBO_ISA_SCALAR) {
        return &alone;
    }
#if defined(TRIBO_HAVE_X86_64_LEVELS)
    const int best = isa == TRIBO_ISA_BEST;
    if (isa == TRIBO_ISA_X86_64_V4 || (best && tribo_isa_available(TRIBO_ISA_X86_64_V4))) {
        return &sweep_x86_64_v4;
    }
    if (isa == TRIBO_ISA_X86_64_V3 || (best && tribo_isa_available(TRIBO_ISA_X86_64_V3))) {
        return &sweep_x86_64_v3;
    }
#endif
    return &sweep_baseline;
}

/* ---- sweeps over bodies ---------------------------------------------------------------------- */

/* A share of one colour. */
typedef struct share {
    sweep *s;
    const colour *of;
    uint32_t count; /* shares */
    int measure;
    double change[SLOTS];
} share;

/* Part i of n parts of `count`. */
static uint32_t part(uint32_t count, uint32_t i, uint32_t n)
{
    return (uint32_t)((uint64_t)count * i / n);
}

static void run_share(void *data, uint32_t i)
{
    share *own = data;
    sweep *s = own->s;
    const colour *k = own->of;
    const uint32_t three = part(k->threes, i, own->count);
    const uint32_t threes = part(k->threes, i + 1, own->count) - three;
    const uint32_t one = part(k->ones, i, own->count);
    const uint32_t ones = part(k->ones, i + 1, own->count) - one;
    const double x = s->table->three(&s->problem, s->threes + k->first_three + three, threes,
                                     s->bodies, own->measure);
    const double y = s->table->one(s->ones + k->first_one + one, ones, s->bodies, s->problem.bodies,
                                   own->measure);
    own->change[i] = greater(x, y);
}

static double sweep_colour(sweep *s, const colour *k, int measure, tribo_parallel_function parallel,
                           void *user, uint32_t tasks)
{
    const uint32_t worth = (k->threes + k->ones) / TASK_BLOCKS;
    share own = {.s = s, .of = k, .measure = measure};
    double greatest = 0.0;
    own.count = worth < tasks ? worth : tasks;
    if (own.count < 2 || !parallel) {
        own.count = 1;
        run_share(&own, 0);
    } else {
        parallel(user, run_share, &own, own.count);
    }
    for (uint32_t i = 0; i < own.count; i++) {
        greatest = greater(own.change[i], greatest);
    }
    return greatest;
}

/* The blocks that remain, contact after contact. */
static double sweep_rest(sweep *s, int measure)
{
    const double x = alone.three(&s->problem, s->threes + s->last_three,
                                 s->three_count - s->last_three, s->bodies, measure);
    const double y = alone.one(s->ones + s->last_one, s->one_count - s->last_one, s->bodies,
                               s->problem.bodies, measure);
    return greater(greater(x, y), sweep_sixes(s, measure));
}

/* Impulses into the blocks, and the bodies to what they give. */
static void load_impulses(sweep *s, const double *r)
{
    const uint32_t none = s->problem.bodies;
    for (uint32_t k = 0; k < s->three_count; k++) {
        sweep_three *g = s->threes + k;
        for (size_t i = 0; i < g->ends.live; i++) {
            const double *from = r + 3 * (size_t)g->ends.contact[i];
            for (int j = 0; j < 3; j++) {
                g->r[j][i] = from[j];
            }
        }
    }
    for (uint32_t k = 0; k < s->one_count; k++) {
        sweep_one *g = s->ones + k;
        for (size_t i = 0; i < g->ends.live; i++) {
            g->r[i] = r[3 * (size_t)g->ends.contact[i]];
        }
    }
    clear_bodies(s);
    s->table->start_three(s->threes, s->last_three, s->bodies, none);
    s->table->start_one(s->ones, s->last_one, s->bodies, none);
    alone.start_three(s->threes + s->last_three, s->three_count - s->last_three, s->bodies, none);
    alone.start_one(s->ones + s->last_one, s->one_count - s->last_one, s->bodies, none);
    for (uint32_t k = 0; k < s->six_count; k++) {
        sweep_six *g = s->sixes + k;
        memcpy(g->r, r + 3 * (size_t)g->contact, sizeof g->r);
        give_six(g, g->r, s->bodies, none);
    }
}

static void store_impulses(const sweep *s, double *r)
{
    for (uint32_t k = 0; k < s->three_count; k++) {
        const sweep_three *g = s->threes + k;
        for (size_t i = 0; i < g->ends.live; i++) {
            double *to = r + 3 * (size_t)g->ends.contact[i];
            for (int j = 0; j < 3; j++) {
                to[j] = g->r[j][i];
            }
        }
    }
    for (uint32_t k = 0; k < s->one_count; k++) {
        const sweep_one *g = s->ones + k;
        for (size_t i = 0; i < g->ends.live; i++) {
            double *to = r + 3 * (size_t)g->ends.contact[i];
            to[0] = g->r[i];
            to[1] = to[2] = 0.0;
        }
    }
    for (uint32_t c = 0; c < s->problem.count; c++) {
        if (resist_is_torque(&s->problem, c)) {
            memset(r + 3 * (size_t)c, 0, 3 * sizeof *r);
        }
    }
    for (uint32_t k = 0; k < s->six_count; k++) {
        const sweep_six *g = s->sixes + k;
        memcpy(r + 3 * (size_t)g->contact, g->r, sizeof g->r);
    }
}

/* v += sign (dv, L x) */
static void shift_velocities(const sweep *s, double sign, double *v)
{
    for (uint32_t k = 0; k < s->problem.bodies; k++) {
        const sweep_body *x = s->bodies + k;
        const double *l = s->factors[k].l;
        double *own = v + 6 * (size_t)k;
        for (int i = 0; i < 3; i++) {
            own[i] += sign * x->v[i];
        }
        own[3] += sign * (l[0] * x->w[0]);
        own[4] += sign * (l[1] * x->w[0] + l[2] * x->w[1]);
        own[5] += sign * (l[3] * x->w[0] + l[4] * x->w[1] + l[5] * x->w[2]);
    }
}

static double run_bodies(sweep *s, uint32_t sweeps, double *r, double *v,
                         tribo_parallel_function parallel, void *user, uint32_t tasks)
{
    const uint32_t most = tasks < SLOTS ? tasks : SLOTS;
    double change = 0.0;
    load_impulses(s, r);
    if (v) {
        shift_velocities(s, -1.0, v);
    }
    for (uint32_t n = 0; n < sweeps; n++) {
        const int measure = n + 1 == sweeps;
        double greatest = 0.0;
        for (uint32_t k = 0; k < s->colour_count; k++) {
            greatest =
                greater(sweep_colour(s, s->colours + k, measure, parallel, user, most), greatest);
        }
        change = greater(sweep_rest(s, measure), greatest);
    }
    store_impulses(s, r);
    if (v) {
        shift_velocities(s, 1.0, v);
    }
    return change;
}

/* ---- assembled form -------------------------------------------------------------------------- */

static void fill_assembled(const system_problem *problem, uint32_t c, assembled *out)
{
    static const double nothing[3] = {0.0, 0.0, 0.0};
    const double *w = problem->diagonal + 9 * (size_t)c;
    const double lower[6] = {w[0], w[3], w[6], w[4], w[7], w[8]};
    const double scale = power_of_two(scale_exponent(greater(greater(w[0], w[4]), w[8])));
    const double inverse_a = 1.0 / (scale * w[0]);
    kernel_problem k;
    kernel_scale(lower, nothing, &k);
    out->nn = scale * w[0];
    for (int i = 0; i < 2; i++) {
        out->row[i] = scale * w[1 + i];
        out->column[i] = scale * w[3 + 3 * i];
    }
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            out->s[2 * i + j] = scale * w[4 + 3 * i + j] - out->column[i] * inverse_a * out->row[j];
        }
    }
    out->mu_s = problem->mu[2 * (size_t)c];
    out->mu_d = problem->mu[2 * (size_t)c + 1];
    out->scale = scale;
    out->trace = out->s[0] + out->s[3];
    out->det = out->s[0] * out->s[3] - out->s[1] * out->s[2];
    /* Friction must not gain energy: the symmetric part of S is positive, too. */
    const double off = 0.5 * (out->s[1] + out->s[2]);
    const int sound = is_sound(out->trace, out->det, out->mu_s, out->mu_d, k.fault) &&
                      out->s[0] * out->s[3] > off * off;
    out->inverse_a = sound ? inverse_a : 0.0;
}

/* The slip equation of a W that need not be symmetric: N and q of kernel.h are quadratics all the
 * same, with c by the column of W, w . p_t by its row. */
static void pose_assembled(const assembled *g, const double b[3], kernel_slip *out)
{
    const double l1 = g->column[0] * g->inverse_a;
    const double l2 = g->column[1] * g->inverse_a;
    const double c1 = l1 * b[0] - b[1];
    const double c2 = l2 * b[0] - b[2];
    const double e1 = g->s[3] * c1 - g->s[1] * c2;
    const double e2 = g->s[0] * c2 - g->s[2] * c1;
    const double unit = g->nn * g->nn;
    out->inverse_a = g->inverse_a;
    out->bn = b[0];
    out->n1 = g->row[0];
    out->n2 = g->row[1];
    out->c1 = c1;
    out->c2 = c2;
    out->e1 = e1;
    out->e2 = e2;
    out->trace = g->trace;
    out->det = g->det;
    out->mu_s = g->mu_s;
    out->inverse_mu = 1.0 / g->mu_d;
    out->A = -g->mu_d * b[0];
    out->B = g->mu_d * (-b[0] * g->trace - (g->row[0] * c1 + g->row[1] * c2));
    out->C = -b[0] * g->det - (g->row[0] * e1 + g->row[1] * e2); /* of mu_d = 1 */
    out->alpha = unit * (c1 * c1 + c2 * c2);
    out->beta = unit * (c1 * e1 + c2 * e2);
    out->gamma = unit * (e1 * e1 + e2 * e2);
    out->least = FAST_CONDITION * g->trace;
    const double greatest_c = greater(absolute(c1), absolute(c2));
    const double closing = g->mu_s * out->C >= sqrt(out->gamma) ? KERNEL_STICK : KERNEL_SLIP;
    const int usual = -b[0] >= FAST_MIN && (greatest_c >= FAST_MIN_DRIVE || !(greatest_c > 0.0));
    out->C *= g->mu_d;
    out->mode = usual ? closing : KERNEL_ODD;
}

/* Returns 0 where this is not for the fast path. */
static int solve_assembled_usual(const assembled *g, const double b[3], double p[3])
{
    const double greatest_b = greater(greater(absolute(b[0]), absolute(b[1])), absolute(b[2]));
    const double sb = power_of_two(scale_exponent(g->scale * greatest_b));
    const double scaled[3] = {sb * (g->scale * b[0]), sb * (g->scale * b[1]),
                              sb * (g->scale * b[2])};
    kernel_slip e;
    int settled;
    if (!(g->inverse_a > 0.0) || !(g->scale * greatest_b <= TRIBO_LARGE)) {
        return 0;
    }
    p[0] = p[1] = p[2] = 0.0;
    if (b[0] >= 0.0) {
        return 1;
    }
    pose_assembled(g, scaled, &e);
    settled = e.mode == KERNEL_STICK;
    e.nu = 0.0;
    if (e.mode == KERNEL_SLIP) {
        kernel_guess(&e);
        for (int step = 0; step < MAX_HALLEY && !settled; step++) {
            settled = kernel_halley(&e, &e.nu);
        }
    }
    kernel_finish(&e, e.nu, e.mode == KERNEL_SLIP, p);
    for (int k = 0; k < 3; k++) {
        p[k] = p[k] / sb;
    }
    return settled && all_finite(p, 3);
}

/* Returns 0 where no solve succeeds: p is then r within the cone. */
static int solve_assembled(const system_problem *problem, const assembled *g, uint32_t c,
                           const double b[3], const double r[3], double p[3])
{
    const double *diagonal = problem->diagonal + 9 * (size_t)c;
    tribo_status status;
    if (g->mu_s == 0.0) {
        const double normal = b[0] < 0.0 ? -b[0] / diagonal[0] : 0.0;
        const int sound = all_finite(&normal, 1) && all_finite(b, 1);
        p[0] = sound ? normal : r[0];
        p[1] = p[2] = 0.0;
        return sound;
    }
    if (solve_assembled_usual(g, b, p)) {
        return 1;
    }
    if (problem->symmetric[c]) {
        double w[6];
        pack_diagonal(diagonal, w);
        status = tribo_contact_solve(w, b, g->mu_s, g->mu_d, p, NULL);
    } else {
        status = tribo_contact_solve_general(diagonal, b, g->mu_s, g->mu_d, p, NULL);
    }
    if (status != TRIBO_OK) {
        tribo_cone_clamp(r, g->mu_s, p);
    }
    return status == TRIBO_OK;
}

/* b = q + sum of W_cj r_j over all j but c; the first `rows` rows. */
static void gather_dense(const sweep *s, uint32_t c, int rows, const double *r, double b[3])
{
    const size_t n = 3 * (size_t)s->problem.count;
    const size_t own = 3 * (size_t)c;
    for (int k = 0; k < rows; k++) {
        const double *w = s->problem.blocks + (own + (size_t)k) * n;
        const double before = sweep_dot(own, w, r);
        const double after = sweep_dot(n - own - 3, w + own + 3, r + own + 3);
        b[k] = s->problem.q[own + (size_t)k] + (before + after);
    }
}

static void gather_sparse(const sweep *s, uint32_t c, int rows, const double *r, double b[3])
{
    const system_problem *problem = &s->problem;
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t at = problem->row_starts[c]; at < problem->row_starts[c + 1]; at++) {
        const uint32_t j = problem->columns[at];
        const double *w = problem->blocks + 9 * (size_t)at;
        const double *other = r + 3 * (size_t)j;
        for (int k = 0; k < rows && j != c; k++) {
            sum[k] += w[3 * k] * other[0] + w[3 * k + 1] * other[1] + w[3 * k + 2] * other[2];
        }
    }
    for (int k = 0; k < rows; k++) {
        b[k] = problem->q[3 * (size_t)c + (size_t)k] + sum[k];
    }
}

/* As sweep_change. */
static double change_assembled(const system_problem *problem, uint32_t c, const double d[3],
                               const double r[3])
{
    const double *w = problem->diagonal + 9 * (size_t)c;
    double change = 0.0;
    double size = 0.0;
    double free = 0.0;
    for (int k = 0; k < 3; k++, w += 3) {
        const double x = absolute(w[0] * d[0] + w[1] * d[1] + w[2] * d[2]);
        const double y = absolute(w[0] * r[0]) + absolute(w[1] * r[1]) + absolute(w[2] * r[2]);
        change = greater(x, change);
        size = greater(y, size);
        free = greater(absolute(problem->q[3 * (size_t)c + (size_t)k]), free);
    }
    const double scale = free + size;
    return change / (scale > 0.0 ? scale : change > 0.0 ? change : 1.0);
}

static double sweep_assembled(const sweep *s, double *r)
{
    double greatest = 0.0;
    for (uint32_t c = 0; c < s->problem.count; c++) {
        const assembled *g = s->contacts + c;
        const int rows = g->mu_s == 0.0 ? 1 : 3;
        double *own = r + 3 * (size_t)c;
        double b[3] = {0.0, 0.0, 0.0};
        double p[3];
        double d[3];
        if (s->problem.row_starts) {
            gather_sparse(s, c, rows, r, b);
        } else {
            gather_dense(s, c, rows, r, b);
        }
        const int solved = solve_assembled(&s->problem, g, c, b, own, p);
        for (int k = 0; k < 3; k++) {
            d[k] = p[k] - own[k];
            own[k] = p[k];
        }
        greatest = greater(solved ? change_assembled(&s->problem, c, d, own) : 1.0, greatest);
    }
    return greatest;
}

/* ---- the calls ------------------------------------------------------------------------------- */

sweep *sweep_prepare(const system_problem *problem, uint32_t isa, void *memory)
{
    unsigned char *at = align_line(memory);
    sweep *s = take(&at, sizeof *s);
    memset(s, 0, sizeof *s);
    s->problem = *problem;
    if (problem->bodies == 0) {
        s->contacts = take(&at, problem->count * sizeof *s->contacts);
        for (uint32_t c = 0; c < problem->count; c++) {
            fill_assembled(problem, c, s->contacts + c);
        }
        return s;
    }
    s->table = table_of(isa);
    s->bodies = take(&at, ((size_t)problem->bodies + 1) * sizeof *s->bodies);
    s->factors = take(&at, problem->bodies * sizeof *s->factors);
    for (uint32_t k = 0; k < problem->bodies; k++) {
        factor_body(problem, k, s->factors + k);
    }
    s->colours = take(&at, COLOURS * sizeof *s->colours);
    s->colour_of = take(&at, problem->count * sizeof *s->colour_of);
    find_colours(s);
    place_colours(s);
    s->threes = take(&at, s->three_count * sizeof *s->threes);
    s->ones = take(&at, s->one_count * sizeof *s->ones);
    fill_blocks(s);
    for (uint32_t c = 0; c < problem->count; c++) {
        s->six_count += resist_acts(problem, c) ? 1 : 0;
    }
    s->sixes = take(&at, s->six_count * sizeof *s->sixes);
    fill_sixes(s);
    return s;
}

double sweep_run(sweep *s, uint32_t sweeps, double *r, double *v, tribo_parallel_function parallel,
                 void *user, uint32_t tasks)
{
    double change = 0.0;
    if (s->problem.bodies > 0) {
        return run_bodies(s, sweeps, r, v, parallel, user, tasks);
    }
    for (uint32_t n = 0; n < sweeps; n++) {
        change = sweep_assembled(s, r);
    }
    return change;
}
