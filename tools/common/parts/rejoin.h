/* Putting the parts of a body (see part) together again: which rows of each part's sections are its own, and
 * where they stand in the sections of the whole. */
#pragma once

#include "tool.h"
#include "stages/views.h"

/* What the rows of a section stand for. */
enum rows_of {
    ROWS_NODES,
    ROWS_CELLS,
    ROWS_FACETS,
    ROWS_SETS, /* members of node sets */
    ROWS_POINTS,
    ROWS_FACES,
    ROWS_OF_FACES, /* that faces are averaged over */
    ROWS_FACEPOINTS,
    ROWS_BOUNDARY, /* points on faces on the boundary */
    ROWS_KINDS
};

/* One part, as it was read. */
struct rejoin_part {
    const char *file;
    struct stream stream;
    bool
        elsewhere; /* another process holds its large tables: here these sections have headers, but no rows */
    int64_t read_as; /* the number of its file, where files have numbers */
    int64_t number, parts;
    char cut[16];
    struct cells cells;
    const int32_t *node, *owner, *cell; /* part.node, part.owner, part.cell */
    struct faces faces;                 /* local; count 0 without */
    bool *at_edge;                      /* for each node: some of its cells are not in this part */
    int32_t *
        to[ROWS_KINDS]; /* of each of its rows the row in the whole, -1: another part's; NULL: no such rows */
    int64_t count[ROWS_KINDS];
};

struct rejoin {
    const struct tool *tool;
    int64_t part_count;
    struct rejoin_part *part; /* by number */
    int64_t rows[ROWS_KINDS]; /* of the whole */
    int dim;
    double *x;     /* of the whole */
    int32_t *cell; /* rows[ROWS_CELLS] * (dim + 1) */
    struct faces faces;
    double widen;
};

/* The parts in these files, checked to be all parts of one cut. Exits with a message on failure. */
void rejoin_begin(struct rejoin *rejoin, const struct tool *tool, char *const files[], int64_t count);

/* The same of parts that have been read: part_count, and of each part file, stream and elsewhere are set. */
void rejoin_streams(struct rejoin *rejoin);

/* Whether this section belongs to a large table, which each process holds for its own parts only. */
bool rejoin_is_large(const char *name);

/* Check the large tables of the parts that this process has read. Processes hold different ones, so that one
 * may find a fault that others do not see: they have to agree on the status. Everything else is the same for
 * all. */
MUST_CHECK enum status rejoin_check_large(const struct rejoin *rejoin, struct error *error);

/* Put all sections that can be put together into the stream, in the order of part 0. Of large tables rows of
 * parts that are elsewhere are empty. */
void rejoin_sections(const struct rejoin *rejoin, struct stream *stream);

void rejoin_free(struct rejoin *rejoin);

/* ---- private to rejoin*.c: which rows of each part are its own, and where they stand in the whole ---- */

/* part->to[kind] of `count` rows, for the caller to fill. */
int32_t *rejoin_new_rows(const struct rejoin *rejoin, struct rejoin_part *part, enum rows_of kind,
                         int64_t count);

/* Exits unless every row of the whole comes from one part; `called`: the section's name. */
void rejoin_check_rows(const struct rejoin *rejoin, enum rows_of kind, const char *called);

/* The faces, the rows that they are averaged over, and the points of these. */
void rejoin_map_faces(struct rejoin *rejoin);
