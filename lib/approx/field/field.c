#include "approx/field/field.h"

#include "approx/points/select.h"
#include "approx/shape/shape.h"
#include "approx/support/support.h"
#include "base/chunks.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* How far into its cell a node is looked for, as a share of the way to the middle. */
static const double into_cell = 1e-3;

enum { POINTS_FOR_THREAD = 4000 }; /* see chunks_of */

enum status field_spacing(const struct cells *cells, double *spacing, struct error *error)
{
    SCRATCH double *nearest = NULL;
    bool complete = cells->count > 0;
    if (cells->count > 0) {
        RETURN_IF_ERROR(cells_node_spacing(cells, NULL, spacing, error));
        for (int64_t n = 0; n < cells->node_count; n++) {
            complete = complete && spacing[n] > 0.0;
        }
    }
    if (!complete) {
        RETURN_IF_ERROR(NEW_ARRAY(&nearest, cells->node_count, error));
        RETURN_IF_ERROR(nodes_spacing(cells->dim, cells->node_count, cells->x, nearest, error));
        for (int64_t n = 0; n < cells->node_count; n++) {
            if (cells->count == 0 || !(spacing[n] > 0.0)) {
                spacing[n] = nearest[n];
            }
        }
    }
    return STATUS_OK;
}

/* nearest[count]: the cell nearest to each point of x[count * dim], the first of several; -1: all are farther
 * than `within` times the largest spacing of their nodes. Where there are no cells, the node; -1: all are
 * farther than twice their spacing. */
static enum status find_nearest(const struct cells *cells, const double *spacing, double within,
                                int64_t count, const double *x, int64_t *nearest, struct error *error)
{
    int dim = cells->dim;
    struct items items = {dim, cells->count, dim + 1, cells->node, cells->x};
    if (cells->count == 0) {
        items = (struct items){dim, cells->node_count, 1, NULL, cells->x};
        within = 2.0;
    }
    NEW_SCRATCH(double, reach, items.count, error);
    for (int64_t i = 0; i < items.count * items.corners; i++) {
        double size = spacing[items.item != NULL ? items.item[i] : i];
        reach[i / items.corners] = fmax(reach[i / items.corners], (within + COARSE_ROUND_OFF) * size);
    }
    return items_nearest(&items, reach, count, x, nearest, error);
}

enum status field_outside(const struct cells *cells, const double *spacing, double within, int64_t count,
                          const double *x, bool *outside, struct error *error)
{
    NEW_SCRATCH(int64_t, nearest, count, error);
    RETURN_IF_ERROR(find_nearest(cells, spacing, within, count, x, nearest, error));
    for (int64_t p = 0; p < count; p++) {
        outside[p] = nearest[p] < 0;
    }
    return STATUS_OK;
}

enum status field_table_at(const struct field_shapes *shapes, const struct visibility *space,
                           const struct visibility_places *places, int64_t count, const double *x,
                           const char *what, bool gradients, struct field_table *table, struct error *error)
{
    *table = (struct field_table){0};
    RETURN_IF_ERROR(support_build(&shapes->support, space, places, count, x, what, &table->lists, error));
    RETURN_IF_ERROR(NEW_ARRAY(&table->phi, table->lists.ptr[count], error));
    if (gradients) {
        RETURN_IF_ERROR(NEW_ARRAY(&table->dphi, table->lists.ptr[count] * space->cells.dim, error));
    }
    return shape_table(&shapes->shapes, space->cells.x, space->supports, &table->lists, x, what, table->phi,
                       table->dphi, error);
}

enum status field_table_build(const struct field_shapes *shapes, const struct cells *cells,
                              const int32_t *cell, int64_t count, const double *x, const char *what,
                              struct field_table *table, struct error *error)
{
    struct visibility_places places = {.cell = cell, .points_per_row = 1};
    FREED_BY(visibility_free) struct visibility space = {0};
    *table = (struct field_table){0};
    RETURN_IF_ERROR(visibility_build(cells, shapes->supports, shapes->support.visibility,
                                     shapes->support.side, &space, error));
    return field_table_at(shapes, &space, &places, count, x, what, false, table, error);
}

void field_table_free(struct field_table *table)
{
    support_free(&table->lists);
    FREE_ALL(table->phi, table->dphi);
    *table = (struct field_table){0};
}

void field_evaluate(int64_t count, const int64_t *ptr, const int32_t *idx, const double *phi, int64_t cols,
                    const double *field, double *values)
{
#pragma omp parallel for schedule(static) num_threads(chunks_of(count, POINTS_FOR_THREAD).threads)
    for (int64_t p = 0; p < count; p++) {
        double *row = values + p * cols;
        for (int64_t c = 0; c < cols; c++) {
            row[c] = 0.0;
        }
        for (int64_t i = ptr[p]; i < ptr[p + 1]; i++) {
            for (int64_t c = 0; c < cols; c++) {
                row[c] += phi[i] * field[idx[i] * cols + c];
            }
        }
    }
}

/* value[cols] at x[dim]: linear interpolation of the values at the nodes of a cell. */
static void interpolate_in_cell(const struct cells *cells, int64_t cell, int64_t cols, const double *values,
                                const double *x, double *value)
{
    const int32_t *node = cells->node + cell * (cells->dim + 1);
    double coordinate[4];
    cell_barycentric(cells, cell, x, coordinate);
    for (int64_t c = 0; c < cols; c++) {
        value[c] = 0.0;
        for (int k = 0; k <= cells->dim; k++) {
            value[c] += coordinate[k] * values[node[k] * cols + c];
        }
    }
}

enum status field_cells_at_nodes(const struct cells *from, const double *spacing, double within,
                                 const struct cells *to, int64_t *cell, double *inward, struct error *error)
{
    int dim = to->dim;
    memcpy(inward, to->x, (size_t)(to->node_count * dim) * sizeof *inward);
    for (int64_t i = to->count * (dim + 1) - 1; i >= 0; i--) { /* towards the middle of its first cell */
        double middle[3];
        int64_t node = to->node[i];
        cell_centroid(to, i / (dim + 1), middle);
        vector_between(dim, to->x + node * dim, middle, into_cell, inward + node * dim);
    }
    return find_nearest(from, spacing, within, to->node_count, inward, cell, error);
}

enum status field_carry(const struct cells *from, int64_t cols, const double *values, const struct cells *to,
                        double *result, struct error *error)
{
    int dim = to->dim;
    if (from->count == 0) {
        return fail(error, STATUS_INPUT, "no cells, within which the field is interpolated");
    }
    NEW_SCRATCH(double, spacing, from->node_count, error);
    NEW_SCRATCH(double, inward, to->node_count * dim, error);
    NEW_SCRATCH(int64_t, cell, to->node_count, error);
    RETURN_IF_ERROR(field_spacing(from, spacing, error));
    RETURN_IF_ERROR(field_cells_at_nodes(from, spacing, FIELD_MARGIN, to, cell, inward, error));
    for (int64_t n = 0; n < to->node_count; n++) {
        const double *x = to->x + n * dim;
        if (cell[n] < 0) {
            return fail(error, STATUS_INPUT, "node %lld at %s is far from all its cells", (long long)n,
                        POINT_TEXT(dim, x));
        }
        interpolate_in_cell(from, cell[n], cols, values, x, result + n * cols);
    }
    return STATUS_OK;
}

/* x[FIELD_TURNING_POINTS * dim]: the points within a cell whose barycentric coordinates are sixth[] / 6. */
static void place_points(const struct cells *cells, int64_t cell, double *x)
{
    int dim = cells->dim;
    const double *corner[4];
    cell_corners(cells, cell, corner);
    for (int n = 0; n < (dim == 2 ? 16 : 64); n++) {
        int sixth[4] = {0, n % 4 + 1, n / 4 % 4 + 1, dim == 2 ? 0 : n / 16 + 1};
        sixth[0] = 6 - sixth[1] - sixth[2] - sixth[3];
        for (int i = 0; i < dim && sixth[0] > 0; i++) {
            *x = 0.0;
            for (int k = 0; k <= dim; k++) {
                *x += sixth[k] / 6.0 * corner[k][i];
            }
            x++;
        }
    }
}

/* det (I + grad u) at point p of a table of gradients. */
static double determinant_at(int dim, const struct field_table *table, int64_t p, const double *u)
{
    double F[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int64_t j = table->lists.ptr[p]; j < table->lists.ptr[p + 1]; j++) {
        for (int i = 0; i < dim; i++) {
            for (int k = 0; k < dim; k++) {
                F[i][k] += u[(int64_t)table->lists.idx[j] * dim + i] * table->dphi[j * dim + k];
            }
        }
    }
    return dim == 2 ? determinant2(F[0], F[1]) : determinant3(F[0], F[1], F[2]);
}

enum status field_least_determinants(const struct field_shapes *shapes, const struct visibility *space,
                                     int64_t count, const int32_t *cell, const double *u, double *least,
                                     struct error *error)
{
    const struct cells *cells = &space->cells;
    int64_t points = count * FIELD_TURNING_POINTS;
    struct visibility_places places = {.cell = cell, .points_per_row = FIELD_TURNING_POINTS};
    FREED_BY(field_table_free) struct field_table table = {0};
    NEW_SCRATCH(double, x, points * cells->dim, error);
    for (int64_t i = 0; i < count; i++) {
        place_points(cells, cell[i], x + i * FIELD_TURNING_POINTS * cells->dim);
    }
    RETURN_IF_ERROR(
        field_table_at(shapes, space, &places, points, x, "points within cells", true, &table, error));
    for (int64_t p = 0; p < points; p++) {
        double determinant = determinant_at(cells->dim, &table, p, u);
        double *lowest = &least[p / FIELD_TURNING_POINTS];
        if (p % FIELD_TURNING_POINTS == 0 || determinant < *lowest || isnan(determinant)) {
            *lowest = determinant;
        }
    }
    return STATUS_OK;
}
