/* Finding the shared objects of the peers at run time: they lie in peers/ beside the program. */
#ifndef TRIBO_BENCH_LOAD_H
#define TRIBO_BENCH_LOAD_H

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

/* Why a shared object is not there, as the build wrote it down beside. */
static void print_skipped(const char *folder, const char *name)
{
    char path[4096];
    char reason[256] = "it was not built; see make bench";
    (void)snprintf(path, sizeof path, "%s/%s.skipped", folder, name);
    FILE *file = fopen(path, "r");
    if (file != NULL) {
        if (fgets(reason, sizeof reason, file) != NULL) {
            reason[strcspn(reason, "\n")] = '\0';
        }
        fclose(file);
    }
    printf("skipped: %s: %s\n", name, reason);
}

/* The address of a symbol of a peer, or null after the reason is printed. */
static void *load_peer(const char *program, const char *name, const char *symbol)
{
    char folder[2048];
    char path[4096];
    const char *slash = strrchr(program, '/');
    const int length = slash != NULL ? (int)(slash + 1 - program) : 0;
    (void)snprintf(folder, sizeof folder, "%.*speers", length, program);
    (void)snprintf(path, sizeof path, "%s/%s.so", folder, name);
    void *object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (object == NULL) {
        print_skipped(folder, name);
        return NULL;
    }
    return dlsym(object, symbol);
}

#endif
