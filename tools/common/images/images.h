/* Reading and writing images by tools; a body and the voxels of an image. */
#pragma once

#include "tool.h"

#include "approx/cells/cells.h"
#include "io/files/table.h"
#include "io/image/image.h"

/* Read an image from a file ("-": standard input), and report assumptions; exits on failure. */
void tool_read_image(const struct tool *tool, const char *file, struct image *image);

/* The value of the option -i, or linear. Exits on another name. */
enum image_method tool_image_method(const struct tool *tool);

/* Exit if the name of tool->output does not end as that of an image which can be written, or standard output
 * is a terminal. Call this before long computations. */
void tool_check_image_output(const struct tool *tool);

/* Write an image to tool->output, in the format of its name, else that of the image; exits on failure. */
void tool_write_image(const struct tool *tool, const struct image *image);

/* The world axis to which the slices along a voxel axis are perpendicular; -1: none. */
int image_axis_across(const struct image *image, int voxel);

/* The world axes and voxel axes in the order of the body's axes. */
struct image_axes {
    int world[3], voxel[3];
};

/* Bring the axes of an image into the order of the body's axes. In 3D nothing changes. A body in 2D lies in
 * an image of one slice across a world axis; its x and y are the other two axes, in their order. Exits for
 * other images in 2D. */
void image_to_body(const struct tool *tool, struct image *image, int dim, struct image_axes *axes);

/* Bring the axes back into the order of the world and of the file. */
void image_from_body(struct image *image, const struct image_axes *axes);

/* For each voxel the cell that contains its centre, with the nodes at x, or -1; to be freed. *doubly: number
 * of voxels in more than one cell. */
int32_t *find_owners(const struct tool *tool, const struct image *grid, const struct cells *cells,
                     const double *x, int64_t *doubly);

/* Exit if no voxel is `inside` the body, or the body is much larger than the image: a unit or space is
 * wrong. */
void check_image_overlap(const struct tool *tool, const struct image *grid, const struct cells *cells,
                         const double *x, int64_t inside);

/* Note that the body, in the state that the image shows, lies partly outside of it. */
void note_image_outside(const struct tool *tool, const struct image *image, const struct cells *cells,
                        const double *x);

/* Volume of a voxel, m3, or its area in the plane of the body, m2. */
double voxel_volume(const struct image *image, int dim);

/* The shortest of the first dim steps between voxels, m. */
double least_step(const struct image *image, int dim);

/* Young's modulus and Poisson's ratio from the values of images: from an intensity by a table, or from the
 * probabilities of tissues. */
struct tissue {
    struct table law;    /* rows value, E, nu, the values ascending; no rows: probabilities */
    int count;           /* of tissues */
    double (*moduli)[2]; /* count: E, Pa, and nu of each */
};

/* Check that E is positive, and nu within (-1, .5). */
MUST_CHECK enum status moduli_check(const double moduli[2], struct error *error);

/* Read a table of rows value, E (Pa), nu. Errors as table_read; STATUS_INPUT for values that do not ascend,
 * and for invalid moduli. */
MUST_CHECK enum status tissue_read(const char *path, struct tissue *tissue, struct error *error);

/* From the values "E,NU" of an option, one for each tissue. */
MUST_CHECK enum status tissue_parse(int count, const char *const text[], struct tissue *tissue,
                                    struct error *error);

/* moduli[2]: E and nu. With a table: linear between the values of its rows, constant beyond them (*beyond is
 * then incremented). With probabilities value[count]: the means weighted by these, negative ones as 0; false
 * if there is no tissue. */
bool tissue_moduli(const struct tissue *tissue, const double *value, double moduli[2], int64_t *beyond);

void tissue_free(struct tissue *tissue);
