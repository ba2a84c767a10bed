#include "parts/cut_body.h"

#include "io/stream/sections.h"

#include <stdlib.h>
#include <string.h>

/* What the rows of a section that is cut belong to. */
enum { OF_NODES, OF_CELLS, OF_FACETS, OF_SETS, KINDS };
static const char *const kinds[KINDS] = {"nodes.x", "cells", "facets", "sets.idx"};

/* The rows of each kind that a part has. */
struct part_rows {
    int64_t count;
    const int32_t *row;
};

/* The kind of a section's rows; KINDS: it is left out. */
static int kind_of(const struct cut_body *whole, const struct section *section)
{
    const struct section_kind *kind = section_kind_of(section->name);
    int of = 0;
    if (kind == NULL || (kind->stage != MADE_WITH_CLOUD && kind->stage != MADE_WITH_RESULTS)) {
        return KINDS;
    }
    const char *rows = kind->content == LIST   ? "sets.idx"
                       : kind->rows_of != NULL ? kind->rows_of
                                               : kind->name;
    while (of < KINDS && strcmp(rows, kinds[of]) != 0) {
        of++;
    }
    return of == OF_NODES && section->rows != whole->cells.node_count ? KINDS : of;
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

void cut_body_drop_sections(const struct cut_body *whole)
{
    struct stream *stream = whole->stream;
    char dropped[256] = "";
    check_groups(whole);
    for (int64_t i = stream->section_count - 1; i >= 0; i--) {
        const struct section *section = &stream->sections[i];
        if (kind_of(whole, section) == KINDS) {
            text_append(dropped, sizeof dropped, " %s", section->name);
            stream_remove(stream, section->name);
        }
    }
    if (dropped[0] != '\0') {
        tool_note(whole->tool, "left out:%s", dropped);
    }
}

/* Put these rows of a section. If `place` is given, the values are node numbers n and become place[n]. */
static void put_rows(const struct cut_body *whole, struct stream *part, const struct section *section,
                     const struct part_rows *rows, const int32_t *place)
{
    size_t bytes = element_size(section->type) * (size_t)section->cols;
    char *data = tool_memory(whole->tool, array_new(rows->count, bytes));
    for (int64_t i = 0; i < rows->count; i++) {
        memcpy(data + (size_t)i * bytes, (const char *)section->data + (size_t)rows->row[i] * bytes, bytes);
    }
    for (int64_t i = 0; place != NULL && i < rows->count * section->cols; i++) {
        ((int32_t *)data)[i] = place[((int32_t *)data)[i]];
    }
    tool_put(whole->tool, part, section->name, section->type, rows->count, section->cols, section->attributes,
             data);
}

/* Whether a cell of the part has a facet, node[dim]. */
static bool has_facet(const struct cut_body *whole, const int32_t *node, const bool *has_cell)
{
    int dim = whole->cells.dim;
    const struct cell_stars *stars = &whole->stars;
    for (int64_t s = stars->ptr[node[0]]; s < stars->ptr[node[0] + 1]; s++) {
        const int32_t *vertex = whole->cells.node + (int64_t)stars->cell[s] * (dim + 1);
        int found = 0;
        for (int i = 0; i < dim * (dim + 1); i++) {
            found += vertex[i % (dim + 1)] == node[i / (dim + 1)];
        }
        if (found == dim && has_cell[stars->cell[s]]) {
            return true;
        }
    }
    return false;
}

/* The facets of cells of the part, and the members of sets that are its nodes, into row[]. */
static void find_rows(const struct cut_body *whole, int kind, const int32_t *place, const bool *has_cell,
                      int32_t **row, struct part_rows *rows)
{
    const struct section *section = stream_find(whole->stream, kinds[kind]);
    int64_t count = section != NULL ? section->rows : 0;
    TOOL_TRY(whole->tool, NEW_ARRAY(row, count, &error));
    *rows = (struct part_rows){.row = *row};
    for (int64_t i = 0; i < count; i++) {
        const int32_t *node = (const int32_t *)section->data + i * section->cols;
        if (kind == OF_FACETS ? has_facet(whole, node, has_cell) : place[*node] >= 0) {
            (*row)[rows->count++] = (int32_t)i;
        }
    }
}

/* Put the starts of the sets, from the members that the part has. */
static void put_set_starts(const struct cut_body *whole, struct stream *part, const struct section *ptr,
                           const struct part_rows *members)
{
    int64_t *own, count = 0;
    TOOL_TRY(whole->tool, NEW_ARRAY(&own, ptr->rows, &error));
    for (int64_t s = 0; s < ptr->rows; s++) {
        while (count < members->count && members->row[count] < ((const int64_t *)ptr->data)[s]) {
            count++;
        }
        own[s] = count;
    }
    tool_put(whole->tool, part, ptr->name, TYPE_I8, ptr->rows, 1, ptr->attributes, own);
}

/* Put part.WHAT: the numbers in the whole body of the rows of a kind, if the body has such rows. */
static void put_numbers(const struct cut_body *whole, struct stream *part, const char *name, int kind,
                        const char *attributes, const struct part_rows *rows)
{
    if (stream_find(whole->stream, kinds[kind]) != NULL) {
        TOOL_TRY(whole->tool,
                 stream_put_copy(part, name, TYPE_I4, rows->count, 1, attributes, rows->row, &error));
    }
}

void cut_body_make_part(const struct cut_body *whole, int32_t number, const struct body_part *body,
                        struct stream *part)
{
    SCRATCH int32_t *facet = NULL, *member = NULL;
    struct part_rows rows[KINDS] = {{body->node_count, body->node}, {body->cell_count, body->cell}};
    char attributes[192];
    TOOL_SCRATCH(whole->tool, int32_t, place, whole->cells.node_count);
    TOOL_SCRATCH(whole->tool, bool, has_cell, whole->cells.count);
    TOOL_SCRATCH(whole->tool, int32_t, owner, body->node_count);
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
    find_rows(whole, OF_FACETS, place, has_cell, &facet, &rows[OF_FACETS]);
    find_rows(whole, OF_SETS, place, has_cell, &member, &rows[OF_SETS]);
    for (int64_t i = 0; i < whole->stream->section_count; i++) {
        const struct section *section = &whole->stream->sections[i];
        const struct section_kind *kind = section_kind_of(section->name);
        if (kind->content == LIST) {
            put_set_starts(whole, part, section, &rows[OF_SETS]);
        } else {
            put_rows(whole, part, section, &rows[kind_of(whole, section)],
                     kind->content == INDEX ? place : NULL);
        }
    }
    snprintf(attributes, sizeof attributes, "part=%d parts=%d cut=%08x nodes=%lld cells=%lld widen=%.17g",
             number, whole->partition.parts, whole->cut, (long long)whole->cells.node_count,
             (long long)whole->cells.count, whole->partition.widen);
    put_numbers(whole, part, "part.node", OF_NODES, attributes, &rows[OF_NODES]);
    put_numbers(whole, part, "part.owner", OF_NODES, "", &(struct part_rows){body->node_count, owner});
    put_numbers(whole, part, "part.cell", OF_CELLS, "", &rows[OF_CELLS]);
    put_numbers(whole, part, "part.facet", OF_FACETS, "", &rows[OF_FACETS]);
    put_numbers(whole, part, "part.set", OF_SETS, "", &rows[OF_SETS]);
}

void cut_body_free(struct cut_body *whole)
{
    FREE_ALL(whole->radius, whole->owner, whole->work, whole->own_ptr, whole->own_cell);
    cell_stars_free(&whole->stars);
    point_grid_free(&whole->grid);
}
