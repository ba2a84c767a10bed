/* The bytes of an image file, its header, and how its values lie; private to lib/io. */
#pragma once

#include "io/image/image.h"

#include <stdint.h>
#include <stdio.h>

/* How the values of a type are stored. */
struct nifti_type {
    int code;
    const char *name;                   /* in VTU, too, in any case */
    int bytes;                          /* of one component */
    int components;                     /* of the type itself */
    double least, most;                 /* of an integer type; 0, 0: floating point */
    const char *nrrd, *metaimage, *vtk; /* A|B, in headers, where the first one is written, and in legacy
                                           files of VTK; of a colour those of its components */
};
enum number_format { NUMBERS_OF_NRRD, NUMBERS_OF_METAIMAGE, NUMBERS_OF_VTU, NUMBERS_OF_VTK };

/* NULL for a type that is not read. */
const struct nifti_type *nifti_type(int code);
const struct nifti_type *nifti_type_named(enum number_format format, const char *name);

/* Whether a word is one of the names A|B|..., in any case. */
bool header_is(const char *names, const char *word);

/* Numbers of this type from their bytes, in the other byte order if `swapped`. */
void nifti_get(const struct nifti_type *type, const unsigned char *bytes, bool swapped, size_t count,
               double *values);

/* The bytes of a number, little-endian: rounded to what the type can hold, NaN to 0 in integers. */
void nifti_put(const struct nifti_type *type, double value, unsigned char *bytes);

/* The bytes of a file, out of gzip, with ROOM_BEHIND more behind them. */
struct image_bytes {
    unsigned char *bytes; /* size */
    size_t size, at;      /* at: those before have been taken */
    bool was_packed;
};

/* How the values are stored. */
enum image_encoding { IMAGE_RAW, IMAGE_PACKED /* by gzip or zlib */, IMAGE_ASCII };

/* Where the values lie behind the header, or in a file of their own, and how. */
struct image_layout {
    const struct nifti_type *type;
    enum image_encoding encoding;
    bool swapped;  /* the other byte order */
    bool together; /* all values of a voxel lie together; else there is a volume for each component */
    bool turned;   /* vectors of at most three components are multiplied by turn */
    double turn[3][3];
    int64_t skip_lines;  /* before the values: lines, as they stand, */
    int64_t skip_bytes;  /* and bytes, of what was compressed; -1: all but the last bytes of the file */
    char data_file[256]; /* in the folder of the header or below; "": they follow the header */
};

/* Read a header: sizes, components, place, and the layout of the values; of NIfTI, that of the file `name`.
 * STATUS_INPUT, with the key, for what is not read or contradicts itself. */
MUST_CHECK enum status nrrd_header(struct image_bytes *file, struct image *image, struct image_layout *layout,
                                   struct error *error);
MUST_CHECK enum status nifti_header(struct image_bytes *file, const char *name, struct image *image,
                                    struct image_layout *layout, struct error *error);
MUST_CHECK enum status metaimage_header(struct image_bytes *file, struct image *image,
                                        struct image_layout *layout, struct error *error);

/* Whether these are the first bytes of a MetaImage header. */
bool metaimage_begins(const unsigned char bytes[4]);

/* Of an image with segments, make one layer of labels: each layer's own, or of several layers the numbers of
 * the segments, 1, 2, ...; where segments overlap, the later one is taken, with a note. STATUS_INPUT for
 * a layer that is not there, and two segments of one label. */
MUST_CHECK enum status image_segments_merge(struct image *image, struct error *error);

/* The version and byte order of a header, from its first 4 bytes; 0: not a header. */
int nifti_version(const unsigned char *bytes, bool *swapped);

/* Encode an image's header, little-endian, with the 4 bytes that follow it; returns the offset of the data.
 */
enum { NIFTI_MOST = 544 };
size_t nifti_encode(const struct image *image, unsigned char bytes[NIFTI_MOST]);

/* Set image->to_world to a map to RAS, m; a slice's third step may be zero. STATUS_INPUT, with the name of
 * its source, for one that is not finite or not invertible. */
MUST_CHECK enum status image_place(struct image *image, double matrix[3][4], const char *form,
                                   struct error *error);

/* Add a sentence, printed, to image->note. */
void image_note(struct image *image, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Set image->description: its beginning, '?' for what is not printable. */
void image_describe(struct image *image, const char *text);
