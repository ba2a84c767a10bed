/* The only part that calls libgmsh (msh_gmsh.c, msh_gmsh_groups.c). */
#ifndef IO_MSH_GMSH_H
#define IO_MSH_GMSH_H

#include "io/msh.h"
#include "io/msh_scan.h"

/* Have libgmsh read the file at `path`, which holds the parts of a file that `scan` found sound, and fill in
 * the coordinates, elements and groups of *msh in the order of that file. STATUS_INPUT when libgmsh finds
 * fault with it, or finds something else in it than the scan did. On failure *msh holds what msh_free
 * releases. */
MUST_CHECK enum status msh_load(struct msh *msh, const struct msh_scan *scan, const char *path,
                                struct error *error);

/* The groups of the mesh that is open in libgmsh: those that the file names, and those that have elements. */
MUST_CHECK enum status msh_load_groups(struct msh *msh, const struct msh_scan *scan, struct error *error);

/* The groups of each element. In MSH 2 the group stands beside each element (an element of two groups is
 * there twice, and libgmsh would have each entity's elements in all groups of that entity); in MSH 4 it is
 * the entity that has groups.
 * entities[2 * i] and [2 * i + 1] are the dimension and tag of entity i, entity_of[element] is the i of an
 * element. */
MUST_CHECK enum status msh_load_members(struct msh *msh, const struct msh_scan *scan, const int *entities,
                                        size_t entity_count, const int32_t entity_of[], struct error *error);

/* Fail with libgmsh's own last word on a failure of `what`. */
enum status msh_gmsh_fail(struct error *error, const char *what);

/* Fail because libgmsh and the scan found different things in the file. */
enum status msh_disagree(struct error *error, const char *what);

#endif
