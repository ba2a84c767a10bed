#include "solid/sparse_operator.h"

#include "base/memory.h"
#include "solid/operator_entries.h"
#include "solid/operator_accumulation.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of a table that stays in a core's second cache. */
static const int64_t second_cache = 1 << 20;

/* The blocks, and how many slices they have. */
static enum status cut_slices(const struct operator_rows *rows, struct sparse_operator *op,
                              struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&op->blocks, rows->block_count, error));
    for (int64_t b = 0; b < rows->block_count; b++) {
        struct operator_block *block = &op->blocks[b];
        block->first_row = rows->first_row[b];
        block->row_count = rows->first_row[b + 1] - block->first_row;
        block->first_slice = op->slice_count;
        block->slice_count = (block->row_count + OPERATOR_SLICE - 1) / OPERATOR_SLICE;
        op->slice_count += block->slice_count;
    }
    for (int64_t r = 0; r < rows->row_count; r++) {
        op->pair_count += rows->ptr[rows->row[r] + 1] - rows->ptr[rows->row[r]];
    }
    status = NEW_ARRAY(&op->slices, op->slice_count + 1, error);
done:
    return status;
}

/* Rows of slice g of a block. */
static int rows_of_slice(const struct operator_block *block, int64_t g)
{
    int64_t left = block->row_count - g * OPERATOR_SLICE;
    return left < OPERATOR_SLICE ? (int)left : OPERATOR_SLICE;
}

/* Where the entries of each slice lie. */
static void count_entries(const struct operator_rows *rows, struct sparse_operator *op,
                          struct entries *entries)
{
    for (int64_t b = 0; b < op->block_count; b++) {
        const struct operator_block *block = &op->blocks[b];
        for (int64_t g = 0; g < block->slice_count; g++) {
            entries_list(rows, block->first_row + g * OPERATOR_SLICE, rows_of_slice(block, g), entries);
            op->slices[block->first_slice + g] = (struct operator_slice){
                op->entry_count, op->offset_count, (int32_t)entries->shared, (int32_t)entries->own};
            op->entry_count += entries->shared + entries->own;
            op->offset_count += entries->shared + entries->own * OPERATOR_SLICE;
        }
    }
    op->slices[op->slice_count] = (struct operator_slice){op->entry_count, op->offset_count, 0, 0};
}

static void fill_values(const struct operator_input *input, struct sparse_operator *op, int64_t first_entry,
                        const struct entries *entries)
{
    int64_t at = first_entry * input->width * OPERATOR_SLICE;
    for (int64_t e = 0; e < entries->shared + entries->own; e++) {
        for (int k = 0; k < input->width; k++) {
            for (int r = 0; r < OPERATOR_SLICE; r++, at++) {
                int64_t pair = entries->entry[e].pair[r];
                double value = pair < 0 ? 0.0 : input->value[pair * input->width + k];
                op->value[at] = value;
            }
        }
    }
}

/* Numbers of the nodes of a block. */
struct numbering {
    int32_t *local_of; /* node_count, or -1 */
    int64_t capacity;  /* of block_node */
};

static enum status number_node(struct sparse_operator *op, struct operator_block *block, int32_t node,
                               struct numbering *numbering, uint16_t *offset, struct error *error)
{
    int32_t *local = &numbering->local_of[node];
    if (*local < 0) {
        if (block->node_count == OPERATOR_MAX_NODES) {
            return fail(error, STATUS_INPUT,
                        "nbr.idx: a block of points has more than %d neighbours: supports are too large",
                        OPERATOR_MAX_NODES);
        }
        if (op->block_node_count == numbering->capacity) {
            numbering->capacity = numbering->capacity * 2 + 4096;
            int32_t *grown = array_grow(op->block_node, numbering->capacity, sizeof *grown);
            if (grown == NULL) {
                return fail_memory(error, "nodes of blocks");
            }
            op->block_node = grown;
        }
        *local = (int32_t)block->node_count++;
        op->block_node[op->block_node_count++] = node;
    }
    *offset = (uint16_t)(*local * OPERATOR_STRIDE(op->dim));
    return STATUS_OK;
}

/* Where the entries of a slice find their nodes. */
static enum status fill_offsets(const struct operator_input *input, struct sparse_operator *op,
                                struct operator_block *block, int64_t first_offset,
                                const struct entries *entries, struct numbering *numbering,
                                struct error *error)
{
    enum status status = STATUS_OK;
    uint16_t *offset = op->offset + first_offset;
    for (int64_t e = 0; e < entries->shared + entries->own; e++) {
        for (int r = 0; r < (e < entries->shared ? 1 : OPERATOR_SLICE); r++) {
            int32_t node = input->place[entries->entry[e].node[r]];
            TRY(number_node(op, block, node, numbering, offset++, error));
        }
    }
done:
    return status;
}

/* Entries and values of all slices, the nodes of each block. */
static enum status fill(const struct operator_input *input, struct sparse_operator *op,
                        struct entries *entries, struct error *error)
{
    enum status status;
    struct numbering numbering = {0};
    int64_t values = op->entry_count * input->width * OPERATOR_SLICE;
    TRY(NEW_ARRAY(&numbering.local_of, op->node_count, error));
    TRY(NEW_ARRAY(&op->offset, op->offset_count, error));
    TRY(NEW_ARRAY(&op->value, values, error));
    memset(numbering.local_of, -1, (size_t)op->node_count * sizeof *numbering.local_of);
    for (int64_t b = 0; b < op->block_count; b++) {
        struct operator_block *block = &op->blocks[b];
        block->first_node = op->block_node_count;
        for (int64_t g = 0; g < block->slice_count; g++) {
            const struct operator_slice *slice = &op->slices[block->first_slice + g];
            entries_list(&input->rows, block->first_row + g * OPERATOR_SLICE, rows_of_slice(block, g),
                         entries);
            fill_values(input, op, slice->first_entry, entries);
            TRY(fill_offsets(input, op, block, slice->first_offset, entries, &numbering, error));
        }
        for (int64_t i = 0; i < block->node_count; i++) {
            numbering.local_of[op->block_node[block->first_node + i]] = -1;
        }
    }
done:
    free(numbering.local_of);
    return status;
}

enum status sparse_operator_build(const struct operator_input *input, struct sparse_operator *op,
                                  struct error *error)
{
    enum status status;
    struct entries entries = {0};
    *op = (struct sparse_operator){.dim = input->dim,
                                   .width = input->width,
                                   .passes = input->passes,
                                   .node_count = input->rows.node_count,
                                   .row_count = input->rows.row_count,
                                   .block_count = input->rows.block_count};
    TRY(cut_slices(&input->rows, op, error));
    TRY(entries_make(&input->rows, &entries, error));
    count_entries(&input->rows, op, &entries);
    TRY(fill(input, op, &entries, error));
    TRY(accumulation_make(op, error));
    op->large = sparse_operator_bytes(op) > second_cache;
done:
    entries_free(&entries);
    if (status != STATUS_OK) {
        sparse_operator_free(op);
    }
    return status;
}

void sparse_operator_clear_forces(struct sparse_operator *op, const struct accumulation_block *accumulation)
{
    int64_t stride = OPERATOR_STRIDE(op->dim);
    memset(op->accumulated_force + accumulation->first_force * stride, 0,
           (size_t)(accumulation->force_count * stride) * sizeof *op->accumulated_force);
}

int64_t sparse_operator_scratch(const struct sparse_operator *op)
{
    int64_t most = 0;
    for (int64_t b = 0; b < op->block_count; b++) {
        most = op->blocks[b].node_count > most ? op->blocks[b].node_count : most;
    }
    return most * OPERATOR_LANES(op->dim);
}

int64_t sparse_operator_bytes(const struct sparse_operator *op)
{
    return op->entry_count * op->width * OPERATOR_SLICE * (int64_t)sizeof *op->value +
           op->offset_count * (int64_t)sizeof *op->offset;
}

void sparse_operator_free(struct sparse_operator *op)
{
    void *arrays[] = {op->slices,
                      op->offset,
                      op->value,
                      op->blocks,
                      op->block_node,
                      op->accumulation,
                      op->accumulated_force,
                      op->block_place,
                      op->sum,
                      op->sum_ptr};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *op = (struct sparse_operator){0};
}
