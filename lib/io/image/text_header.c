#include "io/image/text_header.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum status header_line(struct text_header *header, struct error *error)
{
    struct image_bytes *file = header->file;
    char *line = (char *)file->bytes + file->at;
    size_t left = file->size - file->at;
    const char *newline = memchr(line, '\n', left);
    size_t length = newline != NULL ? (size_t)(newline - line) : left;
    header->line = line;
    header->cut = newline == NULL;
    file->at += length + (newline != NULL);
    if (memchr(line, '\0', length) != NULL) {
        return fail(error, STATUS_INPUT, "header: damaged: a byte of value 0");
    }
    while (length > 0 && strchr(" \t\r", line[length - 1]) != NULL) {
        length--;
    }
    line[length] = '\0';
    return STATUS_OK;
}

enum status header_next(struct text_header *header, struct error *error)
{
    header->key = NULL;
    do {
        RETURN_IF_ERROR(header_line(header, error));
    } while (header->line[0] == '#' && header->separator == ':' && !header->cut);
    char *end = strchr(header->line, header->separator);
    if (header->line[0] == '\0' || header->line[0] == '#') {
        return STATUS_OK;
    }
    if (end == NULL) {
        return fail(error, STATUS_INPUT, "header: '%.60s': no '%c' behind a key", header->line,
                    header->separator);
    }
    header->is_pair = header->separator == ':' && end[1] == '=';
    header->value = end + (header->is_pair ? 2 : 1);
    header->value += strspn(header->value, " \t");
    while (end > header->line && isblank((unsigned char)end[-1])) {
        end--;
    }
    *end = '\0';
    header->key = header->line;
    return STATUS_OK;
}

bool header_is(const char *names, const char *word)
{
    size_t length = strlen(word), name;
    for (const char *at = names; *at != '\0'; at += name + (at[name] == '|')) {
        name = strcspn(at, "|");
        if (name == length && strncasecmp(at, word, name) == 0) {
            return true;
        }
    }
    return false;
}

enum status header_fail(const struct text_header *header, const char *why, struct error *error)
{
    return fail(error, STATUS_INPUT, "header: %.40s%c %.80s: %s", header->key, header->separator,
                header->value, why);
}

bool header_numbers(const char **at, int count, double *numbers)
{
    for (int i = 0; i < count; i++) {
        char *end;
        *at += strspn(*at, " \t,");
        numbers[i] = strtod(*at, &end);
        if (end == *at || isinf(numbers[i])) {
            return false;
        }
        *at = end;
    }
    *at += strspn(*at, " \t");
    return true;
}

/* The value of the field is `count` numbers; 0: the dimension, which stands behind it. */
static enum status take_vector(const struct text_header *header, int64_t count, double *numbers,
                               struct error *error)
{
    const char *at = header->value;
    double further;
    bool is_metaimage = header->separator == '=';
    if (count == 0) {
        return header_fail(header, "stands in front of the number of dimensions", error);
    }
    bool taken = header_numbers(&at, (int)count, numbers);
    while (taken && is_metaimage && *at != '\0' && header_numbers(&at, 1, &further)) {
    } /* images of two dimensions often have three spacings */
    return taken && *at == '\0'
               ? STATUS_OK
               : header_fail(header, "a finite number for each dimension is expected", error);
}

enum status header_integer(const struct text_header *header, int64_t least, int64_t most, int64_t *number,
                           struct error *error)
{
    double value;
    const char *at = header->value;
    char why[80];
    if (header_numbers(&at, 1, &value) && *at == '\0' && value >= (double)least && value <= (double)most &&
        value == floor(value)) {
        *number = (int64_t)value;
        return STATUS_OK;
    }
    snprintf(why, sizeof why, "from %jd to %jd is possible", least, most);
    return header_fail(header, why, error);
}

static enum status take_type(const struct text_header *header, struct image_layout *layout,
                             struct error *error)
{
    layout->type =
        nifti_type_named(header->separator == '=' ? NUMBERS_OF_METAIMAGE : NUMBERS_OF_NRRD, header->value);
    return layout->type != NULL
               ? STATUS_OK
               : header_fail(header, "integers of 8 to 64 bits and floats of 32 and 64 are read", error);
}

/* The value is one of the words of the field: its number. */
static enum status take_word(const struct text_header *header, const char *words, int *number,
                             struct error *error)
{
    char names[32], why[80];
    size_t length;
    *number = 0;
    for (const char *at = words; *at != '\0'; at += length + (at[length] == ' '), ++*number) {
        length = strcspn(at, " ");
        snprintf(names, sizeof names, "%.*s", (int)length, at);
        if (header_is(names, header->value)) {
            return STATUS_OK;
        }
    }
    snprintf(why, sizeof why, "one of these is read: %s", words);
    return header_fail(header, why, error);
}

static bool leads_up(const char *path)
{
    for (; *path != '\0'; path += strcspn(path, "/")) {
        path += strspn(path, "/");
        if (strcspn(path, "/") == 2 && strncmp(path, "..", 2) == 0) {
            return true;
        }
    }
    return false;
}

enum status header_data_file(const struct text_header *header, struct image_layout *layout,
                             struct error *error)
{
    const char *file = header->value;
    if (strncmp(file, "LIST", 4) == 0 || strchr(file, '%') != NULL) {
        return header_fail(header, "the data lie in several files: save the image as one file", error);
    }
    if (file[0] == '\0' || file[0] == '/' || leads_up(file) || strlen(file) >= sizeof layout->data_file) {
        return header_fail(header, "not a file in the folder of the header", error);
    }
    snprintf(layout->data_file, sizeof layout->data_file, "%s", file);
    return STATUS_OK;
}

static enum status take(const struct header_field *field, void *context, const struct text_header *header,
                        struct error *error)
{
    int64_t n = *header->dimension;
    void *at = (char *)context + field->at;
    switch (field->kind) {
    case HEADER_INTEGER:
        return header_integer(header, field->least, field->most, at, error);
    case HEADER_VECTOR:
        return take_vector(header, n, at, error);
    case HEADER_MATRIX:
        return take_vector(header, n * n, at, error);
    case HEADER_TYPE:
        return take_type(header, at, error);
    case HEADER_FILE:
        return header_data_file(header, at, error);
    case HEADER_WORD:
        return take_word(header, field->words, at, error);
    case HEADER_TEXT:
        image_describe(*(struct image **)at, header->value);
        return STATUS_OK;
    case HEADER_SET:
        break;
    }
    return field->set != NULL ? field->set(context, header, error) : STATUS_OK;
}

enum status header_set(struct text_header *header, const struct header_field *fields, size_t count,
                       void *context, struct error *error)
{
    for (size_t f = 0; f < count; f++) {
        if (header_is(fields[f].keys, header->key)) {
            bool again = header_has(header, (int)f);
            RETURN_IF_ERROR(take(&fields[f], context, header, error));
            header->given |= (uint64_t)1 << f;
            return again ? header_fail(header, "stands twice: take one out", error) : STATUS_OK;
        }
    }
    return STATUS_OK;
}

enum status header_sizes(const double size[3], double components, bool colour,
                         const struct image_layout *layout, struct image *image, struct error *error)
{
    size_t count = 1;
    const double sizes[4] = {size[0], size[1], size[2], components};
    for (int i = 0; i < 4; i++) {
        if (!(sizes[i] >= 1 && sizes[i] <= INT32_MAX && sizes[i] == floor(sizes[i]))) {
            return fail(error, STATUS_INPUT, "header: size %g: a whole number from 1 to 2^31 - 1 is possible",
                        sizes[i]);
        }
        if (__builtin_mul_overflow(count, (size_t)sizes[i], &count) || count > SIZE_MAX / 32) {
            return fail(error, STATUS_INPUT, "header: %.0f x %.0f x %.0f voxels: more than any memory",
                        size[0], size[1], size[2]);
        }
    }
    for (int i = 0; i < 3; i++) {
        image->size[i] = (size_t)size[i];
    }
    image->components = (size_t)components;
    image->datatype = layout->type->code;
    if (colour && image->datatype == IMAGE_UINT8 && (components == 3 || components == 4)) {
        image->datatype = components == 3 ? IMAGE_RGB24 : IMAGE_RGBA32;
        image->intent = 0;
    }
    return STATUS_OK;
}
