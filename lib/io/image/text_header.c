/* Headers of text, and those of MetaImage (.mha, .mhd), as ITK reads them: AnatomicalOrientation only repeats
 * what TransformMatrix says. */
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

/* The value is the name of a file in the folder of the header or below. */
static enum status header_data_file(const struct text_header *header, struct image_layout *layout,
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
    case HEADER_LEFT:
        break;
    }
    return field->set != NULL ? field->set(context, header, error) : STATUS_OK;
}

enum status header_set(struct text_header *header, const struct header_field *fields, size_t count,
                       void *context, struct error *error)
{
    for (size_t f = 0; f < count; f++) {
        if (header_is(fields[f].keys, header->key)) {
            bool again = header_has(header, (int)f) && fields[f].kind != HEADER_LEFT;
            RETURN_IF_ERROR(take(&fields[f], context, header, error));
            header->given |= (uint64_t)1 << f;
            return again ? header_fail(header, "stands twice: take one out", error) : STATUS_OK;
        }
    }
    text_append(header->unknown, sizeof header->unknown, ", %.40s", header->key);
    return STATUS_OK;
}

void header_note_unknown(const struct text_header *header, struct image *image)
{
    if (header->unknown[0] != '\0') {
        image_note(image, "fields that are not known, left out: %s", header->unknown + 2);
    }
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

/* ---- MetaImage ---- */

/* The fields of a header as they stand, in mm along left, back, up. */
struct metaimage {
    struct image *image;
    struct image_layout layout;
    int64_t dimension, channels;
    int is_msb, element_msb; /* the newer and the older key of the byte order */
    int is_compressed, is_binary;
    int word; /* of those of which only one is read */
    double size[3], spacing[3], element[3], origin[3], axes[9];
};

/* Fields of which it counts whether they are there. */
enum { SIZE, SPACING, ELEMENT, MATRIX, ORIGIN, BINARY_MSB, ELEMENT_MSB };

#define FLAG "False|F|0 True|T|1"
#define AT(member) offsetof(struct metaimage, member)

static const struct header_field fields[] = {
    [SIZE] = {"DimSize", HEADER_VECTOR, AT(size)},
    [SPACING] = {"ElementSpacing", HEADER_VECTOR, AT(spacing)},
    [ELEMENT] = {"ElementSize", HEADER_VECTOR, AT(element)},
    [MATRIX] = {"TransformMatrix|Rotation|Orientation", HEADER_MATRIX, AT(axes)},
    [ORIGIN] = {"Offset|Position|Origin", HEADER_VECTOR, AT(origin)},
    [BINARY_MSB] = {"BinaryDataByteOrderMSB", HEADER_WORD, AT(is_msb), .words = FLAG},
    [ELEMENT_MSB] = {"ElementByteOrderMSB", HEADER_WORD, AT(element_msb), .words = FLAG},
    {"ObjectType", HEADER_WORD, AT(word), .words = "Image"},
    {"Comment", HEADER_TEXT, AT(image)},
    {"NDims", HEADER_INTEGER, AT(dimension), 2, 3},
    {"ElementNumberOfChannels", HEADER_INTEGER, AT(channels), 1, INT32_MAX},
    {"ElementType", HEADER_TYPE, AT(layout)},
    {"CompressedData", HEADER_WORD, AT(is_compressed), .words = FLAG},
    {"BinaryData", HEADER_WORD, AT(is_binary), .words = FLAG},
    {"HeaderSize", HEADER_INTEGER, AT(layout.skip_bytes), -1, HEADER_SKIP},
    {"DistanceUnits", HEADER_WORD, AT(word), .words = "mm|?"},
    {"ObjectSubType|TransformType|Name|ID|ParentID|Color|AcquisitionDate|CenterOfRotation|"
     "AnatomicalOrientation|CompressedDataSize|Modality|SequenceID|ElementMin|ElementMax|ElementNBits",
     HEADER_LEFT},
};

bool metaimage_begins(const unsigned char bytes[4])
{
    static const char *const keys[] = {"Obje", "NDim", "Comm", "Bina", "DimS"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        if (strncasecmp((const char *)bytes, keys[k], 4) == 0) {
            return true;
        }
    }
    return false;
}

static enum status place(const struct metaimage *meta, const struct text_header *header, struct error *error)
{
    int n = (int)meta->dimension;
    const double *spacing =
        header_has(header, ELEMENT) && !header_has(header, SPACING) ? meta->element : meta->spacing;
    double size[3] = {1, 1, 1}, matrix[3][4] = {{0}};
    static const double sign[3] = {-1e-3, -1e-3, 1e-3}; /* left, back, up in mm, to right, front, up in m */
    struct image *image = meta->image;
    for (int r = 0; r < n; r++) {
        size[r] = meta->size[r];
        for (int a = 0; a < n; a++) {
            matrix[r][a] =
                sign[r] * spacing[a] * (header_has(header, MATRIX) ? meta->axes[n * a + r] : r == a);
        }
        matrix[r][3] = sign[r] * meta->origin[r];
    }
    if (!header_has(header, SPACING) && !header_has(header, ELEMENT)) {
        image_note(image, "has no spacing: 1 mm taken");
    }
    if (!header_has(header, ORIGIN)) {
        image_note(image, "has no Offset: the first voxel lies at 0");
    }
    header_note_unknown(header, image);
    image->intent = meta->channels > 1 ? IMAGE_INTENT_VECTOR : 0;
    image->unit = 1e-3;
    image->space = IMAGE_SPACE_SCANNER;
    RETURN_IF_ERROR(header_sizes(size, (double)meta->channels, true, &meta->layout, image, error));
    return image_place(image, matrix, "TransformMatrix and ElementSpacing", error);
}

enum status metaimage_header(struct image_bytes *file, struct image *image, struct image_layout *layout,
                             struct error *error)
{
    struct text_header header = {.file = file, .separator = '='};
    struct metaimage meta = {
        .image = image, .layout = {.together = true}, .spacing = {1, 1, 1}, .channels = 1, .is_binary = 1};
    header.dimension = &meta.dimension;
    for (;;) {
        RETURN_IF_ERROR(header_next(&header, error));
        if (header.key == NULL) {
            return fail(error, STATUS_INPUT, "cut short: the header ends without ElementDataFile");
        }
        if (strcasecmp(header.key, "ElementDataFile") == 0) {
            break;
        }
        RETURN_IF_ERROR(header_set(&header, fields, sizeof fields / sizeof *fields, &meta, error));
    }
    if (strcasecmp(header.value, "LOCAL") != 0) {
        RETURN_IF_ERROR(header_data_file(&header, &meta.layout, error));
    } else if (header.cut) {
        return fail(error, STATUS_INPUT, "cut short: no data behind the header");
    }
    if (header_has(&header, ELEMENT_MSB) && header_has(&header, BINARY_MSB) &&
        meta.is_msb != meta.element_msb) {
        return fail(error, STATUS_INPUT,
                    "header: BinaryDataByteOrderMSB and ElementByteOrderMSB contradict each other");
    }
    meta.layout.swapped = meta.is_msb || meta.element_msb;
    *layout = meta.layout;
    layout->encoding = meta.is_compressed ? IMAGE_PACKED : meta.is_binary ? IMAGE_RAW : IMAGE_ASCII;
    if (layout->type == NULL || !header_has(&header, SIZE)) {
        return fail(error, STATUS_INPUT, "header: no %s", layout->type == NULL ? "ElementType" : "DimSize");
    }
    return place(&meta, &header, error);
}
