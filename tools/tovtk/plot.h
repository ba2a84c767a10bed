/* The cells, fields and frames that tovtk writes of a stream, and the files for ParaView (VTK XML). */
#pragma once

#include "io/stream/sections.h"
#include "stages/views.h"

/* A view of a field on nodes or cells. */
struct plot_field {
    const char *name;
    bool of_cells;
    const struct section *section; /* one row for each node or cell; attribute cols= names the components */
};

struct plot {
    struct stream stream;
    int64_t given;      /* of its sections; those behind are fields derived for the frame chosen last */
    struct cells cells; /* without cells each node is a vertex */
    struct groups regions;
    struct plot_field *fields; /* of the frame chosen last */
    char (*labels)[128];       /* names of the fields of frames */
    int64_t field_count;
    int64_t *frames; /* the numbers of the frames, ascending */
    int64_t frame_count;
};

/* Find cells, regions and frames of plot->stream; the other members of *plot are zero. To be freed also
 * on failure. */
MUST_CHECK enum status plot_find(struct plot *plot, struct error *error);

/* Release everything, including the stream. */
void plot_free(struct plot *plot);

/* Choose the fields of a frame, or of the final state for FRAME_NONE: those of the stream, and those derived
 * from them. STATUS_INPUT for groups that do not fit the nodes. */
MUST_CHECK enum status plot_choose(struct plot *plot, int64_t frame, struct error *error);

/* Attribute time= of the first section of the frame that has one, else its number; 0 for the final state. */
MUST_CHECK enum status plot_time(const struct plot *plot, int64_t frame, double *time, struct error *error);

/* ---- vtu.c ---- */

/* Whether the columns of a section are those of a symmetric tensor, by their names: xx, yy, zz, xy and, in
 * 3D, xz and yz, in any order. from[6] receives the column of xx, yy, zz, xy, yz, xz, VTK's order; -1 for yz
 * and xz in 2D, which are zero. */
bool vtk_tensor(const struct section *section, int64_t from[6]);

/* Write a VTK XML unstructured grid: data inline, base64 of little-endian values, or as text. Vectors of 2D
 * meshes (two floating columns) are padded to three; symmetric tensors have six components in VTK's order.
 * Each region is an array "region.NAME" of the field data with its index. Errors of the file stay in it. */
void vtu_write(FILE *file, const struct plot *plot, bool text);

/* Write a ParaView collection: `count` files (relative to it) with their times. */
void pvd_write(FILE *file, int64_t count, char *const names[], const double *times);
