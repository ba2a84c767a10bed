/* The table of the sections that the programs know. It determines what `mts check` expects of each, which
 * sections are void if an earlier stage is run again. */
#pragma once

#include "io/stream/stream.h"

/* Requirements on the values of a section. */
enum content {
    ANY, /* results, and sections that the views check (stages/views.h) */
    FINITE,
    POSITIVE,
    AT_LEAST_ONE,
    UNITY,         /* finite; sums to 1 over each list of the pairs */
    INDEX,         /* index of a row of section index_of */
    INDEX_OR_NONE, /* the same, or -1 */
    BELOW,         /* not an index, but from 0 to less than the rows of index_of */
    STRETCH,       /* the last columns: symmetric matrices without an eigenvalue below 1 */
    LIST           /* the start of each list in the .idx of the same name, and the end of the last one */
};

/* The columns of a section: a number, or one of these. */
enum { COLS_DIM = -1, COLS_DIM_PLUS_1 = -2, COLS_DIM_SQUARED = -3, COLS_SIDES = -4, COLS_ANY = -5 };

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
    const char *rows_of; /* the section with the same number of rows (LIST: one less), or what the faces need;
                            NULL: any number of rows */
    enum content content;
    const char *index_of; /* the section of whose rows its values are indices, or NULL */
    enum section_stage stage;
};

enum { SECTION_KINDS = 56 };
extern const struct section_kind section_kinds[SECTION_KINDS];

/* The entry of a section; of a section X.frame.K or X.frames that of X. NULL: not in the table. */
const struct section_kind *section_kind_of(const char *name);

/* The stage of a section. For a section that is not in the table, the part of its name before the first dot
 * decides, for stages before the results (nbr.more: MADE_WITH_SUPPORT). */
enum section_stage section_stage(const char *name);

/* Remove the sections made by the stages first .. last. */
void sections_remove(struct stream *stream, enum section_stage first, enum section_stage last);

/* Sections of frames: X.frame.K is section X in state K of a run, 0 the initial state; X.frames is a table
 * with a row for each state. */
enum { FRAME_NONE = -1, FRAME_TABLE = -2 };

/* K of a section X.frame.K; FRAME_TABLE of X.frames; FRAME_NONE of another section. *length receives that of
 * X. */
int64_t frame_of(const char *name, size_t *length);
