/* The steps of mesh_build. */
#ifndef IO_MSH_BUILD_H
#define IO_MSH_BUILD_H

#include "base/status.h"
#include "io/msh.h"

#include <stdbool.h>
#include <stdint.h>

struct mesh_draft {
    struct mesh *mesh;
    const struct msh *msh;
    int32_t *node_of; /* msh->node_count: node of the mesh, or -1 */
    int64_t *origin;  /* mesh->cell_count: the element that each cell is made of */
    struct error *error;
};

/* Append a name (copied) or a note (printf-style). */
MUST_CHECK enum status mesh_add_name(struct mesh_names *names, const char *name, struct error *error);
MUST_CHECK enum status mesh_add_note(struct mesh_draft *draft, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Index of a name, or -1. */
int32_t mesh_find_name(const struct mesh_names *names, const char *name);

/* The name of a group as one of `names`: an error for blanks, commas, and a name that is there already. */
MUST_CHECK enum status mesh_add_group(struct mesh_names *names, const struct msh_group *group,
                                      struct error *error);

/* Dimension of an element's type. */
int mesh_element_dim(const struct msh *msh, int64_t element);

/* The dimension of the mesh is that of its highest elements, at least 2; in 2 these lie in a plane z = const.
 */
MUST_CHECK enum status mesh_find_dim(struct mesh_draft *draft);
MUST_CHECK enum status mesh_check_plane(const struct mesh_draft *draft);

/* Name the regions; region_of[element] receives the region of each cell that is kept, -1 for all else.
 * `wanted` is as for mesh_build. */
MUST_CHECK enum status mesh_pick_regions(struct mesh_draft *draft, const char *wanted, int32_t region_of[]);

/* Number the nodes of the cells that are kept, in the order of the file, and take their coordinates. */
MUST_CHECK enum status mesh_build_nodes(struct mesh_draft *draft, const int32_t region_of[], double unit);

/* Split the cells that are kept into simplices, turn these to be positive. */
MUST_CHECK enum status mesh_build_cells(struct mesh_draft *draft, const int32_t region_of[]);

/* Two nodes of the mesh within 1e-12 of its extent are an error if cells connect them, else a note: two
 * bodies that touch. */
MUST_CHECK enum status mesh_check_coincident(struct mesh_draft *draft);

/* Facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh_draft *draft);

#endif
