/* Depth of penetration of two convex bodies, found without the library and by other means than
 * its own: polytopes and their rounded kin by separating axes (Gottschalk 1996; edges paired by
 * their arcs on the sphere of normals, Gregorius 2013) and by the distances of all features;
 * sphere against all by the signed distance of a point; all else by directions spread over the
 * sphere and nested golden sections, which are safe because the width is convex in a tangent
 * plane.
 *
 * Errors: separating axes and distances to rounding. Golden sections leave 1e-9 of the size,
 * always upwards, and may settle in a local minimum that lies higher than the least: then the
 * test is lenient, never unjust. */
#ifndef TRIBO_TEST_TRUTH_H
#define TRIBO_TEST_TRUTH_H

#include <tribo/shape.h>

enum { TRUTH_VERTICES = 256, TRUTH_FACES = 2 * TRUTH_VERTICES, TRUTH_EDGES = 3 * TRUTH_VERTICES };

/* Convex polytope, or a segment or point, in its own axes. Edge k joins vertices edge[k][0] and
 * [1] and faces edge[k][2] and [3]; a lone segment has no faces. */
typedef struct truth_polytope {
    int vertices;
    int faces;
    int edges;
    double vertex[TRUTH_VERTICES][3];
    double across[3][TRUTH_VERTICES]; /* the same, all x before all y and z */
    double normal[TRUTH_FACES][3];
    int corner[TRUTH_FACES][4]; /* of a triangle or rectangle, -1 after the last */
    int edge[TRUTH_EDGES][4];
} truth_polytope;

/* A body: a polytope with all points within `radius` of it, or one of the curved shapes. */
typedef struct truth_body {
    uint32_t type; /* TRIBO_SHAPE_... */
    double size[3];
    const truth_polytope *core; /* SPHERE, BOX, CAPSULE, HULL; else null */
    double radius;
    double rotation[9];
    double position[3];
} truth_body;

/* Faces of the hull of points in general position by gift wrapping. Returns 0 if that fails. */
int truth_wrap(int count, const double *points, truth_polytope *out);

/* The core of a sphere, box or capsule. */
void truth_core(uint32_t type, const double *size, truth_polytope *out);

/* How far A has to go along the unit vector n until it is clear of B. */
double truth_width(const truth_body *a, const truth_body *b, const double n[3]);

/* The least of these and its direction; negative if the bodies are apart and one of them is a
 * sphere or both are rounded polytopes, else only an upper bound then. */
double truth_least(const truth_body *a, const truth_body *b, double normal[3]);

/* The same from a start that is near: golden sections over `spread` radians about normal. */
double truth_polish(const truth_body *a, const truth_body *b, double spread, double normal[3]);

#endif
