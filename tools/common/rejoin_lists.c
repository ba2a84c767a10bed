/* The lists of the whole, and what goes with their pairs, from the rows that the parts own. */
#include "rejoin_private.h"

#include <stdlib.h>
#include <string.h>

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
    const struct section *first = rejoin_section(rejoin, 0, name, NULL);
    size_t bytes = element_size(first->type) * (size_t)first->cols;
    int64_t pairs = joined->ptr[rejoin->rows[joined->rows]];
    char *data = rejoin_new_values(rejoin, name, pairs, bytes);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const struct neighbours *of = &joined->of[k];
        const struct section *section = rejoin_section(rejoin, k, name, first);
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
                rejoin_renumber(rejoin, part, name, (int32_t *)(void *)to, count, values);
            }
        }
    }
    rejoin_put(rejoin, stream, name, first->type, pairs, first->cols, first->attributes, data);
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
        rejoin_put(rejoin, stream, name, TYPE_F8, count, rejoin->dim, attributes, image);
        /* In front of it, as support puts them. */
        struct section last = stream->sections[stream->section_count - 1];
        snprintf(name, sizeof name, "%s.around", joined->prefix);
        rejoin_put(rejoin, stream, name, TYPE_I8, count, 1, "", pair);
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
    rejoin_put(rejoin, stream, name, TYPE_I8, rejoin->rows[joined.rows] + 1, 1,
               rejoin_section(rejoin, 0, name, NULL)->attributes, joined.ptr);
    snprintf(name, sizeof name, "%s.idx", joined.prefix);
    put_pairs(rejoin, stream, &joined, name, VALUES_NODES);
    snprintf(name, sizeof name, "%s.widen", joined.prefix);
    if (stream_find(&rejoin->part[0].stream, name) != NULL) {
        rejoin_put_table(rejoin, stream, name, joined.rows, VALUES_PLAIN);
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

bool rejoin_put_lists(const struct rejoin *rejoin, struct stream *stream, const char *name)
{
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++) {
        size_t length = strlen(lists[l].prefix);
        const char *member = strncmp(name, lists[l].prefix, length) == 0 ? name + length : "";
        if (strcmp(member, ".ptr") == 0) {
            put_lists(rejoin, stream, l);
            return true;
        }
        if (strcmp(member, ".around") == 0 || strcmp(member, ".image") == 0) {
            return true; /* what is another part's only */
        }
    }
    return put_following(rejoin, stream, name);
}
