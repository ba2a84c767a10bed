/* Redistribution of the rows of a large table. Each process has read some rows and needs others. A row is
 * sent from the process that has read it to those that need it, so that no process holds the whole table. */
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

/* Set wanted[r] for each row r with an entry in a column of this process; owner(context, column) is the
 * process that a column belongs to. Collective. */
MUST_CHECK enum status read_rows_with(const struct read_rows *rows,
                                      int (*owner)(const void *context, int64_t column), const void *context,
                                      bool *wanted, struct error *error);

/* Fetch the rows r with wanted[r]; the other rows of `fetched` are empty. Collective. */
MUST_CHECK enum status read_rows_fetch(const struct read_rows *rows, const bool *wanted,
                                       struct sparse *fetched, struct error *error);
