/* MetaImage headers (.mha, .mhd), as ITK reads them: AnatomicalOrientation only repeats what TransformMatrix
 * says. */
#include "io/image/text_header.h"

#include <string.h>
#include <strings.h>

/* The fields of a header as they stand, in mm along left, back, up. */
struct metaimage {
    struct image *image;
    struct image_layout *layout;
    int dimension;
    double size[3], spacing[3], origin[3], axes[9];
    int64_t channels;
};

/* Fields of which it counts whether they are there. */
enum { SIZE, SPACING, ELEMENT, MATRIX };

static enum status take_flag(const struct text_header *header, bool *flag, struct error *error)
{
    *flag = header->value[0] != '\0' && strchr("Tt1", header->value[0]) != NULL;
    return *flag || (header->value[0] != '\0' && strchr("Ff0", header->value[0]) != NULL)
               ? STATUS_OK
               : header_fail(header, "True or False is expected", error);
}

static enum status set_object(void *context, const struct text_header *header, struct error *error)
{
    (void)context;
    return strcasecmp(header->value, "Image") == 0 ? STATUS_OK : header_fail(header, "not an image", error);
}

static enum status set_dimension(void *context, const struct text_header *header, struct error *error)
{
    int64_t number;
    RETURN_IF_ERROR(header_integer(header, 2, 3, &number, error));
    ((struct metaimage *)context)->dimension = (int)number;
    return STATUS_OK;
}

static enum status set_size(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    return header_vector(header, meta->dimension, meta->size, error);
}

/* The size of an element is its spacing where none is given. */
static enum status set_spacing(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    bool given = header_has(header, SPACING) && header_is("ElementSize", header->key);
    return given ? STATUS_OK : header_vector(header, meta->dimension, meta->spacing, error);
}

static enum status set_origin(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    return header_vector(header, meta->dimension, meta->origin, error);
}

static enum status set_axes(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    return header_vector(header, meta->dimension * meta->dimension, meta->axes, error);
}

static enum status set_channels(void *context, const struct text_header *header, struct error *error)
{
    return header_integer(header, 1, INT32_MAX, &((struct metaimage *)context)->channels, error);
}

static enum status set_type(void *context, const struct text_header *header, struct error *error)
{
    return header_type(header, metaimage_types, ((struct metaimage *)context)->layout, error);
}

static enum status set_big_endian(void *context, const struct text_header *header, struct error *error)
{
    return take_flag(header, &((struct metaimage *)context)->layout->swapped, error);
}

static enum status set_encoding(void *context, const struct text_header *header, struct error *error)
{
    struct image_layout *layout = ((struct metaimage *)context)->layout;
    bool is_compressed = header_is("CompressedData", header->key), flag;
    RETURN_IF_ERROR(take_flag(header, &flag, error));
    if (flag == is_compressed) {
        layout->encoding = flag ? IMAGE_PACKED : IMAGE_ASCII;
    }
    return STATUS_OK;
}

static enum status set_skip(void *context, const struct text_header *header, struct error *error)
{
    return header_integer(header, -1, (int64_t)1 << 50, &((struct metaimage *)context)->layout->skip_bytes,
                          error);
}

static enum status set_unit(void *context, const struct text_header *header, struct error *error)
{
    (void)context;
    return header_is("mm|?", header->value) ? STATUS_OK : header_fail(header, "only mm is read", error);
}

static enum status set_comment(void *context, const struct text_header *header, struct error *error)
{
    (void)error;
    image_describe(((struct metaimage *)context)->image, header->value);
    return STATUS_OK;
}

static const struct header_field fields[] = {
    [SIZE] = {"DimSize", set_size},
    [SPACING] = {"ElementSpacing", set_spacing},
    [ELEMENT] = {"ElementSize", set_spacing},
    [MATRIX] = {"TransformMatrix|Rotation|Orientation", set_axes},
    {"ObjectType", set_object},
    {"Comment", set_comment},
    {"NDims", set_dimension},
    {"Offset|Position|Origin", set_origin},
    {"ElementNumberOfChannels", set_channels},
    {"ElementType", set_type},
    {"BinaryDataByteOrderMSB|ElementByteOrderMSB", set_big_endian},
    {"CompressedData|BinaryData", set_encoding},
    {"HeaderSize", set_skip},
    {"DistanceUnits", set_unit},
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
    int n = meta->dimension;
    double size[3] = {1, 1, 1}, matrix[3][4] = {{0}};
    static const double sign[3] = {-1e-3, -1e-3, 1e-3}; /* left, back, up in mm, to right, front, up in m */
    struct image *image = meta->image;
    for (int r = 0; r < n; r++) {
        size[r] = meta->size[r];
        for (int a = 0; a < n; a++) {
            matrix[r][a] =
                sign[r] * meta->spacing[a] * (header_has(header, MATRIX) ? meta->axes[n * a + r] : r == a);
        }
        matrix[r][3] = sign[r] * meta->origin[r];
    }
    if (!header_has(header, SPACING) && !header_has(header, ELEMENT)) {
        image_note(image, "tells no spacing: 1 mm taken");
    }
    image->intent = meta->channels > 1 ? IMAGE_INTENT_VECTOR : 0;
    image->unit = 1e-3;
    image->space = IMAGE_SPACE_SCANNER;
    RETURN_IF_ERROR(header_sizes(size, (double)meta->channels, true, meta->layout, image, error));
    return image_place(image, matrix, "TransformMatrix and ElementSpacing", error);
}

enum status metaimage_header(struct image_source *source, const unsigned char begin[4], struct image *image,
                             struct image_layout *layout, struct error *error)
{
    struct text_header header = {.source = source, .separator = '=', .begun = 4};
    struct metaimage meta = {.image = image, .layout = layout, .spacing = {1, 1, 1}, .channels = 1};
    layout->together = true;
    memcpy(header.line, begin, 4);
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
        RETURN_IF_ERROR(header_data_file(&header, layout, error));
    } else if (header.cut) {
        return fail(error, STATUS_INPUT, "cut short: no data behind the header");
    }
    if (layout->type == NULL || !header_has(&header, SIZE)) {
        return fail(error, STATUS_INPUT, "header: no %s", layout->type == NULL ? "ElementType" : "DimSize");
    }
    return place(&meta, &header, error);
}
