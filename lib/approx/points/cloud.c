#include "approx/points/cloud.h"

#include "approx/cells/cells.h"
#include "base/memory.h"

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status check(const struct cloud_options *options, struct error *error)
{
    for (int a = 0; a < options->dim; a++) {
        if (!(options->low[a] < options->high[a]) || !isfinite(options->high[a] - options->low[a])) {
            return fail(error, STATUS_INPUT, "box: %g,%g along axis %d is no range", options->low[a],
                        options->high[a], a + 1);
        }
        if (options->count[a] < 2 && options->kind != CLOUD_HALTON) {
            return fail(error, STATUS_INPUT, "count: %lld nodes along axis %d are fewer than 2",
                        (long long)options->count[a], a + 1);
        }
    }
    return STATUS_OK;
}

/* ---- nodes ---- */

/* Coordinates of the lattice along one axis; their ends are exactly those of the box. */
static void place_axis(const struct cloud_options *options, int axis, double at[])
{
    int64_t last = options->count[axis] - 1;
    double growth =
        options->kind == CLOUD_GRADED && last > 1 ? pow(options->ratio, 1.0 / (double)(last - 1)) : 1.0;
    double whole = 0;
    for (int64_t i = 0; i < last; i++) {
        whole += pow(growth, (double)i);
    }
    double sum = 0;
    for (int64_t i = 0; i <= last; i++) {
        double part = growth > 1 ? sum / whole : (double)i / (double)last;
        at[i] =
            i == last ? options->high[axis] : options->low[axis] * (1 - part) + options->high[axis] * part;
        sum += pow(growth, (double)i);
    }
}

static enum status count_nodes(const struct cloud_options *options, int64_t *count, struct error *error)
{
    *count = 1;
    for (int a = 0; a < (options->kind == CLOUD_HALTON ? 1 : options->dim); a++) {
        if (__builtin_mul_overflow(*count, options->count[a], count) || *count > INT32_MAX) {
            return fail(error, STATUS_INPUT, "count: more than %d nodes", INT32_MAX);
        }
    }
    return STATUS_OK;
}

/* index[dim]: the indices of a node in the lattice. */
static void lattice_index(const struct cloud_options *options, int64_t node, int64_t index[])
{
    for (int a = 0; a < options->dim; a++) {
        index[a] = node % options->count[a];
        node /= options->count[a];
    }
}

static enum status place_lattice(const struct cloud_options *options, struct cloud *cloud,
                                 struct error *error)
{
    int64_t first[4] = {0}; /* coordinate along each axis */
    for (int a = 0; a < options->dim; a++) {
        first[a + 1] = first[a] + options->count[a];
    }
    NEW_SCRATCH(double, at, first[options->dim], error);
    for (int a = 0; a < options->dim; a++) {
        place_axis(options, a, at + first[a]);
    }
    for (int64_t n = 0; n < cloud->node_count; n++) {
        int64_t index[3];
        lattice_index(options, n, index);
        for (int a = 0; a < options->dim; a++) {
            cloud->x[n * options->dim + a] = at[first[a] + index[a]];
        }
    }
    return STATUS_OK;
}

static enum status jitter(const struct cloud_options *options, struct cloud *cloud, struct error *error)
{
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (random == NULL) {
        return fail_memory(error, "random numbers");
    }
    gsl_rng_set(random, options->seed);
    for (int64_t n = 0; n < cloud->node_count; n++) {
        int64_t index[3];
        bool inner = true;
        lattice_index(options, n, index);
        for (int a = 0; a < options->dim; a++) {
            inner = inner && index[a] > 0 && index[a] + 1 < options->count[a];
        }
        for (int a = 0; a < options->dim && inner; a++) {
            double spacing = (options->high[a] - options->low[a]) / (double)(options->count[a] - 1);
            cloud->x[n * options->dim + a] += options->jitter * spacing * (2 * gsl_rng_uniform(random) - 1);
        }
    }
    gsl_rng_free(random);
    return STATUS_OK;
}

static enum status place_halton(const struct cloud_options *options, struct cloud *cloud, struct error *error)
{
    gsl_qrng *sequence = gsl_qrng_alloc(gsl_qrng_halton, (unsigned)options->dim);
    if (sequence == NULL) {
        return fail_memory(error, "the Halton sequence");
    }
    for (int64_t n = 0; n < cloud->node_count; n++) {
        double point[3];
        gsl_qrng_get(sequence, point);
        for (int a = 0; a < options->dim; a++) {
            cloud->x[n * options->dim + a] = options->low[a] * (1 - point[a]) + options->high[a] * point[a];
        }
    }
    gsl_qrng_free(sequence);
    return STATUS_OK;
}

/* ---- cells ---- */

static double least_area(const double *x, const int32_t triangles[2][3])
{
    struct cells cells = {.dim = 2, .x = x, .count = 2, .node = triangles[0]};
    return fmin(cell_volume(&cells, 0), cell_volume(&cells, 1));
}

/* Split the square whose lowest corner is `node`. */
static void split_square(const struct cloud_options *options, const double *x, int64_t node, int32_t *cells)
{
    int32_t a = (int32_t)node;
    int32_t b = a + 1;
    int32_t d = (int32_t)(node + options->count[0]);
    int32_t c = d + 1;
    int32_t usual[2][3] = {{a, b, c}, {a, c, d}};
    int32_t other[2][3] = {{a, b, d}, {b, c, d}};
    bool swap = options->kind == CLOUD_JITTERED &&
                least_area(x, (const int32_t(*)[3])other) > least_area(x, (const int32_t(*)[3])usual);
    memcpy(cells, swap ? other : usual, sizeof usual);
}

/* Split the cube whose lowest corner is `node`. Each tetrahedron is a path from the lowest to the highest
 * corner along the axes, in one of their six orders; odd orders are mirrored. Neighbouring cubes conform. */
static void split_cube(const struct cloud_options *options, int64_t node, int32_t *cells)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    const int64_t step[3] = {1, options->count[0], options->count[0] * options->count[1]};
    for (int t = 0; t < 6; t++) {
        int64_t corner[4] = {node, 0, 0, 0};
        for (int k = 0; k < 3; k++) {
            corner[k + 1] = corner[k] + step[orders[t][k]];
        }
        bool odd = t >= 3;
        cells[4 * t] = (int32_t)corner[0];
        cells[4 * t + 1] = (int32_t)corner[odd ? 2 : 1];
        cells[4 * t + 2] = (int32_t)corner[odd ? 1 : 2];
        cells[4 * t + 3] = (int32_t)corner[3];
    }
}

static enum status make_cells(const struct cloud_options *options, struct cloud *cloud, struct error *error)
{
    int dim = options->dim;
    int pieces = dim == 2 ? 2 : 6;
    int64_t count = pieces;
    for (int a = 0; a < dim; a++) {
        count *= options->count[a] - 1; /* at most 6 (2^31 - 1) */
    }
    if (count > INT32_MAX) {
        return fail(error, STATUS_INPUT, "count: more than %d cells", INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&cloud->cells, count * (dim + 1), error));
    for (int64_t n = 0; n < cloud->node_count; n++) {
        int64_t index[3];
        bool is_corner = true;
        lattice_index(options, n, index);
        for (int a = 0; a < dim; a++) {
            is_corner = is_corner && index[a] + 1 < options->count[a];
        }
        if (!is_corner) {
            continue;
        }
        int32_t *cells = &cloud->cells[cloud->cell_count * (dim + 1)];
        if (dim == 2) {
            split_square(options, cloud->x, n, cells);
        } else {
            split_cube(options, n, cells);
        }
        cloud->cell_count += pieces;
    }
    return STATUS_OK;
}

/* ---- facets ---- */

/* The side of the box that contains a boundary face: 2 * axis, + 1 at the high end. */
static int side_of(const struct cloud_options *options, const int32_t face[])
{
    for (int side = 0; side < 2 * options->dim; side++) {
        int64_t wanted = side % 2 == 0 ? 0 : options->count[side / 2] - 1;
        bool all = true;
        for (int k = 0; k < options->dim; k++) {
            int64_t index[3];
            lattice_index(options, face[k], index);
            all = all && index[side / 2] == wanted;
        }
        if (all) {
            return side;
        }
    }
    return -1;
}

static enum status make_facets(const struct cloud_options *options, const struct cells *cells,
                               struct cloud *cloud, struct error *error)
{
    int dim = options->dim;
    FREED_BY(faces_free) struct faces faces = {0};
    RETURN_IF_ERROR(faces_build(cells, true, &faces, error));
    RETURN_IF_ERROR(NEW_ARRAY(&cloud->facets, faces.count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&cloud->facet_set, faces.count, error));
    for (int side = 0; side < 2 * dim; side++) {
        for (int64_t f = 0; f < faces.count; f++) {
            if (side_of(options, &faces.node[f * dim]) == side) {
                memcpy(&cloud->facets[cloud->facet_count * dim], &faces.node[f * dim],
                       (size_t)dim * sizeof *cloud->facets);
                cloud->facet_set[cloud->facet_count++] = side;
            }
        }
    }
    return STATUS_OK;
}

enum status cloud_make(const struct cloud_options *options, struct cloud *cloud, struct error *error)
{
    *cloud = (struct cloud){.dim = options->dim};
    RETURN_IF_ERROR(check(options, error));
    RETURN_IF_ERROR(count_nodes(options, &cloud->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&cloud->x, cloud->node_count * options->dim, error));
    if (options->kind == CLOUD_HALTON) {
        return place_halton(options, cloud, error);
    }
    RETURN_IF_ERROR(place_lattice(options, cloud, error));
    if (options->kind == CLOUD_JITTERED) {
        RETURN_IF_ERROR(jitter(options, cloud, error));
    }
    RETURN_IF_ERROR(make_cells(options, cloud, error));
    struct cells cells = {cloud->dim, cloud->node_count, cloud->x, cloud->cell_count, cloud->cells};
    if (cells_check(&cells, error) != STATUS_OK) {
        cloud->cell_count = 0;
        return STATUS_OK;
    }
    return make_facets(options, &cells, cloud, error);
}

void cloud_free(struct cloud *cloud)
{
    FREE_ALL(cloud->x, cloud->cells, cloud->facets, cloud->facet_set);
    *cloud = (struct cloud){0};
}
