/* Kernels over means of the field (means.h); private to lib/solid. */
#ifndef SOLID_KERNEL_MEANS_H
#define SOLID_KERNEL_MEANS_H

#include "solid/kernel_pairs.h"

/* Means of a block. */
KERNEL_INLINE void gather_means(struct means *means, int64_t b, struct reading how,
                                const double *restrict local)
{
    const struct pair_block *block = &means->pairs.blocks[b];
    struct cursor cursor = start_block(&means->pairs, b, how, false);
    for (int64_t g = block->first_group; g < block->first_group + block->group_count; g++) {
        quad4 mean[9] = {{0.0}};
        gather_group(&means->pairs.groups[g], how, local, &cursor, mean);
        store_components(mean, how.dim, means->value + g * PAIRS_GROUP * PAIRS_STRIDE(how.dim));
    }
}

/* What the corners put on the means of a group, each component a vector along the means. */
#define SUM_CORNERS(dim, vector)                                                                             \
    KERNEL_INLINE void sum_corners_##dim(const struct means *means, int64_t group, quad4 total[4])           \
    {                                                                                                        \
        vector sum[PAIRS_GROUP] = {{0.0}}, force;                                                            \
        double sums[PAIRS_GROUP][sizeof(vector) / sizeof(double)];                                           \
        const double *const from[PAIRS_GROUP] = {sums[0], sums[1], sums[2], sums[3]};                        \
        for (int64_t i = means->corner_ptr[group]; i < means->corner_ptr[group + 1]; i++) {                  \
            for (int r = 0; r < PAIRS_GROUP; r++) {                                                          \
                int64_t corner = means->corner[i * PAIRS_GROUP + r];                                         \
                LOAD(force, means->corner_force + corner * PAIRS_STRIDE(dim));                               \
                sum[r] += force;                                                                             \
            }                                                                                                \
        }                                                                                                    \
        for (int r = 0; r < PAIRS_GROUP; r++) {                                                              \
            STORE(sums[r], sum[r]);                                                                          \
        }                                                                                                    \
        load_components(from, dim, total);                                                                   \
    }
SUM_CORNERS(2, pair2)
SUM_CORNERS(3, quad4)

/* The transpose, of what the corners put on the means. */
KERNEL_INLINE void scatter_means(struct means *means, int64_t b, struct reading how,
                                 double *restrict lane_forces)
{
    const struct pair_block *block = &means->pairs.blocks[b];
    struct cursor cursor = start_block(&means->pairs, b, how, true);
    clear_lanes(block, how.dim, lane_forces);
    for (int64_t g = block->first_group; g < block->first_group + block->group_count; g++) {
        quad4 total[9];
        if (how.dim == 2) {
            sum_corners_2(means, g, total);
        } else {
            sum_corners_3(means, g, total);
        }
        scatter_group(&means->pairs.groups[g], how, total, lane_forces, &cursor);
    }
    sum_lanes(&means->pairs, b, how.dim, lane_forces);
}

KERNEL_INLINE void kernel_gather_means(struct means *means, int64_t b, int dim, const double *u,
                                       double *scratch)
{
    localise(&means->pairs, b, dim, u, scratch);
    gather_means(means, b, (struct reading){dim, 1}, scratch);
}

KERNEL_INLINE void kernel_scatter_means(struct means *means, int64_t b, int dim, double *scratch)
{
    scatter_means(means, b, (struct reading){dim, 1}, scratch);
}

#endif
