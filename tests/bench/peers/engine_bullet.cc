// Bullet in time: the sequential-impulse solver with 10, 50 and 200 iterations, each with one
// friction direction, as it comes, and with two; and Dantzig's solver. No sleep, no damping.
#include "engine.h"

#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace
{

enum { TWO_DIRECTIONS = 1000, DANTZIG = 0 };

btVector3 vector(const double *v)
{
    return btVector3(btScalar(v[0]), btScalar(v[1]), btScalar(v[2]));
}

struct bullet_world {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broad;
    btSequentialImpulseConstraintSolver sequential;
    btDantzigSolver dantzig;
    btMLCPSolver exact{&dantzig};
    std::unique_ptr<btDiscreteDynamicsWorld> world;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<btVector3> centers; // before a watched step
    bool two_directions = false; // of friction
    btScalar dt;
};

btCollisionShape *make_shape(const engine_body &from)
{
    switch (from.kind) {
    case PEER_SPHERE:
        return new btSphereShape(btScalar(from.size[0]));
    case PEER_BOX:
        return new btBoxShape(vector(from.size));
    default:
        return new btStaticPlaneShape(vector(from.size), btScalar(from.size[3]));
    }
}

void add_body(bullet_world *w, const engine_body &from, double friction)
{
    btCollisionShape *shape = make_shape(from);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(from.mass), nullptr, shape,
                                                  vector(from.inertia));
    const double *q = from.orientation;
    info.m_startWorldTransform =
        btTransform(btQuaternion(btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0])),
                    vector(from.position));
    /* Bullet multiplies the coefficients of two bodies. */
    info.m_friction = btSqrt(btScalar(friction));
    w->shapes.emplace_back(shape);
    w->bodies.emplace_back(new btRigidBody(info));
    w->bodies.back()->setLinearVelocity(vector(from.velocity));
    w->bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    w->bodies.back()->setUserIndex(int(w->bodies.size()) - 1);
    w->world->addRigidBody(w->bodies.back().get());
}

void *make(const engine_scene *from, int choice)
{
    bullet_world *w = new bullet_world;
    btConstraintSolver *solver =
        choice == DANTZIG ? static_cast<btConstraintSolver *>(&w->exact) : &w->sequential;
    w->world.reset(
        new btDiscreteDynamicsWorld(&w->dispatcher, &w->broad, solver, &w->configuration));
    w->world->setGravity(vector(from->gravity));
    btContactSolverInfo &info = w->world->getSolverInfo();
    if (choice != DANTZIG) {
        info.m_numIterations = choice % TWO_DIRECTIONS;
    } else {
        info.m_minimumSolverBatchSize = 1; /* its manual's advice for such solvers */
    }
    w->two_directions = choice >= TWO_DIRECTIONS;
    if (w->two_directions) {
        info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    }
    w->dt = btScalar(from->dt);
    for (int i = 0; i < from->count; i++) {
        add_body(w, from->bodies[i], from->friction);
    }
    return w;
}

void step(void *data, int watched)
{
    bullet_world *w = static_cast<bullet_world *>(data);
    if (watched) {
        w->centers.resize(w->bodies.size());
        for (std::size_t i = 0; i < w->bodies.size(); i++) {
            w->centers[i] = w->bodies[i]->getWorldTransform().getOrigin();
        }
    }
    w->world->stepSimulation(w->dt, 0);
}

void copy(const btVector3 &from, double *to)
{
    for (int k = 0; k < 3; k++) {
        to[k] = double(from[k]);
    }
}

void put_contact(const bullet_world *w, const btPersistentManifold *manifold,
                 const btManifoldPoint &point, engine_contact *out)
{
    out->a = manifold->getBody0()->getUserIndex();
    out->b = manifold->getBody1()->getUserIndex();
    out->gap = double(point.getDistance());
    copy(point.m_normalWorldOnB, out->normal);
    copy(point.getPositionWorldOnA() - w->centers[std::size_t(out->a)], out->arm_a);
    copy(point.getPositionWorldOnB() - w->centers[std::size_t(out->b)], out->arm_b);
    btVector3 impulse = point.m_appliedImpulse * point.m_normalWorldOnB +
                        point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1;
    if (w->two_directions) {
        impulse += point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
    }
    copy(impulse, out->impulse);
}

int contacts(void *data, int room, engine_contact *out)
{
    bullet_world *w = static_cast<bullet_world *>(data);
    int count = 0;
    for (int i = 0; i < w->dispatcher.getNumManifolds(); i++) {
        const btPersistentManifold *manifold = w->dispatcher.getManifoldByIndexInternal(i);
        for (int k = 0; k < manifold->getNumContacts(); k++) {
            if (count < room) {
                put_contact(w, manifold, manifold->getContactPoint(k), &out[count]);
            }
            count++;
        }
    }
    return count;
}

void state(void *data, int i, engine_state *out)
{
    const btRigidBody *body = static_cast<bullet_world *>(data)->bodies[std::size_t(i)].get();
    const btQuaternion q = body->getWorldTransform().getRotation();
    const double turn[4] = {double(q.w()), double(q.x()), double(q.y()), double(q.z())};
    for (int k = 0; k < 4; k++) {
        out->orientation[k] = turn[k];
    }
    for (int k = 0; k < 3; k++) {
        out->position[k] = double(body->getWorldTransform().getOrigin()[k]);
        out->velocity[k] = double(body->getLinearVelocity()[k]);
        out->angular_velocity[k] = double(body->getAngularVelocity()[k]);
    }
}

void drop(void *data)
{
    bullet_world *w = static_cast<bullet_world *>(data);
    for (const std::unique_ptr<btRigidBody> &body : w->bodies) {
        w->world->removeRigidBody(body.get());
    }
    w->world.reset();
    delete w;
}

} // namespace

const engine *engine_list(int *count)
{
    enum { SINGLE = sizeof(btScalar) == 4 };
    static const engine list[] = {
        {"Bullet", "SI 10", 10, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "SI 50", 50, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "SI 200", 200, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "SI 10, 2 dirs", TWO_DIRECTIONS + 10, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "SI 50, 2 dirs", TWO_DIRECTIONS + 50, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "SI 200, 2 dirs", TWO_DIRECTIONS + 200, SINGLE, make, step, state, contacts, drop},
        {"Bullet", "Dantzig", DANTZIG, SINGLE, make, step, state, contacts, drop},
    };
    *count = int(sizeof list / sizeof list[0]);
    return list;
}
