#include "solid/pairs_patches.h"

#include "base/chunks.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Least patches, where there are as many blocks, so that up to as many threads have work; most blocks of a
 * patch, whose forces stay in the second cache. */
enum { LEAST_PATCHES = 32, MOST_BLOCKS = 16 };

static int64_t count_patches(int64_t blocks)
{
    int64_t least = blocks < LEAST_PATCHES ? blocks : LEAST_PATCHES;
    int64_t count = (blocks + MOST_BLOCKS - 1) / MOST_BLOCKS;
    return count > least ? count : least;
}

static enum status cut_patches(struct pairs *pairs, struct error *error)
{
    enum status status;
    struct chunks even = {pairs->block_count, count_patches(pairs->block_count), 1};
    pairs->patch_count = even.count;
    TRY(NEW_ARRAY(&pairs->patches, pairs->patch_count, error));
    for (int64_t p = 0; p < pairs->patch_count; p++) {
        struct pair_patch *patch = &pairs->patches[p];
        patch->first_block = chunks_begin(&even, p);
        patch->block_count = chunks_begin(&even, p + 1) - patch->first_block;
    }
done:
    return status;
}

/* The forces of each patch: one for each of its nodes, as its blocks come to them. node_of_force[]:
 * block_node_count is enough. */
static void place_forces(struct pairs *pairs, int32_t *force_of_node, int32_t *node_of_force)
{
    memset(force_of_node, -1, (size_t)pairs->node_count * sizeof *force_of_node);
    for (int64_t p = 0; p < pairs->patch_count; p++) {
        struct pair_patch *patch = &pairs->patches[p];
        const struct pair_block *first = &pairs->blocks[patch->first_block];
        const struct pair_block *last = first + patch->block_count - 1;
        patch->first_force = pairs->force_count;
        for (int64_t i = first->first_node; i < last->first_node + last->node_count; i++) {
            int32_t *force = &force_of_node[pairs->block_node[i]];
            if (*force < patch->first_force) {
                *force = (int32_t)pairs->force_count;
                node_of_force[pairs->force_count++] = pairs->block_node[i];
            }
            pairs->block_place[i] = *force;
        }
        patch->force_count = pairs->force_count - patch->first_force;
    }
}

/* For each node the forces that are its own. */
static enum status number_sums(struct pairs *pairs, const int32_t *node_of_force, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&pairs->sum_ptr, pairs->node_count + 2, error));
    TRY(NEW_ARRAY(&pairs->sum, pairs->force_count, error));
    for (int64_t i = 0; i < pairs->force_count; i++) {
        pairs->sum_ptr[node_of_force[i] + 2]++;
    }
    for (int64_t n = 0; n < pairs->node_count; n++) {
        pairs->sum_ptr[n + 2] += pairs->sum_ptr[n + 1];
    }
    for (int64_t i = 0; i < pairs->force_count; i++) {
        pairs->sum[pairs->sum_ptr[node_of_force[i] + 1]++] = (int32_t)i;
    }
done:
    return status;
}

enum status patches_make(struct pairs *pairs, struct error *error)
{
    enum status status;
    int32_t *force_of_node = NULL, *node_of_force = NULL;
    TRY(cut_patches(pairs, error));
    TRY(NEW_ARRAY(&force_of_node, pairs->node_count, error));
    TRY(NEW_ARRAY(&node_of_force, pairs->block_node_count, error));
    TRY(NEW_ARRAY(&pairs->block_place, pairs->block_node_count, error));
    place_forces(pairs, force_of_node, node_of_force);
    TRY(number_sums(pairs, node_of_force, error));
    status = NEW_ARRAY(&pairs->patch_force, pairs->force_count * PAIRS_STRIDE(pairs->dim), error);
done:
    free(force_of_node);
    free(node_of_force);
    return status;
}
