/* Check of a whole stream against the table of sections (io/stream/sections.h, lib/README.md) and the views.
 */
#pragma once

#include "io/stream/stream.h"

/* Receives each violation as one line, "section: row: what", without newline. */
typedef void violation_function(void *context, const char *text);

/* Check every section that is in the table. First each by itself: type, columns, rows and numbers. If these
 * are right, sections together: positive volumes of cells, groups, faces, ascending lists, partition of unity
 * within 1e-9. Only the first violation of a section is reported; *count: their number. Absent sections are
 * no violation. STATUS_SYSTEM: memory. */
MUST_CHECK enum status stream_check(const struct stream *stream, violation_function *report, void *context,
                                    int64_t *count, struct error *error);
