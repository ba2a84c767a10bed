/* A label image as the library's labels: its values named, merged and left out by a table. */
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
    uint16_t *voxel;          /* what labels.label points to */
    double to_world[3][4];    /* voxel index to world, m */
    struct label_table table; /* label l, at least 1, is table.name[l - 1]; higher ones are parts: */
    int32_t *region;          /* labels.count: the label whose region it is of */
    int32_t *part_of;         /* labels.count: number of its part, -1: none */
    struct label_ball *ball;  /* labels.count: its ball, if it has one */
    int32_t part_count;
    char **part;    /* part_count: names */
    bool *keep;     /* labels.count */
    double *volume; /* labels.count: of its voxels, m3 (2D: m2) */
    double voxel_volume;
};

/* Read a label image; "-" and NULL: standard input. Exits on failure: what image_read and label_table_read
 * refuse, values that are no whole numbers, several values at a voxel, a label that the table does not name,
 * a name without a voxel, a slice that is no plane across a world axis, a body of impossible size. */
void label_image_read(const struct tool *tool, const char *file, const struct label_image_options *options,
                      struct label_image *image);
void label_image_free(struct label_image *image);

/* The name of a label, of a part that of its region; "outside" for 0. */
const char *label_image_name(const struct label_image *image, int32_t label);

/* The label of that name; -1: none. */
int32_t label_image_find(const struct label_image *image, const char *name);
