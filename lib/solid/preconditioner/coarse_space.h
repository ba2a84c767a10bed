/* The coarse space of the preconditioner, equation (25) of lib/README.md: a partition of unity times the
 * linear polynomials. A few nodes far from each other are centres. At each node the shares of the centres,
 * weights by distance, sum to one (Shepard). The basis of the coarse space, the coarse fields, are the shares
 * and their products with the coordinates. It contains all linear fields. The construction works on any
 * cloud, however thin.
 *
 * The distance is the Euclidean one, or half the length of the shortest path from neighbour to neighbour
 * where that is more, so that the two lips of a slit are far from each other. */
#pragma once

#include "approx/shape/shape.h"
#include "base/status.h"

#include <stdint.h>

enum { COARSE_MOST_CENTRES = 64 };
enum { COARSE_MOST_AT_NODE = 4 * COARSE_MOST_CENTRES };

/* A number for each centre; 0 beyond centre_count. */
typedef double of_centres[COARSE_MOST_CENTRES];

/* Centres are taken four at a time. */
enum { COARSE_FOUR = 4 };

/* Fields are numbered c * (dim + 1) + m: the share of centre c, times 1 (m = 0) or coordinate m - 1 relative
 * to the centre, divided by the radius. */
struct coarse_space {
    int dim;
    int64_t node_count;
    const double *X; /* node_count * dim, m; the caller's */
    int64_t centre_count, count;
    of_centres centre[3]; /* dim coordinates, m */
    double radius;        /* within which a centre has a share, m */
    int64_t stride;       /* centre_count, up to a multiple of COARSE_FOUR */
    double *share;        /* node_count * stride: sum 1, 0 beyond centre_count */
};

/* Fields of so many centres, at most COARSE_MOST_CENTRES; none for 0. `neighbours` of each node; NULL: all
 * distances are straight, as they are between bodies. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status coarse_space_build(int dim, int64_t node_count, const double *X,
                                          const struct neighbours *neighbours, int64_t centre_count,
                                          struct coarse_space *coarse, struct error *error);
void coarse_space_free(struct coarse_space *coarse);

/* The coarse fields that are not zero at a node: their numbers and values; returns how many. */
int coarse_space_at_node(const struct coarse_space *coarse, int64_t node, int field[COARSE_MOST_AT_NODE],
                         double value[COARSE_MOST_AT_NODE]);

/* amount[count * dim] = Z^T v, count > 0: what nodal vectors, such as forces, do along each field, in each
 * direction. Threaded; the same bits for any number of threads and on any processor, here and below. */
void coarse_space_restrict(const struct coarse_space *coarse, const double *v, double *amount);

/* u[node_count * dim] += Z amount. */
void coarse_space_prolongate(const struct coarse_space *coarse, const double *amount, double *u);
