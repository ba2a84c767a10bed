/* Lists of lists (CSR): row r has idx[ptr[r]] to before idx[ptr[r + 1]]. */
#pragma once

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* List the items 0, 1, ... by rows. Item i belongs to the `per` rows row[i * per] and following; -1: none.
 * (*ptr)[rows + 1] and (*idx)[(*ptr)[rows]], ascending in each row, are the caller's to free, also on
 * failure. */
MUST_CHECK enum status lists_by_row(int64_t items, int per, const int32_t *row, int64_t rows, int64_t **ptr,
                                    int32_t **idx, struct error *error);

/* Lexicographic comparison of two lists of `count` numbers: negative if a comes before b, 0 if they are
 * equal, else positive.
 */
int compare_numbers(int count, const int32_t *a, const int32_t *b);

/* Sort numbers, and remove repetitions; returns how many remain. */
int64_t sort_distinct(int64_t count, int64_t *number);

/* Binary search: the first of `count` ascending items, as qsort orders them, that does not come before *key;
 * `count` if there is none. Of numbers: the first i in [low, high) with ascending[i] >= least, or `high`. */
int64_t lower_bound(const void *key, const void *items, int64_t count, size_t size,
                    int (*compare)(const void *left, const void *right));
int64_t first_from(const int64_t *ascending, int64_t low, int64_t high, int64_t least);

/* An item by its place along a line. */
struct placed {
    double place;
    int64_t item;
};

/* For qsort of struct placed: ascending places, items of one place by their numbers. */
int compare_placed(const void *left, const void *right);

/* For qsort and bsearch, ascending: of such numbers, and of structs that begin with one. */
int compare_int32(const void *left, const void *right);
int compare_int64(const void *left, const void *right);
int compare_double(const void *left, const void *right);
