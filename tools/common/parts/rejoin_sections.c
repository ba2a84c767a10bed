/* The sections of the whole from the rows that the parts own, by the table of sections
 * (io/stream/sections.h). */
#include "parts/rejoin.h"

#include "approx/cells/face_edges.h"
#include "io/stream/sections.h"

#include <stdlib.h>
#include <string.h>

/* The names of the rows in the table of sections. */
static const char *const row_names[ROWS_KINDS] = {
    [ROWS_NODES] = "nodes.x",           [ROWS_CELLS] = "cells",
    [ROWS_FACETS] = "facets",           [ROWS_SETS] = "sets.idx",
    [ROWS_POINTS] = "points.x",         [ROWS_FACES] = "faces",
    [ROWS_OF_EDGES] = "edges",          [ROWS_FACEPOINTS] = "facepoints.x",
    [ROWS_BOUNDARY] = "boundary points"};

static enum rows_of rows_called(const char *name)
{
    int rows = 0;
    while (rows < ROWS_KINDS && (name == NULL || strcmp(row_names[rows], name) != 0)) {
        rows++;
    }
    return (enum rows_of)rows;
}

/* Lists of the parts, one for each of `rows`, and the start of each in the whole. */
struct joined_lists {
    char prefix[32];
    enum rows_of rows;
    struct neighbours *of; /* of each part */
    int64_t *ptr;          /* of the whole, rows + 1 */
};

static const char *member(const struct joined_lists *lists, const char *what, char name[64])
{
    snprintf(name, 64, "%s.%s", lists->prefix, what);
    return name;
}

static void lists_free(struct joined_lists *lists)
{
    FREE_ALL(lists->of, lists->ptr);
}

bool rejoin_is_large(const char *name)
{
    return strncmp(name, "edge.", 5) == 0;
}

/* ---- rows ---- */

/* The section of part k. Exits, naming the part, if it is missing or of another kind. */
static const struct section *section_of(const struct rejoin *rejoin, int64_t k, const char *name,
                                        const struct section *like)
{
    const struct section *section = stream_find(&rejoin->part[k].stream, name);
    bool same = section != NULL && section->type == like->type && section->cols == like->cols &&
                strcmp(section->attributes, like->attributes) == 0;
    if (!same) {
        tool_fail(rejoin->tool, STATUS_INPUT,
                  section == NULL ? "%s: no section %s, but in %s: run the same stages on all parts"
                                  : "%s: %s: not made as in %s: run the same stages on all parts",
                  rejoin->part[k].file, name, rejoin->part[0].file);
    }
    return section;
}

/* Turn numbers of nodes or cells of a part into those of the whole. */
static void renumber(const struct rejoin *rejoin, const struct rejoin_part *part,
                     const struct section_kind *kind, int32_t *value, int64_t count)
{
    bool nodes = strcmp(kind->index_of, "nodes.x") == 0;
    const int32_t *number = nodes ? part->node : part->cell;
    int64_t most = nodes ? part->cells.node_count : part->cells.count;
    for (int64_t i = 0; i < count; i++) {
        if (value[i] < 0 || value[i] >= most) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: index %d is out of range", part->file, kind->name,
                      value[i]);
        }
        value[i] = number[value[i]];
    }
}

/* Put a section that has a row for each of `rows`, or with lists for each of their entries. Parts without
 * such rows may lack it. */
static void put_rows(const struct rejoin *rejoin, struct stream *stream, const char *name, enum rows_of rows,
                     const struct joined_lists *lists)
{
    const struct section_kind *kind = section_kind_of(name);
    bool counts = kind->content == INDEX || kind->content == INDEX_OR_NONE;
    const struct section *first = NULL;
    for (int64_t k = 0; k < rejoin->part_count && first == NULL; k++) {
        first = stream_find(&rejoin->part[k].stream, name);
    }
    int64_t total = lists != NULL ? lists->ptr[rejoin->rows[rows]] : rejoin->rows[rows];
    size_t bytes = element_size(first->type) * (size_t)first->cols;
    char *data = tool_memory(rejoin->tool, array_new(total, bytes));
    if (counts && first->type != TYPE_I4) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: not of type i4", rejoin->part[0].file, name);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const int64_t *ptr = lists != NULL ? lists->of[k].ptr : NULL;
        int64_t count = lists != NULL ? lists->of[k].count : part->count[rows];
        int64_t expected = lists != NULL && count > 0 ? ptr[count] : count;
        if (expected == 0 && stream_find(&part->stream, name) == NULL) {
            continue;
        }
        const struct section *section = section_of(rejoin, k, name, first);
        if (part->elsewhere && rejoin_is_large(name)) {
            continue;
        }
        if (section->rows != expected) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: %lld rows, not %lld", part->file, name,
                      (long long)section->rows, (long long)expected);
        }
        for (int64_t i = 0; i < count; i++) {
            int64_t row = part->to[rows][i], from = ptr != NULL ? ptr[i] : i;
            int64_t length = ptr != NULL ? ptr[i + 1] - ptr[i] : 1;
            if (row < 0 || length == 0) {
                continue;
            }
            char *to = data + (size_t)(lists != NULL ? lists->ptr[row] : row) * bytes;
            memcpy(to, (const char *)section->data + (size_t)from * bytes, (size_t)length * bytes);
            if (counts) {
                renumber(rejoin, part, kind, (int32_t *)(void *)to, length * first->cols);
            }
        }
    }
    tool_put(rejoin->tool, stream, name, first->type, total, first->cols, first->attributes, data);
}

/* ---- lists ---- */

/* The lists of part k; none if they are large and elsewhere. Refuses an own list with a node at the edge of
 * the part, which may differ from that of the whole body. */
static enum status view_part(const struct rejoin *rejoin, int64_t k, struct joined_lists *lists,
                             struct error *error)
{
    char name[64];
    const struct rejoin_part *part = &rejoin->part[k];
    struct neighbours *of = &lists->of[k];
    *of = (struct neighbours){0};
    if (part->elsewhere && rejoin_is_large(member(lists, "ptr", name))) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(fail_in(error,
                            stream_neighbours(&part->stream, lists->prefix, part->count[lists->rows],
                                              part->cells.node_count, of, error),
                            "%s", part->file));
    for (int64_t r = 0; r < of->count; r++) {
        for (int64_t i = of->ptr[r]; i < of->ptr[r + 1] && part->to[lists->rows][r] >= 0; i++) {
            if (part->at_edge[of->idx[i]]) {
                return fail(error, STATUS_INPUT,
                            "%s: %s.idx: row %lld: a neighbour at the edge of the halo: cut again with a "
                            "wider one (part -w, now %g)",
                            part->file, lists->prefix, (long long)i, rejoin->widen);
            }
        }
    }
    return STATUS_OK;
}

/* Set the start of each list in the whole. */
static void join_lists(const struct rejoin *rejoin, struct joined_lists *lists)
{
    int64_t rows = rejoin->rows[lists->rows];
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&lists->ptr, rows + 1, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct neighbours *of = &lists->of[k];
        for (int64_t i = 0; i < of->count; i++) {
            int32_t to = rejoin->part[k].to[lists->rows][i];
            if (to >= 0) {
                lists->ptr[to + 1] = of->ptr[i + 1] - of->ptr[i];
            }
        }
    }
    for (int64_t i = 0; i < rows; i++) {
        lists->ptr[i + 1] += lists->ptr[i];
    }
}

/* View the lists of the section X.ptr or X.idx. */
static void view_lists(const struct rejoin *rejoin, const char *name, struct joined_lists *lists)
{
    char ptr[64];
    *lists = (struct joined_lists){.rows = ROWS_KINDS};
    snprintf(lists->prefix, sizeof lists->prefix, "%.*s", (int)strcspn(name, "."), name);
    lists->rows = rows_called(section_kind_of(member(lists, "ptr", ptr))->rows_of);
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&lists->of, rejoin->part_count, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        TOOL_TRY(rejoin->tool, view_part(rejoin, k, lists, &error));
    }
    join_lists(rejoin, lists);
}

enum status rejoin_check_large(const struct rejoin *rejoin, struct error *error)
{
    FREED_BY(lists_free) struct joined_lists lists = {.prefix = "edge", .rows = ROWS_OF_EDGES};
    RETURN_IF_ERROR(NEW_ARRAY(&lists.of, rejoin->part_count, error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *values = stream_find(&part->stream, "edge.phi");
        if (stream_find(&part->stream, "edge.ptr") == NULL || values == NULL) {
            continue; /* every process finds that out for itself */
        }
        RETURN_IF_ERROR(view_part(rejoin, k, &lists, error));
        if (!part->elsewhere && values->rows != lists.of[k].ptr[lists.of[k].count]) {
            return fail(error, STATUS_INPUT, "%s: edge.phi: does not fit edge.idx", part->file);
        }
    }
    return STATUS_OK;
}

/* Make lists of the pairs around corners in each list of each part; their idx is not set. */
static void list_around(const struct rejoin *rejoin, const struct neighbours *of, struct neighbours *around)
{
    int64_t *ptr, i = 0;
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&ptr, of->count + 1, &error));
    for (int64_t r = 0; r < of->count; r++) {
        while (i < of->around.count && of->around.pair[i] < of->ptr[r + 1]) {
            i++;
        }
        ptr[r + 1] = i;
    }
    *around = (struct neighbours){.count = of->count, .ptr = ptr};
}

/* Put X.around, the pairs that see each other around corners, and X.image. */
static void put_around(const struct rejoin *rejoin, struct stream *stream, const struct joined_lists *lists)
{
    char name[64];
    int64_t *pair;
    FREED_BY(lists_free) struct joined_lists around = *lists;
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&around.of, rejoin->part_count, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        list_around(rejoin, &lists->of[k], &around.of[k]);
    }
    join_lists(rejoin, &around);
    int64_t count = around.ptr[rejoin->rows[lists->rows]];
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&pair, count, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct neighbours *of = &lists->of[k];
        const int64_t *ptr = around.of[k].ptr;
        for (int64_t r = 0; r < of->count; r++) {
            int32_t to = rejoin->part[k].to[lists->rows][r];
            for (int64_t i = ptr[r]; i < ptr[r + 1] && to >= 0; i++) {
                pair[around.ptr[to] + i - ptr[r]] = lists->ptr[to] + of->around.pair[i] - of->ptr[r];
            }
        }
    }
    if (count > 0) {
        tool_put(rejoin->tool, stream, member(lists, "around", name), TYPE_I8, count, 1, "", pair);
        put_rows(rejoin, stream, member(lists, "image", name), lists->rows, &around);
    } else {
        free(pair);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        free((int64_t *)(uintptr_t)around.of[k].ptr);
    }
}

/* Put all sections of some lists, in the order in which support and shapefn write them. */
static void put_lists(const struct rejoin *rejoin, struct stream *stream, const struct section *ptr)
{
    char name[64];
    FREED_BY(lists_free) struct joined_lists lists = {0};
    view_lists(rejoin, ptr->name, &lists);
    TOOL_TRY(rejoin->tool, stream_put_copy(stream, ptr->name, TYPE_I8, rejoin->rows[lists.rows] + 1, 1,
                                           ptr->attributes, lists.ptr, &error));
    put_rows(rejoin, stream, member(&lists, "idx", name), lists.rows, &lists);
    if (stream_find(&rejoin->part[0].stream, member(&lists, "widen", name)) != NULL) {
        put_rows(rejoin, stream, name, lists.rows, NULL);
    }
    put_around(rejoin, stream, &lists);
}

/* Put a section with a row for each pair of lists that are already in the stream. */
static void put_pairs(const struct rejoin *rejoin, struct stream *stream, const char *name, const char *idx)
{
    FREED_BY(lists_free) struct joined_lists lists = {0};
    if (stream_find(stream, idx) == NULL) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s before %s", rejoin->part[0].file, name, idx);
    }
    view_lists(rejoin, idx, &lists);
    put_rows(rejoin, stream, name, lists.rows, &lists);
}

/* ---- sections made from the whole body ---- */

static bool put_faces(const struct rejoin *rejoin, struct stream *stream, const struct section *section)
{
    const struct faces *faces = &rejoin->faces;
    const struct {
        const char *name;
        int64_t cols;
        const int32_t *values;
    } made[] = {{"faces", rejoin->dim, faces->node},
                {"faces.cell", 2, faces->cell},
                {"faces.edge", FACE_EDGES(rejoin->dim), faces->edge}};
    for (int i = 0; i < 3; i++) {
        if (strcmp(made[i].name, section->name) == 0 && made[i].values != NULL) {
            TOOL_TRY(rejoin->tool, stream_put_copy(stream, section->name, TYPE_I4, faces->count, made[i].cols,
                                                   section->attributes, made[i].values, &error));
            return true;
        }
    }
    return false;
}

/* Put the ends of the sets, from the members that the parts own. */
static void put_sets(const struct rejoin *rejoin, struct stream *stream, const struct section *first)
{
    int64_t *ptr;
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&ptr, first->rows, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = section_of(rejoin, k, first->name, first);
        const int64_t *begin = section->data;
        if (section->type != TYPE_I8 || section->cols != 1 || section->rows != first->rows ||
            section->rows < 1 || begin[0] != 0 || begin[section->rows - 1] != part->count[ROWS_SETS]) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: sets.ptr: does not fit sets.idx", part->file);
        }
        for (int64_t s = 0; s + 1 < section->rows; s++) {
            for (int64_t i = begin[s]; i < begin[s + 1] && i < part->count[ROWS_SETS]; i++) {
                ptr[s + 1] += i >= 0 && part->to[ROWS_SETS][i] >= 0;
            }
        }
    }
    for (int64_t s = 0; s + 1 < first->rows; s++) {
        ptr[s + 1] += ptr[s];
    }
    tool_put(rejoin->tool, stream, first->name, TYPE_I8, first->rows, 1, first->attributes, ptr);
}

/* ---- all sections ---- */

/* Put one section of part 0, with the sections that belong to it; false if it cannot be joined. */
static bool put_section(const struct rejoin *rejoin, struct stream *stream, const struct section *section)
{
    const char *name = section->name;
    const struct section_kind *kind = section_kind_of(name);
    if (stream_find(stream, name) != NULL || strncmp(name, "part.", 5) == 0) {
        return true;
    }
    if (kind == NULL) {
        return false;
    }
    enum rows_of rows = rows_called(kind->rows_of != NULL ? kind->rows_of : kind->name);
    if (rows == ROWS_FACES) {
        return put_faces(rejoin, stream, section);
    }
    if (strcmp(name, "sets.ptr") == 0) {
        put_sets(rejoin, stream, section);
    } else if (kind->content == LIST) {
        put_lists(rejoin, stream, section);
    } else if (rows < ROWS_KINDS) {
        put_rows(rejoin, stream, name, rows, NULL);
    } else if (kind->rows_of != NULL && text_ends(kind->rows_of, ".idx")) {
        put_pairs(rejoin, stream, name, kind->rows_of);
    } else { /* pairs around corners that only other parts have */
        return text_ends(name, ".around") || text_ends(name, ".image");
    }
    return true;
}

void rejoin_sections(const struct rejoin *rejoin, struct stream *stream)
{
    char left_out[256] = "";
    const struct stream *first = &rejoin->part[0].stream;
    for (int64_t i = 0; i < first->section_count; i++) {
        if (!put_section(rejoin, stream, &first->sections[i])) {
            text_append(left_out, sizeof left_out, " %s", first->sections[i].name);
        }
    }
    if (left_out[0] != '\0') {
        tool_note(rejoin->tool, "left out:%s", left_out);
    }
}
