/* An output file that appears under its name only when it is whole. */
#ifndef TOOLS_OUTPUT_H
#define TOOLS_OUTPUT_H

#include "base/status.h"

struct output {
    int descriptor;   /* to write to */
    const char *name; /* as the user named it; for messages, kept alive by the caller */
    char *target;     /* the file to replace, with symbolic links followed */
    char *temporary;  /* its stand-in in the same folder, NULL when the target is a device or pipe */
};

/* Begin to write: a temporary file in the same folder, removed if the program ends by exit() or by SIGINT,
 * SIGTERM, SIGHUP or SIGXCPU before output_commit. An existing device or pipe is opened as it is. One output
 * at a time. */
MUST_CHECK enum status output_open(struct output *output, const char *name, struct error *error);

/* End what was written with `status`: close, and give the file its name, or leave nothing behind where that
 * or the writing failed; the message then begins with its name. */
MUST_CHECK enum status output_end(struct output *output, enum status status, struct error *error);

/* Close and leave nothing behind; the file that had the name before stays as it was. */
void output_abandon(struct output *output);

#endif
