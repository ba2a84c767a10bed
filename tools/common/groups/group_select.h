/* Expressions that choose facets, nodes or cells (the usage text of groups has the grammar). */
#pragma once

#include "groups/group_body.h"

/* Evaluate an expression for a kind of items: chosen[body->items[kind].count]. Its lengths are in `unit`
 * metres. The message of an error begins with the faulty term. */
MUST_CHECK enum status group_select(const struct group_body *body, enum group_kind kind,
                                    const char *expression, double unit, bool *chosen, struct error *error);

/* The same of one term, KIND:ARGUMENTS. */
MUST_CHECK enum status group_term(const struct group_body *body, enum group_kind kind, const char *term,
                                  double unit, bool *chosen, struct error *error);
