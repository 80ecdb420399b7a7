/* Limits of what a bench runs: work in a process of its own, which may break, or be stopped after so
 * many seconds of the processor. It needs _DEFAULT_SOURCE, for MAP_ANONYMOUS. */
#ifndef TRIBO_BENCH_LIMIT_H
#define TRIBO_BENCH_LIMIT_H

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "threads.h"

/* Zeros that both processes see: what the work has found so far. */
static void *limit_share(size_t size)
{
    void *shared = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) {
        perror("mmap");
        exit(1);
    }
    return shared;
}

/* SIGPROF ends the process after so many seconds of the processor from now on. */
static void limit_set(double seconds)
{
    struct itimerval timer = {{0, 0}, {0, 0}};
    timer.it_value.tv_sec = (time_t)seconds;
    timer.it_value.tv_usec = (suseconds_t)(1e6 * (seconds - floor(seconds)));
    setitimer(ITIMER_PROF, &timer, NULL);
}

enum { LIMIT_DONE, LIMIT_STOPPED, LIMIT_BROKEN };

/* What is printed there is lost: other libraries tell of their troubles at length, and leave by
 * exit or abort. */
static int limit_run(void (*work)(void *user), void *user)
{
    int status = 0;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        if (freopen("/dev/null", "w", stdout) && freopen("/dev/null", "w", stderr)) {
            work(user);
            _exit(0);
        }
        _exit(1);
    }
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
        continue;
    }
    if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return LIMIT_DONE;
    }
    return child > 0 && WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? LIMIT_STOPPED
                                                                           : LIMIT_BROKEN;
}

#endif
