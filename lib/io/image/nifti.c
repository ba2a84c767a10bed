/* The headers of NIfTI. */
#include "io/image/text_header.h"

#include "base/vector.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { NIFTI1_HEADER = 348, NIFTI2_HEADER = 540 };

/* The fields that are used, in the file's units. */
struct nifti {
    int version;
    bool swapped;
    bool pair; /* the data are in a file of their own */
    double dim[8], datatype, bits, intent, pixdim[8], offset, slope, inter, qform, sform, units;
    double quatern[3], qoffset[3], srow[3][4];
};

/* ---- the map from voxels to world coordinates: sform, qform, voxel sizes ---- */

/* NIfTI-1 standard, "quaternion representation of rotation matrix"; lengths and signs in pixdim. */
static void from_qform(const struct nifti *header, double m[3][4])
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2];
    double rest = 1 - b * b - c * c - d * d, a = sqrt(fmax(rest, 0));
    if (rest < 1e-7) { /* half a turn; b, c, d are rounded */
        double length = sqrt(b * b + c * c + d * d);
        a = 0, b /= length, c /= length, d /= length;
    }
    const double rotation[3][3] = {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
                                   {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
                                   {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
    double side = header->pixdim[0] < 0 ? -1 : 1;
    for (int r = 0; r < 3; r++) {
        m[r][0] = rotation[r][0] * fabs(header->pixdim[1]);
        m[r][1] = rotation[r][1] * fabs(header->pixdim[2]);
        m[r][2] = rotation[r][2] * fabs(header->pixdim[3]) * side;
        m[r][3] = header->qoffset[r];
    }
}

/* The quaternion (b, c, d), voxel sizes and qfac of the first three columns of a matrix; false if these are
 * not orthogonal. */
static bool quaternion_of(double matrix[3][4], double quatern[3], double pixdim[4])
{
    double r[3][3];
    for (int c = 0; c < 3; c++) {
        pixdim[1 + c] =
            sqrt(matrix[0][c] * matrix[0][c] + matrix[1][c] * matrix[1][c] + matrix[2][c] * matrix[2][c]);
    }
    pixdim[0] = determinant3(matrix[0], matrix[1], matrix[2]) < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 3; i++) {
            r[i][c] = matrix[i][c] / pixdim[1 + c] * (c == 2 ? pixdim[0] : 1);
        }
    }
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3;
        if (fabs(r[0][c] * r[0][e] + r[1][c] * r[1][e] + r[2][c] * r[2][e]) > 1e-5) {
            return false;
        }
    }
    /* (1 + trace) / 4 is a^2; with two signs changed it is b^2, c^2 or d^2. The largest of these divides. */
    double square[4] = {1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                        1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
    double product[4][4] = {{square[0], r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]},
                            {r[2][1] - r[1][2], square[1], r[0][1] + r[1][0], r[0][2] + r[2][0]},
                            {r[0][2] - r[2][0], r[0][1] + r[1][0], square[2], r[1][2] + r[2][1]},
                            {r[1][0] - r[0][1], r[0][2] + r[2][0], r[1][2] + r[2][1], square[3]}};
    int largest = 0;
    for (int i = 1; i < 4; i++) {
        largest = square[i] > square[largest] ? i : largest;
    }
    double scale = (product[largest][0] < 0 ? -0.5 : 0.5) / sqrt(square[largest]); /* a >= 0 */
    for (int i = 0; i < 3; i++) {
        quatern[i] = scale * product[largest][1 + i];
    }
    return true;
}

/* Set image->to_world, unit and space from a header, and note assumptions. */
static enum status nifti_space(const struct nifti *header, struct image *image, struct error *error)
{
    static const double unit[] = {1e-3, 1, 1e-3, 1e-6};
    double matrix[3][4] = {{0}};
    const char *form = "its voxel sizes (pixdim)";
    int units = (int)header->units & 7;
    if (units > 3) {
        return fail(error, STATUS_INPUT, "header: unknown unit of length %d: metres are 1, mm 2, um 3",
                    units);
    }
    if (units == 0) {
        image_note(image, "no unit of length: millimetres taken");
    }
    image->unit = unit[units];
    if (header->sform > 0) {
        form = "its sform";
        memcpy(matrix, header->srow, sizeof matrix);
        image->space = (int)header->sform;
    } else if (header->qform > 0) {
        form = "its qform";
        from_qform(header, matrix);
        image->space = (int)header->qform;
    } else {
        for (int i = 0; i < 3; i++) {
            matrix[i][i] = fabs(header->pixdim[1 + i]);
        }
        image_note(image, "has neither sform nor qform: first voxel at the origin, axes taken to be RAS");
    }
    if (header->sform > 0 && header->qform > 0) {
        struct image other = *image;
        memcpy(image->to_world, matrix, sizeof matrix);
        from_qform(header, other.to_world);
        if (!(image_distance(image, &other) <= 0.5 * fmin(image_step(image, 0), image_step(image, 1)))) {
            image_note(image, "sform and qform differ by more than half a voxel: sform taken");
        }
    }
    for (int i = 0; i < 12; i++) {
        matrix[i / 4][i % 4] *= image->unit;
    }
    return image_place(image, matrix, form, error);
}

/* ---- the layout of the 348 bytes of a header of NIfTI-1 and of the 540 bytes of NIfTI-2 ---- */

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
static const char magic1[] = "n+1",
                  magic2[] = "n+2\0\r\n\032\n"; /* 'i' for '+': data in a file of their own */

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

/* Decode a whole header of that version. STATUS_INPUT without the mark of NIfTI. */
static enum status nifti_decode(const unsigned char *bytes, int version, bool swapped, struct nifti *header,
                                struct image *image, struct error *error)
{
    char magic[4];
    memcpy(magic, bytes + magic_offset[version - 1], sizeof magic);
    *header = (struct nifti){.version = version, .swapped = swapped, .pair = magic[1] == 'i'};
    magic[1] = (char)(header->pair ? '+' : magic[1]);
    if (memcmp(magic, version == 1 ? magic1 : magic2, sizeof magic) != 0) {
        return fail(error, STATUS_INPUT,
                    version == 1 ? "is an ANALYZE 7.5 header, which knows no orientation: convert it to NIfTI"
                                 : "header: no mark of NIfTI-2: damaged");
    }
    for (int f = 0; f < FIELDS; f++) {
        nifti_get(nifti_type(fields[f].at[version - 1].type), bytes + fields[f].at[version - 1].offset,
                  swapped, fields[f].count, (double *)(void *)((char *)header + fields[f].member));
    }
    image->version = version;
    image->intent = (int)header->intent;
    copy_text(image->description, bytes + description_offset[version - 1], 80);
    copy_text(image->intent_name, bytes + intent_name_offset[version - 1], 16);
    return STATUS_OK;
}

/* Check sizes and components: their product fits into memory sizes. */
static enum status check_sizes(const struct nifti *header, const struct image_layout *layout,
                               struct image *image, struct error *error)
{
    const struct nifti_type *type = layout->type;
    double size[8] = {0, 1, 1, 1, 1, 1, 1, 1};
    if (!(header->dim[0] >= 2 && header->dim[0] <= 7)) {
        return fail(error, STATUS_INPUT, "header: %.0f dimensions: an image has 2 or 3", header->dim[0]);
    }
    int dimensions = (int)header->dim[0];
    for (int i = 1; i <= dimensions; i++) {
        size[i] = header->dim[i];
        if (!(size[i] >= 1 && size[i] <= INT32_MAX)) {
            return fail(error, STATUS_INPUT,
                        "header: size %.0f along dimension %d: from 1 to 2^31 - 1 is possible", size[i], i);
        }
    }
    if (size[4] == 3 && size[5] <= 1) { /* a vector at each voxel, as other programs write it */
        size[5] = size[4];
        size[4] = 1;
    }
    if (size[4] > 1) {
        return fail(error, STATUS_INPUT,
                    "holds %.0f volumes (4-D): choose one and save it as an image of its own", size[4]);
    }
    if (size[6] > 1 || size[7] > 1) {
        return fail(error, STATUS_INPUT, "header: %d dimensions: one value or vector at each voxel is read",
                    dimensions);
    }
    if (size[5] > 1 && type->components > 1) {
        return fail(error, STATUS_INPUT, "header: vectors of colours");
    }
    return header_sizes(size + 1, size[5] * type->components, false, layout, image, error);
}

/* Check a header; set the image and the layout of the values, which are `taken` bytes further on. */
static enum status check_header(const struct nifti *header, int64_t taken, struct image *image,
                                struct image_layout *layout, struct error *error)
{
    const struct nifti_type *type = nifti_type((int)header->datatype);
    double least = header->pair ? 0 : header->version == 1 ? NIFTI1_HEADER + 4 : NIFTI2_HEADER + 4;
    if (type == NULL) {
        return fail(
            error, STATUS_INPUT,
            "header: values of type %d: integers of 8 to 64 bits, floats of 32 and 64, RGB and RGBA are read",
            (int)header->datatype);
    }
    int bits = 8 * type->bytes * type->components;
    if (header->bits != 0 && header->bits != bits) {
        return fail(error, STATUS_INPUT, "header: %.0f bits a voxel, but %s has %d", header->bits, type->name,
                    bits);
    }
    if (header->offset != 0 &&
        !(header->offset >= least && header->offset <= 9e15 && header->offset == floor(header->offset))) {
        return fail(error, STATUS_INPUT, "header: data from byte %g: must be a whole number, at least %.0f",
                    header->offset, least);
    }
    if (isinf(header->slope) || isinf(header->inter)) {
        return fail(error, STATUS_INPUT,
                    "header: scaling of the values is not finite (scl_slope, scl_inter)");
    }
    image->slope = 1;
    if (header->slope != 0 && !isnan(header->slope) && type->components == 1) {
        image->slope = header->slope;
        image->inter = isnan(header->inter) ? 0 : header->inter;
    }
    layout->type = type;
    layout->swapped = header->swapped;
    layout->together = type->components > 1;
    layout->skip_bytes = (int64_t)fmax(header->offset, least) - (header->pair ? 0 : taken);
    return check_sizes(header, layout, image, error);
}

/* The file of data of the header NAME.hdr is NAME.img, that of NAME.hdr.gz is NAME.img.gz. */
static enum status name_partner(const char *name, struct image_layout *layout, struct error *error)
{
    const char *base = strrchr(name, '/') != NULL ? strrchr(name, '/') + 1 : name,
               *end = strstr(base, ".hdr");
    if (end == NULL || strlen(base) >= sizeof layout->data_file ||
        !(strcmp(end, ".hdr") == 0 || strcmp(end, ".hdr.gz") == 0)) {
        return fail(error, STATUS_INPUT,
                    "is a header whose data are in a file of their own: give its name, which ends in .hdr");
    }
    snprintf(layout->data_file, sizeof layout->data_file, "%s", base);
    memcpy(layout->data_file + (end - base), ".img", 4);
    return STATUS_OK;
}

enum status nifti_header(struct image_bytes *file, const char *name, struct image *image,
                         struct image_layout *layout, struct error *error)
{
    struct nifti header;
    bool swapped = false;
    int version = nifti_version(file->bytes, &swapped);
    file->at = version == 1 ? NIFTI1_HEADER : NIFTI2_HEADER;
    if (file->size < file->at) {
        return fail(error, STATUS_INPUT, "cut short: %zu bytes of a header of %zu", file->size, file->at);
    }
    RETURN_IF_ERROR(nifti_decode(file->bytes, version, swapped, &header, image, error));
    RETURN_IF_ERROR(check_header(&header, (int64_t)file->at, image, layout, error));
    RETURN_IF_ERROR(nifti_space(&header, image, error));
    return header.pair ? name_partner(name, layout, error) : STATUS_OK;
}

/* ---- writing ---- */

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

size_t nifti_encode(const struct image *image, unsigned char bytes[NIFTI_MOST])
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
                           .sform = image->space,
                           .units = unit > 0.5      ? 1
                                    : unit > 0.5e-3 ? 2
                                                    : 3};
    sizes_of(image, type, header.dim);
    for (int i = 0; i < 12; i++) {
        header.srow[i / 4][i % 4] = image->to_world[i / 4][i % 4] / unit;
    }
    bool orthogonal = quaternion_of(header.srow, header.quatern, header.pixdim);
    /* An unknown space stays unknown where the sizes of voxels alone tell the map. */
    for (int i = 0; i < 12 && header.sform == IMAGE_SPACE_UNKNOWN; i++) {
        double plain = i / 4 == i % 4 ? header.pixdim[1 + i / 4] : 0;
        header.sform = header.srow[i / 4][i % 4] == plain ? IMAGE_SPACE_UNKNOWN : IMAGE_SPACE_ALIGNED;
    }
    /* A map that a quaternion cannot represent is only in the sform. */
    if (orthogonal) {
        header.qform = header.sform;
        for (int r = 0; r < 3; r++) {
            header.qoffset[r] = header.srow[r][3];
        }
    }
    memset(bytes, 0, NIFTI_MOST);
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
