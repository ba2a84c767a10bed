/* The kernels compiled for each instruction set; the best is chosen at run time. Results differ between them
 * by round-off only (fused multiplications). */
#include "solid/body/kernel.h"

#include "base/processor.h"
#include "solid/body/kernel_cells.h"
#include "solid/body/kernel_sparse.h"

#define KERNEL_SET(set, dim, attribute)                                                                      \
    attribute static void apply_##set##_##dim(const struct sparse *matrix, int64_t begin, int64_t end,       \
                                              const double *x, double *y)                                    \
    {                                                                                                        \
        apply_rows_##dim(matrix, begin, end, x, y);                                                          \
    }                                                                                                        \
    attribute static void apply_transposed_##set##_##dim(const struct row_operator *rows, int64_t stripe,    \
                                                         const double *x, double *y)                         \
    {                                                                                                        \
        apply_transposed_##dim(rows, &rows->stripes[stripe], x, y);                                          \
    }                                                                                                        \
    attribute static void sum_corners_##set##_##dim(struct field_averages *averages, int64_t begin,          \
                                                    int64_t end)                                             \
    {                                                                                                        \
        sum_corners_##dim(averages, begin, end);                                                             \
    }                                                                                                        \
    attribute static void point_gradients_##set##_##dim(struct body *body, int64_t b)                        \
    {                                                                                                        \
        kernel_point_gradients(body, &body->blocks[b], dim);                                                 \
        kernel_determinants(body, &body->blocks[b], dim);                                                    \
    }                                                                                                        \
    attribute static void point_forces_##set##_##dim(struct body *body, int64_t b, const block_rows P)       \
    {                                                                                                        \
        kernel_point_forces(body, &body->blocks[b], dim, P);                                                 \
    }                                                                                                        \
    attribute static void cell_gradients_##set##_##dim(struct body *body, int64_t b)                         \
    {                                                                                                        \
        kernel_cell_gradients(body, &body->blocks[b], dim);                                                  \
    }                                                                                                        \
    attribute static void cell_neo_hookean_##set##_##dim(const struct body *body, int64_t b, block_rows P,   \
                                                         block_rows T)                                       \
    {                                                                                                        \
        kernel_cell_neo_hookean(body, &body->blocks[b], dim, P, T);                                          \
    }                                                                                                        \
    attribute static void cell_forces_##set##_##dim(struct body *body, int64_t b, const block_rows P,        \
                                                    const block_rows T)                                      \
    {                                                                                                        \
        kernel_cell_forces(body, &body->blocks[b], dim, P, T);                                               \
    }                                                                                                        \
    attribute static void neo_hookean_##set##_##dim(const struct body *body, int64_t b, block_rows P)        \
    {                                                                                                        \
        kernel_neo_hookean(body, &body->blocks[b], dim, P);                                                  \
    }                                                                                                        \
    attribute static void bounds_##set##_##dim(const double *g, int64_t count, const double A[9],            \
                                               double smoothing, double *sum)                                \
    {                                                                                                        \
        kernel_bounds(g, count, dim, A, smoothing, sum);                                                     \
    }                                                                                                        \
    static const struct force_kernels kernels_##set##_##dim = {                                              \
        .name = #set,                                                                                        \
        .apply = apply_##set##_##dim,                                                                        \
        .apply_transposed = apply_transposed_##set##_##dim,                                                  \
        .sum_corners = sum_corners_##set##_##dim,                                                            \
        .point_gradients = point_gradients_##set##_##dim,                                                    \
        .point_forces = point_forces_##set##_##dim,                                                          \
        .cell_gradients = cell_gradients_##set##_##dim,                                                      \
        .cell_neo_hookean = cell_neo_hookean_##set##_##dim,                                                  \
        .cell_forces = cell_forces_##set##_##dim,                                                            \
        .neo_hookean = neo_hookean_##set##_##dim,                                                            \
        .bounds = bounds_##set##_##dim};

KERNEL_SET(plain, 2, )
KERNEL_SET(plain, 3, )

#if defined(__x86_64__)
/* Unlike others, these may fuse multiplications. */
#define AVX2_FUSED __attribute__((target("avx2,fma")))
#define AVX512_FUSED __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma")))
KERNEL_SET(avx2, 2, AVX2_FUSED)
KERNEL_SET(avx2, 3, AVX2_FUSED)
KERNEL_SET(avx512, 2, AVX512_FUSED)
KERNEL_SET(avx512, 3, AVX512_FUSED)
#endif

const struct force_kernels *force_kernels_select(const char *name, int dim)
{
    const struct force_kernels *const sets[] = { /* the best first */
#if defined(__x86_64__)
                                                 dim == 2 ? &kernels_avx512_2 : &kernels_avx512_3,
                                                 dim == 2 ? &kernels_avx2_2 : &kernels_avx2_3,
#endif
                                                 dim == 2 ? &kernels_plain_2 : &kernels_plain_3
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        bool lacks_fma = strcmp(sets[i]->name, "avx2") == 0 && !processor_has("fma");
        if ((name == NULL || strcmp(sets[i]->name, name) == 0) && processor_has(sets[i]->name) &&
            !lacks_fma) {
            return sets[i];
        }
    }
    return NULL;
}
