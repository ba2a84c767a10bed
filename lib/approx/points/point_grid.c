#include "approx/points/point_grid.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

static int level_of(double radius, double least)
{
    int level = (int)floor(log2(radius / least));
    return level < 0 ? 0 : level < POINT_GRID_LEVELS ? level : POINT_GRID_LEVELS - 1;
}

/* Bin of a coordinate along one axis, clamped to the grid. */
static int64_t bin_along(const struct point_grid_level *level, int axis, double x)
{
    double at = (x - level->origin[axis]) * level->per_length;
    double last = (double)(level->bins[axis] - 1);
    return (int64_t)(at > 0.0 ? (at > last ? last : at) : 0.0);
}

static int64_t bin_of(const struct point_grid *grid, const struct point_grid_level *level, const double *x)
{
    int64_t bin = 0;
    for (int a = grid->dim - 1; a >= 0; a--) {
        bin = bin * level->bins[a] + bin_along(level, a, x[a]);
    }
    return bin;
}

/* Choose the bins of a level from its nodes' extent: at least half the largest radius, and no more than a few
 * bins per node. */
static int64_t choose_bins(struct point_grid_level *level, int dim, const double *upper, int64_t nodes)
{
    level->bin = 0.5 * level->largest_radius;
    for (;;) {
        double product = 1.0;
        for (int a = 0; a < dim; a++) {
            product *= floor((upper[a] - level->origin[a]) / level->bin) + 1.0;
        }
        if (product <= 4.0 * (double)nodes + 64.0) {
            break;
        }
        level->bin *= 1.25;
    }
    level->per_length = 1.0 / level->bin;
    int64_t total = 1;
    for (int a = 0; a < 3; a++) {
        level->bins[a] = a < dim ? (int64_t)floor((upper[a] - level->origin[a]) / level->bin) + 1 : 1;
        total *= level->bins[a];
    }
    return total;
}

/* Sort the nodes of one level into bins. bin[node_count]: scratch. */
static enum status build_level(struct point_grid *grid, int number, const double *radius,
                               const uint8_t *level_of_node, int32_t *bin, struct error *error)
{
    struct point_grid_level *level = &grid->level[number];
    int dim = grid->dim;
    double upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    int64_t nodes = 0;
    for (int a = 0; a < 3; a++) {
        level->origin[a] = INFINITY;
    }
    for (int64_t n = 0; n < grid->node_count; n++) {
        if (level_of_node[n] != number) {
            continue;
        }
        nodes++;
        level->largest_radius = fmax(level->largest_radius, radius[n]);
        for (int a = 0; a < dim; a++) {
            level->origin[a] = fmin(level->origin[a], grid->x[n * dim + a]);
            upper[a] = fmax(upper[a], grid->x[n * dim + a]);
        }
    }
    if (nodes == 0) {
        return STATUS_OK;
    }
    int64_t bins = choose_bins(level, dim, upper, nodes);
    for (int64_t n = 0; n < grid->node_count; n++) {
        bin[n] = level_of_node[n] == number ? (int32_t)bin_of(grid, level, grid->x + n * dim) : -1;
    }
    RETURN_IF_ERROR(lists_by_row(grid->node_count, 1, bin, bins, &level->start, &level->node, error));
    RETURN_IF_ERROR(NEW_ARRAY(&level->place, nodes * (dim + 1), error));
    for (int64_t i = 0; i < nodes; i++) {
        double *place = level->place + i * (dim + 1);
        for (int a = 0; a < dim; a++) {
            place[a] = grid->x[(int64_t)level->node[i] * dim + a];
        }
        place[dim] = radius[level->node[i]];
    }
    return STATUS_OK;
}

enum status point_grid_build(struct point_grid *grid, int dim, int64_t node_count, const double *x,
                             const double *radius, struct error *error)
{
    double least = INFINITY;
    *grid = (struct point_grid){.dim = dim, .node_count = node_count, .x = x};
    for (int64_t n = 0; n < node_count; n++) {
        if (!(radius[n] > 0.0) || !isfinite(radius[n])) {
            return fail(error, STATUS_INPUT, "support.radius: row %lld: %g is no radius", (long long)n,
                        radius[n]);
        }
        least = fmin(least, radius[n]);
    }
    NEW_SCRATCH(uint8_t, level_of_node, node_count, error);
    NEW_SCRATCH(int32_t, bin, node_count, error);
    for (int64_t n = 0; n < node_count; n++) {
        level_of_node[n] = (uint8_t)level_of(radius[n], least);
        if (level_of_node[n] >= grid->level_count) {
            grid->level_count = level_of_node[n] + 1;
        }
    }
    for (int l = 0; l < grid->level_count; l++) {
        RETURN_IF_ERROR(build_level(grid, l, radius, level_of_node, bin, error));
    }
    return STATUS_OK;
}

void index_list_free(struct index_list *list)
{
    free(list->index);
    *list = (struct index_list){0};
}

void point_grid_free(struct point_grid *grid)
{
    for (int l = 0; l < grid->level_count; l++) {
        const struct point_grid_level *level = &grid->level[l];
        FREE_ALL(level->start, level->node, level->place);
    }
    *grid = (struct point_grid){0};
}

enum status index_list_reserve(struct index_list *list, int64_t count, struct error *error)
{
    return GROW_ARRAY(&list->index, list->count + count, &list->capacity, error);
}

/* Append the nodes at the places [first, last) of a level whose supports meet the box. */
static inline __attribute__((always_inline)) void query_run(const struct point_grid_level *level, int dim,
                                                            int64_t first, int64_t last, const double *low,
                                                            const double *high, double factor,
                                                            struct index_list *list)
{
    int32_t *index = list->index + list->count;
    int64_t found = 0;
    for (int64_t i = first; i < last; i++) {
        const double *place = level->place + i * (dim + 1);
        double radius = place[dim] * factor, distance2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double below = low[a] - place[a], above = place[a] - high[a];
            double difference = (below > 0.0 ? below : 0.0) + (above > 0.0 ? above : 0.0);
            distance2 += difference * difference;
        }
        index[found] = level->node[i];
        found += distance2 < radius * radius;
    }
    list->count += found;
}

/* Append the nodes of a level whose supports meet the box, in no particular order. */
static enum status query_level(const struct point_grid *grid, const struct point_grid_level *level,
                               const double *low, const double *high, double factor, struct index_list *list,
                               struct error *error)
{
    int64_t from[3] = {0, 0, 0}, to[3] = {0, 0, 0};
    double reach = level->largest_radius * factor * (1.0 + 1e-9); /* for round-off at the edges of bins */
    for (int a = 0; a < grid->dim; a++) {
        double end = level->origin[a] + level->bin * (double)level->bins[a];
        if (high[a] + reach < level->origin[a] || low[a] - reach > end) {
            return STATUS_OK;
        }
        from[a] = bin_along(level, a, low[a] - reach);
        to[a] = bin_along(level, a, high[a] + reach);
    }
    /* The bins of a row are consecutive. Omitting those beyond the ball costs more than it saves. */
    for (int64_t k = from[2]; k <= to[2]; k++) {
        for (int64_t j = from[1]; j <= to[1]; j++) {
            int64_t row = (k * level->bins[1] + j) * level->bins[0];
            int64_t first = level->start[row + from[0]], last = level->start[row + to[0] + 1];
            RETURN_IF_ERROR(index_list_reserve(list, last - first, error));
            if (grid->dim == 2) {
                query_run(level, 2, first, last, low, high, factor, list);
            } else {
                query_run(level, 3, first, last, low, high, factor, list);
            }
        }
    }
    return STATUS_OK;
}

enum status point_grid_query_box(const struct point_grid *grid, const double *low, const double *high,
                                 double factor, struct index_list *list, struct error *error)
{
    int64_t first = list->count;
    for (int l = 0; l < grid->level_count; l++) {
        if (grid->level[l].start != NULL) {
            RETURN_IF_ERROR(query_level(grid, &grid->level[l], low, high, factor, list, error));
        }
    }
    if (list->count > first) {
        qsort(list->index + first, (size_t)(list->count - first), sizeof *list->index, compare_int32);
    }
    return STATUS_OK;
}

enum status point_grid_query(const struct point_grid *grid, const double *x, double factor,
                             struct index_list *list, struct error *error)
{
    return point_grid_query_box(grid, x, x, factor, list, error);
}

static void insert(struct nearest_nodes *nearest, int64_t most, int32_t node, double distance)
{
    if (nearest->count == most && distance >= nearest->distance[most - 1]) {
        return;
    }
    int64_t at = nearest->count < most ? nearest->count++ : most - 1;
    for (; at > 0 && nearest->distance[at - 1] > distance; at--) {
        nearest->distance[at] = nearest->distance[at - 1];
        nearest->node[at] = nearest->node[at - 1];
    }
    nearest->distance[at] = distance;
    nearest->node[at] = node;
}

/* Within radii that are doubled until there are enough. */
enum status point_grid_nearest(const struct point_grid *grid, const double *x, int64_t most,
                               node_accepts *accepts, const void *context, struct nearest_nodes *nearest,
                               struct error *error)
{
    FREED_BY(index_list_free) struct index_list near = {0};
    for (int doubled = 0; doubled < 500; doubled++) {
        near.count = nearest->count = 0;
        RETURN_IF_ERROR(point_grid_query(grid, x, ldexp(1.0, doubled), &near, error));
        for (int64_t i = 0; i < near.count; i++) {
            if (accepts == NULL || accepts(context, near.index[i])) {
                insert(nearest, most, near.index[i],
                       vector_distance(grid->dim, grid->x + (int64_t)near.index[i] * grid->dim, x));
            }
        }
        if (nearest->count == most || near.count == grid->node_count) {
            return STATUS_OK;
        }
    }
    return fail(error, STATUS_INPUT, "a point is too far from all others");
}
