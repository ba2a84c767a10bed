#include "approx/points/sorted.h"

int64_t sorted_union(const int32_t *a, int64_t count_a, const int32_t *b, int64_t count_b, int32_t *united)
{
    int64_t i = 0, k = 0, count = 0;
    while (i < count_a && k < count_b) {
        int32_t least = a[i] < b[k] ? a[i] : b[k];
        united[count++] = least;
        i += a[i] == least;
        k += b[k] == least;
    }
    while (i < count_a) {
        united[count++] = a[i++];
    }
    while (k < count_b) {
        united[count++] = b[k++];
    }
    return count;
}

void sorted_places(const int32_t *index, int64_t count, const int32_t *within, int32_t *place)
{
    int32_t at = 0;
    for (int64_t i = 0; i < count; i++) {
        while (within[at] < index[i]) {
            at++;
        }
        place[i] = at;
    }
}
