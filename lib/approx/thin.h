/* Parts of a body that are thin compared with its cells: they are too stiff in bending. */
#pragma once

#include "approx/cells.h"

/* The thickness of a body at a facet of the boundary is the way from the facet's middle straight into the
 * body, to where that leaves it through a facet that faces the other way, to 60 degrees. It counts in lengths
 * of the facet's edges (2D: the facet); and only where it is below the bound also in mean lengths of the
 * edges of the cells on the way: behind long facets of a boundary with few nodes there may be many cells. */
struct thin_report {
    double share;    /* part of the boundary, by area or length, where that is less than the bound */
    double least;    /* the least thickness; the bound where there is none below it */
    double place[3]; /* the middle of that facet, m */
};

/* Errors: as cells_across; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                                       struct error *error);
