/* A sparse operator (sliced ELL) from nodes to rows, laid out for the force loop: rows in blocks, each with a
 * compact list of its nodes, so that a block's displacements lie in the first cache and indices take 16 bits.
 *
 * A slice is a group of four rows, one to each lane of a vector. An entry of a slice has for each row a node
 * and its values. First come the shared entries: one node for all four rows, which at least three of them
 * have, so that its displacement is read, and its force written, once for four rows. The other nodes of the
 * rows follow, side by side, in entries where each row has its own node. Where a row lacks a shared node, or
 * its list is at its end, the value is zero: some 5 % of an operator.
 *
 * Gathering (apply) computes for each row the sum over its nodes; scattering (transposed apply) adds to the
 * nodes. The partition depends on the input alone, never on threads: the blocks of a patch (accumulation
 * block), one after the other, add to forces on the accumulation block's own nodes, and each node sums over
 * its accumulation blocks in their order, so that any number of threads gives the same bits. */
#ifndef SOLID_SPARSE_OPERATOR_H
#define SOLID_SPARSE_OPERATOR_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Displacements and forces stand so many doubles apart: 2, or 3 padded to 4. */
#define OPERATOR_STRIDE(dim) ((dim) == 2 ? 2 : 4)

/* Rows of a slice. */
#define OPERATOR_SLICE 4

/* Forces on a node in lanes stand so many doubles apart: for each component one for each row of a slice, and
 * behind these a vector of components. */
#define OPERATOR_LANES(dim) ((dim) == 2 ? 12 : 16)

/* The most rows of a block. */
#define OPERATOR_MAX_ROWS 128

/* The most nodes a block may hold. */
#define OPERATOR_MAX_NODES 8192

struct operator_block {
    int64_t first_row, row_count;
    int64_t first_slice, slice_count; /* the last slice may have less than OPERATOR_SLICE rows */
    int64_t first_node, node_count;   /* in block_node and block_place */
};

/* Blocks whose forces are summed before the nodes see them: near each other, they share most of their nodes.
 * One thread works on an accumulation block. */
struct accumulation_block {
    int64_t first_block, block_count;
    int64_t first_force, force_count; /* in accumulated_force */
};

struct operator_slice {
    int64_t first_entry, first_offset;
    int32_t shared, own; /* entries of each kind, in this order */
};

struct sparse_operator {
    int dim;
    int width; /* values of each pair: dim (a gradient), or 1 (a shape function) */
    int64_t node_count, row_count, pair_count, slice_count, entry_count, offset_count;
    int passes;                    /* over the table in an evaluation, see operator_input */
    bool large;                    /* does not stay in the second cache from one evaluation to the next */
    struct operator_slice *slices; /* slice_count, and one more where the entries end */
    uint16_t *offset; /* where the displacement of a node begins in those of the block: one for a shared
                         entry, OPERATOR_SLICE for another */
    double *value;    /* entry_count * width * OPERATOR_SLICE: first values of an entry's rows, then their
                         second .. */
    int64_t block_count;
    struct operator_block *blocks;
    int64_t block_node_count;
    int32_t *block_node;  /* block_node_count */
    int32_t *block_place; /* block_node_count: the force in accumulated_force of each */
    int64_t accumulation_count, force_count;
    struct accumulation_block *accumulation;
    double *accumulated_force; /* force_count * stride: scratch */
    int64_t *sum_ptr; /* node_count + 1: entries of accumulated_force of each node, in the accumulation
                         blocks' order */
    int32_t *sum;     /* force_count */
};

/* The caller's lists, and its rows in blocks. */
struct operator_rows {
    int64_t node_count, row_count;
    const int64_t *ptr; /* the nodes of each of the caller's rows */
    const int32_t *idx;
    int64_t *row; /* row_count: the caller's row at each place */
    int64_t block_count;
    const int64_t *first_row; /* block_count + 1; no block has more than OPERATOR_MAX_ROWS */
    int least_sharing;        /* so many rows of a slice, or more, share a node that they have */
};

struct operator_input {
    struct operator_rows rows;
    int dim, width;
    const double *value;  /* the caller's values */
    const int32_t *place; /* node_count: the number by which each of the caller's nodes goes here */
    int passes;           /* 1: a block is scattered as soon as it is gathered; 2: all blocks later */
};

/* Lay out a table; the arrays are copied. STATUS_INPUT when a block has too many nodes. */
MUST_CHECK enum status sparse_operator_build(const struct operator_input *input, struct sparse_operator *op,
                                             struct error *error);
void sparse_operator_free(struct sparse_operator *op);

/* Before the blocks of an accumulation block scatter: no forces yet. */
void sparse_operator_clear_forces(struct sparse_operator *op, const struct accumulation_block *accumulation);

/* Doubles that a thread needs for a block: its nodes' displacements, or their forces in each lane and behind
 * them. */
int64_t sparse_operator_scratch(const struct sparse_operator *op);

/* Bytes of the table, which a pass reads. */
int64_t sparse_operator_bytes(const struct sparse_operator *op);

#endif
