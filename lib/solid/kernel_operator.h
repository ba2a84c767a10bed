/* Kernels over pairs of row and node; private to lib/solid.
 *
 * For each entry of a slice they load the displacement of one node, or of four, and the values of four rows,
 * and multiply and add: reading the operator takes most of the time. */
#ifndef SOLID_KERNEL_OPERATOR_H
#define SOLID_KERNEL_OPERATOR_H

#include "solid/kernel.h"
#include "solid/kernel_vector.h"

/* How a table is read: constants for the compiler. */
struct reading {
    int dim, width;
};

/* Where a kernel is in a table. */
struct cursor {
    const uint16_t *offset;
    const double *value;
    bool prefetches;
    const char *ahead; /* to prefetch now */
    int64_t step;      /* bytes of it at each entry */
};

/* Bytes of an entry. */
KERNEL_INLINE int64_t entry_bytes(struct reading how)
{
    return how.width * OPERATOR_SLICE * (int64_t)sizeof(double);
}

/* At the beginning of a block. Of a table that does not stay in cache, what the next block has is prefetched
 * evenly with the entries of this one: the last three quarters, while the processor sees by itself that the
 * first is read. Where a block is scattered as soon as it is gathered, each of the two does half of it. */
KERNEL_INLINE struct cursor start_block(const struct sparse_operator *op, int64_t b, struct reading how,
                                        bool transposed)
{
    const struct operator_slice *first = &op->slices[op->blocks[b].first_slice];
    const struct operator_slice *next = first + op->blocks[b].slice_count;
    int64_t at = first->first_entry * how.width * OPERATOR_SLICE;
    int64_t share = (next->first_entry - first->first_entry) * entry_bytes(how) * 3 / 4;
    struct cursor cursor = {.offset = op->offset + first->first_offset,
                            .value = op->value + at,
                            .prefetches = op->large,
                            .ahead = (const char *)op->value,
                            .step = entry_bytes(how) * 3 / 4 / (op->passes == 1 ? 2 : 1)};
    cursor.ahead += next->first_entry * entry_bytes(how) + share / 3;
    if (transposed && op->passes == 1) {
        cursor.ahead += share / 2;
    }
    return cursor;
}

/* Go to the next entry, this one having so many offsets. */
KERNEL_INLINE void advance(struct cursor *cursor, struct reading how, int offsets)
{
    cursor->offset += offsets;
    cursor->value += how.width * OPERATOR_SLICE;
    if (cursor->prefetches) {
        prefetch(cursor->ahead, entry_bytes(how) * 3 / 4);
        cursor->ahead += cursor->step;
    }
}

/* sum += u (x) value: component a of u with value k of the pair in sum[a * width + k]. All rows have the same
 * node; */
KERNEL_INLINE void add_shared(struct cursor *cursor, struct reading how, const double *u, quad4 sum[9])
{
    const double *v = u + cursor->offset[0];
    for (int k = 0; k < how.width; k++) {
        quad4 value;
        LOAD(value, cursor->value + k * OPERATOR_SLICE);
        for (int a = 0; a < how.dim; a++) {
            sum[a * how.width + k] += v[a] * value;
        }
    }
    advance(cursor, how, 1);
}

/* each has its own. */
KERNEL_INLINE void add_own(struct cursor *cursor, struct reading how, const double *u, quad4 sum[9])
{
    const double *const from[OPERATOR_SLICE] = {u + cursor->offset[0], u + cursor->offset[1],
                                                u + cursor->offset[2], u + cursor->offset[3]};
    quad4 x[4];
    load_components(from, how.dim, x);
    for (int k = 0; k < how.width; k++) {
        quad4 value;
        LOAD(value, cursor->value + k * OPERATOR_SLICE);
        for (int a = 0; a < how.dim; a++) {
            sum[a * how.width + k] += x[a] * value;
        }
    }
    advance(cursor, how, OPERATOR_SLICE);
}

/* Sums over the entries of a slice of u (x) values, in two chains where one would be bound by the latency of
 * the additions. */
KERNEL_INLINE void apply_slice(const struct operator_slice *slice, struct reading how, const double *u,
                               struct cursor *cursor, quad4 sum[9])
{
    quad4 odd[9] = {{0.0}};
    int32_t shared = slice->shared, own = slice->own;
    bool two_chains = how.dim * how.width < 9;
    for (; two_chains && shared >= 2; shared -= 2) {
        add_shared(cursor, how, u, sum);
        add_shared(cursor, how, u, odd);
    }
    for (; shared > 0; shared--) {
        add_shared(cursor, how, u, sum);
    }
    for (; own > 0; own--) {
        add_own(cursor, how, u, sum);
    }
    for (int k = 0; two_chains && k < how.dim * how.width; k++) {
        sum[k] += odd[k];
    }
}

/* The transpose: sum_k factor[a * width + k] value_k into component a of each row's x. */
KERNEL_INLINE void multiply(const struct cursor *cursor, struct reading how, const quad4 factor[9],
                            quad4 x[4])
{
    for (int k = 0; k < how.width; k++) {
        quad4 value;
        LOAD(value, cursor->value + k * OPERATOR_SLICE);
        for (int a = 0; a < how.dim; a++) {
            x[a] += factor[a * how.width + k] * value;
        }
    }
}

/* Add four vectors given by components. */
KERNEL_INLINE void add_vectors(const quad4 x[4], int dim, double *const to[OPERATOR_SLICE])
{
    if (dim == 2) {
        quad4 even = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6);
        quad4 odd = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7);
        pair2 row[OPERATOR_SLICE] = {
            __builtin_shufflevector(even, even, 0, 1), __builtin_shufflevector(odd, odd, 0, 1),
            __builtin_shufflevector(even, even, 2, 3), __builtin_shufflevector(odd, odd, 2, 3)};
        for (int r = 0; r < OPERATOR_SLICE; r++) {
            pair2 sum;
            LOAD(sum, to[r]);
            sum += row[r];
            STORE(to[r], sum);
        }
    } else {
        quad4 row[4] = {x[0], x[1], x[2], {0.0}};
        transpose(row);
        for (int r = 0; r < OPERATOR_SLICE; r++) {
            quad4 sum;
            LOAD(sum, to[r]);
            sum += row[r];
            STORE(to[r], sum);
        }
    }
}

/* What a slice puts on its nodes: lane_forces has for each node and component a vector along the rows, and
 * behind them, as a vector of components, what comes from entries that the rows do not share. */
KERNEL_INLINE void apply_slice_transposed(const struct operator_slice *slice, struct reading how,
                                          const quad4 factor[9], double *restrict lane_forces,
                                          struct cursor *cursor)
{
    int32_t shared = slice->shared, own = slice->own;
    int apart = OPERATOR_LANES(how.dim) / OPERATOR_STRIDE(how.dim);
    for (; shared > 0; shared--) {
        double *to = lane_forces + cursor->offset[0] * apart;
        quad4 x[4];
        for (int a = 0; a < how.dim; a++) {
            LOAD(x[a], to + a * OPERATOR_SLICE);
        }
        multiply(cursor, how, factor, x);
        for (int a = 0; a < how.dim; a++) {
            STORE(to + a * OPERATOR_SLICE, x[a]);
        }
        advance(cursor, how, 1);
    }
    for (; own > 0; own--) {
        double *own_forces = lane_forces + how.dim * OPERATOR_SLICE;
        double *const to[OPERATOR_SLICE] = {
            own_forces + cursor->offset[0] * apart, own_forces + cursor->offset[1] * apart,
            own_forces + cursor->offset[2] * apart, own_forces + cursor->offset[3] * apart};
        quad4 x[4] = {{0.0}};
        multiply(cursor, how, factor, x);
        add_vectors(x, how.dim, to);
        advance(cursor, how, OPERATOR_SLICE);
    }
}

/* Displacements of the block's nodes. */
KERNEL_INLINE void localise(const struct sparse_operator *op, int64_t b, int dim, const double *u,
                            double *restrict local)
{
    const struct operator_block *block = &op->blocks[b];
    const int32_t *node = op->block_node + block->first_node;
    int64_t stride = OPERATOR_STRIDE(dim);
    for (int64_t i = 0; i < block->node_count; i++) {
        memcpy(local + i * stride, u + node[i] * stride, (size_t)stride * sizeof *u);
    }
}

/* Forces of a block on its nodes: none yet. */
KERNEL_INLINE void clear_lanes(const struct operator_block *block, int dim, double *lane_forces)
{
    memset(lane_forces, 0, (size_t)(block->node_count * OPERATOR_LANES(dim)) * sizeof *lane_forces);
}

/* Add them to those of the accumulation block. */
KERNEL_INLINE void sum_lanes(struct sparse_operator *op, int64_t b, int dim,
                             const double *restrict lane_forces)
{
    const struct operator_block *block = &op->blocks[b];
    const int32_t *place = op->block_place + block->first_node;
    for (int64_t i = 0; i < block->node_count; i++, lane_forces += OPERATOR_LANES(dim)) {
        double *force = op->accumulated_force + (int64_t)place[i] * OPERATOR_STRIDE(dim);
        quad4 row[4] = {{0.0}};
        for (int a = 0; a < dim; a++) {
            LOAD(row[a], lane_forces + a * OPERATOR_SLICE);
        }
        quad4 pairs_of_lanes = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6) +
                               __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
        if (dim == 2) {
            pair2 sum, own;
            LOAD(sum, force);
            LOAD(own, lane_forces + dim * OPERATOR_SLICE);
            sum += own + (__builtin_shufflevector(pairs_of_lanes, pairs_of_lanes, 0, 1) +
                          __builtin_shufflevector(pairs_of_lanes, pairs_of_lanes, 2, 3));
            STORE(force, sum);
        } else {
            quad4 sum, own,
                others = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6) +
                         __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
            LOAD(sum, force);
            LOAD(own, lane_forces + dim * OPERATOR_SLICE);
            sum += own + (__builtin_shufflevector(pairs_of_lanes, others, 0, 1, 4, 5) +
                          __builtin_shufflevector(pairs_of_lanes, others, 2, 3, 6, 7));
            STORE(force, sum);
        }
    }
}

/* F of the points of a block, I + u (x) grad phi. */
KERNEL_INLINE void apply_gradients(const struct sparse_operator *op, int64_t b, struct reading how,
                                   const double *restrict local, block_rows F)
{
    const struct operator_block *block = &op->blocks[b];
    struct cursor cursor = start_block(op, b, how, false);
    int dim = how.dim;
    for (int64_t g = 0; g < block->slice_count; g++) {
        quad4 sum[9] = {{0.0}};
        for (int a = 0; a < dim; a++) {
            sum[a * dim + a] += 1.0;
        }
        apply_slice(&op->slices[block->first_slice + g], how, local, &cursor, sum);
        for (int k = 0; k < dim * dim; k++) {
            STORE(F[k] + g * OPERATOR_SLICE, sum[k]);
        }
    }
    for (int k = 0; block->slice_count * OPERATOR_SLICE % LANES != 0 && k < dim * dim;
         k++) { /* whole vectors */
        quad4 rest = k % (dim + 1) == 0 ? (quad4){1.0, 1.0, 1.0, 1.0} : (quad4){0.0};
        STORE(F[k] + block->slice_count * OPERATOR_SLICE, rest);
    }
}

/* f_j = sum_q P_q grad phi_j */
KERNEL_INLINE void apply_gradients_transposed(struct sparse_operator *op, int64_t b, struct reading how,
                                              const block_rows P, double *restrict lane_forces)
{
    const struct operator_block *block = &op->blocks[b];
    struct cursor cursor = start_block(op, b, how, true);
    clear_lanes(block, how.dim, lane_forces);
    for (int64_t g = 0; g < block->slice_count; g++) {
        quad4 stress[9];
        for (int k = 0; k < how.dim * how.dim; k++) {
            LOAD(stress[k], P[k] + g * OPERATOR_SLICE);
        }
        apply_slice_transposed(&op->slices[block->first_slice + g], how, stress, lane_forces, &cursor);
    }
    sum_lanes(op, b, how.dim, lane_forces);
}

KERNEL_INLINE void kernel_apply(const struct sparse_operator *op, int64_t b, int dim, const double *u,
                                block_rows F, double *scratch)
{
    localise(op, b, dim, u, scratch);
    apply_gradients(op, b, (struct reading){dim, dim}, scratch, F);
}

KERNEL_INLINE void kernel_apply_transposed(struct sparse_operator *op, int64_t b, int dim, const block_rows P,
                                           double *scratch)
{
    apply_gradients_transposed(op, b, (struct reading){dim, dim}, P, scratch);
}

/* Displacements in the body's order. */
KERNEL_INLINE void kernel_place(struct body *body, int64_t first, int64_t last, int dim, const double *u)
{
    for (int64_t n = first; n < last; n++) {
        for (int a = 0; a < dim; a++) {
            body->u[n * OPERATOR_STRIDE(dim) + a] = u[body->node_order[n] * dim + a];
        }
    }
}

/* What the accumulation blocks of a table put on a node. */
#define SUM_KERNEL(dim, vector)                                                                              \
    KERNEL_INLINE void add_accumulated_##dim(const struct sparse_operator *op, int64_t node, vector *sum)    \
    {                                                                                                        \
        for (int64_t i = op->sum_ptr[node]; i < op->sum_ptr[node + 1]; i++) {                                \
            vector part;                                                                                     \
            LOAD(part, op->accumulated_force + (int64_t)op->sum[i] * OPERATOR_STRIDE(dim));                  \
            *sum += part;                                                                                    \
        }                                                                                                    \
    }                                                                                                        \
    KERNEL_INLINE void sum_nodes_##dim(const struct body *body, int64_t first, int64_t last, double *force)  \
    {                                                                                                        \
        const struct sparse_operator *op = body->smoothed ? &body->cells.faces.op : &body->gradients;        \
        for (int64_t n = first; n < last; n++) {                                                             \
            vector sum = {0.0};                                                                              \
            add_accumulated_##dim(op, n, &sum);                                                              \
            if (body->smoothed) {                                                                            \
                add_accumulated_##dim(&body->cells.nodes.op, n, &sum);                                       \
            }                                                                                                \
            for (int a = 0; a < dim; a++) {                                                                  \
                force[body->node_order[n] * dim + a] = sum[a];                                               \
            }                                                                                                \
        }                                                                                                    \
    }
SUM_KERNEL(2, pair2)
SUM_KERNEL(3, quad4)

#endif
