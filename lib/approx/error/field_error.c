#include "approx/error/field_error.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

double field_error_share(double ratio, double order)
{
    return 1.0 / (pow(ratio, order) - 1.0);
}

double field_error_order(double fine, double coarse, double ratio, double least)
{
    double order = log(coarse / fine) / log(ratio);
    if (fine == 0.0 || !isfinite(order)) {
        return FIELD_ERROR_MOST_ORDER;
    }
    return fmin(fmax(order, least), FIELD_ERROR_MOST_ORDER);
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

/* ---- sizes ---- */

/* The order of the error of the gradient. */
#define GRADIENT_ORDER (FIELD_ERROR_MOST_ORDER - 1.0)

/* A node is at a corner, not on a curve, if the normals of the node and of a facet there differ by more than
 * this angle, radians, or if the least such angle at the facet's nodes is below this share of it. */
static const double corner_angle = 0.7, corner_share = 0.25;

/* The factor on a cell's size, now `size`, that gives the cell the error `equal`. */
static double cell_factor(const struct cells *cells, double squared, double size, double equal, double least)
{
    double factor = SIZE_FIELD_MOST;
    if (squared > 0.0) {
        factor = pow(equal / sqrt(squared), 1.0 / (GRADIENT_ORDER + 0.5 * cells->dim));
    }
    return fmin(fmax(factor, fmax(SIZE_FIELD_LEAST, least / size)), SIZE_FIELD_MOST);
}

static double cell_size(const struct cells *cells, const double *spacing, int64_t q)
{
    double sum = 0.0;
    for (int k = 0; k <= cells->dim; k++) {
        sum += spacing[cells->node[q * (cells->dim + 1) + k]];
    }
    return sum / (cells->dim + 1);
}

/* The error e of all cells for which sum e_K^2 falls to its wanted share, by bisection. Cells that already
 * have the least size are left out, as refining others cannot reduce their error. */
static double equal_error(const struct cells *cells, const double *squared, const double *spacing,
                          const struct size_field_request *request)
{
    double wanted = 0.0, largest = 0.0;
    for (int64_t q = 0; q < cells->count; q++) {
        bool bound = cell_size(cells, spacing, q) * sqrt(request->share) < request->least;
        wanted += bound ? 0.0 : request->share * squared[q];
        largest = fmax(largest, squared[q]);
    }
    double low = 1e-6 * sqrt(largest), high = 1e6 * sqrt(largest);
    for (int step = 0; step < 60 && largest > 0.0; step++) {
        double middle = sqrt(low * high), after = 0.0;
        for (int64_t q = 0; q < cells->count; q++) {
            double size = cell_size(cells, spacing, q);
            bool bound = size * sqrt(request->share) < request->least;
            double factor = cell_factor(cells, squared[q], size, middle, request->least);
            after += bound ? 0.0 : squared[q] * pow(factor, 2.0 * GRADIENT_ORDER);
        }
        *(after >= wanted ? &high : &low) = middle;
    }
    return low;
}

/* size[node_count]: the spacing times the geometric mean of the factors of the cells at each node. */
static enum status node_sizes(const struct cells *cells, const double *squared, const double *spacing,
                              const struct size_field_request *request, double *size, struct error *error)
{
    double equal = equal_error(cells, squared, spacing, request);
    NEW_SCRATCH(int64_t, count, cells->node_count, error);
    for (int64_t q = 0; q < cells->count; q++) {
        double now = cell_size(cells, spacing, q);
        double factor = cell_factor(cells, squared[q], now, equal, request->least);
        for (int k = 0; k <= cells->dim; k++) {
            int64_t n = cells->node[q * (cells->dim + 1) + k];
            size[n] += log(factor);
            count[n]++;
        }
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        if (count[n] == 0) {
            return fail(error, STATUS_INPUT, "node %lld belongs to no cell", (long long)n);
        }
        size[n] = spacing[n] * exp(size[n] / (double)count[n]);
    }
    return STATUS_OK;
}

/* normal[node_count * dim]: sum of the area vectors of the facets at each node of the boundary. */
static void boundary_normals(const struct cells *cells, const struct faces *faces, double *normal)
{
    int dim = cells->dim;
    for (int64_t f = 0; f < faces->boundary_count; f++) {
        double vector[3];
        face_area_vector(dim, cells->x, faces->node + f * dim, vector);
        for (int k = 0; k < dim; k++) {
            add_scaled(dim, 1.0, vector, normal + faces->node[f * dim + k] * dim);
        }
    }
}

/* Angle between two vectors. */
static double angle_between(int dim, const double *u, const double *v)
{
    double lengths = sqrt(vector_dot(dim, u, u) * vector_dot(dim, v, v));
    return acos(fmin(fmax(vector_dot(dim, u, v) / lengths, -1.0), 1.0));
}

/* angle[node_count]: the largest between the boundary's normal at a node and those of its facets. */
static void boundary_angles(const struct cells *cells, const struct faces *faces, const double *normal,
                            double *angle)
{
    int dim = cells->dim;
    for (int64_t f = 0; f < faces->boundary_count; f++) {
        const int32_t *node = faces->node + f * dim;
        double vector[3];
        face_area_vector(dim, cells->x, node, vector);
        for (int k = 0; k < dim; k++) {
            angle[node[k]] = fmax(angle[node[k]], angle_between(dim, vector, normal + node[k] * dim));
        }
    }
}

/* Limit sizes by the sag of facets. A chord of length h has the sag h^2 / (8 R) on a curve of radius R. The
 * normal turns by d / R between a node and the middle of a facet at the distance d. */
static void limit_sag(const struct cells *cells, const struct faces *faces, const double *angle, double sag,
                      double *size)
{
    int dim = cells->dim;
    for (int64_t f = 0; f < faces->boundary_count; f++) {
        const int32_t *node = faces->node + f * dim;
        double middle[3],
            least_angle = 0.0; /* over the nodes of the facet; small next to a corner of flat sides */
        for (int k = 0; k < dim; k++) {
            least_angle = k == 0 ? angle[node[k]] : fmin(least_angle, angle[node[k]]);
        }
        vector_middle(dim, cells->x, dim, node, middle);
        for (int k = 0; k < dim; k++) {
            double distance = vector_distance(dim, middle, cells->x + node[k] * dim);
            if (angle[node[k]] > 0.0 && angle[node[k]] < corner_angle &&
                least_angle > corner_share * angle[node[k]]) {
                size[node[k]] = fmin(size[node[k]], sqrt(8.0 * sag * distance / angle[node[k]]));
            }
        }
    }
}

/* outer[node_count * dim]: the nodes of the boundary moved outward by half their spacing. */
static void move_outward(const struct cells *cells, const double *normal, const double *spacing,
                         double *outer)
{
    int dim = cells->dim;
    for (int64_t n = 0; n < cells->node_count; n++) {
        double length = vector_length(dim, normal + n * dim);
        for (int a = 0; a < dim; a++) {
            double shift = length > 0.0 ? 0.5 * spacing[n] * normal[n * dim + a] / length : 0.0;
            outer[n * dim + a] = cells->x[n * dim + a] + shift;
        }
    }
}

/* Limit the change of sizes along each edge to the gradation. */
static void limit_gradation(const struct cells *cells, double *size)
{
    int dim = cells->dim;
    bool changed = true;
    while (changed) {
        changed = false;
        for (int64_t q = 0; q < cells->count; q++) {
            const int32_t *node = cells->node + q * (dim + 1);
            for (int k = 0; k < (dim + 1) * (dim + 1); k++) {
                int32_t i = node[k / (dim + 1)], j = node[k % (dim + 1)];
                double length = vector_distance(dim, cells->x + i * dim, cells->x + j * dim);
                double most = size[i] + SIZE_FIELD_GRADATION * length;
                if (size[j] > most * (1.0 + 1e-9)) {
                    size[j] = most;
                    changed = true;
                }
            }
        }
    }
}

/* The number of nodes of a mesh of these sizes, predicted from the present one. */
static double predicted_nodes(const struct cells *cells, const double *spacing, const double *size)
{
    double sum = 0.0;
    for (int64_t q = 0; q < cells->count; q++) {
        double mean = 0.0;
        for (int k = 0; k <= cells->dim; k++) {
            int64_t n = cells->node[q * (cells->dim + 1) + k];
            mean += log(spacing[n] / size[n]) / (cells->dim + 1);
        }
        sum += exp(cells->dim * mean);
    }
    return sum * (double)cells->node_count / (double)cells->count;
}

enum status size_field_build(const struct cells *cells, const double *squared,
                             const struct size_field_request *request, struct size_field *field,
                             struct error *error)
{
    *field = (struct size_field){0};
    NEW_SCRATCH(double, spacing, cells->node_count, error);
    NEW_SCRATCH(double, normal, cells->node_count * cells->dim, error);
    NEW_SCRATCH(double, angle, cells->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&field->size, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&field->outer, cells->node_count * cells->dim, error));
    RETURN_IF_ERROR(faces_build(cells, true, &field->boundary, error));
    RETURN_IF_ERROR(cells_node_spacing(cells, NULL, spacing, error));
    RETURN_IF_ERROR(node_sizes(cells, squared, spacing, request, field->size, error));
    boundary_normals(cells, &field->boundary, normal);
    move_outward(cells, normal, spacing, field->outer);
    /* On the boundary at most the present ones: the estimate does not include the error of its shape. */
    for (int64_t i = 0; i < field->boundary.boundary_count * cells->dim; i++) {
        int32_t n = field->boundary.node[i];
        field->size[n] = fmin(field->size[n], spacing[n]);
    }
    if (request->sag > 0.0) {
        boundary_angles(cells, &field->boundary, normal, angle);
        limit_sag(cells, &field->boundary, angle, request->sag, field->size);
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        field->size[n] = fmax(field->size[n], request->least);
    }
    limit_gradation(cells, field->size);
    field->nodes = field->unbound = predicted_nodes(cells, spacing, field->size);
    if (field->unbound > request->most_nodes) {
        double larger = pow(field->unbound / request->most_nodes, 1.0 / cells->dim);
        for (int64_t n = 0; n < cells->node_count; n++) {
            field->size[n] *= larger;
        }
        field->nodes = request->most_nodes;
    }
    return STATUS_OK;
}

void size_field_free(struct size_field *field)
{
    FREE_ALL(field->size, field->outer);
    faces_free(&field->boundary);
    *field = (struct size_field){0};
}
