#include "approx/field/field_compare.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* middle[node_count * dim]: the mean of the centroids of the cells at each node, which tells the sides of a
 * slit apart; without cells the node itself. */
static enum status find_middles(const struct cells *cells, double *middle, struct error *error)
{
    int dim = cells->dim, corners = dim + 1;
    NEW_SCRATCH(int64_t, count, cells->node_count, error);
    for (int64_t i = 0; i < cells->count * corners; i++) {
        count[cells->node[i]]++;
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        memcpy(middle + n * dim, cells->x + n * dim, (size_t)(count[n] == 0 ? dim : 0) * sizeof *middle);
    }
    for (int64_t i = 0; i < cells->count * corners; i++) {
        double centroid[3];
        cell_centroid(cells, i / corners, centroid);
        add_scaled(dim, 1.0 / (double)count[cells->node[i]], centroid,
                   middle + (int64_t)cells->node[i] * dim);
    }
    return STATUS_OK;
}

/* match[]: for each node of cloud A the node of cloud B at the same place, within 1e-9 of the larger extent
 * of the clouds, of several that on the same side; each is used once. *matched: false if the counts differ or
 * a node of A has none; match[] is then undefined. */
static enum status match_nodes(const struct cells *a_cells, const struct cells *b_cells, int32_t *match,
                               bool *matched, struct error *error)
{
    int dim = a_cells->dim;
    int64_t a_count = a_cells->node_count, b_count = b_cells->node_count;
    const double *a = a_cells->x, *b = b_cells->x;
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list list = {0};
    struct box box = box_of(dim, a_count, a);
    box_add(&box, b_count, b);
    *matched = a_count == b_count;
    if (!*matched) {
        return STATUS_OK;
    }
    NEW_SCRATCH(double, radius, b_count, error);
    NEW_SCRATCH(bool, used, b_count, error);
    NEW_SCRATCH(double, a_middle, a_count * dim, error);
    NEW_SCRATCH(double, b_middle, b_count * dim, error);
    RETURN_IF_ERROR(find_middles(a_cells, a_middle, error));
    RETURN_IF_ERROR(find_middles(b_cells, b_middle, error));
    for (int64_t n = 0; n < b_count; n++) {
        radius[n] = fmax(1e-9 * box_side(&box) * sqrt((double)dim), 1e-100);
    }
    RETURN_IF_ERROR(point_grid_build(&grid, dim, b_count, b, radius, error));
    for (int64_t n = 0; n < a_count && *matched; n++) {
        list.count = 0;
        RETURN_IF_ERROR(point_grid_query(&grid, a + n * dim, 1.0, &list, error));
        double nearest2 = INFINITY;
        *matched = false;
        for (int64_t i = 0; i < list.count; i++) {
            int32_t other = list.index[i];
            double away2 = vector_distance2(dim, a_middle + n * dim, b_middle + (int64_t)other * dim);
            if (!used[other] && away2 < nearest2) {
                nearest2 = away2;
                match[n] = other;
                *matched = true;
            }
        }
        if (*matched) {
            used[match[n]] = true;
        }
    }
    return STATUS_OK;
}

double field_largest(int64_t count, int64_t cols, const double *field)
{
    double largest2 = 0.0;
    for (int64_t i = 0; i < count; i++) {
        double sum = vector_dot((int)cols, field + i * cols, field + i * cols);
        if (isnan(sum)) {
            return NAN;
        }
        largest2 = fmax(largest2, sum);
    }
    return sqrt(largest2);
}

enum status field_statistics(int64_t count, const int64_t *index, const double *difference,
                             struct field_statistics *statistics, struct error *error)
{
    double sum = 0.0, sum2 = 0.0;
    bool unknown = count == 0;
    *statistics = (struct field_statistics){.count = count};
    RETURN_IF_ERROR(NEW_ARRAY(&statistics->sorted, count, error));
    for (int64_t i = 0; i < count; i++) {
        double d = difference[index[i]];
        statistics->sorted[i] = d;
        unknown = unknown || isnan(d);
        sum += d;
        sum2 += d * d;
        if (i == 0 || d > statistics->largest || (isnan(d) && !isnan(statistics->largest))) {
            statistics->largest = d;
            statistics->largest_at = index[i];
        }
    }
    statistics->average = sum / (double)count;
    statistics->rmse = sqrt(sum2 / (double)count);
    if (unknown) {
        statistics->average = statistics->largest = statistics->rmse = NAN;
        for (int64_t i = 0; i < count; i++) {
            statistics->sorted[i] = NAN;
        }
    } else {
        gsl_sort(statistics->sorted, 1, (size_t)count);
    }
    return STATUS_OK;
}

void field_statistics_free(struct field_statistics *statistics)
{
    free(statistics->sorted);
    *statistics = (struct field_statistics){0};
}

double field_percentile(const struct field_statistics *statistics, double percent)
{
    return statistics->count > 0 ? gsl_stats_quantile_from_sorted_data(
                                       statistics->sorted, 1, (size_t)statistics->count, percent / 100.0)
                                 : NAN;
}

/* Drop the chosen nodes that have no nearest cell of B, or fail on the first. points: the coordinates of
 * those kept. */
static enum status drop_outside(const struct nodal_field *a, const int64_t *nearest, bool skip,
                                struct field_comparison *comparison, double *points, struct error *error)
{
    int dim = a->cells.dim;
    int64_t kept = 0, first = -1;
    for (int64_t i = 0; i < comparison->count; i++) {
        if (nearest[comparison->node[i]] >= 0) {
            memcpy(points + kept * dim, a->cells.x + comparison->node[i] * dim, (size_t)dim * sizeof *points);
            comparison->node[kept++] = comparison->node[i];
        } else if (first < 0) {
            first = comparison->node[i];
        }
    }
    comparison->outside = comparison->count - kept;
    comparison->count = kept;
    if (comparison->outside > 0 && !skip) {
        return fail(
            error, STATUS_INPUT, "%lld nodes of A lie outside of B's cloud, the first is row %lld at %s",
            (long long)comparison->outside, (long long)first, POINT_TEXT(dim, a->cells.x + first * dim));
    }
    return STATUS_OK;
}

/* cell[comparison->count]: the cell of B that each point, a compared node of A, lies in, on the side of its
 * cells in A; -1: in none. A node that is only beside that cell is moved into its own one, by a thousandth.
 */
static void find_cells(const struct cells *b, const struct field_comparison *comparison,
                       const int64_t *nearest, const double *inward, double *points, int32_t *cell)
{
    int dim = b->dim;
    for (int64_t i = 0; i < comparison->count; i++) {
        int64_t node = comparison->node[i];
        cell[i] = (int32_t)nearest[node];
        if (!cell_contains(b, cell[i], points + i * dim, -COARSE_ROUND_OFF)) {
            bool inside = cell_contains(b, cell[i], inward + node * dim, -COARSE_ROUND_OFF);
            memcpy(points + i * dim, inward + node * dim, (size_t)(inside ? dim : 0) * sizeof *points);
            cell[i] = inside ? cell[i] : -1;
        }
    }
}

/* B's field at the chosen nodes of A. */
static enum status interpolate(const struct nodal_field *a, const struct nodal_field *b, bool skip,
                               struct field_comparison *comparison, double *reference, struct error *error)
{
    struct field_shapes fit = {.support = support_defaults(a->cells.dim)};
    FREED_BY(field_table_free) struct field_table table = {0};
    NEW_SCRATCH(double, spacing, b->cells.node_count, error);
    NEW_SCRATCH(double, radius, b->cells.node_count, error);
    NEW_SCRATCH(double, points, a->cells.node_count * a->cells.dim, error);
    NEW_SCRATCH(double, inward, a->cells.node_count * a->cells.dim, error);
    NEW_SCRATCH(int64_t, nearest, a->cells.node_count, error);
    NEW_SCRATCH(double, values, a->cells.node_count * a->cols, error);
    RETURN_IF_ERROR(field_spacing(&b->cells, spacing, error));
    RETURN_IF_ERROR(
        field_cells_at_nodes(&b->cells, spacing, FIELD_MARGIN, &a->cells, nearest, inward, error));
    RETURN_IF_ERROR(drop_outside(a, nearest, skip, comparison, points, error));
    RETURN_IF_ERROR(support_radii(&fit.support, b->cells.node_count, spacing, radius, error));
    fit.supports.radius = radius;
    fit.shapes = fit.support.mls;
    bool sides = a->cells.count > 0 && b->cells.count > 0;
    NEW_SCRATCH(int32_t, cell, comparison->count, error);
    if (sides) {
        find_cells(&b->cells, comparison, nearest, inward, points, cell);
    }
    RETURN_IF_ERROR(field_table_build(b->shapes != NULL ? b->shapes : &fit, &b->cells, sides ? cell : NULL,
                                      comparison->count, points, "nodes of A within B", &table, error));
    field_evaluate(comparison->count, table.lists.ptr, table.lists.idx, table.phi, b->cols,
                   b->parameters != NULL ? b->parameters : b->values, values);
    for (int64_t i = 0; i < comparison->count; i++) {
        memcpy(reference + comparison->node[i] * b->cols, values + i * b->cols,
               (size_t)b->cols * sizeof *values);
    }
    return STATUS_OK;
}

enum status field_compare(const struct nodal_field *a, const struct nodal_field *b, const bool *chosen,
                          bool skip_outside, struct field_comparison *comparison, struct error *error)
{
    int64_t count = a->cells.node_count, cols = a->cols;
    SCRATCH double *reference = NULL; /* B's values at the nodes of A */
    *comparison = (struct field_comparison){0};
    NEW_SCRATCH(int32_t, match, count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&reference, count * cols, error));
    RETURN_IF_ERROR(NEW_ARRAY(&comparison->node, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&comparison->difference, count, error));
    for (int64_t n = 0; n < count; n++) {
        if (chosen == NULL || chosen[n]) {
            comparison->node[comparison->count++] = n;
        }
    }
    for (int64_t i = 0; i < count * cols; i++) {
        reference[i] = NAN;
    }
    RETURN_IF_ERROR(match_nodes(&a->cells, &b->cells, match, &comparison->coincide, error));
    if (comparison->coincide) {
        for (int64_t i = 0; i < comparison->count; i++) {
            int64_t node = comparison->node[i];
            memcpy(reference + node * cols, b->values + match[node] * cols, (size_t)cols * sizeof(double));
        }
    } else {
        enum status status = interpolate(a, b, skip_outside, comparison, reference, error);
        RETURN_IF_ERROR(status == STATUS_VERDICT ? STATUS_INPUT
                                                 : status); /* not comparable is not "differs" */
    }
    for (int64_t i = 0; i < count; i++) { /* not finite wherever a value is not */
        comparison->difference[i] = vector_distance((int)cols, a->values + i * cols, reference + i * cols);
    }
    return STATUS_OK;
}

void field_comparison_free(struct field_comparison *comparison)
{
    FREE_ALL(comparison->node, comparison->difference);
    *comparison = (struct field_comparison){0};
}
