/* Images on regular grids: NIfTI-1 and NIfTI-2 files (.nii, or pairs .hdr and .img), NRRD (.nrrd, or .nhdr
 * and a file of data) and MetaImage (.mha, or .mhd and a file of data), of either byte order, plain or
 * compressed.
 */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* NIfTI's codes of the types of values that are read and written. */
enum image_datatype {
    IMAGE_UINT8 = 2,
    IMAGE_INT16 = 4,
    IMAGE_INT32 = 8,
    IMAGE_FLOAT32 = 16,
    IMAGE_FLOAT64 = 64,
    IMAGE_RGB24 = 128, /* 3 components of 8 bits */
    IMAGE_INT8 = 256,
    IMAGE_UINT16 = 512,
    IMAGE_UINT32 = 768,
    IMAGE_INT64 = 1024,
    IMAGE_UINT64 = 1280,
    IMAGE_RGBA32 = 2304 /* 4 components of 8 bits */
};

/* The formats that are written; a reader keeps them. */
enum image_format { IMAGE_NIFTI_GZIP, IMAGE_NIFTI, IMAGE_NRRD, IMAGE_METAIMAGE, IMAGE_FORMATS };

/* Codes of `intent`. */
enum { IMAGE_INTENT_LABEL = 1002, IMAGE_INTENT_DISPLACEMENT = 1006, IMAGE_INTENT_VECTOR = 1007 };

/* The reference to which the world axes are aligned: NIfTI's codes of sform and qform. */
enum {
    IMAGE_SPACE_UNKNOWN,
    IMAGE_SPACE_SCANNER,
    IMAGE_SPACE_ALIGNED,
    IMAGE_SPACE_TALAIRACH,
    IMAGE_SPACE_MNI
};

/* A segment of a segmentation: the voxels that have its label. */
struct image_segment {
    char name[128];
    int64_t label;
    int64_t layer; /* in the file */
    int number;    /* in the file's header, which orders the segments */
    size_t voxels; /* when it was read */
};

/* An image on a regular grid, as a NIfTI file holds it. Lengths in metres, world axes RAS+ (x to the right, y
 * to the front, z up). Vectors of intent VECTOR stand as in NIfTI files of ITK: to the left, to the back, up.
 */
struct image {
    size_t size[3];        /* voxels along i, j, k, each >= 1; a slice has size[2] == 1 */
    size_t components;     /* values at a voxel: 1, 3 for RGB (4 with opacity), or those of a vector image */
    double to_world[3][4]; /* voxel index (i, j, k, 1), voxel centres, to world, m; invertible */
    int datatype;          /* enum image_datatype, of the file's values: a writer keeps it */
    double *values;        /* size[2] * size[1] * size[0] * components:
                              values[((k * size[1] + j) * size[0] + i) * components + c], after slope and inter */
    double slope, inter;   /* value = slope * stored + inter; slope 1, inter 0: none; ignored for RGB */
    double unit;           /* metres in a unit of length of the file */
    int space; /* IMAGE_SPACE_...: of world coordinates; UNKNOWN: the file names none. In NIfTI, which then
                  states sizes of voxels alone, a place or direction makes it ALIGNED */
    enum image_format format;
    int version; /* of NIfTI: 1 or 2; images too large for 1 are written as 2 */
    int intent;  /* NIfTI's code of the meaning of the values; 0: none */
    char intent_name[17];
    char description[81];
    size_t segment_count;
    struct image_segment *segment; /* segment_count: of a segmentation (.seg.nrrd) */
    char note[512]; /* assumptions made in reading, in one line, for tools to print; "": none */
};

/* An image with all values zero: of type float32, in mm, of unknown space, with voxels of 1 mm.
 * STATUS_SYSTEM: memory. */
MUST_CHECK enum status image_new(struct image *image, const size_t size[3], size_t components,
                                 struct error *error);

/* Read an image file from an open descriptor, which stays open; messages begin with `name`. The data of a
 * NIfTI header NAME.hdr are those of the file NAME.img; NRRD and MetaImage headers name theirs, which must
 * lie in the folder of the header or below. The space of NIfTI is that of sform if the file has one, else of
 * qform, else voxel sizes along axes of unknown direction, with a note; so are spacings of NRRD. Without a
 * unit of length it is mm, in NIfTI with a note. An image of one slice needs no size across. STATUS_INPUT for
 * a file that is not of these formats and of one volume (known ones are named, with the remedy), for types
 * other than enum image_datatype, for a truncated or damaged file, and for a header that contradicts itself
 * or the length of the data; STATUS_SYSTEM for read failures and memory. Time and memory are proportional to
 * the data in the file, whatever its header says. On failure the image is empty. */
MUST_CHECK enum status image_read_from(struct image *image, int descriptor, const char *name,
                                       struct error *error);

/* The least and the largest value that the image's type and scaling can hold. */
void image_range(const struct image *image, double *least, double *most);

/* Write an image, little-endian. Errors of the file stay in it (ferror). Values are rounded to what the type
 * can hold, NaN is 0 in integers. NRRD and MetaImage know no scaling: scaled values become floats. They are
 * written in LPS and mm; with a data_file, in their folder, which is to hold the values, only the header is
 * written, else it is NULL. The same image gives the same bytes. Errors: STATUS_INPUT for sizes that do not
 * fit the type of the components; STATUS_SYSTEM: memory. */
MUST_CHECK enum status image_write(const struct image *image, FILE *file, enum image_format format,
                                   const char *data_file, struct error *error);

/* The values alone, raw: the data_file of a header. Errors as image_write. */
MUST_CHECK enum status image_write_data(const struct image *image, FILE *file, struct error *error);

/* Release values and segments; the image becomes empty. */
void image_free(struct image *image);

/* The whole number that a value of the image stands for: the nearest one, if what separates them is less than
 * a value can state: half a step of the scaling (of at most half a label), and single precision. Else NaN. */
double image_whole(const struct image *image, double value);

/* The number of voxels. */
size_t image_voxels(const struct image *image);

/* inverse: the map from world coordinates, m, to voxel index. */
void image_to_voxel(const struct image *image, double inverse[3][4]);

/* place = m x + t; m[3 * 4] has t in its last column, as to_world and image_to_voxel. */
void image_map(const double *m, const double x[3], double place[3]);

/* World coordinates of a voxel index, which need not be integer, m. */
void image_world(const struct image *image, const double voxel[3], double world[3]);

/* The length of a voxel along its axis, m. */
double image_step(const struct image *image, int axis);

/* The largest distance between the places of a voxel in two images of the same sizes, m. */
double image_distance(const struct image *a, const struct image *b);

/* ---- values between the voxels ---- */

enum image_method { IMAGE_NEAREST, IMAGE_LINEAR, IMAGE_CUBIC, IMAGE_METHOD_COUNT };

/* Names for command lines: "nearest", "linear", "cubic". */
extern const char *const image_method_names[IMAGE_METHOD_COUNT];

/* values[components] at a place in voxel coordinates. False, without values, if the place is in no voxel:
 * more than half a voxel beyond the outermost centres. Within that half, the outermost values are continued.
 * IMAGE_CUBIC: the convolution of Keys 1981 with a = -1/2 along each axis, which reproduces quadratic
 * functions up to the outermost centres. */
bool image_sample(const struct image *image, enum image_method method, const double voxel[3], double *values);
