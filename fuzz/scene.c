/* Properties of include/tribo/scene.h: no NaN, momentum and energy, saved states to the bit, and
 * whatever is wrong. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <tribo/scene.h>

#include "pool.h"
#include "support/scenes.h"

enum { BODIES = SCENES_BODIES, CALLS = 24, STEPS = 12, POINTS = 4096 };

static const double origin[3] = {0.0, 0.0, 0.0};

/* ---- scenes from bytes ----------------------------------------------------------------------- */

/* What a scene may have. */
enum { FLOOR = 1, FRICTION = 2, RESTITUTION = 4, GRAVITY = 8, PUSHED = 16, RESISTANCE = 32 };

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
    out->rolling = (with & RESISTANCE) && make_choice(t, NULL, 2) == 1 ? make_unit(t, NULL) : 0.0;
    out->spinning = (with & RESISTANCE) && make_choice(t, NULL, 2) == 1 ? make_unit(t, NULL) : 0.0;
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
    tribo_body bodies[BODIES + CALLS];
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
        if (c->a >= c->b || !isfinite(c->distance) ||
            !(push >= -1e-9 * tribo_vec3_norm(c->impulse)) ||
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

static void break_nothing(property_trial *t, uint32_t also)
{
    tribo_step_options options;
    record seen;
    make_step_options(t, &options);
    const uint32_t with = make_choice(t, "with", 32) | also;
    const double dt = 0.001 + 0.05 * make_unit(t, "dt");
    tribo_scene *world = make_world(t, with);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, seen.status, TRIBO_OK);
    REQUIRE(t, seen.sane);
}

static void nothing_breaks(property_trial *t)
{
    break_nothing(t, 0);
}

static void resistance_breaks_nothing(property_trial *t)
{
    break_nothing(t, RESISTANCE);
}

/* In empty space, as long as nothing is moved apart. */
static void keep_momentum(property_trial *t, uint32_t also)
{
    tribo_step_options options;
    record seen;
    tribo_change change;
    make_step_options(t, &options);
    options.skip |= TRIBO_SKIP_CORRECTION;
    options.sleep_time = 0.0;
    const uint32_t with = make_choice(t, "with", 4) * FRICTION | also;
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

static void momentum_is_kept(property_trial *t)
{
    keep_momentum(t, 0);
}

static void resistance_keeps_momentum(property_trial *t)
{
    keep_momentum(t, RESISTANCE);
}

static void go_on(property_trial *t, uint32_t also)
{
    tribo_step_options options;
    record first;
    record second;
    size_t size = 0;
    make_step_options(t, &options);
    const uint32_t with = make_choice(t, "with", 32) | also;
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

static void saved_state_goes_on(property_trial *t)
{
    go_on(t, 0);
}

static void saved_resistance_goes_on(property_trial *t)
{
    go_on(t, RESISTANCE);
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
    if (make_choice(t, "resists", 4) == 1) {
        body.rolling = make_any(t, "rolling");
        body.spinning = make_any(t, "spinning");
    }
    ASSUME(t, tribo_scene_create(NULL, NULL, &world) == TRIBO_OK);
    const tribo_status status = tribo_scene_add(world, &body, &id);
    const tribo_status stepped = tribo_scene_step(world, dt, NULL, NULL);
    tribo_body after;
    memset(&after, 0, sizeof after);
    const tribo_status got = tribo_scene_get_body(world, 0, &after, NULL);
    tribo_scene_counts(world, &count, NULL);
    tribo_scene_destroy(world);
    REQUIRE(t, count == (status == TRIBO_OK ? 1u : 0u));
    REQUIRE(t, status != TRIBO_OK || (body.rolling >= 0.0 && isfinite(body.rolling) &&
                                      body.spinning >= 0.0 && isfinite(body.spinning)));
    REQUIRE(t, id == (status == TRIBO_OK ? 0u : 9u));
    REQUIRE_STATUS(t, got, status == TRIBO_OK ? TRIBO_OK : TRIBO_ERROR_INDEX);
    if (status == TRIBO_OK && stepped != TRIBO_OK) {
        REQUIRE_SAME(t, &after, &body.state, sizeof after);
    } else if (status == TRIBO_OK) {
        REQUIRE_STATUS(t, tribo_body_check(&after), TRIBO_OK);
    }
}

/* ---- all kinds of bodies --------------------------------------------------------------------- */

static cast played;
static cast other;

/* All options, within their ranges. */
static void make_all_options(property_trial *t, tribo_step_options *out)
{
    make_step_options(t, out);
    out->max_iterations = 50;
    out->skip = make_choice(t, "skip", 16);
    out->margin = make_choice(t, "margin", 4) == 1 ? 0.125 * make_unit(t, NULL) : 0.0;
    out->threshold = make_choice(t, "threshold", 4) == 1 ? make_unit(t, NULL) : 0.0;
    out->correction = make_choice(t, "correction", 4) == 1 ? make_unit(t, NULL) : 0.0;
}

static double make_dt(property_trial *t)
{
    return ldexp(1.0 + make_unit(t, "dt"), make_exponent(t, -9, -4));
}

static unsigned char *save(const tribo_scene *world, size_t *size)
{
    *size = 0;
    tribo_scene_save(world, NULL, 0, size);
    unsigned char *block = malloc(*size);
    tribo_scene_save(world, block, *size, NULL);
    return block;
}

/* Bodies, contacts, events, what is asleep: all of it. */
static int same_state(const tribo_scene *a, const tribo_scene *b)
{
    size_t sizes[2];
    unsigned char *blocks[2] = {save(a, &sizes[0]), save(b, &sizes[1])};
    const int same = sizes[0] == sizes[1] && memcmp(blocks[0], blocks[1], sizes[0]) == 0;
    free(blocks[0]);
    free(blocks[1]);
    return same;
}

/* Where numbers are beyond double, or bodies turn too fast, a step may say so. */
static int may_refuse(tribo_status status)
{
    return status == TRIBO_OK || status == TRIBO_ERROR_RANGE || status == TRIBO_ERROR_TIME_STEP;
}

static void anything_goes(property_trial *t)
{
    tribo_step_options options;
    record seen;
    make_all_options(t, &options);
    const uint32_t with = make_choice(t, "with", SCENES_ALL + 1);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    tribo_scene *world = scenes_build(&played);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE(t, may_refuse(seen.status));
    REQUIRE(t, seen.sane);
    ASSUME(t, seen.status == TRIBO_OK);
}

/* As momentum_is_kept. */
static void momentum_of_anything(property_trial *t)
{
    tribo_step_options options;
    record seen;
    tribo_change change;
    make_all_options(t, &options);
    options.skip |= TRIBO_SKIP_CORRECTION;
    options.sleep_time = 0.0;
    const uint32_t with = make_choice(t, "with", 4) * SCENES_FRICTION;
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    tribo_scene *world = scenes_build(&played);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, seen.status, TRIBO_OK);
    ASSUME(t, seen.met > 0);
    REQUIRE_STATUS(t, tribo_audit_change(&seen.before, &seen.after, &change), TRIBO_OK);
    REQUIRE_AT_MOST(t, change.linear, 1024.0 * EPS);
    REQUIRE_AT_MOST(t, change.angular, 1024.0 * EPS);
}

/* Half the square of what forces give in a sub-step, a quarter of it: what contacts that are met
 * may add to the energy (scene.h). */
static double energy_allowed(const cast *c, double h, uint64_t substeps)
{
    const double *g = c->settings.gravity;
    double sum = 0.0;
    for (uint32_t i = 0; i < c->count; i++) {
        if (c->bodies[i].kind == TRIBO_BODY_DYNAMIC) {
            sum += h * h * tribo_vec3_dot(g, g) / (8.0 * c->bodies[i].state.inverse_mass);
        }
    }
    return sum * (double)substeps;
}

/* With gravity and ground, as long as nothing is moved apart or driven, and solvers meet their
 * tolerance. */
static void energy_is_bounded(property_trial *t)
{
    tribo_step_options options;
    record seen;
    make_all_options(t, &options);
    options.skip |= TRIBO_SKIP_CORRECTION;
    options.tolerance = 0.0;
    options.max_iterations = 200;
    const uint32_t with = make_choice(t, "with", 16);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    tribo_scene *world = scenes_build(&played);
    ASSUME(t, world != NULL);
    advance(world, dt, STEPS, &options, &seen);
    tribo_scene_destroy(world);
    REQUIRE_STATUS(t, seen.status, TRIBO_OK);
    ASSUME(t, seen.met > 0 && seen.stop == TRIBO_STOP_TOLERANCE);
    const double gain = energy_allowed(&played, dt / options.substeps, STEPS * options.substeps);
    const double scale = fmax(seen.before.energy, seen.after.energy);
    REQUIRE_AT_MOST(t, seen.energy_after - seen.energy_before, gain * (1.0 + 1e-9) + 1e-9 * scale);
}

/* Momentum that bodies which are not dynamic have given, by the events of a step. */
static void add_events(const tribo_scene *world, const cast *c, double sum[3], double *scale)
{
    static tribo_scene_event events[POINTS];
    size_t count = 0;
    tribo_scene_events(world, POINTS, events, &count);
    for (size_t i = 0; i < count; i++) {
        const int moves_a = c->bodies[events[i].a].kind == TRIBO_BODY_DYNAMIC;
        const int moves_b = c->bodies[events[i].b].kind == TRIBO_BODY_DYNAMIC;
        tribo_vec3_add_scaled(sum, (double)(moves_a - moves_b), events[i].impulse, sum);
        *scale += tribo_vec3_norm(events[i].impulse);
    }
}

static void add_pushes(const cast *c, double dt, double sum[3], double *scale)
{
    for (uint32_t i = 0; i < c->count; i++) {
        double push[3];
        if (c->bodies[i].kind == TRIBO_BODY_DYNAMIC) {
            tribo_vec3_scale(1.0 / c->bodies[i].state.inverse_mass, c->settings.gravity, push);
            tribo_vec3_add(push, c->forces[i], push);
            tribo_vec3_add_scaled(sum, dt, push, sum);
            *scale += dt * tribo_vec3_norm(push);
        }
    }
}

/* Whatever happens, as long as all are awake: impulses of forces, gravity and events are what
 * momentum changes by. */
static void impulses_add_up(property_trial *t)
{
    tribo_step_options options;
    tribo_totals before;
    tribo_totals after;
    double sum[3] = {0.0, 0.0, 0.0};
    double error[3];
    double scale = 0.0;
    tribo_status status = TRIBO_OK;
    make_all_options(t, &options);
    options.sleep_time = 0.0;
    const uint32_t with = make_choice(t, "with", SCENES_EXTREME);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    tribo_scene *world = scenes_build(&played);
    ASSUME(t, world != NULL);
    tribo_scene_totals(world, origin, &before, NULL);
    for (int i = 0; i < STEPS && status == TRIBO_OK; i++) {
        status = tribo_scene_step(world, dt, &options, NULL);
        add_events(world, &played, sum, &scale);
        add_pushes(&played, dt, sum, &scale);
    }
    tribo_scene_totals(world, origin, &after, NULL);
    tribo_scene_destroy(world);
    ASSUME(t, status != TRIBO_ERROR_TIME_STEP);
    REQUIRE_STATUS(t, status, TRIBO_OK);
    tribo_vec3_add(before.linear, sum, error);
    tribo_vec3_subtract(error, after.linear, error);
    scale += before.linear_scale + after.linear_scale;
    REQUIRE_AT_MOST(t, tribo_vec3_norm(error), 1024.0 * EPS * scale);
}

/* A force that gives up to 16 sizes/s^2, and a torque that gives up to 16 rad/s^2. */
static tribo_status push(tribo_scene *world, uint32_t id, const double x[6])
{
    double force[3];
    double torque[3];
    tribo_body state;
    const tribo_status status = tribo_scene_get_body(world, id, &state, NULL);
    if (status != TRIBO_OK || !(state.inverse_mass > 0.0)) {
        return tribo_scene_set_force(world, id, x, x + 3);
    }
    const double *j = state.inverse_inertia;
    const double turn = fmax(j[0], fmax(j[3], j[5]));
    tribo_vec3_scale(ldexp(16.0, played.length) / state.inverse_mass, x, force);
    tribo_vec3_scale(turn > 0.0 ? 16.0 / turn : 0.0, x + 3, torque);
    return tribo_scene_set_force(world, id, force, torque);
}

/* One of the calls that change a scene. */
static tribo_status do_call(tribo_scene *world, uint32_t what, uint32_t id, const double x[6],
                            double dt, const tribo_step_options *options)
{
    const double size = ldexp(1.0, played.length);
    double gravity[3];
    tribo_body state;
    uint32_t place = 0;
    switch (what) {
    case 1:
        return tribo_scene_remove(world, id);
    case 2:
        if (tribo_scene_get_body(world, id, &state, NULL) != TRIBO_OK) {
            return TRIBO_ERROR_INDEX;
        }
        tribo_vec3_add_scaled(state.position, size, x, state.position);
        return tribo_scene_set_body(world, id, &state);
    case 3:
        tribo_vec3_scale(10.0 * size, x, gravity);
        return tribo_scene_set_gravity(world, gravity);
    case 4:
        return push(world, id, x);
    case 5:
        return tribo_scene_add(world, &played.bodies[id % played.count], &place);
    default:
        return tribo_scene_step(world, dt, options, NULL);
    }
}

static tribo_scene *copy_of(const tribo_scene *world)
{
    tribo_scene *copy = NULL;
    size_t size = 0;
    unsigned char *block = save(world, &size);
    if (tribo_scene_create(NULL, NULL, &copy) == TRIBO_OK &&
        tribo_scene_load(copy, block, size) != TRIBO_OK) {
        tribo_scene_destroy(copy);
        copy = NULL;
    }
    free(block);
    return copy;
}

/* The same calls give the same bits; a copy may take over at any of them. What is refused changes
 * nothing. */
static void lives_are_replayed(property_trial *t)
{
    tribo_step_options options;
    tribo_scene *worlds[2];
    record seen;
    int refused = 0;
    int agree = 1;
    make_all_options(t, &options);
    const uint32_t with = make_choice(t, "with", SCENES_ALL + 1);
    const int at = (int)make_choice(t, "copied at", CALLS);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    worlds[0] = scenes_build(&played);
    worlds[1] = scenes_build(&played);
    ASSUME(t, worlds[0] != NULL && worlds[1] != NULL);
    for (int i = 0; i < CALLS && agree; i++) {
        const uint32_t what = make_byte(t) % 12;
        const uint32_t id = make_byte(t) % (BODIES + 2);
        tribo_status status[2];
        double x[6];
        make_directions(t, NULL, x, 6);
        if (i == at) {
            tribo_scene_destroy(worlds[1]);
            worlds[1] = copy_of(worlds[0]);
        }
        for (int k = 0; k < 2; k++) {
            status[k] = do_call(worlds[k], what, id, x, dt, &options);
        }
        agree = status[0] == status[1];
        refused += !may_refuse(status[0]) && what == 0;
    }
    const int same = agree && same_state(worlds[0], worlds[1]);
    look(worlds[0], &seen);
    tribo_scene_destroy(worlds[0]);
    tribo_scene_destroy(worlds[1]);
    REQUIRE(t, agree);
    REQUIRE(t, refused == 0);
    REQUIRE(t, same);
    REQUIRE(t, seen.sane);
}

/* A step of n sub-steps is n steps. */
static void substeps_are_steps(property_trial *t)
{
    tribo_step_options options;
    tribo_scene *worlds[2];
    record seen[2];
    make_all_options(t, &options);
    const uint32_t with = make_choice(t, "with", SCENES_ALL + 1);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    worlds[0] = scenes_build(&played);
    worlds[1] = scenes_build(&played);
    ASSUME(t, worlds[0] != NULL && worlds[1] != NULL);
    options.substeps = 4;
    advance(worlds[0], 4.0 * dt, STEPS / 4, &options, &seen[0]);
    options.substeps = 1;
    advance(worlds[1], dt, STEPS, &options, &seen[1]);
    tribo_scene_destroy(worlds[0]);
    tribo_scene_destroy(worlds[1]);
    ASSUME(t, seen[0].status == TRIBO_OK && seen[1].status == TRIBO_OK);
    REQUIRE_SAME(t, seen[0].bodies, seen[1].bodies, sizeof seen[0].bodies);
    REQUIRE_SAME(t, &seen[0].after, &seen[1].after, sizeof seen[0].after);
}

static void scale_body(tribo_body *body, int length, int mass, int time)
{
    for (int k = 0; k < 3; k++) {
        body->position[k] = ldexp(body->position[k], length);
        body->velocity[k] = ldexp(body->velocity[k], length - time);
        body->angular_velocity[k] = ldexp(body->angular_velocity[k], -time);
    }
    for (int k = 0; k < 6; k++) {
        body->inverse_inertia[k] = ldexp(body->inverse_inertia[k], -mass - 2 * length);
    }
    body->inverse_mass = ldexp(body->inverse_mass, -mass);
}

/* Units that are powers of two apart change no bit. */
static void units_do_not_matter(property_trial *t)
{
    tribo_step_options options;
    record seen[2];
    tribo_scene *worlds[2];
    make_all_options(t, &options);
    const uint32_t with = make_choice(t, "with", SCENES_EXTREME);
    const int length = make_exponent(t, -20, 20);
    const int mass = make_exponent(t, -20, 20);
    const int time = make_exponent(t, -20, 20);
    const double dt = make_dt(t);
    make_cast(t, with, &played);
    ASSUME(t, scenes_scale(&played, length, mass, time, &other));
    worlds[0] = scenes_build(&played);
    worlds[1] = scenes_build(&other);
    ASSUME(t, worlds[0] != NULL && worlds[1] != NULL);
    advance(worlds[0], dt, STEPS, &options, &seen[0]);
    options.margin = ldexp(options.margin, length);
    options.threshold = ldexp(options.threshold, length - time);
    options.sleep_time = ldexp(options.sleep_time, time);
    options.sleep_speed = ldexp(options.sleep_speed, length - time);
    advance(worlds[1], ldexp(dt, time), STEPS, &options, &seen[1]);
    tribo_scene_destroy(worlds[0]);
    tribo_scene_destroy(worlds[1]);
    REQUIRE_STATUS(t, seen[1].status, seen[0].status);
    for (uint32_t i = 0; i < seen[0].end; i++) {
        scale_body(&seen[0].bodies[i], length, mass, time);
    }
    REQUIRE_SAME(t, seen[0].bodies, seen[1].bodies, sizeof seen[0].bodies);
}

/* ---- threads --------------------------------------------------------------------------------- */

enum { SIDE = 17 };

/* A field of boxes and balls on a floor, so wide that its colours are worth tasks. */
static tribo_scene *make_field(property_trial *t)
{
    const tribo_scene_settings settings = {.struct_size = sizeof settings,
                                           .gravity = {0.0, 0.0, -10.0}};
    const double gap = 0.01 * make_unit(t, "gap");
    const double mu = make_unit(t, "mu");
    tribo_scene *world = NULL;
    tribo_scene_body body;
    uint32_t id = 0;
    property_expand(t);
    tribo_status status = tribo_scene_create(&settings, NULL, &world);
    for (int i = -1; status == TRIBO_OK && i < SIDE * SIDE; i++) {
        double inertia[9];
        double mass = 0.0;
        tribo_scene_body_init(&body);
        body.material = (tribo_material){mu, mu, 0.0};
        body.kind = i < 0 ? TRIBO_BODY_STATIC : TRIBO_BODY_DYNAMIC;
        body.shape.type = i < 0                   ? TRIBO_SHAPE_HALFSPACE
                          : make_byte(t) % 4 == 1 ? TRIBO_SHAPE_SPHERE
                                                  : TRIBO_SHAPE_BOX;
        body.shape.size[0] = body.shape.size[1] = i < 0 ? 0.0 : 0.5;
        body.shape.size[2] = i < 0 ? 1.0 : 0.5;
        if (i >= 0) {
            tribo_mass_box(1.0 + make_unit(t, NULL), body.shape.size, &mass, inertia);
            tribo_body_set_mass(&body.state, mass, inertia);
            body.state.position[0] = (1.0 + gap) * (i % SIDE) + 0.1 * make_unit(t, NULL);
            body.state.position[1] = (1.0 + gap) * (i / SIDE);
            body.state.position[2] = 0.5 + gap;
            make_directions(t, NULL, body.state.velocity, 3);
        }
        status = tribo_scene_add(world, &body, &id);
    }
    if (status != TRIBO_OK) {
        tribo_scene_destroy(world);
        world = NULL;
    }
    return world;
}

static void threads_change_no_bit(property_trial *t)
{
    static pool *threads;
    tribo_step_options options;
    tribo_scene *worlds[2] = {NULL, NULL};
    tribo_status status[2] = {TRIBO_OK, TRIBO_OK};
    make_step_options(t, &options);
    options.solver = TRIBO_SOLVER_GAUSS_SEIDEL;
    options.max_iterations = 3;
    const uint32_t tasks = 2 + make_choice(t, "tasks", 6);
    threads = threads != NULL ? threads : pool_create(3);
    worlds[0] = make_field(t);
    worlds[1] = worlds[0] != NULL ? copy_of(worlds[0]) : NULL;
    ASSUME(t, threads != NULL && worlds[1] != NULL);
    const uint64_t calls = pool_calls(threads);
    status[0] = tribo_scene_step(worlds[0], 0.01, &options, NULL);
    options.tasks = tasks;
    options.parallel = pool_run;
    options.user = threads;
    status[1] = tribo_scene_step(worlds[1], 0.01, &options, NULL);
    const int same = same_state(worlds[0], worlds[1]);
    tribo_scene_destroy(worlds[0]);
    tribo_scene_destroy(worlds[1]);
    REQUIRE_STATUS(t, status[0], TRIBO_OK);
    REQUIRE_STATUS(t, status[1], TRIBO_OK);
    REQUIRE(t, same);
    ASSUME(t, pool_calls(threads) > calls);
}

/* ---- memory ---------------------------------------------------------------------------------- */

typedef struct purse {
    uint64_t left; /* allocations */
} purse;

static void *spend(void *user, size_t size)
{
    purse *p = user;
    if (p->left == 0) {
        return NULL;
    }
    p->left--;
    return malloc(size);
}

static void refund(void *user, void *memory)
{
    (void)user;
    free(memory);
}

/* Where memory ends the scene is what it was, and with more of it goes on as if nothing had been. */
static void memory_may_end(property_trial *t)
{
    purse own = {UINT64_MAX};
    const tribo_allocator allocator = {sizeof allocator, 0, spend, refund, &own};
    tribo_step_options options;
    tribo_scene *poor = NULL;
    size_t size = 0;
    int kept = 1;
    int failed = 0;
    make_all_options(t, &options);
    const uint32_t with = make_choice(t, "with", SCENES_EXTREME);
    const double dt = make_dt(t);
    const uint32_t first = make_choice(t, "allocations", 32);
    make_cast(t, with, &played);
    tribo_scene *rich = scenes_build(&played);
    ASSUME(t, rich != NULL);
    unsigned char *block = save(rich, &size);
    tribo_status status = tribo_scene_create(NULL, &allocator, &poor);
    if (status == TRIBO_OK) {
        status = tribo_scene_load(poor, block, size);
    }
    free(block);
    for (int i = 0; i < STEPS && status == TRIBO_OK; i++) {
        status = tribo_scene_step(rich, dt, &options, NULL);
        tribo_status got = TRIBO_ERROR_MEMORY;
        for (uint64_t more = first; got == TRIBO_ERROR_MEMORY; more++) {
            size_t before_size = 0;
            unsigned char *before = save(poor, &before_size);
            own.left = more;
            got = tribo_scene_step(poor, dt, &options, NULL);
            own.left = UINT64_MAX;
            if (got == TRIBO_ERROR_MEMORY) {
                size_t after_size = 0;
                unsigned char *after = save(poor, &after_size);
                kept = kept && before_size == after_size && memcmp(before, after, after_size) == 0;
                free(after);
                failed++;
            }
            free(before);
        }
        kept = kept && got == status;
    }
    const int same = same_state(rich, poor);
    tribo_scene_destroy(rich);
    tribo_scene_destroy(poor);
    REQUIRE(t, may_refuse(status));
    REQUIRE(t, kept);
    REQUIRE(t, same);
    ASSUME(t, failed > 0);
}

/* Any numbers in the options: a status that names it, or a step. */
static void wild_options(property_trial *t)
{
    tribo_step_options options;
    tribo_scene *copy;
    make_all_options(t, &options);
    const uint32_t which = make_choice(t, "which", 10);
    double *numbers[6] = {&options.tolerance,  &options.margin,     &options.threshold,
                          &options.correction, &options.sleep_time, &options.sleep_speed};
    if (which < 6) {
        *numbers[which] = make_any(t, "number");
    }
    options.solver = which == 6 ? make_byte(t) : options.solver;
    options.skip = which == 7 ? make_byte(t) : options.skip;
    options.reserved = which == 8 ? make_byte(t) : 0;
    options.struct_size = which == 9 ? make_byte(t) : options.struct_size;
    make_cast(t, make_choice(t, "with", SCENES_EXTREME), &played);
    tribo_scene *world = scenes_build(&played);
    ASSUME(t, world != NULL);
    copy = copy_of(world);
    const tribo_status status = tribo_scene_step(world, 0.01, &options, NULL);
    const int same = same_state(world, copy);
    tribo_scene_destroy(world);
    tribo_scene_destroy(copy);
    REQUIRE(t, status == TRIBO_OK || same);
    REQUIRE(t, may_refuse(status) || status == TRIBO_ERROR_OPTION ||
                   status == TRIBO_ERROR_NOT_FINITE || status == TRIBO_ERROR_STRUCT_SIZE);
}

const char *const property_room = "scene";
const property property_list[] = {
    {"nothing_breaks", nothing_breaks, 40},
    {"momentum_is_kept", momentum_is_kept, 40},
    {"saved_state_goes_on", saved_state_goes_on, 40},
    {"life", life, 40},
    {"wild_bodies", wild_bodies, 1},
    {"anything_goes", anything_goes, 40},
    {"momentum_of_anything", momentum_of_anything, 40},
    {"energy_is_bounded", energy_is_bounded, 40},
    {"impulses_add_up", impulses_add_up, 40},
    {"lives_are_replayed", lives_are_replayed, 100},
    {"substeps_are_steps", substeps_are_steps, 40},
    {"units_do_not_matter", units_do_not_matter, 40},
    {"threads_change_no_bit", threads_change_no_bit, 4000},
    {"memory_may_end", memory_may_end, 100},
    {"wild_options", wild_options, 40},
    {"resistance_breaks_nothing", resistance_breaks_nothing, 40},
    {"resistance_keeps_momentum", resistance_keeps_momentum, 40},
    {"saved_resistance_goes_on", saved_resistance_goes_on, 40},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 20000;
