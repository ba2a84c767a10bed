/* The surface of labels as a table for the rigid bodies of scenes. */
#pragma once

#include "images/label_image.h"

#include "approx/labels/label_cells.h"

/* Which facets, and how far they are moved outward, m. */
struct label_surface_options {
    int32_t inner, outer; /* labels within and beyond; outer -1: whatever is beyond */
    double gap;           /* 0: not moved */
};

/* Read "A" or "A|B", B a label or outside. Exits for other names. */
void label_surface_parse(const struct tool *tool, const struct label_image *image, const char *text,
                         struct label_surface_options *options);

/* Write the facets, right-hand normals outward of A: 3D a triangle's corners in each row; 2D closed curves
 * with A on the left, a point in each row, a blank line between curves; m. To tool->output or standard
 * output; exits on failure, also when there is no such facet. */
void label_surface_write(const struct tool *tool, const struct label_cells *mesh,
                         const struct label_surface_options *options);
