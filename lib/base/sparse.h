/* Sparse matrices by rows (CSR), applied to nodal fields: an entry of a vector is a number, or the `width`
 * components of a displacement or force. Each row is summed by one thread and in one order, so that any
 * number of threads gives the same bits. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct sparse {
    int64_t row_count, column_count;
    int64_t *ptr;  /* row_count + 1 */
    int32_t *idx;  /* ptr[row_count]: columns */
    double *value; /* ptr[row_count] */
};

/* Allocate a matrix; the caller fills in ptr, idx and value. */
MUST_CHECK enum status sparse_new(int64_t row_count, int64_t column_count, int64_t entries,
                                  struct sparse *matrix, struct error *error);

/* The transpose, the entries of each row in the order of the matrix's rows. `transposed` is not `matrix`. */
MUST_CHECK enum status sparse_transpose(const struct sparse *matrix, struct sparse *transposed,
                                        struct error *error);
void sparse_free(struct sparse *matrix);

/* y += A x in the rows from `first` to before `last`, in the order of the entries: y[row_count * width] of
 * x[column_count * width], another array. Threaded. */
void sparse_add_rows(const struct sparse *matrix, int64_t first, int64_t last, int64_t width, const double *x,
                     double *y);
