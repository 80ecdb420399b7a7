/* Written by generate.py: a kernel for one instruction set. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("O3", "no-math-errno", "no-trapping-math", "no-tree-slp-vectorize")
#if defined(__x86_64__)
#pragma GCC target("arch=x86-64-v3,no-fma")
#endif
#endif
#if defined(__GNUC__)
/* The pragma leaves errno to sqrt, which then is no instruction in loops. */
#include <math.h>
extern double sqrt(double) __attribute__((const));
#endif
#if defined(__x86_64__)
#define TRIBO_LANES x86_64_v3
#include "csrc/src/sweep_lanes.inc"
#endif
