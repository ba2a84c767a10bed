/* A tool that finds the sections of an earlier stage missing runs that stage with its defaults. */
#ifndef TOOLS_STAGE_FILL_H
#define TOOLS_STAGE_FILL_H

#include "tool.h"

/* Run the defaults of every stage up to shapefn whose sections are missing, saying so once on standard error
 * and adding the provenance of the stages run. `upto` is "ipoints", "support" or "shapefn". Exits on failure.
 */
void stage_fill(const struct tool *tool, struct stream *stream, const char *upto);

#endif
