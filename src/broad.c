#include <tribo/broad.h>

#include "bits.h"
#include "tree.h"

#include <float.h>

/* A binary tree whose siblings lie side by side: the nodes 2p and 2p + 1 are pair p, node 0 is the
 * root and node 1 is not used. All links are indices, and positions stay while contents move: every
 * change of shape is made of exchanges of two nodes.
 *
 * Leaves hold exact boxes; what their ancestors enclose are the enlarged ones, kept apart by id,
 * because only changes of the tree read them.
 *
 * Heights of siblings differ by SLACK at most, so that depth is bounded whatever the input: with
 * N(h) the fewest leaves of height h, N(h) = N(h-1) + N(h-1-SLACK), and 2^30 leaves are less
 * than N(MAX_HEIGHT). Three rules keep it, by the argument for AVL trees: a leaf becomes the
 * sibling of a node of height SLACK or less; one exchange repairs a difference of SLACK + 1;
 * exchanges for area alone keep the height of the node that they are made in. */
#define NONE UINT32_MAX
#define MAX_CAPACITY (UINT32_C(1) << 30)
#define SLACK 2
#define MAX_HEIGHT 64
#define ROUNDING 8.8817841970012523e-16 /* 2^-50 */
#define STALE 4.0                       /* margins by which an enlarged box may exceed its box */

typedef struct tree_box {
    double low[3];
    double high[3];
} tree_box;

typedef struct tree_node {
    tree_box box;
    uint32_t parent; /* node; of pairs that are free: NONE */
    uint32_t link;   /* leaf: id. Inner node: pair of the children */
    uint32_t height; /* leaf: 0 */
    uint32_t unused;
} tree_node;

#define ID_LEVELS 5 /* 64^5 ids */

struct tribo_tree {
    double margin;
    double greatest; /* finite coordinate, in magnitude, of all enlarged boxes so far */
    double scale;    /* power of two that brings it below 1/2 */
    uint64_t nodes;  /* offsets in bytes from here */
    uint64_t enlarged;
    uint64_t places;
    uint64_t
        ids[ID_LEVELS]; /* free ids below id_end; each level tells which words below are not 0 */
    uint32_t clamps;    /* 1: some coordinate is infinite or too large to be scaled */
    uint32_t capacity;
    uint32_t count;
    uint32_t id_end;    /* ids from here on were never used */
    uint32_t pair_end;  /* likewise pairs */
    uint32_t free_pair; /* head of the list of those freed, linked by `link` */
    uint32_t placed;    /* pair that was put in order last; 0: begin at the root */
    uint32_t slot;      /* where the next one goes */
};

/* ---- layout of the block -------------------------------------------------------------------- */

static uint64_t words_of(uint64_t bits)
{
    return (bits + 63u) / 64u;
}

/* Offsets of all parts for a capacity; returns the size of the whole. */
static uint64_t lay_out(tribo_tree *tree, uint32_t capacity)
{
    uint64_t size = sizeof *tree;
    tree->nodes = size;
    size += 2u * (uint64_t)capacity * sizeof(tree_node);
    tree->enlarged = size;
    size += (uint64_t)capacity * sizeof(tree_box);
    uint64_t bits = capacity;
    for (int level = 0; level < ID_LEVELS; level++) {
        bits = words_of(bits);
        tree->ids[level] = size;
        size += bits * sizeof(uint64_t);
    }
    tree->places = size;
    return size + (words_of((uint64_t)capacity * 32u)) * sizeof(uint64_t);
}

TRIBO_ALWAYS_INLINE tree_node *nodes_of(tribo_tree *tree)
{
    return (tree_node *)(void *)((unsigned char *)tree + tree->nodes);
}

TRIBO_ALWAYS_INLINE const tree_node *read_nodes(const tribo_tree *tree)
{
    return (const tree_node *)(const void *)((const unsigned char *)tree + tree->nodes);
}

TRIBO_ALWAYS_INLINE tree_box *enlarged_of(tribo_tree *tree)
{
    return (tree_box *)(void *)((unsigned char *)tree + tree->enlarged);
}

/* The node that holds an id. */
TRIBO_ALWAYS_INLINE uint32_t *places_of(tribo_tree *tree)
{
    return (uint32_t *)(void *)((unsigned char *)tree + tree->places);
}

TRIBO_ALWAYS_INLINE uint64_t *ids_of(tribo_tree *tree, int level)
{
    return (uint64_t *)(void *)((unsigned char *)tree + tree->ids[level]);
}

size_t tribo_tree_size(uint32_t capacity)
{
    if (capacity == 0 || capacity > MAX_CAPACITY) {
        return 0;
    }
    tribo_tree tree;
    const uint64_t size = lay_out(&tree, capacity);
    return size > SIZE_MAX ? 0 : (size_t)size;
}

tribo_status tribo_tree_init(void *block, uint32_t capacity, double margin, tribo_tree **tree)
{
    if (!block || !tree) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(&margin, 1)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (margin < 0.0 || tribo_tree_size(capacity) == 0) {
        return TRIBO_ERROR_RANGE;
    }
    tribo_tree *made = block;
    memset(made, 0, sizeof *made);
    made->margin = margin;
    made->scale = 1.0;
    made->capacity = capacity;
    made->pair_end = 1;
    made->free_pair = NONE;
    (void)lay_out(made, capacity);
    memset(ids_of(made, 0), 0, (size_t)(made->places - made->ids[0]));
    *tree = made;
    return TRIBO_OK;
}

/* ---- ids ------------------------------------------------------------------------------------ */

/* Number of the lowest bit that is set; `bits` is not 0. */
static uint32_t lowest_bit(uint64_t bits)
{
    uint32_t number = 0;
    for (uint32_t half = 32; half > 0; half /= 2) {
        if ((bits & ((UINT64_C(1) << half) - 1u)) == 0) {
            bits >>= half;
            number += half;
        }
    }
    return number;
}

static uint32_t take_id(tribo_tree *tree)
{
    if (*ids_of(tree, ID_LEVELS - 1) == 0) {
        return tree->id_end++;
    }
    uint32_t id = 0;
    for (int level = ID_LEVELS - 1; level >= 0; level--) {
        id = 64u * id + lowest_bit(ids_of(tree, level)[id]);
    }
    uint32_t at = id;
    for (int level = 0; level < ID_LEVELS; level++) {
        uint64_t *word = &ids_of(tree, level)[at / 64u];
        *word &= ~(UINT64_C(1) << at % 64u);
        if (*word != 0) {
            break;
        }
        at /= 64u;
    }
    return id;
}

static void return_id(tribo_tree *tree, uint32_t id)
{
    for (int level = 0; level < ID_LEVELS; level++) {
        ids_of(tree, level)[id / 64u] |= UINT64_C(1) << id % 64u;
        id /= 64u;
    }
}

/* ---- boxes ---------------------------------------------------------------------------------- */

static tribo_status check_box(const double low[3], const double high[3])
{
    for (int k = 0; k < 3; k++) {
        if (low[k] != low[k] || high[k] != high[k]) {
            return TRIBO_ERROR_NOT_FINITE;
        }
    }
    return low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2] ? TRIBO_OK
                                                                       : TRIBO_ERROR_RANGE;
}

TRIBO_ALWAYS_INLINE tree_box box_of(const double low[3], const double high[3])
{
    const tree_box made = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    return made;
}

TRIBO_ALWAYS_INLINE tree_box enlarge(const tree_box *b, double by)
{
    const tree_box made = {{b->low[0] - by, b->low[1] - by, b->low[2] - by},
                           {b->high[0] + by, b->high[1] + by, b->high[2] + by}};
    return made;
}

TRIBO_ALWAYS_INLINE tree_box join(const tree_box *a, const tree_box *b)
{
    const tree_box made = {
        {lesser(a->low[0], b->low[0]), lesser(a->low[1], b->low[1]), lesser(a->low[2], b->low[2])},
        {greater(a->high[0], b->high[0]), greater(a->high[1], b->high[1]),
         greater(a->high[2], b->high[2])}};
    return made;
}

TRIBO_ALWAYS_INLINE int contains(const tree_box *outer, const tree_box *inner)
{
    return (outer->low[0] <= inner->low[0]) & (outer->low[1] <= inner->low[1]) &
           (outer->low[2] <= inner->low[2]) & (outer->high[0] >= inner->high[0]) &
           (outer->high[1] >= inner->high[1]) & (outer->high[2] >= inner->high[2]);
}

TRIBO_ALWAYS_INLINE int overlaps(const tree_box *a, const tree_box *b)
{
    return (a->low[0] <= b->high[0]) & (b->low[0] <= a->high[0]) & (a->low[1] <= b->high[1]) &
           (b->low[1] <= a->high[1]) & (a->low[2] <= b->high[2]) & (b->low[2] <= a->high[2]);
}

TRIBO_ALWAYS_INLINE double clamp(double x)
{
    return greater(-1.0, lesser(1.0, x));
}

/* Half the surface in scaled lengths. What is infinite counts as somewhat larger than all that
 * is finite: then boxes without bounds along some axis are still told apart by the other axes,
 * and nothing is NaN. */
static double area(const tribo_tree *tree, const tree_box *b)
{
    const double scale = tree->scale;
    double e[3];
    for (int k = 0; k < 3; k++) {
        e[k] = tree->clamps ? clamp(b->high[k] * scale) - clamp(b->low[k] * scale)
                            : (b->high[k] - b->low[k]) * scale;
    }
    return e[0] * (e[1] + e[2]) + e[1] * e[2];
}

static double joint_area(const tribo_tree *tree, const tree_box *a, const tree_box *b)
{
    const tree_box both = join(a, b);
    return area(tree, &both);
}

/* Distance of the centres in scaled lengths, by sum of coordinates. */
static double distance(const tribo_tree *tree, const tree_box *a, const tree_box *b)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double of_a = clamp(a->low[k] * tree->scale) + clamp(a->high[k] * tree->scale);
        const double of_b = clamp(b->low[k] * tree->scale) + clamp(b->high[k] * tree->scale);
        sum += absolute(of_a - of_b);
    }
    return sum;
}

/* Takes note of how far the boxes reach. */
static void reach(tribo_tree *tree, const tree_box *b)
{
    double greatest = tree->greatest;
    for (int k = 0; k < 3; k++) {
        const double far = greater(absolute(b->low[k]), absolute(b->high[k]));
        const double near = lesser(absolute(b->low[k]), absolute(b->high[k]));
        tree->clamps |= far > TRIBO_LARGE;
        greatest = far <= TRIBO_LARGE ? greater(greatest, far) : greatest;
        greatest = near <= TRIBO_LARGE ? greater(greatest, near) : greatest;
    }
    if (greatest > tree->greatest) {
        tree->greatest = greatest;
        tree->scale = 0.25 * power_of_two(scale_exponent(greatest));
    }
}

/* ---- shape of the tree ---------------------------------------------------------------------- */

/* The box that ancestors of a node enclose. */
TRIBO_ALWAYS_INLINE const tree_box *outer_box(tribo_tree *tree, uint32_t at)
{
    const tree_node *n = &nodes_of(tree)[at];
    return n->height == 0 ? &enlarged_of(tree)[n->link] : &n->box;
}

/* After contents have come to `at`: those that refer to it by position are told. */
static void relink(tribo_tree *tree, uint32_t at)
{
    tree_node *nodes = nodes_of(tree);
    if (nodes[at].height == 0) {
        places_of(tree)[nodes[at].link] = at;
    } else {
        nodes[2u * nodes[at].link].parent = at;
        nodes[2u * nodes[at].link + 1u].parent = at;
    }
}

/* Writes contents, but for the parent, which belongs to the position. */
static void put(tribo_tree *tree, uint32_t at, const tree_node *contents)
{
    tree_node *to = &nodes_of(tree)[at];
    to->box = contents->box;
    to->link = contents->link;
    to->height = contents->height;
    relink(tree, at);
}

/* Exchanges two subtrees, neither within the other. */
static void exchange(tribo_tree *tree, uint32_t a, uint32_t b)
{
    const tree_node of_a = nodes_of(tree)[a];
    const tree_node of_b = nodes_of(tree)[b];
    put(tree, a, &of_b);
    put(tree, b, &of_a);
}

static void refit(tribo_tree *tree, uint32_t at)
{
    tree_node *n = &nodes_of(tree)[at];
    const uint32_t left = 2u * n->link;
    const uint32_t heights[2] = {nodes_of(tree)[left].height, nodes_of(tree)[left + 1u].height};
    n->box = join(outer_box(tree, left), outer_box(tree, left + 1u));
    n->height = 1u + (heights[0] > heights[1] ? heights[0] : heights[1]);
}

/* The taller child of a node whose children differ too much sends up its own taller child, in
 * exchange for the other. Of equal ones, the one stays that fits the other better. */
static void repair(tribo_tree *tree, uint32_t at)
{
    const tree_node *nodes = nodes_of(tree);
    const uint32_t left = 2u * nodes[at].link;
    const uint32_t tall = nodes[left].height > nodes[left + 1u].height ? left : left + 1u;
    const uint32_t low = tall ^ 1u;
    if (nodes[tall].height <= nodes[low].height + SLACK) {
        return;
    }
    const uint32_t c = 2u * nodes[tall].link;
    const uint32_t d = c + 1u;
    uint32_t up = nodes[c].height > nodes[d].height ? c : d;
    if (nodes[c].height == nodes[d].height) {
        const double with_c = joint_area(tree, outer_box(tree, low), outer_box(tree, c));
        const double with_d = joint_area(tree, outer_box(tree, low), outer_box(tree, d));
        up = with_c < with_d ? d : c;
    }
    exchange(tree, low, up);
    refit(tree, tall);
}

static uint32_t taller(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static int balanced(uint32_t a, uint32_t b)
{
    return a <= b + SLACK && b <= a + SLACK;
}

/* Exchanges a child of the node with a child of the other, if that makes the other smaller and
 * keeps heights. */
static void rotate(tribo_tree *tree, uint32_t at)
{
    const tree_node *nodes = nodes_of(tree);
    const uint32_t left = 2u * nodes[at].link;
    uint32_t down = NONE;
    uint32_t up = NONE;
    double most = 0.0;
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t split = left + side;
        const uint32_t other = split ^ 1u;
        if (nodes[split].height == 0) {
            continue;
        }
        const double before = area(tree, &nodes[split].box);
        for (uint32_t child = 0; child < 2; child++) {
            const uint32_t goes = 2u * nodes[split].link + child;
            const uint32_t stays = goes ^ 1u;
            const uint32_t height = 1u + taller(nodes[stays].height, nodes[other].height);
            if (!balanced(nodes[stays].height, nodes[other].height) ||
                !balanced(height, nodes[goes].height) ||
                1u + taller(height, nodes[goes].height) != nodes[at].height) {
                continue;
            }
            const double gain =
                before - joint_area(tree, outer_box(tree, stays), outer_box(tree, other));
            if (gain > most) {
                most = gain;
                down = other;
                up = goes;
            }
        }
    }
    if (down != NONE) {
        exchange(tree, down, up);
        refit(tree, down ^ 1u);
    }
}

/* From a node whose children have changed to the root, or as far as something changes. */
static void mend(tribo_tree *tree, uint32_t at)
{
    tree_node *nodes = nodes_of(tree);
    for (;;) {
        const tree_box before = nodes[at].box;
        const uint32_t height = nodes[at].height;
        repair(tree, at);
        refit(tree, at);
        rotate(tree, at);
        if (at == 0 || (nodes[at].height == height && contains(&before, &nodes[at].box) &&
                        contains(&nodes[at].box, &before))) {
            return;
        }
        at = nodes[at].parent;
    }
}

static uint32_t take_pair(tribo_tree *tree)
{
    const uint32_t pair = tree->free_pair;
    if (pair == NONE) {
        return tree->pair_end++;
    }
    tree->free_pair = nodes_of(tree)[2u * pair].link;
    return pair;
}

static void return_pair(tribo_tree *tree, uint32_t pair)
{
    tree_node *first = &nodes_of(tree)[2u * pair];
    first->parent = NONE;
    first->link = tree->free_pair;
    tree->free_pair = pair;
}

/* Least growth of the surfaces, if a leaf goes somewhere below `at`. */
static double least_cost(tribo_tree *tree, uint32_t at, const tree_box *leaf, double leaf_area)
{
    const double joined = joint_area(tree, outer_box(tree, at), leaf);
    if (nodes_of(tree)[at].height == 0) {
        return joined;
    }
    return joined - area(tree, &nodes_of(tree)[at].box) + leaf_area;
}

/* A node at or below `at` for a new leaf to become the sibling of: descends to where surfaces
 * grow least. */
static uint32_t find_sibling(tribo_tree *tree, uint32_t at, const tree_box *leaf)
{
    const tree_node *nodes = nodes_of(tree);
    const double leaf_area = area(tree, leaf);
    while (nodes[at].height > 0) {
        const uint32_t left = 2u * nodes[at].link;
        const uint32_t right = left + 1u;
        const double costs[2] = {least_cost(tree, left, leaf, leaf_area),
                                 least_cost(tree, right, leaf, leaf_area)};
        if (nodes[at].height <= SLACK && area(tree, &nodes[at].box) <= lesser(costs[0], costs[1])) {
            break;
        }
        if (costs[0] != costs[1]) {
            at = costs[0] < costs[1] ? left : right;
            continue;
        }
        const double away[2] = {distance(tree, outer_box(tree, left), leaf),
                                distance(tree, outer_box(tree, right), leaf)};
        const int first =
            away[0] != away[1] ? away[0] < away[1] : nodes[left].height <= nodes[right].height;
        at = first ? left : right;
    }
    return at;
}

/* Hangs up the leaf of an id, whose enlarged box is known, at or below `at`. */
static void hang(tribo_tree *tree, uint32_t at, uint32_t id, const tree_box *exact)
{
    tree_node *nodes = nodes_of(tree);
    const tree_node leaf = {*exact, NONE, id, 0, 0};
    if (tree->count++ == 0) {
        nodes[0] = leaf;
        places_of(tree)[id] = 0;
        return;
    }
    const uint32_t sibling = find_sibling(tree, at, &enlarged_of(tree)[id]);
    const uint32_t pair = take_pair(tree);
    nodes[2u * pair].parent = nodes[2u * pair + 1u].parent = sibling;
    put(tree, 2u * pair, &nodes[sibling]);
    put(tree, 2u * pair + 1u, &leaf);
    nodes[sibling].link = pair;
    refit(tree, sibling);
    rotate(tree, sibling);
    if (sibling != 0) {
        mend(tree, nodes[sibling].parent);
    }
}

/* Takes the leaf of an id off; returns a node near by. */
static uint32_t take_off(tribo_tree *tree, uint32_t id)
{
    tree_node *nodes = nodes_of(tree);
    const uint32_t at = places_of(tree)[id];
    tree->count--;
    if (at == 0) {
        return 0;
    }
    const uint32_t parent = nodes[at].parent;
    put(tree, parent, &nodes[at ^ 1u]);
    return_pair(tree, at / 2u);
    if (parent != 0) {
        mend(tree, nodes[parent].parent);
    }
    return parent;
}

/* ---- order in memory ------------------------------------------------------------------------ */

/* Exchanges the places of two pairs of nodes, related or not. Links are set first: where a
 * parent is itself in one of the pairs, they move with it, and relink then corrects what is read
 * as parent. */
static void exchange_pairs(tribo_tree *tree, uint32_t a, uint32_t b)
{
    tree_node *nodes = nodes_of(tree);
    nodes[nodes[2u * a].parent].link = b;
    nodes[nodes[2u * b].parent].link = a;
    for (uint32_t side = 0; side < 2; side++) {
        const tree_node kept = nodes[2u * a + side];
        nodes[2u * a + side] = nodes[2u * b + side];
        nodes[2u * b + side] = kept;
    }
    for (uint32_t side = 0; side < 2; side++) {
        relink(tree, 2u * a + side);
        relink(tree, 2u * b + side);
    }
}

/* The pair that follows in depth-first order; 0 after the last. */
static uint32_t next_pair(const tree_node *nodes, uint32_t pair)
{
    for (uint32_t at = 2u * pair; at < 2u * pair + 2u; at++) {
        if (nodes[at].height > 0) {
            return nodes[at].link;
        }
    }
    for (uint32_t at = nodes[2u * pair].parent; at != 0; at = nodes[at].parent) {
        if (at % 2u == 0 && nodes[at + 1u].height > 0) {
            return nodes[at + 1u].link;
        }
    }
    return 0;
}

/* A step of an endless walk through the tree that puts pairs into depth-first order in memory,
 * for the sake of caches: with every change of the tree goes one such step, so that no call
 * takes long. What changes meanwhile only makes the order worse. */
static void tidy(tribo_tree *tree)
{
    tree_node *nodes = nodes_of(tree);
    const uint32_t placed = tree->placed;
    if (placed == 0) {
        tree->slot = 1;
    }
    while (tree->slot < tree->pair_end && nodes[2u * tree->slot].parent == NONE) {
        tree->slot++;
    }
    uint32_t next = 0;
    if (placed == 0) {
        next = tree->count > 1 ? nodes[0].link : 0;
    } else if (nodes[2u * placed].parent != NONE) {
        next = next_pair(nodes, placed);
    }
    if (next == 0 || tree->slot == tree->pair_end) {
        tree->placed = 0;
        return;
    }
    if (next > tree->slot) {
        exchange_pairs(tree, next, tree->slot);
        next = tree->slot;
    }
    tree->placed = next;
    tree->slot += next == tree->slot;
}

/* ---- changes -------------------------------------------------------------------------------- */

static int is_live(const tribo_tree *tree, uint32_t id)
{
    const unsigned char *places = (const unsigned char *)tree + tree->places;
    return id < tree->id_end && ((const uint32_t *)(const void *)places)[id] != NONE;
}

tribo_status tribo_tree_add(tribo_tree *tree, const double low[3], const double high[3],
                            uint32_t *id)
{
    if (!tree || !low || !high || !id) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = check_box(low, high);
    if (status != TRIBO_OK) {
        return status;
    }
    if (tree->count == tree->capacity) {
        return TRIBO_ERROR_CAPACITY;
    }
    const tree_box exact = box_of(low, high);
    const uint32_t made = take_id(tree);
    enlarged_of(tree)[made] = enlarge(&exact, tree->margin);
    reach(tree, &enlarged_of(tree)[made]);
    hang(tree, 0, made, &exact);
    tidy(tree);
    *id = made;
    return TRIBO_OK;
}

tribo_status tree_move(tribo_tree *tree, uint32_t id, const double low[3], const double high[3],
                       double margin)
{
    if (!is_live(tree, id)) {
        return TRIBO_ERROR_INDEX;
    }
    const tribo_status status = check_box(low, high);
    if (status != TRIBO_OK) {
        return status;
    }
    const tree_box exact = box_of(low, high);
    tree_box *enlarged = &enlarged_of(tree)[id];
    const tree_box loose = enlarge(&exact, STALE * margin);
    if (contains(enlarged, &exact) && contains(&loose, enlarged)) {
        nodes_of(tree)[places_of(tree)[id]].box = exact;
        return TRIBO_OK;
    }
    uint32_t near = take_off(tree, id);
    *enlarged = enlarge(&exact, margin);
    reach(tree, enlarged);
    while (near != 0 && !contains(outer_box(tree, near), enlarged)) {
        near = nodes_of(tree)[near].parent;
    }
    hang(tree, near, id, &exact);
    tidy(tree);
    return TRIBO_OK;
}

tribo_status tribo_tree_move(tribo_tree *tree, uint32_t id, const double low[3],
                             const double high[3])
{
    return tree && low && high ? tree_move(tree, id, low, high, tree->margin) : TRIBO_ERROR_NULL;
}

tribo_status tribo_tree_remove(tribo_tree *tree, uint32_t id)
{
    if (!tree) {
        return TRIBO_ERROR_NULL;
    }
    if (!is_live(tree, id)) {
        return TRIBO_ERROR_INDEX;
    }
    (void)take_off(tree, id);
    places_of(tree)[id] = NONE;
    return_id(tree, id);
    return TRIBO_OK;
}

/* ---- order of results ----------------------------------------------------------------------- */

#define DIGIT 8
#define BUCKETS (1u << DIGIT)
#define FEW 48 /* keys that are sorted by insertion */

/* Results of one query: ids, or pairs of them, as many as there is room for. */
typedef struct results {
    uint32_t *values;
    size_t capacity;
    size_t count;
} results;

TRIBO_ALWAYS_INLINE uint64_t key_at(const uint32_t *values, size_t i, size_t width)
{
    return width == 1 ? values[i] : (uint64_t)values[2 * i] << 32 | values[2 * i + 1];
}

TRIBO_ALWAYS_INLINE void set_key(uint32_t *values, size_t i, size_t width, uint64_t key)
{
    if (width == 1) {
        values[i] = (uint32_t)key;
    } else {
        values[2 * i] = (uint32_t)(key >> 32);
        values[2 * i + 1] = (uint32_t)key;
    }
}

TRIBO_ALWAYS_INLINE void sort_few(uint32_t *values, size_t begin, size_t end, size_t width)
{
    for (size_t i = begin + 1; i < end; i++) {
        const uint64_t key = key_at(values, i, width);
        size_t to = i;
        for (; to > begin && key_at(values, to - 1, width) > key; to--) {
            set_key(values, to, width, key_at(values, to - 1, width));
        }
        set_key(values, to, width, key);
    }
}

/* Orders keys by the digit at `shift`, in place; ends[d] becomes the end of bucket d. */
TRIBO_ALWAYS_INLINE void part(uint32_t *values, size_t begin, size_t end, size_t width,
                              uint32_t shift, size_t ends[BUCKETS])
{
    size_t heads[BUCKETS];
    size_t counts[BUCKETS] = {0};
    for (size_t i = begin; i < end; i++) {
        counts[key_at(values, i, width) >> shift & (BUCKETS - 1u)]++;
    }
    for (size_t d = 0, at = begin; d < BUCKETS; d++) {
        heads[d] = at;
        at += counts[d];
        ends[d] = at;
    }
    for (size_t d = 0; d < BUCKETS; d++) {
        while (heads[d] < ends[d]) {
            uint64_t key = key_at(values, heads[d], width);
            for (;;) {
                const size_t to = key >> shift & (BUCKETS - 1u);
                const size_t place = heads[to]++;
                if (to == d) {
                    set_key(values, place, width, key);
                    break;
                }
                const uint64_t next = key_at(values, place, width);
                set_key(values, place, width, key);
                key = next;
            }
        }
    }
}

static void part_ids(uint32_t *values, size_t begin, size_t end, uint32_t shift,
                     size_t ends[BUCKETS])
{
    part(values, begin, end, 1, shift, ends);
}

static void part_pairs(uint32_t *values, size_t begin, size_t end, uint32_t shift,
                       size_t ends[BUCKETS])
{
    part(values, begin, end, 2, shift, ends);
}

/* Shift of the first digit of an id of so many bits. */
static uint32_t first_shift(uint32_t bits)
{
    return bits > DIGIT ? bits - DIGIT : 0;
}

/* The digit after that at `shift`; NONE after the last. Digits of the first id of a pair begin
 * at bit 32, those of the second at bit 0. */
static uint32_t next_shift(uint32_t shift, uint32_t bits)
{
    if (shift == 0) {
        return NONE;
    }
    if (shift == 32) {
        return first_shift(bits);
    }
    const uint32_t least = shift > 32 ? 32 : 0;
    return shift >= least + DIGIT ? shift - DIGIT : least;
}

/* Keys differ, so the recursion ends with the last digit: 8 levels at most. */
static void sort(uint32_t *values, size_t begin, size_t end, size_t width, uint32_t shift,
                 uint32_t bits)
{
    if (end - begin <= FEW || shift == NONE) {
        if (width == 1) {
            sort_few(values, begin, end, 1);
        } else {
            sort_few(values, begin, end, 2);
        }
        return;
    }
    size_t ends[BUCKETS];
    (width == 1 ? part_ids : part_pairs)(values, begin, end, shift, ends);
    for (size_t d = 0; d < BUCKETS; d++) {
        const size_t from = d == 0 ? begin : ends[d - 1];
        if (ends[d] - from > 1) {
            sort(values, from, ends[d], width, next_shift(shift, bits), bits);
        }
    }
}

/* Sorts what was found and tells how many there are. */
static tribo_status finish(const tribo_tree *tree, results *found, size_t width, size_t *count)
{
    *count = found->count;
    if (found->count > found->capacity) {
        return TRIBO_ERROR_CAPACITY;
    }
    uint32_t bits = 0;
    while (bits < 32 && tree->id_end >> bits != 0) {
        bits++;
    }
    const uint32_t shift = first_shift(bits) + (width == 2 ? 32 : 0);
    sort(found->values, 0, found->count, width, shift, bits);
    return TRIBO_OK;
}

/* ---- queries -------------------------------------------------------------------------------- */

TRIBO_ALWAYS_INLINE void tell_pair(results *found, uint32_t a, uint32_t b)
{
    const size_t at = found->count++;
    if (at < found->capacity) {
        found->values[2 * at] = a < b ? a : b;
        found->values[2 * at + 1] = a < b ? b : a;
    }
}

TRIBO_ALWAYS_INLINE void tell_id(results *found, uint32_t id)
{
    const size_t at = found->count++;
    if (at < found->capacity) {
        found->values[at] = id;
    }
}

/* All pairs of a leaf in the subtree of `a` and one in that of `b`, whose boxes overlap. Every
 * round takes one entry off the stack and puts up to four on, one level further down. */
static void cross(const tree_node *nodes, uint32_t a, uint32_t b, results *found)
{
    uint32_t stack[2 * (3 * MAX_HEIGHT + 4)];
    size_t size = 0;
    for (;;) {
        const uint32_t end_a = nodes[a].height == 0 ? a + 1u : 2u * nodes[a].link + 2u;
        const uint32_t end_b = nodes[b].height == 0 ? b + 1u : 2u * nodes[b].link + 2u;
        const uint32_t begin_b = nodes[b].height == 0 ? b : end_b - 2u;
        for (uint32_t i = nodes[a].height == 0 ? a : end_a - 2u; i < end_a; i++) {
            for (uint32_t j = begin_b; j < end_b; j++) {
                if (!overlaps(&nodes[i].box, &nodes[j].box)) {
                    continue;
                }
                if ((nodes[i].height | nodes[j].height) == 0) {
                    tell_pair(found, nodes[i].link, nodes[j].link);
                } else {
                    stack[size++] = i;
                    stack[size++] = j;
                }
            }
        }
        if (size == 0) {
            return;
        }
        b = stack[--size];
        a = stack[--size];
    }
}

tribo_status tribo_tree_pairs(const tribo_tree *tree, size_t capacity, uint32_t *pairs,
                              size_t *count)
{
    if (!tree || (!pairs && capacity > 0) || !count) {
        return TRIBO_ERROR_NULL;
    }
    results found = {pairs, capacity, 0};
    const tree_node *nodes = read_nodes(tree);
    for (uint32_t pair = 1; pair < tree->pair_end; pair++) {
        const tree_node *left = &nodes[2u * pair];
        if (left->parent != NONE && overlaps(&left->box, &left[1].box)) {
            cross(nodes, 2u * pair, 2u * pair + 1u, &found);
        }
    }
    return finish(tree, &found, 2, count);
}

tribo_status tribo_tree_query_box(const tribo_tree *tree, const double low[3], const double high[3],
                                  size_t capacity, uint32_t *ids, size_t *count)
{
    if (!tree || !low || !high || (!ids && capacity > 0) || !count) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = check_box(low, high);
    if (status != TRIBO_OK) {
        return status;
    }
    results found = {ids, capacity, 0};
    const tree_node *nodes = read_nodes(tree);
    const tree_box wanted = box_of(low, high);
    uint32_t stack[MAX_HEIGHT + 1];
    size_t size = 0;
    stack[size] = 0;
    size += tree->count > 0;
    while (size > 0) {
        const tree_node *n = &nodes[stack[--size]];
        if (!overlaps(&n->box, &wanted)) {
            continue;
        }
        if (n->height == 0) {
            tell_id(&found, n->link);
        } else {
            stack[size++] = 2u * n->link;
            stack[size++] = 2u * n->link + 1u;
        }
    }
    return finish(tree, &found, 1, count);
}

typedef struct segment {
    double scale[3]; /* 1, or 1/4 along axes where differences overflow */
    double from[3];  /* scaled, as is `along` */
    double along[3];
    tree_box bounds;
} segment;

/* Whether the segment meets the box. Along each axis that is judged exactly. The parameters
 * where the segment enters and leaves slabs carry a relative error below 2^-51 (one difference,
 * one quotient, and the difference beneath): so much is forgiven that no box which is met is
 * ever missed. Rounding keeps order, hence whatever encloses a box that is met is met too. */
static int meets(const segment *s, const tree_box *b)
{
    if (!overlaps(&s->bounds, b)) {
        return 0;
    }
    double enter = 0.0;
    double leave = 1.0;
    for (int k = 0; k < 3; k++) {
        const double along = s->along[k];
        if (along != 0.0) {
            const double low = (s->scale[k] * b->low[k] - s->from[k]) / along;
            const double high = (s->scale[k] * b->high[k] - s->from[k]) / along;
            const double first = along > 0.0 ? low : high;
            const double last = along > 0.0 ? high : low;
            enter = greater(enter, first);
            leave = lesser(leave, last);
        }
    }
    return enter * (1.0 - ROUNDING) <= leave * (1.0 + ROUNDING) + DBL_MIN;
}

tribo_status tribo_tree_query_ray(const tribo_tree *tree, const double from[3], const double to[3],
                                  size_t capacity, uint32_t *ids, size_t *count)
{
    if (!tree || !from || !to || (!ids && capacity > 0) || !count) {
        return TRIBO_ERROR_NULL;
    }
    if (!all_finite(from, 3) || !all_finite(to, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    segment s;
    for (int k = 0; k < 3; k++) {
        s.scale[k] = absolute(to[k] - from[k]) <= DBL_MAX ? 1.0 : 0.25;
        s.from[k] = s.scale[k] * from[k];
        s.along[k] = s.scale[k] * to[k] - s.from[k];
        s.bounds.low[k] = lesser(from[k], to[k]);
        s.bounds.high[k] = greater(from[k], to[k]);
    }
    results found = {ids, capacity, 0};
    const tree_node *nodes = read_nodes(tree);
    uint32_t stack[MAX_HEIGHT + 1];
    size_t size = 0;
    stack[size] = 0;
    size += tree->count > 0;
    while (size > 0) {
        const tree_node *n = &nodes[stack[--size]];
        if (!meets(&s, &n->box)) {
            continue;
        }
        if (n->height == 0) {
            tell_id(&found, n->link);
        } else {
            stack[size++] = 2u * n->link;
            stack[size++] = 2u * n->link + 1u;
        }
    }
    return finish(tree, &found, 1, count);
}
