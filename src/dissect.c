#include "dissect.h"

#include <string.h>

#define SMALL 128 /* nodes that are not halved any more */
#define TRIES 3   /* searches from different ends for one cut */
#define LEAST_SHARE 0.2
#define TILT 4.0 /* price of unequal halves: a cut may be twice as large if it is in the middle */

/* Rows that follow each other and have the same neighbours are one node. */
typedef struct dissection {
    int nodes;
    int *node_of;             /* of each row */
    int *starts, *neighbours; /* of nodes */
    int *part;                /* which subgraph a node is in; -1: in a cut */
    int *set;
    int *list; /* nodes, those of a subgraph side by side */
    int *queue, *level, *seen;
    int *side;          /* 0, 1: halves; 2: cut */
    int *size, *border; /* of each level; and how many of it have a neighbour in the next */
    int search, parts, sets;
} dissection;

/* ---- nodes ----------------------------------------------------------------------------------- */

/* joined[i]: row i has the neighbours of row i - 1. */
static void join_rows(int n, const int *row_starts, const int *columns, int *joined)
{
    joined[0] = 0;
    for (int i = 1; i < n; i++) {
        const int length = row_starts[i] - row_starts[i - 1];
        joined[i] = row_starts[i + 1] - row_starts[i] == length + 1 &&
                    memcmp(columns + row_starts[i - 1], columns + row_starts[i],
                           (size_t)length * sizeof *columns) == 0;
    }
    for (int i = 0; i < n; i++) {
        const int end = row_starts[i + 1];
        for (int k = row_starts[i]; k < end; k++) {
            const int c = columns[k];
            if (c > 0 && (k == row_starts[i] || columns[k - 1] != c - 1)) {
                joined[c] = 0;
            }
            if (c < i && columns[k + 1] != c + 1) {
                joined[c + 1] = 0;
            }
        }
    }
}

static void number_nodes(dissection *d, int n)
{
    int node = -1;
    for (int i = 0; i < n; i++) {
        node += d->node_of[i] == 0;
        d->node_of[i] = node;
    }
    d->nodes = node + 1;
}

/* Both triangles, by the first row of each node. */
static void link_nodes(dissection *d, int n, const int *row_starts, const int *columns)
{
    int *at = d->queue;
    memset(d->starts, 0, ((size_t)d->nodes + 1) * sizeof *d->starts);
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < n; i++) {
            const int node = d->node_of[i];
            int before = -1;
            for (int k = row_starts[i];
                 k < row_starts[i + 1] && (i == 0 || d->node_of[i - 1] < node); k++) {
                const int other = d->node_of[columns[k]];
                if (other == node || other == before) {
                    continue;
                }
                before = other;
                if (pass == 0) {
                    d->starts[node + 1]++;
                    d->starts[other + 1]++;
                } else {
                    d->neighbours[at[node]++] = other;
                    d->neighbours[at[other]++] = node;
                }
            }
        }
        for (int i = 0; i < d->nodes && pass == 0; i++) {
            d->starts[i + 1] += d->starts[i];
            at[i] = d->starts[i];
        }
    }
}

/* ---- one cut --------------------------------------------------------------------------------- */

/* Levels of the subgraph from `first`, to queue and level. Returns how many nodes it reached. */
static int search(dissection *d, int first)
{
    const int part = d->part[first];
    int end = 1;
    d->search++;
    d->queue[0] = first;
    d->level[first] = 0;
    d->seen[first] = d->search;
    for (int begin = 0; begin < end; begin++) {
        const int node = d->queue[begin];
        for (int k = d->starts[node]; k < d->starts[node + 1]; k++) {
            const int next = d->neighbours[k];
            if (d->part[next] == part && d->seen[next] != d->search) {
                d->seen[next] = d->search;
                d->level[next] = d->level[node] + 1;
                d->queue[end++] = next;
            }
        }
    }
    return end;
}

static int is_border(const dissection *d, int node)
{
    for (int k = d->starts[node]; k < d->starts[node + 1]; k++) {
        const int next = d->neighbours[k];
        if (d->part[next] == d->part[node] && d->level[next] == d->level[node] + 1) {
            return 1;
        }
    }
    return 0;
}

/* Sizes of the levels of the last search. Returns their number. */
static int measure_levels(dissection *d, int count)
{
    const int levels = d->level[d->queue[count - 1]] + 1;
    memset(d->size, 0, (size_t)levels * sizeof *d->size);
    memset(d->border, 0, (size_t)levels * sizeof *d->border);
    for (int i = 0; i < count; i++) {
        const int node = d->queue[i];
        d->size[d->level[node]]++;
        d->border[d->level[node]] += is_border(d, node);
    }
    return levels;
}

/* The level to cut at, or -1 if none leaves both halves large enough; lowers *least, the price of
 * the best cut so far. */
static int choose_level(const dissection *d, int count, int levels, double *least)
{
    int chosen = -1;
    int below = 0;
    for (int i = 0; i + 1 < levels; i++) {
        const int low = below + d->size[i] - d->border[i];
        const int high = count - below - d->size[i];
        const double share = (double)(low < high ? low : high) / (double)count;
        const double price = (double)d->border[i] * (1.0 + TILT * (0.5 - share) * (0.5 - share));
        below += d->size[i];
        if (share >= LEAST_SHARE && price < *least) {
            *least = price;
            chosen = i;
        }
    }
    return chosen;
}

/* Sides of the nodes by the last search. */
static void take_sides(dissection *d, int count, int cut)
{
    for (int i = 0; i < count; i++) {
        const int node = d->queue[i];
        const int level = d->level[node];
        d->side[node] = level > cut ? 1 : level < cut || !is_border(d, node) ? 0 : 2;
    }
}

/* Cut a connected subgraph that has just been searched. Returns 0 if it cannot be. */
static int cut(dissection *d, int count)
{
    double least = 2.0 * (double)count;
    int is_cut = 0;
    int first = d->queue[count - 1];
    for (int i = 0; i < TRIES; i++) {
        search(d, first);
        const int chosen = choose_level(d, count, measure_levels(d, count), &least);
        if (chosen >= 0) {
            take_sides(d, count, chosen);
            is_cut = 1;
        }
        /* from the other end, and from the middle */
        first = i == 0 ? d->queue[count - 1] : d->queue[count / 2];
    }
    return is_cut;
}

/* ---- all of them ----------------------------------------------------------------------------- */

/* Stable: nodes of side 0 first, then 1, then 2; `sizes` receives how many there are. */
static void sort_sides(dissection *d, int *list, int count, int sizes[3])
{
    int at = 0;
    for (int side = 0; side < 3; side++) {
        const int first = at;
        for (int i = 0; i < count; i++) {
            if (d->side[list[i]] == side) {
                d->queue[at++] = list[i];
            }
        }
        sizes[side] = at - first;
    }
    memcpy(list, d->queue, (size_t)count * sizeof *list);
}

static void close_set(dissection *d, const int *list, int count)
{
    for (int i = 0; i < count; i++) {
        d->set[list[i]] = d->sets;
    }
    d->sets += count > 0;
}

static void name_part(dissection *d, const int *list, int count)
{
    d->parts++;
    for (int i = 0; i < count; i++) {
        d->part[list[i]] = d->parts;
    }
}

/* A subgraph of one part. The depth of calls is that of the halves, for these keep a share. */
static void halve(dissection *d, int *list, int count)
{
    int sizes[3];
    while (count > SMALL) {
        const int reached = search(d, list[0]);
        if (reached == count) {
            break;
        }
        /* what hangs together apart from the rest */
        for (int i = 0; i < count; i++) {
            d->side[list[i]] = d->seen[list[i]] == d->search ? 0 : 1;
        }
        sort_sides(d, list, count, sizes);
        name_part(d, list, reached);
        halve(d, list, reached);
        list += reached;
        count -= reached;
    }
    if (count <= SMALL || !cut(d, count)) {
        close_set(d, list, count);
        return;
    }
    sort_sides(d, list, count, sizes);
    name_part(d, list, sizes[0]);
    name_part(d, list + sizes[0], sizes[1]);
    for (int i = sizes[0] + sizes[1]; i < count; i++) {
        d->part[list[i]] = -1;
    }
    halve(d, list, sizes[0]);
    halve(d, list + sizes[0], sizes[1]);
    close_set(d, list + sizes[0] + sizes[1], sizes[2]);
}

static int *take(int **room, int count)
{
    int *taken = *room;
    *room += count;
    return taken;
}

size_t dissect_room(int n, int entries)
{
    return 11 * (size_t)n + 1 + 2 * (size_t)entries;
}

void dissect(int n, const int *row_starts, const int *columns, int *room, int *sets)
{
    dissection d = {0};
    int **each[] = {&d.node_of, &d.part, &d.set,  &d.list, &d.queue,
                    &d.level,   &d.seen, &d.side, &d.size, &d.border};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
        *each[i] = take(&room, n);
    }
    d.starts = take(&room, n + 1);
    d.neighbours = room;
    join_rows(n, row_starts, columns, d.node_of);
    number_nodes(&d, n);
    link_nodes(&d, n, row_starts, columns);
    for (int i = 0; i < d.nodes; i++) {
        d.list[i] = i;
        d.part[i] = d.seen[i] = 0;
    }
    halve(&d, d.list, d.nodes);
    for (int i = 0; i < n; i++) {
        sets[i] = d.set[d.node_of[i]];
    }
}
