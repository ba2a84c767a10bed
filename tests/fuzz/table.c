/* Fuzz target: what a scene names: tables, surfaces (STL too) and load curves. The first byte says which. */
#include "fuzz.h"

#include "io/surface.h"
#include "solid/curve.h"
#include "solid/rigid.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

static void require_table(const struct table *table)
{
    REQUIRE(table->rows >= 1 && table->cols >= 1 && table->block_count >= 1);
    for (int64_t i = 0; i < table->rows * table->cols; i++) {
        REQUIRE(isfinite(table->values[i]));
    }
    REQUIRE(table->block_ptr[0] == 0 && table->block_ptr[table->block_count] == table->rows);
    for (int64_t b = 0; b < table->block_count; b++) {
        REQUIRE(table->block_ptr[b] < table->block_ptr[b + 1]);
    }
}

static void try_curve(const struct table *table)
{
    struct load_curve curve;
    struct error error = {""};
    if (is_accepted(curve_tabulate(&curve, table->rows, table->values, 1.0, &error), &error)) {
        for (int i = -1; i <= 11; i++) {
            (void)curve_value(&curve, i * 0.1);
            (void)curve_rate(&curve, i * 0.1);
        }
    }
    curve_free(&curve);
}

static void try_triangles(const struct table *table)
{
    struct rigid_surface surface;
    struct error error = {""};
    if (is_accepted(rigid_build(3, table->rows, table->values, false, &surface, &error), &error)) {
        static const double origin[3];
        struct rigid_contact contact = rigid_closest(&surface, origin, INFINITY);
        REQUIRE(!contact.found || !isnan(contact.gap));
    }
    rigid_free(&surface);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct table table;
    struct error error = {""};
    char name[32], path[64];
    if (size == 0) {
        return 0;
    }
    gsl_set_error_handler_off();
    int file = file_of_bytes(data + 1, size - 1, name);
    snprintf(path, sizeof path, "%s", name);
    int kind = data[0] % 4;
    if (kind == 3) { /* surface_read goes by the name's ending */
        snprintf(path, sizeof path, "/tmp/fuzz-%ld.stl", (long)getpid());
        (void)unlink(path);
        REQUIRE(symlink(name, path) == 0);
    }
    enum status status = kind == 0   ? table_read(path, 2, 6, &table, &error)
                         : kind == 1 ? table_read(path, 2, 2, &table, &error)
                                     : surface_read(path, kind, &table, &error);
    if (is_accepted(status, &error)) {
        require_table(&table);
        if (kind == 1) {
            try_curve(&table);
        } else if (kind == 3) {
            try_triangles(&table);
        }
    } else {
        REQUIRE(table.values == NULL);
    }
    table_free(&table);
    close(file);
    if (kind == 3) {
        (void)unlink(path);
    }
    return 0;
}
