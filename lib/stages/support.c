#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "approx/support/support.h"
#include "base/memory.h"
#include "base/options.h"
#include "io/stream/sections.h"

#include <stdio.h>
#include <string.h>

enum status stage_radii(const struct stream *stream, const struct support_options *options,
                        int64_t node_count, const double *x, double *radius, double **stretch,
                        struct error *error)
{
    struct cells cells;
    *stretch = NULL;
    NEW_SCRATCH(double, spacing, node_count, error);
    RETURN_IF_ERROR(stream_cells(stream, false, &cells, error));
    if (options->radius <= 0.0) { /* the local spacing */
        RETURN_IF_ERROR(cells.count > 0 ? support_sizes(&cells, options->side, stretch, spacing, error)
                                        : nodes_spacing(options->mls.dim, node_count, x, spacing, error));
    }
    return support_radii(options, node_count, spacing, radius, error);
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
    SCRATCH double *stretch = NULL;
    NEW_SCRATCH(double, radius, cells.node_count, error);
    RETURN_IF_ERROR(stage_radii(stream, &actual, cells.node_count, cells.x, radius, &stretch, error));
    const struct field_shapes shapes = {{radius, stretch}, actual, actual.mls};
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

enum status stage_renew(struct stream *stream, const int32_t *side, struct error *error)
{
    struct field_shapes recorded;
    struct support_report report;
    struct cells cells;
    RETURN_IF_ERROR(stream_cells(stream, true, &cells, error));
    RETURN_IF_ERROR(stage_recorded(stream, "support", &recorded, error));
    int64_t count = cells.node_count, size = recorded.supports.stretch != NULL ? cells.dim * cells.dim : 0;
    NEW_SCRATCH(double, kept, count * (1 + size), error);
    for (int64_t i = 0; i < count * (1 + size); i++) {
        kept[i] = i < count ? recorded.supports.radius[i] : recorded.supports.stretch[i - count];
    }
    recorded.supports = (struct supports){kept, size > 0 ? kept + count : NULL};
    recorded.support.side = side;
    sections_remove(stream, MADE_WITH_SUPPORT, MADE_WITH_SHAPES);
    RETURN_IF_ERROR(stage_face_points(stream, error));
    RETURN_IF_ERROR(stage_record(stream, &recorded, cells.node_count, error));
    RETURN_IF_ERROR(stage_lists(stream, &recorded.support, &report, error));
    return stage_shapefn(stream, &recorded.shapes, error);
}

/* ---- settings as options of command lines, and as attributes of the section of radii ---- */

enum { DESCRIPTION = 960 }; /* bytes of the attributes */

static enum status apply_mu(const char *text, struct mls *mls, struct error *error)
{
    int count, wanted = mls_second_order_count(mls->dim);
    RETURN_IF_ERROR(parse_double_list(text, "--mu", 0.0, 1e300, MLS_MAX_SECOND, mls->mu, &count, error));
    bool fits = mls->dim == 0 ? count == 3 || count == 6 : count == wanted;
    if (count != 1 && !fits && mls->dim == 0) {
        return fail(error, STATUS_INPUT, "--mu: %d values; give one, or in 2D 3, in 3D 6", count);
    }
    if (count != 1 && !fits) {
        return fail(error, STATUS_INPUT, "--mu: %d values; in %dD give one, or %d", count, mls->dim, wanted);
    }
    for (int k = count; k < MLS_MAX_SECOND; k++) {
        mls->mu[k] = mls->mu[count - 1];
    }
    return STATUS_OK;
}

enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error)
{
    int choice;
    if (texts->basis != NULL) {
        RETURN_IF_ERROR(parse_choice(texts->basis, "-b", basis_names, BASIS_COUNT, &choice, error));
        mls->basis = (enum basis)choice;
    }
    if (texts->weight != NULL) {
        RETURN_IF_ERROR(parse_choice(texts->weight, "-w", weight_names, WEIGHT_COUNT, &choice, error));
        mls->weight = (enum weight_function)choice;
    }
    if (texts->mu != NULL) {
        mls->mu_absolute = false;
        RETURN_IF_ERROR(apply_mu(texts->mu, mls, error));
    }
    if (texts->mu_unit != NULL) {
        double unit;
        if (texts->mu == NULL) {
            return fail(error, STATUS_INPUT, "--mu-unit: needs --mu");
        }
        RETURN_IF_ERROR(parse_length_unit(texts->mu_unit, "--mu-unit", &unit, error));
        /* mu is used as mu / s^4 with s in this unit. */
        for (int k = 0; k < MLS_MAX_SECOND; k++) {
            mls->mu[k] *= unit * unit * unit * unit;
        }
        mls->mu_absolute = true;
    }
    return STATUS_OK;
}

/* text[size] = "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix. */
static void describe_mls(const struct mls *mls, const char *prefix, char *text, size_t size)
{
    snprintf(text, size, "%sbasis=%s %sweight=%s %smu_absolute=%d %smu=", prefix, basis_names[mls->basis],
             prefix, weight_names[mls->weight], prefix, mls->mu_absolute, prefix);
    for (int k = 0; k < mls_second_order_count(mls->dim); k++) {
        text_append(text, size, "%s%.17g", k > 0 ? "," : "", mls->mu[k]);
    }
}

/* The attributes that record the settings; rarely used ones only if they are set. */
static void describe(const struct field_shapes *recorded, char text[DESCRIPTION])
{
    const struct support_options *options = &recorded->support;
    const struct support_options usual = support_defaults(options->mls.dim);
    char mls[DESCRIPTION / 3], shapes[DESCRIPTION / 3], lists[DESCRIPTION / 6] = "";
    describe_mls(&options->mls, "", mls, sizeof mls);
    describe_mls(&recorded->shapes, "", shapes, sizeof shapes);
    bool same = strcmp(mls, shapes) == 0;
    describe_mls(&recorded->shapes, " shape_", shapes, sizeof shapes);
    if (options->least != usual.least || options->most != usual.most || options->widen != usual.widen ||
        options->gradient_bound != usual.gradient_bound) {
        snprintf(lists, sizeof lists, " least=%jd most=%jd widen=%d bound=%.17g", options->least,
                 options->most, options->widen, options->gradient_bound);
    }
    snprintf(text, DESCRIPTION, "unit=m reach=%s%s %s%s%s", visibility_names[options->visibility],
             recorded->supports.stretch != NULL ? " stretch=yes" : "", mls, lists, same ? "" : shapes);
}

/* The settings of shape functions, from attributes with this prefix. */
static enum status read_mls(const struct section *section, const char *prefix, struct mls *mls,
                            struct error *error)
{
    static const char *const keys[] = {"basis", "weight", "mu", "mu_absolute"};
    char value[4][256], key[32];
    struct error own;
    bool given[4];
    for (int k = 0; k < 4; k++) {
        snprintf(key, sizeof key, "%s%s", prefix, keys[k]);
        given[k] = section_attribute(section, key, value[k], sizeof value[k]);
    }
    const struct mls_texts texts = {.basis = given[0] ? value[0] : NULL,
                                    .weight = given[1] ? value[1] : NULL,
                                    .mu = given[2] ? value[2] : NULL};
    enum status status = mls_apply(&texts, mls, &own);
    mls->mu_absolute = given[3] ? strcmp(value[3], "0") != 0 : mls->mu_absolute;
    return status == STATUS_OK ? status : fail(error, status, "%s: %s", section->name, own.text);
}

enum status stage_recorded(const struct stream *stream, const char *prefix, struct field_shapes *recorded,
                           struct error *error)
{
    struct support_options *options = &recorded->support;
    char name[64], value[64];
    int dim, choice = VISIBILITY_CELLS;
    int64_t widen = 1;
    const struct section *radius;
    snprintf(name, sizeof name, "%s.radius", prefix);
    RETURN_IF_ERROR(stream_nodes(stream, &dim, NULL, NULL, error));
    *recorded = (struct field_shapes){.support = support_defaults(dim)};
    recorded->shapes = options->mls;
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, name, &radius, error));
    RETURN_IF_ERROR(stream_supports(stream, prefix, &recorded->supports, error));
    RETURN_IF_ERROR(stage_sides(stream, prefix, &options->side, error));
    RETURN_IF_ERROR(read_mls(radius, "", &options->mls, error));
    recorded->shapes = options->mls;
    RETURN_IF_ERROR(read_mls(radius, "shape_", &recorded->shapes, error));
    if (section_attribute(radius, "reach", value, sizeof value)) {
        RETURN_IF_ERROR(parse_choice(value, name, visibility_names, VISIBILITY_RULE_COUNT, &choice, error));
        options->visibility = (enum visibility_rule)choice;
    }
    const struct {
        const char *key;
        int64_t *count;
    } counts[] = {{"least", &options->least}, {"most", &options->most}, {"widen", &widen}};
    for (int i = 0; i < 3; i++) {
        if (section_attribute(radius, counts[i].key, value, sizeof value)) {
            RETURN_IF_ERROR(parse_integer(value, name, 0, 1000000, counts[i].count, error));
        }
    }
    options->widen = widen != 0;
    if (section_attribute(radius, "bound", value, sizeof value)) {
        RETURN_IF_ERROR(parse_double(value, name, 1.0, 1e6, &options->gradient_bound, error));
    }
    return STATUS_OK;
}

enum status stage_record(struct stream *stream, const struct field_shapes *recorded, int64_t node_count,
                         struct error *error)
{
    char described[DESCRIPTION];
    describe(recorded, described);
    RETURN_IF_ERROR(stream_put_copy(stream, "support.radius", TYPE_F8, node_count, 1, described,
                                    recorded->supports.radius, error));
    const double *A = recorded->supports.stretch;
    int64_t cols = recorded->support.mls.dim == 2 ? 4 : 9;
    return A == NULL ? STATUS_OK
                     : stream_put_copy(stream, "support.stretch", TYPE_F8, node_count, cols, "", A, error);
}

/* ---- the field that mtled computed ---- */

static const char parameters[] = "parameters";

const struct section *solved_parameters(const struct stream *stream, const struct field_shapes *recorded,
                                        const struct section *field)
{
    char name[96];
    if (recorded->supports.radius == NULL ||
        (strcmp(field->name, "u") != 0 && strncmp(field->name, "u.frame.", 8) != 0)) {
        return field;
    }
    snprintf(name, sizeof name, "%s%s", parameters, field->name + 1);
    const struct section *found = stream_find(stream, name);
    bool fits = found != NULL && found->type == field->type && found->rows == field->rows &&
                found->cols == field->cols;
    return fits ? found : field;
}

bool solved_is_parameters(const struct section *section)
{
    size_t length = strlen(parameters);
    return strncmp(section->name, parameters, length) == 0 &&
           (section->name[length] == '\0' || section->name[length] == '.');
}
