/* What the average of a field over a face is made of: rows of a table. In 2D one row, the average itself, by
 * the values at two points. In 3D the mean of three rows. Between cells these are the values at the middles
 * of the face's edges, which all faces at an edge share. Faces that have a node on the boundary, or on an
 * interface where supports stop (support_options.side), share nothing: their three rows are one, the average,
 * by the values at three points within the face. The mean of a quadratic field is exact either way; where the
 * field is none, by the ends of what is held, the points within are better.
 *
 * Such own rows come first, those of the faces on the boundary before the others, in the order of the faces;
 * then those of edges, as they come. */
#pragma once

#include "approx/cells.h"

#define FACE_ROWS(dim) ((dim) == 2 ? 1 : 3)

/* Points of each row of a face of its own; others have one. */
#define OWN_POINTS(dim) ((dim) == 2 ? 2 : 3)

/* Row k of the FACE_ROWS of face f. */
static inline int64_t face_row(const struct faces *faces, int64_t f, int k)
{
    return faces->row != NULL ? faces->row[f * FACE_ROWS(faces->dim) + k] : f;
}

/* Whether face f has a row of its own. */
static inline bool face_has_own_row(const struct faces *faces, int64_t f)
{
    return face_row(faces, f, 0) == face_row(faces, f, FACE_ROWS(faces->dim) - 1);
}

/* Whether the faces are such that some may share rows. */
static inline bool faces_may_share(const struct faces *faces)
{
    return faces->dim == 3 && faces->boundary_count < faces->count;
}

/* The first point of row r, of those of all rows in turn; of row_count: how many points there are. */
static inline int64_t face_row_point(const struct faces *faces, int64_t r)
{
    int64_t own = r < faces->own_count ? r : faces->own_count;
    return own * OWN_POINTS(faces->dim) + r - own;
}

/* Make the rows of faces whose nodes and cells are known. side: of each cell, or NULL; nodes are fewer than
 * node_count. */
MUST_CHECK enum status face_rows_number(int64_t node_count, const int32_t *side, struct faces *faces,
                                        struct error *error);

/* The cells at the face or edge of each row: ptr[row_count + 1] and cell[ptr[row_count]], the caller's to
 * free. Nodes are fewer than node_count. */
MUST_CHECK enum status face_rows_cells(int64_t node_count, const struct faces *faces, int64_t **ptr,
                                       int32_t **cell, struct error *error);

/* The points, x[face_row_point(faces, row_count) * dim], by the places of the nodes. */
void face_rows_points(const struct faces *faces, const double *nodes, double *x);
