/* Parts of boundary.c, in boundary_sides.c; private to lib/approx. */
#pragma once

#include "approx/shape/boundary.h"

/* face_of[i]: the index in the table of facet i of the set. STATUS_INPUT where a facet is no face of the
 * table, or has a node that does not exist. */
MUST_CHECK enum status boundary_find_faces(const struct face_table *table, const struct facet_set *set,
                                           int64_t *face_of, struct error *error);

/* Outward unit normal (three components, in 2D the last one 0) and size, m or m2, of a facet. */
void boundary_unit_normal(const struct face_table *table, const int32_t *facet, double *normal, double *size);

/* A corner of a facet, and the part that it belongs to. */
struct corner {
    int32_t node;
    int32_t vertex; /* of the facet */
    int32_t side;   /* of an interface, that the facet is on */
    int64_t facet;  /* of the set */
    int64_t part;
};

/* The corners[set->count * dim] of the set, whose facets are those faces of the table, sorted by part; with
 * `split`, a node has a part for each side of the boundary there. */
void boundary_collect_corners(const struct face_table *table, const struct facet_set *set,
                              const int64_t *face_of, bool split, struct corner *corners,
                              int64_t *part_count);

/* Append to the corners[2 * set->count * dim], sorted by part, those of whole sides: a part with all corners
 * of its facets for each side. Sides are the parts of a set within which facets that share an edge (2D: a
 * node) turn by less than 45 degrees, pieces those that hang together by nodes. group[set->count]: with
 * `split` the side, else the piece of each facet, numbered as they come. */
MUST_CHECK enum status boundary_add_sides(const struct face_table *table, const struct facet_set *set,
                                          bool split, struct corner *corners, int64_t *part_count,
                                          int64_t *group, int64_t *group_count, struct error *error);
