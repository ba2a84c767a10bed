/* Rows of a large table of which each process has read some, and needs others: from where they were read they
 * go to where they are needed, so that no process ever has all. */
#pragma once

#include "base/ranks.h"
#include "base/sparse.h"

/* A table (CSR) in the caller's arrays. Rows that other processes have read are empty. */
struct read_rows {
    const struct ranks *ranks; /* not NULL */
    int64_t row_count, column_count;
    const int64_t *ptr; /* row_count + 1 */
    const int32_t *idx;
    const double *value;
    const int32_t *reader; /* row_count: the process that has read each row */
};

/* Set wanted[row_count] of the rows that have a column of this process: `owner` tells whose a column is. All
 * processes call this together. */
MUST_CHECK enum status read_rows_with(const struct read_rows *rows,
                                      int (*owner)(const void *context, int64_t column), const void *context,
                                      bool *wanted, struct error *error);

/* The rows that are wanted here, wanted[row_count]; others are empty. All processes call this together. */
MUST_CHECK enum status read_rows_fetch(const struct read_rows *rows, const bool *wanted,
                                       struct sparse *fetched, struct error *error);
