#include "stages/views.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- nodes, cells and groups ---- */

enum status stream_nodes(const struct stream *stream, int *dim, int64_t *node_count, const double **x,
                         struct error *error)
{
    const struct section *nodes;
    RETURN_IF_ERROR(stream_view(stream, "nodes.x", &nodes, error));
    if (nodes->rows < 1 || nodes->rows > INT32_MAX) {
        return fail(error, STATUS_INPUT, "nodes.x: %jd rows: not a cloud of nodes", nodes->rows);
    }
    *dim = (int)nodes->cols;
    if (node_count != NULL) {
        *node_count = nodes->rows;
        *x = nodes->data;
    }
    return STATUS_OK;
}

enum status stream_cells(const struct stream *stream, bool needed, struct cells *cells, struct error *error)
{
    const struct section *section = stream_find(stream, "cells");
    *cells = (struct cells){0};
    RETURN_IF_ERROR(stream_nodes(stream, &cells->dim, &cells->node_count, &cells->x, error));
    if (section == NULL && !needed) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, "cells", &section, error));
    cells->count = section->rows;
    cells->node = section->data;
    return cells_check(cells, error);
}

enum status stream_field(const struct stream *stream, const char *name, int cols, int64_t node_count,
                         const struct section **field, struct error *error)
{
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_F8, cols, "mtled", field, error));
    if ((*field)->cols > 3 || (*field)->rows != node_count) {
        return fail(error, STATUS_INPUT,
                    "%s: %jd rows of %jd columns: not a field of 1 to 3 columns on %jd nodes", name,
                    (*field)->rows, (*field)->cols, node_count);
    }
    return STATUS_OK;
}

enum status names_of(const struct section *section, const char *key, struct names *names, struct error *error)
{
    size_t size = strlen(section->attributes) + 1;
    *names = (struct names){0};
    NEW_SCRATCH(char, list, (int64_t)size, error);
    return section_attribute(section, key, list, size) ? names_split(names, list, error) : STATUS_OK;
}

/* The nodes of all sets, and the set of each. */
static enum status view_sets(const struct stream *stream, struct groups *sets, struct error *error)
{
    struct neighbours lists;
    RETURN_IF_ERROR(stream_neighbours(stream, "sets", sets->names.count, &lists, error));
    sets->count = lists.ptr[lists.count];
    RETURN_IF_ERROR(NEW_ARRAY(&sets->owned, sets->count, error));
    for (int32_t s = 0; s < lists.count; s++) {
        for (int64_t i = lists.ptr[s]; i < lists.ptr[s + 1]; i++) {
            sets->owned[i] = s;
        }
    }
    sets->node = lists.idx;
    sets->group = sets->owned;
    return STATUS_OK;
}

/* The sections that tell the groups of items, with their names. */
static const char *const group_sections[GROUP_KINDS] = {"facets.set", "sets.ptr", "cells.region"};

enum status stream_groups(const struct stream *stream, enum group_kind kind, bool needed,
                          struct groups *groups, struct error *error)
{
    const struct section *section, *facets;
    *groups = (struct groups){0};
    if (!needed && stream_find(stream, kind == GROUP_FACETS ? "facets" : group_sections[kind]) == NULL) {
        return STATUS_OK;
    }
    if (kind == GROUP_FACETS) {
        RETURN_IF_ERROR(stream_view(stream, "facets", &facets, error));
        groups->node = facets->data;
    }
    RETURN_IF_ERROR(stream_view(stream, group_sections[kind], &section, error));
    RETURN_IF_ERROR(names_of(section, "names", &groups->names, error));
    if (kind == GROUP_NODES) {
        return view_sets(stream, groups, error);
    }
    groups->count = section->rows;
    groups->group = section->data;
    return section_check_indices(section, 0, groups->names.count, kind == GROUP_FACETS ? "group" : "region",
                                 " in names=", error);
}

enum status stream_put_groups(struct stream *stream, enum group_kind kind, const struct names *names,
                              int64_t count, int32_t **node, int32_t **group, struct error *error)
{
    const char *section = group_sections[kind], *items = kind == GROUP_FACETS ? "facets" : "sets.idx";
    if (kind == GROUP_REGION) {
        return stream_put_named(stream, section, TYPE_I4, count, names, array_take(group), true, error);
    }
    if (names->count == 0 || (kind == GROUP_FACETS && count == 0)) {
        stream_remove(stream, section);
        stream_remove(stream, items);
        return STATUS_OK;
    }
    if (kind == GROUP_FACETS) {
        RETURN_IF_ERROR(stream_put(stream, items, TYPE_I4, count, stream_dimension(stream), "",
                                   array_take(node), true, error));
        return stream_put_named(stream, section, TYPE_I4, count, names, array_take(group), true, error);
    }
    NEW_SCRATCH(int64_t, ptr, names->count + 1, error);
    for (int64_t i = 0; i < count; i++) {
        ptr[(*group)[i] + 1] = i + 1;
    }
    for (int64_t g = 0; g < names->count; g++) {
        ptr[g + 1] = ptr[g + 1] > ptr[g] ? ptr[g + 1] : ptr[g];
    }
    RETURN_IF_ERROR(
        stream_put_named(stream, section, TYPE_I8, names->count + 1, names, array_take(&ptr), true, error));
    return stream_put(stream, items, TYPE_I4, count, 1, "", array_take(node), true, error);
}

/* The edges of faces, in 3D of smoothed cells only and in the order of their first use. */
static enum status view_edges(const struct stream *stream, struct faces *faces, struct error *error)
{
    const struct section *edge, *points = stream_find(stream, "points.x");
    if (points == NULL || !points_are_smoothed(points)) {
        return STATUS_OK;
    }
    if (faces->dim == 2) {
        faces->edge_count = faces->count;
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, "faces.edge", &edge, error));
    faces->edge = edge->data;
    for (int64_t i = 0; i < faces->count * 3; i++) {
        if (faces->edge[i] < 0 || faces->edge[i] > faces->edge_count) {
            return fail(error, STATUS_INPUT,
                        "faces.edge: row %jd: not the edges of this face: run ipoints again", (i / 3));
        }
        faces->edge_count += faces->edge[i] == faces->edge_count;
    }
    NEW_SCRATCH(int32_t, ends, faces->edge_count * 2, error);
    return face_edges_ends(faces, ends, error);
}

enum status stream_faces(const struct stream *stream, struct faces *faces, struct error *error)
{
    const struct section *node, *cell;
    RETURN_IF_ERROR(stream_view(stream, "faces", &node, error));
    RETURN_IF_ERROR(stream_view(stream, "faces.cell", &cell, error));
    *faces =
        (struct faces){.dim = (int)node->cols, .count = node->rows, .node = node->data, .cell = cell->data};
    for (int64_t f = 0; f < faces->count; f++) {
        if (faces->cell[2 * f] < 0) {
            return fail(error, STATUS_INPUT, "faces.cell: row %jd: no cell -1", f);
        }
        if (faces->cell[2 * f + 1] < 0 && faces->boundary_count++ < f) {
            return fail(error, STATUS_INPUT,
                        "faces.cell: row %jd: on the boundary, after faces between cells: run ipoints again",
                        f);
        }
    }
    return view_edges(stream, faces, error);
}

bool points_are_smoothed(const struct section *points)
{
    char rule[32];
    return section_attribute(points, "rule", rule, sizeof rule) && strcmp(rule, "conforming") == 0;
}

/* *section: PREFIX.WHAT of lists; NULL if it does not exist and is not needed, or is none of these lists. */
static enum status view_member(const struct stream *stream, const char *prefix, const char *what, bool needed,
                               const struct section **section, struct error *error)
{
    char name[64];
    snprintf(name, sizeof name, "%s.%s", prefix, what);
    *section = NULL;
    return !needed && (stream_find(stream, name) == NULL || section_kind_of(name) == NULL)
               ? STATUS_OK
               : stream_view(stream, name, section, error);
}

enum status stream_neighbours(const struct stream *stream, const char *prefix, int64_t rows,
                              struct neighbours *lists, struct error *error)
{
    const struct section *ptr, *idx, *widen = NULL, *side = NULL;
    RETURN_IF_ERROR(view_member(stream, prefix, "ptr", true, &ptr, error));
    RETURN_IF_ERROR(view_member(stream, prefix, "idx", true, &idx, error));
    RETURN_IF_ERROR(view_member(stream, prefix, "widen", false, &widen, error));
    RETURN_IF_ERROR(view_member(stream, prefix, "side", false, &side, error));
    *lists = (struct neighbours){
        .count = rows, .ptr = ptr->data, .idx = idx->data, .side = side != NULL ? side->data : NULL};
    if (ptr->rows != rows + 1 || lists->ptr[0] != 0 || lists->ptr[rows] != idx->rows) {
        return fail(error, STATUS_INPUT, "%s.ptr: does not fit its lists and %s.idx: run %s again", prefix,
                    prefix, section_producer(section_kind_of(ptr->name)));
    }
    for (int64_t p = 0; p < rows; p++) {
        if (lists->ptr[p + 1] < lists->ptr[p]) {
            return fail(error, STATUS_INPUT, "%s.ptr: row %jd: decreases", prefix, p + 1);
        }
    }
    for (int64_t p = 0; p < rows; p++) {
        for (int64_t i = lists->ptr[p] + 1; i < lists->ptr[p + 1]; i++) {
            if (lists->idx[i] <= lists->idx[i - 1]) {
                return fail(error, STATUS_INPUT, "%s.idx: row %jd: %d does not ascend to %d", prefix, i,
                            lists->idx[i - 1], lists->idx[i]);
            }
        }
    }
    lists->widen = widen != NULL ? widen->data : NULL;
    return STATUS_OK;
}

/* Rows of node, side, R, A. */
static enum status check_sides(const struct section *sides, int64_t nodes, struct error *error)
{
    const double *row = sides->data, *before = NULL;
    for (int64_t i = 0; i < sides->rows; i++, before = row, row += sides->cols) {
        bool ascends = before == NULL || compare_sides(before, row) < 0;
        if (!(row[0] >= 0.0 && row[0] < (double)nodes && row[0] == floor(row[0]) && row[2] > 0.0 &&
              ascends)) {
            return fail(error, STATUS_INPUT,
                        "%s: row %jd: not a node, a side and a radius that ascend: run support again",
                        sides->name, i);
        }
    }
    return STATUS_OK;
}

enum status stream_supports(const struct stream *stream, const char *prefix, struct supports *supports,
                            struct error *error)
{
    const struct section *radius, *stretch, *sides;
    char value[16];
    RETURN_IF_ERROR(view_member(stream, prefix, "radius", true, &radius, error));
    bool needed = section_attribute(radius, "stretch", value, sizeof value);
    RETURN_IF_ERROR(view_member(stream, prefix, "stretch", needed, &stretch, error));
    needed = section_attribute(radius, "sides", value, sizeof value);
    RETURN_IF_ERROR(view_member(stream, prefix, "sides", needed, &sides, error));
    *supports = (struct supports){radius->data, stretch != NULL ? stretch->data : NULL,
                                  sides != NULL ? sides->rows : 0, sides != NULL ? sides->data : NULL};
    return sides != NULL ? check_sides(sides, radius->rows, error) : STATUS_OK;
}

enum status stream_put_copy(struct stream *stream, const char *name, enum element_type type, int64_t rows,
                            int64_t cols, const char *attributes, const void *data, struct error *error)
{
    size_t bytes = element_size(type) * (size_t)cols;
    void *copy = array_new(rows, bytes);
    if (copy == NULL) {
        return fail_memory(error, name);
    }
    if (rows > 0) {
        memcpy(copy, data, (size_t)rows * bytes);
    }
    return stream_put(stream, name, type, rows, cols, attributes, copy, true, error);
}

const char *vector_attributes(int dim, const char *unit, char text[64])
{
    snprintf(text, 64, "unit=%s cols=%s", unit, dim == 2 ? "x,y" : "x,y,z");
    return text;
}

void groups_free(struct groups *groups)
{
    names_free(&groups->names);
    free(groups->owned);
}
