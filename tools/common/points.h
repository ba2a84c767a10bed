/* Points of a table or of a stream, at which images are sampled or fields evaluated. */
#pragma once

#include "tool.h"

struct points {
    const char *what; /* their name in messages */
    int dim;
    int64_t count;
    double *x;           /* count * dim, m */
    char **label, *text; /* names of the rows of a table, in text; NULL: none */
};

/* The rows of a table of coordinates in dim dimensions (0: 2 or 3), in the unit of the option -u, m by
 * default; or landmarks, which are in mm. Exits on failure. */
void points_of_table(const struct tool *tool, const char *file, int dim, struct points *points);

/* A copy of a section of coordinates; exits on failure. */
void points_of_section(const struct tool *tool, const struct stream *stream, const char *name,
                       struct points *points);

/* Keep the integration points in cells of these regions, comma-separated names. Exits on failure. */
void points_in_regions(const struct tool *tool, const struct stream *stream, const char *regions,
                       struct points *points);
void points_free(struct points *points);
