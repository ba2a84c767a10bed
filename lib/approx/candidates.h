/* Nodes that come into question as neighbours of a group of near points, found once for all of them; private
 * to lib/approx. */
#ifndef APPROX_CANDIDATES_H
#define APPROX_CANDIDATES_H

#include "approx/point_grid.h"

struct candidates {
    int dim;
    struct index_list list; /* node indices, ascending */
    int64_t capacity;       /* of the arrays below */
    double *place;          /* [dim][capacity]: coordinates */
    double *reach2;         /* squared support radii, with their factor */
    double *margin;         /* scratch */
};

/* All nodes j with |x - x_j| < factor R_j for some x of the box low .. high, and others. */
MUST_CHECK enum status candidates_find(struct candidates *candidates, const struct point_grid *grid,
                                       const double *low, const double *high, double factor,
                                       struct error *error);
void candidates_free(struct candidates *candidates);

/* Append to `list` those with |x - x_j| < factor R_j, x in the box, ascending: what point_grid_query gives.
 */
MUST_CHECK enum status candidates_within(struct candidates *candidates, const double *x,
                                         struct index_list *list, struct error *error);

#endif
