/* Cutting a body along a blade: cells are divided, nodes on the blade doubled, the faces of the cut become
 * facets.
 *
 * The height of a node over a sheet of the blade has a sign; the sheet is continued beyond its border along
 * its tangents. Edges between heights of different signs are split where they meet it, in all cells that the
 * sheet itself meets. Then faces of the cells lie on it, and the same is done with the edges of these faces
 * and the extent from the border: the edge of the cut is the border of the blade. Faces within the border are
 * opened: a node is doubled where the cells around it are not connected any more.
 *
 * A node as near to the blade as a part of an edge is moved onto it first, as in isosurface stuffing (Labelle
 * and Shewchuk 2007), so that few slivers are made: along edges that stay on the boundaries between bodies,
 * regions and groups on which the node lies, if its cells stay good. */
#pragma once

#include "solid/incision/blade.h"
#include "solid/incision/division.h"

/* Cut along one sheet. The faces of the cut become facets of the groups front, that of the cells in front
 * of the sheet, and back. *opened: how many faces are opened; 0: the sheet meets no cell, lies on the
 * boundary, or within one cell. Errors: STATUS_INPUT as faces_build, STATUS_SYSTEM (memory). */
MUST_CHECK enum status incision_cut(struct division *body, const struct sheet *sheet, int32_t front,
                                    int32_t back, int64_t *opened, struct error *error);
