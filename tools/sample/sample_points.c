#include "sample/sample_points.h"

#include "stage_options.h"

#include "stages/views.h"

#include "io/files/table.h"

#include <string.h>

void sample_points_table(const struct tool *tool, const char *file, double unit, struct sample_points *rows)
{
    FREED_BY(table_free) struct table table = {0};
    TOOL_TRY(tool, table_read(file, 2, 3, &table, &error));
    *rows =
        (struct sample_points){.what = file, .dim = (int)table.cols, .count = table.rows, .x = table.values};
    table.values = NULL;
    for (int64_t i = 0; i < rows->count * rows->dim; i++) {
        rows->x[i] *= table_unit(file, unit);
    }
}

static void choose_regions(const struct tool *tool, const struct stream *stream, const char *list,
                           struct sample_points *rows)
{
    FREED_BY(groups_free) struct groups regions = {0};
    FREED_BY(names_free) struct names given = {0};
    const struct section *cell;
    int64_t kept = 0;
    TOOL_TRY(tool, stream_view(stream, "points.cell", &cell, &error));
    TOOL_TRY(tool, stream_groups(stream, GROUP_REGION, true, &regions, &error));
    TOOL_TRY(tool, section_check_indices(cell, 0, stream_find(stream, "cells.region")->rows, "cell",
                                         " of a region", &error));
    TOOL_TRY(tool, names_split(&given, list, &error));
    TOOL_SCRATCH(tool, bool, wanted, regions.names.count);
    for (int64_t i = 0; i < given.count; i++) {
        int64_t index;
        TOOL_TRY(tool,
                 fail_in(&error, names_need(&regions.names, "region", given.name[i], &index, &error), "-r"));
        wanted[index] = true;
    }
    for (int64_t q = 0; q < rows->count; q++) {
        if (wanted[regions.group[((const int32_t *)cell->data)[q]]]) {
            memmove(rows->x + kept++ * rows->dim, rows->x + q * rows->dim,
                    (size_t)rows->dim * sizeof *rows->x);
        }
    }
    rows->count = kept;
}

void sample_points_section(const struct tool *tool, const char *file, const char *name, const char *regions,
                           struct stream *stream, struct sample_points *rows)
{
    const struct section *at;
    tool_read(tool, file, stream);
    if (strcmp(name, "points.x") == 0) {
        stage_fill(tool, stream, "ipoints");
    }
    TOOL_TRY(tool, stream_need(stream, name, TYPE_F8, 0, "nodes", &at, &error));
    if (at->cols < 2 || at->cols > 3) {
        tool_fail(tool, STATUS_INPUT, "%s: %jd columns: points have 2 or 3 coordinates", name, at->cols);
    }
    *rows = (struct sample_points){.what = name, .dim = (int)at->cols, .count = at->rows};
    TOOL_TRY(tool, NEW_ARRAY(&rows->x, at->rows * at->cols, &error));
    memcpy(rows->x, at->data, (size_t)(at->rows * at->cols) * sizeof *rows->x);
    if (regions != NULL) {
        choose_regions(tool, stream, regions, rows);
    }
}
