/* Conditions along the normals of curved sides: the normal is that at rest, so a point that slides along its
 * tangent leaves the surface. */
#pragma once

#include "base/status.h"

#include <stdint.h>

struct sliding {
    int64_t row_count, row_room;
    int64_t *row; /* the constraint rows on these sides, ascending */
    int64_t facet_count, facet_room;
    int32_t (*facet)[3]; /* dim nodes of each facet of these sides, oriented outward */
};
void sliding_free(struct sliding *sliding);

/* Append a row, and a facet, node[dim]. STATUS_SYSTEM: memory. */
MUST_CHECK enum status sliding_add_row(struct sliding *sliding, int64_t row, struct error *error);
MUST_CHECK enum status sliding_add_facet(struct sliding *sliding, int dim, const int32_t *node,
                                         struct error *error);
