/* What tools share that run stages: the options of basis and supports, -b, -w, --mu, --mu-unit, -k, -R; and
 * the stages that run with their defaults where their sections are missing. */
#pragma once

#include "approx/mls/mls.h"
#include "approx/support/support.h"
#include "tool.h"

/* The names of these options, for tool_first_given. */
#define MLS_OPTIONS "basis", "weight", "mu", "mu-unit"
#define RADIUS_OPTIONS "factor", "radius"

/* Apply those that were given; exits for values that cannot be. */
void mls_parse(const struct tool *tool, struct mls *mls);

/* Apply -k FACTOR or -R RADIUS; not both may be given. */
void radius_parse(const struct tool *tool, struct support_options *support);

/* Run the defaults of every stage up to shapefn whose sections are missing, saying so once on standard error
 * and adding the provenance of the stages run. `upto` is "ipoints", "support" or "shapefn". Exits on failure.
 */
void stage_fill(const struct tool *tool, struct stream *stream, const char *upto);
