/* The sections that the programs know: the one table from which come what `mts check` expects of each, and
 * which sections are void when an earlier stage is run again. */
#ifndef IO_SECTIONS_H
#define IO_SECTIONS_H

#include "io/stream.h"

/* What the values of a section must be; ANY: lists and results, which are checked otherwise or not at all. */
enum content { ANY, FINITE, POSITIVE, AT_LEAST_ONE, INDEX, INDEX_OR_NONE };

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
    const char *rows_of; /* a section with equally many rows, or NULL */
    enum content content;
    const char *index_of; /* the section whose rows the indices count; "names": the list in the attributes */
    enum section_stage stage;
};

enum { SECTION_KINDS = 58 };
extern const struct section_kind section_kinds[SECTION_KINDS];

/* The stage of a section; one before the results also of a section that the table lacks, by the part of its
 * name before the first dot (nbr.more: MADE_WITH_SUPPORT). */
enum section_stage section_stage(const char *name);

/* Remove what the stages first .. last have made. */
void sections_remove(struct stream *stream, enum section_stage first, enum section_stage last);

/* Sections of frames: X.frame.K is section X in state K of a run; 0 is the state at its begin. */

/* What frame_of gives for a section that belongs to no frame. */
#define FRAME_NONE (-1)

/* K of a section X.frame.K; FRAME_NONE for another section. *length receives that of X. */
int64_t frame_of(const char *name, size_t *length);

#endif
