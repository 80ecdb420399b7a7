/* Libraries in the caller's thread alone. */
#ifndef TRIBO_BENCH_THREADS_H
#define TRIBO_BENCH_THREADS_H

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* OpenMP and the BLAS read these when they are loaded: the program starts anew where it has to. */
static void limit_threads(char **argv)
{
    static const char *const names[] = {"OMP_THREAD_LIMIT", "OPENBLAS_NUM_THREADS"};
    int changed = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *value = getenv(names[i]);
        if (!value || strcmp(value, "1") != 0) {
            changed |= setenv(names[i], "1", 1) == 0;
        }
    }
    if (changed) {
        execv(argv[0], argv);
    }
}

#endif
