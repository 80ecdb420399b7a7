/**
 * @file pool.h
 * Threads that wait for work, as a tribo_parallel_function: what an engine would hand to tribo.
 */
#ifndef TRIBO_TESTS_POOL_H
#define TRIBO_TESTS_POOL_H

#include <tribo/system.h>

typedef struct pool pool;

/** The caller's thread works too. Null if a thread can not be made. */
pool *pool_create(uint32_t threads);
void pool_destroy(pool *p);

/** user: a pool. */
void pool_run(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count);

/** Calls of pool_run so far. */
uint64_t pool_calls(const pool *p);

#endif
