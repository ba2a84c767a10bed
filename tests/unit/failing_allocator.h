/* The allocator of a test program, which can be told to fail. Sanitizers bring their own: with them
 * FAILING_ALLOCATOR is not defined, and there is nothing to test. */
#pragma once

#include "unit.h"

#include <errno.h>
#include <malloc.h>

#if !defined(__SANITIZE_ADDRESS__) && defined(__GLIBC__)
#define FAILING_ALLOCATOR

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

static bool watched;
static long before_failure; /* allocations that still succeed */
static long alive;          /* allocated and not yet freed while watched */
static int64_t held, most;  /* bytes of these, and the most there were at a time */

static bool is_denied(void)
{
    return watched && before_failure-- == 0;
}

static void *counted(void *memory)
{
    if (watched && memory != NULL) {
        alive++;
        held += (int64_t)malloc_usable_size(memory);
        most = held > most ? held : most;
    }
    return memory;
}

void *malloc(size_t size)
{
    return is_denied() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return is_denied() ? NULL : counted(__libc_calloc(count, size));
}

void *realloc(void *memory, size_t size)
{
    if (is_denied()) {
        return NULL;
    }
    if (memory == NULL || !watched) {
        return memory == NULL ? counted(__libc_realloc(NULL, size)) : __libc_realloc(memory, size);
    }
    int64_t before = (int64_t)malloc_usable_size(memory);
    void *grown = __libc_realloc(memory, size);
    if (grown != NULL) {
        held += (int64_t)malloc_usable_size(grown) - before;
        most = held > most ? held : most;
    }
    return grown;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return is_denied() ? NULL : counted(__libc_memalign(alignment, size));
}

/* What OpenMP allocates its teams by: counted, never denied. */
void *memalign(size_t alignment, size_t size)
{
    return counted(__libc_memalign(alignment, size));
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    *memory = counted(__libc_memalign(alignment, size));
    return *memory == NULL ? ENOMEM : 0;
}

void free(void *memory)
{
    if (watched && memory != NULL) {
        alive--;
        held -= (int64_t)malloc_usable_size(memory);
    }
    __libc_free(memory);
}

#ifdef WITHOUT_LIBGOMP
/* In place of libgomp's, which ends the program when it gets no memory: all work on this thread. */
void GOMP_parallel(void (*work)(void *), void *data, unsigned threads, unsigned flags);
void GOMP_parallel(void (*work)(void *), void *data, unsigned threads, unsigned flags)
{
    (void)threads;
    (void)flags;
    work(data);
}
#endif

/* Let the first, the second, ... allocation fail, until none is left to fail. A run that succeeds all the
 * same is one of qsort, which does without memory when it gets none. What OpenMP keeps it has from a first
 * run, unwatched: of one thread. */
static inline void fail_each(enum status (*try)(struct error *error), long least)
{
    struct error error = {""};
    long failed = 0, count = 0;
    assert_int_equal(try(&error), STATUS_OK);
    for (bool denied = true; denied; count++) {
        before_failure = count;
        alive = 0;
        watched = true;
        enum status status = try(&error);
        watched = false;
        denied = before_failure < 0;
        assert_int_equal(alive, 0);
        assert_true(status == STATUS_OK ||
                    (status == STATUS_SYSTEM && strstr(error.text, "out of memory") != NULL));
        failed += status == STATUS_SYSTEM;
    }
    assert_true(failed > least);
}

#endif
