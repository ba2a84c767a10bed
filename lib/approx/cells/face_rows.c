#include "approx/cells/face_rows.h"

#include "approx/cells/quadrature.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Number the edges of faces in 3D in the order of their first use: edge[count * 3], each from a node of the
 * face to the next one. */
static enum status number_edges(int64_t node_count, const struct faces *faces, int32_t *edge, int64_t *edges,
                                struct error *error)
{
    SCRATCH int32_t *last = NULL, *before = NULL,
                    *higher = NULL; /* edges by their lower node, latest first */
    *edges = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&last, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&before, faces->count * 3, error));
    RETURN_IF_ERROR(NEW_ARRAY(&higher, faces->count * 3, error));
    for (int64_t i = 0; i < faces->count * 3; i++) {
        const int32_t *node = faces->node + i / 3 * 3;
        int32_t a = node[i % 3], b = node[(i + 1) % 3];
        int32_t low = a < b ? a : b, high = a < b ? b : a, e = last[low] - 1;
        while (e >= 0 && higher[e] != high) {
            e = before[e];
        }
        if (e < 0) {
            e = (int32_t)(*edges)++;
            before[e] = last[low] - 1;
            higher[e] = high;
            last[low] = e + 1;
        }
        edge[i] = e;
    }
    return STATUS_OK;
}

/* outer[node_count]: whether a node belongs to a face on the boundary, or between two sides of an interface.
 */
static void mark_outer(const int32_t *side, const struct faces *faces, bool *outer)
{
    for (int64_t f = 0; f < faces->count; f++) {
        const int32_t *cell = faces->cell + f * 2;
        for (int k = 0; k < 3 && (cell[1] < 0 || (side != NULL && side[cell[0]] != side[cell[1]])); k++) {
            outer[faces->node[f * 3 + k]] = true;
        }
    }
}

enum status face_rows_number(int64_t node_count, const int32_t *side, struct faces *faces,
                             struct error *error)
{
    int64_t edges;
    SCRATCH int32_t *edge = NULL, *row_of = NULL;
    SCRATCH bool *outer = NULL;
    faces->row = NULL;
    faces->own_count = faces->row_count = faces->count;
    if (!faces_may_share(faces)) {
        return STATUS_OK;
    }
    if (faces->count > INT32_MAX / 3) {
        return fail(error, STATUS_INPUT, "%lld faces: too many", (long long)faces->count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&edge, faces->count * 3, error));
    RETURN_IF_ERROR(number_edges(node_count, faces, edge, &edges, error));
    RETURN_IF_ERROR(NEW_ARRAY(&outer, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row_of, edges, error)); /* row + 1; 0: none yet */
    RETURN_IF_ERROR(NEW_ARRAY(&faces->row, faces->count * 3, error));
    mark_outer(side, faces, outer);
    faces->own_count = 0;
    for (int64_t f = 0; f < faces->count; f++) {
        const int32_t *of = faces->node + f * 3;
        bool own = outer[of[0]] || outer[of[1]] || outer[of[2]];
        for (int k = 0; k < 3; k++) {
            faces->row[f * 3 + k] = own ? (int32_t)faces->own_count : -1;
        }
        faces->own_count += own;
    }
    faces->row_count = faces->own_count;
    for (int64_t i = 0; i < faces->count * 3; i++) {
        if (faces->row[i] < 0) {
            if (row_of[edge[i]] == 0) {
                row_of[edge[i]] = (int32_t)++faces->row_count;
            }
            faces->row[i] = row_of[edge[i]] - 1;
        }
    }
    return STATUS_OK;
}

/* row[count * 3]: the rows of the edges of faces in 3D, also for faces that have a row of their own; -1:
 * none. */
static enum status rows_of_edges(int64_t node_count, const struct faces *faces, int32_t *row,
                                 struct error *error)
{
    int64_t edges;
    SCRATCH int32_t *edge = NULL, *row_of = NULL; /* row + 1; 0: none */
    RETURN_IF_ERROR(NEW_ARRAY(&edge, faces->count * 3, error));
    RETURN_IF_ERROR(number_edges(node_count, faces, edge, &edges, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row_of, edges, error));
    for (int64_t i = 0; i < faces->count * 3; i++) {
        if (!face_has_own_row(faces, i / 3)) {
            row_of[edge[i]] = faces->row[i] + 1;
        }
    }
    for (int64_t i = 0; i < faces->count * 3; i++) {
        row[i] = row_of[edge[i]] - 1;
    }
    return STATUS_OK;
}

/* Remove repeated cells and -1 from each row. On entry row r ends at ptr[r + 1]. */
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

enum status face_rows_cells(int64_t node_count, const struct faces *faces, int64_t **ptr, int32_t **cell,
                            struct error *error)
{
    enum status status;
    bool shared = faces->row != NULL;
    int64_t *start = NULL;
    int32_t *row = NULL; /* four for each face: its own, and those of its edges */
    *cell = NULL;
    TRY(NEW_ARRAY(&start, faces->row_count + 2, error));
    TRY(NEW_ARRAY(&row, faces->count * 4, error));
    memset(row, -1, (size_t)faces->count * 4 * sizeof *row);
    if (shared) {
        TRY(rows_of_edges(node_count, faces, row + faces->count, error));
    }
    for (int64_t f = 0; f < faces->count; f++) {
        row[f] = face_has_own_row(faces, f) ? (int32_t)face_row(faces, f, 0) : -1;
    }
    for (int64_t i = 0; i < faces->count * 4; i++) {
        start[row[i] + 2] += row[i] >= 0 ? 2 : 0;
    }
    for (int64_t r = 0; r < faces->row_count; r++) {
        start[r + 2] += start[r + 1];
    }
    TRY(NEW_ARRAY(cell, start[faces->row_count + 1], error));
    for (int64_t i = 0; i < faces->count * 4; i++) {
        int64_t f = i < faces->count ? i : (i - faces->count) / 3;
        if (row[i] >= 0) {
            memcpy(*cell + start[row[i] + 1], faces->cell + f * 2, 2 * sizeof **cell);
            start[row[i] + 1] += 2;
        }
    }
    keep_new_cells(faces->row_count, start, *cell);
done:
    free(row);
    *ptr = start;
    return status;
}

void face_rows_points(const struct faces *faces, const double *nodes, double *x)
{
    int dim = faces->dim;
    const struct quadrature_rule own = quadrature_face_rule(dim);
    for (int64_t f = 0; f < faces->count; f++) {
        const int32_t *node = faces->node + f * dim;
        if (face_has_own_row(faces, f)) {
            quadrature_positions(&own, dim, nodes, node,
                                 x + face_row_point(faces, face_row(faces, f, 0)) * dim);
            continue;
        }
        for (int k = 0; k < dim; k++) {
            double *middle = x + face_row_point(faces, face_row(faces, f, k)) * dim;
            const double *a = nodes + (int64_t)node[k] * dim, *b = nodes + (int64_t)node[(k + 1) % dim] * dim;
            for (int c = 0; c < dim; c++) {
                middle[c] = 0.5 * (a[c] + b[c]);
            }
        }
    }
}
