/* The surface of a rigid body, read from a file. */
#pragma once

#include "base/status.h"
#include "io/files/table.h"

/* Read the surface of a rigid body. dim = 2: polylines, a table of 2 columns (x y), one block of at least two
 * points for each curve. dim = 3: triangles, rows of 9 columns (the three corners), from a table of 9
 * columns, or from an STL file (ASCII or binary, recognised by a name that ends in .stl; little-endian); the
 * right-hand normal of the corners counts, the normals stated in an STL file do not. Errors as table_read;
 * curves of one point, triangles without area and segments without length are errors. */
MUST_CHECK enum status surface_read(const char *path, int dim, struct table *table, struct error *error);

/* The corners of its facets, in another unit: (*x)[*count * dim * dim], to be freed, segments between
 * consecutive points of each curve, or triangles. Errors as surface_read. */
MUST_CHECK enum status surface_facets(const char *path, int dim, double unit, double **x, int64_t *count,
                                      struct error *error);
