/* The sections that the programs know: the one table from which come what `mts check` expects of each, which
 * sections are void when an earlier stage is run again, and how a body is cut into parts and put together. */
#pragma once

#include "io/stream/stream.h"

/* Requirements on the values of a section. */
enum content {
    ANY, /* what the views check (stages/views.h), and results */
    FINITE,
    POSITIVE,
    AT_LEAST_ONE,
    UNITY,         /* finite; sums to 1 over each list of the pairs */
    INDEX,         /* of a row of section index_of */
    INDEX_OR_NONE, /* the same, or -1 */
    BELOW,         /* no index, but a number from 0 that is less than the rows of index_of */
    LIST           /* where each list begins in the .idx of the same name, and the last one ends */
};

/* The columns of a section: a number, or one of these. */
enum { COLS_DIM = -1, COLS_DIM_PLUS_1 = -2, COLS_ANY = -3 };

/* The stage that makes a section, in the order of the pipeline. */
enum section_stage {
    MADE_WITH_CLOUD,   /* nodes, cloud, groups */
    MADE_WITH_POINTS,  /* ipoints */
    MADE_WITH_SUPPORT, /* support */
    MADE_WITH_SHAPES,  /* shapefn */
    MADE_WITH_RESULTS, /* mtled: the final state */
    MADE_ELSEWHERE
};

struct section_kind {
    const char *name;
    enum element_type type;
    int cols;
    const char *rows_of; /* the section with as many rows (LIST: one less), or whatever the faces need; NULL:
                            any number of rows */
    enum content content;
    const char *index_of; /* the section whose rows its numbers count, or NULL */
    enum section_stage stage;
};

enum { SECTION_KINDS = 58 };
extern const struct section_kind section_kinds[SECTION_KINDS];

/* The entry of a section; for a section of a frame, X.frame.K, that of X. NULL: not in the table. */
const struct section_kind *section_kind_of(const char *name);

/* The stage of a section; one before the results also of a section that the table lacks, by the part of its
 * name before the first dot (nbr.more: MADE_WITH_SUPPORT). */
enum section_stage section_stage(const char *name);

/* Remove what the stages first .. last have made. */
void sections_remove(struct stream *stream, enum section_stage first, enum section_stage last);

/* Sections of frames: X.frame.K is section X in state K of a run; 0 is the state at its begin. */

/* Result of frame_of for a section that belongs to no frame. */
#define FRAME_NONE (-1)

/* K of a section X.frame.K; FRAME_NONE for another section. *length receives that of X. */
int64_t frame_of(const char *name, size_t *length);
