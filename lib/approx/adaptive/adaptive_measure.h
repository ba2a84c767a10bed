/* Subcells of background cells, and by how much they change the integral of the products of shape-function
 * gradients; private to lib/approx. */
#pragma once

#include "approx/adaptive/adaptive.h"
#include "approx/cells/quadrature.h"
#include "approx/support/support.h"

/* A subcell. */
struct leaf {
    int32_t cell;
    int32_t level;
    bool measured, split;
    double change;     /* |K by the rule - K by the rule on its children|, Frobenius */
    double vertex[12]; /* (dim + 1) * dim */
};

/* In order of the cells, within a cell in order of the subdivision. */
struct leaves {
    int64_t count;
    struct leaf *leaf;
};

/* The input of the refinement. */
struct refinement {
    const struct adaptive_options *options;
    const struct cells *cells;
    const double *radius;
    struct support_space space;
    struct quadrature_rule rule;
    double *norm; /* |K| of each cell, by the rule on the whole cell */
};

/* Children of a subcell: 4 triangles or 8 tetrahedra of equal volume. */
int adaptive_children(int dim);

/* of_child[(dim + 1) * dim]: the vertices of one child. */
void adaptive_child(int dim, const double *vertex, int child, double *of_child);

/* x[rule->points * dim]: the rule's points in a simplex of those vertices. */
void adaptive_positions(const struct quadrature_rule *rule, int dim, const double *vertex, double *x);

/* Measure the subcells that have not been measured; those of level 0 also set the norm of their cell. */
MUST_CHECK enum status adaptive_measure(struct refinement *refinement, struct leaves *leaves,
                                        struct error *error);
