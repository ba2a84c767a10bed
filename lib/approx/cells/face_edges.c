#include "approx/cells/face_edges.h"

#include "approx/cells/quadrature.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

enum status face_edges_number(int64_t node_count, struct faces *faces, struct error *error)
{
    SCRATCH int32_t *last = NULL, *before = NULL,
                    *higher = NULL; /* edges by their lower node, latest first */
    faces->edge = NULL;
    faces->edge_count = faces->dim == 2 ? faces->count : 0;
    if (faces->dim == 2) {
        return STATUS_OK;
    }
    if (faces->count > INT32_MAX / 3) {
        return fail(error, STATUS_INPUT, "%lld faces: too many", (long long)faces->count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&last, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&before, faces->count * 3, error));
    RETURN_IF_ERROR(NEW_ARRAY(&higher, faces->count * 3, error));
    RETURN_IF_ERROR(NEW_ARRAY(&faces->edge, faces->count * 3, error));
    for (int64_t i = 0; i < faces->count * 3; i++) {
        const int32_t *node = faces->node + i / 3 * 3;
        int32_t a = node[i % 3], b = node[(i + 1) % 3];
        int32_t low = a < b ? a : b, high = a < b ? b : a, e = last[low] - 1;
        while (e >= 0 && higher[e] != high) {
            e = before[e];
        }
        if (e < 0) {
            e = (int32_t)faces->edge_count++;
            before[e] = last[low] - 1;
            higher[e] = high;
            last[low] = e + 1;
        }
        faces->edge[i] = e;
    }
    return STATUS_OK;
}

enum status face_edges_ends(const struct faces *faces, int32_t *ends, struct error *error)
{
    int dim = faces->dim, edges = FACE_EDGES(dim);
    for (int64_t i = 0; i < faces->edge_count * 2; i++) {
        ends[i] = -1;
    }
    for (int64_t i = 0; i < faces->count * edges; i++) {
        const int32_t *node = faces->node + i / edges * dim;
        int32_t a = node[i % edges], b = node[(i % edges + 1) % dim];
        int32_t *end = ends + face_edge(faces, i / edges, (int)(i % edges)) * 2;
        int32_t low = a < b ? a : b, high = a < b ? b : a;
        if (end[0] >= 0 && (end[0] != low || end[1] != high)) {
            return fail(error, STATUS_INPUT,
                        "faces.edge: row %lld: not the edges of this face: run ipoints again",
                        (long long)(i / edges));
        }
        end[0] = low;
        end[1] = high;
    }
    for (int64_t e = 0; e < faces->edge_count; e++) {
        if (ends[2 * e] < 0) {
            return fail(error, STATUS_INPUT, "faces.edge: edge %lld is of no face: run ipoints again",
                        (long long)e);
        }
    }
    return STATUS_OK;
}

/* Remove repeated cells, and -1 for the outside, from each row; row r ended at ptr[r + 1]. */
static void keep_new_cells(int64_t rows, int64_t *ptr, int32_t *cell)
{
    int64_t kept = 0, from = 0;
    for (int64_t r = 0; r < rows; r++) {
        int64_t first = kept, end = ptr[r + 1];
        ptr[r] = first;
        for (; from < end; from++) {
            bool is_new = cell[from] >= 0;
            for (int64_t i = first; i < kept && is_new; i++) {
                is_new = cell[i] != cell[from];
            }
            if (is_new) {
                cell[kept++] = cell[from];
            }
        }
    }
    ptr[rows] = kept;
}

enum status face_points_cells(const struct faces *faces, int64_t **ptr, int32_t **cell, struct error *error)
{
    const int edges = faces->edge_count > 0 ? FACE_EDGES(faces->dim) : 0, uses = 1 + edges;
    int64_t rows = faces->boundary_count + faces->edge_count;
    SCRATCH int32_t *row = NULL; /* of both cells of a face: the row of the face, then those of its edges */
    *ptr = NULL;
    *cell = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&row, faces->count * 2 * uses, error));
    for (int64_t i = 0; i < faces->count * 2; i++) {
        row[i * uses] = i / 2 < faces->boundary_count ? (int32_t)(i / 2) : -1;
        for (int k = 0; k < edges; k++) {
            row[i * uses + 1 + k] = (int32_t)(faces->boundary_count + face_edge(faces, i / 2, k));
        }
    }
    RETURN_IF_ERROR(lists_by_row(faces->count * 2, uses, row, rows, ptr, cell, error));
    for (int64_t i = 0; i < (*ptr)[rows]; i++) {
        (*cell)[i] = faces->cell[(*cell)[i]];
    }
    keep_new_cells(rows, *ptr, *cell);
    return STATUS_OK;
}

void face_points(const struct faces *faces, const double *nodes, double *x)
{
    int dim = faces->dim, edges = FACE_EDGES(dim);
    const struct quadrature_rule rule = quadrature_face_rule(dim);
    double *midpoint = x + face_boundary_points(faces) * dim;
    for (int64_t f = 0; f < faces->boundary_count; f++) {
        quadrature_positions(&rule, dim, nodes, faces->node + f * dim, x + f * FACE_POINTS(dim) * dim);
    }
    for (int64_t i = 0; faces->edge_count > 0 && i < faces->count * edges; i++) {
        const int32_t *node = faces->node + i / edges * dim;
        const int32_t ends[2] = {node[i % edges], node[(i % edges + 1) % dim]};
        vector_middle(dim, nodes, 2, ends, midpoint + face_edge(faces, i / edges, (int)(i % edges)) * dim);
    }
}
