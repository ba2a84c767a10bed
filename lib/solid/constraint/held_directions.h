/* The directions that earlier displacement sections constrain at each node. Where two sections meet, a node's
 * averages on the two sides of the edge are nearly linearly dependent. So each section constrains only the
 * directions that are free so far, and its averages over whole sides carry the rest of the traction. */
#pragma once

#include "base/status.h"
#include "solid/constraint/constraint.h"

#include <stdint.h>

struct held_directions {
    int dim;
    int32_t *count; /* of each node, up to dim */
    double *axis;   /* node_count * dim * dim: orthonormal, the first `count` of each node */
};

MUST_CHECK enum status held_build(int dim, int64_t node_count, struct held_directions *held,
                                  struct error *error);
void held_free(struct held_directions *held);

/* rest[dim] = the component of a direction orthogonal to the prescribed directions of the node and to `count`
 * more orthonormal vectors; returns its length. */
double held_rest(const struct held_directions *held, int32_t node, int count, const double *more,
                 const double *direction, double *rest);

/* A unit direction counts as prescribed if its component orthogonal to those is shorter than this. */
#define HELD_LEAST 1e-3

/* Add the directions of the rows from `first` to before `last`. */
void held_note(struct held_directions *held, const struct constraint_rows *rows, int64_t first, int64_t last);
