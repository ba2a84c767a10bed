/* The cell that contains each point of a regular grid. */
#pragma once

#include "approx/cells/cells.h"

/* owner[size[0] * size[1] * size[2]], first axis fastest: the lowest cell that contains the grid point, or
 * -1. cells->x are in units of the grid, whose points have integer coordinates from 0; size[2] = 1 in 2D.
 * Only cells whose determinant has the sign `sign` (1 or -1) count: -1 if the map to the grid mirrors; the
 * others are inverted. *doubly: number of grid points inside more than one cell, faces excepted. Threaded;
 * the result does not depend on the number of threads. */
void raster_cells(const struct cells *cells, int sign, const int64_t size[3], int32_t *owner,
                  int64_t *doubly);
