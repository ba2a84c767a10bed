/* The supports of nodes, equation (1) of lib/README.md. */
#pragma once

#include "base/lists.h"

#include <stddef.h>
#include <stdint.h>

/* Ellipsoids |A_j (x - x_j)| < R_j. A node on an interface at which supports stop, where cells are flat, has
 * one for each side, seen from there; that of the node itself is seen where sides do not count. */
struct supports {    /* views, or made by support_sizes */
    double *radius;  /* R_j, m */
    double *stretch; /* A_j, symmetric, dim * dim each, no eigenvalue below 1; NULL: all are balls */
    int64_t side_count;
    double *sides; /* side_count rows of node, side, R, A; ascending by node, then side */
};

/* Columns of supports.sides. */
#define SIDE_COLUMNS(dim) (3 + (dim) * (dim))

/* One of them. */
struct own_support {
    double radius;
    const double *stretch; /* NULL: a ball */
};

/* For lower_bound: by node, then side. */
static inline int compare_sides(const void *left, const void *right)
{
    const double *a = left, *b = right;
    int differs = a[0] != b[0] ? 0 : 1;
    return (a[differs] > b[differs]) - (a[differs] < b[differs]);
}

/* The support of a node, seen from a side; -1: from none. */
static inline struct own_support supports_seen(const struct supports *supports, int dim, int64_t node,
                                               int32_t side)
{
    if (side >= 0 && supports->side_count > 0) {
        size_t size = (size_t)SIDE_COLUMNS(dim) * sizeof *supports->sides;
        const double key[2] = {(double)node, side};
        int64_t at = lower_bound(key, supports->sides, supports->side_count, size, compare_sides);
        const double *own = supports->sides + at * SIDE_COLUMNS(dim);
        if (at < supports->side_count && compare_sides(own, key) == 0) {
            return (struct own_support){own[2], own + 3};
        }
    }
    return (struct own_support){supports->radius[node],
                                supports->stretch != NULL ? supports->stretch + node * dim * dim : NULL};
}
