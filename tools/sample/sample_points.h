/* The points of a table or of a stream at which images are sampled. */
#pragma once

#include "tool.h"

/* The points, and the values there. */
struct sample_points {
    const char *what; /* name of the points in messages */
    int dim;
    int64_t count;
    double *x;     /* count * dim, m; owned */
    int64_t cols;  /* values at a point */
    double *value; /* count * cols; owned */
};

/* The rows of a table of coordinates in a unit, m, or of landmarks; exits on failure. */
void sample_points_table(const struct tool *tool, const char *file, double unit, struct sample_points *rows);

/* The points of a section of a stream, which is read into *stream. regions: comma-separated names; only
 * integration points in cells of these are kept; NULL: all. Exits on failure. */
void sample_points_section(const struct tool *tool, const char *file, const char *name, const char *regions,
                           struct stream *stream, struct sample_points *rows);
