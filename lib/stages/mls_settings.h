/* The settings of shape functions as text: options of command lines, and attributes of sections. */
#pragma once

#include "approx/mls/mls.h"

/* The options of the shape functions; NULL: not given. `mu` is one value or one for each second-order
 * monomial (3 in 2D: x2,xy,y2; 6 in 3D: x2,xy,xz,y2,yz,z2); with mls->dim 0, not known yet, either. */
struct mls_texts {
    const char *basis, *weight, *mu, *mu_unit;
};
MUST_CHECK enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error);

/* "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix before it, into
 * text[size], for a section's attributes. */
void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size);
