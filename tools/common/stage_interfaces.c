/* Sides of the interfaces at which supports stop. */
#include "names.h"
#include "stages.h"

#include <stdlib.h>
#include <string.h>

/* of_region[count]: the place of each region in the list of names, or behind it. */
static enum status sides_of_regions(const char *present, int64_t count, const char *names, int32_t *of_region,
                                    struct error *error)
{
    enum status status = STATUS_OK;
    int32_t named = 0;
    char *list = strdup(names), *rest = list;
    if (list == NULL) {
        return fail_memory(error, "regions");
    }
    for (int64_t r = 0; r < count; r++) {
        of_region[r] = -1;
    }
    for (char *name; (name = strsep(&rest, ",")) != NULL;) {
        int64_t region = names_index(present, name);
        if (region < 0) {
            TRY(fail(error, STATUS_INPUT, "--interface: no region '%s'; there are: %s", name, present));
        }
        if (of_region[region] >= 0) {
            TRY(fail(error, STATUS_INPUT, "--interface: region '%s' stands twice", name));
        }
        of_region[region] = named++;
    }
    for (int64_t r = 0; r < count; r++) {
        of_region[r] = of_region[r] < 0 ? named : of_region[r];
    }
done:
    free(list);
    return status;
}

enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                             struct error *error)
{
    enum status status;
    const struct section *section;
    struct cells cells;
    char *present = NULL;
    int32_t *of_region = NULL;
    int64_t count = 1;
    *side = NULL;
    TRY(stream_cells(stream, true, &cells, error));
    TRY(stream_need(stream, "cells.region", TYPE_I4, 1, "nodes", &section, error));
    TRY(names_of_section(section, &present, error));
    for (const char *c = present; *c != '\0'; c++) {
        count += *c == ',';
    }
    TRY(NEW_ARRAY(&of_region, count, error));
    TRY(NEW_ARRAY(side, cells.count, error));
    TRY(sides_of_regions(present, count, names, of_region, error));
    if (section->rows != cells.count) {
        TRY(fail(error, STATUS_INPUT, "cells.region: does not fit the cells"));
    }
    for (int64_t c = 0; c < cells.count; c++) {
        int32_t region = ((const int32_t *)section->data)[c];
        if (region < 0 || region >= count) {
            TRY(fail(error, STATUS_INPUT, "cells.region: row %lld: no region %d", (long long)c, region));
        }
        (*side)[c] = of_region[region];
    }
done:
    free(present);
    free(of_region);
    if (status != STATUS_OK) {
        free(*side);
        *side = NULL;
    }
    return status;
}

enum status stage_own_part(const struct stream *stream, int64_t node_count, struct support_options *options,
                           struct error *error)
{
    enum status status = STATUS_OK;
    const struct section *node = stream_find(stream, "part.node"), *owner;
    char value[64];
    int64_t part = 0;
    if (node == NULL) {
        return STATUS_OK;
    }
    TRY(stream_need(stream, "part.owner", TYPE_I4, 1, "part", &owner, error));
    if (owner->rows != node_count) {
        TRY(fail(error, STATUS_INPUT, "part.owner: %lld rows for %lld nodes: cut again",
                 (long long)owner->rows, (long long)node_count));
    }
    if (!section_attribute(node, "part", value, sizeof value)) {
        TRY(fail(error, STATUS_INPUT, "part.node: no part=: not written by part"));
    }
    TRY(parse_integer(value, "part.node: part", 0, INT32_MAX, &part, error));
    options->owner = owner->data;
    options->part = (int32_t)part;
done:
    return status;
}
