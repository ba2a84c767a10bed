/* What nodes, cloud and voxels say of bodies that are thin compared with their cells. */
#ifndef TOOLS_THIN_NOTE_H
#define TOOLS_THIN_NOTE_H

#include "approx/cells.h"
#include "tool.h"

/* Note where a tenth of the boundary or more is on parts about one cell thick. Exits with a message where
 * memory fails. */
void tool_note_thin(const struct tool *tool, const struct cells *cells);

#endif
