/* setjmp and longjmp, which wasi-libc has none of: clang makes them of WebAssembly's exceptions
 * (-mllvm -wasm-enable-sjlj) and runtime.c. Qhull leaves its errors by them. */
#ifndef TRIBO_JS_SETJMP_H
#define TRIBO_JS_SETJMP_H

typedef struct jump_place {
    unsigned long id; /* of the call of setjmp, among all of the process */
} jmp_buf[1];

int setjmp(jmp_buf place) __attribute__((returns_twice));
_Noreturn void longjmp(jmp_buf place, int value);

#endif
