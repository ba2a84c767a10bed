#include "points.h"

#include "stages/views.h"

#include "io/files/table.h"

#include <string.h>

void points_of_table(const struct tool *tool, const char *file, int dim, struct points *points)
{
    FREED_BY(table_free) struct table table = {0};
    double unit = table_unit(file, tool_length_unit(tool, "unit", 1));
    TOOL_TRY(tool, table_read(file, dim > 0 ? dim : 2, dim > 0 ? dim : 3, &table, &error));
    *points = (struct points){.what = file, .dim = (int)table.cols, .count = table.rows};
    points->x = array_take(&table.values);
    points->label = array_take(&table.label);
    points->text = array_take(&table.text);
    for (int64_t i = 0; i < points->count * points->dim; i++) {
        points->x[i] *= unit;
    }
}

void points_of_section(const struct tool *tool, const struct stream *stream, const char *name,
                       struct points *points)
{
    const struct section *at;
    TOOL_TRY(tool, section_kind_of(name) != NULL
                       ? stream_view(stream, name, &at, &error)
                       : stream_need(stream, name, TYPE_F8, 0, "nodes", &at, &error));
    if (at->type != TYPE_F8 || at->cols < 2 || at->cols > 3) {
        tool_fail(tool, STATUS_INPUT, "%s: %jd columns of %s: points have 2 or 3 coordinates, f8", name,
                  at->cols, element_type_name(at->type));
    }
    *points = (struct points){.what = name, .dim = (int)at->cols, .count = at->rows};
    TOOL_TRY(tool, NEW_ARRAY(&points->x, at->rows * at->cols, &error));
    memcpy(points->x, at->data, (size_t)(at->rows * at->cols) * sizeof *points->x);
}

void points_in_regions(const struct tool *tool, const struct stream *stream, const char *list,
                       struct points *points)
{
    FREED_BY(groups_free) struct groups regions = {0};
    FREED_BY(names_free) struct names given = {0};
    const struct section *cell;
    int64_t kept = 0;
    TOOL_TRY(tool, stream_view(stream, "points.cell", &cell, &error));
    TOOL_TRY(tool, stream_groups(stream, GROUP_REGION, true, &regions, &error));
    TOOL_TRY(tool, section_check_indices(cell, 0, regions.count, "cell", " of a region", &error));
    TOOL_TRY(tool, names_split(&given, list, &error));
    TOOL_SCRATCH(tool, bool, wanted, regions.names.count);
    for (int64_t i = 0; i < given.count; i++) {
        int64_t index;
        TOOL_TRY(tool,
                 fail_in(&error, names_need(&regions.names, "region", given.name[i], &index, &error), "-r"));
        wanted[index] = true;
    }
    for (int64_t q = 0; q < points->count; q++) {
        if (wanted[regions.group[((const int32_t *)cell->data)[q]]]) {
            memmove(points->x + kept++ * points->dim, points->x + q * points->dim,
                    (size_t)points->dim * sizeof *points->x);
        }
    }
    points->count = kept;
}

void points_free(struct points *points)
{
    FREE_ALL(points->x, points->label, points->text);
}
