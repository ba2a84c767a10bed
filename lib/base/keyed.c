#include "base/keyed.h"

#include "base/lists.h"

#include <stdlib.h>

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
