/* Quality of background cells, and parts of a body that are one cell thick. */
#pragma once

#include "approx/cells/cells.h"

/* The radius ratio of a cell, dim r / R with the radii r of its inscribed and R of its circumscribed circle
 * or sphere (Liu and Joe, Relationship between tetrahedron shape measures, BIT 34, 1994; gamma in gmsh): 1
 * for the regular simplex, 0 without volume, negative if inverted. Node coordinates need not be finite.
 * angles[2], or NULL: the least and the largest angle between faces (2D: edges), degrees; 0 and 180 without
 * volume or inverted. */
double cell_quality(const struct cells *cells, int64_t cell, double angles[2]);

/* A cell of lower quality is poor; smoothed cells are then merged with a neighbour
 * (solid/body/merged_cells.h). */
#define POOR_QUALITY 1e-2

/* Parts that are one cell thick: the facets of the boundary whose cell has its other corner on the boundary,
 * too, where that faces the other way. */
struct thin_report {
    double share;    /* of these facets in the boundary, by area or length */
    double place[3]; /* the middle of the largest, m */
};

/* Errors: as cells_across; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_thin(const struct cells *cells, struct thin_report *report,
                                       struct error *error);
