#include "dense.h"

const dense_table *dense_table_of(uint32_t isa)
{
#if defined(TRIBO_HAVE_X86_64_LEVELS)
    const int best = isa == TRIBO_ISA_BEST;
    if (isa == TRIBO_ISA_X86_64_V4 || (best && tribo_isa_available(TRIBO_ISA_X86_64_V4))) {
        return &dense_x86_64_v4;
    }
    if (isa == TRIBO_ISA_X86_64_V3 || (best && tribo_isa_available(TRIBO_ISA_X86_64_V3))) {
        return &dense_x86_64_v3;
    }
#endif
    (void)isa;
    return &dense_baseline;
}

int dense_cholesky(uint32_t isa, const dense_shape *shape, double *a)
{
    return dense_table_of(isa)->cholesky(shape, a);
}

void dense_cholesky_solve(uint32_t isa, const dense_shape *shape, const double *a, double *x)
{
    dense_table_of(isa)->cholesky_solve(shape, a, x);
}

int dense_lu(uint32_t isa, const dense_shape *shape, double *a, uint32_t *pivots)
{
    return dense_table_of(isa)->lu(shape, a, pivots);
}

void dense_lu_solve(uint32_t isa, const dense_shape *shape, const double *a, const uint32_t *pivots,
                    double *x)
{
    dense_table_of(isa)->lu_solve(shape, a, pivots, x);
}
