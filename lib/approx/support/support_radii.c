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

/* stretch[node_count * dim * dim], zero: A of the nodes; *any: whether some are not 1. */
static void stretch_of(const struct cells *cells, double *stretch, bool *any)
{
    *any = false;
    sum_edges(cells, stretch);
    for (int64_t n = 0; n < cells->node_count; n++) {
        *any = set_stretch(cells->dim, stretch + n * cells->dim * cells->dim) || *any;
    }
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

/* node[cells->count * (dim + 1)]: the cells by sides, each side with nodes 0 .. *count - 1 of its own; of[]:
 * of each of these the node of the body. */
static enum status part_sides(const struct cells *cells, const int32_t *side, int32_t *node, int32_t *of,
                              int64_t *count, struct error *error)
{
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    int64_t sides = 0, corners = cells->dim + 1;
    NEW_SCRATCH(int32_t, last, cells->node_count, error); /* of the nodes made, of each node, from 1 */
    for (int64_t c = 0; c < cells->count; c++) {
        sides = side[c] >= sides ? side[c] + 1 : sides;
    }
    RETURN_IF_ERROR(lists_by_row(cells->count, 1, side, sides, &ptr, &idx, error));
    *count = 0;
    for (int64_t s = 0; s < sides; s++) {
        int64_t before = *count;
        for (int64_t i = ptr[s] * corners; i < ptr[s + 1] * corners; i++) {
            int32_t n = cells->node[idx[i / corners] * corners + i % corners];
            if (last[n] <= before) {
                of[(*count)++] = n;
                last[n] = (int32_t)*count;
            }
            node[i] = last[n] - 1;
        }
    }
    return STATUS_OK;
}

/* How many sides need each node of the body, needed[], zero: those on which no node within two edges of it is
 * itself two edges from all interfaces. They have too few nodes of their own to do with less of its support.
 * needs[]: the nodes on sides that do. */
static enum status find_needed(const struct cells *parted, const int32_t *of, int32_t *needed, bool *needs,
                               struct error *error)
{
    int corners = parted->dim + 1;
    NEW_SCRATCH(int32_t, sides, parted->node_count, error);
    for (int64_t i = 0; i < parted->node_count; i++) {
        sides[of[i]]++;
    }
    for (int64_t i = 0; i < parted->node_count; i++) {
        needs[i] = sides[of[i]] > 1;
    }
    RETURN_IF_ERROR(choice_grow(parted->count, corners, parted->node, parted->node_count, 0, NULL, 1, false,
                                needs, error));
    RETURN_IF_ERROR(choice_grow(parted->count, corners, parted->node, parted->node_count, 0, NULL, -2, false,
                                needs, error));
    for (int64_t i = 0; i < parted->node_count; i++) {
        needed[of[i]] += needs[i];
    }
    return STATUS_OK;
}

/* Where cells of some side are flat at a node that the other sides do not need, take A and the spacing that
 * the flattest side alone has. */
static enum status take_flattest(const struct cells *cells, const int32_t *side, double *stretch,
                                 double *spacing, bool *any, struct error *error)
{
    int dim = cells->dim, size = dim * dim;
    struct cells parted = *cells;
    bool flat;
    NEW_SCRATCH(int32_t, node, cells->count * (dim + 1), error);
    NEW_SCRATCH(int32_t, of, cells->count * (dim + 1), error);
    RETURN_IF_ERROR(part_sides(cells, side, node, of, &parted.node_count, error));
    NEW_SCRATCH(double, x, parted.node_count * dim, error);
    NEW_SCRATCH(double, A, parted.node_count * size, error);
    NEW_SCRATCH(double, own, parted.node_count, error);
    NEW_SCRATCH(double, most, cells->node_count, error);
    NEW_SCRATCH(int32_t, needed, cells->node_count, error);
    NEW_SCRATCH(bool, needs, parted.node_count, error);
    for (int64_t i = 0; i < parted.node_count; i++) {
        memcpy(x + i * dim, cells->x + (int64_t)of[i] * dim, (size_t)dim * sizeof *x);
        most[of[i]] = (1.0 + COARSE_ROUND_OFF) * dim;
    }
    parted.x = x;
    parted.node = node;
    stretch_of(&parted, A, &flat);
    RETURN_IF_ERROR(spacing_of(&parted, A, own, error));
    RETURN_IF_ERROR(find_needed(&parted, of, needed, needs, error));
    for (int64_t i = 0; i < parted.node_count && flat; i++) {
        double flatness = trace(dim, A + i * size);
        if (flatness > most[of[i]] && needed[of[i]] == needs[i]) {
            most[of[i]] = (1.0 + COARSE_ROUND_OFF) * flatness;
            memcpy(stretch + (int64_t)of[i] * size, A + i * size, (size_t)size * sizeof *A);
            spacing[of[i]] = own[i];
            *any = true;
        }
    }
    return STATUS_OK;
}

enum status support_sizes(const struct cells *cells, const int32_t *side, double **stretch, double *spacing,
                          struct error *error)
{
    bool any;
    *stretch = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(stretch, cells->node_count * cells->dim * cells->dim, error));
    stretch_of(cells, *stretch, &any);
    RETURN_IF_ERROR(spacing_of(cells, *stretch, spacing, error));
    if (side != NULL) {
        RETURN_IF_ERROR(take_flattest(cells, side, *stretch, spacing, &any, error));
    }
    if (!any) {
        FREE_ALL(*stretch);
        *stretch = NULL;
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
