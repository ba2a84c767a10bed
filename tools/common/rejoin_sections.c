/* The sections of the whole from the rows that the parts own. */
#include "rejoin.h"

#include "approx/face_rows.h"

#include <stdlib.h>
#include <string.h>

/* What the values of a section count. */
enum values_of { VALUES_PLAIN, VALUES_NODES, VALUES_CELLS };

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

/* Lists of nodes (CSR), and the sections that have a row for each pair. */
static const struct {
    const char *prefix;
    enum rows_of rows;
    const char *following[2];
} lists[] = {
    {"nbr", ROWS_POINTS, {"shape.phi", "shape.dphi"}},
    {"facepoint", ROWS_FACEPOINTS, {NULL, NULL}},
    {"node", ROWS_NODES, {"node.phi", NULL}},
    {"face", ROWS_OF_FACES, {"face.phi", NULL}},
    {"boundary", ROWS_BOUNDARY, {"boundary.phi", NULL}},
};

/* The same section of each part; the message names the part where it is missing or another. */
static const struct section *section_of(const struct rejoin *rejoin, int64_t k, const char *name,
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

static void *new_rows(const struct rejoin *rejoin, const char *name, int64_t rows, size_t bytes)
{
    void *data = array_new(rows, bytes);
    if (data == NULL) {
        tool_fail(rejoin->tool, STATUS_SYSTEM, "%s: out of memory", name);
    }
    return data;
}

static void put(const struct rejoin *rejoin, struct stream *stream, const char *name, enum element_type type,
                int64_t rows, int64_t cols, const char *attributes, void *data)
{
    TOOL_TRY(rejoin->tool, stream_put(stream, name, type, rows, cols, attributes, data, true, &error));
}

/* Numbers of nodes or cells of a part become those of the whole. */
static void renumber(const struct rejoin *rejoin, const struct rejoin_part *part, const char *name,
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

static void put_table(const struct rejoin *rejoin, struct stream *stream, const char *name, enum rows_of rows,
                      enum values_of values)
{
    const struct section *first = section_of(rejoin, 0, name, NULL);
    size_t bytes = element_size(first->type) * (size_t)first->cols;
    char *data = new_rows(rejoin, name, rejoin->rows[rows], bytes);
    if (values != VALUES_PLAIN && first->type != TYPE_I4) {
        tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: not of type i4", rejoin->part[0].file, name);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = section_of(rejoin, k, name, first);
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
                renumber(rejoin, part, name, (int32_t *)(void *)to, first->cols, values);
            }
        }
    }
    put(rejoin, stream, name, first->type, rejoin->rows[rows], first->cols, first->attributes, data);
}

/* The lists of one prefix in all parts, checked, and where each of their rows begins in the whole. */
struct joined_lists {
    const char *prefix;
    enum rows_of rows;
    struct neighbours *of; /* of each part */
    int64_t *ptr;          /* of the whole, rows + 1; the stream's from put_lists on */
};

bool rejoin_is_large(const char *name)
{
    return strncmp(name, "face.", 5) == 0;
}

/* The lists of part k, none where these are large and elsewhere. A list that reaches where the part ends is
 * not that of the whole body. */
static enum status view_part(const struct rejoin *rejoin, int64_t k, const char *prefix, enum rows_of rows,
                             struct neighbours *of, struct error *error)
{
    char name[64];
    const struct rejoin_part *part = &rejoin->part[k];
    *of = (struct neighbours){0};
    snprintf(name, sizeof name, "%s.ptr", prefix);
    if (part->elsewhere && rejoin_is_large(name)) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(fail_in(
        error, stream_neighbours(&part->stream, prefix, part->count[rows], part->cells.node_count, of, error),
        "%s", part->file));
    for (int64_t r = 0; r < of->count; r++) {
        for (int64_t i = of->ptr[r]; i < of->ptr[r + 1] && part->to[rows][r] >= 0; i++) {
            if (part->at_edge[of->idx[i]]) {
                return fail(error, STATUS_INPUT,
                            "%s: %s.idx: row %lld: a neighbour at the edge of the halo: cut again with a "
                            "wider one (part -w, now %g)",
                            part->file, prefix, (long long)i, rejoin->widen);
            }
        }
    }
    return STATUS_OK;
}

enum status rejoin_check_large(const struct rejoin *rejoin, struct error *error)
{
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct neighbours of;
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *values = stream_find(&part->stream, "face.phi");
        if (stream_find(&part->stream, "face.ptr") == NULL || values == NULL) {
            continue; /* all find out alike */
        }
        RETURN_IF_ERROR(view_part(rejoin, k, "face", ROWS_OF_FACES, &of, error));
        if (!part->elsewhere && values->rows != of.ptr[of.count]) {
            return fail(error, STATUS_INPUT, "%s: face.phi: does not fit face.idx", part->file);
        }
    }
    return STATUS_OK;
}

static void view_lists(const struct rejoin *rejoin, struct joined_lists *joined)
{
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&joined->of, rejoin->part_count, &error));
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&joined->ptr, rejoin->rows[joined->rows] + 1, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        struct neighbours *of = &joined->of[k];
        TOOL_TRY(rejoin->tool, view_part(rejoin, k, joined->prefix, joined->rows, of, &error));
        for (int64_t i = 0; i < of->count; i++) {
            int32_t to = part->to[joined->rows][i];
            if (to >= 0) {
                joined->ptr[to + 1] = of->ptr[i + 1] - of->ptr[i];
            }
        }
    }
    for (int64_t i = 0; i < rejoin->rows[joined->rows]; i++) {
        joined->ptr[i + 1] += joined->ptr[i];
    }
}

/* A section with a row for each pair of the lists. */
static void put_pairs(const struct rejoin *rejoin, struct stream *stream, const struct joined_lists *joined,
                      const char *name, enum values_of values)
{
    const struct section *first = section_of(rejoin, 0, name, NULL);
    size_t bytes = element_size(first->type) * (size_t)first->cols;
    int64_t pairs = joined->ptr[rejoin->rows[joined->rows]];
    char *data = new_rows(rejoin, name, pairs, bytes);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct neighbours *of = &joined->of[k];
        const struct section *section = section_of(rejoin, k, name, first);
        if (part->elsewhere && rejoin_is_large(name)) {
            continue;
        }
        if (section->rows != of->ptr[of->count]) {
            tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s: does not fit %s.idx", part->file, name,
                      joined->prefix);
        }
        for (int64_t i = 0; i < of->count; i++) {
            int32_t row = part->to[joined->rows][i];
            int64_t count = of->ptr[i + 1] - of->ptr[i];
            if (row < 0 || count == 0) {
                continue;
            }
            char *to = data + (size_t)joined->ptr[row] * bytes;
            memcpy(to, (const char *)section->data + (size_t)of->ptr[i] * bytes, (size_t)count * bytes);
            if (values != VALUES_PLAIN) {
                renumber(rejoin, part, name, (int32_t *)(void *)to, count, values);
            }
        }
    }
    put(rejoin, stream, name, first->type, pairs, first->cols, first->attributes, data);
}

/* Neighbours around corners: the pair of the whole for one of a part, or -1. */
static int64_t pair_of(const struct rejoin_part *part, const struct joined_lists *joined,
                       const struct neighbours *of, int64_t around, int64_t *row)
{
    int64_t pair = of->around.pair[around];
    while (of->ptr[*row + 1] <= pair) {
        ++*row;
    }
    int32_t to = part->to[joined->rows][*row];
    return to < 0 ? -1 : joined->ptr[to] + pair - of->ptr[*row];
}

struct seen_around {
    int64_t pair;
    const double *offset;
};

static int by_pair(const void *a, const void *b)
{
    int64_t left = ((const struct seen_around *)a)->pair, right = ((const struct seen_around *)b)->pair;
    return (left > right) - (left < right);
}

static void put_around(const struct rejoin *rejoin, struct stream *stream, const struct joined_lists *joined)
{
    char name[64];
    const char *attributes = "";
    int64_t most = 0, count = 0, *pair;
    struct seen_around *seen;
    double *image;
    snprintf(name, sizeof name, "%s.image", joined->prefix);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct section *section = stream_find(&rejoin->part[k].stream, name);
        attributes = section != NULL ? section->attributes : attributes;
        most += joined->of[k].around.count;
    }
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&seen, most, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct neighbours *of = &joined->of[k];
        int64_t row = 0;
        for (int64_t i = 0; i < of->around.count; i++) {
            int64_t of_whole = pair_of(&rejoin->part[k], joined, of, i, &row);
            if (of_whole >= 0) {
                seen[count++] = (struct seen_around){of_whole, of->around.offset + i * rejoin->dim};
            }
        }
    }
    if (count > 0) {
        qsort(seen, (size_t)count, sizeof *seen, by_pair);
        TOOL_TRY(rejoin->tool, NEW_ARRAY(&pair, count, &error));
        TOOL_TRY(rejoin->tool, NEW_ARRAY(&image, count * rejoin->dim, &error));
        for (int64_t i = 0; i < count; i++) {
            pair[i] = seen[i].pair;
            memcpy(image + i * rejoin->dim, seen[i].offset, (size_t)rejoin->dim * sizeof *image);
        }
        put(rejoin, stream, name, TYPE_F8, count, rejoin->dim, attributes, image);
        /* In front of it, as support puts them. */
        struct section last = stream->sections[stream->section_count - 1];
        snprintf(name, sizeof name, "%s.around", joined->prefix);
        put(rejoin, stream, name, TYPE_I8, count, 1, "", pair);
        stream->sections[stream->section_count - 2] = stream->sections[stream->section_count - 1];
        stream->sections[stream->section_count - 1] = last;
    }
    free(seen);
}

/* All that belongs to lists of this prefix; in the order in which support and shapefn write it. */
static void put_lists(const struct rejoin *rejoin, struct stream *stream, size_t list)
{
    char name[64];
    struct joined_lists joined = {.prefix = lists[list].prefix, .rows = lists[list].rows};
    view_lists(rejoin, &joined);
    snprintf(name, sizeof name, "%s.ptr", joined.prefix);
    put(rejoin, stream, name, TYPE_I8, rejoin->rows[joined.rows] + 1, 1,
        section_of(rejoin, 0, name, NULL)->attributes, joined.ptr);
    snprintf(name, sizeof name, "%s.idx", joined.prefix);
    put_pairs(rejoin, stream, &joined, name, VALUES_NODES);
    snprintf(name, sizeof name, "%s.widen", joined.prefix);
    if (stream_find(&rejoin->part[0].stream, name) != NULL) {
        put_table(rejoin, stream, name, joined.rows, VALUES_PLAIN);
    }
    put_around(rejoin, stream, &joined);
    free(joined.of);
}

/* Sections that follow the pairs of lists, where those lists' ptr is in the stream already. */
static bool put_following(const struct rejoin *rejoin, struct stream *stream, const char *name)
{
    char ptr[64];
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++) {
        for (int f = 0; f < 2; f++) {
            if (lists[l].following[f] == NULL || strcmp(lists[l].following[f], name) != 0) {
                continue;
            }
            snprintf(ptr, sizeof ptr, "%s.ptr", lists[l].prefix);
            if (stream_find(stream, ptr) == NULL) {
                tool_fail(rejoin->tool, STATUS_INPUT, "%s: %s before %s", rejoin->part[0].file, name, ptr);
            }
            struct joined_lists joined = {.prefix = lists[l].prefix, .rows = lists[l].rows};
            view_lists(rejoin, &joined);
            put_pairs(rejoin, stream, &joined, name, VALUES_PLAIN);
            free(joined.of);
            free(joined.ptr);
            return true;
        }
    }
    return false;
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
                                                   section_of(rejoin, 0, name, NULL)->attributes,
                                                   sections[i].values, &error));
            return true;
        }
    }
    return false;
}

/* Where each set ends, from the members that the parts own. */
static void put_sets(const struct rejoin *rejoin, struct stream *stream)
{
    const struct section *first = section_of(rejoin, 0, "sets.ptr", NULL);
    int64_t *ptr;
    TOOL_TRY(rejoin->tool, NEW_ARRAY(&ptr, first->rows, &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct section *section = section_of(rejoin, k, "sets.ptr", first);
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
    put(rejoin, stream, "sets.ptr", TYPE_I8, first->rows, 1, first->attributes, ptr);
}

static bool is_called(const char *pattern, const char *name)
{
    size_t length = strlen(pattern);
    return pattern[length - 1] == '.' ? strncmp(name, pattern, length) == 0 : strcmp(name, pattern) == 0;
}

/* Put one section of part 0, with what goes with it; false if it is none that can be. */
static bool put_section(const struct rejoin *rejoin, struct stream *stream, const char *name)
{
    char ptr[64];
    if (stream_find(stream, name) != NULL || strncmp(name, "part.", 5) == 0) {
        return true;
    }
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++) {
        size_t length = strlen(lists[l].prefix);
        snprintf(ptr, sizeof ptr, "%s.ptr", lists[l].prefix);
        if (strcmp(name, ptr) == 0) {
            put_lists(rejoin, stream, l);
            return true;
        }
        if (strncmp(name, lists[l].prefix, length) == 0 &&
            (strcmp(name + length, ".around") == 0 || strcmp(name + length, ".image") == 0)) {
            return true; /* what is another part's only */
        }
    }
    if (strcmp(name, "sets.ptr") == 0) {
        put_sets(rejoin, stream);
        return true;
    }
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        if (is_called(tables[t].name, name)) {
            put_table(rejoin, stream, name, tables[t].rows, tables[t].values);
            return true;
        }
    }
    return put_faces(rejoin, stream, name) || put_following(rejoin, stream, name);
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
