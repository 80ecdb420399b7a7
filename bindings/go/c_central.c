/* Written by generate.py: compiled by cgo. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("O3", "no-math-errno", "no-trapping-math", "no-tree-slp-vectorize")
#if defined(__x86_64__)
#pragma GCC target("no-fma")
#endif
#endif
#if defined(__GNUC__)
/* The pragma leaves errno to sqrt, which then is no instruction in loops. */
#include <math.h>
extern double sqrt(double) __attribute__((const));
#endif
#include "csrc/src/central.inc"
