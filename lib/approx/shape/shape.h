/* Tables of shape functions: values and gradients at points (equations (3) and (4) of lib/README.md), and
 * averages over faces of cells (equation (6) of lib/README.md). */
#pragma once

#include "approx/cells/face_rows.h"
#include "approx/mls/mls.h"
#include "approx/support/support.h"

/* The neighbours that points see around corners (see visibility.h). */
struct around {
    int64_t count;
    const int64_t *pair;  /* count: places in idx, ascending */
    const double *offset; /* count * dim: from the point to the neighbour's image (mls_support), m */
};

/* A view of lists of neighbours (CSR), made by support_build. */
struct neighbours {
    int64_t count;
    const int64_t *ptr; /* count + 1 */
    const int32_t *idx;
    const double *widen; /* count */
    struct around around;
};

/* A view of lists. */
struct neighbours support_view(const struct support_lists *lists);

/* phi[ptr[count]] and, unless NULL, dphi[ptr[count] * dim] (1/m) at the points x[count * dim]. `what` names
 * the points in messages. STATUS_VERDICT, naming the first such point, if a point has too few neighbours or
 * an ill-conditioned moment matrix. Threaded; the same bits for any number of threads. */
MUST_CHECK enum status shape_table(const struct mls *mls, const double *nodes, const double *radius,
                                   const struct neighbours *neighbours, const double *x, const char *what,
                                   double *phi, double *dphi, struct error *error);

/* The rows of averages of the shape functions over faces (face_rows.h), as CSR. */
struct face_averages {
    int64_t count;        /* of rows */
    int64_t *ptr;         /* count + 1 */
    int32_t *idx;         /* union of the lists of the row's points, ascending */
    double *phi;          /* means over these points */
    double *boundary_phi; /* values at the points of faces on the boundary, following their lists */
};

/* The rows of the averages of the shape functions over faces, from their points x (face_rows_points). By the
 * divergence theorem, the mean gradient over a cell is the sum over its faces of the average times the area
 * vector, divided by the volume (Chen et al. 2001, here on background cells). Errors and threads as
 * shape_table. */
MUST_CHECK enum status shape_average_faces(const struct mls *mls, const double *nodes, const double *radius,
                                           const struct neighbours *neighbours, const double *x,
                                           const char *what, const struct faces *faces,
                                           struct face_averages *averages, struct error *error);
void face_averages_free(struct face_averages *averages);
