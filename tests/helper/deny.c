/* deny.so, to be preloaded: lets the allocation number DENY of a program fail, counted from 0 at the start of
 * main, whoever asks for it: the program, the C library, OpenMP. Without DENY, none fails, and the
 * number of allocations is written into the file that DENY_COUNT names. The memory comes from the allocator
 * that would serve without it: that of a sanitizer, too (with verify_asan_link_order=0). */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static atomic_bool begun;
static atomic_long seen;
static long denied = -1;
static int (*program)(int, char **, char **);

static bool is_denied(void)
{
    if (!begun || atomic_fetch_add(&seen, 1) != denied) {
        return false;
    }
    errno = ENOMEM;
    return true;
}

/* The next definition of a function behind this one. */
#define NEXT(type, name)                                                                                     \
    static type *next;                                                                                       \
    if (next == NULL) {                                                                                      \
        *(void **)&next = dlsym(RTLD_NEXT, #name);                                                           \
    }

typedef void *one_size(size_t);
typedef void *two_sizes(size_t, size_t);

void *malloc(size_t size)
{
    NEXT(one_size, malloc)
    return is_denied() ? NULL : next(size);
}

void *calloc(size_t count, size_t size)
{
    NEXT(two_sizes, calloc)
    return is_denied() ? NULL : next(count, size);
}

void *realloc(void *memory, size_t size)
{
    typedef void *resize(void *, size_t);
    NEXT(resize, realloc)
    return is_denied() ? NULL : next(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    NEXT(two_sizes, aligned_alloc)
    return is_denied() ? NULL : next(alignment, size);
}

void *memalign(size_t alignment, size_t size)
{
    NEXT(two_sizes, memalign)
    return is_denied() ? NULL : next(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    typedef int align(void **, size_t, size_t);
    NEXT(align, posix_memalign)
    return is_denied() ? ENOMEM : next(memory, alignment, size);
}

static void write_count(void)
{
    const char *path = getenv("DENY_COUNT");
    int file = path == NULL ? -1 : open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0) {
        dprintf(file, "%ld\n", (long)seen);
        close(file);
    }
}

static int begin(int argc, char **argv, char **environment)
{
    const char *number = getenv("DENY");
    denied = number == NULL ? -1 : atol(number);
    if (number == NULL) {
        atexit(write_count);
    }
    begun = true;
    return program(argc, argv, environment);
}

typedef int start_function(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void),
                           void (*)(void), void *);

start_function __libc_start_main;
int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void *stack_end)
{
    NEXT(start_function, __libc_start_main)
    program = main;
    return next(begin, argc, argv, init, fini, rtld_fini, stack_end);
}
