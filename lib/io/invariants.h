/* Check of the sections with known names against their definitions in lib/README.md. */
#ifndef IO_INVARIANTS_H
#define IO_INVARIANTS_H

#include "io/stream.h"

/* Receives each violation as one line, "section: row: what", without newline. */
typedef void violation_function(void *context, const char *text);

/* Check every section whose name is known, whatever else the stream holds: types and shapes that agree with
 * each other, indices in range, ascending lists, finite coordinates, positive weights, radii and cell
 * volumes, partition of unity within 1e-9. Of each kind of violation the first in a section is reported;
 * returns the number of reports. Absent sections are no violation. */
int64_t stream_check(const struct stream *stream, violation_function *report, void *context);

#endif
