/* A body and the voxels of an image. */
#pragma once

#include "tool.h"

#include "approx/cells/cells.h"
#include "io/image/image.h"

/* In which order the axes of the world, and those of the voxels, become the body's. */
struct image_axes {
    int world[3], voxel[3];
};

/* Bring the axes of an image into the order of the body's: changes nothing in 3D. A body in 2D lies in an
 * image of one slice across a world axis: its x and y are the other two, in their order. Exits on other
 * images in 2D. */
void image_to_body(const struct tool *tool, struct image *image, int dim, struct image_axes *axes);

/* The axes back in the order of the world and of the file. */
void image_from_body(struct image *image, const struct image_axes *axes);

/* For each voxel the cell that its centre lies in, the nodes being at x, or -1; free() it. *doubly: voxels in
 * more than one cell. */
int32_t *find_owners(const struct tool *tool, const struct image *grid, const struct cells *cells,
                     const double *x, int64_t *doubly);

/* Exit on units and spaces that cannot be: no voxel `inside` the body, or a body much larger than the image.
 */
void check_image_overlap(const struct tool *tool, const struct image *grid, const struct cells *cells,
                         const double *x, int64_t inside);

/* Volume of a voxel, m3, or its area in the plane of the body, m2. */
double voxel_volume(const struct image *image, int dim);

/* The shortest of the first dim steps between voxels, m. */
double least_step(const struct image *image, int dim);

/* Tell the volume of each label before and after; nothing where the values are not whole numbers, or too
 * many. */
void tell_label_volumes(const struct tool *tool, const struct image *before, const struct image *after,
                        int dim);
