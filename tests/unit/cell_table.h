/* Shape functions in smoothed cells and their mean gradients, from averages over faces, one cell after the
 * other as the divergence theorem has it: what tests compare with. The average over a face on the boundary is
 * its row; over one between cells, Simpson's rule in 2D and the mean of the midpoints of its edges in 3D. */
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

/* Tables of shape functions: on edges and boundary faces, and at the nodes. */
struct cell_sources {
    const struct neighbours *edges, *nodes;
    const double *edge_phi, *node_phi;
};

/* sum[4 * node] += share times each value of a row, and that times area after it. */
static inline void cell_table_add(const struct neighbours *lists, const double *phi, int64_t row,
                                  double share, double part, const double area[3], double *sum, char *seen)
{
    for (int64_t i = lists->ptr[row]; i < lists->ptr[row + 1]; i++) {
        double *of_node = sum + 4 * (int64_t)lists->idx[i];
        seen[lists->idx[i]] = 1;
        of_node[0] += share * part * phi[i];
        for (int a = 0; a < 3; a++) {
            of_node[1 + a] += share * area[a] * phi[i];
        }
    }
}

static inline struct cell_table cell_table_make(const struct cells *cells, const struct faces *faces,
                                                const struct cell_sources *sources)
{
    int dim = cells->dim;
    int64_t nodes = cells->node_count, count = 0;
    size_t most = (size_t)((sources->edges->ptr[sources->edges->count] + sources->nodes->ptr[nodes]) * 6);
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
        for (int k = 0; k <= dim; k++) {
            int64_t s = side[c * (dim + 1) + k], f = s / 2;
            double area[3] = {0.0, 0.0, 0.0}, part = 1.0 / (dim + 1);
            face_area_vector(dim, cells->x, faces->node + f * dim, area);
            for (int a = 0; a < dim; a++) {
                area[a] *= (s % 2 == 0 ? 1.0 : -1.0) / cell_volume(cells, c);
            }
            if (f < faces->boundary_count) {
                cell_table_add(sources->edges, sources->edge_phi, faces->edge_count + f, 1.0, part, area, sum,
                               seen);
                continue;
            }
            for (int e = 0; e < FACE_EDGES(dim); e++) {
                cell_table_add(sources->edges, sources->edge_phi, face_edge(faces, f, e),
                               dim == 2 ? 2.0 / 3.0 : 1.0 / 3.0, part, area, sum, seen);
            }
            for (int n = 0; n < dim && dim == 2; n++) {
                cell_table_add(sources->nodes, sources->node_phi, faces->node[f * dim + n], 1.0 / 6.0, part,
                               area, sum, seen);
            }
        }
        for (int32_t n = 0; n < nodes; n++) {
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
