#include "groups/group_body.h"

#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

const char *const group_kind_names[GROUP_KINDS] = {"facets", "nodes", "region"};

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

static enum status read_groups(const struct stream *stream, enum group_kind kind, struct group_body *body,
                               struct error *error)
{
    FREED_BY(groups_free) struct groups groups = {0};
    struct group_list *list = &body->groups[kind];
    RETURN_IF_ERROR(stream_groups(stream, kind, false, &groups, error));
    NEW_SCRATCH(int32_t, facet, groups.count, error);
    if (kind == GROUP_FACETS) {
        RETURN_IF_ERROR(find_facets(body, &groups, facet, error));
    }
    list->names = groups.names;
    groups.names = (struct names){0};
    RETURN_IF_ERROR(NEW_ARRAY(&list->member, groups.count, error));
    for (int64_t i = 0; i < groups.count; i++) {
        int32_t item = kind == GROUP_FACETS ? facet[i] : kind == GROUP_NODES ? groups.node[i] : (int32_t)i;
        list->member[i] = (struct group_member){groups.group[i], item};
    }
    list->count = list->room = groups.count;
    return STATUS_OK;
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
        RETURN_IF_ERROR(read_groups(stream, GROUP_FACETS, body, error));
        RETURN_IF_ERROR(read_groups(stream, GROUP_REGION, body, error));
    }
    RETURN_IF_ERROR(read_groups(stream, GROUP_NODES, body, error));
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
    return names_remove(&list->names, index, error);
}

/* ---- writing ---- */

/* Facets and nodes are written by groups, cells by their number. */
static enum status write_groups(const struct group_body *body, enum group_kind kind, struct stream *stream,
                                struct error *error)
{
    const struct group_list *list = &body->groups[kind];
    const struct items *items = &body->items[kind];
    int corners = items->corners;
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    NEW_SCRATCH(int32_t, by, list->count, error);
    NEW_SCRATCH(int32_t, node, list->count * corners, error);
    NEW_SCRATCH(int32_t, group, list->count, error);
    if (kind == GROUP_REGION && list->count < body->cells.count) {
        return fail(error, STATUS_INPUT,
                    "%jd of %jd cells belong to no region: give the rest a name, too (-r "
                    "'NAME=all without region:...')",
                    (body->cells.count - list->count), body->cells.count);
    }
    for (int64_t i = 0; i < list->count; i++) {
        by[i] = kind == GROUP_REGION ? list->member[i].item : list->member[i].group;
    }
    int64_t rows = kind == GROUP_REGION ? body->cells.count : list->names.count;
    RETURN_IF_ERROR(lists_by_row(list->count, 1, by, rows, &ptr, &idx, error));
    for (int64_t i = 0; i < list->count; i++) {
        const struct group_member *member = &list->member[idx[i]];
        memcpy(node + i * corners, items->item + (int64_t)member->item * corners,
               (size_t)corners * sizeof *node);
        group[i] = member->group;
    }
    return stream_put_groups(stream, kind, &list->names, list->count, &node, &group, error);
}

enum status group_body_write(const struct group_body *body, struct stream *stream, struct error *error)
{
    for (int kind = 0; kind < GROUP_KINDS; kind++) {
        if (body->groups[kind].changed) {
            RETURN_IF_ERROR(write_groups(body, (enum group_kind)kind, stream, error));
        }
    }
    return STATUS_OK;
}
