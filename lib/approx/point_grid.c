#include "approx/point_grid.h"

#include "base/memory.h"

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
    double at = floor((x - level->origin[axis]) / level->bin);
    double last = (double)(level->bins[axis] - 1);
    return (int64_t)(at < 0.0 ? 0.0 : at > last ? last : at);
}

static int64_t bin_of(const struct point_grid *grid, const struct point_grid_level *level, const double *x)
{
    int64_t bin = 0;
    for (int a = grid->dim - 1; a >= 0; a--) {
        bin = bin * level->bins[a] + bin_along(level, a, x[a]);
    }
    return bin;
}

/* Choose the bins of a level from its nodes' extent: at least the largest radius, and no more than a few bins
 * per node. */
static int64_t choose_bins(struct point_grid_level *level, int dim, const double *upper, int64_t nodes)
{
    int64_t total;
    level->bin = level->largest_radius;
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
    total = 1;
    for (int a = 0; a < 3; a++) {
        level->bins[a] = a < dim ? (int64_t)floor((upper[a] - level->origin[a]) / level->bin) + 1 : 1;
        total *= level->bins[a];
    }
    return total;
}

static enum status build_level(struct point_grid *grid, int number, const uint8_t *level_of_node,
                               struct error *error)
{
    enum status status;
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
        level->largest_radius = fmax(level->largest_radius, grid->radius[n]);
        for (int a = 0; a < dim; a++) {
            level->origin[a] = fmin(level->origin[a], grid->x[n * dim + a]);
            upper[a] = fmax(upper[a], grid->x[n * dim + a]);
        }
    }
    if (nodes == 0) {
        return STATUS_OK;
    }
    int64_t bins = choose_bins(level, dim, upper, nodes);
    TRY(NEW_ARRAY(&level->start, bins + 2, error));
    TRY(NEW_ARRAY(&level->node, nodes, error));
    for (int64_t n = 0; n < grid->node_count; n++) {
        if (level_of_node[n] == number) {
            level->start[bin_of(grid, level, grid->x + n * dim) + 2]++;
        }
    }
    for (int64_t b = 0; b < bins; b++) {
        level->start[b + 2] += level->start[b + 1];
    }
    for (int64_t n = 0; n < grid->node_count; n++) {
        if (level_of_node[n] == number) {
            level->node[level->start[bin_of(grid, level, grid->x + n * dim) + 1]++] = (int32_t)n;
        }
    }
done:
    return status;
}

enum status point_grid_build(struct point_grid *grid, int dim, int64_t node_count, const double *x,
                             const double *radius, struct error *error)
{
    enum status status;
    uint8_t *level_of_node = NULL;
    double least = INFINITY;
    *grid = (struct point_grid){.dim = dim, .node_count = node_count, .x = x, .radius = radius};
    for (int64_t n = 0; n < node_count; n++) {
        if (!(radius[n] > 0.0) || !isfinite(radius[n])) {
            return fail(error, STATUS_INPUT, "support.radius: row %lld: %g is no radius", (long long)n,
                        radius[n]);
        }
        least = fmin(least, radius[n]);
    }
    TRY(NEW_ARRAY(&level_of_node, node_count, error));
    for (int64_t n = 0; n < node_count; n++) {
        level_of_node[n] = (uint8_t)level_of(radius[n], least);
        if (level_of_node[n] >= grid->level_count) {
            grid->level_count = level_of_node[n] + 1;
        }
    }
    for (int l = 0; l < grid->level_count; l++) {
        TRY(build_level(grid, l, level_of_node, error));
    }
done:
    free(level_of_node);
    if (status != STATUS_OK) {
        point_grid_free(grid);
    }
    return status;
}

void point_grid_free(struct point_grid *grid)
{
    for (int l = 0; l < grid->level_count; l++) {
        free(grid->level[l].start);
        free(grid->level[l].node);
    }
    *grid = (struct point_grid){0};
}

static enum status list_append(struct index_list *list, int32_t index, struct error *error)
{
    if (list->count == list->capacity) {
        int64_t capacity = list->capacity * 2 + 64;
        int32_t *grown = array_grow(list->index, capacity, sizeof *grown);
        if (grown == NULL) {
            return fail_memory(error, "neighbour list");
        }
        list->index = grown;
        list->capacity = capacity;
    }
    list->index[list->count++] = index;
    return STATUS_OK;
}

/* Append the nodes of one bin whose supports contain x. */
static enum status query_bin(const struct point_grid *grid, const struct point_grid_level *level, int64_t bin,
                             const double *x, double factor, struct index_list *list, struct error *error)
{
    int dim = grid->dim;
    for (int64_t i = level->start[bin]; i < level->start[bin + 1]; i++) {
        int32_t node = level->node[i];
        double radius = grid->radius[node] * factor, distance2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double difference = grid->x[(int64_t)node * dim + a] - x[a];
            distance2 += difference * difference;
        }
        if (distance2 < radius * radius) {
            enum status status = list_append(list, node, error);
            if (status != STATUS_OK) {
                return status;
            }
        }
    }
    return STATUS_OK;
}

static enum status query_level(const struct point_grid *grid, const struct point_grid_level *level,
                               const double *x, double factor, struct index_list *list, struct error *error)
{
    int64_t low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    double reach = level->largest_radius * factor * (1.0 + 1e-9); /* rounding at the edges of bins */
    for (int a = 0; a < grid->dim; a++) {
        double end = level->origin[a] + level->bin * (double)level->bins[a];
        if (x[a] + reach < level->origin[a] || x[a] - reach > end) {
            return STATUS_OK;
        }
        low[a] = bin_along(level, a, x[a] - reach);
        high[a] = bin_along(level, a, x[a] + reach);
    }
    for (int64_t k = low[2]; k <= high[2]; k++) {
        for (int64_t j = low[1]; j <= high[1]; j++) {
            for (int64_t i = low[0]; i <= high[0]; i++) {
                int64_t bin = (k * level->bins[1] + j) * level->bins[0] + i;
                enum status status = query_bin(grid, level, bin, x, factor, list, error);
                if (status != STATUS_OK) {
                    return status;
                }
            }
        }
    }
    return STATUS_OK;
}

/* Lists come as a few ascending runs: insertion sort is quick on them. */
static void sort_ascending(int32_t *index, int64_t count)
{
    for (int64_t i = 1; i < count; i++) {
        int32_t value = index[i];
        int64_t at = i;
        for (; at > 0 && index[at - 1] > value; at--) {
            index[at] = index[at - 1];
        }
        index[at] = value;
    }
}

enum status point_grid_query(const struct point_grid *grid, const double *x, double factor,
                             struct index_list *list, struct error *error)
{
    int64_t first = list->count;
    for (int l = 0; l < grid->level_count; l++) {
        if (grid->level[l].start != NULL) {
            enum status status = query_level(grid, &grid->level[l], x, factor, list, error);
            if (status != STATUS_OK) {
                return status;
            }
        }
    }
    sort_ascending(list->index + first, list->count - first);
    return STATUS_OK;
}
