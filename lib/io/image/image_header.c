/* The layout of the 348 bytes of a NIfTI-1 header and of the 540 bytes of NIfTI-2. */
#include "io/image/image_private.h"

#include <string.h>

/* The types of fields. */
enum {
    I1 = IMAGE_UINT8,
    I2 = IMAGE_INT16,
    I4 = IMAGE_INT32,
    I8 = IMAGE_INT64,
    F4 = IMAGE_FLOAT32,
    F8 = IMAGE_FLOAT64
};

/* The place of a field in each version. */
struct place {
    int offset, type;
};
struct field {
    struct place at[2];
};

static const struct field dim_field = {{{40, I2}, {16, I8}}}, intent_field = {{{68, I2}, {504, I4}}},
                          datatype_field = {{{70, I2}, {12, I2}}}, bitpix_field = {{{72, I2}, {14, I2}}},
                          pixdim_field = {{{76, F4}, {104, F8}}}, offset_field = {{{108, F4}, {168, I8}}},
                          slope_field = {{{112, F4}, {176, F8}}}, inter_field = {{{116, F4}, {184, F8}}},
                          units_field = {{{123, I1}, {500, I4}}}, qform_field = {{{252, I2}, {344, I4}}},
                          sform_field = {{{254, I2}, {348, I4}}}, quatern_field = {{{256, F4}, {352, F8}}},
                          qoffset_field = {{{268, F4}, {376, F8}}}, srow_field = {{{280, F4}, {400, F8}}};
static const int description_offset[2] = {148, 240}, intent_name_offset[2] = {328, 508},
                 magic_offset[2] = {344, 4};
static const char magic1[] = "n+1", magic2[] = "n+2\0\r\n\032\n";

static double get(const unsigned char *bytes, const struct nifti *header, struct field field, int index)
{
    struct place at = field.at[header->version - 1];
    const struct nifti_type *type = nifti_type(at.type);
    double value;
    nifti_get(type, bytes + at.offset + index * type->bytes, header->swapped, 1, &value);
    return value;
}

static void put(unsigned char *bytes, int version, struct field field, int index, double value)
{
    struct place at = field.at[version - 1];
    const struct nifti_type *type = nifti_type(at.type);
    nifti_put(type, value, bytes + at.offset + index * type->bytes);
}

int nifti_version(const unsigned char *bytes, bool *swapped)
{
    static const int sizes[2] = {NIFTI1_HEADER, NIFTI2_HEADER};
    for (int version = 1; version <= 2; version++) {
        int low = sizes[version - 1] & 255, high = sizes[version - 1] >> 8;
        if (bytes[0] == low && bytes[1] == high && bytes[2] == 0 && bytes[3] == 0) {
            *swapped = false;
            return version;
        }
        if (bytes[0] == 0 && bytes[1] == 0 && bytes[2] == high && bytes[3] == low) {
            *swapped = true;
            return version;
        }
    }
    return 0;
}

/* Printable characters of a field of text, '?' for others. */
static void copy_text(char *text, const unsigned char *bytes, size_t size)
{
    size_t length = 0;
    while (length < size && bytes[length] != '\0') {
        length++;
    }
    memcpy(text, bytes, length);
    text[length] = '\0';
    for (size_t i = 0; i < length; i++) {
        if (text[i] < ' ' || text[i] > '~') {
            text[i] = '?';
        }
    }
}

void image_describe(struct image *image, const char *text)
{
    size_t length = strlen(text), most = sizeof image->description - 1;
    copy_text(image->description, (const unsigned char *)text, length < most ? length : most);
}

void nifti_decode(const unsigned char *bytes, int version, bool swapped, struct nifti *header,
                  struct image *image)
{
    *header = (struct nifti){.version = version, .swapped = swapped};
    for (int i = 0; i < 8; i++) {
        header->dim[i] = get(bytes, header, dim_field, i);
        header->pixdim[i] = get(bytes, header, pixdim_field, i);
    }
    header->datatype = (int)get(bytes, header, datatype_field, 0);
    header->bits = (int)get(bytes, header, bitpix_field, 0);
    header->intent = (int)get(bytes, header, intent_field, 0);
    header->offset = get(bytes, header, offset_field, 0);
    header->slope = get(bytes, header, slope_field, 0);
    header->inter = get(bytes, header, inter_field, 0);
    header->units = (int)get(bytes, header, units_field, 0);
    header->qform = (int)get(bytes, header, qform_field, 0);
    header->sform = (int)get(bytes, header, sform_field, 0);
    for (int r = 0; r < 3; r++) {
        header->quatern[r] = get(bytes, header, quatern_field, r);
        header->qoffset[r] = get(bytes, header, qoffset_field, r);
        for (int c = 0; c < 4; c++) {
            header->srow[r][c] = get(bytes, header, srow_field, 4 * r + c);
        }
    }
    image->version = version;
    image->intent = header->intent;
    copy_text(image->description, bytes + description_offset[version - 1], 80);
    copy_text(image->intent_name, bytes + intent_name_offset[version - 1], 16);
}

/* dim[0] .. dim[7]. */
static void sizes_of(const struct image *image, const struct nifti_type *type, double dim[8])
{
    bool vector = image->components != (size_t)type->components;
    for (int i = 0; i < 8; i++) {
        dim[i] = 1;
    }
    dim[0] = vector ? 5 : image->size[2] > 1 ? 3 : 2;
    for (int i = 0; i < 3; i++) {
        dim[1 + i] = (double)image->size[i];
    }
    dim[5] = vector ? (double)image->components : 1;
}

/* The version to write: 1 if all sizes fit 16 bits, else 2. */
static int version_of(const struct image *image)
{
    bool fits = image->components <= INT16_MAX;
    for (int i = 0; i < 3; i++) {
        fits = fits && image->size[i] <= INT16_MAX;
    }
    return fits && image->version != 2 ? 1 : 2;
}

size_t nifti_encode(const struct image *image, unsigned char bytes[NIFTI2_HEADER + 4])
{
    const struct nifti_type *type = nifti_type(image->datatype);
    int version = version_of(image), size = version == 1 ? NIFTI1_HEADER : NIFTI2_HEADER;
    double dim[8], matrix[3][4], quatern[3], pixdim[4];
    double unit = image->unit == 1 || image->unit == 1e-6 ? image->unit : 1e-3; /* what NIfTI knows */
    memset(bytes, 0, NIFTI2_HEADER + 4);
    bytes[0] = (unsigned char)(size & 255);
    bytes[1] = (unsigned char)(size >> 8);
    sizes_of(image, type, dim);
    for (int i = 0; i < 8; i++) {
        put(bytes, version, dim_field, i, dim[i]);
        put(bytes, version, pixdim_field, i, 1);
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 4; c++) {
            matrix[r][c] = image->to_world[r][c] / unit;
            put(bytes, version, srow_field, 4 * r + c, matrix[r][c]);
        }
    }
    bool rotation = nifti_quaternion(matrix, quatern, pixdim);
    for (int i = 0; i < 4; i++) {
        put(bytes, version, pixdim_field, i, pixdim[i]);
    }
    /* An unknown space stays unknown. A map that a quaternion cannot represent is only in the sform. */
    put(bytes, version, sform_field, 0, image->space);
    put(bytes, version, qform_field, 0, rotation ? image->space : 0);
    for (int r = 0; r < 3 && rotation; r++) {
        put(bytes, version, quatern_field, r, quatern[r]);
        put(bytes, version, qoffset_field, r, matrix[r][3]);
    }
    put(bytes, version, datatype_field, 0, type->code);
    put(bytes, version, bitpix_field, 0, 8 * type->bytes * type->components);
    put(bytes, version, intent_field, 0, image->intent);
    put(bytes, version, slope_field, 0, image->slope);
    put(bytes, version, inter_field, 0, image->inter);
    put(bytes, version, units_field, 0, unit > 0.5 ? 1 : unit > 0.5e-3 ? 2 : 3);
    put(bytes, version, offset_field, 0, size + 4);
    memcpy(bytes + description_offset[version - 1], image->description, strlen(image->description));
    memcpy(bytes + intent_name_offset[version - 1], image->intent_name, strlen(image->intent_name));
    memcpy(bytes + magic_offset[version - 1], version == 1 ? magic1 : magic2, version == 1 ? 4 : 8);
    return (size_t)size + 4;
}
