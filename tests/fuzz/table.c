/* Fuzz target: what a scene names: tables, surfaces (STL too), load curves and measured points; and tables of
 * labels; and landmarks. The first byte says which. */
#include "fuzz.h"

#include "io/image/label_table.h"
#include "io/files/surface.h"
#include "solid/system/curve.h"
#include "solid/rigid/rigid.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

/* Names are there, no number has two, and each is found as it stands. */
static void try_labels(const char *path)
{
    FREED_BY(label_table_free) struct label_table table = {0};
    struct error error = {""};
    if (!is_accepted(label_table_read(path, &table, &error), &error)) {
        return;
    }
    REQUIRE(table.range_count > 0 || table.others);
    for (int32_t r = 0; r < table.range_count; r++) {
        int32_t name = -1;
        REQUIRE(table.range[r].first <= table.range[r].last);
        REQUIRE(table.range[r].name >= 0 && table.range[r].name < table.names.count);
        REQUIRE(label_table_find(&table, table.range[r].first, &name) && name == table.range[r].name);
        REQUIRE(label_table_find(&table, table.range[r].last, &name) && name == table.range[r].name);
    }
    for (int32_t n = 0; n < table.names.count; n++) {
        REQUIRE(table.names.name[n][0] != '\0' && strpbrk(table.names.name[n], ",\"=:|\n\t ") == NULL);
        for (int32_t k = 0; k < n; k++) {
            REQUIRE(strcmp(table.names.name[n], table.names.name[k]) != 0);
        }
    }
}

/* Rows of measured points in a plane: what is open is in the columns that may be. */
static void try_points(const char *path)
{
    FREED_BY(table_free) struct table table = {0};
    struct error error = {""};
    if (is_accepted(table_read_open(path, 4, 5, 2, 4, &table, &error), &error)) {
        for (int64_t i = 0; i < table.rows * table.cols; i++) {
            REQUIRE(isfinite(table.values[i]) || (i % table.cols / 2 == 1 && isnan(table.values[i])));
        }
    }
}

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
    FREED_BY(curve_free) struct load_curve curve = {0};
    struct error error = {""};
    if (is_accepted(curve_tabulate(&curve, table->rows, table->values, 1.0, true, &error), &error)) {
        for (int i = -1; i <= 11; i++) {
            (void)curve_value(&curve, i * 0.1);
            (void)curve_rate(&curve, i * 0.1);
        }
    }
}

static void try_triangles(const struct table *table)
{
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    struct error error = {""};
    if (is_accepted(rigid_build(3, table->rows, table->values, false, &surface, &error), &error)) {
        static const double origin[3];
        struct rigid_contact contact = rigid_closest(&surface, origin, INFINITY);
        REQUIRE(!contact.found || !isnan(contact.gap));
    }
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
    if (data[0] == 4 || data[0] == 5) {
        data[0] == 4 ? try_labels(path) : try_points(path);
        close(file);
        return 0;
    }
    int kind = data[0] % 4;
    const char *ending = data[0] == 6 ? ".mrk.json" : data[0] == 8 ? ".fcsv" : kind == 3 ? ".stl" : NULL;
    if (ending != NULL) { /* the readers go by the name's ending */
        snprintf(path, sizeof path, "/tmp/fuzz-%ld%s", (long)getpid(), ending);
        (void)unlink(path);
        REQUIRE(symlink(name, path) == 0);
    }
    enum status status = kind == 0 || data[0] == 6 ? table_read(path, 2, 6, &table, &error)
                         : kind == 1               ? table_read(path, 2, 2, &table, &error)
                                                   : surface_read(path, kind, &table, &error);
    if (is_accepted(status, &error)) {
        require_table(&table);
        if (table.label != NULL) {
            const char *label = table.label[table.rows - 1];
            REQUIRE(table.cols == 3 && strlen(label) < size);
        } else if (kind == 1) {
            try_curve(&table);
        } else if (kind == 3) {
            try_triangles(&table);
        }
    }
    table_free(&table);
    close(file);
    if (ending != NULL) {
        (void)unlink(path);
    }
    return 0;
}
