#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Bytes. Arrays of twice this size and more lie on such pages, but for their ends, where the system has them:
 * tables that are streamed through cost fewer page faults and address translations. */
static const size_t huge_page = 1 << 21;

static int bytes_of(int64_t count, size_t size, size_t *bytes)
{
    return count >= 0 && !__builtin_mul_overflow((size_t)count, size, bytes) && *bytes <= SIZE_MAX / 2;
}

/* A hint: refused, all works as well. */
static void prefer_huge_pages(char *array, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    size_t before = (huge_page - (uintptr_t)array % huge_page) % huge_page;
    size_t whole = (bytes - before) / huge_page * huge_page;
    (void)madvise(array + before, whole, MADV_HUGEPAGE);
#endif
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
        if (bytes >= 2 * huge_page) {
            prefer_huge_pages(array, bytes);
        }
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
