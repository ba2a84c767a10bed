/* The edges of faces, and the rows of the table of shape functions from which smoothed cells are computed. In
 * 2D faces are edges.
 *
 * Each edge has a row, the value at its midpoint. With the values at the vertices these determine a quadratic
 * field in each cell (equations (6) to (8) of lib/README.md). Each face on the boundary has a row, too, after
 * those of the edges: the mean over the face from two points within it, in 3D three. So means over boundary
 * faces are those that conditions hold and tractions act on, and these points are more accurate than
 * midpoints near junctions of prescribed and free boundary, where the field is singular.
 *
 * The points of boundary faces come first, in the order of the faces. */
#pragma once

#include "approx/cells/cells.h"

/* Edges of a face, and of a cell. */
#define FACE_EDGES(dim) ((dim) == 2 ? 1 : 3)
#define CELL_EDGES(dim) ((dim) == 2 ? 3 : 6)

/* Quadrature points of a face on the boundary (quadrature_face_rule). */
#define FACE_POINTS(dim) ((dim) == 2 ? 2 : 3)

/* The vertices at the ends of each edge of a cell; a triangle has the first three edges. */
static const int cell_edge_ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/* The edges of the face opposite each vertex of a tetrahedron. */
static const int cell_face_edges[4][3] = {{1, 4, 5}, {2, 3, 5}, {0, 3, 4}, {0, 1, 2}};

/* Edge i of the face opposite vertex k of a cell. */
static inline int cell_face_edge(int dim, int k, int i)
{
    return dim == 2 ? (k + 1) % 3 : cell_face_edges[k][i];
}

/* The edge of a face from its node k to the next one. */
static inline int64_t face_edge(const struct faces *faces, int64_t f, int k)
{
    return faces->dim == 2 ? f : faces->edge[f * 3 + k];
}

/* The number of points of the boundary faces. */
static inline int64_t face_boundary_points(const struct faces *faces)
{
    return faces->boundary_count * FACE_POINTS(faces->dim);
}

/* The number of all points; without edges, of those of the boundary. */
static inline int64_t face_point_count(const struct faces *faces)
{
    return face_boundary_points(faces) + faces->edge_count;
}

/* The number of rows. */
static inline int64_t face_row_count(const struct faces *faces)
{
    return faces->edge_count + faces->boundary_count;
}

/* The points of row r: the first, and how many. */
static inline int64_t face_row_points(const struct faces *faces, int64_t r, int *count)
{
    if (r >= faces->edge_count) {
        *count = FACE_POINTS(faces->dim);
        return (r - faces->edge_count) * *count;
    }
    *count = 1;
    return face_boundary_points(faces) + r;
}

/* Number the edges of faces whose nodes are set, in the order of their first use. Node indices are below
 * node_count. */
MUST_CHECK enum status face_edges_number(int64_t node_count, struct faces *faces, struct error *error);

/* ends[edge_count * 2]: the nodes of each edge, the lower one first. STATUS_INPUT when an edge has not the
 * same nodes in all its faces, or belongs to no face. */
MUST_CHECK enum status face_edges_ends(const struct faces *faces, int32_t *ends, struct error *error);

/* The cells at the points: a row for the points of each face on the boundary, then a row for the midpoint of
 * each edge. ptr[rows + 1] and cell[ptr[rows]], the caller's to free. */
MUST_CHECK enum status face_points_cells(const struct faces *faces, int64_t **ptr, int32_t **cell,
                                         struct error *error);

/* The points, x[face_point_count(faces) * dim], by the places of the nodes. */
void face_points(const struct faces *faces, const double *nodes, double *x);
