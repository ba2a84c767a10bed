/* An output file that appears under its name only when it is whole. */
#pragma once

#include "tool.h"

struct output {
    int descriptor;   /* to write to */
    const char *name; /* as the user named it; for messages, kept alive by the caller */
    char *target;     /* the file to replace, with symbolic links followed */
    char *temporary;  /* its stand-in in the same folder, NULL when the target is a device or pipe */
};

/* Begin to write: a temporary file in the same folder, removed if the program ends by exit() or by SIGINT,
 * SIGTERM, SIGHUP or SIGXCPU before output_end. An existing device or pipe is opened as it is. One output
 * at a time. */
MUST_CHECK enum status output_open(struct output *output, const char *name, struct error *error);

/* End what was written with `status`: close, and give the file its name, or leave nothing behind where that
 * or the writing failed; the message then begins with its name. */
MUST_CHECK enum status output_end(struct output *output, enum status status, struct error *error);

/* A file that a tool prints to: its output file, or standard output. */
struct target {
    FILE *file;       /* to print to */
    const char *name; /* NULL: standard output */
    struct output output;
};

/* Begin the file `name`; NULL: standard output. Exits on failure. */
void target_open(const struct tool *tool, struct target *target, const char *name);

/* Give the file its name if the printing went well, which `status` and *error say and the file itself; exit
 * if not. */
void target_close(const struct tool *tool, struct target *target, enum status status, struct error *error);

/* The same where printing itself does not fail. */
void target_end(const struct tool *tool, struct target *target);
