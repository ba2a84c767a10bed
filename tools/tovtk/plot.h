/* The mesh, fields and frames that tovtk writes of a stream. */
#pragma once

#include "io/stream/sections.h"
#include "io/vtk/vtk.h"
#include "stages/views.h"

struct plot {
    struct stream stream;
    int64_t given; /* of its sections; those behind are fields derived for the frame chosen last */
    struct cells cells;
    struct groups regions;
    struct vtk_mesh mesh;     /* a view of the cells and regions */
    struct vtk_field *fields; /* of the frame chosen last */
    char (*labels)[128];      /* names of the fields of frames */
    int64_t field_count;
    int64_t *frames; /* the numbers of the frames, ascending */
    int64_t frame_count;
};

/* Find mesh, fields, groups and frames of plot->stream; the other members of *plot are zero. To be freed also
 * on failure. */
MUST_CHECK enum status plot_find(struct plot *plot, struct error *error);

/* Release everything, including the stream. */
void plot_free(struct plot *plot);

/* Choose the fields of a frame, or of the final state for FRAME_NONE. */
MUST_CHECK enum status plot_choose(struct plot *plot, int64_t frame, struct error *error);

/* Attribute time= of the first section of the frame that has one, else its number; 0 for the final state. */
MUST_CHECK enum status plot_time(const struct plot *plot, int64_t frame, double *time, struct error *error);
