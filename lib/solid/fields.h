/* The coarse space of the preconditioner, equation (25) of lib/README.md: a partition of unity times the
 * linear polynomials. A few centres, nodes far from each other, have shares that sum to one (Shepard), by
 * their distance; each share is a field, and so is its product with each coordinate. Linear fields are
 * contained exactly. The construction works on any cloud, however thin. */
#ifndef SOLID_FIELDS_H
#define SOLID_FIELDS_H

#include "base/status.h"

#include <stdint.h>

enum { FIELDS_MOST_CENTRES = 8 };
enum { FIELDS_MOST_AT_NODE = 4 * FIELDS_MOST_CENTRES };

/* A number for each centre; 0 behind the last. */
typedef double of_centres __attribute__((vector_size(8 * FIELDS_MOST_CENTRES)));

struct field_kernels;

/* Fields are numbered c * (dim + 1) + m: the share of centre c, times 1 (m = 0) or a coordinate of the way
 * from there over the radius. */
struct fields {
    int dim;
    int64_t node_count;
    const double *X; /* node_count * dim, m; the caller's */
    int64_t centre_count, count;
    of_centres centre[3];                /* dim coordinates, m */
    double radius;                       /* within which a centre has a share, m */
    of_centres *share;                   /* node_count: sum 1 */
    const struct field_kernels *kernels; /* for this processor */
};

/* Fields of so many centres, at most FIELDS_MOST_CENTRES; none for 0. */
MUST_CHECK enum status fields_build(int dim, int64_t node_count, const double *X, int64_t centre_count,
                                    struct fields *fields, struct error *error);
void fields_free(struct fields *fields);

/* The fields that are not zero at a node: their numbers and values; returns how many. */
int fields_at_node(const struct fields *fields, int64_t node, int field[FIELDS_MOST_AT_NODE],
                   double value[FIELDS_MOST_AT_NODE]);

/* amount[count * dim] = Z^T v, count > 0: what nodal vectors, such as forces, do along each field, in each
 * direction; or Z^T (weight v) with a weight for each node, unless that is NULL. Threaded; the same bits for
 * any number of threads and on any processor, here and below. */
void fields_collect(const struct fields *fields, const double *weight, const double *v, double *amount);

/* u[node_count * dim] += Z amount. */
void fields_add(const struct fields *fields, const double *amount, double *u);

/* The kernels compiled for an instruction set, see base/processor.h, or NULL where there are none. */
const struct field_kernels *field_kernels_of(const char *set);

#endif
