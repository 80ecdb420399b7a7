#include <tribo/system.h>

#include "arena.h"
#include "bits.h"
#include "resist.h"
#include "restitution.h"
#include "solver.h"
#include "sym3.h"

#define MOST_COUNT 0x7fffffffu
#define DEFAULT_ITERATIONS 1000000u
#define DEFAULT_TOLERANCE 1e-10
#define DEFAULT_DENSE 192u
/* Greatest residual, of the greatest speed before: whatever the impulses are. */
#define RESIDUAL_SHARE 0.1
#define FIRST_SIZE \
    16 /* most contacts of the components that are solved first, then four times those */
/* Parts of a unit vector below this, 2^-100, are far below rounding, but not their products: those
 * become subnormal, and scaling by powers of two would change bits. */
#define LEAST_PART 7.8886090522101181e-31

/* ---- options and info ------------------------------------------------------------------------ */

static int size_is_known(uint32_t size, size_t whole)
{
    return size >= sizeof(uint32_t) && size % sizeof(uint32_t) == 0 && size <= whole;
}

static tribo_status read_linear(const tribo_linear *linear)
{
    if (linear == NULL)
        return TRIBO_OK;
    if (linear->struct_size != sizeof *linear &&
        linear->struct_size != offsetof(tribo_linear, sign))
        return TRIBO_ERROR_STRUCT_SIZE;
    return linear->factor == NULL || linear->solve == NULL ? TRIBO_ERROR_NULL : TRIBO_OK;
}

/* Fill in what the caller's struct, perhaps an older and smaller one, does not give. */
static tribo_status read_options(const tribo_system_options *given, tribo_system_options *out)
{
    const tribo_system_options none = {0};

    *out = none;
    if (given != NULL) {
        if (!size_is_known(given->struct_size, sizeof *given))
            return TRIBO_ERROR_STRUCT_SIZE;
        memcpy(out, given, given->struct_size);
    }
    if (out->solver > TRIBO_SOLVER_NEWTON || out->measure > TRIBO_MEASURE_INVARIANT ||
        out->warm_start > 1 || out->isa > TRIBO_ISA_X86_64_V4 || out->reserved != 0)
        return TRIBO_ERROR_OPTION;
    if (!(out->tolerance >= 0.0) || !(out->max_seconds >= 0.0) ||
        (out->max_seconds > 0.0 && out->clock == NULL))
        return TRIBO_ERROR_OPTION;
    out->struct_size = sizeof *out;
    out->max_iterations = out->max_iterations != 0 ? out->max_iterations : DEFAULT_ITERATIONS;
    out->tolerance = out->tolerance > 0.0 ? out->tolerance : DEFAULT_TOLERANCE;
    out->dense_limit = out->dense_limit != 0 ? out->dense_limit : DEFAULT_DENSE;
    out->tasks = out->tasks != 0 ? out->tasks : 1;
    return read_linear(out->linear);
}

static tribo_status judge_info(const tribo_system_info *info)
{
    return info != NULL && !size_is_known(info->struct_size, sizeof *info) ? TRIBO_ERROR_STRUCT_SIZE
                                                                           : TRIBO_OK;
}

/* Bytes that will be read: all, where nobody says so. */
static uint32_t told_size(const tribo_system_info *info)
{
    return info != NULL ? info->struct_size : (uint32_t)sizeof *info;
}

static void give_info(tribo_system_info *whole, tribo_system_info *info)
{
    if (info == NULL)
        return;
    whole->struct_size = info->struct_size;
    memcpy(info, whole, info->struct_size);
}

static tribo_status judge_place(const tribo_system_options *o, const void *workspace, size_t size,
                                size_t needed)
{
    if (needed > 0 && workspace == NULL)
        return TRIBO_ERROR_NULL;
    if (size < needed)
        return TRIBO_ERROR_CAPACITY;
    return tribo_isa_available(o->isa) ? TRIBO_OK : TRIBO_ERROR_ISA;
}

/* ---- places ---------------------------------------------------------------------------------- */

/* The problem with contacts and bodies in the order of their components, and all that solves it. */
typedef struct plan {
    uint32_t count, bodies, components; /* contacts and torques; bodies; components */
    uint32_t contacts_given;
    uint32_t torques;
    uint32_t assembled; /* the form: 1 has no bodies */
    uint32_t told;      /* bytes of the info that somebody reads */
    uint32_t is_brief;  /* 1: of the measures eta alone, which the solvers' verdicts tell */
    size_t links;       /* blocks of W, or twice the contacts */

    uint32_t *parent; /* union-find; later: component of a body or contact */
    uint32_t *source; /* contact that an item of `order` is of: twice its number, torques 1 more */
    uint32_t *torque; /* null, or 1 for places that hold a torque */
    double *lengths, *arms; /* of torques: 2 and 1 per place */
    uint32_t *order, *rank; /* contact of a place; place of a contact, later place in component */
    uint32_t *starts;       /* components: first contact */
    uint32_t *body_order, *body_rank, *body_starts;
    uint32_t *pairs, *local_pairs, *row_starts, *local_starts, *columns, *local_columns, *symmetric;
    double *frames, *turns, *inverse_mass, *inverse_inertia, *target, *blocks, *diagonal, *q, *mu;
    double *restitution, *free_velocity, *r, *plastic;
    double *matrices; /* 6 per contact, and the contacts themselves: while judging */
    tribo_contact *contacts;
    solver solver;
    restitution stage;
} plan;

static uint32_t *indices(arena *a, size_t count)
{
    return arena_take(a, count, sizeof(uint32_t));
}

static double *numbers(arena *a, size_t count)
{
    return arena_take(a, count, sizeof(double));
}

static void take_shared(plan *p, arena *a, const tribo_system_options *o)
{
    const size_t n = p->count;
    const size_t nodes = p->assembled != 0 ? n : p->bodies;

    p->parent = indices(a, nodes + 1);
    p->order = indices(a, n);
    p->rank = indices(a, n);
    p->starts = indices(a, nodes + 2);
    p->symmetric = indices(a, n);
    p->diagonal = numbers(a, 9 * n);
    p->q = numbers(a, 3 * n);
    p->mu = numbers(a, 2 * n);
    p->r = numbers(a, 3 * n);
    p->plastic = numbers(a, 3 * n);
    p->restitution = numbers(a, n);
    p->solver.dv = numbers(a, 6 * (size_t)p->bodies);
    p->solver.v = numbers(a, 6 * (size_t)p->bodies);
    p->solver.u = numbers(a, 3 * n);
    p->solver.held = numbers(a, 3 * n);
    p->solver.start_r = numbers(a, 3 * n);
    p->solver.best = numbers(a, 3 * n);
    p->solver.swept = numbers(a, 3 * n);
    p->solver.mu = numbers(a, 2 * n);
    p->solver.sweep_memory = arena_take(a, sweep_size(p->count, p->bodies, p->torques), 1);
    p->solver.run.dense_limit = o->dense_limit;
    if (o->linear != NULL)
        memcpy(&p->solver.run.linear, o->linear, o->linear->struct_size);
    p->solver.run.isa = o->isa;
    if (o->solver != TRIBO_SOLVER_GAUSS_SEIDEL)
        p->solver.newton =
            newton_take(a, p->count, p->bodies, p->torques, p->links, &p->solver.run);
    if (o->solver == TRIBO_SOLVER_AUTO)
        p->solver.anderson = anderson_take(a, p->count);
}

static void take_bodies(plan *p, arena *a)
{
    const size_t n = p->count;
    const size_t bodies = p->bodies;

    p->body_order = indices(a, bodies);
    p->body_rank = indices(a, bodies);
    p->body_starts = indices(a, bodies + 2);
    p->pairs = indices(a, 2 * n);
    p->local_pairs = indices(a, 2 * n);
    p->frames = numbers(a, 9 * n);
    p->turns = numbers(a, 18 * n);
    p->target = numbers(a, 3 * n);
    p->inverse_mass = numbers(a, bodies);
    p->inverse_inertia = numbers(a, 6 * bodies);
    p->free_velocity = numbers(a, 6 * bodies);
    p->matrices = numbers(a, 6 * n);
    p->contacts = arena_take(a, n, sizeof(tribo_contact));
    if (p->torques > 0) {
        p->source = indices(a, n);
        p->torque = indices(a, n);
        p->lengths = numbers(a, 2 * n);
        p->arms = numbers(a, n);
    }
    restitution_take(&p->stage, a, p->count);
}

static void take_blocks(plan *p, arena *a)
{
    p->row_starts = indices(a, (size_t)p->count + 1);
    p->local_starts = indices(a, (size_t)p->count + 1);
    p->columns = indices(a, p->links);
    p->local_columns = indices(a, p->links);
    p->blocks = numbers(a, 9 * p->links);
}

static tribo_status measure(plan *p, arena *a, const tribo_system_options *o, size_t *size)
{
    if (p->assembled == 0)
        take_bodies(p, a);
    else
        take_blocks(p, a);
    take_shared(p, a, o);
    if (a->burst != 0)
        return TRIBO_ERROR_CAPACITY;
    *size = a->used;
    return TRIBO_OK;
}

/* ---- components ------------------------------------------------------------------------------ */

static uint32_t find(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void unite(uint32_t *parent, uint32_t a, uint32_t b)
{
    const uint32_t i = find(parent, a);
    const uint32_t j = find(parent, b);

    /* The least index leads: components are numbered by their first member. */
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

/* Number the `nodes` leaders; parent[i] becomes the component of i. */
static uint32_t number_components(uint32_t nodes, uint32_t *parent)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < nodes; i++)
        parent[i] = find(parent, i);
    for (uint32_t i = 0; i < nodes; i++)
        parent[i] = parent[i] == i ? count++ : parent[parent[i]];
    return count;
}

/* Sort `items` stably by component: starts, order (item of a place), rank (place of an item). */
static void sort_items(uint32_t items, uint32_t components, const uint32_t *component,
                       uint32_t *starts, uint32_t *order, uint32_t *rank)
{
    for (uint32_t i = 0; i < components + 2; i++)
        starts[i] = 0;
    for (uint32_t i = 0; i < items; i++) {
        if (component[i] != UINT32_MAX)
            starts[component[i] + 2]++;
    }
    for (uint32_t i = 0; i < components; i++)
        starts[i + 2] += starts[i + 1];
    for (uint32_t i = 0; i < items; i++) {
        rank[i] = UINT32_MAX;
        if (component[i] == UINT32_MAX)
            continue;
        rank[i] = starts[component[i] + 1]++;
        order[rank[i]] = i;
    }
}

/* ---- bodies form: judging and laying out ----------------------------------------------------- */

static int is_movable(const tribo_body *body)
{
    const double *j = body->inverse_inertia;
    return body->inverse_mass > 0.0 || j[0] > 0.0 || j[3] > 0.0 || j[5] > 0.0;
}

static int is_within(size_t body_count, const tribo_system_contact *c)
{
    return (c->a == TRIBO_WORLD || c->a < body_count) && (c->b == TRIBO_WORLD || c->b < body_count);
}

static tribo_status judge_ends(size_t body_count, size_t count,
                               const tribo_system_contact *contacts)
{
    for (size_t i = 0; i < count; i++) {
        if (!is_within(body_count, &contacts[i]))
            return TRIBO_ERROR_INDEX;
    }
    return TRIBO_OK;
}

/* Whether a contact passes a torque. */
static int resists(const tribo_system_contact *c)
{
    return c->dimension == 3 && (c->rolling > 0.0 || c->spinning > 0.0);
}

static tribo_status judge_contact(size_t body_count, const tribo_system_contact *c)
{
    if (!is_within(body_count, c))
        return TRIBO_ERROR_INDEX;
    if (c->a == c->b)
        return c->a == TRIBO_WORLD ? TRIBO_ERROR_IMMOVABLE : TRIBO_ERROR_ALIAS;
    if ((c->dimension != 1 && c->dimension != 3) || c->reserved != 0)
        return TRIBO_ERROR_OPTION;
    if (!all_finite(c->target, 3) || !all_finite(&c->rolling, 1) || !all_finite(&c->spinning, 1))
        return TRIBO_ERROR_NOT_FINITE;
    if (c->rolling < 0.0 || c->spinning < 0.0)
        return TRIBO_ERROR_FRICTION;
    return tribo_material_check(&c->pair);
}

static tribo_status judge_bodies(size_t body_count, const tribo_body *bodies, size_t count,
                                 const tribo_system_contact *contacts)
{
    for (size_t i = 0; i < body_count; i++) {
        const tribo_status status = tribo_body_check(&bodies[i]);
        if (status != TRIBO_OK)
            return status;
    }
    for (size_t i = 0; i < count; i++) {
        const tribo_status status = judge_contact(body_count, &contacts[i]);
        if (status != TRIBO_OK)
            return status;
    }
    return TRIBO_OK;
}

static uint32_t mover(const tribo_body *bodies, uint32_t body)
{
    return body != TRIBO_WORLD && is_movable(&bodies[body]) ? body : TRIBO_WORLD;
}

/* The contact whose impulse or torque has a place. */
static uint32_t contact_of(const plan *p, size_t place)
{
    const uint32_t item = p->order[place];
    return p->source != NULL ? p->source[item] / 2 : item;
}

static int is_torque(const plan *p, size_t place)
{
    return p->torque != NULL && p->torque[place] != 0;
}

/* A torque comes right behind its contact. */
static void sort_contacts(plan *p, const tribo_body *bodies, const tribo_system_contact *contacts)
{
    uint32_t items = 0;

    for (uint32_t c = 0; c < p->contacts_given; c++) {
        const uint32_t a = mover(bodies, contacts[c].a);
        const uint32_t b = mover(bodies, contacts[c].b);
        const uint32_t own = a != TRIBO_WORLD ? a : b;
        const uint32_t end = items + (p->source != NULL && resists(&contacts[c]) ? 2 : 1);
        for (uint32_t k = 0; items < end; items++, k++) {
            /* A contact of nothing that moves stands first and is refused by its matrix. */
            p->symmetric[items] = own != TRIBO_WORLD ? p->parent[own] : 0;
            if (p->source != NULL)
                p->source[items] = 2 * c + k;
        }
    }
    sort_items(p->count, p->components, p->symmetric, p->starts, p->order, p->rank);
    for (size_t i = 0; p->torque != NULL && i < p->count; i++)
        p->torque[i] = p->source[p->order[i]] % 2;
}

/* Components of the bodies that move, and the places of bodies and contacts. */
static void arrange_bodies(plan *p, const tribo_body *bodies, const tribo_system_contact *contacts)
{
    for (uint32_t i = 0; i < p->bodies; i++)
        p->parent[i] = i;
    for (size_t c = 0; c < p->contacts_given; c++) {
        const uint32_t a = mover(bodies, contacts[c].a);
        const uint32_t b = mover(bodies, contacts[c].b);
        if (a != TRIBO_WORLD && b != TRIBO_WORLD)
            unite(p->parent, a, b);
    }
    p->components = number_components(p->bodies, p->parent);
    for (uint32_t i = 0; i < p->bodies; i++) {
        if (!is_movable(&bodies[i]))
            p->parent[i] = UINT32_MAX;
    }
    sort_items(p->bodies, p->components, p->parent, p->body_starts, p->body_order, p->body_rank);
    sort_contacts(p, bodies, contacts);
}

static void turn_of(const double *frame, const double arm[3], double turn[9])
{
    for (int k = 0; k < 3; k++)
        tribo_vec3_cross(arm, frame + 3 * k, turn + 3 * k);
}

static double speed_of(const double *f, const double *t, const tribo_body *body)
{
    return tribo_vec3_dot(f, body->velocity) + tribo_vec3_dot(t, body->angular_velocity);
}

static void lay_contact(plan *p, size_t place, const tribo_body *bodies,
                        const tribo_system_contact *given)
{
    const double *w = p->matrices + 6 * place;
    const double full[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    const uint32_t sides[2] = {given->a, given->b};
    double *turns = p->turns + 18 * place;

    memcpy(p->diagonal + 9 * place, full, sizeof full);
    p->symmetric[place] = 1;
    turn_of(p->frames + 9 * place, given->contact.arm_a, turns);
    turn_of(p->frames + 9 * place, given->contact.arm_b, turns + 9);
    p->mu[2 * place] = given->dimension == 3 ? given->pair.mu_s : 0.0;
    p->mu[2 * place + 1] = given->dimension == 3 ? given->pair.mu_d : 0.0;
    p->restitution[place] = given->pair.e;
    for (size_t k = 0; k < 3; k++) {
        const double *f = p->frames + 9 * place + 3 * k;
        double u = 0.0;
        if (sides[0] != TRIBO_WORLD)
            u += speed_of(f, turns + 3 * k, &bodies[sides[0]]);
        if (sides[1] != TRIBO_WORLD)
            u -= speed_of(f, turns + 9 + 3 * k, &bodies[sides[1]]);
        p->target[3 * place + k] = given->target[k];
        p->q[3 * place + k] = u - given->target[k];
    }
    for (size_t side = 0; side < 2; side++) {
        const uint32_t body = mover(bodies, sides[side]);
        const uint32_t rank = body != TRIBO_WORLD ? p->body_rank[body] : TRIBO_WORLD;
        p->pairs[2 * place + side] = rank;
        p->local_pairs[2 * place + side] =
            body != TRIBO_WORLD ? rank - p->body_starts[p->parent[body]] : TRIBO_WORLD;
    }
}

/* W of a torque, for an arm of 1. */
static void turn_matrix(const uint32_t sides[2], const tribo_body *bodies, const double frame[9],
                        double w[9])
{
    for (int i = 0; i < 9; i++)
        w[i] = 0.0;
    for (int side = 0; side < 2; side++) {
        const uint32_t body = mover(bodies, sides[side]);
        double j[6];
        if (body == TRIBO_WORLD)
            continue;
        tribo_body_world_inverse_inertia(&bodies[body], j);
        for (int k = 0; k < 3; k++) {
            double x[3];
            tribo_sym3_apply(j, frame + 3 * k, x);
            for (int i = 0; i <= k; i++)
                w[3 * i + k] = w[3 * k + i] += tribo_vec3_dot(frame + 3 * i, x);
        }
    }
}

/* The power of two that makes the torque's part of W about as great as the contact's. */
static double arm_of(const double w[9], const double turning[9], const double lengths[2])
{
    const double most = greater(w[0], greater(w[4], w[8]));
    const double most_turning = greater(turning[0], greater(turning[4], turning[8]));
    const uint64_t e = scale_exponent(most);
    const uint64_t f = scale_exponent(most_turning);

    if (!(most_turning > 0.0))
        return 1.0 / power_of_two(scale_exponent(greater(lengths[0], lengths[1])));
    return power_of_two((f + 2046u - e) / 2u);
}

/* The torque of the contact at the place before, whose frame is still here. */
static void lay_torque(plan *p, size_t place, const tribo_body *bodies,
                       const tribo_system_contact *given)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const uint32_t sides[2] = {given->a, given->b};
    double *frame = p->frames + 9 * place;
    double *turns = p->turns + 18 * place;
    double *w = p->diagonal + 9 * place;
    double *lengths = p->lengths + 2 * place;

    lengths[0] = given->spinning;
    lengths[1] = given->rolling;
    turn_matrix(sides, bodies, frame, w);
    const double arm = arm_of(p->diagonal + 9 * (place - 1), w, lengths);
    p->arms[place] = arm;
    for (size_t k = 0; k < 9; k++) {
        turns[k] = turns[9 + k] = arm * frame[k];
        w[k] *= arm * arm;
        frame[k] = 0.0;
    }
    for (size_t k = 0; k < 3; k++) {
        const double *a = sides[0] != TRIBO_WORLD ? bodies[sides[0]].angular_velocity : none;
        const double *b = sides[1] != TRIBO_WORLD ? bodies[sides[1]].angular_velocity : none;
        p->target[3 * place + k] = 0.0;
        p->q[3 * place + k] = tribo_vec3_dot(turns + 3 * k, a) - tribo_vec3_dot(turns + 3 * k, b);
    }
    lengths[0] /= arm;
    lengths[1] /= arm;
    p->symmetric[place] = 1;
    p->mu[2 * place] = p->mu[2 * place + 1] = p->restitution[place] = 0.0;
}

static void drop_small_parts(double frame[9])
{
    for (int k = 0; k < 9; k++)
        frame[k] = absolute(frame[k]) < LEAST_PART ? 0.0 : frame[k];
}

static tribo_status lay_bodies(plan *p, const tribo_body *bodies,
                               const tribo_system_contact *contacts)
{
    for (size_t i = 0; i < p->count; i++) {
        const tribo_system_contact *given = &contacts[contact_of(p, i)];
        p->pairs[2 * i] = given->a;
        p->pairs[2 * i + 1] = given->b;
        p->contacts[i] = given->contact;
    }
    const tribo_status status =
        tribo_batch_matrix(p->solver.run.isa, p->bodies, bodies, p->count, p->pairs, p->contacts,
                           p->frames, p->matrices, NULL);
    if (status != TRIBO_OK)
        return status;
    for (size_t i = 0; i < p->count; i++) {
        if (!(p->matrices[6 * i] > 0.0))
            return TRIBO_ERROR_IMMOVABLE;
        drop_small_parts(p->frames + 9 * i);
        lay_contact(p, i, bodies, &contacts[contact_of(p, i)]);
        if (is_torque(p, i))
            lay_torque(p, i, bodies, &contacts[contact_of(p, i)]);
        if (!all_finite(p->q + 3 * i, 3) || !all_finite(p->diagonal + 9 * i, 9))
            return TRIBO_ERROR_RANGE;
    }
    for (size_t i = 0; i < p->body_starts[p->components]; i++) {
        const tribo_body *body = &bodies[p->body_order[i]];
        p->inverse_mass[i] = body->inverse_mass;
        tribo_body_world_inverse_inertia(body, p->inverse_inertia + 6 * i);
        memcpy(p->free_velocity + 6 * i, body->velocity, sizeof body->velocity);
        memcpy(p->free_velocity + 6 * i + 3, body->angular_velocity, sizeof body->angular_velocity);
    }
    return TRIBO_OK;
}

/* ---- problems for the solvers ---------------------------------------------------------------- */

static system_problem whole_problem(const plan *p)
{
    system_problem out = {0};

    out.count = p->count;
    out.bodies = p->assembled == 0 ? p->body_starts[p->components] : 0;
    out.pairs = p->pairs;
    out.frames = p->frames;
    out.turns = p->turns;
    out.inverse_mass = p->inverse_mass;
    out.inverse_inertia = p->inverse_inertia;
    out.target = p->target;
    out.torque = p->torque;
    out.lengths = p->lengths;
    out.row_starts = p->row_starts;
    out.columns = p->columns;
    out.blocks = p->blocks;
    out.diagonal = p->diagonal;
    out.symmetric = p->symmetric;
    out.q = p->q;
    out.mu = p->mu;
    return out;
}

static system_problem component_problem(const plan *p, uint32_t component)
{
    system_problem out = whole_problem(p);
    const size_t first = p->starts[component];

    out.count = p->starts[component + 1] - p->starts[component];
    out.diagonal += 9 * first;
    out.symmetric += first;
    out.q += 3 * first;
    out.mu += 2 * first;
    if (p->assembled == 0) {
        const size_t body = p->body_starts[component];
        out.bodies = p->body_starts[component + 1] - p->body_starts[component];
        out.pairs = p->local_pairs + 2 * first;
        out.frames += 9 * first;
        out.turns += 18 * first;
        out.target += 3 * first;
        if (p->torque != NULL) {
            out.torque += first;
            out.lengths += 2 * first;
        }
        out.inverse_mass += body;
        out.inverse_inertia += 6 * body;
    } else {
        /* Rows of one component follow each other: only the starts need to begin at 0. */
        out.row_starts = p->local_starts;
        out.columns = p->local_columns + p->row_starts[first];
        out.blocks += 9 * (size_t)p->row_starts[first];
    }
    return out;
}

static goal whole_goal(const plan *p, const tribo_system_options *o)
{
    const system_problem problem = whole_problem(p);
    goal out = {o->measure, o->tolerance, certificate_stiffness(&problem), 0.0, 0.0};
    double squares = 0.0;

    for (size_t i = 0; i < 3 * (size_t)p->count; i++)
        squares += p->q[i] * p->q[i];
    out.limit = o->tolerance * sqrt(squares);
    return out;
}

static double greatest_speed(const system_problem *problem)
{
    double most = 0.0;

    for (size_t i = 0; i < 3 * (size_t)problem->count; i++)
        most = greater(most, absolute(problem->q[i]));
    return most;
}

static int separates(const system_problem *problem)
{
    for (size_t c = 0; c < problem->count; c++) {
        if (problem->q[3 * c] < 0.0 && !resist_is_torque(problem, c))
            return 0;
    }
    return 1;
}

/* Of a component keep what its verdict tells, and what its bodies gain. */
static void note_verdict(plan *p, const system_problem *problem, verdict reached, const double *r)
{
    p->solver.info->eta = greater(p->solver.info->eta, reached.eta);
    if (p->solver.is_current == 0)
        certificate_velocity(problem, r, p->solver.dv, p->solver.u);
}

static verdict judge_open(plan *p, const system_problem *problem, const goal *wanted,
                          const double *r)
{
    p->solver.is_current = 1;
    return certificate_check(problem, wanted, r, p->solver.dv, p->solver.u, p->solver.v);
}

static void solve_contacts(plan *p, uint32_t component, const system_problem *problem,
                           const goal *whole)
{
    const size_t first = p->starts[component];
    const size_t size = 3 * (size_t)problem->count * sizeof *p->r;
    double *r = p->r + 3 * first;
    goal wanted = *whole;
    verdict reached;

    wanted.residual = RESIDUAL_SHARE * greatest_speed(problem);
    wanted.limit *= sqrt((double)problem->count / (double)p->count);
    if (separates(problem)) {
        memset(r, 0, size);
        memset(p->plastic + 3 * first, 0, size);
        if (p->is_brief != 0) {
            reached = judge_open(p, problem, &wanted, r);
            note_verdict(p, problem, reached, r);
        }
        return;
    }
    reached = solver_solve(&p->solver, problem, &wanted, r);
    memcpy(p->plastic + 3 * first, r, size);
    if (p->assembled == 0) {
        const double share =
            restitution_apply(&p->stage, &p->solver, problem, p->restitution + first, &wanted, r);
        p->solver.info->restitution = lesser(p->solver.info->restitution, share);
    }
    if (p->is_brief != 0)
        note_verdict(p, problem, reached, r);
}

static void solve_component(plan *p, uint32_t component, const goal *whole)
{
    const size_t first = p->starts[component];
    double *dv = p->solver.dv;

    if (p->assembled != 0) {
        const uint32_t count = p->starts[component + 1] - p->starts[component];
        for (size_t i = 0; i <= count; i++)
            p->local_starts[i] = p->row_starts[first + i] - p->row_starts[first];
    }
    const system_problem problem = component_problem(p, component);
    if (p->is_brief != 0) {
        p->solver.dv += 6 * (size_t)p->body_starts[component];
        memset(p->solver.dv, 0, 6 * (size_t)problem.bodies * sizeof *dv);
    }
    if (problem.count > 0)
        solve_contacts(p, component, &problem, whole);
    p->solver.dv = dv;
}

/* The components of so many contacts. The smaller ones go first, so that one that takes all the time
 * that there is keeps none of them waiting. */
static void solve_sizes(plan *p, size_t least, size_t most, const goal *whole)
{
    for (uint32_t i = 0; i < p->components && p->solver.status == TRIBO_OK; i++) {
        const size_t size = p->starts[i + 1] - p->starts[i];
        if (size < least || size > most)
            continue;
        p->solver.info->components += size > 0;
        solve_component(p, i, whole);
    }
}

static void solve_all(plan *p, const tribo_system_options *o, const double *start,
                      tribo_system_info *info)
{
    const tribo_system_info none = {0};

    *info = none;
    info->struct_size = sizeof *info;
    info->restitution = 1.0;
    info->solver = o->solver == TRIBO_SOLVER_AUTO ? TRIBO_SOLVER_GAUSS_SEIDEL : o->solver;
    p->solver.options = o;
    p->solver.info = info;
    p->solver.most = o->max_iterations;
    p->solver.run.most_steps = o->max_iterations;
    p->solver.start = solver_now(o);
    for (size_t i = 0; i < p->count; i++) {
        const int turns = is_torque(p, i);
        const double *given = turns ? o->torques : start;
        for (size_t k = 0; k < 3; k++) {
            const double r =
                o->warm_start != 0 && given != NULL ? given[3 * (size_t)contact_of(p, i) + k] : 0.0;
            p->r[3 * i + k] = turns ? r / p->arms[i] : r;
        }
    }
    const goal wanted = whole_goal(p, o);
    for (size_t least = 0, most = FIRST_SIZE; least <= p->count; least = most + 1, most *= 4)
        solve_sizes(p, least, most, &wanted);
    info->stop = p->solver.stop;
}

static int is_told(const plan *p, size_t offset)
{
    return p->told > offset;
}

/* Measures of the plastic solution, then velocities and energy of the whole. */
static int certify(plan *p, tribo_system_info *info)
{
    const system_problem problem = whole_problem(p);
    const size_t size = 3 * (size_t)p->count * sizeof *p->r;

    if (p->is_brief != 0)
        return all_finite(&info->eta, 1);
    certificate_velocity(&problem, p->plastic, p->solver.dv, p->solver.u);
    certificate_write(&problem, p->plastic, p->solver.u, p->solver.v, info);
    if (is_told(p, offsetof(tribo_system_info, invariant)))
        certificate_sum(&problem, p->plastic, p->solver.u, p->solver.v, info);
    if (size > 0 && memcmp(p->r, p->plastic, size) != 0)
        certificate_velocity(&problem, p->r, p->solver.dv, p->solver.u);
    if (is_told(p, offsetof(tribo_system_info, energy)))
        certificate_energy(&problem, p->r, p->solver.u, info);
    return all_finite(&info->energy, 1) && all_finite(&info->invariant, 1) &&
           all_finite(&info->eta, 1);
}

static void give_impulses(const plan *p, const tribo_system_options *o, double *impulses)
{
    const int tell = p->assembled == 0 && o->torques != NULL;

    for (size_t i = 0; tell && i < 3 * (size_t)p->contacts_given; i++)
        o->torques[i] = 0.0;
    for (size_t i = 0; i < p->count; i++) {
        const size_t to = 3 * (size_t)contact_of(p, i);
        if (!is_torque(p, i))
            memcpy(impulses + to, p->r + 3 * i, 3 * sizeof *impulses);
        for (size_t k = 0; k < 3 && tell && is_torque(p, i); k++)
            o->torques[to + k] = p->arms[i] * p->r[3 * i + k];
    }
}

static tribo_status judge_start(const plan *p, const tribo_system_options *o, const double *start)
{
    const int turns = p->torques > 0 && o->torques != NULL;

    for (size_t i = 0; o->warm_start != 0 && i < 3 * (size_t)p->contacts_given; i++) {
        if (!all_finite(start + i, 1) || (turns && !all_finite(o->torques + i, 1)))
            return TRIBO_ERROR_NOT_FINITE;
    }
    return TRIBO_OK;
}

/* ---- bodies form: the calls ------------------------------------------------------------------ */

static tribo_status plan_bodies(plan *p, arena *a, size_t body_count, size_t count,
                                const tribo_system_contact *contacts, const tribo_system_options *o,
                                size_t *size)
{
    const plan none = {0};
    size_t torques = 0;

    if (body_count > MOST_COUNT / 6 || count > MOST_COUNT / 6)
        return TRIBO_ERROR_CAPACITY;
    for (size_t i = 0; i < count; i++)
        torques += resists(&contacts[i]) ? 1 : 0;
    if (count + torques > MOST_COUNT / 6)
        return TRIBO_ERROR_CAPACITY;
    *p = none;
    p->bodies = (uint32_t)body_count;
    p->contacts_given = (uint32_t)count;
    p->torques = (uint32_t)torques;
    p->count = p->contacts_given + p->torques;
    p->links = 2 * (size_t)p->count;
    return measure(p, a, o, size);
}

tribo_status tribo_system_workspace_size(size_t body_count, size_t count,
                                         const tribo_system_contact *contacts,
                                         const tribo_system_options *options, size_t *size)
{
    tribo_system_options o;
    arena counting = {NULL, 0, 0};
    size_t needed = 0;
    plan p;

    if (size == NULL || (count > 0 && contacts == NULL))
        return TRIBO_ERROR_NULL;
    tribo_status status = read_options(options, &o);
    if (status == TRIBO_OK)
        status = plan_bodies(&p, &counting, body_count, count, contacts, &o, &needed);
    if (status == TRIBO_OK)
        status = judge_ends(body_count, count, contacts);
    if (status == TRIBO_OK)
        *size = needed;
    return status;
}

/* Change of a body's momentum about the origin: linear, angular; and their sizes. */
static void momentum_of_body(const tribo_body *before, const double dv[6], double sums[6],
                             double scales[2])
{
    tribo_body after = *before;
    double spins[2][3];
    double change[3];
    double orbit[3];

    for (int k = 0; k < 3; k++) {
        after.angular_velocity[k] = before->angular_velocity[k] + dv[3 + k];
        change[k] = before->inverse_mass > 0.0
                        ? (before->velocity[k] + dv[k] - before->velocity[k]) / before->inverse_mass
                        : 0.0;
    }
    tribo_vec3_cross(before->position, change, orbit);
    tribo_vec3_add(sums, change, sums);
    tribo_vec3_add(sums + 3, orbit, sums + 3);
    scales[0] += tribo_vec3_norm(change);
    scales[1] += tribo_vec3_norm(before->position) * tribo_vec3_norm(change);
    if (tribo_body_spin(before, spins[0]) == TRIBO_OK &&
        tribo_body_spin(&after, spins[1]) == TRIBO_OK) {
        tribo_vec3_subtract(spins[1], spins[0], spins[1]);
        tribo_vec3_add(sums + 3, spins[1], sums + 3);
        scales[1] += tribo_vec3_norm(spins[1]);
    }
}

/* What the impulse of a contact with the world gave. */
static void momentum_of_world(const plan *p, size_t c, const tribo_body *bodies, double sums[6])
{
    const uint32_t side = p->pairs[2 * c] == TRIBO_WORLD;
    const uint32_t body = p->body_order[p->pairs[2 * c + side]];
    const double *arm = side == 0 ? p->contacts[c].arm_a : p->contacts[c].arm_b;
    double impulse[3];
    double point[3];
    double moment[3];

    if (is_torque(p, c)) {
        tribo_mat3_apply_transposed(p->turns + 18 * c, p->r + 3 * c, moment);
        tribo_vec3_add_scaled(sums + 3, side == 0 ? -1.0 : 1.0, moment, sums + 3);
        return;
    }
    tribo_mat3_apply_transposed(p->frames + 9 * c, p->r + 3 * c, impulse);
    tribo_vec3_scale(side == 0 ? -1.0 : 1.0, impulse, impulse);
    tribo_vec3_add(bodies[body].position, arm, point);
    tribo_vec3_cross(point, impulse, moment);
    tribo_vec3_add(sums, impulse, sums);
    tribo_vec3_add(sums + 3, moment, sums + 3);
}

static void momentum(plan *p, const tribo_body *bodies, tribo_system_info *info)
{
    const system_problem problem = whole_problem(p);
    double sums[6] = {0.0};
    double scales[2] = {0.0, 0.0};

    for (size_t i = 0; i < problem.bodies; i++) {
        const tribo_body *before = &bodies[p->body_order[i]];
        const double *dv = p->solver.dv + 6 * i;
        momentum_of_body(before, dv, sums, scales);
    }
    for (size_t c = 0; c < problem.count; c++) {
        const uint32_t *pair = problem.pairs + 2 * c;
        if (pair[0] == TRIBO_WORLD || pair[1] == TRIBO_WORLD)
            momentum_of_world(p, c, bodies, sums);
    }
    info->linear = scales[0] > 0.0 ? tribo_vec3_norm(sums) / scales[0] : 0.0;
    info->angular = scales[1] > 0.0 ? tribo_vec3_norm(sums + 3) / scales[1] : 0.0;
}

static int give_velocities(const plan *p, size_t body_count, const tribo_body *bodies,
                           double *velocities)
{
    double probe = 0.0;

    for (size_t i = 0; i < 6 * (size_t)p->body_starts[p->components]; i++) {
        const double v = p->free_velocity[i] + p->solver.dv[i];
        probe += v - v;
    }
    if (probe != 0.0 || velocities == NULL)
        return probe == 0.0;
    for (size_t i = 0; i < body_count; i++) {
        const uint32_t rank = p->body_rank[i];
        for (size_t k = 0; k < 6; k++) {
            const double v = k < 3 ? bodies[i].velocity[k] : bodies[i].angular_velocity[k - 3];
            velocities[6 * i + k] = rank != UINT32_MAX ? v + p->solver.dv[6 * (size_t)rank + k] : v;
        }
    }
    return 1;
}

static tribo_status solve_bodies(plan *p, const tribo_system_options *o, const tribo_body *bodies,
                                 const tribo_system_contact *contacts, double *impulses,
                                 double *velocities, tribo_system_info *whole)
{
    tribo_status status = judge_bodies(p->bodies, bodies, p->contacts_given, contacts);

    if (status == TRIBO_OK)
        status = judge_start(p, o, impulses);
    if (status != TRIBO_OK)
        return status;
    arrange_bodies(p, bodies, contacts);
    status = lay_bodies(p, bodies, contacts);
    if (status != TRIBO_OK)
        return status;
    solve_all(p, o, impulses, whole);
    if (p->solver.status != TRIBO_OK)
        return p->solver.status;
    if (!certify(p, whole) || !give_velocities(p, p->bodies, bodies, velocities))
        return TRIBO_ERROR_RANGE;
    if (is_told(p, offsetof(tribo_system_info, linear)))
        momentum(p, bodies, whole);
    whole->seconds = solver_now(o) - p->solver.start;
    give_impulses(p, o, impulses);
    return TRIBO_OK;
}

tribo_status tribo_system_solve(size_t body_count, const tribo_body *bodies, size_t count,
                                const tribo_system_contact *contacts,
                                const tribo_system_options *options, void *workspace, size_t size,
                                double *impulses, double *velocities, tribo_system_info *info)
{
    tribo_system_options o;
    tribo_system_info whole = {0};
    arena places = {workspace, 0, 0};
    size_t needed = 0;
    plan p;

    if ((body_count > 0 && bodies == NULL) || (count > 0 && (contacts == NULL || impulses == NULL)))
        return TRIBO_ERROR_NULL;
    tribo_status status = judge_info(info);
    if (status == TRIBO_OK)
        status = read_options(options, &o);
    if (status == TRIBO_OK)
        status = plan_bodies(&p, &places, body_count, count, contacts, &o, &needed);
    if (status == TRIBO_OK)
        status = judge_ends(body_count, count, contacts);
    if (status == TRIBO_OK)
        status = judge_place(&o, workspace, size, needed);
    if (status != TRIBO_OK)
        return status;
    p.told = told_size(info);
    p.is_brief =
        !is_told(&p, offsetof(tribo_system_info, eta_rms)) && o.measure == TRIBO_MEASURE_ETA;
    status = solve_bodies(&p, &o, bodies, contacts, impulses, velocities, &whole);
    whole.bytes = needed;
    if (status == TRIBO_OK)
        give_info(&whole, info);
    return status;
}

tribo_status tribo_system_apply(size_t body_count, tribo_body *bodies, const double *velocities)
{
    if (body_count > 0 && (bodies == NULL || velocities == NULL))
        return TRIBO_ERROR_NULL;
    for (size_t i = 0; i < body_count; i++) {
        if (!all_finite(velocities + 6 * i, 6))
            return TRIBO_ERROR_NOT_FINITE;
    }
    for (size_t i = 0; i < body_count; i++) {
        memcpy(bodies[i].velocity, velocities + 6 * i, sizeof bodies[i].velocity);
        memcpy(bodies[i].angular_velocity, velocities + 6 * i + 3,
               sizeof bodies[i].angular_velocity);
    }
    return TRIBO_OK;
}

/* ---- assembled form -------------------------------------------------------------------------- */

static tribo_status judge_rows(size_t count, const uint32_t *row_starts, const uint32_t *columns)
{
    if (row_starts[0] != 0)
        return TRIBO_ERROR_INDEX;
    for (size_t i = 0; i < count; i++) {
        uint32_t diagonal = 0;
        if (row_starts[i + 1] < row_starts[i])
            return TRIBO_ERROR_INDEX;
        for (size_t k = row_starts[i]; k < row_starts[i + 1]; k++) {
            if (columns[k] >= count || (k > row_starts[i] && columns[k] <= columns[k - 1]))
                return TRIBO_ERROR_INDEX;
            diagonal |= columns[k] == i;
        }
        if (diagonal == 0)
            return TRIBO_ERROR_INDEX;
    }
    return TRIBO_OK;
}

static tribo_status plan_blocks(plan *p, arena *a, size_t count, const uint32_t *row_starts,
                                const tribo_system_options *o, size_t *size)
{
    const plan none = {0};

    if (count > MOST_COUNT / 6)
        return TRIBO_ERROR_CAPACITY;
    *p = none;
    p->count = p->contacts_given = (uint32_t)count;
    p->assembled = 1;
    p->links = row_starts != NULL ? row_starts[count] : count * count;
    if (p->links > MOST_COUNT / 9)
        return TRIBO_ERROR_CAPACITY;
    return measure(p, a, o, size);
}

tribo_status tribo_system_assembled_workspace_size(size_t count, const uint32_t *row_starts,
                                                   const uint32_t *columns,
                                                   const tribo_system_options *options,
                                                   size_t *size)
{
    tribo_system_options o;
    arena counting = {NULL, 0, 0};
    plan p;

    if (size == NULL || (row_starts != NULL && columns == NULL && count > 0))
        return TRIBO_ERROR_NULL;
    tribo_status status = read_options(options, &o);
    if (status == TRIBO_OK && row_starts != NULL)
        status = judge_rows(count, row_starts, columns);
    return status != TRIBO_OK ? status : plan_blocks(&p, &counting, count, row_starts, &o, size);
}

/* What the caller gave: W by blocks, or dense. */
typedef struct assembled {
    const uint32_t *row_starts, *columns;
    const double *blocks, *q, *mu;
} assembled;

static size_t blocks_of(const plan *p, const assembled *given, size_t row)
{
    return given->row_starts != NULL ? given->row_starts[row + 1] - given->row_starts[row]
                                     : p->count;
}

/* Block `k` of a row: its column and numbers. */
static uint32_t read_block(const plan *p, const assembled *given, size_t row, size_t k,
                           double out[9])
{
    if (given->row_starts != NULL) {
        const size_t at = given->row_starts[row] + k;
        memcpy(out, given->blocks + 9 * at, 9 * sizeof *out);
        return given->columns[at];
    }
    for (size_t i = 0; i < 3; i++)
        memcpy(out + 3 * i, given->blocks + (3 * row + i) * 3 * p->count + 3 * k, 3 * sizeof *out);
    return (uint32_t)k;
}

static int is_zero(const double block[9])
{
    for (int i = 0; i < 9; i++) {
        if (block[i] != 0.0)
            return 0;
    }
    return 1;
}

static int is_semidefinite(const double w[9])
{
    const double half[6] = {w[0], 0.5 * (w[1] + w[3]), 0.5 * (w[2] + w[6]),
                            w[4], 0.5 * (w[5] + w[7]), w[8]};
    return sym3_is_semidefinite(half, 1e-9);
}

static tribo_status judge_diagonal(const double w[9])
{
    if (w[0] == 0.0)
        return TRIBO_ERROR_IMMOVABLE;
    return is_semidefinite(w) ? TRIBO_OK : TRIBO_ERROR_CONTACT_MATRIX;
}

static tribo_status judge_blocks(plan *p, const assembled *given)
{
    for (size_t i = 0; i < p->count; i++) {
        const double *mu = given->mu + 2 * i;
        const tribo_material pair = {mu[0], mu[1], 0.0};
        tribo_status status = tribo_material_check(&pair);
        if (status != TRIBO_OK)
            return status;
        if (!all_finite(given->q + 3 * i, 3))
            return TRIBO_ERROR_NOT_FINITE;
        for (size_t k = 0; k < blocks_of(p, given, i); k++) {
            double block[9];
            const uint32_t column = read_block(p, given, i, k, block);
            if (!all_finite(block, 9))
                return TRIBO_ERROR_NOT_FINITE;
            if (column == i && (status = judge_diagonal(block)) != TRIBO_OK)
                return status;
        }
    }
    return TRIBO_OK;
}

static void arrange_blocks(plan *p, const assembled *given)
{
    for (uint32_t i = 0; i < p->count; i++)
        p->parent[i] = i;
    for (uint32_t i = 0; i < p->count; i++) {
        for (size_t k = 0; k < blocks_of(p, given, i); k++) {
            double block[9];
            const uint32_t column = read_block(p, given, i, k, block);
            if (!is_zero(block))
                unite(p->parent, i, column);
        }
    }
    p->components = number_components(p->count, p->parent);
    sort_items(p->count, p->components, p->parent, p->starts, p->order, p->rank);
}

static void lay_blocks(plan *p, const assembled *given)
{
    uint32_t at = 0;

    for (size_t place = 0; place < p->count; place++) {
        const size_t row = p->order[place];
        const uint32_t first = p->starts[p->parent[row]];
        p->row_starts[place] = at;
        for (size_t k = 0; k < blocks_of(p, given, row); k++) {
            double *block = p->blocks + 9 * (size_t)at;
            const uint32_t column = read_block(p, given, row, k, block);
            if (is_zero(block))
                continue;
            p->columns[at] = p->rank[column];
            p->local_columns[at] = p->rank[column] - first;
            if (column == row) {
                memcpy(p->diagonal + 9 * place, block, 9 * sizeof *block);
                p->symmetric[place] =
                    block[1] == block[3] && block[2] == block[6] && block[5] == block[7];
            }
            at++;
        }
        memcpy(p->q + 3 * place, given->q + 3 * row, 3 * sizeof *p->q);
        memcpy(p->mu + 2 * place, given->mu + 2 * row, 2 * sizeof *p->mu);
    }
    p->row_starts[p->count] = at;
}

static tribo_status solve_blocks(plan *p, const tribo_system_options *o, const assembled *given,
                                 double *impulses, double *velocities, tribo_system_info *whole)
{
    tribo_status status = judge_blocks(p, given);

    if (status == TRIBO_OK)
        status = judge_start(p, o, impulses);
    if (status != TRIBO_OK)
        return status;
    arrange_blocks(p, given);
    lay_blocks(p, given);
    solve_all(p, o, impulses, whole);
    if (p->solver.status != TRIBO_OK)
        return p->solver.status;
    if (!certify(p, whole))
        return TRIBO_ERROR_RANGE;
    whole->seconds = solver_now(o) - p->solver.start;
    give_impulses(p, o, impulses);
    for (size_t i = 0; velocities != NULL && i < p->count; i++)
        memcpy(velocities + 3 * (size_t)p->order[i], p->solver.u + 3 * i, 3 * sizeof *velocities);
    return TRIBO_OK;
}

tribo_status tribo_system_solve_assembled(size_t count, const uint32_t *row_starts,
                                          const uint32_t *columns, const double *blocks,
                                          const double *q, const double *mu,
                                          const tribo_system_options *options, void *workspace,
                                          size_t size, double *impulses, double *velocities,
                                          tribo_system_info *info)
{
    const assembled given = {row_starts, columns, blocks, q, mu};
    tribo_system_options o;
    tribo_system_info whole = {0};
    arena places = {workspace, 0, 0};
    size_t needed = 0;
    plan p;

    if (count > 0 && (blocks == NULL || q == NULL || mu == NULL || impulses == NULL))
        return TRIBO_ERROR_NULL;
    tribo_status status = judge_info(info);
    if (status == TRIBO_OK)
        status = read_options(options, &o);
    if (status == TRIBO_OK)
        status =
            tribo_system_assembled_workspace_size(count, row_starts, columns, options, &needed);
    if (status == TRIBO_OK)
        status = judge_place(&o, workspace, size, needed);
    if (status != TRIBO_OK)
        return status;
    plan_blocks(&p, &places, count, row_starts, &o, &needed);
    p.told = told_size(info);
    status = solve_blocks(&p, &o, &given, impulses, velocities, &whole);
    whole.bytes = needed;
    if (status == TRIBO_OK)
        give_info(&whole, info);
    return status;
}
