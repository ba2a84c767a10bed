/* The nodes of a body with their support radii, and their visibility through its cells. If cells have sides
 * (support_options.side), a neighbour of a point is a node of the cells on the point's side. So shape
 * functions have a kink at an interface, like a displacement where the stiffness jumps. Points of faces and
 * nodes on an interface take the lowest of the sides that meet there, so that the field has a single value
 * there. */
#pragma once

#include "approx/support/support.h"

/* The arrays of the cells and the radii are the caller's and must outlive this. */
struct support_space {
    struct cells cells;
    const double *radius;
    struct point_grid grid;
    struct visibility visibility; /* where neighbours must be visible through the cells */
};

/* Fill in a space, which stays where it is. radius[node_count], m. Errors: STATUS_INPUT for cells that share
 * a face with more than one other. */
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
