/* Kernels over pairs of row and node; private to lib/solid.
 *
 * Per pair they do no more than a load of the table, a load of the displacement or force, and the
 * multiplications: the tables decide the speed. Each is compiled for tables in double and in single
 * precision; sums are double always. */
#ifndef SOLID_KERNEL_PAIRS_H
#define SOLID_KERNEL_PAIRS_H

#include "solid/compatibility.h"
#include "solid/kernel.h"
#include "solid/kernel_vector.h"

/* Independent sums of a row: the loop is bound by the latency of the additions otherwise. */
enum { CHAINS = 4 };

#define UNROLL _Pragma("GCC unroll 4")

/* Displacements of the block's nodes. */
KERNEL_INLINE void localise(const struct pairs *pairs, const struct pair_block *block, int dim,
                            const double *u, double *restrict local)
{
    const int32_t *node = pairs->block_node + block->first_node;
    int64_t stride = PAIRS_STRIDE(dim);
    for (int64_t i = 0; i < block->node_count; i++) {
        memcpy(local + i * stride, u + node[i] * stride, (size_t)stride * sizeof *u);
    }
}

/* Value i of a table. */
KERNEL_INLINE double table_value(const struct pairs *pairs, int64_t i, bool single)
{
    return single ? (double)pairs->single_value[i] : pairs->value[i];
}

/* Prefetch what the next block has in place of this row, of a table that does not stay in cache. */
KERNEL_INLINE void prefetch_row(const struct pairs *pairs, const struct pair_block *block, int64_t row,
                                int width, bool single)
{
    if (!pairs->large) {
        return;
    }
    const int64_t *ptr = pairs->ptr;
    int64_t ahead = ptr[block->first_row + block->row_count] - ptr[block->first_row];
    int64_t first = ptr[row] + ahead, last = ptr[row + 1] + ahead;
    if (single) {
        prefetch(pairs->single_value, first * width * 4, last * width * 4);
    } else {
        prefetch(pairs->value, first * width * 8, last * width * 8);
    }
    prefetch(pairs->offset, first * 2, last * 2);
}

/* As many values of a table from i on as the vector has lanes. */
#define LOAD_VALUES(vector)                                                                                  \
    KERNEL_INLINE void load_##vector(const struct pairs *pairs, int64_t i, bool single, vector *value)       \
    {                                                                                                        \
        if (single) {                                                                                        \
            vector##_float narrow;                                                                           \
            LOAD(narrow, pairs->single_value + i);                                                           \
            *value = __builtin_convertvector(narrow, vector);                                                \
        } else {                                                                                             \
            LOAD(*value, pairs->value + i);                                                                  \
        }                                                                                                    \
    }
LOAD_VALUES(pair2)
LOAD_VALUES(quad4)

/* Value i + k of a table, of which `values` holds those from i on: in double precision a load that spreads it
 * over the lanes is quicker than a shuffle. */
#define VALUE_OF(values, pairs, i, k, single) ((single) ? (values)[k] : (pairs)->value[(i) + (k)])

/* Columns of F += u grad phi. */
KERNEL_INLINE void outer2(const struct pairs *pairs, int64_t i, const double *u, bool single, pair2 column[2])
{
    pair2 uu;
    LOAD(uu, u + pairs->offset[i]);
    column[0] += uu * table_value(pairs, 2 * i, single);
    column[1] += uu * table_value(pairs, 2 * i + 1, single);
}

KERNEL_INLINE void gradients_2d(const struct pairs *pairs, const struct pair_block *block,
                                const double *restrict u, bool single, double *restrict F, int64_t stride)
{
    for (int64_t row = block->first_row; row < block->first_row + block->row_count; row++, F++) {
        pair2 column[CHAINS][2] = {{{1.0, 0.0}, {0.0, 1.0}}};
        int64_t i = pairs->ptr[row], end = pairs->ptr[row + 1];
        for (; i + CHAINS <= end; i += CHAINS) {
            for (int chain = 0; chain < CHAINS; chain++) {
                outer2(pairs, i + chain, u, single, column[chain]);
            }
        }
        for (; i < end; i++) {
            outer2(pairs, i, u, single, column[0]);
        }
        for (int b = 0; b < 2; b++) {
            pair2 sum = (column[0][b] + column[1][b]) + (column[2][b] + column[3][b]);
            F[b * stride] = sum[0];
            F[(2 + b) * stride] = sum[1];
        }
    }
}

/* Rows of F += u_a (g0, g1, g2, junk). */
KERNEL_INLINE void outer3(const struct pairs *pairs, int64_t i, const double *u, bool single, quad4 row[3])
{
    const double *v = u + pairs->offset[i];
    quad4 g;
    load_quad4(pairs, 3 * i, single, &g);
    for (int a = 0; a < 3; a++) {
        row[a] += v[a] * g;
    }
}

KERNEL_INLINE void gradients_3d(const struct pairs *pairs, const struct pair_block *block,
                                const double *restrict u, bool single, double *restrict F, int64_t stride)
{
    for (int64_t row = block->first_row; row < block->first_row + block->row_count; row++, F++) {
        quad4 part[CHAINS][3] = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
        int64_t i = pairs->ptr[row], end = pairs->ptr[row + 1];
        for (; i + CHAINS <= end; i += CHAINS) {
            for (int chain = 0; chain < CHAINS; chain++) {
                outer3(pairs, i + chain, u, single, part[chain]);
            }
        }
        for (; i < end; i++) {
            outer3(pairs, i, u, single, part[0]);
        }
        for (int a = 0; a < 3; a++) {
            quad4 sum = (part[0][a] + part[1][a]) + (part[2][a] + part[3][a]);
            for (int b = 0; b < 3; b++) {
                F[(3 * a + b) * stride] = sum[b];
            }
        }
    }
}

KERNEL_INLINE void kernel_gradients(const struct pairs *pairs, const struct pair_block *block, int dim,
                                    const double *local, bool single, double *F, int64_t stride)
{
    if (dim == 2) {
        gradients_2d(pairs, block, local, single, F, stride);
    } else {
        gradients_3d(pairs, block, local, single, F, stride);
    }
}

KERNEL_INLINE void scatter_2d(const struct pairs *pairs, const struct pair_block *block, const block_stress P,
                              bool single, double *restrict force)
{
    const uint16_t *restrict offset = pairs->offset;
    for (int64_t p = 0; p < block->row_count; p++) {
        int64_t row = block->first_row + p;
        pair2 column0 = {P[0][p], P[2][p]}, column1 = {P[1][p], P[3][p]};
        prefetch_row(pairs, block, row, 2, single);
        UNROLL for (int64_t i = pairs->ptr[row], end = pairs->ptr[row + 1]; i < end; i++)
        {
            double *f = force + offset[i];
            pair2 sum, g;
            LOAD(sum, f);
            load_pair2(pairs, 2 * i, single, &g);
            sum += column0 * VALUE_OF(g, pairs, 2 * i, 0, single);
            sum += column1 * VALUE_OF(g, pairs, 2 * i, 1, single);
            STORE(f, sum);
        }
    }
}

KERNEL_INLINE void scatter_3d(const struct pairs *pairs, const struct pair_block *block, const block_stress P,
                              bool single, double *restrict force)
{
    const uint16_t *restrict offset = pairs->offset;
    for (int64_t p = 0; p < block->row_count; p++) {
        int64_t row = block->first_row + p;
        quad4 column0 = {P[0][p], P[3][p], P[6][p], 0.0}, column1 = {P[1][p], P[4][p], P[7][p], 0.0};
        quad4 column2 = {P[2][p], P[5][p], P[8][p], 0.0};
        prefetch_row(pairs, block, row, 3, single);
        UNROLL for (int64_t i = pairs->ptr[row], end = pairs->ptr[row + 1]; i < end; i++)
        {
            double *f = force + offset[i];
            quad4 sum, g;
            LOAD(sum, f);
            load_quad4(pairs, 3 * i, single, &g);
            sum += column0 * VALUE_OF(g, pairs, 3 * i, 0, single);
            sum += column1 * VALUE_OF(g, pairs, 3 * i, 1, single);
            sum += column2 * VALUE_OF(g, pairs, 3 * i, 2, single);
            STORE(f, sum);
        }
    }
}

/* Forces of the block on its nodes, none yet. */
KERNEL_INLINE double *clear_forces(struct pairs *pairs, const struct pair_block *block, int dim)
{
    double *force = pairs->block_force + block->first_node * PAIRS_STRIDE(dim);
    memset(force, 0, (size_t)(block->node_count * PAIRS_STRIDE(dim)) * sizeof *force);
    return force;
}

/* f_j = sum_q P_q grad phi_j */
KERNEL_INLINE void kernel_scatter(struct pairs *pairs, int64_t b, int dim, const block_stress P, bool single)
{
    const struct pair_block *block = &pairs->blocks[b];
    double *force = clear_forces(pairs, block, dim);
    if (dim == 2) {
        scatter_2d(pairs, block, P, single, force);
    } else {
        scatter_3d(pairs, block, P, single, force);
    }
}

KERNEL_INLINE void add_group(const struct pairs *pairs, int64_t i, int dim, const double *u, bool single,
                             quad4 mean[3])
{
    const double *v = u + pairs->offset[i];
    quad4 phi;
    load_quad4(pairs, MEANS_GROUP * i, single, &phi);
    for (int a = 0; a < dim; a++) {
        mean[a] += v[a] * phi;
    }
}

/* Means of the groups of a block. */
KERNEL_INLINE void gather_groups(const struct pairs *pairs, const struct pair_block *block, int dim,
                                 const double *restrict u, bool single, double *restrict value)
{
    for (int64_t g = block->first_row; g < block->first_row + block->row_count; g++) {
        quad4 part[CHAINS][3] = {{{0.0}}};
        int64_t i = pairs->ptr[g], end = pairs->ptr[g + 1];
        for (; i + CHAINS <= end; i += CHAINS) {
            for (int chain = 0; chain < CHAINS; chain++) {
                add_group(pairs, i + chain, dim, u, single, part[chain]);
            }
        }
        for (; i < end; i++) {
            add_group(pairs, i, dim, u, single, part[0]);
        }
        for (int a = 0; a < dim; a++) {
            quad4 sum = (part[0][a] + part[1][a]) + (part[2][a] + part[3][a]);
            STORE(value + (g * dim + a) * MEANS_GROUP, sum);
        }
    }
}

/* The transpose, of what the corners put on the means. Vector: pair2 in 2D, quad4 in 3D. */
#define SCATTER_GROUPS(dim, vector)                                                                          \
    KERNEL_INLINE void scatter_groups_##dim(const struct means *means, const struct pair_block *block,       \
                                            bool single, double *restrict force)                             \
    {                                                                                                        \
        const struct pairs *pairs = &means->pairs;                                                           \
        const uint16_t *restrict offset = pairs->offset;                                                     \
        for (int64_t g = block->first_row; g < block->first_row + block->row_count; g++) {                   \
            vector total[MEANS_GROUP] = {{0.0}}, v;                                                          \
            quad4 phi;                                                                                       \
            for (int64_t i = means->corner_ptr[g]; i < means->corner_ptr[g + 1]; i++) {                      \
                for (int r = 0; r < MEANS_GROUP; r++) {                                                      \
                    LOAD(v, means->corner_force +                                                            \
                                (int64_t)means->corner[i * MEANS_GROUP + r] * PAIRS_STRIDE(dim));            \
                    total[r] += v;                                                                           \
                }                                                                                            \
            }                                                                                                \
            prefetch_row(pairs, block, g, MEANS_GROUP, single);                                              \
            for (int64_t i = pairs->ptr[g], end = pairs->ptr[g + 1]; i < end; i++) {                         \
                double *f = force + offset[i];                                                               \
                LOAD(v, f);                                                                                  \
                load_quad4(pairs, i *MEANS_GROUP, single, &phi);                                             \
                for (int r = 0; r < MEANS_GROUP; r++) {                                                      \
                    v += total[r] * VALUE_OF(phi, pairs, i * MEANS_GROUP, r, single);                        \
                }                                                                                            \
                STORE(f, v);                                                                                 \
            }                                                                                                \
        }                                                                                                    \
    }
SCATTER_GROUPS(2, pair2)
SCATTER_GROUPS(3, quad4)

KERNEL_INLINE void kernel_gather_means(struct means *means, int64_t b, int dim, const double *u,
                                       double *local, bool single)
{
    const struct pairs *pairs = &means->pairs;
    const struct pair_block *block = &pairs->blocks[b];
    localise(pairs, block, dim, u, local);
    gather_groups(pairs, block, dim, local, single, means->value);
}

KERNEL_INLINE void kernel_scatter_means(struct means *means, int64_t b, int dim, bool single)
{
    const struct pair_block *block = &means->pairs.blocks[b];
    double *force = clear_forces(&means->pairs, block, dim);
    if (dim == 2) {
        scatter_groups_2(means, block, single, force);
    } else {
        scatter_groups_3(means, block, single, force);
    }
}

/* Displacements in the body's order. */
KERNEL_INLINE void kernel_place(struct body *body, int64_t first, int64_t last, int dim, const double *u)
{
    for (int64_t n = first; n < last; n++) {
        for (int a = 0; a < dim; a++) {
            body->u[n * PAIRS_STRIDE(dim) + a] = u[body->node_order[n] * dim + a];
        }
    }
}

/* What the blocks of a table put on a node. */
#define SUM_KERNEL(dim, vector)                                                                              \
    KERNEL_INLINE void add_blocks_##dim(const struct pairs *pairs, int64_t node, vector *sum)                \
    {                                                                                                        \
        for (int64_t i = pairs->sum_ptr[node]; i < pairs->sum_ptr[node + 1]; i++) {                          \
            vector part;                                                                                     \
            LOAD(part, pairs->block_force + (int64_t)pairs->sum[i] * PAIRS_STRIDE(dim));                     \
            *sum += part;                                                                                    \
        }                                                                                                    \
    }                                                                                                        \
    KERNEL_INLINE void sum_nodes_##dim(const struct body *body, int64_t first, int64_t last, double *force)  \
    {                                                                                                        \
        bool tied = body->compatibility != NULL && body->compatibility->active;                              \
        const struct pairs *pairs = body->conforming ? &body->cells.faces.pairs : &body->gradients;          \
        for (int64_t n = first; n < last; n++) {                                                             \
            vector sum = {0.0};                                                                              \
            add_blocks_##dim(pairs, n, &sum);                                                                \
            if (tied) {                                                                                      \
                add_blocks_##dim(&body->compatibility->nodes.pairs, n, &sum);                                \
            }                                                                                                \
            for (int a = 0; a < dim; a++) {                                                                  \
                force[body->node_order[n] * dim + a] = sum[a];                                               \
            }                                                                                                \
        }                                                                                                    \
    }
SUM_KERNEL(2, pair2)
SUM_KERNEL(3, quad4)

#endif
