/* Tables of numbers in text files: prescribed displacements, rigid curves, load curves, materials per point.
 *
 * One row per line, its numbers separated by blanks or tabs, all rows of one length; '#' at the start of a
 * line or after a blank begins a comment; blank lines separate blocks, as in gnuplot. */
#pragma once

#include "base/status.h"

#include <stdint.h>

struct table {
    int64_t rows, cols;  /* both >= 1 */
    int64_t room;        /* rows allocated */
    double *values;      /* rows x cols, finite; NAN where table_read_open read none */
    int64_t *line;       /* rows: the line of each row in its file (the triangle's number for binary STL) */
    char **label;        /* rows: names of landmarks, in `text`; NULL: rows have no names */
    char *text;          /* of the file, decoded */
    int64_t block_count; /* >= 1 */
    int64_t *block_ptr;  /* block_count + 1: block b holds rows block_ptr[b] .. block_ptr[b + 1] - 1, at least
                            one */
};

/* The unit of a table's lengths, m: what its format states (landmarks: mm), else the one given. */
double table_unit(const char *path, double given);

/* Read a table of least..most columns. Errors, as `FILE:LINE: ...`: those of textfile_read; STATUS_INPUT for
 * a word that is not a finite decimal number (a decimal comma among them), rows of different lengths, a
 * number of columns outside of least..most, and a file without rows. Landmarks (see landmarks.h) are three
 * columns, RAS. The table is to be freed also on
 * failure.
 */
MUST_CHECK enum status table_read(const char *path, int least, int most, struct table *table,
                                  struct error *error);

/* The same; in the columns open .. closed - 1, counted from 0, '-' or 'nan' means no value. */
MUST_CHECK enum status table_read_open(const char *path, int least, int most, int open, int closed,
                                       struct table *table, struct error *error);

void table_free(struct table *table);

/* Append a row (cols values, copied) to a table, for readers of other formats; `label`: its name, NULL: rows
 * have none. */
MUST_CHECK enum status table_append(struct table *table, const double *row, int64_t line, char *label,
                                    struct error *error);

/* End a block behind the last row, unless one ends there already. */
MUST_CHECK enum status table_end_block(struct table *table, struct error *error);
