/* Nodes that hang on a facet of another cell: they lie on it, but are not its corners, as where two meshes of
 * different fineness meet. The cells are not joined there. */
#pragma once

#include "approx/cells/cells.h"

/* Nodes that hang, and the place of the first one, m. */
struct hanging_nodes {
    int64_t count;
    double place[3];
};

/* Find the nodes on the boundary that hang on facets of the boundary. *joined: those on a facet of their own
 * body, to which cells with common nodes connect them; *apart: those on a facet of another body alone, or of
 * another face of a slit: their own facet and the other are among named[named_count * dim]. Errors: as
 * faces_build; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_hanging(const struct cells *cells, int64_t named_count,
                                          const int32_t *named, struct hanging_nodes *joined,
                                          struct hanging_nodes *apart, struct error *error);
