/* Eigenvalues of small symmetric matrices. */
#pragma once

#include <stdbool.h>

enum { EIGEN_MOST = 6 }; /* rows at most */

/* Eigenvalues values[n], in no particular order, and unit eigenvectors, the columns of V[n * n], of the
 * symmetric matrix A[n * n], row-major, by cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations,
 * 8.5). */
void eigen_symmetric(int n, const double *A, double *values, double *V);

/* ---- axes: directions without a sense, which are averaged and interpolated as a (x) a ---- */

/* The entries of a symmetric matrix: dim (dim + 1) / 2, the upper triangle row by row. */
enum { AXIS_MOST_ENTRIES = 6 };

/* entries = a (x) a of the unit direction of a[dim]. False, and zeros, if a has no length or is not finite.
 */
bool axis_square(int dim, const double *a, double *entries);

/* axis[dim], unit: the eigenvector of the largest eigenvalue. False if the matrix is 0. */
bool axis_principal(int dim, const double *entries, double *axis);
