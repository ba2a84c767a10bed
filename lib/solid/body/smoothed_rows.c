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

/* of_edge[CELL_EDGES(dim)] of each cell in the body's order, in which place[] is that of each cell: its
 * edges.
 */
static enum status match_edges(const struct body_input *input, const struct body *body, const int32_t *place,
                               int32_t *of_edge, struct error *error)
{
    const struct faces *faces = input->faces;
    int dim = body->dim;
    int64_t count = body->point_count * CELL_EDGES(dim);
    memset(of_edge, -1, (size_t)count * sizeof *of_edge);
    for (int64_t i = 0; i < faces->count * 2 * FACE_EDGES(dim); i++) {
        int64_t f = i / (2 * FACE_EDGES(dim)), cell = faces->cell[i / FACE_EDGES(dim)];
        int k = (int)(i % FACE_EDGES(dim));
        if (cell >= 0 && cell < body->point_count) {
            const int32_t *node = faces->node + f * dim, *vertex = input->cells.node + cell * (dim + 1);
            int at = edge_between(dim, vertex, node[k], node[(k + 1) % dim]);
            if (at >= 0) {
                of_edge[place[cell] * CELL_EDGES(dim) + at] = (int32_t)face_edge(faces, f, k);
            }
        }
    }
    for (int64_t i = 0; i < count; i++) {
        if (of_edge[i] < 0) {
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

/* The boundary faces of a body by their cells in the body's order, and of_face[]: these. */
static enum status list_faces(const struct body_input *input, const int32_t *place, struct body *body,
                              int32_t *of_face, struct error *error)
{
    const struct faces *faces = input->faces;
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    SCRATCH int32_t *face = NULL;
    SCRATCH int64_t *ptr = NULL;
    NEW_SCRATCH(int32_t, cell, averages->face_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&averages->face_cell, averages->face_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->face_vertex, averages->face_count, error));
    for (int64_t f = 0; f < averages->face_count; f++) {
        cell[f] = place[faces->cell[2 * f]];
    }
    RETURN_IF_ERROR(lists_by_row(averages->face_count, 1, cell, body->point_count, &ptr, &face, error));
    for (int64_t i = 0; i < averages->face_count; i++) {
        int64_t f = face[i];
        const int32_t *vertex = input->cells.node + (int64_t)faces->cell[2 * f] * (dim + 1);
        const int32_t *node = faces->node + f * dim;
        int32_t k = 0;
        while (k < dim && (vertex[k] == node[0] || vertex[k] == node[1] || vertex[k] == node[dim - 1])) {
            k++;
        }
        averages->face_cell[i] = cell[f];
        averages->face_vertex[i] = k;
        of_face[i] = (int32_t)(faces->edge_count + f);
    }
    return STATUS_OK;
}

/* The edges, vertices and faces that the cells use, in the order of of_use. */
static enum status list_uses(const struct body_input *input, struct body *body, struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim, corners = dim + 1;
    int64_t vertices = field_averages_vertices(averages, dim), faces = field_averages_faces(averages, dim);
    NEW_SCRATCH(int32_t, place, body->point_count, error);
    for (int64_t q = 0; q < body->point_count; q++) {
        place[body->order.points[q]] = (int32_t)q;
    }
    RETURN_IF_ERROR(match_edges(input, body, place, averages->of_use, error));
    for (int64_t i = 0; i < faces - vertices; i++) {
        averages->of_use[vertices + i] =
            input->cells.node[body->order.points[i / corners] * corners + i % corners];
    }
    return list_faces(input, place, body, averages->of_use + faces, error);
}

/* From these to the rows of the tables. */
static void place_uses(const struct row_table tables[2], struct body *body)
{
    struct field_averages *averages = &body->cells.averages;
    int64_t vertices = field_averages_vertices(averages, body->dim);
    int64_t faces = field_averages_faces(averages, body->dim);
    for (int64_t i = 0; i < faces + averages->face_count; i++) {
        bool is_vertex = i >= vertices && i < faces;
        int64_t row = tables[is_vertex].place[averages->of_use[i]];
        row += is_vertex ? tables[0].lists->count : 0;
        averages->of_use[i] = (int32_t)row * VECTOR_STRIDE(body->dim);
    }
}

/* Check that the rows reproduce 1 and x: they are values of the shape functions at x, or averages over an
 * edge or a face with the middle x. `of`: what a row stands for. */
static enum status check_table(const struct row_table *table, const char *of, const double *x,
                               const struct cells *cells, struct error *error)
{
    const struct neighbours *lists = table->lists;
    int dim = cells->dim;
    int64_t rows = lists->count;
    int64_t bad = rows;
#pragma omp parallel for reduction(min : bad) num_threads(chunks_of(rows, ROWS_FOR_THREAD).threads)
    for (int64_t r = 0; r < rows; r++) {
        double sum[4] = {-1.0}, size = 0.0, extent = 0.0;
        for (int64_t i = lists->ptr[r]; i < lists->ptr[r + 1]; i++) {
            sum[0] += table->phi[i];
            size += fabs(table->phi[i]);
            for (int a = 0; a < dim; a++) {
                double offset = cells->x[(int64_t)lists->idx[i] * dim + a] - x[r * dim + a];
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
        return fail(error, STATUS_INPUT,
                    "%s.phi: %s %lld: not the shape functions at this %s: run shapefn again", of, of,
                    (long long)bad, of);
    }
    return STATUS_OK;
}

enum status smoothed_rows_build(const struct body_input *input, struct body *body, struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    int64_t rows = face_row_count(input->faces), stride = VECTOR_STRIDE(dim);
    SCRATCH int64_t *order = NULL;
    averages->row_count = rows + body->node_count;
    averages->cell_count = body->point_count;
    averages->face_count = input->faces->boundary_count;
    int64_t uses = field_averages_faces(averages, dim) + averages->face_count;
    if (averages->row_count > INT32_MAX / stride || uses > INT32_MAX) {
        return fail(error, STATUS_INPUT, "%lld edges and nodes: too many", (long long)averages->row_count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&averages->value, averages->row_count * stride, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->force, averages->row_count * stride, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->of_use, uses, error));
    RETURN_IF_ERROR(list_uses(input, body, error));
    NEW_SCRATCH(int32_t, place, rows, error);
    NEW_SCRATCH(double, x, rows * dim, error);
    RETURN_IF_ERROR(NEW_ARRAY(&order, rows, error));
    const struct row_table tables[] = {
        {1, input->lists, input->phi, order, place},
        {1, input->node_lists, input->node_phi, body->order.nodes, body->order.places}};
    RETURN_IF_ERROR(place_rows(input->faces, input->cells.x, x, error));
    RETURN_IF_ERROR(check_table(&tables[0], "edge", x, &input->cells, error));
    RETURN_IF_ERROR(check_table(&tables[1], "node", input->cells.x, &input->cells, error));
    RETURN_IF_ERROR(renumber_morton(dim, rows, x, NULL, order, error));
    for (int64_t r = 0; r < rows; r++) {
        place[order[r]] = (int32_t)r;
    }
    place_uses(tables, body);
    RETURN_IF_ERROR(field_averages_list(body, error));
    if (body->share.ranks != NULL) {
        memcpy(averages->given, tables, sizeof tables);
        averages->edge_order = array_take(&order);
    }
    return body_rows_copy(input, 2, tables, body, error);
}
