#include "base/lists.h"

#include "base/memory.h"

#include <stdlib.h>

enum status lists_by_row(int64_t items, int per, const int32_t *row, int64_t rows, int64_t **ptr,
                         int32_t **idx, struct error *error)
{
    int64_t count = items * per, *next;
    RETURN_IF_ERROR(NEW_ARRAY(ptr, rows + 2, error));
    next = *ptr + 1; /* next[r]: place of the next item of row r; in the end, the start of row r + 1 */
    for (int64_t i = 0; i < count; i++) {
        (*ptr)[row[i] + 2] += row[i] >= 0;
    }
    for (int64_t r = 0; r < rows; r++) {
        (*ptr)[r + 2] += (*ptr)[r + 1];
    }
    RETURN_IF_ERROR(NEW_ARRAY(idx, (*ptr)[rows + 1], error));
    for (int64_t i = 0; i < count; i++) {
        if (row[i] >= 0) {
            (*idx)[next[row[i]]++] = (int32_t)(i / per);
        }
    }
    return STATUS_OK;
}

int compare_numbers(int count, const int32_t *a, const int32_t *b)
{
    int k = 0;
    while (k < count && a[k] == b[k]) {
        k++;
    }
    return k == count ? 0 : a[k] < b[k] ? -1 : 1;
}

int64_t sort_distinct(int64_t count, int64_t *number)
{
    int64_t kept = 0;
    qsort(number, (size_t)count, sizeof *number, compare_int64);
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || number[i] != number[i - 1]) {
            number[kept++] = number[i];
        }
    }
    return kept;
}

int64_t lower_bound(const void *key, const void *items, int64_t count, size_t size,
                    int (*compare)(const void *left, const void *right))
{
    int64_t low = 0, high = count;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        bool before = compare((const char *)items + (size_t)middle * size, key) < 0;
        *(before ? &low : &high) = middle + before;
    }
    return low;
}

int64_t first_from(const int64_t *ascending, int64_t low, int64_t high, int64_t least)
{
    return low + lower_bound(&least, ascending + low, high - low, sizeof *ascending, compare_int64);
}

int compare_placed(const void *left, const void *right)
{
    const struct placed *a = left, *b = right;
    if (a->place != b->place) {
        return a->place < b->place ? -1 : 1;
    }
    return (a->item > b->item) - (a->item < b->item);
}

int compare_int32(const void *left, const void *right)
{
    return compare_numbers(1, left, right);
}

int compare_int64(const void *left, const void *right)
{
    const int64_t *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

int compare_double(const void *left, const void *right)
{
    const double *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

/* ---- faces of simplices, and items sorted by a key of node indices ---- */

void simplex_face(int dim, const int32_t *node, int vertex, int32_t *face)
{
    static const int of_triangle[3][2] = {{1, 2}, {2, 0}, {0, 1}};
    static const int of_tetrahedron[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const int *corner = dim == 2 ? of_triangle[vertex] : of_tetrahedron[vertex];
    for (int k = 0; k < dim; k++) {
        face[k] = node[corner[k]];
    }
}

void sort_nodes(int count, const int32_t *node, int32_t *sorted)
{
    for (int i = 0; i < count; i++) {
        int at = i;
        for (; at > 0 && sorted[at - 1] > node[i]; at--) {
            sorted[at] = sorted[at - 1];
        }
        sorted[at] = node[i];
    }
}

void face_key(int dim, const int32_t *node, int32_t key[3])
{
    key[2] = -1;
    sort_nodes(dim, node, key);
}

static int compare_keyed(const void *left, const void *right)
{
    const struct keyed *a = left, *b = right;
    int keys = compare_numbers(3, a->key, b->key);
    return keys != 0 ? keys : (a->item > b->item) - (a->item < b->item);
}

void keyed_sort(int64_t count, struct keyed *keyed)
{
    qsort(keyed, (size_t)count, sizeof *keyed, compare_keyed);
}

int64_t keyed_end(int64_t count, const struct keyed *keyed, int64_t first)
{
    int64_t end = first + 1;
    while (end < count && compare_numbers(3, keyed[end].key, keyed[first].key) == 0) {
        end++;
    }
    return end;
}

int64_t keyed_find(int64_t count, const struct keyed *keyed, const int32_t key[3])
{
    const struct keyed first = {{key[0], key[1], key[2]}, INT64_MIN};
    int64_t at = lower_bound(&first, keyed, count, sizeof *keyed, compare_keyed);
    return at < count && compare_numbers(3, keyed[at].key, key) == 0 ? at : -1;
}
