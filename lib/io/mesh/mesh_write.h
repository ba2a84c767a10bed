/* Writing the cells, facets and groups of a body as meshes for other programs. */
#pragma once

#include "io/mesh/msh.h"

#include <stdio.h>

/* A body as a stream holds it: arrays as in struct mesh, the caller's. Groups without names are not written.
 */
struct mesh_view {
    int dim;
    int64_t node_count, cell_count, facet_count;
    const double *x;                                    /* node_count x dim, m */
    const int32_t *cells, *region, *facets, *facet_set; /* region: cell_count, facet_set: facet_count */
    const int64_t *set_ptr;                             /* node_sets.count + 1 */
    const int32_t *set_idx;
    struct names regions, facet_sets, node_sets;
};

/* Print the body as a file of gmsh, MSH 4.1 as text: regions, groups of facets and node sets as physical
 * groups of the dimensions dim, dim - 1 and 0; lengths in `unit`, m. Nodes and elements count from 1, nodes
 * in their order. Errors of the file stay in it (ferror). STATUS_SYSTEM: memory. */
MUST_CHECK enum status mesh_write_msh(FILE *file, const struct mesh_view *mesh, double unit,
                                      struct error *error);

/* Print the body as a deck of Abaqus and CalculiX: *NODE, *ELEMENT (CPE3, C3D4) with an element set for each
 * region, *NSET for each node set, *SURFACE of element faces for each group of facets. STATUS_INPUT for a
 * facet that is no face of a cell; STATUS_SYSTEM: memory. */
MUST_CHECK enum status mesh_write_inp(FILE *file, const struct mesh_view *mesh, double unit,
                                      struct error *error);
