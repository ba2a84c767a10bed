/* Background cells: simplices (triangles, tetrahedra) on the nodes, and their faces. */
#pragma once

#include "base/lists.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* A view of the cells: cells[count * (dim + 1)] indexes x[node_count * dim]; positively oriented. */
struct cells {
    int dim;
    int64_t node_count;
    const double *x;
    int64_t count;
    const int32_t *node;
};

/* Faces (edges in 2D) of cells. */
struct faces {
    int dim;
    int64_t count;
    int64_t boundary_count; /* those on the boundary come first */
    int32_t *node;          /* count * dim, oriented outward from the first cell */
    int32_t *cell;      /* count * 2: the first cell (the lower index), and the one beyond the face or -1 */
    int64_t edge_count; /* face_edges.h; 3D: 0 where they are not numbered */
    int32_t *edge;      /* 3D: count * 3: the edges of each face, from each node to the next one; NULL in 2D,
                           where face f is edge f */
};

/* Check indices and that every volume is positive; the message names the first bad cell. */
MUST_CHECK enum status cells_check(const struct cells *cells, struct error *error);

/* Area or volume of a cell. */
double cell_volume(const struct cells *cells, int64_t cell);

/* coordinate[dim + 1]: the barycentric coordinates of x[dim] in a cell, sum 1; outside of it some are
 * negative. */
void cell_barycentric(const struct cells *cells, int64_t cell, const double *x, double *coordinate);

/* Whether these are all larger than `least`. */
bool cell_contains(const struct cells *cells, int64_t cell, const double *x, double least);

/* corner[dim + 1] = the coordinates of a cell's vertices. */
void cell_corners(const struct cells *cells, int64_t cell, const double *corner[4]);

/* Squared distance of x[dim] from the simplex of corner[0 .. order], order <= dim: a point, a segment, ... */
double simplex_distance2(int dim, int order, const double *const *corner, const double *x);

/* Mean of a cell's vertices. */
void cell_centroid(const struct cells *cells, int64_t cell, double *centroid);

/* face[dim]: the nodes of the face opposite a vertex of a cell, oriented outward. */
void cell_face(const struct cells *cells, int64_t cell, int vertex, int32_t *face);

/* Outward normal times length or area of a face of node indices face[dim]. */
void face_area_vector(int dim, const double *x, const int32_t *face, double *vector);

/* All faces of the cells, each once, those on the boundary before those between two cells, and else in the
 * order of their first cell, with their edges; or only those on the boundary, in 3D without edges.
 * STATUS_INPUT when a face belongs to more than two cells. */
MUST_CHECK enum status faces_build(const struct cells *cells, bool boundary_only, struct faces *faces,
                                   struct error *error);
void faces_free(struct faces *faces);

/* found[count]: the face on the boundary with the nodes of each facet[count * dim], in any order; -1: none.
 */
MUST_CHECK enum status faces_find(const struct faces *faces, int64_t count, const int32_t *facet,
                                  int64_t *found, struct error *error);
/* marked[faces->count] = true of those that are found. */
MUST_CHECK enum status faces_mark(const struct faces *faces, int64_t count, const int32_t *facet,
                                  bool *marked, struct error *error);

/* across[count * (dim + 1)]: the cell beyond the face opposite each vertex, -1 on the boundary. Errors as
 * faces_build. */
MUST_CHECK enum status cells_across(const struct cells *cells, int32_t *across, struct error *error);

/* spacing[node_count]: mean length of the cell edges at each node; 0 at nodes of no cell. stretch[]: A of
 * each node, dim * dim, in lengths |A edge|; NULL: 1. */
MUST_CHECK enum status cells_node_spacing(const struct cells *cells, const double *stretch, double *spacing,
                                          struct error *error);

/* owner[size[0] * size[1] * size[2]], first axis fastest: the lowest cell that contains the grid point, or
 * -1. cells->x are in units of the grid, whose points have integer coordinates from 0; size[2] = 1 in 2D.
 * Only cells whose determinant has the sign `sign` (1 or -1) count: -1 if the map to the grid mirrors; the
 * others are inverted. *doubly: number of grid points inside more than one cell, faces excepted. Threaded;
 * the result does not depend on the number of threads. */
void raster_cells(const struct cells *cells, int sign, const int64_t size[3], int32_t *owner,
                  int64_t *doubly);

/* order[count]: the indices of x[count * dim] in the order of a Morton (Z) curve, in which what is used in
 * succession is close together in memory; equal points in the order given. With group[count], unless NULL,
 * lower groups come first. */
MUST_CHECK enum status renumber_morton(int dim, int64_t count, const double *x, const int32_t *group,
                                       int64_t *order, struct error *error);
