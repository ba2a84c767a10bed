/* The names of groups that a section carries: its attribute names=, separated by commas. */
#ifndef TOOLS_NAMES_H
#define TOOLS_NAMES_H

#include "io/stream.h"

/* The names= of a section, allocated; "" when it has none. */
MUST_CHECK enum status names_of_section(const struct section *section, char **names, struct error *error);

/* Index of `name` in such a list, or -1. */
int64_t names_index(const char *names, const char *name);

#endif
