/* What libtribo and the libraries beneath it need in WebAssembly and wasi-libc does not have, so that
 * the module imports nothing but three functions of JavaScript; and what is of use to JavaScript
 * alone. */
#include "setjmp.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <tribo/contact.h>
#include <tribo/shape.h>
#include <tribo/system.h>

#include <libqhull_r/libqhull_r.h>

#define EXPORT(name) __attribute__((export_name(#name))) name
#define IMPORT(name, ...) \
    __attribute__((import_module("tribo"), import_name(#name))) call_##name(__VA_ARGS__)

/* ---- setjmp: the functions that clang 16 calls ------------------------------------------------ */

/* The calls of setjmp that one call of a function has made: where each goes on. Ends with id 0. */
typedef struct jump_entry {
    unsigned long id;
    uint32_t label;
} jump_entry;

/* What the handler of an exception is told. */
static struct {
    void *place;
    int value;
} jump;

static uint32_t second_result;

uint32_t getTempRet0(void);
jump_entry *saveSetjmp(unsigned long *place, uint32_t label, jump_entry *table, uint32_t size);
uint32_t testSetjmp(unsigned long id, const jump_entry *table, uint32_t size);
_Noreturn void __wasm_longjmp(void *place, int value);

uint32_t getTempRet0(void)
{
    return second_result;
}

/* The table that clang makes has room for 4. No function here has more than one setjmp. */
jump_entry *saveSetjmp(unsigned long *place, uint32_t label, jump_entry *table, uint32_t size)
{
    static unsigned long last;
    uint32_t i = 0;
    while (i + 1 < size && table[i].id != 0 && table[i].label != label) {
        i++;
    }
    table[i].id = *place = ++last;
    table[i].label = label;
    table[i + 1].id = 0;
    second_result = size;
    return table;
}

uint32_t testSetjmp(unsigned long id, const jump_entry *table, uint32_t size)
{
    for (uint32_t i = 0; i < size && table[i].id != 0; i++) {
        if (table[i].id == id) {
            return table[i].label;
        }
    }
    return 0;
}

_Noreturn void __wasm_longjmp(void *place, int value)
{
    jump.place = place;
    jump.value = value != 0 ? value : 1;
    __builtin_wasm_throw(1, &jump);
}

/* ---- libc: a sink for messages that nobody reads, and no time ---------------------------------- */

static char sink;

FILE *fopen(const char *restrict path, const char *restrict mode)
{
    (void)path;
    (void)mode;
    return (FILE *)(void *)&sink;
}

int fclose(FILE *file)
{
    (void)file;
    return 0;
}

int printf(const char *restrict format, ...)
{
    (void)format;
    return 0;
}

int fprintf(FILE *restrict file, const char *restrict format, ...)
{
    (void)file;
    (void)format;
    return 0;
}

/* Qhull tells how long it took, to the sink. */
clock_t clock(void)
{
    return 0;
}

/* ---- Qhull: the functions that it leaves to its users ------------------------------------------ */

void qh_fprintf(qhT *qh, FILE *file, int code, const char *format, ...)
{
    (void)qh;
    (void)file;
    (void)code;
    (void)format;
}

void qh_fprintf_stderr(int code, const char *format, ...)
{
    (void)code;
    (void)format;
}

/* Reached only from outside of qh_new_qhull without a place to jump to, which hull.c sets. */
void qh_exit(int code)
{
    (void)code;
    __builtin_trap();
}

void *qh_malloc(size_t size)
{
    return malloc(size);
}

void qh_free(void *memory)
{
    free(memory);
}

/* ---- functions of JavaScript ------------------------------------------------------------------ */

void IMPORT(support, const void *user, const double direction[3], double point[3]);
uint32_t IMPORT(progress, void *user, const tribo_system_info *info);
double IMPORT(clock, void *user);

/* Their places in the table of functions, as the structs of C hold them. */
tribo_support_function EXPORT(js_support)(void)
{
    return call_support;
}

tribo_progress_function EXPORT(js_progress)(void)
{
    return call_progress;
}

tribo_clock_function EXPORT(js_clock)(void)
{
    return call_clock;
}

/* ---- for JavaScript --------------------------------------------------------------------------- */

void *EXPORT(js_allocate)(size_t size)
{
    return malloc(size);
}

void EXPORT(js_release)(void *memory)
{
    free(memory);
}

/* One contact: w, b, mu_s, mu_d, p in one piece of memory. */
tribo_status EXPORT(js_contact_solve)(double problem[14])
{
    return tribo_contact_solve(problem, problem + 6, problem[9], problem[10], problem + 11, NULL);
}
