/* Tables of shape functions: values and gradients at points, and gradients smoothed over conforming cells. */
#ifndef APPROX_SHAPE_H
#define APPROX_SHAPE_H

#include "approx/cells.h"
#include "approx/mls.h"
#include "approx/support.h"

/* The neighbours that points see around corners (see reach.h). */
struct around {
    int64_t count;
    const int64_t *pair;  /* count: places in idx, ascending */
    const double *offset; /* count * dim: from the point to where the neighbour seems to be, m */
};

/* Lists of neighbours in view (CSR), as support_build makes them. */
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
 * the points in messages. STATUS_VERDICT, naming the first point whose moment matrix is singular,
 * ill-conditioned, or has too few neighbours. Threaded; the same bits for any number of threads. */
MUST_CHECK enum status shape_table(const struct mls *mls, const double *nodes, const double *radius,
                                   const struct neighbours *neighbours, const double *x, const char *what,
                                   double *phi, double *dphi, struct error *error);

/* A table on lists of its own. */
struct smoothed_table {
    int64_t count;
    int64_t *ptr;
    int32_t *idx; /* union of the lists of the cell's face points, ascending */
    double *phi;  /* mean over the faces: reproduces linear fields at the centroid */
    double *dphi; /* (1/V) sum over faces of the outward normal times the face integral of phi; 1/m */
};

/* Conforming cell smoothing: one row per cell from the values of phi at the quadrature points of its faces
 * (all faces of the cells, as faces_build gives them). The divergence theorem makes the sum of V dphi over
 * cells the integral over the boundary, so the linear patch test holds to round-off (Chen et al. 2001, on
 * background cells). Points of face f are rows f * per_face ... of the face lists. */
MUST_CHECK enum status shape_smooth(const struct cells *cells, const struct faces *faces, int per_face,
                                    const struct neighbours *face_neighbours, const double *face_phi,
                                    struct smoothed_table *table, struct error *error);
void smoothed_table_free(struct smoothed_table *table);

#endif
