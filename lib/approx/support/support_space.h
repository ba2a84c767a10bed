/* The nodes of a body with their support radii, and their visibility through its cells. If cells have sides
 * (support_options.side), each side is a body of its own, with the nodes of the interface: a neighbour of a
 * point is a node of the cells on the point's side. So shape functions have a kink at an interface, like a
 * displacement where the stiffness jumps. Points of faces and nodes on an interface take the lowest of the
 * sides that meet there, so that the field has a single value there. Supports of points that have no good one
 * on their side, e.g. a sliver, reach across. */
#pragma once

#include "approx/support/support.h"

/* One side; without interfaces the whole body. */
struct support_side {
    int64_t node_count, cell_count;
    int32_t *node;  /* node_count: their numbers in the whole body, ascending; NULL: all */
    int32_t *local; /* cell_count * (dim + 1): the cells, by nodes of the side; NULL: the body's */
    double *x, *radius;
    struct point_grid grid;
    struct visibility visibility; /* where neighbours must be visible through cells */
};

/* The arrays of the cells and the radii are the caller's and must outlive this. */
struct support_space {
    struct cells cells;
    const double *radius;
    bool by_cells;            /* neighbours must be visible through the cells; else all within their radius */
    const int32_t *cell_side; /* the caller's: cells.count, or NULL: one side */
    int64_t side_count;
    struct support_side *side; /* side_count */
    int32_t *place;            /* cells.count, with several sides: the number of each cell on its side */
};

/* radius[node_count], m. Errors: STATUS_INPUT for cells that share a face with more than one other, and,
 * with sides, for a node of no cell. */
MUST_CHECK enum status support_space_build(const struct support_options *options, const struct cells *cells,
                                           const double *radius, struct support_space *space,
                                           struct error *error);
void support_space_free(struct support_space *space);

/* The lists of points x[count * dim] in the cells of `places` (NULL: not known): see support_build. */
MUST_CHECK enum status support_space_lists(const struct support_options *options,
                                           const struct support_space *space,
                                           const struct visibility_places *places, int64_t count,
                                           const double *x, const char *what, struct support_lists *lists,
                                           struct error *error);
