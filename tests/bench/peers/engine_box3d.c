/* Box3D in time: 4 sub-steps, as it comes, fewer and more. One thread, no sleep. It has no
 * half-spaces: a plane is a great box. It does not tell impulses of points: of a manifold it has
 * one for friction, with a torque, and those along the normal are of the last sub-step. */
#include "engine.h"

#include <box3d/box3d.h>

#include <stdlib.h>

typedef struct box3d_world {
    b3WorldId world;
    b3BodyId *bodies;
    float dt;
    int choice; /* sub-steps */
} box3d_world;

static b3Vec3 vector(const double *v)
{
    const b3Vec3 out = {(float)v[0], (float)v[1], (float)v[2]};
    return out;
}

/* The rotation that takes z to n. */
static b3Quat turn_to(const double *n)
{
    const b3Vec3 z = {0.0f, 0.0f, 1.0f};
    return b3ComputeQuatBetweenUnitVectors(z, vector(n));
}

static void add_plane(const engine_body *from, b3BodyId body, const b3ShapeDef *shape)
{
    const b3Vec3 half = {200.0f, 200.0f, 5.0f};
    const double *n = from->size;
    const float d = (float)n[3] - half.z;
    b3Transform pose;
    pose.q = turn_to(n);
    pose.p = (b3Vec3){d * (float)n[0], d * (float)n[1], d * (float)n[2]};
    const b3BoxHull box = b3MakeTransformedBoxHull(half.x, half.y, half.z, pose);
    b3CreateHullShape(body, shape, &box.base);
}

static void add_shape(const engine_body *from, b3BodyId body, const b3ShapeDef *shape)
{
    if (from->kind == PEER_SPHERE) {
        const b3Sphere sphere = {{0.0f, 0.0f, 0.0f}, (float)from->size[0]};
        b3CreateSphereShape(body, shape, &sphere);
    } else if (from->kind == PEER_BOX) {
        const b3BoxHull box =
            b3MakeBoxHull((float)from->size[0], (float)from->size[1], (float)from->size[2]);
        b3CreateHullShape(body, shape, &box.base);
    } else {
        add_plane(from, body, shape);
    }
}

static b3BodyId add_body(b3WorldId world, const engine_body *from, double friction)
{
    b3BodyDef def = b3DefaultBodyDef();
    b3ShapeDef shape = b3DefaultShapeDef();
    const double *q = from->orientation;
    const double *x = from->position;
    shape.baseMaterial.friction = (float)friction;
    shape.density = 1.0f;
    def.type = from->mass > 0.0 ? b3_dynamicBody : b3_staticBody;
    def.position = (b3Pos){(float)x[0], (float)x[1], (float)x[2]};
    def.rotation = (b3Quat){{(float)q[1], (float)q[2], (float)q[3]}, (float)q[0]};
    def.linearVelocity = vector(from->velocity);
    def.enableSleep = false;
    const b3BodyId body = b3CreateBody(world, &def);
    add_shape(from, body, &shape);
    if (from->mass > 0.0) {
        b3MassData mass = b3Body_GetMassData(body);
        mass.mass = (float)from->mass;
        mass.inertia.cx.x = (float)from->inertia[0];
        mass.inertia.cy.y = (float)from->inertia[1];
        mass.inertia.cz.z = (float)from->inertia[2];
        b3Body_SetMassData(body, mass);
    }
    return body;
}

static void *make(const engine_scene *from, int choice)
{
    box3d_world *w = calloc(1, sizeof *w);
    b3WorldDef def = b3DefaultWorldDef();
    if (w == NULL) {
        return NULL;
    }
    def.gravity = vector(from->gravity);
    def.enableSleep = false;
    def.workerCount = 1;
    w->world = b3CreateWorld(&def);
    w->bodies = calloc((size_t)from->count, sizeof *w->bodies);
    w->dt = (float)from->dt;
    w->choice = choice;
    for (int i = 0; w->bodies != NULL && i < from->count; i++) {
        w->bodies[i] = add_body(w->world, &from->bodies[i], from->friction);
    }
    return w;
}

static void step(void *data, int watched)
{
    (void)watched;
    const box3d_world *w = data;
    b3World_Step(w->world, w->dt, w->choice);
}

static void state(void *data, int i, engine_state *out)
{
    const box3d_world *w = data;
    const b3Pos x = b3Body_GetPosition(w->bodies[i]);
    const b3Quat q = b3Body_GetRotation(w->bodies[i]);
    const b3Vec3 v = b3Body_GetLinearVelocity(w->bodies[i]);
    const b3Vec3 o = b3Body_GetAngularVelocity(w->bodies[i]);
    const engine_state found = {{(double)x.x, (double)x.y, (double)x.z},
                                {(double)q.s, (double)q.v.x, (double)q.v.y, (double)q.v.z},
                                {(double)v.x, (double)v.y, (double)v.z},
                                {(double)o.x, (double)o.y, (double)o.z}};
    *out = found;
}

static void drop(void *data)
{
    box3d_world *w = data;
    b3DestroyWorld(w->world);
    free(w->bodies);
    free(w);
}

const engine *engine_list(int *count)
{
    static const engine list[] = {
        {"Box3D", "1 sub-step", 1, 1, make, step, state, NULL, drop},
        {"Box3D", "4 sub-steps", 4, 1, make, step, state, NULL, drop},
        {"Box3D", "16 sub-steps", 16, 1, make, step, state, NULL, drop},
    };
    *count = (int)(sizeof list / sizeof list[0]);
    return list;
}
