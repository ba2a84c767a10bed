/* Joining the parts of a body (see part): the rows that each part owns, and their places in the sections of
 * the whole. */
#pragma once

#include "tool.h"
#include "stages/views.h"

/* What the rows of a section belong to. */
enum rows_of {
    ROWS_NODES,
    ROWS_CELLS,
    ROWS_FACETS,
    ROWS_SETS, /* members of node sets */
    ROWS_POINTS,
    ROWS_FACES,
    ROWS_OF_EDGES, /* and in 3D of boundary faces */
    ROWS_FACEPOINTS,
    ROWS_BOUNDARY, /* points on faces on the boundary */
    ROWS_KINDS
};

/* One part, as it was read. */
struct rejoin_part {
    const char *file;
    struct stream stream;
    bool elsewhere;  /* another process has its large tables; here these have no rows */
    int64_t read_as; /* number in the name of its file, if there is one */
    int64_t number, parts;
    char cut[16];
    struct cells cells;
    const int32_t *node, *owner, *cell; /* part.node, part.owner, part.cell */
    struct faces faces;                 /* local; count 0 without */
    bool *at_edge;                      /* for each node: some of its cells are not in this part */
    int32_t *to[ROWS_KINDS]; /* of each row: the row in the whole; -1: owned by another part. NULL: no rows */
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

/* Read the parts in these files, which must be all parts of one cut. Exits with a message on failure. */
void rejoin_begin(struct rejoin *rejoin, const struct tool *tool, char *const files[], int64_t count);

/* The same for parts that have been read: part_count, and for each part file, stream and elsewhere are
 * set. */
void rejoin_streams(struct rejoin *rejoin);

/* Whether this section belongs to a large table, which each process holds for its own parts only. */
bool rejoin_is_large(const char *name);

/* Check the large tables of the parts that this process has read. Other processes have other tables, so the
 * processes must agree on the status afterwards (ranks_agree). */
MUST_CHECK enum status rejoin_check_large(const struct rejoin *rejoin, struct error *error);

/* Put all sections that can be joined into the stream, in the order of part 0. Rows of large tables of parts
 * that are elsewhere are empty. */
void rejoin_sections(const struct rejoin *rejoin, struct stream *stream);

void rejoin_free(struct rejoin *rejoin);

/* ---- private to rejoin*.c: the rows that each part owns, and their places in the whole ---- */

/* Allocate part->to[kind] of `count` rows. */
int32_t *rejoin_new_rows(const struct rejoin *rejoin, struct rejoin_part *part, enum rows_of kind,
                         int64_t count);

/* Exits unless every row of the whole comes from one part; `called`: the section's name. */
void rejoin_check_rows(const struct rejoin *rejoin, enum rows_of kind, const char *called);

/* Map the faces, the rows of edges, and the points of faces. */
void rejoin_map_faces(struct rejoin *rejoin);
