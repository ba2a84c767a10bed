/* The sparse operator B of the force loop, equation (12) of lib/README.md: apply y = B x, and transposed
 * apply y = B^T x, from one table by rows. A column is summed by one thread, in the order of the rows, so
 * that any number of threads and of processes gives the same bits. */
#pragma once

#include "base/sparse.h"

/* The columns whose sums in B^T x one thread computes. */
struct row_stripe {
    int64_t begin, end;
    int64_t row_count;
    int32_t *row; /* rows with entries in these columns, ascending: r if all entries of the row are, else
                     -1 - r */
};

struct row_operator {
    struct sparse matrix; /* B; with several processes the rows that own cells need or own nodes are in */
    int stripe_count;
    struct row_stripe *stripes;
};

/* Divide the columns from `begin` to before `end` into one stripe for each of `threads` threads. STATUS_INPUT
 * for 2^31 columns or more. */
MUST_CHECK enum status row_operator_finish(struct row_operator *rows, int64_t begin, int64_t end, int threads,
                                           struct error *error);
void row_operator_free(struct row_operator *rows);
