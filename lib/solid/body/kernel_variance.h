/* Kernels of what varies within smoothed cells, equation (10) of lib/README.md; private to lib/solid. */
#pragma once

#include "solid/body/kernel_points.h"

/* Values in a block's cells: component a of edge or vertex k in row k dim + a, one column for each cell. */
typedef double block_vertices[12][BLOCK_MOST_POINTS];
typedef double block_edges[18][BLOCK_MOST_POINTS];

/* Read `each` uses of each cell, the first of the body's is `first`. */
KERNEL_INLINE void read_uses(const struct field_averages *averages, int64_t first, int each,
                             const struct block *block, int dim, double (*values)[BLOCK_MOST_POINTS])
{
    const int32_t *of_use = averages->of_use + first + block->first_point * each;
    for (int64_t i = 0; i < block->point_count; i++) {
        for (int k = 0; k < each; k++, of_use++) {
            for (int a = 0; a < dim; a++) {
                values[k * dim + a][i] = averages->value[*of_use + a];
            }
        }
    }
}

KERNEL_INLINE void read_cells(const struct body *body, const struct block *block, int dim, block_edges edges,
                              block_vertices vertices)
{
    const struct field_averages *averages = &body->cells.averages;
    read_uses(averages, 0, CELL_EDGES(dim), block, dim, edges);
    read_uses(averages, field_averages_vertices(averages, dim), dim + 1, block, dim, vertices);
}

/* Gradients of the linear shape functions N_0 .. N_dim in the cells from q on, each in a row of 3. */
KERNEL_INLINE void load_linear_gradients(const struct body *body, int64_t q, int dim, lanes grad_N[12])
{
    lanes rest[9];
    load_matrix(body->cells.linear_gradient + q, body->point_count, dim, rest);
    for (int b = 0; b < dim; b++) {
        grad_N[b] = (lanes){0.0};
        for (int k = 1; k <= dim; k++) {
            grad_N[3 * k + b] = rest[(k - 1) * dim + b];
            grad_N[b] -= rest[(k - 1) * dim + b];
        }
    }
}

/* V times factor, where sum_k |R_k - R|^2 = s . V s with the offsets s_e of one component of the field. With
 * h_e = grad N_i + grad N_j, e from i to j, V_ef is -h_e . h_f / (dim + 1), and more for each vertex that e
 * and f share: the product of the gradients of N at their other ends. */
KERNEL_INLINE void variance_matrix(int dim, const lanes grad_N[12], const lanes *factor, lanes V[6][6])
{
    lanes product[4][4];
    for (int k = 0; k <= dim; k++) {
        for (int l = 0; l <= k; l++) {
            product[k][l] = grad_N[3 * k] * grad_N[3 * l];
            for (int b = 1; b < dim; b++) {
                product[k][l] += grad_N[3 * k + b] * grad_N[3 * l + b];
            }
            product[k][l] *= *factor;
            product[l][k] = product[k][l];
        }
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        for (int f = 0; f <= e; f++) {
            lanes with_end[2], sum;
            for (int i = 0; i < 2; i++) {
                int k = cell_edge_ends[e][i];
                with_end[i] = product[k][cell_edge_ends[f][0]] + product[k][cell_edge_ends[f][1]];
            }
            sum = (-1.0 / (dim + 1)) * (with_end[0] + with_end[1]);
            for (int i = 0; i < 4; i++) {
                if (cell_edge_ends[e][i / 2] == cell_edge_ends[f][i % 2]) {
                    sum += product[cell_edge_ends[e][1 - i / 2]][cell_edge_ends[f][1 - i % 2]];
                }
            }
            V[e][f] = V[f][e] = sum;
        }
    }
}

/* The factors of viscoelastic cells from q on. */
KERNEL_INLINE void load_factors(const struct body *body, int64_t q, lanes *factor)
{
    const struct prony_step *steps = prony_steps(body);
    for (int i = 0; i < LANES; i++) {
        (*factor)[i] = steps[body->material[q + i]].factor;
    }
}

/* V in the cells from q on, times what makes s . V s / 2 the energy of s_e = m_e - (v_i + v_j) / 2. */
KERNEL_INLINE void load_variance_matrix(const struct body *body, int64_t q, int dim, const lanes grad_N[12],
                                        bool relaxes, lanes V[6][6])
{
    lanes modulus, shear, bulk;
    load_moduli(body, q, &shear, &bulk);
    LOAD(modulus, body->cells.variance_weight + q);
    modulus *= EDGE_OFFSET * EDGE_OFFSET * VARIANCE_FACTOR(dim) * shear;
    if (relaxes) {
        load_factors(body, q, &shear);
        modulus *= shear;
    }
    variance_matrix(dim, grad_N, &modulus, V);
}

/* The s_e of component a in the cells at i. */
KERNEL_INLINE void load_offsets(const block_edges edges, const block_vertices vertices, int64_t i, int dim,
                                int a, lanes offset[6])
{
    lanes value[4];
    for (int k = 0; k <= dim; k++) {
        LOAD(value[k], vertices[k * dim + a] + i);
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        LOAD(offset[e], edges[e * dim + a] + i);
        offset[e] -= 0.5 * (value[cell_edge_ends[e][0]] + value[cell_edge_ends[e][1]]);
    }
}

/* Add the forces of component a of the energy s . V s / 2 and, of viscoelastic cells, of s_e . F rest_e
 * (prony.h);
 */
KERNEL_INLINE void add_variance_forces(const struct body *body, int64_t q, const block_edges edges,
                                       const block_vertices vertices, int64_t i, int dim, int a, bool relaxes,
                                       lanes V[6][6], lanes on_edge[6], lanes on_vertex[4])
{
    lanes offset[6], F[3], rest;
    load_offsets(edges, vertices, i, dim, a, offset);
    for (int b = 0; b < dim && relaxes; b++) {
        LOAD(F[b], body->F + (a * dim + b) * body->point_count + q);
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        lanes force = V[e][0] * offset[0];
        for (int f = 1; f < CELL_EDGES(dim); f++) {
            force += V[e][f] * offset[f];
        }
        for (int b = 0; b < dim && relaxes; b++) {
            LOAD(rest, body->prony.rest + (PRONY_OFFSETS + e * dim + b) * body->point_count + q);
            force += F[b] * rest;
        }
        on_edge[e] += force;
        force *= 0.5;
        on_vertex[cell_edge_ends[e][0]] -= force;
        on_vertex[cell_edge_ends[e][1]] -= force;
    }
}

/* and the stress of the latter on F, in the cells at i and q. */
KERNEL_INLINE void add_rest_stresses(const struct body *body, int64_t q, int64_t i, int dim,
                                     const block_edges edges, const block_vertices vertices, block_rows P)
{
    const double *rest = body->prony.rest + PRONY_OFFSETS * body->point_count + q;
    for (int a = 0; a < dim; a++) {
        lanes offset[6];
        load_offsets(edges, vertices, i, dim, a, offset);
        for (int b = 0; b < dim; b++) {
            lanes stress, of_edge;
            LOAD(stress, P[a * dim + b] + i);
            for (int e = 0; e < CELL_EDGES(dim); e++) {
                LOAD(of_edge, rest + (e * dim + b) * body->point_count);
                stress += offset[e] * of_edge;
            }
            STORE(P[a * dim + b] + i, stress);
        }
    }
}
