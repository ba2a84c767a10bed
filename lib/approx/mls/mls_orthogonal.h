/* Moving least squares at points whose moment matrix may be ill-conditioned; private to lib/approx. */
#pragma once

#include "approx/mls/mls.h"

/* Values and gradients, unless NULL, by orthogonal factorisation, equation (3) of lib/README.md. Any verdict
 * other than MLS_GOOD: there are none. scratch[MLS_ROWS * stride], stride at least count + MLS_PADDING. */
enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi);
