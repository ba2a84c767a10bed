/* The small symmetric systems of an MLS evaluation (equation (3) of lib/README.md), by the normal equations
 * or, where the moment matrix is ill-conditioned, by orthogonal (QR) factorisation; private to lib/approx. */
#ifndef APPROX_MLS_SOLVE_H
#define APPROX_MLS_SOLVE_H

#include "approx/mls.h"

/* Rows of scratch per neighbour: monomials, QR copy of them, weight, slope, projection, row, image. */
#define MLS_ROWS (2 * MLS_MAX_BASIS + 4 + 3)

/* A row is so much longer than the number of neighbours: for the rows of H, and for whole vectors. */
#define MLS_PADDING 16

/* One point's data in local scaled coordinates; arrays of `count` entries, `stride` apart. */
struct mls_local {
    int64_t count, stride;
    double scale;       /* s, in units of x */
    double *monomials;  /* [m][stride]: p_k(xi_j) */
    double *orthogonal; /* [m][stride]: scratch of the orthogonal factorization, count + m used */
    double *weight;     /* w_j */
    double *slope;      /* grad w_j = -slope_j image_j / s */
    double *image;      /* [dim][stride]: where the neighbour seems to be; xi_j but around corners */
    double *projection; /* p_j . c */
    double *row;        /* scratch */
    double matrix[MLS_MAX_BASIS * MLS_MAX_BASIS]; /* moment matrix with H, m x m */
    double regularisation[MLS_MAX_BASIS];         /* diagonal of H */
};

/* M = D L E L^T D with D = sqrt(diag M), E diagonal; or, when orthogonal, sqrt(W) P D^-1 over sqrt(H) D^-1 =
 * Q R with R in `lower` (transposed) and Q in local->orthogonal. */
struct mls_factor {
    bool orthogonal;
    double scaling[MLS_MAX_BASIS]; /* 1 / D */
    double lower[MLS_MAX_BASIS * MLS_MAX_BASIS];
    double pivot[MLS_MAX_BASIS]; /* E */
};

/* Point the arrays of `local` into scratch[MLS_ROWS * stride]. */
void mls_local_layout(struct mls_local *local, double *scratch, int64_t count, int64_t stride);

/* Factorise local->matrix and judge its condition: that of the linear block always, that of the whole matrix
 * unless `modified` (there H bounds it, and the reproduction is checked afterwards). Chooses the orthogonal
 * factorisation at once where a pivot is too small. */
enum mls_verdict mls_factorise(int m, int dim, bool modified, struct mls_local *local,
                               struct mls_factor *factor);

/* Replace the factor by the orthogonal one. */
void mls_orthogonalise(int m, struct mls_local *local, struct mls_factor *factor);

/* solution = M^-1 right, with one step of iterative refinement. */
void mls_solve(int m, const struct mls_factor *factor, const struct mls_local *local, const double *right,
               double *solution);

/* c = M^-1 e_1 and phi_j = w_j p_j . c, from Q directly: products with a large c would cancel. Sets
 * local->projection. */
void mls_orthogonal_values(int m, const struct mls_factor *factor, struct mls_local *local, double *c,
                           double *phi);

/* Correct values[j * value_stride] by w_j p_j . c over the linear monomials, where H is zero, so that
 * sum_j value_j p_k(xi_j) = target[k], k <= dim, to round-off: linear fields are reproduced also where the
 * quadratic part is ill-conditioned. */
void mls_restore_linear(int m, int dim, const struct mls_factor *factor, const struct mls_local *local,
                        const double *target, double *values, int value_stride);

/* Values and, unless NULL, gradients by the factorisation that the condition asks for; scratch[MLS_ROWS *
 * stride], stride at least count + MLS_PADDING. */
enum mls_verdict mls_orthogonal(const struct mls *mls, const struct mls_support *support, double *scratch,
                                int64_t stride, double *phi, double *dphi);

#endif
