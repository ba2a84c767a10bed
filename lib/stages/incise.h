/* Cutting the body of a stream. */
#pragma once

#include "solid/incision/incision.h"
#include "stages/views.h"

struct incise_options {
    const struct blade *blade; /* NULL: none */
    const double *at;          /* nodes * dim, m: where the blade meets the nodes; NULL: nodes.x */
    const char *name;          /* of the faces, NAME|front and NAME|back, and of the set NAME|edge */
    bool excise;               /* take out what lies behind the blade */
    double least;       /* pieces at the cut that are smaller than this share of the body are taken out */
    const char *region; /* to take out, NULL: none; the wall that it leaves is facets NAME|wall */
};

struct incise_report {
    int64_t opened, unopened;       /* faces opened; sheets that opened none */
    int64_t split, moved, doubled;  /* nodes put on edges, moved, copied */
    double face_area;               /* area of one face of the cut, m2 (2D: m) */
    int64_t edge;                   /* nodes on the edge of the cut */
    int32_t pieces;                 /* connected pieces at the cut */
    int32_t taken_out;              /* of these: as too small, or as excised */
    double smallest, taken, volume; /* of the smallest piece left, of those taken out, of the body, m3 (m2) */
    int64_t region_cells;           /* of the region, taken out */
    double poorest;                 /* quality of the poorest cell */
};

/* Cut the body: replace nodes, cells, facets and sets, with regions; a group that exists is extended. The
 * sections that later stages have made are left out. STATUS_INPUT for a blade that opens nothing, and for
 * sections that do not fit. */
MUST_CHECK enum status stage_incise(struct stream *stream, const struct incise_options *options,
                                    struct incise_report *report, struct error *error);
