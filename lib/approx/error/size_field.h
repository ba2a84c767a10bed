/* Sizes of cells, graded so that each cell has an equal part of the error. A cell of size h has the error e_K
 * of its gradient (approx/error/field_error.h). It decreases as h^(1 + dim / 2): the order of the gradient is
 * one, and the volume decreases, too. The mesh with the least sum e_K^2 for its number of cells has the same
 * e_K in all cells (equidistribution). The error of the displacement is assumed to be proportional to the sum
 * e_K^2: this holds for singular solutions, and for smooth ones both are of second order.
 *
 * So a mesh with the share s of the present error has cells of
 *
 *   h_new = h (e / e_K)^(1 / (1 + dim / 2)),    sum e_K^2 (h_new / h)^2 = s sum e_K^2,
 * with e such that the second equation holds, even where bounds on h_new override the first. Cells that
 * already have about the least admitted size are not counted in it. */
#pragma once

#include "approx/cells/cells.h"

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
