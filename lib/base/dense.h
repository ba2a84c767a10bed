/* Small dense symmetric systems by Cholesky factors (Golub and Van Loan, Matrix Computations, 4.2). */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* A = L L^T of the symmetric matrix[n * n], row-major, of which the lower triangle is read: it becomes L, the
 * upper triangle L^T. Returns false when A is not positive definite; the matrix is then undefined. */
bool dense_factorise(int64_t n, double *matrix);

/* x[n] := A^-1 x from the factor. */
void dense_solve(int64_t n, const double *factor, double *x);

/* y += a x, for x[count] and y[count]. */
void dense_add_row(int64_t count, double a, const double *x, double *restrict y);

/* x y, for x[count] and y[count], by partial sums: of every eighth product. */
double dense_dot(int64_t count, const double *x, const double *y);
