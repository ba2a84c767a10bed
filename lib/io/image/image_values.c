/* The values of an image file. */
#include "io/image/image_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* Refuse integers that a double cannot represent. */
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
    for (size_t c = 0; c < 2 && c < components; c++) {
        for (size_t i = c; i < count && layout->mirrored[c]; i += components) {
            image->values[i] = -image->values[i];
        }
    }
    return image_segments_merge(image, error);
}
