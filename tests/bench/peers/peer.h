/* Other libraries behind one face, so that the benches time all of them on the same pairs in one
 * run. Each is a shared object of its own, loaded at run time: a bench does without those that
 * are not there. */
#ifndef TRIBO_BENCH_PEER_H
#define TRIBO_BENCH_PEER_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PEER_SPHERE,    /* size = radius */
    PEER_BOX,       /* half-extents */
    PEER_CAPSULE,   /* radius, half height; axis z, as in all that follow */
    PEER_CYLINDER,  /* radius, half height */
    PEER_CONE,      /* radius, half height; base at -h */
    PEER_ELLIPSOID, /* semi-axes */
    PEER_HULL,
    PEER_PLANE /* size = n, d: n . x <= d is solid; pose is the world's */
};

typedef struct peer_shape {
    int kind;
    double size[4];
    int vertices; /* HULL */
    const double (*vertex)[3];
    int faces; /* triangles, counter-clockwise seen from outside */
    const int (*corner)[4];
    const double (*normal)[3];
    double position[3];
    double orientation[4]; /* w, x, y, z */
} peer_shape;

typedef struct peer_answer {
    int points;       /* of the manifold; 0: they do not touch */
    double depth;     /* of the deepest point, positive inside */
    double normal[3]; /* from B to A, world axes */
} peer_answer;

/* One way of asking a library. What has to be made once for a pair is made by `make`, as an
 * engine does when a pair begins to be near; `ask` starts without memory of earlier answers. */
typedef struct peer {
    const char *name;
    int single;                                /* it calculates in single precision */
    void *(*make)(const peer_shape shapes[2]); /* null: there is no such shape or pair */
    void (*ask)(void *pair, peer_answer *out);
    void (*drop)(void *pair);
} peer;

/* A broad phase over boxes of six doubles: low, high. */
typedef struct peer_broad {
    const char *name;
    void *(*make)(unsigned count, const double *boxes); /* by number */
    /* A step: where all boxes are now. Returns how many pairs overlap, exactly as they are. */
    unsigned long (*step)(void *broad, const double *boxes);
    void (*drop)(void *broad);
} peer_broad;

/* The symbols of a shared object; the second is there if the library has a broad phase. */
#define PEER_LIST "peer_list"
#define PEER_BROAD "peer_broad_phase"
typedef const peer *(*peer_list_function)(int *count);
#define PEER_EXPORT __attribute__((visibility("default")))
PEER_EXPORT const peer *peer_list(int *count);
PEER_EXPORT extern const peer_broad peer_broad_phase;

#ifdef __cplusplus
}
#endif

#endif
