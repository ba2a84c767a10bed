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

/* The factors of viscoelastic cells from q on. */
KERNEL_INLINE void load_factors(const struct body *body, int64_t q, lanes *factor)
{
    const struct prony_step *steps = prony_steps(body);
    for (int i = 0; i < LANES; i++) {
        (*factor)[i] = steps[body->material[q + i]].factor;
    }
}

/* The s_e of each component in the cells at i. */
KERNEL_INLINE void load_offsets(const block_edges edges, const block_vertices vertices, int64_t i, int dim,
                                lanes offset[6][3])
{
    for (int a = 0; a < dim; a++) {
        lanes value[4];
        for (int k = 0; k <= dim; k++) {
            LOAD(value[k], vertices[k * dim + a] + i);
        }
        for (int e = 0; e < CELL_EDGES(dim); e++) {
            LOAD(offset[e][a], edges[e * dim + a] + i);
            offset[e][a] -= 0.5 * (value[cell_edge_ends[e][0]] + value[cell_edge_ends[e][1]]);
        }
    }
}

/* Z = 4 (3 + F^T F)^-1 */
KERNEL_INLINE void limit_stretch(int dim, const lanes F[9], lanes Z[9])
{
    lanes sum[9], cofactors[9], determinant;
    for (int k = 0; k < dim * dim; k++) {
        sum[k] = (lanes){0.0} + (k / dim == k % dim ? 3.0 : 0.0);
        for (int a = 0; a < dim; a++) {
            sum[k] += F[a * dim + k / dim] * F[a * dim + k % dim];
        }
    }
    lanes_cofactor(sum, dim, cofactors);
    lanes_determinant(sum, cofactors, dim, &determinant);
    for (int k = 0; k < dim * dim; k++) {
        Z[k] = 4.0 * cofactors[k] / determinant;
    }
}

/* product = A B */
KERNEL_INLINE void lanes_product(int dim, const lanes A[9], const lanes B[9], lanes product[9])
{
    for (int k = 0; k < dim * dim; k++) {
        product[k] = A[k / dim * dim] * B[k % dim];
        for (int c = 1; c < dim; c++) {
            product[k] += A[k / dim * dim + c] * B[c * dim + k % dim];
        }
    }
}

/* result = A v, or A^T v. */
KERNEL_INLINE void lanes_apply(int dim, bool transposed, const lanes A[9], const lanes v[3], lanes result[3])
{
    for (int a = 0; a < dim; a++) {
        result[a] = A[transposed ? a : a * dim] * v[0];
        for (int b = 1; b < dim; b++) {
            result[a] += A[transposed ? b * dim + a : a * dim + b] * v[b];
        }
    }
}

/* The variance (10) in the cells at i and q. */
struct variance {
    lanes F[9], Z[9], FZ[9], offset[6][3]; /* s_e */
    lanes along[6][3];                     /* y_e: the derivative of W_v by F^T s_e is Z y_e, */
    lanes product[9]; /* Q = sum_k T_k M_k: that by E = (F^T F - 1) / 2 is -(Z Q + Q^T Z) / 2 */
};

/* M_k, not symmetric yet: with the gradients h_l = Z grad N_l and Z F^T s_e. */
KERNEL_INLINE void vary_gradients(int dim, const lanes h[4][3], const struct variance *v, lanes M[4][9])
{
    lanes mean[9], turned[3];
    for (int b = 0; b < dim * dim; b++) {
        M[0][b] = M[1][b] = M[2][b] = M[3][b] = (lanes){0.0};
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int k = cell_edge_ends[e][0], l = cell_edge_ends[e][1];
        lanes_apply(dim, true, v->FZ, v->offset[e], turned);
        for (int b = 0; b < dim * dim; b++) {
            M[k][b] += turned[b / dim] * h[l][b % dim];
            M[l][b] += turned[b / dim] * h[k][b % dim];
        }
    }
    for (int b = 0; b < dim * dim; b++) {
        mean[b] = M[0][b];
        for (int k = 1; k <= dim; k++) {
            mean[b] += M[k][b];
        }
        mean[b] *= 1.0 / (dim + 1);
        for (int k = 0; k <= dim; k++) {
            M[k][b] -= mean[b];
        }
    }
}

/* Families of fibres in the cells from q on: see struct variance_fibres. */
struct lanes_fibres {
    int count;
    lanes share[2], turned[2], direction[2][3];
};

KERNEL_INLINE void load_fibres(const struct body *body, int64_t q, struct lanes_fibres *fibres)
{
    fibres->count = body->cells.fibres != NULL ? 2 : 0;
    for (int i = 0; i < LANES && fibres->count > 0; i++) {
        const struct variance_fibres *own = &body->cells.fibres[body->material[q + i]];
        for (int f = 0; f < fibres->count; f++) {
            fibres->share[f][i] = own->share[f];
            fibres->turned[f][i] = own->turned[f];
            for (int a = 0; a < 3; a++) {
                fibres->direction[f][a][i] = own->direction[f][a];
            }
        }
    }
}

/* Add to M what fibres of direction a have of the stress of a strain e: share d dev a (x) a, d = a . dev e a,
 * and turned (e a (x) a + a (x) e a - 2 (a . e a) a (x) a). */
KERNEL_INLINE void stress_fibre(int dim, lanes share, lanes turned, const lanes a[3], const lanes strain[9],
                                lanes M[9])
{
    lanes ea[3] = {{0.0}}, along = {0.0}, trace = {0.0};
    for (int k = 0; k < dim * dim; k++) {
        ea[k / dim] += strain[k] * a[k % dim];
        trace += k / dim == k % dim ? strain[k] : (lanes){0.0};
    }
    for (int k = 0; k < dim; k++) {
        along += a[k] * ea[k];
    }
    lanes dev = share * (along - trace * (1.0 / 3.0));
    for (int k = 0; k < dim * dim; k++) {
        lanes outer = a[k / dim] * a[k % dim];
        M[k] += (outer - (k / dim == k % dim ? 1.0 / 3.0 : 0.0)) * dev;
        M[k] += turned * (ea[k / dim] * a[k % dim] + a[k / dim] * ea[k % dim] - 2.0 * along * outer);
    }
}

/* M becomes the stress T of the strain sym M; T sym M is added to Q. */
KERNEL_INLINE void stress_vertex(int dim, lanes shear, lanes bulk, const struct lanes_fibres *fibres,
                                 lanes M[9], lanes Q[9])
{
    lanes strain[9], product[9], trace = M[0];
    for (int a = 1; a < dim; a++) {
        trace += M[a * dim + a];
    }
    trace *= bulk - 2.0 / 3.0 * shear;
    for (int k = 0; k < dim * dim; k++) {
        strain[k] = 0.5 * (M[k] + M[k % dim * dim + k / dim]);
    }
    for (int k = 0; k < dim * dim; k++) {
        M[k] = 2.0 * shear * strain[k] + (k / dim == k % dim ? trace : (lanes){0.0});
    }
    for (int f = 0; f < fibres->count; f++) {
        stress_fibre(dim, shear * fibres->share[f], shear * fibres->turned[f], fibres->direction[f], strain,
                     M);
    }
    lanes_product(dim, M, strain, product);
    for (int k = 0; k < dim * dim; k++) {
        Q[k] += product[k];
    }
}

/* With these moduli. */
KERNEL_INLINE void vary_cells(const struct body *body, int64_t q, int64_t i, int dim, const block_edges edges,
                              const block_vertices vertices, lanes shear, lanes bulk, struct variance *v)
{
    struct lanes_fibres fibres;
    lanes grad_N[12], h[4][3], M[4][9], other[3];
    load_matrix(body->F + q, body->point_count, dim, v->F);
    load_offsets(edges, vertices, i, dim, v->offset);
    load_linear_gradients(body, q, dim, grad_N);
    limit_stretch(dim, v->F, v->Z);
    lanes_product(dim, v->F, v->Z, v->FZ);
    for (int k = 0; k <= dim; k++) {
        lanes_apply(dim, false, v->Z, grad_N + 3 * k, h[k]);
    }
    vary_gradients(dim, (const lanes(*)[3])h, v, M);
    load_fibres(body, q, &fibres);
    memset(v->product, 0, sizeof v->product);
    for (int k = 0; k <= dim; k++) {
        stress_vertex(dim, shear, bulk, &fibres, M[k], v->product);
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int k = cell_edge_ends[e][0], l = cell_edge_ends[e][1];
        lanes_apply(dim, false, M[k], h[l], v->along[e]);
        lanes_apply(dim, false, M[l], h[k], other);
        for (int a = 0; a < dim; a++) {
            v->along[e][a] += other[a];
        }
    }
}

/* S, the derivative by E. */
KERNEL_INLINE void variance_stress(int dim, const struct variance *v, lanes S[9])
{
    lanes product[9];
    lanes_product(dim, v->Z, v->product, product);
    for (int k = 0; k < dim * dim; k++) {
        S[k] = -0.5 * (product[k] + product[k % dim * dim + k / dim]);
    }
}

/* What the histories of viscoelastic cells add (prony.h), to the forces on the s_e and the stress on F. */
KERNEL_INLINE void add_rest_forces(const struct body *body, int64_t q, int64_t i, int dim,
                                   const struct variance *v, block_edges at_edges, lanes stress[9])
{
    lanes rest[3], more[3], force;
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        for (int b = 0; b < dim; b++) {
            LOAD(rest[b], body->prony.rest + (PRONY_OFFSETS + e * dim + b) * body->point_count + q);
        }
        lanes_apply(dim, false, v->F, rest, more);
        for (int a = 0; a < dim; a++) {
            LOAD(force, at_edges[e * dim + a] + i);
            force += more[a];
            STORE(at_edges[e * dim + a] + i, force);
            for (int b = 0; b < dim; b++) {
                stress[a * dim + b] += v->offset[e][a] * rest[b];
            }
        }
    }
}

/* The forces of the variance on the s_e, into at_edges, and its stress on F, added to P, in the cells at i
 * and q. */
KERNEL_INLINE void variance_forces(const struct body *body, int64_t q, int64_t i, int dim, bool relaxes,
                                   const block_edges edges, const block_vertices vertices,
                                   block_edges at_edges, block_rows P)
{
    struct variance v;
    lanes shear, bulk, value, force[3], S[9], outer[9] = {{0.0}}, stress[9], turned[9];
    LOAD(shear, body->cells.variance_shear + q);
    LOAD(bulk, body->cells.variance_bulk + q);
    if (relaxes) {
        load_factors(body, q, &value);
        shear *= value;
    }
    vary_cells(body, q, i, dim, edges, vertices, EDGE_OFFSET * EDGE_OFFSET * shear,
               EDGE_OFFSET * EDGE_OFFSET * bulk, &v);
    variance_stress(dim, &v, S);
    lanes_product(dim, v.F, S, stress);
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        lanes_apply(dim, false, v.FZ, v.along[e], force);
        for (int a = 0; a < dim; a++) {
            STORE(at_edges[e * dim + a] + i, force[a]);
            for (int b = 0; b < dim; b++) {
                outer[a * dim + b] += v.offset[e][a] * v.along[e][b];
            }
        }
    }
    if (relaxes) {
        add_rest_forces(body, q, i, dim, &v, at_edges, stress);
    }
    lanes_product(dim, outer, v.Z, turned);
    for (int k = 0; k < dim * dim; k++) {
        LOAD(value, P[k] + i);
        value += stress[k] + turned[k];
        STORE(P[k] + i, value);
    }
}
