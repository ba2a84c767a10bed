#include "solid/operator_accumulation.h"

#include "base/chunks.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Least accumulation blocks, where there are as many blocks, so that up to as many threads have work; most
 * blocks of an accumulation block, whose forces stay in the second cache. */
enum { LEAST_ACCUMULATIONS = 32, MOST_BLOCKS = 16 };

static int64_t count_accumulation_blocks(int64_t blocks)
{
    int64_t least = blocks < LEAST_ACCUMULATIONS ? blocks : LEAST_ACCUMULATIONS;
    int64_t count = (blocks + MOST_BLOCKS - 1) / MOST_BLOCKS;
    return count > least ? count : least;
}

static enum status cut_accumulation_blocks(struct sparse_operator *op, struct error *error)
{
    enum status status;
    struct chunks even = {op->block_count, count_accumulation_blocks(op->block_count), 1};
    op->accumulation_count = even.count;
    TRY(NEW_ARRAY(&op->accumulation, op->accumulation_count, error));
    for (int64_t p = 0; p < op->accumulation_count; p++) {
        struct accumulation_block *accumulation = &op->accumulation[p];
        accumulation->first_block = chunks_begin(&even, p);
        accumulation->block_count = chunks_begin(&even, p + 1) - accumulation->first_block;
    }
done:
    return status;
}

/* The forces of each accumulation block: one for each of its nodes, as its blocks come to them.
 * node_of_force[]: block_node_count is enough. */
static void place_forces(struct sparse_operator *op, int32_t *force_of_node, int32_t *node_of_force)
{
    memset(force_of_node, -1, (size_t)op->node_count * sizeof *force_of_node);
    for (int64_t p = 0; p < op->accumulation_count; p++) {
        struct accumulation_block *accumulation = &op->accumulation[p];
        const struct operator_block *first = &op->blocks[accumulation->first_block];
        const struct operator_block *last = first + accumulation->block_count - 1;
        accumulation->first_force = op->force_count;
        for (int64_t i = first->first_node; i < last->first_node + last->node_count; i++) {
            int32_t *force = &force_of_node[op->block_node[i]];
            if (*force < accumulation->first_force) {
                *force = (int32_t)op->force_count;
                node_of_force[op->force_count++] = op->block_node[i];
            }
            op->block_place[i] = *force;
        }
        accumulation->force_count = op->force_count - accumulation->first_force;
    }
}

/* For each node the forces that are its own. */
static enum status number_sums(struct sparse_operator *op, const int32_t *node_of_force, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&op->sum_ptr, op->node_count + 2, error));
    TRY(NEW_ARRAY(&op->sum, op->force_count, error));
    for (int64_t i = 0; i < op->force_count; i++) {
        op->sum_ptr[node_of_force[i] + 2]++;
    }
    for (int64_t n = 0; n < op->node_count; n++) {
        op->sum_ptr[n + 2] += op->sum_ptr[n + 1];
    }
    for (int64_t i = 0; i < op->force_count; i++) {
        op->sum[op->sum_ptr[node_of_force[i] + 1]++] = (int32_t)i;
    }
done:
    return status;
}

enum status accumulation_make(struct sparse_operator *op, struct error *error)
{
    enum status status;
    int32_t *force_of_node = NULL, *node_of_force = NULL;
    TRY(cut_accumulation_blocks(op, error));
    TRY(NEW_ARRAY(&force_of_node, op->node_count, error));
    TRY(NEW_ARRAY(&node_of_force, op->block_node_count, error));
    TRY(NEW_ARRAY(&op->block_place, op->block_node_count, error));
    place_forces(op, force_of_node, node_of_force);
    TRY(number_sums(op, node_of_force, error));
    status = NEW_ARRAY(&op->accumulated_force, op->force_count * OPERATOR_STRIDE(op->dim), error);
done:
    free(force_of_node);
    free(node_of_force);
    return status;
}
