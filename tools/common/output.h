/* An output file that appears under its name only when it is complete. */
#pragma once

#include "tool.h"

struct output {
    int descriptor;   /* to write to */
    const char *name; /* given by the user, for messages; the caller's */
    char *target;     /* the file to replace, with symbolic links followed */
    char *temporary;  /* temporary file in the same folder; NULL if the target is a device or pipe */
};

/* Begin to write: a temporary file in the same folder, removed if the program ends by exit() or by SIGINT,
 * SIGTERM, SIGHUP or SIGXCPU before output_end. An existing device or pipe is opened as it is. One output
 * at a time. */
MUST_CHECK enum status output_open(struct output *output, const char *name, struct error *error);

/* The same under the temporary name NAME.part, which stays if the program ends before output_end: for an
 * output that grows while it is computed. */
MUST_CHECK enum status output_open_part(struct output *output, const char *name, struct error *error);

/* Close the output and rename the file to its target; if this or the writing (`status`) failed, remove it.
 * The message of a failure begins with the name. */
MUST_CHECK enum status output_end(struct output *output, enum status status, struct error *error);

/* Begin and end the output of a stream: tool->output, with `grows` as NAME.part, or standard output. Refuses
 * to write binary to a terminal; reports delayed write errors. */
MUST_CHECK enum status tool_output_open(const struct tool *tool, bool grows, struct output *output,
                                        struct error *error);
MUST_CHECK enum status tool_output_end(const struct tool *tool, struct output *output, enum status status,
                                       struct error *error);

/* The file to which a tool prints: its output file, or standard output; or writes by its descriptor. */
struct target {
    FILE *file;       /* to print to */
    const char *name; /* NULL: standard output */
    struct output output;
};

/* Begin the file `name`; NULL: standard output. Exits on failure. */
void target_open(const struct tool *tool, struct target *target, const char *name);

/* Rename the file to its target if printing succeeded, by `status` and by the state of the file; exits with
 * *error if not. */
void target_close(const struct tool *tool, struct target *target, enum status status, struct error *error);

/* The same with STATUS_OK. */
void target_end(const struct tool *tool, struct target *target);
