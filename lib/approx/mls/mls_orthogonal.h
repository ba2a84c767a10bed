/* Moving least squares at points whose moment matrix may be ill-conditioned; private to lib/approx. */
#pragma once

#include "approx/mls/mls.h"

/* Rows of scratch per neighbour: monomials, QR copy of them, weight, slope, projection, row, image. */
#define MLS_ROWS (2 * MLS_MAX_BASIS + 4 + 3)

/* Padding of a row beyond the number of neighbours: for the rows of H, and to whole vectors. */
#define MLS_PADDING 16

/* Values and, unless NULL, gradients by orthogonal factorisation, equation (3) of lib/README.md. Any verdict
 * other than MLS_GOOD: there are none. scratch[MLS_ROWS * stride], stride at least count + MLS_PADDING. */
enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi);
