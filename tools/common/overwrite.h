/* Outputs that would replace an input of the same run. */
#pragma once

#include "tool.h"

/* Whether two names refer to one file, which need not exist yet. */
bool overwrite_is_same(const char *name, const char *other);

/* Whether a file is a stream, which a filter may replace by its output. */
bool overwrite_is_stream(const char *name);

/* Exits if the file named by `option`, with `suffix` appended, is an operand or the value of another option
 * except -o. A stream that is the only file among the operands may be replaced by the output. */
void overwrite_refuse(const struct tool *tool, const char *option, const char *suffix);
