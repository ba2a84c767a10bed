/* Landmarks of 3D Slicer, .mrk.json (markups) and .fcsv: points with labels, in mm, LPS or RAS. */
#pragma once

#include "io/files/table.h"

#include <stdio.h>

/* Whether a file's name ends as that of landmarks. */
bool landmarks_named(const char *path);

/* Read the points of a file into the rows of an empty table: x, y, z in RAS, mm, with labels. STATUS_INPUT,
 * as `FILE:LINE: ...`, for what is not such a file, a point without a position, and no point at all. */
MUST_CHECK enum status landmarks_read(const char *path, struct table *table, struct error *error);

/* The same of the text of markups, whose strings are decoded in place; points without a label have an `empty`
 * one. Messages begin with the line. */
MUST_CHECK enum status markups_read(char *text, char *empty, struct table *table, struct error *error);

/* Print points, x[3 * count] in RAS, m, in the format that `path` names: in mm, LPS in JSON, RAS in .fcsv.
 * label: NULL, or the names of the points of[0 .. count - 1]. */
void landmarks_print(FILE *file, const char *path, int64_t count, const double *x, const int64_t *of,
                     char *const *label);
