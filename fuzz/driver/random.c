/* Random trials of every property of a room, with shrinking; TAP on standard output.
 *
 *   ROOM-random [trials [seed [index]]]
 *
 * `trials` is the number for a property of cost 1, `index` chooses one property. Fails if a
 * property fails, or if fewer than a tenth of its trials really exercise it. A failing input is
 * made smaller as long as it fails at the same place, and printed as bytes and as the values that
 * they stand for; the same bytes in a file are replayed by ROOM-replay and ROOM. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../support/property.h"

enum {
    LONGEST = 768,       /* bytes of an input */
    SHRINK_RUNS = 20000, /* runs spent on making a failing input smaller */
    SHRINK_SECONDS = 10, /* and processor time */
    WORST = 10           /* in percent, how many trials must exercise a property */
};

typedef struct input {
    uint8_t bytes[LONGEST];
    size_t size;
} input;

/* xorshift64*: Vigna, ACM Trans. Math. Softw. 42 (2016) 30. */
static uint64_t next_random(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 0x2545f4914f6cdd1du;
}

/* Mostly uniform bytes, in part of the inputs many zeros and ones, and some inputs that end
 * early. */
static void fill(input *in, uint8_t index, uint64_t *state)
{
    const uint64_t style = next_random(state) >> 32;
    in->size = style % 8 == 0 ? 1 + (style >> 8) % (LONGEST - 1) : LONGEST;
    for (size_t i = 1; i < in->size; i++) {
        const uint64_t bits = next_random(state) >> 32;
        in->bytes[i] = (uint8_t)bits;
        if ((style >> 3) % 4 == 0 && (bits >> 8) % 4 == 0) {
            in->bytes[i] = (bits >> 10) % 4 == 0 ? 0xff : 0;
        }
    }
    in->bytes[0] = index;
}

/* ---- shrinking ---------------------------------------------------------------------------- */

typedef struct failure {
    input least;
    const char *expression;
    int line;
    unsigned runs;
    clock_t start;
} failure;

static int exhausted(const failure *f)
{
    return f->runs >= SHRINK_RUNS || clock() - f->start > SHRINK_SECONDS * CLOCKS_PER_SEC;
}

/* Keep a candidate that fails at the same place. */
static int accept(failure *f, const input *candidate)
{
    property_trial t;
    if (exhausted(f)) {
        return 0;
    }
    f->runs++;
    property_run(&t, candidate->bytes, candidate->size, NULL);
    if (t.expression == NULL || t.line != f->line || strcmp(t.expression, f->expression) != 0) {
        return 0;
    }
    f->least = *candidate;
    return 1;
}

static int delete_spans(failure *f)
{
    int better = 0;
    for (size_t span = f->least.size / 2; span > 0; span /= 2) {
        for (size_t at = f->least.size; at > span; at--) {
            input candidate = f->least;
            const size_t from = at - span;
            if (from == 0 || at > candidate.size) {
                continue;
            }
            memmove(candidate.bytes + from, candidate.bytes + at, candidate.size - at);
            candidate.size -= span;
            if (accept(f, &candidate)) {
                better = 1;
            }
        }
    }
    return better;
}

static int zero_spans(failure *f)
{
    int better = 0;
    static const uint8_t zeros[LONGEST];
    for (size_t span = 16; span > 0; span /= 2) {
        for (size_t from = 1; from + span <= f->least.size; from++) {
            input candidate = f->least;
            if (memcmp(candidate.bytes + from, zeros, span) == 0) {
                continue;
            }
            memset(candidate.bytes + from, 0, span);
            if (accept(f, &candidate)) {
                better = 1;
            }
        }
    }
    return better;
}

static int lessen_bytes(failure *f)
{
    int better = 0;
    for (size_t at = 1; at < f->least.size; at++) {
        for (int step = 0; step < 2; step++) {
            input candidate = f->least;
            const uint8_t old = candidate.bytes[at];
            if (old == 0) {
                continue;
            }
            candidate.bytes[at] = (uint8_t)(step == 0 ? old / 2 : old - 1);
            if (accept(f, &candidate)) {
                better = 1;
            }
        }
    }
    return better;
}

static void shrink(failure *f)
{
    int better = 1;
    while (better && !exhausted(f)) {
        better = delete_spans(f);
        better = zero_spans(f) || better;
        better = lessen_bytes(f) || better;
    }
}

/* ---- report ------------------------------------------------------------------------------- */

static void report(const input *first, const property_trial *failed)
{
    failure f;
    property_trial t;
    f.least = *first;
    f.expression = failed->expression;
    f.line = failed->line;
    f.runs = 0;
    f.start = clock();
    shrink(&f);
    printf("# shrunk from %zu to %zu bytes in %u runs:\n# ", first->size, f.least.size, f.runs);
    for (size_t i = 0; i < f.least.size; i++) {
        printf("%02x", f.least.bytes[i]);
    }
    printf("\n");
    property_run(&t, f.least.bytes, f.least.size, stdout);
    printf("# %s:%d: %s%s\n", t.file, t.line, t.expression, t.detail);
}

static int try_property(size_t index, unsigned long trials, uint64_t seed)
{
    static input in;
    property_trial t;
    unsigned long exercised = 0;
    uint64_t state = seed ^ (0x9e3779b97f4a7c15u * (index + 1));
    for (unsigned long i = 0; i < trials; i++) {
        fill(&in, (uint8_t)index, &state);
        property_run(&t, in.bytes, in.size, NULL);
        if (t.expression != NULL) {
            printf("not ok %zu - %s (trial %lu of %lu)\n", index + 1, property_list[index].name,
                   i + 1, trials);
            report(&in, &t);
            return 0;
        }
        exercised += !t.skipped;
    }
    const int enough = 100 * exercised >= WORST * trials && trials > 0;
    printf("%sok %zu - %s (%lu trials, %lu exercised)\n", enough ? "" : "not ", index + 1,
           property_list[index].name, trials, exercised);
    return enough;
}

int main(int argc, char **argv)
{
    const unsigned long trials = argc > 1 ? strtoul(argv[1], NULL, 0) : property_trials;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 0) : 20;
    const size_t only = argc > 3 ? (size_t)strtoul(argv[3], NULL, 0) : property_count;
    int failed = 0;
    printf("1..%zu\n# %s: seed %llu\n", property_count, property_room, (unsigned long long)seed);
    for (size_t i = 0; i < property_count; i++) {
        const unsigned long share = trials / property_list[i].cost;
        if (only < property_count && i != only) {
            printf("ok %zu - %s # SKIP not asked for\n", i + 1, property_list[i].name);
        } else if (!try_property(i, share > 0 ? share : 1, seed)) {
            failed = 1;
        }
        fflush(stdout);
    }
    return failed;
}
