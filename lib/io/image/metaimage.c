/* MetaImage headers (.mha, .mhd), as ITK reads them: AnatomicalOrientation only repeats what TransformMatrix
 * says. */
#include "io/image/text_header.h"

#include <strings.h>

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
