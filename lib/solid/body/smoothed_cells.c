#include "solid/body/smoothed_cells.h"

#include "approx/cells/renumber.h"
#include "base/chunks.h"
#include "base/memory.h"
#include "base/read_rows.h"
#include "solid/body/body.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum { ROWS_FOR_THREAD = 4000 }; /* see chunks_of */

/* Gradients of the linear shape functions 1 .. dim of a simplex, dim x dim. */
static void linear_gradients(int dim, const double *x, const int32_t *vertex, double *gradient)
{
    double F[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, C[9];
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            F[3 * a + k] = x[(int64_t)vertex[k + 1] * dim + a] - x[(int64_t)vertex[0] * dim + a];
        }
    }
    double J = determinant(F);
    cofactor(F, C); /* C / J = F^-T: its columns are the gradients of N_1 .. N_dim */
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            gradient[k * dim + a] = C[3 * a + k] / J;
        }
    }
}

static enum status set_linear_gradients(const struct smoothed_cells_input *input, int dim, int64_t cell_count,
                                        const int64_t *order, struct smoothed_cells *smoothed,
                                        struct error *error)
{
    RETURN_IF_ERROR(
        NEW_ARRAY(&smoothed->linear_gradient, cell_count * dim * dim + BODY_POINT_PADDING, error));
    for (int64_t q = 0; q < cell_count; q++) {
        double gradient[9];
        linear_gradients(dim, input->x, input->cell_node + order[q] * (dim + 1), gradient);
        for (int k = 0; k < dim * dim; k++) {
            smoothed->linear_gradient[k * cell_count + q] = gradient[k];
        }
    }
    return STATUS_OK;
}

/* Corner of a cell that is opposite a face: the one whose vertex the face has not. */
static int opposite_corner(int dim, const int32_t *vertex, const int32_t *face)
{
    int k = 0;
    while (k < dim && (face[0] == vertex[k] || face[1] == vertex[k] || (dim == 3 && face[2] == vertex[k]))) {
        k++;
    }
    return k;
}

/* The rows of the face opposite each corner. */
static enum status match_corners(const struct smoothed_cells_input *input, int dim, int64_t cell_count,
                                 const int64_t *order, int32_t *row_of_corner, struct error *error)
{
    SCRATCH int64_t *cell_place = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&cell_place, cell_count, error));
    for (int64_t q = 0; q < cell_count; q++) {
        cell_place[order[q]] = q;
    }
    int rows = FACE_ROWS(dim);
    for (int64_t i = 0; i < cell_count * (dim + 1) * rows; i++) {
        row_of_corner[i] = -1;
    }
    for (int64_t i = 0; i < input->faces->count * 2; i++) {
        int64_t face = i / 2, cell = input->faces->cell[i];
        if (cell >= 0 && cell < cell_count) {
            int corner =
                opposite_corner(dim, input->cell_node + cell * (dim + 1), input->faces->node + face * dim);
            for (int k = 0; k < rows; k++) {
                row_of_corner[(cell_place[cell] * (dim + 1) + corner) * rows + k] =
                    (int32_t)face_row(input->faces, face, k);
            }
        }
    }
    for (int64_t i = 0; i < cell_count * (dim + 1); i++) {
        if (row_of_corner[i * rows] < 0) {
            return fail(error, STATUS_INPUT,
                        "faces.cell: cell %lld lacks a face: run ipoints for smoothed cells",
                        (long long)order[i / (dim + 1)]);
        }
    }
    return STATUS_OK;
}

/* x[row_count * dim]: the points of the rows. STATUS_INPUT where the mean of a face's is not its centroid. */
static enum status place_rows(const struct faces *faces, const double *nodes, double *x, struct error *error)
{
    int dim = faces->dim, rows = FACE_ROWS(dim);
    SCRATCH double *points = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&points, face_row_point(faces, faces->row_count) * dim, error));
    face_rows_points(faces, nodes, points);
    for (int64_t r = 0; r < faces->row_count; r++) {
        int64_t first = face_row_point(faces, r), count = face_row_point(faces, r + 1) - first;
        for (int64_t i = 0; i < count * dim; i++) {
            x[r * dim + i % dim] += points[first * dim + i] / (double)count;
        }
    }
    for (int64_t f = 0; f < faces->count; f++) {
        double off = 0.0, size = 0.0, middle[3];
        vector_middle(dim, nodes, dim, faces->node + f * dim, middle);
        for (int a = 0; a < dim; a++) {
            double mean = 0.0, first = nodes[(int64_t)faces->node[f * dim] * dim + a];
            for (int k = 0; k < rows; k++) {
                mean += x[face_row(faces, f, k) * dim + a] / rows;
            }
            off = fmax(off, fabs(mean - middle[a]));
            size = fmax(size, fabs(middle[a] - first));
        }
        if (!(off <= 1e-6 * size)) {
            return fail(error, STATUS_INPUT, "faces.row: row %lld: not those of this face: run ipoints again",
                        (long long)f);
        }
    }
    return STATUS_OK;
}

/* A given table of shape functions: its section, what a row stands for, and the points of the rows. With
 * several processes, rows that others have read are empty. */
struct given_table {
    const char *section, *of;
    const int32_t *reader; /* of each row, as in smoothed_cells_input; NULL: all rows are here */
    int rank;
    const int64_t *ptr;
    const int32_t *idx;
    const double *phi, *x;
};

/* Check that the rows reproduce 1 and x: they are values of the shape functions at x, or averages with the
 * centroid x. */
static enum status check_table(const struct given_table *table, int64_t rows, int dim, const double *nodes,
                               struct error *error)
{
    int64_t bad = rows;
#pragma omp parallel for reduction(min : bad) num_threads(chunks_of(rows, ROWS_FOR_THREAD).threads)
    for (int64_t r = 0; r < rows; r++) {
        double sum[4] = {-1.0}, size = 0.0, extent = 0.0;
        if (table->reader != NULL && table->reader[r] != table->rank) {
            continue;
        }
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

/* Mark in wanted[] all rows of the cells that have a row in touched[]: the stiffness of own nodes needs them.
 */
static void add_rows_of_cells(const struct body *body, const bool *touched, bool *wanted)
{
    const struct field_averages *averages = &body->cells.averages;
    int corners = body->dim + 1, rows = FACE_ROWS(body->dim);
    for (int64_t r = 0; r < averages->row_count; r++) {
        for (int64_t i = averages->corner_ptr[r]; i < averages->corner_ptr[r + 1] && touched[r]; i++) {
            int64_t q = averages->corner[i] % averages->corner_count / corners;
            int64_t first = smoothed_cells_group(body, q), end = smoothed_cells_group_end(body, q);
            for (int64_t c = first * corners * rows; c < end * corners * rows; c++) {
                wanted[averages->of_corner[c] / VECTOR_STRIDE(body->dim)] = true;
            }
        }
    }
}

/* wanted[rows of faces]: the averages that own cells need, those with own nodes in them, and all other rows
 * of the cells that these belong to. */
static enum status list_faces(const struct smoothed_cells_input *input, const struct read_rows *rows,
                              const struct body *body, const int64_t *order, bool *wanted,
                              struct error *error)
{
    const struct field_averages *averages = &body->cells.averages;
    SCRATCH bool *touched = NULL, *in_order = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&touched, averages->row_count, error));
    RETURN_IF_ERROR(body_share_values(body, &in_order, error));
    RETURN_IF_ERROR(read_rows_with(rows, body_share_owner, body, wanted, error));
    for (int64_t r = 0; r < averages->row_count; r++) {
        int64_t n = r < input->faces->row_count ? -1 : body->node_order[r - input->faces->row_count];
        touched[r] = n < 0 && wanted[order[r]];
        for (int64_t i = n < 0 ? 0 : input->node_ptr[n]; n >= 0 && i < input->node_ptr[n + 1]; i++) {
            touched[r] = touched[r] || body_share_owner(body, input->node_idx[i]) == rows->ranks->rank;
        }
    }
    add_rows_of_cells(body, touched, in_order);
    for (int64_t f = 0; f < input->faces->row_count; f++) {
        wanted[order[f]] = wanted[order[f]] || in_order[f];
    }
    return STATUS_OK;
}

/* Fetch the rows of the face table that this process needs, where none has read all of it. */
static enum status fetch_faces(const struct smoothed_cells_input *input, struct body *body,
                               struct average_table *faces, struct error *error)
{
    struct sparse *fetched = &body->cells.averages.fetched;
    const struct read_rows rows = {.ranks = body->share.ranks,
                                   .row_count = input->faces->row_count,
                                   .column_count = body->node_count,
                                   .ptr = input->face_ptr,
                                   .idx = input->face_idx,
                                   .value = input->face_phi,
                                   .reader = input->face_reader};
    SCRATCH bool *wanted = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&wanted, input->faces->row_count, error));
    RETURN_IF_ERROR(list_faces(input, &rows, body, faces->order, wanted, error));
    RETURN_IF_ERROR(read_rows_fetch(&rows, wanted, fetched, error));
    faces->ptr = fetched->ptr;
    faces->idx = fetched->idx;
    faces->phi = fetched->value;
    if (input->copied != NULL) {
        input->copied(input->context);
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
static enum status copy_shares(const struct smoothed_cells_input *input, struct field_averages_input *tables,
                               struct body *body, struct error *error)
{
    struct body_share *share = &body->share;
    struct field_averages *averages = &body->cells.averages;
    struct row_operator *rows = &body->rows;
    SCRATCH bool *needed = NULL, *used = NULL;
    if (input->face_reader != NULL) {
        RETURN_IF_ERROR(fetch_faces(input, body, &tables->tables[0], error));
    }
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

/* Build the rows of the faces and of the nodes. The corners of a face's row are those opposite the face; the
 * corners of a node's row are the vertices of cells at the node. */
static enum status build_averages(const struct smoothed_cells_input *input, struct body *body,
                                  struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim, corners = dim + 1;
    const struct faces *faces = input->faces;
    SCRATCH int64_t *order = NULL;
    SCRATCH int32_t *node_of_corner = NULL, *row_of_corner = NULL;
    SCRATCH double *x = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&row_of_corner, body->point_count * corners * FACE_ROWS(dim), error));
    RETURN_IF_ERROR(match_corners(input, dim, body->point_count, body->order, row_of_corner, error));
    RETURN_IF_ERROR(NEW_ARRAY(&x, faces->row_count * dim, error));
    RETURN_IF_ERROR(place_rows(faces, input->x, x, error));
    const struct given_table rows = {
        "face.phi",      "row",           input->face_reader, ranks_rank(body->share.ranks),
        input->face_ptr, input->face_idx, input->face_phi,    x};
    const struct given_table nodes = {"node.phi",      "node",          NULL,    0, input->node_ptr,
                                      input->node_idx, input->node_phi, input->x};
    enum status checked = check_table(&rows, faces->row_count, dim, input->x, error);
    RETURN_IF_ERROR(input->face_reader != NULL ? ranks_agree(body->share.ranks, checked, error) : checked);
    RETURN_IF_ERROR(check_table(&nodes, body->node_count, dim, input->x, error));
    RETURN_IF_ERROR(NEW_ARRAY(&order, faces->row_count, error));
    RETURN_IF_ERROR(renumber_morton(dim, faces->row_count, x, NULL, order, error));
    RETURN_IF_ERROR(NEW_ARRAY(&node_of_corner, body->point_count * corners, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        memcpy(node_of_corner + q * corners, input->cell_node + body->order[q] * corners,
               (size_t)corners * sizeof *node_of_corner);
    }
    struct field_averages_input tables = {.dim = dim,
                                          .node_count = body->node_count,
                                          .corner_count = body->point_count * corners,
                                          .place = body->node_place,
                                          .lets_go = input->copied != NULL && body->share.ranks == NULL,
                                          .tables = {{faces->row_count, order, input->face_ptr,
                                                      input->face_idx, input->face_phi, row_of_corner},
                                                     {body->node_count, body->node_order, input->node_ptr,
                                                      input->node_idx, input->node_phi, node_of_corner}}};
    RETURN_IF_ERROR(field_averages_build(&tables, averages, error));
    if (body->share.ranks == NULL) {
        RETURN_IF_ERROR(copy_all(input, &tables, body, error));
    } else {
        RETURN_IF_ERROR(copy_shares(input, &tables, body, error));
        averages->face_order = array_take(&order);
    }
    return STATUS_OK;
}

enum status smoothed_cells_build(const struct smoothed_cells_input *input, struct body *body,
                                 struct error *error)
{
    struct smoothed_cells *smoothed = &body->cells;
    int64_t entries = body->point_count * body->dim * body->dim + BODY_POINT_PADDING;
    RETURN_IF_ERROR(set_linear_gradients(input, body->dim, body->point_count, body->order, smoothed, error));
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&smoothed->interpolant, entries, error));
    return build_averages(input, body, error);
}

void smoothed_cells_free(struct smoothed_cells *smoothed)
{
    field_averages_free(&smoothed->averages);
    FREE_ALL(smoothed->interpolant, smoothed->linear_gradient, smoothed->group, smoothed->group_end);
    *smoothed = (struct smoothed_cells){0};
}

void smoothed_cells_linear_gradients(const struct body *body, int64_t q, double *gradient)
{
    int dim = body->dim;
    memset(gradient, 0, (size_t)dim * sizeof *gradient);
    for (int k = 1; k <= dim; k++) {
        for (int b = 0; b < dim; b++) {
            gradient[k * dim + b] = body->cells.linear_gradient[((k - 1) * dim + b) * body->point_count + q];
            gradient[b] -= gradient[k * dim + b];
        }
    }
}

int64_t smoothed_cells_group(const struct body *body, int64_t q)
{
    return body->cells.group != NULL ? body->cells.group[q] : q;
}

int64_t smoothed_cells_group_end(const struct body *body, int64_t q)
{
    return body->cells.group != NULL ? body->cells.group_end[q] : q + 1;
}

int32_t smoothed_cells_row(const struct body *body, int64_t q, int k, int i)
{
    int64_t corner = q * (body->dim + 1) + k;
    return body->cells.averages.of_corner[corner * FACE_ROWS(body->dim) + i] / VECTOR_STRIDE(body->dim);
}

int32_t smoothed_cells_node(const struct body *body, int64_t q, int k)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t first = averages->corner_count * FACE_ROWS(body->dim);
    int32_t row = averages->of_corner[first + q * (body->dim + 1) + k] / VECTOR_STRIDE(body->dim);
    return row - (int32_t)(averages->row_count - body->node_count);
}

double smoothed_cells_share(const struct body *body, int64_t q)
{
    double sum = 0.0;
    for (int64_t i = smoothed_cells_group(body, q); i < smoothed_cells_group_end(body, q); i++) {
        sum += body->weight[i];
    }
    return body->weight[q] / sum;
}
