/* deny.so, to be preloaded: lets the allocation number DENY of a program fail, counted from 0 at the begin of
 * main, whoever asks for it: the program, the C library, OpenMP, gmsh. Without DENY, none fails, and the
 * number of allocations is written into the file that DENY_COUNT names. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

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

void *malloc(size_t size)
{
    return is_denied() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return is_denied() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return is_denied() ? NULL : __libc_realloc(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return is_denied() ? NULL : __libc_memalign(alignment, size);
}

void *memalign(size_t alignment, size_t size)
{
    return is_denied() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    *memory = is_denied() ? NULL : __libc_memalign(alignment, size);
    return *memory == NULL ? ENOMEM : 0;
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
    void *symbol = dlsym(RTLD_NEXT, "__libc_start_main");
    start_function *start;
    *(void **)&start = symbol;
    program = main;
    return start(begin, argc, argv, init, fini, rtld_fini, stack_end);
}
