/* A body cut into parts (see part): the stream of the whole becomes that of each part in turn. */
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
    uint32_t cut; /* tells parts of this cut from others */
};

/* Take what cannot be cut out of the stream, with a note, and keep what the rest was. Exits with a message on
 * failure, as what follows. */
void cut_body_keep_sections(struct cut_body *whole);

/* The stream becomes that of one part, which has the sections of lib/README.md, "A body in parts". */
void cut_body_make_part(const struct cut_body *whole, int32_t number, const struct body_part *body);

void cut_body_free(struct cut_body *whole);
