/* Whether the contact nodes resolve the contact area. */
#pragma once

#include "approx/cells/cells.h"
#include "solid/contact/contact.h"

/* A contact node presses if the points that press have more than half of its weight. The contact area is
 * resolved around a node that presses together with all its neighbours on the contact's facets: the area is
 * then at least three nodes across. The rim of the facets may be a plane of symmetry, and does not count as
 * unresolved. */
struct contact_patch {
    int64_t pressing; /* nodes */
    double force;     /* sum p A over contact nodes and points, N (2D: N/m) */
    double thin;      /* the share of it outside of resolved patches, 0 to 1 */
    int32_t node;     /* with the largest force in that share; -1: none */
    double inside;   /* largest distance from the facets of a vertex of the surface that lies in a cell of the
                        body, m; 0: none does. Only set if nothing presses */
    double place[3]; /* of that vertex, m */
    double width;    /* mean width of the area of a contact node, m */
};

/* Describe a contact as it was evaluated last. set: its facets; cells: the body's, at their deformed
 * positions. STATUS_SYSTEM: memory. */
MUST_CHECK enum status contact_patch_find(const struct contact *contact, const struct facet_set *set,
                                          const struct cells *cells, struct contact_patch *patch,
                                          struct error *error);
