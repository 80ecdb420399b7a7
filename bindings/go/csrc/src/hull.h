/* The flat block of a convex hull. Everything in it is reached by offsets from its first byte, so
 * that it means the same wherever it is copied. */
#ifndef TRIBO_HULL_H
#define TRIBO_HULL_H

#include <tribo/shape.h>

#include "block.h"

#define HULL_MAGIC 0x6c6c75686f626974u /* "tibohull" in the order of a little-endian machine */
#define HULL_VERSION 1u
#define HULL_LINEAR 32u /* up to so many vertices a scan is cheaper than a climb */
#define HULL_GRID 8u    /* cells along each edge of the cube of directions */
#define HULL_SEEDS (6u * HULL_GRID * HULL_GRID)

typedef struct hull_block {
    uint64_t magic;
    uint32_t version;
    uint32_t vertex_count;
    uint32_t face_count;
    uint32_t side_count;  /* sum of the sides of all faces: twice the number of edges */
    uint64_t bytes;       /* of the whole block */
    uint64_t vertices;    /* double[3 V] */
    uint64_t planes;      /* double[4 F]: outward unit normal n, offset d: n . x <= d */
    uint64_t face_starts; /* uint32_t[F + 1] into loops */
    uint64_t loops; /* uint32_t[S]: vertices of each face, counter-clockwise seen from outside */
    uint64_t ring_starts; /* uint32_t[V + 1] into rings */
    uint64_t rings;       /* uint32_t[2 S]: per vertex pairs (next vertex, face with that side) */
    uint64_t seeds;       /* uint32_t[HULL_SEEDS]: where a climb starts; none up to HULL_LINEAR */
    double center[3];     /* centroid of the solid */
    double inner;         /* radius of the ball around it that touches the nearest plane */
    double outer;         /* radius of the ball around it that reaches the farthest vertex */
    uint64_t sum;         /* block_sum of all other bytes */
} hull_block;

TRIBO_ALWAYS_INLINE const double *hull_vertices(const hull_block *hull)
{
    return (const double *)(const void *)((const unsigned char *)hull + hull->vertices);
}

TRIBO_ALWAYS_INLINE const double *hull_planes(const hull_block *hull)
{
    return (const double *)(const void *)((const unsigned char *)hull + hull->planes);
}

TRIBO_ALWAYS_INLINE const uint32_t *hull_table(const hull_block *hull, uint64_t offset)
{
    return (const uint32_t *)(const void *)((const unsigned char *)hull + offset);
}

/* Whether the head of a block is one of this version with sizes and offsets that agree. Costs the
 * same for every size. */
int hull_head_is_valid(const void *block);

/* The sum that belongs into a block. */
uint64_t hull_sum(const hull_block *hull);

/* Index of the vertex farthest along a direction that is neither zero nor of extreme length. */
uint32_t hull_support(const hull_block *hull, const double direction[3]);

/* The face that faces the direction most among those that meet at a vertex. */
uint32_t hull_face_at(const hull_block *hull, uint32_t vertex, const double direction[3]);

/* Mass at density 1, centre of mass, and second moments (xx, xy, xz, yy, yz, zz) about it, all with
 * lengths measured in units of 1/scale and from hull->center. */
void hull_moments(const hull_block *hull, double scale, double *volume, double center[3],
                  double second[6]);

#endif
