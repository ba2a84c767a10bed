/* Nodal fields and their values at points. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/shape/shape.h"
#include "approx/support/support.h"

#include <stdbool.h>

/* spacing[node_count], m: the mean length of the cell edges at each node; at nodes without cell, and without
 * cells, the mean distance to the nearest nodes. */
MUST_CHECK enum status field_spacing(const struct cells *cells, double *spacing, struct error *error);

/* outside[count]: whether a point of x[count * dim] is farther from every cell than `within` times the
 * spacing of that cell's nodes (0: lies in no cell); where there are no cells, farther from every node than
 * twice that node's spacing. Values there would be extrapolated. */
MUST_CHECK enum status field_outside(const struct cells *cells, const double *spacing, double within,
                                     int64_t count, const double *x, bool *outside, struct error *error);

/* The distance from the cells, in spacings, up to which fields are extrapolated: landmarks and nodes of
 * another mesh may lie slightly outside of a curved boundary. */
#define FIELD_MARGIN 1.0

/* result[to->node_count * cols] at the nodes of other cells of about the same body: linear interpolation in
 * each cell of values[node_count * cols]. Outside of the cells, that of the nearest cell is continued;
 * STATUS_INPUT farther away than FIELD_MARGIN. An interpolated displacement that inverts none of these cells
 * hardly inverts a cell of a finer mesh. The solver's smooth field may, as its gradients vary within a cell
 * near corners. Where faces of a slit or bodies touch, each node takes the value on the side of its own
 * cells. */
MUST_CHECK enum status field_carry(const struct cells *from, int64_t cols, const double *values,
                                   const struct cells *to, double *result, struct error *error);

/* Lists and values of shape functions at points. */
struct field_table {
    struct support_lists lists;
    double *phi; /* lists.ptr[lists.count] */
};

/* Supports and shape functions at x[count * dim] on a cloud with radius[node_count], m. Where there are
 * cells, neighbours are those visible through them (visibility.h). Nodal values are taken as the parameters
 * of the approximation, u_h = sum_j phi_j u_j; linear fields (quadratic ones with mls2) are reproduced.
 * `what` names the points in messages. The shape functions are *shapes, or options->mls if that is NULL. */
MUST_CHECK enum status field_table_build(const struct support_options *options, const struct mls *shapes,
                                         const struct cells *cells, const double *radius, int64_t count,
                                         const double *x, const char *what, struct field_table *table,
                                         struct error *error);
void field_table_free(struct field_table *table);

/* values[count * cols] = sum over the row's neighbours of phi_j field[j * cols ...]. */
void field_evaluate(int64_t count, const int64_t *ptr, const int32_t *idx, const double *phi, int64_t cols,
                    const double *field, double *values);
