#include "parts/parts_input.h"

#include "process.h"
#include "parts/rejoin.h"

#include "io/checkpoint/checkpoint.h"
#include "io/files/descriptor.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static const int64_t most_parts = 1000000;

bool parts_are_named(const char *operand)
{
    return operand != NULL && strstr(operand, "%d") != NULL;
}

/* Open the file of part `number`; count: of parts, 0: not known yet. */
static enum status open_part(const char *file, int64_t number, int64_t count, int *descriptor,
                             struct error *error)
{
    *descriptor = open(file, O_RDONLY | O_CLOEXEC);
    if (*descriptor < 0 && errno == ENOENT && count > 0) {
        return fail(error, STATUS_INPUT, "%s: part %lld of %lld is missing", file, (long long)number,
                    (long long)count);
    }
    return *descriptor < 0 ? fail(error, STATUS_INPUT, "%s: %s", file, strerror(errno)) : STATUS_OK;
}

static enum status read_file(const char *file, int64_t number, int64_t count, struct stream *stream,
                             struct error *error)
{
    FREED_BY(descriptor_close) int descriptor = -1;
    RETURN_IF_ERROR(open_part(file, number, count, &descriptor, error));
    return stream_read(stream, descriptor, file, error);
}

/* *count: number of parts, from the first part. */
static enum status count_parts(const char *file, const struct stream *stream, int64_t *count,
                               struct error *error)
{
    char value[64];
    const struct section *node = stream_find(stream, "part.node");
    if (node == NULL || !section_attribute(node, "parts", value, sizeof value)) {
        return fail(error, STATUS_INPUT, "%s: no section part.node: not a part of a body", file);
    }
    return fail_in(error, parse_integer(value, "part.node: parts", 1, most_parts, count, error), "%s", file);
}

/* Let the first process read the first part; all processes get the number of parts. */
static int64_t begin(const struct tool *tool, const char *operand, struct stream *stream)
{
    struct error error;
    enum status status = STATUS_OK;
    const struct ranks *ranks = process_ranks();
    int64_t count = 0;
    if (ranks_rank(ranks) == 0) {
        SCRATCH char *file = tool_numbered(tool, "", operand, 0);
        status = read_file(file, 0, 0, stream, &error);
        status = status == STATUS_OK ? count_parts(file, stream, &count, &error) : status;
        if (status == STATUS_OK) { /* before memory is allocated for so many parts */
            FREED_BY(descriptor_close) int last = -1;
            SCRATCH char *last_file = tool_numbered(tool, "", operand, count - 1);
            status = open_part(last_file, count - 1, count, &last, &error);
        }
    }
    tool_check(tool, ranks_agree(ranks, status, &error), &error);
    count = ranks_most(ranks, count);
    if (ranks_count(ranks) > count) {
        tool_fail(tool, STATUS_INPUT,
                  "%d processes for %lld parts: take fewer (mpirun -n), or cut more parts",
                  ranks_count(ranks), (long long)count);
    }
    return count;
}

/* A checksum of the checksums of all parts. */
static uint32_t identify(const struct tool *tool, const struct rejoin *rejoin, const int64_t *first)
{
    TOOL_SCRATCH(tool, uint32_t, each, rejoin->part_count);
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        each[k] = rejoin->part[k].elsewhere ? 0 : checkpoint_identify_input(&rejoin->part[k].stream);
    }
    ranks_gather(process_ranks(), each, sizeof *each, first);
    uLong crc = crc32_z(0, (const Bytef *)each, (size_t)rejoin->part_count * sizeof *each);
    return (uint32_t)crc;
}

/* For each row of edges, the process that has read it: that of the part that owns the row. */
static void list_readers(const struct tool *tool, const struct rejoin *rejoin, const int64_t *first,
                         struct parts_input *parts)
{
    const struct ranks *ranks = process_ranks();
    TOOL_TRY(tool, NEW_ARRAY(&parts->edge_reader, rejoin->rows[ROWS_OF_EDGES], &error));
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        for (int64_t f = 0; f < part->count[ROWS_OF_EDGES]; f++) {
            if (part->to[ROWS_OF_EDGES][f] >= 0) {
                parts->edge_reader[part->to[ROWS_OF_EDGES][f]] = ranks_owner(ranks, first, part->read_as);
            }
        }
    }
}

/* Read the files of this process's parts; the first part is in *start. */
static enum status read_own(struct rejoin *rejoin, const char *operand, const int64_t *first,
                            const struct stream *start, struct error *error)
{
    enum status status = STATUS_OK;
    const struct ranks *ranks = process_ranks();
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        part->file = tool_numbered(rejoin->tool, "", operand, k);
        part->read_as = k;
        part->elsewhere = ranks_owner(ranks, first, k) != ranks_rank(ranks);
        if (k == 0 && !part->elsewhere) {
            part->stream = *start;
        } else if (!part->elsewhere && status == STATUS_OK) {
            status = read_file(part->file, k, rejoin->part_count, &part->stream, error);
        }
    }
    return status;
}

/* ---- exchange of the small sections of the parts, so that all processes have them ---- */

/* Everything is packed in units of UNIT bytes, so that values are aligned; sent in units of UNIT_SENT. */
enum { UNIT = 8, UNIT_SENT = 64 };

static void pack(FILE *file, const void *bytes, size_t size)
{
    static const char zeros[UNIT];
    fwrite(bytes, 1, size, file);
    fwrite(zeros, 1, (UNIT - size % UNIT) % UNIT, file);
}

static void pack_text(FILE *file, const char *text)
{
    pack(file, text, strlen(text) + 1);
}

/* Pack provenance and sections, large tables without rows. */
static void pack_stream(FILE *file, const struct stream *stream)
{
    const int64_t counts[] = {stream->provenance_count, stream->section_count};
    pack(file, counts, sizeof counts);
    for (int64_t i = 0; i < stream->provenance_count; i++) {
        pack_text(file, stream->provenance[i]);
    }
    for (int64_t i = 0; i < stream->section_count; i++) {
        const struct section *section = &stream->sections[i];
        int64_t rows = rejoin_is_large(section->name) ? 0 : section->rows;
        const int64_t shape[] = {(int64_t)section->type, rows, section->cols};
        pack(file, shape, sizeof shape);
        pack_text(file, section->name);
        pack_text(file, section->attributes);
        pack(file, section->data, (size_t)(rows * section->cols) * element_size(section->type));
    }
}

/* The inverse of pack(): the next `size` bytes, in place. */
static char *take(char **at, size_t size)
{
    char *bytes = *at;
    *at += (size + UNIT - 1) / UNIT * UNIT;
    return bytes;
}

static char *take_text(char **at)
{
    return take(at, strlen(*at) + 1);
}

static enum status unpack_stream(char **at, struct stream *stream, struct error *error)
{
    int64_t counts[2], shape[3];
    memcpy(counts, take(at, sizeof counts), sizeof counts);
    RETURN_IF_ERROR(NEW_ARRAY(&stream->provenance, counts[0], error));
    for (; stream->provenance_count < counts[0]; stream->provenance_count++) {
        stream->provenance[stream->provenance_count] = strdup(take_text(at));
        if (stream->provenance[stream->provenance_count] == NULL) {
            return fail_memory(error, "provenance");
        }
    }
    for (int64_t i = 0; i < counts[1]; i++) {
        memcpy(shape, take(at, sizeof shape), sizeof shape);
        const char *name = take_text(at), *attributes = take_text(at);
        enum element_type type = (enum element_type)shape[0];
        void *data = take(at, (size_t)(shape[1] * shape[2]) * element_size(type));
        RETURN_IF_ERROR(stream_put(stream, name, type, shape[1], shape[2], attributes, data, false, error));
    }
    return STATUS_OK;
}

/* Set the streams of parts that other processes have read. Process r has the parts from first[r] to before
 * first[r + 1]. Collective. *packed holds the data of these streams, to be freed after them. */
static enum status share_small(struct rejoin *rejoin, const int64_t *first, char **packed,
                               struct error *error)
{
    const struct ranks *ranks = process_ranks();
    SCRATCH char *own = NULL;
    SCRATCH int64_t *units = NULL;
    size_t size;
    if (ranks == NULL) {
        return STATUS_OK;
    }
    FILE *file = open_memstream(&own, &size);
    for (int64_t k = first[ranks->rank]; k < first[ranks->rank + 1] && file != NULL; k++) {
        pack_stream(file, &rejoin->part[k].stream);
    }
    if (file == NULL || fclose(file) != 0) {
        return fail_memory(error, "parts");
    }
    RETURN_IF_ERROR(ranks_list(ranks, (int64_t)(size + UNIT_SENT - 1) / UNIT_SENT, &units, error));
    NEW_SCRATCH(int64_t, begin, ranks->count + 1, error);
    for (int r = 0; r < ranks->count; r++) {
        begin[r + 1] = begin[r] + units[r];
    }
    RETURN_IF_ERROR(NEW_ARRAY(packed, begin[ranks->count] * UNIT_SENT, error));
    memcpy(*packed + begin[ranks->rank] * UNIT_SENT, own, size);
    ranks_gather(ranks, *packed, UNIT_SENT, begin);
    for (int r = 0; r < ranks->count; r++) {
        char *at = *packed + begin[r] * UNIT_SENT;
        for (int64_t k = first[r]; k < first[r + 1] && r != ranks->rank; k++) {
            RETURN_IF_ERROR(unpack_stream(&at, &rejoin->part[k].stream, error));
        }
    }
    return STATUS_OK;
}

void parts_read(const struct tool *tool, const char *operand, struct stream *stream,
                struct parts_input *parts)
{
    const struct ranks *ranks = process_ranks();
    FREED_BY(rejoin_free) struct rejoin rejoin = {.tool = tool};
    struct stream start = {0};
    SCRATCH int64_t *first = NULL;
    SCRATCH char *packed = NULL;
    *parts = (struct parts_input){.given = true};
    tool_names_input(operand);
    rejoin.part_count = begin(tool, operand, &start);
    TOOL_TRY(tool, NEW_ARRAY(&rejoin.part, rejoin.part_count, &error));
    TOOL_TRY(tool, ranks_share(ranks, rejoin.part_count, NULL, &first, &error));
    TOOL_TRY(tool, ranks_agree(ranks, read_own(&rejoin, operand, first, &start, &error), &error));
    parts->identity = identify(tool, &rejoin, first);
    TOOL_TRY(tool, share_small(&rejoin, first, &packed, &error));
    rejoin_streams(&rejoin);
    TOOL_TRY(tool, ranks_agree(ranks, rejoin_check_large(&rejoin, &error), &error));
    rejoin_sections(&rejoin, stream);
    if (ranks != NULL && stream_find(stream, "edge.ptr") != NULL) {
        list_readers(tool, &rejoin, first, parts);
    }
    stream_inherit(stream, &rejoin.part[0].stream); /* how the first part was made */
    for (int64_t k = 0; k < rejoin.part_count; k++) {
        free((char *)rejoin.part[k].file);
    }
}

void parts_free(struct parts_input *parts)
{
    free(parts->edge_reader);
    *parts = (struct parts_input){0};
}
