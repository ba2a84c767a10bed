/* Discretisation error of a nodal field: extrapolation from the same scene on a coarser cloud, and recovery
 * of the gradient.
 *
 * Extrapolation (Richardson). With the error c h^p on a cloud of spacing h, and the field on one of r h, the
 * error is
 *
 *   u_h - u = (u_rh - u_h) / (r^p - 1). (29)
 * p is known only between bounds: 2 where the solution is smooth, slightly above 1 where a corner or a
 * junction of prescribed and free boundary makes it singular. From three clouds it is observed. From two the
 * errors of their gradients tell whether the solution is smooth: these are then of order one. p is twice
 * their order, and at least the mean of the bounds: near a singularity they fall more slowly than u's error.
 *
 * Recovery (Zienkiewicz and Zhu, A simple error estimator and adaptive procedure for practical engineering
 * analysis, Int. J. Numer. Meth. Eng. 24 (1987), 337). The gradient of the linear interpolant in a cell is
 * compared with that averaged at the nodes, with the volumes of the cells of one region as weights. It shows
 * from one solution where the cloud is too coarse. It does not give the error of the displacement, which
 * depends on the whole body. */
#pragma once

#include "approx/field/field.h"

/* Bounds of the order, and the order of singular solutions. */
#define FIELD_ERROR_LEAST_ORDER 1.0
#define FIELD_ERROR_MOST_ORDER 2.0
#define FIELD_ERROR_ORDER 1.5

/* Error of the finer field by the difference of the two: 1 / (r^p - 1), ratio > 1, order > 0. */
double field_error_share(double ratio, double order);

/* Observed order from three fields: `fine` is the difference of the fine and the middle one, `coarse` that of
 * the middle and the coarse one; or from two, by the squares of the errors of their gradients. It is limited
 * to `least` and the upper bound; it is the latter where `coarse` is not finite. */
double field_error_order(double fine, double coarse, double ratio, double least);

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

/* Sizes of cells, graded so that each cell has an equal part of the error. A cell of size h has the error e_K
 * of its gradient. It decreases as h^(1 + dim / 2): the order of the gradient is
 * one, and the volume decreases, too. The mesh with the least sum e_K^2 for its number of cells has the same
 * e_K in all cells (equidistribution). The error of the displacement is assumed to be proportional to the sum
 * e_K^2: this holds for singular solutions, and for smooth ones both are of second order.
 *
 * So a mesh with the share s of the present error has cells of
 *
 *   h_new = h (e / e_K)^(1 / (1 + dim / 2)),    sum e_K^2 (h_new / h)^2 = s sum e_K^2,
 * with e such that the second equation holds, even where bounds on h_new override the first. Cells that
 * already have about the least admitted size are not counted in it. */

/* Bounds of the factor by which a size is multiplied: an error estimate is valid only for sizes near those of
 * its mesh. */
#define SIZE_FIELD_LEAST 0.25
#define SIZE_FIELD_MOST 2.0

/* Bound on the gradient of the size: the largest relative difference of neighbouring cells. */
#define SIZE_FIELD_GRADATION 0.3

struct size_field_request {
    double share;      /* wanted error by the present one, > 0 */
    double most_nodes; /* most nodes, > 0 */
    double least;      /* least size, m; 0: any */
    double sag;        /* approximate largest sag of facets on a curved boundary, m; 0: any */
};

struct size_field {
    double *size; /* node_count: wanted length of the cells' edges at the nodes, m */
    struct faces boundary;
    double *outer;  /* node_count * dim, m: nodes of the boundary moved outward by half their spacing. So a
                       finer mesh of a curved body lies within the cells and the layer beyond the boundary */
    double nodes;   /* predicted number of nodes of a mesh of these sizes */
    double unbound; /* the same without the limit most_nodes */
};

/* Sizes from squared[cells->count], the squares of the errors of the cells. If all are zero, sizes grow,
 * except on the boundary: the errors do not include that of its shape. STATUS_INPUT for a node without cell
 * and for cells that faces_build refuses. */
MUST_CHECK enum status size_field_build(const struct cells *cells, const double *squared,
                                        const struct size_field_request *request, struct size_field *field,
                                        struct error *error);
void size_field_free(struct size_field *field);
