/* Scattered-data fit: moving least squares on measured points that may lie on a curve or a surface, or be
 * few. At each x the nearest points, weighted by the quartic spline, are fitted by the linear basis in local
 * scaled coordinates, and the remainder by the quadratic monomials. Combinations of monomials that the points
 * do not determine (singular values below a cut) are left out. So the fit is constant along directions in
 * which there are no points. Linear fields are reproduced, however few the points are. */
#pragma once

#include "approx/points/point_grid.h"
#include "approx/visibility/visibility.h"

#include <stdint.h>

/* A place is too far from the points of a table if the nearest is farther than so many spacings. With points
 * on a square grid none is farther than .71 spacings, on a lattice than .87; with random ones on a surface,
 * one in exp(4 pi), 3e5 places, is farther than 2. */
#define SCATTERED_FIT_REACH 2.0

/* Measured values in the caller's arrays: each row holds a point, then the values. */
struct scattered_fit {
    int dim;
    int value_count;
    int64_t count;     /* >= 1 */
    int64_t row_size;  /* doubles per row, >= dim + value_count */
    const double *row; /* count * row_size; coordinates in units of `unit` */
    double unit;       /* m; scales coordinates and values */
    struct edge_paths
        *paths;         /* unless NULL, only rows connected to a node are used (scattered_fit_evaluate) */
    double *x, *radius; /* set by scattered_fit_build: the points, count * dim, in a grid */
    struct point_grid grid;
};

/* Sort the points into a grid. The other members are the caller's. STATUS_INPUT for coordinates that are not
 * finite or too far apart for a grid. */
MUST_CHECK enum status scattered_fit_build(struct scattered_fit *fit, struct error *error);
void scattered_fit_free(struct scattered_fit *fit);

/* values[value_count] at x[dim], m, near node `from`. With `paths` only rows connected to that node are used
 * (visibility.h); STATUS_INPUT if there are none. *distance receives the distance to the nearest point, and
 * *spacing the mean spacing of the points around that one, m (0 for a single point), so that a caller can
 * refuse to extrapolate far. */
MUST_CHECK enum status scattered_fit_evaluate(const struct scattered_fit *fit, int32_t from, const double *x,
                                              double *values, double *distance, double *spacing,
                                              struct error *error);
