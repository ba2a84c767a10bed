/* Whether the contact nodes resolve the contact area. */
#pragma once

#include "approx/cells/cells.h"
#include "solid/contact/contact.h"

/* A contact node presses where the points that press have more than half of its weight. The contact area is
 * resolved around a node that presses together with all its neighbours on the contact's facets: it is then
 * three nodes across, or wider at the rim of the facets, where a plane of symmetry may be. */
struct contact_patch {
    int64_t pressing; /* nodes */
    double force;     /* sum p A over contact nodes and points, N (2D: N/m) */
    double thin;      /* part of it that is not at the nodes of a resolved patch, 0 to 1 */
    int32_t node;     /* with the largest force in that part; -1: none */
    double inside; /* how far from the facets a vertex of the surface lies in a cell of the body, at most, m;
                      0: none does. Only looked for when nothing presses */
    double place[3]; /* of that vertex, m */
    double width;    /* of a facet that a contact node stands for, on average, m */
};

/* The contact as it was evaluated last, on facets set; the body's cells where it has moved to.
 * STATUS_SYSTEM for memory. */
MUST_CHECK enum status contact_patch_find(const struct contact *contact, const struct facet_set *set,
                                          const struct cells *cells, struct contact_patch *patch,
                                          struct error *error);
