/* A label image as the labels of the library; a table names, merges and omits its values. */
#pragma once

#include "tool.h"

#include "approx/labels/labels.h"
#include "io/image/image.h"
#include "io/image/label_table.h"

struct label_image_options {
    const char *table; /* file of the table of names; NULL: each value is the region label_VALUE */
    double unit;       /* of the file's lengths, m; 0: as the file says */
    const char *slice; /* "z=12mm": the slice nearest to that place; NULL: all, or the only slice */
};

struct label_image {
    struct labels labels;
    uint16_t *voxel;          /* the array of labels.label */
    double to_world[3][4];    /* voxel index to world, m */
    struct label_table table; /* label l, at least 1, is table.name[l - 1]; higher ones are parts: */
    int32_t *region;          /* labels.count: the label of its region */
    int32_t *part_of;         /* labels.count: number of its part; -1: none */
    struct label_ball *ball;  /* labels.count: its ball, if it has one */
    int32_t part_count;
    char **part;    /* part_count: names */
    bool *keep;     /* labels.count */
    double *volume; /* labels.count: of its voxels, m3 (2D: m2) */
    double voxel_volume;
};

/* Read a label image; "-" and NULL: standard input. Exits on failure: errors of image_read_from and
 * label_table_read, values that are not integers, several values at a voxel, a label that is not in the
 * table, a name without a voxel, a slice that is not perpendicular to a world axis, and a body of impossible
 * size. */
void label_image_read(const struct tool *tool, const char *file, const struct label_image_options *options,
                      struct label_image *image);
void label_image_free(struct label_image *image);

/* The name of a label, for a part that of its region; "outside" for 0. */
const char *label_image_name(const struct label_image *image, int32_t label);

/* The label with this name; -1: none. */
int32_t label_image_find(const struct label_image *image, const char *name);
