/* A grid of bins (cell lists) to find the nodes whose supports contain a point; radii may differ from node to
 * node. */
#pragma once

#include "base/memory.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

#define POINT_GRID_LEVELS 40

/* The nodes whose radii are in one octave, in bins of at least half the largest of these. */
struct point_grid_level {
    double origin[3], bin; /* lower corner; edge of a bin */
    double per_length;     /* 1 / bin */
    int64_t bins[3];       /* bins along each axis (1 beyond dim) */
    double largest_radius;
    int64_t *start; /* CSR over bins: bins[0]*bins[1]*bins[2] + 1, first axis fastest */
    int32_t *node;  /* nodes of each bin, ascending */
    double *place;  /* for each of `node`: coordinates and radius, dim + 1 */
};

/* Node coordinates are the caller's and must outlive the grid. */
struct point_grid {
    int dim;
    int64_t node_count;
    const double *x;
    int level_count;
    struct point_grid_level level[POINT_GRID_LEVELS];
};

/* Sort the nodes into bins, in time and memory linear in node_count for any grading. All radii must be
 * positive and finite. */
MUST_CHECK enum status point_grid_build(struct point_grid *grid, int dim, int64_t node_count, const double *x,
                                        const double *radius, struct error *error);
void point_grid_free(struct point_grid *grid);

/* A growing list of node indices. */
struct index_list {
    int32_t *index;
    int64_t count, capacity;
};
void index_list_free(struct index_list *list);

/* Append to `list` the nodes j with |x - x_j| < factor R_j, in ascending order. */
MUST_CHECK enum status point_grid_query(const struct point_grid *grid, const double *x, double factor,
                                        struct index_list *list, struct error *error);

/* The same, where x is the point of the box low .. high nearest to each node. So it finds every node that a
 * query for a point of the box would find. */
MUST_CHECK enum status point_grid_query_box(const struct point_grid *grid, const double *low,
                                            const double *high, double factor, struct index_list *list,
                                            struct error *error);

/* The nodes nearest to a point, by distance, of equally near ones the lower first. */
enum { NEAREST_MOST = 24 };
struct nearest_nodes {
    int64_t count;
    int32_t node[NEAREST_MOST];
    double distance[NEAREST_MOST];
};

/* The `most` nodes nearest to x, at most NEAREST_MOST, of those that the function (NULL: all) accepts; fewer
 * if there are no more. All radii of the grid are equal; they only begin the search. STATUS_INPUT if the
 * nodes are too far away. */
typedef bool node_accepts(const void *context, int32_t node);
MUST_CHECK enum status point_grid_nearest(const struct point_grid *grid, const double *x, int64_t most,
                                          node_accepts *accepts, const void *context,
                                          struct nearest_nodes *nearest, struct error *error);

/* Room for `count` more indices; append one. */
MUST_CHECK enum status index_list_reserve(struct index_list *list, int64_t count, struct error *error);
MUST_CHECK static inline enum status index_list_add(struct index_list *list, int32_t index,
                                                    struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&list->index, list->count + 1, &list->capacity, error));
    list->index[list->count++] = index;
    return STATUS_OK;
}
