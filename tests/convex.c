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
    uint64_t beaten; /* the truth was not the least: golden sections in a local minimum */
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

static void judge(const pairs_pair *pair, uint64_t index, class_tally *sum)
{
    pair_query query;
    pair_axis axis = {{0.0, 0.0, 0.0}, 0.0};
    tribo_collide_info info = {0};
    query_of(pair, 0.1 * pair->small, &query);
    const tribo_status status = convex_axis(&query, &axis, &info);
    const double excess = pairs_excess(pair, axis.normal);
    const double width = truth_width(&pair->body[0], &pair->body[1], axis.normal);
    sum->tribo.pairs++;
    sum->tribo.missed += status != TRIBO_OK || !is_unit(axis.normal);
    sum->tribo.endless += (double)info.supports > far_calls;
    sum->capped += info.capped;
    sum->supports += (double)info.supports;
    sum->most_supports = fmax(sum->most_supports, (double)info.supports);
    sum->worst_depth = fmax(sum->worst_depth, fabs(width + axis.distance) / pair->small);
    sum->beaten += width < pair->depth - wrong * fabs(pair->depth) - 1e-12 * pair->large;
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

static void do_class(const pairs_class *class, uint64_t count, class_tally *sum)
{
    static pairs_pair pair;
    memset(sum, 0, sizeof *sum);
    for (uint64_t i = 0; i < count; i++) {
        pairs_draw(class, SEED, i, -1, -1, &pair);
        judge(&pair, i, sum);
        if (class->depth >= 0.0) {
            judge_raw(pairs_raw_epa, &pair, &sum->epa);
            judge_raw(pairs_raw_mpr, &pair, &sum->mpr);
        }
    }
    print_class(class, sum);
}

static void finds_the_least_way_in_every_class(void **state)
{
    (void)state;
    const int slow = getenv("TRIBO_SLOW") != NULL;
    const uint64_t count = problem_count(slow ? 100000 : 2000);
    uint64_t bad = 0;
    print_message(
        "# class                  pairs  wrong missed  hangs capped beaten | supports   most |"
        " excess   depth error | EPA %% wrong missed hangs | MPR %%\n");
    for (int k = 0; k < pairs_class_count; k++) {
        class_tally sum;
        do_class(&pairs_classes[k], count, &sum);
        bad += sum.tribo.wrong + sum.tribo.missed + sum.tribo.endless;
        assert_true(sum.worst_depth <= 1e-9);
    }
    assert_int_equal(bad, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_least_way_in_every_class),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
