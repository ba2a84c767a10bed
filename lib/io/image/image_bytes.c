#include "io/image/image_private.h"

#include "base/memory.h"
#include "io/files/descriptor.h"

#include <stdlib.h>
#include <string.h>

enum { STRIDE = 1 << 20 };

/* Append what `packed` holds, members of gzip or zlib up to the end. zlib's gzread is not used: it accepts a
 * file without its checksum if the data end with a block. */
static enum status inflate_all(const unsigned char *packed, size_t left, struct image_bytes *file,
                               struct error *error)
{
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)packed}; /* zlib's const */
    int64_t room = 0;
    int code = inflateInit2(&stream, 15 + 32);
    enum status status = code == Z_OK ? STATUS_OK : fail_memory(error, "compressed image");
    while (status == STATUS_OK && (left > 0 || stream.avail_in > 0)) {
        size_t some = stream.avail_in == 0 ? left < STRIDE ? left : STRIDE : 0;
        stream.avail_in += (unsigned)some;
        left -= some;
        if (code == Z_STREAM_END) { /* another member follows */
            inflateReset(&stream);
        }
        status = GROW_ARRAY(&file->bytes, (int64_t)file->size + STRIDE + ROOM_BEHIND, &room, error);
        if (status != STATUS_OK) {
            break;
        }
        stream.next_out = file->bytes + file->size;
        stream.avail_out = STRIDE;
        code = inflate(&stream, Z_NO_FLUSH);
        file->size += STRIDE - stream.avail_out;
        if (code == Z_MEM_ERROR) {
            status = fail_memory(error, "compressed image");
        } else if (code != Z_OK && code != Z_BUF_ERROR && code != Z_STREAM_END) {
            status = fail(error, STATUS_INPUT, "damaged gzip file (%s), behind byte %zu of its contents",
                          stream.msg != NULL ? stream.msg : "not one", file->size);
        }
    }
    inflateEnd(&stream);
    if (status == STATUS_OK && file->bytes != NULL) {
        memset(file->bytes + file->size, 0, ROOM_BEHIND);
    }
    return status != STATUS_OK || code == Z_STREAM_END
               ? status
               : fail(error, STATUS_INPUT, "compressed file cut short, behind byte %zu of its contents",
                      file->size);
}

enum status image_bytes_unpack(struct image_bytes *file, struct error *error)
{
    struct image_bytes unpacked = {.was_packed = true};
    enum status status = inflate_all(file->bytes + file->at, file->size - file->at, &unpacked, error);
    free(file->bytes);
    *file = unpacked;
    return status;
}

static bool is_packed(const unsigned char *bytes, size_t size)
{
    return size >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

static bool goes_on(const char *text, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)text;
    bool swapped;
    return is_packed(bytes, size) || memcmp(bytes, "NRRD", 4) == 0 || metaimage_begins(bytes) ||
           nifti_version(bytes, &swapped) > 0;
}

enum status image_bytes_read(int descriptor, bool any, struct image_bytes *file, struct error *error)
{
    RETURN_IF_ERROR(descriptor_read_all(descriptor, SIZE_MAX, any ? NULL : goes_on, (char **)&file->bytes,
                                        &file->size, error));
    return is_packed(file->bytes, file->size) ? image_bytes_unpack(file, error) : STATUS_OK;
}

void image_bytes_free(struct image_bytes *file)
{
    free(file->bytes);
    *file = (struct image_bytes){0};
}
