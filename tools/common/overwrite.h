/* Outputs that would replace an input of the same run. */
#pragma once

#include "tool.h"

/* Whether two names are of one file, which need not exist yet. */
bool overwrite_is_same(const char *name, const char *other);

/* Exits where the file that `option` names, with `suffix` appended, is an operand, or the value of another
 * option but -o. A stream that is the only file among the operands may be replaced by what is made of it. */
void overwrite_refuse(const struct tool *tool, const char *option, const char *suffix);
