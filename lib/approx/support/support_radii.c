#include "approx/support/support.h"

#include "base/box.h"
#include "base/memory.h"

#include <math.h>

enum status nodes_spacing(int dim, int64_t node_count, const double *x, double *spacing, struct error *error)
{
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    struct box box = box_of(dim, node_count, x);
    double extent = box_side(&box);
    if (node_count < 2 || !(extent > 0.0)) {
        return fail(error, STATUS_INPUT, "nodes.x: %lld nodes at one place have no spacing",
                    (long long)node_count);
    }
    /* A first guess of the neighbourhood's size. */
    NEW_SCRATCH(double, radius, node_count, error);
    for (int64_t n = 0; n < node_count; n++) {
        radius[n] = 2.0 * extent / pow((double)node_count, 1.0 / dim);
    }
    RETURN_IF_ERROR(point_grid_build(&grid, dim, node_count, x, radius, error));
    for (int64_t n = 0; n < node_count; n++) {
        struct nearest_nodes nearest; /* the node itself, too */
        RETURN_IF_ERROR(point_grid_nearest(&grid, x + n * dim, 2 * dim + 1, NULL, NULL, &nearest, error));
        spacing[n] = 0.0;
        for (int64_t i = 0; i < nearest.count; i++) {
            spacing[n] += nearest.distance[i];
        }
        spacing[n] /= (double)(nearest.count - 1);
    }
    return STATUS_OK;
}

enum status support_radii(const struct support_options *options, int64_t node_count, const double *spacing,
                          double *radius, struct error *error)
{
    for (int64_t n = 0; n < node_count; n++) {
        radius[n] = options->radius > 0.0 ? options->radius : options->factor * spacing[n];
        if (!(radius[n] > 0.0) || !isfinite(radius[n])) {
            return fail(error, STATUS_INPUT,
                        "nodes.x: row %lld: the node has no spacing: it coincides with others", (long long)n);
        }
    }
    return STATUS_OK;
}
