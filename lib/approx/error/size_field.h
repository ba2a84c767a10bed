/* Sizes of cells, graded so that each cell has an equal part of the error.
 *
 * A cell of size h has the error e_K of its gradient (approx/error/field_error.h), which falls as h^(1 + dim
 * / 2): by one order, and with the volume. The mesh of least sum e_K^2 for its number of cells has the same
 * e_K in all (equidistribution). The displacement's error is taken to be proportional to the sum e_K^2: where
 * a solution is singular it is, and where it is smooth both are of the second order.
 *
 * So the mesh that is to have a share s of the present error has cells of
 *
 *   h_new = h (e / e_K)^(1 / (1 + dim / 2)),    sum e_K^2 (h_new / h)^2 = s sum e_K^2,
 *
 * with e such that the second equation holds, even where bounds on h_new override the first. Cells that
 * already have about the least admitted size are left out of it. */
#pragma once

#include "approx/cells/cells.h"

/* Bounds of the factor by which a size is multiplied: an error estimate is valid only for sizes near those of
 * its mesh. */
#define SIZE_FIELD_LEAST 0.25
#define SIZE_FIELD_MOST 2.0

/* Bound on the gradient of the size: the largest relative difference of neighbouring cells. */
#define SIZE_FIELD_GRADATION 0.3

struct size_field_request {
    double share;      /* the error wanted, by the present one; > 0 */
    double most_nodes; /* the nodes that there may be; > 0 */
    double least;      /* no size is less, m; 0: any */
    double sag;        /* facets of a curved boundary are off it by at most about so much, m; 0: any */
};

struct size_field {
    double *size; /* node_count: wanted length of the cells' edges at the nodes, m */
    struct faces boundary;
    double
        *outer;     /* node_count * dim, m: nodes of the boundary moved outward by half their spacing, so that
                       a  finer mesh of a curved body lies within the cells and the layer beyond the boundary */
    double nodes;   /* that a mesh of these sizes has, about */
    double unbound; /* the same without the limit most_nodes */
};

/* Sizes by squared[cells->count], the squares of the errors of the cells. Where all are zero
 * the sizes become larger, but on the boundary, whose shape the errors know nothing of, they never do.
 * Errors: STATUS_INPUT for a node of no cell and for cells that faces_build refuses. */
MUST_CHECK enum status size_field_build(const struct cells *cells, const double *squared,
                                        const struct size_field_request *request, struct size_field *field,
                                        struct error *error);
void size_field_free(struct size_field *field);
