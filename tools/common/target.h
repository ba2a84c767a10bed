/* A file that a tool prints to: its output file, which appears only when whole, or standard output. */
#ifndef TOOLS_TARGET_H
#define TOOLS_TARGET_H

#include "output.h"
#include "tool.h"

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

#endif
