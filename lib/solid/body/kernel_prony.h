/* Kernel of what viscoelastic cells and points have in their histories (prony.h); private to lib/solid. */
#pragma once

#include "solid/body/kernel_variance.h"

/* In the cells at i and q: add (10) to X, and F^T s_e to x. */
KERNEL_INLINE void add_variance_state(const struct body *body, int64_t q, int64_t i, int dim,
                                      const block_edges edges, const block_vertices vertices,
                                      const lanes F[9], prony_rows X, prony_rows x)
{
    lanes grad_N[12], V[6][6], C[9], J, s[3][6], sigma[3][6], force[3][6];
    lanes_cofactor(F, dim, C);
    lanes_determinant(F, C, dim, &J);
    load_linear_gradients(body, q, dim, grad_N);
    load_variance_matrix(body, q, dim, grad_N, false, V);
    for (int a = 0; a < dim; a++) {
        load_offsets(edges, vertices, i, dim, a, s[a]);
    }
    for (int k = 0; k < CELL_EDGES(dim) * dim; k++) {
        int e = k / dim, b = k % dim;
        lanes strain = F[b] * s[0][e];
        sigma[b][e] = C[b] * s[0][e];
        for (int a = 1; a < dim; a++) {
            strain += F[a * dim + b] * s[a][e];
            sigma[b][e] += C[a * dim + b] * s[a][e];
        }
        sigma[b][e] /= J;
        STORE(x[PRONY_OFFSETS + k] + i, strain);
    }
    for (int k = 0; k < CELL_EDGES(dim) * dim; k++) {
        int e = k / dim, b = k % dim;
        force[b][e] = V[e][0] * sigma[b][0];
        for (int f = 1; f < CELL_EDGES(dim); f++) {
            force[b][e] += V[e][f] * sigma[b][f];
        }
        STORE(X[PRONY_OFFSETS + k] + i, force[b][e]);
    }
    for (int c = 0; c < PRONY_RATIO; c++) {
        lanes stress;
        LOAD(stress, X[c] + i);
        for (int e = 0; e < CELL_EDGES(dim) && tensor_row[c] < dim && tensor_column[c] < dim; e++) {
            stress -= sigma[tensor_row[c]][e] * force[tensor_column[c]][e];
        }
        STORE(X[c] + i, stress);
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
                               (const double(*)[BLOCK_MOST_POINTS])vertices, F, X, x);
        }
    }
}
