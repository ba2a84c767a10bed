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

/* The name of a group as one of `names`: an error for blanks, commas, and a name that is there already. */
MUST_CHECK enum status mesh_add_group(struct mesh_names *names, const struct msh_group *group,
                                      struct error *error);

/* Two nodes of the mesh within 1e-12 of its extent are an error. */
MUST_CHECK enum status mesh_check_coincident(struct mesh_draft *draft);

/* Facets and node sets from the elements of lower dimension. */
MUST_CHECK enum status mesh_build_facets(struct mesh_draft *draft);

#endif
