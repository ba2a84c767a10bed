/* The values of an image file: memory grows with the data that are there. */
#include "io/image/image_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const size_t block_values = 1 << 16;
static const double exact_integers = 9007199254740992.0; /* 2^53: all up to there are doubles */

/* The bytes in front of the last `size` ones of a file. */
static enum status skip_to_last(const struct image_source *source, size_t size, int64_t *skip,
                                struct error *error)
{
    struct stat facts;
    if (source->gzip || fstat(source->descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) {
        return fail(
            error, STATUS_INPUT,
            "header: a skip of -1 is to the last bytes of a plain file, neither compressed nor a pipe");
    }
    *skip = facts.st_size - source->taken - (int64_t)size;
    return *skip >= 0 ? STATUS_OK
                      : fail(error, STATUS_INPUT, "cut short: the header says %zu bytes of data", size);
}

/* Move to the first value. */
static enum status skip(struct image_source *source, const struct image_layout *layout, size_t size,
                        struct error *error)
{
    unsigned char scratch[1 << 12];
    size_t got = 1;
    int64_t bytes = layout->skip_bytes;
    for (int64_t line = 0; line < layout->skip_lines && got > 0; line += scratch[0] == '\n') {
        RETURN_IF_ERROR(image_source_take(source, scratch, 1, &got, error));
    }
    if (layout->encoding == IMAGE_PACKED && !(layout->data_file[0] != '\0' && source->gzip)) {
        RETURN_IF_ERROR(image_source_unpack(source, error));
    }
    if (bytes < 0) {
        RETURN_IF_ERROR(skip_to_last(source, size, &bytes, error));
    }
    for (int64_t begin = source->taken + bytes; source->taken < begin;) {
        size_t left = (size_t)(begin - source->taken);
        RETURN_IF_ERROR(
            image_source_take(source, scratch, left < sizeof scratch ? left : sizeof scratch, &got, error));
        if (got == 0) {
            return fail(error, STATUS_INPUT,
                        "cut short: %lld bytes, the header says that data begin at byte %lld",
                        (long long)source->taken, (long long)begin);
        }
    }
    return STATUS_OK;
}

/* Take a word between blanks, "" at the end of the file. */
static enum status take_word(struct image_source *source, char word[64], struct error *error)
{
    size_t length = 0, got;
    for (;;) {
        RETURN_IF_ERROR(image_source_take(source, word + length, 1, &got, error));
        bool blank = got == 0 || strchr(" \t\r\n,", word[length]) != NULL; /* a NUL ends it, too */
        if (blank && (length > 0 || got == 0)) {
            word[length] = '\0';
            return STATUS_OK;
        }
        length += !blank;
        if (length == 63) {
            return fail(error, STATUS_INPUT, "'%.20s...' is no number", word);
        }
    }
}

/* Read `count` numbers of text; *got: how many there were. */
static enum status take_words(struct image_source *source, const struct nifti_type *type, size_t count,
                              double *values, size_t *got, struct error *error)
{
    bool whole = type->most > type->least;
    char word[64], *end;
    for (*got = 0; *got < count; ++*got) {
        RETURN_IF_ERROR(take_word(source, word, error));
        if (word[0] == '\0') {
            return STATUS_OK;
        }
        double value = strtod(word, &end);
        if (*end != '\0' ||
            (whole && !(value == floor(value) && value >= type->least && value <= type->most))) {
            return fail(error, STATUS_INPUT, "value %zu, '%.20s': not of the type %s", *got, word,
                        type->name);
        }
        values[*got] = value;
    }
    return STATUS_OK;
}

/* Read `count` numbers as they are stored, with the help of block. */
static enum status take_numbers(struct image_source *source, const struct image_layout *layout, size_t count,
                                unsigned char *block, double *values, size_t *got, struct error *error)
{
    if (layout->encoding == IMAGE_ASCII) {
        return take_words(source, layout->type, count, values, got, error);
    }
    size_t size = (size_t)layout->type->bytes;
    RETURN_IF_ERROR(image_source_take(source, block, count * size, got, error));
    *got /= size;
    nifti_get(layout->type, block, layout->swapped, *got, values);
    return STATUS_OK;
}

/* Read the data: `count` values, and nothing behind them. */
static enum status read_values(struct image_source *source, const struct image_layout *layout, size_t count,
                               struct image *image, struct error *error)
{
    size_t size = (size_t)layout->type->bytes, done_count = 0, capacity = 0, got;
    char word[64]; /* what is behind them */
    NEW_SCRATCH(unsigned char, block, (int64_t)(block_values * size + 8), error);
    RETURN_IF_ERROR(skip(source, layout, count * size, error));
    while (done_count < count) {
        size_t wanted = count - done_count < block_values ? count - done_count : block_values;
        if (done_count + wanted > capacity) {
            capacity = 2 * capacity < count ? 2 * capacity + 4 * block_values : count;
            capacity = capacity < count ? capacity : count;
            RETURN_IF_ERROR(RESIZE_ARRAY(&image->values, (int64_t)capacity, error));
        }
        RETURN_IF_ERROR(take_numbers(source, layout, wanted, block, image->values + done_count, &got, error));
        done_count += got;
        if (got < wanted) {
            return fail(error, STATUS_INPUT, "cut short: %zu values, the header says %zu", done_count, count);
        }
    }
    if (layout->encoding == IMAGE_ASCII) {
        RETURN_IF_ERROR(take_word(source, word, error));
    } else {
        RETURN_IF_ERROR(image_source_take(source, word, 1, &got, error));
        word[0] = got > 0 ? 'x' : '\0';
    }
    return word[0] == '\0'
               ? STATUS_OK
               : fail(error, STATUS_INPUT,
                      "more data than %zu values, as the header says: it lies about size or type", count);
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

enum status image_values_read(struct image_source *source, const struct image_layout *layout,
                              struct image *image, struct error *error)
{
    size_t components = image->components, count = image_voxels(image) * components;
    RETURN_IF_ERROR(read_values(source, layout, count, image, error));
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
