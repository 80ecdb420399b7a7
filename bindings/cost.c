/* What a call costs in C, for the table beside the bindings: one line
 *
 *   NAME<TAB>ns of tribo_contact_solve, called alone<TAB>ns per contact of tribo_batch_solve
 *
 * Inputs are those of the set "batch_solve" in vectors.c with 10 000 contacts from seed 1. Each time
 * is the least of many rounds. Every binding has a program `bench` that prints such a line of the
 * same work, called as its users do. */
#define _POSIX_C_SOURCE 199309L
#include <stdint.h>
#include <stdio.h>
#include <time.h>
#include <tribo/tribo.h>

enum { COUNT = 10000, ROUNDS = 50 };

static uint64_t state = 1;

static double unit(void)
{
    state += 0x9e3779b97f4a7c15u;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

static double w[6 * COUNT], b[3 * COUNT], mu[2 * COUNT], p[3 * COUNT];
static uint32_t modes[COUNT];

static void draw(void)
{
    for (size_t k = 0; k < COUNT; k++) {
        for (size_t i = 0; i < 6; i++) {
            const double side = 2.0 * unit() - 1.0;
            w[6 * k + i] = i == 0 || i == 3 || i == 5 ? 2.0 + side : 0.5 * side;
        }
        for (size_t i = 0; i < 3; i++) {
            b[3 * k + i] = 2.0 * unit() - 1.0;
        }
        mu[2 * k] = 2.0 * unit();
        mu[2 * k + 1] = unit() * mu[2 * k];
        (void)unit();
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(void)
{
    double single = 1e300;
    double batch = 1e300;
    draw();
    for (int round = 0; round < ROUNDS; round++) {
        double start = now();
        for (size_t k = 0; k < COUNT; k++) {
            (void)tribo_contact_solve(w + 6 * k, b + 3 * k, mu[2 * k], mu[2 * k + 1], p + 3 * k,
                                      NULL);
        }
        const double alone = (now() - start) / COUNT;
        start = now();
        (void)tribo_batch_solve(TRIBO_ISA_BEST, COUNT, w, b, mu, p, modes, NULL);
        const double together = (now() - start) / COUNT;
        single = alone < single ? alone : single;
        batch = together < batch ? together : batch;
    }
    printf("C\t%.1f\t%.1f\n", single, batch);
    return 0;
}
