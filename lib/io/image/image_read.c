/* Reading NIfTI files: the header is checked before it is used, and memory grows with the data. libnifti is
 * not used: version 3.0.1 accepts a compressed file without checksum and a header with fewer voxels than
 * there are, and it cannot read a pipe. */
#include "io/image/image_private.h"

#include "base/memory.h"
#include "io/files/descriptor.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t block_values = 1 << 16;
static const double exact_integers = 9007199254740992.0; /* 2^53: all up to there are doubles */
static const char pair_magic[] = "ni1";

/* The error for a file of another format, with the remedy. */
static enum status fail_foreign(const unsigned char *bytes, size_t size, struct error *error)
{
    static const struct {
        size_t offset;
        const char *text, *what;
    } known[] = {{128, "DICM", "a DICOM file: convert the series with dcm2niix"},
                 {0, "NRRD", "an NRRD file: save it as NIfTI (.nii.gz)"},
                 {0, "ObjectType", "a MetaImage file: save it as NIfTI (.nii.gz)"},
                 {0, "# mts", "an mts stream, where an image (NIfTI) is expected"},
                 {0, "$MeshFormat", "a mesh, where an image (NIfTI) is expected"}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        size_t length = strlen(known[k].text);
        if (size >= known[k].offset + length && memcmp(bytes + known[k].offset, known[k].text, length) == 0) {
            return fail(error, STATUS_INPUT, "is %s", known[k].what);
        }
    }
    return size == 0 ? fail(error, STATUS_INPUT, "is empty")
                     : fail(error, STATUS_INPUT,
                            "is no NIfTI image: save it as .nii or .nii.gz; of a pair give the .hdr file");
}

/* *pair: the data are in a file of their own. */
static enum status check_magic(const unsigned char *bytes, int version, bool *pair, struct error *error)
{
    const char *magic = (const char *)bytes + (version == 1 ? 344 : 4);
    *pair = memcmp(magic, version == 1 ? pair_magic : "ni2", 4) == 0;
    if (*pair || memcmp(magic, version == 1 ? "n+1" : "n+2", 4) == 0) {
        return STATUS_OK;
    }
    return version == 1 ? fail(error, STATUS_INPUT,
                               "is an ANALYZE 7.5 header, which knows no orientation: convert it to NIfTI")
                        : fail(error, STATUS_INPUT, "header: no mark of NIfTI-2: damaged");
}

/* Read and decode the header. */
static enum status read_header(struct image_source *source, struct nifti *header, struct image *image,
                               struct error *error)
{
    unsigned char bytes[NIFTI2_HEADER] = {0};
    size_t got, more;
    bool swapped = false;
    RETURN_IF_ERROR(image_source_take(source, bytes, NIFTI1_HEADER, &got, error));
    int version = got >= 4 ? nifti_version(bytes, &swapped) : 0;
    if (version == 0) {
        return fail_foreign(bytes, got, error);
    }
    size_t size = version == 1 ? NIFTI1_HEADER : NIFTI2_HEADER;
    if (got == NIFTI1_HEADER && size > got) {
        RETURN_IF_ERROR(image_source_take(source, bytes + got, size - got, &more, error));
        got += more;
    }
    if (got < size) {
        return fail(error, STATUS_INPUT, "cut short: %zu bytes of a header of %zu", got, size);
    }
    bool pair;
    RETURN_IF_ERROR(check_magic(bytes, version, &pair, error));
    nifti_decode(bytes, version, swapped, header, image);
    header->pair = pair;
    return STATUS_OK;
}

/* Check sizes and components; *count: their product, which fits into memory sizes. */
static enum status check_sizes(const struct nifti *header, const struct nifti_type *type, struct image *image,
                               size_t *count, struct error *error)
{
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
    image->components = (size_t)size[5] * (size_t)type->components;
    *count = image->components;
    for (int i = 0; i < 3; i++) {
        image->size[i] = (size_t)size[1 + i];
        if (__builtin_mul_overflow(*count, image->size[i], count) || *count > SIZE_MAX / 32) {
            return fail(error, STATUS_INPUT, "header: %.0f x %.0f x %.0f voxels: more than any memory",
                        size[1], size[2], size[3]);
        }
    }
    return STATUS_OK;
}

static enum status check_header(const struct nifti *header, const struct nifti_type **type,
                                struct image *image, size_t *count, struct error *error)
{
    double least = header->pair ? 0 : header->version == 1 ? NIFTI1_HEADER + 4 : NIFTI2_HEADER + 4;
    *type = nifti_type(header->datatype);
    if (*type == NULL) {
        return fail(
            error, STATUS_INPUT,
            "header: values of type %d: integers of 8 to 64 bits, floats of 32 and 64, RGB and RGBA are read",
            header->datatype);
    }
    int bits = 8 * (*type)->bytes * (*type)->components;
    if (header->bits != 0 && header->bits != bits) {
        return fail(error, STATUS_INPUT, "header: %d bits a voxel, but %s has %d", header->bits,
                    (*type)->name, bits);
    }
    if (header->offset != 0 && !(header->offset >= least && header->offset <= exact_integers &&
                                 header->offset == floor(header->offset))) {
        return fail(error, STATUS_INPUT, "header: data from byte %g: must be a whole number, at least %.0f",
                    header->offset, least);
    }
    if (isinf(header->slope) || isinf(header->inter)) {
        return fail(error, STATUS_INPUT,
                    "header: scaling of the values is not finite (scl_slope, scl_inter)");
    }
    image->datatype = header->datatype;
    image->slope = 1;
    if (header->slope != 0 && !isnan(header->slope) && (*type)->components == 1) {
        image->slope = header->slope;
        image->inter = isnan(header->inter) ? 0 : header->inter;
    }
    return check_sizes(header, *type, image, count, error);
}

/* Skip the extensions between the header and the data. */
static enum status skip_extensions(struct image_source *source, const struct nifti *header,
                                   unsigned char *scratch, size_t room, struct error *error)
{
    int64_t offset = header->offset > 0     ? (int64_t)header->offset
                     : header->pair         ? 0
                     : header->version == 1 ? NIFTI1_HEADER + 4
                                            : NIFTI2_HEADER + 4;
    while (source->taken < offset) {
        size_t left = (size_t)(offset - source->taken), got;
        RETURN_IF_ERROR(image_source_take(source, scratch, left < room ? left : room, &got, error));
        if (got == 0) {
            return fail(error, STATUS_INPUT,
                        "cut short: %lld bytes, the header says that data begin at byte %lld",
                        (long long)source->taken, (long long)offset);
        }
    }
    return STATUS_OK;
}

/* Read the data: `count` values, and nothing behind them. */
static enum status read_values(struct image_source *source, const struct nifti *header,
                               const struct nifti_type *type, size_t count, struct image *image,
                               struct error *error)
{
    size_t size = (size_t)type->bytes, done_count = 0, capacity = 0, got;
    NEW_SCRATCH(unsigned char, block, (int64_t)(block_values * size + 8), error);
    RETURN_IF_ERROR(skip_extensions(source, header, block, block_values * size, error));
    while (done_count < count) {
        size_t wanted = count - done_count < block_values ? count - done_count : block_values;
        RETURN_IF_ERROR(image_source_take(source, block, wanted * size, &got, error));
        if (got < wanted * size) {
            return fail(error, STATUS_INPUT, "cut short: data of %zu bytes, the header says %zu",
                        done_count * size + got, count * size);
        }
        if (done_count + wanted > capacity) {
            capacity = 2 * capacity < count ? 2 * capacity + 4 * block_values : count;
            capacity = capacity < count ? capacity : count;
            RETURN_IF_ERROR(RESIZE_ARRAY(&image->values, (int64_t)capacity, error));
        }
        nifti_get(type, block, header->swapped, wanted, image->values + done_count);
        done_count += wanted;
    }
    RETURN_IF_ERROR(image_source_take(source, block, 1, &got, error));
    if (got > 0) {
        return fail(error, STATUS_INPUT,
                    "more data than %zu bytes, as the header says: it lies about size or type", count * size);
    }
    return STATUS_OK;
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

static enum status read_data(struct image_source *source, const struct nifti *header,
                             const struct nifti_type *type, size_t count, struct image *image,
                             struct error *error)
{
    RETURN_IF_ERROR(read_values(source, header, type, count, image, error));
    RETURN_IF_ERROR(check_exact(type, count, image->values, error));
    if (image->components > (size_t)type->components) {
        RETURN_IF_ERROR(interleave(image, error));
    }
    for (size_t i = 0; i < count && (image->slope != 1 || image->inter != 0); i++) {
        image->values[i] = image->slope * image->values[i] + image->inter;
    }
    return STATUS_OK;
}

/* Read the data of the header NAME.hdr from NAME.img, those of NAME.hdr.gz from NAME.img.gz. */
static enum status read_partner(const char *name, const struct nifti *header, const struct nifti_type *type,
                                size_t count, struct image *image, struct error *error)
{
    size_t length = strlen(name),
           end = length > 3 && strcmp(name + length - 3, ".gz") == 0 ? length - 3 : length;
    struct image_source source;
    if (end < 4 || strncmp(name + end - 4, ".hdr", 4) != 0) {
        return fail(error, STATUS_INPUT,
                    "is a header whose data are in a file of their own: give its name, which ends in .hdr");
    }
    SCRATCH char *partner = strdup(name);
    if (partner == NULL) {
        return fail_memory(error, "the name of a file");
    }
    memcpy(partner + end - 4, ".img", 4);
    FREED_BY(descriptor_close) int descriptor = open(partner, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return fail(error, STATUS_INPUT, "its data, %s: %s", partner, strerror(errno));
    }
    enum status status = image_source_open(&source, descriptor, error);
    if (status == STATUS_OK) {
        status = read_data(&source, header, type, count, image, error);
    }
    image_source_close(&source);
    return fail_in(error, status, "its data, %s", partner);
}

static enum status read_source(struct image_source *source, const char *name, struct image *image,
                               struct error *error)
{
    struct nifti header;
    const struct nifti_type *type;
    size_t count = 0;
    RETURN_IF_ERROR(read_header(source, &header, image, error));
    RETURN_IF_ERROR(check_header(&header, &type, image, &count, error));
    RETURN_IF_ERROR(nifti_space(&header, image, error));
    return header.pair ? read_partner(name, &header, type, count, image, error)
                       : read_data(source, &header, type, count, image, error);
}

enum status image_read_from(struct image *image, int descriptor, const char *name, struct error *error)
{
    struct image_source source;
    *image = (struct image){0};
    enum status status = image_source_open(&source, descriptor, error);
    if (status == STATUS_OK) {
        status = read_source(&source, name, image, error);
    }
    image_source_close(&source);
    if (status != STATUS_OK) {
        image_free(image);
    }
    return fail_in(error, status, "%s", name);
}
