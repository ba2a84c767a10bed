#include "solid/pairs.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of a table that stays in a core's second cache. */
static const int64_t second_cache = 1 << 20;

void pairs_sort_rows(int64_t count, int64_t *row, const int64_t *ptr, const int32_t *corners)
{
    int64_t key[PAIRS_MAX_ROWS];
    for (int64_t i = 0; i < count; i++) {
        int64_t new_row = row[i], at = i;
        int64_t new_key =
            ptr[new_row + 1] - ptr[new_row] + (corners != NULL ? (int64_t)corners[new_row] << 32 : 0);
        for (; at > 0 && key[at - 1] > new_key; at--) {
            key[at] = key[at - 1];
            row[at] = row[at - 1];
        }
        key[at] = new_key;
        row[at] = new_row;
    }
}

static enum status copy_values(const struct pairs_input *input, struct pairs *pairs, struct error *error)
{
    enum status status;
    int width = input->width;
    TRY(NEW_ARRAY(&pairs->ptr, input->row_count + 1, error));
    for (int64_t r = 0; r < input->row_count; r++) {
        int64_t from = input->row[r];
        pairs->ptr[r + 1] = pairs->ptr[r] + input->ptr[from + 1] - input->ptr[from];
    }
    pairs->pair_count = pairs->ptr[input->row_count];
    if (input->single) {
        TRY(NEW_ARRAY(&pairs->single_value, pairs->pair_count * width + 1, error));
    } else {
        TRY(NEW_ARRAY(&pairs->value, pairs->pair_count * width + 1, error));
    }
    for (int64_t r = 0; r < input->row_count; r++) {
        const double *from = input->value + input->ptr[input->row[r]] * width;
        int64_t at = pairs->ptr[r] * width, count = pairs->ptr[r + 1] * width - at;
        if (!input->single) {
            memcpy(pairs->value + at, from, (size_t)count * sizeof *from);
            continue;
        }
        for (int64_t i = 0; i < count; i++) {
            pairs->single_value[at + i] = (float)from[i];
        }
    }
done:
    return status;
}

/* A node new to a block. */
static enum status add_block_node(struct pairs *pairs, int32_t node, int64_t *capacity, struct error *error)
{
    if (pairs->block_node_count == *capacity) {
        *capacity = *capacity * 2 + 4096;
        int32_t *grown = array_grow(pairs->block_node, *capacity, sizeof *grown);
        if (grown == NULL) {
            return fail_memory(error, "nodes of blocks");
        }
        pairs->block_node = grown;
    }
    pairs->block_node[pairs->block_node_count++] = node;
    return STATUS_OK;
}

/* The nodes of each block and where each pair finds its own. */
static enum status number_nodes(const struct pairs_input *input, struct pairs *pairs, struct error *error)
{
    enum status status;
    int32_t *local_of = NULL;
    int64_t capacity = 0;
    int stride = PAIRS_STRIDE(input->dim);
    TRY(NEW_ARRAY(&pairs->offset, pairs->pair_count, error));
    TRY(NEW_ARRAY(&pairs->blocks, input->block_count, error));
    TRY(NEW_ARRAY(&local_of, input->node_count, error));
    for (int64_t n = 0; n < input->node_count; n++) {
        local_of[n] = -1;
    }
    for (int64_t b = 0; b < input->block_count; b++) {
        struct pair_block *block = &pairs->blocks[b];
        block->first_row = input->first_row[b];
        block->row_count = input->first_row[b + 1] - block->first_row;
        block->first_node = pairs->block_node_count;
        for (int64_t r = block->first_row; r < block->first_row + block->row_count; r++) {
            const int32_t *idx = input->idx + input->ptr[input->row[r]];
            for (int64_t i = pairs->ptr[r]; i < pairs->ptr[r + 1]; i++) {
                int32_t node = input->place[idx[i - pairs->ptr[r]]];
                if (local_of[node] < 0) {
                    local_of[node] = (int32_t)block->node_count++;
                    TRY(add_block_node(pairs, node, &capacity, error));
                }
                if (local_of[node] >= PAIRS_MAX_NODES) {
                    status =
                        fail(error, STATUS_INPUT,
                             "nbr.idx: a block of points has more than %d neighbours: supports are too large",
                             PAIRS_MAX_NODES);
                    goto done;
                }
                pairs->offset[i] = (uint16_t)(local_of[node] * stride);
            }
        }
        for (int64_t i = 0; i < block->node_count; i++) {
            local_of[pairs->block_node[block->first_node + i]] = -1;
        }
    }
    TRY(NEW_ARRAY(&pairs->block_force, pairs->block_node_count * stride, error));
done:
    free(local_of);
    return status;
}

/* For each node the entries of block_force that are its own. */
static enum status number_sums(struct pairs *pairs, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&pairs->sum_ptr, pairs->node_count + 2, error));
    TRY(NEW_ARRAY(&pairs->sum, pairs->block_node_count, error));
    for (int64_t i = 0; i < pairs->block_node_count; i++) {
        pairs->sum_ptr[pairs->block_node[i] + 2]++;
    }
    for (int64_t n = 0; n < pairs->node_count; n++) {
        pairs->sum_ptr[n + 2] += pairs->sum_ptr[n + 1];
    }
    for (int64_t i = 0; i < pairs->block_node_count; i++) {
        pairs->sum[pairs->sum_ptr[pairs->block_node[i] + 1]++] = (int32_t)i;
    }
done:
    return status;
}

enum status pairs_build(const struct pairs_input *input, struct pairs *pairs, struct error *error)
{
    enum status status;
    *pairs = (struct pairs){.dim = input->dim,
                            .width = input->width,
                            .node_count = input->node_count,
                            .row_count = input->row_count,
                            .block_count = input->block_count};
    TRY(copy_values(input, pairs, error));
    pairs->large = pairs->pair_count * (2 + input->width * (input->single ? 4 : 8)) > second_cache;
    TRY(number_nodes(input, pairs, error));
    TRY(number_sums(pairs, error));
done:
    if (status != STATUS_OK) {
        pairs_free(pairs);
    }
    return status;
}

void pairs_free(struct pairs *pairs)
{
    void *arrays[] = {pairs->ptr,          pairs->offset,  pairs->value,
                      pairs->single_value, pairs->blocks,  pairs->block_node,
                      pairs->block_force,  pairs->sum_ptr, pairs->sum};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *pairs = (struct pairs){0};
}
