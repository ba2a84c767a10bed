#include "base/dense.h"

#include "base/processor.h"

#include <math.h>

ALL_SETS void dense_add_row(int64_t count, double a, const double *x, double *restrict y)
{
    for (int64_t i = 0; i < count; i++) {
        y[i] += a * x[i];
    }
}

bool dense_factorise(int64_t n, double *matrix)
{
    for (int64_t k = 0; k < n; k++) {
        double *above = matrix + k * n, pivot = above[k]; /* row k of L^T: the column of L below the pivot */
        if (!(pivot > 0.0 && isfinite(pivot))) {
            return false;
        }
        above[k] = sqrt(pivot);
        for (int64_t i = k + 1; i < n; i++) {
            above[i] = matrix[i * n + k] /= above[k];
            dense_add_row(i - k, -above[i], above + k + 1, matrix + i * n + k + 1);
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
            x[i] -= factor[i * n + k] * x[k];
        }
        x[i] /= factor[i * n + i];
    }
}

void dense_solve_large(int64_t n, const double *factor, double *x)
{
    for (int64_t k = 0; k < n; k++) {
        x[k] /= factor[k * n + k];
        dense_add_row(n - k - 1, -x[k], factor + k * n + k + 1, x + k + 1);
    }
    for (int64_t i = n - 1; i >= 0; i--) {
        x[i] /= factor[i * n + i];
        dense_add_row(i, -x[i], factor + i * n, x);
    }
}

void dense_invert(int64_t n, double *factor)
{
    for (int64_t i = 0; i < n; i++) { /* L^-1, in the place of L */
        double *row = factor + i * n;
        for (int64_t l = 0; l < i; l++) {
            double entry = row[l];
            row[l] = 0.0;
            dense_add_row(l + 1, entry, factor + l * n, row);
        }
        for (int64_t k = 0; k < i; k++) {
            row[k] = -row[k] / row[i];
        }
        row[i] = 1.0 / row[i];
    }
    for (int64_t l = 0; l < n; l++) { /* L^-T L^-1, in the upper triangle */
        const double *row = factor + l * n;
        double last = row[l];
        for (int64_t i = 0; i < l; i++) {
            dense_add_row(l - i, row[i], row + i, factor + i * n + i);
            factor[i * n + l] = row[i] * last;
        }
        factor[l * n + l] = last * last;
    }
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            factor[i * n + k] = factor[k * n + i];
        }
    }
}
