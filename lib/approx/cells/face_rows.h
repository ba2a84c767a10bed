/* Rows of the table from which averages of a field over faces are computed, equation (6) of lib/README.md. In
 * 2D the average over a face is one row: the mean of the values at two points. In 3D it is the mean of three
 * rows. In the interior, these are the values at the midpoints of the edges; all faces at an edge share its
 * row. A face with a node on the boundary, or on an interface where supports stop (support_options.side), has
 * a row of its own, which counts three times: the mean of the values at three points within the face. Both
 * rules are exact for quadratic fields. Near junctions of prescribed and free boundary, where the field is
 * singular, points within the face are more accurate.
 *
 * Rows of single faces come first, those of boundary faces before the others, in the order of the faces. The
 * rows of edges follow, in the order in which the faces first use them. */
#pragma once

#include "approx/cells/cells.h"

#define FACE_ROWS(dim) ((dim) == 2 ? 1 : 3)

/* Quadrature points of a row of a single face; a row of an edge has one. */
#define OWN_POINTS(dim) ((dim) == 2 ? 2 : 3)

/* Row k of the FACE_ROWS of face f. */
static inline int64_t face_row(const struct faces *faces, int64_t f, int k)
{
    return faces->row != NULL ? faces->row[f * FACE_ROWS(faces->dim) + k] : f;
}

/* Whether face f has its own row. */
static inline bool face_has_own_row(const struct faces *faces, int64_t f)
{
    return face_row(faces, f, 0) == face_row(faces, f, FACE_ROWS(faces->dim) - 1);
}

/* Whether some of the faces may share rows. */
static inline bool faces_may_share(const struct faces *faces)
{
    return faces->dim == 3 && faces->boundary_count < faces->count;
}

/* The index of the first point of row r; for r = row_count, the number of points. */
static inline int64_t face_row_point(const struct faces *faces, int64_t r)
{
    int64_t own = r < faces->own_count ? r : faces->own_count;
    return own * OWN_POINTS(faces->dim) + r - own;
}

/* Set the rows of faces whose nodes and cells are set. side: of each cell, or NULL; node indices are below
 * node_count. */
MUST_CHECK enum status face_rows_number(int64_t node_count, const int32_t *side, struct faces *faces,
                                        struct error *error);

/* The cells at the face or edge of each row: ptr[row_count + 1] and cell[ptr[row_count]], the caller's to
 * free. Node indices are below node_count. */
MUST_CHECK enum status face_rows_cells(int64_t node_count, const struct faces *faces, int64_t **ptr,
                                       int32_t **cell, struct error *error);

/* x[face_row_point(faces, row_count) * dim]: the points of all rows; nodes: the coordinates of the nodes. */
void face_rows_points(const struct faces *faces, const double *nodes, double *x);
