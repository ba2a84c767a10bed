#include "approx/cells/crossing.h"

#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

void facet_boxes_sort(int dim, const double *x, const int32_t *facet, int64_t count, struct facet_box *boxes)
{
    for (int64_t i = 0; i < count; i++) {
        boxes[i].box = box_of_nodes(dim, x, facet + boxes[i].facet.item * dim, dim);
        boxes[i].facet.place = boxes[i].box.low[0];
    }
    qsort(boxes, (size_t)count, sizeof *boxes, compare_placed);
}

double simplex_determinant(int dim, const double *a, const double *b, const double *c, const double *d)
{
    double u[3] = {0.0}, v[3] = {0.0}, w[3] = {0.0};
    vector_subtract(dim, b, a, u);
    vector_subtract(dim, c, a, v);
    if (dim == 2) {
        return determinant2(u, v);
    }
    vector_subtract(dim, d, a, w);
    return determinant3(u, v, w);
}

/* Whether the segment p q crosses the facet in the interior of both. */
static bool pierces(int dim, const double *all, int32_t p, int32_t q, const int32_t *node, double round_off)
{
    const double *x = all + (int64_t)p * dim, *y = all + (int64_t)q * dim, *a = all + (int64_t)node[0] * dim,
                 *b = all + (int64_t)node[1] * dim;
    const double *c = all + (int64_t)node[dim - 1] * dim; /* 2D: b, not used */
    double before = simplex_determinant(dim, a, b, dim == 2 ? x : c, x);
    double after = simplex_determinant(dim, a, b, dim == 2 ? y : c, y);
    double side[3];
    double size = vector_distance(dim, x, y) + vector_distance(dim, x, a) + vector_distance(dim, a, b);
    double least = round_off * (dim == 2 ? size : size * size);
    if (!(fmin(before, after) < -least && fmax(before, after) > least)) {
        return false;
    }
    if (dim == 2) {
        side[0] = simplex_determinant(2, x, y, a, NULL);
        side[1] = -simplex_determinant(2, x, y, b, NULL);
        side[2] = side[0];
    } else {
        side[0] = simplex_determinant(3, x, y, a, b);
        side[1] = simplex_determinant(3, x, y, b, c);
        side[2] = simplex_determinant(3, x, y, c, a);
    }
    return (side[0] > least && side[1] > least && side[2] > least) ||
           (side[0] < -least && side[1] < -least && side[2] < -least);
}

/* Whether an edge of facet f (2D: the facet) without a node of facet g crosses g. */
static bool goes_through(int dim, const double *x, const int32_t *f, const int32_t *g, double round_off)
{
    for (int k = 0; k < (dim == 2 ? 1 : 3); k++) {
        int32_t p = f[k], q = f[(k + 1) % dim];
        bool apart = true;
        for (int i = 0; i < dim; i++) {
            apart = apart && g[i] != p && g[i] != q;
        }
        if (apart && pierces(dim, x, p, q, g, round_off)) {
            return true;
        }
    }
    return false;
}

bool facets_cross(int dim, const double *x, const int32_t *f, const int32_t *g, double round_off)
{
    return goes_through(dim, x, f, g, round_off) || goes_through(dim, x, g, f, round_off);
}
