/* The steps of mesh_build, private to lib/io. */
#ifndef IO_MSH_BUILD_H
#define IO_MSH_BUILD_H

#include "base/status.h"
#include "io/msh.h"

#include <stdbool.h>
#include <stdint.h>

enum mesh_role { MESH_UNUSED, MESH_MIDSIDE, MESH_CORNER }; /* a corner of any element is a corner */

struct mesh_draft {
    struct mesh *mesh;
    const struct msh *msh;
    const struct mesh_options *options;
    int8_t *role;       /* msh->node_count: what each node is to the elements, an enum mesh_role */
    int32_t *region_of; /* msh->element_count: the region of each cell that is kept, -1 for all else */
    int32_t *node_of;   /* msh->node_count: node of the mesh, or -1 */
    int64_t *origin;    /* mesh->cell_count: the element that each cell is made of */
    struct error *error;
};

/* Append a note (printf-style). */
MUST_CHECK enum status mesh_add_note(struct mesh_draft *draft, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

void mesh_names_free(struct mesh_names *names);

/* Index of the name of that length, or -1. */
int32_t mesh_find_name(const struct mesh_names *names, const char *name, size_t length);

/* Dimension of an element's type, and how many of its nodes count: its corners or all. */
int mesh_element_dim(const struct mesh_draft *draft, int64_t element);
int mesh_used_nodes(const struct mesh_draft *draft, int64_t element);

/* The simplices of an element, of nodes of the mesh or -1; returns how many. Of a quadrangle in the plane
 * whose corners do not go round a convex one, those on the inner diagonal. */
#define MESH_MOST_SIMPLICES 48
int mesh_simplices(const struct mesh_draft *draft, int64_t element,
                   int32_t simplices[MESH_MOST_SIMPLICES][4]);

/* Fill draft->role; an error for elements that the options want split and that cannot be. */
MUST_CHECK enum status mesh_find_roles(struct mesh_draft *draft);

/* Choose the dimension, that of the highest elements, at least 2, where they lie in a plane z = const; name
 * the regions; fill draft->region_of. */
MUST_CHECK enum status mesh_find_dim(struct mesh_draft *draft);
MUST_CHECK enum status mesh_pick_regions(struct mesh_draft *draft);

/* Number the nodes of the cells that are kept, in the order of the file, and take their coordinates; split
 * these cells into simplices, and turn these to be positive. */
MUST_CHECK enum status mesh_build_nodes(struct mesh_draft *draft);
MUST_CHECK enum status mesh_build_cells(struct mesh_draft *draft);

/* Two nodes of the mesh within 1e-12 of its extent are an error if cells connect them, else a note: two
 * bodies that touch. */
MUST_CHECK enum status mesh_check_coincident(struct mesh_draft *draft);

/* Facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh_draft *draft);

#endif
