/* Moving least squares by the normal equations, in vectors of the compiler; private to lib/approx. Sums over
 * the neighbours have the same partial sums for every instruction set, and no multiplication is fused with an
 * addition (set by the Makefile for lib/approx): every processor gives the same bits. Where the normal
 * equations lose digits, as shown by a small pivot or a defect of the linear reproduction, mls_orthogonal()
 * evaluates the point. */
#pragma once

#include "approx/mls/mls.h"

/* Rows of scratch. Their stride is at least the number of neighbours and MLS_PADDING. */
enum mls_row {
    ROW_XI,
    ROW_RATIO = ROW_XI + 3,
    ROW_WEIGHT,
    ROW_SLOPE,
    ROW_PHI,
    ROW_GRADIENT,
    ROW_ORTHOGONAL = ROW_GRADIENT + 3, /* mls_orthogonal: a matrix in the place of MLS_MAX_BASIS rows */
    MLS_ROWS = ROW_ORTHOGONAL + MLS_MAX_BASIS
};

/* Where all pivots are larger, the condition of this small matrix is good; a support is refused where the
 * reciprocal condition (of the matrix scaled to unit diagonal, from the 1-norm of R) is below the square of
 * this. */
#define MLS_SAFE_PIVOT 1e-5
#define MLS_LEAST_CONDITION (MLS_SAFE_PIVOT * MLS_SAFE_PIVOT)

/* Padding of a row beyond the number of neighbours: for the rows of H, and to whole vectors. */
#define MLS_PADDING 16

/* Evaluate at one point: phi[count] and dphi[count * dim], per unit of x, unless NULL; false if
 * mls_orthogonal() is needed. scratch[MLS_ROWS * stride]. */
bool mls_kernel(const struct mls *mls, const struct mls_support *support, double *scratch, int64_t stride,
                double *phi, double *dphi);

/* The same by orthogonal factorisation, equation (3) of lib/README.md. Any verdict other than MLS_GOOD: there
 * are none. */
enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi);
