/**
 * @file worlds.h
 * Scenes for tests: a floor, spheres and boxes in them, steps that must succeed. It needs cmocka,
 * as check.h does.
 */
#ifndef TRIBO_TESTS_WORLDS_H
#define TRIBO_TESTS_WORLDS_H

#include <tribo/scene.h>

#include "check.h"

/** Restitution of a pair is the greater one; gravity lies in the plane y = 0. */
static inline tribo_scene *make_scene(double gx, double gz, uint32_t friction_rule)
{
    tribo_scene_settings settings = {.struct_size = sizeof settings};
    tribo_scene *scene = NULL;
    settings.friction_rule = friction_rule;
    settings.restitution_rule = TRIBO_MIX_MAXIMUM;
    settings.gravity[0] = gx;
    settings.gravity[2] = gz;
    assert_int_equal(tribo_scene_create(&settings, NULL, &scene), TRIBO_OK);
    return scene;
}

static inline uint32_t add(tribo_scene *scene, const tribo_scene_body *body)
{
    uint32_t id = UINT32_MAX;
    assert_int_equal(tribo_scene_add(scene, body, &id), TRIBO_OK);
    return id;
}

static inline tribo_scene_body floor_of(double mu, double e)
{
    tribo_scene_body body;
    tribo_scene_body_init(&body);
    body.kind = TRIBO_BODY_STATIC;
    body.shape.type = TRIBO_SHAPE_HALFSPACE;
    body.shape.size[2] = 1.0;
    body.material = (tribo_material){mu, mu, e};
    return body;
}

static inline void add_floor(tribo_scene *scene, double mu, double e)
{
    const tribo_scene_body body = floor_of(mu, e);
    add(scene, &body);
}

static inline tribo_scene_body sphere_of(double mass, double radius, double mu, double e)
{
    const double i = 0.4 * mass * radius * radius;
    tribo_scene_body body;
    tribo_scene_body_init(&body);
    body.state = body_of(mass, i, i, i);
    body.shape.type = TRIBO_SHAPE_SPHERE;
    body.shape.size[0] = radius;
    body.material = (tribo_material){mu, mu, e};
    return body;
}

static inline tribo_scene_body box_of(double mass, double hx, double hy, double hz, double mu,
                                      double e)
{
    const double third = mass / 3.0;
    tribo_scene_body body;
    tribo_scene_body_init(&body);
    body.state = body_of(mass, third * (hy * hy + hz * hz), third * (hx * hx + hz * hz),
                         third * (hx * hx + hy * hy));
    body.shape.type = TRIBO_SHAPE_BOX;
    body.shape.size[0] = hx;
    body.shape.size[1] = hy;
    body.shape.size[2] = hz;
    body.material = (tribo_material){mu, mu, e};
    return body;
}

static inline uint32_t add_at(tribo_scene *scene, tribo_scene_body *body, double x, double y,
                              double z)
{
    body->state.position[0] = x;
    body->state.position[1] = y;
    body->state.position[2] = z;
    return add(scene, body);
}

static inline tribo_body state_of(const tribo_scene *scene, uint32_t id)
{
    tribo_body state;
    assert_int_equal(tribo_scene_get_body(scene, id, &state, NULL), TRIBO_OK);
    return state;
}

static inline void sum_info(const tribo_step_info *more, tribo_step_info *sum)
{
    sum->substeps += more->substeps;
    sum->stop = more->stop > sum->stop ? more->stop : sum->stop;
    sum->asleep = more->asleep;
    sum->flights += more->flights;
    sum->turns += more->turns;
    sum->broad += more->broad;
    sum->pairs += more->pairs;
    sum->contacts += more->contacts;
    sum->frictionless += more->frictionless;
    sum->resisting += more->resisting;
    sum->matched += more->matched;
    sum->contact_solves += more->contact_solves;
    sum->impact_solves += more->impact_solves;
    sum->impacts += more->impacts;
    sum->correction_solves += more->correction_solves;
    sum->sweeps += more->sweeps;
    sum->newton_steps += more->newton_steps;
    sum->penetration = fmax(sum->penetration, more->penetration);
}

/** `count` steps; returns the sum of what they tell. */
static inline tribo_step_info run(tribo_scene *scene, double dt, int count,
                                  const tribo_step_options *options)
{
    tribo_step_info sum = {0};
    for (int k = 0; k < count; k++) {
        tribo_step_info info = {.struct_size = sizeof info};
        assert_int_equal(tribo_scene_step(scene, dt, options, &info), TRIBO_OK);
        sum_info(&info, &sum);
    }
    return sum;
}

#endif
