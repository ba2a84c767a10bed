#include "approx/field/field_turning.h"

#include "approx/shape/shape.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

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
static double determinant_at(int dim, const struct neighbours *lists, int64_t p, const double *dphi,
                             const double *u)
{
    double F[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int64_t j = lists->ptr[p]; j < lists->ptr[p + 1]; j++) {
        for (int i = 0; i < dim; i++) {
            for (int k = 0; k < dim; k++) {
                F[i][k] += u[(int64_t)lists->idx[j] * dim + i] * dphi[j * dim + k];
            }
        }
    }
    return dim == 2 ? determinant2(F[0], F[1]) : determinant3(F[0], F[1], F[2]);
}

enum status field_least_determinants(const struct support_options *options, const struct mls *shapes,
                                     const struct support_space *space, int64_t count, const int32_t *cell,
                                     const double *u, double *least, struct error *error)
{
    static const char what[] = "points within cells";
    const struct cells *cells = &space->cells;
    int64_t points = count * FIELD_TURNING_POINTS;
    struct visibility_places places = {.cell = cell, .points_per_row = FIELD_TURNING_POINTS};
    FREED_BY(support_free) struct support_lists table = {0};
    NEW_SCRATCH(double, x, points * cells->dim, error);
    for (int64_t i = 0; i < count; i++) {
        place_points(cells, cell[i], x + i * FIELD_TURNING_POINTS * cells->dim);
    }
    RETURN_IF_ERROR(support_build(options, space, &places, points, x, what, &table, error));
    NEW_SCRATCH(double, phi, table.ptr[points], error);
    NEW_SCRATCH(double, dphi, table.ptr[points] * cells->dim, error);
    struct neighbours lists = support_view(&table);
    RETURN_IF_ERROR(shape_table(shapes != NULL ? shapes : &options->mls, cells->x, space->radius, &lists, x,
                                what, phi, dphi, error));
    for (int64_t p = 0; p < points; p++) {
        double determinant = determinant_at(cells->dim, &lists, p, dphi, u);
        double *lowest = &least[p / FIELD_TURNING_POINTS];
        if (p % FIELD_TURNING_POINTS == 0 || determinant < *lowest || isnan(determinant)) {
            *lowest = determinant;
        }
    }
    return STATUS_OK;
}
