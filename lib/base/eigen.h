/* Eigenvalues of small symmetric matrices. */
#pragma once

enum { EIGEN_MOST = 6 }; /* rows at most */

/* Eigenvalues values[n], in no particular order, and unit eigenvectors, the columns of V[n * n], of the
 * symmetric matrix A[n * n], row-major, by cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations,
 * 8.5). */
void eigen_symmetric(int n, const double *A, double *values, double *V);
