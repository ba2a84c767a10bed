/* Kernels over smoothed cells (equations (7) to (12) of lib/README.md): gradients from face averages and node
 * values, the neo-Hookean law, and the forces on these averages and values; private to lib/solid. */
#pragma once

#include "solid/body/kernel_points.h"
#include "solid/body/merged_cells.h"

/* Values at the corners of a block's cells, of faces or of nodes: component a of corner k in row k dim + a,
 * one column for each cell. read_corners sums over the rows of each corner, which begin in of_corner at
 * `first`. */
typedef double block_corners[12][BLOCK_MOST_POINTS];

KERNEL_INLINE void read_corners(const struct field_averages *averages, int64_t first, int rows,
                                const struct block *block, int dim, block_corners corners)
{
    const int32_t *of_corner = averages->of_corner + first + block->first_point * (dim + 1) * rows;
    for (int64_t i = 0; i < block->point_count; i++) {
        for (int k = 0; k <= dim; k++, of_corner += rows) {
            for (int a = 0; a < dim; a++) {
                double sum = 0.0;
                for (int j = 0; j < rows; j++) {
                    sum += averages->value[of_corner[j] + a];
                }
                corners[k * dim + a][i] = sum;
            }
        }
    }
}

KERNEL_INLINE void write_corners(struct field_averages *averages, int64_t first, const struct block *block,
                                 int dim, const block_corners corners)
{
    int64_t corner = first + block->first_point * (dim + 1);
    for (int64_t i = 0; i < block->point_count; i++) {
        for (int k = 0; k <= dim; k++, corner++) {
            for (int a = 0; a < dim; a++) {
                averages->corner_force[corner * VECTOR_STRIDE(dim) + a] = corners[k * dim + a][i];
            }
        }
    }
}

/* Gradients of the linear shape functions N_1 .. N_dim in the cells from q on. */
KERNEL_INLINE void load_linear_gradients(const struct body *body, int64_t q, int dim, lanes grad_N[9])
{
    load_matrix(body->cells.linear_gradient + q, body->point_count, dim, grad_N);
}

/* gradient = sum_k v_k (x) grad N_k for corner values v of the cells i .. of a block. */
KERNEL_INLINE void corner_gradient(const block_corners v, int64_t i, int dim, const lanes grad_N[9],
                                   lanes gradient[9])
{
    for (int a = 0; a < dim; a++) {
        lanes origin;
        LOAD(origin, v[a] + i);
        for (int b = 0; b < dim; b++) {
            gradient[a * dim + b] = (lanes){0.0};
        }
        for (int k = 1; k <= dim; k++) {
            lanes value;
            LOAD(value, v[k * dim + a] + i);
            value -= origin;
            for (int b = 0; b < dim; b++) {
                gradient[a * dim + b] += value * grad_N[(k - 1) * dim + b];
            }
        }
    }
}

/* The transpose: v_k = scale P grad N_k. */
KERNEL_INLINE void corner_forces(const lanes P[9], int64_t i, int dim, const lanes grad_N[9], double scale,
                                 block_corners v)
{
    for (int a = 0; a < dim; a++) {
        lanes all = {0.0};
        for (int k = 1; k <= dim; k++) {
            lanes sum = P[a * dim] * grad_N[(k - 1) * dim];
            for (int b = 1; b < dim; b++) {
                sum += P[a * dim + b] * grad_N[(k - 1) * dim + b];
            }
            sum *= scale;
            all -= sum;
            STORE(v[k * dim + a] + i, sum);
        }
        STORE(v[a] + i, all);
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

/* F = I - dim sum_k m_k (x) grad N_k, F_h = I + sum_k v_k (x) grad N_k, J = det F_h - cof F_h : (F_h - F);
 * the least determinant is that of F. */
KERNEL_INLINE void kernel_cell_gradients(struct body *body, struct block *block, int dim)
{
    const struct field_averages *averages = &body->cells.averages;
    block_corners mean, value;
    block_rows F, interpolant;
    double determinant[BLOCK_MOST_POINTS], J[BLOCK_MOST_POINTS];
    const double face_factor = (double)dim / FACE_ROWS(dim);
    read_corners(averages, 0, FACE_ROWS(dim), block, dim, mean);
    read_corners(averages, averages->corner_count * FACE_ROWS(dim), 1, block, dim, value);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes grad_N[9], f[9], h[9], C[9], volume;
        load_linear_gradients(body, block->first_point + i, dim, grad_N);
        corner_gradient((const double(*)[BLOCK_MOST_POINTS])mean, i, dim, grad_N, f);
        corner_gradient((const double(*)[BLOCK_MOST_POINTS])value, i, dim, grad_N, h);
        for (int k = 0; k < dim * dim; k++) {
            double unit = k % (dim + 1) == 0 ? 1.0 : 0.0;
            f[k] = unit - face_factor * f[k];
            h[k] += unit;
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

/* dE/dF in P and dE/dF_h in T of w (W_iso(F) + p J + k |F_h - F|^2 / 2), p held: see smoothed_cells.h. */
KERNEL_INLINE void kernel_cell_neo_hookean(const struct body *body, const struct block *block, int dim,
                                           block_rows P, block_rows T)
{
    double weighted_pressure[BLOCK_MOST_POINTS];
    kernel_pressures(body, block, body->J + block->first_point, dim, weighted_pressure);
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes F[9], H[9], D[9], C[9], J, weight, shear, bulk, pressure, stiffness;
        struct lanes_isochoric isochoric;
        int64_t q = block->first_point + i;
        load_matrix(body->F + q, body->point_count, dim, F);
        load_matrix(body->cells.interpolant + q, body->point_count, dim, H);
        LOAD(weight, body->weight + q);
        load_moduli(body, q, &shear, &bulk);
        LOAD(pressure, weighted_pressure + i);
        shear *= weight;
        stiffness = SMOOTHING_STIFFNESS(dim) * shear;
        lanes_cofactor(F, dim, C);
        lanes_determinant(F, C, dim, &J);
        neo_hookean_isochoric(F, &J, &shear, dim, &isochoric);
        for (int k = 0; k < dim * dim; k++) {
            D[k] = H[k] - F[k];
            F[k] = isochoric.along_gradient * F[k] + isochoric.along_cofactor * C[k] - stiffness * D[k];
        }
        lanes_cofactor(H, dim, C);
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = F[k] + pressure * C[k];
            STORE(P[k] + i, stress);
        }
        cofactor_along(H, D, dim, C);
        for (int k = 0; k < dim * dim; k++) {
            lanes stress = stiffness * D[k] - pressure * C[k];
            STORE(T[k] + i, stress);
        }
    }
}

/* Forces of the corners on each row of the face averages, -dim / FACE_ROWS(dim) P grad N_k, and on the node
 * values, T grad N_k. */
KERNEL_INLINE void kernel_cell_forces(struct body *body, const struct block *block, int dim,
                                      const block_rows P, const block_rows T)
{
    struct field_averages *averages = &body->cells.averages;
    block_corners at_faces, at_nodes;
    for (int64_t i = 0; i < block->point_count; i += LANES) {
        lanes grad_N[9], stress[9];
        load_linear_gradients(body, block->first_point + i, dim, grad_N);
        for (int k = 0; k < dim * dim; k++) {
            LOAD(stress[k], P[k] + i);
        }
        corner_forces(stress, i, dim, grad_N, -(double)dim / FACE_ROWS(dim), at_faces);
        for (int k = 0; k < dim * dim; k++) {
            LOAD(stress[k], T[k] + i);
        }
        corner_forces(stress, i, dim, grad_N, 1.0, at_nodes);
    }
    write_corners(averages, 0, block, dim, (const double(*)[BLOCK_MOST_POINTS])at_faces);
    write_corners(averages, averages->corner_count, block, dim, (const double(*)[BLOCK_MOST_POINTS])at_nodes);
}
