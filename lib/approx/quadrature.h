/* Quadrature on background cells and on their faces. All weights are positive: a negative one makes negative
 * masses, which explicit dynamics does not bear. */
#ifndef APPROX_QUADRATURE_H
#define APPROX_QUADRATURE_H

#include "approx/cells.h"

/* A rule on the reference simplex: barycentric coordinates (vertices each) and weights that sum to 1. */
struct quadrature_rule {
    int points, vertices;
    const double *barycentric; /* points * vertices */
    const double *weight;      /* points */
};

/* The rule of that many points on a cell: triangles 1, 3, 4 (centroids of the four sub-triangles), 6, 7, 12;
 * tetrahedra 1, 4, 8, 14. STATUS_INPUT lists what exists. */
MUST_CHECK enum status quadrature_cell_rule(int dim, int points, struct quadrature_rule *rule,
                                            struct error *error);

/* The rule on faces of the boundary: 2 Gauss points on an edge (cubics exact), 3 interior points on a
 * triangle (quadratics exact). */
struct quadrature_rule quadrature_face_rule(int dim);

/* The rule on faces between cells: in 2D the same; in 3D the middles of the edges (quadratics exact). */
struct quadrature_rule quadrature_inner_rule(int dim);

/* The points that rows of faces are made of: x[row_count * ROW_POINTS * dim], those of each row in turn. The
 * mean over a face is that over its points. */
void quadrature_face_points(const struct faces *faces, const double *nodes, double *x);

/* Position of each of a rule's points in a simplex of node indices `vertex`: x[points * dim]. */
void quadrature_positions(const struct quadrature_rule *rule, int dim, const double *nodes,
                          const int32_t *vertex, double *x);

#endif
