/* Cells made of labels, as the mesh that goes into a stream. */
#pragma once

#include "images/label_image.h"

#include "approx/labels/label_cells.h"
#include "io/mesh/msh.h"

/* Make the mesh. Regions are the labels with cells. Facets are the boundary, oriented outward, in groups A|B
 * with the label A within and B beyond, or with the name of a part. Node sets are the interfaces A|B between
 * two regions, A the lower label. The mesh borrows the nodes and cells of *result: release it by
 * label_mesh_free. */
MUST_CHECK enum status label_mesh_make(const struct label_image *image, const struct label_cells *result,
                                       struct mesh *mesh, struct error *error);
void label_mesh_free(struct mesh *mesh);
