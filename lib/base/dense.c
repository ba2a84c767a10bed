#include "base/dense.h"

#include "base/processor.h"

#include <math.h>

ALL_SETS void dense_add_row(int64_t count, double a, const double *x, double *restrict y)
{
    for (int64_t i = 0; i < count; i++) {
        y[i] += a * x[i];
    }
}

ALL_SETS double dense_dot(int64_t count, const double *x, const double *y)
{
    enum { SUMS = 8 };
    double sum[SUMS] = {0.0}, rest = 0.0;
    for (; count >= SUMS; count -= SUMS, x += SUMS, y += SUMS) {
        for (int k = 0; k < SUMS; k++) {
            sum[k] += x[k] * y[k];
        }
    }
    for (int64_t i = 0; i < count; i++) {
        rest += x[i] * y[i];
    }
    for (int k = 0; k < SUMS; k++) {
        rest += sum[k];
    }
    return rest;
}

bool dense_factorise(int64_t n, double *matrix)
{
    for (int64_t c = 0; c < n; c++) {
        double *above = matrix + c * n, pivot = above[c]; /* row c of L^T: the column of L below the pivot */
        if (!(pivot > 0.0 && isfinite(pivot))) {
            return false;
        }
        above[c] = sqrt(pivot);
        for (int64_t i = c + 1; i < n; i++) {
            above[i] = matrix[i * n + c] /= above[c];
            dense_add_row(i - c, -above[i], above + c + 1, matrix + i * n + c + 1);
        }
    }
    return true;
}

void dense_solve(int64_t n, const double *factor, double *x)
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
