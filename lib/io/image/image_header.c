/* The layout of the 348 bytes of a NIfTI-1 header and of the 540 bytes of NIfTI-2. */
#include "io/image/image_private.h"

#include <stddef.h>
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

/* The members of struct nifti, and their place in each version. */
#define AT(member) offsetof(struct nifti, member), sizeof((struct nifti *)0)->member / sizeof(double)
static const struct field {
    size_t member, count;
    struct {
        int offset, type;
    } at[2];
} fields[] = {
    {AT(dim), {{40, I2}, {16, I8}}},       {AT(intent), {{68, I2}, {504, I4}}},
    {AT(datatype), {{70, I2}, {12, I2}}},  {AT(bits), {{72, I2}, {14, I2}}},
    {AT(pixdim), {{76, F4}, {104, F8}}},   {AT(offset), {{108, F4}, {168, I8}}},
    {AT(slope), {{112, F4}, {176, F8}}},   {AT(inter), {{116, F4}, {184, F8}}},
    {AT(units), {{123, I1}, {500, I4}}},   {AT(qform), {{252, I2}, {344, I4}}},
    {AT(sform), {{254, I2}, {348, I4}}},   {AT(quatern), {{256, F4}, {352, F8}}},
    {AT(qoffset), {{268, F4}, {376, F8}}}, {AT(srow), {{280, F4}, {400, F8}}},
};
enum { FIELDS = sizeof fields / sizeof *fields };

static const int description_offset[2] = {148, 240}, intent_name_offset[2] = {328, 508},
                 magic_offset[2] = {344, 4};
static const char magic1[] = "n+1", magic2[] = "n+2\0\r\n\032\n";

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
    for (int f = 0; f < FIELDS; f++) {
        nifti_get(nifti_type(fields[f].at[version - 1].type), bytes + fields[f].at[version - 1].offset,
                  swapped, fields[f].count, (double *)(void *)((char *)header + fields[f].member));
    }
    image->version = version;
    image->intent = (int)header->intent;
    copy_text(image->description, bytes + description_offset[version - 1], 80);
    copy_text(image->intent_name, bytes + intent_name_offset[version - 1], 16);
}

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
    double unit = image->unit == 1 || image->unit == 1e-6 ? image->unit : 1e-3; /* what NIfTI knows */
    struct nifti header = {.datatype = type->code,
                           .bits = 8 * type->bytes * type->components,
                           .intent = image->intent,
                           .pixdim = {1, 1, 1, 1, 1, 1, 1, 1},
                           .offset = size + 4,
                           .slope = image->slope,
                           .inter = image->inter,
                           .sform = image->space, /* an unknown space stays unknown */
                           .units = unit > 0.5      ? 1
                                    : unit > 0.5e-3 ? 2
                                                    : 3};
    sizes_of(image, type, header.dim);
    for (int i = 0; i < 12; i++) {
        header.srow[i / 4][i % 4] = image->to_world[i / 4][i % 4] / unit;
    }
    /* A map that a quaternion cannot represent is only in the sform. */
    if (nifti_quaternion(header.srow, header.quatern, header.pixdim)) {
        header.qform = image->space;
        for (int r = 0; r < 3; r++) {
            header.qoffset[r] = header.srow[r][3];
        }
    }
    memset(bytes, 0, NIFTI2_HEADER + 4);
    bytes[0] = (unsigned char)(size & 255);
    bytes[1] = (unsigned char)(size >> 8);
    for (int f = 0; f < FIELDS; f++) {
        const struct nifti_type *of = nifti_type(fields[f].at[version - 1].type);
        for (size_t i = 0; i < fields[f].count; i++) {
            nifti_put(of, ((const double *)(const void *)((const char *)&header + fields[f].member))[i],
                      bytes + fields[f].at[version - 1].offset + i * (size_t)of->bytes);
        }
    }
    memcpy(bytes + description_offset[version - 1], image->description, strlen(image->description));
    memcpy(bytes + intent_name_offset[version - 1], image->intent_name, strlen(image->intent_name));
    memcpy(bytes + magic_offset[version - 1], version == 1 ? magic1 : magic2, version == 1 ? 4 : 8);
    return (size_t)size + 4;
}
