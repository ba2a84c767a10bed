#include "solid/body/prescribed_values.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/body/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The dim nodes of face i of field_averages.h. */
static void face_corners(const struct body *body, const struct cells *cells, int64_t i, int32_t *corner)
{
    const struct field_averages *averages = &body->cells.averages;
    const int32_t *vertex = cells->node + body->order.points[averages->face_cell[i]] * (body->dim + 1);
    for (int k = 0; k <= body->dim; k++) {
        if (k != averages->face_vertex[i]) {
            *corner++ = vertex[k];
        }
    }
}

/* Where the faces of the boundary are in field_averages.h. */
static enum status find_faces(struct body *body, const struct cells *cells, const struct faces *boundary,
                              struct error *error)
{
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    int64_t count = averages->face_count;
    NEW_SCRATCH(int32_t, facet, count * dim, error);
    NEW_SCRATCH(int64_t, found, count, error);
    for (int64_t i = 0; i < count; i++) {
        face_corners(body, cells, i, facet + i * dim);
    }
    RETURN_IF_ERROR(faces_find(boundary, count, facet, found, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->cells.prescribed.of_face, count, error));
    for (int64_t i = 0; i < count; i++) {
        body->cells.prescribed.of_face[found[i]] = i;
    }
    return STATUS_OK;
}

enum status prescribed_values_begin(struct body *body, const struct cells *cells,
                                    const struct faces *boundary, struct error *error)
{
    struct prescribed_values *values = &body->cells.prescribed;
    int64_t rows = body->cells.averages.row_count;
    RETURN_IF_ERROR(NEW_ARRAY(&values->of_row, rows, error));
    memset(values->of_row, -1, (size_t)rows * sizeof *values->of_row);
    RETURN_IF_ERROR(NEW_ARRAY(&values->is_face, body->cells.averages.face_count, error));
    return find_faces(body, cells, boundary, error);
}

/* Add a row in the middle of nodes. */
static void add_row(const struct cells *cells, int64_t row, int nodes, const int32_t *node,
                    struct face_rows *rows)
{
    int r = rows->count++;
    rows->row[r] = row;
    rows->nodes[r] = nodes;
    memcpy(rows->node[r], node, (size_t)nodes * sizeof *node);
    vector_middle(cells->dim, cells->x, nodes, node, rows->place + cells->dim * r);
}

void prescribed_values_face(const struct body *body, const struct cells *cells, int64_t face,
                            struct face_rows *rows)
{
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    int64_t i = body->cells.prescribed.of_face[face], q = averages->face_cell[i];
    const int32_t *vertex = cells->node + body->order.points[q] * (dim + 1);
    int opposite = averages->face_vertex[i];
    int32_t corner[3];
    *rows = (struct face_rows){.face = face};
    face_corners(body, cells, i, corner);
    add_row(cells, averages->of_use[field_averages_faces(averages, dim) + i] / VECTOR_STRIDE(dim), dim,
            corner, rows);
    for (int k = 0; k <= dim; k++) {
        if (k != opposite) {
            add_row(cells, body_node_row(body, smoothed_cells_node(body, q, k)), 1, vertex + k, rows);
        }
    }
    for (int e = 0; e < FACE_EDGES(dim); e++) {
        int edge = cell_face_edge(dim, opposite, e);
        const int32_t ends[] = {vertex[cell_edge_ends[edge][0]], vertex[cell_edge_ends[edge][1]]};
        add_row(cells, smoothed_cells_edge(body, q, edge), 2, ends, rows);
    }
}

bool prescribed_values_full(const struct body *body, const struct face_rows *rows, int r)
{
    const struct prescribed_values *values = &body->cells.prescribed;
    int32_t item = values->of_row[rows->row[r]];
    return item >= 0 && values->items[item].count == body->dim;
}

enum status prescribed_values_add(struct body *body, const struct face_rows *rows, int r,
                                  const double *direction, double target, int32_t curve, int32_t section,
                                  struct error *error)
{
    struct prescribed_values *values = &body->cells.prescribed;
    int dim = body->dim;
    int64_t row = rows->row[r];
    if (values->of_row[row] < 0) {
        RETURN_IF_ERROR(GROW_ARRAY(&values->items, values->count + 1, &values->room, error));
        values->of_row[row] = (int32_t)values->count;
        struct prescribed_value *added = &values->items[values->count++];
        *added = (struct prescribed_value){.row = row, .nodes = rows->nodes[r]};
        memcpy(added->node, rows->node[r], sizeof added->node);
    }
    struct prescribed_value *item = &values->items[values->of_row[row]];
    values->is_face[rows->face] = true;
    for (int k = 0; k < item->count; k++) {
        if (fabs(vector_dot(dim, direction, item->axis + k * dim)) > COARSE_ROUND_OFF) {
            return STATUS_OK;
        }
    }
    int k = item->count++;
    memcpy(item->axis + k * dim, direction, (size_t)dim * sizeof *direction);
    item->target[k] = target;
    item->curve[k] = curve;
    item->section[k] = section;
    return STATUS_OK;
}

/* Leave out those at faces that are not prescribed. */
static enum status leave_rim(struct body *body, const struct cells *cells, struct error *error)
{
    struct prescribed_values *values = &body->cells.prescribed;
    NEW_SCRATCH(bool, at_rim, body->cells.averages.row_count, error);
    int64_t kept = 0;
    for (int64_t f = 0; f < body->cells.averages.face_count; f++) {
        struct face_rows rows;
        prescribed_values_face(body, cells, f, &rows);
        for (int r = 0; r < rows.count && !values->is_face[f]; r++) {
            at_rim[rows.row[r]] = true;
        }
    }
    for (int64_t i = 0; i < values->count; i++) {
        if (!at_rim[values->items[i].row]) {
            values->items[kept++] = values->items[i];
        }
    }
    values->count = kept;
    return STATUS_OK;
}

/* By the parts of the forces on them, whose order is that of the cells, for any number of processes. */
static int compare_parts(const void *left, const void *right)
{
    int64_t a = ((const struct prescribed_value *)left)->part,
            b = ((const struct prescribed_value *)right)->part;
    return (a > b) - (a < b);
}

enum status prescribed_values_complete(struct body *body, const struct cells *cells, struct error *error)
{
    struct prescribed_values *values = &body->cells.prescribed;
    const struct field_averages *averages = &body->cells.averages;
    int ranks = ranks_count(body->share.ranks);
    if (values->of_row == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(leave_rim(body, cells, error));
    FREE_ALL(values->of_row, values->of_face, values->is_face);
    values->of_row = NULL;
    values->of_face = NULL;
    values->is_face = NULL;
    for (int64_t i = 0; i < values->count; i++) {
        values->items[i].part = averages->part[averages->part_ptr[values->items[i].row]];
    }
    if (values->count > 0) {
        qsort(values->items, (size_t)values->count, sizeof *values->items, compare_parts);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&values->first, ranks + 1, error));
    for (int64_t i = 0; i < values->count; i++) {
        values->first[body_share_owner(body, values->items[i].row) + 1]++;
    }
    for (int r = 0; r < ranks; r++) {
        values->first[r + 1] += values->first[r];
    }
    return STATUS_OK;
}

void prescribed_values_free(struct prescribed_values *values)
{
    FREE_ALL(values->items, values->first, values->of_row, values->of_face, values->is_face);
    *values = (struct prescribed_values){0};
}

/* The load factor of a curve for them. */
static double factor_of(const struct body *body, int32_t curve)
{
    const struct prescribed_values *values = &body->cells.prescribed;
    double factor = (*body->load_factors)[curve];
    return values->change != NULL ? factor - values->lag * values->change[curve] : factor;
}

void prescribed_values_place(struct body *body)
{
    const struct prescribed_values *values = &body->cells.prescribed;
    int dim = body->dim;
#pragma omp for schedule(static)
    for (int64_t i = 0; i < values->count; i++) {
        struct prescribed_value *item = &values->items[i];
        double *value = body->cells.averages.value + item->row * VECTOR_STRIDE(dim);
        for (int k = 0; k < item->count; k++) {
            double target = item->target[k] * factor_of(body, item->curve[k]) +
                            item->start[k] * factor_of(body, values->start_curve);
            target -= vector_dot(dim, item->axis + k * dim, value);
            add_scaled(dim, target, item->axis + k * dim, value);
        }
        memcpy(item->value, value, (size_t)dim * sizeof *value);
    }
}

void prescribed_values_take_forces(struct body *body)
{
    const struct prescribed_values *values = &body->cells.prescribed;
    int dim = body->dim, rank = ranks_rank(body->share.ranks);
    int64_t begin = values->count > 0 ? values->first[rank] : 0;
    int64_t end = values->count > 0 ? values->first[rank + 1] : 0;
#pragma omp for schedule(static)
    for (int64_t i = begin; i < end; i++) {
        struct prescribed_value *item = &values->items[i];
        double *force = body->cells.averages.force + item->row * VECTOR_STRIDE(dim);
        for (int k = 0; k < item->count; k++) {
            item->force[k] = vector_dot(dim, item->axis + k * dim, force);
            add_scaled(dim, -item->force[k], item->axis + k * dim, force);
        }
    }
}

void prescribed_values_collect(struct body *body)
{
    struct prescribed_values *values = &body->cells.prescribed;
    if (values->count > 0) {
        ranks_gather(body->share.ranks, values->items, sizeof *values->items, values->first);
    }
}

double prescribed_values_work(struct body *body, const double *from, const double *to)
{
    const struct prescribed_values *values = &body->cells.prescribed;
    double work = 0.0;
    bool moves = false;
    for (int64_t i = 0; i < 3 * values->count; i++) {
        const struct prescribed_value *item = &values->items[i / 3];
        int32_t curve = item->curve[i % 3];
        moves = moves || (fabs(item->target[i % 3]) > 0.0 && fabs(to[curve] - from[curve]) > 0.0);
    }
    if (!moves) {
        return 0.0;
    }
    prescribed_values_collect(body);
    for (int64_t i = 0; i < values->count; i++) {
        const struct prescribed_value *item = &values->items[i];
        for (int k = 0; k < item->count; k++) {
            work += item->force[k] * item->target[k] * (to[item->curve[k]] - from[item->curve[k]]);
        }
    }
    return work;
}

void prescribed_values_start(struct body *body, int32_t start_curve, const double *start)
{
    struct prescribed_values *values = &body->cells.prescribed;
    values->start_curve = start_curve;
    for (int64_t i = 0; i < values->count; i++) {
        struct prescribed_value *item = &values->items[i];
        double mean[3];
        vector_middle(body->dim, start, item->nodes, item->node, mean);
        for (int k = 0; k < item->count; k++) {
            item->start[k] = vector_dot(body->dim, mean, item->axis + k * body->dim);
        }
    }
}
