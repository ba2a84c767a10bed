/* Writing images. */
#include "io/image/text_header.h"

#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

/* ---- headers of text ---- */

static void print_vector(FILE *file, const struct image *image, int column)
{
    fprintf(file, " (%.15g,%.15g,%.15g)", 0.0 - 1e3 * image->to_world[0][column],
            0.0 - 1e3 * image->to_world[1][column], 0.0 + 1e3 * image->to_world[2][column]);
}

/* Print the header of an image whose values are little-endian: in a file of their own, raw; or (NULL) behind
 * it, compressed by gzip in an NRRD file. */
static void nrrd_print(const struct image *image, const char *data_file, FILE *file)
{
    bool several = image->components > 1;
    bool vector = image->intent == IMAGE_INTENT_VECTOR || image->intent == IMAGE_INTENT_DISPLACEMENT;
    const char *kind = image->datatype == IMAGE_RGB24    ? " RGB-color"
                       : image->datatype == IMAGE_RGBA32 ? " RGBA-color"
                       : vector                          ? " vector"
                                                         : " list";
    fprintf(file, "NRRD0004\n# http://teem.sourceforge.net/nrrd/format.html\n");
    if (image->description[0] != '\0') {
        fprintf(file, "content: %s\n", image->description);
    }
    const char *names = nifti_type(image->datatype)->nrrd;
    fprintf(file,
            "type: %.*s\ndimension: %d\nspace: left-posterior-superior\nsizes:", (int)strcspn(names, "|"),
            names, several ? 4 : 3);
    if (several) {
        fprintf(file, " %zu", image->components);
    }
    fprintf(file, " %zu %zu %zu\nspace directions:%s", image->size[0], image->size[1], image->size[2],
            several ? " none" : "");
    for (int a = 0; a < 3; a++) {
        print_vector(file, image, a);
    }
    fprintf(file, "\nkinds:%s domain domain domain\nendian: little\nencoding: %s\nspace origin:",
            several ? kind : "", data_file != NULL ? "raw" : "gzip");
    print_vector(file, image, 3);
    fprintf(file, "\nspace units: \"mm\" \"mm\" \"mm\"\n");
    image_segments_print(image, file);
    data_file != NULL ? fprintf(file, "data file: %s\n", data_file) : fprintf(file, "\n");
}

static void metaimage_print(const struct image *image, const char *data_file, FILE *file)
{
    fprintf(file, "ObjectType = Image\nNDims = 3\n");
    if (image->description[0] != '\0') {
        fprintf(file, "Comment = %s\n", image->description);
    }
    fprintf(file,
            "BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix =");
    for (int a = 0; a < 3; a++) {
        double step = image_step(image, a);
        fprintf(file, " %.15g %.15g %.15g", 0.0 - image->to_world[0][a] / step,
                0.0 - image->to_world[1][a] / step, 0.0 + image->to_world[2][a] / step);
    }
    fprintf(file, "\nOffset = %.15g %.15g %.15g\nElementSpacing = %.15g %.15g %.15g\nDimSize = %zu %zu %zu\n",
            0.0 - 1e3 * image->to_world[0][3], 0.0 - 1e3 * image->to_world[1][3],
            0.0 + 1e3 * image->to_world[2][3], 1e3 * image_step(image, 0), 1e3 * image_step(image, 1),
            1e3 * image_step(image, 2), image->size[0], image->size[1], image->size[2]);
    if (image->components > 1) {
        fprintf(file, "ElementNumberOfChannels = %zu\n", image->components);
    }
    const char *names = nifti_type(image->datatype)->metaimage;
    fprintf(file, "ElementType = %.*s\nElementDataFile = %s\n", (int)strcspn(names, "|"), names,
            data_file != NULL ? data_file : "LOCAL");
}

/* ---- all formats ---- */

enum { BLOCK = 1 << 20, LEVEL = 6 };

void image_range(const struct image *image, double *least, double *most)
{
    const struct nifti_type *type = nifti_type(image->datatype);
    bool whole = type->most > type->least, scaled = type->components == 1;
    double ends[2] = {whole                         ? type->least
                      : type->code == IMAGE_FLOAT32 ? -FLT_MAX
                                                    : -DBL_MAX,
                      whole                         ? type->most
                      : type->code == IMAGE_FLOAT32 ? FLT_MAX
                                                    : DBL_MAX};
    for (int i = 0; i < 2 && scaled; i++) {
        ends[i] = fmax(fmin(ends[i] * image->slope + image->inter, DBL_MAX), -DBL_MAX);
    }
    *least = fmin(ends[0], ends[1]);
    *most = fmax(ends[0], ends[1]);
}

static bool is_scaled(const struct image *image, const struct nifti_type *type)
{
    return type->components == 1 && (image->slope != 1 || image->inter != 0);
}

/* Store all values, those of a voxel together or a volume for each component. */
static void store_values(const struct image *image, const struct nifti_type *type, bool together,
                         unsigned char *bytes)
{
    int64_t voxels = (int64_t)image_voxels(image), components = (int64_t)image->components;
    bool scaled = is_scaled(image, type);
#pragma omp parallel for schedule(static)
    for (int64_t v = 0; v < voxels; v++) {
        for (int64_t c = 0; c < components; c++) {
            double value = image->values[v * components + c];
            int64_t at = together ? v * components + c : c * voxels + v;
            nifti_put(type, scaled ? (value - image->inter) / image->slope : value, bytes + at * type->bytes);
        }
    }
}

/* Write a gzip file of one member, without name and time. */
static enum status write_gzip(const unsigned char *bytes, size_t size, FILE *file, struct error *error)
{
    z_stream stream = {0};
    NEW_SCRATCH(unsigned char, packed, BLOCK, error);
    if (deflateInit2(&stream, LEVEL, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        return fail_memory(error, "compressed image");
    }
    stream.next_in = (unsigned char *)(uintptr_t)bytes; /* zlib's const */
    for (int code = Z_OK; code != Z_STREAM_END && ferror(file) == 0;) {
        size_t left = size - (size_t)(stream.next_in - bytes);
        stream.avail_in = (unsigned)(left < BLOCK ? left : BLOCK);
        stream.next_out = packed;
        stream.avail_out = BLOCK;
        code = deflate(&stream, left <= BLOCK ? Z_FINISH : Z_NO_FLUSH);
        (void)fwrite(packed, 1, BLOCK - stream.avail_out, file);
    }
    deflateEnd(&stream);
    return STATUS_OK;
}

/* Write the first `offset` bytes and behind them all values, those of a voxel together or a volume for each
 * component. */
static enum status write_values(const struct image *image, const unsigned char *begin, size_t offset,
                                bool together, bool packed, FILE *file, struct error *error)
{
    const struct nifti_type *type = nifti_type(image->datatype);
    size_t size = offset + image_voxels(image) * image->components * (size_t)type->bytes;
    SCRATCH unsigned char *bytes = NULL;
    RETURN_IF_ERROR(RESIZE_ARRAY(&bytes, (int64_t)size, error));
    if (offset > 0) {
        memcpy(bytes, begin, offset);
    }
    store_values(image, type, together, bytes + offset);
    if (packed) {
        return write_gzip(bytes, size, file, error);
    }
    (void)fwrite(bytes, 1, size, file);
    return STATUS_OK;
}

/* The image without scaling, which headers of text do not know; its values are those of the image. */
static enum status unscaled(const struct image *image, struct image *plain, struct error *error)
{
    const struct nifti_type *type = nifti_type(image->datatype);
    if (type == NULL || (type->components > 1 && image->components != (size_t)type->components)) {
        return fail(error, STATUS_INPUT, "%zu components do not fit values of type %d", image->components,
                    image->datatype);
    }
    *plain = *image;
    if (is_scaled(image, type)) { /* a type that holds scaled values */
        plain->datatype = type->code == IMAGE_FLOAT32 || type->bytes < 4 ? IMAGE_FLOAT32 : IMAGE_FLOAT64;
    }
    plain->slope = 1;
    plain->inter = 0;
    return STATUS_OK;
}

enum status image_write_data(const struct image *image, FILE *file, struct error *error)
{
    struct image plain;
    RETURN_IF_ERROR(unscaled(image, &plain, error));
    return write_values(&plain, NULL, 0, true, false, file, error);
}

enum status image_write(const struct image *image, FILE *file, enum image_format format,
                        const char *data_file, struct error *error)
{
    unsigned char header[NIFTI_MOST];
    struct image plain;
    RETURN_IF_ERROR(unscaled(image, &plain, error));
    if (format == IMAGE_NRRD || format == IMAGE_METAIMAGE) {
        format == IMAGE_NRRD ? nrrd_print(&plain, data_file, file) : metaimage_print(&plain, data_file, file);
        return data_file != NULL ? STATUS_OK
                                 : write_values(&plain, NULL, 0, true, format == IMAGE_NRRD, file, error);
    }
    size_t offset = nifti_encode(image, header);
    return write_values(image, header, offset, nifti_type(image->datatype)->components > 1,
                        format == IMAGE_NIFTI_GZIP, file, error);
}
