/* Kernels over smoothed cells (equations (7) to (12) of lib/README.md): gradients from values on edges and at
 * vertices, the neo-Hookean law, and the forces on these values; private to lib/solid. */
#pragma once

#include "solid/body/kernel_variance.h"
#include "solid/body/merged_cells.h"

/* Add the forces of `each` uses of each cell to the parts of the block; the first of the body's is `first`.
 */
KERNEL_INLINE void add_uses(const struct field_averages *averages, int64_t first, int each,
                            const struct block *block, int dim, const double (*forces)[BLOCK_MOST_POINTS],
                            double *parts)
{
    const uint16_t *part = averages->part_of_use + first + block->first_point * each;
    for (int64_t i = 0; i < block->point_count; i++) {
        for (int k = 0; k < each; k++, part++) {
            for (int a = 0; a < dim; a++) {
                parts[*part * dim + a] += forces[k * dim + a][i];
            }
        }
    }
}

/* Component a of F_h - I and F - I. */
KERNEL_INLINE void cell_gradients(const block_edges edges, const block_vertices vertices, int64_t i, int dim,
                                  int a, const lanes grad_N[12], lanes interpolant[3], lanes mean[3])
{
    lanes origin;
    LOAD(origin, vertices[a] + i);
    for (int b = 0; b < dim; b++) {
        interpolant[b] = mean[b] = (lanes){0.0};
    }
    for (int k = 1; k <= dim; k++) {
        lanes value;
        LOAD(value, vertices[k * dim + a] + i);
        value -= origin;
        for (int b = 0; b < dim; b++) {
            interpolant[b] += value * grad_N[3 * k + b];
        }
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        lanes value;
        LOAD(value, edges[e * dim + a] + i);
        value -= origin;
        for (int b = 0; b < dim; b++) {
            mean[b] += value * (grad_N[3 * cell_edge_ends[e][0] + b] + grad_N[3 * cell_edge_ends[e][1] + b]);
        }
    }
    for (int b = 0; b < dim; b++) {
        mean[b] = EDGE_GRADIENT(dim) * mean[b] + VERTEX_GRADIENT(dim) * interpolant[b];
    }
}

/* The transpose, for the stresses P of the mean and T of the interpolant. */
KERNEL_INLINE void cell_forces(const lanes P[3], const lanes T[3], int dim, const lanes grad_N[12],
                               lanes on_edge[6], lanes on_vertex[4])
{
    lanes mean[4];
    for (int k = 0; k <= dim; k++) {
        on_vertex[k] = T[0] * grad_N[3 * k];
        mean[k] = P[0] * grad_N[3 * k];
        for (int b = 1; b < dim; b++) {
            on_vertex[k] += T[b] * grad_N[3 * k + b];
            mean[k] += P[b] * grad_N[3 * k + b];
        }
    }
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        on_edge[e] = EDGE_GRADIENT(dim) * (mean[cell_edge_ends[e][0]] + mean[cell_edge_ends[e][1]]);
    }
    for (int k = 0; k <= dim && VERTEX_GRADIENT(dim) > 0.0; k++) {
        on_vertex[k] += VERTEX_GRADIENT(dim) * mean[k];
    }
}

/* Rows of a block's cells into an array over all cells. */
KERNEL_INLINE void keep_rows(const struct body *body, const struct block *block, int count,
                             const block_rows from, double *rows)
{
    for (int k = 0; k < count; k++) {
        memcpy(rows + k * body->point_count + block->first_point, from[k],
               (size_t)block->point_count * sizeof *from[k]);
    }
}

/* The mean over a face on the boundary is that of its own row, in place of that of the interpolant: a mean
 * that is larger by d changes F by -dim d (x) grad N_k, k the opposite vertex. change: by how much, of each
 * cell. */
KERNEL_INLINE void change_at_boundary(const struct body *body, const struct block *block, int dim,
                                      const block_edges edges, const block_vertices vertices,
                                      block_rows change)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t last = block->first_point + block->point_count, first = block->boundary_face;
    const int32_t *row = averages->of_use + field_averages_faces(averages, dim);
    memset(change, 0, sizeof(block_rows));
    for (int64_t f = first; f < averages->face_count && averages->face_cell[f] < last; f++) {
        int64_t i = averages->face_cell[f] - block->first_point;
        int k = averages->face_vertex[f];
        const double *grad_N = averages->face_gradient + 3 * f;
        for (int a = 0; a < dim; a++) {
            double difference = -averages->value[row[f] + a];
            for (int e = 0; e < FACE_EDGES(dim); e++) {
                difference += EDGE_IN_FACE(dim) * edges[cell_face_edge(dim, k, e) * dim + a][i];
            }
            for (int v = 0; v <= dim && VERTEX_IN_FACE(dim) > 0.0; v++) {
                difference += v != k ? VERTEX_IN_FACE(dim) * vertices[v * dim + a][i] : 0.0;
            }
            for (int b = 0; b < dim; b++) {
                change[dim * a + b][i] += dim * difference * grad_N[b];
            }
        }
    }
}

/* The transpose: the forces of P on these faces, and on the edges and vertices of the cells there. */
KERNEL_INLINE void forces_at_boundary(const struct body *body, const struct block *block, int dim,
                                      const block_rows P, block_edges at_edges, block_vertices at_vertices,
                                      double *parts)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t last = block->first_point + block->point_count, first = block->boundary_face;
    const uint16_t *part = averages->part_of_use + field_averages_faces(averages, dim);
    for (int64_t f = first; f < averages->face_count && averages->face_cell[f] < last; f++) {
        int64_t i = averages->face_cell[f] - block->first_point;
        int k = averages->face_vertex[f];
        const double *grad_N = averages->face_gradient + 3 * f;
        for (int a = 0; a < dim; a++) {
            double along = 0.0;
            for (int b = 0; b < dim; b++) {
                along += dim * P[dim * a + b][i] * grad_N[b];
            }
            parts[part[f] * dim + a] -= along;
            for (int e = 0; e < FACE_EDGES(dim); e++) {
                at_edges[cell_face_edge(dim, k, e) * dim + a][i] += EDGE_IN_FACE(dim) * along;
            }
            for (int v = 0; v <= dim && VERTEX_IN_FACE(dim) > 0.0; v++) {
                at_vertices[v * dim + a][i] += v != k ? VERTEX_IN_FACE(dim) * along : 0.0;
            }
        }
    }
}

/* F, F_h, and J = det F_h - cof F_h : (F_h - F); the least determinant is that of F. */
KERNEL_INLINE void kernel_cell_gradients(struct body *body, struct block *block, int dim)
{
    block_edges edges;
    block_vertices vertices;
    block_rows F, interpolant, change;
    double determinant[BLOCK_MOST_POINTS], J[BLOCK_MOST_POINTS];
    read_cells(body, block, dim, edges, vertices);
    change_at_boundary(body, block, dim, (const double(*)[BLOCK_MOST_POINTS])edges,
                       (const double(*)[BLOCK_MOST_POINTS])vertices, change);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes grad_N[12], f[9], h[9], C[9], volume;
        load_linear_gradients(body, block->first_point + i, dim, grad_N);
        for (int a = 0; a < dim; a++) {
            cell_gradients((const double(*)[BLOCK_MOST_POINTS])edges,
                           (const double(*)[BLOCK_MOST_POINTS])vertices, i, dim, a, grad_N, h + a * dim,
                           f + a * dim);
        }
        for (int k = 0; k < dim * dim; k++) {
            double unit = k % (dim + 1) == 0 ? 1.0 : 0.0;
            f[k] += unit;
            h[k] += unit;
            lanes more;
            LOAD(more, change[k] + i);
            f[k] += more;
            STORE(F[k] + i, f[k]);
            STORE(interpolant[k] + i, h[k]);
        }
        lanes_cofactor(f, dim, C);
        lanes_determinant(f, C, dim, &volume);
        STORE(determinant + i, volume);
        lanes_cofactor(h, dim, C);
        lanes_determinant(h, C, dim, &volume);
        for (int k = 0; k < dim * dim; k++) {
            volume -= C[k] * (h[k] - f[k]);
        }
        STORE(J + i, volume);
    }
    if (body->cells.group != NULL) {
        merged_cells_gradients(body, block, F, interpolant, determinant, J);
    }
    keep_rows(body, block, dim * dim, (const double(*)[BLOCK_MOST_POINTS])F, body->F);
    keep_rows(body, block, dim * dim, (const double(*)[BLOCK_MOST_POINTS])interpolant,
              body->cells.interpolant);
    memcpy(body->J + block->first_point, J, (size_t)block->point_count * sizeof *J);
    note_least(block, determinant);
}

/* d cof F_h along D: T : dF_h is by how much cof F_h : D changes. */
KERNEL_INLINE void cofactor_along(const lanes H[9], const lanes D[9], int dim, lanes T[9])
{
    if (dim == 2) {
        lanes_cofactor(D, dim, T);
        return;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int r = 3 * ((i + 1) % 3), s = 3 * ((i + 2) % 3), k = (j + 1) % 3, l = (j + 2) % 3;
            T[3 * i + j] =
                H[r + k] * D[s + l] + D[r + k] * H[s + l] - H[r + l] * D[s + k] - D[r + l] * H[s + k];
        }
    }
}

/* From W_iso to W_iso + c g of (11b), a cell's volume ratio being `volume`: change its stress, and the
 * pressure along the cofactor of F_h. shear: mu, weighted as these. */
KERNEL_INLINE void couple_volumes(const lanes *J, const lanes *volume, const lanes *shear,
                                  struct lanes_isochoric *isochoric, lanes *pressure)
{
    lanes apart = *volume / *J - 1.0, I1 = 3.0 + 2.0 * isochoric->energy / *shear, part;
    for (int l = 0; l < LANES; l++) {
        part[l] = 1.0 / sqrt(1.0 + COUPLING_CURVE * apart[l] * apart[l]);
    }
    lanes c = COUPLING_OF_ENERGY * isochoric->energy + *shear * (1.0 - 3.0 / I1);
    lanes kept = 1.0 - apart * part * (COUPLING_OF_ENERGY + 6.0 / (I1 * I1));
    c *= part * part * part / *J;
    isochoric->along_gradient *= kept;
    isochoric->along_cofactor = kept * isochoric->along_cofactor + c * (apart + 1.0);
    *pressure -= c;
}

/* Viscoelastic cells, at i and q: put S of a stress a F + b C, and by_ratio. They become what has relaxed of
 * them, and `added` F times the rest. */
KERNEL_INLINE void relax(const struct body *body, int64_t q, int64_t i, int dim, const lanes F[9],
                         const lanes C[9], const lanes *inverse, struct lanes_isochoric *isochoric,
                         lanes *by_ratio, lanes added[9], block_rows stress)
{
    lanes factor, rest[PRONY_OFFSETS], along = isochoric->along_cofactor * *inverse;
    for (int c = 0; c < PRONY_RATIO; c++) {
        int k = tensor_row[c], l = tensor_column[c];
        lanes S = {0.0};
        for (int m = 0; m < dim && k < dim && l < dim; m++) {
            S += C[m * dim + k] * C[m * dim + l];
        }
        S = c == 2 && dim == 2 ? 1.0 / (*inverse * *inverse) : S;
        S = along * S + (k == l ? 1.0 : 0.0) * isochoric->along_gradient;
        STORE(stress[c] + i, S);
    }
    STORE(stress[PRONY_RATIO] + i, *by_ratio);
    for (int c = 0; c < PRONY_OFFSETS; c++) {
        LOAD(rest[c], body->prony.rest + c * body->point_count + q);
    }
    load_factors(body, q, &factor);
    isochoric->along_gradient *= factor;
    isochoric->along_cofactor *= factor;
    *by_ratio = factor * *by_ratio + rest[PRONY_RATIO];
    for (int k = 0; k < dim * dim; k++) {
        added[k] = F[k / dim * dim] * rest[tensor_component[0][k % dim]];
        for (int m = 1; m < dim; m++) {
            added[k] += F[k / dim * dim + m] * rest[tensor_component[m][k % dim]];
        }
    }
}

/* dE/dF in P and dE/dF_h in T of w (W_iso(F) + c g + p J), p constant: see smoothed_cells.h. */
KERNEL_INLINE void kernel_cell_neo_hookean(const struct body *body, const struct block *block, int dim,
                                           bool relaxes, block_rows P, block_rows T)
{
    double weighted_pressure[BLOCK_MOST_POINTS];
    block_rows S;
    kernel_pressures(body, block, body->J + block->first_point, dim, weighted_pressure);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes F[9], H[9], D[9], C[9], added[9] = {{0.0}}, J, volume, weight, shear, bulk, pressure;
        struct lanes_isochoric isochoric;
        int64_t q = block->first_point + i;
        load_matrix(body->F + q, body->point_count, dim, F);
        LOAD(volume, body->J + q);
        load_matrix(body->cells.interpolant + q, body->point_count, dim, H);
        LOAD(weight, body->weight + q);
        load_moduli(body, q, &shear, &bulk);
        LOAD(pressure, weighted_pressure + i);
        shear *= weight;
        lanes_cofactor(F, dim, C);
        lanes_determinant(F, C, dim, &J);
        neo_hookean_isochoric(F, &J, &shear, dim, &isochoric);
        lanes elastic = pressure;
        couple_volumes(&J, &volume, &shear, &isochoric, &pressure);
        if (relaxes) {
            lanes inverse = 1.0 / J, ratio = volume * inverse * inverse, by_ratio = (pressure - elastic) * J;
            isochoric.along_cofactor += by_ratio * ratio;
            relax(body, q, i, dim, F, C, &inverse, &isochoric, &by_ratio, added, S);
            isochoric.along_cofactor -= by_ratio * ratio;
            pressure = elastic + by_ratio * inverse;
        }
        for (int k = 0; k < dim * dim; k++) {
            D[k] = H[k] - F[k];
            F[k] = isochoric.along_gradient * F[k] + isochoric.along_cofactor * C[k];
            if (relaxes) {
                F[k] += added[k];
            }
        }
        lanes_cofactor(H, dim, C);
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = F[k] + pressure * C[k];
            STORE(P[k] + i, stress);
        }
        cofactor_along(H, D, dim, C);
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = -pressure * C[k];
            STORE(T[k] + i, stress);
        }
    }
    if (relaxes) {
        keep_rows(body, block, PRONY_OFFSETS, (const double(*)[BLOCK_MOST_POINTS])S, body->prony.stress);
    }
}

/* The forces of the cells of a block on their rows: of the stresses P and T, and of the variance. */
KERNEL_INLINE void kernel_cell_forces(struct body *body, int64_t number, int dim, bool relaxes, block_rows P,
                                      block_rows T)
{
    enum { MOST_USES = 14 }; /* of a cell: edges, vertices and faces */
    const struct field_averages *averages = &body->cells.averages;
    const struct block *block = &body->blocks[number];
    int64_t first_part = averages->part_first[number];
    size_t size = (size_t)((averages->part_first[number + 1] - first_part) * dim) * sizeof(double);
    double parts[MOST_USES * BLOCK_MOST_POINTS * 3];
    block_edges edges, at_edges;
    block_vertices vertices, at_vertices;
    read_cells(body, block, dim, edges, vertices);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        variance_forces(body, block->first_point + i, i, dim, relaxes,
                        (const double(*)[BLOCK_MOST_POINTS])edges,
                        (const double(*)[BLOCK_MOST_POINTS])vertices, at_edges, P);
    }
    if (body->cells.group != NULL) {
        merged_cells_stresses(body, block, P, T);
    }
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes grad_N[12], mean[3], interpolant[3], on_edge[6], on_vertex[4], force;
        load_linear_gradients(body, block->first_point + i, dim, grad_N);
        for (int a = 0; a < dim; a++) {
            for (int b = 0; b < dim; b++) {
                LOAD(mean[b], P[a * dim + b] + i);
                LOAD(interpolant[b], T[a * dim + b] + i);
            }
            cell_forces(mean, interpolant, dim, grad_N, on_edge, on_vertex);
            for (int e = 0; e < CELL_EDGES(dim); e++) {
                LOAD(force, at_edges[e * dim + a] + i);
                on_edge[e] += force;
                on_vertex[cell_edge_ends[e][0]] -= 0.5 * force;
                on_vertex[cell_edge_ends[e][1]] -= 0.5 * force;
                STORE(at_edges[e * dim + a] + i, on_edge[e]);
            }
            for (int k = 0; k <= dim; k++) {
                STORE(at_vertices[k * dim + a] + i, on_vertex[k]);
            }
        }
    }
    memset(parts, 0, size);
    forces_at_boundary(body, block, dim, (const double(*)[BLOCK_MOST_POINTS])P, at_edges, at_vertices, parts);
    add_uses(averages, 0, CELL_EDGES(dim), block, dim, (const double(*)[BLOCK_MOST_POINTS])at_edges, parts);
    add_uses(averages, field_averages_vertices(averages, dim), dim + 1, block, dim,
             (const double(*)[BLOCK_MOST_POINTS])at_vertices, parts);
    memcpy(averages->part_force + first_part * dim, parts, size);
}
