#include "parts/parts_input.h"

#include "parts/parts_pack.h"
#include "process.h"
#include "parts/rejoin.h"

#include "io/checkpoint/checkpoint.h"

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

static enum status fail_missing(const char *file, int64_t number, int64_t count, struct error *error)
{
    return fail(error, STATUS_INPUT, "%s: part %lld of %lld is missing", file, (long long)number,
                (long long)count);
}

/* Read the file of part `number`. */
static enum status read_file(const char *file, int64_t number, int64_t count, struct stream *stream,
                             struct error *error)
{
    int descriptor = open(file, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 && errno == ENOENT && count > 0) {
        return fail_missing(file, number, count, error);
    }
    if (descriptor < 0) {
        return fail(error, STATUS_INPUT, "%s: %s", file, strerror(errno));
    }
    enum status status = stream_read(stream, descriptor, file, error);
    close(descriptor);
    return status;
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

/* Check that the last part stated in the header exists, before memory is allocated for all. */
static enum status look_for_last(const struct tool *tool, const char *operand, int64_t count,
                                 struct error *error)
{
    SCRATCH char *last = tool_numbered(tool, "", operand, count - 1);
    enum status status = STATUS_OK;
    if (access(last, F_OK) != 0) {
        status = errno == ENOENT ? fail_missing(last, count - 1, count, error)
                                 : fail(error, STATUS_INPUT, "%s: %s", last, strerror(errno));
    }
    return status;
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
        status = status == STATUS_OK ? look_for_last(tool, operand, count, &error) : status;
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
    SCRATCH uint32_t *each = NULL;
    TOOL_TRY(tool, NEW_ARRAY(&each, rejoin->part_count, &error));
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

void parts_read(const struct tool *tool, const char *operand, struct stream *stream,
                struct parts_input *parts)
{
    const struct ranks *ranks = process_ranks();
    FREED_BY(rejoin_free) struct rejoin rejoin = {.tool = tool};
    struct stream start = {0};
    SCRATCH int64_t *first = NULL;
    SCRATCH void *packed = NULL;
    *parts = (struct parts_input){.given = true};
    tool_names_input(operand);
    stream_init(stream);
    rejoin.part_count = begin(tool, operand, &start);
    TOOL_TRY(tool, NEW_ARRAY(&rejoin.part, rejoin.part_count, &error));
    TOOL_TRY(tool, ranks_share(ranks, rejoin.part_count, NULL, &first, &error));
    TOOL_TRY(tool, ranks_agree(ranks, read_own(&rejoin, operand, first, &start, &error), &error));
    parts->identity = identify(tool, &rejoin, first);
    TOOL_TRY(tool, parts_share_small(&rejoin, first, &packed, &error));
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
