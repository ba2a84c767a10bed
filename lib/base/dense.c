#include "base/dense.h"

#include <math.h>

bool dense_factorise(int64_t n, double *matrix)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k <= i; k++) {
            double sum = matrix[i * n + k];
            for (int64_t l = 0; l < k; l++) {
                sum -= matrix[i * n + l] * matrix[k * n + l];
            }
            if (k == i && !(sum > 0.0 && isfinite(sum))) {
                return false;
            }
            matrix[i * n + k] = k == i ? sqrt(sum) : sum / matrix[k * n + k];
        }
    }
    return true;
}

void dense_solve(int64_t n, const double *factor, double *x)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            x[i] -= factor[i * n + k] * x[k];
        }
        x[i] /= factor[i * n + i];
    }
    for (int64_t i = n - 1; i >= 0; i--) {
        for (int64_t k = i + 1; k < n; k++) {
            x[i] -= factor[k * n + i] * x[k];
        }
        x[i] /= factor[i * n + i];
    }
}

void dense_invert(int64_t n, double *factor)
{
    for (int64_t i = 0; i < n; i++) { /* L^-1, in the place of L */
        for (int64_t k = 0; k < i; k++) {
            double sum = 0.0;
            for (int64_t l = k; l < i; l++) {
                sum += factor[i * n + l] * factor[l * n + k];
            }
            factor[i * n + k] = -sum / factor[i * n + i];
        }
        factor[i * n + i] = 1.0 / factor[i * n + i];
    }
    for (int64_t i = 0; i < n; i++) { /* L^-T L^-1, in the upper triangle */
        for (int64_t k = i; k < n; k++) {
            double sum = 0.0;
            for (int64_t l = k; l < n; l++) {
                sum += factor[l * n + i] * factor[l * n + k];
            }
            factor[i * n + k] = sum;
        }
    }
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            factor[i * n + k] = factor[k * n + i];
        }
    }
}
