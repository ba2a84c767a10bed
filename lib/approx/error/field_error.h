/* Discretisation error of a nodal field: extrapolation from the same scene on a coarser cloud, and recovery
 * of the gradient.
 *
 * Extrapolation (Richardson). With the error c h^p on a cloud of spacing h, and the field on one of r h, the
 * error is
 *
 *   u_h - u = (u_rh - u_h) / (r^p - 1). (29)
 * p is known only between bounds: 2 where the solution is smooth, slightly above 1 where a corner or a
 * junction of prescribed and free boundary makes it singular. The mean of the bounds is assumed; from three
 * clouds it is observed.
 *
 * Recovery (Zienkiewicz and Zhu, A simple error estimator and adaptive procedure for practical engineering
 * analysis, Int. J. Numer. Meth. Eng. 24 (1987), 337). The gradient of the linear interpolant in a cell is
 * compared with that averaged at the nodes, with the volumes of the cells of one region as weights. It shows
 * from one solution where the cloud is too coarse. It does not give the error of the displacement, which
 * depends on the whole body. */
#pragma once

#include "approx/field/field.h"

/* Bounds of the order, and the order that is assumed. */
#define FIELD_ERROR_LEAST_ORDER 1.0
#define FIELD_ERROR_MOST_ORDER 2.0
#define FIELD_ERROR_ORDER 1.5

/* Error of the finer field by the difference of the two: 1 / (r^p - 1), ratio > 1, order > 0. */
double field_error_share(double ratio, double order);

/* Observed order from three fields: `fine` is the difference of the fine and the middle one, `coarse` that of
 * the middle and the coarse one. It is limited to the bounds; it is the upper bound where `coarse` is not
 * finite. */
double field_error_order(double fine, double coarse, double ratio);

/* Ratio of the numbers of cells per direction of two meshes of one body; of nodes, where one has no cells. */
double field_error_ratio(const struct cells *fine, const struct cells *coarse);

/* Mean over the body of a value at its nodes, linear in the cells; cells with a node whose value is NaN are
 * left out. The average over the nodes of a graded cloud would be dominated by the regions with many nodes.
 * NaN where no cell is left. */
double field_error_mean(const struct cells *cells, const double *value);

/* squared[cells->count] = integral over the cell of |G - grad u|^2 with the recovered gradient G of u, linear
 * in the cell. Its square root is the error of the cell, in the unit of u times m^(dim / 2 - 1).
 * region[cells->count]: 0 .. region_count - 1, or NULL: one region. STATUS_INPUT for a value that is not
 * finite. */
MUST_CHECK enum status field_error_recovered(const struct cells *cells, const int32_t *region,
                                             int32_t region_count, int64_t cols, const double *values,
                                             double *squared, struct error *error);
