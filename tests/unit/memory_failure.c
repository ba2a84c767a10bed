/* Fault 25: whichever allocation fails, the readers of scenes, tables and surfaces and the load curve report
 * it with STATUS_SYSTEM and leave nothing allocated. See failing_allocator.h. */
#include "io/scene/scene.h"
#include "io/files/surface.h"
#include "io/files/table.h"
#include "solid/system/curve.h"

#include <gsl/gsl_errno.h>

#include <stdio.h>
#include <unistd.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

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
    FREED_BY(scene_free) struct scene scene = {0};
    return scene_read(path, &scene, error);
}

static enum status try_table(struct error *error)
{
    FREED_BY(table_free) struct table table = {0};
    return table_read(path, 2, 2, &table, error);
}

static enum status try_surface(struct error *error)
{
    FREED_BY(table_free) struct table table = {0};
    return surface_read(path, 3, &table, error);
}

static enum status try_curve(struct error *error)
{
    static const double points[] = {0, 0, .5, 1, .7, 2, 1, 1};
    FREED_BY(curve_free) struct load_curve curve = {0};
    return curve_tabulate(&curve, 4, points, 1, error);
}

TEST(scenes)
{
    write_file("[scene]\ndim = 2\nanalysis = quasi-static\ntitle = t\n"
               "[material m]\nregion = a, b\nE = 1\nnu = 0\nrho = 1\n"
               "[displacement d]\nfacets = f\ntable = t\nunit = m\ncurve = c\n"
               "[displacement e]\nnodes = f\ncomponents = 0,free\n"
               "[contact c]\nfacets = f\nrigid = r\nunit = m\nside = left\n"
               "[contact b]\nfacets = f\nagainst = g, h\n"
               "[pressure p]\nfacets = f\nvalue = 1\ncurve = c\n"
               "[force p]\nnodes = f\ncomponents = 0,1\n");
    fail_each(try_scene, 90);
}

TEST(tables)
{
    char text[1024] = "";
    for (int i = 0; i < 100; i++) {
        strcat(text, i % 10 == 9 ? "0 0\n\n" : "1 1\n");
    }
    write_file(text);
    fail_each(try_table, 5);
    write_file("0 0 0 1 0 0 0 1 0\n");
    fail_each(try_surface, 3);
}

TEST(curves)
{
    fail_each(try_curve, 3);
}

static int make_file(void **state)
{
    (void)state;
    gsl_set_error_handler_off(); /* as the tools do */
    int descriptor = mkstemp(path);
    return descriptor < 0 ? -1 : close(descriptor);
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path);
}

RUN_TESTS(make_file, remove_file)

#else
RUN_TESTS(NULL, NULL)
#endif
