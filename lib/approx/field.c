#include "approx/field.h"

#include "approx/support_space.h"
#include "base/memory.h"

#include <stdlib.h>

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

enum status field_table_build(const struct support_options *options, const struct mls *shapes,
                              const struct cells *cells, const double *radius, int64_t count, const double *x,
                              const char *what, struct field_table *table, struct error *error)
{
    enum status status;
    struct support_space space;
    *table = (struct field_table){0};
    TRY(support_space_build(options, cells, radius, &space, error));
    TRY(support_space_lists(options, &space, NULL, count, x, what, &table->lists, error));
    TRY(NEW_ARRAY(&table->phi, table->lists.ptr[count], error));
    struct neighbours lists = support_view(&table->lists);
    TRY(shape_table(shapes != NULL ? shapes : &options->mls, cells->x, radius, &lists, x, what, table->phi,
                    NULL, error));
done:
    support_space_free(&space);
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
