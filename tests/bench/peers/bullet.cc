// Bullet: the algorithm that its dispatcher chooses for a pair, with an empty manifold each time.
// Once as it comes, with a collision margin of 0.04 around hulls and rounded edges, and once
// without margins, so that its shapes are those that were meant.
#include "peer.h"

#include <btBulletCollisionCommon.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

namespace
{

btDefaultCollisionConfiguration *configuration;
btCollisionDispatcher *dispatcher;

struct bullet_pair {
    btCollisionObject objects[2];
    btCollisionShape *shapes[2] = {nullptr, nullptr};
    btCollisionAlgorithm *algorithm = nullptr;
};

btVector3 vector(const double *v)
{
    return btVector3(btScalar(v[0]), btScalar(v[1]), btScalar(v[2]));
}

btQuaternion quaternion(const double *q)
{
    return btQuaternion(btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0]));
}

btCollisionShape *make_hull(const peer_shape &shape, bool margins)
{
    btConvexHullShape *hull = new btConvexHullShape;
    for (int i = 0; i < shape.vertices; i++) {
        hull->addPoint(vector(shape.vertex[i]), false);
    }
    hull->recalcLocalAabb();
    if (!margins) {
        hull->setMargin(0);
    }
    hull->initializePolyhedralFeatures(); // without them there is one point for each pair
    return hull;
}

btCollisionShape *make_shape(const peer_shape &shape, bool margins)
{
    const btScalar r = btScalar(shape.size[0]);
    const btScalar h = btScalar(shape.size[1]);
    btConvexInternalShape *made = nullptr;
    switch (shape.kind) {
    case PEER_SPHERE:
        return new btSphereShape(r);
    case PEER_CAPSULE:
        return new btCapsuleShapeZ(r, 2 * h);
    case PEER_HULL:
        return make_hull(shape, margins);
    case PEER_PLANE:
        return new btStaticPlaneShape(vector(shape.size), btScalar(shape.size[3]));
    case PEER_BOX:
        made = new btBoxShape(vector(shape.size));
        break;
    case PEER_CYLINDER:
        made = new btCylinderShapeZ(btVector3(r, r, h));
        break;
    case PEER_CONE:
        made = new btConeShapeZ(r, 2 * h);
        break;
    default:
        return nullptr;
    }
    if (!margins) {
        made->setMargin(0);
    }
    return made;
}

void drop_pair(void *data)
{
    bullet_pair *pair = static_cast<bullet_pair *>(data);
    if (pair->algorithm != nullptr) {
        pair->algorithm->~btCollisionAlgorithm();
        dispatcher->freeCollisionAlgorithm(pair->algorithm);
    }
    delete pair->shapes[0];
    delete pair->shapes[1];
    delete pair;
}

void *make_pair(const peer_shape shapes[2], bool margins)
{
    bullet_pair *pair = new bullet_pair;
    for (int i = 0; i < 2; i++) {
        pair->shapes[i] = make_shape(shapes[i], margins);
        if (pair->shapes[i] == nullptr) {
            drop_pair(pair);
            return nullptr;
        }
        pair->objects[i].setCollisionShape(pair->shapes[i]);
        pair->objects[i].setWorldTransform(
            btTransform(quaternion(shapes[i].orientation), vector(shapes[i].position)));
    }
    btCollisionObject *o = pair->objects;
    const btCollisionObjectWrapper a(nullptr, pair->shapes[0], &o[0], o[0].getWorldTransform(), -1,
                                     -1);
    const btCollisionObjectWrapper b(nullptr, pair->shapes[1], &o[1], o[1].getWorldTransform(), -1,
                                     -1);
    pair->algorithm = dispatcher->findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    return pair;
}

void *make_as_it_comes(const peer_shape shapes[2])
{
    return make_pair(shapes, true);
}

void *make_without_margins(const peer_shape shapes[2])
{
    return make_pair(shapes, false);
}

void take_points(const bullet_pair *pair, const btPersistentManifold *manifold, peer_answer *out)
{
    const double sign = manifold->getBody0() == &pair->objects[0] ? 1.0 : -1.0;
    for (int k = 0; k < manifold->getNumContacts(); k++) {
        const btManifoldPoint &point = manifold->getContactPoint(k);
        const double depth = -double(point.getDistance());
        if (out->points == 0 || depth > out->depth) {
            out->depth = depth;
            for (int c = 0; c < 3; c++) {
                out->normal[c] = sign * double(point.m_normalWorldOnB[c]);
            }
        }
        out->points++;
    }
}

// A manifold holds what is near, too: only what touches is an answer.
void ask_pair(void *data, peer_answer *out)
{
    bullet_pair *pair = static_cast<bullet_pair *>(data);
    btCollisionObject *o = pair->objects;
    const btCollisionObjectWrapper a(nullptr, pair->shapes[0], &o[0], o[0].getWorldTransform(), -1,
                                     -1);
    const btCollisionObjectWrapper b(nullptr, pair->shapes[1], &o[1], o[1].getWorldTransform(), -1,
                                     -1);
    btDispatcherInfo info;
    btManifoldResult result(&a, &b);
    btManifoldArray manifolds;
    out->points = 0;
    pair->algorithm->getAllContactManifolds(manifolds);
    for (int i = 0; i < manifolds.size(); i++) {
        manifolds[i]->clearManifold();
    }
    pair->algorithm->processCollision(&a, &b, info, &result);
    manifolds.resizeNoInitialize(0);
    pair->algorithm->getAllContactManifolds(manifolds);
    for (int i = 0; i < manifolds.size(); i++) {
        take_points(pair, manifolds[i], out);
    }
    if (out->points > 0 && out->depth <= 0.0) {
        out->points = 0;
    }
}

} // namespace

const peer *peer_list(int *count)
{
    static const peer list[] = {
        {"Bullet", sizeof(btScalar) == 4, make_as_it_comes, ask_pair, drop_pair},
        {"Bullet, margin 0", sizeof(btScalar) == 4, make_without_margins, ask_pair, drop_pair}};
    configuration = new btDefaultCollisionConfiguration;
    dispatcher = new btCollisionDispatcher(configuration);
    *count = 2;
    return list;
}
