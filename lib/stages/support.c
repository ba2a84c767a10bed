#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "approx/support/support.h"
#include "base/memory.h"
#include "io/stream/sections.h"

#include <stdio.h>
#include <string.h>

enum status stage_sizes(const struct stream *stream, const struct support_options *options,
                        int64_t node_count, const double *x, struct supports *sizes, struct error *error)
{
    struct cells cells;
    RETURN_IF_ERROR(stream_cells(stream, false, &cells, error));
    if (cells.count > 0) {
        return support_sizes(options, &cells, sizes, error);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&sizes->radius, node_count, error));
    RETURN_IF_ERROR(options->radius > 0.0
                        ? STATUS_OK
                        : nodes_spacing(options->mls.dim, node_count, x, sizes->radius, error));
    return support_radii(options, node_count, sizes->radius, sizes->radius, error);
}

/* Put a section PREFIX.NAME. The stream takes the array *array, which becomes NULL, also on failure. */
static enum status put_member(struct stream *stream, const char *prefix, const char *name,
                              enum element_type type, int64_t rows, void *array, struct error *error)
{
    char full[64];
    snprintf(full, sizeof full, "%s.%s", prefix, name);
    return stream_put(stream, full, type, rows, 1, "", array_take(array), true, error);
}

/* Put the lists PREFIX.ptr, .idx, .widen of points in these cells, which the report calls `called`. */
static enum status put_lists(struct stream *stream, const struct support_options *options,
                             const struct visibility *space, const struct section *points,
                             const struct visibility_places *places, const char *prefix, const char *called,
                             struct support_report *report, struct error *error)
{
    FREED_BY(support_free) struct neighbours lists = {0};
    int64_t count = points->rows;
    RETURN_IF_ERROR(support_build(options, space, places, count, points->data, points->name, &lists, error));
    int64_t pairs = lists.ptr[count];
    struct list_report *told = &report->list[report->lists++];
    *told = (struct list_report){.what = called, .pairs = pairs, .lists = lists};
    if (lists.steep.count > 0) {
        point_text((int)points->cols, (const double *)points->data + lists.steep.point * points->cols,
                   told->steepest);
    }
    RETURN_IF_ERROR(put_member(stream, prefix, "ptr", TYPE_I8, count + 1, &lists.ptr, error));
    RETURN_IF_ERROR(put_member(stream, prefix, "idx", TYPE_I4, pairs, &lists.idx, error));
    RETURN_IF_ERROR(lists.side != NULL
                        ? put_member(stream, prefix, "side", TYPE_I4, count, &lists.side, error)
                        : STATUS_OK);
    return put_member(stream, prefix, "widen", TYPE_F8, count, &lists.widen, error);
}

/* The cells at the points of faces, in (*ptr)[] and (*cell)[], to be freed; they are searched for if there is
 * no faces.cell. */
static enum status places_of_face_points(const struct stream *stream, const struct cells *cells,
                                         int64_t points, int64_t **ptr, int32_t **cell,
                                         struct visibility_places *places, struct error *error)
{
    struct faces faces;
    *places = (struct visibility_places){0};
    if (cells->count == 0 || stream_find(stream, "faces.cell") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_faces(stream, &faces, error));
    if (face_point_count(&faces) != points) {
        return fail(error, STATUS_INPUT, "facepoints.x: does not fit faces: run ipoints again");
    }
    RETURN_IF_ERROR(face_points_cells(&faces, ptr, cell, error));
    *places = (struct visibility_places){.ptr = *ptr,
                                         .cell = *cell,
                                         .points_per_row = FACE_POINTS(cells->dim),
                                         .long_rows = faces.boundary_count};
    return STATUS_OK;
}

static enum status stage_lists(struct stream *stream, const struct support_options *options,
                               struct support_report *report, struct error *error)
{
    FREED_BY(visibility_free) struct visibility space = {0};
    const struct section *points, *cell;
    struct visibility_places places = {0};
    struct supports supports;
    struct cells cells;
    SCRATCH int64_t *face_ptr = NULL;
    SCRATCH int32_t *face_cell = NULL;
    *report = (struct support_report){.visibility = options->visibility};
    RETURN_IF_ERROR(stream_cells(stream, false, &cells, error));
    RETURN_IF_ERROR(stream_view(stream, "points.x", &points, error));
    const int32_t *side = options->side;
    RETURN_IF_ERROR(side == NULL
                        ? STATUS_OK
                        : stream_put_copy(stream, "support.side", TYPE_I4, cells.count, 1, "", side, error));
    RETURN_IF_ERROR(stream_supports(stream, "support", &supports, error));
    RETURN_IF_ERROR(visibility_build(&cells, supports, options->visibility, side, &space, error));
    bool smoothed = points_are_smoothed(points);                   /* gradients come from the faces alone */
    if (!smoothed && stream_find(stream, "points.cell") != NULL) { /* else cells are searched for */
        RETURN_IF_ERROR(stream_view(stream, "points.cell", &cell, error));
        places = (struct visibility_places){.cell = cell->data, .points_per_row = 1};
    }
    if (!smoothed) {
        RETURN_IF_ERROR(
            put_lists(stream, options, &space, points, &places, "nbr", "integration points", report, error));
    }
    if (stream_find(stream, "faces") != NULL || smoothed) {
        RETURN_IF_ERROR(stream_view(stream, "facepoints.x", &points, error));
        RETURN_IF_ERROR(
            places_of_face_points(stream, &cells, points->rows, &face_ptr, &face_cell, &places, error));
        RETURN_IF_ERROR(put_lists(stream, options, &space, points, &places, "facepoint", "points on faces",
                                  report, error));
    }
    places = (struct visibility_places){.nodes = true};
    return put_lists(stream, options, &space, stream_find(stream, "nodes.x"), &places, "node", "nodes",
                     report, error);
}

enum status stage_support(struct stream *stream, const struct support_options *options,
                          struct support_report *report, struct error *error)
{
    struct support_options actual = *options;
    struct cells cells;
    sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stream_cells(stream, false, &cells, error));
    if (cells.count == 0) {
        actual.visibility = VISIBILITY_DISTANCE;
    }
    FREED_BY(supports_free) struct supports sizes = {0};
    RETURN_IF_ERROR(stage_sizes(stream, &actual, cells.node_count, cells.x, &sizes, error));
    const struct field_shapes shapes = {sizes, actual, actual.mls};
    RETURN_IF_ERROR(stage_record(stream, &shapes, cells.node_count, error));
    return stage_lists(stream, &actual, report, error);
}

/* ---- sides of the interfaces at which supports stop ---- */

/* place[regions->count] = the place of each region in the list, from 1, or 0; *named: their number. */
static enum status read_list(const char *names, const struct names *regions, int32_t *place, int32_t *named,
                             struct error *error)
{
    SCRATCH char *list = strdup(names);
    char *rest = list;
    RETURN_IF_ERROR(list == NULL ? fail_memory(error, "regions") : STATUS_OK);
    for (char *name; (name = strsep(&rest, ",")) != NULL;) {
        int64_t region;
        RETURN_IF_ERROR(fail_in(error, names_need(regions, "region", name, &region, error), "--interface"));
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
    FREED_BY(groups_free) struct groups regions = {0};
    int32_t named = 0;
    *side = NULL;
    RETURN_IF_ERROR(stream_cells(stream, names != NULL, &cells, error));
    if (names == NULL && stream_find(stream, "cells.region") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_groups(stream, GROUP_REGION, true, &regions, error));
    if (names == NULL && regions.names.count < 2) {
        return STATUS_OK;
    }
    NEW_SCRATCH(int32_t, place, regions.names.count, error);
    if (names != NULL) {
        RETURN_IF_ERROR(read_list(names, &regions.names, place, &named, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(side, cells.count, error));
    for (int64_t c = 0; c < cells.count; c++) {
        int32_t region = regions.group[c];
        (*side)[c] = names == NULL ? region : place[region] > 0 ? place[region] - 1 : named;
    }
    return STATUS_OK;
}

enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                        struct error *error)
{
    char name[64];
    const struct section *section;
    snprintf(name, sizeof name, "%s.side", prefix);
    *side = NULL;
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, name, &section, error));
    *side = section->data;
    return STATUS_OK;
}

/* *copy = the values, to be freed; NULL of NULL. */
static enum status copy_values(double **copy, const double *values, int64_t count, struct error *error)
{
    if (values == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(copy, count, error));
    memcpy(*copy, values, (size_t)count * sizeof *values);
    return STATUS_OK;
}

/* A copy of the supports; those on interfaces as by support_sizes for these sides, and as wide as recorded.
 */
static enum status renew_sides(const struct cells *cells, const struct field_shapes *recorded,
                               const int32_t *side, struct supports *kept, struct error *error)
{
    FREED_BY(supports_free) struct supports fresh = {0};
    struct support_options options = recorded->support;
    const struct supports *supports = &recorded->supports;
    int dim = cells->dim;
    RETURN_IF_ERROR(copy_values(&kept->radius, supports->radius, cells->node_count, error));
    RETURN_IF_ERROR(copy_values(&kept->stretch, supports->stretch, cells->node_count * dim * dim, error));
    options.side = side;
    RETURN_IF_ERROR(support_sizes(&options, cells, &fresh, error));
    for (int64_t i = 0; i < fresh.side_count; i++) {
        double *row = fresh.sides + i * SIDE_COLUMNS(dim);
        row[2] *= kept->radius[(int64_t)row[0]] / fresh.radius[(int64_t)row[0]];
    }
    kept->side_count = fresh.side_count;
    kept->sides = array_take(&fresh.sides);
    return STATUS_OK;
}

enum status stage_renew(struct stream *stream, const int32_t *side, struct error *error)
{
    FREED_BY(supports_free) struct supports kept = {0};
    struct field_shapes recorded;
    struct support_report report;
    struct cells cells;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stage_recorded(stream, "support", &recorded, error));
    RETURN_IF_ERROR(renew_sides(&cells, &recorded, side, &kept, error));
    recorded.supports = kept;
    recorded.support.side = side;
    sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stage_face_points(stream, error));
    RETURN_IF_ERROR(stage_record(stream, &recorded, cells.node_count, error));
    RETURN_IF_ERROR(stage_lists(stream, &recorded.support, &report, error));
    return stage_shapefn(stream, &recorded.shapes, error);
}
