/* The steps of mesh_build; private to lib/io. */
#pragma once

#include "base/status.h"
#include "io/mesh/msh.h"

#include <stdint.h>

struct mesh_draft {
    struct mesh *mesh;
    const struct msh *msh;
    const struct mesh_options *options;
    int32_t *region_of; /* msh->element_count: the region of each kept cell, -1 for other elements */
    int32_t *node_of;   /* msh->node_count: node of the mesh, or -1 */
    int64_t *origin;    /* mesh->cell_count: the element of which each cell is a part */
    struct error *error;
};

/* Append a note, printed. */
#define mesh_add_note(draft, ...) names_print(&(draft)->mesh->notes, (draft)->error, __VA_ARGS__)

/* The dimension of an element, and the number of its corners: no other nodes are used. */
int mesh_element_dim(const struct mesh_draft *draft, int64_t element);
int mesh_corners(const struct mesh_draft *draft, int64_t element);

/* The simplices of an element, as nodes of the mesh or -1; returns their number. A quadrangle in the plane
 * that is not convex is split along its inner diagonal. */
#define MSH_MOST_SIMPLICES 6
int mesh_simplices(const struct mesh_draft *draft, int64_t element, int32_t simplices[MSH_MOST_SIMPLICES][4]);

/* Set the dimension, that of the highest elements: 3, or 2 if they lie in a plane z = const. Name the
 * regions, and set draft->region_of. */
MUST_CHECK enum status mesh_find_dim(struct mesh_draft *draft);
MUST_CHECK enum status mesh_pick_regions(struct mesh_draft *draft);

/* Make facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh_draft *draft);
