#include "solid/coarse_kernel.h"

#include "base/processor.h"

#include <string.h>

typedef double four_centres __attribute__((vector_size(32)));
typedef double two_centres __attribute__((vector_size(16)));

/* The coarse fields of each centre at a node, but for the radius. The dimension is known when compiling, here
 * and below. */
KERNEL_INLINE void monomials(const struct coarse_space *coarse, int dim, int64_t node, of_centres value[4])
{
    value[0] = coarse->share[node];
    for (int a = 0; a < dim; a++) {
        value[a + 1] = value[0] * (coarse->X[node * dim + a] - coarse->centre[a]);
    }
}

KERNEL_INLINE void collect(const struct coarse_space *coarse, int dim, int64_t begin, int64_t end,
                           const double *weight, const double *v, coarse_amounts sum)
{
    of_centres all[4][3] = {{{0.0}}}, value[4];
    for (int64_t n = begin; n < end; n++) {
        double scale = weight != NULL ? weight[n] : 1.0;
        monomials(coarse, dim, n, value);
        for (int a = 0; a < dim; a++) {
            double scaled = scale * v[n * dim + a];
            for (int m = 0; m <= dim; m++) {
                all[m][a] += value[m] * scaled;
            }
        }
    }
    memcpy(sum, all, sizeof all);
}

/* By halves: in a fixed order, which costs few instructions. */
KERNEL_INLINE double total(const of_centres *value)
{
    four_centres half = __builtin_shufflevector(*value, *value, 0, 1, 2, 3) +
                        __builtin_shufflevector(*value, *value, 4, 5, 6, 7);
    two_centres quarter =
        __builtin_shufflevector(half, half, 0, 1) + __builtin_shufflevector(half, half, 2, 3);
    return quarter[0] + quarter[1];
}

KERNEL_INLINE void add(const struct coarse_space *coarse, int dim, int64_t begin, int64_t end,
                       const coarse_amounts amount, double *u)
{
    of_centres kept[4][3], value[4];
    memcpy(kept, amount, sizeof kept);
    for (int64_t n = begin; n < end; n++) {
        monomials(coarse, dim, n, value);
        for (int a = 0; a < dim; a++) {
            of_centres sum = value[0] * kept[0][a];
            for (int m = 1; m <= dim; m++) {
                sum += value[m] * kept[m][a];
            }
            u[n * dim + a] += total(&sum);
        }
    }
}

#define KERNEL_SET(set, attribute)                                                                           \
    attribute static void collect_##set(const struct coarse_space *coarse, int64_t begin, int64_t end,       \
                                        const double *weight, const double *v, coarse_amounts sum)           \
    {                                                                                                        \
        if (coarse->dim == 2) {                                                                              \
            collect(coarse, 2, begin, end, weight, v, sum);                                                  \
        } else {                                                                                             \
            collect(coarse, 3, begin, end, weight, v, sum);                                                  \
        }                                                                                                    \
    }                                                                                                        \
    attribute static void add_##set(const struct coarse_space *coarse, int64_t begin, int64_t end,           \
                                    const coarse_amounts amount, double *u)                                  \
    {                                                                                                        \
        if (coarse->dim == 2) {                                                                              \
            add(coarse, 2, begin, end, amount, u);                                                           \
        } else {                                                                                             \
            add(coarse, 3, begin, end, amount, u);                                                           \
        }                                                                                                    \
    }                                                                                                        \
    static const struct coarse_kernels kernels_##set = {collect_##set, add_##set};

KERNEL_SET(plain, PLAIN_SET)

#if defined(__x86_64__)
KERNEL_SET(avx2, AVX2_SET)
KERNEL_SET(avx512, AVX512_SET)
#endif

const struct coarse_kernels *coarse_kernels_of(const char *set)
{
#if defined(__x86_64__)
    if (processor_has(set) && strcmp(set, "avx512") == 0) {
        return &kernels_avx512;
    }
    if (processor_has(set) && strcmp(set, "avx2") == 0) {
        return &kernels_avx2;
    }
#endif
    return strcmp(set, "plain") == 0 ? &kernels_plain : NULL;
}
