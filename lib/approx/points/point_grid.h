/* Cell lists for the question "which nodes' supports contain x?", with radii that may differ from node to
 * node. */
#pragma once

#include "base/status.h"

#include <stdint.h>

#define POINT_GRID_LEVELS 40

/* One octave of radii: the nodes of that level in bins of half its largest radius or more. */
struct point_grid_level {
    double origin[3], bin; /* lower corner; edge of a bin */
    double per_length;     /* 1 / bin */
    int64_t bins[3];       /* bins along each axis (1 beyond dim) */
    double largest_radius;
    int64_t *start;       /* CSR over bins: bins[0]*bins[1]*bins[2] + 1, the first axis quickest */
    int32_t *node;        /* nodes of each bin, ascending */
    double *place;        /* following node: coordinates and radius, dim + 1 each */
    int64_t *touch_start; /* CSR over bins, NULL unless point_grid_list_touching was called: */
    int32_t *touch; /* the places in `node` of the nodes whose supports meet each bin, ascending by node */
};

/* Node coordinates and radii are the caller's and must outlive the grid. */
struct point_grid {
    int dim;
    int64_t node_count;
    const double *x, *radius;
    int level_count;
    struct point_grid_level level[POINT_GRID_LEVELS];
};

/* Sort the nodes into bins: time and memory linear in node_count, whatever the grading. All radii must be
 * positive and finite. */
MUST_CHECK enum status point_grid_build(struct point_grid *grid, int dim, int64_t node_count, const double *x,
                                        const double *radius, struct error *error);
void point_grid_free(struct point_grid *grid);

/* List which supports touch each bin: for many queries of points, by a factor of at most 1. */
MUST_CHECK enum status point_grid_list_touching(struct point_grid *grid, struct error *error);

/* A growing list of node indices. */
struct index_list {
    int32_t *index;
    int64_t count, capacity;
};
void index_list_free(struct index_list *list);

/* Append to `list` the nodes j with |x - x_j| < factor R_j, in ascending order. */
MUST_CHECK enum status point_grid_query(const struct point_grid *grid, const double *x, double factor,
                                        struct index_list *list, struct error *error);

/* The same where x is the point of the box low .. high that is nearest to each node: all nodes that a query
 * for a point of the box would find, and others. */
MUST_CHECK enum status point_grid_query_box(const struct point_grid *grid, const double *low,
                                            const double *high, double factor, struct index_list *list,
                                            struct error *error);

/* Append the places, in `node` and `place` of a level, of those of its nodes whose supports, of `factor`
 * times their radius, reach the box, in no particular order. */
MUST_CHECK enum status point_grid_list_places(const struct point_grid *grid,
                                              const struct point_grid_level *level, const double *low,
                                              const double *high, double factor, struct index_list *list,
                                              struct error *error);

/* Room for `count` more indices. */
MUST_CHECK enum status index_list_reserve(struct index_list *list, int64_t count, struct error *error);
