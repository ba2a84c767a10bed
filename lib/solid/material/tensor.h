/* Products of 3 x 3 matrices, row-major, as material laws use them. */
#pragma once

#include "base/vector.h"

static inline double norm2(const double F[9])
{
    return vector_dot(9, F, F);
}

/* C = F^T F, symmetric. */
static inline void right_cauchy_green(const double F[9], double C[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            C[3 * i + k] = F[i] * F[k] + F[3 + i] * F[3 + k] + F[6 + i] * F[6 + k];
        }
    }
}

/* The product A B. */
static inline void multiply(const double A[9], const double B[9], double AB[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            AB[3 * i + k] = A[3 * i] * B[k] + A[3 * i + 1] * B[3 + k] + A[3 * i + 2] * B[6 + k];
        }
    }
}

/* E = (F^T F - I) / 2 */
static inline void green_lagrange(const double F[9], double E[9])
{
    right_cauchy_green(F, E);
    for (int i = 0; i < 9; i++) {
        E[i] = 0.5 * (E[i] - (i % 4 == 0 ? 1.0 : 0.0));
    }
}

/* y = A x */
static inline void transform(const double A[9], const double x[3], double y[3])
{
    for (int i = 0; i < 3; i++) {
        y[i] = vector_dot(3, A + 3 * i, x);
    }
}
