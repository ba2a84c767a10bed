#include "base/dense.h"

#include "base/chunks.h"
#include "base/processor.h"

#include <math.h>

ALL_SETS void dense_add_row(int64_t count, double a, const double *x, double *restrict y)
{
    for (int64_t i = 0; i < count; i++) {
        y[i] += a * x[i];
    }
}

/* Rows of L that are computed at a time, and then subtracted from the rest; tiles of the rest. */
enum { PANEL = 64, TILE_ROWS = 4, TILE_COLUMNS = 8, COLUMNS_AT_ONCE = 128 };
enum { ENTRIES_FOR_THREAD = 50000 }; /* see chunks_of */

/* Four numbers, which fit into one register of processors with AVX2. */
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

/* rest, TILE_ROWS by TILE_COLUMNS of a matrix of n columns, -= left[TILE_ROWS][count]
 * above[count][TILE_COLUMNS], parts of the same matrix. */
KERNEL_INLINE void subtract_tile(int64_t n, int64_t count, const double *left, const double *above,
                                 double *rest)
{
    four sum[TILE_ROWS][2];
    for (int i = 0; i < TILE_ROWS; i++) {
        sum[i][0] = *(const four *)(rest + i * n);
        sum[i][1] = *(const four *)(rest + i * n + 4);
    }
    for (int64_t k = 0; k < count; k++) {
        four first = *(const four *)(above + k * n), second = *(const four *)(above + k * n + 4);
        for (int i = 0; i < TILE_ROWS; i++) {
            sum[i][0] -= left[i * n + k] * first;
            sum[i][1] -= left[i * n + k] * second;
        }
    }
    for (int i = 0; i < TILE_ROWS; i++) {
        *(four *)(rest + i * n) = sum[i][0];
        *(four *)(rest + i * n + 4) = sum[i][1];
    }
}

/* The same of any part. */
KERNEL_INLINE void subtract_part(int64_t n, int64_t count, int64_t rows, int64_t columns, const double *left,
                                 const double *above, double *rest)
{
    for (int64_t i = 0; i < rows; i++) {
        for (int64_t k = 0; k < count; k++) {
            for (int64_t j = 0; j < columns; j++) {
                rest[i * n + j] -= left[i * n + k] * above[k * n + j];
            }
        }
    }
}

/* Subtract the columns of L from k on, `count`, from the rows i to i + rows behind them up to the diagonal.
 * Each entry is summed in the order of the columns, as without panels. */
ALL_SETS static void subtract_panel(int64_t n, int64_t k, int64_t count, int64_t begin, int64_t end,
                                    double *matrix)
{
    for (int64_t from = k + count; from < end; from += COLUMNS_AT_ONCE) {
        for (int64_t i = begin; i < end; i += TILE_ROWS) {
            int64_t rows = end - i < TILE_ROWS ? end - i : TILE_ROWS;
            int64_t last = i + rows < from + COLUMNS_AT_ONCE ? i + rows : from + COLUMNS_AT_ONCE;
            for (int64_t j = from; j < last; j += TILE_COLUMNS) {
                const double *left = matrix + i * n + k, *above = matrix + k * n + j;
                double *rest = matrix + i * n + j;
                if (rows == TILE_ROWS && last - j >= TILE_COLUMNS) {
                    subtract_tile(n, count, left, above, rest);
                } else {
                    int64_t columns = last - j < TILE_COLUMNS ? last - j : TILE_COLUMNS;
                    subtract_part(n, count, rows, columns, left, above, rest);
                }
            }
        }
    }
}

/* Rows and columns of L from k to before `last`. */
static bool factorise_block(int64_t n, int64_t k, int64_t last, double *matrix)
{
    for (int64_t c = k; c < last; c++) {
        double *above = matrix + c * n, pivot = above[c]; /* row c of L^T: the column of L below the pivot */
        if (!(pivot > 0.0 && isfinite(pivot))) {
            return false;
        }
        above[c] = sqrt(pivot);
        for (int64_t i = c + 1; i < last; i++) {
            above[i] = matrix[i * n + c] /= above[c];
            dense_add_row(i - c, -above[i], above + c + 1, matrix + i * n + c + 1);
        }
    }
    return true;
}

/* The columns of L from k to before `last` in row i below, and in L^T. */
static void solve_row(int64_t n, int64_t k, int64_t last, int64_t i, double *matrix)
{
    double *row = matrix + i * n;
    for (int64_t c = k; c < last; c++) {
        double *above = matrix + c * n;
        above[i] = row[c] /= above[c];
        dense_add_row(last - c - 1, -row[c], above + c + 1, row + c + 1);
    }
}

static int threads_for(int64_t rows)
{
    return chunks_of(rows * rows, ENTRIES_FOR_THREAD).threads;
}

/* The columns of L from k to before `last` in the rows from there on, and these less what they take. */
static void reduce(int64_t n, int64_t k, int64_t last, double *matrix)
{
    int64_t rows = n - last, tiles = (rows + PANEL - 1) / PANEL;
#pragma omp parallel num_threads(threads_for(rows))
    {
#pragma omp for schedule(static)
        for (int64_t i = last; i < n; i++) {
            solve_row(n, k, last, i, matrix);
        }
#pragma omp for schedule(dynamic, 1)
        for (int64_t t = 0; t < tiles; t++) {
            int64_t begin = n - (t + 1) * PANEL, end = n - t * PANEL;
            subtract_panel(n, k, last - k, begin < last ? last : begin, end, matrix);
        }
    }
}

bool dense_factorise(int64_t n, double *matrix)
{
    for (int64_t k = 0; k < n; k += PANEL) {
        int64_t last = n - k < PANEL ? n : k + PANEL;
        if (!factorise_block(n, k, last, matrix)) {
            return false;
        }
        if (last < n) {
            reduce(n, k, last, matrix);
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
