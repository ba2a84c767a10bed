/* The parts of building a rigid surface; private to lib/solid. */
#ifndef SOLID_RIGID_PRIVATE_H
#define SOLID_RIGID_PRIVATE_H

#include "base/box.h"
#include "solid/rigid.h"

#include <math.h>

/* Fill vertex_normal, edge_normal, turn and the rims of a surface whose facets and normals are
 * made. STATUS_INPUT where two facets disagree on the side. */
MUST_CHECK enum status rigid_join_facets(struct rigid_surface *surface, struct error *error);

/* Fill branch, branch_count and in_order. */
MUST_CHECK enum status rigid_grow_tree(struct rigid_surface *surface, struct error *error);

static inline double distance2(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

/* Make v unit; a zero vector stays zero. */
static inline void normalise(int dim, double *v)
{
    double sum = 0.0;
    for (int a = 0; a < dim; a++) {
        sum += v[a] * v[a];
    }
    for (int a = 0; a < dim && sum > 0.0; a++) {
        v[a] /= sqrt(sum);
    }
}

static inline void add_scaled(int dim, double factor, const double *v, double *sum)
{
    for (int a = 0; a < dim; a++) {
        sum[a] += factor * v[a];
    }
}

#endif
