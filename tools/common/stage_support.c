#include "stages.h"

#include "mls_options.h"

#include "approx/face_rows.h"
#include "approx/support_space.h"
#include "io/sections.h"

#include <stdlib.h>
#include <string.h>

enum { DESCRIPTION = 960 }; /* bytes of the attributes */

/* Radii by the local spacing: from the cells where there are any, else from the nearest nodes. */
static enum status local_radii(const struct stream *stream, const struct support_options *options,
                               int64_t node_count, const double *x, double *radius, struct error *error)
{
    enum status status;
    struct cells cells;
    double *spacing = NULL;
    TRY(NEW_ARRAY(&spacing, node_count, error));
    TRY(stream_cells(stream, false, &cells, error));
    if (cells.count > 0) {
        TRY(cells_node_spacing(&cells, spacing, error));
    } else {
        TRY(nodes_spacing(options->mls.dim, node_count, x, spacing, error));
    }
    TRY(support_radii(options, node_count, spacing, radius, error));
done:
    free(spacing);
    return status;
}

enum status stage_radii(const struct stream *stream, const struct support_options *options,
                        int64_t node_count, const double *x, double *radius, struct error *error)
{
    return options->radius > 0.0 ? support_radii(options, node_count, NULL, radius, error)
                                 : local_radii(stream, options, node_count, x, radius, error);
}

/* Attributes that record the settings; those that are seldom given only where they are. */
static void describe(const struct recorded *recorded, char text[DESCRIPTION])
{
    const struct support_options *options = &recorded->support;
    const struct support_options usual = support_defaults(options->mls.dim);
    char mls[DESCRIPTION / 3], shapes[DESCRIPTION / 3], lists[DESCRIPTION / 6] = "";
    mls_describe(&options->mls, "", mls, sizeof mls);
    mls_describe(&recorded->shapes, "", shapes, sizeof shapes);
    bool same = strcmp(mls, shapes) == 0;
    mls_describe(&recorded->shapes, " shape_", shapes, sizeof shapes);
    if (options->least != usual.least || options->most != usual.most || options->widen != usual.widen ||
        options->gradient_bound != usual.gradient_bound) {
        snprintf(lists, sizeof lists, " least=%lld most=%lld widen=%d bound=%.17g", (long long)options->least,
                 (long long)options->most, options->widen, options->gradient_bound);
    }
    snprintf(text, DESCRIPTION, "unit=m reach=%s %s%s%s", reach_names[options->reach], mls, lists,
             same ? "" : shapes);
}

/* The value of one attribute into a whole number, unless it is absent. */
static enum status read_count(const struct section *section, const char *key, int64_t *count,
                              struct error *error)
{
    char value[64], what[96];
    snprintf(what, sizeof what, "%s: %s", section->name, key);
    return section_attribute(section, key, value, sizeof value)
               ? parse_integer(value, what, 0, 1000000, count, error)
               : STATUS_OK;
}

/* The shape functions' settings, in attributes that begin with a prefix, as options of a command line say
 * them. */
static enum status read_mls(const struct section *section, const char *prefix, struct mls *mls,
                            struct error *error)
{
    static const char *const keys[] = {"basis", "weight", "mu", "mu_absolute"};
    char value[4][256], key[32];
    struct error own;
    bool is_told[4];
    for (int k = 0; k < 4; k++) {
        snprintf(key, sizeof key, "%s%s", prefix, keys[k]);
        is_told[k] = section_attribute(section, key, value[k], sizeof value[k]);
    }
    const struct mls_texts texts = {.basis = is_told[0] ? value[0] : NULL,
                                    .weight = is_told[1] ? value[1] : NULL,
                                    .mu = is_told[2] ? value[2] : NULL};
    enum status status = mls_apply(&texts, mls, &own);
    mls->mu_absolute = is_told[3] ? strcmp(value[3], "0") != 0 : mls->mu_absolute;
    return status == STATUS_OK ? status : fail(error, status, "%s: %s", section->name, own.text);
}

enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                        struct error *error)
{
    char name[64];
    struct cells cells;
    const struct section *section;
    snprintf(name, sizeof name, "%s.side", prefix);
    *side = NULL;
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    enum status status = stream_need(stream, name, TYPE_I4, 1, "support", &section, error);
    if (status == STATUS_OK) {
        status = stream_cells(stream, true, &cells, error);
    }
    if (status != STATUS_OK) {
        return status;
    }
    *side = section->data;
    for (int64_t c = 0; c < section->rows; c++) {
        if ((*side)[c] < 0 || (*side)[c] >= cells.count) {
            return fail(error, STATUS_INPUT, "%s: row %lld: no side %d", name, (long long)c, (*side)[c]);
        }
    }
    return section->rows == cells.count
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "%s: %lld rows for %lld cells: run support again", name,
                      (long long)section->rows, (long long)cells.count);
}

enum status stage_recorded(const struct stream *stream, const char *prefix, int dim,
                           struct recorded *recorded, struct error *error)
{
    enum status status = STATUS_OK;
    char name[64];
    snprintf(name, sizeof name, "%s.radius", prefix);
    const struct section *radius = stream_find(stream, name);
    struct support_options *options = &recorded->support;
    char value[64], what[96];
    int choice = REACH_CELLS;
    int64_t widen = 1;
    *options = support_defaults(dim);
    recorded->shapes = options->mls;
    if (radius == NULL) {
        return STATUS_OK;
    }
    TRY(stage_sides(stream, prefix, &options->side, error));
    TRY(read_mls(radius, "", &options->mls, error));
    recorded->shapes = options->mls;
    TRY(read_mls(radius, "shape_", &recorded->shapes, error));
    snprintf(what, sizeof what, "%s: reach", radius->name);
    if (section_attribute(radius, "reach", value, sizeof value)) {
        TRY(parse_choice(value, what, reach_names, REACH_RULE_COUNT, &choice, error));
        options->reach = (enum reach_rule)choice;
    }
    TRY(read_count(radius, "least", &options->least, error));
    TRY(read_count(radius, "most", &options->most, error));
    TRY(read_count(radius, "widen", &widen, error));
    options->widen = widen != 0;
    snprintf(what, sizeof what, "%s: bound", radius->name);
    if (section_attribute(radius, "bound", value, sizeof value)) {
        TRY(parse_double(value, what, 1.0, 1e6, &options->gradient_bound, error));
    }
done:
    return status;
}

enum status stage_record(struct stream *stream, const struct recorded *recorded, int64_t node_count,
                         double *radius, struct error *error)
{
    char described[DESCRIPTION];
    describe(recorded, described);
    return stream_put(stream, "support.radius", TYPE_F8, node_count, 1, described, radius, true, error);
}

/* Radii of the nodes, put into the stream with the settings they were made for. */
static enum status put_radii(struct stream *stream, const struct support_options *options, int64_t node_count,
                             const double *x, struct error *error)
{
    enum status status;
    double *radius = NULL;
    TRY(NEW_ARRAY(&radius, node_count, error));
    TRY(stage_radii(stream, options, node_count, x, radius, error));
    return stage_record(stream, &(struct recorded){*options, options->mls}, node_count, radius, error);
done:
    free(radius);
    return status;
}

static enum status put_sides(struct stream *stream, const struct cells *cells, const int32_t *side,
                             struct error *error)
{
    enum status status;
    int32_t *copy = NULL;
    if (side == NULL) {
        return STATUS_OK;
    }
    TRY(NEW_ARRAY(&copy, cells->count, error));
    memcpy(copy, side, (size_t)cells->count * sizeof *copy);
    return stream_put(stream, "support.side", TYPE_I4, cells->count, 1, "", copy, true, error);
done:
    return status;
}

/* Sections PREFIX.around and .image of the neighbours that are seen around corners; the stream takes them. */
static enum status put_around(struct stream *stream, int dim, const char *prefix, struct support_lists *lists,
                              struct error *error)
{
    char name[64], vector[64];
    snprintf(name, sizeof name, "%s.around", prefix);
    enum status status =
        stream_put(stream, name, TYPE_I8, lists->around_count, 1, "", lists->around_pair, true, error);
    snprintf(name, sizeof name, "%s.image", prefix);
    enum status next = stream_put(stream, name, TYPE_F8, lists->around_count, dim,
                                  vector_attributes(dim, "m", vector), lists->around_offset, true, error);
    lists->around_pair = NULL;
    lists->around_offset = NULL;
    return status != STATUS_OK ? status : next;
}

/* Points of one section, in those cells: lists PREFIX.ptr, .idx, .widen, and what the report calls them. */
struct listed {
    const struct section *points;
    struct reach_places places;
    const char *prefix, *called;
};

static enum status put_lists(struct stream *stream, const struct support_options *options,
                             const struct support_space *space, const struct listed *listed,
                             struct support_report *report, struct error *error)
{
    const struct section *points = listed->points;
    const char *prefix = listed->prefix;
    enum status status, next;
    struct support_lists lists = {0};
    char name[64];
    int64_t count = points->rows;
    TRY(support_space_lists(options, space, &listed->places, count, points->data, points->name, &lists,
                            error));
    int64_t pairs = lists.ptr[count];
    int entry = report->lists++;
    report->list[entry].what = listed->called;
    report->list[entry].points = count;
    report->list[entry].pairs = pairs;
    report->list[entry].fewest = lists.fewest;
    report->list[entry].most = lists.most;
    report->list[entry].widened = lists.widened;
    report->list[entry].widest = lists.widest;
    report->list[entry].around = lists.around_count;
    snprintf(name, sizeof name, "%s.ptr", prefix);
    status = stream_put(stream, name, TYPE_I8, count + 1, 1, "", lists.ptr, true, error);
    snprintf(name, sizeof name, "%s.idx", prefix);
    next = stream_put(stream, name, TYPE_I4, pairs, 1, "", lists.idx, true, error);
    status = status != STATUS_OK ? status : next;
    snprintf(name, sizeof name, "%s.widen", prefix);
    next = stream_put(stream, name, TYPE_F8, count, 1, "", lists.widen, true, error);
    status = status != STATUS_OK ? status : next;
    lists.ptr = NULL;
    lists.idx = NULL;
    lists.widen = NULL;
    if (status == STATUS_OK && lists.around_count > 0) {
        status = put_around(stream, (int)points->cols, prefix, &lists, error);
    }
done:
    support_free(&lists);
    return status;
}

/* The cells of the integration points; to be found by place where there is no such section. */
static enum status places_of_points(const struct stream *stream, const struct cells *cells, int64_t points,
                                    struct reach_places *places, struct error *error)
{
    enum status status = STATUS_OK;
    const struct section *section = stream_find(stream, "points.cell");
    *places = (struct reach_places){0};
    if (section == NULL) {
        return STATUS_OK;
    }
    TRY(stream_need(stream, "points.cell", TYPE_I4, 1, "ipoints", &section, error));
    if (section->rows != points) {
        return fail(error, STATUS_INPUT, "points.cell: %lld rows for %lld points: run ipoints again",
                    (long long)section->rows, (long long)points);
    }
    const int32_t *cell = section->data;
    for (int64_t i = 0; i < points; i++) {
        if (cell[i] < -1 || (cells->count > 0 && cell[i] >= cells->count)) {
            return fail(error, STATUS_INPUT, "points.cell: row %lld: no cell %d", (long long)i, cell[i]);
        }
    }
    *places = (struct reach_places){.cell = cell, .points_per_row = 1};
done:
    return status;
}

/* The cells at the points of faces, in arrays of the caller's; to be found by place where faces.cell is not
 * there. */
static enum status places_of_face_points(const struct stream *stream, const struct cells *cells,
                                         int64_t points, int64_t **ptr, int32_t **cell,
                                         struct reach_places *places, struct error *error)
{
    enum status status = STATUS_OK;
    struct faces faces;
    *places = (struct reach_places){0};
    if (cells->count == 0 || stream_find(stream, "faces.cell") == NULL) {
        return STATUS_OK;
    }
    TRY(stream_faces(stream, cells, &faces, error));
    if (face_row_point(&faces, faces.row_count) != points) {
        status = fail(error, STATUS_INPUT, "facepoints.x: does not fit faces.row: run ipoints again");
        goto done;
    }
    TRY(face_rows_cells(cells->node_count, &faces, ptr, cell, error));
    *places = (struct reach_places){
        .ptr = *ptr, .cell = *cell, .points_per_row = OWN_POINTS(cells->dim), .long_rows = faces.own_count};
done:
    return status;
}

/* The rows of faces, and their points, as the sides have them. */
static enum status renew_rows(struct stream *stream, const struct cells *cells, const int32_t *side,
                              struct error *error)
{
    enum status status;
    struct faces faces;
    int32_t *row = NULL;
    double *x = NULL;
    char attributes[64];
    int dim = cells->dim;
    TRY(stream_faces(stream, cells, &faces, error));
    if (!faces_may_share(&faces)) {
        return STATUS_OK;
    }
    TRY(face_rows_number(cells->node_count, side, &faces, error));
    row = faces.row;
    int64_t points = face_row_point(&faces, faces.row_count);
    TRY(NEW_ARRAY(&x, points * dim, error));
    face_rows_points(&faces, cells->x, x);
    status = stream_put(stream, "faces.row", TYPE_I4, faces.count, dim, "", row, true, error);
    row = NULL;
    TRY(status);
    status = stream_put(stream, "facepoints.x", TYPE_F8, points, dim, vector_attributes(dim, "m", attributes),
                        x, true, error);
    x = NULL;
done:
    free(row);
    free(x);
    return status;
}

enum status stage_support(struct stream *stream, const struct support_options *options,
                          struct support_report *report, struct error *error)
{
    enum status status;
    struct support_space space = {0};
    int dim;
    int64_t node_count;
    const double *x;
    const struct section *points, *facepoints;
    struct support_options actual = *options;
    struct cells cells;
    struct listed listed;
    int64_t *face_ptr = NULL;
    int32_t *face_cell = NULL;
    *report = (struct support_report){0};
    bool had_sides = stream_find(stream, "support.side") != NULL;
    sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
    TRY(stream_nodes(stream, &dim, &node_count, &x, error));
    TRY(stream_need(stream, "points.x", TYPE_F8, dim, "ipoints", &points, error));
    TRY(stream_cells(stream, false, &cells, error));
    if (cells.count == 0) {
        actual.reach = REACH_DISTANCE;
    }
    report->reach = actual.reach;
    TRY(put_radii(stream, &actual, node_count, x, error));
    TRY(put_sides(stream, &cells, actual.side, error));
    TRY(stage_own_part(stream, node_count, &actual, error));
    TRY(support_space_build(&actual, &cells, stream_find(stream, "support.radius")->data, &space, error));
    bool smoothed = points_are_smoothed(points); /* gradients come from the faces alone */
    if (!smoothed) {
        listed = (struct listed){.points = points, .prefix = "nbr", .called = "integration points"};
        TRY(places_of_points(stream, &cells, points->rows, &listed.places, error));
        TRY(put_lists(stream, &actual, &space, &listed, report, error));
    }
    if (stream_find(stream, "faces") != NULL || smoothed) {
        TRY(stream_need(stream, "facepoints.x", TYPE_F8, dim, "ipoints", &facepoints, error));
        if (had_sides || actual.side != NULL) {
            TRY(renew_rows(stream, &cells, actual.side, error));
            facepoints = stream_find(stream, "facepoints.x");
        }
        listed = (struct listed){.points = facepoints, .prefix = "facepoint", .called = "points on faces"};
        TRY(places_of_face_points(stream, &cells, facepoints->rows, &face_ptr, &face_cell, &listed.places,
                                  error));
        TRY(put_lists(stream, &actual, &space, &listed, report, error));
    }
    listed = (struct listed){.points = stream_find(stream, "nodes.x"),
                             .places = {.nodes = true},
                             .prefix = "node",
                             .called = "nodes"};
    TRY(put_lists(stream, &actual, &space, &listed, report, error));
done:
    free(face_ptr);
    free(face_cell);
    support_space_free(&space);
    return status;
}
