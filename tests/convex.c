/* The axis of least translation of any two convex shapes: directions against the truth in
 * classes of pairs that are hard for one reason each, beside libccd alone; margins, liars,
 * scale, bounds of work. */
#include "pair.h"

#include "pairs.h"
#include "problems.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SEED 20160604u

static const double wrong = 0.01;       /* share of the depth by which the way is too long */
static const double far_calls = 2000.0; /* support calls nobody may need */

static void query_of(const pairs_pair *pair, double margin, pair_query *query)
{
    memset(query, 0, sizeof *query);
    query->a = &pair->shape[0];
    query->b = &pair->shape[1];
    memcpy(query->ra, pair->body[0].rotation, sizeof query->ra);
    memcpy(query->rb, pair->body[1].rotation, sizeof query->rb);
    memcpy(query->offset, pair->body[1].position, sizeof query->offset);
    query->margin = margin;
    query->max_points = 4;
}

/* ---- directions
 * --------------------------------------------------------------------------------- */

typedef struct tally {
    uint64_t pairs;
    uint64_t wrong;
    uint64_t missed;
    uint64_t endless;
} tally;

typedef struct class_tally {
    tally tribo;
    tally epa;
    tally mpr;
    uint64_t capped;
    uint64_t beaten;  /* the truth was not the least */
    uint64_t refuted; /* and should have been: it was exact */
    uint64_t loose;   /* longer than the least way by more than 1e-6 of the depth */
    uint64_t rough;   /* 1e-9 */
    double supports;
    double most_supports;
    double worst;       /* share of the depth */
    double worst_depth; /* reported against the width along the normal, of the smaller size */
    uint64_t worst_index;
    uint64_t by_kind[PAIRS_KINDS][PAIRS_KINDS];
} class_tally;

static int is_unit(const double *n)
{
    return fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0) < 1e-12;
}

/* A truth by golden sections may lie above the least: where the answer is lower it is the
 * truth, down to what golden sections find around it. An exact truth is never beaten. */
static void correct(pairs_pair *pair, double margin, const double answer[3], class_tally *sum)
{
    const int exact = pair->body[0].core != NULL && pair->body[1].core != NULL;
    double normal[3] = {answer[0], answer[1], answer[2]};
    const double width = truth_width(&pair->body[0], &pair->body[1], normal);
    const double over = pair->depth - width - 1e-12 * pair->large;
    sum->beaten += over > wrong * fabs(pair->depth);
    sum->refuted += exact && over > 1e-11 * pair->large;
    if (width < -margin) {
        pair->depth = fmin(pair->depth, width); /* apart: any direction that shows it will do */
    } else if (!exact) {
        const double least = truth_polish(&pair->body[0], &pair->body[1], 1e-3, normal);
        pair->depth = fmin(pair->depth, least);
    }
}

/* The pair as a user asks it. Returns the excess of the manifold's normal, infinite if there is
 * none and should be. */
static double ask_manifold(const pairs_pair *pair, double margin, tribo_collide_info *info)
{
    tribo_collide_options options = {0};
    tribo_manifold manifold;
    uint32_t count = 0;
    options.struct_size = sizeof options;
    options.method = TRIBO_METHOD_GENERAL;
    options.margin = margin;
    info->struct_size = sizeof *info;
    const tribo_status status =
        tribo_collide_shapes(&pair->shape[0], &pair->pose[0], &pair->shape[1], &pair->pose[1],
                             &options, 1, &manifold, &count, info);
    if (status == TRIBO_OK && count == 0 && pair->depth < -margin) {
        return 0.0;
    }
    if (status != TRIBO_OK || count != 1 || manifold.count == 0 || !is_unit(manifold.normal)) {
        return HUGE_VAL;
    }
    return pairs_excess(pair, manifold.normal);
}

static void judge(pairs_pair *pair, uint64_t index, class_tally *sum)
{
    pair_query query;
    pair_axis axis = {{0.0, 0.0, 0.0}, 0.0};
    tribo_collide_info info = {0};
    const double margin = 0.1 * pair->small;
    query_of(pair, margin, &query);
    const tribo_status status = convex_axis(&query, &axis, &info);
    const double width = truth_width(&pair->body[0], &pair->body[1], axis.normal);
    sum->worst_depth = fmax(sum->worst_depth, fabs(width + axis.distance) / pair->small);
    sum->capped += info.capped;
    sum->supports += (double)info.supports;
    sum->most_supports = fmax(sum->most_supports, (double)info.supports);
    correct(pair, margin, axis.normal, sum);
    const double excess = fmax(pairs_excess(pair, axis.normal), ask_manifold(pair, margin, &info));
    sum->tribo.pairs++;
    sum->tribo.missed += status != TRIBO_OK || !(excess < HUGE_VAL);
    sum->tribo.endless += (double)info.supports > 2.0 * far_calls;
    sum->loose += excess <= 1e-6 ? 0 : 1;
    sum->rough += excess <= 1e-9 ? 0 : 1;
    if (!(excess <= wrong)) {
        sum->tribo.wrong++;
        sum->by_kind[pair->kind[0]][pair->kind[1]]++;
    }
    if (!(excess <= sum->worst)) {
        sum->worst = excess;
        sum->worst_index = index;
    }
}

static void judge_raw(void (*ask)(const pairs_pair *, pairs_answer *), const pairs_pair *pair,
                      tally *sum)
{
    pairs_answer answer;
    ask(pair, &answer);
    sum->pairs++;
    sum->endless += answer.endless ? 1 : 0;
    if (!answer.found) {
        sum->missed++;
    } else {
        sum->wrong += !is_unit(answer.normal) || !(pairs_excess(pair, answer.normal) <= wrong);
    }
}

static void print_class(const pairs_class *class, const class_tally *sum)
{
    const double n = (double)sum->tribo.pairs;
    print_message(
        "# %-20s %7.0f %6.0f %6.0f %6.0f %6.0f %6.0f | %5.1f %4.0f | %8.1e %8.1e (%llu) | "
        "%6.2f %6.2f %6.2f | %6.2f %6.2f %6.2f\n",
        class->name, n, (double)sum->tribo.wrong, (double)sum->tribo.missed,
        (double)sum->tribo.endless, (double)sum->capped, (double)sum->beaten, sum->supports / n,
        sum->most_supports, sum->worst, sum->worst_depth, (unsigned long long)sum->worst_index,
        100.0 * (double)sum->epa.wrong / n, 100.0 * (double)sum->epa.missed / n,
        100.0 * (double)sum->epa.endless / n, 100.0 * (double)sum->mpr.wrong / n,
        100.0 * (double)sum->mpr.missed / n, 100.0 * (double)sum->mpr.endless / n);
    for (int i = 0; i < PAIRS_KINDS * PAIRS_KINDS; i++) {
        const uint64_t count = sum->by_kind[i / PAIRS_KINDS][i % PAIRS_KINDS];
        if (count > 0) {
            print_message("#   %s - %s: %llu wrong\n", pairs_kind_names[i / PAIRS_KINDS],
                          pairs_kind_names[i % PAIRS_KINDS], (unsigned long long)count);
        }
    }
}

static void do_class(const pairs_class *class, uint64_t seed, uint64_t count, class_tally *sum)
{
    static pairs_pair pair;
    memset(sum, 0, sizeof *sum);
    for (uint64_t i = 0; i < count; i++) {
        pairs_draw(class, seed, i, -1, -1, &pair);
        judge(&pair, i, sum);
        if (class->depth >= 0.0) {
            judge_raw(pairs_raw_epa, &pair, &sum->epa);
            judge_raw(pairs_raw_mpr, &pair, &sum->mpr);
        }
    }
    print_class(class, sum);
}

/* What the environment says; null if that is nothing. */
static const char *wish(const char *name)
{
    const char *text = getenv(name);
    return text != NULL && text[0] != '\0' ? text : NULL;
}

/* TRIBO_SLOW asks for many pairs, TRIBO_PAIRS for those classes alone whose names start so,
 * TRIBO_SEED for others than are drawn every day. */
static void finds_the_least_way_in_every_class(void **state)
{
    (void)state;
    const char *only = wish("TRIBO_PAIRS");
    const uint64_t seed = wish("TRIBO_SEED") ? strtoull(wish("TRIBO_SEED"), NULL, 10) : SEED;
    const uint64_t count = problem_count(wish("TRIBO_SLOW") ? 100000 : 2000);
    uint64_t bad = 0;
    print_message(
        "# class                  pairs  wrong missed  hangs capped beaten | supports   most |"
        " excess   depth error | EPA %% wrong missed hangs | MPR %%\n");
    for (int k = 0; k < pairs_class_count; k++) {
        class_tally sum;
        if (only != NULL && strncmp(pairs_classes[k].name, only, strlen(only)) != 0) {
            continue;
        }
        do_class(&pairs_classes[k], seed, count, &sum);
        bad += sum.tribo.wrong + sum.tribo.missed + sum.tribo.endless + sum.refuted;
        assert_true(sum.worst_depth <= 1e-9);
        if (pairs_classes[k].arrangement == PAIRS_CONCENTRIC) {
            print_message("#   longer than the least way by 1e-9 of it: %llu, by 1e-6: %llu\n",
                          (unsigned long long)sum.rough, (unsigned long long)sum.loose);
            assert_true(sum.rough <= 5 + count / 400 && sum.loose <= 3 + count / 2000);
            assert_true(sum.worst <= 5e-3);
        }
    }
    assert_int_equal(bad, 0);
}

/* ---- the same answer
 * ---------------------------------------------------------------------------- */

/* All lengths of a pair times 2^k. Hulls stay as they are: their blocks are given. */
static void scale_pair(pairs_pair *pair, double factor)
{
    for (int i = 0; i < 2; i++) {
        for (int c = 0; c < 3; c++) {
            pair->shape[i].size[c] *= factor;
            pair->body[i].size[c] *= factor;
            pair->body[i].position[c] *= factor;
        }
        pair->user[i].radius *= factor;
    }
    pair->small *= factor;
}

static int scalable(const pairs_pair *pair)
{
    return pair->kind[0] != PAIRS_HULL32 && pair->kind[0] != PAIRS_HULL256 &&
           pair->kind[1] != PAIRS_HULL32 && pair->kind[1] != PAIRS_HULL256;
}

static void ask(const pairs_pair *pair, pair_axis *axis, tribo_collide_info *info)
{
    pair_query query;
    query_of(pair, 0.1 * pair->small, &query);
    assert_int_equal(convex_axis(&query, axis, info), TRIBO_OK);
}

static void scales_by_powers_of_two_to_the_bit(void **state)
{
    static pairs_pair pair;
    static const double factors[4] = {0x1p-100, 0x1p-7, 0x1p+9, 0x1p+100};
    (void)state;
    for (uint64_t i = 0; i < problem_count(4000); i++) {
        pair_axis first;
        pair_axis second;
        tribo_collide_info info = {0};
        const double factor = factors[i % 4];
        pairs_draw(&pairs_classes[i % 5], SEED + 1, i, -1, -1, &pair);
        if (!scalable(&pair)) {
            continue;
        }
        ask(&pair, &first, &info);
        scale_pair(&pair, factor);
        ask(&pair, &second, &info);
        first.distance *= factor;
        assert_memory_equal(&first, &second, sizeof first);
    }
}

static void swapping_the_bodies_turns_the_axis_round(void **state)
{
    static pairs_pair pair;
    double worst = 0.0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(4000); i++) {
        pair_query query;
        pair_query turned;
        pair_axis first;
        pair_axis second;
        tribo_collide_info info = {0};
        pairs_draw(&pairs_classes[i % 14], SEED + 2, i, -1, -1, &pair);
        query_of(&pair, 0.1 * pair.small, &query);
        turned = query;
        turned.a = query.b;
        turned.b = query.a;
        memcpy(turned.ra, query.rb, sizeof turned.ra);
        memcpy(turned.rb, query.ra, sizeof turned.rb);
        for (int c = 0; c < 3; c++) {
            turned.offset[c] = -query.offset[c];
        }
        assert_int_equal(convex_axis(&query, &first, &info), TRIBO_OK);
        assert_int_equal(convex_axis(&turned, &second, &info), TRIBO_OK);
        if (first.distance <= query.margin || second.distance <= query.margin) {
            const double allowed = fmax(1e-9 * pair.small, 1e-10 * pair.large);
            worst = fmax(worst, fabs(first.distance - second.distance) / allowed);
        }
    }
    print_message("# greatest difference of distance %.2g of the tolerance\n", worst);
    assert_true(worst <= 1.0);
}

/* Where a face is what is nearest, the axis is its normal as the body has it, not one that an
 * iteration came to. */
static void takes_the_normals_of_faces_as_they_are(void **state)
{
    static pairs_pair pair;
    static const int others[4] = {PAIRS_BOX, PAIRS_SPHERE, PAIRS_CYLINDER, PAIRS_USER};
    uint64_t faces = 0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(2000); i++) {
        pair_axis axis;
        tribo_collide_info info = {0};
        pairs_draw(&pairs_classes[2 + i % 3], SEED + 6, i, PAIRS_BOX, others[i % 4], &pair);
        ask(&pair, &axis, &info);
        const double *r = pair.body[0].rotation;
        for (int k = 0; k < 3; k++) {
            const double along =
                r[k] * pair.normal[0] + r[3 + k] * pair.normal[1] + r[6 + k] * pair.normal[2];
            if (fabs(along) > 1.0 - 1e-14) {
                const double column[3] = {copysign(1.0, along) * r[k],
                                          copysign(1.0, along) * r[3 + k],
                                          copysign(1.0, along) * r[6 + k]};
                double off = 0.0;
                for (int c = 0; c < 3; c++) {
                    off = fmax(off, fabs(axis.normal[c] - column[c]));
                }
                assert_true(off <= 2.0 * DBL_EPSILON); /* made of unit length anew */
                faces++;
            }
        }
    }
    print_message("# %llu faces\n", (unsigned long long)faces);
    assert_true(faces > problem_count(2000) / 8);
}

/* What the shortcuts are for, by counts and not by the clock: support calls per pair on average,
 * which say something of so many pairs and not of a few. */
static void needs_few_support_calls(void **state)
{
    static pairs_pair pair;
    static const struct {
        int a, b;
        double most;
    } bounds[] = {{PAIRS_SPHERE, PAIRS_BOX, 25.0},          {PAIRS_BOX, PAIRS_BOX, 32.0},
                  {PAIRS_CAPSULE, PAIRS_HULL32, 28.0},      {PAIRS_HULL32, PAIRS_HULL32, 34.0},
                  {PAIRS_ELLIPSOID, PAIRS_ELLIPSOID, 75.0}, {PAIRS_CYLINDER, PAIRS_BOX, 72.0}};
    (void)state;
    for (size_t k = 0; k < sizeof bounds / sizeof bounds[0]; k++) {
        tribo_collide_info info = {0};
        const uint64_t count = 400;
        for (uint64_t i = 0; i < count; i++) {
            pair_axis axis;
            pairs_draw(&pairs_classes[1], SEED + 7, i, bounds[k].a, bounds[k].b, &pair);
            ask(&pair, &axis, &info);
        }
        const double mean = (double)info.supports / (double)count;
        print_message("# %s - %s: %.1f support calls\n", pairs_kind_names[bounds[k].a],
                      pairs_kind_names[bounds[k].b], mean);
        assert_true(mean <= bounds[k].most);
    }
}

/* ---- users' functions
 * --------------------------------------------------------------------------- */

enum {
    LIE_NAN,
    LIE_INFINITE,
    LIE_HUGE,
    LIE_RANDOM,
    LIE_CONSTANT,
    LIE_BACKWARDS,
    LIE_HOLLOW,
    LIE_SOMETIMES,
    LIE_LONG,
    LIE_GROWING,
    LIES
};

typedef struct liar {
    int lie;
    uint64_t calls;
    problem_random random;
} liar;

static void lying_support(const void *user, const double direction[3], double point[3])
{
    liar *self = (liar *)(uintptr_t)user;
    const double values[LIES] = {(double)NAN, HUGE_VAL, 1e300, 0.0, 0.7};
    const double size = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                             direction[2] * direction[2]);
    self->calls++;
    for (int c = 0; c < 3; c++) {
        point[c] = copysign(0.5, direction[c]);
        if (self->lie == LIE_RANDOM || (self->lie == LIE_SOMETIMES && self->calls % 7 == 0)) {
            point[c] = problem_random_uniform(&self->random, -0.5, 0.5);
        } else if (self->lie == LIE_BACKWARDS) {
            point[c] = -point[c];
        } else if (self->lie == LIE_HOLLOW) {
            point[c] = 0.5 * direction[c] / size * (fabs(direction[0]) > 0.5 * size ? 0.1 : 1.0);
        } else if (self->lie == LIE_LONG) {
            point[c] *= 3.0;
        } else if (self->lie == LIE_GROWING) {
            point[c] = direction[c] / size * (0.1 + 1e-4 * (double)self->calls);
        } else if (self->lie < LIE_RANDOM || self->lie == LIE_CONSTANT) {
            point[c] = values[self->lie];
        }
    }
}

static void survives_users_that_lie(void **state)
{
    static const double box[3] = {0.5, 0.6, 0.7};
    uint64_t errors[LIES] = {0};
    uint64_t most = 0;
    const uint64_t count = 1000; /* the hollow body shows in one of a hundred */
    (void)state;
    for (uint64_t i = 0; i < count * LIES; i++) {
        const int lie = (int)(i % LIES);
        liar self = {0};
        tribo_convex user = {0};
        tribo_shape shapes[2] = {{0}, {0}};
        tribo_pose poses[2] = {{{0}, {1.0, 0.0, 0.0, 0.0}}, {{0}, {1.0, 0.0, 0.0, 0.0}}};
        self.lie = lie;
        problem_random_start(&self.random, 5, SEED, i);
        user.struct_size = sizeof user;
        user.support = lying_support;
        user.user = &self;
        user.radius = 0.9;
        shapes[0].type = TRIBO_SHAPE_CONVEX;
        shapes[0].data = &user;
        shapes[1].type = TRIBO_SHAPE_BOX;
        memcpy(shapes[1].size, box, sizeof box);
        problem_random_direction(&self.random, 4, poses[1].orientation);
        problem_random_direction(&self.random, 3, poses[1].position);
        tribo_manifold manifold;
        uint32_t found = 0;
        const tribo_status status = tribo_collide_shapes(
            &shapes[0], &poses[0], &shapes[1], &poses[1], NULL, 1, &manifold, &found, NULL);
        most = self.calls > most ? self.calls : most;
        assert_true(status == TRIBO_OK || status == TRIBO_ERROR_SUPPORT);
        errors[lie] += status == TRIBO_ERROR_SUPPORT ? 1 : 0;
        if (status == TRIBO_OK && found == 1) {
            assert_true(is_unit(manifold.normal));
            assert_true(isfinite(manifold.points[0].distance));
        }
    }
    print_message("# most calls %llu; of %llu lies of each kind called out:",
                  (unsigned long long)most, (unsigned long long)count);
    for (int k = 0; k < LIES; k++) {
        print_message(" %llu", (unsigned long long)errors[k]);
    }
    print_message("\n");
    assert_true((double)most <= far_calls);
    for (int k = LIE_NAN; k <= LIE_HUGE; k++) {
        assert_true(errors[k] == count);
    }
    assert_true(errors[LIE_BACKWARDS] == count && errors[LIE_LONG] == count);
    assert_true(errors[LIE_HOLLOW] > 0 && errors[LIE_SOMETIMES] > 0);
}

/* A user's function that asks about another pair while the first is under way. */
typedef struct nest {
    const pairs_pair *inner;
    pair_axis expected;
    double half[3];
    int changed;
} nest;

static void nested_support(const void *user, const double direction[3], double point[3])
{
    nest *self = (nest *)(uintptr_t)user;
    pair_axis axis;
    tribo_collide_info info = {0};
    ask(self->inner, &axis, &info);
    self->changed |= memcmp(&axis, &self->expected, sizeof axis) != 0;
    for (int c = 0; c < 3; c++) {
        point[c] = copysign(self->half[c], direction[c]);
    }
}

static void is_reentrant(void **state)
{
    static pairs_pair outer;
    static pairs_pair inner;
    (void)state;
    for (uint64_t i = 0; i < 20; i++) {
        nest self = {0};
        pair_axis plain;
        pair_axis nested;
        tribo_collide_info info = {0};
        pairs_draw(&pairs_classes[i % 5], SEED + 3, i, PAIRS_USER, -1, &outer);
        pairs_draw(&pairs_classes[i % 5], SEED + 4, i, -1, -1, &inner);
        ask(&outer, &plain, &info);
        ask(&inner, &self.expected, &info);
        self.inner = &inner;
        memcpy(self.half, outer.body[0].size, sizeof self.half);
        outer.user[0].support = nested_support;
        outer.user[0].user = &self;
        ask(&outer, &nested, &info);
        assert_int_equal(self.changed, 0);
        assert_memory_equal(&plain, &nested, sizeof plain);
    }
}

static void adds_to_the_info_and_stops_early_where_bodies_are_apart(void **state)
{
    static pairs_pair pair;
    (void)state;
    pairs_draw(&pairs_classes[0], SEED, 3, PAIRS_BOX, PAIRS_CYLINDER, &pair);
    pair.body[1].position[0] += 5.0;
    pair_axis axis;
    tribo_collide_info info = {0};
    info.supports = 7;
    info.mallocs = 5;
    info.capped = 2;
    ask(&pair, &axis, &info);
    assert_true(axis.distance > 0.1 * pair.small);
    assert_int_equal(info.supports, 9);
    assert_int_equal(info.mallocs, 5);
    assert_int_equal(info.capped, 2);
}

/* The truth is judged too: no direction near its own may be shorter. */
static void the_truth_is_a_minimum(void **state)
{
    static pairs_pair pair;
    double worst = 0.0;
    (void)state;
    for (uint64_t i = 0; i < problem_count(1000); i++) {
        double normal[3];
        pairs_draw(&pairs_classes[i % 20], SEED + 5, i, -1, -1, &pair);
        memcpy(normal, pair.normal, sizeof normal);
        const double least = truth_polish(&pair.body[0], &pair.body[1], 0.1, normal);
        const int exact = pair.body[0].core != NULL && pair.body[1].core != NULL;
        worst = fmax(worst, exact ? (pair.depth - least) / pair.large : 0.0);
    }
    print_message("# exact truths undercut by %.2g of the size\n", worst);
    assert_true(worst <= 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_truth_is_a_minimum),
        cmocka_unit_test(finds_the_least_way_in_every_class),
        cmocka_unit_test(scales_by_powers_of_two_to_the_bit),
        cmocka_unit_test(swapping_the_bodies_turns_the_axis_round),
        cmocka_unit_test(takes_the_normals_of_faces_as_they_are),
        cmocka_unit_test(needs_few_support_calls),
        cmocka_unit_test(survives_users_that_lie),
        cmocka_unit_test(is_reentrant),
        cmocka_unit_test(adds_to_the_info_and_stops_early_where_bodies_are_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
