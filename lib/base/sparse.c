#include "base/sparse.h"

#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"

#include <string.h>

enum { ROWS_FOR_THREAD = 4000 }; /* see chunks_of */

enum status sparse_new(int64_t row_count, int64_t column_count, int64_t entries, struct sparse *matrix,
                       struct error *error)
{
    *matrix = (struct sparse){.row_count = row_count, .column_count = column_count};
    RETURN_IF_ERROR(NEW_ARRAY(&matrix->ptr, row_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&matrix->idx, entries, error));
    return NEW_ARRAY(&matrix->value, entries, error);
}

enum status sparse_transpose(const struct sparse *matrix, struct sparse *transposed, struct error *error)
{
    int64_t entries = matrix->ptr[matrix->row_count];
    *transposed = (struct sparse){0};
    NEW_SCRATCH(int64_t, next, matrix->column_count + 1, error);
    RETURN_IF_ERROR(sparse_new(matrix->column_count, matrix->row_count, entries, transposed, error));
    for (int64_t i = 0; i < entries; i++) {
        transposed->ptr[matrix->idx[i] + 1]++;
    }
    for (int64_t c = 0; c < matrix->column_count; c++) {
        transposed->ptr[c + 1] += transposed->ptr[c];
        next[c + 1] = transposed->ptr[c + 1];
    }
    for (int64_t r = 0; r < matrix->row_count; r++) {
        for (int64_t i = matrix->ptr[r]; i < matrix->ptr[r + 1]; i++) {
            int64_t at = next[matrix->idx[i]]++;
            transposed->idx[at] = (int32_t)r;
            transposed->value[at] = matrix->value[i];
        }
    }
    return STATUS_OK;
}

void sparse_free(struct sparse *matrix)
{
    FREE_ALL(matrix->ptr, matrix->idx, matrix->value);
    *matrix = (struct sparse){0};
}

/* y += A x. The width is known when compiling where it is 2 or 3. */
static inline __attribute__((always_inline)) void
apply_rows(const struct sparse *matrix, int64_t begin, int64_t end, int64_t width, const double *x, double *y)
{
    for (int64_t r = begin; r < end; r++) {
        double sum[3] = {0.0, 0.0, 0.0}, *to = width <= 3 ? sum : y + r * width;
        for (int64_t a = 0; a < width; a++) {
            to[a] = y[r * width + a];
        }
        for (int64_t i = matrix->ptr[r]; i < matrix->ptr[r + 1]; i++) {
            const double *at = x + matrix->idx[i] * width;
            for (int64_t a = 0; a < width; a++) {
                to[a] += matrix->value[i] * at[a];
            }
        }
        memmove(y + r * width, to, (size_t)width * sizeof *y);
    }
}

/* The first row of thread t; each thread has about the same number of entries. */
static int64_t begin_of(const struct sparse *matrix, int64_t first, int64_t last, int t, int threads)
{
    if (t == 0 || t == threads) {
        return t == 0 ? first : last;
    }
    int64_t wanted = matrix->ptr[first] + (matrix->ptr[last] - matrix->ptr[first]) * t / threads;
    return first_from(matrix->ptr, first, last, wanted);
}

void sparse_add_rows(const struct sparse *matrix, int64_t first, int64_t last, int64_t width, const double *x,
                     double *y)
{
    int threads = chunks_of(last - first, ROWS_FOR_THREAD).threads;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++) {
        int64_t begin = begin_of(matrix, first, last, t, threads);
        int64_t end = begin_of(matrix, first, last, t + 1, threads);
        if (width == 2) {
            apply_rows(matrix, begin, end, 2, x, y);
        } else if (width == 3) {
            apply_rows(matrix, begin, end, 3, x, y);
        } else {
            apply_rows(matrix, begin, end, width, x, y);
        }
    }
}
