/* The sections of the whole from the rows that the parts own. */
#include "rejoin_private.h"

#include "approx/face_rows.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name; /* with a dot at its end: and all that begins so */
    enum rows_of rows;
    enum values_of values;
} tables[] = {
    {"nodes.x", ROWS_NODES, VALUES_PLAIN},           {"cells", ROWS_CELLS, VALUES_NODES},
    {"cells.region", ROWS_CELLS, VALUES_PLAIN},      {"facets", ROWS_FACETS, VALUES_NODES},
    {"facets.set", ROWS_FACETS, VALUES_PLAIN},       {"sets.idx", ROWS_SETS, VALUES_NODES},
    {"points.x", ROWS_POINTS, VALUES_PLAIN},         {"points.weight", ROWS_POINTS, VALUES_PLAIN},
    {"points.cell", ROWS_POINTS, VALUES_CELLS},      {"facepoints.x", ROWS_FACEPOINTS, VALUES_PLAIN},
    {"support.radius", ROWS_NODES, VALUES_PLAIN},    {"support.side", ROWS_CELLS, VALUES_PLAIN},
    {"nbr.widen", ROWS_POINTS, VALUES_PLAIN},        {"facepoint.widen", ROWS_FACEPOINTS, VALUES_PLAIN},
    {"node.widen", ROWS_NODES, VALUES_PLAIN},        {"u", ROWS_NODES, VALUES_PLAIN},
    {"u.frame.", ROWS_NODES, VALUES_PLAIN},          {"parameters", ROWS_NODES, VALUES_PLAIN},
    {"parameters.radius", ROWS_NODES, VALUES_PLAIN}, {"parameters.side", ROWS_CELLS, VALUES_PLAIN},
    {"parameters.frame.", ROWS_NODES, VALUES_PLAIN}, {"stress", ROWS_POINTS, VALUES_PLAIN},
    {"strain", ROWS_POINTS, VALUES_PLAIN},           {"pressure", ROWS_POINTS, VALUES_PLAIN},
    {"volume_ratio", ROWS_POINTS, VALUES_PLAIN},
};

const struct section *rejoin_section(const struct rejoin *rejoin, int64_t k, const char *name,
                                     const struct section *like)
{
    const struct section *section = stream_find(&rejoin->part[k].stream, name);
    if (section == NULL) {
        tool_fail(rejoin->tool, STATUS_INPUT,
                  "%s: no section %s, but in %s: run the same stages on all parts", rejoin->part[k].file,
                  name, rejoin->part[0].file);
    }
    if (like != NULL && (section->type != like->type || section->cols != like->cols ||
                         strcmp(section->attributes, like->attributes) != 0)) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: not made as in %s: run the same stages on all parts",
                  rejoin->part[k].file, name, rejoin->part[0].file);
    }
    return section;
}

void *rejoin_new_values(const struct rejoin *rejoin, const char *name, int64_t rows, size_t bytes)
{
    void *data = array_new(rows, bytes);
    if (data == NULL) {
        tool_fail(rejoin->tool, STATUS_SYSTEM, "%s: out of memory", name);
    }
    return data;
}

void rejoin_put(const struct rejoin *rejoin, struct stream *stream, const char *name, enum element_type type,
                int64_t rows, int64_t cols, const char *attributes, void *data)
{
    TOOL_TRY(rejoin->tool, stream_put(stream, name, type, rows, cols, attributes, data, true, &error));
}

void rejoin_renumber(const struct rejoin *rejoin, const struct rejoin_part *part, const char *name,
                     int32_t *value, int64_t count, enum values_of values)
{
    const int32_t *number = values == VALUES_NODES ? part->node : part->cell;
    int64_t most = values == VALUES_NODES ? part->cells.node_count : part->cells.count;
    for (int64_t i = 0; i < count; i++) {
        if (value[i] < 0 || value[i] >= most) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: index %d is out of range", part->file, name,
                      value[i]);
        }
        value[i] = number[value[i]];
    }
}

void rejoin_put_table(const struct rejoin *rejoin, struct stream *stream, const char *name, enum rows_of rows,
                      enum values_of values)
{
    const struct section *first = rejoin_section(rejoin, 0, name, NULL);
    size_t bytes = element_size(first->type) * (size_t)first->cols;
    char *data = rejoin_new_values(rejoin, name, rejoin->rows[rows], bytes);
    if (values != VALUES_PLAIN && first->type != TYPE_I4) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: not of type i4", rejoin->part[0].file, name);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = rejoin_section(rejoin, k, name, first);
        if (section->rows != part->count[rows]) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: %lld rows, not %lld", part->file, name,
                      (long long)section->rows, (long long)part->count[rows]);
        }
        for (int64_t i = 0; i < section->rows; i++) {
            if (part->to[rows][i] < 0) {
                continue;
            }
            char *to = data + (size_t)part->to[rows][i] * bytes;
            memcpy(to, (const char *)section->data + (size_t)i * bytes, bytes);
            if (values != VALUES_PLAIN) {
                rejoin_renumber(rejoin, part, name, (int32_t *)(void *)to, first->cols, values);
            }
        }
    }
    rejoin_put(rejoin, stream, name, first->type, rejoin->rows[rows], first->cols, first->attributes, data);
}

/* Faces come from the whole body. */
static bool put_faces(const struct rejoin *rejoin, struct stream *stream, const char *name)
{
    const struct faces *faces = &rejoin->faces;
    const struct {
        const char *name;
        int64_t cols;
        const int32_t *values;
    } sections[] = {{"faces", rejoin->dim, faces->node},
                    {"faces.cell", 2, faces->cell},
                    {"faces.row", FACE_ROWS(rejoin->dim), faces->row}};
    for (int i = 0; i < 3; i++) {
        if (strcmp(sections[i].name, name) == 0 && sections[i].values != NULL) {
            TOOL_TRY(rejoin->tool, stream_put_copy(stream, name, TYPE_I4, faces->count, sections[i].cols,
                                                   rejoin_section(rejoin, 0, name, NULL)->attributes,
                                                   sections[i].values, &error));
            return true;
        }
    }
    return false;
}

/* Where each set ends, from the members that the parts own. */
static void put_sets(const struct rejoin *rejoin, struct stream *stream)
{
    const struct section *first = rejoin_section(rejoin, 0, "sets.ptr", NULL);
    int64_t *ptr;
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&ptr, first->rows, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = rejoin_section(rejoin, k, "sets.ptr", first);
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
    rejoin_put(rejoin, stream, "sets.ptr", TYPE_I8, first->rows, 1, first->attributes, ptr);
}

static bool is_called(const char *pattern, const char *name)
{
    size_t length = strlen(pattern);
    return pattern[length - 1] == '.' ? strncmp(name, pattern, length) == 0 : strcmp(name, pattern) == 0;
}

/* Put one section of part 0, with what goes with it; false if it is none that can be. */
static bool put_section(const struct rejoin *rejoin, struct stream *stream, const char *name)
{
    if (stream_find(stream, name) != NULL || strncmp(name, "part.", 5) == 0 ||
        rejoin_put_lists(rejoin, stream, name)) {
        return true;
    }
    if (strcmp(name, "sets.ptr") == 0) {
        put_sets(rejoin, stream);
        return true;
    }
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        if (is_called(tables[t].name, name)) {
            rejoin_put_table(rejoin, stream, name, tables[t].rows, tables[t].values);
            return true;
        }
    }
    return put_faces(rejoin, stream, name);
}

void rejoin_sections(const struct rejoin *rejoin, struct stream *stream)
{
    char left_out[256] = "";
    const struct stream *first = &rejoin->part[0].stream;
    for (int64_t i = 0; i < first->section_count; i++) {
        if (!put_section(rejoin, stream, first->sections[i].name)) {
            text_append(left_out, sizeof left_out, " %s", first->sections[i].name);
        }
    }
    if (left_out[0] != '\0') {
        tool_note(rejoin->tool, "left out:%s", left_out);
    }
}
