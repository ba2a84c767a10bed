/* Nodes and points in the order of a Morton (Z) curve, so that data that a loop uses in succession is close
 * together in memory. */
#pragma once

#include "base/status.h"

#include <stdint.h>

/* order[count]: the indices of x[count * dim] in the order of a Morton curve; equal points in the order
 * given. With group[count], unless NULL, lower groups come first. */
MUST_CHECK enum status renumber_morton(int dim, int64_t count, const double *x, const int32_t *group,
                                       int64_t *order, struct error *error);
