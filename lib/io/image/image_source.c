#include "io/image/image_private.h"

#include "base/memory.h"
#include "io/files/descriptor.h"

#include <string.h>

/* Read more input if none is left. */
static enum status fill(struct image_source *source, struct error *error)
{
    size_t got;
    if (source->stream.avail_in > 0 || source->ended) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(descriptor_read(source->descriptor, source->buffer, sizeof source->buffer, &got, error));
    source->stream.next_in = source->buffer;
    source->stream.avail_in = (unsigned)got;
    source->ended = got == 0;
    return STATUS_OK;
}

enum status image_source_unpack(struct image_source *source, struct error *error)
{
    if (source->gzip) {
        return fail(error, STATUS_INPUT, "a compressed file with compressed data in it: decompress it first");
    }
    if (inflateInit2(&source->stream, 15 + 32) != Z_OK) {
        return fail_memory(error, "compressed image");
    }
    source->gzip = true;
    return STATUS_OK;
}

/* The first two bytes tell whether the file is compressed. */
enum status image_source_open(struct image_source *source, int descriptor, struct error *error)
{
    source->descriptor = descriptor;
    source->gzip = source->ended = source->complete = false;
    source->stream = (z_stream){0};
    source->taken = 0;
    RETURN_IF_ERROR(fill(source, error));
    if (source->stream.avail_in >= 2 && source->buffer[0] == 0x1f && source->buffer[1] == 0x8b) {
        return image_source_unpack(source, error);
    }
    return STATUS_OK;
}

void image_source_close(struct image_source *source)
{
    if (source->gzip) {
        inflateEnd(&source->stream);
    }
}

/* Decompress some of the input. */
static enum status inflate_some(struct image_source *source, struct error *error)
{
    long long before = (long long)source->taken;
    if (source->ended) {
        return fail(error, STATUS_INPUT, "compressed file cut short, behind byte %lld of its contents",
                    before);
    }
    if (source->complete) { /* another member follows */
        source->complete = false;
        inflateReset(&source->stream);
    }
    int code = inflate(&source->stream, Z_NO_FLUSH);
    if (code == Z_MEM_ERROR) {
        return fail_memory(error, "compressed image");
    }
    source->complete = code == Z_STREAM_END;
    return code == Z_OK || code == Z_BUF_ERROR || code == Z_STREAM_END
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "damaged gzip file (%s), behind byte %lld of its contents",
                      source->stream.msg != NULL ? source->stream.msg : "not one", before);
}

enum status image_source_take(struct image_source *source, void *bytes, size_t size, size_t *got,
                              struct error *error)
{
    z_stream *stream = &source->stream;
    enum status status = STATUS_OK;
    stream->next_out = bytes;
    stream->avail_out = (unsigned)size;
    while (stream->avail_out > 0) {
        TRY(fill(source, error));
        if (source->ended && (!source->gzip || source->complete)) {
            break;
        }
        if (source->gzip) {
            TRY(inflate_some(source, error));
            continue;
        }
        unsigned some = stream->avail_in < stream->avail_out ? stream->avail_in : stream->avail_out;
        memcpy(stream->next_out, stream->next_in, some);
        stream->next_in += some, stream->avail_in -= some;
        stream->next_out += some, stream->avail_out -= some;
    }
done:
    *got = size - stream->avail_out;
    source->taken += (int64_t)*got;
    return status;
}
