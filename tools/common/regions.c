#include "regions.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The names= of the section, cut at their commas. */
static enum status read_names(const struct section *section, struct regions *regions, struct error *error)
{
    enum status status;
    size_t size = strlen(section->attributes) + 1;
    TRY(NEW_ARRAY(&regions->list, (int64_t)size, error));
    if (!section_attribute(section, "names", regions->list, size)) {
        return fail(error, STATUS_INPUT, "cells.region: no names=");
    }
    TRY(NEW_ARRAY(&regions->name, (int64_t)size, error));
    for (char *rest = regions->list; rest != NULL;) {
        regions->name[regions->count++] = strsep(&rest, ",");
    }
done:
    return status;
}

enum status regions_read(const struct stream *stream, const struct cells *cells, struct regions *regions,
                         struct error *error)
{
    enum status status = STATUS_OK;
    const struct section *section = stream_find(stream, "cells.region");
    int corners = cells->dim + 1;
    *regions = (struct regions){.node_count = cells->node_count};
    if (section == NULL || cells->count == 0) {
        return STATUS_OK;
    }
    TRY(stream_need(stream, "cells.region", TYPE_I4, 1, "nodes", &section, error));
    if (section->rows != cells->count) {
        return fail(error, STATUS_INPUT, "cells.region: not one row per cell");
    }
    TRY(read_names(section, regions, error));
    TRY(NEW_ARRAY(&regions->member, cells->node_count * regions->count, error));
    const int32_t *region = section->data;
    for (int64_t c = 0; c < cells->count; c++) {
        if (region[c] < 0 || region[c] >= regions->count) {
            return fail(error, STATUS_INPUT, "cells.region: row %lld: no region %d", (long long)c, region[c]);
        }
        for (int k = 0; k < corners; k++) {
            regions->member[cells->node[c * corners + k] * regions->count + region[c]] = true;
        }
    }
done:
    return status;
}

void regions_free(struct regions *regions)
{
    free(regions->name);
    free(regions->list);
    free(regions->member);
    *regions = (struct regions){0};
}

static enum status fail_unknown(const struct regions *regions, const char *name, struct error *error)
{
    char list[256] = "none";
    for (int r = 0; r < regions->count; r++) {
        size_t length = r == 0 ? 0 : strlen(list);
        snprintf(list + length, sizeof list - length, "%s%s", r == 0 ? "" : ", ", regions->name[r]);
    }
    return fail(error, STATUS_INPUT, "--region: no region '%s'; there are: %s", name, list);
}

enum status regions_choose(const struct regions *regions, const char *name, bool **chosen,
                           struct error *error)
{
    enum status status;
    int index = 0;
    *chosen = NULL;
    if (name == NULL) {
        return STATUS_OK;
    }
    while (index < regions->count && strcmp(regions->name[index], name) != 0) {
        index++;
    }
    if (index == regions->count) {
        return fail_unknown(regions, name, error);
    }
    TRY(NEW_ARRAY(chosen, regions->node_count, error));
    for (int64_t n = 0; n < regions->node_count; n++) {
        (*chosen)[n] = regions->member[n * regions->count + index];
    }
done:
    return status;
}
