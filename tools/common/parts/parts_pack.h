/* Exchange of the small sections of the parts, so that all processes have them. */
#pragma once

#include "parts/rejoin.h"

/* Fill in the streams of the parts that are elsewhere: their sections, of large tables the heads without
 * rows, and provenance. Process r has the parts from first[r] to before first[r + 1]; all call this together.
 * *packed holds what they consist of: to be freed behind them. One process: nothing, and NULL. */
MUST_CHECK enum status parts_share_small(struct rejoin *rejoin, const int64_t *first, void **packed,
                                         struct error *error);
