/* A body and the voxels of an image. */
#ifndef TOOLS_IMAGE_BODY_H
#define TOOLS_IMAGE_BODY_H

#include "tool.h"

#include "approx/cells.h"
#include "io/image.h"

/* Exit unless a body of this dimension can go with the image: one in 2D needs one slice in the plane of x and
 * y. */
void check_image_plane(const struct tool *tool, const struct image *image, int dim);

/* For each voxel the cell that its centre lies in, the nodes being at x, or -1; free() it. *doubly: voxels in
 * more than one cell. */
int32_t *find_owners(const struct tool *tool, const struct image *grid, const struct cells *cells,
                     const double *x, int64_t *doubly);

/* Exit on units and spaces that cannot be: no voxel `inside` the body, or a body much larger than the image.
 */
void check_image_overlap(const struct tool *tool, const struct image *grid, const struct cells *cells,
                         const double *x, int64_t inside);

/* Volume of a voxel, m3, or its area in the plane of x and y, m2. */
double voxel_volume(const struct image *image, int dim);

/* The shortest of the first dim steps between voxels, m. */
double least_step(const struct image *image, int dim);

/* Tell the volume of each label before and after; nothing where the values are not whole numbers, or too
 * many. */
void tell_label_volumes(const struct tool *tool, const struct image *before, const struct image *after,
                        int dim);

#endif
