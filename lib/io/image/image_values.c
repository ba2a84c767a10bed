/* The bytes of an image file, out of gzip, and the values that they are. */
#include "io/image/image_private.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* ---- bytes ---- */

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

/* What follows is compressed by gzip or zlib: keep what it holds. */
static enum status image_bytes_unpack(struct image_bytes *file, struct error *error)
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

/* ---- values ---- */

static const double exact_integers = 9007199254740992.0; /* 2^53: all up to there are doubles */

/* Move to the first of `size` bytes of values. */
static enum status skip(struct image_bytes *file, const struct image_layout *layout, size_t size,
                        struct error *error)
{
    for (int64_t line = 0; line < layout->skip_lines && file->at < file->size; line++) {
        const char *text = (const char *)file->bytes + file->at,
                   *end = memchr(text, '\n', file->size - file->at);
        file->at = end != NULL ? file->at + (size_t)(end + 1 - text) : file->size;
    }
    if (layout->encoding == IMAGE_PACKED && !(layout->data_file[0] != '\0' && file->was_packed)) {
        RETURN_IF_ERROR(image_bytes_unpack(file, error));
    }
    size_t left = file->size - file->at;
    if (layout->skip_bytes < 0) {
        if (left < size) {
            return fail(error, STATUS_INPUT, "cut short: the header says %zu bytes of data", size);
        }
        file->at = file->size - size;
    } else if ((size_t)layout->skip_bytes > left) {
        return fail(error, STATUS_INPUT, "cut short: %zu bytes, the header says that data begin at byte %zu",
                    file->size, file->at + (size_t)layout->skip_bytes);
    } else {
        file->at += (size_t)layout->skip_bytes;
    }
    return STATUS_OK;
}

/* Read at most `count` numbers of text between blanks; *got: how many there are, and one if there are more.
 */
static enum status read_words(const struct image_bytes *file, const struct nifti_type *type, size_t count,
                              double *values, size_t *got, struct error *error)
{
    const char *at = (const char *)file->bytes + file->at, *end = (const char *)file->bytes + file->size;
    bool whole = type->most > type->least;
    for (*got = 0; *got <= count; ++*got) {
        char *behind;
        at += strspn(at, " \t\r\n,");
        if (at == end || *got == count) {
            *got += at < end;
            return STATUS_OK;
        }
        double value = strtod(at, &behind);
        if (behind == at || (behind < end && strchr(" \t\r\n,", *behind) == NULL) ||
            (whole && !(value == floor(value) && value >= type->least && value <= type->most))) {
            return fail(error, STATUS_INPUT, "value %zu, '%.*s': not of the type %s", *got,
                        (int)strcspn(at, " \t\r\n,") < 20 ? (int)strcspn(at, " \t\r\n,") : 20, at,
                        type->name);
        }
        values[*got] = value;
        at = behind;
    }
    return STATUS_OK;
}

/* Read the data: `count` values, and nothing behind them. */
static enum status read_values(struct image_bytes *file, const struct image_layout *layout, size_t count,
                               struct image *image, struct error *error)
{
    size_t size = (size_t)layout->type->bytes, got;
    bool is_text = layout->encoding == IMAGE_ASCII;
    RETURN_IF_ERROR(skip(file, layout, count * size, error));
    size_t left = file->size - file->at, most = is_text ? left / 2 + 1 : left / size;
    RETURN_IF_ERROR(RESIZE_ARRAY(&image->values, (int64_t)(count < most ? count : most), error));
    if (is_text) {
        RETURN_IF_ERROR(read_words(file, layout->type, count, image->values, &got, error));
    } else {
        got = left > count * size ? count + 1 : most;
    }
    if (got < count) {
        return fail(error, STATUS_INPUT, "cut short: %zu values, the header says %zu", got, count);
    }
    if (got > count) {
        return fail(error, STATUS_INPUT,
                    "more data than %zu values, as the header says: it lies about size or type", count);
    }
    if (!is_text) {
        nifti_get(layout->type, file->bytes + file->at, layout->swapped, count, image->values);
    }
    return STATUS_OK;
}

static enum status check_exact(const struct nifti_type *type, size_t count, const double *values,
                               struct error *error)
{
    for (size_t i = 0; i < count && type->most > exact_integers; i++) {
        if (fabs(values[i]) > exact_integers) {
            return fail(error, STATUS_INPUT, "a value of %.0f: whole numbers beyond 2^53 are not read",
                        values[i]);
        }
    }
    return STATUS_OK;
}

/* Reorder from one volume for each component to all components of each voxel. */
static enum status interleave(struct image *image, struct error *error)
{
    size_t voxels = image_voxels(image), components = image->components;
    double *values = NULL;
    RETURN_IF_ERROR(RESIZE_ARRAY(&values, (int64_t)(voxels * components), error));
    for (size_t c = 0; c < components; c++) {
        for (size_t v = 0; v < voxels; v++) {
            values[v * components + c] = image->values[c * voxels + v];
        }
    }
    free(image->values);
    image->values = values;
    return STATUS_OK;
}

static void turn_vector(const double turn[3][3], size_t components, double *vector)
{
    double before[3];
    memcpy(before, vector, components * sizeof *vector);
    for (size_t r = 0; r < components; r++) {
        vector[r] = 0;
        for (size_t c = 0; c < components; c++) {
            vector[r] += turn[r][c] != 0 ? turn[r][c] * before[c] : 0; /* no NaN of another component */
        }
    }
}

enum status image_values_read(struct image_bytes *file, const struct image_layout *layout,
                              struct image *image, struct error *error)
{
    size_t components = image->components, count = image_voxels(image) * components;
    RETURN_IF_ERROR(read_values(file, layout, count, image, error));
    RETURN_IF_ERROR(check_exact(layout->type, count, image->values, error));
    if (!layout->together && components > 1) {
        RETURN_IF_ERROR(interleave(image, error));
    }
    for (size_t i = 0; i < count && (image->slope != 1 || image->inter != 0); i++) {
        image->values[i] = image->slope * image->values[i] + image->inter;
    }
    for (size_t v = 0; v < count && layout->turned; v += components) {
        turn_vector(layout->turn, components, image->values + v);
    }
    return image_segments_merge(image, error);
}
