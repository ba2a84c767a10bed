/* Directions that earlier displacement sections hold at each node. Where sections meet, a node's averages on
 * the two sides of the edge are nearly linearly dependent. So each section holds only the directions that are
 * not held yet, and the means over its sides carry the rest of the traction. */
#pragma once

#include "base/status.h"
#include "solid/constraint.h"

#include <stdint.h>

struct held_directions {
    int dim;
    int32_t *count; /* of each node, up to dim */
    double *axis;   /* node_count * dim * dim: orthonormal, the first `count` of each node */
};

MUST_CHECK enum status held_build(int dim, int64_t node_count, struct held_directions *held,
                                  struct error *error);
void held_free(struct held_directions *held);

/* rest[dim] = the part of a direction across what is held at the node, and across count more orthonormal
 * vectors; returns its length. */
double held_rest(const struct held_directions *held, int32_t node, int count, const double *more,
                 const double *direction, double *rest);

/* A direction that is shorter than this across what is held is held. */
#define HELD_LEAST 1e-3

/* Note what the rows from number `first` up to `last` hold. */
void held_note(struct held_directions *held, const struct constraint_rows *rows, int64_t first, int64_t last);
