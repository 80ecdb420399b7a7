/* What the flat blocks of hulls and meshes have in common: how their parts are placed, and the sum
 * over their bytes by which damage shows. */
#ifndef TRIBO_BLOCK_H
#define TRIBO_BLOCK_H

#include <stddef.h>

#include "bits.h"

/* Takes room at `end`, which stays a multiple of 8; returns where it starts. */
static inline uint64_t block_place(uint64_t *end, uint64_t size)
{
    const uint64_t start = *end;
    *end = start + ((size + 7u) & ~(uint64_t)7u);
    return start;
}

/* Sum over all words of 8 bytes but the one at `hole`, where the sum itself is kept. Each step can
 * be undone, so that no change of one word is lost; the shift lets sign bits, which a product keeps
 * at the top, reach all others. */
static inline uint64_t block_sum(const void *block, uint64_t bytes, uint64_t hole)
{
    const unsigned char *b = block;
    uint64_t sum = 0xcbf29ce484222325u;
    for (uint64_t at = 0; at < bytes; at += 8u) {
        uint64_t word = 0;
        memcpy(&word, b + at, sizeof word);
        sum = (sum ^ (at == hole ? 0u : word)) * 0x9e3779b97f4a7c15u;
        sum ^= sum >> 32;
    }
    return sum;
}

/* Whether blocks may be read at this address. */
static inline int block_is_aligned(const void *block)
{
    return (uintptr_t)block % 8u == 0;
}

#endif
