/* The bytes of an image file, and the decoded header of a NIfTI file; private to lib/io. */
#pragma once

#include "io/image/image.h"

#include <stdint.h>
#include <zlib.h>

enum { NIFTI1_HEADER = 348, NIFTI2_HEADER = 540 };

/* The fields that are used, in the file's units. */
struct nifti {
    int version;
    bool swapped;
    bool pair; /* the data are in a file of their own */
    double dim[8];
    int datatype, bits, intent;
    double pixdim[8], offset, slope, inter;
    int qform, sform, units;
    double quatern[3], qoffset[3], srow[3][4];
};

/* How the values of a type are stored. */
struct nifti_type {
    int code;
    const char *name;
    int bytes;          /* of one component */
    int components;     /* of the type itself */
    double least, most; /* of an integer type; 0, 0: floating point */
};

/* NULL for a type that is not read. */
const struct nifti_type *nifti_type(int code);

/* Numbers of this type from their bytes, in the other byte order if `swapped`. Eight bytes are read for each:
 * up to seven behind the last one are to be there. */
void nifti_get(const struct nifti_type *type, const unsigned char *bytes, bool swapped, size_t count,
               double *values);

/* The bytes of a number, little-endian: rounded to what the type can hold, NaN to 0 in integers. */
void nifti_put(const struct nifti_type *type, double value, unsigned char *bytes);

/* The version and byte order of a header, from its first 4 bytes; 0: not a header. */
int nifti_version(const unsigned char *bytes, bool *swapped);

/* Decode a whole header of that version. */
void nifti_decode(const unsigned char *bytes, int version, bool swapped, struct nifti *header,
                  struct image *image);

/* Encode an image's header, little-endian, with the 4 bytes that follow it; returns the offset of the data.
 */
size_t nifti_encode(const struct image *image, unsigned char bytes[NIFTI2_HEADER + 4]);

/* Set image->to_world, unit and space from a header, and note assumptions. */
MUST_CHECK enum status nifti_space(const struct nifti *header, struct image *image, struct error *error);

/* The quaternion (b, c, d), voxel sizes and qfac of the first three columns of a matrix; false if these are
 * not orthogonal. */
bool nifti_quaternion(double matrix[3][4], double quatern[3], double pixdim[4]);

/* The bytes of a file, compressed or not. zlib's gzread is not used: it accepts a file without its checksum
 * if the data end with a block. */
struct image_source {
    int descriptor;
    bool gzip, ended; /* no more input */
    bool complete;    /* a member of the gzip file has ended, its checksum right */
    z_stream stream;  /* its next_in and avail_in: input that has not been taken */
    int64_t taken;    /* bytes so far, after decompression */
    unsigned char buffer[1 << 15];
};

/* Begin with an open descriptor, which stays open. */
MUST_CHECK enum status image_source_open(struct image_source *source, int descriptor, struct error *error);
void image_source_close(struct image_source *source);

/* Take `size` bytes, or *got fewer at the end of a whole file. */
MUST_CHECK enum status image_source_take(struct image_source *source, void *bytes, size_t size, size_t *got,
                                         struct error *error);
