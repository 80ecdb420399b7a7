/* MuJoCo in time: Newton's solver with pyramids, as it comes, and with elliptic cones, at the ratio
 * of impedances of friction and normal that it has by default and at 100, which creeps less. One
 * thread, warm starts, no sleep, Euler's integrator; contacts as soft as they come.
 *
 * Its convex relaxation of Coulomb's law lifts what slides: a cube at 5 m/s hops, turns and tumbles.
 * A box a fifth as high hops and does not turn; it stops within 0.4 % of its way, which is what
 * Euler's rule leaves. */
#include "engine.h"

#include <mujoco/mujoco.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PYRAMID, CONE, CONE_100 };

typedef struct mujoco_world {
    mjModel *model;
    mjData *data;
    double dt;
} mujoco_world;

static void copy(double *to, const double *from, size_t count)
{
    memcpy(to, from, count * sizeof *to);
}

/* A plane is that of z = 0, turned and moved. */
static void place_plane(mjsBody *body, mjsGeom *geom, const double *n)
{
    mju_quatZ2Vec(body->quat, n);
    mju_scl3(body->pos, n, n[3]);
    geom->size[0] = geom->size[1] = geom->size[2] = 1.0; /* as it is drawn */
}

static void add_body(mjSpec *spec, const engine_body *from, double friction)
{
    static const int types[] = {
        [PEER_SPHERE] = mjGEOM_SPHERE, [PEER_BOX] = mjGEOM_BOX, [PEER_PLANE] = mjGEOM_PLANE};
    mjsBody *body = mjs_addBody(mjs_findBody(spec, "world"), NULL);
    mjsGeom *geom = mjs_addGeom(body, NULL);
    geom->type = (mjtGeom)types[from->kind];
    geom->friction[0] = friction;
    if (from->kind == PEER_PLANE) {
        place_plane(body, geom, from->size);
        return;
    }
    copy(geom->size, from->size, 3);
    copy(body->pos, from->position, 3);
    copy(body->quat, from->orientation, 4);
    if (from->mass > 0.0) {
        body->explicitinertial = 1;
        body->mass = from->mass;
        copy(body->inertia, from->inertia, 3);
        mjs_addFreeJoint(body);
    }
}

static mjModel *make_model(const engine_scene *from, int choice)
{
    mjSpec *spec = mj_makeSpec();
    spec->memory = (mjtSize)from->count * 200000 + 20000000;
    spec->option.timestep = from->dt;
    copy(spec->option.gravity, from->gravity, 3);
    spec->option.solver = mjSOL_NEWTON;
    spec->option.cone = choice == PYRAMID ? mjCONE_PYRAMIDAL : mjCONE_ELLIPTIC;
    spec->option.impratio = choice == CONE_100 ? 100.0 : 1.0;
    for (int i = 0; i < from->count; i++) {
        add_body(spec, &from->bodies[i], from->friction);
    }
    mjModel *model = mj_compile(spec, NULL);
    mj_deleteSpec(spec);
    return model;
}

static void *make(const engine_scene *from, int choice)
{
    mujoco_world *w = calloc(1, sizeof *w);
    if (w == NULL) {
        return NULL;
    }
    w->dt = from->dt;
    w->model = make_model(from, choice);
    w->data = w->model != NULL ? mj_makeData(w->model) : NULL;
    if (w->data == NULL) {
        mj_deleteModel(w->model);
        free(w);
        return NULL;
    }
    for (int i = 0; i < from->count; i++) {
        if (from->bodies[i].mass > 0.0) {
            const int joint = w->model->body_jntadr[i + 1];
            copy(w->data->qvel + w->model->jnt_dofadr[joint], from->bodies[i].velocity, 3);
        }
    }
    return w;
}

static void step(void *data, int watched)
{
    const mujoco_world *w = data;
    (void)watched;
    mj_step(w->model, w->data);
}

/* It goes on without the contacts that it found no room for, and starts anew from what is no
 * number: neither is an answer. */
static int has_failed(const mjData *data)
{
    return data->warning[mjWARN_CONTACTFULL].number + data->warning[mjWARN_CNSTRFULL].number +
               data->warning[mjWARN_BADQPOS].number + data->warning[mjWARN_BADQVEL].number +
               data->warning[mjWARN_BADQACC].number >
           0;
}

static void state(void *data, int i, engine_state *out)
{
    const mujoco_world *w = data;
    const int joint = w->model->body_jntadr[i + 1];
    const double *x = w->data->qpos + w->model->jnt_qposadr[joint];
    const double *v = w->data->qvel + w->model->jnt_dofadr[joint];
    copy(out->position, x, 3);
    copy(out->orientation, x + 3, 4);
    copy(out->velocity, v, 3);
    mju_rotVecQuat(out->angular_velocity, v + 3, x + 3);
    if (has_failed(w->data)) {
        out->position[0] = (double)NAN;
    }
}

/* The normal of MuJoCo points from the first geometry to the second, on which its force acts.
 * Positions are those of the beginning of the step: of what was solved. Body i + 1 has geometry
 * i. */
static void put_contact(const mujoco_world *w, int i, engine_contact *out)
{
    const mjContact *from = &w->data->contact[i];
    mjtNum force[6];
    mj_contactForce(w->model, w->data, i, force);
    out->a = from->geom[1];
    out->b = from->geom[0];
    out->gap = from->dist;
    copy(out->normal, from->frame, 3);
    mju_sub3(out->arm_a, from->pos, w->data->xipos + 3 * (out->a + 1));
    mju_sub3(out->arm_b, from->pos, w->data->xipos + 3 * (out->b + 1));
    mju_mulMatTVec3(out->impulse, from->frame, force);
    mju_scl3(out->impulse, out->impulse, w->dt);
}

static int contacts(void *data, int room, engine_contact *out)
{
    const mujoco_world *w = data;
    for (int i = 0; i < w->data->ncon && i < room; i++) {
        put_contact(w, i, &out[i]);
    }
    return w->data->ncon;
}

static void drop(void *data)
{
    mujoco_world *w = data;
    mj_deleteData(w->data);
    mj_deleteModel(w->model);
    free(w);
}

static void ignore(const char *message)
{
    (void)message;
}

const engine *engine_list(int *count)
{
    static const engine list[] = {
        {"MuJoCo", "pyramid", PYRAMID, 0, make, step, state, contacts, drop},
        {"MuJoCo", "cone", CONE, 0, make, step, state, contacts, drop},
        {"MuJoCo", "cone, ratio 100", CONE_100, 0, make, step, state, contacts, drop},
    };
    mju_user_warning = ignore;
    *count = (int)(sizeof list / sizeof list[0]);
    return list;
}
