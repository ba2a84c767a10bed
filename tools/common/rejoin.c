#include "rejoin.h"

#include "stages.h"

#include "approx/face_rows.h"
#include "approx/partition.h"

#include <stdlib.h>
#include <string.h>

static const char *file_of(const struct rejoin *rejoin, int64_t k)
{
    return rejoin->part[k].file;
}

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

/* Numbers in the whole, ascending, one for each row of `like`. */
static const int32_t *numbers(const struct rejoin *rejoin, const struct rejoin_part *part, const char *name,
                              int64_t rows, int64_t least, int64_t below, bool ascending)
{
    struct error error;
    const struct section *section;
    enum status status = stream_need(&part->stream, name, TYPE_I4, 1, "part", &section, &error);
    if (status != STATUS_OK) {
        tool_fail(rejoin->tool, status, "%s: %s", part->file, error.text);
    }
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

static void read_part(struct rejoin *rejoin, struct rejoin_part *part, const char *file)
{
    struct error error;
    tool_read(rejoin->tool, file, &part->stream);
    part->file = file;
    const struct section *node = stream_find(&part->stream, "part.node");
    if (node == NULL) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: no section part.node: not a part of a body", file);
    }
    part->number = attribute(rejoin, part, "part");
    part->parts = attribute(rejoin, part, "parts");
    if (!section_attribute(node, "cut", part->cut, sizeof part->cut)) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: part.node: no cut=: not written by part", file);
    }
    enum status status = stream_cells(&part->stream, true, &part->cells, &error);
    if (status != STATUS_OK) {
        tool_fail(rejoin->tool, status, "%s: %s", file, error.text);
    }
    part->node =
        numbers(rejoin, part, "part.node", part->cells.node_count, 0, attribute(rejoin, part, "nodes"), true);
    part->owner = numbers(rejoin, part, "part.owner", part->cells.node_count, 0, part->parts, false);
    part->cell =
        numbers(rejoin, part, "part.cell", part->cells.count, 0, attribute(rejoin, part, "cells"), true);
}

/* Of as many parts as there are to be, none is missing if none stands twice. */
static void check_numbers(const struct rejoin *rejoin)
{
    int64_t parts = rejoin->part[0].parts, number = 0;
    for (bool found = true; found && number < parts; number += found) {
        found = false;
        for (int64_t k = 0; k < rejoin->part_count && !found; k++) {
            found = rejoin->part[k].number == number;
        }
    }
    if (number < parts) {
        tool_fail(rejoin->tool, STATUS_INPUT, "part %lld of %lld is missing", (long long)number,
                  (long long)parts);
    }
}

/* Each part once, in the order of their numbers. */
static void sort_parts(struct rejoin *rejoin)
{
    const struct tool *tool = rejoin->tool;
    struct error error;
    struct rejoin_part *sorted, *first = &rejoin->part[0];
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        if (strcmp(part->cut, first->cut) != 0 || part->parts != first->parts ||
            attribute(rejoin, part, "nodes") != attribute(rejoin, first, "nodes") ||
            attribute(rejoin, part, "cells") != attribute(rejoin, first, "cells") ||
            part->cells.dim != first->cells.dim) {
            tool_fail(tool, STATUS_INPUT, "%s and %s are parts of different cuts: cut again", first->file,
                      part->file);
        }
        if (part->number >= part->parts) {
            tool_fail(tool, STATUS_INPUT, "%s: part.node: part %lld of %lld", part->file,
                      (long long)part->number, (long long)part->parts);
        }
    }
    check_numbers(rejoin);
    tool_check(tool, NEW_ARRAY(&sorted, first->parts, &error), &error);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        if (sorted[part->number].file != NULL) {
            tool_fail(tool, STATUS_INPUT, "%s and %s are the same part, %lld", sorted[part->number].file,
                      part->file, (long long)part->number);
        }
        sorted[part->number] = *part;
    }
    free(rejoin->part);
    rejoin->part = sorted;
}

static int32_t *new_rows(const struct rejoin *rejoin, struct rejoin_part *part, enum rows_of kind,
                         int64_t count)
{
    struct error error;
    tool_check(rejoin->tool, NEW_ARRAY(&part->to[kind], count, &error), &error);
    part->count[kind] = count;
    return part->to[kind];
}

/* Every row of the whole must come from one part. */
static void check_rows(const struct rejoin *rejoin, enum rows_of kind, const char *called)
{
    struct error error;
    bool *found;
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
    tool_check(rejoin->tool, NEW_ARRAY(&found, total, &error), &error);
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
    free(found);
}

/* Nodes and cells of the whole. */
static void map_body(struct rejoin *rejoin)
{
    struct error error;
    int vertices = rejoin->dim + 1;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *node = new_rows(rejoin, part, ROWS_NODES, part->cells.node_count);
        int32_t *cell = new_rows(rejoin, part, ROWS_CELLS, part->cells.count);
        for (int64_t i = 0; i < part->cells.node_count; i++) {
            node[i] = part->owner[i] == k ? part->node[i] : -1;
        }
        for (int64_t c = 0; c < part->cells.count; c++) {
            cell[c] = partition_cell_owner(&part->cells, c, part->owner) == k ? part->cell[c] : -1;
        }
    }
    rejoin->rows[ROWS_NODES] = attribute(rejoin, &rejoin->part[0], "nodes");
    rejoin->rows[ROWS_CELLS] = attribute(rejoin, &rejoin->part[0], "cells");
    check_rows(rejoin, ROWS_NODES, "part.node");
    check_rows(rejoin, ROWS_CELLS, "part.cell");
    tool_check(rejoin->tool, NEW_ARRAY(&rejoin->x, rejoin->rows[ROWS_NODES] * rejoin->dim, &error), &error);
    tool_check(rejoin->tool, NEW_ARRAY(&rejoin->cell, rejoin->rows[ROWS_CELLS] * vertices, &error), &error);
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

/* Nodes at which a part lacks cells: no list of what is its own may hold them. */
static void find_edges(struct rejoin *rejoin)
{
    struct error error;
    int vertices = rejoin->dim + 1;
    int32_t *degree;
    tool_check(rejoin->tool, NEW_ARRAY(&degree, rejoin->rows[ROWS_NODES], &error), &error);
    for (int64_t i = 0; i < rejoin->rows[ROWS_CELLS] * vertices; i++) {
        degree[rejoin->cell[i]]++;
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *here;
        tool_check(rejoin->tool, NEW_ARRAY(&here, part->cells.node_count, &error), &error);
        tool_check(rejoin->tool, NEW_ARRAY(&part->at_edge, part->cells.node_count, &error), &error);
        for (int64_t i = 0; i < part->cells.count * vertices; i++) {
            here[part->cells.node[i]]++;
        }
        for (int64_t i = 0; i < part->cells.node_count; i++) {
            part->at_edge[i] = here[i] < degree[part->node[i]];
        }
        free(here);
    }
    free(degree);
}

/* Facets and members of sets belong to the part that owns their first node. */
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
        int32_t *to = new_rows(rejoin, part, kind, section->rows);
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
    check_rows(rejoin, kind, name);
}

/* Integration points follow their cells. */
static void map_points(struct rejoin *rejoin)
{
    struct error error;
    int64_t *begin, cells = rejoin->rows[ROWS_CELLS];
    tool_check(rejoin->tool, NEW_ARRAY(&begin, cells + 2, &error), &error);
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t k = 0; k < rejoin->part_count; k++) {
            struct rejoin_part *part = &rejoin->part[k];
            const struct section *points = stream_find(&part->stream, "points.cell");
            if (points == NULL || points->type != TYPE_I4) {
                continue;
            }
            const int32_t *cell = points->data;
            int32_t *to =
                pass == 0 ? new_rows(rejoin, part, ROWS_POINTS, points->rows) : part->to[ROWS_POINTS];
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
    free(begin);
}

/* The face of the whole that is a part's face, whose first cell is its own; they have the same nodes in the
 * same order. */
static int64_t find_face(const struct rejoin *rejoin, const struct rejoin_part *part, const int64_t *begin,
                         const int32_t *face, int64_t local)
{
    int dim = rejoin->dim;
    int32_t cell = part->cell[part->faces.cell[2 * local]];
    for (int64_t i = begin[cell]; i < begin[cell + 1]; i++) {
        int same = 0;
        for (int a = 0; a < dim; a++) {
            same += rejoin->faces.node[(int64_t)face[i] * dim + a] ==
                    part->node[part->faces.node[local * dim + a]];
        }
        if (same == dim) {
            return face[i];
        }
    }
    tool_fail(rejoin->tool, STATUS_INPUT, "%s: faces: row %lld: not a face of the body: run ipoints again",
              part->file, (long long)local);
}

/* A row that faces share belongs to the part that owns the first of them, and its points with it. */
static void map_face_rows(struct rejoin *rejoin, struct rejoin_part *part, const int32_t *first_face)
{
    int rows = FACE_ROWS(rejoin->dim), per_face = OWN_POINTS(rejoin->dim);
    const struct faces *whole_faces = &rejoin->faces;
    const int32_t *face = part->to[ROWS_FACES];
    int64_t row_count = part->faces.row_count, point_count = face_row_point(&part->faces, row_count);
    int32_t *to = new_rows(rejoin, part, ROWS_OF_FACES, row_count);
    int32_t *points = new_rows(rejoin, part, ROWS_FACEPOINTS, point_count);
    int32_t *boundary = new_rows(rejoin, part, ROWS_BOUNDARY, part->faces.boundary_count * per_face);
    for (int64_t r = 0; r < row_count; r++) {
        to[r] = -1;
    }
    for (int64_t i = 0; i < part->faces.count * rows; i++) {
        int64_t whole = face[i / rows];
        int32_t row = whole < 0 ? -1 : (int32_t)face_row(&rejoin->faces, whole, (int)(i % rows));
        if (row >= 0 && face_has_own_row(whole_faces, whole) != face_has_own_row(&part->faces, i / rows)) {
            tool_fail(rejoin->tool, STATUS_INPUT,
                      "%s: faces.row: row %lld: at the edge of the halo: cut again with a wider one "
                      "(part -w, now %g)",
                      part->file, (long long)(i / rows), rejoin->widen);
        }
        if (row >= 0 && first_face[row] == whole) {
            to[face_row(&part->faces, i / rows, (int)(i % rows))] = row;
        }
    }
    for (int64_t r = 0; r < row_count; r++) {
        int64_t first = face_row_point(&part->faces, r);
        for (int64_t p = first; p < face_row_point(&part->faces, r + 1); p++) {
            points[p] = to[r] < 0 ? -1 : (int32_t)(face_row_point(whole_faces, to[r]) + p - first);
        }
    }
    for (int64_t i = 0; i < part->faces.boundary_count * per_face; i++) {
        boundary[i] = face[i / per_face] < 0 ? -1 : (int32_t)(face[i / per_face] * per_face + i % per_face);
    }
}

/* The side of each cell of the whole, for the caller to free; NULL where supports stop at no interfaces. */
static int32_t *whole_sides(const struct rejoin *rejoin)
{
    struct error error;
    int32_t *side = NULL;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const int32_t *of_part;
        tool_check(rejoin->tool, stage_sides(&part->stream, "support", &of_part, &error), &error);
        if (of_part != NULL && side == NULL) {
            tool_check(rejoin->tool, NEW_ARRAY(&side, rejoin->rows[ROWS_CELLS], &error), &error);
        }
        for (int64_t c = 0; of_part != NULL && c < part->cells.count; c++) {
            side[part->cell[c]] = of_part[c];
        }
    }
    return side;
}

static void map_faces(struct rejoin *rejoin)
{
    struct error error;
    int32_t *side = whole_sides(rejoin);
    const struct tool *tool = rejoin->tool;
    const struct section *points = stream_find(&rejoin->part[0].stream, "points.x");
    bool boundary_only = points != NULL && !points_are_smoothed(points);
    int64_t *begin;
    int32_t *face, *first_face;
    const struct cells whole = {.dim = rejoin->dim,
                                .node_count = rejoin->rows[ROWS_NODES],
                                .x = rejoin->x,
                                .count = rejoin->rows[ROWS_CELLS],
                                .node = rejoin->cell};
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        enum status status = stream_faces(&part->stream, &part->cells, &part->faces, &error);
        if (status != STATUS_OK) {
            tool_fail(tool, status, "%s: %s", part->file, error.text);
        }
    }
    tool_check(tool, faces_build(&whole, boundary_only, &rejoin->faces, &error), &error);
    if (side != NULL) {
        free(rejoin->faces.row);
        tool_check(tool, face_rows_number(whole.node_count, side, &rejoin->faces, &error), &error);
        free(side);
    }
    const struct faces *faces = &rejoin->faces;
    tool_check(tool, NEW_ARRAY(&begin, whole.count + 2, &error), &error);
    tool_check(tool, NEW_ARRAY(&face, faces->count, &error), &error);
    tool_check(tool, NEW_ARRAY(&first_face, faces->row_count, &error), &error);
    int rows = FACE_ROWS(rejoin->dim);
    for (int64_t i = faces->count * rows - 1; i >= 0; i--) {
        first_face[face_row(faces, i / rows, (int)(i % rows))] = (int32_t)(i / rows);
    }
    for (int64_t f = 0; f < faces->count; f++) {
        begin[faces->cell[2 * f] + 2]++;
    }
    for (int64_t c = 1; c <= whole.count; c++) {
        begin[c + 1] += begin[c];
    }
    for (int64_t f = 0; f < faces->count; f++) {
        face[begin[faces->cell[2 * f] + 1]++] = (int32_t)f;
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *to = new_rows(rejoin, part, ROWS_FACES, part->faces.count);
        for (int64_t f = 0; f < part->faces.count; f++) {
            bool own = part->to[ROWS_CELLS][part->faces.cell[2 * f]] >= 0;
            to[f] = own ? (int32_t)find_face(rejoin, part, begin, face, f) : -1;
        }
        map_face_rows(rejoin, part, first_face);
    }
    free(begin);
    free(face);
    free(first_face);
    rejoin->rows[ROWS_FACES] = faces->count;
    rejoin->rows[ROWS_OF_FACES] = faces->row_count;
    rejoin->rows[ROWS_FACEPOINTS] = face_row_point(faces, faces->row_count);
    rejoin->rows[ROWS_BOUNDARY] = faces->boundary_count * OWN_POINTS(rejoin->dim);
    check_rows(rejoin, ROWS_FACES, "faces");
    check_rows(rejoin, ROWS_OF_FACES, "faces.row");
}

void rejoin_begin(struct rejoin *rejoin, const struct tool *tool, char *const files[], int64_t count)
{
    struct error error;
    *rejoin = (struct rejoin){.tool = tool, .part_count = count};
    tool_check(tool, NEW_ARRAY(&rejoin->part, count, &error), &error);
    for (int64_t k = 0; k < count; k++) {
        read_part(rejoin, &rejoin->part[k], files[k]);
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
                          file_of(rejoin, here ? 0 : k), needed[i], file_of(rejoin, here ? k : 0));
            }
        }
    }
    map_body(rejoin);
    find_edges(rejoin);
    map_listed(rejoin, ROWS_FACETS, "facets", "part.facet");
    map_listed(rejoin, ROWS_SETS, "sets.idx", "part.set");
    map_points(rejoin);
    if (stream_find(&rejoin->part[0].stream, "faces") != NULL) {
        map_faces(rejoin);
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
    free(rejoin->part);
    free(rejoin->x);
    free(rejoin->cell);
    faces_free(&rejoin->faces);
}
