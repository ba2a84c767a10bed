/* What tovtk writes of a stream: a mesh, fields and frames. */
#pragma once

#include "derived.h"
#include "io/stream/sections.h"
#include "io/vtk/vtk.h"

struct plot_label;

struct plot {
    struct stream stream;
    struct derived derived; /* fields that follow from the stream's */
    struct cells cells;
    struct cell_regions regions;
    struct vtk_mesh mesh;      /* these */
    struct vtk_field *fields;  /* of the frame chosen last; room for every section */
    struct plot_label *labels; /* the names of those of frames */
    int64_t field_count;
    struct vtk_number *numbers; /* of the frame chosen last: its row of reactions.frames and the like */
    int64_t number_count;
    int64_t *frames; /* the numbers of the frames, ascending */
    int64_t frame_count;
};

/* Find mesh, fields, those of the groups too, and frames of plot->stream, the rest of *plot being zero.
 * plot_free also on failure. */
MUST_CHECK enum status plot_find(struct plot *plot, struct error *error);

/* Release all of it, the stream too. */
void plot_free(struct plot *plot);

/* States to write: the frames, or the final state when there are none. */
int64_t plot_state_count(const struct plot *plot);

/* Number i of the frames; FRAME_NONE, the final state, when there are none. */
int64_t plot_frame(const struct plot *plot, int64_t i);

/* Choose the fields and numbers of a frame, or of the final state for FRAME_NONE, which has no numbers. */
MUST_CHECK enum status plot_choose(struct plot *plot, int64_t frame, struct error *error);

/* Attribute time= of the first section of the frame that has one, else its number; 0 for the final state. */
MUST_CHECK enum status plot_time(const struct plot *plot, int64_t frame, double *time, struct error *error);
