/* Broad phase: pairs and queries against brute force, order, ids, statuses, shape of the tree. */

/* The library's own source once more under other names, to look inside a tree. */
#define tribo_tree inside_tree
#define tribo_tree_size inside_tree_size
#define tribo_tree_init inside_tree_init
#define tribo_tree_add inside_tree_add
#define tribo_tree_move inside_tree_move
#define tree_move inside_move
#define tribo_tree_remove inside_tree_remove
#define tribo_tree_pairs inside_tree_pairs
#define tribo_tree_query_box inside_tree_query_box
#define tribo_tree_query_ray inside_tree_query_ray
#include "../src/broad.c"
#undef tribo_tree
#undef tribo_tree_size
#undef tribo_tree_init
#undef tribo_tree_add
#undef tribo_tree_move
#undef tree_move
#undef tribo_tree_remove
#undef tribo_tree_pairs
#undef tribo_tree_query_box
#undef tribo_tree_query_ray
#undef TRIBO_BROAD_H
#undef TRIBO_TREE_H
#include "problems.h"
#include "tree.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define NOT_A_NUMBER ((double)NAN)
#define INFINITE ((double)INFINITY)

enum { BOXES = 1000, SEED = 20160603 };

/* ---- boxes, and what is known of them ------------------------------------------------------- */

typedef struct model {
    double boxes[BOXES][6];
    uint32_t live[BOXES];
    uint32_t count; /* of those that live */
} model;

typedef struct list {
    uint32_t *values;
    size_t count;
} list;

static model known;
static uint32_t expected[BOXES * BOXES];
static uint32_t found[BOXES * BOXES];

static double uniform(problem_random *random, double low, double high)
{
    const double unit = (double)(problem_random_bits(random) >> 11) * 1.1102230246251565e-16;
    return low + (high - low) * unit;
}

static uint32_t below(problem_random *random, uint32_t end)
{
    return (uint32_t)(problem_random_bits(random) % end);
}

enum {
    UNIFORM,
    CLUSTERED,
    IDENTICAL,
    NESTED,
    POINTS,
    HUGE_AND_SMALL,
    INFINITE_SOME,
    COLUMNS,
    GRID,
    TINY_UNIT,
    GREAT_UNIT,
    EDGE_OF_RANGE,
    KINDS
};

static void put_box(double out[6], const double middle[3], const double half[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = middle[k] - half[k];
        out[3 + k] = middle[k] + half[k];
    }
}

static void draw_uniform(problem_random *random, double unit, double out[6])
{
    double middle[3];
    double half[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = unit * uniform(random, -5.0, 5.0);
        half[k] = unit * uniform(random, 0.0, 1.0);
    }
    put_box(out, middle, half);
}

static void draw_around(problem_random *random, const double middle[3], double spread, double size,
                        double out[6])
{
    double place[3];
    double half[3];
    for (int k = 0; k < 3; k++) {
        place[k] = middle[k] + uniform(random, -spread, spread);
        half[k] = uniform(random, 0.0, size);
    }
    put_box(out, place, half);
}

/* Some bounds moved out to infinity, as those of half-spaces; at times both to the same one. */
static void open_up(problem_random *random, double out[6])
{
    const uint64_t bits = problem_random_bits(random);
    for (int k = 0; k < 3; k++) {
        if ((bits >> k & 1u) != 0) {
            out[k] = -INFINITE;
        }
        if ((bits >> (3 + k) & 1u) != 0) {
            out[3 + k] = INFINITE;
        }
    }
    if ((bits >> 6) % 16 == 0) {
        out[0] = out[3] = INFINITE;
    }
}

static void draw(problem_random *random, int kind, double out[6])
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    const double corner[3] = {(double)below(random, 5) * 1e3, (double)below(random, 2) * -1e4, 0.0};
    draw_uniform(random, 1.0, out);
    switch (kind) {
    case CLUSTERED:
        draw_around(random, corner, 2.0, 0.5, out);
        break;
    case IDENTICAL:
        if (below(random, 20) != 0) {
            static const double one[6] = {-1.0, -1.0, -1.0, 1.0, 1.0, 1.0};
            memcpy(out, one, sizeof one);
        }
        break;
    case NESTED: {
        const double size = ldexp(1.0, (int)below(random, 200) - 100);
        const double half[3] = {size, size, size};
        put_box(out, origin, half);
        break;
    }
    case POINTS:
        for (int k = 0; k < 3; k++) {
            out[k] = out[3 + k] = (double)below(random, 8);
        }
        break;
    case HUGE_AND_SMALL:
        draw_uniform(random, pow(10.0, uniform(random, -8.0, 8.0)), out);
        break;
    case INFINITE_SOME:
        if (below(random, 10) == 0) {
            open_up(random, out);
        }
        break;
    case COLUMNS:
        out[2] = -INFINITE;
        out[5] = INFINITE;
        break;
    case GRID:
        for (int k = 0; k < 3; k++) {
            out[k] = (double)below(random, 12);
            out[3 + k] = out[k] + (double)below(random, 3);
        }
        break;
    case TINY_UNIT:
        draw_uniform(random, 1e-305, out);
        break;
    case GREAT_UNIT:
        draw_uniform(random, 1e30, out);
        break;
    case EDGE_OF_RANGE:
        draw_uniform(random, 2.9e307, out);
        break;
    default:
        break;
    }
}

static tribo_tree *make_tree(uint32_t capacity, double margin)
{
    tribo_tree *tree = NULL;
    void *block = malloc(tribo_tree_size(capacity));
    assert_non_null(block);
    assert_int_equal(tribo_tree_init(block, capacity, margin, &tree), TRIBO_OK);
    assert_ptr_equal(tree, block);
    return tree;
}

/* ---- brute force ---------------------------------------------------------------------------- */

static int overlap(const double *a, const double *b)
{
    for (int k = 0; k < 3; k++) {
        if (a[k] > b[3 + k] || b[k] > a[3 + k]) {
            return 0;
        }
    }
    return 1;
}

static size_t expect_pairs(void)
{
    size_t count = 0;
    for (uint32_t i = 0; i < BOXES; i++) {
        for (uint32_t j = i + 1; j < BOXES; j++) {
            if (known.live[i] && known.live[j] && overlap(known.boxes[i], known.boxes[j])) {
                expected[2 * count] = i;
                expected[2 * count + 1] = j;
                count++;
            }
        }
    }
    return count;
}

static size_t expect_overlaps(const double wanted[6])
{
    size_t count = 0;
    for (uint32_t i = 0; i < BOXES; i++) {
        if (known.live[i] && overlap(known.boxes[i], wanted)) {
            expected[count++] = i;
        }
    }
    return count;
}

static void assert_found(size_t count, size_t wanted, size_t width)
{
    assert_int_equal(count, wanted);
    assert_memory_equal(found, expected, width * wanted * sizeof *found);
}

static void compare_pairs(const tribo_tree *tree)
{
    size_t count = 0;
    assert_int_equal(tribo_tree_pairs(tree, BOXES * BOXES / 2, found, &count), TRIBO_OK);
    assert_found(count, expect_pairs(), 2);
}

static void compare_overlaps(const tribo_tree *tree, const double wanted[6])
{
    size_t count = 0;
    assert_int_equal(tribo_tree_query_box(tree, wanted, wanted + 3, BOXES, found, &count),
                     TRIBO_OK);
    assert_found(count, expect_overlaps(wanted), 1);
}

/* Gap between where the segment leaves the slabs of a box and where it enters them, in parts of
 * the segment; negative: missed. Long doubles: to be trusted beyond 1e-12. */
static long double gap(const double box[6], const double from[3], const double to[3])
{
    long double enter = 0.0L;
    long double leave = 1.0L;
    for (int k = 0; k < 3; k++) {
        const long double along = (long double)to[k] - (long double)from[k];
        if (fmax(from[k], to[k]) < box[k] || fmin(from[k], to[k]) > box[3 + k]) {
            return -(long double)INFINITE;
        }
        if (to[k] == from[k]) {
            continue;
        }
        const long double a = ((long double)box[k] - (long double)from[k]) / along;
        const long double b = ((long double)box[3 + k] - (long double)from[k]) / along;
        enter = fmaxl(enter, fminl(a, b));
        leave = fminl(leave, fmaxl(a, b));
    }
    return leave - enter;
}

static void compare_ray(const tribo_tree *tree, const double from[3], const double to[3])
{
    size_t count = 0;
    assert_int_equal(tribo_tree_query_ray(tree, from, to, BOXES, found, &count), TRIBO_OK);
    size_t at = 0;
    for (uint32_t i = 0; i < BOXES; i++) {
        const int told = at < count && found[at] == i;
        const long double by =
            known.live[i] ? gap(known.boxes[i], from, to) : -(long double)INFINITE;
        if (told) {
            assert_true(by >= -1e-12L);
            at++;
        } else {
            assert_true(by < 0.0L);
        }
    }
    assert_int_equal(at, count);
}

static void compare_all(problem_random *random, const tribo_tree *tree, int kind)
{
    compare_pairs(tree);
    for (int i = 0; i < 20; i++) {
        double wanted[6];
        double other[6];
        draw(random, kind, wanted);
        compare_overlaps(tree, wanted);
        draw(random, kind, other);
        if (fabs(wanted[0]) < INFINITE && fabs(wanted[1]) < INFINITE &&
            fabs(wanted[2]) < INFINITE && fabs(other[0]) < INFINITE && fabs(other[1]) < INFINITE &&
            fabs(other[2]) < INFINITE) {
            compare_ray(tree, wanted, other);
            other[1] = wanted[1]; /* along a coordinate plane */
            compare_ray(tree, wanted, other);
            compare_ray(tree, wanted, wanted);
        }
    }
}

/* ---- random lives --------------------------------------------------------------------------- */

static double own_margin;

static void add(tribo_tree *tree, const double box[6])
{
    uint32_t id = UINT32_MAX;
    uint32_t smallest = 0;
    while (known.live[smallest]) {
        smallest++;
    }
    assert_int_equal(tribo_tree_add(tree, box, box + 3, &id), TRIBO_OK);
    assert_int_equal(id, smallest);
    memcpy(known.boxes[id], box, sizeof known.boxes[id]);
    known.live[id] = 1;
    known.count++;
}

static void drop(tribo_tree *tree, uint32_t id)
{
    assert_int_equal(tribo_tree_remove(tree, id), TRIBO_OK);
    known.live[id] = 0;
    known.count--;
}

/* Some by margins of their own. */
static void shift(tribo_tree *tree, uint32_t id, const double box[6])
{
    const tribo_status status = id % 2 == 0
                                    ? tribo_tree_move(tree, id, box, box + 3)
                                    : tree_move(tree, id, box, box + 3, own_margin * (id % 8));
    assert_int_equal(status, TRIBO_OK);
    memcpy(known.boxes[id], box, sizeof known.boxes[id]);
}

/* Most move a little, as bodies do; some jump. */
static void change(problem_random *random, tribo_tree *tree, int kind, double unit)
{
    for (uint32_t id = 0; id < BOXES; id++) {
        double box[6];
        draw(random, kind, box);
        const uint32_t what = below(random, 16);
        if (!known.live[id]) {
            if (what < 8) {
                add(tree, box);
            }
        } else if (what == 0) {
            drop(tree, id);
        } else if (what < 3) {
            shift(tree, id, box);
        } else if (what < 12) {
            for (int k = 0; k < 3; k++) {
                const double by = unit * uniform(random, -0.05, 0.05);
                box[k] = known.boxes[id][k] + by;
                box[3 + k] = known.boxes[id][3 + k] + by;
            }
            shift(tree, id, box);
        }
    }
}

static void live(int kind, double margin, double unit)
{
    problem_random random = {SEED + (uint64_t)kind};
    memset(&known, 0, sizeof known);
    tribo_tree *tree = make_tree(BOXES, margin * unit);
    own_margin = margin * unit;
    compare_pairs(tree);
    for (uint32_t i = 0; i < BOXES; i++) {
        double box[6];
        draw(&random, kind, box);
        add(tree, box);
    }
    compare_all(&random, tree, kind);
    for (uint64_t round = 0; round < problem_count(10); round++) {
        change(&random, tree, kind, unit);
        compare_all(&random, tree, kind);
    }
    while (known.count > 0) {
        const uint32_t id = below(&random, BOXES);
        if (known.live[id]) {
            drop(tree, id);
            if (known.count % 100 == 1) {
                compare_all(&random, tree, kind);
            }
        }
    }
    compare_all(&random, tree, kind);
    free(tree);
}

static void test_brute_force(void **state)
{
    (void)state;
    static const double margins[3] = {0.0, 0.1, 10.0};
    for (int kind = 0; kind < KINDS; kind++) {
        const double unit = kind == TINY_UNIT       ? 1e-305
                            : kind == GREAT_UNIT    ? 1e30
                            : kind == EDGE_OF_RANGE ? 2.9e307
                                                    : 1.0;
        for (int m = 0; m < (kind == EDGE_OF_RANGE ? 2 : 3); m++) {
            live(kind, margins[m], unit);
        }
    }
}

/* ---- touching, signs of zero ---------------------------------------------------------------- */

static void test_touching(void **state)
{
    (void)state;
    memset(&known, 0, sizeof known);
    tribo_tree *tree = make_tree(BOXES, 0.5);
    static const double boxes[8][6] = {
        {0.0, 0.0, 0.0, 1.0, 1.0, 1.0},
        {1.0, 0.0, 0.0, 2.0, 1.0, 1.0},                     /* face */
        {1.0, 1.0, 0.0, 2.0, 2.0, 1.0},                     /* edge */
        {1.0, 1.0, 1.0, 2.0, 2.0, 2.0},                     /* corner */
        {1.0000000000000002, 0.0, 0.0, 2.0, 1.0, 1.0},      /* one ulp beyond */
        {-1.0, 0.0, 0.0, -0.0, 1.0, 1.0},                   /* face at -0 */
        {-0.0, -0.0, -0.0, -0.0, -0.0, -0.0},               /* point at the corner */
        {-1.0, -1.0, -1.0, -4.9406564584124654e-324, 1, 1}, /* least number below 0 */
    };
    for (int i = 0; i < 8; i++) {
        add(tree, boxes[i]);
    }
    compare_pairs(tree);
    size_t count = 0;
    static const uint32_t of_first[4] = {1, 2, 3, 5};
    static const double least[6] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    assert_int_equal(tribo_tree_pairs(tree, BOXES, found, &count), TRIBO_OK);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(found[2 * i], 0);
        assert_int_equal(found[2 * i + 1], of_first[i]);
    }
    assert_int_equal(tribo_tree_query_box(tree, least, least + 3, BOXES, found, &count), TRIBO_OK);
    assert_int_equal(count, 4);
    /* Segments that end on a face, start on one, slide along one, pass a corner, and stop an ulp
     * before. */
    static const double rays[6][6] = {
        {-3.0, 0.5, 0.5, -1.0, 0.5, 0.5},   {2.0, 0.5, 0.5, 9.0, 0.25, 0.5},
        {-9.0, 0.5, 1.0, 9.0, 0.5, 1.0},    {3.0, 0.0, 0.0, 1.0, 2.0, 4.0},
        {-0.0, -3.0, -3.0, 0.0, -0.0, 0.0}, {-3.0, 0.5, 0.5, -1.0000000000000002, 0.5, 0.5},
    };
    static const size_t counts[6] = {2, 2, 5, 1, 3, 0};
    for (int i = 0; i < 6; i++) {
        compare_ray(tree, rays[i], rays[i] + 3);
        assert_int_equal(tribo_tree_query_ray(tree, rays[i], rays[i] + 3, BOXES, found, &count),
                         TRIBO_OK);
        assert_int_equal(count, counts[i]);
    }
    free(tree);
}

/* On a grid the truth is a comparison of fractions of small integers: neither missed nor
 * invented, whatever the unit. */
static int meets_exactly(const int64_t box[6], const int64_t from[3], const int64_t to[3])
{
    int64_t enter[2] = {0, 1}; /* numerator, denominator > 0 */
    int64_t leave[2] = {1, 1};
    for (int k = 0; k < 3; k++) {
        int64_t along = to[k] - from[k];
        int64_t a = box[k] - from[k];
        int64_t b = box[3 + k] - from[k];
        if (along == 0) {
            if (a > 0 || b < 0) {
                return 0;
            }
            continue;
        }
        if (along < 0) {
            const int64_t other = -a;
            a = -b;
            b = other;
            along = -along;
        }
        if (a * enter[1] > enter[0] * along) {
            enter[0] = a;
            enter[1] = along;
        }
        if (b * leave[1] < leave[0] * along) {
            leave[0] = b;
            leave[1] = along;
        }
    }
    return enter[0] * leave[1] <= leave[0] * enter[1];
}

static void test_ray_on_grid(void **state)
{
    (void)state;
    static int64_t grid[BOXES][6];
    static const double units[3] = {1.0, 0x1p-1040, 0x1p1019};
    for (int u = 0; u < 3; u++) {
        problem_random random = {SEED};
        tribo_tree *tree = make_tree(BOXES, 0.0);
        for (int i = 0; i < BOXES; i++) {
            double box[6];
            uint32_t id;
            for (int k = 0; k < 3; k++) {
                grid[i][k] = below(&random, 14);
                grid[i][3 + k] = grid[i][k] + below(&random, 3);
                box[k] = units[u] * (double)grid[i][k];
                box[3 + k] = units[u] * (double)grid[i][3 + k];
            }
            assert_int_equal(tribo_tree_add(tree, box, box + 3, &id), TRIBO_OK);
        }
        for (uint64_t n = 0; n < problem_count(2000); n++) {
            int64_t ends[6];
            double ray[6];
            size_t wanted = 0;
            size_t count = 0;
            for (int k = 0; k < 6; k++) {
                ends[k] = (int64_t)below(&random, 24) - 4;
                ray[k] = units[u] * (double)ends[k];
            }
            for (uint32_t i = 0; i < BOXES; i++) {
                if (meets_exactly(grid[i], ends, ends + 3)) {
                    expected[wanted++] = i;
                }
            }
            assert_int_equal(tribo_tree_query_ray(tree, ray, ray + 3, BOXES, found, &count),
                             TRIBO_OK);
            assert_found(count, wanted, 1);
        }
        free(tree);
    }
}

/* ---- history does not matter ---------------------------------------------------------------- */

static list list_of(const tribo_tree *tree)
{
    list made = {malloc(2 * BOXES * BOXES * sizeof *made.values), 0};
    assert_non_null(made.values);
    assert_int_equal(tribo_tree_pairs(tree, BOXES * BOXES, made.values, &made.count), TRIBO_OK);
    return made;
}

static void assert_same_answers(problem_random *random, const tribo_tree *a, const tribo_tree *b)
{
    list of_a = list_of(a);
    list of_b = list_of(b);
    assert_int_equal(of_a.count, of_b.count);
    assert_memory_equal(of_a.values, of_b.values, 2 * of_a.count * sizeof *of_a.values);
    free(of_a.values);
    free(of_b.values);
    for (int i = 0; i < 100; i++) {
        double box[6];
        size_t counts[4];
        draw(random, UNIFORM, box);
        assert_int_equal(tribo_tree_query_box(a, box, box + 3, BOXES, found, &counts[0]), TRIBO_OK);
        assert_int_equal(tribo_tree_query_box(b, box, box + 3, BOXES, expected, &counts[1]),
                         TRIBO_OK);
        assert_found(counts[0], counts[1], 1);
        assert_int_equal(tribo_tree_query_ray(a, box, box + 3, BOXES, found, &counts[2]), TRIBO_OK);
        assert_int_equal(tribo_tree_query_ray(b, box, box + 3, BOXES, expected, &counts[3]),
                         TRIBO_OK);
        assert_found(counts[2], counts[3], 1);
    }
}

static void test_history(void **state)
{
    (void)state;
    problem_random random = {SEED};
    tribo_tree *plain = make_tree(BOXES, 0.0);
    tribo_tree *tangled = make_tree(2 * BOXES, 0.3);
    static double boxes[BOXES][6];
    uint32_t id;
    double other[6];
    for (int i = 0; i < BOXES; i++) {
        draw(&random, i % 2 == 0 ? UNIFORM : GRID, boxes[i]);
        assert_int_equal(tribo_tree_add(plain, boxes[i], boxes[i] + 3, &id), TRIBO_OK);
    }
    for (int i = 0; i < 2 * BOXES; i++) {
        draw(&random, i % KINDS, other);
        assert_int_equal(tribo_tree_add(tangled, other, other + 3, &id), TRIBO_OK);
    }
    for (uint32_t i = 2 * BOXES; i-- > BOXES;) {
        assert_int_equal(tribo_tree_remove(tangled, i), TRIBO_OK);
    }
    for (int i = 0; i < 20 * BOXES; i++) {
        draw(&random, i % KINDS, other);
        id = below(&random, BOXES);
        assert_int_equal(tribo_tree_move(tangled, id, other, other + 3), TRIBO_OK);
    }
    for (uint32_t i = BOXES; i-- > 0;) {
        assert_int_equal(tribo_tree_move(tangled, i, boxes[i], boxes[i] + 3), TRIBO_OK);
    }
    assert_same_answers(&random, plain, tangled);
    free(plain);
    free(tangled);
}

static void test_copied_block(void **state)
{
    (void)state;
    problem_random random = {SEED};
    memset(&known, 0, sizeof known);
    tribo_tree *tree = make_tree(BOXES, 0.1);
    while (known.count < BOXES - 50) {
        double box[6];
        draw(&random, UNIFORM, box);
        add(tree, box);
    }
    change(&random, tree, UNIFORM, 1.0);
    const size_t size = tribo_tree_size(BOXES);
    tribo_tree *copy = malloc(size);
    assert_non_null(copy);
    memcpy(copy, tree, size);
    assert_same_answers(&random, tree, copy);
    memset(tree, 0xff, size);
    free(tree);
    compare_all(&random, copy, UNIFORM);
    change(&random, copy, UNIFORM, 1.0);
    compare_all(&random, copy, UNIFORM);
    free(copy);
}

/* ---- ids, capacity, statuses ---------------------------------------------------------------- */

static void test_ids(void **state)
{
    (void)state;
    enum { MANY = 5000 }; /* three levels of 64 */
    static const double at[3] = {0.0, 0.0, 0.0};
    static uint8_t live[MANY];
    problem_random random = {SEED};
    tribo_tree *tree = make_tree(MANY, 0.0);
    uint32_t id;
    for (uint32_t i = 0; i < MANY; i++) {
        assert_int_equal(tribo_tree_add(tree, at, at, &id), TRIBO_OK);
        assert_int_equal(id, i);
        live[i] = 1;
    }
    id = 77;
    assert_int_equal(tribo_tree_add(tree, at, at, &id), TRIBO_ERROR_CAPACITY);
    assert_int_equal(id, 77);
    for (int round = 0; round < 2000; round++) {
        const uint32_t gone = below(&random, MANY);
        const tribo_status wanted = live[gone] ? TRIBO_OK : TRIBO_ERROR_INDEX;
        assert_int_equal(tribo_tree_remove(tree, gone), wanted);
        assert_int_equal(tribo_tree_move(tree, gone, at, at), TRIBO_ERROR_INDEX);
        live[gone] = 0;
        if (round % 3 == 0) {
            const uint8_t *first = memchr(live, 0, MANY);
            assert_non_null(first);
            assert_int_equal(tribo_tree_add(tree, at, at, &id), TRIBO_OK);
            assert_int_equal(id, first - live);
            live[id] = 1;
        }
    }
    free(tree);
}

static void test_sizes(void **state)
{
    (void)state;
    tribo_tree *tree = NULL;
    double block[128];
    assert_int_equal(tribo_tree_size(0), 0);
    assert_int_equal(tribo_tree_size((UINT32_C(1) << 30) + 1u), 0);
    assert_int_equal(tribo_tree_size(UINT32_MAX), 0);
    assert_true(tribo_tree_size(1) > 0 && tribo_tree_size(1) <= sizeof block);
    assert_true(tribo_tree_size(1000001) > tribo_tree_size(1000000));
    assert_true(sizeof(size_t) < 8 || tribo_tree_size(UINT32_C(1) << 30) > 0);
    assert_int_equal(tribo_tree_init(NULL, 1, 0.0, &tree), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_init(block, 1, 0.0, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_init(block, 0, 0.0, &tree), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_tree_init(block, UINT32_MAX, 0.0, &tree), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_tree_init(block, 1, -1e-300, &tree), TRIBO_ERROR_RANGE);
    assert_int_equal(tribo_tree_init(block, 1, NOT_A_NUMBER, &tree), TRIBO_ERROR_NOT_FINITE);
    assert_int_equal(tribo_tree_init(block, 1, INFINITE, &tree), TRIBO_ERROR_NOT_FINITE);
    assert_null(tree);
    assert_int_equal(tribo_tree_init(block, 1, -0.0, &tree), TRIBO_OK);
}

/* The tree and all outputs are the same bytes after a call that fails. */
static void test_statuses(void **state)
{
    (void)state;
    static const double low[3] = {0.0, 0.0, 0.0};
    static const double high[3] = {1.0, 1.0, 1.0};
    const size_t size = tribo_tree_size(4);
    tribo_tree *tree = calloc(1, size);
    void *before = malloc(size);
    assert_non_null(tree);
    assert_non_null(before);
    assert_int_equal(tribo_tree_init(tree, 4, 0.1, &tree), TRIBO_OK);
    uint32_t id = 9;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(tribo_tree_add(tree, low, high, &id), TRIBO_OK);
    }
    memcpy(before, tree, size);
    id = 9;
    size_t count = 8;
    uint32_t out[6] = {7, 7, 7, 7, 7, 7};
    for (int k = 0; k < 3; k++) {
        double bad[3] = {0.5, 0.5, 0.5};
        bad[k] = NOT_A_NUMBER;
        assert_int_equal(tribo_tree_add(tree, bad, high, &id), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_tree_add(tree, low, bad, &id), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_tree_move(tree, 0, bad, high), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_tree_move(tree, 0, low, bad), TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_tree_query_box(tree, bad, high, 3, out, &count),
                         TRIBO_ERROR_NOT_FINITE);
        assert_int_equal(tribo_tree_query_box(tree, low, bad, 3, out, &count),
                         TRIBO_ERROR_NOT_FINITE);
        for (int sign = 0; sign < 2; sign++) {
            assert_int_equal(tribo_tree_query_ray(tree, bad, high, 3, out, &count),
                             TRIBO_ERROR_NOT_FINITE);
            assert_int_equal(tribo_tree_query_ray(tree, low, bad, 3, out, &count),
                             TRIBO_ERROR_NOT_FINITE);
            bad[k] = INFINITE;
        }
        bad[k] = 1.5;
        assert_int_equal(tribo_tree_add(tree, bad, high, &id), TRIBO_ERROR_RANGE);
        assert_int_equal(tribo_tree_move(tree, 0, bad, high), TRIBO_ERROR_RANGE);
        assert_int_equal(tribo_tree_query_box(tree, bad, high, 3, out, &count), TRIBO_ERROR_RANGE);
    }
    assert_int_equal(tribo_tree_add(NULL, low, high, &id), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_add(tree, NULL, high, &id), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_add(tree, low, NULL, &id), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_add(tree, low, high, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_move(NULL, 0, low, high), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_move(tree, 0, NULL, high), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_move(tree, 0, low, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_move(tree, 3, low, high), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_tree_move(tree, UINT32_MAX, low, high), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_tree_remove(NULL, 0), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_remove(tree, 3), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_tree_remove(tree, UINT32_MAX), TRIBO_ERROR_INDEX);
    assert_int_equal(tribo_tree_pairs(NULL, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_pairs(tree, 3, NULL, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_pairs(tree, 3, out, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_box(NULL, low, high, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_box(tree, NULL, high, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_box(tree, low, NULL, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_box(tree, low, high, 3, NULL, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_box(tree, low, high, 3, out, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_ray(NULL, low, high, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_ray(tree, NULL, high, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_ray(tree, low, NULL, 3, out, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_ray(tree, low, high, 3, NULL, &count), TRIBO_ERROR_NULL);
    assert_int_equal(tribo_tree_query_ray(tree, low, high, 3, out, NULL), TRIBO_ERROR_NULL);
    assert_int_equal(id, 9);
    assert_int_equal(count, 8);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(out[i], 7);
    }
    assert_memory_equal(tree, before, size);
    free(before);
    free(tree);
}

/* Too little room: the count is told, and nothing is written beyond the room. */
static void test_room(void **state)
{
    (void)state;
    static const double low[3] = {0.0, 0.0, 0.0};
    static const double high[3] = {1.0, 1.0, 1.0};
    tribo_tree *tree = make_tree(100, 0.0);
    size_t count = 0;
    uint32_t id;
    for (int i = 0; i < 100; i++) {
        assert_int_equal(tribo_tree_add(tree, low, high, &id), TRIBO_OK);
    }
    uint32_t *out = malloc(2 * 4950 * sizeof *out);
    assert_non_null(out);
    for (uint32_t room = 0; room < 3; room++) {
        memset(out, 0x55, 2 * 4950 * sizeof *out);
        assert_int_equal(tribo_tree_pairs(tree, room, room ? out : NULL, &count),
                         TRIBO_ERROR_CAPACITY);
        assert_int_equal(count, 4950);
        assert_int_equal(out[2 * room], 0x55555555);
        assert_int_equal(tribo_tree_query_box(tree, low, low, room, room ? out : NULL, &count),
                         TRIBO_ERROR_CAPACITY);
        assert_int_equal(count, 100);
        assert_int_equal(tribo_tree_query_ray(tree, low, high, room, room ? out : NULL, &count),
                         TRIBO_ERROR_CAPACITY);
        assert_int_equal(count, 100);
        assert_int_equal(out[2 * room], 0x55555555);
    }
    assert_int_equal(tribo_tree_pairs(tree, 4949, out, &count), TRIBO_ERROR_CAPACITY);
    assert_int_equal(tribo_tree_pairs(tree, 4950, out, &count), TRIBO_OK);
    assert_int_equal(out[2 * 4949], 98);
    assert_int_equal(out[2 * 4949 + 1], 99);
    assert_int_equal(tribo_tree_query_box(tree, low, low, 99, out, &count), TRIBO_ERROR_CAPACITY);
    assert_int_equal(tribo_tree_query_box(tree, low, low, 100, out, &count), TRIBO_OK);
    free(out);
    free(tree);
    tree = make_tree(1, 0.0);
    assert_int_equal(tribo_tree_pairs(tree, 0, NULL, &count), TRIBO_OK);
    assert_int_equal(count, 0);
    free(tree);
}

/* ---- inside --------------------------------------------------------------------------------- */

/* Everything that the code relies on; returns the height. */
static uint32_t inspect(inside_tree *tree)
{
    const tree_node *nodes = read_nodes(tree);
    uint32_t leaves = 0;
    uint32_t pairs = 0;
    for (uint32_t at = 0; tree->count > 0 && at < 2u * tree->pair_end; at++) {
        if (at == 1 || (at > 1 && nodes[at & ~1u].parent == NONE)) {
            continue;
        }
        const tree_node *n = &nodes[at];
        if (at > 0) {
            assert_int_equal(nodes[n->parent].link, at / 2u);
            assert_true(nodes[n->parent].height > 0);
            assert_true(contains(&nodes[n->parent].box, outer_box(tree, at)));
        }
        if (n->height == 0) {
            assert_int_equal(places_of(tree)[n->link], at);
            assert_true(contains(outer_box(tree, at), &n->box));
            leaves++;
            continue;
        }
        const tree_node *children = &nodes[2u * n->link];
        const tree_box both =
            join(outer_box(tree, 2u * n->link), outer_box(tree, 2u * n->link + 1u));
        assert_true(contains(&both, &n->box));
        assert_int_equal(n->height, 1u + taller(children[0].height, children[1].height));
        assert_true(balanced(children[0].height, children[1].height));
        pairs++;
    }
    assert_int_equal(leaves, tree->count);
    assert_int_equal(pairs, tree->count > 0 ? tree->count - 1u : 0);
    return tree->count > 0 ? nodes[0].height : 0;
}

static inside_tree *make_inside(uint32_t capacity, double margin)
{
    inside_tree *tree = NULL;
    void *block = malloc(inside_tree_size(capacity));
    assert_non_null(block);
    assert_int_equal(inside_tree_init(block, capacity, margin, &tree), TRIBO_OK);
    return tree;
}

static void test_invariants(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        problem_random random = {SEED};
        inside_tree *tree = make_inside(BOXES, kind % 2 == 0 ? 0.0 : 0.2);
        for (uint64_t step = 0; step < problem_count(20000); step++) {
            double box[6];
            uint32_t id = below(&random, BOXES);
            draw(&random, kind, box);
            if (step / 2000 % 3 == 2) {
                (void)inside_tree_remove(tree, id);
            } else if (inside_tree_move(tree, id, box, box + 3) != TRIBO_OK) {
                assert_int_equal(inside_tree_add(tree, box, box + 3, &id), TRIBO_OK);
            }
            if (step % 50 == 0) {
                (void)inspect(tree);
            }
        }
        free(tree);
    }
}

/* Boxes in orders that make plain trees lists. */
enum { SORTED, REVERSED, TOUCHING_ROW, GROWING, SHRINKING, SAME, HALF_SPACES, ZIGZAG, ORDERS };

static void order_box(int order, uint32_t i, uint32_t count, double out[6])
{
    const double x = (double)(order == REVERSED ? count - i : i);
    double low = 2.0 * x;
    double high = 2.0 * x + (order == TOUCHING_ROW ? 2.0 : 1.0);
    if (order == GROWING || order == SHRINKING) {
        high = pow(1.002, order == GROWING ? x : -x);
        low = -high;
    } else if (order == SAME) {
        low = high = 0.0;
    } else if (order == HALF_SPACES) {
        high = INFINITE;
    } else if (order == ZIGZAG) {
        low = high = i % 2 == 0 ? x : -x;
    }
    for (int k = 0; k < 3; k++) {
        out[k] = k == 0 || order == GROWING || order == SHRINKING ? low : -1.0;
        out[3 + k] = k == 0 || order == GROWING || order == SHRINKING ? high : 1.0;
    }
}

static void test_shallow(void **state)
{
    (void)state;
    enum { COUNT = 1 << 14 };
    static const char *const names[ORDERS] = {"sorted",    "reversed", "touching",    "growing",
                                              "shrinking", "same",     "half-spaces", "zigzag"};
    for (int order = 0; order < ORDERS; order++) {
        inside_tree *tree = make_inside(COUNT, 0.0);
        uint32_t id;
        double box[6];
        for (uint32_t i = 0; i < COUNT; i++) {
            order_box(order, i, COUNT, box);
            assert_int_equal(inside_tree_add(tree, box, box + 3, &id), TRIBO_OK);
        }
        const uint32_t full = inspect(tree);
        for (uint32_t i = 0; i < COUNT - 256; i++) { /* one side empties first */
            assert_int_equal(inside_tree_remove(tree, i), TRIBO_OK);
        }
        const uint32_t rest = inspect(tree);
        print_message("# %s: height %u of 2^14 leaves, %u of 2^8\n", names[order], full, rest);
        assert_true(full <= 25); /* 1.82 log2, with rounding up: what the balance promises */
        assert_true(rest <= 14);
        free(tree);
    }
}

/* The fewest leaves of a tree of the height that stacks are made for are more than any tree has. */
static void test_height_bound(void **state)
{
    (void)state;
    uint64_t fewest[MAX_HEIGHT + 1];
    for (int h = 0; h <= MAX_HEIGHT; h++) {
        fewest[h] = h == 0 ? 1 : fewest[h - 1] + (h > SLACK ? fewest[h - 1 - SLACK] : 1);
    }
    assert_true(fewest[MAX_HEIGHT] > MAX_CAPACITY);
}

/* Enough steps of tidying put all pairs into depth-first order. */
static void test_order_in_memory(void **state)
{
    (void)state;
    problem_random random = {SEED};
    inside_tree *tree = make_inside(BOXES, 0.0);
    for (int round = 0; round < 3; round++) {
        double box[6];
        uint32_t id;
        while (tree->count < BOXES - 1) {
            draw(&random, CLUSTERED, box);
            assert_int_equal(inside_tree_add(tree, box, box + 3, &id), TRIBO_OK);
        }
        for (int i = 0; i < 100 * round; i++) { /* with gaps and without */
            (void)inside_tree_remove(tree, below(&random, BOXES));
        }
        for (int i = 0; i < 3 * BOXES; i++) {
            tidy(tree);
        }
        (void)inspect(tree);
        const tree_node *nodes = read_nodes(tree);
        uint32_t last = nodes[0].link;
        for (uint32_t pair = last; pair != 0; pair = next_pair(nodes, pair)) {
            assert_true(pair >= last);
            last = pair;
        }
    }
    free(tree);
}

/* Sum of the half-perimeters of all inner nodes across x and y: what a query for columns costs. */
static double cost_of(inside_tree *tree)
{
    const tree_node *nodes = read_nodes(tree);
    double sum = 0.0;
    for (uint32_t at = 0; at < 2u * tree->pair_end; at++) {
        if (at != 1 && nodes[at].height > 0) {
            const tree_box *b = &nodes[at].box;
            sum += (b->high[0] - b->low[0]) + (b->high[1] - b->low[1]);
        }
    }
    return sum;
}

static void move_by(problem_random *random, double out[6], double most)
{
    for (int k = 0; k < 2; k++) {
        const double by = uniform(random, -most, most);
        out[k] += by;
        out[3 + k] += by;
    }
}

/* Boxes without bounds along an axis are told apart by the others; and a tree whose boxes have
 * moved for long, by little or far, is nearly as good as a new one. */
static void test_quality(void **state)
{
    (void)state;
    static double boxes[BOXES][6];
    problem_random random = {SEED};
    inside_tree *tree = make_inside(BOXES, 0.05);
    inside_tree *fresh = make_inside(BOXES, 0.05);
    uint32_t id;
    for (uint32_t i = 0; i < BOXES; i++) {
        draw(&random, COLUMNS, boxes[i]);
        for (int k = 0; k < 2; k++) {
            boxes[i][k] *= 8.0;
            boxes[i][3 + k] = boxes[i][k] + 1.0;
        }
        assert_int_equal(inside_tree_add(tree, boxes[i], boxes[i] + 3, &id), TRIBO_OK);
    }
    for (int round = 0; round < 200; round++) {
        for (uint32_t i = 0; i < BOXES; i++) {
            move_by(&random, boxes[i], i % 10 == 0 ? 8.0 : 0.1);
            assert_int_equal(inside_tree_move(tree, i, boxes[i], boxes[i] + 3), TRIBO_OK);
        }
    }
    (void)inspect(tree);
    for (uint32_t i = 0; i < BOXES; i++) {
        boxes[i][2] = -1.0;
        boxes[i][5] = 1.0;
        assert_int_equal(inside_tree_add(fresh, boxes[i], boxes[i] + 3, &id), TRIBO_OK);
    }
    const double ratio = cost_of(tree) / cost_of(fresh);
    print_message("# cost of columns after many moves: %.3f of that of new boxes\n", ratio);
    assert_true(ratio < 1.05);
    free(tree);
    free(fresh);
}

/* Moves within the margin leave the tree alone; a box that has become much smaller does not keep
 * its old bounds. */
static void test_margin(void **state)
{
    (void)state;
    inside_tree *tree = make_inside(4, 0.5);
    double box[6] = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0};
    uint32_t id = 0;
    assert_int_equal(inside_tree_add(tree, box, box + 3, &id), TRIBO_OK);
    box[0] += 0.5;
    box[3] += 0.5;
    assert_int_equal(inside_tree_move(tree, id, box, box + 3), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == 1.5);
    box[3] += 0.0625;
    assert_int_equal(inside_tree_move(tree, id, box, box + 3), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == 2.0625);
    box[3] = INFINITE;
    assert_int_equal(inside_tree_move(tree, id, box, box + 3), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == INFINITE);
    box[3] = 1.0;
    assert_int_equal(inside_tree_move(tree, id, box, box + 3), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == 1.5);
    box[3] = 2.0;
    assert_int_equal(inside_move(tree, id, box, box + 3, 4.0), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == 6.0);
    box[3] = 3.0;
    assert_int_equal(inside_move(tree, id, box, box + 3, 4.0), TRIBO_OK);
    assert_true(outer_box(tree, 0)->high[0] == 6.0);
    free(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brute_force),  cmocka_unit_test(test_touching),
        cmocka_unit_test(test_ray_on_grid),  cmocka_unit_test(test_history),
        cmocka_unit_test(test_copied_block), cmocka_unit_test(test_ids),
        cmocka_unit_test(test_sizes),        cmocka_unit_test(test_statuses),
        cmocka_unit_test(test_room),         cmocka_unit_test(test_invariants),
        cmocka_unit_test(test_shallow),      cmocka_unit_test(test_height_bound),
        cmocka_unit_test(test_margin),       cmocka_unit_test(test_order_in_memory),
        cmocka_unit_test(test_quality),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
