/* A table over pairs of a row and a node, laid out for the force loop: rows in blocks, each with a compact
 * list of its nodes, so that a block's displacements lie in the first cache and indices take 16 bits.
 *
 * Gathering computes, for each row, sums over its nodes' displacements; scattering is the transpose, and adds
 * to the nodes. The partition depends on the input alone, never on threads: each block accumulates forces on
 * its own nodes, and each node sums its blocks' contributions in block order, so that any number of threads
 * gives the same bits. */
#ifndef SOLID_PAIRS_H
#define SOLID_PAIRS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Displacements and forces stand so many doubles apart: 2, or 3 padded to 4. */
#define PAIRS_STRIDE(dim) ((dim) == 2 ? 2 : 4)

/* The most rows of a block. */
#define PAIRS_MAX_ROWS 128

/* The most nodes a block may hold: its displacements lie on the stack of a thread. */
#define PAIRS_MAX_NODES 16384

struct pair_block {
    int64_t first_row, row_count;
    int64_t first_node, node_count; /* in block_node and block_force */
};

struct pairs {
    int dim;
    int width; /* values of each pair: dim (a gradient), or one for each of a group of means (means.h) */
    int64_t node_count, row_count, pair_count;
    bool large;          /* does not stay in the second cache from one evaluation to the next */
    int64_t *ptr;        /* row_count + 1 */
    uint16_t *offset;    /* pair_count: where the node's displacement begins in those of the block */
    double *value;       /* pair_count * width, and one more, which is read and not used; or NULL and */
    float *single_value; /* the same in single precision */
    int64_t block_count;
    struct pair_block *blocks;
    int64_t block_node_count;
    int32_t *block_node; /* block_node_count */
    double *block_force; /* block_node_count * stride: scratch */
    int64_t *sum_ptr;    /* node_count + 1: entries of block_force of each node, in block order */
    int32_t *sum;        /* block_node_count */
};

struct pairs_input {
    int dim, width;
    int64_t node_count, row_count;
    const int64_t *row; /* row_count: the caller's row at each place */
    const int64_t *ptr; /* the caller's lists and values */
    const int32_t *idx;
    const double *value;
    const int32_t *place; /* node_count: the number by which each of the caller's nodes goes here */
    int64_t block_count;
    const int64_t *first_row; /* block_count + 1; no block has more than PAIRS_MAX_ROWS */
    bool single;              /* keep the values in single precision */
};

/* Put the rows of one block, row[count], in the order of their length in the caller's lists, and before that
 * of their corners (means.h; else NULL): loops that go the same way many times in a row are predicted. */
void pairs_sort_rows(int64_t count, int64_t *row, const int64_t *ptr, const int32_t *corners);

/* Lay out a table; the arrays are copied. STATUS_INPUT when a block has too many nodes. */
MUST_CHECK enum status pairs_build(const struct pairs_input *input, struct pairs *pairs, struct error *error);
void pairs_free(struct pairs *pairs);

#endif
