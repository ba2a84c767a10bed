/* Disjoint sets of the numbers 0, 1, ... (union-find). first[i] is i or an earlier member of the set of i; at
 * the beginning first[i] = i. */
#pragma once

#include <stdint.h>

/* The first member of the set that i is in. */
static inline int32_t set_first(int32_t first[], int32_t i)
{
    while (first[i] != i) {
        first[i] = first[first[i]];
        i = first[i];
    }
    return i;
}

static inline void set_join(int32_t first[], int32_t a, int32_t b)
{
    a = set_first(first, a);
    b = set_first(first, b);
    first[a > b ? a : b] = a > b ? b : a;
}

/* first[i] becomes the number of the set of i, from 0 in the order of their first members. Returns how many.
 */
static inline int32_t set_number(int64_t count, int32_t first[])
{
    int32_t sets = 0;
    for (int64_t i = 0; i < count; i++) { /* that of the member before already has its number */
        first[i] = first[i] == i ? sets++ : first[first[i]];
    }
    return sets;
}

/* Initialise first[node_count], and join the nodes of each cell, node[cells * corners]. */
static inline void set_join_cells(int64_t node_count, int64_t cells, int corners, const int32_t *node,
                                  int32_t first[])
{
    for (int64_t n = 0; n < node_count; n++) {
        first[n] = (int32_t)n;
    }
    for (int64_t i = 0; i < cells * corners; i++) {
        set_join(first, node[i / corners * corners], node[i]);
    }
}
