#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static int bytes_of(int64_t count, size_t size, size_t *bytes)
{
    return count >= 0 && !__builtin_mul_overflow((size_t)count, size, bytes) && *bytes <= SIZE_MAX / 2;
}

/* Pages of arrays from this size on become zeros when they are first touched. */
static const size_t large = 1 << 20;

void *array_new(int64_t count, size_t size)
{
    size_t bytes, page = (size_t)sysconf(_SC_PAGESIZE);
    if (!bytes_of(count, size, &bytes)) {
        return NULL;
    }
    bytes = bytes > 0 ? (bytes + 63) / 64 * 64 : 64;
    char *array = aligned_alloc(64, bytes);
    if (array == NULL) {
        return NULL;
    }
    /* Private pages that are released read as zeros afterwards. */
    size_t before = (page - (uintptr_t)array % page) % page;
    size_t whole = bytes > before ? (bytes - before) / page * page : 0;
    if (bytes < large || madvise(array + before, whole, MADV_DONTNEED) != 0) {
        before = bytes;
        whole = 0;
    }
    memset(array, 0, before);
    memset(array + before + whole, 0, bytes - before - whole);
    return array;
}

void memory_give_back(const void *begin, size_t bytes)
{
    uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), from = (uintptr_t)begin, to = from + bytes;
    from = (from + page - 1) / page * page;
    to = to / page * page;
    if (from < to) {
        (void)madvise((void *)from, to - from, MADV_DONTNEED);
    }
}

void *array_grow(void *array, int64_t count, size_t size)
{
    size_t bytes;
    if (!bytes_of(count, size, &bytes)) {
        return NULL;
    }
    return realloc(array, bytes > 0 ? bytes : 1);
}

void *array_take(void *pointer)
{
    void *array;
    memcpy(&array, pointer, sizeof array);
    memset(pointer, 0, sizeof array);
    return array;
}

void scratch_free(void *pointer)
{
    free(array_take(pointer));
}

enum status array_resize(void *pointer, int64_t count, size_t size, const char *name, struct error *error)
{
    void *array;
    memcpy(&array, pointer, sizeof array);
    array = array_grow(array, count, size);
    if (array == NULL) {
        return fail_memory(error, name);
    }
    memcpy(pointer, &array, sizeof array);
    return STATUS_OK;
}

enum status array_grow_list(void *pointer, int64_t needed, int64_t *room, size_t size, const char *name,
                            struct error *error)
{
    int64_t larger = needed + needed / 2 + 64;
    RETURN_IF_ERROR(array_resize(pointer, larger, size, name, error));
    *room = larger;
    return STATUS_OK;
}

void free_all(size_t count, void *const array[])
{
    for (size_t i = 0; i < count; i++) {
        free(array[i]);
    }
}

enum status owned_add(struct owned *owned, void *memory, const char *name, struct error *error)
{
    void **grown = memory == NULL ? NULL : array_grow(owned->item, owned->count + 1, sizeof *grown);
    if (grown == NULL) {
        free(memory);
        return fail_memory(error, name);
    }
    owned->item = grown;
    owned->item[owned->count++] = memory;
    return STATUS_OK;
}

void owned_free(struct owned *owned)
{
    for (int64_t i = 0; i < owned->count; i++) {
        free(owned->item[i]);
    }
    free(owned->item);
    *owned = (struct owned){0};
}
