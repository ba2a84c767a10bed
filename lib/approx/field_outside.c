#include "approx/field.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* A point nearer to a cell than this share of its size counts as inside. */
static const double in_cell = 1e-9;

static double dot(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Barycentric coordinates of the projection of x on the plane through corner[0 .. order], by Cramer's rule on
 * the Gram matrix of the edges. */
static void project(int dim, int order, const double *const *corner, const double *x, double *place)
{
    double edge[3][3], from[3], gram[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, right[3] = {0.0, 0.0, 0.0};
    for (int d = 0; d < dim; d++) {
        from[d] = x[d] - corner[0][d];
        for (int k = 0; k < order; k++) {
            edge[k][d] = corner[k + 1][d] - corner[0][d];
        }
    }
    for (int k = 0; k < order; k++) {
        right[k] = dot(dim, edge[k], from);
        for (int l = 0; l < order; l++) {
            gram[3 * k + l] = dot(dim, edge[k], edge[l]);
        }
    }
    double minor[3] = {gram[4] * gram[8] - gram[5] * gram[7], gram[5] * gram[6] - gram[3] * gram[8],
                       gram[3] * gram[7] - gram[4] * gram[6]};
    double determinant = gram[0] * minor[0] + gram[1] * minor[1] + gram[2] * minor[2];
    double cofactor[9] = {minor[0],
                          minor[1],
                          minor[2],
                          gram[2] * gram[7] - gram[1] * gram[8],
                          gram[0] * gram[8] - gram[2] * gram[6],
                          gram[1] * gram[6] - gram[0] * gram[7],
                          gram[1] * gram[5] - gram[2] * gram[4],
                          gram[2] * gram[3] - gram[0] * gram[5],
                          gram[0] * gram[4] - gram[1] * gram[3]};
    place[0] = 1.0;
    for (int k = 0; k < order; k++) {
        place[k + 1] = dot(3, cofactor + 3 * k, right) / determinant;
        place[0] -= place[k + 1];
    }
}

/* Squared distance of x from the simplex of corner[0 .. order]. Its nearest place is in the simplex, or in a
 * face beyond which the projection of x lies. */
static double distance2(int dim, int order, const double *const *corner, const double *x)
{
    double place[4] = {1.0}, least = INFINITY, offset[3];
    if (order > 0) {
        project(dim, order, corner, x, place);
    }
    for (int k = 0; k <= order; k++) {
        if (place[k] < -in_cell) {
            const double *face[3];
            for (int l = 0; l < order; l++) {
                face[l] = corner[l + (l >= k)];
            }
            least = fmin(least, distance2(dim, order - 1, face, x));
        }
    }
    if (isinf(least)) {
        for (int d = 0; d < dim; d++) {
            offset[d] = -x[d];
            for (int k = 0; k <= order; k++) {
                offset[d] += place[k] * corner[k][d];
            }
        }
        least = dot(dim, offset, offset);
    }
    return least;
}

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
            double sum = 0.0;
            for (int d = 0; d < dim; d++) {
                double offset = cells->x[node * dim + d] - centre[c * dim + d];
                sum += offset * offset;
            }
            radius[c] = fmax(radius[c], sqrt(sum));
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
            for (int k = 0; k <= dim; k++) {
                corner[k] = cells->x + (int64_t)cells->node[c * (dim + 1) + k] * dim;
            }
            double most = (within + in_cell) * size[c];
            outside[p] = !(distance2(dim, dim, corner, x + p * dim) <= most * most);
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
