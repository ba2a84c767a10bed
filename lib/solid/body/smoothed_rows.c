/* The rows from which smoothed cells are computed: which edges, vertices and boundary faces each cell uses,
 * checks of the given tables, and the rows that this process needs. See smoothed_cells.h. */
#include "approx/cells/cells.h"
#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"

#include <math.h>
#include <string.h>

enum { ROWS_FOR_THREAD = 4000 }; /* see chunks_of */

/* The edge of a cell between two of its vertices; -1: they are not of the cell. */
static int edge_between(int dim, const int32_t *vertex, int32_t a, int32_t b)
{
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int32_t first = vertex[cell_edge_ends[e][0]], second = vertex[cell_edge_ends[e][1]];
        if ((first == a && second == b) || (first == b && second == a)) {
            return e;
        }
    }
    return -1;
}

/* edge_of_cell[CELL_EDGES(dim)] of each cell in the body's order, in which place[] is that of each cell. */
static enum status match_edges(const struct smoothed_cells_input *input, const struct body *body,
                               const int32_t *place, int32_t *edge_of_cell, struct error *error)
{
    const struct faces *faces = input->faces;
    int dim = body->dim;
    int64_t cell_count = body->point_count;
    for (int64_t i = 0; i < cell_count * CELL_EDGES(dim); i++) {
        edge_of_cell[i] = -1;
    }
    for (int64_t i = 0; i < faces->count * 2 * FACE_EDGES(dim); i++) {
        int64_t f = i / (2 * FACE_EDGES(dim)), cell = faces->cell[i / FACE_EDGES(dim)];
        int k = (int)(i % FACE_EDGES(dim));
        if (cell >= 0 && cell < cell_count) {
            const int32_t *node = faces->node + f * dim;
            int at = edge_between(dim, input->cell_node + cell * (dim + 1), node[k], node[(k + 1) % dim]);
            if (at >= 0) {
                edge_of_cell[place[cell] * CELL_EDGES(dim) + at] = (int32_t)face_edge(faces, f, k);
            }
        }
    }
    for (int64_t i = 0; i < cell_count * CELL_EDGES(dim); i++) {
        if (edge_of_cell[i] < 0) {
            return fail(error, STATUS_INPUT,
                        "faces.cell: cell %lld lacks a face: run ipoints for smoothed cells",
                        (long long)body->order.points[i / CELL_EDGES(dim)]);
        }
    }
    return STATUS_OK;
}

/* x[face_row_count(faces) * dim]: the midpoints of the edges, and the centres of boundary faces. */
static enum status place_rows(const struct faces *faces, const double *nodes, double *x, struct error *error)
{
    int dim = faces->dim;
    NEW_SCRATCH(int32_t, ends, faces->edge_count * 2, error);
    RETURN_IF_ERROR(face_edges_ends(faces, ends, error));
    for (int64_t e = 0; e < faces->edge_count; e++) {
        vector_middle(dim, nodes, 2, ends + 2 * e, x + e * dim);
    }
    for (int64_t r = faces->edge_count; r < face_row_count(faces); r++) {
        vector_middle(dim, nodes, dim, faces->node + (r - faces->edge_count) * dim, x + r * dim);
    }
    return STATUS_OK;
}

/* The boundary faces of a body by their cells in the body's order: see field_averages.h. */
static enum status list_faces(const struct smoothed_cells_input *input, const struct body *body,
                              const int32_t *place, struct field_averages_input *tables, int32_t **face_row,
                              struct error *error)
{
    const struct faces *faces = input->faces;
    int dim = body->dim;
    SCRATCH int32_t *face = NULL;
    SCRATCH int64_t *ptr = NULL;
    tables->face_count = faces->boundary_count;
    NEW_SCRATCH(int32_t, cell, tables->face_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&tables->face_cell, tables->face_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&tables->face_vertex, tables->face_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(face_row, tables->face_count, error));
    for (int64_t f = 0; f < tables->face_count; f++) {
        cell[f] = place[faces->cell[2 * f]];
    }
    RETURN_IF_ERROR(lists_by_row(tables->face_count, 1, cell, body->point_count, &ptr, &face, error));
    for (int64_t i = 0; i < tables->face_count; i++) {
        int64_t f = face[i];
        const int32_t *vertex = input->cell_node + (int64_t)faces->cell[2 * f] * (dim + 1);
        const int32_t *node = faces->node + f * dim;
        int32_t k = 0;
        while (k < dim && (vertex[k] == node[0] || vertex[k] == node[1] || vertex[k] == node[dim - 1])) {
            k++;
        }
        tables->face_cell[i] = cell[f];
        tables->face_vertex[i] = k;
        (*face_row)[i] = (int32_t)(faces->edge_count + f);
    }
    return STATUS_OK;
}

/* A given table of shape functions: its section, what a row stands for, and the points of the rows. */
struct given_table {
    const char *section, *of;
    const int64_t *ptr;
    const int32_t *idx;
    const double *phi, *x;
};

/* Check that the rows reproduce 1 and x: they are values of the shape functions at x, or averages over an
 * edge or a face with the middle x. */
static enum status check_table(const struct given_table *table, int64_t rows, int dim, const double *nodes,
                               struct error *error)
{
    int64_t bad = rows;
#pragma omp parallel for reduction(min : bad) num_threads(chunks_of(rows, ROWS_FOR_THREAD).threads)
    for (int64_t r = 0; r < rows; r++) {
        double sum[4] = {-1.0}, size = 0.0, extent = 0.0;
        for (int64_t i = table->ptr[r]; i < table->ptr[r + 1]; i++) {
            sum[0] += table->phi[i];
            size += fabs(table->phi[i]);
            for (int a = 0; a < dim; a++) {
                double offset = nodes[(int64_t)table->idx[i] * dim + a] - table->x[r * dim + a];
                sum[1 + a] += table->phi[i] * offset;
                extent = fmax(extent, fabs(offset));
            }
        }
        for (int k = 0; k <= dim; k++) {
            bool right = fabs(sum[k]) <= 1e-5 * size * (k == 0 ? 1.0 : extent);
            bad = !right && r < bad ? r : bad;
        }
    }
    if (bad < rows) {
        return fail(error, STATUS_INPUT, "%s: %s %lld: not the shape functions at this %s: run shapefn again",
                    table->section, table->of, (long long)bad, table->of);
    }
    return STATUS_OK;
}

/* One process: copy all rows. */
static enum status copy_all(const struct smoothed_cells_input *input,
                            const struct field_averages_input *tables, struct body *body, struct error *error)
{
    RETURN_IF_ERROR(field_averages_copy(tables, NULL, 0, body->node_count, &body->rows.matrix, error));
    if (input->copied != NULL) {
        input->copied(input->context);
    }
    RETURN_IF_ERROR(body_share_rows(body, NULL, error));
    return row_ranges_of(0, body->cells.averages.row_count, NULL, &body->share.values, error);
}

/* Several processes: copy the rows that this one's cells need, and the columns of its nodes. */
static enum status copy_shares(const struct field_averages_input *tables, struct body *body,
                               struct error *error)
{
    struct body_share *share = &body->share;
    struct field_averages *averages = &body->cells.averages;
    struct row_operator *rows = &body->rows;
    SCRATCH bool *needed = NULL, *used = NULL;
    RETURN_IF_ERROR(body_share_values(body, &needed, error));
    RETURN_IF_ERROR(row_ranges_of(0, averages->row_count, needed, &share->values, error));
    RETURN_IF_ERROR(field_averages_copy(tables, needed, 0, body->node_count, &rows->matrix, error));
    RETURN_IF_ERROR(
        field_averages_copy(tables, NULL, share->begin_node, share->end_node, &rows->columns, error));
    RETURN_IF_ERROR(sparse_rows_used(&rows->columns, &used, error));
    RETURN_IF_ERROR(body_share_rows(body, used, error));
    memcpy(averages->given, tables->tables, sizeof averages->given);
    return STATUS_OK;
}

enum status smoothed_rows_build(const struct smoothed_cells_input *input, struct body *body,
                                struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim, corners = dim + 1;
    const struct faces *faces = input->faces;
    int64_t rows = face_row_count(faces);
    SCRATCH int64_t *order = NULL;
    SCRATCH int32_t *face_row = NULL;
    NEW_SCRATCH(int32_t, place, body->point_count, error);
    for (int64_t q = 0; q < body->point_count; q++) {
        place[body->order.points[q]] = (int32_t)q;
    }
    NEW_SCRATCH(int32_t, edge_of_cell, body->point_count * CELL_EDGES(dim), error);
    RETURN_IF_ERROR(match_edges(input, body, place, edge_of_cell, error));
    NEW_SCRATCH(double, x, rows * dim, error);
    RETURN_IF_ERROR(place_rows(faces, input->x, x, error));
    const struct given_table edges = {"edge.phi",      "edge",          input->edge_ptr,
                                      input->edge_idx, input->edge_phi, x};
    const struct given_table nodes = {"node.phi",      "node",          input->node_ptr,
                                      input->node_idx, input->node_phi, input->x};
    RETURN_IF_ERROR(check_table(&edges, rows, dim, input->x, error));
    RETURN_IF_ERROR(check_table(&nodes, body->node_count, dim, input->x, error));
    RETURN_IF_ERROR(NEW_ARRAY(&order, rows, error));
    RETURN_IF_ERROR(renumber_morton(dim, rows, x, NULL, order, error));
    NEW_SCRATCH(int32_t, vertex_of_cell, body->point_count * corners, error);
    for (int64_t q = 0; q < body->point_count; q++) {
        memcpy(vertex_of_cell + q * corners, input->cell_node + body->order.points[q] * corners,
               (size_t)corners * sizeof *vertex_of_cell);
    }
    NEW_SCRATCH(int64_t, block_first, body->block_count + 1, error);
    for (int64_t b = 0; b < body->block_count; b++) {
        block_first[b] = body->blocks[b].first_point;
    }
    block_first[body->block_count] = body->point_count;
    struct field_averages_input tables = {
        .dim = dim,
        .block_count = body->block_count,
        .block_first = block_first,
        .node_count = body->node_count,
        .cell_count = body->point_count,
        .place = body->order.places,
        .lets_go = input->copied != NULL && body->share.ranks == NULL,
        .tables = {{rows, order, input->edge_ptr, input->edge_idx, input->edge_phi, edge_of_cell},
                   {body->node_count, body->order.nodes, input->node_ptr, input->node_idx, input->node_phi,
                    vertex_of_cell}}};
    enum status listed = list_faces(input, body, place, &tables, &face_row, error);
    tables.face_row = face_row;
    averages->face_cell = tables.face_cell; /* freed with the body, whatever comes */
    averages->face_vertex = tables.face_vertex;
    RETURN_IF_ERROR(listed);
    RETURN_IF_ERROR(field_averages_build(&tables, averages, error));
    if (body->share.ranks == NULL) {
        RETURN_IF_ERROR(copy_all(input, &tables, body, error));
    } else {
        RETURN_IF_ERROR(copy_shares(&tables, body, error));
        averages->edge_order = array_take(&order);
    }
    return STATUS_OK;
}
