#include "approx/support/support.h"

#include "approx/cells/face_edges.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

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

/* T[node_count * dim * dim]: the sum of x (x) x over the edges of the cells at each node. */
static void sum_edges(const struct cells *cells, double *T)
{
    int dim = cells->dim;
    for (int64_t c = 0; c < cells->count; c++) {
        const int32_t *v = cells->node + c * (dim + 1);
        double sum[9] = {0.0}, edge[3];
        for (int e = 0; e < CELL_EDGES(dim); e++) {
            vector_subtract(dim, cells->x + (int64_t)v[cell_edge_ends[e][1]] * dim,
                            cells->x + (int64_t)v[cell_edge_ends[e][0]] * dim, edge);
            for (int k = 0; k < dim * dim; k++) {
                sum[k] += edge[k / dim] * edge[k % dim];
            }
        }
        for (int k = 0; k <= dim; k++) {
            add_scaled(dim * dim, 1.0, sum, T + (int64_t)v[k] * dim * dim);
        }
    }
}

/* Supports are at most so many times as long as wide: beyond, MMLS is linear across them, as mu = 1e-7
 * exceeds the fourth power of the relative width. */
static const double most_stretch = 32.0;
/* Of the spacing, at most, by which supports are wider there. */
static const double stretched_more = 0.15;

/* From T of a node its A, in place; whether it is not 1. */
static bool set_stretch(int dim, double *A)
{
    double value[3], V[9], longest = 0.0;
    bool flat = false;
    eigen_symmetric(dim, A, value, V);
    for (int i = 0; i < dim; i++) {
        longest = fmax(longest, value[i]);
    }
    for (int k = 0; k < dim * dim; k++) {
        A[k] = k / dim == k % dim ? 1.0 : 0.0;
    }
    for (int i = 0; i < dim; i++) {
        double square = longest / fmax(value[i], longest / (most_stretch * most_stretch)) - 3 * dim + 1;
        double more = sqrt(fmax(square, 1.0)) - 1.0;
        for (int k = 0; k < dim * dim && more > COARSE_ROUND_OFF; k++) {
            A[k] += more * V[k / dim * dim + i] * V[k % dim * dim + i];
        }
        flat = flat || more > COARSE_ROUND_OFF;
    }
    return flat;
}

enum status support_stretch(const struct cells *cells, double **stretch, struct error *error)
{
    int64_t size = (int64_t)cells->dim * cells->dim;
    bool any = false;
    *stretch = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(stretch, cells->node_count * size, error));
    sum_edges(cells, *stretch);
    for (int64_t n = 0; n < cells->node_count; n++) {
        any = set_stretch(cells->dim, *stretch + n * size) || any;
    }
    if (!any) {
        FREE_ALL(*stretch);
        *stretch = NULL;
    }
    return STATUS_OK;
}

enum status support_spacing(const struct cells *cells, const double *stretch, double *spacing,
                            struct error *error)
{
    int dim = cells->dim;
    RETURN_IF_ERROR(cells_node_spacing(cells, stretch, spacing, error));
    for (int64_t n = 0; n < cells->node_count && stretch != NULL; n++) {
        double trace = 0.0;
        for (int a = 0; a < dim; a++) {
            trace += stretch[(n * dim + a) * dim + a];
        }
        spacing[n] *= 1.0 + stretched_more * (1.0 - dim / trace);
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
