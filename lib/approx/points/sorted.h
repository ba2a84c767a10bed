/* Sets of node indices as ascending lists without repeats: unions, and places within them. */
#pragma once

#include <stdint.h>

/* united[at most count_a + count_b] = a and b, each index once; returns how many. `united` overlaps neither.
 */
int64_t sorted_union(const int32_t *a, int64_t count_a, const int32_t *b, int64_t count_b, int32_t *united);

/* place[count]: where each of the indices stands in the list `within`, which holds them all. */
void sorted_places(const int32_t *index, int64_t count, const int32_t *within, int32_t *place);
