/* Parts of boundary.c, in boundary_sides.c; private to lib/approx. */
#pragma once

#include "approx/shape/boundary.h"

/* face_of[i]: the index in the table of facet i of the set. STATUS_INPUT if a facet is not a face of the
 * table, or has a node that does not exist. */
MUST_CHECK enum status boundary_find_faces(const struct face_table *table, const struct facet_set *set,
                                           int64_t *face_of, struct error *error);

/* Outward unit normal (three components, in 2D the last one 0) and size, m or m2, of a facet. */
void boundary_unit_normal(const struct face_table *table, const int32_t *facet, double *normal, double *size);

/* A corner of a facet, and the part to which it belongs. */
struct corner {
    int64_t part;   /* first, as it begins the order in which corners are sorted */
    int32_t node;   /* then this, */
    int32_t facet;  /* of the set, and this */
    int32_t number; /* among the corners of the set */
};

/* The corners[set->count * dim] of the set, whose facets are those faces of the table, sorted by part; with
 * `split`, a node has a part for each side of the boundary there. With sides, corners[2 * set->count * dim]:
 * also a part for each side with all corners of its facets; and *sides is filled in. */
MUST_CHECK enum status boundary_parts(const struct face_table *table, const struct facet_set *set,
                                      const int64_t *face_of, bool split, struct boundary_sides *sides,
                                      struct corner *corners, int64_t *part_count, struct error *error);
