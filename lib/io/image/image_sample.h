/* Values of an image between its voxels. */
#pragma once

#include "io/image/image.h"

enum image_method { IMAGE_NEAREST, IMAGE_LINEAR, IMAGE_CUBIC, IMAGE_METHOD_COUNT };

/* Names for command lines: "nearest", "linear", "cubic". */
extern const char *const image_method_names[IMAGE_METHOD_COUNT];

/* values[components] at a place in voxel coordinates. False, without values, if the place is in no voxel:
 * more than half a voxel beyond the outermost centres. Within that half, the outermost values are continued.
 * IMAGE_CUBIC: the convolution of Keys 1981 with a = -1/2 along each axis, which reproduces quadratic
 * functions. */
bool image_sample(const struct image *image, enum image_method method, const double voxel[3], double *values);
