/* Facets that pass through each other, and the search for them along one axis. */
#pragma once

#include "base/box.h"
#include "base/lists.h"

#include <stdbool.h>

/* The box around a facet, sorted by its low end along the first axis. */
struct facet_box {
    struct placed facet;
    struct box box;
};

/* Set the boxes of the facets number boxes[count].facet.item of facet[], with dim nodes each, for nodes at x;
 * and sort them, of one place by the facets' numbers. */
void facet_boxes_sort(int dim, const double *x, const int32_t *facet, int64_t count, struct facet_box *boxes);

/* Whether an edge (2D: the facet) of one of two facets, f[dim] and g[dim], crosses the other one, with which
 * it has no node in common, in the interior of both. Positions nearer than round_off, m, are the same. */
bool facets_cross(int dim, const double *x, const int32_t *f, const int32_t *g, double round_off);

/* Area (2D: twice) or volume (3D: six times) of the simplex of these corners, positive in a positive order; d
 * is not used in 2D. */
double simplex_determinant(int dim, const double *a, const double *b, const double *c, const double *d);
