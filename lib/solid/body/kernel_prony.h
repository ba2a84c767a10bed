/* Kernel of what viscoelastic cells and points have in their histories (prony.h); private to lib/solid. */
#pragma once

#include "solid/body/kernel_variance.h"

/* In the cells at i and q: add the derivatives of (10), but for its bulk modulus, to X, and F^T s_e to x. */
KERNEL_INLINE void add_variance_state(const struct body *body, int64_t q, int64_t i, int dim,
                                      const block_edges edges, const block_vertices vertices, prony_rows X,
                                      prony_rows x)
{
    struct variance v;
    lanes shear, S[9];
    LOAD(shear, body->cells.variance_shear + q);
    vary_cells(body, q, i, dim, edges, vertices, EDGE_OFFSET * EDGE_OFFSET * shear, (lanes){0.0}, &v);
    variance_stress(dim, &v, S);
    for (int c = 0; c < PRONY_RATIO; c++) {
        lanes stress;
        LOAD(stress, X[c] + i);
        if (tensor_row[c] < dim && tensor_column[c] < dim) {
            stress += S[tensor_row[c] * dim + tensor_column[c]];
        }
        STORE(X[c] + i, stress);
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        lanes turned[3], stress[3];
        lanes_apply(dim, true, v.F, v.offset[e], turned);
        lanes_apply(dim, false, v.Z, v.along[e], stress);
        for (int b = 0; b < dim; b++) {
            STORE(x[PRONY_OFFSETS + e * dim + b] + i, turned[b]);
            STORE(X[PRONY_OFFSETS + e * dim + b] + i, stress[b]);
        }
    }
}

/* X and the strains x of a block at the last evaluation. */
KERNEL_INLINE void kernel_prony_state(const struct body *body, const struct block *block, int dim,
                                      prony_rows X, prony_rows x)
{
    block_edges edges;
    block_vertices vertices;
    if (body->smoothed) {
        read_cells(body, block, dim, edges, vertices);
    }
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        int64_t q = block->first_point + i;
        lanes F[9], C[9], J, value;
        load_matrix(body->F + q, body->point_count, dim, F);
        for (int c = 0; c < PRONY_OFFSETS; c++) {
            LOAD(value, body->prony.stress + c * body->point_count + q);
            STORE(X[c] + i, value);
        }
        for (int c = 0; c < PRONY_RATIO; c++) {
            value = (lanes){0.0} - (tensor_row[c] == tensor_column[c] ? 1.0 : 0.0);
            for (int a = 0; a < dim && tensor_row[c] < dim && tensor_column[c] < dim; a++) {
                value += F[a * dim + tensor_row[c]] * F[a * dim + tensor_column[c]];
            }
            value *= c == 2 && dim == 2 ? 0.0 : 0.5;
            STORE(x[c] + i, value);
        }
        LOAD(value, body->J + q);
        lanes_cofactor(F, dim, C);
        lanes_determinant(F, C, dim, &J);
        value /= J;
        STORE(x[PRONY_RATIO] + i, value);
        if (body->smoothed) {
            add_variance_state(body, q, i, dim, (const double(*)[BLOCK_MOST_POINTS])edges,
                               (const double(*)[BLOCK_MOST_POINTS])vertices, X, x);
        }
    }
}
