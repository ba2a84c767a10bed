/* Displacements of the corners of a membrane, as sums over nodes: those of the boundary there, but for what
 * rows of the conditions prescribe. The tension of a membrane that ends on such a boundary acts on the rows,
 * not on a point of the body. A row holds an average around the node; the value at the node is a combination
 * of rows of neighbouring nodes that is exact for linear fields. */
#pragma once

#include "approx/shape/boundary.h"
#include "solid/constraint/constraint.h"

struct corner_term {
    int32_t node;
    double weight[3][3]; /* displacement of the corner += weight u_node */
};

struct corner_values {
    int dim;
    int64_t count;
    int64_t *first; /* count + 1: the terms of each corner */
    int64_t capacity;
    struct corner_term *terms;
};

/* corners: from boundary_corners_build; rows: those of conditions on facets and nodes. To be freed, also on
 * failure. */
MUST_CHECK enum status corner_values_build(const struct face_table *table,
                                           const struct boundary_averages *corners,
                                           const struct constraint_rows *rows, struct corner_values *values,
                                           struct error *error);
void corner_values_free(struct corner_values *values);

/* u[dim]: the displacement of corner c in the field. */
void corner_values_take(const struct corner_values *values, int64_t c, const double *field, double *u);

/* The transpose: force += that of on[dim], which acts on corner c. */
void corner_values_spread(const struct corner_values *values, int64_t c, const double *on, double *force);
