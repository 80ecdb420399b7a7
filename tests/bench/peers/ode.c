/* The Open Dynamics Engine: dCollide, which calls libccd for what it has no code of its own for. */
#include "peer.h"

#include <ode/ode.h>

#include <stdlib.h>
#include <string.h>

enum { MOST_CONTACTS = 8 };

/* What ODE keeps pointers to of a convex. */
typedef struct ode_hull {
    dReal *planes;
    dReal *points;
    unsigned *polygons;
} ode_hull;

typedef struct ode_pair {
    dGeomID geoms[2];
    ode_hull hulls[2];
} ode_pair;

static dGeomID make_convex(const peer_shape *shape, ode_hull *hull)
{
    const size_t faces = (size_t)shape->faces;
    const size_t vertices = (size_t)shape->vertices;
    hull->planes = calloc(4 * faces, sizeof *hull->planes);
    hull->points = calloc(3 * vertices, sizeof *hull->points);
    hull->polygons = calloc(4 * faces, sizeof *hull->polygons);
    if (hull->planes == NULL || hull->points == NULL || hull->polygons == NULL) {
        return 0;
    }
    for (size_t i = 0; i < 3 * vertices; i++) {
        hull->points[i] = (dReal)shape->vertex[i / 3][i % 3];
    }
    for (size_t f = 0; f < faces; f++) {
        const double *n = shape->normal[f];
        const double *p = shape->vertex[shape->corner[f][0]];
        hull->polygons[4 * f] = 3;
        for (size_t c = 0; c < 3; c++) {
            hull->planes[4 * f + c] = (dReal)n[c];
            hull->polygons[4 * f + 1 + c] = (unsigned)shape->corner[f][c];
        }
        hull->planes[4 * f + 3] = (dReal)(n[0] * p[0] + n[1] * p[1] + n[2] * p[2]);
    }
    return dCreateConvex(0, hull->planes, (unsigned)faces, hull->points, (unsigned)vertices,
                         hull->polygons);
}

static dGeomID make_geom(const peer_shape *shape, ode_hull *hull)
{
    const double *s = shape->size;
    switch (shape->kind) {
    case PEER_SPHERE:
        return dCreateSphere(0, (dReal)s[0]);
    case PEER_BOX:
        return dCreateBox(0, (dReal)(2.0 * s[0]), (dReal)(2.0 * s[1]), (dReal)(2.0 * s[2]));
    case PEER_CAPSULE:
        return dCreateCapsule(0, (dReal)s[0], (dReal)(2.0 * s[1]));
    case PEER_CYLINDER:
        return dCreateCylinder(0, (dReal)s[0], (dReal)(2.0 * s[1]));
    case PEER_HULL:
        return make_convex(shape, hull);
    case PEER_PLANE:
        return dCreatePlane(0, (dReal)s[0], (dReal)s[1], (dReal)s[2], (dReal)s[3]);
    default:
        return 0;
    }
}

static void drop_pair(void *data)
{
    ode_pair *pair = data;
    for (int i = 0; i < 2; i++) {
        if (pair->geoms[i] != 0) {
            dGeomDestroy(pair->geoms[i]);
        }
        free(pair->hulls[i].planes);
        free(pair->hulls[i].points);
        free(pair->hulls[i].polygons);
    }
    free(pair);
}

static void *make_pair(const peer_shape shapes[2])
{
    ode_pair *pair = calloc(1, sizeof *pair);
    for (int i = 0; i < 2 && pair != NULL; i++) {
        const double *p = shapes[i].position;
        const double *q = shapes[i].orientation;
        const dQuaternion turn = {(dReal)q[0], (dReal)q[1], (dReal)q[2], (dReal)q[3]};
        pair->geoms[i] = make_geom(&shapes[i], &pair->hulls[i]);
        if (pair->geoms[i] == 0) {
            drop_pair(pair);
            return NULL;
        }
        if (shapes[i].kind != PEER_PLANE) {
            dGeomSetPosition(pair->geoms[i], (dReal)p[0], (dReal)p[1], (dReal)p[2]);
            dGeomSetQuaternion(pair->geoms[i], turn);
        }
    }
    return pair;
}

/* ODE's normal points into its first body. */
static void ask_pair(void *data, peer_answer *out)
{
    const ode_pair *pair = data;
    dContactGeom contacts[MOST_CONTACTS];
    const int count =
        dCollide(pair->geoms[0], pair->geoms[1], MOST_CONTACTS, contacts, (int)sizeof contacts[0]);
    out->points = count;
    out->depth = -1.0;
    for (int k = 0; k < count; k++) {
        if ((double)contacts[k].depth > out->depth) {
            out->depth = (double)contacts[k].depth;
            for (int c = 0; c < 3; c++) {
                out->normal[c] = (double)contacts[k].normal[c];
            }
        }
    }
}

const peer *peer_list(int *count)
{
    static const peer list[] = {
        {"ODE dCollide", sizeof(dReal) == 4, make_pair, ask_pair, drop_pair}};
    dInitODE();
    *count = 1;
    return list;
}
