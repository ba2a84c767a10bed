/* Cells in which a displacement field inverts the body.
 *
 * The map x + u(x) preserves orientation where det (I + grad u) > 0. For cells that are not flat, the linear
 * interpolant between the vertices decides. Across a flat cell of height t and edges of length h, the error
 * of its gradient is of the order of h^2 / t times the second derivative of u: it may be inverted where the
 * field only bends. These cells are therefore judged by the gradient of the field itself. */
#pragma once

#include "approx/support/support.h"

/* The points within a cell whose barycentric coordinates are positive multiples of 1/6: ten in a triangle,
 * ten in a tetrahedron. */
enum { FIELD_TURNING_POINTS = 10 };

/* least[count]: the least determinant at the points within each cell of cell[count]; NaN if u is not finite.
 * u[node_count * dim]: parameters of the field, m; `space` and `options` define its supports, and *shapes its
 * shape functions, or options->mls if that is NULL. Errors: as support_build and shape_table. */
MUST_CHECK enum status field_least_determinants(const struct support_options *options,
                                                const struct mls *shapes, const struct support_space *space,
                                                int64_t count, const int32_t *cell, const double *u,
                                                double *least, struct error *error);
