/* Where groups of facets end, and which nodes lie beside that. A held part of the boundary that ends at a
 * free one bends the field sharply there: the nodes beside such an end get smaller supports (see support.h).
 */
#ifndef APPROX_ENDS_H
#define APPROX_ENDS_H

#include "approx/cells.h"

/* Named facets of the boundary: facet[count * dim] node indices, set[count] the group of each. */
struct named_facets {
    int64_t count;
    const int32_t *facet, *set;
};

/* What a node lies beside: an end, a node where a group of facets ends (some of the boundary's faces at it
 * are of the group, and some are not), is at a corner where the boundary turns by 45 degrees or more there.
 */
enum beside { BESIDE_NOTHING, BESIDE_CORNER, BESIDE_END };

/* beside[node_count]: for the nodes in a cell with an end that are not ends themselves; of both, BESIDE_END.
 * STATUS_INPUT for facets that are none. */
MUST_CHECK enum status cells_beside_ends(const struct cells *cells, const struct named_facets *facets,
                                         enum beside *beside, struct error *error);

#endif
