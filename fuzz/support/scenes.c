/* Scenes from bytes; see scenes.h. */
#include "scenes.h"

#include <math.h>
#include <string.h>

/* ---- shape and mass -------------------------------------------------------------------------- */

static void make_size(property_trial *t, uint32_t with, const cast *c, made_shape *shape)
{
    static made_shape scaled;
    int exponent = 0;
    frexp(shape->size, &exponent);
    const int spread = (with & SCENES_EXTREME) ? make_exponent(t, -5, 5) : make_exponent(t, -2, 1);
    const int wanted = c->length + spread;
    if (shape->shape.type == TRIBO_SHAPE_HALFSPACE) {
        shape->shape.size[3] = 0.0;
    } else if (shapes_scale(shape, wanted - exponent, &scaled)) {
        shapes_scale(&scaled, 0, shape);
    }
}

/* What is thin spins up without bound, and its flight takes time in proportion. */
static int is_thin(double density, double size, double mass, const double inertia[9])
{
    const double least = fmin(inertia[0], fmin(inertia[4], inertia[8]));
    return least < 0x1p-10 * fmax(inertia[0], fmax(inertia[4], inertia[8])) ||
           mass < 0x1p-12 * density * size * size * size;
}

/* A ball's, where the shape has none or is thin. */
static void set_mass(double density, const made_shape *from, tribo_scene_body *body)
{
    const tribo_shape *solid = from->shape.type == TRIBO_SHAPE_CONVEX ? &from->base : &from->shape;
    double mass = 0.0;
    double center[3] = {0.0, 0.0, 0.0};
    double inertia[9];
    if (tribo_shape_mass(solid, density, &mass, center, inertia) != TRIBO_OK ||
        is_thin(density, from->size, mass, inertia) ||
        tribo_body_set_mass(&body->state, mass, inertia) != TRIBO_OK) {
        tribo_mass_sphere(density, from->size, &mass, inertia);
        tribo_body_set_mass(&body->state, mass, inertia);
        return;
    }
    tribo_vec3_scale(-1.0, center, body->offset.position);
}

static void lock_axis(property_trial *t, tribo_body *body)
{
    static const int diagonal[3] = {0, 3, 5};
    const int axis = (int)make_choice(t, NULL, 3);
    double *j = body->inverse_inertia;
    j[1] = j[2] = j[4] = 0.0;
    j[diagonal[axis]] = 0.0;
    if (make_byte(t) % 2 == 1) {
        j[0] = j[3] = j[5] = 0.0;
    }
}

/* ---- a body ---------------------------------------------------------------------------------- */

static uint32_t make_kind(property_trial *t, uint32_t with, uint32_t type)
{
    const uint32_t choice = make_choice(t, NULL, 8);
    const int is_fixed = type == TRIBO_SHAPE_HALFSPACE || type == TRIBO_SHAPE_MESH;
    if (!is_fixed && (choice < 6 || !(with & SCENES_GROUND))) {
        return TRIBO_BODY_DYNAMIC;
    }
    return choice % 2 == 0 ? TRIBO_BODY_STATIC : TRIBO_BODY_KINEMATIC;
}

/* Near a body that is there: apart, touching or inside. */
static void make_place(property_trial *t, const cast *c, uint32_t i, tribo_scene_body *body)
{
    double away[3];
    double *x = body->state.position;
    if (i == 0) {
        return;
    }
    const uint32_t other = make_choice(t, NULL, i);
    const double reach = c->shapes[i].size + c->shapes[other].size;
    make_normal(t, NULL, away);
    if (c->shapes[other].shape.type == TRIBO_SHAPE_HALFSPACE) {
        tribo_quat_rotate(c->bodies[other].state.orientation, c->shapes[other].shape.size, away);
    }
    tribo_vec3_add_scaled(c->bodies[other].state.position, 1.25 * make_unit(t, NULL) * reach, away,
                          x);
}

static void make_motion(property_trial *t, uint32_t with, const cast *c, uint32_t i,
                        tribo_scene_body *body)
{
    const double size = c->shapes[i].size > 0.0 ? c->shapes[i].size : 1.0;
    const double fast = ldexp(1.0, make_exponent(t, -4, 4));
    const int moves = body->kind == TRIBO_BODY_DYNAMIC ||
                      (body->kind == TRIBO_BODY_KINEMATIC && (with & SCENES_DRIVEN));
    const double *j = body->state.inverse_inertia;
    const int turns = moves && ((with & SCENES_DRIVEN) || (j[0] > 0.0 && j[3] > 0.0 && j[5] > 0.0));
    double belt[3];
    make_directions(t, NULL, body->state.velocity, 3);
    make_directions(t, NULL, body->state.angular_velocity, 3);
    make_directions(t, NULL, belt, 3);
    tribo_vec3_scale(moves ? fast * size : 0.0, body->state.velocity, body->state.velocity);
    /* What turns about a locked axis is a motor. */
    tribo_vec3_scale(turns ? 2.0 * fast : 0.0, body->state.angular_velocity,
                     body->state.angular_velocity);
    if ((with & SCENES_DRIVEN) && make_byte(t) % 4 == 1) {
        tribo_vec3_scale(fast * size, belt, body->belt);
    }
}

static void make_forces(property_trial *t, cast *c, uint32_t i)
{
    const double inverse_mass = c->bodies[i].state.inverse_mass;
    if (inverse_mass > 0.0) {
        make_directions(t, NULL, c->forces[i], 3);
        make_directions(t, NULL, c->torques[i], 3);
        tribo_vec3_scale(10.0 * c->shapes[i].size / inverse_mass, c->forces[i], c->forces[i]);
        tribo_vec3_scale(c->shapes[i].size * c->shapes[i].size / inverse_mass, c->torques[i],
                         c->torques[i]);
    }
}

static void note_kind(property_trial *t, const tribo_scene_body *body)
{
    if (t->log != NULL) {
        static const char *const names[3] = {"dynamic", "kinematic", "static"};
        fprintf(t->log, "#   %s\n", names[body->kind]);
        property_note(t, "  position", body->state.position, 3);
        property_note(t, "  orientation", body->state.orientation, 4);
        property_note(t, "  velocity", body->state.velocity, 3);
        property_note(t, "  angular_velocity", body->state.angular_velocity, 3);
        property_note(t, "  inverse_mass", &body->state.inverse_mass, 1);
        property_note(t, "  inverse_inertia", body->state.inverse_inertia, 6);
        property_note(t, "  offset", body->offset.position, 3);
        property_note(t, "  offset turned", body->offset.orientation, 4);
        property_note(t, "  mu_s", &body->material.mu_s, 1);
        property_note(t, "  mu_d", &body->material.mu_d, 1);
        property_note(t, "  e", &body->material.e, 1);
        property_note(t, "  belt", body->belt, 3);
        property_note(t, "  rolling", &body->rolling, 1);
        property_note(t, "  spinning", &body->spinning, 1);
    }
}

static void make_member(property_trial *t, uint32_t with, cast *c, uint32_t i)
{
    const uint32_t kinds =
        (with & SCENES_GROUND) ? SHAPES_ALL : SHAPES_CONVEX | SHAPES_KIND(TRIBO_SHAPE_COMPOUND);
    tribo_scene_body *body = &c->bodies[i];
    made_shape *shape = &c->shapes[i];
    tribo_scene_body_init(body);
    make_shape(t, "shape", kinds, shape);
    make_size(t, with, c, shape);
    body->shape = shape->shape;
    body->kind = make_kind(t, with, shape->shape.type);
    make_quat(t, NULL, body->state.orientation);
    make_material(t, NULL, &body->material);
    body->material.mu_s = (with & SCENES_FRICTION) ? body->material.mu_s : 0.0;
    body->material.mu_d = (with & SCENES_FRICTION) ? body->material.mu_d : 0.0;
    body->material.e = (with & SCENES_RESTITUTION) ? body->material.e : 0.0;
    const int heavy = c->density + ((with & SCENES_EXTREME) ? make_exponent(t, -10, 10)
                                                            : make_exponent(t, -3, 3));
    const uint32_t special = make_choice(t, NULL, 16);
    if (body->kind == TRIBO_BODY_DYNAMIC) {
        set_mass(ldexp(1.0, heavy), shape, body);
        if (special == 1 && (with & SCENES_GROUND)) {
            lock_axis(t, &body->state);
        }
    }
    if (special == 2) {
        make_pose(t, NULL, -4, 0, &body->offset);
        tribo_vec3_scale(shape->size, body->offset.position, body->offset.position);
    }
    if ((with & SCENES_FRICTION) && special % 8 == 3) {
        body->rolling = 0.25 * make_unit(t, NULL) * shape->size;
        body->spinning = special == 3 ? 0.25 * make_unit(t, NULL) * shape->size : 0.0;
    }
    make_place(t, c, i, body);
    make_motion(t, with, c, i, body);
    if (with & SCENES_FORCES) {
        make_forces(t, c, i);
    }
    note_kind(t, body);
}

/* ---- a cast ---------------------------------------------------------------------------------- */

void make_cast(property_trial *t, uint32_t with, cast *out)
{
    memset(out, 0, sizeof *out);
    out->settings.struct_size = sizeof out->settings;
    out->settings.friction_rule = make_choice(t, "friction_rule", 5);
    out->settings.restitution_rule = make_choice(t, "restitution_rule", 5);
    out->count = 1 + make_choice(t, "bodies", SCENES_BODIES);
    out->length = (with & SCENES_EXTREME) ? make_exponent(t, -20, 20) : 0;
    out->density = (with & SCENES_EXTREME) ? make_exponent(t, -20, 20) : 0;
    property_expand(t);
    if (with & SCENES_GRAVITY) {
        make_directions(t, "gravity", out->settings.gravity, 3);
        tribo_vec3_scale(ldexp(10.0, out->length), out->settings.gravity, out->settings.gravity);
    }
    for (uint32_t i = 0; i < out->count; i++) {
        make_member(t, with, out, i);
    }
}

static void scale(double *x, size_t count, int exponent)
{
    for (size_t i = 0; i < count; i++) {
        x[i] = ldexp(x[i], exponent);
    }
}

int scenes_scale(const cast *from, int length, int mass, int time, cast *out)
{
    int fits = 1;
    memcpy(out, from, sizeof *out);
    scale(out->settings.gravity, 3, length - 2 * time);
    for (uint32_t i = 0; i < out->count; i++) {
        tribo_scene_body *body = &out->bodies[i];
        fits = shapes_scale(&from->shapes[i], length, &out->shapes[i]) && fits;
        body->shape = out->shapes[i].shape;
        scale(body->state.position, 3, length);
        scale(body->state.velocity, 3, length - time);
        scale(body->state.angular_velocity, 3, -time);
        scale(&body->state.inverse_mass, 1, -mass);
        scale(body->state.inverse_inertia, 6, -mass - 2 * length);
        scale(body->offset.position, 3, length);
        scale(body->belt, 3, length - time);
        scale(&body->rolling, 1, length);
        scale(&body->spinning, 1, length);
        scale(out->forces[i], 3, mass + length - 2 * time);
        scale(out->torques[i], 3, mass + 2 * length - 2 * time);
    }
    return fits;
}

tribo_scene *scenes_build(const cast *from)
{
    tribo_scene *world = NULL;
    tribo_status status = tribo_scene_create(&from->settings, NULL, &world);
    for (uint32_t i = 0; status == TRIBO_OK && i < from->count; i++) {
        uint32_t id = 0;
        status = tribo_scene_add(world, &from->bodies[i], &id);
        if (status == TRIBO_OK && from->bodies[i].kind == TRIBO_BODY_DYNAMIC) {
            status = tribo_scene_set_force(world, id, from->forces[i], from->torques[i]);
        }
    }
    if (status != TRIBO_OK) {
        tribo_scene_destroy(world);
        return NULL;
    }
    return world;
}
