/* Writing NIfTI files. Blocks are compressed in parallel, each with the data before it as its dictionary; the
 * bytes are the same for any number of threads. */
#include "io/image/image_private.h"

#include "base/memory.h"
#include "io/files/descriptor.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

enum { BLOCK = 1 << 20, DICTIONARY = 1 << 15, LEVEL = 6 };

void image_range(const struct image *image, double *least, double *most)
{
    const struct nifti_type *type = nifti_type(image->datatype);
    bool whole = type->most > type->least, scaled = type->components == 1;
    double ends[2] = {whole                         ? type->least
                      : type->code == IMAGE_FLOAT32 ? -FLT_MAX
                                                    : -DBL_MAX,
                      whole                         ? type->most
                      : type->code == IMAGE_FLOAT32 ? FLT_MAX
                                                    : DBL_MAX};
    for (int i = 0; i < 2 && scaled; i++) {
        ends[i] = fmax(fmin(ends[i] * image->slope + image->inter, DBL_MAX), -DBL_MAX);
    }
    *least = fmin(ends[0], ends[1]);
    *most = fmax(ends[0], ends[1]);
}

/* Store all values, in the order of the file. */
static void store_values(const struct image *image, const struct nifti_type *type, unsigned char *bytes)
{
    int64_t voxels = (int64_t)image_voxels(image), components = (int64_t)image->components;
    bool together = type->components > 1, scaled = !together && (image->slope != 1 || image->inter != 0);
#pragma omp parallel for schedule(static)
    for (int64_t v = 0; v < voxels; v++) {
        for (int64_t c = 0; c < components; c++) {
            double value = image->values[v * components + c];
            int64_t at = together ? v * components + c : c * voxels + v;
            nifti_put(type, scaled ? (value - image->inter) / image->slope : value, bytes + at * type->bytes);
        }
    }
}

/* Compress one block, from `begin` of bytes, as a part of a deflate stream that begins and ends at a byte. */
static bool compress_block(const unsigned char *bytes, size_t begin, size_t size, bool last,
                           unsigned char *to, size_t room, size_t *used)
{
    z_stream stream = {0};
    if (deflateInit2(&stream, LEVEL, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        return false;
    }
    size_t before = begin < DICTIONARY ? begin : DICTIONARY;
    bool good =
        before == 0 || deflateSetDictionary(&stream, bytes + begin - before, (unsigned)before) == Z_OK;
    stream.next_in = (unsigned char *)(uintptr_t)(bytes + begin); /* zlib's const */
    stream.avail_in = (unsigned)size;
    stream.next_out = to;
    stream.avail_out = (unsigned)room;
    int code = good ? deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH) : Z_MEM_ERROR;
    good = code == (last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
    *used = room - stream.avail_out;
    deflateEnd(&stream);
    return good;
}

static void put_little_endian(unsigned char *bytes, uint32_t value)
{
    for (int b = 0; b < 4; b++) {
        bytes[b] = (unsigned char)(value >> (8 * b));
    }
}

/* Write a gzip file of one member, without name and time. */
static enum status write_gzip(const unsigned char *bytes, size_t size, int descriptor, struct error *error)
{
    static const unsigned char head[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3};
    unsigned char tail[8];
    int64_t blocks = (int64_t)((size + BLOCK - 1) / BLOCK);
    size_t room = compressBound(BLOCK) + 64;
    SCRATCH size_t *used = NULL;
    SCRATCH unsigned char *packed = NULL;
    bool good = true;
    RETURN_IF_ERROR(NEW_ARRAY(&used, blocks, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&packed, blocks * (int64_t)room, error));
#pragma omp parallel for schedule(dynamic) reduction(&& : good)
    for (int64_t b = 0; b < blocks; b++) {
        size_t begin = (size_t)b * BLOCK, length = size - begin < BLOCK ? size - begin : BLOCK;
        good = compress_block(bytes, begin, length, b == blocks - 1, packed + (size_t)b * room, room,
                              &used[b]) &&
               good;
    }
    if (!good) {
        return fail_memory(error, "compressed image");
    }
    RETURN_IF_ERROR(descriptor_write(descriptor, head, sizeof head, error));
    for (int64_t b = 0; b < blocks; b++) {
        RETURN_IF_ERROR(descriptor_write(descriptor, packed + (size_t)b * room, used[b], error));
    }
    put_little_endian(tail, (uint32_t)crc32_z(0, bytes, size));
    put_little_endian(tail + 4, (uint32_t)size);
    return descriptor_write(descriptor, tail, sizeof tail, error);
}

enum status image_write(const struct image *image, int descriptor, bool gzip, struct error *error)
{
    const struct nifti_type *type = nifti_type(image->datatype);
    unsigned char header[NIFTI2_HEADER + 4];
    SCRATCH unsigned char *bytes = NULL;
    if (type == NULL || (type->components > 1 && image->components != (size_t)type->components)) {
        return fail(error, STATUS_INPUT, "%zu components do not fit values of type %d", image->components,
                    image->datatype);
    }
    size_t offset = nifti_encode(image, header);
    size_t size = offset + image_voxels(image) * image->components * (size_t)type->bytes;
    RETURN_IF_ERROR(RESIZE_ARRAY(&bytes, (int64_t)size, error));
    memcpy(bytes, header, offset);
    store_values(image, type, bytes + offset);
    return gzip ? write_gzip(bytes, size, descriptor, error)
                : descriptor_write(descriptor, bytes, size, error);
}
