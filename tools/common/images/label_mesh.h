/* Cells made of labels, as the mesh that goes into a stream. */
#pragma once

#include "images/label_image.h"

#include "approx/labels/label_cells.h"
#include "io/mesh/msh.h"

/* Regions are the labels that have cells; facets the boundary in groups A|B, A the label within and B the one
 * beyond, or of a part and outside that of its name, oriented outward; node sets the interfaces A|B between
 * two regions, A the lower label. The mesh borrows nodes and cells of *mesh: release it by
 * label_mesh_free. */
MUST_CHECK enum status label_mesh_make(const struct label_image *image, const struct label_cells *result,
                                       struct mesh *mesh, struct error *error);
void label_mesh_free(struct mesh *mesh);
