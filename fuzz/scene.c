/* Properties of include/tribo/scene.h: no NaN, momentum and energy, saved states to the bit, and
 * whatever is wrong. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <tribo/scene.h>

#include "support/make.h"

enum { BODIES = 6, STEPS = 12, POINTS = 512 };

static const double origin[3] = {0.0, 0.0, 0.0};

/* ---- scenes from bytes ----------------------------------------------------------------------- */

/* What a scene may have. */
enum { FLOOR = 1, FRICTION = 2, RESTITUTION = 4, GRAVITY = 8, PUSHED = 16 };

static void make_shape_of(property_trial *t, tribo_scene_body *out)
{
    static const uint32_t types[4] = {TRIBO_SHAPE_SPHERE, TRIBO_SHAPE_BOX, TRIBO_SHAPE_CAPSULE,
                                      TRIBO_SHAPE_CYLINDER};
    const double density = 1.0 + 9.0 * make_unit(t, "density");
    double mass = 0.0;
    double center[3];
    double inertia[9];
    out->shape.type = types[make_choice(t, "type", 4)];
    for (int k = 0; k < 3; k++) {
        out->shape.size[k] = 0.125 + make_unit(t, "size");
    }
    tribo_shape_mass(&out->shape, density, &mass, center, inertia);
    tribo_body_set_mass(&out->state, mass, inertia);
}

static void make_scene_body(property_trial *t, uint32_t with, int place, tribo_scene_body *out)
{
    tribo_scene_body_init(out);
    make_shape_of(t, out);
    make_quat(t, "orientation", out->state.orientation);
    for (int k = 0; k < 3; k++) {
        out->state.position[k] = 1.5 * make_signed(t, "position");
        out->state.velocity[k] = 4.0 * make_signed(t, "velocity");
        out->state.angular_velocity[k] = 8.0 * make_signed(t, "angular_velocity");
    }
    out->state.position[2] += 3.0 + 1.5 * place;
    out->material.mu_s = (with & FRICTION) ? 2.0 * make_unit(t, "mu") : 0.0;
    out->material.mu_d = out->material.mu_s;
    out->material.e = (with & RESTITUTION) ? make_unit(t, "e") : 0.0;
}

static tribo_status fill(property_trial *t, uint32_t with, tribo_scene *world)
{
    const uint32_t count = 1 + make_choice(t, "bodies", BODIES);
    tribo_scene_body body;
    uint32_t id = 0;
    tribo_scene_body_init(&body);
    body.kind = TRIBO_BODY_STATIC;
    body.shape.type = TRIBO_SHAPE_HALFSPACE;
    body.shape.size[2] = 1.0;
    body.material.mu_s = body.material.mu_d = (with & FRICTION) ? 0.5 : 0.0;
    body.material.e = (with & RESTITUTION) ? 0.5 : 0.0;
    tribo_status status = (with & FLOOR) ? tribo_scene_add(world, &body, &id) : TRIBO_OK;
    for (uint32_t i = 0; status == TRIBO_OK && i < count; i++) {
        make_scene_body(t, with, (int)i, &body);
        status = tribo_scene_add(world, &body, &id);
    }
    if (status == TRIBO_OK && (with & PUSHED)) {
        double force[3];
        double torque[3];
        make_vector(t, "force", -4, 4, force);
        make_vector(t, "torque", -4, 4, torque);
        status = tribo_scene_set_force(world, id, force, torque);
    }
    return status;
}

static tribo_scene *make_world(property_trial *t, uint32_t with)
{
    const tribo_scene_settings settings = {.struct_size = sizeof settings,
                                           .friction_rule = TRIBO_MIX_MAXIMUM,
                                           .restitution_rule = TRIBO_MIX_MAXIMUM,
                                           .gravity = {0.0, 0.0, (with & GRAVITY) ? -10.0 : 0.0}};
    tribo_scene *world = NULL;
    property_expand(t);
    if (tribo_scene_create(&settings, NULL, &world) == TRIBO_OK &&
        fill(t, with, world) != TRIBO_OK) {
        tribo_scene_destroy(world);
        world = NULL;
    }
    return world;
}

static void make_step_options(property_trial *t, tribo_step_options *out)
{
    memset(out, 0, sizeof *out);
    out->struct_size = sizeof *out;
    out->substeps = 1 + make_choice(t, "substeps", 3);
    out->solver = make_choice(t, "solver", 3);
    out->skip = make_choice(t, "skip", 8);
    out->max_iterations = 200;
    out->tolerance = make_choice(t, "tolerance", 2) == 1 ? 1e-6 : 0.0;
    out->sleep_time = make_choice(t, "sleep", 2) == 1 ? 0.1 : 0.0;
    out->sleep_speed = 0.1;
}

/* ---- what is seen of a run ------------------------------------------------------------------- */

typedef struct record {
    tribo_status status; /* the first that is not TRIBO_OK */
    uint32_t sane;       /* all bodies pass tribo_body_check, contacts and events are in order */
    uint32_t stop;
    uint32_t moved_apart;
    uint32_t met;
    tribo_totals before, after;
    double energy_before, energy_after;
    uint32_t end;
    tribo_body bodies[BODIES + 1];
} record;

static int lists_are_sane(const tribo_scene *world)
{
    static tribo_scene_contact contacts[POINTS];
    static tribo_scene_event events[POINTS];
    size_t points = 0;
    size_t count = 0;
    if (tribo_scene_contacts(world, POINTS, contacts, &points) != TRIBO_OK ||
        tribo_scene_events(world, POINTS, events, &count) != TRIBO_OK) {
        return 0;
    }
    for (size_t i = 0; i < points; i++) {
        const tribo_scene_contact *c = &contacts[i];
        const double push = tribo_vec3_dot(c->impulse, c->normal);
        if (c->a >= c->b || !isfinite(c->distance) || !(push >= -1e-9 * (1.0 + fabs(push))) ||
            (i > 0 && (c[-1].a > c->a || (c[-1].a == c->a && c[-1].b > c->b)))) {
            return 0;
        }
    }
    for (size_t i = 0; i < count; i++) {
        const tribo_scene_event *e = &events[i];
        if (e->kind < TRIBO_EVENT_BEGIN || e->kind > TRIBO_EVENT_END || !(e->normal >= 0.0) ||
            (i > 0 && (e[-1].a > e->a || (e[-1].a == e->a && e[-1].b >= e->b)))) {
            return 0;
        }
    }
    return 1;
}

static void look(const tribo_scene *world, record *out)
{
    uint32_t asleep = 0;
    tribo_scene_counts(world, NULL, &out->end);
    out->sane = lists_are_sane(world) ? 1 : 0;
    for (uint32_t i = 0; i < out->end; i++) {
        if (tribo_scene_get_body(world, i, &out->bodies[i], &asleep) == TRIBO_OK &&
            (tribo_body_check(&out->bodies[i]) != TRIBO_OK || asleep > 1)) {
            out->sane = 0;
        }
    }
}

static void advance(tribo_scene *world, double dt, int steps, const tribo_step_options *options,
                    record *out)
{
    double potential = 0.0;
    memset(out, 0, sizeof *out);
    tribo_scene_totals(world, origin, &out->before, &potential);
    out->energy_before = out->before.energy + potential;
    for (int i = 0; i < steps && out->status == TRIBO_OK; i++) {
        tribo_step_info info = {.struct_size = sizeof info};
        out->status = tribo_scene_step(world, dt, options, &info);
        out->stop = info.stop > out->stop ? info.stop : out->stop;
        out->moved_apart += info.correction_solves > 0;
        out->met += info.contact_solves + info.impact_solves > 0;
    }
    tribo_scene_totals(world, origin, &out->after, &potential);
    out->energy_after = out->after.energy + potential;
    look(world, out);
}

/* ---- properties ------------------------------------------------------------------------------ */

static void nothing_breaks(property_trial *t)
{
    tribo_step_options options;
    record seen;
    make_step_options(t, &options);
    const uint32_t with = make_choice(t, "with", 32);
    const double dt = 0.001 + 0.05 * make_unit(t, "dt");
    tribo_scene *world = make_world(t, with);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, seen.status, TRIBO_OK);
    REQUIRE(t, seen.sane);
}

/* In empty space, as long as nothing is moved apart. */
static void momentum_is_kept(property_trial *t)
{
    tribo_step_options options;
    record seen;
    tribo_change change;
    make_step_options(t, &options);
    options.skip |= TRIBO_SKIP_CORRECTION;
    options.sleep_time = 0.0;
    const uint32_t with = make_choice(t, "with", 4) * FRICTION;
    const double dt = 0.001 + 0.02 * make_unit(t, "dt");
    tribo_scene *world = make_world(t, with);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, seen.status, TRIBO_OK);
    ASSUME(t, seen.met > 0);
    REQUIRE_STATUS(t, tribo_audit_change(&seen.before, &seen.after, &change), TRIBO_OK);
    REQUIRE_AT_MOST(t, change.linear, 1024.0 * EPS);
    REQUIRE_AT_MOST(t, change.angular, 1024.0 * EPS);
    if (seen.stop == TRIBO_STOP_TOLERANCE) {
        REQUIRE_AT_MOST(t, change.energy, 1e-6 + 10.0 * options.tolerance);
    }
}

static void saved_state_goes_on(property_trial *t)
{
    tribo_step_options options;
    record first;
    record second;
    size_t size = 0;
    make_step_options(t, &options);
    const uint32_t with = make_choice(t, "with", 32);
    const double dt = 0.001 + 0.05 * make_unit(t, "dt");
    const int flip = make_choice(t, "flip", 2) == 1;
    const size_t at = (size_t)make_bits(t, 2);
    tribo_scene *world = make_world(t, with);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS / 2, &options, &first);
    tribo_scene_save(world, NULL, 0, &size);
    unsigned char *block = malloc(size);
    const tribo_status saved = tribo_scene_save(world, block, size, NULL);
    advance(world, dt, STEPS / 2, &options, &first);
    if (flip) {
        block[at % size] ^= 4;
    }
    const tribo_status loaded = tribo_scene_load(world, block, size);
    const tribo_status cut = tribo_scene_load(world, block, size - 1);
    free(block);
    memset(&second, 0, sizeof second);
    if (loaded == TRIBO_OK) {
        advance(world, dt, STEPS / 2, &options, &second);
    }
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, saved, TRIBO_OK);
    REQUIRE_STATUS(t, cut, TRIBO_ERROR_DATA);
    REQUIRE_STATUS(t, loaded, flip ? TRIBO_ERROR_DATA : TRIBO_OK);
    if (!flip) {
        REQUIRE_SAME(t, &first, &second, sizeof first);
    }
}

/* Bodies come, go and change between steps. */
static void life(property_trial *t)
{
    tribo_step_options options;
    record seen;
    make_step_options(t, &options);
    tribo_scene *world = make_world(t, FLOOR | GRAVITY | FRICTION | RESTITUTION);
    tribo_status status = TRIBO_OK;
    ASSUME(t, world != NULL);
    for (int i = 0; status == TRIBO_OK && i < STEPS; i++) {
        const double gravity[3] = {0.0, 1.0, -10.0};
        const uint32_t id = make_byte(t) % (BODIES + 2);
        tribo_body state;
        switch (make_byte(t) % 5) {
        case 1:
            tribo_scene_remove(world, id);
            break;
        case 2:
            if (tribo_scene_get_body(world, id, &state, NULL) == TRIBO_OK) {
                state.position[0] += make_signed(t, "move");
                status = tribo_scene_set_body(world, id, &state);
            }
            break;
        case 3:
            status = tribo_scene_set_gravity(world, gravity);
            break;
        default:
            status = tribo_scene_step(world, 0.02, &options, NULL);
        }
    }
    look(world, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE(t, seen.sane);
}

/* Any numbers: a status, and a scene that is as it was. */
static void wild_bodies(property_trial *t)
{
    tribo_scene_body body;
    uint32_t id = 9;
    uint32_t count = 0;
    tribo_scene *world = NULL;
    tribo_scene_body_init(&body);
    make_body_wild(t, "body", &body.state);
    make_material(t, "material", &body.material);
    body.kind = make_choice(t, "kind", 4);
    body.shape.type = make_choice(t, "type", 7);
    for (int k = 0; k < 3; k++) {
        body.shape.size[k] = make_any(t, "size");
        body.offset.position[k] = make_hostile(t, "offset");
    }
    const double dt = make_hostile(t, "dt");
    ASSUME(t, tribo_scene_create(NULL, NULL, &world) == TRIBO_OK);
    const tribo_status status = tribo_scene_add(world, &body, &id);
    const tribo_status stepped = tribo_scene_step(world, dt, NULL, NULL);
    tribo_body after;
    memset(&after, 0, sizeof after);
    const tribo_status got = tribo_scene_get_body(world, 0, &after, NULL);
    tribo_scene_counts(world, &count, NULL);
    tribo_scene_destroy(world);
    REQUIRE(t, count == (status == TRIBO_OK ? 1u : 0u));
    REQUIRE(t, id == (status == TRIBO_OK ? 0u : 9u));
    REQUIRE_STATUS(t, got, status == TRIBO_OK ? TRIBO_OK : TRIBO_ERROR_INDEX);
    if (status == TRIBO_OK && stepped != TRIBO_OK) {
        REQUIRE_SAME(t, &after, &body.state, sizeof after);
    } else if (status == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_body_check(&after), TRIBO_OK);
    }
}

const char *const property_room = "scene";
const property property_list[] = {
    {"nothing_breaks", nothing_breaks, 40},
    {"momentum_is_kept", momentum_is_kept, 40},
    {"saved_state_goes_on", saved_state_goes_on, 40},
    {"life", life, 40},
    {"wild_bodies", wild_bodies, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 20000;
