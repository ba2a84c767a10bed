/* The coarse space of the preconditioner, equation (25) of lib/README.md: a partition of unity times the
 * linear polynomials. Nodes are in groups. The share of a group at a node is that of the node's neighbours
 * which are in the group, by a weight that falls with the distance. The basis of the coarse space, the coarse
 * fields, are the shares and their products with the coordinates. It contains all linear fields. The
 * construction works on any cloud, however thin. A node has shares of its neighbours' groups only, some six,
 * so that the shares do not grow with the number of groups, and the two faces of a slit have none in common.
 */
#pragma once

#include "approx/shape/shape.h"
#include "base/sparse.h"
#include "base/status.h"

#include <stdint.h>

/* Fields are numbered c * (dim + 1) + m: the share of group c, times 1 (m = 0) or coordinate m - 1 relative
 * to the group's centre, divided by the radius. */
struct coarse_space {
    int dim;
    int64_t node_count;
    const double *X; /* node_count * dim, m; the caller's */
    int64_t group_count, count;
    double *centre;         /* group_count * dim, the mean of each group's nodes, m */
    double radius;          /* within which a group has shares, m */
    struct sparse shares;   /* a row for each node: groups, ascending, and their shares, of sum 1; or none */
    struct sparse of_group; /* the transpose */
};

/* Fields of groups of nodes; none for 0. So many runs of nodes that are near each other are a group each
 * where their nodes are connected, else one for each part that is not small; small ones join groups beside
 * them. neighbours: of each node, with itself. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status coarse_space_build(int dim, int64_t node_count, const double *X,
                                          const struct neighbours *neighbours, int64_t runs,
                                          struct coarse_space *coarse, struct error *error);
void coarse_space_free(struct coarse_space *coarse);

/* value[dim + 1]: the fields at a node of a group that has this share of it. */
static inline void coarse_space_values(const struct coarse_space *coarse, int64_t node, int64_t group,
                                       double share, double *value)
{
    int dim = coarse->dim;
    value[0] = share;
    for (int a = 0; a < dim; a++) {
        value[a + 1] =
            share * ((coarse->X[node * dim + a] - coarse->centre[group * dim + a]) / coarse->radius);
    }
}

/* amount[count * dim] = Z^T v, count > 0: what nodal vectors, such as forces, do along each field, in each
 * direction. Threaded; the same bits for any number of threads and on any processor, here and below. */
void coarse_space_restrict(const struct coarse_space *coarse, const double *v, double *amount);

/* u += Z amount */
void coarse_space_prolongate(const struct coarse_space *coarse, const double *amount, double *u);
