/* Which cell each point of a regular grid lies in. */
#pragma once

#include "approx/cells/cells.h"

/* owner[size[0] * size[1] * size[2]], the first axis quickest: the lowest of the cells that hold the grid
 * point of these indices, -1: none. cells->x are the nodes in units of the grid: its points are the whole
 * numbers from 0. size[2] = 1 in 2D. Only cells whose determinant has the given sign (1 or -1) are taken:
 * where the map to the grid mirrors, sound cells have -1; others are folded. *doubly: grid points that more
 * than one of them holds, beyond their faces. Threads share the work; the result does not depend on their
 * number. */
void raster_cells(const struct cells *cells, int sign, const int64_t size[3], int32_t *owner,
                  int64_t *doubly);
