/* A symmetric positive definite matrix of square blocks within its profile, and its Cholesky factor: each row
 * of blocks is stored from its first block to the diagonal, which is where the factor has entries, too
 * (George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981). */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct profile {
    int64_t count, numbers; /* rows of blocks; rows of a block */
    int64_t *first;         /* count: the first block of each row, <= the row */
    int64_t *at;            /* count: where the first block of each row begins among the values */
    int64_t size;           /* values */
    double *panel;          /* scratch */
};

/* A profile whose rows each have their diagonal block alone. */
MUST_CHECK enum status profile_begin(int64_t count, int64_t numbers, struct profile *profile,
                                     struct error *error);
/* Lay out the values, when first[] is known. */
MUST_CHECK enum status profile_lay_out(struct profile *profile, struct error *error);
void profile_free(struct profile *profile);

/* From one row of a row of blocks to the next, among the values. */
static inline int64_t profile_stride(const struct profile *profile, int64_t row)
{
    return (row + 1 - profile->first[row]) * profile->numbers;
}

/* The block of a row and a column of blocks, first[row] <= column <= row. */
static inline double *profile_block(const struct profile *profile, int64_t row, int64_t column, double *value)
{
    return value + profile->at[row] + (column - profile->first[row]) * profile->numbers;
}

/* The entry of row i and column j of the matrix, first[] of its row of blocks <= j / numbers, j <= i. */
static inline double *profile_entry(const struct profile *profile, int64_t i, int64_t j, double *value)
{
    int64_t row = i / profile->numbers;
    return profile_block(profile, row, profile->first[row], value) +
           i % profile->numbers * profile_stride(profile, row) + j - profile->first[row] * profile->numbers;
}

/* A = L L^T: the lower triangle of A in value[size] becomes L. Returns false when A is not positive definite;
 * the values are then undefined. Threaded; each entry is summed in the order of the columns. */
bool profile_factorise(const struct profile *profile, double *value);

/* x[count * numbers] := A^-1 x from the factor. */
void profile_solve(const struct profile *profile, const double *factor, double *x);
