/* Shape functions in smoothed cells and their mean gradients, from averages over faces, one cell after the
 * other as the divergence theorem has it: what tests compare with. */
#pragma once

#include "unit.h"

#include "approx/cells/face_edges.h"
#include "approx/shape/shape.h"

struct cell_table {
    int64_t *ptr;
    int32_t *idx; /* ascending */
    double *phi;  /* mean over the faces */
    double *dphi; /* (1/V) sum over faces of outward normal times average */
};

static inline struct cell_table cell_table_make(const struct cells *cells, const struct faces *faces,
                                                const struct neighbours *averages, const double *phi)
{
    int dim = cells->dim;
    int64_t nodes = cells->node_count, count = 0;
    size_t most = (size_t)(averages->ptr[averages->count] * 6);
    struct cell_table table = {calloc((size_t)cells->count + 1, sizeof(int64_t)),
                               calloc(most, sizeof(int32_t)), calloc(most, sizeof(double)),
                               calloc(most * (size_t)dim, sizeof(double))};
    SCRATCH double *sum = calloc((size_t)nodes * 4, sizeof *sum);
    SCRATCH char *seen = calloc((size_t)nodes, 1), *filled = calloc((size_t)cells->count, 1);
    SCRATCH int64_t *side = calloc((size_t)(cells->count * (dim + 1)), sizeof *side);
    for (int64_t s = 0; s < 2 * faces->count; s++) {
        if (faces->cell[s] >= 0) {
            side[faces->cell[s] * (dim + 1) + filled[faces->cell[s]]++] = s;
        }
    }
    for (int64_t c = 0; c < cells->count; c++) {
        int32_t low = (int32_t)nodes, high = 0;
        for (int k = 0; k <= dim; k++) {
            int64_t s = side[c * (dim + 1) + k];
            double area[3] = {0.0, 0.0, 0.0}, sign = s % 2 == 0 ? 1.0 : -1.0, volume = cell_volume(cells, c);
            face_area_vector(dim, cells->x, faces->node + s / 2 * dim, area);
            bool own = dim == 3 && s / 2 < faces->boundary_count;
            int rows = own ? 1 : FACE_EDGES(dim);
            for (int r = 0; r < rows; r++) {
                int64_t row = own ? faces->edge_count + s / 2 : face_edge(faces, s / 2, r);
                for (int64_t i = averages->ptr[row]; i < averages->ptr[row + 1]; i++) {
                    double *of_node = sum + 4 * (int64_t)averages->idx[i];
                    double share = phi[i] / rows;
                    seen[averages->idx[i]] = 1;
                    low = averages->idx[i] < low ? averages->idx[i] : low;
                    high = averages->idx[i] > high ? averages->idx[i] : high;
                    of_node[0] += share / (dim + 1);
                    for (int a = 0; a < dim; a++) {
                        of_node[1 + a] += sign * area[a] / volume * share;
                    }
                }
            }
        }
        for (int32_t n = low; n <= high; n++) {
            if (seen[n]) {
                table.idx[count] = n;
                table.phi[count] = sum[4 * n];
                for (int a = 0; a < dim; a++) {
                    table.dphi[count * dim + a] = sum[4 * n + 1 + a];
                }
                for (int k = 0; k < 4; k++) {
                    sum[4 * n + k] = 0.0;
                }
                seen[n] = 0;
                count++;
            }
        }
        table.ptr[c + 1] = count;
    }
    return table;
}

static inline void cell_table_free(struct cell_table *table)
{
    free(table->ptr);
    free(table->idx);
    free(table->phi);
    free(table->dphi);
    *table = (struct cell_table){0};
}
