/* Parts of a body that are thin compared with its cells: they are too stiff in bending. */
#pragma once

#include "approx/cells/cells.h"

/* The thickness of a body at a boundary facet is the length of the ray from the facet's middle along its
 * inward normal to where it leaves the body, through a facet whose normal is opposite to within 60 degrees.
 * It is measured in lengths of the facet's edges (2D: of the facet). A facet counts as thin if the thickness
 * is below the bound in this measure and also in mean edge lengths of the cells on the ray, as behind long
 * facets of a boundary with few nodes there may be many cells. */
struct thin_report {
    double share;    /* part of the boundary, by area or length, where that is less than the bound */
    double least;    /* the least thickness; the bound where there is none below it */
    double place[3]; /* the middle of that facet, m */
};

/* Errors: as cells_across; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                                       struct error *error);
