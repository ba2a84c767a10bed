#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Bytes. Arrays of twice this size and more lie on such pages where the system has them: tables that are
 * streamed through cost fewer page faults and address translations. */
static const size_t huge_page = 1 << 21;

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
    size_t alignment = bytes < 2 * huge_page ? 64 : huge_page;
    size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    void *array = aligned_alloc(alignment, rounded > 0 ? rounded : alignment);
    if (array != NULL) {
#ifdef MADV_HUGEPAGE
        if (alignment == huge_page) {
            (void)madvise(array, rounded, MADV_HUGEPAGE); /* a hint: refused, all works as well */
        }
#endif
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
