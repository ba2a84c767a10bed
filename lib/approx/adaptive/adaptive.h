/* Adaptive integration points: each background cell is subdivided until the integral of the products of
 * shape-function gradients, of which stiffnesses consist, converges. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/support/support.h"

#define ADAPTIVE_MOST_LEVELS 10

struct adaptive_options {
    double tolerance;               /* relative change admitted in a cell, > 0 */
    int levels;                     /* most subdivisions of a cell, 0 .. ADAPTIVE_MOST_LEVELS */
    int rule_points;                /* of the rule on each subcell (quadrature_cell_rule) */
    struct support_options support; /* of the shape functions, see support_build */
};

/* Rules exact for quadratics (3 points in 2D, 4 in 3D), four levels (three in 3D), the default shape
 * functions. */
struct adaptive_options adaptive_defaults(int dim);

/* Points in order of the cells, within a cell in order of its subcells. */
struct adaptive_points {
    int64_t count;
    double *x;          /* count * dim */
    double *weight;     /* count, all positive: share of the cell's volume */
    int32_t *cell;      /* count: the background cell */
    int64_t unresolved; /* cells that change by more than the tolerance even at the last level */
};

/* For each cell K_ij = integral(grad phi_i . grad phi_j) is computed by the rule on its subcells. Splitting a
 * subcell at the middles of its edges (4 triangles, 8 tetrahedra) changes K by c, in the Frobenius norm.
 * Subcells are split, those of largest c first, while the sum of c over the cell exceeds tolerance |K|. The
 * points are those of the subcells that are not split. supports: of the nodes. Threads share the
 * work; the result does not depend on their number. Errors: as support_build and shape_table, and
 * STATUS_INPUT for a rule that does not exist. */
MUST_CHECK enum status adaptive_points_build(const struct adaptive_options *options,
                                             const struct cells *cells, struct supports supports,
                                             struct adaptive_points *points, struct error *error);
void adaptive_points_free(struct adaptive_points *points);
