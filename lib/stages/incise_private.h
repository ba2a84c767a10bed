/* The steps of stage_incise. */
#pragma once

#include "stages/incise.h"

/* The body of a stream. */
struct cut_body {
    const struct incise_options *options;
    struct cells cells;
    struct groups regions; /* none: no names */
    struct groups facets;
    struct groups sets;
    struct division body;
    int32_t front, back, wall; /* groups of facets, -1: none */
    int64_t old_groups;        /* those of the stream, before new ones */
    struct incise_report *report;
};

/* Put the cells that are kept[body.cell_count], with their groups, into the stream, and report on them. */
MUST_CHECK enum status cut_body_put(struct cut_body *whole, const bool *kept, struct stream *stream,
                                    struct error *error);
