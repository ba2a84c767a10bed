/* Lists of lists (CSR): row r has idx[ptr[r]] to before idx[ptr[r + 1]]; what is sorted, and keys. */
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

/* ---- faces of simplices, and items sorted by a key of node indices ---- */

/* face[dim]: the nodes of the face opposite a vertex of a cell, node[dim + 1], oriented outward. */
void simplex_face(int dim, const int32_t *node, int vertex, int32_t *face);

/* sorted[count]: a few node indices in ascending order. */
void sort_nodes(int count, const int32_t *node, int32_t *sorted);

/* The node indices node[dim] of a face in ascending order, in 2D -1 last. The key identifies the face
 * whatever its orientation. */
void face_key(int dim, const int32_t *node, int32_t key[3]);

/* An item by its key. */
struct keyed {
    int32_t key[3];
    int64_t item;
};

/* Ascending keys, items of one key by their numbers. */
void keyed_sort(int64_t count, struct keyed *keyed);

/* In a sorted array: the index behind the last item that has the key of item `first`; the index of the first
 * item with a key, or -1. */
int64_t keyed_end(int64_t count, const struct keyed *keyed, int64_t first);
int64_t keyed_find(int64_t count, const struct keyed *keyed, const int32_t key[3]);
