/* Geometry of cells and facets that looking for folds needs; private to lib/solid. */
#ifndef SOLID_FOLDS_PRIVATE_H
#define SOLID_FOLDS_PRIVATE_H

#include "solid/folds.h"

#include <math.h>

static inline void fold_way(int dim, const double *from, const double *to, double way[3])
{
    for (int i = 0; i < dim; i++) {
        way[i] = to[i] - from[i];
    }
}

static inline double fold_dot(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Outward normal times length or twice the area of a facet. */
static inline void fold_area_vector(int dim, const double *y, const int32_t *facet, double area[3])
{
    double a[3], b[3];
    fold_way(dim, y + (int64_t)facet[0] * dim, y + (int64_t)facet[1] * dim, a);
    if (dim == 2) {
        area[0] = a[1];
        area[1] = -a[0];
        return;
    }
    fold_way(dim, y + (int64_t)facet[0] * dim, y + (int64_t)facet[2] * dim, b);
    for (int i = 0; i < 3; i++) {
        area[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}

/* Area (2D: twice) or volume (3D: six times) of the simplex of these corners. */
static inline double fold_volume(int dim, const double *a, const double *b, const double *c, const double *d)
{
    double u[3], v[3], w[3];
    fold_way(dim, a, b, u);
    fold_way(dim, a, c, v);
    if (dim == 2) {
        return u[0] * v[1] - u[1] * v[0];
    }
    fold_way(dim, a, d, w);
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Find the parts and bodies of the cells. */
MUST_CHECK enum status folds_find_bodies(struct folds *folds, struct error *error);

/* Look for a body within another, where boundaries do not cross. */
void folds_find_within(struct folds *folds, struct fold *fold);

/* The same at rest for each cell: whether its middle is deep in a cell of another body. Boundaries that go
 * through each other at nodes do not show as crossed. */
MUST_CHECK enum status folds_find_overlaps(struct folds *folds, struct fold *fold, struct error *error);

/* Sums over the facets of each plane support, into folds->plane. */
void folds_fill_planes(struct folds *folds, const double *y);

/* How far the rim's node is beyond the plane of the support, m; *reach receives its distance from the rim. */
double folds_rim_beyond(const struct folds *folds, const struct fold_rim *rim, const double *y,
                        double *reach);

#endif
