/* Names of the sections of frames: X.frame.K is section X in state K of a run; 0 is the state at its begin.
 */
#ifndef TOOLS_FRAMES_H
#define TOOLS_FRAMES_H

#include <stddef.h>
#include <stdint.h>

/* What frame_of gives for a section that belongs to no frame. */
#define FRAME_NONE (-1)

/* K of a section X.frame.K; FRAME_NONE for another section. *length receives that of X. */
int64_t frame_of(const char *name, size_t *length);

#endif
