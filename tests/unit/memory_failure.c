/* Fault 25: whichever allocation fails, the readers of scenes, tables and surfaces and the load curve report
 * it with STATUS_SYSTEM and leave nothing allocated. The allocator is our own, which can be told to fail;
 * sanitizers bring theirs, so this runs without them only. */
#include "io/scene.h"
#include "io/surface.h"
#include "io/table.h"
#include "solid/curve.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || !defined(__GLIBC__)
int main(void)
{
    return 0;
}
#else

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

static bool watched;
static long before_failure; /* allocations that still succeed */
static long alive;          /* allocated and not yet freed while watched */

static bool is_denied(void)
{
    return watched && before_failure-- == 0;
}

static void *counted(void *memory)
{
    alive += watched && memory != NULL;
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
    return memory == NULL ? counted(__libc_realloc(NULL, size)) : __libc_realloc(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return is_denied() ? NULL : counted(__libc_memalign(alignment, size));
}

void free(void *memory)
{
    alive -= watched && memory != NULL;
    __libc_free(memory);
}

static char path[] = "/tmp/memory-XXXXXX";

static void write_file(const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static enum status try_scene(struct error *error)
{
    struct scene scene;
    enum status status = scene_read(path, &scene, error);
    scene_free(&scene);
    return status;
}

static enum status try_table(struct error *error)
{
    struct table table;
    enum status status = table_read(path, 2, 2, &table, error);
    table_free(&table);
    return status;
}

static enum status try_surface(struct error *error)
{
    struct table table;
    enum status status = surface_read(path, 3, &table, error);
    table_free(&table);
    return status;
}

static enum status try_curve(struct error *error)
{
    static const double points[] = {0, 0, .5, 1, .7, 2, 1, 1};
    struct load_curve curve;
    enum status status = curve_tabulate(&curve, 4, points, 1, error);
    curve_free(&curve);
    return status;
}

/* Let the first, the second, ... allocation fail, until none is left to fail. */
static void fail_each(enum status (*try)(struct error *error), long least)
{
    struct error error = {""};
    enum status status = STATUS_SYSTEM;
    long count = 0;
    for (; status == STATUS_SYSTEM; count++) {
        before_failure = count;
        alive = 0;
        watched = true;
        status = try(&error);
        watched = false;
        assert_int_equal(alive, 0);
        if (status == STATUS_SYSTEM) {
            assert_non_null(strstr(error.text, "out of memory"));
        }
    }
    assert_int_equal(status, STATUS_OK);
    assert_true(count > least);
}

static void scenes(void **state)
{
    (void)state;
    write_file("[scene]\ndim = 2\nanalysis = quasi-static\ntitle = t\n"
               "[material m]\nregion = a, b\nE = 1\nnu = 0\nrho = 1\n"
               "[displacement d]\nfacets = f\ntable = t\nunit = m\ncurve = c\n"
               "[displacement e]\nnodes = f\ncomponents = 0,free\n"
               "[contact c]\nfacets = f\nrigid = r\nunit = m\nside = left\n"
               "[pressure p]\nfacets = f\nvalue = 1\ncurve = c\n"
               "[force p]\nnodes = f\ncomponents = 0,1\n");
    fail_each(try_scene, 100);
}

static void tables(void **state)
{
    (void)state;
    char text[1024] = "";
    for (int i = 0; i < 100; i++) {
        strcat(text, i % 10 == 9 ? "0 0\n\n" : "1 1\n");
    }
    write_file(text);
    fail_each(try_table, 5);
    write_file("0 0 0 1 0 0 0 1 0\n");
    fail_each(try_surface, 3);
}

static void curves(void **state)
{
    (void)state;
    fail_each(try_curve, 3);
}

static int make_file(void **state)
{
    (void)state;
    int descriptor = mkstemp(path);
    return descriptor < 0 ? -1 : close(descriptor);
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes),
        cmocka_unit_test(tables),
        cmocka_unit_test(curves),
    };
    return cmocka_run_group_tests(tests, make_file, remove_file);
}
#endif
