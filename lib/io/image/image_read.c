/* Reading images: the header is checked before it is used. libnifti is
 * not used: version 3.0.1 accepts a compressed file without checksum and a header with fewer voxels than
 * there are, and it cannot read a pipe. */
#include "io/image/image_private.h"

#include "base/memory.h"
#include "base/vector.h"
#include "io/files/textfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

/* ---- bytes ---- */

enum { STRIDE = 1 << 20 };

/* Append what `packed` holds, members of gzip or zlib up to the end. zlib's gzread is not used: it accepts a
 * file without its checksum if the data end with a block. */
static enum status inflate_all(const unsigned char *packed, size_t left, struct image_bytes *file,
                               struct error *error)
{
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)packed}; /* zlib's const */
    int64_t room = 0;
    int code = inflateInit2(&stream, 15 + 32);
    enum status status = code == Z_OK ? STATUS_OK : fail_memory(error, "compressed image");
    while (status == STATUS_OK && (left > 0 || stream.avail_in > 0)) {
        size_t some = stream.avail_in == 0 ? left < STRIDE ? left : STRIDE : 0;
        stream.avail_in += (unsigned)some;
        left -= some;
        if (code == Z_STREAM_END) { /* another member follows */
            inflateReset(&stream);
        }
        status = GROW_ARRAY(&file->bytes, (int64_t)file->size + STRIDE + ROOM_BEHIND, &room, error);
        if (status != STATUS_OK) {
            break;
        }
        stream.next_out = file->bytes + file->size;
        stream.avail_out = STRIDE;
        code = inflate(&stream, Z_NO_FLUSH);
        file->size += STRIDE - stream.avail_out;
        if (code == Z_MEM_ERROR) {
            status = fail_memory(error, "compressed image");
        } else if (code != Z_OK && code != Z_BUF_ERROR && code != Z_STREAM_END) {
            status = fail(error, STATUS_INPUT, "damaged gzip file (%s), behind byte %zu of its contents",
                          stream.msg != NULL ? stream.msg : "not one", file->size);
        }
    }
    inflateEnd(&stream);
    if (status == STATUS_OK && file->bytes != NULL) {
        memset(file->bytes + file->size, 0, ROOM_BEHIND);
    }
    return status != STATUS_OK || code == Z_STREAM_END
               ? status
               : fail(error, STATUS_INPUT, "compressed file cut short, behind byte %zu of its contents",
                      file->size);
}

/* What follows is compressed by gzip or zlib: keep what it holds. */
static enum status image_bytes_unpack(struct image_bytes *file, struct error *error)
{
    struct image_bytes unpacked = {.was_packed = true};
    enum status status = inflate_all(file->bytes + file->at, file->size - file->at, &unpacked, error);
    free(file->bytes);
    *file = unpacked;
    return status;
}

static bool is_packed(const unsigned char *bytes, size_t size)
{
    return size >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

static bool goes_on(const char *text, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)text;
    bool swapped;
    return is_packed(bytes, size) || memcmp(bytes, "NRRD", 4) == 0 || metaimage_begins(bytes) ||
           nifti_version(bytes, &swapped) > 0;
}

/* Read a file out of gzip; of what is no image, unless `any` is wanted, only the beginning. */
static enum status image_bytes_read(int descriptor, bool any, struct image_bytes *file, struct error *error)
{
    RETURN_IF_ERROR(descriptor_read_all(descriptor, SIZE_MAX, any ? NULL : goes_on, (char **)&file->bytes,
                                        &file->size, error));
    return is_packed(file->bytes, file->size) ? image_bytes_unpack(file, error) : STATUS_OK;
}

static void image_bytes_free(struct image_bytes *file)
{
    free(file->bytes);
    *file = (struct image_bytes){0};
}

/* ---- values ---- */

static const double exact_integers = 9007199254740992.0; /* 2^53: all up to there are doubles */

/* Move to the first of `size` bytes of values. */
static enum status skip(struct image_bytes *file, const struct image_layout *layout, size_t size,
                        struct error *error)
{
    for (int64_t line = 0; line < layout->skip_lines && file->at < file->size; line++) {
        const char *text = (const char *)file->bytes + file->at,
                   *end = memchr(text, '\n', file->size - file->at);
        file->at = end != NULL ? file->at + (size_t)(end + 1 - text) : file->size;
    }
    if (layout->encoding == IMAGE_PACKED && !(layout->data_file[0] != '\0' && file->was_packed)) {
        RETURN_IF_ERROR(image_bytes_unpack(file, error));
    }
    size_t left = file->size - file->at;
    if (layout->skip_bytes < 0) {
        if (left < size) {
            return fail(error, STATUS_INPUT, "cut short: the header says %zu bytes of data", size);
        }
        file->at = file->size - size;
    } else if ((size_t)layout->skip_bytes > left) {
        return fail(error, STATUS_INPUT, "cut short: %zu bytes, the header says that data begin at byte %zu",
                    file->size, file->at + (size_t)layout->skip_bytes);
    } else {
        file->at += (size_t)layout->skip_bytes;
    }
    return STATUS_OK;
}

/* Read at most `count` numbers of text between blanks; *got: how many there are, and one if there are more.
 */
static enum status read_words(const struct image_bytes *file, const struct nifti_type *type, size_t count,
                              double *values, size_t *got, struct error *error)
{
    const char *at = (const char *)file->bytes + file->at, *end = (const char *)file->bytes + file->size;
    bool whole = type->most > type->least;
    for (*got = 0; *got <= count; ++*got) {
        char *behind;
        at += strspn(at, " \t\r\n,");
        if (at == end || *got == count) {
            *got += at < end;
            return STATUS_OK;
        }
        double value = strtod(at, &behind);
        if (behind == at || (behind < end && strchr(" \t\r\n,", *behind) == NULL) ||
            (whole && !(value == floor(value) && value >= type->least && value <= type->most))) {
            return fail(error, STATUS_INPUT, "value %zu, '%.*s': not of the type %s", *got,
                        (int)strcspn(at, " \t\r\n,") < 20 ? (int)strcspn(at, " \t\r\n,") : 20, at,
                        type->name);
        }
        values[*got] = value;
        at = behind;
    }
    return STATUS_OK;
}

/* Read the data: `count` values, and nothing behind them. */
static enum status read_values(struct image_bytes *file, const struct image_layout *layout, size_t count,
                               struct image *image, struct error *error)
{
    size_t size = (size_t)layout->type->bytes, got;
    bool is_text = layout->encoding == IMAGE_ASCII;
    RETURN_IF_ERROR(skip(file, layout, count * size, error));
    size_t left = file->size - file->at, most = is_text ? left / 2 + 1 : left / size;
    RETURN_IF_ERROR(RESIZE_ARRAY(&image->values, (int64_t)(count < most ? count : most), error));
    if (is_text) {
        RETURN_IF_ERROR(read_words(file, layout->type, count, image->values, &got, error));
    } else {
        got = left > count * size ? count + 1 : most;
    }
    if (got < count) {
        return fail(error, STATUS_INPUT, "cut short: %zu values, the header says %zu", got, count);
    }
    if (got > count) {
        return fail(error, STATUS_INPUT,
                    "more data than %zu values, as the header says: it lies about size or type", count);
    }
    if (!is_text) {
        nifti_get(layout->type, file->bytes + file->at, layout->swapped, count, image->values);
    }
    return STATUS_OK;
}

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

static void turn_vector(const double turn[3][3], size_t components, double *vector)
{
    double before[3];
    memcpy(before, vector, components * sizeof *vector);
    for (size_t r = 0; r < components; r++) {
        vector[r] = 0;
        for (size_t c = 0; c < components; c++) {
            vector[r] += turn[r][c] != 0 ? turn[r][c] * before[c] : 0; /* no NaN of another component */
        }
    }
}

/* Read the values of an image whose sizes and scaling are set, and check that nothing follows them. */
static enum status image_values_read(struct image_bytes *file, const struct image_layout *layout,
                                     struct image *image, struct error *error)
{
    size_t components = image->components, count = image_voxels(image) * components;
    RETURN_IF_ERROR(read_values(file, layout, count, image, error));
    RETURN_IF_ERROR(check_exact(layout->type, count, image->values, error));
    if (!layout->together && components > 1) {
        RETURN_IF_ERROR(interleave(image, error));
    }
    for (size_t i = 0; i < count && (image->slope != 1 || image->inter != 0); i++) {
        image->values[i] = image->slope * image->values[i] + image->inter;
    }
    for (size_t v = 0; v < count && layout->turned; v += components) {
        turn_vector(layout->turn, components, image->values + v);
    }
    return image_segments_merge(image, error);
}

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

/* ---- places ---- */

static double column_length(double m[3][4], int c)
{
    return sqrt(m[0][c] * m[0][c] + m[1][c] * m[1][c] + m[2][c] * m[2][c]);
}

/* The step across an image of one slice has no meaning: make it as long as the first one if it is zero. */
static void complete_slice(double m[3][4])
{
    if (column_length(m, 2) > 0) {
        return;
    }
    double across[3], length = 0;
    for (int i = 0; i < 3; i++) {
        int next = (i + 1) % 3, last = (i + 2) % 3;
        across[i] = m[next][0] * m[last][1] - m[next][1] * m[last][0];
        length += across[i] * across[i];
    }
    for (int i = 0; i < 3 && length > 0; i++) {
        m[i][2] = across[i] / sqrt(length) * column_length(m, 0);
    }
}

static bool is_sound(double m[3][4])
{
    double volume = column_length(m, 0) * column_length(m, 1) * column_length(m, 2);
    for (int r = 0; r < 3; r++) {
        if (!isfinite(m[r][3])) {
            return false;
        }
    }
    return isfinite(volume) && volume > 0 && fabs(determinant3(m[0], m[1], m[2])) > 1e-6 * volume;
}

enum status image_place(struct image *image, double matrix[3][4], const char *form, struct error *error)
{
    if (image->size[2] == 1) {
        complete_slice(matrix);
    }
    if (!is_sound(matrix)) {
        return fail(error, STATUS_INPUT, "header: %s gives the voxels no place: not finite, or no volume",
                    form);
    }
    memcpy(image->to_world, matrix, sizeof image->to_world);
    return STATUS_OK;
}

/* ---- files ---- */

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
    bool swapped;
    image->slope = 1;
    image->version = 1;
    if (file->size >= 4 && memcmp(file->bytes, "NRRD", 4) == 0) {
        image->format = IMAGE_NRRD;
        RETURN_IF_ERROR(nrrd_header(file, image, &layout, error));
    } else if (file->size >= 4 && metaimage_begins(file->bytes)) {
        image->format = IMAGE_METAIMAGE;
        RETURN_IF_ERROR(metaimage_header(file, image, &layout, error));
    } else if (file->size < 4 || nifti_version(file->bytes, &swapped) == 0) {
        return fail_foreign(file->bytes, file->size, error);
    } else {
        image->format = file->was_packed ? IMAGE_NIFTI_GZIP : IMAGE_NIFTI;
        RETURN_IF_ERROR(nifti_header(file, name, image, &layout, error));
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
