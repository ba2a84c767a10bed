/* A label image as the labels of the library; a table names, merges and omits its values. Then the sizes
 * of its cells, and the cells as a mesh or surface. */
#pragma once

#include "tool.h"

#include "approx/cells/cells.h"
#include "approx/labels/label_cells.h"
#include "io/image/image.h"
#include "io/image/label_table.h"
#include "stages/views.h"

struct label_image {
    struct labels labels;
    struct label_table table; /* label l is table.names.name[l] */
    double *volume;           /* labels.count: of its voxels, m3 (2D: m2) */
    double voxel_volume;
};

/* Read label images, the operands; "-" and none: standard input. The options --labels, --unit and --slice
 * tell the table of their names, the unit of their lengths, and the slice to take. Those behind the first one
 * lie on top where they are not 0. "3=FILE": voxels of FILE that are not 0 have the label 3. Exits on
 * failure: another grid than that of the first; errors of image_read_from and label_table_read, values that
 * are not integers, several values at a voxel, a label that is not in the table, a name without a voxel, a
 * slice that is not perpendicular to a world axis, and a body of impossible size. */
void label_image_read(const struct tool *tool, struct label_image *image);
void label_image_free(struct label_image *image);

/* Put the cells into a stream, which borrows nodes and cells. Regions are the labels with cells. Facets are
 * the boundary, oriented outward, in groups A|B with the label A within and B beyond. Node sets are the
 * interfaces A|B between two regions, A the lower label. */
MUST_CHECK enum status label_mesh_put(const struct label_image *image, const struct label_cells *result,
                                      struct stream *stream, struct error *error);

/* The surface of labels as a table for the rigid bodies of scenes: the facets, and their move outward. */
struct label_surface_options {
    int32_t inner, outer; /* labels within and beyond; outer -1: any */
    double gap;           /* distance by which facets are moved outward, m */
};

/* Read the options --surface "A" or "A|B", B a label or outside, and --gap. Exits for other names. */
void label_surface_parse(const struct tool *tool, const struct label_image *image,
                         struct label_surface_options *options);

/* Write the facets, of which mesh keeps no others, to tool->output or standard output, m. 3D: the corners of
 * a triangle in each row, with the right-hand normal outward from A. 2D: curves with A on the left, a point
 * in each row, a blank line between curves. Exits on failure, also if there is no such facet. */
void label_surface_write(const struct tool *tool, struct label_cells *mesh,
                         const struct label_surface_options *options);
