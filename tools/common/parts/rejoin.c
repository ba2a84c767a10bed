#include "parts/rejoin.h"

#include "approx/partition/partition.h"

#include <stdlib.h>
#include <string.h>

static int64_t attribute(const struct rejoin *rejoin, const struct rejoin_part *part, const char *key)
{
    struct error error;
    char value[64];
    int64_t number = 0;
    const struct section *section = stream_find(&part->stream, "part.node");
    if (!section_attribute(section, key, value, sizeof value) ||
        parse_integer(value, key, 0, INT32_MAX, &number, &error) != STATUS_OK) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: part.node: no %s=: not written by part", part->file, key);
    }
    return number;
}

/* The section `name` of a part: one number from `least` to before `below` for each of `rows` rows, perhaps
 * ascending. Exits if it is not. */
static const int32_t *numbers(const struct rejoin *rejoin, const struct rejoin_part *part, const char *name,
                              int64_t rows, int64_t least, int64_t below, bool ascending)
{
    const struct section *section;
    TOOL_TRY(rejoin->tool,
             fail_in(&error, stream_need(&part->stream, name, TYPE_I4, 1, "part", &section, &error), "%s",
                     part->file));
    const int32_t *value = section->data;
    if (section->rows != rows) {
        tool_fail(rejoin->tool, STATUS_INPUT,
                  "%s: %s: %lld rows, not %lld: cut again, and leave the cloud as it is", part->file, name,
                  (long long)section->rows, (long long)rows);
    }
    for (int64_t i = 0; i < rows; i++) {
        if (value[i] < least || value[i] >= below || (ascending && i > 0 && value[i] <= value[i - 1])) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: row %lld: %d is out of range, or does not ascend",
                      part->file, name, (long long)i, value[i]);
        }
    }
    return value;
}

static void view_part(struct rejoin *rejoin, struct rejoin_part *part)
{
    const char *file = part->file;
    const struct section *node = stream_find(&part->stream, "part.node");
    if (node == NULL) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: no section part.node: not a part of a body", file);
    }
    part->number = attribute(rejoin, part, "part");
    part->parts = attribute(rejoin, part, "parts");
    if (!section_attribute(node, "cut", part->cut, sizeof part->cut)) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: part.node: no cut=: not written by part", file);
    }
    TOOL_TRY(rejoin->tool,
             fail_in(&error, stream_cells(&part->stream, true, &part->cells, &error), "%s", file));
    part->node =
        numbers(rejoin, part, "part.node", part->cells.node_count, 0, attribute(rejoin, part, "nodes"), true);
    part->owner = numbers(rejoin, part, "part.owner", part->cells.node_count, 0, part->parts, false);
    part->cell =
        numbers(rejoin, part, "part.cell", part->cells.count, 0, attribute(rejoin, part, "cells"), true);
}

/* The version in a provenance line of this program, "PROGRAM VERSION ..."; NULL: another program. */
static const char *version_of(const char *line, const char *program, size_t *length)
{
    size_t name = strcspn(program, " ");
    if (strncmp(line, program, name) != 0 || line[name] != ' ') {
        return NULL;
    }
    *length = strcspn(line + name + 1, " ");
    return line + name + 1;
}

/* Exit if parts were made by different versions of a program. */
static void check_versions(const struct rejoin *rejoin, const struct rejoin_part *part)
{
    const struct rejoin_part *first = &rejoin->part[0];
    for (int64_t i = 0; i < part->stream.provenance_count; i++) {
        const char *line = part->stream.provenance[i];
        size_t size, other_size;
        const char *version = version_of(line, line, &size);
        for (int64_t k = 0; k < first->stream.provenance_count && version != NULL; k++) {
            const char *other = version_of(first->stream.provenance[k], line, &other_size);
            if (other != NULL && (size != other_size || strncmp(version, other, size) != 0)) {
                tool_fail(rejoin->tool, STATUS_INPUT,
                          "%s and %s were made by different versions of %.*s: make them again", first->file,
                          part->file, (int)(version - line - 1), line);
            }
        }
    }
}

static int compare_parts(const void *left, const void *right)
{
    const struct rejoin_part *a = left, *b = right;
    return a->number != b->number ? (a->number > b->number) - (a->number < b->number)
                                  : strcmp(a->file, b->file);
}

/* Sort the parts by their numbers; exit if these are not all parts of one cut. */
static void sort_parts(struct rejoin *rejoin)
{
    const struct tool *tool = rejoin->tool;
    const struct rejoin_part *first = &rejoin->part[0];
    int64_t parts = first->parts;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        if (strcmp(part->cut, first->cut) != 0 || part->parts != parts ||
            attribute(rejoin, part, "nodes") != attribute(rejoin, first, "nodes") ||
            attribute(rejoin, part, "cells") != attribute(rejoin, first, "cells") ||
            part->cells.dim != first->cells.dim) {
            tool_fail(tool, STATUS_INPUT, "%s and %s are parts of different cuts: cut again", first->file,
                      part->file);
        }
        check_versions(rejoin, part);
        if (part->number >= parts) {
            tool_fail(tool, STATUS_INPUT, "%s: part.node: part %lld of %lld", part->file,
                      (long long)part->number, (long long)parts);
        }
    }
    qsort(rejoin->part, (size_t)rejoin->part_count, sizeof *rejoin->part, compare_parts);
    for (int64_t k = 0; k < parts || k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        if (k == rejoin->part_count || part->number > k) {
            tool_fail(tool, STATUS_INPUT, "part %lld of %lld is missing", (long long)k, (long long)parts);
        }
        if (part->number < k) {
            tool_fail(tool, STATUS_INPUT, "%s and %s are the same part, %lld", part[-1].file, part->file,
                      (long long)part->number);
        }
    }
}

int32_t *rejoin_new_rows(const struct rejoin *rejoin, struct rejoin_part *part, enum rows_of kind,
                         int64_t count)
{
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&part->to[kind], count, &error));
    part->count[kind] = count;
    return part->to[kind];
}

void rejoin_check_rows(const struct rejoin *rejoin, enum rows_of kind, const char *called)
{
    int64_t total = 0;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        for (int64_t i = 0; i < part->count[kind]; i++) {
            total += part->to[kind][i] >= 0;
        }
    }
    if (total != rejoin->rows[kind]) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %lld rows in all parts, not %lld: cut again", called,
                  (long long)total, (long long)rejoin->rows[kind]);
    }
    TOOL_SCRATCH(rejoin->tool, bool, found, total);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        for (int64_t i = 0; i < part->count[kind]; i++) {
            int32_t to = part->to[kind][i];
            if (to >= 0 && (to >= total || found[to])) {
                tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: row %lld is another part's as well: cut again",
                          part->file, called, (long long)i);
            }
            if (to >= 0) {
                found[to] = true;
            }
        }
    }
}

/* Map the nodes and cells of the parts to those of the whole. */
static void map_body(struct rejoin *rejoin)
{
    int vertices = rejoin->dim + 1;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *node = rejoin_new_rows(rejoin, part, ROWS_NODES, part->cells.node_count);
        int32_t *cell = rejoin_new_rows(rejoin, part, ROWS_CELLS, part->cells.count);
        for (int64_t i = 0; i < part->cells.node_count; i++) {
            node[i] = part->owner[i] == k ? part->node[i] : -1;
        }
        for (int64_t c = 0; c < part->cells.count; c++) {
            cell[c] = partition_cell_owner(&part->cells, c, part->owner) == k ? part->cell[c] : -1;
        }
    }
    rejoin->rows[ROWS_NODES] = attribute(rejoin, &rejoin->part[0], "nodes");
    rejoin->rows[ROWS_CELLS] = attribute(rejoin, &rejoin->part[0], "cells");
    rejoin_check_rows(rejoin, ROWS_NODES, "part.node");
    rejoin_check_rows(rejoin, ROWS_CELLS, "part.cell");
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&rejoin->x, rejoin->rows[ROWS_NODES] * rejoin->dim, &error));
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&rejoin->cell, rejoin->rows[ROWS_CELLS] * vertices, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        for (int64_t i = 0; i < part->cells.node_count; i++) {
            memcpy(rejoin->x + (int64_t)part->node[i] * rejoin->dim, part->cells.x + i * rejoin->dim,
                   (size_t)rejoin->dim * sizeof *rejoin->x);
        }
        for (int64_t i = 0; i < part->cells.count * vertices; i++) {
            rejoin->cell[(int64_t)part->cell[i / vertices] * vertices + i % vertices] =
                part->node[part->cells.node[i]];
        }
    }
}

/* Mark the nodes of each part that have cells outside of it. Supports there may differ from those of the
 * whole body: no list owned by the part may contain such a node. */
static void find_edges(struct rejoin *rejoin)
{
    int vertices = rejoin->dim + 1;
    TOOL_SCRATCH(rejoin->tool, int32_t, degree, rejoin->rows[ROWS_NODES]);
    for (int64_t i = 0; i < rejoin->rows[ROWS_CELLS] * vertices; i++) {
        degree[rejoin->cell[i]]++;
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        TOOL_SCRATCH(rejoin->tool, int32_t, here, part->cells.node_count);
        TOOL_TRY(rejoin->tool, NEW_ARRAY(&part->at_edge, part->cells.node_count, &error));
        for (int64_t i = 0; i < part->cells.count * vertices; i++) {
            here[part->cells.node[i]]++;
        }
        for (int64_t i = 0; i < part->cells.node_count; i++) {
            part->at_edge[i] = here[i] < degree[part->node[i]];
        }
    }
}

/* Map facets, or members of sets; each belongs to the part that owns its first node. */
static void map_listed(struct rejoin *rejoin, enum rows_of kind, const char *name, const char *numbered)
{
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = stream_find(&part->stream, name);
        if (section == NULL || section->type != TYPE_I4) {
            continue;
        }
        const int32_t *node = section->data;
        const int32_t *number = numbers(rejoin, part, numbered, section->rows, 0, INT32_MAX, true);
        int32_t *to = rejoin_new_rows(rejoin, part, kind, section->rows);
        for (int64_t i = 0; i < section->rows; i++) {
            int32_t first = node[i * section->cols];
            if (first < 0 || first >= part->cells.node_count) {
                tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: row %lld: no node %d", part->file, name,
                          (long long)i, first);
            }
            to[i] = part->owner[first] == k ? number[i] : -1;
            rejoin->rows[kind] += to[i] >= 0;
        }
    }
    rejoin_check_rows(rejoin, kind, name);
}

/* Map the integration points, which belong to the parts of their cells. */
static void map_points(struct rejoin *rejoin)
{
    int64_t cells = rejoin->rows[ROWS_CELLS];
    TOOL_SCRATCH(rejoin->tool, int64_t, begin, cells + 2);
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t k = 0; k < rejoin->part_count; k++) {
            struct rejoin_part *part = &rejoin->part[k];
            const struct section *points = stream_find(&part->stream, "points.cell");
            if (points == NULL || points->type != TYPE_I4) {
                continue;
            }
            const int32_t *cell = points->data;
            int32_t *to =
                pass == 0 ? rejoin_new_rows(rejoin, part, ROWS_POINTS, points->rows) : part->to[ROWS_POINTS];
            for (int64_t i = 0; i < points->rows; i++) {
                if (cell[i] < 0 || cell[i] >= part->cells.count) {
                    tool_fail(
                        rejoin->tool, STATUS_INPUT,
                        "%s: points.cell: row %lld: no cell %d: points of a lattice cannot be put together",
                        part->file, (long long)i, cell[i]);
                }
                int32_t of = part->to[ROWS_CELLS][cell[i]];
                to[i] = -1;
                if (of >= 0 && pass == 0) {
                    begin[of + 2]++;
                } else if (of >= 0) {
                    to[i] = (int32_t)begin[of + 1]++;
                }
            }
        }
        for (int64_t c = 1; c <= cells && pass == 0; c++) {
            begin[c + 1] += begin[c];
        }
        rejoin->rows[ROWS_POINTS] = pass == 0 ? begin[cells + 1] : rejoin->rows[ROWS_POINTS];
    }
}

void rejoin_begin(struct rejoin *rejoin, const struct tool *tool, char *const files[], int64_t count)
{
    *rejoin = (struct rejoin){.tool = tool, .part_count = count};
    TOOL_TRY(tool, NEW_ARRAY(&rejoin->part, count, &error));
    for (int64_t k = 0; k < count; k++) {
        rejoin->part[k].file = files[k];
        tool_read(tool, files[k], &rejoin->part[k].stream);
    }
    rejoin_streams(rejoin);
}

void rejoin_streams(struct rejoin *rejoin)
{
    const struct tool *tool = rejoin->tool;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        view_part(rejoin, &rejoin->part[k]);
    }
    sort_parts(rejoin);
    rejoin->part_count = rejoin->part[0].parts;
    rejoin->dim = rejoin->part[0].cells.dim;
    char widen[32];
    if (section_attribute(stream_find(&rejoin->part[0].stream, "part.node"), "widen", widen, sizeof widen)) {
        rejoin->widen = strtod(widen, NULL);
    }
    for (int64_t k = 1; k < rejoin->part_count; k++) {
        const char *const needed[] = {"facets", "sets.ptr", "points.x", "faces"};
        for (int i = 0; i < 4; i++) {
            bool here = stream_find(&rejoin->part[k].stream, needed[i]) != NULL;
            if (here != (stream_find(&rejoin->part[0].stream, needed[i]) != NULL)) {
                tool_fail(tool, STATUS_INPUT,
                          "%s: no section %s, but in %s: run the same stages on all parts",
                          rejoin->part[here ? 0 : k].file, needed[i], rejoin->part[here ? k : 0].file);
            }
        }
    }
    map_body(rejoin);
    find_edges(rejoin);
    map_listed(rejoin, ROWS_FACETS, "facets", "part.facet");
    map_listed(rejoin, ROWS_SETS, "sets.idx", "part.set");
    map_points(rejoin);
    if (stream_find(&rejoin->part[0].stream, "faces") != NULL) {
        rejoin_map_faces(rejoin);
    }
}

void rejoin_free(struct rejoin *rejoin)
{
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        for (int kind = 0; kind < ROWS_KINDS; kind++) {
            free(part->to[kind]);
        }
        free(part->at_edge);
        stream_free(&part->stream);
    }
    FREE_ALL(rejoin->part, rejoin->x, rejoin->cell);
    faces_free(&rejoin->faces);
}
