#include "poured.h"

#include "problems.h"

#include <tribo/scene.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STREAM = 950, PLANES = 5 };

static const double spacing = 1.08;
static const double step = 1.0 / 120.0;
static const double gravity = 9.81;
static const double friction = 0.5;

static void demand(tribo_status status)
{
    if (status != TRIBO_OK) {
        abort();
    }
}

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count + 1, size);
    if (memory == NULL) {
        abort();
    }
    return memory;
}

/* ---- the scene ------------------------------------------------------------------------------- */

static void add(tribo_scene *scene, tribo_scene_body *body)
{
    uint32_t id;
    body->material.mu_s = body->material.mu_d = friction;
    demand(tribo_scene_add(scene, body, &id));
}

static void add_box(tribo_scene *scene, double width)
{
    const double planes[PLANES][4] = {
        {0, 0, 1, 0}, {1, 0, 0, 0}, {-1, 0, 0, -width}, {0, 1, 0, 0}, {0, -1, 0, -width}};
    for (size_t i = 0; i < PLANES; i++) {
        tribo_scene_body body;
        demand(tribo_scene_body_init(&body));
        body.kind = TRIBO_BODY_STATIC;
        body.shape.type = TRIBO_SHAPE_HALFSPACE;
        memcpy(body.shape.size, planes[i], sizeof planes[i]);
        add(scene, &body);
    }
}

static void add_sphere(tribo_scene *scene, const double place[3], problem_random *random)
{
    tribo_scene_body body;
    demand(tribo_scene_body_init(&body));
    const double radius = problem_random_uniform(random, 0.35, 0.5);
    const double mass = 1000.0 * radius * radius * radius;
    body.shape.type = TRIBO_SHAPE_SPHERE;
    body.shape.size[0] = radius;
    body.state.inverse_mass = 1.0 / mass;
    for (size_t i = 0; i < 6; i++) {
        body.state.inverse_inertia[i] =
            i == 0 || i == 3 || i == 5 ? 2.5 / (mass * radius * radius) : 0.0;
    }
    for (size_t k = 0; k < 3; k++) {
        body.state.position[k] =
            spacing * (place[k] + 0.5) + problem_random_uniform(random, -0.03, 0.03);
        body.state.velocity[k] = k < 2 ? 0.3 * problem_random_normal(random) : 0.0;
    }
    add(scene, &body);
}

static tribo_scene *fill(size_t spheres, size_t side, uint64_t seed)
{
    tribo_scene_settings settings = {.struct_size = sizeof settings};
    tribo_scene *scene = NULL;
    problem_random random;
    settings.gravity[2] = -gravity;
    problem_random_start(&random, STREAM, seed, spheres);
    demand(tribo_scene_create(&settings, NULL, &scene));
    add_box(scene, spacing * (double)side);
    for (size_t i = 0; i < spheres; i++) {
        const double place[3] = {(double)(i % side), (double)(i / side % side),
                                 (double)(i / side / side)};
        add_sphere(scene, place, &random);
    }
    return scene;
}

/* ---- its next step --------------------------------------------------------------------------- */

static void read_bodies(const tribo_scene *scene, systems_scene *out)
{
    uint32_t end = 0;
    demand(tribo_scene_counts(scene, NULL, &end));
    const double dv[3] = {0.0, 0.0, -gravity * step};
    out->bodies = allocate(end, sizeof *out->bodies);
    out->body_count = out->body_capacity = end;
    for (uint32_t i = 0; i < end; i++) {
        demand(tribo_scene_get_body(scene, i, &out->bodies[i], NULL));
    }
    systems_accelerate(out, dv);
}

static void read_contacts(const tribo_scene *scene, systems_scene *out)
{
    size_t count = 0;
    (void)tribo_scene_contacts(scene, 0, NULL, &count);
    tribo_scene_contact *from = allocate(count, sizeof *from);
    demand(tribo_scene_contacts(scene, count, from, &count));
    out->contacts = allocate(count, sizeof *out->contacts);
    out->count = out->capacity = count;
    for (size_t i = 0; i < count; i++) {
        tribo_system_contact *to = &out->contacts[i];
        to->a = from[i].a;
        to->b = from[i].b;
        to->dimension = 3;
        memcpy(to->contact.normal, from[i].normal, sizeof from[i].normal);
        memcpy(to->contact.arm_a, from[i].arm_a, sizeof from[i].arm_a);
        memcpy(to->contact.arm_b, from[i].arm_b, sizeof from[i].arm_b);
        to->pair.mu_s = to->pair.mu_d = friction;
        to->target[0] = from[i].distance > 0.0 ? -from[i].distance / step : 0.0;
    }
    free(from);
}

void poured(systems_scene *out, size_t spheres, uint32_t moment, uint64_t seed)
{
    /* what a pile is like does not hang on how well it was solved */
    const tribo_step_options options = {.struct_size = sizeof options,
                                        .solver = TRIBO_SOLVER_GAUSS_SEIDEL,
                                        .skip = TRIBO_SKIP_RESTITUTION,
                                        .max_iterations = 40,
                                        .tolerance = 1e-4};
    const size_t side = (size_t)ceil(cbrt((double)spheres) - 1e-9);
    const double steps = (moment == POURED_FALLING ? 32.0 : 128.0) * sqrt((double)side);
    tribo_scene *scene = fill(spheres, side, seed);
    for (size_t i = 0; i < (size_t)steps; i++) {
        demand(tribo_scene_step(scene, step, &options, NULL));
    }
    memset(out, 0, sizeof *out);
    read_bodies(scene, out);
    read_contacts(scene, out);
    tribo_scene_destroy(scene);
}
