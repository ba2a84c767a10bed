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

/* Sums over the facets of each plane support, into folds->plane. */
void folds_fill_planes(struct folds *folds, const double *y);

/* How far the rim's node is beyond the plane of the support, m; *reach receives its distance from the rim. */
double folds_rim_beyond(const struct folds *folds, const struct fold_rim *rim, const double *y,
                        double *reach);

#endif
