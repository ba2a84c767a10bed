#include "approx/support/support.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* Mean of the `wanted` least distances, or -1 if there are fewer. */
static double mean_of_least(double *distance, int64_t count, int64_t wanted)
{
    double sum = 0.0;
    if (count < wanted) {
        return -1.0;
    }
    for (int64_t i = 0; i < wanted; i++) {
        int64_t least = i;
        for (int64_t k = i + 1; k < count; k++) {
            least = distance[k] < distance[least] ? k : least;
        }
        double swap = distance[i];
        distance[i] = distance[least];
        distance[least] = swap;
        sum += distance[i];
    }
    return sum / (double)wanted;
}

/* Mean distance of a node from the nearest nodes, found in a neighbourhood that is doubled until it has
 * enough nodes. */
static enum status spacing_of(const struct point_grid *grid, int64_t node, struct index_list *list,
                              double *spacing, struct error *error)
{
    int dim = grid->dim;
    SCRATCH double *distance = NULL;
    int64_t wanted = grid->node_count - 1 < 2 * dim ? grid->node_count - 1 : 2 * dim;
    *spacing = -1.0;
    for (double factor = 1.0; *spacing < 0.0; factor *= 2.0) {
        const double *x = grid->x + node * dim;
        list->count = 0;
        RETURN_IF_ERROR(point_grid_query(grid, x, factor, list, error));
        free(distance);
        RETURN_IF_ERROR(NEW_ARRAY(&distance, list->count, error));
        int64_t others = 0;
        for (int64_t i = 0; i < list->count; i++) {
            if (list->index[i] != node) {
                distance[others++] = vector_distance(dim, x, grid->x + (int64_t)list->index[i] * dim);
            }
        }
        *spacing = mean_of_least(distance, others, wanted);
    }
    return STATUS_OK;
}

enum status nodes_spacing(int dim, int64_t node_count, const double *x, double *spacing, struct error *error)
{
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(index_list_free) struct index_list list = {0};
    struct box box = box_of(dim, node_count, x);
    double extent = box_side(&box);
    if (node_count < 2 || !(extent > 0.0)) {
        return fail(error, STATUS_INPUT, "nodes.x: %lld nodes at one place have no spacing",
                    (long long)node_count);
    }
    /* A first guess of the neighbourhood's size; it is doubled where there are too few nodes. */
    NEW_SCRATCH(double, radius, node_count, error);
    for (int64_t n = 0; n < node_count; n++) {
        radius[n] = 2.0 * extent / pow((double)node_count, 1.0 / dim);
    }
    RETURN_IF_ERROR(point_grid_build(&grid, dim, node_count, x, radius, error));
    for (int64_t n = 0; n < node_count; n++) {
        RETURN_IF_ERROR(spacing_of(&grid, n, &list, &spacing[n], error));
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
