#include "groups/group_body.h"

#include "stages/views.h"

#include "base/box.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

const char *const group_kind_names[GROUP_KINDS] = {"facets", "nodes", "region"};

/* ---- lists ---- */

int64_t group_find(const struct group_list *list, const char *name)
{
    for (int64_t g = 0; g < list->count; g++) {
        if (strcmp(list->group[g].name, name) == 0) {
            return g;
        }
    }
    return -1;
}

void group_remove(struct group_list *list, int64_t index)
{
    FREE_ALL(list->group[index].name, list->group[index].item);
    list->count--;
    memmove(&list->group[index], &list->group[index + 1],
            (size_t)(list->count - index) * sizeof *list->group);
    list->changed = true;
}

/* Append an empty group. */
static enum status add_group(struct group_list *list, const char *name, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&list->group, list->count + 1, error));
    list->group[list->count] = (struct group){.name = strdup(name)};
    if (list->group[list->count].name == NULL) {
        return fail_memory(error, "groups");
    }
    list->count++;
    return STATUS_OK;
}

/* Append empty groups with these names. */
static enum status add_named(struct group_list *list, const struct names *names, struct error *error)
{
    for (int64_t i = 0; i < names->count; i++) {
        RETURN_IF_ERROR(add_group(list, names->name[i], error));
    }
    return STATUS_OK;
}

/* Sort items into the groups of_group[count]; items of a group keep their order. */
static enum status sort_items(struct group_list *list, int64_t count, const int32_t *of_group,
                              const int32_t *item, struct error *error)
{
    for (int64_t i = 0; i < count; i++) {
        list->group[of_group[i]].count++;
    }
    for (int64_t g = 0; g < list->count; g++) {
        RETURN_IF_ERROR(NEW_ARRAY(&list->group[g].item, list->group[g].count, error));
        list->group[g].count = 0;
    }
    for (int64_t i = 0; i < count; i++) {
        struct group *group = &list->group[of_group[i]];
        group->item[group->count++] = item != NULL ? item[i] : (int32_t)i;
    }
    return STATUS_OK;
}

/* ---- reading ---- */

/* facet[rows]: the facet of the boundary of each row of `facets`. The boundary takes over its order of nodes,
 * so that unchanged groups are written as they were. */
static enum status find_facets(struct group_body *body, const struct named_facets *named, int32_t *facet,
                               struct error *error)
{
    int dim = body->cells.dim;
    NEW_SCRATCH(int64_t, found, named->count, error);
    RETURN_IF_ERROR(faces_find(&body->boundary, named->count, named->facet, found, error));
    for (int64_t i = 0; i < named->count; i++) {
        if (found[i] < 0) {
            return fail(error, STATUS_INPUT, "facets: row %lld: no face of exactly one cell: run nodes again",
                        (long long)i);
        }
        facet[i] = (int32_t)found[i];
        memcpy(&body->boundary.node[found[i] * dim], &named->facet[i * dim],
               (size_t)dim * sizeof *named->facet);
    }
    return STATUS_OK;
}

static enum status read_facets(const struct stream *stream, struct group_body *body, struct error *error)
{
    FREED_BY(named_facets_free) struct named_facets named = {0};
    struct group_list *list = &body->groups[GROUP_FACETS];
    RETURN_IF_ERROR(stream_facets(stream, false, &body->cells, &named, error));
    NEW_SCRATCH(int32_t, facet, named.count, error);
    RETURN_IF_ERROR(find_facets(body, &named, facet, error));
    RETURN_IF_ERROR(add_named(list, &named.names, error));
    return sort_items(list, named.count, named.group, facet, error);
}

static enum status read_sets(const struct stream *stream, struct group_body *body, struct error *error)
{
    struct group_list *list = &body->groups[GROUP_NODES];
    FREED_BY(named_sets_free) struct named_sets sets = {0};
    RETURN_IF_ERROR(stream_sets(stream, false, body->cells.node_count, &sets, error));
    RETURN_IF_ERROR(add_named(list, &sets.names, error));
    for (int64_t g = 0; g < list->count; g++) {
        struct group *group = &list->group[g];
        RETURN_IF_ERROR(NEW_ARRAY(&group->item, sets.lists.ptr[g + 1] - sets.lists.ptr[g], error));
        for (int64_t i = sets.lists.ptr[g]; i < sets.lists.ptr[g + 1]; i++) {
            group->item[group->count++] = sets.lists.idx[i];
        }
    }
    return STATUS_OK;
}

static enum status read_regions(const struct stream *stream, struct group_body *body, struct error *error)
{
    FREED_BY(cell_regions_free) struct cell_regions regions = {0};
    struct group_list *list = &body->groups[GROUP_REGION];
    if (stream_find(stream, "cells.region") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_regions(stream, &regions, error));
    RETURN_IF_ERROR(add_named(list, &regions.names, error));
    return sort_items(list, body->cells.count, regions.of_cell, NULL, error);
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
        struct group_list *list = &body->groups[kind];
        while (list->count > 0) {
            group_remove(list, list->count - 1);
        }
        free(list->group);
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

/* Remove the cells of a new region from their former regions. */
static void take_cells(struct group_list *regions, const bool *chosen)
{
    for (int64_t g = 0; g < regions->count; g++) {
        struct group *group = &regions->group[g];
        int64_t kept = 0;
        for (int64_t i = 0; i < group->count; i++) {
            if (!chosen[group->item[i]]) {
                group->item[kept++] = group->item[i];
            }
        }
        group->count = kept;
    }
}

enum status group_put(struct group_body *body, enum group_kind kind, const char *name, const bool *chosen,
                      struct error *error)
{
    struct group_list *list = &body->groups[kind];
    int64_t place = group_find(list, name);
    int64_t count = 0;
    for (int64_t i = 0; i < body->items[kind].count; i++) {
        count += chosen[i];
    }
    NEW_SCRATCH(int32_t, item, count, error);
    count = 0;
    for (int64_t i = 0; i < body->items[kind].count; i++) {
        if (chosen[i]) {
            item[count++] = (int32_t)i;
        }
    }
    if (place < 0) {
        place = list->count;
        RETURN_IF_ERROR(add_group(list, name, error));
    }
    if (kind == GROUP_REGION) {
        take_cells(list, chosen);
    }
    struct group *group = &list->group[place];
    free(group->item);
    group->item = array_take(&item);
    group->count = count;
    list->changed = true;
    return STATUS_OK;
}
