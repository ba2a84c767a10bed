/* Quality of background cells. */
#pragma once

#include "approx/cells/cells.h"

/* dim r / R of a cell, r the radius of its inscribed and R of its circumscribed circle or sphere: 1 for the
 * regular simplex, 0 without volume, negative if inverted. (The radius ratio of Liu and Joe, Relationship
 * between tetrahedron shape measures, BIT 34, 1994; gmsh calls it gamma.) Whatever nodes, finite or not. */
double cell_quality(const struct cells *cells, int64_t cell);

/* Below this a cell is called poor; smoothed cells are then merged with a neighbour
 * (solid/body/merged_cells.h).
 */
#define POOR_QUALITY 1e-2

struct poor_cell {
    int64_t cell;
    double quality;
};

/* The `most` poorest cells of quality below `bound`, the poorest first, into poorest[most]; returns how many
 * cells are below it. */
int64_t cells_poorest(const struct cells *cells, double bound, int most, struct poor_cell poorest[]);
