/* The settings of shape functions as text, in options of command lines and attributes of sections. */
#pragma once

#include "approx/mls/mls.h"

/* The options of the shape functions; NULL: not given. `mu` is one value or one for each second-order
 * monomial (3 in 2D: x2,xy,y2; 6 in 3D: x2,xy,xz,y2,yz,z2). With mls->dim 0, the dimension is not known yet,
 * and either number is accepted. */
struct mls_texts {
    const char *basis, *weight, *mu, *mu_unit;
};
MUST_CHECK enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error);

/* text[size] = "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix, for
 * the attributes of a section. */
void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size);
