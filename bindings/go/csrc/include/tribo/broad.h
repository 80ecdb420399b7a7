/**
 * @file broad.h
 * Broad phase: which bounds overlap, among many that move. A dynamic tree of axis-aligned boxes in
 * the caller's memory. Part of libtribo.
 *
 * Adding, moving and removing take time of the order of the logarithm of the number of boxes,
 * whatever the boxes and their order. All comparisons are of the exact boxes: results are the
 * same on every platform, in every unit of length, and for every history of the tree.
 *
 * Rules on aliasing and units: see base.h. Calls that change a tree need it alone; queries may
 * run at once.
 */
#ifndef TRIBO_BROAD_H
#define TRIBO_BROAD_H

#include <tribo/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A tree of boxes; opaque, inside the caller's block. */
typedef struct tribo_tree tribo_tree;

/** Bytes for a tree of up to `capacity` boxes (1 to 2^30); 0 if that is out of range. */
TRIBO_API size_t tribo_tree_size(uint32_t capacity);

/** Make an empty tree in `block` (aligned to 8, of tribo_tree_size(capacity) bytes). The block
 *  may be copied or moved: it has no pointers.
 *  @param margin m, >= 0: stored boxes are larger by it on each side, so that small moves cost
 *                nothing
 *  @param tree   receives the tree: the block itself
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_RANGE, TRIBO_ERROR_NOT_FINITE. */
TRIBO_API tribo_status tribo_tree_init(void *block, uint32_t capacity, double margin,
                                       tribo_tree **tree);

/** Add a box; `id` receives its number: the smallest that is free.
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_NOT_FINITE (NaN; infinities are allowed),
 *          TRIBO_ERROR_RANGE (low > high), TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_tree_add(tribo_tree *tree, const double low[3], const double high[3],
                                      uint32_t *id);

/** Move a box. @return as tribo_tree_add, but for the capacity; TRIBO_ERROR_INDEX. */
TRIBO_API tribo_status tribo_tree_move(tribo_tree *tree, uint32_t id, const double low[3],
                                       const double high[3]);

/** Remove a box. @return TRIBO_ERROR_NULL, TRIBO_ERROR_INDEX. */
TRIBO_API tribo_status tribo_tree_remove(tribo_tree *tree, uint32_t id);

/** All pairs of overlapping boxes (touching counts), each once as (smaller id, greater id),
 *  sorted: the order does not depend on how the tree came to be. Exact boxes are compared, not
 *  the enlarged ones.
 *  @param capacity room in pairs (width 2)
 *  @param pairs    may be null if capacity is 0
 *  @param count    receives the number of pairs, also with TRIBO_ERROR_CAPACITY (then pairs
 *                  holds nothing of use)
 *  @return TRIBO_ERROR_NULL, TRIBO_ERROR_CAPACITY. */
TRIBO_API tribo_status tribo_tree_pairs(const tribo_tree *tree, size_t capacity, uint32_t *pairs,
                                        size_t *count);

/** Boxes that overlap a box (touching counts, bounds may be infinite): ids, sorted.
 *  As tribo_tree_pairs; TRIBO_ERROR_NOT_FINITE (NaN), TRIBO_ERROR_RANGE (low > high). */
TRIBO_API tribo_status tribo_tree_query_box(const tribo_tree *tree, const double low[3],
                                            const double high[3], size_t capacity, uint32_t *ids,
                                            size_t *count);

/** Boxes that the segment from + t (to - from), 0 <= t <= 1, meets: ids, sorted. None that is
 *  met is missed, touched ones included. One that the segment passes by is told only where
 *  rounding hides the gap: beside an edge or corner, where changing t by a part of 2^-48 closes
 *  it. As tribo_tree_pairs; TRIBO_ERROR_NOT_FINITE (infinities too). */
TRIBO_API tribo_status tribo_tree_query_ray(const tribo_tree *tree, const double from[3],
                                            const double to[3], size_t capacity, uint32_t *ids,
                                            size_t *count);

#ifdef __cplusplus
}
#endif

#endif
