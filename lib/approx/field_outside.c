#include "approx/field.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* A point nearer to a cell than this share of its size counts as inside. */
static const double in_cell = 1e-9;

/* centre[count * dim] and radius[count], m: a ball around each cell that holds all that is nearer to it than
 * `within` times the largest spacing of its nodes, size[count]. */
static void enclose(const struct cells *cells, const double *spacing, double within, double *centre,
                    double *radius, double *size)
{
    int dim = cells->dim;
    for (int64_t c = 0; c < cells->count; c++) {
        cell_centroid(cells, c, centre + c * dim);
        for (int k = 0; k <= dim; k++) {
            int64_t node = cells->node[c * (dim + 1) + k];
            radius[c] = fmax(radius[c], vector_distance(dim, cells->x + node * dim, centre + c * dim));
            size[c] = fmax(size[c], spacing[node]);
        }
        radius[c] = (1.0 + 1e-6) * radius[c] + within * size[c];
    }
}

static enum status outside_of_cells(const struct cells *cells, const double *spacing, double within,
                                    int64_t count, const double *x, bool *outside, struct error *error)
{
    enum status status;
    int dim = cells->dim;
    struct point_grid grid = {0};
    struct index_list near = {0};
    double *centre = NULL, *radius = NULL, *size = NULL;
    TRY(NEW_ARRAY(&centre, cells->count * dim, error));
    TRY(NEW_ARRAY(&radius, cells->count, error));
    TRY(NEW_ARRAY(&size, cells->count, error));
    enclose(cells, spacing, within, centre, radius, size);
    TRY(point_grid_build(&grid, dim, cells->count, centre, radius, error));
    for (int64_t p = 0; p < count; p++) {
        near.count = 0;
        outside[p] = true;
        TRY(point_grid_query(&grid, x + p * dim, 1.0, &near, error));
        for (int64_t i = 0; i < near.count && outside[p]; i++) {
            const double *corner[4];
            int64_t c = near.index[i];
            cell_corners(cells, c, corner);
            double most = (within + in_cell) * size[c];
            outside[p] = !(simplex_distance2(dim, dim, corner, x + p * dim) <= most * most);
        }
    }
done:
    point_grid_free(&grid);
    free(near.index);
    free(centre);
    free(radius);
    free(size);
    return status;
}

enum status field_outside(const struct cells *cells, const double *spacing, double within, int64_t count,
                          const double *x, bool *outside, struct error *error)
{
    enum status status;
    struct point_grid grid = {0};
    struct index_list near = {0};
    if (cells->count > 0) {
        return outside_of_cells(cells, spacing, within, count, x, outside, error);
    }
    TRY(point_grid_build(&grid, cells->dim, cells->node_count, cells->x, spacing, error));
    for (int64_t p = 0; p < count; p++) {
        near.count = 0;
        TRY(point_grid_query(&grid, x + p * cells->dim, 2.0, &near, error));
        outside[p] = near.count == 0;
    }
done:
    point_grid_free(&grid);
    free(near.index);
    return status;
}
