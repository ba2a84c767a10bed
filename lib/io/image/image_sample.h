/* Values of an image between its voxels. */
#pragma once

#include "io/image/image.h"

enum image_method { IMAGE_NEAREST, IMAGE_LINEAR, IMAGE_CUBIC, IMAGE_METHOD_COUNT };

/* Names for command lines: "nearest", "linear", "cubic". */
extern const char *const image_method_names[IMAGE_METHOD_COUNT];

/* values[components] at a place of voxel coordinates. False, and no values, where the place lies in no voxel:
 * beyond half a voxel of the outermost centres; within that half, the outermost values go on. Cubic: the
 * convolution of Keys 1981 with a = -1/2, which reproduces quadratic functions; along each axis. */
bool image_sample(const struct image *image, enum image_method method, const double voxel[3], double *values);
