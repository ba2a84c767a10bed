/* The terms of expressions that choose facets, nodes or cells: KIND:ARGUMENTS. */
#ifndef TOOLS_GROUP_TERMS_H
#define TOOLS_GROUP_TERMS_H

#include "group_body.h"

/* chosen[body->items[kind].count]: what one term chooses. */
MUST_CHECK enum status group_term(const struct group_body *body, enum group_kind kind, const char *term,
                                  double unit, bool *chosen, struct error *error);

#endif
