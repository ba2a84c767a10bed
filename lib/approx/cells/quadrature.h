/* Quadrature on background cells and on their faces. All weights are positive, since negative ones could give
 * negative lumped masses. */
#pragma once

#include "approx/cells/cells.h"

enum { QUADRATURE_MOST = 14 }; /* points of a rule */

/* A rule on the reference simplex: barycentric coordinates (vertices each) and weights that sum to 1. */
struct quadrature_rule {
    int points, vertices;
    double barycentric[QUADRATURE_MOST * 4]; /* points * vertices */
    double weight[QUADRATURE_MOST];          /* points */
};

/* The rule of that many points on a cell: triangles 1, 3, 4 (centroids of the four sub-triangles), 6, 7, 12;
 * tetrahedra 1, 4, 8, 14. STATUS_INPUT lists what exists. */
MUST_CHECK enum status quadrature_cell_rule(int dim, int points, struct quadrature_rule *rule,
                                            struct error *error);

/* The rule on faces: 2 Gauss points on an edge (cubics exact), 3 interior points on a triangle (quadratics
 * exact). */
struct quadrature_rule quadrature_face_rule(int dim);

/* Position of each of a rule's points in a simplex of node indices `vertex`: x[points * dim]. */
void quadrature_positions(const struct quadrature_rule *rule, int dim, const double *nodes,
                          const int32_t *vertex, double *x);
