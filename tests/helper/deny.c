/* deny.so, to be preloaded: lets the allocation number DENY of a program fail, counted from 0 at the start of main, whoever
 * asks for it: the program, the C library, OpenMP. With DENY_EACH=path, only the first allocation of each path of calls counts.
 * Without DENY, none fails, and the number of those that count is written into the file that DENY_COUNT names. The memory comes
 * from the allocator that would serve without it: that of a sanitizer, too (with verify_asan_link_order=0). */
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DEPTH = 24, PATHS = 1 << 14 };

static atomic_bool begun;
static atomic_flag busy = ATOMIC_FLAG_INIT;
static long seen;
static long denied = -1;
static bool by_path;
static uint64_t paths[PATHS]; /* a hash table of paths of calls; 0: free */
static int (*program)(int, char **, char **);

/* Is this the first allocation on its path of calls? A path ends in OpenMP's library, which allocates the same wherever
 * it is called from. A table that is full knows all paths. */
static bool is_new_path(void)
{
    void *frames[DEPTH];
    int depth = backtrace(frames, DEPTH);
    Dl_info caller; /* behind is_new_path, is_denied and the allocator */
    if (depth > 4 && dladdr(frames[3], &caller) != 0 && strstr(caller.dli_fname, "libgomp") != NULL) {
        depth = 4;
    }
    uint64_t hash = 1469598103934665603U;
    for (int i = 0; i < depth; i++) {
        hash = (hash ^ (uint64_t)(uintptr_t)frames[i]) * 1099511628211U;
    }
    hash += hash == 0;
    for (int i = 0; i < PATHS; i++) {
        uint64_t *place = &paths[(hash + (uint64_t)i) % PATHS];
        if (*place == hash) {
            return false;
        }
        if (*place == 0) {
            *place = hash;
            return true;
        }
    }
    return false;
}

static bool is_denied(void)
{
    static _Thread_local bool inside; /* backtrace may allocate, too */
    if (!begun || inside) {
        return false;
    }
    inside = true;
    while (atomic_flag_test_and_set(&busy)) {
    }
    bool is_this = (!by_path || is_new_path()) && seen++ == denied;
    atomic_flag_clear(&busy);
    inside = false;
    if (is_this) {
        errno = ENOMEM;
    }
    return is_this;
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
        dprintf(file, "%ld\n", seen);
        close(file);
    }
}

static int begin(int argc, char **argv, char **environment)
{
    const char *number = getenv("DENY");
    denied = number == NULL ? -1 : atol(number);
    by_path = getenv("DENY_EACH") != NULL;
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
