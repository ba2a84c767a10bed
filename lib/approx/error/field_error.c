#include "approx/error/field_error.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

double field_error_share(double ratio, double order)
{
    return 1.0 / (pow(ratio, order) - 1.0);
}

double field_error_order(double fine, double coarse, double ratio)
{
    double order = log(coarse / fine) / log(ratio);
    if (fine == 0.0 || !isfinite(order)) {
        return FIELD_ERROR_MOST_ORDER;
    }
    return fmin(fmax(order, FIELD_ERROR_LEAST_ORDER), FIELD_ERROR_MOST_ORDER);
}

double field_error_ratio(const struct cells *fine, const struct cells *coarse)
{
    bool both = fine->count > 0 && coarse->count > 0;
    double f = (double)(both ? fine->count : fine->node_count);
    double c = (double)(both ? coarse->count : coarse->node_count);
    return pow(f / c, 1.0 / fine->dim);
}

double field_error_mean(const struct cells *cells, const double *value)
{
    double sum = 0.0, volume = 0.0;
    for (int64_t q = 0; q < cells->count; q++) {
        double mean = 0.0, part = cell_volume(cells, q);
        for (int k = 0; k <= cells->dim; k++) {
            mean += value[cells->node[q * (cells->dim + 1) + k]] / (cells->dim + 1);
        }
        if (!isnan(mean)) {
            sum += part * mean;
            volume += part;
        }
    }
    return volume > 0.0 ? sum / volume : NAN;
}

/* gradient[cols * dim] of the linear interpolant in a cell: the gradient of the shape function of a vertex is
 * the inward area vector of the opposite face over dim times the volume. */
static void cell_gradient(const struct cells *cells, int64_t cell, int64_t cols, const double *values,
                          double *gradient)
{
    int dim = cells->dim;
    memset(gradient, 0, (size_t)(cols * dim) * sizeof *gradient);
    for (int k = 0; k <= dim; k++) {
        const double *value = values + cells->node[cell * (dim + 1) + k] * cols;
        int32_t face[3];
        double area[3];
        cell_face(cells, cell, k, face);
        face_area_vector(dim, cells->x, face, area);
        for (int64_t c = 0; c < cols; c++) {
            add_scaled(dim, -value[c] / (dim * cell_volume(cells, cell)), area, gradient + c * dim);
        }
    }
}

/* Integral of the square of a linear function with `values` at the dim + 1 vertices of a cell. */
static double integral_of_square(int dim, double volume, const double *values)
{
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k <= dim; k++) {
        sum += values[k];
        squares += values[k] * values[k];
    }
    return volume * (sum * sum + squares) / ((dim + 1) * (dim + 2));
}

/* squared[] of the cells of one region; recovered[node_count * size] and volume[node_count] are scratch. */
static void recover_region(const struct cells *cells, const int32_t *region, int32_t chosen, int64_t size,
                           const double *gradient, double *recovered, double *volume, double *squared)
{
    int corners = cells->dim + 1;
    memset(recovered, 0, (size_t)(cells->node_count * size) * sizeof *recovered);
    memset(volume, 0, (size_t)cells->node_count * sizeof *volume);
    for (int64_t q = 0; q < cells->count; q++) {
        double part = region != NULL && region[q] != chosen ? 0.0 : cell_volume(cells, q);
        for (int k = 0; k < corners && part > 0.0; k++) {
            int64_t n = cells->node[q * corners + k];
            volume[n] += part;
            for (int64_t i = 0; i < size; i++) {
                recovered[n * size + i] += part * gradient[q * size + i];
            }
        }
    }
    for (int64_t q = 0; q < cells->count; q++) {
        if (region != NULL && region[q] != chosen) {
            continue;
        }
        squared[q] = 0.0;
        for (int64_t i = 0; i < size; i++) {
            double off[4];
            for (int k = 0; k < corners; k++) {
                int64_t n = cells->node[q * corners + k];
                off[k] = recovered[n * size + i] / volume[n] - gradient[q * size + i];
            }
            squared[q] += integral_of_square(cells->dim, cell_volume(cells, q), off);
        }
    }
}

enum status field_error_recovered(const struct cells *cells, const int32_t *region, int32_t region_count,
                                  int64_t cols, const double *values, double *squared, struct error *error)
{
    int64_t size = cols * cells->dim;
    for (int64_t i = 0; i < cells->node_count * cols; i++) {
        if (!isfinite(values[i])) {
            return fail(error, STATUS_INPUT, "row %lld: not a finite number", (long long)(i / cols));
        }
    }
    NEW_SCRATCH(double, gradient, cells->count * size, error);
    NEW_SCRATCH(double, recovered, cells->node_count * size, error);
    NEW_SCRATCH(double, volume, cells->node_count, error);
    for (int64_t q = 0; q < cells->count; q++) {
        cell_gradient(cells, q, cols, values, gradient + q * size);
    }
    for (int32_t r = 0; r < (region != NULL ? region_count : 1); r++) {
        recover_region(cells, region, r, size, gradient, recovered, volume, squared);
    }
    return STATUS_OK;
}
