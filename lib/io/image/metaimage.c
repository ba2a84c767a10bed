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
    bool has_size, has_spacing, has_element, has_axes;
};

const struct header_type metaimage_types[IMAGE_TYPES] = {
    {IMAGE_UINT8, "MET_UCHAR|MET_UCHAR_ARRAY"},
    {IMAGE_INT8, "MET_CHAR|MET_CHAR_ARRAY"},
    {IMAGE_INT16, "MET_SHORT|MET_SHORT_ARRAY"},
    {IMAGE_UINT16, "MET_USHORT|MET_USHORT_ARRAY"},
    {IMAGE_INT32, "MET_INT|MET_LONG|MET_INT_ARRAY|MET_LONG_ARRAY"},
    {IMAGE_UINT32, "MET_UINT|MET_ULONG|MET_UINT_ARRAY|MET_ULONG_ARRAY"},
    {IMAGE_INT64, "MET_LONG_LONG|MET_LONG_LONG_ARRAY"},
    {IMAGE_UINT64, "MET_ULONG_LONG|MET_ULONG_LONG_ARRAY"},
    {IMAGE_FLOAT32, "MET_FLOAT|MET_FLOAT_ARRAY"},
    {IMAGE_FLOAT64, "MET_DOUBLE|MET_DOUBLE_ARRAY"},
};

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
    meta->has_size = true;
    return header_vector(header, meta->dimension, meta->size, error);
}

static enum status set_spacing(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    meta->has_spacing = true;
    return header_vector(header, meta->dimension, meta->spacing, error);
}

/* The size of an element is its spacing where none is given. */
static enum status set_element(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    meta->has_element = true;
    return meta->has_spacing ? STATUS_OK : header_vector(header, meta->dimension, meta->spacing, error);
}

static enum status set_origin(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    return header_vector(header, meta->dimension, meta->origin, error);
}

static enum status set_axes(void *context, const struct text_header *header, struct error *error)
{
    struct metaimage *meta = context;
    meta->has_axes = true;
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
    bool is_compressed = strcasecmp(header->key, "CompressedData") == 0, flag;
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

static enum status set_comment(void *context, const struct text_header *header, struct error *error)
{
    (void)error;
    image_describe(((struct metaimage *)context)->image, header->value);
    return STATUS_OK;
}

static const struct header_field fields[] = {
    {"ObjectType", set_object},
    {"Comment", set_comment},
    {"NDims", set_dimension},
    {"DimSize", set_size},
    {"ElementSpacing", set_spacing},
    {"ElementSize", set_element},
    {"Offset", set_origin},
    {"Position", set_origin},
    {"Origin", set_origin},
    {"TransformMatrix", set_axes},
    {"Rotation", set_axes},
    {"Orientation", set_axes},
    {"ElementNumberOfChannels", set_channels},
    {"ElementType", set_type},
    {"BinaryDataByteOrderMSB", set_big_endian},
    {"ElementByteOrderMSB", set_big_endian},
    {"CompressedData", set_encoding},
    {"BinaryData", set_encoding},
    {"HeaderSize", set_skip},
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

static enum status place(const struct metaimage *meta, struct error *error)
{
    int n = meta->dimension;
    double size[3] = {1, 1, 1}, matrix[3][4] = {{0}};
    static const double sign[3] = {-1e-3, -1e-3, 1e-3}; /* left, back, up in mm, to right, front, up in m */
    struct image *image = meta->image;
    for (int r = 0; r < n; r++) {
        size[r] = meta->size[r];
        for (int a = 0; a < n; a++) {
            matrix[r][a] = sign[r] * meta->spacing[a] * (meta->has_axes ? meta->axes[n * a + r] : r == a);
        }
        matrix[r][3] = sign[r] * meta->origin[r];
    }
    if (!meta->has_spacing && !meta->has_element) {
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
    if (layout->type == NULL || !meta.has_size) {
        return fail(error, STATUS_INPUT, "header: no %s", layout->type == NULL ? "ElementType" : "DimSize");
    }
    return place(&meta, error);
}
