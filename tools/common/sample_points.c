#include "sample_points.h"

#include "names.h"
#include "stages.h"
#include "views.h"

#include "io/table.h"

#include <stdlib.h>
#include <string.h>

void sample_points_table(const struct tool *tool, const char *file, double unit, struct sample_points *rows)
{
    struct table table;
    struct error error;
    tool_check(tool, table_read(file, 2, 3, &table, &error), &error);
    *rows =
        (struct sample_points){.what = file, .dim = (int)table.cols, .count = table.rows, .x = table.values};
    table.values = NULL;
    table_free(&table);
    for (int64_t i = 0; i < rows->count * rows->dim; i++) {
        rows->x[i] *= unit;
    }
}

/* wanted[...]: for each region whether the list names it; allocated. */
static bool *find_regions(const struct tool *tool, const struct section *region, const char *list,
                          size_t *most)
{
    struct error error;
    char *names, *copy = strdup(list), *name;
    bool *wanted;
    tool_check(tool, copy == NULL ? fail_memory(&error, "-r") : STATUS_OK, &error);
    tool_check(tool, names_of_section(region, &names, &error), &error);
    *most = strlen(names) + 1;
    tool_check(tool, NEW_ARRAY(&wanted, (int64_t)*most, &error), &error);
    for (char *rest = copy; (name = strsep(&rest, ",")) != NULL;) {
        int64_t index = names_index(names, name);
        if (index < 0) {
            tool_fail(tool, STATUS_INPUT, "-r: no region '%s': there are %s", name, names);
        }
        wanted[index] = true;
    }
    free(copy);
    free(names);
    return wanted;
}

/* Keep the points in cells of the chosen regions. */
static void choose_regions(const struct tool *tool, const struct stream *stream, const char *list,
                           struct sample_points *rows)
{
    struct error error;
    const struct section *cell, *region;
    int64_t kept = 0;
    size_t most;
    tool_check(tool, stream_need(stream, "points.cell", TYPE_I4, 1, "ipoints", &cell, &error), &error);
    tool_check(tool, stream_need(stream, "cells.region", TYPE_I4, 1, "nodes", &region, &error), &error);
    if (cell->rows != rows->count) {
        tool_fail(tool, STATUS_INPUT, "points.cell: not one row per point: run ipoints again");
    }
    bool *wanted = find_regions(tool, region, list, &most);
    for (int64_t q = 0; q < rows->count; q++) {
        int64_t c = ((const int32_t *)cell->data)[q];
        int64_t r = c >= 0 && c < region->rows ? ((const int32_t *)region->data)[c] : -1;
        if (r < 0 || (size_t)r >= most) {
            tool_fail(tool, STATUS_INPUT, "points.cell: row %lld: no cell of a region", (long long)q);
        }
        if (wanted[r]) {
            memmove(rows->x + kept++ * rows->dim, rows->x + q * rows->dim,
                    (size_t)rows->dim * sizeof *rows->x);
        }
    }
    rows->count = kept;
    free(wanted);
}

void sample_points_section(const struct tool *tool, const char *file, const char *name, const char *regions,
                           struct stream *stream, struct sample_points *rows)
{
    struct error error;
    const struct section *at;
    tool_read(tool, file, stream);
    if (strcmp(name, "points.x") == 0) {
        stage_fill(tool, stream, "ipoints");
    }
    tool_check(tool, stream_need(stream, name, TYPE_F8, 0, "nodes", &at, &error), &error);
    if (at->cols < 2 || at->cols > 3) {
        tool_fail(tool, STATUS_INPUT, "%s: %lld columns: points have 2 or 3 coordinates", name,
                  (long long)at->cols);
    }
    *rows = (struct sample_points){.what = name, .dim = (int)at->cols, .count = at->rows};
    tool_check(tool, NEW_ARRAY(&rows->x, at->rows * at->cols, &error), &error);
    memcpy(rows->x, at->data, (size_t)(at->rows * at->cols) * sizeof *rows->x);
    if (regions != NULL) {
        choose_regions(tool, stream, regions, rows);
    }
}
