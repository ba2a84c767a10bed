#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static int bytes_of(int64_t count, size_t size, size_t *bytes)
{
    return count >= 0 && !__builtin_mul_overflow((size_t)count, size, bytes) && *bytes <= SIZE_MAX / 2;
}

void *array_new(int64_t count, size_t size)
{
    size_t bytes;
    if (!bytes_of(count, size, &bytes)) {
        return NULL;
    }
    size_t rounded = (bytes + 63) / 64 * 64;
    void *array = aligned_alloc(64, rounded > 0 ? rounded : 64);
    if (array != NULL) {
        memset(array, 0, rounded);
    }
    return array;
}

void *array_grow(void *array, int64_t count, size_t size)
{
    size_t bytes;
    if (!bytes_of(count, size, &bytes)) {
        return NULL;
    }
    return realloc(array, bytes > 0 ? bytes : 1);
}
