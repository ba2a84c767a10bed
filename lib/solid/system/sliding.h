/* Conditions along the normals of curved sides: the normal is that at rest, so a point that slides along its
 * tangent leaves the surface. */
#pragma once

#include "base/status.h"

#include <stdint.h>

/* A facet of such a side. */
struct sliding_facet {
    int32_t side; /* numbered in the order of the sections */
    int32_t node[3], section;
};

struct sliding {
    int64_t row_count, row_room;
    int64_t *row; /* the constraint rows on these sides, ascending */
    int64_t facet_count, facet_room;
    struct sliding_facet *facet; /* ascending by side; dim nodes of each, oriented outward */
    int32_t side_count;
};
void sliding_free(struct sliding *sliding);

/* Append a row, and a facet of one of the sides from side_count on. STATUS_SYSTEM: memory, here and below. */
MUST_CHECK enum status sliding_add_row(struct sliding *sliding, int64_t row, struct error *error);
MUST_CHECK enum status sliding_add_facet(struct sliding *sliding, const struct sliding_facet *facet,
                                         struct error *error);

/* Sort the facets that were appended since there were `first`, of `sides` sides. */
void sliding_sort(struct sliding *sliding, int64_t first, int64_t sides);

/* Where a facet slides by s, with unit normals n of the side, it leaves the surface by s . (grad n) s / 2. */
struct sliding_error {
    int32_t section;        /* whose share is the largest; -1: there are no such facets */
    double share;           /* mean distance from the surface by mean slide, 0 to 1 */
    double slide, distance; /* at the facet that is farthest from the surface, m, */
    double place[3];        /* and its middle at rest, m */
};

/* For the displacements u[node_count * dim] of nodes X[node_count * dim]. */
MUST_CHECK enum status sliding_measure(const struct sliding *sliding, int dim, int64_t node_count,
                                       const double *X, const double *u, struct sliding_error *worst,
                                       struct error *error);
