/* The Open Dynamics Engine in time: dSpaceCollide, dWorldQuickStep and dWorldStep, with what its
 * manual and its users set: CFM of double precision, no depth left alone, friction by pyramids. */
#include "engine.h"

#include <ode/ode.h>

#include <math.h>
#include <stdlib.h>

enum { MOST_CONTACTS = 8 };

typedef struct ode_world {
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies;
    double dt, friction;
    int choice; /* iterations of dWorldQuickStep; 0: dWorldStep */
    int failed; /* a step found no memory, and did nothing */
} ode_world;

static void meet(void *data, dGeomID a, dGeomID b)
{
    ode_world *w = data;
    dContact contacts[MOST_CONTACTS];
    if (dGeomGetBody(a) == 0 && dGeomGetBody(b) == 0) {
        return;
    }
    const int count = dCollide(a, b, MOST_CONTACTS, &contacts[0].geom, (int)sizeof contacts[0]);
    for (int i = 0; i < count; i++) {
        contacts[i].surface.mode = dContactApprox1;
        contacts[i].surface.mu = (dReal)w->friction;
        dJointAttach(dJointCreateContact(w->world, w->joints, &contacts[i]), dGeomGetBody(a),
                     dGeomGetBody(b));
    }
}

static dGeomID make_geom(ode_world *w, const engine_body *from)
{
    const double *s = from->size;
    switch (from->kind) {
    case PEER_SPHERE:
        return dCreateSphere(w->space, (dReal)s[0]);
    case PEER_BOX:
        return dCreateBox(w->space, (dReal)(2.0 * s[0]), (dReal)(2.0 * s[1]), (dReal)(2.0 * s[2]));
    default:
        return dCreatePlane(w->space, (dReal)s[0], (dReal)s[1], (dReal)s[2], (dReal)s[3]);
    }
}

static void add_body(ode_world *w, const engine_body *from, dBodyID *body)
{
    const double *x = from->position;
    const double *v = from->velocity;
    const double *q = from->orientation;
    const dQuaternion turn = {(dReal)q[0], (dReal)q[1], (dReal)q[2], (dReal)q[3]};
    dGeomID geom = make_geom(w, from);
    dMass mass;
    if (!(from->mass > 0.0)) {
        return;
    }
    *body = dBodyCreate(w->world);
    dMassSetParameters(&mass, (dReal)from->mass, 0, 0, 0, (dReal)from->inertia[0],
                       (dReal)from->inertia[1], (dReal)from->inertia[2], 0, 0, 0);
    dBodySetMass(*body, &mass);
    dGeomSetBody(geom, *body);
    dBodySetPosition(*body, (dReal)x[0], (dReal)x[1], (dReal)x[2]);
    dBodySetQuaternion(*body, turn);
    dBodySetLinearVel(*body, (dReal)v[0], (dReal)v[1], (dReal)v[2]);
}

static void *make(const engine_scene *from, int choice)
{
    ode_world *w = calloc(1, sizeof *w);
    if (w == NULL) {
        return NULL;
    }
    w->bodies = calloc((size_t)from->count, sizeof *w->bodies);
    w->world = dWorldCreate();
    w->space = dHashSpaceCreate(0);
    w->joints = dJointGroupCreate(0);
    w->dt = from->dt;
    w->friction = from->friction;
    w->choice = choice;
    dWorldSetGravity(w->world, (dReal)from->gravity[0], (dReal)from->gravity[1],
                     (dReal)from->gravity[2]);
    if (choice > 0) {
        dWorldSetQuickStepNumIterations(w->world, choice);
    }
    for (int i = 0; w->bodies != NULL && i < from->count; i++) {
        add_body(w, &from->bodies[i], &w->bodies[i]);
    }
    return w;
}

static void step(void *data)
{
    ode_world *w = data;
    dSpaceCollide(w->space, w, meet);
    const int done = w->choice > 0 ? dWorldQuickStep(w->world, (dReal)w->dt)
                                   : dWorldStep(w->world, (dReal)w->dt);
    w->failed = w->failed || done == 0;
    dJointGroupEmpty(w->joints);
}

static void state(void *data, int i, engine_state *out)
{
    const ode_world *w = data;
    const dReal *x = dBodyGetPosition(w->bodies[i]);
    const dReal *q = dBodyGetQuaternion(w->bodies[i]);
    const dReal *v = dBodyGetLinearVel(w->bodies[i]);
    const dReal *o = dBodyGetAngularVel(w->bodies[i]);
    for (int k = 0; k < 4; k++) {
        out->orientation[k] = (double)q[k];
    }
    for (int k = 0; k < 3; k++) {
        out->position[k] = w->failed ? (double)NAN : (double)x[k];
        out->velocity[k] = (double)v[k];
        out->angular_velocity[k] = (double)o[k];
    }
}

static void drop(void *data)
{
    ode_world *w = data;
    dJointGroupDestroy(w->joints);
    dSpaceDestroy(w->space);
    dWorldDestroy(w->world);
    free(w->bodies);
    free(w);
}

static void ignore(int number, const char *message, va_list values)
{
    (void)number;
    (void)message;
    (void)values;
}

const engine *engine_list(int *count)
{
    enum { SINGLE = sizeof(dReal) == 4 };
    static const engine list[] = {
        {"ODE", "QuickStep 20", 20, SINGLE, make, step, state, drop},
        {"ODE", "QuickStep 50", 50, SINGLE, make, step, state, drop},
        {"ODE", "QuickStep 200", 200, SINGLE, make, step, state, drop},
        {"ODE", "dWorldStep", 0, SINGLE, make, step, state, drop},
    };
    dInitODE();
    dSetMessageHandler(ignore);
    *count = (int)(sizeof list / sizeof list[0]);
    return list;
}
