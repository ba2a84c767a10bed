/* The supports of nodes, equation (1) of lib/README.md. */
#pragma once

#include <stdbool.h>
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

/* The row of supports.sides of a node and a side, or -1. */
static inline int64_t supports_row(const struct supports *supports, int dim, int64_t node, int32_t side)
{
    int64_t low = 0, high = supports->side_count;
    while (low < high) {
        int64_t middle = (low + high) / 2;
        const double *row = supports->sides + middle * SIDE_COLUMNS(dim);
        if (row[0] == (double)node && row[1] == (double)side) {
            return middle;
        }
        if (row[0] < (double)node || (row[0] == (double)node && row[1] < (double)side)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return -1;
}

/* The support of a node, seen from a side; -1: from none. */
static inline struct own_support supports_seen(const struct supports *supports, int dim, int64_t node,
                                               int32_t side)
{
    int64_t row = side >= 0 ? supports_row(supports, dim, node, side) : -1;
    if (row >= 0) {
        const double *own = supports->sides + row * SIDE_COLUMNS(dim), *A = own + 3;
        bool ball = true;
        for (int k = 0; k < dim * dim; k++) {
            ball = ball && A[k] == (k % (dim + 1) == 0 ? 1.0 : 0.0);
        }
        return (struct own_support){own[2], ball ? NULL : A};
    }
    return (struct own_support){supports->radius[node],
                                supports->stretch != NULL ? supports->stretch + node * dim * dim : NULL};
}
