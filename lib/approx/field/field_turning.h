/* Cells in which a displacement field turns the body over.
 *
 * The map x + u(x) keeps its orientation where the determinant of its gradient I + grad u is positive. The
 * linear interpolant between the vertices of a cell tells this of cells that are not flat. Across a flat
 * cell, of height t and edges of length h, it is off by the order of h^2 / t times the second derivative of
 * u, and turns over where the field only bends. So these cells are looked at by the gradient of the field
 * itself. */
#pragma once

#include "approx/support/support_space.h"

/* Points within a cell: those whose barycentric coordinates are 1/6, 2/6, 3/6 or 4/6; as many in a triangle
 * as in a tetrahedron. */
enum { FIELD_TURNING_POINTS = 10 };

/* least[count]: the least determinant at the points within each cell of cell[count]; nan where u is not
 * finite. u[node_count * dim]: parameters, m, of the field whose supports `space` and `options` give, and
 * whose shape functions are *shapes, or options->mls where that is NULL. Errors: as support_space_lists and
 * shape_table. */
MUST_CHECK enum status field_least_determinants(const struct support_options *options,
                                                const struct mls *shapes, const struct support_space *space,
                                                int64_t count, const int32_t *cell, const double *u,
                                                double *least, struct error *error);
