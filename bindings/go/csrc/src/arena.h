/* Places in a caller's buffer, one after the other. With a null base it only counts: the same code
 * tells the size and hands out the places. */
#ifndef TRIBO_ARENA_H
#define TRIBO_ARENA_H

#include <stddef.h>
#include <stdint.h>

typedef struct arena {
    unsigned char *base;
    size_t used;    /* bytes */
    uint32_t burst; /* 1: used does not fit size_t */
} arena;

/* `count` objects of `size` bytes, aligned for double; null while counting. */
static inline void *arena_take(arena *a, size_t count, size_t size)
{
    const size_t at = a->used;
    const size_t room = SIZE_MAX - 64 - at;

    if (a->burst != 0 || (size != 0 && count > room / size)) {
        a->burst = 1;
        return NULL;
    }
    a->used = at + (count * size + 7) / 8 * 8;
    return a->base != NULL ? a->base + at : NULL;
}

#endif
