#include "solid/pairs.h"

#include "base/memory.h"
#include "solid/pairs_entries.h"
#include "solid/pairs_patches.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of a table that stays in a core's second cache. */
static const int64_t second_cache = 1 << 20;

/* The blocks, and how many groups they have. */
static enum status cut_groups(const struct pairs_rows *rows, struct pairs *pairs, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&pairs->blocks, rows->block_count, error));
    for (int64_t b = 0; b < rows->block_count; b++) {
        struct pair_block *block = &pairs->blocks[b];
        block->first_row = rows->first_row[b];
        block->row_count = rows->first_row[b + 1] - block->first_row;
        block->first_group = pairs->group_count;
        block->group_count = (block->row_count + PAIRS_GROUP - 1) / PAIRS_GROUP;
        pairs->group_count += block->group_count;
    }
    for (int64_t r = 0; r < rows->row_count; r++) {
        pairs->pair_count += rows->ptr[rows->row[r] + 1] - rows->ptr[rows->row[r]];
    }
    status = NEW_ARRAY(&pairs->groups, pairs->group_count + 1, error);
done:
    return status;
}

/* Rows of group g of a block. */
static int rows_of_group(const struct pair_block *block, int64_t g)
{
    int64_t left = block->row_count - g * PAIRS_GROUP;
    return left < PAIRS_GROUP ? (int)left : PAIRS_GROUP;
}

/* Where the entries of each group lie. */
static void count_entries(const struct pairs_rows *rows, struct pairs *pairs, struct entries *entries)
{
    for (int64_t b = 0; b < pairs->block_count; b++) {
        const struct pair_block *block = &pairs->blocks[b];
        for (int64_t g = 0; g < block->group_count; g++) {
            entries_list(rows, block->first_row + g * PAIRS_GROUP, rows_of_group(block, g), entries);
            pairs->groups[block->first_group + g] = (struct pair_group){
                pairs->entry_count, pairs->offset_count, (int32_t)entries->shared, (int32_t)entries->own};
            pairs->entry_count += entries->shared + entries->own;
            pairs->offset_count += entries->shared + entries->own * PAIRS_GROUP;
        }
    }
    pairs->groups[pairs->group_count] = (struct pair_group){pairs->entry_count, pairs->offset_count, 0, 0};
}

static void fill_values(const struct pairs_input *input, struct pairs *pairs, int64_t first_entry,
                        const struct entries *entries)
{
    int64_t at = first_entry * input->width * PAIRS_GROUP;
    for (int64_t e = 0; e < entries->shared + entries->own; e++) {
        for (int k = 0; k < input->width; k++) {
            for (int r = 0; r < PAIRS_GROUP; r++, at++) {
                int64_t pair = entries->entry[e].pair[r];
                double value = pair < 0 ? 0.0 : input->value[pair * input->width + k];
                pairs->value[at] = value;
            }
        }
    }
}

/* Numbers of the nodes of a block. */
struct numbering {
    int32_t *local_of; /* node_count, or -1 */
    int64_t capacity;  /* of block_node */
};

static enum status number_node(struct pairs *pairs, struct pair_block *block, int32_t node,
                               struct numbering *numbering, uint16_t *offset, struct error *error)
{
    int32_t *local = &numbering->local_of[node];
    if (*local < 0) {
        if (block->node_count == PAIRS_MAX_NODES) {
            return fail(error, STATUS_INPUT,
                        "nbr.idx: a block of points has more than %d neighbours: supports are too large",
                        PAIRS_MAX_NODES);
        }
        if (pairs->block_node_count == numbering->capacity) {
            numbering->capacity = numbering->capacity * 2 + 4096;
            int32_t *grown = array_grow(pairs->block_node, numbering->capacity, sizeof *grown);
            if (grown == NULL) {
                return fail_memory(error, "nodes of blocks");
            }
            pairs->block_node = grown;
        }
        *local = (int32_t)block->node_count++;
        pairs->block_node[pairs->block_node_count++] = node;
    }
    *offset = (uint16_t)(*local * PAIRS_STRIDE(pairs->dim));
    return STATUS_OK;
}

/* Where the entries of a group find their nodes. */
static enum status fill_offsets(const struct pairs_input *input, struct pairs *pairs,
                                struct pair_block *block, int64_t first_offset, const struct entries *entries,
                                struct numbering *numbering, struct error *error)
{
    enum status status = STATUS_OK;
    uint16_t *offset = pairs->offset + first_offset;
    for (int64_t e = 0; e < entries->shared + entries->own; e++) {
        for (int r = 0; r < (e < entries->shared ? 1 : PAIRS_GROUP); r++) {
            int32_t node = input->place[entries->entry[e].node[r]];
            TRY(number_node(pairs, block, node, numbering, offset++, error));
        }
    }
done:
    return status;
}

/* Entries and values of all groups, the nodes of each block. */
static enum status fill(const struct pairs_input *input, struct pairs *pairs, struct entries *entries,
                        struct error *error)
{
    enum status status;
    struct numbering numbering = {0};
    int64_t values = pairs->entry_count * input->width * PAIRS_GROUP;
    TRY(NEW_ARRAY(&numbering.local_of, pairs->node_count, error));
    TRY(NEW_ARRAY(&pairs->offset, pairs->offset_count, error));
    TRY(NEW_ARRAY(&pairs->value, values, error));
    memset(numbering.local_of, -1, (size_t)pairs->node_count * sizeof *numbering.local_of);
    for (int64_t b = 0; b < pairs->block_count; b++) {
        struct pair_block *block = &pairs->blocks[b];
        block->first_node = pairs->block_node_count;
        for (int64_t g = 0; g < block->group_count; g++) {
            const struct pair_group *group = &pairs->groups[block->first_group + g];
            entries_list(&input->rows, block->first_row + g * PAIRS_GROUP, rows_of_group(block, g), entries);
            fill_values(input, pairs, group->first_entry, entries);
            TRY(fill_offsets(input, pairs, block, group->first_offset, entries, &numbering, error));
        }
        for (int64_t i = 0; i < block->node_count; i++) {
            numbering.local_of[pairs->block_node[block->first_node + i]] = -1;
        }
    }
done:
    free(numbering.local_of);
    return status;
}

enum status pairs_build(const struct pairs_input *input, struct pairs *pairs, struct error *error)
{
    enum status status;
    struct entries entries = {0};
    *pairs = (struct pairs){.dim = input->dim,
                            .width = input->width,
                            .passes = input->passes,
                            .node_count = input->rows.node_count,
                            .row_count = input->rows.row_count,
                            .block_count = input->rows.block_count};
    TRY(cut_groups(&input->rows, pairs, error));
    TRY(entries_make(&input->rows, &entries, error));
    count_entries(&input->rows, pairs, &entries);
    TRY(fill(input, pairs, &entries, error));
    TRY(patches_make(pairs, error));
    pairs->large = pairs_bytes(pairs) > second_cache;
done:
    entries_free(&entries);
    if (status != STATUS_OK) {
        pairs_free(pairs);
    }
    return status;
}

void pairs_clear_forces(struct pairs *pairs, const struct pair_patch *patch)
{
    int64_t stride = PAIRS_STRIDE(pairs->dim);
    memset(pairs->patch_force + patch->first_force * stride, 0,
           (size_t)(patch->force_count * stride) * sizeof *pairs->patch_force);
}

int64_t pairs_scratch(const struct pairs *pairs)
{
    int64_t most = 0;
    for (int64_t b = 0; b < pairs->block_count; b++) {
        most = pairs->blocks[b].node_count > most ? pairs->blocks[b].node_count : most;
    }
    return most * PAIRS_LANES(pairs->dim);
}

int64_t pairs_bytes(const struct pairs *pairs)
{
    return pairs->entry_count * pairs->width * PAIRS_GROUP * (int64_t)sizeof *pairs->value +
           pairs->offset_count * (int64_t)sizeof *pairs->offset;
}

void pairs_free(struct pairs *pairs)
{
    void *arrays[] = {pairs->groups,     pairs->offset,  pairs->value,       pairs->blocks,
                      pairs->block_node, pairs->patches, pairs->patch_force, pairs->block_place,
                      pairs->sum,        pairs->sum_ptr};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *pairs = (struct pairs){0};
}
