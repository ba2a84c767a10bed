#include "approx/field.h"

#include "base/memory.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status field_spacing(const struct cells *cells, double *spacing, struct error *error)
{
    enum status status = STATUS_OK;
    double *nearest = NULL;
    bool complete = cells->count > 0;
    if (cells->count > 0) {
        TRY(cells_node_spacing(cells, spacing, error));
        for (int64_t n = 0; n < cells->node_count; n++) {
            complete = complete && spacing[n] > 0.0;
        }
    }
    if (!complete) {
        TRY(NEW_ARRAY(&nearest, cells->node_count, error));
        TRY(nodes_spacing(cells->dim, cells->node_count, cells->x, nearest, error));
        for (int64_t n = 0; n < cells->node_count; n++) {
            if (cells->count == 0 || !(spacing[n] > 0.0)) {
                spacing[n] = nearest[n];
            }
        }
    }
done:
    free(nearest);
    return status;
}

enum status field_first_outside(const struct point_grid *grid, int64_t from, int64_t count, const double *x,
                                int64_t *row, struct error *error)
{
    enum status status = STATUS_OK;
    struct index_list list = {0};
    for (*row = from; *row < count; ++*row) {
        list.count = 0;
        TRY(point_grid_query(grid, x + *row * grid->dim, 2.0, &list, error));
        if (list.count == 0) {
            break;
        }
    }
done:
    free(list.index);
    return status;
}

enum status field_table_build(const struct support_options *options, int64_t node_count, const double *nodes,
                              const double *spacing, int64_t count, const double *x, const char *what,
                              struct field_table *table, struct error *error)
{
    enum status status;
    double *radius = NULL;
    struct point_grid grid = {0};
    *table = (struct field_table){0};
    TRY(NEW_ARRAY(&radius, node_count, error));
    TRY(support_radii(options, node_count, spacing, radius, error));
    TRY(point_grid_build(&grid, options->mls.dim, node_count, nodes, radius, error));
    TRY(support_build(options, &grid, count, x, what, &table->lists, error));
    TRY(NEW_ARRAY(&table->phi, table->lists.ptr[count], error));
    struct neighbours lists = {
        .count = count, .ptr = table->lists.ptr, .idx = table->lists.idx, .widen = table->lists.widen};
    TRY(shape_table(&options->mls, nodes, radius, &lists, x, what, table->phi, NULL, error));
done:
    point_grid_free(&grid);
    free(radius);
    if (status != STATUS_OK) {
        field_table_free(table);
    }
    return status;
}

void field_table_free(struct field_table *table)
{
    support_free(&table->lists);
    free(table->phi);
    *table = (struct field_table){0};
}

void field_evaluate(int64_t count, const int64_t *ptr, const int32_t *idx, const double *phi, int64_t cols,
                    const double *field, double *values)
{
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

/* The larger extent of two clouds along any axis. */
static double extent_of(int dim, int64_t a_count, const double *a, int64_t b_count, const double *b)
{
    double extent = 0.0;
    for (int axis = 0; axis < dim; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t n = 0; n < a_count; n++) {
            low = fmin(low, a[n * dim + axis]);
            high = fmax(high, a[n * dim + axis]);
        }
        for (int64_t n = 0; n < b_count; n++) {
            low = fmin(low, b[n * dim + axis]);
            high = fmax(high, b[n * dim + axis]);
        }
        extent = fmax(extent, high - low);
    }
    return extent;
}

static bool same_place(int dim, const double *a, const double *b, double tolerance)
{
    for (int axis = 0; axis < dim; axis++) {
        if (!(fabs(a[axis] - b[axis]) <= tolerance)) {
            return false;
        }
    }
    return true;
}

/* Match nodes in any order through cell lists. */
static enum status match_any_order(int dim, int64_t count, const double *a, const double *b, double tolerance,
                                   int32_t *match, bool *matched, struct error *error)
{
    enum status status;
    struct point_grid grid = {0};
    struct index_list list = {0};
    double *radius = NULL;
    char *used = NULL;
    TRY(NEW_ARRAY(&radius, count, error));
    TRY(NEW_ARRAY(&used, count, error));
    for (int64_t n = 0; n < count; n++) {
        radius[n] = tolerance * sqrt((double)dim);
    }
    TRY(point_grid_build(&grid, dim, count, b, radius, error));
    *matched = true;
    for (int64_t n = 0; n < count && *matched; n++) {
        list.count = 0;
        TRY(point_grid_query(&grid, a + n * dim, 1.0, &list, error));
        int64_t at = 0;
        while (at < list.count && used[list.index[at]]) {
            at++;
        }
        *matched = at < list.count;
        if (*matched) {
            match[n] = list.index[at];
            used[match[n]] = 1;
        }
    }
done:
    point_grid_free(&grid);
    free(list.index);
    free(radius);
    free(used);
    return status;
}

enum status field_match_nodes(int dim, int64_t a_count, const double *a, int64_t b_count, const double *b,
                              int32_t *match, bool *matched, struct error *error)
{
    double tolerance = 1e-9 * extent_of(dim, a_count, a, b_count, b);
    *matched = a_count == b_count;
    if (!*matched) {
        return STATUS_OK;
    }
    for (int64_t n = 0; n < a_count && *matched; n++) {
        match[n] = (int32_t)n;
        *matched = same_place(dim, a + n * dim, b + n * dim, tolerance);
    }
    if (*matched || !(tolerance > 0.0)) {
        return STATUS_OK;
    }
    return match_any_order(dim, a_count, a, b, tolerance, match, matched, error);
}

void field_difference(int64_t count, int64_t cols, const double *a, const double *b, double *difference)
{
    for (int64_t i = 0; i < count; i++) {
        double sum = 0.0;
        for (int64_t c = 0; c < cols; c++) {
            double d = a[i * cols + c] - b[i * cols + c];
            sum += d * d;
        }
        difference[i] = sqrt(sum);
    }
}

double field_largest(int64_t count, int64_t cols, const double *field)
{
    double largest2 = 0.0;
    for (int64_t i = 0; i < count; i++) {
        double sum = 0.0;
        for (int64_t c = 0; c < cols; c++) {
            sum += field[i * cols + c] * field[i * cols + c];
        }
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
    enum status status;
    double sum = 0.0, sum2 = 0.0;
    bool unknown = count == 0;
    *statistics = (struct field_statistics){.count = count};
    TRY(NEW_ARRAY(&statistics->sorted, count, error));
    for (int64_t i = 0; i < count; i++) {
        double d = difference[index[i]];
        statistics->sorted[i] = d;
        unknown = unknown || isnan(d);
        sum += d;
        sum2 += d * d;
        if (i == 0 || d > statistics->largest) {
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
done:
    return status;
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
