/* Kernels over means of the field (field_averages.h); private to lib/solid. */
#ifndef SOLID_KERNEL_AVERAGES_H
#define SOLID_KERNEL_AVERAGES_H

#include "solid/kernel_operator.h"

/* Averages of a block. */
KERNEL_INLINE void apply_averages(struct field_averages *averages, int64_t b, struct reading how,
                                  const double *restrict local)
{
    const struct operator_block *block = &averages->op.blocks[b];
    struct cursor cursor = start_block(&averages->op, b, how, false);
    for (int64_t g = block->first_slice; g < block->first_slice + block->slice_count; g++) {
        quad4 mean[9] = {{0.0}};
        apply_slice(&averages->op.slices[g], how, local, &cursor, mean);
        store_components(mean, how.dim, averages->value + g * OPERATOR_SLICE * OPERATOR_STRIDE(how.dim));
    }
}

/* What the corners put on the averages of a slice, each component a vector along the averages. */
#define SUM_CORNERS(dim, vector)                                                                             \
    KERNEL_INLINE void sum_corners_##dim(const struct field_averages *averages, int64_t slice,               \
                                         quad4 total[4])                                                     \
    {                                                                                                        \
        vector sum[OPERATOR_SLICE] = {{0.0}}, force;                                                         \
        double sums[OPERATOR_SLICE][sizeof(vector) / sizeof(double)];                                        \
        const double *const from[OPERATOR_SLICE] = {sums[0], sums[1], sums[2], sums[3]};                     \
        for (int64_t i = averages->corner_ptr[slice]; i < averages->corner_ptr[slice + 1]; i++) {            \
            for (int r = 0; r < OPERATOR_SLICE; r++) {                                                       \
                int64_t corner = averages->corner[i * OPERATOR_SLICE + r];                                   \
                LOAD(force, averages->corner_force + corner * OPERATOR_STRIDE(dim));                         \
                sum[r] += force;                                                                             \
            }                                                                                                \
        }                                                                                                    \
        for (int r = 0; r < OPERATOR_SLICE; r++) {                                                           \
            STORE(sums[r], sum[r]);                                                                          \
        }                                                                                                    \
        load_components(from, dim, total);                                                                   \
    }
SUM_CORNERS(2, pair2)
SUM_CORNERS(3, quad4)

/* The transpose, of what the corners put on the averages. */
KERNEL_INLINE void apply_averages_transposed(struct field_averages *averages, int64_t b, struct reading how,
                                             double *restrict lane_forces)
{
    const struct operator_block *block = &averages->op.blocks[b];
    struct cursor cursor = start_block(&averages->op, b, how, true);
    clear_lanes(block, how.dim, lane_forces);
    for (int64_t g = block->first_slice; g < block->first_slice + block->slice_count; g++) {
        quad4 total[9];
        if (how.dim == 2) {
            sum_corners_2(averages, g, total);
        } else {
            sum_corners_3(averages, g, total);
        }
        apply_slice_transposed(&averages->op.slices[g], how, total, lane_forces, &cursor);
    }
    sum_lanes(&averages->op, b, how.dim, lane_forces);
}

KERNEL_INLINE void kernel_apply_averages(struct field_averages *averages, int64_t b, int dim, const double *u,
                                         double *scratch)
{
    localise(&averages->op, b, dim, u, scratch);
    apply_averages(averages, b, (struct reading){dim, 1}, scratch);
}

KERNEL_INLINE void kernel_apply_averages_transposed(struct field_averages *averages, int64_t b, int dim,
                                                    double *scratch)
{
    apply_averages_transposed(averages, b, (struct reading){dim, 1}, scratch);
}

#endif
