#define _POSIX_C_SOURCE 200809L

#include "pool.h"

#include <pthread.h>
#include <stdlib.h>

enum { MOST = 16 };

struct pool {
    pthread_mutex_t lock;
    pthread_cond_t work, done;
    pthread_t threads[MOST];
    uint32_t thread_count;
    uint32_t stops;
    uint64_t calls;
    void (*task)(void *data, uint32_t i);
    void *data;
    uint32_t next, count, running; /* tasks of the call */
};

/* The lock is held on entry and on return. */
static void work_off(pool *p)
{
    while (p->next < p->count) {
        const uint32_t i = p->next++;
        p->running++;
        pthread_mutex_unlock(&p->lock);
        p->task(p->data, i);
        pthread_mutex_lock(&p->lock);
        p->running--;
    }
    if (p->running == 0) {
        pthread_cond_broadcast(&p->done);
    }
}

static void *serve(void *context)
{
    pool *p = context;
    pthread_mutex_lock(&p->lock);
    while (p->stops == 0) {
        work_off(p);
        if (p->stops == 0) {
            pthread_cond_wait(&p->work, &p->lock);
        }
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

pool *pool_create(uint32_t threads)
{
    pool *p = calloc(1, sizeof *p);
    if (p == NULL) {
        return NULL;
    }
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->work, NULL);
    pthread_cond_init(&p->done, NULL);
    while (p->thread_count < threads && p->thread_count < MOST) {
        if (pthread_create(&p->threads[p->thread_count], NULL, serve, p) != 0) {
            pool_destroy(p);
            return NULL;
        }
        p->thread_count++;
    }
    return p;
}

void pool_destroy(pool *p)
{
    if (p == NULL) {
        return;
    }
    pthread_mutex_lock(&p->lock);
    p->stops = 1;
    pthread_cond_broadcast(&p->work);
    pthread_mutex_unlock(&p->lock);
    for (uint32_t i = 0; i < p->thread_count; i++) {
        pthread_join(p->threads[i], NULL);
    }
    pthread_cond_destroy(&p->done);
    pthread_cond_destroy(&p->work);
    pthread_mutex_destroy(&p->lock);
    free(p);
}

void pool_run(void *user, void (*task)(void *data, uint32_t i), void *data, uint32_t count)
{
    pool *p = user;
    pthread_mutex_lock(&p->lock);
    p->calls++;
    p->task = task;
    p->data = data;
    p->next = 0;
    p->count = count;
    pthread_cond_broadcast(&p->work);
    work_off(p);
    while (p->running > 0) {
        pthread_cond_wait(&p->done, &p->lock);
    }
    pthread_mutex_unlock(&p->lock);
}

uint64_t pool_calls(const pool *p)
{
    return p->calls;
}
