/* Quality of background cells. */
#pragma once

#include "approx/cells/cells.h"

/* The radius ratio of a cell, dim r / R with the radii r of its inscribed and R of its circumscribed circle
 * or sphere (Liu and Joe, Relationship between tetrahedron shape measures, BIT 34, 1994; gamma in gmsh): 1
 * for the regular simplex, 0 without volume, negative if inverted. Node coordinates need not be finite. */
double cell_quality(const struct cells *cells, int64_t cell);

/* A cell of lower quality is poor; smoothed cells are then merged with a neighbour
 * (solid/body/merged_cells.h). */
#define POOR_QUALITY 1e-2
