#include "systems.h"

#include "problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STREAM = 900 };

static const double up[3] = {0.0, 0.0, 1.0};
static const double pi = 3.14159265358979323846;

static void *grow(void *memory, size_t count, size_t size)
{
    void *larger = realloc(memory, count * size);
    if (larger == NULL) {
        abort();
    }
    return larger;
}

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size);
    if (memory == NULL) {
        abort();
    }
    return memory;
}

/* ---- parts ----------------------------------------------------------------------------------- */

void systems_free(systems_scene *scene)
{
    free(scene->bodies);
    free(scene->contacts);
    memset(scene, 0, sizeof *scene);
}

void systems_append(systems_scene *scene, const systems_scene *other)
{
    const uint32_t offset = (uint32_t)scene->body_count;
    const size_t bodies = scene->body_count + other->body_count;
    const size_t contacts = scene->count + other->count;
    scene->bodies = grow(scene->bodies, bodies + 1, sizeof *scene->bodies);
    scene->contacts = grow(scene->contacts, contacts + 1, sizeof *scene->contacts);
    for (size_t i = 0; i < other->body_count; i++) {
        scene->bodies[scene->body_count++] = other->bodies[i];
    }
    for (size_t i = 0; i < other->count; i++) {
        tribo_system_contact *c = &scene->contacts[scene->count++];
        *c = other->contacts[i];
        c->a += c->a == TRIBO_WORLD ? 0 : offset;
        c->b += c->b == TRIBO_WORLD ? 0 : offset;
    }
    scene->body_capacity = bodies + 1;
    scene->capacity = contacts + 1;
}

void systems_copy(const systems_scene *from, systems_scene *to)
{
    memset(to, 0, sizeof *to);
    systems_append(to, from);
}

static tribo_body *add_body(systems_scene *scene, const double position[3])
{
    if (scene->body_count == scene->body_capacity) {
        scene->body_capacity = 2 * scene->body_capacity + 8;
        scene->bodies = grow(scene->bodies, scene->body_capacity, sizeof *scene->bodies);
    }
    tribo_body *body = &scene->bodies[scene->body_count++];
    tribo_body_init(body);
    memcpy(body->position, position, sizeof body->position);
    return body;
}

uint32_t systems_add_static(systems_scene *scene, const double position[3])
{
    add_body(scene, position);
    return (uint32_t)(scene->body_count - 1);
}

uint32_t systems_add_box(systems_scene *scene, const double half[3], double mass,
                         const double position[3])
{
    tribo_body *body = add_body(scene, position);
    const double x = half[0] * half[0];
    const double y = half[1] * half[1];
    const double z = half[2] * half[2];
    body->inverse_mass = 1.0 / mass;
    body->inverse_inertia[0] = 3.0 / (mass * (y + z));
    body->inverse_inertia[3] = 3.0 / (mass * (x + z));
    body->inverse_inertia[5] = 3.0 / (mass * (x + y));
    return (uint32_t)(scene->body_count - 1);
}

uint32_t systems_add_sphere(systems_scene *scene, double radius, double mass,
                            const double position[3])
{
    tribo_body *body = add_body(scene, position);
    body->inverse_mass = 1.0 / mass;
    for (size_t i = 0; i < 6; i++) {
        body->inverse_inertia[i] = i == 0 || i == 3 || i == 5 ? 2.5 / (mass * radius * radius) : 0;
    }
    return (uint32_t)(scene->body_count - 1);
}

static void set_arm(const systems_scene *scene, uint32_t body, const double point[3], double arm[3])
{
    for (size_t i = 0; i < 3; i++) {
        arm[i] = body == TRIBO_WORLD ? 0.0 : point[i] - scene->bodies[body].position[i];
    }
}

tribo_system_contact *systems_add_contact(systems_scene *scene, uint32_t a, uint32_t b,
                                          const double point[3], const double normal[3], double mu)
{
    if (scene->count == scene->capacity) {
        scene->capacity = 2 * scene->capacity + 8;
        scene->contacts = grow(scene->contacts, scene->capacity, sizeof *scene->contacts);
    }
    tribo_system_contact *contact = &scene->contacts[scene->count++];
    memset(contact, 0, sizeof *contact);
    contact->a = a;
    contact->b = b;
    contact->dimension = 3;
    memcpy(contact->contact.normal, normal, sizeof contact->contact.normal);
    set_arm(scene, a, point, contact->contact.arm_a);
    set_arm(scene, b, point, contact->contact.arm_b);
    contact->pair.mu_s = contact->pair.mu_d = mu;
    return contact;
}

void systems_accelerate(systems_scene *scene, const double dv[3])
{
    for (size_t i = 0; i < scene->body_count; i++) {
        for (size_t k = 0; k < 3 && scene->bodies[i].inverse_mass > 0.0; k++) {
            scene->bodies[i].velocity[k] += dv[k];
        }
    }
}

static void fall(systems_scene *scene)
{
    const double dv[3] = {0.0, 0.0, -SYSTEMS_FALL};
    systems_accelerate(scene, dv);
}

static void scale(double *x, size_t n, int exponent)
{
    for (size_t i = 0; i < n; i++) {
        x[i] = ldexp(x[i], exponent);
    }
}

void systems_scale(systems_scene *scene, int length, int mass, int time)
{
    for (size_t i = 0; i < scene->body_count; i++) {
        tribo_body *body = &scene->bodies[i];
        scale(body->position, 3, length);
        scale(body->velocity, 3, length - time);
        scale(body->angular_velocity, 3, -time);
        scale(&body->inverse_mass, 1, -mass);
        scale(body->inverse_inertia, 6, -mass - 2 * length);
    }
    for (size_t i = 0; i < scene->count; i++) {
        scale(scene->contacts[i].contact.arm_a, 3, length);
        scale(scene->contacts[i].contact.arm_b, 3, length);
        scale(scene->contacts[i].target, 3, length - time);
        scale(&scene->contacts[i].rolling, 1, length);
        scale(&scene->contacts[i].spinning, 1, length);
    }
}

void systems_permute(systems_scene *scene, uint64_t seed, size_t *order)
{
    problem_random random;
    problem_random_start(&random, STREAM, seed, 0);
    for (size_t i = 0; i < scene->count && order != NULL; i++) {
        order[i] = i;
    }
    for (size_t i = scene->count; i > 1; i--) {
        const size_t k = (size_t)(problem_random_bits(&random) % i);
        const tribo_system_contact kept = scene->contacts[i - 1];
        scene->contacts[i - 1] = scene->contacts[k];
        scene->contacts[k] = kept;
        if (order != NULL) {
            const size_t old = order[i - 1];
            order[i - 1] = order[k];
            order[k] = old;
        }
    }
}

/* ---- assembled ------------------------------------------------------------------------------- */

static int moves(const systems_scene *scene, uint32_t index)
{
    if (index == TRIBO_WORLD) {
        return 0;
    }
    const tribo_body *body = &scene->bodies[index];
    double sum = body->inverse_mass;
    for (size_t i = 0; i < 6; i++) {
        sum += fabs(body->inverse_inertia[i]);
    }
    return sum > 0.0;
}

/* sign J_c M^-1 J_d^T of one body, added. */
static void add_product(const tribo_body *body, const tribo_contact *c, const double arm_c[3],
                        const tribo_contact *d, const double arm_d[3], double sign, double block[9])
{
    double frames[2][9];
    double inertia[6];
    tribo_basis_from_normal(c->normal, frames[0]);
    tribo_basis_from_normal(d->normal, frames[1]);
    tribo_body_world_inverse_inertia(body, inertia);
    for (size_t row = 0; row < 3; row++) {
        double moment[3];
        double turned[3];
        tribo_vec3_cross(arm_c, frames[0] + 3 * row, moment);
        tribo_sym3_apply(inertia, moment, turned);
        for (size_t column = 0; column < 3; column++) {
            const double *axis = frames[1] + 3 * column;
            double other[3];
            tribo_vec3_cross(arm_d, axis, other);
            block[3 * row + column] +=
                sign * (body->inverse_mass * tribo_vec3_dot(frames[0] + 3 * row, axis) +
                        tribo_vec3_dot(turned, other));
        }
    }
}

static int add_shared(const systems_scene *scene, size_t i, size_t k, double block[9])
{
    const tribo_system_contact *c = &scene->contacts[i];
    const tribo_system_contact *d = &scene->contacts[k];
    int shared = 0;
    memset(block, 0, 9 * sizeof block[0]);
    for (size_t side = 0; side < 4; side++) {
        const uint32_t body = side / 2 == 0 ? c->a : c->b;
        const double *arm = side / 2 == 0 ? c->contact.arm_a : c->contact.arm_b;
        const double *other = side % 2 == 0 ? d->contact.arm_a : d->contact.arm_b;
        if (moves(scene, body) && body == (side % 2 == 0 ? d->a : d->b)) {
            add_product(&scene->bodies[body], &c->contact, arm, &d->contact, other,
                        side / 2 == side % 2 ? 1.0 : -1.0, block);
            shared = 1;
        }
    }
    return shared;
}

static void assemble_velocity(const systems_scene *scene, size_t i, double q[3])
{
    const tribo_system_contact *c = &scene->contacts[i];
    tribo_body world;
    double frame[9];
    tribo_body_init(&world);
    tribo_basis_from_normal(c->contact.normal, frame);
    const tribo_body *a = c->a == TRIBO_WORLD ? &world : &scene->bodies[c->a];
    const tribo_body *b = c->b == TRIBO_WORLD ? &world : &scene->bodies[c->b];
    tribo_contact_velocity(a, b, &c->contact, frame, q);
    for (size_t k = 0; k < 3; k++) {
        q[k] -= c->target[k];
    }
}

void systems_assemble(const systems_scene *scene, systems_blocks *out)
{
    const size_t n = scene->count;
    size_t capacity = 16 * n + 16;
    size_t used = 0;
    memset(out, 0, sizeof *out);
    out->count = n;
    out->row_starts = allocate(n + 1, sizeof *out->row_starts);
    out->q = allocate(3 * n, sizeof *out->q);
    out->mu = allocate(2 * n, sizeof *out->mu);
    out->columns = allocate(capacity, sizeof *out->columns);
    out->blocks = allocate(9 * capacity, sizeof *out->blocks);
    for (size_t i = 0; i < n; i++) {
        const tribo_system_contact *c = &scene->contacts[i];
        assemble_velocity(scene, i, out->q + 3 * i);
        out->mu[2 * i] = c->dimension == 1 ? 0.0 : c->pair.mu_s;
        out->mu[2 * i + 1] = c->dimension == 1 ? 0.0 : c->pair.mu_d;
        for (size_t k = 0; k < n; k++) {
            if (used == capacity) {
                capacity *= 2;
                out->columns = grow(out->columns, capacity, sizeof *out->columns);
                out->blocks = grow(out->blocks, 9 * capacity, sizeof *out->blocks);
            }
            if (add_shared(scene, i, k, out->blocks + 9 * used)) {
                out->columns[used++] = (uint32_t)k;
            }
        }
        out->row_starts[i + 1] = (uint32_t)used;
    }
}

void systems_free_blocks(systems_blocks *blocks)
{
    free(blocks->row_starts);
    free(blocks->columns);
    free(blocks->blocks);
    free(blocks->q);
    free(blocks->mu);
    memset(blocks, 0, sizeof *blocks);
}

double *systems_dense(const systems_blocks *blocks)
{
    const size_t n = blocks->count;
    double *dense = allocate(9 * n * n, sizeof *dense);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = blocks->row_starts[i]; k < blocks->row_starts[i + 1]; k++) {
            for (size_t e = 0; e < 9; e++) {
                const size_t row = 3 * i + e / 3;
                dense[row * 3 * n + 3 * blocks->columns[k] + e % 3] = blocks->blocks[9 * k + e];
            }
        }
    }
    return dense;
}

/* ---- scenes that stand ----------------------------------------------------------------------- */

/* Four contacts of a over b at the corners of a rectangle. */
static void add_rectangle(systems_scene *scene, uint32_t a, uint32_t b, const double low[2],
                          const double high[2], double z, double mu)
{
    for (size_t i = 0; i < 4; i++) {
        const double point[3] = {i % 2 == 0 ? low[0] : high[0], i / 2 == 0 ? low[1] : high[1], z};
        systems_add_contact(scene, a, b, point, up, mu);
    }
}

static void stack_cubes(systems_scene *out, size_t boxes, const double *masses, const double *mu)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    static const double low[2] = {-0.5, -0.5};
    static const double high[2] = {0.5, 0.5};
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < boxes; i++) {
        const double position[3] = {0.0, 0.0, 0.5 + (double)i};
        const uint32_t box = systems_add_box(out, half, masses[i], position);
        add_rectangle(out, box, i == 0 ? TRIBO_WORLD : box - 1, low, high, (double)i, mu[i]);
    }
}

void systems_tower(systems_scene *out, size_t boxes, uint32_t masses, double ratio, double mu)
{
    double *mass = allocate(boxes, sizeof *mass);
    double *friction = allocate(boxes, sizeof *friction);
    for (size_t i = 0; i < boxes; i++) {
        mass[i] = 1.0;
        if (masses == SYSTEMS_GEOMETRIC && boxes > 1) {
            mass[i] = pow(ratio, (double)i / (double)(boxes - 1));
        } else if (masses == SYSTEMS_ALTERNATE ? i % 2 == 1 : i + 1 == boxes) {
            mass[i] = ratio;
        }
        friction[i] = mu;
    }
    stack_cubes(out, boxes, mass, friction);
    fall(out);
    free(mass);
    free(friction);
}

void systems_sliding_tower(systems_scene *out, size_t boxes, uint64_t seed)
{
    problem_random random;
    double *mass = allocate(boxes, sizeof *mass);
    double *friction = allocate(boxes, sizeof *friction);
    problem_random_start(&random, STREAM + 1, seed, boxes);
    const double least = problem_random_bits(&random) % 4 == 0 ? 1.0 : 0.0;
    const double mu = problem_random_uniform(&random, least, 1.5);
    const double speed = problem_random_decades(&random, -2.0, 0.5);
    for (size_t i = 0; i < boxes; i++) {
        mass[i] = 1.0;
        friction[i] = mu;
    }
    stack_cubes(out, boxes, mass, friction);
    fall(out);
    for (size_t i = 0; i < boxes; i++) {
        out->bodies[i].velocity[0] += speed * problem_random_normal(&random);
        out->bodies[i].velocity[1] += speed * problem_random_normal(&random);
        out->bodies[i].angular_velocity[2] += speed * problem_random_normal(&random);
    }
    free(mass);
    free(friction);
}

void systems_box_on_slope(systems_scene *out, double width, double height, double angle, double mu)
{
    const double half[3] = {width / 2.0, width / 2.0, height / 2.0};
    const double position[3] = {0.0, 0.0, height / 2.0};
    const double low[2] = {-width / 2.0, -width / 2.0};
    const double high[2] = {width / 2.0, width / 2.0};
    const double dv[3] = {SYSTEMS_FALL * sin(angle), 0.0, -SYSTEMS_FALL * cos(angle)};
    memset(out, 0, sizeof *out);
    add_rectangle(out, systems_add_box(out, half, 1.0, position), TRIBO_WORLD, low, high, 0.0, mu);
    systems_accelerate(out, dv);
}

void systems_slope(systems_scene *out, double angle, double mu)
{
    systems_box_on_slope(out, 1.0, 1.0, angle, mu);
}

void systems_wall(systems_scene *out, size_t columns, size_t rows, uint64_t seed)
{
    static const double half[3] = {1.0, 0.5, 0.5};
    problem_random random;
    uint32_t below = 0;
    memset(out, 0, sizeof *out);
    problem_random_start(&random, STREAM + 2, seed, rows);
    for (size_t row = 0; row < rows; row++) {
        const size_t bricks = columns - row % 2;
        const uint32_t first = (uint32_t)out->body_count;
        for (size_t i = 0; i < bricks; i++) {
            const double x = 2.0 * (double)i + (double)(row % 2);
            const double position[3] = {x, 0.0, 0.5 + (double)row};
            const double mass = seed == 0 ? 1.0 : problem_random_decades(&random, -0.15, 0.15);
            const uint32_t brick = systems_add_box(out, half, mass, position);
            for (size_t side = 0; side < 2; side++) {
                const double low[2] = {x - 1.0 + (double)side, -0.5};
                const double high[2] = {x + (double)side, 0.5};
                /* the brick that lies under this half; the ends of odd rows lie in */
                const size_t place = row % 2 == 1 ? i + side : i + side - 1;
                if (row == 0) {
                    add_rectangle(out, brick, TRIBO_WORLD, low, high, 0.0, 0.6);
                } else if (row % 2 == 1 || (i + side > 0 && place < columns - 1)) {
                    add_rectangle(out, brick, below + (uint32_t)place, low, high, (double)row, 0.6);
                }
            }
        }
        below = first;
    }
    fall(out);
}

/* Touching spheres of diameter 1 whose numbers are known. */
static void touch(systems_scene *scene, uint32_t a, uint32_t b, double mu)
{
    double point[3];
    double normal[3];
    if (a == TRIBO_WORLD || b == TRIBO_WORLD) {
        return;
    }
    for (size_t i = 0; i < 3; i++) {
        const double x = scene->bodies[a].position[i];
        const double y = scene->bodies[b].position[i];
        normal[i] = x - y;
        point[i] = (x + y) / 2.0;
    }
    tribo_vec3_normalize(normal, normal);
    systems_add_contact(scene, a, b, point, normal, mu);
}

void systems_rubble(systems_scene *out, size_t layers, uint64_t seed)
{
    problem_random random;
    const double rise = sqrt(0.5);
    uint32_t *below = NULL;
    memset(out, 0, sizeof *out);
    problem_random_start(&random, STREAM + 3, seed, layers);
    for (size_t layer = 0; layer < layers; layer++) {
        const size_t side = layers - layer;
        uint32_t *here = allocate(side * side, sizeof *here);
        for (size_t i = 0; i < side * side; i++) {
            const double shift = (double)layer / 2.0;
            const double position[3] = {shift + (double)(i % side), shift + (double)(i / side),
                                        0.5 + rise * (double)layer};
            const double mu = problem_random_uniform(&random, 0.2, 0.9);
            here[i] = TRIBO_WORLD;
            if (layers > 1 && problem_random_bits(&random) % 20 == 0) {
                continue;
            }
            const double mass = problem_random_decades(&random, -0.5, 0.5);
            const uint32_t ball = systems_add_sphere(out, 0.5, mass, position);
            here[i] = ball;
            for (size_t k = 0; k < 3; k++) {
                out->bodies[ball].velocity[k] = 0.1 * SYSTEMS_FALL * problem_random_normal(&random);
            }
            if (layer == 0) {
                const double point[3] = {position[0], position[1], 0.0};
                systems_add_contact(out, ball, TRIBO_WORLD, point, up, mu);
            }
            for (size_t k = 0; k < 4 && layer > 0; k++) {
                const size_t place = (i / side + k / 2) * (side + 1) + i % side + k % 2;
                touch(out, ball, below[place], mu);
            }
            touch(out, ball, i % side > 0 ? here[i - 1] : TRIBO_WORLD, mu);
            touch(out, ball, i >= side ? here[i - side] : TRIBO_WORLD, mu);
        }
        free(below);
        below = here;
    }
    free(below);
    fall(out);
}

void systems_heap(systems_scene *out, size_t layers, double mu, uint64_t seed)
{
    problem_random random;
    const double rise = sqrt(0.5);
    uint32_t *below = NULL;
    memset(out, 0, sizeof *out);
    problem_random_start(&random, STREAM + 6, seed, layers);
    for (size_t layer = 0; layer < layers; layer++) {
        const size_t side = layers - layer;
        const double shift = (double)layer / 2.0;
        uint32_t *here = allocate(side * side, sizeof *here);
        for (size_t i = 0; i < side * side; i++) {
            const double position[3] = {shift + (double)(i % side), shift + (double)(i / side),
                                        0.5 + rise * (double)layer};
            const double mass = problem_random_decades(&random, -0.5, 0.5);
            here[i] = systems_add_sphere(out, 0.5, mass, position);
            if (layer == 0) {
                const double point[3] = {position[0], position[1], 0.0};
                systems_add_contact(out, here[i], TRIBO_WORLD, point, up, mu);
            }
            for (size_t k = 0; k < 4 && layer > 0; k++) {
                touch(out, here[i], below[(i / side + k / 2) * (side + 1) + i % side + k % 2], mu);
            }
        }
        free(below);
        below = here;
    }
    free(below);
    fall(out);
}

void systems_crowd(systems_scene *out, size_t contacts, uint64_t seed)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    static const double position[3] = {0.0, 0.0, 0.5};
    problem_random random;
    memset(out, 0, sizeof *out);
    problem_random_start(&random, STREAM + 4, seed, contacts);
    const uint32_t box = systems_add_box(out, half, 1.0, position);
    for (size_t i = 0; i < contacts; i++) {
        const double point[3] = {problem_random_uniform(&random, -0.5, 0.5),
                                 problem_random_uniform(&random, -0.5, 0.5), 0.0};
        systems_add_contact(out, box, TRIBO_WORLD, point, up, 0.5);
    }
    for (size_t k = 0; k < 3; k++) {
        out->bodies[0].velocity[k] = 0.3 * problem_random_normal(&random);
        out->bodies[0].angular_velocity[k] = 0.3 * problem_random_normal(&random);
    }
    fall(out);
}

/* ---- thresholds of rest ---------------------------------------------------------------------- */

/* A slender rod or card of 1 m in the plane y = 0. */
static uint32_t add_card(systems_scene *scene, double x, double z, double angle)
{
    static const double half[3] = {0.5, 0.01, 0.01};
    const double position[3] = {x, 0.0, z};
    const uint32_t card = systems_add_box(scene, half, 1.0, position);
    /* turned about -y by the angle: the x axis rises */
    scene->bodies[card].orientation[0] = cos(angle / 2.0);
    scene->bodies[card].orientation[2] = -sin(angle / 2.0);
    return card;
}

void systems_ladder(systems_scene *out, double angle, double mu_floor, double mu_wall)
{
    const double foot[3] = {cos(angle), 0.0, 0.0};
    const double top[3] = {0.0, 0.0, sin(angle)};
    static const double off_wall[3] = {1.0, 0.0, 0.0};
    memset(out, 0, sizeof *out);
    const uint32_t ladder = add_card(out, cos(angle) / 2.0, sin(angle) / 2.0, pi - angle);
    systems_add_contact(out, ladder, TRIBO_WORLD, foot, up, mu_floor);
    systems_add_contact(out, ladder, TRIBO_WORLD, top, off_wall, mu_wall);
    fall(out);
}

void systems_cards(systems_scene *out, double half_angle, double mu)
{
    const double x = sin(half_angle);
    const double z = cos(half_angle);
    const double feet[2][3] = {{-x, 0.0, 0.0}, {x, 0.0, 0.0}};
    const double apex[3] = {0.0, 0.0, z};
    static const double across[3] = {1.0, 0.0, 0.0};
    memset(out, 0, sizeof *out);
    const uint32_t left = add_card(out, -x / 2.0, z / 2.0, pi / 2.0 - half_angle);
    const uint32_t right = add_card(out, x / 2.0, z / 2.0, pi / 2.0 + half_angle);
    systems_add_contact(out, left, TRIBO_WORLD, feet[0], up, mu);
    systems_add_contact(out, right, TRIBO_WORLD, feet[1], up, mu);
    systems_add_contact(out, right, left, apex, across, mu);
    fall(out);
}

void systems_overhang(systems_scene *out, size_t bricks, double share)
{
    static const double half[3] = {0.5, 0.5, 0.05};
    double x = 0.0;
    memset(out, 0, sizeof *out);
    /* from the lowest up: brick k from the top stands 1 / (2 k) over what is below it */
    for (size_t k = bricks; k > 0; k--) {
        const double edge = x + 0.5;
        x += share * 0.5 / (double)k;
        const double z = 0.1 * (double)(bricks - k);
        const double position[3] = {x, 0.0, z + 0.05};
        const double low[2] = {x - 0.5, -0.5};
        const double high[2] = {edge, 0.5};
        const uint32_t brick = systems_add_box(out, half, 1.0, position);
        add_rectangle(out, brick, k == bricks ? TRIBO_WORLD : brick - 1, low, high, z, 0.5);
    }
    fall(out);
}

void systems_arch(systems_scene *out, size_t voussoirs, double thickness, double mu)
{
    const double radii[2] = {1.0 - thickness / 2.0, 1.0 + thickness / 2.0};
    const double step = pi / (double)voussoirs;
    const double cubes = pow(radii[1], 3.0) - pow(radii[0], 3.0);
    const double squares = radii[1] * radii[1] - radii[0] * radii[0];
    /* centroid of a sector of a ring */
    const double centre = 2.0 / 3.0 * sin(step / 2.0) / (step / 2.0) * cubes / squares;
    const double half[3] = {step / 2.0, 0.5, thickness / 2.0};
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < voussoirs; i++) {
        const double middle = step * ((double)i + 0.5);
        const double position[3] = {centre * cos(middle), 0.0, centre * sin(middle)};
        systems_add_box(out, half, squares * step / 2.0, position);
    }
    for (size_t joint = 0; joint <= voussoirs; joint++) {
        const double angle = step * (double)joint;
        const double normal[3] = {-sin(angle), 0.0, cos(angle)};
        for (size_t k = 0; k < 2; k++) {
            const double point[3] = {radii[k] * cos(angle), 0.0, radii[k] * sin(angle)};
            systems_add_contact(out, joint == voussoirs ? TRIBO_WORLD : (uint32_t)joint,
                                joint == 0 ? TRIBO_WORLD : (uint32_t)joint - 1, point, normal, mu);
        }
    }
    fall(out);
}

/* ---- impacts --------------------------------------------------------------------------------- */

void systems_rocking(systems_scene *out, double b, double h, double mu)
{
    const double half[3] = {b, 0.5, h};
    const double position[3] = {0.0, 0.0, h};
    const double feet[2][3] = {{-b, 0.0, 0.0}, {b, 0.0, 0.0}};
    memset(out, 0, sizeof *out);
    const uint32_t block = systems_add_box(out, half, 1.0, position);
    systems_add_contact(out, block, TRIBO_WORLD, feet[0], up, mu);
    systems_add_contact(out, block, TRIBO_WORLD, feet[1], up, mu);
    out->bodies[0].angular_velocity[1] = 1.0;
    out->bodies[0].velocity[0] = h;
    out->bodies[0].velocity[2] = -b;
}

void systems_wheel(systems_scene *out, size_t spokes, double inertia, double mu)
{
    const double half_angle = pi / (double)spokes;
    const double x = sin(half_angle);
    const double z = cos(half_angle);
    const double hub[3] = {0.0, 0.0, z};
    const double feet[2][3] = {{-x, 0.0, 0.0}, {x, 0.0, 0.0}};
    memset(out, 0, sizeof *out);
    const uint32_t wheel = systems_add_sphere(out, sqrt(2.5 * inertia), 1.0, hub);
    systems_add_contact(out, wheel, TRIBO_WORLD, feet[0], up, mu);
    systems_add_contact(out, wheel, TRIBO_WORLD, feet[1], up, mu);
    out->bodies[0].angular_velocity[1] = 1.0;
    out->bodies[0].velocity[0] = z;
    out->bodies[0].velocity[2] = -x;
}

static void ball_at(systems_scene *scene, double x, double y, double mass)
{
    const double position[3] = {x, y, 0.0};
    systems_add_sphere(scene, 0.5, mass, position);
}

/* Contacts of all balls whose distance is 1. */
static void join_balls(systems_scene *scene, double e)
{
    for (uint32_t a = 0; a < scene->body_count; a++) {
        for (uint32_t b = a + 1; b < scene->body_count; b++) {
            double between[3];
            tribo_vec3_subtract(scene->bodies[a].position, scene->bodies[b].position, between);
            if (fabs(tribo_vec3_norm(between) - 1.0) < 1e-9) {
                touch(scene, a, b, 0.0);
                scene->contacts[scene->count - 1].dimension = 1;
                scene->contacts[scene->count - 1].pair.e = e;
            }
        }
    }
}

void systems_cradle(systems_scene *out, size_t balls, const double *masses, double e)
{
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < balls; i++) {
        ball_at(out, (double)i, 0.0, masses != NULL ? masses[i] : 1.0);
    }
    out->bodies[0].velocity[0] = 1.0;
    join_balls(out, e);
}

/* Rows of 1, 2, 3, ... balls, and one that meets the first. */
static void break_rows(systems_scene *out, size_t rows, double e)
{
    const double step = sqrt(0.75);
    memset(out, 0, sizeof *out);
    for (size_t row = 0; row < rows; row++) {
        for (size_t i = 0; i <= row; i++) {
            ball_at(out, step * (double)row, (double)i - (double)row / 2.0, 1.0);
        }
    }
    out->bodies[0].velocity[0] = 1.0;
    join_balls(out, e);
}

void systems_break(systems_scene *out, double e)
{
    break_rows(out, 2, e);
}

void systems_rack(systems_scene *out, double e)
{
    memset(out, 0, sizeof *out);
    break_rows(out, 5, e);
    out->bodies[0].velocity[0] = 0.0;
    free(out->contacts);
    out->contacts = NULL;
    out->count = out->capacity = 0;
    ball_at(out, -1.0, 0.0, 1.0);
    out->bodies[out->body_count - 1].velocity[0] = 1.0;
    join_balls(out, e);
}

/* ---- small random systems -------------------------------------------------------------------- */

static int one_in(problem_random *random, uint64_t n)
{
    return problem_random_bits(random) % n == 0;
}

static void random_body(systems_scene *out, uint32_t draws, problem_random *random)
{
    double half[3];
    double position[3];
    for (size_t k = 0; k < 3; k++) {
        half[k] = problem_random_decades(random, -0.5, 0.5);
        position[k] = 2.0 * problem_random_normal(random);
    }
    if ((draws & SYSTEMS_STATIC) && one_in(random, 6)) {
        systems_add_static(out, position);
        return;
    }
    systems_add_box(out, half, problem_random_decades(random, -1.0, 1.0), position);
    tribo_body *body = &out->bodies[out->body_count - 1];
    problem_random_direction(random, 4, body->orientation);
    for (size_t k = 0; k < 3; k++) {
        body->velocity[k] = problem_random_normal(random);
        body->angular_velocity[k] = problem_random_normal(random);
    }
    if ((draws & SYSTEMS_DEGENERATE) && one_in(random, 8)) {
        /* one that turned all the same would be driven, and give energy */
        memset(body->inverse_inertia, 0, sizeof body->inverse_inertia);
        memset(body->angular_velocity, 0, sizeof body->angular_velocity);
    }
}

static void random_pair(problem_random *random, uint32_t draws, tribo_system_contact *contact)
{
    tribo_material *pair = &contact->pair;
    pair->mu_s = one_in(random, 6) ? 0.0 : problem_random_uniform(random, 0.0, 1.5);
    pair->mu_d = pair->mu_s;
    if ((draws & SYSTEMS_TWO_FRICTION) && one_in(random, 3)) {
        pair->mu_d *= problem_random_uniform(random, 0.3, 1.0);
    }
    if ((draws & SYSTEMS_RESTITUTION) && one_in(random, 2)) {
        pair->e = one_in(random, 3) ? 1.0 : problem_random_uniform(random, 0.0, 1.0);
    }
    if ((draws & SYSTEMS_ONE_ROW) && one_in(random, 4)) {
        contact->dimension = 1;
    }
    for (size_t k = 0; k < 3 && (draws & SYSTEMS_TARGETS); k++) {
        contact->target[k] = one_in(random, 2) ? 0.3 * problem_random_normal(random) : 0.0;
    }
}

static void random_contact(systems_scene *out, uint32_t draws, problem_random *random)
{
    const uint64_t bodies = out->body_count;
    uint32_t a = (uint32_t)(problem_random_bits(random) % bodies);
    uint32_t b = (uint32_t)(problem_random_bits(random) % (bodies + 1));
    double normal[3];
    if (b == bodies || b == a) {
        b = TRIBO_WORLD;
    }
    if (!moves(out, a) && !moves(out, b)) {
        return;
    }
    if (one_in(random, 2)) {
        const uint32_t kept = a;
        a = b;
        b = kept;
    }
    if ((draws & SYSTEMS_DEGENERATE) && out->count > 0 && one_in(random, 5)) {
        const tribo_system_contact again = out->contacts[problem_random_bits(random) % out->count];
        *systems_add_contact(out, a, b, up, up, 0.0) = again;
        return;
    }
    problem_random_direction(random, 3, normal);
    const tribo_body *near = &out->bodies[a == TRIBO_WORLD ? b : a];
    double point[3];
    for (size_t k = 0; k < 3; k++) {
        point[k] = near->position[k] + 0.7 * problem_random_normal(random);
    }
    random_pair(random, draws, systems_add_contact(out, a, b, point, normal, 0.0));
}

void systems_random(systems_scene *out, size_t bodies, size_t contacts, uint32_t draws,
                    uint64_t seed)
{
    problem_random random;
    memset(out, 0, sizeof *out);
    problem_random_start(&random, STREAM + 5, seed, draws);
    const size_t body_count = 1 + (size_t)(problem_random_bits(&random) % bodies);
    const size_t count = 1 + (size_t)(problem_random_bits(&random) % contacts);
    for (size_t i = 0; i < body_count; i++) {
        random_body(out, i == 0 ? draws & ~(uint32_t)SYSTEMS_STATIC : draws, &random);
    }
    for (size_t i = 0; i < count; i++) {
        random_contact(out, draws, &random);
    }
}

void systems_press(systems_scene *out, double speed, double mu)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    static const double centre[3] = {0.0, 0.0, 0.0};
    static const double left[3] = {-0.5, 0.0, 0.0};
    static const double right[3] = {0.5, 0.0, 0.0};
    static const double normals[2][3] = {{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}};
    memset(out, 0, sizeof *out);
    const uint32_t box = systems_add_box(out, half, 1.0, centre);
    systems_add_contact(out, box, TRIBO_WORLD, left, normals[0], mu)->target[0] = speed;
    systems_add_contact(out, box, TRIBO_WORLD, right, normals[1], mu)->target[0] = speed;
}
