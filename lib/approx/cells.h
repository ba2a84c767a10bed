/* Background cells: simplices (triangles, tetrahedra) on the nodes, and their faces. */
#ifndef APPROX_CELLS_H
#define APPROX_CELLS_H

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

/* What the average of a field over a face is made of: rows of a table. In 2D one row, the average itself, by
 * the values at two points. In 3D the mean of three rows, the values at one point each: those of a face on
 * the boundary lie within it; those of a face between cells are the middles of its edges, which faces share.
 */
#define FACE_ROWS(dim) ((dim) == 2 ? 1 : 3)
#define ROW_POINTS(dim) ((dim) == 2 ? 2 : 1)

/* Faces (edges in 2D) of cells. */
struct faces {
    int dim;
    int64_t count;
    int64_t boundary_count; /* those on the boundary come first */
    int32_t *node;          /* count * dim, oriented outward from the first cell */
    int32_t *cell; /* count * 2: the cell it is oriented by (the lower index), and the one beyond or -1 */
    int64_t row_count;
    int32_t *row; /* count * FACE_ROWS: numbered as they come. In 3D row k of a face between cells is that of
                     the edge from its node k to the next one */
};

/* Check indices and that every volume is positive; the message names the first bad cell. */
MUST_CHECK enum status cells_check(const struct cells *cells, struct error *error);

/* Area or volume of a cell. */
double cell_volume(const struct cells *cells, int64_t cell);

/* Mean of a cell's vertices. */
void cell_centroid(const struct cells *cells, int64_t cell, double *centroid);

/* Outward normal times length or area of a face of node indices face[dim]. */
void face_area_vector(int dim, const double *x, const int32_t *face, double *vector);

/* Node indices node[dim] of a face in ascending order, in 2D -1 last: what tells it, whichever way it is
 * turned. */
void face_key(int dim, const int32_t *node, int32_t key[3]);

/* All faces of the cells, each once, those on the boundary before those between two cells, and else in the
 * order of their first cell; or only those on the boundary.
 * STATUS_INPUT when a face belongs to more than two cells. */
MUST_CHECK enum status faces_build(const struct cells *cells, bool boundary_only, struct faces *faces,
                                   struct error *error);
void faces_free(struct faces *faces);

/* The cells of the faces that each row is of: ptr[row_count + 1] and cell[ptr[row_count]], the caller's to
 * free. */
MUST_CHECK enum status faces_row_cells(const struct faces *faces, int64_t **ptr, int32_t **cell,
                                       struct error *error);

/* across[count * (dim + 1)]: the cell beyond the face opposite each vertex, -1 on the boundary. Errors as
 * faces_build. */
MUST_CHECK enum status cells_across(const struct cells *cells, int32_t *across, struct error *error);

/* spacing[node_count]: mean length of the cell edges at each node; 0 at nodes of no cell. */
MUST_CHECK enum status cells_node_spacing(const struct cells *cells, double *spacing, struct error *error);

#endif
