/* Inside of lib/io: the bytes of an image file, and the header of a NIfTI file, decoded. */
#pragma once

#include "io/image/image.h"

#include <stdint.h>
#include <zlib.h>

enum { NIFTI1_HEADER = 348, NIFTI2_HEADER = 540 };

/* The fields that matter, in the file's units. */
struct nifti {
    int version;
    bool swapped;
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
    int components;     /* that the type itself has */
    double least, most; /* of an integer; 0, 0: floating */
};

/* NULL for a type that is not read. */
const struct nifti_type *nifti_type(int code);

/* The header's version and byte order by its first 4 bytes; 0 when they are no header's. */
int nifti_version(const unsigned char *bytes, bool *swapped);

/* Decode a whole header of that version. */
void nifti_decode(const unsigned char *bytes, int version, bool swapped, struct nifti *header,
                  struct image *image);

/* Encode an image's header, little-endian, with the 4 bytes that follow it; returns the offset of the data.
 */
size_t nifti_encode(const struct image *image, unsigned char bytes[NIFTI2_HEADER + 4]);

/* image->to_world, unit and space from a header; notes what is assumed. */
MUST_CHECK enum status nifti_space(const struct nifti *header, struct image *image, struct error *error);

/* The quaternion (b, c, d), the sizes and qfac that give the first three columns of a matrix; false when its
 * columns are not orthogonal. */
bool nifti_quaternion(double matrix[3][4], double quatern[3], double pixdim[4]);

/* The bytes of a file, compressed or not. Not by zlib's gzread, which takes a file without its checksum for
 * whole where the data end with a block of its own. */
struct image_source {
    int descriptor;
    bool gzip, ended; /* no more input */
    bool complete;    /* a member of the gzip file has ended, its checksum right */
    z_stream stream;  /* its next_in and avail_in: what is read and not yet taken */
    int64_t taken;    /* bytes so far, after decompression */
    unsigned char buffer[1 << 15];
};

/* Begin with an open descriptor, which stays open. */
MUST_CHECK enum status image_source_open(struct image_source *source, int descriptor, struct error *error);
void image_source_close(struct image_source *source);

/* Take `size` bytes, or *got fewer at the end of a whole file. */
MUST_CHECK enum status image_source_take(struct image_source *source, void *bytes, size_t size, size_t *got,
                                         struct error *error);
