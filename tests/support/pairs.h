/* Pairs of convex bodies whose depth is known, in classes that are hard for one reason each,
 * and what libccd alone says of them. A pair is a function of (class, seed, index) alone. */
#ifndef TRIBO_TEST_PAIRS_H
#define TRIBO_TEST_PAIRS_H

#include "truth.h"

enum {
    PAIRS_SPHERE,
    PAIRS_BOX,
    PAIRS_CAPSULE,
    PAIRS_CYLINDER,
    PAIRS_CONE,
    PAIRS_ELLIPSOID,
    PAIRS_HULL32,
    PAIRS_HULL256,
    PAIRS_USER, /* a box that is known by its support function alone */
    PAIRS_KINDS
};

/* How two bodies lie to each other. */
enum {
    PAIRS_ANYHOW,
    PAIRS_FACES,      /* axes parallel, half of them tilted by 1e-12 to 1e-3 */
    PAIRS_EDGES,      /* turned about a common axis */
    PAIRS_CONCENTRIC, /* positions equal, or 1e-16 to 1e-3 of the size apart */
    PAIRS_PLATES, /* as FACES; A is a box, a cylinder or a user's box 2000 times as wide as thick */
    PAIRS_APART   /* any two features laid onto each other along a direction, and drawn apart */
};

typedef struct pairs_class {
    const char *name;
    int arrangement;
    double depth;  /* of the smaller size; CONCENTRIC: as it comes */
    double scale;  /* m */
    double aspect; /* greatest, of each body */
    double far;    /* distance from the origin, m */
} pairs_class;

extern const pairs_class pairs_classes[];
extern const int pairs_class_count;

extern const char *const pairs_kind_names[PAIRS_KINDS];

/* Large; keep it static. Not to be moved: it points into itself. */
typedef struct pairs_pair {
    int kind[2];
    tribo_shape shape[2];
    tribo_pose pose[2];
    truth_body body[2]; /* relative to the position of A */
    double depth;       /* true; negative if apart */
    double normal[3];   /* true, where there is only one */
    double small;       /* least half-size of both */
    double large;       /* greatest */
    truth_polytope core[2];
    tribo_convex user[2];
} pairs_pair;

/* Draws pair `index`; kinds < 0 are drawn too. */
void pairs_draw(const pairs_class *class, uint64_t seed, uint64_t index, int kind_a, int kind_b,
                pairs_pair *out);

/* How much longer the way along the normal is than the least, as a share of the depth (or of
 * 1e-9 of the smaller size, if that is more), beyond rounding of the greater size. */
double pairs_excess(const pairs_pair *pair, const double normal[3]);

typedef struct pairs_answer {
    int found;
    int endless; /* support calls went over the bound */
    double depth;
    double normal[3];
} pairs_answer;

/* libccd with its default tolerances, bodies where they are. */
void pairs_raw_epa(const pairs_pair *pair, pairs_answer *out);
void pairs_raw_mpr(const pairs_pair *pair, pairs_answer *out);

#endif
