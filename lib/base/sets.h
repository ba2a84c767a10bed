/* Sets of numbers 0, 1, ... that are joined (union and find): first[i] is an earlier member of the set of i,
 * or i itself, which it is at first. */
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

/* first[node_count]: the nodes that cells connect, node[cells * corners], are joined. */
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
