#define _POSIX_C_SOURCE 200809L

#include "world.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

int world_check(world *w, tribo_status status)
{
    if (w->status == TRIBO_OK)
        w->status = status;
    return w->status == TRIBO_OK;
}

/* ---- making ---------------------------------------------------------------------------------- */

void world_begin_mixed(world *w, double gx, double gy, double gz, uint32_t friction_rule)
{
    const tribo_scene_settings settings = {.struct_size = sizeof settings,
                                           .friction_rule = friction_rule,
                                           .restitution_rule = TRIBO_MIX_MAXIMUM,
                                           .gravity = {gx, gy, gz}};

    world_end(w);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_create(&settings, NULL, &w->scene));
}

void world_begin(world *w, double gx, double gy, double gz)
{
    world_begin_mixed(w, gx, gy, gz, TRIBO_MIX_MAXIMUM);
}

void world_end(world *w)
{
    tribo_scene_destroy(w->scene);
    w->scene = NULL;
    free(w->kept);
    w->kept = NULL;
    w->kept_count = 0;
    w->time = 0.0;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

tribo_scene_body world_floor(double mu, double e)
{
    tribo_scene_body body;

    tribo_scene_body_init(&body);
    body.kind = TRIBO_BODY_STATIC;
    body.shape.type = TRIBO_SHAPE_HALFSPACE;
    body.shape.size[2] = 1.0;
    body.material = (tribo_material){mu, mu, e};
    return body;
}

tribo_scene_body world_plane(double nx, double nz, double d, double mu)
{
    tribo_scene_body body = world_floor(mu, 0.0);

    body.shape.size[0] = nx;
    body.shape.size[2] = nz;
    body.shape.size[3] = d;
    return body;
}

tribo_scene_body world_block(double hx, double hy, double hz, double mu)
{
    tribo_scene_body body = world_floor(mu, 0.0);

    body.shape = (tribo_shape){.type = TRIBO_SHAPE_BOX, .size = {hx, hy, hz}};
    return body;
}

void world_tilt(tribo_scene_body *body, double angle)
{
    body->state.orientation[0] = cos(0.5 * angle);
    body->state.orientation[2] = sin(0.5 * angle);
}

tribo_scene_body world_body(double mass, double ixx, double iyy, double izz, double mu, double e)
{
    const double inertia[9] = {ixx, 0.0, 0.0, 0.0, iyy, 0.0, 0.0, 0.0, izz};
    tribo_scene_body body;

    tribo_scene_body_init(&body);
    tribo_body_set_mass(&body.state, mass, inertia); /* if it is refused, so is the body */
    body.material = (tribo_material){mu, mu, e};
    return body;
}

tribo_scene_body world_ball_of(double mass, double radius, double share, double mu, double e)
{
    const double i = share * mass * radius * radius;
    tribo_scene_body body = world_body(mass, i, i, i, mu, e);

    body.shape.type = TRIBO_SHAPE_SPHERE;
    body.shape.size[0] = radius;
    return body;
}

tribo_scene_body world_ball(double mass, double radius, double mu, double e)
{
    return world_ball_of(mass, radius, 0.4, mu, e);
}

tribo_scene_body world_box(double mass, double hx, double hy, double hz, double mu, double e)
{
    const double third = mass / 3.0;
    tribo_scene_body body =
        world_body(mass, third * (hy * hy + hz * hz), third * (hx * hx + hz * hz),
                   third * (hx * hx + hy * hy), mu, e);

    body.shape.type = TRIBO_SHAPE_BOX;
    body.shape.size[0] = hx;
    body.shape.size[1] = hy;
    body.shape.size[2] = hz;
    return body;
}

uint32_t world_add(world *w, const tribo_scene_body *body)
{
    uint32_t id = 0;

    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_add(w->scene, body, &id));
    return id;
}

uint32_t world_add_at(world *w, const tribo_scene_body *body, double x, double y, double z)
{
    tribo_scene_body placed = *body;

    placed.state.position[0] = x;
    placed.state.position[1] = y;
    placed.state.position[2] = z;
    return world_add(w, &placed);
}

double world_substep(const world *w)
{
    return w->dt / (w->options.substeps > 0 ? w->options.substeps : 1);
}

void world_before(const world *w, tribo_scene_body *body)
{
    const double half = 0.5 * world_substep(w);
    double turn[3];
    double q[4];

    tribo_vec3_add_scaled(body->state.position, -half, body->state.velocity, body->state.position);
    tribo_vec3_scale(-half, body->state.angular_velocity, turn);
    if (tribo_quat_from_rotation_vector(turn, q) == TRIBO_OK)
        tribo_quat_multiply(q, body->state.orientation, body->state.orientation);
}

tribo_body world_state(world *w, uint32_t id)
{
    tribo_body state;

    tribo_body_init(&state);
    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_get_body(w->scene, id, &state, NULL));
    return state;
}

void world_keep(world *w)
{
    uint32_t end = 0;

    if (w->status != TRIBO_OK || !world_check(w, tribo_scene_counts(w->scene, NULL, &end)))
        return;
    free(w->kept);
    w->kept_count = 0;
    w->kept = malloc((end + 1) * sizeof *w->kept);
    if (w->kept == NULL) {
        world_check(w, TRIBO_ERROR_MEMORY);
        return;
    }
    for (uint32_t i = 0; i < end; i++)
        w->kept[w->kept_count++] = world_state(w, i);
}

/* Of one coordinate; NaN is a greater way than any. */
static double farther(double way, double now, double then, double size)
{
    const double gone = size * fabs(now - then);

    return gone <= way ? way : gone;
}

double world_way(world *w, double size)
{
    double way = 0.0;

    for (uint32_t i = 0; i < w->kept_count; i++) {
        const tribo_body now = world_state(w, i);
        for (int k = 0; k < 3; k++)
            way = farther(way, now.position[k], w->kept[i].position[k], 1.0);
        for (int k = 0; k < 4; k++)
            way = farther(way, now.orientation[k], w->kept[i].orientation[k], 2.0 * size);
    }
    return way;
}

double world_energy(world *w)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    tribo_totals totals = {0};
    double potential = 0.0;

    if (w->status == TRIBO_OK)
        world_check(w, tribo_scene_totals(w->scene, origin, &totals, &potential));
    return totals.energy + potential;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static void write_rows(world *w)
{
    uint32_t end = 0;

    if (tribo_scene_counts(w->scene, NULL, &end) != TRIBO_OK)
        return;
    for (uint32_t id = 0; id < end; id++) {
        tribo_body b;
        if (tribo_scene_get_body(w->scene, id, &b, NULL) != TRIBO_OK)
            continue;
        const double *x = b.position, *q = b.orientation, *v = b.velocity, *o = b.angular_velocity;
        if (b.inverse_mass != 0.0 || tribo_vec3_norm(v) != 0.0 || tribo_vec3_norm(o) != 0.0)
            fprintf(w->csv,
                    "%.17g,%u,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,"
                    "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                    w->time, (unsigned)id, x[0], x[1], x[2], q[0], q[1], q[2], q[3], v[0], v[1],
                    v[2], o[0], o[1], o[2]);
    }
}

static void keep_info(world *w, const tribo_step_info *info)
{
    w->last = *info;
    w->impacts += info->impacts;
    w->sweeps += info->sweeps;
    w->newton += info->newton_steps;
    w->stop = info->stop > w->stop ? info->stop : w->stop;
    w->restitution = fmin(w->restitution, info->restitution);
}

void world_step(world *w)
{
    tribo_step_info info = {.struct_size = sizeof info};

    if (w->status != TRIBO_OK)
        return;
    if (w->csv != NULL && w->time == 0.0)
        write_rows(w);
    const double tick = world_tick();
    const tribo_status status = tribo_scene_step(w->scene, w->dt, &w->options, &info);
    world_tock(w, tick);
    if (!world_check(w, status))
        return;
    w->time += w->dt;
    keep_info(w, &info);
    if (w->csv != NULL)
        write_rows(w);
}

uint64_t world_steps(const world *w, double seconds)
{
    const double steps = floor(seconds / w->dt + 0.5);

    return steps > 1.0 ? (uint64_t)steps : 1;
}

void world_run(world *w, double seconds)
{
    const uint64_t steps = world_steps(w, seconds);

    for (uint64_t i = 0; i < steps && w->status == TRIBO_OK; i++)
        world_step(w);
}

double world_tick(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void world_tock(world *w, double tick)
{
    w->spent += world_tick() - tick;
    w->steps++;
}
