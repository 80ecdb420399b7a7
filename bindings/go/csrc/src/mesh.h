/* The flat block of a triangle mesh: triangles in the order of the input, and a tree of bounds. */
#ifndef TRIBO_MESH_H
#define TRIBO_MESH_H

#include <tribo/shape.h>

#include "block.h"

#define MESH_MAGIC 0x6873656d6f626974u /* "tibomesh" in the order of a little-endian machine */
#define MESH_VERSION 1u
#define MESH_LEAF 4u
#define MESH_BATCH 64u

/* Edge k of a triangle runs from its vertex k to the next. An edge is active if contact normals may
 * lean over it: its neighbour bends away by more than 1e-6 rad, or there is no single neighbour.
 * Over any other edge the normal is the triangle's own. */
#define MESH_ACTIVE(k) (1u << (k))

typedef struct mesh_face {
    uint32_t vertices[3];
    uint32_t index; /* in the caller's list */
    uint32_t flags;
    uint32_t reserved;
} mesh_face;

/* Nodes in depth-first order: the children of an inner node are the next one and the one at the
 * left's skip. */
typedef struct mesh_node {
    double low[3];
    double high[3];
    uint32_t skip;  /* node after the whole subtree */
    uint32_t first; /* leaf: into order; inner: count is 0 */
    uint32_t count;
    uint32_t least; /* slots of the subtree lie within least and greatest */
    uint32_t greatest;
    uint32_t reserved;
} mesh_node;

typedef struct mesh_block {
    uint64_t magic;
    uint32_t version;
    uint32_t face_count;
    uint32_t vertex_count;
    uint32_t node_count;
    uint64_t bytes;
    uint64_t vertices; /* double[3 V] */
    uint64_t faces;    /* mesh_face[F], without degenerate ones, by rising index */
    uint64_t nodes;    /* mesh_node[N] */
    uint64_t order;    /* uint32_t[F]: slots of faces, leaf by leaf */
    uint64_t sum;      /* block_sum of all other bytes */
} mesh_block;

TRIBO_ALWAYS_INLINE const double *mesh_vertices(const mesh_block *mesh)
{
    return (const double *)(const void *)((const unsigned char *)mesh + mesh->vertices);
}

TRIBO_ALWAYS_INLINE const mesh_face *mesh_faces(const mesh_block *mesh)
{
    return (const mesh_face *)(const void *)((const unsigned char *)mesh + mesh->faces);
}

/* Whether the head of a block is one of this version with sizes and offsets that agree. */
int mesh_head_is_valid(const void *block);

/* The sum that belongs into a block. */
uint64_t mesh_sum(const mesh_block *mesh);

/* Bounds of the mesh along the rows of a rotation. */
void mesh_extent(const mesh_block *mesh, const double rows[9], double low[3], double high[3]);

/* A triangle as a convex shape. */
typedef struct mesh_triangle {
    double vertices[9];
    double normal[3]; /* unit, outward */
    uint32_t index;   /* in the caller's list */
    uint32_t flags;   /* MESH_ACTIVE(k) */
} mesh_triangle;

/* Triangles whose bounds touch a box, in the axes of the mesh, by rising index. No allocation. */
typedef struct mesh_cursor {
    const mesh_block *mesh;
    double low[3];
    double high[3];
    uint32_t next;  /* no slot below is still to come */
    uint32_t count; /* batch of slots that were found, and how many are handed out */
    uint32_t taken;
    uint32_t slots[MESH_BATCH];
} mesh_cursor;

void mesh_begin(const mesh_block *mesh, const double low[3], const double high[3],
                mesh_cursor *cursor);

/* 0 if there is none left. */
int mesh_next(mesh_cursor *cursor, mesh_triangle *out);

#endif
