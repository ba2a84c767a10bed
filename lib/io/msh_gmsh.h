/* The only part that calls libgmsh. */
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

#endif
