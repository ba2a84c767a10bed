/* Parts of the labels of an image by place: their boundary is a group of its own. */
#pragma once

#include "images/label_image.h"

/* Split labels that are kept by the uses of --part: NAME=ball:X,Y,Z,RADIUS (2D: X,Y,RADIUS), lengths with a
 * unit, or NAME=IMAGE, whose voxels that are not 0 count. Voxels of a part get a label of its own, of the
 * same region. Of two that overlap the later one takes all. Exits on failure: other expressions, a name that
 * is taken, a part without a voxel of a label that is kept. */
void label_parts_make(const struct tool *tool, struct label_image *image);
