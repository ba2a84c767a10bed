/* Options that several tools share: -b, -w, --mu, --mu-unit of the basis, -k and -R of the supports. */
#ifndef TOOLS_MLS_OPTIONS_H
#define TOOLS_MLS_OPTIONS_H

#include "approx/mls.h"
#include "approx/support.h"
#include "base/options.h"

/* Entries for a tool's table of options, in this order. */
#define MLS_OPTIONS                                                                                          \
    {.letter = 'b', .name = "basis", .takes_value = true},                                                   \
        {.letter = 'w', .name = "weight", .takes_value = true}, {.name = "mu", .takes_value = true},         \
    {                                                                                                        \
        .name = "mu-unit", .takes_value = true                                                               \
    }

#define MLS_OPTION_COUNT 4

/* Apply the given ones among options[0..3] to `mls`. --mu takes one value or one for each second-order
 * monomial (3 in 2D: x2,xy,y2; 6 in 3D: x2,xy,xz,y2,yz,z2); with mls->dim 0, not known yet, either. */
MUST_CHECK enum status mls_apply_options(const struct option options[MLS_OPTION_COUNT], struct mls *mls,
                                         struct error *error);

/* Apply -k FACTOR or -R RADIUS to `support`; not both may be given. */
MUST_CHECK enum status radius_apply_options(const struct option *factor, const struct option *radius,
                                            struct support_options *support, struct error *error);

/* "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix before it, into
 * text[size], for a section's attributes. */
void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size);

#endif
