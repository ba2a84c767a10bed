/* The kernels compiled for each instruction set; the best is chosen at run time. */
#include "solid/kernel.h"

#define KERNEL_SET(set, dim, attribute)                                                                      \
    attribute static void gather_##set##_##dim(struct body *body, const struct block *block,                 \
                                               const double *u, double *local)                               \
    {                                                                                                        \
        kernel_gather(body, block, dim, u, local);                                                           \
    }                                                                                                        \
    attribute static void neo_hookean_##set##_##dim(const struct body *body, const struct block *block,      \
                                                    block_stress P)                                          \
    {                                                                                                        \
        kernel_neo_hookean(body, block, dim, P);                                                             \
    }                                                                                                        \
    attribute static void scatter_##set##_##dim(struct body *body, const struct block *block,                \
                                                const block_stress P, double *local)                         \
    {                                                                                                        \
        kernel_scatter(body, block, dim, P, local);                                                          \
    }                                                                                                        \
    static const struct force_kernels kernels_##set##_##dim = {                                              \
        #set, gather_##set##_##dim, neo_hookean_##set##_##dim, scatter_##set##_##dim};

#define NO_ATTRIBUTE
KERNEL_SET(plain, 2, NO_ATTRIBUTE)
KERNEL_SET(plain, 3, NO_ATTRIBUTE)

#if defined(__x86_64__)
#define AVX2 __attribute__((target("avx2,fma")))
#define AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma")))
KERNEL_SET(avx2, 2, AVX2)
KERNEL_SET(avx2, 3, AVX2)
KERNEL_SET(avx512, 2, AVX512)
KERNEL_SET(avx512, 3, AVX512)
#endif

const struct force_kernels *force_kernels_select(int dim)
{
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
        return dim == 2 ? &kernels_avx512_2 : &kernels_avx512_3;
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return dim == 2 ? &kernels_avx2_2 : &kernels_avx2_3;
    }
#endif
    return dim == 2 ? &kernels_plain_2 : &kernels_plain_3;
}
