/* What sections of known names promise to those who read them (lib/README.md), checked. */
#ifndef IO_INVARIANTS_H
#define IO_INVARIANTS_H

#include "io/stream.h"

/* Receives each violation as one line, "section: row: what", without newline. */
typedef void violation_function(void *context, const char *text);

/* Check every section whose name is known, whatever else the stream holds: types and shapes that agree with
 * each other, indices in range, ascending lists, finite coordinates, positive weights, radii and cell
 * volumes, partition of unity within 1e-9. At most one violation of each kind is told per section, the first;
 * the number told is returned. Sections that are absent break nothing. */
int64_t stream_check(const struct stream *stream, violation_function *tell, void *context);

#endif
