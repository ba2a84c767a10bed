/* Tables of shape functions: values and gradients at points (equations (3) and (4) of lib/README.md), and
 * their rows on edges (equation (6) of lib/README.md). */
#pragma once

#include "approx/mls/mls.h"
#include "approx/cells/cells.h"
#include "approx/support/support.h"

/* phi[ptr[count]] and, unless NULL, dphi[ptr[count] * dim] (1/m) at the points x[count * dim]. `what` names
 * the points in messages. STATUS_VERDICT, naming the first such point, if a point has too few neighbours or
 * an ill-conditioned moment matrix. Threaded; the same bits for any number of threads. */
MUST_CHECK enum status shape_table(const struct mls *mls, const double *nodes, struct supports supports,
                                   const struct neighbours *neighbours, const double *x, const char *what,
                                   double *phi, double *dphi, struct error *error);

/* Rows of a table, with lists of their own. */
struct shape_rows {
    int64_t *ptr; /* rows + 1 */
    int32_t *idx; /* ascending in each row */
    double *phi;
};
void shape_rows_free(struct shape_rows *rows);

/* The rows of edges and of boundary faces (face_edges.h): means of the values phi at their points, on
 * the lists of these. */
MUST_CHECK enum status shape_on_edges(const struct neighbours *points, const double *phi,
                                      const struct faces *faces, struct shape_rows *rows,
                                      struct error *error);
