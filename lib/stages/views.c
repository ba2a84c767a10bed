#include "stages/views.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum status stream_nodes(const struct stream *stream, int *dim, int64_t *node_count, const double **x,
                         struct error *error)
{
    const struct section *nodes;
    RETURN_IF_ERROR(stream_need(stream, "nodes.x", TYPE_F8, 0, "nodes", &nodes, error));
    if ((nodes->cols != 2 && nodes->cols != 3) || nodes->rows < 1 || nodes->rows > INT32_MAX) {
        return fail(error, STATUS_INPUT,
                    "nodes.x: %lld rows of %lld columns: not a cloud in 2 or 3 dimensions",
                    (long long)nodes->rows, (long long)nodes->cols);
    }
    const double *place = nodes->data;
    *dim = (int)nodes->cols;
    if (node_count != NULL) {
        *node_count = nodes->rows;
        *x = place;
    }
    for (int64_t i = 0; i < nodes->rows * nodes->cols; i++) {
        if (!isfinite(place[i])) {
            return fail(error, STATUS_INPUT, "nodes.x: row %lld: not a finite coordinate",
                        (long long)(i / nodes->cols));
        }
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
    RETURN_IF_ERROR(stream_need(stream, "cells", TYPE_I4, cells->dim + 1, "nodes", &section, error));
    cells->count = section->rows;
    cells->node = section->data;
    return cells_check(cells, error);
}

enum status section_check_numbers(const struct section *section, bool positive, struct error *error)
{
    const double *values = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (!isfinite(values[i]) || (positive && !(values[i] > 0.0))) {
            return fail(error, STATUS_INPUT, "%s: row %lld: %g is not a %s", section->name,
                        (long long)(i / section->cols), values[i],
                        positive ? "positive length" : "finite coordinate");
        }
    }
    return STATUS_OK;
}

enum status stream_field(const struct stream *stream, const char *name, int64_t node_count,
                         const struct section **field, struct error *error)
{
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_F8, 0, "mtled", field, error));
    if ((*field)->cols > 3 || (*field)->rows != node_count) {
        return fail(error, STATUS_INPUT,
                    "%s: %lld rows of %lld columns: not a field of 1 to 3 columns on %lld nodes", name,
                    (long long)(*field)->rows, (long long)(*field)->cols, (long long)node_count);
    }
    return STATUS_OK;
}

/* Check that the numbers of a section are within [0, bound). `what` and `where` name them in messages. */
static enum status check_numbers(const struct section *section, const char *what, const char *where,
                                 int64_t bound, struct error *error)
{
    const int32_t *number = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (number[i] < 0 || number[i] >= bound) {
            return fail(error, STATUS_INPUT, "%s: row %lld: no %s %d%s", section->name,
                        (long long)(i / section->cols), what, number[i], where);
        }
    }
    return STATUS_OK;
}

enum status stream_regions(const struct stream *stream, const struct cells *cells,
                           struct cell_regions *regions, struct error *error)
{
    const struct section *section;
    *regions = (struct cell_regions){0};
    RETURN_IF_ERROR(stream_need(stream, "cells.region", TYPE_I4, 1, "nodes", &section, error));
    if (section->rows != cells->count) {
        return fail(error, STATUS_INPUT, "cells.region: has %lld rows, cells %lld: does not fit",
                    (long long)section->rows, (long long)cells->count);
    }
    RETURN_IF_ERROR(names_of(section, "names", &regions->names, error));
    regions->of_cell = section->data;
    return check_numbers(section, "region", " in names=", regions->names.count, error);
}

enum status stream_facets(const struct stream *stream, bool needed, const struct cells *cells,
                          struct named_facets *facets, struct error *error)
{
    const struct section *facet, *group;
    *facets = (struct named_facets){0};
    if (!needed && stream_find(stream, "facets") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_need(stream, "facets", TYPE_I4, cells->dim, "nodes", &facet, error));
    RETURN_IF_ERROR(stream_need(stream, "facets.set", TYPE_I4, 1, "nodes", &group, error));
    if (group->rows != facet->rows) {
        return fail(error, STATUS_INPUT, "facets.set: does not fit facets");
    }
    RETURN_IF_ERROR(check_numbers(facet, "node", "", cells->node_count, error));
    RETURN_IF_ERROR(names_of(group, "names", &facets->names, error));
    RETURN_IF_ERROR(check_numbers(group, "group", " in names=", facets->names.count, error));
    facets->count = facet->rows;
    facets->facet = facet->data;
    facets->group = group->data;
    return STATUS_OK;
}

enum status stream_sets(const struct stream *stream, bool needed, int64_t node_count, struct named_sets *sets,
                        struct error *error)
{
    const struct section *ptr;
    *sets = (struct named_sets){0};
    if (!needed && stream_find(stream, "sets.ptr") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_need(stream, "sets.ptr", TYPE_I8, 1, "nodes", &ptr, error));
    RETURN_IF_ERROR(names_of(ptr, "names", &sets->names, error));
    return stream_neighbours(stream, "sets", sets->names.count, node_count, &sets->lists, error);
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
    RETURN_IF_ERROR(stream_need(stream, "faces.edge", TYPE_I4, 3, "ipoints", &edge, error));
    if (edge->rows != faces->count) {
        return fail(error, STATUS_INPUT, "faces.edge: does not fit faces: run ipoints again");
    }
    faces->edge = edge->data;
    for (int64_t i = 0; i < faces->count * 3; i++) {
        if (faces->edge[i] < 0 || faces->edge[i] > faces->edge_count) {
            return fail(error, STATUS_INPUT,
                        "faces.edge: row %lld: not the edges of this face: run ipoints again",
                        (long long)(i / 3));
        }
        faces->edge_count += faces->edge[i] == faces->edge_count;
    }
    SCRATCH int32_t *ends = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&ends, faces->edge_count * 2, error));
    return face_edges_ends(faces, ends, error);
}

enum status stream_faces(const struct stream *stream, const struct cells *cells, struct faces *faces,
                         struct error *error)
{
    const struct section *node, *cell;
    RETURN_IF_ERROR(stream_need(stream, "faces", TYPE_I4, cells->dim, "ipoints", &node, error));
    RETURN_IF_ERROR(stream_need(stream, "faces.cell", TYPE_I4, 2, "ipoints", &cell, error));
    *faces = (struct faces){.dim = cells->dim, .count = node->rows, .node = node->data, .cell = cell->data};
    if (cell->rows != faces->count) {
        return fail(error, STATUS_INPUT, "faces.cell: does not fit faces: run ipoints again");
    }
    RETURN_IF_ERROR(check_numbers(node, "node", "", cells->node_count, error));
    for (int64_t f = 0; f < faces->count; f++) {
        for (int k = 0; k < 2; k++) {
            int32_t at = faces->cell[2 * f + k];
            if (at < -k || at >= cells->count) {
                return fail(error, STATUS_INPUT, "faces.cell: row %lld: no cell %d", (long long)f, at);
            }
        }
        if (faces->cell[2 * f + 1] < 0 && faces->boundary_count++ < f) {
            return fail(error, STATUS_INPUT,
                        "faces.cell: row %lld: on the boundary, after faces between cells: run ipoints again",
                        (long long)f);
        }
    }
    return view_edges(stream, faces, error);
}

bool points_are_smoothed(const struct section *points)
{
    char rule[32];
    return section_attribute(points, "rule", rule, sizeof rule) && strcmp(rule, "conforming") == 0;
}

/* The sections PREFIX.around and .image, if they exist, of lists with `pairs` entries. */
static enum status view_around(const struct stream *stream, const char *prefix, int64_t pairs,
                               struct around *around, struct error *error)
{
    char name[64];
    int dim;
    const struct section *pair, *image;
    *around = (struct around){0};
    snprintf(name, sizeof name, "%s.around", prefix);
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_nodes(stream, &dim, NULL, NULL, error));
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_I8, 1, "support", &pair, error));
    snprintf(name, sizeof name, "%s.image", prefix);
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_F8, dim, "support", &image, error));
    *around = (struct around){.count = pair->rows, .pair = pair->data, .offset = image->data};
    if (image->rows != pair->rows) {
        return fail(error, STATUS_INPUT, "%s: does not fit %s.around: run support again", name, prefix);
    }
    for (int64_t i = 0; i < pair->rows; i++) {
        if (around->pair[i] < (i > 0 ? around->pair[i - 1] + 1 : 0) || around->pair[i] >= pairs) {
            return fail(error, STATUS_INPUT, "%s.around: row %lld: no neighbour %lld, or not ascending",
                        prefix, (long long)i, (long long)around->pair[i]);
        }
    }
    for (int64_t i = 0; i < image->rows * dim; i++) {
        if (!isfinite(around->offset[i])) {
            return fail(error, STATUS_INPUT, "%s: row %lld: not a finite offset", name, (long long)(i / dim));
        }
    }
    return STATUS_OK;
}

enum status stream_neighbours(const struct stream *stream, const char *prefix, int64_t rows, int64_t columns,
                              struct neighbours *lists, struct error *error)
{
    char name[64];
    const struct section *ptr, *idx, *widen;
    snprintf(name, sizeof name, "%s.ptr", prefix);
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_I8, 1, "support", &ptr, error));
    snprintf(name, sizeof name, "%s.idx", prefix);
    RETURN_IF_ERROR(stream_need(stream, name, TYPE_I4, 1, "support", &idx, error));
    snprintf(name, sizeof name, "%s.widen", prefix);
    widen = stream_find(stream, name);
    *lists = (struct neighbours){.count = rows, .ptr = ptr->data, .idx = idx->data};
    if (widen != NULL && widen->type == TYPE_F8 && widen->rows == rows) {
        lists->widen = widen->data;
    }
    if (ptr->rows != rows + 1 || lists->ptr[0] != 0 || lists->ptr[rows] != idx->rows) {
        return fail(error, STATUS_INPUT, "%s.ptr: does not fit its lists and %s.idx: run %s again", prefix,
                    prefix, strcmp(prefix, "sets") == 0 ? "nodes" : "support");
    }
    for (int64_t p = 0; p < rows; p++) {
        if (lists->ptr[p + 1] < lists->ptr[p]) {
            return fail(error, STATUS_INPUT, "%s.ptr: row %lld: decreases", prefix, (long long)p + 1);
        }
    }
    RETURN_IF_ERROR(check_numbers(idx, "node", "", columns, error));
    for (int64_t p = 0; p < rows; p++) {
        for (int64_t i = lists->ptr[p] + 1; i < lists->ptr[p + 1]; i++) {
            if (lists->idx[i] <= lists->idx[i - 1]) {
                return fail(error, STATUS_INPUT, "%s.idx: row %lld: %d does not ascend to %d", prefix,
                            (long long)i, lists->idx[i - 1], lists->idx[i]);
            }
        }
    }
    return view_around(stream, prefix, idx->rows, &lists->around, error);
}

enum status stream_put_member(struct stream *stream, const char *prefix, const char *name,
                              enum element_type type, int64_t rows, int64_t cols, const char *attributes,
                              void *array, struct error *error)
{
    char full[64];
    snprintf(full, sizeof full, "%s.%s", prefix, name);
    return stream_put(stream, full, type, rows, cols, attributes, array_take(array), true, error);
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

void stream_inherit(struct stream *stream, struct stream *from)
{
    stream->provenance = array_take(&from->provenance);
    stream->provenance_count = from->provenance_count;
    from->provenance_count = 0;
}

const char *vector_attributes(int dim, const char *unit, char text[64])
{
    snprintf(text, 64, "unit=%s cols=%s", unit, dim == 2 ? "x,y" : "x,y,z");
    return text;
}

void cell_regions_free(struct cell_regions *regions)
{
    names_free(&regions->names);
}

void named_facets_free(struct named_facets *facets)
{
    names_free(&facets->names);
}

void named_sets_free(struct named_sets *sets)
{
    names_free(&sets->names);
}
