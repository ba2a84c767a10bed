#include "parts/parts_pack.h"

#include "process.h"

#include <stdlib.h>
#include <string.h>

/* Everything is packed in units of UNIT bytes, so that values are aligned; sent in units of UNIT_SENT. */
enum { UNIT = 8, UNIT_SENT = 64 };

/* A buffer to which bytes are appended; if `at` is NULL they are only counted. */
struct pack {
    char *at;
    size_t size;
};

static void pack_bytes(struct pack *pack, const void *bytes, size_t size)
{
    if (pack->at != NULL && size > 0) {
        memcpy(pack->at + pack->size, bytes, size);
    }
    pack->size += (size + UNIT - 1) / UNIT * UNIT;
}

static void pack_text(struct pack *pack, const char *text)
{
    pack_bytes(pack, text, strlen(text) + 1);
}

static size_t bytes_of(const struct section *section)
{
    return (size_t)(section->rows * section->cols) * element_size(section->type);
}

static void pack_stream(struct pack *pack, const struct stream *stream)
{
    const int64_t counts[] = {stream->provenance_count, stream->section_count};
    pack_bytes(pack, counts, sizeof counts);
    for (int64_t i = 0; i < stream->provenance_count; i++) {
        pack_text(pack, stream->provenance[i]);
    }
    for (int64_t i = 0; i < stream->section_count; i++) {
        const struct section *section = &stream->sections[i];
        bool large = rejoin_is_large(section->name);
        const int64_t shape[] = {(int64_t)section->type, large ? 0 : section->rows, section->cols};
        pack_bytes(pack, shape, sizeof shape);
        pack_text(pack, section->name);
        pack_text(pack, section->attributes);
        if (!large) {
            pack_bytes(pack, section->data, bytes_of(section));
        }
    }
}

/* The inverse of pack_bytes: the next `size` bytes, in place. */
static char *take(struct pack *pack, size_t size)
{
    char *bytes = pack->at + pack->size;
    pack->size += (size + UNIT - 1) / UNIT * UNIT;
    return bytes;
}

static char *take_text(struct pack *pack)
{
    return take(pack, strlen(pack->at + pack->size) + 1);
}

static enum status unpack_stream(struct pack *pack, struct stream *stream, struct error *error)
{
    int64_t counts[2], shape[3];
    stream_init(stream);
    memcpy(counts, take(pack, sizeof counts), sizeof counts);
    RETURN_IF_ERROR(NEW_ARRAY(&stream->provenance, counts[0], error));
    for (; stream->provenance_count < counts[0]; stream->provenance_count++) {
        stream->provenance[stream->provenance_count] = strdup(take_text(pack));
        if (stream->provenance[stream->provenance_count] == NULL) {
            return fail_memory(error, "provenance");
        }
    }
    for (int64_t i = 0; i < counts[1]; i++) {
        memcpy(shape, take(pack, sizeof shape), sizeof shape);
        const char *name = take_text(pack), *attributes = take_text(pack);
        enum element_type type = (enum element_type)shape[0];
        void *data = take(pack, (size_t)(shape[1] * shape[2]) * element_size(type));
        RETURN_IF_ERROR(stream_put(stream, name, type, shape[1], shape[2], attributes, data, false, error));
    }
    return STATUS_OK;
}

/* Pack the sections that this process has read; (*units)[count]: the size of each process's data. */
static enum status pack_own(const struct rejoin *rejoin, struct pack *own, int64_t **units,
                            struct error *error)
{
    *own = (struct pack){0};
    for (int pass = 0; pass < 2; pass++) {
        own->size = 0;
        for (int64_t k = 0; k < rejoin->part_count; k++) {
            if (!rejoin->part[k].elsewhere) {
                pack_stream(own, &rejoin->part[k].stream);
            }
        }
        if (pass == 0) {
            RETURN_IF_ERROR(NEW_ARRAY(&own->at, (int64_t)own->size, error));
        }
    }
    return ranks_list(process_ranks(), (int64_t)(own->size + UNIT_SENT - 1) / UNIT_SENT, units, error);
}

enum status parts_share_small(struct rejoin *rejoin, const int64_t *first, void **packed, struct error *error)
{
    enum status status = STATUS_OK;
    const struct ranks *ranks = process_ranks();
    struct pack own = {0}, all = {0};
    int64_t *units = NULL, *begin = NULL;
    *packed = NULL;
    if (ranks == NULL) {
        return STATUS_OK;
    }
    TRY(pack_own(rejoin, &own, &units, error));
    TRY(NEW_ARRAY(&begin, ranks->count + 1, error));
    for (int r = 0; r < ranks->count; r++) {
        begin[r + 1] = begin[r] + units[r];
    }
    TRY(NEW_ARRAY(&all.at, begin[ranks->count] * UNIT_SENT, error));
    *packed = all.at;
    memcpy(all.at + begin[ranks->rank] * UNIT_SENT, own.at, own.size);
    free(own.at);
    own.at = NULL;
    ranks_gather(ranks, all.at, UNIT_SENT, begin);
    for (int r = 0; r < ranks->count; r++) {
        all.size = (size_t)begin[r] * UNIT_SENT;
        for (int64_t k = first[r]; k < first[r + 1] && r != ranks->rank; k++) {
            TRY(unpack_stream(&all, &rejoin->part[k].stream, error));
        }
    }
done:
    FREE_ALL(own.at, units, begin);
    return status;
}
