/* Test vectors for all bindings: inputs by rule, outputs exact. Writes vectors.json to standard
 * output.
 *
 * A set is drawn from its seed by splitmix64 (Steele, Lea & Flood, OOPSLA 2014):
 *
 *   state += 0x9e3779b97f4a7c15; z = state; z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
 *   z = (z ^ z >> 27) * 0x94d049bb133111eb; z ^= z >> 31
 *
 * unit() = (z >> 11) 2^-53 in [0, 1), side() = 2 unit() - 1. Draws are made in the order in which
 * they stand below. The hash of a set is FNV-1a (64 bits) over its outputs: 64-bit words, byte by
 * byte from the least, a double as its bits, an integer as itself, a status as its number; after a
 * status other than TRIBO_OK the case has no more outputs. "first" has the words of case 0. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tribo/collide.h>
#include <tribo/scene.h>
#include <tribo/tribo.h>

/* ---- rule and hash --------------------------------------------------------------------------- */

enum { SHOWN = 16 };

typedef struct set {
    const char *name;
    uint64_t seed;
    uint32_t count;
    uint64_t state;
    uint64_t hash;
    uint32_t words; /* of case 0 */
    uint64_t first[SHOWN];
    uint32_t is_first;
} set;

static double unit(set *s)
{
    s->state += 0x9e3779b97f4a7c15u;
    uint64_t z = s->state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

static double side(set *s)
{
    return 2.0 * unit(s) - 1.0;
}

static void sides(set *s, int count, double *out)
{
    for (int i = 0; i < count; i++) {
        out[i] = side(s);
    }
}

static void put(set *s, uint64_t word)
{
    for (int i = 0; i < 8; i++) {
        s->hash = (s->hash ^ (word >> (8 * i) & 0xff)) * 0x100000001b3u;
    }
    if (s->is_first != 0 && s->words < SHOWN) {
        s->first[s->words++] = word;
    }
}

static void put_numbers(set *s, int count, const double *numbers)
{
    for (int i = 0; i < count; i++) {
        uint64_t word;
        memcpy(&word, &numbers[i], sizeof word);
        put(s, word);
    }
}

/* 1 if the case goes on. */
static int put_status(set *s, tribo_status status)
{
    put(s, (uint64_t)status);
    return status == TRIBO_OK;
}

/* ---- one contact ----------------------------------------------------------------------------- */

/* w = (2 + side, side / 2, side / 2, 2 + side, side / 2, 2 + side). */
static void draw_matrix(set *s, double w[6])
{
    for (int i = 0; i < 6; i++) {
        const int is_diagonal = i == 0 || i == 3 || i == 5;
        w[i] = is_diagonal ? 2.0 + side(s) : 0.5 * side(s);
    }
}

/* mu_s = 2 unit, mu_d = unit mu_s, e = unit. */
static tribo_material draw_pair(set *s)
{
    tribo_material pair = {0};
    pair.mu_s = 2.0 * unit(s);
    pair.mu_d = unit(s) * pair.mu_s;
    pair.e = unit(s);
    return pair;
}

/* Matrix, b (3 sides), pair; tribo_contact_solve. Outputs: status, p, mode. */
static void do_solve(set *s, uint32_t i)
{
    double w[6];
    double b[3];
    double p[3];
    tribo_solve_info info = {.struct_size = sizeof info};
    (void)i;
    draw_matrix(s, w);
    sides(s, 3, b);
    const tribo_material pair = draw_pair(s);
    if (put_status(s, tribo_contact_solve(w, b, pair.mu_s, pair.mu_d, p, &info))) {
        put_numbers(s, 3, p);
        put(s, info.mode);
    }
}

/* Matrix, u (3 sides), pair; tribo_impact by law i % 8. Outputs: status, p, mode, energy. */
static void do_impact(set *s, uint32_t i)
{
    const tribo_impact_options options = {.struct_size = sizeof options, .law = i % 8};
    tribo_impact_info info = {.struct_size = sizeof info};
    double w[6];
    double u[3];
    double p[3];
    draw_matrix(s, w);
    sides(s, 3, u);
    const tribo_material pair = draw_pair(s);
    if (put_status(s, tribo_impact(w, u, &pair, &options, p, &info))) {
        put_numbers(s, 3, p);
        put(s, info.mode);
        put_numbers(s, 1, &info.energy);
    }
}

/* Box of half-extents 1/2 + unit, density 1000, at 3 sides, turned by the rotation vector of 3
 * sides, with velocity and angular velocity of 3 sides each. */
static tribo_body draw_box(set *s)
{
    tribo_body body;
    double half[3];
    double mass;
    double inertia[9];
    double turn[3];
    tribo_body_init(&body);
    for (int k = 0; k < 3; k++) {
        half[k] = 0.5 + unit(s);
    }
    tribo_mass_box(1000.0, half, &mass, inertia);
    tribo_body_set_mass(&body, mass, inertia);
    sides(s, 3, body.position);
    sides(s, 3, turn);
    tribo_quat_from_rotation_vector(turn, body.orientation);
    sides(s, 3, body.velocity);
    sides(s, 3, body.angular_velocity);
    return body;
}

/* Two boxes, a point of 3 sides, the normal along 3 sides, pair; tribo_collide by default options.
 * Outputs: status, velocities and angular velocities of A and B, impulse, energy. */
static void do_collide(set *s, uint32_t i)
{
    tribo_collision_info info = {.struct_size = sizeof info};
    tribo_body a = draw_box(s);
    tribo_body b = draw_box(s);
    double point[3];
    double normal[3];
    (void)i;
    sides(s, 3, point);
    sides(s, 3, normal);
    tribo_vec3_normalize(normal, normal);
    const tribo_material pair = draw_pair(s);
    if (put_status(s, tribo_collide(&a, &b, point, normal, &pair, NULL, &info))) {
        put_numbers(s, 3, a.velocity);
        put_numbers(s, 3, a.angular_velocity);
        put_numbers(s, 3, b.velocity);
        put_numbers(s, 3, b.angular_velocity);
        put_numbers(s, 3, info.impulse);
        put_numbers(s, 1, &info.energy);
    }
}

/* ---- batches --------------------------------------------------------------------------------- */

enum { BATCH = 100 };

/* BATCH times what do_solve draws, in one call. Outputs: status, all p, all modes. */
static void do_batch_solve(set *s, uint32_t i)
{
    static double w[6 * BATCH];
    static double b[3 * BATCH];
    static double mu[2 * BATCH];
    static double p[3 * BATCH];
    static uint32_t modes[BATCH];
    (void)i;
    for (size_t k = 0; k < BATCH; k++) {
        draw_matrix(s, w + 6 * k);
        sides(s, 3, b + 3 * k);
        const tribo_material pair = draw_pair(s);
        mu[2 * k] = pair.mu_s;
        mu[2 * k + 1] = pair.mu_d;
    }
    if (put_status(s, tribo_batch_solve(TRIBO_ISA_BEST, BATCH, w, b, mu, p, modes, NULL))) {
        put_numbers(s, 3 * BATCH, p);
        for (size_t k = 0; k < BATCH; k++) {
            put(s, modes[k]);
        }
    }
}

/* BATCH times what do_impact draws, in one call, law ALGEBRAIC. Outputs as do_batch_solve. */
static void do_batch_impact(set *s, uint32_t i)
{
    static double w[6 * BATCH];
    static double u[3 * BATCH];
    static double p[3 * BATCH];
    static tribo_material pairs[BATCH];
    static uint32_t modes[BATCH];
    (void)i;
    for (size_t k = 0; k < BATCH; k++) {
        draw_matrix(s, w + 6 * k);
        sides(s, 3, u + 3 * k);
        pairs[k] = draw_pair(s);
    }
    if (put_status(s, tribo_batch_impact(TRIBO_ISA_BEST, BATCH, w, u, pairs, p, modes, NULL))) {
        put_numbers(s, 3 * BATCH, p);
        for (size_t k = 0; k < BATCH; k++) {
            put(s, modes[k]);
        }
    }
}

/* ---- shapes ---------------------------------------------------------------------------------- */

/* Type (i + 1): 1 sphere to 6 ellipsoid, all three sizes 1/4 + unit / 2 whatever the type needs; at
 * a pose of 3 sides, halved, turned by the rotation vector of 3 sides. */
static void draw_shape(set *s, uint32_t i, tribo_shape *shape, tribo_pose *pose)
{
    double turn[3];
    memset(shape, 0, sizeof *shape);
    shape->type = i + 1;
    for (int k = 0; k < 3; k++) {
        shape->size[k] = 0.25 + 0.5 * unit(s);
    }
    sides(s, 3, pose->position);
    for (int k = 0; k < 3; k++) {
        pose->position[k] *= 0.5;
    }
    sides(s, 3, turn);
    tribo_quat_from_rotation_vector(turn, pose->orientation);
}

/* Shapes i % 6 and i / 6 % 6; margin 1/64. Outputs: status, number of manifolds, and of the one
 * there may be: number of points, normal, of each point its arms, distance and id. */
static void do_manifold(set *s, uint32_t i)
{
    const tribo_collide_options options = {.struct_size = sizeof options, .margin = 0.015625};
    tribo_shape shapes[2];
    tribo_pose poses[2];
    tribo_manifold m;
    uint32_t count = 0;
    draw_shape(s, i % 6, &shapes[0], &poses[0]);
    draw_shape(s, i / 6 % 6, &shapes[1], &poses[1]);
    const tribo_status status = tribo_collide_shapes(&shapes[0], &poses[0], &shapes[1], &poses[1],
                                                     &options, 1, &m, &count, NULL);
    if (!put_status(s, status)) {
        return;
    }
    put(s, count);
    if (count == 0) {
        return;
    }
    put(s, m.count);
    put_numbers(s, 3, m.normal);
    for (uint32_t k = 0; k < m.count; k++) {
        put_numbers(s, 3, m.points[k].arm_a);
        put_numbers(s, 3, m.points[k].arm_b);
        put_numbers(s, 1, &m.points[k].distance);
        put(s, m.points[k].id);
    }
}

/* ---- systems --------------------------------------------------------------------------------- */

enum { TOWER = 5, CORNERS = 4 };

/* A tower of unit boxes, the lowest on the world: box k at height k + 1/2, density 1000, velocity
 * (side / 8, side / 8, -1/64), angular velocity of 3 sides / 8. Contacts from below, corners (-,-),
 * (+,-), (-,+), (+,+) of each: A the upper box. mu_s = mu_d = 1/2, e = 0. Solver 1 + i % 2,
 * tolerance 2^-30. Outputs: status, impulses, velocities. */
static void do_system(set *s, uint32_t i)
{
    static const double half[3] = {0.5, 0.5, 0.5};
    const tribo_system_options options = {
        .struct_size = sizeof options, .solver = 1 + i % 2, .tolerance = 0x1p-30};
    tribo_system_contact contacts[TOWER * CORNERS] = {0};
    tribo_body bodies[TOWER];
    double impulses[3 * TOWER * CORNERS];
    double velocities[6 * TOWER];
    double mass;
    double inertia[9];
    size_t size = 0;
    tribo_mass_box(1000.0, half, &mass, inertia);
    for (uint32_t k = 0; k < TOWER; k++) {
        tribo_body_init(&bodies[k]);
        tribo_body_set_mass(&bodies[k], mass, inertia);
        bodies[k].position[2] = k + 0.5;
        bodies[k].velocity[0] = 0.125 * side(s);
        bodies[k].velocity[1] = 0.125 * side(s);
        bodies[k].velocity[2] = -0.015625;
        for (int j = 0; j < 3; j++) {
            bodies[k].angular_velocity[j] = 0.125 * side(s);
        }
        for (uint32_t j = 0; j < CORNERS; j++) {
            tribo_system_contact *c = &contacts[CORNERS * k + j];
            c->a = k;
            c->b = k > 0 ? k - 1 : TRIBO_WORLD;
            c->dimension = 3;
            c->contact.normal[2] = 1.0;
            c->contact.arm_a[0] = c->contact.arm_b[0] = j % 2 == 0 ? -0.5 : 0.5;
            c->contact.arm_a[1] = c->contact.arm_b[1] = j / 2 == 0 ? -0.5 : 0.5;
            c->contact.arm_a[2] = -0.5;
            c->contact.arm_b[2] = 0.5;
            c->pair.mu_s = c->pair.mu_d = 0.5;
        }
    }
    tribo_system_workspace_size(TOWER, TOWER * CORNERS, contacts, &options, &size);
    void *workspace = malloc(size);
    if (workspace == NULL) {
        exit(1);
    }
    const tribo_status status =
        tribo_system_solve(TOWER, bodies, TOWER * CORNERS, contacts, &options, workspace, size,
                           impulses, velocities, NULL);
    free(workspace);
    if (put_status(s, status)) {
        put_numbers(s, 3 * TOWER * CORNERS, impulses);
        put_numbers(s, 6 * TOWER, velocities);
    }
}

/* ---- a scene --------------------------------------------------------------------------------- */

enum { BODIES = 10, STEPS = 1000 };

static uint32_t add(tribo_scene *scene, const tribo_scene_body *body)
{
    uint32_t id = 0;
    if (tribo_scene_add(scene, body, &id) != TRIBO_OK) {
        exit(1);
    }
    return id;
}

/* Gravity (0, 0, -9.8125). A static half-space z <= 0, mu_s = mu_d = 1/2, e = 1/4; then BODIES
 * dynamic ones of density 1000 and the same material: body k of type 1 + k % 4 (sphere, box,
 * capsule, cylinder) with all sizes 1/4, at (side, side, 1 + k), velocity of 3 sides, angular
 * velocity of 3 sides. STEPS steps of 1/256 s, default options. Outputs after every 100 steps:
 * status, then position, orientation, velocity and angular velocity of each body. */
static void do_scene(set *s, uint32_t i)
{
    const tribo_scene_settings settings = {.struct_size = sizeof settings,
                                           .gravity = {0.0, 0.0, -9.8125}};
    tribo_scene *scene = NULL;
    tribo_scene_body floor;
    (void)i;
    if (tribo_scene_create(&settings, NULL, &scene) != TRIBO_OK) {
        exit(1);
    }
    tribo_scene_body_init(&floor);
    floor.kind = TRIBO_BODY_STATIC;
    floor.shape.type = TRIBO_SHAPE_HALFSPACE;
    floor.shape.size[2] = 1.0;
    floor.material.mu_s = floor.material.mu_d = 0.5;
    floor.material.e = 0.25;
    add(scene, &floor);
    for (uint32_t k = 0; k < BODIES; k++) {
        tribo_scene_body body;
        double mass;
        double center[3];
        double inertia[9];
        tribo_scene_body_init(&body);
        body.material = floor.material;
        body.shape.type = 1 + k % 4;
        body.shape.size[0] = body.shape.size[1] = body.shape.size[2] = 0.25;
        tribo_shape_mass(&body.shape, 1000.0, &mass, center, inertia);
        tribo_body_set_mass(&body.state, mass, inertia);
        body.state.position[0] = side(s);
        body.state.position[1] = side(s);
        body.state.position[2] = 1.0 + k;
        sides(s, 3, body.state.velocity);
        sides(s, 3, body.state.angular_velocity);
        add(scene, &body);
    }
    for (uint32_t step = 1; step <= STEPS; step++) {
        const tribo_status status = tribo_scene_step(scene, 0.00390625, NULL, NULL);
        for (uint32_t k = 1; step % 100 == 0 && k <= BODIES; k++) {
            tribo_body body;
            tribo_scene_get_body(scene, k, &body, NULL);
            put_status(s, status);
            put_numbers(s, 3, body.position);
            put_numbers(s, 4, body.orientation);
            put_numbers(s, 3, body.velocity);
            put_numbers(s, 3, body.angular_velocity);
        }
    }
    tribo_scene_destroy(scene);
}

/* ---- output ---------------------------------------------------------------------------------- */

static void print_set(const char *name, uint64_t seed, uint32_t count,
                      void (*run)(set *s, uint32_t i), const char *end)
{
    set s = {.name = name, .seed = seed, .count = count, .state = seed};
    s.hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < count; i++) {
        s.is_first = i == 0;
        run(&s, i);
    }
    printf("  {\"name\": \"%s\", \"seed\": %" PRIu64 ", \"count\": %" PRIu32
           ", \"hash\": \"%016" PRIx64 "\",\n   \"first\": [",
           name, seed, count, s.hash);
    for (uint32_t k = 0; k < s.words; k++) {
        printf("%s\"%016" PRIx64 "\"", k == 0 ? "" : k % 4 == 0 ? ",\n    " : ", ", s.first[k]);
    }
    printf("]}%s\n", end);
}

static void print_statuses(void)
{
    const char *between = "";
    for (tribo_status status = 0; status < 1000; status++) {
        const char *name = tribo_status_name(status);
        if (strcmp(name, "TRIBO_ERROR_UNKNOWN") != 0) {
            printf("%s  {\"value\": %d, \"name\": \"%s\", \"text\": \"%s\"}", between, (int)status,
                   name, tribo_status_string(status));
            between = ",\n";
        }
    }
}

int main(void)
{
    printf("{\"version\": \"%s\",\n \"statuses\": [\n", tribo_version_string());
    print_statuses();
    printf("\n ],\n \"sets\": [\n");
    print_set("solve", 1, 1000, do_solve, ",");
    print_set("impact", 2, 1000, do_impact, ",");
    print_set("collide", 3, 500, do_collide, ",");
    print_set("batch_solve", 4, 10, do_batch_solve, ",");
    print_set("batch_impact", 5, 10, do_batch_impact, ",");
    print_set("manifold", 6, 720, do_manifold, ",");
    print_set("system", 7, 20, do_system, ",");
    print_set("scene", 8, 1, do_scene, "");
    printf(" ]}\n");
    return 0;
}
