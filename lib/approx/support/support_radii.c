#include "approx/support/support.h"

#include "approx/cells/face_edges.h"
#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

/* stretch[node_count * dim * dim], zero: A of the nodes; returns whether some are not 1. */
static bool stretch_of(const struct cells *cells, double *stretch)
{
    bool any = false;
    sum_edges(cells, stretch);
    for (int64_t n = 0; n < cells->node_count; n++) {
        any = set_stretch(cells->dim, stretch + n * cells->dim * cells->dim) || any;
    }
    return any;
}

static double trace(int dim, const double *A)
{
    return A[0] + A[dim + 1] + (dim == 3 ? A[8] : 0.0);
}

static enum status spacing_of(const struct cells *cells, const double *stretch, double *spacing,
                              struct error *error)
{
    int dim = cells->dim;
    RETURN_IF_ERROR(cells_node_spacing(cells, stretch, spacing, error));
    for (int64_t n = 0; n < cells->node_count; n++) {
        spacing[n] *= 1.0 + stretched_more * (1.0 - dim / trace(dim, stretch + n * dim * dim));
    }
    return STATUS_OK;
}

/* The cells, each side with nodes of its own, numbered by sides. of[cells->count * (dim + 1)]: of each of
 * these nodes that of the body; side_of[]: and its side; node[], x[]: the arrays of *parted. */
static enum status part_sides(const struct cells *cells, const int32_t *side, int32_t *node, double *x,
                              int32_t *of, int32_t *side_of, struct cells *parted, struct error *error)
{
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    int64_t sides = 0, count = 0, corners = cells->dim + 1;
    NEW_SCRATCH(int32_t, last, cells->node_count, error); /* of the nodes made, of each node, from 1 */
    for (int64_t c = 0; c < cells->count; c++) {
        sides = side[c] >= sides ? side[c] + 1 : sides;
    }
    RETURN_IF_ERROR(lists_by_row(cells->count, 1, side, sides, &ptr, &idx, error));
    for (int64_t s = 0; s < sides; s++) {
        int64_t before = count;
        for (int64_t i = ptr[s] * corners; i < ptr[s + 1] * corners; i++) {
            int32_t n = cells->node[idx[i / corners] * corners + i % corners];
            if (last[n] <= before) {
                memcpy(x + count * cells->dim, cells->x + (int64_t)n * cells->dim,
                       (size_t)cells->dim * sizeof *x);
                side_of[count] = (int32_t)s;
                of[count++] = n;
                last[n] = (int32_t)count;
            }
            node[i] = last[n] - 1;
        }
    }
    *parted = *cells;
    parted->node_count = count;
    parted->node = node;
    parted->x = x;
    return STATUS_OK;
}

/* The supports of nodes on interfaces where cells are flat, of each side as of its cells alone; R: the
 * spacing. */
static enum status make_sides(const struct cells *cells, const int32_t *side, struct supports *sizes,
                              struct error *error)
{
    int dim = cells->dim, size = dim * dim;
    struct cells parted;
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    NEW_SCRATCH(int32_t, node, cells->count * (dim + 1), error);
    NEW_SCRATCH(int32_t, of, cells->count * (dim + 1), error);
    NEW_SCRATCH(int32_t, side_of, cells->count * (dim + 1), error);
    NEW_SCRATCH(double, x, cells->count * (dim + 1) * dim, error);
    RETURN_IF_ERROR(part_sides(cells, side, node, x, of, side_of, &parted, error));
    NEW_SCRATCH(double, A, parted.node_count * size, error);
    NEW_SCRATCH(double, spacing, parted.node_count, error);
    (void)stretch_of(&parted, A);
    RETURN_IF_ERROR(spacing_of(&parted, A, spacing, error));
    RETURN_IF_ERROR(lists_by_row(parted.node_count, 1, of, cells->node_count, &ptr, &idx, error));
    RETURN_IF_ERROR(NEW_ARRAY(&sizes->sides, parted.node_count * SIDE_COLUMNS(dim), error));
    for (int64_t n = 0; n < cells->node_count; n++) {
        bool flat = trace(dim, sizes->stretch + n * size) > dim;
        for (int64_t i = ptr[n]; i < ptr[n + 1]; i++) {
            flat = flat || trace(dim, A + (int64_t)idx[i] * size) > dim;
        }
        for (int64_t i = ptr[n]; i < ptr[n + 1] && flat && ptr[n + 1] - ptr[n] > 1; i++) {
            double *row = sizes->sides + sizes->side_count++ * SIDE_COLUMNS(dim);
            row[0] = (double)n;
            row[1] = side_of[idx[i]];
            row[2] = spacing[idx[i]];
            memcpy(row + 3, A + (int64_t)idx[i] * size, (size_t)size * sizeof *A);
        }
    }
    return STATUS_OK;
}

void supports_free(struct supports *sizes)
{
    FREE_ALL(sizes->radius, sizes->stretch, sizes->sides);
    *sizes = (struct supports){0};
}

enum status support_sizes(const struct support_options *options, const struct cells *cells,
                          struct supports *sizes, struct error *error)
{
    int dim = cells->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&sizes->radius, cells->node_count, error));
    if (options->radius <= 0.0) {
        RETURN_IF_ERROR(NEW_ARRAY(&sizes->stretch, cells->node_count * dim * dim, error));
        bool flat = stretch_of(cells, sizes->stretch);
        RETURN_IF_ERROR(spacing_of(cells, sizes->stretch, sizes->radius, error));
        RETURN_IF_ERROR(options->side != NULL && options->visibility == VISIBILITY_CELLS
                            ? make_sides(cells, options->side, sizes, error)
                            : STATUS_OK);
        if (!flat) {
            FREE_ALL(sizes->stretch);
            sizes->stretch = NULL;
        }
    }
    for (int64_t i = 0; i < sizes->side_count; i++) {
        sizes->sides[i * SIDE_COLUMNS(dim) + 2] *= options->factor;
    }
    return support_radii(options, cells->node_count, sizes->radius, sizes->radius, error);
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
