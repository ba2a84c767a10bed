/* Sides of the interfaces at which supports stop. */
#include "stages/stages.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/stream/sections.h"

#include <stdio.h>
#include <string.h>

/* place[regions->count] = the place of each region in the list, from 1; 0: not in it. *named: their number.
 */
static enum status read_list(const char *names, const struct names *regions, int32_t *place, int32_t *named,
                             struct error *error)
{
    SCRATCH char *list = strdup(names);
    char *rest = list;
    RETURN_IF_ERROR(list == NULL ? fail_memory(error, "regions") : STATUS_OK);
    for (char *name; (name = strsep(&rest, ",")) != NULL;) {
        int64_t region = names_find(regions, name);
        if (region < 0) {
            return fail(error, STATUS_INPUT, "--interface: no region '%s'; there are: %s", name,
                        regions->list);
        }
        if (place[region] > 0) {
            return fail(error, STATUS_INPUT, "--interface: region '%s' stands twice", name);
        }
        place[region] = ++*named;
    }
    return STATUS_OK;
}

enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                             struct error *error)
{
    struct cells cells;
    FREED_BY(cell_regions_free) struct cell_regions regions = {0};
    int32_t named = 0;
    *side = NULL;
    RETURN_IF_ERROR(stream_cells(stream, names != NULL, &cells, error));
    if (names == NULL && stream_find(stream, "cells.region") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_regions(stream, &regions, error));
    if (names == NULL && regions.names.count < 2) {
        return STATUS_OK;
    }
    NEW_SCRATCH(int32_t, place, regions.names.count, error);
    if (names != NULL) {
        RETURN_IF_ERROR(read_list(names, &regions.names, place, &named, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(side, cells.count, error));
    for (int64_t c = 0; c < cells.count; c++) {
        int32_t region = regions.of_cell[c];
        (*side)[c] = names == NULL ? region : place[region] > 0 ? place[region] - 1 : named;
    }
    return STATUS_OK;
}

enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                        struct error *error)
{
    char name[64];
    struct cells cells;
    const struct section *section;
    snprintf(name, sizeof name, "%s.side", prefix);
    *side = NULL;
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, name, &section, error));
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    *side = section->data;
    return section_check_indices(section, 0, cells.count, "side", "", error);
}

enum status stage_renew(struct stream *stream, const int32_t *side, struct error *error)
{
    struct recorded recorded;
    struct support_report report;
    struct cells cells;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stage_recorded(stream, "support", &recorded, error));
    NEW_SCRATCH(double, radius, cells.node_count, error);
    memcpy(radius, recorded.radius, (size_t)cells.node_count * sizeof *radius);
    recorded.support.side = side;
    sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stage_face_points(stream, error));
    RETURN_IF_ERROR(stage_record(stream, &recorded, cells.node_count, radius, error));
    RETURN_IF_ERROR(stage_lists(stream, &recorded.support, &report, error));
    return stage_shapefn(stream, &recorded.shapes, error);
}
