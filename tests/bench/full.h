/* --full, the first argument of a bench: all of it, however long that takes. Without it there are
 * fewer sizes and repetitions, so that all benches together take minutes. */
#ifndef TRIBO_BENCH_FULL_H
#define TRIBO_BENCH_FULL_H

#include <string.h>

/* Whether it is there; takes it away. */
static int take_full(int *count, char **arguments)
{
    if (*count < 2 || strcmp(arguments[1], "--full") != 0) {
        return 0;
    }
    --*count;
    memmove(arguments + 1, arguments + 2, (size_t)*count * sizeof *arguments);
    return 1;
}

#endif
