#include "tovtk/plot.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool begins_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

/* Whether a section of this name (X of X.frame.K) describes the reference state, which is the same in all
 * frames. */
static bool is_static(const char *name)
{
    return begins_with(name, "cells.") || begins_with(name, "nodes.") || begins_with(name, "support.") ||
           begins_with(name, DERIVED_GROUP) || strcmp(name, "points.weight") == 0;
}

/* Whether the part of a name before its first dot is in a NULL-terminated list. */
static bool is_one_of(const char *name, const char *const *list)
{
    size_t length = strcspn(name, ".");
    for (; *list != NULL; list++) {
        if (length == strlen(*list) && strncmp(name, *list, length) == 0) {
            return true;
        }
    }
    return false;
}

/* Whether a section is a list, geometry, or of neither nodes nor cells, for any number of rows. */
static bool is_structure(const char *name)
{
    static const char *const exact[] = {"nodes.x", "cells", "points.x", "points.cell"};
    static const char *const first[] = {"facets", "faces",     "facepoints", "facepoint", "face", "boundary",
                                        "sets",   "reactions", "energy",     "gaps",      NULL};
    for (size_t i = 0; i < sizeof exact / sizeof exact[0]; i++) {
        if (strcmp(name, exact[i]) == 0) {
            return true;
        }
    }
    return is_one_of(name, first) || text_ends(name, ".ptr") || text_ends(name, ".idx");
}

/* Whether a section of this name has a row for each integration point or cell. */
static bool is_of_points(const char *name)
{
    static const char *const first[] = {"cells",        "points", "stress", "strain", "pressure",
                                        "volume_ratio", "fibre",  "J",      NULL};
    return is_one_of(name, first);
}

/* Whether a section is a field on nodes or cells. */
static bool is_field(const struct vtk_mesh *mesh, const struct section *section, bool *of_cells)
{
    bool fits_cells = mesh->node != NULL && section->rows == mesh->cell_count;
    bool fits_nodes = section->rows == mesh->node_count;
    *of_cells = fits_cells && (is_of_points(section->name) || !fits_nodes);
    return (fits_cells || fits_nodes) && section->cols > 0;
}

static void choose_field(struct plot *plot, const struct section *section, int64_t frame)
{
    struct vtk_field field = {.section = section};
    size_t length;
    int64_t of = frame_of(section->name, &length);
    bool is_wanted = of == frame || (of == FRAME_NONE && is_static(section->name));
    if (is_wanted && is_field(&plot->mesh, section, &field.of_cells)) {
        field.name =
            begins_with(section->name, DERIVED_GROUP) ? strchr(section->attributes, '=') + 1 : section->name;
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
    while (stream->section_count > plot->given) {
        stream_remove(stream, stream->sections[stream->section_count - 1].name);
    }
    RETURN_IF_ERROR(derived_add(stream, &plot->cells, frame, error));
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
        if (frame != FRAME_NONE) {
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

static enum status find_mesh(struct plot *plot, struct error *error)
{
    struct cells *cells = &plot->cells;
    struct cell_regions *regions = &plot->regions;
    RETURN_IF_ERROR(stream_cells(&plot->stream, false, cells, error));
    plot->mesh = (struct vtk_mesh){.dim = cells->dim,
                                   .node_count = cells->node_count,
                                   .x = cells->x,
                                   .cell_count = cells->count,
                                   .node = cells->count > 0 ? cells->node : NULL};
    if (cells->count > 0 && stream_find(&plot->stream, "cells.region") != NULL) {
        RETURN_IF_ERROR(stream_regions(&plot->stream, regions, error));
        plot->mesh.regions = regions->names;
    }
    return STATUS_OK;
}

enum status plot_find(struct plot *plot, struct error *error)
{
    RETURN_IF_ERROR(find_mesh(plot, error));
    plot->given = plot->stream.section_count;
    return find_frames(plot, error);
}

void plot_free(struct plot *plot)
{
    stream_free(&plot->stream);
    names_free(&plot->regions.names);
    FREE_ALL(plot->fields, plot->labels, plot->frames);
}
