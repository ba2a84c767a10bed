#include "groups/group_body.h"

#include "stages/views.h"

#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

const char *const group_kind_names[GROUP_KINDS] = {"facets", "nodes", "region"};

/* Set all members of a list; item NULL: 0, 1, ... */
static enum status set_members(struct group_list *list, int64_t count, const int32_t *group,
                               const int32_t *item, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&list->member, count, error));
    for (int64_t i = 0; i < count; i++) {
        list->member[i] = (struct group_member){group[i], item != NULL ? item[i] : (int32_t)i};
    }
    list->count = list->room = count;
    return STATUS_OK;
}

/* ---- reading ---- */

/* facet[rows]: the facet of the boundary of each row of `facets`. The boundary takes over its order of nodes,
 * so that unchanged groups are written as they were. */
static enum status find_facets(struct group_body *body, const struct groups *named, int32_t *facet,
                               struct error *error)
{
    int dim = body->cells.dim;
    NEW_SCRATCH(int64_t, found, named->count, error);
    RETURN_IF_ERROR(faces_find(&body->boundary, named->count, named->node, found, error));
    for (int64_t i = 0; i < named->count; i++) {
        if (found[i] < 0) {
            return fail(error, STATUS_INPUT, "facets: row %jd: no face of exactly one cell: run nodes again",
                        i);
        }
        facet[i] = (int32_t)found[i];
        memcpy(&body->boundary.node[found[i] * dim], &named->node[i * dim],
               (size_t)dim * sizeof *named->node);
    }
    return STATUS_OK;
}

static enum status read_facets(const struct stream *stream, struct group_body *body, struct error *error)
{
    FREED_BY(groups_free) struct groups named = {0};
    struct group_list *list = &body->groups[GROUP_FACETS];
    RETURN_IF_ERROR(stream_facets(stream, false, &named, error));
    NEW_SCRATCH(int32_t, facet, named.count, error);
    RETURN_IF_ERROR(find_facets(body, &named, facet, error));
    list->names = named.names;
    named.names = (struct names){0};
    return set_members(list, named.count, named.group, facet, error);
}

static enum status read_sets(const struct stream *stream, struct group_body *body, struct error *error)
{
    struct group_list *list = &body->groups[GROUP_NODES];
    FREED_BY(groups_free) struct groups sets = {0};
    RETURN_IF_ERROR(stream_sets(stream, false, &sets, error));
    list->names = sets.names;
    sets.names = (struct names){0};
    return set_members(list, sets.count, sets.group, sets.node, error);
}

static enum status read_regions(const struct stream *stream, struct group_body *body, struct error *error)
{
    FREED_BY(groups_free) struct groups regions = {0};
    struct group_list *list = &body->groups[GROUP_REGION];
    RETURN_IF_ERROR(stream_regions(stream, false, &regions, error));
    if (regions.group == NULL) {
        return STATUS_OK;
    }
    list->names = regions.names;
    regions.names = (struct names){0};
    return set_members(list, body->cells.count, regions.group, NULL, error);
}

enum status group_body_read(const struct stream *stream, struct group_body *body, struct error *error)
{
    *body = (struct group_body){0};
    struct cells *cells = &body->cells;
    RETURN_IF_ERROR(stream_cells(stream, false, cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->node, cells->node_count, error));
    for (int64_t n = 0; n < cells->node_count; n++) {
        body->node[n] = (int32_t)n;
    }
    struct box box = box_of(cells->dim, cells->node_count, cells->x);
    body->diagonal = box_diagonal(&box);
    body->items[GROUP_NODES] = (struct items){cells->dim, cells->node_count, 1, body->node, cells->x};
    if (cells->count > 0) {
        RETURN_IF_ERROR(faces_build(cells, true, &body->boundary, error));
        RETURN_IF_ERROR(read_facets(stream, body, error));
        RETURN_IF_ERROR(read_regions(stream, body, error));
    }
    RETURN_IF_ERROR(read_sets(stream, body, error));
    body->items[GROUP_FACETS] =
        (struct items){cells->dim, body->boundary.count, cells->dim, body->boundary.node, cells->x};
    body->items[GROUP_REGION] =
        (struct items){cells->dim, cells->count, cells->dim + 1, cells->node, cells->x};
    return STATUS_OK;
}

void group_body_free(struct group_body *body)
{
    faces_free(&body->boundary);
    free(body->node);
    for (int kind = 0; kind < GROUP_KINDS; kind++) {
        names_free(&body->groups[kind].names);
        free(body->groups[kind].member);
    }
    *body = (struct group_body){0};
}

/* ---- changing ---- */

enum status group_check_name(const char *name, struct error *error)
{
    static const char *const words[] = {"all", "boundary", "and", "or", "without"};
    if (name[0] == '\0') {
        return fail(error, STATUS_INPUT, "the name is empty");
    }
    for (const char *c = name; *c != '\0'; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr(",\"=:", *c) != NULL) {
            return fail(error, STATUS_INPUT, "'%.60s': no blanks, commas, quotes, colons in names", name);
        }
    }
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strcmp(name, words[i]) == 0) {
            return fail(error, STATUS_INPUT, "'%s' is a word of the expressions: take another name", name);
        }
    }
    return STATUS_OK;
}

/* Remove the members of a group, and (unless it is NULL) of all groups the chosen items. */
static void drop_members(struct group_list *list, int64_t group, const bool *chosen)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < list->count; i++) {
        if (list->member[i].group != group && (chosen == NULL || !chosen[list->member[i].item])) {
            list->member[kept++] = list->member[i];
        }
    }
    list->count = kept;
    list->changed = true;
}

enum status group_put(struct group_body *body, enum group_kind kind, const char *name, const bool *chosen,
                      struct error *error)
{
    struct group_list *list = &body->groups[kind];
    int64_t place = names_find(&list->names, name);
    drop_members(list, place, kind == GROUP_REGION ? chosen : NULL);
    if (place < 0) {
        place = list->names.count;
        RETURN_IF_ERROR(names_add(&list->names, name, error));
    }
    for (int64_t i = 0; i < body->items[kind].count; i++) {
        if (chosen[i]) {
            RETURN_IF_ERROR(GROW_ARRAY(&list->member, list->count + 1, &list->room, error));
            list->member[list->count++] = (struct group_member){(int32_t)place, (int32_t)i};
        }
    }
    return STATUS_OK;
}

enum status group_remove(struct group_list *list, int64_t index, struct error *error)
{
    drop_members(list, index, NULL);
    for (int64_t i = 0; i < list->count; i++) {
        list->member[i].group -= list->member[i].group > index;
    }
    return names_change(&list->names, index, NULL, error);
}

/* ---- writing ---- */

/* The items of each group: (*idx)[(*ptr)[g]] to before (*idx)[(*ptr)[g + 1]]. */
static enum status list_items(const struct group_list *list, int64_t **ptr, int32_t **idx,
                              struct error *error)
{
    NEW_SCRATCH(int32_t, group, list->count, error);
    for (int64_t i = 0; i < list->count; i++) {
        group[i] = list->member[i].group;
    }
    RETURN_IF_ERROR(lists_by_row(list->count, 1, group, list->names.count, ptr, idx, error));
    for (int64_t i = 0; i < list->count; i++) {
        (*idx)[i] = list->member[(*idx)[i]].item;
    }
    return STATUS_OK;
}

static enum status write_facets(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_FACETS];
    int dim = body->boundary.dim;
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    if (list->count == 0) {
        stream_remove(stream, "facets");
        stream_remove(stream, "facets.set");
        return STATUS_OK;
    }
    RETURN_IF_ERROR(list_items(list, &ptr, &idx, error));
    NEW_SCRATCH(int32_t, node, list->count * dim, error);
    NEW_SCRATCH(int32_t, set, list->count, error);
    for (int32_t g = 0; g < list->names.count; g++) {
        for (int64_t i = ptr[g]; i < ptr[g + 1]; i++) {
            memcpy(&node[i * dim], &body->boundary.node[(int64_t)idx[i] * dim], (size_t)dim * sizeof *node);
            set[i] = g;
        }
    }
    RETURN_IF_ERROR(
        stream_put(stream, "facets", TYPE_I4, list->count, dim, "", array_take(&node), true, error));
    return stream_put_named(stream, "facets.set", TYPE_I4, list->count, &list->names, array_take(&set), true,
                            error);
}

static enum status write_sets(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_NODES];
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    if (list->names.count == 0) {
        stream_remove(stream, "sets.ptr");
        stream_remove(stream, "sets.idx");
        return STATUS_OK;
    }
    RETURN_IF_ERROR(list_items(list, &ptr, &idx, error));
    RETURN_IF_ERROR(stream_put_named(stream, "sets.ptr", TYPE_I8, list->names.count + 1, &list->names,
                                     array_take(&ptr), true, error));
    return stream_put(stream, "sets.idx", TYPE_I4, list->count, 1, "", array_take(&idx), true, error);
}

static enum status write_regions(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *list = &body->groups[GROUP_REGION];
    if (list->count < body->cells.count) {
        return fail(error, STATUS_INPUT,
                    "%jd of %jd cells belong to no region: give the rest a name, too (-r "
                    "'NAME=all without region:...')",
                    (body->cells.count - list->count), body->cells.count);
    }
    NEW_SCRATCH(int32_t, region, body->cells.count, error);
    for (int64_t i = 0; i < list->count; i++) {
        region[list->member[i].item] = list->member[i].group;
    }
    return stream_put_named(stream, "cells.region", TYPE_I4, body->cells.count, &list->names,
                            array_take(&region), true, error);
}

enum status group_body_write(const struct group_body *body, struct stream *stream, struct error *error)
{
    const struct group_list *groups = body->groups;
    RETURN_IF_ERROR(groups[GROUP_FACETS].changed ? write_facets(body, stream, error) : STATUS_OK);
    RETURN_IF_ERROR(groups[GROUP_NODES].changed ? write_sets(body, stream, error) : STATUS_OK);
    return groups[GROUP_REGION].changed ? write_regions(body, stream, error) : STATUS_OK;
}
