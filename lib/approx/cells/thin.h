/* Parts of a body that are thin compared with its cells: they are too stiff in bending. */
#pragma once

#include "approx/cells/cells.h"

/* The thickness of a body at a boundary facet is the length of the ray from the facet's middle along its
 * inward normal to the point where it leaves the body, through a facet whose normal is opposite within 60
 * degrees. Its unit is the mean edge of the facet (2D: the facet's length). A facet is thin if the thickness
 * is below the bound in this unit and also in mean edges of the cells on the ray: behind the long facets of a
 * boundary with few nodes there may be many cells. */
struct thin_report {
    double share;    /* of thin facets in the boundary, by area or length */
    double least;    /* least thickness; the bound if there is none below it */
    double place[3]; /* the middle of that facet, m */
};

/* Errors: as cells_across; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                                       struct error *error);
