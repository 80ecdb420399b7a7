#include "coupled.h"

#include <stdlib.h>
#include <string.h>

/* Arrays of a coupled problem that may be written. */
typedef struct parts {
    double *frames, *turns, *inverse_mass, *inverse_inertia, *target, *diagonal, *q, *mu, *v;
    uint32_t *pairs, *symmetric;
} parts;

static double *take(double **at, size_t count)
{
    double *taken = *at;
    *at += count;
    return taken;
}

static void allocate(size_t count, size_t bodies, coupled *out, parts *p)
{
    const size_t numbers = count * (9 + 18 + 3 + 9 + 3 + 2 + 2) + bodies * (1 + 6 + 6) + 1;
    double *at = calloc(numbers, sizeof *at);
    if (at == NULL) {
        abort();
    }
    out->memory = at;
    p->frames = take(&at, 9 * count);
    p->turns = take(&at, 18 * count);
    p->target = take(&at, 3 * count);
    p->diagonal = take(&at, 9 * count);
    p->q = take(&at, 3 * count);
    p->mu = take(&at, 2 * count);
    p->inverse_mass = take(&at, bodies);
    p->inverse_inertia = take(&at, 6 * bodies);
    p->v = take(&at, 6 * bodies);
    p->pairs = (uint32_t *)(void *)take(&at, count);
    p->symmetric = (uint32_t *)(void *)take(&at, count);
}

static void give(const parts *p, size_t count, size_t bodies, coupled *out)
{
    const system_problem problem = {
        .count = (uint32_t)count,
        .bodies = (uint32_t)bodies,
        .pairs = p->pairs,
        .frames = p->frames,
        .turns = p->turns,
        .inverse_mass = p->inverse_mass,
        .inverse_inertia = p->inverse_inertia,
        .target = p->target,
        .diagonal = p->diagonal,
        .symmetric = p->symmetric,
        .q = p->q,
        .mu = p->mu,
    };
    out->problem = problem;
    out->free_velocity = p->v;
}

/* Inverse inertia in world axes: R J R^T. */
static void add_body(const tribo_body *body, size_t k, const parts *p)
{
    double r[9];
    double column[3][3];
    size_t at = 6 * k;
    tribo_quat_to_mat3(body->orientation, r);
    for (size_t i = 0; i < 3; i++) {
        double axis[3] = {r[3 * i], r[3 * i + 1], r[3 * i + 2]};
        tribo_sym3_apply(body->inverse_inertia, axis, axis);
        tribo_mat3_apply(r, axis, column[i]);
    }
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = i; j < 3; j++) {
            p->inverse_inertia[at++] = column[i][j];
        }
    }
    p->inverse_mass[k] = body->inverse_mass;
    memcpy(p->v + 6 * k, body->velocity, sizeof body->velocity);
    memcpy(p->v + 6 * k + 3, body->angular_velocity, sizeof body->angular_velocity);
}

static int moves(const tribo_body *body)
{
    const double *j = body->inverse_inertia;
    return body->inverse_mass > 0.0 || j[0] > 0.0 || j[3] > 0.0 || j[5] > 0.0;
}

/* f . (v + omega x arm) = f . v + (arm x f) . omega */
static void add_end(const systems_scene *scene, uint32_t body, const double arm[3], size_t c,
                    size_t end, const parts *p)
{
    const int still = body == TRIBO_WORLD || !moves(&scene->bodies[body]);
    p->pairs[2 * c + end] = still ? TRIBO_WORLD : body;
    for (size_t k = 0; k < 3; k++) {
        tribo_vec3_cross(arm, p->frames + 9 * c + 3 * k, p->turns + 18 * c + 9 * end + 3 * k);
    }
}

static void add_contact(const systems_scene *scene, size_t c, const parts *p)
{
    const tribo_system_contact *own = &scene->contacts[c];
    const tribo_body world = {.orientation = {1.0, 0.0, 0.0, 0.0}};
    const tribo_body *a = own->a == TRIBO_WORLD ? &world : &scene->bodies[own->a];
    const tribo_body *b = own->b == TRIBO_WORLD ? &world : &scene->bodies[own->b];
    const int one = own->dimension == 1;
    double w[6] = {0.0};
    double u[3];
    tribo_basis_from_normal(own->contact.normal, p->frames + 9 * c);
    add_end(scene, own->a, own->contact.arm_a, c, 0, p);
    add_end(scene, own->b, own->contact.arm_b, c, 1, p);
    tribo_contact_matrix(a, b, &own->contact, p->frames + 9 * c, w);
    tribo_contact_velocity(a, b, &own->contact, p->frames + 9 * c, u);
    const double full[9] = {w[0], w[1], w[2], w[1], w[3], w[4], w[2], w[4], w[5]};
    memcpy(p->diagonal + 9 * c, full, sizeof full);
    memcpy(p->target + 3 * c, own->target, sizeof own->target);
    tribo_vec3_subtract(u, own->target, p->q + 3 * c);
    p->mu[2 * c] = one ? 0.0 : own->pair.mu_s;
    p->mu[2 * c + 1] = one ? 0.0 : own->pair.mu_d;
    p->symmetric[c] = 1;
}

void coupled_of_scene(const systems_scene *scene, coupled *out)
{
    parts p;
    allocate(scene->count, scene->body_count, out, &p);
    for (size_t k = 0; k < scene->body_count; k++) {
        add_body(&scene->bodies[k], k, &p);
    }
    for (size_t c = 0; c < scene->count; c++) {
        add_contact(scene, c, &p);
    }
    give(&p, scene->count, scene->body_count, out);
}

static void copy_diagonal(const systems_blocks *blocks, size_t c, double *out)
{
    for (uint32_t at = blocks->row_starts[c]; at < blocks->row_starts[c + 1]; at++) {
        if (blocks->columns[at] == c) {
            memcpy(out, blocks->blocks + 9 * (size_t)at, 9 * sizeof *out);
        }
    }
}

void coupled_of_blocks(const systems_blocks *blocks, const double *dense, coupled *out)
{
    parts p;
    allocate(blocks->count, 0, out, &p);
    for (size_t c = 0; c < blocks->count; c++) {
        double *w = p.diagonal + 9 * c;
        copy_diagonal(blocks, c, w);
        p.symmetric[c] = w[1] == w[3] && w[2] == w[6] && w[5] == w[7];
    }
    memcpy(p.q, blocks->q, 3 * blocks->count * sizeof *p.q);
    memcpy(p.mu, blocks->mu, 2 * blocks->count * sizeof *p.mu);
    give(&p, blocks->count, 0, out);
    out->problem.row_starts = dense ? NULL : blocks->row_starts;
    out->problem.columns = dense ? NULL : blocks->columns;
    out->problem.blocks = dense ? dense : blocks->blocks;
}

void coupled_free(coupled *c)
{
    free(c->memory);
    memset(c, 0, sizeof *c);
}
