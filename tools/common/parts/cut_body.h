/* Cutting a body into parts (see part): from the stream of the whole to that of each part. */
#pragma once

#include "tool.h"

#include "stages/stages.h"

#include "approx/partition/partition.h"

/* The body, and how it is cut. */
struct cut_body {
    struct tool *tool;
    struct stream *stream;
    struct cells cells;
    struct cell_stars stars;
    struct point_grid grid;
    struct partition partition;
    int64_t *own_ptr;
    int32_t *own_cell;
    double *radius;
    int32_t *owner, *work;
    uint32_t cut; /* distinguishes parts of this cut from others */
};

/* Remove sections that cannot be cut from the stream, with a note. Exits with a message on failure, as does
 * the function below. */
void cut_body_drop_sections(const struct cut_body *whole);

/* Put the sections of one part into a stream: lib/README.md, "Of a body in parts". */
void cut_body_make_part(const struct cut_body *whole, int32_t number, const struct body_part *body,
                        struct stream *part);

void cut_body_free(struct cut_body *whole);
