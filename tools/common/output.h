/* An output file that appears under its name only when it is complete. */
#pragma once

#include "tool.h"

struct output {
    FILE *file;
    const char *name; /* given by the user, for messages; the caller's */
    char *target;     /* the file to replace, with symbolic links followed */
    char *temporary;  /* temporary file in the same folder; NULL if the target is a device or pipe */
};

/* Begin to write a file, or NULL: standard output: a temporary file in the same folder, removed if the
 * program ends by exit() or by SIGINT, SIGTERM, SIGHUP or SIGXCPU before output_end; with `grows` NAME.part,
 * which stays, for an output that grows while it is computed. An existing device or pipe is opened as it is.
 * One output at a time. */
MUST_CHECK enum status output_open(struct output *output, const char *name, bool grows, struct error *error);

/* The same for a stream, to tool->output. Refuses to write binary to a terminal. */
MUST_CHECK enum status output_open_stream(struct output *output, const struct tool *tool, bool grows,
                                          struct error *error);

/* Close the output and rename the file to its target; if this or the writing, by `status` and by the state of
 * `file`, failed, remove it. Reports delayed write errors. The message of a failure begins with the name. */
MUST_CHECK enum status output_end(struct output *output, enum status status, struct error *error);
