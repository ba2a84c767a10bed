/* Cutting a body into parts (see part): the stream of the whole is turned into that of each part in turn. */
#pragma once

#include "tool.h"

#include "stages/stages.h"

#include "approx/partition/partition.h"

/* The body, its sections as they were read, and how it is cut. */
struct cut_body {
    struct tool *tool;
    struct stream *stream;
    struct section *sections; /* those of the stream when it was read */
    int64_t section_count;
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

/* Remove sections that cannot be cut from the stream, with a note, and keep a copy of the others. Exits with
 * a message on failure, as do the functions below. */
void cut_body_keep_sections(struct cut_body *whole);

/* Turn the stream into that of one part, with the sections of lib/README.md, "Of a body in parts". */
void cut_body_make_part(const struct cut_body *whole, int32_t number, const struct body_part *body);

void cut_body_free(struct cut_body *whole);
