// Bullet: the algorithm that its dispatcher chooses for a pair, with an empty manifold each time.
// Once as it comes, with a collision margin of 0.04 around hulls and rounded edges, and once
// without margins, so that its shapes are those that were meant. And its broad phase, the tree.
#include "peer.h"

#include <btBulletCollisionCommon.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace
{

btDefaultCollisionConfiguration *const configuration = new btDefaultCollisionConfiguration;
btCollisionDispatcher *const dispatcher = new btCollisionDispatcher(configuration);

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

// ---- the broad phase

struct bullet_broad {
    btDbvtBroadphase tree;
    std::vector<btBroadphaseProxy *> proxies;
};

// Single precision rounds: outwards, so that no overlap is lost.
btVector3 corner(const double *box, double side)
{
    btScalar c[3];
    for (int k = 0; k < 3; k++) {
        c[k] = btScalar(box[k]);
        if (side * (double(c[k]) - box[k]) < 0.0) {
            c[k] = std::nextafter(c[k], btScalar(side * 1e30));
        }
    }
    return btVector3(c[0], c[1], c[2]);
}

void *make_broad(unsigned count, const double *boxes)
{
    bullet_broad *broad = new bullet_broad;
    for (unsigned i = 0; i < count; i++) {
        const double *box = boxes + 6 * i;
        broad->proxies.push_back(broad->tree.createProxy(
            corner(box, -1.0), corner(box + 3, 1.0), BOX_SHAPE_PROXYTYPE,
            reinterpret_cast<void *>(std::uintptr_t(i)), 1, -1, dispatcher));
    }
    return broad;
}

bool overlap(const double *a, const double *b)
{
    return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] &&
           b[2] <= a[5];
}

// Bullet keeps pairs whose enlarged boxes overlap, or did: they are judged by the boxes.
unsigned long step_broad(void *data, const double *boxes)
{
    bullet_broad *broad = static_cast<bullet_broad *>(data);
    unsigned long found = 0;
    for (std::size_t i = 0; i < broad->proxies.size(); i++) {
        const double *box = boxes + 6 * i;
        broad->tree.setAabb(broad->proxies[i], corner(box, -1.0), corner(box + 3, 1.0), dispatcher);
    }
    broad->tree.calculateOverlappingPairs(dispatcher);
    const btBroadphasePairArray &pairs =
        broad->tree.getOverlappingPairCache()->getOverlappingPairArray();
    for (int k = 0; k < pairs.size(); k++) {
        const std::uintptr_t a = std::uintptr_t(pairs[k].m_pProxy0->m_clientObject);
        const std::uintptr_t b = std::uintptr_t(pairs[k].m_pProxy1->m_clientObject);
        found += overlap(boxes + 6 * a, boxes + 6 * b) ? 1 : 0;
    }
    return found;
}

void drop_broad(void *data)
{
    bullet_broad *broad = static_cast<bullet_broad *>(data);
    for (btBroadphaseProxy *proxy : broad->proxies) {
        broad->tree.destroyProxy(proxy, dispatcher);
    }
    delete broad;
}

} // namespace

const peer_broad peer_broad_phase = {"Bullet", make_broad, step_broad, drop_broad};

const peer *peer_list(int *count)
{
    static const peer list[] = {
        {"Bullet", sizeof(btScalar) == 4, make_as_it_comes, ask_pair, drop_pair},
        {"Bullet, margin 0", sizeof(btScalar) == 4, make_without_margins, ask_pair, drop_pair}};
    *count = 2;
    return list;
}
