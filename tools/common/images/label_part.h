/* Parts of the labels of an image by position, whose boundary is a group of its own. */
#pragma once

#include "images/label_image.h"

/* Split kept labels by the uses of --part: NAME=ball:X,Y,Z,RADIUS (2D: X,Y,RADIUS), lengths with a unit, or
 * NAME=IMAGE with the nonzero voxels of an image. Voxels of a part get a label of their own in the same
 * region. Where parts overlap, the later one counts. Exits for other expressions, a repeated name, and a part
 * without a voxel of a kept label. */
void label_parts_make(const struct tool *tool, struct label_image *image);
