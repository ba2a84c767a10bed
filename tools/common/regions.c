#include "regions.h"

#include "base/memory.h"

#include <stdlib.h>

enum status regions_read(const struct stream *stream, const struct cells *cells, struct regions *regions,
                         struct error *error)
{
    enum status status;
    struct cell_regions of;
    int corners = cells->dim + 1;
    *regions = (struct regions){.node_count = cells->node_count};
    if (stream_find(stream, "cells.region") == NULL || cells->count == 0) {
        return STATUS_OK;
    }
    status = stream_regions(stream, cells, &of, error);
    regions->names = of.names;
    TRY(status);
    int64_t count = of.names.count;
    TRY(NEW_ARRAY(&regions->member, cells->node_count * count, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        regions->member[cells->node[i] * count + of.of_cell[i / corners]] = true;
    }
done:
    return status;
}

void regions_free(struct regions *regions)
{
    names_free(&regions->names);
    free(regions->member);
    *regions = (struct regions){0};
}

enum status regions_choose(const struct regions *regions, const char *name, bool **chosen,
                           struct error *error)
{
    char list[256];
    *chosen = NULL;
    if (name == NULL) {
        return STATUS_OK;
    }
    int64_t region = names_find(&regions->names, name);
    if (region < 0) {
        return fail(error, STATUS_INPUT, "--region: no region '%s'; there are: %s", name,
                    names_text(&regions->names, list));
    }
    RETURN_IF_ERROR(NEW_ARRAY(chosen, regions->node_count, error));
    for (int64_t n = 0; n < regions->node_count; n++) {
        (*chosen)[n] = regions->member[n * regions->names.count + region];
    }
    return STATUS_OK;
}
