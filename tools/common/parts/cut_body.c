#include "parts/cut_body.h"

#include "io/stream/sections.h"

#include <stdlib.h>
#include <string.h>

/* How a section is cut: its rows follow "nodes.x" or "cells", or belong to "facets" or "sets.idx"; NULL: it
 * is left out. */
static const char *rows_of(const struct cut_body *whole, const struct section *section)
{
    static const char *const cut[] = {"nodes.x", "cells", "facets", "sets.idx"};
    const struct section_kind *kind = section_kind_of(section->name);
    if (kind == NULL || (kind->stage != MADE_WITH_CLOUD && kind->stage != MADE_WITH_RESULTS)) {
        return NULL;
    }
    const char *rows = kind->content == LIST   ? "sets.idx"
                       : kind->rows_of != NULL ? kind->rows_of
                                               : kind->name;
    bool fits = strcmp(rows, "nodes.x") != 0 || section->rows == whole->cells.node_count;
    for (size_t i = 0; i < sizeof cut / sizeof *cut && fits; i++) {
        if (strcmp(rows, cut[i]) == 0) {
            return cut[i];
        }
    }
    return NULL;
}

static bool has(const struct cut_body *whole, const char *name, const char *other)
{
    return stream_find(whole->stream, name) != NULL || stream_find(whole->stream, other) != NULL;
}

/* Check the groups of a body; its other sections are cut unchecked. */
static void check_groups(const struct cut_body *whole)
{
    const struct tool *tool = whole->tool;
    const struct cells *cells = &whole->cells;
    FREED_BY(cell_regions_free) struct cell_regions regions = {0};
    FREED_BY(named_facets_free) struct named_facets facets = {0};
    FREED_BY(named_sets_free) struct named_sets sets = {0};
    const int32_t *side;
    if (stream_find(whole->stream, "cells.region") != NULL) {
        TOOL_TRY(tool, stream_regions(whole->stream, &regions, &error));
    }
    TOOL_TRY(tool, stage_sides(whole->stream, "parameters", &side, &error));
    TOOL_TRY(tool, stream_facets(whole->stream, has(whole, "facets", "facets.set"), cells, &facets, &error));
    TOOL_TRY(tool, stream_sets(whole->stream, has(whole, "sets.ptr", "sets.idx"), cells->node_count, &sets,
                               &error));
}

/* Remove sections that cannot be cut, and keep a copy of the others. */
void cut_body_keep_sections(struct cut_body *whole)
{
    struct stream *stream = whole->stream;
    char dropped[256] = "";
    check_groups(whole);
    for (int64_t i = stream->section_count - 1; i >= 0; i--) {
        const struct section *section = &stream->sections[i];
        if (rows_of(whole, section) == NULL) {
            text_append(dropped, sizeof dropped, " %s", section->name);
            stream_remove(stream, section->name);
        }
    }
    if (dropped[0] != '\0') {
        tool_note(whole->tool, "left out:%s", dropped);
    }
    whole->section_count = stream->section_count;
    TOOL_TRY(whole->tool, NEW_ARRAY(&whole->sections, stream->section_count, &error));
    for (int64_t i = 0; i < stream->section_count; i++) {
        struct section *kept = &whole->sections[i];
        *kept = stream->sections[i];
        stream->sections[i].owned = false; /* replaced for each part; the data is freed at the end */
        kept->name = tool_memory(whole->tool, strdup(kept->name));
        kept->attributes = tool_memory(whole->tool, strdup(kept->attributes));
    }
}

static const struct section *kept_section(const struct cut_body *whole, const char *name)
{
    for (int64_t i = 0; i < whole->section_count; i++) {
        if (strcmp(whole->sections[i].name, name) == 0) {
            return &whole->sections[i];
        }
    }
    return NULL;
}

static void put(const struct cut_body *whole, const char *name, enum element_type type, int64_t rows,
                int64_t cols, const char *attributes, void *data)
{
    TOOL_TRY(whole->tool, stream_put(whole->stream, name, type, rows, cols, attributes, data, true, &error));
}

/* Put these rows of a section. If `place` is given, the values are node numbers n and become place[n]. */
static void put_rows(const struct cut_body *whole, const struct section *section, const int32_t *row,
                     int64_t count, const int32_t *place)
{
    size_t bytes = element_size(section->type) * (size_t)section->cols;
    char *data = array_new(count, bytes);
    if (data == NULL) {
        tool_fail(whole->tool, STATUS_SYSTEM, "%s: out of memory", section->name);
    }
    for (int64_t i = 0; i < count; i++) {
        memcpy(data + (size_t)i * bytes, (const char *)section->data + (size_t)row[i] * bytes, bytes);
    }
    for (int64_t i = 0; place != NULL && i < count * section->cols; i++) {
        ((int32_t *)data)[i] = place[((int32_t *)data)[i]];
    }
    put(whole, section->name, section->type, count, section->cols, section->attributes, data);
}

/* A copy of a list of numbers as a section. */
static void put_numbers(const struct cut_body *whole, const char *name, const char *attributes,
                        const int32_t *number, int64_t count)
{
    TOOL_TRY(whole->tool,
             stream_put_copy(whole->stream, name, TYPE_I4, count, 1, attributes, number, &error));
}

/* Put the facets of a cell of the part. */
static void put_facets(const struct cut_body *whole, const int32_t *place, const bool *has_cell)
{
    const struct section *facets = kept_section(whole, "facets"), *set = kept_section(whole, "facets.set");
    if (facets == NULL || set == NULL) {
        return;
    }
    const int32_t *node = facets->data;
    const struct cell_stars *stars = &whole->stars;
    int dim = whole->cells.dim;
    int64_t count = 0;
    SCRATCH int32_t *row = NULL;
    TOOL_TRY(whole->tool, NEW_ARRAY(&row, facets->rows, &error));
    for (int64_t f = 0; f < facets->rows; f++) {
        bool there = false;
        int32_t first = node[f * dim];
        for (int64_t s = stars->ptr[first]; s < stars->ptr[first + 1] && !there; s++) {
            const int32_t *vertex = whole->cells.node + (int64_t)stars->cell[s] * (dim + 1);
            int found = 0;
            for (int i = 0; i < dim; i++) {
                for (int k = 0; k <= dim; k++) {
                    found += vertex[k] == node[f * dim + i];
                }
            }
            there = found == dim && has_cell[stars->cell[s]];
        }
        if (there) {
            row[count++] = (int32_t)f;
        }
    }
    put_rows(whole, facets, row, count, place);
    put_rows(whole, set, row, count, NULL);
    put_numbers(whole, "part.facet", "", row, count);
}

static void put_sets(const struct cut_body *whole, const int32_t *place)
{
    const struct section *ptr = kept_section(whole, "sets.ptr"), *idx = kept_section(whole, "sets.idx");
    if (ptr == NULL || idx == NULL) {
        return;
    }
    const int64_t *begin = ptr->data;
    const int32_t *node = idx->data;
    int64_t *own, count = 0;
    SCRATCH int32_t *row = NULL;
    TOOL_TRY(whole->tool, NEW_ARRAY(&own, ptr->rows, &error));
    TOOL_TRY(whole->tool, NEW_ARRAY(&row, idx->rows, &error));
    for (int64_t s = 0; s + 1 < ptr->rows; s++) {
        for (int64_t i = begin[s]; i < begin[s + 1]; i++) {
            if (place[node[i]] >= 0) {
                row[count++] = (int32_t)i;
            }
        }
        own[s + 1] = count;
    }
    put(whole, "sets.ptr", TYPE_I8, ptr->rows, 1, ptr->attributes, own);
    put_rows(whole, idx, row, count, place);
    put_numbers(whole, "part.set", "", row, count);
}

/* Turn the stream into that of one part. */
void cut_body_make_part(const struct cut_body *whole, int32_t number, const struct body_part *body)
{
    int32_t *place, *owner;
    SCRATCH bool *has_cell = NULL;
    char attributes[192];
    TOOL_TRY(whole->tool, NEW_ARRAY(&place, whole->cells.node_count, &error));
    TOOL_TRY(whole->tool, NEW_ARRAY(&has_cell, whole->cells.count, &error));
    TOOL_TRY(whole->tool, NEW_ARRAY(&owner, body->node_count, &error));
    for (int64_t n = 0; n < whole->cells.node_count; n++) {
        place[n] = -1;
    }
    for (int64_t i = 0; i < body->node_count; i++) {
        place[body->node[i]] = (int32_t)i;
        owner[i] = whole->owner[body->node[i]];
    }
    for (int64_t i = 0; i < body->cell_count; i++) {
        has_cell[body->cell[i]] = true;
    }
    for (int64_t i = 0; i < whole->section_count; i++) {
        const struct section *section = &whole->sections[i];
        const char *rows = rows_of(whole, section);
        if (strcmp(rows, "nodes.x") == 0) {
            put_rows(whole, section, body->node, body->node_count, NULL);
        } else if (strcmp(rows, "cells") == 0) {
            put_rows(whole, section, body->cell, body->cell_count,
                     strcmp(section->name, "cells") == 0 ? place : NULL);
        }
    }
    snprintf(attributes, sizeof attributes, "part=%d parts=%d cut=%08x nodes=%lld cells=%lld widen=%.17g",
             number, whole->partition.parts, whole->cut, (long long)whole->cells.node_count,
             (long long)whole->cells.count, whole->partition.widen);
    put_numbers(whole, "part.node", attributes, body->node, body->node_count);
    put(whole, "part.owner", TYPE_I4, body->node_count, 1, "", owner);
    put_numbers(whole, "part.cell", "", body->cell, body->cell_count);
    put_facets(whole, place, has_cell);
    put_sets(whole, place);
    free(place);
}

void cut_body_free(struct cut_body *whole)
{
    FREE_ALL(whole->radius, whole->owner, whole->work, whole->own_ptr, whole->own_cell);
    cell_stars_free(&whole->stars);
    point_grid_free(&whole->grid);
    for (int64_t i = 0; i < whole->section_count; i++) {
        FREE_ALL(whole->sections[i].name, whole->sections[i].attributes);
        if (whole->sections[i].owned) {
            free(whole->sections[i].data);
        }
    }
    free(whole->sections);
}
