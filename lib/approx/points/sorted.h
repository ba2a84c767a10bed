/* Sets of node indices as ascending lists without repetitions. */
#pragma once

#include <stdint.h>

/* united[at most count_a + count_b] = the union of a and b; returns its size. `united` overlaps neither. */
int64_t sorted_union(const int32_t *a, int64_t count_a, const int32_t *b, int64_t count_b, int32_t *united);

/* place[count]: the place of each index in the list `within`, which contains them all. */
void sorted_places(const int32_t *index, int64_t count, const int32_t *within, int32_t *place);
