/* Shared by tools that run stages: the options of basis and supports, -b, -w, --mu, --mu-unit, -k, -R; and
 * running stages with their defaults if their sections are missing. */
#pragma once

#include "approx/mls/mls.h"
#include "approx/support/support.h"
#include "stages/stages.h"
#include "tool.h"

/* The names of these options, for tool_first_given. */
#define MLS_OPTIONS "basis", "weight", "mu", "mu-unit"
#define RADIUS_OPTIONS "factor", "radius"

/* Apply the options that were given; exits for invalid values. */
void mls_parse(const struct tool *tool, struct mls *mls);

/* Apply -k FACTOR or -R RADIUS; exits if both are given. */
void radius_parse(const struct tool *tool, struct support_options *support);

/* Note the points whose gradients exceed their bound. */
void support_note_steep(const struct tool *tool, const struct support_options *options,
                        const struct support_report *report);

/* Run every stage up to `upto` ("ipoints", "support" or "shapefn") whose sections are missing with its
 * defaults, note this once, and add the provenance of these stages. Exits on failure. */
void stage_fill(const struct tool *tool, struct stream *stream, const char *upto);
