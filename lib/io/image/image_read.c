/* Reading images: the header is checked before it is used. libnifti is
 * not used: version 3.0.1 accepts a compressed file without checksum and a header with fewer voxels than
 * there are, and it cannot read a pipe. */
#include "io/image/text_header.h"

#include "base/memory.h"
#include "io/files/textfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const double exact_integers = 9007199254740992.0; /* 2^53: all up to there are doubles */

static enum status fail_foreign(const unsigned char *bytes, size_t size, struct error *error)
{
    static const struct {
        size_t offset;
        const char *text, *what;
    } known[] = {{128, "DICM", "a DICOM file: convert the series with dcm2niix"},
                 {0, "# mts", "an mts stream, where an image is expected"},
                 {0, "$MeshFormat", "a mesh, where an image is expected"}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        size_t length = strlen(known[k].text);
        if (size >= known[k].offset + length && memcmp(bytes + known[k].offset, known[k].text, length) == 0) {
            return fail(error, STATUS_INPUT, "is %s", known[k].what);
        }
    }
    return size == 0 ? fail(error, STATUS_INPUT, "is empty")
                     : fail(error, STATUS_INPUT,
                            "is no image of NIfTI, NRRD or MetaImage: save it as .nii.gz; of a pair give the "
                            "header's file");
}

static enum status read_header(struct image_bytes *file, struct nifti *header, struct image *image,
                               struct error *error)
{
    bool swapped = false;
    int version = file->size >= 4 ? nifti_version(file->bytes, &swapped) : 0;
    if (version == 0) {
        return fail_foreign(file->bytes, file->size, error);
    }
    file->at = version == 1 ? NIFTI1_HEADER : NIFTI2_HEADER;
    if (file->size < file->at) {
        return fail(error, STATUS_INPUT, "cut short: %zu bytes of a header of %zu", file->size, file->at);
    }
    return nifti_decode(file->bytes, version, swapped, header, image, error);
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
    if (header->offset != 0 && !(header->offset >= least && header->offset <= exact_integers &&
                                 header->offset == floor(header->offset))) {
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

/* Open a file of data in the folder of the header (its first `folder` bytes) or below: links that lead
 * elsewhere are refused. */
static enum status open_partner(const char *partner, size_t folder, int *descriptor, struct error *error)
{
    char of_header[PATH_MAX], of_data[PATH_MAX];
    NEW_SCRATCH(char, begin, (int64_t)folder + 2, error);
    struct stat facts;
    memcpy(begin, folder > 0 ? partner : ".", folder > 0 ? folder : 1);
    if (realpath(begin, of_header) == NULL || realpath(partner, of_data) == NULL) {
        return fail(error, STATUS_INPUT, "its data, %s: %s", partner, strerror(errno));
    }
    size_t length = strlen(of_header);
    length -= of_header[length - 1] == '/'; /* the root */
    if (strncmp(of_header, of_data, length) != 0 || of_data[length] != '/') {
        return fail(error, STATUS_INPUT,
                    "its data, %s: is a link that leaves the folder of the header: put the file there",
                    partner);
    }
    *descriptor = open(of_data, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK | O_NOFOLLOW);
    return *descriptor >= 0 && fstat(*descriptor, &facts) == 0 && S_ISREG(facts.st_mode)
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "its data, %s: %s", partner,
                      *descriptor < 0 ? strerror(errno) : "is a folder, pipe or device, not a file");
}

/* Read data that are in a file of their own, beside the header `name`. */
static enum status read_partner(const char *name, const struct image_layout *layout, struct image *image,
                                struct error *error)
{
    FREED_BY(image_bytes_free) struct image_bytes file = {0};
    size_t folder = strrchr(name, '/') != NULL ? (size_t)(strrchr(name, '/') + 1 - name) : 0;
    NEW_SCRATCH(char, partner, (int64_t)(folder + sizeof layout->data_file), error);
    memcpy(partner, name, folder);
    memcpy(partner + folder, layout->data_file, sizeof layout->data_file);
    FREED_BY(descriptor_close) int descriptor = -1;
    RETURN_IF_ERROR(open_partner(partner, folder, &descriptor, error));
    enum status status = image_bytes_read(descriptor, true, &file, error);
    if (status == STATUS_OK) {
        status = image_values_read(&file, layout, image, error);
    }
    return fail_in(error, status, "its data, %s", partner);
}

static enum status read_file(struct image_bytes *file, const char *name, struct image *image,
                             struct error *error)
{
    struct image_layout layout = {0};
    image->slope = 1;
    image->version = 1;
    if (file->size >= 4 && memcmp(file->bytes, "NRRD", 4) == 0) {
        image->format = IMAGE_NRRD;
        RETURN_IF_ERROR(nrrd_header(file, image, &layout, error));
    } else if (file->size >= 4 && metaimage_begins(file->bytes)) {
        image->format = IMAGE_METAIMAGE;
        RETURN_IF_ERROR(metaimage_header(file, image, &layout, error));
    } else {
        image->format = file->was_packed ? IMAGE_NIFTI_GZIP : IMAGE_NIFTI;
        struct nifti header;
        RETURN_IF_ERROR(read_header(file, &header, image, error));
        RETURN_IF_ERROR(check_header(&header, (int64_t)file->at, image, &layout, error));
        RETURN_IF_ERROR(nifti_space(&header, image, error));
        RETURN_IF_ERROR(header.pair ? name_partner(name, &layout, error) : STATUS_OK);
    }
    if (layout.skip_bytes < 0 && layout.encoding != IMAGE_RAW) {
        return fail(error, STATUS_INPUT, "header: a skip of -1 goes with raw data only");
    }
    return layout.data_file[0] != '\0' ? read_partner(name, &layout, image, error)
                                       : image_values_read(file, &layout, image, error);
}

enum status image_read_from(struct image *image, int descriptor, const char *name, struct error *error)
{
    FREED_BY(image_bytes_free) struct image_bytes file = {0};
    *image = (struct image){0};
    enum status status = image_bytes_read(descriptor, false, &file, error);
    if (status == STATUS_OK) {
        status = read_file(&file, name, image, error);
    }
    if (status != STATUS_OK) {
        image_free(image);
    }
    return fail_in(error, status, "%s", name);
}
