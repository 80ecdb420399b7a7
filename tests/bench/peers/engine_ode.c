/* The Open Dynamics Engine in time: dSpaceCollide, dWorldQuickStep and dWorldStep as they come: CFM
 * and ERP of its precision, no depth left alone, friction by pyramids; and dWorldStep with the CFM
 * of single precision, for a matrix without it is singular where contacts are more than enough.
 * Contacts are made anew in each step, and it is built without warm starts: it has none. */
#include "engine.h"

#include <ode/ode.h>

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CONTACTS = 8, WORLD_STEP = 0, WORLD_STEP_SOFT = -1 };

static const dReal soft_cfm = (dReal)1e-5;

/* A contact of a watched step. */
typedef struct watched_contact {
    engine_contact contact;
    dJointID joint;
    dJointFeedback feedback;
} watched_contact;

typedef struct ode_world {
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies;
    double dt, friction;
    int choice; /* iterations of dWorldQuickStep, or WORLD_STEP... */
    int failed; /* a step found no memory, and did nothing */
    int watched;
    watched_contact *list; /* of the last watched step */
    int count, room;
} ode_world;

/* The arm from a body, if there is one, to a point. */
static void put_arm(dBodyID body, const dReal *point, double arm[3])
{
    for (int k = 0; k < 3; k++) {
        arm[k] = (double)point[k] - (body ? (double)dBodyGetPosition(body)[k] : 0.0);
    }
}

static void watch(ode_world *w, const dContactGeom *geom, dJointID joint)
{
    if (w->count == w->room) {
        const int room = 2 * w->room + 64;
        watched_contact *list = realloc(w->list, (size_t)room * sizeof *list);
        if (list == NULL) {
            return;
        }
        w->list = list;
        w->room = room;
    }
    watched_contact *at = &w->list[w->count++];
    memset(at, 0, sizeof *at);
    at->joint = joint;
    at->contact.a = (int)(intptr_t)dGeomGetData(geom->g1);
    at->contact.b = (int)(intptr_t)dGeomGetData(geom->g2);
    at->contact.gap = -(double)geom->depth;
    put_arm(dGeomGetBody(geom->g1), geom->pos, at->contact.arm_a);
    put_arm(dGeomGetBody(geom->g2), geom->pos, at->contact.arm_b);
    for (int k = 0; k < 3; k++) {
        at->contact.normal[k] = (double)geom->normal[k];
    }
}

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
        const dJointID joint = dJointCreateContact(w->world, w->joints, &contacts[i]);
        dJointAttach(joint, dGeomGetBody(contacts[i].geom.g1), dGeomGetBody(contacts[i].geom.g2));
        if (w->watched) {
            watch(w, &contacts[i].geom, joint);
        }
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

static void add_body(ode_world *w, const engine_body *from, int number)
{
    dBodyID *body = &w->bodies[number];
    const double *x = from->position;
    const double *v = from->velocity;
    const double *q = from->orientation;
    const dQuaternion turn = {(dReal)q[0], (dReal)q[1], (dReal)q[2], (dReal)q[3]};
    dGeomID geom = make_geom(w, from);
    dMass mass;
    dGeomSetData(geom, (void *)(intptr_t)number);
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
    } else if (choice == WORLD_STEP_SOFT) {
        dWorldSetCFM(w->world, soft_cfm);
    }
    for (int i = 0; w->bodies != NULL && i < from->count; i++) {
        add_body(w, &from->bodies[i], i);
    }
    return w;
}

static void step(void *data, int watched)
{
    ode_world *w = data;
    w->watched = watched;
    w->count = 0;
    dSpaceCollide(w->space, w, meet);
    for (int i = 0; i < w->count; i++) {
        dJointSetFeedback(w->list[i].joint, &w->list[i].feedback);
    }
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

/* What acts on the first body of a joint: the only one, if the other is the world. */
static int contacts(void *data, int room, engine_contact *out)
{
    const ode_world *w = data;
    for (int i = 0; i < w->count && i < room; i++) {
        const watched_contact *at = &w->list[i];
        const double sign = w->bodies[at->contact.a] ? w->dt : -w->dt;
        out[i] = at->contact;
        for (int k = 0; k < 3; k++) {
            out[i].impulse[k] = sign * (double)at->feedback.f1[k];
        }
    }
    return w->count;
}

static void drop(void *data)
{
    ode_world *w = data;
    dJointGroupDestroy(w->joints);
    dSpaceDestroy(w->space);
    dWorldDestroy(w->world);
    free(w->bodies);
    free(w->list);
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
        {"ODE", "QuickStep 20", 20, SINGLE, make, step, state, contacts, drop},
        {"ODE", "QuickStep 50", 50, SINGLE, make, step, state, contacts, drop},
        {"ODE", "QuickStep 200", 200, SINGLE, make, step, state, contacts, drop},
        {"ODE", "dWorldStep", WORLD_STEP, SINGLE, make, step, state, contacts, drop},
        {"ODE", "Step, CFM 1e-5", WORLD_STEP_SOFT, SINGLE, make, step, state, contacts, drop},
    };
    dInitODE();
    dSetMessageHandler(ignore);
    *count = (int)(sizeof list / sizeof list[0]);
    return list;
}
