/* The surface of labels as a table for the rigid bodies of scenes. */
#pragma once

#include "images/label_image.h"

#include "approx/labels/label_cells.h"

/* The facets, and their move outward. */
struct label_surface_options {
    int32_t inner, outer; /* labels within and beyond; outer -1: any */
    double gap;           /* distance by which facets are moved outward, m */
};

/* Read "A" or "A|B", B a label or outside. Exits for other names. */
void label_surface_parse(const struct tool *tool, const struct label_image *image, const char *text,
                         struct label_surface_options *options);

/* Write the facets to tool->output or standard output, m. 3D: the corners of a triangle in each row, with the
 * right-hand normal outward from A. 2D: curves with A on the left, a point in each row, a blank line between
 * curves. Exits on failure, also if there is no such facet. */
void label_surface_write(const struct tool *tool, const struct label_cells *mesh,
                         const struct label_surface_options *options);
