/* Options that several tools share: -b, -w, --mu, --mu-unit of the basis, -k and -R of the supports. */
#ifndef TOOLS_MLS_OPTIONS_H
#define TOOLS_MLS_OPTIONS_H

#include "approx/mls.h"
#include "approx/support.h"
#include "tool.h"

/* Their names, for tool_first_given. */
#define MLS_OPTIONS "basis", "weight", "mu", "mu-unit"
#define RADIUS_OPTIONS "factor", "radius"

/* Apply those that were given; exits for values that cannot be. */
void mls_parse(const struct tool *tool, struct mls *mls);

/* Apply -k FACTOR or -R RADIUS; not both may be given. */
void radius_parse(const struct tool *tool, struct support_options *support);

#endif
