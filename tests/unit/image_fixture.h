/* NIfTI files made byte by byte from the standard's tables, apart from the reader and the writer under test.
 */
#pragma once

#include "unit.h"

#include "io/image/image.h"

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

static struct image image;
static struct error said;

/* Read bytes as a file. */
static enum status read_bytes(const void *bytes, size_t size)
{
    int descriptor = memfd_create("image", 0);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, bytes, size), size);
    assert_int_equal(lseek(descriptor, 0, SEEK_SET), 0);
    enum status status = image_read_from(&image, descriptor, "file", &said);
    close(descriptor);
    if (status != STATUS_OK) {
        assert_null(image.values);
        assert_int_equal(strncmp(said.text, "file: ", 6), 0);
    }
    return status;
}

/* A file in the making: the fields of either version are named by the first one's. */
struct nifti_file {
    int version;
    bool big; /* big-endian */
    size_t size;
    unsigned char bytes[1 << 17];
};

static inline void put_number(struct nifti_file *file, size_t offset, int size, uint64_t bits)
{
    for (int b = 0; b < size; b++) {
        file->bytes[offset + (size_t)(file->big ? size - 1 - b : b)] = (unsigned char)(bits >> (8 * b));
    }
}

static inline void put_integer(struct nifti_file *file, size_t offset1, int size1, size_t offset2, int size2,
                               int64_t value)
{
    put_number(file, file->version == 1 ? offset1 : offset2, file->version == 1 ? size1 : size2,
               (uint64_t)value);
}

static inline void put_real(struct nifti_file *file, size_t offset1, size_t offset2, double value)
{
    uint64_t bits;
    float single = (float)value;
    uint32_t low;
    memcpy(&low, &single, sizeof low);
    memcpy(&bits, &value, sizeof bits);
    put_number(file, file->version == 1 ? offset1 : offset2, file->version == 1 ? 4 : 8,
               file->version == 1 ? low : bits);
}

static inline void put_dim(struct nifti_file *file, int index, int64_t value)
{
    put_integer(file, 40 + 2 * (size_t)index, 2, 16 + 8 * (size_t)index, 8, value);
}
static inline void put_pixdim(struct nifti_file *file, int index, double value)
{
    put_real(file, 76 + 4 * (size_t)index, 104 + 8 * (size_t)index, value);
}
static inline void put_type(struct nifti_file *file, int code, int bits)
{
    put_integer(file, 70, 2, 12, 2, code);
    put_integer(file, 72, 2, 14, 2, bits);
}
static inline void put_offset(struct nifti_file *file, int64_t offset)
{
    if (file->version == 1) {
        put_real(file, 108, 0, (double)offset);
    } else {
        put_number(file, 168, 8, (uint64_t)offset);
    }
}
static inline void put_scale(struct nifti_file *file, double slope, double inter)
{
    put_real(file, 112, 176, slope);
    put_real(file, 116, 184, inter);
}
static inline void put_units(struct nifti_file *file, int units)
{
    put_integer(file, 123, 1, 500, 4, units);
}
static inline void put_sform(struct nifti_file *file, int code, double m[3][4])
{
    put_integer(file, 254, 2, 348, 4, code);
    for (size_t i = 0; i < 12; i++) {
        put_real(file, 280 + 4 * i, 400 + 8 * i, m[i / 4][i % 4]);
    }
}
static inline void put_qform(struct nifti_file *file, int code, double b, double c, double d,
                             const double offset[3])
{
    const double quatern[3] = {b, c, d};
    put_integer(file, 252, 2, 344, 4, code);
    for (size_t i = 0; i < 3; i++) {
        put_real(file, 256 + 4 * i, 352 + 8 * i, quatern[i]);
        put_real(file, 268 + 4 * i, 376 + 8 * i, offset[i]);
    }
}

/* A header of an image of nx x ny x nz values of a type, in mm, with voxels of 1 and neither sform nor qform.
 */
static inline void begin_nifti(struct nifti_file *file, int version, bool big, int nx, int ny, int nz,
                               int type, int bits)
{
    static const char magic2[8] = "n+2\0\r\n\032\n";
    *file = (struct nifti_file){.version = version, .big = big, .size = version == 1 ? 352 : 544};
    put_number(file, 0, 4, version == 1 ? 348 : 540);
    memcpy(file->bytes + (version == 1 ? 344 : 4), version == 1 ? "n+1" : magic2, version == 1 ? 4 : 8);
    const int dim[8] = {3, nx, ny, nz, 1, 1, 1, 1};
    for (int i = 0; i < 8; i++) {
        put_dim(file, i, dim[i]);
        put_pixdim(file, i, 1);
    }
    put_type(file, type, bits);
    put_offset(file, (int64_t)file->size);
    put_units(file, 2);
}

/* Append a stored value of `size` bytes. */
static inline void append_value(struct nifti_file *file, int size, uint64_t bits)
{
    put_number(file, file->size, size, bits);
    file->size += (size_t)size;
}
