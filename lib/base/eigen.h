/* Eigenvalues of symmetric 3 x 3 matrices. */
#ifndef BASE_EIGEN_H
#define BASE_EIGEN_H

/* Eigenvalues, in no particular order, and unit eigenvectors (columns of V) of a symmetric 3 x 3 matrix
 * (row-major), by Jacobi rotations. */
void eigen_symmetric(const double A[9], double values[3], double V[9]);

#endif
