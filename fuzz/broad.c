/* Properties of include/tribo/broad.h, against brute force over all boxes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <tribo/broad.h>

#include "support/property.h"

enum { BOXES = 48, STEPS = 120, WORDS = 2048 };

/* ---- boxes -------------------------------------------------------------------------------- */

typedef struct box {
    double low[3];
    double high[3];
} box;

enum { GRID, UNIFORM, ANY_SCALE, POINTS, ENDLESS, ANY, BOX_KINDS };

static double make_coordinate(property_trial *t, uint32_t kind)
{
    switch (kind) {
    case UNIFORM:
        return make_signed(t, NULL);
    case ANY_SCALE:
        return make_real(t, NULL, -40, 40);
    case ANY:
        return make_finite(t, NULL);
    default:
        return (double)(make_byte(t) % 8u);
    }
}

static void make_box(property_trial *t, uint32_t kind, box *out)
{
    for (int k = 0; k < 3; k++) {
        const double a = make_coordinate(t, kind);
        const double b = kind == POINTS ? a : make_coordinate(t, kind);
        const double span = kind == UNIFORM ? 0.25 * (b - a) : b - a;
        const double end = isfinite(span) ? a + span : b;
        out->low[k] = fmin(a, end);
        out->high[k] = fmax(a, end);
        const uint8_t open = kind == ENDLESS ? make_byte(t) : 255;
        if (open < 64) {
            out->low[k] = open < 32 ? -HUGE_VAL : out->low[k];
            out->high[k] = open % 2 == 0 ? HUGE_VAL : out->high[k];
        }
    }
    property_note(t, "box", (const double *)out, 6);
}

static int overlap(const box *a, const box *b)
{
    for (int k = 0; k < 3; k++) {
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) {
            return 0;
        }
    }
    return 1;
}

/* Share of the segment between entering the slabs of a box and leaving them; negative: missed. */
static long double share_within(const box *b, const double from[3], const double to[3])
{
    long double enter = 0.0L;
    long double leave = 1.0L;
    for (int k = 0; k < 3; k++) {
        const long double way = (long double)to[k] - (long double)from[k];
        if (fmax(from[k], to[k]) < b->low[k] || fmin(from[k], to[k]) > b->high[k]) {
            return -(long double)INFINITY;
        }
        if (to[k] != from[k]) {
            const long double x = ((long double)b->low[k] - (long double)from[k]) / way;
            const long double y = ((long double)b->high[k] - (long double)from[k]) / way;
            enter = fmaxl(enter, fminl(x, y));
            leave = fminl(leave, fmaxl(x, y));
        }
    }
    return leave - enter;
}

/* ---- a tree and what should be in it ------------------------------------------------------ */

typedef struct forest {
    tribo_tree *tree;
    uint32_t capacity;
    uint32_t count;
    uint8_t live[BOXES];
    box boxes[BOXES];
    uint64_t block[WORDS];
} forest;

static forest first;
static forest second;

static void plant(property_trial *t, forest *f, uint32_t capacity, double margin)
{
    memset(f, 0, offsetof(forest, block));
    f->capacity = capacity;
    REQUIRE(t, tribo_tree_size(capacity) > 0 && tribo_tree_size(capacity) <= sizeof f->block);
    REQUIRE_STATUS(t, tribo_tree_init(f->block, capacity, margin, &f->tree), TRIBO_OK);
    REQUIRE(t, (void *)f->tree == (void *)f->block);
}

static uint32_t least_free(const forest *f)
{
    uint32_t id = 0;
    while (id < f->capacity && f->live[id]) {
        id++;
    }
    return id;
}

static void add(property_trial *t, forest *f, const box *b)
{
    const uint32_t want = least_free(f);
    uint32_t id = 77;
    const tribo_status status = tribo_tree_add(f->tree, b->low, b->high, &id);
    if (want == f->capacity) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_CAPACITY);
        REQUIRE(t, id == 77);
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE(t, id == want);
    f->live[id] = 1;
    f->boxes[id] = *b;
    f->count++;
}

static void move(property_trial *t, forest *f, uint32_t id, const box *b)
{
    const int known = id < f->capacity && f->live[id];
    REQUIRE_STATUS(t, tribo_tree_move(f->tree, id, b->low, b->high),
                   known ? TRIBO_OK : TRIBO_ERROR_INDEX);
    if (known) {
        f->boxes[id] = *b;
    }
}

static void drop(property_trial *t, forest *f, uint32_t id)
{
    const int known = id < f->capacity && f->live[id];
    REQUIRE_STATUS(t, tribo_tree_remove(f->tree, id), known ? TRIBO_OK : TRIBO_ERROR_INDEX);
    if (known) {
        f->live[id] = 0;
        f->count--;
    }
}

/* Adds more often than it removes; moves far or by a little. */
static void change(property_trial *t, forest *f, uint32_t kind)
{
    box b;
    const uint8_t what = make_byte(t);
    const uint32_t id = make_byte(t) % (f->capacity + 1);
    make_box(t, kind, &b);
    if (what < 112) {
        add(t, f, &b);
    } else if (what < 176) {
        move(t, f, id, &b);
    } else if (what < 208 && id < f->capacity && f->live[id]) {
        const double by = ldexp(make_signed(t, NULL), -6);
        b = f->boxes[id];
        for (int k = 0; k < 3; k++) {
            b.low[k] += by;
            b.high[k] += by;
        }
        move(t, f, id, &b);
    } else {
        drop(t, f, id);
    }
}

/* ---- answers ------------------------------------------------------------------------------ */

static uint32_t found[2 * BOXES * BOXES];
static uint32_t expected[2 * BOXES * BOXES];

static void compare_pairs(property_trial *t, const forest *f)
{
    size_t want = 0;
    size_t count = 0;
    for (uint32_t i = 0; i < f->capacity; i++) {
        for (uint32_t j = i + 1; j < f->capacity; j++) {
            if (f->live[i] && f->live[j] && overlap(&f->boxes[i], &f->boxes[j])) {
                expected[2 * want] = i;
                expected[2 * want + 1] = j;
                want++;
            }
        }
    }
    if (want > 0) {
        REQUIRE_STATUS(t, tribo_tree_pairs(f->tree, want - 1, found, &count), TRIBO_ERROR_CAPACITY);
        REQUIRE(t, count == want);
    }
    canary_set(found, sizeof found);
    REQUIRE_STATUS(t, tribo_tree_pairs(f->tree, want, want > 0 ? found : NULL, &count), TRIBO_OK);
    REQUIRE(t, count == want);
    REQUIRE_SAME(t, found, expected, 2 * want * sizeof *found);
    canary_set(expected, sizeof expected);
    REQUIRE_SAME(t, found + 2 * want, expected + 2 * want, sizeof found - 2 * want * sizeof *found);
}

static void compare_box(property_trial *t, const forest *f, const box *b)
{
    size_t want = 0;
    size_t count = 0;
    for (uint32_t i = 0; i < f->capacity; i++) {
        if (f->live[i] && overlap(&f->boxes[i], b)) {
            expected[want++] = i;
        }
    }
    if (want > 0) {
        REQUIRE_STATUS(t, tribo_tree_query_box(f->tree, b->low, b->high, want - 1, found, &count),
                       TRIBO_ERROR_CAPACITY);
        REQUIRE(t, count == want);
    }
    REQUIRE_STATUS(t, tribo_tree_query_box(f->tree, b->low, b->high, want, found, &count),
                   TRIBO_OK);
    REQUIRE(t, count == want);
    REQUIRE_SAME(t, found, expected, want * sizeof *found);
}

/* Long doubles err by less than what a ray may be told too much. */
static void compare_ray(property_trial *t, const forest *f, const double from[3],
                        const double to[3])
{
    size_t at = 0;
    size_t count = 0;
    REQUIRE_STATUS(t, tribo_tree_query_ray(f->tree, from, to, BOXES, found, &count), TRIBO_OK);
    for (uint32_t i = 0; i < f->capacity; i++) {
        const int told = at < count && found[at] == i;
        const long double share =
            f->live[i] ? share_within(&f->boxes[i], from, to) : -(long double)INFINITY;
        REQUIRE(t, told ? share >= -0x1p-47L : share < 0.0L);
        at += (size_t)told;
    }
    REQUIRE(t, at == count);
}

/* Along a coordinate plane, along an axis, of no length, or any. */
static void make_segment(property_trial *t, uint32_t kind, double from[3], double to[3])
{
    const uint8_t flat = make_byte(t);
    for (int k = 0; k < 3; k++) {
        from[k] = make_coordinate(t, kind);
        to[k] = make_coordinate(t, kind);
        to[k] = (flat >> k) % 2 == 1 ? from[k] : to[k];
    }
    property_note(t, "from", from, 3);
    property_note(t, "to", to, 3);
}

/* Through a corner of a box and as far again. */
static void aim(property_trial *t, const box *b, const double from[3], double to[3])
{
    const uint8_t corner = make_byte(t);
    for (int k = 0; k < 3; k++) {
        const double at = (corner >> k) % 2 == 0 ? b->low[k] : b->high[k];
        const double end = from[k] + 2.0 * (at - from[k]);
        to[k] = isfinite(end) ? end : to[k];
    }
    property_note(t, "to", to, 3);
}

static void compare_all(property_trial *t, const forest *f, uint32_t kind)
{
    box b;
    double from[3];
    double to[3];
    make_box(t, kind, &b);
    make_segment(t, kind, from, to);
    compare_pairs(t, f);
    compare_box(t, f, &b);
    compare_ray(t, f, from, to);
    const uint32_t id = make_byte(t) % f->capacity;
    if (f->live[id]) {
        aim(t, &f->boxes[id], from, to);
        compare_ray(t, f, from, to);
    }
}

static double make_margin(property_trial *t)
{
    const uint8_t kind = make_byte(t);
    return kind < 128 ? 0.0 : kind < 240 ? make_unit(t, "margin") : fabs(make_finite(t, "margin"));
}

/* ---- properties --------------------------------------------------------------------------- */

/* A life of adding, moving and removing; all answers from time to time. */
static void life(property_trial *t)
{
    const uint32_t kind = make_choice(t, "kind", BOX_KINDS);
    const uint32_t capacity = 1 + make_choice(t, "capacity", BOXES);
    const uint32_t steps = make_choice(t, "steps", STEPS);
    plant(t, &first, capacity, make_margin(t));
    property_expand(t);
    for (uint32_t i = 0; i < steps && t->expression == NULL; i++) {
        change(t, &first, kind);
        if (i % 16 == 7 && t->expression == NULL) {
            compare_all(t, &first, kind);
        }
    }
    if (t->expression == NULL) {
        compare_all(t, &first, kind);
    }
}

static size_t all_pairs(const forest *f, uint32_t *pairs)
{
    size_t count = 0;
    (void)tribo_tree_pairs(f->tree, (size_t)BOXES * BOXES, pairs, &count);
    return count;
}

/* The same boxes at the same ids by another history, margin and capacity: the same answers. */
static void history_is_forgotten(property_trial *t)
{
    box b;
    const uint32_t kind = make_choice(t, "kind", BOX_KINDS);
    const uint32_t capacity = 1 + make_choice(t, "capacity", BOXES - 1);
    const uint32_t steps = make_choice(t, "steps", STEPS);
    plant(t, &first, capacity, make_margin(t));
    plant(t, &second, capacity + 1, make_margin(t));
    property_expand(t);
    for (uint32_t i = 0; i < steps && t->expression == NULL; i++) {
        change(t, &first, kind);
    }
    for (uint32_t i = 0; i < capacity && t->expression == NULL; i++) {
        make_box(t, kind, &b);
        add(t, &second, first.live[i] ? &first.boxes[i] : &b);
    }
    for (uint32_t i = capacity; i-- > 0 && t->expression == NULL;) {
        if (!first.live[i]) {
            drop(t, &second, i);
        }
    }
    if (t->expression != NULL) {
        return;
    }
    const size_t count = all_pairs(&first, found);
    REQUIRE(t, count == all_pairs(&second, expected));
    REQUIRE_SAME(t, found, expected, 2 * count * sizeof *found);
    compare_all(t, &second, kind);
}

/* A copy of the block elsewhere is the same tree, and goes on as it does. */
static void copy_is_a_tree(property_trial *t)
{
    const uint32_t kind = make_choice(t, "kind", BOX_KINDS);
    const uint32_t capacity = 1 + make_choice(t, "capacity", BOXES);
    const uint32_t steps = make_choice(t, "steps", STEPS);
    plant(t, &first, capacity, make_margin(t));
    property_expand(t);
    for (uint32_t i = 0; i < steps && t->expression == NULL; i++) {
        change(t, &first, kind);
    }
    second = first;
    second.tree = (tribo_tree *)(void *)second.block;
    canary_set(first.block, sizeof first.block);
    for (uint32_t i = 0; i < 4 && t->expression == NULL; i++) {
        change(t, &second, kind);
    }
    if (t->expression == NULL) {
        compare_all(t, &second, kind);
    }
}

/* One call with something wrong: a status, and the tree answers as before. */
static void faults(property_trial *t)
{
    box b;
    double from[3];
    double to[3];
    uint32_t id = 77;
    size_t count = 77;
    const uint32_t kind = make_choice(t, "kind", ANY);
    plant(t, &first, 8, make_margin(t));
    property_expand(t);
    for (uint32_t i = 0; i < 6 && t->expression == NULL; i++) {
        change(t, &first, kind);
    }
    if (t->expression != NULL) {
        return;
    }
    tribo_tree *tree = first.tree;
    make_box(t, kind, &b);
    make_segment(t, kind, from, to);
    REQUIRE_STATUS(t, tribo_tree_add(NULL, b.low, b.high, &id), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_add(tree, NULL, b.high, &id), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_add(tree, b.low, NULL, &id), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_add(tree, b.low, b.high, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_move(NULL, 0, b.low, b.high), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_move(tree, UINT32_MAX, b.low, b.high), TRIBO_ERROR_INDEX);
    REQUIRE_STATUS(t, tribo_tree_remove(NULL, 0), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_remove(tree, UINT32_MAX), TRIBO_ERROR_INDEX);
    REQUIRE_STATUS(t, tribo_tree_pairs(NULL, 0, NULL, &count), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_pairs(tree, 4, NULL, &count), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_pairs(tree, 4, found, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_query_box(tree, b.low, b.high, 4, NULL, &count), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_query_ray(tree, from, NULL, 4, found, &count), TRIBO_ERROR_NULL);
    to[make_choice(t, NULL, 3)] = make_hostile(t, "to");
    REQUIRE_STATUS(t, tribo_tree_query_ray(tree, from, to, 4, found, &count),
                   TRIBO_ERROR_NOT_FINITE);
    const uint32_t axis = make_choice(t, "axis", 3);
    box bad = b;
    bad.high[axis] = (double)NAN;
    REQUIRE_STATUS(t, tribo_tree_add(tree, bad.low, bad.high, &id), TRIBO_ERROR_NOT_FINITE);
    REQUIRE_STATUS(t, tribo_tree_query_box(tree, bad.low, bad.high, 4, found, &count),
                   TRIBO_ERROR_NOT_FINITE);
    bad.low[axis] = 1.0;
    bad.high[axis] = -make_positive(t, "below", -1000, 1000);
    REQUIRE_STATUS(t, tribo_tree_add(tree, bad.low, bad.high, &id), TRIBO_ERROR_RANGE);
    REQUIRE_STATUS(t, tribo_tree_query_box(tree, bad.low, bad.high, 4, found, &count),
                   TRIBO_ERROR_RANGE);
    if (first.live[0]) {
        REQUIRE_STATUS(t, tribo_tree_move(tree, 0, bad.low, bad.high), TRIBO_ERROR_RANGE);
    }
    REQUIRE(t, id == 77 && count == 77);
    compare_all(t, &first, kind);
}

/* Capacities and margins that are none. */
static void init_bad(property_trial *t)
{
    tribo_tree *tree = NULL;
    uint64_t block[64];
    const double margin = make_finite(t, "margin");
    const uint32_t capacity = (uint32_t)make_bits(t, 4);
    canary_set(block, sizeof block);
    const int possible = capacity >= 1 && capacity <= UINT32_C(1) << 30;
    const size_t size = tribo_tree_size(capacity);
    REQUIRE(t, (size > 0) == possible);
    REQUIRE(t, size % 8 == 0 && (!possible || size > (size_t)48 * capacity));
    REQUIRE_STATUS(t, tribo_tree_init(NULL, 1, 0.0, &tree), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_init(block, 1, 0.0, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_tree_init(block, 1, make_hostile(t, "margin"), &tree),
                   TRIBO_ERROR_NOT_FINITE);
    if (margin < 0.0 || !possible) {
        REQUIRE_STATUS(t, tribo_tree_init(block, capacity, margin, &tree), TRIBO_ERROR_RANGE);
    }
    REQUIRE(t, tree == NULL && canary_kept(block, sizeof block));
}

/* In a block of exactly the bytes it needs, so that sanitizers see a step out of it. */
static void full_tree_fits(property_trial *t)
{
    box b;
    const uint32_t kind = make_choice(t, "kind", BOX_KINDS);
    const uint32_t capacity = 1 + make_choice(t, "capacity", BOXES);
    tribo_tree *tree = NULL;
    uint32_t id = 0;
    size_t count = 0;
    tribo_status status = TRIBO_OK;
    void *block = malloc(tribo_tree_size(capacity));
    ASSUME(t, block != NULL);
    memset(block, 0x5a, tribo_tree_size(capacity));
    property_expand(t);
    const tribo_status made = tribo_tree_init(block, capacity, 0.0, &tree);
    for (uint32_t i = 0; i < capacity && status == TRIBO_OK; i++) {
        make_box(t, kind, &b);
        status = tribo_tree_add(tree, b.low, b.high, &id);
    }
    const tribo_status full = tribo_tree_add(tree, b.low, b.high, &id);
    const tribo_status told = tribo_tree_pairs(tree, (size_t)BOXES * BOXES, found, &count);
    free(block);
    REQUIRE_STATUS(t, made, TRIBO_OK);
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE_STATUS(t, full, TRIBO_ERROR_CAPACITY);
    REQUIRE_STATUS(t, told, TRIBO_OK);
}

const char *const property_room = "broad";
const property property_list[] = {
    {"life", life, 4},
    {"history_is_forgotten", history_is_forgotten, 4},
    {"copy_is_a_tree", copy_is_a_tree, 4},
    {"faults", faults, 2},
    {"init_bad", init_bad, 1},
    {"full_tree_fits", full_tree_fits, 4},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 20000;
