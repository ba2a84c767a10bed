/* Local sizes of the cells of a label image: at interfaces, and from the sizes of a solution. */
#pragma once

#include "images/label_image.h"

#include "approx/cells/cells.h"

/* The value of --fine, "3mm" or "3mm:ventricles,tumour", which must be less than `spacing`, m: *finest, m.
 * Returns an array of labels, to be freed; NULL: of all. Exits on failure. */
bool *label_fine_parse(const struct tool *tool, const struct label_image *image, const char *text,
                       double spacing, double *finest);

/* Sizes at the nodes of cells, as views of a stream, which is to be freed. */
struct label_sizes {
    struct stream stream;
    struct cells cells;
    const double *size; /* cells.node_count, m, positive; NULL: no sizes */
};

/* Read the sections nodes.x, cells and size of the stream `file` (NULL: no sizes), in the dimension of the
 * image. Exits on failure. */
void label_sizes_read(const struct tool *tool, const struct label_image *image, const char *file,
                      struct label_sizes *sizes);
