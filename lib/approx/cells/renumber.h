/* Locality: nodes and points in the order of a Morton (Z) curve, so that what a loop touches in succession
 * lies close together in memory. */
#pragma once

#include "base/status.h"

#include <stdint.h>

/* order[count]: the given index of each place, along a Morton curve through x[count * dim]; equal places in
 * the order given. With group[count] (else NULL) all of a lower group come before a higher one. */
MUST_CHECK enum status renumber_morton(int dim, int64_t count, const double *x, const int32_t *group,
                                       int64_t *order, struct error *error);
