#include "tovtk/plot.h"

#include "base/eigen.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/vector.h"
#include "io/stream/sections.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Names of the sections of groups begin so; "label=facets.NAME" or "label=set.NAME" are their attributes. */
#define DERIVED_GROUP "derived."

/* ---- derived fields ---- */

/* A[9]: row `row` of a symmetric tensor, whose components are in the columns from[6]. */
static void read_tensor(const struct section *section, const int64_t from[6], int64_t row, double A[9])
{
    static const int place[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    memset(A, 0, 9 * sizeof *A);
    for (int k = 0; k < 6; k++) {
        int64_t at = row * section->cols + from[k];
        double value = from[k] < 0                ? 0.0
                       : section->type == TYPE_F8 ? ((const double *)section->data)[at]
                                                  : (double)((const float *)section->data)[at];
        A[3 * place[k][0] + place[k][1]] = A[3 * place[k][1] + place[k][0]] = value;
    }
}

static void principal_values(const double A[9], double *row)
{
    double V[9], values[3];
    eigen_symmetric(3, A, values, V);
    qsort(values, 3, sizeof *values, compare_double);
    for (int i = 0; i < 3; i++) {
        row[i] = values[2 - i];
    }
}

static void von_mises(const double A[9], double *row)
{
    double mean = (A[0] + A[4] + A[8]) / 3.0, squares = 0.0;
    for (int k = 0; k < 9; k++) {
        double deviator = A[k] - (k % 4 == 0 ? mean : 0.0);
        squares += deviator * deviator;
    }
    *row = sqrt(1.5 * squares);
}

static void mean_pressure(const double A[9], double *row)
{
    *row = (0.0 - A[0] - A[4] - A[8]) / 3.0; /* not -0 */
}

static void volume_ratio(const double A[9], double *row)
{
    double C[9];
    for (int k = 0; k < 9; k++) {
        C[k] = 2.0 * A[k] + (k % 4 == 0 ? 1.0 : 0.0);
    }
    *row = sqrt(determinant3(C, C + 3, C + 6));
}

static const struct invariant {
    const char *of, *name; /* of section `of` and its frames */
    int cols;
    const char *attributes;
    const char *given; /* left out if the stream has this section; "": never */
    void (*compute)(const double A[9], double *row);
} invariants[] = {
    {"stress", "stress.von_mises", 1, "unit=Pa", "", von_mises},
    {"stress", "stress.principal", 3, "unit=Pa cols=1,2,3", "", principal_values},
    {"stress", "pressure", 1, "unit=Pa", "pressure", mean_pressure},
    {"strain", "strain.principal", 3, "unit=1 cols=1,2,3", "", principal_values},
    {"strain", "J", 1, "unit=1", "volume_ratio", volume_ratio},
};

/* Put fields into the stream, derived from the symmetric tensors stress and strain of a frame (X.frame.K
 * gives X.NAME.frame.K) or of the final state (FRAME_NONE), with the same rows:
 *
 *   stress.von_mises   sqrt(3/2 s:s), s the deviator, Pa
 *   stress.principal   the principal stresses, Pa, the largest first
 *   pressure           -tr(stress)/3, Pa, unless the stream has it
 *   strain.principal   the principal strains, the largest first
 *   J                  sqrt det(1 + 2 strain), exactly det F, unless the stream has volume_ratio */
static enum status add_invariants(struct stream *stream, int64_t frame, struct error *error)
{
    char name[160];
    int64_t count = stream->section_count;
    for (int64_t s = 0; s < count; s++) {
        const struct section *section = &stream->sections[s];
        size_t length;
        int64_t from[6];
        bool wanted = frame_of(section->name, &length) == frame && vtk_tensor(section, from);
        for (size_t i = 0; i < sizeof invariants / sizeof *invariants; i++) {
            const struct invariant *what = &invariants[i];
            const char *tail = section->name + length;
            snprintf(name, sizeof name, "%s%s", what->given, tail);
            if (!wanted || strlen(what->of) != length || strncmp(section->name, what->of, length) != 0 ||
                stream_find(stream, name) != NULL) {
                continue;
            }
            NEW_SCRATCH(double, values, section->rows *what->cols, error);
            for (int64_t row = 0; row < section->rows; row++) {
                double A[9];
                read_tensor(section, from, row, A);
                what->compute(A, values + row * what->cols);
            }
            snprintf(name, sizeof name, "%s%s", what->name, tail);
            RETURN_IF_ERROR(stream_put(stream, name, TYPE_F8, section->rows, what->cols, what->attributes,
                                       array_take(&values), true, error));
        }
    }
    return STATUS_OK;
}

/* Put a section for each name: 1 at the nodes of its facets or set, which have so many `nodes` each, 0
 * elsewhere.
 */
static enum status add_groups(struct stream *stream, const char *prefix, const struct groups *groups,
                              int64_t node_count, int nodes, struct error *error)
{
    for (int64_t g = 0; g < groups->names.count; g++) {
        char name[64];
        SCRATCH char *label = NULL;
        NEW_SCRATCH(int32_t, value, node_count, error);
        for (int64_t i = 0; i < groups->count * nodes; i++) {
            value[groups->node[i]] |= groups->group[i / nodes] == g;
        }
        snprintf(name, sizeof name, DERIVED_GROUP "%s%jd", prefix, g);
        if (asprintf(&label, "label=%s.%s", prefix, groups->names.name[g]) < 0) {
            label = NULL;
            return fail_memory(error, "labels");
        }
        RETURN_IF_ERROR(
            stream_put(stream, name, TYPE_I4, node_count, 1, label, array_take(&value), true, error));
    }
    return STATUS_OK;
}

/* ---- the plot ---- */

static bool begins_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

/* Whether a section is a list, geometry, or of neither nodes nor cells, for any number of rows. */
static bool is_structure(const char *name)
{
    const struct section_kind *kind = section_kind_of(name);
    return kind != NULL &&
           (kind->content == LIST || kind->content == INDEX_OR_NONE || kind->rows_of == NULL ||
            (strcmp(kind->rows_of, "nodes.x") != 0 && strcmp(kind->rows_of, "cells") != 0 &&
             strcmp(kind->rows_of, "points.x") != 0));
}

/* Whether a section of this name has a row for each integration point or cell. */
static bool is_of_points(const char *name)
{
    static const char *const first[] = {"cells",    "points",       "stress", "strain",
                                        "pressure", "volume_ratio", "fibre",  "J"};
    size_t length = strcspn(name, ".");
    bool any = false;
    for (size_t i = 0; i < sizeof first / sizeof *first; i++) {
        any = any || (length == strlen(first[i]) && strncmp(name, first[i], length) == 0);
    }
    return any;
}

static bool is_field(const struct cells *cells, const struct section *section, bool *of_cells)
{
    bool fits_cells = cells->count > 0 && section->rows == cells->count;
    bool fits_nodes = section->rows == cells->node_count;
    *of_cells = fits_cells && (is_of_points(section->name) || !fits_nodes);
    return (fits_cells || fits_nodes) && section->cols > 0;
}

static void choose_field(struct plot *plot, const struct section *section, int64_t frame)
{
    struct plot_field field = {.section = section};
    size_t length;
    int64_t of = frame_of(section->name, &length);
    bool is_derived = begins_with(section->name, DERIVED_GROUP);
    /* What describes the reference state is the same in all frames. */
    bool is_wanted =
        of == frame || (of == FRAME_NONE && (is_derived || section_stage(section->name) < MADE_WITH_RESULTS));
    if (is_wanted && is_field(&plot->cells, section, &field.of_cells)) {
        field.name = is_derived ? strchr(section->attributes, '=') + 1 : section->name;
        if (of != FRAME_NONE) {
            char *label = plot->labels[plot->field_count];
            snprintf(label, sizeof plot->labels[0], "%.*s", (int)length, section->name);
            field.name = label;
        }
        plot->fields[plot->field_count++] = field;
    }
}

enum status plot_choose(struct plot *plot, int64_t frame, struct error *error)
{
    struct stream *stream = &plot->stream;
    const struct cells *cells = &plot->cells;
    FREED_BY(groups_free) struct groups facets = {0}, sets = {0};
    while (stream->section_count > plot->given) {
        stream_remove(stream, stream->sections[stream->section_count - 1].name);
    }
    RETURN_IF_ERROR(add_invariants(stream, frame, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_FACETS, false, &facets, error));
    RETURN_IF_ERROR(add_groups(stream, "facets", &facets, cells->node_count, cells->dim, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_NODES, false, &sets, error));
    RETURN_IF_ERROR(add_groups(stream, "set", &sets, cells->node_count, 1, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&plot->fields, stream->section_count, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&plot->labels, stream->section_count, error));
    plot->field_count = 0;
    for (int64_t s = 0; s < stream->section_count; s++) {
        if (!is_structure(stream->sections[s].name)) {
            choose_field(plot, &stream->sections[s], frame);
        }
    }
    return STATUS_OK;
}

static enum status find_frames(struct plot *plot, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&plot->frames, plot->stream.section_count, error));
    for (int64_t s = 0; s < plot->stream.section_count; s++) {
        size_t length;
        int64_t frame = frame_of(plot->stream.sections[s].name, &length);
        if (frame >= 0) {
            plot->frames[plot->frame_count++] = frame;
        }
    }
    plot->frame_count = sort_distinct(plot->frame_count, plot->frames);
    return STATUS_OK;
}

enum status plot_time(const struct plot *plot, int64_t frame, double *time, struct error *error)
{
    *time = frame == FRAME_NONE ? 0.0 : (double)frame;
    for (int64_t s = 0; s < plot->stream.section_count; s++) {
        const struct section *section = &plot->stream.sections[s];
        size_t length;
        char text[64];
        if (frame != FRAME_NONE && frame_of(section->name, &length) == frame &&
            section_attribute(section, "time", text, sizeof text)) {
            return parse_double(text, section->name, -1e300, 1e300, time, error);
        }
    }
    return STATUS_OK;
}

enum status plot_find(struct plot *plot, struct error *error)
{
    struct cells *cells = &plot->cells;
    RETURN_IF_ERROR(stream_cells(&plot->stream, false, cells, error));
    RETURN_IF_ERROR(cells->count > 0
                        ? stream_groups(&plot->stream, GROUP_REGION, false, &plot->regions, error)
                        : STATUS_OK);
    plot->given = plot->stream.section_count;
    return find_frames(plot, error);
}

void plot_free(struct plot *plot)
{
    stream_free(&plot->stream);
    groups_free(&plot->regions);
    FREE_ALL(plot->fields, plot->labels, plot->frames);
}
