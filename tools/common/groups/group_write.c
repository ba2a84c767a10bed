/* Writing modified groups into the stream. */
#include "groups/group_body.h"

#include "base/memory.h"
#include "base/names.h"

#include <string.h>

/* *text = "names=a,b" of the groups, to be freed. */
static enum status names_of_groups(const struct group_list *list, char **text, struct error *error)
{
    FREED_BY(names_free) struct names names = {0};
    for (int64_t g = 0; g < list->count; g++) {
        RETURN_IF_ERROR(names_add(&names, list->group[g].name, error));
    }
    return names_attribute(&names, text, error);
}

static int64_t item_count(const struct group_list *list)
{
    int64_t sum = 0;
    for (int64_t g = 0; g < list->count; g++) {
        sum += list->group[g].count;
    }
    return sum;
}

static enum status write_facets(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_FACETS];
    int dim = body->boundary.dim;
    int64_t count = item_count(list);
    int64_t at = 0;
    SCRATCH int32_t *set = NULL;
    SCRATCH char *names = NULL;
    if (count == 0) {
        stream_remove(stream, "facets");
        stream_remove(stream, "facets.set");
        return STATUS_OK;
    }
    NEW_SCRATCH(int32_t, node, count * dim, error);
    RETURN_IF_ERROR(NEW_ARRAY(&set, count, error));
    RETURN_IF_ERROR(names_of_groups(list, &names, error));
    for (int64_t g = 0; g < list->count; g++) {
        for (int64_t i = 0; i < list->group[g].count; i++, at++) {
            memcpy(&node[at * dim], &body->boundary.node[(int64_t)list->group[g].item[i] * dim],
                   (size_t)dim * sizeof *node);
            set[at] = (int32_t)g;
        }
    }
    RETURN_IF_ERROR(stream_put(stream, "facets", TYPE_I4, count, dim, "", array_take(&node), true, error));
    return stream_put(stream, "facets.set", TYPE_I4, count, 1, names, array_take(&set), true, error);
}

static enum status write_sets(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_NODES];
    int64_t count = item_count(list);
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    SCRATCH char *names = NULL;
    if (list->count == 0) {
        stream_remove(stream, "sets.ptr");
        stream_remove(stream, "sets.idx");
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&ptr, list->count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&idx, count, error));
    RETURN_IF_ERROR(names_of_groups(list, &names, error));
    for (int64_t g = 0; g < list->count; g++) {
        ptr[g + 1] = ptr[g] + list->group[g].count;
        memcpy(&idx[ptr[g]], list->group[g].item, (size_t)list->group[g].count * sizeof *idx);
    }
    RETURN_IF_ERROR(
        stream_put(stream, "sets.ptr", TYPE_I8, list->count + 1, 1, names, array_take(&ptr), true, error));
    return stream_put(stream, "sets.idx", TYPE_I4, count, 1, "", array_take(&idx), true, error);
}

static enum status write_regions(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_REGION];
    int64_t lacking = body->cells.count - item_count(list);
    SCRATCH int32_t *region = NULL;
    SCRATCH char *names = NULL;
    if (lacking > 0) {
        return fail(error, STATUS_INPUT,
                    "%lld of %lld cells belong to no region: give the rest a name, too (-r "
                    "'NAME=all without region:...')",
                    (long long)lacking, (long long)body->cells.count);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&region, body->cells.count, error));
    RETURN_IF_ERROR(names_of_groups(list, &names, error));
    for (int64_t g = 0; g < list->count; g++) {
        for (int64_t i = 0; i < list->group[g].count; i++) {
            region[list->group[g].item[i]] = (int32_t)g;
        }
    }
    return stream_put(stream, "cells.region", TYPE_I4, body->cells.count, 1, names, array_take(&region), true,
                      error);
}

enum status group_body_write(const struct group_body *body, struct stream *stream, struct error *error)
{
    RETURN_IF_ERROR(body->groups[GROUP_FACETS].changed ? write_facets(body, stream, error) : STATUS_OK);
    RETURN_IF_ERROR(body->groups[GROUP_NODES].changed ? write_sets(body, stream, error) : STATUS_OK);
    return body->groups[GROUP_REGION].changed ? write_regions(body, stream, error) : STATUS_OK;
}
