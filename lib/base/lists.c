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
