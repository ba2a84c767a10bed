/* The sparse operator B of the force loop, equation (12) of lib/README.md: apply y = B x, and transposed
 * apply y = B^T x, from one table by rows. A column is summed by one thread, in the order of the rows, so
 * that any number of threads and of processes gives the same bits. */
#pragma once

#include "base/sparse.h"

/* The columns whose sums in B^T x one thread computes. */
struct row_stripe {
    int64_t begin, end;
    int64_t row_count;
    int32_t *row; /* the rows with entries in these columns, ascending: r if it has no others, else -1 - r; */
    struct sparse cut; /* of each of the latter, in order, the entries in these columns */
};

struct row_operator {
    struct sparse matrix;  /* B */
    struct sparse columns; /* of several processes: its entries in columns of own nodes. Without rows: the
                              matrix has them */
    int stripe_count;
    struct row_stripe *stripes;
};

/* Cut the columns from `begin` to before `end`, whose entries matrix or columns have, into stripes for so
 * many threads. STATUS_INPUT with 2^31 columns or more. */
MUST_CHECK enum status row_operator_finish(struct row_operator *rows, int64_t begin, int64_t end, int threads,
                                           struct error *error);
void row_operator_free(struct row_operator *rows);

/* Some columns of B, ascending, as the rows of a matrix. range[2 * rows], of row_operator_ranges;
 * slot[columns]: scratch, which receives the row of each of these. */
MUST_CHECK enum status row_operator_transpose(const struct row_operator *rows, const int32_t *range,
                                              const int32_t *column, int64_t count, int32_t *slot,
                                              struct sparse *transposed, struct error *error);

/* (*range)[2 * rows], to be freed: the first and the last column of each row; none: the last is before it. */
MUST_CHECK enum status row_operator_ranges(const struct row_operator *rows, int32_t **range,
                                           struct error *error);
