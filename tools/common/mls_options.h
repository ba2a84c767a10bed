/* Options that several tools share: -b, -w, --mu, --mu-unit of the basis, -k and -R of the supports. */
#ifndef TOOLS_MLS_OPTIONS_H
#define TOOLS_MLS_OPTIONS_H

#include "approx/mls.h"
#include "approx/support.h"
#include "tool.h"

/* Their names, for tool_first_given. */
#define MLS_OPTIONS "basis", "weight", "mu", "mu-unit"
#define RADIUS_OPTIONS "factor", "radius"

/* What the options say of the shape functions; NULL: nothing. `mu` is one value or one for each second-order
 * monomial (3 in 2D: x2,xy,y2; 6 in 3D: x2,xy,xz,y2,yz,z2); with mls->dim 0, not known yet, either. */
struct mls_texts {
    const char *basis, *weight, *mu, *mu_unit;
};
MUST_CHECK enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error);

/* Apply those that were given; exits for values that cannot be. */
void mls_parse(const struct tool *tool, struct mls *mls);

/* Apply -k FACTOR or -R RADIUS; not both may be given. */
void radius_parse(const struct tool *tool, struct support_options *support);

/* "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix before it, into
 * text[size], for a section's attributes. */
void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size);

#endif
