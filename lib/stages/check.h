/* Check of a whole stream against the table of sections (io/stream/sections.h, lib/README.md) and the views.
 */
#pragma once

#include "io/stream/stream.h"

/* Receives each violation as one line, "section: row: what", without newline. */
typedef void violation_function(void *context, const char *text);

/* Check every section that the table knows, whatever else the stream holds: first each by itself, its type,
 * columns, rows and numbers; then, where these are right, what they say together: positive volumes of cells,
 * groups, faces, ascending lists, partition of unity within 1e-9. Of a section the first violation is
 * reported; *count receives how many were. Absent sections are no violation. STATUS_SYSTEM where memory is
 * short. */
MUST_CHECK enum status stream_check(const struct stream *stream, violation_function *report, void *context,
                                    int64_t *count, struct error *error);
